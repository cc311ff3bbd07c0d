/* SPDX-License-Identifier: Apache-2.0 */
/** @file record.h
 *  Records of sensors: what their columns are, where their rows come from, and one in memory.
 *
 *  Jobs (job.h) take a record source: a file is one kind (imk_log_source(), log.h), arrays
 *  in memory are another (imk_array_source_make()); they give to a record sink. */
#ifndef IMUKIT_RECORD_H
#define IMUKIT_RECORD_H

#include "imukit/allocator.h"
#include "imukit/executor.h"
#include "imukit/status.h"
#include "imukit/units.h"

#include <stdbool.h>

IMK_BEGIN_C

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
    bool label; /**< the file holds texts (section names, …): the value is the index of the text
                     in the reader's list, see imk_log_label() */
} imk_log_column;

/** What was found in the rows read so far. Rows count from 1, the first data row.
 *
 *  The interval is the median of the first 4096 positive time steps (of all, when there are fewer),
 *  afterwards the median of the medians of groups of 4096, or 1/rate where the settings say a rate.
 *  Gaps and jitter are assessed by the interval known when the group of the step was complete.
 *  Jitter leaves gaps, repeats and reversals out. No step is formed with a time that is not
 *  finite. */
typedef struct imk_log_findings {
    size_t rows;
    size_t not_finite, first_not_finite; /**< rows with a NaN, an infinity or an empty cell */
    size_t reversals, first_reversal;    /**< time steps < 0 */
    size_t repeats, first_repeat;        /**< time steps = 0 */
    size_t gaps, first_gap, missing;     /**< imk_step_is_gap(); samples missing in them */
    double interval;                     /**< median time step, or 1/rate [s] */
    double jitter;                       /**< rms deviation of the steps from it [s] */
    double first_time, last_time;        /**< [s] */
    double
        time_origin; /**< [s] subtracted from the times: the first one if beyond 1e6 s (clocks that
                        count from an epoch), so that microseconds keep their resolution; else 0 */
} imk_log_findings;

/** Where the rows of a record come from. Functions that are NULL are not there. */
typedef struct imk_record_source {
    void *context;
    size_t column_count;
    const imk_log_column *columns; /**< as imk_record_source.read gives them, SI */
    double rate;                   /**< [Hz]; 0: from the time column */
    /** The next rows, up to `rows_most`, into one array per column (NULL skips a column); 0 rows at
     *  the end. */
    imk_status (*read)(void *context, size_t rows_most, double *const *columns, size_t *rows,
                       imk_error *error);
    /** Back to the first row. */
    imk_status (*rewind)(void *context, imk_error *error);
    /** On the rows read so far. */
    imk_log_findings (*findings)(void *context);
    /** What was read, and of how much (0: not known), in any measure. */
    void (*progress)(void *context, uint64_t *done, uint64_t *total);
    /** Text number `index` of the columns of labels; NULL beyond the last. */
    const char *(*label)(void *context, size_t index);
} imk_record_source;

/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_record_find(const imk_record_source *source, imk_quantity quantity, int axis);

/** A column of a sensor in SI units, by name: gyro_x, accel_z, time, temperature, or any other.
 *  @return IMK_QUANTITY_OTHER for a name that says nothing */
IMK_API imk_log_column imk_record_column(const char *name);

/** Rows in memory as a source; the arrays stay the caller's. */
typedef struct imk_array_source {
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    const double *data[IMK_LOG_COLUMNS_MAX];
    size_t column_count, rows, next;
    double rate;
    imk_log_findings findings;
} imk_array_source;

/** A source of `rows` rows in one array per column.
 *  @param names  gyro_x [rad/s], accel_x [m/s^2], time [s], temperature [K] and so on, without
 *                units
 *  @param rate   [Hz]; 0: from a column named time
 *  @param memory what the source is about, until it is not used any more
 *  @return IMK_ERROR_COLUMN (too many, or a name twice), _ARGUMENT (no array), _RATE_MISSING,
 *          _MEMORY
 */
IMK_API imk_status imk_array_source_make(size_t column_count, const char *const *names,
                                         const double *const *data, size_t rows, double rate,
                                         imk_array_source *memory, imk_record_source *source,
                                         imk_error *error);

/** Where the rows of a record go. */
typedef struct imk_record_sink {
    void *context;
    /** Before the first row: the columns.
     *  @param decimals  per column, those that hold every value to come; -1: not known
     *  @param rows      how many are to come; 0: not known */
    imk_status (*begin)(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error);
    /** Rows from one array per column, SI; increments as increments. */
    imk_status (*write)(void *context, size_t rows, const double *const *columns,
                        const imk_executor *executor, imk_error *error);
    /** Where the texts of columns of labels are; NULL: they are not wanted. */
    void (*labels)(void *context, const imk_record_source *source);
} imk_record_sink;

/** Rows into arrays of the caller. */
typedef struct imk_array_sink {
    size_t column_count, capacity, rows; /**< capacity: of each array */
    double *const *data;                 /**< as many as there will be columns */
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
} imk_array_sink;

/** A sink into arrays: `memory` with its counts, capacity and data set.
 *  Writing beyond the capacity, or more columns, is IMK_ERROR_WORKSPACE. */
IMK_API imk_record_sink imk_array_sink_of(imk_array_sink *memory);

/** "gyro_x", "accel_3": the column of a sensor by its number, 0 to 2 along the axes of the body.
 *  @param text  48 bytes */
IMK_API void imk_axis_name(const char *sensor, int axis, char *text);

/** A whole log in memory. */
typedef struct imk_log {
    size_t rows, column_count;
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    double *data[IMK_LOG_COLUMNS_MAX]; /**< rows values each (room for rows + 1), SI */
    imk_log_findings findings;
    size_t label_count;
    char (*label)[48];       /**< texts the values of label columns index */
    imk_allocator allocator; /**< of the columns and labels */
} imk_log;

/** Free the columns of a loaded log. */
IMK_API void imk_log_free(imk_log *log);
/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_log_find(const imk_log *log, imk_quantity quantity, int axis);

IMK_END_C
#endif
