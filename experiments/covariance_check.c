/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance against Monte Carlo: are the errors of many full runs those that the linear theory
 * says?
 *
 * usage: covariance_check [runs] [case]
 *
 * For each case and time: the ratio of the standard deviations of the nine errors, runs over
 * theory (its own scatter is 1/sqrt(2 runs)), and of the normalised squares e' P^-1 e, which should
 * be chi-square distributed, the mean over the degrees of freedom, the fraction beyond the 95 % and
 * the 99.9 % point, and the probability of a goodness of fit at least as bad with 20 classes of
 * equal probability. States of which the theory says nothing (the slaved vertical) are left out.
 * Ends with 1 when a ratio is off by more than 5 % plus five times its scatter. */
#include "../tests/car_profile.h"
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES, TIMES_MAX = 4, CLASSES = 20 };

typedef struct study {
    const char *name, *device;
    bool drive, self, compensated, free, all;
    double rate;
    size_t time_count;
    double time[TIMES_MAX];
} study;

/* all: every term at once, see add_the_rest() */
static const study studies[] = {
    {"at rest, attitude given", "navigation", .rate = 1.0, .time_count = 4,
     .time = {60.0, 600.0, 3600.0, 14400.0}},
    {"at rest, self-aligned", "navigation", .self = true, .rate = 1.0, .time_count = 3,
     .time = {60.0, 600.0, 3600.0}},
    {"at rest, self-aligned", "tactical", .self = true, .rate = 10.0, .time_count = 3,
     .time = {10.0, 60.0, 600.0}},
    {"at rest, attitude given, free vertical", "ADIS16465", .free = true, .rate = 100.0,
     .time_count = 3, .time = {1.0, 10.0, 100.0}},
    {"10 min in traffic, self-aligned", "navigation", .drive = true, .self = true, .rate = 100.0,
     .time_count = 3, .time = {60.0, 200.0, 600.0}},
    {"in traffic, compensated, attitude given", "ADIS16465", .drive = true, .compensated = true,
     .rate = 100.0, .time_count = 2, .time = {40.0, 100.0}},
    {"in traffic, every term, compensated", "navigation", .drive = true, .compensated = true,
     .all = true, .rate = 100.0, .time_count = 2, .time = {40.0, 200.0}},
    {"at rest, every term, self-aligned", "navigation", .self = true, .compensated = true,
     .all = true, .rate = 20.0, .time_count = 3, .time = {40.0, 200.0, 1200.0}},
};

typedef struct work {
    const imk_model *model;
    const imk_drift_settings *settings;
    size_t runs, size;
    double *errors; /* [run][time][state] */
} work;

static void run_lanes(void *context, size_t item)
{
    const work *w = context;
    const size_t first = item * IMK_DRIFT_LANES;
    const size_t count = w->runs - first < IMK_DRIFT_LANES ? w->runs - first : IMK_DRIFT_LANES;
    void *memory = aligned_alloc(64, (w->size + 63) / 64 * 64);
    imk_error error;
    if (!memory || imk_drift_runs(w->model, w->settings, 1, (uint32_t)first, count,
                                  w->errors + first * w->settings->time_count * STATES, memory,
                                  w->size, &error)) {
        fprintf(stderr, "covariance_check: runs from %zu on failed\n", first);
        exit(2);
    }
    free(memory);
}

/* Uncertain known values: bias, scale factor, misalignment. */
static void make_uncertain(imk_triad *triad, double scale, double turn)
{
    for (int i = 0; i < 3; i++) {
        triad->bias.fixed.sigma[i] = triad->bias.repeatability.value[i];
        triad->scale_factor.fixed.sigma[i] = scale;
        for (int j = 0; j < 3; j++)
            if (j != i)
                triad->misalignment.sigma[i][j] = turn;
    }
}

/* Terms that the devices do not have, each of a size that is seen beside the others. */
static void add_the_rest(imk_model *model)
{
    imk_triad *gyro = &model->gyro, *accel = &model->accel;
    imk_noise *noise[2] = {&gyro->noise, &accel->noise};
    const double small[2] = {1e-7, 1e-4}; /* rad/s, m/s^2 */
    for (int k = 0; k < 2; k++) {
        noise[k]->gauss_markov_count = noise[k]->sinusoid_count = noise[k]->resonance_count = 1;
        for (int i = 0; i < 3; i++) {
            noise[k]->quantization.value[i] = small[k] * 1.0;
            noise[k]->random_walk.value[i] = small[k] * 0.03;
            noise[k]->ramp.sigma[i] = small[k] * 3e-3;
            noise[k]->gauss_markov[0].sigma.value[i] = small[k];
            noise[k]->gauss_markov[0].correlation_time.value[i] = 60.0;
            noise[k]->sinusoid[0].amplitude.value[i] = small[k] * 2.0;
            noise[k]->sinusoid[0].frequency.value[i] = 0.004;
            noise[k]->resonance[0].sigma.value[i] = small[k] * 30.0;
            noise[k]->resonance[0].frequency.value[i] = 2.0;
            noise[k]->resonance[0].q.value[i] = 5.0;
        }
    }
    for (int i = 0; i < 3; i++) {
        accel->nonlinearity.k2.sigma[i] = 3e-6;
        accel->nonlinearity.k3.sigma[i] = 3e-7;
        gyro->nonlinearity.asymmetry.sigma[i] = 1e-5;
        for (int j = 0; j < 3; j++) {
            gyro->g_sensitivity.sigma[i][j] = 1e-8;
            gyro->g2_sensitivity.sigma[i][j] = 1e-9;
            accel->lever_arm.sigma[i][j] = 0.01;
            accel->nonlinearity.cross_products.sigma[i][j] = 3e-6;
        }
    }
    model->timing.rate_error.sigma = 2e-5;
    model->timing.skew.sigma = 2e-4;
    model->timing.jitter.value = 2e-5;
}

/* ---- comparison ---- */

typedef struct statistics {
    double ratio[STATES];
    size_t degrees;
    double square, beyond95, beyond999, fit;
} statistics;

static statistics compare(const work *w, size_t time, const imk_drift_moments *theory)
{
    const size_t stride = w->settings->time_count * STATES;
    const double *first = w->errors + time * STATES;
    statistics s = {.degrees = 0};
    size_t state[STATES], class[CLASSES] = {0};
    double factor[STATES * STATES];
    for (size_t i = 0; i < STATES; i++) {
        const double variance = theory->covariance[i][i];
        double sum = 0.0;
        for (size_t run = 0; run < w->runs; run++) {
            const double e = first[run * stride + i] - theory->mean[i];
            sum += e * e;
        }
        s.ratio[i] = variance > 0.0 ? sqrt(sum / (double)w->runs / variance) : (double)NAN;
        /* The slaved vertical follows from curvature alone. */
        if (variance > 0.0 && (w->settings->vertical == IMK_VERTICAL_FREE || i % 3 != 2 || i > 5))
            state[s.degrees++] = i;
        else
            s.ratio[i] = (double)NAN;
    }
    const size_t n = s.degrees;
    double scale[STATES];
    for (size_t i = 0; i < n; i++)
        scale[i] = 1.0 / sqrt(theory->covariance[state[i]][state[i]]);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            factor[i * n + j] = theory->covariance[state[i]][state[j]] * scale[i] * scale[j];
    if (imk_cholesky_factor(n, factor)) {
        s.square = s.beyond95 = s.beyond999 = s.fit = (double)NAN;
        return s;
    }
    const double at95 = imk_chi_square_quantile(0.95, (double)n);
    const double at999 = imk_chi_square_quantile(0.999, (double)n);
    for (size_t run = 0; run < w->runs; run++) {
        double e[STATES], x[STATES], square = 0.0;
        for (size_t i = 0; i < n; i++)
            x[i] = e[i] = (first[run * stride + state[i]] - theory->mean[state[i]]) * scale[i];
        imk_cholesky_solve(n, factor, x);
        for (size_t i = 0; i < n; i++)
            square += e[i] * x[i];
        s.square += square / (double)n / (double)w->runs;
        s.beyond95 += (square > at95) / (double)w->runs;
        s.beyond999 += (square > at999) / (double)w->runs;
        const double p = imk_chi_square_probability(square, (double)n) * CLASSES;
        class[p < CLASSES ? (size_t)p : CLASSES - 1]++;
    }
    double fit = 0.0;
    const double due = (double)w->runs / CLASSES;
    for (size_t k = 0; k < CLASSES; k++)
        fit += ((double)class[k] - due) * ((double)class[k] - due) / due;
    s.fit = 1.0 - imk_chi_square_probability(fit, CLASSES - 1.0);
    return s;
}

static bool print(double time, const statistics *s, size_t runs)
{
    bool good = true;
    printf("%8.0f s ", time);
    for (size_t i = 0; i < STATES; i++) {
        if (isnan(s->ratio[i]))
            printf("      -");
        else
            printf(" %6.3f", s->ratio[i]);
        good = good && !(fabs(s->ratio[i] - 1.0) > 0.05 + 5.0 / sqrt(2.0 * (double)runs));
    }
    printf("   %zu: %.3f %.4f %.5f %.3g\n", s->degrees, s->square, s->beyond95, s->beyond999,
           s->fit);
    return good;
}

static bool run_study(const study *of, size_t runs, const imk_trajectory *drive,
                      const imk_executor *executor)
{
    static imk_model model;
    imk_device_model(imk_device_find(of->device), &model);
    const double scale = of->all ? 2e-5 : 1e-3;
    if (of->compensated) {
        make_uncertain(&model.gyro, scale, scale);
        make_uncertain(&model.accel, scale, scale);
    }
    if (of->all)
        add_the_rest(&model);
    imk_drift_settings settings = imk_drift_default();
    settings.attitude_errors = IMK_ATTITUDE_EARTH; /* of displayed_attitude.c are the others */
    settings.motion = of->drive ? drive : NULL;
    settings.rate = of->rate;
    settings.vertical = of->free ? IMK_VERTICAL_FREE : IMK_VERTICAL_SLAVED;
    settings.alignment = of->self ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
    settings.compensated = of->compensated;
    settings.time_count = of->time_count;
    settings.time = of->time;
    for (int i = 0; i < STATES; i++)
        settings.initial_sigma[i] = i < 3 ? 1.0 : (i < 6 ? 0.01 : 1e-4);
    imk_error error;
    if (imk_drift_validate(&model, &settings, &error)) {
        fprintf(stderr, "covariance_check: %s: %s\n", error.field, error.expected);
        return false;
    }
    const size_t size = imk_drift_covariance_size(&model, &settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_drift_analysis *analysis;
    work w = {&model, &settings, runs, imk_drift_runs_workspace_size(&model, &settings),
              malloc(runs * of->time_count * STATES * sizeof(double))};
    if (!memory || !w.errors ||
        imk_drift_covariance(&model, &settings, executor, &analysis, memory, size, &error)) {
        fprintf(stderr, "covariance_check: no covariance for %s\n", of->name);
        return false;
    }
    imk_execute(executor, (runs + IMK_DRIFT_LANES - 1) / IMK_DRIFT_LANES, run_lanes, &w);
    printf("\n%s, %s, %g Hz\n%10s  %6s %6s %6s %6s %6s %6s %6s %6s %6s   %s\n", of->name,
           of->device, of->rate, "", "r N", "r E", "r D", "v N", "v E", "v D", "a N", "a E", "a D",
           "squares/dof, > 95 %, > 99.9 %, fit");
    bool good = true;
    for (size_t i = 0; i < of->time_count; i++) {
        const statistics s = compare(&w, i, &analysis->total[i]);
        good = print(of->time[i], &s, runs) && good;
    }
    fflush(stdout);
    free(memory);
    free(w.errors);
    return good;
}

int main(int argc, char **argv)
{
    const size_t runs = argc > 1 ? strtoul(argv[1], NULL, 10) : 10000;
    const size_t only = argc > 2 ? strtoul(argv[2], NULL, 10) : 0; /* from 1 */
    static imk_motion_script script;
    static imk_motion_step step[CAR_PROFILE_STEPS];
    imk_trajectory drive;
    size_t pieces = 0;
    car_profile(&script, step);
    if (runs < 2 || imk_motion_script_pieces(&script, &pieces, NULL))
        return 2;
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    if (!piece || imk_motion_script_compile(&script, piece, pieces, &drive, NULL))
        return 2;
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    bool good = true;
    printf("%zu runs\n", runs);
    for (size_t i = 0; i < sizeof studies / sizeof *studies; i++)
        if (only == 0 || only == i + 1)
            good = run_study(&studies[i], runs, &drive, &executor) && good;
    imk_thread_pool_destroy(pool);
    free(piece);
    return good ? 0 : 1;
}
