/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the catalogue, in the units of data sheets. */
#ifndef IMUKI_DEVICE_TABLE_INTERNAL_H
#define IMUKI_DEVICE_TABLE_INTERNAL_H

#include "imukit/model.h"

/* What is known of one kind of sensor; 0 or NULL: not stated. Units: gyro, accelerometer. */
typedef struct imki_device_figures {
    bool present;           /* false also where no figure of the sensors can be taken */
    double white;           /* [deg/sqrt(h)], [m/s/sqrt(h)] */
    double white_z;         /* of z, where it differs */
    double instability;     /* [deg/h], [ug] */
    bool is_floor;          /* the instability is the floor of the Allan deviation, 0.664 B */
    double random_walk;     /* [deg/h/sqrt(h)], [ug/sqrt(h)] */
    double quantization;    /* of the integral, Q [arcsec], [m/s] */
    double repeatability;   /* [deg/h], [ug] */
    double range;           /* [deg/s], [g] */
    double resolution;      /* step of the output [deg/s], [mg] */
    double bandwidth;       /* [Hz] */
    double scale_factor;    /* repeatability [ppm] */
    double misalignment;    /* of every pair of axes [mrad] */
    double k2;              /* response to the square of the input; accelerometers [ug/g^2] */
    double g_sensitivity;   /* of every axis along itself [deg/h/g] */
    double g2_sensitivity;  /* of every axis to the square along itself [deg/h/g^2] */
    const double *bias;     /* fixed, 3 axes [deg/h], [ug] */
    const double *matrix;   /* 3 rows: scale factors on the diagonal, misalignment beside [ppm] */
    const double *g_matrix; /* 3 rows [deg/h/g] */
} imki_device_figures;

typedef struct imki_device_entry {
    imk_device device; /* first, so that a pointer to it is one to the entry */
    const char *method;
    imki_device_figures gyro, accel;
} imki_device_entry;

/* One for each class of imk_grade, in its order. */
enum { IMKI_PRESETS = 5 };
extern const imki_device_entry imki_grade_presets[IMKI_PRESETS];

extern const imki_device_entry imki_device_table[];
extern const size_t imki_device_table_count;

/* Parts by their data sheets, behind those. */
extern const imki_device_entry imki_part_table[];
extern const size_t imki_part_table_count;

#endif
