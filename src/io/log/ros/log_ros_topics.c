/* SPDX-License-Identifier: Apache-2.0 */
/* The channels of a log and the topics they belong to. Several channels may be one topic: each
 * publisher of a ROS 1 topic has a connection of its own, and some programs write a channel anew in
 * each chunk. */
#include "imukit/utf8.h"
#include "log_ros_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* FNV-1a. */
static uint64_t hash_bytes(uint64_t hash, imki_log_piece piece)
{
    for (const char *at = piece.begin; at < piece.end; at++)
        hash = (hash ^ (uint8_t)*at) * UINT64_C(0x100000001B3);
    return (hash ^ 0xFF) * UINT64_C(0x100000001B3);
}

/* A text for messages, shortened if need be, and without what a terminal would obey. */
static void copy_text(imki_log_piece piece, char *text, size_t size)
{
    char whole[512];
    size_t length = (size_t)(piece.end - piece.begin);
    length = length < sizeof whole - 1 ? length : sizeof whole - 1;
    for (size_t i = 0; i < length; i++)
        whole[i] =
            (unsigned char)piece.begin[i] < 32 || piece.begin[i] == 127 ? '?' : piece.begin[i];
    whole[length] = '\0';
    imk_utf8_shorten(whole, text, size);
}

static imk_status refuse_memory(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

static imk_status refuse_number(imk_error *error)
{
    char found[64];
    snprintf(found, sizeof found, "the log has more than %d topics or connections",
             IMKI_ROS_CHANNELS_MAX);
    return imk_error_set(error, IMK_ERROR_RANGE, "", found,
                         "a log of fewer topics, as rosbag filter or mcap filter writes");
}

/* Topics that are called alike, of which messages are in two encodings, are told apart by number.
 */
static void number_alike(imki_ros_log *log, imki_ros_topic *made)
{
    if (made->encoding == IMKI_ROS_OTHER)
        return;
    for (size_t i = log->topic_count; i-- > 0;) {
        imk_log_stream *other = &log->topics[i].stream;
        if (log->topics[i].encoding == IMKI_ROS_OTHER ||
            strcmp(other->name, made->stream.name) != 0)
            continue;
        if (other->instance < 0)
            other->instance = 0;
        made->stream.instance = other->instance + 1;
        return;
    }
}

imk_status imki_ros_topic_add(imki_ros_log *log, imki_log_piece name, imki_log_piece type,
                              imki_ros_encoding encoding, uint32_t *topic, imk_error *error)
{
    uint64_t hash = hash_bytes(UINT64_C(0xCBF29CE484222325), name);
    hash = hash_bytes(hash, type) + encoding;
    for (*topic = 0; *topic < log->topic_count; ++*topic)
        if (log->topics[*topic].hash == hash)
            return IMK_OK;
    if (log->topic_count == IMKI_ROS_CHANNELS_MAX)
        return refuse_number(error);
    if (log->topic_count == log->topic_room) {
        const size_t room = log->topic_room > 0 ? 2 * log->topic_room : 16;
        imki_ros_topic *larger = realloc(log->topics, room * sizeof *larger);
        if (!larger)
            return refuse_memory(error);
        log->topics = larger;
        log->topic_room = room;
    }
    imki_ros_topic *made = &log->topics[log->topic_count];
    *made = (imki_ros_topic){.hash = hash, .encoding = encoding};
    made->stream = (imk_log_stream){.instance = -1, .begin = (double)NAN, .end = (double)NAN};
    copy_text(name, made->stream.name, sizeof made->stream.name);
    copy_text(type, made->stream.kind, sizeof made->stream.kind);
    number_alike(log, made);
    log->topic_count++;
    return IMK_OK;
}

void imki_ros_topic_form(imki_ros_log *log, uint32_t topic, imki_log_piece form)
{
    copy_text(form, log->topics[topic].form, sizeof log->topics[topic].form);
}

/* Index of the first channel that is not before `id`. */
static size_t find(const imki_ros_log *log, uint32_t id)
{
    size_t begin = 0, end = log->channel_count;
    while (begin < end) {
        const size_t middle = (begin + end) / 2;
        if (log->channels[middle].id < id)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

imk_status imki_ros_channel_add(imki_ros_log *log, uint32_t id, imki_log_piece name,
                                imki_log_piece type, imki_ros_encoding encoding, uint32_t *topic,
                                imk_error *error)
{
    const imk_status status = imki_ros_topic_add(log, name, type, encoding, topic, error);
    if (status != IMK_OK)
        return status;
    const size_t at = find(log, id);
    log->last_known = false;
    if (at < log->channel_count && log->channels[at].id == id) {
        log->channels[at].topic = *topic;
        return IMK_OK;
    }
    if (log->channel_count == IMKI_ROS_CHANNELS_MAX)
        return refuse_number(error);
    if (log->channel_count == log->channel_room) {
        const size_t room = log->channel_room > 0 ? 2 * log->channel_room : 16;
        imki_ros_channel *larger = realloc(log->channels, room * sizeof *larger);
        if (!larger)
            return refuse_memory(error);
        log->channels = larger;
        log->channel_room = room;
    }
    memmove(log->channels + at + 1, log->channels + at,
            (log->channel_count - at) * sizeof *log->channels);
    log->channels[at] = (imki_ros_channel){id, *topic};
    log->channel_count++;
    return IMK_OK;
}

imki_ros_topic *imki_ros_topic_of(imki_ros_log *log, uint32_t channel)
{
    if (!log->last_known || log->last.id != channel) {
        const size_t at = find(log, channel);
        if (at == log->channel_count || log->channels[at].id != channel)
            return NULL;
        log->last = log->channels[at];
        log->last_known = true;
    }
    return &log->topics[log->last.topic];
}

void imki_ros_topic_count(imki_ros_log *log, uint32_t channel, uint64_t messages)
{
    imki_ros_topic *topic = imki_ros_topic_of(log, channel);
    if (!topic)
        return;
    const uint64_t room = UINT64_MAX - topic->stream.samples;
    topic->stream.samples += messages < room ? messages : room;
}

void imki_ros_topic_times(imki_ros_log *log, uint32_t channel, int64_t begin, int64_t end)
{
    imki_ros_topic *topic = imki_ros_topic_of(log, channel);
    if (!topic)
        return;
    imk_log_stream *stream = &topic->stream;
    const double from = (double)begin / 1e9, to = (double)end / 1e9;
    stream->begin = stream->begin <= from ? stream->begin : from;
    stream->end = stream->end >= to ? stream->end : to;
}

void imki_ros_topic_uncount(imki_ros_log *log)
{
    for (size_t i = 0; i < log->topic_count; i++) {
        log->topics[i].stream.samples = 0;
        log->topics[i].stream.begin = log->topics[i].stream.end = (double)NAN;
    }
}
