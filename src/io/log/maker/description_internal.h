/* SPDX-License-Identifier: Apache-2.0 */
/* A description of binary records in words, such as "u32 time us, 3 x i16 gyro 16.4 LSB/(deg/s)":
 * what it says of the fields. */
#ifndef IMUKIT_DESCRIPTION_INTERNAL_H
#define IMUKIT_DESCRIPTION_INTERNAL_H

#include "imukit/log.h"

#include <stdbool.h>
#include <stdint.h>

enum { IMKI_SYNC_MAX = 8, IMKI_RECORD_MAX = 65536 };

/* How a number of a record becomes one with a unit: number / divisor * factor + offset. One of
 * divisor and factor is 1. */
typedef struct imki_count_scale {
    double divisor, factor, offset;
    char unit[48]; /* "": none is stated */
} imki_count_scale;

/* A number in a record. */
typedef struct imki_record_field {
    size_t place, size; /* [bytes] from the beginning of the record */
    bool is_signed, is_float, big_endian;
    imki_count_scale scale;
    char name[96]; /* as in a header: "gyro_x [deg/s]" */
} imki_record_field;

/* Records of one size, one behind the other. */
typedef struct imki_record_form {
    uint64_t header; /* bytes before the first record */
    size_t size;     /* of a record */
    size_t sync_size;
    unsigned char sync[IMKI_SYNC_MAX]; /* at the beginning of each record */
    size_t field_count;
    imki_record_field field[IMK_LOG_COLUMNS_MAX];
    int time_field; /* -1: none */
} imki_record_form;

/* Read a description. @return IMK_ERROR_SYNTAX, _RANGE, _COLUMN and errors of units; error.field is
 * "binary", and error.found begins with the item that is wrong */
imk_status imki_record_form_parse(const char *text, imki_record_form *form, imk_error *error);

/* Read "16.4 LSB/(deg/s)", "0.061 mg/LSB", "39.0625 us", "deg/s", "count", each with "offset 23
 * degC" behind it; "" has no unit.
 * @param wrong  receives what is wrong, up to `size` bytes
 * @return whether it is a scale */
bool imki_count_scale_read(const char *begin, const char *end, imki_count_scale *scale, size_t size,
                           char *wrong);

#endif
