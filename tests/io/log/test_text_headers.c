/* SPDX-License-Identifier: Apache-2.0 */
/* Headers by which a text could be read as something else than it is: times in two columns, axes
 * counted from 1, units that contradict each other, times of another unit than stated. */
#include "check.h"

#include "imukit/io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 32, COLUMNS = 8 };

static struct {
    imk_status status;
    size_t rows, columns;
    imk_log_column column[COLUMNS];
    double data[COLUMNS][ROOM];
    size_t damaged;
    char message[1400];
} t;

static void read_text(const char *text, const imk_log_settings *settings)
{
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    double *data[IMK_LOG_COLUMNS_MAX] = {NULL};
    memset(&t, 0, sizeof t);
    for (size_t j = 0; j < COLUMNS; j++)
        data[j] = t.data[j];
    t.status = imk_log_open_memory(text, strlen(text), settings, &reader, &error);
    assert_int_equal(t.status, error.status); /* one that was overcome is not left behind */
    if (t.status == IMK_OK)
        t.status = imk_log_read(reader, ROOM, data, &t.rows, &error);
    if (t.status == IMK_OK) {
        t.columns = imk_log_column_count(reader);
        for (size_t j = 0; j < t.columns && j < COLUMNS; j++)
            t.column[j] = *imk_log_column_get(reader, j);
        t.damaged = imk_log_findings_get(reader).damaged;
    } else {
        imk_error_text(&error, "log.csv", t.message, sizeof t.message);
    }
    imk_log_close(reader);
}

static void check_says(imk_status status, const char *words)
{
    if (t.status != status || !strstr(t.message, words))
        fail_msg("%s: \"%s\" does not say \"%s\"", imk_status_name(t.status), t.message, words);
}

/* ------------------------------------------------------------------------- times in two columns */

/* The second row is 10 ms behind the first, the third 1 s and 1 ns: exact as differences of whole
 * nanoseconds, which the seconds of 1970 in a double do not hold. */
static void times_in_two_columns_are_joined(void **state)
{
    (void)state;
    static const char *const names[][2] = {{"header.stamp.secs", "header.stamp.nsecs"},
                                           {"field.header.stamp.sec", "field.header.stamp.nanosec"},
                                           {"sec", "nsec"},
                                           {"Secs", "NSecs"},
                                           {"tv_sec", "tv_nsec"}};
    const imk_log_settings settings = imk_log_default();
    char text[400];
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        snprintf(text, sizeof text,
                 "%s,%s,gyro_x [rad/s]\n1714552800,994999999,1\n1714552801,4999999,2\n"
                 "1714552801,995000000,3\n",
                 names[k][0], names[k][1]);
        read_text(text, &settings);
        assert_int_equal(t.status, IMK_OK);
        assert_int_equal(t.columns, 2);
        assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TIME);
        assert_int_equal(t.rows, 3);
        CHECK_CLOSE(t.data[0][0], 0, 0);
        CHECK_CLOSE(t.data[0][1], 0.01, 0);
        CHECK_CLOSE(t.data[0][2], 1.000000001, 0);
    }
    static const char *const more[][3] = {{"seconds", "milliseconds", "0"},
                                          {"sec", "msec", "0"},
                                          {"t_s", "t_ms", "0"},
                                          {"time_sec", "time_usec", "0000"},
                                          {"t_s", "t_us", "0000"},
                                          {"time.s", "time.us", "0000"},
                                          {"timestamp.sec", "timestamp.nsec", "0000000"}};
    for (size_t k = 0; k < sizeof more / sizeof more[0]; k++) {
        snprintf(text, sizeof text, "%s,%s,gyro_x [rad/s]\n7,25%s,1\n8,5%s,2\n", more[k][0],
                 more[k][1], more[k][2], more[k][2]);
        read_text(text, &settings);
        assert_int_equal(t.status, IMK_OK);
        assert_int_equal(t.columns, 2);
        CHECK_CLOSE(t.data[0][0], 7.25, 0); /* 250 ms, 250000 us */
        CHECK_CLOSE(t.data[0][1], 8.05, 0);
    }
    read_text("t_s,t_us,T [degC],gyro_x [rad/s]\n7,250000,20,1\n8,0,20,1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 7.25, 0);
    read_text("sec,usec,gyro_x [rad/s]\n12,999999,1\n13,9999,2\n", &settings);
    CHECK_CLOSE(t.data[0][0], 12.999999, 0); /* a clock without epoch stays as it is */
    CHECK_CLOSE(t.data[0][1], 13.009999, 0);
}

/* Behind the rows that are looked at for what the columns are. */
static void a_rest_of_more_than_a_second_is_no_time(void **state)
{
    (void)state;
    const imk_log_settings settings = imk_log_default();
    char text[800] = "sec,nsec,gyro_x [rad/s]\n";
    for (int k = 0; k < 20; k++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%d,5,1\n", k);
    strcat(text, "20,1000000000,1\n21,5,1\n");
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, 21);
    assert_int_equal(t.damaged, 1);
}

static void seconds_alone_are_no_time_beside_the_rest(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.map = "time=header.stamp.secs,gyro_x=gyro_x";
    read_text("header.stamp.secs,header.stamp.nsecs,gyro_x [rad/s]\n5,500000000,1\n6,0,2\n",
              &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 5.5, 0);
    settings.map = NULL;
    read_text("header.stamp.secs,header.stamp.nsecs,gyro_x [rad/s]\n5.5,500000000,1\n", &settings);
    check_says(IMK_ERROR_COLUMN, "header.stamp.secs is only the seconds of the time");
    read_text("seconds,milliseconds,gyro_x [rad/s]\n5,5000,1\n5,5010,1\n", &settings);
    check_says(IMK_ERROR_COLUMN, "seconds is only the seconds of the time, and milliseconds");
    read_text("time_s,time_ms,gyro_x [rad/s]\n5,5000,1\n5,5010,1\n", &settings);
    check_says(IMK_ERROR_COLUMN, "twice, as time_s and time_ms; say which columns to read");
    /* Those of a clock begin again with each minute. */
    read_text("min,sec,msec,gyro_x [rad/s]\n5,59,0,1\n6,0,0,1\n", &settings);
    check_says(IMK_ERROR_RATE_MISSING, "the log has no time column");
    /* The whole time stands beside them. */
    read_text("time [s],header.stamp.secs,header.stamp.nsecs,gyro_x [rad/s]\n5.5,5,5e8,1\n",
              &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 5.5, 0);
}

/* ------------------------------------------------------------------------- indices in brackets */

static void an_index_stands_before_a_unit(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    read_text("gyro[0] [deg/s],gyro[1] [deg/s],gyro[2] [deg/s],acc[0] (g),acc(1)(g),mag(2) [uT]\n"
              "1,2,3,4,5,6\n",
              &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_string_equal(t.column[0].name, "gyro_x");
    assert_string_equal(t.column[2].name, "gyro_z");
    assert_string_equal(t.column[2].unit.text, "deg/s");
    assert_string_equal(t.column[4].name, "accel_y");
    assert_string_equal(t.column[4].unit.text, "g");
    assert_string_equal(t.column[5].name, "mag_z");
    settings.map = "gyro_z=gyro[0],gyro_x=gyro[2] [deg/s]";
    read_text("gyro[0] [deg/s],gyro[1] [deg/s],gyro[2] [deg/s]\n1,2,3\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_string_equal(t.column[0].name, "gyro_z");
    assert_string_equal(t.column[1].name, "gyro_x");
    settings.map = NULL;
    settings.gyro_unit = "rad/s";
    read_text("gyro[0],gyro[1],gyro(2)\n1,2,3\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_string_equal(t.column[1].name, "gyro_y");
    assert_int_equal(t.column[2].axis, 2);
    /* A unit in brackets of its own. */
    settings.gyro_unit = NULL;
    read_text("gyro_x [(deg)/(s)]\n180\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 3.14159265358979, 1e-14); /* 180 deg/s in rad/s */
}

/* The header that ulog2csv writes for sensor_combined: microseconds, rad/s and m/s^2 by the
 * definition of the message [ULOG]. */
static void columns_of_ulog2csv_have_the_units_of_the_message(void **state)
{
    (void)state;
    static const char text[] =
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,accelerometer_m_s2[0],"
        "accelerometer_m_s2[1],accelerometer_m_s2[2]\n1500000,1,2,3,10000,4,5,6\n";
    imk_log_settings settings = imk_log_default();
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.columns, 8);
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TIME);
    assert_string_equal(t.column[3].name, "gyro_z");
    assert_string_equal(t.column[7].name, "accel_z");
    CHECK_CLOSE(t.data[0][0], 1.5, 0);
    CHECK_CLOSE(t.data[3][0], 3, 0);
    CHECK_CLOSE(t.data[7][0], 6, 0);
    settings.map = "time=timestamp,gyro_x=gyro_rad[1]";
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.columns, 2);
    CHECK_CLOSE(t.data[1][0], 2, 0);
    settings.map = "time=timestamp,gyro_x=gyro_rad[1] [deg/s]";
    read_text(text, &settings);
    check_says(IMK_ERROR_CONFLICT, "[deg/s] does not agree with the file");
}

/* ------------------------------------------------------------------------- units in other words */

static void check_unit(const char *column, const char *unit)
{
    char text[200];
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    snprintf(text, sizeof text, "%s,gyro_z [rad/s]\n1,2\n", column);
    read_text(text, &settings);
    if (t.status != IMK_OK || strcmp(t.column[0].unit.text, unit) != 0)
        fail_msg("%s: %s %s", column, t.column[0].unit.text, t.message);
}

static void units_are_read_in_brackets_as_at_the_end_of_a_name(void **state)
{
    (void)state;
    check_unit("GyrX [DPS]", "deg/s");
    check_unit("GyrX (mDPS)", "mdps");
    check_unit("gyro_x [Deg/Sec]", "deg/s");
    check_unit("gyro_x (degrees per second)", "deg/s");
    check_unit("accel_x (M/S2)", "m/s^2");
    check_unit("accel_x [milli-g]", "mg");
    check_unit("accel_x [mG]", "mg"); /* no milligauss, which an acceleration is not */
    check_unit("accel_x [G]", "g");
    check_unit("mag_x [mG]", "mG");
    check_unit("mag_x [Gs]", "gauss");
    check_unit("accel_x [mgal]", "mGal");
    check_unit("Time (S)", "s");
    check_unit("time [msec]", "ms");
    check_unit("time [USEC]", "us");
    check_unit("Temp (C)", "degC");
    check_unit("T [degC]", "degC");
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TEMPERATURE);
    check_unit("T_degC", "degC");
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TEMPERATURE);
    check_unit("T (C)", "degC");
    check_unit("T (ms)", "ms");
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TIME);
    check_unit("T (deg)", "deg"); /* no time, and no temperature that is known */
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_OTHER);
    check_unit("G_X [dps]", "dps"); /* no gravity */
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_ANGULAR_RATE);
    check_unit("G_X [m/s^2]", "m/s^2");
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_OTHER);
    check_unit("mag_x [a.u.]", "a.u."); /* as without a unit */
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_OTHER);
    const imk_log_settings settings = imk_log_default();
    read_text("time,gyro_x,T\nmsec,Deg/Sec,C\n0,1,20\n10,2,20\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.column[2].quantity, IMK_QUANTITY_TEMPERATURE);
    assert_string_equal(t.column[0].unit.text, "ms");
    read_text("time [s],gyro_x [rad/s],T [degC]\n0,1,20\n1,2,20\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.column[2].quantity, IMK_QUANTITY_TEMPERATURE);
}

static void check_unknown(const char *column, const char *words)
{
    char text[200];
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    snprintf(text, sizeof text, "%s,gyro_z [rad/s]\n1,2\n", column);
    read_text(text, &settings);
    check_says(IMK_ERROR_UNIT_UNKNOWN, words);
}

/* The letters are near those of dB, rad, deg, milligram, s and mdeg, which these columns do not
 * have, or have in another multiple. */
static void only_units_that_a_column_can_have_are_suggested(void **state)
{
    (void)state;
    static const char *const wrong[] = {"gx (d/s)", "dtheta_x [raw]", "accel_x [millig]",
                                        "time [ks]", "gyro_x [udeg/s]"};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        check_unknown(wrong[k], "is not a known unit; if it is another word for a known unit, ");
        assert_null(strstr(t.message, "did you mean"));
    }
    check_unknown("GyrX [mdpss]",
                  "did you mean mdps? if it is another word for a known unit, state that with "
                  "--map, as in \"gyro_x=GyrX [UNIT],...\" (UNIT: deg/s, rad/s, count)");
    check_unknown("temperature [°F]", "is not a known unit; write the column in degC or K, or "
                                      "leave it out, with - in its place in --columns");
    check_unknown("accel_x [meter/s^2]", "is not a known unit");
    imk_log_settings settings = imk_log_default();
    settings.time_unit = "d";
    read_text("time,gyro_x [rad/s]\n1,2\n", &settings);
    check_says(IMK_ERROR_UNIT_UNKNOWN,
               "\"d\" is not a known unit; expected a unit such as s, ms, us");
}

static void a_unit_that_is_not_known_may_be_stated(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    static const char text[] = "time [s],GyrX [d/s]\n0,180\n1,0\n";
    settings.map = "time=time,gyro_x=GyrX [deg/s]";
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[1][0], 3.14159265358979, 1e-14); /* 180 deg */
    settings.map = NULL;
    settings.columns = "time,gyro_x [deg/s]";
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[1][0], 3.14159265358979, 1e-14);
    settings.columns = "time,gyro_x";
    read_text(text, &settings);
    check_says(IMK_ERROR_UNIT_UNKNOWN, "state that in --columns, as gyro_x [UNIT]");
    /* One that is known is not overruled, and the same in other words is the same. */
    settings.columns = NULL;
    settings.map = "time=time,gyro_x=GyrX [rad/s]";
    read_text("time [s],GyrX [DPS]\n0,180\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "[rad/s] does not agree with the file, which says [DPS]");
    settings.map = "time=time,gyro_x=GyrX [deg/s]";
    read_text("time [s],GyrX [DPS]\n0,180\n", &settings);
    assert_int_equal(t.status, IMK_OK);
}

static void a_line_of_units_agrees_with_the_header(void **state)
{
    (void)state;
    const imk_log_settings settings = imk_log_default();
    read_text("time [s],gyro_x [deg/s]\ns,rad/s\n0,1\n", &settings);
    check_says(IMK_ERROR_CONFLICT,
               "gyro_x: rad/s in the line of units does not agree with [deg/s] in the header");
    read_text("time [s],gyro_x [deg/s],T [degC]\ns,dps,C\n0,1,20\n1,1,20\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, 2);
    assert_int_equal(t.damaged, 0);
}

/* ------------------------------------------------------------------------- axes counted from 1 */

static void check_axes(const char *header, int first, int second, int third)
{
    char text[300];
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    snprintf(text, sizeof text, "%s\n1,2,3\n", header);
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.column[0].axis, first);
    assert_int_equal(t.column[1].axis, second);
    assert_int_equal(t.column[2].axis, third);
}

static void axes_may_be_counted_from_one(void **state)
{
    (void)state;
    check_axes("AngularVelocity_1 [rad/s],AngularVelocity_2 [rad/s],AngularVelocity_3 [rad/s]", 0,
               1, 2);
    assert_string_equal(t.column[0].name, "gyro_x");
    assert_string_equal(t.column[2].name, "gyro_z");
    check_axes("Acceleration_1_g,Acceleration_3_g,Acceleration_2_g", 0, 2, 1); /* unit behind */
    check_axes("Acceleration_3 [g],Acceleration_1 [g],Acceleration_2 [g]", 2, 0, 1);
    /* The names of sets of more than three axes count from 0, and so do others that have a 0. */
    check_axes("gyro_1 [rad/s],gyro_2 [rad/s],gyro_3 [rad/s]", 1, 2, 3);
    check_axes("gyroADC[0] (deg/s),gyroADC[1] (deg/s),gyroADC[2] (deg/s)", 0, 1, 2);
    check_axes("AngularVelocity_1 [rad/s],AngularVelocity_2 [rad/s],AngularVelocity_0 [rad/s]", 1,
               2, 0);
    check_axes("AngularVelocity_1 [rad/s],AngularVelocity_2 [rad/s],other", 1, 2, -1);
}

/* -------------------------------------------------------------------- units against each other */

static void units_must_agree_with_the_end_of_the_name(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    read_text("gyro_x_dps\nrad/s\n1\n", &settings); /* a line of units */
    check_says(IMK_ERROR_CONFLICT,
               "[rad/s] does not agree with the file, which says [deg/s] for gyro_x_dps");
    read_text("gyro_x_dps [rad/s]\n1\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "which says [deg/s] for gyro_x_dps");
    read_text("gyro_x_dps [deg/s]\n180\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 3.14159265358979312, 1e-15); /* 180 deg/s */
    settings.columns = "gyro_x [rad/s]";
    read_text("gyro_x_dps\n180\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "columns");
    check_says(IMK_ERROR_CONFLICT, "which says [deg/s] for gyro_x_dps");
    settings.columns = "gyro_x";
    read_text("gyro_x_dps\n180\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][0], 3.14159265358979312, 1e-15);
    settings.gyro_unit = "rad/s";
    read_text("gyro_x_dps\n180\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "--gyro-unit rad/s does not agree with the file");
    settings = imk_log_default();
    settings.rate = 100;
    settings.map = "gyro_x=gyro_x_dps [rad/s]";
    read_text("gyro_x_dps\n180\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "which says [deg/s] for gyro_x_dps");
}

/* 10 ms apart, and in milliseconds of the year 54 million. */
static void times_of_another_unit_are_refused(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    static const char stamps[] = "timestamp,gyro_x [rad/s]\n1714552800000000000,1\n"
                                 "1714552800010000000,2\n1714552800020000000,3\n";
    settings.time_unit = "ms";
    read_text(stamps, &settings);
    check_says(IMK_ERROR_CONFLICT, "--time-unit: times such as 1714552800000000000 are no ms: they "
                                   "can only be nanoseconds since 1970");
    check_says(IMK_ERROR_CONFLICT, "give --time-unit ns");
    settings.time_unit = "ns";
    read_text(stamps, &settings);
    assert_int_equal(t.status, IMK_OK);
    CHECK_CLOSE(t.data[0][2], 0.02, 0);
    settings.time_unit = NULL;
    read_text("t [s],gyro_x [rad/s]\n1714552800000,1\n1714552800010,2\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "they can only be milliseconds since 1970");
    check_says(IMK_ERROR_CONFLICT, "write the unit ms into the header");
    /* A clock that counts from elsewhere may be anything. */
    read_text("t [s],gyro_x [rad/s]\n5000000000,1\n5000000001,2\n", &settings);
    assert_int_equal(t.status, IMK_OK);
}

/* --------------------------------------------------------------------------- names with brackets
 */

/* As of Blackbox, read and written: the name is another one, and none is there twice. */
static void brackets_in_names_become_signs(void **state)
{
    (void)state;
    char path[300], text[300] = "";
    const char *directory = getenv("TMPDIR");
    const int decimals[4] = {-1, -1, -1, -1};
    const double value = 1, *const data[4] = {&value, &value, &value, &value};
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    snprintf(path, sizeof path, "%s/imukit_%ld_brackets.csv", directory ? directory : "/tmp",
             (long)getpid());
    read_text("axisP[0],axisP_0,gyroUnfilt[1] (deg/s),gyroADC[2] (deg/s)\n1,2,3,4\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    imk_log_sink sink = {.path = path};
    const imk_record_sink s = imk_log_sink_of(&sink);
    CHECK_OK(s.begin(s.context, 4, t.column, decimals, 1, NULL));
    CHECK_OK(s.write(s.context, 1, data, NULL, NULL));
    CHECK_OK(imk_log_sink_end(&sink, IMK_OK, NULL));
    FILE *file = fopen(path, "rb");
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    remove(path);
    static const char head[] = "axisP_0_,axisP_0,gyroUnfilt_1 [deg/s],gyro_z [deg/s]\n";
    assert_memory_equal(text, head, sizeof head - 1);
    read_text(text, &settings);
    assert_int_equal(t.column[2].quantity, IMK_QUANTITY_OTHER); /* as before */
}

/* ---------------------------------------------------------------------------- names of the time */

static void check_time(const char *name, const char *words)
{
    char text[300];
    const imk_log_settings settings = imk_log_default();
    snprintf(text, sizeof text, "%s,gyro_x [rad/s]\n10,1\n20,2\n30,3\n", name);
    read_text(text, &settings);
    if (words) {
        check_says(IMK_ERROR_RATE_MISSING, words);
        return;
    }
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.column[0].quantity, IMK_QUANTITY_TIME);
}

static void times_have_many_names(void **state)
{
    (void)state;
    check_time("Seconds", NULL);
    CHECK_CLOSE(t.data[0][1], 20, 0);
    check_time("Time since start in ms", NULL);
    CHECK_CLOSE(t.data[0][1], 0.02, 0);
    check_time("timestamps (us)", NULL);
    CHECK_CLOSE(t.data[0][1], 20e-6, 1e-20);
    /* Not read, and named. */
    check_time("TimeStartup", "if TimeStartup is the time, name it so with --columns, or with "
                              "--map \"time=TimeStartup,...\"");
    check_time("sensor secs", "if sensor secs is the time");
    check_time("tempo [s]", "if tempo is the time");
    const imk_log_settings settings = imk_log_default();
    read_text("section,gyro_x [rad/s]\n1,1\n1,2\n", &settings); /* does not increase */
    check_says(IMK_ERROR_RATE_MISSING, "the log has no time column");
    assert_null(strstr(t.message, "section"));
    read_text("minutes,seconds,gyro_x [rad/s]\n1,58,1\n1,59,2\n2,0,2\n", &settings); /* a clock */
    check_says(IMK_ERROR_RATE_MISSING, "the log has no time column");
}

/* -------------------------------------------------------------------- texts that are something
 * else */

static void dates_in_other_words_are_named(void **state)
{
    (void)state;
    static const char *const times[] = {
        "01/05/2024 10:00:00.00", "10:00:00.010", "2024-05-01", "01.05.2024", "10:00:00 PM",
        "1-May-2024 10:00:00"};
    imk_log_settings settings = imk_log_default();
    for (size_t k = 0; k < 2 * (sizeof times / sizeof times[0]); k++) {
        char text[200], words[160];
        snprintf(text, sizeof text, "time,gyro_x [rad/s]\n%s,1\n", times[k / 2]);
        snprintf(words, sizeof words,
                 "\"%s\" is a date or time of day that imukit does not read; write it as "
                 "2024-05-01T10:00:00.000 (ISO 8601) or as seconds",
                 times[k / 2]);
        settings.time_unit = k % 2 ? "s" : NULL; /* which does not make it one */
        read_text(text, &settings);
        check_says(IMK_ERROR_SYNTAX, words);
    }
    settings.time_unit = NULL;
    read_text("time [s],gyro_x [rad/s]\n1.5e-3,1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
}

static void headers_of_one_byte_each_are_named(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    /* The degree sign and mu of the code pages of Windows are read, other letters are not. */
    read_text("gyro_x [\xB0/s]\n1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_string_equal(t.column[0].unit.text, "\xC2\xB0/s");
    read_text("accel_x\n\xB5g\n1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    read_text("gyro_x [\xA7/s]\n1\n", &settings);
    check_says(IMK_ERROR_FORMAT,
               "not UTF-8, and a unit is not readable; convert it: iconv -f LATIN1");
    read_text("gyro_x\n\xA7/s\n1\n", &settings);
    check_says(IMK_ERROR_FORMAT, "not UTF-8");
    read_text("gyro_x [\xC2\xB0/s]\n1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    settings.columns = "gyro_x [deg/s]";
    read_text("gyro_x [\xB0/s]\n1\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    settings.columns = NULL; /* a name may be anything */
    read_text("gyro_x [deg/s],gr\xFCn\n1,2\n", &settings);
    assert_int_equal(t.status, IMK_OK);
}

static void headers_come_first(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    static const char below[] = "Device: X1\nTime: today\ntime [s],gyro_x [deg/s]\n0,1\n1,2\n";
    read_text(below, &settings);
    check_says(IMK_ERROR_COLUMN, "the names of the columns are in line 3, below other lines");
    check_says(IMK_ERROR_COLUMN, "delete the lines above it");
    settings.columns = "time [s],gyro_x [deg/s]";
    read_text(below, &settings);
    check_says(IMK_ERROR_COLUMN, "the names of the columns are in line 3");
    settings.columns = NULL;
    read_text("# Device: X1\n# Time: today\ntime [s],gyro_x [deg/s]\n0,1\n1,2\n", &settings);
    assert_int_equal(t.status, IMK_OK);
}

/* ------------------------------------------------------------------------- sensors of a table */

static void sensors_may_share_what_has_no_number(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    static const char two[] =
        "time [s],gyro1_x [rad/s],gyro2_x [rad/s],accel_x [m/s^2]\n0,1,2,3\n1,1,2,3\n";
    read_text(two, &settings);
    check_says(IMK_ERROR_NAME_UNKNOWN, "the log holds 2 sensors; add --topic 1 (or --topic 2)");
    settings.topic = "2";
    read_text(two, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.columns, 3);
    CHECK_CLOSE(t.data[1][0], 2, 0);
    CHECK_CLOSE(t.data[2][0], 3, 0);
    assert_int_equal(t.column[2].quantity, IMK_QUANTITY_SPECIFIC_FORCE);
    settings.topic = NULL; /* of the two gyros, one is the table's own */
    read_text("time [s],gyro_x [rad/s],gyro2_x [rad/s],accel_x [m/s^2]\n0,1,2,3\n", &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.column[2].quantity, IMK_QUANTITY_OTHER);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_in_two_columns_are_joined),
        cmocka_unit_test(a_rest_of_more_than_a_second_is_no_time),
        cmocka_unit_test(seconds_alone_are_no_time_beside_the_rest),
        cmocka_unit_test(an_index_stands_before_a_unit),
        cmocka_unit_test(columns_of_ulog2csv_have_the_units_of_the_message),
        cmocka_unit_test(units_are_read_in_brackets_as_at_the_end_of_a_name),
        cmocka_unit_test(only_units_that_a_column_can_have_are_suggested),
        cmocka_unit_test(a_unit_that_is_not_known_may_be_stated),
        cmocka_unit_test(a_line_of_units_agrees_with_the_header),
        cmocka_unit_test(axes_may_be_counted_from_one),
        cmocka_unit_test(units_must_agree_with_the_end_of_the_name),
        cmocka_unit_test(times_of_another_unit_are_refused),
        cmocka_unit_test(brackets_in_names_become_signs),
        cmocka_unit_test(times_have_many_names),
        cmocka_unit_test(dates_in_other_words_are_named),
        cmocka_unit_test(headers_of_one_byte_each_are_named),
        cmocka_unit_test(headers_come_first),
        cmocka_unit_test(sensors_may_share_what_has_no_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
