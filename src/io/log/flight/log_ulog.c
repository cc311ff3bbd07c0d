/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of PX4 [ULOG]: the header and the flags; then see flight_log.c. */
#include "ulog_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Magic number, version, time at which the logging began; of the first message the header, flags
 * that old readers may leave aside, flags that they may not, places of appended data. */
enum {
    MAGIC = 7,
    FILE_HEADER = 16,
    FLAGS = FILE_HEADER + 3 + 8,
    APPENDED = FLAGS + 8,
    FLAGS_END = APPENDED + 24
};

static const char magic[MAGIC] = "ULog\x01\x12\x35";

static imk_status refuse(const char *found, const char *expected, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found, expected);
}

/* The flags, which stand first if they are there. */
static imk_status read_flags(imki_ulog *ulog, const char *begin, size_t size, imk_error *error)
{
    if (size < FLAGS_END || begin[FILE_HEADER + 2] != 'B')
        return IMK_OK;
    for (int i = 0; i < 8; i++)
        if ((unsigned char)begin[FLAGS + i] & (i == 0 ? ~1u : ~0u))
            return refuse("the ULog has flags that say that it cannot be read without knowing them",
                          "export it with a current pyulog: ulog2csv FILE", error);
    if ((begin[FLAGS] & 1) != 0)
        memcpy(ulog->appended, begin + APPENDED, sizeof ulog->appended);
    return IMK_OK;
}

static imk_status open_ulog(imk_log_reader *reader, imk_error *error)
{
    imki_log_text *text = &reader->text;
    const imk_status status = imki_log_text_need(text, FLAGS_END, error);
    const size_t size = (size_t)(text->end - text->next);
    if (status != IMK_OK)
        return status;
    if (size >= MAGIC && memcmp(text->next, "ULogEnc", MAGIC) == 0)
        return refuse("the ULog is encrypted", "decrypt it first with Tools/decrypt_ulog.py of PX4",
                      error);
    if (size < FILE_HEADER || memcmp(text->next, magic, MAGIC) != 0)
        return refuse(size < FILE_HEADER ? "the ULog ends in its header"
                                         : "the header of the ULog is damaged",
                      "copy the log again", error);
    imki_ulog *ulog = calloc(1, sizeof *ulog);
    reader->state = ulog;
    if (ulog)
        ulog->number = calloc(IMKI_ULOG_NUMBERS, sizeof *ulog->number);
    if (!ulog || !ulog->number)
        return imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    ulog->log.next = imki_ulog_next;
    ulog->log.nothing = "the log holds no messages of gyros or accelerometers";
    const imk_status flags = read_flags(ulog, text->next, size, error);
    if (flags != IMK_OK)
        return flags;
    text->next += FILE_HEADER;
    return imki_flight_open(reader, error);
}

static void close_ulog(imk_log_reader *reader)
{
    imki_ulog *ulog = reader->state;
    imki_flight_close(reader);
    if (ulog) {
        imki_ulog_formats_free(&ulog->formats);
        free(ulog->number);
    }
}

const imki_log_codec imki_log_ulog = {.defines_units = true,
                                      .open = open_ulog,
                                      .read = imki_flight_read,
                                      .close = close_ulog,
                                      .seek = imki_flight_seek};
