/* SPDX-License-Identifier: Apache-2.0 */
/* Means of angular rate and specific force over the samples of a trajectory: samples are cut where
 * pieces meet, and the parts are handed to the kernel of trajectory_kernel.h, eight at a time or,
 * where eight samples or more lie within one piece, in rows. */
#include "trajectory_internal.h"

#include <math.h>
#include <string.h>

typedef struct kernel_set {
    imki_means_of_intervals *intervals;
    imki_means_of_samples *samples;
} kernel_set;

static kernel_set kernels_of(imk_kernel kernel)
{
#if defined(__x86_64__) && defined(__GNUC__)
    if (kernel == IMK_KERNEL_AVX512)
        return (kernel_set){imki_means_of_intervals_avx512, imki_means_of_samples_avx512};
    if (kernel == IMK_KERNEL_AVX2)
        return (kernel_set){imki_means_of_intervals_avx2, imki_means_of_samples_avx2};
#endif
    (void)kernel;
    return (kernel_set){imki_means_of_intervals_portable, imki_means_of_samples_portable};
}

/* ---- the piece at a time --------------------------------------------------------------------- */

/* A piece without accelerations that goes on from where `piece` is at s, with its velocity and its
 * angular rate. What changes the norm of the quaternion only is left out, so that it never gets 0.
 */
static void go_on_from(const imk_trajectory_piece *piece, double s, imk_trajectory_piece *on)
{
    memset(on, 0, sizeof *on);
    on->start = piece->start + s;
    double square = 0.0, growth = 0.0;
    for (int i = 0; i < 3; i++)
        for (int power = 6; power >= 0; power--) {
            on->position[i][1] = on->position[i][1] * s + on->position[i][0];
            on->position[i][0] = on->position[i][0] * s + piece->position[i][power];
        }
    for (int i = 0; i < 4; i++) {
        double *const q = on->quaternion[i];
        for (int power = 5; power >= 0; power--) {
            q[1] = q[1] * s + q[0];
            q[0] = q[0] * s + piece->quaternion[i][power];
        }
        square += q[0] * q[0];
        growth += q[0] * q[1];
    }
    for (int i = 0; i < 4; i++)
        on->quaternion[i][1] -= on->quaternion[i][0] * (growth / square);
}

/* Enter the piece before `next`, or what is before or after all of them. */
static void enter(imki_cursor *cursor)
{
    const imk_trajectory *trajectory = cursor->trajectory;
    const imk_trajectory_piece *piece = trajectory->piece;
    const size_t count = trajectory->piece_count, next = cursor->next;
    cursor->piece = &cursor->beyond;
    cursor->end = (double)INFINITY;
    if (next == 0) {
        go_on_from(&piece[0], 0.0, &cursor->beyond);
        cursor->end = piece[0].start;
    } else if (next > count) {
        go_on_from(&piece[count - 1], piece[count - 1].length, &cursor->beyond);
    } else {
        cursor->piece = &piece[next - 1];
        cursor->end =
            next < count ? piece[next].start : piece[next - 1].start + piece[next - 1].length;
    }
}

void imki_cursor_start(imki_cursor *cursor, const imk_trajectory *trajectory, double time)
{
    size_t low = 0, high = trajectory->piece_count; /* pieces that start at or before the time */
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (trajectory->piece[middle].start <= time)
            low = middle + 1;
        else
            high = middle;
    }
    cursor->trajectory = trajectory;
    cursor->next = low;
    enter(cursor);
    imki_cursor_advance(cursor, time);
}

void imki_cursor_advance(imki_cursor *cursor, double time)
{
    while (time >= cursor->end) {
        cursor->next++;
        enter(cursor);
    }
}

/* By how much a time may be past the end by rounding: sums of steps, rows over rates and times in
 * text do not meet in the last digits. */
static double rounding_at(const imk_trajectory_piece *piece, double end)
{
    const double of_piece = 1e-6, of_time = 0x1p-48;
    return of_piece * piece->length + of_time * fmax(fabs(piece->start), fabs(end));
}

const imk_trajectory_piece *imki_cursor_at(imki_cursor *cursor, double time)
{
    const imk_trajectory *trajectory = cursor->trajectory;
    const imk_trajectory_piece *last = &trajectory->piece[trajectory->piece_count - 1];
    const double end = last->start + last->length;
    imki_cursor_advance(cursor, time);
    return time >= end && time - end <= rounding_at(last, end) ? last : cursor->piece;
}

static bool is_constant(const imk_trajectory *trajectory, const imk_trajectory_piece *piece)
{
    if (trajectory->line_count > 0)
        return false;
    for (int power = 1; power < 6; power++)
        for (int i = 0; i < 4; i++)
            if (piece->quaternion[i][power] != 0.0)
                return false;
    for (int power = 1; power < 7; power++)
        for (int i = 0; i < 3; i++)
            if (piece->position[i][power] != 0.0)
                return false;
    return true;
}

/* ---- parts of samples ------------------------------------------------------------------------ */

/* Parts on their way to the kernel, in order of time. */
typedef struct part_list {
    size_t count;
    size_t sample[IMKI_INTERVALS];
    imki_intervals intervals;
    double first[3]; /* rates where the sample under way began */
} part_list;

/* Take the means of the parts and add them up to samples. A sample of one part is its mean. */
static void finish_batch(const kernel_set *kernels, const imk_trajectory *trajectory,
                         const double *boundary, const imki_means *means, part_list *batch)
{
    imki_intervals *const part = &batch->intervals;
    if (batch->count == 0)
        return;
    kernels->intervals(trajectory, batch->count, part);
    for (size_t i = 0; i < batch->count; i++) {
        const size_t k = batch->sample[i];
        const double length = boundary[k + 1] - boundary[k];
        const bool begins = part->begin[i] == boundary[k], ends = part->end[i] == boundary[k + 1];
        const double share = begins && ends ? 1.0 : (part->end[i] - part->begin[i]) / length;
        for (int axis = 0; axis < 3; axis++) {
            double *const rate = &means->rate[axis][k], *const force = &means->force[axis][k];
            *rate = (begins ? 0.0 : *rate) + share * part->rate[axis][i];
            *force = (begins ? 0.0 : *force) + share * part->force[axis][i];
            if (begins)
                batch->first[axis] = part->first[axis][i];
            if (ends && means->acceleration[0])
                means->acceleration[axis][k] = (part->last[axis][i] - batch->first[axis]) / length;
        }
    }
    batch->count = 0;
}

/* The means of one sample, cut where pieces meet. The cursor is left where it ends. */
static void add_sample(const kernel_set *kernels, imki_cursor *cursor, size_t k,
                       const double *boundary, const imki_means *means, part_list *batch)
{
    double begin = boundary[k];
    for (;;) {
        imki_cursor_advance(cursor, begin);
        const bool last = !(boundary[k + 1] > cursor->end);
        const double end = last ? boundary[k + 1] : cursor->end;
        const size_t i = batch->count++;
        batch->sample[i] = k;
        batch->intervals.begin[i] = begin;
        batch->intervals.end[i] = end;
        batch->intervals.piece[i] = cursor->piece;
        /* A piece beyond the ends is overwritten when the cursor moves on. */
        if (batch->count == IMKI_INTERVALS || cursor->piece == &cursor->beyond)
            finish_batch(kernels, cursor->trajectory, boundary, means, batch);
        if (last)
            return;
        begin = end;
    }
}

/* All samples read what one of them does. */
static void fill_constant(const kernel_set *kernels, const imki_cursor *cursor, size_t first,
                          size_t count, const double *boundary, const imki_means *means)
{
    imki_intervals part;
    part.begin[0] = boundary[first];
    part.end[0] = boundary[first + 1];
    part.piece[0] = cursor->piece;
    kernels->intervals(cursor->trajectory, 1, &part);
    for (int axis = 0; axis < 3; axis++)
        for (size_t k = first; k < first + count; k++) {
            means->rate[axis][k] = part.rate[axis][0];
            means->force[axis][k] = part.force[axis][0];
            if (means->acceleration[0])
                means->acceleration[axis][k] = 0.0;
        }
}

void imk_trajectory_means(const imk_trajectory *trajectory, imk_kernel kernel, size_t count,
                          const double *boundary, double *const rate[3],
                          double *const acceleration[3], double *const force[3])
{
    if (count == 0)
        return;
    const kernel_set kernels = kernels_of(kernel);
    imki_means means = {
        {rate[0], rate[1], rate[2]}, {NULL, NULL, NULL}, {force[0], force[1], force[2]}};
    for (int axis = 0; acceleration && axis < 3; axis++)
        means.acceleration[axis] = acceleration[axis];
    imki_cursor cursor;
    imki_cursor_start(&cursor, trajectory, boundary[0]);
    part_list batch = {.count = 0};
    size_t k = 0;
    while (k < count) {
        imki_cursor_advance(&cursor, boundary[k]);
        size_t whole = 0;
        while (k + whole < count && boundary[k + whole + 1] <= cursor.end)
            whole++;
        const bool constant = whole > 0 && is_constant(trajectory, cursor.piece);
        if (!constant)
            whole -= whole % IMKI_INTERVALS;
        if (whole == 0) {
            add_sample(&kernels, &cursor, k++, boundary, &means, &batch);
            continue;
        }
        if (constant) {
            fill_constant(&kernels, &cursor, k, whole, boundary, &means);
        } else {
            const imki_means from = {{rate[0] + k, rate[1] + k, rate[2] + k},
                                     {means.acceleration[0] ? means.acceleration[0] + k : NULL,
                                      means.acceleration[0] ? means.acceleration[1] + k : NULL,
                                      means.acceleration[0] ? means.acceleration[2] + k : NULL},
                                     {force[0] + k, force[1] + k, force[2] + k}};
            kernels.samples(trajectory, cursor.piece, whole, boundary + k, &from);
        }
        k += whole;
    }
    finish_batch(&kernels, trajectory, boundary, &means, &batch);
}
