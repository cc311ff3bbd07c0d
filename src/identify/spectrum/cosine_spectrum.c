/* SPDX-License-Identifier: Apache-2.0 */
/* The record's cosine spectrum, gathered into bands.
 *
 * With c_k the orthonormal DCT-II of n samples, E c_k^2 dt is the two-sided spectrum S(f) at
 * f = k/(2 n dt). The c_k are independent for white noise, and for a random walk too: the DCT
 * diagonalises its precision matrix D^T D exactly, so no window is needed against leakage. Low
 * frequencies keep one band per coefficient; above, a band spans 3 % in frequency, over which
 * averaging loses nothing. */
#include "identify/likelihood/identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Band edges: a coefficient each up to IMKI_SINGLE_BANDS, then 3 % wide, but near a resonance no
 * wider than an eighth of its half-power width and of the distance to it. */
static size_t next_edge(size_t k, double step_hz, size_t resonance_count,
                        const imk_resonance *resonances)
{
    double width = 0.03 * (double)k;
    for (size_t i = 0; i < resonance_count; i++) {
        const double half_power = resonances[i].frequency / resonances[i].q / step_hz;
        const double distance = fabs((double)k - resonances[i].frequency / step_hz);
        width = fmin(width, (half_power + distance) / 8);
    }
    return k + (width > 1 ? (size_t)width : 1);
}

static bool in_line(size_t k, size_t line_count, const imki_line *lines)
{
    for (size_t i = 0; i < line_count; i++)
        if (k >= lines[i].first && k <= lines[i].last)
            return true;
    return false;
}

/* First index at or after k at which the state of being in a line changes, at most `end`. */
static size_t line_change(size_t k, size_t end, size_t line_count, const imki_line *lines)
{
    for (size_t i = 0; i < line_count; i++) {
        if (lines[i].first > k && lines[i].first < end)
            end = lines[i].first;
        if (lines[i].last + 1 > k && lines[i].last + 1 < end)
            end = lines[i].last + 1;
    }
    return end;
}

/* DCT-II of t_j = j dt:  d_k = -sqrt(2/n) dt cos(w/2)/(2 sin^2(w/2)) for odd k, w = pi k/n; 0 for
 * even k. (From sum_j j cos(w(j+1/2)) = Re sum of an arithmetico-geometric series.) */
static double ramp_coefficient(size_t n, double dt, size_t k)
{
    if (k % 2 == 0)
        return 0;
    const double half = 1.5707963267948966 * (double)k / (double)n, s = imk_sin(half);
    return -sqrt(2.0 / (double)n) * dt * imk_cos(half) / (2 * s * s);
}

/* What the rounding errors before the first sample, e_0, and behind the last, e_n, add to the
 * coefficients of a quantized record: summed by parts, (e_(j+1) - e_j)/dt transforms to white noise
 * times 2 sin(w/2) plus sqrt(2/n) cos(w/2)/dt [(-1)^k e_n - e_0]. Within a band the cosine is taken
 * at its centre: where it changes, at the fast end, the rest is much larger. */
static void add_end_sums(imki_bands *bands, size_t b, size_t k, size_t end,
                         const imki_spectrum *spectrum)
{
    const double n = (double)spectrum->n,
                 half = 1.5707963267948966 * 0.5 * (double)(k + end - 1) / n;
    const double u = sqrt(2 / n) * imk_cos(half) / spectrum->dt;
    double sum[2] = {0, 0};
    for (size_t i = k; i < end; i++)
        sum[i % 2] += spectrum->coefficients[i];
    for (size_t parity = 0; parity < 2; parity++) {
        const double terms = (double)((end + 1 - parity) / 2 - (k + 1 - parity) / 2);
        bands->end_product[parity][b] = u * sum[parity] * spectrum->dt;
        bands->end_square[parity][b] = u * u * terms * spectrum->dt;
    }
}

/* The coefficients k … end - 1 as one band. */
static void add_band(imki_bands *bands, const imki_spectrum *spectrum, size_t k, size_t end)
{
    const size_t b = bands->count++;
    const double step_hz = 1 / (2 * (double)spectrum->n * spectrum->dt);
    const double *c = spectrum->coefficients;
    bands->frequency[b] = 0.5 * (double)(k + end - 1) * step_hz;
    bands->degrees[b] = (double)(end - k) * spectrum->squares;
    bands->length[b] = spectrum->length;
    bands->power[b] = (spectrum->cumulative[end] - spectrum->cumulative[k]) / (double)(end - k);
    for (size_t parity = 0; parity < 2; parity++)
        bands->end_product[parity][b] = bands->end_square[parity][b] = 0;
    if (!c)
        return;
    add_end_sums(bands, b, k, end, spectrum);
    if (b + 1 == k && k < IMKI_SINGLE_BANDS) {
        const double factor = sqrt(spectrum->dt / bands->dt);
        bands->power[b] = c[k] * c[k] * spectrum->dt;
        bands->coefficient[b] = factor * c[k];
        bands->ramp[b] = factor * ramp_coefficient(spectrum->n, spectrum->dt, k);
        bands->singles = b + 1;
    }
}

void imki_bands_add(imki_bands *bands, const imki_spectrum *spectrum, size_t resonance_count,
                    const imk_resonance *resonances)
{
    const double step_hz = 1 / (2 * (double)spectrum->n * spectrum->dt);
    for (size_t k = spectrum->first; k < spectrum->end && bands->count < IMKI_BANDS_MAX;) {
        size_t end = spectrum->coefficients && k < IMKI_SINGLE_BANDS
                         ? k + 1
                         : next_edge(k, step_hz, resonance_count, resonances);
        if (end > spectrum->end || bands->count == IMKI_BANDS_MAX - 1)
            end = spectrum->end;
        end = line_change(k, end, spectrum->line_count, spectrum->lines);
        if (!in_line(k, spectrum->line_count, spectrum->lines))
            add_band(bands, spectrum, k, end);
        k = end;
    }
}

void imki_bands_build(imki_bands *bands, size_t n, double dt, const double *coefficients,
                      const double *cumulative, size_t line_count, const imki_line *lines,
                      size_t resonance_count, const imk_resonance *resonances)
{
    const imki_spectrum whole = {n, dt, n, 1, n, 1, coefficients, cumulative, line_count, lines};
    bands->n = n;
    bands->dt = dt;
    bands->count = bands->singles = 0;
    imki_bands_add(bands, &whole, resonance_count, resonances);
}

/* The sums for the ends are sums over coefficients like the degrees: with less weight on these
 * alone, the ends would explain more than the power that there is, and the likelihood have no top.
 */
void imki_bands_weigh(imki_bands *bands, size_t b, double factor)
{
    bands->degrees[b] *= factor;
    for (size_t parity = 0; parity < 2; parity++) {
        bands->end_product[parity][b] *= factor;
        bands->end_square[parity][b] *= factor;
    }
}

static void arma_shape(const imk_arma *arma, const imki_bands *bands, double *shape)
{
    for (size_t b = 0; b < bands->count; b++)
        shape[b] = imk_arma_spectrum(arma, bands->frequency[b]);
}

void imki_resonance_shape(double frequency, double q, const imki_bands *bands, double *shape)
{
    imk_arma arma;
    if (imk_resonance_arma((imk_resonance){1, frequency, q}, bands->dt, &arma) == IMK_OK)
        arma_shape(&arma, bands, shape);
}

void imki_filter_shape(imk_low_pass filter, const imki_bands *bands, double *shape)
{
    imk_arma arma;
    if (imk_filtered_white_arma(1, filter, bands->dt, &arma) == IMK_OK)
        arma_shape(&arma, bands, shape);
}
