/* SPDX-License-Identifier: Apache-2.0 */
/* Why nothing came out: what was found in the log, what is needed, what to do. A doubt about the
 * log, where there is one that explains it, says more than the procedure that stumbled. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

/* The first doubt that makes a log useless, as a message. @return -1 when there is none */
static int tell_doubt(const bench *b, const bench_log *log)
{
    for (size_t k = 0; k < log->doubt_count; k++) {
        const calibrate_sentence sentence = doubt_sentence(b, log, &log->doubt[k]);
        if (doubt_matters(log, &log->doubt[k]) && sentence.level == LEVEL_USELESS)
            return command_failed("%s: %s", log->path, sentence.text);
    }
    return -1;
}

/* Only rows with a temperature above 0 K count. */
static int few_temperatures(const bench_log *log, const imk_error *error)
{
    size_t cold = 0, none = 0;
    for (size_t row = 0; row < log->record.count; row++) {
        const double temperature = log->record.temperature[row];
        cold += temperature <= 0;
        none += !isfinite(temperature);
    }
    if ((double)(log->record.count - cold - none) >= error->limit)
        return command_error(error, log->path);
    return command_failed("%s: of %zu rows the temperature is 0 K or less in %zu and no number in "
                          "%zu; at least %g need one: check the column temperature and its unit "
                          "(--temperature-unit)",
                          log->path, log->record.count, cold, none, error->limit);
}

static int too_short(const bench_log *log, const imk_error *error)
{
    static const char *const things[] = {"hold", "turn", "step"};
    static const char *const many[] = {"holds", "turns", "steps of constant reference"};
    const char *name = imk_procedure_name(log->procedure);
    const char *due = error->expected;
    for (size_t k = 0; k < 3; k++)
        if (strcmp(error->field, things[k]) == 0)
            return command_failed("%s: %g of at least %g %s were found for %s%s%s", log->path,
                                  error->value, error->limit, many[k], name, due[0] ? ": " : "",
                                  due);
    if (strcmp(error->field, "temperature") == 0)
        return command_failed("%s: the temperature varies by %.3g K; at least %.3g K are needed to "
                              "see what it does",
                              log->path, error->value, error->limit);
    if (log->procedure == IMK_PROCEDURE_THERMAL && log->record.temperature)
        return few_temperatures(log, error);
    return command_error(error, log->path);
}

static int key_missing(const bench_log *log, const imk_error *error)
{
    const char *name = imk_procedure_name(log->procedure);
    if (strncmp(error->field, "reference", 9) == 0)
        return command_failed("%s: %s needs to know what the unit was exposed to%s%s: add --motion "
                              "PROGRAMME, or columns such as reference_rate_z [deg/s] and "
                              "reference_force_x [g] to the log",
                              log->path, name, error->expected[0] ? "; " : "", error->expected);
    if (strcmp(error->field, "temperature") == 0)
        return command_failed("%s has no column temperature [degC], which %s needs", log->path,
                              name);
    if (strcmp(error->field, "section") == 0)
        return command_failed("%s: %s needs a column of texts that names the sections: add "
                              "--section NAME",
                              log->path, name);
    return command_failed("%s: %s needs %s", log->path, name,
                          error->expected[0] ? error->expected : error->field);
}

static int unit_missing(const bench *b, const bench_log *log, const imk_error *error)
{
    const int sensor = strncmp(error->field, "gyro", 4) == 0 ? 0 : 1;
    return command_failed(
        "%s: the %s readings are counts, and %s does not tell how many make a unit: add "
        "--%s-sensitivity \"%s\" from the data sheet, or --model MODEL of an earlier calibration",
        log->path, sensor_titles[sensor],
        b->repeatability ? "repeatability" : imk_procedure_name(log->procedure),
        sensor_keys[sensor], sensor == 0 ? "4778 count/(rad/s)" : "415 count/(m/s^2)");
}

/* Columns without a single number, or rows. */
static int not_finite(const bench_log *log, const imk_error *error)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < log->record.axis_count[sensor]; axis++) {
            size_t row = 0;
            while (row < log->record.count && !isfinite(log->record.reading[sensor][axis][row]))
                row++;
            if (row == log->record.count)
                return command_failed("%s: %s_%c is never a number: nothing can be estimated from "
                                      "it; look into the log, or name the columns with --columns",
                                      log->path, sensor_keys[sensor], axis_letter(axis));
        }
    size_t first;
    const size_t missing = bench_rows_missing(&log->record, &first);
    if (missing > 0)
        return command_failed("%s: %.3g %% of its rows have an empty cell, or one that is no "
                              "number, in a gyro or accelerometer column, and no stretch between "
                              "them is long enough: log all sensors at one rate, or leave a sensor "
                              "out by --columns (- skips a column)",
                              log->path, 100 * (double)missing / (double)log->record.count);
    return command_error(error, log->path);
}

/* Readings that do not do what the reference does. */
static int not_following(const bench_log *log, const imk_error *error)
{
    const bool of_axis = error->index >= 0 &&
                         (strcmp(error->field, "gyro") == 0 || strcmp(error->field, "accel") == 0);
    if (!of_axis)
        return command_error(error, log->path);
    return command_failed("%s: %s_%c changes by %.3g times what the reference changes by, where 1 "
                          "is due: check the unit, the signs and the order of the axes, and that "
                          "the log and the programme are of the same test and begin together "
                          "(--motion-offset auto)",
                          log->path, error->field, axis_letter(error->index), error->value);
}

int bench_observe_failed(const bench *b, const bench_log *log, const imk_error *error)
{
    const int code = tell_doubt(b, log);
    if (code >= 0)
        return code;
    switch (error->status) {
    case IMK_ERROR_TOO_SHORT:
        return too_short(log, error);
    case IMK_ERROR_KEY_MISSING:
        return key_missing(log, error);
    case IMK_ERROR_UNIT_MISSING:
        return unit_missing(b, log, error);
    case IMK_ERROR_NOT_FINITE:
        return not_finite(log, error);
    case IMK_ERROR_CONFLICT:
        return not_following(log, error);
    default:
        return command_error(error, log->path);
    }
}

/* ---- solution -------------------------------------------------------------------------------- */

/* What would determine a parameter. */
static const char *remedy_for(const imk_model_parameter *parameter)
{
    switch (parameter->term) {
    case IMK_MODEL_BIAS:
        return "hold the unit with this axis both up and down";
    case IMK_MODEL_SCALE_FACTOR:
        return parameter->sensor == 0 ? "turn the unit about this axis, by 90 deg or more"
                                      : "hold the unit with this axis both up and down";
    case IMK_MODEL_MISALIGNMENT:
    case IMK_MODEL_CROSS_AXIS:
        return parameter->sensor == 0
                   ? "turn the unit about the other axis too"
                   : "hold the unit in poses between the axes too, such as on its edges";
    case IMK_MODEL_G_SENSITIVITY:
    case IMK_MODEL_G2_SENSITIVITY:
        return "hold the unit in more attitudes, each axis up and down, or leave it out: --without "
               "g_sensitivity,g2_sensitivity";
    case IMK_MODEL_LEVER_ARM:
        return "turn the unit fast about two axes at least";
    case IMK_MODEL_BIAS_TEMPERATURE:
    case IMK_MODEL_SCALE_TEMPERATURE:
    case IMK_MODEL_TEMPERATURE_RATE:
        return "sweep the temperature wider, or lower --temperature-order";
    default:
        return "apply more levels of it, of both signs, or leave it out: --without nonlinearity";
    }
}

static int undetermined(const bench *b, const imk_error *error)
{
    imk_model_parameter parameter;
    char poses[160] = "";
    if (imk_model_parameter_parse(error->field, &parameter) != IMK_OK)
        return command_error(error, NULL);
    const imk_triad *triad =
        parameter.sensor == 0 ? &b->calibration->model.gyro : &b->calibration->model.accel;
    if (triad->axis_count > 3 && !b->options->model && !b->options->into)
        return command_failed("the log has %d %s axes, and where they point is not known: add "
                              "--model MODEL that says so, as %s.direction",
                              triad->axis_count, sensor_titles[parameter.sensor],
                              sensor_keys[parameter.sensor]);
    if (b->log_count == 1 && b->log[0].procedure == IMK_PROCEDURE_MULTIPOSITION)
        bench_advise(b, &b->log[0], "; of further poses most would tell ", poses, sizeof poses);
    return command_failed("the logs do not determine %s: %s%s", error->field,
                          remedy_for(&parameter), poses);
}

int bench_solve_failed(const bench *b, const imk_error *error)
{
    for (size_t k = 0; k < b->log_count; k++) {
        const int code = tell_doubt(b, &b->log[k]);
        if (code >= 0)
            return code;
    }
    switch (error->status) {
    case IMK_ERROR_SINGULAR:
        return undetermined(b, error);
    case IMK_ERROR_UNIT_MISSING:
        return unit_missing(b, &b->log[0], error);
    case IMK_ERROR_TOO_SHORT:
        return command_failed("%g observations%s%s are too few, %g are needed: add poses or turns "
                              "that differ from those there are",
                              error->value, error->field[0] ? " of " : "", error->field,
                              error->limit);
    case IMK_ERROR_NO_CONVERGENCE:
        return command_failed("no set of parameters fits the logs: the estimate does not settle. "
                              "Check units (--accel-unit, --gyro-unit), --gravity, and that each "
                              "log is of the procedure named");
    case IMK_ERROR_NOT_FINITE:
        return command_failed("a reading that is no number came into the estimate%s%s: nothing is "
                              "estimated from it",
                              error->field[0] ? ", in " : "", error->field);
    case IMK_ERROR_CONFLICT:
        if (strcmp(error->field, "frame") == 0)
            return command_failed("--frame %s contradicts what is estimated: %s",
                                  imk_triad_frame_name(b->calibration->frame),
                                  error->expected[0] ? error->expected
                                                     : "name another frame, or other terms");
        return command_error(error, NULL);
    default:
        return command_error(error, NULL);
    }
}
