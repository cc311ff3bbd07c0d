/* SPDX-License-Identifier: Apache-2.0 */
/* MCAP files [MCAP]: chunks of messages in CDR, each compressed and followed by the times and
 * places of its messages; then a summary. Nothing is written twice, so a pipe will do. */
#include "log_mcap_write_internal.h"

#include "log_mcap_internal.h"

#include <stdlib.h>
#include <zlib.h>
#include <zstd.h>

enum { CHUNK = IMKI_ROS_CHUNK_WRITTEN, SCHEMA_ID = 1, CHANNEL_ID = 0, LEVEL = 1 };

typedef struct mcap_writer {
    imki_ros_writer writer;
    imki_ros_gathered chunk;  /* records of the open chunk */
    imki_ros_gathered places; /* of its messages */
    imki_ros_gathered index;  /* of the chunks, for the summary */
    imki_ros_gathered record; /* that is made now */
    ZSTD_CCtx *zstd;
    uint64_t place;      /* bytes written */
    uint64_t begin, end; /* times of the open chunk */
    uint32_t chunks, messages;
    uint32_t sum; /* CRC-32 of what is written */
    bool defined; /* schema and channel stand in a chunk */
} mcap_writer;

/* ---- members of records ---- */

static void put_u8(imki_ros_gathered *to, uint8_t value)
{
    imki_ros_gather_bytes(to, &value, 1);
}

static void put_u16(imki_ros_gathered *to, uint16_t value)
{
    uint8_t *at = imki_ros_gather(to, 2);
    if (at)
        imki_put_u16(at, value);
}

static void put_u32(imki_ros_gathered *to, uint32_t value)
{
    uint8_t *at = imki_ros_gather(to, 4);
    if (at)
        imki_put_u32(at, value);
}

static void put_u64(imki_ros_gathered *to, uint64_t value)
{
    uint8_t *at = imki_ros_gather(to, 8);
    if (at)
        imki_put_u64(at, value);
}

static void put_text(imki_ros_gathered *to, const char *text)
{
    put_u32(to, (uint32_t)strlen(text));
    imki_ros_gather_bytes(to, text, strlen(text));
}

/* A record whose length is known later. @return where its members begin */
static size_t open_record(imki_ros_gathered *to, uint8_t kind)
{
    put_u8(to, kind);
    put_u64(to, 0);
    return to->size;
}

static void close_record(imki_ros_gathered *to, size_t begin)
{
    if (!to->failed)
        imki_put_u64(to->bytes + begin - 8, to->size - begin);
}

static void put_schema(imki_ros_gathered *to)
{
    const size_t begin = open_record(to, IMKI_MCAP_SCHEMA);
    put_u16(to, SCHEMA_ID);
    put_text(to, "sensor_msgs/msg/Imu");
    put_text(to, "ros2msg");
    put_text(to, imki_ros2_imu_definition);
    close_record(to, begin);
}

static void put_channel(imki_ros_gathered *to)
{
    const size_t begin = open_record(to, IMKI_MCAP_CHANNEL);
    put_u16(to, CHANNEL_ID);
    put_u16(to, SCHEMA_ID);
    put_text(to, IMKI_ROS_TOPIC);
    put_text(to, "cdr");
    put_u32(to, 0); /* metadata: none */
    close_record(to, begin);
}

static void put_message(mcap_writer *mcap, const imki_imu *imu)
{
    uint8_t data[IMKI_ROS_IMU_MAX];
    const size_t size = imki_ros_imu_write(IMKI_ROS_CDR, imu, 0, data);
    const uint64_t time = (uint64_t)imu->stamp;
    put_u64(&mcap->places, time);
    put_u64(&mcap->places, mcap->chunk.size);
    const size_t begin = open_record(&mcap->chunk, IMKI_MCAP_MESSAGE);
    put_u16(&mcap->chunk, CHANNEL_ID);
    put_u32(&mcap->chunk, (uint32_t)(mcap->writer.rows - 1));
    put_u64(&mcap->chunk, time);
    put_u64(&mcap->chunk, time);
    imki_ros_gather_bytes(&mcap->chunk, data, size);
    close_record(&mcap->chunk, begin);
    const bool first = mcap->messages++ == 0;
    mcap->begin = first || time < mcap->begin ? time : mcap->begin;
    mcap->end = first || time > mcap->end ? time : mcap->end;
}

/* Write what mcap->record holds, which is empty then. */
static imk_status put_record(imki_log_output *log)
{
    mcap_writer *mcap = log->state;
    imki_ros_gathered *record = &mcap->record;
    if (record->failed)
        return IMK_ERROR_MEMORY;
    mcap->place += record->size;
    mcap->sum = (uint32_t)crc32_z(mcap->sum, record->bytes, record->size);
    const imk_status status = imk_output_file_write(log->file, record->bytes, record->size);
    record->size = 0;
    return status;
}

/* ---- chunks ---- */

/* Chunk, and the index of its messages, into mcap->record. @return size of the first */
static size_t put_chunk(mcap_writer *mcap, size_t *packed)
{
    imki_ros_gathered *to = &mcap->record;
    size_t begin = open_record(to, IMKI_MCAP_CHUNK);
    put_u64(to, mcap->begin);
    put_u64(to, mcap->end);
    put_u64(to, mcap->chunk.size);
    put_u32(to, (uint32_t)crc32_z(0, mcap->chunk.bytes, mcap->chunk.size));
    put_text(to, "zstd");
    put_u64(to, 0);
    const size_t at = to->size, most = ZSTD_compressBound(mcap->chunk.size);
    *packed = 0;
    uint8_t *room = imki_ros_gather(to, most);
    if (!room)
        return 0;
    *packed = ZSTD_compress2(mcap->zstd, room, most, mcap->chunk.bytes, mcap->chunk.size);
    if (ZSTD_isError(*packed)) { /* nothing is wrong with the bytes */
        to->failed = true;
        return 0;
    }
    to->size = at + *packed;
    imki_put_u64(to->bytes + at - 8, *packed);
    close_record(to, begin);
    const size_t size = to->size;
    begin = open_record(to, IMKI_MCAP_MESSAGE_INDEX);
    put_u16(to, CHANNEL_ID);
    put_u32(to, (uint32_t)mcap->places.size);
    imki_ros_gather_bytes(to, mcap->places.bytes, mcap->places.size);
    close_record(to, begin);
    return size;
}

static imk_status close_chunk(imki_log_output *log)
{
    mcap_writer *mcap = log->state;
    size_t packed;
    if (mcap->messages == 0)
        return IMK_OK;
    const size_t size = put_chunk(mcap, &packed);
    imki_ros_gathered *to = &mcap->index;
    const size_t begin = open_record(to, IMKI_MCAP_CHUNK_INDEX);
    put_u64(to, mcap->begin);
    put_u64(to, mcap->end);
    put_u64(to, mcap->place);
    put_u64(to, size);
    put_u32(to, 10); /* bytes of the list: one channel */
    put_u16(to, CHANNEL_ID);
    put_u64(to, mcap->place + size);
    put_u64(to, mcap->record.size - size);
    put_text(to, "zstd");
    put_u64(to, packed);
    put_u64(to, mcap->chunk.size);
    close_record(to, begin);
    mcap->chunk.size = mcap->places.size = 0;
    mcap->messages = 0;
    mcap->chunks++;
    return mcap->index.failed || mcap->places.failed ? IMK_ERROR_MEMORY : put_record(log);
}

/* ---- the end ---- */

static void put_statistics(const mcap_writer *mcap, imki_ros_gathered *to)
{
    const imki_ros_writer *writer = &mcap->writer;
    const size_t begin = open_record(to, IMKI_MCAP_STATISTICS);
    put_u64(to, writer->rows);
    put_u16(to, 1); /* schemas */
    put_u32(to, 1); /* channels */
    put_u32(to, 0); /* attachments */
    put_u32(to, 0); /* metadata */
    put_u32(to, mcap->chunks);
    put_u64(to, (uint64_t)writer->first);
    put_u64(to, (uint64_t)writer->last);
    put_u32(to, 10); /* bytes of the list: one channel */
    put_u16(to, CHANNEL_ID);
    put_u64(to, writer->rows);
    close_record(to, begin);
}

static void put_offset(imki_ros_gathered *to, uint8_t kind, uint64_t place, size_t size)
{
    if (size == 0)
        return;
    const size_t begin = open_record(to, IMKI_MCAP_SUMMARY_OFFSET);
    put_u8(to, kind);
    put_u64(to, place);
    put_u64(to, size);
    close_record(to, begin);
}

/* From the first schema to the footer, whose CRC is that of all before it. */
static void put_summary(mcap_writer *mcap)
{
    imki_ros_gathered *to = &mcap->record;
    const uint64_t place = mcap->place;
    const uint8_t kind[4] = {IMKI_MCAP_SCHEMA, IMKI_MCAP_CHANNEL, IMKI_MCAP_STATISTICS,
                             IMKI_MCAP_CHUNK_INDEX};
    size_t end[4];
    put_schema(to);
    end[0] = to->size;
    put_channel(to);
    end[1] = to->size;
    put_statistics(mcap, to);
    end[2] = to->size;
    imki_ros_gather_bytes(to, mcap->index.bytes, mcap->index.size);
    end[3] = to->size;
    for (int i = 0; i < 4; i++) {
        const size_t begin = i > 0 ? end[i - 1] : 0;
        put_offset(to, kind[i], place + begin, end[i] - begin);
    }
    const size_t begin = open_record(to, IMKI_MCAP_FOOTER);
    put_u64(to, place);
    put_u64(to, place + end[3]);
    put_u32(to, 0);
    close_record(to, begin);
    if (!to->failed)
        imki_put_u32(to->bytes + to->size - 4, (uint32_t)crc32_z(0, to->bytes, to->size - 4));
    imki_ros_gather_bytes(to, IMKI_MCAP_MAGIC_TEXT, IMKI_MCAP_MAGIC);
}

/* ---- the codec ---- */

imk_status imki_mcap_create(imki_log_output *log, const char *path, imk_error *error)
{
    mcap_writer *mcap = calloc(1, sizeof *mcap);
    log->state = mcap;
    if (!mcap || !(mcap->zstd = ZSTD_createCCtx()))
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    ZSTD_CCtx_setParameter(mcap->zstd, ZSTD_c_compressionLevel, LEVEL);
    return imki_ros_writer_start(&mcap->writer, log, path, error);
}

void imki_mcap_begin(imki_log_output *log)
{
    mcap_writer *mcap = log->state;
    imki_ros_gathered *to = &mcap->record;
    imki_ros_gather_bytes(to, IMKI_MCAP_MAGIC_TEXT, IMKI_MCAP_MAGIC);
    const size_t begin = open_record(to, IMKI_MCAP_HEADER);
    put_text(to, "ros2");
    put_text(to, "imukit");
    close_record(to, begin);
    put_record(log); /* what fails is told with the first row, or at the end */
}

imk_status imki_mcap_write(imki_log_output *log, const char *bytes, size_t size, size_t rows)
{
    mcap_writer *mcap = log->state;
    const size_t row_size = size / rows;
    imk_status status = IMK_OK;
    for (size_t i = 0; i < rows && status == IMK_OK; i++) {
        imki_imu imu;
        if (!imki_ros_writer_take(&mcap->writer, log->origin, bytes + i * row_size, &imu))
            return IMK_ERROR_RANGE;
        if (!mcap->defined) {
            put_schema(&mcap->chunk);
            put_channel(&mcap->chunk);
            mcap->defined = true;
        }
        put_message(mcap, &imu);
        if (mcap->chunk.failed || mcap->chunk.size >= CHUNK)
            status = mcap->chunk.failed ? IMK_ERROR_MEMORY : close_chunk(log);
    }
    return status;
}

imk_status imki_mcap_end(imki_log_output *log, imk_error *error)
{
    mcap_writer *mcap = log->state;
    imk_status status = imki_ros_writer_check(&mcap->writer, error);
    if (status != IMK_OK)
        return status;
    status = mcap->chunk.failed ? IMK_ERROR_MEMORY : close_chunk(log);
    if (status == IMK_OK) {
        const size_t begin = open_record(&mcap->record, IMKI_MCAP_DATA_END);
        put_u32(&mcap->record, mcap->sum);
        close_record(&mcap->record, begin);
        status = put_record(log);
    }
    if (status == IMK_OK) {
        put_summary(mcap);
        status = put_record(log);
    }
    /* What the file could not write, its own end tells. */
    return status == IMK_ERROR_MEMORY ? imk_error_set(error, status, "", "", "") : IMK_OK;
}

void imki_mcap_discard(imki_log_output *log)
{
    mcap_writer *mcap = log->state;
    if (!mcap)
        return;
    ZSTD_freeCCtx(mcap->zstd);
    free(mcap->chunk.bytes);
    free(mcap->places.bytes);
    free(mcap->index.bytes);
    free(mcap->record.bytes);
    free(mcap);
}
