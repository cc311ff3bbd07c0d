/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate: log + model -> log without the errors the model describes. Rows are corrected
 * as they are read; the memory does not depend on the length of the log. */
#include "compensate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const option compensate_option_table[] = {
    {"output", 'o', OPTION_OUTPUT, "LOG", NULL, NULL,
     "where to write: .csv (also .gz, .zst) or .npy; - (the default) is standard output",
     offsetof(compensate_options, output)},
    {"temperature", 0, OPTION_QUANTITY, "TEMPERATURE", "degC", NULL,
     "of the unit, for a log without such a column; overrules one",
     offsetof(compensate_options, temperature)},
    {"temperature-time", 0, OPTION_QUANTITY, "TIME", "s", NULL,
     "over which the rate of temperature is smoothed, where the model needs it; default 30s",
     offsetof(compensate_options, temperature_time)},
    {"powered-for", 0, OPTION_QUANTITY, "TIME", "s", NULL,
     "how long the unit was on before the first row, for warm-up; default 0s",
     offsetof(compensate_options, powered_for)},
    {"rate-limit", 0, OPTION_QUANTITY, "RATE", "deg/s", "positive",
     "largest rate, where the model has nonlinear terms and no range",
     offsetof(compensate_options, rate_limit)},
    {"force-limit", 0, OPTION_QUANTITY, "FORCE", "g", "positive",
     "largest specific force, likewise", offsetof(compensate_options, force_limit)},
    {"to-gyro-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "of the rates written; default: as read, rad/s for counts",
     offsetof(compensate_options, to_gyro_unit)},
    {"to-accel-unit", 0, OPTION_TEXT, "UNIT", NULL, NULL,
     "of the forces written; default: as read, m/s^2 for counts",
     offsetof(compensate_options, to_accel_unit)},
    {"decimals", 0, OPTION_INTEGER, "N", NULL, "0-17",
     "digits after the point, 0 to 17; default: as many as the number needs",
     offsetof(compensate_options, decimals)},
    {"flags", 0, OPTION_FLAG, NULL, NULL, NULL,
     "add a column of flags: 1 saturated, 2 temperature, 4 limit, 8 not finite, 16 acceleration",
     offsetof(compensate_options, flags)},
    {"strict", 0, OPTION_FLAG, NULL, NULL, NULL, "exit with 1 when there is a warning",
     offsetof(compensate_options, strict)},
    {"json", 0, OPTION_FLAG, NULL, NULL, NULL,
     "print the summary as JSON; the log goes to a file then", offsetof(compensate_options, json)},
    {"threads", 0, OPTION_INTEGER, "N", NULL, "1-65536",
     "threads to use; default: all processors. The bytes do not depend on it",
     offsetof(compensate_options, threads)},
};

static int run(int count, char **words);

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
        "LOG is CSV (also .gz, .zst) or .npy; - is standard input. MODEL is a model file or a name "
        "from `imukit devices`. Gyro and accel columns become angular rate and specific force of "
        "the body; other columns are copied.\n\nThe deterministic terms are taken out: bias with "
        "temperature and warm-up, scale factor, nonlinearity, misalignment, cross-axis and "
        "g-sensitivity, lever arms, counts. Noise, hysteresis, repeatability and bandwidth stay, "
        "because a model knows their size and not their course.\n\nWith lever arms, the angular "
        "acceleration is the central difference of the rates. A gap in time begins anew.\n\nWith "
        "--emit-c and no LOG, the correction is written as C99 code without loops, heap or libm. "
        "Lever arms, warm-up and the rate of temperature stay in there.",
    .groups = {{"Options", sizeof compensate_option_table / sizeof compensate_option_table[0],
                compensate_option_table, 0},
               {"Code for a device", COMPENSATE_EMIT_OPTIONS, compensate_emit_options,
                offsetof(compensate_options, emission)},
               {"Terms", TERM_OPTIONS, term_options, offsetof(compensate_options, terms)},
               {"Reading the log", LOG_FORMAT_OPTIONS, log_input_options,
                offsetof(compensate_options, log)}},
    .run = run};

/* What can be said before the log is read. */
static int check_model(const compensate_options *o, const compensation *c)
{
    char term[64];
    const bool needs = compensate_temperature_term(&c->model, term, sizeof term);
    if (needs && c->columns.temperature < 0 && isnan(o->temperature))
        return command_failed("%s depends on temperature (%s) and %s has no temperature column: "
                              "add --temperature 25degC",
                              c->name, term, c->log);
    if (needs && isnan(o->temperature)) {
        const imk_log_column *column =
            imk_log_column_get(c->reader, (size_t)c->columns.temperature);
        if (imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension))
            return command_failed("%s depends on temperature (%s), which %s has in counts only: "
                                  "add --temperature 25degC",
                                  c->name, term, c->log);
    }
    if (c->model.residual_of[0])
        command_warn("residual", "%s is what is left after compensating with %s: do that first",
                     c->name, c->model.residual_of);
    if (compensate_taken_out(&c->model).count == 0)
        command_warn("nothing", "%s has no deterministic term%s: there is nothing to take out",
                     c->name, o->terms.only || o->terms.without ? " of those selected" : "");
    return -1;
}

static int compensate(const compensate_options *o, compensation *c)
{
    imk_error error;
    imk_log_settings settings = log_input_settings(&o->log);
    int code = command_model(c->name, &c->whole, NULL);
    if (code >= 0)
        return code;
    c->model = c->whole;
    code = compensate_select(o, &c->model);
    if (code >= 0)
        return code;
    if (imk_log_open(c->log, &settings, &c->reader, &error) != IMK_OK)
        return command_log_error(&error, c->log);
    code = compensate_match(o, c->reader, c->log, c->name, &c->model, &c->columns);
    if (code < 0)
        code = check_model(o, c);
    if (code < 0)
        code = compensate_stream(o, c);
    if (code < 0) {
        imk_result *result = show_begin("compensate");
        compensate_warn(&c->counts);
        compensate_show(c, result);
        code = compensate_end(o, result);
    }
    imk_log_close(c->reader);
    return code;
}

static int check(const compensate_options *o)
{
    if (o->json && !o->emission.directory && (!o->output || strcmp(o->output, "-") == 0))
        return command_misused("--json and the log cannot both go to standard output: add -o LOG");
    if (!isnan(o->temperature) && !(o->temperature >= 0))
        return command_misused("--temperature is below absolute zero");
    if (!(o->temperature_time > 0))
        return command_misused("--temperature-time must be positive");
    if (!(o->powered_for >= 0))
        return command_misused("--powered-for must not be negative");
    return -1;
}

static int run(int count, char **words)
{
    compensate_options o = {
        .temperature = (double)NAN, .temperature_time = 30, .emission = {.vectors = {.value = 64}}};
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
    compensation *c = command_zeroed(sizeof *c);
    c->log = operands[0];
    c->name = operands[1];
    code = compensate(&o, c);
    free(c);
    return code;
}
