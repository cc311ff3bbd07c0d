/* SPDX-License-Identifier: Apache-2.0 */
/* Do intervals of sixposition and ferraris hold the truth as often as they say?
 *
 * usage: coverage_six_position [BENCHES] [SEED]
 *
 * Simulates whole bench tests, raw samples with noise, instability, quantization, placement errors
 * and the turning Earth (tests/calibrate/six_position_session.h), calibrates each, and prints per
 * parameter how often the 95 % interval held the truth and the bias in sigmas. The last plans have
 * 10 % bad poses. */
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
         {5, 8, 6, 1.7e-3, 0.1}}};
    const int benches = argc > 1 ? atoi(argv[1]) : 3000;
    const uint64_t seed = argc > 2 ? (uint64_t)atoll(argv[2]) : 1;
    if (benches < 1) {
        fputs("usage: coverage_six_position [BENCHES] [SEED]\n", stderr);
        return 2;
    }
    session *b = session_new();
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        static coverage_count count;
        memset(&count, 0, sizeof count);
        for (int n = 0; n < benches; n++) {
            imk_error error;
            if (session_run(b, &plans[i].session, plans[i].procedure, seed, (uint32_t)n, &error)) {
                coverage_add(&count, &b->result, &b->truth, 0.95);
            } else if (count.failed++ == 0) {
                printf("bench %d: %s %s %s\n", n, imk_status_name(error.status), error.field,
                       error.expected);
            }
        }
        printf("%s: %zu benches, %zu refused\n", plans[i].name, count.benches, count.failed);
        if (count.benches > 0)
            coverage_print(&count, stdout);
        fflush(stdout);
    }
    session_free(b);
    return 0;
}
