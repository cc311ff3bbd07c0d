/* SPDX-License-Identifier: Apache-2.0 */
/* Jobs refuse what they cannot use, and say which: no source, sink, model or settings, and numbers
 * out of range. */
#include "check.h"

#include "imukit/jobs.h"

#include <string.h>

enum { ROWS = 1000, RATE = 100, COLUMNS = 7 };

static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                           "accel_x", "accel_y", "accel_z"};
static double data[COLUMNS][ROWS], out[COLUMNS][ROWS];
static double *const arrays[COLUMNS] = {out[0], out[1], out[2], out[3], out[4], out[5], out[6]};
static imk_model model;
static imk_array_source memory;
static imk_record_source source;
static imk_array_sink sink_memory;
static imk_record_sink sink;
static imk_error error;

static int set_up(void **state)
{
    const double *columns[COLUMNS];
    (void)state;
    for (int i = 0; i < ROWS; i++) {
        data[0][i] = (double)i / RATE;
        for (int c = 1; c < COLUMNS; c++)
            data[c][i] = 1e-3 * sin(12.9898 * c * i * i) - (c == 6 ? 9.8 : 0);
    }
    for (int c = 0; c < COLUMNS; c++)
        columns[c] = data[c];
    imk_model_default(&model);
    CHECK_OK(imk_array_source_make(COLUMNS, names, columns, ROWS, 0, &memory, &source, &error));
    sink_memory = (imk_array_sink){.column_count = COLUMNS, .capacity = ROWS, .data = arrays};
    sink = imk_array_sink_of(&sink_memory);
    return 0;
}

static void assert_refused(imk_status status, imk_status expected, const char *field)
{
    CHECK_STATUS(status, expected);
    CHECK_STATUS(error.status, expected);
    assert_string_equal(error.field, field);
}

/* ---- each job, by what it is handed; settings NULL: those of its _default function ---- */

static const void *settings_handed; /* &none: NULL */
static const char none;
#define HANDED(made) (settings_handed == &none ? NULL : settings_handed ? settings_handed : &(made))

#define JOB_OF_SOURCE(job)                                                                         \
    static imk_status job(const imk_record_source *from)                                           \
    {                                                                                              \
        imk_##job##_log *found = NULL;                                                             \
        const imk_##job##_log_settings made = imk_##job##_log_default();                           \
        const imk_status status = imk_##job##_log_run(from, HANDED(made), NULL, &found, &error);   \
        imk_##job##_log_free(found);                                                               \
        return status;                                                                             \
    }
JOB_OF_SOURCE(allan)
JOB_OF_SOURCE(spectrum)
JOB_OF_SOURCE(identify)

static imk_status navigate(const imk_record_source *from)
{
    imk_navigate_log *found = NULL;
    imk_navigate_log_settings made = imk_navigate_log_default();
    made.align = 5;
    made.place.latitude = 0.8;
    const imk_status status = imk_navigate_log_run(from, HANDED(made), NULL, &found, &error);
    imk_navigate_log_free(found);
    return status;
}

static imk_status compensate_to(const imk_record_source *from, const imk_model *by,
                                const imk_compensate_log_settings *settings,
                                const imk_record_sink *to)
{
    imk_compensate_log *found = NULL;
    sink_memory.rows = 0;
    const imk_status status = imk_compensate_log_run(from, by, settings, to, NULL, &found, &error);
    imk_compensate_log_free(found);
    return status;
}

static imk_status compensate(const imk_record_source *from)
{
    const imk_compensate_log_settings made = imk_compensate_log_default();
    return compensate_to(from, &model, HANDED(made), &sink);
}

static imk_status convert(const imk_record_source *from)
{
    const imk_convert_log_settings made = imk_convert_log_default();
    sink_memory.rows = 0;
    return imk_convert_log_run(from, HANDED(made), &sink, NULL, NULL, &error);
}

static imk_status load_test(const imk_record_source *from)
{
    imk_calibrate_record record = {.path = NULL};
    const imk_calibrate_log_settings made = imk_calibrate_log_default();
    const imk_status status =
        imk_calibrate_record_load(HANDED(made), "record", from, NULL, &record, &error);
    imk_calibrate_record_free(&record);
    return status;
}

static imk_status (*const jobs[])(const imk_record_source *from) = {
    allan, spectrum, identify, navigate, compensate, convert, load_test};
enum { JOBS = sizeof jobs / sizeof *jobs };

static imk_status run(int job, const imk_record_source *from)
{
    CHECK_OK(source.rewind(source.context, NULL));
    return jobs[job](from);
}

static void test_sources(void **state)
{
    (void)state;
    imk_record_source wrong[5] = {{.context = NULL}, source, source, source, source};
    wrong[1].read = NULL;
    wrong[2].columns = NULL;
    wrong[3].column_count = 0;
    wrong[4].column_count = IMK_LOG_COLUMNS_MAX + 1;
    for (int j = 0; j < JOBS; j++) {
        assert_refused(run(j, NULL), IMK_ERROR_ARGUMENT, "source");
        for (int k = 0; k < 5; k++)
            assert_refused(run(j, &wrong[k]), IMK_ERROR_ARGUMENT, "source");
        assert_true(error.value == IMK_LOG_COLUMNS_MAX + 1 && error.limit == IMK_LOG_COLUMNS_MAX);
    }
}

/* All that a source may leave out. */
static void test_bare_source(void **state)
{
    (void)state;
    imk_record_source bare = source;
    bare.findings = NULL;
    bare.progress = NULL;
    bare.rewind = NULL;
    for (int j = 0; j < JOBS; j++)
        CHECK_STATUS(run(j, &bare), run(j, &source));
    CHECK_OK(run(0, &bare));
    CHECK_OK(run(4, &bare));
    assert_int_equal(sink_memory.rows, ROWS);
    assert_int_equal(sink_memory.column_count, COLUMNS);
}

static void test_settings(void **state)
{
    (void)state;
    static const double zeros[128];
    for (int j = 0; j < JOBS; j++) {
        settings_handed = &none;
        assert_refused(run(j, &source), IMK_ERROR_ARGUMENT, "settings");
        settings_handed = zeros;
        assert_refused(run(j, &source), IMK_ERROR_UNINITIALISED, "settings");
        settings_handed = NULL;
    }
    const imk_allan_log_settings settings = imk_allan_log_default();
    assert_refused(imk_allan_log_run(&source, &settings, NULL, NULL, &error), IMK_ERROR_ARGUMENT,
                   "result");
}

static imk_status simulate_by(const imk_model *by, const imk_simulate_log_settings *settings,
                              const imk_record_sink *to)
{
    sink_memory.rows = 0;
    return imk_simulate_log_run(by, settings, to, "simulating", NULL, &error);
}

static void test_sinks_and_models(void **state)
{
    (void)state;
    const imk_record_sink zero_sink = {.context = NULL};
    static const imk_model zero;
    const imk_compensate_log_settings c = imk_compensate_log_default();
    const imk_convert_log_settings v = imk_convert_log_default();
    imk_simulate_log_settings s = imk_simulate_log_default();
    imk_graded *graded;
    s.rows = 10;
    CHECK_OK(simulate_by(&model, &s, &sink));
    assert_refused(simulate_by(&model, &s, &zero_sink), IMK_ERROR_ARGUMENT, "sink");
    assert_refused(simulate_by(&model, &s, NULL), IMK_ERROR_ARGUMENT, "sink");
    assert_refused(simulate_by(&model, NULL, &sink), IMK_ERROR_ARGUMENT, "settings");
    assert_refused(simulate_by(NULL, &s, &sink), IMK_ERROR_UNINITIALISED, "model");
    assert_refused(simulate_by(&zero, &s, &sink), IMK_ERROR_UNINITIALISED, "model");
    assert_refused(compensate_to(&source, &model, &c, &zero_sink), IMK_ERROR_ARGUMENT, "sink");
    assert_refused(compensate_to(&source, &zero, &c, &sink), IMK_ERROR_UNINITIALISED, "model");
    assert_refused(compensate_to(&source, NULL, &c, &sink), IMK_ERROR_UNINITIALISED, "model");
    assert_refused(imk_convert_log_run(&source, &v, &zero_sink, NULL, NULL, &error),
                   IMK_ERROR_ARGUMENT, "sink");
    assert_refused(imk_grade_run(&zero, NULL, &graded, &error), IMK_ERROR_UNINITIALISED, "model");
    assert_null(graded);
}

/* The room stays what it was, and too little of it is said in numbers. */
static void test_array_sink(void **state)
{
    (void)state;
    imk_array_sink few = {.column_count = 2, .capacity = ROWS, .data = arrays};
    const imk_record_sink narrow = imk_array_sink_of(&few);
    imk_convert_log_settings v = imk_convert_log_default();
    CHECK_OK(source.rewind(source.context, NULL));
    assert_refused(imk_convert_log_run(&source, &v, &narrow, NULL, NULL, &error),
                   IMK_ERROR_WORKSPACE, "sink");
    assert_non_null(strstr(error.expected, "7 arrays"));
    v.select = "gyro_x";
    CHECK_OK(imk_convert_log_run(&source, &v, &narrow, NULL, NULL, &error));
    assert_int_equal(few.columns, 1);
    assert_int_equal(few.column_count, 2);
    v.select = "gyro_x,gyro_y";
    few.rows = 0;
    CHECK_OK(source.rewind(source.context, NULL));
    CHECK_OK(imk_convert_log_run(&source, &v, &narrow, NULL, NULL, &error));
    assert_int_equal(few.columns, 2);
}

static void test_array_source(void **state)
{
    (void)state;
    const char *const nameless[] = {NULL};
    const double *const columns[] = {data[0]};
    imk_array_source made;
    imk_record_source from;
    assert_refused(imk_array_source_make(1, nameless, columns, 1, 1, &made, &from, &error),
                   IMK_ERROR_ARGUMENT, "names");
    assert_refused(imk_array_source_make(1, NULL, columns, 1, 1, &made, &from, &error),
                   IMK_ERROR_ARGUMENT, "columns");
}

/* ---- numbers ---- */

static void test_confidence(void **state)
{
    (void)state;
    const double wrong[] = {0, 1, -0.5, 95, (double)NAN};
    imk_allan_log_settings a = imk_allan_log_default();
    imk_spectrum_log_settings s = imk_spectrum_log_default();
    imk_identify_log_settings i = imk_identify_log_default();
    for (int k = 0; k < 5; k++) {
        a.confidence = s.confidence = i.confidence = wrong[k];
        for (int j = 0; j < 3; j++) {
            settings_handed = j == 0 ? (const void *)&a : j == 1 ? (const void *)&s : &i;
            assert_refused(run(j, &source), IMK_ERROR_RANGE, "confidence");
            assert_true(error.value == wrong[k] || isnan(wrong[k]));
        }
    }
    a = imk_allan_log_default();
    a.statistic_count = 1000;
    settings_handed = &a;
    assert_refused(run(0, &source), IMK_ERROR_RANGE, "statistic_count");
    settings_handed = NULL;
}

static void test_units_and_lengths(void **state)
{
    (void)state;
    imk_simulate_log_settings s = imk_simulate_log_default();
    imk_compensate_log_settings c = imk_compensate_log_default();
    imk_convert_log_settings v = imk_convert_log_default();
    assert_refused(simulate_by(&model, &s, &sink), IMK_ERROR_RANGE, "rows");
    s.rows = 10;
    s.gyro_unit = imk_unit_of("m");
    assert_refused(simulate_by(&model, &s, &sink), IMK_ERROR_DIMENSION, "gyro_unit");
    s.gyro_unit = imk_unit_of("deg/s");
    s.increments = true;
    assert_refused(simulate_by(&model, &s, &sink), IMK_ERROR_DIMENSION, "gyro_unit");
    s.gyro_unit = imk_unit_of("deg");
    s.accel_unit = imk_unit_of("m/s^2");
    assert_refused(simulate_by(&model, &s, &sink), IMK_ERROR_DIMENSION, "accel_unit");
    c.gyro_unit = imk_unit_of("kg");
    assert_refused(compensate_to(&source, &model, &c, &sink), IMK_ERROR_DIMENSION, "gyro_unit");
    c = imk_compensate_log_default();
    c.temperature = -1;
    assert_refused(compensate_to(&source, &model, &c, &sink), IMK_ERROR_RANGE, "temperature");
    assert_true(error.value == -1);
    v.gravity_free = true;
    v.latitude = 0.8;
    v.still = 11;
    settings_handed = &v;
    assert_refused(run(5, &source), IMK_ERROR_RANGE, "still");
    CHECK_CLOSE(error.limit, 10, 1e-9);
    v.still = 10;
    CHECK_OK(run(5, &source));
    settings_handed = NULL;
}

/* What is behind a tab belongs to a finding. */
static void test_field_without_tab(void **state)
{
    (void)state;
    imk_convert_log_settings v = imk_convert_log_default();
    v.select = "gyro_w";
    settings_handed = &v;
    assert_refused(run(5, &source), IMK_ERROR_COLUMN, "gyro_w");
    settings_handed = NULL;
}

static void test_navigate_settings(void **state)
{
    (void)state;
    imk_navigate_log_settings n = imk_navigate_log_default();
    n.align = 0.5;
    settings_handed = &n;
    assert_refused(run(3, &source), IMK_ERROR_RANGE, "align");
    assert_true(error.value == 0.5 && error.limit == 1 && error.expected[0]);
    settings_handed = NULL;
}

/* ---- drift ---- */

static imk_status times_of(double duration, size_t count, double stated, imk_drift_times *times)
{
    return imk_drift_times_choose(duration, count, &stated, 0, RATE, false, 0.0, NULL, times,
                                  &error);
}

static bool count_calls(void *context, const char *stage, const char *unit, uint64_t done,
                        uint64_t total)
{
    (void)stage, (void)unit;
    ++*(int *)context;
    assert_true(done <= total);
    return true;
}

static void test_drift(void **state)
{
    (void)state;
    imk_drift_times times;
    imk_drift_models *found = NULL;
    imk_drift_models_settings s = imk_drift_models_default();
    const imk_model *many[9];
    const char *called[9];
    int calls = 0;
    const imk_job job = {.progress = count_calls, .progress_context = &calls};
    for (int k = 0; k < 9; k++) {
        many[k] = &model;
        called[k] = "model";
    }
    assert_refused(times_of(0, 0, 0, &times), IMK_ERROR_RANGE, "duration");
    assert_refused(times_of(0, 1, -60, &times), IMK_ERROR_RANGE, "stated");
    assert_true(error.value == -60);
    CHECK_OK(times_of(0, 1, 60, &times));
    assert_refused(imk_drift_models_run(9, many, called, &times, &s, NULL, &found, &error),
                   IMK_ERROR_RANGE, "count");
    assert_refused(imk_drift_models_run(1, many, NULL, &times, &s, NULL, &found, &error),
                   IMK_ERROR_ARGUMENT, "names");
    assert_refused(imk_drift_models_run(1, NULL, called, &times, &s, NULL, &found, &error),
                   IMK_ERROR_ARGUMENT, "models");
    assert_refused(imk_drift_models_run(1, many, called, NULL, &s, NULL, &found, &error),
                   IMK_ERROR_ARGUMENT, "times");
    assert_refused(imk_drift_models_run(1, many, called, &times, NULL, NULL, &found, &error),
                   IMK_ERROR_ARGUMENT, "settings");
    s.want = (imk_drift_wanted){.asked = true, .goal = 1000, .time = 3600};
    assert_refused(imk_drift_models_run(1, many, called, &times, &s, NULL, &found, &error),
                   IMK_ERROR_RANGE, "want.time");
    assert_true(error.value == 3600 && error.limit == 60);
    assert_null(found);
    s.want.asked = false;
    CHECK_OK(imk_drift_models_run(2, many, called, &times, &s, &job, &found, &error));
    assert_int_equal(calls, 3);
    imk_drift_models_free(found);
    imk_drift_times_free(&times);
}

/* ---- physics ---- */

static void test_physics(void **state)
{
    (void)state;
    static double of_another[512];
    imk_physics_log_settings s = imk_physics_log_default();
    imk_physics_log *log = NULL;
    imk_physics_view view;
    imk_physics_sweep *sweep = NULL;
    s.duration = 1;
    assert_refused(imk_physics_log_run(&s, NULL, NULL, NULL, &log, &error), IMK_ERROR_ARGUMENT,
                   "instrument");
    s.instrument = imk_instrument_find("ring_laser");
    assert_refused(imk_physics_log_run(&s, NULL, NULL, NULL, &log, &error), IMK_ERROR_ARGUMENT,
                   "design");
    imk_instrument_find("pendulous_servo")->set_default(of_another);
    s.design = of_another;
    assert_refused(imk_physics_log_run(&s, NULL, NULL, NULL, &log, &error), IMK_ERROR_UNINITIALISED,
                   "design");
    assert_refused(imk_physics_sweep_run(&s, NULL, &sweep, &error), IMK_ERROR_UNINITIALISED,
                   "design");
    assert_refused(imk_physics_view_run(&s, 0, NULL, &view, &error), IMK_ERROR_UNINITIALISED,
                   "design");
    imk_physics_view_free(&view);
    s.instrument = imk_instrument_find("pendulous_servo");
    assert_refused(imk_physics_view_run(&s, 1000, NULL, &view, &error), IMK_ERROR_RANGE, "index");
    s.duration = 0;
    assert_refused(imk_physics_log_run(&s, NULL, NULL, NULL, &log, &error), IMK_ERROR_RANGE,
                   "duration");
    assert_null(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sources),
        cmocka_unit_test(test_bare_source),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_sinks_and_models),
        cmocka_unit_test(test_array_sink),
        cmocka_unit_test(test_array_source),
        cmocka_unit_test(test_confidence),
        cmocka_unit_test(test_units_and_lengths),
        cmocka_unit_test(test_field_without_tab),
        cmocka_unit_test(test_navigate_settings),
        cmocka_unit_test(test_drift),
        cmocka_unit_test(test_physics),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
