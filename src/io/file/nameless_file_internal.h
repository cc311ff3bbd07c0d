/* SPDX-License-Identifier: Apache-2.0 */
/* Files for what does not fit into memory. */
#ifndef IMUKIT_NAMELESS_FILE_INTERNAL_H
#define IMUKIT_NAMELESS_FILE_INTERNAL_H

/* A new file without a name, in TMPDIR. @return -1 with errno */
int imki_open_nameless(void);

#endif
