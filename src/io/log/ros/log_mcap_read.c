/* SPDX-License-Identifier: Apache-2.0 */
/* Records of MCAP files [MCAP]: a byte for the kind, eight for the length, the members. Messages
 * stand in chunks or between them, behind the schema and the channel that they belong to. */
#include "log_mcap_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>

static const char remedy[] =
    "copy the file again, or save what is whole: mcap recover OLD.mcap -o NEW.mcap";

const uint8_t *imki_mcap_take(imki_mcap_members *members, uint64_t size)
{
    const uint8_t *at = members->at;
    if (members->bad || size > (size_t)(members->end - at)) {
        members->bad = true;
        return NULL;
    }
    members->at += size;
    return at;
}

imki_log_piece imki_mcap_text(imki_mcap_members *members)
{
    const uint32_t size = imki_mcap_u32(members);
    const char *at = (const char *)imki_mcap_take(members, size);
    return at ? (imki_log_piece){at, at + size} : (imki_log_piece){"", ""};
}

/* ---- schemas and channels ---- */

static imki_mcap_schema *find_schema(const imki_mcap *mcap, uint32_t id)
{
    for (size_t i = 0; i < mcap->schema_count; i++)
        if (mcap->schemas[i].id == id)
            return &mcap->schemas[i];
    return NULL;
}

static imk_status add_schema(imki_mcap *mcap, imki_mcap_members *members, imk_error *error)
{
    const uint32_t id = imki_mcap_u16(members);
    const imki_log_piece name = imki_mcap_text(members);
    imki_mcap_schema *schema = find_schema(mcap, id);
    if (members->bad) {
        imki_log_damage(mcap->log->reader, mcap->log->rows);
        return IMK_OK;
    }
    if (mcap->schema_count == IMKI_MCAP_SCHEMAS_MAX && !schema) {
        char found[64];
        snprintf(found, sizeof found, "the log has more than %d schemas", IMKI_MCAP_SCHEMAS_MAX);
        return imk_error_set(error, IMK_ERROR_RANGE, "", found,
                             "a log of fewer topics, as mcap filter writes");
    }
    if (mcap->schema_count == mcap->schema_room && !schema) {
        const size_t room = mcap->schema_room > 0 ? 2 * mcap->schema_room : 16;
        imki_mcap_schema *larger = realloc(mcap->schemas, room * sizeof *larger);
        if (!larger)
            return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
        mcap->schemas = larger;
        mcap->schema_room = room;
    }
    schema = schema ? schema : &mcap->schemas[mcap->schema_count++];
    const size_t length = (size_t)(name.end - name.begin), most = sizeof schema->name - 1;
    schema->id = id;
    memset(schema->name, 0, sizeof schema->name);
    memcpy(schema->name, name.begin, length < most ? length : most);
    return IMK_OK;
}

/* By the encoding of the messages and the name of the schema. */
static imki_ros_encoding encoding_of(imki_log_piece encoding, const char *type)
{
    const bool imu1 = strcmp(type, "sensor_msgs/Imu") == 0;
    const bool imu2 =
        strcmp(type, "sensor_msgs/msg/Imu") == 0 || strcmp(type, "sensor_msgs::msg::Imu") == 0;
    return imu1 && imki_piece_is(encoding, "ros1")            ? IMKI_ROS_1
           : (imu1 || imu2) && imki_piece_is(encoding, "cdr") ? IMKI_ROS_CDR
                                                              : IMKI_ROS_OTHER;
}

static imk_status add_channel(imki_mcap *mcap, imki_mcap_members *members, imk_error *error)
{
    const uint32_t id = imki_mcap_u16(members), schema_id = imki_mcap_u16(members);
    const imki_log_piece topic = imki_mcap_text(members), encoding = imki_mcap_text(members);
    const imki_mcap_schema *schema = find_schema(mcap, schema_id);
    const char *type = schema ? schema->name : "";
    uint32_t index;
    if (members->bad) {
        imki_log_damage(mcap->log->reader, mcap->log->rows);
        return IMK_OK;
    }
    const imk_status status =
        imki_ros_channel_add(mcap->log, id, topic, (imki_log_piece){type, type + strlen(type)},
                             encoding_of(encoding, type), &index, error);
    if (status == IMK_OK)
        imki_ros_topic_form(mcap->log, index, encoding);
    return status;
}

imk_status imki_mcap_define(imki_mcap *mcap, const imki_mcap_record *record, imk_error *error)
{
    imki_mcap_members members = {record->data, record->data + record->size, false};
    return record->kind == IMKI_MCAP_SCHEMA ? add_schema(mcap, &members, error)
                                            : add_channel(mcap, &members, error);
}

/* ---- records ---- */

/* Have the head of a record at hand: kind and size. *found is false at the end. */
static imk_status need_head(imki_ros_log *log, imki_mcap_record *record, bool *found,
                            imk_error *error)
{
    imki_log_text *text = log->text;
    imk_status status = imki_ros_need(log, IMKI_MCAP_HEAD, found, error);
    if (status != IMK_OK || !*found)
        return status;
    const uint8_t *at = (const uint8_t *)text->next;
    *record = (imki_mcap_record){at[0], at + IMKI_MCAP_HEAD, imki_get_u64(at + 1)};
    if (record->size > UINT64_MAX - IMKI_MCAP_HEAD) {
        log->reader->cut_short = true;
        *found = false;
    }
    return IMK_OK;
}

imk_status imki_mcap_need(imki_ros_log *log, imki_mcap_record *record, bool *whole,
                          imk_error *error)
{
    if (record->size > IMKI_ROS_RECORD_MAX)
        return imki_ros_refuse_record(log, "a record is larger than 1 GiB", remedy, error);
    const imk_status status = imki_ros_need(log, IMKI_MCAP_HEAD + record->size, whole, error);
    record->data = (const uint8_t *)log->text->next + IMKI_MCAP_HEAD;
    return status;
}

/* Times beyond 292 years are no times. */
static int64_t time_of(uint64_t nanoseconds)
{
    return nanoseconds < INT64_MAX ? (int64_t)nanoseconds : INT64_MAX;
}

/* @return false: the record is damaged */
static bool give(const imki_mcap_record *record, imki_ros_message *message)
{
    enum { MEMBERS = IMKI_MCAP_MESSAGE_MEMBERS, LOG_TIME = 6 };
    if (record->size < MEMBERS)
        return false;
    *message = (imki_ros_message){.channel = imki_get_u16(record->data),
                                  .received = time_of(imki_get_u64(record->data + LOG_TIME)),
                                  .data = record->data + MEMBERS,
                                  .size = (size_t)record->size - MEMBERS};
    return true;
}

/* The record at text->next. One that comes again, or behind what was not met, changes nothing. */
static void sum_up(imki_mcap *mcap, size_t size)
{
    const imki_log_text *text = mcap->log->text;
    if (imki_log_text_place(text) != mcap->summed || (size_t)(text->end - text->next) < size)
        return;
    mcap->sum = (uint32_t)crc32_z(mcap->sum, (const uint8_t *)text->next, size);
    mcap->summed += size;
}

/* The end of the data section: the CRC-32 of all before it, or 0. */
static imk_status end_data(imki_mcap *mcap, imk_error *error)
{
    enum { ALL = IMKI_MCAP_HEAD + 4 };
    imki_ros_log *log = mcap->log;
    bool whole;
    const imk_status status = imki_ros_need(log, ALL, &whole, error);
    if (status != IMK_OK || !whole || log->looking ||
        imki_log_text_place(log->text) != mcap->summed)
        return status;
    mcap->summed = 0; /* once */
    const uint32_t sum = imki_get_u32((const uint8_t *)log->text->next + IMKI_MCAP_HEAD);
    if (sum != 0 && sum != mcap->sum)
        imki_log_damage(log->reader, log->rows);
    return IMK_OK;
}

/* Chunk: times of its first and last message, size and CRC-32 of the records in it, compression,
 * size of what follows. */
static imk_status enter_chunk(imki_mcap *mcap, imki_mcap_record *record, imk_error *error)
{
    imki_ros_log *log = mcap->log;
    bool whole = false;
    const imk_status status = imki_mcap_need(log, record, &whole, error);
    if (status != IMK_OK)
        return status;
    const size_t at_hand = (size_t)(log->text->end - log->text->next);
    const size_t all = IMKI_MCAP_HEAD + (size_t)record->size;
    imki_ros_inside *inside = &mcap->inside;
    inside->cut = !whole;
    inside->behind = whole ? all : at_hand;
    imki_mcap_members members = {record->data, (const uint8_t *)log->text->next + inside->behind,
                                 false};
    imki_mcap_take(&members, 16);
    const uint64_t due = imki_mcap_u64(&members);
    const uint32_t sum = imki_mcap_u32(&members);
    const imki_log_piece packing = imki_mcap_text(&members);
    const uint64_t size = imki_mcap_u64(&members);
    const size_t left = (size_t)(members.end - members.at);
    if (members.bad || (whole && size > left)) {
        imki_ros_leave(log, inside, true);
        return IMK_OK;
    }
    if (whole && sum == 0)
        sum_up(mcap, all);
    return imki_ros_enter(log, inside, packing, members.at, size < left ? (size_t)size : left, due,
                          sum, error);
}

/* A record of the chunk that is open. */
static imk_status next_inside(imki_mcap *mcap, imki_ros_message *message, bool *found,
                              imk_error *error)
{
    imki_ros_inside *inside = &mcap->inside;
    const size_t left = (size_t)(inside->end - inside->at);
    const uint64_t size = left >= IMKI_MCAP_HEAD ? imki_get_u64(inside->at + 1) : 0;
    if (left < IMKI_MCAP_HEAD || size > left - IMKI_MCAP_HEAD) {
        imki_ros_leave(mcap->log, inside, left > 0);
        return IMK_OK;
    }
    const imki_mcap_record record = {inside->at[0], inside->at + IMKI_MCAP_HEAD, size};
    inside->at += IMKI_MCAP_HEAD + size;
    if (record.kind == IMKI_MCAP_SCHEMA || record.kind == IMKI_MCAP_CHANNEL)
        return imki_mcap_define(mcap, &record, error);
    *found = record.kind == IMKI_MCAP_MESSAGE && give(&record, message);
    if (record.kind == IMKI_MCAP_MESSAGE && !*found)
        imki_log_damage(mcap->log->reader, mcap->log->rows);
    return IMK_OK;
}

/* A record that holds no messages; one of a kind that is not known was perhaps of another. */
static imk_status pass(imki_mcap *mcap, const imki_mcap_record *record, bool *over,
                       imk_error *error)
{
    enum { AT_HAND_MAX = 1 << 20 };
    imki_ros_log *log = mcap->log;
    const uint64_t all = IMKI_MCAP_HEAD + record->size;
    bool whole = true;
    imk_status status = IMK_OK;
    if (all <= AT_HAND_MAX)
        status = imki_ros_need(log, all, &whole, error);
    *over = !whole;
    if (status != IMK_OK || !whole)
        return status;
    if (record->kind > IMKI_MCAP_DATA_END &&
        imki_mcap_holds_messages(log, (const uint8_t *)log->text->next,
                                 (size_t)(log->text->end - log->text->next)))
        imki_log_damage(log->reader, log->rows);
    if (all <= AT_HAND_MAX)
        sum_up(mcap, (size_t)all);
    status = imki_ros_skip(log, all, &whole, error);
    *over = !whole;
    return status;
}

/* A record of the file. *over: there are no more. */
static imk_status next_outside(imki_mcap *mcap, imki_ros_message *message, bool *found, bool *over,
                               imk_error *error)
{
    imki_ros_log *log = mcap->log;
    imki_mcap_record record;
    bool there, sound, whole = false, enough = false;
    imk_status status = imki_ros_go_on(log, &sound, over, error);
    if (status != IMK_OK || !sound)
        return status;
    status = need_head(log, &record, &there, error);
    if (status == IMK_OK && there)
        imki_ros_mark(log, IMKI_MCAP_HEAD + record.size, &enough);
    *over = !there || enough;
    if (status != IMK_OK || *over)
        return status;
    switch (record.kind) {
    case IMKI_MCAP_DATA_END:
    case IMKI_MCAP_FOOTER:
        *over = true;
        return record.kind == IMKI_MCAP_DATA_END ? end_data(mcap, error) : IMK_OK;
    case IMKI_MCAP_CHUNK:
        return enter_chunk(mcap, &record, error);
    case IMKI_MCAP_SCHEMA:
    case IMKI_MCAP_CHANNEL:
    case IMKI_MCAP_MESSAGE:
        break;
    default:
        return pass(mcap, &record, over, error);
    }
    status = imki_mcap_need(log, &record, &whole, error);
    *over = !whole;
    if (status != IMK_OK || !whole)
        return status;
    if (record.kind != IMKI_MCAP_MESSAGE)
        status = imki_mcap_define(mcap, &record, error);
    else if (!(*found = give(&record, message)))
        imki_log_damage(log->reader, log->rows);
    sum_up(mcap, (size_t)(IMKI_MCAP_HEAD + record.size));
    log->text->next += IMKI_MCAP_HEAD + record.size;
    return status;
}

imk_status imki_mcap_next(imki_mcap *mcap, imki_ros_message *message, bool *found, imk_error *error)
{
    imk_status status = IMK_OK;
    *found = false;
    for (bool over = false; status == IMK_OK && !over && !*found;)
        status = mcap->inside.at ? next_inside(mcap, message, found, error)
                                 : next_outside(mcap, message, found, &over, error);
    return status;
}

imk_status imki_mcap_start(imki_mcap *mcap, imk_error *error)
{
    imki_log_text *text = mcap->log->text;
    const imk_status status = imki_log_text_need(text, IMKI_MCAP_MAGIC, error);
    if (status != IMK_OK)
        return status;
    if (text->end - text->next < IMKI_MCAP_MAGIC ||
        memcmp(text->next, IMKI_MCAP_MAGIC_TEXT, IMKI_MCAP_MAGIC) != 0)
        return imk_error_set(error, IMK_ERROR_FORMAT, "", "the file does not begin as MCAP",
                             "copy the file again");
    mcap->inside.at = NULL;
    mcap->log->places.count = 0;
    mcap->sum = (uint32_t)crc32_z(0, (const uint8_t *)text->next, IMKI_MCAP_MAGIC);
    mcap->summed = IMKI_MCAP_MAGIC;
    text->next += IMKI_MCAP_MAGIC;
    mcap->log->looked = IMKI_MCAP_MAGIC;
    return IMK_OK;
}

void imki_mcap_stop(imki_mcap *mcap)
{
    imki_ros_chunk_free(&mcap->inside.unpacked);
    free(mcap->schemas);
}
