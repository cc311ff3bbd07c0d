/* SPDX-License-Identifier: Apache-2.0 */
/* Does a log look like a draw of the model identified from it?
 *
 * usage: twin_envelope LOG MODEL RATE_HZ [twins] [first seed]
 *
 * Simulates twins of the log and takes the overlapped Allan deviations of all, ten averaging times
 * a decade from two samples to a ninth of the log. Of all (channel, tau) at least 95 % must lie
 * inside the twins' 99 % pointwise envelope, from the 0.5 % to the 99.5 % quantile. Of 100
 * twins these lie between the two outermost on either side: a log that is a draw of the model
 * itself is outside at about 3 % of the points. */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS = 6, FACTORS = 120, TWINS_MAX = 1000 };

typedef struct channel_work {
    size_t n, factor_count;
    const size_t *factors;
    double *columns[CHANNELS];
    double (*deviation)[FACTORS]; /* [channel][factor] */
} channel_work;

static void deviations_item(void *context, size_t channel)
{
    channel_work *w = context;
    double *sums = w->columns[channel];
    imk_allan_sums(w->n, sums, sums, NULL);
    imk_allan_variances(IMK_ALLAN_OVERLAPPING, w->n, sums, w->factor_count, w->factors,
                        w->deviation[channel], NULL, NULL);
    for (size_t i = 0; i < w->factor_count; i++)
        w->deviation[channel][i] = sqrt(w->deviation[channel][i]);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(const double *sorted, size_t count, double p)
{
    const double place = p * ((double)count - 1);
    const size_t low = (size_t)place;
    return low + 1 < count ? sorted[low] + (place - (double)low) * (sorted[low + 1] - sorted[low])
                           : sorted[count - 1];
}

/* The log's deviation at one point against the twins'. */
typedef struct comparison {
    double ratio;     /* log over the median of the twins */
    double low, high; /* of the envelope, over the median */
    double distance;  /* of the log from the median, in half widths of the envelope */
} comparison;

static comparison compare(double deviation, size_t twins, double (*twin)[CHANNELS][FACTORS],
                          int channel, size_t factor)
{
    double values[TWINS_MAX];
    for (size_t t = 0; t < twins; t++)
        values[t] = twin[t][channel][factor];
    qsort(values, twins, sizeof *values, ascending);
    const double median = quantile(values, twins, 0.5);
    comparison p = {deviation / median, quantile(values, twins, 0.005) / median,
                    quantile(values, twins, 0.995) / median, 0};
    p.distance = p.ratio > 1 ? (p.ratio - 1) / (p.high - 1) : (p.ratio - 1) / (1 - p.low);
    return p;
}

static int fail(const imk_error *error, const char *source)
{
    char text[512];
    imk_error_text(error, source, text, sizeof text);
    fprintf(stderr, "%s\n", text);
    return 1;
}

/* Prints how the log compares at every point. @return whether enough of them lie inside */
static bool report(const channel_work *work, double dt, double (*real)[FACTORS], size_t twins,
                   double (*twin)[CHANNELS][FACTORS])
{
    const size_t *factors = work->factors, factor_count = work->factor_count;
    size_t tested = 0, inside = 0;
    for (int c = 0; c < CHANNELS; c++) {
        size_t inside_here = 0;
        double worst = 0, worst_tau = 0;
        for (size_t i = 0; i < factor_count; i++) {
            const double tau = (double)factors[i] * dt;
            const comparison p = compare(real[c][i], twins, twin, c, i);
            const bool in = p.ratio >= p.low && p.ratio <= p.high;
            inside_here += in;
            if (!in)
                printf("outside: channel %d, tau %.4g s: log/median %.4f, envelope %.4f to %.4f\n",
                       c, tau, p.ratio, p.low, p.high);
            if (fabs(p.distance) > fabs(worst)) {
                worst = p.distance;
                worst_tau = tau;
            }
        }
        printf("channel %d: %zu of %zu inside; worst at %.4g s, %+.1f half widths of the envelope "
               "from the median\n",
               c, inside_here, factor_count, worst_tau, worst);
        inside += inside_here;
        tested += factor_count;
    }
    printf("inside the 99 %% envelope of %zu twins, from %.4g s to %.4g s: %zu of %zu (%.1f %%)\n",
           twins, (double)factors[0] * dt, (double)factors[factor_count - 1] * dt, inside, tested,
           100 * (double)inside / (double)tested);
    return (double)inside >= 0.95 * (double)tested;
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        fprintf(stderr, "usage: twin_envelope LOG MODEL RATE_HZ [twins] [first seed]\n");
        return 2;
    }
    const double rate = strtod(argv[3], NULL);
    const size_t twins = argc > 4 ? strtoul(argv[4], NULL, 10) : 100;
    const uint64_t first_seed = argc > 5 ? strtoull(argv[5], NULL, 10) : 1;
    imk_error error;
    imk_log log;
    imk_log_settings log_settings = imk_log_settings_default();
    log_settings.rate = rate;
    if (imk_log_load(argv[1], &log_settings, NULL, &log, &error) != IMK_OK)
        return fail(&error, argv[1]);
    static imk_model model;
    if (imk_model_open(argv[2], &model, NULL, &error) != IMK_OK)
        return fail(&error, argv[2]);

    const double dt = 1 / rate;
    size_t factors[FACTORS], factor_count = imk_allan_factors(IMK_ALLAN_DECADE, log.rows, NULL);
    if (factor_count > FACTORS || twins > TWINS_MAX)
        return 2;
    imk_allan_factors(IMK_ALLAN_DECADE, log.rows, factors);
    while (factors[factor_count - 1] > log.rows / 9)
        factor_count--;
    while (factor_count > 0 && factors[0] < 2) {
        factor_count--;
        memmove(factors, factors + 1, factor_count * sizeof *factors);
    }

    static double real[CHANNELS][FACTORS], twin[TWINS_MAX][CHANNELS][FACTORS];
    channel_work work = {.n = log.rows, .factor_count = factor_count, .factors = factors};
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (int c = 0; c < CHANNELS; c++) {
        const imk_quantity quantity =
            c < 3 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE;
        work.columns[c] = log.data[imk_log_find(&log, quantity, c % 3)];
    }
    work.deviation = real;
    imk_execute(&executor, CHANNELS, deviations_item, &work);

    imk_simulation simulation = imk_simulation_default();
    simulation.rate = rate;
    const size_t size = (imk_simulator_size(&model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    for (size_t t = 0; t < twins; t++) {
        simulation.seed = first_seed + t;
        imk_simulator *simulator;
        if (imk_simulator_start(&model, &simulation, &simulator, memory, size, &error) != IMK_OK)
            return fail(&error, argv[2]);
        imk_simulator_next(simulator, log.rows, work.columns, &executor);
        work.deviation = twin[t];
        imk_execute(&executor, CHANNELS, deviations_item, &work);
    }

    const bool good = report(&work, dt, real, twins, twin);
    imk_thread_pool_destroy(pool);
    return !good;
}
