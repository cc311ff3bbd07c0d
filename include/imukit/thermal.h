/* SPDX-License-Identifier: Apache-2.0 */
/** @file thermal.h
 *  Effects of temperature on a unit at rest: polynomial, hysteresis, rate of temperature, lag.
 *
 *  The log of a unit that rests in one pose while its temperature sweeps is fitted, axis by axis,
 *  with
 *
 *      reading = c + sum a_i (T - reference)^i + rate dT/dt + width/2 p + noise
 *
 *  where p is the state of thermal hysteresis (distort.h) from the log's own history. The noise is
 *  correlated, so even a long log has few independent samples. Therefore the shares of white noise,
 *  flicker and random walk are estimated with the fit, by restricted likelihood, and give the
 *  sigmas. The order is chosen by cross-validation, which leaves out stretches of time, not single
 *  samples. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_THERMAL_H
#define IMUKIT_THERMAL_H

#include "imukit/test_record.h"

IMK_BEGIN_C

enum { IMK_THERMAL_GAPS_MAX = 24 };

/** Settings of the analysis. Start from imk_thermal_default(), then change fields. */
typedef struct imk_thermal_settings {
    uint32_t cookie;
    int order;     /**< order of the polynomial; -1 (default): chosen per axis, 0 … order_max */
    int order_max; /**< 1 … 5; default 5 */
    double reference_temperature; /**< [K]; NaN (default): 25 degC if within the range, else its
                                       middle */
    double significance; /**< probability that hysteresis, rate or lag is found where there is none;
                            default 1e-3 */
} imk_thermal_settings;
/** The defaults stated above. */
IMK_API imk_thermal_settings imk_thermal_default(void);

/** Cause of a difference between warming and cooling. */
typedef enum imk_thermal_cause {
    IMK_THERMAL_NONE = 0,   /**< no difference was found, or the log cannot show it */
    IMK_THERMAL_RATE,       /**< in proportion to dT/dt */
    IMK_THERMAL_HYSTERESIS, /**< depends on the history of the temperature */
    IMK_THERMAL_BOTH,
    IMK_THERMAL_CAUSES
} imk_thermal_cause;
/** "none", "temperature rate", "hysteresis", "hysteresis and temperature rate"; NULL beyond. */
IMK_API const char *imk_thermal_cause_name(imk_thermal_cause cause);

/** One axis. Units are those of the reading in SI. */
typedef struct imk_thermal_axis {
    int order; /**< of the polynomial */
    bool order_given;
    int order_best;      /**< order with the smallest score */
    double score[6];     /**< cross-validation, per order: root mean square error of
                              predicting blocks left out; NaN: not tried */
    double excess[6];    /**< mean square error above that of the best order, in units of its sigma;
                            the lowest order with 1 or less is chosen */
    imk_scalar constant; /**< reading at the reference temperature */
    imk_scalar coefficient[5]; /**< a_i [unit/K^i]; 0 beyond the order */
    double freedom;            /**< degrees of freedom of the sigmas */
    imk_thermal_cause cause;   /**< terms that the fit contains */
    imk_scalar hysteresis; /**< width of the loop; fitted with the cause, or alone if the cause does
                              not contain it */
    imk_scalar temperature_rate;           /**< [unit/(K/s)], fitted in the same way */
    double likelihood[IMK_THERMAL_CAUSES]; /**< log likelihood above that of IMK_THERMAL_NONE */
    imk_scalar lag; /**< delay of the sensor behind its thermometer [s], fitted instead of the
                       cause; negative: the thermometer lags */
    double lag_likelihood; /**< log likelihood of the lag instead of any cause, as above */
    bool lag_likelier; /**< a lag explains the log better than the cause, with fewer parameters */
    double refused;    /**< share of the log that was left out because it was disturbed */
    double scatter;    /**< standard deviation of the samples before any correction */
    /** Rms of samples about the best single-valued polynomial of that order. */
    double rms_polynomial;
    double rms_compensated; /**< rms after compensation of polynomial and rate; hysteresis remains,
                               as a model does not know its state */
    double rms;             /**< rms about the whole fit */
    double white, flicker, random_walk; /**< noise estimated with the fit: standard deviation of a
                                           sample, bias instability B, K [unit/sqrt(s)] */
    /** Where warming and cooling passes both cross gap_temperature: their mean readings,
     *  difference and its 1 sigma; NaN where one is missing. */
    double warming[IMK_THERMAL_GAPS_MAX], cooling[IMK_THERMAL_GAPS_MAX];
    imk_scalar gap[IMK_THERMAL_GAPS_MAX]; /**< warming less cooling */
    double gap_largest;                   /**< largest absolute gap; 0: none */
    bool single_valued; /**< no difference between warming and cooling was found; false: a
                             single-valued polynomial cannot follow this axis */
} imk_thermal_axis;

/** Result of the analysis. About 20 kB. */
typedef struct imk_thermal_findings {
    double reference; /**< reference temperature, where the polynomials are 0 and bias.fixed holds
                         [K] */
    double minimum, maximum; /**< observed range, which is the valid range [K]. Beyond it the value
                                at its end is used: there is no extrapolation */
    double mean;             /**< mean temperature of the log [K] */
    double duration;         /**< [s] */
    double fastest;          /**< largest rate of temperature [K/s] */
    int warming, cooling;    /**< number of passes */
    double overlap;          /**< share of the range crossed in both directions [1] */
    bool both_directions; /**< true: `overlap` is enough to detect hysteresis; false: hysteresis may
                             be present undetected */
    size_t samples, left_out;
    size_t blocks;     /**< number of means that were fitted */
    double force[3];   /**< mean measured specific force [m/s^2]; NaN: no triad of accelerometers.
                          Along it, a change of scale factor looks like a change of bias */
    bool accel_shared; /**< there is one pose, so the accelerometers' coefficients are the sum of
                          bias and force times scale factor */
    char residual_of[96]; /**< not "": the log was compensated with this model; the results are
                             residuals, to be added to the model, not to replace its values */
    int axis_count[2];
    imk_thermal_axis axis[2][IMK_AXES_MAX];
    int gap_count;
    double gap_temperature[IMK_THERMAL_GAPS_MAX]; /**< [K], whole degrees Celsius */
} imk_thermal_findings;

/** Bytes of workspace: about 500 kB, whatever the record. */
IMK_API size_t imk_thermal_workspace_size(void);

/** Analyse a log in one pose, or with a constant reference. The time is linear in its length, plus
 *  some 50 ms.
 *  @param model  gives sensitivities of readings in counts, ranges and residual_of
 *  @return IMK_ERROR_KEY_MISSING (field "temperature"), IMK_ERROR_UNIT_MISSING (counts without a
 *          sensitivity), IMK_ERROR_TOO_SHORT (field "temperature": range of temperature found,
 *          limit 2 K; field "samples"), IMK_ERROR_CONFLICT (field "pose": the unit was turned,
 *          index: of the sample), IMK_ERROR_RATE_MISSING, IMK_ERROR_NOT_FINITE (field "time"),
 *          IMK_ERROR_RANGE (settings), _WORKSPACE, _UNINITIALISED */
IMK_API imk_status imk_thermal_analyse(const imk_test_record *record,
                                       const imk_thermal_settings *settings, const imk_model *model,
                                       imk_thermal_findings *findings, void *workspace,
                                       size_t workspace_size, imk_error *error);

/** Put findings into a model: hysteresis, temperature_rate, reference and valid range, all with
 *  sigmas. With `polynomials` also the coefficients, which replace those of the model.
 *  @return IMK_ERROR_CONFLICT (field "residual_of": the log was compensated with a model, and this
 *          model does not describe the residual; or the numbers of axes differ) */
IMK_API imk_status imk_thermal_apply(const imk_thermal_findings *findings, bool polynomials,
                                     imk_model *model, imk_error *error);

IMK_END_C
#endif
