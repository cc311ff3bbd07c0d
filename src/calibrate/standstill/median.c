/* SPDX-License-Identifier: Apache-2.0 */
/* Selection by parting the array around a pivot, again and again in the part that holds the middle
 * [HOARE1961]. */
#include "median_internal.h"

double imki_median(double *x, size_t count)
{
    size_t low = 0, high = count - 1;
    const size_t middle = count / 2;
    while (low < high) {
        const double pivot = x[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (x[i] < pivot)
                i++;
            while (x[j] > pivot)
                j--;
            if (i >= j)
                break;
            const double swapped = x[i];
            x[i++] = x[j];
            x[j--] = swapped;
        }
        /* x[low … j] <= pivot <= x[j + 1 … high] */
        if (middle <= j)
            high = j;
        else
            low = j + 1;
    }
    return x[middle];
}
