/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written as .npz, .mat and .h5: what is in the bytes, names as these formats can have them,
 * long logs in several blocks, empty ones, and names of files that are no format's. That the values
 * come back is tested with those of other formats in test_log_writer.c; that NumPy, SciPy, GNU
 * Octave and h5py read them was tried when they were written (docs/logs.md). */
#define _POSIX_C_SOURCE 200809L
#include "check.h"
#include "enter_folder.h"

#include "imukit/io.h"
#include "imukit/log.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const endings[] = {".npz", ".mat", ".h5"};
enum { ENDINGS = sizeof endings / sizeof endings[0], ROWS = 10001 /* two blocks and a part */ };

static imk_log_column column_of(const char *name, const char *unit)
{
    imk_log_column column = {.axis = -1};
    snprintf(column.name, sizeof column.name, "%s", name);
    column.unit = unit[0] ? imk_unit_of(unit) : (imk_unit){.scale = 1.0};
    return column;
}

static const char *path_of(size_t ending)
{
    static char path[32];
    snprintf(path, sizeof path, "log%s", endings[ending]);
    return path;
}

static void write_rows(const char *path, size_t columns, const imk_log_column *column, size_t rows,
                       const double *const *values)
{
    imk_log_writer *writer = NULL;
    imk_error error;
    CHECK_OK(imk_log_create(path, columns, column, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
    for (size_t done = 0; done < rows;) { /* pieces that do not fit the blocks */
        const double *piece[8];
        const size_t count = rows - done < 777 ? rows - done : 777;
        for (size_t c = 0; c < columns; c++)
            piece[c] = values[c] + done;
        CHECK_OK(imk_log_write(writer, count, piece, NULL));
        done += count;
    }
    CHECK_OK(imk_log_commit(writer, &error));
}

/* Blocks of 4096 rows are joined, also where the last one is not full. */
static void blocks(void **state)
{
    (void)state;
    static double time[ROWS], rate[ROWS];
    const double *values[] = {time, rate};
    const imk_log_column column[] = {column_of("time", "s"), column_of("gyro_y", "rad/s")};
    for (size_t i = 0; i < ROWS; i++) {
        time[i] = (double)i / 64;
        rate[i] = (double)i * (double)i;
    }
    rate[5000] = (double)NAN;
    for (size_t e = 0; e < ENDINGS; e++) {
        imk_log log;
        imk_error error;
        write_rows(path_of(e), 2, column, ROWS, values);
        CHECK_OK(imk_log_load(path_of(e), NULL, NULL, &log, &error));
        assert_int_equal(log.rows, ROWS);
        assert_string_equal(log.column[1].name, "gyro_y");
        assert_int_equal(log.findings.not_finite, 1);
        for (size_t i = 0; i < ROWS; i++)
            assert_true(log.data[0][i] == time[i] && (i == 5000 || log.data[1][i] == rate[i]));
        imk_log_free(&log);
    }
}

/* Names become those of variables, different ones; units are kept, also in other letters than
 * ASCII. */
static void names(void **state)
{
    (void)state;
    static const double one[] = {1.0, 2.0};
    const double *values[] = {one, one, one, one, one};
    imk_log_column column[] = {column_of("time", "s"), column_of("gyro_x", "rad/s"),
                               column_of("fan speed", "s"), column_of("fan-speed", ""),
                               column_of("2nd", "s")};
    snprintf(column[2].unit.text, sizeof column[2].unit.text, "\u00b5s");
    column[2].unit.scale = 1e-6;
    for (size_t e = 0; e < ENDINGS; e++) {
        imk_log log;
        imk_error error;
        write_rows(path_of(e), 5, column, 2, values);
        CHECK_OK(imk_log_load(path_of(e), NULL, NULL, &log, &error));
        assert_int_equal(log.column_count, 5);
        assert_string_equal(log.column[2].name, "fan_speed");
        assert_string_equal(log.column[2].unit.text, "\u00b5s");
        assert_string_equal(log.column[3].name, "fan_speed_2");
        assert_string_equal(log.column[3].unit.text, "");
        assert_string_equal(log.column[4].name, "x2nd");
        imk_log_free(&log);
    }
}

/* A log without rows is a file of its format, and nothing can be read of it. */
static void empty(void **state)
{
    (void)state;
    const double *values[] = {NULL, NULL};
    const imk_log_column column[] = {column_of("time", "s"), column_of("gyro_y", "rad/s")};
    for (size_t e = 0; e < ENDINGS; e++) {
        imk_log_reader *reader = NULL;
        imk_error error;
        write_rows(path_of(e), 2, column, 0, values);
        CHECK_STATUS(imk_log_open(path_of(e), NULL, &reader, &error), IMK_ERROR_EMPTY);
    }
}

/* The same log is the same bytes: no time of writing is in them. */
static void same_bytes(void **state)
{
    (void)state;
    static const double one[] = {1.0, 2.0, 3.0};
    const double *values[] = {one, one};
    const imk_log_column column[] = {column_of("time", "s"), column_of("gyro_y", "rad/s")};
    for (size_t e = 0; e < ENDINGS; e++) {
        static char first[32768], second[32768];
        for (int i = 0; i < 2; i++) {
            write_rows(path_of(e), 2, column, 3, values);
            FILE *file = fopen(path_of(e), "rb");
            const size_t size = fread(i == 0 ? first : second, 1, sizeof first, file);
            fclose(file);
            assert_in_range(size, 100, sizeof first - 1);
            unlink(path_of(e));
        }
        assert_memory_equal(first, second, sizeof first);
    }
}

/* Abandoned, nothing appears. */
static void abandoned(void **state)
{
    (void)state;
    static const double one[] = {1.0};
    const double *values[] = {one};
    const imk_log_column column[] = {column_of("time", "s")};
    for (size_t e = 0; e < ENDINGS; e++) {
        imk_log_writer *writer = NULL;
        imk_error error;
        unlink(path_of(e));
        CHECK_OK(imk_log_create(path_of(e), 1, column, IMK_LOG_SHORTEST, NULL, 0, &writer, &error));
        CHECK_OK(imk_log_write(writer, 1, values, NULL));
        imk_log_abandon(writer);
        assert_int_equal(access(path_of(e), F_OK), -1);
    }
}

static void check_name(const char *path, uint64_t rows, imk_status due, const char *found)
{
    imk_log_writer *writer = NULL;
    imk_error error;
    const imk_log_column column = column_of("time", "s");
    const imk_status status =
        imk_log_create(path, 1, &column, IMK_LOG_SHORTEST, NULL, rows, &writer, &error);
    CHECK_STATUS(status, due);
    if (due != IMK_OK && !strstr(error.found, found))
        fail_msg("%s: \"%s\"", path, error.found);
    imk_log_abandon(writer);
}

/* Which names are those of a log, and which of them of one that can be written. */
/* Texts have no place: refused with the columns that have. */
static void labels(void **state)
{
    (void)state;
    static const char *const paths[] = {"log.npy", "log.npz", "log.mat", "log.h5"};
    imk_log_column column[] = {column_of("time", "s"), column_of("phase", ""),
                               column_of("gyro_y", "rad/s")};
    column[1].label = true;
    for (size_t i = 0; i < 4; i++) {
        imk_log_writer *writer = NULL;
        imk_error error;
        char due[100];
        CHECK_STATUS(
            imk_log_create(paths[i], 3, column, IMK_LOG_SHORTEST, NULL, 0, &writer, &error),
            IMK_ERROR_COLUMN);
        assert_string_equal(error.field, "phase");
        snprintf(due, sizeof due, "imukit convert FILE.csv FILE%s --select time,gyro_y",
                 strchr(paths[i], '.'));
        assert_string_equal(error.expected, due);
        assert_int_not_equal(access(paths[i], F_OK), 0);
    }
}

static void file_names(void **state)
{
    (void)state;
    const char *none = "no log is written to a file with the ending ";
    static const char *const good[] = {"a.csv",  "a.csv.gz", "a.txt.zst", "a.CSV",    "log",
                                       "log.gz", ".hidden",  "a.b/log",   "/dev/null"};
    mkdir("a.b", 0777);
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        check_name(good[i], 0, IMK_OK, "");
    static const char *const bad[] = {"a.xyz", "a.tsv", "a.MAT", "a.csv.bak", "a.1", "a.xls.gz"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_name(bad[i], 0, IMK_ERROR_UNSUPPORTED, none);
    check_name("a.npz.gz", 0, IMK_ERROR_UNSUPPORTED, "not read from a compressed file");
    /* [MAT5]: bytes of a variable are less than 2^31 */
    check_name("a.mat", UINT64_C(1) << 28, IMK_ERROR_UNSUPPORTED,
               "268435456 rows are more than a MAT-file of version 5 can hold");
}

static int set_up(void **state)
{
    static char folder[] = "/tmp/test_log_arrays_write_XXXXXX";
    *state = folder;
    enter_folder(folder);
    return 0;
}

static int clean_up(void **state)
{
    for (size_t e = 0; e < ENDINGS; e++)
        unlink(path_of(e));
    rmdir("a.b");
    return chdir("/") == 0 ? rmdir(*state) : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks),     cmocka_unit_test(names),     cmocka_unit_test(empty),
        cmocka_unit_test(same_bytes), cmocka_unit_test(abandoned), cmocka_unit_test(file_names),
        cmocka_unit_test(labels),
    };
    return cmocka_run_group_tests(tests, set_up, clean_up);
}
