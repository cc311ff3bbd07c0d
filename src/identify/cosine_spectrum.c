/* SPDX-License-Identifier: Apache-2.0 */
/* The record's cosine spectrum, gathered into bands.
 *
 * With c_k the orthonormal DCT-II of n samples, E c_k^2 dt is the two-sided spectrum S(f) at
 * f = k/(2 n dt). The c_k are independent for white noise, and for a random walk too: the DCT
 * diagonalises its precision matrix D^T D exactly, so no window is needed against leakage. Low
 * frequencies keep one band per coefficient; above, a band spans 3 % in frequency, over which
 * averaging loses nothing. */
#include "identify_internal.h"

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
    const double half = 1.5707963267948966 * (double)k / (double)n, s = sin(half);
    return -sqrt(2.0 / (double)n) * dt * cos(half) / (2 * s * s);
}

/* @param cumulative  cumulative[k] = sum of c_i^2 dt over 1 <= i < k, n + 1 values */
void imki_bands_build(imki_bands *bands, size_t n, double dt, const double *coefficients,
                      const double *cumulative, size_t line_count, const imki_line *lines,
                      size_t resonance_count, const imk_resonance *resonances)
{
    const double step_hz = 1 / (2 * (double)n * dt);
    bands->n = n;
    bands->dt = dt;
    bands->count = bands->singles = 0;
    for (size_t k = 1; k < n && bands->count < IMKI_BANDS_MAX;) {
        size_t end =
            k < IMKI_SINGLE_BANDS ? k + 1 : next_edge(k, step_hz, resonance_count, resonances);
        if (end > n || bands->count == IMKI_BANDS_MAX - 1)
            end = n;
        end = line_change(k, end, line_count, lines);
        if (!in_line(k, line_count, lines)) {
            const size_t b = bands->count++;
            bands->frequency[b] = 0.5 * (double)(k + end - 1) * step_hz;
            bands->degrees[b] = (double)(end - k);
            bands->power[b] = (cumulative[end] - cumulative[k]) / (double)(end - k);
            if (b + 1 == k && k < IMKI_SINGLE_BANDS) {
                bands->power[b] = coefficients[k] * coefficients[k] * dt;
                bands->coefficient[b] = coefficients[k];
                bands->ramp[b] = ramp_coefficient(n, dt, k);
                bands->singles = b + 1;
            }
        }
        k = end;
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
