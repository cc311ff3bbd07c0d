/* SPDX-License-Identifier: Apache-2.0 */
/* Records from arrays and from text are the same to a job; gaps, cancelling and failing memory. */
#include "check.h"

#include "imukit/jobs.h"
#include "imukit/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 600, TEXT = 64 * ROWS };

static const double nan_value = (double)NAN;

/* 100 Hz of a gyro that is no constant. */
typedef struct record {
    double time[ROWS], gyro[ROWS];
    size_t rows;
} record;

static record make_record(void)
{
    record r = {.rows = ROWS};
    for (int i = 0; i < ROWS; i++) {
        r.time[i] = 0.01 * i;
        r.gyro[i] = 1e-3 * sin(12.9898 * i * i);
    }
    return r;
}

/* Leave a row out. */
static void lose(record *r, size_t row)
{
    memmove(r->time + row, r->time + row + 1, (r->rows - row - 1) * sizeof *r->time);
    memmove(r->gyro + row, r->gyro + row + 1, (r->rows - row - 1) * sizeof *r->gyro);
    r->rows--;
}

static imk_record_source arrays_of(const record *r, imk_array_source *memory)
{
    static const char *const names[] = {"time", "gyro_x"};
    const double *const data[] = {r->time, r->gyro};
    imk_record_source source;
    imk_error error;
    CHECK_OK(imk_array_source_make(2, names, data, r->rows, 0, memory, &source, &error));
    return source;
}

static imk_log_reader *text_of(const record *r, char *text)
{
    imk_log_reader *reader;
    imk_error error;
    size_t used = (size_t)sprintf(text, "time [s],gyro_x [rad/s]\n");
    for (size_t i = 0; i < r->rows; i++)
        used += (size_t)sprintf(text + used, "%.17g,%.17g\n", r->time[i], r->gyro[i]);
    CHECK_OK(imk_log_open_memory(text, used, NULL, &reader, &error));
    return reader;
}

static void assert_same(const imk_even_record *a, const imk_even_record *b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->rows, b->rows);
    assert_true(a->dt == b->dt);
    assert_int_equal(a->missing, b->missing);
    assert_int_equal(a->not_finite, b->not_finite);
    for (size_t i = 0; i < a->rows; i++) {
        const double x = imk_even_record_data(a, 0)[i], y = imk_even_record_data(b, 0)[i];
        assert_true(x == y || (isnan(x) && isnan(y)));
    }
}

static void test_arrays_are_a_log(void **state)
{
    (void)state;
    static char text[TEXT];
    record r = make_record();
    r.gyro[7] = nan_value;
    lose(&r, 50);
    lose(&r, 51);
    for (int gaps = IMK_GAPS_BRIDGE; gaps <= IMK_GAPS_KEEP; gaps++) {
        imk_array_source memory;
        imk_findings findings[2] = {{0}, {0}};
        imk_even_record even[2];
        imk_error error;
        const imk_job job = {.memory = 0};
        const imk_record_source arrays = arrays_of(&r, &memory);
        imk_log_reader *reader = text_of(&r, text);
        const imk_record_source log = imk_log_source(reader);
        CHECK_OK(imk_even_record_load(&arrays, (imk_gap_policy)gaps, &job, &even[0], &findings[0],
                                      &error));
        CHECK_OK(
            imk_even_record_load(&log, (imk_gap_policy)gaps, &job, &even[1], &findings[1], &error));
        assert_same(&even[0], &even[1]);
        assert_int_equal(findings[0].count, findings[1].count);
        /* Rewound, both are as they were. */
        imk_even_record_free(&even[1]);
        CHECK_OK(log.rewind(log.context, &error));
        CHECK_OK(
            imk_even_record_load(&log, (imk_gap_policy)gaps, &job, &even[1], &findings[1], &error));
        assert_same(&even[0], &even[1]);
        imk_even_record_free(&even[0]);
        imk_even_record_free(&even[1]);
        imk_log_close(reader);
    }
}

static void test_what_is_missing(void **state)
{
    (void)state;
    record r = make_record();
    imk_array_source memory;
    imk_findings findings = {.count = 0};
    imk_even_record even;
    imk_error error;
    char text[300];
    const imk_job job = {.memory = 0};
    r.time[20] = nan_value; /* one row, though its place is missing too */
    lose(&r, 100);
    lose(&r, 100);
    const imk_record_source source = arrays_of(&r, &memory);
    CHECK_OK(imk_even_record_load(&source, IMK_GAPS_KEEP, &job, &even, &findings, &error));
    assert_int_equal(even.rows, ROWS);
    assert_int_equal(even.not_finite, 1);
    assert_int_equal(even.missing, 3);
    assert_int_equal(even.holes, 2);
    assert_int_equal(even.longest_hole, 2);
    assert_int_equal(findings.count, 2);
    imk_finding_text(&findings.item[0], text, sizeof text);
    assert_string_equal(text, "1 row with a value that is not a finite number or beyond 1e60, "
                              "first in row 21: counted as missing");
    imk_finding_text(&findings.item[1], text, sizeof text);
    assert_string_equal(
        text,
        "3 of 600 samples are missing, in 2 gaps, the longest of 0.02 s; the gaps stay empty");
    imk_even_record_free(&even);
    CHECK_OK(source.rewind(source.context, &error));
    findings.count = 0;
    CHECK_STATUS(imk_even_record_load(&source, IMK_GAPS_REFUSE, &job, &even, &findings, &error),
                 IMK_ERROR_GAP);
    assert_string_equal(imk_findings_failure(&findings)->code, "refused_not_finite");
    imk_even_record_free(&even);
}

static bool give_up(void *context, const char *stage, const char *unit, uint64_t done,
                    uint64_t total)
{
    int *left = context;
    (void)stage, (void)unit, (void)done, (void)total;
    return (*left)-- > 0;
}

static void test_given_up(void **state)
{
    (void)state;
    const record r = make_record();
    for (int calls = 0; calls < 2; calls++) {
        imk_array_source memory;
        imk_allan_log *found;
        imk_error error;
        int left = calls;
        const imk_job job = {.progress = give_up, .progress_context = &left};
        const imk_record_source source = arrays_of(&r, &memory);
        const imk_allan_log_settings settings = imk_allan_log_default();
        CHECK_STATUS(imk_allan_log_run(&source, &settings, &job, &found, &error),
                     IMK_ERROR_CANCELLED);
        imk_allan_log_free(found);
    }
}

static size_t calls, fail_at, pieces;

static void *failing(void *context, void *at, size_t size)
{
    (void)context;
    if (size == 0) {
        pieces -= at != NULL;
        free(at);
        return NULL;
    }
    if (++calls == fail_at)
        return NULL;
    pieces += at == NULL;
    return realloc(at, size);
}

static imk_status run_job(int which, const imk_record_source *source, const imk_job *job)
{
    imk_error error;
    imk_status status = IMK_OK;
    if (which == 0) {
        imk_allan_log *found;
        imk_allan_log_settings settings = imk_allan_log_default();
        settings.statistic_count = 2;
        settings.statistic[1] = IMK_ALLAN_MODIFIED;
        status = imk_allan_log_run(source, &settings, job, &found, &error);
        imk_allan_log_free(found);
    } else if (which == 1) {
        imk_spectrum_log *found;
        const imk_spectrum_log_settings settings = imk_spectrum_log_default();
        status = imk_spectrum_log_run(source, &settings, job, &found, &error);
        imk_spectrum_log_free(found);
    } else {
        imk_identify_log *found;
        const imk_identify_log_settings settings = imk_identify_log_default();
        status = imk_identify_log_run(source, &settings, job, &found, &error);
        imk_identify_log_free(found);
    }
    return status;
}

/* Wherever memory fails, the job says so and everything is given back; only what is to be smaller
 * may stay as it is. */
static void test_failing_memory(void **state)
{
    (void)state;
    const record r = make_record();
    const imk_job job = {.allocator = {failing, NULL}};
    for (int which = 0; which < 3; which++) {
        int refused = 0;
        bool whole = false;
        for (fail_at = 1; !whole; fail_at++) {
            imk_array_source memory;
            const imk_record_source source = arrays_of(&r, &memory);
            calls = 0;
            const imk_status status = run_job(which, &source, &job);
            whole = calls < fail_at;
            refused += status == IMK_ERROR_MEMORY;
            assert_true(status == IMK_OK || (status == IMK_ERROR_MEMORY && !whole));
            assert_int_equal(pieces, 0);
        }
        assert_true(refused >= (int)fail_at - 5); /* two columns and a spare call */
    }
}

static void test_wrong_arrays(void **state)
{
    (void)state;
    static const char *const names[] = {"gyro_x", "gyro_x"};
    const double values[] = {1, 2}, *const data[] = {values, values};
    imk_array_source memory;
    imk_record_source source;
    imk_error error;
    CHECK_STATUS(imk_array_source_make(2, names, data, 2, 100, &memory, &source, &error),
                 IMK_ERROR_COLUMN);
    CHECK_STATUS(imk_array_source_make(1, names, data, 2, 0, &memory, &source, &error),
                 IMK_ERROR_RATE_MISSING);
    CHECK_STATUS(imk_array_source_make(0, names, data, 2, 100, &memory, &source, &error),
                 IMK_ERROR_COLUMN);
    const imk_log_column axis = imk_record_column("accel_3"), other = imk_record_column("gyro_xy");
    assert_int_equal(axis.quantity, IMK_QUANTITY_SPECIFIC_FORCE);
    assert_int_equal(axis.axis, 3);
    assert_int_equal(other.quantity, IMK_QUANTITY_OTHER);
}

/* Arrays in other units are read in SI units, as a file's columns are. */
static void test_units_of_arrays(void **state)
{
    (void)state;
    static const char *const names[] = {"time [ms]", "gyro_x [deg/s]", "temperature [degC]",
                                        "accel_x [count]"};
    static const char *const wrong[] = {"gyro_x [m/s]", "gyro_x [deg/s", "gyro_x [quux]"};
    const double time[] = {0, 10, 20}, rate[] = {180, -90, 0}, celsius[] = {25, 0, -40};
    const double counts[] = {1, 2, 3}, *const data[] = {time, rate, celsius, counts};
    double read[4][3], *const to[] = {read[0], read[1], read[2], read[3]};
    imk_array_source memory;
    imk_record_source source;
    imk_error error;
    size_t rows;
    CHECK_OK(imk_array_source_make(4, names, data, 3, 0, &memory, &source, &error));
    CHECK_OK(source.read(source.context, 3, to, &rows, &error));
    CHECK_CLOSE(source.findings(source.context).interval, 0.01, 1e-15);
    CHECK_CLOSE(read[0][2], 0.02, 1e-15);
    CHECK_CLOSE(read[1][0], 3.141592653589793, 1e-15);
    CHECK_CLOSE(read[2][2], 233.15, 1e-12);
    CHECK_CLOSE(read[3][2], 3, 0);
    assert_string_equal(source.columns[1].name, "gyro_x");
    assert_string_equal(source.columns[1].unit.text, "deg/s");
    CHECK_STATUS(imk_array_source_make(1, wrong, data, 3, 100, &memory, &source, &error),
                 IMK_ERROR_DIMENSION);
    assert_string_equal(error.field, "gyro_x");
    CHECK_STATUS(imk_array_source_make(1, wrong + 1, data, 3, 100, &memory, &source, &error),
                 IMK_ERROR_UNIT_MISSING);
    CHECK_STATUS(imk_array_source_make(1, wrong + 2, data, 3, 100, &memory, &source, &error),
                 IMK_ERROR_UNIT_UNKNOWN);
}

/* Columns of a matrix that is stored row by row, and a column backwards. */
static void test_strides(void **state)
{
    (void)state;
    static const char *const names[] = {"gyro_x [deg/s]", "gyro_y", "gyro_z"};
    enum { COUNT = 4 };
    const double rows[COUNT][2] = {{1, 10}, {2, 20}, {3, (double)NAN}, {4, 40}};
    const double *const data[] = {&rows[0][0], &rows[0][1], &rows[COUNT - 1][0]};
    const ptrdiff_t strides[] = {2, 2, -2};
    double x[COUNT], y[COUNT], z[COUNT], *const columns[] = {x, y, z};
    imk_array_source memory;
    imk_record_source source;
    imk_error error;
    size_t read;
    CHECK_OK(
        imk_array_source_strided(3, names, data, strides, COUNT, 100, &memory, &source, &error));
    CHECK_OK(source.read(source.context, COUNT, columns, &read, &error));
    assert_int_equal(read, COUNT);
    for (int k = 0; k < COUNT; k++) {
        assert_true(fabs(x[k] - (k + 1) * 3.14159265358979323846 / 180) < 1e-15);
        assert_true(z[k] == COUNT - k);
        if (k != 2)
            assert_true(y[k] == 10 * (k + 1));
    }
    const imk_log_findings findings = source.findings(source.context);
    assert_int_equal(findings.not_finite, 1);
    assert_int_equal(findings.first_not_finite, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units_of_arrays), cmocka_unit_test(test_arrays_are_a_log),
        cmocka_unit_test(test_what_is_missing), cmocka_unit_test(test_given_up),
        cmocka_unit_test(test_failing_memory),  cmocka_unit_test(test_wrong_arrays),
        cmocka_unit_test(test_strides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
