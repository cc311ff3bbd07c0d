/* SPDX-License-Identifier: Apache-2.0 */
/* The iteration of correct.h over blocks of samples: x <- x + J+ (y - distort(x)), as often as
 * imk_correction_start() found to be enough, whatever the values are. The first step is from x = 0,
 * where only biases and angular acceleration act. Where the response of the axes is not linear,
 * steps start from within the limits: the solution is there, so this is no step away from it, and a
 * reading far beyond them cannot lead to where a cubic turns back. */
#include "correct_internal.h"

#include <string.h>

enum { BLOCK = IMKI_CORRECT_BLOCK };

/* A block of samples; the last chunk is filled up with zeros. */
typedef struct work {
    double reading[2][IMK_AXES_MAX][BLOCK], residual[2][IMK_AXES_MAX][BLOCK];
    double solution[2][IMK_AXES_MAX][BLOCK];
    double angular_acceleration[3][BLOCK], temperature[BLOCK], temperature_rate[BLOCK];
    double warm_up[2][BLOCK];
    double along[3][BLOCK];              /* body components of the one input of an axis */
    size_t count, chunks;                /* samples there are, and chunks that hold them */
    imki_exposure exposure[2], first[2]; /* in the first step there is neither rate nor force */
} work;

static void fill_up(const work *w, double *array)
{
    memset(array + w->count, 0, (w->chunks * IMKI_CHUNK - w->count) * sizeof *array);
}

static const double *copy_of(const work *w, const double *from, size_t start, double *copy)
{
    if (!from)
        return NULL;
    memcpy(copy, from + start, w->count * sizeof *copy);
    fill_up(w, copy);
    return copy;
}

/* Readings of a block, in physical units, and what else is known of it. */
static void load(work *w, const imk_correction *c, const imk_readings *readings, size_t start)
{
    imk_stimulus s = {.temperature = copy_of(w, readings->temperature, start, w->temperature),
                      .temperature_rate =
                          copy_of(w, readings->temperature_rate, start, w->temperature_rate)};
    for (int j = 0; j < 3; j++)
        s.angular_acceleration[j] =
            copy_of(w, readings->angular_acceleration[j], start, w->angular_acceleration[j]);
    for (int sensor = 0; sensor < 2; sensor++) {
        s.warm_up[sensor] = copy_of(w, readings->warm_up[sensor], start, w->warm_up[sensor]);
        for (int j = 0; j < 3 && c->solves[sensor]; j++)
            (sensor == IMK_GYRO ? s.angular_rate : s.specific_force)[j] = w->solution[sensor][j];
        for (int j = 0; j < c->output_count[sensor]; j++)
            memset(w->solution[sensor][j], 0, sizeof w->solution[sensor][j]);
        for (int i = 0; i < c->distortion.axis_count[sensor]; i++) {
            const double *from = readings->channel[sensor][i] + start;
            const double zero = c->zero_offset[sensor][i], per_unit = c->per_unit[sensor][i];
            for (size_t k = 0; k < w->count; k++)
                w->reading[sensor][i][k] = (from[k] - zero) * per_unit;
            fill_up(w, w->reading[sensor][i]);
        }
    }
    for (int sensor = 0; sensor < 2; sensor++) {
        if (!c->solves[sensor])
            for (int j = 0; j < 3; j++)
                (sensor == IMK_GYRO ? s.angular_rate : s.specific_force)[j] = w->along[j];
        w->exposure[sensor] = imki_expose(sensor, &s);
        imk_stimulus first = s;
        memset(first.angular_rate, 0, sizeof first.angular_rate);
        memset(first.specific_force, 0, sizeof first.specific_force);
        w->first[sensor] = imki_expose(sensor, &first);
        /* Of a set that is not solved only its own axes see the inputs. */
        if (!c->solves[sensor])
            for (int j = 0; j < 3; j++)
                (sensor == IMK_GYRO ? s.angular_rate : s.specific_force)[j] = NULL;
    }
}

static void add_solution(work *w, const imk_correction *c)
{
    const imk_kernel kernel = c->distortion.kernel;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < c->output_count[sensor]; j++) {
            double *sum = w->solution[sensor][j];
            if (!c->solves[sensor]) {
                imki_add_residual(kernel, w->chunks, c->axis_inverse[sensor][j],
                                  w->residual[sensor][j], sum);
                continue;
            }
            const double *gain = c->inverse[3 * sensor + j];
            for (int of = 0; of < 2; of++)
                for (int i = 0; i < c->distortion.axis_count[of]; i++)
                    if (gain[of * IMK_AXES_MAX + i] != 0.0)
                        imki_add_residual(kernel, w->chunks, gain[of * IMK_AXES_MAX + i],
                                          w->residual[of][i], sum);
        }
}

static void iterate(work *w, const imk_correction *c, bool is_first)
{
    const imk_kernel kernel = c->distortion.kernel;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; !is_first && c->stays_within[sensor] && j < c->output_count[sensor]; j++)
            imki_limit(kernel, w->chunks, c->limit[sensor][j], w->solution[sensor][j]);
    for (int sensor = 0; sensor < 2; sensor++) {
        const imki_exposure *x = is_first ? &w->first[sensor] : &w->exposure[sensor];
        for (int i = 0; i < c->distortion.axis_count[sensor]; i++) {
            for (int j = 0; !c->solves[sensor] && j < 3; j++)
                for (size_t k = 0; k < w->chunks * IMKI_CHUNK; k++)
                    w->along[j][k] = c->along[sensor][i][j] * w->solution[sensor][i][k];
            imki_distort_chunks(kernel, &c->distortion.axis[sensor][i], x, w->chunks,
                                w->residual[sensor][i]);
            imki_residual(kernel, w->chunks, w->reading[sensor][i], w->residual[sensor][i]);
        }
    }
    add_solution(w, c);
}

void imk_correct(const imk_correction *correction, const imk_readings *readings, size_t count,
                 double *const out[2][IMK_AXES_MAX])
{
    work w;
    for (size_t start = 0; start < count; start += BLOCK) {
        w.count = count - start < BLOCK ? count - start : BLOCK;
        w.chunks = (w.count + IMKI_CHUNK - 1) / IMKI_CHUNK;
        load(&w, correction, readings, start);
        for (int i = 0; i < correction->iterations; i++)
            iterate(&w, correction, i == 0);
        for (int sensor = 0; sensor < 2; sensor++)
            for (int j = 0; j < correction->output_count[sensor]; j++)
                memcpy(out[sensor][j] + start, w.solution[sensor][j], w.count * sizeof **out[0]);
    }
}
