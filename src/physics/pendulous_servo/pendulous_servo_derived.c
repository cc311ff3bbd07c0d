/* SPDX-License-Identifier: Apache-2.0 */
/* The pendulous servo accelerometer: what follows from its parts. */
#include "pendulous_servo_internal.h"
#include "physics/derived_rows_internal.h"

#define DESIGN imk_pendulous_servo

static const double stated_vibration = 100.0; /* [Hz] */

VALUE(scale, imk_pendulous_servo_scale(d))
VALUE(percussion, d->inertia / d->pendulosity)
VALUE(torque, d->pendulosity)
VALUE(range, d->largest_current / imk_pendulous_servo_scale(d))
VALUE_IF(free_frequency, d->hinge_stiffness > 0.0,
         sqrt(d->hinge_stiffness / d->inertia) / (2.0 * IMKI_PI))
VALUE(frequency, imk_pendulous_servo_frequency(d))
VALUE(damping, d->damping / (2.0 * sqrt(d->inertia * imki_servo_stiffness(d))))
VALUE(bandwidth, imk_pendulous_servo_bandwidth(d))
VALUE(stiffness, imki_servo_stiffness(d))
VALUE(angle, d->pendulosity / imki_servo_stiffness(d))
VALUE_IF(time_constant, d->integral > 0.0, imki_servo_stiffness(d) / d->integral)
VALUE(restraint, d->hinge_stiffness / d->pendulosity)
VALUE(vibration, imk_pendulous_servo_rectification(d, stated_vibration))

const imk_derived imki_pendulous_servo_derived[] = {
    {"scale factor of the current", "K_1", "A/(m/s^2)", "mA/g", "K_1 = P/K_t", "[IEEE1293]", scale,
     NULL},
    {"pendulosity, torque per specific force", "P", "kg*m", "uN*m/g", "P = m l", "[IEEE1293]",
     torque, NULL},
    {"centre of percussion from the hinge", "l_p", "m", "mm", "l_p = J/P", "[IEEE1293]", percussion,
     NULL},
    {"largest specific force of the torquer", "a_m", "m/s^2", "g", "a_m = i_max K_t/P",
     "[IEEE1293]", range, NULL},
    {"natural frequency without the loop", "f_h", "Hz", "Hz", "f_h = sqrt(K_h/J)/(2 pi)",
     "[LAWRENCE1998]", free_frequency, "the hinge has no stiffness (hinge.stiffness)"},
    {"natural frequency of the loop", "f_n", "Hz", "Hz", "f_n = sqrt((K_p + K_h)/J)/(2 pi)",
     "[LAWRENCE1998]", frequency, NULL},
    {"damping ratio of the loop", "z", "1", "1", "z = b/(2 sqrt(J (K_p + K_h)))", "[LAWRENCE1998]",
     damping, NULL},
    {"loop bandwidth (-3 dB)", "f_b", "Hz", "Hz", "f_b: |M_c/(P f)|^2 falls to half",
     "[LAWRENCE1998]", bandwidth, NULL},
    {"static stiffness of the loop", "K", "N*m/rad", "N*m/rad", "K = K_p + K_h", "[LAWRENCE1998]",
     stiffness, NULL},
    {"angle per specific force, before the integral acts", "th/a", "rad/(m/s^2)", "urad/g",
     "th/a = P/(K_p + K_h)", "[LAWRENCE1998]", angle, NULL},
    {"time constant of the integral", "tau_i", "s", "ms", "tau_i = (K_p + K_h)/K_i",
     "[LAWRENCE1998]", time_constant, "the controller has no integral part (controller.integral)"},
    {"elastic restraint, bias per angle", "b_h", "m/s^2/rad", "mg/mrad", "b_h = K_h/P",
     "[LAWRENCE1998]", restraint, NULL},
    {"vibropendulous rectification at 100 Hz", "K_vp", "1/(m/s^2)", "ug/g^2",
     "K_vp = 1/2 Re[P/K_c(i 2 pi 100 Hz)]", "[IEEE1293]", vibration, NULL},
    DERIVED_END,
};
