/* SPDX-License-Identifier: Apache-2.0 */
/* Total variance [RILEY2008, (25)]: the overlapping one of the record continued beyond both ends by
 * its own image, turned by half a turn so that it joins smoothly.
 *
 *     TOTVAR(m) = 1/(2 m^2 (n - 1)) sum_{i=1}^{n-1} (x[i-m] - 2 x[i] + x[i+m])^2
 *     x[-i] = 2 s[0] - s[i],   x[n+i] = 2 s[n] - s[n-i]
 *
 * The terms inside the record are the overlapping variance's; here are the 2 (m - 1) others. Beyond
 * m = n/2 there are n - 1 in all, and those in the middle reach beyond both ends. */
#include "allan_internal.h"

static double beyond_half(size_t n, const double *s, size_t m)
{
    double total = 0;
    for (size_t i = 1; i < n; i++) {
        const double before = i < m ? 2 * s[0] - s[m - i] : s[i - m];
        const double after = i + m > n ? 2 * s[n] - s[2 * n - i - m] : s[i + m];
        const double d = (after - s[i]) - (s[i] - before);
        total += d * d;
    }
    return total;
}

double imki_allan_total_ends(size_t n, const double *sums, size_t m)
{
    if (2 * m > n)
        return beyond_half(n, sums, m);
    const double *end = sums + n;
    double left = 0, right = 0;
    for (size_t i = 1; i < m; i++) {
        const double a = (sums[i + m] - sums[i]) - (sums[i] + sums[m - i] - 2 * sums[0]);
        const double *at = end - i;
        const double b = (*(at - m) - *at) - (*at + *(end - (m - i)) - 2 * *end);
        left += a * a;
        right += b * b;
    }
    return left + right;
}
