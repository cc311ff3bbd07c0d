/* SPDX-License-Identifier: Apache-2.0 */
/* Do the intervals of a laboratory table hold the truth as often as they say? Tables are drawn with
 * normal noise, up and down, in one or more runs; the truth is what the same table without noise
 * gives.
 *
 *     coverage_evaluate [TABLES] [SEED]
 *
 * Share of 95 % intervals that hold the truth, and the bias of the value in standard deviations.
 * Then the same of the hysteresis of logs whose reference is late: a fifth of TABLES each. */
#include "../tests/calibrate/delayed_reference.h"
#include "../tests/calibrate/evaluation_session.h"

#include <stdio.h>

static const char *const names[EVALUATION_FIGURES] = {"precision", "sensitivity", "zero",
                                                      "accuracy",  "coverage",    "linearity",
                                                      "best",      "hysteresis",  "asymmetry"};

static void cover_delay(double delay, int logs, uint64_t seed)
{
    delayed_reference *d = malloc(sizeof *d);
    int held = 0, warned = 0;
    double sum = 0.0, square = 0.0, late = 0.0;
    for (int k = 0; d && k < logs; k++) {
        delayed_log(d, delay, seed * 1000000 + (uint64_t)k);
        if (!delayed_evaluate(d, false))
            continue;
        held +=
            d->hysteresis.lower <= delayed_hysteresis && delayed_hysteresis <= d->hysteresis.upper;
        warned += d->warned;
        sum += d->hysteresis.value / logs;
        late += d->delay / logs;
        square += (d->delay - delay) * (d->delay - delay) / logs;
    }
    printf("reference %.3g s late: %d logs, found %.4f s (rms error %.1e s), told %.1f %%; "
           "hysteresis 0.1 %%: %.4f %%, held %.2f %%\n",
           delay, logs, late, sqrt(square), 100.0 * warned / logs, 100.0 * sum,
           100.0 * held / logs);
    free(d);
}

int main(int argc, char **argv)
{
    const int tables = argc > 1 ? atoi(argv[1]) : 3000;
    const uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    if (tables < 1) {
        fputs("usage: coverage_evaluate [TABLES] [SEED]\n", stderr);
        return 2;
    }
    for (size_t p = 0; p < EVALUATION_PLANS; p++) {
        evaluation_score score[EVALUATION_FIGURES] = {{0}};
        evaluation_cover(&evaluation_plans[p], (uint32_t)p, tables, seed, score);
        printf("%s\n", evaluation_plans[p].name);
        for (int k = 0; k < EVALUATION_FIGURES; k++) {
            const evaluation_score *s = &score[k];
            const double n = s->stated, mean = s->sum / n;
            const double sigma = sqrt(s->square / n - mean * mean);
            if (s->stated > 0)
                printf("  %-12s held %6.2f %%  (too high %.2f %%, too low %.2f %%)  bias %+.3f "
                       "sigma\n",
                       names[k], 100.0 * (n - s->high - s->low) / n, 100.0 * s->high / n,
                       100.0 * s->low / n, mean / sigma);
        }
    }
    static const double delays[] = {0.0, 0.05, 0.5, -0.5, 1.3};
    for (size_t k = 0; k < sizeof delays / sizeof *delays; k++)
        cover_delay(delays[k], (tables + 4) / 5, seed);
    return 0;
}
