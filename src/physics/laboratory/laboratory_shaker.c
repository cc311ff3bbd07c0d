/* SPDX-License-Identifier: Apache-2.0 */
/* Frequency response: sines at frequencies in equal ratios, and where the gain falls by 3 dB below
 * that of the lowest, by interpolation between the logarithms. */
#include "laboratory_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Of full scale: small enough for the response to be linear. */
static const double amplitude = 0.05;

static double crossing(const imk_laboratory_response *a, const imk_laboratory_response *b,
                       double gain)
{
    const double fraction = imk_ln(a->gain / gain) / imk_ln(a->gain / b->gain);
    return a->frequency * imk_exp(fraction * imk_ln(b->frequency / a->frequency));
}

void imki_shaker(const imk_laboratory *laboratory, double bandwidth, char *states,
                 const imk_executor *executor, imk_laboratory_result *result)
{
    imki_trial trials[IMK_LABORATORY_FREQUENCIES_MAX];
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
    const int count = laboratory->frequencies;
    const double rate = laboratory->physics.rate;
    const double lowest = laboratory->lowest > 0.0 ? laboratory->lowest
                          : bandwidth > 0.0        ? bandwidth / 30.0
                                                   : 0.01 * rate;
    const double highest = laboratory->highest > 0.0 ? laboratory->highest
                           : bandwidth > 0.0         ? bandwidth * 3.0
                                                     : 0.25 * rate;
    for (int i = 0; i < count; i++) {
        const double fraction = count > 1 ? (double)i / (count - 1) : 0.0;
        trials[i] = imki_trial_of(laboratory, 0.0);
        trials[i].input = amplitude * result->full_scale;
        trials[i].frequency = lowest * imk_exp(fraction * imk_ln(highest / lowest));
    }
    imki_trials_run(laboratory, (size_t)count, trials, states, executor);
    for (int i = 0; i < count; i++)
        if (isfinite(trials[i].sine.gain))
            result->response[result->response_count++] = trials[i].sine;
    for (int i = 1; i < result->response_count; i++) {
        const imk_laboratory_response *r = &result->response[i - 1];
        const double limit = result->response[0].gain / sqrt(2.0);
        if (r[0].gain >= limit && r[1].gain < limit) {
            result->bandwidth = crossing(&r[0], &r[1], limit);
            triad->bandwidth.sigma[0] = (r[1].frequency - r[0].frequency) / sqrt(12.0);
            break;
        }
    }
    triad->bandwidth.value[0] = result->bandwidth;
}
