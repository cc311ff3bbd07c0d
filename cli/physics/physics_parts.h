/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imukit physics. */
#ifndef IMUKIT_PHYSICS_PARTS_H
#define IMUKIT_PHYSICS_PARTS_H

#include "shell/show.h"

#include "imukit/distort.h"
#include "imukit/laboratory.h"

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

/* What the instrument is exposed to, against time. */
typedef struct physics_input {
    imk_exposure exposure; /* angular rate and specific force are the amplitudes of a sine */
    bool is_sine;
    double frequency;        /* [Hz] */
    double temperature_rate; /* [K/s] */
} physics_input;

/* An instrument, its design and how to run it. */
typedef struct physics {
    const physics_options *options;
    const char *source; /* the operand: a file or a name */
    imk_design_file file;
    imk_physics_settings settings;
    physics_input input;
    imk_model *model; /* reduced, one axis */
} physics;

/* physics_input.c: what the options say. @return -1 or the exit code */
int physics_input_make(const physics_options *o, physics_input *input);
/* Exposure of sample `index` at this rate, the mean over it. */
imk_exposure physics_input_at(const physics_input *input, double rate, uint64_t index);

/* physics_run.c */

/* A started instrument. @return -1 or the exit code; free() the state */
int physics_start(const physics *p, const imk_physics_settings *settings, void **state);
/* Why an instrument could not be started, in its units and with the options' names. */
int physics_refused(const physics *p, imk_error *error);

enum { PHYSICS_CURVE_POINTS = 4000 };

/* A run to look at: statistics of the outputs, and means for a picture. */
typedef struct physics_run {
    uint64_t samples, stride; /* samples to a point of the picture */
    double mean[IMK_INSTRUMENT_OUTPUTS_MAX];
    double deviation[IMK_INSTRUMENT_OUTPUTS_MAX]; /* NaN: of one sample */
    double last[IMK_INSTRUMENT_OUTPUTS_MAX]; /* at the end: mean of the last 1 % of the samples */
    size_t points;
    double *time, *curve[IMK_INSTRUMENT_OUTPUTS_MAX]; /* [s], display units;
                                                         PHYSICS_CURVE_POINTS + 1 each */
    double *input;                                    /* in the unit of output 0 */
} physics_run;

/* Run for --duration, write the log and the signals. */
int physics_run_make(const physics *p, physics_run *run);
void physics_run_free(physics_run *run);
/* Unit to show an output in: of the measured input, by its size. */
imk_unit physics_output_unit(const physics *p, const physics_run *run, size_t output);
uint64_t physics_samples(const physics_options *o, double rate);

/* physics_warnings.c: what can be known of a run that went wrong quietly. */
void physics_warn_of_run(const physics *p, const physics_run *run);

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
void physics_show_run_figure(const physics *p, const physics_run *run, imk_result *result);
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
int physics_show(const physics *p, const physics_run *r, const physics_laboratory *l,
                 imk_result *result);

#endif
