/* SPDX-License-Identifier: Apache-2.0 */
/* Published fits to the degrees of freedom and biases of the total family and Theo1, n/m being
 * the record's length in averaging times.
 *
 *     TOTDEV  b n/m - c                 MTOT  b n/m - c                HTOT  n/m / (b0 + b1 m/n)
 *
 * [RILEY2008, 5.4.4 to 5.4.6, 5.12 to 5.14]; Theo1 [HOWE2003], [RILEY2008, 5.4.7, 5.15]. Where a
 * fit does not hold (TOTDEV with phase noise, MTOT below m = 8, HTOT below m = 16) the reflections
 * add next to nothing, and the degrees of freedom are those of the statistic it stands for. */
#include "allan_internal.h"
#include "imukit/elementary.h"

#include <math.h>

/* Rows: alpha = 2, 1, 0, -1, -2, -3, -4. A 0 is no value. */
enum { TYPES = 7 };

static size_t row_of(imk_power_law type)
{
    const int row = IMK_WHITE_PHASE - (int)type;
    return row < 0 ? 0 : row >= TYPES ? TYPES - 1 : (size_t)row;
}

static double total_edf(size_t row, double ratio)
{
    static const double b[TYPES] = {0, 0, 1.50, 1.17, 0.93}, c[TYPES] = {0, 0, 0, 0.22, 0.36};
    return b[row] > 0 ? b[row] * ratio - c[row] : (double)NAN;
}

static double modified_total_edf(size_t row, double ratio, size_t m)
{
    static const double b[TYPES] = {1.90, 1.20, 1.10, 0.85, 0.75};
    static const double c[TYPES] = {2.10, 1.40, 1.20, 0.50, 0.31};
    return b[row] > 0 && m >= 8 ? b[row] * ratio - c[row] : (double)NAN;
}

static double hadamard_total_edf(size_t row, double ratio, size_t m)
{
    static const double b0[TYPES] = {0, 0, 0.559, 0.868, 0.938, 0.974, 1.276};
    static const double b1[TYPES] = {0, 0, 1.004, 1.140, 1.696, 2.554, 3.149};
    return b0[row] > 0 && m >= 16 ? ratio / (b0[row] + b1[row] / ratio) : (double)NAN;
}

/* points: values of the phase; t: averaging time in samples. */
static double theo_edf(size_t row, double points, double t)
{
    const double p = points;
    switch (row) {
    case 0:
        return 0.86 * (p + 1) * (p - 4 * t / 3) / (p - t) * (t / (t + 1.14));
    case 1:
        return (4.798 * p * p - 6.374 * p * t + 12.387 * t) / (sqrt(t + 36.6) * (p - t)) *
               (t / (t + 0.3));
    case 2:
        return ((4.1 * p + 0.8) / t - (3.1 * p + 6.5) / p) * (t * sqrt(t) / (t * sqrt(t) + 5.2));
    case 3:
        return (2 * p * p - 1.3 * p * t - 3.5 * t) / (p * t) * (t * t * t / (t * t * t + 2.3));
    default: {
        const double q = 4.4 * p - 1;
        return (q - 1) / (2.9 * t) * (q * q - 8.6 * t * q + 11.4 * t * t) / ((q - 2) * (q - 2));
    }
    }
}

double imki_allan_edf_published(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                size_t m)
{
    const size_t row = row_of(type);
    const double ratio = (double)n / (double)m;
    double edf = (double)NAN;
    imk_allan_statistic instead = IMK_ALLAN_OVERLAPPING;
    if (statistic == IMK_ALLAN_TOTAL) {
        edf = total_edf(row, ratio);
    } else if (statistic == IMK_ALLAN_MODIFIED_TOTAL) {
        edf = modified_total_edf(row, ratio, m);
        instead = IMK_ALLAN_MODIFIED;
    } else if (statistic == IMK_ALLAN_HADAMARD_TOTAL) {
        edf = hadamard_total_edf(row, ratio, m);
        instead = IMK_ALLAN_HADAMARD;
    } else {
        edf = theo_edf(row, (double)n + 1, 0.75 * (double)m);
    }
    if (isnan(edf))
        edf = imki_allan_edf(instead, type, true, n, m);
    return edf > 1 ? edf : 1;
}

double imk_allan_bias_published(imk_allan_statistic statistic, imk_power_law type, size_t n,
                                size_t m)
{
    static const double total[TYPES] = {0, 0, 0, 0.481, 0.750, 0.750, 0.750};
    static const double modified[TYPES] = {0.94, 0.83, 0.73, 0.70, 0.69, 0.69, 0.69};
    static const double hadamard[TYPES] = {1, 1, 0.995, 0.851, 0.771, 0.717, 0.679};
    static const double a[TYPES] = {0.09, 0.14, 1.00, 1.87, 2.70, 2.70, 2.70};
    static const double b[TYPES] = {0.74, 0.82, 0, -1.05, -1.53, -1.53, -1.53};
    static const double c[TYPES] = {0.40, 0.30, 0, 0.79, 0.85, 0.85, 0.85};
    const size_t row = row_of(type);
    switch (statistic) {
    case IMK_ALLAN_TOTAL:
        return 1 - total[row] * (double)m / (double)n;
    case IMK_ALLAN_MODIFIED_TOTAL:
        return modified[row];
    case IMK_ALLAN_HADAMARD_TOTAL:
        return hadamard[row];
    case IMK_ALLAN_THEO1:
        return 1 / (a[row] + b[row] / imk_exp(c[row] * imk_ln((double)m)));
    default:
        return 1;
    }
}
