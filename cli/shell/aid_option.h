/* SPDX-License-Identifier: Apache-2.0 */
/* Options whose value is an aid of a navigator (imukit/aid_text.h). */
#ifndef IMUKIT_AID_OPTION_H
#define IMUKIT_AID_OPTION_H

#include "command.h"

#include "imukit/aiding.h"

/* Aids as --NAME states them. @param aids  room for IMK_AIDS_MAX
 * @return -1 or the exit code, the message printed */
int aid_option_parse(const char *name, const char *text, size_t *count, imk_aid *aids);

/* As above, but each kind once. */
int aid_option_kinds(const char *name, const char *text, size_t *count, imk_aid *aids);

/* Three lengths. @param sigma  NULL: takes none @return -1 or the exit code */
int aid_option_arm(const char *name, const char *text, double arm[3], double *sigma);

#endif
