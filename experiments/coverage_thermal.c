/* SPDX-License-Identifier: Apache-2.0 */
/* How often the intervals of the thermal analysis hold the truth.
 *
 * usage: coverage_thermal [BENCHES] [SEED]
 *
 * Simulates BENCHES (3000) temperature sweeps of raw samples, see
 * tests/calibrate/thermal_session.h, and prints per axis which orders and causes were found, and
 * per parameter the share held by the 95 % interval and the bias in sigmas; then the same with a
 * tenth of the log disturbed. */
#include "../tests/calibrate/thermal_session.h"

static thermal_session session;

static int run(size_t benches, uint64_t seed, bool knocks)
{
    static thermal_count count;
    const imk_thermal_settings settings = imk_thermal_default();
    memset(&count, 0, sizeof count);
    for (size_t k = 0; k < benches; k++) {
        if (!thermal_run(&session, 1000003 * seed + k, knocks) ||
            imk_thermal_analyse(&session.record, &settings, &session.nominal, &session.findings,
                                session.workspace, imk_thermal_workspace_size(),
                                &session.error) != IMK_OK) {
            count.failed++;
            continue;
        }
        thermal_add(&count, &session);
    }
    printf("%zu benches, %zu failed%s\n", count.benches, count.failed,
           knocks ? ", a tenth of each log disturbed" : "");
    thermal_print(&count, stdout);
    return count.failed > 0;
}

int main(int argc, char **argv)
{
    const size_t benches = argc > 1 ? strtoul(argv[1], NULL, 10) : 3000;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    thermal_truth(&session);
    if (!thermal_open(&session))
        return 1;
    const int bad = run(benches, seed, false) + run(benches, seed, true);
    thermal_close(&session);
    return bad;
}
