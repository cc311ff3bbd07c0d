/* SPDX-License-Identifier: Apache-2.0 */
/* The forward map of the deterministic terms, applied to arrays: whole chunks of samples where they
 * stand, the rest in a chunk filled up with zeros, so that a sample's bits do not depend on where
 * it stands. */
#include "distort_internal.h"

#include <stddef.h>
#include <string.h>

/* Feature k is the product of these components, or one component: -1. */
static const signed char second_factor[IMK_FEATURES] = {-1, -1, -1, 0, 1, 2, 1, 2, 0, -1, -1, -1};

static const double zeros[IMKI_CHUNK];

static void take(const double *const from[3], imki_component to[3])
{
    for (int j = 0; j < 3; j++)
        to[j] = from[j] ? (imki_component){from[j], SIZE_MAX} : (imki_component){zeros, 0};
}

imki_exposure imki_expose(int sensor, const imk_stimulus *s)
{
    const double *const *own = sensor == IMK_GYRO ? s->angular_rate : s->specific_force;
    const double *const *cross = sensor == IMK_GYRO ? s->specific_force : s->angular_rate;
    const double *const *third = sensor == IMK_GYRO ? s->specific_force : s->angular_acceleration;
    imki_exposure x = {.temperature = s->temperature,
                       .temperature_rate = s->temperature_rate,
                       .warm_up = s->warm_up[sensor],
                       .hysteresis = s->hysteresis[sensor]};
    for (int k = 0; k < IMK_FEATURES; k++) {
        const bool is_product = second_factor[k] >= 0;
        const double *const *of = k < 3 ? own : is_product ? cross : third;
        x.factor[k][0] = of[k % 3];
        x.factor[k][1] = is_product ? of[second_factor[k]] : NULL;
        if (x.factor[k][0] && (x.factor[k][1] || !is_product))
            x.available |= 1u << k;
    }
    take(s->specific_force, x.force);
    take(s->angular_rate, x.rate);
    take(s->angular_acceleration, x.acceleration);
    for (int j = 0; j < 3; j++)
        x.turns = x.turns || s->angular_rate[j] || s->angular_acceleration[j];
    return x;
}

/* Bytes of two structures that are the same; what stands between members is 0 or counts as
 * different. */
static bool same_bytes(const void *a, const void *b, size_t from, size_t to)
{
    return memcmp((const char *)a + from, (const char *)b + from, to - from) == 0;
}

bool imki_axes_alike(const imk_axis_response *a, const imk_axis_response *b)
{
    return same_bytes(a, b, 0, offsetof(imk_axis_response, bias)) &&
           same_bytes(a, b, offsetof(imk_axis_response, power), sizeof *a);
}

enum { ARRAYS = 13 };

/* A copy of the last, incomplete chunk. */
static const double *padded(const double *from, size_t start, size_t count,
                            double copy[ARRAYS][IMKI_CHUNK], int array)
{
    if (!from)
        return NULL;
    memcpy(copy[array], from + start, count * sizeof *from);
    return copy[array];
}

static void distort_rest(const imk_distortion *distortion, int sensor, int axis,
                         const imk_stimulus *s, size_t start, size_t count, double *out)
{
    double copy[ARRAYS][IMKI_CHUNK], response[IMKI_CHUNK];
    memset(copy, 0, sizeof copy);
    imk_stimulus rest = {.temperature = padded(s->temperature, start, count, copy, 0),
                         .temperature_rate = padded(s->temperature_rate, start, count, copy, 1)};
    rest.warm_up[sensor] = padded(s->warm_up[sensor], start, count, copy, 2);
    rest.hysteresis[sensor] = padded(s->hysteresis[sensor], start, count, copy, 3);
    for (int j = 0; j < 3; j++) {
        rest.angular_rate[j] = padded(s->angular_rate[j], start, count, copy, 4 + j);
        rest.specific_force[j] = padded(s->specific_force[j], start, count, copy, 7 + j);
        rest.angular_acceleration[j] =
            padded(s->angular_acceleration[j], start, count, copy, 10 + j);
    }
    const imki_exposure exposure = imki_expose(sensor, &rest);
    imki_distort_chunks(distortion->kernel, &distortion->axis[sensor][axis], &exposure, 1,
                        response);
    memcpy(out + start, response, count * sizeof *out);
}

void imk_distort(const imk_distortion *distortion, int sensor, int axis,
                 const imk_stimulus *stimulus, size_t count, double *out)
{
    const imki_exposure exposure = imki_expose(sensor, stimulus);
    const size_t chunks = count / IMKI_CHUNK, done = chunks * IMKI_CHUNK;
    imki_distort_chunks(distortion->kernel, &distortion->axis[sensor][axis], &exposure, chunks,
                        out);
    if (done < count)
        distort_rest(distortion, sensor, axis, stimulus, done, count - done, out);
}
