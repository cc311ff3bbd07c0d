/* SPDX-License-Identifier: Apache-2.0 */
/* Chunks of messages, unpacked: bzip2, frames of LZ4 [LZ4FRAME] and of Zstandard [RFC8878]. The
 * size that a log claims bounds what comes out, but memory is taken only as it comes. */
#include "log_ros_internal.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <stdio.h>
#include <stdlib.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

imki_ros_packing imki_ros_packing_named(imki_log_piece name)
{
    static const struct {
        const char *name;
        imki_ros_packing packing;
    } known[] = {{"", IMKI_ROS_PLAIN},
                 {"none", IMKI_ROS_PLAIN},
                 {"bz2", IMKI_ROS_BZ2},
                 {"lz4", IMKI_ROS_LZ4},
                 {"zstd", IMKI_ROS_ZSTD}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (imki_piece_is(name, known[i].name))
            return known[i].packing;
    return IMKI_ROS_PACKING_UNKNOWN;
}

/* What a step of a decoder did. */
typedef struct step {
    size_t taken, given;
    bool failed, over;
    bool memory; /* failed for want of it, and not because of the bytes */
} step;

static void step_bz2(bz_stream *z, const uint8_t *from, size_t size, uint8_t *to, size_t room,
                     step *s)
{
    const unsigned most = 1u << 30;
    z->next_in = (char *)(uintptr_t)from; /* the library does not write there */
    z->avail_in = size < most ? (unsigned)size : most;
    z->next_out = (char *)to;
    z->avail_out = room < most ? (unsigned)room : most;
    const unsigned in = z->avail_in, out = z->avail_out;
    const int result = BZ2_bzDecompress(z);
    s->taken = in - z->avail_in;
    s->given = out - z->avail_out;
    s->over = result == BZ_STREAM_END;
    s->failed = result != BZ_OK && !s->over;
    s->memory = result == BZ_MEM_ERROR;
}

static void step_lz4(LZ4F_dctx *lz4, const uint8_t *from, size_t size, uint8_t *to, size_t room,
                     step *s)
{
    s->taken = size;
    s->given = room;
    const size_t result = LZ4F_decompress(lz4, to, &s->given, from, &s->taken, NULL);
    s->failed = LZ4F_isError(result) != 0;
    s->over = result == 0;
    if (s->failed) {
        s->taken = s->given = 0;
        /* Its number is no part of the library's public interface. */
        s->memory = strcmp(LZ4F_getErrorName(result), "ERROR_allocation_failed") == 0;
    }
}

static void step_zstd(ZSTD_DCtx *zstd, const uint8_t *from, size_t size, uint8_t *to, size_t room,
                      step *s)
{
    ZSTD_inBuffer in = {from, size, 0};
    ZSTD_outBuffer out = {to, room, 0};
    const size_t result = ZSTD_decompressStream(zstd, &out, &in);
    s->taken = in.pos;
    s->given = out.pos;
    s->failed = ZSTD_isError(result) != 0;
    s->memory = ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation;
    s->over = result == 0;
}

static bool grow(imki_ros_chunk *chunk, size_t room)
{
    if (room <= chunk->room)
        return true;
    uint8_t *larger = realloc(chunk->bytes, room);
    if (!larger)
        return false;
    chunk->bytes = larger;
    chunk->room = room;
    return true;
}

typedef struct decoder {
    imki_ros_packing packing;
    bz_stream bz2;
} decoder;

/* Make the decoder ready. @return false: no memory */
static bool start(imki_ros_chunk *chunk, decoder *d)
{
    if (d->packing == IMKI_ROS_BZ2)
        return BZ2_bzDecompressInit(&d->bz2, 0, 0) == BZ_OK;
    if (d->packing == IMKI_ROS_LZ4) {
        LZ4F_dctx *lz4 = chunk->lz4;
        if (!lz4 && LZ4F_isError(LZ4F_createDecompressionContext(&lz4, LZ4F_VERSION)))
            return false;
        chunk->lz4 = lz4;
        LZ4F_resetDecompressionContext(lz4);
        return true;
    }
    if (!chunk->zstd)
        chunk->zstd = ZSTD_createDCtx();
    return chunk->zstd && !ZSTD_isError(ZSTD_DCtx_reset(chunk->zstd, ZSTD_reset_session_only));
}

imk_status imki_ros_unpack(imki_ros_chunk *chunk, imki_ros_packing packing, const uint8_t *bytes,
                           size_t size, uint64_t due, bool *intact, imk_error *error)
{
    enum { FIRST = 1 << 16 };
    decoder d = {.packing = packing};
    step s = {.over = false};
    bool enough = start(chunk, &d);
    chunk->size = 0;
    /* Several frames of zstd, one behind the other, are data as well [RFC8878]. */
    const bool frames = packing == IMKI_ROS_ZSTD;
    while (enough && !s.failed && (!s.over || (frames && size > 0 && chunk->size < due))) {
        /* What is claimed may be a thousand times the bytes that are there. */
        const size_t likely = chunk->size > 0 ? 2 * chunk->size : 4 * size + FIRST;
        enough = chunk->size < chunk->room || grow(chunk, likely < due ? likely : (size_t)due + 1);
        const size_t left = chunk->room - chunk->size;
        if (!enough || left == 0)
            break;
        if (packing == IMKI_ROS_BZ2)
            step_bz2(&d.bz2, bytes, size, chunk->bytes + chunk->size, left, &s);
        else if (packing == IMKI_ROS_LZ4)
            step_lz4(chunk->lz4, bytes, size, chunk->bytes + chunk->size, left, &s);
        else
            step_zstd(chunk->zstd, bytes, size, chunk->bytes + chunk->size, left, &s);
        bytes += s.taken;
        size -= s.taken;
        chunk->size += s.given;
        if (chunk->size > due || (s.taken == 0 && s.given == 0))
            break;
    }
    if (packing == IMKI_ROS_BZ2)
        BZ2_bzDecompressEnd(&d.bz2);
    *intact = s.over && !s.failed && chunk->size == due;
    chunk->size = chunk->size < due ? chunk->size : (size_t)due;
    return enough && !s.memory ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

void imki_ros_chunk_free(imki_ros_chunk *chunk)
{
    free(chunk->bytes);
    LZ4F_freeDecompressionContext(chunk->lz4);
    ZSTD_freeDCtx(chunk->zstd);
    *chunk = (imki_ros_chunk){0};
}

void imki_ros_leave(imki_ros_log *log, imki_ros_inside *inside, bool damaged)
{
    if (damaged && !inside->cut)
        imki_log_damage(log->reader, log->rows);
    log->text->next += inside->behind;
    inside->at = NULL;
}

/* Leave a chunk out that cannot be unpacked, be it so or by damage. If nothing else is wrong with a
 * log without rows, this is why. */
static imk_status leave_out(imki_ros_log *log, imki_ros_inside *inside, const char *reason)
{
    if (!log->unread[0])
        snprintf(log->unread, sizeof log->unread, "%s", reason);
    log->unread_chunks++;
    imki_ros_leave(log, inside, true);
    return IMK_OK;
}

imk_status imki_ros_enter(imki_ros_log *log, imki_ros_inside *inside, imki_log_piece packing,
                          const uint8_t *bytes, size_t size, uint64_t due, uint32_t sum,
                          imk_error *error)
{
    const imki_ros_packing kind = imki_ros_packing_named(packing);
    bool intact = size == due;
    if (kind == IMKI_ROS_PACKING_UNKNOWN) {
        char found[96];
        snprintf(found, sizeof found, "the messages are compressed by \"%.*s\"",
                 (int)(packing.end - packing.begin < 32 ? packing.end - packing.begin : 32),
                 packing.begin);
        return leave_out(log, inside, found);
    }
    inside->at = bytes;
    inside->end = bytes + size;
    if (kind != IMKI_ROS_PLAIN) {
        if (due > IMKI_ROS_RECORD_MAX)
            return leave_out(log, inside, "a chunk is larger than 1 GiB");
        const imk_status status =
            imki_ros_unpack(&inside->unpacked, kind, bytes, size, due, &intact, error);
        if (status != IMK_OK)
            return status;
        inside->at = inside->unpacked.bytes;
        inside->end = inside->at + inside->unpacked.size;
    }
    if (intact && sum != 0)
        intact = crc32_z(0, inside->at, (size_t)(inside->end - inside->at)) == sum;
    if (!intact && !inside->cut)
        imki_ros_leave(log, inside, true);
    return IMK_OK;
}
