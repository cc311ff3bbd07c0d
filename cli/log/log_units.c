/* SPDX-License-Identifier: Apache-2.0 */
/* Units of the columns of a log that is written. */
#include "log_units.h"

#include "shell/command.h"

#include <string.h>

int log_unit_parse(const char *option_name, const char *text, imk_unit *unit)
{
    imk_error error;
    if (text && imk_unit_parse(text, text + strlen(text), unit, &error) != IMK_OK)
        return command_misused("--%s %s: the unit is not known", option_name, text);
    return -1;
}

int log_unit_asked(const char *option_name, const char *text, imk_unit *unit)
{
    imk_unit asked = *unit;
    const int code = log_unit_parse(option_name, text, &asked);
    if (code < 0 && !imk_dimension_equal(asked.dimension, unit->dimension))
        return command_misused("--%s %s: expected %s such as %s", option_name, text,
                               imk_dimension_name(unit->dimension),
                               imk_dimension_examples(unit->dimension));
    *unit = asked;
    return code;
}
