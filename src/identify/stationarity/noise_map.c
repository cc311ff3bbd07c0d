/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamic Allan map [GALLEANI2009] of Haar differences: with means M_0(k) = samples,
 *
 *     d_j(k) = M_j(2k + 1) - M_j(2k),   M_j+1(k) = (M_j(2k) + M_j(2k + 1))/2
 *
 * the Allan variance at 2^j samples is the mean of d_j^2/2, and no difference shares a sample with
 * another one of its octave [PERCIVAL1994]. Sums of d are kept for octaves and blocks of time. */
#include "noise_map_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { CHUNK = IMK_NOISE_MAP_CHUNK, LANES = 4 };

/* Share of samples that both means of a difference need. */
static const double share_least = 0.75;

void imk_noise_map_begin(imk_noise_map *map)
{
    memset(map, 0, sizeof *map);
    map->block = CHUNK;
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++)
        map->share[j] = -1;
}

static void join_cells(imk_noise_cell *to, const imk_noise_cell *a, const imk_noise_cell *b)
{
    const imk_noise_cell sum = {a->count + b->count, a->absolute + b->absolute,
                                a->square + b->square, a->fourth + b->fourth};
    *to = sum;
}

static void join_blocks(imk_noise_map *map)
{
    static const imk_noise_cell none = {0, 0, 0, 0};
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++) {
        imk_noise_cell *row = map->cell[j];
        for (size_t b = 0; b < IMK_NOISE_MAP_BLOCKS / 2; b++)
            join_cells(&row[b], &row[2 * b], &row[2 * b + 1]);
        for (size_t b = IMK_NOISE_MAP_BLOCKS / 2; b < IMK_NOISE_MAP_BLOCKS; b++)
            row[b] = none;
    }
    map->block *= 2;
}

static void add_difference(imk_noise_cell *cell, double d)
{
    const double square = d * d;
    cell->count++;
    cell->absolute += fabs(d);
    cell->square += square;
    cell->fourth += square * square;
}

/* One more mean of an octave; goes up while it is the second of two. */
static void push(imk_noise_map *map, size_t octave, double mean, double share)
{
    for (size_t j = octave; j < IMK_NOISE_MAP_OCTAVES; j++) {
        const double first = map->waiting[j], part = map->share[j];
        if (part < 0) {
            map->waiting[j] = mean;
            map->share[j] = share;
            return;
        }
        map->share[j] = -1;
        if (part >= share_least && share >= share_least) {
            /* of white noise, missing samples raise the variance of the mean */
            const double excess = 0.5 / part + 0.5 / share;
            const size_t begin = (map->done >> (j + 1)) << (j + 1); /* of its window */
            add_difference(&map->cell[j][begin / map->block], (mean - first) / sqrt(excess));
        }
        mean = part + share > 0 ? (first * part + mean * share) / (part + share) : 0;
        share = 0.5 * (part + share);
    }
}

/* Differences of a row of means without holes, which become the means of the next octave. */
static void take_row(size_t count, double *mean, imk_noise_cell *cell)
{
    double absolute[LANES] = {0}, square[LANES] = {0}, fourth[LANES] = {0};
    for (size_t k = 0; k < count / 2; k += LANES)
        for (size_t l = 0; l < LANES && k + l < count / 2; l++) {
            const double first = mean[2 * (k + l)], second = mean[2 * (k + l) + 1];
            const double d = second - first, dd = d * d;
            absolute[l] += fabs(d);
            square[l] += dd;
            fourth[l] += dd * dd;
            mean[k + l] = 0.5 * (first + second);
        }
    cell->count += (double)(count / 2);
    cell->absolute += (absolute[0] + absolute[1]) + (absolute[2] + absolute[3]);
    cell->square += (square[0] + square[1]) + (square[2] + square[3]);
    cell->fourth += (fourth[0] + fourth[1]) + (fourth[2] + fourth[3]);
}

static void take_chunk(imk_noise_map *map)
{
    double *samples = map->buffer, missing = 0;
    if (map->done == map->block * IMK_NOISE_MAP_BLOCKS)
        join_blocks(map);
    for (size_t i = 0; i < CHUNK; i++)
        missing += samples[i] != samples[i];
    const size_t block = map->done / map->block;
    if (missing > 0) {
        for (size_t i = 0; i < CHUNK; i++) {
            const bool there = samples[i] == samples[i];
            push(map, 0, there ? samples[i] : 0, there);
            map->done++;
        }
    } else {
        size_t octave = 0;
        for (size_t count = CHUNK; count > 1; count /= 2)
            take_row(count, samples, &map->cell[octave++][block]);
        push(map, octave, samples[0], 1);
        map->done += CHUNK;
    }
    map->filled = 0;
}

void imk_noise_map_add(imk_noise_map *map, size_t count, const double *samples)
{
    map->samples += count;
    while (count > 0) {
        const size_t room = CHUNK - map->filled, part = count < room ? count : room;
        memcpy(map->buffer + map->filled, samples, part * sizeof *samples);
        map->filled += part;
        samples += part;
        count -= part;
        if (map->filled == CHUNK)
            take_chunk(map);
    }
}

void imk_noise_map_end(imk_noise_map *map)
{
    if (map->filled == 0)
        return;
    for (size_t i = map->filled; i < CHUNK; i++)
        map->buffer[i] = (double)NAN;
    take_chunk(map);
}

void imk_noise_map_rescale(imk_noise_map *map, double factor)
{
    const double square = factor * factor;
    for (size_t j = 0; j < IMK_NOISE_MAP_OCTAVES; j++)
        for (size_t b = 0; b < IMK_NOISE_MAP_BLOCKS; b++) {
            map->cell[j][b].absolute *= factor;
            map->cell[j][b].square *= square;
            map->cell[j][b].fourth *= square * square;
        }
}

size_t imk_noise_map_blocks(const imk_noise_map *map)
{
    return (map->samples + map->block - 1) / map->block;
}

imk_noise_cell imki_noise_cells(const imk_noise_map *map, size_t octave, size_t first, size_t end)
{
    imk_noise_cell sum = {0, 0, 0, 0};
    for (size_t b = first; b < end && b < IMK_NOISE_MAP_BLOCKS; b++)
        join_cells(&sum, &sum, &map->cell[octave][b]);
    return sum;
}

size_t imk_noise_map_octaves(const imk_noise_map *map)
{
    enum { LEAST = 16 };
    size_t octaves = 0;
    while (octaves < IMK_NOISE_MAP_OCTAVES &&
           imki_noise_cells(map, octaves, 0, IMK_NOISE_MAP_BLOCKS).count >= LEAST)
        octaves++;
    return octaves;
}

imk_estimate imk_noise_map_deviation(const imk_noise_map *map, size_t octave, size_t first,
                                     size_t end, double confidence)
{
    imk_estimate e = {.upper = HUGE_VAL};
    if (octave >= IMK_NOISE_MAP_OCTAVES)
        return e;
    const imk_noise_cell sum = imki_noise_cells(map, octave, first, end);
    if (!(sum.count > 0))
        return e;
    const double n = sum.count, tail = 0.5 * (1 - confidence);
    e.present = true;
    e.value = e.free_value = sqrt(0.5 * sum.square / n);
    e.sigma = e.value / sqrt(2 * n);
    e.lower = e.value * sqrt(n / imk_chi_square_quantile(1 - tail, n));
    e.upper = e.value * sqrt(n / imk_chi_square_quantile(tail, n));
    return e;
}
