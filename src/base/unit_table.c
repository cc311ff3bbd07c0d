/* SPDX-License-Identifier: Apache-2.0 */
/* The units that have names. Only the listed multiples exist: so "mg" can only be a thousandth of
 * g, "min" a minute and "ms" a millisecond. Scales are exact by definition, or the double nearest
 * to it, so that "1 deg" is one rounding of pi/180. */
#include "base/unit_table_internal.h"

#include "imukit/names.h"

#include <string.h>

#define PI 3.14159265358979323846
#define NONE                                                                                       \
    {                                                                                              \
        {                                                                                          \
            0, 0, 0, 0, 0                                                                          \
        }                                                                                          \
    }
#define LENGTH                                                                                     \
    {                                                                                              \
        {                                                                                          \
            2, 0, 0, 0, 0                                                                          \
        }                                                                                          \
    }
#define TIME                                                                                       \
    {                                                                                              \
        {                                                                                          \
            0, 2, 0, 0, 0                                                                          \
        }                                                                                          \
    }
#define ANGLE                                                                                      \
    {                                                                                              \
        {                                                                                          \
            0, 0, 2, 0, 0                                                                          \
        }                                                                                          \
    }
#define TEMPERATURE                                                                                \
    {                                                                                              \
        {                                                                                          \
            0, 0, 0, 2, 0                                                                          \
        }                                                                                          \
    }
#define COUNT                                                                                      \
    {                                                                                              \
        {                                                                                          \
            0, 0, 0, 0, 2                                                                          \
        }                                                                                          \
    }
#define FREQUENCY                                                                                  \
    {                                                                                              \
        {                                                                                          \
            0, -2, 0, 0, 0                                                                         \
        }                                                                                          \
    }
#define RATE                                                                                       \
    {                                                                                              \
        {                                                                                          \
            0, -2, 2, 0, 0                                                                         \
        }                                                                                          \
    }
#define ACCELERATION                                                                               \
    {                                                                                              \
        {                                                                                          \
            2, -4, 0, 0, 0                                                                         \
        }                                                                                          \
    }

static const imki_named_unit units[] = {
    /* angle */
    {"rad", 1.0, 0.0, ANGLE, false},
    {"mrad", 1e-3, 0.0, ANGLE, false},
    {"urad", 1e-6, 0.0, ANGLE, false},
    {"nrad", 1e-9, 0.0, ANGLE, false},
    {"deg", PI / 180.0, 0.0, ANGLE, false},
    {"degree", PI / 180.0, 0.0, ANGLE, false},
    {"degrees", PI / 180.0, 0.0, ANGLE, false},
    {"mdeg", PI / 180e3, 0.0, ANGLE, false},
    {"arcmin", PI / 10800.0, 0.0, ANGLE, false},
    {"arcsec", PI / 648000.0, 0.0, ANGLE, false},
    {"arc-sec", PI / 648000.0, 0.0, ANGLE, false},
    {"arcsecond", PI / 648000.0, 0.0, ANGLE, false},
    {"arcseconds", PI / 648000.0, 0.0, ANGLE, false},
    {"asec", PI / 648000.0, 0.0, ANGLE, false},
    {"rev", 2.0 * PI, 0.0, ANGLE, false},
    /* angular rate */
    {"dps", PI / 180.0, 0.0, RATE, false},
    {"mdps", PI / 180e3, 0.0, RATE, false},
    {"dph", PI / 648000.0, 0.0, RATE, false},
    {"rpm", PI / 30.0, 0.0, RATE, false},
    /* time */
    {"s", 1.0, 0.0, TIME, false},
    {"sec", 1.0, 0.0, TIME, false},
    {"second", 1.0, 0.0, TIME, false},
    {"seconds", 1.0, 0.0, TIME, false},
    {"ms", 1e-3, 0.0, TIME, false},
    {"us", 1e-6, 0.0, TIME, false},
    {"ns", 1e-9, 0.0, TIME, false},
    {"min", 60.0, 0.0, TIME, false},
    {"minute", 60.0, 0.0, TIME, false},
    {"minutes", 60.0, 0.0, TIME, false},
    {"h", 3600.0, 0.0, TIME, false},
    {"hr", 3600.0, 0.0, TIME, false},
    {"hour", 3600.0, 0.0, TIME, false},
    {"hours", 3600.0, 0.0, TIME, false},
    {"day", 86400.0, 0.0, TIME, false},
    {"days", 86400.0, 0.0, TIME, false},
    /* frequency */
    {"Hz", 1.0, 0.0, FREQUENCY, true},
    {"hz", 1.0, 0.0, FREQUENCY, true},
    {"mHz", 1e-3, 0.0, FREQUENCY, true},
    {"kHz", 1e3, 0.0, FREQUENCY, true},
    {"MHz", 1e6, 0.0, FREQUENCY, true},
    /* length; the foot by the agreement of 1959, the nautical mile by that of 1929 */
    {"m", 1.0, 0.0, LENGTH, false},
    {"nm", 1e-9, 0.0, LENGTH, false},
    {"um", 1e-6, 0.0, LENGTH, false},
    {"mm", 1e-3, 0.0, LENGTH, false},
    {"cm", 1e-2, 0.0, LENGTH, false},
    {"km", 1e3, 0.0, LENGTH, false},
    {"nmi", 1852.0, 0.0, LENGTH, false},
    {"ft", 0.3048, 0.0, LENGTH, false},
    /* acceleration */
    {"g", IMK_STANDARD_GRAVITY, 0.0, ACCELERATION, false},
    {"mg", 9.80665e-3, 0.0, ACCELERATION, false},
    {"ug", 9.80665e-6, 0.0, ACCELERATION, false},
    {"ng", 9.80665e-9, 0.0, ACCELERATION, false},
    {"Gal", 1e-2, 0.0, ACCELERATION, false},
    {"mGal", 1e-5, 0.0, ACCELERATION, false},
    {"uGal", 1e-8, 0.0, ACCELERATION, false},
    /* temperature */
    {"K", 1.0, 0.0, TEMPERATURE, false},
    {"mK", 1e-3, 0.0, TEMPERATURE, false},
    {"degC", 1.0, 273.15, TEMPERATURE, false},
    /* counts and ratios */
    {"count", 1.0, 0.0, COUNT, false},
    {"counts", 1.0, 0.0, COUNT, false},
    {"LSB", 1.0, 0.0, COUNT, false},
    {"lsb", 1.0, 0.0, COUNT, false},
    {"%", 1e-2, 0.0, NONE, false},
    {"percent", 1e-2, 0.0, NONE, false},
    {"ppm", 1e-6, 0.0, NONE, false},
    {"ppb", 1e-9, 0.0, NONE, false},
};

enum { UNIT_COUNT = (int)(sizeof units / sizeof units[0]) };

const imki_named_unit *imki_unit_find(const char *name)
{
    for (size_t i = 0; i < UNIT_COUNT; i++) {
        if (strcmp(units[i].name, name) == 0)
            return &units[i];
    }
    return NULL;
}

const char *imki_unit_nearest(const char *name)
{
    const char *names[UNIT_COUNT];
    for (size_t i = 0; i < UNIT_COUNT; i++)
        names[i] = units[i].name;
    const size_t nearest = imk_nearest_name(name, UNIT_COUNT, names);
    return nearest < UNIT_COUNT ? names[nearest] : NULL;
}
