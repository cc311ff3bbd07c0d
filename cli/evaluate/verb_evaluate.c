/* SPDX-License-Identifier: Apache-2.0 */
/* imukit evaluate: references and readings -> the figures of a test laboratory. */
#include "evaluate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(evaluate_options, member)

static const option result_options[] = {
    {"limit", 0, A_TEXT("LIMITS"), AT(limit),
     "hold figures against limits, such as \"linearity 0.05 %, zero 0.2 deg/s\": a column says "
     "which are met"},
    {"report", 0, AN_OUTPUT("FILE.html"), AT(report),
     "write a test report that can be printed: figures, plots, definitions, levels"},
    {"plot", 0, AN_OUTPUT("FILE.svg|.png|.pdf|term"), AT(plot),
     "draw the deviations from both lines, and the hysteresis loop"},
    {"levels", 0, A_FLAG, AT(levels), "print the mean readings of every level"},
    {"confidence", 0, A_FRACTION("FRACTION", CONFIDENCE_RANGE), AT(confidence),
     "of intervals, and of the coverage; default 0.95"},
    {"json", 0, A_FLAG, AT(json), "print the result as JSON instead of tables"},
    {"strict", 0, A_FLAG, AT(strict),
     "exit with 1 when a limit is not met, or there is another warning"},
    {"unit", 0, A_TEXT("TEXT"), AT(unit), "for the report: what was tested"},
    {"serial", 0, A_TEXT("TEXT"), AT(serial), "its serial number"},
    {"operator", 0, A_TEXT("TEXT"), AT(operator_name), "who tested it"},
    {"laboratory", 0, A_TEXT("TEXT"), AT(laboratory), "where"},
    {"date", 0, A_TEXT("TEXT"), AT(date), "when; never filled in by itself"},
    {"at-temperature", 0, A_TEXT("TEXT"), AT(temperature), "at which temperature"},
};

static const option test_options[] = {
    {"static", 0, AN_INPUT("LOG"), AT(rest),
     "log of the unit at rest: bias instability, fitted and by the Allan minimum"},
    {"full-scale", 0, A_TEXT("QUANTITY"), AT(full_scale),
     "what % of full scale is of, such as \"300 deg/s\"; default: the largest reference"},
    {"sensitivity", 0, A_TEXT("QUANTITY"), AT(sensitivity),
     "nominal, of readings in counts, such as \"131 count/(deg/s)\": figures are then in the unit "
     "of the reference, with accuracy"},
    {"zero", 0, A_TEXT("QUANTITY"), AT(zero), "counts at zero, such as \"32768 count\""},
    {"level-width", 0, A_TEXT("QUANTITY"), AT(level_width),
     "references not further apart are one level; default 1e-5 of full scale in logs, 0 in tables"},
    {"motion", 0, AN_INPUT("PROGRAMME"), AT(bench.motion),
     "motion file that the table ran: the reference of a log"},
    {"motion-offset", 0, A_TEXT("TIME|auto"), AT(bench.motion_offset),
     "time of the log at which the programme begins; auto finds it; default 0s"},
    {"table-axis", 0, A_CHOICE("AXIS", "x|y|z"), AT(bench.table_axis),
     "of the unit, about which a column table_rate [deg/s] turns it"},
    {"section", 0, A_TEXT("COLUMN"), AT(bench.section),
     "column of texts that names the runs of a log"},
    {"minimum", 0, A_QUANTITY("TIME", "s", "positive"), AT(bench.minimum),
     "shortest stretch of constant reference that counts; default 0.5s"},
    {"trim", 0, A_QUANTITY("TIME", "s", "not negative"), AT(bench.trim),
     "left out at both ends of a stretch; default 0.2s"},
    {"settle", 0, A_QUANTITY("TIME", "s", "not negative"), AT(bench.settle),
     "left out at its beginning besides, until filters have settled; default 0s"},
};

static int run(int count, char **words);

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
        "FILE is a table, CSV with the columns reference and reading (or several: reading_x …) "
        "with "
        "their units, and if there are such: direction (up, down; else inferred from the order), "
        "run (power cycles), sigma; or a log of a sensor with what it was exposed to: columns "
        "reference_rate_x [deg/s] …, reference_force_x [g] …, table_rate [deg/s] with "
        "--table-axis, "
        "or --motion. Every stretch of constant reference of a log is a reading. Each file is a "
        "run.\n\n"
        "Every figure comes with an interval. How large the noise is follows from repeated "
        "readings of one reference, reached from the same side: take each level twice or more. "
        "docs/evaluate.md has the definitions.",
    .groups = {{A_GROUP("Options", result_options), 0},
               {A_GROUP("The test", test_options), 0},
               {A_GROUP("Reading logs", log_input_options), AT(bench.log)}},
    .run = run};

/* ---- quantities that need the channel's unit ------------------------------------------------- */

/* A quantity of an option; untouched when it was not given. */
static int read_quantity(const char *name, const char *text, imk_dimension dimension, double *value)
{
    imk_error error;
    double sigma, found;
    size_t count;
    char sentence[400];
    if (!text)
        return -1;
    if (imk_quantity_parse(text, text + strlen(text), dimension, 1, &found, &sigma, &count, NULL,
                           &error) != IMK_OK) {
        imk_error_text(&error, NULL, sentence, sizeof sentence);
        return command_misused("--%s: %s", name, sentence);
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
    const evaluate_options *o = v->options;
    const struct {
        const char *name;
        bool given;
    } of_logs[] = {{"motion", o->bench.motion != NULL},
                   {"motion-offset", o->bench.motion_offset != NULL},
                   {"table-axis", o->bench.table_axis >= 0},
                   {"section", o->bench.section != NULL}};
    bool counts = false;
    for (size_t k = 0; k < v->channel_count; k++)
        counts = counts || in_counts(&v->channel[k]);
    if (o->sensitivity && !counts)
        return command_misused("--sensitivity is of readings in counts, and there are none");
    if (o->zero && !o->sensitivity)
        return command_misused("--zero is of --sensitivity: add it");
    if (o->bench.motion_offset && !o->bench.motion)
        return command_misused("--motion-offset is of --motion: add it");
    for (size_t k = 0; k < sizeof of_logs / sizeof of_logs[0]; k++)
        if (of_logs[k].given && !v->has_log)
            return command_misused("--%s is of logs, and there are tables only", of_logs[k].name);
    return -1;
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
    for (size_t k = 0; code < 0 && k < c->count; k++) {
        c->reading[k] = (c->reading[k] - zero) / sensitivity;
        c->sigma[k] /= sensitivity;
    }
    if (code < 0)
        c->reading_unit = c->reference_unit;
    return code;
}

static int prepare(const evaluate_options *o, imk_evaluate_channel *c)
{
    double largest = 0;
    c->settings = imk_evaluation_default();
    c->settings.confidence = o->confidence;
    int code = apply_sensitivity(o, c);
    c->settings.same_unit =
        imk_dimension_equal(c->reading_unit.dimension, c->reference_unit.dimension);
    for (size_t k = 0; k < c->count; k++)
        largest = fmax(largest, fabs(c->reference[k]));
    const imk_dimension dimension = c->reference_unit.dimension;
    if (code < 0)
        code = read_quantity("full-scale", o->full_scale, dimension, &c->settings.full_scale);
    if (c->of_log)
        c->settings.level_width = 1e-5 * largest;
    if (code < 0)
        code = read_quantity("level-width", o->level_width, dimension, &c->settings.level_width);
    return code;
}

/* ---- from end to end ------------------------------------------------------------------------- */

static bool all_known(size_t count, const double *sigma)
{
    for (size_t k = 0; k < count; k++)
        if (!isfinite(sigma[k]))
            return false;
    return true;
}

static bool any_direction(const imk_evaluate_channel *c)
{
    for (size_t k = 0; k < c->count; k++)
        if (c->direction[k] != 0)
            return true;
    return false;
}

static int evaluate_channel_table(const evaluate_options *o, imk_evaluate_channel *c)
{
    imk_error error;
    int code = prepare(o, c);
    if (code >= 0)
        return code;
    const imk_evaluation_table table = {.count = c->count,
                                        .reference = c->reference,
                                        .reading = c->reading,
                                        .sigma = all_known(c->count, c->sigma) ? c->sigma : NULL,
                                        .direction = any_direction(c) ? c->direction : NULL,
                                        .run = c->run};
    const size_t size = imk_evaluation_workspace_size(&table);
    void *workspace = command_memory(NULL, size);
    c->level = command_memory(NULL, c->count * sizeof *c->level);
    const imk_status status =
        imk_evaluate(&table, &c->settings, workspace, size, c->level, c->count, &c->result, &error);
    free(workspace);
    if (status != IMK_OK)
        return command_error(&error, c->name);
    imk_evaluate_channel_figures(c);
    return -1;
}

static int show(const evaluation *v)
{
    const evaluate_options *o = v->options;
    const int end =
        o->strict && (v->missed || command_warning_count() > 0) ? EXIT_FAILED : EXIT_DONE;
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
                                      .channel_count = v->channel_count,
                                      .rest_count = v->rest_count,
                                      .limit_count = v->limit_count,
                                      .channel = v->channel,
                                      .rest = v->rest};
    imk_show_evaluate(&shown, result);
    show_origin(result);
    const show_options options = {
        .report = o->report,
        .plot = o->plot,
        .json = o->json,
        .lacking = v->channel_count == 0 ? "a table or a log with a reference" : NULL};
    return show_end(result, &options, end);
}

static int evaluate(evaluation *v)
{
    int code = evaluate_read_limits(v);
    if (code < 0)
        code = evaluate_load(v);
    if (code < 0)
        code = evaluate_load_rest(v);
    if (code < 0)
        code = check_company(v);
    for (size_t k = 0; code < 0 && k < v->channel_count; k++)
        code = evaluate_channel_table(v->options, &v->channel[k]);
    if (code < 0)
        code = evaluate_check_limits(v);
    return code < 0 ? show(v) : code;
}

static void free_evaluation(evaluation *v)
{
    for (size_t k = 0; k < v->channel_count; k++) {
        imk_evaluate_channel *c = &v->channel[k];
        free(c->reference);
        free(c->reading);
        free(c->sigma);
        free(c->direction);
        free(c->run);
        free(c->level);
    }
    imk_motion_file_free(v->motion);
    free(v);
}

static int run(int count, char **words)
{
    const double none = (double)NAN;
    evaluate_options o = {
        .confidence = 0.95,
        .bench = {.minimum = none, .trim = none, .settle = none, .table_axis = -1}};
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
    free_evaluation(v);
    return code;
}
