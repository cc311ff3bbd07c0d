/* SPDX-License-Identifier: Apache-2.0 */
/** @file calibration_plan.h
 *  Which bench test reaches a wanted uncertainty, before it is done; and which pose would help most
 *  while it is done.
 *
 *  A procedure offers steps: poses, rates, forces, temperatures. What a step would tell about all
 *  parameters is its information (imk_calibration_information()), by the noise of the model: the
 *  mean over a time T of an axis is known to the Allan variance at T of its noise terms,
 *
 *      sigma^2(T) = N^2/T + (2 ln 2/pi) B^2 + K^2 T/3 + 2 Q^2/T^2 + …
 *
 *  Steps are taken one by one, each the one that adds most: first to the determinant of the
 *  information (D-optimal), then to what is required. Then the time of a step is chosen, as short
 *  as the requirements allow; where no time is enough, steps are added. Requirements that no
 *  programme reaches are said to be so, with what is attainable. Method:
 *  docs/theory/calibration.md. */
#ifndef IMUKIT_CALIBRATION_PLAN_H
#define IMUKIT_CALIBRATION_PLAN_H

#include "imukit/motion_script.h"
#include "imukit/procedure.h"

IMK_BEGIN_C

/** A wanted uncertainty. */
typedef struct imk_sigma_requirement {
    imk_model_parameter parameter;
    double sigma; /**< wanted, 1 sigma [unit of the parameter], > 0 */
    /* Filled by imk_plan_make(): */
    double expected; /**< 1 sigma of the programme, what does not last included; NaN: not
                          determined */
    double floor;    /**< of it what no programme can lower: see `lasting` */
    bool reached;
} imk_sigma_requirement;

/** What to plan. Start from imk_plan_default(procedure), then change fields. */
typedef struct imk_plan_settings {
    uint32_t cookie;
    imk_procedure procedure;
    /** 0: none; the programme is the shortest that determines everything */
    size_t requirement_count;
    imk_sigma_requirement *requirement; /**< the caller's */
    double rate;                        /**< of samples [Hz]; 100, thermal 10: it takes hours */
    bool lasting; /**< requirements are about what stays true after the test: the bias instability
                       (its Allan floor) and the repeatability of the model, which no test
                       lowers, count. false: about the test's own figures. Default true */
    double hold_minimum, hold_maximum; /**< time of a step that is measured [s]; 2, 120 */
    double margin;        /**< held longer, for detection and settling [s]; default 2 */
    double turn_time;     /**< from pose to pose [s]; 2, longer where the range of the gyros needs
                               it */
    double soak;          /**< thermal: held at each temperature before it is measured, until the
                               unit has settled [s]; 600, some time constants of a unit without
                               its own heat sink */
    size_t steps_minimum; /**< 0 (default): what the procedure needs to show misfits too */
    size_t steps_maximum; /**< 120 */
    double placement_sigma, fixture_sigma; /**< as in imk_procedure_settings [rad] */
    double turn_angle;  /**< ferraris: of each turn, with sign [rad]; default 2 pi */
    double rate_limit;  /**< highest rate of the table [rad/s]; 0 (default): nine tenths of the
                             range of the gyros, 3 rad/s where none is stated */
    double force_limit; /**< highest force of the centrifuge [m/s^2]; 0 (default): nine tenths of
                             the range of the accelerometers, 10 g where none is stated */
    double temperature_minimum, temperature_maximum; /**< [K]; 253.15, 343.15 */
    int temperature_order;                           /**< of the bias; default 3 */
    bool nonlinear, cross_products, g_sensitivity;   /**< as in imk_procedure_settings */
} imk_plan_settings;
/** Defaults of a procedure, the values above. */
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
    double duration;    /**< measured [s]; a turn of a Ferraris session: how long it takes */
} imk_plan_step;

/** The programme as a whole. */
typedef struct imk_plan_result {
    size_t step_count;
    double duration; /**< turns, margins and soaks included, but not what a chamber takes from one
                          temperature to the next [s] */
    double hold;     /**< measured time of each step [s] */
    size_t parameter_count;
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    double sigma[IMK_CORRELATED_MAX]; /**< that the calibration would state; NaN: not determined */
    size_t reached;                   /**< requirements */
} imk_plan_result;

/** Bytes of workspace. @param calibration  as for imk_plan_make(); room behind its observations is
 *  scratch */
IMK_API size_t imk_plan_workspace_size(imk_calibration *calibration,
                                       const imk_plan_settings *settings);

/** Plan.
 *  @param calibration  gives the model with its noise, frame, gravity, latitude and priors; what is
 *                      observed already counts. Its room for observations and turns, as many as
 *                      steps_maximum, is scratch; it is left as it was. When it has free parameters
 *                      they are kept (requirements must be among them), else the procedure's are
 *                      made free
 *  @param step         settings->steps_maximum of them
 *  @return IMK_ERROR_UNINITIALISED, _RANGE (settings, field), _WORKSPACE (also: room for
 *          observations or turns), _KEY_MISSING (a requirement for a parameter that the procedure
 *          does not estimate; or "noise": the model states none), errors of
 *          imk_calibration_information().
 *          A requirement that is not reached is no error */
IMK_API imk_status imk_plan_make(imk_calibration *calibration, const imk_plan_settings *settings,
                                 imk_plan_step *step, imk_plan_result *result, void *workspace,
                                 size_t workspace_size, imk_error *error);

/** Steps that imk_plan_script() may need. */
IMK_API size_t imk_plan_script_steps(size_t step_count);
/** The programme as a motion: turned to each pose, margins included. The script points to
 *  `motion_step`, imk_plan_script_steps() of them; its place and so on are those of
 *  imk_motion_script_default().
 *  @return IMK_ERROR_UNSUPPORTED: a centrifuge is no motion of this kind */
IMK_API imk_status imk_plan_script(const imk_plan_settings *settings, size_t step_count,
                                   const imk_plan_step *step, imk_motion_step *motion_step,
                                   imk_motion_script *script, imk_error *error);

/** A pose that would help. */
typedef struct imk_pose_advice {
    double up[3];       /**< direction of the specific force, body axes, unit */
    double roll, pitch; /**< such a pose [rad] */
    double gain;        /**< of information: half the logarithm of the ratio of determinants
                             [nat] */
    int improved;       /**< index of the parameter that gains most; -1: none is free */
    double ratio;       /**< its sigma after over that before; 0: not determined before */
} imk_pose_advice;

/** Bytes of workspace. */
IMK_API size_t imk_next_pose_workspace_size(const imk_calibration *calibration);
/** The best further poses at rest, given what is observed: each of `count` the best after those
 *  before it.
 *  @param sigma  of the mean of an accelerometer in such a pose [m/s^2] (gyros: of the observations
 *                there are); 0: the median of those observed, or 1e-3 */
IMK_API imk_status imk_next_pose(const imk_calibration *calibration, double sigma, size_t count,
                                 imk_pose_advice *advice, void *workspace, size_t workspace_size,
                                 imk_error *error);

IMK_END_C
#endif
