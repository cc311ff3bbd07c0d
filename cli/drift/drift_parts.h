/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit drift` is made of: its options, the scene (motion and times), models analysed, and
 * what is shown of them. */
#ifndef IMUKIT_DRIFT_PARTS_H
#define IMUKIT_DRIFT_PARTS_H

#include "shell/command.h"
#include "shell/json_output.h"
#include "shell/term_selection.h"
#include "shell/text_table.h"

#include "imukit/campaign.h"
#include "imukit/drift.h"
#include "imukit/motion_file.h"

typedef struct drift_options {
    double duration, rate, align_time, latitude, height, roll, pitch, yaw;
    option_integer monte_carlo, seed, threads;
    int aligned, vertical; /* in the order of the choices */
    bool compensated, json;
    const char *times, *motion, *initial_position, *initial_velocity, *initial_attitude;
    const char *want, *shard, *output, *plot, *report;
    term_selection terms;
} drift_options;

/* ---- drift_units.c: numbers as a person reads them ---- */

enum { DRIFT_TEXT = 40 };
/* Three digits. Each function returns `text`. */
const char *drift_number(double value, char text[DRIFT_TEXT]);
const char *drift_in_unit(double value, const imk_unit *unit, char text[DRIFT_TEXT]);
/* The readable unit of a figure: "m", "km", "m/s", "arcsec", "arcmin", "deg". */
imk_unit drift_unit_of(imk_drift_wish wish, double value);
const char *drift_figure_text(imk_drift_wish wish, double value, char text[DRIFT_TEXT]);
const char *drift_length(double metres, char text[DRIFT_TEXT]);
const char *drift_angle(double radians, char text[DRIFT_TEXT]);
const char *drift_speed(double metres_per_second, char text[DRIFT_TEXT]);
/* "CEP", "R95", …: of a wish. */
const char *drift_wish_name(imk_drift_wish wish);
/* SI unit of a wish: "m", "m/s", "rad". */
const char *drift_wish_unit(imk_drift_wish wish);

/* ---- drift_scene.c ---- */

/* "CEP 1 nmi @ 1h" */
typedef struct drift_wished {
    bool asked;
    imk_drift_wish figure;
    double goal;   /* SI */
    imk_unit unit; /* of the goal, as it was asked */
    double time;   /* [s] */
} drift_wished;

/* What is navigated, and when to look. */
typedef struct drift_scene {
    imk_drift_settings settings; /* its times are the first `dense` or the `rows` below */
    imk_motion_file *motion;
    drift_wished want;
    size_t time_count; /* of all times, those of the table and those between for curves */
    double *time;
    size_t row_count; /* of the table */
    size_t *row;      /* their positions among all */
} drift_scene;

/* @return -1 or the exit code, the message printed; drift_scene_free() either way */
int drift_scene_open(const drift_options *o, drift_scene *scene);
void drift_scene_free(drift_scene *scene);

/* ---- drift_wish.c ---- */

int drift_want_parse(const char *text, drift_wished *want);

/* ---- drift_analysis.c ---- */

enum { DRIFT_MODELS_MAX = 8 };

/* A model and what its errors grow to; with --compensated one model is two of these. */
typedef struct drift_case {
    const char *name; /* operand */
    char label[120];  /* "tactical, compensated" */
    imk_model *model;
    imk_drift_settings settings;
    void *memory; /* of the analysis */
    imk_drift_analysis *analysis;
    imk_drift_figures *figures; /* at all times */
} drift_case;

typedef struct drift_result {
    const drift_options *options;
    const drift_scene *scene;
    size_t model_count;
    imk_model *model[DRIFT_MODELS_MAX];
    const char *name[DRIFT_MODELS_MAX];
    size_t case_count;
    drift_case cases[DRIFT_MODELS_MAX + 1];
    /* Monte Carlo of the last case: at the times of the table; NULL without. */
    uint64_t run_count;
    imk_drift_figures *found, *low, *high;
    size_t *used;
} drift_result;

/* Memory for an analysis, aligned; NULL when there is none. Free with free(). */
void *drift_memory(size_t size);
int drift_analyse(drift_result *result, const imk_executor *executor);
void drift_result_free(drift_result *result);

/* What a linear answer is worth at one time. */
typedef enum drift_validity { DRIFT_LINEAR, DRIFT_ROUGH, DRIFT_LOST } drift_validity;
drift_validity drift_validity_of(const imk_drift_figures *figures);
/* Position among all times of what a budget is made of: the time that --want asks about, else the
 * last row that is a position still (the first when none is). */
size_t drift_budget_time(const drift_result *result, const drift_case *one);

/* One line of a budget: a source at one time. */
typedef struct drift_share {
    size_t source;
    double share;                    /* of the variance of what is looked at, 0 … 1 */
    double shift;                    /* size of the mean [SI] */
    imk_drift_figures random, whole; /* of this source alone: without and with its mean */
} drift_share;
/* Sources at one time, the largest share first. @param share  room for IMK_DRIFT_SOURCES_MAX
 * @return how many have a share or a shift */
size_t drift_budget(const drift_case *one, size_t time, imk_drift_wish wish, drift_share *share);

/* ---- drift_tables.c ---- */

text_table drift_growth_table(const drift_result *result, const drift_case *one);
text_table drift_before_after_table(const drift_result *result);
text_table drift_comparison_table(const drift_result *result);
text_table drift_budget_table(const drift_case *one, size_t time, imk_drift_wish wish);
text_table drift_shift_table(const drift_case *one, size_t time);
/* "at rest at 45 deg north; attitude true at the start, height held by other means." */
enum { DRIFT_CONDITIONS = 4400 };
void drift_conditions(const drift_result *result, char *text, size_t size);
void drift_print(const drift_result *result);
/* Sentences about omitted terms, about errors beyond the linear range, about disagreement. */
void drift_warn(const drift_result *result);
/* The first cell of a row: its time, with ~ where the figures are rough. */
void drift_set_time(text_table *table, double time, drift_validity validity);
void drift_time_text(double time, char *text, size_t size);
/* Print, behind an empty line, and free. */
void drift_print_table(text_table table);

/* ---- drift_runs_table.c ---- */

text_table drift_runs_table(const drift_result *result);
void drift_print_runs(const drift_result *result);
void drift_warn_of_runs(const drift_result *result);

/* ---- drift_requirement_table.c ---- */

typedef struct drift_candidate {
    const imk_device *device;
    imk_drift_figures figures;
    bool usable;  /* gyros and accelerometers are there, and the analysis worked */
    bool no_bias; /* its source states no run-to-run bias of one of them */
    bool no_memory;
} drift_candidate;

typedef struct drift_answer {
    imk_drift_requirement requirement;
    size_t time;
    size_t candidate_count;
    drift_candidate *candidate; /* sorted, the best first */
} drift_answer;

int drift_answer_find(const drift_result *result, const imk_executor *executor,
                      drift_answer *answer);
void drift_answer_free(drift_answer *answer);
text_table drift_answer_table(const drift_result *result, const drift_answer *answer);
text_table drift_device_table(const drift_result *result, const drift_answer *answer, bool presets);
void drift_answer_print(const drift_result *result, const drift_answer *answer);
/* "gyro.bias.repeatability" -> "1 deg/h" as the model says it, times a factor; "" when it cannot be
 * told in one quantity. */
void drift_term_value(const json_t *model, const char *source, bool compensated, double factor,
                      char *text, size_t size);

/* ---- drift_campaign.c ---- */

/* @return -1 or the exit code; fills the Monte Carlo part of the result */
int drift_runs(drift_result *result);
/* Statistics of a results file. @return the exit code */
int drift_show_results(const drift_options *o, const char *path);

/* ---- drift_parameters.c ---- */

/* Everything the numbers of a campaign depend on, as JSON text from malloc(); NULL on failure, the
 * message printed. */
char *drift_parameters(const drift_scene *scene, const imk_drift_settings *settings,
                       const imk_model *model);

/* ---- drift_output.c, drift_figure.c, drift_report.c ---- */

int drift_write_csv(const drift_result *result, const char *path);
json_t *drift_runs_json(const drift_result *result);
int drift_print_json(const drift_result *result, const drift_answer *answer);
int drift_draw(const drift_result *result, const char *path);
int drift_report(const drift_result *result, const drift_answer *answer, const char *path);

#endif
