/* SPDX-License-Identifier: Apache-2.0 */
/* Records of ROS 1 bags. */
#ifndef IMUKIT_LOG_BAG_INTERNAL_H
#define IMUKIT_LOG_BAG_INTERNAL_H

#include "log_ros_internal.h"

/* Field `op` of records. */
enum {
    IMKI_BAG_MESSAGE = 2,
    IMKI_BAG_HEAD = 3,
    IMKI_BAG_INDEX = 4,
    IMKI_BAG_CHUNK = 5,
    IMKI_BAG_CHUNK_INFO = 6,
    IMKI_BAG_CONNECTION = 7
};
#define IMKI_BAG_NO_CONNECTION UINT64_MAX

/* The fields of the header of a record, 0 and empty where not there; the connection is then
 * IMKI_BAG_NO_CONNECTION. */
typedef struct imki_bag_header {
    uint64_t op, connection, time, size;
    uint64_t index_place, connections, chunks; /* of the head of the bag */
    uint64_t chunk_place, begin, end, count;   /* of where a chunk is */
    imki_log_piece topic, compression, encryptor, type, digest;
} imki_bag_header;

typedef struct imki_bag_record {
    imki_bag_header header;
    const uint8_t *data;
    uint64_t size; /* of the data */
    size_t head;   /* bytes before the data */
} imki_bag_record;

typedef struct imki_bag {
    imki_ros_log log;
    imki_ros_inside inside;
    uint64_t index_place; /* by its head; 0: it was not closed */
    uint64_t first;       /* place of the first record behind the head */
} imki_bag;

/* Seconds and nanoseconds, as one number of 8 bytes, in nanoseconds. */
static inline int64_t imki_bag_time(uint64_t value)
{
    return (int64_t)(value & UINT32_MAX) * 1000000000 + (int64_t)(value >> 32);
}

/* @param whole  the data must be there, too */
bool imki_bag_record_take(const uint8_t *at, size_t size, bool whole, imki_bag_record *record);
/* Have the head of a record at hand; *found is false at the end. */
imk_status imki_bag_head(imki_ros_log *log, imki_bag_record *record, bool *found, imk_error *error);
/* As before; a damaged record is the end, where it is no matter to tell. */
imk_status imki_bag_head_or_end(imki_ros_log *log, imki_bag_record *record, bool *there,
                                imk_error *error);
imk_status imki_bag_connection(imki_ros_log *log, const imki_bag_record *record, imk_error *error);

/* log_bag_index.c: topics, numbers of messages and places of chunks, if the bag has an index; the
 * text is back at the first record. And imki_log_codec.seek. */
imk_status imki_bag_index_read(imki_bag *bag, const imki_bag_header *head, imk_error *error);
imk_status imki_bag_seek(imk_log_reader *reader, double fraction, imk_error *error);

#endif
