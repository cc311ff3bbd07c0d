/* SPDX-License-Identifier: Apache-2.0 */
/* Diagnostics of a log as messages: what was found, what is expected, and the option or the action
 * that mends it. */
#include "calibrate_message_internal.h"

#include "imukit/axes_mending.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A factor counts as seen when it is met to this part: placement and scale factors are well below,
 * and the factors asked for are farther apart. */
static const double factor_tolerance = 0.12;

/* Scale factors further from 1 are no sensor's. */
static const double scale_doubted = 0.1;
/* The same of a solution, in which the sensor may be one of the few: a doubt from here on. */
static const double scale_rare = 0.08;
/* Factor by which readings are off that are not those of what they are said to be. */
static const double scale_useless = 1.5;

imki_calibrate_message imki_calibrate_say(imk_finding_level level, const char *code,
                                          const char *format, ...)
{
    imki_calibrate_message message = {.level = level, .code = code};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message.text, sizeof message.text, format, arguments);
    va_end(arguments);
    return message;
}

void imki_calibrate_add(imk_verdict *v, imki_calibrate_message message)
{
    imki_verdict_add(v, message.level, message.code, "%s", message.text);
}

static bool is_near(double value, double due)
{
    return fabs(value / due - 1) < factor_tolerance;
}

/* As the header states it; "": it does not. */
static const char *unit_of_column(const imk_calibrate_record *log, int sensor)
{
    const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    const int column = imk_log_find(&log->log, kinds[sensor], 0);
    return column >= 0 ? log->log.column[column].unit.text : "";
}

static imki_calibrate_message gravity_unit(const imk_calibrate_log *b,
                                           const imk_calibrate_record *log, double force)
{
    /* |force| as it comes out where the column is in the second unit and read in the first. */
    static const struct {
        double ratio;
        const char *unit;
    } units[] = {{1 / 9.80665, "g"},     {1000 / 9.80665, "mg"}, {9.80665, "m/s^2"},
                 {9.80665e-3, "m/s^2"},  {1e-3, "m/s^2"},        {1e3, "mg"},
                 {1 / 0.3048, "ft/s^2"}, {1e6 / 9.80665, "ug"},  {1e-3 / 9.80665, "g"}};
    const char *found = unit_of_column(log, 1);
    const double ratio = force / b->calibration->gravity;
    for (size_t k = 0; k < sizeof units / sizeof units[0]; k++) {
        if (!is_near(ratio, units[k].ratio) || strcmp(found, units[k].unit) == 0)
            continue;
        if (strcmp(units[k].unit, "ft/s^2") == 0)
            return imki_calibrate_say(
                IMK_FINDING_FAILURE, "gravity_unit",
                "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns "
                "look like ft/s^2; multiply the readings by 0.3048",
                force, b->calibration->gravity);
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "gravity_unit",
            "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns look "
            "like %s, not %s; %s %s",
            force, b->calibration->gravity, units[k].unit, found[0] ? found : "m/s^2",
            found[0] ? "correct the unit in the header to" : "add --accel-unit", units[k].unit);
    }
    imki_text causes = {0};
    imki_scale_causes(b, 1, ratio, true, &causes);
    const imki_calibrate_message message = imki_calibrate_say(
        IMK_FINDING_FAILURE, "gravity_unit",
        "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: no usual unit explains "
        "the difference; it looks like %s; check the unit of the accelerometer columns; for "
        "raw counts, use the unit count and --accel-sensitivity",
        force, b->calibration->gravity, causes.bytes ? causes.bytes : "a wrong unit");
    free(causes.bytes);
    return message;
}

static imki_calibrate_message rate_unit(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                        double ratio)
{
    const double degrees = 57.29577951308232;
    const char *unit = is_near(ratio, degrees)       ? "deg/s"
                       : is_near(ratio, 1 / degrees) ? "rad/s"
                                                     : NULL;
    if (!unit) {
        imki_text causes = {0};
        imki_scale_causes(b, 0, ratio, true, &causes);
        const imki_calibrate_message message = imki_calibrate_say(
            IMK_FINDING_FAILURE, "rate_unit",
            "the gyros show rates %.4g times as large as they are; it looks like %s; check the "
            "unit of the gyro columns",
            ratio, causes.bytes ? causes.bytes : "a wrong unit");
        free(causes.bytes);
        return message;
    }
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "rate_unit",
        "the gyros show turns %.4g times as large as %s: the columns look like %s; %s %s", ratio,
        log->procedure == IMK_PROCEDURE_TURNS ? "stated" : "the accelerometers show", unit,
        unit_of_column(log, 0)[0] ? "correct the unit in the header to" : "add --gyro-unit", unit);
}

static imki_calibrate_message time_unit(const imk_calibrate_record *log, double factor)
{
    const char *unit = is_near(factor, 1e3)   ? "ms"
                       : is_near(factor, 1e6) ? "us"
                       : is_near(factor, 1e9) ? "ns"
                                              : NULL;
    const double rate = factor / log->record.dt;
    if (!unit)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "time_unit",
            "the times are about %.3g times too long for the turns that the gyros measured: "
            "check the unit of the time column",
            factor);
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "time_unit",
        "the samples are %.4g s apart, far too long for the turns that the gyros measured: "
        "the times look like %s; add --time-unit %s, or correct the header (the sampling "
        "rate is then %.4g Hz)",
        log->record.dt, unit, unit, rate);
}

static imki_calibrate_message few_poses(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                        const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const bool chosen = b->settings.estimate || b->settings.model;
    return imki_calibrate_say(
        b->result && chosen ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE, "few_poses",
        "the log has %g poses, %g or more are needed: keep the unit at rest for some seconds with "
        "each of its six faces down, and on the edges and corners between the faces%s",
        d->value, d->limit, poses);
}

static imki_calibrate_message one_cone(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                       const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const char axis = imk_axis_letter(d->axis);
    return imki_calibrate_say(
        b->result ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE, "one_plane",
        "the force of gravity along %c is nearly the same in all poses, so the bias of %c "
        "cannot be told from its scale factor: add poses with %c up, with %c down and with "
        "%c level%s",
        axis, axis, axis, axis, axis, poses);
}

static imki_calibrate_message one_plane(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                        const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const imk_finding_level level = b->result ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE;
    const char axis = imk_axis_letter(d->axis);
    if (d->axis >= 0 && b->nominal[1]) /* zero is not known: a plane or a cone */
        return one_cone(b, log, d);
    if (d->axis < 0)
        return imki_calibrate_say(
            level, "one_plane", "the poses all lie in one plane: add poses far out of this plane%s",
            poses);
    return imki_calibrate_say(
        level, "one_plane",
        "the poses all lie in one plane: gravity hardly ever acts along %c; add poses with "
        "%c up, with %c down and with %c at 45 deg%s",
        axis, axis, axis, axis, poses);
}

/* A solution is shown with it; without one it is why. */
static imki_calibrate_message scale(const imk_calibrate_log *b, const imk_diagnostic_finding *d)
{
    static const char *const codes[2] = {"gyro_scale", "accel_scale"};
    imki_calibrate_message m = {.level = IMK_FINDING_FAILURE, .code = codes[d->sensor == 1]};
    if (b->result && d->value > 1 / scale_useless && d->value < scale_useless)
        m.level = d->limit < scale_doubted && fabs(d->value - 1) < scale_rare ? IMK_FINDING_NOTE
                                                                              : IMK_FINDING_WARNING;
    imki_scale_text(b, d, m.text, sizeof m.text);
    return m;
}

/* Whole numbers in the unit of the file, of some size: counts, whatever the header says. */
static bool is_whole(const imk_calibrate_record *log, int sensor)
{
    enum { LOOKED_AT = 4096 };
    const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    const int column = imk_log_find(&log->log, kinds[sensor], 0);
    const double scale = column >= 0 ? log->log.column[column].unit.scale : 0;
    double largest = 0;
    for (int axis = 0; axis < log->record.axis_count[sensor]; axis++)
        for (size_t row = 0; row < log->record.count && row < LOOKED_AT; row++) {
            const double number = log->record.reading[sensor][axis][row] / scale;
            if (!isfinite(number))
                continue;
            if (fabs(number - round(number)) > 1e-9 * fmax(1, fabs(number)))
                return false;
            largest = fmax(largest, fabs(number));
        }
    return largest > 20;
}

static imki_calibrate_message never_static(const imk_calibrate_log *b,
                                           const imk_calibrate_record *log)
{
    for (int sensor = 1; sensor >= 0; sensor--)
        if (!log->record.counts[sensor] && is_whole(log, sensor))
            return imki_calibrate_say(
                IMK_FINDING_FAILURE, "counts",
                "no stationary interval is found, and the %s readings are whole numbers: if they "
                "are counts, not %s, write [count] into the header (or add --%s-unit count)",
                imki_sensor_titles[sensor], unit_of_column(log, sensor), imki_sensor_keys[sensor]);
    size_t first;
    const size_t missing = imk_test_record_missing(&log->record, &first);
    if (2 * missing > log->record.count)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "never_static",
            "no stationary interval is found: only %zu of %zu rows have a number in all "
            "columns (the first without is row %zu); check the log, or leave a column out "
            "with --columns (- skips a column)",
            log->record.count - missing, log->record.count, first + 1);
    if (!isnan(b->settings.minimum))
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "never_static",
            "the unit is never stationary for %.4g s, which --minimum requires: lower "
            "--minimum, or hold each pose longer",
            b->settings.minimum);
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "never_static",
        "the unit is never stationary for long enough: it is stationary in %.2g %% of the "
        "log, tested in windows of %.2g s; put the unit down for 3 s or more in each pose "
        "(a hand moves too much); if the unit was at rest at the beginning, add "
        "--initial-rest 10s, and the noise is estimated there%s",
        100 * log->stationary.standing, log->stationary.window,
        log->record.time ? "" : "; if --rate is too high, all rests look too short");
}

/* In words of the mendings, unless there is one of one mistake. */
static bool mended(const imk_diagnostic_finding *d, const char *code,
                   imki_calibrate_message *message)
{
    imk_axes_mending mending[IMK_AXES_MENDINGS_MAX];
    const size_t count = imk_axes_mendings(d->classes, mending);
    *message = (imki_calibrate_message){.level = IMK_FINDING_FAILURE, .code = code};
    if (count == 0 || (count == 1 && d->sensor >= 0))
        return false;
    (void)imki_axes_text(d->classes, true, message->text, sizeof message->text);
    return true;
}

static imki_calibrate_message swapped(const imk_diagnostic_finding *d)
{
    imki_calibrate_message message;
    if (mended(d, "swapped_axes", &message))
        return message;
    const char *sensor = d->sensor >= 0 ? imki_sensor_keys[d->sensor] : "gyro";
    if (d->axis < 0 || d->other < 0)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "swapped_axes",
            "the axes of gyros and accelerometers are in different orders: the turns that the "
            "gyros measure do not lead from one attitude of the accelerometers to the next; "
            "reorder the columns with --columns, so that x, y, z mean the same for both");
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "swapped_axes",
        "%s_%c and %s_%c look exchanged%s: the turns of the gyros lead from one attitude of "
        "the accelerometers to the next only when these two are exchanged back; exchange "
        "the two names, in the header or with --columns",
        sensor, imk_axis_letter(d->axis), sensor, imk_axis_letter(d->other),
        d->sensor >= 0 ? "" : " (or the same two accelerometers), and signs are changed");
}

static imki_calibrate_message left_handed(const imk_diagnostic_finding *d)
{
    imki_calibrate_message message;
    if (mended(d, "left_handed", &message))
        return message;
    if (d->axis < 0)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "left_handed",
            "all three gyros measure turns in the opposite direction to the accelerometers: "
            "change the sign of all gyro columns");
    const char *sensor = d->sensor == 1 ? "accel" : "gyro";
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "left_handed",
        "%s_%c has the wrong sign relative to the other axes: the axes are mirrored (left-handed), "
        "and the turns of the gyros lead from one attitude of the accelerometers to the next only "
        "with this sign changed; change the sign of this column in the log",
        sensor, imk_axis_letter(d->axis));
}

static imki_calibrate_message never_moves(const imk_calibrate_record *log)
{
    if (log->record.means)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "never_moves",
            "all rows are of one attitude: --pose-means needs a row for each of several "
            "attitudes; if the rows are the samples of a log, leave --pose-means out");
    if (log->interval_count > 1)
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "never_moves",
            "all %zu rests have the same attitude to gravity: a turn about the vertical "
            "(heading) changes nothing that accelerometers read. Put the unit on its other "
            "faces, edges and corners; to identify the noise of a unit that was not moved, use "
            "imukit identify",
            log->interval_count);
    return imki_calibrate_say(
        IMK_FINDING_FAILURE, "never_moves",
        "the unit is stationary in one pose all the time: turn the unit to other poses, "
        "and hold each for some seconds; to identify the noise of a log at rest, use "
        "imukit identify");
}

static imki_calibrate_message odd_turn(const imk_diagnostic_finding *d)
{
    imki_calibrate_message message = {.level = IMK_FINDING_WARNING, .code = "odd_turn"};
    (void)imki_axes_text(d->classes, false, message.text, sizeof message.text);
    return message;
}

imki_calibrate_message imki_message_on_log(const imk_calibrate_log *b,
                                           const imk_calibrate_record *log,
                                           const imk_diagnostic_finding *d)
{
    const char *sensor = d->sensor >= 0 ? imki_sensor_titles[d->sensor] : "sensor";
    switch (d->kind) {
    case IMK_DIAGNOSTIC_NEVER_STATIC:
        return never_static(b, log);
    case IMK_DIAGNOSTIC_NEVER_MOVES:
        return never_moves(log);
    case IMK_DIAGNOSTIC_FEW_POSES:
        return few_poses(b, log, d);
    case IMK_DIAGNOSTIC_ONE_PLANE:
        return one_plane(b, log, d);
    case IMK_DIAGNOSTIC_GRAVITY_UNIT:
        return gravity_unit(b, log, d->value);
    case IMK_DIAGNOSTIC_RATE_UNIT:
        return rate_unit(b, log, d->value);
    case IMK_DIAGNOSTIC_SATURATED:
        return imki_calibrate_say(
            IMK_FINDING_WARNING, "saturated",
            "%s %c is at the end of its range in %.3g %% of the log; the affected %s are left out: "
            "choose a larger range in the device, or %s; --%s-range writes the range into the "
            "model",
            sensor, imk_axis_letter(d->axis), 100 * d->value, d->sensor == 0 ? "turns" : "poses",
            d->sensor == 0 ? "turn more slowly" : "choose poses without this axis along gravity",
            imki_sensor_keys[d->sensor > 0]);
    case IMK_DIAGNOSTIC_COUNTS:
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "counts",
            "the %s readings are whole numbers, and in no usual unit do they equal gravity "
            "at rest: they look like counts; write [count] into the header (or add "
            "--%s-unit count) and, if you know the sensitivity, add --%s-sensitivity",
            sensor, imki_sensor_keys[d->sensor > 0], imki_sensor_keys[d->sensor > 0]);
    case IMK_DIAGNOSTIC_SWAPPED_AXES:
        return swapped(d);
    case IMK_DIAGNOSTIC_LEFT_HANDED:
        return left_handed(d);
    case IMK_DIAGNOSTIC_ODD_TURN:
        return odd_turn(d);
    case IMK_DIAGNOSTIC_TIME_UNIT:
        return time_unit(log, d->value);
    case IMK_DIAGNOSTIC_SCALE:
        return scale(b, d);
    case IMK_DIAGNOSTIC_ONE_CONE:
        return one_cone(b, log, d);
    default:
        return imki_calibrate_say(
            IMK_FINDING_FAILURE, "stuck",
            "%s %c never changes its reading: the axis is dead, or the column has the wrong "
            "name; check the device and the header",
            sensor, imk_axis_letter(d->axis));
    }
}
