/* SPDX-License-Identifier: Apache-2.0 */
/** @file shell_gyro.h
 *  Gyro with an axisymmetric vibrating shell: a ring, a cylinder or a hemisphere ("wineglass").
 *
 *  The rim vibrates as cos(n angle), n = 2 for an ellipse. Two such modes of one frequency, 90/n
 *  degrees apart, are the coordinates x and y of the model. A standing wave is a straight line in
 *  the x-y plane, at the modal angle theta, which is n times the angle of the pattern on the shell.
 *  When the case turns at the rate W about the axis of the shell, Coriolis forces turn the pattern
 *  by -kappa W in the case [BRYAN1890], theta by -k W with k = n kappa:
 *
 *      x'' = 2 k W y' + k W' y - (2/tau) x' - D (c x' + s y') - w^2 x - w dw (C x + S y) + fx/m
 *      y'' = -2 k W x' - k W' x - (2/tau) y' - D (s x' - c y') - w^2 y - w dw (S x - C y) + fy/m
 *
 *  tau = 2 Q/w; D is the difference of 1/tau of the principal axes of damping, at the modal angle
 *  theta_d (c, s = cos, sin of 2 theta_d); dw that of the frequencies of the principal axes of
 *  stiffness, at theta_w (C, S) [LYNCH1995]. Averaged over a cycle, an amplitude a and its
 *  quadrature q (the short axis of the ellipse) obey
 *
 *      theta' = -k W + (D/2) sin 2(theta - theta_d) + fv/(2 m w a)
 *      a' = -a/tau - (D/2) a cos 2(theta - theta_d) + fu/(2 m w)
 *      q' = (dw/2) a sin 2(theta - theta_w) + fq/(2 m w)            (q << a)
 *
 *  where fu and fv are the forces in phase with the velocity, along and across the pattern, and fq
 *  is the force across the pattern in phase with the displacement. The electronics measure the
 *  amplitudes at a reference phase and close four loops: the reference on the phase of the
 *  vibration, fu on the amplitude, fq on the quadrature (zero), and either fv on the angle (force
 *  to rebalance: fv is the rate) or none (whole angle: the change of theta is the rate).
 *
 *  Case axes: x is the axis of the shell (input); y points to the antinode of mode x (theta = 0); z
 *  completes the right-handed triad.
 *
 *  Left out: the centrifugal term, which is equal for both modes and only changes the frequency, by
 *  a part (W/w)^2 (1e-7 at 1000 deg/s for 4 kHz); the reference follows this change; the
 *  sensitivity to force, which for a balanced shell is of second order only; nonlinear elasticity.
 */
#ifndef IMUKIT_SHELL_GYRO_H
#define IMUKIT_SHELL_GYRO_H

#include "imukit/instrument.h"

IMK_BEGIN_C

typedef enum imk_shell_mode {
    IMK_SHELL_REBALANCE = 0, /**< the pattern is held, the force that holds it is read */
    IMK_SHELL_WHOLE_ANGLE,   /**< the pattern turns, its angle is read */
    IMK_SHELL_FREE           /**< excited once, then free; the angle is read. Full dynamics only */
} imk_shell_mode;

typedef enum imk_shell_shape {
    IMK_SHELL_RING = 0,   /**< kappa = 2/(n^2 + 1) */
    IMK_SHELL_HEMISPHERE, /**< kappa = 0.277, n = 2 */
    IMK_SHELL_OTHER       /**< kappa as stated */
} imk_shell_shape;

typedef enum imk_shell_drive {
    IMK_SHELL_DIRECTIONAL = 0, /**< electrodes push along the pattern */
    IMK_SHELL_PARAMETRIC /**< a ring electrode modulates the stiffness of the whole shell at twice
                            the frequency: it drives the pattern at any angle */
} imk_shell_drive;

/** A design. Angles of anisotropy, pattern and alignment are modal angles. */
typedef struct imk_shell_gyro {
    uint32_t cookie;
    imk_shell_mode mode;
    struct {
        imk_shell_shape shape;
        int mode_number;           /**< n */
        double angular_gain;       /**< kappa; used for IMK_SHELL_OTHER [1] */
        double angular_gain_error; /**< relative error of the gain assumed by the electronics [1] */
        double mass;               /**< modal mass m [kg] */
        double frequency;          /**< w/2 pi at 20 degC [Hz] */
        double quality;            /**< Q at 20 degC */
        double frequency_temperature; /**< relative change of w [1/K] */
        double damping_temperature;   /**< relative change of 1/tau and D [1/K] */
    } resonator;
    struct {
        double damping_difference;    /**< D at 20 degC [1/s] */
        double damping_angle;         /**< theta_d [rad] */
        double damping_repeatability; /**< 1 sigma per run of D cos 2 theta_d and of D sin 2 theta_d
                                         [1/s] */
        double damping_instability;   /**< flicker B of each of them [1/s] */
        double frequency_split;       /**< dw/2 pi [Hz] */
        double stiffness_angle;       /**< theta_w [rad] */
    } anisotropy;
    struct {
        double amplitude; /**< a [m] */
        double angle;     /**< angle at which the pattern is held, or starts [rad] */
    } pattern;
    struct {
        double noise;         /**< of each mode's pickoff, two-sided [m/sqrt(Hz)] */
        double gain_error;    /**< of both, relative [1] */
        double gain_mismatch; /**< gain of x minus gain of y, relative [1] */
        double misalignment;  /**< the axes of x and y are closer than 90 deg by this [rad] */
    } pickoff;
    struct {
        imk_shell_drive drive;
        double gain_error, gain_mismatch; /**< defined as for the pickoff [1] */
        double misalignment;              /**< [rad] */
        double gain_temperature;          /**< relative change of the gain [1/K] */
        double limit;                     /**< of the rebalance force [N]; 0: none */
    } forcer;
    struct {
        int cycles;                 /**< of vibration per update of the loops */
        double rebalance_bandwidth; /**< of the rebalance loop [Hz] */
        double support_bandwidth;   /**< of amplitude, quadrature and phase loop [Hz] */
        double phase_error;         /**< phase lag of the forces [rad] */
    } control;
    struct {
        double misalignment_y, misalignment_z; /**< response to rates about y and z [rad] */
    } package;
} imk_shell_gyro;

/** A silicon ring of 6 mm at 14 kHz, force to rebalance. The loop bandwidth (55 Hz), the response
 *  to other axes (within 2 %) and the kind of instrument are those of the Silicon Sensing CRG20
 *  data sheet DCR620000255; ring, Q, amplitude, anisotropy and noise are not published: they are
 *  chosen for an angle random walk of 0.1 deg/sqrt(h), an instability of 5 deg/h and a bias
 *  repeatability of 200 deg/h. */
IMK_API imk_shell_gyro imk_shell_gyro_default(void);

/** Check a design: every field must be in its range, and the design possible: damping positive in
 *  every direction and run (D plus six times its repeatability < 2/tau); n = 2 for a hemisphere; a
 *  pattern ten times as large as thermal motion and pickoff noise, unless it is free; loop
 *  bandwidths below a tenth of their update rate, and at least four updates in tau; a rebalance
 *  force above that at rest.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_shell_gyro_validate(const imk_shell_gyro *design, imk_error *error);

/** The error model. The design must be valid. Noise and biases are those at 20 degC and at
 *  pattern.angle. When the pattern of a whole-angle gyro turns, its bias varies as sin 2 theta and
 *  averages out. */
IMK_API void imk_shell_gyro_reduce(const imk_shell_gyro *design, imk_model *model);

/* ---- closed forms ---------------------------------------------------------------------------- */

/** kappa: angle of the pattern per angle of the case, 2/(n^2 + 1) for a ring [BRYAN1890]; 0.277 for
 *  a hemisphere [LYNCH1995]. */
IMK_API double imk_shell_gyro_angular_gain(const imk_shell_gyro *design);
/** k = n kappa: modal angle per angle of the case; 0.8 for a ring, 0.554 for a hemisphere. */
IMK_API double imk_shell_gyro_modal_gain(const imk_shell_gyro *design);
/** Time in which a free amplitude falls to 1/e, tau = 2 Q/w [s]. */
IMK_API double imk_shell_gyro_decay_time(const imk_shell_gyro *design);
/** Rate of the modal angle of a free or whole-angle pattern, caused by the resonator alone [rad/s],
 *  -k W + (D/2) sin 2(theta - theta_d) [LYNCH1995]. */
IMK_API double imk_shell_gyro_precession(const imk_shell_gyro *design, double rate, double angle);
/** Bias by damping, -(D/2k) sin 2(theta - theta_d): D sin(2 theta_d)/2k at theta = 0 [rad/s]. */
IMK_API double imk_shell_gyro_damping_bias(const imk_shell_gyro *design, double angle);
/** Quadrature as a rate, -(dw/2k) sin 2(theta - theta_w) [rad/s]. The sine of the phase error times
 *  this adds to the bias. */
IMK_API double imk_shell_gyro_quadrature_rate(const imk_shell_gyro *design, double angle);
/** Angle random walk by the Brownian motion of the shell, sqrt(kB T/(m w Q))/(k a)
 *  [rad/sqrt(s)], the same in both modes of operation. */
IMK_API double imk_shell_gyro_thermal_random_walk(const imk_shell_gyro *design, double temperature);
/** Force that balances a rate, 2 m w a k W [N]. */
IMK_API double imk_shell_gyro_rebalance_force(const imk_shell_gyro *design, double rate);
/** Force that keeps the amplitude, 2 m w a/tau [N]. */
IMK_API double imk_shell_gyro_drive_force(const imk_shell_gyro *design);

/** The instrument. */
IMK_API extern const imk_instrument imk_shell_gyro_instrument;

IMK_END_C
#endif
