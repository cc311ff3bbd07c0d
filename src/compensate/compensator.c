/* SPDX-License-Identifier: Apache-2.0 */
/* Samples through the correction, in blocks. Place 2 of the lanes is the first new sample; places 1
 * and 0 are those before it, which wait for its rates when the model has lever arms:
 *
 *     alpha[i] = (w[i+1] - w[i-1])/(2 dt)
 *
 * w comes from a first pass without alpha, the output from a second one with it. A reading that is
 * not finite is replaced by zero rate or force on the way in, and what depends on it by NaN on the
 * way out, so that it does no harm to the rest of its sample and to its neighbours.
 *
 * Every step works on each sample alone or on its neighbours in time, so that blocks of any length
 * give the same bits. */
#include "imukit/compensate.h"

#include "base/workspace_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 256, BEFORE = 2, ROWS = 4 * IMK_AXES_MAX + 10 };

/* Marks of a sample: the public flags, and what decides about its neighbours and outputs. */
enum { PUBLIC_MARKS = 0xFF, GYRO_SATURATED = 0x100, FIRST_BAD_AXIS = 16 };

typedef struct lanes {
    double *reading[2][IMK_AXES_MAX], *out[2][IMK_AXES_MAX];
    double *temperature, *temperature_rate, *warm_up[2], *rate[3], *acceleration[3];
    uint32_t *mark;
} lanes;

static lanes lay_out(double *workspace, size_t capacity, uint32_t *mark)
{
    lanes l = {.mark = mark};
    double *next = workspace;
    const size_t stride = capacity + BEFORE;
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < IMK_AXES_MAX; i++, next += 2 * stride) {
            l.reading[sensor][i] = next;
            l.out[sensor][i] = next + stride;
        }
        l.warm_up[sensor] = next;
        next += stride;
    }
    l.temperature = next;
    l.temperature_rate = next + stride;
    for (int k = 0; k < 3; k++) {
        l.rate[k] = next + (size_t)(2 + k) * stride;
        l.acceleration[k] = next + (size_t)(5 + k) * stride;
    }
    return l;
}

/* Marks of one axis. */
static uint32_t bad_axis(int sensor, int axis)
{
    return (uint32_t)1 << (FIRST_BAD_AXIS + sensor * IMK_AXES_MAX + axis);
}

static uint32_t bad_sensor(int sensor)
{
    return (uint32_t)0xFF << (FIRST_BAD_AXIS + sensor * IMK_AXES_MAX);
}

/* The readings that make the outputs of a sensor NaN. */
static uint32_t spoils(const imk_compensator *c, int sensor)
{
    return bad_sensor(sensor) | (c->depends_on_other[sensor] ? bad_sensor(1 - sensor) : 0);
}

static void take_readings(const imk_compensator *c, const imk_readings *readings, size_t first,
                          size_t count, lanes *l)
{
    const imk_correction *correction = &c->correction;
    uint32_t *mark = l->mark + BEFORE;
    memset(mark, 0, count * sizeof *mark);
    for (int sensor = 0; sensor < 2; sensor++) {
        const uint32_t saturated = IMK_FLAG_SATURATED | (sensor == IMK_GYRO ? GYRO_SATURATED : 0);
        for (int i = 0; i < correction->distortion.axis_count[sensor]; i++) {
            const double *in = readings->channel[sensor][i] + first;
            double *lane = l->reading[sensor][i] + BEFORE;
            const double zero = correction->zero_offset[sensor][i];
            const double per_unit = correction->per_unit[sensor][i], range = c->range[sensor][i];
            const uint32_t bad = IMK_FLAG_NOT_FINITE | bad_axis(sensor, i);
            for (size_t j = 0; j < count; j++) {
                const double x = in[j];
                const bool finite = fabs(x) < (double)INFINITY;
                const bool beyond = fabs((x - zero) * per_unit) >= range;
                lane[j] = finite ? x : zero;
                mark[j] |= finite ? (beyond ? saturated : 0) : bad;
            }
        }
    }
}

/* One temperature: the last known one, the smoothed slope, the marks. */
static void take_temperature(imk_compensator *c, double temperature, double rate_given,
                             size_t place, lanes *l)
{
    const double interval = c->temperature_interval;
    c->temperature_interval = c->dt;
    if (!(fabs(temperature) < (double)INFINITY))
        temperature = c->temperature;
    if (!isnan(c->temperature)) {
        const double slope = (temperature - c->temperature) / interval;
        c->temperature_rate -=
            imk_expm1(-interval / c->temperature_time) * (slope - c->temperature_rate);
    }
    c->temperature = temperature;
    const bool known = !isnan(temperature);
    const bool matters = c->temperature_maximum < (double)INFINITY || isnan(rate_given);
    l->temperature[place] = known ? temperature : 0.0;
    l->temperature_rate[place] = isnan(rate_given) ? c->temperature_rate : rate_given;
    if (known && (temperature < c->temperature_minimum || temperature > c->temperature_maximum))
        l->mark[place] |= IMK_FLAG_TEMPERATURE;
    for (int sensor = 0; sensor < 2; sensor++)
        if (!known && matters && c->uses_temperature[sensor])
            l->mark[place] |= IMK_FLAG_NOT_FINITE | bad_sensor(sensor);
}

static void take_in(imk_compensator *c, const imk_readings *readings, size_t first, size_t count,
                    lanes *l)
{
    take_readings(c, readings, first, count, l);
    for (size_t j = 0; c->needs_temperature && j < count; j++)
        take_temperature(c, readings->temperature ? readings->temperature[first + j] : (double)NAN,
                         readings->temperature_rate ? readings->temperature_rate[first + j]
                                                    : (double)NAN,
                         BEFORE + j, l);
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t j = 0; c->warm_up_time[sensor] > 0.0 && j < count; j++) {
            /* A sample is the mean over the interval that ends at its time. */
            const double time = c->start_time + ((double)(c->count + j) - 0.5) * c->dt;
            l->warm_up[sensor][BEFORE + j] = imk_exp(-time / c->warm_up_time[sensor]);
        }
    c->count += count;
}

/* From the lanes of readings to those of outputs. */
static void correct(const imk_compensator *c, size_t place, size_t count,
                    const double *const acceleration[3], lanes *l)
{
    imk_readings readings = {0};
    double *out[2][IMK_AXES_MAX];
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            readings.channel[sensor][i] = l->reading[sensor][i] + place;
            out[sensor][i] = l->out[sensor][i] + place;
        }
        if (c->warm_up_time[sensor] > 0.0)
            readings.warm_up[sensor] = l->warm_up[sensor] + place;
    }
    if (c->needs_temperature)
        readings.temperature = l->temperature + place;
    if (c->needs_temperature_rate)
        readings.temperature_rate = l->temperature_rate + place;
    for (int k = 0; k < 3; k++)
        readings.angular_acceleration[k] = acceleration[k];
    /* The cast only adds const, which C17 does not do by itself for arrays of pointers. */
    imk_correct(&c->correction, &readings, count, (double *const(*)[IMK_AXES_MAX])out);
}

/* Rates of the first pass, for the differences. */
static void find_rates(const imk_compensator *c, size_t count, lanes *l)
{
    static const double *const none[3] = {NULL};
    const uint32_t spoiled = spoils(c, IMK_GYRO);
    correct(c, BEFORE, count, none, l);
    for (int k = 0; k < 3; k++)
        for (size_t j = BEFORE; j < BEFORE + count; j++)
            l->rate[k][j] = l->mark[j] & spoiled ? (double)NAN : l->out[IMK_GYRO][k][j];
}

/* Angular acceleration at the places from `place` on, each of which has one more beside it. A rate
 * that is not known is NaN. */
static void differentiate(const imk_compensator *c, size_t place, size_t count, lanes *l)
{
    const double whole = 1.0 / c->dt, half = 0.5 / c->dt;
    for (size_t j = place; j < place + count; j++) {
        const bool before = !isnan(l->rate[0][j - 1]), here = !isnan(l->rate[0][j]);
        const bool after = !isnan(l->rate[0][j + 1]);
        const size_t from = before ? j - 1 : j, to = after ? j + 1 : j;
        const bool known = (before && after) || (here && (before || after));
        const double factor = before && after ? half : whole;
        for (int k = 0; k < 3; k++)
            l->acceleration[k][j] = known ? (l->rate[k][to] - l->rate[k][from]) * factor : 0.0;
        if (!known || ((l->mark[from] | l->mark[to]) & GYRO_SATURATED))
            l->mark[j] |= IMK_FLAG_ACCELERATION;
    }
}

/* Outputs of the places from `place` on: NaN where a reading is missing, flags. */
static void give_out(const imk_compensator *c, size_t place, size_t count, lanes *l,
                     double *out[2][IMK_AXES_MAX], unsigned char *flags, size_t first)
{
    const uint32_t *mark = l->mark + place;
    uint32_t *limits = l->mark + place;
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < imk_compensator_components(c, sensor); i++) {
            const double limit =
                c->limited[sensor] ? c->correction.limit[sensor][i] : (double)INFINITY;
            const uint32_t spoiled =
                c->correction.solves[sensor]
                    ? spoils(c, sensor)
                    : (spoils(c, sensor) & ~bad_sensor(sensor)) | bad_axis(sensor, i);
            double *lane = l->out[sensor][i] + place;
            for (size_t j = 0; j < count; j++) {
                lane[j] = mark[j] & spoiled ? (double)NAN : lane[j];
                limits[j] |= fabs(lane[j]) > limit ? IMK_FLAG_LIMIT : 0;
            }
            if (out[sensor][i])
                memcpy(out[sensor][i] + first, lane, count * sizeof *lane);
        }
    }
    for (size_t j = 0; flags && j < count; j++)
        flags[first + j] = (unsigned char)(mark[j] & PUBLIC_MARKS);
}

/* The sample that waits, and the rates before it, between the lanes and the compensator. */
static void put_held(const imk_compensator *c, lanes *l)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < IMK_AXES_MAX; i++)
            l->reading[sensor][i][1] = c->held[0].reading[sensor][i];
        l->warm_up[sensor][1] = c->held_warm_up[sensor];
    }
    l->temperature[1] = c->held[0].temperature;
    l->temperature_rate[1] = c->held_temperature_rate;
    for (int k = 0; k < 3; k++) {
        l->rate[k][1] = c->holds ? c->held[0].rate[k] : (double)NAN;
        l->rate[k][0] = c->holds ? c->held[1].rate[k] : (double)NAN;
    }
    l->mark[1] = c->holds ? c->held_marks[0] : 0;
    l->mark[0] = c->holds ? c->held_marks[1] : 0;
}

static void hold(imk_compensator *c, const lanes *l, size_t place)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        for (int i = 0; i < c->correction.distortion.axis_count[sensor]; i++)
            c->held[0].reading[sensor][i] = l->reading[sensor][i][place];
        if (c->warm_up_time[sensor] > 0.0)
            c->held_warm_up[sensor] = l->warm_up[sensor][place];
    }
    if (c->needs_temperature) {
        c->held[0].temperature = l->temperature[place];
        c->held_temperature_rate = l->temperature_rate[place];
    }
    for (int k = 0; k < 3; k++) {
        c->held[0].rate[k] = l->rate[k][place];
        c->held[1].rate[k] = l->rate[k][place - 1];
    }
    c->held_marks[0] = l->mark[place];
    c->held_marks[1] = l->mark[place - 1];
    c->holds = true;
}

/* Up to as many samples as the lanes hold. @return outputs, which stand in `out` from `written` */
static size_t run(imk_compensator *c, const imk_readings *readings, size_t first, size_t count,
                  lanes *l, double *out[2][IMK_AXES_MAX], unsigned char *flags, size_t written)
{
    const double *const *given = readings->angular_acceleration;
    const double *acceleration[3] = {NULL};
    take_in(c, readings, first, count, l);
    if (!c->needs_acceleration || given[0]) {
        for (int k = 0; k < 3 && c->needs_acceleration; k++)
            acceleration[k] = given[k] + first;
        correct(c, BEFORE, count, acceleration, l);
        give_out(c, BEFORE, count, l, out, flags, written);
        return count;
    }
    const size_t place = c->holds ? 1 : BEFORE;
    const size_t outputs = count + BEFORE - 1 - place;
    put_held(c, l);
    find_rates(c, count, l);
    differentiate(c, place, outputs, l);
    for (int k = 0; k < 3; k++)
        acceleration[k] = l->acceleration[k] + place;
    correct(c, place, outputs, acceleration, l);
    give_out(c, place, outputs, l, out, flags, written);
    hold(c, l, count + BEFORE - 1);
    return outputs;
}

size_t imk_compensator_block(imk_compensator *compensator, const imk_readings *readings,
                             size_t count, double *out[2][IMK_AXES_MAX], unsigned char *flags,
                             void *workspace, size_t workspace_size)
{
    uint32_t mark[BLOCK + BEFORE];
    if (!workspace || workspace_size < imk_compensate_workspace_size(count))
        return 0;
    lanes l = lay_out(imki_align(workspace), count < BLOCK ? count : BLOCK, mark);
    size_t written = 0;
    for (size_t first = 0; first < count; first += BLOCK) {
        const size_t left = count - first;
        written +=
            run(compensator, readings, first, left < BLOCK ? left : BLOCK, &l, out, flags, written);
    }
    return written;
}

/* Pointers to the outputs of one sample. */
static void point_at(imk_compensator_sample *sample, double *out[2][IMK_AXES_MAX])
{
    for (int i = 0; i < IMK_AXES_MAX; i++) {
        out[IMK_GYRO][i] = &sample->rate[i];
        out[IMK_ACCEL][i] = &sample->force[i];
    }
}

bool imk_compensator_next(imk_compensator *compensator, imk_compensator_sample *sample)
{
    double workspace[ROWS * (1 + BEFORE)], *out[2][IMK_AXES_MAX];
    uint32_t mark[1 + BEFORE];
    unsigned char flags = 0;
    lanes l = lay_out(workspace, 1, mark);
    imk_readings readings = {.temperature = &sample->temperature};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            readings.channel[sensor][i] = &sample->reading[sensor][i];
    point_at(sample, out);
    const bool any = run(compensator, &readings, 0, 1, &l, out, &flags, 0) == 1;
    if (any)
        sample->flags = flags;
    return any;
}

/* The held sample, with no rate behind it. */
static bool finish(imk_compensator *c, double *out[2][IMK_AXES_MAX], unsigned char *flags,
                   size_t written)
{
    double workspace[ROWS * (1 + BEFORE)];
    uint32_t mark[1 + BEFORE];
    const double *acceleration[3];
    lanes l = lay_out(workspace, 1, mark);
    if (!c->holds)
        return false;
    put_held(c, &l);
    mark[BEFORE] = 0;
    for (int k = 0; k < 3; k++) {
        l.rate[k][BEFORE] = (double)NAN;
        acceleration[k] = l.acceleration[k] + 1;
    }
    differentiate(c, 1, 1, &l);
    correct(c, 1, 1, acceleration, &l);
    give_out(c, 1, 1, &l, out, flags, written);
    c->holds = false;
    return true;
}

bool imk_compensator_finish(imk_compensator *compensator, imk_compensator_sample *sample)
{
    double *out[2][IMK_AXES_MAX];
    unsigned char flags = 0;
    point_at(sample, out);
    const bool any = finish(compensator, out, &flags, 0);
    if (any)
        sample->flags = flags;
    return any;
}

imk_status imk_compensate_record(imk_compensator *compensator, const imk_readings *readings,
                                 size_t count, double *out[2][IMK_AXES_MAX], unsigned char *flags,
                                 void *workspace, size_t workspace_size)
{
    if (!workspace || workspace_size < imk_compensate_workspace_size(count))
        return IMK_ERROR_WORKSPACE;
    const size_t written =
        imk_compensator_block(compensator, readings, count, out, flags, workspace, workspace_size);
    finish(compensator, out, flags, written);
    return IMK_OK;
}

size_t imk_compensate_workspace_size(size_t count)
{
    return ROWS * ((count < BLOCK ? count : BLOCK) + BEFORE) * sizeof(double) +
           IMKI_ALIGNMENT_SLACK;
}
