/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of autopilots: messages of many kinds one behind the other, each with fields at fixed
 * places. Which messages there are and where their fields are stands in the file; each format finds
 * its messages and says which sensor they are of, the rest is common. */
#ifndef IMUKIT_FLIGHT_LOG_INTERNAL_H
#define IMUKIT_FLIGHT_LOG_INTERNAL_H

#include "io/log/log_reader_internal.h"

enum { IMKI_FLIGHT_CELLS = 12, IMKI_FLIGHT_COLUMN = 48 };

/* Numbers in messages, little-endian. */
typedef enum imki_flight_type {
    IMKI_FLIGHT_NONE = 0, /* the message has no such field */
    IMKI_FLIGHT_INT8,
    IMKI_FLIGHT_UINT8,
    IMKI_FLIGHT_INT16,
    IMKI_FLIGHT_UINT16,
    IMKI_FLIGHT_INT32,
    IMKI_FLIGHT_UINT32,
    IMKI_FLIGHT_INT64,
    IMKI_FLIGHT_UINT64,
    IMKI_FLIGHT_FLOAT,
    IMKI_FLIGHT_DOUBLE
} imki_flight_type;

typedef struct imki_flight_field {
    imki_flight_type type;
    size_t place; /* of its first byte in the message */
    size_t count; /* of the elements of an array, else 1 */
} imki_flight_field;

/* A column of the rows: value * factor / divisor. */
typedef struct imki_flight_cell {
    char column[IMKI_FLIGHT_COLUMN]; /* "gyro_x [rad/s]" */
    bool optional;                   /* left out where no message has a finite value */
    bool marked;                     /* no value where `mark` is the largest int32 */
    double factor;
    imki_flight_field value, divisor, mark; /* divisor NONE: 1 */
} imki_flight_cell;

/* How the messages of a sensor become rows. */
typedef struct imki_flight_plan {
    bool usable; /* all that is needed is in the messages */
    size_t cell_count;
    imki_flight_cell cell[IMKI_FLIGHT_CELLS]; /* without the time */
    imki_flight_field stamp, stamp_else;      /* the first unless it is missing or 0 */
    uint64_t stamp_unit;                      /* [us] */
    /* Messages of many samples: the cells are arrays, of which `samples` are filled. The stamp is
     * that of the last one; they are `interval` us apart; values are multiplied by `scale`. */
    imki_flight_field samples, interval, scale;
} imki_flight_plan;

/* A sensor of the log. */
typedef struct imki_flight_stream {
    imk_log_stream about;
    int rank; /* place in lists, before the instance */
    const imki_flight_plan *plan;
    uint64_t rows;     /* met in the survey */
    uint32_t seen;     /* cells of which a finite value was met, by bits */
    bool stamped;      /* a message was met */
    uint64_t first;    /* its stamp [us] */
    double begin, end; /* times of rows [us] */
} imki_flight_stream;

/* A message, or the end of the log. */
typedef struct imki_flight_message {
    size_t size;      /* bytes from text->next on; 0: there is none */
    size_t stream;    /* whose it is */
    const char *body; /* where the places of fields count from */
    uint64_t stamp;   /* [us] */
    size_t rows;
    bool arrays; /* cells are arrays, of `rows` samples */
    /* Row i is at stamp + (first + i) * step / rate [us]; values of arrays are * scale / divisor.
     * Each of these is rounded once: all products are exact. */
    double first, step, rate;
    double scale, divisor;
} imki_flight_message;

/* What a format knows of a log; the first member of its reader->state. */
typedef struct imki_flight_log {
    /* The next message of a sensor; it is not consumed, and comes again until it is. Others are
     * consumed, those that begin before the byte `until`. */
    imk_status (*next)(imk_log_reader *reader, imki_flight_message *message, imk_error *error);
    void (*forget)(imk_log_reader *reader); /* what earlier messages said of later ones; or NULL */
    void (*settle)(imk_log_reader *reader); /* after the look at the beginning; or NULL */
    const char *nothing;                    /* as in imki_log_stream_choose() */
    imki_flight_stream *streams;
    size_t stream_count, stream_room;
    size_t chosen;
    imki_flight_plan plan; /* of the chosen one, without columns that hold nothing */
    imki_flight_cell idle; /* a temperature that held nothing in the survey; column "": none */
    uint64_t begin;        /* byte where the messages begin */
    uint64_t origin;       /* [us] that is subtracted from the stamps */
    size_t row;            /* rows of the message at hand that are read */
    size_t rows;           /* read before in this call, for imki_log_damage() */
    uint64_t until;
    bool surveying;    /* sensors may be added */
    uint64_t surveyed; /* byte up to which all definitions are known */
    bool lost;         /* we are somewhere in the log and no message is found yet */
    bool sought;       /* not all before was read: messages may be of unknown kinds */
    bool redefined;    /* what holds at a place depends on what stands before it */
} imki_flight_log;

/* Add a sensor. `name` and `kind` are copied.
 * @return its index; SIZE_MAX: no memory */
size_t imki_flight_stream_add(imki_flight_log *log, const char *name, const char *kind,
                              int instance, int rank, const imki_flight_plan *plan);

/* Look at the beginning and the end of the log, list its sensors and choose one. The text is at the
 * first message, and is so again. */
imk_status imki_flight_open(imk_log_reader *reader, imk_error *error);

/* The plan of a sensor is another one from here on. @return false: it is the sensor that is read,
 * and the columns cannot be had any more in the units that they have */
bool imki_flight_follow(imki_flight_log *log, const imki_flight_plan *plan);

imk_status imki_flight_read(imk_log_reader *reader, size_t max_rows, double *const *out,
                            size_t *rows, imk_error *error);
imk_status imki_flight_seek(imk_log_reader *reader, double fraction, imk_error *error);
void imki_flight_close(imk_log_reader *reader);

/* May what stands here define anything? Where all was looked at it must not, because what comes
 * before it would be read otherwise the next time. */
bool imki_flight_learns(const imk_log_reader *reader);

/* Stamp and rows of a message of `stream`, whose fields are at `body`. */
imki_flight_message imki_flight_message_of(const imki_flight_plan *plan, size_t stream,
                                           const char *body, size_t size);
/* Time of a row of a message, from its stamp [us]. */
double imki_flight_offset(const imki_flight_message *message, size_t row);
/* Value of a cell in a row of a message. */
double imki_flight_value(const imki_flight_cell *cell, const imki_flight_message *message,
                         size_t row);

/* Size of a number [bytes]. */
size_t imki_flight_size(imki_flight_type type);
double imki_flight_number(const imki_flight_field *field, const char *body, size_t index);
/* The same of a whole number, exactly; negative ones as int64_t. */
uint64_t imki_flight_whole(const imki_flight_field *field, const char *body);

#endif
