/* SPDX-License-Identifier: Apache-2.0 */
/* Maximum likelihood of a sum of spectra, and its profile.
 *
 * A band's power P is S times a chi-square mean of v degrees, so
 *
 *     l = -1/2 sum_b v_b [ log S_b + P_b/S_b ],   S_b = sum_j amount_j shape_jb,   amount >= 0
 *
 * [WHITTLE1953], less what it would be with S_b = P_b (imki_deviance()); the terms are linear in S,
 * so Fisher scoring with the information H_ij = 1/2 sum_b v_b shape_ib shape_jb / S_b^2 converges
 * in a few steps. Two things enter the mean of the coefficients c:
 *
 * - a ramp, in the lowest: P = (c - ramp d)^2 dt;
 * - the rounding errors at the ends of a quantized record, a u with a ~ N(0, q), q = 2 Q^2, one a
 *   for odd coefficients, one for even ones. With W = sum u^2 dt/S, X = sum u c dt/S over them,
 *   integration over a adds to the likelihood
 *
 *       -1/2 log(1 + q W) + 1/2 q X^2/(1 + q W)
 *
 *   Its gradient in S is that of the likelihood without a, with the expected square E (c - a u)^2
 *   for c^2: a has the mean m = V X and the variance V = q/(1 + q W). */
#include "identify_internal.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

double imki_fit_spectrum(const imki_fit *fit, size_t band)
{
    double s = fit->floor;
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j])
            s += fit->amount[j] * fit->shape[j][band];
    return s;
}

/* Row by row, which the compiler vectorises. */
static void add_spectrum(const imki_fit *fit, size_t count, double *restrict spectrum)
{
    for (size_t b = 0; b < count; b++)
        spectrum[b] = fit->floor;
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j] && fit->amount[j] > 0) {
            const double *restrict shape = fit->shape[j], amount = fit->amount[j];
            for (size_t b = 0; b < count; b++)
                spectrum[b] += amount * shape[b];
        }
}

/* Product of u and the coefficients less the ramp, times dt, summed over a band. */
static double end_product(const imki_fit *fit, const imki_bands *bands, size_t parity, size_t b)
{
    double product = bands->end_product[parity][b];
    if (parity == 1 && fit->ramp != 0 && b < bands->singles)
        product -= fit->ramp * bands->ramp[b] * sqrt(bands->end_square[1][b] * bands->dt);
    return product;
}

/* What the ends add to the likelihood; takes them from the powers. */
static double take_ends(const imki_fit *fit, const imki_bands *bands, imki_evaluation *e)
{
    const double q = 2 * fit->amount[IMK_NOISE_QUANTIZATION];
    double gain = 0;
    e->end_slope = e->end_information = 0;
    if (!fit->active[IMK_NOISE_QUANTIZATION] || !(q > 0))
        return 0;
    for (size_t parity = 0; parity < 2; parity++) {
        const double *square = bands->end_square[parity];
        double w = 0, x = 0;
        for (size_t b = 0; b < bands->count; b++) {
            w += square[b] / e->spectrum[b];
            x += end_product(fit, bands, parity, b) / e->spectrum[b];
        }
        const double part = 1 / (1 + q * w), variance = q * part, mean = variance * x;
        gain += 0.5 * imk_ln(part) + 0.5 * mean * x;
        e->end_slope += part * (x * x * part - w);
        e->end_information += 2 * w * w * part * part;
        for (size_t b = 0; b < bands->count; b++)
            e->power[b] += ((mean * mean + variance) * square[b] -
                            2 * mean * end_product(fit, bands, parity, b)) /
                           bands->degrees[b];
    }
    return gain;
}

/* Deviance of every band: a loop that the compiler vectorises. */
static void add_deviances(const imki_bands *bands, const double *restrict spectrum,
                          double *restrict deviance)
{
    const double *restrict power = bands->power, *restrict degrees = bands->degrees;
    const size_t count = bands->count;
    for (size_t b = 0; b < count; b++)
        deviance[b] = degrees[b] * imki_deviance(power[b], spectrum[b]);
}

static double evaluate(imki_fit *fit, const imki_bands *bands)
{
    imki_evaluation *e = &fit->evaluation;
    const size_t count = bands->count;
    double sum = 0;
    bool inside = true;
    add_spectrum(fit, count, e->spectrum);
    add_deviances(bands, e->spectrum, e->weight);
    for (size_t b = 0; b < count; b++) {
        const double s = e->spectrum[b];
        inside &= (s >= IMKI_LEAST_SPECTRUM) & (s <= IMKI_MOST_SPECTRUM);
        sum += e->weight[b];
    }
    memcpy(e->power, bands->power, count * sizeof(double));
    for (size_t b = 0; fit->ramp != 0 && b < bands->singles; b++) {
        const double c = bands->coefficient[b] - fit->ramp * bands->ramp[b];
        e->power[b] = c * c * bands->dt;
        sum += bands->degrees[b] * (e->power[b] - bands->power[b]) / e->spectrum[b];
    }
    e->log_likelihood = -HUGE_VAL;
    if (inside && sum == sum)
        e->log_likelihood = -0.5 * sum + take_ends(fit, bands, e);
    return e->log_likelihood;
}

/* Gradient and information over columns dS/d parameter, at an evaluation. */
static void slope(imki_evaluation *e, const imki_bands *bands, size_t count,
                  const double *const *columns, double *gradient, double *information)
{
    const size_t bands_count = bands->count;
    const double *restrict spectrum = e->spectrum, *restrict power = e->power;
    double *restrict weight = e->weight, *restrict product = e->product;
    for (size_t b = 0; b < bands_count; b++)
        weight[b] = 0.5 * bands->degrees[b] / (spectrum[b] * spectrum[b]);
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        for (size_t b = 0; b < bands_count; b++) {
            product[b] = weight[b] * columns[i][b];
            sum += product[b] * (power[b] - spectrum[b]);
        }
        gradient[i] = sum;
        for (size_t j = 0; j <= i; j++) {
            double part[4] = {0, 0, 0, 0}; /* four sums side by side */
            size_t b = 0;
            for (; b + 4 <= bands_count; b += 4)
                for (size_t lane = 0; lane < 4; lane++)
                    part[lane] += product[b + lane] * columns[j][b + lane];
            for (; b < bands_count; b++)
                part[0] += product[b] * columns[j][b];
            information[i * count + j] = information[j * count + i] =
                part[0] + part[1] + (part[2] + part[3]);
        }
    }
}

void imki_fit_slope(imki_fit *fit, const imki_bands *bands, size_t count,
                    const double *const *columns, double *gradient, double *information)
{
    evaluate(fit, bands);
    slope(&fit->evaluation, bands, count, columns, gradient, information);
}

/* Covariance of the active amounts: inverse of the scaled information. */
void imki_fit_covariance(imki_fit *fit, const imki_bands *bands, double *covariance)
{
    const size_t t = fit->templates;
    double h[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX], scale[IMKI_TEMPLATES_MAX];
    double gradient[IMKI_TEMPLATES_MAX], inverse[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    const double *columns[IMKI_TEMPLATES_MAX] = {0};
    size_t index[IMKI_TEMPLATES_MAX] = {0}, count = 0;
    for (size_t i = 0; i < t; i++)
        if (fit->active[i]) {
            columns[count] = fit->shape[i];
            index[count++] = i;
        }
    memset(covariance, 0, t * t * sizeof *covariance);
    imki_fit_slope(fit, bands, count, columns, gradient, h);
    for (size_t i = 0; i < count; i++)
        scale[i] = h[i * count + i] > 0 ? 1 / sqrt(h[i * count + i]) : 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            h[i * count + j] = i == j ? 1 + 1e-12 : h[i * count + j] * scale[i] * scale[j];
    if (imk_cholesky_factor(count, h) != IMK_OK)
        return;
    imk_cholesky_inverse(count, h, inverse);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            covariance[index[i] * t + index[j]] = inverse[i * count + j] * scale[i] * scale[j];
}

double imki_fit_degrees(imki_fit *fit, const imki_bands *bands, double value, const double *slope)
{
    const size_t t = fit->templates;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX], variance = 0;
    imki_fit_covariance(fit, bands, covariance);
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            variance += covariance[i * t + j] * slope[i] * slope[j];
    return fmin(1e6, 2 * value * value / variance);
}

double imki_fit_ramp_information(const imki_fit *fit, const imki_bands *bands)
{
    double sum = 0;
    for (size_t b = 0; b < bands->singles; b++)
        sum += bands->ramp[b] * bands->ramp[b] * bands->dt / imki_fit_spectrum(fit, b);
    return sum;
}

double imki_fit_ramp_degrees(imki_fit *fit, const imki_bands *bands)
{
    double slope[IMKI_TEMPLATES_MAX] = {0}; /* of the information, its sign changed */
    for (size_t j = 0; j < fit->templates; j++)
        for (size_t b = 0; fit->active[j] && b < bands->singles; b++) {
            const double ratio = bands->ramp[b] / imki_fit_spectrum(fit, b);
            slope[j] += ratio * ratio * bands->dt * fit->shape[j][b];
        }
    return imki_fit_degrees(fit, bands, imki_fit_ramp_information(fit, bands), slope) - 1;
}

/* Best ramp for the present spectrum: weighted mean of c/d. */
static double best_ramp(const imki_bands *bands, const imki_evaluation *e)
{
    double product = 0, information = 0;
    for (size_t b = 0; b < bands->singles; b++) {
        product += bands->ramp[b] * bands->coefficient[b] / e->spectrum[b];
        information += bands->ramp[b] * bands->ramp[b] / e->spectrum[b];
    }
    return information > 0 ? product / information : 0;
}

/* Solves the scaled h x = g for the parameters in `index`, of `count` in all; x in `solution`,
 * scaled. */
static bool solve(size_t count, const double *h, const double *g, size_t chosen,
                  const size_t *index, const double *scale, double *solution)
{
    double matrix[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    for (size_t i = 0; i < chosen; i++) {
        for (size_t j = 0; j < chosen; j++)
            matrix[i * chosen + j] =
                h[index[i] * count + index[j]] * scale[index[i]] * scale[index[j]];
        matrix[i * chosen + i] += 1e-12; /* templates may coincide where the record cannot tell */
        solution[i] = g[index[i]] * scale[index[i]];
    }
    if (imk_cholesky_factor(chosen, matrix) != IMK_OK)
        return false;
    imk_cholesky_solve(chosen, matrix, solution);
    return true;
}

/* Newton step over the free amounts; those that would turn negative are taken to zero one by one,
 * and the step of the others solved again. Returns twice the likelihood that
 * the step promises, negative when there is none. */
static double scoring_step(imki_fit *fit, const imki_bands *bands, int held, double *step)
{
    imki_evaluation *e = &fit->evaluation;
    size_t slot[IMKI_TEMPLATES_MAX] = {0}, index[IMKI_TEMPLATES_MAX], count = 0;
    const double *columns[IMKI_TEMPLATES_MAX] = {0};
    double gradient[IMKI_TEMPLATES_MAX], h[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    double scale[IMKI_TEMPLATES_MAX], solution[IMKI_TEMPLATES_MAX];
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j] && (int)j != held) {
            columns[count] = fit->shape[j];
            slot[count++] = j;
        }
    memset(step, 0, IMKI_TEMPLATES_MAX * sizeof *step);
    slope(e, bands, count, columns, gradient, h);
    if (count > 0 && slot[0] == IMK_NOISE_QUANTIZATION) {
        gradient[0] += e->end_slope;
        h[0] += e->end_information;
    }
    for (size_t i = 0; i < count; i++) {
        scale[i] = h[i * count + i] > 0 ? 1 / sqrt(h[i * count + i]) : 0;
        index[i] = i;
    }
    double moved[IMKI_TEMPLATES_MAX]; /* gradient after the steps that are fixed */
    memcpy(moved, gradient, sizeof moved);
    size_t chosen = count;
    while (chosen > 0) {
        if (!solve(count, h, moved, chosen, index, scale, solution))
            return -1;
        size_t worst = chosen;
        double least = 0;
        for (size_t i = 0; i < chosen; i++) {
            const double left = scale[index[i]] > 0
                                    ? fit->amount[slot[index[i]]] / scale[index[i]] + solution[i]
                                    : 0;
            worst = left < least ? i : worst;
            least = fmin(least, left);
        }
        if (worst == chosen)
            break;
        const size_t fixed = index[worst];
        step[slot[fixed]] = -fit->amount[slot[fixed]];
        for (size_t j = 0; j < count; j++)
            moved[j] -= h[j * count + fixed] * step[slot[fixed]];
        for (size_t i = worst; i + 1 < chosen; i++)
            index[i] = index[i + 1];
        chosen--;
    }
    for (size_t i = 0; i < chosen; i++)
        step[slot[index[i]]] = solution[i] * scale[index[i]];
    double promised = 0;
    for (size_t i = 0; i < count; i++)
        promised += step[slot[i]] * gradient[i];
    return promised;
}

static bool take_step(imki_fit *fit, const imki_bands *bands, const double *step, double best)
{
    double start[IMKI_TEMPLATES_MAX];
    memcpy(start, fit->amount, sizeof start);
    for (double part = 1; part > 1e-10; part *= 0.5) {
        for (size_t j = 0; j < fit->templates; j++)
            fit->amount[j] = fmax(0, start[j] + part * step[j]);
        if (evaluate(fit, bands) >= best)
            return true;
    }
    memcpy(fit->amount, start, sizeof start);
    return false;
}

static double maximise(imki_fit *fit, const imki_bands *bands, int held)
{
    const imki_evaluation *e = &fit->evaluation;
    double best = evaluate(fit, bands);
    for (int iteration = 0; iteration < 200; iteration++) {
        const double before = best;
        double step[IMKI_TEMPLATES_MAX];
        const double promised = scoring_step(fit, bands, held, step);
        const bool moved = promised > 1e-8;
        if (moved && !take_step(fit, bands, step, best))
            evaluate(fit, bands);
        best = moved ? e->log_likelihood : best;
        if (fit->ramp_active && held != IMKI_HELD_RAMP) {
            const double ramp = fit->ramp;
            fit->ramp = best_ramp(bands, e);
            if (!(evaluate(fit, bands) >= best)) {
                fit->ramp = ramp;
                evaluate(fit, bands);
            }
            best = e->log_likelihood;
        }
        if (!(best - before > 1e-7))
            break;
    }
    fit->log_likelihood = best;
    return best;
}

double imki_fit_maximise(imki_fit *fit, const imki_bands *bands)
{
    return maximise(fit, bands, IMKI_HELD_NONE);
}

double imki_fit_profile(imki_fit *fit, const imki_bands *bands, int held, double value)
{
    if (held == IMKI_HELD_RAMP)
        fit->ramp = value;
    else
        fit->amount[held] = value;
    return maximise(fit, bands, held);
}

imki_amounts imki_fit_keep(const imki_fit *fit)
{
    imki_amounts kept = {
        .ramp_active = fit->ramp_active, .ramp = fit->ramp, .log_likelihood = fit->log_likelihood};
    memcpy(kept.active, fit->active, sizeof kept.active);
    memcpy(kept.amount, fit->amount, sizeof kept.amount);
    memcpy(kept.correlation_time, fit->correlation_time, sizeof kept.correlation_time);
    return kept;
}

void imki_fit_restore(imki_fit *fit, const imki_bands *bands, const imki_amounts *kept)
{
    memcpy(fit->active, kept->active, sizeof kept->active);
    memcpy(fit->amount, kept->amount, sizeof kept->amount);
    for (size_t i = 0; i < IMKI_GAUSS_MARKOV_MAX; i++) {
        const size_t slot = IMKI_FIRST_GAUSS_MARKOV + i;
        const double time = kept->active[slot] ? kept->correlation_time[i] : 0;
        if (time > 0 && fit->correlation_time[i] != time)
            imki_gauss_markov_shape(fit, bands, time, fit->shape[slot]);
        fit->correlation_time[i] = time;
    }
    fit->ramp_active = kept->ramp_active;
    fit->ramp = kept->ramp;
    fit->log_likelihood = kept->log_likelihood;
}

void imki_fit_copy(imki_fit *to, const imki_fit *from, const imki_bands *bands)
{
    const imki_amounts kept = imki_fit_keep(from);
    to->templates = from->templates;
    to->floor = from->floor;
    memcpy(to->sine_square, from->sine_square, bands->count * sizeof(double));
    memcpy(to->correlation_time, from->correlation_time, sizeof to->correlation_time);
    for (size_t j = 0; j < from->templates; j++)
        if (from->active[j] || j < IMKI_FIRST_GAUSS_MARKOV)
            memcpy(to->shape[j], from->shape[j], bands->count * sizeof(double));
    imki_fit_restore(to, bands, &kept);
}
