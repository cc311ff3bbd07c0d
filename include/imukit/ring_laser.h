/* SPDX-License-Identifier: Apache-2.0 */
/** @file ring_laser.h
 *  The ring laser gyro: two beams in one cavity, their beat, lock-in, and the dither that overcomes
 *  lock-in.
 *
 *  Rotation makes the path longer for one beam and shorter for the other, so their frequencies
 *  differ. A little light scattered from each beam into the other pulls the two together; the phase
 *  psi of the beat follows [ARONOWITZ1971, CHOW1985]
 *
 *      psi' = K (W + W_0 + d(t)) - K W_L sin(psi + e) + noise,    K = 2 pi S,  S = 4 A/(lambda P)
 *
 *  with the input rate W, the null shift W_0, the rate d(t) = W_d cos(w t) of the dither, the
 *  lock-in rate W_L, the area A, the perimeter P and the wavelength lambda. The readout counts the
 *  fringes: floor(psi/2 pi), or half or quarter fringes.
 *
 *  Below W_L the undithered gyro reads 0. Dither carries it through that band twice a cycle; each
 *  passage kicks the phase by up to K W_L sqrt(2 pi/(K W_d w)). Under a pure sine the kicks repeat
 *  and small dead bands stay; if the amplitude varies at random from half cycle to half cycle, the
 *  kicks are independent and become angle random walk.
 *
 *  Levels. IMK_LEVEL_FULL integrates the equation through every passage, about 24 sqrt(K th_d)
 *  steps to a cycle of the dither. IMK_LEVEL_SLOW takes one kick for each half cycle; it needs a
 *  dither of at least 20 rad of phase and kicks below 0.5 rad, and is not accurate where the input
 *  rate comes within a twentieth of the peak rate of the dither, where two passages merge.
 *
 *  Without noise (settings.noise false) the dither has a constant amplitude, so its dead band
 *  appears.
 *
 *  Axes of the case: x is the normal of the beams' plane, y points to a mirror, z completes them.
 */
#ifndef IMUKIT_RING_LASER_H
#define IMUKIT_RING_LASER_H

#include "imukit/instrument.h"

IMK_BEGIN_C

/** Shape of the beams' path. */
typedef enum imk_ring_laser_shape {
    IMK_RING_LASER_TRIANGLE = 0, /**< equilateral */
    IMK_RING_LASER_SQUARE = 1
} imk_ring_laser_shape;

/** What the readout counts. */
typedef enum imk_ring_laser_decoding {
    IMK_RING_LASER_FRINGES = 0, /**< one count a fringe */
    IMK_RING_LASER_HALVES = 1,  /**< both edges of one detector */
    IMK_RING_LASER_QUARTERS = 2 /**< both edges of two detectors a quarter fringe apart */
} imk_ring_laser_decoding;

/** How the motion of the dither is removed from the reading. */
typedef enum imk_ring_laser_stripping {
    IMK_RING_LASER_PICKOFF = 0, /**< the angle that a pickoff on the dither spring measures is
                                   subtracted */
    IMK_RING_LASER_PERIODS = 1  /**< counts are read at the same point of each cycle; the reading is
                                   the rate over the last whole cycle, so it comes one cycle late */
} imk_ring_laser_stripping;

/** A design. Start from imk_ring_laser_default(), then change fields. SI units. */
typedef struct imk_ring_laser {
    uint32_t cookie;
    struct imk_ring_laser_cavity {
        imk_ring_laser_shape shape;
        double perimeter;  /**< P [m] */
        double wavelength; /**< lambda [m] */
        double loss;       /**< part of a beam's energy lost in one round trip [1] */
        double power;      /**< power circulating in each beam [W] */
    } cavity;
    struct imk_ring_laser_lock_in {
        double rate;  /**< W_L [rad/s]: without dither, rates below read 0 */
        double phase; /**< e, of the backscattered light [rad] */
    } lock_in;
    struct imk_ring_laser_dither {
        double frequency;  /**< [Hz] */
        double rate;       /**< peak rate W_d [rad/s]; 0: no dither */
        double randomness; /**< 1 sigma of the amplitude of each half cycle, relative */
    } dither;
    struct imk_ring_laser_null_shift {
        double fixed;         /**< W_0 [rad/s] */
        double repeatability; /**< 1 sigma from run to run [rad/s] */
        double instability;   /**< flicker B within a run [rad/s] */
        double temperature;   /**< change per kelvin [rad/s/K] */
    } null_shift;
    struct imk_ring_laser_scale_factor {
        double error;         /**< relative, of 4 A/(lambda P) against its nominal value */
        double repeatability; /**< 1 sigma from run to run, relative */
    } scale_factor;
    struct imk_ring_laser_path_length {
        double expansion; /**< relative change of the perimeter with temperature [1/K] */
        double stroke;    /**< change of the perimeter that its control can make, end to end [m] */
    } path_length;
    struct imk_ring_laser_alignment {
        double y, z; /**< response to rates about the case's y and z: tilt of the plane [rad] */
    } alignment;
    struct imk_ring_laser_readout {
        imk_ring_laser_decoding decoding;
        imk_ring_laser_stripping stripping;
        double pickoff_error; /**< gain of the dither pickoff less 1 */
        double range;         /**< limit of the output [rad/s] */
    } readout;
    struct imk_ring_laser_temperature {
        double reference; /**< temperature at which null shift and path length are stated [K] */
        /** Range of operation [K]; the null shift is constant beyond it. */
        double minimum, maximum;
    } temperature;
} imk_ring_laser;

/** A gyro like Honeywell's GG1320AN. Published: bias stability 0.0035 deg/h (taken as a floor of
 *  the Allan deviation: B is 1/0.664 times that), angle random walk 0.0035 deg/sqrt(h), scale
 *  factor 5 ppm. Chosen: a triangle of 16 cm, which fits its case of 88 mm, at 632.8 nm with 300
 *  ppm of loss and 10 mW a beam; a dither of 517 Hz, 150 deg/s, 2 % at random; the lock-in rate
 *  152.5 deg/h that makes up the published random walk with the quantum noise of that cavity; a
 *  bias repeatability of 0.003 deg/h; quarter fringes, 900 deg/s; a body that expands by 2e-8/K,
 *  the limit of the glass ceramic such bodies are made of; a path length control of 2 um. */
IMK_API imk_ring_laser imk_ring_laser_default(void);

/** Check a design: every field must be in its range; the dither must exceed lock-in
 *  (dither.rate > lock_in.rate) or be 0; the path length control must reach a wavelength;
 *  temperatures must be in order.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_ring_laser_validate(const imk_ring_laser *design, imk_error *error);

/** The error model; the design must be valid. Bias: null shift. Scale factor: error, repeatability,
 *  and with temperature the steps of the mode hops as a straight line, where operation reaches
 *  them. Noise: N = sqrt(N_lock^2 + N_q^2), B of the null shift, Q = count/sqrt(12). Dead band:
 *  imk_ring_laser_dead_band() if it dominates the noise, 2 b/(K N^2) > 1; else noise carries the
 *  phase through it. Not in the model: the square-root law just outside the dead band, the bands at
 *  multiples of the dither frequency, the error of the pickoff (imk_ring_laser_dither_residual()).
 */
IMK_API void imk_ring_laser_reduce(const imk_ring_laser *design, imk_model *model);

/* ---- closed forms; the design must be valid -------------------------------------------------- */

/** Enclosed area [m^2]: P^2/(12 sqrt 3) or P^2/16. */
IMK_API double imk_ring_laser_area(const imk_ring_laser *design);
/** S = 4 A/(lambda P): fringes per radian of rotation, or Hz of beat per rad/s [ARONOWITZ1971]. */
IMK_API double imk_ring_laser_fringes_per_radian(const imk_ring_laser *design);
/** Angle of one count [rad]: 1/S, half or a quarter of it. */
IMK_API double imk_ring_laser_count_angle(const imk_ring_laser *design);

/** Mean reading without dither [rad/s]: sign(W) sqrt(W^2 - W_L^2), 0 within +-W_L  [ADLER1946]. */
IMK_API double imk_ring_laser_undithered_rate(const imk_ring_laser *design, double rate);
/** Amplitude of the dither [rad]: W_d/w. */
IMK_API double imk_ring_laser_dither_angle(const imk_ring_laser *design);
/** Half width of the band around zero that reads 0 [rad/s]: W_L without dither, else
 *  W_L |J_0(K th_d)| e^(-(K th_d r)^2/2), r the randomness [CHOW1985]. */
IMK_API double imk_ring_laser_dead_band(const imk_ring_laser *design);
/** Mean reading under a pure sine dither [rad/s], without null shift and scale errors.
 *
 *  By Fourier's series sin(psi + K th_d sin w t) = sum J_n(K th_d) sin(psi + n w t) there is a band
 *  like the one at zero at every rate W_n = n w/K, of half width b_n = W_L |J_n|. The nearest acts
 *  by the square-root law, the others in second order:
 *
 *      W_n + sign(x) sqrt(x^2 - b_n^2) - sum over m != n of b_m^2/(2 (W - W_m)),   x = W - W_n
 *
 *  Higher orders are left out: with a lock-in rate of a thousandth of W_d they are 0.3 % of the
 *  largest correction. For |W| < W_d; about 1 ms. */
IMK_API double imk_ring_laser_dithered_rate(const imk_ring_laser *design, double rate);
/** Rate of the n-th band [rad/s]: n w/K. Its half width goes to *half_width, unless that is NULL.
 */
IMK_API double imk_ring_laser_band(const imk_ring_laser *design, int n, double *half_width);

/** Angle random walk caused by lock-in under random dither [rad/s/sqrt(Hz)]: W_L/sqrt(K W_d) sqrt(1
 *  - e^(-(K th_d r)^2)); 0 without dither. A kick of W_L K sqrt(2 pi/(K W_d w)) times a sine of
 *  random phase at every half cycle pi/w has this variance. */
IMK_API double imk_ring_laser_lock_in_noise(const imk_ring_laser *design);
/** Decay rate of the light in the cavity [1/s]: Gamma = c loss/P. Gamma/2 pi is its linewidth [Hz].
 */
IMK_API double imk_ring_laser_decay_rate(const imk_ring_laser *design);
/** Quantum noise [rad/s/sqrt(Hz)]: N_q = (Gamma/K) sqrt(h nu/P_lost), P_lost = loss times power:
 * each beam has the phase diffusion h nu Gamma^2/(2 P_lost) of a laser far above threshold. The
 * same as c P/(4 A Q) sqrt(h nu/P_lost) with Q = 2 pi nu/Gamma  [SCHREIBER2013, DORSCHNER1980]. */
IMK_API double imk_ring_laser_quantum_noise(const imk_ring_laser *design);
/** Relative change of scale when the cavity hops to the next mode: lambda/P. */
IMK_API double imk_ring_laser_mode_hop(const imk_ring_laser *design);
/** Change of temperature from the reference to the first mode hop [K]: half the stroke divided by
 *  the expansion of the perimeter; infinite without expansion. */
IMK_API double imk_ring_laser_hop_temperature(const imk_ring_laser *design);
/** Largest error of a sample of 1/rate caused by the error of the pickoff's gain [rad/s]: |error| 2
 *  th_d |sin(pi f/rate)| rate. It is 0 where the rate divides the dither frequency. */
IMK_API double imk_ring_laser_dither_residual(const imk_ring_laser *design, double rate);

/** The instrument. Outputs: the rate [rad/s]; the counts of the sample, dither included. */
IMK_API extern const imk_instrument imk_ring_laser_instrument;

IMK_END_C
#endif
