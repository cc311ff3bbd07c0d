/* SPDX-License-Identifier: Apache-2.0 */
/* The register of what a process that a signal ends would leave behind: temporary files, folders
 * that are empty without them, programs that were started. imk_output_file_abandon_all() removes
 * all of it. */
#ifndef IMUKIT_LEFTOVERS_INTERNAL_H
#define IMUKIT_LEFTOVERS_INTERNAL_H

#include <signal.h>
#include <sys/types.h>

/* Signals wait from here to imki_signals_release(): between making something and its place in the
 * register, none may end the process. The threads of thread_pool.c take none at any time. */
void imki_signals_hold(sigset_t *before);
void imki_signals_release(const sigset_t *before);

/* A file or folder. @return the place in the register, -1 when it is full or the name too long */
int imki_leftover_add(const char *name);

/* A program that leads a process group of its own. @return as above */
int imki_leftover_add_program(pid_t leader);

/* It is gone, or has become what was asked for. -1 is allowed. */
void imki_leftover_drop(int slot);

#endif
