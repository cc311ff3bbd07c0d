/* SPDX-License-Identifier: Apache-2.0 */
/* imukit convert: logs, model files and parameter files of other programs between formats. */
#include "convert_parameters.h"
#include "log/log_input.h"
#include "shell/job_progress.h"
#include "shell/show.h"

#include "imukit/convert_log.h"
#include "imukit/model_file.h"
#include "imukit/names.h"
#include "imukit/show.h"

#include <math.h>

#include <stdlib.h>
#include <string.h>

typedef struct convert_options {
    log_input log;
    parameter_options parameters;
    imk_convert_log_settings to;
    const char *to_point;
    option_integer decimals, threads;
} convert_options;

#define AT(field) offsetof(convert_options, field)

static const option convert_option_table[] = {
    {"select", OPTION_TEXT, AT(to.select), .value = "NAMES",
     .help = "columns to keep, in this order, such as time,gyro_x; default: all"},
    {"to-gyro-unit", OPTION_UNIT, AT(to.gyro_unit), .value = "UNIT",
     .help = "unit of the gyro columns written; default: as read"},
    {"to-accel-unit", OPTION_UNIT, AT(to.accel_unit), .value = "UNIT",
     .help = "unit of the accelerometer columns written; default: as read"},
    {"to-time-unit", OPTION_UNIT, AT(to.time_unit), .value = "UNIT",
     .help = "unit of the time column written; default: as read"},
    {"to-temperature-unit", OPTION_UNIT, AT(to.temperature_unit), .value = "UNIT",
     .help = "unit of the temperature column written; default: as read"},
    DECIMALS_OPTION(AT(decimals)),
    THREADS_OPTION(AT(threads), "threads to use; default: all processors"),
};

static const option motion_option_table[] = {
    {"to-point", OPTION_TEXT, AT(to_point), .value = "\"X Y Z UNIT\"",
     .help = "specific force at another point of the body, forward right down of the "
             "accelerometers, such as \"0.1 0 -0.05 m\""},
    {"gravity-free", OPTION_FLAG, AT(to.gravity_free),
     .help = "acceleration relative to the Earth instead of specific force; needs --latitude, and "
             "a unit that is at rest at the start"},
    {"still", OPTION_QUANTITY, AT(to.still), .value = "TIME", .unit = "s",
     .help = "time at rest at the start, to find roll and pitch; default 10s"},
    LATITUDE_OPTION(AT(to.latitude), "geodetic latitude, for gravity"),
    HEIGHT_OPTION(AT(to.height)),
    TURN_OPTION("yaw", AT(to.yaw),
                "heading at the start, from north to east, for the Earth's rotation; default 0deg"),
};

/* The kind of each end. An input name without an ending does not show the kind, so the content is
 * examined; a stream is examined only if a model is expected, because it has to be copied. An
 * output stream has the kind of the input. */
static void find_kinds(const char *in, const char *out, bool *from_model, bool *to_model)
{
    *to_model = imk_is_script_name(out);
    *from_model =
        *to_model || !command_is_stream(in) ? imk_model_recognise(in) : imk_is_script_name(in);
    *to_model = *to_model || (*from_model && command_is_stream(out));
}

/* The document is kept only within one format: JSON has no place for comments and layout. */
static int convert_model(const parameter_options *o, const char *in, const char *out)
{
    imk_error error;
    imk_document *document = NULL;
    imk_model *model = command_memory(NULL, sizeof *model);
    int code = command_model(in, model, &document);
    if (code < 0 && imk_model_write(out, model, document, &error) != IMK_OK)
        code = command_error(&error, NULL);
    imk_document_free(document);
    free(model);
    return code < 0 ? convert_show(o, IMK_PARAMETERS_UNKNOWN, in, out, NULL) : code;
}

static int parse_point(const char *text, double point[3])
{
    double sigma[3];
    size_t count;
    const imk_dimension length = imk_unit_of("m").dimension;
    if (imk_quantity_parse(text, text + strlen(text), length, 3, point, sigma, &count, NULL,
                           NULL) == IMK_OK &&
        count == 3)
        return -1;
    return command_misused("--to-point %s: expected three lengths with their unit, such as "
                           "\"0.1 0 -0.05 m\"",
                           text);
}

static int set_up(convert_options *o)
{
    o->to.to_point = o->to_point != NULL;
    int code = o->to_point ? parse_point(o->to_point, o->to.point.v) : -1;
    if (code < 0 && o->to.gravity_free && isnan(o->to.latitude))
        code = command_misused("--gravity-free: gravity depends on the place; add --latitude 45deg "
                               "and, away from sea level, --height 500m");
    return code;
}

/* Errors of an option or of the output; all other errors concern the log. */
static int tell(const char *in, const imk_findings *findings, imk_status status,
                const imk_error *error)
{
    const imk_finding *failure = status != IMK_OK ? imk_findings_failure(findings) : NULL;
    char text[400];
    if (failure && strcmp(failure->code, "not_written") == 0)
        return command_error(error, NULL);
    if (failure && strcmp(failure->code, "no_such_column") == 0) {
        imk_finding_text(failure, text, sizeof text);
        return command_failed_by(imk_finding_code(failure), error, in, "%s", text);
    }
    if (!failure && status == IMK_ERROR_DIMENSION)
        return command_misused("--to-%s %s: expected %s", error->field, error->found,
                               error->expected);
    if (!failure && status == IMK_ERROR_RANGE)
        return command_misused("--%s must be %s", error->field, error->expected);
    return log_input_tell(in, findings, status, error);
}

/* Columns and units are those of the format. */
static int set_up_euroc(convert_options *o, imk_log_sink *written)
{
    if (o->to.select || o->decimals.given || o->to.gyro_unit.scale > 0 ||
        o->to.accel_unit.scale > 0 || o->to.time_unit.scale > 0)
        return command_misused("--to euroc has its columns and units: leave --select, --decimals "
                               "and the options for units out");
    written->euroc = true;
    return -1;
}

enum { EUROC_COLUMNS = 7, EUROC_NAMES = EUROC_COLUMNS * (sizeof((imk_log_column *)0)->name + 1) };

/* The names of its columns in the log; the others are told. */
static int select_euroc(const imk_log_reader *reader, const char *in, char names[EUROC_NAMES])
{
    static const struct {
        imk_quantity quantity;
        int axis;
    } due[EUROC_COLUMNS] = {{IMK_QUANTITY_TIME, -1},          {IMK_QUANTITY_ANGULAR_RATE, 0},
                            {IMK_QUANTITY_ANGULAR_RATE, 1},   {IMK_QUANTITY_ANGULAR_RATE, 2},
                            {IMK_QUANTITY_SPECIFIC_FORCE, 0}, {IMK_QUANTITY_SPECIFIC_FORCE, 1},
                            {IMK_QUANTITY_SPECIFIC_FORCE, 2}};
    bool used[IMK_LOG_COLUMNS_MAX] = {false};
    size_t length = 0, lost = 0;
    for (size_t i = 0; i < EUROC_COLUMNS; i++) {
        const int column = imk_log_column_find(reader, due[i].quantity, due[i].axis);
        const char *lacking = due[i].quantity == IMK_QUANTITY_TIME           ? "a time"
                              : due[i].quantity == IMK_QUANTITY_ANGULAR_RATE ? "a gyro"
                                                                             : "an accelerometer";
        if (column < 0)
            return command_failed("%s: the EuRoC format has a time, three gyros and three "
                                  "accelerometers, and the log lacks %s; write a .csv without "
                                  "--to euroc",
                                  in, lacking);
        used[column] = true;
        length += (size_t)snprintf(names + length, EUROC_NAMES - length, "%s%s", i > 0 ? "," : "",
                                   imk_log_column_get(reader, (size_t)column)->name);
    }
    for (size_t i = 0; i < imk_log_column_count(reader); i++)
        lost += !used[i];
    for (size_t i = 0; i < imk_log_column_count(reader); i++)
        if (!used[i]) {
            command_warn("lost", "the EuRoC format has no place for %s%s: left out",
                         imk_log_column_get(reader, i)->name, lost > 1 ? " and other columns" : "");
            break;
        }
    return -1;
}

static int show_log(const convert_options *o, const char *in, const imk_log_sink *written)
{
    imk_result *result = show_begin("convert");
    imk_result_object(result, "inputs");
    convert_show_file(in, "log", result);
    imk_result_end(result);
    imk_result_object(result, "result");
    show_judge(result, "%s has %llu rows of %zu columns", written->path,
               (unsigned long long)written->rows, written->column_count);
    imk_show_file(written->path, written->rows, written->column_count, written->column, result);
    imk_result_end(result);
    return show_end(result, &(show_options){.json = o->parameters.json, .quiet = true}, EXIT_DONE);
}

static int convert_log(convert_options *o, const char *in, const char *out)
{
    imk_error error;
    imk_findings findings;
    imk_log_reader *reader = NULL;
    char names[EUROC_NAMES] = "";
    imk_log_sink written = {
        .path = out, .fixed = o->decimals.given, .decimals = (int)o->decimals.value};
    int code = set_up(o);
    if (code < 0 && o->parameters.to == CONVERT_TO_EUROC)
        code = set_up_euroc(o, &written);
    if (code < 0)
        code = log_input_open(&o->log, in, false, &reader);
    if (code < 0 && written.euroc) {
        code = select_euroc(reader, in, names);
        o->to.select = names;
    }
    if (code >= 0) {
        imk_log_close(reader);
        return code;
    }
    const imk_log_findings read = imk_log_findings_get(reader);
    written.origin = read.time_origin_nanoseconds;
    if (read.time_origin != 0 && !written.euroc && !imk_log_format_of(out)->keeps_epoch)
        command_note("time_origin", "the times count from %.3f s, which is 0 in what is written",
                     read.time_origin);
    threaded_job t;
    threaded_job_begin(&t, in, o->threads.value);
    const imk_record_source source = imk_log_source(reader);
    const imk_record_sink sink = imk_log_sink_of(&written);
    const imk_status status =
        imk_convert_log_run(&source, &o->to, &sink, &t.job, &findings, &error);
    threaded_job_end(&t);
    const imk_log_findings done = imk_log_findings_get(reader);
    if (status == IMK_OK && done.not_finite > 0)
        command_note("not_finite",
                     "%zu of %zu rows have a value that is missing or no finite number: it is "
                     "written as it is",
                     done.not_finite, done.rows);
    const imk_status ended = imk_log_sink_end(&written, status, &error);
    code = status == IMK_OK && ended != IMK_OK ? command_error(&error, NULL)
                                               : tell(in, &findings, ended, &error);
    imk_log_close(reader);
    return code < 0 ? show_log(o, in, &written) : code;
}

static int run(int count, char **words)
{
    convert_options o = {.to = imk_convert_log_default()};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&convert_verb, count, words, &o, operands);
    if (code >= 0)
        return code;
    operands[1] = options_output_name(operands[1]);
    bool wanted;
    if (o.parameters.json && strcmp(operands[1], "-") == 0)
        return command_misused("--json and the file would both go to standard output");
    code = parameters_wanted(&o.parameters, operands[0], imk_is_script_name(operands[1]), &wanted);
    if (code >= 0)
        return code;
    if (wanted)
        return convert_parameters(&o.parameters, o.log.file.rate, operands[0], operands[1]);
    if (o.parameters.sensor || o.parameters.density || o.parameters.use_bounds ||
        o.parameters.bias_instability_tau > 0 || o.parameters.frame_rate > 0)
        return command_misused("%s: --sensor, --density, --bias-instability-tau, "
                               "--use-bounds and --frame-rate are for parameter files; state the "
                               "format with --from or --to",
                               operands[0]);
    bool from_model, to_model;
    find_kinds(operands[0], operands[1], &from_model, &to_model);
    if (from_model != to_model)
        return command_misused("%s is a %s and %s a %s: a log and a model cannot become each "
                               "other; use identify or simulate",
                               operands[0], from_model ? "model" : "log", operands[1],
                               to_model ? "model" : "log");
    if (from_model && o.parameters.to == CONVERT_TO_EUROC)
        return command_misused("--to euroc is for logs, and %s is a model", operands[0]);
    if (from_model && (o.to_point || o.to.gravity_free))
        return command_misused("--to-point and --gravity-free are for logs, and %s is a model",
                               operands[0]);
    return from_model ? convert_model(&o.parameters, operands[0], operands[1])
                      : convert_log(&o, operands[0], operands[1]);
}

const verb convert_verb = {
    .name = "convert",
    .summary = "logs, models and parameter files between formats",
    .operands = "IN OUT",
    .operands_minimum = 2,
    .operands_maximum = 2,
    .last_is_written = true,
    .examples =
        {{"imukit convert raw.csv log.csv.zst --gyro-unit deg/s --accel-unit g",
          "a log without units becomes a log that states its units"},
         {"imukit convert model.yaml imu.yaml --to kalibr --rate 200Hz",
          "a model becomes a parameter file of another program; without --to a parameter file "
          "becomes a model"}},
    .description =
        "A log is .csv (also .gz, .zst){ or logs}; - is standard input or output, as CSV; with "
        "--to euroc it is written as in the EuRoC data set. "
        "Increments become rates. Values keep their units unless an option changes them.\n\nA "
        "model (.yaml, .yml, .json, or through a pipe) is converted between YAML and JSON. "
        "Parameter files of kalibr, gazebo (SDF), matlab (imuSensor), gnss-ins-sim, navego, "
        "openvins, vins, px4, ardupilot, lio-sam, fast-lio, dlio, glim, orb-slam3, gtsam, airsim "
        "and fusion are recognised by their content. Assumptions about "
        "units and densities, and values that a format cannot hold, are reported on standard "
        "error. docs/other-formats.md describes the formats.",
    .groups = {OPTION_GROUP("Options", convert_option_table, 0),
               {"Parameter files", PARAMETER_OPTIONS, parameter_option_table, AT(parameters)},
               OPTION_GROUP("Another point, without gravity", motion_option_table, 0),
               {"Reading the log", LOG_FORMAT_OPTIONS, log_input_options, AT(log)}},
    .run = run};
