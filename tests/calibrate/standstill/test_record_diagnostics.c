/* SPDX-License-Identifier: Apache-2.0 */
/* Diagnostics about logs: each mistake is named, sound logs raise none. */
#include "check.h"

#include "calibrate/pose_log.h"

#include "imukit/axes_mending.h"
#include "imukit/procedure.h"

static const double GRAVITY = 9.80620; /* WGS84 at 45 deg, sea level, to five digits */

static const char xsens[] =
    SHARED_DIRECTORY "/data/calibration/xsens_mti_multiposition_raw_counts.csv.gz";
static const char *const mpu9150[2] = {
    SHARED_DIRECTORY "/data/calibration/mpu9150_unit0_multiposition_100hz.csv.gz",
    SHARED_DIRECTORY "/data/calibration/mpu9150_unit1_multiposition_100hz.csv.gz"};
static const char ferraris[] =
    SHARED_DIRECTORY "/data/calibration/ferraris_session_204.8hz_counts.csv.gz";

typedef struct diagnostics {
    size_t count;
    imk_diagnostic_finding finding[IMK_DIAGNOSTICS];
} diagnostics;

static diagnostics look(pose_log *log, const imk_model *model)
{
    const imk_static_settings settings = imk_static_default();
    diagnostics d;
    pose_log_detect(log, &settings, model);
    d.count = imk_record_diagnostics(&log->record, &log->findings, log->count, log->interval,
                                     GRAVITY, model, IMK_DIAGNOSTICS, d.finding);
    return d;
}

static const imk_diagnostic_finding *find(const diagnostics *d, imk_diagnostic kind)
{
    for (size_t i = 0; i < d->count; i++)
        if (d->finding[i].kind == kind)
            return &d->finding[i];
    return NULL;
}

static void print(const diagnostics *d)
{
    for (size_t i = 0; i < d->count; i++)
        print_message("diagnostic %d sensor %d axis %d other %d value %g limit %g\n",
                      (int)d->finding[i].kind, d->finding[i].sensor, d->finding[i].axis,
                      d->finding[i].other, d->finding[i].value, d->finding[i].limit);
}

/* Exactly this diagnostic. */
static imk_diagnostic_finding only(pose_log *log, const imk_model *model, imk_diagnostic kind)
{
    const diagnostics d = look(log, model);
    if (d.count != 1 || d.finding[0].kind != kind) {
        print(&d);
        fail_msg("%zu diagnostics, expected one of kind %d", d.count, (int)kind);
    }
    return d.finding[0];
}

static void none(pose_log *log, const imk_model *model)
{
    const diagnostics d = look(log, model);
    print(&d);
    assert_int_equal(d.count, 0);
}

/* Units with errors of some per cent and deg/s raise no diagnostic, SI or counts. */
static void sound_logs_raise_none(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        imk_model model = pose_log_model(), nominal;
        imk_model_default(&nominal);
        double error[32];
        imk_random_normals(imk_random_seeded(seed), 99, 0, 32, error);
        for (int i = 0; i < 3; i++) {
            model.gyro.scale_factor.fixed.value[i] = 0.02 * error[i];
            model.accel.scale_factor.fixed.value[i] = 0.02 * error[3 + i];
            model.gyro.bias.fixed.value[i] = 0.05 * error[6 + i];
            model.accel.bias.fixed.value[i] = 0.1 * error[9 + i];
            for (int j = 0; j < 3; j++) {
                model.gyro.misalignment.value[i][j] = i == j ? 0.0 : 0.01 * error[12 + 3 * i + j];
                model.accel.misalignment.value[i][j] = i == j ? 0.0 : 0.01 * error[21 + 3 * i + j];
            }
            if (seed % 3 == 0) {
                model.gyro.sensitivity.value[i] = nominal.gyro.sensitivity.value[i] = 7500.0;
                model.accel.sensitivity.value[i] = nominal.accel.sensitivity.value[i] = 1670.0;
                model.gyro.zero_offset.value[i] = nominal.gyro.zero_offset.value[i] = 32768.0;
            }
        }
        pose_log *log =
            pose_log_simulate(&model, 10 + (size_t)seed, 2.5 + 0.2 * (double)(seed % 4), 2.0, seed);
        none(log, &nominal);
        pose_log_free(log);
    }
}

static void real_logs_raise_none(void **state)
{
    (void)state;
    pose_log *log = pose_log_read(xsens, 0.0, true);
    if (!log) {
        print_message("%s is not there\n", xsens);
        skip();
    }
    none(log, NULL);
    /* With the factory's sensitivities the turns are looked at too. */
    imk_model model;
    imk_model_default(&model);
    const double accel[3] = {415, 413, 415}, gyro[3] = {4778, 4758, 4766};
    const double accel_zero[3] = {33124, 33275, 32364}, gyro_zero[3] = {32777, 32460, 32512};
    for (int i = 0; i < 3; i++) {
        model.accel.sensitivity.value[i] = accel[i];
        model.accel.zero_offset.value[i] = accel_zero[i];
        model.gyro.sensitivity.value[i] = gyro[i];
        model.gyro.zero_offset.value[i] = gyro_zero[i];
    }
    none(log, &model);
    /* Exchange two gyros there. */
    log->record.reading[0][0] = log->value[1];
    log->record.reading[0][1] = log->value[0];
    const imk_diagnostic_finding f = only(log, &model, IMK_DIAGNOSTIC_SWAPPED_AXES);
    assert_int_equal(f.sensor, IMK_GYRO);
    assert_int_equal(f.axis, 0);
    assert_int_equal(f.other, 1);
    pose_log_free(log);
    for (int unit = 0; unit < 2; unit++) {
        log = pose_log_read(mpu9150[unit], 0.0, false);
        none(log, NULL);
        pose_log_free(log);
    }
    log = pose_log_read(ferraris, 204.8, true);
    none(log, NULL);
    pose_log_free(log);
}

static pose_log *sound(uint64_t seed)
{
    const imk_model model = pose_log_model();
    return pose_log_simulate(&model, 16, 3.0, 2.0, seed);
}

static void scale(pose_log *log, int sensor, double factor)
{
    for (int i = 0; i < 3; i++)
        for (size_t k = 0; k < log->record.count; k++)
            log->value[3 * sensor + i][k] *= factor;
}

static void never_static_and_never_moves(void **state)
{
    (void)state;
    pose_log *log = pose_log_noise(6000, 0.005, 0.05, 1);
    only(log, NULL, IMK_DIAGNOSTIC_NEVER_MOVES);
    /* Shaken throughout: tremor of 1 rad/s. */
    for (int c = 0; c < 6; c++)
        for (size_t k = 0; k < log->record.count; k++)
            log->value[c][k] += (c < 3 ? 1.0 : 3.0) * sin(0.07 * (double)k * (1.0 + 0.1 * c)) *
                                sin(0.011 * (double)k + c);
    only(log, NULL, IMK_DIAGNOSTIC_NEVER_STATIC);
    pose_log_free(log);
}

static void few_poses_and_one_plane(void **state)
{
    (void)state;
    const imk_model model = pose_log_model();
    imk_motion_step step[24];
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    /* Turned about x only: y and z take turns, nothing along x. */
    for (int i = 0; i < 12; i++) {
        step[2 * i] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 3.0};
        step[2 * i + 1] = (imk_motion_step){
            .kind = IMK_STEP_POSE, .duration = 2.0, .angle = {0.6 * (i + 1) - 3.0, 0.02, 0.0}};
    }
    script.step_count = 23;
    pose_log *log = pose_log_of(&model, &script, 58.0, 100.0, 1);
    const imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_ONE_PLANE);
    assert_int_equal(f.axis, 0);
    CHECK_BELOW(f.value, 0.03);
    pose_log_free(log);
    log = pose_log_simulate(&model, 5, 3.0, 2.0, 2);
    const imk_diagnostic_finding few = only(log, NULL, IMK_DIAGNOSTIC_FEW_POSES);
    CHECK_CLOSE(few.value, 5.0, 0.0);
    pose_log_free(log);
}

/* |force| is 1, 1000, 32.17, 96.2 or something else. */
static void units_of_force(void **state)
{
    (void)state;
    static const double factor[5] = {9.80665, 9.80665e-3, 0.3048, 1.0 / 9.80665, 0.0};
    for (int i = 0; i < 5; i++) {
        pose_log *log = sound(3);
        scale(log, IMK_ACCEL, factor[i] > 0.0 ? 1.0 / factor[i] : 3.0 / 2.0);
        const imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_GRAVITY_UNIT);
        CHECK_CLOSE(f.limit, factor[i], 0.0);
        CHECK_RELATIVE(f.value, GRAVITY / (factor[i] > 0.0 ? factor[i] : 2.0 / 3.0), 0.03);
        pose_log_free(log);
    }
}

static void units_of_rate_and_time(void **state)
{
    (void)state;
    const double degree = 57.29577951308232;
    pose_log *log = sound(4);
    scale(log, IMK_GYRO, degree);
    CHECK_RELATIVE(only(log, NULL, IMK_DIAGNOSTIC_RATE_UNIT).value, degree, 1e-12);
    scale(log, IMK_GYRO, 1.0 / (degree * degree));
    CHECK_RELATIVE(only(log, NULL, IMK_DIAGNOSTIC_RATE_UNIT).value, 1.0 / degree, 1e-12);
    pose_log_free(log);
    log = sound(5);
    log->record.dt = 10.0;
    CHECK_RELATIVE(only(log, NULL, IMK_DIAGNOSTIC_TIME_UNIT).value, 1e3, 1e-12);
    log->record.dt = 1e4;
    CHECK_RELATIVE(only(log, NULL, IMK_DIAGNOSTIC_TIME_UNIT).value, 1e6, 1e-12);
    pose_log_free(log);
}

/* Every exchange and inversion of axes, of either sensor. */
static void axes_exchanged_and_inverted(void **state)
{
    (void)state;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3;
            pose_log *log = sound(6);
            const double *x = log->record.reading[sensor][i];
            log->record.reading[sensor][i] = log->record.reading[sensor][j];
            log->record.reading[sensor][j] = x;
            imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_SWAPPED_AXES);
            assert_int_equal(f.sensor, sensor);
            assert_int_equal(f.axis, i < j ? i : j);
            assert_int_equal(f.other, i < j ? j : i);
            pose_log_free(log);
            log = sound(7);
            for (size_t k = 0; k < log->record.count; k++)
                log->value[3 * sensor + i][k] = -log->value[3 * sensor + i][k];
            f = only(log, NULL, IMK_DIAGNOSTIC_LEFT_HANDED);
            assert_int_equal(f.sensor, sensor);
            assert_int_equal(f.axis, i);
            pose_log_free(log);
        }
    /* Both sensors with z the other way: a left-handed frame. */
    pose_log *log = sound(8);
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t k = 0; k < log->record.count; k++)
            log->value[3 * sensor + 2][k] = -log->value[3 * sensor + 2][k];
    const imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_LEFT_HANDED);
    assert_int_equal(f.sensor, -1);
    assert_int_equal(f.axis, -1);
    pose_log_free(log);
}

/* Every signed permutation of the gyros but the identity is found, as the only class. */
static void every_permutation_is_found(void **state)
{
    (void)state;
    for (int index = 1; index < IMK_SIGNED_AXES; index++) {
        if (check_skips((size_t)index, 4))
            continue;
        pose_log *log = sound(20 + (uint64_t)index);
        const imk_signed_axes p = imk_signed_axes_of(index);
        /* Read gyros so that p mends them. */
        for (int i = 0; i < 3; i++) {
            for (size_t k = 0; k < log->record.count; k++)
                log->value[i][k] *= p.sign[i];
            log->record.reading[0][p.column[i]] = log->value[i];
        }
        const diagnostics d = look(log, NULL);
        assert_int_equal(d.count, 1);
        if (d.finding[0].classes != UINT64_C(1) << index)
            print(&d);
        assert_true(d.finding[0].classes == UINT64_C(1) << index);
        pose_log_free(log);
    }
}

/* A range, or a sampling rate without times: one ratio of all rates, beyond what a sensor errs. */
static void scales_of_no_sensor(void **state)
{
    (void)state;
    static const double ratio[] = {0.25, 0.5, 0.8, 1.25, 2.0, 4.0};
    for (int i = 0; i < 6; i++) {
        pose_log *log = sound(70 + (uint64_t)i);
        scale(log, IMK_GYRO, ratio[i]);
        const imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_SCALE);
        assert_int_equal(f.sensor, IMK_GYRO);
        CHECK_RELATIVE(f.value, ratio[i], 0.03);
        pose_log_free(log);
    }
    for (int i = 0; i < 2; i++) {
        pose_log *log = sound(80 + (uint64_t)i);
        scale(log, IMK_GYRO, i ? 1.1 : 0.9);
        none(log, NULL);
        pose_log_free(log);
    }
}

/* All poses within 45 deg of level: gravity acts along z throughout. */
static void one_cone(void **state)
{
    (void)state;
    const imk_model model = pose_log_model();
    imk_motion_step step[24];
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    for (int i = 0; i < 12; i++) {
        step[2 * i] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 3.0};
        step[2 * i + 1] =
            (imk_motion_step){.kind = IMK_STEP_POSE,
                              .duration = 2.0,
                              .angle = {0.6 * sin(2.4 * i), 0.6 * cos(2.4 * i), 0.5 * i}};
    }
    script.step_count = 23;
    pose_log *log = pose_log_of(&model, &script, 58.0, 100.0, 1);
    const imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_ONE_CONE);
    assert_int_equal(f.axis, 2);
    pose_log_free(log);
}

/* Turned about x over and over, and only five times about the others. */
static pose_log *mostly_about_x(uint64_t seed)
{
    enum { POSES = 24 };
    const imk_model model = pose_log_model();
    imk_motion_step step[2 * POSES];
    imk_motion_script script = imk_motion_script_default();
    script.step = step;
    for (int i = 0; i < POSES; i++) {
        step[2 * i] = (imk_motion_step){.kind = IMK_STEP_HOLD, .duration = 3.0};
        step[2 * i + 1] = (imk_motion_step){.kind = IMK_STEP_ROTATE,
                                            .axis = i % 5 == 4 ? 1 + i / 5 % 2 : 0,
                                            .amount = i % 3 == 0 ? -1.4 : 1.1,
                                            .rate = 0.8};
    }
    script.step_count = 2 * POSES;
    return pose_log_of(&model, &script, 24.0 * 4.7, 100.0, seed);
}

/* A mistake that concerns few of the turns is found all the same, and rightly named. */
static void axes_seldom_turned_about(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        pose_log *log = mostly_about_x(seed);
        none(log, NULL);
        const double *y = log->record.reading[0][1];
        log->record.reading[0][1] = log->record.reading[0][2];
        log->record.reading[0][2] = y;
        imk_diagnostic_finding f = only(log, NULL, IMK_DIAGNOSTIC_SWAPPED_AXES);
        assert_int_equal(f.sensor, IMK_GYRO);
        assert_int_equal(f.axis, 1);
        assert_int_equal(f.other, 2);
        log->record.reading[0][2] = log->record.reading[0][1];
        log->record.reading[0][1] = y;
        for (size_t k = 0; k < log->record.count; k++)
            log->value[1][k] = -log->value[1][k];
        f = only(log, NULL, IMK_DIAGNOSTIC_LEFT_HANDED);
        assert_int_equal(f.sensor, IMK_GYRO);
        assert_int_equal(f.axis, 1);
        pose_log_free(log);
    }
}

/* One turn in five spoilt, by gyros that miss it or by a hand that let the unit slip: no axis is
 * doubted for that. */
static void bad_turns_are_no_bad_axes(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        pose_log *log = seed % 2 ? mostly_about_x(seed) : sound(seed);
        const imk_static_settings settings = imk_static_default();
        pose_log_detect(log, &settings, NULL);
        assert_true(log->count > 10);
        for (size_t i = seed % 5; i + 1 < log->count; i += 5)
            for (size_t k = log->interval[i].end; k < log->interval[i + 1].begin; k++)
                log->value[seed % 3][k] *= seed % 4 < 2 ? 0.0 : -1.0;
        const diagnostics d = look(log, NULL);
        if (find(&d, IMK_DIAGNOSTIC_SWAPPED_AXES) || find(&d, IMK_DIAGNOSTIC_LEFT_HANDED))
            print(&d);
        assert_null(find(&d, IMK_DIAGNOSTIC_SWAPPED_AXES));
        assert_null(find(&d, IMK_DIAGNOSTIC_LEFT_HANDED));
        assert_null(find(&d, IMK_DIAGNOSTIC_RATE_UNIT));
        pose_log_free(log);
    }
}

/* z saturates at 8 m/s^2, with the range stated and without. */
static void saturated_poses(void **state)
{
    (void)state;
    imk_model model = pose_log_model();
    pose_log *log = sound(9);
    for (size_t k = 0; k < log->record.count; k++)
        log->value[5][k] = fmax(fmin(log->value[5][k], 8.0), -8.0);
    diagnostics d = look(log, NULL);
    const imk_diagnostic_finding *f = find(&d, IMK_DIAGNOSTIC_SATURATED);
    assert_non_null(f);
    assert_int_equal(f->sensor, IMK_ACCEL);
    assert_int_equal(f->axis, 2);
    model.accel.range.value[2] = 8.0;
    d = look(log, &model);
    f = find(&d, IMK_DIAGNOSTIC_SATURATED);
    assert_non_null(f);
    assert_int_equal(f->axis, 2);
    assert_true(f->value > 0.05 && f->value < 0.4);
    pose_log_free(log);
}

static void counts_and_stuck_axis(void **state)
{
    (void)state;
    imk_model model = pose_log_model();
    for (int i = 0; i < 3; i++) {
        model.gyro.sensitivity.value[i] = 7500.0;
        model.accel.sensitivity.value[i] = 1670.0;
    }
    pose_log *log = pose_log_simulate(&model, 16, 3.0, 2.0, 10);
    log->record.counts[0] = log->record.counts[1] = false;
    diagnostics d = look(log, NULL);
    assert_true(d.count >= 2);
    assert_int_equal(d.finding[0].kind, IMK_DIAGNOSTIC_COUNTS);
    assert_int_equal(d.finding[1].kind, IMK_DIAGNOSTIC_COUNTS);
    assert_null(find(&d, IMK_DIAGNOSTIC_GRAVITY_UNIT));
    pose_log_free(log);
    log = sound(11);
    for (size_t k = 0; k < log->record.count; k++)
        log->value[1][k] = 0.25;
    d = look(log, NULL);
    const imk_diagnostic_finding *f = find(&d, IMK_DIAGNOSTIC_STUCK);
    assert_non_null(f);
    assert_int_equal(f->sensor, IMK_GYRO);
    assert_int_equal(f->axis, 1);
    pose_log_free(log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_logs_raise_none),
        cmocka_unit_test(real_logs_raise_none),
        cmocka_unit_test(never_static_and_never_moves),
        cmocka_unit_test(few_poses_and_one_plane),
        cmocka_unit_test(units_of_force),
        cmocka_unit_test(units_of_rate_and_time),
        cmocka_unit_test(axes_exchanged_and_inverted),
        cmocka_unit_test(every_permutation_is_found),
        cmocka_unit_test(scales_of_no_sensor),
        cmocka_unit_test(one_cone),
        cmocka_unit_test(axes_seldom_turned_about),
        cmocka_unit_test(bad_turns_are_no_bad_axes),
        cmocka_unit_test(saturated_poses),
        cmocka_unit_test(counts_and_stuck_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
