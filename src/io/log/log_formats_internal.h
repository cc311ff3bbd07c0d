/* SPDX-License-Identifier: Apache-2.0 */
/* What a format of logs is: a row of IMKI_LOG_FORMATS and a file with its functions. The reader and
 * the writer do what is common: units, axes, times, increments, findings, compression, threads, and
 * that a file appears complete or not at all. */
#ifndef IMUKIT_LOG_FORMATS_INTERNAL_H
#define IMUKIT_LOG_FORMATS_INTERNAL_H

#include "imukit/log.h"
#include "log_format_internal.h"

/* name of the functions below (imki_log_csv, …); what help and messages call the format, which is
 * the ending of its files; how they begin, NULL: they are known by the ending only; the ending more
 * of a file that comes with one, NULL: none; whether it is written, too. The first is that of
 * texts, of standard output and of names with any other ending. */
#define IMKI_LOG_FORMATS(ROW)                                                                      \
    ROW(csv, "CSV", NULL, NULL, true)                                                              \
    ROW(npy, ".npy", "\x93NUMPY", ".columns", true)

/* What a format sees of a log that is written. */
typedef struct imki_log_output {
    imk_output_file *file;
    imk_output_file *companion; /* opened by `create`, appears with the file; NULL: none */
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    imki_row_format rows;
    uint64_t written, announced; /* rows; announced 0: not known */
} imki_log_output;

/* The functions of a format; those that may be NULL say what that means. Those that read know the
 * path and the settings from the reader. */
typedef struct imki_log_codec {
    /* Read what stands before the rows: layout, labels, and the times of the first rows
     * (imki_log_first_rows()). The bytes are at hand in reader->text; what else the format keeps it
     * puts into reader->state. */
    imk_status (*open)(imk_log_reader *reader, imk_error *error);
    /* Up to max_rows rows as they stand, times the factors of the layout. out: per cell. */
    imk_status (*read)(imk_log_reader *reader, size_t max_rows, double *const *out, size_t *rows,
                       imk_error *error);
    void (*close)(imk_log_reader *reader); /* NULL: reader->state is free()d */

    /* The file is open; `path` as given. NULL: nothing to do. */
    imk_status (*create)(imki_log_output *log, const char *path, imk_error *error);
    /* Before the first row. NULL: there is no place for comments. */
    void (*comment)(imki_log_output *log, const char *text);
    /* What stands before the rows. NULL: nothing. */
    void (*begin)(imki_log_output *log);
    /* Add rows first … first + count - 1; called by several threads. NULL: it is only read. */
    void (*format)(const imki_row_format *rows, const double *const *columns, size_t first,
                   size_t count, imki_log_bytes *bytes);
    /* After the last row. NULL: nothing to do. */
    imk_status (*end)(imki_log_output *log, imk_error *error);
} imki_log_codec;

#define ROW(functions, ...) extern const imki_log_codec imki_log_##functions;
IMKI_LOG_FORMATS(ROW)
#undef ROW

/* The functions of a format of imk_log_format_get(). */
const imki_log_codec *imki_log_codec_of(const imk_log_format *format);

/* The format of a log that begins so. @param path  NULL: in memory */
const imk_log_format *imki_log_format_recognise(const char *path, const char *begin, size_t size);

/* `name [unit]` of each column, each but the last followed by `separator`. */
void imki_log_names_write(imk_output_file *file, size_t column_count, const imk_log_column *columns,
                          char separator);

#endif
