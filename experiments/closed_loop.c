/* SPDX-License-Identifier: Apache-2.0 */
/* Simulate, identify, compare: coverage, bias and scatter over thousands of records.
 *
 * usage: closed_loop [logs] [seed] [first log]
 *
 * Each log is three channels of three hours at 100 Hz with N = 0.3 deg/sqrt(h), B = 8 deg/h,
 * K = 20 deg/h/sqrt(h), and gives three estimates of each parameter. Prints, per parameter: how
 * often the 95 % profile-likelihood interval covers the truth; bias and scatter of the square of
 * the likeliest value, against the bound of Cramer and Rao; how often the term is called present;
 * and how often something false is found. Exits with 1 when the scatter exceeds the bound by 15 %,
 * the bias a tenth of the scatter, or the coverage is not 95 +- 1.2 %. */
#include "imukit/io.h"
#include "noise_record.h"

#include <stdio.h>
#include <stdlib.h>

enum { CHANNELS = 3, BATCH = 24, WORKERS = 8 };
static const double DEGREE = 0.017453292519943295;

typedef struct tally {
    const char *name;
    int term;
    size_t trials, covered, present;
    double sum, squares; /* of the squared likeliest value, in units of the truth's */
} tally;

typedef struct experiment {
    truth t;
    uint64_t seed;
    size_t first, count, workers; /* records of the present batch */
    double *samples[WORKERS];
    void *workspace[WORKERS];
    size_t workspace_size;
    imk_identification result[BATCH];
    imk_status status[BATCH];
} experiment;

static void worker(void *context, size_t index)
{
    experiment *e = context;
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 1 / e->t.rate;
    for (size_t i = index; i < e->count; i += e->workers) {
        make_record(&e->t, e->seed, e->first + i, e->samples[index]);
        e->status[i] =
            imk_identify_channel(&settings, e->t.samples, e->samples[index], &e->result[i],
                                 e->workspace[index], e->workspace_size, NULL);
    }
}

static void count(tally *t, double truth_value, const imk_identification *r)
{
    const imk_estimate *e = &r->term[t->term];
    const double ratio = e->free_value / truth_value, square = ratio * ratio;
    t->trials++;
    t->covered += e->lower <= truth_value && truth_value <= e->upper;
    t->present += e->present;
    t->sum += square;
    t->squares += square * square;
}

static bool print(const tally *t, double bound)
{
    const double n = (double)t->trials, mean = t->sum / n;
    const double sd = sqrt(fmax(0, t->squares / n - mean * mean));
    const double covered = (double)t->covered / n, bias = (mean - 1) / sd;
    printf("%s: %zu estimates, 95 %% intervals cover %.2f %% (+- %.2f), present %.1f %%\n", t->name,
           t->trials, 100 * covered, 100 * sqrt(0.05 * 0.95 / n), 100 * (double)t->present / n);
    printf("   squared: sd %.3f %%, bound %.3f %%, ratio %.3f; bias %+.3f sd (+- %.3f)\n", 100 * sd,
           100 * bound, sd / bound, bias, 1 / sqrt(n));
    return sd <= 1.15 * bound && fabs(bias) <= 0.1 && fabs(covered - 0.95) <= 0.012;
}

int main(int argc, char **argv)
{
    const size_t logs = argc > 1 ? strtoul(argv[1], NULL, 10) : 1000;
    const size_t first = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    static experiment e = {
        .t = {.name = "3 h", .rate = 100, .samples = 1080000}, .seed = 1, .workers = WORKERS};
    e.seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    e.t.term[IMK_NOISE_WHITE] = 0.3 * DEGREE / 60;
    e.t.term[IMK_NOISE_BIAS_INSTABILITY] = 8 * DEGREE / 3600;
    e.t.term[IMK_NOISE_RANDOM_WALK] = 20 * DEGREE / 3600 / 60;
    e.workspace_size = imk_identify_workspace_size(e.t.samples);
    for (size_t i = 0; i < e.workers; i++) {
        e.samples[i] = malloc(e.t.samples * sizeof(double));
        e.workspace[i] = malloc(e.workspace_size);
    }
    tally tallies[] = {{.name = "N", .term = IMK_NOISE_WHITE},
                       {.name = "B", .term = IMK_NOISE_BIAS_INSTABILITY},
                       {.name = "K", .term = IMK_NOISE_RANDOM_WALK}};
    size_t quantization = 0, ramp = 0, shape = 0, gauss_markov = 0, failed = 0;
    const size_t end = (first + logs) * CHANNELS;
    for (e.first = first * CHANNELS; e.first < end; e.first += e.count) {
        e.count = end - e.first < BATCH ? end - e.first : BATCH;
        imk_execute(&executor, e.workers, worker, &e);
        for (size_t i = 0; i < e.count; i++) {
            const imk_identification *r = &e.result[i];
            failed += e.status[i] != IMK_OK;
            for (size_t j = 0; j < 3; j++)
                count(&tallies[j], e.t.term[tallies[j].term], r);
            quantization += r->term[IMK_NOISE_QUANTIZATION].present;
            ramp += r->term[IMK_NOISE_RAMP].present;
            shape += r->filter.bandwidth > 0 || r->sinusoid_count > 0 || r->resonance_count > 0;
            gauss_markov += r->gauss_markov_count > 0;
        }
        if (e.first / 600 != (e.first + e.count) / 600)
            fprintf(stderr, "%zu of %zu logs\n", (e.first + e.count) / CHANNELS - first, logs);
    }
    double bound[PARAMETERS];
    bounds(&e.t, bound);
    bool good = failed == 0;
    for (size_t j = 0; j < 3; j++)
        good = print(&tallies[j], bound[tallies[j].term]) && good;
    printf(
        "false: quantization %zu, ramp %zu, lines or filter %zu, Gauss-Markov %zu of %zu; failed "
        "%zu\n",
        quantization, ramp, shape, gauss_markov, tallies[0].trials, failed);
    for (size_t i = 0; i < e.workers; i++) {
        free(e.samples[i]);
        free(e.workspace[i]);
    }
    imk_thread_pool_destroy(pool);
    return !good;
}
