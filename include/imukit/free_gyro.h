/* SPDX-License-Identifier: Apache-2.0 */
/** @file free_gyro.h
 *  The free gyro: a spinning wheel in two gimbals, which keeps its direction in inertial space
 *  while the case turns around it; pick-offs measure how far the case has turned.
 *
 *  The outer gimbal turns by the angle `outer` about case x, the inner gimbal by `inner` about the
 *  y axis of the outer one. At outer = inner = 0 the spin axis points along case z; in general
 *
 *      spin axis in case axes = (sin inner, -sin outer cos inner, cos outer cos inner)
 *
 *  so case y is the inner gimbal's axis and case z the spin axis, as long as both angles are small.
 *  When the case turns about x at the rate w, the outer angle changes at -w. Output 0 is the change
 *  of the outer reading over a sample with reversed sign; output 1 is the same for the inner
 *  reading.
 *
 *  Notation of the formulas: H angular momentum of the wheel; b the inner angle, s = sin b, c = cos
 *  b; Mo and Mi torques about the outer and the inner axis; A = Ai + Ar, B = Bi + Ar, C = Ci the
 *  inertias about the inner gimbal's x, y and z of gimbal and wheel (without the wheel about z:
 *  that is in H); Ao, Bo, Co those of the outer gimbal. J = Ao + A c^2 + C s^2.
 *
 *  The equations of motion, their derivation and what is left out: docs/physics/free_gyro.md. */
#ifndef IMUKIT_FREE_GYRO_H
#define IMUKIT_FREE_GYRO_H

#include "imukit/instrument.h"

IMK_BEGIN_C

/** A design. Start from imk_free_gyro_default(), then change fields. Triples are along x, y, z of
 *  the gimbal they belong to. */
typedef struct imk_free_gyro {
    uint32_t cookie;
    double spin_rate;        /**< nominal speed of the wheel in inertial space [rad/s], > 0 */
    double spin_error;       /**< relative error of the speed [1] */
    double rotor_polar;      /**< inertia of the wheel about its axis [kg m^2], > 0 */
    double rotor_transverse; /**< inertia across that axis: at least half the polar one [kg m^2] */
    double inner_inertia[3]; /**< of the inner gimbal alone [kg m^2] */
    double outer_inertia[3]; /**< of the outer gimbal [kg m^2] */
    double mass;             /**< of wheel and inner gimbal [kg] */
    double unbalance[3];     /**< centre of that mass from the gimbal axes, inner gimbal's axes
                                [m] */
    double compliance[3];    /**< of the suspension of that mass, same axes [m/N] */
    double viscous_friction; /**< of the bearings of each gimbal [N m s/rad] */
    double coulomb_friction; /**< of the bearings of each gimbal [N m] */
    double friction_rate;    /**< rate v0 over which the Coulomb torque changes its sign, -Mc
                                v/sqrt(v^2 + v0^2) [rad/s], > 0 */
    double stop;             /**< the inner gimbal's travel either way [rad], < pi/2 */
    double torque_inner;     /**< constant error torque about the inner axis [N m] */
    double torque_outer;     /**< the same about the outer axis [N m] */
    double torque_temperature;   /**< change of both with temperature, from 293.15 K [N m/K] */
    double torque_repeatability; /**< 1 sigma from run to run, about each axis [N m] */
    double torque_instability;   /**< flicker B about each axis [N m] */
    double torque_noise;         /**< white, two-sided density, about each axis [N m/sqrt(Hz)] */
    double pickoff_resolution;   /**< step of the readings of both angles, 0: none [rad] */
    double pickoff_noise;        /**< 1 sigma of each reading [rad] */
    double pickoff_scale_error;  /**< relative, of both [1] */
    double start_outer, start_inner; /**< angles of the gimbals when they are released [rad] */
    double start_nutation; /**< amplitude of the nutation at release, of the inner angle [rad] */
} imk_free_gyro;

/** A gyro of the size of those in aircraft instruments. The wheel's 22 550 r/min on 400 Hz and the
 *  travel of 85 deg are those of the electric attitude gyro in the pilots' training notes at
 *  flyingpilots.com (p = 264). The rest is chosen: inertias of a brass wheel of 24 mm radius and
 *  gimbals to match, friction of small ball bearings, error torques for a drift of 0.2 deg/min,
 *  because of which such gyros are re-erected every few minutes, and 15 arcsec of nutation after
 *  uncaging. */
IMK_API imk_free_gyro imk_free_gyro_default(void);

/** Check a design: every field must be in its range, and the design possible: no body's inertia
 *  about an axis above the sum of the other two (a wheel's polar inertia at most twice the
 *  transverse one), start angle and nutation within the stops, friction that the wheel can overcome
 *  (its slope at rest below H cos(stop)/2), and an unbalance small enough for a gyro.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_free_gyro_validate(const imk_free_gyro *design, imk_error *error);

/** The error model at the start angles of the gimbals. The design must be valid:
 *
 *      bias       (Mi - D Mo/(H c))/(H c)        of each kind of torque, white noise included
 *      g          m (dx z - dz x)/(H c)          x, z: the inner gimbal's axes in case axes,
 *      g^2        m^2 (Cz - Cx) (x.f)(z.f)/(H c)    and the part of Mo that friction passes on
 *      cross axis D/(H c) along the inner axis, D the friction's slope at rest
 *      geometry   -tan b (case rate along the outer gimbal's z)
 *      scale      pick-off error, -(D/(H c))^2
 *      Q          sqrt(step^2/12 + reading noise^2)
 *
 *  It holds for small changes of the angles: a free gyro's errors depend on where its gimbals are.
 *  The readings follow the case without delay, so there is no bandwidth; the model does not contain
 *  the nutation. */
IMK_API void imk_free_gyro_reduce(const imk_free_gyro *design, imk_model *model);

/** Angular momentum H [N m s], speed error included. */
IMK_API double imk_free_gyro_momentum(const imk_free_gyro *design);

/** Frequency of the nutation at an inner angle b [Hz]: H c/(2 pi sqrt(J B)) [ARNOLD1961] */
IMK_API double imk_free_gyro_nutation(const imk_free_gyro *design, double inner);

/** Mean rate of the outer gimbal [rad/s] while the inner one nutates by a [rad] about b:
 *
 *      -a^2 H s (Ao + C)/(2 J^2)
 *
 *  "gimbal walk" [PLYMALE1955], [MAGNUS1955]: the leading term in a; it follows from the adiabatic
 *  invariance of the nutation's action E/omega: d(outer)/dt = (E/omega) d omega/db/(H c). */
IMK_API double imk_free_gyro_gimbal_walk(const imk_free_gyro *design, double inner,
                                         double amplitude);

/** Steady rate of the outer gimbal under a torque Mi about the inner axis, the case at rest
 *  [rad/s]: the root that tends to -Mi/(H c) of
 *
 *      (A - C) s c w^2 - H c w - Mi = 0
 *
 *  A heavy top is a free gyro with gimbals of no mass whose outer axis is vertical. NaN when there
 *  is no such root, because the torque is too large for the wheel. */
IMK_API double imk_free_gyro_precession(const imk_free_gyro *design, double inner, double torque);

/** Bias by unbalance at zero angles, per specific force along each case axis [rad/s/(m/s^2)]: m
 *  (-dz, 0, dx)/H. */
IMK_API void imk_free_gyro_unbalance(const imk_free_gyro *design, double sensitivity[3]);

/** Bias by unequal compliance at zero angles, per fx fz [rad/s/(m/s^2)^2]: m^2 (Cz - Cx)/H. */
IMK_API double imk_free_gyro_anisoelasticity(const imk_free_gyro *design);

/** The instrument; outputs and signals are in its tables. */
IMK_API extern const imk_instrument imk_free_gyro_instrument;

IMK_END_C
#endif
