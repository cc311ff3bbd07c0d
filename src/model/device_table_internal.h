/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the catalogue, in the units of data sheets. */
#ifndef IMUKI_DEVICE_TABLE_INTERNAL_H
#define IMUKI_DEVICE_TABLE_INTERNAL_H

#include "imukit/model.h"

/* What is known of one kind of sensor; 0 or NULL: not stated. Units: gyro, accelerometer. */
typedef struct imki_device_figures {
    bool present;
    double white;           /* [deg/sqrt(h)], [m/s/sqrt(h)] */
    double instability;     /* [deg/h], [ug] */
    bool is_floor;          /* the instability is the floor of the Allan deviation, 0.664 B */
    double random_walk;     /* [deg/h/sqrt(h)], [ug/sqrt(h)] */
    double repeatability;   /* [deg/h], [ug] */
    double range;           /* [deg/s], [g] */
    double scale_factor;    /* repeatability [ppm] */
    double misalignment;    /* of every pair of axes [mrad] */
    double g_sensitivity;   /* of every axis along itself [deg/h/g] */
    const double *bias;     /* fixed, 3 axes [deg/h], [ug] */
    const double *matrix;   /* 3 rows: scale factors on the diagonal, misalignment beside [ppm] */
    const double *g_matrix; /* 3 rows [deg/h/g] */
} imki_device_figures;

typedef struct imki_device_entry {
    imk_device device; /* first, so that a pointer to it is one to the entry */
    const char *method;
    imki_device_figures gyro, accel;
} imki_device_entry;

extern const imki_device_entry imki_device_table[];
extern const size_t imki_device_table_count;

#endif
