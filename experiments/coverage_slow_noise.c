/* SPDX-License-Identifier: Apache-2.0 */
/* Do the stated intervals hold the truth when the noise is slower than the test? Rate table in
 * steps and tumble as in coverage_reference.c, raw samples at 100 Hz, of units whose gyros have a
 * bias instability of 5 deg/h at 0.15 deg/sqrt(h), and whose accelerometers
 * have 30 ug at 50 ug/sqrt(Hz); then with a random walk and a Gauss-Markov process of a
 * minute besides. Once the calibration is told the noise, once not.
 *
 * usage: coverage_slow_noise [BENCHES] [SEED]
 *
 * Prints for every parameter how often the 95 % interval holds the truth and the mean and root mean
 * square of the errors in sigmas. Without the noise told a tenth of BENCHES are done. 3000 take
 * about 2 minutes. */
#include "../tests/calibrate/coverage.h"
#include "../tests/calibrate/slow_units.h"

static const struct {
    const char *name;
    imk_procedure procedure;
    void (*programme)(session *);
    void (*slower)(imk_model *);
} programmes[] = {
    {"rate-table, flicker", IMK_PROCEDURE_RATE_TABLE, session_rate_steps, slow_flicker},
    {"rate-table, flicker, random walk and Gauss-Markov", IMK_PROCEDURE_RATE_TABLE,
     session_rate_steps, slow_all},
    {"tumble, flicker", IMK_PROCEDURE_TUMBLE, session_tumble, slow_flicker},
    {"tumble, flicker, random walk and Gauss-Markov", IMK_PROCEDURE_TUMBLE, session_tumble,
     slow_all},
};

static void run(size_t which, size_t benches, uint64_t seed, bool known)
{
    session *b = malloc(sizeof *b);
    coverage_count count = {0};
    if (!b)
        return;
    session_start(b, programmes[which].procedure, programmes[which].programme);
    b->settings.nonlinear = true;
    b->slower = programmes[which].slower;
    b->noise_known = known;
    double factor[2] = {0.0, 0.0};
    for (size_t i = 0; i < benches; i++) {
        session_log(b, seed * 1000000 + i, 0.0);
        if (session_solve(b, NULL) != IMK_OK) {
            count.failed++;
            continue;
        }
        coverage_add(&count, &b->result, &b->truth, 0.95);
        for (int g = 0; g < 2; g++)
            factor[g] += b->result.group[g].factor / (double)benches;
    }
    printf("%s, %s: %zu benches, %zu refused, mean factors %.3f %.3f\n", programmes[which].name,
           known ? "noise known" : "noise not known", count.benches, count.failed, factor[0],
           factor[1]);
    coverage_print(&count, stdout);
    free(b->workspace);
    free(b);
}

int main(int argc, char **argv)
{
    const size_t benches = argc > 1 ? (size_t)atol(argv[1]) : 3000;
    const uint64_t seed = argc > 2 ? (uint64_t)atol(argv[2]) : 1;
    for (size_t i = 0; i < sizeof programmes / sizeof *programmes; i++) {
        run(i, benches, seed, true);
        run(i, (benches + 9) / 10, seed, false);
    }
    return 0;
}
