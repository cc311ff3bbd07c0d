/* SPDX-License-Identifier: Apache-2.0 */
/* Scale factors of the raw counts of NovAtel's receivers, by the type of the IMU. */
#ifndef IMUKIT_NOVATEL_INTERNAL_H
#define IMUKIT_NOVATEL_INTERNAL_H

#include <stdbool.h>

typedef struct imki_novatel_imu {
    unsigned type;
    const char *name;
    bool rates; /* the counts are rates and forces; else increments since the row before */
    double gyro_scale, accel_scale; /* unit per count */
    const char *gyro_unit, *accel_unit;
    double rate; /* [Hz] at least; 0: not needed */
} imki_novatel_imu;

/* NULL: the type is not in the table. */
const imki_novatel_imu *imki_novatel_imu_of(unsigned type);

#endif
