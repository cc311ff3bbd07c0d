/* SPDX-License-Identifier: Apache-2.0 */
/* Rate table, tumble, centrifuge and spin: procedures whose input a reference says for every
 * sample.
 *
 * Where the reference is constant, means of readings and reference make one observation; a log
 * whose reference never holds still, such as a sine, is cut into short blocks, once the lag of the
 * readings behind the reference is known. The mounting of the unit in all of them is one unknown
 * rotation with the sigma of the settings. What a procedure makes free, in this order, as far as
 * the inputs tell it apart (reference_determined.c):
 *
 *     rate-table   gyros: bias, scale factor, misalignments, asymmetry, K2, K3, Koq; where forces
 *                  are known also g- and g2-sensitivity
 *     tumble       accelerometers: bias (K0), scale factor (K1), misalignments, K2, K3, Kip, Kio,
 *                  Kpo; gyros: bias, g- and g2-sensitivity
 *     centrifuge   the same with Koq and asymmetry; gyros where the rate of the arm is known
 *     spin         accelerometers: lever arms */
#include "reference_internal.h"

#include "base/algebra/vector_internal.h"
#include "base/workspace_internal.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "imukit/samples.h"

#include <math.h>

enum { FIT_SAMPLES = 200000 };

/* The reference is called moving when stretches reach less than this share of its largest value. */
static const double reached = 0.5;
/* Readings follow their reference when the slope of one on the other is within a factor of this:
 * degrees for radians, or another unit of force, are further off, and no sensor is. */
static const double plausible = 3.0;
/* A reference below this is rest [rad/s]: some times the Earth's rate, which turns gravity by less
 * than a milliradian a second. */
static const double at_rest = 5e-4;
/* Longest lag of readings that is looked for [s]. */
static const double longest_lag = 0.5;

typedef struct observed {
    const imki_procedure_call *call;
    imk_calibration *calibration;
    const imk_test_record *record;
    size_t count;
    imk_reference_stretch *stretch;
    bool moving;
    double lag; /* samples */
    int fixture;
} observed;

/* ---- workspace -------------------------------------------------------------------------------
 */

static size_t stretches_possible(const imk_test_record *record,
                                 const imk_procedure_settings *settings)
{
    const size_t shortest = imk_samples_in(settings->minimum, record->dt);
    if (record->means)
        return record->count;
    return record->count / (shortest > 2 ? shortest : 2) + 1;
}

static size_t scratch_size(const imk_test_record *record)
{
    const size_t search = imk_reference_stretches_workspace_size(record);
    const size_t design = imki_free_determined_workspace();
    return ((search > design ? search : design) + 63) / 64 * 64;
}

size_t imki_reference_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings)
{
    if (!(record->dt > 0.0) || !(settings->minimum > 0.0))
        return 0;
    return IMKI_ALIGNMENT_SLACK + scratch_size(record) +
           2 * stretches_possible(record, settings) * sizeof(imk_reference_stretch);
}

/* ---- what a record must have -----------------------------------------------------------------
 */

static imk_status missing(const imki_procedure_call *call, const char *field, const char *expected)
{
    return imki_reference_refuse(call, IMK_ERROR_KEY_MISSING, field, -1, 0.0, 0.0, expected);
}

static imk_status check_record(const imki_procedure_call *call, const imk_test_record *record)
{
    const bool rate = imki_reference_channels(record, IMK_GYRO) != NULL;
    const bool force = imki_reference_channels(record, IMK_ACCEL) != NULL;
    switch (call->procedure) {
    case IMK_PROCEDURE_RATE_TABLE:
        if (record->axis_count[IMK_GYRO] == 0)
            return missing(call, "gyro", "log the gyros: a rate table shows their errors");
        return rate ? IMK_OK
                    : missing(call, "reference_rate",
                              "give the rates of the table: reference_rate columns in the log, or "
                              "the programme of the motion");
    case IMK_PROCEDURE_SPIN:
        if (record->axis_count[IMK_ACCEL] == 0)
            return missing(call, "accel", "log the accelerometers: a spin shows their positions");
        return rate || record->axis_count[IMK_GYRO] >= 3
                   ? IMK_OK
                   : missing(call, "reference_rate",
                             "give the rate of the unit, or also log its gyros");
    default:
        return force ? IMK_OK
                     : missing(call, "reference_force",
                               "give the specific forces or the attitudes of the unit");
    }
}

/* Counts need a sensitivity to have a unit; a rate table finds that of gyros. */
static imk_status check_units(const imki_procedure_call *call, const imk_test_record *record)
{
    static const char *const fields[2] = {"gyro.sensitivity", "accel.sensitivity"};
    const imk_model *model = &call->calibration->model;
    for (int sensor = 0; sensor < 2; sensor++) {
        const bool table = call->procedure == IMK_PROCEDURE_RATE_TABLE;
        const bool unread = table || (call->procedure == IMK_PROCEDURE_SPIN && sensor == IMK_GYRO &&
                                      imki_reference_channels(record, IMK_GYRO));
        const imk_triad *triad = imk_model_triad(model, sensor);
        for (int axis = 0; axis < record->axis_count[sensor] && !unread; axis++)
            if (record->counts[sensor] && triad->sensitivity.value[axis] == 0.0)
                return imki_reference_refuse(call, IMK_ERROR_UNIT_MISSING, fields[sensor], axis,
                                             0.0, 0.0, "state the sensitivity, in counts per unit");
    }
    return IMK_OK;
}

/* ---- readings against the reference ------------------------------------------------------------
 */

/* Reading of an axis against the component of its reference along it. */
static imki_linear_fit along_axis(const observed *o, int sensor, int axis)
{
    const imk_model *model = &o->calibration->model;
    const double *e = imk_model_triad(model, sensor)->direction[axis];
    const double *const *channel = imki_reference_channels(o->record, sensor);
    imki_linear_fit fit = {.count = 0};
    const size_t stride = o->record->count / FIT_SAMPLES + 1;
    for (size_t k = 0; o->moving && k < o->record->count; k += stride) {
        double u[3] = {0.0, 0.0, 0.0};
        for (int j = 0; j < 3; j++)
            u[0] += e[j] * imki_reference_at(channel[j], o->record->count, k, o->lag);
        const double y = o->record->reading[sensor][axis][k];
        if (fabs(u[0]) < HUGE_VAL && fabs(y) < HUGE_VAL)
            imki_linear_fit_add(&fit, u, y);
    }
    for (size_t i = 0; !o->moving && i < o->count; i++) {
        const imk_reference_stretch *s = &o->stretch[i];
        const double *input = sensor == IMK_GYRO ? s->rate : s->force;
        const double u[3] = {imki_dot3(e, input), 0.0, 0.0};
        const double y = s->reading.mean[sensor][axis];
        if (fabs(u[0]) < HUGE_VAL && fabs(y) < HUGE_VAL)
            imki_linear_fit_add(&fit, u, y);
    }
    imki_linear_fit_solve(&fit);
    return fit;
}

/* Variance of the input of a fit. */
static double input_variance(const imki_linear_fit *fit)
{
    const double n = (double)fit->count;
    return fit->count > 1 ? (fit->product[0] - fit->sum[0] * fit->sum[0] / n) / n : 0.0;
}

/* Fits of all axes, and which of them were moved themselves: by a tenth of the most moved one. */
static void fit_axes(const observed *o, int sensor, imki_linear_fit fit[IMK_AXES_MAX],
                     bool moved[IMK_AXES_MAX])
{
    double most = 0.0;
    for (int axis = 0; axis < o->record->axis_count[sensor]; axis++) {
        fit[axis] = along_axis(o, sensor, axis);
        most = fmax(most, input_variance(&fit[axis]));
    }
    for (int axis = 0; axis < o->record->axis_count[sensor]; axis++)
        moved[axis] = fit[axis].count > 2 && most > 0.0 && input_variance(&fit[axis]) > 0.01 * most;
}

/* Nominal sensitivity and zero offset of gyros that have none: what the fits say; axes that were
 * not moved are taken to be like the others. */
static imk_status find_sensitivity(const observed *o)
{
    imki_linear_fit fit[IMK_AXES_MAX];
    bool moved[IMK_AXES_MAX];
    imk_triad *triad = &o->calibration->model.gyro;
    double sum = 0.0;
    int count = 0;
    fit_axes(o, IMK_GYRO, fit, moved);
    for (int axis = 0; axis < o->record->axis_count[IMK_GYRO]; axis++) {
        if (triad->sensitivity.value[axis] != 0.0 || !moved[axis])
            continue;
        if (!(fit[axis].share > 0.5) || !(fit[axis].slope[0] > 0.0))
            return imki_reference_refuse(o->call, IMK_ERROR_CONFLICT, "gyro", axis,
                                         fit[axis].slope[0], 0.0,
                                         "check signs and order of the axes: readings must grow "
                                         "with the rate about their axis");
        triad->sensitivity.value[axis] = fit[axis].slope[0];
        triad->zero_offset.value[axis] = fit[axis].intercept;
        sum += fit[axis].slope[0];
        count++;
    }
    for (int axis = 0; axis < o->record->axis_count[IMK_GYRO]; axis++) {
        if (triad->sensitivity.value[axis] != 0.0)
            continue;
        if (count == 0)
            return imki_reference_refuse(
                o->call, IMK_ERROR_UNIT_MISSING, "gyro.sensitivity", axis, 0.0, 0.0,
                "state the sensitivity, in counts per unit: no axis was turned");
        triad->sensitivity.value[axis] = sum / count;
        triad->zero_offset.value[axis] = fit[axis].intercept;
    }
    return IMK_OK;
}

/* Do readings follow their reference, about one to one? Where they do not, a unit, a sign or the
 * order of axes is wrong, and no estimate would mean anything. */
static imk_status check_following(const observed *o, int sensor)
{
    imki_linear_fit fit[IMK_AXES_MAX];
    bool moved[IMK_AXES_MAX];
    fit_axes(o, sensor, fit, moved);
    for (int axis = 0; axis < o->record->axis_count[sensor]; axis++) {
        const double slope = fit[axis].slope[0] / imki_reference_sensitivity(o->call, sensor, axis);
        if (!moved[axis] || (slope > 1.0 / plausible && slope < plausible))
            continue;
        return imki_reference_refuse(
            o->call, IMK_ERROR_CONFLICT, sensor == IMK_GYRO ? "gyro" : "accel", axis, slope, 1.0,
            "check units, signs and order of axes, and that readings and reference begin at the "
            "same time: the readings must follow the reference one to one");
    }
    return IMK_OK;
}

/* ---- stretches as observations ---------------------------------------------------------------
 */

/* Rate of a unit at rest under a known force: the part of the Earth's rate along the vertical. The
 * other part h has no known direction. The headings of m holds may be alike, as on a dividing head,
 * or not; since (sum of x_i)^2 <= m sum of x_i^2, the covariance of the h is m times their
 * variances at most, however they depend on each other, and each reading gets m times its own. */
static void earth_at_rest(const observed *o, imk_observation *observation)
{
    const imk_calibration *c = o->calibration;
    const double *f = observation->force;
    const double size = imki_norm3(f);
    if (!(size > 0.0) || c->earth_rate == 0.0)
        return;
    const bool known = fabs(c->latitude) < HUGE_VAL;
    const double vertical = known ? c->earth_rate * imk_sin(c->latitude) : 0.0;
    const double level = known ? c->earth_rate * imk_cos(c->latitude) : c->earth_rate;
    for (int j = 0; j < 3; j++)
        observation->rate[j] = vertical * f[j] / size;
    observation->heading_depends = true;
    for (int axis = 0; axis < o->record->axis_count[IMK_GYRO]; axis++) {
        const double *e = c->model.gyro.direction[axis];
        const double up = imki_dot3(e, f) / size;
        const double across = known ? 0.5 * fmax(0.0, 1.0 - up * up) : 1.0 / 3.0;
        observation->heading_variance[axis] = (double)o->count * across * level * level;
    }
}

static bool takes(const observed *o, int sensor)
{
    if (o->record->axis_count[sensor] == 0)
        return false;
    if (o->call->procedure == IMK_PROCEDURE_RATE_TABLE)
        return sensor == IMK_GYRO;
    /* On a centrifuge the gyros see the arm turn. */
    return sensor == IMK_ACCEL || o->call->procedure == IMK_PROCEDURE_TUMBLE ||
           imki_reference_channels(o->record, IMK_GYRO);
}

static void input_of(const observed *o, const imk_reference_stretch *s, imk_observation *made)
{
    const imk_test_record *record = o->record;
    const bool own_force =
        record->axis_count[IMK_ACCEL] >= 3 &&
        (!record->counts[IMK_ACCEL] || o->calibration->model.accel.sensitivity.value[0] != 0.0);
    for (int j = 0; j < 3; j++) {
        made->rate[j] = isnan(s->rate[j]) ? 0.0 : s->rate[j];
        made->force[j] = isnan(s->force[j]) ? 0.0 : s->force[j];
        made->angular_acceleration[j] = s->angular_acceleration[j];
    }
    if (isnan(s->force[0]) && own_force)
        imki_reference_own(o->call, IMK_ACCEL, s->reading.mean[IMK_ACCEL], made->force);
    if (isnan(s->rate[0]) && o->call->procedure == IMK_PROCEDURE_TUMBLE)
        earth_at_rest(o, made);
}

static imk_status add_stretches(const observed *o)
{
    const imki_pooled_noise noise = imki_reference_noise(o->call, o->count, o->stretch);
    const imk_status status = imki_reference_room(o->call, o->count);
    if (status != IMK_OK)
        return status;
    for (size_t i = 0; i < o->count; i++) {
        const imk_reference_stretch *s = &o->stretch[i];
        imk_observation made = imki_reference_blank(o->call, s->begin, s->end, o->fixture);
        bool any = false;
        for (int sensor = 0; sensor < 2; sensor++)
            if (takes(o, sensor) && imki_reference_usable(o->call, sensor, s->begin, s->end)) {
                imki_reference_take(o->call, sensor, &noise, s, &made);
                any = true;
            }
        if (!any) {
            o->call->findings->left_out++;
            continue;
        }
        input_of(o, s, &made);
        made.offset_sigma = imki_reference_offset_sigma(o->call, &made);
        if (o->call->procedure == IMK_PROCEDURE_TUMBLE &&
            o->call->settings->placement_sigma > 0.0) {
            made.knowledge = IMK_INPUT_PLACED;
            made.placement_sigma = o->call->settings->placement_sigma;
        }
        imk_calibration_observe(o->calibration, &made);
    }
    return IMK_OK;
}

/* Where the readings lag, a stretch of the reference is one of theirs only as far as both last. */
static void delay_stretches(observed *o)
{
    const size_t head = (size_t)ceil(fmax(0.0, o->lag)), tail = (size_t)ceil(fmax(0.0, -o->lag));
    size_t kept = 0;
    for (size_t i = 0; i < o->count && head + tail > 0; i++) {
        imk_reference_stretch s = o->stretch[i];
        if (s.end - s.begin < head + tail + 2)
            continue;
        s.begin += head;
        s.end -= tail;
        s.reading = imk_static_summary(o->record, s.begin, s.end);
        o->stretch[kept++] = s;
    }
    o->count = head + tail > 0 ? kept : o->count;
}

/* Blocks between the stretches; their noise is that within stretches, where there are some. */
static imk_status add_blocks(const observed *o)
{
    const imki_pooled_noise noise = imki_reference_noise(o->call, o->count, o->stretch);
    double sigma[IMK_AXES_MAX];
    imki_reference_sigmas(o->call, IMK_GYRO, &noise, sigma);
    return imki_reference_blocks(o->call, IMK_GYRO, o->lag, o->fixture, o->count, o->stretch,
                                 o->count > 0 ? sigma : NULL);
}

/* Smallest eigenvalue of the mean outer product of the directions of force. */
static double spread_of(const imk_calibration *c, size_t first)
{
    double sum[9] = {0.0}, values[3];
    for (size_t i = first; i < c->observation_count; i++) {
        const double *f = c->observation[i].force;
        const double square = imki_dot3(f, f);
        for (int j = 0; j < 9 && square > 0.0; j++)
            sum[j] += f[j / 3] * f[j % 3] / square / (double)(c->observation_count - first);
    }
    return imk_symmetric_eigen(3, sum, values, NULL) == IMK_OK ? fmax(values[0], 0.0) : 0.0;
}

/* ---- the procedures --------------------------------------------------------------------------
 */

/* Does the reference go far beyond what it does in stretches? */
static bool is_moving(const observed *o)
{
    double all = 0.0, still = 0.0;
    for (size_t k = 0; k < o->record->count; k++) {
        double square = 0.0;
        for (int j = 0; j < 3; j++)
            square += o->record->reference_rate[j][k] * o->record->reference_rate[j][k];
        all = square > all ? square : all;
    }
    for (size_t i = 0; i < o->count; i++) {
        const double *r = o->stretch[i].rate;
        still = fmax(still, imki_dot3(r, r));
    }
    return still < reached * reached * all;
}

static double rate_of(const imk_reference_stretch *s)
{
    return imki_norm3(s->rate);
}

/* Stretches of steady rate for what turns, though gravity may turn with the table; at rest forces
 * must be steady too, or a change of mounting would be one with what is before and after. */
static imk_status find_turning(observed *o, const imk_test_record *record, void *scratch)
{
    const imki_procedure_call *call = o->call;
    const size_t possible = stretches_possible(o->record, call->settings);
    imk_procedure_settings rates_only = *call->settings;
    imk_reference_stretch *still = o->stretch + possible;
    size_t still_count = 0, turning = 0, at = 0;
    double slow = at_rest;
    rates_only.steady_force = 1e300;
    imk_status status =
        imk_reference_stretches(record, &rates_only, o->stretch, possible, &o->count, scratch,
                                scratch_size(o->record), call->error);
    if (status == IMK_OK)
        status = imk_reference_stretches(record, call->settings, still, possible, &still_count,
                                         scratch, scratch_size(o->record), call->error);
    if (status != IMK_OK)
        return status;
    /* Gyros have a bias, which is small beside the rates of a spin. */
    for (size_t i = 0; i < o->count && !o->record->reference_rate[0]; i++)
        slow = fmax(slow, 0.05 * rate_of(&o->stretch[i]));
    for (size_t i = 0; i < o->count; i++)
        if (rate_of(&o->stretch[i]) > slow)
            o->stretch[turning++] = o->stretch[i];
    for (size_t i = 0; i < still_count; i++)
        if (!(rate_of(&still[i]) > slow))
            still[at++] = still[i];
    /* Both are in order of time; put together from behind, nothing is overwritten. */
    o->count = turning + at < possible ? turning + at : possible;
    for (size_t k = o->count; k > 0 && at > 0; k--)
        o->stretch[k - 1] = turning > 0 && o->stretch[turning - 1].begin > still[at - 1].begin
                                ? o->stretch[--turning]
                                : still[--at];
    return IMK_OK;
}

static imk_status find_stretches(observed *o, void *scratch)
{
    const imki_procedure_call *call = o->call;
    imk_test_record shown = *o->record;
    const bool spin = call->procedure == IMK_PROCEDURE_SPIN;
    /* Without a reference the sensors of a spin say themselves where it is steady. */
    for (int j = 0; j < 3 && spin; j++) {
        if (!o->record->reference_rate[j] && !shown.counts[IMK_GYRO])
            shown.reference_rate[j] = shown.reading[IMK_GYRO][j];
        if (!o->record->reference_force[j] && j < shown.axis_count[IMK_ACCEL])
            shown.reference_force[j] = shown.reading[IMK_ACCEL][j];
    }
    if (call->procedure == IMK_PROCEDURE_RATE_TABLE || spin)
        return find_turning(o, &shown, scratch);
    return imk_reference_stretches(&shown, call->settings, o->stretch,
                                   stretches_possible(o->record, call->settings), &o->count,
                                   scratch, scratch_size(o->record), call->error);
}

/* A fixture for the record's mounting; none when it is exact. */
static imk_status take_fixture(observed *o)
{
    imk_calibration *c = o->calibration;
    o->fixture = -1;
    if (!(o->call->settings->fixture_sigma > 0.0))
        return IMK_OK;
    if (c->fixture_count >= IMK_FIXTURES_MAX)
        return imki_reference_refuse(o->call, IMK_ERROR_RANGE, "fixture", -1,
                                     (double)c->fixture_count + 1.0, IMK_FIXTURES_MAX,
                                     "fewer logs: each log has a mounting of its own");
    c->fixture_sigma[c->fixture_count] = o->call->settings->fixture_sigma;
    o->fixture = (int)c->fixture_count++;
    return IMK_OK;
}

static imk_status add_observations(observed *o)
{
    const imki_procedure_call *call = o->call;
    if (call->procedure == IMK_PROCEDURE_SPIN)
        return imki_spin_observe(call, o->count, o->stretch, o->fixture);
    o->moving = call->procedure == IMK_PROCEDURE_RATE_TABLE && is_moving(o);
    if (o->moving) {
        double sigma = 0.0;
        if (imki_reference_lag(o->record, 1, longest_lag / o->record->dt, &o->lag, &sigma)) {
            call->findings->lag = o->lag * o->record->dt;
            call->findings->lag_sigma = sigma * o->record->dt;
        }
        delay_stretches(o);
    }
    imk_status status = IMK_OK;
    if (call->procedure == IMK_PROCEDURE_RATE_TABLE && o->record->counts[IMK_GYRO])
        status = find_sensitivity(o);
    for (int sensor = 0; sensor < 2 && status == IMK_OK; sensor++)
        if (takes(o, sensor) && imki_reference_channels(o->record, sensor) &&
            (sensor == IMK_ACCEL || call->procedure != IMK_PROCEDURE_TUMBLE))
            status = check_following(o, sensor);
    if (status != IMK_OK)
        return status;
    status = add_stretches(o);
    return o->moving && status == IMK_OK ? add_blocks(o) : status;
}

/* The axes of the reference are the body frame, unless poses of unknown attitude are in the same
 * solution, whose frame the caller has chosen. */
static void set_frame(imk_calibration *c)
{
    for (size_t i = 0; i < c->observation_count; i++)
        if (c->observation[i].knowledge == IMK_INPUT_GRAVITY)
            return;
    c->frame = IMK_FRAME_REFERENCE;
}

static imk_status enough(const observed *o, size_t first)
{
    static const double needed[] = {[IMK_PROCEDURE_RATE_TABLE] = 3,
                                    [IMK_PROCEDURE_TUMBLE] = 4,
                                    [IMK_PROCEDURE_CENTRIFUGE] = 3,
                                    [IMK_PROCEDURE_SPIN] = 1};
    const double found = (double)(o->calibration->observation_count - first);
    const double limit = o->call->keep_free ? 1.0 : needed[o->call->procedure];
    if (found >= limit)
        return IMK_OK;
    return imki_reference_refuse(
        o->call, IMK_ERROR_TOO_SHORT, o->call->procedure == IMK_PROCEDURE_TUMBLE ? "hold" : "step",
        -1, found, limit, "hold the reference constant for longer, or allow more variation");
}

imk_status imki_reference_observe(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    observed o = {.call = call, .calibration = c, .record = c->record[call->record]};
    const size_t first = c->observation_count;
    imk_status status = check_record(call, o.record);
    if (status == IMK_OK)
        status = check_units(call, o.record);
    if (status != IMK_OK)
        return status;
    char *memory = (char *)imki_align(call->workspace);
    o.stretch = (imk_reference_stretch *)(void *)(memory + scratch_size(o.record));
    status = find_stretches(&o, memory);
    if (status == IMK_OK)
        status = take_fixture(&o);
    if (status == IMK_OK)
        status = add_observations(&o);
    if (status == IMK_OK)
        status = enough(&o, first);
    if (status != IMK_OK)
        return status;
    call->findings->intervals = o.count;
    call->findings->spread = spread_of(c, first);
    if (call->procedure == IMK_PROCEDURE_TUMBLE)
        call->findings->creeping = imki_reference_creeping(o.record, o.count, o.stretch);
    if (!call->keep_free)
        set_frame(c);
    imki_candidate list[IMKI_CANDIDATES_MAX];
    const size_t count = imki_reference_candidates(call, list);
    imki_procedure_call scratch = *call;
    scratch.workspace = memory;
    return imki_free_determined(&scratch, count, list);
}
