/* SPDX-License-Identifier: Apache-2.0 */
/* Schematics of the instruments: their tables, the drawings read back as XML, and their motion. */
#include "check.h"
#include "report/figure_internal.h"

#include "imukit/physics.h"
#include "imukit/schematic.h"
#include "imukit/units.h"

#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading a drawing ----------------------------------------------------------------------- */

enum { TEXTS_MAX = 100, DESIGN_MAX = 1024 };

typedef struct label {
    double left, right, top, bottom;
    char text[200];
} label;

/* What stands in a drawing. */
typedef struct drawing {
    const imk_schematic *schematic;
    int drawn[IMK_SCHEMATIC_PARTS_MAX]; /* how often each part is */
    int texts, titles, descriptions;
    int moving, resting; /* animations with and without different values */
    bool in_text;
    double x, y;
    int anchor;
    label label[TEXTS_MAX];
    char words[200];
} drawing;

static const char *attribute(const char **attributes, const char *name)
{
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

static void read_part(drawing *d, const char **attributes)
{
    const imk_schematic *s = d->schematic;
    const char *id = attribute(attributes, "id");
    for (size_t p = 0; p < s->part_count; p++) {
        if (strcmp(s->parts[p].id, id) != 0)
            continue;
        assert_string_equal(attribute(attributes, "data-signal"), s->parts[p].signal);
        assert_string_equal(attribute(attributes, "data-move"), imk_move_name(s->parts[p].move));
        assert_non_null(attribute(attributes, "data-gain"));
        assert_non_null(attribute(attributes, "data-base"));
        assert_non_null(attribute(attributes, "data-origin"));
        d->drawn[p]++;
        return;
    }
    fail_msg("%s: a part \"%s\" that is not in the table", s->instrument->name, id);
}

/* Do the values of an animation differ? */
static bool differs(const char *values)
{
    const char *next = strchr(values, ';');
    const size_t first = next ? (size_t)(next - values) : strlen(values);
    for (; next; next = strchr(next + 1, ';'))
        if (strncmp(next + 1, values, first) != 0)
            return true;
    return false;
}

static void begin(void *context, const char *name, const char **attributes)
{
    drawing *d = context;
    const char *class = attribute(attributes, "class");
    if (class && strcmp(class, "part") == 0)
        read_part(d, attributes);
    d->titles += strcmp(name, "title") == 0;
    d->descriptions += strcmp(name, "desc") == 0;
    if (strncmp(name, "animate", 7) == 0) {
        const bool moves = differs(attribute(attributes, "values"));
        d->moving += moves;
        d->resting += !moves;
    }
    if (strcmp(name, "text") == 0) {
        const char *anchor = attribute(attributes, "text-anchor");
        d->in_text = true;
        d->words[0] = '\0';
        d->x = strtod(attribute(attributes, "x"), NULL);
        d->y = strtod(attribute(attributes, "y"), NULL);
        d->anchor = !anchor ? 0 : strcmp(anchor, "middle") == 0 ? 1 : 2;
    }
}

static void words(void *context, const char *text, int length)
{
    drawing *d = context;
    if (d->in_text)
        snprintf(d->words + strlen(d->words), sizeof d->words - strlen(d->words), "%.*s", length,
                 text);
}

static void end(void *context, const char *name)
{
    drawing *d = context;
    if (strcmp(name, "text") != 0)
        return;
    assert_true(d->texts < TEXTS_MAX);
    label *l = &d->label[d->texts++];
    const double width = imki_line_width(d->words, 20);
    l->left = d->x - 0.5 * d->anchor * width;
    l->right = l->left + width;
    l->top = d->y - 16;
    l->bottom = d->y + 4;
    snprintf(l->text, sizeof l->text, "%s", d->words);
    d->in_text = false;
}

static void read_drawing(const imk_schematic *schematic, const char *svg, size_t size, drawing *d)
{
    memset(d, 0, sizeof *d);
    d->schematic = schematic;
    XML_Parser parser = XML_ParserCreate(NULL);
    XML_SetUserData(parser, d);
    XML_SetElementHandler(parser, begin, end);
    XML_SetCharacterDataHandler(parser, words);
    if (XML_Parse(parser, svg, (int)size, 1) != XML_STATUS_OK)
        fail_msg("%s: %s in line %lu", schematic->instrument->name,
                 XML_ErrorString(XML_GetErrorCode(parser)), XML_GetCurrentLineNumber(parser));
    XML_ParserFree(parser);
}

/* ---- what every schematic must be ------------------------------------------------------------ */

typedef void visitor(const imk_schematic *schematic, void *design);

/* Each schematic with the default design. */
static void for_each(visitor *visit)
{
    static _Alignas(64) unsigned char design[DESIGN_MAX];
    for (size_t i = 0; i < imk_instrument_count(); i++) {
        const imk_instrument *instrument = imk_instrument_get(i);
        const imk_schematic *schematic = imk_schematic_of(instrument);
        assert_true(instrument->design_size <= sizeof design);
        if (!schematic)
            fail_msg("%s has no schematic", instrument->name);
        assert_ptr_equal(schematic->instrument, instrument);
        instrument->set_default(design);
        visit(schematic, design);
    }
}

static bool is_signal(const imk_instrument *instrument, const char *name)
{
    for (size_t i = 0; i < instrument->signal_count; i++)
        if (strcmp(instrument->signals[i].name, name) == 0)
            return true;
    for (size_t i = 0; i < instrument->output_count; i++)
        if (strcmp(instrument->outputs[i].name, name) == 0)
            return true;
    return strcmp(name, "input") == 0 || strcmp(name, "turned") == 0 || strcmp(name, "screen") == 0;
}

static void check_parts(const imk_schematic *s, void *design)
{
    assert_in_range(s->part_count, 1, IMK_SCHEMATIC_PARTS_MAX);
    for (size_t p = 0; p < s->part_count; p++) {
        const imk_schematic_part *part = &s->parts[p];
        if (!is_signal(s->instrument, part->signal))
            fail_msg("%s: part %s moves by \"%s\", which is no signal", s->instrument->name,
                     part->id, part->signal);
        bool led = !part->with;
        for (size_t q = 0; q < s->part_count; q++) {
            assert_true(p == q || strcmp(part->id, s->parts[q].id) != 0);
            led = led || (strcmp(part->with, s->parts[q].id) == 0 && !s->parts[q].with);
        }
        assert_true(led);
        const double gain = imk_schematic_gain(s, design, p);
        assert_true(gain != 0 && isfinite(gain));
    }
    assert_true(imk_schematic_pace(s, design) > 0);
}

static void check_quantities(const imk_schematic *s, void *design)
{
    const imk_exposure exposure = {
        .angular_rate = {0.1}, .specific_force = {1}, .temperature = 300};
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX] = {0}, signals[IMK_INSTRUMENT_SIGNALS_MAX] = {0};
    const imk_schematic_moment moment = {
        .exposure = &exposure, .outputs = outputs, .signals = signals};
    assert_true(s->quantity_count >= 3);
    for (size_t i = 0; i < s->quantity_count; i++) {
        const imk_schematic_quantity q = imk_schematic_quantity_get(s, i);
        if (!q.symbol || !q.si || !q.unit || !q.equation)
            fail_msg("%s: \"%s\" is no derived quantity", s->instrument->name, q.name);
        const imk_unit si = imk_unit_of(q.si), unit = imk_unit_of(q.unit);
        assert_true(si.scale == 1 && unit.scale > 0);
        assert_true(imk_dimension_equal(si.dimension, unit.dimension));
        assert_false(isinf(imk_schematic_quantity_value(s, design, i, &moment)));
    }
}

static void check_drawing(const imk_schematic *s, const void *design)
{
    static drawing d;
    imk_error error;
    char *svg;
    size_t size;
    CHECK_OK(imk_schematic_svg(s->instrument, design, &svg, &size, &error));
    assert_int_equal(strlen(svg), size);
    read_drawing(s, svg, size, &d);
    free(svg);
    assert_int_equal(d.titles, 1);
    assert_int_equal(d.descriptions, 1);
    for (int i = 0; i < d.texts; i++) {
        const label *a = &d.label[i];
        if (!(a->left >= 4 && a->right <= IMK_SCHEMATIC_WIDTH - 4 && a->top >= 4 &&
              a->bottom <= IMK_SCHEMATIC_HEIGHT - 4))
            fail_msg("%s: \"%s\" leaves the sheet", s->instrument->name, a->text);
        for (int k = 0; k < i; k++) {
            const label *b = &d.label[k];
            if (a->left < b->right && b->left < a->right && a->top < b->bottom &&
                b->top < a->bottom)
                fail_msg("%s: \"%s\" and \"%s\" overlap", s->instrument->name, a->text, b->text);
        }
    }
}

static void check_every_part_drawn(const imk_schematic *s, void *design)
{
    static drawing d;
    imk_error error;
    char *svg;
    size_t size;
    CHECK_OK(imk_schematic_svg(s->instrument, design, &svg, &size, &error));
    read_drawing(s, svg, size, &d);
    free(svg);
    for (size_t p = 0; p < s->part_count; p++)
        if (d.drawn[p] != 1)
            fail_msg("%s: part %s is drawn %d times", s->instrument->name, s->parts[p].id,
                     d.drawn[p]);
    check_drawing(s, design);
}

/* A run as a page does it, 60 steps a second on the screen. */
static void check_starts(const imk_schematic *s, const void *design, const char *path)
{
    static _Alignas(64) unsigned char state[1 << 20];
    imk_physics_settings settings = imk_physics_default();
    imk_error error;
    assert_true(s->instrument->state_size <= sizeof state);
    memset(state, 0, s->instrument->state_size);
    settings.rate = 60 / imk_schematic_pace(s, design);
    if (imk_instrument_init(s->instrument, design, &settings, state, &error) != IMK_OK)
        fail_msg("%s: %s: %s: %s, %s", s->instrument->name, path, error.field, error.found,
                 error.expected);
}

/* With each slider anywhere, the design is valid and drawn, and runs. */
static void check_sliders(const imk_schematic *s, void *design)
{
    int fields = 0;
    for (size_t i = 0; i < s->slider_count; i++) {
        const imk_schematic_slider *slider = &s->sliders[i];
        const imk_instrument *instrument = s->instrument;
        const imk_design_field *field = NULL;
        for (size_t f = 0; f < instrument->field_count; f++)
            if (strcmp(instrument->fields[f].path, slider->path) == 0)
                field = &instrument->fields[f];
        if (!field) {
            assert_non_null(slider->unit);
            const char *si = strcmp(slider->path, "rate") == 0           ? "rad/s"
                             : strcmp(slider->path, "acceleration") == 0 ? "m/s^2"
                             : strcmp(slider->path, "temperature") == 0  ? "K"
                                                                         : NULL;
            if (!si)
                fail_msg("%s: no field %s", instrument->name, slider->path);
            assert_true(imk_dimension_equal(imk_unit_of(si).dimension,
                                            imk_unit_of(slider->unit).dimension));
            assert_true(slider->minimum < slider->maximum);
            continue;
        }
        fields++;
        for (int k = 0; k <= 8; k++) {
            instrument->set_default(design);
            void *at = (char *)design + field->offset;
            const double part = k / 8.0;
            const imk_unit unit = imk_unit_of(slider->unit ? slider->unit : field->unit);
            if (field->kind == IMK_DESIGN_NUMBER) {
                assert_true(slider->minimum < slider->maximum);
                const double value =
                    slider->logarithmic
                        ? slider->minimum * pow(slider->maximum / slider->minimum, part)
                        : slider->minimum + part * (slider->maximum - slider->minimum);
                *(double *)at = value * unit.scale + unit.offset;
            } else if (field->kind == IMK_DESIGN_CHOICE) {
                *(int *)at = k % 2;
            } else {
                *(bool *)at = k % 2;
            }
            check_starts(s, design, slider->path);
            if (k % 4 == 0 || field->kind != IMK_DESIGN_NUMBER)
                check_drawing(s, design);
        }
        instrument->set_default(design);
    }
    assert_in_range(fields, 2, 6);
}

/* At the ends of the range of any field, too, the drawing is one, if the design is possible. */
static void check_extremes(const imk_schematic *s, void *design)
{
    const imk_instrument *instrument = s->instrument;
    imk_error error;
    int drawn = 0;
    for (size_t f = 0; f < instrument->field_count; f++) {
        const imk_design_field *field = &instrument->fields[f];
        for (int end = 0; end < 2; end++) {
            instrument->set_default(design);
            void *at = (char *)design + field->offset;
            const double value = end ? field->maximum : field->minimum;
            if (field->kind == IMK_DESIGN_NUMBER)
                *(double *)at = value > 0 && field->open && !end ? 1.001 * value : value;
            else if (field->kind == IMK_DESIGN_COUNT)
                *(int *)at = (int)value;
            else if (field->kind == IMK_DESIGN_CHOICE)
                *(int *)at = end;
            else
                *(bool *)at = end;
            if (imk_design_check(instrument, design, &error) != IMK_OK)
                continue;
            check_drawing(s, design);
            drawn++;
        }
    }
    instrument->set_default(design);
    assert_true(drawn >= (int)instrument->field_count / 2);
}

/* Every part moves in the animation, which is short. */
static void check_animation(const imk_schematic *s, void *design)
{
    static drawing d;
    imk_physics_log_settings settings = imk_physics_log_default();
    imk_error error;
    char *svg;
    size_t size;
    settings.instrument = s->instrument;
    settings.design = design;
    settings.physics.seed = 1;
    CHECK_OK(imk_schematic_animated(&settings, 0, 0, NULL, &svg, &size, &error));
    assert_true(size < 60000);
    read_drawing(s, svg, size, &d);
    free(svg);
    int held = 0;
    for (size_t p = 0; p < s->part_count; p++)
        held += s->parts[p].held;
    assert_int_equal(d.moving + d.resting, s->part_count);
    assert_true(d.resting <= held);
}

/* ---- one of them by hand --------------------------------------------------------------------- */

/* The mass of the MEMS accelerometer at each moment, by a run of the instrument itself: 30 px are
 * the gap. Ten periods of the springs last 4 s, and the specific force is a sine of 5 g whose
 * period they are. */
static void test_values(void **state)
{
    (void)state;
    enum { FRAMES = 50 };
    static _Alignas(64) unsigned char instrument_state[1 << 16];
    const imk_instrument *instrument = &imk_mems_accelerometer_instrument;
    imk_mems_accelerometer design = imk_mems_accelerometer_default();
    imk_physics_log_settings settings = imk_physics_log_default();
    imk_physics_input input = {.exposure = imk_exposure_default(),
                               .frequency = design.frequency / 10};
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    imk_error error;
    char *svg;
    size_t size;
    settings.instrument = instrument;
    settings.design = &design;
    CHECK_OK(imk_schematic_animated(&settings, 0, FRAMES, NULL, &svg, &size, &error));
    assert_non_null(strstr(svg, "prefers-reduced-motion"));
    const char *value = strstr(svg, "type=\"translate\"");
    assert_non_null(value);
    assert_true(value > strstr(svg, "<g class=\"s-moving\">"));
    assert_non_null(strstr(value, "dur=\"4000ms\""));
    value = strstr(value, "values=\"") + 8;
    assert_true(instrument->state_size <= sizeof instrument_state);
    memset(instrument_state, 0, sizeof instrument_state);
    settings.physics.rate = (FRAMES - 1) / (10 / design.frequency);
    CHECK_OK(imk_instrument_init(instrument, &design, &settings.physics, instrument_state, &error));
    input.exposure.specific_force[0] = 5 * 9.80665;
    for (int k = 0; k < FRAMES; k++) {
        const imk_exposure e = imk_physics_input_at(&input, settings.physics.rate, (uint64_t)k);
        instrument->step(instrument_state, &e, outputs);
        instrument->observe(instrument_state, signals);
        char *end;
        /* tenths of a pixel are written */
        CHECK_CLOSE(strtod(value, &end), 30 / design.gap * signals[0], 0.0501);
        assert_true(*end == (k < FRAMES - 1 ? ';' : '"'));
        value = end + 1;
    }
    free(svg);
}

static void test_refusals(void **state)
{
    (void)state;
    imk_ring_laser design = imk_ring_laser_default();
    imk_physics_log_settings settings = imk_physics_log_default();
    imk_error error;
    char *svg = NULL;
    size_t size;
    settings.instrument = &imk_ring_laser_instrument;
    CHECK_STATUS(imk_schematic_svg(NULL, &design, &svg, &size, &error), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_schematic_svg(settings.instrument, NULL, &svg, &size, &error),
                 IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_schematic_animated(&settings, 0, 0, NULL, &svg, &size, &error),
                 IMK_ERROR_ARGUMENT); /* no design */
    settings.design = &design;
    CHECK_STATUS(imk_schematic_animated(&settings, 0, 1, NULL, &svg, &size, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "frames");
    CHECK_STATUS(imk_schematic_animated(&settings, 0, 121, NULL, &svg, &size, &error),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_schematic_animated(&settings, 0.5, 0, NULL, &svg, &size, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "seconds");
    CHECK_STATUS(imk_schematic_animated(&settings, (double)NAN, 0, NULL, &svg, &size, &error),
                 IMK_ERROR_RANGE);
    design.cavity.perimeter = (double)NAN;
    CHECK_STATUS(imk_schematic_svg(settings.instrument, &design, &svg, &size, &error),
                 IMK_ERROR_NOT_FINITE);
    assert_string_equal(error.field, "cavity.perimeter");
    assert_null(svg);
}

static void test_parts(void **state)
{
    (void)state;
    for_each(check_parts);
}

static void test_quantities(void **state)
{
    (void)state;
    for_each(check_quantities);
}

/* A spring or a torquer holds the gimbal against the gyroscopic torque, and its torque turns the
 * wheel after the case. */
static void check_held(const char *name, const char *signal, double momentum)
{
    const imk_schematic *s = imk_schematic_of(imk_instrument_find(name));
    const imk_exposure exposure = {.angular_rate = {0.1}, .temperature = 293.15};
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX] = {0}, signals[IMK_INSTRUMENT_SIGNALS_MAX] = {0};
    const imk_schematic_moment moment = {
        .exposure = &exposure, .outputs = outputs, .signals = signals};
    static _Alignas(64) unsigned char design[DESIGN_MAX];
    s->instrument->set_default(design);
    for (size_t i = 0; i < s->instrument->signal_count; i++)
        if (strcmp(s->instrument->signals[i].name, signal) == 0)
            signals[i] = momentum * 0.1;
    CHECK_RELATIVE(imk_schematic_quantity_value(s, design, 1, &moment), momentum * 0.1, 1e-12);
    CHECK_RELATIVE(imk_schematic_quantity_value(s, design, 2, &moment), -momentum * 0.1, 1e-12);
    CHECK_RELATIVE(imk_schematic_quantity_value(s, design, 3, &moment), 0.1, 1e-12);
}

static void test_held_wheels(void **state)
{
    (void)state;
    check_held("rate_gyro", "spring_torque", 0.001);
    check_held("rate_integrating_gyro", "torquer_torque", 0.04);
}

static void test_drawings(void **state)
{
    (void)state;
    for_each(check_every_part_drawn);
}

static void test_sliders(void **state)
{
    (void)state;
    for_each(check_sliders);
}

static void test_extremes(void **state)
{
    (void)state;
    for_each(check_extremes);
}

static void test_animations(void **state)
{
    (void)state;
    for_each(check_animation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts),       cmocka_unit_test(test_quantities),
        cmocka_unit_test(test_held_wheels), cmocka_unit_test(test_drawings),
        cmocka_unit_test(test_sliders),     cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_animations),  cmocka_unit_test(test_values),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
