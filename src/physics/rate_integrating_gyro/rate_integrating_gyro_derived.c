/* SPDX-License-Identifier: Apache-2.0 */
/* The floated rate-integrating gyro: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "rate_integrating_gyro_internal.h"

#define DESIGN imk_rate_integrating_gyro

VALUE(momentum, imki_rate_integrating_gyro_gimbal(d).momentum)
VALUE(per_torque, 1.0 / momentum(d))
VALUE(unbalance_spin, -imk_unbalance_drift(d->balance.mass, d->balance.offset_spin, momentum(d)))
VALUE(unbalance_input, imk_unbalance_drift(d->balance.mass, d->balance.offset_input, momentum(d)))
VALUE(compliance,
      imk_anisoelastic_drift(d->balance.mass,
                             d->balance.compliance_spin - d->balance.compliance_input, momentum(d)))
VALUE(inertia_difference, imki_rate_integrating_gyro_gimbal(d).inertia_difference / momentum(d))
VALUE(output_axis, imki_rate_integrating_gyro_gimbal(d).inertia / momentum(d))
VALUE(gain, imk_rate_integrating_gyro_gain(d))
VALUE(time_constant, imk_rate_integrating_gyro_time_constant(d))
VALUE(input_stop, d->stop / imk_rate_integrating_gyro_gain(d))
VALUE(restraint, d->stiffness / momentum(d))
VALUE_IF(leak, d->stiffness > 0.0, d->damping / d->stiffness)
VALUE_IF(range, d->rebalance != IMK_REBALANCE_OPEN, imk_rate_integrating_gyro_range(d))
VALUE_IF(pulse, d->rebalance == IMK_REBALANCE_TERNARY || d->rebalance == IMK_REBALANCE_BINARY,
         imk_rate_integrating_gyro_pulse(d))
VALUE_IF(bandwidth, d->rebalance == IMK_REBALANCE_OPEN || d->rebalance == IMK_REBALANCE_ANALOG,
         imki_rate_integrating_gyro_bandwidth(d))

static double stiffness(const void *design)
{
    const DESIGN *const d = design;
    double proportional, integral;
    imk_rate_integrating_gyro_loop(d, &proportional, &integral);
    return d->rebalance == IMK_REBALANCE_ANALOG ? proportional : (double)NAN;
}

const imk_derived imki_rate_integrating_gyro_derived[] = {
    {"angular momentum", "H", "kg*m^2/s", "kg*m^2/s", "H = H_0 (1 + dH/H)", "[LAWRENCE1998]",
     momentum, NULL},
    {"gyro gain", "G", "1", "1", "G = H/C", "[LAWRENCE1998]", gain, NULL},
    {"float time constant", "tau", "s", "ms", "tau = I/C", "[LAWRENCE1998]", time_constant, NULL},
    {"input angle at the stop", "a_s", "rad", "deg", "a_s = stop C/H", "[LAWRENCE1998]", input_stop,
     NULL},
    {"drift per torque", "w/M", "rad/s/(N*m)", "deg/h/(uN*m)", "w/M = 1/H", "[LAWRENCE1998]",
     per_torque, NULL},
    {"elastic restraint drift", "D_k", "rad/s/rad", "deg/h/mrad", "D_k = k/H", "[LAWRENCE1998]",
     restraint, NULL},
    {"time constant of the elastic restraint", "tau_k", "s", "s", "tau_k = C/k", "[LAWRENCE1998]",
     leak, "the flex leads have no stiffness (float.stiffness)"},
    {"largest rate of the torquer", "w_m", "rad/s", "deg/s", "w_m = M_t/H", "[LAWRENCE1998]", range,
     "no torquer holds the float (rebalance)"},
    {"pulse weight", "a_p", "rad", "arcsec", "a_p = M_t/(H f_p)", "[LAWRENCE1998]", pulse,
     "the torquer gives no pulses (rebalance)"},
    {"torque per float angle of the loop", "K_1", "N*m/rad", "N*m/rad", "K_1 = 2 z w_l C",
     "[LAWRENCE1998]", stiffness, "there is no analog loop (rebalance)"},
    {"bandwidth (-3 dB)", "f_b", "Hz", "Hz", "f_b: |G(f_b)|^2 = 1/2; open 1/(2 pi tau)",
     "[LAWRENCE1998]", bandwidth, "pulses have no linear response (rebalance)"},
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
