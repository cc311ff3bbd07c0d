/* SPDX-License-Identifier: Apache-2.0 */
/* Degrees of freedom and biases of TOTDEV, MTOT, HTOT and Theo1.
 *
 * Each is a quadratic form s'As of the sums, so that with R the autocovariance of sampled noise
 *
 *     E = tr(A R),   edf = tr(A R)^2 / tr(A R A R)
 *
 * exactly. The tables are that, evaluated with matrices (m = 10 and 20, Theo1 m = 40 and 100), as
 * the gain over the statistic it stands for, whose degrees of freedom are known for every m; for
 * Theo1, which goes where OADEV does not, as degrees of freedom a record's length in m. They depend
 * on n/m and, from white rate noise down, hardly on m. MTOT of noise alpha is HTOT of noise alpha -
 * 2 with sums for rates. */
#include "allan_internal.h"

#include <math.h>

enum { PLACES = 10, TYPES = 7, THEO_PLACES = 8, THEO_TYPES = 3 };

/* m/n at the places of each table; the last is the limit of a long record. */
static const double hadamard_at[PLACES] = {1 / 3.0, 1 / 3.5,  1 / 4.0,  1 / 5.0,  1 / 6.0,
                                           1 / 8.0, 1 / 12.0, 1 / 20.0, 1 / 32.0, 0};
static const double total_at[PLACES] = {1 / 2.0, 1 / 2.5, 1 / 3.0,  1 / 4.0,  1 / 5.0,
                                        1 / 6.0, 1 / 8.0, 1 / 12.0, 1 / 20.0, 0};
static const double theo_at[THEO_PLACES] = {1,       1 / 1.25, 1 / 1.5, 1 / 2.0,
                                            1 / 3.0, 1 / 5.0,  1 / 9.0, 0};

/* HTOT over OHDEV; rows alpha = 2 … -4. */
static const double hadamard_gain[TYPES][PLACES] = {
    {14.94, 4.013, 2.565, 2.363, 2.152, 1.959, 1.864, 1.816, 1.80, 1.78},
    {7.356, 3.112, 2.186, 2.054, 1.924, 1.821, 1.766, 1.739, 1.72, 1.71},
    {3.398, 2.303, 1.741, 1.621, 1.539, 1.484, 1.453, 1.437, 1.430, 1.42},
    {2.447, 1.941, 1.487, 1.361, 1.301, 1.263, 1.241, 1.230, 1.225, 1.22},
    {2.059, 1.747, 1.394, 1.247, 1.201, 1.170, 1.153, 1.143, 1.139, 1.132},
    {1.676, 1.523, 1.316, 1.173, 1.137, 1.112, 1.098, 1.090, 1.086, 1.083},
    {1.317, 1.270, 1.197, 1.116, 1.092, 1.075, 1.065, 1.059, 1.057, 1.054}};

/* TOTDEV over OADEV; rows alpha = 1 … -2. */
static const double total_gain[TYPES - 3][PLACES] = {
    {4.553, 1.670, 1.180, 1.120, 1.080, 1.060, 1.030, 1.010, 1.00, 1.00},
    {2.963, 2.029, 1.596, 1.455, 1.355, 1.286, 1.205, 1.130, 1.075, 1.00},
    {2.096, 2.031, 1.701, 1.442, 1.332, 1.265, 1.187, 1.118, 1.067, 1.00},
    {1.523, 1.697, 1.632, 1.428, 1.313, 1.245, 1.170, 1.106, 1.060, 1.00}};

/* Theo1: edf m/n; rows alpha = 0 … -2. */
static const double theo_share[THEO_TYPES][THEO_PLACES] = {
    {1.94, 2.80, 3.64, 4.10, 4.45, 4.75, 5.04, 5.41},
    {1.21, 1.21, 1.42, 1.72, 1.955, 2.176, 2.327, 2.516},
    {1.05, 0.92, 0.94, 1.08, 1.277, 1.456, 1.572, 1.717}};

/* Between the places of a table, which descend. */
static double between(size_t places, const double *at, const double *value, double x)
{
    size_t i = 1;
    while (i + 1 < places && x < at[i])
        i++;
    const double share = (at[i - 1] - x) / (at[i - 1] - at[i]);
    return value[i - 1] + (share < 0 ? 0 : share) * (value[i] - value[i - 1]);
}

/* TOTDEV with independent sums of variance 1: n - 2m + 1 terms inside (6 each) and 2 (m - 1) at the
 * ends (10 each), which share 2 s[0] and 2 s[n]: 4m s[0]^2 alone has 32 m^2 for its variance. The
 * products that end terms share otherwise are 215 a term (fitted to the exact form, m = 4 to 30).
 */
static double total_edf_white_phase(double n, double m)
{
    const double inside = n - 2 * m + 1, mean = 6 * inside + 20 * (m - 1);
    return mean * mean / (70 * inside + 32 * (m - 1) * (m - 1) + 215 * (m - 1));
}

/* Theo1 of few samples has less: the factor of the published fit [HOWE2003]. */
static double theo_short(int row, size_t m)
{
    const double t = 0.75 * (double)m, power = t * sqrt(t);
    return row == 2 ? power / (power + 5.2) : 1;
}

double imki_allan_edf_total(imk_allan_statistic statistic, imk_power_law type, size_t n, size_t m)
{
    const int row = IMK_WHITE_PHASE - (int)type;
    const double x = (double)m / (double)n;
    double edf;
    if (statistic == IMK_ALLAN_THEO1) {
        edf = row < 2
                  ? imki_allan_edf_published(statistic, type, n, m)
                  : between(THEO_PLACES, theo_at, theo_share[row - 2], x) / x * theo_short(row, m);
    } else if (statistic == IMK_ALLAN_TOTAL && row == 0) {
        edf = total_edf_white_phase((double)n, (double)m);
    } else if (statistic == IMK_ALLAN_TOTAL) {
        edf = imki_allan_edf(IMK_ALLAN_OVERLAPPING, type, false, n, m) *
              (m > 1 ? between(PLACES, total_at, total_gain[row - 1], x) : 1);
    } else {
        const bool modified = statistic == IMK_ALLAN_MODIFIED_TOTAL;
        const double length = modified ? (double)m / (double)(n + 1) : x;
        const double *gain = hadamard_gain[modified ? row + 2 : row];
        edf =
            imki_allan_edf(modified ? IMK_ALLAN_MODIFIED : IMK_ALLAN_HADAMARD, type, false, n, m) *
            (m > 1 ? between(PLACES, hadamard_at, gain, length) : 1);
    }
    return edf > 1 ? edf : 1;
}

/* Expected square of the sum of coefficient[i] s[at[i]]. */
static double expected_square(int alpha, int count, const double *coefficient, const double *at)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        for (int j = 0; j < count; j++)
            sum +=
                coefficient[i] * coefficient[j] * imki_allan_autocovariance(alpha, at[i] - at[j]);
    return sum;
}

static double allan_expectation(int alpha, double m)
{
    const double coefficient[] = {1, -2, 1}, at[] = {0, m, 2 * m};
    return expected_square(alpha, 3, coefficient, at) / (2 * m * m);
}

/* Beyond this the ratio depends on n/m only. */
enum { FACTOR_MAX = 4096 };

static double total_bias(int alpha, double n, double m)
{
    if (m > FACTOR_MAX) {
        n *= FACTOR_MAX / m;
        m = FACTOR_MAX;
    }
    const double coefficient[] = {1, -2, -1, 2};
    double ends = 0;
    for (double i = 1; i < m; i++) {
        const double at[] = {i + m, i, m - i, 0};
        ends += 2 * expected_square(alpha, 4, coefficient, at);
    }
    const double inside = allan_expectation(alpha, m) * 2 * m * m;
    return (1 + n - 2 * m + ends / inside) / (n - 1);
}

static double theo_bias(int alpha, double m)
{
    m = m > FACTOR_MAX ? FACTOR_MAX : m;
    const double coefficient[] = {1, -1, 1, -1};
    double sum = 0;
    for (double k = 1; k <= m / 2; k++) {
        const double at[] = {0, k, m, m - k};
        sum += expected_square(alpha, 4, coefficient, at) / k;
    }
    return sum / (0.75 * m * m) / allan_expectation(alpha, 0.75 * m);
}

double imk_allan_bias(imk_allan_statistic statistic, imk_power_law type, size_t n, size_t m)
{
    /* HTOT for alpha = 2 … -4 at m = 12 (1.36 is 1.35 at m = 8, 1.38 at 100), MTOT two rows down.
     */
    static const double stretches[TYPES] = {1.36, 1.197, 0.995, 0.851, 0.772, 0.717, 0.679};
    size_t lowest, highest, step;
    imk_allan_range(statistic, n, &lowest, &highest, &step);
    if (m < lowest || m > highest || (int)type > IMK_WHITE_PHASE)
        return (double)NAN;
    const int least = imki_allan_lowest_type(statistic);
    const int alpha = (int)type < least ? least : (int)type, row = IMK_WHITE_PHASE - alpha;
    switch (statistic) {
    case IMK_ALLAN_TOTAL:
        return total_bias(alpha, (double)n, (double)m);
    case IMK_ALLAN_THEO1:
        return theo_bias(alpha, (double)m);
    case IMK_ALLAN_MODIFIED_TOTAL: /* at m = 1 half of MDEV whatever the noise */
        return m == 1 ? 0.5 : stretches[row + 2];
    case IMK_ALLAN_HADAMARD_TOTAL:
        return m == 1 ? 0.5 : stretches[row];
    default:
        return 1;
    }
}
