/* SPDX-License-Identifier: Apache-2.0 */
/* Bags that are written: they come back to the last bit, also without gyros or accelerometers and
 * from several threads; what they cannot hold is refused with the command that leaves it out. */
#define _POSIX_C_SOURCE 200809L
#include "bag_files.h"

#include "imukit/thread_pool.h"

enum { ROWS = 5000 };

static double data[BAG_COLUMNS][ROWS];

static const char *const names[BAG_COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
static const char *const endings[] = {".bag", ".mcap", ".db3"};

static int make_rows(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (size_t i = 0; i < ROWS; i++)
        for (size_t c = 0; c < BAG_COLUMNS; c++) {
            random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            data[c][i] =
                c == 0 ? (double)((int64_t)i * 5000001) / 1e9 : (double)(int64_t)random * 0x1p-60;
        }
    return 0;
}

static imk_status start(const char *path, size_t count, const char *const *name,
                        imk_log_writer **writer, imk_error *error)
{
    imk_log_column columns[BAG_COLUMNS + 1];
    for (size_t c = 0; c < count; c++)
        columns[c] = imk_record_column(name[c]);
    return imk_log_create(path, count, columns, IMK_LOG_SHORTEST, NULL, 0, writer, error);
}

/* Write columns `first` … `first + count - 1` behind the time. */
static imk_status write_log(const char *path, size_t first, size_t count, size_t rows,
                            const imk_executor *executor, imk_error *error)
{
    imk_log_writer *writer;
    const char *name[BAG_COLUMNS] = {names[0]};
    const double *from[BAG_COLUMNS] = {data[0]};
    for (size_t c = 0; c < count; c++) {
        name[c + 1] = names[first + c];
        from[c + 1] = data[first + c];
    }
    const imk_status status = start(path, count + 1, name, &writer, error);
    if (status != IMK_OK)
        return status;
    if (rows > 0)
        (void)imk_log_write(writer, rows, from, executor); /* commit tells */
    return imk_log_commit(writer, error);
}

static void test_round_trip(void **state)
{
    (void)state;
    static bag_table t;
    static const size_t parts[3][2] = {{1, 6}, {1, 3}, {4, 3}};
    char path[256];
    for (size_t k = 0; k < 9; k++) {
        const size_t *part = parts[k / 3];
        imk_error error;
        bag_path(endings[k % 3], path);
        CHECK_OK(write_log(path, part[0], part[1], ROWS, NULL, &error));
        CHECK_OK(bag_load(path, NULL, &t, &error));
        assert_int_equal(t.rows, ROWS);
        assert_int_equal(t.columns, part[1] + 1);
        for (size_t c = 0; c < t.columns; c++)
            for (size_t i = 0; i < ROWS; i++)
                assert_true(t.data[c][i] == data[c == 0 ? 0 : part[0] + c - 1][i]);
        assert_int_equal(t.findings.damaged, 0);
        assert_false(t.findings.cut_short || t.findings.received);
        remove(path);
    }
}

/* Their indices know the rows, and lead to places among them. */
static void test_index(void **state)
{
    (void)state;
    static bag_table t;
    char path[256];
    for (size_t k = 0; k < 3; k++) {
        imk_log_stream stream;
        imk_log_reader *reader;
        imk_error error;
        size_t count;
        bag_path(endings[k], path);
        CHECK_OK(write_log(path, 1, 6, ROWS, NULL, &error));
        CHECK_OK(imk_log_streams(path, NULL, 1, &stream, &count, NULL, &error));
        assert_int_equal(count, 1);
        assert_string_equal(stream.name, "/imu");
        assert_int_equal(stream.samples, ROWS);
        assert_true(stream.begin == 0.0 && stream.end == data[0][ROWS - 1]);
        CHECK_OK(imk_log_open(path, NULL, &reader, &error));
        CHECK_OK(imk_log_seek(reader, 0.7, &error));
        CHECK_OK(bag_read(reader, 500, &t, &error));
        assert_true(t.rows > ROWS / 20 && t.rows < 4 * ROWS / 5); /* a chunk has 2200 */
        assert_true(t.data[0][0] == data[0][ROWS - t.rows]);
        assert_true(t.data[6][t.rows - 1] == data[6][ROWS - 1]);
        imk_log_close(reader);
        remove(path);
    }
}

/* The bytes do not depend on the threads. A database has none of its own. */
static void test_threads(void **state)
{
    (void)state;
    imk_error error;
    imk_thread_pool *pool = imk_thread_pool_create(3);
    const imk_executor executor = imk_thread_pool_executor(pool);
    for (size_t k = 0; k < 3; k++) {
        char one[256], many[256], name[32];
        size_t size[2];
        snprintf(name, sizeof name, "many%s", endings[k]);
        bag_path(endings[k], one);
        bag_path(name, many);
        CHECK_OK(write_log(one, 1, 6, ROWS, NULL, &error));
        CHECK_OK(write_log(many, 1, 6, ROWS, &executor, &error));
        char *a = bag_bytes(one, &size[0]), *b = bag_bytes(many, &size[1]);
        assert_int_equal(size[0], size[1]);
        if (k < 2) /* the metadata name the file */
            assert_memory_equal(a, b, size[0]);
        free(a);
        free(b);
        remove(one);
        remove(many);
    }
    imk_thread_pool_destroy(pool);
}

static void test_without_rows(void **state)
{
    (void)state;
    char path[256];
    for (size_t k = 0; k < 3; k++) {
        imk_error error;
        bag_path(endings[k], path);
        CHECK_OK(write_log(path, 1, 6, 0, NULL, &error));
        bag_refused(path, NULL, IMK_ERROR_EMPTY, "", "");
        remove(path);
    }
}

static void check_refused(const char *path, size_t count, const char *const *name,
                          const char *field, const char *expected)
{
    imk_log_writer *writer;
    imk_error error;
    CHECK_STATUS(start(path, count, name, &writer, &error), IMK_ERROR_COLUMN);
    assert_string_equal(error.field, field);
    if (!strstr(error.expected, expected))
        print_error("%s\n", error.expected);
    assert_non_null(strstr(error.expected, expected));
    assert_int_not_equal(access(path, F_OK), 0);
}

static void test_refused_columns(void **state)
{
    (void)state;
    char path[256];
    for (size_t k = 0; k < 3; k++) {
        char due[128];
        const char *const hot[] = {"time", "gyro_x", "gyro_y", "gyro_z", "temperature", "accel_x"};
        bag_path(endings[k], path);
        snprintf(due, sizeof due,
                 "imukit convert FILE.csv FILE%s --select time,gyro_x,gyro_y,gyro_z", endings[k]);
        check_refused(path, 5, hot, "temperature", due);
        const char *const two[] = {"time", "gyro_x", "gyro_y", "gyro_z", "accel_x"};
        check_refused(path, 5, two, "accel_x", due);
        check_refused(path, 3, hot + 1, "time", "columns time,");
        check_refused(path, 1, hot, "gyro_x", "columns time,");
        const char *const axis[] = {"time", "gyro_0", "gyro_1", "gyro_2", "gyro_3"};
        check_refused(path, 5, axis, "gyro_3", "--select time,gyro_0,gyro_1,gyro_2");
    }
}

static void test_refused_outputs(void **state)
{
    (void)state;
    static const char *const bad[] = {"x.bag.gz", "x.db3.zst"};
    char path[256];
    imk_error error;
    for (size_t k = 0; k < 2; k++) {
        CHECK_STATUS(write_log(bag_path(bad[k], path), 1, 6, ROWS, NULL, &error),
                     IMK_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.expected, ".mcap"));
        assert_int_not_equal(access(path, F_OK), 0);
    }
    /* MCAP needs no second look at what is written. */
    static bag_table t;
    CHECK_OK(write_log(bag_path("x.mcap.zst", path), 1, 6, ROWS, NULL, &error));
    CHECK_OK(bag_load(path, NULL, &t, &error));
    assert_int_equal(t.rows, ROWS);
    remove(path);
}

static void test_refused_times(void **state)
{
    (void)state;
    static const double bad[] = {-0.001, 3e9, (double)NAN};
    char path[256];
    for (size_t k = 0; k < 9; k++) {
        imk_error error;
        const double before = data[0][3000];
        data[0][3000] = bad[k / 3];
        bag_path(endings[k % 3], path);
        CHECK_STATUS(write_log(path, 1, 6, ROWS, NULL, &error), IMK_ERROR_RANGE);
        assert_non_null(strstr(error.found, "row 3001"));
        assert_int_not_equal(access(path, F_OK), 0);
        data[0][3000] = before;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),      cmocka_unit_test(test_index),
        cmocka_unit_test(test_threads),         cmocka_unit_test(test_without_rows),
        cmocka_unit_test(test_refused_columns), cmocka_unit_test(test_refused_outputs),
        cmocka_unit_test(test_refused_times),
    };
    return cmocka_run_group_tests(tests, make_rows, NULL);
}
