/* SPDX-License-Identifier: Apache-2.0 */
/* Noise that makes a filter consistent, on three motions and with three sensors: is the NEES that
 * the covariance predicts that of the increments of simulated readings, is the fit's mean 1, and
 * is the safe answer safe?
 *
 * usage: filter_tuning [runs]
 *
 * For each case and answer: the mean NEES over the times, predicted and found; the largest
 * difference of a time in standard errors of the runs, and the limit that the largest of all times
 * exceeds with 1 % (Bonferroni, Student); the range of NEES; the largest eigenvalue; the share of
 * errors beyond the 95 % ellipsoid. Ends with 1 when a difference is beyond its limit, the mean of
 * the fit is not 1 within its own 99 % interval, or the safe answer exceeds its eigenvalue. */
#include "filter_motions.h"
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { STATES = IMK_TUNING_STATES, TIMES = IMK_TUNING_TIMES_MAX };

static const char *const sensors[3][2] = {
    {"control", "consumer"}, {"AHRS", "industrial"}, {"tactical", "tactical"}};

typedef struct work {
    const imk_model *model;
    const imk_filter_tuning_settings *settings;
    const imk_filter_tuning *tuning;
    size_t size;
    uint64_t seed;
    double (*nees)[IMK_FILTER_ANSWERS][TIMES]; /* [run] */
} work;

static void *memory_of(size_t size)
{
    void *memory = calloc(1, size);
    if (!memory) {
        fprintf(stderr, "filter_tuning: no memory\n");
        exit(2);
    }
    return memory;
}

static void run_one(void *context, size_t run)
{
    const work *w = context;
    imk_error error;
    void *workspace = memory_of(w->size);
    double *errors =
        memory_of(w->tuning->window_count * w->tuning->time_count * STATES * sizeof(double));
    if (imk_filter_tuning_simulate(w->model, w->settings, w->tuning, w->seed, (uint32_t)run, errors,
                                   workspace, w->size, &error) != IMK_OK) {
        fprintf(stderr, "filter_tuning: %s\n", error.expected);
        exit(2);
    }
    for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++)
        if (w->tuning->answer[kind].found)
            imk_filter_tuning_nees(w->tuning, kind, errors, w->nees[run][kind]);
    free(errors);
    free(workspace);
}

/* Mean of the runs and its standard error; time TIMES: of the mean over the times. */
static void statistics(const work *w, size_t runs, int kind, size_t time, double *mean,
                       double *error)
{
    const size_t count = w->tuning->time_count;
    double sum = 0.0, squares = 0.0;
    for (size_t r = 0; r < runs; r++) {
        double x = 0.0;
        for (size_t t = 0; t < count; t++)
            x += time == TIMES ? w->nees[r][kind][t] / (double)count
                               : (t == time ? w->nees[r][kind][t] : 0.0);
        sum += x;
        squares += x * x;
    }
    *mean = sum / (double)runs;
    *error = sqrt(fmax(squares / (double)runs - *mean * *mean, 0.0) / (double)(runs - 1));
}

/* @return false: something is not as it must be */
static bool report(const work *w, size_t runs, int kind, double limit)
{
    const imk_filter_tuning *tuning = w->tuning;
    const imk_filter_answer *answer = &tuning->answer[kind];
    double mean, error, most = 0.0, low = INFINITY, high = 0.0, largest = 0.0, beyond = 0.0;
    for (size_t t = 0; t < tuning->time_count; t++) {
        const imk_filter_consistency *c = &answer->consistency[t];
        statistics(w, runs, kind, t, &mean, &error);
        most = fmax(most, fabs(mean - c->nees) / error);
        low = fmin(low, c->nees);
        high = fmax(high, c->nees);
        largest = fmax(largest, c->largest);
        beyond = fmax(beyond, c->beyond);
    }
    statistics(w, runs, kind, TIMES, &mean, &error);
    const double alone = imk_student_quantile(0.995, (double)(runs - 1));
    printf("  %-20s %10.4g %10.4g %8.2f   %8.3g … %-8.3g %8.3g %6.1f %%",
           imk_filter_answer_name(kind), answer->mean_nees, mean, most, low, high, largest,
           100.0 * beyond);
    bool good = most <= limit;
    if (kind == IMK_FILTER_FIT)
        good = good && fabs(mean - 1.0) <= alone * error;
    if (kind == IMK_FILTER_SAFE || kind == IMK_FILTER_SAFE_SCALED)
        good = good && largest <= 1.05;
    printf("%s\n", good ? "" : "  NO");
    return good;
}

static void show_numbers(const imk_filter_answer *a)
{
    const double hour = 60.0 * 180.0 / 3.14159265358979323846;
    printf("    N %.3g deg/sqrt(h), %.3g m/s/sqrt(h); K %.3g deg/h/sqrt(h), %.3g ug/sqrt(h)",
           a->parameters.white[0][0] * hour, a->parameters.white[1][0] * 60.0,
           a->parameters.walk[0][0] * hour * 3600.0, a->parameters.walk[1][0] * 60.0 / 9.80665e-6);
    if (a->parameters.scale_factor[0][0] > 0.0)
        printf("; scale factors %.3g, %.3g", a->parameters.scale_factor[0][0],
               a->parameters.scale_factor[1][0]);
    printf("\n");
}

static bool study(const imk_motion_file *motion, const imk_model *model, uint64_t seed, size_t runs,
                  const imk_executor *executor)
{
    imk_error error;
    imk_filter_tuning *tuning;
    imk_filter_tuning_settings settings = imk_filter_tuning_default();
    settings.motion_count = 1;
    settings.motion[0] = *imk_motion_file_motion(motion);
    settings.window_count = 48;
    settings.bias_sigma[0] = settings.bias_sigma[1] = 0.0; /* the fit is then free of scale */
    const size_t size = imk_filter_tuning_size(model, &settings);
    void *memory = memory_of(size);
    if (imk_filter_tuning_run(model, &settings, executor, &tuning, memory, size, &error) !=
        IMK_OK) {
        fprintf(stderr, "filter_tuning: %s %s\n", error.field, error.expected);
        exit(2);
    }
    work w = {model,  &settings,
              tuning, imk_filter_tuning_runs_workspace_size(model, &settings),
              seed,   memory_of(runs * sizeof *w.nees)};
    imk_execute(executor, runs, run_one, &w);
    const double family = (double)(tuning->time_count * IMK_FILTER_ANSWERS);
    const double limit = imk_student_quantile(1.0 - 0.005 / family, (double)(runs - 1));
    printf("  limit of the differences %.2f; %zu times, %zu windows; %s%s\n", limit,
           tuning->time_count, tuning->window_count,
           tuning->inconstant ? "no constant noise: " : "largest error: ",
           tuning->source[tuning->worst_source].name);
    bool good = true;
    for (int kind = 0; kind < IMK_FILTER_ANSWERS; kind++)
        if (tuning->answer[kind].found) {
            good = report(&w, runs, kind, limit) && good;
            show_numbers(&tuning->answer[kind]);
        } else
            good = false;
    free(w.nees);
    free(memory);
    return good;
}

int main(int count, char **words)
{
    const size_t runs = count > 1 ? strtoul(words[1], NULL, 10) : 200;
    bool good = runs > 2;
    imk_model *model = memory_of(sizeof *model);
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (size_t m = 0; m < FILTER_MOTIONS && good; m++) {
        imk_motion_file *motion;
        imk_error error;
        if (imk_motion_parse(filter_motions[m].text, strlen(filter_motions[m].text), NULL, 1,
                             &motion, &error) != IMK_OK) {
            fprintf(stderr, "filter_tuning: %s: line %zu: %s\n", filter_motions[m].name, error.line,
                    error.expected);
            return 2;
        }
        for (size_t s = 0; s < 3; s++) {
            imk_device_model(imk_device_find(sensors[s][0]), model);
            printf("%s, %s (%s)\n                         predicted      found  differ         NEES"
                   "          eigenvalue beyond\n",
                   filter_motions[m].name, sensors[s][1], sensors[s][0]);
            good = study(motion, model, 2000 + 10 * m + s, runs, &executor) && good;
            fflush(stdout);
        }
        imk_motion_file_free(motion);
    }
    imk_thread_pool_destroy(pool);
    free(model);
    return good ? 0 : 1;
}
