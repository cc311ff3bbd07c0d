/* SPDX-License-Identifier: Apache-2.0 */
/* Heapsort [WILLIAMS1964], which needs neither memory nor the C library, whose qsort may allocate.
 */
#include "sort_internal.h"

static void sift_down(double *x, size_t root, size_t count)
{
    const double value = x[root];
    for (size_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
        if (child + 1 < count && x[child + 1] > x[child])
            child++;
        if (!(x[child] > value))
            break;
        x[root] = x[child];
        root = child;
    }
    x[root] = value;
}

void imki_sort(double *x, size_t count)
{
    for (size_t root = count / 2; root-- > 0;)
        sift_down(x, root, count);
    for (size_t last = count; last-- > 1;) {
        const double largest = x[0];
        x[0] = x[last];
        x[last] = largest;
        sift_down(x, 0, last);
    }
}
