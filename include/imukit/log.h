/* SPDX-License-Identifier: Apache-2.0 */
/** @file log.h
 *  Sensor logs of many formats, read and written as streams of rows.
 *
 *  CSV: a header `time [s],gyro_x [deg/s],…,accel_x [g],…,temperature [degC]` in any order; lines
 *  starting with # are comments; comma, semicolon, tab or blanks separate. Increments
 *  (`dtheta_x [arcsec]`, `dvel_x [m/s]`) are divided by the sample interval. Everything comes out
 *  in SI units. */
#ifndef IMUKIT_LOG_H
#define IMUKIT_LOG_H

#include "imukit/executor.h"
#include "imukit/job.h"
#include "imukit/output_file.h"
#include "imukit/record.h"
#include "imukit/status.h"
#include "imukit/units.h"

#include <stdbool.h>

IMK_BEGIN_C

/** A format of logs. */
typedef struct imk_log_format {
    const char *name;      /**< what imk_log_settings.format takes: "npy" */
    const char *title;     /**< its name in messages: ".npy", "ROS 1 bag" */
    const char *endings;   /**< endings of its files, with blanks between: ".h5 .hdf5"; "": none */
    const char *beginning; /**< first bytes of its files; NULL: they do not tell, or not alone */
    const char *companion; /**< ending added for the file of names and units that comes with each
                              file, such as ".columns" for FILE.npy.columns; NULL: there is none */
    bool written;          /**< the format can be written, too */
    bool keeps_epoch;      /**< its stamps are whole nanoseconds, since 1970 or whatever else: see
                              imk_log_write_origin() */
} imk_log_format;

/** Format `index`, CSV first; NULL beyond the last. In the order in which contents are compared
 * with them. */
IMK_API const imk_log_format *imk_log_format_get(size_t index);
/** Format of a log by the name of its file, where a final .gz or .zst is ignored; CSV if that does
 *  not tell.
 *  @param path  may be NULL */
IMK_API const imk_log_format *imk_log_format_of(const char *path);
/** Format of a log that is to be written: by the ending of its name; CSV for names without an
 *  ending, standard output, and what is no regular file, such as a pipe.
 *  @param path  may be NULL
 *  @return IMK_ERROR_UNSUPPORTED (an ending of no format, or of one that is only read; the error
 *          lists the endings) */
IMK_API imk_status imk_log_format_written(const char *path, const imk_log_format **format,
                                          imk_error *error);
/** Format of a log by its first bytes; NULL: they do not tell. */
IMK_API const imk_log_format *imk_log_format_begun(const char *begin, size_t size);
/** Format of a name of imk_log_format.name; NULL: there is none. */
IMK_API const imk_log_format *imk_log_format_named(const char *name);
/** List the titles of all formats except CSV, to follow "CSV" in a message: ", .npy or ROS 1 bag".
 *  @param last     text before the last title: " or "
 *  @param written  true: only formats that can be written
 *  @return text, of at most size - 1 bytes */
IMK_API const char *imk_log_formats_text(const char *last, bool written, size_t size, char *text);

/** How to read a file. Start from imk_log_default(). A text that is NULL is taken from the header.
 */
typedef struct imk_log_settings {
    uint32_t cookie;
    const char *columns; /**< names for a file without header: "time,gyro_x,gyro_y,…"; "-" skips */
    /** Columns by the names that the file has for them: "gyro_x=wx,time=stamp [us]"; the others are
     * not read. NULL: the names tell what they are. */
    const char *map;
    /** Units for columns without a unit in the file. One that contradicts the file is refused. */
    const char *gyro_unit, *accel_unit, *time_unit, *temperature_unit;
    /** Name of the format (imk_log_format.name) for files that do not tell it; NULL: by content. */
    const char *format;
    /** Layout of the records of a binary file: "u32 time us, 3 x i16 gyro 16.4 LSB/(deg/s), 3 x i16
     *  accel 2048 LSB/g" (docs/logs.md); NULL: the file is none. */
    const char *binary;
    /** Which of the sensors in a log that holds several (imk_log_stream): its name, or an ending of
     * it that only one has; NULL: the only one. */
    const char *topic;
    /** Which of the sensors of one name: its imk_log_stream.instance plus 1; 0: the only one. */
    int instance;
    /** What a count of gyros and accelerometers is, "16.4 LSB/(deg/s)", "0.061 mg/LSB"
     *  (imk_count_scale_parse()). Or the device whose counts these are, with its full scales,
     *  "2000 deg/s", "16 g", where it has several (imk_device_sensitivity_find()); then its
     *  temperature is converted, too. NULL: counts stay counts. */
    const char *gyro_scale, *accel_scale;
    const char *device, *gyro_range, *accel_range;
    double rate; /**< sampling rate [Hz]; required without a time column; 0: from the times */
    /** Only rows from `after` to `before` seconds from the first one are read; 0: from the first,
     *  to the last. Times stay as they are; findings are of the rows read. */
    double after, before;
    const char *axes; /**< axes of the log, "right-forward-up" …, mapped to forward-right-down;
                         NULL: no mapping */
    bool any_columns; /**< also accept a table without time and sensors; default false */
    /** For a first look: a column whose unit nobody states is read as it is written, with an empty
     *  unit of scale 1, also the time; a log without times needs no rate, and a CSV without header
     *  has "column 1", "column 2", … Default false: all that is missing is refused. */
    bool as_written;
    bool reopened; /**< the log will be opened again. An input that cannot be rewound, such as a
                      pipe, is then first copied to a temporary file in TMPDIR. That file is read
                      now and at later openings, up to and including the first without `reopened`;
                      default false */
    size_t memory; /**< largest memory for a whole log [bytes]; 0: half of imk_memory_limit() */
} imk_log_settings;

/** Everything from the header of the file. */
IMK_API imk_log_settings imk_log_default(void);

typedef struct imk_log_reader imk_log_reader;

/** Open a log and read its header. `path` may be "-" (standard input), a pipe or a compressed file.
 *  The memory needed does not depend on the length of the log; a line beyond 1 MiB is refused.
 *
 *  Names, in any case: time (t, timestamp); gyro_, dtheta_, accel_ (acc_), dvel_ followed by x, y,
 *  z or 0 … 7; temperature (temp); and what people and programs write for these (docs/logs.md).
 *  Units follow the name in brackets or parentheses, or at its end. Counts are allowed for any
 *  sensor. Texts may be UTF-8, UTF-16 and of any line ends; numbers may have decimal commas, times
 *  be dates. Rows that cannot be read are left out and counted, as long as they are few: up to 3 or
 *  1 %. Other columns are kept as IMK_QUANTITY_OTHER: in SI if their unit is
 *  known, else unchanged. If the first cell that is not blank, within 16 MiB, holds a text, the
 *  column is a label column; a blank cell is then the empty text.
 *
 *  The message of every error ends with the exact option to add.
 *  @return IMK_ERROR_OPEN, _READ, _WRITE (of the temporary copy), _EMPTY, _FORMAT, _COMPRESSED,
 *          _COLUMN, _UNIT_MISSING, _UNIT_UNKNOWN, _DIMENSION, _RATE_MISSING, _NAME_UNKNOWN (the
 *          format; the topic, or several and none chosen), _CONFLICT (a unit of the settings and
 *          that of the file), _UNSUPPORTED (a pipe, of a format that needs a file; a format that is
 *          only known by name), … */
IMK_API imk_status imk_log_open(const char *path, const imk_log_settings *settings,
                                imk_log_reader **reader, imk_error *error);

/** As imk_log_open(), for a first look: a log of which units, times or names are missing is opened
 *  with settings.as_written.
 *  @param lacking  receives what is missing; its status is IMK_OK if nothing is
 *  @return errors of imk_log_open() */
IMK_API imk_status imk_log_open_first_look(const char *path, const imk_log_settings *settings,
                                           imk_log_reader **reader, imk_error *lacking,
                                           imk_error *error);

/** The sensors of a log, without choosing one: as imk_log_open(), but settings.topic and .instance
 *  are left aside. Only what stands at the beginning, at the end and in an index of the file is
 *  read.
 *  @param stream  receives up to `most`, those that can be read first
 *  @param count   receives their number, which may be above `most`; 0: the log has none of its own
 *  @param format  receives the format of the log; may be NULL
 *  @return errors of imk_log_open(), but for a log in which there is nothing that can be read */
IMK_API imk_status imk_log_streams(const char *path, const imk_log_settings *settings, size_t most,
                                   imk_log_stream *stream, size_t *count,
                                   const imk_log_format **format, imk_error *error);
/** The same of a log that is open. @return their number */
IMK_API size_t imk_log_stream_list(const imk_log_reader *reader, size_t most,
                                   imk_log_stream *stream);

/** The sensor that is read. */
IMK_API const imk_log_stream *imk_log_stream_get(const imk_log_reader *reader);
/** The format of the log. */
IMK_API const imk_log_format *imk_log_format_read(const imk_log_reader *reader);

/** As imk_log_open(), for a log in memory, which must outlive the reader. */
IMK_API imk_status imk_log_open_memory(const char *text, size_t size,
                                       const imk_log_settings *settings, imk_log_reader **reader,
                                       imk_error *error);

/** Number of columns of the log. */
IMK_API size_t imk_log_column_count(const imk_log_reader *reader);
/** Description of column `index`, whose values are read in SI; NULL beyond the last. */
IMK_API const imk_log_column *imk_log_column_get(const imk_log_reader *reader, size_t index);
/** Index of the column of a quantity and axis, or -1. */
IMK_API int imk_log_column_find(const imk_log_reader *reader, imk_quantity quantity, int axis);
/** Bytes of the file consumed and its size (0 when not known), for progress. */
IMK_API void imk_log_progress(const imk_log_reader *reader, uint64_t *done, uint64_t *size);

/** Read up to max_rows rows, SI units, into one array per column (NULL skips a column).
 *
 *  A value is number * scale + offset of its unit. Increments are divided by the interval: 1/rate
 *  if the settings state a rate, else the time step from the row before (for the first row: to the
 *  next row; if the step is not positive: the last positive one). An empty cell is NaN. If rows
 *  before an error could be read, the next call returns the error.
 *  @param rows  how many were read; 0 at the end
 *  @return IMK_ERROR_SYNTAX (cells that are not numbers), IMK_ERROR_COLUMN (rows with another
 *          number of cells), where they are more than few; IMK_ERROR_CONFLICT (the rate of the
 *          settings and the times), IMK_ERROR_COMPRESSED, IMK_ERROR_READ, with line and column of
 *          the first. A last line without an end is left out, unless it has the decimals of the
 *          others: it may be cut within a number. */
IMK_API imk_status imk_log_read(imk_log_reader *reader, size_t max_rows, double *const *columns,
                                size_t *rows, imk_error *error);

/** Go to about this fraction of the log, 0 … 1; the next rows are read from there, and counts and
 *  times begin anew. For a look at a long log.
 *  @return IMK_ERROR_UNSUPPORTED (a pipe, a compressed file, a format without this) */
IMK_API imk_status imk_log_seek(imk_log_reader *reader, double fraction, imk_error *error);

/** Text number `index` of the label columns, in the order of appearance; NULL beyond the last. */
IMK_API const char *imk_log_label(const imk_log_reader *reader, size_t index);

/** Counts and times of the rows read so far. */
IMK_API imk_log_findings imk_log_findings_get(const imk_log_reader *reader);

/** Close and free; NULL is allowed. */
IMK_API void imk_log_close(imk_log_reader *reader);

/** Make a record source of a log, from the present position of the reader; it is valid until the
 *  reader is closed. Rewinding opens the log again with the same path and settings, which must
 *  still exist. To rewind a pipe, open it with settings.reopened; else it is empty then. */
IMK_API imk_record_source imk_log_source(imk_log_reader *reader);

/** Read a whole log. Free with imk_log_free().
 *  @param job  its allocator, progress and memory are used (settings.memory takes precedence);
 *              NULL: no progress, memory from the C library
 *  @return errors of imk_log_open() and imk_log_read(); IMK_ERROR_MEMORY (with the number of rows
 *          read) for a log that takes more memory than allowed */
IMK_API imk_status imk_log_load(const char *path, const imk_log_settings *settings,
                                const imk_job *job, imk_log *log, imk_error *error);

/** How numbers are written. */
typedef enum imk_log_precision {
    /** In SI units (scale 1) the shortest decimal that reads back to the same double. In other
     * units a decimal of at most 15 or so digits where one reads back to the SI value, scale *
     * number + offset == value; else the shortest decimal of the quotient, (value - offset) /
     * scale. So a log in deg/s or g with up to 15 significant digits, or in degC with up to 11
     * decimals, is the same text after reading and writing. Of arbitrary SI doubles, 2 to 16 % (by
     * unit) have no double in the unit that reads back to them; they move by one unit in the last
     * place. */
    IMK_LOG_SHORTEST = 0,
    IMK_LOG_FIXED /**< a number of decimals per column, exactly rounded quotients */
} imk_log_precision;

/** Writes one log; one thread at a time. Memory: about 1.3 MB, and 2.5 MB per thread of the
 *  executor. */
typedef struct imk_log_writer imk_log_writer;

/** Start a log. The file appears complete or not at all (output_file.h).
 *
 *  - A path ending in .npy: float64 matrix, rows x columns, C order, little-endian, values in the
 *    units of the columns chosen as for IMK_LOG_SHORTEST; `name [unit]` of each column goes to a
 *    line of FILE.npy.columns, which appears with it.
 *  - .npz, .mat (version 5), .h5 and .hdf5: a vector of float64 for each column, with its unit. The
 *    columns are kept in a temporary file in TMPDIR until the log is finished.
 *  - .bag, .mcap, .db3: messages sensor_msgs/Imu of a time and three gyros, three accelerometers or
 *    both; a .bag and a .db3 are plain files.
 *  - .csv, .txt, no ending, "-" and NULL (standard output): CSV text, commas, line feeds, `name
 *    [unit]` in the header (`name` for a unit without text). NaN and infinities are written nan,
 *    inf, -inf.
 *  - A path that ends in .gz or .zst after .csv, .txt, .npy or no ending is compressed.
 *  - Any other ending is refused (imk_log_format_written()).
 *
 *  @param columns    name and unit of each; values given to imk_log_write() are SI: an increment
 *                    column takes increments of the integral [rad, m/s]. Names are not empty,
 *                    different, and without separators, quotes and brackets.
 *  @param decimals   per column (0 … 17), with IMK_LOG_FIXED; else NULL
 *  @param row_count  number of rows if known, else 0. Only a .npy that is not a plain file (a pipe,
 *                    compressed) needs it, and then exactly.
 *  @return IMK_ERROR_OPEN, IMK_ERROR_COLUMN (a name; a column that the format does not hold,
 *          as a label column in any but a CSV), IMK_ERROR_ARGUMENT (a unit or decimals),
 *          IMK_ERROR_UNSUPPORTED (the ending; a format that needs a plain file; a .npy that needs
 *          row_count; more rows than a .mat holds), IMK_ERROR_WRITE (no temporary file),
 *          IMK_ERROR_MEMORY */
IMK_API imk_status imk_log_create(const char *path, size_t column_count,
                                  const imk_log_column *columns, imk_log_precision precision,
                                  const int *decimals, uint64_t row_count, imk_log_writer **writer,
                                  imk_error *error);
/** State the time from which those of the rows count: time_origin_nanoseconds of the
 *  imk_log_findings of the log that they were read from. It is added to the stamps of formats that
 *  keep it (imk_log_format.keeps_epoch), and to the times of a text in whole nanoseconds. To be
 *  called before the first row. */
IMK_API void imk_log_write_origin(imk_log_writer *writer, int64_t nanoseconds);
/** Write comment lines (one per line of the text) before the header of a CSV; a .npy leaves them
 *  out. @return IMK_ERROR_ARGUMENT after the first row */
IMK_API imk_status imk_log_comment(imk_log_writer *writer, const char *text);
/** Function that gives the text for a value of a label column; NULL: there is none. */
typedef const char *(*imk_log_label_lookup)(void *context, size_t index);
/** State the function that gives the texts of label columns of a CSV; call this before the first
 *  row. Without `lookup`, and where it returns NULL, the index is written. With an executor in
 *  imk_log_write(), several threads call `lookup` at once. */
IMK_API void imk_log_write_labels(imk_log_writer *writer, imk_log_label_lookup lookup,
                                  void *context);
/** Add rows from one array per column, SI. @param executor  formats blocks in parallel while
 *  earlier blocks are compressed and written; may be NULL. The bytes depend neither on it nor on
 *  how the rows are divided among calls.
 *  @return IMK_ERROR_WRITE or IMK_ERROR_MEMORY, possibly one call late; IMK_ERROR_NOT_FINITE (a
 *          finite value that is infinite in the column's unit); imk_log_commit() gives the reason
 */
IMK_API imk_status imk_log_write(imk_log_writer *writer, size_t rows, const double *const *columns,
                                 const imk_executor *executor);
/** Finish the log: the file appears, or nothing after an error. Frees the writer.
 *  @return IMK_ERROR_WRITE (error.field: the path, error.found: the system's reason),
 *          IMK_ERROR_CONFLICT (the number of rows differs from row_count, where that is needed),
 *          IMK_ERROR_NOT_FINITE (error.field: column and row), IMK_ERROR_MEMORY */
IMK_API imk_status imk_log_commit(imk_log_writer *writer, imk_error *error);
/** A log written as a record sink. */
typedef struct imk_log_sink {
    const char *path; /**< "-": standard output */
    bool fixed; /**< write with IMK_LOG_FIXED; `decimals` holds for columns for which the job states
                   none */
    int decimals;
    /** Write as imu0/data.csv of the EuRoC data set: its header, times in whole nanoseconds. The
     * columns must be time, gyro_x … gyro_z, accel_x … accel_z; `fixed` does not hold. */
    bool euroc;
    int64_t origin;         /**< see imk_log_write_origin() [ns] */
    imk_log_writer *writer; /**< its own */
    imk_record_source labels;
    uint64_t rows; /**< written so far */
    size_t column_count;
    imk_log_column column[IMK_LOG_COLUMNS_MAX]; /**< as they are in the file */
} imk_log_sink;

/** Make a record sink of a log, whose path and precision must be set. */
IMK_API imk_record_sink imk_log_sink_of(imk_log_sink *log);
/** Finish the log, or discard it if the job failed.
 *  @param status,error  those of the job that wrote the log
 *  @return `status`, or why the log could not be finished */
IMK_API imk_status imk_log_sink_end(imk_log_sink *log, imk_status status, imk_error *error);

/** Discard a log: no file appears. Frees the writer; NULL is allowed. */
IMK_API void imk_log_abandon(imk_log_writer *writer);

IMK_END_C
#endif
