/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of ArduPilot. flight.bin and old.bin were written by make_flight_logs.py, after the
 * published format and without imukit; their values are formulas, which are computed here again, so
 * that all numbers agree to the last bit. */
#define _DEFAULT_SOURCE
#include "flight_table.h"

#include "imukit/io.h"

static bytes log_bytes;
static table t;

static double whole(int k, int axis)
{
    return (double)((7 * k + 31 * axis) % 201 - 100);
}

static double value(int k, int axis)
{
    return whole(k, axis) / 1024;
}

static double seconds(double us)
{
    return us * 1e-6;
}

static void read_sensor(const char *topic, int instance, size_t block)
{
    const imk_log_settings settings = sensor(topic, instance);
    read_bytes(log_bytes.at, log_bytes.size, &settings, block, &t);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.findings.damaged, 0);
    assert_int_equal(t.findings.not_finite, 0);
    assert_false(t.findings.cut_short);
}

static void all_sensors_are_listed(void **state)
{
    (void)state;
    static const struct {
        const char *name, *kind;
        int instance;
        uint64_t rows;
        double begin, end; /* [us], by the formulas of make_flight_logs.py */
    } due[] = {{"IMU", "IMU", 0, 31, 6990000, 7072500},
               {"IMU", "IMU", 1, 30, 7000000, 7072500},
               {"GYR", "GYR", 2, 30, 7000000, 7014500},
               {"ACC", "ACC", 0, 30, 7000000, 7014500},
               {"ISBD/gyro", "ISBD", 1, 128, 8100000, 8300000 + 63e6 / 1600.5},
               {"ISBD/accel", "ISBD", 1, 192, 8000000, 8400000 + 63e6 / 1600.5},
               {"MAG", "MAG", 0, 5, 7000000, 7000000}};
    char path[] = SOURCE_DIRECTORY "/tests/io/log/flight/flight.bin";
    imk_log_stream stream[16];
    size_t count;
    imk_error error;
    CHECK_OK(imk_log_streams(path, NULL, 16, stream, &count, NULL, &error));
    assert_int_equal(count, 7);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(stream[i].name, due[i].name);
        assert_string_equal(stream[i].kind, due[i].kind);
        assert_int_equal(stream[i].instance, due[i].instance);
        assert_true(stream[i].readable == (i < 6));
        assert_false(stream[i].estimated);
        assert_int_equal(stream[i].samples, due[i].rows);
        CHECK_RELATIVE(stream[i].begin, seconds(due[i].begin), 1e-15);
        CHECK_RELATIVE(stream[i].end, seconds(due[i].end), 1e-15);
    }
}

static void rows_of_both_kinds(void **state)
{
    (void)state;
    for (int instance = 0; instance < 2; instance++) {
        const int early = instance == 0; /* one row before the units are said */
        read_sensor("IMU", instance, 7);
        assert_int_equal(t.rows, 30 + early);
        assert_int_equal(t.columns, 8);
        for (int row = early; row < 30 + early; row++) {
            const int k = row - early;
            assert_true(t.value[0][row] == seconds(7e6 + 2500 * k));
            for (int axis = 0; axis < 6; axis++)
                assert_true(t.value[1 + axis][row] == value(k + 50 * instance, axis));
            assert_true(t.value[7][row] == 20 + k / 8.0 + 273.15);
        }
    }
}

static void units_and_multipliers_of_the_log(void **state)
{
    (void)state;
    const double degree = acos(-1) / 180;
    read_sensor("ACC", -1, 16); /* hundredths, by its multiplier */
    for (int k = 0; k < 30; k++) {
        assert_true(t.value[0][k] == seconds(7e6 + 500 * k));
        assert_true(t.value[3][k] == whole(k, 2) * 0.01);
    }
    read_sensor("GYR", -1, 16);    /* deg/s, by its unit */
    for (int k = 0; k < 30; k++) { /* message 4 has no SampleUS */
        assert_true(t.value[0][k] == seconds(7e6 + 500 * k + (k == 4 ? 50 : 0)));
        assert_true(t.value[1][k] == value(k, 0) * degree);
    }
}

static void batches_become_rows(void **state)
{
    (void)state;
    static table other;
    for (int gyro = 0; gyro < 2; gyro++) {
        const char *name = gyro ? "ISBD/gyro" : "ISBD/accel";
        read_sensor(name, -1, 100);
        size_t row = 0;
        for (int number = gyro; number < 5; number += 2)
            for (int i = 0; i < 64; i++, row++) {
                assert_true(t.value[0][row] == seconds(8e6 + 1e5 * number + i * 1e6 / 1600.5));
                for (int axis = 0; axis < 3; axis++)
                    assert_true(t.value[1 + axis][row] == whole(64 * number + i, axis) / 938);
            }
        assert_int_equal(t.rows, row);
        assert_string_equal(t.names[1], gyro ? "gyro_x" : "accel_x");
        for (size_t block = 1; block < 80; block += 9) { /* pieces end within a message */
            const imk_log_settings settings = sensor(name, -1);
            read_bytes(log_bytes.at, log_bytes.size, &settings, block, &other);
            assert_int_equal(other.rows, t.rows);
            check_same_rows(&t, 0, &other, 0, t.rows);
        }
    }
}

static void old_logs(void **state)
{
    (void)state;
    const bytes old = fixture("old.bin");
    const imk_log_settings first = sensor("IMU", -1), second = sensor("IMU2", -1);
    read_bytes(old.at, old.size, &first, 5, &t);
    assert_int_equal(t.rows, 12);
    for (int k = 0; k < 12; k++) {
        assert_true(t.value[0][k] == seconds((90000 + 20 * k) * 1000.0));
        assert_true(t.value[6][k] == value(k, 5));
        assert_true(t.value[7][k] == (2500 + k) * 0.01 + 273.15);
    }
    read_bytes(old.at, old.size, &second, 5, &t);
    assert_int_equal(t.rows, 12);
    assert_int_equal(t.columns, 7);
    for (int k = 0; k < 12; k++)
        assert_true(t.value[1][k] == value(k + 1, 0));
    free(old.at);
}

/* Where the first message of a number begins. */
static size_t place_of(unsigned char number)
{
    const char header[3] = {(char)0xA3, (char)0x95, (char)number};
    size_t at = 0;
    while (memcmp(log_bytes.at + at, header, 3) != 0)
        at++;
    return at;
}

static void cut_and_damaged_logs(void **state)
{
    (void)state;
    const imk_log_settings imu = sensor("IMU", 1), batch = sensor("ISBD/accel", -1);
    check_cut(&log_bytes, &imu, 7);
    check_cut(&log_bytes, &batch, 61);
    const size_t from = place_of(13); /* PARM; nothing replaces what stands before */
    assert_true(check_damage(&log_bytes, &imu, from, 9, 0) > 10);
    assert_true(check_damage(&log_bytes, &imu, from, 60, 0xA3) > 10);
    assert_true(check_damage(&log_bytes, &batch, from, 30, 0xFF) > 1);
}

static void bytes_that_are_lost(void **state)
{
    (void)state;
    static table hurt;
    const imk_log_settings settings = sensor("IMU", 1);
    read_bytes(log_bytes.at, log_bytes.size, &settings, 64, &t);
    char *copy = malloc(log_bytes.size);
    assert_non_null(copy);
    for (size_t at = place_of(13); at + 40 < log_bytes.size; at += 11) {
        memcpy(copy, log_bytes.at, at);
        memcpy(copy + at, log_bytes.at + at + 40, log_bytes.size - at - 40);
        read_bytes(copy, log_bytes.size - 40, &settings, 64, &hurt);
        size_t place = 0;
        for (size_t row = 0; row < hurt.rows; row++) /* no row is made up of two */
            assert_true(find_row(&hurt, row, &t, &place));
        assert_true(hurt.rows + 2 >= t.rows);
        assert_true(hurt.findings.damaged > 0 || hurt.findings.cut_short);
    }
    free(copy);
}

static void any_place_can_be_gone_to(void **state)
{
    (void)state;
    static table part;
    static const char *const names[] = {"IMU", "ISBD/gyro"};
    for (int n = 0; n < 2; n++) {
        const imk_log_settings settings = sensor(names[n], 1);
        imk_log_reader *reader;
        imk_error error;
        read_bytes(log_bytes.at, log_bytes.size, &settings, 64, &t);
        CHECK_OK(imk_log_open_memory(log_bytes.at, log_bytes.size, &settings, &reader, &error));
        size_t before = t.rows;
        for (int i = 0; i <= 50; i++) {
            CHECK_OK(imk_log_seek(reader, i / 50.0, &error));
            read_on(reader, 16, &part);
            assert_true(part.rows <= before && (i > 0 || part.rows == t.rows));
            check_same_rows(&part, 0, &t, t.rows - part.rows, part.rows);
            assert_int_equal(part.findings.damaged, 0);
            before = part.rows;
        }
        assert_int_equal(before, 0);
        imk_log_close(reader);
    }
}

static void check_refused(const char *at, size_t size, const imk_log_settings *settings,
                          imk_status due, const char *words)
{
    char text[400];
    read_bytes(at, size, settings, 64, &t);
    CHECK_STATUS(t.opened, due);
    imk_error_text(&t.error, "x.bin", text, sizeof text);
    if (!strstr(text, words))
        fail_msg("\"%s\" lacks \"%s\"", text, words);
}

static void what_cannot_be_read_is_refused(void **state)
{
    (void)state;
    static const char text[] = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n";
    check_refused(text, sizeof text - 1, NULL, IMK_ERROR_FORMAT, "give the .bin file");
    check_refused("\xA3\x95", 2, NULL, IMK_ERROR_EMPTY, "no messages of gyros");
    imk_log_settings settings = sensor("IMU", 1);
    settings.columns = "time,gyro_x";
    check_refused(log_bytes.at, log_bytes.size, &settings, IMK_ERROR_CONFLICT, "leave --columns");
    settings = sensor("IMU", 7);
    check_refused(log_bytes.at, log_bytes.size, &settings, IMK_ERROR_NAME_UNKNOWN,
                  "none of the 6 sensors is \"IMU\" of instance 7; add --instance 0 (or --instance "
                  "1, --topic GYR --instance 2, ...)");
    settings = imk_log_default();
    settings.format = "dataflash";
    check_refused("time [s],gyro_x [rad/s]\n", 24, &settings, IMK_ERROR_FORMAT, "ArduPilot");
}

/* A log that is made here, after [DATAFLASH]. */
typedef struct made {
    char at[8192];
    size_t size;
} made;

static void put(made *m, const void *at, size_t size)
{
    assert_true(m->size + size <= sizeof m->at);
    memcpy(m->at + m->size, at, size);
    m->size += size;
}

static void put_header(made *m, int number)
{
    const char header[3] = {(char)0xA3, (char)0x95, (char)number};
    put(m, header, 3);
}

static void put_format(made *m, int number, int length, const char *name, const char *types,
                       const char *labels)
{
    char text[4 + 16 + 64] = {0};
    const char head[2] = {(char)number, (char)length};
    memcpy(text, name, strlen(name));
    memcpy(text + 4, types, strlen(types));
    memcpy(text + 20, labels, strlen(labels));
    put_header(m, 128);
    put(m, head, 2);
    put(m, text, sizeof text);
}

/* A time and six floats: `first` are those of the three fields that come first. */
static void put_row(made *m, int number, int k, int first, int second)
{
    const uint64_t stamp = (uint64_t)(1000 * k + 1000);
    put_header(m, number);
    put(m, &stamp, 8);
    for (int i = 0; i < 6; i++) {
        const float number_at = (float)value(k, i < 3 ? first + i : second + i - 3);
        put(m, &number_at, 4);
    }
}

#define GYROS_FIRST "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ"
#define FORCES_FIRST "TimeUS,AccX,AccY,AccZ,GyrX,GyrY,GyrZ"

static void put_head(made *m)
{
    put_format(m, 128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
}

static void check_made(const made *m, size_t rows)
{
    read_bytes(m->at, m->size, NULL, 4, &t);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, rows);
    assert_int_equal(t.findings.damaged, 0);
    for (int k = 0; k < (int)rows; k++) {
        assert_true(t.value[0][k] == seconds(1000 * k + 1000));
        for (int axis = 0; axis < 6; axis++)
            assert_true(t.value[1 + axis][k] == value(k, axis));
    }
}

/* The first message of a number follows its FMT at once, also where a type is defined between
 * messages of others. */
static void messages_right_behind_their_format(void **state)
{
    (void)state;
    static made m;
    m.size = 0;
    put_head(&m);
    put_format(&m, 200, 35, "IMU", "Qffffff", GYROS_FIRST);
    for (int k = 0; k < 10; k++) {
        put_row(&m, 200, k, 0, 3);
        if (k == 4)
            put_format(&m, 210, 35, "DYN", "Qffffff", "TimeUS,A,B,C,D,E,F");
        if (k >= 4)
            put_row(&m, 210, k, 0, 0);
    }
    check_made(&m, 10);
}

/* Two logs put together, of versions that have the fields in another order, under the same number
 * or under another one. */
static void formats_that_change(void **state)
{
    (void)state;
    static made m;
    for (int number = 200; number <= 201; number++) {
        m.size = 0;
        put_head(&m);
        put_format(&m, 200, 35, "IMU", "Qffffff", GYROS_FIRST);
        for (int k = 0; k < 5; k++)
            put_row(&m, 200, k, 0, 3);
        put_head(&m);
        put_format(&m, number, 35, "IMU", "Qffffff", FORCES_FIRST);
        if (number == 201) /* what is no sensor any more */
            put_format(&m, 200, 35, "BARO", "Qffffff", "TimeUS,A,B,C,D,E,F");
        for (int k = 5; k < 10; k++) {
            put_row(&m, number, k, 3, 0);
            if (number == 201)
                put_row(&m, 200, k, 1, 2);
        }
        check_made(&m, 10);
        imk_log_reader *reader;
        imk_error error;
        CHECK_OK(imk_log_open_memory(m.at, m.size, NULL, &reader, &error));
        CHECK_STATUS(imk_log_seek(reader, 0.5, &error), IMK_ERROR_UNSUPPORTED);
        imk_log_close(reader);
    }
}

/* ... and of versions with other columns, or with another unit: no row of the second is read. */
static void formats_that_lose_columns(void **state)
{
    (void)state;
    static made m;
    for (int unit = 0; unit < 2; unit++) {
        m.size = 0;
        put_head(&m);
        put_format(&m, 200, 35, "IMU", "Qffffff", GYROS_FIRST);
        for (int k = 0; k < 5; k++)
            put_row(&m, 200, k, 0, 3);
        const size_t joint = m.size;
        put_head(&m);
        put_format(&m, 201, 35, "IMU", "Qffffff",
                   unit ? FORCES_FIRST : "TimeUS,GyrX,GyrY,GyrZ,A,B,C");
        if (unit) {
            char fields[44] = {0};
            put_format(&m, 1, 76, "UNIT", "QbZ", "TimeUS,Id,Label");
            put_header(&m, 1);
            memcpy(fields + 8, "kdeg/s", 6);
            put(&m, fields, 44);
            put(&m, (char[29]){0}, 29);
            put_format(&m, 2, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");
            put_header(&m, 2);
            memset(fields, 0, sizeof fields);
            fields[8] = (char)201;
            memcpy(fields + 9, "----kkk", 7);
            put(&m, fields, 41);
        }
        for (int k = 5; k < 10; k++)
            put_row(&m, 201, k, 3, 0);
        read_bytes(m.at, m.size, NULL, 4, &t);
        assert_int_equal(t.rows, 5);
        CHECK_STATUS(t.status, IMK_ERROR_COLUMN);
        char due[80];
        snprintf(due, sizeof due, "\"head -c %zu\" and \"tail -c +%zu\"", joint, joint + 1);
        if (!strstr(t.error.expected, due))
            fail_msg("\"%s\" lacks \"%s\"", t.error.expected, due);
    }
}

/* A temperature that comes later than the look at the beginning, 8 MiB, is no column, but told. */
static void temperatures_that_come_later(void **state)
{
    (void)state;
    enum { ROWS = 20, FILLING = 255, FILLED = 9 << 20 };
    static made m;
    m.size = 0;
    put_head(&m);
    put_format(&m, 200, 39, "IMU", "Qfffffff", GYROS_FIRST ",T");
    put_format(&m, 201, FILLING, "FILL", "ZZZNNNdi", "A,B,C,D,E,F,G,H");
    char *at = malloc(FILLED + sizeof m.at), *end = at;
    assert_non_null(at);
    memcpy(end, m.at, m.size);
    end += m.size;
    for (int k = 0; k < ROWS; k++) {
        const float temperature = k < ROWS / 2 ? NAN : 20;
        m.size = 0;
        put_row(&m, 200, k, 0, 3);
        put(&m, &temperature, 4);
        memcpy(end, m.at, m.size);
        end += m.size;
        for (int i = 0; k == ROWS / 2 - 1 && i < FILLED / FILLING; i++, end += FILLING) {
            memset(end, 0, FILLING);
            memcpy(end, "\xA3\x95\xC9", 3);
        }
    }
    read_bytes(at, (size_t)(end - at), NULL, 64, &t);
    free(at);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.rows, ROWS);
    assert_int_equal(t.columns, 7);
    assert_int_equal(t.findings.damaged, 0);
    assert_int_equal(t.findings.later[2], ROWS / 2);
}

static int load(void **state)
{
    (void)state;
    log_bytes = fixture("flight.bin");
    return 0;
}

static int unload(void **state)
{
    (void)state;
    free(log_bytes.at);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_sensors_are_listed),
        cmocka_unit_test(rows_of_both_kinds),
        cmocka_unit_test(units_and_multipliers_of_the_log),
        cmocka_unit_test(batches_become_rows),
        cmocka_unit_test(old_logs),
        cmocka_unit_test(cut_and_damaged_logs),
        cmocka_unit_test(bytes_that_are_lost),
        cmocka_unit_test(any_place_can_be_gone_to),
        cmocka_unit_test(what_cannot_be_read_is_refused),
        cmocka_unit_test(messages_right_behind_their_format),
        cmocka_unit_test(formats_that_change),
        cmocka_unit_test(formats_that_lose_columns),
        cmocka_unit_test(temperatures_that_come_later),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
