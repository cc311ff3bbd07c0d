/* SPDX-License-Identifier: Apache-2.0 */
/* A band of a spectrum is shown in SI for inertial sensors, in the unit of other channels;
 * one-sided where that is asked. */
#include "check.h"

#include "imukit/spectrum_log.h"

enum { ROWS = 500 };

static const double degree = 3.14159265358979323846 / 180;

/* @param unit  that densities are shown in [SI] */
static void check_band(const char *name, double unit, bool one_sided)
{
    double gyro[ROWS];
    const double *data[] = {gyro};
    imk_array_source memory;
    imk_record_source source;
    imk_spectrum_log *log;
    imk_error error;
    uint32_t state = 1;
    for (int i = 0; i < ROWS; i++) {
        state = state * 1664525u + 1013904223u;
        gyro[i] = (double)state / 4294967296.0 - 0.5;
    }
    imk_spectrum_log_settings settings = imk_spectrum_log_default();
    settings.one_sided = one_sided;
    CHECK_OK(imk_array_source_make(1, &name, data, ROWS, 10, &memory, &source, &error));
    CHECK_OK(imk_spectrum_log_run(&source, &settings, NULL, &log, &error));
    assert_true(log->channel[0].fine_count > 0);
    const imk_spectrum_band *band = &log->channel[0].fine[0];
    const imk_spectrum_band shown = imk_spectrum_log_band(log, 0, band);
    const double due = (one_sided ? 2 : 1) / unit / unit;
    assert_true(band->density > 0);
    CHECK_CLOSE(shown.density, due * band->density, 1e-12 * shown.density);
    CHECK_CLOSE(shown.lower, due * band->lower, 1e-12 * shown.lower);
    CHECK_CLOSE(shown.upper, due * band->upper, 1e-12 * shown.upper);
    CHECK_CLOSE(shown.frequency, band->frequency, 0);
    imk_spectrum_log_free(log);
}

static void test_band(void **state)
{
    (void)state;
    check_band("gyro_x [deg/s]", 1, false);
    check_band("gyro_x [deg/s]", 1, true);
    check_band("tilt [deg]", degree, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_band)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
