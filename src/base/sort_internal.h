/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IMUKIT_SORT_INTERNAL_H
#define IMUKIT_SORT_INTERNAL_H

#include <stddef.h>

/* Numbers, none of them NaN, in ascending order. */
void imki_sort(double *x, size_t count);

#endif
