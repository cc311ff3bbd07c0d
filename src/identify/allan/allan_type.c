/* SPDX-License-Identifier: Apache-2.0 */
/* Which noise a record shows at an averaging factor. */
#include "allan_internal.h"

#include <math.h>

/* Lag-1 autocorrelation of the d-th differences of cluster means y_i = s[(i+1)m] - s[im]. */
static double lag_one(size_t clusters, const double *sums, size_t m, int d)
{
    static const double binomial[4][4] = {{1}, {1, -1}, {1, -2, 1}, {1, -3, 3, -1}};
    const size_t count = clusters - (size_t)d;
    double mean = 0, product = 0, square = 0, previous = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < count; i++) {
            double z = 0;
            for (size_t j = 0; j <= (size_t)d; j++)
                z += binomial[d][j] *
                     (sums[(i + (size_t)d - j + 1) * m] - sums[(i + (size_t)d - j) * m]);
            if (pass == 0) {
                mean += z / (double)count;
            } else {
                z -= mean;
                square += z * z;
                product += i > 0 ? z * previous : 0;
                previous = z;
            }
        }
    return square > 0 ? product / square : 0;
}

/* Lag-1 autocorrelation that d-th differences of cluster means have under a power law: those of the
 * sums' (d + 1)-th differences m apart. */
static double lag_one_of(imk_power_law type, int d, size_t m)
{
    static const double binomial[4][4] = {{2, -1}, {6, -4, 1}, {20, -15, 6, -1}};
    const int order = d + 1, alpha = (int)type;
    const double *b = binomial[d], step = (double)m;
    double zero = b[0] * imki_allan_autocovariance(alpha, 0);
    double one = b[0] * imki_allan_autocovariance(alpha, step);
    for (int k = 1; k <= order; k++) {
        zero += 2 * b[k] * imki_allan_autocovariance(alpha, k * step);
        one += b[k] * (imki_allan_autocovariance(alpha, (k - 1) * step) +
                       imki_allan_autocovariance(alpha, (k + 1) * step));
    }
    return one / zero;
}

/* The law from white phase noise to the lowest whose d-th differences are stationary, and no lower
 * than `lowest`, with the autocorrelation next to r. */
imk_power_law imki_allan_nearest_type(double r, int d, size_t m, imk_power_law lowest)
{
    const int end = (int)lowest > -2 * d ? (int)lowest : -2 * d;
    int best = IMK_WHITE_PHASE;
    double distance = HUGE_VAL;
    for (int alpha = IMK_WHITE_PHASE; alpha >= end; alpha--) {
        const double off = fabs(r - lag_one_of((imk_power_law)alpha, d, m));
        if (off < distance) {
            distance = off;
            best = alpha;
        }
    }
    return (imk_power_law)best;
}

/* As [RILEY2004], difference the cluster means until their lag-1 autocorrelation r is that of a
 * stationary fractional noise, r/(1 + r) < 1/4. Its relation alpha = -2 (r/(1 + r) + d) is for
 * fractional noise, and means of flicker noise, r = -0.22 at d = 1, lie at its limit to random
 * walk; so r is compared with that of means under each law. */
static imk_status noise_type(size_t n, const double *sums, size_t m, imk_power_law lowest,
                             imk_power_law *type)
{
    const size_t clusters = m > 0 ? n / m : 0;
    const int most = lowest < IMK_RANDOM_WALK_RATE ? 2 : 1;
    if (clusters < IMKI_ALLAN_CLUSTERS_MIN)
        return IMK_ERROR_TOO_SHORT;
    double r = 0;
    int d = 0;
    for (;; d++) {
        r = lag_one(clusters, sums, m, d);
        if (r / (1 + r) < 0.25 || d == most)
            break;
    }
    if (isnan(r))
        return IMK_ERROR_NOT_FINITE;
    *type = imki_allan_nearest_type(r, d, m, lowest);
    return IMK_OK;
}

imk_status imk_allan_noise_type(size_t n, const double *sums, size_t m, imk_power_law *type)
{
    return noise_type(n, sums, m, IMK_RANDOM_WALK_RATE, type);
}

imk_status imk_allan_noise_type_for(imk_allan_statistic statistic, size_t n, const double *sums,
                                    size_t m, imk_power_law *type)
{
    return noise_type(n, sums, m, imki_allan_lowest_type(statistic), type);
}

/* Clusters of white noise, m of them from the end of a record, have a lag-1 autocorrelation that
 * scatters by 1/sqrt(clusters), and phase noise begins at -0.25: with 30 clusters it would be found
 * in one record in ten, and gives the point many times its degrees of freedom. Phase noise falls
 * faster with the averaging time than noise of the rate does, so it does not come back; and where
 * clusters are few, only redder types are believed, which have fewer degrees of freedom. */
imk_power_law imki_allan_type_at(size_t clusters, imk_power_law found, const imk_power_law *before)
{
    enum { FEW = 100 };
    if (clusters < IMKI_ALLAN_CLUSTERS_MIN)
        return before ? *before : IMK_WHITE_RATE;
    if (!before)
        return found;
    const imk_power_law bluest =
        clusters < FEW || *before > IMK_WHITE_RATE ? *before : IMK_WHITE_RATE;
    return found < bluest ? found : bluest;
}
