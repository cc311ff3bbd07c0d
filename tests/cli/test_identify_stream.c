/* SPDX-License-Identifier: Apache-2.0 */
/* Long logs, identified without being held: the same messages on what is missing as for short
 * ones, the whole length told, and the truth found. */
#include "run_command.h"

#include "imukit/log.h"
#include "imukit/random.h"

enum { ROWS = 2200000, BLOCK = 50000, HOLE_FROM = 1000000, HOLE = 1500 };

/* White noise of 1e-4 rad/sqrt(s) at 100 Hz and a random walk of 1e-6 rad/s/sqrt(s); the rows of a
 * hole of 15 s left out, one value not a number. */
static void write_log(const char *path, bool hole)
{
    static double time[BLOCK], rate[BLOCK], steps[BLOCK];
    imk_log_column columns[2];
    memset(columns, 0, sizeof columns);
    snprintf(columns[0].name, sizeof columns[0].name, "time");
    columns[0].unit = imk_unit_of("s");
    columns[0].quantity = IMK_QUANTITY_TIME;
    snprintf(columns[1].name, sizeof columns[1].name, "gyro_x");
    columns[1].unit = imk_unit_of("rad/s");
    columns[1].quantity = IMK_QUANTITY_ANGULAR_RATE;
    imk_log_writer *writer;
    CHECK_OK(imk_log_create(path, 2, columns, IMK_LOG_SHORTEST, NULL, 0, &writer, NULL));
    const imk_random random = imk_random_seeded(1);
    const double *pointers[] = {time, rate};
    double level = 0;
    for (size_t row = 0; row < ROWS; row += BLOCK) {
        size_t count = 0;
        imk_random_normals(random, 1, row, BLOCK, rate);
        imk_random_normals(random, 2, row, BLOCK, steps);
        for (size_t i = 0; i < BLOCK; i++) {
            const size_t place = row + i;
            level += 1e-7 * steps[i];
            if (hole && place >= HOLE_FROM && place < HOLE_FROM + HOLE)
                continue;
            time[count] = 0.01 * (double)place;
            rate[count++] = hole && place == 77 ? (double)NAN : 1e-3 * rate[i] + level;
        }
        CHECK_OK(imk_log_write(writer, count, pointers, NULL));
    }
    CHECK_OK(imk_log_commit(writer, NULL));
}

/* Run identify on the log; its warnings stay in err. */
static json_t *identify(const char *options)
{
    char line[600];
    snprintf(line, sizeof line, "$I identify long.npy %s --json", options);
    assert_int_equal(run(line), 0);
    json_t *root = json_loads(out, 0, NULL);
    assert_non_null(root);
    return root;
}

static void remove_log(void)
{
    remove("long.npy");
    remove("long.npy.columns");
}

static json_int_t rows_of(json_t *root)
{
    return json_integer_value(json_object_get(json_object_get(root, "inputs"), "rows"));
}

/* A value within six of its standard deviations of the truth: wrong in 2e-9 of cases. */
static void check_term(json_t *root, const char *name, double truth)
{
    json_t *channels = json_object_get(json_object_get(root, "result"), "channels");
    json_t *term = json_object_get(json_object_get(json_array_get(channels, 0), "terms"), name);
    assert_true(json_is_true(json_object_get(term, "present")));
    CHECK_CLOSE(json_number_value(json_object_get(term, "value")), truth,
                6 * json_number_value(json_object_get(term, "sigma")));
}

static void test_long_log(void **state)
{
    (void)state;
    write_log("long.npy", false);
    json_t *root = identify("");
    assert_string_equal(err, "");
    assert_int_equal(rows_of(root), ROWS);
    check_term(root, "angle_random_walk", 1e-4);
    check_term(root, "rate_random_walk", 1e-6);
    json_decref(root);
    /* The same bytes from one thread and from two. */
    if (!check_quick()) {
        char *serial = malloc(TEXT_SIZE);
        assert_int_equal(run("$I identify long.npy --json --threads 1"), 0);
        strcpy(serial, out);
        assert_int_equal(run("$I identify long.npy --json --threads 2"), 0);
        assert_string_equal(out, serial);
        free(serial);
    }
    remove_log();
}

static void test_long_log_with_a_hole(void **state)
{
    (void)state;
    write_log("long.npy", true);
    json_t *root = identify("");
    check_contains(out, "longest gap 15 s", "");
    check_contains(
        out, "1 row with a value that is not a finite number or beyond 1e60, first in row 78", "");
    assert_int_equal(rows_of(root), ROWS);
    check_term(root, "angle_random_walk", 1e-4);
    check_term(root, "rate_random_walk", 1e-6);
    json_decref(root);
    /* Another policy sees the whole log. */
    assert_int_equal(run("$I identify long.npy --gaps refuse"), 1);
    check_contains(
        err, "1 row with a value that is not a finite number or beyond 1e60, first in row 78", "");
    root = identify("--gaps longest");
    assert_int_equal(rows_of(root), ROWS - HOLE_FROM - HOLE);
    json_decref(root);
    remove_log();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_long_log),
                                       cmocka_unit_test(test_long_log_with_a_hole)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
