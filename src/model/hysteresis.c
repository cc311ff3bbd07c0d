/* SPDX-License-Identifier: Apache-2.0 */
/* Thermal hysteresis. Between two temperatures the direction s does not change, and the equation of
 * distort.h has the solution
 *
 *     r <- r e^(-|dT|/L),     p = s (1 - r),
 *
 * where r = 1 - s p is the distance from the side of the loop that is being approached; at a turn
 * it becomes the distance from the other side, 2 - r. The steps that the temperature takes on its
 * way do not matter, as long as it does not turn. */
#include "imukit/distort.h"
#include "imukit/elementary.h"

#include <math.h>

imk_hysteresis imk_hysteresis_start(const imk_triad *triad)
{
    const imk_temperature_polynomial *polynomial = &triad->bias.temperature;
    const double span =
        polynomial->order > 0 ? (polynomial->maximum - polynomial->minimum) / 8.0 : 10.0;
    return (imk_hysteresis){.span = span, .temperature = NAN, .distance = 1.0};
}

#define SMALL 0x1p-13

/* e^-x for 0 <= x < SMALL: the next term of the series is below 2^-56. Temperatures change little
 * from sample to sample. */
static inline double small_decay(double x)
{
    return 1.0 - x * (1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0)));
}

void imk_hysteresis_next(imk_hysteresis *hysteresis, size_t count, const double *temperature,
                         double *state)
{
    imk_hysteresis h = *hysteresis;
    const double per_span = 1.0 / h.span;
    for (size_t i = 0; i < count; i++) {
        const double change = temperature[i] - h.temperature;
        const double x = h.direction * change * per_span;
        if (x > 0.0 && x < SMALL) { /* on as before: one multiplication waits for the last one */
            h.distance *= small_decay(x);
        } else if (change != 0.0 && change == change) {
            const double sign = change > 0.0 ? 1.0 : -1.0;
            if (sign != h.direction)
                h.distance = 2.0 - h.distance; /* 1 stays 1 at the first change */
            h.direction = sign;
            h.distance *= imk_exp(-(sign * change * per_span));
        }
        /* A temperature that is missing changes nothing. */
        if (temperature[i] == temperature[i])
            h.temperature = temperature[i];
        state[i] = h.state = h.direction * (1.0 - h.distance);
    }
    *hysteresis = h;
}
