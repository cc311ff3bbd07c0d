/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit tune` is made of: its options, and the motions. */
#ifndef IMUKIT_TUNE_PARTS_H
#define IMUKIT_TUNE_PARTS_H

#include "shell/term_selection.h"

#include "imukit/model_unstated.h"
#include "imukit/motion_file.h"
#include "imukit/parameter_file.h"
#include "imukit/tune_model.h"

enum { TUNE_OPERANDS = 1 + IMK_TUNING_MOTIONS_MAX };

typedef struct tune_options {
    double rate, from, to, bias[2], bias_time, correlation_time, latitude, height, frame_rate;
    option_integer windows, runs, seed, threads;
    int answer, format, assume_class; /* in the order of the choices */
    bool learned, compensated, per_axis, json;
    const char *output, *plot, *report;
    term_selection terms;
} tune_options;

typedef struct tune_work {
    const tune_options *o;
    const char *name[TUNE_OPERANDS + 1]; /* the model, then motions */
    imk_model *model;
    imk_unstated unstated, assumed;
    imk_motion_file *motion[IMK_TUNING_MOTIONS_MAX];
    imk_tune_model_settings settings;
    imk_tune_model *r;
} tune_work;

/* ---- tune_scene.c ---- */

/* Motions and settings. @return -1 or the exit code, the message printed; tune_scene_free() either
 * way */
int tune_scene_open(tune_work *w);
void tune_scene_free(tune_work *w);
/* The message of an error: it names the model, or the motion. @return the exit code */
int tune_refuse(const tune_work *w, const imk_error *error);

#endif
