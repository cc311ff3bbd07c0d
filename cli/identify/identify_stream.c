/* SPDX-License-Identifier: Apache-2.0 */
/* Identifies a long log without ever holding it: a block of rows is read while the channels of the
 * block before are gathered, each on a thread. Rows are placed on the grid of samples by the rules
 * of log_grid.c, a block at a time; under another policy than that one, a log with anything missing
 * is loaded. */
#include "identify_parts.h"

#include "shell/progress.h"

#include "imukit/identify_record.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROWS = 1 << 17,      /* of a block */
    EMPTY = 4096,        /* missing samples handed over at a time */
    ROW_BYTES_LEAST = 4, /* of a file, compressed or not */
};

/* Rows first … first + count - 1 of a block, with `missing` samples before them. */
typedef struct piece {
    size_t missing, first, count;
} piece;

typedef struct row_block {
    double *memory;
    double *column[IMK_LOG_COLUMNS_MAX]; /* NULL: not wanted */
    size_t rows;
    imk_status status; /* of reading it */
    imk_error error;
} row_block;

typedef struct log_stream {
    identification *all;
    imk_log_reader *reader;
    row_block block[2];
    size_t current; /* the block being gathered; the other is being read */
    int time_column;
    double last_time, first_time; /* [s], of rows taken */
    size_t samples;               /* on the grid so far */
    size_t rows;                  /* of the log so far */
    size_t first_not_finite;      /* from 1 */
    bool uneven;                  /* this needs the policies for whole logs */
    size_t piece_count;
    piece pieces[ROWS];
    bool dirty[IMK_LOG_COLUMNS_MAX]; /* the block has missing values of this channel */
    void *memory[IMK_LOG_COLUMNS_MAX];
    imk_identify_record *record[IMK_LOG_COLUMNS_MAX];
    imk_status status[IMK_LOG_COLUMNS_MAX];
    imk_error error[IMK_LOG_COLUMNS_MAX];
} log_stream;

static void make_block(const log_stream *s, row_block *block)
{
    const log_channels *channels = &s->all->channels;
    const size_t columns = channels->count + (s->time_column >= 0 ? 1 : 0);
    block->memory = command_memory(NULL, columns * ROWS * sizeof(double));
    double *place = block->memory;
    for (size_t c = 0; c < channels->count; c++, place += ROWS)
        block->column[channels->column[c]] = place;
    if (s->time_column >= 0)
        block->column[s->time_column] = place;
}

static void read_block(log_stream *s, row_block *block)
{
    block->rows = 0;
    block->status =
        imk_log_read(s->reader, ROWS, (double *const *)block->column, &block->rows, &block->error);
}

/* Is this a log of more rows than are identified as a whole? Judged by the size of the file and of
 * the rows of its first block. */
static bool is_long(const log_stream *s, const row_block *first)
{
    uint64_t done, size;
    imk_log_progress(s->reader, &done, &size);
    return first->status == IMK_OK && first->rows == ROWS && done > 0 && size > done &&
           (double)first->rows * ((double)size / (double)done) > IMK_IDENTIFY_RECORD_ADVISED;
}

/* Steps from the last row taken to a time; 0 where the row is to be left out. */
static size_t steps_to(log_stream *s, double time)
{
    log_channels *channels = &s->all->channels;
    if (!isfinite(time)) {
        channels->not_finite++;
        return 0;
    }
    const size_t steps =
        s->samples == 0 ? 1 : imk_step_intervals(time - s->last_time, channels->dt);
    channels->unordered += steps == 0;
    return steps;
}

/* Cut the block where samples are missing or rows are left out. */
static void cut_block(log_stream *s, const row_block *block)
{
    log_channels *channels = &s->all->channels;
    const double *time = s->time_column >= 0 ? block->column[s->time_column] : NULL;
    piece *last = NULL;
    s->piece_count = 0;
    for (size_t row = 0; row < block->rows; row++) {
        const size_t steps = time ? steps_to(s, time[row]) : 1;
        if (steps > LOG_EMPTY_MOST * (s->rows + block->rows) + 1000)
            s->uneven = true; /* a jump of the clock */
        if (s->uneven)
            return;
        if (steps == 0)
            continue;
        if (!last || steps > 1 || last->first + last->count != row) {
            last = &s->pieces[s->piece_count++];
            *last = (piece){steps - 1, row, 0};
            channels->missing += steps - 1;
            channels->holes += steps > 1;
            channels->longest_hole =
                steps - 1 > channels->longest_hole ? steps - 1 : channels->longest_hole;
        }
        if (time && s->samples == 0)
            s->first_time = time[row];
        s->last_time = time ? time[row] : 0;
        last->count++;
        s->samples += steps;
    }
}

static bool all_readings(size_t count, const double *values)
{
    bool all = true;
    for (size_t i = 0; i < count; i++)
        all &= fabs(values[i]) <= IMK_READING_MAX;
    return all;
}

static imk_status add_piece(imk_identify_record *record, const piece *p, const double *data,
                            imk_error *error)
{
    double empty[EMPTY];
    imk_status status = IMK_OK;
    for (size_t i = 0; i < EMPTY && i < p->missing; i++)
        empty[i] = (double)NAN;
    for (size_t done = 0; done < p->missing && status == IMK_OK; done += EMPTY)
        status = imk_identify_record_add(
            record, p->missing - done < EMPTY ? p->missing - done : EMPTY, empty, error);
    return status == IMK_OK ? imk_identify_record_add(record, p->count, data + p->first, error)
                            : status;
}

/* Item 0 reads the next block, the others each take a channel of this one. */
static void pass_block(void *context, size_t item)
{
    log_stream *s = context;
    if (item == 0) {
        read_block(s, &s->block[1 - s->current]);
        return;
    }
    const size_t channel = item - 1;
    const row_block *block = &s->block[s->current];
    double *data = block->column[s->all->channels.column[channel]];
    s->dirty[channel] = !all_readings(block->rows, data);
    for (size_t row = 0; row < block->rows && s->dirty[channel]; row++)
        data[row] = fabs(data[row]) <= IMK_READING_MAX ? data[row] : (double)NAN;
    for (size_t p = 0; p < s->piece_count && s->status[channel] == IMK_OK; p++)
        s->status[channel] = add_piece(s->record[channel], &s->pieces[p], data, &s->error[channel]);
}

/* Rows of this block with a value missing in some channel. */
static void count_not_finite(log_stream *s)
{
    log_channels *channels = &s->all->channels;
    const row_block *block = &s->block[s->current];
    bool any = false;
    for (size_t c = 0; c < channels->count; c++)
        any = any || s->dirty[c];
    for (size_t row = 0; row < block->rows && any; row++) {
        bool finite = true;
        for (size_t c = 0; c < channels->count; c++)
            finite = finite && isfinite(block->column[channels->column[c]][row]);
        if (!finite && channels->not_finite++ == 0)
            s->first_not_finite = s->rows + row + 1;
    }
}

/* Is the block as the policy wants it? */
static bool is_even(const log_stream *s)
{
    const log_channels *channels = &s->all->channels;
    for (size_t c = 0; c < channels->count; c++)
        if (s->status[c] != IMK_OK)
            return false;
    return s->all->options->log.gaps == GAPS_KEEP ||
           channels->missing + channels->unordered + channels->not_finite == 0;
}

static bool begin_records(log_stream *s)
{
    const row_block *first = &s->block[0];
    uint64_t done, size;
    imk_log_progress(s->reader, &done, &size);
    const double expected = (double)first->rows * ((double)size / (double)done);
    for (size_t c = 0; c < s->all->channels.count; c++) {
        const size_t bytes = imk_identify_record_size((size_t)expected);
        s->memory[c] = command_memory(NULL, bytes);
        if (imk_identify_record_begin((size_t)expected, s->memory[c], bytes, &s->record[c], NULL) !=
            IMK_OK)
            return false;
    }
    return true;
}

/* Block by block to the end of the log; stops at what only a whole log can be asked about. */
static imk_status pass_log(log_stream *s, const char *path, const imk_executor *executor,
                           imk_error *error)
{
    char label[120];
    snprintf(label, sizeof label, "reading %.100s", path);
    progress shown = progress_begin(label, "B", 1);
    for (s->current = 0; s->block[s->current].rows > 0 && !s->uneven; s->current = 1 - s->current) {
        cut_block(s, &s->block[s->current]);
        imk_execute(executor, 1 + s->all->channels.count, pass_block, s);
        count_not_finite(s);
        s->rows += s->block[s->current].rows;
        s->uneven = s->uneven || !is_even(s);
        uint64_t done, size;
        imk_log_progress(s->reader, &done, &size);
        progress_update(&shown, done, size);
    }
    progress_end(&shown);
    const row_block *last = &s->block[s->current];
    if (!s->uneven && last->status != IMK_OK) {
        *error = last->error;
        return last->status;
    }
    return IMK_OK;
}

static imk_status take_curve(const imk_identify_record *record, double dt, allan_curve *curve)
{
    size_t count;
    const imk_allan_point *points = imk_identify_record_curve(record, &count);
    *curve = (allan_curve){.count = count};
    curve->point = malloc(count * sizeof *curve->point);
    curve->tau = malloc(4 * count * sizeof *curve->tau);
    if (!curve->point || !curve->tau) {
        allan_curve_free(curve);
        return IMK_ERROR_MEMORY;
    }
    curve->deviation = curve->tau + count;
    curve->lower = curve->deviation + count;
    curve->upper = curve->lower + count;
    for (size_t i = 0; i < count; i++) {
        curve->point[i] = points[i];
        curve->tau[i] = dt * (double)points[i].m;
        curve->deviation[i] = points[i].deviation;
        curve->lower[i] = points[i].lower;
        curve->upper[i] = points[i].upper;
    }
    return IMK_OK;
}

static void finish_channel(void *context, size_t channel)
{
    log_stream *s = context;
    imk_identify_record *record = s->record[channel];
    imk_error *error = &s->error[channel];
    const size_t size = imk_identify_record_workspace_size(record);
    void *workspace = malloc(size);
    imk_identify_settings settings;
    imk_status status = IMK_ERROR_MEMORY;
    imk_error_set(error, status, NULL, NULL, NULL);
    if (workspace && identify_settings_for(s->all, channel, &settings))
        status = imk_identify_record_finish(record, &settings, &s->all->result[channel], workspace,
                                            size, error);
    free(workspace);
    if (status == IMK_OK)
        status = take_curve(record, settings.dt, &s->all->curve[channel]);
    s->status[channel] = status;
}

/* @param taken  false when a channel has so much missing that it is to be seen as a whole */
static int finish(log_stream *s, const imk_executor *executor, bool *taken)
{
    identification *i = s->all;
    log_channels *channels = &i->channels;
    channels->rows = s->samples;
    channels->log.rows = s->rows;
    channels->log.findings = imk_log_findings_get(s->reader);
    if (!(i->options->log.rate > 0) && s->time_column >= 0)
        channels->dt = (s->last_time - s->first_time) / (double)(s->samples - 1);
    const int code = s->time_column >= 0 ? log_grid_jitter(i->path, channels) : -1;
    if (code >= 0)
        return code;
    imk_execute(executor, channels->count, finish_channel, s);
    for (size_t c = 0; c < channels->count; c++)
        *taken = *taken && s->status[c] != IMK_ERROR_GAP;
    if (!*taken)
        return -1;
    log_grid_tell(channels, s->first_not_finite);
    for (size_t c = 0; c < channels->count; c++)
        if (s->status[c] != IMK_OK)
            return identify_explain(i, c, s->status[c], &s->error[c]);
    return -1;
}

/* The log opened and its channels chosen; false where it is short. */
static bool begin(log_stream *s)
{
    identification *i = s->all;
    log_channels *channels = &i->channels;
    uint64_t done, size;
    imk_log_progress(s->reader, &done, &size);
    if (size < (uint64_t)IMK_IDENTIFY_RECORD_ADVISED * ROW_BYTES_LEAST)
        return false;
    channels->log.column_count = imk_log_column_count(s->reader);
    for (size_t c = 0; c < channels->log.column_count; c++)
        channels->log.column[c] = *imk_log_column_get(s->reader, c);
    log_choose_channels(channels);
    s->time_column = imk_log_column_find(s->reader, IMK_QUANTITY_TIME, -1);
    if (channels->count == 0)
        return false;
    make_block(s, &s->block[0]);
    make_block(s, &s->block[1]);
    read_block(s, &s->block[0]);
    if (s->block[0].rows < ROWS)
        read_block(s, &s->block[1]); /* says why it ended there */
    const double interval = imk_log_findings_get(s->reader).interval;
    channels->dt = i->options->log.rate > 0 ? 1 / i->options->log.rate : interval;
    return is_long(s, &s->block[0]) && channels->dt > 0 && begin_records(s);
}

/* What is wrong with the log itself, loading it tells best. What the system refuses may be given
 * when asked again, and then a long log would be treated as a short one. */
static bool is_of_system(imk_status status)
{
    return status == IMK_ERROR_OPEN || status == IMK_ERROR_READ || status == IMK_ERROR_MEMORY;
}

/* Open the log and read its first block. @return -1, or the exit code
 * @param long_log  false where it is to be loaded */
static int start(log_stream *s, const char *path, bool *long_log)
{
    imk_log_settings settings = log_input_settings(&s->all->options->log);
    settings.reopened = true; /* for who loads it */
    imk_error error;
    const imk_status status = imk_log_open(path, &settings, &s->reader, &error);
    *long_log = status == IMK_OK && begin(s);
    if (is_of_system(status))
        return command_log_error(&error, path);
    for (int b = 0; b < 2; b++)
        if (is_of_system(s->block[b].status))
            return command_log_error(&s->block[b].error, path);
    return -1;
}

int identify_stream(identification *i, const imk_executor *executor, bool *taken)
{
    log_stream *s = calloc(1, sizeof *s);
    *taken = false;
    if (!s)
        return command_failed("memory is exhausted");
    s->all = i;
    bool long_log;
    int code = start(s, i->path, &long_log);
    if (code < 0 && long_log) {
        imk_error error;
        const imk_status status = pass_log(s, i->path, executor, &error);
        *taken = !s->uneven;
        if (status != IMK_OK)
            code = command_log_error(&error, i->path);
        else if (*taken)
            code = finish(s, executor, taken);
    }
    if (!*taken) {
        for (size_t c = 0; c < i->channels.count; c++)
            allan_curve_free(&i->curve[c]);
        for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) {
            free(i->summary[c]);
            i->summary[c] = NULL;
        }
        i->channels = (log_channels){0};
    }
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++)
        free(s->memory[c]);
    free(s->block[0].memory);
    free(s->block[1].memory);
    imk_log_close(s->reader);
    free(s);
    return code;
}
