/* SPDX-License-Identifier: Apache-2.0 */
/* Means over a trajectory in portable C: two intervals at once where a processor has pairs of
 * doubles, else one, in functions that stay apart as what has no such registers has little memory,
 * too. For every processor, and the reference of the other kernels; also the state at one instant.
 */
#include <math.h>
#include <stdint.h>

#if defined(__SSE2__) || defined(__aarch64__)
#define LANES 2
#else
#define LANES 1
#define KERNEL static
#endif

typedef double real __attribute__((vector_size(8 * LANES)));

#ifdef __SSE2__
#include <emmintrin.h>

static inline real square_root(real a)
{
    return (real)_mm_sqrt_pd((__m128d)a);
}
#else
static inline real square_root(real a)
{
    for (int lane = 0; lane < LANES; lane++)
        a[lane] = sqrt(a[lane]);
    return a;
}
#endif

#include "trajectory_kernel.h"

void imki_means_of_intervals_portable(const imk_trajectory *trajectory, size_t count,
                                      imki_intervals *intervals)
{
    means_of_intervals(trajectory, count, intervals);
}

void imki_means_of_samples_portable(const imk_trajectory *trajectory,
                                    const imk_trajectory_piece *piece, size_t count,
                                    const double *boundary, const imki_means *means)
{
    means_of_samples(trajectory, piece, count, boundary, means);
}

/* -0 becomes 0, as in the means. */
static void take_first_lane(vector from, double to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = from.v[i][0] + 0.0;
}

void imki_instant_of(const imk_trajectory *trajectory, const imk_trajectory_piece *piece,
                     double time, imki_instant *instant)
{
    const coefficients from = {
        .same = true, .position = &piece->position[0][0], .quaternion = &piece->quaternion[0][0]};
    const real s = spread(time - piece->start);
    node at;
    if (trajectory->line_count > 0)
        at = node_at(trajectory, true, &from, spread(time), s, NULL);
    else
        at = node_at(trajectory, false, &from, spread(time), s, NULL);
    take_first_lane(at.position, instant->position);
    take_first_lane(at.velocity, instant->velocity);
    take_first_lane(at.rotation, instant->rotation);
    take_first_lane(at.rate, instant->rate);
    take_first_lane(at.acceleration, instant->acceleration);
    take_first_lane(at.force, instant->force);
}
