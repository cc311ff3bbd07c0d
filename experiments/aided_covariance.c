/* SPDX-License-Identifier: Apache-2.0 */
/* An aided navigator: is its covariance that of many full runs, filter and aids included?
 *
 * usage: aided_covariance [runs] [case]
 *
 * For each case and time: the ratio of the standard deviations of the nine errors, runs over
 * theory. The interval of a ratio is that of a chi-square with as many degrees of freedom as runs,
 * at 99 % for all ratios of the program together (Bonferroni). Where the filter knows the truth,
 * also e' P^-1 e with the filter's own P in every run, at many times: its mean over 50 runs is due
 * to be within its 95 % interval in 92 to 98 % of the sets of runs and times.
 *
 * Ends with 1 when a ratio or a share is outside. */
#include "../tests/car_profile.h"
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES, ALL = IMK_DRIFT_AIDED_STATES, SHOWN = 4, TIMES = 200 };

static const char *const gnss = "position 1 m, velocity 0.05 m/s at 1 Hz until 300 s";

/* known: a model of which the filter knows all; otherwise a device, compensated. */
typedef struct study {
    const char *name, *device;
    bool known, drive, self;
    const char *aid[3];
    const char *filter_aid; /* what the filter believes of the first */
    double shown[SHOWN];
} study;

static const study studies[] = {
    {"at rest, attitude given, white aids", .known = true, .aid = {gnss},
     .shown = {100.0, 300.0, 360.0, 600.0}},
    {"at rest, self-aligned, correlated aids, lever arm", .known = true, .self = true,
     .aid =
         {"position 1 m, velocity 0.05 m/s at 1 Hz until 300 s correlated 60 s, lever arm 1 2 -1 "
          "± 0.1 m"},
     .shown = {100.0, 300.0, 360.0, 600.0}},
    {"drive, attitude given, correlated aids, lever arm", .known = true, .drive = true,
     .aid =
         {"position 1 m correlated 60 s, velocity 0.05 m/s at 1 Hz until 300 s, lever arm 1 2 -1 "
          "± 0.1 m",
          "odometer 0.1 0.1 0.1 m/s at 2 Hz, lever arm 0.5 0 0 ± 0.05 m"},
     .shown = {100.0, 300.0, 360.0, 590.0}},
    {"drive, vertical held, velocity, heading and stops", .known = true, .drive = true,
     .aid = {"velocity 0.1 m/s at 1 Hz until 300 s", "heading 0.5 deg at 1 Hz until 300 s",
             "zero velocity 2 cm/s"},
     .shown = {100.0, 300.0, 360.0, 590.0}},
    {"drive, tactical, compensated", "tactical", .drive = true, .aid = {gnss, "height 2 m"},
     .shown = {100.0, 300.0, 360.0, 590.0}},
    {"drive, ADIS16465, compensated", "ADIS16465", .drive = true,
     .aid = {gnss, "odometer 0.1 0.1 0.1 m/s"}, .shown = {100.0, 300.0, 360.0, 590.0}},
    /* Twice the size, else the filter refuses readings, which is not linear. */
    {"drive, the filter takes correlated errors for white of twice the size", .known = true,
     .drive = true, .aid = {"position 2 m, velocity 0.1 m/s at 1 Hz until 300 s correlated 100 s"},
     .filter_aid = "position 4 m, velocity 0.2 m/s at 1 Hz until 300 s",
     .shown = {100.0, 300.0, 360.0, 590.0}},
};
enum { STUDIES = sizeof studies / sizeof studies[0] };

/* ---- runs ---- */

typedef struct work {
    const imk_model *model;
    const imk_drift_settings *settings;
    size_t runs, size;
    double *errors; /* [run][time][ALL] */
} work;

static void run_lanes(void *context, size_t item)
{
    const work *w = context;
    const size_t first = item * IMK_DRIFT_LANES;
    const size_t count = w->runs - first < IMK_DRIFT_LANES ? w->runs - first : IMK_DRIFT_LANES;
    void *memory = aligned_alloc(64, (w->size + 63) / 64 * 64);
    imk_error error;
    if (!memory || imk_drift_aided_runs(w->model, w->settings, 1, (uint32_t)first, count,
                                        w->errors + first * w->settings->time_count * ALL, memory,
                                        w->size, &error)) {
        fprintf(stderr, "aided_covariance: runs from %zu on failed\n", first);
        exit(2);
    }
    free(memory);
}

/* ---- models ---- */

/* A unit that finds north has gyros twenty times as good, with which an angle from an arc tangent
 * still is linear. */
static void known_model(bool self, imk_model *model)
{
    imk_model_default(model);
    imk_triad *triad[2] = {&model->gyro, &model->accel};
    static const double white[2] = {3e-5, 5e-4}, bias[2] = {5e-6, 5e-3}, walk[2] = {1e-7, 5e-5},
                        sigma[2] = {2e-6, 1e-3}, time[2] = {300.0, 100.0};
    for (int k = 0; k < 2; k++) {
        const double factor = self && k == 0 ? 0.05 : 1.0;
        triad[k]->noise.gauss_markov_count = 1;
        for (int i = 0; i < 3; i++) {
            triad[k]->noise.white.value[i] = factor * white[k];
            triad[k]->bias.repeatability.value[i] = factor * bias[k];
            triad[k]->noise.random_walk.value[i] = factor * walk[k];
            triad[k]->noise.gauss_markov[0].sigma.value[i] = factor * sigma[k];
            triad[k]->noise.gauss_markov[0].correlation_time.value[i] = time[k];
        }
    }
}

/* What a calibration leaves and the filter has no state for. */
static void make_uncertain(imk_triad *triad, double scale, double turn)
{
    for (int i = 0; i < 3; i++) {
        triad->scale_factor.fixed.sigma[i] = scale;
        for (int j = 0; j < 3; j++)
            if (j != i)
                triad->misalignment.sigma[i][j] = turn;
    }
}

/* ---- comparison ---- */

/* @return how many ratios are outside */
static int compare(const work *w, const imk_drift_analysis *theory, const study *s)
{
    const size_t stride = w->settings->time_count * ALL;
    const double n = (double)w->runs, family = 0.01 / (STUDIES * SHOWN * STATES);
    const double low = sqrt(imk_chi_square_quantile(0.5 * family, n) / n);
    const double high = sqrt(imk_chi_square_quantile(1.0 - 0.5 * family, n) / n);
    const bool held = imk_drift_vertical(w->settings) == IMK_VERTICAL_SLAVED;
    int outside = 0;
    printf("   due: %.3f to %.3f\n", low, high);
    for (size_t k = 0; k < SHOWN; k++) {
        size_t t = 0;
        while (fabs(theory->time[t] - s->shown[k]) > 1e-6)
            t++;
        printf("%8.0f s ", s->shown[k]);
        for (size_t i = 0; i < STATES; i++) {
            const double variance = theory->total[t].covariance[i][i];
            double sum = 0.0;
            if (held && (i == 2 || i == 5)) {
                printf("      -");
                continue;
            }
            for (size_t run = 0; run < w->runs; run++) {
                const double e = w->errors[run * stride + t * ALL + i] - theory->total[t].mean[i];
                sum += e * e;
            }
            const double ratio = sqrt(sum / n / variance);
            printf(" %6.3f", ratio);
            outside += !(ratio >= low && ratio <= high);
        }
        printf("\n");
    }
    return outside;
}

/* Errors last, so that what a set of runs has at one time it has at most others; sets of 50 are
 * independent. @return is the share of sets and times what it is due to be? */
static bool consistent(const work *w)
{
    enum { SET = 50 };
    const double degrees = imk_drift_nees_degrees(w->settings);
    const double low = imk_chi_square_quantile(0.025, SET * degrees) / SET;
    const double high = imk_chi_square_quantile(0.975, SET * degrees) / SET;
    const size_t sets = w->runs / SET, times = w->settings->time_count;
    size_t inside = 0;
    double all = 0.0;
    for (size_t set = 0; set < sets; set++)
        for (size_t t = 0; t < times; t++) {
            double mean = 0.0;
            for (size_t run = set * SET; run < (set + 1) * SET; run++)
                mean += w->errors[(run * times + t) * ALL + STATES] / SET;
            inside += mean >= low && mean <= high;
            all += mean / (double)(times * sets);
        }
    const double share = (double)inside / (double)(times * sets);
    printf("   normalised error squared: mean %.3f of %.0f; means of 50 runs within their 95 %% "
           "interval (%.3f to %.3f) in %.1f %% of %zu sets x %zu times\n",
           all, degrees, low, high, 100.0 * share, sets, times);
    return share >= 0.92 && share <= 0.98;
}

/* ---- a case ---- */

static size_t read_aids(const char *const *text, imk_aid *aid)
{
    size_t count = 0;
    for (int k = 0; k < 3 && text[k]; k++) {
        imk_aid found[IMK_AIDS_MAX];
        size_t more;
        imk_error error;
        if (imk_aid_parse(text[k], found, &more, &error) != IMK_OK) {
            fprintf(stderr, "aided_covariance: %s: %s %s\n", text[k], error.found, error.expected);
            exit(2);
        }
        memcpy(aid + count, found, more * sizeof *aid);
        count += more;
    }
    return count;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool run_study(const study *s, size_t runs, const imk_trajectory *drive,
                      const imk_executor *executor)
{
    static imk_model model;
    imk_aid aid[IMK_AIDS_MAX], told[IMK_AIDS_MAX];
    double time[TIMES + SHOWN];
    imk_error error;
    imk_drift_analysis *analysis;
    if (s->known) {
        known_model(s->self, &model);
    } else {
        imk_device_model(imk_device_find(s->device), &model);
        make_uncertain(&model.gyro, 3e-4, 3e-4);
        make_uncertain(&model.accel, 3e-4, 3e-4);
    }
    imk_drift_settings settings = imk_drift_default();
    settings.motion = s->drive ? drive : NULL;
    settings.alignment = s->self ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
    settings.compensated = true;
    settings.aid = aid;
    settings.aid_count = read_aids(s->aid, aid);
    if (s->filter_aid) {
        read_aids((const char *const[3]){s->filter_aid, NULL, NULL}, told);
        settings.filter_aid = told;
    }
    for (int i = 0; i < 3; i++) {
        settings.initial_sigma[i] = 3.0;
        settings.initial_sigma[3 + i] = 0.1;
        settings.initial_sigma[6 + i] = i < 2 ? 0.002 : 0.01;
    }
    size_t count = 0;
    for (; count < TIMES; count++)
        time[count] = s->shown[SHOWN - 1] * (double)(count + 1) / (TIMES + 1.0) + 0.37;
    for (size_t k = 0; k < SHOWN; k++)
        time[count++] = s->shown[k];
    for (size_t k = 0; k < count; k++)
        time[k] = floor(time[k] * settings.rate + 0.5) / settings.rate;
    qsort(time, count, sizeof *time, by_value);
    settings.time = time;
    settings.time_count = count;
    const size_t size = imk_drift_covariance_size(&model, &settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    if (!memory ||
        imk_drift_covariance(&model, &settings, executor, &analysis, memory, size, &error)) {
        fprintf(stderr, "aided_covariance: %s: %s\n", error.field, error.expected);
        exit(2);
    }
    work w = {&model, &settings, runs, imk_drift_runs_workspace_size(&model, &settings), NULL};
    w.errors = malloc(runs * count * ALL * sizeof *w.errors);
    if (!w.errors)
        exit(2);
    imk_execute(executor, (runs + IMK_DRIFT_LANES - 1) / IMK_DRIFT_LANES, run_lanes, &w);
    printf("%s\n", s->name);
    const int outside = compare(&w, analysis, s);
    const bool good = !s->known || s->filter_aid || consistent(&w);
    if (outside > 0)
        printf("   %d ratios outside\n", outside);
    free(w.errors);
    free(memory);
    return outside == 0 && good;
}

int main(int count, char **words)
{
    const size_t runs = count > 1 ? (size_t)atoll(words[1]) : 200;
    const int only = count > 2 ? atoi(words[2]) : -1;
    imk_motion_script script;
    static imk_motion_step step[CAR_PROFILE_STEPS];
    imk_trajectory drive;
    size_t pieces = 0;
    bool good = true;
    car_profile(&script, step);
    if (imk_motion_script_pieces(&script, &pieces, NULL) != IMK_OK)
        return 2;
    imk_trajectory_piece *piece = malloc(pieces * sizeof *piece);
    if (!piece || imk_motion_script_compile(&script, piece, pieces, &drive, NULL) != IMK_OK)
        return 2;
    imk_thread_pool *pool = imk_thread_pool_create(2);
    const imk_executor executor = imk_thread_pool_executor(pool);
    printf(
        "%zu runs; ratios of standard deviations: position, velocity, attitude, each north, east, "
        "down\n",
        runs);
    for (int k = 0; k < STUDIES; k++)
        if (only < 0 || only == k)
            good = run_study(&studies[k], runs, &drive, &executor) && good;
    imk_thread_pool_destroy(pool);
    free(piece);
    return good ? 0 : 1;
}
