/* SPDX-License-Identifier: Apache-2.0 */
/* Moving through the records of a log, of which a pipe shows each byte once. */
#include "log_ros_internal.h"

#include <stdio.h>
#include <stdlib.h>

bool imki_ros_can_seek(const imki_ros_log *log)
{
    return !log->text->buffer || imki_input_file(log->text->input) >= 0;
}

uint64_t imki_ros_size(const imki_ros_log *log)
{
    uint64_t done, size;
    if (!log->text->buffer)
        return (uint64_t)(log->text->end - log->text->base);
    imki_input_progress(log->text->input, &done, &size);
    return size;
}

imk_status imki_ros_need(imki_ros_log *log, uint64_t size, bool *whole, imk_error *error)
{
    const uint64_t most = size < SIZE_MAX / 2 ? size : SIZE_MAX / 2;
    const imk_status status = imki_log_text_need(log->text, (size_t)most, error);
    *whole = (uint64_t)(log->text->end - log->text->next) >= size;
    if (status == IMK_OK && !*whole)
        log->reader->cut_short = true;
    return status;
}

imk_status imki_ros_skip(imki_ros_log *log, uint64_t size, bool *whole, imk_error *error)
{
    imki_log_text *text = log->text;
    imk_status status = IMK_OK;
    *whole = true;
    if (size > (uint64_t)(text->end - text->next) && text->buffer && imki_ros_can_seek(log)) {
        const uint64_t place = imki_log_text_place(text), end = imki_ros_size(log);
        *whole = place <= end && size <= end - place;
        log->reader->cut_short |= !*whole;
        return *whole ? imki_log_text_seek(text, place + size, error) : IMK_OK;
    }
    while (size > 0 && status == IMK_OK && *whole) {
        status = imki_ros_need(log, 1, whole, error);
        const size_t at_hand = (size_t)(text->end - text->next);
        const size_t step = at_hand < size ? at_hand : (size_t)size;
        text->next += step;
        size -= step;
    }
    return status;
}

/* Is a topic asked for that was not met yet? A file is then looked through to its end. */
static bool is_wanting(const imki_ros_log *log)
{
    const imk_log_settings *s = &log->reader->settings;
    for (size_t i = 0; i < log->topic_count; i++)
        if (log->topics[i].seen > 0 &&
            imki_log_stream_is_named(log->reader, &log->topics[i].stream))
            return false;
    return (s->topic || s->instance > 0) && imki_ros_can_seek(log);
}

void imki_ros_mark(imki_ros_log *log, uint64_t size, bool *enough)
{
    imki_log_text *text = log->text;
    const uint64_t place = imki_log_text_place(text);
    *enough = false;
    if (!log->looking)
        return;
    if (log->held) {
        const uint64_t kept = place - log->looked;
        *enough =
            (kept > IMKI_ROS_LOOK_BYTES || size > IMKI_ROS_LOOK_BYTES - kept) && !is_wanting(log);
        return;
    }
    log->looked = place;
    log->damaged_before = log->reader->damaged;
    if (!imki_ros_can_seek(log))
        text->hold = text->next;
}

imk_status imki_ros_back(imki_ros_log *log, imk_error *error)
{
    imki_log_text *text = log->text;
    log->reader->cut_short = false;
    log->reader->damaged = log->damaged_before; /* what is behind comes again */
    log->reader->first_damaged = 0;
    if (imki_ros_can_seek(log))
        return imki_log_text_seek(text, log->looked, error);
    if (text->hold)
        text->next = text->hold;
    text->hold = NULL;
    return IMK_OK;
}

imk_status imki_ros_refuse_record(const imki_ros_log *log, const char *what, const char *remedy,
                                  imk_error *error)
{
    char found[160];
    snprintf(found, sizeof found, "%s, at byte %llu", what,
             (unsigned long long)imki_log_text_place(log->text));
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found, remedy);
}

bool imki_ros_place_add(imki_ros_places *places, uint64_t place)
{
    if (places->count == places->room) {
        const size_t room = places->room > 0 ? 2 * places->room : 64;
        uint64_t *larger = realloc(places->place, room * sizeof *larger);
        if (!larger)
            return false;
        places->place = larger;
        places->room = room;
    }
    places->place[places->count++] = place;
    places->sorted = false;
    return true;
}

static int by_place(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

bool imki_ros_place_next(imki_ros_places *places, uint64_t here, uint64_t *place)
{
    size_t begin = 0, end = places->count;
    if (!places->sorted && end > 0)
        qsort(places->place, end, sizeof *places->place, by_place);
    places->sorted = true;
    while (begin < end) {
        const size_t middle = (begin + end) / 2;
        if (places->place[middle] <= here)
            begin = middle + 1;
        else
            end = middle;
    }
    if (begin < places->count)
        *place = places->place[begin];
    return begin < places->count;
}

bool imki_ros_place_find(const imki_ros_places *places, uint64_t target, uint64_t *place)
{
    bool before = false;
    for (size_t i = 0; i < places->count; i++) {
        const uint64_t at = places->place[i];
        const bool fits = at <= target;
        if (i == 0 || (fits && (!before || at > *place)) || (!fits && !before && at < *place))
            *place = at;
        before |= fits;
    }
    return places->count > 0;
}
