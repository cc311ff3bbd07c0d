/* SPDX-License-Identifier: Apache-2.0 */
/* The rate gyro: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "rate_gyro_internal.h"

#define DESIGN imk_rate_gyro

VALUE(momentum, imki_rate_gyro_gimbal(d).momentum)
VALUE(per_torque, 1.0 / momentum(d))
VALUE(unbalance_spin, -imk_unbalance_drift(d->balance.mass, d->balance.offset_spin, momentum(d)))
VALUE(unbalance_input, imk_unbalance_drift(d->balance.mass, d->balance.offset_input, momentum(d)))
VALUE(compliance,
      imk_anisoelastic_drift(d->balance.mass,
                             d->balance.compliance_spin - d->balance.compliance_input, momentum(d)))
VALUE(inertia_difference, imki_rate_gyro_gimbal(d).inertia_difference / momentum(d))
VALUE(output_axis, imki_rate_gyro_gimbal(d).inertia / momentum(d))
VALUE(sensitivity, imk_rate_gyro_sensitivity(d))
VALUE(frequency, imk_rate_gyro_natural_frequency(d) / (2.0 * IMKI_PI))
VALUE(damping, imk_rate_gyro_damping_ratio(d))
VALUE(bandwidth, imk_rate_gyro_bandwidth(d))
VALUE(full_scale, d->stop / imk_rate_gyro_sensitivity(d))

const imk_derived imki_rate_gyro_derived[] = {
    {"angular momentum", "H", "kg*m^2/s", "kg*m^2/s", "H = H_0 (1 + dH/H)", "[LAWRENCE1998]",
     momentum, NULL},
    {"gimbal angle per rate", "th/w", "rad/(rad/s)", "mrad/(deg/s)", "th/w = H/k", "[LAWRENCE1998]",
     sensitivity, NULL},
    {"rate at the stop", "w_s", "rad/s", "deg/s", "w_s = k stop/H", "[LAWRENCE1998]", full_scale,
     NULL},
    {"natural frequency", "f_n", "Hz", "Hz", "f_n = sqrt(k/I)/(2 pi)", "[LAWRENCE1998]", frequency,
     NULL},
    {"damping ratio", "z", "1", "1", "z = c/(2 sqrt(k I))", "[LAWRENCE1998]", damping, NULL},
    {"bandwidth (-3 dB)", "f_b", "Hz", "Hz", "f_b = f_n sqrt(q + sqrt(q^2 + 1)), q = 1 - 2 z^2",
     "[LAWRENCE1998]", bandwidth, NULL},
    {"drift per torque", "w/M", "rad/s/(N*m)", "deg/h/(uN*m)", "w/M = 1/H", "[LAWRENCE1998]",
     per_torque, NULL},
    {"mass unbalance drift, force along x", "D_x", "rad/s/(m/s^2)", "deg/h/g", "D_x = -m d_z/H",
     "[LAWRENCE1998]", unbalance_spin, NULL},
    {"mass unbalance drift, force along z", "D_z", "rad/s/(m/s^2)", "deg/h/g", "D_z = m d_x/H",
     "[LAWRENCE1998]", unbalance_input, NULL},
    {"anisoelastic drift", "D_xz", "rad/s/(m/s^2)^2", "deg/h/g^2", "D_xz = m^2 (C_z - C_x)/H",
     "[LAWRENCE1998]", compliance, NULL},
    {"anisoinertia error", "D_i", "rad/s/(rad/s)^2", "deg/h/(deg/s)^2", "D_i = (Iz - Ix)/H",
     "[LAWRENCE1998]", inertia_difference, NULL},
    {"output-axis acceleration error", "D_a", "rad/s/(rad/s^2)", "deg/s/(deg/s^2)", "D_a = I/H",
     "[LAWRENCE1998]", output_axis, NULL},
    DERIVED_END,
};
