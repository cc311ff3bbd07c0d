/* SPDX-License-Identifier: Apache-2.0 */
/* What a format of logs is: a row of IMKI_LOG_FORMATS and a file with its functions. The reader and
 * the writer do what is common: units, axes, times, increments, findings, compression, threads, and
 * that a file appears complete or not at all. */
#ifndef IMUKIT_LOG_FORMATS_INTERNAL_H
#define IMUKIT_LOG_FORMATS_INTERNAL_H

#include "imukit/log.h"
#include "log_format_internal.h"

/* name of the functions below (imki_log_csv, …), then the members of imk_log_format. The first is
 * that of texts, of standard output and of names with any other ending. */
#define IMKI_LOG_FORMATS(ROW)                                                                      \
    ROW(csv, "csv", "CSV", ".csv .txt", NULL, NULL, true, false)                                   \
    ROW(npy, "npy", ".npy", ".npy", "\x93NUMPY", ".columns", true, false)                          \
    ROW(npz, "npz", ".npz", ".npz", NULL, NULL, true, false)                                       \
    ROW(mat, "mat", ".mat", ".mat", NULL, NULL, true, false)                                       \
    ROW(hdf5, "hdf5", "HDF5", ".h5 .hdf5", "\x89HDF\r\n\x1a\n", NULL, true, false)                 \
    ROW(bag, "bag", "ROS 1 bag", ".bag", "#ROSBAG V2", NULL, true, true)                           \
    ROW(mcap, "mcap", "MCAP", ".mcap",                                                             \
        "\x89"                                                                                     \
        "MCAP0\r\n",                                                                               \
        NULL, true, true)                                                                          \
    ROW(rosbag2, "rosbag2", "rosbag2", ".db3", "SQLite format 3", NULL, true, true)                \
    ROW(ulog, "ulog", "PX4 ULog", ".ulg", "ULog", NULL, false, false)                              \
    ROW(dataflash, "dataflash", "ArduPilot .bin", ".bin .BIN", "\xA3\x95", NULL, false, false)     \
    ROW(novatel, "novatel", "NovAtel", "", NULL, NULL, false, false)                               \
    ROW(sbg, "sbg", "sbgECom", "", NULL, NULL, false, false)                                       \
    ROW(ubx, "ubx", "UBX", ".ubx", NULL, NULL, false, false)                                       \
    ROW(vectornav, "vectornav", "VectorNav", "", NULL, NULL, false, false)                         \
    ROW(rtklib, "rtklib", "RTKLIB .pos", ".pos", NULL, NULL, false, false)                         \
    ROW(described, "binary", "records described by --binary", "", NULL, NULL, false, false)

/* What a format sees of a log that is written. */
typedef struct imki_log_output {
    imk_output_file *file;
    imk_output_file *companion; /* opened by `create`, appears with the file; NULL: none */
    imk_log_column column[IMK_LOG_COLUMNS_MAX];
    imki_row_format rows;
    uint64_t written, announced; /* rows; announced 0: not known */
    int64_t origin;              /* [ns] of the times */
    void *state;                 /* of the format */
} imki_log_output;

/* The functions of a format; those that may be NULL say what that means. Those that read know the
 * path and the settings from the reader. */
typedef struct imki_log_codec {
    /* Does a file begin like one of this format? Where `beginning` does not say it alone; NULL: it
     * does. */
    bool (*recognise)(const char *begin, size_t size);
    bool folders;       /* reads folders, too: reader->path, without text */
    bool needs_file;    /* moves in the file: a pipe and a compressed file are refused in words */
    bool defines_units; /* units are those of the format's definition, not of a header */
    /* Read what stands before the rows: layout, labels, and the times of the first rows
     * (imki_log_first_rows()). The bytes are at hand in reader->text; what else the format keeps it
     * puts into reader->state. */
    imk_status (*open)(imk_log_reader *reader, imk_error *error);
    /* Up to max_rows rows as they stand, times the factors of the layout. out: per cell. */
    imk_status (*read)(imk_log_reader *reader, size_t max_rows, double *const *out, size_t *rows,
                       imk_error *error);
    void (*close)(imk_log_reader *reader); /* NULL: reader->state is free()d */
    /* imk_log_seek(). NULL: there is none. */
    imk_status (*seek)(imk_log_reader *reader, double fraction, imk_error *error);
    /* imk_log_progress(). NULL: by the bytes of the text that are consumed. */
    void (*progress)(const imk_log_reader *reader, uint64_t *done, uint64_t *size);

    /* The file is open; `path` as given. NULL: nothing to do. */
    imk_status (*create)(imki_log_output *log, const char *path, imk_error *error);
    /* Before the first row. NULL: there is no place for comments. */
    void (*comment)(imki_log_output *log, const char *text);
    /* What stands before the rows. NULL: nothing. */
    void (*begin)(imki_log_output *log);
    /* Add rows first … first + count - 1; called by several threads. NULL: it is only read. */
    void (*format)(const imki_row_format *rows, const double *const *columns, size_t first,
                   size_t count, imki_log_bytes *bytes);
    /* Put what `format` made of the next `rows` rows into the file, in order. NULL: as it is. */
    imk_status (*write)(imki_log_output *log, const char *bytes, size_t size, size_t rows);
    /* After the last row. NULL: nothing to do. */
    imk_status (*end)(imki_log_output *log, imk_error *error);
    /* Free log->state, after the end and after an error. NULL: by free(). */
    void (*discard)(imki_log_output *log);
} imki_log_codec;

#define ROW(functions, ...) extern const imki_log_codec imki_log_##functions;
IMKI_LOG_FORMATS(ROW)
#undef ROW

/* The functions of a format of imk_log_format_get(). */
const imki_log_codec *imki_log_codec_of(const imk_log_format *format);

/* The format of a log that begins so. @param path  NULL: in memory */
const imk_log_format *imki_log_recognise(const char *path, const char *begin, size_t size);
/* The format that reads folders. NULL: none. */
const imk_log_format *imki_log_format_of_folders(void);

/* The command that leaves columns out; "" if nothing would remain.
 * @param keep  per column of the log */
void imki_log_select_text(const imki_log_output *log, const char *path, const bool *keep,
                          size_t size, char *text);
/* `name [unit]` of each column, each but the last followed by `separator`. */
void imki_log_names_write(imk_output_file *file, size_t column_count, const imk_log_column *columns,
                          char separator);

#endif
