/* SPDX-License-Identifier: Apache-2.0 */
/* What the likelihood is given of a record with samples missing: powers of full size, and what they
 * weigh.
 *
 * The projection A = v^(1/2) C_p^T Sigma_pp^-1 C_p v^(1/2) on the present samples has the diagonal
 * a_k, and the information about spectra v' and v'' is 1/2 sum_kl (v'/v)_k |A_kl|^2 (v''/v)_l. Of
 * the sum of |A_kl|^2 over l, which is a_k, a_k^2 is on the diagonal. The rest is spread by the
 * spectrum of the gaps, over 1/gap in frequency. Where that is narrow against f it counts as if it
 * were on the diagonal; what goes far tells the level of all the spectrum, not its shape, and is
 * given up:
 *
 *     degrees  a_k [a_k + (1 - a_k) near_k]
 *
 * with near_k the share of the gaps' spectrum within f/10. (With a fifth missing at random, the
 * interval of white noise, which is nothing but that level, is a tenth wider than it need be.) */
#include "missing_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Share of the gaps' spectrum within f/10, f in cycles per sample: of a run of l samples within
 * x/l, the integral of sinc^2 from -x to x, about 2x/sqrt(1 + 4 x^2) (to 0.07). */
static double near_share(const imki_missing *m, double frequency)
{
    double sum = 0, total = 0;
    for (size_t octave = 0; octave < IMKI_RUN_OCTAVES; octave++)
        if (m->runs[octave] > 0) {
            const double x = frequency / 10 * m->in_runs[octave] / m->runs[octave];
            sum += m->in_runs[octave] * 2 * x / sqrt(1 + 4 * x * x);
            total += m->in_runs[octave];
        }
    return total > 0 ? sum / total : 0;
}

/* A narrow line is filled in nearly whole, and what is missing is of the noise under it: there the
 * power is added, elsewhere the coefficient is enlarged. */
void imki_missing_restore(const imki_missing *m, size_t n, double *coefficients)
{
    size_t b = 0;
    for (size_t k = 1; k < n; k++) {
        const double lost = imki_missing_between(m, m->lost, &b, k);
        coefficients[k] /= sqrt(1 - lost);
    }
    for (size_t i = 0; i < m->line_count; i++) {
        b = 0;
        for (size_t k = m->line[i].first; k <= m->line[i].last; k++) {
            const double lost = imki_missing_between(m, m->lost, &b, k), c = coefficients[k];
            const double under = lost * imk_exp(imki_missing_between(m, m->level, &b, k));
            coefficients[k] = copysign(sqrt(c * c * (1 - lost) + under), c);
        }
    }
}

void imki_missing_weigh(imki_missing *m, imki_bands *bands)
{
    size_t at = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const double f = bands->frequency[b], near = near_share(m, f * bands->dt);
        const size_t k = (size_t)(f * 2 * (double)bands->n * bands->dt + 0.5);
        const double a = 1 - imki_missing_between(m, m->lost, &at, k);
        m->whole[b] = bands->degrees[b];
        imki_bands_weigh(bands, b, a * (a + (1 - a) * near));
        if (b < bands->singles)
            bands->ramp[b] = m->ramp[b + 1] / sqrt(a);
    }
}
