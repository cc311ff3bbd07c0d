/* SPDX-License-Identifier: Apache-2.0 */
/* Rows that are taken when they are wanted are those of the log, however they are divided. */
#include "check.h"

#include "imukit/simulate_log.h"

#include <math.h>
#include <string.h>

enum { ROWS = 1000, COLUMNS = 8 };

typedef struct table {
    double data[COLUMNS][ROWS];
    double *column[COLUMNS];
} table;

static imk_model model;
static imk_simulate_log_settings settings;
static imk_error error;
static table whole, parts;

static int set_up(void **state)
{
    (void)state;
    imk_model_default(&model);
    for (int k = 0; k < 3; k++)
        model.gyro.noise.white.value[k] = model.accel.noise.bias_instability.value[k] = 1e-3;
    settings = imk_simulate_log_default();
    settings.rows = ROWS;
    for (int c = 0; c < COLUMNS; c++) {
        whole.column[c] = whole.data[c];
        parts.column[c] = parts.data[c];
    }
    return 0;
}

static size_t make_whole(void)
{
    imk_array_sink sink = {.column_count = COLUMNS, .capacity = ROWS, .data = whole.column};
    const imk_record_sink to = imk_array_sink_of(&sink);
    CHECK_OK(imk_simulate_log_run(&model, &settings, &to, "", NULL, &error));
    return sink.rows;
}

/* In blocks of 1, 2, 3 … rows. */
static size_t make_parts(uint64_t end)
{
    imk_simulated_rows *rows = NULL;
    size_t count = 0, columns, made;
    CHECK_OK(imk_simulated_rows_start(&model, &settings, NULL, &rows, &error));
    assert_string_equal(imk_simulated_rows_columns(rows, &columns)[0].name, "time");
    for (size_t most = 1; imk_simulated_rows_left(rows) > end; most++) {
        double *at[COLUMNS];
        for (size_t c = 0; c < columns; c++)
            at[c] = parts.column[c] + count;
        if (count + most > ROWS)
            most = ROWS - count;
        CHECK_OK(imk_simulated_rows_next(rows, most, at, "", NULL, &made, &error));
        count += made;
    }
    imk_simulated_rows_free(rows);
    return count;
}

static void test_division(void **state)
{
    (void)state;
    imk_temperature_profile profile = {
        .point_count = 1, .time = (double[]){0}, .temperature = (double[]){300}};
    settings.simulation.temperature = &profile;
    settings.increments = true;
    settings.start = -2;
    assert_int_equal(make_whole(), ROWS);
    assert_int_equal(make_parts(0), ROWS);
    assert_memory_equal(whole.data, parts.data, sizeof whole.data);
    assert_true(parts.data[0][0] == -2 && parts.data[7][5] == 300);
}

static void test_lost_rows(void **state)
{
    (void)state;
    model.timing.drops.value = 0.3;
    const size_t rows = make_whole();
    assert_true(rows < ROWS);
    assert_int_equal(make_parts(0), rows);
    for (size_t c = 0; c < 7; c++)
        assert_memory_equal(whole.data[c], parts.data[c], rows * sizeof(double));
}

static void test_without_end(void **state)
{
    (void)state;
    imk_simulated_rows *rows = NULL;
    size_t made;
    make_whole();
    settings.rows = 0;
    CHECK_OK(imk_simulated_rows_start(&model, &settings, NULL, &rows, &error));
    assert_true(imk_simulated_rows_left(rows) == UINT64_MAX);
    CHECK_OK(imk_simulated_rows_next(rows, ROWS, parts.column, "", NULL, &made, &error));
    assert_int_equal(made, ROWS);
    assert_memory_equal(whole.data, parts.data, 7 * sizeof whole.data[0]);
    CHECK_OK(imk_simulated_rows_next(rows, ROWS, parts.column, "", NULL, &made, &error));
    assert_true(parts.data[0][0] == 10);
    imk_simulated_rows_free(rows);
}

static bool give_up(void *context, const char *stage, const char *unit, uint64_t done,
                    uint64_t total)
{
    (void)context, (void)stage, (void)unit, (void)done, (void)total;
    return false;
}

static void test_refused(void **state)
{
    (void)state;
    imk_simulated_rows *rows = NULL;
    size_t made;
    const imk_job job = {.progress = give_up};
    imk_simulate_log_settings wrong = settings;
    wrong.simulation.rate = -1;
    assert_int_equal(imk_simulated_rows_start(&model, &wrong, NULL, &rows, &error),
                     IMK_ERROR_RANGE);
    assert_int_equal(imk_simulated_rows_start(&model, &settings, NULL, NULL, &error),
                     IMK_ERROR_ARGUMENT);
    assert_null(rows);
    CHECK_OK(imk_simulated_rows_start(&model, &settings, NULL, &rows, &error));
    assert_int_equal(imk_simulated_rows_next(rows, 10, parts.column, "", &job, &made, &error),
                     IMK_ERROR_CANCELLED);
    imk_simulated_rows_free(rows);
    imk_simulated_rows_free(NULL);
}

/* What the command takes from the model and the motion. */
static void test_completed(void **state)
{
    (void)state;
    imk_findings findings = {.count = 0};
    double dipole[3];
    const double whole_motion = (double)NAN;
    model.mag = model.accel;
    model.gyro.bias.temperature_rate.value[0] = 1;
    CHECK_OK(imk_simulate_log_complete(&model, whole_motion, 2.0, &settings, &findings, &error));
    imk_dipole_field(settings.simulation.latitude, dipole);
    assert_memory_equal(settings.simulation.field, dipole, sizeof dipole);
    assert_int_equal(settings.rows, 201);
    assert_int_equal(findings.count, 1);
    assert_string_equal(imk_finding_code(&findings.item[0]), "temperature_unknown");
    CHECK_OK(imk_simulate_log_complete(&model, 1.5, 2.0, &settings, &findings, &error));
    /* Where a sensor works, and where none does: told once, with the unit that is likely meant. */
    const double temperatures[][2] = {{174, 472}, {298, 25}, {25, 25}, {298, 571.3}, {298, 5000}};
    const char *const told[] = {NULL, "write 25degC if", "write 25degC if", "write 298.15K if",
                                "above 200 degC"};
    const imk_temperature_profile *none = settings.simulation.temperature;
    for (size_t i = 0; i < 5; i++) {
        char text[512];
        const imk_temperature_profile profile = {
            .point_count = 2, .time = (const double[]){0, 1}, .temperature = temperatures[i]};
        imk_findings found = {.count = 0};
        settings.simulation.temperature = &profile;
        CHECK_OK(imk_simulate_log_complete(&model, 1.5, 2.0, &settings, &found, &error));
        assert_int_equal(found.count, told[i] != NULL);
        if (told[i]) {
            imk_finding_text(&found.item[0], text, sizeof text);
            assert_non_null(strstr(text, told[i]));
        }
    }
    settings.simulation.temperature = none;
    assert_int_equal(settings.rows, 150);
    CHECK_OK(
        imk_simulate_log_complete(&model, whole_motion, HUGE_VAL, &settings, &findings, &error));
    assert_int_equal(settings.rows, 0);
    const double wrong[][2] = {{whole_motion, 1e14}, {3, 2}, {0, 2}, {-1, 2}, {1e14, HUGE_VAL}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(imk_simulate_log_complete(&model, wrong[i][0], wrong[i][1], &settings,
                                                   &findings, &error),
                         IMK_ERROR_RANGE);
    settings.simulation.rate = 0;
    assert_int_equal(imk_simulate_log_complete(&model, 1, 1, &settings, &findings, &error),
                     IMK_ERROR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_division, set_up),
        cmocka_unit_test_setup(test_lost_rows, set_up),
        cmocka_unit_test_setup(test_without_end, set_up),
        cmocka_unit_test_setup(test_refused, set_up),
        cmocka_unit_test_setup(test_completed, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
