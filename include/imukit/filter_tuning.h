/* SPDX-License-Identifier: Apache-2.0 */
/** @file filter_tuning.h
 *  The noise that makes a filter consistent: white noise and bias random walk of gyros and
 *  accelerometers for a filter of attitude, velocity, position and biases, so that its covariance
 *  is that of its errors on a motion.
 *
 *  What is compared is the error of increments (attitude, velocity, position) that are integrated
 *  over a time tau from readings, less a bias known at the beginning: P_t(tau), from all errors of
 *  a sensor model on the motion, with the covariance P_m(tau) that the filter computes from four
 *  numbers. Both are means over windows that begin along the motion, in the body axes of the
 *  beginning; P_t is about zero, with the mean error in it.
 *
 *  The bias known at the beginning of a window is the mean of what the model's slow terms (fixed
 *  bias, repeatability, warm-up, ramp, bias instability, random walk, Gauss-Markov) made of the
 *  readings during `bias_time` before it, with an independent error of `bias_sigma`. All other
 *  errors enter as they are on the motion, with its vibration. Readings are integrated as means
 *  over samples, rate and force being constant in each; what this leaves out of coning and sculling
 *  is a source of error by the name "motion.sampling".
 *
 *  Equations: docs/theory/filter-tuning.md. */
#ifndef IMUKIT_FILTER_TUNING_H
#define IMUKIT_FILTER_TUNING_H

#include "imukit/drift.h"

IMK_BEGIN_C

enum {
    IMK_TUNING_MOTIONS_MAX = 8,
    IMK_TUNING_TIMES_MAX = 48,
    IMK_TUNING_WINDOWS_MAX = 1024, /**< of all motions together */
    IMK_TUNING_STATES = 9          /**< attitude 0-2 [rad], velocity 3-5 [m/s], position 6-8 [m] */
};

/** What the filter is for. Start from imk_filter_tuning_default(), then change fields. */
typedef struct imk_filter_tuning_settings {
    uint32_t cookie;
    size_t motion_count;                       /**< 1 … IMK_TUNING_MOTIONS_MAX */
    imk_motion motion[IMK_TUNING_MOTIONS_MAX]; /**< trajectories or recorded motions */
    double duration[IMK_TUNING_MOTIONS_MAX];   /**< part of the motion to use, from its start [s];
                                                  0: to its end, where it has one */
    double rate;         /**< of the readings [Hz], 0.1 … 1e5; default 200 */
    double from, to;     /**< shortest and longest time of integration [s]; default 0.01, 10 */
    size_t per_decade;   /**< times in a decade, 1 … 12; default 4 */
    size_t window_count; /**< of each motion, evenly along it, 1 … 256; default 64 */
    double bias_time; /**< the bias is known as its mean over this time [s], 0 … 1e4 (at least a
                         sample); default 1 */
    /** 1 sigma of the bias known at the beginning of a window, of gyros and accelerometers [rad/s,
     *  m/s^2], in the truth and in the filter; negative (default): the Allan deviation of the
     *  worst axis at 100 s. */
    double bias_sigma[2];
    /** Correlation time of the filter's biases [s], 1 … 1e9; 0 (default): they are random walks.
     * The bias known is held over a window, as a filter's mean does over times much shorter. */
    double correlation_time;
    /** False (default): the bias known is that of the terms of bias. True: it is the mean of all
     *  errors of the readings but fast noise and those of the clock, as a filter with updates
     *  learns it: a scale factor on gravity counts only as far as the attitude changes. */
    bool learned;
    bool compensated;   /**< as in imk_drift_settings, without correlations of the model */
    bool per_axis;      /**< numbers of each axis, not of a triad; default false */
    double eigen_limit; /**< of the safe answer, > 0: largest eigenvalue of P_m^-1 P_t; 1.05. Its N
                           and K are not below those of the model, B not counted */
} imk_filter_tuning_settings;

/** 200 Hz, 0.01 s to 10 s, 64 windows, no motion yet. */
IMK_API imk_filter_tuning_settings imk_filter_tuning_default(void);

/** Check the settings, and the model with them.
 *  @return the errors of imk_drift_validate() of the model and of imk_trajectory_validate(),
 *          IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _EMPTY (no motion), _TOO_SHORT (a motion
 *          that has no window of two samples; error.index), _CONFLICT (a recorded motion at another
 *          rate, or with a clock error) */
IMK_API imk_status imk_filter_tuning_validate(const imk_model *model,
                                              const imk_filter_tuning_settings *settings,
                                              imk_error *error);

/** Numbers of a filter, two-sided densities; [IMK_GYRO or IMK_ACCEL][axis]. */
typedef struct imk_filter_parameters {
    double white[2][3];        /**< N [unit/sqrt(Hz)] */
    double walk[2][3];         /**< K of the bias [unit/sqrt(s)]; of a Gauss-Markov process its
                                  driving noise, sigma sqrt(2/T) */
    double bias_sigma[2];      /**< 1 sigma of the bias at the beginning [unit] */
    double correlation_time;   /**< T of the biases [s]; 0: random walks */
    double scale_factor[2][3]; /**< 1 sigma of scale factors estimated besides [1]; 0: no states */
} imk_filter_parameters;

/** Whose numbers. */
typedef enum imk_filter_answer_kind {
    IMK_FILTER_STATED = 0,  /**< of the model: N, K and, for B, the usual walk of filter_noise.h */
    IMK_FILTER_TENFOLD,     /**< ten times these densities */
    IMK_FILTER_FIT,         /**< the filter is consistent in the mean: the least
                               sum over tau of tr(P_m^-1 P_t) + ln det P_m */
    IMK_FILTER_SAFE,        /**< no direction is underestimated: the least noise for which the
                               largest eigenvalue of P_m^-1 P_t is at most eigen_limit at each tau */
    IMK_FILTER_FIT_SCALED,  /**< fit of a filter that estimates scale factors, too, whose sigmas are
                               those of the model; not found if it states none */
    IMK_FILTER_SAFE_SCALED, /**< safe, with scale factors */
    IMK_FILTER_ANSWERS
} imk_filter_answer_kind;

/** "data sheet", "data sheet x10", "fit", "safe", "fit, scale factors", "safe, scale factors" */
IMK_API const char *imk_filter_answer_name(imk_filter_answer_kind kind);

/** How consistent a filter is over one time. */
typedef struct imk_filter_consistency {
    double nees;                    /**< tr(P_m^-1 P_t)/9: 1 is consistent, more is overconfident */
    double block[3];                /**< the same of attitude, velocity, position alone */
    double axis[IMK_TUNING_STATES]; /**< variance in P_t over that in P_m */
    double largest, smallest;       /**< eigenvalues of P_m^-1 P_t */
    double beyond; /**< share of errors beyond the 95 % ellipsoid of the filter, each window by its
                      own P_t and P_m: 0.05 is consistent */
} imk_filter_consistency;

/** One filter. */
typedef struct imk_filter_answer {
    bool found; /**< false: there is none, and the rest is 0 */
    imk_filter_parameters parameters;
    double mean_nees;  /**< over the times */
    bool unused[2][2]; /**< of gyros and accelerometers: N, or K, has come down to nothing */
    const imk_filter_consistency *consistency;                        /**< [time] */
    const double (*covariance)[IMK_TUNING_STATES][IMK_TUNING_STATES]; /**< P_m [time] */
    /** Share of each source in tr(P_m^-1 P_t): [source * time_count + time]. Those of one time add
     *  up to 1; one may be negative where known errors compensate each other. */
    const double *share;
} imk_filter_answer;

/** Result of imk_filter_tuning(), in the memory given to it. */
typedef struct imk_filter_tuning {
    size_t time_count, window_count;
    const double *time; /**< [s], whole numbers of samples */
    const size_t *samples;
    size_t short_count, long_count; /**< times left out: below two samples (velocity and position
                                       are then one error), and longer than a motion allows */
    size_t source_count;
    const imk_drift_source *source;
    const double (*truth)[IMK_TUNING_STATES][IMK_TUNING_STATES]; /**< P_t [time] */
    /** True increments [window * time_count + time]: attitude of the end in the axes of the
     *  beginning, by rows, velocity and position. */
    const double (*increments)[15];
    imk_filter_answer answer[IMK_FILTER_ANSWERS];
    double bias_sigma[2]; /**< as used */
    bool inconstant;     /**< true: nees of the fit is below 0.5 or above 2 at some time, so that no
                            constant noise describes the errors */
    size_t worst_time;   /**< where it is farthest from 1 */
    size_t worst_source; /**< the largest share where it is highest */
    size_t omitted_count;
    const char *omitted[24]; /**< as in imk_drift_analysis; vibration is not among them */
} imk_filter_tuning;

/** Bytes for valid model and settings. */
IMK_API size_t imk_filter_tuning_size(const imk_model *model,
                                      const imk_filter_tuning_settings *settings);
/** Find the numbers. Takes about 20 us for each sample of each window at 2.7 GHz (64 windows of
 *  10 s at 200 Hz: 3 s on one thread).
 *  @param memory    imk_filter_tuning_size() bytes; holds the result
 *  @param executor  windows are its work items; NULL: serial. The bits do not depend on it
 *  @return the errors of imk_filter_tuning_validate() and of the simulator's start;
 *          IMK_ERROR_WORKSPACE; IMK_ERROR_SINGULAR (errors without noise: nothing to fit) */
IMK_API imk_status imk_filter_tuning_run(const imk_model *model,
                                         const imk_filter_tuning_settings *settings,
                                         const imk_executor *executor, imk_filter_tuning **tuning,
                                         void *memory, size_t memory_size, imk_error *error);

/* ---- Monte Carlo ------------------------------------------------------------------------------
 */

/** Bytes of workspace for a run. */
IMK_API size_t imk_filter_tuning_runs_workspace_size(const imk_model *model,
                                                     const imk_filter_tuning_settings *settings);
/** One run: readings of imk_simulator along each motion, less the bias known, integrated from the
 *  beginning of each window, against the same integrals of the true rates and forces. The bias
 *  known is made of the simulated readings of the slow terms alone, and normal number `window` of
 *  the stream (run, IMK_TERM_INITIAL, motion, 3 sensor + axis), windows counted in each motion.
 *  @param tuning  of the same model and settings
 *  @param errors  [window][time][IMK_TUNING_STATES], windows of all motions
 *  @return the errors of the simulator, IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_filter_tuning_simulate(const imk_model *model,
                                              const imk_filter_tuning_settings *settings,
                                              const imk_filter_tuning *tuning, uint64_t seed,
                                              uint32_t run, double *errors, void *workspace,
                                              size_t workspace_size, imk_error *error);
/** Mean over the windows of e^T P_m^-1 e/9, one for each time, of errors as above. */
IMK_API void imk_filter_tuning_nees(const imk_filter_tuning *tuning, imk_filter_answer_kind kind,
                                    const double *errors, double *nees);

IMK_END_C
#endif
