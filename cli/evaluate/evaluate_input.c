/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of references and readings, and which file is one. */
#include "evaluate_parts.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- channels -------------------------------------------------------------------------------- */

evaluate_channel *evaluate_channel_of(evaluation *v, const char *name, imk_unit reference,
                                      imk_unit reading)
{
    for (size_t k = 0; k < v->channel_count; k++) {
        evaluate_channel *c = &v->channel[k];
        if (strcmp(c->name, name) != 0)
            continue;
        if (imk_dimension_equal(c->reference_unit.dimension, reference.dimension) &&
            imk_dimension_equal(c->reading_unit.dimension, reading.dimension))
            return c;
        command_failed("%s is in %s over %s in one file and in %s over %s in another", name,
                       c->reading_unit.text, c->reference_unit.text, reading.text, reference.text);
        return NULL;
    }
    if (v->channel_count == EVALUATE_CHANNELS) {
        command_failed("there are more than %d columns of readings", EVALUATE_CHANNELS);
        return NULL;
    }
    evaluate_channel *c = &v->channel[v->channel_count++];
    snprintf(c->name, sizeof c->name, "%s", name);
    c->reference_unit = reference;
    c->reading_unit = reading;
    return c;
}

static bool grow(void **array, size_t capacity, size_t size)
{
    void *grown = realloc(*array, capacity * size);
    if (grown)
        *array = grown;
    return grown != NULL;
}

bool evaluate_add(evaluate_channel *c, double reference, double reading, double sigma,
                  int direction, int run)
{
    if (c->count == c->capacity) {
        const size_t capacity = c->capacity > 0 ? 2 * c->capacity : 64;
        if (!grow((void **)&c->reference, capacity, sizeof *c->reference) ||
            !grow((void **)&c->reading, capacity, sizeof *c->reading) ||
            !grow((void **)&c->sigma, capacity, sizeof *c->sigma) ||
            !grow((void **)&c->direction, capacity, sizeof *c->direction) ||
            !grow((void **)&c->run, capacity, sizeof *c->run))
            return false;
        c->capacity = capacity;
    }
    c->reference[c->count] = reference;
    c->reading[c->count] = reading;
    c->sigma[c->count] = sigma;
    c->direction[c->count] = (signed char)direction;
    c->run[c->count++] = run;
    return true;
}

/* ---- columns --------------------------------------------------------------------------------- */

/* Columns of a table; -1: none. */
typedef struct columns {
    int reference, direction, run, sigma;
} columns;

static int column_of(const imk_log *log, const char *name)
{
    for (size_t c = 0; c < log->column_count; c++)
        if (strcmp(log->column[c].name, name) == 0)
            return (int)c;
    return -1;
}

static bool is_reading(const imk_log_column *column)
{
    return strncmp(column->name, "reading", 7) == 0 && !column->label;
}

static int check_unit(const char *path, const imk_log_column *column)
{
    if (column->label)
        return command_failed("%s: column %s holds texts, expected numbers", path, column->name);
    if (!column->unit.text[0])
        return command_failed("%s: %s has no unit; write it into the header, such as %s [deg/s] or "
                              "%s [count]",
                              path, column->name, column->name, column->name);
    return -1;
}

/* "up", "down" or their like; a number's sign. */
static int read_direction(const imk_log *log, int column, size_t row, int *direction)
{
    const double value = log->data[column][row];
    *direction = value > 0 ? 1 : value < 0 ? -1 : 0;
    if (!log->column[column].label)
        return -1;
    const char *text =
        value >= 0 && value < (double)log->label_count ? log->label[(size_t)value] : "";
    *direction = strcmp(text, "up") == 0 ? 1 : strcmp(text, "down") == 0 ? -1 : 0;
    if (*direction == 0 && text[0] && strcmp(text, "-") != 0)
        return command_failed("row %zu: direction \"%s\"; expected up, down or -", row + 1, text);
    return -1;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* Values of the column run, and the number of each among all runs. */
typedef struct run_list {
    size_t count, first;
    double value[IMK_EVALUATION_RUNS_MAX];
} run_list;

static int run_number(run_list *runs, double value)
{
    for (size_t k = 0; k < runs->count; k++)
        if (runs->value[k] == value)
            return (int)(runs->first + k);
    if (runs->first + runs->count == IMK_EVALUATION_RUNS_MAX)
        return -1;
    runs->value[runs->count++] = value;
    return (int)(runs->first + runs->count - 1);
}

static int take_row(evaluate_channel *c, const char *path, const imk_log *log, const columns *at,
                    int reading, size_t row, run_list *runs)
{
    int direction = 0;
    int code = at->direction >= 0 ? read_direction(log, at->direction, row, &direction) : -1;
    if (code >= 0)
        return code;
    const double reference = log->data[at->reference][row], value = log->data[reading][row];
    const double sigma = at->sigma >= 0 ? log->data[at->sigma][row] : (double)NAN;
    const int run = run_number(runs, at->run >= 0 ? log->data[at->run][row] : 0.0);
    if (run < 0)
        return command_failed("%s: more than %d runs", path, IMK_EVALUATION_RUNS_MAX);
    const bool referred = fabs(reference) <= IMK_READING_MAX;
    if (!referred || !(fabs(value) <= IMK_READING_MAX))
        return command_failed("%s: row %zu: %s is no number, or beyond 1e60; leave the row out",
                              path, row + 1, referred ? log->column[reading].name : "reference");
    if (at->sigma >= 0 && !(sigma > 0))
        return command_failed("%s: row %zu: sigma should be above 0", path, row + 1);
    if (!evaluate_add(c, reference, value, sigma, direction, run))
        return command_failed("memory is exhausted");
    return -1;
}

static int take_table(evaluation *v, const char *path, const imk_log *log)
{
    const columns at = {column_of(log, "reference"), column_of(log, "direction"),
                        column_of(log, "run"), column_of(log, "sigma")};
    run_list runs = {.first = v->run_count};
    int code = check_unit(path, &log->column[at.reference]);
    for (size_t k = 0; code < 0 && k < log->column_count; k++) {
        const imk_log_column *column = &log->column[k];
        if (!is_reading(column))
            continue;
        const char *name = column->name[7] == '_' ? column->name + 8 : column->name;
        code = check_unit(path, column);
        evaluate_channel *c =
            code < 0 ? evaluate_channel_of(v, name, log->column[at.reference].unit, column->unit)
                     : NULL;
        if (code < 0 && !c)
            return EXIT_FAILED;
        for (size_t row = 0; code < 0 && row < log->rows; row++)
            code = take_row(c, path, log, &at, (int)k, row, &runs);
    }
    v->run_count += runs.count;
    return code;
}

/* ---- files ----------------------------------------------------------------------------------- */

static imk_log_settings table_settings(const evaluation *v)
{
    imk_log_settings settings = log_input_settings(&v->options->bench.log);
    if (!(settings.rate > 0))
        settings.rate = 1; /* a table has no time */
    settings.any_columns = true;
    return settings;
}

/* A table has the columns reference and reading. What cannot be opened is left to the reader of
 * logs, which says why. */
static bool is_table(const evaluation *v, const char *path)
{
    imk_log_reader *reader;
    imk_log_settings settings = table_settings(v);
    bool reference = false, reading = false;
    settings.reopened = true;
    if (command_unless_memory(imk_log_open(path, &settings, &reader, NULL)) != IMK_OK)
        return false;
    for (size_t k = 0; k < imk_log_column_count(reader); k++) {
        const imk_log_column *column = imk_log_column_get(reader, k);
        reference = reference || strcmp(column->name, "reference") == 0;
        reading = reading || is_reading(column);
    }
    imk_log_close(reader);
    return reference && reading;
}

static int load_table(evaluation *v, const char *path)
{
    imk_error error;
    imk_log log;
    const imk_log_settings settings = table_settings(v);
    if (imk_log_load(path, &settings, NULL, NULL, &log, &error) != IMK_OK)
        return command_log_error(&error, path);
    int code = -1;
    if (column_of(&log, "reference") < 0)
        code = command_failed("%s has no column reference and reading", path);
    else if (log.rows == 0)
        code = command_failed("%s: there is a header but no data row", path);
    else
        code = take_table(v, path, &log);
    imk_log_free(&log);
    return code;
}

int evaluate_load(evaluation *v)
{
    int code = -1;
    for (size_t k = 0; code < 0 && k < v->path_count; k++)
        code =
            is_table(v, v->path[k]) ? load_table(v, v->path[k]) : evaluate_load_log(v, v->path[k]);
    return code;
}
