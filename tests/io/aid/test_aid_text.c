/* SPDX-License-Identifier: Apache-2.0 */
/* Aids in one line of text: every word, and messages for what is none. */
#include "check.h"

#include "imukit/aid_text.h"
#include "imukit/io.h"

#include <string.h>

static size_t parse(const char *text, imk_aid aid[IMK_AIDS_MAX])
{
    imk_error error;
    size_t count;
    CHECK_OK(imk_aid_parse(text, aid, &count, &error));
    return count;
}

static void test_gnss(void **state)
{
    (void)state;
    imk_aid aid[IMK_AIDS_MAX];
    assert_int_equal(
        parse("gnss position 1 1 2 m, velocity 5 cm/s at 2 Hz from 3 s until 10min", aid), 2);
    assert_int_equal(aid[0].kind, IMK_AID_POSITION);
    assert_int_equal(aid[1].kind, IMK_AID_VELOCITY);
    for (int i = 0; i < 3; i++) {
        CHECK_RELATIVE(aid[0].sigma[i], i < 2 ? 1.0 : 2.0, 1e-15);
        CHECK_RELATIVE(aid[1].sigma[i], 0.05, 1e-15);
    }
    for (int k = 0; k < 2; k++) {
        CHECK_RELATIVE(aid[k].interval, 0.5, 1e-15);
        CHECK_RELATIVE(aid[k].from, 3.0, 1e-15);
        CHECK_RELATIVE(aid[k].until, 600.0, 1e-15);
        assert_true(aid[k].correlated_sigma[0] == 0.0);
    }
}

/* A correlation behind a comma is of all quantities, right behind one of that one. */
static void test_correlated(void **state)
{
    (void)state;
    imk_aid aid[IMK_AIDS_MAX];
    assert_int_equal(parse("position 2 m, velocity 0.1 m/s, correlated 60 s", aid), 2);
    CHECK_RELATIVE(aid[0].correlated_sigma[1], 2.0, 1e-15);
    CHECK_RELATIVE(aid[0].sigma[1], 0.2, 1e-15);
    CHECK_RELATIVE(aid[1].correlation_time, 60.0, 1e-15);
    assert_int_equal(parse("position 2 m correlated 1 min, velocity 0.1 m/s", aid), 2);
    CHECK_RELATIVE(aid[0].correlation_time, 60.0, 1e-15);
    assert_true(aid[1].correlated_sigma[0] == 0.0);
    CHECK_RELATIVE(aid[1].sigma[0], 0.1, 1e-15);
}

static void test_other_kinds(void **state)
{
    (void)state;
    imk_aid aid[IMK_AIDS_MAX];
    assert_int_equal(parse("barometer height 2 m every 5 s", aid), 1);
    assert_int_equal(aid[0].kind, IMK_AID_HEIGHT);
    CHECK_RELATIVE(aid[0].interval, 5.0, 1e-15);
    CHECK_RELATIVE(aid[0].from, 5.0, 1e-15);
    assert_true(isinf(aid[0].until));
    assert_int_equal(parse("Zero Velocity 1 cm/s", aid), 1);
    assert_int_equal(aid[0].kind, IMK_AID_ZERO_VELOCITY);
    CHECK_RELATIVE(aid[0].sigma[2], 0.01, 1e-15);
    assert_int_equal(parse("odometer 0.1 m/s", aid), 1);
    assert_true(isinf(aid[0].sigma[1]) && isinf(aid[0].sigma[2]));
    assert_int_equal(parse("odometer 0.1 0.2 0.3 m/s lever arm 1 0 -2 ± 0.05 m", aid), 1);
    CHECK_RELATIVE(aid[0].sigma[2], 0.3, 1e-15);
    CHECK_RELATIVE(aid[0].lever_arm[2], -2.0, 1e-15);
    CHECK_RELATIVE(aid[0].lever_arm_sigma[1], 0.05, 1e-15);
    assert_int_equal(parse("horizontal position 3 m", aid), 1);
    assert_true(aid[0].sigma[1] == 3.0 && isinf(aid[0].sigma[2]));
    assert_int_equal(parse("compass heading 1 deg", aid), 1);
    CHECK_RELATIVE(aid[0].sigma[0], 3.14159265358979323846 / 180.0, 1e-15);
    assert_true(isinf(aid[0].sigma[1]));
}

/* Each message names what was found and what is due. */
static void test_messages(void **state)
{
    (void)state;
    static const struct {
        const char *text, *found, *due;
    } wrong[] = {
        {"positon 1 m", "\"positon\" is not a word", "position"},
        {"position", "\"position\" has no quantity", "length"},
        {"position 1 kg", "\"1 kg\"", "length"},
        {"position 1 2 m", "\"1 2 m\"", "one number or three"},
        {"position 1 m at 1", "\"1\"", "frequency"},
        {"position 1 m until 0 s", "no positive number", "above 0"},
        {"position 1 m lever 1 m", "\"lever\" has one number", "three"},
        {"zero 1 m/s", "\"zero\"", "zero velocity"},
        {"at 1 Hz", "no quantity", "position"},
        {"", "no quantity", "position"},
        {"position 0 m", "", "sigma above 0"},
        {"position -1 m", "", "sigma above 0"},
        {"position 1 m from 20 s until 10 s", "", "not before"},
        {"height 1 m height 1 m height 1 m height 1 m height 1 m height 1 m height 1 m height 1 m "
         "height 1 m",
         "one too many", "at most 8"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        imk_aid aid[IMK_AIDS_MAX];
        imk_error error;
        size_t count = 7;
        assert_true(imk_aid_parse(wrong[i].text, aid, &count, &error) != IMK_OK);
        assert_int_equal(count, 0);
        assert_non_null(strstr(error.found, wrong[i].found));
        assert_non_null(strstr(error.expected, wrong[i].due));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gnss),
        cmocka_unit_test(test_correlated),
        cmocka_unit_test(test_other_kinds),
        cmocka_unit_test(test_messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
