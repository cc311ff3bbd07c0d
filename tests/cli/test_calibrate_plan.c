/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate --plan -> imukit simulate -> imukit calibrate: a programme reaches what was
 * wanted of it, whatever the procedure. */
#include "run_command.h"

#include "imukit/model_file.h"
#include "imukit/model_parameter.h"

#define PLACE " --position '48.1 deg, 11.6 deg, 520 m' "

static imk_model read_model(const char *path)
{
    imk_model model;
    imk_error error;
    if (imk_model_read(path, &model, NULL, &error) != IMK_OK)
        fail_msg("%s: %s %s", path, error.field, error.expected);
    return model;
}

static void put_unit(void)
{
    put("unit.yaml",
        "imukit: 1\n"
        "gyro:\n"
        "  bias: {fixed: 0.5 -0.8 0.3 deg/s}\n"
        "  scale_factor: {fixed: 8000 -5000 3000 ppm}\n"
        "  misalignment: 2 -3 4 1 -2 3 mrad\n"
        "  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 1 deg/h}\n"
        "accel:\n"
        "  bias: {fixed: 20 -35 50 mg}\n"
        "  scale_factor: {fixed: -3000 6000 9000 ppm}\n"
        "  misalignment: 3 -2 0 4 0 0 mrad\n"
        "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h), bias_instability: 10 ug}\n");
}

/* Simulate and calibrate as the command says that one should: its own "Next" line. */
static void follow_advice(const char *output)
{
    char line[2000];
    const char *next = strstr(out, "Next: imukit simulate ");
    assert_non_null(next);
    const char *second = strstr(next, " && imukit ");
    assert_non_null(second);
    const char *first = next + strlen("Next: imukit ");
    const size_t end = strcspn(second, "\n");
    snprintf(line, sizeof line, "$I %.*s --seed 5 && $I %.*s -o %s", (int)(second - first), first,
             (int)(end - strlen(" && imukit ")), second + strlen(" && imukit "), output);
    if (run(line) != 0)
        fail_msg("%s: %s", line, err);
}

/* What is stated of a term is no more than was required, and holds: within 4.5 sigma of the truth
 * (six axes of a fixed seed; others pass). The factor that the residuals give to sigma scatters by
 * a tenth where they have fifty degrees of freedom. */
static void check_reached(const char *path, int sensor, int term, double requirement)
{
    const imk_model found = read_model(path), truth = read_model("unit.yaml");
    int checked = 0;
    for (int i = 0; i < 3; i++) {
        const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, (uint8_t)i, 0};
        imk_model copy = found;
        double *sigma;
        const double *value = imk_model_parameter_at(&copy, p, &sigma);
        if (!(*sigma > 0 && *sigma <= 1.1 * requirement))
            fail_msg("%s: 1 sigma %.3g, wanted %.3g", path, *sigma, requirement);
        CHECK_CLOSE(*value, imk_model_parameter_get(&truth, p), 4.5 * *sigma);
        checked++;
    }
    assert_int_equal(checked, 3);
}

static void programmes_reach_what_was_wanted(void **state)
{
    (void)state;
    static const struct {
        const char *procedure, *requirement;
        int sensor;
        double sigma;
    } cases[] = {{"multiposition", "accel.scale_factor 25 ppm", 1, 25e-6},
                 {"multiposition", "gyro.scale_factor 60 ppm", 0, 60e-6},
                 {"sixposition", "accel.scale_factor 45 ppm", 1, 45e-6},
                 {"rate-table", "gyro.scale_factor 100 ppm", 0, 100e-6},
                 {"tumble", "accel.scale_factor 20 ppm", 1, 20e-6}};
    put_unit();
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        if (check_skips(k, 2))
            continue;
        char line[500];
        snprintf(line, sizeof line,
                 "$I calibrate --plan unit.yaml -p %s" PLACE "--want '%s' --strict -o p.yaml",
                 cases[k].procedure, cases[k].requirement);
        if (run(line) != 0)
            fail_msg("%s: %s %s", line, out, err);
        follow_advice("found.yaml");
        check_reached("found.yaml", cases[k].sensor, IMK_MODEL_SCALE_FACTOR, cases[k].sigma);
    }
    sweep();
}

/* A Ferraris session is planned with whole turns, which the calibration finds by itself. Placement
 * of 0.1 degree limits what a turn tells to 278 ppm (0.1/360). */
static void turns_of_a_ferraris_session(void **state)
{
    (void)state;
    put_unit();
    assert_int_equal(run("$I calibrate --plan unit.yaml -p ferraris" PLACE
                         "--want 'gyro.scale_factor 300 ppm' --strict -o p.yaml"),
                     0);
    follow_advice("found.yaml");
    check_reached("found.yaml", 0, IMK_MODEL_SCALE_FACTOR, 300e-6);
    /* Better than that takes the session several times over, or a better placement. */
    assert_int_equal(run("$I calibrate --plan unit.yaml -p ferraris" PLACE
                         "--want 'gyro.scale_factor 100 ppm' --strict"),
                     0);
    assert_null(strstr(out, ": 9 steps"));
    assert_int_equal(run("$I calibrate --plan unit.yaml -p ferraris" PLACE
                         "--placement 0.02deg --want 'gyro.scale_factor 100 ppm' --strict"),
                     0);
    check_contains(out, ": 9 steps", "once");
    sweep();
}

/* Every temperature is soaked; the file is one for --temperature; what is wanted of the slope is
 * reached. A linear bias of 0.01 deg/s/K is found. */
static void temperatures_are_soaked(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\n"
                     "gyro:\n"
                     "  bias:\n"
                     "    fixed: 0.5 -0.8 0.3 deg/s\n"
                     "    temperature: {reference_temperature: 25 degC, valid_range: -40 80 degC, "
                     "coefficients: [0.01 0.01 0.01 deg/s/K]}\n"
                     "  noise: {angle_random_walk: 0.3 deg/sqrt(h), bias_instability: 1 deg/h}\n");
    assert_int_equal(run("$I calibrate --plan unit.yaml -p thermal -o t.yaml"), 0);
    check_contains(out, "Each temperature is held for 600 s until the unit has settled (--soak)",
                   "soak");
    check_contains(out, "Next: imukit simulate unit.yaml --temperature t.yaml --rate 10Hz", "next");
    read_text("t.yaml", out);
    check_contains(out, "imukit_temperature: 1\n", "t.yaml");
    check_contains(out, "  - soak 604 s\n", "t.yaml");
    assert_int_equal(run("$I calibrate --plan unit.yaml -p thermal --soak 2min -o t.yaml"), 0);
    /* Twelve holds of 124 s and ten ramps of 18 min; the turn to the first pose takes none. */
    assert_int_equal(run("$I simulate unit.yaml --temperature t.yaml --rate 2Hz --duration 12288s "
                         "-o t.csv && $I calibrate t.csv -p thermal -o found.yaml"),
                     0);
    const imk_model found = read_model("found.yaml");
    assert_true(found.gyro.bias.temperature.order >= 1);
    for (int i = 0; i < 3; i++) {
        const double slope = found.gyro.bias.temperature.coefficient[0].value[i];
        CHECK_RELATIVE(slope, 0.01 * 0.017453292519943295, 1e-2);
    }
    assert_int_equal(run("$I calibrate t.csv -p thermal --soak 2min"), 2);
    check_contains(err, "--soak is used with --plan only", "soak");
    check_message("$I calibrate --plan unit.yaml -p thermal --soak 1e308s", 2,
                  "imukit calibrate: error: --soak 1e308s: expected 0s to 1e6s\n" TRY("calibrate"));
    sweep();
}

/* A mounting that is not known limits what misalignments can be told, and only these. */
static void mounting_counts(void **state)
{
    (void)state;
    put_unit();
    assert_int_equal(run("$I calibrate --plan unit.yaml -p tumble" PLACE
                         "--want 'accel.misalignment 0.2 mrad, accel.scale_factor 50 ppm' "
                         "--strict"),
                     0);
    assert_int_equal(run("$I calibrate --plan unit.yaml -p tumble --mounting 0.1deg" PLACE
                         "--want 'accel.scale_factor 50 ppm' --strict"),
                     0);
    assert_int_equal(run("$I calibrate --plan unit.yaml -p tumble --mounting 0.1deg" PLACE
                         "--want 'accel.misalignment 0.2 mrad' --strict"),
                     1);
    check_contains(out, "not reached", "misalignment");
    sweep();
}

static void a_centrifuge_is_no_motion(void **state)
{
    (void)state;
    put_unit();
    assert_int_equal(run("$I calibrate --plan unit.yaml -p centrifuge" PLACE), 0);
    check_contains(out, "force +10 +0 +0 g", "levels");
    check_contains(out, "a motion file cannot describe the arm of a centrifuge", "why");
    assert_int_equal(run("$I calibrate --plan unit.yaml -p centrifuge -o p.yaml" PLACE), 2);
    check_contains(err, "leave --output out, and set the levels that the table shows",
                   "what to do");
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(programmes_reach_what_was_wanted),
        cmocka_unit_test(turns_of_a_ferraris_session),
        cmocka_unit_test(temperatures_are_soaked),
        cmocka_unit_test(mounting_counts),
        cmocka_unit_test(a_centrifuge_is_no_motion),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
