/* SPDX-License-Identifier: Apache-2.0 */
/* How well the mean over a time T is known: the Allan variance at T of the terms of the model,
 * which is half the mean square difference of two such means side by side. A quantized integral is
 * the exception: over one stretch only its two ends count, 2 Q^2/T^2. Rounded samples add step^2/12
 * of each. */
#include "plan_internal.h"

#include "imukit/noise.h"

#include <math.h>

double imki_plan_mean_variance(const imk_triad *triad, int axis, double dt, double time)
{
    const imk_noise *n = &triad->noise;
    const double q = n->quantization.value[axis];
    double step = triad->resolution.value[axis];
    if (triad->sensitivity.value[axis] != 0.0)
        step = fmax(step, 1.0 / fabs(triad->sensitivity.value[axis]));
    double variance = imk_white_allan_variance(n->white.value[axis], time) +
                      imk_flicker_allan_variance(n->bias_instability.value[axis], time) +
                      imk_random_walk_allan_variance(n->random_walk.value[axis], time) +
                      imk_ramp_allan_variance(n->ramp.value[axis], time) +
                      2.0 * q * q / (time * time) + step * step / 12.0 * dt / time;
    for (int i = 0; i < n->gauss_markov_count; i++) {
        const imk_gauss_markov process = {n->gauss_markov[i].sigma.value[axis],
                                          n->gauss_markov[i].correlation_time.value[axis]};
        if (process.sigma > 0.0)
            variance += imk_gauss_markov_allan_variance(process, time);
    }
    for (int i = 0; i < n->sinusoid_count; i++) {
        const imk_sinusoid sinusoid = {n->sinusoid[i].amplitude.value[axis],
                                       n->sinusoid[i].frequency.value[axis]};
        if (sinusoid.amplitude > 0.0)
            variance += imk_sinusoid_allan_variance(sinusoid, time);
    }
    return variance;
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
