/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of PX4. flight.ulg was written by make_flight_logs.py, after the published format and
 * without imukit; its values are formulas, which are computed here again, so that all numbers agree
 * to the last bit. */
#define _DEFAULT_SOURCE
#include "flight_table.h"

#include "imukit/io.h"

#include <unistd.h>
#include <zlib.h>

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

/* A time in us, as it comes in seconds. */
static double seconds(double us)
{
    return us * 1e-6;
}

static void all_sensors_are_listed(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int instance;
        uint64_t rows;
        double begin, end; /* [us], by the formulas of make_flight_logs.py */
    } due[] = {{"sensor_combined", 0, 43, 6000000, 6168000},
               {"sensor_gyro", 0, 20, 6000001, 6190001},
               {"sensor_gyro", 1, 4, 6060002, 6090002},
               {"sensor_accel", 0, 8, 6000000, 6140000},
               {"sensor_gyro_fifo", 0, 51, 7000000 - 7 * 125.125, 7004000},
               {"vehicle_imu", 0, 8, 6000000, 6035000},
               {"sensor_mag", 0, 8, 1, 1}};
    char path[] = SOURCE_DIRECTORY "/tests/io/log/flight/flight.ulg";
    imk_log_stream stream[16];
    size_t count;
    imk_error error;
    CHECK_OK(imk_log_streams(path, NULL, 16, stream, &count, NULL, &error));
    assert_int_equal(count, 7);
    for (size_t i = 0; i < count; i++) {
        assert_string_equal(stream[i].name, due[i].name);
        assert_string_equal(stream[i].kind, due[i].name);
        assert_int_equal(stream[i].instance, due[i].instance);
        assert_true(stream[i].readable == (i < 6));
        assert_false(stream[i].estimated);
        assert_int_equal(stream[i].samples, due[i].rows);
        CHECK_RELATIVE(stream[i].begin, seconds(due[i].begin), 1e-15);
        CHECK_RELATIVE(stream[i].end, seconds(due[i].end), 1e-15);
    }
}

static void combined_rows(void **state)
{
    (void)state;
    static const char *const names[] = {"time",
                                        "gyro_x",
                                        "gyro_y",
                                        "gyro_z",
                                        "accel_x",
                                        "accel_y",
                                        "accel_z",
                                        "accelerometer_timestamp_relative",
                                        "gyro_integral_dt",
                                        "accelerometer_integral_dt"};
    const imk_log_settings settings = sensor("sensor_combined", -1);
    read_bytes(log_bytes.at, log_bytes.size, &settings, 64, &t);
    assert_int_equal(t.status, IMK_OK);
    assert_int_equal(t.columns, 10);
    for (int i = 0; i < 10; i++)
        assert_string_equal(t.names[i], names[i]);
    assert_int_equal(t.rows, 43);
    for (int k = 0; k < 43; k++) {
        assert_true(t.value[0][k] == seconds(6000000 + 4000.0 * k));
        for (int axis = 0; axis < 3; axis++) {
            assert_true(t.value[1 + axis][k] == value(k, axis));
            if (k == 5)
                assert_true(isnan(t.value[4 + axis][k]));
            else
                assert_true(t.value[4 + axis][k] == value(k, 3 + axis));
        }
        assert_true(t.value[8][k] == seconds(4000) && t.value[9][k] == seconds(3990));
    }
    /* Row 6 has forces that are not valid; a message was cut off where data were appended. */
    assert_int_equal(t.findings.not_finite, 1);
    assert_int_equal(t.findings.first_not_finite, 6);
    assert_int_equal(t.findings.damaged, 1);
    assert_int_equal(t.findings.first_damaged, 40);
    assert_false(t.findings.cut_short);
}

static void instances_and_old_formats(void **state)
{
    (void)state;
    imk_log_settings settings = sensor("sensor_gyro", 0);
    read_bytes(log_bytes.at, log_bytes.size, &settings, 7, &t);
    assert_int_equal(t.rows, 20);
    assert_string_equal(t.names[4], "temperature");
    for (int k = 0; k < 20; k++) { /* message 3 has no timestamp_sample */
        assert_true(t.value[0][k] == seconds(6000001 + 10000.0 * k + (k == 3 ? 300 : 0)));
        assert_true(t.value[3][k] == value(k + 1, 2)); /* axes(k + number), number 1 */
        assert_true(t.value[4][k] == 25 + k / 8.0 + 273.15);
    }
    settings = sensor("sensor_gyro", 1);
    read_bytes(log_bytes.at, log_bytes.size, &settings, 7, &t);
    assert_int_equal(t.rows, 4);
    for (int k = 0; k < 4; k++) {
        assert_true(t.value[0][k] == seconds(6060002 + 10000.0 * k));
        assert_true(t.value[1][k] == value(k + 6 + 2, 0));
    }
    /* Doubles behind a nested format; a temperature that is always NaN is no column. */
    settings = sensor("accel", -1); /* an ending that only one has */
    read_bytes(log_bytes.at, log_bytes.size, &settings, 7, &t);
    assert_int_equal(t.rows, 8);
    assert_int_equal(t.columns, 4);
    assert_int_equal(t.findings.not_finite, 0);
    for (int k = 0; k < 8; k++)
        assert_true(t.value[2][k] == value(k, 1) && t.value[0][k] == seconds(6e6 + 2e4 * k));
}

static void arrays_become_rows(void **state)
{
    (void)state;
    static const int samples[] = {8, 8, 3, 0, 32};
    static table other;
    const imk_log_settings settings = sensor("sensor_gyro_fifo", -1);
    const float scale = 0.0010652645f, interval = 125.125f;
    read_bytes(log_bytes.at, log_bytes.size, &settings, 256, &t);
    assert_int_equal(t.rows, 51);
    size_t row = 0;
    for (int k = 0; k < 5; k++)
        for (int i = 0; i < samples[k]; i++, row++) {
            const double behind = (double)(samples[k] - 1 - i) * (double)interval;
            assert_true(t.value[0][row] == seconds(7e6 + 1000 * k - behind));
            for (int axis = 0; axis < 3; axis++)
                assert_true(t.value[1 + axis][row] == whole(100 * k + i, axis) * (double)scale);
        }
    for (size_t block = 1; block < 40; block += 4) { /* pieces end within a message */
        read_bytes(log_bytes.at, log_bytes.size, &settings, block, &other);
        assert_int_equal(other.rows, 51);
        check_same_rows(&t, 0, &other, 0, 51);
    }
}

static void increments_become_mean_rates(void **state)
{
    (void)state;
    const imk_log_settings settings = sensor("vehicle_imu", -1);
    read_bytes(log_bytes.at, log_bytes.size, &settings, 3, &t);
    assert_int_equal(t.rows, 8);
    for (int k = 0; k < 8; k++)
        for (int axis = 0; axis < 3; axis++) {
            assert_true(t.value[4 + axis][k] == value(k, 3 + axis) * 1e6 / (5000 - k));
            if (k == 2) /* it has no duration */
                assert_true(isnan(t.value[1 + axis][k]));
            else
                assert_true(t.value[1 + axis][k] == value(k, axis) * 1e6 / (4999 + k));
        }
    assert_int_equal(t.findings.not_finite, 1);
}

static void axes_are_turned(void **state)
{
    (void)state;
    imk_log_settings settings = sensor("sensor_accel", -1);
    settings.axes = "forward-left-up";
    read_bytes(log_bytes.at, log_bytes.size, &settings, 64, &t);
    assert_true(t.value[1][4] == value(4, 0) && t.value[2][4] == -value(4, 1));
}

/* Place of the first message of a kind. */
static size_t place_of(const bytes *b, char kind)
{
    size_t at = 16;
    while (b->at[at + 2] != kind)
        at += 3 + (unsigned char)b->at[at] + 256 * (size_t)(unsigned char)b->at[at + 1];
    return at;
}

/* Without what is appended, three messages of 50 bytes, and without the 30 that are cut off. */
static bytes plain_log(void)
{
    const bytes b = {malloc(log_bytes.size), log_bytes.size - 3 * 50 - 30};
    assert_non_null(b.at);
    memcpy(b.at, log_bytes.at, b.size);
    memset(b.at + 27, 0, 32); /* the flags and the places */
    return b;
}

static void cut_and_damaged_logs(void **state)
{
    (void)state;
    const imk_log_settings combined = sensor("sensor_combined", -1);
    const imk_log_settings fifo = sensor("sensor_gyro_fifo", -1);
    check_cut(&log_bytes, &combined, 7);
    check_cut(&log_bytes, &fifo, 61);
    const size_t from = place_of(&log_bytes, 'D'); /* nothing replaces the definitions */
    assert_true(check_damage(&log_bytes, &combined, from, 9, 0) > 10);
    assert_true(check_damage(&log_bytes, &combined, from, 60, 0xFF) > 10);
    assert_true(check_damage(&log_bytes, &fifo, from, 30, 'D') > 1);
}

static void bytes_that_are_lost(void **state)
{
    (void)state;
    static table hurt;
    const imk_log_settings settings = sensor("sensor_combined", -1);
    const bytes plain = plain_log();
    const size_t first = place_of(&plain, 'D');
    read_bytes(plain.at, plain.size, &settings, 64, &t);
    assert_int_equal(t.rows, 40);
    char *copy = malloc(plain.size);
    assert_non_null(copy);
    for (size_t at = first; at + 40 < plain.size; at += 11) {
        memcpy(copy, plain.at, at);
        memcpy(copy + at, plain.at + at + 40, plain.size - at - 40);
        read_bytes(copy, plain.size - 40, &settings, 64, &hurt);
        size_t place = 0;
        for (size_t row = 0; row < hurt.rows; row++) /* no row is made up of two */
            assert_true(find_row(&hurt, row, &t, &place));
        assert_true(hurt.rows + 3 >= t.rows && hurt.rows < t.rows + 1);
        assert_true(hurt.findings.damaged > 0 || hurt.findings.cut_short);
    }
    free(copy);
    free(plain.at);
}

static void any_place_can_be_gone_to(void **state)
{
    (void)state;
    static table part;
    const imk_log_settings settings = sensor("sensor_combined", -1);
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
        before = part.rows;
    }
    assert_true(before <= 1);
    imk_log_close(reader);
}

/* The same messages again and again, 9 MiB. */
static bytes long_log(void)
{
    const bytes plain = plain_log();
    const size_t first = place_of(&plain, 'D'), length = plain.size - first;
    const size_t rounds = (9 << 20) / length;
    bytes b = {malloc(first + rounds * length), first};
    assert_non_null(b.at);
    memcpy(b.at, plain.at, first);
    for (size_t i = 0; i < rounds; i++, b.size += length)
        memcpy(b.at + b.size, plain.at + first, length);
    free(plain.at);
    return b;
}

static size_t count_rows(imk_log_reader *reader)
{
    static double values[TABLE_COLUMNS][1000];
    double *columns[TABLE_COLUMNS];
    size_t rows, total = 0;
    imk_error error;
    for (int i = 0; i < TABLE_COLUMNS; i++)
        columns[i] = values[i];
    do {
        CHECK_OK(imk_log_read(reader, 1000, columns, &rows, &error));
        total += rows;
    } while (rows > 0);
    return total;
}

static void long_logs_are_estimated(void **state)
{
    (void)state;
    bytes b = long_log();
    const imk_log_settings settings = sensor("sensor_combined", -1);
    imk_log_reader *reader;
    imk_error error;
    char path[] = "/tmp/imukit-flight-XXXXXX";
    CHECK_OK(imk_log_open_memory(b.at, b.size, &settings, &reader, &error));
    const imk_log_stream *about = imk_log_stream_get(reader);
    const size_t rows = count_rows(reader);
    assert_true(rows > 60000);
    assert_true(about->estimated);
    CHECK_RELATIVE((double)about->samples, (double)rows, 1e-3);
    assert_true(about->end == seconds(6000000 + 4000.0 * 39));
    assert_int_equal(imk_log_findings_get(reader).damaged, 0);
    imk_log_close(reader);
    /* Compressed, it is not gone about in: the first bytes are kept until they are read. */
    const int file = mkstemp(path);
    gzFile out = gzdopen(file, "wb1");
    assert_int_equal(gzwrite(out, b.at, (unsigned)b.size), b.size);
    assert_int_equal(gzclose(out), Z_OK);
    CHECK_OK(imk_log_open(path, &settings, &reader, &error));
    assert_int_equal(count_rows(reader), rows);
    assert_true(isnan(imk_log_stream_get(reader)->end));
    CHECK_STATUS(imk_log_seek(reader, 0.5, &error), IMK_ERROR_UNSUPPORTED);
    imk_log_close(reader);
    unlink(path);
    free(b.at);
}

static void check_refused(const char *at, size_t size, imk_status due, const char *words)
{
    char text[400];
    read_bytes(at, size, NULL, 64, &t);
    CHECK_STATUS(t.opened, due);
    imk_error_text(&t.error, "x.ulg", text, sizeof text);
    if (!strstr(text, words))
        fail_msg("\"%s\" lacks \"%s\"", text, words);
}

static void what_cannot_be_read_is_refused(void **state)
{
    (void)state;
    char head[64];
    memcpy(head, log_bytes.at, sizeof head);
    check_refused("ULogEnc\1........................................................", 64,
                  IMK_ERROR_FORMAT, "decrypt");
    check_refused(head, 15, IMK_ERROR_FORMAT, "ends in its header");
    check_refused("ULog..........................................................", 60,
                  IMK_ERROR_FORMAT, "damaged");
    check_refused(head, 59, IMK_ERROR_EMPTY, "no messages of gyros");
    head[27] |= 2; /* an incompatible flag of a later version */
    check_refused(head, 59, IMK_ERROR_FORMAT, "flags");
    check_refused(log_bytes.at, log_bytes.size, IMK_ERROR_NAME_UNKNOWN,
                  "the log holds 6 sensors; add --topic sensor_combined (or --topic sensor_gyro "
                  "--instance 0, --topic sensor_gyro --instance 1, ...)");
}

/* What a reader of its own, ulog_oracle.py, finds in real logs. */
static void real_logs(void **state)
{
    (void)state;
    static const struct {
        const char *file, *topic;
        int instance;
        size_t rows;
        double first, last; /* times [s] */
        double gyro, accel; /* sums of all values of x, y, z times 1, 2, 3; 0: none */
    } due[] = {
#include "ulog_oracle.inc"
    };
    for (size_t i = 0; i < sizeof due / sizeof due[0]; i++) {
        static double values[TABLE_COLUMNS][8192];
        double *columns[TABLE_COLUMNS], sum[2] = {0, 0};
        char path[512];
        snprintf(path, sizeof path, SHARED_DIRECTORY "/data/logs/%s", due[i].file);
        if (access(path, R_OK) != 0) {
            print_message("%s is absent: skipped\n", path);
            continue;
        }
        const imk_log_settings settings = sensor(due[i].topic, due[i].instance);
        imk_log_reader *reader;
        imk_error error;
        size_t rows;
        CHECK_OK(imk_log_open(path, &settings, &reader, &error));
        assert_int_equal(imk_log_stream_get(reader)->samples, due[i].rows);
        for (size_t j = 0; j < TABLE_COLUMNS; j++)
            columns[j] = values[j];
        CHECK_OK(imk_log_read(reader, 8192, columns, &rows, &error));
        assert_int_equal(rows, due[i].rows);
        for (int kind = 0; kind < 2; kind++)
            for (int axis = 0; axis < 3; axis++) {
                const int column = imk_log_column_find(
                    reader, kind == 0 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE,
                    axis);
                for (size_t row = 0; row < rows && column >= 0; row++)
                    sum[kind] += (axis + 1) * values[column][row];
            }
        const imk_log_findings found = imk_log_findings_get(reader);
        CHECK_CLOSE(found.time_origin + values[0][0], due[i].first, 1e-6 + 2.5e-7);
        CHECK_CLOSE(found.time_origin + values[0][rows - 1], due[i].last, 1e-6 + 2.5e-7);
        CHECK_CLOSE(sum[0], due[i].gyro, 1e-9);
        CHECK_CLOSE(sum[1], due[i].accel, 1e-6);
        assert_int_equal(found.damaged, 0);
        imk_log_close(reader);
    }
}

static int load(void **state)
{
    (void)state;
    log_bytes = fixture("flight.ulg");
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
        cmocka_unit_test(all_sensors_are_listed),         cmocka_unit_test(combined_rows),
        cmocka_unit_test(instances_and_old_formats),      cmocka_unit_test(arrays_become_rows),
        cmocka_unit_test(increments_become_mean_rates),   cmocka_unit_test(axes_are_turned),
        cmocka_unit_test(cut_and_damaged_logs),           cmocka_unit_test(bytes_that_are_lost),
        cmocka_unit_test(any_place_can_be_gone_to),       cmocka_unit_test(long_logs_are_estimated),
        cmocka_unit_test(what_cannot_be_read_is_refused), cmocka_unit_test(real_logs),
    };
    return cmocka_run_group_tests(tests, load, unload);
}
