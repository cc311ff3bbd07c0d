/* SPDX-License-Identifier: Apache-2.0 */
/* Thermal hysteresis. Between two temperatures the direction does not change, and the equation of
 * distort.h has the solution
 *
 *     p <- p (1 - E) + sign(dT) E,     E = 1 - e^(-|dT|/L),
 *
 * which is the same whatever steps the temperature takes on its way, as long as it does not turn.
 */
#include "imukit/distort.h"
#include "imukit/elementary.h"

#include <math.h>

imk_hysteresis imk_hysteresis_start(const imk_triad *triad)
{
    const imk_temperature_polynomial *polynomial = &triad->bias.temperature;
    const double span =
        polynomial->order > 0 ? (polynomial->maximum - polynomial->minimum) / 8.0 : 10.0;
    return (imk_hysteresis){.span = span, .temperature = NAN, .state = 0.0};
}

/* 1 - e^-x for x >= 0. Temperatures change little from sample to sample: below 1/1024 five terms of
 * the series are exact to rounding. */
static inline double approach(double x)
{
    if (x < 0x1p-10)
        return x * (1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0)))));
    return -imk_expm1(-x);
}

void imk_hysteresis_next(imk_hysteresis *hysteresis, size_t count, const double *temperature,
                         double *state)
{
    double last = hysteresis->temperature, p = hysteresis->state;
    const double per_span = 1.0 / hysteresis->span;
    for (size_t i = 0; i < count; i++) {
        const double change = temperature[i] - last;
        if (change != 0.0 && change == change) {
            /* What waits for p is one multiplication and one addition. */
            const double sign = change > 0.0 ? 1.0 : -1.0;
            const double gone = approach(sign * change * per_span);
            p = p * (1.0 - gone) + sign * gone;
        }
        /* A temperature that is missing changes nothing. */
        if (temperature[i] == temperature[i])
            last = temperature[i];
        state[i] = p;
    }
    hysteresis->temperature = last;
    hysteresis->state = p;
}
