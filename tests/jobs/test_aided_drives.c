/* SPDX-License-Identifier: Apache-2.0 */
/* The job of navigation with aids: are errors as large as it states? A short form of
 * experiments/aided_drives.c, on units drawn here. And what it keeps of its readings. */
#include "check.h"

#include "imukit/jobs.h"

#include <stdlib.h>
#include <string.h>

enum { LOG_COLUMNS = 7, AID_COLUMNS = 13, ROWS = 170 * 20, READINGS = 200 };
static const double degree = 0.017453292519943295, rate = 20.0;

static double log_data[LOG_COLUMNS][ROWS], aid_data[AID_COLUMNS][READINGS];
static imk_model unit;
static imk_trajectory_piece pieces[200];
static imk_trajectory trajectory;

static const char *const log_names[LOG_COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                                   "accel_x", "accel_y", "accel_z"};
static const char *const aid_names[AID_COLUMNS] = {"time",
                                                   "latitude [rad]",
                                                   "longitude [rad]",
                                                   "height [m]",
                                                   "sigma_north [m]",
                                                   "sigma_east [m]",
                                                   "sigma_down [m]",
                                                   "velocity_north [m/s]",
                                                   "velocity_east [m/s]",
                                                   "velocity_down [m/s]",
                                                   "sigma_velocity_north [m/s]",
                                                   "sigma_velocity_east [m/s]",
                                                   "sigma_velocity_down [m/s]"};

/* 30 s at rest, then two turns at 12 m/s. */
static int set_up(void **state)
{
    (void)state;
    static const imk_motion_step step[] = {
        {.kind = IMK_STEP_HOLD, .duration = 30.0},
        {.kind = IMK_STEP_ACCELERATE, .amount = 12.0, .rate = 2.0},
        {.kind = IMK_STEP_HOLD, .duration = 30.0},
        {.kind = IMK_STEP_TURN, .amount = 1.6, .rate = 0.2},
        {.kind = IMK_STEP_HOLD, .duration = 40.0},
        {.kind = IMK_STEP_TURN, .amount = -1.2, .rate = 0.2},
        {.kind = IMK_STEP_HOLD, .duration = 60.0}};
    imk_motion_script script = imk_motion_script_default();
    size_t count;
    script.step = step;
    script.step_count = sizeof step / sizeof *step;
    CHECK_OK(imk_motion_script_pieces(&script, &count, NULL));
    assert_true(count <= sizeof pieces / sizeof *pieces);
    CHECK_OK(imk_motion_script_compile(&script, pieces, count, &trajectory, NULL));
    imk_model_default(&unit);
    for (int i = 0; i < 3; i++) {
        unit.gyro.bias.repeatability.value[i] = 1.0 * degree / 3600.0;
        unit.accel.bias.repeatability.value[i] = 5e-3;
        unit.gyro.noise.white.value[i] = 3e-5;
        unit.accel.noise.white.value[i] = 1e-3;
    }
    return 0;
}

static imk_record_source source_of(size_t columns, const char *const *names, double *data,
                                   size_t stride, size_t rows, imk_array_source *memory)
{
    const double *at[AID_COLUMNS];
    imk_record_source source;
    for (size_t c = 0; c < columns; c++)
        at[c] = data + c * stride;
    CHECK_OK(imk_array_source_make(columns, names, at, rows, 0.0, memory, &source, NULL));
    return source;
}

/* @param normal  the error of the heading that is given, in its sigma */
static imk_navigate_log *navigate(uint32_t run, double normal, bool smooth)
{
    static imk_array_source log_memory, aid_memory;
    double *log_at[LOG_COLUMNS], *aid_at[AID_COLUMNS];
    imk_error error;
    for (size_t c = 0; c < LOG_COLUMNS; c++)
        log_at[c] = log_data[c];
    for (size_t c = 0; c < AID_COLUMNS; c++)
        aid_at[c] = aid_data[c];
    imk_array_sink log = {.column_count = LOG_COLUMNS, .capacity = ROWS, .data = log_at};
    imk_array_sink aids = {.column_count = AID_COLUMNS, .capacity = READINGS, .data = aid_at};
    const imk_record_sink log_sink = imk_array_sink_of(&log);
    const imk_record_sink aid_sink = imk_array_sink_of(&aids);
    imk_simulate_log_settings s = imk_simulate_log_default();
    s.simulation.motion.trajectory = &trajectory;
    s.simulation.rate = rate;
    s.simulation.run = run;
    s.rows = ROWS;
    imk_aid aid[2] = {imk_aid_default(IMK_AID_POSITION), imk_aid_default(IMK_AID_VELOCITY)};
    imk_navigate_log_settings o = imk_navigate_log_default();
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            aid[k].lever_arm[i] = o.lever_arm[i] = (double[3]){1.0, -0.5, -1.5}[i];
            aid[k].sigma[i] = k == 1 ? 0.05 : 1.0;
            aid[k].from = 0.337;
        }
    CHECK_OK(imk_simulate_log_run(&unit, &s, &log_sink, "", NULL, &error));
    CHECK_OK(imk_simulate_aids_run(&unit, &s, 2, aid, &aid_sink, NULL, &error));
    const imk_record_source from =
        source_of(LOG_COLUMNS, log_names, &log_data[0][0], ROWS, log.rows, &log_memory);
    const imk_record_source readings =
        source_of(AID_COLUMNS, aid_names, &aid_data[0][0], READINGS, aids.rows, &aid_memory);
    o.place = (imk_geodetic){45.0 * degree, 0.0, 0.0};
    o.align = 25.0;
    o.heading_given = true;
    o.attitude_sigma[2] = 2.0 * degree;
    o.attitude[2] = normal * o.attitude_sigma[2];
    o.model = &unit;
    o.hold_height = false;
    o.aids = &readings;
    o.smooth = smooth;
    imk_navigate_log *n;
    CHECK_OK(imk_navigate_log_run(&from, &o, NULL, &n, &error));
    return n;
}

/* Normalised errors squared of position and velocity in a row of the track. */
static double off_in(double *const *track, size_t row)
{
    imk_motion_state m;
    imk_trajectory_state(&trajectory, track[IMK_TRACK_TIME][row], &m);
    const imk_matrix3 axes = imk_ned_axes(m.place.latitude, m.place.longitude);
    const imk_vector3 there = imk_ecef_from_geodetic((imk_geodetic){track[IMK_TRACK_LATITUDE][row],
                                                                    track[IMK_TRACK_LONGITUDE][row],
                                                                    track[IMK_TRACK_HEIGHT][row]});
    const imk_vector3 off =
        imk_matrix3_apply(imk_matrix3_transpose(axes), imk_vector3_subtract(there, m.position));
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double speed = track[IMK_TRACK_VELOCITY + i][row] - m.velocity_ned.v[i];
        sum += pow(off.v[i] / track[IMK_TRACK_SIGMA + i][row], 2.0) +
               pow(speed / track[IMK_TRACK_SIGMA + 3 + i][row], 2.0);
    }
    return sum;
}

/* Six normalised errors in four rows 40 s apart and of twenty units. Rows so far apart share little
 * more than the attitude: as many as 160 of the 480 numbers may count as independent ones. Their
 * mean square is then 1 with a standard deviation of sqrt(2/160) = 0.11: five of these. Smoothed
 * rows share more, and the limits are wider by half. */
static void test_bounds(void **state)
{
    (void)state;
    const uint32_t runs = 20;
    double filtered = 0.0, smoothed = 0.0, sigma[2] = {0};
    double normal[20];
    imk_random_normals(imk_random_seeded(7), 1, 0, runs, normal);
    for (uint32_t run = 0; run < runs; run++) {
        imk_navigate_log *n = navigate(run, normal[run], true);
        assert_true(n->track_rows > 140);
        for (size_t row = 20; row <= 140; row += 40) {
            filtered += off_in(n->filtered, row);
            smoothed += off_in(n->track, row);
            sigma[0] += n->filtered[IMK_TRACK_SIGMA][row];
            sigma[1] += n->track[IMK_TRACK_SIGMA][row];
        }
        imk_navigate_log_free(n);
    }
    filtered /= 24.0 * runs;
    smoothed /= 24.0 * runs;
    print_message("mean square over the predicted: filtered %.3f, smoothed %.3f\n", filtered,
                  smoothed);
    CHECK_CLOSE(filtered, 1.0, 0.55);
    CHECK_CLOSE(smoothed, 1.0, 0.8);
    CHECK_BELOW(sigma[1], 0.8 * sigma[0]);
}

/* Readings come 0.337 s after whole seconds; 25 of them are before the navigation. */
static void test_kept(void **state)
{
    (void)state;
    imk_navigate_log *n = navigate(3, 0.0, false);
    assert_int_equal(n->aid_count, 2);
    assert_null(n->filtered[0]);
    for (size_t k = 0; k < 2; k++) {
        const imk_navigate_aid *a = &n->aid[k];
        assert_true(a->sigma_columns && !a->held);
        assert_int_equal(a->readings, 170);
        assert_int_equal(a->outside, 25);
        assert_int_equal(a->tested, 145);
        assert_int_equal(a->counts.accepted + a->counts.refused, 145);
        CHECK_CLOSE(a->first, 25.337, 1e-9);
        CHECK_CLOSE(a->last, 169.337, 1e-9);
        CHECK_CLOSE(a->time[1], 26.337, 1e-9);
    }
    assert_int_equal(imk_findings_failure(&n->findings) == NULL, 1);
    imk_navigate_log_free(n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bounds), cmocka_unit_test(test_kept)};
    return cmocka_run_group_tests(tests, set_up, NULL);
}
