/* SPDX-License-Identifier: Apache-2.0 */
/* Random motion for tests. */
#ifndef IMUKIT_TESTS_RANDOM_PIECES_H
#define IMUKIT_TESTS_RANDOM_PIECES_H

#include "imukit/elementary.h"
#include "imukit/motion.h"

#include <math.h>
#include <string.h>

/* Uniform in [-1, 1): the high bits of a multiplicative congruential sequence [STEELE2022]. */
static inline double uniform(uint64_t *state)
{
    *state = *state * UINT64_C(0xd1342543de82ef95) + 1;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Smooth pieces, not joined: turning at about 1 rad/s, 20 m/s fast and with 5 m/s^2. */
static inline void random_pieces(size_t count, double length, uint64_t seed,
                                 imk_trajectory_piece *piece)
{
    for (size_t i = 0; i < count; i++) {
        piece[i] = (imk_trajectory_piece){.start = 3.0 + length * (double)i, .length = length};
        for (int axis = 0; axis < 3; axis++)
            for (int power = 0; power < 7; power++)
                piece[i].position[axis][power] = 40.0 * ldexp(uniform(&seed), -power);
        for (int part = 0; part < 4; part++)
            for (int power = 0; power < 6; power++)
                piece[i].quaternion[part][power] =
                    0.5 * uniform(&seed) * imk_exp(-power) + (power == 0 && part == 1 ? 1.0 : 0.0);
    }
}

static inline imk_trajectory on_earth(size_t count, const imk_trajectory_piece *piece)
{
    imk_trajectory trajectory = {.earth = true, .piece_count = count, .piece = piece};
    const imk_vector3 origin = imk_ecef_from_geodetic((imk_geodetic){0.9, 0.22, 80.0});
    memcpy(trajectory.origin, origin.v, sizeof origin.v);
    return trajectory;
}

static const imk_vibration_line lines[] = {
    {0, 2e-3, 3.1, 0.1}, {1, 1e-3, 5.7, 0.7}, {2, 3e-3, 2.2, -0.3}, {3, 2e-2, 1.9, 0.25},
    {4, 3e-2, 2.9, 0.5}, {5, 1e-2, 4.1, 0.9}, {5, 2e-2, 0.7, 0.2}};
enum { LINES = sizeof lines / sizeof *lines };

#endif
