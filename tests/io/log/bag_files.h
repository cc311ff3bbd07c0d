/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of bags share: files, and all rows of a log. */
#ifndef IMUKIT_TESTS_BAG_FILES_H
#define IMUKIT_TESTS_BAG_FILES_H

#include "check.h"

#include "imukit/io.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BAGS SOURCE_DIRECTORY "/tests/fixtures/bags/"

enum { BAG_ROWS = 6000, BAG_COLUMNS = 7 };

typedef struct bag_table {
    size_t rows, columns;
    imk_log_findings findings;
    double data[BAG_COLUMNS][BAG_ROWS];
} bag_table;

static inline const char *bag_path(const char *name, char path[256])
{
    const char *folder = getenv("TMPDIR");
    snprintf(path, 256, "%s/imukit_%ld_%s", folder ? folder : "/tmp", (long)getpid(), name);
    return path;
}

/* All rows from where the reader is, `piece` at a time. */
static inline imk_status bag_read(imk_log_reader *reader, size_t piece, bag_table *t,
                                  imk_error *error)
{
    imk_status status = IMK_OK;
    t->rows = 0;
    t->columns = imk_log_column_count(reader);
    assert_true(t->columns <= BAG_COLUMNS);
    for (size_t got = 1; status == IMK_OK && got > 0; t->rows += got) {
        double *to[BAG_COLUMNS] = {NULL};
        for (size_t c = 0; c < t->columns; c++)
            to[c] = t->data[c] + t->rows;
        assert_true(t->rows + piece <= BAG_ROWS);
        got = 0;
        status = imk_log_read(reader, piece, to, &got, error);
    }
    t->findings = imk_log_findings_get(reader);
    return status;
}

static inline imk_status bag_load(const char *path, const imk_log_settings *settings, bag_table *t,
                                  imk_error *error)
{
    imk_log_reader *reader = NULL;
    imk_status status = imk_log_open(path, settings, &reader, error);
    t->rows = 0;
    if (status == IMK_OK)
        status = bag_read(reader, 1000, t, error);
    imk_log_close(reader);
    return status;
}

/* Open a file that is refused. */
static inline void bag_refused(const char *path, const imk_log_settings *settings, imk_status due,
                               const char *found, const char *expected)
{
    imk_log_reader *reader = NULL;
    imk_error error = {.status = IMK_OK};
    CHECK_STATUS(imk_log_open(path, settings, &reader, &error), due);
    if (!strstr(error.found, found) || !strstr(error.expected, expected))
        print_error("%s: %s; %s\n", path, error.found, error.expected);
    assert_non_null(strstr(error.found, found));
    assert_non_null(strstr(error.expected, expected));
}

/* A whole file. */
static inline char *bag_bytes(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static inline void bag_save(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

#endif
