/* SPDX-License-Identifier: Apache-2.0 */
/* A table in memory becomes a channel with figures; what is wrong with it is a finding. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
