/* SPDX-License-Identifier: Apache-2.0 */
/** @file distort.h
 *  The deterministic terms, forward: the readings of a unit at a known motion and temperature,
 *  without noise and before the output stage.
 *
 *  Axis i of the gyros or accelerometers, with direction e_i and position r_i, reads
 *
 *      y = b + u + s u + (A + X)_i . v + n(u) + c(v)  [+ G1_i . f + G2_i . q(f) for a gyro]
 *      u = e_i . v,   n(u) = K2 u^2 + Koq u|u| + K3 u^3 + asymmetry |u|/2
 *      c(v) = Kip u p + Kio u o + Kpo p o,  p and o the components of v along the accelerometer's
 *             pendulous and output axes
 *      v = w for a gyro,   v = f + alpha x r_i + w x (w x r_i) for an accelerometer
 *      q(f) = fx^2, fy^2, fz^2, fx fy, fy fz, fz fx
 *
 *      b = fixed + run constant + polynomial(T) + rate dT/dt + warm_up e^(-t/time)
 *          + width/2 hysteresis state,     s = fixed + run constant + polynomial(T)
 *
 *  The input axis is the output axis crossed with the pendulous axis. If a model states no
 *  pendulous axis for a sensor along body axis x, y or z, the pendulous axis is z, x or y (and the
 *  output axis y, z or x).
 *
 *  Every term of axis i uses the specific force at the position of that accelerometer. All are
 *  linear combinations of twelve features of the motion (three components, six products, three more
 *  components), so that a model is compiled into weights once and applied to blocks of samples.
 *
 *  Outside a triad's valid temperature range, the polynomials keep their value at its end.
 *  Only + - * / are used, so the bits are the same everywhere. */
#ifndef IMUKIT_DISTORT_H
#define IMUKIT_DISTORT_H

#include "imukit/model.h"
#include "imukit/random.h"

IMK_BEGIN_C

/** Motion and temperature of a unit: one array per quantity, one element per sample, body axes.
 *  NULL means zero throughout (for the temperature: the polynomials are zero). */
typedef struct imk_stimulus {
    const double *angular_rate[3];         /**< of the body in inertial space [rad/s] */
    const double *specific_force[3];       /**< at the reference point of the body [m/s^2] */
    const double *angular_acceleration[3]; /**< [rad/s^2] */
    const double *temperature;             /**< [K] */
    const double *temperature_rate;        /**< [K/s] */
    const double *warm_up[2];    /**< e^(-t/time) of gyros and accelerometers, t since power-on */
    const double *hysteresis[2]; /**< -1 (cooling for long) … 1 (warming), see below */
} imk_stimulus;

/** Constants that differ from run to run, added to those of the model; zero when not drawn. */
typedef struct imk_run_constants {
    double bias[2][IMK_AXES_MAX];         /**< [unit] */
    double scale_factor[2][IMK_AXES_MAX]; /**< [1] */
} imk_run_constants;

/** One axis, compiled. The features of a gyro are w (3), the products of f (6: xx yy zz xy yz zx)
 *  and f (3); of an accelerometer f, the products of w, and alpha. */
enum { IMK_FEATURES = 12, IMK_POWERS = 6 };
typedef struct imk_axis_response {
    double input[IMK_FEATURES]; /**< u */
    double other[IMK_FEATURES]; /**< all linear terms except u and s u */
    double pendulous[IMK_FEATURES], output[IMK_FEATURES];
    bool has_cross_products, has_nonlinearity;
    double bias, scale; /**< sum of fixed value and run constant */
    /** n(u) = u^2 sum of power[0][k] u^k + |u| sum of power[1][k] u^k, k below `powers` */
    double power[2][IMK_POWERS];
    int powers;
    double kip, kio, kpo;
    double bias_temperature[IMK_TEMPERATURE_ORDER_MAX],
        scale_temperature[IMK_TEMPERATURE_ORDER_MAX];
    int bias_order, scale_order;
    double bias_reference, bias_minimum, bias_maximum;    /**< [K] */
    double scale_reference, scale_minimum, scale_maximum; /**< [K] */
    double temperature_rate, warm_up, half_hysteresis;
    double place[3];  /**< position r of an accelerometer [m]; the weights include it */
    bool has_place;   /**< r is not 0 */
    uint16_t used[4]; /**< bit k: weight k of input, other, pendulous, output is not 0 */
} imk_axis_response;

/** A model, compiled. About 11 kB; plain data. */
typedef struct imk_distortion {
    uint32_t cookie;
    imk_kernel kernel;
    int axis_count[2];
    imk_axis_response axis[2][IMK_AXES_MAX];
} imk_distortion;

/** Compile a valid model (imk_model_validate()).
 *  @param constants  NULL: none
 *  @param kernel     of imk_random_seeded(), or IMK_KERNEL_SCALAR; the bits do not depend on it
 *  @return IMK_ERROR_CONFLICT for cross products of an accelerometer in a direction without a
 *          default pendulous axis, when none is stated */
IMK_API imk_status imk_distortion_start(imk_distortion *distortion, const imk_model *model,
                                        const imk_run_constants *constants, imk_kernel kernel,
                                        imk_error *error);

/** Compute the readings of axis `axis` of the gyros or accelerometers for `count` samples [unit].
 *  `out` may not overlap the stimulus. */
IMK_API void imk_distort(const imk_distortion *distortion, int sensor, int axis,
                         const imk_stimulus *stimulus, size_t count, double *out);

/** State of the thermal hysteresis of a triad. It follows the direction in which the temperature
 *  moves and forgets the past over a turn-round span L:
 *
 *      dp = (sign(dT) - p) |dT|/L,     bias = width/2 p
 *
 *  So a sweep over the whole range opens a loop of the stated width, and an excursion much smaller
 *  than L hardly opens one. L is an eighth of the valid range of the bias polynomial, 10 K when it
 *  states none (a Duhem model of the simplest kind). Between two temperatures the equation is
 *  solved exactly, so only turning points matter, not the size of steps; a temperature that is NaN
 *  is skipped. */
typedef struct imk_hysteresis {
    double span;        /**< L [K] */
    double temperature; /**< last [K]; NaN before the first */
    double state;       /**< p; starts at 0 */
    double direction;   /**< sign of the last change; 0 before the first */
    double distance; /**< 1 - direction p: distance from the side of the loop that is approached */
} imk_hysteresis;
/** State 0, before the first temperature. */
IMK_API imk_hysteresis imk_hysteresis_start(const imk_triad *triad);
/** The state after each of the next `count` temperatures. */
IMK_API void imk_hysteresis_next(imk_hysteresis *hysteresis, size_t count,
                                 const double *temperature, double *state);

IMK_END_C
#endif
