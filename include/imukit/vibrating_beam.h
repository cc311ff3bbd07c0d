/* SPDX-License-Identifier: Apache-2.0 */
/** @file vibrating_beam.h
 *  Vibrating beam accelerometer: a proof mass pulls at one beam, or pushes one and pulls the other
 *  of a pair, and the beams' frequencies tell the force.
 *
 *      f_i^2 = f_0i^2 (1 + c_i (T - T_0)) + kappa N_i,   kappa N/f_0^2 = 0.02458 N L^2/(E I)
 *      N_1 = m x + M,  N_2 = -(m x + M):  x what the suspension makes of the specific force,
 *                                         M the stress of the mount
 *
 *  for a beam clamped at both ends: Rayleigh's quotient with its first mode gives 12.302/500.56 =
 *  0.02458, exact to first order in N [TIMOSHENKO1974]. kappa does not depend on the modulus, so
 *  that temperature moves f_0 and leaves f_1^2 - f_2^2 alone when both beams are alike.
 *
 *  Case axes: x input; y and z across it have no effect here.
 *
 *  Full level: both oscillations, several steps a cycle, as exact rotations in phase space with
 *  thermal noise, amplitude held by the drive; crossings of zero are timed by a clock. Slow level:
 *  phases only. Both hold the force for a part of a sample short against the suspension's period.
 */
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
    double proof_mass;                /**< m a beam carries [kg], > 0 */
    double proof_mass_error;          /**< relative [1] */
    double suspension_frequency;      /**< of proof mass, flexure and beams [Hz], > 0 */
    double suspension_damping;        /**< ratio to critical [1], > 0 */
    double mount_force;               /**< M, stress of the mount [N] */
    double mount_force_repeatability; /**< 1 sigma from run to run [N], >= 0 */
    double mount_force_instability;   /**< flicker B [N], >= 0 */
    double clock;                     /**< frequency that times the crossings [Hz]; 0: perfectly */
    double range;                     /**< stops of the proof mass [m/s^2], > 0 */
    double temperature;               /**< T_0 [K], > 0 */
} imk_vibrating_beam;

/** A quartz pair of 40 kHz and 80 Hz/g over 70 g, the figures of Sundstrand's RBA-500 family (as
 *  commonly quoted; the mechanical design is chosen to give them), of tactical grade. */
IMK_API imk_vibrating_beam imk_vibrating_beam_default(void);

/** See imk_instrument. Besides single fields: at the end of the range no beam may come near
 *  buckling, kappa m range < 0.9 f_0^2 (IMK_ERROR_CONFLICT, field proof_mass.range); a
 *  beam is slender (thickness at most a fifth of the length), its amplitude ten times its thermal
 *  motion, and the clock, if there is one, ticks four times in a cycle. */
IMK_API imk_status imk_vibrating_beam_validate(const imk_vibrating_beam *design, imk_error *error);

/** f_0 = (4.73004^2/(2 pi)) sqrt(E I/(rho A L^4)) of beam 0 or 1 [Hz] [TIMOSHENKO1974]. */
IMK_API double imk_vibrating_beam_frequency(const imk_vibrating_beam *design, int beam);

/** kappa, the change of f^2 with axial force [Hz^2/N]. */
IMK_API double imk_vibrating_beam_stiffening(const imk_vibrating_beam *design);

/** Slope of f_1 at no force, kappa m/(2 f_0) [Hz/(m/s^2)]. */
IMK_API double imk_vibrating_beam_slope(const imk_vibrating_beam *design);

/** What a reading makes of a constant force by closed form, without other errors [m/s^2]:
 *  x for squares, and for frequencies (f_1 - f_2 less its value at no force)/slope. */
IMK_API double imk_vibrating_beam_reading(const imk_vibrating_beam *design, double force);

/** White noise N of the reading, two-sided [m/s^2/sqrt(Hz)]: thermal frequency noise of the beams,
 *  two-sided density k T/(Q m_b w x_0^2) of the angular frequency each, and of the suspension. */
IMK_API double imk_vibrating_beam_noise(const imk_vibrating_beam *design);

/** Q of the quantization of timing by a clock [m/s]. */
IMK_API double imk_vibrating_beam_quantization(const imk_vibrating_beam *design);

/** See imk_instrument. Stated: bias by the mount and by unequal beams with temperature, scale
 *  factor, K2 and K3 of readouts of frequencies, noise, quantization, bandwidth and damping of the
 *  suspension, range. */
IMK_API void imk_vibrating_beam_reduce(const imk_vibrating_beam *design, imk_model *model);

/** Outputs 1 and 2 are the frequencies [Hz], 3 the temperature that f_1^2 + f_2^2 tells [K].
 *  Signals: displacements of both beams, axial force, amplitudes. */
IMK_API extern const imk_instrument imk_vibrating_beam_instrument;

IMK_END_C
#endif
