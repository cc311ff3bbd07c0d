/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imukit physics. */
#ifndef IMUKIT_PHYSICS_PARTS_H
#define IMUKIT_PHYSICS_PARTS_H

#include "shell/command.h"
#include "shell/json_output.h"
#include "shell/text_table.h"

#include "imukit/distort.h"
#include "imukit/laboratory.h"
#include "imukit/report.h"

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
    double *time, *curve[IMK_INSTRUMENT_OUTPUTS_MAX]; /* [s], SI; PHYSICS_CURVE_POINTS + 1 each */
    double *input;                                    /* of output 0's kind */
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
int physics_list(const physics_options *o);
int physics_show(const physics *p);
text_table physics_design_table(const physics *p);
json_t *physics_design_json(const physics *p);
json_t *physics_instrument_json(const imk_instrument *instrument);
int physics_overview(const physics *p);

/* physics_reduce.c: the error model and what experiments say of it. */
typedef struct physics_laboratory {
    imk_laboratory_result result;
    size_t count;
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX], found[IMK_LABORATORY_FIGURES_MAX];
} physics_laboratory;

/* Parameters of a model of one axis that are stated; extras such as repeatability included. */
text_table physics_model_table(const imk_model *model, int sensor);
json_t *physics_model_json(const imk_model *model, int sensor);
int physics_write_model(const physics *p, const imk_model *model, const char *path);
/* physics_sweep.c */
int physics_laboratory_make(const physics *p, physics_laboratory *laboratory);
text_table physics_sweep_table(const physics *p, const physics_laboratory *laboratory);
json_t *physics_sweep_json(const physics *p, const physics_laboratory *laboratory);

/* physics_figure.c: pictures. */
enum { PHYSICS_PANELS_MAX = 16 };
typedef struct physics_figure {
    imk_figure figure;
    imk_panel panel[PHYSICS_PANELS_MAX];
    imk_curve curve[PHYSICS_PANELS_MAX][IMK_VIEW_CURVES_MAX];
    char label[PHYSICS_PANELS_MAX][2][128];
    char name[PHYSICS_PANELS_MAX][IMK_VIEW_CURVES_MAX][56];
    double *memory[PHYSICS_PANELS_MAX];
} physics_figure;

/* The outputs of a run against time, and against the input when that is a sine. */
void physics_figure_of_run(const physics *p, const physics_run *run, physics_figure *figure);
/* A view, with the duration and rate that were asked for. */
imk_view physics_view_as_asked(const physics *p, size_t index);
/* One view of the instrument, or all of them (index SIZE_MAX). @return -1 or the exit code */
int physics_figure_of_view(const physics *p, size_t index, physics_figure *figure);
bool physics_figure_of_laboratory(const physics *p, const physics_laboratory *laboratory,
                                  physics_figure *figure);
/* True when there is nothing of the view to see in this design. */
bool physics_view_is_empty(const imk_view *view, const imk_panel *panel);
void physics_figure_free(physics_figure *figure);
int physics_draw(const imk_figure *figure, const char *path);
/* The view that --view names. @return -1 or the exit code */
int physics_find_view(const physics *p, size_t *index);

/* physics_animation.c: views whose axes are both signals, in motion. */
bool physics_view_can_move(const imk_view *view);
/* The animation of a figure of one such view; clock is room for a text. */
imk_animation physics_animation_of_view(const imk_view *view, const physics_figure *figure,
                                        char *clock, size_t size);
int physics_animate(const physics *p, const char *path);

/* physics_report.c */
int physics_report(const physics *p, const physics_run *run, const physics_laboratory *laboratory,
                   const char *path);

#endif
