/* SPDX-License-Identifier: Apache-2.0 */
/* Heapsort [WILLIAMS1964], which needs neither memory nor the C library, whose own may allocate. */
#ifndef IMUKI_SORT_INTERNAL_H
#define IMUKI_SORT_INTERNAL_H

#include <stddef.h>

/* Ascending. */
void imki_sort(double *x, size_t count);

#endif
