/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibration.h
 *  Bench tests -> deterministic terms of a model with their covariance: one estimator for all
 *  procedures and any combination of logs.
 *
 *  A procedure (procedure.h) turns a log into observations: mean readings at an input that is known
 *  (rate table, centrifuge), known but for a small placement error (six faces), or of which only
 *  the amount is known (any pose under gravity), and turns between two poses, over which the gyros
 *  must carry the vertical from one to the other. The solver fits all of them at once by maximum
 *  likelihood, with the attitudes that are not known, the placements and the mounting on the
 *  fixture as further unknowns:
 *
 *      reading = sensitivity * distort(model, rate, force, temperature) + zero offset + noise
 *
 *  Observations and turns that do not fit are refused as a whole: beyond a limit that a good set
 *  passes in 99 of 100 calibrations, found from a fit that a minority of bad ones cannot spoil
 *  (Huber's weights, then Tukey's biweight). What is not refused has full weight. The scatter
 *  within a hold is not the whole uncertainty of its mean: each group of observations (readings of
 *  gyros, of accelerometers, turns) gets its own factor from its residuals, when these have 3
 *  degrees of freedom or more, and 1 sigma and intervals are stated with it.
 *
 *  Slow noise, which observations of one record share, shows in no residual. Where the model states
 *  it (bias_instability, random_walk, gauss_markov longer than a hold), sigmas, covariance and
 *  intervals contain it. A bias is that during the test, the mean of its slow noise over the whole
 *  record included, and its sigma is that of this figure. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_CALIBRATION_H
#define IMUKIT_CALIBRATION_H

#include "imukit/model_parameter.h"
#include "imukit/test_record.h"

IMK_BEGIN_C

enum { IMK_TEST_RECORDS_MAX = 64, IMK_FIXTURES_MAX = 8 };

/** What fixes the rotation of the triads: |g| alone does not. Both triads share the body frame. */
typedef enum imk_triad_frame {
    IMK_FRAME_UPPER = 0, /**< response of the accelerometers upper triangular: z senses along body
                              z, y in the plane of y and z */
    IMK_FRAME_LOWER,     /**< lower triangular: x senses along body x, y in the plane of x and y */
    IMK_FRAME_SYMMETRIC, /**< response of the accelerometers symmetric: no axis is preferred */
    IMK_FRAME_REFERENCE  /**< that of the reference: faces of the housing, axes of the table */
} imk_triad_frame;
/** "upper-triangular", "lower-triangular", "symmetric", "reference"; NULL beyond the last. */
IMK_API const char *imk_triad_frame_name(imk_triad_frame frame);

/** How much of an observation's input is known. */
typedef enum imk_input_knowledge {
    IMK_INPUT_KNOWN = 0, /**< rate and force, but for the mounting on the fixture */
    IMK_INPUT_PLACED,    /**< but for a small rotation as well, 1 sigma `placement_sigma` an axis */
    IMK_INPUT_GRAVITY    /**< only that it is at rest on Earth: |force| = gravity */
} imk_input_knowledge;

/** Groups with a variance factor each. */
typedef enum imk_observation_group {
    IMK_GROUP_GYRO = 0, /**< readings of gyros */
    IMK_GROUP_ACCEL,    /**< readings of accelerometers */
    IMK_GROUP_TURN,     /**< turns between poses */
    IMK_GROUPS
} imk_observation_group;

/** The mean of some samples, and what the unit was exposed to. */
typedef struct imk_observation {
    imk_input_knowledge knowledge;
    int record;                      /**< index in imk_calibration.record; -1: none, readings are
                                          SI */
    size_t begin, end;               /**< its samples */
    double reading[2][IMK_AXES_MAX]; /**< mean, in the record's unit; NaN: not observed */
    double sigma[2][IMK_AXES_MAX];   /**< of the mean, from the scatter within, > 0 */
    double rate[3], force[3];        /**< nominal input; with IMK_INPUT_GRAVITY force is a first
                                          guess, or zeros, and rate is not used */
    double angular_acceleration[3];  /**< [rad/s^2] */
    double temperature;              /**< [K]; NaN: not known, the polynomials vanish */
    double temperature_rate;         /**< [K/s] */
    double placement_sigma;          /**< [rad] */
    int fixture;                     /**< whose mounting it shares; -1: none */
    bool correlated;                 /**< sigma has the part of slow noise already: none is added */
    /* Filled by imk_calibration_solve(): */
    double residual[2][IMK_AXES_MAX]; /**< reading less fit [rad/s], [m/s^2]; NaN: not observed */
    double vertical[3]; /**< of an unknown attitude: direction of the specific force, body axes */
    double distance;    /**< root mean square of residual over sigma (variance factors taken into
                             account) */
    double weight;      /**< 1 used in full … 0 refused */
} imk_observation;

/** A turn between two observations at unknown attitudes of one record: the gyros must carry the
 *  vertical of `from` to that of `to`. */
typedef struct imk_turn {
    int from, to;       /**< observations */
    size_t begin, end;  /**< samples of the record integrated: from the middle of one rest into the
                             other, or less */
    double sigma;       /**< of the angle about each axis across the vertical [rad], > 0 */
    double earth_sigma; /**< the part of it that is the Earth's horizontal rate, whose heading is
                           not known [rad], 0 (none) or more, < sigma: a root mean square */
    /* Filled by imk_calibration_solve(): */
    double residual[2]; /**< across the vertical [rad] */
    double angle;       /**< turned by [rad] */
    double distance, weight;
} imk_turn;

/** The problem. Start from imk_calibration_default(), then set fields and let procedures add to it.
 *  About 60 kB. */
typedef struct imk_calibration {
    uint32_t cookie;
    imk_model model; /**< what is known before: nominal sensitivities, terms not estimated, slow
                          noise; free parameters start here */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX]; /**< free */
    double prior_sigma[IMK_CORRELATED_MAX]; /**< around the model's value; 0: nothing known */
    imk_triad_frame frame;                  /**< IMK_FRAME_UPPER by default */
    double gravity;                         /**< [m/s^2] */
    double latitude;   /**< geodetic [rad], for the Earth's rotation; NaN: not known, which
                            widens the sigma of gyro readings at rest by what it may be */
    double earth_rate; /**< 7.292115e-5 rad/s; 0: references contain no Earth rate, a bias of
                            gyros takes it in */
    bool robust;       /**< default true */
    size_t record_count;
    const imk_test_record *record[IMK_TEST_RECORDS_MAX];
    size_t fixture_count;
    double fixture_sigma[IMK_FIXTURES_MAX]; /**< 1 sigma of the mounting's angles [rad]; 0: exact */
    size_t observation_count, observation_capacity;
    imk_observation *observation; /**< the caller's */
    size_t turn_count, turn_capacity;
    imk_turn *turn; /**< the caller's */
} imk_calibration;

/** A perfect unit, nothing free, nothing observed, normal gravity at 45 deg and sea level, robust.
 */
IMK_API void imk_calibration_default(imk_calibration *calibration);
/** Make a parameter free, if it is not yet. @return IMK_ERROR_ARGUMENT (no such number),
 *  IMK_ERROR_RANGE (IMK_CORRELATED_MAX are) */
IMK_API imk_status imk_calibration_free(imk_calibration *calibration, int sensor, int term,
                                        int axis, int element);
/** Add an observation. @return its index, or -1 when the capacity is used up */
IMK_API int imk_calibration_observe(imk_calibration *calibration,
                                    const imk_observation *observation);

/** One group's fit. */
typedef struct imk_group_fit {
    size_t count, refused;     /**< scalars observed, and of these refused */
    double chi_square;         /**< of residuals over their stated sigma */
    double degrees_of_freedom; /**< redundancy: count less what the fit used up */
    double factor; /**< by which sigmas were multiplied: sqrt(chi_square/degrees_of_freedom), of
                        gyros at rest without the part of the Earth's unknown heading, of all
                        without what stated slow noise leaves; 1 with fewer than 3 degrees of
                        freedom */
    double rms;    /**< of the residuals [rad/s], [m/s^2], [rad] */
} imk_group_fit;

/** The solution. About 95 kB. */
typedef struct imk_calibration_result {
    imk_model model; /**< values, sigmas, correlation, evidence.frame */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double value[IMK_CORRELATED_MAX], sigma[IMK_CORRELATED_MAX];
    double freedom[IMK_CORRELATED_MAX]; /**< degrees of freedom of sigma: intervals are Student's;
                                             infinite where no factor was estimated */
    double covariance[IMK_CORRELATED_MAX * IMK_CORRELATED_MAX]; /**< parameter_count^2, row-major */
    imk_group_fit group[IMK_GROUPS];
    double chi_square, degrees_of_freedom; /**< of all, by the stated sigmas */
    size_t observations_refused, turns_refused;
    double fixture[IMK_FIXTURES_MAX][3]; /**< mounting found [rad] */
    int iterations;
    double weakest; /**< how well the worst determined combination is known, against the best: its
                         ratio of sigmas in units of the parameters' own sigmas [1]; large: two
                         parameters are told apart by the noise only */
    int weakest_parameter[2]; /**< the pair correlated most, indices; -1: none above 0.9 */
} imk_calibration_result;

/** Bytes of workspace. */
IMK_API size_t imk_calibration_workspace_size(const imk_calibration *calibration);

/** Solve. Fills the outputs of observations and turns; calibration->model stays the start.
 *  @return IMK_ERROR_SINGULAR (field: name of a parameter that the observations do not determine,
 *          such as accel.misalignment.x.y: nothing moves it, nothing tells it from another, or a
 *          ratio is known to 30 % or worse), IMK_ERROR_TOO_SHORT (field: group; value observations,
 *          limit how many are needed), IMK_ERROR_NO_CONVERGENCE, IMK_ERROR_NOT_FINITE (index: of
 *          the observation), IMK_ERROR_CONFLICT (field "frame": a frame that contradicts the free
 *          parameters), IMK_ERROR_UNIT_MISSING (readings in counts, no sensitivity),
 *          IMK_ERROR_ARGUMENT, _RANGE, _WORKSPACE, _UNINITIALISED, errors of imk_model_validate().
 *          The result is untouched on error: what is not finite or has not converged is never a
 *          result
 */
IMK_API imk_status imk_calibration_solve(imk_calibration *calibration,
                                         imk_calibration_result *result, void *workspace,
                                         size_t workspace_size, imk_error *error);

/** Information that the observations hold about the parameters at the model's values, attitudes and
 *  placements eliminated, by stated sigmas and priors: parameter_count^2, row-major. For planning:
 *  readings are not looked at, only whether they are NaN; with IMK_INPUT_GRAVITY force must be
 *  given. Rows of what a symmetric frame ties to another element are 0. @return errors as of
 *  imk_calibration_solve() but _SINGULAR, and IMK_ERROR_KEY_MISSING ("force") */
IMK_API imk_status imk_calibration_information(const imk_calibration *calibration,
                                               double *information, void *workspace,
                                               size_t workspace_size, imk_error *error);

/** Half width of the interval of parameter `index` for a confidence, such as 0.95. */
IMK_API double imk_calibration_half_width(const imk_calibration_result *result, int index,
                                          double confidence);

/** Turn a model (and, when not NULL, the covariance of `count` of its parameters) from its frame to
 *  another: both triads' responses are multiplied by the rotation that gives the accelerometers'
 *  the wanted form. To first order in the misalignments for the covariance, exact for the values.
 *  Scale factors change to second order. Not to or from IMK_FRAME_REFERENCE.
 *  @param rotation  3x3, row-major: from the old body axes to the new; NULL: not wanted
 *  @return IMK_ERROR_CONFLICT (no triad of accelerometers), IMK_ERROR_SINGULAR */
IMK_API imk_status imk_triad_frame_convert(imk_model *model, imk_triad_frame frame, size_t count,
                                           const imk_model_parameter *parameter, double *covariance,
                                           double *rotation);

/** Compare two calibrations of one unit: b is brought to a's frame. Where a states a convention
 *  (accel_evidence.frame: upper-triangular, lower-triangular, symmetric) b is converted to it; else
 *  b is turned by the small rotation that makes the two agree best.
 *  @param turned      b in a's frame; after an error something in between
 *  @param rotation    3 angles [rad]: what had to be turned; NULL: not wanted
 *  @param difference  for every parameter of a: b less a; NaN where b does not state it
 *  @param sigma       of the difference, from both models' sigmas */
IMK_API imk_status imk_calibration_compare(const imk_model *a, const imk_model *b, size_t count,
                                           const imk_model_parameter *parameter, imk_model *turned,
                                           double rotation[3], double *difference, double *sigma,
                                           imk_error *error);

IMK_END_C
#endif
