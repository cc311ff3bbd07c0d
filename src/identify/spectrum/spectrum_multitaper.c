/* SPDX-License-Identifier: Apache-2.0 */
/* What the eigencoefficients of one segment say: its density, and whether a bin holds a line.
 *
 * With S_k = |J_k|^2 the spectrum seen through taper k, of which the share 1 - lambda_k leaks in
 * from everywhere, the adaptive estimate is [THOMSON1982, (5.2)]
 *
 *     S = sum b_k^2 lambda_k S_k / sum b_k^2 lambda_k,   b_k = S/(lambda_k S + (1 - lambda_k) s2)
 *
 * s2 the segment's variance times dt, with 2 (sum b^2 lambda)^2/sum b^4 lambda^2 degrees of freedom
 * [PERCIVAL1993, (370b)].
 *
 * A sinusoid of complex amplitude mu adds mu U_k to J_k, U_k the taper's sum. Regression of the J_k
 * on the U_k gives F = |mu|^2 sum U^2 (K - 1)/sum |J_k - mu U_k|^2 with 2 and 2 K - 2 degrees of
 * freedom [THOMSON1982, (13.10)]; over several segments both sums of squares are added up, so that
 * the phase of the line may differ between them. */
#include "spectrum_internal.h"

#include <math.h>

enum { ITERATIONS = 8 };

static double eigenspectrum(const double *eigen, size_t count, int taper, size_t bin)
{
    const double *j = eigen + 2 * ((size_t)taper * count + bin);
    return j[0] * j[0] + j[1] * j[1];
}

void imki_multitaper_add(int tapers, size_t count, const double *eigen, const double *concentration,
                         bool adaptive, double variance, double *density, double *degrees)
{
    for (size_t bin = 0; bin < count; bin++) {
        double s[IMK_TAPERS_MAX], sum = 0, squares = 0, estimate = 0;
        for (int k = 0; k < tapers; k++) {
            s[k] = eigenspectrum(eigen, count, k, bin);
            estimate += s[k] / tapers;
        }
        if (adaptive && tapers > 1)
            estimate = 0.5 * (s[0] + s[1]);
        for (int iteration = 0; iteration < (adaptive ? ITERATIONS : 1); iteration++) {
            double weighted = 0;
            sum = squares = 0;
            for (int k = 0; k < tapers; k++) {
                const double leak = (1 - concentration[k]) * variance;
                const double below = concentration[k] * estimate + leak;
                const double b = !adaptive ? 1 : below > 0 ? estimate / below : 1;
                const double w = b * b * (adaptive ? concentration[k] : 1);
                weighted += w * s[k];
                sum += w;
                squares += w * w;
            }
            estimate = sum > 0 ? weighted / sum : 0;
        }
        density[bin] += estimate;
        degrees[bin] += squares > 0 ? 2 * sum * sum / squares : 2;
    }
}

void imki_harmonic_add(int tapers, size_t count, const double *eigen, const double *sums,
                       double *explained, double *rest)
{
    double total = 0;
    for (int k = 0; k < tapers; k++)
        total += sums[k] * sums[k];
    for (size_t bin = 0; bin < count; bin++) {
        double re = 0, im = 0, residual = 0;
        for (int k = 0; k < tapers; k++) {
            const double *j = eigen + 2 * ((size_t)k * count + bin);
            re += sums[k] * j[0] / total;
            im += sums[k] * j[1] / total;
        }
        for (int k = 0; k < tapers; k++) {
            const double *j = eigen + 2 * ((size_t)k * count + bin);
            const double x = j[0] - re * sums[k], y = j[1] - im * sums[k];
            residual += x * x + y * y;
        }
        explained[bin] += (re * re + im * im) * total;
        rest[bin] += residual;
    }
}
