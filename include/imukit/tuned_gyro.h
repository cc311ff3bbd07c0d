/* SPDX-License-Identifier: Apache-2.0 */
/** @file tuned_gyro.h
 *  The dynamically tuned gyro: a rotor on a Hooke joint that turns with the shaft.
 *
 *  The joint is two pairs of flexures with a small gimbal between them. Its springs would pull the
 *  rotor along with the case. But when the rotor is tilted, the gimbal nods twice in a turn, and
 *  this causes a torque of the opposite sign. At one speed, the tuned speed,
 *
 *      N^2 = (kx + ky)/J,   J = Ag + Bg - Cg   (nearly),
 *
 *  both cancel and the rotor is free [CRAIG1972]: two input axes from one wheel. A rebalance loop
 *  keeps the rotor in line with the shaft by torques about the other axis, and these are the
 *  reading.
 *
 *  In axes that turn with the shaft (1 along the flexures of the shaft, 2 along those of the
 *  rotor), with the tilt (f1, f2) of the rotor, the rate (W1, W2) of the case in these axes, and
 *  the torque (T1, T2) on the rotor, all small but N:
 *
 *      (A + Ag) f1'' + d f1' + [(C - A - Bg + Cg) N^2 + kx] f1 + (C - 2A) N f2'
 *                                = T1 - (A + Ag) W1' - (C - A - Bg + Cg) N W2
 *      A f2'' + d f2' + [(C - A) N^2 + ky] f2 - (C - 2A) N f1' = T2 - A W2' + (C - A) N W1
 *
 *  A and C are the inertias of the rotor across and along its axis, Ag, Bg, Cg those of the gimbal
 *  about 1, 2 and the shaft, kx, ky the flexures of the shaft and of the rotor, d their damping.
 *  With a tilted rotor, a rate about the shaft couples in: w_x - w_z th_y, w_y + w_z th_x.
 *
 *  Case axes: x and y input, z along the shaft. Output 0 is the rate about x, output 1 about y;
 *  their slow errors and noise are independent. Tilts are assumed small; the model does not limit
 *  them.
 *
 *  Levels: full, as above, each step exact; slow, the mean over a turn of the shaft without delay.
 *
 *  The default design is chosen, not copied: 12000 rpm, 0.01 kg m^2/s, a figure of merit C/J of
 *  200, time constant 100 s, 100 deg/s, and a bias of the class "tactical", the size of small tuned
 *  gyros of strapdown systems. */
#ifndef IMUKIT_TUNED_GYRO_H
#define IMUKIT_TUNED_GYRO_H

#include "imukit/instrument.h"
#include "imukit/spinning_mass.h"

IMK_BEGIN_C

/** The design. Start from imk_tuned_gyro_default(), then change fields. */
typedef struct imk_tuned_gyro {
    uint32_t cookie;
    double spin_frequency;      /**< of the shaft, as designed [Hz] */
    double speed_error;         /**< relative [1] */
    double axial_inertia;       /**< C of the rotor [kg m^2] */
    double transverse_inertia;  /**< A of the rotor [kg m^2] */
    double gimbal_inertia_x;    /**< Ag, about the flexures of the shaft [kg m^2] */
    double gimbal_inertia_y;    /**< Bg, about the flexures of the rotor [kg m^2] */
    double gimbal_inertia_z;    /**< Cg, about the shaft [kg m^2] */
    double stiffness_x;         /**< kx [N m/rad] */
    double stiffness_y;         /**< ky [N m/rad] */
    double hinge_damping;       /**< d of either pair [N m s/rad] */
    double mass;                /**< of the rotor [kg] */
    double axial_offset;        /**< of its centre of mass from the joint, along z [m] */
    double quadrature_offset;   /**< effective offset for a torque along the force [m] */
    double axial_compliance;    /**< shift of the rotor per force along z [m/N] */
    double radial_compliance;   /**< shift per force across z [m/N] */
    imk_error_torque torque;    /**< on each axis; positive torques read as positive rates */
    double pickoff_noise;       /**< two-sided density [rad/sqrt(Hz)] */
    double pickoff_offset_x;    /**< reading without tilt about x [rad] */
    double pickoff_offset_y;    /**< reading without tilt about y [rad] */
    double pickoff_range;       /**< largest reading [rad]; the stops are twice as far */
    double torquer_limit;       /**< largest torque [N m] */
    double torquer_error;       /**< relative error of the torque per current [1] */
    double torquer_temperature; /**< change of that error with temperature [1/K] */
    bool captured;              /**< false: no loop; the reading is minus the change of the tilt */
    double loop_frequency;      /**< natural frequency w/2pi; the loop commands the rate
                                   -(2 z w th + w^2 integral of th) [Hz] */
    double loop_damping;        /**< damping ratio z of the loop */
    double loop_filter; /**< corner of the second-order Butterworth filter of the pickoffs, so that
                           the loop does not drive the nutation [Hz] */
} imk_tuned_gyro;

/** The design described above, exactly tuned. */
IMK_API imk_tuned_gyro imk_tuned_gyro_default(void);

/** Check a design.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE (error.field: the path), _CONFLICT
 *          (impossible moments of inertia; a gimbal with J <= 0, which has no tuned speed; a loop
 *          that drives the nutation or oscillates) */
IMK_API imk_status imk_tuned_gyro_validate(const imk_tuned_gyro *design, imk_error *error);

/** Tuned speed by the textbook formula, sqrt((kx + ky)/(Ag + Bg - Cg)) [rad/s]. */
IMK_API double imk_tuned_gyro_first_speed(const imk_tuned_gyro *design);
/** Exact tuned speed, at which the residual spring is 0 [rad/s]: it differs from the textbook value
 *  by a part of about J/(8 (2A - C)), because the gimbal also drives the rotor at 2N. */
IMK_API double imk_tuned_gyro_tuned_speed(const imk_tuned_gyro *design);
/** Actual speed, with its error [rad/s]. */
IMK_API double imk_tuned_gyro_speed(const imk_tuned_gyro *design);
/** Angular momentum at a speed, the steady torque per rate of the case, nearly
 *  N (C + (Ag - Bg + Cg)/2) [N m s]. */
IMK_API double imk_tuned_gyro_momentum(const imk_tuned_gyro *design, double speed);
/** Residual spring, the steady torque per tilt of the rotor, nearly (kx + ky - J N^2)/2 [N m/rad].
 */
IMK_API double imk_tuned_gyro_residual_spring(const imk_tuned_gyro *design);
/** Time constant with which a tilted free rotor returns to the shaft, H/(N d) [s]; infinite without
 *  d. */
IMK_API double imk_tuned_gyro_time_constant(const imk_tuned_gyro *design);
/** Figure of merit C/J: the drift of a mistuned rotor is N (dN/N) times the tilt, divided by it. */
IMK_API double imk_tuned_gyro_figure_of_merit(const imk_tuned_gyro *design);
/** Nutation H/(A + Ag/2), nearly [rad/s]. */
IMK_API double imk_tuned_gyro_nutation(const imk_tuned_gyro *design);
/** Drift per amplitude of an angular vibration of the case at twice the spin frequency, in the
 *  worst phase: nearly J N/(8 H), an eighth of the inverse figure of merit. Holds for a loop that
 *  is slow against 2N. */
IMK_API double imk_tuned_gyro_vibration_drift(const imk_tuned_gyro *design);

/** Error model of the x axis by closed forms, with the tilt th = -pickoff offset that the loop
 *  keeps, D = N d and K the residual spring:
 *
 *      scale factor  (H/designed H)/(1 + torquer error) - 1, and -d(torquer error)/dT
 *      bias          [torque + K offset_y - D offset_x]/H
 *      misalignment  offset_y to z
 *      g             -m d_axial/H along x, m d_quadrature/H along y
 *      g^2           m^2 (C_axial - C_radial)/H for f_z f_x
 *      N             torque noise/H;  range limit/H
 *      bandwidth, damping of x to x by the loop, with the residual spring K, which turns the tilt
 *                    by K/H while the loop pulls
 *
 *  Not in the error model: the drift by vibration at 2N; the noise of the pickoffs, which is the
 *  derivative of a bounded angle; and, of a rotor that no loop holds, the drift -K/H times its
 *  tilt. */
IMK_API void imk_tuned_gyro_reduce(const imk_tuned_gyro *design, imk_model *model);

/** The instrument; name "tuned_gyro". */
IMK_API extern const imk_instrument imk_tuned_gyro_instrument;

IMK_END_C
#endif
