/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the calibration of a magnetometer (magnetometer.h). */
#ifndef IMUKIT_MAGNETOMETER_INTERNAL_H
#define IMUKIT_MAGNETOMETER_INTERNAL_H

#include "imukit/attitude.h"
#include "imukit/magnetometer.h"

enum {
    IMKI_MAG_COOKIE = 0x4D414731, /* "MAG1" */
    IMKI_MAG_BIAS = 0,
    IMKI_MAG_RESPONSE = IMK_MAGNETOMETER_RESPONSE,
    IMKI_MAG_FIELD = IMK_MAGNETOMETER_FIELD,
    IMKI_MAG_DIP = IMK_MAGNETOMETER_DIP,
    IMKI_MAG_ALL = IMK_MAGNETOMETER_PARAMETERS
};

/* An estimate on its way. */
typedef struct imki_mag_fit {
    const imk_magnetometer *problem;
    bool aligned, field_known;
    double x[IMKI_MAG_ALL];
    imk_matrix3 inverse; /* of A */
    bool rough; /* outliers are still there: derivatives at the readings, as of least squares */
    double factor, added; /* sigma used: sqrt((factor sigma)^2 + added^2) */
    double up_factor;     /* of up_sigma */
    /* dx = map d(independent parameters) */
    size_t free;
    double map[IMKI_MAG_ALL][IMKI_MAG_ALL];
    /* of the last sums */
    double normal[IMKI_MAG_ALL * IMKI_MAG_ALL], gradient[IMKI_MAG_ALL];
    double covariance[IMKI_MAG_ALL * IMKI_MAG_ALL]; /* of x, from the last sums */
    double chi_square;                              /* with weights */
} imki_mag_fit;

static inline bool imki_mag_has_up(const imk_magnetometer_observation *o)
{
    return o->up[0] != 0.0 || o->up[1] != 0.0 || o->up[2] != 0.0;
}

/* magnetometer_start.c: hard iron, A and field by algebra, good enough to iterate from. */
void imki_mag_start(imki_mag_fit *fit);

/* magnetometer_equations.c: the inverse of A, after the convention of its scale, and which
 * parameters are independent; false: A is singular. */
bool imki_mag_set_response(imki_mag_fit *fit);
/* The equations of one observation. */
typedef struct imki_mag_equations {
    int count;
    double residual[2], information[2][2]; /* inverse of their covariance */
    double gradient[2][IMKI_MAG_ALL];
    double up_gradient[3]; /* of the second residual by `up` */
    double up_variance;    /* its part of the variance of the second residual */
    double adjusted[3];    /* the reading nearest to the observed one that fits */
} imki_mag_equations;
void imki_mag_equate(const imki_mag_fit *fit, const imk_magnetometer_observation *o,
                     imki_mag_equations *e);
/* Sum the weighted equations of all observations, whose adjusted readings are renewed. */
void imki_mag_sum(imki_mag_fit *fit);
/* Covariance of x from the sums, with knowledge from before. false: it is singular. */
bool imki_mag_invert(imki_mag_fit *fit);
/* One step; *size: the largest change over its sigma. */
bool imki_mag_step(imki_mag_fit *fit, double *size);

/* magnetometer_coverage.c: directions of the field, and which are missing. */
void imki_mag_coverage(const imki_mag_fit *fit, imk_magnetometer_result *result);
/* The signed permutation nearest to a matrix; *angle: the rotation that remains. */
int imki_mag_nearest(const double a[9], double *angle);

#endif
