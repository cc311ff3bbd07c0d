/* SPDX-License-Identifier: Apache-2.0 */
/* Static detection: what stands is found, what moves is not, whatever the noise looks like; nothing
 * is left out without being counted. */
#include "check.h"

#include "calibrate/pose_log.h"

#include <time.h>

static const char xsens[] =
    SHARED_DIRECTORY "/data/calibration/xsens_mti_multiposition_raw_counts.csv.gz";
static const char mpu9150[] =
    SHARED_DIRECTORY "/data/calibration/mpu9150_unit0_multiposition_100hz.csv.gz";
static const char mpu9150_1[] =
    SHARED_DIRECTORY "/data/calibration/mpu9150_unit1_multiposition_100hz.csv.gz";
static const char ferraris[] =
    SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz";

/* One interval, nearly all of the log. */
static void pure_noise_stands(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(100000, 0.005, 0.05, 1);
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, NULL);
    /* 2000 windows without overlap, each a false alarm with at most 1e-4; one splits the log only
     * where a window beside it is another. */
    assert_in_range(log->count, 1, 3);
    assert_true(log->findings.standing > 0.99);
    assert_true(log->findings.rest_end > log->findings.rest_begin);
    for (int c = 0; c < 6; c++) {
        const double noise = c < 3 ? 0.005 : 0.05;
        /* Of some 1e5 samples: the estimate's own 1 sigma is 0.2 %, here five of them; of fewer,
         * when a false alarm split the log. */
        CHECK_RELATIVE(log->findings.noise[c / 3][c % 3], noise, 0.03);
        CHECK_RELATIVE(log->interval[0].scatter[c / 3][c % 3], noise, 0.03);
    }
    pose_log_free(log);
}

/* The rate of false alarms is the stated one: 12 of 15 tests of a window (six scatters, six halves;
 * three means, which have an allowance) share it. White noise, a window of 40 samples, 2^20
 * samples: 26214 windows without overlap. */
static void false_alarms_are_as_stated(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(1 << 20, 0.005, 0.05, 2);
    imk_static_settings settings = imk_static_default();
    settings.window = 0.4;
    settings.false_alarm = 0.01;
    pose_log_detect(log, &settings, NULL);
    size_t alarms = 0, windows = 0;
    for (size_t k = 40; k + 80 < log->record.count; k += 40) {
        alarms += log->activity[k] > 1.0;
        windows++;
    }
    /* Expected 0.8 % of 26212: 210, sd 14.5; five sd are 72 (2e-7 each way). Limits leave room for
     * the error of the learnt noise: here some 1e5 samples tell it, 0.3 %, which moves the tail
     * probability by 5 %; and for the halves' tests, whose limit takes the larger of the expected
     * and the observed variance. */
    assert_in_range(alarms, 90, 300);
    pose_log_free(log);
}

/* Neighbours correlated by 0.9, as behind a low-pass filter. */
static void coloured_noise_stands(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(60000, 0.005, 0.05, 3);
    for (int c = 0; c < 6; c++)
        for (size_t k = 1; k < log->record.count; k++) {
            const double level = c == 5 ? -9.8 : 0.0;
            log->value[c][k] = level + 0.9 * (log->value[c][k - 1] - level) +
                               0.4358898943540674 * (log->value[c][k] - level);
        }
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, NULL);
    assert_true(log->findings.standing > 0.97);
    /* 1 + 2 sum rho^2k = (1 + 0.81)/(1 - 0.81) = 9.5 samples stand for one. */
    const double n = log->findings.window / 0.01;
    for (int c = 0; c < 6; c++) {
        assert_true(log->findings.effective[c / 3][c % 3] < n / 4.0);
        assert_true(log->findings.effective[c / 3][c % 3] > n / 20.0);
    }
    pose_log_free(log);
}

/* 1 sigma of a mean over simulated holds: white, correlated by 0.8, and quantized coarsely.
 * Normalised errors of 3 x 400 holds: their rms has 1 sigma of 1/sqrt(2400) = 2 %; estimates of
 * sigma scatter by some 10 %, those of correlated noise by 25 %, and are low by some per cent. */
static void sigma_of_means_is_honest(void **state)
{
    (void)state;
    enum { HOLDS = 400, SAMPLES = 500 };
    static const double correlation[3] = {0.0, 0.8, 0.0}, coarse[3] = {0.0, 0.0, 2.5};
    static const double low[3] = {0.9, 0.9, 0.85}, high[3] = {1.1, 1.25, 1.15};
    for (int kind = 0; kind < 3; kind++) {
        pose_log *log = pose_log_noise((size_t)HOLDS * SAMPLES, 1.0, 1.0, 4);
        const double rho = correlation[kind], step = coarse[kind];
        double square = 0.0;
        for (int c = 0; c < 3; c++) {
            double *x = log->value[c];
            for (size_t k = 1; k < log->record.count; k++)
                x[k] = rho * x[k - 1] + sqrt(1.0 - rho * rho) * x[k];
            for (size_t k = 0; step > 0.0 && k < log->record.count; k++) {
                /* another place within a step in each hold */
                const double place = step * 0.6180339887498949 * (double)(k / SAMPLES);
                x[k] = step * floor((x[k] + place) / step + 0.5) - place;
            }
        }
        for (size_t h = 0; h < HOLDS; h++) {
            const imk_static_interval hold =
                imk_static_summary(&log->record, h * SAMPLES, (h + 1) * SAMPLES);
            for (int i = 0; i < 3; i++)
                square += hold.mean[0][i] * hold.mean[0][i] / (hold.sigma[0][i] * hold.sigma[0][i]);
        }
        const double rms = sqrt(square / (3.0 * HOLDS));
        CHECK_BELOW(low[kind], rms);
        CHECK_BELOW(rms, high[kind]);
        pose_log_free(log);
    }
}

/* Twenty poses: each is found, nothing of a turn is taken for rest. */
static void poses_are_found(void **state)
{
    (void)state;
    const imk_model model = pose_log_model();
    for (uint64_t seed = 1; seed <= 3; seed++) {
        pose_log *log = pose_log_simulate(&model, 20, 4.0, 1.5, seed);
        const imk_static_settings settings = imk_static_default();
        pose_log_detect(log, &settings, NULL);
        assert_int_equal(log->count, 20);
        for (size_t i = 0; i < log->count; i++) {
            /* The turns begin and end smoothly: x^3, so that a tenth of a turn's time moves by
             * 1 % of the angle; the guard leaves that out. */
            const double begin = 5.5 * (double)i, end = begin + 4.0;
            assert_true((double)log->interval[i].begin * 0.01 >= begin - 1e-9);
            assert_true((double)log->interval[i].end * 0.01 <= end + 1e-9);
            assert_true((double)(log->interval[i].end - log->interval[i].begin) * 0.01 > 1.5);
            double square = 0.0;
            for (int j = 0; j < 3; j++)
                square += log->interval[i].mean[1][j] * log->interval[i].mean[1][j];
            CHECK_CLOSE(sqrt(square), 9.806, 0.15); /* biases of up to 0.06 an axis */
        }
        CHECK_BELOW(log->findings.standing, 80.0 / 108.5);
        CHECK_BELOW(0.7 * 80.0 / 108.5, log->findings.standing);
        assert_true(log->findings.quietest < 1.0 && log->findings.loudest > 10.0);
        pose_log_free(log);
    }
}

/* Slow tumbling without a stop: rates of about 0.3 rad/s about changing axes. */
static void restless_log_has_no_interval(void **state)
{
    (void)state;
    const imk_model model = pose_log_model();
    for (uint64_t seed = 1; seed <= 4; seed++) {
        imk_motion_step step[60];
        uint32_t word[120];
        imk_random_words(imk_random_seeded(seed), 7, 0, 120, word);
        for (int i = 0; i < 60; i++)
            step[i] = (imk_motion_step){.kind = IMK_STEP_POSE,
                                        .duration = 1.0 + 2.0 * word[2 * i] / 4294967296.0,
                                        .angle = {word[2 * i] / 2147483648.0 - 1.0,
                                                  0.7 * (word[2 * i + 1] / 2147483648.0 - 1.0),
                                                  (i % 7) - 3.0}};
        imk_motion_script script = imk_motion_script_default();
        script.step = step;
        script.step_count = 60;
        pose_log *log = pose_log_of(&model, &script, 60.0, 100.0, seed);
        const imk_static_settings settings = imk_static_default();
        pose_log_detect(log, &settings, NULL);
        assert_int_equal(log->count, 0);
        pose_log_free(log);
    }
}

/* A rate table: the accelerometers of a turn about the vertical see nothing, and a steady rate does
 * not scatter. Slow: 1 deg/s. */
static void steady_turn_is_no_rest(void **state)
{
    (void)state;
    const imk_model model = pose_log_model();
    imk_motion_step step[9];
    for (int i = 0; i < 9; i++)
        step[i] = i % 2 == 0 ? (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 5.0}
                             : (imk_motion_step){.kind = IMK_STEP_ROTATE,
                                                 .axis = 2,
                                                 .amount = 0.5 * (i - 4),
                                                 .rate = 0.05 * i};
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    script.step_count = 9;
    double total = 0.0, begin[9];
    for (size_t i = 0; i < 9; i++) {
        begin[i] = total;
        total += imk_motion_step_duration(&script, i);
    }
    pose_log *log = pose_log_of(&model, &script, total, 100.0, 5);
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, NULL);
    assert_int_equal(log->count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_true((double)log->interval[i].begin * 0.01 > begin[2 * i]);
        assert_true((double)log->interval[i].end * 0.01 < begin[2 * i] + 5.0);
    }
    pose_log_free(log);
}

/* Gyros that feel force, 0.1 deg/s/g = 1.8e-4 rad/s/(m/s^2) on every element, and are quiet: from
 * face to face the rate at rest changes by up to sqrt(3) 2 g times that, 6e-3 rad/s, several times
 * what their noise, the Earth and tremor allow. All poses are found. Once a face has been held for
 * 20 s, a turn of 5e-3 rad/s about the vertical is one, though a change of face might make 4e-3. */
static void g_sensitivity_is_no_turn(void **state)
{
    (void)state;
    imk_model model = pose_log_model();
    for (int i = 0; i < 3; i++) {
        model.gyro.noise.white.value[i] = 1e-5;
        model.gyro.noise.bias_instability.value[i] = 4e-6;
        for (int j = 0; j < 3; j++)
            model.gyro.g_sensitivity.value[i][j] = (i + j) % 2 ? 1.8e-4 : -1.8e-4;
    }
    const imk_static_settings settings = imk_static_default();
    pose_log *log = pose_log_simulate(&model, 20, 4.0, 1.5, 12);
    pose_log_detect(log, &settings, NULL);
    assert_int_equal(log->count, 20);
    /* Accelerometers in counts tell no force: as much is allowed for as it can change. */
    log->record.counts[1] = true;
    pose_log_detect(log, &settings, NULL);
    assert_int_equal(log->count, 20);
    pose_log_free(log);
    imk_motion_step step[5] = {
        {.kind = IMK_STEP_HOLD, .duration = 6.0},
        {.kind = IMK_STEP_ROTATE, .axis = 1, .amount = 1.5707963267948966, .rate = 1.0},
        {.kind = IMK_STEP_HOLD, .duration = 20.0},
        {.kind = IMK_STEP_ROTATE, .axis = 0, .amount = 0.06, .rate = 5e-3},
        {.kind = IMK_STEP_HOLD, .duration = 6.0}};
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    script.step_count = 5;
    double total = 0.0, begin[5];
    for (size_t i = 0; i < 5; i++) {
        begin[i] = total;
        total += imk_motion_step_duration(&script, i);
    }
    log = pose_log_of(&model, &script, total, 100.0, 13);
    pose_log_detect(log, &settings, NULL);
    assert_int_equal(log->count, 3);
    for (size_t i = 0; i < 3; i++) {
        assert_true((double)log->interval[i].begin * 0.01 > begin[2 * i] - 1e-9);
        assert_true((double)log->interval[i].end * 0.01 < begin[2 * i] + step[2 * i].duration);
    }
    pose_log_free(log);
}

/* Readings coarser than their noise: one axis shows a single value in the quietest part, and two
 * values elsewhere. */
static void coarse_axis_stands(void **state)
{
    (void)state;
    imk_model model = pose_log_model();
    for (int i = 0; i < 3; i++) {
        model.gyro.resolution.value[i] = 0.006;
        model.accel.resolution.value[i] = 0.04;
    }
    pose_log *log = pose_log_simulate(&model, 20, 4.0, 1.5, 6);
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, NULL);
    assert_int_equal(log->count, 20);
    for (size_t i = 0; i < log->count; i++)
        for (int c = 0; c < 6; c++)
            assert_true(log->interval[i].sigma[c / 3][c % 3] > 0.0);
    pose_log_free(log);
}

/* Gaps, numbers that are none, saturation: left out and counted. */
static void unusable_samples_are_counted(void **state)
{
    (void)state;
    imk_model model = pose_log_model();
    pose_log *log = pose_log_noise(30000, 0.005, 0.05, 8);
    double *time = malloc(log->record.count * sizeof(double));
    for (size_t k = 0; k < log->record.count; k++)
        time[k] = 0.01 * (double)k + (k >= 10000 ? 30.0 : 0.0);
    log->record.time = time;
    for (size_t k = 20000; k < 20007; k++)
        log->value[2][k] = log->value[4][k] = NAN;
    model.accel.range.value[2] = 19.6;
    for (size_t k = 25000; k < 25100; k++)
        log->value[5][k] = -19.6;
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, &model);
    assert_int_equal(log->findings.not_finite, 7);
    assert_int_equal(log->findings.saturated, 100);
    assert_int_equal(log->count, 4);
    assert_true(log->interval[0].end <= 10000 && log->interval[1].begin >= 10000);
    assert_true(log->interval[1].end <= 20000 && log->interval[2].begin >= 20007);
    assert_true(log->interval[2].end <= 25000 && log->interval[3].begin >= 25100);
    /* Without a stated range the axis still sticks at the end of its readings. */
    pose_log_detect(log, &settings, NULL);
    assert_in_range(log->findings.saturated, 80, 100);
    assert_int_equal(log->count, 4);
    free(time);
    pose_log_free(log);
}

static void settings_are_checked(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(1000, 0.005, 0.05, 9);
    imk_static_settings settings = imk_static_default();
    static double workspace[4096];
    size_t count;
    imk_static_findings findings;
    imk_error error;
    const size_t size = imk_static_workspace_size(&log->record, &settings);
    assert_true(size < sizeof workspace);
    CHECK_OK(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                               workspace, size, &error));
    CHECK_STATUS(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                                   workspace, size - 1, &error),
                 IMK_ERROR_WORKSPACE);
    settings.false_alarm = 0.0;
    CHECK_STATUS(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                                   workspace, size, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "false_alarm");
    settings = imk_static_default();
    settings.cookie = 0;
    CHECK_STATUS(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                                   workspace, size, &error),
                 IMK_ERROR_UNINITIALISED);
    settings = imk_static_default();
    log->record.count = 63;
    CHECK_STATUS(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                                   workspace, size, &error),
                 IMK_ERROR_TOO_SHORT);
    log->record.count = 1000;
    for (size_t k = 0; k < 1000; k++)
        log->value[0][k] = NAN;
    CHECK_STATUS(imk_static_detect(&log->record, &settings, NULL, NULL, 0, &count, NULL, &findings,
                                   workspace, size, &error),
                 IMK_ERROR_NOT_FINITE);
    pose_log_free(log);
}

/* Temperature of an interval: mean and slope of a straight line are exact but for rounding. */
static void temperature_is_summarised(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(1000, 0.005, 0.05, 10);
    double temperature[1000];
    for (int k = 0; k < 1000; k++)
        temperature[k] = 300.0 + 0.02 * (0.01 * k);
    log->record.temperature = temperature;
    const imk_static_interval all = imk_static_summary(&log->record, 200, 801);
    CHECK_CLOSE(all.temperature, 300.0 + 0.02 * 5.0, 1e-10);
    CHECK_CLOSE(all.temperature_rate, 0.02, 1e-10);
    assert_int_equal(all.section, -1);
    const imk_static_interval none = imk_static_summary(&log->record, 5, 5);
    assert_true(isnan(none.mean[0][0]) && isnan(none.temperature));
    pose_log_free(log);
}

/* Real logs: intervals counted on plots of the scatter; thresholds just above the scatter at rest.
 */
static pose_log *real_log(const char *path, double rate, bool counts)
{
    pose_log *log = pose_log_read(path, rate, counts);
    if (!log) {
        print_message("%s is not there\n", path);
        skip();
    }
    const imk_static_settings settings = imk_static_default();
    pose_log_detect(log, &settings, NULL);
    for (int c = 0; c < 6; c++) {
        const double ratio =
            log->findings.threshold[c / 3][c % 3] / log->findings.noise[c / 3][c % 3];
        assert_true(ratio > 1.1);
        /* Hands tremble: only gyros in SI may have more. */
        assert_true(ratio < 2.0 || (c < 3 && !counts));
    }
    return log;
}

static void xsens_log(void **state)
{
    (void)state;
    pose_log *log = real_log(xsens, 0.0, true);
    /* 37 poses, some of which were touched once. */
    assert_in_range(log->count, 35, 46);
    /* The long rest at the beginning, 50 s. */
    CHECK_BELOW((double)log->findings.rest_begin * 0.01, 8.0);
    CHECK_BELOW(49.0, (double)log->findings.rest_end * 0.01);
    CHECK_BELOW((double)log->findings.rest_end * 0.01, 53.0);
    CHECK_CLOSE(log->findings.noise[0][0], 26.6, 1.0); /* counts; read off a plot of its scatter */
    CHECK_CLOSE(log->findings.noise[1][0], 3.3, 0.3);
    imk_static_settings settings = imk_static_default();
    settings.initial_rest = 50.0;
    pose_log_detect(log, &settings, NULL);
    assert_in_range(log->count, 35, 46);
    assert_int_equal(log->findings.rest_begin, 0);
    pose_log_free(log);
}

static void mpu9150_logs(void **state)
{
    (void)state;
    pose_log *log = real_log(mpu9150, 0.0, false);
    assert_in_range(log->count, 20, 26);
    pose_log_free(log);
    log = real_log(mpu9150_1, 0.0, false);
    assert_in_range(log->count, 20, 26);
    pose_log_free(log);
}

static void ferraris_log(void **state)
{
    (void)state;
    pose_log *log = real_log(ferraris, 204.8, true);
    /* Six holds; the three turns (sections 2, 5, 8 in the order met) have none. */
    assert_int_equal(log->count, 6);
    const int section[6] = {0, 1, 3, 4, 6, 7};
    for (int i = 0; i < 6; i++)
        assert_int_equal(log->interval[i].section, section[i]);
    pose_log_free(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pure_noise_stands),
        cmocka_unit_test(false_alarms_are_as_stated),
        cmocka_unit_test(coloured_noise_stands),
        cmocka_unit_test(sigma_of_means_is_honest),
        cmocka_unit_test(poses_are_found),
        cmocka_unit_test(restless_log_has_no_interval),
        cmocka_unit_test(steady_turn_is_no_rest),
        cmocka_unit_test(g_sensitivity_is_no_turn),
        cmocka_unit_test(coarse_axis_stands),
        cmocka_unit_test(unusable_samples_are_counted),
        cmocka_unit_test(settings_are_checked),
        cmocka_unit_test(temperature_is_summarised),
        cmocka_unit_test(xsens_log),
        cmocka_unit_test(mpu9150_logs),
        cmocka_unit_test(ferraris_log),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
