/* SPDX-License-Identifier: Apache-2.0 */
/* A sensor that is stepped, and how its memory is divided. */
#ifndef IMUKIT_SENSOR_INTERNAL_H
#define IMUKIT_SENSOR_INTERNAL_H

#include "imukit/sensor.h"
#include "model/distort_internal.h"
#include "simulate_internal.h"

/* Numbers that each channel of each sensor has. */
typedef enum imki_sensor_number {
    IMKI_SENSOR_BIAS, /* fixed value and run constant */
    IMKI_SENSOR_SCALE,
    IMKI_SENSOR_FILTER,       /* x of the bandwidth; NaN: it begins with the next input */
    IMKI_SENSOR_FILTER_SPEED, /* v */
    IMKI_SENSOR_RESIDUAL,     /* of the quantization, with the next two */
    IMKI_SENSOR_SUM,
    IMKI_SENSOR_COUNTED,
    IMKI_SENSOR_NUMBERS
} imki_sensor_number;

struct imk_sensor {
    imk_random random;
    uint32_t run;
    double drops, interval;
    uint64_t next;               /* step */
    size_t count, places;        /* sensors; room for them in arrays */
    size_t channels, of_kind[2]; /* gyro axes, accelerometer axes */
    bool temperature;            /* is part of the truth */
    bool warm_up_present[2], hysteresis_present[2];
    double warm_up_time[2], warm_up_block[2]; /* the second of this block */
    bool hysteresis_shared;                   /* all have seen the same: that of sensor 0 */
    imk_hysteresis *hysteresis[2];            /* of each sensor */
    imk_axis_response *axis;                  /* of each channel, the same for all sensors */
    imki_channel *channel;                    /* [sensor][channel] */
    double *number;                           /* [imki_sensor_number][channel][place] */
    /* Groups of sensors one after another, each [channel][sample of the block][place]. */
    double *noise;
    double *block; /* scratch: IMKI_INTERLEAVED blocks */
};

/* Sensors that are stepped together: a chunk of samples for the distortion. */
enum { IMKI_GROUP = IMKI_CHUNK };

/* Room in arrays of numbers: a single sensor is a pair of samples. */
static inline size_t imki_sensor_places(size_t count)
{
    return count == 1 ? 2 : (count + IMKI_GROUP - 1) / IMKI_GROUP * IMKI_GROUP;
}

/* Places in the noise of `count` sensors. */
static inline size_t imki_noise_places(size_t count)
{
    return count == 1 ? 1 : (count + IMKI_INTERLEAVED - 1) / IMKI_INTERLEAVED * IMKI_INTERLEAVED;
}

/* The noise of the group that begins with this sensor. @param places  of each sample */
static inline double *imki_group_noise(const imk_sensor *s, size_t first, size_t *places)
{
    const size_t left = s->count - first;
    *places = imki_noise_places(left < IMKI_GROUP ? left : IMKI_GROUP);
    return s->noise + first * s->channels * IMK_NOISE_BLOCK;
}

static inline double *imki_sensor_numbers(const imk_sensor *s, imki_sensor_number which,
                                          size_t channel)
{
    return s->number + ((size_t)which * s->channels + channel) * s->places;
}

#endif
