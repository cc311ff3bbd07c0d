/* SPDX-License-Identifier: Apache-2.0 */
/* DataFlash, the logs of ArduPilot [DATAFLASH]. Messages of a fixed length each: A3 95, a number
 * that says of which format they are, the fields. The formats stand in messages themselves:
 *
 *     FMT   number, length, name[4], a letter for the type of each field [16], names [64]
 *     FMTU  time, number, a letter for the unit of each field [16], one for its multiplier [16]
 *     UNIT  time, letter, unit [64]           MULT  time, letter, multiplier
 *
 * All numbers are little-endian; texts end with their room or a 0. */
#ifndef IMUKIT_DATAFLASH_INTERNAL_H
#define IMUKIT_DATAFLASH_INTERNAL_H

#include "flight_log_internal.h"

enum {
    IMKI_DATAFLASH_HEADER = 3,
    IMKI_DATAFLASH_FMT = 128, /* the number of FMT, and the length of its messages */
    IMKI_DATAFLASH_FMT_LENGTH = 89,
    IMKI_DATAFLASH_FIELDS = 16,
    IMKI_DATAFLASH_SENSORS = 20,
    IMKI_DATAFLASH_INSTANCES = 16, /* ArduPilot has up to 5, twice that in batches */
    IMKI_DATAFLASH_PIECE = 32      /* samples in an ISBD */
};

typedef struct imki_dataflash_format {
    size_t length; /* of its messages; 0: there is none */
    char name[5], types[IMKI_DATAFLASH_FIELDS + 1], labels[65];
    char units[IMKI_DATAFLASH_FIELDS + 1], multipliers[IMKI_DATAFLASH_FIELDS + 1];
    uint64_t place; /* of its FMT */
    uint64_t joint; /* where the log of another start may begin that it belongs to */
    int number;
    int sensor;                 /* in the list of those with sensors; -1: it has none */
    imki_flight_field instance; /* tells several of one name apart */
} imki_dataflash_format;

/* What an ISBH says of the samples that follow it in ISBD. */
typedef struct imki_dataflash_batch {
    bool known;
    uint64_t number, samples, stamp;
    size_t stream; /* SIZE_MAX: none */
    double rate, divisor;
} imki_dataflash_batch;

typedef struct imki_dataflash {
    imki_flight_log log;
    imki_dataflash_format format[256]; /* those that hold here */
    imki_dataflash_format first[256];  /* those that hold at the beginning */
    uint64_t joint;                    /* as in imki_dataflash_format */
    bool joined, defining;  /* `joint` is that of an FMT for FMT; the last message was an FMT */
    char unit[256][16];     /* by letter; "": not said */
    double multiplier[256]; /* by letter; 0: not said */
    imki_flight_plan plan[IMKI_DATAFLASH_SENSORS];
    int planned[IMKI_DATAFLASH_SENSORS]; /* number of its format, + 1; 0: the plan is to be made */
    imki_dataflash_format basis[IMKI_DATAFLASH_SENSORS]; /* of the first message; length 0: none */
    int stream[IMKI_DATAFLASH_SENSORS]
              [IMKI_DATAFLASH_INSTANCES]; /* by instance: index + 1; 0: none */
    imki_dataflash_batch batch;
} imki_dataflash;

/* Note a format, also another one for a number that has one: logs that were put together.
 * @param learns  numbers may be defined that are not known yet
 * @return false: it is none */
bool imki_dataflash_define(imki_dataflash *flash, const char *message, uint64_t place, bool learns);
/* Go back to what holds at the beginning. */
void imki_dataflash_restore(imki_dataflash *flash);
/* Note what a message says of units, if it is one of those. What was known in the survey stays. */
void imki_dataflash_learn(imki_dataflash *flash, const imki_dataflash_format *format,
                          const char *message);
/* A field of numbers by its name; places count from the header of the message.
 * @param index  its place among the fields; may be NULL */
imki_flight_field imki_dataflash_field(const imki_dataflash_format *format, const char *label,
                                       size_t *index);

/* Place of a name in the list of messages with sensors; -1: it has none. */
int imki_dataflash_sensor(const char *name);
const char *imki_dataflash_sensor_name(int sensor);
/* The sensors whose samples are in ISBD. */
int imki_dataflash_batches(bool gyro);
/* How messages of a format become rows. */
void imki_dataflash_plan(const imki_dataflash *flash, const imki_dataflash_format *format,
                         int sensor, imki_flight_plan *plan);

/* From here on the messages of a sensor are of the format of this number. @return false: it is the
 * one that is read, and these do not have its columns */
bool imki_dataflash_follow(imki_dataflash *flash, int sensor, int number);

/* imki_flight_log.next and .forget */
imk_status imki_dataflash_next(imk_log_reader *reader, imki_flight_message *message,
                               imk_error *error);
void imki_dataflash_forget(imk_log_reader *reader);

#endif
