/* SPDX-License-Identifier: Apache-2.0 */
/* Mean of a stretch of samples and how well it is known. With autocorrelation rho_k of the samples
 *
 *     var(mean) = s^2/n (1 + 2 sum rho_k),
 *
 * the sum cut where pairs rho_2k + rho_2k+1 cease to be positive [GEYER1992]. A reading that is
 * coarser than its noise does not average out: with noise sigma before a quantizer of step q the
 * error of the mean that stays is about
 *
 *     q/sqrt(12) exp(-2 pi^2 sigma^2/q^2)                                       [WIDROW2008]
 *
 * (rms over where the value lies within a step, at sigma = 0 exactly), which is added. Of readings
 * that only take two neighbouring values the noise is not known: it is taken for 0. */
#include "imukit/elementary.h"
#include "static_internal.h"

#include <math.h>

enum {
    BATCHES = 1024, /* at most so many values are correlated: longer stretches are averaged first */
    LAGS = 256,
    NEIGHBOURHOOD = 1024 /* samples in which the step of a reading is looked for, and as many on
                            both sides of a stretch where it never changes */
};

double imki_lagged_product(const double *x, size_t n, size_t lag)
{
    double sum[4] = {0.0, 0.0, 0.0,
                     0.0}; /* side by side, so that they do not wait for each other */
    size_t k = lag;
    for (; k + 4 <= n; k += 4)
        for (size_t j = 0; j < 4; j++)
            sum[j] += x[k + j] * x[k + j - lag];
    for (; k < n; k++)
        sum[0] += x[k] * x[k - lag];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Sum of the autocorrelations, 1 + 2 sum rho_k, of values with mean zero. */
static double inefficiency(const double *x, size_t count)
{
    if (count < 8)
        return 1.0;
    const size_t lags = count / 2 < LAGS ? count / 2 : LAGS;
    const double square = imki_lagged_product(x, count, 0);
    double sum = 0.0, even = 1.0;
    for (size_t lag = 1; square > 0.0 && lag < lags; lag += 2) {
        const double odd = imki_lagged_product(x, count, lag) / square;
        if (even + odd <= 0.0)
            break;
        sum += even + odd;
        even = imki_lagged_product(x, count, lag + 1) / square;
    }
    /* White noise gives 1; noise that averages out faster, such as that of quantized increments,
     * less, but a short stretch cannot show how much. */
    return 2.0 * sum - 1.0 > 0.2 ? 2.0 * sum - 1.0 : 0.2;
}

/* Means of equal parts, their number at most BATCHES. */
typedef struct batches {
    size_t count, samples; /* samples that are numbers */
    double mean[BATCHES], weight[BATCHES];
    double square; /* about the means of the parts */
} batches;

/* The numbers among them. */
static size_t finite_moments(const double *x, size_t n, imki_moments *m)
{
    *m = imki_static_moments(x, n);
    if (isfinite(m->mean) && isfinite(m->square))
        return n;
    size_t count = 0;
    *m = (imki_moments){0.0, 0.0};
    for (size_t k = 0; k < n; k++)
        if (isfinite(x[k])) {
            const double d = x[k] - m->mean;
            m->mean += d / (double)++count;
            m->square += d * (x[k] - m->mean);
        }
    return count;
}

static void fill_batches(const double *x, size_t count, batches *b)
{
    const size_t part = (count + BATCHES - 1) / BATCHES;
    b->count = b->samples = 0;
    b->square = 0.0;
    for (size_t k = 0; part == 1 && k < count; k++)
        if (isfinite(x[k])) {
            b->mean[b->count] = x[k];
            b->weight[b->count++] = 1.0;
            b->samples++;
        }
    for (size_t k = 0; part > 1 && k < count; k += part) {
        imki_moments m;
        const size_t n = finite_moments(x + k, part < count - k ? part : count - k, &m);
        if (n == 0)
            continue;
        b->mean[b->count] = m.mean;
        b->weight[b->count++] = (double)n;
        b->square += m.square;
        b->samples += n;
    }
}

/* Step of the readings: within the stretch, else in its neighbourhood; counts have step 1. */
static double step_of(const imk_test_record *record, int sensor, int axis, size_t begin, size_t end)
{
    const double *x = record->reading[sensor][axis];
    double step =
        imki_static_step(x, begin, end - begin < NEIGHBOURHOOD ? end : begin + NEIGHBOURHOOD);
    if (step == 0.0) {
        const size_t from = begin > NEIGHBOURHOOD ? begin - NEIGHBOURHOOD : 0;
        const size_t to = record->count - end > NEIGHBOURHOOD ? end + NEIGHBOURHOOD : record->count;
        step = imki_static_step(x, from, to);
    }
    if (step == 0.0 && record->counts[sensor])
        step = 1.0;
    return step;
}

/* The step of a stretch of one value. Zeros that are further from all others than these are from
 * each other are in a dead band, which is twice as wide; but rates that begin all at once, as in
 * logs without noise, are no such band. */
static double step_of_one_value(const imk_test_record *record, int sensor, int axis, double step,
                                const imk_static_interval *interval)
{
    const double *x = record->reading[sensor][axis], value = x[interval->begin];
    const size_t from = interval->begin > NEIGHBOURHOOD ? interval->begin - NEIGHBOURHOOD : 0;
    const size_t to = record->count - interval->end > NEIGHBOURHOOD ? interval->end + NEIGHBOURHOOD
                                                                    : record->count;
    double nearest = (double)INFINITY, farthest = 0.0;
    for (size_t k = from; k < to; k++) {
        const double distance = fabs(x[k] - value);
        if (distance > 0.0 && distance < nearest)
            nearest = distance;
        if (distance > farthest)
            farthest = distance;
    }
    const bool dead_band = value == 0.0 && nearest > 2.0 * step && nearest < 0.5 * farthest;
    return dead_band ? 2.0 * nearest : step;
}

/* Two neighbouring values and no third one. */
static bool is_of_two_values(const double *x, size_t count, double step)
{
    double low = (double)INFINITY, high = -(double)INFINITY;
    for (size_t k = 0; k < count; k++)
        if (isfinite(x[k])) {
            low = x[k] < low ? x[k] : low;
            high = x[k] > high ? x[k] : high;
        }
    return high - low < 1.5 * step;
}

/* rms of the error that stays in a mean of rounded readings. */
static double rounding_of(double variance, double step, bool two_values)
{
    static const double two_pi_squared = 19.739208802178716;
    const double before = two_values ? 0.0 : variance - step * step / 12.0;
    const double smooth = before > 0.0 ? before / (step * step) : 0.0;
    return step / sqrt(12.0) * imk_exp(-two_pi_squared * smooth);
}

static void summarise_axis(const imk_test_record *record, int sensor, int axis, double step,
                           imk_static_interval *interval)
{
    const double *x = record->reading[sensor][axis];
    double rounding = 0.0;
    batches b;
    fill_batches(x + interval->begin, interval->end - interval->begin, &b);
    if (b.count == 0)
        return;
    const double n = (double)b.samples;
    double off = 0.0, between = 0.0;
    for (size_t k = 0; k < b.count; k++)
        off += b.weight[k] * (b.mean[k] - b.mean[0]);
    const double mean = b.mean[0] + off / n;
    for (size_t k = 0; k < b.count; k++) {
        b.mean[k] -= mean;
        b.square += b.weight[k] * b.mean[k] * b.mean[k];
        between += b.mean[k] * b.mean[k];
    }
    const double variance = b.samples > 1 ? b.square / (n - 1.0) : 0.0;
    double square = variance;
    if (b.count > 1)
        square = between / (double)b.count * inefficiency(b.mean, b.count) / (double)(b.count - 1);
    if (step > 0.0) {
        if (variance == 0.0)
            step = step_of_one_value(record, sensor, axis, step, interval);
        const double quantization = step * step / 12.0;
        rounding = rounding_of(
            variance, step,
            is_of_two_values(x + interval->begin, interval->end - interval->begin, step));
        square = square > quantization / n ? square : quantization / n;
        square += rounding * rounding;
    } else {
        /* One value throughout the log: known to the digits it is given with, say six. */
        square += 1e-12 * (mean * mean + 1e-12);
    }
    interval->mean[sensor][axis] = mean;
    interval->scatter[sensor][axis] = sqrt(variance);
    interval->sigma[sensor][axis] = sqrt(square);
    interval->rounding[sensor][axis] = rounding;
}

static double time_of(const imk_test_record *record, size_t k)
{
    return record->time ? record->time[k] : (double)k * record->dt;
}

/* Mean and least-squares slope. */
static void summarise_temperature(const imk_test_record *record, imk_static_interval *interval)
{
    const double *t = record->temperature;
    const double origin = time_of(record, interval->begin);
    double n = 0.0, sum_time = 0.0, sum = 0.0, first = (double)NAN;
    for (size_t k = interval->begin; k < interval->end; k++)
        if (isfinite(t[k])) {
            if (!isfinite(first))
                first = t[k];
            n += 1.0;
            sum_time += time_of(record, k) - origin;
            sum += t[k] - first;
        }
    if (n == 0.0)
        return;
    const double middle = sum_time / n, mean = sum / n;
    double product = 0.0, square = 0.0;
    for (size_t k = interval->begin; k < interval->end; k++)
        if (isfinite(t[k])) {
            const double d = time_of(record, k) - origin - middle;
            product += d * (t[k] - first - mean);
            square += d * d;
        }
    interval->temperature = first + mean;
    interval->temperature_rate = square > 0.0 ? product / square : 0.0;
}

imk_static_interval imki_static_summarise(const imk_test_record *record, size_t begin, size_t end,
                                          double step[2][IMK_AXES_MAX])
{
    if (record->means && begin < record->count)
        return imki_static_mean(record, begin);
    imk_static_interval interval = {
        .begin = begin, .end = end, .temperature = (double)NAN, .section = -1};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++)
            interval.mean[sensor][i] = interval.sigma[sensor][i] = interval.scatter[sensor][i] =
                (double)NAN;
    interval.temperature_rate = (double)NAN;
    if (end > record->count || begin >= end)
        return interval;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < record->axis_count[sensor]; i++)
            if (record->reading[sensor][i])
                summarise_axis(record, sensor, i,
                               step ? step[sensor][i] : step_of(record, sensor, i, begin, end),
                               &interval);
    if (record->temperature)
        summarise_temperature(record, &interval);
    if (record->section)
        interval.section = record->section[begin + (end - begin) / 2];
    return interval;
}

imk_static_interval imk_static_summary(const imk_test_record *record, size_t begin, size_t end)
{
    return imki_static_summarise(record, begin, end, NULL);
}
