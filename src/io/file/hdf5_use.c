/* SPDX-License-Identifier: Apache-2.0 */
/* libhdf5 as this library uses it: its serial form is not made for threads, and it prints every
 * error on standard error unless told not to. What the caller told it is restored. It does not
 * survive that memory fails within it, so it is entered only while there is more than it takes. */
#include "hdf5_use_internal.h"

#include <hdf5.h>
#include <pthread.h>
#include <stdlib.h>

enum { ENOUGH = 4 << 20 };

bool imki_hdf5_use(void (*use)(void *context), void *context)
{
    static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    void *volatile memory = malloc(ENOUGH); /* volatile: else the compiler leaves it out */
    const bool is_enough = memory != NULL;
    free(memory);
    if (!is_enough)
        return false;
    pthread_mutex_lock(&mutex);
    H5E_BEGIN_TRY
    {
        use(context);
    }
    H5E_END_TRY
    pthread_mutex_unlock(&mutex);
    return true;
}
