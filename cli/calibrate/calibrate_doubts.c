/* SPDX-License-Identifier: Apache-2.0 */
/* Doubts as sentences: what was found, what is expected, and the option or the action that mends
 * it. */
#include "calibrate_parts.h"

#include <math.h>
#include <string.h>

static const char *const sensor_names[2] = {"gyro", "accelerometer"};
static const char *const column_names[2] = {"gyro", "accel"};

/* A factor counts as seen when it is met to this part: placement and scale factors are well below,
 * and the factors asked for are farther apart. */
static const double factor_tolerance = 0.12;

/* Residuals this far above the noise are not a trembling hand: the model is another one. */
static const double residual_alarm = 100;

char axis_letter(int axis)
{
    return axis < 0 ? '?' : axis < 3 ? "xyz"[axis] : (char)('0' + axis);
}

static bool is_near(double value, double due)
{
    return fabs(value / due - 1) < factor_tolerance;
}

/* ---- on a log -------------------------------------------------------------------------------- */

/* Holds are looked for in these. */
static bool looks_for_holds(const bench_log *log)
{
    return log->procedure == IMK_PROCEDURE_MULTIPOSITION;
}

bool doubt_matters(const bench_log *log, const imk_doubt_finding *doubt)
{
    switch (doubt->kind) {
    case IMK_DOUBT_NEVER_STATIC:
        return looks_for_holds(log) || log->procedure == IMK_PROCEDURE_SIXPOSITION ||
               log->procedure == IMK_PROCEDURE_THERMAL;
    case IMK_DOUBT_NEVER_MOVES:
        return looks_for_holds(log) || log->procedure == IMK_PROCEDURE_SIXPOSITION;
    case IMK_DOUBT_FEW_POSES:
    case IMK_DOUBT_ONE_PLANE:
        return looks_for_holds(log);
    default:
        return true;
    }
}

/* Does the header state the unit? Then it is the header that is wrong. */
static bool stated(const bench_log *log, int sensor)
{
    const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    const int column = imk_log_find(&log->log, kinds[sensor], 0);
    return column >= 0 && log->log.column[column].unit.text[0] != '\0';
}

static const char *unit_of_column(const bench_log *log, int sensor)
{
    const imk_quantity kinds[2] = {IMK_QUANTITY_ANGULAR_RATE, IMK_QUANTITY_SPECIFIC_FORCE};
    const int column = imk_log_find(&log->log, kinds[sensor], 0);
    return column >= 0 ? log->log.column[column].unit.text : "";
}

static calibrate_sentence gravity_unit(const bench *b, const bench_log *log, double force)
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
            return sentence_make(
                LEVEL_USELESS, "gravity_unit",
                "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns "
                "look like ft/s^2; multiply them by 0.3048",
                force, b->calibration->gravity);
        return sentence_make(
            LEVEL_USELESS, "gravity_unit",
            "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: the columns look "
            "like %s, not %s; %s %s",
            force, b->calibration->gravity, units[k].unit, found[0] ? found : "m/s^2",
            stated(log, 1) ? "correct the header to" : "add --accel-unit", units[k].unit);
    }
    return sentence_make(
        LEVEL_USELESS, "gravity_unit",
        "at rest the accelerometers read %.5g m/s^2, gravity is %.5g: no usual unit "
        "explains it; check the unit of the accelerometer columns, or give raw counts with "
        "--accel-sensitivity",
        force, b->calibration->gravity);
}

static calibrate_sentence rate_unit(const bench_log *log, double ratio)
{
    const double degrees = 57.29577951308232;
    const char *unit = is_near(ratio, degrees)       ? "deg/s"
                       : is_near(ratio, 1 / degrees) ? "rad/s"
                                                     : NULL;
    if (!unit)
        return sentence_make(
            LEVEL_USELESS, "rate_unit",
            "the gyros turn %.4g times as far as the accelerometers saw the unit turned: "
            "check the unit of the gyro columns, and of the times",
            ratio);
    return sentence_make(
        LEVEL_USELESS, "rate_unit",
        "the gyros turn %.4g times as far as the accelerometers saw the unit turned: the "
        "columns look like %s; %s %s",
        ratio, unit, stated(log, 0) ? "correct the header to" : "add --gyro-unit", unit);
}

static calibrate_sentence time_unit(const bench_log *log, double factor)
{
    const char *unit = is_near(factor, 1e3)   ? "ms"
                       : is_near(factor, 1e6) ? "us"
                       : is_near(factor, 1e9) ? "ns"
                                              : NULL;
    const double rate = factor / log->record.dt;
    if (!unit)
        return sentence_make(
            LEVEL_USELESS, "time_unit",
            "the times are about %.3g times too long for what the gyros turned: check the "
            "unit of the time column",
            factor);
    return sentence_make(
        LEVEL_USELESS, "time_unit",
        "the samples are %.4g s apart, far too long for what the gyros turned: the times "
        "look like %s; add --time-unit %s, or correct the header (then the rate is %.4g "
        "Hz)",
        log->record.dt, unit, unit, rate);
}

static calibrate_sentence few_poses(const bench *b, const bench_log *log,
                                    const imk_doubt_finding *d)
{
    char poses[120] = "";
    const bool known = bench_advise(b, log, poses, sizeof poses);
    return sentence_make(
        b->result ? LEVEL_WARNING : LEVEL_USELESS, "few_poses",
        "%g poses are there, %g or more are needed: hold the unit still for some seconds "
        "with each of its six faces down, and on edges and corners between%s%s",
        d->value, d->limit, known ? "; most would tell " : "", poses);
}

static calibrate_sentence one_plane(const bench *b, const bench_log *log,
                                    const imk_doubt_finding *d)
{
    char poses[120] = "";
    const bool known = bench_advise(b, log, poses, sizeof poses);
    const calibrate_level level = b->result ? LEVEL_WARNING : LEVEL_USELESS;
    if (d->axis < 0)
        return sentence_make(level, "one_plane",
                             "the poses all lie in one plane: add some far out of it%s%s",
                             known ? "; most would tell " : "", poses);
    return sentence_make(
        level, "one_plane",
        "the poses all lie in one plane: gravity hardly ever acts along %c; add poses with "
        "%c up, with %c down and with %c at 45 deg%s%s",
        axis_letter(d->axis), axis_letter(d->axis), axis_letter(d->axis), axis_letter(d->axis),
        known ? "; most would tell " : "", poses);
}

/* Whole numbers in the unit of the file, of some size: counts, whatever the header says. */
static bool is_whole(const bench_log *log, int sensor)
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

static calibrate_sentence never_static(const bench *b, const bench_log *log)
{
    for (int sensor = 1; sensor >= 0; sensor--)
        if (!log->record.counts[sensor] && is_whole(log, sensor))
            return sentence_make(
                LEVEL_USELESS, "counts",
                "no rest is found, and the %s readings are whole numbers: if they are counts, not "
                "%s, write [count] into the header (or give --%s-unit count)",
                sensor_names[sensor], unit_of_column(log, sensor), column_names[sensor]);
    if (!isnan(b->options->minimum))
        return sentence_make(
            LEVEL_USELESS, "never_static",
            "the unit never stands still for %.4g s, which --minimum asks for: shorten it, or rest "
            "longer in each pose",
            b->options->minimum);
    return sentence_make(
        LEVEL_USELESS, "never_static",
        "the unit never stands still for long enough: %.2g %% of the log does, by windows "
        "of %.2g s; put it down for 3 s or more in each pose (a hand is not still). If it "
        "did rest at the beginning, add --initial-rest 10s, so that its noise is learnt "
        "there",
        100 * log->stationary.standing, log->stationary.window);
}

static calibrate_sentence swapped(const imk_doubt_finding *d)
{
    const char *sensor = d->sensor >= 0 ? column_names[d->sensor] : "gyro";
    if (d->axis < 0 || d->other < 0)
        return sentence_make(
            LEVEL_USELESS, "swapped_axes",
            "the axes of gyros and accelerometers are in different orders: the turns of the "
            "gyros do not lead from one attitude of the accelerometers to the next; put "
            "the columns in order with --columns, so that x, y, z mean the same for both");
    return sentence_make(
        LEVEL_USELESS, "swapped_axes",
        "%s_%c and %s_%c look exchanged%s: only then do the turns of the gyros lead from "
        "one attitude of the accelerometers to the next; exchange the two names, in the "
        "header or by --columns",
        sensor, axis_letter(d->axis), sensor, axis_letter(d->other),
        d->sensor >= 0 ? "" : " (or those of the accelerometers), and signs are changed");
}

static calibrate_sentence left_handed(const imk_doubt_finding *d)
{
    if (d->axis < 0)
        return sentence_make(
            LEVEL_USELESS, "left_handed",
            "the gyros turn the wrong way round against the accelerometers, all three: "
            "change the sign of all gyro columns");
    const char *sensor = d->sensor == 1 ? "accel" : "gyro";
    return sentence_make(
        LEVEL_USELESS, "left_handed",
        "%s_%c has the wrong sign against the others: the axes are mirrored "
        "(left-handed), and the turns of the gyros lead from one attitude of the "
        "accelerometers to the next only with its sign changed; change it in the log",
        sensor, axis_letter(d->axis));
}

static calibrate_sentence on_log(const bench *b, const bench_log *log, const imk_doubt_finding *d)
{
    const char *sensor = d->sensor >= 0 ? sensor_names[d->sensor] : "sensor";
    switch (d->kind) {
    case IMK_DOUBT_NEVER_STATIC:
        return never_static(b, log);
    case IMK_DOUBT_NEVER_MOVES:
        return sentence_make(
            LEVEL_USELESS, "never_moves",
            "the unit stands still all the time, in one pose: turn it to others, each for "
            "some seconds; a log at rest is for imukit identify");
    case IMK_DOUBT_FEW_POSES:
        return few_poses(b, log, d);
    case IMK_DOUBT_ONE_PLANE:
        return one_plane(b, log, d);
    case IMK_DOUBT_GRAVITY_UNIT:
        return gravity_unit(b, log, d->value);
    case IMK_DOUBT_RATE_UNIT:
        return rate_unit(log, d->value);
    case IMK_DOUBT_SATURATED:
        return sentence_make(
            LEVEL_WARNING, "saturated",
            "%s %c is at the end of its range in %.3g %% of the log; the %s it spoils are left "
            "out: choose a larger range in the device, or %s",
            sensor, axis_letter(d->axis), 100 * d->value, d->sensor == 0 ? "turns" : "poses",
            d->sensor == 0 ? "turn more slowly" : "poses without this axis along gravity");
    case IMK_DOUBT_COUNTS:
        return sentence_make(
            LEVEL_USELESS, "counts",
            "the %s readings are whole numbers, and at rest no usual unit makes gravity of "
            "them: they look like counts; write [count] into the header (or add --%s-unit "
            "count) and, if you know it, --%s-sensitivity",
            sensor, column_names[d->sensor > 0], column_names[d->sensor > 0]);
    case IMK_DOUBT_SWAPPED_AXES:
        return swapped(d);
    case IMK_DOUBT_LEFT_HANDED:
        return left_handed(d);
    case IMK_DOUBT_TIME_UNIT:
        return time_unit(log, d->value);
    default:
        return sentence_make(
            LEVEL_USELESS, "stuck",
            "%s %c never changes its reading: the axis is dead, or its column is not what "
            "it is called",
            sensor, axis_letter(d->axis));
    }
}

/* ---- on the solution ------------------------------------------------------------------------- */

static calibrate_sentence correlated(const bench *b, double correlation)
{
    char one[IMK_MODEL_PARAMETER_NAME] = "?", other[IMK_MODEL_PARAMETER_NAME] = "?";
    const imk_calibration_result *r = b->result;
    for (int k = 0; k < 2; k++)
        if (r->weakest_parameter[k] >= 0)
            (void)imk_model_parameter_name(r->parameter[r->weakest_parameter[k]],
                                           k == 0 ? one : other);
    return sentence_make(
        LEVEL_WARNING, "correlated",
        "%s and %s are hardly told apart (correlation %.4f): what one has too much the "
        "other has too little; their sum is known better than each. More differing poses "
        "or turns tell them apart, or leave one out",
        one, other, correlation);
}

static calibrate_sentence on_solution(const bench *b, const imk_doubt_finding *d)
{
    switch (d->kind) {
    case IMK_DOUBT_RESIDUALS:
        if (sqrt(d->value) > residual_alarm)
            return sentence_make(
                LEVEL_WARNING, "residuals",
                "the residuals are %.3g times what the noise within the holds explains: the model "
                "does not describe this log. Check the signs and order of the axes, labels, and "
                "that the log is of the procedure named",
                sqrt(d->value));
        return sentence_make(
            LEVEL_NOTE, "residuals",
            "the residuals are %.3g times what the noise within the holds explains "
            "(chi-square per degree of freedom %.3g): the table, the hand or the sensor "
            "does more than the model says; all 1 sigma are widened by it",
            sqrt(d->value), d->value);
    case IMK_DOUBT_CORRELATED:
        return correlated(b, d->value);
    default:
        return sentence_make(
            LEVEL_WARNING, "outliers",
            "%.3g %% of the observations do not fit the others and are left out; --poses "
            "lists them. More than a few say that the unit moved during the holds, or that "
            "a unit or label is wrong",
            100 * d->value);
    }
}

calibrate_sentence doubt_sentence(const bench *b, const bench_log *log,
                                  const imk_doubt_finding *doubt)
{
    const bool of_solution = doubt->kind == IMK_DOUBT_RESIDUALS ||
                             doubt->kind == IMK_DOUBT_CORRELATED ||
                             doubt->kind == IMK_DOUBT_OUTLIERS;
    if (of_solution)
        return on_solution(b, doubt);
    if (log)
        return on_log(b, log, doubt);
    /* Responses that were solved for: of a force, times what was read at rest. */
    imk_doubt_finding found = *doubt;
    if (found.kind == IMK_DOUBT_GRAVITY_UNIT)
        found.value *= b->calibration->gravity;
    return on_log(b, &b->log[0], &found);
}

void doubts_of_named_holds(bench_log *log)
{
    enum { FACES = 6 };
    if ((log->procedure != IMK_PROCEDURE_SIXPOSITION && log->procedure != IMK_PROCEDURE_FERRARIS) ||
        !log->record.section || log->record.section_count < FACES)
        return;
    size_t kept = 0;
    for (size_t i = 0; i < log->doubt_count; i++)
        if (log->doubt[i].kind != IMK_DOUBT_NEVER_STATIC &&
            log->doubt[i].kind != IMK_DOUBT_NEVER_MOVES &&
            log->doubt[i].kind != IMK_DOUBT_FEW_POSES)
            log->doubt[kept++] = log->doubt[i];
    log->doubt_count = kept;
}
