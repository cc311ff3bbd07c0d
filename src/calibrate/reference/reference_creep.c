/* SPDX-License-Identifier: Apache-2.0 */
/* Does the unit creep while its reference is constant, as on a dividing head that turns on after it
 * was set? Then gravity turns slowly: the accelerometers have a slope within the holds.
 *
 * The means m_0 … m_3 of the quarters of a hold have three contrasts of equal variance, where the
 * noise is white,
 *
 *     slope (-3 -1 1 3)/sqrt(20),    bend (1 -1 -1 1)/2,    third (-1 3 -3 1)/sqrt(20)
 *
 * and a creep is in the first only. Flicker noise has 2.3 times the variance there that it has in
 * the mean of both others. A hold creeps if its slope is five times what bends and thirds are over
 * all holds, which flicker has on an axis in one of 1000, and three times its own, which keeps out
 * readings in coarse steps. */
#include "reference_internal.h"

#include <math.h>

static const double least_slope = 5.0, least_local = 3.0;

typedef struct contrasts {
    double slope, bend, third;
} contrasts;

static contrasts contrasts_of(const double *x, size_t begin, size_t end)
{
    const size_t length = (end - begin) / 4;
    double m[4] = {0.0};
    for (size_t k = 0; k < 4 * length; k++)
        m[k / length] += (x[begin + k] - x[begin]) / (double)length;
    return (contrasts){(3.0 * (m[3] - m[0]) + m[2] - m[1]) / sqrt(20.0),
                       0.5 * (m[0] - m[1] - m[2] + m[3]),
                       (m[3] - m[0] + 3.0 * (m[1] - m[2])) / sqrt(20.0)};
}

/* Mean square of bends and thirds over the holds, for a mean of one sample. */
static double noise_of(const double *x, size_t count, const imk_reference_stretch *stretch)
{
    double sum = 0.0, holds = 0.0;
    for (size_t i = 0; i < count; i++) {
        const contrasts c = contrasts_of(x, stretch[i].begin, stretch[i].end);
        const double square = 0.5 * (c.bend * c.bend + c.third * c.third) *
                              (double)((stretch[i].end - stretch[i].begin) / 4);
        if (!(square < HUGE_VAL))
            continue;
        sum += square;
        holds++;
    }
    return holds > 0.0 ? sum / holds : 0.0;
}

size_t imki_reference_creeping(const imk_test_record *record, size_t count,
                               const imk_reference_stretch *stretch)
{
    const int axes = record->axis_count[IMK_ACCEL];
    double noise[IMK_AXES_MAX];
    size_t creeping = 0;
    if (record->means)
        return 0;
    for (int axis = 0; axis < axes; axis++)
        noise[axis] = noise_of(record->reading[IMK_ACCEL][axis], count, stretch);
    for (size_t i = 0; i < count; i++) {
        const double length = (double)((stretch[i].end - stretch[i].begin) / 4);
        bool creeps = false;
        for (int axis = 0; axis < axes && length > 1.0; axis++) {
            const contrasts c =
                contrasts_of(record->reading[IMK_ACCEL][axis], stretch[i].begin, stretch[i].end);
            creeps = creeps || (noise[axis] > 0.0 &&
                                fabs(c.slope) > least_slope * sqrt(noise[axis] / length) &&
                                fabs(c.slope) > least_local * fmax(fabs(c.bend), fabs(c.third)));
        }
        creeping += creeps;
    }
    return creeping;
}
