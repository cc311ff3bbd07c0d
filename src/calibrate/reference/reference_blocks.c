/* SPDX-License-Identifier: Apache-2.0 */
/* Observations where the reference never holds still: short blocks of samples.
 *
 * A block's observation is the mean reading at the mean input. For the terms that are not linear
 * the mean of u^2 is what counts, not the square of the mean; they differ by the variance of u
 * within the block, (length x slope)^2/12. A block is as long as keeps that below 1e-4 of the
 * variance of u in the log, at least one sample. */
#include "reference_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/samples.h"

#include <math.h>

enum { BLOCKS_MAX = 20000, FIT_SAMPLES = 200000 };

typedef struct plan {
    const imk_test_record *record;
    int sensor, fixture;
    double lag;
    size_t length, stride; /* samples of a block, and from one used to the next */
    size_t skip_count;
    const imk_reference_stretch *skip;
    const double *const *turning; /* rates [rad/s]; NULL: not known */
    double still;                 /* what they differ by at most while a stretch lasts */
} plan;

/* Part of the record. */
typedef struct span {
    size_t at, begin, end; /* of which stretch */
} span;

/* Of the reference: the mean square of its steps over its variance. */
static double relative_steps(const imk_test_record *record, const double *const *channel)
{
    double steps = 0.0, sum[3] = {0.0}, squares[3] = {0.0};
    size_t n = 0;
    for (size_t k = 1; k < record->count; k++) {
        double step[3], value[3];
        for (int j = 0; j < 3; j++) {
            value[j] = channel[j][k] - channel[j][0];
            step[j] = channel[j][k] - channel[j][k - 1];
        }
        const double square = imki_dot3(step, step);
        if (!(square < HUGE_VAL))
            continue;
        steps += square;
        n++;
        for (int j = 0; j < 3; j++) {
            sum[j] += value[j];
            squares[j] += value[j] * value[j];
        }
    }
    double variance = 0.0;
    for (int j = 0; j < 3 && n > 0; j++)
        variance += squares[j] - sum[j] * sum[j] / (double)n;
    return variance > 0.0 ? steps / variance : 1.0;
}

static size_t block_length(const imki_procedure_call *call, const imk_test_record *record,
                           const double *const *channel)
{
    const size_t wanted = imk_samples_in(call->settings->sine_block, record->dt);
    if (call->settings->sine_block > 0.0)
        return wanted > 1 ? wanted : 1;
    const double length = sqrt(12.0 * 1e-4 / fmax(relative_steps(record, channel), 1e-12));
    return length > 1.0 ? (size_t)length : 1;
}

/* Has the record three axes of a sensor whose readings have a unit? */
static bool has_own(const imki_procedure_call *call, const plan *p, int sensor)
{
    return p->record->axis_count[sensor] >= 3 &&
           (!p->record->counts[sensor] || imki_reference_sensitivity(call, sensor, 0) != 0.0);
}

/* What the other sensor reads over a block. */
static void own_mean(const imki_procedure_call *call, const plan *p, int sensor, size_t begin,
                     size_t end, double vector[3])
{
    double mean[IMK_AXES_MAX];
    for (int axis = 0; axis < p->record->axis_count[sensor]; axis++) {
        mean[axis] = 0.0;
        for (size_t k = begin; k < end; k++)
            mean[axis] += p->record->reading[sensor][axis][k] / (double)(end - begin);
    }
    imki_reference_own(call, sensor, mean, vector);
}

/* Rate at one sample, by the reference or by the gyros. */
static void rate_at(const imki_procedure_call *call, const plan *p, size_t k, double rate[3])
{
    if (!p->record->reference_rate[0]) {
        own_mean(call, p, IMK_GYRO, k, k + 1, rate);
        return;
    }
    for (int j = 0; j < 3; j++)
        rate[j] = imki_reference_at(p->record->reference_rate[j], p->record->count, k, p->lag);
}

/* What lever arms need and the reference does not say: the rate by the gyros, and the angular
 * acceleration by the rates of four neighbours,
 *
 *     (8 (w[k+1] - w[k-1]) - (w[k+2] - w[k-2]))/(12 dt),
 *
 * short by (2 pi f dt)^4/30 at the frequency f; two neighbours would be by (2 pi f dt)^2/6. */
static void turning(const imki_procedure_call *call, const plan *p, size_t begin, size_t end,
                    imk_observation *o)
{
    const imk_test_record *record = p->record;
    if (!record->reference_rate[0] && has_own(call, p, IMK_GYRO))
        own_mean(call, p, IMK_GYRO, begin, end, o->rate);
    if (record->reference_acceleration[0])
        return;
    for (size_t k = begin; k < end; k++) {
        double far[2][3], near[2][3];
        if (k < 2 || k + 2 >= record->count) {
            o->angular_acceleration[0] = (double)NAN;
            return;
        }
        rate_at(call, p, k - 2, far[0]);
        rate_at(call, p, k + 2, far[1]);
        rate_at(call, p, k - 1, near[0]);
        rate_at(call, p, k + 1, near[1]);
        for (int j = 0; j < 3; j++)
            o->angular_acceleration[j] +=
                (8.0 * (near[1][j] - near[0][j]) - (far[1][j] - far[0][j])) /
                (12.0 * record->dt * (double)(end - begin));
    }
}

/* Means of the input over a block. @return false where it is not known */
static bool input_of(const imki_procedure_call *call, const plan *p, size_t begin, size_t end,
                     imk_observation *o)
{
    const imk_test_record *record = p->record;
    const double *const *const sources[3] = {record->reference_rate, record->reference_force,
                                             record->reference_acceleration};
    double *const target[3] = {o->rate, o->force, o->angular_acceleration};
    for (int s = 0; s < 3; s++)
        for (int j = 0; j < 3 && sources[s][j]; j++) {
            double sum = 0.0;
            for (size_t k = begin; k < end; k++)
                sum += imki_reference_at(sources[s][j], record->count, k, p->lag);
            target[s][j] = sum / (double)(end - begin);
            if (!(fabs(target[s][j]) < HUGE_VAL))
                return false;
        }
    if (p->sensor == IMK_GYRO && !record->reference_force[0] && has_own(call, p, IMK_ACCEL))
        own_mean(call, p, IMK_ACCEL, begin, end, o->force);
    if (p->sensor == IMK_ACCEL)
        turning(call, p, begin, end, o);
    double sum = 0.0;
    for (int j = 0; j < 3; j++)
        sum += fabs(o->rate[j]) + fabs(o->force[j]) + fabs(o->angular_acceleration[j]);
    return sum < HUGE_VAL;
}

static void readings_of(const plan *p, size_t begin, size_t end, const double *sigma,
                        imk_observation *o)
{
    const imk_test_record *record = p->record;
    const double n = (double)(end - begin);
    for (int axis = 0; axis < record->axis_count[p->sensor]; axis++) {
        const double *reading = record->reading[p->sensor][axis] + begin;
        double sum = 0.0;
        for (size_t k = 0; k < end - begin; k++)
            sum += reading[k] - reading[0];
        o->reading[p->sensor][axis] = reading[0] + sum / n;
        o->sigma[p->sensor][axis] = sigma[axis] / sqrt(n);
    }
    if (record->temperature)
        o->temperature = record->temperature[begin + (end - begin) / 2];
}

static bool gap_within(const imk_test_record *record, size_t begin, size_t end)
{
    return record->time && end - begin > 1 &&
           record->time[end - 1] - record->time[begin] > ((double)(end - begin) - 0.5) * record->dt;
}

/* Sample k turns as a stretch does. */
static bool is_still(const plan *p, const imk_reference_stretch *s, size_t k)
{
    bool still = true;
    for (int j = 0; j < 3; j++)
        still = still && fabs(p->turning[j][k] - s->rate[j]) < p->still;
    return still;
}

/* A stretch with what was trimmed off it: a block there would have the error of the stretch. */
static span whole_stretch(const plan *p, size_t at)
{
    const imk_reference_stretch *s = &p->skip[at];
    span whole = {at, s->begin, s->end};
    while (p->turning && whole.begin > 0 && is_still(p, s, whole.begin - 1))
        whole.begin--;
    while (p->turning && whole.end < p->record->count && is_still(p, s, whole.end))
        whole.end++;
    return whole;
}

/* Is any sample of the block in a stretch that is left out? `next` moves on with the blocks. */
static bool skipped(const plan *p, size_t block_begin, size_t block_end, span *next)
{
    const double begin = (double)block_begin - p->lag, end = (double)block_end - p->lag;
    while (next->at < p->skip_count && (double)next->end <= begin) {
        const size_t at = next->end > 0 ? next->at + 1 : 0;
        *next = at < p->skip_count ? whole_stretch(p, at) : (span){.at = at};
    }
    return next->at < p->skip_count && (double)next->begin < end;
}

/* What a stretch may differ by from its neighbours: a hundredth of the fastest. */
static void find_turning(const imki_procedure_call *call, plan *p)
{
    double fastest = 0.0;
    const bool own = has_own(call, p, IMK_GYRO) && !p->record->counts[IMK_GYRO];
    p->turning = p->record->reference_rate[0] ? p->record->reference_rate
                 : own                        ? p->record->reading[IMK_GYRO]
                                              : NULL;
    for (size_t i = 0; i < p->skip_count; i++)
        for (int j = 0; j < 3; j++)
            fastest = fmax(fastest, fabs(p->skip[i].rate[j]));
    for (size_t k = 0; p->turning && k < p->record->count; k++)
        for (int j = 0; j < 3; j++)
            fastest = fmax(fastest, fabs(p->turning[j][k]));
    p->still = 0.01 * fastest;
}

/* Go through the blocks, adding observations, or only counting them where sigma is NULL. */
static size_t go_through(const imki_procedure_call *call, const plan *p, const double *sigma)
{
    const imk_test_record *record = p->record;
    size_t count = 0;
    span next = {0};
    for (size_t begin = 0; begin + p->length <= record->count; begin += p->stride) {
        const size_t end = begin + p->length;
        imk_observation o = imki_reference_blank(call, begin, end, p->fixture);
        o.moving = true;
        if (skipped(p, begin, end, &next) || gap_within(record, begin, end) ||
            !imki_reference_usable(call, p->sensor, begin, end) ||
            !input_of(call, p, begin, end, &o))
            continue;
        count++;
        if (!sigma)
            continue;
        readings_of(p, begin, end, sigma, &o);
        o.offset_sigma = imki_reference_offset_sigma(call, &o);
        imk_calibration_observe(call->calibration, &o);
    }
    return count;
}

imk_status imki_reference_blocks(const imki_procedure_call *call, int sensor, double lag,
                                 int fixture, size_t skip_count, const imk_reference_stretch *skip,
                                 const double *sigma)
{
    const imk_test_record *record = call->calibration->record[call->record];
    plan p = {.record = record,
              .sensor = sensor,
              .fixture = fixture,
              .lag = lag,
              .skip_count = skip_count,
              .skip = skip};
    const double *const *channel = imki_reference_channels(record, IMK_GYRO);
    if (!channel)
        channel = imki_reference_channels(record, IMK_ACCEL);
    /* The force at an accelerometer goes with the square of rates that change fast. */
    p.length = channel && sensor == IMK_GYRO ? block_length(call, record, channel) : 1;
    p.stride = p.length;
    find_turning(call, &p);
    const size_t count = go_through(call, &p, NULL);
    if (count > BLOCKS_MAX)
        p.stride *= (count + BLOCKS_MAX - 1) / BLOCKS_MAX;
    const imk_status status = imki_reference_room(call, count > BLOCKS_MAX ? BLOCKS_MAX : count);
    if (status != IMK_OK)
        return status;
    double fitted[IMK_AXES_MAX];
    for (int axis = 0; !sigma && axis < record->axis_count[sensor]; axis++) {
        const imki_linear_fit fit = imki_reference_fit(record, sensor, axis, lag, 0, record->count,
                                                       record->count / FIT_SAMPLES + 1);
        fitted[axis] = fmax(fit.residual, imki_reference_floor(call, sensor, axis));
    }
    go_through(call, &p, sigma ? sigma : fitted);
    return IMK_OK;
}
