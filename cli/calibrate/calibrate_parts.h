/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit calibrate: what was asked, the logs, the problem and its solution, and how it is
 * shown. */
#ifndef IMUKIT_CALIBRATE_PARTS_H
#define IMUKIT_CALIBRATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"

#include "imukit/earth.h"
#include "imukit/model_file.h"
#include "imukit/motion_file.h"
#include "imukit/show.h"

typedef struct calibrate_options {
    log_input log;
    const char *procedure, *position, *estimate, *with, *without;
    const char *sensitivity[2], *zero_offset[2]; /* gyro, accel */
    const char *section, *motion, *motion_offset, *want;
    const char *model, *into, *name, *output, *plot, *report;
    /* NaN: not given. */
    double gravity, placement, mounting, turn_angle, initial_rest, window, minimum, trim, settle;
    double reference_temperature, soak;
    option_integer temperature_order;
    int frame, table_axis; /* -1: not given */
    int robust;            /* 0 yes, 1 no */
    int estimator;         /* 0 maximum likelihood, 1 closed form */
    bool no_earth, plan, anyway, poses, json, strict;
} calibrate_options;

typedef imk_calibrate_record session_log;
#define session_log_free imk_calibrate_record_free

typedef struct session {
    const calibrate_options *options;
    imk_calibrate_log *found;
    imk_geodetic place;
    imk_motion_file *motion;
    imk_document *document; /* of --into */
    imk_model before;       /* known before */
} session;

static const char *const sensor_keys[2] = {"gyro", "accel"};
static const char *const sensor_titles[2] = {"gyro", "accelerometer"};

/* All return -1 or the exit code, the message printed, where nothing else is said. */

/* calibrate_input.c: a log with its columns as a record. */
int session_load(session *b, session_log *log);
/* calibrate_reference.c: what the unit was exposed to, from columns or from --motion. */
int session_reference(session *b, session_log *log);

/* calibrate_problem.c: the options as a problem, and the logs loaded. */
int session_choose(session *b); /* procedures, place and frame */
int session_known_before(session *b);
int session_prepare(session *b);
/* calibrate_terms.c: --estimate and --with, --without. */
int session_free_terms(session *b);
/* Append the numbers that a name means to a list; messages speak of the option. */
int session_list_terms(const session *b, const char *option_name, const char *item, size_t capacity,
                       imk_model_parameter *parameter, size_t *count);
int session_switch_terms(const calibrate_options *o, imk_procedure procedure,
                         imk_procedure_settings *settings);
/* calibrate_runs.c: --procedure repeatability, of models, each the calibration of a run. */
bool session_has_run_models(const session *b);
int session_compare_models(session *b);

/* calibrate_plan.c: --plan, the operand being a model. @return the exit code */
int session_plan(session *b);

/* calibrate_ending.c: warnings, and why the job failed; then the model and what is shown. */
int session_done(const session *b, imk_status status, const imk_error *error);
int session_show(session *b);

#endif
