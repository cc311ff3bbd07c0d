/* SPDX-License-Identifier: Apache-2.0 */
/* Designs, settings and inputs of the tests of vibrating beams. */
#ifndef IMUKIT_TESTS_VIBRATING_BEAM_DESIGNS_H
#define IMUKIT_TESTS_VIBRATING_BEAM_DESIGNS_H

#include "instrument_run.h"

#include "imukit/units.h"
#include "imukit/vibrating_beam.h"
#include "physics/vibrating_beam/vibrating_beam_internal.h"

#define G IMK_STANDARD_GRAVITY
static const imk_instrument *const beam = &imk_vibrating_beam_instrument;

/* Without anything but the beams. */
static inline imk_vibrating_beam plain(void)
{
    imk_vibrating_beam d = imk_vibrating_beam_default();
    d.mount_force = d.frequency_mismatch = d.temperature_mismatch = d.clock = 0.0;
    d.pickoff_noise = 0.0;
    return d;
}

static inline imk_physics_settings quiet(double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.noise = false;
    return settings;
}

static inline imk_exposure force_of(double force)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.specific_force[0] = force;
    return exposure;
}

#endif
