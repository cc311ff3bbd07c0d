/* SPDX-License-Identifier: Apache-2.0 */
/* Requests for more memory than there is fail. */
#ifndef MEMORY_GUARD_H
#define MEMORY_GUARD_H

/* Systems that promise more memory than they have end a program that takes it, or another one,
 * without a word. From here on a request beyond seven eighths of the memory fails, and is told. */
void memory_guard(void);

#endif
