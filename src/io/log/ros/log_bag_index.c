/* SPDX-License-Identifier: Apache-2.0 */
/* The index at the end of a ROS 1 bag [ROSBAG2_0]: all connections; then of each chunk its place,
 * the times of its first and last message, and the number of messages of each connection. */
#include "log_bag_internal.h"

/* @return false: the record is damaged */
static bool take_chunk(imki_bag *bag, const imki_bag_record *record, imk_status *status,
                       imk_error *error)
{
    const imki_bag_header *h = &record->header;
    if (record->size / 8 != h->count || record->size % 8 != 0)
        return false;
    for (uint64_t i = 0; i < h->count; i++) {
        const uint32_t connection = imki_get_u32(record->data + 8 * i);
        if (!imki_ros_topic_of(&bag->log, connection))
            return false;
        imki_ros_topic_count(&bag->log, connection, imki_get_u32(record->data + 8 * i + 4));
        imki_ros_topic_times(&bag->log, connection, imki_bag_time(h->begin), imki_bag_time(h->end));
    }
    if (!imki_ros_place_add(&bag->log.places, h->chunk_place))
        *status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    return true;
}

imk_status imki_bag_head_or_end(imki_ros_log *log, imki_bag_record *record, bool *there,
                                imk_error *error)
{
    imk_error reason = {.status = IMK_OK};
    const imk_status status = imki_bag_head(log, record, there, &reason);
    if (status != IMK_OK && status != IMK_ERROR_FORMAT && error)
        *error = reason;
    return status == IMK_ERROR_FORMAT ? IMK_OK : status;
}

/* @param intact  the record is there and makes sense */
static imk_status take_record(imki_bag *bag, uint64_t op, bool *intact, imk_error *error)
{
    imki_ros_log *log = &bag->log;
    imki_bag_record record;
    bool whole = false;
    *intact = false;
    imk_status status = imki_bag_head_or_end(log, &record, &whole, error);
    if (status != IMK_OK || !whole || record.header.op != op || record.size > 1 << 24)
        return status;
    status = imki_ros_need(log, record.head + record.size, &whole, error);
    if (status != IMK_OK || !whole)
        return status;
    imki_bag_record_take((const uint8_t *)log->text->next,
                         (size_t)(log->text->end - log->text->next), true, &record);
    *intact = true;
    if (op == IMKI_BAG_CONNECTION)
        status = imki_bag_connection(log, &record, error);
    else
        *intact = take_chunk(bag, &record, &status, error);
    log->text->next += record.head + record.size;
    return status;
}

imk_status imki_bag_index_read(imki_bag *bag, const imki_bag_header *head, imk_error *error)
{
    imki_ros_log *log = &bag->log;
    const uint64_t connections = head->connections, chunks = head->chunks;
    bool intact = head->index_place > bag->first && head->index_place < imki_ros_size(log);
    imk_status status = IMK_OK;
    if (intact)
        status = imki_log_text_seek(log->text, head->index_place, error);
    for (uint64_t i = 0; i < connections && intact && status == IMK_OK; i++)
        status = take_record(bag, IMKI_BAG_CONNECTION, &intact, error);
    for (uint64_t i = 0; i < chunks && intact && status == IMK_OK; i++)
        status = take_record(bag, IMKI_BAG_CHUNK_INFO, &intact, error);
    intact = intact && imki_log_text_place(log->text) == imki_ros_size(log);
    log->indexed = log->counted = intact;
    log->reader->cut_short = false;
    log->reader->damaged = log->reader->first_damaged = 0;
    if (!intact) {
        imki_ros_topic_uncount(log);
        bag->log.places.count = 0;
    }
    return status == IMK_OK ? imki_log_text_seek(log->text, bag->first, error) : status;
}

/* Without an index: from record to record. */
static imk_status walk(imki_bag *bag, uint64_t target, uint64_t *place, imk_error *error)
{
    imki_ros_log *log = &bag->log;
    imki_bag_record record;
    bool there = true;
    imk_status status = imki_log_text_seek(log->text, bag->first, error);
    *place = bag->first;
    while (status == IMK_OK && there) {
        status = imki_bag_head_or_end(log, &record, &there, error);
        if (status != IMK_OK || !there)
            break;
        if (record.header.op == IMKI_BAG_CHUNK || record.header.op == IMKI_BAG_MESSAGE)
            *place = imki_log_text_place(log->text);
        if (imki_log_text_place(log->text) + record.head + record.size > target)
            break;
        status = imki_ros_skip(log, record.head + record.size, &there, error);
    }
    return status;
}

imk_status imki_bag_seek(imk_log_reader *reader, double fraction, imk_error *error)
{
    imki_bag *bag = (imki_bag *)imki_ros_log_of(reader);
    if (!imki_ros_can_seek(&bag->log))
        return imki_log_text_seek(&reader->text, 0, error);
    const uint64_t target = (uint64_t)(fraction * (double)imki_ros_size(&bag->log));
    uint64_t place;
    imk_status status = IMK_OK;
    if (!imki_ros_place_find(&bag->log.places, target, &place))
        status = walk(bag, target, &place, error);
    bag->inside.at = NULL;
    bag->log.moved = true;
    return status == IMK_OK ? imki_log_text_seek(&reader->text, place, error) : status;
}
