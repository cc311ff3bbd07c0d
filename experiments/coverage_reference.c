/* SPDX-License-Identifier: Apache-2.0 */
/* Do the stated intervals of the procedures with a reference hold the truth? Simulated bench tests
 * of raw samples at 100 Hz: rate table in steps and sines, tumble, centrifuge, spin, each unit with
 * errors of its own, white noise, bias instability, rounded increments and an encoder of 2e-7 rad.
 *
 * usage: coverage_reference [BENCHES] [SEED] [PROCEDURE]
 *
 * Prints for every parameter how often the 95 % interval holds the truth and the mean and root mean
 * square of the errors in sigmas; then the same with a tenth of the holds disturbed, with axes
 * whose noise is 1 : 4 : 16, and where besides every hold is off by as much on each axis, some
 * times the noise of the quietest. Every unit has a g-sensitivity of 20 deg/h/g; the last two
 * programmes do not tell it from the bias. Of sines, in blocks of 50 ms, a tenth of BENCHES are
 * done, of spins a fifth. */
#include "../tests/calibrate/coverage.h"
#include "../tests/calibrate/reference_session.h"

static const struct {
    const char *name;
    imk_procedure procedure;
    void (*programme)(session *);
    size_t part; /* of the benches asked for: thousands of observations take their time */
    bool without_g;
} programmes[] = {
    {"rate-table, steps", IMK_PROCEDURE_RATE_TABLE, session_rate_steps, 1, false},
    {"rate-table, sine", IMK_PROCEDURE_RATE_TABLE, session_rate_sine, 10, false},
    {"tumble", IMK_PROCEDURE_TUMBLE, session_tumble, 1, false},
    {"centrifuge", IMK_PROCEDURE_CENTRIFUGE, session_centrifuge, 1, false},
    {"spin", IMK_PROCEDURE_SPIN, session_spin, 5, false},
    {"rate-table, steps, three attitudes", IMK_PROCEDURE_RATE_TABLE, session_rate_upright, 1,
     false},
    {"rate-table, steps, three attitudes, g-sensitivity not estimated", IMK_PROCEDURE_RATE_TABLE,
     session_rate_upright, 1, true},
};

static const struct {
    const char *name;
    double bad, unequal, push[2];
} faults[] = {{"0 % bad", 0.0, 1.0, {0.0, 0.0}},
              {"10 % bad", 0.1, 1.0, {0.0, 0.0}},
              {"axes 1 : 4 : 16", 0.0, 4.0, {0.0, 0.0}},
              {"axes 1 : 4 : 16, equal errors of holds", 0.0, 4.0, {1e-4, 2e-3}}};

static void run(size_t which, size_t fault, size_t benches, uint64_t seed)
{
    session *b = malloc(sizeof *b);
    coverage_count count = {0};
    if (!b)
        return;
    session_start(b, programmes[which].procedure, programmes[which].programme);
    b->settings.g_sensitivity = !programmes[which].without_g;
    if (b->procedure == IMK_PROCEDURE_TUMBLE)
        b->settings.nonlinear = true;
    if (b->procedure == IMK_PROCEDURE_RATE_TABLE)
        b->settings.sine_block = 0.05;
    b->unequal = faults[fault].unequal;
    memcpy(b->push, faults[fault].push, sizeof b->push);
    for (size_t i = 0; i < benches; i++) {
        imk_error error;
        session_log(b, seed * 1000000 + i, faults[fault].bad);
        if (session_solve(b, &error) == IMK_OK) {
            coverage_take(&count, &b->calibration, &b->result, &b->truth);
            continue;
        }
        if (count.failed++ == 0)
            printf("%s: %s %s %g %g\n", imk_status_name(error.status), error.field, error.expected,
                   error.value, error.limit);
    }
    printf("%s, %s: %zu benches, %zu refused, %zu observations, not determined:",
           programmes[which].name, faults[fault].name, count.benches, count.failed,
           b->findings.observations);
    for (size_t i = 0; i < b->findings.undetermined_count && i < IMK_UNDETERMINED_MAX; i++) {
        char name[IMK_MODEL_PARAMETER_NAME];
        if (imk_model_parameter_name(b->findings.undetermined[i], name) == IMK_OK)
            printf(" %s", name);
    }
    printf("\n  factors %.3f %.3f, refused %zu\n", b->result.group[IMK_GROUP_GYRO].factor,
           b->result.group[IMK_GROUP_ACCEL].factor, b->result.observations_refused);
    coverage_print(&count, stdout);
    free(b->workspace);
    free(b);
}

int main(int argc, char **argv)
{
    const size_t benches = argc > 1 ? (size_t)atol(argv[1]) : 3000;
    const uint64_t seed = argc > 2 ? (uint64_t)atol(argv[2]) : 1;
    const int only = argc > 3 ? atoi(argv[3]) : -1;
    for (size_t i = 0; i < sizeof programmes / sizeof *programmes; i++)
        for (size_t fault = 0; fault < sizeof faults / sizeof *faults; fault++)
            if (only < 0 || (size_t)only == i)
                run(i, fault, (benches + programmes[i].part - 1) / programmes[i].part, seed);
    return 0;
}
