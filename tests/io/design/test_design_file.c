/* SPDX-License-Identifier: Apache-2.0 */
/* Design files: what is read into the fields of a small instrument made here, what is refused and
 * with which message, that writing and reading keep every bit; and that the tables of all
 * instruments of the library can be written and read. Values are the numbers of the texts times
 * the unit's definition. */
#define _POSIX_C_SOURCE 200809L

#include "check.h"

#include "imukit/io.h"
#include "imukit/units.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define DEG (3.14159265358979323846 / 180.0)

/* ---- an instrument to test with -------------------------------------------------------------- */

typedef enum wheel_loop { WHEEL_OPEN, WHEEL_CLOSED, WHEEL_BOTH } wheel_loop;

typedef struct wheel {
    uint32_t cookie;
    double inertia, speed, quality, temperature, noise, axis_offset;
    int blades;
    wheel_loop loop;
    bool sealed;
} wheel;

static const imk_design_field wheel_fields[] = {
    {"rotor.inertia", IMK_DESIGN_NUMBER, offsetof(wheel, inertia), "gram*cm^2", 0.0, 1.0, true,
     NULL, "moment of inertia about the spin axis"},
    {"loop", IMK_DESIGN_CHOICE, offsetof(wheel, loop), NULL, 0, 0, false, "open|closed|both",
     "how it is read"},
    {"rotor.drive.speed", IMK_DESIGN_NUMBER, offsetof(wheel, speed), "rpm", 10.0, 5000.0, false,
     NULL, "speed of the wheel"},
    {"rotor.drive.blades", IMK_DESIGN_COUNT, offsetof(wheel, blades), NULL, 1, 64, false, NULL,
     "blades of the fan"},
    {"pickoff.quality", IMK_DESIGN_NUMBER, offsetof(wheel, quality), "1", 0.5, 1e6, true, NULL,
     "quality factor"},
    {"pickoff.noise", IMK_DESIGN_NUMBER, offsetof(wheel, noise), "nV/sqrt(Hz)", 0.0, 1.0, false,
     NULL, "voltage noise, two-sided"},
    {"temperature", IMK_DESIGN_NUMBER, offsetof(wheel, temperature), "degC", 1.0, 1000.0, false,
     NULL, "working temperature"},
    {"rotor.offset", IMK_DESIGN_NUMBER, offsetof(wheel, axis_offset), "nm", -1e-3, 1e-3, false,
     NULL, "of the centre of mass"},
    {"sealed", IMK_DESIGN_SWITCH, offsetof(wheel, sealed), NULL, 0, 0, false, NULL,
     "gas-tight case"},
};

static void wheel_default(void *design)
{
    *(wheel *)design = (wheel){.cookie = 7,
                               .inertia = 1.3e-6,
                               .speed = 2500.0,
                               .quality = 1000.0,
                               .temperature = 333.15,
                               .noise = 1e-8,
                               .blades = 12,
                               .loop = WHEEL_CLOSED};
}

static imk_status wheel_check(const void *design, imk_error *error);

static const imk_instrument wheel_instrument = {.name = "test_wheel",
                                                .title = "test wheel",
                                                .technology = "",
                                                .source = "chosen for this test",
                                                .cookie = 7,
                                                .design_size = sizeof(wheel),
                                                .field_count = COUNT(wheel_fields),
                                                .fields = wheel_fields,
                                                .set_default = wheel_default,
                                                .check = wheel_check};

/* Fast wheels must be sealed. */
static imk_status wheel_check(const void *design, imk_error *error)
{
    const wheel *w = design;
    if (w->sealed || w->speed <= 4000.0)
        return IMK_OK;
    imk_error_set(error, IMK_ERROR_CONFLICT, "rotor.drive.speed", "", "set sealed: yes");
    if (error) {
        error->index = -1;
        error->value = w->speed;
        error->limit = 4000.0;
    }
    return IMK_ERROR_CONFLICT;
}

static const char head[] = "imukit: 1\ninstrument: test_wheel\n";

static imk_status read_wheel(const char *rest, imk_design_file *file, imk_error *error)
{
    char text[2048];
    snprintf(text, sizeof text, "%s%s", head, rest);
    return imk_design_parse_as(&wheel_instrument, text, strlen(text), file, error);
}

/* ---- reading --------------------------------------------------------------------------------- */

static void keys_not_given_keep_the_default(void **state)
{
    (void)state;
    imk_design_file file = {.design = NULL};
    wheel due;
    wheel_default(&due);
    CHECK_OK(read_wheel("", &file, NULL));
    assert_ptr_equal(file.instrument, &wheel_instrument);
    assert_memory_equal(file.design, &due, sizeof due);
    assert_string_equal(file.name, "");
    imk_design_file_free(&file);
    assert_null(file.design);
    imk_design_file_free(&file);
    imk_design_file_free(NULL);
}

static void fields_are_read_in_their_units(void **state)
{
    (void)state;
    imk_design_file file;
    CHECK_OK(read_wheel("name: my wheel\ndescription: \"first, of three\"\n"
                        "rotor:\n  inertia: 20 gram cm^2\n"
                        "  drive: {speed: 24000 deg/s, blades: 5}\n  offset: -3 um\n"
                        "loop: both\nsealed: on\npickoff: {quality: 20e3, noise: 2 uV/√Hz}\n"
                        "temperature: 25 degC\n",
                        &file, NULL));
    const wheel *w = file.design;
    assert_string_equal(file.name, "my wheel");
    assert_string_equal(file.description, "first, of three");
    CHECK_RELATIVE(w->inertia, 20e-7, 4e-16); /* roundings of the scales of units */
    CHECK_RELATIVE(w->speed, 24000.0 * DEG, 4e-16);
    CHECK_RELATIVE(w->axis_offset, -3e-6, 4e-16);
    CHECK_RELATIVE(w->noise, 2e-6, 4e-16);
    CHECK_CLOSE(w->quality, 20e3, 0.0);
    CHECK_CLOSE(w->temperature, 298.15, 1e-13);
    assert_int_equal(w->blades, 5);
    assert_int_equal(w->loop, WHEEL_BOTH);
    assert_true(w->sealed);
    assert_int_equal(w->cookie, 7);
    imk_design_file_free(&file);
    /* the unit of a pure number may stand there; JSON is the same tree */
    const char json[] = "{\"imukit\": 1, \"instrument\": \"test_wheel\", \"sealed\": \"no\", "
                        "\"pickoff\": {\"quality\": \"30 1\"}, \"loop\": \"open\"}";
    CHECK_OK(imk_design_parse_as(&wheel_instrument, json, strlen(json), &file, NULL));
    CHECK_CLOSE(((const wheel *)file.design)->quality, 30.0, 0.0);
    assert_int_equal(((const wheel *)file.design)->loop, WHEEL_OPEN);
    imk_design_file_free(&file);
}

static void bad_files_are_refused_with_a_message(void **state)
{
    (void)state;
    static const struct {
        const char *text; /* behind the two lines of the head */
        imk_status status;
        const char *message;
    } cases[] = {
        {"rotr: {inertia: 1 kg m^2}\n", IMK_ERROR_KEY_UNKNOWN,
         "w.yaml:3:1: rotr: \"rotr\" is not a known key; did you mean \"rotor\"?"},
        {"rotor: {inerta: 1 kg m^2}\n", IMK_ERROR_KEY_UNKNOWN,
         "w.yaml:3:9: rotor.inerta: \"inerta\" is not a known key; did you mean \"inertia\"?"},
        {"rotor: {drive: {quality: 1}}\n", IMK_ERROR_KEY_UNKNOWN,
         "w.yaml:3:17: rotor.drive.quality: \"quality\" is not a known key; expected one of speed, "
         "blades"},
        {"rotor.inertia: 1 kg m^2\n", IMK_ERROR_KEY_UNKNOWN,
         "w.yaml:3:1: rotor.inertia: \"rotor.inertia\" is not a known key; nest the keys instead "
         "of writing dots: a: {b: …}"},
        {"sealed: yes\nsealed: no\n", IMK_ERROR_KEY_DUPLICATE,
         "w.yaml:4:1: sealed: \"sealed\" is given twice; the first one is in line 3"},
        {"rotor: 3 rpm\n", IMK_ERROR_SYNTAX,
         "w.yaml:3:8: rotor: \"3 rpm\" cannot be read; expected a mapping: {key: value, …}"},
        {"rotor: {inertia: 3}\n", IMK_ERROR_UNIT_MISSING,
         "w.yaml:3:18: rotor.inertia: \"3\" has no unit; expected a unit such as gram*cm^2 or "
         "kg*m^2"},
        {"rotor: {inertia: 3 mg}\n", IMK_ERROR_DIMENSION,
         "w.yaml:3:18: rotor.inertia: \"3 mg\" is a specific force or acceleration; expected a "
         "moment of inertia like gram*cm^2 or kg*m^2"},
        {"rotor: {inertia: 3 kg furlong}\n", IMK_ERROR_UNIT_UNKNOWN,
         "w.yaml:3:18: rotor.inertia: \"furlong\" is not a known unit; expected a unit such as "
         "gram*cm^2 or kg*m^2"},
        {"rotor: {inertia: 3 ± 1 kg m^2}\n", IMK_ERROR_SYNTAX,
         "w.yaml:3:18: rotor.inertia: \"3 ± 1 kg m^2\" cannot be read; expected a quantity without "
         "uncertainty"},
        {"rotor: {inertia: [1 kg m^2]}\n", IMK_ERROR_SYNTAX,
         "w.yaml:3:18: rotor.inertia: the text cannot be read; expected a number and its unit, as "
         "one "
         "text"},
        {"rotor: {inertia: nan kg m^2}\n", IMK_ERROR_NOT_FINITE,
         "w.yaml:3:18: rotor.inertia: \"nan kg m^2\" is not finite; expected a finite number"},
        {"pickoff: {quality: inf}\n", IMK_ERROR_NOT_FINITE,
         "w.yaml:3:20: pickoff.quality: \"inf\" is not finite; expected a finite number"},
        {"rotor: {inertia: 0 kg m^2}\n", IMK_ERROR_RANGE,
         "w.yaml:3:18: rotor.inertia: \"0 kg m^2\" is outside its valid range; expected more than "
         "0 gram*cm^2 (moment of inertia about the spin axis)"},
        {"rotor: {drive: {speed: 90 krpm}}\n", IMK_ERROR_UNIT_UNKNOWN, NULL},
        {"rotor: {drive: {speed: 6000 rad/s}}\n", IMK_ERROR_RANGE,
         "w.yaml:3:24: rotor.drive.speed: \"6000 rad/s\" is outside its valid range; expected at "
         "most 47746.5 rpm (speed of the wheel)"},
        {"rotor: {drive: {speed: 50 rpm}}\n", IMK_ERROR_RANGE,
         "w.yaml:3:24: rotor.drive.speed: \"50 rpm\" is outside its valid range; expected at least "
         "95.493 rpm (speed of the wheel)"},
        {"pickoff: {quality: 0.5}\n", IMK_ERROR_RANGE,
         "w.yaml:3:20: pickoff.quality: \"0.5\" is outside its valid range; expected more than 0.5 "
         "(quality factor)"},
        {"rotor: {drive: {blades: 5.5}}\n", IMK_ERROR_SYNTAX,
         "w.yaml:3:25: rotor.drive.blades: \"5.5\" cannot be read; expected a whole number, "
         "without a unit"},
        {"rotor: {drive: {blades: 65}}\n", IMK_ERROR_RANGE,
         "w.yaml:3:25: rotor.drive.blades: \"65\" is outside its valid range; expected at most 64 "
         "(blades of the fan)"},
        {"rotor: {drive: {blades: 99999999999}}\n", IMK_ERROR_SYNTAX, NULL},
        {"rotor: {drive: {blades: \"\"}}\n", IMK_ERROR_SYNTAX, NULL},
        {"loop: close\n", IMK_ERROR_NAME_UNKNOWN,
         "w.yaml:3:7: loop: \"close\" is not a known name; did you mean \"closed\"?"},
        {"loop: servo\n", IMK_ERROR_NAME_UNKNOWN,
         "w.yaml:3:7: loop: \"servo\" is not a known name; expected one of open, closed, both"},
        {"loop: [open]\n", IMK_ERROR_SYNTAX, NULL},
        {"sealed: maybe\n", IMK_ERROR_SYNTAX,
         "w.yaml:3:9: sealed: \"maybe\" cannot be read; expected \"yes\" or \"no\""},
        {"sealed: no\nrotor:\n  drive:\n    speed: 40000 rpm\n", IMK_ERROR_CONFLICT,
         "w.yaml:6:12: rotor.drive.speed: \"40000 rpm\" is in conflict (limit 38197.2 rpm); set "
         "sealed: yes"},
        {"name: [a]\n", IMK_ERROR_SYNTAX, NULL},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        imk_design_file file = {.design = &file};
        imk_error error;
        char message[600];
        const imk_status status = read_wheel(cases[i].text, &file, &error);
        imk_error_text(&error, "w.yaml", message, sizeof message);
        if (status != cases[i].status || error.status != status)
            fail_msg("%s: %s: %s", cases[i].text, imk_status_name(status), message);
        if (cases[i].message)
            assert_string_equal(message, cases[i].message);
        assert_ptr_equal(file.design, &file); /* untouched */
        CHECK_STATUS(read_wheel(cases[i].text, &file, NULL), cases[i].status);
    }
}

static void heads_are_checked(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        imk_status status;
        const char *message;
    } cases[] = {
        {"instrument: test_wheel\n", IMK_ERROR_KEY_MISSING,
         "w.yaml:1:1: a required key is missing; write imukit: 1, the version of the format"},
        {"imukit: 2\ninstrument: test_wheel\n", IMK_ERROR_VERSION,
         "w.yaml:1:9: imukit: \"2\" is not a supported version; version 1 of the format"},
        {"imukit: 1\n", IMK_ERROR_KEY_MISSING,
         "w.yaml:1:1: \"instrument\" is missing; write instrument: NAME, with a name that imukit "
         "physics lists"},
        {"imukit: 1\ninstrument: spinning_top\n", IMK_ERROR_NAME_UNKNOWN,
         "w.yaml:2:13: instrument: \"spinning_top\" is not a known name; expected a design file, "
         "or a name that imukit physics lists"},
        {"imukit: 1\ninstrument: [a]\n", IMK_ERROR_SYNTAX, NULL},
        {"", IMK_ERROR_EMPTY, NULL},
        {"- a\n", IMK_ERROR_FORMAT, NULL},
        {"imukit: 1\ninstrument: &a test_wheel\n", IMK_ERROR_UNSUPPORTED, NULL},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        imk_design_file file = {.design = NULL};
        imk_error error;
        char message[600];
        const imk_status status =
            imk_design_parse(cases[i].text, strlen(cases[i].text), &file, &error);
        imk_error_text(&error, "w.yaml", message, sizeof message);
        if (status != cases[i].status)
            fail_msg("%s: %s: %s", cases[i].text, imk_status_name(status), message);
        if (cases[i].message)
            assert_string_equal(message, cases[i].message);
        assert_null(file.design);
    }
    imk_design_file file = {.design = NULL};
    imk_error error;
    const char other[] = "imukit: 1\ninstrument: ring\n";
    CHECK_STATUS(imk_design_parse_as(&wheel_instrument, other, strlen(other), &file, &error),
                 IMK_ERROR_CONFLICT);
    assert_string_equal(error.found, "\"ring\" is not \"test_wheel\"");
    CHECK_STATUS(imk_design_open("no_such_instrument", &file, &error), IMK_ERROR_NAME_UNKNOWN);
    CHECK_STATUS(imk_design_open("no/such.yaml", &file, &error), IMK_ERROR_OPEN);
    CHECK_STATUS(imk_design_open("missing.yaml", &file, &error), IMK_ERROR_OPEN);
    CHECK_STATUS(imk_design_open("/tmp", &file, &error), IMK_ERROR_OPEN); /* a directory */
}

/* ---- writing --------------------------------------------------------------------------------- */

static void designs_are_written_with_units_and_help(void **state)
{
    (void)state;
    wheel w;
    wheel_default(&w);
    imk_design_file file = {.instrument = &wheel_instrument, .design = &w, .name = "yes"};
    char *text;
    size_t size;
    w.sealed = true;
    CHECK_OK(imk_design_print(&file, &text, &size, NULL));
    assert_int_equal(size, strlen(text));
    assert_string_equal(
        text, "# test wheel. Default design: chosen for this test\n"
              "imukit: 1\n"
              "instrument: test_wheel\n"
              "name: \"yes\"\n"
              "rotor:\n"
              "  inertia: 13 gram*cm^2                 # moment of inertia about the spin "
              "axis\n"
              "  drive:\n"
              "    speed: 23873.241463784303 rpm       # speed of the wheel\n"
              "    blades: 12                          # blades of the fan\n"
              "  offset: 0 nm                          # of the centre of mass\n"
              "loop: closed                            # how it is read: open, closed or "
              "both\n"
              "pickoff:\n"
              "  quality: 1000                         # quality factor\n"
              "  noise: 10 nV/sqrt(Hz)                 # voltage noise, two-sided\n"
              "temperature: 60 degC                    # working temperature\n"
              "sealed: yes                             # gas-tight case\n");
    free(text);
    w.speed = 4500.0;
    w.sealed = false;
    imk_error error;
    char path[] = "/tmp/imukit-design-XXXXXX";
    const int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    remove(path);
    CHECK_STATUS(imk_design_write(path, &file, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.found, "\"42971.8 rpm\" is in conflict (limit 38197.2 rpm)");
    assert_true(access(path, F_OK) != 0);
    w.sealed = true;
    CHECK_OK(imk_design_write(path, &file, &error));
    imk_design_file back = {.design = NULL};
    CHECK_STATUS(imk_design_open(path, &back, &error),
                 IMK_ERROR_NAME_UNKNOWN); /* none of the list */
    assert_int_equal(error.line, 3);
    remove(path);
}

static void check_same_fields(const imk_instrument *instrument, const void *a, const void *b)
{
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        const size_t size = field->kind == IMK_DESIGN_NUMBER   ? sizeof(double)
                            : field->kind == IMK_DESIGN_SWITCH ? sizeof(bool)
                                                               : sizeof(int);
        if (memcmp((const char *)a + field->offset, (const char *)b + field->offset, size) != 0)
            fail_msg("%s %s is not read back", instrument->name, field->path);
    }
}

static double random_between(uint64_t *state, double low, double high)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return low + (high - low) * ((double)(*state >> 11) * 0x1p-53);
}

/* 2000 random designs: some doubles have no decimal in the table's unit and go through SI. */
static void written_designs_are_read_back_to_the_bit(void **state)
{
    (void)state;
    uint64_t random = 88172645463325252u;
    size_t in_si = 0;
    for (int i = 0; i < 2000; i++) {
        wheel w;
        wheel_default(&w);
        w.inertia = pow(10.0, random_between(&random, -12.0, -0.1));
        w.speed = random_between(&random, 10.0, 5000.0);
        w.quality = random_between(&random, 0.6, 1e6);
        w.temperature = random_between(&random, 1.0, 1000.0);
        w.noise = random_between(&random, 0.0, 1e-6);
        w.axis_offset = random_between(&random, -1e-3, 1e-3);
        w.blades = 1 + i % 64;
        w.loop = (wheel_loop)(i % 3);
        w.sealed = true;
        imk_design_file file = {.instrument = &wheel_instrument, .design = &w}, back;
        imk_error error;
        char *text;
        size_t size;
        CHECK_OK(imk_design_print(&file, &text, &size, NULL));
        in_si += strstr(text, "kg*m^2") != NULL;
        if (imk_design_parse_as(&wheel_instrument, text, size, &back, &error) != IMK_OK)
            fail_msg("%s: %s; %s", error.field, error.found, error.expected);
        check_same_fields(&wheel_instrument, &w, back.design);
        free(text);
        imk_design_file_free(&back);
    }
    assert_true(in_si > 0 && in_si < 2000);
}

/* ---- the instruments of the library ---------------------------------------------------------- */

static void check_signal(const char *instrument, const imk_signal *signal)
{
    const imk_unit si = imk_unit_of(signal->si), unit = imk_unit_of(signal->unit);
    if (!(si.scale == 1.0) || !(unit.scale > 0.0) ||
        !imk_dimension_equal(si.dimension, unit.dimension) || !signal->help[0] || !signal->name[0])
        fail_msg("%s: signal %s [%s, shown in %s]", instrument, signal->name, signal->si,
                 signal->unit);
}

static void check_table(const imk_instrument *instrument)
{
    static const char *const of_file[] = {"imukit", "instrument", "name", "description"};
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        for (size_t k = 0; k < COUNT(of_file); k++)
            if (strncmp(field->path, of_file[k], strcspn(field->path, ".")) == 0 &&
                of_file[k][strcspn(field->path, ".")] == '\0')
                fail_msg("%s: %s is a key of the file itself", instrument->name, field->path);
        if (strlen(field->path) > 80 || !field->help || !field->help[0])
            fail_msg("%s: field %zu", instrument->name, i);
        if (field->kind == IMK_DESIGN_NUMBER && !(imk_unit_of(field->unit).scale > 0.0))
            fail_msg("%s: %s: the unit \"%s\" is not known", instrument->name, field->path,
                     field->unit);
        if (field->kind == IMK_DESIGN_CHOICE && !field->choices)
            fail_msg("%s: %s: no choices", instrument->name, field->path);
        for (size_t k = 0; k < i; k++)
            if (strcmp(instrument->fields[k].path, field->path) == 0)
                fail_msg("%s: %s is there twice", instrument->name, field->path);
    }
    for (size_t i = 0; i < instrument->output_count; i++)
        check_signal(instrument->name, &instrument->outputs[i]);
    for (size_t i = 0; i < instrument->signal_count; i++)
        check_signal(instrument->name, &instrument->signals[i]);
    for (size_t i = 0; i < instrument->view_count; i++) {
        const imk_view *view = &instrument->views[i];
        const int count = (int)instrument->signal_count;
        bool good = view->x >= -1 && view->x < count && view->curve_count >= 1 &&
                    view->curve_count <= IMK_VIEW_CURVES_MAX && view->duration > 0.0 &&
                    view->rate > 0.0 && view->settle >= 0.0 && view->title && view->caption;
        for (int k = 0; good && k < view->curve_count; k++)
            good = view->y[k] >= 0 && view->y[k] < count &&
                   strcmp(instrument->signals[view->y[k]].unit,
                          instrument->signals[view->y[0]].unit) == 0;
        if (!good)
            fail_msg("%s: view %zu", instrument->name, i);
    }
}

/* Default designs are valid, can be found by name, written and read; names, units and views are
 * what the table's reader expects. */
static void every_instrument_has_a_table_that_works(void **state)
{
    (void)state;
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *instrument = imk_instrument_get(i);
        imk_design_file file = {.design = NULL}, back = {.design = NULL};
        imk_error error = {.status = IMK_OK};
        char *text, message[600];
        size_t size;
        check_table(instrument);
        assert_ptr_equal(imk_instrument_find(instrument->name), instrument);
        assert_true(instrument->output_count >= 1 && instrument->source[0] && instrument->title[0]);
        CHECK_OK(imk_design_open(instrument->name, &file, &error));
        imk_status status = imk_design_print(&file, &text, &size, &error);
        if (status == IMK_OK)
            status = imk_design_parse(text, size, &back, &error);
        imk_error_text(&error, instrument->name, message, sizeof message);
        if (status != IMK_OK)
            fail_msg("%s", message);
        check_same_fields(instrument, file.design, back.design);
        free(text);
        imk_design_file_free(&file);
        imk_design_file_free(&back);
    }
}

/* The designs that the documentation shows. */
static void the_examples_are_valid(void **state)
{
    (void)state;
    const char folder[] = SOURCE_DIRECTORY "/examples/instruments";
    DIR *listing = opendir(folder);
    if (!listing)
        skip();
    for (struct dirent *entry = readdir(listing); entry; entry = readdir(listing)) {
        char path[1024], message[600];
        imk_design_file file;
        imk_error error;
        if (!strstr(entry->d_name, ".yaml"))
            continue;
        snprintf(path, sizeof path, "%s/%.200s", folder, entry->d_name);
        if (imk_design_read(path, &file, &error) != IMK_OK) {
            imk_error_text(&error, path, message, sizeof message);
            fail_msg("%s", message);
        }
        imk_design_file_free(&file);
    }
    closedir(listing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_not_given_keep_the_default),
        cmocka_unit_test(fields_are_read_in_their_units),
        cmocka_unit_test(bad_files_are_refused_with_a_message),
        cmocka_unit_test(heads_are_checked),
        cmocka_unit_test(designs_are_written_with_units_and_help),
        cmocka_unit_test(written_designs_are_read_back_to_the_bit),
        cmocka_unit_test(every_instrument_has_a_table_that_works),
        cmocka_unit_test(the_examples_are_valid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
