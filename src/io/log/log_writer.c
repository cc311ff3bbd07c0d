/* SPDX-License-Identifier: Apache-2.0 */
/* Logs written as streams of rows.
 *
 * Rows are formatted in blocks, each into its own bytes, by the items of an executor; a wave of
 * blocks is written to the file, in order, by item 0 of the next wave. So the file's system calls
 * and compression run beside the formatting, and the bytes do not depend on the executor. */
#include "imukit/log.h"

#include "io/file/output_file_internal.h"
#include "log_formats_internal.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    BLOCK_CELLS = 4096,     /* about 50 kB of text: in the second-level cache */
    BLOCKS_PER_THREAD = 16, /* so that the threads end a wave together, within some per cent */
    BLOCKS_MAX = 257,       /* in a wave */
    PARALLEL_CELLS = 2048   /* fewer are not worth waking a thread, some 10 us */
};

typedef struct wave {
    imki_log_bytes block[BLOCKS_MAX];
    size_t rows[BLOCKS_MAX];
    size_t count;
} wave;

struct imk_log_writer {
    imki_log_output log;
    const imki_log_codec *codec;
    bool begun; /* what stands before the rows is written */
    wave waves[2];
    int filling; /* the wave that is formatted next; the other one waits to be written */
    imk_status status;
    size_t beyond_column; /* of a value that its unit cannot hold, when status is NOT_FINITE */
    uint64_t beyond_row;
};

/* Names and units become cells of the header, so they must not contain what divides it. A # in
 * front of all makes the header a comment, which is read as a header, too. */
static imk_status check_column(const imk_log_column *columns, size_t index, imk_error *error)
{
    const imk_log_column *column = &columns[index];
    const char *name = column->name + (index == 0 && column->name[0] == '#');
    if (name[0] == '\0' || strpbrk(name, ",;\"#[]()\t\r\n"))
        return imk_error_set(error, IMK_ERROR_COLUMN, column->name,
                             "this is not a valid column name",
                             "a name without separators, quotes and brackets");
    for (size_t i = 0; i < index; i++)
        if (strcmp(columns[i].name, column->name) == 0)
            return imk_error_set(error, IMK_ERROR_COLUMN, column->name,
                                 "two columns have this name",
                                 "leave one of them out, with --map or --columns");
    if (!(column->unit.scale > 0.0 && column->unit.scale <= DBL_MAX) ||
        !(column->unit.offset - column->unit.offset == 0.0) ||
        strpbrk(column->unit.text, ",;\"#[]\t\r\n"))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, column->name, "the unit is not valid",
                             "a unit from imk_unit_parse() or imk_unit_of()");
    return IMK_OK;
}

static imk_status set_format(imki_row_format *format, size_t column_count,
                             const imk_log_column *columns, imk_log_precision precision,
                             const int *decimals, imk_error *error)
{
    if (column_count < 1 || column_count > IMK_LOG_COLUMNS_MAX)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "column_count", "", "1 to 64 columns");
    if (precision != IMK_LOG_SHORTEST && (precision != IMK_LOG_FIXED || !decimals))
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "precision", "",
                             "IMK_LOG_SHORTEST, or IMK_LOG_FIXED with decimals");
    format->column_count = column_count;
    format->precision = precision;
    for (size_t i = 0; i < column_count; i++) {
        const imk_status status = check_column(columns, i, error);
        if (status != IMK_OK)
            return status;
        if (precision == IMK_LOG_FIXED && (decimals[i] < 0 || decimals[i] > 17))
            return imk_error_set(error, IMK_ERROR_ARGUMENT, columns[i].name,
                                 "the number of decimals is not valid", "0 to 17 decimals");
        imki_column_format_set(&format->column[i], columns[i].unit.scale, columns[i].unit.offset,
                               decimals ? decimals[i] : 0);
        format->column[i].label = columns[i].label;
    }
    return IMK_OK;
}

/* Numbers that stand for texts which the file does not hold would be taken for values. */
static imk_status check_labels(const imki_log_output *log, const char *path, imk_error *error)
{
    bool keep[IMK_LOG_COLUMNS_MAX];
    const char *label = NULL;
    char expected[160];
    for (size_t i = 0; i < log->rows.column_count; i++) {
        keep[i] = !log->column[i].label;
        label = label || keep[i] ? label : log->column[i].name;
    }
    if (!label)
        return IMK_OK;
    imki_log_select_text(log, path, keep, sizeof expected, expected);
    return imk_error_set(error, IMK_ERROR_COLUMN, label,
                         "the column holds texts, and this format is written with numbers only",
                         expected[0] ? expected : "a name that ends in .csv");
}

static imk_status open_files(imk_log_writer *writer, const char *path, imk_error *error)
{
    const imk_log_format *format;
    imk_status status = imk_log_format_written(path, &format, error);
    if (status != IMK_OK)
        return status;
    writer->codec = imki_log_codec_of(format);
    status = imk_output_file_open(path, &writer->log.file, error);
    if (status == IMK_OK && writer->codec->create)
        status = writer->codec->create(&writer->log, path, error);
    if (status == IMK_OK && writer->codec->format != imki_log_format_text)
        status = check_labels(&writer->log, path, error);
    return status;
}

imk_status imk_log_create(const char *path, size_t column_count, const imk_log_column *columns,
                          imk_log_precision precision, const int *decimals, uint64_t row_count,
                          imk_log_writer **writer, imk_error *error)
{
    imk_log_writer *made = calloc(1, sizeof *made);
    if (!made)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    imk_status status =
        set_format(&made->log.rows, column_count, columns, precision, decimals, error);
    if (status == IMK_OK) {
        memcpy(made->log.column, columns, column_count * sizeof *columns);
        made->log.announced = row_count;
        status = open_files(made, path, error);
    }
    if (status != IMK_OK) {
        imk_log_abandon(made);
        return status;
    }
    *writer = made;
    return IMK_OK;
}

imk_status imk_log_comment(imk_log_writer *writer, const char *text)
{
    if (writer->begun)
        return IMK_ERROR_ARGUMENT;
    if (writer->codec->comment)
        writer->codec->comment(&writer->log, text);
    return IMK_OK;
}

void imk_log_write_origin(imk_log_writer *writer, int64_t nanoseconds)
{
    const imk_unit nanosecond = imk_unit_of("ns");
    writer->log.origin = nanoseconds;
    for (size_t i = 0; i < writer->log.rows.column_count; i++)
        if (writer->log.column[i].quantity == IMK_QUANTITY_TIME &&
            writer->log.column[i].unit.scale == nanosecond.scale && nanoseconds != 0) {
            writer->log.rows.column[i].origin = nanoseconds;
            writer->log.rows.has_origin = true;
        }
}

void imk_log_write_labels(imk_log_writer *writer, imk_log_label_lookup lookup, void *context)
{
    bool any = false;
    for (size_t i = 0; i < writer->log.rows.column_count; i++)
        any = any || writer->log.rows.column[i].label;
    writer->log.rows.label = any ? lookup : NULL;
    writer->log.rows.label_context = context;
}

/* What stands before the rows, once. */
static void begin(imk_log_writer *writer)
{
    if (!writer->begun && writer->codec->begin)
        writer->codec->begin(&writer->log);
    writer->begun = true;
}

static void write_wave(imk_log_writer *writer, wave *done)
{
    for (size_t i = 0; i < done->count; i++) {
        if (done->block[i].failed)
            writer->status = IMK_ERROR_MEMORY;
        const imki_log_bytes *block = &done->block[i];
        if (writer->status == IMK_OK)
            writer->status =
                writer->codec->write
                    ? writer->codec->write(&writer->log, block->bytes, block->size, done->rows[i])
                    : imk_output_file_write(writer->log.file, block->bytes, block->size);
    }
    done->count = 0;
}

/* One wave: item 0 writes the previous one, the others format a block each. */
typedef struct job {
    imk_log_writer *writer;
    const double *const *columns;
    size_t first, rows, block_rows; /* rows of the wave */
} job;

static void work(void *context, size_t item)
{
    const job *j = context;
    imk_log_writer *writer = j->writer;
    if (item == 0) {
        write_wave(writer, &writer->waves[!writer->filling]);
        return;
    }
    const size_t begin_row = (item - 1) * j->block_rows;
    const size_t left = j->rows - begin_row, rows = left < j->block_rows ? left : j->block_rows;
    /* In a variable of this thread's own: neighbouring blocks share cache lines. */
    imki_log_bytes *block = &writer->waves[writer->filling].block[item - 1], own = *block;
    own.size = 0;
    writer->codec->format(&writer->log.rows, j->columns, j->first + begin_row, rows, &own);
    writer->waves[writer->filling].rows[item - 1] = rows;
    *block = own;
}

static int is_beyond(double value, double most)
{
    return (fabs(value) > most) & (fabs(value) <= DBL_MAX);
}

/* A number that is finite must be so in the unit written, too. */
static void check_units(imk_log_writer *writer, size_t rows, const double *const *columns)
{
    for (size_t c = 0; c < writer->log.rows.column_count && writer->status == IMK_OK; c++) {
        const double scale = writer->log.column[c].unit.scale;
        const double most = DBL_MAX * scale * (1.0 - 1e-12); /* rounding left aside */
        if (scale >= 1.0 || writer->log.column[c].label)
            continue;
        int any = 0; /* without a branch, so that several rows are compared at a time */
        for (size_t row = 0; row < rows; row++)
            any |= is_beyond(columns[c][row], most);
        for (size_t row = 0; row < rows && any && writer->status == IMK_OK; row++)
            if (is_beyond(columns[c][row], most)) {
                writer->status = IMK_ERROR_NOT_FINITE;
                writer->beyond_column = c;
                writer->beyond_row = writer->log.written + row + 1;
            }
    }
}

static imk_status refuse_unit(const imk_log_writer *writer, imk_error *error)
{
    const imk_log_column *column = &writer->log.column[writer->beyond_column];
    char field[96], found[128];
    snprintf(field, sizeof field, "%s, row %llu", column->name,
             (unsigned long long)writer->beyond_row);
    snprintf(found, sizeof found, "\"%s\" is too small a unit: the number would be infinite",
             column->unit.text);
    return imk_error_set(error, IMK_ERROR_NOT_FINITE, field, found, "choose a larger unit");
}

imk_status imk_log_write(imk_log_writer *writer, size_t rows, const double *const *columns,
                         const imk_executor *executor)
{
    const size_t cells = writer->log.rows.column_count;
    const size_t block_rows = BLOCK_CELLS / cells;
    if (rows <= PARALLEL_CELLS / cells)
        executor = NULL;
    const size_t threads = executor && executor->threads > 1 ? executor->threads : 0;
    const size_t required = 1 + threads * BLOCKS_PER_THREAD;
    const size_t blocks_max = required < BLOCKS_MAX ? required : BLOCKS_MAX;
    begin(writer);
    check_units(writer, rows, columns);
    for (size_t first = 0; first < rows && writer->status == IMK_OK;) {
        size_t blocks = (rows - first + block_rows - 1) / block_rows;
        blocks = blocks < blocks_max ? blocks : blocks_max;
        const size_t left = rows - first;
        job j = {writer, columns, first, blocks * block_rows, block_rows};
        j.rows = j.rows < left ? j.rows : left;
        imk_execute(executor, blocks + 1, work, &j);
        writer->waves[writer->filling].count = blocks;
        writer->filling = !writer->filling;
        first += j.rows;
        writer->log.written += j.rows;
    }
    return writer->status;
}

static void release(imk_log_writer *writer)
{
    for (int i = 0; i < 2; i++)
        for (size_t block = 0; block < BLOCKS_MAX; block++)
            free(writer->waves[i].block[block].bytes);
    free(writer);
}

imk_status imk_log_commit(imk_log_writer *writer, imk_error *error)
{
    begin(writer);
    write_wave(writer, &writer->waves[!writer->filling]);
    imk_status status = IMK_OK;
    if (writer->status == IMK_ERROR_MEMORY)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "", "", "");
    else if (writer->status == IMK_ERROR_NOT_FINITE)
        status = refuse_unit(writer, error);
    else if (writer->codec->end)
        status = writer->codec->end(&writer->log, error);
    /* Both files are made ready before the first appears, so that the second does not fail. A
     * failing prepare or commit has freed its file. */
    if (status == IMK_OK && (status = imki_output_file_prepare(writer->log.file, error)) != IMK_OK)
        writer->log.file = NULL;
    if (status == IMK_OK && writer->log.companion) {
        status = imk_output_file_commit(writer->log.companion, error);
        writer->log.companion = NULL;
    }
    if (status == IMK_OK) {
        status = imk_output_file_commit(writer->log.file, error);
        writer->log.file = NULL;
    }
    imk_log_abandon(writer);
    return status;
}

void imk_log_abandon(imk_log_writer *writer)
{
    if (!writer)
        return;
    imk_output_file_abandon(writer->log.file);
    imk_output_file_abandon(writer->log.companion);
    if (writer->codec && writer->codec->discard)
        writer->codec->discard(&writer->log);
    else
        free(writer->log.state);
    release(writer);
}
