/* SPDX-License-Identifier: Apache-2.0 */
/* The means of the rests of a log, taken where the programme says that the unit rests, say of the
 * accelerometers what the log says. */
#include "../calibrate/multiposition_session.h"
#include "check.h"

#include "imukit/jobs.h"

enum { COLUMNS = 13 };

static double mean[COLUMNS][BENCH_POSES];

/* Means, standard deviations and number of the samples of each hold, but for 0.4 s at both ends. */
static void take_means(const multiposition_session *b)
{
    const size_t left = 4 * BENCH_RATE / 10, count = (size_t)BENCH_HOLD * BENCH_RATE - 2 * left;
    for (int pose = 0; pose < BENCH_POSES; pose++) {
        const size_t begin =
            ((size_t)pose * (BENCH_HOLD + BENCH_TURN) + BENCH_TURN) * BENCH_RATE + left;
        for (int c = 0; c < 6; c++) {
            double sum = 0, square = 0;
            for (size_t k = begin; k < begin + count; k++)
                sum += b->value[c][k];
            mean[c][pose] = sum / (double)count;
            for (size_t k = begin; k < begin + count; k++)
                square += (b->value[c][k] - mean[c][pose]) * (b->value[c][k] - mean[c][pose]);
            mean[6 + c][pose] = sqrt(square / (double)(count - 1));
        }
        mean[12][pose] = (double)count;
    }
}

static imk_calibrate_log *calibrate(const multiposition_session *b, size_t columns,
                                    const double *const *data, size_t rows, bool means)
{
    static const char *const names[COLUMNS] = {"gyro_x [count]",
                                               "gyro_y [count]",
                                               "gyro_z [count]",
                                               "accel_x [count]",
                                               "accel_y [count]",
                                               "accel_z [count]",
                                               "gyro_x_std [count]",
                                               "gyro_y_std [count]",
                                               "gyro_z_std [count]",
                                               "accel_x_std [count]",
                                               "accel_y_std [count]",
                                               "accel_z_std [count]",
                                               "samples"};
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    imk_array_source arrays;
    imk_record_source source;
    imk_calibrate_log *found;
    imk_error error;
    settings.model = &b->nominal;
    settings.gravity = b->calibration.gravity;
    settings.place_known = true;
    settings.place = (imk_geodetic){.latitude = 0.7853981633974483};
    settings.pose_means = means;
    settings.without = IMK_CALIBRATE_GYRO_TURNS; /* which tell of accelerometers, too */
    CHECK_OK(imk_array_source_make(columns, names, data, rows, means ? 1 : BENCH_RATE, &arrays,
                                   &source, NULL));
    const imk_calibrate_input input = {"poses", IMK_PROCEDURE_MULTIPOSITION, &source};
    CHECK_OK(imk_calibrate_logs(1, &input, &settings, NULL, &found, &error));
    return found;
}

static void means_say_what_the_log_says(void **state)
{
    (void)state;
    multiposition_session *b = session_start();
    const double *all[6], *taken[COLUMNS];
    assert_non_null(b);
    imk_calibration_default(&b->calibration);
    CHECK_OK(session_simulate(b, 21, 0));
    take_means(b);
    for (int c = 0; c < COLUMNS; c++)
        taken[c] = mean[c];
    for (int c = 0; c < 6; c++)
        all[c] = b->value[c];
    imk_calibrate_log *log = calibrate(b, 6, all, b->rows, false);
    const imk_model truth = session_true_model(b);
    for (int stated = 0; stated < 2; stated++) {
        imk_calibrate_log *table = calibrate(b, stated ? COLUMNS : 6, taken, BENCH_POSES, true);
        int compared = 0;
        assert_int_equal(table->result->parameter_count, 21);
        for (size_t p = 0; p < table->result->parameter_count; p++) {
            const imk_model_parameter parameter = table->result->parameter[p];
            const int k = imk_calibrate_find(log, parameter);
            assert_true(k >= 0);
            /* Six of its sigmas from the truth; and of accelerometers one from the log, whose rests
             * have the same samples but for their ends. */
            CHECK_CLOSE(table->result->value[p], imk_model_parameter_get(&truth, parameter),
                        6 * table->result->sigma[p]);
            if (parameter.sensor != IMK_ACCEL)
                continue;
            CHECK_CLOSE(table->result->value[p], log->result->value[k], log->result->sigma[k]);
            assert_in_range((int)(100 * table->result->sigma[p] / log->result->sigma[k]), 60, 180);
            compared++;
        }
        assert_int_equal(compared, 9);
        imk_calibrate_log_free(table);
    }
    imk_calibrate_log_free(log);
    session_stop(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(means_say_what_the_log_says)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
