/* SPDX-License-Identifier: Apache-2.0 */
/* A record in memory is corrected into arrays; refusals are findings. */
#include "check.h"

#include "imukit/compensate_log.h"

enum { ROWS = 10 };

static void biased_gyro(imk_model *model)
{
    imk_model_default(model);
    model->gyro.present = true;
    model->gyro.bias.fixed.value[0] = 0.25;
}

static imk_status run(const char *const *names, const imk_model *model, double *const *out,
                      imk_compensate_log **log)
{
    static double time[ROWS], rate[3][ROWS];
    const double *const data[] = {time, rate[0], rate[1], rate[2]};
    for (int i = 0; i < ROWS; i++) {
        time[i] = 0.01 * i;
        rate[0][i] = 1 + i;
    }
    imk_array_source memory;
    imk_record_source source;
    imk_array_sink written = {.column_count = 5, .capacity = ROWS, .data = out};
    imk_error error;
    assert_int_equal(imk_array_source_make(4, names, data, ROWS, 0, &memory, &source, &error),
                     IMK_OK);
    imk_compensate_log_settings settings = imk_compensate_log_default();
    settings.flags = true;
    const imk_record_sink sink = imk_array_sink_of(&written);
    return imk_compensate_log_run(&source, model, &settings, &sink, NULL, log, &error);
}

static void test_bias_is_taken_out(void **state)
{
    (void)state;
    static const char *const names[] = {"time", "gyro_x", "gyro_y", "gyro_z"};
    static imk_model model;
    static double column[5][ROWS];
    double *const out[] = {column[0], column[1], column[2], column[3], column[4]};
    imk_compensate_log *log;
    biased_gyro(&model);
    assert_int_equal(run(names, &model, out, &log), IMK_OK);
    assert_int_equal(log->counts.rows, ROWS);
    assert_int_equal(log->taken_out.count, 1);
    assert_string_equal(log->taken_out.key[0], "gyro.bias.fixed");
    for (int i = 0; i < ROWS; i++)
        check_close(column[1][i], 0.75 + i, 1e-12, "rate", __FILE__, __LINE__);
    imk_compensate_log_free(log);
}

static void test_missing_axis_is_a_finding(void **state)
{
    (void)state;
    static const char *const names[] = {"time", "gyro_x", "gyro_y", "other"};
    static imk_model model;
    imk_compensate_log *log;
    char text[200];
    biased_gyro(&model);
    assert_int_equal(run(names, &model, NULL, &log), IMK_ERROR_COLUMN);
    const imk_finding *why = imk_findings_failure(&log->findings);
    assert_non_null(why);
    imk_finding_message(why, "log.csv", "unit.yaml", text, sizeof text);
    assert_string_equal(text, "log.csv has no column gyro_z: unit.yaml describes 3 gyro axes, and "
                              "all of them are needed");
    imk_compensate_log_free(log);
}

/* m = h + A u: u by hand, A = {{1.1, 0.2, 0}, {0, 0.9, 0}, {0, 0, 1}}. */
static void test_magnetometer(void **state)
{
    (void)state;
    static const char *const names[] = {"time", "mag_x [uT]", "mag_y [uT]", "mag_z [uT]"};
    static imk_model model;
    static double column[5][ROWS];
    double *const out[] = {column[0], column[1], column[2], column[3], column[4]};
    imk_compensate_log *log;
    imk_model_default(&model);
    model.mag = model.accel;
    model.mag.bias.fixed.value[0] = 1e-6;
    model.mag.bias.fixed.value[1] = 0.9e-6;
    model.mag.scale_factor.fixed.value[0] = 0.1;
    model.mag.scale_factor.fixed.value[1] = -0.1;
    model.mag.cross_axis.value[0][1] = 0.2;
    model.mag.noise.white.value[0] = 1e-9;
    assert_int_equal(run(names, &model, out, &log), IMK_OK);
    assert_int_equal(log->taken_out.count, 3);
    assert_string_equal(log->taken_out.key[2], "mag.cross_axis");
    assert_int_equal(log->left_in.count, 1);
    /* Readings (1 + i, 0, 0) uT: u_y = -1 uT, u_x = (i + 0.2)/1.1 uT. */
    for (int i = 0; i < ROWS; i++) {
        CHECK_CLOSE(column[1][i], (i + 0.2) / 1.1 * 1e-6, 1e-18);
        CHECK_CLOSE(column[2][i], -1e-6, 1e-18);
        CHECK_CLOSE(column[3][i], 0, 1e-18);
    }
    imk_compensate_log_free(log);
    /* Two axes are no triad: copied, with a warning. */
    static const char *const two[] = {"time", "mag_x [uT]", "mag_y [uT]", "gyro_x [rad/s]"};
    model.gyro.axis_count = 1;
    model.accel.present = false;
    assert_int_equal(run(two, &model, out, &log), IMK_OK);
    assert_string_equal(log->findings.item[0].code, "magnetometer_left");
    CHECK_CLOSE(column[1][3], 4e-6, 1e-18);
    imk_compensate_log_free(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bias_is_taken_out),
        cmocka_unit_test(test_magnetometer),
        cmocka_unit_test(test_missing_axis_is_a_finding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
