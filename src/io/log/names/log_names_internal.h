/* SPDX-License-Identifier: Apache-2.0 */
/* What a column is by its name, as people and programs write it: "gyro_x", "GyroX", "wx",
 * "angular_velocity.x", "imu0_acc_z_mg", "timestamp_ns". */
#ifndef IMUKIT_LOG_NAMES_INTERNAL_H
#define IMUKIT_LOG_NAMES_INTERNAL_H

#include "imukit/record.h"

/* Kinds of columns with a meaning here. */
typedef struct imki_log_kind {
    const char *name; /* as it is called from here on; with an axis: what stands before it */
    imk_quantity quantity;
    bool has_axis, increment;
    const char *unit;     /* one of the right dimension */
    const char *option;   /* states the unit; NULL: without a unit it is a column like any other */
    const char *examples; /* of units, for messages */
} imki_log_kind;

typedef struct imki_log_name {
    const imki_log_kind *kind; /* NULL: a column like any other */
    int axis;                  /* 0 … 7; -1: none */
    bool numbered;             /* the axis is a figure */
    bool exact;                /* one of the names of docs/logs.md, or one of them in other words */
    bool of_message;           /* called as the field of sensor_msgs/Imu */
    char group[40];            /* the words before the sensor's, "imu0"; "" */
    const char *unit;          /* by the end of the name, as in "acc_x_mg"; NULL: none */
    const char *reason;        /* why it is no reading although it seems so; NULL */
} imki_log_name;

enum { IMKI_LOG_KINDS = 7 };
extern const imki_log_kind imki_log_kinds[IMKI_LOG_KINDS];

/* The first kind of columns of a quantity; NULL: none. */
const imki_log_kind *imki_log_kind_of(imk_quantity quantity);

/* @param text  without the unit in brackets */
imki_log_name imki_log_name_of(const char *text);

/* The unit that a text is at the end of the name of such a column; NULL: none, or none for sure. */
const char *imki_log_unit_of_words(const char *text, const imki_log_kind *kind);

#endif
