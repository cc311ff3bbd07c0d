/* SPDX-License-Identifier: Apache-2.0 */
/* From message to message of a DataFlash log, also past damaged bytes. There are no checksums: a
 * message is trusted if its number is known and another header follows it. */
#include "dataflash_internal.h"

#include <stdio.h>
#include <string.h>

enum { HEADER = IMKI_DATAFLASH_HEADER };

static const char mark[2] = "\xA3\x95";

static int message_number(const char *message)
{
    return (unsigned char)message[2];
}

static size_t length_at(const imki_dataflash *flash, const char *at)
{
    return flash->format[message_number(at)].length;
}

/* Do these bytes, as far as they are there, begin a message of a known number?
 * @param defined  a number that is known, too; -1: none */
static bool begins(const imki_dataflash *flash, const char *at, size_t left, int defined)
{
    if (left < HEADER)
        return left == 0 || memcmp(at, mark, left < 2 ? left : 2) == 0;
    return memcmp(at, mark, 2) == 0 && (length_at(flash, at) > 0 || message_number(at) == defined);
}

/* Have a message at text->next. @param size  of it; 0: it is no whole one, or none follows */
static imk_status fetch(const imki_dataflash *flash, imki_log_text *text, size_t *size,
                        imk_error *error)
{
    imk_status status = IMK_OK;
    *size = 0;
    if ((size_t)(text->end - text->next) < HEADER)
        status = imki_log_text_need(text, HEADER, error);
    if (status != IMK_OK || (size_t)(text->end - text->next) < HEADER ||
        !begins(flash, text->next, HEADER, -1))
        return status;
    const size_t length = length_at(flash, text->next);
    if ((size_t)(text->end - text->next) < length + HEADER)
        status = imki_log_text_need(text, length + HEADER, error);
    const size_t left = (size_t)(text->end - text->next);
    if (status != IMK_OK || left < length)
        return status;
    /* The first message of a number may follow its FMT at once. */
    const bool defines = message_number(text->next) == IMKI_DATAFLASH_FMT;
    const int defined = defines ? (unsigned char)text->next[HEADER] : -1;
    if (begins(flash, text->next + length, left - length, defined))
        *size = length;
    return status;
}

/* Go on to the next message that can be trusted, or to the end. */
static imk_status find_way(const imki_dataflash *flash, imki_log_text *text, imk_error *error)
{
    for (;;) {
        size_t size;
        const imk_status status = fetch(flash, text, &size, error);
        if (status != IMK_OK || size > 0 || text->next == text->end ||
            imki_log_text_place(text) >= flash->log.until)
            return status;
        const char *found = memchr(text->next + 1, mark[0], (size_t)(text->end - text->next) - 1);
        text->next = found ? found : text->end;
    }
}

static imk_status refuse(const imki_dataflash_format *format, uint64_t begin, imk_error *error)
{
    char found[96], due[200] = "a log whose messages of one name have the same fields";
    const unsigned long long place = (unsigned long long)format->joint;
    snprintf(found, sizeof found, "messages %s do not have the same columns and units any more",
             format->name);
    if (format->joint > begin)
        snprintf(
            due, sizeof due,
            "seemingly logs were put together: give them apart, as \"head -c %llu\" and \"tail "
            "-c +%llu\" divide the file",
            place, place + 1);
    return imk_error_set(error, IMK_ERROR_COLUMN, "", found, due);
}

/* The sensor of an instance, which is new perhaps. SIZE_MAX: none, or *status is an error */
static size_t stream_of(imki_dataflash *flash, int sensor, int number, size_t instance,
                        bool counted, imk_status *status, imk_error *error)
{
    const imki_dataflash_format *format = &flash->format[number];
    const char *name = imki_dataflash_sensor_name(sensor);
    int *index = &flash->stream[sensor][instance];
    if (flash->basis[sensor].length == 0 && !flash->log.surveying)
        return SIZE_MAX;
    if (flash->planned[sensor] != number + 1 && !imki_dataflash_follow(flash, sensor, number)) {
        *status = refuse(format, flash->log.begin, error);
        return SIZE_MAX;
    }
    if (*index > 0)
        return (size_t)*index - 1;
    if (!flash->log.surveying)
        return SIZE_MAX;
    const size_t added =
        imki_flight_stream_add(&flash->log, name, format->name, counted ? (int)instance : -1,
                               sensor, &flash->plan[sensor]);
    if (added == SIZE_MAX)
        *status = imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
    else
        *index = (int)added + 1;
    return added;
}

/* An ISBH: what follows in ISBD. @return false: it makes no sense */
static bool begin_batch(imki_dataflash *flash, const imki_dataflash_format *format,
                        const char *message, imk_status *status, imk_error *error)
{
    static const char *const labels[] = {"N",       "type",     "instance", "mul",
                                         "smp_cnt", "SampleUS", "smp_rate"};
    imki_flight_field field[7];
    imki_dataflash_batch *batch = &flash->batch;
    int data = 0;
    *batch = (imki_dataflash_batch){.known = false};
    for (int i = 0; i < 7; i++) {
        field[i] = imki_dataflash_field(format, labels[i], NULL);
        if (field[i].type == IMKI_FLIGHT_NONE)
            return false;
    }
    while (data < 256 && strcmp(flash->format[data].name, "ISBD") != 0)
        data++;
    const uint64_t type = imki_flight_whole(&field[1], message);
    const uint64_t instance = imki_flight_whole(&field[2], message);
    const double multiplier = imki_flight_number(&field[3], message, 0);
    const double rate = imki_flight_number(&field[6], message, 0);
    if (data == 256 || type > 1 || instance >= IMKI_DATAFLASH_INSTANCES || !(multiplier > 0) ||
        !(rate > 0))
        return false;
    *batch = (imki_dataflash_batch){.known = true,
                                    .number = imki_flight_whole(&field[0], message),
                                    .samples = imki_flight_whole(&field[4], message),
                                    .stamp = imki_flight_whole(&field[5], message),
                                    .rate = rate,
                                    .divisor = multiplier};
    batch->stream =
        stream_of(flash, imki_dataflash_batches(type == 1), data, instance, true, status, error);
    return true;
}

/* An ISBD: 32 samples, the first one the number `seqno` times 32 of its batch.
 * @return false: its batch is not known, or has no such samples */
static bool take_piece(imki_dataflash *flash, const imki_dataflash_format *format,
                       const char *message, size_t size, imki_flight_message *made)
{
    const imki_dataflash_batch *batch = &flash->batch;
    const imki_flight_field number = imki_dataflash_field(format, "N", NULL);
    const imki_flight_field piece = imki_dataflash_field(format, "seqno", NULL);
    if (!batch->known || number.type == IMKI_FLIGHT_NONE || piece.type == IMKI_FLIGHT_NONE ||
        imki_flight_whole(&number, message) != batch->number)
        return false;
    const uint64_t first = imki_flight_whole(&piece, message) * IMKI_DATAFLASH_PIECE;
    if (first >= batch->samples)
        return false;
    if (batch->stream == SIZE_MAX)
        return true;
    if (flash->planned[flash->log.streams[batch->stream].rank] != message_number(message) + 1)
        return false;
    const uint64_t left = batch->samples - first;
    *made = (imki_flight_message){.size = size,
                                  .stream = batch->stream,
                                  .body = message,
                                  .stamp = batch->stamp,
                                  .rows = left < IMKI_DATAFLASH_PIECE ? (size_t)left
                                                                      : IMKI_DATAFLASH_PIECE,
                                  .arrays = true,
                                  .first = (double)first,
                                  .step = 1e6,
                                  .rate = batch->rate,
                                  .scale = 1,
                                  .divisor = batch->divisor};
    return true;
}

/* A message at hand. @param made  is set if it is of a sensor
 * @return whether it can be read, or *status is an error */
static bool take(imk_log_reader *reader, size_t size, imki_flight_message *made, imk_status *status,
                 imk_error *error)
{
    imki_dataflash *flash = reader->state;
    const char *message = reader->text.next;
    const int number = message_number(message);
    const imki_dataflash_format *format = &flash->format[number];
    if (number == IMKI_DATAFLASH_FMT)
        return imki_dataflash_define(flash, message, imki_log_text_place(&reader->text),
                                     imki_flight_learns(reader));
    flash->defining = false;
    if (format->sensor >= 0) {
        const bool counted = format->instance.type == IMKI_FLIGHT_UINT8;
        const size_t instance = counted ? imki_flight_whole(&format->instance, message) : 0;
        if (instance >= IMKI_DATAFLASH_INSTANCES)
            return false;
        const size_t stream =
            stream_of(flash, format->sensor, number, instance, counted, status, error);
        if (stream != SIZE_MAX)
            *made = imki_flight_message_of(&flash->plan[format->sensor], stream, message, size);
        return true;
    }
    if (strcmp(format->name, "ISBH") == 0)
        return begin_batch(flash, format, message, status, error);
    if (strcmp(format->name, "ISBD") == 0)
        return take_piece(flash, format, message, size, made) || flash->log.sought;
    imki_dataflash_learn(flash, format, message);
    return true;
}

imk_status imki_dataflash_next(imk_log_reader *reader, imki_flight_message *message,
                               imk_error *error)
{
    imki_dataflash *flash = reader->state;
    imki_log_text *text = &reader->text;
    imk_status status = IMK_OK;
    *message = (imki_flight_message){.size = 0};
    if (flash->log.lost)
        status = find_way(flash, text, error);
    flash->log.lost = false;
    while (status == IMK_OK && imki_log_text_place(text) < flash->log.until) {
        size_t size;
        status = fetch(flash, text, &size, error);
        const size_t left = (size_t)(text->end - text->next);
        if (status != IMK_OK || left == 0)
            return status;
        if (size > 0) {
            if (!take(reader, size, message, &status, error))
                imki_log_damage(reader, flash->log.rows);
            if (status != IMK_OK || message->size > 0)
                return status;
            text->next += size;
        } else {
            /* Damaged, or cut off by the end, when nothing follows. */
            const bool cut = begins(flash, text->next, left < HEADER ? left : HEADER, -1) &&
                             (left < HEADER || left < length_at(flash, text->next));
            text->next++;
            status = find_way(flash, text, error);
            if (cut && text->next == text->end)
                reader->cut_short = true;
            else
                imki_log_damage(reader, flash->log.rows);
        }
    }
    return status;
}

void imki_dataflash_forget(imk_log_reader *reader)
{
    imki_dataflash *flash = reader->state;
    flash->batch.known = false;
    if (!flash->log.lost) /* at the end hold most likely those that were met last */
        imki_dataflash_restore(flash);
}
