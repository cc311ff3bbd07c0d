/* SPDX-License-Identifier: Apache-2.0 */
/* Texts as other programs write them: encodings, dates and long stamps, rows that cannot be read,
 * headers between the rows, last lines without an end; names, --map, units and rates that do not
 * agree with the file; and logs written as in the EuRoC data set. */
#include "check.h"

#include "io/log/log_stamps_internal.h"
#include "io/log/names/log_names_internal.h"

#include "imukit/io.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { ROOM = 4000 };

typedef struct table {
    imk_status status;
    size_t rows;
    double data[8][ROOM];
    imk_log_findings findings;
    char message[1400];
} table;

static table t;

/* Read a text, in pieces of some rows, and keep what is said about it. */
static void read_bytes(const char *text, size_t size, const imk_log_settings *settings)
{
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    t.rows = 0;
    t.message[0] = '\0';
    t.status = imk_log_open_memory(text, size, settings, &reader, &error);
    size_t got = 1;
    while (t.status == IMK_OK && got > 0) {
        double *columns[IMK_LOG_COLUMNS_MAX] = {NULL};
        got = 0;
        for (size_t j = 0; j < 8; j++)
            columns[j] = t.data[j] + t.rows;
        t.status =
            imk_log_read(reader, t.rows + 300 < ROOM ? 300 : ROOM - t.rows, columns, &got, &error);
        t.rows += got;
    }
    if (reader)
        t.findings = imk_log_findings_get(reader);
    if (t.status != IMK_OK)
        imk_error_text(&error, "log.csv", t.message, sizeof t.message);
    imk_log_close(reader);
}

static void read_text(const char *text, const imk_log_settings *settings)
{
    read_bytes(text, strlen(text), settings);
}

static void check_says(imk_status status, const char *words)
{
    if (t.status != status || !strstr(t.message, words))
        fail_msg("%s: \"%s\" does not say \"%s\"", imk_status_name(t.status), t.message, words);
}

/* ------------------------------------------------------------------------------------ encodings */

static const char plain[] = "time [s],gyro_x [deg/s],µ\n0,1,ab\n0.5,2,ä€𝄞\n1,3,c\n";

/* UTF-16 of a text of characters up to three bytes and one of four. */
static size_t to_utf16(const char *text, bool big, bool mark, char *out)
{
    size_t size = 0;
    unsigned unit[2];
    const unsigned char *c = (const unsigned char *)text;
    for (bool first = mark; *c || first; first = false) {
        unsigned code = 0xFEFF;
        if (!first) {
            const int more = *c < 0x80 ? 0 : *c < 0xE0 ? 1 : *c < 0xF0 ? 2 : 3;
            code = more == 0 ? *c : *c & (0x3FU >> more);
            c++;
            for (int k = 0; k < more; k++)
                code = code << 6 | (*c++ & 0x3FU);
        }
        const int units = code < 0x10000 ? 1 : 2;
        unit[0] = units == 1 ? code : 0xD800 + ((code - 0x10000) >> 10);
        unit[1] = 0xDC00 + ((code - 0x10000) & 0x3FF);
        for (int k = 0; k < units; k++) {
            out[size++] = (char)(big ? unit[k] >> 8 : unit[k] & 0xFF);
            out[size++] = (char)(big ? unit[k] & 0xFF : unit[k] >> 8);
        }
    }
    return size;
}

static void check_plain(void)
{
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, 3);
    CHECK_CLOSE(t.data[0][1], 0.5, 0);
    CHECK_CLOSE(t.data[2][2], 2, 0); /* the third label */
}

static void encodings_are_decoded(void **state)
{
    (void)state;
    static char wide[1000];
    imk_log_settings settings = imk_log_default();
    read_text(plain, &settings);
    check_plain();
    for (int big = 0; big < 2; big++)
        for (int mark = 0; mark < 2; mark++) {
            const size_t size = to_utf16(plain, big, mark, wide);
            read_bytes(wide, size, &settings);
            if (mark == 1)
                check_plain();
            else /* without a mark, only what is ASCII at the beginning is unmistakable */
                assert_int_equal(t.status, IMK_ERROR_FORMAT);
        }
    for (int big = 0; big < 2; big++) {
        const size_t size = to_utf16("time [s],gyro_x [deg/s]\n0,1\n1,2\n", big, false, wide);
        read_bytes(wide, size, &settings);
        assert_int_equal(t.rows, 2);
    }
    /* Halves of pairs become the character for what is none; an odd byte at the end is dropped. */
    size_t size = to_utf16("time [s],gyro_x [deg/s],n\n0,1,a\n1,2,", false, true, wide);
    memcpy(wide + size, "\x00\xD8\x0A\x00\x00", 5);
    read_bytes(wide, size + 5, &settings);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, 2);
    read_text("time [s],gyro_x [deg/s]\r0,1\r1,2\r", &settings);
    assert_int_equal(t.rows, 2);
    read_text("time [s],gyro_x [deg/s]\r", &settings);
    check_says(IMK_ERROR_EMPTY, "no rows");
}

/* A text that is decoded in pieces, from a file and packed, and cannot be entered in the middle. */
static void long_texts_are_decoded_in_pieces(void **state)
{
    (void)state;
    enum { ROWS = 60000 };
    char *text = malloc(ROWS * 20 + 100), *wide = malloc(2 * (ROWS * 20 + 100)), path[300];
    const char *directory = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/imukit_%ld_wide.csv", directory ? directory : "/tmp",
             (long)getpid());
    size_t used = (size_t)sprintf(text, "time [s],gyro_x [deg/s]\n");
    for (int i = 0; i < ROWS; i++)
        used += (size_t)sprintf(text + used, "%d,%d\n", i, i % 7);
    const size_t size = to_utf16(text, false, true, wide);
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(wide, 1, size, file), size);
    fclose(file);
    imk_log log;
    CHECK_OK(imk_log_load(path, NULL, NULL, &log, NULL));
    assert_int_equal(log.rows, ROWS);
    CHECK_CLOSE(log.data[0][ROWS - 1], ROWS - 1, 0);
    imk_log_free(&log);
    imk_log_reader *reader;
    CHECK_OK(imk_log_open(path, NULL, &reader, NULL));
    CHECK_STATUS(imk_log_seek(reader, 0.5, NULL), IMK_ERROR_UNSUPPORTED);
    imk_log_close(reader);
    remove(path);
    free(wide);
    free(text);
}

/* ---------------------------------------------------------------------------------------- times */

static void long_stamps_keep_their_digits(void **state)
{
    (void)state;
    /* Differences in ns; a double at 1.4e18 has steps of 256. */
    read_text("t [ns],gyro_x [deg/s]\n1403636579763555584,1\n1403636579763555585,1\n"
              "1403636579768555591, 1\n",
              NULL);
    CHECK_RELATIVE(t.data[0][1], 1e-9, 1e-15);
    CHECK_RELATIVE(t.data[0][2], 5000007e-9, 1e-15);
    CHECK_RELATIVE(t.findings.time_origin, 1403636579.763555584, 1e-15);
    read_text("gyro_x [deg/s],t [s]\n1,1403636579.763555584\n1,1403636579.763555585\r\n"
              "1,1403636579.768555591\n",
              NULL);
    CHECK_RELATIVE(t.data[1][1], 1e-9, 1e-15);
    CHECK_RELATIVE(t.data[1][2], 5000007e-9, 1e-15);
    read_text("t [us],gyro_x [deg/s]\n1403636579763555,1\n1.40363657976455e15,1\nnan,2\n", NULL);
    CHECK_CLOSE(t.data[0][1], 1e-3 - 5e-6, 1e-7);
    assert_true(isnan(t.data[0][2]));
    assert_int_equal(t.findings.not_finite, 1);
    /* Not from an epoch: as they stand. */
    read_text("t [ns],gyro_x [deg/s]\n1000000007,1\n", NULL);
    CHECK_RELATIVE(t.data[0][0], 1.000000007, 1e-15);
}

static void dates_are_times(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int64_t ticks; /* [ns] since 1970, by `date -u -d TEXT +%s` */
    } dates[] = {{"1970-01-01T00:00:00Z", 0},
                 {"2024-05-01T12:00:00.123456Z", INT64_C(1714564800123456000)},
                 {"2024-05-01 12:00:00.123456789", INT64_C(1714564800123456789)},
                 {"2024-02-29T23:59:59,5+01:00", INT64_C(1709247599500000000)},
                 {"2024/02/29 23:59:59 -0130", INT64_C(1709256599) * 1000000000},
                 {"1969-12-31T23:59:59Z", INT64_C(-1000000000)},
                 {"2000-03-01T00:00 UTC", INT64_C(951868800) * 1000000000}};
    static const char *const none[] = {"2024-05-01",           "2023-02-29T00:00:00Z",
                                       "2024-13-01T00:00:00Z", "2024-05-01T24:00:00Z",
                                       "2024-05-01T12:00:60Z", "2024-05-01T12:00:00.Z",
                                       "2024-05-01T12:00:00X", "12:00:00",
                                       "2024-05-01T12:00:0",   "9999-01-01T00:00:00Z"};
    int64_t ticks;
    for (size_t k = 0; k < sizeof dates / sizeof dates[0]; k++) {
        const char *end = dates[k].text + strlen(dates[k].text);
        if (!imki_log_date_read(dates[k].text, end, &ticks) || ticks != dates[k].ticks)
            fail_msg("%s: %lld", dates[k].text, (long long)ticks);
    }
    for (size_t k = 0; k < sizeof none / sizeof none[0]; k++)
        if (imki_log_date_read(none[k], none[k] + strlen(none[k]), &ticks))
            fail_msg("%s is taken for a date", none[k]);
    const char text[] = "timestamp,gyro_x [deg/s]\n2024-05-01T12:00:00.000000001Z,1\n"
                        "2024-05-01T14:00:00.000000003+02:00,2\n,3\n2024-05-01T12:00:01Z,4\n";
    read_text(text, NULL);
    assert_int_equal(t.rows, 4);
    CHECK_CLOSE(t.data[0][0], 0, 0);
    CHECK_RELATIVE(t.data[0][1], 2e-9, 1e-15);
    assert_true(isnan(t.data[0][2]));
    CHECK_RELATIVE(t.data[0][3], 0.999999999, 1e-15);
    imk_log_settings settings = imk_log_default();
    settings.time_unit = "ms";
    read_text(text, &settings);
    check_says(IMK_ERROR_CONFLICT, "--time-unit ms does not agree with the file, whose times are "
                                   "dates");
}

/* A unit of the times is named only where no other one fits. */
static void epochs_are_named_where_they_are_plain(void **state)
{
    (void)state;
    static const struct {
        const char *first, *second, *unit; /* NULL: several fit */
    } cases[] = {{"1403636579763555584", "1403636579768555584", "ns"},
                 {"1403636579763555", "1403636579768555", "us"},
                 {"1403636579763", "1403636579773", "ms"},
                 {"1403636579.763", "1403636579.773", "s"},
                 {"1403636579", "1403636580", NULL},       /* ms since boot, too */
                 {"1403636579000", "1403636579100", NULL}, /* us since boot, too */
                 {"1403636579", "1403646579", NULL},       /* us since boot */
                 {"12345", "12355", NULL},
                 {"0.00", "0.01", NULL}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[200], words[60];
        snprintf(text, sizeof text, "time,gyro_x [deg/s]\n%s,1\n%s,2\n", cases[k].first,
                 cases[k].second);
        read_text(text, NULL);
        snprintf(words, sizeof words, "add --time-unit %s (",
                 cases[k].unit ? cases[k].unit : "UNIT");
        check_says(IMK_ERROR_UNIT_MISSING, words);
    }
}

/* ---------------------------------------------------------------------------------------- rows */

/* A log of rows of which every n-th is replaced. */
static void make_rows(char *text, size_t rows, size_t every, const char *bad)
{
    size_t used = (size_t)sprintf(text, "time [s],gyro_x [deg/s]\n");
    for (size_t i = 0; i < rows; i++)
        used += every > 0 && i % every == every - 1 ? (size_t)sprintf(text + used, "%s\n", bad)
                                                    : (size_t)sprintf(text + used, "%zu,1.25\n", i);
}

static void few_bad_rows_are_left_out(void **state)
{
    (void)state;
    static char text[ROOM * 12];
    static const char *const bad[] = {"1,2,3", "1", "1,abc", "12,1..5", "#REF!x,", "x"};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        if (bad[k][0] == '#')
            continue;
        make_rows(text, 3000, 150, bad[k]);
        read_text(text, NULL);
        assert_int_equal(t.status, IMK_OK);
        assert_int_equal(t.rows, 2980);
        assert_int_equal(t.findings.damaged, 20);
        assert_int_equal(t.findings.first_damaged, 149);
        assert_int_equal(t.findings.damaged_line, 151);
        assert_int_equal(t.findings.rows, 2980);
        /* The fifth of every 50th is in row 250: more than 1 % of 250. The rows before it come. */
        make_rows(text, 3000, 50, bad[k]);
        read_text(text, NULL);
        check_says(bad[k][1] == ',' && bad[k][2] == 'a' ? IMK_ERROR_SYNTAX : t.status,
                   "4 of the first 200 rows cannot be read");
        check_says(t.status, "log.csv:51:");
        assert_true(t.rows > 100 && t.rows < 200);
    }
    /* Three at the beginning may be the rest of what a logger wrote before. */
    read_text("time [s],gyro_x [deg/s]\nx\ny\n7\n0,1\n1,2\n", NULL);
    assert_int_equal(t.rows, 2);
    assert_int_equal(t.findings.damaged, 3);
    assert_int_equal(t.findings.first_damaged, 0);
}

static void words_for_no_value_are_missing_values(void **state)
{
    (void)state;
    read_text("time [s],gyro_x [deg/s]\n0,N/A\n1,null\n2,-\n3,NaN\n4,\n5,None\n6,1\n", NULL);
    assert_int_equal(t.rows, 7);
    assert_int_equal(t.findings.not_finite, 6);
    assert_int_equal(t.findings.damaged, 0);
    for (int i = 0; i < 6; i++)
        assert_true(isnan(t.data[1][i]));
    read_text("time [s],gyro_x [deg/s]\n0,1,\n1,2,\n", NULL); /* a separator that ends the row */
    assert_int_equal(t.rows, 2);
}

static void headers_between_rows_are_told(void **state)
{
    (void)state;
    read_text("time [s],gyro_x [deg/s]\n0,1\n1,1\ntime [s],gyro_x [deg/s]\n2,1\n", NULL);
    assert_int_equal(t.rows, 3);
    assert_int_equal(t.findings.headers, 1);
    assert_int_equal(t.findings.first_header, 2);
    assert_int_equal(t.findings.damaged, 0);
    read_text("#t [s],gyro_x [deg/s]\n0,1\n# a note\n#t [s],gyro_x [deg/s]\n2,1\n", NULL);
    assert_int_equal(t.rows, 2);
    assert_int_equal(t.findings.headers, 1);
    read_text("time,gx\ns,deg/s\n0,1\ntime,gx\ns,deg/s\n2,1\n", NULL);
    assert_int_equal(t.rows, 2);
    assert_int_equal(t.findings.headers, 1);
    assert_int_equal(t.findings.damaged, 0);
    /* Another header is none of this log. */
    read_text("time [s],gyro_x [deg/s]\n0,1\n1,1\ntime [s],gyro_y [deg/s]\n2,1\n", NULL);
    assert_int_equal(t.findings.headers, 0);
    assert_int_equal(t.findings.damaged, 1);
}

/* A last line without an end is kept only where a cut would be seen. */
static void last_lines_may_be_cut(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t rows;
    } cases[] = {{"t [s],gyro_x [deg/s]\n0,1.25\n1,1.35\n2,1.45", 3},
                 {"t [s],gyro_x [deg/s]\n0,1.25\n1,1.35\n2,1.4", 2},
                 {"t [s],gyro_x [deg/s]\n0,1.25\n1,1.35\n2,", 2},
                 {"t [s],gyro_x [deg/s]\n0,1.25\n1,1.35\n2", 2},
                 {"t [s],gyro_x [deg/s]\n0,1.25\n1,1.3\n2,1.45", 2},
                 {"t [s],gyro_x [deg/s]\n0,125\n1,135\n2,145", 2},
                 {"t [s],gyro_x [deg/s]\n0,1.25\n1,1.35\n2,1.45\n", 3},
                 {"t [s],gyro_x [deg/s]\n0,\"1\"\n1,\"22\"\n2,\"3\"", 3}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const size_t length = strlen(cases[k].text);
        const bool ended = cases[k].text[length - 1] == '\n';
        read_text(cases[k].text, NULL);
        assert_int_equal(t.status, IMK_OK);
        assert_int_equal(t.rows, cases[k].rows);
        assert_int_equal(t.findings.cut_short, !ended && cases[k].rows < 3);
    }
    imk_log_settings settings = imk_log_default();
    settings.any_columns = true; /* a table, which people write */
    settings.rate = 1;
    read_text("a,b\n1,2\n3,4", &settings);
    assert_int_equal(t.rows, 2);
}

static void decimal_commas_are_read(void **state)
{
    (void)state;
    char text[1000];
    size_t used = (size_t)sprintf(text, "t [s];gyro_x [deg/s];n\n0,5;-1,25e-1;1\n");
    for (int i = 1; i < 30; i++)
        used += (size_t)sprintf(text + used, "%d;2,5;2\n", i);
    sprintf(text + used, "31,5;3.5;3\n"); /* a point among commas is no decimal point */
    read_text(text, NULL);
    assert_int_equal(t.rows, 30);
    assert_int_equal(t.findings.damaged, 1);
    CHECK_CLOSE(t.data[0][0], 0.5, 0);
    CHECK_RELATIVE(t.data[1][0], -0.125 * 0.017453292519943295, 1e-15);
    read_text("t [s],gyro_x [deg/s]\n0,5,1,25\n1,5,1,25\n", NULL);
    check_says(IMK_ERROR_COLUMN, "decimal point, or semicolons or tabs");
}

/* --------------------------------------------------------------------------------- names, --map */

static void other_names_are_not_read(void **state)
{
    (void)state;
    static const char *const names[] = {"x",
                                        "y",
                                        "-gyro_x",
                                        "+acc_x",
                                        "FreeAcc_X",
                                        "gravity_x",
                                        "grav_x",
                                        "g_x",
                                        "userAcceleration.x",
                                        "gyro_x_std",
                                        "gyro_bias_x",
                                        "acc_x_filtered",
                                        "gyro_x_raw",
                                        "PacketCounter",
                                        "gyro_temp_x",
                                        "max",
                                        "may",
                                        "my_x_note",
                                        "quat_x",
                                        "vel_x",
                                        "cpu_temp",
                                        "max_acc_x",
                                        "seconds_of_day",
                                        "ms",
                                        "rate",
                                        "w",
                                        "a",
                                        "gyro",
                                        "angular_acceleration_x",
                                        "lin_acc_x",
                                        "setpoint_gyro_x",
                                        "gyroUnfilt[0]",
                                        "true_gyro_x",
                                        "gyro_x_deg"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
        if (imki_log_name_of(names[k]).kind)
            fail_msg("%s is read as %s", names[k], imki_log_name_of(names[k]).kind->name);
    assert_non_null(imki_log_name_of("FreeAcc_X").reason);
}

static void names_are_read_with_their_groups(void **state)
{
    (void)state;
    static const struct {
        const char *name, *kind, *group, *unit;
        int axis;
    } names[] = {{"gyro_x", "gyro_", "", NULL, 0},
                 {"Gyro Y", "gyro_", "", NULL, 1},
                 {"w_RS_S_z", "gyro_", "", NULL, 2},
                 {"a_RS_S_x", "accel_", "", NULL, 0},
                 {"imu0.AngularVelocity.y", "gyro_", "imu0", NULL, 1},
                 {"IMU1GyroX", "gyro_", "imu1", NULL, 0},
                 {"gyro2_x", "gyro_", "2", NULL, 0},
                 {"left_foot_acc_z_mg", "accel_", "left_foot", "mg", 2},
                 {"gyroADC[2]", "gyro_", "", NULL, 2},
                 {"magX", "mag_", "", NULL, 0},
                 {"gyro_7", "gyro_", "", NULL, 7},
                 {"timestamp_ns", "time", "", "ns", -1},
                 {"seconds_elapsed", "time", "", "s", -1},
                 {"temp_c", "temperature", "", "degC", -1}};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        const imki_log_name n = imki_log_name_of(names[k].name);
        if (!n.kind || strcmp(n.kind->name, names[k].kind) != 0 || n.axis != names[k].axis ||
            strcmp(n.group, names[k].group) != 0 ||
            strcmp(n.unit ? n.unit : "", names[k].unit ? names[k].unit : "") != 0)
            fail_msg("%s: %s, axis %d, group %s, unit %s", names[k].name,
                     n.kind ? n.kind->name : "none", n.axis, n.group, n.unit ? n.unit : "none");
    }
}

static void maps_name_columns(void **state)
{
    (void)state;
    static const struct {
        const char *map;
        imk_status status;
        const char *words;
    } cases[] = {
        {"gyro_x=q [deg/s],time=z", IMK_OK, ""},
        {"gyro_x = q [deg/s] , time = z [s]", IMK_OK, ""},
        {"gyro_x=Q,time=z", IMK_ERROR_UNIT_MISSING, "\"gyro_x\" has no unit"},
        {"gyro_x=v,time=z", IMK_ERROR_COLUMN, "\"v\" is no column of the log; the log has"},
        {"gyro_x,time=z", IMK_ERROR_COLUMN, "\"gyro_x\" has no ="},
        {"gyro_x=,time=z", IMK_ERROR_COLUMN, "lacks a name"},
        {"gyro_x=q [deg/s],gyro_y=q [deg/s],time=z", IMK_ERROR_COLUMN, "is mapped twice"},
        {"gyro_x=q [deg/s],gyro_x=r [deg/s],time=z", IMK_ERROR_COLUMN, "twice"},
        {"gyro_x=q [deg/s],time=z [ms]", IMK_ERROR_CONFLICT,
         "[ms] does not agree with the file, which says [s] for z"}};
    imk_log_settings settings = imk_log_default();
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        settings.map = cases[k].map;
        read_text("q,r,z [s]\n90,2,0\n90,2,1\n", &settings);
        if (cases[k].status != IMK_OK) {
            check_says(cases[k].status, cases[k].words);
            continue;
        }
        assert_int_equal(t.rows, 2);
        CHECK_RELATIVE(t.data[0][0], 1.5707963267948966, 1e-15);
        CHECK_CLOSE(t.data[1][1], 1, 0);
    }
}

static void sensors_of_a_table_are_chosen(void **state)
{
    (void)state;
    static const char text[] = "time [s],a_gyro_x [rad/s],a_acc_x [g],b_gyro_x [rad/s],n\n"
                               "0,1,2,3,4\n1,1,2,3,4\n";
    imk_log_settings settings = imk_log_default();
    imk_log_stream stream[4];
    size_t count;
    read_text(text, NULL);
    check_says(IMK_ERROR_NAME_UNKNOWN, "the log holds 2 sensors; add --topic a (or --topic b)");
    settings.topic = "b";
    read_text(text, &settings);
    CHECK_CLOSE(t.data[1][0], 3, 0);
    CHECK_CLOSE(t.data[2][0], 4, 0); /* n, which belongs to both */
    settings.topic = "c";
    read_text(text, &settings);
    check_says(IMK_ERROR_NAME_UNKNOWN, "\"c\"");
    read_text("time [s],gyro_x [rad/s]\n0,1\n", &settings);
    check_says(IMK_ERROR_NAME_UNKNOWN, "leave --topic and --instance out");
    const imk_log_format *format;
    const char path[] = "/tmp/imukit_sensors.csv";
    FILE *file = fopen(path, "wb");
    fputs(text, file);
    fclose(file);
    CHECK_OK(imk_log_streams(path, NULL, 4, stream, &count, &format, NULL));
    remove(path);
    assert_int_equal(count, 2);
    assert_string_equal(stream[0].name, "a");
    assert_true(stream[1].readable);
}

/* ----------------------------------------------------------------------- what does not agree */

static void options_must_agree_with_the_file(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    const char text[] = "time [s],gyro_x [rad/s]\n0,1\n1,2\n";
    settings.gyro_unit = "rad/s";
    read_text(text, &settings);
    assert_int_equal(t.status, IMK_OK);
    settings.gyro_unit = "deg/s";
    read_text(text, &settings);
    check_says(IMK_ERROR_CONFLICT,
               "--gyro-unit deg/s does not agree with the file, which says gyro_x [rad/s]");
    read_text("time [s],gyro_x_rad_s\n0,1\n1,2\n", &settings);
    check_says(IMK_ERROR_CONFLICT, "does not agree");
}

static void rates_must_agree_with_even_times(void **state)
{
    (void)state;
    static char text[ROOM * 24];
    static const struct {
        double step; /* [s] */
        double tick; /* [s] times are rounded down to it */
        double rate; /* stated [Hz] */
        bool refused;
    } cases[] = {{0.005, 0, 200, false},
                 {0.005, 0, 201, false},
                 {0.005, 0, 203, true},
                 {0.005, 0, 400, true},
                 {0.005, 0, 100, true},
                 {1 / 800.0, 1e-3, 800, false}, /* steps of one and two ticks are not even */
                 {1 / 800.0, 1e-3, 400, false}, /* they leave it to the jobs */
                 {0.01, 1, 100, false},         /* seconds */
                 {1 / 110.0, 1e-3, 110, false}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        size_t used = (size_t)sprintf(text, "time [s],gyro_x [deg/s]\n");
        for (int i = 0; i < 600; i++) {
            const double time = i * cases[k].step;
            used += (size_t)sprintf(
                text + used, "%.6f,1\n",
                cases[k].tick > 0 ? floor(time / cases[k].tick + 1e-6) * cases[k].tick : time);
        }
        imk_log_settings settings = imk_log_default();
        settings.rate = cases[k].rate;
        read_text(text, &settings);
        if (cases[k].refused)
            check_says(IMK_ERROR_CONFLICT, "does not agree with the time column, by which");
        else
            assert_int_equal(t.status, IMK_OK);
        /* Without the column, any rate may be stated. */
        settings.map = "gyro_x=gyro_x";
        read_text(text, &settings);
        assert_int_equal(t.rows, 600);
    }
    imk_log_settings settings = imk_log_default();
    settings.rate = 50;
    read_text("time [s],gyro_x [deg/s]\n0,1\n1,1\n2,1\n", &settings); /* too few to tell */
    assert_int_equal(t.status, IMK_OK);
}

/* ------------------------------------------------------------------------------------ writing */

static void logs_are_written_as_in_euroc(void **state)
{
    (void)state;
    static const double time[3] = {0, 0.0049999999, 86400.000000001},
                        values[3] = {0.1, -1.0 / 3, 12345.678901234567};
    static const char *const names[] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                        "accel_x", "accel_y", "accel_z"};
    imk_log_column columns[7];
    const double *data[7];
    int decimals[7];
    char path[300], text[1000] = "";
    const char *directory = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/imukit_%ld_euroc.csv", directory ? directory : "/tmp",
             (long)getpid());
    for (int c = 0; c < 7; c++) {
        columns[c] = imk_record_column(names[c]);
        data[c] = c == 0 ? time : values;
        decimals[c] = -1;
    }
    imk_log_sink sink = {.path = path, .euroc = true};
    const imk_record_sink s = imk_log_sink_of(&sink);
    CHECK_OK(s.begin(s.context, 7, columns, decimals, 3, NULL));
    CHECK_OK(s.write(s.context, 3, data, NULL, NULL));
    CHECK_OK(imk_log_sink_end(&sink, IMK_OK, NULL));
    FILE *file = fopen(path, "rb");
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    static const char head[] =
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n0,0.1,";
    assert_memory_equal(text, head, sizeof head - 1);
    assert_non_null(strstr(text, "\n5000000,-0.3333333333333333,"));
    assert_non_null(strstr(text, "\n86400000000001,12345.678901234567,"));
    imk_log log;
    CHECK_OK(imk_log_load(path, NULL, NULL, &log, NULL));
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(log.data[4][i], values[i], 0);
    imk_log_free(&log);
    remove(path);
    sink = (imk_log_sink){.path = path, .euroc = true};
    const imk_record_sink again = imk_log_sink_of(&sink);
    CHECK_STATUS(again.begin(again.context, 6, columns, decimals, 3, NULL), IMK_ERROR_COLUMN);
    sink = (imk_log_sink){.path = "x.npy", .euroc = true};
    const imk_record_sink matrix = imk_log_sink_of(&sink);
    CHECK_STATUS(matrix.begin(matrix.context, 7, columns, decimals, 3, NULL),
                 IMK_ERROR_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(encodings_are_decoded),
        cmocka_unit_test(long_texts_are_decoded_in_pieces),
        cmocka_unit_test(long_stamps_keep_their_digits),
        cmocka_unit_test(dates_are_times),
        cmocka_unit_test(epochs_are_named_where_they_are_plain),
        cmocka_unit_test(few_bad_rows_are_left_out),
        cmocka_unit_test(words_for_no_value_are_missing_values),
        cmocka_unit_test(headers_between_rows_are_told),
        cmocka_unit_test(last_lines_may_be_cut),
        cmocka_unit_test(decimal_commas_are_read),
        cmocka_unit_test(other_names_are_not_read),
        cmocka_unit_test(names_are_read_with_their_groups),
        cmocka_unit_test(maps_name_columns),
        cmocka_unit_test(sensors_of_a_table_are_chosen),
        cmocka_unit_test(options_must_agree_with_the_file),
        cmocka_unit_test(rates_must_agree_with_even_times),
        cmocka_unit_test(logs_are_written_as_in_euroc),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
