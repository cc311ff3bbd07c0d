/* SPDX-License-Identifier: Apache-2.0 */
/** @file correct.h
 *  The deterministic terms, inverse: angular rate and specific force of the body from the readings
 *  of a unit.
 *
 *  All channels are solved jointly, because g-sensitivity makes the rates depend on the forces and
 *  lever arms the forces on the rates. With J the derivative of distort.h in the middle of the
 *  range, a matrix of all axes against the six components x = (w, f), the solution is the fixed
 *  point of
 *
 *      x <- x + J+ (y - distort(x)),      x = 0 at first
 *
 *  More than three axes of a kind are solved by least squares. The forces come from the
 *  accelerometers alone, with J+ = (J^T J)^-1 J^T of the accelerometers; their effect on the gyros
 *  is subtracted from the gyros' readings.
 *
 *  Convergence and its speed are proven when the model is loaded, not checked in the loop. Interval
 *  bounds of the derivative of x - J+ distort(x) between the solution and the iterate give a
 *  non-negative matrix P with |error after| <= P |error before|. The product of these matrices
 *  tells how many iterations bring the error below the tolerance for every input within the range.
 *  A model that needs more than 200 is refused, and so is one with a reading that turns back within
 *  the range. */
#ifndef IMUKIT_CORRECT_H
#define IMUKIT_CORRECT_H

#include "imukit/distort.h"

IMK_BEGIN_C

/** How to correct. Start from imk_correction_default(), then change fields. */
typedef struct imk_correction_settings {
    uint32_t cookie;
    /** Largest true rate [rad/s] and force [m/s^2] per body axis; 0 (default): 1.1 times the
     *  model's ranges. Required when the model has no ranges but has terms that are not linear,
     *  other than lever arms and g2-sensitivity. The limit of force holds at the reference point,
     *  at every accelerometer, and for the part alpha x r alone. */
    double rate_limit, force_limit;
    /** Largest error of the solution for inputs within the limits, relative to the limit; default
     *  1e-14. */
    double tolerance;
    imk_kernel kernel; /**< default IMK_KERNEL_SCALAR; the bits do not depend on it */
} imk_correction_settings;
/** The defaults stated above. */
IMK_API imk_correction_settings imk_correction_default(void);

/** A model compiled for correction. About 12 kB; plain data. imk_correction_start() and
 *  imk_correct() need some 30 kB of stack. */
typedef struct imk_correction {
    uint32_t cookie;
    imk_distortion distortion;
    bool solves[2];       /**< true: gives three components of rate, of force; see imk_correct() */
    int output_count[2];  /**< 3, or the number of axes, or 0 without such sensors */
    bool stays_within[2]; /**< true: iterates (not outputs) are clipped to the limits, as the
                             response of the axes is not linear */
    int iterations;       /**< 1 when everything is linear */
    double contraction;   /**< spectral radius of P near the solution; 0: linear */
    double bound[2]; /**< largest error after the iterations [rad/s], [m/s^2]; rounding adds some
                        1e-15 of the limit */
    double limit[2][IMK_AXES_MAX]; /**< largest true outputs for which the bound is proven; if they
                                      come from ranges, no axis may have a larger input either; 1
                                      rad/s and 10 m/s^2 if no limit is stated or needed */
    double inverse[6][2 * IMK_AXES_MAX];  /**< J+: column i is gyro axis i, column IMK_AXES_MAX + i
                                               accelerometer axis i */
    double axis_inverse[2][IMK_AXES_MAX]; /**< the same if there is one output per axis */
    double along[2][IMK_AXES_MAX][3];     /**< direction over its squared length */
    double per_unit[2][IMK_AXES_MAX];     /**< 1/sensitivity for outputs in counts; else 1 */
    double zero_offset[2][IMK_AXES_MAX];
} imk_correction;

/** Compile a valid model.
 *  @param settings  NULL: imk_correction_default()
 *  @return IMK_ERROR_SINGULAR (the directions do not span three dimensions, but terms need that),
 *          IMK_ERROR_NO_CONVERGENCE (not invertible over the range; field names the worst term,
 *          value is the contraction and limit 1; or index the axis whose reading turns back, value
 *          the input where it does and limit its largest input), IMK_ERROR_KEY_MISSING (field: what
 *          the model must state, such as gyro.range), IMK_ERROR_CONFLICT (g-sensitivity without
 *          accelerometers, lever arms without gyros), IMK_ERROR_UNINITIALISED or _RANGE (settings),
 *          the errors of imk_distortion_start() */
IMK_API imk_status imk_correction_start(imk_correction *correction, const imk_model *model,
                                        const imk_correction_settings *settings, imk_error *error);

/** Readings of a unit: one array per axis, in counts if the model has a sensitivity, else in SI. */
typedef struct imk_readings {
    const double *channel[2][IMK_AXES_MAX];
    const double *angular_acceleration[3]; /**< [rad/s^2]; NULL: zero. Only lever arms need it */
    const double *temperature, *temperature_rate; /**< as in imk_stimulus */
    const double *warm_up[2];
} imk_readings;

/** Correct `count` samples: out[IMK_GYRO][0 … 2] are the components of angular rate,
 *  out[IMK_ACCEL][0 … 2] of specific force at the reference point. A set of fewer than three
 *  independent axes (solves[] is false) gives one output per axis instead: its input u, with other
 *  components taken as zero. out may be the arrays of the readings. A reading that is NaN makes the
 *  outputs that depend on it NaN. Thermal hysteresis is not corrected, because the model states its
 *  width, not its state; nor are run-to-run constants, which are not known. */
IMK_API void imk_correct(const imk_correction *correction, const imk_readings *readings,
                         size_t count, double *const out[2][IMK_AXES_MAX]);

IMK_END_C
#endif
