/* SPDX-License-Identifier: Apache-2.0 */
/* ROS 1 bags, written as a recorder that was closed leaves them [ROSBAG2_0]: chunks without
 * compression, each followed by the times and places of its messages; the index at the end; and at
 * the beginning where that is. */
#include "log_bag_write_internal.h"

#include "io/file/output_file_internal.h"
#include "log_bag_internal.h"

#include <stdlib.h>

enum { MAGIC = 13, HEAD_SIZE = 4096, CHUNK = IMKI_ROS_CHUNK_WRITTEN };

typedef struct bag_writer {
    imki_ros_writer writer;
    imki_ros_gathered chunk;  /* records of the open chunk */
    imki_ros_gathered places; /* of its messages */
    imki_ros_gathered index;  /* records at the end of the bag */
    uint64_t place;           /* bytes written */
    uint64_t begin, end;      /* times of the open chunk */
    uint32_t messages, chunks;
    bool connected; /* the connection stands in a chunk */
} bag_writer;

/* ---- records ---- */

static void put_field(imki_ros_gathered *to, const char *name, const void *value, size_t size)
{
    uint8_t length[4];
    imki_put_u32(length, (uint32_t)(strlen(name) + 1 + size));
    imki_ros_gather_bytes(to, length, 4);
    imki_ros_gather_bytes(to, name, strlen(name));
    imki_ros_gather_bytes(to, "=", 1);
    imki_ros_gather_bytes(to, value, size);
}

static void put_text(imki_ros_gathered *to, const char *name, const char *value)
{
    put_field(to, name, value, strlen(value));
}

static void put_number(imki_ros_gathered *to, const char *name, uint64_t value, size_t size)
{
    uint8_t bytes[8];
    imki_put_u64(bytes, value);
    put_field(to, name, bytes, size);
}

/* A length that is known later. @return where it is */
static size_t open_length(imki_ros_gathered *to)
{
    imki_ros_gather_bytes(to, "\0\0\0", 4);
    return to->size;
}

static void close_length(imki_ros_gathered *to, size_t begin)
{
    if (!to->failed)
        imki_put_u32(to->bytes + begin - 4, (uint32_t)(to->size - begin));
}

static void put_connection(imki_ros_gathered *to)
{
    size_t length = open_length(to);
    put_number(to, "conn", 0, 4);
    put_number(to, "op", IMKI_BAG_CONNECTION, 1);
    put_text(to, "topic", IMKI_ROS_TOPIC);
    close_length(to, length);
    length = open_length(to);
    put_text(to, "topic", IMKI_ROS_TOPIC);
    put_text(to, "type", "sensor_msgs/Imu");
    put_text(to, "md5sum", imki_ros1_imu_digest);
    put_text(to, "message_definition", imki_ros1_imu_definition);
    close_length(to, length);
}

/* Seconds in the first four bytes, nanoseconds in the others. */
static uint64_t bag_time(int64_t stamp)
{
    return (uint64_t)stamp / 1000000000 | (uint64_t)stamp % 1000000000 << 32;
}

static void put_message(bag_writer *bag, const imki_imu *imu)
{
    uint8_t data[IMKI_ROS_IMU_MAX], entry[12];
    const uint32_t sequence = (uint32_t)(bag->writer.rows - 1);
    const size_t size = imki_ros_imu_write(IMKI_ROS_1, imu, sequence, data);
    const uint64_t time = bag_time(imu->stamp);
    imki_put_u32(imki_put_u64(entry, time), (uint32_t)bag->chunk.size);
    imki_ros_gather_bytes(&bag->places, entry, sizeof entry);
    size_t length = open_length(&bag->chunk);
    put_number(&bag->chunk, "conn", 0, 4);
    put_number(&bag->chunk, "op", IMKI_BAG_MESSAGE, 1);
    put_number(&bag->chunk, "time", time, 8);
    close_length(&bag->chunk, length);
    length = open_length(&bag->chunk);
    imki_ros_gather_bytes(&bag->chunk, data, size);
    close_length(&bag->chunk, length);
    /* By their numbers, as the times of a log may go back. */
    const bool first = bag->messages++ == 0;
    if (first || imki_bag_time(time) < imki_bag_time(bag->begin))
        bag->begin = time;
    if (first || imki_bag_time(time) > imki_bag_time(bag->end))
        bag->end = time;
}

static imk_status put(imki_log_output *log, const imki_ros_gathered *bytes)
{
    bag_writer *bag = log->state;
    if (bytes->failed)
        return IMK_ERROR_MEMORY;
    bag->place += bytes->size;
    return imk_output_file_write(log->file, bytes->bytes, bytes->size);
}

/* ---- chunks ---- */

static imk_status close_chunk(imki_log_output *log)
{
    bag_writer *bag = log->state;
    imki_ros_gathered head = {.bytes = NULL}, index = {.bytes = NULL};
    if (bag->messages == 0)
        return IMK_OK;
    size_t length = open_length(&bag->index);
    put_number(&bag->index, "chunk_pos", bag->place, 8);
    put_number(&bag->index, "count", 1, 4);
    put_number(&bag->index, "end_time", bag->end, 8);
    put_number(&bag->index, "op", IMKI_BAG_CHUNK_INFO, 1);
    put_number(&bag->index, "start_time", bag->begin, 8);
    put_number(&bag->index, "ver", 1, 4);
    close_length(&bag->index, length);
    length = open_length(&bag->index);
    uint8_t count[8];
    imki_put_u32(imki_put_u32(count, 0), bag->messages);
    imki_ros_gather_bytes(&bag->index, count, sizeof count);
    close_length(&bag->index, length);

    length = open_length(&head);
    put_text(&head, "compression", "none");
    put_number(&head, "op", IMKI_BAG_CHUNK, 1);
    put_number(&head, "size", bag->chunk.size, 4);
    close_length(&head, length);
    imki_put_u32(count, (uint32_t)bag->chunk.size);
    imki_ros_gather_bytes(&head, count, 4);

    length = open_length(&index);
    put_number(&index, "conn", 0, 4);
    put_number(&index, "count", bag->messages, 4);
    put_number(&index, "op", IMKI_BAG_INDEX, 1);
    put_number(&index, "ver", 1, 4);
    close_length(&index, length);
    length = open_length(&index);
    imki_ros_gather_bytes(&index, bag->places.bytes, bag->places.size);
    close_length(&index, length);

    imk_status status =
        bag->index.failed || bag->places.failed ? IMK_ERROR_MEMORY : put(log, &head);
    if (status == IMK_OK)
        status = put(log, &bag->chunk);
    if (status == IMK_OK)
        status = put(log, &index);
    free(head.bytes);
    free(index.bytes);
    bag->chunk.size = bag->places.size = 0;
    bag->messages = 0;
    bag->chunks++;
    return status;
}

/* The head of the bag, of a fixed size, padded by blanks. */
static void put_head(const bag_writer *bag, imki_ros_gathered *to, uint64_t index_place)
{
    size_t length = open_length(to);
    put_number(to, "chunk_count", bag->chunks, 4);
    put_number(to, "conn_count", 1, 4);
    put_number(to, "index_pos", index_place, 8);
    put_number(to, "op", IMKI_BAG_HEAD, 1);
    close_length(to, length);
    const size_t header = to->size - length;
    length = open_length(to);
    uint8_t *blanks = imki_ros_gather(to, HEAD_SIZE - header);
    if (blanks)
        memset(blanks, ' ', HEAD_SIZE - header);
    close_length(to, length);
}

/* ---- the codec ---- */

imk_status imki_bag_create(imki_log_output *log, const char *path, imk_error *error)
{
    bag_writer *bag = calloc(1, sizeof *bag);
    log->state = bag;
    if (!bag)
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    if (!imki_output_file_can_replace(log->file))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                             "a .bag cannot be compressed or go to a pipe, as its beginning says "
                             "where its end is",
                             "write a plain .bag file, or a .mcap");
    return imki_ros_writer_start(&bag->writer, log, path, error);
}

void imki_bag_begin(imki_log_output *log)
{
    bag_writer *bag = log->state;
    imki_ros_gathered head = {.bytes = NULL};
    imki_ros_gather_bytes(&head, "#ROSBAG V2.0\n", MAGIC);
    put_head(bag, &head, 0);
    if (put(log, &head) == IMK_ERROR_MEMORY)
        bag->chunk.failed = true; /* told with the first row, or at the end */
    free(head.bytes);
}

imk_status imki_bag_write(imki_log_output *log, const char *bytes, size_t size, size_t rows)
{
    bag_writer *bag = log->state;
    const size_t row_size = size / rows;
    imk_status status = IMK_OK;
    for (size_t i = 0; i < rows && status == IMK_OK; i++) {
        imki_imu imu;
        if (!imki_ros_writer_take(&bag->writer, log->origin, bytes + i * row_size, &imu))
            return IMK_ERROR_RANGE;
        if (!bag->connected)
            put_connection(&bag->chunk);
        bag->connected = true;
        put_message(bag, &imu);
        if (bag->chunk.failed || bag->chunk.size >= CHUNK)
            status = bag->chunk.failed ? IMK_ERROR_MEMORY : close_chunk(log);
    }
    return status;
}

imk_status imki_bag_end(imki_log_output *log, imk_error *error)
{
    bag_writer *bag = log->state;
    imki_ros_gathered head = {.bytes = NULL}, connection = {.bytes = NULL};
    imk_status status = imki_ros_writer_check(&bag->writer, error);
    if (status != IMK_OK)
        return status;
    status = bag->chunk.failed ? IMK_ERROR_MEMORY : close_chunk(log);
    put_head(bag, &head, bag->place);
    put_connection(&connection);
    if (status == IMK_OK)
        status = put(log, &connection);
    if (status == IMK_OK)
        status = put(log, &bag->index);
    if (status == IMK_OK && !head.failed)
        imki_output_file_replace(log->file, MAGIC, head.bytes, head.size);
    if (head.failed)
        status = IMK_ERROR_MEMORY;
    free(head.bytes);
    free(connection.bytes);
    /* What the file could not write, its own end tells. */
    return status == IMK_ERROR_MEMORY ? imk_error_set(error, status, "", "", "") : IMK_OK;
}

void imki_bag_discard(imki_log_output *log)
{
    bag_writer *bag = log->state;
    if (!bag)
        return;
    free(bag->chunk.bytes);
    free(bag->places.bytes);
    free(bag->index.bytes);
    free(bag);
}
