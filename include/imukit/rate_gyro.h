/* SPDX-License-Identifier: Apache-2.0 */
/** @file rate_gyro.h
 *  The spring-restrained rate gyro: a wheel in one gimbal, held by a torsion bar and a damper.
 *
 *  A rate w_x of the case turns the wheel against the spring until the gyroscopic torque is
 *  balanced; the angle th is the reading. With H the angular momentum of the wheel, k the spring, c
 *  the damper and I the inertia of the gimbal with its wheel about the output axis,
 *
 *      I th'' + c th' + k th = H p + (Iz - Ix) p r - I a_y + M
 *      p = w_x cos th - w_z sin th,   r = w_x sin th + w_z cos th
 *
 *  Case axes: x input, y output (the gimbal's), z spin reference (along the wheel at th = 0).
 *
 *  Output 0 is (k/H) times the angle, k and H as designed, averaged over the sample.
 *
 *  Levels: full, the dynamics of the gimbal; slow, the angle at which the torques balance. The
 *  linear part is propagated exactly. Terms that depend on the angle enter as the mean of their
 *  values at both ends of a step; this scheme is symmetric in time, so without a damper the gimbal
 *  swings for ever. Coulomb friction holds the gimbal until the torque exceeds it. The gimbal does
 *  not bounce off the stops.
 *
 *  The default design is chosen, not copied: a miniature gyro with a torsion bar, +-200 deg/s in
 *  2.5 deg of gimbal angle, 30 Hz, damping ratio 0.7, no friction, and a bias of the class "control
 *  system". */
#ifndef IMUKIT_RATE_GYRO_H
#define IMUKIT_RATE_GYRO_H

#include "imukit/instrument.h"
#include "imukit/spinning_mass.h"

IMK_BEGIN_C

/** The design. Start from imk_rate_gyro_default(), then change fields. */
typedef struct imk_rate_gyro {
    uint32_t cookie;
    double momentum;              /**< H of the wheel, as designed [kg m^2/s] */
    double momentum_error;        /**< dH/H of this gyro: relative error of the motor's speed [1] */
    double output_inertia;        /**< I of gimbal and wheel [kg m^2] */
    double input_inertia;         /**< Ix of gimbal and wheel [kg m^2] */
    double spin_inertia;          /**< Iz of gimbal and wheel [kg m^2] */
    double stiffness;             /**< k as designed [N m/rad] */
    double stiffness_error;       /**< dk/k of this gyro [1] */
    double stiffness_temperature; /**< dk/k per kelvin [1/K] */
    double damping;               /**< c [N m s/rad], 0 allowed */
    double friction;              /**< Coulomb's, of the gimbal's bearings [N m] */
    double stop;                  /**< largest angle [rad] */
    imk_balance balance;
    imk_error_torque torque;
    double pickoff_noise;      /**< two-sided density of the angle [rad/sqrt(Hz)] */
    double pickoff_resolution; /**< step of the angle [rad], 0: none */
} imk_rate_gyro;

/** The design described above. */
IMK_API imk_rate_gyro imk_rate_gyro_default(void);

/** Check a design.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE (error.field: the path), _CONFLICT
 *          (impossible moments of inertia; a spring weaker than the anisoinertia within the range)
 */
IMK_API imk_status imk_rate_gyro_validate(const imk_rate_gyro *design, imk_error *error);

/** Angle per rate, H/k [rad/(rad/s)], errors of this gyro included. */
IMK_API double imk_rate_gyro_sensitivity(const imk_rate_gyro *design);
/** Natural frequency, sqrt(k/I) [rad/s]. */
IMK_API double imk_rate_gyro_natural_frequency(const imk_rate_gyro *design);
/** Damping ratio, c/(2 sqrt(k I)). */
IMK_API double imk_rate_gyro_damping_ratio(const imk_rate_gyro *design);
/** -3 dB frequency [Hz]: natural frequency times sqrt(m + sqrt(m^2 + 1)), m = 1 - 2 z^2. */
IMK_API double imk_rate_gyro_bandwidth(const imk_rate_gyro *design);
/** K3 of the reading, w (1 + K3 w^2): -(H/k)^2/2, as the input axis turns by th, plus (Iz - Ix)/k,
 *  as anisoinertia softens the spring [(rad/s)^-2]. */
IMK_API double imk_rate_gyro_cubic(const imk_rate_gyro *design);
/** Angle random walk, sqrt(2 k_B T c + noise^2)/H and the pickoff's share [rad/s/sqrt(Hz)]. */
IMK_API double imk_rate_gyro_random_walk(const imk_rate_gyro *design);

/** Error model of one axis by closed forms.
 *
 *      scale factor   (1 + dH/H)/(1 + dk/k) - 1, and -d(dk/k)/dT
 *      bias           M/H for torques of every kind; k2 of the angle at which the bias holds it
 *      k3             imk_rate_gyro_cubic()
 *      g, g^2         -m d_z/H along x, m d_x/H along z;  m^2 (C_z - C_x)/H for f_z f_x
 *      bandwidth, damping of the gimbal; range k stop/H; dead band friction/H; resolution k step/H
 *
 *  Not in the error model, because it has no such terms: -th w_z, the response to a rate along the
 *  spin axis while the gimbal is turned; (Iz - Ix)/H w_x w_z; -(I/H) times the angular acceleration
 *  about the output axis. */
IMK_API void imk_rate_gyro_reduce(const imk_rate_gyro *design, imk_model *model);

/** The instrument; name "rate_gyro". */
IMK_API extern const imk_instrument imk_rate_gyro_instrument;

IMK_END_C
#endif
