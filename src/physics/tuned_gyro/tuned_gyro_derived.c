/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro: what follows from its parts. */
#include "physics/derived_rows_internal.h"
#include "tuned_gyro_internal.h"

#define DESIGN imk_tuned_gyro

VALUE(momentum, imk_tuned_gyro_momentum(d, imk_tuned_gyro_speed(d)))
VALUE(first_speed, imk_tuned_gyro_first_speed(d))
VALUE(tuned_speed, imk_tuned_gyro_tuned_speed(d))
VALUE(mistuning, imk_tuned_gyro_speed(d) / imk_tuned_gyro_tuned_speed(d) - 1.0)
VALUE(spring, imk_tuned_gyro_residual_spring(d))
VALUE(spring_drift, imk_tuned_gyro_residual_spring(d) / momentum(d))
VALUE(merit, imk_tuned_gyro_figure_of_merit(d))
VALUE(time_constant, imk_tuned_gyro_time_constant(d))
VALUE(damping_drift, imk_tuned_gyro_speed(d) * d->hinge_damping / momentum(d))
VALUE(nutation, imk_tuned_gyro_nutation(d) / (2.0 * IMKI_PI))
VALUE(vibration_frequency, imk_tuned_gyro_speed(d) / IMKI_PI)
VALUE(vibration, imk_tuned_gyro_vibration_drift(d))
VALUE(per_torque, 1.0 / momentum(d))
VALUE(unbalance, -imk_unbalance_drift(d->mass, d->axial_offset, momentum(d)))
VALUE(quadrature, imk_unbalance_drift(d->mass, d->quadrature_offset, momentum(d)))
VALUE(compliance,
      imk_anisoelastic_drift(d->mass, d->axial_compliance - d->radial_compliance, momentum(d)))
VALUE_IF(range, d->captured, d->torquer_limit / momentum(d))
VALUE_IF(bandwidth, d->captured, imki_tuned_gyro_bandwidth(d))

const imk_derived imki_tuned_gyro_derived[] = {
    {"angular momentum", "H", "kg*m^2/s", "kg*m^2/s", "H = N (C + (Ag - Bg + Cg)/2), nearly",
     "[CRAIG1972]", momentum, NULL},
    {"tuned speed, first order", "N_1", "rad/s", "rpm", "N_1 = sqrt((kx + ky)/(Ag + Bg - Cg))",
     "[CRAIG1972]", first_speed, NULL},
    {"tuned speed, exact", "N_t", "rad/s", "rpm", "N_t: K(N_t) = 0", "[CRAIG1972]", tuned_speed,
     NULL},
    {"mistuning", "e", "1", "ppm", "e = N/N_t - 1", "[CRAIG1972]", mistuning, NULL},
    {"residual spring", "K", "N*m/rad", "uN*m/rad", "K = (kx + ky - J N^2)/2, nearly",
     "[CRAIG1972]", spring, NULL},
    {"drift per tilt by the residual spring", "D_K", "rad/s/rad", "deg/h/mrad", "D_K = K/H",
     "[CRAIG1972]", spring_drift, NULL},
    {"figure of merit", "F", "1", "1", "F = C/(Ag + Bg - Cg)", "[CRAIG1972]", merit, NULL},
    {"time constant", "tau", "s", "s", "tau = H/(N d)", "[CRAIG1972]", time_constant,
     "the flexures have no damping (hinge.damping)"},
    {"drift per tilt by damping", "D_d", "rad/s/rad", "deg/h/mrad", "D_d = N d/H", "[CRAIG1972]",
     damping_drift, NULL},
    {"nutation frequency", "f_n", "Hz", "Hz", "f_n = H/(2 pi (A + Ag/2))", "[CRAIG1972]", nutation,
     NULL},
    {"twice the spin frequency", "f_2N", "Hz", "Hz", "f_2N = N/pi", "[CRAIG1972]",
     vibration_frequency, NULL},
    {"drift by angular vibration at 2N", "D_2N", "rad/s/rad", "deg/h/arcsec",
     "D_2N = J N/(8 H), nearly", "[CRAIG1972]", vibration, NULL},
    {"drift per torque", "w/M", "rad/s/(N*m)", "deg/h/(uN*m)", "w/M = 1/H", "[LAWRENCE1998]",
     per_torque, NULL},
    {"mass unbalance drift, force along x", "D_x", "rad/s/(m/s^2)", "deg/h/g", "D_x = -m d_axial/H",
     "[LAWRENCE1998]", unbalance, NULL},
    {"quadrature unbalance drift, force along y", "D_y", "rad/s/(m/s^2)", "deg/h/g",
     "D_y = m d_quadrature/H", "[LAWRENCE1998]", quadrature, NULL},
    {"anisoelastic drift", "D_xz", "rad/s/(m/s^2)^2", "deg/h/g^2",
     "D_xz = m^2 (C_axial - C_radial)/H", "[LAWRENCE1998]", compliance, NULL},
    {"largest rate of the torquer", "w_m", "rad/s", "deg/s", "w_m = M_t/H", "[LAWRENCE1998]", range,
     "no loop captures the rotor (loop.captured)"},
    {"loop bandwidth (-3 dB)", "f_b", "Hz", "Hz", "f_b: |G(f_b)|^2 = 1/2", "[LAWRENCE1998]",
     bandwidth, "no loop captures the rotor (loop.captured)"},
    DERIVED_END,
};
