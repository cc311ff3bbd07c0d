/* SPDX-License-Identifier: Apache-2.0 */
/** @file drift.h
 *  Growth of the errors of a model in free inertial navigation, by covariance (linear, with the
 *  share of every term) and by Monte Carlo (full mechanisation, run by run).
 *
 *  Both describe the same case: a unit at rest or on a trajectory, and a strapdown navigator. Its
 *  initial attitude is given or found by self-alignment. Its vertical channel is slaved to the true
 *  height (as by a barometer) or free. The error, estimate minus truth, at each time of interest is
 *  nine numbers,
 *
 *      0-2  position, north, east, down [m]
 *      3-5  velocity, north, east, down [m/s]
 *      6-8  attitude [rad], about north, east, down, as displayed or in Earth-fixed axes
 *           (imk_attitude_errors)
 *
 *  in the north-east-down axes of the true place. Equations: docs/theory/error-growth.md.
 *
 *  Terms with a known value (bias.fixed, misalignment, R, …) shift every run alike: they give the
 *  mean. Terms of which only the size is known (repeatability, N, B, K, Gauss-Markov, 1 sigma of
 *  calibrated values) give the covariance. With `compensated`, known values are taken out and their
 *  sigmas remain: those of biases, warm-up, scale factors, nonlinearity, misalignment, cross-axis
 *  response, sensitivities to force, lever arms, ramps, rate error and skew of the clock, with the
 *  correlations that the model states (imk_correlation). The delay caused by a bandwidth remains.
 *
 *  Power-on, from which random walks, ramps and warm-up count, is the start of the self-alignment,
 *  or of the navigation with a given attitude. */
#ifndef IMUKIT_DRIFT_H
#define IMUKIT_DRIFT_H

#include "imukit/aiding.h"
#include "imukit/executor.h"
#include "imukit/model.h"
#include "imukit/motion.h"

IMK_BEGIN_C

enum { IMK_DRIFT_STATES = 9, IMK_DRIFT_AIDED_STATES = 10, IMK_DRIFT_LANES = 8 };

/** A tenth of the Earth's radius [m]: with a larger horizontal error the position is lost, and the
 *  linear theory does not hold. */
#define IMK_DRIFT_DISTANCE_MAX 637100.0

typedef enum imk_vertical {
    IMK_VERTICAL_SLAVED = 0, /**< height and climb follow the truth */
    IMK_VERTICAL_FREE        /**< the height error grows without bound: it doubles every 6.6 min */
} imk_vertical;

typedef enum imk_alignment_source {
    IMK_ALIGNED_GIVEN = 0, /**< the initial attitude is true except for errors of initial_sigma */
    IMK_ALIGNED_SELF /**< the unit finds it at rest before the start, from the means of its readings
                        over alignment_time (imk_alignment, method means) */
} imk_alignment_source;

/** Which error of the attitude is meant, in results and in initial_sigma. */
typedef enum imk_attitude_errors {
    IMK_ATTITUDE_LOCAL = 0, /**< phi, of what a display shows: attitude relative to the local level
                               at the computed position, against the true one relative to the level
                               at the true position (imk_displayed_attitude_error()). Tilt about
                               north and east, and the error of the heading, in (-pi, pi]; of the
                               grid heading beyond IMK_GRID_LATITUDE */
    IMK_ATTITUDE_EARTH      /**< psi, against Earth-fixed axes: rotation vector, C_eb (estimated) =
                               exp([psi x]) C_eb (true). It holds what a display hides: an error of the
                               position that the attitude follows */
} imk_attitude_errors;

/** Motion, navigator and times of the analysis. Start from imk_drift_default(). */
typedef struct imk_drift_settings {
    uint32_t cookie;
    const imk_trajectory *motion; /**< NULL: at rest as follows, on the Earth */
    double latitude, height;      /**< [rad], [m]; default 45 deg, 0 */
    double roll, pitch, yaw;      /**< [rad] */
    double rate;                  /**< sampling rate [Hz]; 0.001 … 1e6, default 100 */
    imk_vertical vertical;
    imk_alignment_source alignment;
    double alignment_time;                  /**< [s]; 1 … 1e7, default 300 */
    double initial_sigma[IMK_DRIFT_STATES]; /**< 1 sigma of independent errors at the start; those
                                               of attitude are used for IMK_ALIGNED_GIVEN only, and
                                               are in the sense of `attitude_errors` */
    imk_attitude_errors attitude_errors;
    /** 1 sigma of what gravity has beside normal gravity across the vertical, north and east each
     *  [m/s^2]; 0 … 0.1, default 0. 25 to 50 ug, 5 to 10 arc seconds, are usual. */
    double gravity_deflection;
    double gravity_distance; /**< its correlation distance along the ground [m]: a Gauss-Markov
                                process of first order; default 20 km. 0: constant, as at rest */
    bool compensated;
    size_t time_count;
    const double *time; /**< times at which errors are computed, from the start of navigation:
                           increasing, > 0, up to 1e8 [s] */
    /** Aids of the navigator, up to IMK_AIDS_MAX: their true errors. The navigator then is the
     *  filter of navigation_filter.h. Their times count from the start of navigation; a reading is
     *  used at the end of the sample that has ended by then, and zero velocity only where the
     *  motion stands. While an aid gives a height, the vertical is free. */
    size_t aid_count;
    const imk_aid *aid;
    const imk_aid *filter_aid;     /**< how the filter describes the same aids; NULL: as they are */
    const imk_model *filter_model; /**< the model that the filter is made for; NULL: the model */
    /** Called by imk_drift_covariance() on its thread when the errors are computed up to `time`
     * [s]; false ends it with IMK_ERROR_CANCELLED. NULL: nobody is told. */
    bool (*progress)(void *context, double time);
    void *progress_context;
} imk_drift_settings;

/** At rest at 45 deg north, level, heading north, 100 Hz, slaved vertical, perfect start. */
IMK_API imk_drift_settings imk_drift_default(void);

/** Check the settings, and the model with them. @return the errors of imk_model_validate() and
 *  imk_trajectory_validate(), IMK_ERROR_UNINITIALISED, _NOT_FINITE, _RANGE, _EMPTY (no time),
 *  _TIME_ORDER, _CONFLICT (a motion without the Earth; self-alignment on one that does not begin at
 *  rest, or within 1 deg of a pole; with `compensated`, correlations whose matrix is not positive),
 *  _UNSUPPORTED (other than three gyros and three accelerometers along body x, y, z) */
IMK_API imk_status imk_drift_validate(const imk_model *model, const imk_drift_settings *settings,
                                      imk_error *error);

/** The vertical of these settings: free where an aid gives the height, else as they say. */
IMK_API imk_vertical imk_drift_vertical(const imk_drift_settings *settings);
/** When the outage of aids begins: the latest end (`until`) of those that end [s]; NaN: none ends.
 *  Aids without an end, such as an odometer, go on. */
IMK_API double imk_drift_outage(const imk_drift_settings *settings);

/* ---- covariance ------------------------------------------------------------------------------ */

/** Mean and covariance of the nine errors. */
typedef struct imk_drift_moments {
    double mean[IMK_DRIFT_STATES];
    double covariance[IMK_DRIFT_STATES][IMK_DRIFT_STATES]; /**< about the mean; exactly symmetric */
} imk_drift_moments;

enum { IMK_DRIFT_SOURCES_MAX = 128 };

/** One source of error: a term of the model on all axes of its sensor, or the start. */
typedef struct imk_drift_source {
    char name[64]; /**< "gyro.bias.repeatability", "accel.noise.gauss_markov[1]", "initial.attitude"
                    */
    const char *text; /**< in words: "gyro bias repeatability" */
} imk_drift_source;

/** What two sources have in common, because the values that they are the uncertainty of were
 *  calibrated together (imk_correlation): with `compensated` only. */
typedef struct imk_drift_cross {
    size_t first, second; /**< sources, first < second */
    /** [time]: means of 0, and the covariance that both together have beyond the sum of theirs; it
     *  may be negative. If the sources are multiplied by a and b, it is by a b. */
    const imk_drift_moments *moments;
} imk_drift_cross;

/** Result of imk_drift_covariance(), in the memory given to it. The moments of the sources, and
 *  after them those of the crosses, add up to the total, exactly if added in their order (variances
 *  that rounding makes negative are 0 in the total). */
typedef struct imk_drift_analysis {
    size_t source_count, time_count, cross_count;
    const imk_drift_source *source;
    const imk_drift_cross *cross;          /**< cross_count pairs of sources */
    const imk_drift_moments *contribution; /**< [source * time_count + time] */
    const imk_drift_moments *total;        /**< [time] */
    /** [time]: the covariance that the filter of an aided navigator has computed for itself; equal
     *  to `total` if its description is the truth. NULL: no aids. */
    const imk_drift_moments *believed;
    const double *time; /**< [s] */
    /** Effects that the linear theory leaves out, for a warning. Those in Monte Carlo only: dead
     *  bands, ranges that the motion comes near, a resolution coarser than the noise
     *  ("gyro.resolution"), lost samples, and vibration acting on terms that are not linear
     *  ("motion.vibration"). Left out of both: terms in temperature, as there is no temperature
     *  profile. */
    size_t omitted_count;
    const char *omitted[24];
} imk_drift_analysis;

/** Bytes for an analysis of this model and settings (both valid). */
IMK_API size_t imk_drift_covariance_size(const imk_model *model,
                                         const imk_drift_settings *settings);
/** Covariance analysis along the motion. At 2.7 GHz, a day at rest takes some 40 ms and 10 minutes
 *  of a car's drive 60 ms, mostly for the 28 stages of the flicker noise.
 *  @param memory    imk_drift_covariance_size() bytes; holds the analysis
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
 *  `imukit simulate --run`), aligned, and navigated. The bits of a run depend only on model,
 *  settings, seed and its number. With `compensated`, each run draws the error that calibration
 *  left in every known value (normal, with the model's correlations, term IMK_TERM_RESIDUAL).
 *  Initial errors are drawn by IMK_TERM_INITIAL, those of height and climb for a free vertical
 *  only. docs/theory/monte-carlo.md has the numbers.
 *
 *  Self-alignment takes the first alignment_time * rate rows, rounded; a motion has a standstill of
 *  that length before it. The error at a time is that at the end of the last sample that has ended
 *  by then, against the truth at the instant when this sample truly ended (including clock errors).
 *  Counts are divided by the sensitivity; the navigator replaces a lost row by the one before. A
 *  run takes some 70 ns a row at rest and 90 ns on a motion, on a core with AVX-512; eight runs at
 *  once are fastest.
 *  @param count   1 … IMK_DRIFT_LANES
 *  @param errors  [run][time][state], estimate minus truth; NaN after a run has left the Earth's
 *                 surroundings (below 6000 km or above 10000 km from the centre), and for a run
 *                 whose alignment found no north
 *  @return the errors of imk_drift_validate() and of the simulator, IMK_ERROR_RANGE (count, or run
 *          numbers beyond 2^32 - 1), IMK_ERROR_WORKSPACE, IMK_ERROR_ARGUMENT (no workspace) */
IMK_API imk_status imk_drift_runs(const imk_model *model, const imk_drift_settings *settings,
                                  uint64_t seed, uint32_t first, size_t count, double *errors,
                                  void *workspace, size_t workspace_size, imk_error *error);

/** As imk_drift_runs(), for a navigator with aids, whose filter runs in each run; the errors of the
 *  aids are drawn by IMK_TERM_AID. At 100 Hz with 15 states and readings once a second a run takes
 *  some 0.1 s for 10 minutes.
 *  @param errors  [run][time][IMK_DRIFT_AIDED_STATES]: the nine errors, and e^T P^-1 e of them by
 *                 the filter's own covariance P, without height and climb when they are held; it is
 *                 chi-square with imk_drift_nees_degrees() if the filter knows the truth
 *  @return also IMK_ERROR_ARGUMENT (no aids) */
IMK_API imk_status imk_drift_aided_runs(const imk_model *model, const imk_drift_settings *settings,
                                        uint64_t seed, uint32_t first, size_t count, double *errors,
                                        void *workspace, size_t workspace_size, imk_error *error);
/** Errors that are normalised: 9, or 7 with a vertical that is held. */
IMK_API int imk_drift_nees_degrees(const imk_drift_settings *settings);

/* ---- figures ----------------------------------------------------------------------------------
 */

/** Figures that summarise the errors at one time. */
typedef struct imk_drift_figures {
    double cep;  /**< radius of the circle that contains half of the horizontal errors [m] */
    double r95;  /**< radius of the circle that contains 95 % of them [m] */
    double drms; /**< root mean square horizontal error [m] */
    double north, east, height; /**< root mean squares [m] */
    double velocity;            /**< horizontal, rms [m/s] */
    double climb;               /**< vertical velocity, rms [m/s] */
    double tilt;                /**< about the horizontal axes together, rms [rad] */
    double heading;             /**< about the vertical, rms [rad] */
} imk_drift_figures;

/** Figures of a normal distribution, mean included; the radii have a relative error of 1e-9. */
IMK_API imk_drift_figures imk_drift_figures_of(const imk_drift_moments *moments);

/** Figures of `count` runs. Runs with a NaN are left out.
 *  @param errors    errors[run * stride + state]
 *  @param scratch   count doubles
 *  @param low,high  95 % intervals, or NULL: radii by order statistics (high is infinite if there
 *                   are too few runs), root mean squares by the fourth moments
 *  @param used      number of runs not left out, or NULL */
IMK_API imk_drift_figures imk_drift_figures_of_runs(size_t count, size_t stride,
                                                    const double *errors, double *scratch,
                                                    imk_drift_figures *low, imk_drift_figures *high,
                                                    size_t *used);

/** Validity of the linear theory at one time. */
typedef enum imk_drift_validity {
    IMK_DRIFT_LINEAR = 0,
    IMK_DRIFT_ROUGH, /**< tilt or heading beyond a tenth of a radian */
    IMK_DRIFT_LOST   /**< drms beyond IMK_DRIFT_DISTANCE_MAX: the position is lost */
} imk_drift_validity;
/** Validity by tilt, heading and drms. */
IMK_API imk_drift_validity imk_drift_validity_of(const imk_drift_figures *figures);

/** The figure to which a requirement applies. */
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
/** Value of the figure to which a requirement applies [SI]. */
IMK_API double imk_drift_required(const imk_drift_figures *figures,
                                  imk_drift_requirement requirement);

/** Factors by which error sources must be reduced to meet a requirement. */
typedef struct imk_drift_allocation {
    double present; /**< the present value of the figure */
    double all; /**< the requirement is met if every source is multiplied by this (> 1: margin) */
    double source[IMK_DRIFT_SOURCES_MAX]; /**< least effort: only sources above a common limit are
                                             reduced, by this factor (1: good enough) */
    /** The requirement is met if this source alone is multiplied by this; 0: not even without the
     *  source; 1 or more: it may be so much larger; infinite: it has no effect. */
    double alone[IMK_DRIFT_SOURCES_MAX];
} imk_drift_allocation;

/** Compute the factors by which sources must be reduced to meet a requirement.
 *  @param time  index of the time
 *  @param goal  largest value of the figure, SI, > 0
 *  @return IMK_ERROR_RANGE */
IMK_API imk_status imk_drift_require(const imk_drift_analysis *analysis, size_t time,
                                     imk_drift_requirement requirement, double goal,
                                     imk_drift_allocation *allocation, imk_error *error);

/** Make what a source stands for so many times as large: numbers of the model (with `compensated`
 *  the sigmas of known values), the start in the settings, or an aid. The analysis then finds the
 *  source so many times as large, with a filter that is made for the new numbers.
 *  @param source  imk_drift_source.name
 *  @param aids    those of the settings, to be changed; NULL: none
 *  @return false: nothing has this name */
IMK_API bool imk_drift_scale_source(const char *source, double factor, imk_model *model,
                                    imk_drift_settings *settings, imk_aid *aids);

IMK_END_C
#endif
