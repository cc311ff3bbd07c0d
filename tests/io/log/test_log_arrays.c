/* SPDX-License-Identifier: Apache-2.0 */
/* Files of NumPy, SciPy, GNU Octave and h5py (arrays/make_fixtures.py), which hold the samples of
 * the formulas below: read to the last bit, or refused with what to do. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include "imukit/io.h"
#include "imukit/log.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define FOLDER SOURCE_DIRECTORY "/tests/io/log/arrays/"

enum { ROWS = 20 };

/* As make_fixtures.py has them. */
static double sample(imk_quantity quantity, int axis, int row)
{
    switch (quantity) {
    case IMK_QUANTITY_TIME:
        return row / 64.0;
    case IMK_QUANTITY_ANGULAR_RATE:
        return (7 * row + 3 * axis - 50) / 1024.0;
    case IMK_QUANTITY_SPECIFIC_FORCE:
        return (5 * row - 11 * axis) / 512.0 - (axis == 2 ? 9.75 : 0.0);
    default:
        return (double)NAN;
    }
}

typedef struct settings {
    const char *time, *gyro, *accel; /* units */
    const char *topic, *columns;
    double gyro_scale, accel_scale, sign; /* numbers of the file are so many of the above */
} settings;

static imk_log_settings settings_of(const settings *s)
{
    imk_log_settings made = imk_log_default();
    made.time_unit = s->time;
    made.gyro_unit = s->gyro;
    made.accel_unit = s->accel;
    made.topic = s->topic;
    made.columns = s->columns;
    return made;
}

/* All samples of time, three gyros and three accelerometers, whatever the order. */
static void check_log(const char *name, settings s)
{
    char path[300];
    imk_log log;
    imk_error error;
    const imk_log_settings made = settings_of(&s);
    snprintf(path, sizeof path, FOLDER "%s", name);
    if (imk_log_load(path, &made, NULL, &log, &error) != IMK_OK) {
        char text[500];
        imk_error_text(&error, name, text, sizeof text);
        fail_msg("%s", text);
    }
    assert_int_equal(log.rows, ROWS);
    size_t known = 0;
    const bool stamps = log.findings.time_origin == 1.7e9;
    for (size_t c = 0; c < log.column_count; c++) {
        const imk_log_column *column = &log.column[c];
        if (column->quantity == IMK_QUANTITY_OTHER)
            continue;
        known++;
        const double scale = column->quantity == IMK_QUANTITY_ANGULAR_RATE     ? s.gyro_scale
                             : column->quantity == IMK_QUANTITY_SPECIFIC_FORCE ? s.accel_scale
                                                                               : 0.0;
        const double sign = s.sign != 0.0 && scale != 0.0 ? s.sign : 1.0;
        for (int row = 0; row < ROWS; row++) {
            double due = sign * sample(column->quantity, column->axis, row);
            if (stamps && column->quantity == IMK_QUANTITY_TIME)
                due = due * 1e9 * 1e-9; /* as whole nanoseconds become seconds */
            if (log.data[c][row] != due * (scale != 0.0 ? scale : 1.0))
                fail_msg("%s: %s, row %d is %.17g", name, column->name, row, log.data[c][row]);
        }
    }
    assert_int_equal(known, 7);
    imk_log_free(&log);
}

static const settings si = {.time = "s", .gyro = "rad/s", .accel = "m/s^2"};

/* Vectors, n x 3, 3 x n, C and Fortran order, stored and deflated, either order of bytes, float32,
 * whole numbers, datetime64, a matrix with names. */
static void npz(void **state)
{
    (void)state;
    check_log("stored.npz", si);
    check_log("deflated.npz", (settings){0});
    check_log("matrix.npz", (settings){0});
    check_log("zip64.npz", (settings){0});
    check_log("named.npz",
              (settings){.columns = "t [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],"
                                    "accel_x [m/s^2],accel_y [m/s^2],accel_z [m/s^2]"});
    check_log(
        "stamps.npz",
        (settings){.gyro = "rad/s", .accel = "m/s^2", .gyro_scale = 1024.0, .accel_scale = 512.0});
}

/* Version 5 as SciPy and Octave write it, compressed or not; structures; units in a structure; the
 * other order of bytes; HDF5 as MATLAB's version 7.3 has it. */
static void mat(void **state)
{
    (void)state;
    check_log("plain.mat", (settings){0});
    check_log("packed.mat", si);
    check_log("octave.mat", (settings){0});
    check_log("big_endian.mat", si);
    check_log("two.mat", (settings){"s", "rad/s", "m/s^2", "left", NULL, 0, 0, 0});
    check_log("two.mat", (settings){"s", "rad/s", "m/s^2", "right", NULL, 1.0, 1.0, -1.0});
    check_log("matlab.mat", (settings){0});
}

/* Chunks that are compressed, transposed arrays in groups, whole numbers of nanoseconds since an
 * epoch, the other order of bytes, records with lists, a matrix with names. */
static void hdf5(void **state)
{
    (void)state;
    check_log("chunked.h5", (settings){0});
    check_log("groups.h5", (settings){.topic = "/left/imu"});
    check_log("groups.h5", (settings){.time = "ns",
                                      .gyro = "rad/s",
                                      .accel = "m/s^2",
                                      .topic = "right",
                                      .gyro_scale = 1024.0});
    check_log("records.h5", (settings){0});
    check_log("matrix.h5", (settings){0});
}

/* scale_factor and add_offset [CF]: of a float32 in a list of one, a double and a whole number, for
 * whole numbers, floats, columns of a matrix and times. */
static void coded(void **state)
{
    (void)state;
    check_log("coded.h5", (settings){.topic = "scaled"});
}

/* A factor that is a text or a list is told, and its dataset not read. NaN as the number for no
 * value, and one that no value can be, are no reason to refuse. */
static void coded_otherwise(void **state)
{
    (void)state;
    static const struct {
        const char *topic, *unread, *kind;
        imk_quantity read;
    } groups[] = {
        {"text", "/text/accel", "dataset whose scale_factor is unclear", IMK_QUANTITY_ANGULAR_RATE},
        {"list", "/list/gyro", "dataset whose scale_factor is unclear",
         IMK_QUANTITY_SPECIFIC_FORCE},
        {"sign", "/sign/gyro", "dataset whose _Unsigned is unclear", IMK_QUANTITY_SPECIFIC_FORCE}};
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++) {
        imk_log log;
        imk_error error;
        const imk_log_settings s = settings_of(&(settings){.topic = groups[i].topic});
        CHECK_OK(imk_log_load(FOLDER "coded.h5", &s, NULL, &log, &error));
        assert_int_equal(log.column_count, 4);
        for (size_t c = 0; c < log.column_count; c++) {
            const imk_quantity q = log.column[c].quantity;
            assert_true(q == IMK_QUANTITY_TIME || q == groups[i].read);
            for (int row = 0; row < ROWS; row++)
                assert_true(log.data[c][row] == sample(q, log.column[c].axis, row));
        }
        assert_int_equal(log.findings.unread, 1);
        assert_string_equal(log.findings.unread_name, groups[i].unread);
        assert_string_equal(log.findings.unread_kind, groups[i].kind);
        imk_log_free(&log);
    }
}

/* Numbers for no value, as make_fixtures.py puts them: rows that lack one, by quantity and axis. A
 * float32 is compared with 1e20 as a float32; the origin is the first stamp that there is,
 * and the date in the unit of the time is passed over. */
static void holes(void **state)
{
    (void)state;
    imk_log log;
    imk_error error;
    const imk_log_settings s = settings_of(&(settings){.topic = "holes"});
    CHECK_OK(imk_log_load(FOLDER "coded.h5", &s, NULL, &log, &error));
    assert_int_equal(log.column_count, 7);
    for (size_t c = 0; c < log.column_count; c++) {
        const imk_quantity q = log.column[c].quantity;
        const int axis = log.column[c].axis;
        for (int row = 0; row < ROWS; row++) {
            const bool none = q == IMK_QUANTITY_TIME ? row == 0 || row == 5
                              : q == IMK_QUANTITY_ANGULAR_RATE
                                  ? (row == 3 && axis == 1) || (row == 4 && axis == 0)
                                  : (row == 7 && axis == 2) || row == 8;
            double due = sample(q, axis, row);
            if (q == IMK_QUANTITY_TIME) /* row 1 is the first that has one */
                due = (double)(15625000 * (row - 1)) * 1e-9;
            if (none ? !isnan(log.data[c][row]) : log.data[c][row] != due)
                fail_msg("%s, row %d is %.17g", log.column[c].name, row, log.data[c][row]);
        }
    }
    imk_log_free(&log);
}

/* The origin of stamps is told. 1.7e18 ns have no digits below 256 as a double. */
static void origin(void **state)
{
    (void)state;
    static const char *const names[] = {"stamps.npz", "groups.h5"};
    for (size_t i = 0; i < 2; i++) {
        char path[300];
        imk_log log;
        imk_error error;
        imk_log_settings s = settings_of(&si);
        s.time_unit = "ns";
        s.topic = i == 1 ? "right" : NULL;
        snprintf(path, sizeof path, FOLDER "%s", names[i]);
        CHECK_OK(imk_log_load(path, &s, NULL, &log, &error));
        assert_true(log.findings.time_origin == 1.7e9);
        size_t time = 0;
        while (log.column[time].quantity != IMK_QUANTITY_TIME)
            time++;
        assert_true(log.data[time][0] == 0.0 && log.data[time][1] == 15625000 * 1e-9);
        imk_log_free(&log);
    }
}

/* timedelta64: whole numbers in the unit of its name. */
static void durations(void **state)
{
    (void)state;
    imk_log log;
    imk_error error;
    imk_log_settings s = settings_of(&si);
    s.time_unit = NULL;
    CHECK_OK(imk_log_load(FOLDER "duration.npz", &s, NULL, &log, &error));
    assert_string_equal(log.column[0].name, "time");
    assert_string_equal(log.column[0].unit.text, "ns");
    for (size_t i = 0; i < ROWS; i++)
        assert_true(log.data[0][i] == (double)i * 15625000 * 1e-9);
    imk_log_free(&log);
}

static void check_refused(const char *name, settings s, imk_status due, const char *text)
{
    char path[300], told[600];
    imk_log_reader *reader = NULL;
    imk_error error;
    const imk_log_settings made = settings_of(&s);
    snprintf(path, sizeof path, FOLDER "%s", name);
    CHECK_STATUS(imk_log_open(path, &made, &reader, &error), due);
    assert_null(reader);
    imk_error_text(&error, name, told, sizeof told);
    if (!strstr(told, text))
        fail_msg("%s: \"%s\", expected in it \"%s\"", name, told, text);
}

static void refusals(void **state)
{
    (void)state;
    check_refused(
        "stored.npz", (settings){0}, IMK_ERROR_UNIT_MISSING,
        "\"time\", \"gyro_x\", \"accel_x\", … have no unit; add --time-unit UNIT --gyro-unit "
        "UNIT --accel-unit UNIT (UNIT is the unit of the log)");
    check_refused("stored.npz", (settings){.gyro = "rad/s"}, IMK_ERROR_UNIT_MISSING,
                  "add --time-unit UNIT --accel-unit UNIT (UNIT");
    check_refused("lengths.npz", (settings){0}, IMK_ERROR_NAME_UNKNOWN,
                  "add --topic gyro (or --topic accel)");
    check_refused("lengths.npz", (settings){.topic = "gyro"}, IMK_ERROR_RATE_MISSING, "--rate");
    check_refused("records.npz", (settings){0}, IMK_ERROR_EMPTY,
                  "\"table\" is a record array; write its fields: numpy.savez(");
    check_refused("half.npz", (settings){.gyro = "rad/s", .accel = "m/s^2"}, IMK_ERROR_RATE_MISSING,
                  "\"t\" is a NumPy array of type <f2; write it as float64");
    check_refused("named.npz", (settings){0}, IMK_ERROR_COLUMN, "add --columns");
    check_refused("named.npz", (settings){.columns = "time,gyro_x"}, IMK_ERROR_COLUMN,
                  "2 names are given for 7 columns; the columns are data column 1, data column 2");
    check_refused("two.mat", (settings){0}, IMK_ERROR_NAME_UNKNOWN, "the log holds 2 sensors");
    check_refused("old.mat", (settings){0}, IMK_ERROR_UNSUPPORTED,
                  "the MAT-file is of version 4; write it in MATLAB as save('log.mat', '-v7')");
    check_refused("table.mat", (settings){0}, IMK_ERROR_EMPTY,
                  "\"data\" is a MATLAB table; write it in MATLAB as a CSV: writetable(");
    check_refused("groups.h5", (settings){0}, IMK_ERROR_NAME_UNKNOWN,
                  "add --topic /left/imu (or --topic /right)");
    check_refused("virtual.h5", (settings){0}, IMK_ERROR_EMPTY,
                  "\"/gyro_x\" is a dataset with values in another file; write the values into");
    check_refused("coded.h5", (settings){.topic = "table"}, IMK_ERROR_NAME_UNKNOWN,
                  "add --topic /holes (or --topic /list, --topic /scaled, ...)");
}

/* What cannot be read is listed beside what can. */
static void streams(void **state)
{
    (void)state;
    imk_log_stream stream[4];
    size_t count = 0;
    const imk_log_format *format;
    imk_error error;
    CHECK_OK(imk_log_streams(FOLDER "groups.h5", NULL, 4, stream, &count, &format, &error));
    assert_int_equal(count, 3);
    assert_string_equal(stream[0].name, "/left/imu");
    assert_string_equal(stream[0].kind, "accel, gyro, t"); /* by name, as h5py made it */
    assert_int_equal(stream[0].samples, ROWS);
    assert_string_equal(stream[1].name, "/right");
    assert_false(stream[2].readable);
    assert_string_equal(stream[2].name, "/elsewhere");
    const imk_log_settings stated = settings_of(&si);
    CHECK_OK(imk_log_streams(FOLDER "linked.h5", &stated, 4, stream, &count, &format, &error));
    assert_int_equal(count, 2); /* gyro and time; a soft link called like a sensor */
    assert_string_equal(stream[1].name, "/imu/accel");
    assert_string_equal(stream[1].kind, "soft link");
    CHECK_OK(imk_log_streams(FOLDER "matlab.mat", NULL, 4, stream, &count, &format, &error));
    assert_int_equal(count, 2);
    assert_string_equal(stream[0].name, "");
    assert_false(stream[1].readable);
    assert_string_equal(stream[1].kind, "MATLAB table");
}

/* A sensor that is there and cannot be read is told and listed: half precision, complex numbers
 * beside an array of three dimensions, a compression that libhdf5 does not have. */
static void unread(void **state)
{
    (void)state;
    static const struct {
        const char *name, *found, *kind;
        size_t count;
    } files[] = {{"unread.npz", "gyro", "NumPy array of type <f2", 1},
                 {"unread.mat", "wide", "MATLAB array of 3 dimensions", 2},
                 {"unread.h5", "/gyro", "dataset of a compression libhdf5 lacks", 1},
                 {"plain.mat", "", "", 0}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char path[300];
        imk_log log;
        imk_error error;
        imk_log_stream stream[4];
        size_t count = 0;
        const imk_log_settings s = settings_of(&si);
        snprintf(path, sizeof path, FOLDER "%s", files[i].name);
        CHECK_OK(imk_log_load(path, &s, NULL, &log, &error));
        assert_int_equal(log.rows, ROWS);
        assert_int_equal(log.findings.unread, files[i].count);
        assert_string_equal(log.findings.unread_name, files[i].found);
        assert_string_equal(log.findings.unread_kind, files[i].kind);
        imk_log_free(&log);
        CHECK_OK(imk_log_streams(path, &s, 4, stream, &count, NULL, &error));
        assert_int_equal(count, 1 + files[i].count);
        assert_true(stream[0].readable && (count == 1 || !stream[1].readable));
    }
}

/* From the middle: packed arrays cannot, the others give the rows from there. */
static void seek(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        imk_status due;
    } files[] = {{"stored.npz", IMK_OK},
                 {"plain.mat", IMK_OK},
                 {"chunked.h5", IMK_OK},
                 {"deflated.npz", IMK_ERROR_UNSUPPORTED}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char path[300];
        double time[ROWS], *columns[IMK_LOG_COLUMNS_MAX] = {NULL};
        size_t rows = 0;
        imk_log_reader *reader = NULL;
        imk_error error;
        const imk_log_settings s = settings_of(&si);
        snprintf(path, sizeof path, FOLDER "%s", files[i].name);
        CHECK_OK(imk_log_open(path, &s, &reader, &error));
        columns[imk_log_column_find(reader, IMK_QUANTITY_TIME, -1)] = time;
        CHECK_OK(imk_log_read(reader, 3, columns, &rows, &error));
        CHECK_STATUS(imk_log_seek(reader, 0.5, &error), files[i].due);
        if (files[i].due == IMK_OK) {
            CHECK_OK(imk_log_read(reader, ROWS, columns, &rows, &error));
            assert_int_equal(rows, ROWS / 2);
            assert_true(time[0] == ROWS / 2 / 64.0);
        }
        imk_log_close(reader);
    }
}

/* ---- damage ---------------------------------------------------------------------------------- */

static char copy_path[64];

static void put_copy(const char *bytes, size_t size)
{
    FILE *file = fopen(copy_path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* Read it all, or be refused with a message. @return the rows; -1: refused */
static long try(void)
{
    imk_log log;
    imk_error error = {.status = IMK_OK};
    const imk_log_settings s = settings_of(&si);
    const imk_status status = imk_log_load(copy_path, &s, NULL, &log, &error);
    if (status == IMK_OK) {
        const long rows = (long)log.rows;
        imk_log_free(&log);
        return rows;
    }
    char text[600];
    assert_int_equal(error.status, status);
    assert_true(imk_error_text(&error, "copy", text, sizeof text) < sizeof text);
    return -1;
}

static size_t read_fixture(const char *name, char bytes[16384])
{
    char path[300];
    snprintf(path, sizeof path, FOLDER "%s", name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, 16384, file);
    fclose(file);
    return size;
}

/* A block of the user's own before the file, which begins at 512, 1024, 2048, ... [HDF5]. */
static void user_block(void **state)
{
    (void)state;
    enum { MOST = 2048 };
    static char bytes[MOST + 16384];
    for (size_t block = 512; block <= MOST; block *= 2) {
        memset(bytes, '#', block);
        put_copy(bytes, block + read_fixture("chunked.h5", bytes + block));
        assert_int_equal(try(), ROWS);
    }
}

/* Whatever is left of a file, it is not taken for a whole log. Of HDF5 every attempt is a process.
 */
static void cut(void **state)
{
    (void)state;
    static const char *const names[] = {"stored.npz", "deflated.npz", "plain.mat", "packed.mat",
                                        "chunked.h5"};
    static char bytes[16384];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const size_t size = read_fixture(names[i], bytes);
        const size_t step = i == 4 ? 611 : check_quick() ? 29 : 1;
        put_copy(bytes, size);
        assert_int_equal(try(), ROWS);
        for (size_t left = size - 1; left > step; left -= step) {
            assert_int_equal(truncate(copy_path, (off_t)left), 0);
            /* The units of plain.mat come last, and the settings state them. A whole variable less
             * is less than seven columns, but a log. */
            if (try() == ROWS && i != 2 && i != 3)
                fail_msg("%s is whole after %zu of %zu bytes", names[i], left, size);
        }
    }
}

/* xorshift64 [MARSAGLIA2003] */
static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Of an HDF5 file with changed bytes libhdf5 may crash, and this program does not. */
static void changed(void **state)
{
    (void)state;
    static const char *const names[] = {"chunked.h5", "groups.h5", "records.h5", "matlab.mat"};
    static char bytes[16384];
    uint64_t random = 88172645463325252u;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        for (int k = 0; k < (check_quick() ? 3 : 12); k++) {
            const size_t size = read_fixture(names[i], bytes);
            for (int n = 0; n < 4; n++)
                bytes[512 + next_random(&random) % (size - 512)] = (char)next_random(&random);
            put_copy(bytes, size);
            try();
        }
}

/* A member's CRC is compared: one bit of a value of a stored vector. */
static void checksum(void **state)
{
    (void)state;
    static char bytes[16384];
    imk_log_settings s = settings_of(&si);
    imk_log log;
    imk_error error;
    const size_t size = read_fixture("stored.npz", bytes);
    bytes[200] ^= 1; /* t.npy is the first member: 55 bytes of its head, 128 of the array's */
    put_copy(bytes, size);
    CHECK_STATUS(imk_log_load(copy_path, &s, NULL, &log, &error), IMK_ERROR_FORMAT);
    assert_string_equal(error.found, "\"t.npy\" does not have the checksum that is stated for it");
    /* Columns that follow each other are read at several places of the member. */
    bytes[200] ^= 1;
    size_t at = 0;
    while (memcmp(bytes + at, "accel.npy", 9) != 0)
        at++;
    bytes[at + 9 + 128 + 40] ^= 1;
    put_copy(bytes, size);
    CHECK_STATUS(imk_log_load(copy_path, &s, NULL, &log, &error), IMK_ERROR_FORMAT);
    assert_string_equal(error.found,
                        "\"accel.npy\" does not have the checksum that is stated for it");
}

/* zlib's own checksum is compared in a MAT-file: no flipped bit gives other values. */
static void packed_bits(void **state)
{
    (void)state;
    static char bytes[16384];
    const imk_log_settings s = settings_of(&si);
    const size_t size = read_fixture("packed.mat", bytes), step = check_quick() ? 7 : 1;
    size_t refused = 0;
    for (size_t at = 128; at < size; at += step) {
        imk_log log;
        imk_error error;
        bytes[at] ^= 1;
        put_copy(bytes, size);
        bytes[at] ^= 1;
        if (imk_log_load(copy_path, &s, NULL, &log, &error) != IMK_OK) {
            refused++;
            continue;
        }
        for (size_t c = 0; c < log.column_count; c++)
            for (int row = 0; row < ROWS && log.column[c].quantity != IMK_QUANTITY_OTHER; row++)
                if (log.data[c][row] != sample(log.column[c].quantity, log.column[c].axis, row))
                    fail_msg("byte %zu: %s, row %d", at, log.column[c].name, row);
        imk_log_free(&log);
    }
    assert_true(refused > (size - 128) / step / 2);
}

static int set_up(void **state)
{
    (void)state;
    snprintf(copy_path, sizeof copy_path, "/tmp/test_log_arrays_%ld", (long)getpid());
    return 0;
}

static int clean_up(void **state)
{
    (void)state;
    unlink(copy_path);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(npz),         cmocka_unit_test(mat),
        cmocka_unit_test(hdf5),        cmocka_unit_test(origin),
        cmocka_unit_test(refusals),    cmocka_unit_test(streams),
        cmocka_unit_test(seek),        cmocka_unit_test(cut),
        cmocka_unit_test(changed),     cmocka_unit_test(checksum),
        cmocka_unit_test(packed_bits), cmocka_unit_test(unread),
        cmocka_unit_test(coded),       cmocka_unit_test(coded_otherwise),
        cmocka_unit_test(holes),       cmocka_unit_test(user_block),
        cmocka_unit_test(durations),
    };
    return cmocka_run_group_tests(tests, set_up, clean_up);
}
