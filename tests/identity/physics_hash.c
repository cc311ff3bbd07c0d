/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of every instrument from first principles, hashed: the same on every machine.
 *
 * Each default design at each level it has, with noise, turning and pulled in all axes and warming;
 * all outputs and internal signals enter as the bits they are. */
#include "imukit/instrument.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 60 };

/* FNV-1a [FOWLER1991]. */
static uint64_t add_number(uint64_t hash, double number)
{
    unsigned char bytes[sizeof number];
    memcpy(bytes, &number, sizeof number);
    for (size_t i = 0; i < sizeof number; i++)
        hash = (hash ^ bytes[i]) * 0x100000001B3u;
    return hash;
}

/* Slow enough for the fringe of a fibre coil, strong enough to matter to each. */
static imk_exposure exposure_of(int sample)
{
    imk_exposure exposure = imk_exposure_default();
    for (int k = 0; k < 3; k++) {
        exposure.angular_rate[k] = 0.01 * (k + 1) + 1e-3 * (sample % 7);
        exposure.angular_acceleration[k] = 0.02 * (sample % 3 - 1);
        exposure.specific_force[k] = 2.0 - k + 0.1 * (sample % 5);
    }
    exposure.temperature = 293.15 + 0.05 * sample;
    exposure.temperature_rate = 5.0;
    return exposure;
}

static uint64_t run(uint64_t hash, const imk_instrument *instrument, imk_level level, void *design,
                    void *state)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX] = {0}, signals[IMK_INSTRUMENT_SIGNALS_MAX] = {0};
    imk_physics_settings settings = imk_physics_default();
    settings.seed = 3;
    settings.rate = 500.0;
    settings.level = level;
    if (imk_instrument_init(instrument, design, &settings, state, NULL) != IMK_OK)
        return add_number(hash, -1.0);
    for (int i = 0; i < SAMPLES; i++) {
        const imk_exposure exposure = exposure_of(i);
        instrument->step(state, &exposure, outputs);
        instrument->observe(state, signals);
        for (size_t k = 0; k < instrument->output_count; k++)
            hash = add_number(hash, outputs[k]);
        for (size_t k = 0; k < instrument->signal_count; k++)
            hash = add_number(hash, signals[k]);
    }
    return hash;
}

int main(void)
{
    uint64_t hash = 0xCBF29CE484222325u;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *instrument = imk_instrument_get(i);
        void *design = malloc(instrument->design_size);
        void *state = aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
        if (!design || !state)
            return EXIT_FAILURE;
        instrument->set_default(design);
        hash = run(hash, instrument, IMK_LEVEL_FULL, design, state);
        hash = run(hash, instrument, IMK_LEVEL_SLOW, design, state);
        free(state);
        free(design);
        /* the hash so far, so that a difference names its instrument */
        printf("%s %016llx\n", instrument->name, (unsigned long long)hash);
    }
    return EXIT_SUCCESS;
}
