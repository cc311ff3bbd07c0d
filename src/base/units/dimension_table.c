/* SPDX-License-Identifier: Apache-2.0 */
/* What the dimensions of a sensor model are called, and the units people use for them. */
#include "imukit/units.h"

#include "unit_table_internal.h"

#include <math.h>
#include <string.h>

enum { READABLE_MAX = 4 };

/* A usual unit, for magnitudes from `minimum` of that unit up to the next one's. */
typedef struct readable {
    const char *unit;
    double minimum;
} readable;

typedef struct dimension_entry {
    imk_dimension dimension; /* metre, second, radian, kelvin, count, kilogram, ampere: halves */
    const char *name;
    const char *examples;
    readable units[READABLE_MAX]; /* from small to large; the first serves everything below */
} dimension_entry;

static const dimension_entry entries[] = {
    {{{0, 0, 0, 0, 0}}, "a ratio", "ppm, % or 1", {{"ppm", 0.0}, {"%", 1.0}, {"1", 1.0}}},
    {{{0, 2, 0, 0, 0}},
     "a time",
     "s, ms, min or h",
     {{"us", 0.0}, {"ms", 1.0}, {"s", 1.0}, {"h", 10.0}}},
    {{{0, -2, 0, 0, 0}}, "a frequency", "Hz or kHz", {{"Hz", 0.0}, {"kHz", 10.0}}},
    {{{2, 0, 0, 0, 0}},
     "a length",
     "m, mm or km",
     {{"um", 0.0}, {"mm", 0.1}, {"m", 1.0}, {"km", 10.0}}},
    {{{2, -2, 0, 0, 0}}, "a velocity", "m/s or ug*s", {{"mm/s", 0.0}, {"m/s", 0.1}}},
    {{{0, 0, 0, 2, 0}}, "a temperature", "degC or K", {{"K", 0.0}, {"degC", 150.0}}},
    {{{0, -2, 0, 2, 0}}, "a rate of temperature", "degC/min or K/s", {{"degC/min", 0.0}}},
    {{{0, 0, 0, 0, 2}}, "a number of counts", "count", {{"count", 0.0}}},

    /* gyros */
    {{{0, 0, 2, 0, 0}},
     "an angle",
     "deg, mrad, urad or arcsec",
     {{"urad", 0.0}, {"mrad", 0.1}, {"deg", 1.0}}},
    {{{0, -2, 2, 0, 0}},
     "an angular rate",
     "deg/h, deg/s or rad/s",
     {{"deg/h", 0.0}, {"deg/s", 0.1}}},
    {{{0, -4, 2, 0, 0}},
     "an angular acceleration or rate ramp",
     "deg/h/h, deg/s^2 or rad/s^2",
     {{"deg/h/h", 0.0}, {"deg/s^2", 0.01}}},
    {{{0, -1, 2, 0, 0}},
     "a white-noise density of angular rate (angle random walk)",
     "deg/sqrt(h) or rad/s/sqrt(Hz)",
     {{"deg/sqrt(h)", 0.0}}},
    {{{0, -3, 2, 0, 0}},
     "a rate random walk",
     "deg/h/sqrt(h) or rad/s/sqrt(s)",
     {{"deg/h/sqrt(h)", 0.0}}},
    {{{0, -2, 4, 0, 0}},
     "a power spectral density of angular rate",
     "(deg/h)^2/Hz or (rad/s)^2/Hz",
     {{"(deg/h)^2/Hz", 0.0}, {"(deg/s)^2/Hz", 0.01}}},
    {{{0, -4, 4, 0, 0}},
     "a squared angular rate",
     "(deg/h)^2 or (rad/s)^2",
     {{"(deg/h)^2", 0.0}, {"(deg/s)^2", 0.01}}},
    {{{-2, 2, 2, 0, 0}},
     "an angular rate per specific force (g-sensitivity)",
     "deg/h/g or rad/s/(m/s^2)",
     {{"deg/h/g", 0.0}, {"deg/s/g", 0.1}}},
    {{{-4, 6, 2, 0, 0}},
     "an angular rate per squared specific force (g^2-sensitivity)",
     "deg/h/g^2 or rad/s/(m/s^2)^2",
     {{"deg/h/g^2", 0.0}, {"deg/s/g^2", 0.1}}},
    {{{0, 0, 2, -2, 0}},
     "an angular rate per rate of temperature",
     "deg/h/(degC/min) or rad/s/(K/s)",
     {{"deg/h/(degC/min)", 0.0}}},
    {{{0, -2, 2, -2, 0}}, "an angular rate per temperature", "deg/h/degC", {{"deg/h/degC", 0.0}}},
    {{{0, -2, 2, -4, 0}},
     "an angular rate per squared temperature",
     "deg/h/degC^2",
     {{"deg/h/degC^2", 0.0}}},
    {{{0, -2, 2, -6, 0}},
     "an angular rate per cubed temperature",
     "deg/h/degC^3",
     {{"deg/h/degC^3", 0.0}}},
    {{{0, -2, 2, -8, 0}},
     "an angular rate per fourth power of temperature",
     "deg/h/degC^4",
     {{"deg/h/degC^4", 0.0}}},
    {{{0, -2, 2, -10, 0}},
     "an angular rate per fifth power of temperature",
     "deg/h/degC^5",
     {{"deg/h/degC^5", 0.0}}},
    {{{0, 2, -2, 0, 0}},
     "a ratio per angular rate",
     "ppm/(deg/s) or 1/(rad/s)",
     {{"ppm/(deg/s)", 0.0}}},
    {{{0, 4, -4, 0, 0}},
     "a ratio per squared angular rate",
     "ppm/(deg/s)^2 or 1/(rad/s)^2",
     {{"ppm/(deg/s)^2", 0.0}}},
    {{{0, 2, -2, 0, 2}},
     "a number of counts per angular rate",
     "count/(deg/s) or count/(rad/s)",
     {{"count/(deg/s)", 0.0}}},

    /* accelerometers */
    {{{2, -4, 0, 0, 0}},
     "a specific force or acceleration",
     "mg, ug, g or m/s^2",
     {{"ug", 0.0}, {"mg", 1.0}, {"m/s^2", 1.0}}},
    {{{2, -6, 0, 0, 0}},
     "an acceleration ramp",
     "ug/h or m/s^3",
     {{"ug/h", 0.0}, {"mg/s", 0.01}, {"m/s^3", 1.0}}},
    {{{2, -3, 0, 0, 0}},
     "a white-noise density of specific force (velocity random walk)",
     "ug/sqrt(Hz) or m/s/sqrt(h)",
     {{"ug/sqrt(Hz)", 0.0}}},
    {{{2, -5, 0, 0, 0}},
     "an acceleration random walk",
     "ug/sqrt(h) or m/s^2/sqrt(s)",
     {{"ug/sqrt(h)", 0.0}}},
    {{{2, -1, 0, 0, 0}},
     "a white-noise density of velocity",
     "m/s/sqrt(Hz) or m/s*sqrt(s)",
     {{"m/s/sqrt(Hz)", 0.0}}},
    {{{4, -6, 0, 0, 0}},
     "a power spectral density of specific force",
     "ug^2/Hz or (m/s^2)^2/Hz",
     {{"ug^2/Hz", 0.0}}},
    {{{4, -8, 0, 0, 0}},
     "a squared specific force",
     "ug^2 or (m/s^2)^2",
     {{"ug^2", 0.0}, {"(m/s^2)^2", 0.01}}},
    {{{2, -2, 0, -2, 0}},
     "a specific force per rate of temperature",
     "mg/(degC/min) or m/s^2/(K/s)",
     {{"ug/(degC/min)", 0.0}, {"mg/(degC/min)", 1.0}}},
    {{{2, -4, 0, -2, 0}},
     "a specific force per temperature",
     "ug/degC or mg/degC",
     {{"ug/degC", 0.0}, {"mg/degC", 1.0}}},
    {{{2, -4, 0, -4, 0}},
     "a specific force per squared temperature",
     "ug/degC^2",
     {{"ug/degC^2", 0.0}}},
    {{{2, -4, 0, -6, 0}},
     "a specific force per cubed temperature",
     "ug/degC^3",
     {{"ug/degC^3", 0.0}}},
    {{{2, -4, 0, -8, 0}},
     "a specific force per fourth power of temperature",
     "ug/degC^4",
     {{"ug/degC^4", 0.0}}},
    {{{2, -4, 0, -10, 0}},
     "a specific force per fifth power of temperature",
     "ug/degC^5",
     {{"ug/degC^5", 0.0}}},
    {{{-2, 4, 0, 0, 0}}, "a ratio per specific force", "ppm/g or 1/(m/s^2)", {{"ppm/g", 0.0}}},
    {{{-4, 8, 0, 0, 0}},
     "a ratio per squared specific force",
     "ppm/g^2 or 1/(m/s^2)^2",
     {{"ppm/g^2", 0.0}}},
    {{{-2, 4, 0, 0, 2}},
     "a number of counts per specific force",
     "count/g or count/(m/s^2)",
     {{"count/g", 0.0}}},

    /* magnetometers */
    {{{0, -4, 0, 0, 0, 2, -2}},
     "a magnetic flux density",
     "uT, nT or gauss",
     {{"nT", 0.0}, {"uT", 0.1}, {"mT", 1.0}}},
    {{{0, -3, 0, 0, 0, 2, -2}},
     "a white-noise density of magnetic flux density",
     "nT/sqrt(Hz)",
     {{"nT/sqrt(Hz)", 0.0}}},
    {{{0, -5, 0, 0, 0, 2, -2}},
     "a random walk of magnetic flux density",
     "nT/sqrt(h) or T/sqrt(s)",
     {{"nT/sqrt(h)", 0.0}}},
    {{{0, -6, 0, 0, 0, 2, -2}}, "a ramp of magnetic flux density", "nT/h or T/s", {{"nT/h", 0.0}}},
    {{{0, -2, 0, -2, 0, 2, -2}},
     "a magnetic flux density per rate of temperature",
     "nT/(degC/min) or T/(K/s)",
     {{"nT/(degC/min)", 0.0}}},
    {{{0, -4, 0, -2, 0, 2, -2}},
     "a magnetic flux density per temperature",
     "nT/degC",
     {{"nT/degC", 0.0}}},
    {{{0, -4, 0, -4, 0, 2, -2}},
     "a magnetic flux density per squared temperature",
     "nT/degC^2",
     {{"nT/degC^2", 0.0}}},
    {{{0, -4, 0, -6, 0, 2, -2}},
     "a magnetic flux density per cubed temperature",
     "nT/degC^3",
     {{"nT/degC^3", 0.0}}},
    {{{0, -4, 0, -8, 0, 2, -2}},
     "a magnetic flux density per fourth power of temperature",
     "nT/degC^4",
     {{"nT/degC^4", 0.0}}},
    {{{0, -4, 0, -10, 0, 2, -2}},
     "a magnetic flux density per fifth power of temperature",
     "nT/degC^5",
     {{"nT/degC^5", 0.0}}},
    {{{0, 4, 0, 0, 2, -2, 2}},
     "a number of counts per magnetic flux density",
     "count/uT or count/gauss",
     {{"count/uT", 0.0}}},

    /* scale factors over temperature */
    {{{0, 0, 0, -2, 0}}, "a ratio per temperature", "ppm/degC or 1/K", {{"ppm/degC", 0.0}}},
    {{{0, 0, 0, -4, 0}}, "a ratio per squared temperature", "ppm/degC^2", {{"ppm/degC^2", 0.0}}},
    {{{0, 0, 0, -6, 0}}, "a ratio per cubed temperature", "ppm/degC^3", {{"ppm/degC^3", 0.0}}},
    {{{0, 0, 0, -8, 0}},
     "a ratio per fourth power of temperature",
     "ppm/degC^4",
     {{"ppm/degC^4", 0.0}}},
    {{{0, 0, 0, -10, 0}},
     "a ratio per fifth power of temperature",
     "ppm/degC^5",
     {{"ppm/degC^5", 0.0}}},

    /* what instruments are made of: size, mass, force, electricity */
    {{{4, 0, 0, 0, 0, 0, 0}},
     "an area",
     "mm^2, um^2 or m^2",
     {{"um^2", 0.0}, {"mm^2", 0.01}, {"m^2", 0.01}}},
    {{{6, 0, 0, 0, 0, 0, 0}}, "a volume", "mm^3 or m^3", {{"mm^3", 0.0}}},
    {{{-2, 0, 0, 0, 0, 0, 0}},
     "a number or attenuation per length",
     "dB/km, 1/mm or 1/m",
     {{"1/m", 0.0}}},
    {{{2, 0, 0, -2, 0, 0, 0}}, "a length per temperature", "nm/K or um/K", {{"nm/K", 0.0}}},
    {{{0, 1, 2, 0, 0, 0, 0}},
     "a white-noise density of angle",
     "arcsec/sqrt(Hz) or urad/sqrt(Hz)",
     {{"urad/sqrt(Hz)", 0.0}}},
    {{{2, 1, 0, 0, 0, 0, 0}},
     "a white-noise density of displacement",
     "pm/sqrt(Hz) or m/sqrt(Hz)",
     {{"pm/sqrt(Hz)", 0.0}}},
    {{{0, 1, 0, 0, 0, 0, 0}},
     "a white-noise density of a ratio",
     "1/sqrt(Hz) or ppm/sqrt(Hz)",
     {{"ppm/sqrt(Hz)", 0.0}}},
    {{{0, -2, 0, -2, 0, 0, 0}}, "a frequency per temperature", "Hz/K", {{"Hz/K", 0.0}}},
    {{{-2, 2, 0, 0, 0, 0, 0}},
     "a frequency per acceleration",
     "Hz/g or 1/s/(m/s^2)",
     {{"Hz/g", 0.0}}},
    {{{0, 0, -2, 0, 0, 0, 0}}, "a number per angle", "1/rad or 1/arcsec", {{"1/rad", 0.0}}},
    {{{-2, 0, 2, 0, 0, 0, 0}}, "an angle per length", "mrad/mm or rad/m", {{"rad/m", 0.0}}},
    {{{0, 0, 0, 0, 0, 2, 0}},
     "a mass",
     "kg, gram, milligram or microgram",
     {{"microgram", 0.0}, {"milligram", 1.0}, {"gram", 1.0}, {"kg", 1.0}}},
    {{{-6, 0, 0, 0, 0, 2, 0}}, "a density", "kg/m^3", {{"kg/m^3", 0.0}}},
    {{{2, 0, 0, 0, 0, 2, 0}},
     "a mass times length (pendulosity, unbalance)",
     "gram*cm or kg*m",
     {{"gram*cm", 0.0}, {"kg*m", 1.0}}},
    {{{4, 0, 0, 0, 0, 2, 0}},
     "a moment of inertia",
     "gram*cm^2 or kg*m^2",
     {{"gram*cm^2", 0.0}, {"kg*m^2", 0.01}}},
    {{{4, -2, 0, 0, 0, 2, 0}},
     "an angular momentum",
     "gram*cm^2/s, N*m*s or kg*m^2/s",
     {{"gram*cm^2/s", 0.0}, {"N*m*s", 0.001}}},
    {{{2, -4, 0, 0, 0, 2, 0}},
     "a force",
     "uN, mN or N",
     {{"nN", 0.0}, {"uN", 1.0}, {"mN", 1.0}, {"N", 1.0}}},
    {{{2, -3, 0, 0, 0, 2, 0}},
     "a white-noise density of force",
     "N/sqrt(Hz)",
     {{"N/sqrt(Hz)", 0.0}}},
    {{{4, -4, 0, 0, 0, 2, 0}},
     "a torque or energy",
     "nN*m, mN*m, N*m or J",
     {{"nN*m", 0.0}, {"uN*m", 1.0}, {"mN*m", 1.0}, {"N*m", 1.0}}},
    {{{4, -3, 0, 0, 0, 2, 0}},
     "a white-noise density of torque",
     "N*m/sqrt(Hz)",
     {{"N*m/sqrt(Hz)", 0.0}}},
    {{{4, -5, 0, 0, 0, 2, 0}},
     "a random walk of torque",
     "N*m/sqrt(h) or N*m/sqrt(s)",
     {{"N*m/sqrt(h)", 0.0}}},
    {{{4, -4, -2, 0, 0, 2, 0}}, "a torsional stiffness", "N*m/rad", {{"N*m/rad", 0.0}}},
    {{{4, -2, -2, 0, 0, 2, 0}}, "a torsional damping", "N*m*s/rad", {{"N*m*s/rad", 0.0}}},
    {{{0, -4, 0, 0, 0, 2, 0}}, "a stiffness", "N/m or mN/m", {{"N/m", 0.0}}},
    {{{0, -2, 0, 0, 0, 2, 0}}, "a damping", "N*s/m", {{"N*s/m", 0.0}}},
    {{{0, 4, 0, 0, 0, -2, 0}}, "a compliance", "nm/N or m/N", {{"nm/N", 0.0}}},
    {{{4, -4, 0, -2, 0, 2, 0}}, "a torque per temperature", "nN*m/K or N*m/K", {{"nN*m/K", 0.0}}},
    {{{2, -4, 0, -2, 0, 2, 0}}, "a force per temperature", "uN/K or N/K", {{"uN/K", 0.0}}},
    {{{-2, -4, 0, 0, 0, 2, 0}},
     "a pressure or elastic modulus",
     "Pa, kPa, MPa or GPa",
     {{"Pa", 0.0}, {"kPa", 1.0}, {"MPa", 1.0}, {"GPa", 1.0}}},
    {{{-2, -2, 0, 0, 0, 2, 0}}, "a viscosity", "Pa*s", {{"Pa*s", 0.0}}},
    {{{4, -6, 0, 0, 0, 2, 0}},
     "a power",
     "nW, uW, mW or W",
     {{"nW", 0.0}, {"uW", 1.0}, {"mW", 1.0}, {"W", 1.0}}},
    {{{0, 0, 0, 0, 0, 0, 2}},
     "an electric current",
     "nA, uA, mA or A",
     {{"nA", 0.0}, {"uA", 1.0}, {"mA", 1.0}, {"A", 1.0}}},
    {{{0, 1, 0, 0, 0, 0, 2}},
     "a white-noise density of current",
     "pA/sqrt(Hz) or A/sqrt(Hz)",
     {{"pA/sqrt(Hz)", 0.0}}},
    {{{0, 2, 0, 0, 0, 0, 2}}, "an electric charge", "A*s", {{"A*s", 0.0}}},
    {{{4, -6, 0, 0, 0, 2, -2}}, "a voltage", "uV, mV or V", {{"uV", 0.0}, {"mV", 1.0}, {"V", 1.0}}},
    {{{4, -5, 0, 0, 0, 2, -2}},
     "a white-noise density of voltage",
     "nV/sqrt(Hz) or V/sqrt(Hz)",
     {{"nV/sqrt(Hz)", 0.0}}},
    {{{2, -6, 0, 0, 0, 2, -2}}, "an electric field", "V/m or V/mm", {{"V/m", 0.0}}},
    {{{4, -6, -2, 0, 0, 2, -2}}, "a voltage per angle", "V/rad or mV/deg", {{"V/rad", 0.0}}},
    {{{4, -6, 0, 0, 0, 2, -4}},
     "a resistance",
     "ohm, kohm or Mohm",
     {{"ohm", 0.0}, {"kohm", 1.0}, {"Mohm", 1.0}}},
    {{{-4, 8, 0, 0, 0, -2, 4}},
     "a capacitance",
     "fF, pF, nF or uF",
     {{"fF", 0.0}, {"pF", 1.0}, {"nF", 1.0}, {"uF", 1.0}}},
    {{{-6, 8, 0, 0, 0, -2, 4}}, "a capacitance per length", "pF/um or F/m", {{"pF/um", 0.0}}},
    {{{-4, 6, 0, 0, 0, -2, 2}},
     "a current per power (responsivity)",
     "A/W or mA/mW",
     {{"A/W", 0.0}}},
    {{{2, -4, 0, 0, 0, 2, -2}}, "a force per current", "N/A or mN/mA", {{"N/A", 0.0}}},
    {{{4, -4, 0, 0, 0, 2, -2}}, "a torque per current", "N*m/A or mN*m/A", {{"N*m/A", 0.0}}},
};

bool imk_dimension_equal(imk_dimension a, imk_dimension b)
{
    return memcmp(a.half, b.half, sizeof a.half) == 0;
}

static const dimension_entry *find(imk_dimension dimension)
{
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
        if (imk_dimension_equal(entries[i].dimension, dimension))
            return &entries[i];
    }
    return NULL;
}

bool imki_dimension_known(imk_dimension dimension)
{
    return find(dimension) != NULL;
}

const char *imk_dimension_name(imk_dimension dimension)
{
    const dimension_entry *entry = find(dimension);
    return entry ? entry->name : "a quantity of an unusual dimension";
}

const char *imk_dimension_examples(imk_dimension dimension)
{
    const dimension_entry *entry = find(dimension);
    return entry ? entry->examples : "a product of SI units";
}

imk_unit imk_unit_readable(imk_dimension dimension, double magnitude)
{
    const dimension_entry *entry = find(dimension);
    char text[IMKI_SI_TEXT_SIZE] = {0};
    if (!entry) {
        imk_unit si = {.scale = 1.0, .dimension = dimension};
        imki_unit_si_text(dimension, false, text);
        memcpy(si.text, text, sizeof si.text - 1); /* no unit met in practice is longer */
        return si;
    }
    imk_unit best = imk_unit_of(entry->units[0].unit);
    for (size_t i = 1; i < READABLE_MAX && entry->units[i].unit; i++) {
        const imk_unit larger = imk_unit_of(entry->units[i].unit);
        /* A hair below the limit counts, so that 1 mg in m/s^2 is not 1000 ug by a rounding. */
        if (fabs(magnitude) >= entry->units[i].minimum * larger.scale * (1.0 - 1e-9))
            best = larger;
    }
    return best;
}

/* ---- SI text -------------------------------------------------------------------------------- */

typedef struct writer {
    char *text;
    size_t length;
} writer;

static void put(writer *w, const char *text)
{
    const size_t length = strlen(text);
    memcpy(w->text + w->length, text, length + 1);
    w->length += length;
}

/* name^(half/2), |half| <= 128: at most 5 characters behind the name. */
static void put_power(writer *w, const char *name, int half)
{
    char number[8];
    size_t at = sizeof number;
    put(w, name);
    if (half == 2)
        return;
    number[--at] = '\0';
    if (half % 2 != 0) {
        number[--at] = '5';
        number[--at] = '.';
    }
    int whole = half / 2;
    do
        number[--at] = (char)('0' + whole % 10);
    while ((whole /= 10) > 0);
    number[--at] = '^';
    put(w, number + at);
}

void imki_unit_si_text(imk_dimension dimension, bool per_root_hertz, char text[IMKI_SI_TEXT_SIZE])
{
    static const char *const names[] = {"m", "s", "rad", "K", "count", "kg", "A"};
    static const int order[] = {IMK_COUNT,  IMK_RADIAN, IMK_KILOGRAM, IMK_METRE,
                                IMK_AMPERE, IMK_KELVIN, IMK_SECOND};
    writer w = {text, 0};
    text[0] = '\0';
    if (per_root_hertz)
        dimension.half[IMK_SECOND] = (int8_t)(dimension.half[IMK_SECOND] - 1);
    for (size_t i = 0; i < IMKI_DIMENSIONS; i++) {
        const int half = dimension.half[order[i]];
        if (half > 0) {
            put(&w, w.length > 0 ? "*" : "");
            put_power(&w, names[order[i]], half);
        }
    }
    if (w.length == 0)
        put(&w, "1");
    for (size_t i = 0; i < IMKI_DIMENSIONS; i++) {
        const int half = dimension.half[order[i]];
        if (half < 0) {
            put(&w, "/");
            put_power(&w, names[order[i]], -half);
        }
    }
    if (per_root_hertz)
        put(&w, "/sqrt(Hz)");
}

size_t imk_dimension_si(imk_dimension dimension, char *text, size_t size)
{
    char whole[IMKI_SI_TEXT_SIZE];
    imki_unit_si_text(dimension, false, whole);
    const size_t length = strlen(whole);
    if (length >= size)
        return 0;
    memcpy(text, whole, length + 1);
    return length;
}
