/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of makers: fixtures by an independent writer to the last bit, messages that makers and
 * others published, logs cut at every byte and with every byte changed. */
#include "check_log.h"

#include <stdbool.h>

static imk_log_settings timed(void)
{
    imk_log_settings settings = imk_log_default();
    settings.time_unit = "39.0625 us";
    return settings;
}

static imk_log_settings rated(void)
{
    imk_log_settings settings = imk_log_default();
    settings.rate = 100.0;
    return settings;
}

static imk_log_settings topic(const char *name)
{
    imk_log_settings settings = imk_log_default();
    settings.topic = name;
    return settings;
}

static const struct fixture {
    const char *file, *expected;
    imk_log_settings (*settings)(void);
    size_t rows_of_message;
    bool strict; /* what is no message is always noted */
} fixtures[] = {{"novatel.bin", "novatel.bin", imk_log_default, 1, false},
                {"novatel.asc", "novatel.asc", imk_log_default, 1, false},
                {"ubx.ubx", "ubx.ubx", timed, 4, false},
                {"vectornav.asc", "vectornav.asc", rated, 1, true}};
enum { FIXTURES = sizeof fixtures / sizeof fixtures[0] };

static void fixtures_are_read(void **state)
{
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const imk_log_settings settings = fixtures[i].settings();
        check_log(fixtures[i].file, fixtures[i].expected, &settings);
    }
    static const char *const kinds[] = {"imu_short", "imu_data", "fast_imu_data"};
    for (size_t i = 0; i < 3; i++) {
        char expected[64];
        const imk_log_settings settings = topic(kinds[i]);
        snprintf(expected, sizeof expected, "sbg.bin.%s", kinds[i]);
        check_log("sbg.bin", expected, &settings);
    }
}

/* Which formats the fixtures are taken for, without being told. */
static void formats_are_recognised(void **state)
{
    static const char *const files[][2] = {{"novatel.bin", "novatel"},
                                           {"novatel.asc", "novatel"},
                                           {"sbg.bin", "sbg"},
                                           {"ubx.ubx", "ubx"},
                                           {"vectornav.asc", "vectornav"}};
    char path[512];
    (void)state;
    for (size_t i = 0; i < 5; i++) {
        imk_log_settings settings = timed();
        settings.topic = i == 2 ? "imu_short" : NULL;
        settings.time_unit = i == 3 ? settings.time_unit : NULL;
        settings.rate = i == 4 ? 100.0 : 0.0;
        imk_log_reader *reader = NULL;
        snprintf(path, sizeof path, "%s/tests/io/log/maker/fixtures/%s", SOURCE_DIRECTORY,
                 files[i][0]);
        check_status(imk_log_open(path, &settings, &reader, NULL), IMK_OK, path, __FILE__,
                     __LINE__);
        assert_string_equal(imk_log_format_read(reader)->name, files[i][1]);
        imk_log_close(reader);
    }
}

/* Rows that are whole are read, and the end within one is told. */
static void every_cut_is_read(void **state)
{
    static char bytes[16384];
    static log_table table, expected;
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const imk_log_settings settings = fixtures[i].settings();
        const size_t size = log_fixture_read(fixtures[i].file, sizeof bytes, bytes);
        log_expected_read(fixtures[i].expected, &expected);
        size_t before = 0;
        for (size_t cut = 0; cut <= size; cut++) {
            log_table_read(bytes, cut, &settings, 64, &table);
            if (table.status != IMK_OK) {
                assert_true(before == 0 && table.error.status == table.status);
                continue;
            }
            if (table.rows < before || table.rows > before + 4)
                fail_msg("%s cut at %zu has %zu rows behind %zu", fixtures[i].file, cut, table.rows,
                         before);
            if (table.findings.damaged > 0)
                fail_msg("%s has damage when cut at %zu", fixtures[i].file, cut);
            before = table.rows;
            for (size_t row = 0; row < table.rows; row++)
                check_same_row(&table, row, &expected, row);
        }
        assert_int_equal(before, expected.rows);
        log_table_read(bytes, size - 4, &settings, 64, &table);
        assert_true(table.rows < expected.rows && table.findings.cut_short);
    }
}

/* A changed byte costs at most the rows of its message. */
static void every_damage_is_survived(void **state)
{
    static char bytes[16384];
    static log_table table, expected;
    (void)state;
    for (size_t i = 0; i < FIXTURES; i++) {
        const struct fixture *f = &fixtures[i];
        const imk_log_settings settings = f->settings();
        const size_t size = log_fixture_read(f->file, sizeof bytes, bytes);
        size_t told = 0, lost = 0;
        log_expected_read(f->expected, &expected);
        for (size_t at = 0; at < size; at++) {
            bytes[at] ^= 0x41;
            log_table_read(bytes, size, &settings, 64, &table);
            bytes[at] ^= 0x41;
            check_status(table.status, IMK_OK, f->file, __FILE__, __LINE__);
            assert_true(table.rows + f->rows_of_message >= expected.rows &&
                        table.rows <= expected.rows);
            const bool is_lost = table.rows < expected.rows && at > size / 16;
            lost += is_lost;
            told += is_lost && (table.findings.damaged > 0 || table.findings.cut_short);
            assert_true(table.findings.damaged <= 2);
        }
        assert_true(lost > size / 3 && told <= lost && lost - told <= (f->strict ? 0 : lost / 40));
    }
}

/* What stands in public: the manual's page of RAWIMUSX (docs.novatel.com), NovAtel's answer on
 * accelerations of RAWIMU, and lines of tests of novatel_edie; VectorNav's example in the code of
 * its users. The receiver's gravity is what they all have in common. */
static void published_lines_are_read(void **state)
{
    static const struct {
        const char *line;
        int axis;         /* that is vertical */
        double rate;      /* of increments, as published [Hz] */
        double low, high; /* of the vertical force [m/s^2] */
    } lines[] = {
        {"%RAWIMUSXA,2209,491674.014;04,41,2209,491674.013699,ea59fe00,329308016,-2706935,4508389,"
         "196192,417138,-1000837*038422a7\r\n",
         2, 125, 9.7, 9.9},
        {"%RAWIMUSXA,1692,484620.664;00,11,1692,484620.664389000,00801503,43110635,-817242,-202184,"
         "-215194,-41188,-9895*a5db8c7b\r\n",
         2, 100, 9.7, 9.9},
        {"%RAWIMUSXA,2075,507495.165;00,13,2075,507495.165000000,00000000,32068,-1612,-1320,256,"
         "1536,-255*dd88585c\r\n",
         2, 200, 9.7, 9.9},
        {"$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,"
         "-00.044656,+20.7,+084.322*66\r\n",
         2, 40, 9.94, 9.96},
    };
    static log_table table;
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        imk_log_settings settings = imk_log_default();
        settings.rate = lines[i].rate;
        log_table_read(lines[i].line, strlen(lines[i].line), &settings, 4, &table);
        check_status(table.status, IMK_OK, lines[i].line, __FILE__, __LINE__);
        assert_int_equal(table.rows, 1);
        size_t vertical = 0;
        for (size_t j = 0; j < table.columns; j++)
            if (strcmp(table.name[j], "dvel_z") == 0 || strcmp(table.name[j], "accel_z") == 0)
                vertical = j;
        assert_true(table.value[vertical][0] > lines[i].low &&
                    table.value[vertical][0] < lines[i].high);
    }
}

/* The binary RAWIMUSX of novatel_edie's tests is the ASCII one above. */
static void published_bytes_are_read(void **state)
{
    static const unsigned char bytes[] = {
        'G',  'A',  'R',  'B',  'A',  'G',  'E',  0xAA, 0x44, 0x13, 0x28, 0xB6, 0x05,
        0x9C, 0x06, 0x78, 0xB9, 0xE2, 0x1C, 0x00, 0x0B, 0x9C, 0x06, 0x0B, 0x97, 0x55,
        0xA8, 0x32, 0x94, 0x1D, 0x41, 0x03, 0x15, 0x80, 0x00, 0xEB, 0xD0, 0x91, 0x02,
        0xA6, 0x87, 0xF3, 0xFF, 0x38, 0xEA, 0xFC, 0xFF, 0x66, 0xB7, 0xFC, 0xFF, 0x1C,
        0x5F, 0xFF, 0xFF, 0x59, 0xD9, 0xFF, 0xFF, 0x47, 0x5F, 0xAF, 0xBA};
    /* counts -9895, +41188, -215194 of 2^-33 rad, -202184, +817242, 43110635 of 2^-27 ft/s */
    static const double counts[] = {-9895, 41188, -215194, -202184, 817242, 43110635};
    static log_table table;
    (void)state;
    imk_log_settings settings = imk_log_default();
    settings.rate = 100.0;
    log_table_read((const char *)bytes, sizeof bytes, &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.rows, 1);
    for (size_t k = 0; k < 6; k++)
        CHECK_RELATIVE(table.value[1 + k][0],
                       counts[k] * (k < 3 ? 0x1p-33 : 0x1p-27 * 0.3048) * 100.0, 1e-15);
}

/* Steps of the time stamps divide increments: a rate twice as high gives readings twice as large.
 */
static void rates_come_from_the_stamps(void **state)
{
    static const char text[] =
        "%RAWIMUSA,1537,361705.645;1537,361705.644826900,00000000,30387,415,-5398,-23039,-18100736,"
        "-5117*c01b540c\n";
    static log_table table;
    imk_log_settings settings = imk_log_default();
    (void)state;
    settings.rate = 200.0;
    log_table_read(text, strlen(text), &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_ERROR_UNIT_MISSING);
    assert_string_equal(table.error.expected, "add --gyro-unit count --accel-unit count");
    settings.gyro_unit = settings.accel_unit = "count";
    log_table_read(text, strlen(text), &settings, 4, &table);
    CHECK_STATUS(table.status, IMK_OK);
    CHECK_CLOSE(table.value[6][0], 30387.0 * 200.0, 0.0);
    CHECK_CLOSE(table.value[5][0], -415.0 * 200.0, 0.0);
    CHECK_CLOSE(table.value[1][0], -5117.0 * 200.0, 0.0);
}

static void time_tags_need_a_unit(void **state)
{
    static char bytes[16384];
    static log_table table;
    (void)state;
    imk_log_settings settings = imk_log_default();
    const size_t size = log_fixture_read("ubx.ubx", sizeof bytes, bytes);
    log_table_read(bytes, size, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_ERROR_RATE_MISSING);
    settings.rate = 100.0;
    log_table_read(bytes, size, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_string_equal(table.name[0], "sensor_tag");
    CHECK_CLOSE(table.value[0][4], (double)((1 << 24) - 1000 + 256 * 4 - (1 << 24)), 0.0);
    settings.time_unit = "3 fortnights";
    log_table_read(bytes, size, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_ERROR_UNIT_UNKNOWN);
}

/* Bytes from before the first message are no damage; messages with wrong checksums there are. */
static void beginnings_are_judged(void **state)
{
    static char bytes[16384];
    static log_table table;
    (void)state;
    imk_log_settings settings = imk_log_default();
    const size_t size = log_fixture_read("novatel.bin", sizeof bytes, bytes);
    log_table_read(bytes + 10, size - 10, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.findings.damaged, 0);
    bytes[20] ^= 1;
    log_table_read(bytes, size, &settings, 64, &table);
    assert_int_equal(table.findings.damaged, 1);
    assert_int_equal(table.findings.first_damaged, 0);
}

/* Line feeds alone between the lines change nothing, at the end of the file neither. */
static void lines_end_in_line_feeds(void **state)
{
    static char bytes[16384];
    static log_table table, expected;
    (void)state;
    const imk_log_settings settings = rated();
    const size_t size = log_fixture_read("vectornav.asc", sizeof bytes, bytes);
    size_t kept = 0;
    for (size_t i = 0; i < size; i++)
        if (bytes[i] != '\r')
            bytes[kept++] = bytes[i];
    assert_true(kept < size && bytes[kept - 1] == '\n');
    log_expected_read("vectornav.asc", &expected);
    log_table_read(bytes, kept, &settings, 64, &table);
    CHECK_STATUS(table.status, IMK_OK);
    assert_int_equal(table.rows, expected.rows);
    for (size_t row = 0; row < table.rows; row++)
        check_same_row(&table, row, &expected, row);
    assert_int_equal(table.findings.damaged, 0);
    assert_false(table.findings.cut_short);
}

/* A look at another part begins with the next message, and meets no damage. */
static void places_are_found(void **state)
{
    static char bytes[16384];
    static log_table expected;
    (void)state;
    const size_t size = log_fixture_read("vectornav.asc", sizeof bytes, bytes);
    const imk_log_settings settings = rated();
    log_expected_read("vectornav.asc", &expected);
    for (double part = 0.0; part < 0.95; part += 0.1) {
        imk_log_reader *reader = NULL;
        double first, *columns[LOG_COLUMNS_MAX] = {&first};
        size_t rows;
        CHECK_STATUS(imk_log_open_memory(bytes, size, &settings, &reader, NULL), IMK_OK);
        CHECK_STATUS(imk_log_seek(reader, part, NULL), IMK_OK);
        CHECK_STATUS(imk_log_read(reader, 1, columns, &rows, NULL), IMK_OK);
        const size_t due = (size_t)(part * (double)expected.rows);
        assert_int_equal(rows, 1);
        assert_true(first == expected.value[0][due] || first == expected.value[0][due + 1]);
        assert_int_equal(imk_log_findings_get(reader).damaged, 0);
        imk_log_close(reader);
    }
}

/* UBX-ESF-RAW with `count` readings of types from `first` on, after [UBX]. @return behind it */
static char *put_raw(char *at, const unsigned char *types, size_t count, unsigned value,
                     unsigned tag)
{
    const size_t payload = 4 + 8 * count;
    unsigned char bytes[128] = {0xB5, 0x62, 0x10, 0x03, (unsigned char)payload, 0};
    unsigned char a = 0, b = 0;
    for (size_t i = 0; i < count; i++) {
        unsigned char *pair = bytes + 6 + 4 + 8 * i;
        pair[0] = (unsigned char)value;
        pair[3] = types[i];
        pair[4] = (unsigned char)tag;
        pair[5] = (unsigned char)(tag >> 8);
    }
    for (size_t i = 2; i < 6 + payload; i++) {
        a = (unsigned char)(a + bytes[i]);
        b = (unsigned char)(b + a);
    }
    bytes[6 + payload] = a;
    bytes[7 + payload] = b;
    memcpy(at, bytes, 8 + payload);
    return at + 8 + payload;
}

/* Readings of one tag in two messages are one row; in messages with tags of their own those of the
 * first message are the rows, and it is told that there are others. */
static void readings_of_a_tag_are_a_row(void **state)
{
    enum { ROWS = 20 };
    static const unsigned char gyros[] = {14, 13, 5}, accels[] = {16, 17, 18};
    static char bytes[8192];
    static log_table table;
    (void)state;
    for (int apart = 0; apart < 2; apart++) {
        const imk_log_settings settings = timed();
        char *end = bytes;
        for (unsigned k = 0; k < ROWS; k++) {
            end = put_raw(end, gyros, 3, k, 100 + 256 * k);
            end = put_raw(end, accels, 3, k + 1, 100 + 256 * k + 3 * (unsigned)apart);
        }
        const size_t size = (size_t)(end - bytes);
        log_table_read(bytes, size, &settings, 64, &table);
        CHECK_STATUS(table.status, IMK_OK);
        assert_int_equal(table.rows, ROWS);
        assert_int_equal(table.columns, apart ? 4 : 7);
        assert_int_equal(table.findings.not_finite, 0);
        assert_int_equal(table.findings.later[0], 0);
        assert_int_equal(table.findings.later[1], apart ? ROWS : 0);
        for (unsigned k = 0; k < ROWS; k++) {
            CHECK_CLOSE(table.value[1][k], k * 0x1p-12 * acos(-1) / 180, 1e-18);
            if (!apart)
                assert_true(table.value[6][k] == (k + 1) * 0x1p-10);
        }
        /* A place between two messages of a tag: the first row is whole. */
        for (size_t at = 0; at < size; at += 19) {
            imk_log_reader *reader = NULL;
            double *columns[LOG_COLUMNS_MAX];
            size_t rows;
            for (size_t j = 0; j < LOG_COLUMNS_MAX; j++)
                columns[j] = table.value[j];
            CHECK_STATUS(imk_log_open_memory(bytes, size, &settings, &reader, NULL), IMK_OK);
            CHECK_STATUS(imk_log_seek(reader, (double)at / (double)size, NULL), IMK_OK);
            CHECK_STATUS(imk_log_read(reader, 64, columns, &rows, NULL), IMK_OK);
            assert_true(rows <= ROWS && (at > 0 || rows == ROWS));
            assert_int_equal(imk_log_findings_get(reader).not_finite, 0);
            imk_log_close(reader);
        }
    }
}

static void kinds_are_listed(void **state)
{
    imk_log_stream streams[4];
    size_t count = 0;
    char path[512];
    (void)state;
    snprintf(path, sizeof path, "%s/tests/io/log/maker/fixtures/sbg.bin", SOURCE_DIRECTORY);
    CHECK_STATUS(imk_log_streams(path, NULL, 4, streams, &count, NULL, NULL), IMK_OK);
    assert_int_equal(count, 3);
    assert_string_equal(streams[0].name, "imu_short");
    assert_string_equal(streams[1].kind, "SBG_ECOM_LOG_IMU_DATA");
    assert_true(streams[2].readable && streams[2].samples == 24);
    imk_log_reader *reader = NULL;
    CHECK_STATUS(imk_log_open(path, NULL, &reader, NULL), IMK_ERROR_NAME_UNKNOWN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fixtures_are_read),           cmocka_unit_test(formats_are_recognised),
        cmocka_unit_test(every_cut_is_read),           cmocka_unit_test(every_damage_is_survived),
        cmocka_unit_test(published_lines_are_read),    cmocka_unit_test(published_bytes_are_read),
        cmocka_unit_test(rates_come_from_the_stamps),  cmocka_unit_test(time_tags_need_a_unit),
        cmocka_unit_test(beginnings_are_judged),       cmocka_unit_test(places_are_found),
        cmocka_unit_test(readings_of_a_tag_are_a_row), cmocka_unit_test(kinds_are_listed),
        cmocka_unit_test(lines_end_in_line_feeds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
