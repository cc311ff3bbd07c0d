/* SPDX-License-Identifier: Apache-2.0 */
/** @file rate_integrating_gyro.h
 *  The floated rate-integrating gyro: a wheel in a float that is restrained only by a viscous
 *  liquid.
 *
 *  The gyroscopic torque of a rate drives the float against the liquid: the float's angle is the
 *  integral of the rate. With H the angular momentum, C the damping, I the inertia of the float
 *  about the output axis and k the stiffness of its flex leads,
 *
 *      I th'' + C th' + k th = H p + (Iz - Ix) p r - I a_y + M - T
 *      p = w_x cos th - w_z sin th,   r = w_x sin th + w_z cos th
 *
 *  A torquer (T) drives the float back to zero, and its torque gives the measured rate:
 *
 *  - open: no torquer; the reading is (C/H) times the change of the angle over a sample;
 *  - analog: T = K1 th + K2 integral of th; the reading is the mean of T/H;
 *  - ternary: once per pulse period the torquer gives a pulse +T, 0 or -T, depending on whether
 *    th + lead th' exceeds half a pulse; the reading is the sum of the pulses, each the angle T
 *    period/H;
 *  - binary: +T or -T, always one of the two, so the heating is the same at all rates.
 *
 *  Case axes: x input, y output (the float's), z spin reference. Output 0 is the rate.
 *
 *  Levels: full, the float and its loop; slow, the float without inertia and the loop without
 *  delay.
 *
 *  The default design: an analog loop of 30 deg/s. Its drift is that of a satellite's floated gyros
 *  in pulse-restrained loops: a band of 16 arcsec/h over a year and a half, taken as 4 sigma, and a
 *  standard deviation of 1 arcsec/h [HARRIS1974]. Its dimensions are chosen. */
#ifndef IMUKIT_RATE_INTEGRATING_GYRO_H
#define IMUKIT_RATE_INTEGRATING_GYRO_H

#include "imukit/instrument.h"
#include "imukit/spinning_mass.h"

IMK_BEGIN_C

typedef enum imk_rebalance {
    IMK_REBALANCE_OPEN = 0,
    IMK_REBALANCE_ANALOG,
    IMK_REBALANCE_TERNARY,
    IMK_REBALANCE_BINARY
} imk_rebalance;

/** The design. Start from imk_rate_integrating_gyro_default(), then change fields. */
typedef struct imk_rate_integrating_gyro {
    uint32_t cookie;
    double momentum;       /**< H as designed [kg m^2/s] */
    double momentum_error; /**< dH/H of this gyro [1] */
    double output_inertia; /**< I of the float [kg m^2] */
    double input_inertia;  /**< Ix [kg m^2] */
    double spin_inertia;   /**< Iz [kg m^2] */
    double damping;        /**< C of the liquid [N m s/rad] */
    double stiffness;      /**< k of the flex leads [N m/rad] */
    double stop;           /**< largest angle [rad] */
    imk_balance balance;
    imk_error_torque torque;
    double pickoff_noise;      /**< two-sided density of the angle [rad/sqrt(Hz)] */
    double pickoff_resolution; /**< step of the angle, open loop [rad], 0: none */
    imk_rebalance rebalance;
    double torquer_limit;       /**< largest torque, and that of the pulses [N m] */
    double torquer_error;       /**< relative error of the torque per current [1] */
    double torquer_temperature; /**< change of that error with temperature [1/K] */
    double pulse_frequency;     /**< pulse periods per second [Hz]; whole ones in a sample */
    double pulse_lead;          /**< [s]; I/C compensates the lag of the float */
    double loop_frequency;      /**< of the analog loop, sqrt(K2/C)/2 pi [Hz] */
    double loop_damping;        /**< K1/(2 sqrt(K2 C)) */
} imk_rate_integrating_gyro;

/** The design described above. */
IMK_API imk_rate_integrating_gyro imk_rate_integrating_gyro_default(void);

/** Check a design.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE (error.field: the path), _CONFLICT
 *          (impossible moments of inertia; an analog loop that oscillates, C K1 <= I K2 (k +
 *          K1 > 0)) */
IMK_API imk_status imk_rate_integrating_gyro_validate(const imk_rate_integrating_gyro *design,
                                                      imk_error *error);

/** Angle of the float per angle of the case, H/C. */
IMK_API double imk_rate_integrating_gyro_gain(const imk_rate_integrating_gyro *design);
/** Time constant of the float, I/C [s]. */
IMK_API double imk_rate_integrating_gyro_time_constant(const imk_rate_integrating_gyro *design);
/** Largest rate that the torquer can balance, limit/H [rad/s]. */
IMK_API double imk_rate_integrating_gyro_range(const imk_rate_integrating_gyro *design);
/** Angle of one pulse, limit/(H frequency) [rad]. */
IMK_API double imk_rate_integrating_gyro_pulse(const imk_rate_integrating_gyro *design);
/** Gains K1 [N m/rad] and K2 [N m/(rad s)] of the analog loop. */
IMK_API void imk_rate_integrating_gyro_loop(const imk_rate_integrating_gyro *design,
                                            double *proportional, double *integral);
/** Angle random walk, sqrt(2 k_B T C + noise^2)/H [rad/s/sqrt(Hz)]. */
IMK_API double imk_rate_integrating_gyro_random_walk(const imk_rate_integrating_gyro *design);

/** Error model of one axis by closed forms.
 *
 *      scale factor   (1 + dH/H)/(1 + torquer error) - 1 and -d(torquer error)/dT; open: dH/H
 *      bias, g, g^2   as of the rate gyro (rate_gyro.h), over the torquer's scale
 *      N              of the torques; Q = angle step/sqrt(12): of the pickoff's step times C/H
 *                     (open), of one pulse (ternary) or two (binary)
 *      bandwidth      1/(2 pi I/C) (open), of (K1 s + K2)/(I s^3 + C s^2 + (K1 + k) s + K2)
 *                     (analog)
 *      range          limit/H
 *
 *  Not in the error model: -th w_z, small in a closed loop; -(I/H) times the angular acceleration
 *  about the output axis; (Iz - Ix)/H w_x w_z; the noise of the pickoff, which is (C/H) times the
 *  derivative of the angle noise and integrates to a bounded angle. */
IMK_API void imk_rate_integrating_gyro_reduce(const imk_rate_integrating_gyro *design,
                                              imk_model *model);

/** The instrument; name "rate_integrating_gyro". */
IMK_API extern const imk_instrument imk_rate_integrating_gyro_instrument;

IMK_END_C
#endif
