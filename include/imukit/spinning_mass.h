/* SPDX-License-Identifier: Apache-2.0 */
/** @file spinning_mass.h
 *  Common parts of gyros with a spinning wheel: the torques that make them drift.
 *
 *  A torque M on a wheel of angular momentum H gives the same reading as a rate M/H. */
#ifndef IMUKIT_SPINNING_MASS_H
#define IMUKIT_SPINNING_MASS_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Error torques about the output axis of one gyro. */
typedef struct imk_error_torque {
    double fixed;         /**< at 293.15 K [N m] */
    double temperature;   /**< change with the temperature [N m/K] */
    double repeatability; /**< 1 sigma of a constant of each run [N m] */
    double instability;   /**< B of the flicker torque [N m] */
    double noise; /**< white, two-sided density, in addition to the thermal torque of the damping [N
                     m/sqrt(Hz)] */
} imk_error_torque;

/** Balance of the suspended mass of a single-axis gyro about its output axis. Offsets are from that
 *  axis to the centre of mass, along the input and the spin axis. A compliance is the shift of the
 *  centre of mass along an axis per force along the same axis. */
typedef struct imk_balance {
    double mass;             /**< [kg] */
    double offset_input;     /**< [m] */
    double offset_spin;      /**< [m] */
    double compliance_input; /**< [m/N] */
    double compliance_spin;  /**< [m/N] */
} imk_balance;

/** Drift of an unbalanced mass per specific force, m d/H [rad/s/(m/s^2)]. */
IMK_API double imk_unbalance_drift(double mass, double offset, double momentum);

/** Drift by unequal compliances, m^2 dC/H [rad/s/(m/s^2)^2]: multiply by the product of the
 *  specific forces along the two axes. */
IMK_API double imk_anisoelastic_drift(double mass, double compliance_difference, double momentum);

/** Density of the thermal torque of a viscous damper at 293.15 K, sqrt(2 k T c), two-sided
 *  [N m/sqrt(Hz)], by the fluctuation-dissipation theorem [CALLEN1951].
 *  @param damping  c [N m s/rad] */
IMK_API double imk_thermal_torque(double damping);

IMK_END_C
#endif
