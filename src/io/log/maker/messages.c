/* SPDX-License-Identifier: Apache-2.0 */
/* What logs of messages have in common: finding messages, the kinds that are in a log, rows,
 * damage. */
#include "messages_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOOK = 1 << 20 }; /* bytes in which the kinds of messages are looked for */

/* May a message begin with this byte? */
static bool may_begin(const imki_maker *maker, char c)
{
    return c != '\0' && strchr(maker->starts, c) != NULL;
}

bool imki_messages_recognise(const imki_maker *maker, const char *begin, size_t size)
{
    imki_message message;
    for (size_t at = 0; at < size; at++)
        if (may_begin(maker, begin[at]) && maker->find((const unsigned char *)begin + at, size - at,
                                                       &message) == IMKI_FOUND_MESSAGE)
            return true;
    return false;
}

/* Bytes that may stand between messages of a sound log. */
static bool may_be_between(const imki_maker *maker, char c)
{
    return c == '\r' || c == '\n' || c == ' ' || c == '\t' ||
           (maker->text_between && c > ' ' && c <= '~');
}

/* To the next byte that may begin a message, behind the one at the place.
 * @return whether nothing is passed that cannot stand between messages */
static bool step_on(const imki_messages *m, imki_log_text *text)
{
    const char *at = text->next;
    bool sound = true;
    do
        sound &= may_be_between(m->maker, *at++);
    while (at < text->end && !may_begin(m->maker, *at));
    text->next = at;
    return sound;
}

static void note_loss(imk_log_reader *reader, imki_messages *m, size_t rows)
{
    if (!m->lost && !m->searching)
        imki_log_damage(reader, rows);
    m->lost |= !m->searching;
}

/* The next message, which stays at the place. *found is false at the end. */
static imk_status next_message(imk_log_reader *reader, size_t rows, imki_message *message,
                               bool *found, imk_error *error)
{
    imki_messages *m = reader->state;
    imki_log_text *text = &reader->text;
    for (;;) {
        const imk_status status = imki_log_text_need(text, m->maker->longest, error);
        const size_t left = (size_t)(text->end - text->next);
        *found = false;
        if (status != IMK_OK)
            return status;
        if (left == 0) {
            reader->cut_short |= m->part;
            return IMK_OK;
        }
        const bool begins = may_begin(m->maker, *text->next);
        const imki_found what =
            begins ? m->maker->find((const unsigned char *)text->next, left, message)
                   : IMKI_FOUND_NOTHING;
        switch (what) {
        case IMKI_FOUND_MESSAGE:
            if (m->part)
                note_loss(reader, m, rows);
            m->part = m->lost = m->searching = false;
            *found = m->begun = true;
            return IMK_OK;
        case IMKI_FOUND_DAMAGED:
            if (!m->part)
                note_loss(reader, m, rows);
            break;
        case IMKI_FOUND_PART:
            m->part = true;
            break;
        case IMKI_FOUND_NOTHING: /* one byte does not tell */
            m->part |= left == 1 && begins;
            break;
        }
        if (!step_on(m, text) && what == IMKI_FOUND_NOTHING && m->begun && !m->part)
            note_loss(reader, m, rows);
    }
}

static void consume(imki_messages *m, imki_log_text *text, const imki_message *message)
{
    text->next += message->size;
    m->place = 0;
}

/* The next row; *found is false at the end. */
static imk_status next_row(imk_log_reader *reader, size_t rows, double *values, bool *found,
                           imk_error *error)
{
    imki_messages *m = reader->state;
    for (;;) {
        imki_message message;
        const imk_status status = next_message(reader, rows, &message, found, error);
        if (status != IMK_OK)
            return status;
        if (!*found) {
            *found = m->kind->rest && m->kind->rest(m, values);
            return IMK_OK;
        }
        bool is_row = false;
        m->wrong = false;
        if (message.id == m->kind->id)
            is_row = m->kind->row(m, &message, values);
        if (m->wrong)
            imki_log_damage(reader, rows);
        if (message.id != m->kind->id || m->wrong || m->place >= message.body_size)
            consume(m, &reader->text, &message);
        if (is_row && !m->wrong)
            return IMK_OK;
    }
}

/* Back to the beginning, with nothing met. */
static void go_back(imk_log_reader *reader)
{
    imki_messages *m = reader->state;
    imki_log_text *text = &reader->text;
    text->next = text->hold;
    m->place = 0;
    m->begun = m->searching = m->lost = m->part = m->counter.begun = false;
    m->held = (imki_held){.cells = 0};
    memset(m->later, 0, sizeof m->later);
    reader->damaged = reader->first_damaged = 0;
    reader->cut_short = false;
}

/* Which kinds there are: how many messages of each are in the first part of the log. */
static imk_status count_kinds(imk_log_reader *reader, uint64_t *counts, bool *whole,
                              imk_error *error)
{
    imki_messages *m = reader->state;
    imki_log_text *text = &reader->text;
    bool found = true;
    while (found && text->next - text->hold < LOOK) {
        imki_message message;
        const imk_status status = next_message(reader, 0, &message, &found, error);
        if (status != IMK_OK)
            return status;
        for (size_t i = 0; i < m->maker->kind_count && found; i++)
            counts[i] += m->maker->kinds[i].id == message.id;
        if (found)
            consume(m, text, &message);
    }
    *whole = !found;
    go_back(reader);
    return IMK_OK;
}

enum { KINDS_MAX = 8 };

static imk_status choose_kind(imk_log_reader *reader, imk_error *error)
{
    imki_messages *m = reader->state;
    uint64_t counts[KINDS_MAX] = {0};
    size_t of_stream[KINDS_MAX], streams = 0, index;
    bool whole = false;
    imk_status status = count_kinds(reader, counts, &whole, error);
    for (int readable = 1; readable >= 0; readable--)
        for (size_t i = 0; i < m->maker->kind_count && status == IMK_OK; i++) {
            const imki_message_kind *kind = &m->maker->kinds[i];
            if (counts[i] == 0 || (kind->layout != NULL) != (readable == 1))
                continue;
            imk_log_stream stream = {.instance = -1,
                                     .readable = readable == 1,
                                     /* Where rows are held back, messages are no rows. */
                                     .samples = whole && !kind->rest ? counts[i] : 0,
                                     .begin = (double)NAN,
                                     .end = (double)NAN};
            snprintf(stream.name, sizeof stream.name, "%s", kind->name);
            snprintf(stream.kind, sizeof stream.kind, "%s", kind->kind);
            of_stream[streams++] = i;
            status = imki_log_stream_add(reader, &stream, error);
        }
    if (status == IMK_OK)
        status = imki_log_stream_choose(reader, m->maker->nothing, &index, error);
    if (status == IMK_OK)
        m->kind = &m->maker->kinds[of_stream[index]];
    return status;
}

/* The columns, from the first message of the kind. */
static imk_status make_layout(imk_log_reader *reader, imk_error *error)
{
    imki_messages *m = reader->state;
    imki_message message = {.id = 0};
    bool found = true;
    while (found && message.id != m->kind->id) {
        if (message.size > 0)
            consume(m, &reader->text, &message);
        const imk_status status = next_message(reader, 0, &message, &found, error);
        if (status != IMK_OK)
            return status;
    }
    const imk_status status =
        found ? m->kind->layout(reader, m, &message, error)
              : imk_error_set(error, IMK_ERROR_READ, "", "the log has changed", "");
    go_back(reader);
    return status;
}

static double time_of(const imki_messages *m)
{
    return (double)(int64_t)((uint64_t)m->stamp - (uint64_t)m->origin) * m->tick;
}

static imk_status look_at_rows(imk_log_reader *reader, imk_error *error)
{
    imki_messages *m = reader->state;
    double time[2] = {(double)NAN, (double)NAN}, values[IMKI_MESSAGE_COLUMNS];
    uint64_t rows = 0;
    for (; rows < 2; rows++) {
        bool found;
        const imk_status status = next_row(reader, 0, values, &found, error);
        if (status != IMK_OK)
            return status;
        if (!found)
            break;
        if (rows == 0 && m->timed && m->per_second > 0)
            m->origin = imki_log_stamp_origin(reader, m->stamp, m->per_second);
        time[rows] = m->timed ? time_of(m) : (double)NAN;
    }
    go_back(reader);
    return imki_log_first_rows(reader, rows, time, m->maker->nothing,
                               "a log with gyros or accelerometers", error);
}

imk_status imki_messages_open(imk_log_reader *reader, const imki_maker *maker, imk_error *error)
{
    imki_messages *m = calloc(1, sizeof *m);
    reader->state = m;
    if (!m)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    *m = (imki_messages){.maker = maker, .tick = 1.0, .timed = true};
    reader->text.hold = reader->text.next;
    imk_status status = choose_kind(reader, error);
    if (status == IMK_OK)
        status = make_layout(reader, error);
    if (status == IMK_OK)
        status = look_at_rows(reader, error);
    reader->text.hold = NULL;
    return status;
}

imk_status imki_messages_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                              size_t *rows, imk_error *error)
{
    imki_messages *m = reader->state;
    const imki_log_layout_read *layout = &reader->layout;
    for (*rows = 0; *rows < max_rows; ++*rows) {
        double values[IMKI_MESSAGE_COLUMNS];
        bool found, finite = true;
        const imk_status status = next_row(reader, *rows, values, &found, error);
        memcpy(reader->later, m->later, sizeof reader->later);
        if (status != IMK_OK || !found)
            return status;
        for (size_t i = 0; i < layout->cell_count; i++) {
            if (layout->cell_column[i] < 0)
                continue;
            const bool is_time = layout->cell_column[i] == layout->time_column;
            const double value = (is_time ? time_of(m) : values[i]) * layout->cell_factor[i];
            finite &= isfinite(value) != 0;
            out[i][*rows] = value;
        }
        if (!finite && reader->not_finite++ == 0)
            reader->first_not_finite = reader->rows + *rows + 1;
    }
    return IMK_OK;
}

imk_status imki_messages_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    imki_messages *m = reader->state;
    const uint64_t size = imki_log_text_size(&reader->text);
    const imk_status status =
        imki_log_text_seek(&reader->text, (uint64_t)(fraction * (double)size), error);
    m->place = 0;
    m->searching = true;
    m->lost = m->part = m->counter.begun = false;
    m->held = (imki_held){.broken = fraction > 0};
    memset(m->later, 0, sizeof m->later);
    return status;
}

bool imki_numbers_read(const imki_message *message, size_t count, double *numbers)
{
    const char *begin = (const char *)message->body;
    imki_log_piece cells[IMKI_MESSAGE_COLUMNS];
    bool whole = imki_log_split(begin, begin + message->body_size, ',', IMKI_MESSAGE_COLUMNS,
                                cells) == count;
    for (size_t i = 0; i < count && whole; i++)
        whole = imki_log_piece_is_number(cells[i], &numbers[i]) && isfinite(numbers[i]);
    return whole;
}

size_t imki_star_find(const unsigned char *at, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        if (at[i] == '*')
            return i;
        if (at[i] < ' ' || at[i] > '~')
            return 0;
    }
    return 0;
}

bool imki_hex_read(const unsigned char *at, size_t digits, uint32_t *number)
{
    *number = 0;
    for (size_t i = 0; i < digits; i++) {
        const unsigned char c = at[i];
        const int digit = c >= '0' && c <= '9'   ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (digit < 0)
            return false;
        *number = *number << 4 | (uint32_t)digit;
    }
    return true;
}
