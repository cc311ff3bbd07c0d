/* SPDX-License-Identifier: Apache-2.0 */
/* imukit calibrate: the Ferraris session with its published matrices, readings that fall where the
 * input rises, and power cycles compared by whole calibrations. */
#include "run_command.h"

#include "imukit/model_file.h"

#define SESSION SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz"
#define EXPECTED SHARED_DIRECTORY "/data/reference/ferraris_session_expected.json"
#define FERRARIS                                                                                   \
    "$I calibrate " SESSION " -p ferraris --gravity 9.81m/s^2 --turn-angle -360deg --rate "        \
    "204.8Hz "

static const double degree = 0.017453292519943295;

static imk_model read_model(const char *path)
{
    imk_model model;
    imk_error error;
    if (imk_model_read(path, &model, NULL, &error) != IMK_OK)
        fail_msg("%s: %s %s", path, error.field, error.expected);
    return model;
}

static double number(const json_t *list, int row, int column)
{
    const json_t *item = json_array_get(list, (size_t)row);
    if (column >= 0)
        item = json_array_get(item, (size_t)column);
    assert_true(json_is_number(item));
    return json_number_value(item);
}

static bool session_is_there(void)
{
    if (access(SESSION, R_OK) == 0 && access(EXPECTED, R_OK) == 0)
        return true;
    print_message("[ SKIPPED ] %s is not there\n", SESSION);
    return false;
}

/* Every element of every matrix to 1e-12 of itself: the conventions of golden.md, which the options
 * state, and the readings as they are (--trim 0s). Angles are degrees in the file expected. */
static void published_matrices(void **state)
{
    (void)state;
    if (!session_is_there())
        skip();
    assert_int_equal(run(FERRARIS "--trim 0s --estimator closed-form --json -o found.yaml"), 0);
    assert_string_equal(err, "");
    json_t *all = json_loads(out, 0, NULL), *due = json_load_file(EXPECTED, 0, NULL);
    assert_non_null(all);
    assert_non_null(due);
    const json_t *form = json_object_get(json_object_get(all, "result"), "closed_form");
    if (!form)
        form = json_object_get(all, "closed_form");
    static const char *const names[2] = {"gyro", "accel"};
    static const char *const keys[2][3] = {{"K_g", "R_g", "b_g"}, {"K_a", "R_a", "b_a"}};
    for (int sensor = 0; sensor < 2; sensor++) {
        const json_t *triad = json_object_get(form, names[sensor]);
        const double unit = sensor == 0 ? degree : 1;
        assert_string_equal(json_string_value(json_object_get(triad, "reading_unit")), "count");
        for (int i = 0; i < 3; i++) {
            CHECK_RELATIVE(unit * number(json_object_get(triad, "scale"), i, -1),
                           number(json_object_get(due, keys[sensor][0]), i, i), 1e-12);
            CHECK_RELATIVE(number(json_object_get(triad, "bias"), i, -1),
                           number(json_object_get(due, keys[sensor][2]), i, -1), 1e-12);
            for (int j = 0; j < 3; j++)
                CHECK_RELATIVE(number(json_object_get(triad, "axes"), i, j),
                               number(json_object_get(due, keys[sensor][1]), i, j), 1e-12);
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            CHECK_RELATIVE(number(json_object_get(form, "g_sensitivity"), i, j),
                           number(json_object_get(due, "K_ga"), i, j), 1e-12);
    json_decref(all);
    json_decref(due);
    const imk_model model = read_model("found.yaml");
    check_contains(model.gyro_evidence.method, "ferraris, closed form", "method");
    assert_int_equal(run(FERRARIS "--estimator closed-form --without g_sensitivity"), 2);
    check_contains(err, "leave --estimate, --with and --without out", "fixed");
    assert_int_equal(run("$I calibrate " SESSION " -p sixposition --gravity 9.81m/s^2 --rate "
                         "204.8Hz --estimator closed-form"),
                     2);
    check_contains(err, "solves one log of --procedure ferraris only", "procedure");
    sweep();
}

/* Turns of -360 degrees are gyros that read less the more they turn: the sensitivity found is
 * negative. Both estimators agree within what placements on the faces explain, 0.1 degree of a full
 * turn and 1.7 mrad; turned the other way round the same comes out with the other sign. */
static void readings_may_fall_with_the_input(void **state)
{
    (void)state;
    if (!session_is_there())
        skip();
    assert_int_equal(run(FERRARIS "-o likely.yaml"), 0);
    assert_int_equal(run(FERRARIS "--estimator closed-form -o closed.yaml"), 0);
    assert_int_equal(run("$I calibrate " SESSION
                         " -p ferraris --gravity 9.81m/s^2 --rate 204.8Hz -o other.yaml"),
                     0);
    const imk_model a = read_model("likely.yaml"), b = read_model("closed.yaml"),
                    c = read_model("other.yaml");
    for (int i = 0; i < 3; i++) {
        const double likely =
            a.gyro.sensitivity.value[i] * (1 + a.gyro.scale_factor.fixed.value[i]);
        const double closed =
            b.gyro.sensitivity.value[i] * (1 + b.gyro.scale_factor.fixed.value[i]);
        const double other = c.gyro.sensitivity.value[i] * (1 + c.gyro.scale_factor.fixed.value[i]);
        assert_true(a.gyro.sensitivity.value[i] < 0 && b.gyro.sensitivity.value[i] < 0);
        assert_true(c.gyro.sensitivity.value[i] > 0);
        CHECK_RELATIVE(likely, closed, 1e-3);
        CHECK_RELATIVE(likely, -other, 1e-5);
    }
    /* The same counts with that sensitivity given. */
    assert_int_equal(run(FERRARIS "--model likely.yaml -o again.yaml"), 0);
    const imk_model d = read_model("again.yaml");
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(d.gyro.scale_factor.fixed.value[i], a.gyro.scale_factor.fixed.value[i], 1e-5);
    sweep();
}

/* Accelerometers and gyros of which one axis is mounted the other way round, in counts, through the
 * procedures that need no reference and those that do. */
static void one_axis_the_other_way_round(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\n"
                     "gyro:\n"
                     "  sensitivity: 4778 -4778 4778 count/(rad/s)\n"
                     "  scale_factor: {fixed: 8000 -5000 3000 ppm}\n"
                     "  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                     "accel:\n"
                     "  sensitivity: 2000 2000 -2000 count/(m/s^2)\n"
                     "  scale_factor: {fixed: -3000 6000 9000 ppm}\n"
                     "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n");
    put("known.yaml", "imukit: 1\n"
                      "gyro:\n"
                      "  sensitivity: 4778 -4778 4778 count/(rad/s)\n"
                      "  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                      "accel:\n"
                      "  sensitivity: 2000 2000 -2000 count/(m/s^2)\n"
                      "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n");
    static const char *const procedures[] = {"multiposition", "sixposition", "rate-table",
                                             "tumble"};
    for (int k = 0; k < 4; k++) {
        char line[600];
        snprintf(line, sizeof line,
                 "$I calibrate --plan known.yaml -p %s --gravity 9.80620m/s^2 -o p.yaml --json > "
                 "p.json && $I simulate unit.yaml --motion p.yaml --rate 50Hz --duration 200s -o "
                 "b.csv && $I calibrate b.csv -p %s %s --gravity 9.80620m/s^2 --model known.yaml "
                 "-o found.yaml",
                 procedures[k], procedures[k], k > 1 ? "--motion p.yaml" : "");
        if (run(line) != 0)
            fail_msg("%s: %s", line, err);
        const imk_model found = read_model("found.yaml"), truth = read_model("unit.yaml");
        for (int i = 0; i < 3; i++) {
            if (found.gyro.scale_factor.fixed.sigma[i] > 0)
                CHECK_CLOSE(found.gyro.scale_factor.fixed.value[i],
                            truth.gyro.scale_factor.fixed.value[i],
                            4.5 * found.gyro.scale_factor.fixed.sigma[i]);
            if (found.accel.scale_factor.fixed.sigma[i] > 0)
                CHECK_CLOSE(found.accel.scale_factor.fixed.value[i],
                            truth.accel.scale_factor.fixed.value[i],
                            4.5 * found.accel.scale_factor.fixed.sigma[i]);
        }
    }
    sweep();
}

/* Eight power cycles, each calibrated by itself: 1 sigma from run to run of biases and of scale
 * factors, the truth within its interval of 95 % on this seed but for one of six in a while, which
 * is allowed (two of six outside: 3 %; the seed is fixed). */
static void models_of_runs_are_compared(void **state)
{
    (void)state;
    put("unit.yaml", "imukit: 1\n"
                     "gyro:\n  noise: {angle_random_walk: 0.3 deg/sqrt(h)}\n"
                     "accel:\n"
                     "  bias: {fixed: 20 -35 50 mg, repeatability: 3 mg}\n"
                     "  scale_factor: {fixed: -3000 6000 9000 ppm, repeatability: 500 ppm}\n"
                     "  noise: {velocity_random_walk: 0.05 m/s/sqrt(h)}\n");
    put("six.yaml", "imukit_motion: 1\nsteps:\n  - hold 4 s\n  - pose 90 0 0 deg in 2 s\n  - hold "
                    "4 s\n  - pose 180 0 0 deg in 2 s\n  - hold 4 s\n  - pose -90 0 0 deg in 2 s\n "
                    " - hold 4 s\n  - pose 0 88 0 deg in 2 s\n  - pose 0 90 0 deg in 1 s\n  - hold "
                    "4 s\n  - pose 0 -90 0 deg in 3 s\n  - hold 4 s\n");
    assert_int_equal(run("for k in 1 2 3 4 5 6 7 8; do $I simulate unit.yaml --motion six.yaml "
                         "--rate 50Hz --duration 36s --run $k -o r.csv && $I calibrate r.csv -p "
                         "sixposition --placement 0.01deg --gravity 9.80620m/s^2 -o r$k.yaml || "
                         "exit 1; done"),
                     0);
    assert_int_equal(run("$I calibrate r?.yaml -p repeatability --into unit.yaml -o all.yaml"), 0);
    check_contains(out, "scale factor, 1 sigma from run to run", "table");
    check_contains(out, "bias, 1 sigma from run to run", "table");
    const imk_model model = read_model("all.yaml");
    const imk_evidence *evidence = &model.accel_evidence;
    int checked = 0, outside = 0;
    for (int k = 0; k < evidence->interval_count; k++) {
        const bool bias = strcmp(evidence->interval[k].key, "bias.repeatability") == 0;
        if (!bias && strcmp(evidence->interval[k].key, "scale_factor.repeatability") != 0)
            continue;
        const double due = bias ? 3e-3 * 9.80665 : 500e-6;
        for (int i = 0; i < 3; i++) {
            checked++;
            outside += !(evidence->interval[k].lower.value[i] < due &&
                         due < evidence->interval[k].upper.value[i]);
            /* Of eight runs the interval reaches from 0.66 to 2.04 of what was found. */
            CHECK_BELOW(evidence->interval[k].upper.value[i], 6 * due);
        }
    }
    assert_int_equal(checked, 6);
    assert_true(outside <= 1);
    check_contains(evidence->method, "repeatability of 8 runs", "method");
    assert_int_equal(run("$I calibrate r1.yaml -p repeatability"), 1);
    check_contains(err, "1 run: at least two are needed, better ten", "one");
    assert_int_equal(run("$I calibrate r1.yaml r.csv -p repeatability"), 2);
    check_contains(err, "r.csv is a log and others are models", "mixed");
    assert_int_equal(run("$I calibrate r1.yaml unit.yaml -p repeatability"), 1);
    check_contains(err, "unit.yaml states no uncertainty of bias or scale factor", "no sigma");
    sweep();
}

/* What rounds to nothing has no sign: six faces that read the same both ways. */
static void nothing_has_no_sign(void **state)
{
    (void)state;
    const char *line =
        "$I calibrate six.csv -p sixposition --gravity 9.81m/s^2 --placement 0deg --no-earth";
    FILE *file = fopen("six.csv", "wb");
    assert_non_null(file);
    fprintf(file, "time [s],section,accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n");
    for (int k = 0; k < 1200; k++) {
        const double noise = (k % 4 == 0 || k % 4 == 3 ? 0.01 : -0.01) * (1 + k / 4 % 2);
        fprintf(file, "%.2f,f%d", k * 0.01, k / 200);
        for (int j = 0; j < 3; j++)
            fprintf(file, ",%.7f",
                    (k / 400 == j ? 9.81 * (1 - 2 * (k / 200 % 2)) : 0.0) - 2e-6 +
                        noise * (1 + 0.1 * j));
        fputc('\n', file);
    }
    fclose(file);
    assert_int_equal(run(line), 0);
    check_contains(out, "scale factor error  ppm   0.000 ± ", line);
    assert_null(strstr(out, " -0.000 ± "));
    sweep();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_has_no_sign),
        cmocka_unit_test(published_matrices),
        cmocka_unit_test(readings_may_fall_with_the_input),
        cmocka_unit_test(one_axis_the_other_way_round),
        cmocka_unit_test(models_of_runs_are_compared),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
