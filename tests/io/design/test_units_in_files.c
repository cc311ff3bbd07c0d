/* SPDX-License-Identifier: Apache-2.0 */
/* Each unit with a name, with each multiple of it that there is, is read alike in a design, a
 * model, a motion script and on the command line, and what is written is read with the same bits.
 * Sizes are the definitions of the SI (prefixes: milli 1e-3 …), of the degree as pi/180 rad, of g
 * as 9.80665 m/s^2 (CGPM 1901), of the gauss as 1e-4 T. */
#include "cli/run_command.h"

#include "base/units/unit_table_internal.h"
#include "imukit/io.h"
#include "imukit/units.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define DEG (3.14159265358979323846 / 180.0)
#define G 9.80665

typedef struct base_unit {
    const char *name, *si;
    double size;
    const char *prefixes; /* the letters of those there are, beside none */
} base_unit;

/* Every name of the table, by the multiples that documents list; units of masses, which have no
 * letters as multiples, by each name. */
static const base_unit bases[] = {
    {"rad", "rad", 1, "mun"},
    {"deg", "rad", DEG, "m"},
    {"degree", "rad", DEG, ""},
    {"degrees", "rad", DEG, ""},
    {"arcmin", "rad", DEG / 60, ""},
    {"arcsec", "rad", DEG / 3600, ""},
    {"arc-sec", "rad", DEG / 3600, ""},
    {"arcsecond", "rad", DEG / 3600, ""},
    {"arcseconds", "rad", DEG / 3600, ""},
    {"asec", "rad", DEG / 3600, ""},
    {"rev", "rad", 360 * DEG, ""},
    {"dps", "rad/s", DEG, "m"},
    {"dph", "rad/s", DEG / 3600, ""},
    {"rpm", "rad/s", 6 * DEG, ""},
    {"s", "s", 1, "mun"},
    {"sec", "s", 1, ""},
    {"second", "s", 1, ""},
    {"seconds", "s", 1, ""},
    {"milliseconds", "s", 1e-3, ""},
    {"microseconds", "s", 1e-6, ""},
    {"nanoseconds", "s", 1e-9, ""},
    {"min", "s", 60, ""},
    {"minute", "s", 60, ""},
    {"minutes", "s", 60, ""},
    {"h", "s", 3600, ""},
    {"hr", "s", 3600, ""},
    {"hour", "s", 3600, ""},
    {"hours", "s", 3600, ""},
    {"day", "s", 86400, ""},
    {"days", "s", 86400, ""},
    {"Hz", "1/s", 1, "mkMGT"},
    {"hz", "1/s", 1, ""},
    {"m", "m", 1, "pnumck"},
    {"nmi", "m", 1852, ""},
    {"ft", "m", 0.3048, ""},
    {"g", "m/s^2", G, "mun"},
    {"Gal", "m/s^2", 1e-2, "mu"},
    {"gram", "kg", 1e-3, ""},
    {"grams", "kg", 1e-3, ""},
    {"kg", "kg", 1, ""},
    {"milligram", "kg", 1e-6, ""},
    {"microgram", "kg", 1e-9, ""},
    {"nanogram", "kg", 1e-12, ""},
    {"N", "kg*m/s^2", 1, "munp"},
    {"Nm", "kg*m^2/s^2", 1, "mu"},
    {"J", "kg*m^2/s^2", 1, ""},
    {"Pa", "kg/m/s^2", 1, "kMG"},
    {"W", "kg*m^2/s^3", 1, "mun"},
    {"A", "A", 1, "munp"},
    {"V", "kg*m^2/s^3/A", 1, "kmun"},
    {"ohm", "kg*m^2/s^3/A^2", 1, "kM"},
    {"F", "A^2*s^4/kg/m^2", 1, "unpf"},
    {"T", "kg/s^2/A", 1, "mun"},
    {"gauss", "kg/s^2/A", 1e-4, ""},
    {"G", "kg/s^2/A", 1e-4, "m"},
    {"K", "K", 1, "m"},
    {"count", "count", 1, ""},
    {"counts", "count", 1, ""},
    {"LSB", "count", 1, ""},
    {"lsb", "count", 1, ""},
    {"digit", "count", 1, ""},
    {"digits", "count", 1, ""},
    {"%", "1", 1e-2, ""},
    {"percent", "1", 1e-2, ""},
    {"ppm", "1", 1e-6, ""},
    {"ppb", "1", 1e-9, ""},
    {"dB", "1", 0.23025850929940457 /* ln(10)/10 */, ""},
};

/* What docs/design-file.md and docs/model-file.md list beside names alone. */
static const base_unit products[] = {
    {"N m", "kg*m^2/s^2", 1, ""},
    {"kg m^2", "kg*m^2", 1, ""},
    {"gram cm^2", "kg*m^2", 1e-7, ""},
    {"nanogram m^2", "kg*m^2", 1e-12, ""},
    {"N m s", "kg*m^2/s", 1, ""},
    {"Ω", "kg*m^2/s^3/A^2", 1, ""},
    {"rev/s", "rad/s", 360 * DEG, ""},
    {"deg/s", "rad/s", DEG, ""},
    {"dB/km", "1/m", 0.23025850929940457e-3, ""},
    {"N m/sqrt(Hz)", "kg*m^2/s^2/sqrt(Hz)", 1, ""},
    {"pA/√Hz", "A/sqrt(Hz)", 1e-12, ""},
    {"urad/sqrt(Hz)", "rad/sqrt(Hz)", 1e-6, ""},
    {"N m/rad", "kg*m^2/s^2/rad", 1, ""},
    {"N m s/rad", "kg*m^2/s/rad", 1, ""},
    {"V/rad", "kg*m^2/s^3/A/rad", 1, ""},
    {"A s", "A*s", 1, ""},
    {"nanogram/um^3", "kg/m^3", 1e6, ""},
};

static double size_of_prefix(char prefix)
{
    static const struct {
        char letter;
        double size;
    } sizes[] = {{'f', 1e-15}, {'p', 1e-12}, {'n', 1e-9}, {'u', 1e-6}, {'m', 1e-3},
                 {'c', 1e-2},  {'k', 1e3},   {'M', 1e6},  {'G', 1e9},  {'T', 1e12}};
    for (size_t i = 0; i < COUNT(sizes); i++)
        if (sizes[i].letter == prefix)
            return sizes[i].size;
    return 1;
}

/* Call `check` with each unit as text, and its size. @return how many */
static size_t each(size_t count, const base_unit *table,
                   void (*check)(const char *unit, const char *si, double size))
{
    size_t checked = 0;
    for (size_t i = 0; i < count; i++) {
        char name[48];
        check(table[i].name, table[i].si, table[i].size);
        checked++;
        for (const char *p = table[i].prefixes; *p; p++, checked++) {
            snprintf(name, sizeof name, "%c%s", *p, table[i].name);
            check(name, table[i].si, size_of_prefix(*p) * table[i].size);
        }
    }
    return checked;
}

/* ---- numbers with units by themselves -------------------------------------------------------- */

/* One number, several, an uncertainty; printed and read again. */
static void check_alone(const char *name, const char *si, double size)
{
    static const double numbers[] = {4, -0.37, 1.2345678901234567e-5, 3e17};
    const imk_dimension due = imk_unit_of(si).dimension;
    char text[128], printed[256];
    double value[3], sigma[3], again, none;
    size_t count, length;
    imk_error error = {0};
    imk_unit unit;
    for (size_t i = 0; i < COUNT(numbers); i++) {
        length = (size_t)snprintf(text, sizeof text, "%.17g %s", numbers[i], name);
        if (imk_quantity_parse(text, text + length, due, 1, value, sigma, &count, &unit, &error))
            fail_msg("%s: %s; %s", text, error.found, error.expected);
        if (!(fabs(value[0] / (numbers[i] * size) - 1) < 2e-15))
            fail_msg("%s is read as %.17g", text, value[0]);
        length = imk_quantity_format(value, NULL, 1, &unit, printed, sizeof printed);
        CHECK_OK(imk_quantity_parse(printed, printed + length, due, 1, &again, &none, &count, NULL,
                                    &error));
        if (memcmp(&again, value, sizeof again) != 0)
            fail_msg("%s is written %s and read as %.17g", text, printed, again);
    }
    length = (size_t)snprintf(text, sizeof text, "1 2 3 ± 0.5 %s", name);
    CHECK_OK(imk_quantity_parse(text, text + length, due, 3, value, sigma, &count, NULL, &error));
    assert_int_equal(count, 3);
    CHECK_RELATIVE(value[2], 3 * size, 2e-15);
    CHECK_RELATIVE(sigma[1], 0.5 * size, 2e-15);
}

static size_t names_known;
static void check_name(const char *name, const char *si, double size)
{
    (void)si;
    (void)size;
    names_known += imki_unit_find(name) != NULL;
}

static void each_unit_by_itself(void **unused)
{
    (void)unused;
    names_known = 0;
    const size_t count = each(COUNT(bases), bases, check_name);
    assert_int_equal(names_known, count);
    /* degC, whose zero is shifted, is in test_units.c */
    assert_int_equal(count + 1, imki_unit_count());
    (void)each(COUNT(bases), bases, check_alone);
    (void)each(COUNT(products), products, check_alone);
}

/* Words for no number stay what they were: no value of any quantity. */
static void no_number_is_refused(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        imk_status status;
    } cases[] = {
        {"nan kg", IMK_ERROR_NOT_FINITE},          {"inf kg", IMK_ERROR_NOT_FINITE},
        {"1e999 kg", IMK_ERROR_NOT_FINITE},        {"nanogram", IMK_ERROR_SYNTAX},
        {"4 nan gram", IMK_ERROR_SYNTAX},          {"4 nanogramme", IMK_ERROR_UNIT_UNKNOWN},
        {"4 infinitygram", IMK_ERROR_UNIT_UNKNOWN}};
    double value, sigma;
    size_t count;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *text = cases[i].text;
        const imk_status status =
            imk_quantity_parse(text, text + strlen(text), imk_unit_of("kg").dimension, 1, &value,
                               &sigma, &count, NULL, NULL);
        if (status != cases[i].status)
            fail_msg("%s: %s", text, imk_status_name(status));
    }
}

/* ---- in a design ----------------------------------------------------------------------------- */

typedef struct thing {
    uint32_t cookie;
    double value;
} thing;

static void thing_default(void *design)
{
    *(thing *)design = (thing){.cookie = 3};
}

static void check_in_design(const char *name, const char *si, double size)
{
    const imk_design_field field = {.path = "part.value",
                                    .kind = IMK_DESIGN_NUMBER,
                                    .offset = offsetof(thing, value),
                                    .unit = name,
                                    .minimum = -1e300,
                                    .maximum = 1e300,
                                    .help = "a value"};
    const imk_instrument instrument = {.name = "thing",
                                       .title = "thing",
                                       .source = "this test",
                                       .cookie = 3,
                                       .design_size = sizeof(thing),
                                       .field_count = 1,
                                       .fields = &field,
                                       .set_default = thing_default};
    imk_design_file file = {.design = NULL}, again = {.design = NULL};
    imk_error error = {0};
    char text[256], *printed = NULL;
    size_t length = (size_t)snprintf(text, sizeof text,
                                     "imukit: 1\ninstrument: thing\npart: {value: 4 %s}\n", name);
    (void)si;
    if (imk_design_parse_as(&instrument, text, length, &file, &error) != IMK_OK)
        fail_msg("%s: %s; %s", name, error.found, error.expected);
    CHECK_RELATIVE(((const thing *)file.design)->value, 4 * size, 2e-15);
    CHECK_OK(imk_design_print(&file, &printed, &length, &error));
    CHECK_OK(imk_design_parse_as(&instrument, printed, length, &again, &error));
    assert_memory_equal(file.design, again.design, sizeof(thing));
    free(printed);
    imk_design_file_free(&again);
    imk_design_file_free(&file);
}

static void each_unit_in_a_design(void **unused)
{
    (void)unused;
    (void)each(COUNT(bases), bases, check_in_design);
    (void)each(COUNT(products), products, check_in_design);
}

/* ---- in a model, a motion script and options ------------------------------------------------- */

/* A value is taken, or refused for its dimension alone: the unit was read. */
static void check_read(const char *name, const char *si, const char *due, imk_status status,
                       const imk_error *error)
{
    const bool fits = imk_dimension_equal(imk_unit_of(si).dimension, imk_unit_of(due).dimension);
    if (status != (fits ? IMK_OK : IMK_ERROR_DIMENSION))
        fail_msg("%s: %s; %s", name, error->found, error->expected);
}

static void check_in_model(const char *name, const char *si, double size)
{
    static imk_model model;
    char text[256];
    imk_error error = {0};
    const size_t length =
        (size_t)snprintf(text, sizeof text, "imukit: 1\naccel: {bias: {fixed: 4e-9 %s}}\n", name);
    const imk_status status = imk_model_parse(text, length, &model, NULL, &error);
    check_read(name, si, "m/s^2", status, &error);
    if (status == IMK_OK)
        CHECK_RELATIVE(model.accel.bias.fixed.value[1], 4e-9 * size, 2e-15);
}

static void check_in_script(const char *name, const char *si, double size)
{
    const imk_geodetic place = {0};
    imk_motion_file *file = NULL;
    char text[256];
    imk_error error = {0};
    const size_t length =
        (size_t)snprintf(text, sizeof text, "imukit_motion: 1\nsteps: [hold 1 s, hold %.17g %s]\n",
                         4 / size, name); /* of a unit of time, 4 s */
    check_read(name, si, "s", imk_motion_parse(text, length, &place, 0, &file, &error), &error);
    imk_motion_file_free(file);
}

static void each_unit_in_other_files(void **unused)
{
    (void)unused;
    (void)each(COUNT(bases), bases, check_in_model);
    (void)each(COUNT(bases), bases, check_in_script);
    (void)each(COUNT(products), products, check_in_model);
    (void)each(COUNT(products), products, check_in_script);
}

/* Each name once; the multiples are read by the same function as in files. */
static void each_unit_in_an_option(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < COUNT(bases); i++) {
        char line[256], message[256];
        const imk_dimension dimension = imk_unit_of(bases[i].si).dimension;
        snprintf(line, sizeof line,
                 "$I physics pendulous_servo --temperature '4 %s' --duration 0.01s", bases[i].name);
        const int code = run(line);
        if (imk_dimension_equal(dimension, imk_unit_of("K").dimension)) {
            assert_int_equal(code, 0);
            continue;
        }
        snprintf(message, sizeof message, "\"4 %s\" is %s", bases[i].name,
                 imk_dimension_name(dimension));
        assert_int_equal(code, 2);
        check_contains(err, message, line);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_unit_by_itself),    cmocka_unit_test(no_number_is_refused),
        cmocka_unit_test(each_unit_in_a_design),  cmocka_unit_test(each_unit_in_other_files),
        cmocka_unit_test(each_unit_in_an_option),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
