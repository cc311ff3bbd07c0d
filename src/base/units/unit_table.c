/* SPDX-License-Identifier: Apache-2.0 */
/* The units that have names. Only the listed multiples exist: so "mg" can only be a thousandth of
 * g, "min" a minute and "ms" a millisecond. Scales are exact by definition, or the double nearest
 * to it, so that "1 deg" is one rounding of pi/180. */
#include "unit_table_internal.h"

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
#define MASS                                                                                       \
    {                                                                                              \
        {                                                                                          \
            0, 0, 0, 0, 0, 2, 0                                                                    \
        }                                                                                          \
    }
#define FORCE                                                                                      \
    {                                                                                              \
        {                                                                                          \
            2, -4, 0, 0, 0, 2, 0                                                                   \
        }                                                                                          \
    }
#define TORQUE                                                                                     \
    {                                                                                              \
        {                                                                                          \
            4, -4, 0, 0, 0, 2, 0                                                                   \
        }                                                                                          \
    }
#define PRESSURE                                                                                   \
    {                                                                                              \
        {                                                                                          \
            -2, -4, 0, 0, 0, 2, 0                                                                  \
        }                                                                                          \
    }
#define POWER                                                                                      \
    {                                                                                              \
        {                                                                                          \
            4, -6, 0, 0, 0, 2, 0                                                                   \
        }                                                                                          \
    }
#define CURRENT                                                                                    \
    {                                                                                              \
        {                                                                                          \
            0, 0, 0, 0, 0, 0, 2                                                                    \
        }                                                                                          \
    }
#define VOLTAGE                                                                                    \
    {                                                                                              \
        {                                                                                          \
            4, -6, 0, 0, 0, 2, -2                                                                  \
        }                                                                                          \
    }
#define RESISTANCE                                                                                 \
    {                                                                                              \
        {                                                                                          \
            4, -6, 0, 0, 0, 2, -4                                                                  \
        }                                                                                          \
    }
#define FLUX_DENSITY                                                                               \
    {                                                                                              \
        {                                                                                          \
            0, -4, 0, 0, 0, 2, -2                                                                  \
        }                                                                                          \
    }
#define CAPACITANCE                                                                                \
    {                                                                                              \
        {                                                                                          \
            -4, 8, 0, 0, 0, -2, 4                                                                  \
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
    {"milliseconds", 1e-3, 0.0, TIME, false},
    {"microseconds", 1e-6, 0.0, TIME, false},
    {"nanoseconds", 1e-9, 0.0, TIME, false},
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
    {"GHz", 1e9, 0.0, FREQUENCY, true},
    {"THz", 1e12, 0.0, FREQUENCY, true},
    /* length; the foot by the agreement of 1959, the nautical mile by that of 1929 */
    {"m", 1.0, 0.0, LENGTH, false},
    {"pm", 1e-12, 0.0, LENGTH, false},
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
    /* mass; g, mg and ug are accelerations */
    {"kg", 1.0, 0.0, MASS, false},
    {"gram", 1e-3, 0.0, MASS, false},
    {"grams", 1e-3, 0.0, MASS, false},
    {"milligram", 1e-6, 0.0, MASS, false},
    {"microgram", 1e-9, 0.0, MASS, false},
    {"nanogram", 1e-12, 0.0, MASS, false},
    /* force, torque, pressure, energy, power */
    {"N", 1.0, 0.0, FORCE, false},
    {"mN", 1e-3, 0.0, FORCE, false},
    {"uN", 1e-6, 0.0, FORCE, false},
    {"nN", 1e-9, 0.0, FORCE, false},
    {"pN", 1e-12, 0.0, FORCE, false},
    {"Nm", 1.0, 0.0, TORQUE, false},
    {"mNm", 1e-3, 0.0, TORQUE, false},
    {"uNm", 1e-6, 0.0, TORQUE, false},
    {"J", 1.0, 0.0, TORQUE, false},
    {"Pa", 1.0, 0.0, PRESSURE, false},
    {"kPa", 1e3, 0.0, PRESSURE, false},
    {"MPa", 1e6, 0.0, PRESSURE, false},
    {"GPa", 1e9, 0.0, PRESSURE, false},
    {"W", 1.0, 0.0, POWER, false},
    {"mW", 1e-3, 0.0, POWER, false},
    {"uW", 1e-6, 0.0, POWER, false},
    {"nW", 1e-9, 0.0, POWER, false},
    /* electricity; no C, which many write for degC */
    {"A", 1.0, 0.0, CURRENT, false},
    {"mA", 1e-3, 0.0, CURRENT, false},
    {"uA", 1e-6, 0.0, CURRENT, false},
    {"nA", 1e-9, 0.0, CURRENT, false},
    {"pA", 1e-12, 0.0, CURRENT, false},
    {"V", 1.0, 0.0, VOLTAGE, false},
    {"kV", 1e3, 0.0, VOLTAGE, false},
    {"mV", 1e-3, 0.0, VOLTAGE, false},
    {"uV", 1e-6, 0.0, VOLTAGE, false},
    {"nV", 1e-9, 0.0, VOLTAGE, false},
    {"ohm", 1.0, 0.0, RESISTANCE, false},
    {"kohm", 1e3, 0.0, RESISTANCE, false},
    {"Mohm", 1e6, 0.0, RESISTANCE, false},
    {"F", 1.0, 0.0, CAPACITANCE, false},
    {"uF", 1e-6, 0.0, CAPACITANCE, false},
    {"nF", 1e-9, 0.0, CAPACITANCE, false},
    {"pF", 1e-12, 0.0, CAPACITANCE, false},
    {"fF", 1e-15, 0.0, CAPACITANCE, false},
    /* magnetic flux density; G and mG are gauss, g and mg accelerations */
    {"T", 1.0, 0.0, FLUX_DENSITY, false},
    {"mT", 1e-3, 0.0, FLUX_DENSITY, false},
    {"uT", 1e-6, 0.0, FLUX_DENSITY, false},
    {"nT", 1e-9, 0.0, FLUX_DENSITY, false},
    {"gauss", 1e-4, 0.0, FLUX_DENSITY, false},
    {"G", 1e-4, 0.0, FLUX_DENSITY, false},
    {"mG", 1e-7, 0.0, FLUX_DENSITY, false},
    /* temperature */
    {"K", 1.0, 0.0, TEMPERATURE, false},
    {"mK", 1e-3, 0.0, TEMPERATURE, false},
    {"degC", 1.0, 273.15, TEMPERATURE, false},
    /* counts and ratios */
    {"count", 1.0, 0.0, COUNT, false},
    {"counts", 1.0, 0.0, COUNT, false},
    {"LSB", 1.0, 0.0, COUNT, false},
    {"lsb", 1.0, 0.0, COUNT, false},
    {"digit", 1.0, 0.0, COUNT, false},
    {"digits", 1.0, 0.0, COUNT, false},
    {"%", 1e-2, 0.0, NONE, false},
    {"percent", 1e-2, 0.0, NONE, false},
    {"ppm", 1e-6, 0.0, NONE, false},
    {"ppb", 1e-9, 0.0, NONE, false},
    {"dB", 0.23025850929940458, 0.0, NONE, false}, /* ln(10)/10: of a power, in the exponent */
};

enum { UNIT_COUNT = (int)(sizeof units / sizeof units[0]) };

size_t imki_unit_count(void)
{
    return UNIT_COUNT;
}

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
