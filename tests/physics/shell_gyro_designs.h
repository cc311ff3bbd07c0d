/* SPDX-License-Identifier: Apache-2.0 */
/* Designs of shell gyros for tests. Carriers are low where the physics does not depend on them, to
 * save steps. */
#ifndef IMUKIT_TESTS_SHELL_GYRO_DESIGNS_H
#define IMUKIT_TESTS_SHELL_GYRO_DESIGNS_H

#include "instrument_run.h"

#include "imukit/shell_gyro.h"

static const double pi = 3.14159265358979324;
static const imk_instrument *const shell = &imk_shell_gyro_instrument;

enum { AMPLITUDE = 2, QUADRATURE = 3, MODAL_ANGLE = 4, REBALANCE_FORCE = 7 }; /* signals */

/* A resonator without any error, at 1 kHz. */
static inline imk_shell_gyro perfect(imk_shell_mode mode)
{
    imk_shell_gyro design = imk_shell_gyro_default();
    design.mode = mode;
    design.resonator.shape = IMK_SHELL_HEMISPHERE;
    design.resonator.mass = 1e-6;
    design.resonator.frequency = 1000.0;
    design.resonator.quality = 1000.0;
    design.resonator.frequency_temperature = design.resonator.damping_temperature = 0.0;
    memset(&design.anisotropy, 0, sizeof design.anisotropy);
    memset(&design.pickoff, 0, sizeof design.pickoff);
    memset(&design.forcer, 0, sizeof design.forcer);
    memset(&design.package, 0, sizeof design.package);
    design.control.rebalance_bandwidth = design.control.support_bandwidth = 20.0;
    design.control.phase_error = 0.0;
    return design;
}

/* The example examples/instruments/hemispherical.yaml. */
static inline imk_shell_gyro hemispherical(void)
{
    imk_shell_gyro design = perfect(IMK_SHELL_WHOLE_ANGLE);
    const double degree = pi / 180.0;
    design.resonator.angular_gain_error = 1e-7;
    design.resonator.mass = 1e-3;
    design.resonator.frequency = 4000.0;
    design.resonator.quality = 1e7;
    design.resonator.frequency_temperature = 8e-5;
    design.resonator.damping_temperature = 1e-3;
    design.anisotropy.damping_difference = 2e-8;
    design.anisotropy.damping_angle = 30.0 * degree;
    design.anisotropy.damping_repeatability = 2.5e-8;
    design.anisotropy.damping_instability = 2e-9;
    design.anisotropy.frequency_split = 1e-4;
    design.anisotropy.stiffness_angle = 50.0 * degree;
    design.pattern.amplitude = 1e-7;
    design.pickoff.noise = 1e-15;
    design.pickoff.gain_mismatch = 5e-6;
    design.pickoff.misalignment = 5e-6;
    design.forcer.drive = IMK_SHELL_PARAMETRIC;
    design.forcer.gain_mismatch = design.forcer.misalignment = 1e-4;
    design.control.cycles = 20;
    design.control.support_bandwidth = 2.0;
    design.control.phase_error = 0.001 * degree;
    design.package.misalignment_y = design.package.misalignment_z = 2e-5;
    return design;
}

static inline imk_physics_settings quiet(imk_level level, double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.level = level;
    settings.rate = rate;
    settings.noise = false;
    return settings;
}

static inline imk_exposure turning(double rate)
{
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_rate[0] = rate;
    return exposure;
}

static inline double signal_of(const void *state, int signal)
{
    double values[IMK_INSTRUMENT_SIGNALS_MAX];
    shell->observe(state, values);
    return values[signal];
}

/* A light shell, so that its Brownian motion shows: N = 1e-3 rad/sqrt(s). */
static inline imk_shell_gyro light(imk_shell_mode mode)
{
    imk_shell_gyro design = perfect(mode);
    design.resonator.frequency = 250.0;
    design.resonator.quality = 1000.0;
    design.control.rebalance_bandwidth = design.control.support_bandwidth = 10.0;
    design.resonator.mass = 2e-10;
    design.control.cycles = 2; /* 8 ms */
    design.pattern.amplitude = 6.5e-6;
    return design;
}

#endif
