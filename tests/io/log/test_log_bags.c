/* SPDX-License-Identifier: Apache-2.0 */
/* Bags as the reference programs wrote them (tests/fixtures): every row to the last bit, from
 * files, memory and pipes; what an index tells; bags that are cut short or damaged. */
#define _POSIX_C_SOURCE 200809L
#include "bag_files.h"

#include "io/log/ros/log_ros_imu_internal.h"

#include <sys/stat.h>

enum { SAMPLES = 10 };

/* The formulas of experiments/formats/samples.py. */
static const int64_t start = INT64_C(1700000000123456789), step = 5000001, delay = 1500000;

static double sample(size_t i, size_t column)
{
    if (column == 0)
        return (double)((int64_t)i * step) / 1e9;
    const double axis = (double)((column - 1) % 3);
    return column < 4 ? (double)i * 0.001 + axis * 0.1 : (double)i * -0.01 + axis * 9.80665;
}

/* Rows are samples first … first + rows - 1, to the last bit. @param from  first column of sample()
 * behind the time */
static void check_rows(const bag_table *t, size_t first, size_t from)
{
    for (size_t i = 0; i < t->rows; i++)
        for (size_t c = 0; c < t->columns; c++) {
            const double due = sample(first + i, c == 0 ? 0 : from + c - 1);
            if (t->data[c][i] != due)
                print_error("row %zu, column %zu: %.17g, due %.17g\n", i, c, t->data[c][i], due);
            assert_true(t->data[c][i] == due);
        }
}

static const char *const whole[] = {
    "none.bag",        "bz2.bag",       "lz4.bag",       "outside.bag", "cdr_none.mcap",
    "cdr_lz4.mcap",    "cdr_zstd.mcap", "ros1_lz4.mcap", "big.mcap",    "unchunked.mcap",
    "no_summary.mcap", "single.db3",    "two",           "packed",      "messages",
};
enum { WHOLE = sizeof whole / sizeof whole[0] };

static void path_of(const char *name, char path[256])
{
    snprintf(path, 256, BAGS "%s", name);
}

static bool is_folder(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && S_ISDIR(about.st_mode);
}

/* ---- whole logs ---- */

static void test_files(void **state)
{
    (void)state;
    static bag_table t;
    char path[256];
    for (size_t i = 0; i < WHOLE; i++) {
        imk_log_reader *reader;
        imk_error error;
        path_of(whole[i], path);
        CHECK_OK(imk_log_open(path, NULL, &reader, &error));
        assert_string_equal(imk_log_stream_get(reader)->name, "/imu/data");
        assert_int_equal(imk_log_column_get(reader, 1)->unit_origin, IMK_UNIT_OF_FORMAT);
        CHECK_OK(bag_read(reader, 1 + i, &t, &error));
        assert_int_equal(t.rows, SAMPLES);
        assert_int_equal(t.columns, 7);
        check_rows(&t, 0, 1);
        assert_int_equal(t.findings.damaged, 0);
        assert_false(t.findings.cut_short || t.findings.received);
        assert_int_equal(t.findings.other_frames, 0);
        CHECK_RELATIVE(t.findings.time_origin, (double)start / 1e9, 1e-15);
        /* Again from the first row, and from another place. */
        const imk_record_source source = imk_log_source(reader);
        CHECK_OK(source.rewind(source.context, &error));
        CHECK_OK(bag_read(reader, 7, &t, &error));
        assert_int_equal(t.rows, SAMPLES);
        check_rows(&t, 0, 1);
        CHECK_OK(imk_log_seek(reader, 0.9, &error));
        CHECK_OK(bag_read(reader, 7, &t, &error));
        check_rows(&t, SAMPLES - t.rows, 1);
        imk_log_close(reader);
    }
}

static void test_memory_and_pipes(void **state)
{
    (void)state;
    static bag_table t;
    char path[256], pipe_path[256];
    for (size_t i = 0; i < WHOLE; i++) {
        imk_log_reader *reader;
        imk_error error;
        size_t size;
        int ends[2];
        path_of(whole[i], path);
        if (is_folder(path))
            continue;
        char *bytes = bag_bytes(path, &size);
        CHECK_OK(imk_log_open_memory(bytes, size, NULL, &reader, &error));
        CHECK_OK(bag_read(reader, 3, &t, &error));
        assert_int_equal(t.rows, SAMPLES);
        check_rows(&t, 0, 1);
        imk_log_close(reader);
        assert_int_equal(pipe(ends), 0);
        assert_int_equal(write(ends[1], bytes, size), size); /* less than a pipe holds */
        close(ends[1]);
        snprintf(pipe_path, sizeof pipe_path, "/dev/fd/%d", ends[0]);
        CHECK_OK(bag_load(pipe_path, NULL, &t, &error));
        assert_int_equal(t.rows, SAMPLES);
        check_rows(&t, 0, 1);
        close(ends[0]);
        free(bytes);
    }
}

/* A folder of two MCAP files, of which each has all samples. */
static void test_parts(void **state)
{
    (void)state;
    static bag_table t;
    imk_error error;
    CHECK_OK(bag_load(BAGS "parts/", NULL, &t, &error));
    assert_int_equal(t.rows, 2 * SAMPLES);
    assert_true(t.data[0][SAMPLES] == 0.0 && t.data[3][SAMPLES + 1] == sample(1, 3));
    assert_int_equal(t.findings.reversals, 1);
}

static void test_absent_and_unstamped(void **state)
{
    (void)state;
    static bag_table t;
    imk_error error;
    CHECK_OK(bag_load(BAGS "no_gyro.bag", NULL, &t, &error));
    assert_int_equal(t.columns, 4);
    assert_int_equal(t.rows, 3);
    check_rows(&t, 0, 4);
    CHECK_OK(bag_load(BAGS "unstamped.bag", NULL, &t, &error));
    check_rows(&t, 0, 1); /* all are recorded with the same delay */
    assert_true(t.findings.received);
    CHECK_RELATIVE(t.findings.time_origin, (double)(start + delay) / 1e9, 1e-15);
}

/* ---- topics ---- */

static void test_streams(void **state)
{
    (void)state;
    static const char *const indexed[] = {"none.bag", "cdr_zstd.mcap", "two", "parts"};
    imk_log_stream stream[4];
    size_t count;
    imk_error error;
    for (size_t i = 0; i < 4; i++) {
        char path[256];
        path_of(indexed[i], path);
        CHECK_OK(imk_log_streams(path, NULL, 4, stream, &count, NULL, &error));
        assert_int_equal(count, 2);
        for (int k = 0; k < 2; k++) {
            const bool imu = strcmp(stream[k].name, "/imu/data") == 0;
            const size_t due = (imu ? SAMPLES : 2) * (i == 3 ? 2u : 1u);
            assert_true(stream[k].readable == imu);
            assert_int_equal(stream[k].samples, i == 3 && !imu ? 3 : due);
            assert_int_equal(stream[k].instance, -1);
            if (imu && i < 3) {
                CHECK_CLOSE(stream[k].begin, (double)(start + delay) / 1e9, 1e-6);
                CHECK_CLOSE(stream[k].end, (double)(start + delay + 9 * step) / 1e9, 1e-6);
            }
        }
    }
    CHECK_OK(imk_log_streams(BAGS "single.db3", NULL, 4, stream, &count, NULL, &error));
    assert_int_equal(count, 2);
    assert_string_equal(stream[1].kind, "sensor_msgs/msg/Imu");
    assert_int_equal(stream[1].samples, 0); /* not known */
}

static void test_two_topics(void **state)
{
    (void)state;
    static bag_table t;
    imk_error error;
    imk_log_settings settings = imk_log_default();
    bag_refused(BAGS "two_topics.bag", NULL, IMK_ERROR_NAME_UNKNOWN, "holds 2 sensors",
                "--topic /left/imu (or --topic /right/imu)");
    settings.topic = "right/imu";
    CHECK_OK(bag_load(BAGS "two_topics.bag", &settings, &t, &error));
    assert_int_equal(t.rows, 3);
    assert_true(t.data[1][0] == sample(3, 1));
    settings.topic = "/middle";
    bag_refused(BAGS "two_topics.bag", &settings, IMK_ERROR_NAME_UNKNOWN, "/middle", "--topic");
    settings.topic = NULL;
    settings.columns = "time,gyro_x";
    bag_refused(BAGS "none.bag", &settings, IMK_ERROR_CONFLICT, "", "--columns");
}

/* A record of a bag without chunks, by its `op` and a text in it. @return its size */
static size_t find_record(const char *bag, size_t size, int op, const char *text, const char **at)
{
    for (size_t place = 13; place < size;) {
        const size_t header = imki_get_u32((const uint8_t *)bag + place);
        const size_t data = imki_get_u32((const uint8_t *)bag + place + 4 + header);
        const size_t all = 8 + header + data, length = strlen(text);
        bool is_op = false, has = false;
        for (size_t i = 4; i + 4 <= 4 + header; i++)
            is_op |= memcmp(bag + place + i, "op=", 3) == 0 && bag[place + i + 3] == op;
        for (size_t i = 4; i + length <= all; i++)
            has |= memcmp(bag + place + i, text, length) == 0;
        if (is_op && has) {
            *at = bag + place;
            return all;
        }
        place += all;
    }
    fail();
    return 0;
}

/* The same record of connection 200 and its topic /imu/dat2. */
static void rename_record(char *record, size_t size)
{
    for (size_t i = 0; i + 9 <= size; i++) {
        if (memcmp(record + i, "conn=", 5) == 0)
            record[i + 5] = (char)200;
        if (memcmp(record + i, "/imu/data", 9) == 0)
            record[i + 8] = '2';
    }
}

/* Behind the part that is looked at, a second sensor begins in a bag without index: it is told when
 * it comes, and found when it is asked for. */
static void test_second_topic_later(void **state)
{
    (void)state;
    enum { MESSAGES = 52000 }; /* above 16 MiB */
    const char *connection, *message, *head;
    size_t size;
    char *bag = bag_bytes(BAGS "outside.bag", &size);
    const size_t begin = 13 + find_record(bag, size, 3, "index_pos", &head);
    const size_t first = find_record(bag, size, 7, "sensor_msgs/Imu", &connection);
    const size_t each = find_record(bag, size, 2, "sensor", &message);
    const size_t all = begin + 2 * first + (MESSAGES + 1) * each;
    char *long_bag = malloc(all), *at = long_bag;
    assert_non_null(long_bag);
    assert_true(MESSAGES * each > (16 << 20) + 1000);
    memcpy(at, bag, begin);
    memcpy(at += begin, connection, first);
    at += first;
    for (int i = 0; i < MESSAGES; i++, at += each)
        memcpy(at, message, each);
    memcpy(at, connection, first);
    rename_record(at, first);
    memcpy(at += first, message, each);
    rename_record(at, each);
    static const char *const topics[] = {NULL, "/imu/data", "/imu/dat2"};
    for (int asked = 0; asked < 3; asked++) {
        static double values[BAG_COLUMNS][1024];
        imk_log_settings settings = imk_log_default();
        imk_log_reader *reader;
        imk_error error;
        double *to[BAG_COLUMNS];
        size_t rows = 1, total = 0;
        for (int c = 0; c < BAG_COLUMNS; c++)
            to[c] = values[c];
        settings.topic = topics[asked];
        CHECK_OK(imk_log_open_memory(long_bag, all, &settings, &reader, &error));
        imk_status status = IMK_OK;
        while (status == IMK_OK && rows > 0) {
            status = imk_log_read(reader, 1024, to, &rows, &error);
            total += status == IMK_OK ? rows : 0;
        }
        assert_int_equal(total, asked == 2 ? 1 : MESSAGES);
        CHECK_STATUS(status, asked ? IMK_OK : IMK_ERROR_NAME_UNKNOWN);
        if (!asked) {
            assert_string_equal(error.found, "a second sensor, /imu/dat2, begins later");
            assert_string_equal(error.expected, "add --topic /imu/data (or --topic /imu/dat2)");
        }
        imk_log_close(reader);
    }
    free(long_bag);
    free(bag);
}

/* ---- places ---- */

/* Rows behind a place are those that follow the first of them, up to the last. */
static void test_seek(void **state)
{
    (void)state;
    static bag_table t;
    char path[256];
    for (size_t i = 0; i < WHOLE; i++) {
        imk_log_reader *reader;
        imk_error error;
        path_of(whole[i], path);
        CHECK_OK(imk_log_open(path, NULL, &reader, &error));
        for (int k = 0; k <= 4; k++) {
            CHECK_OK(imk_log_seek(reader, k / 4.0, &error));
            CHECK_OK(bag_read(reader, 1000, &t, &error));
            assert_true(t.rows >= 1 && t.rows <= SAMPLES && (k > 0 || t.rows == SAMPLES));
            check_rows(&t, SAMPLES - t.rows, 1);
            assert_int_equal(t.findings.damaged, 0);
        }
        imk_log_close(reader);
    }
}

static void test_no_seek_in_a_pipe(void **state)
{
    (void)state;
    int ends[2];
    size_t size;
    imk_log_reader *reader;
    imk_error error;
    char *bytes = bag_bytes(BAGS "none.bag", &size), path[64];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], bytes, size), size);
    close(ends[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    CHECK_OK(imk_log_open(path, NULL, &reader, &error));
    CHECK_STATUS(imk_log_seek(reader, 0.5, &error), IMK_ERROR_UNSUPPORTED);
    imk_log_close(reader);
    close(ends[0]);
    free(bytes);
}

/* ---- faults ---- */

/* However a log is cut, what is read is its beginning, and it is told; or it is refused in words.
 */
static void test_cut_short(void **state)
{
    (void)state;
    static bag_table t;
    char path[256];
    for (size_t i = 0; i < WHOLE; i++) {
        size_t size, read = 0;
        path_of(whole[i], path);
        if (is_folder(path))
            continue;
        char *bytes = bag_bytes(path, &size);
        for (size_t cut = 20; cut < size; cut += check_quick() ? 199 : 11) {
            imk_log_reader *reader = NULL;
            imk_error error = {.status = IMK_OK};
            imk_status status = imk_log_open_memory(bytes, cut, NULL, &reader, &error);
            if (status == IMK_OK)
                status = bag_read(reader, 100, &t, &error);
            assert_true(status == IMK_OK || (error.status == status && error.found[0] != '\0'));
            if (reader) {
                check_rows(&t, 0, 1);
                assert_true(t.rows <= SAMPLES && t.rows >= read);
                read = t.rows; /* more bytes, more rows */
                assert_true(t.rows == SAMPLES || t.findings.cut_short || status != IMK_OK ||
                            strcmp(whole[i], "outside.bag") == 0);
            }
            imk_log_close(reader);
        }
        /* A page of a database has several. */
        assert_true(read >= (strstr(whole[i], ".db3") ? 1 : SAMPLES - 1));
        free(bytes);
    }
}

/* A byte in the rates of the first chunk is another: its CRC tells, and the others are read. */
static void test_wrong_sum(void **state)
{
    (void)state;
    static bag_table t;
    imk_log_reader *reader;
    imk_error error;
    size_t size, at = 0;
    char *bytes = bag_bytes(BAGS "cdr_none.mcap", &size);
    while (memcmp(bytes + at, "sensor\0", 7) != 0)
        at++;
    bytes[at + 120] ^= 1;
    CHECK_OK(imk_log_open_memory(bytes, size, NULL, &reader, &error));
    CHECK_OK(bag_read(reader, 100, &t, &error));
    assert_int_equal(t.findings.damaged, 1);
    assert_int_equal(t.findings.first_damaged, 0);
    assert_true(t.rows > 0 && t.rows < SAMPLES);
    assert_true(t.data[1][0] == sample(SAMPLES - t.rows, 1));
    imk_log_close(reader);
    free(bytes);
}

/* Messages of other frames than the first are rows as the others, are counted and named; the count
 * begins anew with another place. */
static void test_frames(void **state)
{
    (void)state;
    static const char *const files[] = {"none.bag", "unchunked.mcap", "single.db3"};
    static const char *const other[] = {NULL, NULL, "le\tft!", NULL, "right!", "le\tft!"};
    static bag_table t;
    char path[256], copy[256];
    for (size_t i = 0; i < 3; i++) {
        imk_log_reader *reader;
        imk_error error;
        size_t size, met = 0;
        path_of(files[i], path);
        char *bytes = bag_bytes(path, &size);
        for (size_t at = 0; at + 7 <= size; at++) {
            if (memcmp(bytes + at, "sensor", 6) != 0 || bytes[at + 6] == '_')
                continue;
            if (met < sizeof other / sizeof other[0] && other[met])
                memcpy(bytes + at, other[met], 6);
            met++;
        }
        assert_int_equal(met, SAMPLES);
        bag_save(bag_path(files[i], copy), bytes, size);
        free(bytes);
        CHECK_OK(imk_log_open(copy, NULL, &reader, &error));
        for (int pass = 0; pass < 2; pass++) {
            CHECK_OK(bag_read(reader, 4, &t, &error));
            assert_int_equal(t.rows, SAMPLES);
            check_rows(&t, 0, 1);
            assert_int_equal(t.findings.other_frames, 3);
            assert_string_equal(t.findings.frames, "\"sensor\", \"le?ft!\", \"right!\"");
            CHECK_OK(imk_log_seek(reader, 0.0, &error));
        }
        imk_log_close(reader);
        unlink(copy);
    }
}

/* One bit of the header of a chunk or of a record in it: rows that are missing then are told. */
static void test_header_bits(void **state)
{
    (void)state;
    static bag_table t;
    static const char *const keys[] = {"op=\5", "op=\2", "op=\7", "compression=", "size=", "conn="};
    size_t size;
    char *bytes = bag_bytes(BAGS "none.bag", &size);
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
        size_t lost = 0;
        for (size_t at = 13; at + 12 < size; at++)
            for (size_t i = 0; i < strlen(keys[k]) && !memcmp(bytes + at, keys[k], strlen(keys[k]));
                 i++)
                for (int bit = 0; bit < 8; bit++) {
                    imk_log_reader *reader = NULL;
                    imk_error error = {.status = IMK_OK};
                    bytes[at + i] ^= (char)(1 << bit);
                    imk_status status = imk_log_open_memory(bytes, size, NULL, &reader, &error);
                    if (status == IMK_OK)
                        status = bag_read(reader, 100, &t, &error);
                    if (status == IMK_OK && t.rows < SAMPLES) {
                        lost++;
                        if (t.findings.damaged == 0)
                            fail_msg("%s: byte %zu, bit %d", keys[k], at + i, bit);
                    }
                    imk_log_close(reader);
                    bytes[at + i] ^= (char)(1 << bit);
                }
        assert_true(lost > 0 || k > 1);
    }
    free(bytes);
}

/* Any byte may be another: nothing is read that is no row, nothing hangs. */
static void test_any_byte(void **state)
{
    (void)state;
    static bag_table t;
    static const char *const names[] = {"lz4.bag", "cdr_zstd.mcap", "single.db3"};
    for (size_t i = 0; i < 3; i++) {
        size_t size;
        char path[256];
        path_of(names[i], path);
        char *bytes = bag_bytes(path, &size);
        for (size_t at = 0; at < size; at += check_quick() ? 97 : 7) {
            imk_log_reader *reader = NULL;
            imk_error error = {.status = IMK_OK};
            bytes[at] ^= 0x55;
            imk_status status = imk_log_open_memory(bytes, size, NULL, &reader, &error);
            if (status == IMK_OK)
                status = bag_read(reader, 100, &t, &error);
            assert_true(status == IMK_OK || error.found[0] != '\0' || error.expected[0] != '\0');
            imk_log_close(reader);
            bytes[at] ^= 0x55;
        }
        free(bytes);
    }
}

static void test_refusals(void **state)
{
    (void)state;
    char path[256], other[300];
    imk_error error;
    static bag_table t;
    bag_save(bag_path("old.bag", path), "#ROSBAG V2.1\n----", 17);
    bag_refused(path, NULL, IMK_ERROR_UNSUPPORTED, "not of version 2.0", "rosbag fix");
    remove(path);
    bag_refused(SOURCE_DIRECTORY "/tests", NULL, IMK_ERROR_OPEN, "without a metadata.yaml",
                "ros2 bag reindex");
    /* A database that is being recorded has a second file. */
    size_t size;
    char *bytes = bag_bytes(BAGS "single.db3", &size);
    bag_save(bag_path("live.db3", path), bytes, size);
    snprintf(other, sizeof other, "%s-wal", path);
    bag_save(other, "messages", 8);
    bag_refused(path, NULL, IMK_ERROR_OPEN, "-wal", "end the recording");
    bag_save(other, "", 0);
    CHECK_OK(bag_load(path, NULL, &t, &error));
    assert_int_equal(t.rows, SAMPLES);
    remove(other);
    /* Its table of messages is called otherwise. */
    for (size_t at = 0; at + 8 < size; at++)
        if (memcmp(bytes + at, "messages", 8) == 0)
            bytes[at] = 'M', bytes[at + 1] = 'x';
    bag_save(path, bytes, size);
    bag_refused(path, NULL, IMK_ERROR_FORMAT, "no tables", "ROS 2");
    remove(path);
    free(bytes);
}

/* Why there is no Imu: another encoding, damage, an end before the first message. */
static void test_none_readable(void **state)
{
    (void)state;
    char path[256];
    size_t size;
    char *bytes = bag_bytes(BAGS "single.db3", &size);
    for (size_t at = 0; at + 3 < size; at++)
        if (memcmp(bytes + at, "cdr", 3) == 0)
            memcpy(bytes + at, "foo", 3);
    bag_save(bag_path("other.db3", path), bytes, size);
    bag_refused(path, NULL, IMK_ERROR_EMPTY,
                "the messages sensor_msgs/msg/Imu are in the encoding \"foo\"", "in cdr");
    remove(path);
    free(bytes);
    bytes = bag_bytes(BAGS "cdr_none.mcap", &size);
    size_t last = 0; /* the last message; what is behind, and knows the topics, is cut off */
    for (size_t at = 0; at + 7 < size; at++)
        last = memcmp(bytes + at, "sensor\0", 7) == 0 ? at : last;
    for (size_t at = 0; at < last; at++) /* every chunk has one */
        if (memcmp(bytes + at, "sensor\0", 7) == 0)
            bytes[at + 120] ^= 1;
    bag_save(bag_path("damaged.mcap", path), bytes, last);
    bag_refused(path, NULL, IMK_ERROR_EMPTY, "no sensor_msgs/Imu can be read, and ", "again");
    remove(path);
    free(bytes);
    bytes = bag_bytes(BAGS "none.bag", &size);
    bag_save(bag_path("cut.bag", path), bytes, 200);
    bag_refused(path, NULL, IMK_ERROR_EMPTY, "the log is cut short", "copy the file again");
    remove(path);
    free(bytes);
}

static void test_metadata_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *text, *found;
        imk_status status;
    } cases[] = {
        {"rosbag2_bagfile_information:\n  storage_identifier: tape\n", "\"tape\"",
         IMK_ERROR_UNSUPPORTED},
        {"rosbag2_bagfile_information:\n  storage_identifier: mcap\n  compression_format: xz\n",
         "\"xz\"", IMK_ERROR_UNSUPPORTED},
        {"rosbag2_bagfile_information:\n  storage_identifier: mcap\n", "names no files",
         IMK_ERROR_EMPTY},
        {"rosbag2_bagfile_information:\n  storage_identifier: mcap\n  relative_file_paths:\n"
         "    - gone.mcap\n",
         "", IMK_ERROR_OPEN},
        {"something: else\n", "no such part", IMK_ERROR_FORMAT},
    };
    char folder[256], path[300];
    bag_path("folder", folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    snprintf(path, sizeof path, "%s/metadata.yaml", folder);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bag_save(path, cases[i].text, strlen(cases[i].text));
        bag_refused(folder, NULL, cases[i].status, cases[i].found, "");
    }
    remove(path);
    remove(folder);
}

/* ---- messages ---- */

/* Both serialisations come back, and a message that is shorter by any number of bytes is none. */
static void test_messages(void **state)
{
    (void)state;
    for (int encoding = IMKI_ROS_1; encoding <= IMKI_ROS_CDR; encoding++) {
        const imki_imu imu = {.stamp = INT64_C(1234567890123456789),
                              .has = {true, encoding == IMKI_ROS_1},
                              .value = {{1, 2, 3}, {4, 5, 6}}};
        uint8_t data[IMKI_ROS_IMU_MAX];
        imki_imu back;
        const size_t size = imki_ros_imu_write((imki_ros_encoding)encoding, &imu, 7, data);
        assert_true(imki_ros_imu_read((imki_ros_encoding)encoding, data, size, &back));
        assert_true(back.stamp == imu.stamp);
        assert_true(back.frame_size == 3 && memcmp(back.frame, "imu", 3) == 0);
        for (int k = 0; k < 2; k++) {
            assert_int_equal(back.has[k], imu.has[k]);
            for (int i = 0; i < 3 && back.has[k]; i++)
                assert_true(back.value[k][i] == imu.value[k][i]);
        }
        for (size_t less = 0; less < size; less++)
            assert_false(imki_ros_imu_read((imki_ros_encoding)encoding, data, less, &back));
        /* A text that is said to be longer than all there is. */
        data[encoding == IMKI_ROS_1 ? 14 : 13] = 0xFF;
        assert_false(imki_ros_imu_read((imki_ros_encoding)encoding, data, size, &back));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_memory_and_pipes),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_absent_and_unstamped),
        cmocka_unit_test(test_streams),
        cmocka_unit_test(test_two_topics),
        cmocka_unit_test(test_second_topic_later),
        cmocka_unit_test(test_seek),
        cmocka_unit_test(test_no_seek_in_a_pipe),
        cmocka_unit_test(test_cut_short),
        cmocka_unit_test(test_wrong_sum),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_header_bits),
        cmocka_unit_test(test_any_byte),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_none_readable),
        cmocka_unit_test(test_metadata_refusals),
        cmocka_unit_test(test_messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
