/* SPDX-License-Identifier: Apache-2.0 */
/* Why nothing came out: what was found in the log, what is needed, what to do. A diagnostic about
 * the log, where there is one that explains it, says more than the procedure that stumbled. */
#include "calibrate_show_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Where the message goes. */
typedef struct message {
    char *text;
    size_t size;
} message;

static size_t say(const message *to, const char *format, ...) __attribute__((format(printf, 2, 3)));

static size_t say(const message *to, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(to->text, to->size, format, arguments);
    va_end(arguments);
    return length > 0 ? (size_t)length : 0;
}

/* Only rows with a temperature above 0 K count. */
static size_t few_temperatures(const message *to, const imk_calibrate_record *log,
                               const imk_error *error)
{
    size_t cold = 0, none = 0;
    for (size_t row = 0; row < log->record.count; row++) {
        const double temperature = log->record.temperature[row];
        cold += temperature <= 0;
        none += !isfinite(temperature);
    }
    if ((double)(log->record.count - cold - none) >= error->limit)
        return 0;
    return say(to,
               "%s: of %zu rows, %zu have a temperature of 0 K or less and %zu have no number; at "
               "least %g rows need a valid temperature: check the column temperature and its unit "
               "(--temperature-unit)",
               log->path, log->record.count, cold, none, error->limit);
}

/* Holds are missing, and some were there that were not taken. */
static size_t without_lost(const message *to, const imk_calibrate_record *log,
                           const imk_error *error)
{
    char list[700];
    imki_lost_text(log, list, sizeof list);
    return say(to,
               "%s: %s needs at least %g holds, found %g; %zu more look%s like %s, but cannot be "
               "used: %s; repeat %s%s%s",
               log->path, imk_procedure_name(log->procedure), error->limit, error->value,
               log->lost_count, log->lost_count == 1 ? "s" : "",
               log->lost_count == 1 ? "one" : "holds", list, log->lost_count == 1 ? "it" : "them",
               error->expected[0] ? ", or " : "", error->expected);
}

static size_t too_short(const message *to, const imk_calibrate_record *log, const imk_error *error)
{
    static const char *const things[] = {"hold", "turn", "step"};
    static const char *const many[] = {"holds", "turns", "steps of constant reference"};
    const char *name = imk_procedure_name(log->procedure);
    const char *due = error->expected;
    if (strcmp(error->field, "hold") == 0 && log->lost_count > 0)
        return without_lost(to, log, error);
    for (size_t k = 0; k < 3; k++)
        if (strcmp(error->field, things[k]) == 0)
            return say(to, "%s: %s needs at least %g %s, found %g%s%s", log->path, name,
                       error->limit, error->limit > 1 ? many[k] : things[k], error->value,
                       due[0] ? ": " : "", due);
    if (strcmp(error->field, "samples") == 0 && !log->record.means &&
        imk_procedure_takes_means(log->procedure) && imk_calibrate_looks_like_means(log))
        return say(to,
                   "%s has %zu rows, and most are in another attitude than the row before: if each "
                   "row is the mean of a pose at rest, add --pose-means; a log needs %g samples",
                   log->path, log->record.count, error->limit);
    if (strcmp(error->field, "temperature") == 0)
        return say(to,
                   "%s: the temperature varies by %.3g K; at least %.3g K are needed to estimate "
                   "its effect",
                   log->path, error->value, error->limit);
    if (log->procedure == IMK_PROCEDURE_THERMAL && log->record.temperature)
        return few_temperatures(to, log, error);
    return 0;
}

static size_t key_missing(const message *to, const imk_calibrate_record *log,
                          const imk_error *error)
{
    const char *name = imk_procedure_name(log->procedure);
    const bool also = error->expected[0] && log->procedure == IMK_PROCEDURE_SPIN;
    if (log->record.means && strncmp(error->field, "reference", 9) == 0)
        return say(to,
                   "%s: %s needs the force that acted on the unit in each pose: add columns "
                   "reference_force_x [g] and so on to the table",
                   log->path, name);
    if (strncmp(error->field, "reference", 9) == 0)
        return say(
            to,
            "%s: %s needs the rates or forces that acted on the unit%s%s: add --motion PROGRAMME, "
            "or add columns such as reference_rate_z [deg/s] and reference_force_x [g] to the log",
            log->path, name, also ? "; " : "", also ? error->expected : "");
    if (strcmp(error->field, "temperature") == 0)
        return say(to, "%s has no column temperature [degC], which %s needs", log->path, name);
    if (strcmp(error->field, "section") == 0)
        return say(to,
                   "%s: %s needs a column of texts that names the sections: add "
                   "--section NAME",
                   log->path, name);
    const bool of_reference =
        log->procedure == IMK_PROCEDURE_RATE_TABLE || log->procedure == IMK_PROCEDURE_SPIN;
    for (int sensor = 0; sensor < 2 && of_reference; sensor++)
        if (strcmp(error->field, imki_sensor_keys[sensor]) == 0)
            return say(to,
                       "%s: %s needs %s readings, which the log does not have: log them, or name "
                       "their columns with --columns",
                       log->path, name, imki_sensor_titles[sensor]);
    return say(to, "%s: %s needs %s", log->path, name,
               error->expected[0] ? error->expected : error->field);
}

static size_t unit_missing(const message *to, const imk_calibrate_log *b,
                           const imk_calibrate_record *log, const imk_error *error)
{
    const int sensor = strncmp(error->field, "gyro", 4) == 0 ? 0 : 1;
    return say(
        to,
        "%s: the %s readings are counts, and %s cannot determine the counts per unit: add "
        "--%s-sensitivity \"%s\" from the data sheet, or --model MODEL of an earlier calibration",
        log->path, imki_sensor_titles[sensor],
        b->settings.repeatability ? "repeatability" : imk_procedure_name(log->procedure),
        imki_sensor_keys[sensor], sensor == 0 ? "4778 count/(rad/s)" : "415 count/(m/s^2)");
}

/* Columns without a single number, or rows. */
static size_t not_finite(const message *to, const imk_calibrate_record *log)
{
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < log->record.axis_count[sensor]; axis++) {
            size_t row = 0;
            while (row < log->record.count && !isfinite(log->record.reading[sensor][axis][row]))
                row++;
            if (row == log->record.count)
                return say(to,
                           "%s: %s_%c never has a number: nothing can be estimated from this "
                           "column; check the log, or name the columns with --columns",
                           log->path, imki_sensor_keys[sensor],
                           imk_axis_letter(log->body_axis[sensor][axis]));
        }
    size_t first;
    const size_t missing = imk_test_record_missing(&log->record, &first);
    if (missing > 0)
        return say(
            to,
            "%s: %.3g %% of the rows have an empty cell, or a cell that is not a number, in a gyro "
            "or accelerometer column, and no stretch between these rows is long enough: log all "
            "sensors at one rate, or leave a sensor out with --columns (- skips a column)",
            log->path, 100 * (double)missing / (double)log->record.count);
    return 0;
}

/* Readings that do not do what the reference does. */
static size_t not_following(const message *to, const imk_calibrate_record *log,
                            const imk_error *error)
{
    const bool of_axis = error->index >= 0 &&
                         (strcmp(error->field, "gyro") == 0 || strcmp(error->field, "accel") == 0);
    if (!of_axis)
        return 0;
    return say(to,
               "%s: %s_%c changes by %.3g times the change of the reference, but 1 is expected: "
               "check the unit, the signs and the order of the axes, and that the log and the "
               "programme are of the same test and begin together (--motion-offset auto)",
               log->path, error->field, imk_axis_letter(error->index), error->value);
}

/* Labels of faces that the readings do not show. */
static size_t wrong_labels(const message *to, const imk_calibrate_record *log,
                           const imk_error *error)
{
    const bool up = error->index % 2 == 0;
    const char axis = imk_axis_letter(error->index / 2);
    return say(to,
               "%s: the label %s contradicts the readings (%g of %g labels do): accel_%c reads "
               "gravity there, with a %s sign (%c is %s); %s",
               log->path, error->found, error->value, error->limit, axis,
               up ? "positive" : "negative", axis, up ? "up" : "down", error->expected);
}

static size_t of_record(const message *to, const imk_calibrate_log *b,
                        const imk_calibrate_record *log, const imk_error *error)
{
    if (imki_calibrate_useless(b, log, to->text, to->size))
        return strlen(to->text);
    switch (error->status) {
    case IMK_ERROR_TOO_SHORT:
        return too_short(to, log, error);
    case IMK_ERROR_KEY_MISSING:
        return key_missing(to, log, error);
    case IMK_ERROR_UNIT_MISSING:
        return unit_missing(to, b, log, error);
    case IMK_ERROR_NOT_FINITE:
        return not_finite(to, log);
    case IMK_ERROR_CONFLICT:
        if (strcmp(error->field, "section") == 0 && error->index >= 0)
            return wrong_labels(to, log, error);
        return not_following(to, log, error);
    default:
        return 0;
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
        return "hold the unit in more attitudes, each axis up and down, or leave these terms out: "
               "--without g_sensitivity,g2_sensitivity";
    case IMK_MODEL_LEVER_ARM:
        return "turn the unit fast about at least two axes";
    case IMK_MODEL_BIAS_TEMPERATURE:
    case IMK_MODEL_SCALE_TEMPERATURE:
    case IMK_MODEL_TEMPERATURE_RATE:
        return "sweep a wider range of temperature, or lower --temperature-order";
    default:
        return "apply more levels of the input, of both signs, or leave the term out: --without "
               "nonlinearity";
    }
}

static size_t undetermined(const message *to, const imk_calibrate_log *b, const imk_error *error)
{
    imk_model_parameter parameter;
    char poses[160] = "";
    if (imk_model_parameter_parse(error->field, &parameter) != IMK_OK)
        return 0;
    const imk_triad *triad = imk_model_triad(&b->calibration->model, parameter.sensor);
    if (triad->axis_count > 3 && !b->settings.model)
        return say(to,
                   "the log has %d %s axes, and their directions are not known: add --model MODEL "
                   "with the directions as %s.direction",
                   triad->axis_count, imki_sensor_titles[parameter.sensor],
                   imki_sensor_keys[parameter.sensor]);
    const imk_calibrate_record *log = b->count == 1 ? b->record : NULL;
    if (log && log->procedure == IMK_PROCEDURE_MULTIPOSITION)
        imki_calibrate_poses(b, log, "; the most informative further poses are ", poses,
                             sizeof poses);
    return say(to, "the logs do not determine %s: %s%s", error->field, remedy_for(&parameter),
               poses);
}

static size_t of_solution(const message *to, const imk_calibrate_log *b, const imk_error *error)
{
    for (size_t k = 0; k < b->count; k++)
        if (imki_calibrate_useless(b, &b->record[k], to->text, to->size))
            return strlen(to->text);
    switch (error->status) {
    case IMK_ERROR_SINGULAR:
        return undetermined(to, b, error);
    case IMK_ERROR_UNIT_MISSING:
        return unit_missing(to, b, &b->record[0], error);
    case IMK_ERROR_TOO_SHORT:
        return say(to,
                   "%g observations%s%s are too few, %g are needed: add poses or turns that differ "
                   "from the present ones",
                   error->value, error->field[0] ? " of " : "", error->field, error->limit);
    case IMK_ERROR_NO_CONVERGENCE:
        return say(
            to,
            "the iteration found no parameters that fit the logs: check the units (--accel-unit, "
            "--gyro-unit), --gravity, and that each log is of the procedure named");
    case IMK_ERROR_NOT_FINITE:
        return say(to,
                   "a reading that is not a number entered the estimate%s%s: nothing is estimated; "
                   "check the log",
                   error->field[0] ? ", in " : "", error->field);
    case IMK_ERROR_CONFLICT:
        if (strcmp(error->field, "frame") == 0)
            return say(to, "--frame %s contradicts the terms that are estimated: %s",
                       imk_triad_frame_name(b->calibration->frame),
                       error->expected[0] ? error->expected : "name another frame, or other terms");
        return 0;
    default:
        return 0;
    }
}

size_t imk_calibrate_failure(const imk_calibrate_log *b, const imk_error *error, char *text,
                             size_t size)
{
    const message to = {text, size};
    const imk_finding *finding = imk_findings_failure(&b->findings);
    const imk_calibrate_record *log = b->failed < b->count ? &b->record[b->failed] : NULL;
    if (!finding && log)
        finding = imk_findings_failure(&log->loaded);
    if (finding)
        return imk_finding_message(finding, log ? log->path : NULL, "the model", text, size);
    if (b->settings.repeatability && error->status != IMK_ERROR_UNIT_MISSING)
        return 0;
    return log ? of_record(&to, b, log, error) : of_solution(&to, b, error);
}
