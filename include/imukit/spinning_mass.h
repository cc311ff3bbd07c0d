/* SPDX-License-Identifier: Apache-2.0 */
/** @file spinning_mass.h
 *  What gyros with a spinning wheel have in common: the torques that make them drift.
 *
 *  A torque M on a wheel of angular momentum H looks like the rate M/H. */
#ifndef IMUKIT_SPINNING_MASS_H
#define IMUKIT_SPINNING_MASS_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Torques nobody wants, about the output axis of one gyro. */
typedef struct imk_error_torque {
    double fixed;         /**< at 293.15 K [N m] */
    double temperature;   /**< change with the temperature [N m/K] */
    double repeatability; /**< 1 sigma of a constant of each run [N m] */
    double instability;   /**< B of the flicker torque [N m] */
    double noise;         /**< white, two-sided density, besides the thermal torque of the damping
                             [N m/sqrt(Hz)] */
} imk_error_torque;

/** How well the suspended mass of a single-axis gyro is balanced about its output axis. Offsets are
 *  those of the centre of mass from that axis, along the input and the spin axis; compliances are
 *  how far a force along an axis moves the centre of mass along it. */
typedef struct imk_balance {
    double mass;             /**< [kg] */
    double offset_input;     /**< [m] */
    double offset_spin;      /**< [m] */
    double compliance_input; /**< [m/N] */
    double compliance_spin;  /**< [m/N] */
} imk_balance;

/** Drift per specific force of an unbalanced mass, m d/H [rad/s/(m/s^2)]. */
IMK_API double imk_unbalance_drift(double mass, double offset, double momentum);

/** Drift of unequal compliances, m^2 dC/H [rad/s/(m/s^2)^2]: multiply by the product of the
 * specific forces along the two axes. */
IMK_API double imk_anisoelastic_drift(double mass, double compliance_difference, double momentum);

/** Density of the thermal torque of a viscous damper at 293.15 K, sqrt(2 k T c), two-sided
 *  [N m/sqrt(Hz)], by the fluctuation-dissipation theorem [CALLEN1951].
 *  @param damping  c [N m s/rad] */
IMK_API double imk_thermal_torque(double damping);

IMK_END_C
#endif
