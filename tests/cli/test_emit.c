/* SPDX-License-Identifier: Apache-2.0 */
/* imukit compensate MODEL --emit-c DIR: the code compiles as C99 without a warning and agrees with
 * imk_correct() within its bound on this machine; messages, refusals, JSON. On the processors it is
 * for: tools/check_firmware.sh. */
#include "run_command.h"

#include "compensate/firmware_models.h"

#include "imukit/firmware_file.h"
#include "imukit/model_file.h"

static const char main_file[] = "#include \"unit.h\"\n"
                                "#include <stdio.h>\n"
                                "int main(void)\n{\n"
                                "    printf(\"%lu\\n\", unit_self_test());\n    return 0;\n}\n";

static const char compile_line[] =
    "cc -std=c99 -O0 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wshadow "
    "-Wdouble-promotion -Werror -o run unit.c unit_test.c main.c && ./run";

static bool has_compiler(void)
{
    return run("command -v cc") == 0;
}

/* Compile what stands in this directory, run its self-test. */
static void check_code(const char *what)
{
    char line[512];
    put("main.c", main_file);
    snprintf(line, sizeof line, "cd . && %s", compile_line);
    if (run(line) != 0 || strcmp(out, "0\n") != 0) {
        print_error("%s: %s%s\n", what, out, err);
        fail();
    }
}

/* The models of tools/check_firmware.sh. 10 000 samples of single precision, in counts. */
static void test_self_tests(void **state)
{
    (void)state;
    static const char *const cases[][3] = {
        {"linear", "float", "10000"},   {"linear", "double", "500"},
        {"linear", "fixed", "2000"},    {"nonlinear", "float", "2000"},
        {"nonlinear", "double", "500"}, {"nonlinear", "fixed", "2000"}};
    if (!has_compiler()) {
        print_message("there is no cc: not run\n");
        skip();
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char line[512];
        snprintf(line, sizeof line,
                 "$I compensate " SOURCE_DIRECTORY
                 "/tests/firmware/%s.yaml --emit-c . --prefix unit "
                 "--arithmetic %s --vectors %s",
                 cases[i][0], cases[i][1], cases[i][2]);
        assert_int_equal(run(line), 0);
        check_code(line);
        sweep();
    }
}

/* Models with any of the terms, redundant axes, single sensors; the same bytes each time. */
static void test_random_models(void **state)
{
    (void)state;
    uint64_t random = 3;
    static imk_firmware plan;
    imk_firmware_file_settings files = imk_firmware_file_default();
    imk_error error;
    if (!has_compiler()) {
        print_message("there is no cc: not run\n");
        skip();
    }
    files.name = "unit";
    files.vectors = 200;
    for (int m = 0; m < 6; m++) {
        if (check_skips((size_t)m, 3))
            continue;
        const imk_model model = practical_model(&random, m < 3);
        imk_firmware_settings settings = imk_firmware_default();
        char what[32];
        settings.arithmetic = (imk_firmware_arithmetic)(m % 3);
        CHECK_OK(imk_firmware_plan(&plan, &model, &settings, &error));
        CHECK_OK(imk_firmware_write(".", &plan, &model, &files, &error));
        assert_int_equal(run("cat unit.h unit.c unit_test.c >first"), 0);
        CHECK_OK(imk_firmware_write(".", &plan, &model, &files, &error));
        assert_int_equal(run("cat unit.h unit.c unit_test.c | cmp - first"), 0);
        snprintf(what, sizeof what, "random model %d", m);
        check_code(what);
        sweep();
    }
}

/* A wrong constant is found: else the tests above would mean nothing. */
static void test_self_test_can_fail(void **state)
{
    (void)state;
    if (!has_compiler()) {
        print_message("there is no cc: not run\n");
        skip();
    }
    assert_int_equal(run("$I compensate " SOURCE_DIRECTORY
                         "/tests/firmware/linear.yaml --emit-c . --prefix unit"),
                     0);
    /* The scale of an accelerometer, cut off after four hexadecimal digits. */
    assert_int_equal(
        run("sed -i '/force.0. per accel.0./s/\\(0x1\\.[0-9a-f]\\{4\\}\\)[0-9a-f]*/\\1/' "
            "unit.c"),
        0);
    put("main.c", main_file);
    assert_int_equal(run(compile_line), 0);
    assert_string_not_equal(out, "0\n");
    sweep();
}

static const char unit_model[] =
    "imukit: 1\nname: My unit, no. 7*/\n"
    "gyro: {bias: {fixed: 0.25 rad/s, warm_up: {amplitude: 0.1 rad/s, time: 60 s}}, range: 4 rad/s,"
    " noise: {angle_random_walk: 0.1 deg/sqrt(h)}}\n"
    "accel: {bias: {fixed: 0.5 m/s^2}, lever_arm: [1 0 0 mm, 0 0 0 mm, 0 0 0 mm], range: 10 g}\n";

static void test_messages(void **state)
{
    (void)state;
    put("unit.yaml", unit_model);
    /* 4.4 rad/s (the range and a tenth) and its bias are below 8: u = 2^-24, of the reading less
     * the bias, and that of the bias itself; with those of imk_correct(), 2.6e-07. */
    check_message(
        "$I compensate unit.yaml --emit-c made", 0,
        "imukit compensate: warning: the code does not correct gyro.bias.warm_up, which needs more "
        "than one sample; imukit compensate LOG MODEL takes it out of a log\nimukit compensate: "
        "warning: the code does not correct accel.lever_arm, which needs more than one sample; "
        "imukit compensate LOG MODEL takes it out of a log\nUsable with care, as it leaves in 2 "
        "terms that need more than one sample: the rate is exact to 2.5e-07 rad/s up to 4.4 rad/s, "
        "the force is exact to 5.9e-06 m/s^2 up to 107.9 m/s^2.\n\nTaken out: gyro.bias.fixed, "
        "accel.bias.fixed\nLeft in: gyro.bias.warm_up, gyro.noise, accel.lever_arm\nThe rate is "
        "within 2.5e-07 rad/s of the exact correction up to 4.4 rad/s\nThe force is within 5.9e-06 "
        "m/s^2 of the exact correction up to 107.9 m/s^2\n0 multiplications, 6 additions, 12 "
        "comparisons a sample\nWrote "
        "made/imukit_my_unit_no_7.h, .c and _test.c. Next, for example:\n    arm-none-eabi-gcc "
        "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -O2 -c made/imukit_my_unit_no_7.c\n");
    assert_string_equal(out, "");
    assert_int_equal(run("cd made && ls && rm -r ../made"), 0);
    assert_string_equal(
        out, "imukit_my_unit_no_7.c\nimukit_my_unit_no_7.h\nimukit_my_unit_no_7_test.c\n");
    /* A name in the model does not end the comment. */
    assert_int_equal(run("$I compensate unit.yaml --emit-c . --json --strict --prefix unit"), 1);
    json_t *document = json_loads(out, 0, NULL), *result = json_object_get(document, "result");
    assert_string_equal(json_string_value(json_array_get(json_object_get(result, "files"), 1)),
                        "./unit.c");
    assert_int_equal(json_array_size(json_object_get(result, "taken_out")), 2);
    assert_int_equal(json_array_size(json_object_get(document, "findings")), 2);
    assert_int_equal(
        json_integer_value(json_object_get(json_object_get(result, "cost"), "additions")), 6);
    json_decref(document);
    /* One made before is replaced, a foreign one is not. */
    assert_int_equal(run("$I compensate unit.yaml --emit-c . --prefix unit"), 0);
    put("unit.c", "int main(void) { return 0; }\n");
    check_message("$I compensate unit.yaml --emit-c . --prefix unit --without warm_up,lever_arm", 1,
                  "imukit compensate: warning: the code does not correct gyro.bias.warm_up, which "
                  "needs more than one sample; imukit compensate LOG MODEL takes it out of a "
                  "log\nimukit compensate: warning: the code does not correct accel.lever_arm, "
                  "which needs more than one sample; imukit compensate LOG MODEL takes it out of a "
                  "log\nimukit compensate: error: ./unit.c: this file was not made by --emit-c and "
                  "is not replaced; give another --prefix or directory\n");
    assert_int_equal(run("cat unit.c"), 0);
    assert_string_equal(out, "int main(void) { return 0; }\n");
    sweep();
}

/* The comparisons of a sample without flags, counted in the code: each side of a condition, two in
 * clip() and one in size(). */
static const char count_line[] =
    "awk '/^unsigned/ { inside = 1 } inside { n += 2 * gsub(/clip\\(/, \"\") + gsub(/size\\(/, "
    "\"\"); gsub(/>>|->/, \"\"); n += gsub(/[<>]/, \"\") } END { print n }' unit.c";

static void test_comparisons(void **state)
{
    (void)state;
    static const char *const kinds[] = {"float", "double", "fixed"};
    static const char *const models[] = {"linear", "nonlinear"};
    for (int k = 0; k < 6; k++) {
        char line[500];
        snprintf(line, sizeof line,
                 "$I compensate " SOURCE_DIRECTORY "/tests/firmware/%s.yaml --emit-c . --prefix "
                 "unit --arithmetic %s --json",
                 models[k / 3], kinds[k % 3]);
        assert_int_equal(run(line), 0);
        json_t *document = json_loads(out, 0, NULL), *result = json_object_get(document, "result");
        const json_t *cost = json_object_get(result, "cost");
        const long long stated = json_integer_value(json_object_get(cost, "comparisons"));
        json_decref(document);
        assert_int_equal(run(count_line), 0);
        assert_int_equal(strtoll(out, NULL, 10), stated);
    }
    sweep();
}

static void test_refusals(void **state)
{
    (void)state;
    put("unit.yaml", unit_model);
    put("any.yaml", "imukit: 1\ngyro: {bias: {fixed: 1 deg/s}}\n");
    put("file", "");
    check_message(
        "$I compensate unit.yaml", 2,
        "imukit compensate: error: an operand is missing: imukit compensate LOG MODEL\n" TRY(
            "compensate"));
    check_message("$I compensate log.csv unit.yaml --emit-c .", 2,
                  "imukit compensate: error: --emit-c makes code from the model alone: imukit "
                  "compensate MODEL --emit-c DIR\n" TRY("compensate"));
    check_message("$I compensate unit.yaml --emit-c . -o x", 2,
                  "imukit compensate: error: --emit-c writes into its directory: leave --output "
                  "out\n" TRY("compensate"));
    check_message(
        "$I compensate unit.yaml --emit-c . --vectors 0", 2,
        "imukit compensate: error: --vectors 0: expected 1 to 1000000\n" TRY("compensate"));
    check_message("$I compensate any.yaml --emit-c . --prefix 7up --rate-limit 9rad/s", 1,
                  "imukit compensate: error: prefix: an argument is not valid: 7up; expected a "
                  "name of letters, digits and _, "
                  "at most 47, that does not begin with a digit\n");
    check_message("$I compensate any.yaml --emit-c . --arithmetic fixed", 1,
                  "imukit compensate: error: any.yaml: gyro.range: a required key is missing; add "
                  "the range, or "
                  "--rate-limit and --force-limit: fixed point needs the largest values\n");
    check_message("$I compensate any.yaml --emit-c file", 1,
                  "imukit compensate: warning: the model states no gyro.range: the code sets its "
                  "flag LIMIT beyond 35 rad/s; add the range to the model, or give "
                  "--rate-limit\nimukit compensate: error: file/imukit_unit.h: the file cannot be "
                  "opened: Not a "
                  "directory; check the path\n");
    assert_int_equal(run("$I compensate any.yaml --emit-c . --arithmetic fixed --rate-limit "
                         "300deg/s"),
                     0);
    assert_int_equal(sweep(), 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_self_tests),         cmocka_unit_test(test_random_models),
        cmocka_unit_test(test_self_test_can_fail), cmocka_unit_test(test_messages),
        cmocka_unit_test(test_comparisons),        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
