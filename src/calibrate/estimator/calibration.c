/* SPDX-License-Identifier: Apache-2.0 */
/* The problem of a calibration: its default, what is free, what was observed. */
#include "calibration_internal.h"

#include "imukit/distributions.h"
#include "imukit/earth.h"

#include <math.h>
#include <string.h>

const char *imk_triad_frame_name(imk_triad_frame frame)
{
    static const char *const names[] = {"upper-triangular", "lower-triangular", "symmetric",
                                        "reference"};
    return (unsigned)frame < sizeof names / sizeof *names ? names[frame] : NULL;
}

void imk_calibration_default(imk_calibration *calibration)
{
    memset(calibration, 0, sizeof *calibration);
    calibration->cookie = IMKI_CALIBRATION_COOKIE;
    imk_model_default(&calibration->model);
    calibration->frame = IMK_FRAME_UPPER;
    calibration->gravity = imk_normal_gravity(0.7853981633974483, 0.0);
    calibration->latitude = (double)NAN;
    calibration->earth_rate = IMK_EARTH_RATE;
    calibration->robust = true;
}

static void set_prior(imk_calibration *c, size_t p, double sigma, bool guessed, bool hidden)
{
    c->prior_sigma[p] = sigma;
    c->prior_guessed[p] = guessed;
    c->hidden[p] = hidden;
}

imk_status imk_calibration_free(imk_calibration *calibration, int sensor, int term, int axis,
                                int element)
{
    if (sensor < 0 || sensor > 1 || term < 0 || term >= IMK_MODEL_TERMS || axis < 0 ||
        axis >= IMK_AXES_MAX || element < 0 || element >= imk_model_term_elements(sensor, term))
        return IMK_ERROR_ARGUMENT;
    const imk_model_parameter wanted = {(uint8_t)sensor, (uint8_t)term, (uint8_t)axis,
                                        (uint8_t)element};
    for (size_t p = 0; p < calibration->parameter_count; p++)
        if (memcmp(&calibration->parameter[p], &wanted, sizeof wanted) == 0) {
            if (calibration->prior_guessed[p])
                set_prior(calibration, p, 0.0, false, false);
            return IMK_OK;
        }
    if (calibration->parameter_count >= IMK_CORRELATED_MAX)
        return IMK_ERROR_RANGE;
    calibration->parameter[calibration->parameter_count] = wanted;
    set_prior(calibration, calibration->parameter_count++, 0.0, false, false);
    return IMK_OK;
}

imk_status imk_calibration_consider(imk_calibration *calibration, imk_model_parameter parameter,
                                    double sigma, bool hidden)
{
    const size_t before = calibration->parameter_count;
    if (!(sigma > 0.0 && sigma < HUGE_VAL))
        return IMK_ERROR_ARGUMENT;
    for (size_t p = 0; p < before; p++)
        if (memcmp(&calibration->parameter[p], &parameter, sizeof parameter) == 0)
            return IMK_OK;
    const imk_status status = imk_calibration_free(calibration, parameter.sensor, parameter.term,
                                                   parameter.axis, parameter.element);
    if (status == IMK_OK)
        set_prior(calibration, before, sigma, true, hidden);
    return status;
}

int imk_calibration_observe(imk_calibration *calibration, const imk_observation *observation)
{
    if (calibration->observation_count >= calibration->observation_capacity ||
        !calibration->observation)
        return -1;
    calibration->observation[calibration->observation_count] = *observation;
    return (int)calibration->observation_count++;
}

double imk_calibration_half_width(const imk_calibration_result *result, int index,
                                  double confidence)
{
    if (index < 0 || (size_t)index >= result->parameter_count ||
        !(confidence > 0.0 && confidence < 1.0))
        return (double)NAN;
    return result->sigma[index] *
           imk_student_quantile(0.5 + 0.5 * confidence, result->freedom[index]);
}
