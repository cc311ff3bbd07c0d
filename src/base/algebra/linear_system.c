/* SPDX-License-Identifier: Apache-2.0 */
/* The exponential of a small matrix by balancing, scaling and squaring, and the covariance of a
 * step by the same doubling:
 *
 *     e^{2 A h} = (e^{A h})^2,   Q(2h) = Q(h) + phi(h) Q(h) phi(h)^T
 *
 * Both begin with a Taylor series at |A h| <= 1/4, whose terms fall below 1e-18 of the first after
 * 14 terms. Every term of Q is a covariance, so nothing cancels [VANLOAN1978]. */
#include "linear_system_internal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { N = IMKI_SYSTEM_MAX, TAYLOR_TERMS = 14, BALANCE_SWEEPS = 40 };

static void multiply(int n, const double *a, const double *b, double *product)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0.0;
            for (int k = 0; k < n; k++)
                sum += a[i * n + k] * b[k * n + j];
            product[i * n + j] = sum;
        }
}

static void add(int n, const double *a, double *sum)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            sum[i * n + j] += a[i * n + j];
}

/* Powers of two d that make the off-diagonal row and column sums of D^-1 A D alike, so that the
 * norm tells how fast the system is whatever the units of its states are [OSBORNE1960]. */
static void balance(int n, double *a, double *d)
{
    for (int i = 0; i < n; i++)
        d[i] = 1.0;
    bool changed = true;
    for (int sweep = 0; changed && sweep < BALANCE_SWEEPS; sweep++) {
        changed = false;
        for (int i = 0; i < n; i++) {
            double row = 0.0, column = 0.0, factor = 1.0;
            for (int j = 0; j < n; j++)
                if (j != i) {
                    row += fabs(a[i * n + j]);
                    column += fabs(a[j * n + i]);
                }
            if (!(row > 0.0 && column > 0.0))
                continue;
            while (column * factor * factor < row / 2.0)
                factor *= 2.0;
            while (column * factor * factor > row * 2.0)
                factor /= 2.0;
            if (factor == 1.0)
                continue;
            changed = true;
            d[i] *= factor;
            for (int j = 0; j < n; j++) {
                a[j * n + i] *= factor;
                a[i * n + j] /= factor;
            }
        }
    }
}

static double norm(int n, const double *a)
{
    double largest = 0.0;
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = 0; j < n; j++)
            sum += fabs(a[i * n + j]);
        largest = sum > largest ? sum : largest;
    }
    return largest;
}

/* Halvings that bring |A h| to at most 1/4; 0 also for what is not finite. */
static int halvings(int n, const double *a, double h)
{
    double size = norm(n, a) * fabs(h);
    int count = 0;
    while (size > 0.25 && size < 1e300 && count < 1000) {
        size /= 2.0;
        count++;
    }
    return count;
}

static double power_of_half(int count)
{
    double power = 1.0;
    for (int i = 0; i < count; i++)
        power /= 2.0;
    return power;
}

/* e^{A h} for |A h| <= 1/4. */
static void series(int n, const double *a, double h, double *phi)
{
    double term[N * N], next[N * N];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            phi[i * n + j] = term[i * n + j] = i == j ? 1.0 : 0.0;
    for (int k = 1; k <= TAYLOR_TERMS; k++) {
        multiply(n, term, a, next);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                term[i * n + j] = next[i * n + j] * (h / k);
                phi[i * n + j] += term[i * n + j];
            }
    }
}

void imki_exponential(int n, const double *a, double h, double *phi)
{
    double scaled[N * N], square[N * N], d[N];
    memcpy(scaled, a, (size_t)(n * n) * sizeof *a);
    balance(n, scaled, d);
    const int count = halvings(n, scaled, h);
    series(n, scaled, h * power_of_half(count), phi);
    for (int i = 0; i < count; i++) {
        multiply(n, phi, phi, square);
        memcpy(phi, square, (size_t)(n * n) * sizeof *phi);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            phi[i * n + j] *= d[i] / d[j];
}

void imki_discretise(int n, int m, const double *a, const double *b, double h, double *phi,
                     double *gamma)
{
    double whole[N * N], exponential[N * N];
    const int size = n + m;
    for (int i = 0; i < size; i++)
        for (int j = 0; j < size; j++)
            whole[i * size + j] = i >= n ? 0.0 : j < n ? a[i * n + j] : b[i * m + j - n];
    imki_exponential(size, whole, h, exponential);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            phi[i * n + j] = exponential[i * size + j];
        for (int j = 0; j < m; j++)
            gamma[i * m + j] = exponential[i * size + n + j];
    }
}

/* Q(h) for |A h| <= 1/4 from Q' = W + A Q + Q A^T: the k-th derivative at 0 is that of the one
 * before, put through A . + . A^T. */
static void covariance_series(int n, const double *a, const double *w, double h, double *q)
{
    double term[N * N], next[N * N];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            q[i * n + j] = term[i * n + j] = w[i * n + j] * h;
    for (int k = 2; k <= TAYLOR_TERMS; k++) {
        multiply(n, a, term, next);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                term[i * n + j] = (next[i * n + j] + next[j * n + i]) * (h / k);
        add(n, term, q);
    }
}

void imki_step_covariance(int n, const double *a, const double *w, double h, double *q)
{
    double scaled[N * N], phi[N * N], half[N * N], whole[N * N], density[N * N], d[N];
    memcpy(scaled, a, (size_t)(n * n) * sizeof *a);
    balance(n, scaled, d);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            density[i * n + j] = w[i * n + j] / (d[i] * d[j]);
    const int count = halvings(n, scaled, h);
    const double first = h * power_of_half(count);
    series(n, scaled, first, phi);
    covariance_series(n, scaled, density, first, q);
    for (int c = 0; c < count; c++) {
        multiply(n, phi, q, half);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double sum = 0.0;
                for (int k = 0; k < n; k++)
                    sum += half[i * n + k] * phi[j * n + k];
                whole[i * n + j] = sum;
            }
        add(n, whole, q);
        multiply(n, phi, phi, whole);
        memcpy(phi, whole, (size_t)(n * n) * sizeof *phi);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            q[i * n + j] *= d[i] * d[j];
}

void imki_covariance_root(int n, const double *q, double *root)
{
    for (int j = 0; j < n; j++) {
        double pivot = q[j * n + j];
        for (int k = 0; k < j; k++)
            pivot -= root[j * n + k] * root[j * n + k];
        /* what rounding leaves of an exact zero */
        const bool singular = !(pivot > 1e-15 * q[j * n + j]);
        const double diagonal = singular ? 0.0 : sqrt(pivot);
        for (int i = j + 1; i < n; i++) {
            double sum = q[i * n + j];
            for (int k = 0; k < j; k++)
                sum -= root[i * n + k] * root[j * n + k];
            root[i * n + j] = singular ? 0.0 : sum / diagonal;
        }
        root[j * n + j] = diagonal;
        for (int i = 0; i < j; i++)
            root[i * n + j] = 0.0;
    }
}
