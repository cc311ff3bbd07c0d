/* SPDX-License-Identifier: Apache-2.0 */
/* Columns of a log that is written. */
#include "log_units.h"

#include "shell/command.h"

#include <string.h>

int log_unit_asked(const char *option_name, const char *text, imk_unit *unit)
{
    const imk_dimension due = unit->dimension;
    imk_unit asked;
    imk_error error;
    if (!text)
        return -1;
    if (imk_unit_parse(text, text + strlen(text), &asked, &error) != IMK_OK)
        return command_misused("--%s %s: the unit is not known", option_name, text);
    if (!imk_dimension_equal(asked.dimension, due))
        return command_misused("--%s %s: expected %s such as %s", option_name, text,
                               imk_dimension_name(due), imk_dimension_examples(due));
    *unit = asked;
    return -1;
}

static const char *label_of(void *reader, size_t index)
{
    return imk_log_label(reader, index);
}

void log_copy_labels(imk_log_reader *from, imk_log_writer *to)
{
    imk_log_write_labels(to, label_of, from);
}
