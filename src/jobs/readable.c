/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers, durations and figures of drift as a person reads them. */
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

imk_unit imk_readable_figure_unit(imk_drift_requirement requirement, double value)
{
    const double size = fabs(value), degree = 3.14159265358979323846 / 180;
    if (requirement == IMK_REQUIRED_VELOCITY)
        return imk_unit_of("m/s");
    if (requirement == IMK_REQUIRED_TILT || requirement == IMK_REQUIRED_HEADING)
        return imk_unit_of(size >= degree ? "deg" : size >= degree / 60 ? "arcmin" : "arcsec");
    return imk_unit_of(size < 1000 ? "m" : "km");
}

const char *imk_readable_number(double value, char text[IMK_READABLE_SIZE])
{
    if (!isfinite(value))
        snprintf(text, IMK_READABLE_SIZE, "-");
    else if (value == 0)
        snprintf(text, IMK_READABLE_SIZE, "0");
    else if (fabs(value) < 0.001)
        snprintf(text, IMK_READABLE_SIZE, "%.2g", value);
    else
        imk_readable_value(value, 0, 3, text, IMK_READABLE_SIZE);
    return text;
}

const char *imk_readable_quantity(double value, const imk_unit *unit, char text[IMK_READABLE_SIZE])
{
    char number[IMK_READABLE_SIZE];
    imk_readable_number(value / unit->scale, number);
    if (isfinite(value))
        snprintf(text, IMK_READABLE_SIZE, "%.24s %.12s", number, unit->text);
    else
        snprintf(text, IMK_READABLE_SIZE, "-");
    return text;
}

const char *imk_readable_figure(imk_drift_requirement requirement, double value,
                                char text[IMK_READABLE_SIZE])
{
    const imk_unit unit = imk_readable_figure_unit(requirement, value);
    return imk_readable_quantity(value, &unit, text);
}
