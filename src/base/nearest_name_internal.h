/* SPDX-License-Identifier: Apache-2.0 */
/* The nearest of a list of names, for use inside the library; see imukit/names.h. */
#ifndef IMUKI_NEAREST_NAME_INTERNAL_H
#define IMUKI_NEAREST_NAME_INTERNAL_H

#include <stddef.h>

size_t imki_nearest_name(const char *name, size_t count, const char *const *candidates);

#endif
