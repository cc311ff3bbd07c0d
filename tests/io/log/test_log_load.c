/* SPDX-License-Identifier: Apache-2.0 */
/* Whole logs in memory: how much they may take. */
#define _DEFAULT_SOURCE
#include "check.h"

#include "imukit/io.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

enum { ROWS = 100000, COLUMNS = 2 };

static char path[] = "/tmp/imukit-load-XXXXXX.csv.gz";

/* Rows of a few bits each. */
static int write_log(void **state)
{
    (void)state;
    const int file = mkstemps(path, 7);
    gzFile out = file >= 0 ? gzdopen(file, "wb1") : NULL;
    if (!out)
        return -1;
    gzprintf(out, "time [s],gyro_x [rad/s]\n");
    for (int i = 0; i < ROWS; i++)
        gzputs(out, "0,0\n");
    return gzclose(out) == Z_OK ? 0 : -1;
}

static int remove_log(void **state)
{
    (void)state;
    return unlink(path);
}

static void test_memory_of_the_settings(void **state)
{
    (void)state;
    imk_log_settings settings = imk_log_default();
    imk_log log = {.rows = 77};
    imk_error error;
    char message[300];
    settings.memory = (ROWS - 1) * COLUMNS * sizeof(double);
    CHECK_STATUS(imk_log_load(path, &settings, NULL, &log, &error), IMK_ERROR_MEMORY);
    assert_int_equal(log.rows, 77);
    imk_error_text(&error, "x.csv.gz", message, sizeof message);
    assert_string_equal(message,
                        "x.csv.gz: memory is full: 99999 rows of 2 columns take 1.6 MB; cut the "
                        "log into parts, or leave out columns (--columns with -)");
    CHECK_STATUS(imk_log_load(path, &settings, NULL, &log, NULL), IMK_ERROR_MEMORY);
    settings.memory = 1;
    CHECK_STATUS(imk_log_load(path, &settings, NULL, &log, NULL), IMK_ERROR_MEMORY);
    settings.memory = (ROWS + 1) * COLUMNS * sizeof(double);
    CHECK_OK(imk_log_load(path, &settings, NULL, &log, &error));
    assert_int_equal(log.rows, ROWS);
    imk_log_free(&log);
    settings.memory = 0; /* half of what there is */
    CHECK_OK(imk_log_load(path, &settings, NULL, &log, &error));
    assert_int_equal(log.rows, ROWS);
    imk_log_free(&log);
}

static void test_limit_of_the_process(void **state)
{
    (void)state;
    struct rlimit before, limit;
    const size_t all = imk_memory_limit();
    assert_true(all >= (size_t)1 << 20);
    assert_int_equal(getrlimit(RLIMIT_DATA, &before), 0);
    limit = before;
    limit.rlim_cur = (rlim_t)(all / 3); /* nothing is asked for below it */
    assert_int_equal(setrlimit(RLIMIT_DATA, &limit), 0);
    assert_int_equal(imk_memory_limit(), all / 3);
    assert_int_equal(setrlimit(RLIMIT_DATA, &before), 0);
    assert_int_equal(imk_memory_limit(), all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_memory_of_the_settings),
        cmocka_unit_test(test_limit_of_the_process),
    };
    return cmocka_run_group_tests(tests, write_log, remove_log);
}
