/* SPDX-License-Identifier: Apache-2.0 */
/* The median, shared by what must not be moved by a few bad values. */
#ifndef IMUKIT_MEDIAN_INTERNAL_H
#define IMUKIT_MEDIAN_INTERNAL_H

#include <stddef.h>

/* The element that would stand at count/2 of the sorted array, count >= 1; x is reordered. Linear
 * time on average. */
double imki_median(double *x, size_t count);

#endif
