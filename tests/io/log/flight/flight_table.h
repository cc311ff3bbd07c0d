/* SPDX-License-Identifier: Apache-2.0 */
/* Flight logs in memory, and their rows. */
#ifndef FLIGHT_TABLE_H
#define FLIGHT_TABLE_H

#include "check.h"

#include "imukit/log.h"

#include <stdio.h>
#include <string.h>

enum { TABLE_ROWS = 512, TABLE_COLUMNS = 12 };

typedef struct bytes {
    char *at;
    size_t size;
} bytes;

typedef struct table {
    imk_status opened, status; /* of opening; of reading */
    imk_error error;
    size_t rows, columns;
    double value[TABLE_COLUMNS][TABLE_ROWS];
    imk_log_findings findings;
    char names[TABLE_COLUMNS][48];
} table;

/* A file beside the tests, or of others: {NULL, 0} if it is not there. */
static inline bytes bytes_of(const char *path)
{
    bytes b = {NULL, 0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return b;
    fseek(file, 0, SEEK_END);
    b.size = (size_t)ftell(file);
    rewind(file);
    b.at = malloc(b.size + 1);
    assert_non_null(b.at);
    assert_int_equal(fread(b.at, 1, b.size, file), b.size);
    fclose(file);
    return b;
}

static inline bytes fixture(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, SOURCE_DIRECTORY "/tests/io/log/flight/%s", name);
    const bytes b = bytes_of(path);
    assert_non_null(b.at);
    return b;
}

/* @param instance  -1: not chosen */
static inline imk_log_settings sensor(const char *topic, int instance)
{
    imk_log_settings settings = imk_log_default();
    settings.topic = topic;
    settings.instance = instance + 1;
    return settings;
}

/* Read on to the end, `block` rows at a time. */
static inline void read_on(imk_log_reader *reader, size_t block, table *t)
{
    t->rows = 0;
    t->columns = imk_log_column_count(reader);
    assert_true(t->columns <= TABLE_COLUMNS);
    for (size_t i = 0; i < t->columns; i++)
        snprintf(t->names[i], sizeof t->names[i], "%s", imk_log_column_get(reader, i)->name);
    for (;;) {
        double *columns[TABLE_COLUMNS];
        size_t got = 0;
        assert_true(t->rows + block <= TABLE_ROWS);
        for (size_t i = 0; i < t->columns; i++)
            columns[i] = t->value[i] + t->rows;
        t->status = imk_log_read(reader, block, columns, &got, &t->error);
        if (t->status != IMK_OK || got == 0)
            break;
        t->rows += got;
    }
    t->findings = imk_log_findings_get(reader);
}

static inline void read_bytes(const char *at, size_t size, const imk_log_settings *settings,
                              size_t block, table *t)
{
    imk_log_reader *reader;
    t->rows = 0;
    t->error = (imk_error){.status = IMK_OK};
    t->opened = imk_log_open_memory(at, size, settings, &reader, &t->error);
    t->status = t->opened;
    if (t->opened != IMK_OK)
        return;
    read_on(reader, block, t);
    imk_log_close(reader);
}

/* The same rows, bit by bit. */
static inline void check_same_rows(const table *a, size_t from_a, const table *b, size_t from_b,
                                   size_t rows)
{
    assert_true(from_a + rows <= a->rows && from_b + rows <= b->rows);
    for (size_t i = 0; i < a->columns; i++)
        assert_memory_equal(a->value[i] + from_a, b->value[i] + from_b, rows * sizeof(double));
}

/* Is row `row` of `a` one of the rows of `b`, from *at on? *at is set behind it. */
static inline bool find_row(const table *a, size_t row, const table *b, size_t *at)
{
    for (; *at < b->rows; ++*at) {
        bool same = true;
        for (size_t i = 0; i < b->columns; i++)
            same &= memcmp(&a->value[i][row], &b->value[i][*at], sizeof(double)) == 0;
        if (same) {
            ++*at;
            return true;
        }
    }
    return false;
}

/* Cut short at every `step`th byte: the first rows, and it is told; or a refusal. */
static inline void check_cut(const bytes *b, const imk_log_settings *settings, size_t step)
{
    static table whole, cut;
    size_t refused = 0, told = 0;
    read_bytes(b->at, b->size, settings, 64, &whole);
    assert_int_equal(whole.status, IMK_OK);
    for (size_t size = 1; size < b->size; size += step) {
        char *copy = malloc(size); /* of just this size, so that a sanitizer sees more than it */
        assert_non_null(copy);
        memcpy(copy, b->at, size);
        read_bytes(copy, size, settings, 64, &cut);
        free(copy);
        assert_true((cut.opened != IMK_OK) == (cut.error.status != IMK_OK));
        refused += cut.opened != IMK_OK;
        if (cut.opened != IMK_OK)
            continue;
        assert_int_equal(cut.status, IMK_OK);
        assert_true(cut.rows <= whole.rows);
        if (cut.columns == whole.columns)
            check_same_rows(&cut, 0, &whole, 0, cut.rows);
        told += cut.findings.cut_short;
    }
    assert_true(refused > 0 && told > 0);
}

/* Some bytes of others: whole rows of the log only, and it is told.
 * @param from  where the rows begin
 * @return how many runs lost rows */
static inline size_t check_damage(const bytes *b, const imk_log_settings *settings, size_t from,
                                  size_t length, unsigned char filling)
{
    static table whole, hurt;
    size_t lost = 0;
    read_bytes(b->at, b->size, settings, 64, &whole);
    char *copy = malloc(b->size);
    assert_non_null(copy);
    for (size_t at = from; at + length < b->size; at += 37) {
        memcpy(copy, b->at, b->size);
        memset(copy + at, filling, length);
        read_bytes(copy, b->size, settings, 64, &hurt);
        assert_int_equal(hurt.status, IMK_OK);
        size_t place = 0, strange = 0;
        for (size_t row = 0; row < hurt.rows; row++) {
            size_t before = place;
            if (!find_row(&hurt, row, &whole, &place)) {
                strange++; /* the damage is within the numbers of a row: nothing can tell */
                place = before;
            }
        }
        assert_true(strange <= 32);
        if (hurt.rows < whole.rows) {
            lost++; /* a single one may be in a message that is now of another instance */
            assert_true(hurt.rows + 1 == whole.rows || hurt.findings.damaged > 0 ||
                        hurt.findings.cut_short);
        }
    }
    free(copy);
    return lost;
}

#endif
