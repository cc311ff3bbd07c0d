/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of makers' receivers and sensors: messages with a checksum, one behind the other, with
 * anything between. A format finds messages and makes rows of them; messages.c does the rest. */
#ifndef IMUKIT_MESSAGES_INTERNAL_H
#define IMUKIT_MESSAGES_INTERNAL_H

#include "../log_reader_internal.h"
#include "record_bytes_internal.h"

enum { IMKI_MESSAGE_COLUMNS = 16 };

/* What begins at a byte. */
typedef enum imki_found {
    IMKI_FOUND_NOTHING,
    IMKI_FOUND_PART,    /* of a message; the rest is not at hand */
    IMKI_FOUND_DAMAGED, /* a message whose checksum is wrong */
    IMKI_FOUND_MESSAGE
} imki_found;

typedef struct imki_message {
    uint32_t id; /* 0: none whose kind is told apart */
    bool is_text;
    size_t size; /* from its first byte to behind its last */
    const unsigned char *body;
    size_t body_size;
} imki_message;

typedef struct imki_messages imki_messages;

/* A kind of message that holds readings. */
typedef struct imki_message_kind {
    uint32_t id;
    const char *name; /* of the stream */
    const char *kind; /* what the maker calls it */
    /* Make the layout, from the first message, and set the clock of `m`. NULL: the kind is only
     * known. */
    imk_status (*layout)(imk_log_reader *reader, imki_messages *m, const imki_message *first,
                         imk_error *error);
    /* The next row of a message, from m->place in its body; m->place becomes at least the size of
     * the body with the last one, also without a row.
     * @param values  receives the cells; the time is in m->stamp
     * @return whether there is one */
    bool (*row)(imki_messages *m, const imki_message *message, double *values);
    /* The row that was held back, at the end of the log. NULL: there is none. */
    bool (*rest)(imki_messages *m, double *values);
} imki_message_kind;

/* A format. */
typedef struct imki_maker {
    const char *starts;  /* bytes that messages begin with, never 0 */
    size_t longest;      /* message that is looked at */
    bool text_between;   /* other lines of text may stand between messages */
    const char *nothing; /* a clause, for a log without readings */
    imki_found (*find)(const unsigned char *at, size_t size, imki_message *message);
    const imki_message_kind *kinds;
    size_t kind_count;
} imki_maker;

/* Readings of one tag, until those of another come: they may stand in several messages. */
typedef struct imki_held {
    unsigned cells; /* 0: there are none */
    uint32_t tag;
    bool broken; /* behind a jump: the readings before them are not known */
    double numbers[IMKI_MESSAGE_COLUMNS];
} imki_held;

/* The state of a reader. */
struct imki_messages {
    const imki_maker *maker;
    const imki_message_kind *kind; /* which one is read */
    size_t place;                  /* in the body of the message at the place of the text */
    bool lost;                     /* what came last was no message */
    bool part;                     /* since the last message, one began that was not whole */
    bool begun;     /* a message was met; what stands before is one that began before recording */
    bool searching; /* behind a jump: until the next message, nothing is damage */
    /* The clock: cell `time_cell` is (stamp - origin) * tick, in the unit of the column. */
    bool timed;
    double tick;
    int64_t per_second; /* stamps; 0: the origin is not moved */
    int64_t stamp, origin;
    bool wrong; /* row() found that the content contradicts itself */
    imki_counter counter;
    /* Of the kind. */
    unsigned type;
    double gyro_scale, accel_scale;
    unsigned cells; /* a bit per reading that is there */
    imki_held held;
    uint64_t later[3]; /* as in imk_log_findings */
};

/* Is there a message in these bytes? */
bool imki_messages_recognise(const imki_maker *maker, const char *begin, size_t size);

imk_status imki_messages_open(imk_log_reader *reader, const imki_maker *maker, imk_error *error);
imk_status imki_messages_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                              size_t *rows, imk_error *error);
imk_status imki_messages_seek(imk_log_reader *reader, double fraction, imk_error *error);

/* The numbers of a text between commas. @return whether there are exactly `count` finite ones */
bool imki_numbers_read(const imki_message *message, size_t count, double *numbers);

/* "*4f" at the end of a line of text: the place of the star within `size` bytes; 0: the line ends
 * before one. */
size_t imki_star_find(const unsigned char *at, size_t size);
/* The number of `digits` hexadecimal digits. @return whether they are that */
bool imki_hex_read(const unsigned char *at, size_t digits, uint32_t *number);

#endif
