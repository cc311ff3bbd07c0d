/* SPDX-License-Identifier: Apache-2.0 */
/* Aids of a navigator as texts. */
#ifndef IMUKIT_SHELL_AID_TEXT_H
#define IMUKIT_SHELL_AID_TEXT_H

#include "command.h"

#include "imukit/aiding.h"

/* Kinds and their 1 sigma, "position 1 m correlated 2 m over 60 s, odometer 0.1 m/s", each once.
 * @param aids  room for IMK_AIDS_MAX @return -1 or the exit code, the message printed */
int aid_text_parse(const char *name, const char *text, size_t *aid_count, imk_aid *aids);

/* Three lengths. @param sigma  NULL: takes none @return -1 or the exit code */
int aid_arm_parse(const char *name, const char *text, double arm[3], double *sigma);

#endif
