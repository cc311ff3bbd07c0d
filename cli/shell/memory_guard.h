/* SPDX-License-Identifier: Apache-2.0 */
/* Requests for more memory than there is fail. */
#ifndef MEMORY_GUARD_H
#define MEMORY_GUARD_H

/* Systems that promise more memory than they have kill the program that uses it, or another one,
 * without a message. After this call a request beyond seven eighths of the memory fails with a
 * message. */
void memory_guard(void);

#endif
