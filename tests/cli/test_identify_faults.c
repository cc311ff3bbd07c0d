/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as they come from a bench: a fifth of the rows missing, a hole of five minutes, outliers of
 * 50 sigma, a warm-up. The parameters are those of the sound log, and the report says what was
 * found. */
#include "run_command.h"

#include "imukit/elementary.h"
#include "imukit/log.h"
#include "imukit/random.h"

#include <math.h>

enum { ROWS = 90000, AXES = 3 }; /* a quarter of an hour at 100 Hz */

/* Truth of the model below, SI. */
#define DEGREE (3.14159265358979323846 / 180)
static const double white = 0.3 * DEGREE / 60, flicker = 8 * DEGREE / 3600,
                    walk = 20 * DEGREE / 3600 / 60;

static double *columns[1 + AXES]; /* time and three gyros, sound */

static int make_log(void **state)
{
    if (set_up(state) != 0)
        return -1;
    put("model.yaml", "imukit: 1\nname: bench\ngyro:\n  noise:\n"
                      "    angle_random_walk: 0.3 deg/sqrt(h)\n"
                      "    bias_instability: 8 deg/h\n"
                      "    rate_random_walk: 20 deg/h/sqrt(h)\n");
    if (run("$I simulate model.yaml --rate 100Hz --duration 15min --seed 11 -o sound.npy") != 0) {
        print_error("%s", err);
        return -1;
    }
    imk_log log = {0};
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    CHECK_OK(imk_log_load("sound.npy", &settings, NULL, &log, NULL));
    for (int c = 0; c <= AXES; c++)
        columns[c] = malloc(ROWS * sizeof(double));
    for (size_t row = 0; row < ROWS; row++)
        columns[0][row] = 0.01 * (double)row;
    for (int axis = 0; axis < AXES; axis++) {
        const int from = imk_log_find(&log, IMK_QUANTITY_ANGULAR_RATE, axis);
        memcpy(columns[1 + axis], log.data[from], ROWS * sizeof(double));
    }
    imk_log_free(&log);
    return 0;
}

static int drop_log(void **state)
{
    for (int c = 0; c <= AXES; c++)
        free(columns[c]);
    sweep();
    return tear_down(state);
}

/* The rows for which `there` holds (NULL: all), with `added` on the gyros. */
static void write_log(const bool *there, const double *added)
{
    static double out_columns[1 + AXES][ROWS];
    imk_log_column names[1 + AXES];
    memset(names, 0, sizeof names);
    snprintf(names[0].name, sizeof names[0].name, "time");
    names[0].unit = imk_unit_of("s");
    names[0].quantity = IMK_QUANTITY_TIME;
    for (int axis = 0; axis < AXES; axis++) {
        snprintf(names[1 + axis].name, sizeof names[0].name, "gyro_%c", 'x' + axis);
        names[1 + axis].unit = imk_unit_of("rad/s");
        names[1 + axis].quantity = IMK_QUANTITY_ANGULAR_RATE;
        names[1 + axis].axis = axis;
    }
    const double *pointers[1 + AXES];
    size_t count = 0;
    for (size_t row = 0; row < ROWS; row++) {
        if (there && !there[row])
            continue;
        for (int c = 0; c <= AXES; c++)
            out_columns[c][count] = columns[c][row] + (c > 0 && added ? added[row] : 0);
        count++;
    }
    for (int c = 0; c <= AXES; c++)
        pointers[c] = out_columns[c];
    imk_log_writer *writer;
    CHECK_OK(imk_log_create("log.npy", 1 + AXES, names, IMK_LOG_SHORTEST, NULL, 0, &writer, NULL));
    CHECK_OK(imk_log_write(writer, count, pointers, NULL));
    CHECK_OK(imk_log_commit(writer, NULL));
}

static json_t *identify(const char *options)
{
    char line[300];
    snprintf(line, sizeof line, "$I identify log.npy --json %s", options);
    assert_int_equal(run(line), 0);
    json_t *root = json_loads(out, 0, NULL);
    assert_non_null(root);
    return root;
}

static json_t *channel_of(json_t *root, size_t axis)
{
    return json_array_get(json_object_get(json_object_get(root, "result"), "channels"), axis);
}

static const char *message(json_t *root, const char *code)
{
    json_t *verdict = json_object_get(json_object_get(root, "result"), "verdict");
    for (size_t k = 0; k < json_array_size(verdict); k++) {
        json_t *message = json_array_get(verdict, k);
        if (strcmp(json_string_value(json_object_get(message, "code")), code) == 0)
            return json_string_value(json_object_get(message, "message"));
    }
    return "";
}

static double number(json_t *object, const char *name)
{
    return json_number_value(json_object_get(object, name));
}

/* Values within six of their standard deviations, wrong in 2e-9 of cases each, and of the nine
 * intervals of 95 % at least four hold the truth: six misses or more come in 1.2e-6 of cases, and
 * fewer as a term at its bound covers more often. */
static void check_parameters(json_t *root)
{
    static const char *const names[] = {"angle_random_walk", "bias_instability",
                                        "rate_random_walk"};
    const double truth[] = {white, flicker, walk};
    int held = 0;
    for (size_t axis = 0; axis < AXES; axis++)
        for (size_t k = 0; k < 3; k++) {
            json_t *term =
                json_object_get(json_object_get(channel_of(root, axis), "terms"), names[k]);
            held += number(term, "lower") <= truth[k] && truth[k] <= number(term, "upper");
            if (json_is_true(json_object_get(term, "present")))
                CHECK_CLOSE(number(term, "value"), truth[k], 6 * number(term, "sigma"));
            else
                assert_true(number(term, "upper") > 0);
        }
    assert_true(held >= 4);
}

static void test_sound(void **state)
{
    (void)state;
    write_log(NULL, NULL);
    json_t *root = identify("");
    check_parameters(root);
    static const char *const codes[] = {"missing", "outliers", "stuck",          "at_limit",
                                        "steps",   "warm_up",  "warm_up_removed"};
    for (size_t k = 0; k < sizeof codes / sizeof codes[0]; k++)
        assert_string_equal(message(root, codes[k]), "");
    json_decref(root);
}

static void test_fifth_missing(void **state)
{
    (void)state;
    bool *there = malloc(ROWS);
    uint32_t *chance = malloc(ROWS * sizeof *chance);
    size_t missing = 0;
    imk_random_words(imk_random_seeded(3), 1, 0, ROWS, chance);
    for (size_t row = 0; row < ROWS; row++) {
        there[row] = row == 0 || row == ROWS - 1 || chance[row] >= 0.2 * 0x1p32;
        missing += !there[row];
    }
    write_log(there, NULL);
    json_t *root = identify("");
    check_parameters(root);
    assert_int_equal(json_integer_value(json_object_get(channel_of(root, 0), "missing")), missing);
    check_contains(message(root, "missing"), "gyro_x (20", "a fifth missing");
    json_decref(root);
    free(there);
    free(chance);
}

static void test_hole(void **state)
{
    (void)state;
    bool *there = malloc(ROWS);
    for (size_t row = 0; row < ROWS; row++)
        there[row] = row < 30000 || row >= 60000;
    write_log(there, NULL);
    json_t *root = identify("");
    check_parameters(root);
    check_contains(message(root, "missing"), "longest gap 300 s", "a hole");
    free(there);
    json_decref(root);
}

/* 0.1 % of the samples 50 standard deviations off, either way. */
static void test_outliers(void **state)
{
    (void)state;
    double *added = calloc(ROWS, sizeof *added);
    uint32_t *chance = malloc(ROWS * sizeof *chance);
    size_t planted = 0;
    imk_random_words(imk_random_seeded(4), 1, 0, ROWS, chance);
    for (size_t row = 0; row < ROWS; row++)
        if (chance[row] < 0.001 * 0x1p32) {
            added[row] = (planted++ % 2 ? 50 : -50) * white * 10; /* sigma of a sample at 100 Hz */
        }
    write_log(NULL, added);
    json_t *root = identify("");
    check_parameters(root);
    for (size_t axis = 0; axis < AXES; axis++) {
        json_t *found =
            json_object_get(json_object_get(channel_of(root, axis), "screening"), "outliers");
        const double samples = number(found, "samples");
        /* A false one comes in a thousand records; two, in one of a million. */
        assert_true(samples >= (double)planted && samples <= (double)planted + 1);
    }
    check_contains(message(root, "outliers"), "left out of the estimate", "outliers");
    json_decref(root);
    /* Kept, they make white noise 1.87 times as large: 1 + 0.001 50^2 in its square. */
    root = identify("--keep outliers");
    check_contains(message(root, "outliers"), "kept", "outliers kept");
    json_t *term =
        json_object_get(json_object_get(channel_of(root, 0), "terms"), "angle_random_walk");
    CHECK_CLOSE(number(term, "value"), white * sqrt(1 + 2500 * (double)planted / (double)ROWS),
                0.05 * white);
    json_decref(root);
    free(added);
    free(chance);
}

/* 0.1 deg/s off at the start, falling to a third within two minutes. */
static void test_warm_up(void **state)
{
    (void)state;
    double *added = malloc(ROWS * sizeof *added);
    for (size_t row = 0; row < ROWS; row++)
        added[row] = 0.1 * DEGREE * imk_exp(-columns[0][row] / 120);
    write_log(NULL, added);
    json_t *root = identify("");
    check_parameters(root);
    for (size_t axis = 0; axis < AXES; axis++) {
        json_t *found =
            json_object_get(json_object_get(channel_of(root, axis), "screening"), "warm_up");
        /* Slow noise shifts both by some per cent; this is no test of their sigmas. */
        CHECK_CLOSE(number(json_object_get(found, "amplitude"), "value"), 0.1 * DEGREE,
                    0.02 * DEGREE);
        CHECK_CLOSE(number(json_object_get(found, "time"), "value"), 120, 30);
    }
    check_contains(message(root, "warm_up_removed"), "subtracted", "warm-up");
    assert_string_equal(message(root, "warm_up"), "");
    json_decref(root);
    root = identify("--keep warm-up");
    check_contains(message(root, "warm_up_removed"), "kept", "warm-up kept");
    json_decref(root);
    free(added);
}

static void test_keep_message(void **state)
{
    (void)state;
    check_message("$I identify log.npy --keep outlier", 2,
                  "imukit identify: error: --keep: \"outlier\" is none of outliers, stuck, "
                  "saturated, warm-up, temperature, all\n" TRY("identify"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound),   cmocka_unit_test(test_fifth_missing),
        cmocka_unit_test(test_hole),    cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_warm_up), cmocka_unit_test(test_keep_message),
    };
    return cmocka_run_group_tests(tests, make_log, drop_log);
}
