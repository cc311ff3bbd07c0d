/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imukit physics. */
#ifndef IMUKIT_PHYSICS_PARTS_H
#define IMUKIT_PHYSICS_PARTS_H

#include "shell/show.h"

#include "imukit/design_file.h"
#include "imukit/show.h"

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

/* All return -1 or the exit code, the message printed. */

/* physics_input.c: what the options say. */
int physics_input_make(const physics_options *o, imk_physics_log_settings *settings);

/* physics_run.c */

/* Why an instrument could not be started, in its units and with the options' names. */
int physics_refused(const physics *p, imk_error *error);
/* Run for --duration, write the log and the signals, warn. */
int physics_run_make(const physics *p, imk_physics_log **run);
int physics_sweep_make(const physics *p, imk_physics_sweep **sweep);

/* physics_views.c */

/* Each view that shows something, for a page. */
void physics_show_views(const physics *p, imk_result *result);
/* The view that --view names, or all of them in one figure. */
int physics_show_view_figure(const physics *p, imk_result *result);
/* Write a view of one signal against another, in motion. */
int physics_animate(const physics *p, const char *path);
/* Does --view ask for the schematic, which is no view of signals? */
bool physics_asks_schematic(const physics_options *o);
/* Write the schematic in motion. */
int physics_draw_schematic(const physics *p, const char *path);

#endif
