/* SPDX-License-Identifier: Apache-2.0 */
/** @file record.h
 *  Records of sensors: their columns, the source and the sink of their rows, and a record in
 *  memory.
 *
 *  Jobs (job.h) read from a record source: a file (imk_log_source(), log.h) or arrays in memory
 *  (imk_array_source_make()). They write to a record sink. */
#ifndef IMUKIT_RECORD_H
#define IMUKIT_RECORD_H

#include "imukit/allocator.h"
#include "imukit/executor.h"
#include "imukit/status.h"
#include "imukit/units.h"

#include <stdbool.h>

IMK_BEGIN_C

enum { IMK_LOG_COLUMNS_MAX = 64 };

/** What a column measures. */
typedef enum imk_quantity {
    IMK_QUANTITY_OTHER = 0,
    IMK_QUANTITY_TIME,
    IMK_QUANTITY_ANGULAR_RATE,
    IMK_QUANTITY_SPECIFIC_FORCE,
    IMK_QUANTITY_TEMPERATURE,
    IMK_QUANTITY_MAGNETIC /**< magnetic flux density */
} imk_quantity;

/** Who says what the unit of a column is. */
typedef enum imk_unit_origin {
    IMK_UNIT_OF_HEADER = 0, /**< the file, beside the column */
    IMK_UNIT_OF_FORMAT,     /**< the definition of the format or of the message */
    IMK_UNIT_OF_SETTINGS,   /**< imk_log_settings */
    IMK_UNIT_OF_DEVICE      /**< the data sheet of the device that the settings name */
} imk_unit_origin;

/** One column of a log. */
typedef struct imk_log_column {
    char name[48]; /**< "gyro_x" */
    imk_quantity quantity;
    int axis;       /**< 0 … 7; -1 for time, temperature, other */
    imk_unit unit;  /**< unit of the numbers in the file */
    bool increment; /**< the file holds increments of the integral */
    bool label; /**< the file holds texts (section names, …): the value is the index of the text
                     in the reader's list, see imk_log_label() */
    imk_unit_origin unit_origin;
} imk_log_column;

/** A sensor in a log that may hold several: a topic of a bag, messages of one kind and instance of
 * a flight log. */
typedef struct imk_log_stream {
    char name[96];     /**< "/imu/data", "sensor_accel"; "" in formats that hold one sensor only */
    char kind[64];     /**< type of the messages: "sensor_msgs/msg/Imu" */
    int instance;      /**< of those of the same name, from 0; -1: names are different */
    bool readable;     /**< it holds gyros or accelerometers that imk_log_open() reads */
    bool estimated;    /**< `samples` is an estimate */
    uint64_t samples;  /**< 0: not known */
    double begin, end; /**< times of its first and last sample [s], of the clock of the log; NaN:
                          not known */
} imk_log_stream;

/** Counts and times of the rows read so far. Rows count from 1, the first data row.
 *
 *  The interval is the median of the first 4096 positive time steps (of all, when there are fewer),
 *  afterwards the median of the medians of groups of 4096, or 1/rate where the settings state a
 *  rate. Gaps and jitter are assessed by the interval that was known when the group of the step was
 *  complete. The jitter leaves out gaps, repeats and reversals. A time that is not finite forms no
 *  step. */
typedef struct imk_log_findings {
    size_t rows;
    size_t not_finite, first_not_finite; /**< rows with a NaN, an infinity or an empty cell */
    size_t reversals, first_reversal;    /**< time steps < 0 */
    size_t repeats, first_repeat;        /**< time steps = 0 */
    /** Steps that leave samples out (imk_step_is_gap()); number of missing samples. */
    size_t gaps, first_gap, missing;
    double interval;              /**< median time step, or 1/rate [s] */
    double jitter;                /**< rms deviation of the steps from the interval [s] */
    double first_time, last_time; /**< [s] */
    /** [s] subtracted from the times: the first one if beyond 1e6 s (clocks that count from an
     *  epoch), so that microseconds keep their resolution; else 0. */
    double time_origin;
    int64_t time_origin_nanoseconds; /**< the same, exact where the log has whole numbers */
    /** Steps that evenly spaced samples do not have: below 0.4 intervals, or of 1.35 to 4 and more
     *  than 0.25 off a whole number; steps below 0.25 intervals. */
    size_t uneven, bursts;
    double largest_reversal; /**< [s] */
    double mean_step;        /**< of the steps that are no gap, repeat or reversal [s] */
    /** Standard deviation of the steps in intervals, each step counted as 2 intervals at most, and
     *  their correlation with the step before. */
    double step_scatter, step_correlation;
    /** Gaps about as far from the gap before as that was from its predecessor. */
    size_t steady_gaps;
    size_t doubled; /**< rows equal to the row before in time and values, where these were found */
    /** Rows, messages or blocks of the file that cannot be read and are left out; the place of the
     *  first, as rows before it. */
    size_t damaged, first_damaged;
    size_t damaged_line, damaged_column; /**< of the first in a text, from 1; 0: not known */
    size_t headers, first_header;        /**< lines between the rows of a text that are its header
                                            once more; rows before the first */
    bool cut_short;  /**< the file ends within a row, message or block, which is left out */
    bool received;   /**< the times are those of recording: the first messages do not say when they
                          were measured */
    uint64_t stamps; /**< messages that do, if `received` */
    /** Messages of the sensor with what its first ones do not have, and which is not read: gyros,
     *  accelerometers, a temperature. */
    uint64_t later[3];
    /** Sampling interval of the device that the log names, for increments of single samples [s];
     *  0: not known. */
    double device_interval;
    /** Arrays of the file, beside those that are read, that cannot be: of a sensor by their names,
     *  or of the group that is read; the first. */
    size_t unread;
    char unread_name[56], unread_kind[40];
    /** Messages whose header.frame_id is not that of the first one; the frames, in quotes. */
    size_t other_frames;
    char frames[96];
    /** Messages of the sensor that an index of the log states and that are not in it, of how many;
     *  known behind the last row. */
    uint64_t absent, stated;
    bool unclosed;   /**< the last messages may be in a file beside the log, which is not there */
    size_t unlisted; /**< files of a folder that its list of files does not name; the first */
    char unlisted_name[56];
} imk_log_findings;

/** Where the rows of a record come from. A function that the source does not offer is NULL. */
typedef struct imk_record_source {
    void *context;
    size_t column_count;
    const imk_log_column *columns; /**< columns in the order of `read`; values are SI */
    double rate;                   /**< sampling rate [Hz]; 0: from the time column */
    /** Read the next rows, up to `rows_most`, into one array per column (NULL skips a column).
     *  `rows` is set to the number of rows read: 0 at the end. */
    imk_status (*read)(void *context, size_t rows_most, double *const *columns, size_t *rows,
                       imk_error *error);
    /** Go back to the first row. A job reads a source to its end, so it has to be rewound before
     *  another job reads it. */
    imk_status (*rewind)(void *context, imk_error *error);
    /** Go to about this fraction of the record, 0 … 1; counts and times begin anew. For a look at
     *  parts of a long record. May be NULL. */
    imk_status (*seek)(void *context, double fraction, imk_error *error);
    /** Counts and times of the rows read so far. */
    imk_log_findings (*findings)(void *context);
    /** How much was read, and the total (0: not known), both in the same arbitrary measure. */
    void (*progress)(void *context, uint64_t *done, uint64_t *total);
    /** Text number `index` of the label columns; NULL beyond the last. */
    const char *(*label)(void *context, size_t index);
    bool axes_turned; /**< the axes of the sensors are not those of the file, but body axes */
} imk_record_source;

/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_record_find(const imk_record_source *source, imk_quantity quantity, int axis);

/** A column of a sensor in SI units, by name: gyro_x, accel_z, mag_x, time, temperature, or any
 *  other.
 *  @return the column; its quantity is IMK_QUANTITY_OTHER for a name that is not known */
IMK_API imk_log_column imk_record_column(const char *name);

/** Rows in memory as a source. The arrays belong to the caller; the other fields are internal. */
typedef struct imk_array_source {
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    const double *data[IMK_LOG_COLUMNS_MAX];
    ptrdiff_t stride[IMK_LOG_COLUMNS_MAX];
    size_t column_count, rows, next;
    double rate;
    imk_log_findings findings;
} imk_array_source;

/** Make a source of `rows` rows in one array per column.
 *  @param names   of the columns, in SI units: "gyro_x" [rad/s], "accel_x" [m/s^2], "mag_x" [T],
 *                 "time" [s], "temperature" [K]; or with the unit in brackets: "gyro_x [deg/s]",
 *                 "accel_x [count]", "table_rate [deg/s]"
 *  @param rate    sampling rate [Hz]; 0: from a column named time
 *  @param memory  holds the state of the source; must live as long as the source is used
 *  @return IMK_ERROR_COLUMN (too many columns, or a name twice), _ARGUMENT (no array or no name),
 *          _RATE_MISSING (neither rate nor time), _DIMENSION, _MEMORY, errors of imk_unit_parse()
 */
IMK_API imk_status imk_array_source_make(size_t column_count, const char *const *names,
                                         const double *const *data, size_t rows, double rate,
                                         imk_array_source *memory, imk_record_source *source,
                                         imk_error *error);
/** As imk_array_source_make(), for arrays whose numbers do not follow one another, such as the
 *  columns of a matrix that is stored row by row.
 *  @param strides  per column: distance of the numbers of two rows [doubles], of any sign */
IMK_API imk_status imk_array_source_strided(size_t column_count, const char *const *names,
                                            const double *const *data, const ptrdiff_t *strides,
                                            size_t rows, double rate, imk_array_source *memory,
                                            imk_record_source *source, imk_error *error);

/** Where the rows of a record go. */
typedef struct imk_record_sink {
    void *context;
    /** Called once before the first row: states the columns.
     *  @param decimals  per column: decimal places that hold every value to come; -1: not known
     *  @param rows      number of rows to come; 0: not known */
    imk_status (*begin)(void *context, size_t column_count, const imk_log_column *columns,
                        const int *decimals, uint64_t rows, imk_error *error);
    /** Write rows from one array per column, in SI. Columns of increments hold increments. */
    imk_status (*write)(void *context, size_t rows, const double *const *columns,
                        const imk_executor *executor, imk_error *error);
    /** Tells the source that holds the texts of the label columns; NULL: the sink does not need the
     *  texts. */
    void (*labels)(void *context, const imk_record_source *source);
} imk_record_sink;

/** A sink that writes rows into arrays of the caller. */
typedef struct imk_array_sink {
    size_t column_count; /**< number of arrays */
    size_t capacity;     /**< rows that each array can hold */
    size_t rows;         /**< rows written so far */
    double *const *data; /**< the arrays */
    size_t columns;      /**< columns of the record written: the first arrays */
    imk_log_column column[IMK_LOG_COLUMNS_MAX]; /**< what those columns are */
} imk_array_sink;

/** Make a sink into arrays. The caller sets column_count, capacity and data of `memory` before;
 * they stay as they are. Set rows to 0 before another job writes into the same arrays. More rows
 * than the capacity, or more columns, give IMK_ERROR_WORKSPACE: error.expected says how many arrays
 * and rows there must be. */
IMK_API imk_record_sink imk_array_sink_of(imk_array_sink *memory);

/** "gyro_x", "accel_3": the name of a sensor's column. Axes 0 to 2 are called x, y and z, others by
 *  their number.
 *  @param sensor  "gyro", "accel" or "mag"
 *  @param text    receives the name, 48 bytes */
IMK_API void imk_axis_name(const char *sensor, int axis, char *text);

/** A whole log in memory. */
typedef struct imk_log {
    size_t rows, column_count;
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    double *data[IMK_LOG_COLUMNS_MAX]; /**< rows values each (room for rows + 1), SI */
    imk_log_findings findings;
    size_t label_count;
    char (*label)[48];       /**< texts; the values of label columns are indices into this list */
    imk_allocator allocator; /**< allocator of the columns and labels */
} imk_log;

/** Free the columns of a loaded log. */
IMK_API void imk_log_free(imk_log *log);
/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_log_find(const imk_log *log, imk_quantity quantity, int axis);

IMK_END_C
#endif
