/* SPDX-License-Identifier: Apache-2.0 */
/* Do the intervals of a multi-position calibration hold the truth as often as they say?
 *
 *     coverage_multiposition [BENCHES] [SEED]        3000 and 1 by default
 *
 * Whole bench tests are simulated (tests/calibrate/multiposition_session.h): 24 poses by hand, 120
 * s at 100 Hz, MEMS noise, counts, the Earth. Each goes through detection, procedure and solver.
 * Per parameter: the share of benches in which the 95 % interval holds the truth, and the bias of
 * the estimate in its own sigmas; then the same with a tenth of the poses spoilt; then with noise
 * of the accelerometers of 1 : 2 : 4 and every pose off by 3 mm/s^2 on each of them. */
#include "../tests/calibrate/multiposition_session.h"

int main(int count, char **arguments)
{
    const long benches = count > 1 ? atol(arguments[1]) : 3000;
    const uint64_t seed = count > 2 ? strtoull(arguments[2], NULL, 10) : 1;
    multiposition_session *b = session_start();
    if (!b)
        return EXIT_FAILURE;
    for (int way = 0; way < 3; way++) {
        const int bad = way == 1 ? BENCH_POSES / 10 : 0;
        b->push = way == 2 ? 3e-3 : 0.0;
        for (int axis = 1; way == 2 && axis < 3; axis++)
            b->truth.accel.noise.white.value[axis] =
                2.0 * b->truth.accel.noise.white.value[axis - 1];
        coverage_count sum = {0};
        size_t refused = 0, turns_refused = 0, turns = 0;
        for (long run = 0; run < benches; run++) {
            const imk_status status = session_run(b, seed, (uint32_t)run, bad, &sum);
            if (status != IMK_OK)
                fprintf(stderr, "bench %ld: %s %s\n", run, imk_status_name(status), b->error.field);
            refused += b->result.observations_refused;
            turns_refused += b->result.turns_refused;
            turns += b->calibration.turn_count;
        }
        printf("%ld benches, seed %llu, %d bad poses of %d%s: %zu failed; a bench: %.2f turns, "
               "refused %.3f holds and %.3f turns\n",
               benches, (unsigned long long)seed, bad, BENCH_POSES,
               way == 2 ? ", unequal axes, equal pose errors" : "", sum.failed,
               (double)turns / (double)benches, (double)refused / (double)benches,
               (double)turns_refused / (double)benches);
        if (sum.benches > 0)
            coverage_print(&sum, stdout);
    }
    session_stop(b);
    return EXIT_SUCCESS;
}
