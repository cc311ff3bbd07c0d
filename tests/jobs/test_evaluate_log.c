/* SPDX-License-Identifier: Apache-2.0 */
/* A table in memory becomes a channel with figures; what is wrong with it is a finding. */
#include "calibrate/delayed_reference.h"
#include "check.h"

#include "imukit/evaluate_log.h"

#include <string.h>

enum { ROWS = 8 };

/* Readings of 2 reference + 1, up and down. */
static imk_log table_of(double *reference, double *reading)
{
    imk_log log = {.rows = ROWS, .column_count = 2};
    log.column[0] = imk_record_column("reference");
    log.column[1] = imk_record_column("reading_z");
    log.column[0].unit = imk_unit_of("deg/s");
    log.column[1].unit = imk_unit_of("V");
    for (int i = 0; i < ROWS; i++) {
        reference[i] = i < ROWS / 2 ? i : ROWS - 1 - i;
        reading[i] = 2 * reference[i] + 1;
    }
    log.data[0] = reference;
    log.data[1] = reading;
    return log;
}

static imk_evaluate_log *evaluation(void)
{
    imk_evaluate_log *made;
    imk_error error;
    const imk_evaluate_log_settings settings = imk_evaluate_log_default();
    CHECK_OK(imk_evaluate_log_create(&settings, NULL, &made, &error));
    return made;
}

static void test_table(void **state)
{
    (void)state;
    double reference[ROWS], reading[ROWS];
    imk_error error;
    imk_log log = table_of(reference, reading);
    imk_evaluate_log *v = evaluation();
    assert_true(imk_evaluate_is_table(log.column_count, log.column));
    CHECK_OK(imk_evaluate_table(v, &log, &error));
    assert_int_equal(v->run_count, 1);
    assert_int_equal(v->channel_count, 1);
    imk_evaluate_channel *c = &v->channel[0];
    assert_string_equal(c->name, "z");
    assert_int_equal(c->count, ROWS);
    imk_evaluate_channel_settings(v, c);
    CHECK_OK(imk_evaluate_channel_run(v, c, &error));
    CHECK_CLOSE(c->result.sensitivity.value, 2, 1e-12);
    assert_true(c->sheet.count > 0);
    imk_evaluate_scale(c, 2, 1);
    CHECK_CLOSE(c->reading[3], c->reference[3], 0);
    imk_evaluate_log_free(v);
}

static void check_refused(const imk_log *log, imk_status status, const char *code)
{
    imk_error error;
    imk_evaluate_log *v = evaluation();
    CHECK_STATUS(imk_evaluate_table(v, log, &error), status);
    assert_string_equal(imk_findings_failure(&v->findings)->code, code);
    imk_evaluate_log_free(v);
}

/* A reference half a second late, or early: its last 0.3 s after the trim are of another level, ten
 * times the hysteresis. The delay is met to a tenth of a sample, and the figure is as without. */
static void test_late_reference(void **state)
{
    (void)state;
    delayed_reference *d = calloc(1, sizeof *d);
    for (int sense = -1; sense <= 1; sense += 2) {
        delayed_log(d, 0.5 * sense, 7);
        assert_true(delayed_evaluate(d, false));
        CHECK_CLOSE(d->delay, 0.5 * sense, 0.1 * delayed_dt);
        assert_true(d->warned);
        CHECK_CLOSE(d->hysteresis.value, delayed_hysteresis, 0.05 * delayed_hysteresis);
        assert_true(delayed_evaluate(d, true));
        assert_true(d->warned);
        assert_true(d->hysteresis.value > 5.0 * delayed_hysteresis);
    }
    free(d);
}

/* Sound logs: no delay is found beyond a sample, nothing is said, and the figure is the same as
 * without a search. A delay below the trim is taken out without a word. */
static void test_reference_in_time(void **state)
{
    (void)state;
    delayed_reference *d = calloc(1, sizeof *d);
    for (uint32_t seed = 0; seed < check_runs(20); seed++) {
        delayed_log(d, 0.0, 100 + seed);
        assert_true(delayed_evaluate(d, false));
        CHECK_CLOSE(d->delay, 0.0, 0.0);
        assert_false(d->warned);
        const double value = d->hysteresis.value;
        assert_true(delayed_evaluate(d, true));
        CHECK_CLOSE(d->hysteresis.value, value, 0.0);
    }
    delayed_log(d, 0.06, 9);
    assert_true(delayed_evaluate(d, false));
    CHECK_CLOSE(d->delay, 0.06, 0.1 * delayed_dt);
    assert_false(d->warned);
    free(d);
}

static void test_refusals(void **state)
{
    (void)state;
    double reference[ROWS], reading[ROWS];
    imk_log log = table_of(reference, reading);
    reading[5] = (double)NAN;
    check_refused(&log, IMK_ERROR_NOT_FINITE, "no_reading");
    log.column[1].unit.text[0] = '\0';
    check_refused(&log, IMK_ERROR_UNIT_MISSING, "no_unit");
    log.rows = 0;
    check_refused(&log, IMK_ERROR_EMPTY, "no_rows");
    memcpy(log.column[0].name, "other", 6);
    check_refused(&log, IMK_ERROR_COLUMN, "no_readings");

    imk_error error;
    imk_evaluate_log *v = evaluation();
    const imk_calibrate_record record = {.path = "x"};
    CHECK_STATUS(imk_evaluate_record(v, &record, &error), IMK_ERROR_KEY_MISSING);
    imk_evaluate_log_free(v);
    imk_evaluate_log_free(NULL);
}

/* A table is known by its columns; what is of records is then refused. A record needs a reference.
 */
static void test_sources(void **state)
{
    (void)state;
    static const char *const names[] = {"reference [deg/s]", "reading [V]"};
    double reference[ROWS], reading[ROWS];
    imk_array_source memory;
    imk_record_source source;
    imk_error error;
    const imk_log table = table_of(reference, reading);
    const double *data[] = {table.data[0], table.data[1]};
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    imk_evaluate_log *v = evaluation();
    CHECK_OK(imk_array_source_make(2, names, data, ROWS, 1, &memory, &source, &error));
    CHECK_OK(imk_evaluate_source(v, "table", &source, &settings, NULL, &error));
    assert_int_equal(v->run_count, 1);
    assert_int_equal(v->channel[0].count, ROWS);
    CHECK_OK(imk_evaluate_check_used(v, &settings, &error));
    settings.table_axis = 2;
    CHECK_STATUS(imk_evaluate_check_used(v, &settings, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "table_axis");
    v->record_count = 1;
    CHECK_OK(imk_evaluate_check_used(v, &settings, &error));

    static const char *const sensor[] = {"gyro_z [deg/s]"};
    double gyro[100];
    for (int i = 0; i < 100; i++)
        gyro[i] = i % 7;
    data[0] = gyro;
    settings.table_axis = -1;
    CHECK_OK(imk_array_source_make(1, sensor, data, 100, 10, &memory, &source, &error));
    CHECK_STATUS(imk_evaluate_source(v, "record", &source, &settings, NULL, &error),
                 IMK_ERROR_KEY_MISSING);
    assert_string_equal(imk_findings_failure(&v->findings)->code, "no_reference");
    imk_evaluate_log_free(v);
}

static void test_times_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_evaluate_log *v;
    imk_evaluate_log_settings settings = imk_evaluate_log_default();
    settings.minimum = 0;
    CHECK_STATUS(imk_evaluate_log_create(&settings, NULL, &v, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "minimum");
    assert_null(v);
    settings = imk_evaluate_log_default();
    settings.settle = -1;
    CHECK_STATUS(imk_evaluate_log_create(&settings, NULL, &v, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "settle");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_late_reference),
        cmocka_unit_test(test_reference_in_time),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_sources),
        cmocka_unit_test(test_times_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
