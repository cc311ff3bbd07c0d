/* SPDX-License-Identifier: Apache-2.0 */
/* Diagnostics as messages: what was found, what is expected, and the option or the action that
 * mends it; and what diagnostics, the findings over temperature and the warnings add up to. */
#include "calibrate_show_internal.h"

#include "imukit/axes_mending.h"
#include "imukit/distributions.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A factor counts as seen when it is met to this part: placement and scale factors are well below,
 * and the factors asked for are farther apart. */
static const double factor_tolerance = 0.12;

/* Residuals this far above the noise are not a trembling hand: the model is another one. Sound logs
 * of real units turned by hand have 1 to 5. */
static const double residual_alarm = 10;

/* Scale factors further from 1 are no sensor's. */
static const double scale_doubted = 0.1;

/* A message of the verdict. */
typedef struct calibrate_message {
    imk_finding_level level;
    const char *code;
    char text[1200];
} calibrate_message;

static calibrate_message say(imk_finding_level level, const char *code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static calibrate_message say(imk_finding_level level, const char *code, const char *format, ...)
{
    calibrate_message message = {.level = level, .code = code};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message.text, sizeof message.text, format, arguments);
    va_end(arguments);
    return message;
}

static bool is_near(double value, double due)
{
    return fabs(value / due - 1) < factor_tolerance;
}

/* ---- on a log -------------------------------------------------------------------------------- */

/* Worth a look only where holds are looked for. */
static bool diagnostic_matters(const imk_calibrate_record *log,
                               const imk_diagnostic_finding *diagnostic)
{
    const bool looks_for_holds = log->procedure == IMK_PROCEDURE_MULTIPOSITION;
    const bool takes_holds = looks_for_holds || log->procedure == IMK_PROCEDURE_SIXPOSITION;
    switch (diagnostic->kind) {
    case IMK_DIAGNOSTIC_NEVER_STATIC:
        return takes_holds || log->procedure == IMK_PROCEDURE_THERMAL;
    case IMK_DIAGNOSTIC_NEVER_MOVES:
        return takes_holds;
    case IMK_DIAGNOSTIC_FEW_POSES:
    case IMK_DIAGNOSTIC_ONE_PLANE:
    case IMK_DIAGNOSTIC_ONE_CONE:
        return looks_for_holds;
    default:
        return true;
    }
}

/* As the header states it; "": it does not. */
static const char *unit_of_column(const imk_calibrate_record *log, int sensor)
{
    const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    const int column = imk_log_find(&log->log, kinds[sensor], 0);
    return column >= 0 ? log->log.column[column].unit.text : "";
}

static calibrate_message gravity_unit(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                      double force)
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
            return say(IMK_FINDING_FAILURE, "gravity_unit",
                       "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns "
                       "look like ft/s^2; multiply the readings by 0.3048",
                       force, b->calibration->gravity);
        return say(IMK_FINDING_FAILURE, "gravity_unit",
                   "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns look "
                   "like %s, not %s; %s %s",
                   force, b->calibration->gravity, units[k].unit, found[0] ? found : "m/s^2",
                   found[0] ? "correct the unit in the header to" : "add --accel-unit",
                   units[k].unit);
    }
    imki_text causes = {0};
    imki_scale_causes(b, 1, ratio, true, &causes);
    const calibrate_message message =
        say(IMK_FINDING_FAILURE, "gravity_unit",
            "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: no usual unit explains "
            "the difference; it looks like %s; check the unit of the accelerometer columns; for "
            "raw counts, use the unit count and --accel-sensitivity",
            force, b->calibration->gravity, causes.bytes ? causes.bytes : "a wrong unit");
    free(causes.bytes);
    return message;
}

static calibrate_message rate_unit(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                   double ratio)
{
    const double degrees = 57.29577951308232;
    const char *unit = is_near(ratio, degrees)       ? "deg/s"
                       : is_near(ratio, 1 / degrees) ? "rad/s"
                                                     : NULL;
    if (!unit) {
        imki_text causes = {0};
        imki_scale_causes(b, 0, ratio, true, &causes);
        const calibrate_message message =
            say(IMK_FINDING_FAILURE, "rate_unit",
                "the gyros show rates %.4g times as large as they are; it looks like %s; check the "
                "unit of the gyro columns",
                ratio, causes.bytes ? causes.bytes : "a wrong unit");
        free(causes.bytes);
        return message;
    }
    return say(IMK_FINDING_FAILURE, "rate_unit",
               "the gyros show turns %.4g times as large as the accelerometers show: the columns "
               "look like %s; %s %s",
               ratio, unit,
               unit_of_column(log, 0)[0] ? "correct the unit in the header to" : "add --gyro-unit",
               unit);
}

static calibrate_message time_unit(const imk_calibrate_record *log, double factor)
{
    const char *unit = is_near(factor, 1e3)   ? "ms"
                       : is_near(factor, 1e6) ? "us"
                       : is_near(factor, 1e9) ? "ns"
                                              : NULL;
    const double rate = factor / log->record.dt;
    if (!unit)
        return say(IMK_FINDING_FAILURE, "time_unit",
                   "the times are about %.3g times too long for the turns that the gyros measured: "
                   "check the unit of the time column",
                   factor);
    return say(IMK_FINDING_FAILURE, "time_unit",
               "the samples are %.4g s apart, far too long for the turns that the gyros measured: "
               "the times look like %s; add --time-unit %s, or correct the header (the sampling "
               "rate is then %.4g Hz)",
               log->record.dt, unit, unit, rate);
}

static calibrate_message few_poses(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                   const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const bool chosen = b->settings.estimate || b->settings.model;
    return say(
        b->result && chosen ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE, "few_poses",
        "the log has %g poses, %g or more are needed: keep the unit at rest for some seconds with "
        "each of its six faces down, and on the edges and corners between the faces%s",
        d->value, d->limit, poses);
}

static calibrate_message one_cone(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                  const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const char axis = imk_axis_letter(d->axis);
    return say(b->result ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE, "one_plane",
               "the force of gravity along %c is nearly the same in all poses, so the bias of %c "
               "cannot be told from its scale factor: add poses with %c up, with %c down and with "
               "%c level%s",
               axis, axis, axis, axis, axis, poses);
}

static calibrate_message one_plane(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                   const imk_diagnostic_finding *d)
{
    char poses[160];
    imki_calibrate_poses(b, log, "; the most informative further poses are ", poses, sizeof poses);
    const imk_finding_level level = b->result ? IMK_FINDING_WARNING : IMK_FINDING_FAILURE;
    const char axis = imk_axis_letter(d->axis);
    if (d->axis >= 0 && b->nominal[1]) /* zero is not known: a plane or a cone */
        return one_cone(b, log, d);
    if (d->axis < 0)
        return say(level, "one_plane",
                   "the poses all lie in one plane: add poses far out of this plane%s", poses);
    return say(level, "one_plane",
               "the poses all lie in one plane: gravity hardly ever acts along %c; add poses with "
               "%c up, with %c down and with %c at 45 deg%s",
               axis, axis, axis, axis, poses);
}

/* A solution is shown with it; without one it is why. */
static calibrate_message scale(const imk_calibrate_log *b, const imk_diagnostic_finding *d)
{
    static const char *const codes[2] = {"gyro_scale", "accel_scale"};
    calibrate_message m = {.level = IMK_FINDING_FAILURE, .code = codes[d->sensor == 1]};
    if (b->result)
        m.level = d->limit < scale_doubted ? IMK_FINDING_NOTE : IMK_FINDING_WARNING;
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

static calibrate_message never_static(const imk_calibrate_log *b, const imk_calibrate_record *log)
{
    for (int sensor = 1; sensor >= 0; sensor--)
        if (!log->record.counts[sensor] && is_whole(log, sensor))
            return say(
                IMK_FINDING_FAILURE, "counts",
                "no stationary interval is found, and the %s readings are whole numbers: if they "
                "are counts, not %s, write [count] into the header (or add --%s-unit count)",
                imki_sensor_titles[sensor], unit_of_column(log, sensor), imki_sensor_keys[sensor]);
    size_t first;
    const size_t missing = imk_test_record_missing(&log->record, &first);
    if (2 * missing > log->record.count)
        return say(IMK_FINDING_FAILURE, "never_static",
                   "no stationary interval is found: only %zu of %zu rows have a number in all "
                   "columns (the first without is row %zu); check the log, or leave a column out "
                   "with --columns (- skips a column)",
                   log->record.count - missing, log->record.count, first + 1);
    if (!isnan(b->settings.minimum))
        return say(IMK_FINDING_FAILURE, "never_static",
                   "the unit is never stationary for %.4g s, which --minimum requires: lower "
                   "--minimum, or hold each pose longer",
                   b->settings.minimum);
    return say(IMK_FINDING_FAILURE, "never_static",
               "the unit is never stationary for long enough: it is stationary in %.2g %% of the "
               "log, tested in windows of %.2g s; put the unit down for 3 s or more in each pose "
               "(a hand moves too much); if the unit was at rest at the beginning, add "
               "--initial-rest 10s, and the noise is estimated there%s",
               100 * log->stationary.standing, log->stationary.window,
               log->record.time ? "" : "; if --rate is too high, all rests look too short");
}

/* In words of the mendings, unless there is one of one mistake. */
static bool mended(const imk_diagnostic_finding *d, const char *code, calibrate_message *message)
{
    imk_axes_mending mending[IMK_AXES_MENDINGS_MAX];
    const size_t count = imk_axes_mendings(d->classes, mending);
    *message = (calibrate_message){.level = IMK_FINDING_FAILURE, .code = code};
    if (count == 0 || (count == 1 && d->sensor >= 0))
        return false;
    (void)imki_axes_text(d->classes, message->text, sizeof message->text);
    return true;
}

static calibrate_message swapped(const imk_diagnostic_finding *d)
{
    calibrate_message message;
    if (mended(d, "swapped_axes", &message))
        return message;
    const char *sensor = d->sensor >= 0 ? imki_sensor_keys[d->sensor] : "gyro";
    if (d->axis < 0 || d->other < 0)
        return say(
            IMK_FINDING_FAILURE, "swapped_axes",
            "the axes of gyros and accelerometers are in different orders: the turns that the "
            "gyros measure do not lead from one attitude of the accelerometers to the next; "
            "reorder the columns with --columns, so that x, y, z mean the same for both");
    return say(IMK_FINDING_FAILURE, "swapped_axes",
               "%s_%c and %s_%c look exchanged%s: the turns of the gyros lead from one attitude of "
               "the accelerometers to the next only when these two are exchanged back; exchange "
               "the two names, in the header or with --columns",
               sensor, imk_axis_letter(d->axis), sensor, imk_axis_letter(d->other),
               d->sensor >= 0 ? "" : " (or the same two accelerometers), and signs are changed");
}

static calibrate_message left_handed(const imk_diagnostic_finding *d)
{
    calibrate_message message;
    if (mended(d, "left_handed", &message))
        return message;
    if (d->axis < 0)
        return say(IMK_FINDING_FAILURE, "left_handed",
                   "all three gyros measure turns in the opposite direction to the accelerometers: "
                   "change the sign of all gyro columns");
    const char *sensor = d->sensor == 1 ? "accel" : "gyro";
    return say(
        IMK_FINDING_FAILURE, "left_handed",
        "%s_%c has the wrong sign relative to the other axes: the axes are mirrored (left-handed), "
        "and the turns of the gyros lead from one attitude of the accelerometers to the next only "
        "with this sign changed; change the sign of this column in the log",
        sensor, imk_axis_letter(d->axis));
}

static calibrate_message on_log(const imk_calibrate_log *b, const imk_calibrate_record *log,
                                const imk_diagnostic_finding *d)
{
    const char *sensor = d->sensor >= 0 ? imki_sensor_titles[d->sensor] : "sensor";
    switch (d->kind) {
    case IMK_DIAGNOSTIC_NEVER_STATIC:
        return never_static(b, log);
    case IMK_DIAGNOSTIC_NEVER_MOVES:
        return say(IMK_FINDING_FAILURE, "never_moves",
                   "the unit is stationary in one pose all the time: turn the unit to other poses, "
                   "and hold each for some seconds; to identify the noise of a log at rest, use "
                   "imukit identify");
    case IMK_DIAGNOSTIC_FEW_POSES:
        return few_poses(b, log, d);
    case IMK_DIAGNOSTIC_ONE_PLANE:
        return one_plane(b, log, d);
    case IMK_DIAGNOSTIC_GRAVITY_UNIT:
        return gravity_unit(b, log, d->value);
    case IMK_DIAGNOSTIC_RATE_UNIT:
        return rate_unit(b, log, d->value);
    case IMK_DIAGNOSTIC_SATURATED:
        return say(
            IMK_FINDING_WARNING, "saturated",
            "%s %c is at the end of its range in %.3g %% of the log; the affected %s are left out: "
            "choose a larger range in the device, or %s",
            sensor, imk_axis_letter(d->axis), 100 * d->value, d->sensor == 0 ? "turns" : "poses",
            d->sensor == 0 ? "turn more slowly" : "choose poses without this axis along gravity");
    case IMK_DIAGNOSTIC_COUNTS:
        return say(IMK_FINDING_FAILURE, "counts",
                   "the %s readings are whole numbers, and in no usual unit do they equal gravity "
                   "at rest: they look like counts; write [count] into the header (or add "
                   "--%s-unit count) and, if you know the sensitivity, add --%s-sensitivity",
                   sensor, imki_sensor_keys[d->sensor > 0], imki_sensor_keys[d->sensor > 0]);
    case IMK_DIAGNOSTIC_SWAPPED_AXES:
        return swapped(d);
    case IMK_DIAGNOSTIC_LEFT_HANDED:
        return left_handed(d);
    case IMK_DIAGNOSTIC_TIME_UNIT:
        return time_unit(log, d->value);
    case IMK_DIAGNOSTIC_SCALE:
        return scale(b, d);
    case IMK_DIAGNOSTIC_ONE_CONE:
        return one_cone(b, log, d);
    default:
        return say(IMK_FINDING_FAILURE, "stuck",
                   "%s %c never changes its reading: the axis is dead, or the column has the wrong "
                   "name; check the device and the header",
                   sensor, imk_axis_letter(d->axis));
    }
}

/* ---- on the solution ------------------------------------------------------------------------- */

static calibrate_message correlated(const imk_calibrate_log *b, double correlation)
{
    char one[IMK_MODEL_PARAMETER_NAME] = "?", other[IMK_MODEL_PARAMETER_NAME] = "?";
    const imk_calibration_result *r = b->result;
    bool linear = true;
    for (int k = 0; k < 2; k++) {
        const imk_model_parameter *p = &r->parameter[r->weakest_parameter[k]];
        (void)imk_model_parameter_name(*p, k == 0 ? one : other);
        linear = linear && (p->term == IMK_MODEL_BIAS || p->term == IMK_MODEL_SCALE_FACTOR ||
                            p->term == IMK_MODEL_MISALIGNMENT);
    }
    /* Few rates do not separate K2 from an asymmetry: their intervals say so, and the log is sound.
     */
    return say(linear ? IMK_FINDING_WARNING : IMK_FINDING_NOTE, "correlated",
               "%s and %s are strongly correlated (%.4f): an error in one balances an error in the "
               "other, so only a combination of both is known well; add poses or turns that differ "
               "more, or leave one of the two out (--estimate)",
               one, other, correlation);
}

/* What the log holds is not what the model says. */
static calibrate_message unexplained(const imk_calibrate_log *b, const imk_diagnostic_finding *d)
{
    static const struct {
        const char *what, *si, *causes;
    } groups[IMK_GROUPS] = {
        {"gyro readings at rest", "rad/s",
         "the unit was not at rest in all holds, or the bias drifts"},
        {"accelerometer readings", "m/s^2",
         "a face, a label or a reference is not what it is said to be, the unit was moved during "
         "holds, or the accelerometers are at the end of their range or not linear"},
        {"turns between poses", "rad",
         "gyros and accelerometers are not sampled at the same time, the sampling rate varies, a "
         "gyro saturates, signs or axes are wrong, or the gyros sense the force and g_sensitivity "
         "is not estimated"}};
    const int g = d->other >= 0 && d->other < IMK_GROUPS ? d->other : 0;
    const double rms = b->result->group[g].rms;
    const imk_unit unit = imk_unit_readable(imk_unit_of(groups[g].si).dimension, rms);
    return say(IMK_FINDING_WARNING, "residuals",
               "the %s differ from the solution by %.3g %s rms, %.3g times what the noise within "
               "the holds explains (chi-square per degree of freedom %.3g): the model does not "
               "describe this log, and the intervals hold only if the excess is random. Likely "
               "causes: %s; --poses lists the residuals",
               groups[g].what, rms / unit.scale, unit.text, sqrt(d->value), d->value,
               groups[g].causes);
}

static calibrate_message on_solution(const imk_calibrate_log *b, const imk_diagnostic_finding *d)
{
    switch (d->kind) {
    case IMK_DIAGNOSTIC_RESIDUALS:
        if (sqrt(d->value) > residual_alarm)
            return unexplained(b, d);
        return say(IMK_FINDING_NOTE, "residuals",
                   "the residuals are %.3g times what the noise within the holds explains "
                   "(chi-square per degree of freedom %.3g): the table, the hand or the sensor "
                   "does more than the model describes; every 1 sigma includes this excess",
                   sqrt(d->value), d->value);
    case IMK_DIAGNOSTIC_CORRELATED:
        return correlated(b, d->value);
    default:
        return say(IMK_FINDING_WARNING, "outliers",
                   "%.3g %% of the observations do not fit the others and are left out; --poses "
                   "lists them; if there are more than a few, the unit moved during the holds, or "
                   "the unit of a column or a label is wrong",
                   100 * d->value);
    }
}

static calibrate_message diagnostic_message(const imk_calibrate_log *b,
                                            const imk_calibrate_record *log,
                                            const imk_diagnostic_finding *diagnostic)
{
    const bool of_solution = diagnostic->kind == IMK_DIAGNOSTIC_RESIDUALS ||
                             diagnostic->kind == IMK_DIAGNOSTIC_CORRELATED ||
                             diagnostic->kind == IMK_DIAGNOSTIC_OUTLIERS;
    if (of_solution)
        return on_solution(b, diagnostic);
    if (log)
        return on_log(b, log, diagnostic);
    /* Responses that were solved for: of a force, times what was read at rest. */
    imk_diagnostic_finding found = *diagnostic;
    if (found.kind == IMK_DIAGNOSTIC_GRAVITY_UNIT)
        found.value *= b->calibration->gravity;
    return on_log(b, &b->record[0], &found);
}

bool imki_calibrate_useless(const imk_calibrate_log *b, const imk_calibrate_record *log, char *text,
                            size_t size)
{
    for (size_t k = 0; k < log->diagnostic_count; k++) {
        const calibrate_message message = diagnostic_message(b, log, &log->diagnostic[k]);
        if (!diagnostic_matters(log, &log->diagnostic[k]) || message.level != IMK_FINDING_FAILURE)
            continue;
        snprintf(text, size, "%s: %s", log->path, message.text);
        return true;
    }
    return false;
}

/* ---- all of them ----------------------------------------------------------------------------- */

static void add(imk_verdict *v, calibrate_message message)
{
    imki_verdict_add(v, message.level, message.code, "%s", message.text);
}

static void add_thermal(imk_verdict *v, const imk_calibrate_record *log)
{
    const imk_thermal_findings *f = log->thermal;
    for (int sensor = 0; f && sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_thermal_axis *a = &f->axis[sensor][i];
            if (a->single_valued || !(a->gap_largest > 0))
                continue;
            const imk_unit unit =
                imk_unit_readable(imk_unit_of(imki_sensor_units[sensor]).dimension, a->gap_largest);
            add(v, say(IMK_FINDING_WARNING, "hysteresis",
                       "%s: the readings of %s %c while warming and while cooling differ by up to "
                       "%.3g %s: no polynomial of the temperature can describe this difference; "
                       "the error after compensation is %.3g %s rms",
                       log->path, imki_sensor_titles[sensor], imk_axis_letter(i),
                       a->gap_largest / unit.scale, unit.text, a->rms_compensated / unit.scale,
                       unit.text));
        }
    if (f && !f->both_directions)
        add(v, say(IMK_FINDING_NOTE, "one_direction",
                   "%s: the temperature changed in one direction only, which cannot show "
                   "hysteresis: sweep up and down",
                   log->path));
    if (f && f->accel_shared)
        add(v, say(IMK_FINDING_NOTE, "one_pose",
                   "%s: one pose cannot separate the temperature effects on accelerometer bias and "
                   "scale factor: the coefficients hold for this pose only; sweep the temperature "
                   "in several poses to separate them",
                   log->path));
}

/* "gyro.nonlinearity.k2" of gyro.nonlinearity.k2.x. */
static void term_of(imk_model_parameter parameter, char term[IMK_MODEL_PARAMETER_NAME])
{
    parameter.axis = parameter.element = 0;
    term[0] = '\0';
    if (imk_model_parameter_name(parameter, term) != IMK_OK)
        return;
    char *axis = strstr(term, ".x");
    if (axis)
        *axis = '\0';
}

/* Terms a procedure would have estimated and the log does not determine, on some axes at least. */
static void add_undetermined(const imk_calibrate_log *b, const imk_calibrate_record *log,
                             imk_verdict *v)
{
    const imk_procedure_findings *f = &log->findings;
    imki_text names = {0};
    char term[IMK_MODEL_PARAMETER_NAME];
    for (size_t k = 0; k < f->undetermined_count && k < IMK_UNDETERMINED_MAX; k++) {
        term_of(f->undetermined[k], term);
        if (imk_calibrate_find(b, f->undetermined[k]) < 0 &&
            !(names.bytes && strstr(names.bytes, term)))
            imki_list_item(&names, "%s", term);
    }
    if (names.bytes)
        add(v, say(IMK_FINDING_NOTE, "undetermined",
                   "%s does not determine %s (on all axes): the undetermined values are left as "
                   "before; apply inputs along other axes, or more levels",
                   log->path, names.bytes));
    free(names.bytes);
}

/* Placements that scatter beyond what is stated of them: in one of a thousand calibrations by
 * chance. */
static void add_placements(const imk_calibrate_log *b, imk_verdict *v)
{
    const double by_chance = 1e-3, degrees = 57.29577951308232;
    const imk_group_fit *fit = b->result ? &b->result->placement : NULL;
    if (!fit || fit->count == 0)
        return;
    if (!(fit->degrees_of_freedom >= 3))
        add(v, say(IMK_FINDING_NOTE, "placement_untested",
                   "this log does not test the placements: their uncertainty is as --placement "
                   "states; put the unit on each face three times to test it"));
    else if (imk_gamma_upper(0.5 * fit->degrees_of_freedom, 0.5 * fit->chi_square) < by_chance)
        add(v, say(IMK_FINDING_WARNING, "placement",
                   "the placements scatter by %.2g deg (1 sigma), %.2g times what --placement "
                   "states: this is included in every uncertainty; check the faces and the plate, "
                   "or state --placement %.2gdeg",
                   fit->rms * degrees, fit->factor, fit->rms * degrees));
}

/* What a g-sensitivity that is not determined, or not estimated, does to the biases. */
static void add_considered(const imk_calibrate_log *b, imk_verdict *v)
{
    const double si = 57.29577951308232 * 3600 * 9.80665;
    const imk_group_fit *fit = b->result ? &b->result->assumed : NULL;
    double sigma = 0;
    if (!fit || fit->count == 0)
        return;
    for (size_t p = 0; p < b->calibration->parameter_count; p++)
        if (b->calibration->prior_guessed[p])
            sigma = b->calibration->prior_sigma[p] * fit->factor;
    add(v,
        say(IMK_FINDING_NOTE, "g_sensitivity_assumed",
            "the attitudes do not separate the g-sensitivity of the gyros from their bias, or it "
            "is not estimated: the uncertainty of the bias includes a g-sensitivity of %.2g "
            "deg/h/g (1 sigma, %s); turn the unit upside down in each attitude, or state "
            "--g-sensitivity-sigma",
            sigma * si, fit->degrees_of_freedom >= 3 ? "as this log shows it" : "assumed"));
}

/* What a log showed already need not be said of the solution again, nor of each axis. */
static bool is_said(const imk_verdict *v, size_t count, const char *code)
{
    for (size_t k = 0; k < v->count && k < count; k++)
        if (strcmp(v->message[k].code, code) == 0)
            return true;
    return false;
}

/* A sensitivity that was found takes a sign with it: the model is right if the turns were, and of
 * all gyros alike when the direction of the turns was stated. */
static void add_opposite_turns(const imk_calibrate_log *b, imk_verdict *v)
{
    calibrate_message m = {.level = IMK_FINDING_FAILURE, .code = "left_handed"};
    const size_t count =
        is_said(v, v->count, m.code) ? 0 : imki_turns_text(b, m.text, sizeof m.text);
    if (count == 0)
        return;
    if (b->nominal[0])
        m.level =
            count == (size_t)b->result->model.gyro.axis_count && !isnan(b->settings.turn_angle)
                ? IMK_FINDING_NOTE
                : IMK_FINDING_WARNING;
    add(v, m);
}

imk_verdict imk_calibrate_verdict(const imk_calibrate_log *b, size_t count,
                                  const imk_message *before, imk_result *result)
{
    imk_verdict v = {.result = result};
    for (size_t k = 0; k < count; k++)
        imki_verdict_add(&v, before[k].level, before[k].code, "%s", before[k].text);
    for (const imk_calibrate_record *log = b->record; log < b->record + b->count; log++) {
        for (size_t d = 0; d < log->diagnostic_count; d++) {
            if (!diagnostic_matters(log, &log->diagnostic[d]))
                continue;
            const calibrate_message plain = diagnostic_message(b, log, &log->diagnostic[d]);
            add(&v, say(plain.level, plain.code, "%.150s: %.1000s", log->path, plain.text));
        }
        add_undetermined(b, log, &v);
        add_thermal(&v, log);
    }
    add_opposite_turns(b, &v);
    const size_t of_logs = v.count;
    add_placements(b, &v);
    add_considered(b, &v);
    for (size_t d = 0; d < b->diagnostic_count; d++) {
        const calibrate_message message = diagnostic_message(b, NULL, &b->diagnostic[d]);
        const bool of_scale = b->diagnostic[d].kind == IMK_DIAGNOSTIC_SCALE;
        const char *unit = b->diagnostic[d].sensor == 0 ? "rate_unit" : "gravity_unit";
        if (!is_said(&v, of_scale ? of_logs : v.count, message.code) &&
            !(of_scale && is_said(&v, v.count, unit)) &&
            !(of_scale && b->diagnostic[d].value < 0 && is_said(&v, v.count, "left_handed")))
            add(&v, message);
    }
    imki_untestable(b, &v);
    return v;
}
