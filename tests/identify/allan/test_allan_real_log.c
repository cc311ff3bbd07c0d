/* SPDX-License-Identifier: Apache-2.0 */
/* Published Haar wavelet variances of the ADIS16405 at rest, 2.78 h at 100 Hz: six channels, scales
 * of 2 to 2^18 samples, printed to 15 digits. Skipped when the data folder is not beside the
 * checkout. */
#include "check.h"

#include "imukit/allan.h"
#include "imukit/io.h"
#include "imukit/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOG SHARED_DIRECTORY "/data/static/adis16405_imu1_100hz.csv.gz"
#define PUBLISHED SHARED_DIRECTORY "/data/reference/adis16405_imu1_haar_wv.csv"

static void test_published_wavelet_variances(void **state)
{
    (void)state;
    FILE *published = access(LOG, R_OK) == 0 ? fopen(PUBLISHED, "r") : NULL;
    if (!published) {
        print_message("%s or %s is not there\n", LOG, PUBLISHED);
        skip();
    }
    imk_log log;
    imk_log_settings settings = imk_log_settings_default();
    settings.rate = 100;
    imk_error error;
    const imk_status status = imk_log_load(LOG, &settings, NULL, &log, &error);
    CHECK_STATUS(status, IMK_OK);
    char line[256];
    size_t compared = 0;
    assert_non_null(fgets(line, sizeof line, published));
    for (int channel = 0; channel < 6; channel++) {
        const int column = imk_log_find(
            &log, channel < 3 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE,
            channel % 3);
        double *sums = log.data[column];
        imk_allan_sums(log.rows, sums, sums, NULL);
        for (int i = 0; i < 18; i++, compared++) {
            double scale, expected, variance;
            assert_non_null(fgets(line, sizeof line, published));
            assert_int_equal(line[channel < 3 ? 6 : 7], 'X' + channel % 3);
            assert_int_equal(sscanf(strchr(line, ',') + 1, "%lf,%lf", &scale, &expected), 2);
            const size_t m = (size_t)(scale * 50 + 0.5);
            CHECK_STATUS(
                imk_allan_variances(IMK_ALLAN_HAAR, log.rows, sums, 1, &m, &variance, NULL, NULL),
                IMK_OK);
            const double unit = log.column[column].unit.scale;
            CHECK_RELATIVE(variance / (unit * unit), expected, 1e-10);
        }
    }
    assert_int_equal(compared, 108);
    fclose(published);
    imk_log_free(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_published_wavelet_variances)};
    return cmocka_run_group_tests_name("allan_real_log", tests, NULL, NULL);
}
