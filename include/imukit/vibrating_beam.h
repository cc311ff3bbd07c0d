/* SPDX-License-Identifier: Apache-2.0 */
/** @file vibrating_beam.h
 *  Vibrating beam accelerometer: a proof mass pulls one beam, or pushes one and pulls the other of
 *  a pair, and the beams' frequencies measure the force.
 *
 *      f_i^2 = f_01^2 e_i l(n_i),   n_i = N_i L^2/(E I e_i)
 *      e_1 = 1 + c_1 (T - T_0),  e_2 = (f_02/f_01)^2 (1 + c_2 (T - T_0))
 *      N_1 = m x + M,  N_2 = -(m x + M):  x: specific force as passed by the suspension,
 *                                         M: stress of the mount
 *
 *  l is the square of the frequency of a beam clamped at both ends over that without a load, by the
 *  first root of its characteristic equation [TIMOSHENKO1974],
 *
 *      s tanh s + t tan t = 0,   s^2 - t^2 = n/4,   l = 16 s^2 t^2/4.73004^4
 *      l = 1 + 0.0245775 n - 1.50528e-5 n^2 + 7.8306e-8 n^3 …
 *
 *  and 0 at n = -4 pi^2, where the beam buckles. e_i is the modulus of a beam over that of the
 *  first: it moves f_0, and f_1^2 - f_2^2 only in the terms beyond the first.
 *
 *  Case axes: x input; y and z across it have no effect here.
 *
 *  Full level: both oscillations, several steps a cycle, as exact rotations in phase space with
 *  thermal noise, with the amplitude held by the drive; a clock times the crossings of zero, which
 *  the noise of the pickoff moves. Slow level: phases only. In both, the force is constant over a
 *  part of a sample that is short against the suspension's period. A load beyond 0.95 of that of
 *  buckling, pushed or pulled, which only temperature can cause in a valid design, counts as that.
 */
#ifndef IMUKIT_VIBRATING_BEAM_H
#define IMUKIT_VIBRATING_BEAM_H

#include "imukit/instrument.h"

IMK_BEGIN_C

typedef enum imk_beam_arrangement { IMK_BEAM_PAIR = 0, IMK_BEAM_SINGLE } imk_beam_arrangement;

typedef enum imk_beam_readout {
    IMK_BEAM_SQUARES = 0, /**< f_1^2 - f_2^2: linear in the force to first order of l */
    IMK_BEAM_FREQUENCIES  /**< f_1 - f_2 */
} imk_beam_readout;

/** A design. Start from imk_vibrating_beam_default(), then change fields. */
typedef struct imk_vibrating_beam {
    uint32_t cookie;
    int arrangement;                  /**< imk_beam_arrangement */
    int readout;                      /**< imk_beam_readout */
    double length, width, thickness;  /**< of a beam; it bends along its thickness [m], > 0 */
    double modulus;                   /**< Young's, E [Pa], > 0 */
    double density;                   /**< [kg/m^3], > 0 */
    double quality;                   /**< Q, > 1/2 */
    double amplitude;                 /**< of the middle of the beam, peak [m], > 0 */
    double pickoff_noise;             /**< at the comparator, rms [m], >= 0 */
    double frequency_mismatch;        /**< f_02/f_01 - 1 [1] */
    double frequency_temperature;     /**< c_1 of the modulus [1/K] */
    double temperature_mismatch;      /**< c_2 - c_1 [1/K] */
    double proof_mass;                /**< m per beam [kg], > 0 */
    double proof_mass_error;          /**< relative [1] */
    double suspension_frequency;      /**< of proof mass, flexure and beams [Hz], > 0 */
    double suspension_damping;        /**< ratio to critical [1], > 0 */
    double mount_force;               /**< M, stress of the mount [N] */
    double mount_force_repeatability; /**< 1 sigma from run to run [N], >= 0 */
    double mount_force_instability;   /**< flicker B [N], >= 0 */
    double clock; /**< frequency of the clock that times the crossings [Hz]; 0: perfect timing */
    double range; /**< stops of the proof mass [m/s^2], > 0 */
    double temperature; /**< T_0 [K], > 0 */
} imk_vibrating_beam;

/** A quartz pair of 40 kHz and 80 Hz/g over 70 g, the figures of Sundstrand's RBA-500 family (as
 *  commonly quoted; the mechanical design is chosen to give them), of tactical grade. */
IMK_API imk_vibrating_beam imk_vibrating_beam_default(void);

/** Check a design: every field must be in its range, and the design possible: at the end of the
 *  range the force on a beam, m range and mount, must be below 0.9 of the force that buckles it
 *  (IMK_ERROR_CONFLICT, field proof_mass.range or mount.force); a beam must be slender (thickness
 *  at most a fifth of the length), its amplitude at least ten times its thermal motion and the
 *  noise of the pickoff, and the clock, if there is one, must tick at least four times in a cycle.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_vibrating_beam_validate(const imk_vibrating_beam *design, imk_error *error);

/** Frequency f_0 = (4.73004^2/(2 pi)) sqrt(E I/(rho A L^4)) of beam 0 or 1 [Hz] [TIMOSHENKO1974].
 */
IMK_API double imk_vibrating_beam_frequency(const imk_vibrating_beam *design, int beam);

/** Frequency of beam 0 or 1 under an axial force, positive when it pulls, at T_0 [Hz]: by the
 *  characteristic equation; 0 from buckling on. */
IMK_API double imk_vibrating_beam_loaded(const imk_vibrating_beam *design, int beam, double force);

/** Force that buckles the weaker beam, 4 pi^2 E I/L^2 [N]. */
IMK_API double imk_vibrating_beam_buckling(const imk_vibrating_beam *design);

/** Change of f^2 with axial force at no force, kappa [Hz^2/N]; both beams have the same. */
IMK_API double imk_vibrating_beam_stiffening(const imk_vibrating_beam *design);

/** Slope of f_1 at no force, kappa m/(2 f_0) [Hz/(m/s^2)]. */
IMK_API double imk_vibrating_beam_slope(const imk_vibrating_beam *design);

/** Reading for a constant specific force, by the frequencies under it and without other errors
 *  [m/s^2]: (f_1^2 - f_2^2 less its value at no force)/(2 kappa m) for readouts of squares,
 *  (f_1 - f_2 less its value at no force)/(sum of the slopes) for readouts of frequencies. */
IMK_API double imk_vibrating_beam_reading(const imk_vibrating_beam *design, double force);

/** White noise N of the reading, two-sided [m/s^2/sqrt(Hz)]: thermal frequency noise of the beams,
 *  each with the two-sided density k T/(Q m_b w x_0^2) of its angular frequency, and thermal noise
 *  of the suspension. */
IMK_API double imk_vibrating_beam_noise(const imk_vibrating_beam *design);

/** Q of the rounding of crossings to ticks of the clock [m/s]: an error of the last crossing of a
 *  sample, which the next sample takes back. */
IMK_API double imk_vibrating_beam_quantization(const imk_vibrating_beam *design);

/** 1 sigma of a reading of the velocity by the noise of the pickoff [m/s], which moves the same
 *  crossing by pickoff_noise/(w x_0). */
IMK_API double imk_vibrating_beam_reading_noise(const imk_vibrating_beam *design);

/** The error model; the design must be valid. It states the bias by the mount and, with
 *  temperature, by unequal beams; scale factor, K2 and K3 by the derivatives of l at the mount's
 *  force; noise, reading noise, quantization; bandwidth and damping of the suspension; range. */
IMK_API void imk_vibrating_beam_reduce(const imk_vibrating_beam *design, imk_model *model);

/** The instrument. Outputs 1 and 2 are the frequencies [Hz], output 3 is the temperature that
 *  follows from both [K]. Signals: displacements of both beams, axial force, amplitudes. */
IMK_API extern const imk_instrument imk_vibrating_beam_instrument;

IMK_END_C
#endif
