/* SPDX-License-Identifier: Apache-2.0 */
/* ULog, the logs of PX4 [ULOG]. A header of 16 bytes; then messages, each with the size of its body
 * (uint16), a letter that says what it is, and the body:
 *
 *     B  flags and the places of appended data     A  messages with this number are of this format
 *     F  a format: its fields with their types     D  data: number, fields
 *     S  eight fixed bytes, to find the way again  R, O, L, C, I, M, P, Q  nothing that is read
 * here
 *
 * All numbers are little-endian. */
#ifndef IMUKIT_ULOG_INTERNAL_H
#define IMUKIT_ULOG_INTERNAL_H

#include "flight_log_internal.h"

enum { IMKI_ULOG_TOPICS = 9, IMKI_ULOG_NUMBERS = 1 << 16 };

typedef struct imki_ulog_format {
    char *text; /* "name:type field;type[3] field;" without the colon, which is a 0 */
    const char *fields;
    uint32_t hash;   /* of the name */
    int state;       /* 0: not measured; 1: being measured; 2: measured */
    size_t size;     /* of its fields; 0: they cannot be read */
    size_t smallest; /* without padding at the end, which need not be written */
} imki_ulog_format;

typedef struct imki_ulog_formats {
    imki_ulog_format *item;
    size_t count, room;
} imki_ulog_formats;

/* Note a format; the first one of a name holds. @return whether it can be: it is text, not too
 * many; *memory false: there was none */
bool imki_ulog_format_add(imki_ulog_formats *formats, const char *text, size_t size, bool *memory);
/* NULL: there is none. */
imki_ulog_format *imki_ulog_format_find(imki_ulog_formats *formats, const char *name, size_t size);
/* Find out the sizes. */
void imki_ulog_format_measure(imki_ulog_formats *formats, imki_ulog_format *format);
/* A field of numbers, "x" or "gyro_rad[1]"; its type is IMKI_FLIGHT_NONE if there is none. */
imki_flight_field imki_ulog_field(imki_ulog_formats *formats, imki_ulog_format *format,
                                  const char *name);
void imki_ulog_formats_free(imki_ulog_formats *formats);

/* What the messages of a number are. */
typedef struct imki_ulog_number {
    bool known;
    uint16_t smallest, largest; /* bytes of the fields */
    int stream;                 /* -1: no sensor */
} imki_ulog_number;

typedef struct imki_ulog {
    imki_flight_log log;
    imki_ulog_formats formats;
    imki_ulog_number *number; /* IMKI_ULOG_NUMBERS */
    imki_flight_plan plan[IMKI_ULOG_TOPICS];
    bool planned[IMKI_ULOG_TOPICS];
    uint64_t appended[3]; /* bytes where appended data begin; 0: none */
} imki_ulog;

/* Place of a topic in the list of those with sensors; -1: it has none. */
int imki_ulog_topic(const char *name, size_t size);
/* How its messages become rows, as the format of the file has them. */
void imki_ulog_plan(imki_ulog_formats *formats, imki_ulog_format *format, int topic,
                    imki_flight_plan *plan);

/* imki_flight_log.next */
imk_status imki_ulog_next(imk_log_reader *reader, imki_flight_message *message, imk_error *error);

#endif
