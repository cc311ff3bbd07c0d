/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of stretches as observations: means with their sigma, and what is not usable. */
#include "base/algebra/vector_internal.h"
#include "base/refuse_internal.h"
#include "reference_internal.h"

#include "imukit/attitude.h"
#include "imukit/elementary.h"

#include <math.h>

/* Standard deviation of a rounded number, in steps. */
static const double rounding = 0.28867513459481287;

static const imk_test_record *record_of(const imki_procedure_call *call)
{
    return call->calibration->record[call->record];
}

imk_status imki_reference_refuse(const imki_procedure_call *call, imk_status status,
                                 const char *field, int index, double value, double limit,
                                 const char *expected)
{
    return imki_refuse_at(call->error, status, field, (size_t)index, value, limit, expected);
}

imk_status imki_reference_room(const imki_procedure_call *call, size_t wanted)
{
    const imk_calibration *c = call->calibration;
    if (c->observation && c->observation_count + wanted <= c->observation_capacity)
        return IMK_OK;
    return imki_reference_refuse(
        call, IMK_ERROR_WORKSPACE, "observation", -1, (double)(c->observation_count + wanted),
        (double)c->observation_capacity, "provide room for all observations");
}

double imki_reference_sensitivity(const imki_procedure_call *call, int sensor, int axis)
{
    return record_of(call)->counts[sensor]
               ? imk_model_triad(&call->calibration->model, sensor)->sensitivity.value[axis]
               : 1.0;
}

/* A tenth of what rounding to the output's step leaves: nothing is better known than that by the
 * mean of equal samples. Without a known step, a part in 1e9 of 1 unit. */
double imki_reference_floor(const imki_procedure_call *call, int sensor, int axis)
{
    const imk_triad *triad = imk_model_triad(&call->calibration->model, sensor);
    if (record_of(call)->counts[sensor])
        return 0.1 * rounding;
    const double step = triad->resolution.value[axis];
    return step > 0.0 ? 0.1 * rounding * step : 1e-9;
}

/* Without forces the attitude of the unit is not known, and g-sensitivity times gravity looks like
 * a bias; so does the Earth's rate, (Omega^2/3 along each axis, all directions alike), where the
 * table tells its own rates only. */
double imki_reference_offset_sigma(const imki_procedure_call *call,
                                   const imk_observation *observation)
{
    const imk_calibration *c = call->calibration;
    double variance = 0.0;
    if (call->procedure != IMK_PROCEDURE_RATE_TABLE)
        return 0.0;
    if (!(imki_norm3(observation->force) > 0.0)) {
        const double sigma = call->settings->g_sensitivity_sigma * c->gravity;
        variance += sigma * sigma;
    }
    if (record_of(call)->reference_on_ground)
        variance += c->earth_rate * c->earth_rate / 3.0;
    return sqrt(variance);
}

imk_observation imki_reference_blank(const imki_procedure_call *call, size_t begin, size_t end,
                                     int fixture)
{
    imk_observation o = {.knowledge = IMK_INPUT_KNOWN,
                         .record = call->record,
                         .begin = begin,
                         .end = end,
                         .temperature = (double)NAN,
                         .fixture = fixture,
                         .correlated = record_of(call)->means};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
            o.reading[sensor][axis] = (double)NAN;
            o.sigma[sensor][axis] = 1.0;
        }
    return o;
}

bool imki_reference_usable(const imki_procedure_call *call, int sensor, size_t begin, size_t end)
{
    const imk_test_record *record = record_of(call);
    const imk_triad *triad = imk_model_triad(&call->calibration->model, sensor);
    for (int axis = 0; axis < record->axis_count[sensor]; axis++) {
        const double *reading = record->reading[sensor][axis];
        const double range = triad->range.value[axis] > 0.0 ? triad->range.value[axis] : HUGE_VAL;
        const double sensitivity = imki_reference_sensitivity(call, sensor, axis);
        const double zero = record->counts[sensor] ? triad->zero_offset.value[axis] : 0.0;
        /* The last step below the range may be all that saturation shows. */
        const double limit = range * (1.0 - 1e-9) * fabs(sensitivity);
        for (size_t k = begin; k < end; k++)
            if (!(fabs(reading[k] - zero) < limit))
                return false;
    }
    return true;
}

imki_pooled_noise imki_reference_noise(const imki_procedure_call *call, size_t count,
                                       const imk_reference_stretch *stretch)
{
    imki_pooled_noise noise = {{{0.0}}};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int axis = 0; axis < record_of(call)->axis_count[sensor]; axis++) {
            double sum = 0.0;
            size_t n = 0;
            for (size_t i = 0; i < count; i++) {
                const double sigma = stretch[i].reading.sigma[sensor][axis];
                const double variance = sigma * sigma * (double)(stretch[i].end - stretch[i].begin);
                if (variance > 0.0 && variance < HUGE_VAL) {
                    sum += imk_ln(variance);
                    n++;
                }
            }
            noise.variance[sensor][axis] = n > 0 ? imk_exp(sum / (double)n) : 0.0;
        }
    return noise;
}

void imki_reference_sigmas(const imki_procedure_call *call, int sensor,
                           const imki_pooled_noise *noise, double sigma[IMK_AXES_MAX])
{
    for (int axis = 0; axis < record_of(call)->axis_count[sensor]; axis++)
        sigma[axis] =
            fmax(sqrt(noise->variance[sensor][axis]), imki_reference_floor(call, sensor, axis));
}

void imki_reference_take(const imki_procedure_call *call, int sensor,
                         const imki_pooled_noise *noise, const imk_reference_stretch *stretch,
                         imk_observation *observation)
{
    const imk_static_interval *reading = &stretch->reading;
    const bool stated = record_of(call)->means;
    const double samples = (double)(stretch->end - stretch->begin);
    for (int axis = 0; axis < record_of(call)->axis_count[sensor]; axis++) {
        const double own = reading->sigma[sensor][axis];
        const double pooled = sqrt(noise->variance[sensor][axis] / samples);
        observation->reading[sensor][axis] = reading->mean[sensor][axis];
        /* A stretch that is disturbed beyond what luck explains speaks for itself. */
        observation->sigma[sensor][axis] = fmax(stated || own > 3.0 * pooled ? own : pooled,
                                                imki_reference_floor(call, sensor, axis));
    }
    observation->temperature = reading->temperature;
    observation->temperature_rate =
        fabs(reading->temperature_rate) < HUGE_VAL ? reading->temperature_rate : 0.0;
}

void imki_reference_own(const imki_procedure_call *call, int sensor, const double *mean,
                        double vector[3])
{
    const imk_test_record *record = record_of(call);
    const imk_triad *triad = imk_model_triad(&call->calibration->model, sensor);
    /* Sums of e e^T and e y: their solution is the vector of least squares. */
    imk_matrix3 sum = {{{0.0}}};
    imk_vector3 right = {{0.0, 0.0, 0.0}};
    for (int axis = 0; axis < record->axis_count[sensor]; axis++) {
        const double *e = triad->direction[axis];
        const double y =
            imki_reading_si(&call->calibration->model, record, sensor, axis, mean[axis]);
        for (int i = 0; i < 3; i++) {
            right.v[i] += e[i] * y;
            for (int j = 0; j < 3; j++)
                sum.m[i][j] += e[i] * e[j];
        }
    }
    imk_matrix3 inverse;
    imk_vector3 solution = {{0.0, 0.0, 0.0}};
    if (imk_matrix3_inverse(sum, &inverse) == IMK_OK)
        solution = imk_matrix3_apply(inverse, right);
    for (int i = 0; i < 3; i++)
        vector[i] = solution.v[i];
}
