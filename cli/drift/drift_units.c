/* SPDX-License-Identifier: Apache-2.0 */
/* Figures of drift in the units a person reads them in. */
#include "drift_parts.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

imk_unit drift_unit_of(imk_drift_wish wish, double value)
{
    const double size = fabs(value), degree = pi / 180;
    if (wish == IMK_WISH_VELOCITY)
        return imk_unit_of("m/s");
    if (wish == IMK_WISH_TILT || wish == IMK_WISH_HEADING)
        return imk_unit_of(size >= degree ? "deg" : size >= degree / 60 ? "arcmin" : "arcsec");
    return imk_unit_of(size < 1000 ? "m" : "km");
}

const char *drift_number(double value, char text[DRIFT_TEXT])
{
    if (!isfinite(value))
        snprintf(text, DRIFT_TEXT, "-");
    else if (value == 0)
        snprintf(text, DRIFT_TEXT, "0");
    else if (fabs(value) < 0.001)
        snprintf(text, DRIFT_TEXT, "%.2g", value);
    else
        format_value(value, 0, 3, text, DRIFT_TEXT);
    return text;
}

const char *drift_in_unit(double value, const imk_unit *unit, char text[DRIFT_TEXT])
{
    char number[DRIFT_TEXT];
    drift_number(value / unit->scale, number);
    if (isfinite(value))
        snprintf(text, DRIFT_TEXT, "%.24s %.12s", number, unit->text);
    else
        snprintf(text, DRIFT_TEXT, "-");
    return text;
}

const char *drift_figure_text(imk_drift_wish wish, double value, char text[DRIFT_TEXT])
{
    const imk_unit unit = drift_unit_of(wish, value);
    return drift_in_unit(value, &unit, text);
}

const char *drift_length(double metres, char text[DRIFT_TEXT])
{
    return drift_figure_text(IMK_WISH_CEP, metres, text);
}

const char *drift_angle(double radians, char text[DRIFT_TEXT])
{
    return drift_figure_text(IMK_WISH_HEADING, radians, text);
}

const char *drift_speed(double metres_per_second, char text[DRIFT_TEXT])
{
    return drift_figure_text(IMK_WISH_VELOCITY, metres_per_second, text);
}

const char *drift_wish_name(imk_drift_wish wish)
{
    static const char *const names[] = {"CEP",      "R95",  "DRMS",   "height",
                                        "velocity", "tilt", "heading"};
    return names[wish];
}

const char *drift_wish_unit(imk_drift_wish wish)
{
    static const char *const units[] = {"m", "m", "m", "m", "m/s", "rad", "rad"};
    return units[wish];
}
