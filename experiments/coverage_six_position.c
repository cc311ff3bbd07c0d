/* SPDX-License-Identifier: Apache-2.0 */
/* Do intervals of sixposition and ferraris hold the truth as often as they say?
 *
 * usage: coverage_six_position [BENCHES] [SEED] [PLAN]
 *
 * Simulates whole bench tests, raw samples with noise, instability, quantization, placement errors
 * and the turning Earth (tests/calibrate/six_position_session.h), calibrates each, and prints per
 * parameter how often the 95 % interval held the truth and the bias in sigmas. Two
 * plans have 10 % bad poses; in the last ones the placement is not what the calibration is told,
 * or the axes differ in noise while every pose errs alike on all of them. */
#include "../tests/calibrate/six_position_session.h"

#include <stdio.h>

typedef struct plan {
    const char *name;
    imk_procedure procedure;
    session_plan session;
} plan;

int main(int argc, char **argv)
{
    static const plan plans[] = {
        {"sixposition, each face once, exact", IMK_PROCEDURE_SIXPOSITION, {1, 8, 0, 0, 0}},
        {"sixposition, each face once, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {1, 8, 0, 1.7e-3, 0}},
        {"sixposition, each face three times, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {3, 8, 0, 1.7e-3, 0}},
        {"ferraris, exact", IMK_PROCEDURE_FERRARIS, {1, 8, 6, 0, 0}},
        {"ferraris, three times, placement 0.1 deg", IMK_PROCEDURE_FERRARIS, {3, 8, 6, 1.7e-3, 0}},
        {"sixposition, five times, placement 0.1 deg, 10 % bad poses",
         IMK_PROCEDURE_SIXPOSITION,
         {5, 8, 0, 1.7e-3, 0.1}},
        {"ferraris, five times, placement 0.1 deg, 10 % bad poses",
         IMK_PROCEDURE_FERRARIS,
         {5, 8, 6, 1.7e-3, 0.1}},
        {"wrong: sixposition, each face once, placement 0.3 deg, 0.1 stated",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .placement = 5.2e-3, .stated = 1.0 / 3.0}},
        {"wrong: sixposition, each face three times, placement 0.3 deg, 0.1 stated",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .placement = 5.2e-3, .stated = 1.0 / 3.0}},
        {"wrong: sixposition, each face once, placement 0.15 deg, 0.1 stated",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .placement = 2.6e-3, .stated = 2.0 / 3.0}},
        {"wrong: ferraris, once, placement 0.3 deg, 0.1 stated",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 1, .hold = 8, .turn = 6, .placement = 5.2e-3, .stated = 1.0 / 3.0}},
        {"wrong: ferraris, three times, placement 0.3 deg, 0.1 stated",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 3, .hold = 8, .turn = 6, .placement = 5.2e-3, .stated = 1.0 / 3.0}},
        {"equal pose errors: sixposition, exact, each face once",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .unequal = 1.0, .push = 3e-3}},
        {"axes 1 : 2 : 4, equal pose errors: sixposition, exact, each face once",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .unequal = 2.0, .push = 3e-3}},
        {"axes 1 : 4 : 16, equal pose errors: sixposition, exact, each face once",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .unequal = 4.0, .push = 3e-3}},
        {"axes 1 : 4 : 16: sixposition, exact, each face once",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .unequal = 4.0}},
        {"axes 1 : 2 : 4, equal pose errors: sixposition, exact, each face three times",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .unequal = 2.0, .push = 3e-3}},
        {"axes 1 : 4 : 16, equal pose errors: sixposition, exact, each face three times",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .unequal = 4.0, .push = 3e-3}},
        {"equal pose errors: sixposition, once, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .placement = 1.7e-3, .unequal = 1.0, .push = 3e-3}},
        {"axes 1 : 2 : 4: sixposition, once, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .placement = 1.7e-3, .unequal = 2.0}},
        {"axes 1 : 2 : 4: sixposition, three times, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .placement = 1.7e-3, .unequal = 2.0}},
        {"axes 1 : 2 : 4, equal pose errors: sixposition, once, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 1, .hold = 8, .placement = 1.7e-3, .unequal = 2.0, .push = 3e-3}},
        {"axes 1 : 2 : 4, equal pose errors: sixposition, three times, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .placement = 1.7e-3, .unequal = 2.0, .push = 3e-3}},
        {"axes 1 : 4 : 16, equal pose errors: sixposition, three times, placement 0.1 deg",
         IMK_PROCEDURE_SIXPOSITION,
         {.rounds = 3, .hold = 8, .placement = 1.7e-3, .unequal = 4.0, .push = 3e-3}},
        {"axes 1 : 2 : 4, equal pose errors: ferraris, three times, placement 0.1 deg",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 3, .hold = 8, .turn = 6, .placement = 1.7e-3, .unequal = 2.0, .push = 3e-3}},
        {"axes 1 : 4 : 16, equal pose errors: ferraris, three times, placement 0.1 deg",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 3, .hold = 8, .turn = 6, .placement = 1.7e-3, .unequal = 4.0, .push = 3e-3}},
        {"ferraris without labels, a rest after each turn, placement 0.1 deg",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 1, .hold = 5, .turn = 6, .placement = 1.7e-3, .unlabelled = true}},
        {"ferraris without labels, three times, a rest after each turn, placement 0.1 deg",
         IMK_PROCEDURE_FERRARIS,
         {.rounds = 3, .hold = 5, .turn = 6, .placement = 1.7e-3, .unlabelled = true}}};
    const int benches = argc > 1 ? atoi(argv[1]) : 3000;
    const uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    const size_t only = argc > 3 ? (size_t)atoi(argv[3]) : sizeof plans;
    if (benches < 1) {
        fputs("usage: coverage_six_position [BENCHES] [SEED] [PLAN]\n", stderr);
        return 2;
    }
    size_t outside = 0;
    session *b = session_new();
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        static coverage_count count;
        if (only < sizeof plans && only != i)
            continue;
        memset(&count, 0, sizeof count);
        for (int n = 0; n < benches; n++) {
            imk_error error;
            if (session_run(b, &plans[i].session, plans[i].procedure, seed, (uint32_t)n, &error)) {
                coverage_take(&count, &b->calibration, &b->result, &b->truth);
            } else if (count.failed++ == 0) {
                printf("bench %d: %s %s %s\n", n, imk_status_name(error.status), error.field,
                       error.expected);
            }
        }
        printf("%s: %zu benches, %zu refused\n", plans[i].name, count.benches, count.failed);
        if (count.benches > 0)
            outside += coverage_print(&count, stdout);
        fflush(stdout);
    }
    session_free(b);
    return outside > 0;
}
