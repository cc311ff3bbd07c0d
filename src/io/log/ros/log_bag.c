/* SPDX-License-Identifier: Apache-2.0 */
/* ROS 1 bags of version 2.0 [ROSBAG2_0]. A record is
 *
 *     length of the header, fields of the header; length of the data, data
 *     field: length, name=value
 *
 * with the field `op`: 3 the head of the bag, 5 a chunk of records, 7 a connection (a publisher of
 * a topic), 2 a message, 4 the index of a chunk, 6 where a chunk is and what is in it. Connections
 * stand in the chunks before their first message, so a bag is read from its beginning without its
 * index, which a bag that was not closed does not have. */
#include "log_bag_internal.h"
#include "log_bag_write_internal.h"

#include <stdlib.h>

enum {
    HEADER_MAX = 1 << 20,
    FIELDS_MAX = 64 /* so that no search takes long; there are up to ten */
};

/* The next field of a header. @return false: there is none, or it is damaged (*at is not end) */
static bool take_field(const uint8_t **at, const uint8_t *end, imki_log_piece *name,
                       imki_log_piece *value)
{
    if (end - *at < 4 || imki_get_u32(*at) > (size_t)(end - *at - 4))
        return false;
    const char *begin = (const char *)*at + 4;
    const size_t length = imki_get_u32(*at);
    const char *equals = length > 0 ? memchr(begin, '=', length) : NULL;
    if (!equals)
        return false;
    *name = (imki_log_piece){begin, equals};
    *value = (imki_log_piece){equals + 1, begin + length};
    *at = (const uint8_t *)begin + length;
    return true;
}

static bool take_header(const uint8_t *at, size_t size, imki_bag_header *header)
{
    const struct {
        const char *name;
        uint64_t *number;
        size_t size;
        imki_log_piece *text;
    } known[] = {{"op", &header->op, 1, NULL},
                 {"conn", &header->connection, 4, NULL},
                 {"time", &header->time, 8, NULL},
                 {"topic", NULL, 0, &header->topic},
                 {"compression", NULL, 0, &header->compression},
                 {"size", &header->size, 4, NULL},
                 {"index_pos", &header->index_place, 8, NULL},
                 {"conn_count", &header->connections, 4, NULL},
                 {"chunk_count", &header->chunks, 4, NULL},
                 {"encryptor", NULL, 0, &header->encryptor},
                 {"chunk_pos", &header->chunk_place, 8, NULL},
                 {"start_time", &header->begin, 8, NULL},
                 {"end_time", &header->end, 8, NULL},
                 {"count", &header->count, 4, NULL},
                 {"type", NULL, 0, &header->type},
                 {"md5sum", NULL, 0, &header->digest}};
    const uint8_t *end = at + size;
    imki_log_piece name, value;
    *header = (imki_bag_header){.connection = IMKI_BAG_NO_CONNECTION};
    for (int left = FIELDS_MAX; left > 0 && take_field(&at, end, &name, &value); left--) {
        const size_t length = (size_t)(value.end - value.begin);
        const uint8_t *bytes = (const uint8_t *)value.begin;
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
            if (!imki_piece_is(name, known[i].name))
                continue;
            if (known[i].text)
                *known[i].text = value;
            else if (length != known[i].size)
                return false;
            else
                *known[i].number = length == 8   ? imki_get_u64(bytes)
                                   : length == 4 ? imki_get_u32(bytes)
                                                 : bytes[0];
            break;
        }
    }
    return at == end;
}

bool imki_bag_record_take(const uint8_t *at, size_t size, bool whole, imki_bag_record *record)
{
    if (size < 4 || imki_get_u32(at) > size - 4)
        return false;
    const size_t header = imki_get_u32(at);
    if (size - 4 - header < 4 || !take_header(at + 4, header, &record->header))
        return false;
    record->data = at + 4 + header + 4;
    record->size = imki_get_u32(record->data - 4);
    record->head = 4 + header + 4;
    return !whole || record->size <= size - record->head;
}

/* ---- records ---- */

imk_status imki_bag_connection(imki_ros_log *log, const imki_bag_record *record, imk_error *error)
{
    imki_bag_header about;
    uint32_t topic;
    if (record->size > UINT32_MAX || !take_header(record->data, (size_t)record->size, &about) ||
        record->header.connection > UINT32_MAX || about.type.begin == about.type.end) {
        imki_log_damage(log->reader, log->rows);
        return IMK_OK;
    }
    const bool imu =
        imki_piece_is(about.type, "sensor_msgs/Imu") &&
        (imki_piece_is(about.digest, imki_ros1_imu_digest) || imki_piece_is(about.digest, "*"));
    return imki_ros_channel_add(log, (uint32_t)record->header.connection, record->header.topic,
                                about.type, imu ? IMKI_ROS_1 : IMKI_ROS_OTHER, &topic, error);
}

static void give(const imki_bag_record *record, imki_ros_message *message)
{
    *message = (imki_ros_message){.channel = (uint32_t)record->header.connection,
                                  .received = imki_bag_time(record->header.time),
                                  .data = record->data,
                                  .size = (size_t)record->size};
}

static const imki_ros_shape none = {.due = 0};

static imki_ros_shape chunk_shape(const imki_bag_record *record, bool strict)
{
    enum { CHUNK = 2 };
    const imki_ros_packing packing = imki_ros_packing_named(record->header.compression);
    const bool plain = packing == IMKI_ROS_PLAIN;
    if (!record->header.compression.begin || (plain && record->size != record->header.size) ||
        (!plain && record->size > IMKI_ROS_RECORD_MAX) ||
        (strict && packing == IMKI_ROS_PACKING_UNKNOWN))
        return none;
    return (imki_ros_shape){.size = record->head + record->size, .weight = CHUNK, .proven = plain};
}

/* @param at_hand  of the data, too */
static imki_ros_shape connection_shape(const imki_bag_record *record, size_t at_hand)
{
    enum { LINKED = 3, DATA_MAX = 1 << 20 };
    const uint64_t all = record->head + record->size;
    imki_bag_header about;
    if (record->header.connection > UINT32_MAX || record->size > DATA_MAX)
        return none;
    if (all > at_hand)
        return (imki_ros_shape){.due = (size_t)all};
    if (!take_header(record->data, (size_t)record->size, &about) || !about.type.begin)
        return none;
    return (imki_ros_shape){.size = all, .weight = LINKED, .proven = true};
}

/* As imki_ros_container.shape. */
static imki_ros_shape shape(imki_ros_log *log, const uint8_t *at, size_t at_hand, bool strict)
{
    enum { LEAST = 8, INDEX_ENTRY = 12, INFO_ENTRY = 8 }; /* a field "op=" and its length */
    const uint32_t header = imki_get_u32(at);
    imki_bag_record record;
    if (header < LEAST || header > HEADER_MAX || imki_get_u32(at + 4) > header - 4)
        return none;
    if (at_hand < (size_t)header + 8)
        return (imki_ros_shape){.due = (size_t)header + 8};
    if (!imki_bag_record_take(at, at_hand, false, &record))
        return none;
    const imki_bag_header *h = &record.header;
    const bool index = h->op == IMKI_BAG_INDEX, info = h->op == IMKI_BAG_CHUNK_INFO;
    const bool message = h->op == IMKI_BAG_MESSAGE;
    if (h->op == IMKI_BAG_CHUNK)
        return chunk_shape(&record, strict);
    if (h->op == IMKI_BAG_CONNECTION)
        return connection_shape(&record, at_hand);
    if ((index || info) && record.size != h->count * (index ? INDEX_ENTRY : INFO_ENTRY))
        return none;
    if (h->op == IMKI_BAG_HEAD && (h->connection <= UINT32_MAX || h->compression.begin))
        return none;
    if (message && (h->connection > UINT32_MAX || record.size > IMKI_ROS_RECORD_MAX))
        return none;
    if (message)
        return imki_ros_message_shape(log, (uint32_t)h->connection, at, at_hand, record.head,
                                      record.size, strict);
    return (imki_ros_shape){.size = record.head + record.size,
                            .weight = index || info || !strict,
                            .proven = index || info};
}

imk_status imki_bag_head(imki_ros_log *log, imki_bag_record *record, bool *found, imk_error *error)
{
    static const char remedy[] = "copy the file again, or mend it: rosbag fix OLD.bag NEW.bag";
    imki_log_text *text = log->text;
    bool whole;
    *found = false;
    imk_status status = imki_log_text_need(text, 4, error);
    if (status != IMK_OK || text->end == text->next)
        return status;
    status = imki_ros_need(log, 4, &whole, error);
    if (status != IMK_OK || !whole)
        return status;
    const uint32_t header = imki_get_u32((const uint8_t *)text->next);
    if (header > HEADER_MAX)
        return imki_ros_refuse_record(log, "the header of a record is damaged", remedy, error);
    status = imki_ros_need(log, (uint64_t)header + 8, &whole, error);
    if (status != IMK_OK || !whole)
        return status;
    if (!imki_bag_record_take((const uint8_t *)text->next, (size_t)(text->end - text->next), false,
                              record))
        return imki_ros_refuse_record(log, "the header of a record is damaged", remedy, error);
    *found = true;
    return IMK_OK;
}

/* Have the data of a record at hand, of which the head is. @param whole  or as much as there is */
static imk_status need_data(imki_ros_log *log, imki_bag_record *record, bool *whole,
                            imk_error *error)
{
    const uint8_t *data = record->data;
    const imk_status status = imki_ros_need(log, record->head + record->size, whole, error);
    const uint8_t *at = (const uint8_t *)log->text->next;
    const size_t at_hand = (size_t)(log->text->end - log->text->next);
    if (status == IMK_OK && data != at + record->head) /* the window has moved */
        imki_bag_record_take(at, at_hand, false, record);
    return status;
}

static imk_status enter_chunk(imki_bag *bag, imki_bag_record *record, imk_error *error)
{
    imki_ros_log *log = &bag->log;
    bool whole;
    if (record->size > IMKI_ROS_RECORD_MAX)
        return imki_ros_refuse_record(log, "a chunk is larger than 1 GiB",
                                      "a bag of smaller chunks", error);
    const imk_status status = need_data(log, record, &whole, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(log->text->end - log->text->next);
    const size_t all = record->head + (size_t)record->size;
    bag->inside.cut = !whole;
    bag->inside.behind = whole ? all : at_hand;
    return imki_ros_enter(log, &bag->inside, record->header.compression, record->data,
                          (size_t)bag->inside.behind - record->head, record->header.size, 0, error);
}

/* A record of the chunk that is open. */
static imk_status next_inside(imki_bag *bag, imki_ros_message *message, bool *found,
                              imk_error *error)
{
    imki_ros_inside *inside = &bag->inside;
    imki_bag_record record;
    const size_t left = (size_t)(inside->end - inside->at);
    if (left == 0 || !imki_bag_record_take(inside->at, left, true, &record)) {
        imki_ros_leave(&bag->log, inside, left > 0);
        return IMK_OK;
    }
    inside->at += record.head + record.size;
    *found = record.header.op == IMKI_BAG_MESSAGE;
    if (*found)
        give(&record, message);
    else if (record.header.op != IMKI_BAG_CONNECTION)
        imki_log_damage(bag->log.reader, bag->log.rows);
    return record.header.op == IMKI_BAG_CONNECTION ? imki_bag_connection(&bag->log, &record, error)
                                                   : IMK_OK;
}

/* Records that hold no messages. What another one held is lost. */
static bool may_be_passed(uint64_t op)
{
    return op == IMKI_BAG_HEAD || op == IMKI_BAG_INDEX || op == IMKI_BAG_CHUNK_INFO;
}

/* A record of the file. *over: there are no more. */
static imk_status next_outside(imki_bag *bag, imki_ros_message *message, bool *found, bool *over,
                               imk_error *error)
{
    imki_ros_log *log = &bag->log;
    imki_bag_record record;
    bool there, sound, whole = true, enough = false;
    imk_status status = imki_ros_go_on(log, &sound, over, error);
    if (status != IMK_OK || !sound)
        return status;
    status = imki_bag_head(log, &record, &there, error);
    if (status == IMK_OK && there)
        imki_ros_mark(log, record.head + record.size, &enough);
    *over = !there || enough;
    if (!there && imki_log_text_place(log->text) < bag->index_place)
        log->reader->cut_short = true;
    if (status != IMK_OK || *over)
        return status;
    if (record.header.op == IMKI_BAG_CHUNK)
        return enter_chunk(bag, &record, error);
    const bool message_found = record.header.op == IMKI_BAG_MESSAGE;
    if (!message_found && record.header.op != IMKI_BAG_CONNECTION) {
        if (!may_be_passed(record.header.op))
            imki_log_damage(log->reader, log->rows);
        status = imki_ros_skip(log, record.head + record.size, &whole, error);
        *over = !whole;
        return status;
    }
    status = need_data(log, &record, &whole, error);
    *over = !whole;
    if (status != IMK_OK || !whole)
        return status;
    if (message_found)
        give(&record, message);
    else
        status = imki_bag_connection(log, &record, error);
    *found = message_found;
    log->text->next += record.head + record.size;
    return status;
}

static imk_status next(imki_ros_log *log, imki_ros_message *message, bool *found, imk_error *error)
{
    imki_bag *bag = (imki_bag *)log;
    imk_status status = IMK_OK;
    *found = false;
    for (bool over = false; status == IMK_OK && !over && !*found;)
        status = bag->inside.at ? next_inside(bag, message, found, error)
                                : next_outside(bag, message, found, &over, error);
    return status;
}

static imk_status back(imki_ros_log *log, imk_error *error)
{
    ((imki_bag *)log)->inside.at = NULL;
    return imki_ros_back(log, error);
}

/* ---- the codec ---- */

static imk_status open_bag(imk_log_reader *reader, imk_error *error)
{
    static const imki_ros_container container = {next, back, shape};
    enum { MAGIC = 13 };
    imki_log_text *text = &reader->text;
    imki_bag_record record;
    bool found;
    imki_bag *bag = calloc(1, sizeof *bag);
    reader->state = bag;
    if (!bag)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    bag->log = (imki_ros_log){.container = &container, .reader = reader, .text = text};
    if (text->end - text->next < MAGIC || memcmp(text->next, "#ROSBAG V2.0\n", MAGIC) != 0)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "the bag is not of version 2.0",
                             "bring it to version 2.0: rosbag fix OLD.bag NEW.bag");
    text->next += MAGIC;
    /* Without its head, a bag is read as one that was not closed. */
    imk_status status = imki_bag_head_or_end(&bag->log, &record, &found, error);
    if (status != IMK_OK)
        return status;
    if (!found || record.header.op != IMKI_BAG_HEAD)
        record.header = (imki_bag_header){0};
    const imki_log_piece cipher = record.header.encryptor;
    if (cipher.end > cipher.begin && !imki_piece_is(cipher, "rosbag/NoEncryptor"))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "the bag is encrypted",
                             "decrypt it: rosbag decompress FILE.bag");
    bag->first = imki_log_text_place(text);
    bag->log.looked = bag->first;
    bag->index_place = record.header.index_place;
    if (imki_ros_can_seek(&bag->log))
        status = imki_bag_index_read(bag, &record.header, error);
    return status == IMK_OK ? imki_ros_open(&bag->log, error) : status;
}

static void close_bag(imk_log_reader *reader)
{
    imki_bag *bag = reader->state;
    if (!bag)
        return;
    imki_ros_chunk_free(&bag->inside.unpacked);
    imki_ros_close(&bag->log);
}

const imki_log_codec imki_log_bag = {.defines_units = true,
                                     .open = open_bag,
                                     .read = imki_ros_read,
                                     .close = close_bag,
                                     .seek = imki_bag_seek,
                                     .create = imki_bag_create,
                                     .begin = imki_bag_begin,
                                     .format = imki_log_format_matrix,
                                     .write = imki_bag_write,
                                     .end = imki_bag_end,
                                     .discard = imki_bag_discard};
