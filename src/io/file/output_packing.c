/* SPDX-License-Identifier: Apache-2.0 */
/* gzip [RFC1952] by zlib, and Zstandard [RFC8878] by libzstd. */
#define ZLIB_CONST
#include "output_packing_internal.h"

#include "imukit/names.h"

#include <errno.h>
#include <stdlib.h>
#include <zlib.h>
#include <zstd.h>

struct imki_packing {
    ZSTD_CStream *zstd; /* NULL: gzip */
    z_stream gzip;
    gz_header gzip_header;
};

static bool start_gzip(imki_packing *p)
{
    /* 15: largest window, + 16: gzip; 8: zlib's usual memory */
    if (deflateInit2(&p->gzip, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return false;
    p->gzip_header.os = 255; /* "unknown": the same bytes on every system */
    deflateSetHeader(&p->gzip, &p->gzip_header);
    return true;
}

static bool start_zstd(imki_packing *p)
{
    p->zstd = ZSTD_createCStream();
    if (!p->zstd)
        return false;
    ZSTD_CCtx_setParameter(p->zstd, ZSTD_c_compressionLevel, 3);
    ZSTD_CCtx_setParameter(p->zstd, ZSTD_c_checksumFlag, 1);
    return true;
}

imk_status imki_packing_start(const char *path, imki_packing **packing, imk_error *error)
{
    const bool gzip = imk_has_ending(path, ".gz");
    *packing = NULL;
    if (!gzip && !imk_has_ending(path, ".zst"))
        return IMK_OK;
    imki_packing *made = calloc(1, sizeof *made);
    if (!made || !(gzip ? start_gzip(made) : start_zstd(made))) {
        free(made);
        return imk_error_set(error, IMK_ERROR_MEMORY, path, "", "");
    }
    *packing = made;
    return IMK_OK;
}

static int step_gzip(z_stream *z, const unsigned char **bytes, size_t *size, bool last,
                     unsigned char *room, size_t room_size, size_t *used, bool *more)
{
    const uInt part = *size < (1u << 30) ? (uInt)*size : 1u << 30;
    z->next_in = *bytes;
    z->avail_in = part;
    z->next_out = room + *used;
    z->avail_out = (uInt)(room_size - *used);
    const int result = deflate(z, last && part == *size ? Z_FINISH : Z_NO_FLUSH);
    *used = room_size - z->avail_out;
    *bytes += part - z->avail_in;
    *size -= part - z->avail_in;
    *more = z->avail_out == 0 || *size > 0;
    return result == Z_STREAM_ERROR ? EINVAL : 0;
}

int imki_packing_step(imki_packing *p, const unsigned char **bytes, size_t *size, bool last,
                      unsigned char *room, size_t room_size, size_t *used, bool *more)
{
    if (!p->zstd)
        return step_gzip(&p->gzip, bytes, size, last, room, room_size, used, more);
    ZSTD_inBuffer in = {*bytes, *size, 0};
    ZSTD_outBuffer out = {room, room_size, *used};
    const size_t left =
        ZSTD_compressStream2(p->zstd, &out, &in, last ? ZSTD_e_end : ZSTD_e_continue);
    *used = out.pos;
    *bytes += in.pos;
    *size -= in.pos;
    *more = *size > 0 || (last && left > 0);
    return ZSTD_isError(left) ? ENOMEM : 0; /* nothing is wrong with the bytes */
}

void imki_packing_free(imki_packing *p)
{
    if (!p)
        return;
    if (p->zstd)
        ZSTD_freeCStream(p->zstd);
    else
        deflateEnd(&p->gzip);
    free(p);
}
