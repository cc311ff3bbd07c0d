/* SPDX-License-Identifier: Apache-2.0 */
/* Units: every spelling of the model file and the log, their SI values from the definitions (the
 * degree as pi/180, g = 9.80665 m/s^2 by the CGPM of 1901), the refusals, and the quantities. */
#include "check.h"

#include "imukit/decimal.h"
#include "imukit/units.h"

#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define DEG (3.14159265358979323846 / 180.0)
#define G 9.80665

static imk_status parse(const char *text, imk_unit *unit, imk_error *error)
{
    return imk_unit_parse(text, text + strlen(text), unit, error);
}

typedef struct spelling {
    const char *text;
    const char *same_as; /* SI units of the same dimension */
    double scale;
    bool per_root_hertz;
} spelling;

/* Scales come from products of a few roundings, so they agree to a few ulp. */
static void check_spellings(const spelling *spellings, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        imk_unit unit = {0};
        imk_error error;
        if (parse(spellings[i].text, &unit, &error) != IMK_OK)
            fail_msg("%s: %s %s", spellings[i].text, error.found, error.expected);
        if (!imk_dimension_equal(unit.dimension, imk_unit_of(spellings[i].same_as).dimension))
            fail_msg("%s is not like %s", spellings[i].text, spellings[i].same_as);
        if (!(fabs(unit.scale / spellings[i].scale - 1.0) < 1e-15))
            fail_msg("%s is %.17g, expected %.17g", spellings[i].text, unit.scale,
                     spellings[i].scale);
        if (unit.per_root_hertz != spellings[i].per_root_hertz)
            fail_msg("%s: per root hertz", spellings[i].text);
        assert_string_equal(unit.text, spellings[i].text);
    }
}

static void simple_units_have_their_defined_size(void **state)
{
    (void)state;
    static const spelling spellings[] = {
        {"rad", "rad", 1.0, false},
        {"mrad", "rad", 1e-3, false},
        {"urad", "rad", 1e-6, false},
        {"µrad", "rad", 1e-6, false},
        {"μrad", "rad", 1e-6, false},
        {"deg", "rad", DEG, false},
        {"°", "rad", DEG, false},
        {"arcsec", "rad", DEG / 3600.0, false},
        {"arc-sec", "rad", DEG / 3600.0, false},
        {"s", "s", 1.0, false},
        {"ms", "s", 1e-3, false},
        {"us", "s", 1e-6, false},
        {"milliseconds", "s", 1e-3, false},
        {"microseconds", "s", 1e-6, false},
        {"nanoseconds", "s", 1e-9, false},
        {"µs", "s", 1e-6, false},
        {"min", "s", 60.0, false},
        {"h", "s", 3600.0, false},
        {"hr", "s", 3600.0, false},
        {"hour", "s", 3600.0, false},
        {"Hz", "1/s", 1.0, false},
        {"kHz", "1/s", 1e3, false},
        {"m", "m", 1.0, false},
        {"mm", "m", 1e-3, false},
        {"um", "m", 1e-6, false},
        {"km", "m", 1e3, false},
        {"nmi", "m", 1852.0, false},
        {"g", "m/s^2", G, false},
        {"mg", "m/s^2", 1e-3 * G, false},
        {"ug", "m/s^2", 1e-6 * G, false},
        {"µg", "m/s^2", 1e-6 * G, false},
        {"Gal", "m/s^2", 1e-2, false},
        {"mGal", "m/s^2", 1e-5, false},
        {"count", "count", 1.0, false},
        {"LSB", "count", 1.0, false},
        {"ppm", "1", 1e-6, false},
        {"%", "1", 1e-2, false},
        {"1", "1", 1.0, false},
        {"K", "K", 1.0, false},
        {"dps", "rad/s", DEG, false},
        {"  mg ", "m/s^2", 1e-3 * G, false},
    };
    check_spellings(spellings, COUNT(spellings) - 1);
    imk_unit unit;
    CHECK_OK(parse("  mg ", &unit, NULL));
    assert_string_equal(unit.text, "mg");
}

static void compound_units_follow_from_their_parts(void **state)
{
    (void)state;
    static const spelling spellings[] = {
        {"deg/h", "rad/s", DEG / 3600.0, false},
        {"deg/hr", "rad/s", DEG / 3600.0, false},
        {"°/s", "rad/s", DEG, false},
        {"deg h^-1", "rad/s", DEG / 3600.0, false},
        {"deg·h⁻¹", "rad/s", DEG / 3600.0, false},
        {"deg / h", "rad/s", DEG / 3600.0, false},
        {"m/s2", "m/s^2", 1.0, false},
        {"m/s²", "m/s^2", 1.0, false},
        {"m/s/s", "m/s^2", 1.0, false},
        {"m s^-2", "m/s^2", 1.0, false},
        {"m s-2", "m/s^2", 1.0, false},
        {"rad s-1", "rad/s", 1.0, false},
        {"kg m2 s-3", "kg m^2/s^3", 1.0, false},
        {"m*s^(-2)", "m/s^2", 1.0, false},
        {"deg/sqrt(h)", "rad/s^0.5", DEG / 60.0, false},
        {"deg/√h", "rad/s^0.5", DEG / 60.0, false},
        {"°/√hr", "rad/s^0.5", DEG / 60.0, false},
        {"deg/√(h)", "rad/s^0.5", DEG / 60.0, false},
        {"deg/rt-hr", "rad/s^0.5", DEG / 60.0, false},
        {"°/rt-hr", "rad/s^0.5", DEG / 60.0, false},
        {"deg/rthr", "rad/s^0.5", DEG / 60.0, false},
        {"deg/root-hour", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h^½", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h½", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h^0.5", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h^1/2", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h^(1/2)", "rad/s^0.5", DEG / 60.0, false},
        {"deg*h^-0.5", "rad/s^0.5", DEG / 60.0, false},
        {"deg/h/sqrt(Hz)", "rad/s^0.5", DEG / 3600.0, true},
        {"(deg/h)/√Hz", "rad/s^0.5", DEG / 3600.0, true},
        {"dps/rt-Hz", "rad/s^0.5", DEG, true},
        {"rad/s/√Hz", "rad/s^0.5", 1.0, true},
        {"mdps/√Hz", "rad/s^0.5", 1e-3 * DEG, true},
        {"sqrt(deg^2/s^2/Hz)", "rad/s^0.5", DEG, true},
        {"(rad/s)^2/Hz", "rad^2/s", 1.0, false},
        {"ug/sqrt(Hz)", "m/s^1.5", 1e-6 * G, true},
        {"µg/√Hz", "m/s^1.5", 1e-6 * G, true},
        {"mg/Hz^0.5", "m/s^1.5", 1e-3 * G, true},
        {"m/s/sqrt(h)", "m/s^1.5", 1.0 / 60.0, false},
        {"m/s^1.5", "m/s^1.5", 1.0, false},
        {"m/s^3/2", "m/s^1.5", 1.0, false},
        {"m/s^2/sqrt(Hz)", "m/s^1.5", 1.0, true},
        {"rad/s^1.5", "rad/s^1.5", 1.0, false},
        {"deg/h/h", "rad/s^2", DEG / 3600.0 / 3600.0, false},
        {"deg/h^2", "rad/s^2", DEG / 3600.0 / 3600.0, false},
        {"deg/h/sqrt(h)", "rad/s^1.5", DEG / 3600.0 / 60.0, false},
        {"deg/h^1.5", "rad/s^1.5", DEG / 3600.0 / 60.0, false},
        {"m/s^2/sqrt(s)", "m/s^2.5", 1.0, false},
        {"deg/h/g", "rad*s/m", DEG / 3600.0 / G, false},
        {"deg/h/g^2", "rad*s^3/m^2", DEG / 3600.0 / (G * G), false},
        {"deg/h/g²", "rad*s^3/m^2", DEG / 3600.0 / (G * G), false},
        {"deg/(h g)", "rad*s/m", DEG / 3600.0 / G, false},
        {"ppm/g", "s^2/m", 1e-6 / G, false},
        {"ppm/degC", "1/K", 1e-6, false},
        {"degC/min", "K/s", 1.0 / 60.0, false},
        {"deg/h/(degC/min)", "rad/K", DEG / 3600.0 * 60.0, false},
        {"count/(rad/s)", "count*s/rad", 1.0, false},
        {"LSB/(°/s)", "count*s/rad", 1.0 / DEG, false},
        {"LSB/g", "count*s^2/m", 1.0 / G, false},
        {"ug*s", "m/s", 1e-6 * G, false},
        {"g·s", "m/s", G, false},
        {"1/s", "Hz", 1.0, false},
    };
    check_spellings(spellings, COUNT(spellings));
    /* One rounding only, so exact. */
    CHECK_RELATIVE(imk_unit_of("deg").scale, DEG, 0.0);
    CHECK_RELATIVE(imk_unit_of("g").scale, G, 0.0);
    CHECK_RELATIVE(imk_unit_of("deg h^-1").scale, imk_unit_of("deg/h").scale, 0.0);
}

/* The units of designs: SI prefixes as the SI brochure defines them, dB of a power as ln(10)/10
 * (0.230258509299404568… by multiprecision), products by the definitions of N, J, W, V, ohm, F. */
static void units_of_designs_follow_from_kilogram_and_ampere(void **state)
{
    (void)state;
    static const spelling spellings[] = {
        {"kg", "kg", 1.0, false},
        {"gram", "kg", 1e-3, false},
        {"milligram", "kg", 1e-6, false},
        {"microgram", "kg", 1e-9, false},
        {"N", "kg*m/s^2", 1.0, false},
        {"mN", "kg*m/s^2", 1e-3, false},
        {"uN", "kg m/s^2", 1e-6, false},
        {"nN", "kg*m/s^2", 1e-9, false},
        {"pN", "kg*m/s^2", 1e-12, false},
        {"N m", "kg*m^2/s^2", 1.0, false},
        {"Nm", "J", 1.0, false},
        {"mN m", "N*m", 1e-3, false},
        {"N·m/rad", "kg*m^2/s^2/rad", 1.0, false},
        {"kg m^2", "kg*m^2", 1.0, false},
        {"gram*cm^2", "kg*m^2", 1e-7, false},
        {"N m s", "kg*m^2/s", 1.0, false},
        {"GPa", "N/m^2", 1e9, false},
        {"W", "J/s", 1.0, false},
        {"uW", "V*A", 1e-6, false},
        {"µW", "W", 1e-6, false},
        {"nW", "W", 1e-9, false},
        {"mV", "W/A", 1e-3, false},
        {"uV", "V", 1e-6, false},
        {"kV", "V", 1e3, false},
        {"V/m", "N/A/s", 1.0, false},
        {"nV/sqrt(Hz)", "V*s^0.5", 1e-9, true},
        {"mA", "A", 1e-3, false},
        {"uA", "A", 1e-6, false},
        {"nA", "A", 1e-9, false},
        {"pA/√Hz", "A*s^0.5", 1e-12, true},
        {"ohm", "V/A", 1.0, false},
        {"\u03a9", "V/A", 1.0, false},
        {"k\u2126", "V/A", 1e3, false},
        {"pF", "A*s/V", 1e-12, false},
        {"fF", "F", 1e-15, false},
        {"uF", "F", 1e-6, false},
        {"A/W", "1/V", 1.0, false},
        {"pm", "m", 1e-12, false},
        {"THz", "1/s", 1e12, false},
        {"GHz", "Hz", 1e9, false},
        {"dB/km", "1/m", 0.230258509299404568e-3, false},
        {"rev/s", "rad/s", 360.0 * DEG, false},
        {"rpm", "rad/s", 6.0 * DEG, false},
        {"1/Hz", "s", 1.0, false},
        {"ppm/K", "1/K", 1e-6, false},
        {"1/K", "1/K", 1.0, false},
        {"urad/sqrt(Hz)", "rad*s^0.5", 1e-6, true},
        {"N/sqrt(Hz)", "kg*m/s^1.5", 1.0, true},
        {"N m/A", "V*s", 1.0, false},
    };
    check_spellings(spellings, COUNT(spellings));
    /* kilogram and ampere in the order of the SI text */
    const imk_unit odd = imk_unit_readable(imk_unit_of("V*rad/K").dimension, 1.0);
    assert_string_equal(odd.text, "rad*kg*m^2/A/K/s^3");
    CHECK_CLOSE(odd.scale, 1.0, 0.0);
    char si[48];
    assert_int_equal(imk_dimension_si(imk_unit_of("mW").dimension, si, sizeof si), 10);
    assert_string_equal(si, "kg*m^2/s^3");
    assert_int_equal(imk_dimension_si(imk_unit_of("mW").dimension, si, 10), 0);
    assert_int_equal(imk_dimension_si(imk_unit_of("%").dimension, si, sizeof si), 1);
    /* the longest there is needs more than a unit's text can hold; nothing is overrun */
    const imk_unit longest = imk_unit_of("(count*rad*kg*m*A*K*s)^29.5");
    const imk_unit scaled = imk_unit_of("(count*rad*kg*m*A*K*s)^29.5*ppm");
    const double value = (double)NAN;
    char text[160];
    assert_int_equal(longest.dimension.half[IMK_AMPERE], 59);
    assert_true(imk_quantity_format(&value, NULL, 1, &scaled, text, sizeof text) > 0);
    assert_string_equal(text, "nan count^29.5*rad^29.5*kg^29.5*m^29.5*A^29.5*K^29.5*s^29.5");
    const imk_unit of_longest = imk_unit_readable(longest.dimension, 1.0);
    assert_true(imk_dimension_equal(of_longest.dimension, longest.dimension));
    CHECK_CLOSE(of_longest.scale, 1.0, 0.0);
}

static void celsius_is_shifted_only_by_itself(void **state)
{
    (void)state;
    CHECK_CLOSE(imk_unit_of("degC").offset, 273.15, 0.0);
    CHECK_CLOSE(imk_unit_of("°C").offset, 273.15, 0.0);
    CHECK_CLOSE(imk_unit_of("degC/min").offset, 0.0, 0.0);
    CHECK_CLOSE(imk_unit_of("1/degC").offset, 0.0, 0.0);
    CHECK_CLOSE(imk_unit_of("deg/h/(degC/min)").offset, 0.0, 0.0);
    CHECK_CLOSE(imk_unit_of("degC^2").offset, 0.0, 0.0);
}

static void angle_and_frequency_are_not_mixed(void **state)
{
    (void)state;
    const char *const different[][2] = {{"rad/s", "Hz"},
                                        {"deg", "1"},
                                        {"deg/h", "deg/sqrt(h)"},
                                        {"ug", "ug/sqrt(Hz)"},
                                        {"count", "1"},
                                        {"K", "1"},
                                        {"m", "s"}};
    for (size_t i = 0; i < COUNT(different); i++)
        assert_false(imk_dimension_equal(imk_unit_of(different[i][0]).dimension,
                                         imk_unit_of(different[i][1]).dimension));
}

static void unknown_units_are_refused_with_the_nearest(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        imk_status status;
        const char *found, *expected; /* NULL: any */
    } cases[] = {
        {"", IMK_ERROR_UNIT_MISSING, "", NULL},
        {"  ", IMK_ERROR_UNIT_MISSING, "", NULL},
        {"degg/h", IMK_ERROR_UNIT_UNKNOWN, "degg", "deg"},
        {"deg/hourr", IMK_ERROR_UNIT_UNKNOWN, "hourr", "hour"},
        {"arcsek", IMK_ERROR_UNIT_UNKNOWN, "arcsek", "arcsec"},
        {"Deg/h", IMK_ERROR_UNIT_UNKNOWN, "Deg", "deg"},
        {"furlong", IMK_ERROR_UNIT_UNKNOWN, "furlong", NULL},
        {"mmin", IMK_ERROR_UNIT_UNKNOWN, "mmin", NULL}, /* no prefix is put to what has none */
        {"deg/", IMK_ERROR_SYNTAX, "deg/", NULL},
        {"/h", IMK_ERROR_SYNTAX, "/h", NULL},
        {"deg//h", IMK_ERROR_SYNTAX, "deg//h", NULL},
        {"deg/(h", IMK_ERROR_SYNTAX, NULL, NULL},
        {"deg)/h", IMK_ERROR_SYNTAX, NULL, NULL},
        {"sqrt(Hz", IMK_ERROR_SYNTAX, NULL, NULL},
        {"m/s^", IMK_ERROR_SYNTAX, NULL, NULL},
        {"m/s^0.3", IMK_ERROR_SYNTAX, NULL, NULL},
        {"m^99", IMK_ERROR_SYNTAX, NULL, NULL},
        {"sqrt(sqrt(s))", IMK_ERROR_SYNTAX, NULL, NULL},
        {"deg/h sqrt(Hz)", IMK_ERROR_SYNTAX, NULL, "write brackets, or a / before each divisor"},
        {"2 deg", IMK_ERROR_SYNTAX, NULL, NULL},
        {"10", IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 Hz", IMK_ERROR_SYNTAX, NULL, NULL}, /* a quantity */
        {"1^2", IMK_ERROR_SYNTAX, NULL, NULL},
        {"1*g", IMK_ERROR_SYNTAX, NULL, NULL},
        {"m/s4", IMK_ERROR_SYNTAX, NULL, NULL},
        {"((((((((((m))))))))))", IMK_ERROR_SYNTAX, NULL, NULL},
        {"m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m*m", IMK_ERROR_SYNTAX, NULL, NULL},
        {"(km^30)^30", IMK_ERROR_SYNTAX, NULL, NULL},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        imk_unit unit = {.scale = -7.0};
        imk_error error;
        const imk_status status = parse(cases[i].text, &unit, &error);
        if (status != cases[i].status || error.status != status)
            fail_msg("\"%s\": %s", cases[i].text, imk_status_name(status));
        if (cases[i].found)
            assert_string_equal(error.found, cases[i].found);
        if (cases[i].expected)
            assert_string_equal(error.expected, cases[i].expected);
        CHECK_CLOSE(unit.scale, -7.0, 0.0); /* untouched */
        CHECK_STATUS(parse(cases[i].text, &unit, NULL), cases[i].status);
    }
    CHECK_CLOSE(imk_unit_of("furlong").scale, 0.0, 0.0);
}

static imk_status quantity(const char *text, const char *like, size_t max_count, double *values,
                           double *sigmas, size_t *count, imk_error *error)
{
    return imk_quantity_parse(text, text + strlen(text), imk_unit_of(like).dimension, max_count,
                              values, sigmas, count, NULL, error);
}

static void quantities_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *text, *like;
        size_t count;
        double values[3], sigmas[3];
    } cases[] = {
        {"0.1 -0.2 0.05 ± 0.01 deg/h",
         "rad/s",
         3,
         {0.1 * DEG / 3600, -0.2 * DEG / 3600, 0.05 * DEG / 3600},
         {0.01 * DEG / 3600, 0.01 * DEG / 3600, 0.01 * DEG / 3600}},
        {"1 2 3 +- 0.1 0.2 0.3 mg",
         "m/s^2",
         3,
         {1e-3 * G, 2e-3 * G, 3e-3 * G},
         {1e-4 * G, 2e-4 * G, 3e-4 * G}},
        {"0.0501 ± 0.0003 deg/sqrt(h)", "rad/sqrt(s)", 1, {0.0501 * DEG / 60}, {0.0003 * DEG / 60}},
        {"0.0501±0.0003deg/√h", "rad/sqrt(s)", 1, {0.0501 * DEG / 60}, {0.0003 * DEG / 60}},
        {"0.2 mrad", "rad", 1, {2e-4}, {0}},
        {"1e-3 ± 2e-4 1/s", "Hz", 1, {1e-3}, {2e-4}},
        {"1e-3 +/- 2e-4 1/s", "Hz", 1, {1e-3}, {2e-4}},
        {"3 1/s", "Hz", 1, {3}, {0}},
        {"1 Hz", "Hz", 1, {1}, {0}},
        {"100Hz", "Hz", 1, {100}, {0}},
        {"0 0 1 1/s", "Hz", 3, {0, 0, 1}, {0}},
        {"0 1 0 deg/s", "rad/s", 3, {0, DEG, 0}, {0}},
        {"0.5 1", "1", 1, {0.5}, {0}},
        {"1 1", "1", 1, {1}, {0}},
        {"1 2 3 1", "1", 3, {1, 2, 3}, {0}},
        {"0.5 ± 0.1 1", "1", 1, {0.5}, {0.1}},
        {"50 %", "1", 1, {0.5}, {0}},
        {"0 ppm", "1", 1, {0}, {0}},
        {"25 ± 2 degC", "K", 1, {298.15}, {2}},
        {" 4778 count/(rad/s) ", "count*s/rad", 1, {4778}, {0}},
        {"5 min", "s", 1, {300}, {0}},
        {"8 ± -0 degC", "K", 1, {281.15}, {0}},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        double values[3] = {0}, sigmas[3] = {0};
        size_t count = 0;
        imk_error error;
        if (quantity(cases[i].text, cases[i].like, 3, values, sigmas, &count, &error) != IMK_OK)
            fail_msg("%s: %s; %s", cases[i].text, error.found, error.expected);
        assert_int_equal(count, cases[i].count);
        for (size_t k = 0; k < count; k++) {
            CHECK_RELATIVE(values[k], cases[i].values[k], 1e-15);
            CHECK_RELATIVE(sigmas[k], cases[i].sigmas[k], 1e-15);
            assert_false(signbit(sigmas[k]));
        }
    }
}

static void bad_quantities_are_refused_with_a_message(void **state)
{
    (void)state;
    static const struct {
        const char *text, *like;
        size_t max_count;
        imk_status status;
        const char *found, *expected;
    } cases[] = {
        {"0.1 deg/h", "rad/sqrt(s)", 1, IMK_ERROR_DIMENSION, "\"0.1 deg/h\" is an angular rate",
         "a white-noise density of angular rate (angle random walk) like "
         "deg/sqrt(h) or rad/s/sqrt(Hz)"},
        {"1 2 3 furlong", "m", 3, IMK_ERROR_UNIT_UNKNOWN, "furlong", "a unit such as m, mm or km"},
        {"5 degg/h", "rad/s", 3, IMK_ERROR_UNIT_UNKNOWN, "degg", "deg"},
        {"3 Hz", "rad/s", 1, IMK_ERROR_DIMENSION, "\"3 Hz\" is a frequency",
         "an angular rate like deg/h, deg/s or rad/s"},
        {"3 m^2/s", "rad/s", 1, IMK_ERROR_DIMENSION, "\"3 m^2/s\" is in m^2/s",
         "an angular rate like deg/h, deg/s or rad/s"},
        {"5 mg", "kg", 1, IMK_ERROR_DIMENSION, "\"5 mg\" is a specific force or acceleration",
         "a mass like kg, gram, milligram or microgram"},
        {"3 g cm^2", "kg*m^2", 1, IMK_ERROR_DIMENSION, "\"3 g cm^2\" is in m^3/s^2",
         "a moment of inertia like gram*cm^2 or kg*m^2"},
        {"0.1", "rad/s", 3, IMK_ERROR_UNIT_MISSING, "\"0.1\" has no unit",
         "a unit such as deg/h, deg/s or rad/s"},
        {"0 0 1", "rad/s", 3, IMK_ERROR_UNIT_MISSING, "\"0 0 1\" has no unit",
         "a unit such as deg/h, deg/s or rad/s"},
        {"0", "rad/s", 3, IMK_ERROR_UNIT_MISSING, "\"0\" has no unit", NULL},
        {"0.1 ± 0.2", "1", 3, IMK_ERROR_UNIT_MISSING, "\"0.1 ± 0.2\" has no unit", NULL},
        {"", "rad/s", 3, IMK_ERROR_EMPTY, "", "a number and its unit"},
        {"deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, "\"deg/h\" does not start with a number", NULL},
        {"± 1 deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 2 deg/h", "rad/s", 1, IMK_ERROR_SYNTAX, "\"1 2 deg/h\" has too many numbers",
         "one number and a unit"},
        {"1 2 3 4 deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 2 3 ± 1 2 deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 ± deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 ± 2 ± 3 deg/h", "rad/s", 3, IMK_ERROR_SYNTAX, NULL, NULL},
        {"1 ± -0.1 deg/h", "rad/s", 3, IMK_ERROR_RANGE,
         "\"1 ± -0.1 deg/h\" has a negative uncertainty", NULL},
        {"nan deg/h", "rad/s", 3, IMK_ERROR_NOT_FINITE, "\"nan deg/h\" is not finite", NULL},
        {"1 inf 2 deg/h", "rad/s", 3, IMK_ERROR_NOT_FINITE, NULL, NULL},
        {"1 ± inf deg/h", "rad/s", 3, IMK_ERROR_NOT_FINITE, NULL, NULL},
        {"1e308 km", "m", 1, IMK_ERROR_NOT_FINITE, NULL, NULL},
        /* Too long for the message: the unit alone is quoted. */
        {"0.12345678901234567 0.12345678901234567 0.12345678901234567 0.12345678901234567 deg/h",
         "m", 4, IMK_ERROR_DIMENSION, "\"deg/h\" is an angular rate", NULL},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        double values[4] = {-7.0, -7.0, -7.0, -7.0}, sigmas[4] = {-7.0};
        size_t count = 77;
        imk_error error;
        const imk_status status = quantity(cases[i].text, cases[i].like, cases[i].max_count, values,
                                           sigmas, &count, &error);
        if (status != cases[i].status || error.status != status)
            fail_msg("%s: %s", cases[i].text, imk_status_name(status));
        if (cases[i].found)
            assert_string_equal(error.found, cases[i].found);
        if (cases[i].expected)
            assert_string_equal(error.expected, cases[i].expected);
        assert_true(values[0] == -7.0 && sigmas[0] == -7.0 && count == 77);
        CHECK_STATUS(quantity(cases[i].text, cases[i].like, cases[i].max_count, values, sigmas,
                              &count, NULL),
                     cases[i].status);
    }
}

static const char *const usual_units[] = {"rad",
                                          "mrad",
                                          "urad",
                                          "deg",
                                          "arcsec",
                                          "deg/h",
                                          "deg/s",
                                          "rad/s",
                                          "deg/sqrt(h)",
                                          "deg/h/sqrt(Hz)",
                                          "rad/s/sqrt(Hz)",
                                          "deg/h/sqrt(h)",
                                          "deg/h/h",
                                          "g",
                                          "mg",
                                          "ug",
                                          "m/s^2",
                                          "ug/sqrt(Hz)",
                                          "mg/sqrt(Hz)",
                                          "m/s/sqrt(h)",
                                          "ug/sqrt(h)",
                                          "ug/h",
                                          "ug*s",
                                          "deg/h/g",
                                          "deg/h/g^2",
                                          "ppm",
                                          "%",
                                          "1",
                                          "ppm/g",
                                          "ppm/degC",
                                          "ug/degC",
                                          "deg/h/degC",
                                          "deg/h/(degC/min)",
                                          "s",
                                          "ms",
                                          "h",
                                          "Hz",
                                          "kHz",
                                          "mm",
                                          "m",
                                          "count",
                                          "count/(deg/s)",
                                          "count/g",
                                          "degC",
                                          "K",
                                          "kg",
                                          "gram",
                                          "microgram",
                                          "kg*m^2",
                                          "N*m*s",
                                          "N",
                                          "uN",
                                          "N*m",
                                          "N*m/rad",
                                          "N/m",
                                          "N*s/m",
                                          "N/sqrt(Hz)",
                                          "N*m/sqrt(Hz)",
                                          "N*m*s/rad",
                                          "GPa",
                                          "W",
                                          "uW",
                                          "mA",
                                          "A",
                                          "mV",
                                          "V",
                                          "nV/sqrt(Hz)",
                                          "pA/sqrt(Hz)",
                                          "V/m",
                                          "ohm",
                                          "pF",
                                          "A/W",
                                          "N*m/A",
                                          "N/A",
                                          "dB/km",
                                          "um^2",
                                          "kg/m^3",
                                          "kg*m",
                                          "nm/N",
                                          "urad/sqrt(Hz)",
                                          "1/sqrt(Hz)",
                                          "m/sqrt(Hz)",
                                          "V/rad",
                                          "F/m",
                                          "Hz/K",
                                          "Hz/g",
                                          "nN*m/K"};

static uint64_t next_bits(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Any doubles come back bit by bit, in the unit or in SI. 100 000 in all, of all magnitudes that
 * do not overflow, and temperatures of 1 mK … 1000 K. */
static void formatted_quantities_read_back_to_the_same_bits(void **state)
{
    (void)state;
    uint64_t bits = 88172645463325252u;
    for (size_t u = 0; u < COUNT(usual_units); u++) {
        const imk_unit unit = imk_unit_of(usual_units[u]);
        assert_true(unit.scale > 0.0);
        for (int i = 0; i < 2300; i++) {
            const double mantissa = (double)(next_bits(&bits) >> 11) * 0x1p-53;
            const double exponent = (double)(next_bits(&bits) >> 11) * 0x1p-53;
            const double sign = i % 2 == 0 ? 1.0 : -1.0;
            const double range = i < 1000 ? 12.0 : 250.0;
            double value = sign * (1.0 + mantissa) * pow(10.0, range * (2.0 * exponent - 1.0));
            if (unit.offset != 0.0)
                value = 1000.0 * mantissa * mantissa + 0.001;
            const double sigma = i % 3 == 0 ? 0.0 : 0.1 * fabs(value);
            char text[256];
            const size_t length = imk_quantity_format(&value, &sigma, 1, &unit, text, sizeof text);
            double back = 0.0, back_sigma = 0.0;
            size_t count;
            imk_unit found;
            imk_error error;
            assert_true(length > 0 && length == strlen(text));
            if (imk_quantity_parse(text, text + length, unit.dimension, 1, &back, &back_sigma,
                                   &count, &found, &error) != IMK_OK)
                fail_msg("%s: %s", text, error.expected);
            if (memcmp(&back, &value, sizeof value) != 0 || back_sigma != sigma)
                fail_msg("%s for %.17g %s is read as %.17g", text, value, usual_units[u], back);
            /* In SI it must still say whether it is a density per root hertz. */
            assert_int_equal(found.per_root_hertz, unit.per_root_hertz);
        }
    }
}

/* A short decimal read from a file is written as it stood. */
static void short_decimals_are_written_as_they_were_read(void **state)
{
    (void)state;
    const char *const numbers[] = {"0.1",  "0.0501", "-0.2", "3",      "150", "0.003", "1e-7",
                                   "9.81", "0.30",   "1e20", "25.005", "-40", "85",    "0"};
    for (size_t u = 0; u < COUNT(usual_units); u++) {
        const imk_unit unit = imk_unit_of(usual_units[u]);
        for (size_t i = 0; i < COUNT(numbers); i++) {
            double number, value, sigma;
            size_t count;
            char text[32], expected[128], written[128];
            (void)imk_decimal_parse(numbers[i], numbers[i] + strlen(numbers[i]), &number);
            (void)imk_decimal_shortest(number, text);
            /* 273.15 swallows digits of very large and very small numbers of degC. */
            if (unit.offset != 0.0 && number != 0.0 && (number > 1e3 || fabs(number) < 1e-3))
                continue;
            (void)snprintf(expected, sizeof expected, "%s %s", text, usual_units[u]);
            CHECK_OK(quantity(expected, usual_units[u], 1, &value, &sigma, &count, NULL));
            assert_true(imk_quantity_format(&value, &sigma, 1, &unit, written, sizeof written) > 0);
            assert_string_equal(written, expected);
        }
    }
}

static void quantities_are_written(void **state)
{
    (void)state;
    const imk_unit rate = imk_unit_of("deg/h"), density = imk_unit_of("ug/sqrt(Hz)");
    double values[3], sigmas[3];
    size_t count;
    char text[128];
    const char *const texts[] = {"0.1 -0.2 0.05 ± 0.01 deg/h", "1 2 3 ± 0.1 0.2 0.3 deg/h",
                                 "1 2 3 deg/h", "0 0 0 ± 0.01 deg/h", "-0 1 2 deg/h"};
    for (size_t i = 0; i < COUNT(texts); i++) {
        CHECK_OK(quantity(texts[i], "rad/s", 3, values, sigmas, &count, NULL));
        assert_int_equal(imk_quantity_format(values, sigmas, 3, &rate, text, sizeof text),
                         strlen(texts[i]));
        assert_string_equal(text, texts[i]);
    }
    assert_int_equal(imk_quantity_format(values, NULL, 3, &rate, text, 12), 0);
    assert_true(imk_quantity_format(values, NULL, 3, &rate, text, 13) == 12);
    assert_int_equal(imk_quantity_format(values, NULL, 0, &rate, text, sizeof text), 0);
    /* A double that no decimal number of ug/sqrt(Hz) gives stays a density per root hertz. */
    double value = 1e-5;
    while (imk_quantity_format(&value, NULL, 1, &density, text, sizeof text) > 0 &&
           strstr(text, "ug"))
        value = nextafter(value, 1.0);
    assert_non_null(strstr(text, " m/s^2/sqrt(Hz)"));
    value = (double)NAN;
    assert_true(imk_quantity_format(&value, NULL, 1, &rate, text, sizeof text) > 0);
    assert_string_equal(text, "nan rad/s");
}

static void readable_units_suit_the_grades(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *unit, *readable;
    } cases[] = {
        {0.001, "deg/h", "deg/h"},
        {0.01, "deg/h", "deg/h"},
        {100, "deg/h", "deg/h"},
        {0.5, "deg/s", "deg/s"},
        {3, "rad/s", "deg/s"},
        {0, "rad/s", "deg/h"},
        {30, "ug", "ug"},
        {999, "ug", "ug"},
        {1, "mg", "mg"},
        {1, "g", "m/s^2"},
        {0.002, "deg/sqrt(h)", "deg/sqrt(h)"},
        {60, "ug/sqrt(Hz)", "ug/sqrt(Hz)"},
        {150, "ppm", "ppm"},
        {2, "%", "%"},
        {3, "1", "1"},
        {0.2, "mrad", "mrad"},
        {5, "urad", "urad"},
        {30, "deg", "deg"},
        {300, "s", "s"},
        {12, "h", "h"},
        {20, "us", "us"},
        {100, "Hz", "Hz"},
        {298, "K", "degC"},
        {5, "K", "K"},
        {5, "mm", "mm"},
        {0.3, "deg/h/sqrt(h)", "deg/h/sqrt(h)"},
        {0.1, "deg/h/g", "deg/h/g"},
        {3e-9, "kg", "microgram"},
        {0.05, "kg", "gram"},
        {40, "uW", "uW"},
        {0.01, "W", "mW"},
        {2e-7, "N*m", "nN*m"},
        {5, "V", "V"},
        {200, "fF", "fF"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const imk_unit unit = imk_unit_of(cases[i].unit);
        const imk_unit readable = imk_unit_readable(unit.dimension, cases[i].value * unit.scale);
        if (strcmp(readable.text, cases[i].readable) != 0)
            fail_msg("%g %s in %s, expected %s", cases[i].value, cases[i].unit, readable.text,
                     cases[i].readable);
        assert_true(imk_dimension_equal(readable.dimension, unit.dimension));
    }
    /* Any dimension has one, if only in SI. */
    const imk_unit odd = imk_unit_readable(imk_unit_of("m^2.5*K/s^3/count").dimension, 1.0);
    assert_string_equal(odd.text, "m^2.5*K/count/s^3");
    CHECK_CLOSE(odd.scale, 1.0, 0.0);
}

/* The examples a message gives can be read, and are of the dimension they are examples of. */
static void examples_of_a_dimension_have_that_dimension(void **state)
{
    (void)state;
    for (size_t u = 0; u < COUNT(usual_units); u++) {
        const imk_dimension dimension = imk_unit_of(usual_units[u]).dimension;
        char examples[128];
        assert_null(strstr(imk_dimension_name(dimension), "unusual"));
        assert_true(strlen(imk_dimension_name(dimension)) < 80);
        (void)snprintf(examples, sizeof examples, "%s", imk_dimension_examples(dimension));
        for (char *next, *at = examples; at; at = next) {
            char *comma = strstr(at, ", "), * or = strstr(at, " or ");
            next = comma ? comma + 2 : or ? or +4 : NULL;
            *(comma ? comma : or ? or : at + strlen(at)) = '\0';
            const imk_unit unit = imk_unit_of(at);
            if (!(unit.scale > 0.0) || !imk_dimension_equal(unit.dimension, dimension))
                fail_msg("%s is no example of %s", at, imk_dimension_name(dimension));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(simple_units_have_their_defined_size),
        cmocka_unit_test(compound_units_follow_from_their_parts),
        cmocka_unit_test(units_of_designs_follow_from_kilogram_and_ampere),
        cmocka_unit_test(celsius_is_shifted_only_by_itself),
        cmocka_unit_test(angle_and_frequency_are_not_mixed),
        cmocka_unit_test(unknown_units_are_refused_with_the_nearest),
        cmocka_unit_test(quantities_are_read),
        cmocka_unit_test(bad_quantities_are_refused_with_a_message),
        cmocka_unit_test(formatted_quantities_read_back_to_the_same_bits),
        cmocka_unit_test(short_decimals_are_written_as_they_were_read),
        cmocka_unit_test(quantities_are_written),
        cmocka_unit_test(readable_units_suit_the_grades),
        cmocka_unit_test(examples_of_a_dimension_have_that_dimension),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
