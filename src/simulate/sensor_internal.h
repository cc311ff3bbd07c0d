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

/* Sensors that are stepped together: a chunk of samples for the distortion. */
enum { IMKI_GROUP = IMKI_CHUNK };

/* What a group of sensors is exposed to, a row of places for each quantity. */
enum {
    IMKI_SENSOR_FORCE = 3,
    IMKI_SENSOR_ACCELERATION = 6,
    IMKI_SENSOR_TEMPERATURE = 9,
    IMKI_SENSOR_TEMPERATURE_RATE,
    IMKI_SENSOR_WARM_UP,
    IMKI_SENSOR_HYSTERESIS = IMKI_SENSOR_WARM_UP + 2,
    IMKI_SENSOR_ROWS = IMKI_SENSOR_HYSTERESIS + 2
};

struct imk_sensor {
    double *rows;              /* IMKI_SENSOR_ROWS */
    imki_exposure exposure[2]; /* of gyros and accelerometers to these rows */
    imk_random random;
    uint32_t run;
    double drops, interval;
    uint64_t next;               /* step */
    size_t count, places;        /* sensors; room for them in arrays */
    size_t channels, of_kind[2]; /* gyro axes, accelerometer axes */
    bool temperature;            /* is part of the truth */
    double warm_up_time[2], warm_up_block[2];
    bool same_warm_up, same_hysteresis; /* of gyros and accelerometers: made once */
    bool shared_hysteresis;             /* all have seen the same: that of sensor 0 */
    imk_hysteresis *hysteresis[2];      /* of each sensor; NULL: none */
    imk_axis_response *axis;            /* of each channel, the same for all sensors */
    imki_quantizer *quantizer;          /* of each channel */
    imki_channel *channel;              /* [sensor][channel] */
    double *number;                     /* [imki_sensor_number][channel][place] */
    /* Groups of sensors one after another, each [channel][sample of the block][place]. */
    double *noise;
    double *rest;  /* alike, IMKI_LEAD samples: what was left of a block when the next was made */
    double *block; /* scratch: IMKI_INTERLEAVED blocks */
    double *response; /* scratch: of a channel of a group that is not whole */
};

/* Room in arrays of numbers: a single sensor is a pair of samples. */
static inline size_t imki_sensor_places(size_t count)
{
    return count == 1 ? 2 : (count + IMKI_GROUP - 1) / IMKI_GROUP * IMKI_GROUP;
}

/* Places in the noise of a single sensor, or of some of many. */
static inline size_t imki_noise_places(bool single, size_t count)
{
    return single ? 1 : (count + IMKI_INTERLEAVED - 1) / IMKI_INTERLEAVED * IMKI_INTERLEAVED;
}

/* The groups make their blocks one after another, over the last samples of the block before. */
enum { IMKI_LEAD = 64 };

/* So many samples before its end the group that begins with this sensor makes the next block. */
static inline size_t imki_lead(const imk_sensor *s, size_t first)
{
    const size_t groups = (s->count + IMKI_GROUP - 1) / IMKI_GROUP;
    return first / IMKI_GROUP * IMKI_LEAD / groups;
}

static inline size_t imki_group_places(const imk_sensor *s, size_t first)
{
    const size_t left = s->count - first;
    return imki_noise_places(s->count == 1, left < IMKI_GROUP ? left : IMKI_GROUP);
}

/* The noise of a group, and the rest of its block before. */
static inline double *imki_group_noise(const imk_sensor *s, size_t first)
{
    return s->noise + first * s->channels * IMK_NOISE_BLOCK;
}

static inline double *imki_group_rest(const imk_sensor *s, size_t first)
{
    return s->rest + first * s->channels * IMKI_LEAD;
}

/* Make the next block of a group. */
void imki_sensor_make_noise(imk_sensor *s, size_t first);

static inline double *imki_sensor_numbers(const imk_sensor *s, imki_sensor_number which,
                                          size_t channel)
{
    return s->number + ((size_t)which * s->channels + channel) * s->places;
}

/* Places of a row of what a group is exposed to. */
static inline size_t imki_row_places(size_t count)
{
    return count == 1 ? 2 : (size_t)IMKI_GROUP;
}

static inline double *imki_sensor_row(const imk_sensor *s, int row)
{
    return s->rows + (size_t)row * imki_row_places(s->count);
}

/* The output stage of a channel of `count` sensors from `first` on: a response becomes a reading.
 * The state has all it needs: what is handed over on the stack can be slow, because a processor
 * takes a load for one of something stored just before when their addresses are equal modulo 4096.
 * @param noise  of this sample
 * @param count  <= IMKI_GROUP
 * @return true if all readings are finite */
bool imki_sensor_output(const imk_sensor *s, size_t channel, size_t first, const double *noise,
                        size_t count, double *y);

/* The same of one instruction set. */
#define IMKI_SENSOR_OUTPUT(isa)                                                                    \
    bool imki_sensor_output_##isa(const imk_sensor *s, size_t channel, size_t first,               \
                                  const double *noise, size_t count, double *y);
IMKI_SENSOR_OUTPUT(portable)
IMKI_SENSOR_OUTPUT(avx2)
IMKI_SENSOR_OUTPUT(avx512)

#endif
