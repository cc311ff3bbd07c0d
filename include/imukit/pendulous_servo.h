/* SPDX-License-Identifier: Apache-2.0 */
/** @file pendulous_servo.h
 *  Pendulous force-rebalance accelerometer: a pendulum on a hinge, held at zero by a torquer whose
 *  current is the reading.
 *
 *      J phi'' + b phi' + K_h phi = P (f_x cos phi + f_z sin phi) + J (alpha_y + w_x w_z)
 *                                   + M_error + noise - M_c
 *      M_c = K_p (phi + n) + K_i integral (phi + n) dt,       |M_c| <= largest torque
 *      current i:  M_c = K_t i (1 + a i),    reading = i K_t,nominal/P
 *
 *  Case axes: x input, z pendulous (from the hinge to the mass at phi = 0), y = z x x output: the
 *  hinge. phi is positive when the mass is displaced towards -x, as by a positive force. The origin
 *  is the hinge, so the reading is the force at a point J/P along z, the centre of percussion.
 *  [LAWRENCE1998, IEEE1293]
 *
 *  Full level: the linear loop by its exact propagator, the torques that depend on the angle by
 *  symmetric kicks (error of second order in step x loop frequency, of this small part only). Slow
 *  level: the linear loop exactly, one step per sample; torques that depend on the angle are left
 *  out. */
#ifndef IMUKIT_PENDULOUS_SERVO_H
#define IMUKIT_PENDULOUS_SERVO_H

#include "imukit/instrument.h"

IMK_BEGIN_C

/** A design. Start from imk_pendulous_servo_default(), then change fields. */
typedef struct imk_pendulous_servo {
    uint32_t cookie;
    double pendulosity;                /**< P, mass times distance from the hinge [kg m], > 0 */
    double inertia;                    /**< J, about the hinge [kg m^2], > 0 */
    double damping;                    /**< b, gas film and rate feedback [N m s], >= 0 */
    double hinge_stiffness;            /**< K_h [N m/rad], >= 0 */
    double stop;                       /**< largest angle [rad], > 0 */
    double hinge_torque;               /**< constant error torque [N m] */
    double hinge_torque_temperature;   /**< its change with temperature [N m/K] */
    double hinge_torque_repeatability; /**< 1 sigma from run to run [N m], >= 0 */
    double hinge_torque_instability;   /**< flicker B [N m], >= 0 */
    double proportional;               /**< K_p [N m/rad], > 0 */
    double integral;                   /**< K_i [N m/(rad s)], >= 0; 0: the angle stays deflected */
    double torquer_constant;           /**< K_t nominal [N m/A], > 0 */
    double torquer_error;              /**< relative error of K_t [1], > -1 */
    double torquer_temperature;        /**< relative change with temperature [1/K] */
    double torquer_repeatability; /**< 1 sigma of the relative error from run to run [1], >= 0 */
    double torquer_quadratic;     /**< a [1/A] */
    double largest_current;       /**< [A], > 0 */
    double readout_noise;         /**< of the current, two-sided [A/sqrt(Hz)], >= 0 */
    double readout_step;          /**< of the sampled current [A], >= 0 */
    double pickoff_noise;         /**< n, two-sided [rad/sqrt(Hz)], >= 0 */
    double misalignment_y, misalignment_z; /**< of the input axis towards case y and z [rad] */
    double temperature; /**< temperature of the gas, at which errors are stated [K], > 0 */
} imk_pendulous_servo;

/** A quartz-flexure accelerometer of navigation grade, by the datasheet of Honeywell's QA-3000: 60
 *  g, 1.3 mA/g, bias 4 mg and 15 ug/K, repeatable to 40 ug, scale factor 120 ppm/K and 80 ppm,
 *  bandwidth above 300 Hz. Pendulum and loop are not published; they are chosen to give these
 *  figures. */
IMK_API imk_pendulous_servo imk_pendulous_servo_default(void);

/** Check a design: every field must be in its range, and the design possible: the loop must be
 *  stable (K_i/(K_p + K_h) below b/J, by Routh's criterion, field controller.integral); the torquer
 *  must balance the hinge's torque, its torque must grow with the current, and its constant must
 *  keep its sign in every run.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_pendulous_servo_validate(const imk_pendulous_servo *design,
                                                imk_error *error);

/** Scale factor of the current, P/K_t [A/(m/s^2)]. */
IMK_API double imk_pendulous_servo_scale(const imk_pendulous_servo *design);

/** Natural frequency of the captured pendulum, sqrt((K_p + K_h)/J)/(2 pi) [Hz]. */
IMK_API double imk_pendulous_servo_frequency(const imk_pendulous_servo *design);

/** Gain |M_c/(P f)| of the loop at a frequency [Hz]: with integral action it is 1 at 0 Hz. */
IMK_API double imk_pendulous_servo_gain(const imk_pendulous_servo *design, double frequency);

/** Bandwidth: frequency at which imk_pendulous_servo_gain() has fallen to 1/sqrt(2) [Hz]. */
IMK_API double imk_pendulous_servo_bandwidth(const imk_pendulous_servo *design);

/** Vibropendulous rectification: the mean reading of forces A cos(w t) along both x and z, divided
 * by A^2 [1/(m/s^2)]:  1/2 Re[P/K_c(jw)],  K_c = K_p + K_h - J w^2 + j b w + K_i/(j w). */
IMK_API double imk_pendulous_servo_rectification(const imk_pendulous_servo *design,
                                                 double frequency);

/** White noise of the reading at low frequency, N, two-sided [m/s^2/sqrt(Hz)]: Brownian torque
 *  2 k T b, readout, and pickoff against the hinge. */
IMK_API double imk_pendulous_servo_noise(const imk_pendulous_servo *design);

/** Reading noise [m/s]: standard deviation of (J phi' + b phi)/P, the momentum of the pendulum
 *  caused by the pickoff's noise and the Brownian torque. The mean torque of a sample contains the
 *  difference of this momentum between its ends. */
IMK_API double imk_pendulous_servo_reading_noise(const imk_pendulous_servo *design);

/** The error model; the design must be valid. It states the fixed bias and its effects, scale
 *  factor, K2 of the torquer, the lever arm J/P, noise, bandwidth, range and resolution. Without
 *  integral action also: the share K_p/K of all that acts on the pendulum, K_ip, and the hinge
 *  torque's part of the misalignment. */
IMK_API void imk_pendulous_servo_reduce(const imk_pendulous_servo *design, imk_model *model);

/** The instrument. Output 1 is the current [A]; signals: angle, torque, current. */
IMK_API extern const imk_instrument imk_pendulous_servo_instrument;

IMK_END_C
#endif
