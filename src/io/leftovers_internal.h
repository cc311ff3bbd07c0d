/* SPDX-License-Identifier: Apache-2.0 */
/* The register of what a process that a signal ends would leave behind: temporary files and
 * folders. imk_output_file_abandon_all() removes it. */
#ifndef IMUKIT_LEFTOVERS_INTERNAL_H
#define IMUKIT_LEFTOVERS_INTERNAL_H

/* @return the place in the register, -1 when it is full or the name too long */
int imki_leftover_add(const char *name);

/* It is gone, or has become what was asked for. -1 is allowed. */
void imki_leftover_drop(int slot);

#endif
