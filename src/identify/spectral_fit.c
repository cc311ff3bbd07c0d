/* SPDX-License-Identifier: Apache-2.0 */
/* Maximum likelihood of a sum of spectra, and its profile.
 *
 * A band's power P is S times a chi-square mean of v degrees, so
 *
 *     l = -1/2 sum_b v_b [ log S_b + P_b/S_b ],   S_b = sum_j amount_j shape_jb,   amount >= 0
 *
 * [WHITTLE1953]; the terms are linear in S, so Fisher scoring with the information
 * H_ij = 1/2 sum_b v_b shape_ib shape_jb / S_b^2 converges in a few steps. A ramp enters the mean
 * of the lowest coefficients: P = (c - ramp d)^2 dt. */
#include "identify_internal.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

double imki_fit_spectrum(const imki_fit *fit, size_t band)
{
    double s = 0;
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j])
            s += fit->amount[j] * fit->shape[j][band];
    return s;
}

static double band_power(const imki_fit *fit, const imki_bands *bands, size_t b)
{
    if (b >= bands->singles || fit->ramp == 0)
        return bands->power[b];
    const double c = bands->coefficient[b] - fit->ramp * bands->ramp[b];
    return c * c * bands->dt;
}

static double likelihood(const imki_fit *fit, const imki_bands *bands)
{
    double sum = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const double s = imki_fit_spectrum(fit, b);
        if (!(s > 0))
            return -INFINITY;
        sum += bands->degrees[b] * (log(s) + band_power(fit, bands, b) / s);
    }
    return -0.5 * sum;
}

/* Gradient and information over the templates in `index`. */
static void slope(const imki_fit *fit, const imki_bands *bands, size_t count, const size_t *index,
                  double *gradient, double *information)
{
    memset(gradient, 0, count * sizeof *gradient);
    memset(information, 0, count * count * sizeof *information);
    for (size_t b = 0; b < bands->count; b++) {
        const double s = imki_fit_spectrum(fit, b), weight = 0.5 * bands->degrees[b] / (s * s);
        const double excess = weight * (band_power(fit, bands, b) - s);
        for (size_t i = 0; i < count; i++) {
            const double shape = fit->shape[index[i]][b];
            gradient[i] += excess * shape;
            for (size_t j = 0; j <= i; j++)
                information[i * count + j] += weight * shape * fit->shape[index[j]][b];
        }
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++)
            information[j * count + i] = information[i * count + j];
}

/* Covariance of the active amounts: inverse of the scaled information. */
void imki_fit_covariance(const imki_fit *fit, const imki_bands *bands, double *covariance)
{
    const size_t t = fit->templates;
    double h[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX], scale[IMKI_TEMPLATES_MAX];
    double gradient[IMKI_TEMPLATES_MAX];
    size_t index[IMKI_TEMPLATES_MAX] = {0};
    for (size_t i = 0; i < t; i++)
        index[i] = i;
    slope(fit, bands, t, index, gradient, h);
    for (size_t i = 0; i < t; i++)
        scale[i] = fit->active[i] && h[i * t + i] > 0 ? 1 / sqrt(h[i * t + i]) : 0;
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            h[i * t + j] = i == j ? 1 + 1e-12 : h[i * t + j] * scale[i] * scale[j];
    memset(covariance, 0, t * t * sizeof *covariance);
    if (imk_cholesky_factor(t, h) != IMK_OK)
        return;
    imk_cholesky_inverse(t, h, covariance);
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            covariance[i * t + j] *= scale[i] * scale[j];
}

double imki_fit_ramp_information(const imki_fit *fit, const imki_bands *bands)
{
    double sum = 0;
    for (size_t b = 0; b < bands->singles; b++)
        sum += bands->ramp[b] * bands->ramp[b] * bands->dt / imki_fit_spectrum(fit, b);
    return sum;
}

/* Best ramp for the present spectrum: weighted mean of c/d. */
static void fit_ramp(imki_fit *fit, const imki_bands *bands)
{
    double product = 0;
    for (size_t b = 0; b < bands->singles; b++)
        product += bands->ramp[b] * bands->coefficient[b] * bands->dt / imki_fit_spectrum(fit, b);
    fit->ramp = product / imki_fit_ramp_information(fit, bands);
}

/* Newton step over the free amounts; those that would turn negative are held at zero one by one,
 * and a zero amount is freed when the likelihood rises with it. */
static bool scoring_step(const imki_fit *fit, const imki_bands *bands, int held, double *step)
{
    size_t index[IMKI_TEMPLATES_MAX], count = 0;
    double gradient[IMKI_TEMPLATES_MAX], h[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    for (size_t j = 0; j < fit->templates; j++)
        if (fit->active[j] && (int)j != held)
            index[count++] = j;
    memset(step, 0, IMKI_TEMPLATES_MAX * sizeof *step);
    while (count > 0) {
        slope(fit, bands, count, index, gradient, h);
        double scale[IMKI_TEMPLATES_MAX];
        for (size_t i = 0; i < count; i++)
            scale[i] = h[i * count + i] > 0 ? 1 / sqrt(h[i * count + i]) : 0;
        for (size_t i = 0; i < count; i++) {
            for (size_t j = 0; j < count; j++)
                h[i * count + j] *= scale[i] * scale[j];
            h[i * count + i] +=
                1e-12; /* templates may coincide where the record cannot tell them */
            gradient[i] *= scale[i];
        }
        if (imk_cholesky_factor(count, h) != IMK_OK)
            return false;
        imk_cholesky_solve(count, h, gradient);
        size_t worst = count;
        for (size_t i = 0; i < count; i++) {
            gradient[i] *= scale[i];
            if (fit->amount[index[i]] <= 0 && gradient[i] < 0 &&
                (worst == count || gradient[i] / scale[i] < gradient[worst] / scale[worst]))
                worst = i;
        }
        if (worst == count) {
            for (size_t i = 0; i < count; i++)
                step[index[i]] = gradient[i];
            return true;
        }
        for (size_t i = worst; i + 1 < count; i++)
            index[i] = index[i + 1];
        count--;
    }
    return true;
}

static double maximise(imki_fit *fit, const imki_bands *bands, int held)
{
    double best = likelihood(fit, bands);
    for (int iteration = 0; iteration < 200; iteration++) {
        const double before = best, ramp = fit->ramp;
        double step[IMKI_TEMPLATES_MAX], start[IMKI_TEMPLATES_MAX];
        memcpy(start, fit->amount, sizeof start);
        if (!scoring_step(fit, bands, held, step))
            break;
        for (double part = 1; part > 1e-10; part *= 0.5) {
            for (size_t j = 0; j < fit->templates; j++)
                fit->amount[j] = fmax(0, start[j] + part * step[j]);
            const double trial = likelihood(fit, bands);
            if (trial >= best) {
                best = trial;
                break;
            }
            memcpy(fit->amount, start, sizeof start);
        }
        if (fit->ramp_active && held != IMKI_HELD_RAMP) {
            fit_ramp(fit, bands);
            const double trial = likelihood(fit, bands);
            fit->ramp = trial >= best ? fit->ramp : ramp;
            best = trial >= best ? trial : best;
        }
        if (best - before <= 1e-9)
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
