/* SPDX-License-Identifier: Apache-2.0 */
/* What the columns of a log are called that is written, their units, and its words. */
#ifndef IMUKIT_WRITTEN_COLUMNS_H
#define IMUKIT_WRITTEN_COLUMNS_H

#include "imukit/log.h"
#include "imukit/model.h"

/* The unit that an option asks for, which is to be of the dimension of the one it replaces; NULL
 * text leaves that. @return -1 or the exit code, the message printed */
int log_unit_asked(const char *option_name, const char *text, imk_unit *unit);
/* The words of a log, where it has any, go into the one that is made of it. */
void log_copy_labels(imk_log_reader *from, imk_log_writer *to);

#endif
