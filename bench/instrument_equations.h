/* SPDX-License-Identifier: Apache-2.0 */
/* The equations of motion of instruments as their headers state them, for a general solver: nothing
 * here shares code with the library. */
#ifndef IMUKIT_INSTRUMENT_EQUATIONS_H
#define IMUKIT_INSTRUMENT_EQUATIONS_H

#include "ode_yardstick.h"

#include "imukit/free_gyro.h"
#include "imukit/mems_accelerometer.h"
#include "imukit/ring_laser.h"
#include "imukit/shell_gyro.h"
#include "imukit/tuning_fork.h"

/** Free gyro, the case at rest, no torque: outer and inner angle, rates of both in inertial space.
 *  Readings: the angles. */
typedef struct free_gyro_equations {
    double h, ao, a, b, c;
} free_gyro_equations;
void free_gyro_problem(const imk_free_gyro *design, free_gyro_equations *with,
                       ode_problem *problem);

/** Beat of a ring laser: psi, or what is left of it without rotation and dither (`moving`).
 *  Reading: psi. */
typedef struct ring_laser_equations {
    double slope, rate, dither, w, kappa;
    bool moving;
} ring_laser_equations;
void ring_laser_problem(const imk_ring_laser *design, double rate, bool moving,
                        ring_laser_equations *with, ode_problem *problem);

/** Two coupled oscillators under a force of one frequency: x, x', y, y'. Readings: x and y,
 * relative to problem->size. */
typedef struct oscillator_equations {
    double xx, xv, xy, xyv;       /* x'' = -xx x - xv x' - xy y + xyv y' + force */
    double yy, yv, yx, yxv;       /* y'' = -yy y - yv y' - yx x + yxv x' + leak force */
    double force, leak, w, phase; /* force cos(w t + phase) */
    double size_x, size_y;
} oscillator_equations;
/** The mass of a tuning fork gyro with its drive force as it is when the loops have settled. */
void tuning_fork_problem(const imk_tuning_fork *design, double rate, double force, double phase,
                         double frequency, const double start[4], oscillator_equations *with,
                         ode_problem *problem);
/** A shell struck once. */
void shell_gyro_problem(const imk_shell_gyro *design, double rate, double x, double y,
                        oscillator_equations *with, ode_problem *problem);

/** Envelope of a tuning fork's sense motion, its output filter, and the integral of the output; or
 *  (`shell`) a reading that follows the rate with a lag, and its integral. The input is held over a
 *  sample. Reading: the mean of the output over it. */
typedef struct envelope_equations {
    const imk_exposure *exposure;
    double decay, turn;      /* of q: a = decay + i turn */
    double cosine, sine;     /* of the phase error */
    double bias, quadrature; /* rates */
    double filter, rate, sample, gain;
} envelope_equations;
void tuning_fork_envelope_problem(const imk_tuning_fork *design, const imk_exposure *exposure,
                                  double sample, envelope_equations *with, ode_problem *problem);
void shell_gyro_lag_problem(const imk_shell_gyro *design, double bias, double gain,
                            const imk_exposure *exposure, double sample, envelope_equations *with,
                            ode_problem *problem);

/** Mass of an accelerometer between its plates, output filter, integral of the output. The input is
 *  held over a sample, and the feedback of a sigma-delta loop over a clock. Reading of an open
 *  loop: the mean of the output over a sample [m/s^2]; of a sigma-delta loop: the mass'
 *  displacement over the gap, after each clock. */
typedef struct mems_equations {
    const imk_mems_accelerometer *design;
    const imk_exposure *exposure;
    double sample, force, constant, filter;
    double plus, minus;          /* V+^2, V-^2 */
    double rest, stiffness;      /* open loop: where the mass rests, and its stiffness there */
    double unit, middle, signal; /* sigma-delta: what a bit counts as */
    double before, sum;
    size_t clocks; /* per sample */
} mems_equations;
void mems_open_problem(const imk_mems_accelerometer *design, const imk_exposure *exposure,
                       double sample, mems_equations *with, ode_problem *problem);
void mems_sigma_delta_problem(const imk_mems_accelerometer *design, const imk_exposure *exposure,
                              double sample, size_t clocks, mems_equations *with,
                              ode_problem *problem);

#endif
