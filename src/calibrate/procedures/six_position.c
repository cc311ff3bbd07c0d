/* SPDX-License-Identifier: Apache-2.0 */
/* sixposition: each axis of the housing up and down on a level plate.
 *
 * The specific force at rest points up, so a hold with axis i up is exposed to +g e_i, but for its
 * placement. The Earth turns the unit by
 *
 *     w = W sin(latitude) up + W cos(latitude) north
 *
 * of which the heading of the unit, and so its direction to the north, is not known: that part adds
 * (W cos(latitude))^2/2 to the variance of both gyros across the vertical. */
#include "six_position_internal.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>

size_t imki_six_position_workspace(const imk_test_record *record,
                                   const imk_procedure_settings *settings)
{
    return imki_stretches_workspace(record, settings);
}

/* ---- the Earth --------------------------------------------------------------------------------
 */

void imki_earth_at_rest(const imk_calibration *calibration, const double up[3], double rate[3],
                        double sigma[3])
{
    const double total = calibration->earth_rate, latitude = calibration->latitude;
    if (isnan(latitude)) {
        /* Anywhere on Earth, all directions alike: each component has the variance W^2/3. That of
         * the vertical is the same up and down and does not average out, so it counts twice. */
        for (int i = 0; i < 3; i++) {
            rate[i] = 0.0;
            sigma[i] = total * sqrt((1.0 + up[i] * up[i]) / 3.0);
        }
        return;
    }
    const double vertical = total * imk_sin(latitude), level = total * imk_cos(latitude);
    for (int i = 0; i < 3; i++) {
        rate[i] = vertical * up[i];
        sigma[i] = level * sqrt(0.5 * fmax(0.0, 1.0 - up[i] * up[i]));
    }
}

/* ---- observations -----------------------------------------------------------------------------
 */

/* Half a count: what a mean may be off when no noise carries the reading over the steps. */
static double smallest_sigma(const imk_model *model, const imk_test_record *record, int sensor,
                             int axis)
{
    static const double uniform = 0.28867513459481287; /* 1/sqrt(12) */
    const double resolution = imk_model_triad(model, sensor)->resolution.value[axis];
    if (record->counts[sensor])
        return uniform;
    return resolution > 0.0 ? uniform * resolution : 1e-9;
}

/* What the rounding to steps leaves in the mean of a gyro is the same in all holds, and does not
 * average out: it counts as often as there are holds. */
static double add_rounding(double sigma, const imk_static_interval *hold, size_t holds, int axis)
{
    const double rounding = hold->rounding[IMK_GYRO][axis];
    return sqrt(sigma * sigma + ((double)holds - 1.0) * rounding * rounding);
}

static void set_readings(const imki_procedure_call *call, const imk_static_interval *hold,
                         size_t holds, const double earth_sigma[3], imk_observation *observation)
{
    const imk_model *model = &call->calibration->model;
    const imk_test_record *record = call->calibration->record[call->record];
    for (int s = 0; s < 2; s++) {
        const bool known = imki_unit_known(model, record, s);
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            observation->reading[s][i] = (double)NAN;
            observation->sigma[s][i] = 1.0;
            if (i >= record->axis_count[s] || !known || !isfinite(hold->mean[s][i]))
                continue;
            double sigma = hold->sigma[s][i];
            if (!(sigma > 0.0))
                sigma = smallest_sigma(model, record, s, i);
            if (s == IMK_GYRO)
                sigma = add_rounding(sigma, hold, holds, i);
            if (s == IMK_GYRO && i < 3)
                observation->heading_variance[i] = earth_sigma[i] * earth_sigma[i];
            observation->reading[s][i] = hold->mean[s][i];
            observation->sigma[s][i] = sigma;
        }
    }
}

/* Is rounding most of what the bias of a gyro is uncertain by? */
static bool is_coarse(const imk_test_record *record, const imki_session_stretches *list,
                      size_t holds)
{
    bool coarse = false;
    for (int i = 0; i < record->axis_count[IMK_GYRO]; i++) {
        double all = 0.0, rounding = 0.0;
        for (size_t k = 0; k < list->count; k++) {
            const imk_static_interval *hold = &list->stretch[k].summary;
            if (list->stretch[k].at.turn || !isfinite(hold->sigma[IMK_GYRO][i]))
                continue;
            all += hold->sigma[IMK_GYRO][i] * hold->sigma[IMK_GYRO][i];
            rounding += hold->rounding[IMK_GYRO][i] * hold->rounding[IMK_GYRO][i];
        }
        coarse = coarse || (double)holds * rounding > all - rounding;
    }
    return coarse;
}

/* Mean of two holds, by their samples. */
static void pool(imk_static_interval *to, const imk_static_interval *more, double *samples)
{
    const double own = *samples, other = (double)(more->end - more->begin), all = own + other;
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const double a = own * to->sigma[s][i] / all, b = other * more->sigma[s][i] / all;
            to->mean[s][i] = (own * to->mean[s][i] + other * more->mean[s][i]) / all;
            to->sigma[s][i] = sqrt(a * a + b * b);
            to->rounding[s][i] = fmax(to->rounding[s][i], more->rounding[s][i]);
        }
    to->temperature = (own * to->temperature + other * more->temperature) / all;
    to->temperature_rate = (own * to->temperature_rate + other * more->temperature_rate) / all;
    *samples = all;
}

/* What a placement reads: in its hold, and in those that turns led to from there. Holds are in
 * order of time. */
static imk_static_interval of_placement(const imki_session_stretches *list, size_t hold)
{
    imk_static_interval summary = list->stretch[hold].summary;
    double samples = (double)(summary.end - summary.begin);
    for (size_t k = hold + 1; k < list->count; k++) {
        const imki_session_stretch *next = &list->stretch[k];
        if (next->at.turn)
            continue;
        if (!next->again)
            break;
        pool(&summary, &next->summary, &samples);
    }
    return summary;
}

/* Smallest eigenvalue of the mean outer product of the directions of holds: of axes, the smallest
 * share of the holds. */
static double spread_of(const imki_session_stretches *list)
{
    double holds[3] = {0.0};
    for (size_t k = 0; k < list->count; k++)
        if (!list->stretch[k].at.turn)
            holds[list->stretch[k].at.axis] += 1.0;
    return fmin(fmin(holds[0], holds[1]), holds[2]) / (holds[0] + holds[1] + holds[2]);
}

imk_status imki_holds_observe(const imki_procedure_call *call, const imki_session_stretches *list,
                              size_t more, int *fixture)
{
    imk_calibration *c = call->calibration;
    const imk_procedure_settings *settings = call->settings;
    const size_t needed = c->observation_count + list->count + more;
    if (needed > c->observation_capacity) {
        return imki_refuse(call->error, IMK_ERROR_WORKSPACE, "observations", (double)needed,
                           (double)c->observation_capacity,
                           "provide room for one observation per hold and turn");
    }
    *fixture = imki_add_fixture(call);
    if (*fixture == -2)
        return imk_error_set(call->error, IMK_ERROR_RANGE, "fixture", NULL,
                             "at most 8 mountings in one solution");
    for (int i = 0; i < 3 && list->sensitivity[i] > 0.0; i++) {
        c->model.accel.sensitivity.value[i] = list->sensitivity[i];
        c->model.accel.zero_offset.value[i] = list->zero_offset[i];
    }
    c->frame = IMK_FRAME_REFERENCE;
    size_t holds = 0;
    for (size_t k = 0; k < list->count; k++)
        holds += !list->stretch[k].at.turn && !list->stretch[k].again;
    c->gyro_coarse = c->gyro_coarse || is_coarse(c->record[call->record], list, holds);
    for (size_t k = 0; k < list->count; k++) {
        const imki_session_stretch *stretch = &list->stretch[k];
        if (stretch->at.turn || stretch->again)
            continue;
        const imk_static_interval summary = of_placement(list, k);
        imk_observation observation = {
            .knowledge = settings->placement_sigma > 0.0 ? IMK_INPUT_PLACED : IMK_INPUT_KNOWN,
            .record = call->record,
            .begin = stretch->at.begin,
            .end = stretch->at.end,
            .temperature = summary.temperature,
            .temperature_rate = isfinite(summary.temperature_rate) ? summary.temperature_rate : 0.0,
            .placement_sigma = settings->placement_sigma,
            .fixture = *fixture,
            .correlated = c->record[call->record]->means};
        double up[3] = {0.0}, earth_sigma[3];
        up[stretch->at.axis] = stretch->at.sense;
        observation.force[stretch->at.axis] = stretch->at.sense * c->gravity;
        imki_earth_at_rest(c, up, observation.rate, earth_sigma);
        set_readings(call, &summary, holds, earth_sigma, &observation);
        (void)imk_calibration_observe(c, &observation);
    }
    call->findings->intervals += list->found;
    call->findings->left_out += list->left_out;
    call->findings->contradicted += list->contradictions;
    call->findings->contradicted_at = list->contradicted.at.begin;
    call->findings->spread = spread_of(list);
    return IMK_OK;
}

imk_status imki_six_position_observe(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    const imk_test_record *record = c->record[call->record];
    imki_session_stretches list;
    int fixture;
    imk_status status =
        imki_stretches_find(record, call->settings, &c->model, c->gravity, call->workspace,
                            call->workspace_size, &list, &call->findings->stationary, call->error);
    if (status == IMK_OK)
        status = imki_faces_complete(&list, call->error);
    if (status == IMK_OK)
        status = imki_holds_observe(call, &list, 0, &fixture);
    if (status == IMK_OK)
        status = imki_free_term(call, IMK_ACCEL, IMK_MODEL_BIAS, 1, true);
    if (status == IMK_OK)
        status = imki_free_term(call, IMK_ACCEL, IMK_MODEL_SCALE_FACTOR, 1, true);
    if (status == IMK_OK)
        status = imki_free_term(call, IMK_ACCEL, IMK_MODEL_MISALIGNMENT, 3, true);
    if (status != IMK_OK || !imki_unit_known(&c->model, record, IMK_GYRO))
        return status;
    status = imki_free_term(call, IMK_GYRO, IMK_MODEL_BIAS, 1, true);
    if (status == IMK_OK && call->settings->g_sensitivity)
        status = imki_free_term(call, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, 3, true);
    return status;
}
