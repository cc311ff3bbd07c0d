/* SPDX-License-Identifier: Apache-2.0 */
/* Do the intervals of a multi-position calibration hold the truth as often as they say?
 *
 *     coverage_multiposition [BENCHES] [SEED] [PLAN]     3000, 1 and all by default
 *
 * Whole bench tests are simulated (tests/calibrate/multiposition_session.h): 24 poses by hand, 120
 * s at 100 Hz, MEMS noise, counts, the Earth. Each goes through detection, procedure and solver.
 * Per parameter: the share of benches in which the 95 % interval holds the truth, and the bias of
 * the estimate in its own sigmas; then the same with a tenth of the poses spoilt; then with fewer
 * poses, with accelerometers of unequal noise, and with every pose off by 3 mm/s^2 on each of them,
 * alike. Fails where a share is outside 93 to 97 % beyond chance. */
#include "../tests/calibrate/multiposition_session.h"

typedef struct plan {
    int poses, bad;
    double ratio, push; /* noise of an axis over that of the one before; [m/s^2] */
} plan;

/* @return parameters outside the band beyond chance */
static size_t run_plan(multiposition_session *b, const plan *p, long benches, uint64_t seed)
{
    coverage_count sum = {0};
    size_t refused = 0, turns_refused = 0, turns = 0;
    session_truth(b);
    session_poses(b, p->poses);
    b->push = p->push;
    for (int axis = 1; axis < 3; axis++)
        b->truth.accel.noise.white.value[axis] =
            p->ratio * b->truth.accel.noise.white.value[axis - 1];
    for (long run = 0; run < benches; run++) {
        const imk_status status = session_run(b, seed, (uint32_t)run, p->bad, &sum);
        if (status != IMK_OK && sum.failed == 1)
            printf("bench %ld: %s %s\n", run, imk_status_name(status), b->error.field);
        refused += b->result.observations_refused;
        turns_refused += b->result.turns_refused;
        turns += b->calibration.turn_count;
    }
    printf("%ld benches, seed %llu, %d poses, %d bad, noise 1 : %g : %g, poses off by %g mm/s^2: "
           "%zu failed; a bench: %.2f turns, refused %.3f holds and %.3f turns\n",
           benches, (unsigned long long)seed, p->poses, p->bad, p->ratio, p->ratio * p->ratio,
           1e3 * p->push, sum.failed, (double)turns / (double)benches,
           (double)refused / (double)benches, (double)turns_refused / (double)benches);
    const size_t outside = sum.benches > 0 ? coverage_print(&sum, stdout) : 0;
    fflush(stdout);
    return outside;
}

int main(int count, char **arguments)
{
    static const plan plans[] = {{24, 0, 1.0, 0.0},  {24, 2, 1.0, 0.0},  {24, 0, 1.0, 3e-3},
                                 {24, 0, 2.0, 0.0},  {24, 0, 2.0, 3e-3}, {24, 0, 4.0, 0.0},
                                 {24, 0, 4.0, 3e-3}, {12, 0, 1.0, 0.0},  {12, 0, 1.0, 3e-3},
                                 {12, 0, 2.0, 3e-3}, {12, 0, 4.0, 0.0},  {12, 0, 4.0, 3e-3}};
    const long benches = count > 1 ? atol(arguments[1]) : 3000;
    const uint64_t seed = count > 2 ? strtoull(arguments[2], NULL, 10) : 1;
    const int only = count > 3 ? atoi(arguments[3]) : -1;
    size_t outside = 0;
    multiposition_session *b = session_start();
    if (!b)
        return EXIT_FAILURE;
    for (int i = 0; i < (int)(sizeof plans / sizeof *plans); i++)
        if (only < 0 || only == i)
            outside += run_plan(b, &plans[i], benches, seed);
    session_stop(b);
    return outside > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}
