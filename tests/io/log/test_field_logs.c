/* SPDX-License-Identifier: Apache-2.0 */
/* Headers and files as programs and people write them: what is read of each, and the options that
 * it takes. The table of docs/logs.md is made of these cases, and is compared with what the reader
 * says. */
#include "check.h"

#include "imukit/io.h"

#include <stdio.h>
#include <string.h>

typedef struct field_log {
    const char *title;   /* in the table; what has a program's name was written after its format */
    const char *text;    /* the whole file */
    const char *says;    /* in the message without the options; NULL: none are needed */
    const char *options; /* that it takes; NULL: none, or none does it */
    const char *read;    /* what then is read; NULL: nothing */
} field_log;

static const field_log logs[] = {
    {"EuRoC, TUM-VI `data.csv`",
     "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
     "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
     "1403636579763555584,-0.099,0.147,0.029,8.17,-0.37,-2.43\n"
     "1403636579768555584,-0.099,0.141,0.027,8.03,-0.37,-2.41\n",
     NULL, NULL, "time [ns], gyro xyz [rad s^-1], accel xyz [m s^-2]"},
    {"`rostopic echo -p` of `sensor_msgs/Imu`",
     "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angular_velocity.x,"
     "field.angular_velocity.y,field.angular_velocity.z,field.linear_acceleration.x,"
     "field.linear_acceleration.y,field.linear_acceleration.z\n"
     "1403636579763555584,7,1403636579763555584,imu,0.1,0.2,0.3,1,2,9.8\n"
     "1403636579768555584,8,1403636579768555584,imu,0.1,0.2,0.3,1,2,9.7\n",
     NULL, NULL, "time [ns], gyro xyz [rad/s], accel xyz [m/s^2]"},
    {"ROS to CSV: `.header.stamp`, `.angular_velocity.x`, `.linear_acceleration.x`, …",
     ".header.stamp,.angular_velocity.x,.angular_velocity.y,.angular_velocity.z,"
     ".linear_acceleration.x,.linear_acceleration.y,.linear_acceleration.z\n"
     "1403636579.763555584,1,2,3,1,2,9.8\n1403636579.773555584,1,2,3,1,2,9.8\n",
     "--time-unit s --gyro-unit UNIT --accel-unit UNIT",
     "--time-unit s --gyro-unit rad/s --accel-unit m/s^2",
     "time [s], gyro xyz [rad/s], accel xyz [m/s^2]"},
    {"phyphox: `Time (s)`, `Gyroscope x (rad/s)`, …, tabs and decimal commas",
     "\"Time (s)\"\t\"Gyroscope x (rad/s)\"\t\"Gyroscope y (rad/s)\"\t\"Gyroscope z (rad/s)\"\n"
     "0,0025\t1,5E-3\t-0,25\t0,5\n0,0050\t2,5E-3\t-0,25\t0,5\n",
     NULL, NULL, "time [s], gyro xyz [rad/s]"},
    {"phyphox: `Time (s)`, `Acceleration x (m/s^2)`, …",
     "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z "
     "(m/s^2)\"\n0.0,0.1,0.2,9.8\n0.1,0.1,0.2,9.8\n",
     NULL, NULL, "time [s], accel xyz [m/s^2]"},
    {"phyphox: `Linear Acceleration x (m/s^2)`, … beside a gyro: gravity is taken out",
     "Time (s),Linear Acceleration x (m/s^2),Gyroscope x (rad/s)\n0,0.1,0.2\n1,0.1,0.2\n", NULL,
     NULL, "time [s], gyro x [rad/s]"},
    {"Sensor Logger `Gyroscope.csv`: `time,seconds_elapsed,z,y,x`",
     "time,seconds_elapsed,z,y,x\n1718030736872695300,0.0706953125,-0.32,0.15,0.67\n"
     "1718030736882695300,0.0806953125,-0.31,0.14,0.66\n",
     "--map", "--map \"time=seconds_elapsed,gyro_x=x [rad/s],gyro_y=y [rad/s],gyro_z=z [rad/s]\"",
     "time [s], gyro xyz [rad/s]"},
    {"SensorLog: `motionRotationRateX(rad/s)`, `accelerometerAccelerationX(G)`, `timestamp(s)`, …",
     "timestamp(s),motionRotationRateX(rad/s),motionRotationRateY(rad/s),motionRotationRateZ(rad/"
     "s),"
     "accelerometerAccelerationX(G),accelerometerAccelerationY(G),accelerometerAccelerationZ(G),"
     "motionUserAccelerationX(G)\n1,1,2,3,0,0,-1,0\n2,1,2,3,0,0,-1,0\n",
     NULL, NULL, "time [s], gyro xyz [rad/s], accel xyz [g]"},
    {"Gyroflow `.gcsv`",
     "GYROFLOW IMU "
     "LOG\nversion,1.3\nid,logger\norientation,YxZ\ntscale,0.001\ngscale,0.00122173047\n"
     "ascale,0.00048828125\nt,gx,gy,gz,ax,ay,az\n0,39,86,183,-1137,-15689,-2986\n"
     "1,56,100,202,-1179,-15694,-2887\n",
     NULL, NULL, "time [s], gyro xyz [rad/s], accel xyz [g]"},
    {"Betaflight Blackbox: `loopIteration,time (us),gyroADC[0] (deg/s),…,accSmooth[0]`",
     "loopIteration,time (us),gyroADC[0] (deg/s),gyroADC[1] (deg/s),gyroADC[2] (deg/s),"
     "accSmooth[0],accSmooth[1],accSmooth[2],gyroUnfilt[0]\n"
     "0,31250,1,2,3,12,-30,2048,1\n1,31750,1,2,3,14,-31,2050,1\n",
     "--accel-unit UNIT", "--accel-unit count", "time [us], gyro xyz [deg/s], accel xyz [count]"},
    {"PX4 `ulog2csv` of `sensor_combined`: `timestamp,gyro_rad[0],…,accelerometer_m_s2[0],…`",
     "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],"
     "accelerometer_m_s2[2]\n1500000,0.1,0.2,0.3,1,2,-9.8\n1505000,0.1,0.2,0.3,1,2,-9.8\n",
     NULL, NULL, "time [us], gyro xyz [rad/s], accel xyz [m/s^2]"},
    {"Xsens MT Manager text: `// ` lines, `PacketCounter`, `Acc_X`, `Gyr_X`, `FreeAcc_X`, …",
     "// Start Time: Unknown\n// Update Rate: 100.0Hz\n"
     "PacketCounter\tAcc_X\tAcc_Y\tAcc_Z\tFreeAcc_X\tGyr_X\tGyr_Y\tGyr_Z\n"
     "03583\t3.03\t5.25\t-7.71\t0.1\t0.005\t-0.032\t0.022\n"
     "03584\t3.03\t5.25\t-7.71\t0.1\t0.005\t-0.032\t0.022\n",
     "--accel-unit UNIT --gyro-unit UNIT --rate RATE",
     "--accel-unit m/s^2 --gyro-unit rad/s --rate 100Hz", "accel xyz [m/s^2], gyro xyz [rad/s]"},
    {"gnss-ins-sim `gyro-0.csv`", "gyro_x (deg/s),gyro_y (deg/s),gyro_z (deg/s)\n1,2,3\n1,2,4\n",
     "--rate RATE", "--rate 100Hz", "gyro xyz [deg/s]"},
    {"KITTI oxts, its frames put together",
     "49 8 112 0.03 0 -2 -1 -1 1 0 0 1.5 0.2 9.7 1.5 0.2 9.7 0.01 0.02 0.03 0.01 0.02 0.03 0 0 4 "
     "11 "
     "6 6 6\n49 8 112 0.03 0 -2 -1 -1 1 0 0 1.4 0.2 9.7 1.4 0.2 9.7 0.01 0.02 0.03 0.01 0.02 0.03 "
     "0 "
     "0 4 11 6 6 6\n",
     "no header", "--format kitti --rate 10Hz", "accel xyz [m/s^2], gyro xyz [rad/s]"},
    {"PSINS `imu` as text",
     "1e-6 2e-6 3e-6 0.001 0.002 0.098 0.01\n1e-6 2e-6 4e-6 0.001 0.002 0.098 0.02\n", "no header",
     "--format psins", "dtheta xyz [rad], dvel xyz [m/s], time [s]"},
    {"`time_ms,ax_mg,ay_mg,az_mg,gx_mdps,gy_mdps,gz_mdps`",
     "time_ms,ax_mg,ay_mg,az_mg,gx_mdps,gy_mdps,gz_mdps\n0,1,2,1000,3,4,5\n10,1,2,1001,3,4,5\n",
     NULL, NULL, "time [ms], accel xyz [mg], gyro xyz [mdps]"},
    {"`ts_us,gyr_x_dps,gyr_y_dps,gyr_z_dps,acc_x_ms2,…,temp_c`",
     "ts_us,gyr_x_dps,gyr_y_dps,gyr_z_dps,acc_x_ms2,acc_y_ms2,acc_z_ms2,temp_c\n"
     "0,1,2,3,4,5,6,25\n1000,1,2,3,4,5,7,25\n",
     NULL, NULL, "time [us], gyro xyz [deg/s], accel xyz [m/s^2], temperature [degC]"},
    {"`Timestamp,GyroX,GyroY,GyroZ,AccX,AccY,AccZ` and times as dates",
     "Timestamp,GyroX,GyroY,GyroZ,AccX,AccY,AccZ\n2024-05-01T12:00:00.000Z,1.5,2,3,4,5,6\n"
     "2024-05-01T12:00:00.010Z,1.5,2,3,4,5,7\n",
     "--gyro-unit UNIT --accel-unit UNIT", "--gyro-unit deg/s --accel-unit g",
     "time [s], gyro xyz [deg/s], accel xyz [g]"},
    {"`Time (s),Gyro X (deg/s),…,Accel X (m/s²),…,Temperature (°C)`",
     "Time (s),Gyro X (deg/s),Gyro Y (deg/s),Gyro Z (deg/s),Accel X (m/s²),Accel Y (m/s²),"
     "Accel Z (m/s²),Temperature (°C)\n0,1,2,3,4,5,6,25\n1,1,2,3,4,5,7,25\n",
     NULL, NULL, "time [s], gyro xyz [deg/s], accel xyz [m/s²], temperature [°C]"},
    {"`Gyro X (°/s);Gyro Y (°/s);…`, semicolons and decimal commas",
     "Time (s);Gyro X (°/s);Gyro Y (°/s);Gyro Z (°/s)\n0,00;1,5;2,0;-0,5\n0,01;1,4;2,0;-0,5\n",
     NULL, NULL, "time [s], gyro xyz [°/s]"},
    {"`time,gx,gy,gz,ax,ay,az` above a line of units `s,deg/s,…,g`",
     "time,gx,gy,gz,ax,ay,az\ns,deg/s,deg/s,deg/s,g,g,g\n0,1,2,3,0,0,1\n1,1,2,3,0,0,1\n", NULL,
     NULL, "time [s], gyro xyz [deg/s], accel xyz [g]"},
    {"`# t wx wy wz ax ay az` above the rows",
     "# t wx wy wz ax ay az\n0.00 1 2 3 4 5 6.5\n0.01 1 2 3 4 5 6.5\n",
     "--time-unit UNIT --gyro-unit UNIT --accel-unit UNIT",
     "--time-unit s --gyro-unit rad/s --accel-unit m/s^2",
     "time [s], gyro xyz [rad/s], accel xyz [m/s^2]"},
    {"`epoch,gyroX,gyroY,gyroZ` with milliseconds since 1970",
     "epoch,gyroX [dps],gyroY [dps],gyroZ [dps]\n1714564800000,1,2,3\n1714564800010,1,2,4\n",
     "--time-unit ms (times such as 1714564800000 look like milliseconds since 1970)",
     "--time-unit ms", "time [ms], gyro xyz [dps]"},
    {"`time [s],imu0_gyro_x [deg/s],…,imu1_gyro_x [deg/s],…`",
     "time [s],imu0_gyro_x [deg/s],imu0_acc_x [g],imu1_gyro_x [deg/s],imu1_acc_x [g]\n0,1,2,3,4\n"
     "1,1,2,3,5\n",
     "--topic imu0 (or --topic imu1)", "--topic imu1", "time [s], gyro x [deg/s], accel x [g]"},
    {"`xacc,yacc,zacc,xgyro,ygyro,zgyro` of MAVLink",
     "time_ms,xacc,yacc,zacc,xgyro,ygyro,zgyro\n0,1,2,1000,3,4,5\n10,1,2,1001,3,4,5\n",
     "--accel-unit UNIT --gyro-unit UNIT", "--accel-unit mg --gyro-unit mrad/s",
     "time [ms], accel xyz [mg], gyro xyz [mrad/s]"},
    {"`time_s,angular_rate_x_deg_s,…,specific_force_x_m_s2,…`",
     "time_s,angular_rate_x_deg_s,angular_rate_y_deg_s,angular_rate_z_deg_s,specific_force_x_m_s2,"
     "specific_force_y_m_s2,specific_force_z_m_s2\n0,1,2,3,4,5,6\n1,1,2,3,4,5,7\n",
     NULL, NULL, "time [s], gyro xyz [deg/s], accel xyz [m/s^2]"},
    {"names in another language: `tempo [s],vel_ang_x [rad/s],…`",
     "tempo [s],vel_ang_x [rad/s],vel_ang_y [rad/s],vel_ang_z [rad/s]\n0,1,2,3\n1,1,2,3\n", "--map",
     "--map \"time=tempo,gyro_x=vel_ang_x,gyro_y=vel_ang_y,gyro_z=vel_ang_z\"",
     "time [s], gyro xyz [rad/s]"},
    {"`time,x,y,z`", "time,x,y,z\n0,1,2,3\n1,1,2,3\n", "the names x, y, z do not say",
     "--map \"time=time [s],accel_x=x [g],accel_y=y [g],accel_z=z [g]\"",
     "time [s], accel xyz [g]"},
    {"no header, seven columns", "0.00,1,2,3,4,5,6.5\n0.01,1,2,3,4,5,6.5\n",
     "add --columns with the names in their order",
     "--columns \"time [s],gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\" --gyro-unit deg/s "
     "--accel-unit g",
     "time [s], gyro xyz [deg/s], accel xyz [g]"},
    {"Excel: `sep=;` and quoted cells",
     "sep=;\n\"time [s]\";\"gyro_x [deg/s]\"\n\"0,0\";\"1,5\"\n\"0,1\";\"1,6\"\n", NULL, NULL,
     "time [s], gyro x [deg/s]"},
    {"decimal commas between commas", "time [s],gyro_x [deg/s]\n0,0,1,5\n0,1,1,6\n",
     "as of numbers with decimal commas between commas", NULL, NULL},
};

enum { LOGS = sizeof logs / sizeof logs[0] };

/* ---- the options of a case as settings ---- */

/* The words of a line, with quotes taken off. @return how many */
static int divide(char *line, char **word, int most)
{
    int count = 0;
    while (*line && count < most) {
        const char end = *line == '"' ? '"' : ' ';
        word[count++] = line + (end == '"');
        line = word[count - 1] + strcspn(word[count - 1], end == '"' ? "\"" : " ");
        if (*line)
            *line++ = '\0';
        while (*line == ' ')
            line++;
    }
    return count;
}

static imk_log_settings settings_of(const char *options, char *line, size_t size)
{
    imk_log_settings s = imk_log_default();
    char *word[16];
    snprintf(line, size, "%s", options ? options : "");
    const int count = divide(line, word, 16);
    for (int i = 0; i + 1 < count; i += 2) {
        const char *name = word[i], *value = word[i + 1];
        if (strcmp(name, "--rate") == 0)
            s.rate = strtod(value, NULL);
        else
            *(strcmp(name, "--map") == 0          ? &s.map
              : strcmp(name, "--columns") == 0    ? &s.columns
              : strcmp(name, "--topic") == 0      ? &s.topic
              : strcmp(name, "--format") == 0     ? &s.format
              : strcmp(name, "--time-unit") == 0  ? &s.time_unit
              : strcmp(name, "--gyro-unit") == 0  ? &s.gyro_unit
              : strcmp(name, "--accel-unit") == 0 ? &s.accel_unit
                                                  : &s.axes) = value;
    }
    assert_null(s.axes);
    return s;
}

/* ---- what is read, in words ---- */

static void add(char *text, size_t size, const char *more)
{
    snprintf(text + strlen(text), size - strlen(text), "%s", more);
}

/* "time [s], gyro xyz [deg/s]": neighbouring axes of a sensor together. */
static void describe(const imk_log_reader *reader, char *text, size_t size)
{
    char sensor[48] = "", unit[64] = "";
    text[0] = '\0';
    for (size_t i = 0; i < imk_log_column_count(reader); i++) {
        const imk_log_column *c = imk_log_column_get(reader, i);
        char name[48];
        if (c->quantity == IMK_QUANTITY_OTHER)
            continue;
        snprintf(name, sizeof name, "%s", c->name);
        char *axis = c->axis >= 0 ? strrchr(name, '_') : NULL;
        if (axis)
            *axis++ = '\0';
        const bool same = axis && strcmp(name, sensor) == 0 && strcmp(c->unit.text, unit) == 0;
        if (!same) {
            if (text[0]) {
                add(text, size, " [");
                add(text, size, unit);
                add(text, size, "], ");
            }
            add(text, size, name);
            add(text, size, axis ? " " : "");
        }
        add(text, size, axis ? axis : "");
        snprintf(sensor, sizeof sensor, "%s", name);
        snprintf(unit, sizeof unit, "%s", c->unit.text);
    }
    add(text, size, " [");
    add(text, size, unit);
    add(text, size, "]");
}

/* Letters in the order of axes, as z, y, x are named. */
static void sort_axes(char *text)
{
    for (char *at = text; (at = strstr(at, "zyx")) != NULL;)
        memcpy(at, "xyz", 3);
}

static size_t read_rows(imk_log_reader *reader)
{
    static double values[IMK_LOG_COLUMNS_MAX][16];
    double *columns[IMK_LOG_COLUMNS_MAX];
    size_t rows = 0;
    for (size_t i = 0; i < IMK_LOG_COLUMNS_MAX; i++)
        columns[i] = values[i];
    CHECK_OK(imk_log_read(reader, 16, columns, &rows, NULL));
    const imk_log_findings f = imk_log_findings_get(reader);
    assert_int_equal(f.damaged + f.not_finite + f.cut_short, 0);
    return rows;
}

static void test_what_is_read(void **state)
{
    (void)state;
    for (size_t k = 0; k < LOGS; k++) {
        const field_log *l = &logs[k];
        char line[400], text[300], message[1200] = "";
        imk_log_reader *reader;
        imk_error error;
        imk_status status = imk_log_open_memory(l->text, strlen(l->text), NULL, &reader, &error);
        if (status != IMK_OK)
            imk_error_text(&error, NULL, message, sizeof message);
        if ((status == IMK_OK) != !l->says || (l->says && !strstr(message, l->says)))
            fail_msg("%s: %s", l->title, message);
        if (status != IMK_OK && l->options) {
            const imk_log_settings settings = settings_of(l->options, line, sizeof line);
            status = imk_log_open_memory(l->text, strlen(l->text), &settings, &reader, &error);
            if (status != IMK_OK) {
                imk_error_text(&error, NULL, message, sizeof message);
                fail_msg("%s: %s", l->title, message);
            }
        }
        if (status != IMK_OK) {
            assert_null(l->read);
            continue;
        }
        describe(reader, text, sizeof text);
        sort_axes(text);
        assert_string_equal(text, l->read);
        assert_int_equal(read_rows(reader), 2);
        imk_log_close(reader);
    }
}

/* ---- the page ---- */

static void test_the_page(void **state)
{
    (void)state;
    FILE *file = fopen(SOURCE_DIRECTORY "/docs/logs.md", "rb");
    static char page[65536];
    assert_non_null(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    fclose(file);
    bool whole = true;
    char row[900];
    for (size_t k = 0; k < LOGS; k++) {
        const field_log *l = &logs[k];
        snprintf(row, sizeof row, "| %s | %s | %s%s%s |\n", l->title,
                 l->read ? l->read : "not read", l->options ? "`" : "",
                 l->options ? l->options : "", l->options ? "`" : "");
        whole = whole && strstr(page, row);
        if (!strstr(page, row))
            print_error("%s", row);
    }
    if (!whole)
        fail_msg("the rows above are not in docs/logs.md");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_is_read),
                                       cmocka_unit_test(test_the_page)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
