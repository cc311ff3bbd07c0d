/* SPDX-License-Identifier: Apache-2.0 */
/* How navigation starts: the method of alignment follows from the model, north that is hidden is
 * told, and the biases of the gyros are those of the readings at rest. */
#include "check.h"

#include "imukit/navigate_log.h"
#include "imukit/simulate_log.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 7, RATE = 10, SECONDS = 400, ROWS = RATE * SECONDS };

static const double degree = 0.017453292519943295, latitude = 0.78539816339744831;
static double data[COLUMNS][ROWS];
static imk_array_source memory;
static imk_record_source source;

/* A log at rest at 45 deg north. */
static void simulate(const imk_model *model, uint32_t run)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    double *arrays[COLUMNS];
    const double *columns[COLUMNS];
    imk_simulate_log_settings settings = imk_simulate_log_default();
    for (int i = 0; i < COLUMNS; i++)
        columns[i] = arrays[i] = data[i];
    imk_array_sink array = {.column_count = COLUMNS, .capacity = ROWS, .data = arrays};
    const imk_record_sink sink = imk_array_sink_of(&array);
    settings.simulation.rate = RATE;
    settings.simulation.latitude = latitude;
    settings.simulation.run = run;
    settings.rows = ROWS;
    CHECK_OK(imk_simulate_log_run(model, &settings, &sink, "simulating", NULL, NULL));
    CHECK_OK(imk_array_source_make(COLUMNS, names, columns, ROWS, 0.0, &memory, &source, NULL));
}

static imk_navigate_log *navigate(const imk_navigate_log_settings *settings)
{
    imk_navigate_log *n = NULL;
    imk_error error;
    memory.next = 0;
    const imk_status status = imk_navigate_log_run(&source, settings, NULL, &n, &error);
    if (status != IMK_OK)
        fail_msg("%s: %s", imk_status_text(status),
                 n && n->findings.count > 0 ? n->findings.item[n->findings.count - 1].code : "");
    return n;
}

static imk_navigate_log_settings settings_for(const imk_model *model)
{
    imk_navigate_log_settings settings = imk_navigate_log_default();
    settings.place.latitude = latitude;
    settings.align = 300.0;
    settings.model = model;
    settings.model_name = "the model";
    return settings;
}

static bool finds(const imk_navigate_log *n, const char *code)
{
    for (size_t i = 0; i < n->findings.count; i++)
        if (strcmp(n->findings.item[i].code, code) == 0)
            return true;
    return false;
}

/* Of an AHRS (6 deg/h) and an ADIS16488 (720 deg/h) no run aligns in inertial axes and none claims
 * a heading, whatever the gyros happen to read; of a navigation unit every run does. The biases are
 * found: with the heading given, within 5 of their sigmas. */
static void test_method_follows_the_model(void **state)
{
    (void)state;
    static const char *const devices[] = {"AHRS", "ADIS16488", "navigation"};
    static imk_model model;
    for (int d = 0; d < 3; d++)
        for (uint32_t run = 0; run < 12; run++) {
            imk_device_model(imk_device_find(devices[d]), &model);
            memset(model.gyro.g_sensitivity.value, 0, sizeof model.gyro.g_sensitivity.value);
            memset(&model.gyro.g2_sensitivity, 0, sizeof model.gyro.g2_sensitivity);
            imk_navigate_log_settings settings = settings_for(&model);
            simulate(&model, run);
            imk_navigate_log *n = navigate(&settings);
            assert_int_equal(n->coarse, d < 2);
            assert_int_equal(n->method, d < 2 ? IMK_ALIGNMENT_MEANS : IMK_ALIGNMENT_INERTIAL);
            assert_int_equal(finds(n, "north_unknown"), d < 2);
            assert_true(d < 2 ? n->attitude_sigma[2] > 0.2 && n->attitude_sigma[2] < 1.8138
                              : n->attitude_sigma[2] < 0.01);
            imk_navigate_log_free(n);
            settings.heading_given = true;
            n = navigate(&settings);
            assert_false(finds(n, "north_unknown"));
            const double earth[3] = {IMK_EARTH_RATE * cos(latitude), 0.0,
                                     -IMK_EARTH_RATE * sin(latitude)};
            for (int i = 0; i < 3; i++) {
                double read = 0.0;
                for (int k = 0; k < ROWS; k++)
                    read += data[1 + i][k] / ROWS;
                CHECK_CLOSE(n->end.gyro_bias.v[i], read - earth[i],
                            5.0 * n->end.gyro_bias_sigma.v[i]);
                assert_true(n->end.gyro_bias_sigma.v[i] < (d == 1 ? 40.0 : 10.0) * degree / 3600.0);
            }
            imk_navigate_log_free(n);
        }
}

/* A bias that the model does not state is told and taken, and one that it states is not told. */
static void test_bias_beyond_the_model(void **state)
{
    (void)state;
    static imk_model model, stated, truth;
    imk_model_default(&model);
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.white.value[i] = 1e-5;
        model.accel.noise.white.value[i] = 1e-4;
    }
    stated = truth = model;
    truth.gyro.bias.fixed.value[1] = 0.3 * degree;
    stated.gyro.bias.repeatability.value[1] = 0.5 * degree;
    model.gyro.bias.repeatability.value[1] = 1e-3 * degree;
    for (int known = 0; known < 2; known++) {
        imk_navigate_log_settings settings = settings_for(known ? &stated : &model);
        settings.heading_given = true;
        simulate(&truth, 2);
        imk_navigate_log *n = navigate(&settings);
        assert_int_equal(finds(n, "bias_beyond_model"), !known);
        CHECK_CLOSE(n->end.gyro_bias.v[1], 0.3 * degree, 3e-6); /* noise: 6e-7 */
        imk_navigate_log_free(n);
    }
}

/* Without a model the readings say how large biases are: 0.3 of the Earth's rotation along the
 * vertical, and none across it, make 1.32 x 0.3/(sqrt(2) cos 45 deg) of heading. */
static void test_doubt_without_model(void **state)
{
    (void)state;
    static imk_model model;
    imk_model_default(&model);
    model.gyro.bias.fixed.value[2] = 0.3 * IMK_EARTH_RATE;
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.white.value[i] = 1e-9;
        model.accel.noise.white.value[i] = 1e-6;
    }
    simulate(&model, 0);
    imk_navigate_log_settings settings = settings_for(NULL);
    settings.method_given = true;
    settings.method = IMK_ALIGNMENT_MEANS;
    imk_navigate_log *n = navigate(&settings);
    CHECK_RELATIVE(n->attitude_sigma[2], 1.32 * 0.3 / sqrt(2.0) / cos(latitude), 1e-3);
    imk_navigate_log_free(n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_method_follows_the_model),
        cmocka_unit_test(test_bias_beyond_the_model),
        cmocka_unit_test(test_doubt_without_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
