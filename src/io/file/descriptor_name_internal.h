/* SPDX-License-Identifier: Apache-2.0 */
/* Names that mean a stream this process has open. */
#ifndef IMUKIT_DESCRIPTOR_NAME_INTERNAL_H
#define IMUKIT_DESCRIPTOR_NAME_INTERNAL_H

/* Number of the open stream that a path names: /dev/stdin, /dev/stdout, /dev/stderr, /dev/fd/N and
 * /proc/self/fd/N; -1 for any other. Shells make such names of <(command) and >(command). */
int imki_descriptor_named(const char *path);

#endif
