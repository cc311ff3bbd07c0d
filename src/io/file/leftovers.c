/* SPDX-License-Identifier: Apache-2.0 */
/* The register from which a signal handler removes temporary files and ends programs. */
#define _POSIX_C_SOURCE 200809L
#include "leftovers_internal.h"

#include "imukit/output_file.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    SLOTS = 32,
    NAME_SIZE = 4096 /* PATH_MAX of Linux */
};

/* For the signal handler: names lie in static memory, since a handler may run on one thread while
 * another frees memory. Whoever takes a slot out of SLOT_LIVE decides what becomes of its file. */
enum { SLOT_FREE, SLOT_FILLING, SLOT_LIVE };

static struct {
    atomic_int state;
    pid_t leader; /* of a program; 0: a file or folder */
    char name[NAME_SIZE];
} slots[SLOTS];

void imki_signals_hold(sigset_t *before)
{
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, before);
}

void imki_signals_release(const sigset_t *before)
{
    pthread_sigmask(SIG_SETMASK, before, NULL);
}

static int add(const char *name, pid_t leader)
{
    const size_t size = strlen(name) + 1;
    for (int slot = 0; slot < SLOTS && size <= NAME_SIZE; slot++) {
        int state = SLOT_FREE;
        if (atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FILLING)) {
            memcpy(slots[slot].name, name, size);
            slots[slot].leader = leader;
            atomic_store(&slots[slot].state, SLOT_LIVE);
            return slot;
        }
    }
    return -1;
}

int imki_leftover_add(const char *name)
{
    return add(name, 0);
}

int imki_leftover_add_program(pid_t leader)
{
    return add("", leader);
}

void imki_leftover_drop(int slot)
{
    int state = SLOT_LIVE;
    if (slot >= 0)
        atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FREE);
}

/* Programs first, for they may be writing files; folders last, when those are gone. */
void imk_output_file_abandon_all(void)
{
    const int saved = errno;
    bool taken[SLOTS];
    for (int slot = 0; slot < SLOTS; slot++) {
        int state = SLOT_LIVE;
        taken[slot] = atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FILLING);
        if (taken[slot] && slots[slot].leader > 0 && kill(-slots[slot].leader, SIGKILL) == 0)
            waitpid(slots[slot].leader, NULL, 0);
    }
    for (int slot = 0; slot < SLOTS; slot++)
        if (taken[slot])
            unlink(slots[slot].name);
    for (int slot = 0; slot < SLOTS; slot++)
        if (taken[slot])
            rmdir(slots[slot].name);
    errno = saved;
}
