/* SPDX-License-Identifier: Apache-2.0 */
/** @file log.h
 *  Sensor logs: CSV (plain, .gz, .zst) and .npy, read and written as streams of rows.
 *
 *  CSV: a header `time [s],gyro_x [deg/s],…,accel_x [g],…,temperature [degC]` in any order; lines
 *  starting with # are comments; comma, semicolon, tab or blanks separate. Increments
 *  (`dtheta_x [arcsec]`, `dvel_x [m/s]`) are divided by the sample interval. Everything comes out
 * in SI units. */
#ifndef IMUKIT_LOG_H
#define IMUKIT_LOG_H

#include "imukit/executor.h"
#include "imukit/output_file.h"
#include "imukit/status.h"
#include "imukit/units.h"

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { IMK_LOG_COLUMNS_MAX = 64 };

typedef enum imk_quantity {
    IMK_QUANTITY_OTHER = 0,
    IMK_QUANTITY_TIME,
    IMK_QUANTITY_ANGULAR_RATE,
    IMK_QUANTITY_SPECIFIC_FORCE,
    IMK_QUANTITY_TEMPERATURE
} imk_quantity;

/** One column of a log. */
typedef struct imk_log_column {
    char name[48]; /**< "gyro_x" */
    imk_quantity quantity;
    int axis;       /**< 0 … 7; -1 for time, temperature, other */
    imk_unit unit;  /**< as in the file */
    bool increment; /**< the file holds increments of the integral */
} imk_log_column;

/** How to read a file. Start from imk_log_settings_default(). Texts may be NULL: taken from the
 *  header. */
typedef struct imk_log_settings {
    uint32_t cookie;
    const char *columns; /**< names for a file without header: "time,gyro_x,gyro_y,…"; "-" skips */
    const char *gyro_unit, *accel_unit, *time_unit,
        *temperature_unit; /**< where the file has none */
    double rate;           /**< [Hz]; needed when there is no time column; 0: from time */
    const char *axes;      /**< "right-forward-up" …: mapped to forward-right-down; NULL: as is */
} imk_log_settings;

IMK_API imk_log_settings imk_log_settings_default(void);

/** What was found in the rows read so far. Rows count from 1, the first data row. */
typedef struct imk_log_findings {
    size_t rows;
    size_t not_finite, first_not_finite; /**< rows with a NaN, an infinity or an empty cell */
    size_t reversals, first_reversal;    /**< time steps < 0 */
    size_t repeats, first_repeat;        /**< time steps = 0 */
    size_t gaps, first_gap, missing;     /**< steps > 1.5 intervals; samples missing in them */
    double interval;                     /**< median time step, or 1/rate [s] */
    double jitter;                       /**< rms deviation of the steps from it [s] */
    double first_time, last_time;        /**< [s] */
} imk_log_findings;

typedef struct imk_log_reader imk_log_reader;

/** Open a log ("-": standard input) and read its header. Regular plain files are memory-mapped.
 *  The message of every refusal ends with the exact option to add.
 *  @return IMK_ERROR_OPEN, _READ, _EMPTY, _FORMAT, _COMPRESSED, _COLUMN, _UNIT_MISSING,
 *          _UNIT_UNKNOWN, _DIMENSION, _RATE_MISSING, … */
IMK_API imk_status imk_log_open(const char *path, const imk_log_settings *settings,
                                imk_log_reader **reader, imk_error *error);

/** The same for a CSV text in memory, which must outlive the reader. */
IMK_API imk_status imk_log_open_memory(const char *text, size_t size,
                                       const imk_log_settings *settings, imk_log_reader **reader,
                                       imk_error *error);

IMK_API size_t imk_log_column_count(const imk_log_reader *reader);
IMK_API const imk_log_column *imk_log_column_get(const imk_log_reader *reader, size_t index);
/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_log_column_find(const imk_log_reader *reader, imk_quantity quantity, int axis);
/** Bytes of the file consumed and its size (0 when not known), for progress. */
IMK_API void imk_log_progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size);

/** Read up to max_rows rows, SI units, into one array per column (NULL skips a column).
 *  @param rows  how many were read; 0 at the end
 *  @return IMK_ERROR_SYNTAX (a cell that is no number), IMK_ERROR_COLUMN (a row with another number
 *          of cells), IMK_ERROR_COMPRESSED, IMK_ERROR_READ, with line and column. A last line that
 *          was cut in the middle is an error, not a row. */
IMK_API imk_status imk_log_read(imk_log_reader *reader, size_t max_rows, double *const *columns,
                                size_t *rows, imk_error *error);

/** Findings on the rows read so far. */
IMK_API imk_log_findings imk_log_findings_get(const imk_log_reader *reader);

IMK_API void imk_log_close(imk_log_reader *reader);

/** A whole log in memory. */
typedef struct imk_log {
    size_t rows, column_count;
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    double *data[IMK_LOG_COLUMNS_MAX]; /**< rows values each (room for rows + 1), SI */
    imk_log_findings findings;
} imk_log;

/** Called now and then on long work; `done` of `total` (0: not known) in any measure. */
typedef void (*imk_progress)(void *context, uint64_t done, uint64_t total);

/** Read a whole log. @param progress may be NULL. Free with imk_log_free(). */
IMK_API imk_status imk_log_load(const char *path, const imk_log_settings *settings,
                                imk_progress progress, void *progress_context, imk_log *log,
                                imk_error *error);
IMK_API void imk_log_free(imk_log *log);
/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_log_find(const imk_log *log, imk_quantity quantity, int axis);

/** How numbers are written. */
typedef enum imk_log_precision {
    IMK_LOG_SHORTEST = 0, /**< shortest decimal that reads back to the same double */
    IMK_LOG_FIXED         /**< a number of decimals per column */
} imk_log_precision;

typedef struct imk_log_writer imk_log_writer;

/** Start a log: .csv (also .gz, .zst, and "-") with a header, or .npy (float64 matrix, rows x
 * columns, C order, values in the units of the columns; the column names go to FILE.npy.columns).
 *  @param columns   name and unit of each; values given to imk_log_write() are SI and are divided
 *                   by the unit's scale
 *  @param decimals  per column, with IMK_LOG_FIXED; else NULL
 *  @param row_count number of rows if known (needed for .npy on a pipe), else 0 */
IMK_API imk_status imk_log_create(const char *path, size_t column_count,
                                  const imk_log_column *columns, imk_log_precision precision,
                                  const int *decimals, uint64_t row_count, imk_log_writer **writer,
                                  imk_error *error);
/** A comment line at the head of a CSV, before the first row. */
IMK_API imk_status imk_log_comment(imk_log_writer *writer, const char *text);
/** Add rows from one array per column, SI. @param executor formats blocks in parallel; may be NULL.
 *  The bytes do not depend on it. */
IMK_API imk_status imk_log_write(imk_log_writer *writer, size_t rows, const double *const *columns,
                                 const imk_executor *executor);
/** Finish: the file appears. On error nothing appears. Frees the writer. */
IMK_API imk_status imk_log_commit(imk_log_writer *writer, imk_error *error);
IMK_API void imk_log_abandon(imk_log_writer *writer);

#ifdef __cplusplus
}
#endif
#endif
