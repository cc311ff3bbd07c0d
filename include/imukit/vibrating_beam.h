/* SPDX-License-Identifier: Apache-2.0 */
/** @file vibrating_beam.h
 *  Vibrating beam accelerometer: a proof mass pulls one beam, or pushes one and pulls the other of
 *  a pair, and the beams' frequencies measure the force.
 *
 *      f_i^2 = f_0i^2 (1 + c_i (T - T_0)) + kappa N_i,   kappa N/f_0^2 = 0.02458 N L^2/(E I)
 *      N_1 = m x + M,  N_2 = -(m x + M):  x: specific force as passed by the suspension,
 *                                         M: stress of the mount
 *
 *  for a beam clamped at both ends: Rayleigh's quotient with its first mode gives
 *  12.302/500.56 = 0.02458, exact to first order in N [TIMOSHENKO1974]. kappa does not depend on
 *  the modulus, so temperature changes f_0 but not f_1^2 - f_2^2, if both beams are equal.
 *
 *  Case axes: x input; y and z across it have no effect here.
 *
 *  Full level: both oscillations, several steps a cycle, as exact rotations in phase space with
 *  thermal noise, with the amplitude held by the drive; a clock times the crossings of zero. Slow
 *  level: phases only. In both, the force is constant over a part of a sample that is short against
 *  the suspension's period. */
#ifndef IMUKIT_VIBRATING_BEAM_H
#define IMUKIT_VIBRATING_BEAM_H

#include "imukit/instrument.h"

IMK_BEGIN_C

typedef enum imk_beam_arrangement { IMK_BEAM_PAIR = 0, IMK_BEAM_SINGLE } imk_beam_arrangement;

typedef enum imk_beam_readout {
    IMK_BEAM_SQUARES = 0, /**< f_1^2 - f_2^2: linear in the force */
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
    double frequency_mismatch;        /**< f_02/f_01 - 1 [1] */
    double frequency_temperature;     /**< c_1 of f^2 [1/K] */
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
 *  range no beam may come near buckling, kappa m range < 0.9 f_0^2 (IMK_ERROR_CONFLICT, field
 *  proof_mass.range); a beam must be slender (thickness at most a fifth of the length), its
 *  amplitude at least ten times its thermal motion, and the clock, if there is one, must tick at
 *  least four times in a cycle.
 *  @return IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT; error.field the path */
IMK_API imk_status imk_vibrating_beam_validate(const imk_vibrating_beam *design, imk_error *error);

/** Frequency f_0 = (4.73004^2/(2 pi)) sqrt(E I/(rho A L^4)) of beam 0 or 1 [Hz] [TIMOSHENKO1974].
 */
IMK_API double imk_vibrating_beam_frequency(const imk_vibrating_beam *design, int beam);

/** Change of f^2 with axial force, kappa [Hz^2/N]. */
IMK_API double imk_vibrating_beam_stiffening(const imk_vibrating_beam *design);

/** Slope of f_1 at no force, kappa m/(2 f_0) [Hz/(m/s^2)]. */
IMK_API double imk_vibrating_beam_slope(const imk_vibrating_beam *design);

/** Reading for a constant force by closed form, without other errors [m/s^2]: x for readouts of
 *  squares; (f_1 - f_2 less its value at no force)/slope for readouts of frequencies. */
IMK_API double imk_vibrating_beam_reading(const imk_vibrating_beam *design, double force);

/** White noise N of the reading, two-sided [m/s^2/sqrt(Hz)]: thermal frequency noise of the beams,
 *  each with the two-sided density k T/(Q m_b w x_0^2) of its angular frequency, and thermal noise
 *  of the suspension. */
IMK_API double imk_vibrating_beam_noise(const imk_vibrating_beam *design);

/** Q of the quantization caused by timing with a clock [m/s]. */
IMK_API double imk_vibrating_beam_quantization(const imk_vibrating_beam *design);

/** The error model; the design must be valid. It states the bias by the mount and, with
 *  temperature, by unequal beams; scale factor; K2 and K3 of readouts of frequencies; noise;
 *  quantization; bandwidth and damping of the suspension; range. */
IMK_API void imk_vibrating_beam_reduce(const imk_vibrating_beam *design, imk_model *model);

/** The instrument. Outputs 1 and 2 are the frequencies [Hz], output 3 is the temperature that
 *  follows from f_1^2 + f_2^2 [K]. Signals: displacements of both beams, axial force, amplitudes.
 */
IMK_API extern const imk_instrument imk_vibrating_beam_instrument;

IMK_END_C
#endif
