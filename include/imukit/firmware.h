/* SPDX-License-Identifier: Apache-2.0 */
/** @file firmware.h
 *  Compensation on a small processor: the list of operations, with constants, that takes a model's
 *  errors out of one sample, with a bound of its error and its cost.
 *
 *  The list has no loop and no branch. Readings r are in counts or physical units; the temperature
 *  is clipped to the valid range of each polynomial and scaled to t in -1 … 1. For a linear model
 *  the list is
 *
 *      d_i = r_i - zero_i - sensitivity_i b_i(t)                    (Horner's rule)
 *      x   = W d                                    (W = J+ of correct.h / sensitivity)
 *
 *  Where the response is not linear, or the scale factor depends on temperature, the remainder n(x,
 *  t) is taken out in a fixed number of steps, which imk_correction_start() has proven to be
 *  enough,
 *
 *      x <- W d - J+ n(x, t).
 *
 *  This is the iteration of correct.h in another order.
 *
 *  Terms that cannot be corrected sample by sample stay in the reading: lever arms (they need the
 *  angular acceleration), warm-up and the rate of temperature (they need time). Theory:
 *  docs/theory/compensation.md. firmware_file.h writes the list as C code. */
#ifndef IMUKIT_FIRMWARE_H
#define IMUKIT_FIRMWARE_H

#include "imukit/compensate.h"

IMK_BEGIN_C

typedef enum imk_firmware_arithmetic {
    IMK_FIRMWARE_FLOAT,  /**< binary32 */
    IMK_FIRMWARE_DOUBLE, /**< binary64 */
    IMK_FIRMWARE_FIXED   /**< 32-bit integers of stated scale, products summed in 64 bits */
} imk_firmware_arithmetic;

/** How to plan. Start from imk_firmware_default(), then change fields. */
typedef struct imk_firmware_settings {
    uint32_t cookie;
    imk_firmware_arithmetic arithmetic;
    double rate_limit, force_limit; /**< as in imk_correction_settings */
    double tolerance; /**< largest error of the iteration for a model that is not linear, relative
                         to the limit; 0 (default): 2^-22 for float, 1e-14 for double, 2^-28 for
                         fixed point */
} imk_firmware_settings;
/** Float; limits from the model. */
IMK_API imk_firmware_settings imk_firmware_default(void);

/** One operation. Operands are numbers of earlier operations. */
typedef enum imk_firmware_kind {
    IMK_FIRMWARE_READING, /**< reading of axis `axis`, less its origin; fixed point: clipped before
                           */
    IMK_FIRMWARE_TEMPERATURE, /**< [degC] */
    IMK_FIRMWARE_CLIP,        /**< a, clipped to lower … upper */
    IMK_FIRMWARE_SIZE,        /**< |a| */
    IMK_FIRMWARE_PRODUCT,     /**< a b + constant */
    IMK_FIRMWARE_SUM          /**< constant + sum of coefficient times operand, in this order */
} imk_firmware_kind;

/** Purpose of an operation; it decides names and comments in the code. */
typedef enum imk_firmware_role {
    IMK_FIRMWARE_STEP,    /**< intermediate result for the next operation */
    IMK_FIRMWARE_CELSIUS, /**< temperature within a valid range */
    IMK_FIRMWARE_SCALED,  /**< temperature scaled to -1 … 1 */
    IMK_FIRMWARE_BIAS,    /**< in the unit of the readings, less the origin */
    IMK_FIRMWARE_INPUT,   /**< reading less bias */
    IMK_FIRMWARE_SLOPE,   /**< scale factor, as far as it depends on temperature */
    IMK_FIRMWARE_WITHIN,  /**< component of the motion, within the limits */
    IMK_FIRMWARE_ALONG,   /**< component along an axis */
    IMK_FIRMWARE_REST,    /**< part of an axis' response that is not linear */
    IMK_FIRMWARE_MOTION   /**< a component of the motion; the last one is the output */
} imk_firmware_role;

/** An addend of a sum. */
typedef struct imk_firmware_term {
    int operand;
    double coefficient; /**< as rounded to the arithmetic */
    int32_t fixed;      /**< coefficient times 2^(scale of the sum - bits of the operand) */
} imk_firmware_term;

typedef struct imk_firmware_operation {
    imk_firmware_kind kind;
    imk_firmware_role role;
    /** `step`: number of the iteration, from 1, or power of t in a polynomial. */
    int sensor, axis, step;
    int a, b;                      /**< operands of clip, size and product; else -1 */
    int first, count;              /**< terms of a sum */
    double constant, lower, upper; /**< as rounded to the arithmetic */
    int bits;                      /**< fixed point: the value is the integer times 2^-bits */
    int shift;                     /**< right shift of a sum or product */
    int64_t fixed_constant;        /**< sum: before the shift, rounding included; else after it */
    int32_t fixed_lower, fixed_upper;
    double minimum, maximum; /**< range of the exact value */
    double error;            /**< largest difference between the computed and the exact value */
} imk_firmware_operation;

/** The reading of one axis. */
typedef struct imk_firmware_channel {
    bool in_counts;
    int32_t origin;      /**< subtracted as an integer [count]; 0 in physical units */
    double lower, upper; /**< readings at or beyond these are flagged; the bound holds between */
    unsigned flag; /**< IMK_FLAG_SATURATED; without a range IMK_FLAG_LIMIT, and lower and upper
                      follow from the limits */
    int bits;      /**< fixed point: the reading is the integer times 2^-bits */
} imk_firmware_channel;

/** Number of arithmetic operations in all; a coefficient of 1 costs no multiplication. */
typedef struct imk_firmware_cost {
    int multiplications, additions;
    int comparisons; /**< for clipping and flags, in a sample without flags */
} imk_firmware_cost;

enum { IMK_FIRMWARE_OPERATIONS_MAX = 768, IMK_FIRMWARE_TERMS_MAX = 4096 };

/** A plan. About 270 kB; plain data. */
typedef struct imk_firmware {
    uint32_t cookie;
    imk_firmware_arithmetic arithmetic;
    /** The terms taken out: the model without the terms that cannot be corrected. */
    imk_model model;
    imk_correction correction; /**< correction of that model, to the tolerance of the plan */
    int axis_count[2], output_count[2];
    imk_firmware_channel channel[2][IMK_AXES_MAX];
    bool needs_temperature;
    double temperature_minimum, temperature_maximum; /**< temperatures beyond are flagged [degC] */
    int temperature_bits;                            /**< fixed point */
    bool limited[2];               /**< outputs beyond limit are flagged, see compensate.h */
    double limit[2][IMK_AXES_MAX]; /**< [rad/s], [m/s^2]; as rounded to the arithmetic */
    bool limit_stated[2];          /**< true: by range or settings; false: nominal limits */
    int output_bits[2];            /**< fixed point: scale of the outputs */
    int iterations;                /**< steps of the iteration; 1 for a linear model */
    double bound[2];               /**< largest difference of an output from imk_correct() [rad/s],
                                        [m/s^2], for unflagged samples of a motion within limit */
    imk_firmware_cost cost;
    int operation_count, term_count;
    int output[2][IMK_AXES_MAX]; /**< numbers of the operations that give the outputs */
    imk_firmware_operation operation[IMK_FIRMWARE_OPERATIONS_MAX];
    imk_firmware_term term[IMK_FIRMWARE_TERMS_MAX];
} imk_firmware;

/** Plan the compensation of a model. Needs some 60 kB of stack.
 *  @param settings  NULL: imk_firmware_default()
 *  @return errors of imk_model_validate() and imk_correction_start(); IMK_ERROR_UNINITIALISED,
 *          _ARGUMENT or _RANGE (settings); IMK_ERROR_KEY_MISSING (fixed point without a range),
 *          IMK_ERROR_UNSUPPORTED (more operations than there is room for, or numbers too large for
 *          32 bits) */
IMK_API imk_status imk_firmware_plan(imk_firmware *firmware, const imk_model *model,
                                     const imk_firmware_settings *settings, imk_error *error);

/** A sample on the device: readings in counts or physical units, temperature [degC]. */
typedef struct imk_firmware_sample {
    double reading[2][IMK_AXES_MAX];
    double temperature;
    double out[2][IMK_AXES_MAX]; /**< [rad/s], [m/s^2] */
    unsigned flags;              /**< IMK_FLAG_… bits (compensate.h) */
} imk_firmware_sample;

/** Round readings and temperature to values that the arithmetic can represent. */
IMK_API void imk_firmware_round(const imk_firmware *firmware, imk_firmware_sample *sample);
/** Compute a sample exactly as the device does: in fixed point bit by bit, in float and double
 *  except for fused multiply-adds, which round less. Call imk_firmware_round() on the sample
 *  before. */
IMK_API void imk_firmware_run(const imk_firmware *firmware, imk_firmware_sample *sample);

IMK_END_C
#endif
