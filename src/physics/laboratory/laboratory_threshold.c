/* SPDX-License-Identifier: Apache-2.0 */
/* Threshold: the smallest input that gives at least half of its expected change. Inputs fall from
 * full scale by sqrt(10) each, over 10.5 decades; below the first that fails, or that noise hides,
 * nothing is asked. Between it and the last good one the limit is bisected. */
#include "laboratory_internal.h"

#include <math.h>

enum { SCAN = 22, BISECTIONS = 6, CYCLES = 4 };

typedef struct answer {
    double change, sigma;
} answer;

/* Is the change half of the input or more? -1: noise hides it. */
static int responds(const answer *a, double input)
{
    if (!(6.0 * a->sigma < input))
        return -1;
    return a->change >= 0.5 * input;
}

/* Changes by `count` inputs, in cycles of the same noise. @return false when stopped */
static bool ask(imki_bench *bench, size_t count, const double *input, answer *answers)
{
    double y[CYCLES * (SCAN + 1)];
    imki_experiment *e = imki_experiment_begin(bench, "threshold");
    e->rows = count + 1;
    for (size_t i = 0; i <= count; i++)
        e->trial[i] = imki_trial_of(bench->laboratory, i < count ? input[i] : 0.0);
    if (!imki_progress(bench, e->stage, 0, CYCLES * e->rows))
        return false;
    imki_readings(bench, 0, CYCLES, y);
    for (size_t i = 0; i < count; i++) {
        double change[CYCLES], mean = 0.0, square = 0.0;
        for (size_t c = 0; c < CYCLES; c++) {
            change[c] = y[c * e->rows + i] - y[c * e->rows + count];
            mean += change[c] / CYCLES;
        }
        for (size_t c = 0; c < CYCLES; c++)
            square += (change[c] - mean) * (change[c] - mean);
        answers[i] = (answer){mean, sqrt(square / (CYCLES * (CYCLES - 1.0)))};
    }
    bench->result->effort[imki_figure_of(bench, "dead_band")].seconds +=
        (double)(CYCLES * e->rows) * imki_trial_time(bench);
    return true;
}

void imki_threshold(imki_bench *bench)
{
    double inputs[SCAN], input = bench->result->full_scale, good = input, bad = 0.0;
    answer answers[SCAN];
    bool hidden = false;
    const size_t figure = imki_figure_of(bench, "dead_band");
    imk_laboratory_effort *effort = &bench->result->effort[figure];
    for (size_t i = 0; i < SCAN; i++, input /= sqrt(10.0))
        inputs[i] = input;
    if (!ask(bench, SCAN, inputs, answers))
        return;
    for (size_t i = 0; i < SCAN && bad <= 0.0 && !hidden; i++) {
        const int yes = responds(&answers[i], inputs[i]);
        hidden = yes < 0;
        if (yes == 0)
            bad = inputs[i];
        else if (yes == 1)
            good = inputs[i];
    }
    for (int i = 0; bad > 0.0 && i < BISECTIONS; i++) {
        const double middle = sqrt(good * bad);
        if (!ask(bench, 1, &middle, answers))
            return;
        if (responds(answers, middle) == 1)
            good = middle;
        else
            bad = middle;
    }
    bench->result->threshold = bad > 0.0 ? good : 0.0;
    bench->result->threshold_from = good;
    /* without one, it may be below the smallest input that gave an answer */
    bench->triad->dead_band.value[0] = bad > 0.0 ? sqrt(good * bad) : 0.0;
    bench->triad->dead_band.sigma[0] = bad > 0.0 ? good - bad : good / 3.0;
    const double times =
        bench->triad->dead_band.sigma[0] / (IMKI_WANTED * bench->result->matters[figure]);
    effort->freedom = (double)INFINITY;
    effort->needs = effort->seconds * fmax(times * times, 1.0);
}
