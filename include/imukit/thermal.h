/* SPDX-License-Identifier: Apache-2.0 */
/** @file thermal.h
 *  What temperature does to a unit at rest: polynomial, hysteresis, rate of temperature, lag.
 *
 *  The log of a unit that rests in one pose while its temperature sweeps is fitted, axis by axis,
 *  with
 *
 *      reading = c + sum a_i (T - reference)^i + rate dT/dt + width/2 p + noise
 *
 *  p being the state of thermal hysteresis (distort.h) after the log's own history. The noise is
 *  correlated, and the number of independent samples is small however long the log: its make-up of
 *  white noise, flicker and random walk is estimated beside the fit, by restricted likelihood, and
 *  sigmas follow from it. The order is chosen by cross-validation: stretches of
 *  time are left out, not single samples. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_THERMAL_H
#define IMUKIT_THERMAL_H

#include "imukit/test_record.h"

IMK_BEGIN_C

enum { IMK_THERMAL_GAPS_MAX = 24 };

/** How to look. Start from imk_thermal_default(), then change fields. */
typedef struct imk_thermal_settings {
    uint32_t cookie;
    int order;                    /**< -1 (default): chosen per axis, 0 … order_max */
    int order_max;                /**< 1 … 5; default 5 */
    double reference_temperature; /**< [K]; NaN (default): 25 degC if within the range, else its
                                       middle */
    double significance; /**< probability at which hysteresis, rate or lag is found where there is
                              none; 1e-3 */
} imk_thermal_settings;
/** The values named above. */
IMK_API imk_thermal_settings imk_thermal_default(void);

/** What makes warming and cooling differ. */
typedef enum imk_thermal_cause {
    IMK_THERMAL_NONE = 0,   /**< nothing found, or the log cannot show it */
    IMK_THERMAL_RATE,       /**< in proportion to dT/dt */
    IMK_THERMAL_HYSTERESIS, /**< depends on where the temperature came from */
    IMK_THERMAL_BOTH,
    IMK_THERMAL_CAUSES
} imk_thermal_cause;
/** "none", "temperature rate", "hysteresis", "hysteresis and temperature rate"; NULL beyond. */
IMK_API const char *imk_thermal_cause_name(imk_thermal_cause cause);

/** One axis. Units are those of the reading in SI. */
typedef struct imk_thermal_axis {
    int order; /**< of the polynomial */
    bool order_given;
    int order_best;              /**< with the smallest score */
    double score[6];             /**< cross-validation, per order: root mean square error of
                                      predicting blocks left out; NaN: not tried */
    double excess[6];            /**< mean square error above that of the best order, in its own
                                      sigma: the lowest order with 1 or less is chosen */
    imk_scalar constant;         /**< reading at the reference temperature */
    imk_scalar coefficient[5];   /**< a_i [unit/K^i]; 0 beyond the order */
    double freedom;              /**< degrees of freedom of the sigmas */
    imk_thermal_cause cause;     /**< what the fit contains */
    imk_scalar hysteresis;       /**< width of the loop, with the cause, or alone when not in it */
    imk_scalar temperature_rate; /**< [unit/(K/s)], likewise */
    double likelihood[IMK_THERMAL_CAUSES]; /**< log likelihood above that of IMK_THERMAL_NONE */
    imk_scalar lag;         /**< of the sensor behind its thermometer [s]; negative: the thermometer
                                 lags; instead of the cause */
    double lag_likelihood;  /**< log likelihood of the lag instead of any cause, as above */
    bool lag_likelier;      /**< a lag explains more than the cause does, with fewer numbers */
    double refused;         /**< share of the log that was disturbed, and left out */
    double scatter;         /**< standard deviation of the samples before anything is taken out */
    double rms_polynomial;  /**< of samples about the best single-valued polynomial of that order */
    double rms_compensated; /**< of what compensation leaves: polynomial and rate taken out, but
                                 not hysteresis, whose state a model does not know */
    double rms;             /**< about all that was fitted */
    double white, flicker, random_walk; /**< noise found beside it: standard deviation of a sample,
                                             bias instability B, K [unit/sqrt(s)] */
    /** Where warming and cooling passes both cross gap_temperature: their mean readings,
     *  difference and its 1 sigma; NaN where one is missing. */
    double warming[IMK_THERMAL_GAPS_MAX], cooling[IMK_THERMAL_GAPS_MAX];
    imk_scalar gap[IMK_THERMAL_GAPS_MAX]; /**< warming less cooling */
    double gap_largest;                   /**< in amount; 0: none */
    bool single_valued; /**< no difference between warming and cooling was found; false: a
                             single-valued polynomial cannot follow this axis */
} imk_thermal_axis;

/** What the log shows. About 20 kB. */
typedef struct imk_thermal_findings {
    double reference;        /**< [K]: where the polynomials vanish, and bias.fixed holds */
    double minimum, maximum; /**< observed [K]: the valid range. Beyond it the value at the end
                                  holds: nothing is extrapolated */
    double mean;             /**< mean temperature of the log [K] */
    double duration;         /**< [s] */
    double fastest;          /**< largest rate of temperature [K/s] */
    int warming, cooling;    /**< passes */
    double overlap;          /**< share of the range crossed in both directions [1] */
    bool both_directions;    /**< enough of it to see hysteresis; false: it may be there unseen */
    size_t samples, left_out;
    size_t blocks;        /**< means that were fitted */
    double force[3];      /**< mean specific force as read, of a triad [m/s^2]; NaN: no such triad.
                               Along it a change of scale factor looks like one of bias */
    bool accel_shared;    /**< one pose: the accelerometers' coefficients are bias and force times
                               scale factor together */
    char residual_of[96]; /**< not "": the log was compensated with that model; what is found is
                               what is left, to be added to it, not put in its place */
    int axis_count[2];
    imk_thermal_axis axis[2][IMK_AXES_MAX];
    int gap_count;
    double gap_temperature[IMK_THERMAL_GAPS_MAX]; /**< [K], whole degrees Celsius */
} imk_thermal_findings;

/** Bytes of workspace: about 500 kB, whatever the record. */
IMK_API size_t imk_thermal_workspace_size(void);

/** Look at a log in one pose, or with a reference that is constant. Linear in its length, and some
 *  50 ms besides.
 *  @param model  sensitivities of readings in counts, ranges, residual_of
 *  @return IMK_ERROR_KEY_MISSING (field "temperature"), IMK_ERROR_UNIT_MISSING (counts without a
 *          sensitivity), IMK_ERROR_TOO_SHORT (field "temperature": range of temperature found,
 *          limit 2 K; field "samples"), IMK_ERROR_CONFLICT (field "pose": the unit was turned,
 *          index: of the sample), IMK_ERROR_RATE_MISSING, IMK_ERROR_NOT_FINITE (field "time"),
 *          IMK_ERROR_RANGE (settings), _WORKSPACE, _UNINITIALISED */
IMK_API imk_status imk_thermal_analyse(const imk_test_record *record,
                                       const imk_thermal_settings *settings, const imk_model *model,
                                       imk_thermal_findings *findings, void *workspace,
                                       size_t workspace_size, imk_error *error);

/** Put findings into a model: hysteresis, temperature_rate, reference and valid range, and when
 *  `polynomials` the coefficients too (replacing what the model had). Sigmas with them.
 *  @return IMK_ERROR_CONFLICT (field "residual_of": the log was compensated with a model, and this
 *          one is not about its residual; or another number of axes) */
IMK_API imk_status imk_thermal_apply(const imk_thermal_findings *findings, bool polynomials,
                                     imk_model *model, imk_error *error);

IMK_END_C
#endif
