/* SPDX-License-Identifier: Apache-2.0 */
/** @file drift.h
 *  What a sensor is worth: how the errors of a model grow in a navigator that has nothing else, by
 *  covariance (linear, with the share of every term) and by Monte Carlo (the whole mechanisation,
 *  run by run).
 *
 *  Both see the same thing: a unit at rest or on a trajectory, a strapdown navigator started with
 *  given or self-found attitude, its vertical slaved to a true height (a barometer) or free, and
 *  the error estimate minus truth at times of interest as nine numbers,
 *
 *      0-2  position, north, east, down [m]
 *      3-5  velocity, north, east, down [m/s]
 *      6-8  attitude [rad], rotation vector about north, east, down: C_nb (estimated) =
 *           exp([e x]) C_nb (true)
 *
 *  in the north-east-down axes of the true place. Equations: docs/theory/error-growth.md.
 *
 *  Terms whose value is known (bias.fixed, misalignment, R, …) shift every run alike: they make the
 *  mean. Terms of which a size is known only (repeatability, N, B, K, Gauss-Markov, 1 sigma of what
 *  was calibrated) make the covariance. With `compensated`, known values are taken out, and their
 *  sigma stays: of biases, warm-up, scale factors, nonlinearity, misalignment, cross-axis response,
 *  sensitivities to force, lever arms, ramps, rate error and skew of the clock. The delay that a
 *  bandwidth makes stays.
 *
 *  Power-on, from which random walks, ramps and warm-up count, is the start of the self-alignment,
 *  or of the navigation with a given attitude. */
#ifndef IMUKIT_DRIFT_H
#define IMUKIT_DRIFT_H

#include "imukit/executor.h"
#include "imukit/model.h"
#include "imukit/motion.h"

IMK_BEGIN_C

enum { IMK_DRIFT_STATES = 9, IMK_DRIFT_LANES = 8 };

/** A tenth of the Earth's radius [m]: a horizontal error beyond it is no position any more, and the
 *  linear theory says nothing about it. */
#define IMK_DRIFT_DISTANCE_MAX 637100.0

typedef enum imk_vertical {
    IMK_VERTICAL_SLAVED = 0, /**< height and climb follow the truth */
    IMK_VERTICAL_FREE        /**< grows without bound: doubles every 6.6 min */
} imk_vertical;

typedef enum imk_alignment_source {
    IMK_ALIGNED_GIVEN = 0, /**< initial attitude is the truth but for initial_sigma */
    IMK_ALIGNED_SELF /**< found by the unit at rest before the start, from the means of its own
                          readings over alignment_time (imk_alignment, method means) */
} imk_alignment_source;

/** What is navigated, and when to look. Start from imk_drift_default(). */
typedef struct imk_drift_settings {
    uint32_t cookie;
    const imk_trajectory *motion; /**< NULL: at rest as follows, on the Earth */
    double latitude, height;      /**< [rad], [m]; default 45 deg, 0 */
    double roll, pitch, yaw;      /**< [rad] */
    double rate;                  /**< of the samples [Hz]; 0.001 … 1e6, default 100 */
    imk_vertical vertical;
    imk_alignment_source alignment;
    double alignment_time;                  /**< [s]; 1 … 1e7, default 300 */
    double initial_sigma[IMK_DRIFT_STATES]; /**< 1 sigma of the errors at the start, independent;
                                                 those of attitude for IMK_ALIGNED_GIVEN only */
    bool compensated;
    size_t time_count;
    const double *time; /**< when to look, from the start of navigation: increasing, > 0, up to
                             1e8 [s] */
} imk_drift_settings;

/** At rest at 45 deg north, level, heading north, 100 Hz, slaved vertical, perfect start. */
IMK_API imk_drift_settings imk_drift_default(void);

/** Check the settings, and the model with them. @return the errors of imk_model_validate() and
 *  imk_trajectory_validate(), IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _EMPTY (no time),
 *  _TIME_ORDER, _CONFLICT (a motion without the Earth; self-alignment on one that does not begin at
 *  rest, or within 1 deg of a pole), _UNSUPPORTED (other than three gyros and three accelerometers
 *  along body x, y, z) */
IMK_API imk_status imk_drift_validate(const imk_model *model, const imk_drift_settings *settings,
                                      imk_error *error);

/* ---- covariance ------------------------------------------------------------------------------ */

/** Mean and covariance of the nine errors. */
typedef struct imk_drift_moments {
    double mean[IMK_DRIFT_STATES];
    double covariance[IMK_DRIFT_STATES][IMK_DRIFT_STATES]; /**< symmetric to the bit; about the
                                                                mean */
} imk_drift_moments;

enum { IMK_DRIFT_SOURCES_MAX = 128 };

/** One source of error: a term of the model on all axes of its sensor, or the start. */
typedef struct imk_drift_source {
    char name[64]; /**< "gyro.bias.repeatability", "accel.noise.gauss_markov[1]", "initial.attitude"
                    */
    const char *text; /**< for people: "gyro bias repeatability" */
} imk_drift_source;

/** Result of imk_drift_covariance(), in the memory given to it. The moments of the sources add up
 *  to the total: to the bit when added in their order. */
typedef struct imk_drift_analysis {
    size_t source_count, time_count;
    const imk_drift_source *source;
    const imk_drift_moments *contribution; /**< [source * time_count + time] */
    const imk_drift_moments *total;        /**< [time] */
    const double *time;                    /**< [s] */
    /** What the linear theory leaves out, for a warning: dead bands, ranges that the motion comes
     *  near to, resolution that noise does not carry across ("gyro.resolution"), lost samples, and
     *  what vibration makes of terms that are not linear ("motion.vibration"), which act in Monte
     *  Carlo; and terms in temperature, which without a profile of it act nowhere. */
    size_t omitted_count;
    const char *omitted[24];
} imk_drift_analysis;

/** Bytes for an analysis of this model and settings (both valid). */
IMK_API size_t imk_drift_covariance_size(const imk_model *model,
                                         const imk_drift_settings *settings);
/** Covariance analysis along the motion. A day at rest takes some 40 ms at 2.7 GHz, 10 minutes of a
 *  car's drive 60 ms, most of it for the flicker noise's 32 stages.
 *  @param memory    imk_drift_covariance_size() bytes, in which the analysis is
 *  @param executor  sources are its work items; NULL: serial. The bits do not depend on it
 *  @return the errors of imk_drift_validate(), IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_drift_covariance(const imk_model *model, const imk_drift_settings *settings,
                                        const imk_executor *executor, imk_drift_analysis **analysis,
                                        void *memory, size_t memory_size, imk_error *error);

/* ---- Monte Carlo ------------------------------------------------------------------------------
 */

/** Bytes of workspace to run up to IMK_DRIFT_LANES runs at once. */
IMK_API size_t imk_drift_runs_workspace_size(const imk_model *model,
                                             const imk_drift_settings *settings);
/** Runs first … first + count - 1: each simulated as imk_simulator does (the samples are those of
 *  `imukit simulate --run`), aligned, and navigated. A run's bits depend on model, settings, seed
 *  and its number alone. With `compensated`, each run draws what calibration left of every known
 *  value (normal, term IMK_TERM_RESIDUAL); initial errors are drawn by IMK_TERM_INITIAL, those of
 *  height and climb for a free vertical only. docs/theory/monte-carlo.md has the numbers.
 *
 *  Self-alignment takes the first alignment_time * rate rows, rounded; a motion has a standstill
 *  of that length before it. The error at a time is that at the end of the last sample that ended
 *  by then, against the truth at the instant when it truly ended, with all errors of the clock.
 *  Counts are divided by the sensitivity; the navigator takes a lost row to be like the one before.
 *  Per run and row on a core with AVX-512 some 70 ns at rest, 90 ns on a motion; eight runs at once
 *  are best.
 *  @param count   1 … IMK_DRIFT_LANES
 *  @param errors  [run][time][state], estimate minus truth; NaN from where a run left the Earth's
 *                 surroundings (below 6000 km or above 10000 km from the centre), and for a run
 *                 that found no north
 *  @return the errors of imk_drift_validate() and of the simulator, IMK_ERROR_RANGE (count, or run
 *          numbers beyond 2^32 - 1), IMK_ERROR_WORKSPACE, IMK_ERROR_ARGUMENT (no workspace) */
IMK_API imk_status imk_drift_runs(const imk_model *model, const imk_drift_settings *settings,
                                  uint64_t seed, uint32_t first, size_t count, double *errors,
                                  void *workspace, size_t workspace_size, imk_error *error);

/* ---- figures ----------------------------------------------------------------------------------
 */

/** What errors at one time amount to. */
typedef struct imk_drift_figures {
    double cep;  /**< radius of the circle that holds half of the horizontal errors [m] */
    double r95;  /**< and 95 % of them [m] */
    double drms; /**< root mean square horizontal error [m] */
    double north, east, height; /**< root mean squares [m] */
    double velocity;            /**< horizontal, rms [m/s] */
    double climb;               /**< vertical velocity, rms [m/s] */
    double tilt;                /**< roll and pitch together, rms [rad] */
    double heading;             /**< rms [rad] */
} imk_drift_figures;

/** Of a normal distribution; the radii exact to 1e-9 relative, mean included. */
IMK_API imk_drift_figures imk_drift_figures_of(const imk_drift_moments *moments);

/** Of `count` runs: errors[run * stride + state]. `low` and `high` (or NULL) are 95 % intervals:
 *  of the radii by order statistics (infinite above where the runs are too few to say), of root
 *  mean squares by the fourth moments. Runs with a NaN are left out; `used` (or NULL) counts the
 *  others.
 *  @param scratch  count doubles */
IMK_API imk_drift_figures imk_drift_figures_of_runs(size_t count, size_t stride,
                                                    const double *errors, double *scratch,
                                                    imk_drift_figures *low, imk_drift_figures *high,
                                                    size_t *used);

/** What the answer of a linear theory is worth at one time. */
typedef enum imk_drift_validity {
    IMK_DRIFT_LINEAR = 0,
    IMK_DRIFT_ROUGH, /**< tilt or heading beyond a tenth of a radian */
    IMK_DRIFT_LOST   /**< drms beyond IMK_DRIFT_DISTANCE_MAX: no position any more */
} imk_drift_validity;
/** By tilt, heading and drms. */
IMK_API imk_drift_validity imk_drift_validity_of(const imk_drift_figures *figures);

/** A requirement: a figure at a time of the analysis. */
typedef enum imk_drift_requirement {
    IMK_REQUIRED_CEP = 0,
    IMK_REQUIRED_R95,
    IMK_REQUIRED_DRMS,
    IMK_REQUIRED_HEIGHT,
    IMK_REQUIRED_VELOCITY,
    IMK_REQUIRED_TILT,
    IMK_REQUIRED_HEADING
} imk_drift_requirement;

/** "CEP", "R95", "DRMS", "height", "velocity", "tilt", "heading" */
IMK_API const char *imk_drift_requirement_name(imk_drift_requirement requirement);
/** The SI unit of its figure: "m", "m/s", "rad". */
IMK_API const char *imk_drift_requirement_unit(imk_drift_requirement requirement);
/** Value of the figure a requirement is about. */
IMK_API double imk_drift_required(const imk_drift_figures *figures,
                                  imk_drift_requirement requirement);

/** How good each source must become to meet a requirement. */
typedef struct imk_drift_allocation {
    double present;                       /**< the figure as it is */
    double all;                           /**< every source times this meets it (> 1: margin) */
    double source[IMK_DRIFT_SOURCES_MAX]; /**< the least work: only sources above a common ceiling
                                               are made better, by this factor (1: good enough) */
    double alone[IMK_DRIFT_SOURCES_MAX]; /**< this source alone made better by this factor would do;
                                              0: not even without it; 1 or more: it may be that
                                              much larger; infinite: it does not matter */
} imk_drift_allocation;

/** @param time  index of the time
 *  @param goal  of the figure, SI, > 0
 *  @return IMK_ERROR_RANGE */
IMK_API imk_status imk_drift_require(const imk_drift_analysis *analysis, size_t time,
                                     imk_drift_requirement requirement, double goal,
                                     imk_drift_allocation *allocation, imk_error *error);

IMK_END_C
#endif
