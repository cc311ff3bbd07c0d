/* SPDX-License-Identifier: Apache-2.0 */
/* What `imukit drift` is made of: its options, the scene (motion and times), models analysed, and
 * what is shown of them. */
#ifndef IMUKIT_DRIFT_PARTS_H
#define IMUKIT_DRIFT_PARTS_H

#include "shell/growing_list.h"
#include "shell/show.h"
#include "shell/term_selection.h"

#include "imukit/campaign.h"
#include "imukit/drift.h"
#include "imukit/motion_file.h"
#include "imukit/readable.h"

typedef struct drift_options {
    double duration, rate, align_time, latitude, height, roll, pitch, yaw;
    option_integer monte_carlo, seed, threads;
    int aligned, vertical; /* in the order of the choices */
    bool compensated, json;
    const char *times, *motion, *initial_position, *initial_velocity, *initial_attitude;
    const char *want, *shard, *output, *plot, *report;
    term_selection terms;
} drift_options;

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

int drift_want_parse(const char *text, drift_wished *want);
/* @return -1 or the exit code, the message printed; drift_scene_free() either way */
int drift_scene_open(const drift_options *o, drift_scene *scene);
void drift_scene_free(drift_scene *scene);

/* ---- drift_analysis.c ---- */

enum { DRIFT_MODELS_MAX = 8 };

/* One line of a budget: a source at one time. */
typedef struct drift_share {
    size_t source;
    double share;                    /* of the variance of what is looked at, 0 … 1 */
    double shift;                    /* size of the mean [SI] */
    imk_drift_figures random, whole; /* of this source alone: without and with its mean */
} drift_share;

/* A model and what its errors grow to; with --compensated one model is two of these. */
typedef struct drift_case {
    const char *name; /* operand */
    char label[120];  /* "tactical, compensated" */
    imk_model *model;
    imk_drift_settings settings;
    void *memory; /* of the analysis */
    imk_drift_analysis *analysis;
    imk_drift_figures *figures; /* at all times */
    /* Position among all times of what the budget is made of: the time that --want asks about, else
     * the last row that is a position still (the first when none is). */
    size_t time;
    size_t share_count; /* sources that have a share or a shift then, the largest share first */
    drift_share *share;
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

/* What budgets are of: the figure that is wanted, or CEP. */
static inline imk_drift_wish drift_looked_at(const drift_result *r)
{
    return r->scene->want.asked ? r->scene->want.figure : IMK_WISH_CEP;
}

static inline const drift_case *drift_last_case(const drift_result *r)
{
    return &r->cases[r->case_count - 1];
}

/* Memory for an analysis, aligned; NULL when there is none. Free with free(). */
void *drift_memory(size_t size);
int drift_analyse(drift_result *result, const imk_executor *executor);
void drift_result_free(drift_result *result);

/* ---- drift_warn.c ---- */

/* Of omitted terms, of errors beyond the linear range, of disagreement with the runs. */
void drift_warn(const drift_result *result);

/* ---- drift_answer.c ---- */

typedef struct drift_candidate {
    const imk_device *device;
    imk_drift_figures figures;
    bool usable;  /* gyros and accelerometers are there, and the analysis worked */
    bool no_bias; /* its source states no run-to-run bias of one of them */
    bool no_memory;
} drift_candidate;

/* Factors from here to 1 are no improvement. */
#define DRIFT_SAME 0.9995

/* What --want asks for. */
typedef struct drift_answer {
    imk_drift_requirement requirement;
    size_t order_count;                  /* of the terms that must become better */
    size_t order[IMK_DRIFT_SOURCES_MAX]; /* the one that needs most first */
    bool alone;                          /* one of them would do alone */
    size_t candidate_count;
    drift_candidate *candidate; /* sorted, the best first */
} drift_answer;

int drift_answer_find(const drift_result *result, const imk_executor *executor,
                      drift_answer *answer);
void drift_answer_free(drift_answer *answer);
/* Does it meet the wish, and is it a grade preset, or none? */
bool drift_would_do(const drift_result *result, const drift_candidate *candidate, bool preset);

/* ---- drift_term_value.c ---- */

/* "gyro.bias.repeatability" -> "1 deg/h" as the model says it, times a factor; nothing when it
 * cannot be told in one quantity. @param model  its JSON as data called "model" */
void drift_term_value(const imk_result *model, const char *source, bool compensated, double factor,
                      growing_list *text);

/* ---- drift_campaign.c ---- */

/* @return -1 or the exit code; fills the Monte Carlo part of the result */
int drift_runs(drift_result *result);
/* Statistics of a results file. @return the exit code */
int drift_results(const drift_options *o, const char *path);

/* ---- drift_parameters.c ---- */

/* Everything the numbers of a campaign depend on, as JSON text from malloc(). */
char *drift_parameters(const drift_scene *scene, const imk_drift_settings *settings,
                       const imk_model *model);

/* ---- drift_csv.c ---- */

int drift_write_csv(const drift_result *result, const char *path);

/* ---- drift_show.c ---- */

enum { DRIFT_FIGURES = 10 };
/* In the order of CSV and JSON. */
double drift_figure(const imk_drift_figures *figures, int index);

/* @param answer  NULL: nothing is wanted */
void drift_show(const drift_result *r, const drift_answer *answer, imk_result *result);
/* Of a file of runs, which has no cases. */
void drift_show_results(const drift_result *r, const imk_campaign_results *file,
                        imk_result *result);

/* ---- drift_tables.c: each behind an empty line ---- */

enum { DRIFT_TIME_TEXT = 80 };
/* "10 min ~", where figures are rough. */
const char *drift_time(double time, imk_drift_validity validity, char text[DRIFT_TIME_TEXT]);

/* Growth of one case, two of one model, or several models. */
void drift_show_growth(const drift_result *r, imk_result *result);
void drift_show_budget(const drift_result *r, const drift_case *one, imk_result *result);
void drift_show_runs(const drift_result *r, imk_result *result);
/* How the runs compare with the covariance. */
void drift_show_ratios(const drift_result *r, imk_result *result);

/* ---- drift_figure.c, drift_show_answer.c ---- */

/* @param shares  with the shares of the terms beside it */
void drift_show_figure(const drift_result *r, bool shares, imk_result *result);
void drift_show_answer(const drift_result *r, const drift_answer *answer, imk_result *result);
void drift_show_answer_data(const drift_result *r, const drift_answer *answer, imk_result *result);

#endif
