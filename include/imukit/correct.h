/* SPDX-License-Identifier: Apache-2.0 */
/** @file correct.h
 *  The deterministic terms, inverse: from what a unit reads to the angular rate and specific force
 *  of its body.
 *
 *  All channels are solved jointly, because g-sensitivity makes the rates depend on the forces and
 *  lever arms the forces on the rates. With J the linear part of distort.h at rest (a matrix of all
 *  axes against the six components x = (w, f)) the solution is the fixed point of
 *
 *      x <- x + J+ (y - distort(x)),      J+ = (J^T W J)^-1 J^T W
 *
 *  Whether it converges, and how fast, is proven when the model is loaded, not watched in the loop:
 *  interval bounds of the derivative of x - J+ distort(x) over the operating range give a
 *  non-negative 6 x 6 matrix P with |error after| <= P |error before|. P^n tells how many
 *  iterations bring the error below the tolerance for every input within the range; a model for
 *  which none does (its scale factor is not monotonic in the range, say) is refused. */
#ifndef IMUKIT_CORRECT_H
#define IMUKIT_CORRECT_H

#include "imukit/distort.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How to correct. Start from imk_correction_default(), then change fields. */
typedef struct imk_correction_settings {
    uint32_t cookie;
    /** Largest true rate [rad/s] and force [m/s^2] per body axis; 0 (default): from the model's
     * ranges, with a tenth more. Needed when the model has none and terms that are not linear. */
    double rate_limit, force_limit;
    /** Largest error of the solution for inputs within the limits, relative to the limit; default
     *  1e-14. */
    double tolerance;
    imk_kernel kernel; /**< default IMK_KERNEL_SCALAR; the bits do not depend on it */
} imk_correction_settings;
IMK_API imk_correction_settings imk_correction_default(void);

/** A model, ready to be taken out. About 13 kB; plain data. */
typedef struct imk_correction {
    uint32_t cookie;
    imk_distortion distortion;
    bool solves[2];     /**< three components of rate, of force; see imk_correct() */
    int iterations;     /**< 1 when everything is linear */
    double contraction; /**< spectral radius of P, < 1; 0: linear */
    double bound[2];    /**< of the error left after the iterations [rad/s], [m/s^2] */
    double inverse[6][2 * IMK_AXES_MAX]; /**< J+: gyro axes, then accelerometer axes */
    double per_unit[2][IMK_AXES_MAX];    /**< of outputs in counts: 1/sensitivity; else 1 */
    double zero_offset[2][IMK_AXES_MAX];
} imk_correction;

/** Compile a valid model.
 *  @return IMK_ERROR_SINGULAR (the directions do not span space in three dimensions, where terms
 *          need them to), IMK_ERROR_NO_CONVERGENCE (not invertible over the range; field names the
 *          worst term, value is the contraction and limit 1), IMK_ERROR_KEY_MISSING (field: what
 *          the model must state, such as gyro.range), IMK_ERROR_CONFLICT (g-sensitivity without
 *          accelerometers), the errors of imk_distortion_start() */
IMK_API imk_status imk_correction_start(imk_correction *correction, const imk_model *model,
                                        const imk_correction_settings *settings, imk_error *error);

/** Readings of a unit: one array per axis, physical units or counts as the model has them. */
typedef struct imk_readings {
    const double *channel[2][IMK_AXES_MAX];
    const double *angular_acceleration[3]; /**< [rad/s^2]; NULL: zero. Only lever arms need it */
    const double *temperature, *temperature_rate; /**< as in imk_stimulus */
    const double *warm_up[2];
} imk_readings;

/** Correct `count` samples: out[IMK_GYRO][0 … 2] are the components of angular rate,
 *  out[IMK_ACCEL][0 … 2] of specific force at the reference point. A set of fewer than three
 *  independent axes (solves[] is false) gives one output per axis instead: its input u, other
 *  components taken as zero. out may be the arrays of the readings. Thermal hysteresis is not
 *  taken out: the model knows its width, not its state. Repeatabilities are not known either. */
IMK_API void imk_correct(const imk_correction *correction, const imk_readings *readings,
                         size_t count, double *const out[2][IMK_AXES_MAX]);

#ifdef __cplusplus
}
#endif
#endif
