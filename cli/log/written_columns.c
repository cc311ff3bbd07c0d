/* SPDX-License-Identifier: Apache-2.0 */
/* Columns of a log that is written. */
#include "written_columns.h"

#include "shell/command.h"

#include <string.h>

void log_axis_name(const char *sensor, int axis, char *text, size_t size)
{
    if (axis >= 0 && axis < 3)
        snprintf(text, size, "%s_%c", sensor, "xyz"[axis]);
    else
        snprintf(text, size, "%s_%d", sensor, axis);
}

void log_axes(const imk_triad *triad, int axis[IMK_AXES_MAX])
{
    bool named = true, taken[3] = {false};
    for (int i = 0; i < triad->axis_count; i++) {
        axis[i] = -1;
        for (int k = 0; k < 3; k++)
            if (triad->direction[i][k] >= 1)
                axis[i] = k;
        named = named && axis[i] >= 0 && !taken[axis[i]];
        if (named)
            taken[axis[i]] = true;
    }
    for (int i = 0; i < triad->axis_count && !named; i++)
        axis[i] = i;
}

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
