/* SPDX-License-Identifier: Apache-2.0 */
/* Do intervals of a magnetometer's hard iron, soft iron and alignment hold the truth as often as
 * they say?
 *
 * usage: coverage_magnetometer [BENCHES] [SEED] [PLAN]
 *
 * Simulates benches from samples (tests/calibrate/magnetometer_bench.h), calibrates each, and
 * prints per parameter how often the 95 % interval held the truth, the bias in sigmas, and the
 * share of benches whose residuals are doubted. */
#include "../tests/calibrate/magnetometer_bench.h"

#include "imukit/distributions.h"

#include <stdio.h>

typedef struct plan {
    const char *name;
    mag_bench_plan bench;
} plan;

typedef struct counts {
    int done, refused_benches, doubted;
    double refused;
    int held[IMK_MAGNETOMETER_PARAMETERS];
    double sum[IMK_MAGNETOMETER_PARAMETERS], square[IMK_MAGNETOMETER_PARAMETERS];
} counts;

static void count(const mag_bench *b, counts *c)
{
    const imk_magnetometer_result *r = &b->result;
    const double t = imk_student_quantile(0.975, r->freedom);
    c->done++;
    c->refused += (double)r->refused;
    c->doubted += r->rms[0] > 0.005 * r->value[IMK_MAGNETOMETER_FIELD] && r->added > 0;
    for (int p = 0; p < IMK_MAGNETOMETER_PARAMETERS; p++) {
        const double z = (r->value[p] - b->truth[p]) / r->sigma[p];
        c->held[p] += fabs(z) < t;
        c->sum[p] += z;
        c->square[p] += z * z;
    }
}

static void print(const char *name, const counts *c)
{
    static const char *const names[IMK_MAGNETOMETER_PARAMETERS] = {
        "hard iron x", "hard iron y", "hard iron z", "xx", "xy", "xz",    "yx",
        "yy",          "yz",          "zx",          "zy", "zz", "field", "sin(dip)"};
    printf("%s: %d benches, %d not solved, %.2f observations refused, %.1f %% doubted\n", name,
           c->done, c->refused_benches, c->refused / c->done, 100.0 * c->doubted / c->done);
    for (int p = 0; p < IMK_MAGNETOMETER_PARAMETERS; p++) {
        const double n = c->done;
        if (isfinite(c->square[p]) && c->square[p] > 0.0)
            printf("  %-12s held %6.2f %%   bias %+.3f sigma   rms %.3f sigma\n", names[p],
                   100.0 * c->held[p] / n, c->sum[p] / n, sqrt(c->square[p] / n));
    }
}

int main(int argc, char **argv)
{
    static const plan plans[] = {
        {"24 rests of 4 s",
         {.rests = 24,
          .rows = 400,
          .noise = 0.3e-6,
          .up_sigma = 1e-4,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"24 rests of 4 s, field known to 0.1 uT, dip 0",
         {.rests = 24,
          .rows = 400,
          .noise = 0.3e-6,
          .up_sigma = 1e-4,
          .field = 30e-6,
          .dip = 0.0,
          .field_sigma = 0.1e-6}},
        {"24 rests of 4 s, a reading held for 10 rows, step 0.15 uT",
         {.rests = 24,
          .rows = 400,
          .held = 10,
          .noise = 0.3e-6,
          .step = 0.15e-6,
          .up_sigma = 1e-4,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"24 rests of 4 s, noise 0.03 uT, step 0.3 uT",
         {.rests = 24,
          .rows = 400,
          .noise = 0.03e-6,
          .step = 0.3e-6,
          .up_sigma = 1e-4,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"24 rests of 4 s, field differs by 0.5 uT",
         {.rests = 24,
          .rows = 400,
          .noise = 0.3e-6,
          .disturbance = 0.5e-6,
          .up_sigma = 1e-4,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"30 rests of 4 s, a tenth beside steel",
         {.rests = 30,
          .rows = 400,
          .noise = 0.3e-6,
          .bad = 0.1,
          .up_sigma = 1e-4,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"24 rests of 4 s, the vertical is the larger error, and a third larger than stated",
         {.rests = 24,
          .rows = 400,
          .noise = 0.1e-6,
          .up_sigma = 2e-3,
          .up_stated = 1.5e-3,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}},
        {"24 rests of 4 s, no accelerometers",
         {.rests = 24,
          .rows = 400,
          .noise = 0.3e-6,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1,
          .no_up = true}},
        {"turned for 60 s, no accelerometers",
         {.rows = 6000,
          .noise = 0.5e-6,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1,
          .no_up = true}},
        {"turned for 60 s, noise 2 uT, a reading held for 5 rows",
         {.rows = 6000,
          .held = 5,
          .noise = 2e-6,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = 0,
          .no_up = true}},
        {"turned for 60 s, field wanders by 0.5 uT",
         {.rows = 6000,
          .noise = 0.3e-6,
          .wander = 0.5e-6,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1,
          .no_up = true}},
        {"24 rests of 0.1 s, noise 2 uT",
         {.rests = 24,
          .rows = 10,
          .noise = 2e-6,
          .up_sigma = 1e-3,
          .field = 48e-6,
          .dip = 1.1,
          .field_sigma = -1}}};
    const int benches = argc > 1 ? atoi(argv[1]) : 1000;
    const uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    const size_t only = argc > 3 ? (size_t)atoi(argv[3]) : sizeof plans;
    mag_bench *b = calloc(1, sizeof *b);
    if (benches < 1 || !b) {
        fputs("usage: coverage_magnetometer [BENCHES] [SEED] [PLAN]\n", stderr);
        free(b);
        return 2;
    }
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        counts c = {.done = 0};
        if (only < sizeof plans && only != i)
            continue;
        /* A minute of single readings takes as long as hundred rests. */
        const int runs = plans[i].bench.rests > 0 ? benches : (benches + 1) / 2;
        for (int n = 0; n < runs; n++)
            if (mag_bench_run(b, &plans[i].bench, seed, (uint32_t)n) == IMK_OK)
                count(b, &c);
            else
                c.refused_benches++;
        print(plans[i].name, &c);
        fflush(stdout);
    }
    free(b);
    return 0;
}
