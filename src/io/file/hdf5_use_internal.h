/* SPDX-License-Identifier: Apache-2.0 */
/* The one way into libhdf5. */
#ifndef IMUKIT_HDF5_USE_INTERNAL_H
#define IMUKIT_HDF5_USE_INTERNAL_H

#include <stdbool.h>

/* Call a function that uses libhdf5: one at a time, and without messages on standard error.
 * @return false: memory is short, and it was not called */
bool imki_hdf5_use(void (*use)(void *context), void *context);

#endif
