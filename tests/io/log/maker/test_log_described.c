/* SPDX-License-Identifier: Apache-2.0 */
/* Binary records that the user describes: fixtures by an independent writer to the last bit, all
 * types of numbers, clocks that begin again, lost bytes, and every wrong description refused. */
#include "check_log.h"

#include <stdbool.h>

static const char plain[] = "u32 time us, 3 x i16 gyro 16.4 LSB/(deg/s), 3 x i16 accel 2048 LSB/g, "
                            "i16 temperature 512 LSB/degC offset 23 degC";
static const char with_sync[] =
    "be: header 16, sync 0xAA55, u24 time 39.0625 us, 3 x i24 gyro 0.001 deg/s/LSB, skip u8, f32 "
    "accel_x m/s^2, f32 accel_y m/s^2, f64 le accel_z m/s^2, checksum u16";

static imk_log_settings described(const char *layout)
{
    imk_log_settings settings = imk_log_default();
    settings.binary = layout;
    return settings;
}

static void fixtures_are_read(void **state)
{
    (void)state;
    imk_log_settings settings = described(plain);
    check_log("described.bin", "described.bin", &settings);
    settings = described(with_sync);
    check_log("described_be.bin", "described_be.bin", &settings);
}

/* The numbers of one record by hand. */
static void all_types_are_read(void **state)
{
    static const unsigned char bytes[] = {
        0xFF, 0x80, 0x34, 0x12, 0x00, 0x80, 0x56, 0x34, 0x12, 0xFF, 0xFF, 0xFF, 0x01,
        0x00, 0x00, 0x80, 0xFE, 0xFF, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x80, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x00, 0x00, 0xC0,
        0x3F, 0xC0, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x12, 0x34, 0xFF, 0xFE};
    static const double due[] = {255.0, -128.0, 4660.0, -32768.0, 1193046.0, -1.0,   2147483649.0,
                                 -2.0,  0x1p63, -3.0,   1.5,      -2.5,      4660.0, -2.0};
    static log_table table;
    (void)state;
    imk_log_settings settings = described("u8 a, i8 b, u16 c, i16 d, u24 e, i24 f, u32 g, i32 h, "
                                          "u64 i, i64 j, f32 k, be f64 l, u16be "
                                          "m, i16 be n");
    settings.rate = 1.0;
    settings.any_columns = true;
    unsigned char record[sizeof bytes];
    memcpy(record, bytes, sizeof bytes);
    record[40] = 0xC0; /* -2.5 is C004000000000000 */
    log_table_read((const char *)record, sizeof record, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.rows, 1);
    assert_int_equal(table.columns, 14);
    for (size_t j = 0; j < 14; j++)
        CHECK_CLOSE(table.value[j][0], due[j], 0.0);
}

/* A file of a known format is no file of records, unless they stand behind a header. */
static void known_formats_are_not_records(void **state)
{
    static const char bytes[64] = "#ROSBAG V2.0\n";
    static log_table table;
    (void)state;
    imk_log_settings settings = described("f32 gyro_x rad/s");
    settings.rate = 1.0;
    log_table_read(bytes, sizeof bytes, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_ERROR_CONFLICT);
    assert_string_equal(table.error.found, "the file begins as one of the format ROS 1 bag");
    settings.binary = "header 16, f32 gyro_x rad/s";
    log_table_read(bytes, sizeof bytes, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.rows, (sizeof bytes - 16) / 4);
}

/* A counter of 16 bits in ms: it begins again, rows are missing, one is out of order. */
static void counters_are_unwrapped(void **state)
{
    static const unsigned stamps[] = {65000, 65500, 464, 30000, 29990, 61000, 10};
    static const double due[] = {65.0, 65.5, 66.0, 95.536, 95.526, 126.536, 131.082};
    static log_table table;
    unsigned char bytes[7 * 3];
    (void)state;
    for (size_t i = 0; i < 7; i++) {
        bytes[3 * i] = (unsigned char)(stamps[i] & 0xFF);
        bytes[3 * i + 1] = (unsigned char)(stamps[i] >> 8);
        bytes[3 * i + 2] = (unsigned char)i;
    }
    const imk_log_settings settings = described("u16 time ms, u8 gyro_x count");
    log_table_read((const char *)bytes, sizeof bytes, &settings, 2, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.rows, 7);
    for (size_t i = 0; i < 7; i++)
        CHECK_RELATIVE(table.value[0][i], due[i], 1e-15);
}

/* Nanoseconds since 1970 keep each digit. */
static void epochs_are_exact(void **state)
{
    static log_table table;
    unsigned char bytes[4 * 9];
    (void)state;
    for (size_t i = 0; i < 4; i++) {
        const uint64_t stamp = UINT64_C(1764320000123456789) + 1000001 * i;
        for (size_t k = 0; k < 8; k++)
            bytes[9 * i + k] = (unsigned char)(stamp >> 8 * k);
        bytes[9 * i + 8] = 1;
    }
    const imk_log_settings settings = described("u64 time ns, i8 accel_z g");
    log_table_read((const char *)bytes, sizeof bytes, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_OK);
    for (size_t i = 0; i < 4; i++)
        CHECK_CLOSE(table.value[0][i], (double)(1000001 * i) * 1e-9, 0.0);
    CHECK_CLOSE(table.findings.time_origin, 1764320000.123456789, 1e-6);
}

static void every_cut_is_read(void **state)
{
    static char bytes[4096];
    static log_table table, expected;
    const struct {
        const char *name, *layout;
        size_t header, size;
    } files[] = {{"described.bin", plain, 0, 18}, {"described_be.bin", with_sync, 16, 33}};
    (void)state;
    for (size_t k = 0; k < 2; k++) {
        const size_t size = log_fixture_read(files[k].name, sizeof bytes, bytes);
        const imk_log_settings settings = described(files[k].layout);
        log_expected_read(files[k].name, &expected);
        for (size_t cut = 0; cut <= size; cut++) {
            const size_t data = cut < files[k].header ? 0 : cut - files[k].header;
            const size_t rows = data / files[k].size;
            log_table_read(bytes, cut, &settings, 64, &table);
            check_status(table.status, rows > 0 ? IMK_OK : IMK_ERROR_EMPTY, files[k].name, __FILE__,
                         __LINE__);
            assert_int_equal(table.rows, rows);
            assert_true(rows == 0 || table.findings.cut_short == (data % files[k].size != 0));
            assert_int_equal(table.findings.damaged, 0);
            for (size_t row = 0; row < rows; row++)
                check_same_row(&table, row, &expected, row);
        }
    }
}

/* A byte that is missing, one too many, and a sync word that is wrong cost the records around them,
 * and no other; none is read with shifted numbers. */
static void lost_bytes_are_passed(void **state)
{
    enum { HEADER = 16, SIZE = 33 };
    static char bytes[4096], damaged[4096];
    static log_table table, expected;
    (void)state;
    const size_t size = log_fixture_read("described_be.bin", sizeof bytes, bytes);
    const imk_log_settings settings = described(with_sync);
    log_expected_read("described_be.bin", &expected);
    for (int change = -1; change <= 1; change++)
        for (size_t at = HEADER; at < size; at++) {
            memcpy(damaged, bytes, at);
            if (change <= 0)
                memcpy(damaged + at, bytes + at + 1, size - at - 1);
            if (change == 0)
                memmove(damaged + at + 1, damaged + at, size - at - 1);
            if (change >= 0)
                damaged[at] = (char)(bytes[at] ^ 0x11);
            if (change > 0)
                memcpy(damaged + at + 1, bytes + at, size - at);
            log_table_read(damaged, (size_t)((long)size + change), &settings, 64, &table);
            CHECK_STATUS(table.status, IMK_OK);
            assert_true(table.rows + 2 >= expected.rows && table.rows <= expected.rows);
            assert_true(change == 0 || at % SIZE == HEADER || table.findings.damaged == 1 ||
                        table.findings.cut_short);
            for (size_t row = 0, due = 0; row < table.rows && change != 0; row++, due++) {
                while (due < expected.rows && table.value[0][row] != expected.value[0][due])
                    due++;
                assert_true(due < expected.rows);
                check_same_row(&table, row, &expected, due);
            }
        }
}

static void wrong_descriptions_are_refused(void **state)
{
    static const struct {
        const char *layout, *item; /* how error.found begins */
        imk_status status;
    } wrong[] = {
        {"", "\"\" (item 1)", IMK_ERROR_SYNTAX},
        {"u32 time us,,u8 a", "\"\" (item 2)", IMK_ERROR_SYNTAX},
        {"u33 time us", "\"u33 time us\" (item 1)", IMK_ERROR_SYNTAX},
        {"u32 time us, 3 x i17 gyro", "\"3 x i17 gyro\" (item 2)", IMK_ERROR_SYNTAX},
        {"u32 time us, 3 i16 gyro", "\"3 i16 gyro\" (item 2)", IMK_ERROR_SYNTAX},
        {"u32 time us, 0 x i16 gyro", "\"0 x i16 gyro\" (item 2)", IMK_ERROR_SYNTAX},
        {"u32 time us, 9 x i16 gyro", "\"9 x i16 gyro\" (item 2)", IMK_ERROR_RANGE},
        {"u32 time us, i16", "\"i16\" (item 2)", IMK_ERROR_SYNTAX},
        {"u32 time us, i16 gyro", "\"i16 gyro\" (item 2)", IMK_ERROR_SYNTAX},
        {"2 x u32 time us", "\"2 x u32 time us\" (item 1)", IMK_ERROR_SYNTAX},
        {"u32 time us, u16 t ms", "\"u16 t ms\" (item 2)", IMK_ERROR_COLUMN},
        {"u8 a, u8 b, u8 a", "\"u8 a\" (item 3)", IMK_ERROR_COLUMN},
        {"i16 gyro_x 16.4", "\"i16 gyro_x 16.4\" (item 1)", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 gyro_x LSB/(deg/s)", "\"i16 gyro_x LSB/(deg/s)\" (item 1)", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 gyro_x 0 LSB/(deg/s)", "\"i16 gyro_x 0 LSB/(deg/s)\"", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 gyro_x 1e999 deg/s", "\"i16 gyro_x 1e999 deg/s\"", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 gyro_x 1 dag/s", "\"i16 gyro_x 1 dag/s\" (item 1)", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 temp 1 degC offset", "\"i16 temp 1 degC offset\"", IMK_ERROR_UNIT_UNKNOWN},
        {"i16 temp 1 degC offset 2 K", "\"i16 temp 1 degC offset 2 K\"", IMK_ERROR_UNIT_UNKNOWN},
        {"sync 0x, u8 a", "\"sync 0x\" (item 1)", IMK_ERROR_SYNTAX},
        {"sync AA55, u8 a", "\"sync AA55\" (item 1)", IMK_ERROR_SYNTAX},
        {"sync 0x112233445566778899, u8 a", "\"sync 0x", IMK_ERROR_SYNTAX},
        {"sync 0xA5G5, u8 a", "\"sync 0xA5G5\" (item 1)", IMK_ERROR_SYNTAX},
        {"u8 a, sync 0xAA", "\"sync 0xAA\" (item 2)", IMK_ERROR_SYNTAX},
        {"u8 a, header 4", "\"header 4\" (item 2)", IMK_ERROR_SYNTAX},
        {"header, u8 a", "\"header\" (item 1)", IMK_ERROR_SYNTAX},
        {"header 99999999999999999999, u8 a", "\"header 9", IMK_ERROR_SYNTAX},
        {"u8 a, skip", "\"skip\" (item 2)", IMK_ERROR_SYNTAX},
        {"u8 a, skip -1", "\"skip -1\" (item 2)", IMK_ERROR_SYNTAX},
        {"u8 a, skip 65536", "\"skip 65536\" (item 2)", IMK_ERROR_RANGE},
        {"u8 a, crc u7", "\"crc u7\" (item 2)", IMK_ERROR_SYNTAX},
        {"u8 a, be: u8 b", "\"be: u8 b\" (item 2)", IMK_ERROR_SYNTAX},
        {"65 x u8 a", "\"65 x u8 a\" (item 1)", IMK_ERROR_RANGE},
        {"u8 a\xC3\xA4", "\"u8 a\xC3\xA4\" (item 1)", IMK_ERROR_SYNTAX},
        {"skip 4", "no field has a name", IMK_ERROR_EMPTY},
    };
    static log_table table;
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        imk_log_settings settings = described(wrong[i].layout);
        settings.rate = 1.0;
        log_table_read("0123456789", 10, &settings, 4, &table);
        check_status(table.status, wrong[i].status, wrong[i].layout, __FILE__, __LINE__);
        assert_string_equal(table.error.field, "binary");
        if (strncmp(table.error.found, wrong[i].item, strlen(wrong[i].item)) != 0)
            fail_msg("%s does not begin with %s", table.error.found, wrong[i].item);
        assert_true(strncmp(table.error.expected, "such as ", 8) == 0);
    }
    /* Units: of the options where the description has none, and of the right kind. */
    imk_log_settings settings = described("i16 gyro_x");
    settings.rate = 1.0;
    log_table_read("0123456789", 10, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_ERROR_UNIT_MISSING);
    settings.gyro_unit = "deg/s";
    log_table_read("0123456789", 10, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_OK);
    settings = described("i16 gyro_x 2048 LSB/g");
    settings.rate = 1.0;
    log_table_read("0123456789", 10, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_ERROR_DIMENSION);
    settings = described("u8 a");
    settings.format = "npy";
    log_table_read("0123456789", 10, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_ERROR_CONFLICT);
    settings = imk_log_default();
    settings.format = "binary";
    log_table_read("0123456789", 10, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_ERROR_CONFLICT);
}

/* A look at another part of the log begins with a whole record. */
static void places_are_found(void **state)
{
    static char bytes[4096];
    static log_table expected;
    (void)state;
    const size_t size = log_fixture_read("described.bin", sizeof bytes, bytes);
    const imk_log_settings settings = described(plain);
    log_expected_read("described.bin", &expected);
    imk_log_reader *reader = NULL;
    CHECK_STATUS(imk_log_open_memory(bytes, size, &settings, &reader, NULL), IMK_OK);
    CHECK_STATUS(imk_log_seek(reader, 0.5, NULL), IMK_OK);
    double gyro;
    double *columns[LOG_COLUMNS_MAX] = {NULL, &gyro};
    size_t rows;
    CHECK_STATUS(imk_log_read(reader, 1, columns, &rows, NULL), IMK_OK);
    CHECK_CLOSE(gyro, expected.value[1][12], 0.0);
    imk_log_close(reader);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fixtures_are_read),
        cmocka_unit_test(all_types_are_read),
        cmocka_unit_test(known_formats_are_not_records),
        cmocka_unit_test(counters_are_unwrapped),
        cmocka_unit_test(epochs_are_exact),
        cmocka_unit_test(every_cut_is_read),
        cmocka_unit_test(lost_bytes_are_passed),
        cmocka_unit_test(wrong_descriptions_are_refused),
        cmocka_unit_test(places_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
