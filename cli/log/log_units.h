/* SPDX-License-Identifier: Apache-2.0 */
/* Units of the columns of a log that is written. */
#ifndef IMUKIT_WRITTEN_COLUMNS_H
#define IMUKIT_WRITTEN_COLUMNS_H

#include "imukit/units.h"

/* The unit that an option asks for; NULL text leaves what is there.
 * @return -1 or the exit code, the message printed */
int log_unit_parse(const char *option_name, const char *text, imk_unit *unit);
/* The same, of the dimension of the unit that it replaces. */
int log_unit_asked(const char *option_name, const char *text, imk_unit *unit);

#endif
