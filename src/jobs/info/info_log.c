/* SPDX-License-Identifier: Apache-2.0 */
/* What is in a record: all of a short one; of a long one its beginning, places within, and its end.
 */
#include "info_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/even_record_internal.h"
#include "jobs/record/record_check_internal.h"

#include <math.h>
#include <string.h>

enum {
    BLOCK_ROWS = 256,
    FIRST_ROWS = 1 << 16, /* at the beginning */
    PLACE_ROWS = 1 << 13, /* at each place */
    PLACES = 12
};
/* In the measure of the source's progress, which are bytes of files. */
static const uint64_t short_record = 32u << 20; /* read as a whole */
static const uint64_t first_most = 16u << 20, place_most = 2u << 20, end_least = 1u << 20;

static const uint32_t settings_cookie = 0x494E4631; /* "INF1" */

imk_info_log_settings imk_info_log_default(void)
{
    return (imk_info_log_settings){.cookie = settings_cookie};
}

void imk_info_log_free(imk_info_log *result)
{
    if (result) {
        const imk_allocator allocator = result->allocator;
        imki_resize(&allocator, result, 0);
    }
}

typedef struct look {
    const imk_record_source *source;
    const imk_job *job;
    imk_info_log *info;
    imki_info_rows rows;
    double *column[IMK_LOG_COLUMNS_MAX];
    double *scratch, *rests;
    int time;
    uint64_t size;    /* of the record, in the measure of its progress; 0: not known */
    uint64_t reached; /* how far rows were read */
    double covered;   /* by the places, in it */
    bool over;        /* the end was met */
    bool ended;       /* rows at the end were read, behind others */
    bool overlaps;    /* the place at present begins with rows of another */
    /* Sums over the places. */
    double jitter_squares, steps, interval;
    imki_info_stamps stamps;
} look;

static uint64_t progress_of(look *l)
{
    uint64_t done = 0, size = 0;
    if (l->source->progress)
        l->source->progress(l->source->context, &done, &size);
    l->size = size;
    return done;
}

static bool take_memory(look *l, imki_arena *arena)
{
    imki_info_rows *r = &l->rows;
    for (size_t c = 0; c < l->info->channel_count; c++) {
        l->column[c] = imki_arena_room(arena, BLOCK_ROWS * sizeof(double));
        r->sample[c] = imki_arena_room(arena, IMKI_INFO_SAMPLE * sizeof(double));
    }
    r->window = imki_arena_room(arena, IMKI_INFO_WINDOWS * sizeof *r->window);
    l->scratch = imki_arena_room(arena, IMKI_INFO_SAMPLE * sizeof(double));
    l->rests = imki_arena_room(arena, IMKI_INFO_WINDOWS * sizeof(double));
    return !arena->failed;
}

static void find_columns(look *l)
{
    imk_info_log *info = l->info;
    imki_info_rows *r = &l->rows;
    const imk_dimension count = imk_unit_of("count").dimension;
    r->info = info;
    r->stride = 1;
    r->window_rows = IMKI_INFO_WINDOW_ROWS;
    l->time = imk_record_find(l->source, IMK_QUANTITY_TIME, -1);
    info->channel_count = l->source->column_count;
    for (size_t c = 0; c < info->channel_count; c++)
        info->channel[c].column = l->source->columns[c];
    for (int a = 0; a < IMKI_INFO_AXES; a++) {
        r->axis[a] = imk_record_find(
            l->source, a < 3 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, a % 3);
        if (r->axis[a] >= 0)
            r->counts[a / 3] =
                imk_dimension_equal(info->channel[r->axis[a]].column.unit.dimension, count);
    }
}

/* Is the unit known of the times and of each sensor? */
static void find_stated(look *l)
{
    imk_info_log *info = l->info;
    info->timed =
        l->time >= 0 ? info->channel[l->time].column.unit.text[0] != '\0' : l->interval > 0;
    info->stated = info->timed;
    for (size_t c = 0; c < info->channel_count; c++) {
        const imk_log_column *column = &info->channel[c].column;
        info->stated = info->stated &&
                       (column->quantity == IMK_QUANTITY_OTHER || column->unit.text[0] != '\0');
    }
}

/* After the first block: how many rows are a second. */
static void find_window(look *l)
{
    const imk_log_findings f = l->source->findings ? l->source->findings(l->source->context)
                                                   : (imk_log_findings){.interval = 0};
    l->interval = f.interval;
    if (f.interval > 0 && 1 / f.interval > IMKI_INFO_WINDOW_ROWS)
        l->rows.window_rows = (size_t)fmin(1 / f.interval + 0.5, 1e5);
}

/* Take out of the block what an earlier place had: where a sensor is rare, some rows of it reach
 * beyond the next places. @return the rows left */
static size_t drop_known(look *l, size_t rows)
{
    size_t known = 0;
    while (known < rows && l->time >= 0 && l->column[l->time][known] <= l->info->last_time)
        known++;
    for (size_t c = 0; c < l->info->channel_count && known > 0; c++)
        memmove(l->column[c], l->column[c] + known, (rows - known) * sizeof(double));
    return rows - known;
}

/* Read on, up to so many rows and, beyond the first block, so much of the record. */
static imk_status read_place(look *l, size_t rows_most, uint64_t size_most, bool first,
                             imk_error *error)
{
    const uint64_t begin = progress_of(l);
    const size_t before = l->info->rows_read;
    const uint64_t from = begin > l->reached ? begin : l->reached;
    bool known = begin < l->reached;
    l->overlaps = false;
    imk_status status = IMK_OK;
    imki_info_rows_begin(&l->rows);
    for (size_t rows = 0, got = 1; rows < rows_most && !l->over; rows += got) {
        status = l->source->read(l->source->context, BLOCK_ROWS, l->column, &got, error);
        if (status != IMK_OK)
            break;
        l->over = got == 0;
        if (first && rows == 0)
            find_window(l);
        const size_t left = known ? drop_known(l, got) : got;
        known = known && left == 0;
        l->overlaps = l->overlaps || left < got;
        if (l->time >= 0 && left > 0) {
            if (l->info->rows_read == 0)
                l->info->first_time = l->column[l->time][0];
            l->info->last_time = l->column[l->time][left - 1];
        }
        if (first)
            imki_info_stamps_add(&l->stamps, left, l->column);
        imki_info_rows_add(&l->rows, left, l->column);
        const uint64_t at = progress_of(l);
        l->reached = left > 0 && at > l->reached ? at : l->reached;
        status = imki_job_progress(l->job, "looking", "B", at, l->size, error);
        if (status != IMK_OK || (at > begin && at - begin > size_most))
            break;
    }
    const uint64_t end = progress_of(l);
    l->covered += end > from ? (double)(end - from) : 0;
    l->info->places += l->info->rows_read > before;
    return status;
}

/* Counts of the place that was read. */
static void take_findings(look *l, size_t rows_before)
{
    imk_info_log *info = l->info;
    if (!l->source->findings)
        return;
    const imk_log_findings f = l->source->findings(l->source->context);
    const double steps = (double)(info->rows_read - rows_before);
    info->time_origin = f.time_origin;
    if (!l->stamps.settled && !l->overlaps) {
        info->gaps += f.gaps;
        info->missing += f.missing;
    }
    if (!l->overlaps) { /* what stands in both is counted already */
        info->repeats += f.repeats;
        info->reversals += f.reversals;
        info->not_finite += f.not_finite;
        info->damaged += f.damaged;
    }
    info->cut_short = f.cut_short;
    info->other_frames += f.other_frames;
    memcpy(info->frames, f.frames, sizeof info->frames);
    if (!(steps > 0))
        return;
    if (f.interval > 0 && l->steps == 0)
        l->interval = f.interval;
    l->steps += steps;
    l->jitter_squares += steps * f.jitter * f.jitter;
    if (rows_before == 0 && l->source->rate == 0)
        imki_info_stamps_settle(&l->stamps, info, &f);
}

/* The end: so far before it that it is met, at first one megabyte. Where a sensor is rare among
 * others there may be no row in that. */
static imk_status read_end(look *l, imk_error *error)
{
    imk_status status = IMK_OK;
    for (uint64_t back = end_least; status == IMK_OK && back <= 16 * end_least; back *= 4) {
        const size_t before = l->info->rows_read;
        const double fraction = 1 - (double)back / (double)l->size;
        if (l->source->seek(l->source->context, fraction > 0 ? fraction : 0, error) != IMK_OK)
            return IMK_OK;
        l->over = false;
        status = read_place(l, SIZE_MAX, UINT64_MAX, false, error);
        take_findings(l, before);
        l->ended = l->info->rows_read > before;
        if (l->ended)
            break;
    }
    return status;
}

static imk_status read_places(look *l, imk_error *error)
{
    imk_status status = IMK_OK;
    for (int k = 1; k <= PLACES && status == IMK_OK; k++) {
        const size_t before = l->info->rows_read;
        if (l->source->seek(l->source->context, (double)k / (PLACES + 1), error) != IMK_OK)
            return IMK_OK; /* what was read has to do */
        l->over = false;
        status = read_place(l, PLACE_ROWS, place_most, false, error);
        take_findings(l, before);
    }
    l->ended = l->over;
    return status == IMK_OK && !l->ended ? read_end(l, error) : status;
}

/* Damage of a record of which some places were read: their counts, whose rows have no number. */
static void tell_places(look *l)
{
    imk_info_log *info = l->info;
    if (info->damaged > 0)
        imki_find(&info->findings, IMK_FINDING_WARNING, "places:damaged", NULL,
                  IMKI_NUMBERS((double)info->damaged));
    if (info->cut_short)
        imki_find(&info->findings, IMK_FINDING_WARNING, "places:cut_short", NULL, 0, NULL);
    if (info->other_frames > 0)
        imki_find(&info->findings, IMK_FINDING_WARNING, "frames", info->frames,
                  IMKI_NUMBERS((double)info->other_frames, (double)info->rows_read));
    imki_tell_manner(l->source, &info->findings);
}

static void estimate_rows(look *l)
{
    imk_info_log *info = l->info;
    const bool timed = l->time >= 0;
    info->rows = info->rows_read;
    info->rows_from = IMK_INFO_READ;
    if (!info->whole) {
        info->rows_from = IMK_INFO_BEGINNING;
        if (info->settings.rows > 0) {
            info->rows = info->settings.rows;
            info->rows_from = IMK_INFO_INDEX;
        } else if (l->size > 0 && l->covered > 0) {
            const double rows = (double)info->rows_read * (double)l->size / l->covered;
            info->rows = rows > (double)info->rows_read ? (uint64_t)(rows + 0.5) : info->rows_read;
            info->rows_from = IMK_INFO_SIZE;
        }
    }
    info->duration =
        timed ? info->last_time - info->first_time : (double)(info->rows - 1) * l->interval;
    info->duration_from = info->whole ? IMK_INFO_READ
                          : !timed    ? info->rows_from
                          : l->ended  ? IMK_INFO_ENDS
                                      : IMK_INFO_BEGINNING;
    if (info->uneven_stamps && info->interval > 0 && info->rows_from != IMK_INFO_BEGINNING) {
        info->duration = (double)(info->rows - 1 + info->missing) * info->interval;
        info->duration_from = info->rows_from;
    }
    if (timed && info->duration_from == IMK_INFO_BEGINNING &&
        info->rows_from != IMK_INFO_BEGINNING) {
        info->duration = (double)(info->rows - 1) * l->interval;
        info->duration_from = info->rows_from;
        info->last_time = (double)NAN;
    }
}

static imk_status run(look *l, imk_error *error)
{
    imk_info_log *info = l->info;
    const bool full = info->settings.full;
    progress_of(l);
    const bool all = full || (l->size > 0 && l->size <= short_record);
    imk_status status =
        read_place(l, all ? SIZE_MAX : FIRST_ROWS, all ? UINT64_MAX : first_most, true, error);
    take_findings(l, 0);
    info->whole = l->over;
    if (status == IMK_OK && !info->whole && l->source->seek && l->size > 0)
        status = read_places(l, error);
    if (info->rows_read == 0)
        return status != IMK_OK
                   ? status
                   : imki_fail(&info->findings, error, IMK_ERROR_EMPTY, "no_rows", NULL, 0, NULL);
    info->uneven_stamps = l->stamps.settled;
    info->rate_stated = l->source->rate > 0;
    info->interval = l->stamps.settled ? l->stamps.interval : l->interval;
    info->jitter = l->steps > 0 ? sqrt(l->jitter_squares / l->steps) : 0;
    estimate_rows(l);
    info->stopped = status != IMK_OK;
    if (info->whole)
        imki_tell_damage(l->source, &info->findings);
    else
        tell_places(l);
    imki_tell_unused(l->source->column_count, l->source->columns, IMK_KINDS, &info->findings);
    imki_info_rows_end(&l->rows, l->scratch);
    find_stated(l);
    info->resting = (double)NAN;
    if (info->stated)
        imki_info_motion(&l->rows, l->rests, l->scratch);
    return status;
}

imk_status imk_info_log_run(const imk_record_source *source, const imk_info_log_settings *settings,
                            const imk_job *job, imk_info_log **result, imk_error *error)
{
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_info_log_default()", error);
    if (!result)
        return status;
    *result = NULL;
    job = imki_job_of(job);
    if (status == IMK_OK)
        status = imki_check_source(source, error);
    imk_info_log *made = imki_result_new(job, sizeof *made, &status, error);
    if (!made)
        return status;
    made->allocator = job->allocator;
    made->settings = *settings;
    made->first_time = made->last_time = (double)NAN;
    *result = made;
    imki_arena arena = {.allocator = job->allocator};
    look *l = imki_arena_take(&arena, sizeof *l);
    if (l) {
        *l = (look){.source = source, .job = job, .info = made};
        find_columns(l);
        l->stamps.failed = l->time < 0;
        l->stamps.stamps = (imki_stamps){.allocator = job->allocator,
                                         .column_count = made->channel_count,
                                         .time_column = l->time < 0 ? 0 : (size_t)l->time};
    }
    status = l && take_memory(l, &arena) ? run(l, error)
                                         : imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (l)
        imki_stamps_free(&l->stamps.stamps);
    imki_arena_free(&arena);
    return status;
}
