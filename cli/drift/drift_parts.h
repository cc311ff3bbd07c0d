/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit drift` is made of: its options, the scene (motion and times), and campaigns. */
#ifndef IMUKIT_DRIFT_PARTS_H
#define IMUKIT_DRIFT_PARTS_H

#include "shell/show.h"
#include "shell/term_selection.h"

#include "imukit/campaign.h"
#include "imukit/drift_models.h"
#include "imukit/motion_file.h"
#include "imukit/readable.h"

typedef struct drift_options {
    double duration, rate, align_time, latitude, height, roll, pitch, yaw;
    double deflection, deflection_distance;
    option_integer monte_carlo, seed, threads;
    int aligned, vertical, attitude_errors, assume_class; /* in the order of the choices */
    bool compensated, json;
    const char *times, *motion, *initial_position, *initial_velocity, *initial_attitude;
    const char *want, *shard, *output, *plot, *report;
    option_texts aid;
    const char *outage, *filter_model;
    int gains;
    term_selection terms;
} drift_options;

/* ---- drift_want.c, drift_scene.c ---- */

/* What is navigated, and when to look. */
typedef struct drift_scene {
    imk_drift_settings settings;
    imk_motion_file *motion;
    imk_drift_wanted want;
    bool want_after; /* its time counts from the start of the outage */
    imk_drift_times times;
    imk_aid aid[IMK_AIDS_MAX];
    imk_model *filter_model; /* NULL: that of the unit */
} drift_scene;

/* @param after  set: the time counts from the start of the outage */
int drift_want_parse(const char *text, imk_drift_wanted *want, bool *after);
/* drift_aids.c: the aids and the model of the filter. @return -1 or the exit code */
int drift_aids_open(const drift_options *o, drift_scene *scene);
/* Times of a list such as "1min, 10 min, 1h". @param name  of the option */
typedef struct drift_stated {
    size_t count;
    double at[IMK_DRIFT_ROWS_MAX];
} drift_stated;
int drift_stated_times(const char *name, const char *text, drift_stated *times);
/* @return -1 or the exit code, the message printed; drift_scene_free() either way */
int drift_scene_open(const drift_options *o, drift_scene *scene);
void drift_scene_free(drift_scene *scene);

/* ---- drift_campaign.c ---- */

/* Monte Carlo of the last case. @return -1 or the exit code */
int drift_runs(const drift_options *o, const drift_scene *scene, imk_drift_models *r);
/* Statistics of a results file. @return the exit code */
int drift_results(const drift_options *o, const char *path);

/* ---- drift_parameters.c ---- */

/* Everything the numbers of a campaign depend on, as JSON text from malloc(). */
char *drift_parameters(const drift_scene *scene, const imk_drift_settings *settings,
                       const imk_model *model);

/* ---- drift_csv.c ---- */

int drift_write_csv(const imk_drift_models *r, const char *path);

#endif
