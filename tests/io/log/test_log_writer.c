/* SPDX-License-Identifier: Apache-2.0 */
/* Writing logs: exact texts, numbers that read back, bytes that do not depend on threads or calls,
 * .npy heads. */
#define _POSIX_C_SOURCE 200809L
#include "imukit/decimal.h"
#include "imukit/log.h"
#include "imukit/thread_pool.h"

#include "io/file/input_stream_internal.h"
#include "io/log/fixed_decimal_internal.h"
#include "io/log/log_format_internal.h"
#include "io/log/npy_internal.h"

#include "check.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PI 3.14159265358979323846

static char directory[64];

static const char *path_of(const char *name)
{
    static char paths[4][128];
    static unsigned next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

/* splitmix64 [STEELE2014]: good enough to choose test values */
static uint64_t random_state = 1;
static uint64_t random_bits(void)
{
    uint64_t z = random_state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

/* Uniform in -1 … 1. */
static double random_number(void)
{
    return (double)(int64_t)random_bits() * 0x1p-63;
}

/* Decoded content from malloc(), with a zero behind it. */
static char *content_of(const char *path, size_t *size)
{
    imki_input *input;
    size_t total = 0, got, capacity = 1 << 16;
    char *content = malloc(capacity);
    CHECK_OK(imki_input_open(path, &input, NULL));
    for (;;) {
        CHECK_OK(imki_input_read(input, content + total, capacity - total - 1, &got, NULL));
        if (got == 0)
            break;
        total += got;
        if (capacity - total < 1 << 15)
            content = realloc(content, capacity *= 2);
        assert_non_null(content);
    }
    imki_input_close(input);
    content[total] = '\0';
    *size = total;
    return content;
}

static imk_log_column column_of(const char *name, const char *unit, double scale, double offset)
{
    imk_log_column column = {.axis = -1, .unit = {.scale = scale, .offset = offset}};
    snprintf(column.name, sizeof column.name, "%s", name);
    snprintf(column.unit.text, sizeof column.unit.text, "%s", unit);
    return column;
}

static void check_text(const char *path, const char *expected)
{
    size_t size;
    char *content = content_of(path, &size);
    assert_string_equal(content, expected);
    free(content);
    unlink(path);
}

static void exact_text(void **state)
{
    (void)state;
    const imk_log_column described[] = {
        column_of("time", "s", 1.0, 0.0), column_of("gyro_x", "deg/s", PI / 180.0, 0.0),
        column_of("accel_x", "g", 9.80665, 0.0), column_of("temperature", "degC", 1.0, 273.15),
        column_of("flag", "", 1.0, 0.0)};
    const double time[] = {0.0, 0.01, 1e6},
                 gyro[] = {0.1 * (PI / 180.0), -90.0 * (PI / 180.0), 0.0};
    const double accel[] = {9.80665, -0.5 * 9.80665, (double)NAN};
    const double temperature[] = {20.0 + 273.15, 273.15, -12.375 + 273.15};
    const double flag[] = {1.0, -0.0, (double)-INFINITY};
    const double *columns[] = {time, gyro, accel, temperature, flag};
    const int decimals[] = {2, 3, 4, 1, 0};
    const char *header = "# made by a test\n# in two lines\n"
                         "time [s],gyro_x [deg/s],accel_x [g],temperature [degC],flag\n";
    for (int precision = IMK_LOG_SHORTEST; precision <= IMK_LOG_FIXED; precision++) {
        imk_log_writer *writer;
        imk_error error;
        char expected[512];
        CHECK_OK(imk_log_create(path_of("a.csv"), 5, described, (imk_log_precision)precision,
                                decimals, 0, &writer, &error));
        CHECK_OK(imk_log_comment(writer, "made by a test\nin two lines\n"));
        CHECK_OK(imk_log_write(writer, 3, columns, NULL));
        CHECK_STATUS(imk_log_comment(writer, "too late"), IMK_ERROR_ARGUMENT);
        assert_int_equal(access(path_of("a.csv"), F_OK), -1);
        CHECK_OK(imk_log_commit(writer, &error));
        /* -12.375 to one decimal is a tie: to the even digit, as printf rounds */
        snprintf(expected, sizeof expected, "%s%s", header,
                 precision == IMK_LOG_FIXED
                     ? "0.00,0.100,1.0000,20.0,1\n0.01,-90.000,-0.5000,0.0,-0\n"
                       "1000000.00,0.000,nan,-12.4,-inf\n"
                     : "0,0.1,1,20,1\n0.01,-90,-0.5,0,-0\n1000000,0,nan,-12.375,-inf\n");
        check_text(path_of("a.csv"), expected);
    }
}

static char labels_context[1];
static const char *label_of(void *context, size_t index)
{
    static const char *const labels[] = {"level", "turn x, slow", "a \"b\"", ""};
    assert_ptr_equal(context, labels_context);
    return index < 4 ? labels[index] : NULL;
}

static void labels(void **state)
{
    (void)state;
    imk_log_column described[2] = {column_of("time", "s", 1.0, 0.0),
                                   column_of("section", "", 1.0, 0.0)};
    described[1].label = true;
    const double time[] = {0, 1, 2, 3, 4, 5}, section[] = {0, 1, 2, 3, 4, (double)NAN};
    const double *columns[] = {time, section};
    for (int with = 0; with < 2; with++) {
        imk_log_writer *writer;
        CHECK_OK(imk_log_create(path_of("a.csv"), 2, described, IMK_LOG_SHORTEST, NULL, 0, &writer,
                                NULL));
        if (with)
            imk_log_write_labels(writer, label_of, labels_context);
        CHECK_OK(imk_log_write(writer, 6, columns, NULL));
        CHECK_OK(imk_log_commit(writer, NULL));
        check_text(path_of("a.csv"),
                   with ? "time [s],section\n0,level\n1,\"turn x, slow\"\n2,\"a 'b'\"\n3,\"\"\n"
                          "4,4\n5,nan\n"
                        : "time [s],section\n0,0\n1,1\n2,2\n3,3\n4,4\n5,nan\n");
    }
}

static void header_alone(void **state)
{
    (void)state;
    const imk_log_column described[] = {column_of("time", "s", 1.0, 0.0)};
    imk_log_writer *writer;
    CHECK_OK(
        imk_log_create(path_of("a.csv"), 1, described, IMK_LOG_SHORTEST, NULL, 0, &writer, NULL));
    CHECK_OK(imk_log_comment(writer, ""));
    CHECK_OK(imk_log_commit(writer, NULL));
    check_text(path_of("a.csv"), "# \ntime [s]\n");
}

/* Fixed decimals are printf's, on all magnitudes, ties, carries and signs. */
static void fixed_is_printf(void **state)
{
    (void)state;
    static const double special[] = {
        0.0,    -0.0,          0.5,         1.5,      2.5,
        9.5,    99999999.0,    99999998.75, 1e16,     123456789.0,
        5e-324, 1.7976931e308, 9.999999995, 0.999999, 922.3372036854776,
        1e-5,   0.125,         1e22,        -0.5,     8388607.5};
    for (int decimals = 0; decimals <= 17; decimals++) {
        const imki_fixed_decimal format = imki_fixed_decimal_of(decimals);
        for (size_t i = 0; i < 20000; i++) {
            double x = random_number();
            if (i % 4 == 1) /* a tie at some number of decimals */
                x = floor(x * 8388608.0) / (double)(1 << (random_bits() % 20));
            else if (i % 4 == 2) /* any magnitude */
                x *= exp2((double)((int)(random_bits() % 160) - 80));
            else if (i % 4 == 3) /* as logs have them */
                x *= 12.0;
            if (i < sizeof special / sizeof special[0])
                x = special[i];
            char text[IMK_DECIMAL_SIZE + IMKI_FIXED_SLACK], expected[IMK_DECIMAL_SIZE];
            *imki_fixed_decimal_write(&format, x, text) = '\0';
            snprintf(expected, sizeof expected, "%.*f", decimals, x);
            if (strcmp(text, expected) != 0)
                fail_msg("%.17g with %d decimals is %s, expected %s", x, decimals, text, expected);
        }
    }
}

/* Any doubles in SI columns read back bit by bit. */
static void shortest_reads_back(void **state)
{
    (void)state;
    enum { ROWS = 5000, COLUMNS = 5 };
    static double data[COLUMNS][ROWS];
    const double *columns[COLUMNS];
    imk_log_column described[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        char name[8];
        snprintf(name, sizeof name, "c%d", i);
        described[i] = column_of(name, "rad/s", 1.0, 0.0);
        columns[i] = data[i];
        for (size_t row = 0; row < ROWS; row++) {
            const uint64_t bits = random_bits();
            memcpy(&data[i][row], &bits, sizeof bits); /* any bit pattern */
            if (i > 2 || isnan(data[i][row]))
                data[i][row] = random_number();
        }
    }
    imk_log_writer *writer;
    CHECK_OK(imk_log_create(path_of("a.csv"), COLUMNS, described, IMK_LOG_SHORTEST, NULL, 0,
                            &writer, NULL));
    CHECK_OK(imk_log_write(writer, ROWS, columns, NULL));
    CHECK_OK(imk_log_commit(writer, NULL));
    size_t size;
    char *content = content_of(path_of("a.csv"), &size);
    char *at = strchr(content, '\n') + 1;
    for (size_t row = 0; row < ROWS; row++)
        for (int i = 0; i < COLUMNS; i++) {
            char *end;
            const double number = strtod(at, &end);
            assert_memory_equal(&number, &data[i][row], sizeof number);
            assert_int_equal(*end, i == COLUMNS - 1 ? '\n' : ',');
            at = end + 1;
        }
    assert_ptr_equal(at, content + size);
    free(content);
    unlink(path_of("a.csv"));
}

typedef struct tested_unit {
    const char *text;
    double scale, offset;
    int digits;   /* significant digits that always survive */
    int decimals; /* the same for a unit with an offset, whose SI values are coarse near it */
} tested_unit;

static const tested_unit units[] = {
    {"deg/s", PI / 180.0, 0.0, 15, 0},
    {"deg/h", PI / 180.0 / 3600.0, 0.0, 15, 0},
    {"arcsec", PI / 648000.0, 0.0, 15, 0},
    {"g", 9.80665, 0.0, 15, 0},
    {"ug", 9.80665e-6, 0.0, 15, 0},
    {"ms", 1e-3, 0.0, 15, 0},
    {"h", 3600.0, 0.0, 15, 0},
    {"degC", 1.0, 273.15, 0, 11},
};
enum { UNITS = sizeof units / sizeof units[0] };

/* number -> SI -> number gives the same text. 15 digits survive: a relative step of 1e-15 is above
 * twice the spacing of doubles (2.2e-16), so at most one such number reads back to an SI value.
 * Below 1000 K doubles are 1.2e-13 apart or less, a hundredth of the 11th decimal. */
static void text_survives_reading_and_writing(void **state)
{
    (void)state;
    for (size_t u = 0; u < UNITS; u++) {
        imki_column_format column;
        imki_column_format_set(&column, units[u].scale, units[u].offset, 0);
        for (int i = 0; i < 20000; i++) {
            char text[IMK_DECIMAL_SIZE], again[IMK_DECIMAL_SIZE];
            double number;
            size_t length;
            /* in steps, since the order in which arguments are evaluated is not fixed */
            const double uniform = random_number();
            const int fewer = (int)(random_bits() % 11), power = (int)(random_bits() % 20) - 10;
            if (units[u].digits > 0)
                length = imk_decimal_significant(uniform * pow(10.0, power),
                                                 units[u].digits - fewer, text);
            else
                length = imk_decimal_fixed(uniform * 100.0, units[u].decimals - fewer, text);
            imk_decimal_parse(text, text + length, &number);
            number += 0.0; /* -0 becomes 0, as an SI value cannot tell them with an offset */
            const double value = units[u].scale * number + units[u].offset;
            imk_decimal_shortest(number, text);
            imk_decimal_shortest(imki_log_in_unit(&column, value), again);
            if (strcmp(text, again) != 0)
                fail_msg("%s %s comes back as %s", text, units[u].text, again);
        }
    }
}

/* An arbitrary SI value comes back exactly whenever some double in the unit reads back to it, and
 * moves by one unit in the last place otherwise. */
static void value_survives_if_possible(void **state)
{
    (void)state;
    for (size_t u = 0; u < UNITS; u++) {
        imki_column_format column;
        const double scale = units[u].scale, offset = units[u].offset;
        imki_column_format_set(&column, scale, offset, 0);
        size_t same = 0;
        for (int i = 0; i < 20000; i++) {
            const double uniform = random_number();
            const double value =
                offset + scale * uniform * exp2((double)(random_bits() % 40) - 20.0);
            const double number = imki_log_in_unit(&column, value);
            const double plain = (value - offset) / scale;
            bool possible = false;
            const double near[] = {plain, nextafter(plain, -1e9), nextafter(plain, 1e9)};
            for (int j = 0; j < 3; j++)
                possible = possible || scale * near[j] + offset == value;
            const double back = scale * number + offset;
            if (possible)
                assert_true(back == value);
            else
                assert_true(back == nextafter(value, -1e9) || back == nextafter(value, 1e9));
            same += back == value;
        }
        assert_true(same > 16000); /* 84 to 100 %, by unit; binomial sd 0.3 % */
    }
    imki_column_format column; /* what cannot be scaled stays what it is */
    imki_column_format_set(&column, PI / 180.0, 0.0, 0);
    assert_true(isnan(imki_log_in_unit(&column, (double)NAN)));
    assert_true(imki_log_in_unit(&column, (double)INFINITY) == (double)INFINITY);
    CHECK_RELATIVE(imki_log_in_unit(&column, 1e-300), 1e-300 * 180.0 / PI, 1e-15);
    CHECK_RELATIVE(imki_log_in_unit(&column, -1e300), -1e300 * 180.0 / PI, 1e-15);
    assert_true(imki_log_in_unit(&column, 0.0) == 0.0);
}

enum { LOG_ROWS = 16000, LOG_COLUMNS = 4 };
static double log_data[LOG_COLUMNS][LOG_ROWS];

/* Write the log in calls of random sizes. @param seed  of the sizes; 0: one call */
static void write_log(const char *path, imk_log_precision precision, uint64_t row_count,
                      const imk_executor *executor, uint64_t seed)
{
    const imk_log_column described[LOG_COLUMNS] = {
        column_of("time", "s", 1.0, 0.0), column_of("gyro_x", "deg/s", PI / 180.0, 0.0),
        column_of("accel_x", "m/s^2", 1.0, 0.0), column_of("accel_y", "g", 9.80665, 0.0)};
    const int decimals[LOG_COLUMNS] = {3, 7, 6, 8};
    imk_log_writer *writer;
    imk_error error;
    CHECK_OK(imk_log_create(path, LOG_COLUMNS, described, precision, decimals, row_count, &writer,
                            &error));
    random_state = seed;
    for (size_t row = 0; row < LOG_ROWS;) {
        const uint64_t magnitude = random_bits() % 14;
        size_t rows = seed == 0 ? LOG_ROWS : random_bits() % (1u << magnitude);
        rows = rows < LOG_ROWS - row ? rows : LOG_ROWS - row;
        const double *columns[LOG_COLUMNS];
        for (int i = 0; i < LOG_COLUMNS; i++)
            columns[i] = log_data[i] + row;
        CHECK_OK(imk_log_write(writer, rows, columns, executor));
        row += rows;
    }
    CHECK_OK(imk_log_commit(writer, &error));
}

static void make_log(void)
{
    for (size_t row = 0; row < LOG_ROWS; row++) {
        log_data[0][row] = 0.01 * (double)row;
        for (int i = 1; i < LOG_COLUMNS; i++)
            log_data[i][row] = random_number();
    }
    log_data[2][777] = 1.5e308; /* 309 digits: a block grows */
}

static void bytes_depend_on_neither_threads_nor_calls(void **state)
{
    (void)state;
    static const char *const names[] = {"a.csv", "a.csv.gz", "a.csv.zst", "a.npy"};
    make_log();
    for (int way = 0; way < 5; way++) {
        const char *name = names[way < 4 ? way : 0];
        const imk_log_precision precision = way < 4 ? IMK_LOG_SHORTEST : IMK_LOG_FIXED;
        size_t expected_size, size;
        write_log(path_of(name), precision, 0, NULL, 0);
        char *expected = content_of(path_of(name), &expected_size);
        const bool slow = way == 1 || way == 2; /* the compression */
        for (size_t threads = slow ? 3 : 1; threads <= (slow ? 3 : 4); threads++) {
            imk_thread_pool *pool = imk_thread_pool_create(threads);
            const imk_executor executor = imk_thread_pool_executor(pool);
            write_log(path_of(name), precision, 0, &executor, threads - 1);
            char *content = content_of(path_of(name), &size);
            assert_int_equal(size, expected_size);
            assert_memory_equal(content, expected, size);
            free(content);
            imk_thread_pool_destroy(pool);
        }
        free(expected);
        unlink(path_of(name));
    }
    unlink(path_of("a.npy.columns"));
}

/* The head is the one numpy.save() of NumPy 1.24 writes for this shape, but for the blanks that
 * leave room for a longer one. */
static void npy_file(void **state)
{
    (void)state;
    static const char *const names[] = {"a.npy", "a.npy.gz", "a.npy.zst"};
    make_log();
    for (int way = 0; way < 3; way++) {
        size_t size;
        write_log(path_of(names[way]), IMK_LOG_SHORTEST, way == 0 ? 0 : LOG_ROWS, NULL, 5);
        char *content = content_of(path_of(names[way]), &size);
        const char head[] = "\x93NUMPY\x01\x00\x76\x00"
                            "{'descr': '<f8', 'fortran_order': False, 'shape': (16000, 4), }";
        assert_int_equal(size, 128 + LOG_ROWS * LOG_COLUMNS * sizeof(double));
        assert_memory_equal(content, head, sizeof head - 1);
        for (size_t i = sizeof head - 1; i < 127; i++)
            assert_int_equal(content[i], ' ');
        assert_int_equal(content[127], '\n');
        imki_npy npy;
        CHECK_OK(imki_npy_header_read(content, size, &npy, NULL));
        assert_int_equal(npy.rows, LOG_ROWS);
        assert_int_equal(npy.columns, LOG_COLUMNS);
        assert_int_equal(npy.value_size, 8);
        assert_int_equal(npy.header_size, 128);
        const double scale[LOG_COLUMNS] = {1.0, PI / 180.0, 1.0, 9.80665};
        for (size_t row = 0; row < LOG_ROWS; row++)
            for (size_t i = 0; i < LOG_COLUMNS; i++) {
                double number;
                memcpy(&number, content + 128 + 8 * (LOG_COLUMNS * row + i), sizeof number);
                /* one rounding in the quotient, half a unit in the last place of 15 digits */
                CHECK_RELATIVE(number, log_data[i][row] / scale[i], 2e-15);
            }
        free(content);
        unlink(path_of(names[way]));
        char names_file[64];
        snprintf(names_file, sizeof names_file, "%s.columns", names[way]);
        check_text(path_of(names_file), "time [s]\ngyro_x [deg/s]\naccel_x [m/s^2]\naccel_y [g]\n");
    }
}

/* A .npy whose head cannot be corrected afterwards needs the true number of rows before. */
static void npy_row_count(void **state)
{
    (void)state;
    const imk_log_column described[] = {column_of("time", "s", 1.0, 0.0)};
    const double time[] = {1.0, 2.0};
    const double *columns[] = {time};
    imk_log_writer *writer = NULL;
    imk_error error;
    CHECK_STATUS(imk_log_create(path_of("a.npy.gz"), 1, described, IMK_LOG_SHORTEST, NULL, 0,
                                &writer, &error),
                 IMK_ERROR_UNSUPPORTED);
    assert_null(writer);
    CHECK_OK(imk_log_create(path_of("a.npy.gz"), 1, described, IMK_LOG_SHORTEST, NULL, 3, &writer,
                            &error));
    CHECK_OK(imk_log_write(writer, 2, columns, NULL));
    CHECK_STATUS(imk_log_commit(writer, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.found, "2 rows are written, but 3 were announced");
    assert_int_equal(access(path_of("a.npy.gz"), F_OK), -1);
    assert_int_equal(access(path_of("a.npy.gz.columns"), F_OK), -1);

    CHECK_OK(imk_log_create(path_of("a.npy"), 1, described, IMK_LOG_SHORTEST, NULL, 3, &writer,
                            &error)); /* a plain file is put right */
    CHECK_OK(imk_log_write(writer, 2, columns, NULL));
    CHECK_OK(imk_log_commit(writer, &error));
    size_t size;
    char *content = content_of(path_of("a.npy"), &size);
    imki_npy npy;
    CHECK_OK(imki_npy_header_read(content, size, &npy, NULL));
    assert_int_equal(npy.rows, 2);
    free(content);
    unlink(path_of("a.npy"));
    unlink(path_of("a.npy.columns"));
}

static void check_npy_head(const char *dictionary, imk_status status, const char *found)
{
    for (char version = 1; version <= 3; version++) {
        char head[256];
        const size_t prefix = version == 1 ? 10 : 12, length = strlen(dictionary);
        const char magic[12] = {'\x93', 'N', 'U', 'M', 'P', 'Y', version, 0, (char)length, 0, 0, 0};
        memcpy(head, magic, sizeof magic);
        memcpy(head + prefix, dictionary, length);
        assert_int_equal(imki_npy_header_size(head), prefix + length);
        imki_npy npy;
        imk_error error = {0};
        CHECK_STATUS(imki_npy_header_read(head, prefix + length, &npy, &error), status);
        if (status != IMK_OK)
            assert_string_equal(error.found, found);
        else
            assert_int_equal(npy.header_size, prefix + length);
        /* cut anywhere it is damaged, and nothing is read beyond */
        char *exact = malloc(prefix + length - 1);
        memcpy(exact, head, prefix + length - 1);
        CHECK_STATUS(imki_npy_header_read(exact, prefix + length - 1, &npy, NULL),
                     IMK_ERROR_FORMAT);
        free(exact);
    }
}

static void npy_heads(void **state)
{
    (void)state;
    const char *damaged = "the dictionary of the .npy file is damaged";
    check_npy_head("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }\n", IMK_OK, "");
    check_npy_head("{\"shape\":(3,),\"fortran_order\":False,\"descr\":\"<f4\"}", IMK_OK, "");
    check_npy_head("{'descr': '>f8', 'fortran_order': False, 'shape': (3, 4), }",
                   IMK_ERROR_UNSUPPORTED, "the array type '>f8' is not supported");
    check_npy_head("{'descr': '<i8', 'fortran_order': False, 'shape': (3, 4), }",
                   IMK_ERROR_UNSUPPORTED, "the array type '<i8' is not supported");
    check_npy_head("{'descr': '<f8', 'fortran_order': True, 'shape': (3, 4), }",
                   IMK_ERROR_UNSUPPORTED, "the array is in Fortran order");
    check_npy_head("{'descr': '<f8', 'fortran_order': False, 'shape': (), }", IMK_ERROR_UNSUPPORTED,
                   "the array has 0 dimensions");
    check_npy_head("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4, 5), }",
                   IMK_ERROR_UNSUPPORTED, "the array has 3 dimensions");
    check_npy_head("{'descr': '<f8', 'fortran_order': False, }", IMK_ERROR_FORMAT, damaged);
    check_npy_head("{'descr': '<f8', 'fortran_order': False, 'shape': (3, x), }", IMK_ERROR_FORMAT,
                   damaged);
    check_npy_head("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (3,), }",
                   IMK_ERROR_UNSUPPORTED, "the array type 'record' is not supported");
    check_npy_head("{'descr': [('a', '<f8'), 'fortran_order': False, 'shape': (3,), }",
                   IMK_ERROR_FORMAT, damaged);
    check_npy_head("{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551616,), }",
                   IMK_ERROR_FORMAT, damaged);
    check_npy_head("{'descr': '<f8', 'fortran", IMK_ERROR_FORMAT, damaged);
    check_npy_head("{}", IMK_ERROR_FORMAT, damaged);
    assert_int_equal(imki_npy_header_size("time [s],gyr"), 0);
    assert_int_equal(imki_npy_header_size("\x93NUMPY\x04\x00\x76\x00\x00\x00"), 0);
    char header[IMKI_NPY_HEADER_SIZE]; /* the greatest shape fits */
    imki_npy npy;
    imki_npy_header_write(UINT64_MAX, UINT64_MAX, header);
    CHECK_OK(imki_npy_header_read(header, sizeof header, &npy, NULL));
    assert_true(npy.rows == UINT64_MAX && npy.columns == UINT64_MAX);
}

/* What the reader makes of our files: the same doubles, columns and units. */
static void reader_and_writer_agree(void **state)
{
    (void)state;
    static const char *const names[] = {"a.csv", "a.csv.gz", "a.csv.zst", "a.npy",
                                        "a.npz", "a.mat",    "a.h5"};
    make_log();
    log_data[2][777] = -1.5; /* the reader takes lines of this length in its fast way */
    for (size_t way = 0; way < sizeof names / sizeof names[0]; way++) {
        const imk_log_settings settings = imk_log_default();
        imk_error error;
        imk_log log;
        write_log(path_of(names[way]), IMK_LOG_SHORTEST, 0, NULL, 0);
        CHECK_OK(imk_log_load(path_of(names[way]), &settings, NULL, &log, &error));
        assert_int_equal(log.rows, LOG_ROWS);
        assert_int_equal(log.column_count, LOG_COLUMNS);
        assert_string_equal(log.column[1].name, "gyro_x");
        assert_string_equal(log.column[1].unit.text, "deg/s");
        assert_int_equal(log.findings.gaps, 0);
        for (int i = 0; i < LOG_COLUMNS; i++)
            for (size_t row = 0; row < LOG_ROWS; row++) {
                /* deg/s and g: see value_survives_if_possible() */
                const double expected = log_data[i][row], got = log.data[i][row];
                if (i == 0 || i == 2)
                    assert_true(got == expected);
                else
                    assert_true(got == expected || got == nextafter(expected, -9.0) ||
                                got == nextafter(expected, 9.0));
            }
        imk_log_free(&log);
        unlink(path_of(names[way]));
    }
    unlink(path_of("a.npy.columns"));
}

static void check_refused(size_t count, const imk_log_column *described, const int *decimals,
                          imk_status status)
{
    imk_log_writer *writer = NULL;
    imk_error error;
    CHECK_STATUS(imk_log_create(path_of("a.csv"), count, described, IMK_LOG_FIXED, decimals, 0,
                                &writer, &error),
                 status);
    assert_null(writer);
    assert_int_equal(error.status, status);
}

static void refusals(void **state)
{
    (void)state;
    imk_log_column described[2] = {column_of("a", "s", 1.0, 0.0), column_of("b", "s", 1.0, 0.0)};
    const int decimals[2] = {3, 3}, negative[2] = {3, -1}, many[2] = {3, 18};
    check_refused(0, described, decimals, IMK_ERROR_ARGUMENT);
    check_refused(65, described, decimals, IMK_ERROR_ARGUMENT);
    check_refused(2, described, NULL, IMK_ERROR_ARGUMENT);
    check_refused(2, described, negative, IMK_ERROR_ARGUMENT);
    check_refused(2, described, many, IMK_ERROR_ARGUMENT);
    static const char *const names[] = {"a", "", "b,c", "b\n", "b [s]", "\"b\"", "#b", "b\t"};
    for (size_t i = 0; i < 8; i++) {
        described[1] = column_of(names[i], "s", 1.0, 0.0);
        check_refused(2, described, decimals, IMK_ERROR_COLUMN);
    }
    static const double scales[] = {0.0, -1.0, (double)NAN, (double)INFINITY};
    for (size_t i = 0; i < 4; i++) {
        described[1] = column_of("b", "s", scales[i], 0.0);
        check_refused(2, described, decimals, IMK_ERROR_ARGUMENT);
    }
    described[1] = column_of("b", "s", 1.0, (double)NAN);
    check_refused(2, described, decimals, IMK_ERROR_ARGUMENT);
    described[1] = column_of("b", "s,", 1.0, 0.0);
    check_refused(2, described, decimals, IMK_ERROR_ARGUMENT);
    assert_int_equal(access(path_of("a.csv"), F_OK), -1);
}

/* A finite number that its unit makes infinite is refused by column and row; infinities stay. */
static void number_beyond_its_unit(void **state)
{
    (void)state;
    const imk_log_column columns[] = {column_of("x", "m", 1.0, 0.0),
                                      column_of("time", "ns", 1e-9, 0.0)};
    const char *const names[] = {"beyond.csv", "beyond.npy"};
    const double x[] = {1.0, 1e308, 1e308}, good[] = {1.0, (double)INFINITY, 1e298},
                 bad[] = {1.0, (double)NAN, -1e300};
    for (int k = 0; k < 2; k++) {
        const char *path = path_of(names[k]);
        imk_log_writer *writer;
        imk_error error;
        CHECK_OK(imk_log_create(path, 2, columns, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
        CHECK_OK(imk_log_write(writer, 3, (const double *const[]){x, good}, NULL));
        CHECK_STATUS(imk_log_write(writer, 3, (const double *const[]){x, bad}, NULL),
                     IMK_ERROR_NOT_FINITE);
        CHECK_STATUS(imk_log_commit(writer, &error), IMK_ERROR_NOT_FINITE);
        assert_string_equal(error.field, "time, row 6");
        assert_int_equal(access(path, F_OK), -1);
    }
}

/* A full device: the error comes, at the latest at commit, with the reason. */
static void full_device(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    const imk_log_column described[] = {column_of("time", "s", 1.0, 0.0)};
    const double *columns[] = {log_data[1]};
    for (int calls = 1; calls < 200; calls += 198) {
        imk_log_writer *writer;
        imk_error error;
        CHECK_OK(
            imk_log_create("/dev/full", 1, described, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
        imk_status status = IMK_OK;
        for (int i = 0; i < calls; i++)
            status = imk_log_write(writer, calls == 1 ? 10 : LOG_ROWS, columns, NULL);
        CHECK_STATUS(status, calls == 1 ? IMK_OK : IMK_ERROR_WRITE);
        CHECK_STATUS(imk_log_commit(writer, &error), IMK_ERROR_WRITE);
        assert_string_equal(error.field, "/dev/full");
        assert_string_equal(error.found, "No space left on device");
    }
}

static void abandoned(void **state)
{
    (void)state;
    const imk_log_column described[] = {column_of("time", "s", 1.0, 0.0)};
    const double *columns[] = {log_data[1]};
    static const char *const names[] = {"a.csv", "a.npy"};
    for (int i = 0; i < 2; i++) {
        imk_log_writer *writer;
        CHECK_OK(imk_log_create(path_of(names[i]), 1, described, IMK_LOG_SHORTEST, NULL, 0, &writer,
                                NULL));
        CHECK_OK(imk_log_write(writer, LOG_ROWS, columns, NULL));
        imk_log_abandon(writer);
        assert_int_equal(access(path_of(names[i]), F_OK), -1);
    }
    imk_log_abandon(NULL);
}

static int make_directory(void **state)
{
    (void)state;
    snprintf(directory, sizeof directory, "/tmp/imukit_writer_XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    return rmdir(directory); /* fails when a test left something behind */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_text),
        cmocka_unit_test(labels),
        cmocka_unit_test(header_alone),
        cmocka_unit_test(fixed_is_printf),
        cmocka_unit_test(shortest_reads_back),
        cmocka_unit_test(text_survives_reading_and_writing),
        cmocka_unit_test(value_survives_if_possible),
        cmocka_unit_test(bytes_depend_on_neither_threads_nor_calls),
        cmocka_unit_test(npy_file),
        cmocka_unit_test(npy_row_count),
        cmocka_unit_test(npy_heads),
        cmocka_unit_test(reader_and_writer_agree),
        cmocka_unit_test(refusals),
        cmocka_unit_test(number_beyond_its_unit),
        cmocka_unit_test(full_device),
        cmocka_unit_test(abandoned),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
