/* SPDX-License-Identifier: Apache-2.0 */
/* Motion from tables: poses in every form, recorded truth, and what is refused. Positions are
 * compared with the textbook formula of geodetic coordinates on WGS84. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include "imukit/io.h"

#include "io/motion/geodetic_difference_internal.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const double degree = 3.14159265358979323846 / 180;
static const double gravity = 9.80665;

/* A few roundings of conversion. */
static const double rounding = 1e-15;

static void fail_with(const imk_error *error)
{
    char message[512];
    imk_error_text(error, NULL, message, sizeof message);
    fail_msg("%s", message);
}

static char table_path[64];

static void write_table(const char *text)
{
    FILE *file = fopen(table_path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static imk_motion_file *table(const char *text, const imk_geodetic *place)
{
    imk_motion_file *file = NULL;
    imk_error error;
    write_table(text);
    if (imk_motion_read(table_path, NULL, place, 0, &file, &error) != IMK_OK)
        fail_with(&error);
    return file;
}

static imk_motion_state state_at(const imk_motion_file *file, double time)
{
    imk_motion_state at;
    imk_trajectory_state(imk_motion_file_motion(file)->trajectory, time, &at);
    return at;
}

static void check_euler(const imk_motion_state *at, double roll, double pitch, double yaw)
{
    double angle[3];
    imk_matrix3_to_euler(at->c_nb, &angle[0], &angle[1], &angle[2]);
    /* Rounding of a dozen operations on numbers of size 1. */
    CHECK_CLOSE(angle[0], roll * degree, 1e-14);
    CHECK_CLOSE(angle[1], pitch * degree, 1e-14);
    CHECK_CLOSE(angle[2], yaw * degree, 1e-14);
}

/* Of WGS84: a = 6378137 m, 1/f = 298.257223563; r = N cos(lat) …, N = a/sqrt(1 - e^2 sin^2). */
static imk_vector3 textbook_ecef(double latitude, double longitude, double height)
{
    const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double n = a / sqrt(1 - e2 * sin(latitude) * sin(latitude));
    return (imk_vector3){{(n + height) * cos(latitude) * cos(longitude),
                          (n + height) * cos(latitude) * sin(longitude),
                          (n * (1 - e2) + height) * sin(latitude)}};
}

/* Far away: the difference of the textbook's positions, which have 1e-9 m. Near by:
 * the change up to the second order, north by (M + h) d, east by (N + h) cos(lat) l. */
static void differences_of_places_are_exact(void **state)
{
    (void)state;
    const imk_geodetic from = {0.7, -2.1, 1500}, far = {-1.2, 2.9, -300};
    const imk_vector3 a = textbook_ecef(0.7, -2.1, 1500), b = textbook_ecef(-1.2, 2.9, -300);
    imk_vector3 way = imki_geodetic_difference(from, far);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(way.v[i], b.v[i] - a.v[i], 5e-9);
    const double d = 0x1p-26, l = -0x1p-25, h = 0x1p-4; /* added without rounding */
    const imk_geodetic start = {0.75, -2.25, 1500}, near = {0.75 + d, -2.25 + l, 1500 + h};
    const double f = 1 / 298.257223563, e2 = f * (2 - f), w = 1 - e2 * sin(0.75) * sin(0.75);
    const double n = 6378137 / sqrt(w), m = n * (1 - e2) / w;
    const double north = (m + 1500) * d, east = (n + 1500) * cos(0.75) * l;
    way = imki_geodetic_difference(start, near);
    const imk_matrix3 axes = imk_ned_axes(0.75, -2.25);
    const imk_vector3 ned = imk_matrix3_apply(imk_matrix3_transpose(axes), way);
    /* Second order: the parallel bends to the north, M grows by 3 M e^2 sin cos/w d, the parallels
     * are shorter in the north, a higher way is longer; and the Earth is round. Rounding of 0.1 m.
     */
    const double sine = sin(0.75), cosine = cos(0.75);
    CHECK_CLOSE(ned.v[0],
                north + 0.5 * (n + 1500) * sine * cosine * l * l +
                    1.5 * m * e2 * sine * cosine / w * d * d + h * d,
                1e-15);
    CHECK_CLOSE(ned.v[1], east - (m + 1500) * sine * d * l + h * cosine * l, 1e-15);
    CHECK_CLOSE(ned.v[2], -h + 0.5 * ((m + 1500) * d * d + (n + 1500) * cosine * cosine * l * l),
                1e-15);
}

/* At the rows the trajectory is what the table says; places up to the rounding of 6e6 m. */
static void geodetic_rows_are_met(void **state)
{
    (void)state;
    imk_motion_file *file =
        table("time [s],lat [deg],Longitude [deg],alt [m],roll [deg],pitch [deg],yaw "
              "[deg],vel_north [m/s]\n"
              "100,45,7,300,1,2,170,0\n101,45.0001,7.0002,301,2,3,180,0\n"
              "102,45.0003,7.0004,303,0,1,-170,0\n103,45.0004,7.0007,304,-1,1,-150,0\n"
              "104,45.0004,7.0009,300,-1,1,-150,0\n",
              NULL);
    assert_int_equal(imk_motion_file_kind(file), IMK_MOTION_POSES);
    assert_string_equal(imk_motion_file_note(file), "1 column is not used");
    CHECK_CLOSE(imk_motion_file_duration(file), 4, 0);
    const double place[3][3] = {{45, 7, 300}, {45.0003, 7.0004, 303}, {45.0004, 7.0009, 300}};
    const double angle[3][3] = {{1, 2, 170}, {0, 1, -170}, {-1, 1, -150}};
    CHECK_OK(imk_trajectory_validate(imk_motion_file_motion(file)->trajectory, NULL));
    for (int i = 0; i < 3; i++) {
        const imk_motion_state at = state_at(file, 2.0 * i);
        CHECK_CLOSE(at.place.latitude, place[i][0] * degree, 1e-15);
        CHECK_CLOSE(at.place.longitude, place[i][1] * degree, 1e-15);
        CHECK_CLOSE(at.place.height, place[i][2], 5e-9);
        check_euler(&at, angle[i][0], angle[i][1], angle[i][2]);
    }
    imk_motion_file_free(file);
}

/* A flat frame at the place: 1000 m to the east, with the attitude of that frame. The tangent plane
 * is d^2/2R higher there: 78 mm. */
static void local_rows_are_in_the_frame_at_the_place(void **state)
{
    (void)state;
    const imk_geodetic place = {.latitude = 0.5, .longitude = 0.25, .height = 100};
    imk_motion_file *file = table("time [s],x [m],y [m],z [m],q_w,q_x,q_y,q_z\n"
                                  "0,0,0,0,1,0,0,0\n1,0,500,-20,1,0,0,0\n2,0,1000,0,1,0,0,0\n",
                                  &place);
    const imk_motion_state at = state_at(file, 2.0);
    const imk_vector3 start = textbook_ecef(0.5, 0.25, 100);
    /* East is (-sin lon, cos lon, 0). */
    CHECK_CLOSE(at.position.v[0], start.v[0] - 1000 * sin(0.25), 2e-9);
    CHECK_CLOSE(at.position.v[1], start.v[1] + 1000 * cos(0.25), 2e-9);
    CHECK_CLOSE(at.position.v[2], start.v[2], 2e-9);
    CHECK_CLOSE(at.place.height, 100 + 1e6 / (2 * 6.38e6), 1e-3);
    /* The attitude is that of the start: east is not quite east any more. */
    const imk_motion_state at_start = state_at(file, 0.0);
    CHECK_CLOSE(at.attitude.w, at_start.attitude.w, 1e-15);
    CHECK_CLOSE(at.attitude.z, at_start.attitude.z, 1e-15);
    check_euler(&at_start, 0, 0, 0);
    imk_motion_file_free(file);
}

/* Earth-fixed positions, a quaternion of few digits, and no times but a rate. 90 deg of yaw; the
 * second quaternion is the first one with the other sign. */
static void earth_fixed_rows_are_met(void **state)
{
    (void)state;
    char text[512];
    const imk_vector3 a = textbook_ecef(0.5, 0.25, 100), b = textbook_ecef(0.5, 0.25, 107);
    snprintf(text, sizeof text,
             "gyro_0 [deg/s],ecef_x [m],ecef_y [m],ecef_z [m],qw,qx,qy,qz\n"
             "0,%.9f,%.9f,%.9f,0.707,0,0,0.707\n0,%.9f,%.9f,%.9f,-0.707,0,0,-0.707\n",
             a.v[0], a.v[1], a.v[2], b.v[0], b.v[1], b.v[2]);
    write_table(text);
    imk_log_settings settings = imk_log_default();
    settings.columns = "-,ecef_x,ecef_y,ecef_z,qw,qx,qy,qz";
    settings.rate = 0.5;
    imk_motion_file *file = NULL;
    CHECK_OK(imk_motion_read(table_path, &settings, NULL, 0, &file, NULL));
    CHECK_CLOSE(imk_motion_file_duration(file), 2, 0);
    const imk_motion_state at = state_at(file, 2);
    CHECK_CLOSE(at.place.latitude, 0.5, 1e-15);
    CHECK_CLOSE(at.place.height, 107, 5e-9);
    CHECK_CLOSE(state_at(file, 1).velocity_ned.v[2], -3.5, 1e-8);
    check_euler(&at, 0, 0, 90);
    imk_motion_file_free(file);
}

static void what_is_missing_is_at_rest(void **state)
{
    (void)state;
    const imk_geodetic place = {.latitude = 0.5, .longitude = 0.25, .height = 100};
    imk_motion_file *file = table(
        "time [s],roll [deg],pitch [deg],heading [deg]\n0,0,0,0\n1,0,10,0\n2,0,10,20\n", &place);
    assert_string_equal(imk_motion_file_note(file),
                        "the table has no position: the unit stays at its place");
    imk_motion_state at = state_at(file, 2.0);
    check_euler(&at, 0, 10, 20);
    CHECK_CLOSE(at.place.latitude, 0.5, 1e-15);
    CHECK_CLOSE(at.place.height, 100, 2e-9);
    CHECK_CLOSE(imk_vector3_norm(at.velocity), 0, 0);
    imk_motion_file_free(file);
    file = table("time [s],north [m],east [m],down [m],note\n0,0,0,0,a\n1,1,0,0,b\n", &place);
    assert_string_equal(
        imk_motion_file_note(file),
        "the table has no attitude: the unit is level, heading north; 1 column is not used");
    at = state_at(file, 0.0);
    check_euler(&at, 0, 0, 0);
    CHECK_CLOSE(at.velocity_ned.v[0], 1.0, 1e-9);
    imk_motion_file_free(file);
}

static void recorded_truth_is_kept(void **state)
{
    (void)state;
    /* 204.8 Hz with times rounded to a microsecond: not 205 Hz. */
    imk_motion_file *file =
        table("time [s],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [g],accel_y "
              "[g],accel_z [g],angular_acceleration_x [deg/s^2],angular_acceleration_y "
              "[deg/s^2],angular_acceleration_z [deg/s^2]\n"
              "5,1,2,3,0,0,-1,7,8,9\n5.004883,4,5,6,0,0.5,-1,7,8,9\n5.009766,7,8,9,1,0,-1,7,8,9\n",
              NULL);
    const imk_recorded_motion *recorded = imk_motion_file_motion(file)->recorded;
    assert_int_equal(imk_motion_file_kind(file), IMK_MOTION_RECORDED);
    assert_null(imk_motion_file_motion(file)->trajectory);
    assert_int_equal(recorded->count, 3);
    CHECK_CLOSE(recorded->rate, 204.8, 0);
    CHECK_RELATIVE(imk_motion_file_duration(file), 3 / 204.8, rounding);
    CHECK_RELATIVE(recorded->angular_rate[1][2], 8 * degree, rounding);
    CHECK_RELATIVE(recorded->specific_force[1][1], 0.5 * gravity, rounding);
    CHECK_RELATIVE(recorded->angular_acceleration[2][0], 9 * degree, rounding);
    imk_motion_file_free(file);
    /* Increments over 10 ms. */
    file = table("time [s],dtheta_x [rad],dtheta_y [rad],dtheta_z [rad],dvel_x [m/s],dvel_y "
                 "[m/s],dvel_z [m/s]\n0,0.01,0,0,0,0,-0.1\n0.01,0.01,0,0,0,0,-0.1\n",
                 NULL);
    recorded = imk_motion_file_motion(file)->recorded;
    CHECK_CLOSE(recorded->rate, 100, 0);
    CHECK_RELATIVE(recorded->angular_rate[0][1], 1, rounding);
    CHECK_RELATIVE(recorded->specific_force[2][0], -10, rounding);
    assert_null(recorded->angular_acceleration[0]);
    imk_motion_file_free(file);
}

#define SIX "gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s],accel_x [g],accel_y [g],accel_z [g]"
#define ANGLES "roll [deg],pitch [deg],yaw [deg]"
#define PLACES "latitude [deg],longitude [deg],height [m]"

static const struct {
    const char *text, *message;
} bad_tables[] = {
    {"time [s],a,b\n0,1,2\n1,1,2\n",
     "m.csv: no column of a motion has a known name; expected one of latitude, longitude, height, "
     "x, y, z, roll, pitch, yaw, q_w … q_z, or gyro_x … accel_z"},
    {"time [s]," ANGLES "\n0,1,2,3\n",
     "m.csv: a single row is not a motion; expected two rows or more"},
    {"time [s]," ANGLES "\n0,1,2,3\n1,1,2,3\n1,1,2,3\n",
     "m.csv: time, row 3: this time is not later than that of the row before; remove one of the "
     "two rows, or sort the rows by time"},
    {"time [s]," ANGLES "\n0,1,2,3\n1,1,2,3\n0.5,1,2,3\n",
     "m.csv: time, row 3: this time is not later than that of the row before; remove one of the "
     "two rows, or sort the rows by time"},
    {"time [s]," ANGLES "\n0,1,2,3\n1,1,,3\n",
     "m.csv: pitch, row 2: nan is not finite; expected a number in every row"},
    {"time [s]," ANGLES "\n0,1,2,3\n1,1,2,153\n",
     "m.csv: attitude, row 2: \"150 deg\" is the rotation since the row before; expected at most "
     "120 deg from row to row, so that its direction is clear"},
    {"time [s],roll [deg],pitch [deg]\n0,1,2\n1,1,2\n",
     "m.csv: yaw: this column is missing; the columns roll, pitch and yaw go together"},
    {"time [s],roll,pitch,yaw\n0,1,2,3\n1,1,2,3\n",
     "m.csv: \"roll\" has no unit; write the unit in the header, as in roll [deg]"},
    {"time [s],roll [m],pitch [m],yaw [m]\n0,1,2,3\n1,1,2,3\n",
     "m.csv: roll: \"m\" is a length; expected an angle, such as deg, mrad, urad or arcsec"},
    {"time [s],yaw [deg],heading [deg],roll [deg],pitch [deg]\n0,1,2,3,4\n1,1,2,3,4\n",
     "m.csv: yaw: this column is in the table twice; remove one of the two columns"},
    {"time [s],q_w,q_x,q_y,q_z\n0,1,0,0,0\n1,0.5,0,0,0\n",
     "m.csv: q_w, row 2: \"0.5\" is the length of the quaternion; expected a length of 1, up to "
     "the rounding of the digits"},
    {"time [s],q_w,q_x,q_y,q_z\n0,1,0,0,0\n1,0.988,0,0,0\n",
     "m.csv: q_w, row 2: \"0.988\" is the length of the quaternion; expected a length of 1, up to "
     "the rounding of the digits"},
    {"time [s]," ANGLES "\n0,0,0,0\n1,122,0,0\n",
     "m.csv: attitude, row 2: \"122 deg\" is the rotation since the row before; expected at most "
     "120 deg from row to row, so that its direction is clear"},
    {"time [s],q_w,q_x,q_z\n0,1,0,0\n1,1,0,0\n",
     "m.csv: q_y: this column is missing; the columns q_w, q_x, q_y and q_z go together"},
    {"time [s]," ANGLES ",q_w,q_x,q_y,q_z\n0,1,2,3,1,0,0,0\n1,1,2,3,1,0,0,0\n",
     "m.csv: roll and q_w are two descriptions of the attitude; remove the columns of one of the "
     "two"},
    {"time [s]," PLACES ",x [m],y [m],z [m]\n0,1,2,3,0,0,0\n1,1,2,3,0,0,0\n",
     "m.csv: latitude and x are two descriptions of the position; remove the columns of one of the "
     "two"},
    {"time [s]," PLACES "\n0,1,2,3\n1,91,2,3\n",
     "m.csv: latitude, row 2: \"91 deg\" is beyond a pole; expected between -90 deg and 90 deg"},
    {"time [s]," PLACES "\n0,1,2,3\n1,1,2,1e160\n",
     "m.csv: height, row 2: \"1e+160 m\" is beyond the limit; expected between -10000000 m and "
     "10000000 m"},
    {"time [s]," ANGLES "\n0,1,1e20,3\n1,1,2,3\n",
     "m.csv: pitch, row 1: \"1e+20 deg\" is beyond the limit; expected between -10000000 deg and "
     "10000000 deg"},
    {"time [s],x [m],y [m],z [m]\n0,1,2,3\n1,1,-2e7,3\n",
     "m.csv: y, row 2: \"-20000000 m\" is beyond the limit; expected between -10000000 m and "
     "10000000 m"},
    {"time [s],ecef_x [m],ecef_y [m],ecef_z [m]\n0,6378137,0,0\n1,6339068,0,0\n",
     "m.csv: position, row 2: \"6339.068 km\" is the distance from the centre of the Earth; "
     "expected "
     "6340 km to 16400 km"},
    {"time [s]," ANGLES "\n0,1,2,3\n1e-320,1,2,3\n1,1,2,3\n",
     "m.csv: time, row 2: \"9.99989e-321 s\" is the time since the row before; expected a step of "
     "time from 1 ns to 1e9 s"},
    {"time [s]," PLACES "," ANGLES "\n0,45,7,300,0,0,90\n1,45.0001,7,0,1,0,100\n"
     "2,45.0002,7.0001,302,3,0,110\n3,45.0003,7.0001,302,1,1,115\n"
     "404500,0.4,7.0002,302,0,1,120\n",
     "m.csv: poses, row 4: the rows around this one cannot be joined by a smooth motion; split the "
     "table at this row, or fill the gap"},
    {"time [s],lat [deg],lon [deg]\n0,1,2\n1,1,2\n",
     "m.csv: height: this column is missing; the columns latitude, longitude and height go "
     "together"},
    {"time [s]," ANGLES "," SIX "\n0,1,2,3,1,2,3,4,5,6\n",
     "m.csv: the table has both poses, and rates or forces; remove the columns of one of the two"},
    {"time [s]," SIX "\n0,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n0.03,1,2,3,4,5,6\n0.04,1,2,3,4,5,6\n",
     "m.csv: time, row 3: the time since the row before is 0.02 s, not 0.01 s; recorded rates and "
     "forces "
     "must have equal time steps; resample them, or give a table of poses"},
    {"time [s]," SIX "\n0,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n0.020120,1,2,3,4,5,6\n0.03,1,2,3,4,5,6\n",
     "m.csv: time, row 3: the time since the row before is 0.01012 s, not 0.01 s; recorded rates "
     "and "
     "forces must have equal time steps; resample them, or give a table of poses"},
    {"time [s],gyro_x [deg/s],gyro_y [deg/s]\n0,1,2\n1,1,2\n",
     "m.csv: gyro_z: this column is missing; recorded motion needs gyro_x, gyro_y, gyro_z, "
     "accel_x, accel_y and accel_z"},
    {"time [s]," SIX "\n0,1,2,3,4,5,nan\n1,1,2,3,4,5,6\n",
     "m.csv: accel_z, row 1: nan is not finite; expected a number in every row"},
    {"time [s],gyro_x [count],gyro_y [count],gyro_z [count],accel_x [g],accel_y [g],accel_z "
     "[g]\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n",
     "m.csv: gyro_x: \"count\" is a number of counts; expected an angular rate, such as deg/h, "
     "deg/s or rad/s"},
    {"time [s]," SIX ",angular_acceleration_x [deg/s^2]\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n",
     "m.csv: angular_acceleration: the column of one axis is missing; give all three axes or none"},
    {"time [s],roll [deg],pitch [deg],yaw [deg]\n0,a,b,c\n1,a,b,c\n",
     "m.csv: roll: this column contains texts; expected a column of numbers"},
};

/* Just within what is refused above. */
static void tables_within_the_tolerances(void **state)
{
    (void)state;
    static const char *const tables[] = {
        "time [s],q_w,q_x,q_y,q_z\n0,1,0,0,0\n1,0.992,0,0,0\n",
        "time [s]," ANGLES "\n0,0,0,0\n1,118,0,0\n",
        "time [s]," SIX
        "\n0,1,2,3,4,5,6\n0.01,1,2,3,4,5,6\n0.020080,1,2,3,4,5,6\n0.03,1,2,3,4,5,6\n",
    };
    for (size_t i = 0; i < COUNT(tables); i++) {
        imk_motion_file *file = NULL;
        imk_error error;
        write_table(tables[i]);
        CHECK_STATUS(imk_motion_read(table_path, NULL, NULL, 0, &file, &error), IMK_OK);
        imk_motion_file_free(file);
    }
}

static void bad_tables_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(bad_tables); i++) {
        imk_motion_file *file = NULL;
        imk_error error;
        char message[512];
        write_table(bad_tables[i].text);
        const imk_status status = imk_motion_read(table_path, NULL, NULL, 0, &file, &error);
        if (status == IMK_OK)
            fail_msg("%s is taken", bad_tables[i].text);
        assert_null(file);
        imk_error_text(&error, "m.csv", message, sizeof message);
        assert_string_equal(message, bad_tables[i].message);
        CHECK_STATUS(imk_motion_read(table_path, NULL, NULL, 0, &file, NULL), status);
    }
    imk_motion_file *file = NULL;
    CHECK_STATUS(imk_motion_read("/nowhere/m.yaml", NULL, NULL, 0, &file, NULL), IMK_ERROR_OPEN);
    CHECK_STATUS(imk_motion_read("/nowhere/m.csv", NULL, NULL, 0, &file, NULL), IMK_ERROR_OPEN);
}

/* A published profile of a car: the trajectory passes through its rows. */
static void groves_profile_is_read(void **state)
{
    (void)state;
    static const char path[] = SHARED_DIRECTORY "/data/navigation/groves_profile_1.csv.gz";
    imk_log log;
    if (access(path, R_OK) != 0) {
        print_message("%s is not here: skipped\n", path);
        skip();
    }
    imk_motion_file *file = NULL;
    CHECK_OK(imk_motion_read(path, NULL, NULL, 0, &file, NULL));
    CHECK_OK(imk_log_load(path, NULL, NULL, &log, NULL));
    assert_string_equal(imk_motion_file_note(file), "3 columns are not used");
    CHECK_CLOSE(imk_motion_file_duration(file), log.data[0][log.rows - 1], 0);
    for (size_t row = 0; row < log.rows; row += 97) {
        const imk_motion_state at = state_at(file, log.data[0][row]);
        CHECK_CLOSE(at.place.latitude, log.data[1][row], 1e-15);
        CHECK_CLOSE(at.place.longitude, log.data[2][row], 1e-15);
        CHECK_CLOSE(at.place.height, log.data[3][row], 1e-8);
        double roll, pitch, yaw;
        imk_matrix3_to_euler(at.c_nb, &roll, &pitch, &yaw);
        CHECK_CLOSE(roll, log.data[7][row], 1e-13);
        CHECK_CLOSE(pitch, log.data[8][row], 1e-13);
        CHECK_CLOSE(sin(0.5 * (yaw - log.data[9][row])), 0.0, 1e-13);
    }
    imk_log_free(&log);
    imk_motion_file_free(file);
}

static int make_path(void **state)
{
    (void)state;
    snprintf(table_path, sizeof table_path, "/tmp/imukit_motion_%ld.csv", (long)getpid());
    return 0;
}

static int remove_table(void **state)
{
    (void)state;
    remove(table_path);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(differences_of_places_are_exact),
        cmocka_unit_test(geodetic_rows_are_met),
        cmocka_unit_test(local_rows_are_in_the_frame_at_the_place),
        cmocka_unit_test(earth_fixed_rows_are_met),
        cmocka_unit_test(what_is_missing_is_at_rest),
        cmocka_unit_test(recorded_truth_is_kept),
        cmocka_unit_test(tables_within_the_tolerances),
        cmocka_unit_test(bad_tables_are_refused),
        cmocka_unit_test(groves_profile_is_read),
    };
    return cmocka_run_group_tests(tests, make_path, remove_table);
}
