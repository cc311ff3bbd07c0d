/* SPDX-License-Identifier: Apache-2.0 */
/* The sentence for an error:  source:line:column: field: what was found; what is due. */
#include "imukit/io.h"

#include <stdio.h>

size_t imk_error_text(const imk_error *error, const char *source, char *text, size_t size)
{
    char place[64] = "";
    if (error->line > 0 && error->column > 0)
        snprintf(place, sizeof place, "%zu:%zu: ", error->line, error->column);
    else if (error->line > 0)
        snprintf(place, sizeof place, "%zu: ", error->line);
    const char *found = error->found[0] ? error->found : imk_status_text(error->status);
    int length = snprintf(text, size, "%s%s%s%s%s%s%s%s", source ? source : "", source ? ":" : "",
                          place[0] ? place : (source ? " " : ""), error->field,
                          error->field[0] ? ": " : "", found, error->expected[0] ? "; " : "",
                          error->expected);
    if (length < 0)
        return 0;
    return (size_t)length < size ? (size_t)length : size - 1;
}
