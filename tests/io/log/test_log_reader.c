/* SPDX-License-Identifier: Apache-2.0 */
/* The log reader: every refusal with its remedy, units and axes, findings against their definition,
 * and the same numbers whichever way the bytes come. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include "imukit/decimal.h"
#include "imukit/io.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static const double degree = 0.017453292519943295; /* pi/180, rounded to double */

static uint64_t random_state = 20240607;

static uint64_t random_bits(void)
{
    uint64_t z = random_state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

/* ------------------------------------------------------------------------------------- helpers */

static const char *temporary_path(const char *name)
{
    static char path[4][256];
    static int turn;
    char *text = path[turn++ % 4];
    const char *directory = getenv("TMPDIR");
    snprintf(text, sizeof path[0], "%s/imukit_%ld_%s", directory ? directory : "/tmp",
             (long)getpid(), name);
    return text;
}

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static void write_gzip(const char *path, const char *text, size_t size)
{
    gzFile file = gzopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(gzwrite(file, text, (unsigned)size), (int)size);
    gzclose(file);
}

/* Everything read from an open log in pieces of `piece` rows; at most 64 columns of `room` rows. */
typedef struct table {
    size_t rows, columns;
    double *data[IMK_LOG_COLUMNS_MAX];
    imk_log_findings findings;
} table;

static imk_status read_table(imk_log_reader *reader, size_t room, size_t piece, table *t,
                             imk_error *error)
{
    *t = (table){.columns = imk_log_column_count(reader)};
    for (size_t j = 0; j < t->columns; j++)
        t->data[j] = calloc(room, sizeof(double));
    size_t got = 1;
    imk_status status = IMK_OK;
    while (status == IMK_OK && got > 0) {
        double *place[IMK_LOG_COLUMNS_MAX];
        for (size_t j = 0; j < t->columns; j++)
            place[j] = t->data[j] + t->rows;
        const size_t left = room - t->rows;
        got = 0;
        status = imk_log_read(reader, left < piece ? left : piece, place, &got, error);
        t->rows += got;
    }
    t->findings = imk_log_findings_get(reader);
    return status;
}

static void free_table(table *t)
{
    for (size_t j = 0; j < t->columns; j++)
        free(t->data[j]);
}

/* Read a text; the status of opening or of reading. */
static imk_status try_text(const char *text, size_t size, const imk_log_settings *settings,
                           table *t, imk_error *error)
{
    imk_log_reader *reader;
    table local;
    imk_status status = imk_log_open_memory(text, size, settings, &reader, error);
    if (status != IMK_OK)
        return status;
    status = read_table(reader, 4000, 1000, t ? t : &local, error);
    if (!t)
        free_table(&local);
    imk_log_close(reader);
    return status;
}

static table read_text(const char *text, const imk_log_settings *settings)
{
    table t = {0};
    imk_error error = {0};
    const imk_status status = try_text(text, strlen(text), settings, &t, &error);
    if (status != IMK_OK) {
        char message[512];
        imk_error_text(&error, NULL, message, sizeof message);
        print_error("%s: %s\n", imk_status_name(status), message);
        fail();
    }
    return t;
}

/* A text is refused with this status, at this line, and the message holds these words. */
static void check_refused(const char *text, size_t size, const imk_log_settings *settings,
                          imk_status status, size_t line, const char *words)
{
    imk_error error = {0};
    char message[512];
    CHECK_STATUS(try_text(text, size, settings, NULL, &error), status);
    assert_int_equal(error.status, status);
    imk_error_text(&error, "log.csv", message, sizeof message);
    if (!strstr(message, words)) {
        print_error("\"%s\" does not say \"%s\"\n", message, words);
        fail();
    }
    assert_int_equal(error.line, line);
}

/* ------------------------------------------------------------------------------------ refusals */

static void bad_texts_are_refused_with_a_remedy(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        imk_status status;
        size_t line;
        const char *words;
    } cases[] = {
        {"", IMK_ERROR_EMPTY, 0, "empty"},
        {"# only\n# comments\n\n", IMK_ERROR_EMPTY, 0, "no header"},
        {"time [s],gyro_x [deg/s]\n", IMK_ERROR_EMPTY, 0, "no rows"},
        {"time [s],gyro_x [deg/s]", IMK_ERROR_EMPTY, 0, "no rows"},
        {"time [s],gyro_x\n0,1\n", IMK_ERROR_UNIT_MISSING, 1, "add --gyro-unit UNIT ("},
        {"time [s],acc_x\n0,1\n", IMK_ERROR_UNIT_MISSING, 1, "add --accel-unit UNIT ("},
        {"time,gyro_x [deg/s]\n0,1\n", IMK_ERROR_UNIT_MISSING, 1, "add --time-unit UNIT ("},
        {"time [s],temp,gyro_x [deg/s]\n0,1,2\n", IMK_ERROR_UNIT_MISSING, 1,
         "add --temperature-unit UNIT ("},
        {"gyro_x [deg/s]\n1\n", IMK_ERROR_RATE_MISSING, 1, "add --rate RATE (samples per second"},
        {"time [s],gyro_x [furlong]\n0,1\n", IMK_ERROR_UNIT_UNKNOWN, 1, "furlong"},
        {"time [s],gyro_x [deg]\n0,1\n", IMK_ERROR_DIMENSION, 1, "angular rate"},
        {"time [s],accel_x [deg/s]\n0,1\n", IMK_ERROR_DIMENSION, 1, "specific force"},
        {"time [m],accel_x [g]\n0,1\n", IMK_ERROR_DIMENSION, 1, "time"},
        {"time [s],dtheta_x [deg/s]\n0,1\n", IMK_ERROR_DIMENSION, 1, "angle"},
        {"0,1,2,3,4,5\n", IMK_ERROR_COLUMN, 0,
         "such as \"gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\"; - skips a column, and units "
         "as in gyro_x [UNIT]; add --rate RATE"},
        {"0,1,2,3,4,5,6\n", IMK_ERROR_COLUMN, 0,
         "such as \"time,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\"; - skips a column, and"},
        {"1,2\n3,4\n", IMK_ERROR_COLUMN, 0, "add --columns with 2 names"},
        {"foo,bar\n3,4\n", IMK_ERROR_COLUMN, 1, "no column has a known name"},
        {"time [s],gyro_x [deg/s],gyro_x [deg/s]\n0,1,2\n", IMK_ERROR_COLUMN, 1, "twice"},
        {"time [s],accel_x [g],acc_x [g]\n0,1,2\n", IMK_ERROR_COLUMN, 1, "twice"},
        {"time [s],gyro_x [deg/s]\n0,1\n1,2,3\n1,2,3\n1,2,3\n1,2,3\n", IMK_ERROR_COLUMN, 3,
         "3 cells"},
        {"time [s],gyro_x [deg/s]\n0,1\n1\n1\n1\n1\n2,2\n", IMK_ERROR_COLUMN, 3,
         "1 cell; expected 2, as in the first line; 4 of the first 5 rows cannot be read"},
        {"time [s],gyro_x [deg/s]\n0,1\n0.5,x\n1,1.2.3\n1,--2\n1,.\n", IMK_ERROR_SYNTAX, 3,
         "\"x\" cannot be read"},
        {"time [s],gyro_x [deg/s]\n0,5,1,5\n1,5,2,5\n", IMK_ERROR_COLUMN, 2, "decimal commas"},
        {"time [s],dtheta_x [arcsec]\n0,1\n", IMK_ERROR_TOO_SHORT, 0, "add --rate"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_refused(cases[i].text, strlen(cases[i].text), NULL, cases[i].status, cases[i].line,
                      cases[i].words);
}

static void binary_junk_is_refused(void **state)
{
    (void)state;
    char junk[5000];
    for (size_t i = 0; i < sizeof junk; i++)
        junk[i] = (char)random_bits();
    check_refused(junk, sizeof junk, NULL, IMK_ERROR_FORMAT, 0, "not a text log");
    const char zero[] = "time [s],gyro_x [deg/s]\n0,1\0,2\n";
    check_refused(zero, sizeof zero - 1, NULL, IMK_ERROR_FORMAT, 0, "not a text log");
    const char npy[] = "\x93NUMPY\x01\x00\xFF\xFF{'descr'";
    check_refused(npy, sizeof npy - 1, NULL, IMK_ERROR_FORMAT, 0, "npy");
}

/* A header, a row and then `size` digits without a newline. */
static void very_long_lines_are_refused(void **state)
{
    (void)state;
    static const char head[] = "time [s],gyro_x [deg/s]\n0,1\n";
    const size_t size = 3 << 20;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, '1', size);
    check_refused(text, size, NULL, IMK_ERROR_FORMAT, 1, "longer than 1 MiB");
    memcpy(text, head, sizeof head - 1);
    check_refused(text, size, NULL, IMK_ERROR_FORMAT, 3, "longer than 1 MiB");
    /* The same as a stream, from a file that unpacks to much more than it is. */
    const char *path = temporary_path("long.csv.gz");
    write_gzip(path, text, size);
    imk_log_reader *reader;
    imk_error error;
    CHECK_OK(imk_log_open(path, NULL, &reader, &error));
    table t;
    CHECK_STATUS(read_table(reader, 10, 10, &t, &error), IMK_ERROR_FORMAT);
    assert_int_equal(t.rows, 1);
    assert_int_equal(error.line, 3);
    free_table(&t);
    imk_log_close(reader);
    remove(path);
    free(text);
}

static void missing_files_and_directories_are_refused(void **state)
{
    (void)state;
    imk_log_reader *reader;
    imk_error error;
    CHECK_STATUS(imk_log_open("/nonexistent/log.csv", NULL, &reader, &error), IMK_ERROR_OPEN);
    CHECK_STATUS(imk_log_open("/", NULL, &reader, &error), IMK_ERROR_OPEN);
    const char *path = temporary_path("empty.csv");
    write_file(path, "", 0);
    CHECK_STATUS(imk_log_open(path, NULL, &reader, &error), IMK_ERROR_EMPTY);
    remove(path);
}

static void settings_are_checked(void **state)
{
    (void)state;
    const char text[] = "gyro_x,gyro_y\n1,2\n";
    imk_log_settings settings = imk_log_default();
    settings.gyro_unit = "deg/s";
    settings.rate = -1.0;
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_RANGE, 0, "--rate");
    settings.rate = (double)NAN;
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_RANGE, 0, "--rate");
    settings.rate = 10.0;
    settings.columns = "gyro_x";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_COLUMN, 0, "2, one for each column");
    settings.columns = "-,-";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_COLUMN, 0, "skipped");
    settings.columns = NULL;
    settings.gyro_unit = "nonsense";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_UNIT_UNKNOWN, 1, "nonsense");
    /* A unit that the header leaves without use is read all the same. */
    const char whole[] = "time [s],gyro_x [deg/s]\n0,1\n1,2\n";
    check_refused(whole, sizeof whole - 1, &settings, IMK_ERROR_UNIT_UNKNOWN, 1, "nonsense");
    settings.gyro_unit = "deg";
    check_refused(whole, sizeof whole - 1, &settings, IMK_ERROR_DIMENSION, 1, "an angular rate");
    const char increments[] = "time [s],dtheta_x [deg]\n0,1\n1,2\n";
    settings.gyro_unit = "deg/s";
    check_refused(increments, sizeof increments - 1, &settings, IMK_ERROR_DIMENSION, 1,
                  "an angle,");
    settings.accel_unit = "deg/s"; /* of columns that are not there */
    check_refused(whole, sizeof whole - 1, &settings, IMK_ERROR_DIMENSION, 1, "--accel-unit");
    settings.accel_unit = "m/s";
    CHECK_STATUS(try_text(whole, sizeof whole - 1, &settings, NULL, NULL), IMK_OK);
    settings.accel_unit = NULL;
    settings.gyro_unit = "deg/s";
    settings.axes = "right-forward";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_SYNTAX, 1, "right-forward-up");
    settings.axes = "right-left-up";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_CONFLICT, 1, "right angles");
    settings.axes = "right-forward-down";
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_CONFLICT, 1, "left-handed");
    settings.cookie = 0;
    check_refused(text, sizeof text - 1, &settings, IMK_ERROR_UNINITIALISED, 0, "_default");
}

static void damaged_gzip_is_an_error_after_its_good_rows(void **state)
{
    (void)state;
    char *text = malloc(1 << 20);
    assert_non_null(text);
    size_t size = (size_t)sprintf(text, "time [s],gyro_x [deg/s]\n");
    for (int i = 0; i < 20000; i++)
        size += (size_t)sprintf(text + size, "%d.5,%u\n", i, (unsigned)(random_bits() >> 40));
    const char *path = temporary_path("cut.csv.gz");
    write_gzip(path, text, size);
    FILE *file = fopen(path, "rb");
    static char packed[1 << 20];
    const size_t packed_size = fread(packed, 1, sizeof packed, file);
    fclose(file);
    write_file(path, packed, packed_size / 2);
    imk_log log;
    imk_error error;
    CHECK_STATUS(imk_log_load(path, NULL, NULL, &log, &error), IMK_ERROR_COMPRESSED);
    imk_log_reader *reader;
    CHECK_OK(imk_log_open(path, NULL, &reader, &error));
    table t;
    CHECK_STATUS(read_table(reader, 30000, 1000, &t, &error), IMK_ERROR_COMPRESSED);
    assert_true(t.rows > 5000 && t.rows < 15000);
    CHECK_CLOSE(t.data[0][t.rows - 1], (double)t.rows - 0.5, 0.0);
    free_table(&t);
    imk_log_close(reader);
    remove(path);
    free(text);
}

/* --------------------------------------------------------------------------- columns and units */

static void names_and_units_are_understood(void **state)
{
    (void)state;
    imk_log_reader *reader;
    const char text[] = "\xEF\xBB\xBF# a comment, with commas\n\n"
                        "Timestamp (ms), GYRO_Z [deg/s],ACC_x [g],Temp [degC],pressure [hPa?],n\n"
                        "1000, 90, 1 ,25,7,3\n";
    CHECK_OK(imk_log_open_memory(text, sizeof text - 1, NULL, &reader, NULL));
    assert_int_equal(imk_log_column_count(reader), 6);
    assert_int_equal(imk_log_column_find(reader, IMK_QUANTITY_TIME, -1), 0);
    assert_int_equal(imk_log_column_find(reader, IMK_QUANTITY_ANGULAR_RATE, 2), 1);
    assert_int_equal(imk_log_column_find(reader, IMK_QUANTITY_SPECIFIC_FORCE, 0), 2);
    assert_int_equal(imk_log_column_find(reader, IMK_QUANTITY_TEMPERATURE, -1), 3);
    assert_int_equal(imk_log_column_find(reader, IMK_QUANTITY_ANGULAR_RATE, 0), -1);
    assert_string_equal(imk_log_column_get(reader, 1)->name, "gyro_z");
    assert_string_equal(imk_log_column_get(reader, 2)->name, "accel_x");
    assert_string_equal(imk_log_column_get(reader, 4)->name, "pressure");
    assert_null(imk_log_column_get(reader, 6));
    table t;
    CHECK_OK(read_table(reader, 10, 10, &t, NULL));
    assert_int_equal(t.rows, 1);
    CHECK_CLOSE(t.data[0][0], 1.0, 0.0);
    CHECK_CLOSE(t.data[1][0], 90.0 * degree, 0.0);
    CHECK_CLOSE(t.data[2][0], 9.80665, 0.0);
    CHECK_CLOSE(t.data[3][0], 298.15, 0.0);
    CHECK_CLOSE(t.data[4][0], 7.0, 0.0); /* unit not known: as it stands */
    CHECK_CLOSE(t.data[5][0], 3.0, 0.0);
    free_table(&t);
    imk_log_close(reader);
}

static void every_separator_and_line_end_is_understood(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "time [s],gyro_x [rad/s],gyro_y [rad/s]\n0,1.5,-2\n1,-0.25,3e-2\n",
        "time [s];gyro_x [rad/s];gyro_y [rad/s]\r\n0;1.5;-2\r\n1;-0.25;3e-2\r\n",
        "time [s]\tgyro_x [rad/s]\tgyro_y [rad/s]\n0\t1.5\t-2\n1\t-0.25\t3e-2\n",
        "time [s] gyro_x [rad/s] gyro_y [rad/s]\n  0 1.5   -2 \n1\t-0.25 3e-2\n",
        "time[s] gyro_x[rad/s] gyro_y(rad/s)\n0 1.5 -2\n1 -0.25 3e-2\n",
        "\"time [s]\",\"gyro_x [rad/s]\",\"gyro_y [rad/s]\"\n\"0\",\"1.5\",\"-2\"\n1,-0.25, 3e-2\n",
        "time [s],gyro_x [rad/s],gyro_y [rad/s]\n# note\n0,1.5,-2\n\n  # another\n1,-.25,+.03\r\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        table t = read_text(texts[i], NULL);
        assert_int_equal(t.rows, 2);
        assert_int_equal(t.columns, 3);
        assert_true(t.data[0][0] == 0.0 && t.data[0][1] == 1.0);
        assert_true(t.data[1][0] == 1.5 && t.data[1][1] == -0.25);
        assert_true(t.data[2][0] == -2.0 && t.data[2][1] == 3e-2);
        free_table(&t);
    }
}

static void settings_stand_in_for_the_header(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.columns = "time,gyro_x,-,accel_z";
    settings.time_unit = "us";
    settings.gyro_unit = "deg/s";
    settings.accel_unit = "mg";
    table t = read_text("0,1,99,1000\n10000,2,99,-1000\n", &settings);
    assert_int_equal(t.columns, 3);
    assert_int_equal(t.rows, 2);
    CHECK_CLOSE(t.data[0][1], 0.01, 0.0);
    CHECK_CLOSE(t.data[1][1], 2.0 * degree, 1e-17);
    CHECK_RELATIVE(t.data[2][1], -9.80665, 3e-16); /* 1e-3 and the product round */
    free_table(&t);
    /* Names of a file that has its own are replaced, its units stay. */
    settings.time_unit = settings.gyro_unit = settings.accel_unit = NULL;
    t = read_text("a [s],wx [rad/s],b,az [g]\n0,1,99,1\n1,2,99,-1\n", &settings);
    assert_int_equal(t.rows, 2);
    CHECK_CLOSE(t.data[0][1], 1.0, 0.0);
    CHECK_CLOSE(t.data[1][1], 2.0, 0.0);
    CHECK_CLOSE(t.data[2][1], -9.80665, 0.0);
    free_table(&t);
}

static void axes_are_turned_to_forward_right_down(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.axes = "right-forward-up";
    settings.rate = 1.0;
    const char text[] = "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]\n1,2,3\n";
    imk_log_reader *reader;
    CHECK_OK(imk_log_open_memory(text, sizeof text - 1, &settings, &reader, NULL));
    table t;
    CHECK_OK(read_table(reader, 4, 4, &t, NULL));
    /* forward is the file's y, right its x, down minus its z */
    const double expected[3] = {2.0, 1.0, -3.0};
    for (int axis = 0; axis < 3; axis++) {
        const int column = imk_log_column_find(reader, IMK_QUANTITY_SPECIFIC_FORCE, axis);
        assert_in_range(column, 0, 2);
        CHECK_CLOSE(t.data[column][0], expected[axis], 0.0);
    }
    assert_string_equal(imk_log_column_get(reader, 0)->name, "accel_y");
    free_table(&t);
    imk_log_close(reader);
}

static void texts_become_labels(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.rate = 2.0;
    const char text[] = "section,accel_x [count]\nx_a,1\nx_a,2\ny b,3\nx_a,4\n";
    const char *path = temporary_path("labels.csv");
    write_file(path, text, sizeof text - 1);
    imk_log log;
    CHECK_OK(imk_log_load(path, &settings, NULL, &log, NULL));
    remove(path);
    assert_true(log.column[0].label && !log.column[1].label);
    assert_int_equal(log.rows, 4);
    assert_int_equal(log.label_count, 2);
    assert_string_equal(log.label[0], "x_a");
    assert_string_equal(log.label[1], "y b");
    const double expected[4] = {0.0, 0.0, 1.0, 0.0};
    for (int i = 0; i < 4; i++)
        CHECK_CLOSE(log.data[0][i], expected[i], 0.0);
    assert_int_equal(log.findings.not_finite, 0);
    imk_log_free(&log);
}

/* A unit is not guessed, but that the numbers are whole is said. */
static void counts_are_said_to_be_whole(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool whole;
    } logs[] = {{"gyro_x,accel_x,note\n12,-3,0.5\n0,4,0.5\n", true},
                {"gyro_x [deg/s],accel_x\n1.5,400\n2.5,401\n", true},
                {"gyro_x,accel_x\n12,-3\n0.5,4\n", false},
                {"gyro_x,accel_x\n0,0\n0,0\n", false}};
    imk_log_settings settings = imk_log_default();
    settings.rate = 2.0;
    for (size_t k = 0; k < sizeof logs / sizeof logs[0]; k++) {
        imk_log_reader *reader;
        imk_error error;
        assert_int_not_equal(
            imk_log_open_memory(logs[k].text, strlen(logs[k].text), &settings, &reader, &error),
            IMK_OK);
        assert_non_null(strstr(error.expected, " UNIT ("));
        assert_null(strstr(error.expected, "-unit count"));
        assert_int_equal(strstr(error.expected, "whole numbers: count") != NULL, logs[k].whole);
    }
}

/* A column that begins blank is what its first other cell says, also far beyond the first window of
 * a text that is not in memory as a whole. */
static void blank_cells_wait(void **state)
{
    (void)state;
    enum { BLANK = 30000 };
    const char *const first[] = {"up", "7", ""};
    char *text = malloc(16 * BLANK);
    const char *path = temporary_path("blank.csv");
    for (int k = 0; k < 3; k++)
        for (int packed = 0; packed < 2; packed++) {
            size_t used = (size_t)sprintf(text, "accel_x [count],note\n");
            for (int i = 0; i < BLANK; i++)
                used += (size_t)sprintf(text + used, i == 0 ? "1,\"\"\n" : "1,\n");
            used += (size_t)sprintf(text + used, "2,%s\n3,\n", first[k]);
            imk_log_settings settings = imk_log_default();
            settings.rate = 2.0;
            imk_log log;
            if (packed)
                write_gzip(path, text, used);
            else
                write_file(path, text, used);
            CHECK_OK(imk_log_load(path, &settings, NULL, &log, NULL));
            remove(path);
            assert_int_equal(log.rows, BLANK + 2);
            assert_int_equal(log.column[1].label, k == 0);
            CHECK_CLOSE(log.data[0][BLANK], 2.0, 0.0);
            const double note = log.data[1][BLANK];
            if (k == 0) {
                assert_string_equal(log.label[(size_t)note], "up");
                assert_string_equal(log.label[(size_t)log.data[1][0]], "");
                assert_string_equal(log.label[(size_t)log.data[1][BLANK + 1]], "");
                assert_int_equal(log.findings.not_finite, 0);
            } else {
                assert_true(k == 1 ? note == 7.0 : isnan(note));
                assert_true(isnan(log.data[1][0]));
            }
            imk_log_free(&log);
        }
    free(text);
}

/* ---------------------------------------------------------------------------- times and findings
 */

static void increments_are_divided_by_the_interval(void **state)
{
    (void)state;
    /* Steps 0.5 s and 0.25 s; the first row takes the next step. */
    const char text[] = "time [s],dtheta_x [rad],dvel_x [m/s]\n0,1,10\n0.5,2,20\n0.75,3,30\n"
                        "0.75,1,0\n1.75,1,0\n";
    const double rates[5] = {2.0, 4.0, 12.0, 4.0, 1.0};
    table t = read_text(text, NULL);
    assert_int_equal(t.rows, 5);
    for (int i = 0; i < 5; i++)
        CHECK_CLOSE(t.data[1][i], rates[i], 0.0);
    CHECK_CLOSE(t.data[2][2], 120.0, 0.0);
    free_table(&t);
    imk_log_settings settings = imk_log_default();
    settings.rate = 8.0;
    t = read_text(text, &settings);
    CHECK_CLOSE(t.data[1][0], 8.0, 0.0);
    CHECK_CLOSE(t.data[1][4], 8.0, 0.0);
    free_table(&t);
    /* Row by row and with columns nobody wants it is the same. */
    imk_log_reader *reader;
    CHECK_OK(imk_log_open_memory(text, sizeof text - 1, NULL, &reader, NULL));
    for (int i = 0; i < 5; i++) {
        double rate = 0.0;
        double *columns[3] = {NULL, &rate, NULL};
        size_t rows;
        CHECK_OK(imk_log_read(reader, 1, columns, &rows, NULL));
        assert_int_equal(rows, 1);
        CHECK_CLOSE(rate, rates[i], 0.0);
    }
    imk_log_close(reader);
}

/* An increment is that of one sample: lost rows make none smaller, a new rate does. */
static void increments_behind_lost_rows(void **state)
{
    (void)state;
    enum { ROWS = 200 };
    char text[ROWS * 40] = "time [ms],dtheta_x [rad]\n";
    size_t length = strlen(text);
    double due[ROWS];
    size_t rows = 0;
    for (int i = 0; i < ROWS; i++) {
        const bool slow = i > 100;
        if ((i >= 40 && i < 43) || i == 60 || i == 63 || i == 66 || i == 150 || (slow && i % 2))
            continue; /* lost, or of the half rate */
        length += (size_t)snprintf(text + length, sizeof text - length, "%d,%d\n", 10 * i, i);
        due[rows++] = slow ? i / 0.02 : i / 0.01;
    }
    table t = read_text(text, NULL);
    assert_int_equal(t.rows, rows);
    size_t wrong = 0;
    for (size_t i = 0; i < rows; i++)
        wrong += !(fabs(t.data[1][i] - due[i]) <= 1e-9 * due[i]);
    /* The first rows of the new rate cannot be told from those behind a loss. */
    assert_int_equal(wrong, 4);
    CHECK_RELATIVE(t.data[1][rows - 1], due[rows - 1], 1e-9);
    free_table(&t);
}

static void microsecond_clocks_keep_their_resolution(void **state)
{
    (void)state;
    table t = read_text("time [us],gyro_x [rad/s]\n256551281491968,1\n256551281491969,2\n"
                        "256551281491971,3\n",
                        NULL);
    CHECK_CLOSE(t.data[0][0], 0.0, 0.0);
    CHECK_CLOSE(t.data[0][1], 1e-6, 0.0);
    CHECK_CLOSE(t.data[0][2], 3e-6, 1e-21);
    CHECK_CLOSE(t.findings.time_origin, 256551281.491968, 1e-7);
    free_table(&t);
    t = read_text("time [s],gyro_x [rad/s]\n604800.5,1\n604800.75,2\n", NULL);
    CHECK_CLOSE(t.data[0][0], 604800.5, 0.0); /* a GPS time of the week stays */
    CHECK_CLOSE(t.findings.time_origin, 0.0, 0.0);
    free_table(&t);
}

static void findings_count_what_is_wrong(void **state)
{
    (void)state;
    /* Steps: 1 1 3 0 1 -2 1 1 | nan between, so no step there | 1 2.6 */
    table t = read_text("time [s],gyro_x [rad/s]\n0,1\n1,1\n2,nan\n5,1\n5,1\n6,\n4,1\n5,1\n6,inf\n"
                        "nan,1\n7,1\n8,1\n10.6,1\n",
                        NULL);
    const imk_log_findings *f = &t.findings;
    assert_int_equal(f->rows, 13);
    assert_int_equal(f->not_finite, 4);
    assert_int_equal(f->first_not_finite, 3);
    assert_int_equal(f->reversals, 1);
    assert_int_equal(f->first_reversal, 7);
    assert_int_equal(f->repeats, 1);
    assert_int_equal(f->first_repeat, 5);
    assert_int_equal(f->gaps, 2);
    assert_int_equal(f->first_gap, 4);
    assert_int_equal(f->missing, 2 + 2); /* 3 s hold 2 more, 2.6 s round to 3 */
    CHECK_CLOSE(f->interval, 1.0, 0.0);
    CHECK_CLOSE(f->jitter, 0.0, 0.0);
    CHECK_CLOSE(f->first_time, 0.0, 0.0);
    CHECK_CLOSE(f->last_time, 10.6, 0.0);
    assert_true(isnan(t.data[1][2]) && isnan(t.data[1][5]) && isinf(t.data[1][8]));
    free_table(&t);
    /* What is a gap, samples.h: 1.49 intervals are none, 1.51 are. */
    t = read_text("time [s],gyro_x [rad/s]\n0,1\n1,1\n2,1\n3.49,1\n4.49,1\n6,1\n7,1\n8,1\n", NULL);
    assert_int_equal(t.findings.gaps, 1);
    assert_int_equal(t.findings.first_gap, 6);
    assert_int_equal(t.findings.missing, 1);
    free_table(&t);
    imk_log_settings settings = imk_log_default();
    settings.rate = 50.0;
    t = read_text("gyro_x [rad/s]\n1\n2\n3\n", &settings);
    CHECK_CLOSE(t.findings.interval, 0.02, 0.0);
    CHECK_CLOSE(t.findings.last_time, 0.04, 0.0);
    free_table(&t);
}

/* 20 000 steps of 1 s or 1.125 s in turn, beyond several groups of 4096, with a gap of 10 s in
 * every 2500: the median is 1 s (as many of both, the lower one counts; the first group holds one
 * gap, so the 4095 others decide), the jitter sqrt(0.125^2 / 2). All steps are exact in binary. */
static void findings_hold_over_many_groups(void **state)
{
    (void)state;
    char *text = malloc(1 << 20);
    assert_non_null(text);
    size_t size = (size_t)sprintf(text, "time [s],gyro_x [rad/s]\n");
    double time = 0.0;
    size_t gaps = 0;
    for (int i = 0; i <= 20000; i++) {
        size += (size_t)sprintf(text + size, "%.3f,0\n", time);
        if (i % 2500 == 2499) {
            time += 10.0;
            gaps++;
        } else {
            time += i % 2 == 0 ? 1.0 : 1.125;
        }
    }
    imk_log_reader *reader;
    CHECK_OK(imk_log_open_memory(text, size, NULL, &reader, NULL));
    table t;
    CHECK_OK(read_table(reader, 30000, 777, &t, NULL));
    assert_int_equal(t.findings.rows, 20001);
    assert_int_equal(t.findings.gaps, gaps);
    assert_int_equal(t.findings.first_gap, 2501);
    assert_int_equal(t.findings.missing, 9 * gaps);
    CHECK_CLOSE(t.findings.interval, 1.0, 0.0);
    /* Every gap takes the place of a step of 1.125 s. */
    CHECK_RELATIVE(t.findings.jitter, 0.125 * sqrt(9992.0 / 19992.0), 1e-12);
    free_table(&t);
    imk_log_close(reader);
    free(text);
}

/* ----------------------------------------------------------------- the same whichever way it comes
 */

/* A cell as logs and people write them, and what it is. */
static size_t random_cell(char *text, double *value)
{
    const uint64_t kind = random_bits() % 40;
    const double unit = (double)(random_bits() >> 11) * 0x1p-53 - 0.5;
    const double number = unit * (random_bits() % 4 == 0 ? 1e5 : 10.0);
    size_t length;
    if (kind < 20)
        length = (size_t)sprintf(text, "%.*f", (int)(random_bits() % 12), number);
    else if (kind < 28)
        length = (size_t)sprintf(text, "%.9g", number);
    else if (kind < 34)
        length = (size_t)sprintf(text, "%.17g", unit);
    else if (kind < 38)
        length = (size_t)sprintf(text, "%d", (int)(random_bits() % 100000));
    else if (kind == 38)
        length = (size_t)sprintf(text, "%.12e", number);
    else
        length = (size_t)sprintf(text, "%s", random_bits() % 30 == 0 ? "nan" : " 0.5 ");
    *value = strtod(text, NULL);
    return length;
}

static void compare_tables(const table *a, const table *b)
{
    assert_int_equal(a->rows, b->rows);
    for (size_t j = 0; j < a->columns; j++)
        for (size_t i = 0; i < a->rows; i++)
            if (!(a->data[j][i] == b->data[j][i] ||
                  (isnan(a->data[j][i]) && isnan(b->data[j][i])))) {
                print_error("row %zu column %zu: %.17g and %.17g\n", i, j, a->data[j][i],
                            b->data[j][i]);
                fail();
            }
}

/* Random logs of many shapes: from memory in one piece, from memory in pieces of random length with
 * either kernel, and through a gzip stream, all give what strtod() gives for each cell. */
static void random_logs_read_the_same_every_way(void **state)
{
    (void)state;
    static const char separators[] = ",;\t ";
    enum { ROWS = 3000 };
    char *text = malloc(ROWS * 8 * 32);
    assert_non_null(text);
    const char *path = temporary_path("random.csv.gz");
    const char *requirement = getenv("IMUKIT_ISA");
    char *isa = requirement ? strdup(requirement) : NULL; /* as the test was started with */
    for (int turn = 0; turn < 24; turn++) {
        const size_t columns = 1 + (size_t)(random_bits() % 7);
        const char separator = separators[random_bits() % 4];
        const char *line_end = random_bits() % 4 == 0 ? "\r\n" : "\n";
        table expected = {.rows = ROWS, .columns = columns};
        size_t size = 0;
        for (size_t j = 0; j < columns; j++) {
            expected.data[j] = calloc(ROWS, sizeof(double));
            size +=
                (size_t)sprintf(text + size, "%s%s_%d [%s]", j > 0 ? (char[]){separator, 0} : "",
                                j % 2 ? "accel" : "gyro", (int)j, j % 2 ? "m/s^2" : "rad/s");
        }
        size += (size_t)sprintf(text + size, "%s", line_end);
        for (size_t i = 0; i < ROWS; i++) {
            if (random_bits() % 500 == 0)
                size += (size_t)sprintf(text + size, "# comment%s", line_end);
            for (size_t j = 0; j < columns; j++) {
                size += random_cell(text + size, &expected.data[j][i]);
                text[size++] = separator;
            }
            size--;
            size += (size_t)sprintf(text + size, "%s", line_end);
        }
        if (turn % 5 == 0) { /* the last line without its end may be cut */
            size -= strlen(line_end);
            expected.rows = ROWS - 1;
        }
        imk_log_settings settings = imk_log_default();
        settings.rate = 1.0;
        write_gzip(path, text, size);
        for (int way = 0; way < 4; way++) {
            imk_log_reader *reader;
            /* The portable kernel; the choice is made when a log is opened. */
            if (way == 1)
                setenv("IMUKIT_ISA", "scalar", 1);
            else if (isa)
                setenv("IMUKIT_ISA", isa, 1);
            else
                unsetenv("IMUKIT_ISA");
            CHECK_OK(way < 3 ? imk_log_open_memory(text, size, &settings, &reader, NULL)
                             : imk_log_open(path, &settings, &reader, NULL));
            table t;
            CHECK_OK(read_table(reader, ROWS + 1, way == 0 ? ROWS + 1 : 1 + random_bits() % 700, &t,
                                NULL));
            compare_tables(&t, &expected);
            free_table(&t);
            imk_log_close(reader);
        }
        free_table(&expected);
    }
    remove(path);
    free(isa);
    free(text);
}

/* A text cut anywhere gives whole rows and, at most, one error; never a wrong row. */
static void cut_logs_give_whole_rows(void **state)
{
    (void)state;
    const char text[] = "time [s],gyro_x [rad/s],accel_x [m/s^2]\n0.125,-1.5,9.75\n"
                        "0.250,-2.5,9.50\n0.375,-3.5,9.25\n";
    for (size_t size = 0; size < sizeof text; size++) {
        char *copy = malloc(size + 1); /* exact size, for the address sanitiser */
        assert_non_null(copy);
        memcpy(copy, text, size);
        table t = {0};
        imk_error error = {0};
        const imk_status status = try_text(copy, size, NULL, &t, &error);
        for (size_t i = 0; i < t.rows; i++) {
            CHECK_CLOSE(t.data[1][i], -1.5 - (double)i, 0.0);
            assert_true(t.data[2][i] <= 9.75 && t.data[2][i] >= 9.0);
        }
        assert_true(t.rows <= 3);
        assert_true(status == IMK_OK || error.status == status);
        free_table(&t);
        free(copy);
    }
}

static void memory_of_exact_size_is_enough(void **state)
{
    (void)state;
    /* Neither before nor behind the text is a byte read: the address sanitiser tells. */
    const char text[] = "t [s],gyro_x [rad/s]\n0,1\n1,22.5\n2,-333.25\n";
    char *copy = malloc(sizeof text - 1);
    assert_non_null(copy);
    memcpy(copy, text, sizeof text - 1);
    table t;
    CHECK_OK(try_text(copy, sizeof text - 1, NULL, &t, NULL));
    assert_int_equal(t.rows, 3);
    CHECK_CLOSE(t.data[1][2], -333.25, 0.0);
    free_table(&t);
    free(copy);
}

/* ------------------------------------------------------------------------------------- matrices */

static void matrices_are_read(void **state)
{
    (void)state;
    for (int single = 0; single < 2; single++) {
        char bytes[128 + 8 * 9] = "\x93NUMPY\x01\x00\x76";
        char *head = bytes + 10;
        memset(head, ' ', 118);
        const char *dictionary =
            single ? "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }"
                   : "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 3), }";
        memcpy(head, dictionary, strlen(dictionary));
        head[117] = '\n';
        const size_t value_size = single ? 4 : 8;
        for (int i = 0; i < 9; i++) {
            const double value = i == 7 ? (double)NAN : 0.5 * i;
            const float narrow = (float)value;
            memcpy(bytes + 128 + (size_t)i * value_size, single ? (const void *)&narrow : &value,
                   value_size);
        }
        const char *path = temporary_path("matrix.npy");
        char names_path[300];
        snprintf(names_path, sizeof names_path, "%s.columns", path);
        const char names[] = "time [s]\ngyro_x [deg/s]\ntemperature [degC]\n";
        write_file(path, bytes, 128 + 9 * value_size);
        write_file(names_path, names, sizeof names - 1);
        imk_log log;
        imk_error error;
        CHECK_OK(imk_log_load(path, NULL, NULL, &log, &error));
        assert_int_equal(log.rows, 3);
        CHECK_CLOSE(log.data[0][2], 3.0, 0.0);
        CHECK_CLOSE(log.data[1][1], 2.0 * degree, 0.0);
        CHECK_CLOSE(log.data[2][1], 2.5 + 273.15, 0.0);
        assert_int_equal(log.findings.not_finite, 1);
        assert_int_equal(log.findings.first_not_finite, 3);
        CHECK_CLOSE(log.findings.interval, 1.5, 0.0);
        imk_log_free(&log);
        /* Without names: the option is asked for; and cut in the middle. */
        remove(names_path);
        CHECK_STATUS(imk_log_load(path, NULL, NULL, &log, &error), IMK_ERROR_COLUMN);
        assert_non_null(strstr(error.expected, "--columns"));
        imk_log_settings settings = imk_log_default();
        settings.columns = "time [s],-,gyro_y [rad/s]";
        write_file(path, bytes, 128 + 8 * value_size);
        CHECK_STATUS(imk_log_load(path, &settings, NULL, &log, &error), IMK_ERROR_FORMAT);
        remove(path);
    }
}

/* -------------------------------------------------------------------------------------- loading */

static bool count_progress(void *context, const char *stage, const char *unit, uint64_t done,
                           uint64_t total)
{
    uint64_t *last = context;
    assert_string_equal(stage, "reading");
    assert_string_equal(unit, "B");
    assert_true(done >= last[0] && (total == 0 || done <= total));
    last[0] = done;
    last[1]++;
    return true;
}

/* Not what has been fetched ahead, which depends on how much the system gives at a time. */
static void progress_is_what_was_consumed(void **state)
{
    (void)state;
    enum { ROWS = 20000, ROW = 15, TAKEN = 777 };
    const char *path = temporary_path("long.csv"), head[] = "gyro_x [rad/s]\n";
    const size_t begin = sizeof head - 1;
    char *text = malloc(begin + ROWS * ROW + 1);
    assert_non_null(text);
    memcpy(text, head, begin);
    for (size_t row = 0; row < ROWS; row++)
        assert_int_equal(snprintf(text + begin + row * ROW, ROW + 1, "%.12f\n", 1e-5 * (double)row),
                         ROW);
    write_file(path, text, begin + ROWS * ROW);
    imk_log_settings settings = imk_log_default();
    settings.rate = 100;
    imk_log_reader *reader;
    static double values[TAKEN];
    double *const columns[] = {values};
    size_t rows;
    uint64_t done, size;
    CHECK_OK(imk_log_open(path, &settings, &reader, NULL));
    CHECK_OK(imk_log_read(reader, TAKEN, columns, &rows, NULL));
    assert_int_equal(rows, TAKEN);
    imk_log_progress(reader, &done, &size);
    assert_int_equal(done, begin + TAKEN * ROW);
    assert_int_equal(size, begin + ROWS * ROW);
    imk_log_close(reader);
    remove(path);
    free(text);
}

/* A part of a log is what a log of these rows alone would be, by its times or by a rate. */
static void a_part_is_read(void **state)
{
    (void)state;
    enum { ROWS = 3500 };
    char *text = malloc(ROWS * 40 + 100);
    for (int timed = 0; timed < 2; timed++) {
        size_t size = (size_t)sprintf(text, "%sgyro_x [deg/s]\n", timed ? "time [s]," : "");
        for (int i = 0; i < ROWS; i++) {
            size += timed ? (size_t)sprintf(text + size, "%.2f,", 1e9 + 0.01 * i) : 0;
            size += (size_t)sprintf(text + size, i == 10 || i == 1400 ? "nan\n" : "%d\n", i);
        }
        imk_log_settings settings = imk_log_default();
        settings.rate = timed ? 0 : 100;
        settings.after = 12.995;
        settings.before = 24.005;
        table t = read_text(text, &settings);
        const size_t column = t.columns - 1;
        assert_int_equal(t.rows, 1101);
        assert_int_equal(t.findings.rows, 1101);
        assert_int_equal(t.findings.not_finite, 1);
        assert_int_equal(t.findings.first_not_finite, 1401);
        assert_int_equal(t.findings.gaps, 0);
        for (size_t i = 0; i < t.rows; i++)
            assert_true(i == 100 || t.data[column][i] == (double)(1300 + i) * degree);
        if (timed)
            CHECK_CLOSE(t.data[0][0], 13, 1e-6);
        free_table(&t);
        settings.before = 0;
        t = read_text(text, &settings);
        assert_int_equal(t.rows, ROWS - 1300);
        free_table(&t);
        settings.after = 0;
        settings.before = 0.095;
        t = read_text(text, &settings);
        assert_int_equal(t.rows, 10);
        assert_int_equal(t.findings.not_finite, 0);
        free_table(&t);
        settings.before = 0;
        settings.after = 40;
        check_refused(text, size, &settings, IMK_ERROR_EMPTY, 0, "ends after 34.99 s");
        settings.before = 30;
        check_refused(text, size, &settings, IMK_ERROR_RANGE, 0, "--after");
    }
    free(text);
}

static void real_log_loads_whole(void **state)
{
    (void)state;
    const char *path = SHARED_DIRECTORY "/data/static/adis16405_imu1_100hz.csv.gz";
    if (access(path, R_OK) != 0) {
        print_message("%s is not there\n", path);
        skip();
    }
    imk_log_settings settings = imk_log_default();
    settings.rate = 100.0;
    uint64_t progress[2] = {0, 0};
    const imk_job job = {.progress = count_progress, .progress_context = progress};
    imk_log log;
    CHECK_OK(imk_log_load(path, &settings, &job, &log, NULL));
    assert_int_equal(log.rows, 1000000);
    assert_true(progress[1] > 5);
    assert_int_equal(log.findings.not_finite, 0);
    assert_int_equal(imk_log_find(&log, IMK_QUANTITY_SPECIFIC_FORCE, 2), 5);
    /* First row of the file: -0.05,-0.30,0.70,-0.00666,0.00000,-1.01565 */
    CHECK_CLOSE(log.data[0][0], -0.05 * degree, 1e-18);
    CHECK_CLOSE(log.data[5][0], -1.01565 * IMK_STANDARD_GRAVITY, 0.0);
    log.data[0][log.rows] = 0.0; /* there is room for one more */
    imk_log_free(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_texts_are_refused_with_a_remedy),
        cmocka_unit_test(binary_junk_is_refused),
        cmocka_unit_test(very_long_lines_are_refused),
        cmocka_unit_test(missing_files_and_directories_are_refused),
        cmocka_unit_test(settings_are_checked),
        cmocka_unit_test(damaged_gzip_is_an_error_after_its_good_rows),
        cmocka_unit_test(names_and_units_are_understood),
        cmocka_unit_test(every_separator_and_line_end_is_understood),
        cmocka_unit_test(settings_stand_in_for_the_header),
        cmocka_unit_test(axes_are_turned_to_forward_right_down),
        cmocka_unit_test(texts_become_labels),
        cmocka_unit_test(blank_cells_wait),
        cmocka_unit_test(counts_are_said_to_be_whole),
        cmocka_unit_test(increments_are_divided_by_the_interval),
        cmocka_unit_test(increments_behind_lost_rows),
        cmocka_unit_test(microsecond_clocks_keep_their_resolution),
        cmocka_unit_test(findings_count_what_is_wrong),
        cmocka_unit_test(findings_hold_over_many_groups),
        cmocka_unit_test(random_logs_read_the_same_every_way),
        cmocka_unit_test(cut_logs_give_whole_rows),
        cmocka_unit_test(memory_of_exact_size_is_enough),
        cmocka_unit_test(matrices_are_read),
        cmocka_unit_test(progress_is_what_was_consumed),
        cmocka_unit_test(a_part_is_read),
        cmocka_unit_test(real_log_loads_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
