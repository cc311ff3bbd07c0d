/* SPDX-License-Identifier: Apache-2.0 */
/** @file memory_limit.h
 *  How much memory the process may use. */
#ifndef IMUKIT_MEMORY_LIMIT_H
#define IMUKIT_MEMORY_LIMIT_H

#include "imukit/status.h"

#include <stddef.h>

IMK_BEGIN_C

/** Bytes that this process may have in all: the least of the machine's memory and of the limits on
 *  its address space, its data and its control group; SIZE_MAX when nothing is known. */
IMK_API size_t imk_memory_limit(void);

IMK_END_C
#endif
