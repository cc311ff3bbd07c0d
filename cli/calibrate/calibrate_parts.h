/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of imukit calibrate: what was asked, the logs, the problem and its solution, and how it is
 * shown. */
#ifndef IMUKIT_CALIBRATE_PARTS_H
#define IMUKIT_CALIBRATE_PARTS_H

#include "log/log_input.h"
#include "shell/show.h"

#include "imukit/earth.h"
#include "imukit/ferraris.h"
#include "imukit/model_file.h"
#include "imukit/motion_file.h"
#include "imukit/procedure.h"
#include "imukit/repeatability.h"
#include "imukit/thermal.h"

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

enum { BENCH_DOUBTS_MAX = 16, BENCH_REFERENCES = 9 };

/* One log. */
typedef struct bench_log {
    const char *path;
    imk_log log; /* owns the columns */
    imk_test_record record;
    size_t dropped; /* rows without a time that increases */
    int *section;
    const char **section_name;
    double *reference;    /* BENCH_REFERENCES columns: rate, force, angular acceleration */
    double motion_offset; /* the log shows at t what the programme says at t less this [s] */
    imk_procedure procedure;
    imk_procedure_settings settings;
    imk_procedure_findings findings;
    imk_static_findings stationary; /* window 0: not looked at */
    size_t interval_count;
    imk_static_interval *interval;
    double *activity; /* per sample; NULL: not asked for */
    size_t doubt_count;
    imk_doubt_finding doubt[BENCH_DOUBTS_MAX];
    imk_thermal_findings *thermal; /* of that procedure */
} bench_log;

/* A sentence of the verdict, worst last. */
typedef enum calibrate_level {
    LEVEL_GOOD = 0,
    LEVEL_NOTE,
    LEVEL_WARNING,
    LEVEL_USELESS
} calibrate_level;
typedef struct calibrate_sentence {
    calibrate_level level;
    char code[40];
    char text[700];
} calibrate_sentence;
enum { CALIBRATE_SENTENCES_MAX = 48 };

typedef struct bench {
    const calibrate_options *options;
    size_t log_count;
    bench_log *log;
    bool repeatability; /* the logs are power cycles, nothing is solved */
    bool place_known;
    imk_geodetic place;
    imk_motion_file *motion;
    imk_document *document; /* of --into */
    bool nominal[2];        /* sensitivities were found, not given */
    imk_calibration *calibration;
    imk_calibration_result *result;
    imk_ferraris *ferraris; /* of --estimator closed-form */
    imk_repeatability_result *runs;
    size_t run_count;
    size_t doubt_count;
    imk_doubt_finding doubt[BENCH_DOUBTS_MAX]; /* of the solution */
    size_t sentence_count;
    calibrate_sentence sentence[CALIBRATE_SENTENCES_MAX];
    imk_model before, model; /* known before; as written */
} bench;

/* All return -1 or the exit code, the message printed, where nothing else is said. */

/* calibrate_input.c: a log with its columns as a record. */
int bench_load(bench *b, bench_log *log);
void bench_log_free(bench_log *log);
/* When a row was taken [s]. */
double bench_time(const imk_test_record *record, size_t row);
/* Rows with a reading or a temperature that is no number. @param first  set when there are some */
size_t bench_rows_missing(const imk_test_record *record, size_t *first);
/* calibrate_reference.c: what the unit was exposed to, from columns or from --motion. */
int bench_reference(bench *b, bench_log *log);

/* calibrate_problem.c: the options as a problem; then each log looked at; then the solution. */
int bench_choose(bench *b); /* procedures, place and frame */
int bench_known_before(bench *b);
int bench_prepare(bench *b);
int bench_observe(bench *b, bench_log *log);
int bench_solve(bench *b);
bool bench_is_known(imk_procedure procedure); /* what the unit is exposed to is known */
/* calibrate_closed_form.c: --estimator closed-form, in the place of the last two. */
int bench_closed_form(bench *b);
/* calibrate_terms.c: --estimate and --with, --without. */
int bench_free_terms(bench *b);
/* Append the numbers that a name means to a list; messages speak of the option. */
int bench_list_terms(const bench *b, const char *option_name, const char *item, size_t capacity,
                     imk_model_parameter *parameter, size_t *count);
int bench_switch_terms(const calibrate_options *o, imk_procedure procedure,
                       imk_procedure_settings *settings);
/* calibrate_runs.c: --procedure repeatability, of logs or of models, each the calibration of a
 * run. */
int bench_compare_runs(bench *b);
bool bench_has_run_models(const bench *b);
int bench_compare_models(bench *b);

/* calibrate_plan.c: --plan, the operand being a model. @return the exit code */
int bench_plan(bench *b);

/* calibrate_advice.c: the poses that would tell most, as a list of angles behind `before`; "" where
 * they are not known. */
void bench_advise(const bench *b, const bench_log *log, const char *before, char *text,
                  size_t size);

/* calibrate_failures.c: why a log could not be used, or the problem not be solved. */
int bench_observe_failed(const bench *b, const bench_log *log, const imk_error *error);
int bench_solve_failed(const bench *b, const imk_error *error);

/* calibrate_doubts.c: doubts as sentences. */
calibrate_sentence doubt_sentence(const bench *b, const bench_log *log,
                                  const imk_doubt_finding *doubt);
/* Is it worth a look in this log? Some are only where holds are looked for. */
bool doubt_matters(const bench_log *log, const imk_doubt_finding *doubt);
/* Take away the doubts whether holds can be found where sections name them: the procedure counts
 * the faces. */
void doubts_of_named_holds(bench_log *log);
/* Sentences on logs and solution; warnings also go to standard error. */
void bench_judge(bench *b);

/* calibrate_model.c: fill b->model; write it to -o. */
void bench_make_model(bench *b);
int bench_write_model(bench *b);

/* calibrate_units.c: words and units in which sensors and parameters are shown and written. Gyros
 * come first. */
extern const char *const sensor_keys[2], *const sensor_titles[2], *const sensor_units[2];
char axis_letter(int axis); /* x, y, z, 3 … 7 */
imk_unit parameter_unit(imk_model_parameter parameter, double magnitude);
/* As in the model file, whatever the size. */
const char *parameter_file_unit(imk_model_parameter parameter);
/* "scale factor", "misalignment towards y": without sensor and axis. */
void parameter_title(imk_model_parameter parameter, char *text, size_t size);
/* Index of a parameter of the solution, or -1. */
int bench_find(const bench *b, imk_model_parameter parameter);

/* calibrate_show.c: all of it as a result. @return is there a figure? */
bool bench_show(const bench *b, imk_result *result);
/* calibrate_words.c */
calibrate_level bench_level(const bench *b);
/* "Good: …", "Usable with care …": the verdict in one sentence. */
void bench_verdict(const bench *b, char *text, size_t size);
/* On frame and gravity, what was left out and what is correlated. */
void bench_show_remarks(const bench *b, imk_result *result);
/* calibrate_tables.c */
void bench_show_parameters(const bench *b, int sensor, imk_result *result);
void bench_show_runs(const bench *b, int sensor, imk_result *result);
void bench_show_thermal(const bench_log *log, int sensor, bool brief, imk_result *result);
void bench_show_fit(const bench *b, imk_result *result);
void bench_show_poses(const bench *b, imk_result *result);
/* calibrate_figure.c. @return is there something to draw? */
bool bench_show_figure(const bench *b, imk_result *result);

#endif
