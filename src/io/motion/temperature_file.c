/* SPDX-License-Identifier: Apache-2.0 */
/* Temperature profiles: a script of a climatic chamber's steps, a table, or a constant.
 *
 * The surroundings are straight lines between points. A ramp by d at the rate r takes |d|/r; a step
 * is two points at one time. The unit follows with the time constant, see motion.h. */
#define _POSIX_C_SOURCE 200809L

#include "io/file/text_file_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "motion_file_internal.h"
#include "step_text_internal.h"

#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { START, RAMP, SOAK, STEP };

static const imki_verb verbs[] = {
    {"start", START, 0, 0, {IMKI_BARE_BIT}, "write start 25 degC"},
    {"ramp",
     RAMP,
     0,
     0,
     {IMKI_TO_BIT | IMKI_AT_BIT, IMKI_TO_BIT | IMKI_IN_BIT},
     "write ramp to 60 degC at 1 degC/min or ramp to 60 degC in 40 min"},
    {"soak", SOAK, 0, 0, {IMKI_BARE_BIT, IMKI_FOR_BIT}, "write soak 30 min"},
    {"step", STEP, 0, 0, {IMKI_TO_BIT}, "write step to 25 degC"},
};

struct imk_temperature_file {
    imk_temperature_profile profile;
    double *time, *temperature; /* capacity of them */
    double *carried;
    size_t capacity;
    imk_log log; /* of a table */
};

static imk_status add_point(imk_temperature_file *file, double time, double temperature,
                            imk_error *error)
{
    imk_temperature_profile *profile = &file->profile;
    if (profile->point_count == file->capacity) {
        const size_t capacity = file->capacity > 0 ? 2 * file->capacity : 16;
        double *times = realloc(file->time, capacity * sizeof *times);
        if (times)
            file->time = times;
        double *temperatures = realloc(file->temperature, capacity * sizeof *temperatures);
        if (temperatures)
            file->temperature = temperatures;
        if (!times || !temperatures)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
        file->capacity = capacity;
    }
    file->time[profile->point_count] = time;
    file->temperature[profile->point_count++] = temperature;
    profile->time = file->time;
    profile->temperature = file->temperature;
    return IMK_OK;
}

/* ---- scripts --------------------------------------------------------------------------------- */

/* A temperature above absolute zero. */
static double read_temperature(const imki_step_text *s, imki_part part)
{
    const double temperature = imki_step_text_number(s, part, "K");
    if (!(temperature > 0.0))
        imki_step_text_refuse(s, part, IMK_ERROR_RANGE, "a temperature above 0 K");
    return temperature;
}

/* A straight line from the last point to a temperature: so long, or at a rate. */
static double read_ramp_time(const imki_step_text *s, double change)
{
    return imki_step_text_has(s, IMKI_PART_AT)
               ? fabs(change) / imki_step_text_positive(s, IMKI_PART_AT, "K/s")
               : imki_step_text_positive(s, IMKI_PART_IN, "s");
}

static void read_step(imki_reading *r, int node, imk_temperature_file *file)
{
    imki_step_text s;
    if (!imki_value_require(r, node, IMKI_NODE_SCALAR,
                            "a step such as ramp to 60 degC at 1 degC/min") ||
        !imki_step_text_read(r, node, "a step", sizeof verbs / sizeof verbs[0], verbs, &s))
        return;
    const size_t count = file->profile.point_count;
    const int kind = s.verb->kind;
    if ((count == 0) != (kind == START))
        imki_step_text_refuse(&s, IMKI_PARTS, IMK_ERROR_SYNTAX,
                              count == 0
                                  ? "start with a step such as start 25 degC"
                                  : "start can only be the first step; write step to 25 degC");
    if (r->status != IMK_OK)
        return;
    double time = count > 0 ? file->time[count - 1] : 0.0;
    double temperature = count > 0 ? file->temperature[count - 1] : 0.0;
    if (kind == SOAK) {
        const bool words = imki_step_text_has(&s, IMKI_PART_FOR);
        time += imki_step_text_positive(&s, words ? IMKI_PART_FOR : IMKI_PART_BARE, "s");
    } else {
        const double before = temperature;
        temperature = read_temperature(&s, kind == START ? IMKI_PART_BARE : IMKI_PART_TO);
        const double duration = kind == RAMP ? read_ramp_time(&s, temperature - before) : 0.0;
        if (kind == RAMP && !(duration > 0.0))
            return;
        time += duration;
    }
    if (r->status == IMK_OK)
        r->status = add_point(file, time, temperature, r->error);
}

static void read_script(imki_reading *r, imk_temperature_file *file)
{
    static const char *const names[] = {"imukit_temperature", "name", "time_constant", "steps"};
    static const char due[] = "a list of steps: [start 25 degC, soak 30 min, …]";
    const imki_node *nodes = r->document->node;
    const int constant = imki_document_value(r->document, 0, "time_constant");
    char name[IMKI_MOTION_NAME_SIZE];
    int steps;
    imki_value_keys(r, 0, 4, names);
    imki_value_version(r, "imukit_temperature");
    imki_value_name(r, "name", name, sizeof name);
    imki_value_number(r, 0, "time_constant", "s", &file->profile.time_constant);
    if (!(file->profile.time_constant >= 0.0))
        imki_refuse_value(r, constant, IMK_ERROR_RANGE, "a time of 0 s or more");
    if (!imki_value_find(r, 0, "steps", due, &steps) ||
        !imki_value_require(r, steps, IMKI_NODE_SEQUENCE, due))
        return;
    if (nodes[steps].count == 0)
        imki_value_refuse(r, steps, IMK_ERROR_SYNTAX, "[]", due);
    for (int i = nodes[steps].first; r->status == IMK_OK && i != IMKI_NONE; i = nodes[i].next)
        read_step(r, i, file);
}

static imk_status open_script(const char *path, imk_temperature_file *file, imk_error *error)
{
    char *text = NULL;
    size_t size = 0;
    imk_document *document = NULL;
    imk_status status = imki_text_file_read(path, IMKI_DOCUMENT_SIZE_MAX, &text, &size, error);
    if (status == IMK_OK)
        status = imki_document_parse_as("temperature", "imukit_temperature: 1", text, size,
                                        &document, error);
    imki_reading reading = {.document = document, .error = error};
    if (status == IMK_OK) {
        read_script(&reading, file);
        status = reading.status;
    }
    imk_document_free(document);
    free(text);
    return status;
}

/* ---- tables and constants -------------------------------------------------------------------- */

static imk_status refuse_column(const char *name, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_COLUMN, name, "this column is missing",
                         "give the columns time [s] and temperature [degC]");
}

/* The columns of file->log. */
static imk_status take_table(imk_temperature_file *file, imk_error *error)
{
    imk_log *log = &file->log;
    const int time = imk_log_find(log, IMK_QUANTITY_TIME, -1);
    const int temperature = imk_log_find(log, IMK_QUANTITY_TEMPERATURE, -1);
    if (time < 0 || temperature < 0)
        return refuse_column(time < 0 ? "time" : "temperature", error);
    imk_status status = imki_table_column_check(log, (size_t)time, "s", error);
    if (status == IMK_OK)
        status = imki_table_column_check(log, (size_t)temperature, "K", error);
    if (status != IMK_OK)
        return status;
    const double first = log->data[time][0];
    for (size_t i = 0; i < log->rows; i++) {
        log->data[time][i] -= first;
        if (i > 0 && !(log->data[time][i] >= log->data[time][i - 1]))
            return imki_table_row_error("time", IMK_ERROR_TIME_ORDER, i + 1,
                                        "this time is before that of the row before",
                                        "sort the rows by time", error);
        if (!(log->data[temperature][i] > 0.0)) {
            char found[64];
            snprintf(found, sizeof found, "\"%.6g K\" is not above absolute zero",
                     log->data[temperature][i]);
            return imki_table_row_error("temperature", IMK_ERROR_RANGE, i + 1, found,
                                        "a temperature above 0 K", error);
        }
    }
    file->profile.point_count = log->rows;
    file->profile.time = log->data[time];
    file->profile.temperature = log->data[temperature];
    return IMK_OK;
}

static imk_status open_table(const char *path, imk_temperature_file *file, imk_error *error)
{
    const imk_log_settings settings = imk_log_default();
    const imk_status status = imk_log_load(path, &settings, NULL, &file->log, error);
    if (status == IMK_ERROR_RATE_MISSING) /* here no rate can stand for the times */
        return refuse_column("time", error);
    return status == IMK_OK ? take_table(file, error) : status;
}

/* Does it begin as a number does, and is no file? */
static bool is_quantity(const char *text)
{
    struct stat unused;
    const char *digits = text + (*text == '-' || *text == '+');
    digits += *digits == '.';
    return *digits >= '0' && *digits <= '9' && stat(text, &unused) != 0;
}

static imk_status open_constant(const char *text, imk_temperature_file *file, imk_error *error)
{
    double value, sigma;
    size_t count;
    const imk_status status =
        imk_quantity_parse(text, text + strlen(text), imk_unit_of("K").dimension, 1, &value, &sigma,
                           &count, NULL, error);
    if (status != IMK_OK)
        return status;
    if (!(value > 0.0) || sigma != 0.0)
        return imk_error_set(error, IMK_ERROR_RANGE, "", text,
                             "a temperature above 0 K, without uncertainty");
    return add_point(file, 0.0, value, error);
}

/* What makes looking a temperature up quick in a long profile. */
static imk_status carry(imk_temperature_file *file, imk_error *error)
{
    file->carried = malloc((file->profile.point_count + 1) * sizeof *file->carried);
    if (!file->carried)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    imk_temperature_carry(&file->profile, file->carried);
    file->profile.carried = file->carried;
    return IMK_OK;
}

/* Takes it over. */
static imk_status finish(imk_status status, imk_temperature_file *made, imk_temperature_file **file,
                         imk_error *error)
{
    if (status == IMK_OK)
        status = imk_temperature_validate(&made->profile, error);
    if (status == IMK_OK)
        status = carry(made, error);
    if (status != IMK_OK) {
        imk_temperature_file_free(made);
        return status;
    }
    *file = made;
    return IMK_OK;
}

imk_status imk_temperature_read(const char *path, imk_temperature_file **file, imk_error *error)
{
    imk_temperature_file *made = calloc(1, sizeof *made);
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    const imk_status status = is_quantity(path) ? open_constant(path, made, error)
                              : imki_is_script(path, "imukit_temperature")
                                  ? open_script(path, made, error)
                                  : open_table(path, made, error);
    return finish(status, made, file, error);
}

imk_status imk_temperature_of_record(const imk_record_source *source, imk_temperature_file **file,
                                     imk_error *error)
{
    imk_temperature_file *made = calloc(1, sizeof *made);
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    imk_status status = imki_record_load(source, imki_job_of(NULL), &made->log, error);
    if (status == IMK_OK)
        status = take_table(made, error);
    return finish(status, made, file, error);
}

void imk_temperature_file_free(imk_temperature_file *file)
{
    if (!file)
        return;
    imk_log_free(&file->log);
    free(file->time);
    free(file->temperature);
    free(file->carried);
    free(file);
}

const imk_temperature_profile *imk_temperature_file_profile(const imk_temperature_file *file)
{
    return &file->profile;
}
