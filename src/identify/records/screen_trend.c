/* SPDX-License-Identifier: Apache-2.0 */
/* Is there a warm-up in the mean of a record, and does it follow the temperature, or is it slow
 * noise?
 *
 * The record as means of up to 256 parts, cosine-transformed: c_k. Noise makes them independent,
 * with variance
 *
 *     S_k = a + b/(2 s) + d (1/(4 s^2) - 1/6),   s = sin(pi k/2M)
 *
 * for white noise, flicker and random walk (exact for the first and the last), and a trend adds its
 * own transform. The amounts a, b, d >= 0 and the factors of the trends are fitted together by
 * maximum likelihood, so that a record which slow noise can explain needs no trend: twice the gain
 * in log-likelihood tells [BROCKWELL1991, 10.8]. For the warm-up, whose time is searched, the gain
 * is over the better of slow noise alone and slow noise with a ramp. */
#include "identify/likelihood/identify_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "screen_internal.h"

#include <math.h>

enum { PARTS = 256, NOISES = 3, TRENDS = 3, ROUNDS = 40, FIRST_ROUNDS = 400, TIMES = 14 };

typedef struct trend_work {
    size_t parts, n;
    double dt;
    double cosine[4 * PARTS];     /* cos(pi i/2M) */
    double power[NOISES][PARTS];  /* spectra of the noises for amount 1 */
    double coefficient[PARTS];    /* of the record */
    double temperature[2][PARTS]; /* of the temperature and its square */
    double trend[TRENDS][PARTS];  /* of the trends fitted */
    double spectrum[PARTS];       /* fitted; before a fit, values to be transformed */
    double amount[NOISES];
    double factor[TRENDS], covariance[TRENDS * TRENDS];
    size_t trends;
} trend_work;

static size_t part_begin(const trend_work *w, size_t part)
{
    return part * w->n / w->parts;
}

/* Means over what is there; parts without anything lie on a line between their neighbours. */
static bool part_means(const trend_work *w, const double *values, double *mean)
{
    size_t last = PARTS;
    for (size_t p = 0; p < w->parts; p++) {
        double sum = 0, shift = 0;
        size_t count = 0;
        for (size_t i = part_begin(w, p); i < part_begin(w, p + 1); i++) {
            if (!imki_is_there(values[i]))
                continue;
            shift = count++ == 0 ? values[i] : shift;
            sum += values[i] - shift;
        }
        if (count == 0)
            continue;
        mean[p] = shift + sum / (double)count;
        for (size_t k = last == PARTS ? 0 : last + 1; k < p; k++)
            mean[k] = last == PARTS ? mean[p]
                                    : mean[last] + (mean[p] - mean[last]) * (double)(k - last) /
                                                       (double)(p - last);
        last = p;
    }
    for (size_t k = last + 1; last < PARTS && k < w->parts; k++)
        mean[k] = mean[last];
    return last < PARTS;
}

/* Orthonormal cosine transform (II) by its definition; coefficient 0 is left 0. */
static void transform(const trend_work *w, const double *values, double *coefficient)
{
    const double scale = sqrt(2 / (double)w->parts);
    coefficient[0] = 0;
    for (size_t k = 1; k < w->parts; k++) {
        double sum = 0;
        for (size_t j = 0, turn = k; j < w->parts; j++) { /* turn = k (2j + 1) mod 4M */
            sum += (values[j] - values[0]) * w->cosine[turn];
            turn += 2 * k;
            turn -= turn >= 4 * w->parts ? 4 * w->parts : 0;
        }
        coefficient[k] = scale * sum;
    }
}

static void set_spectra(trend_work *w)
{
    const double angle = 3.14159265358979324 / (2 * (double)w->parts);
    for (size_t i = 0; i < 4 * w->parts; i++)
        w->cosine[i] = imk_cos(angle * (double)i);
    for (size_t k = 1; k < w->parts; k++) {
        const double s = imk_sin(angle * (double)k);
        w->power[0][k] = 1;
        w->power[1][k] = 1 / (2 * s);
        w->power[2][k] = 1 / (4 * s * s) - 1.0 / 6;
    }
}

/* Factors of the trends at the present spectrum by weighted least squares. */
static void fit_factors(trend_work *w)
{
    double normal[TRENDS * TRENDS] = {0}, right[TRENDS] = {0};
    const size_t t = w->trends;
    for (size_t k = 1; k < w->parts; k++)
        for (size_t i = 0; i < t; i++) {
            const double x = w->trend[i][k] / w->spectrum[k];
            right[i] += x * w->coefficient[k];
            for (size_t j = 0; j < t; j++)
                normal[i * t + j] += x * w->trend[j][k];
        }
    if (t == 0 || imk_cholesky_factor(t, normal) != IMK_OK) {
        for (size_t i = 0; i < t; i++)
            w->factor[i] = 0;
        return;
    }
    imk_cholesky_inverse(t, normal, w->covariance);
    imk_cholesky_solve(t, normal, right);
    for (size_t i = 0; i < t; i++)
        w->factor[i] = right[i];
}

static void set_spectrum(trend_work *w)
{
    for (size_t k = 1; k < w->parts; k++)
        w->spectrum[k] =
            w->amount[0] + w->amount[1] * w->power[1][k] + w->amount[2] * w->power[2][k];
}

/* Amounts and factors in turns, from the amounts at hand. A step of the amounts multiplies each by
 * the ratio of what the likelihood's derivative wants more to what it wants less, and keeps them
 * positive [FEVOTTE2009]. @return the log-likelihood */
static double fit(trend_work *w, int rounds)
{
    double likelihood = 0;
    for (int round = 0; round <= rounds; round++) {
        set_spectrum(w);
        fit_factors(w);
        double more[NOISES] = {0}, less[NOISES] = {0};
        likelihood = 0;
        for (size_t k = 1; k < w->parts; k++) {
            double rest = w->coefficient[k];
            for (size_t i = 0; i < w->trends; i++)
                rest -= w->factor[i] * w->trend[i][k];
            const double inverse = 1 / w->spectrum[k], ratio = rest * rest * inverse;
            for (size_t i = 0; i < NOISES; i++) {
                more[i] += w->power[i][k] * ratio * inverse;
                less[i] += w->power[i][k] * inverse;
            }
            if (round == rounds)
                likelihood -= 0.5 * (imk_ln(w->spectrum[k]) + ratio);
        }
        for (size_t i = 0; round < rounds && i < NOISES; i++)
            w->amount[i] *= more[i] / less[i];
    }
    return likelihood;
}

/* Amounts to begin with: a third of the power each, of what the trends leave. */
static void start(trend_work *w)
{
    double have[NOISES] = {0};
    for (size_t k = 1; k < w->parts; k++) {
        double rest = w->coefficient[k];
        for (size_t i = 0; i < w->trends; i++)
            rest -= w->factor[i] * w->trend[i][k];
        for (size_t i = 0; i < NOISES; i++)
            have[i] += rest * rest / w->power[i][k];
    }
    for (size_t i = 0; i < NOISES; i++)
        w->amount[i] = have[i] / (double)(w->parts - 1) / NOISES;
}

/* Fit once more from what the trends leave: where they explain much, the amounts of the fit without
 * them are far off, and some have vanished that come back slowly. */
static void fit_anew(trend_work *w)
{
    double amount[NOISES];
    const double before = fit(w, ROUNDS);
    for (size_t i = 0; i < NOISES; i++)
        amount[i] = w->amount[i];
    start(w);
    if (fit(w, FIRST_ROUNDS) >= before)
        return;
    for (size_t i = 0; i < NOISES; i++)
        w->amount[i] = amount[i];
    fit(w, ROUNDS);
}

/* Transform of exp(-t/T), each part's mean: a geometric sum over its samples. */
static void set_exponential(trend_work *w, double *coefficient, double time)
{
    double *mean = w->spectrum;
    const double step = w->dt / time;
    for (size_t p = 0; p < w->parts; p++) {
        const double from = (double)part_begin(w, p);
        const double count = (double)(part_begin(w, p + 1)) - from;
        mean[p] = imk_exp(-from * step) * imk_expm1(-count * step) / (count * imk_expm1(-step));
    }
    transform(w, mean, coefficient);
}

typedef struct time_search {
    trend_work *w;
    double start[NOISES];
} time_search;

/* Log-likelihood with the last trend an exponential of this logarithm of time. */
static double at_time(void *context, double log_time)
{
    const time_search *s = context;
    trend_work *w = s->w;
    for (size_t i = 0; i < NOISES; i++)
        w->amount[i] = s->start[i];
    set_exponential(w, w->trend[w->trends - 1], imk_exp(log_time));
    return fit(w, ROUNDS);
}

/* Standard deviation of the time, amplitude and other trends free: the curvature of the likelihood
 * along it. */
static double time_sigma(time_search *s, double log_time)
{
    const double h = 0.05, centre = at_time(s, log_time);
    const double curvature =
        (2 * centre - at_time(s, log_time - h) - at_time(s, log_time + h)) / (h * h);
    at_time(s, log_time);
    return curvature > 0 ? imk_exp(log_time) / sqrt(curvature) : HUGE_VAL;
}

/* Chance of such a gain by slow noise alone: chi-square with one degree of freedom, times how many
 * times the search over the time looks anew. */
static double gain_probability(double gain, double searches)
{
    if (!(gain > 0))
        return 1;
    const double p = 1 - imk_chi_square_probability(gain, 1);
    const double all = p + searches * imk_exp(-gain / 2);
    return all < 1 ? all : 1;
}

static void find_warm_up(trend_work *w, double significance, imk_screen *found)
{
    /* Slow noise alone, and with a ramp. */
    time_search search = {w, {0}};
    double without = fit(w, FIRST_ROUNDS);
    for (size_t i = 0; i < NOISES; i++)
        search.start[i] = w->amount[i];
    double *ramp = w->spectrum;
    for (size_t p = 0; p < w->parts; p++)
        ramp[p] = (double)p / (double)w->parts;
    transform(w, ramp, w->trend[w->trends++]);
    without = fmax(without, fit(w, ROUNDS));
    /* Times from one part to a third of the record, on a grid and then between. */
    const double low = imk_ln((double)w->n * w->dt / (double)w->parts);
    const double high = imk_ln((double)w->n * w->dt / 3);
    double best = -HUGE_VAL, place = low;
    for (int i = 0; i < TIMES; i++) {
        const double log_time = low + (high - low) * i / (TIMES - 1);
        const double height = at_time(&search, log_time);
        if (height > best) {
            best = height;
            place = log_time;
        }
    }
    found->warm_up_probability = gain_probability(2 * (best - without), 2);
    found->warm_up = found->warm_up_probability < significance;
    if (found->warm_up) {
        const double grid = (high - low) / (TIMES - 1);
        place = imki_peak(at_time, &search, fmax(place - grid, low), fmin(place + grid, high), 16);
        at_time(&search, place);
        fit_anew(w);
        for (size_t i = 0; i < NOISES; i++)
            search.start[i] = w->amount[i];
        place = imki_peak(at_time, &search, fmax(place - grid, low), fmin(place + grid, high), 16);
        found->warm_up_time = imk_exp(place);
        found->warm_up_time_sigma = time_sigma(&search, place);
        const size_t last = w->trends - 1;
        found->warm_up_amplitude = w->factor[last];
        found->warm_up_amplitude_sigma = sqrt(w->covariance[last * w->trends + last]);
        found->degrees_taken += 2;
    } else {
        w->trends--;
    }
}

/* Put the first `degree` powers of the temperature in front of the trends; amounts to begin with.
 */
static double fit_temperature(trend_work *w, size_t degree, const double *amount)
{
    w->trends = degree;
    for (size_t i = 0; i < NOISES; i++)
        w->amount[i] = amount[i];
    for (size_t i = 0; i < degree; i++)
        for (size_t k = 0; k < w->parts; k++)
            w->trend[i][k] = w->temperature[i][k];
    return fit(w, ROUNDS);
}

static void find_temperature(trend_work *w, double significance, const double *temperature,
                             imk_screen *found)
{
    double *mean = w->spectrum, *square = w->trend[0]; /* no trend is there yet */
    double low = HUGE_VAL, high = -HUGE_VAL, centre = 0;
    for (size_t p = 0; p < w->parts; p++)
        mean[p] = temperature[p];
    for (size_t p = 0; p < w->parts; p++) {
        low = fmin(low, mean[p]);
        high = fmax(high, mean[p]);
        centre += mean[p] / (double)w->parts;
    }
    if (!(high > low))
        return;
    for (size_t p = 0; p < w->parts; p++) {
        mean[p] -= centre;
        square[p] = mean[p] * mean[p];
    }
    transform(w, mean, w->temperature[0]);
    transform(w, square, w->temperature[1]);
    fit(w, FIRST_ROUNDS);
    const double amount[NOISES] = {w->amount[0], w->amount[1], w->amount[2]};
    const double none = fit_temperature(w, 0, amount), one = fit_temperature(w, 1, amount);
    const double two = fit_temperature(w, 2, amount);
    const double first = gain_probability(2 * (one - none), 0);
    const double second = gain_probability(2 * (two - one), 0);
    found->temperature_reference = centre;
    found->temperature_probability = fmin(first, 2 * second);
    size_t degree = second < significance ? 2 : first < significance ? 1 : 0;
    fit_temperature(w, degree, amount);
    if (degree > 0)
        fit_anew(w);
    found->temperature_degree = (int)degree;
    found->degrees_taken += (int)degree;
}

static void take_temperature(const trend_work *w, imk_screen *found)
{
    if (found->temperature_degree < 1)
        return;
    found->temperature_slope = w->factor[0];
    found->temperature_slope_sigma = sqrt(w->covariance[0]);
    if (found->temperature_degree < 2)
        return;
    found->temperature_curvature = w->factor[1];
    found->temperature_curvature_sigma = sqrt(w->covariance[w->trends + 1]);
}

static void find_trends(trend_work *w, double significance, const double *mean,
                        const double *temperature, imk_screen *found)
{
    set_spectra(w);
    transform(w, mean, w->coefficient);
    double power = 0;
    for (size_t k = 1; k < w->parts; k++)
        power += w->coefficient[k] * w->coefficient[k];
    if (!(power > 0))
        return;
    start(w);
    if (temperature)
        find_temperature(w, significance, temperature, found);
    find_warm_up(w, significance, found);
    if (!found->warm_up) /* the exponential was fitted beside: without it again */
        fit(w, ROUNDS);
    take_temperature(w, found);
}

void imki_trend_of_means(double significance, size_t parts, size_t samples, double dt,
                         const double *mean, const double *temperature, imk_screen *found)
{
    trend_work work, *w = &work;
    if (parts < 16)
        return;
    w->parts = parts;
    w->n = parts * samples;
    w->dt = dt;
    w->trends = 0;
    find_trends(w, significance, mean, temperature, found);
}

void imki_trend_find(double significance, size_t n, const double *samples, imk_screen *found)
{
    trend_work work, *w = &work;
    const size_t parts = n / 8 < PARTS ? n / 8 : PARTS;
    if (parts < 16)
        return;
    w->parts = parts;
    w->n = n;
    w->dt = 1;
    w->trends = 0;
    if (part_means(w, samples, w->spectrum))
        find_trends(w, significance, w->spectrum, NULL, found);
}
