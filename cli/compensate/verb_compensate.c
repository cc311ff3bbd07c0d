/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate: log + model -> log without the errors the model describes. */
#include "compensate_parts.h"
#include "shell/job_progress.h"

#include "imukit/show.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(field) offsetof(compensate_options, field)

static const option compensate_option_table[] = {
    {"output", OPTION_OUTPUT, AT(output), .letter = 'o', .value = "LOG",
     .help =
         "where to write: .csv (also .gz, .zst){ or written}; - (the default) is standard output"},
    {"temperature", OPTION_QUANTITY, AT(settings.temperature), .value = "TEMPERATURE",
     .unit = "degC",
     .help = "temperature of the unit, for a log without a temperature column; if there is one, it "
             "is ignored"},
    {"temperature-time", OPTION_QUANTITY, AT(settings.temperature_time), .value = "TIME",
     .unit = "s",
     .help = "time over which the rate of temperature is smoothed, where the model needs it; "
             "default 30s"},
    {"powered-for", OPTION_QUANTITY, AT(settings.powered_for), .value = "TIME", .unit = "s",
     .help = "how long the unit was on before the first row, for warm-up; default 0s"},
    {"rate-limit", OPTION_QUANTITY, AT(settings.rate_limit), .value = "RATE", .unit = "deg/s",
     .choices = "positive", .help = "largest rate, if the model has nonlinear terms but no range"},
    {"force-limit", OPTION_QUANTITY, AT(settings.force_limit), .value = "FORCE", .unit = "g",
     .choices = "positive", .help = "largest specific force, in the same case"},
    {"to-gyro-unit", OPTION_UNIT, AT(settings.gyro_unit), .value = "UNIT", .unit = "rad/s",
     .help = "unit of the rates written; default: as read, rad/s for counts"},
    {"to-accel-unit", OPTION_UNIT, AT(settings.accel_unit), .value = "UNIT", .unit = "m/s^2",
     .help = "unit of the forces written; default: as read, m/s^2 for counts"},
    DECIMALS_OPTION(AT(decimals)),
    {"flags", OPTION_FLAG, AT(settings.flags),
     .help = "add a column of flags: 1 saturated, 2 temperature, 4 limit, 8 not finite, 16 "
             "acceleration"},
    STRICT_OPTION(AT(strict), "exit with 1 when there is a warning"),
    JSON_OPTION(AT(json), "print the summary as JSON; the log must go to a file"),
    THREADS_OPTION(AT(threads),
                   "threads to use; default: all processors. The bytes do not depend on it"),
};

int compensate_models(const compensate_options *o, const char *name, imk_model *whole,
                      imk_model *terms)
{
    int code = command_model(name, whole, NULL);
    if (code >= 0)
        return code;
    *terms = *whole;
    code = term_selection_apply(&o->terms, terms);
    imk_compensation_model(whole, terms);
    return code;
}

int compensate_end(const compensate_options *o, imk_result *result)
{
    const int code = o->strict && told_warnings() > 0 ? EXIT_FAILED : EXIT_DONE;
    if (!o->json)
        show_aside(result);
    return show_end(result, &(show_options){.json = o->json, .quiet = true}, code);
}

/* Errors of the model or of the output; all other errors concern the log. */
static int tell(const char *const *operands, const imk_compensate_log *log, imk_status status,
                const imk_error *error)
{
    const imk_findings none = {.count = 0}, *findings = log ? &log->findings : &none;
    const imk_finding *failure = imk_findings_failure(findings);
    char text[400];
    log_input_note(operands[0], findings);
    if (failure && strcmp(failure->code, "compensate:axes_of_counts") == 0) {
        imk_finding_text(failure, text, sizeof text);
        return command_misused("%s", text);
    }
    if (failure && strcmp(failure->code, "model_refused") == 0)
        return command_error(error, operands[1]);
    if (failure && strcmp(failure->code, "not_written") == 0)
        return command_error(error, NULL);
    return log_input_tell_model(operands[0], operands[1], findings, status, error);
}

static int compensate(const compensate_options *o, const char *const *operands,
                      imk_log_reader *reader, const imk_model *whole)
{
    const imk_compensate_log_settings *settings = &o->settings;
    imk_error error;
    imk_log_sink written = {.path = o->output ? o->output : "-",
                            .fixed = o->decimals.given,
                            .decimals = (int)o->decimals.value};
    const imk_record_source source = imk_log_source(reader);
    const imk_record_sink sink = imk_log_sink_of(&written);
    threaded_job t;
    threaded_job_begin(&t, operands[0], o->threads.value);
    imk_compensate_log *log;
    const imk_status status =
        imk_compensate_log_run(&source, whole, settings, &sink, &t.job, &log, &error);
    threaded_job_end(&t);
    const imk_status ended = imk_log_sink_end(&written, status, &error);
    int code = status == IMK_OK && ended != IMK_OK ? command_error(&error, NULL)
                                                   : tell(operands, log, ended, &error);
    if (code < 0) {
        imk_result *result = show_begin("compensate");
        imk_show_compensate_log(log, operands[0], operands[1], result);
        code = compensate_end(o, result);
    }
    imk_compensate_log_free(log);
    return code;
}

static int check(const compensate_options *o)
{
    if (o->json && !o->emission.directory && (!o->output || strcmp(o->output, "-") == 0))
        return command_misused("--json and the log cannot both go to standard output: add -o LOG");
    if (!isnan(o->settings.temperature) && !(o->settings.temperature >= 0))
        return command_misused("--temperature is below absolute zero");
    if (!(o->settings.temperature_time > 0))
        return command_misused("--temperature-time must be positive");
    if (!(o->settings.powered_for >= 0))
        return command_misused("--powered-for must not be negative");
    return -1;
}

static int run(int count, char **words)
{
    compensate_options o = {.settings = imk_compensate_log_default(),
                            .emission = {.vectors = {.value = 64}}};
    const char *operands[OPERANDS_MAX];
    int code = options_parse(&compensate_verb, count, words, &o, operands);
    if (code < 0)
        code = check(&o);
    if (code >= 0)
        return code;
    if (o.emission.directory)
        return compensate_emit(&o, operands);
    if (!operands[1])
        return command_misused("an operand is missing: imukit compensate LOG MODEL");
    imk_log_reader *reader = NULL;
    imk_model *models = command_memory(NULL, 2 * sizeof *models);
    code = compensate_models(&o, operands[1], &models[0], &models[1]);
    if (o.terms.only || o.terms.without)
        o.settings.terms = &models[1];
    if (code < 0)
        code = log_input_open(&o.log, operands[0], false, &reader);
    if (code < 0)
        code = compensate(&o, operands, reader, &models[0]);
    imk_log_close(reader);
    free(models);
    return code;
}

const verb compensate_verb = {
    .name = "compensate",
    .summary = "log + model -> log without the errors the model describes; model -> C code",
    .operands = "[LOG] MODEL",
    .operands_minimum = 1,
    .operands_maximum = 2,
    .examples = {{"imukit compensate raw.csv unit.yaml -o clean.csv",
                  "biases, scale factors, misalignment and whatever else the model has are taken "
                  "out"},
                 {"imukit compensate unit.yaml --emit-c firmware",
                  "the same for a device: C99 code for one sample, with its error bound and a "
                  "self-test"}},
    .description =
        "LOG is CSV (also .gz, .zst){ or logs}; - is standard input. MODEL is a model file or a "
        "name from `imukit devices`. Gyro and accel columns become angular rate and specific force "
        "of the body; other columns are copied.\n\nThe deterministic terms are taken out: bias "
        "with temperature and warm-up, scale factor, nonlinearity, misalignment, cross-axis and "
        "g-sensitivity, lever arms, counts. Noise, hysteresis, repeatability and bandwidth stay, "
        "because a model states their size, not their course.\n\nWith lever arms, the angular "
        "acceleration is the central difference of the rates. The correction starts anew after a "
        "gap in time.\n\nWith --emit-c and no LOG, the correction is written as C99 code without "
        "loops, heap or libm. This code does not correct lever arms, warm-up and the rate of "
        "temperature.",
    .groups = {OPTION_GROUP("Options", compensate_option_table, 0),
               {"Code for a device", COMPENSATE_EMIT_OPTIONS, compensate_emit_options,
                AT(emission)},
               {"Terms", TERM_OPTIONS, term_options, AT(terms)},
               {"Reading the log", LOG_FORMAT_OPTIONS, log_input_options, AT(log)}},
    .run = run};
