/* SPDX-License-Identifier: Apache-2.0 */
/* A record in memory becomes another: columns, the force at another point; refusals are findings.
 */
#include "check.h"

#include "imukit/convert_log.h"

enum { ROWS = 10, COLUMNS = 7 };

static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                           "accel_x", "accel_y", "accel_z"};

/* A steady rotation of 2 rad/s about z, gravity along z. */
static imk_status run(const imk_convert_log_settings *settings, size_t columns,
                      imk_array_sink *written, imk_findings *findings, imk_error *error)
{
    static double column[COLUMNS][ROWS];
    const double *data[COLUMNS];
    for (int c = 0; c < COLUMNS; c++)
        data[c] = column[c];
    for (int i = 0; i < ROWS; i++) {
        column[0][i] = 0.5 * i;
        column[3][i] = 2;
        column[6][i] = -9.75;
    }
    imk_array_source memory;
    imk_record_source source;
    CHECK_OK(imk_array_source_make(columns, names, data, ROWS, 0, &memory, &source, error));
    const imk_record_sink sink = imk_array_sink_of(written);
    return imk_convert_log_run(&source, settings, &sink, NULL, findings, error);
}

static void test_columns_are_selected(void **state)
{
    (void)state;
    static double out[2][ROWS];
    double *const data[] = {out[0], out[1]};
    imk_array_sink written = {.column_count = 2, .capacity = ROWS, .data = data};
    imk_findings findings;
    imk_error error;
    imk_convert_log_settings settings = imk_convert_log_default();
    settings.select = "gyro_z,time";
    settings.gyro_unit = imk_unit_of("deg/s");
    CHECK_OK(run(&settings, COLUMNS, &written, &findings, &error));
    assert_int_equal(written.rows, ROWS);
    assert_string_equal(written.column[0].name, "gyro_z");
    assert_string_equal(written.column[0].unit.text, "deg/s");
    CHECK_CLOSE(out[0][3], 2, 0);
    CHECK_CLOSE(out[1][3], 1.5, 0);

    settings.gyro_unit = imk_unit_of("g");
    CHECK_STATUS(run(&settings, COLUMNS, &written, &findings, &error), IMK_ERROR_DIMENSION);
    assert_string_equal(error.field, "gyro-unit");
    settings.select = "gyro_w";
    CHECK_STATUS(run(&settings, COLUMNS, &written, &findings, NULL), IMK_ERROR_COLUMN);
    assert_string_equal(imk_findings_failure(&findings)->code, "no_such_column");
}

/* Half a metre forward, the force is less by 4 * 0.5 towards the axis. */
static void test_force_at_another_point(void **state)
{
    (void)state;
    static double out[COLUMNS][ROWS];
    double *data[COLUMNS];
    for (int c = 0; c < COLUMNS; c++)
        data[c] = out[c];
    imk_array_sink written = {.column_count = COLUMNS, .capacity = ROWS, .data = data};
    imk_findings findings;
    imk_error error;
    imk_convert_log_settings settings = imk_convert_log_default();
    settings.to_point = true;
    settings.point.v[0] = 0.5;
    CHECK_OK(run(&settings, COLUMNS, &written, &findings, &error));
    assert_int_equal(findings.count, 0);
    for (int i = 0; i < ROWS; i++) {
        CHECK_CLOSE(out[4][i], -2, 1e-15);
        CHECK_CLOSE(out[6][i], -9.75, 0);
    }
    CHECK_STATUS(run(&settings, 4, &written, &findings, &error), IMK_ERROR_COLUMN);
    assert_string_equal(imk_findings_failure(&findings)->code, "convert:no_axis");
}

static void test_without_gravity(void **state)
{
    (void)state;
    static double out[COLUMNS][ROWS];
    double *data[COLUMNS];
    for (int c = 0; c < COLUMNS; c++)
        data[c] = out[c];
    imk_array_sink written = {.column_count = COLUMNS, .capacity = ROWS, .data = data};
    imk_findings findings;
    imk_error error;
    imk_convert_log_settings settings = imk_convert_log_default();
    settings.gravity_free = true;
    settings.still = 0.05;
    CHECK_STATUS(run(&settings, COLUMNS, &written, &findings, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "latitude");
    settings.latitude = 0.8;
    CHECK_OK(run(&settings, COLUMNS, &written, &findings, &error));
    assert_int_equal(written.rows, ROWS);
    CHECK_CLOSE(out[6][0], 0, 0.1); /* normal gravity at 45.8 deg is 9.807 m/s^2 */
    assert_string_equal(findings.item[0].code, "drift");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns_are_selected),
        cmocka_unit_test(test_force_at_another_point),
        cmocka_unit_test(test_without_gravity),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
