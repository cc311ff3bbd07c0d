/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of compressed and plain files: any bytes are delivered or refused, and whether
 * they are asked for in large or in small pieces makes no difference to what is delivered.
 * Reads: src/io/file/input_stream.c */
#include "harness.h"

#include "io/file/input_stream_internal.h"

#include <stdlib.h>
#include <string.h>

/* A few bytes can become gigabytes: more than this is not asked for. */
enum { DELIVERED_MAX = 1 << 16, SMALL_MAX = 61 };

/* Read in pieces, up to DELIVERED_MAX bytes in all. @return IMK_OK, or how the input ended */
static imk_status deliver(const char *path, size_t piece, char *bytes, size_t *count)
{
    imki_input *input = NULL;
    imk_error error = {.status = IMK_OK};
    imk_status status = imki_input_open(path, &input, &error);
    require_told(status, &error);
    *count = 0;
    size_t got = status == IMK_OK;
    while (got > 0 && *count < DELIVERED_MAX) {
        const size_t room = DELIVERED_MAX - *count;
        got = 0;
        status = imki_input_read(input, bytes + *count, piece < room ? piece : room, &got, &error);
        require_told(status, &error);
        *count += got;
    }
    if (input) {
        uint64_t done, size;
        imki_input_progress(input, &done, &size);
        require(done <= size);
    }
    imki_input_close(input);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char large[DELIVERED_MAX], small[DELIVERED_MAX];
    size_t large_count, small_count;
    const char *path = input_file_put(INPUT_TABLE, data, size);
    const imk_status status = deliver(path, DELIVERED_MAX, large, &large_count);
    const size_t piece = 1 + choice_of(data, size) % SMALL_MAX;
    const imk_status again = deliver(path, piece, small, &small_count);
    const size_t both = small_count < large_count ? small_count : large_count;
    require(memcmp(small, large, both) == 0);
    /* In front of damage, a large piece may lack bytes that small ones still deliver; what stands
     * behind the last byte asked for may have been looked at or not. */
    if (status == IMK_OK && again == IMK_OK)
        require(small_count == large_count);
    require(again == status || small_count == DELIVERED_MAX || large_count == DELIVERED_MAX);
    return 0;
}
