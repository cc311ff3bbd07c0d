/* SPDX-License-Identifier: Apache-2.0 */
/* What is in a record: figures of columns, faults of times, rest and motion; long records that are
 * looked at in places. */
#include "check.h"

#include "imukit/info_log.h"
#include "imukit/random.h"

#include <string.h>

enum { MOST = 200000, ROW_SIZE = 100 };

/* A record made by a function of the row, with the progress of a file of 100 bytes a row. */
typedef struct made_record {
    imk_log_column column[8];
    size_t columns, rows, next;
    void (*make)(size_t row, double *values);
    bool seeks;
    size_t seeks_done;
} made_record;

static imk_status read_made(void *context, size_t most, double *const *columns, size_t *rows,
                            imk_error *error)
{
    made_record *m = context;
    double values[8];
    (void)error;
    for (*rows = 0; *rows < most && m->next < m->rows; ++*rows, m->next++) {
        m->make(m->next, values);
        for (size_t c = 0; c < m->columns; c++)
            columns[c][*rows] = values[c];
    }
    return IMK_OK;
}

static imk_status seek_made(void *context, double fraction, imk_error *error)
{
    made_record *m = context;
    if (!m->seeks)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "", "");
    m->next = (size_t)(fraction * (double)m->rows);
    m->seeks_done++;
    return IMK_OK;
}

static void progress_made(void *context, uint64_t *done, uint64_t *total)
{
    const made_record *m = context;
    *done = (uint64_t)m->next * ROW_SIZE;
    *total = (uint64_t)m->rows * ROW_SIZE;
}

static imk_log_findings findings_made(void *context)
{
    (void)context;
    return (imk_log_findings){.interval = 0.01};
}

/* White noise of sigma 1 that is a function of the row and the column alone. */
static double noise(size_t row, uint32_t column)
{
    double n;
    imk_random_normals(imk_random_seeded(7), column, row, 1, &n);
    return n;
}

static made_record record_of(size_t rows, void (*make)(size_t, double *))
{
    static const char *const names[] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                        "accel_x", "accel_y", "accel_z"};
    made_record m = {.columns = 7, .rows = rows, .make = make, .seeks = true};
    for (size_t c = 0; c < m.columns; c++)
        m.column[c] = imk_record_column(names[c]);
    return m;
}

static imk_info_log *look_at(made_record *m, bool full)
{
    const imk_record_source source = {.context = m,
                                      .column_count = m->columns,
                                      .columns = m->column,
                                      .read = read_made,
                                      .seek = seek_made,
                                      .findings = findings_made,
                                      .progress = progress_made};
    imk_info_log_settings settings = imk_info_log_default();
    imk_info_log *info;
    imk_error error;
    settings.full = full;
    m->next = 0;
    CHECK_OK(imk_info_log_run(&source, &settings, NULL, &info, &error));
    return info;
}

/* At rest, level: gyros of 1e-3 rad/s in steps of 1e-4, accelerometers of 0.01 m/s^2. */
static void at_rest(size_t row, double *v)
{
    v[0] = (double)row * 0.01;
    for (uint32_t a = 0; a < 3; a++) {
        v[1 + a] = 1e-4 * round(10 * noise(row, a));
        v[4 + a] = 0.01 * noise(row, 3 + a) - (a == 2 ? 9.8 : 0);
    }
}

/* A minute on each of six faces, two seconds of turning between. */
static void in_poses(size_t row, double *v)
{
    const size_t pose = row / 6200 % 6, within = row % 6200;
    at_rest(row, v);
    v[6] += 9.8;
    v[4 + pose % 3] += pose < 3 ? 9.8 : -9.8;
    if (within >= 6000)
        v[1] += 1;
}

/* A tilt of 0.2 deg/s, slower than what a bias is. */
static void tilting(size_t row, double *v)
{
    const double angle = 0.2 * 3.14159265358979 / 180 * 0.01 * (double)row;
    at_rest(row, v);
    v[1] += 0.2 * 3.14159265358979 / 180;
    v[5] += 9.8 * sin(angle);
    v[6] += 9.8 - 9.8 * cos(angle);
}

/* The turns of a vehicle: 0.1 rad/s in half a minute. */
static void moving(size_t row, double *v)
{
    at_rest(row, v);
    v[3] += 0.1 * sin(0.01 * (double)row * 0.2);
}

/* Gyro x ends at 2e-3 rad/s, twice its noise; y once has no value, z shows one alone. */
static void clipped(size_t row, double *v)
{
    at_rest(row, v);
    v[1] = fmin(v[1] * 3, 2e-3);
    v[2] = row == 1000 ? (double)NAN : v[2];
    v[3] = 0.5;
}

/* A steady 100 deg/s; noise of 3 deg/s at rest; forces about nothing; a value in every tenth row
 * only of accel y. */
static void turning(size_t row, double *v)
{
    at_rest(row, v);
    v[3] += 1.745;
}

static void noisy(size_t row, double *v)
{
    at_rest(row, v);
    v[1] = 0.052 * noise(row, 0);
}

static void weightless(size_t row, double *v)
{
    at_rest(row, v);
    v[6] += 9.8;
}

static void sparse(size_t row, double *v)
{
    at_rest(row, v);
    v[0] = row % 10 == 0 ? v[0] : (double)NAN;
    v[5] = row % 10 == 0 ? v[5] : (double)NAN;
}

/* Wrong values of single rows, one in 400: 3 rad/s. */
static void glitching(size_t row, double *v)
{
    at_rest(row, v);
    v[1] += row % 400 == 17 ? 3 : 0;
    v[2] -= row % 400 == 17 ? 3 : 0;
}

static void check_motion(void (*make)(size_t, double *), imk_info_motion due)
{
    made_record m = record_of(20000, make);
    imk_info_log *info = look_at(&m, false);
    assert_int_equal(info->motion, due);
    imk_info_log_free(info);
}

/* Windows with holes show no motion; columns without them have their figures all the same. */
static void test_holes(void **state)
{
    (void)state;
    made_record m = record_of(20000, sparse);
    imk_info_log *info = look_at(&m, false);
    assert_int_equal(info->motion, IMK_INFO_UNKNOWN);
    CHECK_RELATIVE(info->channel[4].scatter, 0.01, 0.03);
    assert_true(isnan(info->channel[5].scatter));
    assert_int_equal(info->channel[5].finite, 2000);
    imk_info_log_free(info);
}

static void test_figures(void **state)
{
    (void)state;
    made_record m = record_of(20000, at_rest);
    imk_info_log *info = look_at(&m, false);
    assert_true(info->whole);
    assert_int_equal(info->rows, 20000);
    assert_int_equal(info->rows_from, IMK_INFO_READ);
    assert_int_equal(m.seeks_done, 0);
    CHECK_CLOSE(info->duration, 199.99, 1e-9);
    CHECK_CLOSE(info->interval, 0.01, 0);
    assert_int_equal(info->motion, IMK_INFO_REST);
    CHECK_CLOSE(info->resting, 1, 0);
    assert_int_equal(info->attitudes, 1);
    /* Deviations of 20000 samples are known to 0.5 %, their means to 0.7 % of them: six sigma. */
    CHECK_RELATIVE(info->channel[1].scatter, sqrt(1e-6 + 1e-8 / 12), 0.03);
    CHECK_CLOSE(info->channel[1].mean, 0, 6 * 1e-3 / sqrt(20000));
    CHECK_CLOSE(info->channel[6].mean, -9.8, 6 * 0.01 / sqrt(20000));
    CHECK_CLOSE(info->channel[1].step, 1e-4, 1e-12);
    CHECK_CLOSE(info->channel[4].step, 0, 0);
    for (size_t c = 1; c < 7; c++)
        assert_int_equal(info->channel[c].clipped_low + info->channel[c].clipped_high, 0);
    imk_info_log_free(info);
}

static void test_clipping(void **state)
{
    (void)state;
    made_record m = record_of(20000, clipped);
    imk_info_log *info = look_at(&m, false);
    /* P(n > 2/3) = 0.2525 of 20000 rows are at the end, within six sigma of 61. */
    assert_int_equal(info->channel[1].clipped_low, 0);
    assert_in_range(info->channel[1].clipped_high, 5050 - 370, 5050 + 370);
    assert_int_equal(info->channel[2].finite, 19999);
    assert_int_equal(info->channel[2].clipped_low + info->channel[2].clipped_high, 0);
    /* A constant has no range at whose end it could be. */
    assert_int_equal(info->channel[3].clipped_low + info->channel[3].clipped_high, 0);
    imk_info_log_free(info);
}

static void test_motion(void **state)
{
    (void)state;
    made_record poses = record_of(6 * 6200, in_poses), moved = record_of(60000, moving);
    imk_info_log *info = look_at(&poses, false);
    assert_int_equal(info->motion, IMK_INFO_POSES);
    assert_int_equal(info->attitudes, 6);
    CHECK_CLOSE(info->resting, 6000.0 / 6200, 0.03);
    imk_info_log_free(info);
    info = look_at(&moved, false);
    assert_int_equal(info->motion, IMK_INFO_MOVES);
    imk_info_log_free(info);
    check_motion(turning, IMK_INFO_MOVES);
    check_motion(tilting, IMK_INFO_MOVES);
    check_motion(noisy, IMK_INFO_REST);
    check_motion(glitching, IMK_INFO_REST);
    check_motion(weightless, IMK_INFO_REST);
    /* Without gyros and accelerometers nothing is said. */
    made_record other = record_of(1000, at_rest);
    other.columns = 1;
    info = look_at(&other, false);
    assert_int_equal(info->motion, IMK_INFO_UNKNOWN);
    imk_info_log_free(info);
}

/* A day at 100 Hz: 864 MB of a file. Few rows are read, and the figures are those of all. */
static void test_a_long_record(void **state)
{
    (void)state;
    made_record m = record_of(8640000, at_rest);
    imk_info_log *info = look_at(&m, false);
    assert_false(info->whole);
    assert_true(info->rows_read < 400000);
    assert_true(info->places >= 10);
    assert_int_equal(info->rows_from, IMK_INFO_SIZE);
    CHECK_RELATIVE((double)info->rows, 8640000, 1e-3);
    assert_int_equal(info->duration_from, IMK_INFO_ENDS);
    CHECK_CLOSE(info->duration, 86399.99, 1e-6);
    assert_int_equal(info->motion, IMK_INFO_REST);
    imk_info_log_free(info);

    m.seeks = false;
    info = look_at(&m, false);
    assert_int_equal(info->places, 1);
    assert_int_equal(info->duration_from, IMK_INFO_SIZE);
    CHECK_RELATIVE(info->duration, 86399.99, 1e-3);
    assert_true(isnan(info->last_time));
    imk_info_log_free(info);
}

static void test_full(void **state)
{
    (void)state;
    made_record m = record_of(400000, at_rest);
    imk_info_log *info = look_at(&m, true);
    assert_true(info->whole);
    assert_int_equal(info->rows_read, 400000);
    assert_int_equal(m.seeks_done, 0);
    imk_info_log_free(info);
}

static imk_log_findings findings_of_a_faster_device(void *context)
{
    (void)context;
    return (imk_log_findings){.interval = 0.01, .device_interval = 0.005};
}

/* Increments of messages that were not recorded are missing. */
static void test_a_faster_device(void **state)
{
    (void)state;
    made_record m = record_of(1000, at_rest);
    const imk_record_source source = {.context = &m,
                                      .column_count = m.columns,
                                      .columns = m.column,
                                      .read = read_made,
                                      .findings = findings_of_a_faster_device,
                                      .progress = progress_made};
    const imk_info_log_settings settings = imk_info_log_default();
    imk_info_log *info;
    imk_error error;
    char text[900];
    CHECK_OK(imk_info_log_run(&source, &settings, NULL, &info, &error));
    assert_int_equal(info->findings.count, 1);
    assert_string_equal(info->findings.item[0].code, "decimated");
    imk_finding_text(&info->findings.item[0], text, sizeof text);
    assert_non_null(strstr(text, "100 increments per second, and its device makes 200"));
    assert_non_null(strstr(text, "a factor of 2;"));
    imk_info_log_free(info);
    m = record_of(1000, at_rest);
    info = look_at(&m, false);
    assert_int_equal(info->findings.count, 0);
    imk_info_log_free(info);
}

static imk_log_findings findings_of_scattered_times(void *context)
{
    (void)context;
    return (imk_log_findings){.interval = 0.01, .jitter = 0.003, .mean_step = 0.01};
}

/* Steps that scatter matter where increments are divided by them. */
static void test_increments(void **state)
{
    (void)state;
    for (int increments = 0; increments < 2; increments++) {
        made_record m = record_of(1000, at_rest);
        m.column[1].increment = increments > 0;
        const imk_record_source source = {.context = &m,
                                          .column_count = m.columns,
                                          .columns = m.column,
                                          .read = read_made,
                                          .findings = findings_of_scattered_times,
                                          .progress = progress_made};
        const imk_info_log_settings settings = imk_info_log_default();
        imk_info_log *info;
        imk_error error;
        CHECK_OK(imk_info_log_run(&source, &settings, NULL, &info, &error));
        assert_int_equal(info->findings.count, increments);
        if (increments)
            assert_string_equal(info->findings.item[0].code, "uneven_increments");
        imk_info_log_free(info);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    made_record m = record_of(0, at_rest);
    const imk_record_source source = {
        .context = &m, .column_count = m.columns, .columns = m.column, .read = read_made};
    imk_info_log_settings settings = imk_info_log_default();
    imk_info_log *info;
    imk_error error;
    CHECK_STATUS(imk_info_log_run(&source, &settings, NULL, &info, &error), IMK_ERROR_EMPTY);
    imk_info_log_free(info);
    settings.cookie = 0;
    CHECK_STATUS(imk_info_log_run(&source, &settings, NULL, &info, &error),
                 IMK_ERROR_UNINITIALISED);
    imk_info_log_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_figures),         cmocka_unit_test(test_clipping),
        cmocka_unit_test(test_motion),          cmocka_unit_test(test_holes),
        cmocka_unit_test(test_a_long_record),   cmocka_unit_test(test_full),
        cmocka_unit_test(test_a_faster_device), cmocka_unit_test(test_increments),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
