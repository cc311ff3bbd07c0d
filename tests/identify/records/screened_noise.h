/* SPDX-License-Identifier: Apache-2.0 */
/* Records of noise in memory, and their screening. Define SCREENED_SAMPLES before. */
#ifndef IMUKIT_TEST_SCREENED_NOISE_H
#define IMUKIT_TEST_SCREENED_NOISE_H

#include "check.h"
#include "imukit/noise.h"
#include "imukit/record_screen.h"

enum { N = SCREENED_SAMPLES };

static double rate[N];
static char memory[1 << 20];

/* White noise of standard deviation 1 about a level, with flicker noise and a random walk. */
static void make(uint64_t seed, double level, double flicker, double walk)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    const imk_random random = imk_random_seeded(seed);
    for (size_t i = 0; i < N; i++)
        rate[i] = level;
    imk_white_start(&w, 1, 1, random, 1);
    imk_white_add(&w, N, rate);
    imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random, 2);
    imk_flicker_add(&f, N, rate);
    imk_random_walk_start(&k, walk, 1, random, 3);
    imk_random_walk_add(&k, N, rate);
}

static imk_screen screen(void)
{
    imk_screen_settings settings = imk_screen_default();
    settings.dt = 0.01;
    imk_screen found;
    CHECK_OK(imk_screen_channel(&settings, N, rate, &found, memory, sizeof memory, NULL));
    return found;
}

#endif
