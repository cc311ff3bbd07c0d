/* SPDX-License-Identifier: Apache-2.0 */
/** @file tuning_fork.h
 *  The planar vibratory gyro: a mass (in practice two, swinging against each other like the tines
 *  of a tuning fork) vibrates along a drive axis. A rate about the input axis makes it vibrate also
 *  along the sense axis, in phase with its velocity.
 *
 *      x'' + (wd/Qd) x' + wd^2 x = ux + 2 k (W - Wc) y' - (q - k W') y
 *      y'' + (ws/Qs) y' + ws^2 y = uy - 2 k (W + Wc) x' - (q + k W') x - asymmetry f
 *      q = 2 k wd Wq
 *
 *  [SHKEL2006]; [LYNCH1995]: W is the rate and k the angular gain. Wq is the quadrature error and
 *  Wc the damping coupling, both stated as the rate with the same effect. ux and uy are the forces
 *  per mass of the electronics and of thermal noise. An amplitude control holds x at the amplitude
 *  x0, a phase-locked loop gives the reference phase th, x = x0 cos th. The motion along y is
 *  multiplied with cos th and sin th; its part in phase with the velocity is the rate.
 *
 *  There are two arrangements; the case axis x is the input axis in both:
 *
 *      in-plane      the input axis is the normal of the chip; drive z and sense y lie in its plane
 *      out-of-plane  the input axis x and the drive axis y lie in the plane of the chip; the mass
 *                    responds along its normal z
 *
 *  A steady specific force f along the sense axis bends the springs of both tines alike, by f/wc^2
 *  in the common mode. If both tines are equal, this has no effect. With a relative asymmetry of
 *  the masses, that part of the deflection turns the drive force by asymmetry f/(wc^2 gap), which
 *  reads as a rate.
 *
 *  Levels: full, every step of the carrier by the exact propagator, the electronics once a cycle;
 *  slow, the envelope of y with the drive locked. A run of the full level begins at rest: the loops
 *  of the drive need some 10 ms. Exposures are constant over a sample; with more than fd/4 samples
 *  a second, one exposure is taken per cycle, so vibration at the carrier is not simulated. Theory,
 *  with every key of the design: docs/physics/tuning_fork.md. */
#ifndef IMUKIT_TUNING_FORK_H
#define IMUKIT_TUNING_FORK_H

#include "imukit/instrument.h"

IMK_BEGIN_C

typedef enum imk_tuning_fork_arrangement {
    IMK_TUNING_FORK_IN_PLANE = 0,
    IMK_TUNING_FORK_OUT_OF_PLANE = 1
} imk_tuning_fork_arrangement;

typedef enum imk_tuning_fork_loop {
    IMK_TUNING_FORK_OPEN = 0,  /**< the motion along y is measured */
    IMK_TUNING_FORK_CLOSED = 1 /**< forces cancel the motion along y, both its rate and its
                                  quadrature part, and are measured */
} imk_tuning_fork_loop;

/** Design. Start from imk_tuning_fork_default(), then change fields. Values at 293.15 K; densities
 *  are one-sided, as data sheets state them. */
typedef struct imk_tuning_fork {
    uint32_t cookie;
    imk_tuning_fork_arrangement arrangement;
    double mass;         /**< m, the same in both modes [kg] */
    double angular_gain; /**< k: 1 for a mass that moves as a whole */
    struct imk_tuning_fork_drive {
        double frequency;               /**< wd/2pi [Hz] */
        double q;                       /**< Qd, > 1/2 */
        double amplitude;               /**< x0 as assumed by the electronics [m] */
        double amplitude_error;         /**< relative error of the actual amplitude [1] */
        double amplitude_repeatability; /**< 1 sigma of that error from run to run [1] */
        double loop_bandwidth;          /**< of amplitude control and phase lock [Hz] */
        double force_limit;             /**< largest amplitude of the drive force [N] */
        double force_angle;   /**< of the drive force from the drive axis; positive reads as a
                                 positive rate [rad] */
        double pickoff_noise; /**< of the measured x [m/sqrt(Hz)] */
    } drive;
    struct imk_tuning_fork_sense {
        double split; /**< (ws - wd)/2pi, either sign; 0: matched [Hz] */
        double q;     /**< Qs, > 1/2 */
        imk_tuning_fork_loop loop;
        double bandwidth;     /**< of the closed loop [Hz] */
        double pickoff_noise; /**< of the measured y [m/sqrt(Hz)] */
    } sense;
    double quadrature;       /**< Wq [rad/s] */
    double damping_coupling; /**< Wc [rad/s] */
    struct imk_tuning_fork_phase {
        double error; /**< of demodulation and modulation; turns quadrature into rate [rad] */
        double repeatability; /**< 1 sigma from run to run [rad] */
        double instability;   /**< flicker B [rad] */
    } phase;
    struct imk_tuning_fork_tines {
        double asymmetry;        /**< relative difference of the two masses [1] */
        double common_frequency; /**< wc/2pi of both tines swinging together along y [Hz] */
        double gap;              /**< of the drive comb [m] */
    } tines;
    struct imk_tuning_fork_temperature {
        double frequency; /**< of both modes, relative [1/K] */
        double split;     /**< additional change of the split [Hz/K] */
        double q;         /**< of both, relative [1/K] */
        double amplitude; /**< held, relative [1/K] */
        double phase;     /**< [rad/K] */
    } temperature;        /**< linear from 233.15 to 398.15 K, constant beyond */
    struct imk_tuning_fork_output {
        double bandwidth;  /**< of the low-pass filter, -3 dB; 0: none [Hz] */
        double damping;    /**< of a filter of second order; 0: first order [1] */
        double range;      /**< full scale, also of the force of a closed loop; 0: none [rad/s] */
        double resolution; /**< step of the output; 0: none [rad/s] */
    } output;
} imk_tuning_fork;

/** A surface-micromachined gyro of the kind of the ADXRS150. Its data sheet [ADXRS150] gives the
 *  resonance (14 kHz), the bandwidth (40 Hz, one pole), the range (150 deg/s), the noise (0.05
 *  deg/s/sqrt(Hz)) and the effect of acceleration (0.2 deg/s/g), its designers the Allan floor (50
 *  deg/h) [GEEN2002]. Mass, amplitude, both Q (of a device in air), split, quadrature and the
 *  temperature coefficients are not published: plausible values were chosen, and with them the
 *  pickoff noise, the asymmetry and the instability of the phase that give those figures. */
IMK_API imk_tuning_fork imk_tuning_fork_default(void);

/** Check a design. @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the
 *  key */
IMK_API imk_status imk_tuning_fork_validate(const imk_tuning_fork *design, imk_error *error);

/** The error model of one axis; the design must be valid. Bias, scale factor and their temperature
 *  polynomials (-40 to 125 degC) come from the steady response that imk_tuning_fork_reading()
 *  evaluates. */
IMK_API void imk_tuning_fork_reduce(const imk_tuning_fork *design, imk_model *model);

/** Steady reading [rad/s] at a rate [rad/s], a specific force along the sense axis [m/s^2] and a
 *  temperature [K], without noise and output stage:
 *
 *      Im[ rho e^{i phase} ( i (W + Wc + angle wd/(2 k Qd)) + Wq ) ]
 *
 *  where rho is the response relative to the one that the electronics assume: x0 wd H(wd) for an
 *  open loop, x0 wd for a closed loop. H(w) = 1/(ws^2 - w^2 + i w ws/Qs). */
IMK_API double imk_tuning_fork_reading(const imk_tuning_fork *design, double rate,
                                       double specific_force, double temperature);

/** Motion along y per rate [m/(rad/s)]: 2 k x0 wd |H(wd)|. */
IMK_API double imk_tuning_fork_response(const imk_tuning_fork *design);

/** Angle random walk by the Brownian motion of the sense mode [rad/s/sqrt(Hz), two-sided]:
 *
 *      N = sqrt(kB T ws/(m Qs))/(k x0 wd),   T = 293.15 K unless given otherwise
 *
 *  The force on the mass has the two-sided density 2 kB T m ws/Qs; half of its power near the
 *  carrier is in phase with the velocity [LELAND2005]. */
IMK_API double imk_tuning_fork_brownian_noise(const imk_tuning_fork *design, double temperature);

/** Angle random walk by the sense pickoff: one-sided density/response [rad/s/sqrt(Hz), two-sided:
 *  demodulation doubles what one-sided had doubled]. */
IMK_API double imk_tuning_fork_pickoff_noise(const imk_tuning_fork *design);

/** Gain of an open loop for a rate that oscillates at `frequency` [Hz], relative to a steady one:
 *
 *      |G|,   G(s) = (p^2 + g s)/(s^2 + 2 g s + p^2),   g = ws/2Qs,  p^2 = (ws - wd)^2 + g^2
 *
 *  from the two sidebands of the carrier, one of which is nearer to the sense resonance. It peaks
 *  at the split; a matched gyro has G = g/(s + g). */
IMK_API double imk_tuning_fork_gain(const imk_tuning_fork *design, double frequency);

/** Frequency [Hz] up to which imk_tuning_fork_gain() is within 3 dB of 1: 0.54 |split| for a split
 *  much wider than the resonance, ws/(4 pi Qs) matched. */
IMK_API double imk_tuning_fork_bandwidth(const imk_tuning_fork *design);

/** Cubic coefficient of the scale factor of an open loop [1/(rad/s)^2]: -(k D/(D^2 + g^2))^2, D =
 *  ws - wd. The Coriolis force of the sense motion pulls the drive frequency by -k^2 W^2 D/(D^2 +
 *  g^2), and so the split. */
IMK_API double imk_tuning_fork_cubic(const imk_tuning_fork *design);

/** Force that holds the amplitude [N]: m wd^2 x0/Qd. */
IMK_API double imk_tuning_fork_drive_force(const imk_tuning_fork *design);

/** Rate [rad/s] with the same effect as an anisotropic property whose principal axes are turned by
 *  `angle` [rad]: difference sin(2 angle)/(2 k). For the difference of the angular eigenfrequencies
 *  it is the quadrature error; for the difference of 2/tau (the energy decay rates w/Q) the damping
 *  coupling [LYNCH1995]. */
IMK_API double imk_tuning_fork_coupling(double difference, double angle, double angular_gain);

/** The instrument. Outputs: rate, quadrature [rad/s]. */
IMK_API extern const imk_instrument imk_tuning_fork_instrument;

IMK_END_C
#endif
