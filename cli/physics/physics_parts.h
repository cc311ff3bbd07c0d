/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imukit physics. */
#ifndef IMUKIT_PHYSICS_PARTS_H
#define IMUKIT_PHYSICS_PARTS_H

#include "shell/show.h"

#include "imukit/distort.h"
#include "imukit/physics_log.h"

typedef struct physics_options {
    bool list, show, reduce, sweep, single_axis, no_noise, json;
    const char *rate, *acceleration; /* texts: one number or three */
    double sine;                     /* [Hz]; NaN: none */
    double temperature, temperature_rate, duration, output_rate, step, signal_rate;
    double view_duration, view_rate; /* of --view; NaN: the view's own */
    int level;
    option_integer seed, run, threads;
    const char *output, *signals, *plot, *report, *view, *animate;
} physics_options;

/* An instrument, its design and how to run it. */
typedef struct physics {
    const physics_options *options;
    const char *source; /* the operand: a file or a name */
    imk_design_file file;
    imk_physics_log_settings settings;
    imk_model *model; /* reduced, one axis */
} physics;

/* physics_input.c: what the options say. @return -1 or the exit code */
int physics_input_make(const physics_options *o, imk_physics_input *input);

/* physics_run.c */

/* A started instrument. @return -1 or the exit code; free() the state */
int physics_start(const physics *p, const imk_physics_settings *settings, void **state);
/* Why an instrument could not be started, in its units and with the options' names. */
int physics_refused(const physics *p, imk_error *error);
/* Run for --duration, write the log and the signals, warn. @return -1 or the exit code */
int physics_run_make(const physics *p, imk_physics_log **run);

/* physics_design.c: the list of instruments, one design. */
void physics_show_list(imk_result *result);
void physics_show_overview(const physics *p, imk_result *result);
void physics_show_design(const physics *p, imk_result *result);
void physics_design_data(const physics *p, imk_result *result);
void physics_instrument_data(const imk_instrument *instrument, const char *key, imk_result *result);

/* physics_model.c: the error model and what experiments say of it. */
typedef struct physics_laboratory {
    imk_laboratory_result result;
    size_t count;
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
} physics_laboratory;

int physics_write_model(const physics *p, const imk_model *model, const char *path);
/* Parameters of a model of one axis that are stated; extras such as repeatability included. */
void physics_show_model(const imk_model *model, int sensor, imk_result *result);
void physics_model_data(const imk_model *model, int sensor, imk_result *result);
int physics_laboratory_make(const physics *p, physics_laboratory *laboratory);
void physics_show_laboratory(const physics_laboratory *l, imk_result *result);
void physics_laboratory_data(const physics *p, const physics_laboratory *l, imk_result *result);
/* "" of pure numbers. */
const char *physics_unit_text(const char *unit);

/* physics_figure.c: pictures. */
enum { PHYSICS_LABEL = 128 };

/* A view of the instrument, run as it was asked for. */
typedef struct physics_view {
    imk_view view;
    size_t points;
    double *data; /* x, then each curve, in the units of their labels */
    char x_label[PHYSICS_LABEL], y_label[PHYSICS_LABEL], clock[80];
} physics_view;

/* The outputs of a run against time, and against the input when that is a sine. */
void physics_show_run_figure(const physics *p, const imk_physics_log *run, imk_result *result);
/* Each view that shows something, for a page. */
void physics_show_views(const physics *p, imk_result *result);
/* The view that --view names, or all of them in one figure. @return -1 or the exit code */
int physics_show_view_figure(const physics *p, imk_result *result);
/* @return whether there is something to draw */
bool physics_show_laboratory_figure(const physics *p, const physics_laboratory *l,
                                    imk_result *result);
/* Write a view of one signal against another, in motion. @return -1 or the exit code */
int physics_animate(const physics *p, const char *path);

/* physics_show.c */

/* The name of the design, or what the instrument is. */
const char *physics_name(const physics *p);
/* All there is to show of a run, of the error models (laboratory NULL: not measured), or of the
 * design. @return -1 or the exit code, the message printed */
int physics_show(const physics *p, const imk_physics_log *r, const physics_laboratory *l,
                 imk_result *result);

#endif
