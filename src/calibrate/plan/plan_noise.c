/* SPDX-License-Identifier: Apache-2.0 */
/* How well the mean over a time T is known. Of a quantized integral only the two ends of the
 * stretch count, 2 Q^2/T^2. Rounded samples add step^2/12 of each. */
#include "plan_internal.h"

#include "noise/noise_terms_internal.h"

#include <math.h>

double imki_plan_mean_variance(const imk_triad *triad, int axis, double dt, double time)
{
    const double q = triad->noise.quantization.value[axis];
    double step = triad->resolution.value[axis], variance = 0.0;
    if (triad->sensitivity.value[axis] != 0.0)
        step = fmax(step, 1.0 / fabs(triad->sensitivity.value[axis]));
    for (int t = 0; t < IMKI_NOISE_TERMS; t++) {
        const imki_noise_term *term = imki_noise_terms[t];
        const int count = imki_term_count(term, &triad->noise);
        imki_term_place place = {triad, axis, 0};
        for (; place.instance < count; place.instance++)
            if (term->strength(place) != 0.0)
                variance += term->mean_variance(place, dt, time);
    }
    return variance + imk_ramp_allan_variance(triad->noise.ramp.value[axis], time) +
           2.0 * q * q / (time * time) + step * step / 12.0 * dt / time;
}

double imki_plan_floor_variance(const imk_model *model, imk_model_parameter parameter)
{
    const imk_triad *triad = imk_model_triad(model, parameter.sensor);
    if (parameter.term == IMK_MODEL_SCALE_FACTOR) {
        const double r = triad->scale_factor.repeatability.value[parameter.axis];
        return r * r;
    }
    if (parameter.term != IMK_MODEL_BIAS)
        return 0.0;
    const double r = triad->bias.repeatability.value[parameter.axis];
    return r * r +
           imk_flicker_allan_variance(triad->noise.bias_instability.value[parameter.axis], 1.0);
}
