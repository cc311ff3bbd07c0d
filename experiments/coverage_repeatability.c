/* SPDX-License-Identifier: Apache-2.0 */
/* Do intervals of the repeatability hold the truth as often as they say?
 *
 * usage: coverage_repeatability [SETS] [SEED]
 *
 * Sets of runs are drawn: a value each, normal with the true repeatability and the run's own sigma,
 * which differs from run to run; where sigmas have few degrees of freedom, what is stated is drawn
 * from chi-square. Printed: the share of sets whose 95 % interval holds the repeatability, the bias
 * of the estimated variance in sigmas of it, and how often the difference is called significant. */
#include "imukit/imukit.h"
#include "imukit/repeatability.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { RUNS_MOST = 40, FREEDOM_MOST = 16, ROW = 2048 };

typedef struct plan {
    size_t runs;
    double between; /* against sigmas from 0.5 to 1.5 */
    int freedom;    /* of each sigma; 0: exact */
} plan;

static void draw(const plan *p, const double *normal, double *value, double *sigma, double *freedom)
{
    for (size_t k = 0; k < p->runs; k++) {
        const double own = 0.5 + (double)k / (double)(p->runs - 1);
        double square = 0.0;
        value[k] = 3.0 + p->between * normal[k] + own * normal[RUNS_MOST + k];
        for (int f = 0; f < p->freedom; f++) {
            const double n = normal[2 * RUNS_MOST + k * FREEDOM_MOST + (size_t)f];
            square += n * n;
        }
        sigma[k] = p->freedom > 0 ? own * sqrt(square / p->freedom) : own;
        freedom[k] = p->freedom > 0 ? p->freedom : (double)INFINITY;
    }
}

int main(int argc, char **argv)
{
    static const plan plans[] = {{5, 0.0, 0},   {5, 0.5, 0},  {5, 1.0, 0},  {5, 3.0, 0},
                                 {5, 1.0, 6},   {5, 3.0, 6},  {10, 1.0, 0}, {10, 1.0, 6},
                                 {10, 1.0, 12}, {10, 3.0, 6}, {3, 3.0, 0},  {2, 3.0, 0},
                                 {40, 0.5, 0},  {40, 1.0, 6}};
    const int sets = argc > 1 ? atoi(argv[1]) : 3000;
    const imk_random source = imk_random_seeded(argc > 2 ? (uint64_t)atoll(argv[2]) : 1);
    if (sets < 1) {
        fputs("usage: coverage_repeatability [SETS] [SEED]\n", stderr);
        return 2;
    }
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        const plan *p = &plans[i];
        static double normal[ROW];
        double value[RUNS_MOST], sigma[RUNS_MOST], freedom[RUNS_MOST];
        double sum = 0.0, square = 0.0;
        int held = 0, above = 0, below = 0, significant = 0;
        for (int s = 0; s < sets; s++) {
            imk_repeatability r;
            imk_random_normals(source, i, (uint64_t)s * ROW, ROW, normal);
            draw(p, normal, value, sigma, freedom);
            if (imk_repeatability_estimate(p->runs, value, sigma, freedom, 0.95, &r, NULL) !=
                IMK_OK)
                return 1;
            above += r.lower > p->between;
            below += r.upper < p->between;
            held += r.lower <= p->between && p->between <= r.upper;
            significant += r.lower > 0.0;
            sum += r.value * r.value;
            square += r.value * r.value * r.value * r.value;
        }
        const double mean = sum / sets, spread = sqrt(square / sets - mean * mean);
        printf(
            "%2zu runs, between/within %.1f, freedom %2d: held %6.2f %% (too high %.2f %%, too low "
            "%.2f %%), bias of the variance %+.3f sigma, significant %.1f %%\n",
            p->runs, p->between, p->freedom, 100.0 * held / sets, 100.0 * above / sets,
            100.0 * below / sets, (mean - p->between * p->between) / spread,
            100.0 * significant / sets);
    }
    return 0;
}
