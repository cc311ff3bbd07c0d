/* SPDX-License-Identifier: Apache-2.0 */
/* Means of what sensors on a trajectory read, written once for every instruction set. No include
 * guard: each trajectory_*.c defines first
 *
 *     LANES              how many intervals are worked at once: 1, 2, 4 or 8
 *     real               a vector of LANES doubles
 *     square_root(a)     correctly rounded, lane by lane
 *     KERNEL             how small functions are declared, unless they shall always be inlined
 *
 * Each lane sees the same operations in the same order whatever LANES is.
 *
 * Means over an interval are by the Gauss-Lobatto formula with five nodes, 0, (1 -+ sqrt(3/7))/2,
 * 1/2 and 1, whose weights are 1/20, 49/180, 16/45 [ABRAMOWITZ1964, 25.4.32]; as differences to the
 * middle, so that the mean of a constant is that constant. */
#include "trajectory_node.h"

#include <string.h>

/* ---- one interval ---------------------------------------------------------------------------- */

#define INNER_NODE 0.17267316464601143 /* (1 - sqrt(3/7))/2 */
#define END_WEIGHT (1.0 / 20.0)
#define INNER_WEIGHT (49.0 / 180.0)

/* -0 becomes 0, so that it cannot matter whether a constant was integrated or copied. */
KERNEL vector lobatto_mean(vector begin, vector early, vector middle, vector late, vector end)
{
    const vector ends = sum(difference(begin, middle), difference(end, middle));
    const vector inner = sum(difference(early, middle), difference(late, middle));
    vector mean;
    for (int i = 0; i < 3; i++)
        mean.v[i] = (middle.v[i] + (END_WEIGHT * ends.v[i] + INNER_WEIGHT * inner.v[i])) + 0.0;
    return mean;
}

/* What the mean over an interval needs of its nodes. */
typedef struct reading {
    vector rate, force, gravity;
} reading;

/* Gravity in the middle and at the end of an interval, found before all else: these long chains of
 * operations then go on beside the rest. */
typedef struct gravities {
    vector middle, end;
} gravities;

KERNEL gravities gravity_ahead(const imk_trajectory *trajectory, bool shaken,
                               const coefficients *from, real s0, real s1)
{
    if (shaken)
        return (gravities){zero_vector(), zero_vector()};
    return (gravities){smooth_gravity(trajectory, from, s0 + 0.5 * (s1 - s0)),
                       smooth_gravity(trajectory, from, s1)};
}

/* Where a trajectory is shaken, each node finds its own gravity; otherwise it may be known. */
KERNEL reading reading_at(const imk_trajectory *trajectory, bool shaken, const coefficients *from,
                          real time, real s, const vector *gravity)
{
    const node at = node_at(trajectory, shaken, from, time, s, shaken ? NULL : gravity);
    return (reading){at.rate, at.force, at.gravity};
}

/* The quadratic through gravity at the ends and in the middle, at fraction x of the interval: over
 * 1 km its error is 1e-13 of gravity. */
KERNEL vector gravity_between(const reading *begin, vector middle, const reading *end, double x)
{
    const double away = 2.0 * x - 1.0;
    const vector drift = scaled(spread(0.5), difference(end->gravity, begin->gravity));
    const vector bend = scaled(
        spread(0.5), sum(difference(begin->gravity, middle), difference(end->gravity, middle)));
    return sum(middle, sum(scaled(spread(away), drift), scaled(spread(away * away), bend)));
}

KERNEL void interval_means(const imk_trajectory *trajectory, bool shaken, const coefficients *from,
                           real start, real t0, real t1, const reading *begin, const reading *end,
                           const gravities *ahead, vector *rate, vector *force)
{
    const real s0 = t0 - start, s1 = t1 - start;
    const reading middle = reading_at(trajectory, shaken, from, t0 + 0.5 * (t1 - t0),
                                      s0 + 0.5 * (s1 - s0), &ahead->middle);
    const double x[] = {INNER_NODE, 1.0 - INNER_NODE};
    reading inner[2];
    for (int i = 0; i < 2; i++) {
        const vector gravity = gravity_between(begin, middle.gravity, end, x[i]);
        inner[i] = reading_at(trajectory, shaken, from, t0 + x[i] * (t1 - t0),
                              s0 + x[i] * (s1 - s0), &gravity);
    }
    *rate = lobatto_mean(begin->rate, inner[0].rate, middle.rate, inner[1].rate, end->rate);
    *force = lobatto_mean(begin->force, inner[0].force, middle.force, inner[1].force, end->force);
}

/* ---- many intervals -------------------------------------------------------------------------- */

/* The vector that begins with the last lane of `before` and goes on with `now`. */
KERNEL real delayed(real before, real now)
{
#if LANES == 8
    return __builtin_shufflevector(before, now, 7, 8, 9, 10, 11, 12, 13, 14);
#elif LANES == 4
    return __builtin_shufflevector(before, now, 3, 4, 5, 6);
#elif LANES == 2
    return __builtin_shufflevector(before, now, 1, 2);
#else
    (void)now;
    return before;
#endif
}

KERNEL reading delayed_reading(const reading *before, const reading *now)
{
    reading result;
    for (int i = 0; i < 3; i++) {
        result.rate.v[i] = delayed(before->rate.v[i], now->rate.v[i]);
        result.force.v[i] = delayed(before->force.v[i], now->force.v[i]);
        result.gravity.v[i] = delayed(before->gravity.v[i], now->gravity.v[i]);
    }
    return result;
}

/* The node at the end of an interval is that at the beginning of the next one. */
KERNEL void sample_means(const imk_trajectory *trajectory, bool shaken, bool cubic,
                         const imk_trajectory_piece *piece, size_t count, const double *boundary,
                         const imki_means *means)
{
    coefficients from;
    from.same = true;
    from.cubic = cubic;
    from.position = &piece->position[0][0];
    from.quaternion = &piece->quaternion[0][0];
    const real start = spread(piece->start);
    const real first = spread(boundary[0]);
    reading before = reading_at(trajectory, shaken, &from, first, first - start, NULL);
    for (size_t k = 0; k < count; k += LANES) {
        const real t0 = load(boundary + k), t1 = load(boundary + k + 1);
        const gravities ahead = gravity_ahead(trajectory, shaken, &from, t0 - start, t1 - start);
        const reading end = reading_at(trajectory, shaken, &from, t1, t1 - start, &ahead.end);
        const reading begin = delayed_reading(&before, &end);
        vector rate, force;
        interval_means(trajectory, shaken, &from, start, t0, t1, &begin, &end, &ahead, &rate,
                       &force);
        for (int i = 0; i < 3; i++) {
            store(means->rate[i] + k, rate.v[i]);
            store(means->force[i] + k, force.v[i]);
            if (means->acceleration[0])
                store(means->acceleration[i] + k, (end.rate.v[i] - begin.rate.v[i]) / (t1 - t0));
        }
        before = end;
    }
}

/* The same coefficient of all lanes' pieces; put together in a register. */
KERNEL real across(const double *const first[LANES], size_t i)
{
    real all = spread(0.0);
    for (int lane = 0; lane < LANES; lane++)
        all[lane] = first[lane][i];
    return all;
}

KERNEL void gather(const imk_trajectory_piece *const *piece, bool cubic, coefficients *from)
{
    const double *position[LANES], *quaternion[LANES];
    for (size_t lane = 0; lane < LANES; lane++) {
        position[lane] = &piece[lane]->position[0][0];
        quaternion[lane] = &piece[lane]->quaternion[0][0];
    }
    from->same = false;
    from->cubic = cubic;
    for (size_t i = 0; i < 21; i++)
        if (!cubic || i % 7 < 4)
            from->gathered_position[i] = across(position, i);
    for (size_t i = 0; i < 24; i++)
        if (!cubic || i % 6 < 4)
            from->gathered_quaternion[i] = across(quaternion, i);
}

KERNEL void interval_group(const imk_trajectory *trajectory, bool shaken, bool cubic, size_t group,
                           imki_intervals *intervals)
{
    coefficients from;
    real start;
    gather(intervals->piece + group, cubic, &from);
    for (int lane = 0; lane < LANES; lane++)
        start[lane] = intervals->piece[group + lane]->start;
    const real t0 = load(intervals->begin + group), t1 = load(intervals->end + group);
    const gravities ahead = gravity_ahead(trajectory, shaken, &from, t0 - start, t1 - start);
    const reading begin = reading_at(trajectory, shaken, &from, t0, t0 - start, NULL);
    const reading end = reading_at(trajectory, shaken, &from, t1, t1 - start, &ahead.end);
    vector rate, force;
    interval_means(trajectory, shaken, &from, start, t0, t1, &begin, &end, &ahead, &rate, &force);
    for (int i = 0; i < 3; i++) {
        store(intervals->rate[i] + group, rate.v[i]);
        store(intervals->force[i] + group, force.v[i]);
        store(intervals->first[i] + group, begin.rate.v[i]);
        store(intervals->last[i] + group, end.rate.v[i]);
    }
}

/* ---- the ways to do it ----------------------------------------------------------------------- */

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Without powers above the third, as in splines through poses: half the work. By the bits, as
 * comparing doubles takes as long as a node; a -0 is merely taken for a power. */
static bool is_cubic(const imk_trajectory_piece *piece)
{
    uint64_t higher = 0;
    for (int axis = 0; axis < 3; axis++)
        for (int power = 4; power < 7; power++)
            higher |= bits_of(piece->position[axis][power]);
    for (int part = 0; part < 4; part++)
        for (int power = 4; power < 6; power++)
            higher |= bits_of(piece->quaternion[part][power]);
    return higher == 0;
}

static void means_of_samples(const imk_trajectory *trajectory, const imk_trajectory_piece *piece,
                             size_t count, const double *boundary, const imki_means *means)
{
    if (trajectory->line_count > 0)
        sample_means(trajectory, true, false, piece, count, boundary, means);
    else if (is_cubic(piece))
        sample_means(trajectory, false, true, piece, count, boundary, means);
    else
        sample_means(trajectory, false, false, piece, count, boundary, means);
}

/* Lanes beyond the last interval repeat it. */
static void means_of_intervals(const imk_trajectory *trajectory, size_t count,
                               imki_intervals *intervals)
{
    bool cubic = true;
    for (size_t i = 0; cubic && i < count; i++)
        cubic = is_cubic(intervals->piece[i]);
    for (size_t i = count; i % LANES != 0; i++) {
        intervals->begin[i] = intervals->begin[count - 1];
        intervals->end[i] = intervals->end[count - 1];
        intervals->piece[i] = intervals->piece[count - 1];
    }
    for (size_t group = 0; group < count; group += LANES) {
        if (trajectory->line_count > 0)
            interval_group(trajectory, true, false, group, intervals);
        else if (cubic)
            interval_group(trajectory, false, true, group, intervals);
        else
            interval_group(trajectory, false, false, group, intervals);
    }
}
