/* SPDX-License-Identifier: Apache-2.0 */
/* The sensors of a flight log: what its first 8 MiB and its end say of them, and which one is read.
 *
 * Messages that say what there is stand before the first data, but a sensor may be announced later,
 * when it first has a value. Nowhere does a log say how many messages there are. So the first 8 MiB
 * are walked through, which takes some ten milliseconds, and counts are scaled to the size of the
 * file. */
#include "flight_log_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SURVEY = 8 << 20, TAIL = 1 << 20 }; /* bytes */

size_t imki_flight_stream_add(imki_flight_log *log, const char *name, const char *kind,
                              int instance, int rank, const imki_flight_plan *plan)
{
    if (log->stream_count == log->stream_room) {
        const size_t room = log->stream_room > 0 ? 2 * log->stream_room : 16;
        imki_flight_stream *larger = realloc(log->streams, room * sizeof *larger);
        if (!larger)
            return SIZE_MAX;
        log->streams = larger;
        log->stream_room = room;
    }
    imki_flight_stream *stream = &log->streams[log->stream_count];
    *stream = (imki_flight_stream){.rank = rank, .plan = plan};
    stream->about = (imk_log_stream){
        .instance = instance, .begin = (double)NAN, .end = (double)NAN, .estimated = true};
    snprintf(stream->about.name, sizeof stream->about.name, "%s", name);
    snprintf(stream->about.kind, sizeof stream->about.kind, "%s", kind);
    return log->stream_count++;
}

/* Can the text go to another place, without keeping what it leaves? */
static bool moves(const imki_log_text *text)
{
    return !text->buffer || imki_input_file(text->input) >= 0;
}

/* Where the text can move. */
static uint64_t size_of(const imki_log_text *text)
{
    uint64_t done, size;
    if (!text->buffer)
        return (uint64_t)(text->end - text->base);
    imki_input_progress(text->input, &done, &size);
    return size;
}

bool imki_flight_learns(const imk_log_reader *reader)
{
    const imki_flight_log *log = reader->state;
    return log->surveying || imki_log_text_place(&reader->text) >= log->surveyed;
}

static void count(imki_flight_log *log, const imki_flight_message *m)
{
    imki_flight_stream *stream = &log->streams[m->stream];
    if (m->rows == 0)
        return;
    if (!stream->stamped) {
        stream->first = m->stamp;
        stream->begin = (double)m->stamp + imki_flight_offset(m, 0);
        stream->stamped = true;
    }
    stream->end = (double)m->stamp + imki_flight_offset(m, m->rows - 1);
    if (!log->surveying)
        return;
    stream->rows += m->rows;
    for (size_t i = 0; i < stream->plan->cell_count && stream->plan->usable; i++)
        if (stream->plan->cell[i].optional &&
            isfinite(imki_flight_value(&stream->plan->cell[i], m, 0)))
            stream->seen |= 1u << i;
}

/* Walk through messages up to this byte. What the input cannot give is told when the rows are read.
 * @param whole  whether the end was met
 * @return IMK_ERROR_MEMORY */
static imk_status walk(imk_log_reader *reader, uint64_t until, bool *whole, imk_error *error)
{
    imki_flight_log *log = reader->state;
    imki_flight_message m;
    *whole = false;
    log->until = until;
    for (;;) {
        const imk_status status = log->next(reader, &m, NULL);
        if (status == IMK_ERROR_MEMORY)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        if (status != IMK_OK)
            return IMK_OK;
        if (m.size == 0)
            break;
        count(log, &m);
        reader->text.next += m.size;
    }
    *whole = reader->text.finished && reader->text.next == reader->text.end;
    return IMK_OK;
}

/* Begin anew at a byte; what was found of damage is of a look only. */
static imk_status go_to(imk_log_reader *reader, uint64_t place, imk_error *error)
{
    imki_flight_log *log = reader->state;
    reader->damaged = reader->first_damaged = 0;
    reader->cut_short = false;
    log->row = log->rows = 0;
    log->until = UINT64_MAX;
    log->lost = log->sought = place != log->begin;
    if (log->forget)
        log->forget(reader);
    if (reader->text.hold) {
        reader->text.next = reader->text.hold;
        reader->text.hold = NULL;
        return IMK_OK;
    }
    return imki_log_text_seek(&reader->text, place, error);
}

/* Number of samples in the whole log, by the part that was walked through. */
static void estimate(imk_log_reader *reader, bool whole)
{
    imki_flight_log *log = reader->state;
    const imki_log_text *text = &reader->text;
    uint64_t done = imki_log_text_place(text) - log->begin, size = 0;
    if (moves(text))
        size = size_of(text) - log->begin;
    else if (!whole)
        imki_input_progress(text->input, &done, &size);
    for (size_t i = 0; i < log->stream_count; i++) {
        imki_flight_stream *stream = &log->streams[i];
        const double ratio = whole ? 1 : done > 0 ? (double)size / (double)done : 0;
        stream->about.samples = (uint64_t)((double)stream->rows * ratio);
        stream->about.estimated = !whole;
    }
}

/* Is a sensor asked for that was not met yet? It may begin later. */
static bool is_wanting(const imk_log_reader *reader)
{
    const imki_flight_log *log = reader->state;
    for (size_t i = 0; i < log->stream_count; i++)
        if (log->streams[i].rows > 0 && imki_log_stream_is_named(reader, &log->streams[i].about))
            return false;
    return reader->settings.topic || reader->settings.instance > 0;
}

static imk_status survey(imk_log_reader *reader, imk_error *error)
{
    imki_flight_log *log = reader->state;
    imki_log_text *text = &reader->text;
    const bool free_to_move = moves(text);
    bool whole, ended = true;
    log->begin = imki_log_text_place(text);
    text->hold = free_to_move ? NULL : text->next;
    log->surveying = true;
    imk_status status = walk(reader, log->begin + SURVEY, &whole, error);
    if (status == IMK_OK && !whole && free_to_move && is_wanting(reader))
        status = walk(reader, UINT64_MAX, &whole, error);
    log->surveying = false;
    log->surveyed = imki_log_text_place(text);
    if (status == IMK_OK)
        estimate(reader, whole);
    const uint64_t walked = imki_log_text_place(text), size = free_to_move ? size_of(text) : 0;
    if (status == IMK_OK && !whole && size > walked) {
        status = go_to(reader, size - walked > TAIL ? size - TAIL : walked, error);
        if (status == IMK_OK)
            status = walk(reader, UINT64_MAX, &ended, error);
    }
    for (size_t i = 0; i < log->stream_count; i++) {
        imki_flight_stream *stream = &log->streams[i];
        if (stream->stamped && stream->rows > 0)
            stream->about.begin = stream->begin * 1e-6;
        if (stream->stamped && (whole || size > walked))
            stream->about.end = stream->end * 1e-6;
    }
    return status == IMK_OK ? go_to(reader, log->begin, error) : status;
}

/* A sensor in the order of the list. */
typedef struct place {
    const imki_flight_stream *stream;
} place;

static int compare(const void *a, const void *b)
{
    const imki_flight_stream *x = ((const place *)a)->stream, *y = ((const place *)b)->stream;
    if (x->about.readable != y->about.readable)
        return x->about.readable ? -1 : 1;
    if (x->rank != y->rank)
        return x->rank < y->rank ? -1 : 1;
    return x->about.instance < y->about.instance ? -1 : x->about.instance > y->about.instance;
}

static imk_status choose(imk_log_reader *reader, imk_error *error)
{
    imki_flight_log *log = reader->state;
    size_t index = 0;
    place *order = malloc((log->stream_count + 1) * sizeof *order);
    if (!order)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    for (size_t i = 0; i < log->stream_count; i++)
        order[i].stream = &log->streams[i];
    qsort(order, log->stream_count, sizeof *order, compare);
    imk_status status = IMK_OK;
    for (size_t i = 0; i < log->stream_count && status == IMK_OK; i++)
        status = imki_log_stream_add(reader, &order[i].stream->about, error);
    if (status == IMK_OK)
        status = imki_log_stream_choose(reader, log->nothing, &index, error);
    if (status == IMK_OK)
        log->chosen = (size_t)(order[index].stream - log->streams);
    free(order);
    return status;
}

imk_status imki_flight_open(imk_log_reader *reader, imk_error *error)
{
    imki_flight_log *log = reader->state;
    const char *names[IMKI_FLIGHT_CELLS + 1] = {"time [us]"};
    imk_status status = survey(reader, error);
    if (status == IMK_OK && log->settle)
        log->settle(reader);
    for (size_t i = 0; i < log->stream_count; i++) {
        imki_flight_stream *stream = &log->streams[i];
        stream->about.readable =
            stream->plan->usable && (stream->rows > 0 || stream->about.estimated);
    }
    if (status == IMK_OK)
        status = choose(reader, error);
    if (status != IMK_OK)
        return status;
    const imki_flight_stream *stream = &log->streams[log->chosen];
    imki_flight_plan *plan = &log->plan;
    *plan = *stream->plan;
    plan->cell_count = 0;
    for (size_t i = 0; i < stream->plan->cell_count; i++) {
        const imki_flight_cell *cell = &stream->plan->cell[i];
        if (!cell->optional || (stream->seen & 1u << i) != 0)
            plan->cell[plan->cell_count++] = *cell;
        else if (strncmp(cell->column, "temperature", 11) == 0)
            log->idle = *cell;
    }
    for (size_t i = 0; i < plan->cell_count; i++)
        names[i + 1] = plan->cell[i].column;
    status = imki_log_layout_of(reader, plan->cell_count + 1, names, error);
    if (status != IMK_OK)
        return status;
    log->origin = (uint64_t)imki_log_stamp_origin(reader, (int64_t)stream->first, 1000000);
    const double time[2] = {(double)(int64_t)(stream->first - log->origin), (double)NAN};
    return imki_log_first_rows(reader, 1, time, "", "", error);
}

/* The cell of a column in a new plan. @return false: there is none, and must be one */
static bool follow(const imki_flight_plan *plan, imki_flight_cell *cell)
{
    size_t now = 0;
    while (now < plan->cell_count && strcmp(plan->cell[now].column, cell->column) != 0)
        now++;
    if (now < plan->cell_count)
        *cell = plan->cell[now];
    else
        cell->value.type = IMKI_FLIGHT_NONE;
    return now < plan->cell_count || cell->optional;
}

bool imki_flight_follow(imki_flight_log *log, const imki_flight_plan *plan)
{
    if (log->plan.cell_count == 0 || log->streams[log->chosen].plan != plan)
        return true;
    bool good = plan->usable;
    for (size_t i = 0; i < log->plan.cell_count && good; i++)
        good = follow(plan, &log->plan.cell[i]);
    (void)follow(plan, &log->idle);
    return good;
}

imk_status imki_flight_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    const imki_flight_log *log = reader->state;
    if (!moves(&reader->text))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "in a pipe and in compressed data there is no way to another place",
                             "write it to a plain file");
    if (log->redefined && fraction > 0)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "",
                             "the log gives its messages other fields on the way",
                             "read it from its beginning");
    const uint64_t size = size_of(&reader->text);
    const uint64_t length = size > log->begin ? size - log->begin : 0;
    return go_to(reader, log->begin + (uint64_t)(fraction * (double)length), error);
}

void imki_flight_close(imk_log_reader *reader)
{
    imki_flight_log *log = reader->state;
    if (log)
        free(log->streams);
}
