/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibration_plan.h
 *  Planning of bench tests: which programme reaches a required uncertainty, and, during the test,
 *  which pose would help most.
 *
 *  A procedure offers steps: poses, rates, forces, temperatures. The information that a step gives
 *  about all parameters (imk_calibration_information()) follows from the noise of the model: the
 *  variance of a mean over a time T is the Allan variance of the noise terms at T,
 *
 *      sigma^2(T) = N^2/T + (2 ln 2/pi) B^2 + K^2 T/3 + 2 Q^2/T^2 + …
 *
 *  Steps are chosen one by one, each the one that adds most: first to the determinant of the
 *  information (D-optimal), then to the requirements. Then the time of the steps is chosen as short
 *  as the requirements allow; if no time is enough, steps are added. Requirements that no programme
 *  reaches are marked, with the attainable uncertainty. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_CALIBRATION_PLAN_H
#define IMUKIT_CALIBRATION_PLAN_H

#include "imukit/motion_script.h"
#include "imukit/procedure.h"

IMK_BEGIN_C

/** A required uncertainty of one parameter. */
typedef struct imk_sigma_requirement {
    imk_model_parameter parameter;
    double sigma; /**< required 1 sigma [unit of the parameter], > 0 */
    /* Filled by imk_plan_make(): */
    double expected; /**< 1 sigma that the programme reaches, including the part of `lasting`; NaN:
                        not determined */
    double floor;    /**< part of it that no programme can lower: see `lasting` */
    bool reached;
} imk_sigma_requirement;

/** Settings of a plan. Start from imk_plan_default(procedure), then change fields. */
typedef struct imk_plan_settings {
    uint32_t cookie;
    imk_procedure procedure;
    /** Number of requirements; 0: the programme is the shortest that determines all parameters. */
    size_t requirement_count;
    imk_sigma_requirement *requirement; /**< the caller's */
    double rate;  /**< sampling rate [Hz]; default 100, thermal 10 as it takes hours */
    bool lasting; /**< true: requirements hold for use after the test, so they include the model's
                     bias instability (its Allan floor) and repeatability, which no test lowers.
                     false: they hold for the test's own figures. Default true */
    double hold_minimum, hold_maximum; /**< measuring time of a step [s]; default 2, 120 */
    double margin; /**< additional time of each hold, for detection and settling [s]; default 2 */
    double turn_time; /**< time from pose to pose [s]; default 2, longer if the range of the gyros
                         requires it */
    double soak;      /**< thermal: waiting time at each temperature until the unit has settled [s];
                         default 600, some time constants of a unit without a heat sink */
    size_t steps_minimum; /**< 0 (default): as many as the procedure needs to show misfits, too */
    size_t steps_maximum; /**< default 120 */
    double placement_sigma, fixture_sigma; /**< as in imk_procedure_settings [rad] */
    double turn_angle;  /**< ferraris: angle of each turn, with sign [rad]; default 2 pi */
    double rate_limit;  /**< highest rate of the table [rad/s]; 0 (default): nine tenths of the
                             range of the gyros, 3 rad/s where none is stated */
    double force_limit; /**< highest force of the centrifuge [m/s^2]; 0 (default): nine tenths of
                             the range of the accelerometers, 10 g where none is stated */
    double temperature_minimum, temperature_maximum; /**< [K]; default 253.15, 343.15 */
    int temperature_order;                           /**< order for the bias; default 3 */
    bool nonlinear, cross_products, g_sensitivity;   /**< as in imk_procedure_settings */
} imk_plan_settings;
/** Default settings of a procedure, as stated above. */
IMK_API imk_plan_settings imk_plan_default(imk_procedure procedure);

typedef enum imk_plan_action {
    IMK_PLAN_HOLD = 0, /**< at rest in a pose */
    IMK_PLAN_RATE,     /**< in a pose, turning about body axis `axis`, which is vertical */
    IMK_PLAN_FORCE,    /**< on a centrifuge */
    IMK_PLAN_SOAK      /**< at rest in a pose at a temperature */
} imk_plan_action;

/** One step of the programme. */
typedef struct imk_plan_step {
    imk_plan_action action;
    double angle[3];    /**< roll, pitch, yaw of the pose [rad] */
    int axis;           /**< of the rate */
    double rate;        /**< [rad/s] */
    double force[3];    /**< specific force, body axes [m/s^2] */
    double temperature; /**< [K]; NaN: any */
    double duration; /**< measuring time [s]; for a turn of a Ferraris session: time of the turn */
} imk_plan_step;

/** The programme as a whole. */
typedef struct imk_plan_result {
    size_t step_count;
    double duration; /**< whole time, with turns, margins and soaks, but without the time in which a
                        chamber changes its temperature [s] */
    double hold;     /**< measuring time of each step [s] */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double sigma[IMK_CORRELATED_MAX]; /**< 1 sigma that the calibration would state; NaN: not
                                         determined */
    size_t reached;                   /**< number of requirements reached */
} imk_plan_result;

/** Bytes of workspace. @param calibration  as for imk_plan_make(); free room after its observations
 *  is used as scratch */
IMK_API size_t imk_plan_workspace_size(imk_calibration *calibration,
                                       const imk_plan_settings *settings);

/** Plan a programme. A requirement that is not reached is no error.
 *  @param calibration  gives the model with its noise, frame, gravity, latitude and priors;
 *                      existing observations count. It needs room for steps_maximum more
 *                      observations and turns, as scratch; it is unchanged afterwards. Its free
 *                      parameters are planned for (requirements must be among them); if it has
 *                      none, those of the procedure
 *  @param step         receives the steps; room for settings->steps_maximum
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (settings, field), _WORKSPACE (also for too little room
 *          for observations or turns), _KEY_MISSING (a requirement for a parameter that the
 *          procedure does not estimate; or "noise": the model states none), errors of
 *          imk_calibration_information() */
IMK_API imk_status imk_plan_make(imk_calibration *calibration, const imk_plan_settings *settings,
                                 imk_plan_step *step, imk_plan_result *result, void *workspace,
                                 size_t workspace_size, imk_error *error);

/** Number of motion steps that imk_plan_script() may need. */
IMK_API size_t imk_plan_script_steps(size_t step_count);
/** Make a motion script of a programme: turns to each pose, and holds with margins. The script
 *  points to `motion_step`, an array of imk_plan_script_steps() steps; place and other settings are
 *  those of imk_motion_script_default().
 *  @return IMK_ERROR_UNSUPPORTED: a centrifuge is no motion of this kind */
IMK_API imk_status imk_plan_script(const imk_plan_settings *settings, size_t step_count,
                                   const imk_plan_step *step, imk_motion_step *motion_step,
                                   imk_motion_script *script, imk_error *error);

/** A recommended further pose. */
typedef struct imk_pose_advice {
    double up[3];       /**< direction of the specific force, body axes, unit */
    double roll, pitch; /**< a pose with this direction [rad] */
    double gain;  /**< gain of information: half the logarithm of the ratio of determinants [nat] */
    int improved; /**< index of the parameter that gains most; -1: none is free */
    double ratio; /**< its sigma afterwards over its sigma before; 0: not determined before */
} imk_pose_advice;

/** Bytes of workspace. */
IMK_API size_t imk_next_pose_workspace_size(const imk_calibration *calibration);
/** Find the best `count` further poses at rest, given the existing observations. Each is the best
 *  after those before it.
 *  @param sigma  1 sigma of the mean of an accelerometer in such a pose [m/s^2]; 0: the median of
 *                the existing observations, or 1e-3. For gyros that of the existing observations */
IMK_API imk_status imk_next_pose(const imk_calibration *calibration, double sigma, size_t count,
                                 imk_pose_advice *advice, void *workspace, size_t workspace_size,
                                 imk_error *error);

IMK_END_C
#endif
