/* SPDX-License-Identifier: Apache-2.0 */
/* What holes take from cluster means, where samples are missing together.
 *
 * The mean of those n of m samples that are there has the variance of the mean of all plus
 *
 *     - 2 sum_k D_k g_k,   D_k = p_k/n^2 - (m - k)/m^2,
 *
 * with g_k = E (y_{i+k} - y_i)^2/2 and p_k the pairs at lag k of which both are there. Samples that
 * are missing one by one give D_k = -D_0 q_k, q_k = (m - k)/(m (m - 1)), and D_0 s^2 is the sum.
 * Else
 *
 *     D_0 s^2 [1 + 2 sum_k (D_k/D_0 + q_k) (1 - g_k/s^2)]
 *
 * where the bracket, averaged over clusters, is the factor computed here. White noise (g_k = s^2)
 * has factor 1 whatever is missing, quantization nearly 0. Lags are taken one by one to 8, then 8
 * to an octave, each standing for its neighbours; those whose g_k differs from s^2 by less than
 * four standard errors are left out, or many of them would add more scatter than the whole is worth
 * where the noise is white. */
#include "allan_gaps_internal.h"

#include <math.h>

/* A difference at a lag is taken at PLACES places in the time of the lag, at most: neighbours tell
 * little more of slow noise. */
enum { ONE_BY_ONE = 8, PLACES = 64 };

/* To the next lag. */
static size_t stride_of(size_t lag)
{
    return lag > ONE_BY_ONE ? lag / ONE_BY_ONE : 1;
}

void imki_gap_take_lags(imki_gap_record *r)
{
    for (size_t lag = 1; lag < r->n / 2 && r->lag_count < IMKI_GAP_LAGS; lag += stride_of(lag)) {
        double squares = 0;
        size_t count = 0;
        for (size_t i = 0; i + lag < r->n; i += lag / PLACES + 1) {
            const double first = r->sums[i + 1] - r->sums[i];
            const double d = r->sums[i + lag + 1] - r->sums[i + lag] - first;
            const bool both = r->holes[i] == 0 && r->holes[i + lag] == 0;
            squares += both ? d * d : 0;
            count += both;
        }
        r->lag[r->lag_count] = lag;
        r->variogram[r->lag_count] = count > 0 ? squares / 2 / (double)count : 0;
        r->pairs[r->lag_count++] = count;
    }
}

/* Mean over clusters, by their samples, of p_k/n^2; at every stride-th place. */
static double mean_pairs(const imki_gap_record *r, size_t m, size_t least, size_t lag)
{
    const size_t stride = stride_of(lag);
    double sum = 0, weight = 0;
    for (size_t from = 0; from + m <= r->n; from += m) {
        const size_t there = r->counts[from + m] - r->counts[from];
        if (there < least)
            continue;
        size_t pairs = 0, places = 0;
        for (size_t i = from; i + lag < from + m; i += stride, places++)
            pairs += r->holes[i] == 0 && r->holes[i + lag] == 0;
        if (places > 0)
            sum += (double)pairs / (double)places * (double)(m - lag) / (double)there;
        weight += (double)there;
    }
    return weight > 0 ? sum / weight : 0;
}

double imki_gap_hole_factor(const imki_gap_record *r, size_t m, size_t least, double inside,
                            double *error)
{
    const double length = (double)m;
    /* Lag 0: the mean of 1/n. */
    double clusters = 0, weight = 0, sum = 0, variance = 0;
    *error = 0;
    for (size_t from = 0; from + m <= r->n; from += m) {
        const size_t there = r->counts[from + m] - r->counts[from];
        clusters += there >= least;
        weight += there >= least ? (double)there : 0;
    }
    const double d0 = weight > 0 ? clusters / weight - 1 / length : 0;
    if (!(d0 > 0) || !(inside > 0))
        return 1;
    for (size_t l = 0; l < r->lag_count && r->lag[l] < m; l++) {
        const double lag = (double)r->lag[l], rest = length - lag;
        const double stands_for =
            0.5 * (double)(stride_of(r->lag[l]) + (l > 0 ? r->lag[l] - r->lag[l - 1] : 1));
        const double differs = 1 - r->variogram[l] / inside;
        /* Relative variance of g_k for white noise: (2 + 1)/pairs. */
        if (differs * differs * (double)r->pairs[l] < 16 * 3)
            continue;
        const double dk = mean_pairs(r, m, least, r->lag[l]) - rest / (length * length);
        const double share = stands_for * (dk / d0 + rest / (length * (length - 1)));
        sum += share * differs;
        variance += share * share * 3 / (double)r->pairs[l];
    }
    *error = 2 * sqrt(variance);
    return 1 + 2 * sum;
}
