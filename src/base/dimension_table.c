/* SPDX-License-Identifier: Apache-2.0 */
/* What the dimensions of a sensor model are called, and the units people use for them. */
#include "imukit/units.h"

#include "base/unit_table_internal.h"

#include <math.h>
#include <string.h>

enum { READABLE_MAX = 4 };

/* A usual unit, for magnitudes from `minimum` of that unit up to the next one's. */
typedef struct readable {
    const char *unit;
    double minimum;
} readable;

typedef struct dimension_entry {
    imk_dimension dimension; /* metre, second, radian, kelvin, count, in halves */
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
    char text[48];
    if (!entry) {
        imki_unit_si_text(dimension, false, text);
        return imk_unit_of(text);
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

/* name^(half/2); |half| <= 128, so at most 4 characters of exponent. */
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

void imki_unit_si_text(imk_dimension dimension, bool per_root_hertz, char text[48])
{
    static const char *const names[] = {"m", "s", "rad", "K", "count"};
    static const int order[] = {IMK_COUNT, IMK_RADIAN, IMK_METRE, IMK_KELVIN, IMK_SECOND};
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
