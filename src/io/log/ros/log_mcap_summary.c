/* SPDX-License-Identifier: Apache-2.0 */
/* The summary at the end of an MCAP file [MCAP]: schemas and channels again, numbers of messages,
 * and where each chunk is. The footer, of a fixed size before the last magic, says where it begins.
 */
#include "log_mcap_internal.h"

#include <zlib.h>

enum {
    FOOTER = 20,
    TAIL = IMKI_MCAP_HEAD + FOOTER + IMKI_MCAP_MAGIC,
    SUMMED = IMKI_MCAP_HEAD + 16
};

/* Where the summary begins; 0: there is none. */
static imk_status find_summary(imki_mcap *mcap, uint64_t *begin, uint64_t *end, uint32_t *sum,
                               imk_error *error)
{
    imki_ros_log *log = mcap->log;
    imki_log_text *text = log->text;
    const uint64_t size = imki_ros_size(log);
    *begin = 0;
    if (size < IMKI_MCAP_MAGIC + TAIL)
        return IMK_OK;
    imk_status status = imki_log_text_seek(text, size - TAIL, error);
    if (status == IMK_OK)
        status = imki_log_text_need(text, TAIL, error);
    const uint8_t *at = (const uint8_t *)text->next;
    if (status != IMK_OK || text->end - text->next < TAIL || at[0] != IMKI_MCAP_FOOTER ||
        imki_get_u64(at + 1) != FOOTER ||
        memcmp(at + TAIL - IMKI_MCAP_MAGIC, IMKI_MCAP_MAGIC_TEXT, IMKI_MCAP_MAGIC) != 0)
        return status;
    const uint64_t place = imki_get_u64(at + IMKI_MCAP_HEAD);
    *end = size - TAIL;
    *sum = imki_get_u32(at + SUMMED);
    if (place >= IMKI_MCAP_MAGIC && place < *end)
        *begin = place;
    return IMK_OK;
}

static bool take_statistics(imki_mcap *mcap, const imki_mcap_record *record)
{
    enum { BEFORE = 8 + 2 + 4 * 4 + 2 * 8 }; /* numbers of records, first and last time */
    imki_mcap_members m = {record->data, record->data + record->size, false};
    const uint64_t messages = imki_mcap_u64(&m);
    imki_mcap_take(&m, BEFORE - 8);
    const uint32_t size = imki_mcap_u32(&m);
    const uint8_t *map = imki_mcap_take(&m, size);
    imki_mcap_members counts = {map, map ? map + size : map, false};
    uint64_t counted = 0;
    while (!m.bad && counts.at < counts.end) {
        const uint16_t channel = imki_mcap_u16(&counts);
        const uint64_t count = imki_mcap_u64(&counts);
        if (counts.bad || !imki_ros_topic_of(mcap->log, channel))
            return false;
        imki_ros_topic_count(mcap->log, channel, count);
        counted += count;
    }
    return !m.bad && counted == messages;
}

/* Times and place of a chunk, and whose messages are in it. */
static bool take_chunk(imki_mcap *mcap, const imki_mcap_record *record, bool *memory)
{
    imki_mcap_members m = {record->data, record->data + record->size, false};
    const uint64_t begin = imki_mcap_u64(&m), end = imki_mcap_u64(&m), place = imki_mcap_u64(&m);
    imki_mcap_take(&m, 8);
    const uint32_t size = imki_mcap_u32(&m);
    const uint8_t *map = imki_mcap_take(&m, size);
    if (m.bad || begin > INT64_MAX || end > INT64_MAX)
        return false;
    for (imki_mcap_members channels = {map, map + size, false}; channels.at < channels.end;) {
        const uint16_t channel = imki_mcap_u16(&channels);
        imki_mcap_take(&channels, 8);
        if (channels.bad)
            return false;
        imki_ros_topic_times(mcap->log, channel, (int64_t)begin, (int64_t)end);
    }
    *memory = *memory && imki_ros_place_add(&mcap->log->places, place);
    return true;
}

/* What a look at all records of the summary found. */
typedef struct summary {
    uint64_t begin, end;
    bool definitions; /* look for schemas and channels; else for numbers */
    bool intact, counted, memory;
    uint32_t sum;
} summary;

static imk_status take_record(imki_mcap *mcap, const imki_mcap_record *record, summary *s,
                              imk_error *error)
{
    const bool defines = record->kind == IMKI_MCAP_SCHEMA || record->kind == IMKI_MCAP_CHANNEL;
    if (s->definitions && defines)
        return imki_mcap_define(mcap, record, error);
    if (!s->definitions && record->kind == IMKI_MCAP_STATISTICS)
        s->counted = s->intact = s->intact && take_statistics(mcap, record);
    if (!s->definitions && record->kind == IMKI_MCAP_CHUNK_INDEX)
        s->intact = s->intact && take_chunk(mcap, record, &s->memory);
    return s->memory ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

static imk_status look(imki_mcap *mcap, summary *s, imk_error *error)
{
    imki_ros_log *log = mcap->log;
    imki_log_text *text = log->text;
    imk_status status = imki_log_text_seek(text, s->begin, error);
    while (status == IMK_OK && s->intact && imki_log_text_place(text) < s->end) {
        const uint64_t left = s->end - imki_log_text_place(text);
        imki_mcap_record record;
        status = imki_log_text_need(text, IMKI_MCAP_HEAD, error);
        if (status != IMK_OK || text->end - text->next < IMKI_MCAP_HEAD)
            break;
        const uint8_t *at = (const uint8_t *)text->next;
        record = (imki_mcap_record){.kind = at[0], .size = imki_get_u64(at + 1)};
        s->intact = left >= IMKI_MCAP_HEAD && record.size <= left - IMKI_MCAP_HEAD &&
                    record.size <= IMKI_ROS_RECORD_MAX;
        if (!s->intact)
            break;
        status = imki_mcap_need(log, &record, &s->intact, error);
        if (status != IMK_OK || !s->intact)
            break;
        const size_t all = IMKI_MCAP_HEAD + (size_t)record.size;
        if (s->definitions)
            s->sum = (uint32_t)crc32_z(s->sum, (const uint8_t *)text->next, all);
        status = take_record(mcap, &record, s, error);
        text->next += all;
    }
    return status;
}

/* Definitions first, as they may stand behind the numbers. */
static imk_status look_twice(imki_mcap *mcap, summary *s, uint32_t due, imk_error *error)
{
    s->definitions = true;
    imk_status status = look(mcap, s, error);
    if (status == IMK_OK && s->intact)
        status = imki_log_text_need(mcap->log->text, SUMMED, error);
    if (status == IMK_OK && s->intact && mcap->log->text->end - mcap->log->text->next >= SUMMED)
        s->sum = (uint32_t)crc32_z(s->sum, (const uint8_t *)mcap->log->text->next, SUMMED);
    s->intact = s->intact && (due == 0 || due == s->sum);
    s->definitions = false;
    return status == IMK_OK && s->intact ? look(mcap, s, error) : status;
}

imk_status imki_mcap_summary_read(imki_mcap *mcap, bool *intact, imk_error *error)
{
    imki_ros_log *log = mcap->log;
    summary s = {.intact = true, .memory = true};
    uint32_t due = 0;
    mcap->log->places.count = 0;
    imk_status status = find_summary(mcap, &s.begin, &s.end, &due, error);
    if (status == IMK_OK && s.begin > 0)
        status = look_twice(mcap, &s, due, error);
    *intact = s.begin > 0 && s.intact && s.counted;
    if (!s.intact)
        mcap->log->places.count = 0;
    log->reader->cut_short = false;
    log->reader->damaged = log->reader->first_damaged = 0;
    return status == IMK_OK ? imki_log_text_seek(log->text, IMKI_MCAP_MAGIC, error) : status;
}

/* Without an index: from record to record. */
static imk_status walk(imki_mcap *mcap, uint64_t target, uint64_t *place, imk_error *error)
{
    imki_ros_log *log = mcap->log;
    bool there = true;
    imk_status status = imki_log_text_seek(log->text, IMKI_MCAP_MAGIC, error);
    *place = IMKI_MCAP_MAGIC;
    while (status == IMK_OK && there) {
        status = imki_log_text_need(log->text, IMKI_MCAP_HEAD, error);
        if (status != IMK_OK || log->text->end - log->text->next < IMKI_MCAP_HEAD)
            break;
        const uint8_t *at = (const uint8_t *)log->text->next;
        const uint64_t here = imki_log_text_place(log->text), size = imki_get_u64(at + 1);
        if (at[0] == 0 || at[0] == IMKI_MCAP_FOOTER || at[0] == IMKI_MCAP_DATA_END ||
            size > UINT64_MAX / 2)
            break;
        if (at[0] == IMKI_MCAP_CHUNK || at[0] == IMKI_MCAP_MESSAGE)
            *place = here;
        if (here + IMKI_MCAP_HEAD + size > target)
            break;
        status = imki_ros_skip(log, IMKI_MCAP_HEAD + size, &there, error);
    }
    return status;
}

imk_status imki_mcap_go(imki_mcap *mcap, double fraction, imk_error *error)
{
    imki_ros_log *log = mcap->log;
    if (!imki_ros_can_seek(log))
        return imki_log_text_seek(log->text, 0, error);
    const uint64_t target = (uint64_t)(fraction * (double)imki_ros_size(log));
    uint64_t place;
    imk_status status = IMK_OK;
    if (!imki_ros_place_find(&mcap->log->places, target, &place))
        status = walk(mcap, target, &place, error);
    mcap->inside.at = NULL;
    log->moved = true;
    return status == IMK_OK ? imki_log_text_seek(log->text, place, error) : status;
}
