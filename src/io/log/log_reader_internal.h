/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the log reader: what the columns are, and a row in its general form. */
#ifndef IMUKIT_LOG_READER_INTERNAL_H
#define IMUKIT_LOG_READER_INTERNAL_H

#include "imukit/log.h"
#include "jobs/record/record_times_internal.h"
#include "log_formats_internal.h"
#include "log_stamps_internal.h"
#include "log_text_internal.h"

enum { IMKI_LABELS_MAX = 4096 };

typedef char imki_log_label[48];

/* What the header and the settings leave open. */
typedef struct imki_log_missing {
    size_t count;                   /* units: one for each option that states one */
    size_t kind[4];                 /* their rows of imki_log_kinds */
    int first[4];                   /* the first column of each */
    bool cell[IMK_LOG_COLUMNS_MAX]; /* lacks its unit */
    bool rate;                      /* there is neither a time nor a rate */
} imki_log_missing;

/* What the rows show of what is missing. */
typedef struct imki_log_hints {
    const char *time_unit, *time_words; /* "ns", "nanoseconds": the only one that fits; NULL */
    char time[32];                      /* one of the times */
    bool counts;                        /* whole numbers where a unit is missing */
    int time_like; /* a column that seems to be the time by its name and numbers; -1: none */
} imki_log_hints;

/* Cells of a row and the columns they are. */
typedef struct imki_log_layout_read {
    size_t cell_count;
    int cell_column[IMK_LOG_COLUMNS_MAX];    /* -1: skipped */
    double cell_factor[IMK_LOG_COLUMNS_MAX]; /* 1 for time, which is scaled later */
    char separator;
    bool decimal_comma;                  /* "1,5" is a number */
    bool date_cell[IMK_LOG_COLUMNS_MAX]; /* holds dates: "2024-05-01T12:00:00.5Z" */
    imki_log_stamps stamps;              /* how the times are read; set behind the columns */
    size_t rest_cell;                    /* of stamps in two columns, the second */
    size_t column_count;
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    double factor[IMK_LOG_COLUMNS_MAX]; /* per column: scale, with the sign of the axes */
    double offset[IMK_LOG_COLUMNS_MAX]; /* per column, added to factor times number */
    double most[IMK_LOG_COLUMNS_MAX];   /* largest that the counts of a device give, before the
                                           offset [SI]; 0: not known */
    int time_column;                    /* -1: none */
    bool has_increments;
    bool axes_turned; /* those of the columns are not those of the file */
    imki_log_missing missing;
} imki_log_layout_read;

/* A piece of text. */
typedef struct imki_log_piece {
    const char *begin, *end;
} imki_log_piece;

/* Divide a line into cells; quotes and blanks around a cell are taken off.
 * @return how many there are, also beyond max_count */
size_t imki_log_split(const char *begin, const char *end, char separator, size_t max_count,
                      imki_log_piece *cells);

/* comma, semicolon, tab or blank: which one separates the cells of this line? */
char imki_log_find_separator(const char *begin, const char *end);

/* Is the line blank or a comment? */
bool imki_log_line_is_idle(const char *begin, const char *end);

bool imki_log_piece_is_number(imki_log_piece piece, double *value);
/* Is it empty, or a word for a value that is not there, such as N/A, null or -? */
bool imki_log_piece_is_missing(imki_log_piece piece);

/* Fill the layout from the names of the cells (`header`) and the settings. `separator`,
 * `decimal_comma` and `dates` of the layout stay.
 * @return IMK_ERROR_UNIT_MISSING, IMK_ERROR_RATE_MISSING: all that is missing is in one message,
 *         and in layout->missing */
imk_status imki_log_layout_make(const imki_log_piece *header, size_t cell_count,
                                const imk_log_settings *settings, imki_log_layout_read *layout,
                                imk_error *error);

/* log_counts.c: do the settings say what counts of a quantity are? */
bool imki_log_counted(const imk_log_settings *settings, imk_quantity quantity);
/* Refuse counts that the device cannot give: of the last `rows` rows, which are among
 * reader->rows. */
imk_status imki_log_counts_check(const imk_log_reader *reader, size_t rows, double *const *columns,
                                 imk_error *error);
/* Make a column of counts one of a physical unit, where the settings say what a count is: its unit,
 * and SI value = *factor * count + *offset, where *most is the largest *factor * count of a device.
 * Other columns stay.
 * @return IMK_ERROR_CONFLICT (it is none of counts), or what imk_count_scale_parse() and
 *         imk_device_sensitivity_find() return */
imk_status imki_log_counts_apply(const imk_log_settings *settings, imk_log_column *column,
                                 double *factor, double *offset, double *most, imk_error *error);

/* The message of what is missing once more, with what the rows show. */
imk_status imki_log_missing_refuse(const imki_log_layout_read *layout, const imki_log_hints *hints,
                                   imk_error *error);

/* Multiply the numbers of a cell, beside its unit. */
void imki_log_layout_scale(imki_log_layout_read *layout, size_t cell, double factor);

/* Read "right-forward-up": file axis i is sign[i] times body axis body[i] (0 forward, 1 right,
 * 2 down). */
imk_status imki_log_axes_parse(const char *text, int body[3], double sign[3], imk_error *error);

/* Read one row in its general form: blanks, quotes, empty cells, nan, labels, decimal commas,
 * dates.
 * @param labels      texts of label columns, *label_count of room for IMKI_LABELS_MAX
 * @param not_finite  whether a number is missing, NaN or infinite */
imk_status imki_log_row_read(imki_log_layout_read *layout, imki_log_piece line, size_t line_number,
                             imki_log_label *labels, size_t *label_count, double *values,
                             bool *not_finite, imk_error *error);

enum { IMKI_LOG_BLOCK = 1024 }; /* rows handled at a time */

/* Which part of the log is read. */
typedef struct imki_log_part {
    size_t before, after; /* rows dropped before and after it */
    size_t not_finite;    /* rows in it */
    bool begun;
    double first_time, place; /* of the first row [s]; of the last row, from it */
} imki_log_part;

/* Steps of the times that are even, for a look at a stated rate. */
typedef struct imki_log_pace {
    bool begun, done;
    size_t steps;
    double first, last, least, most; /* [s] */
} imki_log_pace;

/* Steps of the time, by which increments are divided. */
typedef struct imki_log_steps {
    double usual, last; /* [s] */
    unsigned even;      /* steps like the usual one, in a row */
    unsigned alike;     /* steps like the last one, in a row */
} imki_log_steps;

struct imk_log_reader {
    imki_log_text text;
    imki_log_layout_read layout;
    const imk_log_format *format;
    const imki_log_codec *codec;
    void *state; /* of the format; from malloc() */
    /* The sensors in the log, those that are readable first. */
    imk_log_stream *streams;
    size_t stream_count, stream_room;
    size_t stream;              /* the one that is read */
    double origin_before;       /* [s] that the format itself subtracted from the times */
    int64_t origin_nanoseconds; /* the same */
    /* Met by the format: rows, messages or blocks that are left out; the end within one. */
    size_t damaged, first_damaged;
    size_t damaged_line, damaged_column; /* of the first, in a text */
    size_t headers, first_header;        /* of a text, once more between its rows */
    bool cut_short;
    size_t unread; /* arrays, as in imk_log_findings */
    char unread_name[56], unread_kind[40];
    size_t other_frames; /* messages of another frame than the first; all frames */
    char frames[96];
    uint64_t absent, stated; /* as in imk_log_findings, and so the next */
    bool unclosed;
    size_t unlisted;
    char unlisted_name[56];
    bool received;             /* the times are those of recording, as the first stamps are 0 */
    uint64_t stamps, later[3]; /* as in imk_log_findings */
    double rate;               /* [Hz]; 0: from the times */
    double time_origin;        /* in the unit of the file */
    double last_time;          /* [s] */
    imki_log_steps steps;      /* of the times so far, for increments */
    double device_interval;    /* [s], of the device that the log names; 0: not known */
    size_t rows, not_finite, first_not_finite;
    imki_log_label *labels;
    size_t label_count;
    const char *path; /* what it was opened with, for another time; NULL: a text in memory */
    const char *memory;
    size_t memory_size;
    imk_log_settings settings;
    bool failed; /* an error met behind rows that were delivered; comes with the next call */
    imk_error failure;
    imki_record_times times;
    imki_log_part part;
    imki_log_pace pace;
    double spare[IMKI_LOG_BLOCK];    /* for columns nobody wants */
    double time[IMKI_LOG_BLOCK];     /* for the times, if nobody wants them */
    double interval[IMKI_LOG_BLOCK]; /* [s] of increments */
};

/* Compare the rate of the settings with the times [s] of the next rows. @param ended  of the last
 * ones. @return IMK_ERROR_CONFLICT */
imk_status imki_log_pace_check(imk_log_reader *reader, size_t rows, const double *time, bool ended,
                               imk_error *error);

/* Keep the rows within the part that the settings state; the others are counted.
 * @param time,out  of `rows` rows, as the format gave them: times in the unit of the file (NULL: no
 *                  time column), cells
 * @return how many are kept, at the front of the arrays */
size_t imki_log_part_keep(imk_log_reader *reader, size_t rows, const double *time,
                          double *const *out);
/* At the end of a log without a row in the part: @return IMK_ERROR_RANGE if it has others. */
imk_status imki_log_part_empty(const imk_log_reader *reader, imk_error *error);
imk_status imki_log_part_check(const imk_log_settings *settings, imk_error *error);

/* Note a sensor of the log, which may be one that cannot be read. The format does so in open(), in
 * the order in which they shall be listed. @return IMK_ERROR_MEMORY */
imk_status imki_log_stream_add(imk_log_reader *reader, const imk_log_stream *stream,
                               imk_error *error);
/* May the settings mean this one? Where they name none, any. */
bool imki_log_stream_is_named(const imk_log_reader *reader, const imk_log_stream *stream);
/* Choose the sensor to read, by the settings or because it is the only readable one.
 * @param nothing  what a log lacks that has none, as in "no topic of type sensor_msgs/Imu"
 * @param index    receives its place in the order of imki_log_stream_add()
 * @return IMK_ERROR_NAME_UNKNOWN (none has the name of the settings; several, and none chosen),
 *         IMK_ERROR_EMPTY (none can be read) */
imk_status imki_log_stream_choose(imk_log_reader *reader, const char *nothing, size_t *index,
                                  imk_error *error);

/* The layout of columns that the format defines: names as in a header, "gyro_x [rad/s]"; "-" and
 * NULL are left out. @param count  up to IMK_LOG_COLUMNS_MAX; cell i of the rows is that of
 * names[i] */
imk_status imki_log_layout_of(imk_log_reader *reader, size_t count, const char *const *names,
                              imk_error *error);

/* Ticks of a clock in nanoseconds, exact where a tick is some of them; 0: beyond 292 years. */
int64_t imki_log_nanoseconds(int64_t ticks, int64_t per_second);
/* Whole stamps of a clock: what to subtract from all before they become seconds, by the rule that
 * times beyond 1e6 s count from the first one, without loss of digits.
 * @param per_second  stamps in a second */
int64_t imki_log_stamp_origin(imk_log_reader *reader, int64_t first, int64_t per_second);

/* A row, message or block that cannot be read is left out; `rows` of the call are before it. */
void imki_log_damage(imk_log_reader *reader, size_t rows);

/* Back to the first row: the log is opened again. */
imk_status imki_log_rewind(imk_log_reader *reader, imk_error *error);

/* What the first rows say: the origin of the times and the first step.
 * @param rows  how many there are, 2 standing for more
 * @param time  of the first two, as they stand; NaN where not known
 * @param none,due  what was found where there is no row, and what is expected
 * @return IMK_ERROR_EMPTY, IMK_ERROR_TOO_SHORT (increments without a step) */
imk_status imki_log_first_rows(imk_log_reader *reader, uint64_t rows, const double time[2],
                               const char *none, const char *due, imk_error *error);

/* Fill reader->interval for rows of these times, which follow those before. */
void imki_log_intervals(imk_log_reader *reader, size_t rows, const double *time);

#endif
