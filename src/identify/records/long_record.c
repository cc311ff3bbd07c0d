/* SPDX-License-Identifier: Apache-2.0 */
/* A long record, gathered as its samples come in: what is kept of them has the size of a segment
 * and of the means, not of the record. Samples are handled a chunk at a time, at the same places
 * however they were handed over. */
#include "imukit/fourier.h"
#include "long_record_internal.h"

#include <math.h>
#include <string.h>

enum {
    SEGMENT = 1 << 16,        /* transforms of that length stay in the second-level cache */
    CAPACITY_LEAST = 1 << 20, /* means */
    MISSING_SHARE = 100       /* a segment with more than a hundredth missing is left out */
};

/* Blocks of at most 128 samples, so that the slow spectrum and the fast one overlap well. */
imki_record_sizes imki_record_sizes_for(size_t expected)
{
    imki_record_sizes sizes = {SEGMENT, CAPACITY_LEAST};
    while (sizes.capacity < expected / 128 + 1 && sizes.capacity <= SIZE_MAX / 128)
        sizes.capacity *= 2;
    return sizes;
}

static size_t chunk_of(const imki_record_sizes *sizes)
{
    return sizes->segment < IMKI_CHUNK ? sizes->segment : IMKI_CHUNK;
}

static size_t sums_size(const imki_record_sizes *sizes)
{
    return chunk_of(sizes) + 2 * IMKI_STRIDE_ONE + 1;
}

static void lay_out(imk_identify_record *r, const imki_record_sizes *sizes, imki_parts *parts)
{
    const size_t segment = (sizes->segment + 1) * sizeof(double);
    r->buffer = imki_take(parts, segment);
    r->spectrum = imki_take(parts, segment);
    r->power = imki_take(parts, segment);
    r->transform_size = imk_cosine_workspace_size(sizes->segment);
    r->transform = imki_take(parts, r->transform_size);
    r->means = imki_take(parts, sizes->capacity * sizeof(double));
    r->sums = imki_take(parts, sums_size(sizes) * sizeof(double));
    r->map = imki_take(parts, sizeof *r->map);
}

size_t imki_record_memory(const imki_record_sizes *sizes)
{
    imk_identify_record unused;
    imki_parts parts = imki_parts_of(NULL);
    imki_take(&parts, sizeof unused);
    lay_out(&unused, sizes, &parts);
    return imki_parts_size(&parts);
}

imk_identify_record *imki_record_start(const imki_record_sizes *sizes, void *memory)
{
    imki_parts parts = imki_parts_of(memory);
    imk_identify_record *r = imki_take(&parts, sizeof *r);
    memset(r, 0, sizeof *r);
    r->sizes = *sizes;
    r->chunk = chunk_of(sizes);
    lay_out(r, sizes, &parts);
    memset(r->power, 0, (sizes->segment + 1) * sizeof(double));
    r->block = IMKI_BLOCK_LEAST;
    r->scale = 1;
    r->checks.last = (double)NAN;
    imki_record_allan_begin(r);
    imk_noise_map_begin(r->map);
    return r;
}

size_t imk_identify_record_size(size_t expected)
{
    const imki_record_sizes sizes = imki_record_sizes_for(expected);
    return imki_record_memory(&sizes);
}

imk_status imk_identify_record_begin(size_t expected, imk_identify_record **record, void *memory,
                                     size_t memory_size, imk_error *error)
{
    if (!memory || !record)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", NULL, NULL);
    if (memory_size < imk_identify_record_size(expected))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", NULL,
                             "imk_identify_record_size() bytes");
    const imki_record_sizes sizes = imki_record_sizes_for(expected);
    *record = imki_record_start(&sizes, memory);
    return IMK_OK;
}

imk_status imk_identify_record_copy(const imk_identify_record *record, imk_identify_record **copy,
                                    void *memory, size_t memory_size, imk_error *error)
{
    const size_t segment = (record->sizes.segment + 1) * sizeof(double);
    if (!memory || !copy)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", NULL, NULL);
    if (memory_size < imki_record_memory(&record->sizes))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", NULL,
                             "imk_identify_record_size() bytes");
    imk_identify_record *r = imki_record_start(&record->sizes, memory), places = *r;
    *r = *record;
    r->buffer = memcpy(places.buffer, record->buffer, segment);
    r->power = memcpy(places.power, record->power, segment);
    r->means = memcpy(places.means, record->means, record->mean_count * sizeof(double));
    r->sums = memcpy(places.sums, record->sums, sums_size(&record->sizes) * sizeof(double));
    r->spectrum = places.spectrum;
    r->transform = places.transform;
    *copy = r;
    return IMK_OK;
}

void imk_identify_record_subtract(imk_identify_record *r, double dt, imk_record_trend trend,
                                  const void *context)
{
    imki_record_flush(r);
    for (size_t i = 0; i < r->mean_count; i++) {
        const double time = ((double)i + 0.5) * (double)r->block * dt;
        const double part = trend(context, time);
        r->means[i] -= part * r->scale;
    }
}

/* Mean of the first chunk and a power of two that brings its span near 1, so that a constant
 * (gravity) costs no digits and no square overflows or vanishes. */
static void start(imk_identify_record *r, size_t count, const double *samples)
{
    double low = HUGE_VAL, high = -HUGE_VAL, sum = 0, present = 0;
    for (size_t i = 0; i < count; i++)
        if (samples[i] == samples[i]) {
            low = samples[i] < low ? samples[i] : low;
            high = samples[i] > high ? samples[i] : high;
        }
    if (!(high >= low))
        return; /* nothing is there */
    for (size_t i = 0; i < count; i++)
        if (samples[i] == samples[i]) {
            sum += samples[i] - low;
            present++;
        }
    int exponent;
    frexp(high - low, &exponent);
    r->shift = low + sum / present;
    r->scale = high > low ? ldexp(1, exponent < -1000  ? 1000
                                     : exponent > 1000 ? -1000
                                                       : -exponent)
                          : 1;
    r->started = true;
}

static double mean_of_block(const double *samples, size_t count)
{
    double lane[8] = {0};
    for (size_t i = 0; i < count; i += 8)
        for (size_t l = 0; l < 8; l++)
            lane[l] += samples[i + l];
    return (((lane[0] + lane[4]) + (lane[2] + lane[6])) +
            ((lane[1] + lane[5]) + (lane[3] + lane[7]))) /
           (double)count;
}

/* Mean of what is there; NaN when nothing is. */
static double mean_of_rest(const double *samples, size_t count)
{
    double sum = 0, present = 0;
    for (size_t i = 0; i < count; i++)
        if (samples[i] == samples[i]) {
            sum += samples[i];
            present++;
        }
    return present > 0 ? sum / present : (double)NAN;
}

/* Twice as many samples to a mean; one alone stands for both. */
static void join_means(imk_identify_record *r)
{
    for (size_t i = 0; i < r->mean_count / 2; i++) {
        const double a = r->means[2 * i], b = r->means[2 * i + 1];
        r->means[i] = a != a ? b : b != b ? a : 0.5 * (a + b);
    }
    r->mean_count /= 2;
    r->block *= 2;
}

static void add_means(imk_identify_record *r, size_t count, const double *samples, bool whole)
{
    for (size_t i = 0; i + r->block <= count; i += r->block) {
        if (r->mean_count == r->sizes.capacity)
            join_means(r); /* a chunk holds an even number of blocks, before and after */
        r->means[r->mean_count++] =
            whole ? mean_of_block(samples + i, r->block) : mean_of_rest(samples + i, r->block);
    }
}

void imki_record_transform(imk_identify_record *r)
{
    (void)imk_cosine(r->sizes.segment, r->spectrum, r->transform, r->transform_size); /* sized */
}

static void end_segment(imk_identify_record *r)
{
    const size_t n = r->sizes.segment;
    if (r->segments + r->skipped == 0) {
        /* The first one tells the steps between values; its sorted copy needs the room. */
        r->checks.resolution = imki_record_resolution(n, r->buffer, r->spectrum, n);
    }
    if (r->missing_here <= n / MISSING_SHARE) {
        memcpy(r->spectrum, r->buffer, n * sizeof(double));
        imki_record_transform(r);
        for (size_t k = 0; k < n; k++)
            r->power[k] += r->spectrum[k] * r->spectrum[k];
        r->segments++;
    } else {
        r->skipped++;
    }
    r->missing_before = r->missing_here;
    r->missing_here = r->filled = r->handled = 0;
}

/* Extremes and sums of whole chunks; lanes let the compiler use vectors. */
static void sum_up(imk_identify_record *r, size_t count, double *samples, double *low, double *high)
{
    enum { LANES = 8 };
    double least[LANES], most[LANES], sum[LANES] = {0}, squares[LANES] = {0};
    for (size_t l = 0; l < LANES; l++) {
        least[l] = HUGE_VAL;
        most[l] = -HUGE_VAL;
    }
    for (size_t i = 0; i < count; i += LANES) {
        const size_t width = count - i < LANES ? count - i : LANES;
        for (size_t l = 0; l < width; l++) {
            const double y = (samples[i + l] - r->shift) * r->scale;
            const double there = y == y ? y : 0;
            samples[i + l] = y;
            least[l] = y < least[l] ? y : least[l];
            most[l] = y > most[l] ? y : most[l];
            sum[l] += there;
            squares[l] += there * there;
        }
    }
    double all = 0, all_squares = 0;
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (size_t l = 0; l < LANES; l++) {
        *low = least[l] < *low ? least[l] : *low;
        *high = most[l] > *high ? most[l] : *high;
        all += sum[l];
        all_squares += squares[l];
    }
    r->sum += all;
    r->squares += all_squares;
}

static size_t count_missing(size_t count, const double *samples)
{
    size_t missing = 0;
    for (size_t i = 0; i < count; i++)
        missing += samples[i] != samples[i];
    return missing;
}

static void handle(imk_identify_record *r, size_t count)
{
    double *samples = r->buffer + r->handled, low, high;
    if (!r->started)
        start(r, count, samples);
    const size_t missing = count_missing(count, samples);
    sum_up(r, count, samples, &low, &high);
    if (missing < count)
        imki_record_check(&r->checks, count, samples, low, high);
    add_means(r, count, samples, missing == 0);
    imk_noise_map_add(r->map, count, samples);
    if (missing > 0)
        imki_record_bridge(count, samples, 0, r->samples);
    if (missing <= count / MISSING_SHARE)
        imki_record_allan_add(r, count, samples);
    else
        r->carried = false; /* windows begin anew behind the hole */
    r->samples += count;
    r->missing += missing;
    r->missing_here += missing;
    r->handled += count;
}

void imki_record_flush(imk_identify_record *r)
{
    if (r->filled > r->handled)
        handle(r, r->filled - r->handled);
}

static imk_status refuse_infinite(const imk_identify_record *r, size_t ahead, imk_error *error)
{
    const size_t place = r->samples + (r->filled - r->handled) + ahead;
    imk_error_set(error, IMK_ERROR_NOT_FINITE, NULL, NULL,
                  "remove such samples, or mark them as "
                  "missing (NaN)");
    if (error)
        error->index = place < INT32_MAX ? (int)place : -1;
    return IMK_ERROR_NOT_FINITE;
}

imk_status imk_identify_record_add(imk_identify_record *r, size_t count, const double *samples,
                                   imk_error *error)
{
    for (size_t i = 0; i < count; i++)
        if (fabs(samples[i]) > 1.7976931348623157e308)
            return refuse_infinite(r, i, error);
    while (count > 0) {
        if (r->block > r->chunk / 2)
            return imk_error_set(error, IMK_ERROR_RANGE, NULL, NULL,
                                 "fewer samples, or state their number at the start");
        const size_t room = r->handled + r->chunk - r->filled;
        const size_t part = count < room ? count : room;
        memcpy(r->buffer + r->filled, samples, part * sizeof(double));
        r->filled += part;
        samples += part;
        count -= part;
        if (r->filled == r->handled + r->chunk)
            handle(r, r->chunk);
        if (r->handled == r->sizes.segment)
            end_segment(r);
    }
    return IMK_OK;
}

const imk_allan_point *imk_identify_record_curve(const imk_identify_record *r, size_t *count)
{
    *count = r->octave_count;
    return r->octave;
}

const imk_noise_map *imk_identify_record_map(const imk_identify_record *r)
{
    return r->map;
}
