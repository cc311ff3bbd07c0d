/* SPDX-License-Identifier: Apache-2.0 */
/* The register from which a signal handler removes temporary files. */
#define _POSIX_C_SOURCE 200809L
#include "io/leftovers_internal.h"

#include "imukit/output_file.h"

#include <errno.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

enum {
    SLOTS = 32,
    NAME_SIZE = 4096 /* PATH_MAX of Linux */
};

/* A temporary file, for the signal handler: the name lies in static memory, since a handler may run
 * on one thread while another frees memory. Whoever takes the slot out of SLOT_LIVE decides what
 * becomes of the file. */
enum { SLOT_FREE, SLOT_FILLING, SLOT_LIVE };

static struct {
    atomic_int state;
    char name[NAME_SIZE];
} slots[SLOTS];

int imki_leftover_add(const char *name)
{
    const size_t size = strlen(name) + 1;
    for (int slot = 0; slot < SLOTS && size <= NAME_SIZE; slot++) {
        int state = SLOT_FREE;
        if (atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FILLING)) {
            memcpy(slots[slot].name, name, size);
            atomic_store(&slots[slot].state, SLOT_LIVE);
            return slot;
        }
    }
    return -1;
}

void imki_leftover_drop(int slot)
{
    int state = SLOT_LIVE;
    if (slot >= 0)
        atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FREE);
}

void imk_output_file_abandon_all(void)
{
    const int saved = errno;
    for (int slot = 0; slot < SLOTS; slot++) {
        int state = SLOT_LIVE;
        if (atomic_compare_exchange_strong(&slots[slot].state, &state, SLOT_FILLING))
            unlink(slots[slot].name);
    }
    errno = saved;
}
