/* SPDX-License-Identifier: Apache-2.0 */
/* What to do about columns that a format does not hold: the command that leaves them out. */
#include "log_formats_internal.h"

#include <stdio.h>
#include <string.h>

void imki_log_select_text(const imki_log_output *log, const char *path, const bool *keep,
                          size_t size, char *text)
{
    const char *ending = strrchr(path, '.');
    size_t used = (size_t)snprintf(text, size, "imukit convert FILE.csv FILE%.8s --select ",
                                   ending ? ending : "");
    const size_t bare = used;
    for (size_t i = 0; i < log->rows.column_count; i++) {
        const char *name = log->column[i].name;
        if (keep[i] && used + strlen(name) + 2 > size) {
            snprintf(text + bare, size - bare, "NAMES, separated by commas");
            return;
        }
        if (keep[i])
            used +=
                (size_t)snprintf(text + used, size - used, "%s%s", used > bare ? "," : "", name);
    }
    if (used == bare)
        text[0] = '\0';
}
