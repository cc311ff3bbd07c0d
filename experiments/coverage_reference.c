/* SPDX-License-Identifier: Apache-2.0 */
/* Do the stated intervals of the procedures with a reference hold the truth? Simulated bench tests
 * of raw samples at 100 Hz: rate table in steps and sines, tumble, centrifuge, spin, each unit with
 * errors of its own, white noise, bias instability, rounded increments and an encoder of 2e-7 rad.
 *
 * usage: coverage_reference [BENCHES] [SEED] [PROCEDURE]
 *
 * Prints for every parameter how often the 95 % interval holds the truth and the mean and root mean
 * square of the errors in sigmas; then the same with a tenth of the holds disturbed, with axes
 * whose noise is 1 : 4 : 16, where every hold is off by as much on each axis, some times the noise
 * of the quietest, both together, and with a unit that is placed worse than stated: on its fixture,
 * or in each face. Every unit has a g-sensitivity of 20 deg/h/g; some programmes do not tell it
 * from the bias, or do not estimate it. In the last ones the Earth turns, and the calibration does
 * not know the heading of the unit, or knows no more than the rate of the table. */
#include "../tests/calibrate/coverage.h"
#include "../tests/calibrate/reference_session.h"

#define DEGREE 0.017453292519943295

static const struct {
    const char *name;
    imk_procedure procedure;
    void (*programme)(session *);
    bool without_g;
    session_earth earth;
} programmes[] = {
    {"rate-table, steps", IMK_PROCEDURE_RATE_TABLE, session_rate_steps, false, SESSION_NO_EARTH},
    {"rate-table, sine", IMK_PROCEDURE_RATE_TABLE, session_rate_sine, false, SESSION_NO_EARTH},
    {"tumble", IMK_PROCEDURE_TUMBLE, session_tumble, false, SESSION_NO_EARTH},
    {"centrifuge", IMK_PROCEDURE_CENTRIFUGE, session_centrifuge, false, SESSION_NO_EARTH},
    {"spin", IMK_PROCEDURE_SPIN, session_spin, false, SESSION_NO_EARTH},
    {"rate-table, steps, three attitudes", IMK_PROCEDURE_RATE_TABLE, session_rate_upright, false,
     SESSION_NO_EARTH},
    {"rate-table, steps, three attitudes, g-sensitivity not estimated", IMK_PROCEDURE_RATE_TABLE,
     session_rate_upright, true, SESSION_NO_EARTH},
    {"tumble, g-sensitivity not estimated", IMK_PROCEDURE_TUMBLE, session_tumble, true,
     SESSION_NO_EARTH},
    {"centrifuge, g-sensitivity not estimated", IMK_PROCEDURE_CENTRIFUGE, session_centrifuge, true,
     SESSION_NO_EARTH},
    {"tumble, forces alone, one heading", IMK_PROCEDURE_TUMBLE, session_tumble, false,
     SESSION_ONE_HEADING},
    {"tumble, forces alone, another heading in each hold", IMK_PROCEDURE_TUMBLE, session_tumble,
     false, SESSION_HEADINGS},
    {"rate-table, steps, gyros alone and the rate of the table", IMK_PROCEDURE_RATE_TABLE,
     session_rate_one, false, SESSION_TABLE},
};

static const struct {
    const char *name;
    double bad, unequal, push[2], mounting, placement, stated;
} faults[] = {{"0 % bad", .unequal = 1.0},
              {"10 % bad", .bad = 0.1, .unequal = 1.0},
              {"axes 1 : 4 : 16", .unequal = 4.0},
              {"equal errors of holds", .unequal = 1.0, .push = {1e-4, 2e-3}},
              {"axes 1 : 4 : 16, equal errors of holds", .unequal = 4.0, .push = {1e-4, 2e-3}},
              {"mounting 0.3 deg, 0.1 stated, which no log tests", .unequal = 1.0,
               .mounting = 0.3 * DEGREE, .stated = 1.0 / 3.0},
              {"placement 0.1 deg", .unequal = 1.0, .placement = 0.1 * DEGREE, .stated = 1.0},
              {"placement 0.3 deg, 0.1 stated", .unequal = 1.0, .placement = 0.3 * DEGREE,
               .stated = 1.0 / 3.0},
              {"axes 1 : 4 : 16, placement 0.3 deg, 0.1 stated", .unequal = 4.0,
               .placement = 0.3 * DEGREE, .stated = 1.0 / 3.0}};

/* Only a tumble is told how well it is placed in each hold; where the g-sensitivity is not
 * estimated, errors of holds are what may be taken for it; where the Earth's rate is not known, the
 * scatter of the readings is what may be taken for it. */
static bool has_fault(size_t which, size_t fault)
{
    if (programmes[which].earth != SESSION_NO_EARTH &&
        (faults[fault].bad > 0.0 || faults[fault].mounting > 0.0 || faults[fault].placement > 0.0))
        return false;
    if (programmes[which].without_g && fault > 0 && !(faults[fault].push[0] > 0.0))
        return false;
    return !(faults[fault].placement > 0.0) || programmes[which].procedure == IMK_PROCEDURE_TUMBLE;
}

static void run(size_t which, size_t fault, size_t benches, uint64_t seed)
{
    session *b = malloc(sizeof *b);
    coverage_count count = {0};
    if (!b)
        return;
    session_start(b, programmes[which].procedure, programmes[which].programme);
    b->settings.g_sensitivity = !programmes[which].without_g;
    b->earth = programmes[which].earth;
    if (b->procedure == IMK_PROCEDURE_TUMBLE)
        b->settings.nonlinear = true;
    if (b->procedure == IMK_PROCEDURE_RATE_TABLE)
        b->settings.sine_block = 0.05;
    b->unequal = faults[fault].unequal;
    memcpy(b->push, faults[fault].push, sizeof b->push);
    b->mounting = faults[fault].mounting;
    b->placement = faults[fault].placement;
    b->stated = faults[fault].stated;
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
            if ((only < 0 || (size_t)only == i) && has_fault(i, fault))
                run(i, fault, benches, seed);
    return 0;
}
