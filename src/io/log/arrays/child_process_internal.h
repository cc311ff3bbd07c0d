/* SPDX-License-Identifier: Apache-2.0 */
/* A part of this program in a process of its own, where it may crash, hang or take too much memory:
 * for libraries that do not survive damaged files. The two talk over a socket. */
#ifndef IMUKIT_CHILD_PROCESS_INTERNAL_H
#define IMUKIT_CHILD_PROCESS_INTERNAL_H

#include "imukit/status.h"

#include <stdbool.h>
#include <sys/types.h>

/* Sanitizers reserve terabytes of addresses: with them there is no limit of memory. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IMKI_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) ||                         \
    __has_feature(memory_sanitizer)
#define IMKI_SANITIZED 1
#endif
#endif
#ifndef IMKI_SANITIZED
#define IMKI_SANITIZED 0
#endif

typedef struct imki_child {
    pid_t process; /* 0: none */
    int socket;    /* -1: closed */
} imki_child;

/* What the child runs. It may read `file`, talk over `socket`, and call imki_child_continue(); it
 * has no other file, and is ended when it returns. */
typedef void (*imki_child_work)(int file, int socket);

/* Start a child. Memory beyond 1 GiB and 20 s of processor time for one step are not given to it.
 * @return IMK_ERROR_MEMORY, or IMK_ERROR_OPEN with the system's reason */
imk_status imki_child_start(imki_child_work work, int file, imki_child *child, imk_error *error);
/* In the child: the next step begins. */
void imki_child_continue(void);
/* End it, whatever it does. */
void imki_child_end(imki_child *child);
/* It did not answer as it should: end it, and say what became of it.
 * @param library  "HDF5", for the message
 * @return IMK_ERROR_FORMAT */
imk_status imki_child_refuse(imki_child *child, const char *library, imk_error *error);

/* All bytes, in either direction. @return false: the other side is gone */
bool imki_socket_send(int socket, const void *bytes, size_t size);
bool imki_socket_receive(int socket, void *bytes, size_t size);

#endif
