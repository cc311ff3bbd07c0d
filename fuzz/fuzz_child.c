/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzz entry point of what the child that reads HDF5 files says: the bytes come over its socket, a
 * list of arrays and then rows.
 * Reads: src/io/log/arrays/child_messages.c src/io/log/arrays/array_list.c */
#include "harness.h"

#include "io/log/arrays/child_messages_internal.h"
#include "io/log/arrays/child_process_internal.h"

#include <math.h>
#include <sys/socket.h>
#include <unistd.h>

enum { SIZE_MOST = 1 << 16 /* what a socket holds */, ROWS_SIZE = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    int pair[2];
    imki_array_list list = {.separator = '/'};
    imk_error error = {.status = IMK_OK};
    imk_status status = IMK_OK;
    unsigned char rows[ROWS_SIZE];
    if (size > SIZE_MOST)
        return 0;
    require(socketpair(AF_UNIX, SOCK_STREAM, 0, pair) == 0);
    require(imki_socket_send(pair[1], data, size));
    close(pair[1]);
    bool good = imki_child_list(pair[0], &list, &status, &error);
    require_told(status, &error);
    for (size_t i = 0; i < list.count; i++) {
        const imki_coding *coding = &list.array[i].coding;
        require(!list.array[i].coded ||
                (coding->missing_count <= IMKI_MISSING_MAX && isfinite(coding->factor) &&
                 coding->factor != 0.0 && isfinite(coding->offset)));
        require(list.array[i].type == IMKI_FLOAT64 || list.array[i].type == IMKI_INT64 ||
                list.array[i].type == IMKI_UINT64);
    }
    while (good && status == IMK_OK) {
        good = imki_child_rows(pair[0], rows, sizeof rows, &status, &error);
        require_told(status, &error);
    }
    imki_array_list_free(&list);
    close(pair[0]);
    return 0;
}
