/* SPDX-License-Identifier: Apache-2.0 */
/* What bags say of themselves and do not hold, and what their first messages say of all: messages
 * that are missing by an index, files that no list names, databases that were not closed, messages
 * that are compressed or serialised in another way, covariances and stamps of the first ones. */
#define _POSIX_C_SOURCE 200809L
#include "bag_files.h"

#include "io/log/ros/log_ros_internal.h"

#include <sys/stat.h>
#include <zstd.h>

enum { SAMPLES = 10, ROWS = 40, LOOKED_AT = 20 /* more than IMKI_ROS_LOOK */ };

static bag_table t;

static void replace_all(char *bytes, size_t size, const char *from, const char *to)
{
    const size_t length = strlen(from);
    assert_int_equal(strlen(to), length);
    for (size_t at = 0; at + length <= size; at++)
        if (memcmp(bytes + at, from, length) == 0)
            memcpy(bytes + at, to, length);
}

static void load_bytes(const char *bytes, size_t size)
{
    imk_log_reader *reader;
    imk_error error;
    CHECK_OK(imk_log_open_memory(bytes, size, NULL, &reader, &error));
    CHECK_OK(bag_read(reader, 7, &t, &error));
    imk_log_close(reader);
}

/* ---- numbers of messages ---- */

/* The folder of two files, of which the list names the first: tests/fixtures/bags/two. */
static void test_folder_with_a_short_list(void **state)
{
    (void)state;
    static const char *const files[] = {"two_0.db3", "two_1.db3", "metadata.yaml"};
    char folder[256], path[300];
    imk_error error;
    size_t first = 0;
    CHECK_OK(bag_load(BAGS "two/two_0.db3", NULL, &t, &error));
    first = t.rows;
    assert_true(first > 0 && first < SAMPLES);
    bag_path("short_list", folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    for (size_t i = 0; i < 3; i++) {
        size_t size;
        snprintf(path, sizeof path, BAGS "two/%s", files[i]);
        char *bytes = bag_bytes(path, &size);
        bytes[size] = '\0';
        if (i == 2) { /* the last entry of the list, which is the last line */
            char *line = strstr(bytes, "    - two_1.db3");
            assert_non_null(line);
            size = (size_t)(line - bytes);
        }
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        bag_save(path, bytes, size);
        free(bytes);
    }
    CHECK_OK(bag_load(folder, NULL, &t, &error));
    assert_int_equal(t.rows, first);
    assert_int_equal(t.findings.stated, SAMPLES);
    assert_int_equal(t.findings.absent, SAMPLES - first);
    assert_int_equal(t.findings.unlisted, 1);
    assert_string_equal(t.findings.unlisted_name, "two_1.db3");
    for (size_t i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        remove(path);
    }
    remove(folder);
    CHECK_OK(bag_load(BAGS "two", NULL, &t, &error));
    assert_int_equal(t.findings.absent, 0);
    assert_int_equal(t.findings.unlisted, 0);
}

/* A message whose kind was changed to one that is passed over: the statistics know it. */
static void test_mcap_with_statistics(void **state)
{
    (void)state;
    enum { MAGIC = 8, HEAD = 9, MESSAGE = 5, IMU = 346, OWN = 0x80 };
    size_t size, at = MAGIC;
    char *bytes = bag_bytes(BAGS "unchunked.mcap", &size);
    load_bytes(bytes, size);
    assert_int_equal(t.findings.absent, 0);
    while (bytes[at] != MESSAGE || imki_get_u64((const uint8_t *)bytes + at + 1) != IMU)
        at += HEAD + (size_t)imki_get_u64((const uint8_t *)bytes + at + 1);
    bytes[at] = (char)OWN;
    load_bytes(bytes, size);
    assert_int_equal(t.rows, SAMPLES - 1);
    assert_int_equal(t.findings.damaged, 2); /* the record, and the checksum of all of them */
    assert_int_equal(t.findings.absent, 1);
    assert_int_equal(t.findings.stated, SAMPLES);
    free(bytes);
}

/* The head of an SQLite database has two bytes that say that it was written ahead [SQLITE, 1.3]. */
static void test_write_ahead(void **state)
{
    (void)state;
    char path[256];
    size_t size;
    char *bytes = bag_bytes(BAGS "single.db3", &size);
    load_bytes(bytes, size);
    assert_false(t.findings.unclosed);
    bytes[18] = bytes[19] = 2;
    load_bytes(bytes, size);
    assert_int_equal(t.rows, SAMPLES);
    assert_true(t.findings.unclosed);
    replace_all(bytes, size, "messages", "massages");
    bag_save(bag_path("ahead.db3", path), bytes, size);
    bag_refused(path, NULL, IMK_ERROR_FORMAT, "no tables", "-wal");
    remove(path);
    free(bytes);
}

/* ---- how messages are written ---- */

static void test_packed_messages_alone(void **state)
{
    (void)state;
    imk_error error;
    CHECK_OK(bag_load(BAGS "messages", NULL, &t, &error));
    static bag_table alone;
    CHECK_OK(bag_load(BAGS "messages/messages_0.db3", NULL, &alone, &error));
    assert_int_equal(alone.rows, SAMPLES);
    for (size_t c = 0; c < BAG_COLUMNS; c++)
        assert_memory_equal(alone.data[c], t.data[c], SAMPLES * sizeof(double));
}

static void test_other_kind_of_cdr(void **state)
{
    (void)state;
    enum { BEFORE_TEXT = 16 }; /* representation 4, stamp 8, length of the text 4 */
    char path[256];
    size_t size;
    char *bytes = bag_bytes(BAGS "single.db3", &size);
    for (size_t at = BEFORE_TEXT; at + 7 < size; at++)
        if (memcmp(bytes + at, "sensor\0", 7) == 0)
            bytes[at - BEFORE_TEXT + 1] = 7;
    bag_save(bag_path("cdr2.db3", path), bytes, size);
    bag_refused(path, NULL, IMK_ERROR_UNSUPPORTED, "CDR of another kind, number 7", "plain CDR");
    remove(path);
    free(bytes);
}

static void test_chunk_of_two_frames(void **state)
{
    (void)state;
    enum { HALF = 1000 };
    char text[2 * HALF], packed[4 * HALF];
    imki_ros_chunk chunk = {.bytes = NULL};
    imk_error error;
    bool intact;
    size_t size = 0;
    for (size_t i = 0; i < sizeof text; i++)
        text[i] = (char)(i * i % 251);
    for (size_t i = 0; i < 2; i++)
        size += ZSTD_compress(packed + size, sizeof packed - size, text + i * HALF, HALF, 3);
    assert_true(size < sizeof packed);
    CHECK_OK(imki_ros_unpack(&chunk, IMKI_ROS_ZSTD, (const uint8_t *)packed, size, sizeof text,
                             &intact, &error));
    assert_true(intact && chunk.size == sizeof text);
    assert_memory_equal(chunk.bytes, text, sizeof text);
    CHECK_OK(imki_ros_unpack(&chunk, IMKI_ROS_ZSTD, (const uint8_t *)packed, size - 1, sizeof text,
                             &intact, &error));
    assert_false(intact);
    imki_ros_chunk_free(&chunk);
}

/* ---- what the first messages say ---- */

/* A bag of ROWS messages; the first `changed` have a first covariance of the gyros of -1, or no
 * stamp. */
static void load_changed(size_t changed, bool stamp)
{
    /* sequence 4, stamp 8, length and text "imu"; then doubles, of which 16 is the covariance */
    enum { TEXT = 7, COVARIANCE = TEXT + 8 * 16, STAMP = 8 };
    static const char *const names[BAG_COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                                   "accel_x", "accel_y", "accel_z"};
    static double rows[BAG_COLUMNS][ROWS];
    const double absent = -1.0, *from[BAG_COLUMNS];
    imk_log_column columns[BAG_COLUMNS];
    imk_log_writer *writer;
    imk_error error;
    char path[256];
    size_t size, met = 0;
    for (size_t c = 0; c < BAG_COLUMNS; c++) {
        columns[c] = imk_record_column(names[c]);
        from[c] = rows[c];
        for (size_t i = 0; i < ROWS; i++)
            rows[c][i] = c == 0 ? 1.0 + (double)i / 64 : (double)(i + c);
    }
    bag_path("first.bag", path);
    CHECK_OK(
        imk_log_create(path, BAG_COLUMNS, columns, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
    CHECK_OK(imk_log_write(writer, ROWS, from, NULL));
    CHECK_OK(imk_log_commit(writer, &error));
    char *bytes = bag_bytes(path, &size);
    for (size_t at = STAMP; at + COVARIANCE + 8 <= size && met < changed; at++) {
        if (memcmp(bytes + at, "\3\0\0\0imu", TEXT) != 0)
            continue;
        met++;
        if (stamp)
            memset(bytes + at - STAMP, 0, STAMP);
        else
            memcpy(bytes + at + COVARIANCE, &absent, 8);
    }
    assert_int_equal(met, changed);
    load_bytes(bytes, size);
    assert_int_equal(t.rows, ROWS);
    remove(path);
    free(bytes);
}

/* A sensor that one of the messages looked at has is a column; one that begins later is told. */
static void test_covariances_of_the_first(void **state)
{
    (void)state;
    load_changed(1, false);
    assert_int_equal(t.columns, 7);
    assert_true(isnan(t.data[1][0]) && t.data[1][1] == 2.0 && t.data[4][0] == 4.0);
    assert_int_equal(t.findings.not_finite, 1);
    assert_true(t.findings.later[0] == 0 && t.findings.later[1] == 0);
    load_changed(LOOKED_AT, false);
    assert_int_equal(t.columns, 4);
    assert_int_equal(t.findings.later[0], ROWS - LOOKED_AT);
    assert_int_equal(t.findings.later[1], 0);
}

static void test_stamps_of_the_first(void **state)
{
    (void)state;
    load_changed(LOOKED_AT, true);
    assert_true(t.findings.received);
    assert_int_equal(t.findings.stamps, ROWS - LOOKED_AT);
    load_changed(ROWS, true);
    assert_true(t.findings.received);
    assert_int_equal(t.findings.stamps, 0);
    assert_true(t.data[0][1] - t.data[0][0] == 1.0 / 64); /* written with the time of recording */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_folder_with_a_short_list),
        cmocka_unit_test(test_mcap_with_statistics),
        cmocka_unit_test(test_write_ahead),
        cmocka_unit_test(test_packed_messages_alone),
        cmocka_unit_test(test_other_kind_of_cdr),
        cmocka_unit_test(test_chunk_of_two_frames),
        cmocka_unit_test(test_covariances_of_the_first),
        cmocka_unit_test(test_stamps_of_the_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
