/* SPDX-License-Identifier: Apache-2.0 */
/* The table of the five classes and the look-up in it. Limits are those of the table: 0.005, 0.01,
 * 1, 10, 1000 deg/h and 30 ug, 50 ug, 1, 1, 10 mg. */
#include "check.h"

#include "imukit/model.h"

static const double degree_per_hour = 3.14159265358979323846 / 180 / 3600;
static const double micro_g = 9.80665e-6;

static void table_is_the_published_one(void **state)
{
    (void)state;
    static const double gyro[5] = {0.005, 0.01, 1, 10, 1000};
    static const double accel[5] = {30, 50, 1000, 1000, 10000};
    for (int i = 0; i < 5; i++) {
        const imk_grade_row *row = imk_grade_table((imk_grade)i);
        CHECK_RELATIVE(row->gyro_bias_limit, gyro[i] * degree_per_hour, 1e-15);
        CHECK_RELATIVE(row->accel_bias_limit, accel[i] * micro_g, 1e-15);
    }
    assert_string_equal(imk_grade_table(IMK_GRADE_NAVIGATION)->position_performance, "1 nmi / h");
    assert_string_equal(imk_grade_table(IMK_GRADE_CONTROL)->name, "control system");
    assert_null(imk_grade_table(IMK_GRADE_NONE));
    assert_null(imk_grade_table((imk_grade)-1));
}

static imk_grade_result grade(double gyro_deg_per_hour, double accel_ug)
{
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability.value[1] = gyro_deg_per_hour * degree_per_hour;
    model.accel.bias.repeatability.value[2] = accel_ug * micro_g;
    return imk_grade_model(&model);
}

static void listed_values_belong_to_their_class(void **state)
{
    (void)state;
    assert_int_equal(grade(0.00499, 29.9).overall, IMK_GRADE_STRATEGIC);
    assert_int_equal(grade(0.005, 29.9).gyro, IMK_GRADE_NAVIGATION);
    assert_int_equal(grade(0.01, 50).overall, IMK_GRADE_NAVIGATION);
    assert_int_equal(grade(0.0101, 50).gyro, IMK_GRADE_TACTICAL);
    assert_int_equal(grade(1, 1000).overall, IMK_GRADE_TACTICAL);
    assert_int_equal(grade(10, 1000).overall, IMK_GRADE_AHRS);
    assert_int_equal(grade(1000, 10000).overall, IMK_GRADE_CONTROL);
    assert_int_equal(grade(1001, 1).overall, IMK_GRADE_NONE);
}

static void worse_sensor_decides(void **state)
{
    (void)state;
    imk_grade_result result = grade(0.001, 5000);
    assert_int_equal(result.gyro, IMK_GRADE_STRATEGIC);
    assert_int_equal(result.overall, IMK_GRADE_CONTROL);
    assert_string_equal(result.limiting, "accelerometer bias");
    assert_string_equal(grade(100, 5).limiting, "gyro bias");
}

/* 3, 4 and 12 make 13. */
static void parts_add_as_squares(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability.value[0] = 3e-6;
    model.gyro.noise.bias_instability.value[0] = 4e-6;
    model.gyro.bias.fixed.sigma[0] = 12e-6;
    model.gyro.bias.fixed.value[0] = 1;
    CHECK_RELATIVE(imk_grade_model(&model).gyro_bias, 13e-6, 1e-14);
}

static void silence_is_not_a_grade(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_grade_result result = imk_grade_model(&model);
    assert_true(isnan(result.gyro_bias) && isnan(result.accel_bias));
    assert_int_equal(result.overall, IMK_GRADE_NONE);
    assert_string_equal(result.limiting, "");
    model.accel.present = false;
    model.gyro.bias.repeatability.value[0] = degree_per_hour;
    assert_int_equal(imk_grade_model(&model).overall, IMK_GRADE_TACTICAL);
}

/* Claims as numbers: 1 nmi (1852 m) after an hour, after a day; tactical has no upper end. A figure
 * on the limit meets it. */
static void class_of_position(void **state)
{
    (void)state;
    const double none = (double)NAN;
    assert_int_equal(imk_grade_of_position(100, 1852), IMK_GRADE_STRATEGIC);
    assert_int_equal(imk_grade_of_position(100, 1853), IMK_GRADE_NAVIGATION);
    assert_int_equal(imk_grade_of_position(1852, none), IMK_GRADE_NAVIGATION);
    assert_int_equal(imk_grade_of_position(1853, 100), IMK_GRADE_TACTICAL);
    assert_int_equal(imk_grade_of_position(300e3, none), IMK_GRADE_TACTICAL);
    assert_int_equal(imk_grade_of_position(none, none), IMK_GRADE_NONE);
    assert_int_equal(imk_grade_of_position((double)INFINITY, 1), IMK_GRADE_NONE);
    assert_true(isinf(imk_grade_table(IMK_GRADE_TACTICAL)->position_limit));
    assert_true(isnan(imk_grade_table(IMK_GRADE_AHRS)->position_limit));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_is_the_published_one),
        cmocka_unit_test(listed_values_belong_to_their_class),
        cmocka_unit_test(worse_sensor_decides),
        cmocka_unit_test(parts_add_as_squares),
        cmocka_unit_test(class_of_position),
        cmocka_unit_test(silence_is_not_a_grade),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
