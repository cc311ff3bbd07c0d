/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit calibrate: what was asked, the calibration, and how it is shown. */
#ifndef IMUKIT_CALIBRATE_PARTS_H
#define IMUKIT_CALIBRATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"

#include "imukit/model_file.h"
#include "imukit/motion_file.h"
#include "imukit/show.h"

typedef struct calibrate_options {
    log_input log;
    imk_calibrate_log_settings settings; /* what options set as it is */
    const char *procedure, *position, *with, *without;
    const char *sensitivity[2], *zero_offset[2], *range[2]; /* gyro, accel */
    const char *field, *dip;                                /* of the Earth */
    const char *motion, *motion_offset, *want;
    const char *model, *into, *name, *output, *plot, *report;
    double soak; /* NaN: not given */
    option_integer temperature_order;
    int robust;    /* 0 yes, 1 no */
    int estimator; /* 0 maximum likelihood, 1 closed form */
    bool plan, anyway, poses, json, strict;
} calibrate_options;

typedef struct session {
    const calibrate_options *options;
    const char *path[IMK_TEST_RECORDS_MAX];
    size_t count;
    imk_procedure procedure[IMK_TEST_RECORDS_MAX];
    imk_calibrate_log_settings settings;
    imk_calibrate_log *found;
    imk_motion_file *motion;
    imk_model *known;       /* of --model or --into; NULL: not given */
    imk_document *document; /* of --into */
} session;

/* All return -1 or the exit code, the message printed, where nothing else is said. */

/* calibrate_settings.c: the options as settings, and an empty calibration. */
int session_choose(session *b);
/* The message of what imk_calibrate_terms() refused. @return the exit code */
int session_terms_refused(const char *option_name, const imk_error *error);
/* --motion, read where it is not yet, and --motion-offset. */
int session_motion(const calibrate_options *o, const imk_geodetic *place, imk_motion_file **motion,
                   imk_calibrate_log_settings *settings);
/* --model or --into. */
int session_known_before(session *b);

/* calibrate_input.c: a log as a record, with what the unit was exposed to; then all of them. */
int session_read(const calibrate_options *o, const imk_calibrate_log_settings *settings,
                 const char *path, imk_calibrate_record *record);
int session_load(session *b);

/* calibrate_runs.c: --procedure repeatability, of models, each the calibration of a run. */
bool session_has_run_models(const session *b);
int session_compare_models(session *b);

/* calibrate_plan.c: --plan, the operand being a model. @return the exit code */
int session_plan(session *b);

/* calibrate_ending.c: warnings, and why the job failed; then the model and what is shown. */
int session_done(const session *b, imk_status status, const imk_error *error);
int session_show(session *b);

#endif
