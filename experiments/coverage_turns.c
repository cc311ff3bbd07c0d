/* SPDX-License-Identifier: Apache-2.0 */
/* Do intervals of turns hold the truth as often as they say?
 *
 * usage: coverage_turns [BENCHES] [SEED] [PLAN]
 *
 * Simulates whole bench tests of gyros alone, raw samples with noise, instability, quantization,
 * angles and faces that are off, an unknown g-sensitivity and the turning Earth
 * (tests/calibrate/turns_session.h), calibrates each, and prints per parameter how often the 95 %
 * interval held the truth and the bias in sigmas. In the last plans the placement is three times
 * what the calibration is told; `doubted` counts the benches whose repetitions show that with a
 * probability of 1e-3. */
#include "../tests/calibrate/turns_session.h"

#include <stdio.h>

#define DEGREE 0.017453292519943295

typedef struct plan {
    const char *name;
    turns_plan session;
} plan;

static bool is_doubted(const imk_procedure_findings *findings)
{
    const imk_turns_findings *f = &findings->known_turns;
    return f->freedom > 0.0 && imk_gamma_upper(0.5 * f->freedom, 0.5 * f->chi_square) < 1e-3;
}

int main(int argc, char **argv)
{
    static const plan plans[] = {
        {"one turn about each axis, placement 0.1 deg",
         {.pairs = 0, .angle = BENCH_TURN, .placement = 0.1 * DEGREE}},
        {"forth and back, placement 0.1 deg",
         {.pairs = 1, .angle = BENCH_TURN, .placement = 0.1 * DEGREE}},
        {"five times forth and back, placement 0.1 deg",
         {.pairs = 5, .angle = BENCH_TURN, .placement = 0.1 * DEGREE}},
        {"five times forth and back, placement 0.005 deg",
         {.pairs = 5, .angle = BENCH_TURN, .placement = 0.005 * DEGREE}},
        {"twice forth and back by 90 deg, placement 0.1 deg",
         {.pairs = 2, .angle = 0.25 * BENCH_TURN, .placement = 0.1 * DEGREE}},
        {"twice forth and back, instability 200 deg/h, placement 0.02 deg",
         {.pairs = 2, .angle = BENCH_TURN, .placement = 0.02 * DEGREE, .instability = 100.0}},
        {"twice forth and back, white noise 3 deg/sqrt(h), placement 0.02 deg",
         {.pairs = 2, .angle = BENCH_TURN, .placement = 0.02 * DEGREE, .white = 10.0}},
        {"gyro_z alone, forth and back, placement 0.1 deg",
         {.pairs = 1, .angle = BENCH_TURN, .placement = 0.1 * DEGREE, .one_gyro = true}},
        {"wrong: one turn about each axis, placement 0.3 deg, 0.1 stated",
         {.pairs = 0, .angle = BENCH_TURN, .placement = 0.3 * DEGREE, .stated = 1.0 / 3.0}},
        {"wrong: forth and back, placement 0.3 deg, 0.1 stated",
         {.pairs = 1, .angle = BENCH_TURN, .placement = 0.3 * DEGREE, .stated = 1.0 / 3.0}},
        {"wrong: five times forth and back, placement 0.3 deg, 0.1 stated",
         {.pairs = 5, .angle = BENCH_TURN, .placement = 0.3 * DEGREE, .stated = 1.0 / 3.0}},
        {"wrong: gyro_z alone, forth and back, placement 0.3 deg, 0.1 stated",
         {.pairs = 1,
          .angle = BENCH_TURN,
          .placement = 0.3 * DEGREE,
          .stated = 1.0 / 3.0,
          .one_gyro = true}}};
    const int benches = argc > 1 ? atoi(argv[1]) : 1000;
    const uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    const size_t only = argc > 3 ? (size_t)atoi(argv[3]) : sizeof plans;
    if (benches < 1) {
        fputs("usage: coverage_turns [BENCHES] [SEED] [PLAN]\n", stderr);
        return 2;
    }
    session *b = session_new();
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        static coverage_count count;
        size_t doubted = 0;
        if (only < sizeof plans && only != i)
            continue;
        memset(&count, 0, sizeof count);
        for (int n = 0; n < benches; n++) {
            imk_error error;
            if (turns_run(b, &plans[i].session, seed, (uint32_t)n, &error)) {
                coverage_add(&count, &b->result, &b->truth, 0.95);
                doubted += is_doubted(&b->findings);
            } else if (count.failed++ == 0) {
                printf("bench %d: %s %s %s\n", n, imk_status_name(error.status), error.field,
                       error.expected);
            }
        }
        printf("%s: %zu benches, %zu refused, %zu doubted\n", plans[i].name, count.benches,
               count.failed, doubted);
        if (count.benches > 0)
            coverage_print(&count, stdout);
        fflush(stdout);
    }
    session_free(b);
    return 0;
}
