/* SPDX-License-Identifier: Apache-2.0 */
/* What a count is, as data sheets write it. Expected values by the definitions of the degree
 * (pi/180 rad) and of g (9.80665 m/s^2, CGPM 1901). */
#include "check.h"

#include "imukit/units.h"

#include <string.h>

static const double degree = 3.14159265358979323846 / 180, g = 9.80665;

static imk_status parse(const char *text, const char *quantity, double *per_count, imk_error *error)
{
    return imk_count_scale_parse(text, text + strlen(text), imk_unit_of(quantity).dimension,
                                 per_count, error);
}

static void both_ways_of_writing_are_read(void **state)
{
    (void)state;
    const struct {
        const char *text, *quantity;
        double per_count;
    } texts[] = {
        {"16.4 LSB/(deg/s)", "rad/s", degree / 16.4},
        {"16.4 LSB/(°/s)", "rad/s", degree / 16.4},
        {"16.384LSB/dps", "rad/s", degree / 16.384},
        {"  131 counts/(deg/s) ", "rad/s", degree / 131},
        {"938.7 count/(rad/s)", "rad/s", 1 / 938.7},
        {"8.75 mdps/LSB", "rad/s", 8.75e-3 * degree},
        {"0.00875 dps/digit", "rad/s", 8.75e-3 * degree},
        {"(0.1) deg", "rad/s", 0},
        {"0.1 deg/s/LSB", "rad/s", 0.1 * degree},
        {"0.1 (deg/s)/count", "rad/s", 0.1 * degree},
        {"2048 LSB/g", "m/s^2", g / 2048},
        {"0.061 mg/LSB", "m/s^2", 0.061e-3 * g},
        {"61 ug/digits", "m/s^2", 61e-6 * g},
        {"408.268 LSB/(m/s^2)", "m/s^2", 1 / 408.268},
        {"132.48 LSB/degC", "K", 1 / 132.48}, /* a difference: without the 273.15 of degC */
        {"0.125 K/LSB", "K", 0.125},
        {"0.15 uT/LSB", "T", 0.15e-6},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        double per_count = -1;
        imk_error error;
        const imk_status status = parse(texts[i].text, texts[i].quantity, &per_count, &error);
        if (texts[i].per_count > 0 && status != IMK_OK)
            fail_msg("%s: %s %s", texts[i].text, error.found, error.expected);
        if (texts[i].per_count > 0)
            CHECK_RELATIVE(per_count, texts[i].per_count, 1e-15);
        else {
            assert_int_equal(status, IMK_ERROR_SYNTAX);
            CHECK_CLOSE(per_count, -1, 0); /* untouched */
        }
    }
}

static void what_is_no_scale_is_refused_in_words(void **state)
{
    (void)state;
    static const char rate[] =
        "a number of counts per angular rate like 16.4 LSB/(deg/s), or an angular rate "
        "per count like 8.75 mdps/LSB";
    static const char force[] =
        "a number of counts per acceleration like 2048 LSB/g, or an acceleration per "
        "count like 0.061 mg/LSB";
    static const struct {
        const char *text, *quantity;
        imk_status status;
        const char *found, *expected;
    } texts[] = {
        {"", "rad/s", IMK_ERROR_SYNTAX, "\"\" does not start with a number", rate},
        {"LSB/g", "m/s^2", IMK_ERROR_SYNTAX, "\"LSB/g\" does not start with a number", force},
        {"16.4", "rad/s", IMK_ERROR_UNIT_MISSING, "\"16.4\" has no unit", rate},
        {"0 LSB/g", "m/s^2", IMK_ERROR_RANGE, "\"0 LSB/g\" is not above 0", force},
        {"-2 LSB/g", "m/s^2", IMK_ERROR_RANGE, "\"-2 LSB/g\" is not above 0", force},
        {"inf LSB/g", "m/s^2", IMK_ERROR_RANGE, "\"inf LSB/g\" is not above 0", force},
        {"1e-320 LSB/(m/s^2)", "m/s^2", IMK_ERROR_RANGE,
         "\"1e-320 LSB/(m/s^2)\" is beyond what a number can hold", force},
        {"2048 LSB/g", "rad/s", IMK_ERROR_DIMENSION,
         "\"2048 LSB/g\" is a number of counts per specific force", rate},
        {"16.4 LSB/(deg/s)", "m/s^2", IMK_ERROR_DIMENSION, NULL, force},
        {"16.4 LSB/deg/s", "rad/s", IMK_ERROR_DIMENSION, NULL, rate},
        {"16.4 deg/s", "rad/s", IMK_ERROR_DIMENSION, NULL, rate},
        {"16.4 LSB", "rad/s", IMK_ERROR_DIMENSION, NULL, rate},
        {"5 LSB^2/g", "m/s^2", IMK_ERROR_DIMENSION, NULL, force},
        {"5 LSB/gg", "m/s^2", IMK_ERROR_UNIT_UNKNOWN, "gg", NULL},
        {"5 LSB/T", "K", IMK_ERROR_DIMENSION, NULL,
         "a number of counts per kelvin like 132.48 LSB/degC, or kelvins per count like 0.125 "
         "K/LSB"},
        {"5 LSB/g", "m", IMK_ERROR_DIMENSION, NULL,
         "a number with a unit of LSB/(m) or the reverse"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        double per_count = -1;
        imk_error error;
        assert_int_equal(parse(texts[i].text, texts[i].quantity, &per_count, &error),
                         texts[i].status);
        if (texts[i].found)
            assert_string_equal(error.found, texts[i].found);
        if (texts[i].expected)
            assert_string_equal(error.expected, texts[i].expected);
        CHECK_CLOSE(per_count, -1, 0);
        assert_int_equal(parse(texts[i].text, texts[i].quantity, &per_count, NULL),
                         texts[i].status);
    }
}

/* Of any length, and cut between characters. */
static void long_texts_are_shortened(void **state)
{
    (void)state;
    char text[1000] = "1";
    for (size_t i = 1; i + 2 < sizeof text; i += 2)
        memcpy(text + i, "é", 3);
    double per_count;
    imk_error error;
    assert_int_equal(parse(text, "rad/s", &per_count, &error), IMK_ERROR_SYNTAX);
    assert_int_equal(parse(text + 1, "rad/s", &per_count, &error), IMK_ERROR_SYNTAX);
    assert_true(strlen(error.found) < sizeof error.found && strstr(error.found, "é\" does not"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_ways_of_writing_are_read),
        cmocka_unit_test(what_is_no_scale_is_refused_in_words),
        cmocka_unit_test(long_texts_are_shortened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
