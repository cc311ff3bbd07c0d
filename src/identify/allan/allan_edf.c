/* SPDX-License-Identifier: Apache-2.0 */
/* Equivalent degrees of freedom of the statistics whose terms are fixed differences of the sums.
 *
 * The variance is a mean of M squares z_j^2 of correlated Gaussian terms, so
 *
 *     edf = 2 E^2 / var = M r(0)^2 / sum_{|l| < M} (1 - |l|/M) r(l)^2,   r(l) = E z_j z_{j+l}
 *     r(l) = sum_k (-1)^k binomial(2d, d + k) R(l + k m)
 *
 * with d the order of the difference and R the generalised autocovariance of the sums. Greenhall
 * and Riley [GREENHALL2003] take R of the continuous process; for independent rate *samples* the
 * sums are a discrete random walk, R(l) = -|l|/2, which gives fewer degrees of freedom at small m
 * (666.2 against 782.0 for OADEV at m = 1, n = 1000). The modified variance's means of m sums are
 * one more difference of sums of sums, whose law is lower by 2. PDEV is a weighted sum of 2m sums.
 */
#include "allan_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Generalised autocovariance of the sums of a sampled process at lag l, up to terms that the
 * differences remove and up to a factor. White phase: independent sums. White rate: random walk.
 * Random-walk rate: the twice summed unit impulse; random run, four times. The flicker laws have no
 * finite sampled form; their continuous ones are used, with the limit of flicker phase at lag 0
 * that a band limit at Nyquist gives: R(0) - R(l) -> Cin(pi l). */
double imki_allan_autocovariance(int alpha, double lag)
{
    const double l = fabs(lag), euler_plus_log_pi = 0.57721566490153286 + 1.1447298858494002;
    switch (alpha) {
    case IMK_WHITE_PHASE:
        return l < 0.5 ? 1.0 : 0.0;
    case IMK_FLICKER_PHASE:
        return l < 0.5 ? 0.0 : -(euler_plus_log_pi + imk_ln(l));
    case IMK_WHITE_RATE:
        return -l;
    case IMK_FLICKER_RATE:
        return l < 0.5 ? 0.0 : l * l * imk_ln(l);
    case IMK_RANDOM_WALK_RATE:
        return l * l * l - l;
    case IMK_FLICKER_WALK_RATE:
        return l < 0.5 ? 0.0 : -l * l * l * l * imk_ln(l);
    case IMK_RANDOM_RUN_RATE:
        return -l * (l * l - 1) * (l * l - 4);
    }
    return (double)NAN;
}

/* Autocovariance of the sums of Greenhall's continuous process averaged over 1/F of a cluster, in
 * clusters: s_x(t, F) = F^2 (2 s_w(t) - s_w(t - 1/F) - s_w(t + 1/F)). */
static double continuous_kernel(int alpha, double t)
{
    const double a = fabs(t), square = a * a;
    switch (alpha) {
    case IMK_WHITE_PHASE:
        return -a;
    case IMK_FLICKER_PHASE:
        return a > 0 ? square * imk_ln(a) : 0;
    case IMK_WHITE_RATE:
        return square * a;
    case IMK_FLICKER_RATE:
        return a > 0 ? -square * square * imk_ln(a) : 0;
    case IMK_RANDOM_WALK_RATE:
        return -square * square * a;
    case IMK_FLICKER_WALK_RATE:
        return a > 0 ? square * square * square * imk_ln(a) : 0;
    case IMK_RANDOM_RUN_RATE:
        return square * square * square * a;
    }
    return (double)NAN;
}

static double continuous_autocovariance(int alpha, double t, double f)
{
    return f * f *
           (2 * continuous_kernel(alpha, t) - continuous_kernel(alpha, t - 1 / f) -
            continuous_kernel(alpha, t + 1 / f));
}

typedef struct edf_setting {
    int alpha;
    int order;       /* of the differences of R */
    double m;        /* samples in a cluster */
    bool continuous; /* Greenhall and Riley's process instead of the sampled one */
    double f;        /* how many means the continuous process has in a cluster */
} edf_setting;

static double autocovariance(const edf_setting *setting, double lag)
{
    return setting->continuous
               ? continuous_autocovariance(setting->alpha, lag / setting->m, setting->f)
               : imki_allan_autocovariance(setting->alpha, lag);
}

static double difference(const edf_setting *setting, double lag)
{
    static const double binomial[4][4] = {{1}, {2, -1}, {6, -4, 1}, {20, -15, 6, -1}};
    const double *b = binomial[setting->order], m = setting->m;
    double r = b[0] * autocovariance(setting, lag);
    for (int k = 1; k <= setting->order; k++)
        r += b[k] * (autocovariance(setting, lag - k * m) + autocovariance(setting, lag + k * m));
    return r;
}

/* Beyond CLUSTER_MAX the law no longer depends on m but through M/m: a shorter cluster with M in
 * proportion has the same edf to 1e-4, at a bounded cost. White phase noise in unmodified
 * differences is the exception: its terms are correlated at multiples of m only, whatever m. Terms
 * REACH clusters apart are independent for this purpose. */
enum { CLUSTER_MAX = 256, PARABOLIC_MAX = 32, REACH = 12 };

/* The sum over lags, `stride` apart; `unit` lags from one term to the next. */
static double sum_over_lags(const edf_setting *setting, double terms, double unit, double stride)
{
    const double r0 = difference(setting, 0);
    double sum = r0 * r0;
    for (double lag = stride; lag <= REACH * setting->m && lag / unit < terms; lag += stride) {
        const double r = difference(setting, lag);
        sum += 2 * (1 - lag / unit / terms) * r * r;
    }
    const double edf = terms * r0 * r0 / sum;
    return edf > 1 ? edf : 1;
}

/* PDEV: r(l) = sum_d c(d) R(l + d) with c the autocorrelation of the 2m weights. */
static double parabolic_edf(imk_power_law type, bool continuous, size_t n, size_t m)
{
    enum { WEIGHTS = 2 * PARABOLIC_MAX, LAGS = (REACH + 2) * PARABOLIC_MAX };
    const size_t cluster = m < PARABOLIC_MAX ? m : PARABOLIC_MAX, weights = 2 * cluster;
    const edf_setting setting = {(int)type, 0, (double)cluster, continuous, (double)cluster};
    const double terms = ((double)n - 2 * (double)m + 2) * (double)cluster / (double)m;
    double weight[WEIGHTS], c[WEIGHTS] = {0}, r[LAGS + 1];
    for (size_t k = 0; k < cluster; k++) {
        weight[k] = 0.5 * ((double)cluster - 1) - (double)k;
        weight[cluster + k] = -weight[k];
    }
    for (size_t d = 0; d < weights; d++)
        for (size_t k = 0; k + d < weights; k++)
            c[d] += weight[k] * weight[k + d];
    const size_t reach = REACH * cluster;
    for (size_t l = 0; l <= reach + weights; l++)
        r[l] = autocovariance(&setting, (double)l);
    double first = 0, sum = 0;
    for (size_t l = 0; l <= reach && (double)l < terms; l++) {
        double value = c[0] * r[l];
        for (size_t d = 1; d < weights; d++)
            value += c[d] * (r[l + d] + r[l > d ? l - d : d - l]);
        first = l == 0 ? value : first;
        sum += (l == 0 ? 1 : 2 * (1 - (double)l / terms)) * value * value;
    }
    const double edf = terms * first * first / sum;
    return edf > 1 ? edf : 1;
}

double imki_allan_edf(imk_allan_statistic statistic, imk_power_law type, bool continuous, size_t n,
                      size_t m)
{
    const bool plain = statistic == IMK_ALLAN_PLAIN || statistic == IMK_ALLAN_HADAMARD_PLAIN;
    const bool modified = statistic == IMK_ALLAN_MODIFIED || statistic == IMK_ALLAN_TIME;
    const bool hadamard = statistic == IMK_ALLAN_HADAMARD || statistic == IMK_ALLAN_HADAMARD_PLAIN;
    if (statistic == IMK_ALLAN_PARABOLIC && m > 1)
        return parabolic_edf(type, continuous, n, m);
    double cluster = (double)m;
    const int order = hadamard ? 3 : 2;
    double terms = plain      ? (double)(n / m) - order + 1
                   : modified ? (double)n - 3 * cluster + 2
                              : (double)n - order * cluster + 1;
    /* Lag of neighbouring terms, and of the lags at which terms are correlated at all. */
    const bool every_lag = !plain && (modified || type != IMK_WHITE_PHASE);
    if (every_lag && m > CLUSTER_MAX) {
        terms *= CLUSTER_MAX / cluster;
        cluster = CLUSTER_MAX;
    }
    edf_setting setting = {(int)type, order, cluster, continuous, modified ? 1 : cluster};
    if (modified && !continuous) {
        setting.alpha -= 2;
        setting.order++;
    }
    return sum_over_lags(&setting, terms, plain ? cluster : 1, every_lag ? 1 : cluster);
}
