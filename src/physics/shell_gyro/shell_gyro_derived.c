/* SPDX-License-Identifier: Apache-2.0 */
/* The shell gyro: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "shell_gyro_internal.h"

#define DESIGN imk_shell_gyro

VALUE(angular_gain, imk_shell_gyro_angular_gain(d))
VALUE(modal_gain, imk_shell_gyro_modal_gain(d))
VALUE(mode_angle, 0.5 * IMKI_PI / (double)d->resonator.mode_number)
VALUE(stiff, d->resonator.frequency + 0.5 * d->anisotropy.frequency_split)
VALUE(soft, d->resonator.frequency - 0.5 * d->anisotropy.frequency_split)
VALUE(decay_time, imk_shell_gyro_decay_time(d))
VALUE(fast_decay,
      1.0 / (1.0 / imk_shell_gyro_decay_time(d) + 0.5 * d->anisotropy.damping_difference))
VALUE(slow_decay,
      1.0 / (1.0 / imk_shell_gyro_decay_time(d) - 0.5 * d->anisotropy.damping_difference))
VALUE(linewidth, 1.0 / (IMKI_PI * imk_shell_gyro_decay_time(d)))
VALUE(damping_bias,
      imk_shell_gyro_damping_bias(d, d->anisotropy.damping_angle - 45.0 * IMKI_DEGREE))
VALUE(quadrature,
      imk_shell_gyro_quadrature_rate(d, d->anisotropy.stiffness_angle - 45.0 * IMKI_DEGREE))
VALUE(force, imk_shell_gyro_rebalance_force(d, 1.0))
VALUE(drive_force, imk_shell_gyro_drive_force(d))
VALUE(speed, 2.0 * IMKI_PI * d->resonator.frequency * d->pattern.amplitude)
VALUE_IF(bandwidth, d->mode == IMK_SHELL_REBALANCE, imki_shell_loop_bandwidth(d))
VALUE_IF(range, d->mode == IMK_SHELL_REBALANCE && d->forcer.limit > 0.0,
         imki_shell_command_limit(d) / imki_shell_assumed_gain(d))
VALUE(thermal, imk_shell_gyro_thermal_random_walk(d, IMKI_DESIGN_TEMPERATURE))

const imk_derived imki_shell_gyro_derived[] = {
    {"Bryan's factor (angular gain)", "kappa", "1", "1", "kappa = 2/(n^2 + 1), hemisphere 0.277",
     "[BRYAN1890]", angular_gain, NULL},
    {"modal angle per angle of the case", "k", "1", "1", "k = n kappa", "[LYNCH1995]", modal_gain,
     NULL},
    {"angle on the shell between the two modes", "a_m", "rad", "deg", "a_m = 90 deg/n",
     "[LYNCH1995]", mode_angle, NULL},
    {"frequency of the stiffer mode", "f_1", "Hz", "kHz", "f_1 = f + df/2", "[LYNCH1995]", stiff,
     NULL},
    {"frequency of the softer mode", "f_2", "Hz", "kHz", "f_2 = f - df/2", "[LYNCH1995]", soft,
     NULL},
    {"decay time constant", "tau", "s", "s", "tau = 2 Q/w", "[LYNCH1995]", decay_time, NULL},
    {"decay time along the axis of most damping", "tau_1", "s", "s", "tau_1 = 1/(1/tau + D/2)",
     "[LYNCH1995]", fast_decay, NULL},
    {"decay time along the axis of least damping", "tau_2", "s", "s", "tau_2 = 1/(1/tau - D/2)",
     "[LYNCH1995]", slow_decay, NULL},
    {"width of the resonance", "Df", "Hz", "Hz", "Df = f/Q = 1/(pi tau)", "[LYNCH1995]", linewidth,
     NULL},
    {"largest drift by unequal damping", "W_D", "rad/s", "deg/h", "W_D = D/(2 k)", "[LYNCH1995]",
     damping_bias, NULL},
    {"largest quadrature, as a rate", "W_q", "rad/s", "deg/s", "W_q = dw/(2 k)", "[LYNCH1995]",
     quadrature, NULL},
    {"peak speed of the vibration", "v", "m/s", "m/s", "v = a w", "[LYNCH1995]", speed, NULL},
    {"rebalance force per rate", "F/W", "N/(rad/s)", "nN/(deg/s)", "F/W = 2 m w a k", "[LYNCH1995]",
     force, NULL},
    {"force that holds the amplitude", "F_u", "N", "nN", "F_u = 2 m w a/tau", "[LYNCH1995]",
     drive_force, NULL},
    {"bandwidth of the rebalance loop (-3 dB)", "f_b", "Hz", "Hz", "f_b: |G(f_b)|^2 = 1/2",
     "[LYNCH1995]", bandwidth, "no loop holds the pattern (mode)"},
    {"largest rate of the rebalance loop", "W_m", "rad/s", "deg/s", "W_m = F_limit/(2 m w a k)",
     "[LYNCH1995]", range,
     "no loop holds the pattern, or its force has no limit (mode, forcer.limit)"},
    {"angle random walk by Brownian motion", "N_B", "rad/s/sqrt(Hz)", "deg/sqrt(h)",
     "N_B = sqrt(k_B T/(m w Q))/(k a)", "[LYNCH1995]", thermal, NULL},
    DERIVED_END,
};
