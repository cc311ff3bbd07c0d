/* SPDX-License-Identifier: Apache-2.0 */
/* imukit evaluate: references and readings -> the figures of a test laboratory. */
#include "evaluate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(evaluate_options, field)
#define SESSION(field) AT(session.field)

static const option result_options[] = {
    {"limit", OPTION_TEXT, AT(limit), .value = "LIMITS",
     .help = "compare figures with limits, such as \"linearity 0.05 %, zero 0.2 deg/s\"; a column "
             "says which are met"},
    REPORT_OPTION(AT(report),
                  "write a test report that can be printed: figures, plots, definitions, levels"),
    PLOT_OPTION(AT(plot), "draw the deviations from both lines, and the hysteresis loop"),
    {"levels", OPTION_FLAG, AT(levels), .help = "print the mean readings of every level"},
    CONFIDENCE_OPTION(AT(confidence), "of intervals, and of the coverage; default 0.95"),
    JSON_OPTION(AT(json), "print the result as JSON instead of tables"),
    STRICT_OPTION(AT(strict), "exit with 1 when a limit is not met, or there is another warning"),
    {"unit", OPTION_TEXT, AT(unit), .value = "TEXT", .help = "for the report: what was tested"},
    {"serial", OPTION_TEXT, AT(serial), .value = "TEXT", .help = "its serial number"},
    {"operator", OPTION_TEXT, AT(operator_name), .value = "TEXT", .help = "who tested it"},
    {"laboratory", OPTION_TEXT, AT(laboratory), .value = "TEXT", .help = "where"},
    {"date", OPTION_TEXT, AT(date), .value = "TEXT", .help = "when; never filled in automatically"},
    {"at-temperature", OPTION_TEXT, AT(temperature), .value = "TEXT",
     .help = "at which temperature"},
};

static const option test_options[] = {
    {"static", OPTION_FILE, AT(rest), .value = "LOG",
     .help = "log of the unit at rest, for the bias instability: fitted, and by the Allan minimum"},
    {"full-scale", OPTION_TEXT, AT(full_scale), .value = "QUANTITY",
     .help =
         "full scale, to which % refers, such as \"300 deg/s\"; default: the largest reference"},
    {"sensitivity", OPTION_TEXT, AT(sensitivity), .value = "QUANTITY",
     .help = "nominal sensitivity of readings in counts, such as \"131 count/(deg/s)\": figures "
             "are then in the unit of the reference, with accuracy"},
    {"zero", OPTION_TEXT, AT(zero), .value = "QUANTITY",
     .help = "counts at zero, such as \"32768 count\""},
    {"level-width", OPTION_TEXT, AT(level_width), .value = "QUANTITY",
     .help = "references at most this far apart are one level; default 1e-5 of full scale in logs, "
             "0 in tables"},
    {"motion", OPTION_FILE, SESSION(motion), .value = "PROGRAMME",
     .help = "motion file that the table ran: the reference of a log"},
    {"motion-offset", OPTION_TEXT, SESSION(motion_offset), .value = "TIME|auto",
     .help = "time of the log at which the programme begins; auto finds it; default 0s"},
    {"table-axis", OPTION_CHOICE, SESSION(settings.table_axis), .value = "AXIS", .choices = "x|y|z",
     .help = "axis of the unit about which the column table_rate [deg/s] turns the unit"},
    {"section", OPTION_TEXT, SESSION(settings.section), .value = "COLUMN",
     .help = "column of texts that names the runs of a log"},
    {"keep-delay", OPTION_FLAG, AT(keep_delay),
     .help = "do not move a reference that comes later or earlier than the readings"},
    {"minimum", OPTION_QUANTITY, SESSION(settings.minimum), .value = "TIME", .unit = "s",
     .choices = "positive",
     .help = "shortest stretch of constant reference that counts; default 0.5s"},
    {"trim", OPTION_QUANTITY, SESSION(settings.trim), .value = "TIME", .unit = "s",
     .choices = "not negative", .help = "time left out at both ends of a stretch; default 0.2s"},
    {"settle", OPTION_QUANTITY, SESSION(settings.settle), .value = "TIME", .unit = "s",
     .choices = "not negative",
     .help = "time also left out at the beginning of a stretch, until filters have settled; "
             "default 0s"},
};

#define COUNT(table) (sizeof(table) / sizeof *(table))

/* ---- quantities that need the channel's unit ------------------------------------------------- */

/* A quantity of an option; untouched when it was not given. */
static int read_quantity(const char *name, const char *text, imk_dimension dimension, double *value)
{
    imk_error error;
    double sigma, found;
    size_t count;
    char message[400];
    if (!text)
        return -1;
    if (imk_quantity_parse(text, text + strlen(text), dimension, 1, &found, &sigma, &count, NULL,
                           &error) != IMK_OK) {
        imk_error_text(&error, NULL, message, sizeof message);
        return command_misused("--%s: %s", name, message);
    }
    if (!(found > 0) && strcmp(name, "zero") != 0)
        return command_misused("--%s %s: expected a quantity above 0", name, text);
    *value = found;
    return -1;
}

static bool in_counts(const imk_evaluate_channel *c)
{
    return imk_dimension_equal(c->reading_unit.dimension, imk_unit_of("count").dimension);
}

/* Options of counts and of logs mean nothing without them. */
static int check_company(const evaluation *v)
{
    static const imk_motion unread = {0}; /* of --motion, which is read where a log asks for it */
    const evaluate_options *o = v->options;
    imk_calibrate_log_settings given = o->session.settings;
    imk_error error;
    bool counts = false;
    for (size_t k = 0; k < v->log->channel_count; k++)
        counts = counts || in_counts(&v->log->channel[k]);
    if (o->sensitivity && !counts)
        return command_misused(
            "--sensitivity is for readings in counts, and there are none: leave --sensitivity out");
    if (o->zero && !o->sensitivity)
        return command_misused("--zero is used with --sensitivity only: add --sensitivity");
    if (o->session.motion_offset && !o->session.motion)
        return command_misused("--motion-offset is used with --motion only: add --motion");
    given.motion = o->session.motion ? &unread : NULL;
    if (imk_evaluate_check_used(v->log, &given, &error) == IMK_OK)
        return -1;
    for (char *c = error.field; *c; c++)
        *c = *c == '_' ? '-' : *c;
    return command_misused("--%s %s: %s", error.field, error.found, error.expected);
}

/* Counts become what they stand for. */
static int apply_sensitivity(const evaluate_options *o, imk_evaluate_channel *c)
{
    const imk_dimension counts = imk_unit_of("count").dimension;
    imk_dimension dimension = counts;
    double sensitivity = 0, zero = 0;
    if (!o->sensitivity || !in_counts(c))
        return -1;
    for (int k = 0; k < 7; k++)
        dimension.half[k] = (int8_t)(dimension.half[k] - c->reference_unit.dimension.half[k]);
    int code = read_quantity("sensitivity", o->sensitivity, dimension, &sensitivity);
    if (code < 0)
        code = read_quantity("zero", o->zero, counts, &zero);
    if (code < 0)
        imk_evaluate_scale(c, sensitivity, zero);
    return code;
}

static int evaluate_channel(const evaluation *v, imk_evaluate_channel *c)
{
    const evaluate_options *o = v->options;
    const imk_dimension dimension = c->reference_unit.dimension;
    imk_error error;
    int code = apply_sensitivity(o, c);
    imk_evaluate_channel_settings(v->log, c);
    if (code < 0)
        code = read_quantity("full-scale", o->full_scale, dimension, &c->settings.full_scale);
    if (code < 0)
        code = read_quantity("level-width", o->level_width, dimension, &c->settings.level_width);
    if (code < 0 && imk_evaluate_channel_run(v->log, c, &error) != IMK_OK)
        code = command_error(&error, c->name);
    return code;
}

/* ---- from end to end ------------------------------------------------------------------------- */

static int show(const evaluation *v)
{
    const evaluate_options *o = v->options;
    const int end = o->strict && (v->missed || told_warnings() > 0) ? EXIT_FAILED : EXIT_DONE;
    imk_result *result = show_begin("evaluate");
    const imk_evaluate_shown shown = {.confidence = o->confidence,
                                      .path_count = v->path_count,
                                      .path = v->path,
                                      .rest_path = o->rest,
                                      .unit = o->unit,
                                      .serial = o->serial,
                                      .operator_name = o->operator_name,
                                      .laboratory = o->laboratory,
                                      .date = o->date,
                                      .temperature = o->temperature,
                                      .report = o->report,
                                      .levels = o->levels,
                                      .missed = v->missed,
                                      .channel_count = v->log->channel_count,
                                      .rest_count = v->log->rest_count,
                                      .limit_count = v->limit_count,
                                      .channel = v->log->channel,
                                      .rest = v->log->rest,
                                      .findings = &v->log->findings};
    imk_show_evaluate(&shown, result);
    show_origin(result);
    const show_options options = {
        .report = o->report,
        .plot = o->plot,
        .json = o->json,
        .lacking = v->log->channel_count == 0 ? "a table or a log with a reference" : NULL};
    return show_end(result, &options, end);
}

static int evaluate(evaluation *v)
{
    const calibrate_options *logs = &v->options->session;
    imk_evaluate_log_settings settings = imk_evaluate_log_default();
    settings.confidence = v->options->confidence;
    settings.minimum = logs->settings.minimum;
    settings.trim = logs->settings.trim;
    settings.settle = logs->settings.settle;
    settings.sections = logs->settings.section != NULL;
    settings.keep_delay = v->options->keep_delay;
    (void)command_unless_memory(imk_evaluate_log_create(&settings, NULL, &v->log, NULL));
    int code = evaluate_read_limits(v);
    if (code < 0)
        code = evaluate_load(v);
    if (code < 0)
        code = evaluate_load_rest(v);
    if (code < 0)
        code = check_company(v);
    for (size_t k = 0; code < 0 && k < v->log->channel_count; k++)
        code = evaluate_channel(v, &v->log->channel[k]);
    if (code < 0)
        code = evaluate_check_limits(v);
    return code < 0 ? show(v) : code;
}

static int run(int count, char **words)
{
    evaluate_options o = {.confidence = 0.95, .session = {.settings = imk_calibrate_log_default()}};
    evaluation *v = command_zeroed(sizeof *v);
    v->options = &o;
    int code = options_parse(&evaluate_verb, count, words, &o, v->path);
    if (code < 0)
        code = command_check_plot(o.plot);
    while (v->path_count < IMK_EVALUATION_RUNS_MAX && v->path[v->path_count])
        v->path_count++;
    if (code < 0 && v->path_count == 0 && !o.rest)
        code = command_misused("an operand is missing: imukit evaluate FILE..., or --static LOG");
    if (code < 0)
        code = evaluate(v);
    imk_evaluate_log_free(v->log);
    imk_motion_file_free(v->motion);
    free(v);
    return code;
}

const verb evaluate_verb = {
    .name = "evaluate",
    .summary = "references and readings -> linearity, hysteresis, resolution, report",
    .operands = "FILE...",
    .operands_minimum = 0,
    .operands_maximum = IMK_EVALUATION_RUNS_MAX,
    .all_are_evidence = true,
    .examples = {{"imukit evaluate table.csv --limit \"linearity 0.05 %\" --report report.html",
                  "a table with the columns reference [deg/s] and reading [deg/s], in the order "
                  "taken"},
                 {"imukit evaluate steps.csv --motion programme.yaml --static rest.csv --plot "
                  "deviations.svg",
                  "a log of a rate table that ran the programme, and one at rest"}},
    .description =
        "FILE is a table or a log. A table is CSV with the columns reference and reading (or "
        "several: reading_x …) with their units; it may have the columns direction (up, down; else "
        "inferred from the order), run (power cycles) and sigma. A log of a sensor needs its "
        "reference: columns reference_rate_x [deg/s] …, reference_force_x [g] …, table_rate "
        "[deg/s] with --table-axis, or --motion. Every stretch of constant reference of a log is a "
        "reading. Each file is a run.\n\nEvery figure has an interval. The noise is estimated from "
        "repeated readings of one reference, reached from the same side: take each level twice or "
        "more. docs/evaluate.md has the definitions.",
    .groups = {{"Options", COUNT(result_options), result_options, 0},
               {"The test", COUNT(test_options), test_options, 0},
               {"Reading logs", LOG_INPUT_OPTIONS, log_input_options, SESSION(log)}},
    .run = run};
