/* SPDX-License-Identifier: Apache-2.0 */
/** @file fibre_optic.h
 *  The interferometric fibre-optic gyro, open or closed loop.
 *
 *  Light of a broadband source travels both ways round a coil of fibre. Rotation about the coil's
 *  axis lengthens one path and shortens the other, by the Sagnac phase [SAGNAC1913, VALI1976]
 *
 *      phi = K W,   K = 2 pi L D/(lambda c)
 *
 *  The two waves interfere on a detector: P = P0/2 [1 + V cos(phi + delta)]. One wave passes a
 *  phase modulator at one end of the coil at once, the other after the transit time tau = n L/c, so
 *  the modulator adds delta(t) = m(t) - m(t - tau) [LEFEVRE2014]:
 *
 *  - open loop: m is a sine of the proper frequency 1/(2 tau), delta = b cos(w t), and the first
 *    harmonic of the detected power is -P0 V J1(b) sin(phi): the reading is sin(K W)/K;
 *  - closed loop: m is a square wave, delta = +b and -b in turn, each for one transit. The
 *    difference of the two powers drives the step of a digital ramp, which falls back by 2 pi when
 *    it overflows. The ramp's step per transit is the phase that cancels the Sagnac phase: the
 *    reading is -step/K, linear and independent of power.
 *
 *  Case axes: x is the axis of the coil, y and z lie in its plane; the gyro senses only x.
 *
 *  Levels: IMK_LEVEL_FULL computes each transit (closed loop) or 16 instants of each period of the
 *  modulation (open loop), with the detector's noise at the power of that moment, the rounding of
 *  the converters, the ramp and its resets. IMK_LEVEL_SLOW is the loop linearised about its
 *  operating point: first order, solved exactly over a sample, with white phase noise in continuous
 *  time; fringes remain. A sample may have any length; the exposure of a sample takes effect from
 *  its first whole transit on. Between two samples the rate may not jump by more than half a
 *  fringe, pi/K, else the loop locks on another fringe, as a real one would.
 *
 *  The default design has the optics of [MOELLER1989], whose published figures are: 1 km of
 *  polarization-preserving fibre on a radius of 16 cm; insertion loss 14 dB; angle random walk
 *  3.2e-4 deg/sqrt(h); bias within 0.03 deg/h over three days; scale factor within 32 ppm over 12
 *  days. "Within" is taken as 3 sigma. That gyro was read open loop; the closed loop is our choice,
 *  and so are all figures that were not published: the wavelength of 1550 nm, the depth of 120
 *  degrees, the source's power, and its linewidth, such that the angle random walk is the published
 *  one. */
#ifndef IMUKIT_FIBRE_OPTIC_H
#define IMUKIT_FIBRE_OPTIC_H

#include "imukit/instrument.h"

IMK_BEGIN_C

/** How the phase is read. */
typedef enum imk_fibre_optic_loop {
    IMK_FIBRE_OPTIC_CLOSED = 0, /**< square modulation, digital ramp */
    IMK_FIBRE_OPTIC_OPEN = 1    /**< sine modulation, first harmonic */
} imk_fibre_optic_loop;

/** Design. Start from imk_fibre_optic_default(), then change fields. A field named `error` is a
 *  deviation that the instrument's electronics do not know. */
typedef struct imk_fibre_optic {
    uint32_t cookie;
    int loop; /**< imk_fibre_optic_loop */

    double coil_length;      /**< L [m]; at least one turn, pi D */
    double coil_diameter;    /**< D [m] */
    double coil_index;       /**< n: group index of the fibre, 1 … 3 */
    double coil_attenuation; /**< of power [1/m]; 1 dB/km is 2.303e-4 */
    double coil_expansion;   /**< relative change of L D [1/K] */
    double thermo_optic;     /**< dn/dT [1/K] */
    /** Share of the Shupe effect that the winding leaves when one half of the coil is warmed: 1
     *  plain, 0 perfect, negative for the other half. */
    double winding_residual;

    double source_power;             /**< [W] */
    double power_error;              /**< relative [1]: scales the open-loop reading */
    double wavelength;               /**< lambda [m] */
    double wavelength_error;         /**< relative [1] */
    double wavelength_repeatability; /**< 1 sigma per run, relative [1] */
    double wavelength_temperature;   /**< relative [1/K], against 293.15 K */
    double linewidth;                /**< equivalent width of the spectrum [m] */
    double intensity_noise;          /**< relative, one-sided [1/Hz]; 0: 2/linewidth in Hz, that of
                                        polarized thermal light */
    double optics_loss; /**< loss from source to detector without the fibre, as exponent: ln(10)/10
                           per dB */
    double visibility;  /**< V of the fringes, 1e-6 … 1 */

    double modulation_depth; /**< b [rad], 0 … 3.1 */
    double depth_error;      /**< relative [1] */
    double reset_error;      /**< relative error of the reset against 2 pi [1]; closed loop */
    double gain_error; /**< of the ramp's phase, relative [1]: half-wave voltage; closed loop */
    int ramp_bits;     /**< bits of the ramp's converter over 2 pi; 0: continuous */

    double responsivity;    /**< R of the detector [A/W] */
    double load_resistance; /**< [ohm] */
    /** Power above and below the operating point at which amplifier and converter saturate [W]; 0:
     *  none. Open loop: amplitude of the harmonic. */
    double converter_range;
    int converter_bits; /**< bits over twice that range; 0: continuous. Rounding needs noise as
                           dither; without noise there is no rounding */
    double demodulation_error; /**< relative error of the demodulator's gain [1] */

    double loop_gain; /**< g: share of the phase error that a step corrects, once per 2 tau */
    double crosstalk; /**< amplitude of the phase error synchronous with the ramp, which causes a
                         dead zone [rad] */
    double range;     /**< [rad/s]; closed loop: below 2 pi/K; open loop: at most pi/(2 K) */
    int output_bits;  /**< bits of the angle's counts for one fringe 2 pi tau/K; 0: not rounded */

    double phase_fixed;         /**< nonreciprocal phase at 293.15 K [rad] */
    double phase_temperature;   /**< [rad/K] */
    double phase_repeatability; /**< 1 sigma per run [rad] */
    double phase_instability;   /**< flicker B [rad] */
} imk_fibre_optic;

/** The design described above. */
IMK_API imk_fibre_optic imk_fibre_optic_default(void);

/** Check a design: every field must be in its range, and the gyro possible: at least one turn,
 *  light on the detector, a stable loop (effective gain below 2), a range within the fringe, and
 *  noise well below the fringe.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT */
IMK_API imk_status imk_fibre_optic_validate(const imk_fibre_optic *design, imk_error *error);

/** The error model, one axis. `design` must be valid. Closed loop:
 *
 *      bias             (phase + Shupe)/K,  with repeatability, instability, temperature
 *      scale factor     -d lambda/lambda + d(LD)/LD + reset_error
 *      white noise      phase noise/(sqrt 2 K)
 *      bandwidth        of the loop
 *      dead band        crosstalk/K (beyond it the reading is sqrt(W^2 - W_x^2))
 *      quantization     2 pi tau/(K 2^bits sqrt 12)
 *
 *  Open loop: all terms are multiplied by the gain of the harmonic, K3 = -gain K^2/6, K2 = -gain K
 *  phase/2, no bandwidth, no dead band. */
IMK_API void imk_fibre_optic_reduce(const imk_fibre_optic *design, imk_model *model);

/* ---- closed forms: of the nominal design, errors and temperature aside --------------------------
 */

/** Number of turns, L/(pi D). */
IMK_API double imk_fibre_optic_turns(const imk_fibre_optic *design);
/** Phase per rate, K = 2 pi L D/(lambda c) [s] [LEFEVRE2014]. */
IMK_API double imk_fibre_optic_scale(const imk_fibre_optic *design);
/** Transit time, tau = n L/c [s]. */
IMK_API double imk_fibre_optic_transit_time(const imk_fibre_optic *design);
/** Proper frequency of the coil, 1/(2 tau) [Hz]. */
IMK_API double imk_fibre_optic_proper_frequency(const imk_fibre_optic *design);
/** Rate between neighbouring fringes, 2 pi/K [rad/s]. */
IMK_API double imk_fibre_optic_fringe_rate(const imk_fibre_optic *design);
/** Angle between two resets of the ramp, 2 pi tau/K = lambda n/D [rad]. */
IMK_API double imk_fibre_optic_reset_angle(const imk_fibre_optic *design);
/** Power at the detector on a bright fringe P0 [W], after the losses. */
IMK_API double imk_fibre_optic_detector_power(const imk_fibre_optic *design);
/** Relative intensity noise, one-sided [1/Hz]: 2/linewidth unless stated.
 *
 *  Thermal light has the intensity covariance I^2 |gamma(t)|^2 [GOODMAN1985]; the two-sided
 *  spectrum at low frequency is I^2 times the integral of |gamma|^2, which is 1/linewidth: the
 *  equivalent width is defined by it (a rectangular spectrum's own width, 1.505 times the full
 *  width at half maximum of a Gaussian one). */
IMK_API double imk_fibre_optic_intensity_noise(const imk_fibre_optic *design);
/** Noise of the measured phase, one-sided [rad/sqrt(Hz)]. Closed loop, at the operating point
 *  Pb = P0/2 (1 + V cos b), with S(P) = 4 k T/(Rf R^2) + 2 q P/R + RIN P^2 + converter:
 *
 *      sqrt(S(Pb))/(P0/2 V sin b)
 *
 *  which for V = 1 is  cot(b/2) sqrt(2 q/(R Pb) + RIN + 4 k T/(Rf (R Pb)^2)). Open loop:
 *  2 sqrt(mean of S cos^2 over a period)/(P0 V J1(b)). T = 293.15 K. */
IMK_API double imk_fibre_optic_phase_noise(const imk_fibre_optic *design);
/** Angle random walk N [rad/sqrt(s)], phase noise/(sqrt 2 K). */
IMK_API double imk_fibre_optic_angle_random_walk(const imk_fibre_optic *design);
/** Effective loop gain: g times the actual over the nominal power, demodulator gain and sin b. The
 *  loop is stable below 2. */
IMK_API double imk_fibre_optic_effective_gain(const imk_fibre_optic *design);
/** Pole of the loop -ln(1 - g)/(4 pi tau) [Hz], g the effective gain below 1: the error decays by
 *  1 - g in 2 tau. */
IMK_API double imk_fibre_optic_loop_pole(const imk_fibre_optic *design);
/** -3 dB frequency of the loop [Hz]. The loop is H = g/(z - 1 + g), z = e^{2 i pi f 2 tau}:
 *
 *      cos(4 pi f tau) = (1 + (1 - g)^2 - 2 g^2)/(2 (1 - g))
 *
 *  0 if the loop loses less than 3 dB up to half the sampling rate 1/(2 tau); also 0 for an open
 *  loop. */
IMK_API double imk_fibre_optic_bandwidth(const imk_fibre_optic *design);
/** First harmonic of an open loop per sine of the phase: actual/nominal P0 J1(b) [1]. */
IMK_API double imk_fibre_optic_harmonic_gain(const imk_fibre_optic *design);
/** Apparent rate [rad/s] of a coil whose fibre warms at `rate[i]` [K/s] in the i-th of `count`
 *  equal sections, plain winding [SHUPE1980]:
 *
 *      n/(D L) dn/dT  integral over z from 0 to L of dT/dt (L - 2 z) */
IMK_API double imk_fibre_optic_shupe_rate(const imk_fibre_optic *design, size_t count,
                                          const double *rate);
/** Apparent rate per rate of temperature [rad/s/(K/s)]: winding_residual n dn/dT L/(4 D). */
IMK_API double imk_fibre_optic_shupe_coefficient(const imk_fibre_optic *design);

/** The instrument; its design is a struct imk_fibre_optic. Outputs: the rate; resets per second. */
IMK_API extern const imk_instrument imk_fibre_optic_instrument;

IMK_END_C
#endif
