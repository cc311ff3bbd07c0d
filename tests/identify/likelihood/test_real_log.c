/* SPDX-License-Identifier: Apache-2.0 */
/* Published results on a real log: the ADIS16405 at rest, 2.78 h at 100 Hz. Skipped when the data
 * folder is not beside the checkout. */
#include "check.h"

#include "imukit/imukit.h"
#include "imukit/io.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOG SHARED_DIRECTORY "/data/static/adis16405_imu1_100hz.csv.gz"
#define PUBLISHED SHARED_DIRECTORY "/data/reference/adis16405_imu1_avar.csv"

static void load(imk_log *log)
{
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    imk_error error;
    const imk_status status = imk_log_load(LOG, &settings, NULL, log, &error);
    CHECK_STATUS(status, IMK_OK);
    assert_int_equal(log->rows, 1000000);
}

/* Six channels at 18 averaging times, printed to 15 digits. The published ones were computed from
 * values rounded elsewhere: 6e-6 is the largest difference seen, 1e-5 the bound. */
static void test_published_variances(void **state)
{
    (void)state;
    if (access(LOG, R_OK) != 0) {
        print_message("%s is not there\n", LOG);
        skip();
    }
    imk_log log;
    load(&log);
    FILE *published = fopen(PUBLISHED, "r");
    assert_non_null(published);
    char line[256];
    size_t compared = 0;
    assert_non_null(fgets(line, sizeof line, published));
    for (int channel = 0; channel < 6; channel++) {
        const bool gyro = channel < 3;
        const int column = imk_log_find(
            &log, gyro ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, channel % 3);
        double *sums = log.data[column];
        imk_allan_sums(log.rows, sums, sums, NULL);
        for (int i = 0; i < 18; i++) {
            double tau, expected, variance;
            assert_non_null(fgets(line, sizeof line, published));
            assert_int_equal(sscanf(strchr(line, ',') + 1, "%lf,%lf", &tau, &expected), 2);
            const size_t m = (size_t)(tau * 100 + 0.5);
            CHECK_STATUS(imk_allan_variances(IMK_ALLAN_OVERLAPPING, log.rows, sums, 1, &m,
                                             &variance, NULL, NULL),
                         IMK_OK);
            const double unit = log.column[column].unit.scale;
            CHECK_RELATIVE(variance / (unit * unit), expected, 1e-5);
            compared++;
        }
    }
    assert_int_equal(compared, 108);
    fclose(published);
    imk_log_free(&log);
}

/* The hump of gyro z at 20.3 Hz, with a half-power width of a sixteenth of that, is of several
 * resonances, since its frequency drifts: mean frequency and deviation of those around it, weighted
 * by power. */
static void check_hump(const imk_identification *r)
{
    double power = 0, moment = 0;
    for (int i = 0; i < r->resonance_count; i++)
        if (fabs(r->resonance[i].frequency - 20.3) < 1.5) {
            const double variance = r->resonance[i].sigma * r->resonance[i].sigma;
            power += variance;
            moment += variance * r->resonance[i].frequency;
        }
    CHECK_CLOSE(moment / power, 20.3, 0.3);
    /* 0.28 deg/s for a single resonance of Q 16. */
    CHECK_CLOSE(sqrt(power) / 0.017453292519943295, 0.28, 0.03);
}

/* What the log is known to hold: an output filter near 61 Hz on gyros x and y, a resonance at 20.3
 * Hz with Q about 16 on gyro z, a line at 0.564 Hz on the accelerometers, no quantization noise. */
static void test_known_contents(void **state)
{
    (void)state;
    if (access(LOG, R_OK) != 0) {
        print_message("%s is not there\n", LOG);
        skip();
    }
    imk_log log;
    load(&log);
    imk_identify_settings settings = imk_identify_default();
    settings.dt = 0.01;
    const size_t size = imk_identify_workspace_size(log.rows);
    void *workspace = malloc(size);
    imk_identification r;
    imk_error error;
    for (int channel = 0; channel < 6; channel++) {
        if (check_skips((size_t)channel, 2))
            continue;
        const bool gyro = channel < 3;
        const int column = imk_log_find(
            &log, gyro ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, channel % 3);
        CHECK_STATUS(imk_identify_channel(&settings, log.rows, log.data[column], &r, workspace,
                                          size, &error),
                     IMK_OK);
        assert_false(r.term[IMK_NOISE_QUANTIZATION].present);
        assert_true(r.term[IMK_NOISE_WHITE].present);
        /* Slow noise, whichever terms describe it. */
        assert_true(r.term[IMK_NOISE_BIAS_INSTABILITY].present || r.gauss_markov_count > 0);
        assert_true(r.verdict & IMK_VERDICT_FILTERED);
        CHECK_RELATIVE(r.resolution, gyro ? 0.05 * 0.017453292519943295 : 0.00333 * 9.80665, 1e-3);
        if (channel < 2)
            CHECK_CLOSE(r.filter.bandwidth, 61, 5);
        if (channel == 2)
            check_hump(&r);
        bool line = false;
        for (int i = 0; i < r.resonance_count; i++)
            line = line || fabs(r.resonance[i].frequency - 0.564) < 0.002;
        for (int i = 0; i < r.sinusoid_count; i++)
            line = line || fabs(r.sinusoid[i].frequency - 0.564) < 0.002;
        assert_int_equal(line, !gyro);
    }
    free(workspace);
    imk_log_free(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_published_variances),
        cmocka_unit_test(test_known_contents),
    };
    return cmocka_run_group_tests_name("real_log", tests, NULL, NULL);
}
