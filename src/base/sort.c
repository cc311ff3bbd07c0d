/* SPDX-License-Identifier: Apache-2.0 */
/* Quicksort [HOARE1962] by the median of three, short parts by insertion; what parts of unequal
 * size leave of the work by heapsort [WILLIAMS1964]. It needs neither memory nor the C library,
 * whose qsort may allocate. */
#include "sort_internal.h"

#include <stdbool.h>

enum { SHORT = 16, PARTS_MAX = 64 };

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

static void heap_sort(double *x, size_t count)
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

static void insert_all(double *x, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        const double value = x[i];
        size_t at = i;
        for (; at > 0 && x[at - 1] > value; at--)
            x[at] = x[at - 1];
        x[at] = value;
    }
}

static double middle_of(double a, double b, double c)
{
    const double low = a < b ? a : b, high = a < b ? b : a;
    return c < low ? low : c > high ? high : c;
}

/* Divide into values up to the pivot and values from it on. @return where the latter begin; neither
 * part is empty, because the pivot is the median of three of them */
static size_t divide(double *x, size_t count)
{
    const double pivot = middle_of(x[0], x[count / 2], x[count - 1]);
    for (size_t i = 0, j = count - 1;; i++, j--) {
        while (x[i] < pivot)
            i++;
        while (x[j] > pivot)
            j--;
        if (i >= j)
            return i;
        const double low = x[j];
        x[j] = x[i];
        x[i] = low;
    }
}

void imki_sort(double *x, size_t count)
{
    struct {
        double *x;
        size_t count;
    } part[PARTS_MAX]; /* the larger of two, so that the other is at most half as long each time */
    size_t parts = 0, work = 0;
    for (size_t n = count; n > 0; n /= 2)
        work += 4 * count; /* parts of equal size take a quarter of that */
    for (;;) {
        while (count > SHORT && work >= count) {
            work -= count;
            const size_t at = divide(x, count);
            const bool first = at > count - at;
            part[parts].x = first ? x : x + at;
            part[parts++].count = first ? at : count - at;
            x = first ? x + at : x;
            count = first ? count - at : at;
        }
        if (count > SHORT)
            heap_sort(x, count);
        else
            insert_all(x, count);
        if (parts == 0)
            return;
        x = part[--parts].x;
        count = part[parts].count;
    }
}
