/* SPDX-License-Identifier: Apache-2.0 */
/* Random numbers of the instruments. Instances of a stream: 0-63 draws, 64-71 constants of the
 * run, 128 + 21 k … the stages of flicker noise k < 6 (enough up to 1.9 MHz; beyond, the
 * slowest shares the numbers of the fastest of the next). Terms: IMK_TERM_PHYSICS + 256 times the
 * occasion. */
#include "physics_internal.h"

enum { CONSTANTS = 64, FLICKERS = 128, FLICKER_INSTANCES = 21 };

static uint64_t stream_of(const imk_physics_settings *settings, int occasion, int instance)
{
    return imk_stream(settings->run, (uint16_t)(IMK_TERM_PHYSICS + 256 * occasion),
                      (uint8_t)instance, settings->axis);
}

void imki_draws_start(imki_draws *draws, const imk_physics_settings *settings, uint8_t source)
{
    draws->random = imk_random_seeded(settings->seed);
    draws->stream = stream_of(settings, settings->occasion, source);
    draws->next = 0;
    draws->position = IMKI_DRAWS;
    draws->silent = !settings->noise;
}

void imki_draws_fill(imki_draws *draws)
{
    if (draws->silent) {
        for (int i = 0; i < IMKI_DRAWS; i++)
            draws->buffer[i] = 0.0;
    } else {
        imk_random_normals(draws->random, draws->stream, draws->next, IMKI_DRAWS, draws->buffer);
        draws->next += IMKI_DRAWS;
    }
    draws->position = 0;
}

double imki_run_constant(const imk_physics_settings *settings, uint8_t source, double repeatability)
{
    double constant = 0.0;
    if (settings->noise)
        imk_random_normals(imk_random_seeded(settings->seed),
                           stream_of(settings, 0, CONSTANTS + source), 0, 1, &constant);
    return constant * repeatability;
}

void imki_wander_start(imki_wander *wander, const imk_physics_settings *settings, uint8_t source,
                       double repeatability, double instability)
{
    wander->constant = imki_run_constant(settings, source, repeatability);
    wander->position = IMKI_WANDER_BLOCK;
    wander->flickers =
        settings->noise && instability > 0.0 &&
        imk_flicker_start(&wander->flicker, (imk_flicker){instability, 0}, 1.0 / settings->rate,
                          imk_random_seeded(settings->seed),
                          stream_of(settings, settings->occasion,
                                    FLICKERS + FLICKER_INSTANCES * source)) == IMK_OK;
}

void imki_wander_fill(imki_wander *wander)
{
    for (int i = 0; i < IMKI_WANDER_BLOCK; i++)
        wander->buffer[i] = 0.0;
    imk_flicker_add(&wander->flicker, IMKI_WANDER_BLOCK, wander->buffer);
    wander->position = 0;
}
