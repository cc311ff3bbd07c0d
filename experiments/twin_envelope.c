/* SPDX-License-Identifier: Apache-2.0 */
/* Does a log look like a draw of the model identified from it?
 *
 * usage: twin_envelope LOG MODEL RATE_HZ [twins] [first seed]
 *
 * Simulates twins of the log, takes the overlapped Allan deviations of all, ten per decade, and
 * compares: with the median of the twins where the degrees of freedom are at least 100 (limit 10
 * %), and with their 99 % pointwise envelope from 2 s to a ninth of the log (95 % of the points
 * must lie inside). */
#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

static int fail(const imk_error *error, const char *source)
{
    char text[512];
    imk_error_text(error, source, text, sizeof text);
    fprintf(stderr, "%s\n", text);
    return 1;
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
    if (imk_log_load(argv[1], &log_settings, NULL, NULL, &log, &error) != IMK_OK)
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
        if (imk_simulator_start(memory, size, &model, &simulation, &simulator, &error) != IMK_OK)
            return fail(&error, argv[2]);
        imk_simulator_next(simulator, log.rows, work.columns, &executor);
        work.deviation = twin[t];
        imk_execute(&executor, CHANNELS, deviations_item, &work);
    }

    size_t tested = 0, inside = 0, close_tested = 0, close = 0;
    double worst = 0;
    for (int c = 0; c < CHANNELS; c++)
        for (size_t i = 0; i < factor_count; i++) {
            double values[TWINS_MAX];
            for (size_t t = 0; t < twins; t++)
                values[t] = twin[t][c][i];
            qsort(values, twins, sizeof *values, ascending);
            const double tau = (double)factors[i] * dt, median = quantile(values, twins, 0.5);
            const double low = quantile(values, twins, 0.005),
                         high = quantile(values, twins, 0.995);
            const double edf =
                imk_allan_edf_exact(IMK_ALLAN_OVERLAPPING, IMK_WHITE_RATE, log.rows, factors[i]);
            const double ratio = real[c][i] / median;
            if (edf >= 100) {
                close_tested++;
                close += fabs(ratio - 1) <= 0.10;
                worst = fabs(ratio - 1) > fabs(worst) ? ratio - 1 : worst;
            }
            if (tau >= 2 * (1 - 1e-9)) {
                const bool in = real[c][i] >= low && real[c][i] <= high;
                tested++;
                inside += in;
                if (!in)
                    printf("outside: channel %d, tau %.4g s: log/median %.3f, envelope %.3f to "
                           "%.3f\n",
                           c, tau, ratio, low / median, high / median);
            }
        }
    printf("within 10 %% of the twins' median where edf >= 100: %zu of %zu, worst %+.1f %%\n",
           close, close_tested, 100 * worst);
    printf("inside the 99 %% envelope of %zu twins from 2 s to T/9: %zu of %zu (%.1f %%)\n", twins,
           inside, tested, 100 * (double)inside / (double)tested);
    imk_thread_pool_destroy(pool);
    return !(close == close_tested && (double)inside >= 0.95 * (double)tested);
}
