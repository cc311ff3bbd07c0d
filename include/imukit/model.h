/* SPDX-License-Identifier: Apache-2.0 */
/** @file model.h
 *  The sensor model: every error a set of gyros and accelerometers can have, in SI units, and those
 *  of a magnetometer beside them.
 *
 *  This is the one object of imukit. Instruments reduce to it, logs are identified into it, and
 *  simulation, compensation and error budgets start from it. Gyros, accelerometers and
 *  magnetometers are three imk_triad of the same type; `unit` below is rad/s for a gyro, m/s^2 for
 *  an accelerometer and T for a magnetometer. Hard iron is the bias of a magnetometer; soft iron,
 *  scale factors and misalignment together are its scale factor and cross-axis response.
 *  A term that is zero is absent; whether it is zero or only not stated is told in
 *  model_unstated.h. Equations: docs/theory. */
#ifndef IMUKIT_MODEL_H
#define IMUKIT_MODEL_H

#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

enum {
    IMK_AXES_MAX =
        8, /**< largest number of sensing axes of one kind: usually 3, more if redundant */
    IMK_TEMPERATURE_ORDER_MAX = 5, /**< largest order of the temperature polynomials */
    IMK_TERMS_MAX = 8, /**< largest number each of Gauss-Markov terms, sinusoids and resonances */
    IMK_INTERVALS_MAX = 24
};

/** One number per axis with its 1-sigma uncertainty (0: not stated). */
typedef struct imk_axes {
    double value[IMK_AXES_MAX];
    double sigma[IMK_AXES_MAX];
} imk_axes;

/** A row of three per axis (its response to the x, y, z components of a vector). */
typedef struct imk_rows {
    double value[IMK_AXES_MAX][3];
    double sigma[IMK_AXES_MAX][3];
} imk_rows;

/** A row of six per axis: its response to fx^2, fy^2, fz^2, fx fy, fy fz, fz fx. */
typedef struct imk_quadratic_rows {
    double value[IMK_AXES_MAX][6];
    double sigma[IMK_AXES_MAX][6];
} imk_quadratic_rows;

/** A scalar with its 1-sigma uncertainty. */
typedef struct imk_scalar {
    double value;
    double sigma;
} imk_scalar;

/** Change with temperature: sum over i of coefficient[i-1] (T - reference)^i, T clipped to the
 *  valid range. */
typedef struct imk_temperature_polynomial {
    int order;                                       /**< 0 … 5; 0: none */
    imk_axes coefficient[IMK_TEMPERATURE_ORDER_MAX]; /**< [unit/K^i] */
    double reference;                                /**< [K] */
    double minimum, maximum;                         /**< valid range [K] */
} imk_temperature_polynomial;

typedef struct imk_bias {
    imk_axes fixed;         /**< [unit] */
    imk_axes repeatability; /**< 1 sigma of the random constant of each run [unit]: what comes on
                               top of the noise, whose slow part also differs from run to run */
    imk_temperature_polynomial temperature;
    imk_axes temperature_rate;  /**< [unit/(K/s)] */
    imk_axes warm_up_amplitude; /**< [unit] */
    imk_scalar warm_up_time;    /**< [s], > 0 when the amplitude is not 0 */
    imk_axes hysteresis;        /**< width over the range, warming less cooling [unit] */
} imk_bias;

typedef struct imk_scale_factor {
    imk_axes fixed;                         /**< relative error [1] */
    imk_axes repeatability;                 /**< 1 sigma of the random constant of each run [1] */
    imk_temperature_polynomial temperature; /**< [1/K^i] */
} imk_scale_factor;

/** Error per axis K2 u^2 + Koq u|u| + K3 u^3 + asymmetry |u|/2 for an input u; names of IEEE 1293.
 */
typedef struct imk_nonlinearity {
    imk_axes k2, koq;        /**< [1/unit] */
    imk_axes k3;             /**< [1/unit^2] */
    imk_axes asymmetry;      /**< difference of the scale factors for + and - input, relative [1] */
    imk_rows cross_products; /**< accelerometer: Kip, Kio, Kpo of input, pendulous, output axes
                                [1/unit] */
    /** Pendulous axis for cross_products, in the body frame, unit norm, perpendicular to the
     *  direction; zeros: default axis, see distort.h. The output axis is pendulous x input. */
    double pendulous_axis[IMK_AXES_MAX][3];
} imk_nonlinearity;

typedef enum imk_density {
    IMK_DENSITY_UNSTATED = 0,
    IMK_DENSITY_TWO_SIDED,
    IMK_DENSITY_ONE_SIDED
} imk_density;

/** Stochastic terms; see noise.h for each. Values are always of two-sided densities; `density` only
 *  records how the model file states them. */
typedef struct imk_noise {
    imk_density density;
    imk_axes white;            /**< N: angle or velocity random walk [unit/sqrt(Hz)] */
    imk_axes bias_instability; /**< B [unit]; the Allan floor is 0.664 B */
    imk_scalar bias_instability_correlation_time; /**< T [s]: B^2/(2 pi f) down to 1/(2 pi T), flat
                                  below; 0: IMK_FLICKER_TIME of noise.h, 1e6 s */
    imk_axes random_walk;   /**< K: rate or acceleration random walk [unit/sqrt(s)] */
    imk_axes ramp;          /**< R: rate or acceleration ramp [unit/s] */
    imk_axes angle_white;   /**< A: white noise of the integrated output [unit s/sqrt(Hz)] */
    imk_axes reading_noise; /**< 1 sigma of each reading of the integrated output, whatever the
                               rate, such as counts behind a dither have [unit s] */
    imk_axes quantization;  /**< Q = LSB/sqrt(12) of the integrated output [unit s] */
    int gauss_markov_count, sinusoid_count, resonance_count;
    struct imk_gauss_markov_term {
        imk_axes sigma;            /**< [unit] */
        imk_axes correlation_time; /**< [s] */
    } gauss_markov[IMK_TERMS_MAX];
    struct imk_sinusoid_term {
        imk_axes amplitude; /**< [unit] */
        imk_axes frequency; /**< [Hz] */
    } sinusoid[IMK_TERMS_MAX];
    struct imk_resonance_term {
        imk_axes sigma;     /**< [unit] */
        imk_axes frequency; /**< [Hz] */
        imk_axes q;         /**< [1] */
    } resonance[IMK_TERMS_MAX];
} imk_noise;

/** A set of sensing axes of one kind: usually three, orthogonal. */
typedef struct imk_triad {
    bool present;                      /**< false: the unit has no such sensors */
    int axis_count;                    /**< 1 … IMK_AXES_MAX */
    double direction[IMK_AXES_MAX][3]; /**< sensing directions e_i in the body frame, unit norm */
    imk_bias bias;
    imk_scale_factor scale_factor;
    imk_nonlinearity nonlinearity;
    imk_rows misalignment;  /**< row i: response of axis i to the x, y, z components [rad]; the
                               diagonal of three axes is 0 */
    imk_rows cross_axis;    /**< the same for cross-coupling that is not geometric [1] */
    imk_rows g_sensitivity; /**< gyro only [rad/s/(m/s^2)] */
    imk_quadratic_rows g2_sensitivity; /**< gyro only [rad/s/(m/s^2)^2] */
    imk_rows lever_arm;                /**< accelerometer only: position of each sensor [m] */
    imk_noise noise;
    imk_axes bandwidth;   /**< -3 dB [Hz]; 0: unlimited */
    imk_axes damping;     /**< of a second-order output filter [1]; 0: first order */
    imk_axes dead_band;   /**< half width [unit] */
    imk_axes range;       /**< full scale, +-range [unit]; 0: unlimited */
    imk_axes resolution;  /**< step of the output [unit] */
    imk_axes sensitivity; /**< nominal [count/unit]; 0: output in physical units */
    imk_axes zero_offset; /**< [count] */
    /** Numbers that are 0 because they are stated to be, a bit each; see imk_model_state_zero(). */
    uint64_t stated_zero;
} imk_triad;

typedef struct imk_timing {
    imk_scalar rate_error; /**< relative error of the sample clock [1] */
    imk_scalar jitter;     /**< 1 sigma of a sample's time [s] */
    imk_scalar skew;       /**< delay of the accelerometer samples against the gyros' [s] */
    imk_scalar drops;      /**< fraction of samples lost, 0 … < 1 */
} imk_timing;

/** A 95 % interval of one parameter, as identification or calibration found it. */
typedef struct imk_interval {
    char key[48]; /**< dotted path in the triad: "noise.bias_instability" */
    int instance; /**< index in a list term ("noise.gauss_markov.sigma"), from 0; else 0 */
    /** Ends of the interval, in value[] [unit of the parameter]; for an axis without the term,
     *  lower is 0 and upper the bound. sigma[] is not used. */
    imk_axes lower, upper;
} imk_interval;

/** Where a model's numbers come from: documentation, which never alters a simulation. */
typedef struct imk_evidence {
    char source[192]; /**< file or publication */
    char method[192];
    char frame[48]; /**< convention that fixes the triad's rotation, "" when it does not matter */
    int interval_count;
    imk_interval interval[IMK_INTERVALS_MAX];
} imk_evidence;

enum { IMK_CORRELATED_MAX = 64 };

/** The deterministic terms whose numbers can be addressed one by one. Values are fixed for ever. */
typedef enum imk_model_term {
    IMK_MODEL_BIAS = 0,
    IMK_MODEL_SCALE_FACTOR = 1,
    IMK_MODEL_MISALIGNMENT = 2, /**< element: column 0 … 2, not the axis itself in a triad */
    IMK_MODEL_CROSS_AXIS = 3,   /**< element: column 0 … 2, not the axis itself in a triad */
    IMK_MODEL_K2 = 4,
    IMK_MODEL_KOQ = 5,
    IMK_MODEL_K3 = 6,
    IMK_MODEL_ASYMMETRY = 7,
    IMK_MODEL_CROSS_PRODUCTS = 8,     /**< accelerometer; element 0 Kip, 1 Kio, 2 Kpo */
    IMK_MODEL_G_SENSITIVITY = 9,      /**< gyro; element: component of force */
    IMK_MODEL_G2_SENSITIVITY = 10,    /**< gyro; element 0 … 5 */
    IMK_MODEL_LEVER_ARM = 11,         /**< accelerometer; element: component of the place */
    IMK_MODEL_BIAS_TEMPERATURE = 12,  /**< element: power - 1 */
    IMK_MODEL_SCALE_TEMPERATURE = 13, /**< element: power - 1 */
    IMK_MODEL_TEMPERATURE_RATE = 14,
    IMK_MODEL_TERMS
} imk_model_term;

/** Place of one number of a model; see model_parameter.h. */
typedef struct imk_model_parameter {
    uint8_t sensor; /**< IMK_GYRO, IMK_ACCEL or IMK_MAG */
    uint8_t term;   /**< imk_model_term */
    uint8_t axis;   /**< 0 … IMK_AXES_MAX - 1 */
    uint8_t element;
} imk_model_parameter;

/** Correlations of parameters that were estimated together; with their sigmas they give the
 *  covariance. Documentation, like imk_evidence, but error analyses use it. */
typedef struct imk_correlation {
    int count; /**< 0 … IMK_CORRELATED_MAX; 0: none stated */
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    float value[IMK_CORRELATED_MAX * (IMK_CORRELATED_MAX - 1) /
                2]; /**< correlation of parameters i > j at i (i - 1)/2 + j; -1 … 1 */
} imk_correlation;

/** The sensor model. Start from imk_model_default(), then change fields. About 84 kB. */
typedef struct imk_model {
    uint32_t cookie;
    char name[96];
    char description[256];
    char residual_of[96]; /**< not "": this model describes the errors left after compensation with
                             the model named here */
    imk_triad gyro;       /**< [rad/s] */
    imk_triad accel;      /**< [m/s^2] */
    imk_triad mag;        /**< magnetometers [T] */
    imk_timing timing;
    imk_evidence gyro_evidence, accel_evidence, mag_evidence;
    imk_correlation correlation;
} imk_model;

/** Kinds of sensors; also the index of arrays with one element for gyros and one for
 *  accelerometers. */
enum { IMK_GYRO = 0, IMK_ACCEL = 1, IMK_MAG = 2, IMK_KINDS = 3 };

/** The triad of a kind of sensor: IMK_GYRO, IMK_ACCEL or IMK_MAG. */
IMK_API const imk_triad *imk_model_triad(const imk_model *model, int sensor);
/** The triad of a kind of sensor, to be changed. */
IMK_API imk_triad *imk_model_triad_to_set(imk_model *model, int sensor);

/** 1 sigma of the error of one reading of the integral of an axis, means over dt [s] being read
 *  [unit s]: the root of Q^2 + reading_noise^2 + A^2/dt. The Allan variance of these errors is
 *  three times its square over tau^2. */
IMK_API double imk_noise_reading(const imk_noise *noise, int axis, double dt);

/** A perfect unit: orthogonal triads of gyros and accelerometers without any error, and no
 *  magnetometer. */
IMK_API void imk_model_default(imk_model *model);

/** Give a model of gyros alone, or of accelerometers alone, three perfect sensors of the other
 *  kind, along x, y and z: what a navigator needs beside them.
 *  @return the kind that was added, IMK_GYRO or IMK_ACCEL; -1: both were there */
IMK_API int imk_model_complete(imk_model *model);

/** Check every field: finite numbers, sizes, signs, unit directions, correlation times, polynomial
 *  ranges, terms that exclude each other or belong to the other kind of sensor. Elements beyond
 *  axis_count or the count of a list are not checked, nor is a sensor that is not present. A time,
 *  frequency or q may be 0 on an axis where the term's sigma or amplitude is 0.
 *  @param error  field is the dotted path ("gyro.noise.gauss_markov[1].correlation_time"), index
 *                the axis
 *  @return IMK_OK, IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _CONFLICT, _KEY_MISSING (no
 *          sensor), _KEY_UNKNOWN or _KEY_DUPLICATE (key of an interval, parameter of the
 *          correlation), _ARGUMENT (a text without a terminating zero) */
IMK_API imk_status imk_model_validate(const imk_model *model, imk_error *error);

/** Switch terms off, to see the effect of the others alone.
 *
 *  A name is a key of the model file, a term ("angle_random_walk", "noise.gauss_markov"), a group
 *  ("bias", "noise"), or either of one sensor only ("gyro.bias.fixed", "gyro.fixed",
 *  "accel.noise"), or "timing" and its keys. Fields that are not errors always stay: directions,
 *  pendulous axes, sensitivity and zero offset. Of the terms that imk_model_unstated() looks for,
 *  those switched off are stated to be 0.
 *  @param keep  true: keep only the terms named; false: remove only the terms named
 *  @return IMK_ERROR_NAME_UNKNOWN (error.found: the name, error.expected: the nearest known name)
 */
IMK_API imk_status imk_model_select(imk_model *model, bool keep, size_t count,
                                    const char *const *names, imk_error *error);

/** True when two models would simulate the same bytes (name, evidence, correlation, sigmas and
 * whether a zero is stated aside). */
IMK_API bool imk_model_equal(const imk_model *a, const imk_model *b);

/* ---- catalogue: real devices and grade presets ---------------------------------------------- */

/** One entry: a real device, or one of the five grades. */
typedef struct imk_device {
    const char *name;   /**< "ADIS16465", "tactical" */
    const char *grade;  /**< "industrial MEMS", "navigation", … */
    const char *source; /**< source of the figures */
    const char *note;   /**< conversions made and contradictions found */
    bool is_preset;     /**< one of the five grades */
} imk_device;

/** Number of entries in the catalogue, presets included. */
IMK_API size_t imk_device_count(void);
/** Entry `index`; pointers live for ever. NULL beyond the end. */
IMK_API const imk_device *imk_device_get(size_t index);
/** Entry by name, compared as in imk_name_equal() (names.h); NULL when there is none. */
IMK_API const imk_device *imk_device_find(const char *name);
/** Model of an entry; it is always valid. The Allan floor of a datasheet is divided by 0.664 to
 *  give B. `device` must come from imk_device_get() or imk_device_find(), and not be a copy. */
IMK_API void imk_device_model(const imk_device *device, imk_model *model);

/** Size, mass and supply of a device of the catalogue, as read in a source. A figure of 0 was not
 *  read anywhere. */
typedef struct imk_device_build {
    const char *device; /**< its name in the catalogue */
    double size[3];     /**< [m] */
    double mass;        /**< [kg] */
    double power;       /**< [W] */
    double current;     /**< of the supply [A], where the source states no power */
    bool is_limit;      /**< power or current are upper limits */
    const char *source;
} imk_device_build;

/** Build of a device by its name, compared as in imk_name_equal(); NULL when nothing was read. */
IMK_API const imk_device_build *imk_device_build_find(const char *name);

/* ---- grades ---------------------------------------------------------------------------------- */

typedef enum imk_grade {
    IMK_GRADE_STRATEGIC = 0,
    IMK_GRADE_NAVIGATION,
    IMK_GRADE_TACTICAL,
    IMK_GRADE_AHRS,
    IMK_GRADE_CONTROL,
    IMK_GRADE_NONE /**< worse than every class */
} imk_grade;

/** A row of the table of grades. */
typedef struct imk_grade_row {
    const char *name;
    const char *position_performance; /**< claim about the position error, as the table prints it */
    const char *gyro_technology, *accel_technology;
    double gyro_bias_limit;  /**< upper end of the class [rad/s] */
    double accel_bias_limit; /**< [m/s^2] */
    double position_limit;   /**< largest position error after position_time by that claim [m];
                                infinite: the claim has no upper end; NaN: no claim */
    double position_time;    /**< [s]; NaN without a claim */
} imk_grade_row;

/** Row of a class; NULL for IMK_GRADE_NONE. */
IMK_API const imk_grade_row *imk_grade_table(imk_grade grade);

/** Class of a model by the table, from the bias that remains after calibration: on the worst axis,
 *  the root sum of squares of repeatability, bias instability and the fixed bias's sigma. */
typedef struct imk_grade_result {
    imk_grade gyro, accel, overall;
    double gyro_bias, accel_bias; /**< the figures compared; NaN when the model states none */
    const char *limiting; /**< "gyro bias" or "accelerometer bias", whichever decides `overall` (the
                             gyro's if both are of one class); "" when the model states neither */
    /** The model has such sensors, but does not state their run-to-run bias or bias instability,
     *  and with typical values (imk_model_unstated()) the figure compared would be larger by more
     *  than 5 % of its square. The class is then the best that is possible, and no class. */
    bool gyro_at_best, accel_at_best;
    bool at_best; /**< of `overall`: either is, and the other is not below every class */
} imk_grade_result;
/** Grade of a model; see imk_grade_result. */
IMK_API imk_grade_result imk_grade_model(const imk_model *model);

/** Class by performance: the best class whose claim holds for these position errors. Navigation
 *  needs 1 nmi after an hour, strategic also 1 nmi after a day. The claim of tactical, "> 10 nmi /
 *  h", has no upper end, so any finite error after an hour is tactical at least. Lower classes
 *  claim no position: IMK_GRADE_NONE.
 *  @param hour,day  position errors after an hour and after a day [m]; not finite: the position is
 *                   lost */
IMK_API imk_grade imk_grade_of_position(double hour, double day);

IMK_END_C
#endif
