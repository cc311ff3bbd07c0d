/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the reader of CSV texts: what stands before the table, the header, a look at the
 * first rows, the rows. */
#ifndef IMUKIT_LOG_CSV_INTERNAL_H
#define IMUKIT_LOG_CSV_INTERNAL_H

#include "io/log/log_columns_internal.h"
#include "io/log/log_reader_internal.h"
#include "io/log/log_stamps_internal.h"
#include "log_cells_internal.h"
#include "log_dialects_internal.h"

/* The header of a table, whose text is kept. */
typedef struct imki_csv_header {
    char *line, *units; /* as they stand, ended; NULL: there is none */
    size_t number;      /* of the line, from 1 */
    bool is_comment;    /* it stands behind a # */
    bool is_row;        /* there is none: `line` is the first row, or its names in a comment */
    size_t count;
    imki_log_piece cell[IMK_LOG_COLUMNS_MAX];
    char text[IMK_LOG_COLUMNS_MAX][IMKI_LOG_NAME_SIZE]; /* of cells that are made */
    double scale[IMK_LOG_COLUMNS_MAX];                  /* of the numbers, beside the unit */
} imki_csv_header;

enum { IMKI_CSV_LOOK = 16, IMKI_CSV_CELL = 40 };

/* What the first rows show. */
typedef struct imki_csv_look {
    size_t rows; /* whole ones, at most IMKI_CSV_LOOK */
    size_t count[IMKI_CSV_LOOK];
    char text[IMKI_CSV_LOOK][IMK_LOG_COLUMNS_MAX][IMKI_CSV_CELL]; /* of cells, shortened */
    int decimals; /* of the last cell, the same in all of two or more rows; -1: not so */
} imki_csv_look;

typedef struct imki_csv {
    imki_log_cells_reader *read_cells;
    size_t slow_left, slow_run; /* rows to read in their general form before trying the fast way */
    uint64_t begin;             /* byte of the first row */
    imki_csv_header header;
    imki_csv_look look;
    size_t time_cell;          /* IMK_LOG_COLUMNS_MAX: none */
    imki_log_time_parts parts; /* ticks 0: none */
    imk_error damage;          /* of the first row that cannot be read */
} imki_csv;

typedef struct imki_csv_comment {
    char *text; /* from malloc(), NULL: none */
    size_t line;
} imki_csv_comment;

/* The next line that is neither blank nor a comment. *found is false at the end.
 * @param comment  receives the last comment before it; NULL: not wanted */
imk_status imki_csv_line(imki_log_text *text, imki_log_piece *line, bool *whole, bool *found,
                         imki_csv_comment *comment, imk_error *error);

/* Begin anew at text->hold. */
void imki_csv_go_back(imki_log_text *text, size_t line);

/* Find the header and what the cells of the rows are called; the text is then at the rows. */
imk_status imki_csv_header_read(imk_log_reader *reader, imk_error *error);

/* Numbers that a Gyroflow log multiplies its rows by. */
typedef struct imki_csv_scales {
    bool found; /* it is one */
    double time, gyro, accel, mag;
} imki_csv_scales;

/* Step over what stands before the header: Excel's "sep=;", the lines of a Blackbox log and those
 * of a Gyroflow log. @param line  the first one, then that of the header */
imk_status imki_csv_preamble_skip(imk_log_reader *reader, imki_log_piece *line, bool *whole,
                                  bool *found, imki_csv_scales *scales, imk_error *error);
/* Names and units of the program that wrote the file. @param mapped  the names remain */
void imki_csv_gyroflow_apply(imki_csv_header *header, const imki_csv_scales *scales, bool mapped);
void imki_csv_dialect_apply(imki_csv_header *header, bool mapped);

bool imki_csv_is_utf8(imki_log_piece piece);
/* Refuse units that are not UTF-8, such as the degree sign of Latin-1. Names may be anything.
 * @return IMK_ERROR_FORMAT */
imk_status imki_csv_encoding_check(const imki_csv_header *header, imk_error *error);
/* Refuse a header of fewer than two known names if one with more stands below it.
 * @return IMK_ERROR_COLUMN */
imk_status imki_csv_preamble_check(imk_log_reader *reader, imk_error *error);
/* Refuse times that are dates in words that are not read. @param line  of the header
 * @return IMK_ERROR_SYNTAX */
imk_status imki_csv_dates_check(const imki_csv_look *look, const imki_log_layout_read *layout,
                                size_t line, imk_error *error);

/* Look at the first rows, which stay. */
void imki_csv_look_at(imk_log_reader *reader, imki_csv_look *look);
/* Is each number of the rows one with a decimal comma, if it has decimals? */
bool imki_csv_has_decimal_commas(const imki_csv_look *look, size_t count);
/* What the rows say of what is missing. */
imki_log_hints imki_csv_hints(const imki_csv_look *look, const imki_log_layout_read *layout);

/* Refuse a unit by which the times count from beyond 2100, where they can only be of another one.
 * @param cell  of the time @return IMK_ERROR_CONFLICT */
imk_status imki_csv_time_unit_check(const imki_csv_look *look, const imki_log_layout_read *layout,
                                    size_t cell, imk_error *error);

/* Is this a cell with a value, or with a word for none? */
bool imki_csv_is_value(imki_log_piece cell);

/* Does the last line of a text, which has no end, lack nothing? Its last number may be cut so that
 * it is another: only one with as many decimals as those before it is known to be whole. */
bool imki_csv_is_whole(const imk_log_reader *reader, imki_log_piece line);

imk_status imki_csv_rows_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                              size_t *rows, imk_error *error);

/* Several sensors in one table are streams: those of the others are left out of the header. */
imk_status imki_csv_choose_sensor(imk_log_reader *reader, imki_csv_header *header,
                                  imk_error *error);

#endif
