/* SPDX-License-Identifier: Apache-2.0 */
/* How far to trust an Allan deviation: noise type, equivalent degrees of freedom, interval.
 *
 * The variance is a mean of M squares z_j^2 of correlated Gaussian second differences, so
 *
 *     edf = 2 E^2 / var = M r(0)^2 / sum_{|l| < M} (1 - |l|/M) r(l)^2,   r(l) = E z_j z_{j+l}
 *     r(l) = 6 R(l) - 4 R(l-m) - 4 R(l+m) + R(l-2m) + R(l+2m)
 *
 * with R the generalised autocovariance of the sums. Greenhall and Riley [GREENHALL2003] take R of
 * the continuous process; for independent rate *samples* the sums are a discrete random walk, R(l)
 * =
 * -|l|/2, which gives fewer degrees of freedom at small m (666.2 against 782.0 at m = 1, n = 1000).
 */
#include "imukit/allan.h"
#include "imukit/distributions.h"

#include <math.h>

/* Generalised autocovariance of the sums of a sampled process at lag l, up to terms that second
 * differences remove and up to a factor. White phase: independent sums. White rate: random walk.
 * Random-walk rate: the twice summed unit impulse. The two flicker laws have no finite sampled
 * form; their continuous ones are used, with the limit of flicker phase at lag 0 that a band limit
 * at Nyquist gives: R(0) - R(l) -> Cin(pi l). */
static double sampled_autocovariance(imk_power_law type, double lag)
{
    const double l = fabs(lag), euler_plus_log_pi = 0.57721566490153286 + 1.1447298858494002;
    switch (type) {
    case IMK_WHITE_PHASE:
        return l < 0.5 ? 1.0 : 0.0;
    case IMK_FLICKER_PHASE:
        return l < 0.5 ? 0.0 : -(euler_plus_log_pi + log(l));
    case IMK_WHITE_RATE:
        return -l;
    case IMK_FLICKER_RATE:
        return l < 0.5 ? 0.0 : l * l * log(l);
    case IMK_RANDOM_WALK_RATE:
        return l * l * l - l;
    }
    return 0;
}

/* Autocovariance of the sums of Greenhall's continuous process averaged over 1/F of a cluster, in
 * clusters: s_x(t, F) = F^2 (2 s_w(t) - s_w(t - 1/F) - s_w(t + 1/F)). */
static double continuous_kernel(imk_power_law type, double t)
{
    const double a = fabs(t);
    switch (type) {
    case IMK_WHITE_PHASE:
        return -a;
    case IMK_FLICKER_PHASE:
        return a > 0 ? a * a * log(a) : 0;
    case IMK_WHITE_RATE:
        return a * a * a;
    case IMK_FLICKER_RATE:
        return a > 0 ? -a * a * a * a * log(a) : 0;
    case IMK_RANDOM_WALK_RATE:
        return -a * a * a * a * a;
    }
    return 0;
}

static double continuous_autocovariance(imk_power_law type, double t, double f)
{
    return f * f *
           (2 * continuous_kernel(type, t) - continuous_kernel(type, t - 1 / f) -
            continuous_kernel(type, t + 1 / f));
}

typedef struct edf_setting {
    imk_power_law type;
    double m;        /* samples in a cluster */
    bool continuous; /* Greenhall and Riley's process instead of the sampled one */
} edf_setting;

static double autocovariance(const edf_setting *setting, double lag)
{
    return setting->continuous
               ? continuous_autocovariance(setting->type, lag / setting->m, setting->m)
               : sampled_autocovariance(setting->type, lag);
}

static double second_difference(const edf_setting *setting, double lag)
{
    const double m = setting->m;
    return 6 * autocovariance(setting, lag) -
           4 * (autocovariance(setting, lag - m) + autocovariance(setting, lag + m)) +
           autocovariance(setting, lag - 2 * m) + autocovariance(setting, lag + 2 * m);
}

/* Beyond this cluster length the law no longer depends on m but through M/m: a shorter cluster with
 * M in proportion has the same edf to 1e-4, at a bounded cost. White phase noise is the exception:
 * its second differences are correlated at lags 0, m, 2m only, whatever m. */
enum { CLUSTER_MAX = 256, REACH = 12 };

static double degrees_of_freedom(imk_allan_statistic statistic, imk_power_law type, bool continuous,
                                 size_t n, size_t m)
{
    const bool plain = statistic == IMK_ALLAN_PLAIN;
    double cluster = (double)m;
    double terms = plain ? (double)(n / m) - 1 : (double)n - 2 * cluster + 1;
    if (!(terms >= 1))
        return NAN;
    /* Lag of neighbouring terms, and of the lags at which terms are correlated at all. */
    const bool every_lag = !plain && type != IMK_WHITE_PHASE;
    if (every_lag && m > CLUSTER_MAX) {
        terms *= CLUSTER_MAX / cluster;
        cluster = CLUSTER_MAX;
    }
    const double unit = plain ? cluster : 1, stride = every_lag ? 1 : cluster;
    const edf_setting setting = {type, cluster, continuous};
    const double r0 = second_difference(&setting, 0);
    double sum = r0 * r0;
    for (double lag = stride; lag <= REACH * cluster && lag / unit < terms; lag += stride) {
        const double r = second_difference(&setting, lag);
        sum += 2 * (1 - lag / unit / terms) * r * r;
    }
    const double edf = terms * r0 * r0 / sum;
    return edf > 1 ? edf : 1;
}

double imk_allan_edf_greenhall_riley(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                     size_t m)
{
    return degrees_of_freedom(statistic, type, true, n, m);
}

double imk_allan_edf_exact(imk_allan_statistic statistic, imk_power_law type, size_t n, size_t m)
{
    return degrees_of_freedom(statistic, type, false, n, m);
}

void imk_allan_interval(double deviation, double edf, double confidence, double *lower,
                        double *upper)
{
    const double tail = (1 - confidence) / 2;
    *lower = deviation * sqrt(edf / imk_chi_square_quantile(1 - tail, edf));
    *upper = deviation * sqrt(edf / imk_chi_square_quantile(tail, edf));
}

/* Lag-1 autocorrelation of the d-th differences of cluster means y_i = s[(i+1)m] - s[im]. */
static double lag_one(size_t clusters, const double *sums, size_t m, int d)
{
    static const double binomial[3][3] = {{1, 0, 0}, {1, -1, 0}, {1, -2, 1}};
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

/* [RILEY2004]: difference the cluster means until their lag-1 autocorrelation r is that of a
 * stationary fractional noise, delta = r/(1 + r) < 1/4; then alpha = -2 (delta + d). */
imk_status imk_allan_noise_type(size_t n, const double *sums, size_t m, imk_power_law *type)
{
    const size_t clusters = m > 0 ? n / m : 0;
    if (clusters < 30)
        return IMK_ERROR_TOO_SHORT;
    double delta = 0;
    int d = 0;
    for (;; d++) {
        const double r = lag_one(clusters, sums, m, d);
        delta = r / (1 + r);
        if (delta < 0.25 || d == 2)
            break;
    }
    const double alpha = floor(-2 * (delta + d) + 0.5);
    *type = (imk_power_law)(alpha > 2 ? 2 : alpha < -2 ? -2 : alpha);
    return IMK_OK;
}

typedef struct point_work {
    const imk_allan_settings *settings;
    size_t n;
    const double *sums;
    const size_t *factors;
    imk_allan_point *points;
} point_work;

/* edf = 0 marks a type that could not be told. */
static void point_item(void *context, size_t item)
{
    const point_work *w = context;
    imk_allan_point *p = &w->points[item];
    double variance = 0;
    p->m = w->factors[item];
    imk_allan_variances(w->settings->statistic, w->n, w->sums, 1, &p->m, &variance, &p->count,
                        NULL);
    p->deviation = sqrt(variance);
    p->edf = imk_allan_noise_type(w->n, w->sums, p->m, &p->type) == IMK_OK;
}

imk_status imk_allan_points(const imk_allan_settings *settings, size_t n, const double *sums,
                            size_t factor_count, const size_t *factors, imk_allan_point *points,
                            const imk_executor *executor)
{
    if (settings->cookie != imk_allan_default().cookie)
        return IMK_ERROR_UNINITIALISED;
    if (!(settings->confidence > 0 && settings->confidence < 1))
        return IMK_ERROR_RANGE;
    for (size_t i = 0; i < factor_count; i++)
        if (factors[i] < 1 || factors[i] > n / 2)
            return n < 2 ? IMK_ERROR_TOO_SHORT : IMK_ERROR_RANGE;
    point_work work = {settings, n, sums, factors, points};
    imk_execute(executor, factor_count, point_item, &work);

    imk_power_law type = IMK_WHITE_RATE;
    for (size_t i = 0; i < factor_count; i++) {
        imk_allan_point *p = &points[i];
        type = p->edf > 0 ? p->type : type;
        p->type = type;
        p->edf = settings->greenhall_riley
                     ? imk_allan_edf_greenhall_riley(settings->statistic, type, n, p->m)
                     : imk_allan_edf_exact(settings->statistic, type, n, p->m);
        imk_allan_interval(p->deviation, p->edf, settings->confidence, &p->lower, &p->upper);
    }
    return IMK_OK;
}

imk_allan_settings imk_allan_default(void)
{
    return (imk_allan_settings){.cookie = 0xA11A0001u, .confidence = 0.95};
}
