/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of tests/io/log/maker/fixtures against what their writer says is in them. */
#ifndef IMUKIT_TESTS_CHECK_LOG_H
#define IMUKIT_TESTS_CHECK_LOG_H

#include "check.h"

#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

enum { LOG_ROWS_MAX = 256, LOG_COLUMNS_MAX = 16 };

typedef struct log_table {
    imk_status status; /* of opening or reading */
    imk_error error;
    size_t rows, columns;
    double value[LOG_COLUMNS_MAX][LOG_ROWS_MAX];
    char name[LOG_COLUMNS_MAX][48];
    imk_log_findings findings;
} log_table;

/* Everything in the bytes, in pieces of `piece` rows. */
static inline void log_table_read(const char *bytes, size_t size, const imk_log_settings *settings,
                                  size_t piece, log_table *table)
{
    imk_log_reader *reader = NULL;
    memset(table, 0, sizeof *table);
    table->status = imk_log_open_memory(bytes, size, settings, &reader, &table->error);
    if (table->status != IMK_OK)
        return;
    table->columns = imk_log_column_count(reader);
    assert_true(table->columns <= LOG_COLUMNS_MAX);
    for (size_t j = 0; j < table->columns; j++)
        strcpy(table->name[j], imk_log_column_get(reader, j)->name);
    for (size_t got = 1; got > 0 && table->status == IMK_OK;) {
        double *columns[LOG_COLUMNS_MAX];
        for (size_t j = 0; j < table->columns; j++)
            columns[j] = table->value[j] + table->rows;
        assert_true(table->rows + piece <= LOG_ROWS_MAX);
        got = 0;
        table->status = imk_log_read(reader, piece, columns, &got, &table->error);
        table->rows += got;
    }
    table->findings = imk_log_findings_get(reader);
    imk_log_close(reader);
}

/* A file of the fixtures. @return its size */
static inline size_t log_fixture_read(const char *name, size_t room, char *bytes)
{
    char path[512];
    snprintf(path, sizeof path, "%s/tests/io/log/maker/fixtures/%s", SOURCE_DIRECTORY, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t size = fread(bytes, 1, room, file);
    assert_true(size < room);
    fclose(file);
    return size;
}

/* What must be in a log: NAME.txt. */
static inline void log_expected_read(const char *name, log_table *table)
{
    static char text[16384];
    char file[128];
    snprintf(file, sizeof file, "%s.txt", name);
    text[log_fixture_read(file, sizeof text - 1, text)] = '\0';
    memset(table, 0, sizeof *table);
    char *at = text;
    for (char *end = strchr(text, '\n'); at < end; table->columns++) {
        const size_t length = strcspn(at, " \n");
        snprintf(table->name[table->columns], 48, "%.*s", (int)length, at);
        at += length + 1;
    }
    while (*at) {
        for (size_t j = 0; j < table->columns; j++)
            table->value[j][table->rows] = strtod(at, &at);
        at += *at == '\n';
        table->rows++;
    }
    assert_true(table->rows > 0);
}

static inline void check_same_row(const log_table *actual, size_t row, const log_table *expected,
                                  size_t expected_row)
{
    for (size_t j = 0; j < expected->columns; j++)
        if (memcmp(&actual->value[j][row], &expected->value[j][expected_row], sizeof(double)) != 0)
            fail_msg("%s of row %zu is %a, expected %a", expected->name[j], row,
                     actual->value[j][row], expected->value[j][expected_row]);
}

/* To the last bit, whatever the pieces. */
static inline void check_log(const char *file, const char *expected_name,
                             const imk_log_settings *settings)
{
    static char bytes[16384];
    static log_table table, expected;
    static const size_t pieces[] = {1, 3, 64};
    const size_t size = log_fixture_read(file, sizeof bytes, bytes);
    log_expected_read(expected_name, &expected);
    for (size_t k = 0; k < sizeof pieces / sizeof pieces[0]; k++) {
        log_table_read(bytes, size, settings, pieces[k], &table);
        check_status(table.status, IMK_OK, file, __FILE__, __LINE__);
        assert_int_equal(table.rows, expected.rows);
        assert_int_equal(table.columns, expected.columns);
        for (size_t j = 0; j < expected.columns; j++)
            assert_string_equal(table.name[j], expected.name[j]);
        for (size_t row = 0; row < expected.rows; row++)
            check_same_row(&table, row, &expected, row);
        assert_int_equal(table.findings.damaged, 0);
        assert_false(table.findings.cut_short);
    }
}

#endif
