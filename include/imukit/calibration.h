/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibration.h
 *  Calibration: deterministic terms of a model, with their covariance, from bench tests. One
 *  estimator serves all procedures and any combination of logs.
 *
 *  A procedure (procedure.h) turns a log into observations and turns. An observation is a mean
 *  reading at an input that is known (rate table, centrifuge), known except for a small placement
 *  error (six faces), or known in magnitude only (any pose under gravity). A turn leads from one
 *  pose to another, and the gyros must carry the vertical along. The solver fits all of them at
 *  once by maximum likelihood. Unknown attitudes, placements and the mounting on the fixture are
 *  further unknowns:
 *
 *      reading = sensitivity * distort(model, rate, force, temperature) + zero offset + noise
 *
 *  Observations and turns that do not fit are refused as a whole. The limit is chosen such that a
 *  set without outliers passes in 99 of 100 calibrations. It is applied to a robust fit, which a
 *  minority of outliers cannot spoil (Huber's weights, then Tukey's biweight). The others have full
 *  weight. The scatter within a hold is not the whole uncertainty of its mean. Therefore 1 sigma
 *  and intervals of each group of observations (readings of gyros, of accelerometers, turns) are
 *  multiplied by a factor from the group's residuals, if these have 3 degrees of freedom or more.
 *
 *  Slow noise is common to the observations of one record, so residuals do not show it. If the
 *  model states slow noise (bias_instability, random_walk, gauss_markov longer than a hold),
 *  sigmas, covariance and intervals include it. The bias estimated is that during the test,
 *  including the mean of its slow noise over the record, and its sigma refers to this value.
 *  Method: docs/theory/calibration.md. */
#ifndef IMUKIT_CALIBRATION_H
#define IMUKIT_CALIBRATION_H

#include "imukit/model_parameter.h"
#include "imukit/test_record.h"

IMK_BEGIN_C

enum {
    IMK_TEST_RECORDS_MAX = 64,
    IMK_FIXTURES_MAX = 8,
    IMK_OFFSETS_MAX = 24 /**< gyros of records that state an offset_sigma, together */
};

/** Convention that fixes the rotation of the triads, which |g| alone does not determine. Both
 *  triads share the body frame. */
typedef enum imk_triad_frame {
    IMK_FRAME_UPPER = 0, /**< response of the accelerometers upper triangular: z senses along body
                              z, y in the plane of y and z */
    IMK_FRAME_LOWER,     /**< lower triangular: x senses along body x, y in the plane of x and y */
    IMK_FRAME_SYMMETRIC, /**< response of the accelerometers symmetric: no axis is preferred */
    IMK_FRAME_REFERENCE  /**< that of the reference: faces of the housing, axes of the table */
} imk_triad_frame;
/** "upper-triangular", "lower-triangular", "symmetric", "reference"; NULL beyond the last. */
IMK_API const char *imk_triad_frame_name(imk_triad_frame frame);

/** What is known about the input of an observation. */
typedef enum imk_input_knowledge {
    IMK_INPUT_KNOWN = 0, /**< rate and force, except for the mounting on the fixture */
    IMK_INPUT_PLACED,    /**< also except for a small rotation, 1 sigma `placement_sigma` about each
                            axis */
    IMK_INPUT_GRAVITY    /**< only that the unit is at rest on Earth: |force| = gravity */
} imk_input_knowledge;

/** Groups of observations, each with its own variance factor. */
typedef enum imk_observation_group {
    IMK_GROUP_GYRO = 0, /**< readings of gyros */
    IMK_GROUP_ACCEL,    /**< readings of accelerometers */
    IMK_GROUP_TURN,     /**< turns between poses */
    IMK_GROUPS
} imk_observation_group;

/** The mean of some samples, and the motion and temperature of the unit. */
typedef struct imk_observation {
    imk_input_knowledge knowledge;
    int record;                      /**< index in imk_calibration.record; -1: none, readings are
                                          SI */
    size_t begin, end;               /**< samples of the record: from begin to before end */
    double reading[2][IMK_AXES_MAX]; /**< mean reading, in the record's unit; NaN: not observed */
    double sigma[2][IMK_AXES_MAX];   /**< of the mean, from the scatter within, > 0 */
    double rate[3], force[3];        /**< nominal input; with IMK_INPUT_GRAVITY force is a first
                                          guess, or zeros, and rate is not used */
    double angular_acceleration[3];  /**< [rad/s^2] */
    double temperature;              /**< [K]; NaN: not known, the polynomials vanish */
    double temperature_rate;         /**< [K/s] */
    double placement_sigma;          /**< [rad] */
    double heading_variance[IMK_AXES_MAX]; /**< of gyros: what the Earth's rate at a heading that is
                           not known adds to the variance of a reading [rad^2/s^2]. No factor
                           multiplies it */
    bool heading_depends; /**< false: the heading is that of this observation alone; true: it may be
                           that of others too, so that heading_variance is a bound and residuals
                           need not show it */
    double offset_sigma;  /**< 1 sigma of what the readings of a gyro in all observations of the
                            record that state it are off by together, as by g-sensitivity in an
                            attitude that is not known [rad/s]; 0: nothing */
    double turn_time; /**< of a turn that begins and ends at stops that are placed [s]: its rate,
                           besides, is off by the placement's angle about it over this time; 0: none
                           */
    int fixture;      /**< index of the fixture whose mounting it shares; -1: none */
    bool correlated;  /**< true: sigma includes slow noise already, and none is added */
    bool relative;    /**< true: the readings are those less the readings at rest, so that the bias
                           and all that does not depend on the rate have no part in them (of counts,
                           plus the zero offset) */
    bool moving;      /**< true: a short block of samples while the input changes. What befalls a
                           hold befalls many of them, or none: their scatter is their own */
    /* Filled by imk_calibration_solve(): */
    double residual[2][IMK_AXES_MAX]; /**< reading less fit [rad/s], [m/s^2]; NaN: not observed */
    double vertical[3]; /**< of an unknown attitude: direction of the specific force, body axes */
    double distance;    /**< root mean square of residual/sigma (variance factors included) */
    double weight;      /**< 1 used in full … 0 refused */
} imk_observation;

/** A turn between two observations at unknown attitudes of one record: the gyros must carry the
 *  vertical of `from` to that of `to`. */
typedef struct imk_turn {
    int from, to;      /**< observations */
    size_t begin, end; /**< samples of the record integrated: from the middle of one hold to the
                          middle of the other, or fewer */
    double sigma;      /**< of the angle about each axis perpendicular to the vertical [rad], > 0 */
    double earth_sigma; /**< part of sigma (root mean square) caused by the Earth's horizontal rate,
                           as the heading is not known [rad]; 0 (none) or more, < sigma */
    /* Filled by imk_calibration_solve(): */
    double residual[2]; /**< about the two axes perpendicular to the vertical [rad] */
    double angle;       /**< angle of the turn [rad] */
    double distance, weight;
} imk_turn;

/** The problem. Start from imk_calibration_default(), then set fields and let procedures add to it.
 *  About 60 kB. */
typedef struct imk_calibration {
    uint32_t cookie;
    imk_model model; /**< prior knowledge: nominal sensitivities, terms not estimated, slow noise;
                        the estimation of free parameters starts from here */
    size_t parameter_count;
    /** The free parameters, which are estimated. */
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double prior_sigma[IMK_CORRELATED_MAX]; /**< prior 1 sigma about the model's value; 0: no prior
                                               knowledge */
    bool prior_guessed[IMK_CORRELATED_MAX]; /**< prior_sigma is what such terms usually have. The
                                               log corrects it: where it leaves 3 degrees of freedom
                                               or more, all such priors are multiplied by the factor
                                               that the estimates show */
    bool hidden[IMK_CORRELATED_MAX];        /**< with a prior: the parameter is part of the others'
                                               uncertainty, but neither reported nor changed */
    imk_triad_frame frame;                  /**< IMK_FRAME_UPPER by default */
    double gravity;                         /**< local gravity [m/s^2] */
    double latitude;   /**< geodetic [rad], for the Earth's rotation; NaN: not known; the sigma of
                          gyro readings at rest then includes the unknown rotation */
    double earth_rate; /**< default 7.292115e-5 rad/s; 0: the references contain no Earth rate, and
                          the gyro bias then includes it */
    bool robust;       /**< refuse outliers; default true */
    bool gyro_coarse; /**< gyros are rounded to steps coarser than their noise: the residuals do not
                         show this error, which is the same in all holds, so sigmas of gyro readings
                         and of turns are at least as stated; default false */
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
/** Make a parameter free, if it is not yet free. One with a guessed prior loses the prior.
 *  @return IMK_ERROR_ARGUMENT (no such parameter), IMK_ERROR_RANGE (IMK_CORRELATED_MAX are already
 *          free) */
IMK_API imk_status imk_calibration_free(imk_calibration *calibration, int sensor, int term,
                                        int axis, int element);
/** Make a parameter free with a guessed prior [SI of the parameter], if it is not yet free.
 *  @param hidden  do not report it
 *  @return errors of imk_calibration_free(); IMK_ERROR_ARGUMENT (sigma not above 0) */
IMK_API imk_status imk_calibration_consider(imk_calibration *calibration,
                                            imk_model_parameter parameter, double sigma,
                                            bool hidden);
/** Add an observation. @return its index, or -1 when the capacity is used up */
IMK_API int imk_calibration_observe(imk_calibration *calibration,
                                    const imk_observation *observation);

/** Fit of one group of observations. */
typedef struct imk_group_fit {
    size_t count, refused;     /**< number of scalar observations, and number of refused ones */
    double chi_square;         /**< of residuals over their stated sigma */
    double degrees_of_freedom; /**< redundancy: count less the unknowns that the group determines */
    double factor; /**< factor by which sigmas were multiplied: sqrt(chi_square/degrees_of_freedom);
                      1 with fewer than 3 degrees of freedom. It leaves out the part of the Earth's
                      rate at unknown heading (gyros at rest) and of stated slow noise */
    double axis_factor[IMK_AXES_MAX]; /**< the sigma used of an axis is sqrt((axis_factor sigma)^2 +
                                         axis_added^2): `factor` and 0, or where the residuals fit
                                         another form better, a factor for each axis, an added part
                                         for all axes, or one for each */
    double axis_added[IMK_AXES_MAX];  /**< [rad/s], [m/s^2] */
    /** Root mean square of the sigmas stated of the readings of an axis [rad/s], [m/s^2]; 0: it has
     *  none. */
    double axis_noise[IMK_AXES_MAX];
    double rms; /**< root mean square of the residuals [rad/s], [m/s^2], [rad] */
} imk_group_fit;

/** The solution. About 95 kB. */
typedef struct imk_calibration_result {
    imk_model model; /**< values, sigmas, correlation, evidence.frame */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double value[IMK_CORRELATED_MAX], sigma[IMK_CORRELATED_MAX];
    double freedom[IMK_CORRELATED_MAX]; /**< degrees of freedom of sigma, for intervals by Student's
                                           t; infinite where no factor was estimated */
    double covariance[IMK_CORRELATED_MAX * IMK_CORRELATED_MAX]; /**< parameter_count^2, row-major */
    imk_group_fit group[IMK_GROUPS];
    imk_group_fit placement; /**< of the placements: chi_square and degrees_of_freedom of their
                                agreement with placement_sigma, factor (1 or more), rms: the 1 sigma
                                of a placement that the log itself shows [rad]; 0 degrees: the log
                                does not test it */
    double turn_chi_square, turn_freedom; /**< the part of `placement` that is of turns
                                             (imk_observation.turn_time) */
    imk_group_fit assumed; /**< the same of parameters whose prior_sigma is guessed; the factor may
                              be below 1 */
    double chi_square, degrees_of_freedom; /**< of all observations, by their stated sigmas */
    size_t observations_refused, turns_refused;
    double fixture[IMK_FIXTURES_MAX][3]; /**< estimated mounting angles [rad] */
    int iterations;
    double weakest; /**< ratio of the sigmas of the worst and the best determined combination of
                       parameters, each in units of its own sigma [1]; large: only noise tells two
                       parameters apart */
    int weakest_parameter[2]; /**< indices of the pair with the largest correlation; -1: none above
                                 0.9 */
} imk_calibration_result;

/** Bytes of workspace. */
IMK_API size_t imk_calibration_workspace_size(const imk_calibration *calibration);

/** Estimate the free parameters. The outputs in observations and turns are filled;
 *  calibration->model is not changed.
 *  @return IMK_ERROR_SINGULAR (field: name of a parameter that the observations do not determine,
 *          such as accel.misalignment.x.y: nothing excites it, it cannot be separated from another,
 *          or a ratio is known to 30 % or worse), IMK_ERROR_TOO_SHORT (field: group; value
 *          observations, limit how many are needed), IMK_ERROR_NO_CONVERGENCE, IMK_ERROR_NOT_FINITE
 *          (index: of the observation), IMK_ERROR_CONFLICT (field "frame": a frame that contradicts
 *          the free parameters), IMK_ERROR_UNIT_MISSING (readings in counts, no sensitivity),
 *          IMK_ERROR_ARGUMENT, _RANGE, _WORKSPACE, _UNINITIALISED, errors of imk_model_validate().
 *          The result is unchanged on error, so it is always finite and converged */
IMK_API imk_status imk_calibration_solve(imk_calibration *calibration,
                                         imk_calibration_result *result, void *workspace,
                                         size_t workspace_size, imk_error *error);

/** Information matrix of the parameters at the model's values, from stated sigmas and priors, with
 *  attitudes and placements eliminated. It serves planning: only whether a reading is NaN is used,
 *  not its value; with IMK_INPUT_GRAVITY force must be given. Rows of parameters that a symmetric
 *  frame ties to others are 0.
 *  @param information  parameter_count^2, row-major
 *  @return errors of imk_calibration_solve() except _SINGULAR; IMK_ERROR_KEY_MISSING ("force") */
IMK_API imk_status imk_calibration_information(const imk_calibration *calibration,
                                               double *information, void *workspace,
                                               size_t workspace_size, imk_error *error);

/** Half width of the interval of parameter `index` for a confidence, such as 0.95. */
IMK_API double imk_calibration_half_width(const imk_calibration_result *result, int index,
                                          double confidence);

/** Probability of placements that scatter as much as these when they are as good as stated: doubt
 *  placement_sigma below 1e-3. A turn and the hold before it may be one placement, so holds and
 *  turns are looked at by themselves: twice the smaller probability, where there are both.
 *  @return NaN with fewer than 1 degree of freedom: the log does not test them */
IMK_API double imk_calibration_placement_probability(const imk_calibration_result *result);

/** Convert a model (and, when not NULL, the covariance of `count` of its parameters) from its frame
 *  to another: the responses of both triads are multiplied by the rotation that gives the response
 *  of the accelerometers the form of the frame. Values are exact, the covariance is to first order
 *  in the misalignments. Scale factors change in second order. Not possible to or from
 *  IMK_FRAME_REFERENCE.
 *  @param rotation  3x3, row-major: from the old body axes to the new; NULL: not wanted
 *  @return IMK_ERROR_CONFLICT (no triad of accelerometers), IMK_ERROR_SINGULAR */
IMK_API imk_status imk_triad_frame_convert(imk_model *model, imk_triad_frame frame, size_t count,
                                           const imk_model_parameter *parameter, double *covariance,
                                           double *rotation);

/** Compare two calibrations of one unit; b is first brought to the frame of a. If a states a
 *  convention (accel_evidence.frame: upper-triangular, lower-triangular, symmetric), b is converted
 *  to it; else b is turned by the small rotation that makes the two agree best.
 *  @param turned      receives b in the frame of a; undefined after an error
 *  @param rotation    receives the 3 angles by which b was turned [rad]; NULL: not wanted
 *  @param difference  for each of the `count` parameters: b less a; NaN where b does not state it
 *  @param sigma       of the difference, from both models' sigmas */
IMK_API imk_status imk_calibration_compare(const imk_model *a, const imk_model *b, size_t count,
                                           const imk_model_parameter *parameter, imk_model *turned,
                                           double rotation[3], double *difference, double *sigma,
                                           imk_error *error);

IMK_END_C
#endif
