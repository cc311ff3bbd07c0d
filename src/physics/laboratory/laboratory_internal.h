/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the laboratory. An experiment is a table of inputs and a linear law for its
 * readings, done in several power cycles; how the lengths are chosen stands in laboratory.h. */
#ifndef IMUKI_LABORATORY_INTERNAL_H
#define IMUKI_LABORATORY_INTERNAL_H

#include "imukit/distort.h"
#include "imukit/laboratory.h"

#define IMKI_PI 3.14159265358979323846

enum {
    IMKI_TRIALS = IMK_LABORATORY_POINTS_MAX,
    IMKI_COEFFICIENTS = 10,
    IMKI_STATES = IMK_LABORATORY_POINTS_MAX /* simulations that run side by side */

};

/* One run of the instrument with a constant input along x, and whatever else its exposure has. */
typedef struct imki_trial {
    imk_exposure exposure;
    double input; /* along x [rad/s or m/s^2] */
} imki_trial;

/* One coefficient of the law of an experiment: a figure times `unit`. */
typedef struct imki_column {
    const char *key; /* NULL: no figure, only a part of the law */
    double unit;
    double *value, *sigma; /* of the model that is measured */
} imki_column;

/* y = offset + A x: rows are trials, columns coefficients. */
typedef struct imki_experiment {
    const char *stage, *limit;  /* what the law leaves out: "higher orders of the input" */
    size_t rows, columns, rest; /* rest: the row without input */
    bool ramps, quick, repeats; /* repeats: its figures differ from run to run */
    double dwell;               /* averaging time of a reading [s] */
    imki_trial trial[IMKI_TRIALS];
    double offset[IMKI_TRIALS];
    double a[IMKI_TRIALS * IMKI_COEFFICIENTS];
    imki_column column[IMKI_COEFFICIENTS];
    /* result */
    size_t cycles;
    double seconds;
    double mean[IMKI_TRIALS], spread[IMKI_TRIALS];    /* readings, and 1 sigma of their means */
    double change[IMKI_TRIALS], scatter[IMKI_TRIALS]; /* the same less the reading of `rest` */
    double x[IMKI_COEFFICIENTS], sigma[IMKI_COEFFICIENTS];
    double gain[IMKI_COEFFICIENTS]; /* sigma of a coefficient, of that of a reading */
} imki_experiment;

/* All that the experiments share. */
typedef struct imki_bench {
    const imk_laboratory *laboratory;
    const imk_executor *executor;
    imk_laboratory_result *result;
    imk_triad *triad; /* of result->model */
    imk_laboratory_figure computed[IMK_LABORATORY_FIGURES_MAX];
    double bias,
        scale; /* what a reading changes from run to run: without input, and in its scale */
    double pendulous_axis[3], bandwidth; /* that reduce states */
    double white;                        /* N that reduce states */
    double rounding;                     /* 1 sigma of the rounding of the integral [unit s] */
    bool ranged;                         /* reduce states a range */
    double settle;                       /* [s] */
    imk_level slow;                      /* level of long simulations */
    double longest[2];                   /* [s], at the level of the laboratory and the slow one */
    bool cancelled;
    imki_experiment experiment; /* the one in hand */
    char *states;
    size_t samples; /* of the static record at most */
    double *record;
    void *identification;
} imki_bench;

/* laboratory.c: simulated time that an experiment at this sample rate may take [s]: of the
 * settings, or what is computed in about 4 s, 6 s where it is at the slow level. It depends on no
 * clock, so the results are the same on every machine. */
double imki_longest(const imki_bench *bench, double rate, bool quick);

/* laboratory_trials.c */
size_t imki_state_size(const imk_laboratory *laboratory);
/* Whole samples of this time, rounded up, at least one. */
size_t imki_samples_in(double time, double rate);
/* A trial with this input along x added to the surroundings. */
imki_trial imki_trial_of(const imk_laboratory *laboratory, double input);
/* Settings of power cycle `cycle`. */
imk_physics_settings imki_cycle(const imki_bench *bench, size_t cycle, bool quick);
/* Readings y[cycle * rows + row] of the experiment's trials in `cycles` power cycles from `first`,
 * rows * cycles <= IMKI_STATES; NaN where the instrument refuses. */
void imki_readings(imki_bench *bench, size_t first, size_t cycles, double *y);
/* Time after which a step of the input no longer shows [s]: of the settings, or from a pilot. */
double imki_settling_time(imki_bench *bench);
/* Simulated time of a trial [s]. */
double imki_trial_time(const imki_bench *bench);
/* Tell of progress; @return false when the caller gives up. */
bool imki_progress(imki_bench *bench, const char *stage, uint64_t done, uint64_t total);

/* laboratory_experiment.c */
/* Least squares y = A x with equal weights. sigma: from the residuals, 0 where there are as many
 * rows as columns. @return false when the columns are dependent */
bool imki_fit(size_t rows, size_t columns, const double *a, const double *y, double *x,
              double *sigma);
/* Empty experiment of the bench. */
imki_experiment *imki_experiment_begin(imki_bench *bench, const char *stage);
void imki_experiment_column(imki_experiment *experiment, const char *key, double unit,
                            double *value, double *sigma);
/* Readings, fit, and their figures into the model. */
void imki_experiment_run(imki_bench *bench);
/* What a row would read by the closed forms, less what the row at rest would. */
double imki_experiment_computed(const imki_bench *bench, size_t row);

/* laboratory_matters.c */
/* The place of a figure; every key is there. */
size_t imki_figure_of(const imki_bench *bench, const char *key);
/* Fill bench->computed, result->matters; of the reduced model. */
void imki_matters(imki_bench *bench, const imk_model *reduced);
/* sigma that an experiment aims for, in parts of what matters. */
#define IMKI_WANTED 0.06

/* laboratory_table.c, laboratory_chamber.c */
void imki_power_cycles(imki_bench *bench);
void imki_rate_table(imki_bench *bench);
void imki_cross_rates(imki_bench *bench);
void imki_tumble(imki_bench *bench);
void imki_chamber(imki_bench *bench);
/* laboratory_threshold.c */
void imki_threshold(imki_bench *bench);
/* laboratory_shaker.c */
void imki_shaker(imki_bench *bench);
/* laboratory_record.c */
size_t imki_record_samples(const imk_laboratory *laboratory);
void imki_record(imki_bench *bench);

#endif
