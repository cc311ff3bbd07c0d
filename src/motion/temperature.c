/* SPDX-License-Identifier: Apache-2.0 */
/* Temperature of a unit that follows its surroundings, T' = (u - T)/tau. Between two points the
 * surroundings are u + m s; with x = s/tau and E = 1 - e^{-x}
 *
 *     T(s)  = T + (u - T) E + m tau (x - E)
 *     T'(s) = (u - T)/tau e^{-x} + m E
 *
 * exactly, so the temperature at each point follows from that at the one before. */
#include "imukit/motion.h"

#include "imukit/elementary.h"

#include <math.h>

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

/* s after a point at which the unit had temperature T. */
static double follow(const straight *line, double time_constant, double temperature, double s,
                     double *rate)
{
    if (time_constant == 0.0) {
        *rate = line->slope;
        return line->value + line->slope * s;
    }
    const double x = s / time_constant, gap = line->value - temperature;
    const double approach = -imk_expm1(-x);
    *rate = gap / time_constant * imk_exp(-x) + line->slope * approach;
    return temperature + (gap * approach + line->slope * time_constant * (x - approach));
}

/* From point i to point i + 1. */
static double carry(const imk_temperature_profile *profile, size_t i, double temperature)
{
    const straight line = line_after(profile, i);
    double rate;
    return follow(&line, profile->time_constant, temperature, profile->time[i + 1] - line.start,
                  &rate);
}

void imk_temperature_carry(const imk_temperature_profile *profile, double *carried)
{
    carried[0] = profile->temperature[0];
    for (size_t i = 0; i + 1 < profile->point_count; i++)
        carried[i + 1] = carry(profile, i, carried[i]);
}

static imk_status refuse(imk_error *error, imk_status status, const char *field, size_t index,
                         double value, double limit, const char *expected)
{
    imk_error_set(error, status, field, NULL, expected);
    if (error) {
        error->index = (int)index;
        error->value = value;
        error->limit = limit;
    }
    return status;
}

imk_status imk_temperature_validate(const imk_temperature_profile *profile, imk_error *error)
{
    if (profile->point_count == 0 || !profile->time || !profile->temperature)
        return imk_error_set(error, IMK_ERROR_EMPTY, "temperature", NULL, "at least one point");
    const double tau = profile->time_constant;
    if (!isfinite(tau))
        return refuse(error, IMK_ERROR_NOT_FINITE, "time_constant", 0, tau, 0.0, "a time");
    if (!(tau == 0.0 || tau >= 1e-9)) /* below, s/tau could overflow */
        return refuse(error, IMK_ERROR_RANGE, "time_constant", 0, tau, 1e-9,
                      "0, or a time from 1 ns up");
    for (size_t i = 0; i < profile->point_count; i++) {
        const double time = profile->time[i], temperature = profile->temperature[i];
        if (!isfinite(time))
            return refuse(error, IMK_ERROR_NOT_FINITE, "time", i, time, 0.0, "a time");
        if (!isfinite(temperature))
            return refuse(error, IMK_ERROR_NOT_FINITE, "temperature", i, temperature, 0.0,
                          "a temperature");
        if (i > 0 && !(time >= profile->time[i - 1]))
            return refuse(error, IMK_ERROR_TIME_ORDER, "time", i, time, profile->time[i - 1],
                          "times that do not decrease");
        if (!(temperature > 0.0))
            return refuse(error, IMK_ERROR_RANGE, "temperature", i, temperature, 0.0,
                          "a temperature above absolute zero");
    }
    return IMK_OK;
}

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

void imk_temperature_at(const imk_temperature_profile *profile, size_t count, const double *time,
                        double *temperature, double *rate)
{
    if (count == 0)
        return;
    progress at = walk_to(profile, time[0]);
    straight line = line_after(profile, at.point);
    for (size_t k = 0; k < count; k++) {
        const size_t point = at.point;
        walk_on(profile, time[k], &at);
        if (at.point != point)
            line = line_after(profile, at.point);
        double change = 0.0;
        if (time[k] < line.start) /* before the first point */
            temperature[k] = profile->temperature[0];
        else
            temperature[k] = follow(&line, profile->time_constant, at.temperature,
                                    time[k] - line.start, &change);
        if (rate)
            rate[k] = change;
    }
}
