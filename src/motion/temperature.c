/* SPDX-License-Identifier: Apache-2.0 */
/* Temperature of a unit that follows its surroundings, T' = (u - T)/tau. Between two points the
 * surroundings are u + m s; with x = s/tau and E = 1 - e^{-x}
 *
 *     T(s)  = T + (u - T) E + m tau (x - E)
 *     T'(s) = (u - T)/tau (1 - E) + m E
 *
 * exactly, so the temperature at each point follows from that at the one before. From x = 40 on, E
 * is 1 to rounding. */
#include "imukit/motion.h"

#include "base/refuse_internal.h"

#include <math.h>
#include <string.h>

/* ---- between two points ---------------------------------------------------------------------- */

/* The straight line of the surroundings from a point on. */
typedef struct straight {
    double start, value, slope;
} straight;

/* The line after point i; level after the last one, and where the next point is at the same time.
 */
static straight line_after(const imk_temperature_profile *profile, size_t i)
{
    straight line = {profile->time[i], profile->temperature[i], 0.0};
    if (i + 1 < profile->point_count && profile->time[i + 1] > profile->time[i])
        line.slope =
            (profile->temperature[i + 1] - line.value) / (profile->time[i + 1] - line.start);
    return line;
}

/* 1 - e^{-x} for 0 <= x < 41, without branches, so that compilers work several at once:
 *
 *     n = nearest x / ln 2,   r = n ln 2 - x,   E = (1 - 2^-n) - 2^-n (r + r^2/2! + r^3/3! + ...)
 *
 * where |r| < 0.35 and the next term is below 1e-17. For x < 0.34 n is 0, and nothing cancels; the
 * error is below 2e-16 and 2 ulp. */
static inline double approach_of(double x)
{
    const double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33; /* n high: exact */
    const double shifted = x * 1.4426950408889634 + 0x1.8p52;
    const double n = shifted - 0x1.8p52;
    uint64_t bits;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (UINT64_C(1023) << 52) - (bits << 52); /* the last bits of `shifted` are n */
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    const double r = (n * ln2_high - x) + n * ln2_low, rr = r * r;
    double even = 1.0 / 479001600.0, odd = 1.0 / 6227020800.0;
    even = even * rr + 1.0 / 3628800.0;
    odd = odd * rr + 1.0 / 39916800.0;
    even = even * rr + 1.0 / 40320.0;
    odd = odd * rr + 1.0 / 362880.0;
    even = even * rr + 1.0 / 720.0;
    odd = odd * rr + 1.0 / 5040.0;
    even = even * rr + 1.0 / 24.0;
    odd = odd * rr + 1.0 / 120.0;
    even = even * rr + 1.0 / 2.0;
    odd = odd * rr + 1.0 / 6.0;
    return (1.0 - scale) - scale * (r + rr * (even + r * odd));
}

/* How the unit goes on from a point: T, u - T, m, m tau. */
typedef struct course {
    double start, temperature, gap, slope, lag;
    double time_constant;
    double settled; /* from this time on T = u + m (s - tau); at once when tau is 0 */
} course;

static course course_from(const straight *line, double time_constant, double temperature)
{
    return (course){.start = line->start,
                    .temperature = temperature,
                    .gap = line->value - temperature,
                    .slope = line->slope,
                    .lag = line->slope * time_constant,
                    .time_constant = time_constant,
                    .settled = line->start + 40.0 * time_constant};
}

/* Temperature at times of the course before it has settled, and its rate unless `rate` is NULL. */
static void follow(const course *from, size_t count, const double *time, double *temperature,
                   double *rate)
{
    const course c = *from;
    const double inverse = 1.0 / c.time_constant, decay = c.gap * inverse;
    if (!rate) {
        for (size_t k = 0; k < count; k++) {
            const double x = (time[k] - c.start) * inverse, approach = approach_of(x);
            temperature[k] = c.temperature + (c.gap * approach + c.lag * (x - approach));
        }
        return;
    }
    for (size_t k = 0; k < count; k++) {
        const double x = (time[k] - c.start) * inverse, approach = approach_of(x);
        temperature[k] = c.temperature + (c.gap * approach + c.lag * (x - approach));
        rate[k] = decay * (1.0 - approach) + c.slope * approach;
    }
}

/* The same after that. */
static void go_along(const course *from, size_t count, const double *time, double *temperature,
                     double *rate)
{
    const course c = *from;
    const double value = c.temperature + c.gap;
    for (size_t k = 0; k < count; k++)
        temperature[k] = value + (c.slope * (time[k] - c.start) - c.lag);
    for (size_t k = 0; rate && k < count; k++)
        rate[k] = c.slope;
}

static void take_course(const course *from, size_t count, const double *time, double *temperature,
                        double *rate)
{
    if (time[0] < from->settled)
        follow(from, count, time, temperature, rate);
    else
        go_along(from, count, time, temperature, rate);
}

/* From point i to point i + 1. */
static double carry(const imk_temperature_profile *profile, size_t i, double temperature)
{
    const straight line = line_after(profile, i);
    const course from = course_from(&line, profile->time_constant, temperature);
    double next;
    take_course(&from, 1, &profile->time[i + 1], &next, NULL);
    return next;
}

void imk_temperature_carry(const imk_temperature_profile *profile, double *carried)
{
    carried[0] = profile->temperature[0];
    for (size_t i = 0; i + 1 < profile->point_count; i++)
        carried[i + 1] = carry(profile, i, carried[i]);
}

imk_status imk_temperature_validate(const imk_temperature_profile *profile, imk_error *error)
{
    if (profile->point_count == 0 || !profile->time || !profile->temperature)
        return imk_error_set(error, IMK_ERROR_EMPTY, "temperature", NULL, "at least one point");
    const double tau = profile->time_constant;
    if (!isfinite(tau))
        return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "time_constant", 0, tau, 0.0, "a time");
    if (!(tau == 0.0 || tau >= 1e-9)) /* below, s/tau could overflow */
        return imki_refuse_at(error, IMK_ERROR_RANGE, "time_constant", 0, tau, 1e-9,
                              "0, or a time from 1 ns up");
    for (size_t i = 0; i < profile->point_count; i++) {
        const double time = profile->time[i], temperature = profile->temperature[i];
        if (!isfinite(time))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "time", i, time, 0.0, "a time");
        if (!isfinite(temperature))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "temperature", i, temperature, 0.0,
                                  "a temperature");
        if (i > 0 && !(time >= profile->time[i - 1]))
            return imki_refuse_at(error, IMK_ERROR_TIME_ORDER, "time", i, time,
                                  profile->time[i - 1], "use times that do not decrease");
        if (!(temperature > 0.0))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "temperature", i, temperature, 0.0,
                                  "a temperature above absolute zero");
    }
    return IMK_OK;
}

/* ---- along the points ------------------------------------------------------------------------ */

/* Where a walk along the points has come to: the last point at or before the time, and the
 * temperature of the unit there. */
typedef struct progress {
    size_t point;
    double temperature;
} progress;

static progress walk_to(const imk_temperature_profile *profile, double time)
{
    size_t low = 0, high = profile->point_count - 1; /* low is at or before the time */
    while (low < high) {
        const size_t middle = high - (high - low) / 2;
        if (profile->time[middle] <= time)
            low = middle;
        else
            high = middle - 1;
    }
    progress walk = {low, profile->temperature[0]};
    if (profile->carried)
        walk.temperature = profile->carried[low];
    else if (profile->time_constant > 0.0)
        for (size_t i = 0; i < low; i++)
            walk.temperature = carry(profile, i, walk.temperature);
    return walk;
}

static void walk_on(const imk_temperature_profile *profile, double time, progress *walk)
{
    while (walk->point + 1 < profile->point_count && profile->time[walk->point + 1] <= time) {
        if (profile->carried)
            walk->temperature = profile->carried[walk->point + 1];
        else if (profile->time_constant > 0.0)
            walk->temperature = carry(profile, walk->point, walk->temperature);
        walk->point++;
    }
}

/* How many of the times are before `end`, at least one. */
static size_t run_length(size_t count, const double *time, double end)
{
    size_t run = 1;
    if (time[count - 1] < end)
        return count;
    while (run < count && time[run] < end)
        run++;
    return run;
}

/* The course at a time, and until when it holds. */
static double course_at(const imk_temperature_profile *profile, const progress *at, double time,
                        course *from)
{
    const straight line = line_after(profile, at->point);
    if (time < line.start) { /* before the first point: at rest */
        *from = (course){
            .start = line.start, .temperature = at->temperature, .settled = -(double)INFINITY};
        return line.start;
    }
    *from = course_from(&line, profile->time_constant, at->temperature);
    const double end =
        at->point + 1 < profile->point_count ? profile->time[at->point + 1] : (double)INFINITY;
    return time < from->settled && from->settled < end ? from->settled : end;
}

void imk_temperature_at(const imk_temperature_profile *profile, size_t count, const double *time,
                        double *temperature, double *rate)
{
    if (count == 0)
        return;
    progress at = walk_to(profile, time[0]);
    size_t run;
    for (size_t k = 0; k < count; k += run) {
        course from;
        walk_on(profile, time[k], &at);
        const double end = course_at(profile, &at, time[k], &from);
        run = run_length(count - k, time + k, end);
        take_course(&from, run, time + k, temperature + k, rate ? rate + k : NULL);
    }
}
