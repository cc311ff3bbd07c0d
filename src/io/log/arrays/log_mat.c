/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as MAT-files of version 5, which MATLAB writes as -v6, and compressed as -v7 [MAT5]. The
 * head is a text of 116 bytes, the place of data of MATLAB's own, the version, and "MI" as a number
 * of 16 bits: "IM" where the low byte comes first.
 *
 * A file of version 4 has no head but that of its first matrix, five numbers: M O P T in decimal (M
 * order of bytes, O zero, P type of numbers, T full, text or sparse), rows, columns, whether
 * complex, length of the name. It is recognised, and refused. */
#include "column_store_internal.h"
#include "mat_elements_internal.h"
#include "mat_write_internal.h"

#include <string.h>

enum { V4_HEAD = 20, NAME_MAX_V4 = 64 };

static bool is_version_5(const char *begin, size_t size)
{
    if (size < IMKI_MAT_HEAD)
        return false;
    const char *order = begin + 126;
    const unsigned char *version = (const unsigned char *)begin + 124;
    return (order[0] == 'I' && order[1] == 'M' && version[1] == 1) ||
           (order[0] == 'M' && order[1] == 'I' && version[0] == 1);
}

static bool is_version_4(const char *begin, size_t size)
{
    if (size < V4_HEAD + 2)
        return false;
    for (int swapped = 0; swapped < 2; swapped++) {
        uint32_t head[5];
        for (size_t i = 0; i < 5; i++)
            head[i] = imki_mat_number((const unsigned char *)begin + 4 * i, swapped);
        const char *name = begin + V4_HEAD;
        const size_t length = head[4];
        if (head[0] > 1052 || head[0] / 100 % 10 != 0 || head[0] / 10 % 10 > 5 ||
            head[0] % 10 > 2 || head[1] < 1 || head[2] < 1 || head[3] > 1 || length < 2 ||
            length > NAME_MAX_V4 || length > size - V4_HEAD || name[length - 1] != '\0' ||
            strlen(name) != length - 1)
            continue;
        bool is_name = true;
        for (const char *c = name; *c; c++)
            is_name = is_name && (*c == '_' || (*c >= '0' && *c <= '9') ||
                                  (*c >= 'A' && *c <= 'Z') || (*c >= 'a' && *c <= 'z'));
        if (is_name)
            return true;
    }
    return false;
}

static bool recognise(const char *begin, size_t size)
{
    return is_version_5(begin, size) || is_version_4(begin, size);
}

static imk_status open_mat(imk_log_reader *reader, imk_error *error)
{
    const imki_log_text *text = &reader->text;
    const size_t size = (size_t)(text->end - text->next);
    if (!is_version_5(text->next, size))
        return is_version_4(text->next, size)
                   ? imk_error_set(error, IMK_ERROR_UNSUPPORTED, "", "the MAT-file is of version 4",
                                   "write it in MATLAB as save('log.mat', '-v7')")
                   : imk_error_set(error, IMK_ERROR_FORMAT, "",
                                   "the file does not begin as a MAT-file of version 5",
                                   "a file that MATLAB wrote with -v6 or -v7");
    uint16_t order;
    memcpy(&order, text->next + 126, sizeof order);
    imk_status status = imki_array_strips_make(reader, '.', error);
    if (status == IMK_OK)
        status = imki_mat_list(reader, order != 0x4D49, error); /* "MI" as a number */
    return status == IMK_OK ? imki_array_strips_begin(reader, error) : status;
}

const imki_log_codec imki_log_mat = {.recognise = recognise,
                                     .needs_file = true,
                                     .open = open_mat,
                                     .read = imki_array_rows_read,
                                     .close = imki_array_strips_close,
                                     .seek = imki_array_strips_seek,
                                     .progress = imki_array_rows_progress,
                                     .create = imki_mat_create,
                                     .format = imki_log_format_matrix,
                                     .write = imki_column_store_write,
                                     .end = imki_mat_end,
                                     .discard = imki_column_store_discard};
