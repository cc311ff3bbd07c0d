/* SPDX-License-Identifier: Apache-2.0 */
/* What a program asks of a drift: a requirement as text, times by what is known, and runs in memory
 * that are the same whatever the number of threads. */
#include "check.h"

#include "imukit/drift_models.h"
#include "imukit/model_file.h"
#include "imukit/thread_pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void test_requirement(void **state)
{
    (void)state;
    imk_drift_wanted want;
    imk_error error;
    bool after;
    CHECK_OK(imk_drift_wanted_parse("CEP 1 nmi @ 1h", &want, &after, &error));
    assert_true(want.asked && !after && want.figure == IMK_REQUIRED_CEP);
    CHECK_CLOSE(want.goal, 1852.0, 1e-9);
    CHECK_CLOSE(want.time, 3600.0, 0.0);
    CHECK_OK(imk_drift_wanted_parse(" tilt <= 180 deg after 2 min", &want, &after, &error));
    assert_true(after && want.figure == IMK_REQUIRED_TILT);
    CHECK_RELATIVE(want.goal, 3.14159265358979, 1e-12);
    static const struct {
        const char *text;
        imk_status status;
    } wrong[] = {{"CEP 1 nmi", IMK_ERROR_EMPTY},        {"CEP @ 1h", IMK_ERROR_EMPTY},
                 {"CPE 1 nmi @ 1h", IMK_ERROR_SYNTAX},  {"", IMK_ERROR_SYNTAX},
                 {"CEP 1 kg @ 1h", IMK_ERROR_SYNTAX},   {"CEP 1 nmi @ 1 m", IMK_ERROR_SYNTAX},
                 {"CEP -1 m @ 1h", IMK_ERROR_SYNTAX},   {"CEP 1 m after -3 s", IMK_ERROR_SYNTAX},
                 {"CEP 1e-10 m @ 1h", IMK_ERROR_RANGE}, {"CEP 1e10 m @ 1h", IMK_ERROR_RANGE}};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++)
        assert_int_equal(imk_drift_wanted_parse(wrong[k].text, &want, &after, &error),
                         wrong[k].status);
    assert_true(want.figure == IMK_REQUIRED_TILT); /* as it was */
}

/* Rows of the table that are chosen. */
static void check_times(const imk_drift_when *when, const imk_drift_settings *s,
                        const imk_drift_wanted *want, size_t count, const double *due)
{
    imk_drift_times times;
    imk_error error;
    CHECK_OK(imk_drift_times_ask(when, s, want, NULL, &times, &error));
    assert_true(times.row_count >= count);
    for (size_t k = 0; k < count; k++) /* the last ones */
        CHECK_CLOSE(times.time[times.row[times.row_count - count + k]], due[k], 1e-9);
    imk_drift_times_free(&times);
}

static void test_times(void **state)
{
    (void)state;
    imk_drift_settings s = imk_drift_default();
    imk_drift_wanted want;
    imk_aid aid = imk_aid_default(IMK_AID_POSITION);
    imk_error error;
    bool after;
    const double day[] = {86400}, hour[] = {3600}, end[] = {43.5}, stated[] = {20, 10},
                 rows[] = {10, 20}, usual[] = {600, 610, 660, 900}, until[] = {600, 610, 660},
                 behind[] = {600, 610, 620};
    CHECK_OK(imk_drift_wanted_parse("CEP 1 nmi @ 1h", &want, &after, &error));
    check_times(&(imk_drift_when){.duration = 0}, &s, NULL, 1, day);
    check_times(&(imk_drift_when){.duration = 0}, &s, &want, 1, hour);
    check_times(&(imk_drift_when){.motion = 43.5}, &s, NULL, 1, end);
    check_times(&(imk_drift_when){.time_count = 2, .time = stated}, &s, NULL, 2, rows);
    s.aid = &aid;
    s.aid_count = 1;
    check_times(&(imk_drift_when){.duration = 0}, &s, NULL, 1, day);
    aid.until = 600;
    check_times(&(imk_drift_when){.duration = 0}, &s, NULL, 4, usual);
    check_times(&(imk_drift_when){.motion = 700}, &s, NULL, 3, until);
    check_times(&(imk_drift_when){.outage_count = 2, .outage = stated}, &s, NULL, 3, behind);
}

static void test_wrong_times(void **state)
{
    (void)state;
    const double nan = (double)NAN, one[] = {10}, none[] = {0}, bad[] = {nan};
    const imk_drift_settings s = imk_drift_default();
    imk_drift_times times;
    imk_drift_wanted want;
    imk_error error;
    bool after;
    const struct {
        imk_drift_when when;
        imk_status status;
        const char *field;
    } wrong[] = {
        {{.duration = -1}, IMK_ERROR_RANGE, "duration"},
        {{.duration = nan}, IMK_ERROR_RANGE, "duration"},
        {{.duration = 2e8}, IMK_ERROR_RANGE, "duration"},
        {{.duration = 0.001}, IMK_ERROR_RANGE, "duration"},
        {{.duration = 60, .time_count = 1, .time = one}, IMK_ERROR_CONFLICT, ""},
        {{.time_count = 0, .time = one}, IMK_ERROR_EMPTY, "times"},
        {{.time_count = 1, .time = none}, IMK_ERROR_RANGE, "times"},
        {{.time_count = 1, .time = bad}, IMK_ERROR_RANGE, "times"},
        {{.time_count = 100, .time = one}, IMK_ERROR_RANGE, "times"},
        {{.outage_count = 1, .outage = one}, IMK_ERROR_EMPTY, "outage"},
        {{.duration = 10, .motion = 5}, IMK_ERROR_RANGE, "motion"},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        assert_int_equal(imk_drift_times_ask(&wrong[k].when, &s, NULL, NULL, &times, &error),
                         wrong[k].status);
        assert_string_equal(error.field, wrong[k].field);
    }
    CHECK_OK(imk_drift_wanted_parse("CEP 1 m @ 1h", &want, &after, &error));
    assert_int_equal(
        imk_drift_times_ask(&(imk_drift_when){.duration = 60}, &s, &want, NULL, &times, &error),
        IMK_ERROR_RANGE);
    assert_string_equal(error.field, "want.time");
}

/* Runs of 21 on some threads, beside the covariance. */
static void simulate(const imk_model *model, size_t threads, double *kept)
{
    const char *name = "tactical";
    imk_drift_models_settings settings = imk_drift_models_default();
    imk_thread_pool *pool = imk_thread_pool_create(threads);
    const imk_executor executor = imk_thread_pool_executor(pool);
    const imk_job job = {.executor = &executor};
    const double *errors;
    imk_drift_times times;
    imk_drift_models *r;
    imk_error error;
    CHECK_OK(imk_drift_times_ask(&(imk_drift_when){.duration = 10}, &settings.drift, NULL, NULL,
                                 &times, &error));
    CHECK_OK(imk_drift_models_run(1, &model, &name, &times, &settings, &job, &r, &error));
    CHECK_OK(imk_drift_models_simulate(r, 1, 21, &job, &errors, &error));
    assert_int_equal(r->run_count, 21);
    const size_t last = times.row_count - 1;
    for (size_t run = 0; run < 21; run++)
        kept[run] = errors[(run * times.row_count + last) * IMK_DRIFT_STATES];
    double sum = 0;
    for (size_t run = 0; run < 21; run++)
        sum += kept[run] * kept[run];
    CHECK_RELATIVE(sqrt(sum / 21), r->found[last].north, 1e-12);
    assert_int_equal(imk_drift_models_simulate(r, 1, 0, &job, &errors, &error), IMK_ERROR_RANGE);
    imk_drift_models_free(r);
    imk_drift_times_free(&times);
    imk_thread_pool_destroy(pool);
}

static void test_runs(void **state)
{
    (void)state;
    double one[21], three[21];
    imk_error error;
    imk_model *model = malloc(sizeof *model);
    assert_non_null(model);
    CHECK_OK(imk_model_open("tactical", model, NULL, &error));
    simulate(model, 1, one);
    simulate(model, 3, three);
    assert_memory_equal(one, three, sizeof one);
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_requirement),
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_wrong_times),
        cmocka_unit_test(test_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
