/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers and durations as a person reads them. */
#include "imukit/readable.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void imk_readable_value(double value, double uncertainty, int digits, char *text, size_t size)
{
    double magnitude = fabs(value);
    if (!isfinite(value)) {
        snprintf(text, size, "%s", isnan(value) ? "-" : value > 0 ? "inf" : "-inf");
        return;
    }
    int decimals;
    if (uncertainty > 0 && isfinite(uncertainty) && uncertainty < 1e6)
        decimals = 1 - (int)floor(log10(uncertainty));
    else
        decimals = magnitude > 0 ? digits - 1 - (int)floor(log10(magnitude)) : 0;
    decimals = decimals < 0 ? 0 : decimals;
    if (decimals > 9 || magnitude >= 1e7)
        snprintf(text, size, "%.*g", digits, value);
    else
        snprintf(text, size, "%.*f", decimals, value);
    /* What rounds to nothing has no sign. */
    if (text[0] == '-' && strspn(text + 1, "0.") == strlen(text + 1))
        memmove(text, text + 1, strlen(text));
}

void imk_readable_duration(double seconds, char *text, size_t size)
{
    if (!(seconds >= 60) || seconds > 1e9) {
        snprintf(text, size, "%.3g s", seconds);
        return;
    }
    unsigned long whole = (unsigned long)llround(seconds);
    unsigned long days = whole / 86400, hours = whole / 3600 % 24, minutes = whole / 60 % 60;
    size_t used = 0;
    const struct {
        unsigned long count;
        const char *unit;
    } part[] = {{days, "d"}, {hours, "h"}, {minutes, "min"}, {whole % 60, "s"}};
    text[0] = '\0';
    for (int i = 0; i < 4 && used < size; i++)
        if (part[i].count > 0)
            used += (size_t)snprintf(text + used, size - used, "%s%lu %s", used ? " " : "",
                                     part[i].count, part[i].unit);
}
