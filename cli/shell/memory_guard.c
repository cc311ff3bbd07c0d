/* SPDX-License-Identifier: Apache-2.0 */
/* The limit on the data of the command itself. The address and thread sanitizers map far more
 * memory than exists, and do not use it, so they have no limit. */
#define _POSIX_C_SOURCE 200809L
#include "memory_guard.h"

#include "imukit/memory_limit.h"

#include <sys/resource.h>

#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED
#endif

void memory_guard(void)
{
#ifndef SANITIZED
    struct rlimit limit;
    const rlim_t memory = imk_memory_limit(), most = memory - memory / 8;
    if (getrlimit(RLIMIT_DATA, &limit) != 0 || limit.rlim_cur < most)
        return;
    limit.rlim_cur = most;
    setrlimit(RLIMIT_DATA, &limit);
#endif
}
