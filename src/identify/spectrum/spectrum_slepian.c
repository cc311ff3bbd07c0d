/* SPDX-License-Identifier: Apache-2.0 */
/* Slepian tapers: eigenvectors of the symmetric tridiagonal matrix
 *
 *     T[i][i] = ((n - 1 - 2 i)/2)^2 cos(2 pi W),   T[i-1][i] = i (n - i)/2,   W = NW/n
 *
 * that commutes with the concentration operator but has well-separated eigenvalues
 * [SLEPIAN1978, (14)]; the largest belong to the best tapers. Up to COARSE samples they are found
 * by bisection with Sturm counts and inverse iteration; longer ones start from those, interpolated,
 * and converge cubically by Rayleigh quotient iteration. The concentration follows from one row of
 * the operator. */
#include "imukit/spectrum.h"

#include "base/workspace_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
enum { COARSE = 320, BISECTIONS = 60, INVERSE_ITERATIONS = 4, QUOTIENT_ITERATIONS = 4 };

/* The matrix over n^2, so that its norm does not depend on n; off[i] couples i - 1 and i. */
static void fill_matrix(size_t n, double time_bandwidth, double *diagonal, double *off)
{
    const double size = (double)n, cosine = imk_cos(2 * PI * time_bandwidth / size);
    for (size_t i = 0; i < n; i++) {
        const double half = 0.5 * (size - 1 - 2 * (double)i) / size;
        diagonal[i] = half * half * cosine;
        off[i] = 0.5 * ((double)i / size) * ((double)(n - i) / size);
    }
}

/* Eigenvalues above x: signs of the pivots of T - x. */
static int count_above(size_t n, const double *diagonal, const double *off, double x)
{
    int count = 0;
    double pivot = diagonal[0] - x;
    for (size_t i = 1;; i++) {
        count += pivot > 0;
        if (i == n)
            return count;
        if (fabs(pivot) < 1e-300)
            pivot = 1e-300;
        pivot = diagonal[i] - x - off[i] * off[i] / pivot;
    }
}

static double eigenvalue(size_t n, const double *diagonal, const double *off, int index)
{
    double low = -1, high = 1; /* the norm is below 1/2 */
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (low + high);
        *(count_above(n, diagonal, off, middle) > index ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* Solve (T - x) y = v in place by elimination with row exchanges: upper holds 3 n values, the three
 * diagonals of U. A zero pivot, where x is an eigenvalue, becomes a tiny one. */
static void solve_shifted(size_t n, const double *diagonal, const double *off, double x, double *v,
                          double *upper)
{
    double a = diagonal[0] - x, b = n > 1 ? off[1] : 0; /* the row in hand: a, b, then 0 */
    for (size_t i = 0; i + 1 < n; i++) {
        const double below = off[i + 1], next = diagonal[i + 1] - x;
        const double after = i + 2 < n ? off[i + 2] : 0;
        double *row = upper + 3 * i;
        if (fabs(below) > fabs(a)) {
            const double factor = a / below, held = v[i];
            row[0] = below;
            row[1] = next;
            row[2] = after;
            v[i] = v[i + 1];
            v[i + 1] = held - factor * v[i];
            a = b - factor * next;
            b = -factor * after;
        } else {
            const double factor = below / (fabs(a) > 1e-300 ? a : (a = 1e-300));
            row[0] = a;
            row[1] = b;
            row[2] = 0;
            v[i + 1] -= factor * v[i];
            a = next - factor * b;
            b = after;
        }
    }
    upper[3 * (n - 1)] = fabs(a) > 1e-18 ? a : 1e-18;
    v[n - 1] /= upper[3 * (n - 1)];
    for (size_t i = n - 1; i-- > 0;) {
        const double *row = upper + 3 * i;
        double sum = v[i] - row[1] * v[i + 1];
        if (i + 2 < n)
            sum -= row[2] * v[i + 2];
        v[i] = sum / row[0];
    }
}

static void normalise(size_t n, double *v)
{
    double largest = 0, squares = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(v[i]));
    for (size_t i = 0; i < n; i++) {
        v[i] /= largest;
        squares += v[i] * v[i];
    }
    for (size_t i = 0; i < n; i++)
        v[i] /= sqrt(squares);
}

static double rayleigh_quotient(size_t n, const double *diagonal, const double *off,
                                const double *v)
{
    double sum = diagonal[0] * v[0] * v[0];
    for (size_t i = 1; i < n; i++)
        sum += diagonal[i] * v[i] * v[i] + 2 * off[i] * v[i] * v[i - 1];
    return sum;
}

/* Tapers are even or odd: rounding is not, and this takes half of it away. The sign is that of the
 * sum (even), or of the first lobe (odd). */
static void make_symmetric(size_t n, int index, double *v)
{
    const double parity = index % 2 == 0 ? 1 : -1;
    double sign = 0;
    for (size_t i = 0; i < n - 1 - i; i++) {
        v[i] = 0.5 * (v[i] + parity * v[n - 1 - i]);
        v[n - 1 - i] = parity * v[i];
    }
    if (n % 2 == 1 && parity < 0)
        v[n / 2] = 0;
    for (size_t i = 0; i < n; i++)
        sign += parity > 0 ? v[i] : ((double)n - 1 - 2 * (double)i) * v[i];
    normalise(n, v);
    for (size_t i = 0; sign < 0 && i < n; i++)
        v[i] = -v[i];
}

/* A start whose parity is that of the taper and which is orthogonal to none of them. */
static void find_by_bisection(size_t n, int index, const double *diagonal, const double *off,
                              double *v, double *upper)
{
    const double value = eigenvalue(n, diagonal, off, index);
    for (size_t i = 0; i < n; i++)
        v[i] = 1 + 0.3 * imk_sin(1.7 * (double)i) + (i < n / 2 ? 0.5 : 0);
    for (int iteration = 0; iteration < INVERSE_ITERATIONS; iteration++) {
        solve_shifted(n, diagonal, off, value, v, upper);
        normalise(n, v);
    }
    make_symmetric(n, index, v);
}

/* Cubic interpolation of a coarse taper at the centres of finer samples. */
static void interpolate(const double *coarse, size_t n, double *v)
{
    for (size_t i = 0; i < n; i++) {
        const double place = ((double)i + 0.5) / (double)n * COARSE - 0.5;
        const double base = fmin(fmax(floor(place), 1), COARSE - 3), t = place - base;
        const double *c = coarse + (size_t)base;
        v[i] = -c[-1] * t * (t - 1) * (t - 2) / 6 + c[0] * (t + 1) * (t - 1) * (t - 2) / 2 -
               c[1] * (t + 1) * t * (t - 2) / 2 + c[2] * (t + 1) * t * (t - 1) / 6;
    }
    normalise(n, v);
}

static void refine(size_t n, int index, const double *diagonal, const double *off, double *v,
                   double *upper)
{
    for (int iteration = 0; iteration < QUOTIENT_ITERATIONS; iteration++) {
        solve_shifted(n, diagonal, off, rayleigh_quotient(n, diagonal, off, v), v, upper);
        make_symmetric(n, index, v);
    }
}

/* lambda v_i = sum_j sin(2 pi W (i - j))/(pi (i - j)) v_j, at the i where v is largest. */
static double concentration(size_t n, double time_bandwidth, const double *v)
{
    const double turn = 2 * PI * time_bandwidth / (double)n;
    size_t peak = 0;
    for (size_t i = 1; i < n; i++)
        peak = fabs(v[i]) > fabs(v[peak]) ? i : peak;
    double sum = turn / PI * v[peak];
    for (size_t j = 0; j < n; j++)
        if (j != peak) {
            const double lag = (double)j - (double)peak;
            sum += imk_sin(turn * lag) / (PI * lag) * v[j];
        }
    return fmin(1, sum / v[peak]);
}

size_t imk_slepian_workspace_size(size_t n)
{
    return (8 * n + 64) * sizeof(double);
}

imk_status imk_slepian_tapers(size_t n, double time_bandwidth, int count, double *tapers,
                              double *concentrations, void *workspace, size_t workspace_size)
{
    if (n < 8 || count < 1 || count > (int)n / 2 ||
        !(time_bandwidth >= 0.5 && time_bandwidth <= 0.25 * (double)n) ||
        !((double)count <= 2 * time_bandwidth))
        return IMK_ERROR_RANGE;
    if (!workspace || workspace_size < imk_slepian_workspace_size(n))
        return IMK_ERROR_WORKSPACE;
    double *diagonal = imki_align(workspace), *off = diagonal + n, *upper = off + n;
    double *coarse = upper + 3 * n;
    const bool fine = n > 2 * COARSE;
    for (int k = 0; k < count; k++) {
        double *v = tapers + (size_t)k * n;
        if (fine) { /* 8 n exceeds what the coarse one needs besides */
            fill_matrix(COARSE, time_bandwidth, diagonal, off);
            find_by_bisection(COARSE, k, diagonal, off, coarse, upper);
            interpolate(coarse, n, v);
        }
        fill_matrix(n, time_bandwidth, diagonal, off);
        if (fine)
            refine(n, k, diagonal, off, v, upper);
        else
            find_by_bisection(n, k, diagonal, off, v, upper);
        concentrations[k] = concentration(n, time_bandwidth, v);
    }
    return IMK_OK;
}
