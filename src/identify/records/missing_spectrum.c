/* SPDX-License-Identifier: Apache-2.0 */
/* The spectrum of a record with samples missing, as far as filling needs it: levels in bands 3 %
 * wide, of which those with few coefficients lean on the fit of quantization, white noise, bias
 * instability and random walk; and strong narrow lines, which keep their own power, so that a tone
 * runs on through the gaps. */
#include "missing_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* Degrees of freedom that a band's level, relative to the fit, is averaged over, which leaves it
 * uncertain by 10 %. */
static const double LEVEL_DEGREES = 200;
/* A line this many times narrower than its frequency, and this many times its surroundings, is
 * apart from the bands; a weaker one is hardly worth continuing. */
static const double NARROW = 25, STRONG = 4;

void imki_missing_bands(imki_missing *m, size_t n)
{
    m->bands = 0;
    for (size_t k = 1; k < n;) {
        const size_t wide = k < IMKI_SINGLE_BANDS ? 1 : (size_t)(0.03 * (double)k);
        size_t end = k + (wide > 1 ? wide : 1);
        if (end > n || m->bands == IMKI_BANDS_MAX - 1)
            end = n;
        const size_t b = m->bands++;
        m->first[b] = (double)k;
        m->width[b] = (double)(end - k);
        m->centre[b] = 0.5 * (double)(k + end - 1);
        k = end;
    }
}

static bool in_line(const imki_missing *m, size_t k)
{
    for (size_t i = 0; i < m->line_count; i++)
        if (k >= m->line[i].first && k <= m->line[i].last)
            return true;
    return false;
}

/* Mean over each band, without lines, of the squares of `coefficients`, divided by the variance if
 * given; and over how many. */
void imki_missing_means(const imki_missing *m, const double *coefficients, const double *variance,
                        double *mean, double *count)
{
    for (size_t b = 0; b < m->bands; b++) {
        const size_t first = (size_t)m->first[b], end = first + (size_t)m->width[b];
        double sum = 0, used = 0;
        for (size_t k = first; k < end; k++)
            if (m->line_count == 0 || !in_line(m, k)) {
                sum += coefficients[k] * coefficients[k] / (variance ? variance[k] : 1);
                used += 1;
            }
        count[b] = used;
        mean[b] = used > 0 ? sum / used : 0;
    }
}

/* Weighted mean over as many neighbours on both sides as make up the weight. */
void imki_missing_smooth(size_t bands, const double *value, const double *weight, double needed,
                         double *out)
{
    for (size_t b = 0; b < bands; b++) {
        double sum = weight[b] * value[b], total = weight[b];
        for (size_t reach = 1; total < needed && reach < bands; reach++) {
            if (b >= reach) {
                sum += weight[b - reach] * value[b - reach];
                total += weight[b - reach];
            }
            if (b + reach < bands) {
                sum += weight[b + reach] * value[b + reach];
                total += weight[b + reach];
            }
        }
        out[b] = total > 0 ? sum / total : 0;
    }
}

/* Values of the bands' table at index k, linear in k between their centres: `b` is the last band
 * whose centre is not above k, and is moved on. */
double imki_missing_between(const imki_missing *m, const double *table, size_t *b, size_t k)
{
    while (*b + 1 < m->bands && m->centre[*b + 1] <= (double)k)
        ++*b;
    if (*b + 1 == m->bands || (double)k < m->centre[*b])
        return table[*b];
    const double part = ((double)k - m->centre[*b]) / (m->centre[*b + 1] - m->centre[*b]);
    return table[*b] + part * (table[*b + 1] - table[*b]);
}

/* The variance of coefficient k, between lines; exponentials once in 32 coefficients. */
static void spread_levels(const imki_missing *m, size_t n, double *variance)
{
    size_t b = 0;
    for (size_t k = 1; k < n;) {
        const bool dense = b + 1 < m->bands && m->width[b] < 32;
        const size_t step = dense ? 1 : 32, end = k + step < n ? k + step : n;
        const double low = imki_missing_between(m, m->level, &b, k);
        size_t ahead = b;
        const double high = imki_missing_between(m, m->level, &ahead, end - 1);
        const double ratio = end - k > 1 ? imk_exp((high - low) / (double)(end - k - 1)) : 1;
        double v = imk_exp(low);
        for (; k < end; k++, v *= ratio)
            variance[k] = v;
    }
}

/* Lines keep their own power, averaged over a quarter of the distance from their middle, where it
 * stands out: to take every chance excess for a line would fill in too much. */
static void spread_lines(const imki_missing *m, size_t n, const double *coefficients,
                         double *variance)
{
    for (size_t i = 0; i < m->line_count; i++) {
        const imki_line *line = &m->line[i];
        const double centre = 0.5 * (double)(line->first + line->last);
        for (size_t k = line->first; k <= line->last; k++) {
            const size_t half = 1 + (size_t)(0.25 * fabs((double)k - centre));
            const size_t from = k > half ? k - half : 1, to = k + half < n ? k + half : n - 1;
            double sum = 0;
            for (size_t j = from; j <= to; j++)
                sum += coefficients[j] * coefficients[j];
            const double power = sum / (double)(to - from + 1);
            variance[k] = power > STRONG * variance[k] ? power : variance[k];
        }
    }
}

void imki_missing_spread(const imki_missing *m, size_t n, const double *coefficients,
                         double *variance)
{
    spread_levels(m, n, variance);
    if (coefficients)
        spread_lines(m, n, coefficients, variance);
}

/* Quantization, white noise, bias instability and random walk fitted to the bands. */
static bool fit_terms(imki_work *w, const imki_missing *m, const double *power,
                      const double *degrees)
{
    imki_bands *bands = w->bands;
    imki_fit *fit = w->fit;
    const double dt = w->settings->dt;
    bands->n = w->n;
    bands->dt = dt;
    bands->count = m->bands;
    bands->singles = 0;
    memset(fit, 0, sizeof *fit);
    fit->templates = IMKI_FIRST_GAUSS_MARKOV;
    for (size_t b = 0; b < m->bands; b++) {
        const double f = m->centre[b] / (2 * (double)w->n * dt);
        bands->frequency[b] = f;
        bands->degrees[b] = degrees[b];
        bands->length[b] = w->n;
        bands->power[b] = power[b] * dt;
        for (size_t parity = 0; parity < 2; parity++)
            bands->end_product[parity][b] = bands->end_square[parity][b] = 0;
        fit->shape[IMK_NOISE_QUANTIZATION][b] = imk_quantization_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_WHITE][b] = imk_white_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_BIAS_INSTABILITY][b] =
            b + 1 < IMKI_SINGLE_BANDS
                ? imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt, w->n, b + 1)
                : imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
        fit->shape[IMK_NOISE_RANDOM_WALK][b] = imk_random_walk_sampled_spectrum(1, dt, f);
    }
    const size_t middle = m->bands * 3 / 4, low = m->bands > 8 ? 4 : 0;
    for (size_t j = 0; j < fit->templates; j++)
        fit->active[j] = true;
    fit->amount[IMK_NOISE_WHITE] = fmax(bands->power[middle], 1e-12 * bands->power[low]);
    fit->amount[IMK_NOISE_QUANTIZATION] = 0.01 * fit->amount[IMK_NOISE_WHITE] * dt * dt;
    for (size_t j = IMK_NOISE_BIAS_INSTABILITY; j <= IMK_NOISE_RANDOM_WALK; j++)
        fit->amount[j] = 0.25 * bands->power[low] / fit->shape[j][low];
    return imki_fit_maximise(fit, bands) > -HUGE_VAL;
}

/* Levels of the bands: the fit, times the smoothed ratio to it. */
double imki_missing_levels(imki_work *w, imki_missing *m, const double *power,
                           const double *degrees)
{
    double *ratio = m->scratch[2], *reference = m->scratch[3], *smoothed = m->scratch[4];
    double change = 0, peak = 0;
    const bool fitted = fit_terms(w, m, power, degrees);
    for (size_t b = 0; b < m->bands; b++) {
        reference[b] = fitted ? imki_fit_spectrum(w->fit, b) / w->settings->dt : 1;
        ratio[b] = power[b] / reference[b];
    }
    imki_missing_smooth(m->bands, ratio, degrees, LEVEL_DEGREES, smoothed);
    for (size_t b = 0; b < m->bands; b++) {
        smoothed[b] *= reference[b];
        peak = fmax(peak, smoothed[b]);
    }
    for (size_t b = 0; b < m->bands; b++) {
        const double level = imk_ln(fmax(smoothed[b], 1e-20 * peak));
        const double moved = level - m->level[b];
        change += 0.5 * degrees[b] * moved * moved;
        m->level[b] = level;
    }
    return change;
}

void imki_missing_lines(imki_work *w, imki_missing *m)
{
    imki_line found[IMKI_LINES_MAX];
    w->cumulative[0] = w->cumulative[1] = 0;
    for (size_t k = 1; k < w->n; k++)
        w->cumulative[k + 1] = w->cumulative[k] + w->coefficients[k] * w->coefficients[k];
    const size_t count = imki_lines_find(w->n, w->cumulative, 1, found);
    m->line_count = 0;
    for (size_t i = 0; i < count; i++) {
        const double centre = 0.5 * (double)(found[i].first + found[i].last);
        if (found[i].ratio > STRONG &&
            centre > NARROW * (double)(found[i].last - found[i].first + 1))
            m->line[m->line_count++] = imki_line_widen(&found[i], w->n);
    }
}
