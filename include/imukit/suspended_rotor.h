/* SPDX-License-Identifier: Apache-2.0 */
/** @file suspended_rotor.h
 *  The electrostatically suspended gyro (ESG): a ball that spins in a vacuum, held by electric
 *  fields between three pairs of electrodes, and read off by a pattern or by its mass unbalance.
 *  Nothing touches the ball, so it keeps its axis in inertial space while the case turns in any
 *  way.
 *
 *  The electrodes are on the case axes. The spin axis s points along case z at the start, or
 *  `start_tilt` from there towards the direction at `start_azimuth` from x. The readings are the
 *  direction cosines of s in case axes. The rotation of the case follows from their change between
 *  two samples,
 *
 *      rate = -(s0 x s1)/|s0 x s1| angle(s0, s1)/dt.
 *
 *  Output 0 is the x component and output 1 the y component. A ball does not sense rotation about
 *  its own spin axis: it reads w - s (s.w). With the spin axis along z, both components are sensed
 *  fully; with the spin axis along x, a rate about x is not sensed.
 *
 *  Notation: m mass, H = C spin the angular momentum, A and C the inertias across and about the
 *  axis of figure, f specific force; index k runs over the case axes.
 *
 *  Equations, derivation and simplifications: docs/physics/suspended_rotor.md. */
#ifndef IMUKIT_SUSPENDED_ROTOR_H
#define IMUKIT_SUSPENDED_ROTOR_H

#include "imukit/instrument.h"

IMK_BEGIN_C

/** A design. Start from imk_suspended_rotor_default(), then change fields. Triples are along the
 *  case axes. */
typedef struct imk_suspended_rotor {
    uint32_t cookie;
    double spin_rate;          /**< [rad/s], > 0 */
    double diameter;           /**< of the ball [m], > 0 */
    double hollow;             /**< diameter of the hollow inside, 0: solid [m] */
    double density;            /**< [kg/m^3], > 0 */
    double inertia_difference; /**< (C - A)/A > 0, so that the ball spins about a stable axis [1] */
    double unbalance;   /**< distance of the centre of mass from the centre, along the spin [m] */
    double oblateness;  /**< height of the second harmonic of the spinning shape, of P2 (negative:
                             flattened at the poles) [m] */
    double pear;        /**< height of the third harmonic, of P3 [m] */
    double limit;       /**< largest specific force that the suspension can support along each axis
                           [m/s^2], > 0 */
    double gap;         /**< distance of the ball from the electrodes [m], > 0 */
    double clearance;   /**< distance of the ball from its stops [m], > 0, smaller than the gap */
    double bandwidth;   /**< natural frequency of the ball in the control of the field [Hz], > 0 */
    double restitution; /**< speed behind an impact on a stop over the speed before it [1] */
    double friction;    /**< of the ball on a stop, force over normal force [1] */
    double preload_error[3];     /**< relative errors of the preloads of the three pairs [1] */
    double torque[3];            /**< constant error torque [N m] */
    double torque_temperature;   /**< change of each component, from 293.15 K [N m/K] */
    double torque_repeatability; /**< 1 sigma per run of each component [N m] */
    double torque_instability;   /**< flicker B of each component [N m] */
    double torque_noise;         /**< white, two-sided density, each component [N m/sqrt(Hz)] */
    double readout_resolution;   /**< step of the direction cosines, 0: none [rad] */
    double readout_noise;        /**< 1 sigma of each direction cosine [rad] */
    double start_tilt, start_azimuth; /**< of the spin axis in the case [rad] */
    /** Angle between axis of figure and angular momentum at the start [rad]. */
    double start_wobble;
    double wobble_time; /**< time in which the wobble falls to 1/e [s], > 0 */
} imk_suspended_rotor;

/** A ball like that of the Autonetics MICRON (N57A): solid beryllium, 10 mm, 2500 revolutions a
 *  second [LAWRENCE1998]. Beryllium has 1848 kg/m^3. The rest is chosen: a suspension for 25 g,
 *  electrodes at 10 um and stops at 5 um,
 *  torques of a strategic gyro (0.002 deg/h from run to run, 0.0005 deg/h of flicker, 0.0003
 *  deg/sqrt(h)), a centre of mass known to a nanometre (0.013 deg/h/g), shape errors of tens of
 *  nanometres or less, 1 arcsec steps. */
IMK_API imk_suspended_rotor imk_suspended_rotor_default(void);

/** Check a design: every field must be in its range, the hollow smaller than the ball, the centre
 *  of mass inside it, shape errors small against the radius, the stops nearer than the electrodes.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_suspended_rotor_validate(const imk_suspended_rotor *design,
                                                imk_error *error);

/** The error model for the spin axis s at the start. The design must be valid. With the drift's
 *  generator G (see imk_suspended_rotor_drift()) and I the unit matrix, the bias about x is
 *
 *      [(I - s s^T) grad G - s x torque]_x / H.
 *
 *  Its parts that are constant, linear and quadratic in f are bias, g and g^2 sensitivity; noise, B
 *  and repeatability are those of the torque times sqrt(1 - s_x^2)/H. Scale factor and misalignment
 *  are those of w - s (s.w). Q = sqrt(step^2/12 + reading noise^2) sqrt(1 - s_x^2). Wobble is not
 *  in the model. */
IMK_API void imk_suspended_rotor_reduce(const imk_suspended_rotor *design, imk_model *model);

/** Mass of the ball, pi/6 (diameter^3 - hollow^3) density [kg]. */
IMK_API double imk_suspended_rotor_mass(const imk_suspended_rotor *design);
/** Angular momentum H = C spin [N m s]. The mean of the three inertias is that of the round ball, 8
 *  pi/15 density (R^5 - r^5); with e = (C - A)/A, C is 3 (1 + e)/(3 + e) times that. */
IMK_API double imk_suspended_rotor_momentum(const imk_suspended_rotor *design);
/** Frequency of the wobble (free nutation) [Hz]: the axis of figure circles the angular momentum at
 *  H/A [LANDAU1976, 33]. */
IMK_API double imk_suspended_rotor_wobble(const imk_suspended_rotor *design);

/** Rate ds/dt [1/s] at which the spin axis drifts in inertial space, in case axes, without error
 *  torques and noise:
 *
 *      ds/dt = s x grad G/H,
 *      G = sum over k of  -m d f_k s_k + a3 m f_k P3(s_k) + a2 T_k P2(s_k),
 *      T_k = T0 (1 + error_k) + (m f_k)^2/(4 T0),   T0 = m limit/2
 *
 *  d is `unbalance`, a2 and a3 are `oblateness` and `pear`. T_k is the pull of both electrodes of a
 *  pair together, for a field that the control varies linearly about the preload. An electrode
 *  attracts a bump of the surface; the work of that is G. Electrodes are assumed small against the
 *  ball.
 *  @param axis  s, of unit length */
IMK_API void imk_suspended_rotor_drift(const imk_suspended_rotor *design, const double axis[3],
                                       const double force[3], double drift[3]);

/* ---- touch-down ------------------------------------------------------------------------------
 *
 * With a fixed voltage an electrode pulls with the inverse square of its distance. Displaced by x
 * against the largest pull of the electrode on the other side, the ball has the acceleration
 *
 *     x'' = f - limit (gap/(gap + x))^2
 *
 * so that it falls as soon as f exceeds the limit, and cannot be lifted before f is much smaller.
 */

/** Specific force along one axis beyond which the ball falls on its stop: the limit [m/s^2]. */
IMK_API double imk_suspended_rotor_touch_down(const imk_suspended_rotor *design);
/** Specific force below which the suspension lifts the ball from the stop: limit (gap/(gap +
 *  clearance))^2 [m/s^2]. */
IMK_API double imk_suspended_rotor_lift_off(const imk_suspended_rotor *design);
/** Speed at which a ball at rest in the centre meets its stop under a constant force above the
 *  limit: v^2 = 2 clearance (f - limit gap/(gap + clearance)) [m/s].
 *  @param force  along one axis [m/s^2] */
IMK_API double imk_suspended_rotor_impact(const imk_suspended_rotor *design, double force);
/** Time in which a ball that lies on its stop, its spin axis across the force, runs down: H over
 *  the friction's torque, friction (diameter/2) m (f - lift off) [s]. Infinite without friction. */
IMK_API double imk_suspended_rotor_run_down(const imk_suspended_rotor *design, double force);

/** The instrument; outputs and signals are in its tables. */
IMK_API extern const imk_instrument imk_suspended_rotor_instrument;

IMK_END_C
#endif
