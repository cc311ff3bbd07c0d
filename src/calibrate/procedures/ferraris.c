/* SPDX-License-Identifier: Apache-2.0 */
/* ferraris: six holds and a full turn about each axis, by hand on a plate or on a table.
 *
 * The holds are those of sixposition. A turn by the angle a that takes T is an observation of the
 * mean rate a/T about its axis, whatever the motion between was like, and of
 *
 *     G times the mean force, which the accelerometers tell, corrected by the holds,
 *
 * with the Earth's rate: its vertical part points as the mean force does, W sin(latitude) f/g; its
 * level part stays along the axis, where that is not vertical, and is averaged out across it by the
 * turn, up to |mean of e^(i angle)|. */
#include "six_position_internal.h"

#include "imukit/attitude.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

size_t imki_ferraris_workspace(const imk_test_record *record,
                               const imk_procedure_settings *settings)
{
    return imki_stretches_workspace(record, settings);
}

imk_status imk_ferraris_stretches(const imk_test_record *record,
                                  const imk_procedure_settings *settings, const imk_model *model,
                                  double gravity, size_t capacity, imk_ferraris_stretch *stretch,
                                  size_t *count, void *workspace, size_t workspace_size,
                                  imk_error *error)
{
    imki_session_stretches list;
    imk_static_findings stationary;
    imk_status status = imki_stretches_find(record, settings, model, gravity, workspace,
                                            workspace_size, &list, &stationary, error);
    if (status == IMK_OK)
        status = imki_faces_complete(&list, error);
    if (status == IMK_OK)
        status = imki_turns_find(record, settings, model, &list, error);
    if (status != IMK_OK)
        return status;
    for (size_t k = 0; k < list.count && k < capacity; k++)
        stretch[k] = list.stretch[k].at;
    *count = list.count;
    return IMK_OK;
}

/* ---- what the gyros' counts stand for ---------------------------------------------------------
 */

static double rest_reading(const imki_session_stretches *list, int axis)
{
    double sum = 0.0, samples = 0.0;
    for (size_t k = 0; k < list->count; k++)
        if (!list->stretch[k].at.turn) {
            const double n = (double)(list->stretch[k].at.end - list->stretch[k].at.begin);
            sum += n * list->stretch[k].summary.mean[IMK_GYRO][axis];
            samples += n;
        }
    return sum / samples;
}

/* Nominal sensitivity: one number for the three of a part, with the sign of each axis; a zero other
 * than 0 only where readings are plainly offset. */
static void nominal_counts(const imk_test_record *record, const imki_session_stretches *list,
                           double turn_angle, imk_triad *gyro)
{
    double per_unit[3] = {0.0}, turns[3] = {0.0}, rest[3], sum = 0.0;
    bool offset = false;
    for (int i = 0; i < 3; i++)
        rest[i] = rest_reading(list, i);
    for (size_t k = 0; k < list->count; k++) {
        const imk_ferraris_stretch *at = &list->stretch[k].at;
        if (!at->turn)
            continue;
        const int i = at->axis;
        const imki_turn_means means = imki_turn_mean(record, at->begin, at->end);
        const double rate = at->sense * turn_angle / means.duration;
        per_unit[i] += (means.reading[IMK_GYRO][i] - rest[i]) / rate;
        turns[i] += 1.0;
        offset = offset || fabs(rest[i]) > fabs(means.reading[IMK_GYRO][i] - rest[i]);
    }
    for (int i = 0; i < 3; i++)
        sum += fabs(per_unit[i] / turns[i]) / 3.0;
    for (int i = 0; i < 3; i++) {
        const double sign = per_unit[i] < 0.0 ? -1.0 : 1.0;
        gyro->sensitivity.value[i] = sign * imki_round_digits(sum, 3);
        gyro->zero_offset.value[i] = offset ? rint(rest[i]) : 0.0;
    }
}

/* ---- forces ------------------------------------------------------------------------------------
 */

/* Readings of the accelerometers to force, by the holds: f = M^-1 (reading - b), the columns of M
 * half the difference of the readings up and down over g, b the mean of all six. */
typedef struct force_meter {
    imk_matrix3 inverse;
    double bias[3];
} force_meter;

static bool force_meter_of(const imki_session_stretches *list, double gravity, force_meter *meter)
{
    double mean[3][2][3] = {{{0.0}}}, samples[3][2] = {{0.0}};
    imk_matrix3 response;
    for (size_t k = 0; k < list->count; k++) {
        const imki_session_stretch *hold = &list->stretch[k];
        const int axis = hold->at.axis, down = hold->at.sense < 0;
        const double n = (double)(hold->at.end - hold->at.begin);
        if (hold->at.turn)
            continue;
        samples[axis][down] += n;
        for (int i = 0; i < 3; i++)
            mean[axis][down][i] += n * hold->summary.mean[IMK_ACCEL][i];
    }
    for (int i = 0; i < 3; i++) {
        meter->bias[i] = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            const double up = mean[axis][0][i] / samples[axis][0],
                         down = mean[axis][1][i] / samples[axis][1];
            response.m[i][axis] = (up - down) / (2.0 * gravity);
            meter->bias[i] += (up + down) / 6.0;
        }
    }
    return imk_matrix3_inverse(response, &meter->inverse) == IMK_OK;
}

static void force_of(const force_meter *meter, const double reading[3], double force[3])
{
    imk_vector3 v;
    for (int i = 0; i < 3; i++)
        v.v[i] = reading[i] - meter->bias[i];
    v = imk_matrix3_apply(meter->inverse, v);
    memcpy(force, v.v, sizeof v.v);
}

/* ---- turns ------------------------------------------------------------------------------------
 */

/* |mean of e^(i angle)| over a turn, the angle by the gyro about its axis: 0 when the turn is even,
 * 1 when the unit stands nearly all the time. */
static double unevenness(const imk_test_record *record, const imk_ferraris_stretch *at, double rest,
                         double per_unit)
{
    double angle = 0.0, cosine = 0.0, sine = 0.0;
    for (size_t k = at->begin; k < at->end; k++) {
        angle += (record->reading[IMK_GYRO][at->axis][k] - rest) / per_unit * record->dt;
        cosine += imk_cos(angle);
        sine += imk_sin(angle);
    }
    return sqrt(cosine * cosine + sine * sine) / (double)(at->end - at->begin);
}

/* The Earth's rate over a turn: what the mean force tells of it, and sigmas of the rest. Where the
 * latitude is not known the vertical part is not either. */
static void earth_in_turn(const imk_calibration *c, int axis, const double force[3], double uneven,
                          double rate[3], double sigma[3])
{
    const double third = sqrt(1.0 / 3.0);
    const bool known = !isnan(c->latitude);
    const double vertical = known ? c->earth_rate * imk_sin(c->latitude) : 0.0;
    const double level = c->earth_rate * (known ? imk_cos(c->latitude) : sqrt(2.0) * third);
    for (int i = 0; i < 3; i++) {
        const double up = force[i] / c->gravity;
        const double share = i == axis ? sqrt(fmax(0.0, 1.0 - up * up)) : uneven;
        rate[i] = vertical * up;
        sigma[i] = level * share * sqrt(0.5);
        if (!known)
            sigma[i] =
                sqrt(sigma[i] * sigma[i] + c->earth_rate * c->earth_rate * up * up * third * third);
    }
}

/* Density of the gyros' noise by the holds: sigma of a mean times the square root of its time. */
static double noise_density(const imk_test_record *record, const imki_session_stretches *list,
                            int axis)
{
    double sum = 0.0, holds = 0.0;
    for (size_t k = 0; k < list->count; k++) {
        const imki_session_stretch *hold = &list->stretch[k];
        if (hold->at.turn)
            continue;
        const double sigma = hold->summary.sigma[IMK_GYRO][axis];
        sum += sigma * sigma * (double)(hold->at.end - hold->at.begin) * record->dt;
        holds += 1.0;
    }
    return sqrt(sum / holds);
}

static void observe_turn(const imki_procedure_call *call, const imki_session_stretches *list,
                         const force_meter *meter, const imk_ferraris_stretch *at, int fixture)
{
    imk_calibration *c = call->calibration;
    const imk_test_record *record = c->record[call->record];
    const double placement = call->settings->placement_sigma;
    const imki_turn_means means = imki_turn_mean(record, at->begin, at->end);
    imk_observation observation = {.knowledge =
                                       placement > 0.0 ? IMK_INPUT_PLACED : IMK_INPUT_KNOWN,
                                   .record = call->record,
                                   .begin = at->begin,
                                   .end = at->end,
                                   .temperature = means.temperature,
                                   .placement_sigma = placement,
                                   .turn_time = means.duration,
                                   .fixture = fixture};
    double earth_sigma[3];
    force_of(meter, means.reading[IMK_ACCEL], observation.force);
    const double per_unit = imki_counts_per_unit(&c->model, record, IMK_GYRO, at->axis);
    const double uneven = unevenness(record, at, rest_reading(list, at->axis), per_unit);
    earth_in_turn(c, at->axis, observation.force, uneven, observation.rate, earth_sigma);
    observation.rate[at->axis] += at->sense * call->settings->turn_angle / means.duration;
    for (int i = 0; i < IMK_AXES_MAX; i++) {
        observation.reading[IMK_GYRO][i] = observation.reading[IMK_ACCEL][i] = (double)NAN;
        observation.sigma[IMK_GYRO][i] = observation.sigma[IMK_ACCEL][i] = 1.0;
    }
    for (int i = 0; i < 3; i++) {
        const double counts = fabs(imki_counts_per_unit(&c->model, record, IMK_GYRO, i));
        const double sigma = noise_density(record, list, i) / sqrt(means.duration);
        observation.reading[IMK_GYRO][i] = means.reading[IMK_GYRO][i];
        observation.sigma[IMK_GYRO][i] = sigma > 0.0 ? sigma : 1e-9 * counts;
        observation.heading_variance[i] = earth_sigma[i] * earth_sigma[i];
    }
    (void)imk_calibration_observe(c, &observation);
}

static imk_status free_terms(const imki_procedure_call *call)
{
    static const struct {
        int term, elements;
    } terms[] = {{IMK_MODEL_BIAS, 1}, {IMK_MODEL_SCALE_FACTOR, 1}, {IMK_MODEL_MISALIGNMENT, 3}};
    imk_status status = IMK_OK;
    for (int sensor = 1; status == IMK_OK && sensor >= 0; sensor--)
        for (int t = 0; status == IMK_OK && t < 3; t++)
            status = imki_free_term(call, sensor, terms[t].term, terms[t].elements, true);
    if (status == IMK_OK && call->settings->g_sensitivity)
        status = imki_free_term(call, IMK_GYRO, IMK_MODEL_G_SENSITIVITY, 3, true);
    return status;
}

imk_status imki_ferraris_observe(const imki_procedure_call *call)
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
        status = imki_turns_find(record, call->settings, &c->model, &list, call->error);
    if (status != IMK_OK)
        return status;
    force_meter meter;
    if (!force_meter_of(&list, c->gravity, &meter))
        return imk_error_set(
            call->error, IMK_ERROR_SINGULAR, "accel", NULL,
            "check the accelerometers: their readings do not distinguish the six holds");
    if (!imki_unit_known(&c->model, record, IMK_GYRO))
        nominal_counts(record, &list, call->settings->turn_angle, &c->model.gyro);
    status = imki_holds_observe(call, &list, 0, &fixture);
    for (size_t k = 0; status == IMK_OK && k < list.count; k++)
        if (list.stretch[k].at.turn)
            observe_turn(call, &list, &meter, &list.stretch[k].at, fixture);
    return status == IMK_OK ? free_terms(call) : status;
}
