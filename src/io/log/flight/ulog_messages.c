/* SPDX-License-Identifier: Apache-2.0 */
/* From message to message of a ULog, also past damaged bytes. There are no checksums: a message is
 * trusted if its kind, its size and what is known of its body fit, and one that is not known only
 * if another one follows. */
#include "ulog_internal.h"

#include <string.h>

enum { HEADER = 3, LARGEST_UNKNOWN = 10000, NAME_MOST = 256, SYNC = 8 };

typedef enum trust { WRONG, UNKNOWN, FITS } trust;

static size_t number16(const char *at)
{
    return (size_t)(unsigned char)at[0] | (size_t)(unsigned char)at[1] << 8;
}

static trust trust_data(const imki_ulog *ulog, const char *body, size_t size)
{
    if (size < 2)
        return WRONG;
    const imki_ulog_number *number = &ulog->number[number16(body)];
    if (number->known && size - 2 >= number->smallest && size - 2 <= number->largest)
        return FITS;
    return size <= LARGEST_UNKNOWN ? UNKNOWN : WRONG;
}

/* Is it text, from the beginning up to the first `end`, which is there? */
static bool is_text(const char *begin, size_t size, char end)
{
    size_t i = 0;
    while (i < size && begin[i] != end && begin[i] > ' ' && begin[i] <= '~')
        i++;
    return i > 0 && i < size && begin[i] == end;
}

/* A key, "type name", with its length before it, behind `before` bytes. */
static trust trust_key(const char *body, size_t size, size_t before)
{
    const size_t length = size > before ? (unsigned char)body[before] : 0;
    return length + before + 1 <= size && is_text(body + before + 1, length, ' ') ? FITS : WRONG;
}

/* Does a message of this kind and size, whose body is at hand, fit? */
static trust trust_of(const imki_ulog *ulog, char kind, const char *body, size_t size)
{
    static const char sync[SYNC] = "\x2F\x73\x13\x20\x25\x0C\xBB\x12";
    switch (kind) {
    case 'D':
        return trust_data(ulog, body, size);
    case 'S':
        return size == SYNC && memcmp(body, sync, SYNC) == 0 ? FITS : WRONG;
    case 'I':
    case 'P':
        return trust_key(body, size, 0);
    case 'M':
    case 'Q':
        return trust_key(body, size, 1);
    case 'A':
        return size > 3 && size < NAME_MOST && body[3] > ' ' && body[3] <= '~' ? FITS : WRONG;
    case 'F':
        return is_text(body, size < NAME_MOST ? size : NAME_MOST, ':') ? FITS : WRONG;
    case 'R':
    case 'O':
        return size == 2 ? FITS : WRONG;
    default: /* L, C, B, which any bytes may be, or of a later version */
        return ((kind >= 'A' && kind <= 'Z') || (kind >= 'a' && kind <= 'z')) && size > 0 &&
                       size <= LARGEST_UNKNOWN
                   ? UNKNOWN
                   : WRONG;
    }
}

/* Bytes from here on that belong together: to the end, or to where appended data begin. */
static size_t at_hand(const imki_ulog *ulog, const imki_log_text *text, bool *last)
{
    const size_t left = (size_t)(text->end - text->next);
    const uint64_t place = imki_log_text_place(text);
    *last = text->finished;
    for (size_t i = 0; i < 3; i++)
        if (ulog->appended[i] > place && ulog->appended[i] - place <= left) {
            *last = true;
            return (size_t)(ulog->appended[i] - place);
        }
    return left;
}

/* Trust in a message of which `left` bytes of the body are there, because the end cuts it off. */
static trust trust_cut(const imki_ulog *ulog, char kind, const char *body, size_t size, size_t left)
{
    if (kind == 'D')
        return left < 2 || trust_data(ulog, body, size) == FITS ? UNKNOWN : WRONG;
    if (kind == 'S' || kind == 'R' || kind == 'O')
        return size == (kind == 'S' ? SYNC : 2) ? UNKNOWN : WRONG;
    return strchr("ABCFILMPQ", kind) && kind != '\0' && size <= LARGEST_UNKNOWN ? UNKNOWN : WRONG;
}

/* Trust in what stands `from` bytes behind text->next, within `left` bytes. */
static trust trust_at(const imki_ulog *ulog, const imki_log_text *text, size_t from, size_t left)
{
    if (left < from + HEADER)
        return FITS;
    const char *at = text->next + from, *body = at + HEADER;
    const size_t size = number16(at), there = left - from - HEADER;
    return there < size ? trust_cut(ulog, at[2], body, size, there)
                        : trust_of(ulog, at[2], body, size);
}

/* Whole message at text->next? If need be, by the next one.
 * @param sure  a known message, too, needs one that follows */
static imk_status look(const imki_ulog *ulog, imki_log_text *text, bool sure, trust *found,
                       imk_error *error)
{
    const size_t size = HEADER + number16(text->next);
    bool last;
    *found = trust_of(ulog, text->next[2], text->next + HEADER, size - HEADER);
    if (*found == WRONG || (*found == FITS && !sure))
        return IMK_OK;
    imk_status status = imki_log_text_need(text, size + HEADER, error);
    if (status == IMK_OK && at_hand(ulog, text, &last) >= size + HEADER)
        status = imki_log_text_need(text, size + HEADER + number16(text->next + size), error);
    if (status == IMK_OK && trust_at(ulog, text, size, at_hand(ulog, text, &last)) == WRONG)
        *found = WRONG;
    return status;
}

/* Have a message at text->next. @param size  of it with its header; 0: the rest is no whole one */
static imk_status fetch(const imki_ulog *ulog, imki_log_text *text, size_t *size, bool *last,
                        imk_error *error)
{
    *size = 0;
    imk_status status = IMK_OK;
    if ((size_t)(text->end - text->next) < HEADER)
        status = imki_log_text_need(text, HEADER, error);
    if (status != IMK_OK || at_hand(ulog, text, last) < HEADER)
        return status;
    const size_t due = HEADER + number16(text->next);
    if ((size_t)(text->end - text->next) < due)
        status = imki_log_text_need(text, due, error);
    if (status == IMK_OK && at_hand(ulog, text, last) >= due)
        *size = due;
    return status;
}

/* Go on to the next byte with a message that can be trusted, or to the end. */
static imk_status find_way(imki_ulog *ulog, imki_log_text *text, imk_error *error)
{
    for (;;) {
        size_t size;
        bool last;
        trust found = WRONG;
        imk_status status = fetch(ulog, text, &size, &last, error);
        if (status == IMK_OK && size > 0)
            status = look(ulog, text, true, &found, error);
        if (status != IMK_OK || found == FITS || text->next == text->end ||
            imki_log_text_place(text) >= ulog->log.until)
            return status;
        text->next++;
    }
}

/* Messages of a number: their size, and the sensor that they are of. @return IMK_ERROR_MEMORY */
static imk_status subscribe(imki_ulog *ulog, const char *body, size_t size, imk_error *error)
{
    imki_flight_log *log = &ulog->log;
    imki_ulog_number *number = &ulog->number[number16(body + 1)];
    const char *name = body + 3;
    const int instance = (unsigned char)body[0];
    if (number->known) /* a number is of one format only */
        return IMK_OK;
    *number = (imki_ulog_number){true, 0, UINT16_MAX, -1};
    imki_ulog_format *format = imki_ulog_format_find(&ulog->formats, name, size - 3);
    if (!format)
        return IMK_OK;
    imki_ulog_format_measure(&ulog->formats, format);
    if (format->size == 0)
        return IMK_OK;
    number->smallest = (uint16_t)format->smallest;
    number->largest = (uint16_t)format->size;
    const int topic = imki_ulog_topic(name, size - 3);
    if (topic < 0)
        return IMK_OK;
    for (size_t i = 0; i < log->stream_count; i++)
        if (log->streams[i].rank == topic && log->streams[i].about.instance == instance) {
            number->stream = (int)i;
            return IMK_OK;
        }
    if (!log->surveying)
        return IMK_OK;
    if (!ulog->planned[topic])
        imki_ulog_plan(&ulog->formats, format, topic, &ulog->plan[topic]);
    ulog->planned[topic] = true;
    const size_t index = imki_flight_stream_add(log, format->text, format->text, instance, topic,
                                                &ulog->plan[topic]);
    if (index == SIZE_MAX)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    number->stream = (int)index;
    return IMK_OK;
}

/* What a message that is no data says. */
static imk_status learn(imk_log_reader *reader, size_t size, imk_error *error)
{
    imki_ulog *ulog = reader->state;
    const char *at = reader->text.next;
    bool memory = true;
    if (at[2] == 'A' && imki_flight_learns(reader))
        return subscribe(ulog, at + HEADER, size - HEADER, error);
    if (at[2] == 'F' && ulog->log.surveying &&
        !imki_ulog_format_add(&ulog->formats, at + HEADER, size - HEADER, &memory) && memory)
        imki_log_damage(reader, ulog->log.rows);
    return memory ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

/* What stands here reaches beyond the end, or into appended data. Either it was cut off, and
 * nothing follows, or its size is damaged. */
static imk_status end_of_part(imk_log_reader *reader, imk_error *error)
{
    imki_ulog *ulog = reader->state;
    imki_log_text *text = &reader->text;
    text->next++;
    const imk_status status = find_way(ulog, text, error);
    if (text->next == text->end)
        reader->cut_short = true;
    else
        imki_log_damage(reader, ulog->log.rows);
    return status;
}

/* A message that is at hand: *message is set if it is of a sensor. Else it is consumed, or what
 * follows the damage is looked for. */
static imk_status take(imk_log_reader *reader, size_t size, imki_flight_message *message,
                       imk_error *error)
{
    imki_ulog *ulog = reader->state;
    imki_log_text *text = &reader->text;
    trust found;
    static const imki_ulog_number none = {.stream = -1};
    const bool data = text->next[2] == 'D' && size >= HEADER + 2;
    const imki_ulog_number *number = data ? &ulog->number[number16(text->next + HEADER)] : &none;
    const bool sensor = number->known && number->stream >= 0;
    imk_status status = look(ulog, text, sensor, &found, error);
    if (status != IMK_OK)
        return status;
    if (found == WRONG) {
        imki_log_damage(reader, ulog->log.rows);
        text->next++;
        return find_way(ulog, text, error);
    }
    if (sensor && found == FITS) {
        *message = imki_flight_message_of(ulog->log.streams[number->stream].plan,
                                          (size_t)number->stream, text->next + HEADER + 2, size);
        return IMK_OK;
    }
    if (data && found == UNKNOWN && (number->known || !ulog->log.sought))
        imki_log_damage(reader, ulog->log.rows);
    status = learn(reader, size, error);
    text->next += size;
    return status;
}

imk_status imki_ulog_next(imk_log_reader *reader, imki_flight_message *message, imk_error *error)
{
    imki_ulog *ulog = reader->state;
    imki_log_text *text = &reader->text;
    imk_status status = IMK_OK;
    *message = (imki_flight_message){.size = 0};
    if (ulog->log.lost)
        status = find_way(ulog, text, error);
    ulog->log.lost = false;
    while (status == IMK_OK && message->size == 0 && imki_log_text_place(text) < ulog->log.until) {
        size_t size;
        bool last;
        status = fetch(ulog, text, &size, &last, error);
        if (status != IMK_OK || (text->next == text->end && last))
            return status;
        if (size > 0)
            status = take(reader, size, message, error);
        else
            status = end_of_part(reader, error);
    }
    return status;
}
