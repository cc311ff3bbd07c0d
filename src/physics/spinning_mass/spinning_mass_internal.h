/* SPDX-License-Identifier: Apache-2.0 */
/* What the gyros with one gimbal share. Gimbal axes: x input, y output, z spin; the gimbal has
 * turned by the angle th about y against the case. With p and r the rate of the case along its x
 * and z, and H along z, Euler's equation about y is
 *
 *     I th'' = H p + (Iz - Ix) p r - I a_y + M,
 *     p = w_x cos th - w_z sin th,   r = w_x sin th + w_z cos th
 *
 * and M contains the weight of the unbalanced, elastically supported mass, d x (-m f) with
 * d = (d_x, 0, d_z) - m (C_x f_x, 0, C_z f_z). */
#ifndef IMUKI_SPINNING_MASS_INTERNAL_H
#define IMUKI_SPINNING_MASS_INTERNAL_H

#include "imukit/elementary.h"
#include "imukit/spinning_mass.h"
#include "physics/physics_internal.h"

/* Parts of a design that load the gimbal. */
typedef struct imki_gimbal {
    double momentum;           /* the true H [N m s] */
    double inertia;            /* I about the output axis [kg m^2] */
    double inertia_difference; /* Iz - Ix [kg m^2] */
    double moment_x, moment_z; /* m d_x, m d_z [kg m] */
    double anisoelastic;       /* m^2 (C_z - C_x) [kg^2 m/N] */
} imki_gimbal;

imki_gimbal imki_gimbal_of(double momentum, double inertia, double inertia_difference,
                           const imk_balance *balance);

/* Torque about the output axis at the angle th, without damping, springs and error torque. */
static inline double imki_gimbal_torque(const imki_gimbal *gimbal, const imk_exposure *exposure,
                                        double th)
{
    const double c = imk_cos(th), s = imk_sin(th);
    const double *w = exposure->angular_rate, *f = exposure->specific_force;
    const double p = w[0] * c - w[2] * s, r = w[0] * s + w[2] * c;
    const double fx = f[0] * c - f[2] * s, fz = f[0] * s + f[2] * c;
    return gimbal->momentum * p + gimbal->inertia_difference * p * r -
           gimbal->inertia * exposure->angular_acceleration[1] + gimbal->moment_x * fz -
           gimbal->moment_z * fx + gimbal->anisoelastic * fx * fz;
}

/* Three moments of inertia that a body can have: none exceeds the sum of the others. */
bool imki_inertias_possible(double a, double b, double c);

/* The terms of the error model that torques make: bias with its temperature, repeatability and
 * instability, g and g^2 sensitivity. `per_torque` is what the gyro reads per torque [rad/s/(N m)].
 */
void imki_reduce_torques(const imk_error_torque *torque, const imki_gimbal *gimbal,
                         double per_torque, imk_triad *triad);

/* Put one number per kelvin into a temperature polynomial valid over 213 … 373 K. */
void imki_reduce_temperature(double per_kelvin, imk_temperature_polynomial *polynomial);

/* The reading of everything changes by this part per kelvin: of the scale factor, and of the fixed
 * bias besides what its torque changes by. After both, and the bias's own slope, have been set. */
void imki_reduce_scale_temperature(double relative, imk_triad *triad);

/* Half-power frequency of a response [rad/s].
 *  @param power  |G|^2 at the frequency w [rad/s], G(0) = 1
 *  @param scale  a frequency of the order of the bandwidth [rad/s] */
double imki_response_edge(double (*power)(const void *design, double w), const void *design,
                          double scale);

/* The low-pass filter of model.h that stands for a response: same -3 dB frequency, and a damping
 * that gives the same peak (first order's absence of one: 0.7071). */
void imki_reduce_response(double (*power)(const void *design, double w), const void *design,
                          double scale, imk_triad *triad);

/* Rows of the table of fields of a DESIGN with members `balance` and `torque`. */
#define IMKI_BALANCE_FIELDS                                                                        \
    ABOVE("balance.mass", balance.mass, "kg", 0.0, 100.0, "suspended mass"),                       \
        NUMBER("balance.offset_input", balance.offset_input, "nm", -1e-3, 1e-3,                    \
               "centre of mass from the output axis, along the input axis"),                       \
        NUMBER("balance.offset_spin", balance.offset_spin, "nm", -1e-3, 1e-3,                      \
               "centre of mass from the output axis, along the spin axis"),                        \
        NUMBER("balance.compliance_input", balance.compliance_input, "nm/N", 0.0, 1e-3,            \
               "shift of the mass per force along the input axis"),                                \
        NUMBER("balance.compliance_spin", balance.compliance_spin, "nm/N", 0.0, 1e-3,              \
               "shift of the mass per force along the spin axis")

#define IMKI_TORQUE_FIELDS                                                                         \
    NUMBER("torque.fixed", torque.fixed, "N*m", -1.0, 1.0, "constant error torque"),               \
        NUMBER("torque.temperature", torque.temperature, "N*m/K", -1.0, 1.0,                       \
               "change of the error torque with temperature"),                                     \
        NUMBER("torque.repeatability", torque.repeatability, "N*m", 0.0, 1.0,                      \
               "1 sigma of the error torque from run to run"),                                     \
        NUMBER("torque.instability", torque.instability, "N*m", 0.0, 1.0,                          \
               "flicker of the error torque, B"),                                                  \
        NUMBER("torque.noise", torque.noise, "N*m/sqrt(Hz)", 0.0, 1.0,                             \
               "white error torque besides the thermal one, two-sided")

#endif
