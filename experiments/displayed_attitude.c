/* SPDX-License-Identifier: Apache-2.0 */
/* Are the stated errors of the displayed attitude those of a display? Full runs against the
 * covariance: rms over the runs of the three attitude errors, and of the heading and roll and pitch
 * that a display would show, over the stated sigmas.
 *
 * usage: displayed_attitude [runs]
 *
 * For each latitude and time: the stated tilt and heading in both senses, and rms over stated of
 * tilt north, tilt east and heading in the sense of imk_attitude_errors: expected scatter
 * 1/sqrt(2 runs). The unit is level at rest; the start is given with an error of 20 m in position
 * and 0.01 deg in attitude, and at 45 deg also found by self-alignment. Ends with 1 when a ratio of
 * a displayed error is off by more than 10 %. */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STATES = IMK_DRIFT_STATES, TIMES = 3 };

static const double degree = 0.017453292519943295;
static const double times[TIMES] = {600.0, 3600.0, 14400.0};

typedef struct study {
    double latitude, yaw;
    bool self;
} study;

static const study studies[] = {{-60.0, 30.0, false}, {0.0, 30.0, false},  {45.0, 30.0, false},
                                {85.0, 30.0, false},  {90.0, 30.0, false}, {-89.999, 30.0, false},
                                {45.0, 30.0, true}};

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
                                  w->errors + first * TIMES * STATES, memory, w->size, &error)) {
        fprintf(stderr, "displayed_attitude: runs from %zu on failed\n", first);
        exit(2);
    }
    free(memory);
}

/* Of every state at every time: mean and covariance together. */
static void stated_of(const imk_model *model, const imk_drift_settings *settings,
                      double stated[TIMES][STATES])
{
    const size_t size = imk_drift_covariance_size(model, settings);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_drift_analysis *analysis;
    imk_error error;
    if (!memory || imk_drift_covariance(model, settings, NULL, &analysis, memory, size, &error)) {
        fprintf(stderr, "displayed_attitude: the covariance failed\n");
        exit(2);
    }
    for (int t = 0; t < TIMES; t++)
        for (int i = 0; i < STATES; i++)
            stated[t][i] = sqrt(analysis->total[t].covariance[i][i] +
                                analysis->total[t].mean[i] * analysis->total[t].mean[i]);
    free(memory);
}

static imk_drift_settings settings_of(const study *s, imk_attitude_errors sense)
{
    imk_drift_settings settings = imk_drift_default();
    settings.latitude = s->latitude * degree;
    settings.yaw = s->yaw * degree;
    settings.rate = 1.0;
    settings.alignment = s->self ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
    settings.attitude_errors = sense;
    settings.initial_sigma[0] = settings.initial_sigma[1] = 20.0;
    for (int i = 6; i < STATES; i++)
        settings.initial_sigma[i] = 0.01 * degree;
    settings.time = times;
    settings.time_count = TIMES;
    return settings;
}

/* @return the largest deviation of a ratio from 1 */
static double compare(const imk_model *model, const study *s, imk_attitude_errors sense,
                      size_t runs, imk_thread_pool *pool)
{
    const imk_drift_settings settings = settings_of(s, sense);
    const imk_executor executor = imk_thread_pool_executor(pool);
    double stated[TIMES][STATES], worst = 0.0;
    work w = {model, &settings, runs, imk_drift_runs_workspace_size(model, &settings),
              malloc(runs * TIMES * STATES * sizeof(double))};
    if (!w.errors)
        exit(2);
    stated_of(model, &settings, stated);
    imk_execute(&executor, (runs + IMK_DRIFT_LANES - 1) / IMK_DRIFT_LANES, run_lanes, &w);
    for (int t = 0; t < TIMES; t++) {
        double ratio[3];
        for (int i = 0; i < 3; i++) {
            double sum = 0.0;
            for (size_t run = 0; run < runs; run++) {
                const double e = w.errors[(run * TIMES + (size_t)t) * STATES + 6 + (size_t)i];
                sum += e * e;
            }
            ratio[i] = sqrt(sum / (double)runs) / stated[t][6 + i];
            worst = fmax(worst, fabs(ratio[i] - 1.0));
        }
        printf("  %-5s %8.0f s %12.6f %12.6f deg %9.3f %9.3f %9.3f\n",
               sense == IMK_ATTITUDE_LOCAL ? "local" : "earth", times[t],
               hypot(stated[t][6], stated[t][7]) / degree, stated[t][8] / degree, ratio[0],
               ratio[1], ratio[2]);
    }
    free(w.errors);
    return worst;
}

int main(int count, char **words)
{
    const size_t runs = count > 1 ? (size_t)atol(words[1]) : 400;
    imk_thread_pool *pool = imk_thread_pool_create(2);
    imk_model model;
    double worst = 0.0;
    imk_device_model(imk_device_find("navigation"), &model);
    printf("navigation preset, level at rest, heading 30 deg, %zu runs at 1 Hz\n", runs);
    printf("  sense       time         tilt      heading     rms/stated: north, east, down\n");
    for (size_t i = 0; i < sizeof studies / sizeof *studies; i++) {
        const study *s = &studies[i];
        printf("latitude %g deg, attitude %s\n", s->latitude, s->self ? "found" : "given");
        worst = fmax(worst, compare(&model, s, IMK_ATTITUDE_LOCAL, runs, pool));
        compare(&model, s, IMK_ATTITUDE_EARTH, runs, pool);
    }
    printf("largest deviation of a displayed error: %.1f %%\n", 100.0 * worst);
    imk_thread_pool_destroy(pool);
    return worst > 0.1;
}
