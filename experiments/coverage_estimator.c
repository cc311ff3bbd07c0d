/* SPDX-License-Identifier: Apache-2.0 */
/* Do the estimator's intervals hold the truth as often as they say? Usage: coverage_estimator
 * [BENCHES] [SEED]. Observations are drawn, not samples: means with normal errors, at poses under
 * gravity with any heading, at known rates and forces, and both. Signals beyond white noise belong
 * to the procedures' own experiments; here sigmas are stated right, three times too small, and
 * a tenth of the poses have a force that is 3 % off. Then the same as tables of pose means
 * (--pose-means), with and without their standard deviations, by the job; [BENCHES] [SEED] means
 * makes only these. */
#include "../tests/calibrate/means_bench.h"

#include "imukit/distributions.h"

typedef struct kind {
    const char *name;
    int poses, bad, known;
    double understated;
    bool reference; /* attitudes are known: the reference frame, all parameters */
    bool unknown_latitude;
} kind;

static void make(session *b, const kind *k)
{
    b->understated = k->understated;
    if (k->unknown_latitude) { /* anywhere on a sphere */
        b->place = asin(2.0 * imk_normal_probability(session_normal(b)) - 1.0);
        b->calibration.latitude = (double)NAN;
    }
    if (k->reference) {
        b->calibration.frame = IMK_FRAME_REFERENCE;
        b->truth.accel.misalignment.value[1][0] = -.002;
        b->truth.accel.misalignment.value[2][0] = .0015;
        b->truth.accel.misalignment.value[2][1] = -.001;
        session_free_all(b);
    } else {
        session_free_static(b);
    }
    session_know_the_rest(b);
    for (int i = 0; i < k->poses; i++)
        session_pose(b, i < k->bad ? 1.03 : 1.0);
    for (int i = 0; i < k->known; i++)
        session_known(b);
}

static void run(const kind *k, size_t benches, uint64_t seed)
{
    coverage_count count;
    size_t refused = 0, poses = 0;
    memset(&count, 0, sizeof count);
    for (size_t i = 0; i < benches; i++) {
        session *b = session_new(seed, (uint32_t)i);
        make(b, k);
        if (session_solve(b) == IMK_OK) {
            coverage_add(&count, &b->result, &b->truth, 0.95);
            refused += b->result.observations_refused;
            poses += b->calibration.observation_count;
        } else {
            count.failed++;
        }
        session_free(b);
    }
    printf("%s: %zu benches, %zu not solved; %.2f %% of the observations refused\n", k->name,
           count.benches, count.failed, 100.0 * (double)refused / (double)poses);
    coverage_print(&count, stdout);
}

static void run_tables(size_t benches, uint64_t seed)
{
    static const double tenth = 0.0017453292519943296; /* of a degree */
    static const means_plan plans[] = {
        {"table of 24 poses", 24, .understated = 1},
        {"table of 14 poses", 14, .understated = 1},
        {"table of 24 poses in counts", 24, .understated = 1, .counts = true},
        {"table of 24 poses, 2 bad", 24, .bad = 2, .understated = 1},
        {"table of 24 poses, deviations and samples", 24, .stated = true, .understated = 1},
        {"table of 14 poses, deviations and samples", 14, .stated = true, .understated = 1},
        {"the same in counts", 14, .stated = true, .understated = 1, .counts = true},
        {"table of 24 poses, deviations three times too small", 24, .stated = true,
         .understated = 3},
        {"table of faces, three times", .rounds = 3, .placement = tenth, .understated = 1},
        {"table of faces, exact, once", .rounds = 1, .understated = 1},
        {"table of faces, once, deviations and samples", .rounds = 1, .placement = tenth,
         .stated = true, .understated = 1},
    };
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        coverage_count count;
        memset(&count, 0, sizeof count);
        for (size_t k = 0; k < benches; k++) {
            imk_error error;
            if (means_run(&plans[i], seed, (uint32_t)k, &count, &error) != IMK_OK &&
                count.failed == 1)
                printf("table %zu: %s %s %s\n", k, imk_status_name(error.status), error.field,
                       error.expected);
        }
        printf("%s: %zu benches, %zu not solved\n", plans[i].name, count.benches, count.failed);
        coverage_print(&count, stdout);
    }
}

int main(int argc, char **argv)
{
    static const kind kinds[] = {
        {"24 poses under gravity", 24, 0, 0, 1.0, false, false},
        {"24 poses, sigmas three times too small", 24, 0, 0, 3.0, false, false},
        {"24 poses, latitude unknown", 24, 0, 0, 1.0, false, true},
        {"24 poses, 3 bad", 24, 3, 0, 1.0, false, false},
        {"20 known inputs", 0, 0, 20, 1.0, true, false},
        {"16 poses and 12 known inputs", 16, 0, 12, 1.0, true, false},
        {"16 poses, 2 bad, and 12 known inputs", 16, 2, 12, 3.0, true, false},
    };
    const size_t benches = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 3000;
    const uint64_t seed = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    for (size_t i = 0; argc <= 3 && i < sizeof kinds / sizeof *kinds; i++)
        run(&kinds[i], benches, seed);
    run_tables(benches, seed);
    return 0;
}
