/* SPDX-License-Identifier: Apache-2.0 */
/* imukit convert: logs, model files and parameter files of other programs between formats. */
#include "convert_motion.h"
#include "convert_parameters.h"
#include "log/log_input.h"
#include "log/log_units.h"
#include "shell/command.h"
#include "shell/progress.h"

#include "imukit/model_file.h"

#include <stdlib.h>
#include <string.h>

typedef struct convert_options {
    log_input log;
    parameter_options parameters;
    convert_motion_options motion;
    const char *to_gyro_unit, *to_accel_unit, *to_time_unit, *to_temperature_unit, *select;
    option_integer decimals, threads;
} convert_options;

#define AT(member) offsetof(convert_options, member)

static const option convert_option_table[] = {
    {"select", 0, A_TEXT("NAMES"), AT(select),
     "columns to keep, in this order, such as time,gyro_x; default: all"},
    {"to-gyro-unit", 0, A_TEXT("UNIT"), AT(to_gyro_unit),
     "of the gyro columns written; default: as read"},
    {"to-accel-unit", 0, A_TEXT("UNIT"), AT(to_accel_unit),
     "of the accelerometer columns written; default: as read"},
    {"to-time-unit", 0, A_TEXT("UNIT"), AT(to_time_unit),
     "of the time column written; default: as read"},
    {"to-temperature-unit", 0, A_TEXT("UNIT"), AT(to_temperature_unit),
     "of the temperature column written; default: as read"},
    {"decimals", 0, AN_INTEGER("N", "0-17"), AT(decimals),
     "digits after the point, 0 to 17; default: as many as the number needs"},
    {"threads", 0, AN_INTEGER("N", "1-65536"), AT(threads),
     "threads to use; default: all processors"},
};

static int run(int count, char **words);

const verb convert_verb = {
    .name = "convert",
    .summary = "logs, models and parameter files between formats",
    .operands = "IN OUT",
    .operands_minimum = 2,
    .operands_maximum = 2,
    .last_is_written = true,
    .examples =
        {{"imukit convert raw.csv log.csv.zst --rate 200Hz --gyro-unit deg/s --accel-unit g",
          "a log without units becomes one that says everything"},
         {"imukit convert model.yaml imu.yaml --to kalibr --rate 200Hz",
          "a model becomes a parameter file of another program; without --to the way back"}},
    .description =
        "A log is .csv (also .gz, .zst){ or logs}; - is standard input or output, as CSV. "
        "Increments "
        "become rates. Values keep their units unless an option changes them.\n\n"
        "A model (.yaml, .yml, .json, or through a pipe) is converted between YAML and JSON. "
        "Parameter files of "
        "kalibr, gazebo (SDF), matlab (imuSensor), gnss-ins-sim, navego, openvins, vins, px4 and "
        "ardupilot "
        "are recognised by their content; what was assumed about units and densities, and what a "
        "format cannot hold, is said on standard error. docs/other-formats.md has the formats.",
    .groups = {{A_GROUP("Options", convert_option_table), 0},
               {"Parameter files", PARAMETER_OPTIONS, parameter_option_table, AT(parameters)},
               {"Another point, without gravity", CONVERT_MOTION_OPTIONS,
                convert_motion_option_table, AT(motion)},
               {"Reading the log", LOG_FORMAT_OPTIONS, log_input_options, AT(log)}},
    .run = run};

/* What each end is. A name without an ending tells nothing of what is read: its content is looked
 * at, but a stream's only when a model is due, for it has to be copied. A stream that is written is
 * of the kind of what is read. */
static void find_kinds(const char *in, const char *out, bool *from_model, bool *to_model)
{
    *to_model = parameters_or_model(out);
    *from_model =
        *to_model || !command_is_stream(in) ? imk_model_recognise(in) : parameters_or_model(in);
    *to_model = *to_model || (*from_model && command_is_stream(out));
}

/* The document is kept only within one format: JSON has no place for comments and layout. */
static int convert_model(const char *in, const char *out)
{
    imk_error error;
    imk_document *document = NULL;
    imk_model *model = command_memory(NULL, sizeof *model);
    int code = command_model(in, model, &document);
    if (code < 0)
        code = imk_model_write(out, model, document, &error) == IMK_OK
                   ? EXIT_DONE
                   : command_error(&error, NULL);
    imk_document_free(document);
    free(model);
    return code;
}

/* Which columns are read and how they are written. */
typedef struct conversion {
    size_t count;
    size_t source[IMK_LOG_COLUMNS_MAX];
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
} conversion;

static int select_columns(const convert_options *o, imk_log_reader *reader, conversion *c)
{
    const char *names[IMK_LOG_COLUMNS_MAX];
    size_t available = imk_log_column_count(reader);
    for (size_t k = 0; k < available; k++)
        names[k] = imk_log_column_get(reader, k)->name;
    c->count = 0;
    for (size_t k = 0; !o->select && k < available; k++)
        c->source[c->count++] = k;
    for (const char *item = o->select; item;) {
        size_t length = strcspn(item, ","), k = 0;
        while (k < available &&
               (strlen(names[k]) != length || strncmp(names[k], item, length) != 0))
            k++;
        if (k == available || c->count == IMK_LOG_COLUMNS_MAX) {
            char name[64];
            snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), item);
            const char *nearest = command_nearest(name, available, names);
            return command_failed("--select: the log has no column \"%s\"%s%s%s", name,
                                  nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                                  nearest ? "\"?" : "");
        }
        c->source[c->count++] = k;
        item = item[length] ? item + length + 1 : NULL;
    }
    for (size_t k = 0; k < c->count; k++)
        c->column[k] = *imk_log_column_get(reader, c->source[k]);
    return -1;
}

/* Increments were divided by the interval on reading: name and unit follow. */
static void make_rate(imk_log_column *column)
{
    const bool gyro = column->quantity == IMK_QUANTITY_ANGULAR_RATE;
    if (!column->increment)
        return;
    column->increment = false;
    column->unit = imk_unit_of(gyro ? "deg/s" : "m/s^2");
    if (column->axis >= 0 && column->axis < 3)
        imk_axis_name(gyro ? "gyro" : "accel", column->axis, column->name);
}

static int set_units(const convert_options *o, conversion *c)
{
    const struct {
        imk_quantity quantity;
        const char *option_name, *text;
    } choices[] = {{IMK_QUANTITY_TIME, "to-time-unit", o->to_time_unit},
                   {IMK_QUANTITY_ANGULAR_RATE, "to-gyro-unit", o->to_gyro_unit},
                   {IMK_QUANTITY_SPECIFIC_FORCE, "to-accel-unit", o->to_accel_unit},
                   {IMK_QUANTITY_TEMPERATURE, "to-temperature-unit", o->to_temperature_unit}};
    int code = -1;
    for (size_t k = 0; k < c->count; k++) {
        make_rate(&c->column[k]);
        for (size_t i = 0; i < sizeof choices / sizeof choices[0] && code < 0; i++)
            if (c->column[k].quantity == choices[i].quantity)
                code = log_unit_asked(choices[i].option_name, choices[i].text, &c->column[k].unit);
    }
    return code;
}

enum { BLOCK_ROWS = 65536 };

static int copy_rows(imk_log_reader *reader, convert_motion *motion, imk_log_writer *writer,
                     const conversion *c, const char *in, const imk_executor *executor)
{
    double *read[IMK_LOG_COLUMNS_MAX] = {NULL}, *written[IMK_LOG_COLUMNS_MAX];
    double *memory =
        command_memory(NULL, imk_log_column_count(reader) * BLOCK_ROWS * sizeof *memory);
    imk_error error;
    imk_status status = IMK_OK;
    for (size_t k = 0; k < imk_log_column_count(reader); k++)
        read[k] = memory + k * BLOCK_ROWS;
    for (size_t k = 0; k < c->count; k++)
        written[k] = read[c->source[k]];
    progress p = progress_begin("converting", "B", 1);
    size_t rows = 1;
    bool wrote = true;
    uint64_t total = 0;
    while (status == IMK_OK && rows > 0 && wrote) {
        uint64_t done, size;
        status = convert_motion_read(motion, reader, BLOCK_ROWS, read, &rows, &error);
        if (status == IMK_OK && rows > 0)
            wrote = imk_log_write(writer, rows, (const double *const *)written, executor) == IMK_OK;
        total += rows;
        imk_log_progress(reader, &done, &size);
        progress_update(&p, done, size);
    }
    progress_end(&p);
    free(memory);
    if (status != IMK_OK) {
        imk_log_abandon(writer);
        return command_error(&error, in);
    }
    if (wrote && total == 0) {
        imk_log_abandon(writer);
        return command_failed("%s: there is a header but no data row", in);
    }
    if (imk_log_commit(writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    return EXIT_DONE;
}

static int write_log(const convert_options *o, imk_log_reader *reader, convert_motion *motion,
                     const conversion *c, const char *in, const char *out)
{
    int decimals[IMK_LOG_COLUMNS_MAX];
    bool fixed = o->decimals.given;
    imk_error error;
    imk_log_writer *writer;
    for (size_t k = 0; k < c->count; k++)
        decimals[k] = (int)o->decimals.value;
    if (imk_log_create(out, c->count, c->column, fixed ? IMK_LOG_FIXED : IMK_LOG_SHORTEST,
                       fixed ? decimals : NULL, 0, &writer, &error) != IMK_OK)
        return command_error(&error, NULL);
    log_copy_labels(reader, writer);
    imk_thread_pool *pool = imk_thread_pool_create(o->threads.value);
    imk_executor executor = imk_thread_pool_executor(pool);
    int code = copy_rows(reader, motion, writer, c, in, &executor);
    imk_thread_pool_destroy(pool);
    return code;
}

static int convert_log(const convert_options *o, const char *in, const char *out)
{
    imk_error error;
    imk_log_reader *reader;
    imk_log_settings settings = log_input_settings(&o->log);
    conversion c;
    convert_motion *motion = NULL;
    if (imk_log_open(in, &settings, &reader, &error) != IMK_OK)
        return command_log_error(&error, in);
    int code = select_columns(o, reader, &c);
    if (code < 0)
        code = set_units(o, &c);
    if (code < 0)
        code = convert_motion_start(&o->motion, reader, in, &motion);
    if (code < 0)
        code = write_log(o, reader, motion, &c, in, out);
    convert_motion_end(motion);
    imk_log_close(reader);
    return code;
}

static int run(int count, char **words)
{
    convert_options o = {.motion = convert_motion_default()};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&convert_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    operands[1] = options_output_name(operands[1]);
    bool wanted;
    code = parameters_wanted(&o.parameters, operands[0], parameters_or_model(operands[1]), &wanted);
    if (code >= 0)
        return code;
    if (wanted)
        return convert_parameters(&o.parameters, o.log.rate, operands[0], operands[1]);
    if (o.parameters.json || o.parameters.sensor || o.parameters.density)
        return command_misused("%s: --json, --sensor and --density are for parameter files; "
                               "--from says which kind it is",
                               operands[0]);
    bool from_model, to_model;
    find_kinds(operands[0], operands[1], &from_model, &to_model);
    if (from_model != to_model)
        return command_misused("%s is a %s and %s a %s: a log and a model cannot become each "
                               "other; use identify or simulate",
                               operands[0], from_model ? "model" : "log", operands[1],
                               to_model ? "model" : "log");
    if (from_model && (o.motion.to_point || o.motion.gravity_free))
        return command_misused("--to-point and --gravity-free are for logs, and %s is a model",
                               operands[0]);
    return from_model ? convert_model(operands[0], operands[1])
                      : convert_log(&o, operands[0], operands[1]);
}
