/* SPDX-License-Identifier: Apache-2.0 */
/* Spin: where the accelerometers are, from what fast rotation adds to their readings (size effect),
 *
 *     e.(alpha x r + w x (w x r)).
 *
 * A steady rotation about one axis shows the components of r across it that lie along the sensing
 * direction; building up and dying away, its angular acceleration shows the others. Both are
 * observed: steady stretches by their means, what lies between in blocks.
 *
 * Without a reference of force the unit must turn about the vertical, where gravity stays the same
 * in its axes. What it reads at rest before and after is then taken off:
 *
 *     y - (y_before + y_after)/2 = what lever arms and the rest of the model say without force.
 *
 * Two neighbouring stretches share a rest between them; the variance of the two rests' mean is
 * counted twice, which is right for the mean of many stretches. */
#include "base/algebra/vector_internal.h"
#include "calibrate/estimator/axis_reading_internal.h"
#include "reference_internal.h"

#include <math.h>

/* At rest is what turns slower than this share of the fastest: 1/400 of its effect. */
static const double rest_share = 0.05;
/* Sine of the angle between axis and vertical that is still taken for upright. What gravity then
 * turns by goes in sines over the turn, and cancels over whole turns. */
static const double upright = 0.1;

static void rate_of(const imki_procedure_call *call, const imk_reference_stretch *stretch,
                    double rate[3])
{
    if (fabs(stretch->rate[0]) < HUGE_VAL) {
        for (int j = 0; j < 3; j++)
            rate[j] = stretch->rate[j];
        return;
    }
    imki_reference_own(call, IMK_GYRO, stretch->reading.mean[IMK_GYRO], rate);
}

static double fastest_of(const imki_procedure_call *call, size_t count,
                         const imk_reference_stretch *stretch)
{
    double fastest = 0.0, rate[3];
    for (size_t i = 0; i < count; i++) {
        rate_of(call, &stretch[i], rate);
        fastest = fmax(fastest, imki_norm3(rate));
    }
    return fastest;
}

/* ---- what the unit reads at rest -------------------------------------------------------------
 */

typedef struct rests {
    const imki_procedure_call *call;
    size_t count;
    const imk_reference_stretch *stretch;
    double limit; /* of the rate */
} rests;

static bool is_rest(const rests *r, const imk_reference_stretch *stretch)
{
    double rate[3];
    rate_of(r->call, stretch, rate);
    return imki_norm3(rate) <= r->limit;
}

/* The last rest that ends before sample `k`, and the first that begins after it; NULL: none. */
static void neighbours(const rests *r, size_t k, const imk_reference_stretch *found[2])
{
    found[0] = found[1] = NULL;
    for (size_t i = 0; i < r->count; i++) {
        if (!is_rest(r, &r->stretch[i]))
            continue;
        if (r->stretch[i].end <= k)
            found[0] = &r->stretch[i];
        else if (r->stretch[i].begin > k && !found[1])
            found[1] = &r->stretch[i];
    }
}

/* Is the axis of a rotation along what the unit reads at rest? */
static bool is_upright(const rests *r, const imk_reference_stretch *rest, const double w[3])
{
    double f[3], across[3];
    imki_reference_own(r->call, IMK_ACCEL, rest->reading.mean[IMK_ACCEL], f);
    imki_cross3(w, f, across);
    return imki_norm3(across) <= upright * imki_norm3(w) * imki_norm3(f);
}

/* Take the readings at rest off an observation's. @return false when the axis is not upright, or
 * there is no rest */
static bool take_off(const rests *r, const imki_pooled_noise *noise, imk_observation *o)
{
    const imk_calibration *c = r->call->calibration;
    const imk_test_record *record = c->record[o->record];
    const imk_reference_stretch *rest[2];
    neighbours(r, (o->begin + o->end) / 2, rest);
    const int count = (rest[0] != NULL) + (rest[1] != NULL);
    if (count == 0)
        return false;
    for (int i = 0; i < 2; i++)
        if (rest[i] && !is_upright(r, rest[i], o->rate))
            return false;
    const imki_input still = {.temperature = o->temperature,
                              .temperature_rate = o->temperature_rate};
    for (int axis = 0; axis < record->axis_count[IMK_ACCEL]; axis++) {
        double mean = 0.0, variance = 0.0;
        for (int i = 0; i < 2; i++)
            if (rest[i]) {
                mean += rest[i]->reading.mean[IMK_ACCEL][axis] / count;
                variance += noise->variance[IMK_ACCEL][axis] /
                            (double)(rest[i]->end - rest[i]->begin) / (count * count);
            }
        const double zero =
            record->counts[IMK_ACCEL] ? c->model.accel.zero_offset.value[axis] : 0.0;
        o->reading[IMK_ACCEL][axis] += zero - mean +
                                       imki_reference_sensitivity(r->call, IMK_ACCEL, axis) *
                                           imki_axis_read(&c->model, IMK_ACCEL, axis, &still).value;
        const double sigma = o->sigma[IMK_ACCEL][axis];
        o->sigma[IMK_ACCEL][axis] = sqrt(sigma * sigma + 2.0 * variance);
    }
    return true;
}

/* ---- observations ----------------------------------------------------------------------------
 */

static imk_status add_steady(const imki_procedure_call *call, const rests *r, bool referenced,
                             const imki_pooled_noise *noise, int fixture)
{
    for (size_t i = 0; i < r->count; i++) {
        const imk_reference_stretch *s = &r->stretch[i];
        if (!referenced && is_rest(r, s))
            continue;
        if (!imki_reference_usable(call, IMK_ACCEL, s->begin, s->end)) {
            call->findings->left_out++;
            continue;
        }
        imk_observation o = imki_reference_blank(call, s->begin, s->end, fixture);
        imki_reference_take(call, IMK_ACCEL, noise, s, &o);
        rate_of(call, s, o.rate);
        for (int j = 0; j < 3; j++) {
            o.angular_acceleration[j] = s->angular_acceleration[j];
            o.force[j] = referenced ? s->force[j] : 0.0;
        }
        if (imk_calibration_observe(call->calibration, &o) < 0)
            return imki_reference_room(call, 1);
    }
    return IMK_OK;
}

/* What is hardly turning shows no lever arms, and may be a change of mounting: it is dropped. */
static imk_status take_rests_off(const imki_procedure_call *call, const rests *r,
                                 const imki_pooled_noise *noise, size_t first)
{
    imk_calibration *c = call->calibration;
    size_t kept = first;
    for (size_t i = first; i < c->observation_count; i++) {
        if (imki_norm3(c->observation[i].rate) <= r->limit)
            continue;
        c->observation[kept] = c->observation[i];
        if (!take_off(r, noise, &c->observation[kept++]))
            return imki_reference_refuse(call, IMK_ERROR_KEY_MISSING, "reference_force", -1, 0.0,
                                         0.0,
                                         "without the specific force, the unit must turn about the "
                                         "vertical, with rests between the turns");
    }
    c->observation_count = kept;
    return IMK_OK;
}

imk_status imki_spin_observe(const imki_procedure_call *call, size_t stretch_count,
                             const imk_reference_stretch *stretch, int fixture)
{
    imk_calibration *c = call->calibration;
    const imk_test_record *record = c->record[call->record];
    const bool referenced = imki_reference_channels(record, IMK_ACCEL) != NULL;
    const size_t first = c->observation_count;
    const rests r = {call, stretch_count, stretch,
                     rest_share * fastest_of(call, stretch_count, stretch)};
    const imki_pooled_noise noise = imki_reference_noise(call, stretch_count, stretch);
    double sigma[IMK_AXES_MAX];
    imki_reference_sigmas(call, IMK_ACCEL, &noise, sigma);
    imk_status status = add_steady(call, &r, referenced, &noise, fixture);
    if (status == IMK_OK && stretch_count > 0)
        status =
            imki_reference_blocks(call, IMK_ACCEL, 0.0, fixture, stretch_count, stretch, sigma);
    if (status == IMK_OK && !referenced)
        status = take_rests_off(call, &r, &noise, first);
    return status;
}
