/* SPDX-License-Identifier: Apache-2.0 */
/* Identifies a long record without ever holding it: a block of rows is read while the channels of
 * the block before are gathered, each on a thread. Rows are placed by record_grid.c, one at a time;
 * under another policy than IMK_GAPS_KEEP, a record with anything missing is loaded. */
#include "identify_log_internal.h"
#include "log_coherence_internal.h"
#include "long_passage_internal.h"

#include "jobs/allan/allan_curve_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"
#include "jobs/record/record_repeats_internal.h"
#include "jobs/record/record_stamps_internal.h"

#include "imukit/samples.h"

#include <math.h>

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
    double *column[IMK_LOG_COLUMNS_MAX]; /* NULL: not wanted */
    size_t rows;
    imk_status status; /* of reading it */
    imk_error error;
} row_block;

typedef struct long_record {
    imk_identify_log *log;
    const imk_record_source *source;
    const imk_job *job;
    imki_arena arena; /* blocks and records */
    row_block block[2];
    size_t current; /* the block being gathered; the other is being read */
    int time_column;
    imki_grid grid;
    size_t rows;             /* of the record so far */
    size_t first_not_finite; /* from 1 */
    bool uneven;             /* this needs the policies for whole records */
    bool again;              /* the stamps proved not to be sample times: settle them first */
    imki_stamps stamps;      /* their times, when settled */
    imk_log_findings settled;
    imki_repeats repeats;
    imki_coherence coherence;
    size_t piece_count;
    piece *pieces;                   /* ROWS of them, for a record that is long */
    bool dirty[IMK_LOG_COLUMNS_MAX]; /* the block has missing values of this channel */
    int temperature_column;          /* -1: none */
    imki_passage passage[IMK_LOG_COLUMNS_MAX];
    imk_status status[IMK_LOG_COLUMNS_MAX];
    imk_error error[IMK_LOG_COLUMNS_MAX];
} long_record;

/* @return false: memory is exhausted */
static bool make_block(long_record *s, row_block *block)
{
    const imk_even_record *record = &s->log->record;
    const size_t columns =
        record->count + (s->time_column >= 0 ? 1 : 0) + (s->temperature_column >= 0 ? 1 : 0);
    double *place = imki_arena_room(&s->arena, columns * ROWS * sizeof *place);
    if (!place)
        return false;
    for (size_t c = 0; c < record->count; c++, place += ROWS)
        block->column[record->column[c]] = place;
    if (s->time_column >= 0)
        block->column[s->time_column] = place;
    if (s->temperature_column >= 0)
        block->column[s->temperature_column] = place + (s->time_column >= 0 ? ROWS : 0);
    return true;
}

static void start_counts(long_record *s)
{
    const imk_even_record *record = &s->log->record;
    imki_repeats_start(&s->repeats, record->count, record->column, record->log.column);
    imki_coherence_start(&s->coherence, record->count, record->column, record->log.column);
}

static void read_block(long_record *s, row_block *block)
{
    block->rows = 0;
    block->status = s->source->read(s->source->context, ROWS, (double *const *)block->column,
                                    &block->rows, &block->error);
    if (block->status != IMK_OK)
        return;
    imki_repeats_add(&s->repeats, block->rows, block->column);
    imki_coherence_add(&s->coherence, block->rows, block->column);
}

/* How many rows there will be, by the size of the source and of the rows of the first block. */
static double expected_rows(const long_record *s)
{
    uint64_t done, size;
    s->source->progress(s->source->context, &done, &size);
    return done > 0 && size > done ? (double)s->block[0].rows * ((double)size / (double)done) : 0;
}

/* Is this a record of more rows than are identified as a whole? */
static bool is_long(const long_record *s)
{
    const row_block *first = &s->block[0];
    return first->status == IMK_OK && first->rows == ROWS &&
           expected_rows(s) > IMK_IDENTIFY_RECORD_ADVISED;
}

/* Times of the rows of the block; NULL: there are none. */
static const double *times_of(const long_record *s, const row_block *block)
{
    if (s->time_column < 0)
        return NULL;
    return s->stamps.time ? s->stamps.time + s->rows : block->column[s->time_column];
}

static void drop_impossible(size_t count, double *values)
{
    for (size_t i = 0; i < count; i++)
        values[i] = fabs(values[i]) <= IMK_READING_MAX ? values[i] : (double)NAN;
}

/* Cut the block where samples are missing or rows are left out. */
static void cut_block(long_record *s, const row_block *block)
{
    imk_even_record *record = &s->log->record;
    const double *time = times_of(s, block);
    piece *last = NULL;
    if (s->temperature_column >= 0)
        drop_impossible(block->rows, block->column[s->temperature_column]);
    s->piece_count = 0;
    s->grid.rows = s->rows + block->rows;
    for (size_t row = 0; row < block->rows; row++) {
        const size_t steps = time ? imki_grid_step(&s->grid, time[row], record) : 1;
        s->uneven = s->grid.leaps;
        if (s->uneven)
            return;
        if (!time)
            s->grid.places++;
        if (steps == 0)
            continue;
        if (!last || steps > 1 || last->first + last->count != row) {
            last = &s->pieces[s->piece_count++];
            *last = (piece){steps - 1, row, 0};
        }
        last->count++;
    }
}

static bool all_readings(size_t count, const double *values)
{
    bool all = true;
    for (size_t i = 0; i < count; i++)
        all &= fabs(values[i]) <= IMK_READING_MAX;
    return all;
}

static imk_status add_piece(imki_passage *passage, const piece *p, const double *data,
                            const double *temperature, imk_error *error)
{
    double empty[EMPTY];
    for (size_t i = 0; i < EMPTY && i < p->missing; i++)
        empty[i] = (double)NAN;
    for (size_t done = 0; done < p->missing; done += EMPTY)
        imki_passage_add(passage, p->missing - done < EMPTY ? p->missing - done : EMPTY, empty,
                         temperature ? empty : NULL);
    imki_passage_add(passage, p->count, data + p->first,
                     temperature ? temperature + p->first : NULL);
    if (passage->status != IMK_OK && error)
        *error = passage->error;
    return passage->status;
}

/* Item 0 reads the next block, the others each take a channel of this one. */
static void pass_block(void *context, size_t item)
{
    long_record *s = context;
    if (item == 0) {
        read_block(s, &s->block[1 - s->current]);
        return;
    }
    const size_t channel = item - 1;
    const row_block *block = &s->block[s->current];
    double *data = block->column[s->log->record.column[channel]];
    const double *temperature =
        s->temperature_column >= 0 ? block->column[s->temperature_column] : NULL;
    s->dirty[channel] = !all_readings(block->rows, data);
    if (s->dirty[channel])
        drop_impossible(block->rows, data);
    for (size_t p = 0; p < s->piece_count && s->status[channel] == IMK_OK; p++)
        s->status[channel] =
            add_piece(&s->passage[channel], &s->pieces[p], data, temperature, &s->error[channel]);
}

/* Rows of this block whose time, or a value of some channel, is missing. */
static void count_not_finite(long_record *s)
{
    imk_even_record *record = &s->log->record;
    const row_block *block = &s->block[s->current];
    const double *time = times_of(s, block);
    bool any = time && !all_readings(block->rows, time);
    for (size_t c = 0; c < record->count; c++)
        any = any || s->dirty[c];
    for (size_t row = 0; row < block->rows && any; row++) {
        bool finite = !time || isfinite(time[row]);
        for (size_t c = 0; c < record->count; c++)
            finite = finite && isfinite(block->column[record->column[c]][row]);
        if (!finite && record->not_finite++ == 0)
            s->first_not_finite = s->rows + row + 1;
    }
}

/* Is the block as the policy wants it? */
static bool is_even(const long_record *s)
{
    const imk_even_record *record = &s->log->record;
    for (size_t c = 0; c < record->count; c++)
        if (s->status[c] != IMK_OK)
            return false;
    return s->log->settings.gaps == IMK_GAPS_KEEP ||
           record->missing + record->unordered + record->not_finite == 0;
}

/* @return false where memory is exhausted, or the record asks for more than there is */
static bool begin_records(long_record *s)
{
    const size_t expected = (size_t)expected_rows(s);
    const imk_screen_settings screening = imki_screen_settings(s->log);
    s->pieces = imki_arena_room(&s->arena, ROWS * sizeof *s->pieces);
    for (size_t c = 0; s->pieces && c < s->log->record.count; c++)
        if (!imki_passage_begin(&s->passage[c], &screening, s->log->settings.take_out, expected,
                                &s->arena, &s->job->allocator))
            return false;
    return s->pieces != NULL;
}

/* Block by block to the end; stops at what only a whole record can be asked about. */
static imk_status pass_record(long_record *s, imk_error *error)
{
    imk_status status = IMK_OK;
    for (s->current = 0; status == IMK_OK && s->block[s->current].rows > 0 && !s->uneven;
         s->current = 1 - s->current) {
        uint64_t done, size;
        cut_block(s, &s->block[s->current]);
        imk_execute(s->job->executor, 1 + s->log->record.count, pass_block, s);
        count_not_finite(s);
        s->rows += s->block[s->current].rows;
        s->uneven = s->uneven || !is_even(s);
        s->source->progress(s->source->context, &done, &size);
        status = imki_job_progress(s->job, "reading", "B", done, size, error);
    }
    const row_block *last = &s->block[s->current];
    if (status == IMK_OK && !s->uneven && last->status != IMK_OK) {
        if (error)
            *error = last->error;
        return last->status;
    }
    return status;
}

static void finish_channel(void *context, size_t channel)
{
    long_record *s = context;
    const imk_allocator *allocator = &s->job->allocator;
    imki_passage *passage = &s->passage[channel];
    imk_error *error = &s->error[channel];
    imk_identify_record *record = NULL;
    imk_status status =
        imki_passage_finish(passage, s->log->record.dt, &record, &s->log->screen[channel], error);
    imk_identify_settings settings;
    const size_t size = record ? imk_identify_record_workspace_size(record) : 0;
    void *workspace = status == IMK_OK ? imki_resize(allocator, NULL, size) : NULL;
    if (status == IMK_OK &&
        !(workspace && imki_identify_settings(s->log, channel, allocator, &settings)))
        status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (status == IMK_OK)
        status = imk_identify_record_finish(record, &settings, &s->log->result[channel], workspace,
                                            size, error);
    imki_resize(allocator, workspace, 0);
    if (status == IMK_OK)
        status = imki_identify_changes(s->log, channel, imk_identify_record_map(record), allocator,
                                       error);
    if (status == IMK_OK) {
        size_t count;
        const imk_allan_point *points = imk_identify_record_curve(record, &count);
        status = imki_allan_curve_of(count, points, s->log->record.dt, allocator,
                                     &s->log->curve[channel]);
    }
    imki_passage_end(passage);
    s->status[channel] = status;
}

/* @param taken  false when a channel has so much missing that it is to be seen as a whole */
static imk_status finish(long_record *s, bool *taken, imk_error *error)
{
    imk_identify_log *log = s->log;
    imk_even_record *record = &log->record;
    const bool times = s->time_column >= 0;
    record->rows = s->grid.places;
    record->log.rows = s->rows;
    record->log.findings = s->stamps.time ? s->settled : s->source->findings(s->source->context);
    if (!s->stamps.time && times) {
        s->again = imki_stamps_uneven(s->source->rate, &record->log.findings);
        *taken = !s->again;
        if (s->again)
            return IMK_OK;
        imki_tell_steps(&record->log.findings, &log->findings);
        imki_tell_rate(s->source->rate, record->log.findings.mean_step, &log->findings);
    }
    if (!(s->source->rate > 0) && times)
        record->dt = (s->grid.last_time - s->grid.first_time) / (double)(s->grid.places - 1);
    const imk_status status = times ? imki_grid_jitter(record, &log->findings, error) : IMK_OK;
    if (status != IMK_OK)
        return status;
    imk_execute(s->job->executor, record->count, finish_channel, s);
    for (size_t c = 0; c < record->count; c++)
        *taken = *taken && s->status[c] != IMK_ERROR_GAP;
    if (!*taken)
        return IMK_OK;
    imki_grid_tell(record, s->first_not_finite, &log->findings);
    if (record->log.findings.doubled == 0)
        imki_repeats_tell(&s->repeats, record->log.column, record->dt, &log->findings);
    imki_coherence_tell(&s->coherence, record->log.column, &log->findings);
    imki_tell_damage(s->source, &log->findings);
    imki_even_record_unused(record, &log->findings);
    for (size_t c = 0; c < record->count; c++)
        if (s->status[c] != IMK_OK)
            return imki_identify_explain(log, c, s->status[c], &s->error[c], error);
    return IMK_OK;
}

/* The channels chosen, the first block read; false where the record is short, or nothing was read
 * yet and `touched` stays false. */
static bool begin(long_record *s, bool *touched)
{
    imk_even_record *record = &s->log->record;
    uint64_t done, size;
    s->source->progress(s->source->context, &done, &size);
    if (size < (uint64_t)IMK_IDENTIFY_RECORD_ADVISED * ROW_BYTES_LEAST)
        return false;
    record->log.column_count = s->source->column_count;
    for (size_t c = 0; c < record->log.column_count; c++)
        record->log.column[c] = s->source->columns[c];
    imk_even_record_choose(record);
    s->time_column = imk_record_find(s->source, IMK_QUANTITY_TIME, -1);
    s->temperature_column = imk_record_find(s->source, IMK_QUANTITY_TEMPERATURE, -1);
    if (record->count == 0)
        return false;
    if (!make_block(s, &s->block[0]) || !make_block(s, &s->block[1])) {
        s->block[0].status = imk_error_set(&s->block[0].error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        return false;
    }
    *touched = true;
    start_counts(s);
    read_block(s, &s->block[0]);
    if (s->block[0].rows < ROWS)
        read_block(s, &s->block[1]); /* says why it ended there */
    s->settled = s->source->findings(s->source->context);
    s->again = s->again || (s->time_column >= 0 && is_long(s) &&
                            imki_stamps_uneven(s->source->rate, &s->settled));
    return is_long(s);
}

/* Stamps that are no sample times are replaced before the rows are read. */
static imk_status settle(long_record *s, imk_error *error)
{
    imk_status status = imki_stamps_of_source(s->source, s->job, &s->stamps, error);
    if (status == IMK_OK)
        status =
            imki_stamps_settle(&s->stamps, s->source->rate, &s->settled, &s->log->findings, error);
    start_counts(s);
    if (status == IMK_OK)
        read_block(s, &s->block[0]);
    return status;
}

/* @return false: the record is to be loaded */
static bool begin_grid(long_record *s)
{
    imk_even_record *record = &s->log->record;
    record->dt = s->source->rate > 0 ? 1 / s->source->rate : s->settled.interval;
    s->grid.interval = record->dt;
    return record->dt > 0 && begin_records(s);
}

/* What is wrong with the record itself, loading it tells best. What the system refuses may be given
 * when asked again, and then a long record would be treated as a short one. */
static imk_status refused_by_system(const long_record *s, imk_error *error)
{
    for (int b = 0; b < 2; b++) {
        const row_block *block = &s->block[b];
        if (block->status == IMK_ERROR_OPEN || block->status == IMK_ERROR_READ ||
            block->status == IMK_ERROR_MEMORY) {
            if (error)
                *error = block->error;
            return block->status;
        }
    }
    return s->arena.failed ? imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL) : IMK_OK;
}

/* As if nothing had been read. */
static imk_status forget(long_record *s, bool touched, imk_error *error)
{
    imk_identify_log *log = s->log;
    const imk_allocator *allocator = &s->job->allocator;
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) {
        imk_allan_curve_free(&log->curve[c], allocator);
        log->summary[c] = imki_resize(allocator, log->summary[c], 0);
        log->map[c] = imki_resize(allocator, log->map[c], 0);
    }
    log->record = (imk_even_record){.count = 0};
    log->findings.count = 0;
    return touched ? s->source->rewind(s->source->context, error) : IMK_OK;
}

/* One attempt. @param again  to settle the stamps first; says when that proves necessary */
static imk_status identify_once(imk_identify_log *log, const imk_record_source *source,
                                const imk_job *job, bool *taken, bool *again, imk_error *error)
{
    imki_arena arena = {.allocator = job->allocator};
    long_record *s = imki_arena_take(&arena, sizeof *s);
    bool touched = false;
    *taken = false;
    if (!s)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    s->log = log; /* the rest is zero: three megabytes, too much for a literal on the stack */
    s->source = source;
    s->job = job;
    s->arena.allocator = job->allocator;
    s->again = *again;
    const bool long_enough = begin(s, &touched);
    imk_status status = refused_by_system(s, error);
    if (status == IMK_OK && long_enough && s->again)
        status = settle(s, error);
    s->again = false;
    const bool ready = status == IMK_OK && long_enough && begin_grid(s);
    if (status == IMK_OK)
        status = refused_by_system(s, error);
    if (status == IMK_OK && ready) {
        status = pass_record(s, error);
        *taken = !s->uneven;
        if (status == IMK_OK && *taken)
            status = finish(s, taken, error);
    }
    *again = s->again;
    if (status == IMK_OK && !*taken)
        status = forget(s, touched, error);
    imki_stamps_free(&s->stamps);
    for (size_t c = 0; c < IMK_LOG_COLUMNS_MAX; c++) /* a record that is forgotten has none */
        imki_passage_end(&s->passage[c]);
    imki_arena_free(&s->arena);
    imki_arena_free(&arena);
    return status;
}

imk_status imki_identify_long(imk_identify_log *log, const imk_record_source *source,
                              const imk_job *job, bool *taken, imk_error *error)
{
    bool again = false;
    imk_status status = identify_once(log, source, job, taken, &again, error);
    if (status == IMK_OK && again)
        status = identify_once(log, source, job, taken, &again, error);
    return status;
}
