/* SPDX-License-Identifier: Apache-2.0 */
/* What a page shows of the instrument that runs in it: its description as JSON, its schematic, and
 * where the parts of the schematic are at the moment. */
#include "live.h"

#include "imukit/result.h"
#include "imukit/schematic.h"

#include <stdlib.h>

#define EXPORT(name) __attribute__((export_name(#name))) name

/* ---- what is seen first ---------------------------------------------------------------------- */

/* Without a schematic: the first view, in six seconds. */
double live_first_pace(const imk_instrument *instrument, const void *design)
{
    const imk_schematic *schematic = imk_schematic_of(instrument);
    return schematic ? imk_schematic_pace(schematic, design) : instrument->views[0].duration / 6;
}

void live_first_input(const imk_instrument *instrument, imk_exposure *exposure)
{
    const imk_schematic *schematic = imk_schematic_of(instrument);
    const imk_view *view = &instrument->views[0];
    const bool gyro = instrument->sensor == IMK_GYRO;
    (gyro ? exposure->angular_rate : exposure->specific_force)[0] =
        schematic ? schematic->input : view->input;
    if (gyro)
        exposure->specific_force[0] = schematic ? schematic->force : view->force;
}

double live_settling(void)
{
    const imk_instrument *instrument = live.file.instrument;
    const imk_schematic *schematic = imk_schematic_of(instrument);
    return schematic ? schematic->settle : instrument->views[0].settle;
}

/* ---- description ----------------------------------------------------------------------------- */

static double in_unit(double value, const char *unit)
{
    const imk_unit u = imk_unit_of(unit);
    return (value - u.offset) / u.scale;
}

static void describe_signals(imk_result *result, const char *key, size_t count,
                             const imk_signal *signals, size_t first)
{
    imk_result_array(result, key);
    for (size_t i = 0; i < count; i++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "name", signals[i].name);
        imk_result_text(result, "unit", live_unit(live.file.instrument, first + i));
        imk_result_text(result, "help", signals[i].help);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void describe_fields(imk_result *result)
{
    const imk_instrument *instrument = live.file.instrument;
    char text[160];
    imk_result_array(result, "fields");
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        (void)imk_design_field_text(field, live.file.design, 0, text, sizeof text);
        imk_result_object(result, NULL);
        imk_result_text(result, "path", field->path);
        imk_result_text(result, "value", text);
        imk_result_text(result, "unit", field->kind == IMK_DESIGN_NUMBER ? field->unit : NULL);
        imk_result_text(result, "choices",
                        field->kind == IMK_DESIGN_SWITCH   ? "no|yes"
                        : field->kind == IMK_DESIGN_CHOICE ? field->choices
                                                           : NULL);
        imk_result_text(result, "help", field->help);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void describe_derived(imk_result *result)
{
    imk_result_array(result, "derived");
    for (const imk_derived *d = live.file.instrument->derived; d->name; d++) {
        const double value = imk_derived_value(d, live.file.design);
        imk_result_object(result, NULL);
        imk_result_text(result, "name", d->name);
        imk_result_text(result, "unit", d->unit);
        imk_result_text(result, "equation", d->equation);
        imk_result_text(result, "source", d->source);
        imk_result_text(result, "absent", d->absent);
        imk_result_number(result, "value", in_unit(value, d->unit));
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void describe_quantities(imk_result *result, const imk_schematic *schematic)
{
    imk_result_array(result, "quantities");
    for (size_t i = 0; schematic && i < schematic->quantity_count; i++) {
        const imk_schematic_quantity q = imk_schematic_quantity_get(schematic, i);
        imk_result_object(result, NULL);
        imk_result_text(result, "name", q.name);
        imk_result_text(result, "unit", q.unit);
        imk_result_text(result, "equation", q.equation);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void describe_sliders(imk_result *result, const imk_schematic *schematic)
{
    imk_result_array(result, "sliders");
    for (size_t i = 0; schematic && i < schematic->slider_count; i++) {
        const imk_schematic_slider *s = &schematic->sliders[i];
        imk_result_object(result, NULL);
        imk_result_text(result, "path", s->path);
        imk_result_number(result, "minimum", s->minimum);
        imk_result_number(result, "maximum", s->maximum);
        imk_result_text(result, "unit", s->unit);
        imk_result_flag(result, "logarithmic", s->logarithmic);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void describe_parts(imk_result *result, const imk_schematic *schematic)
{
    imk_result_array(result, "parts");
    for (size_t i = 0; schematic && i < schematic->part_count; i++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "id", schematic->parts[i].id);
        imk_result_text(result, "move", imk_move_name(schematic->parts[i].move));
        imk_result_numbers(result, "origin", 2,
                           (const double[]){schematic->parts[i].x, schematic->parts[i].y});
        imk_result_end(result);
    }
    imk_result_end(result);
}

/** All of the instrument and its design, as JSON. */
const char *EXPORT(live_describe)(void)
{
    static char *text;
    const imk_instrument *instrument = live.file.instrument;
    const imk_schematic *schematic = imk_schematic_of(instrument);
    size_t size;
    imk_result *result = imk_result_create(NULL);
    imk_result_text(result, "name", instrument->name);
    imk_result_text(result, "title", instrument->title);
    imk_result_text(result, "source", instrument->source);
    imk_result_flag(result, "gyro", instrument->sensor == IMK_GYRO);
    imk_result_text(result, "description", schematic ? schematic->description : NULL);
    imk_result_number(result, "rate", live.physics.rate);
    imk_result_number(result, "pace", live.pace);
    imk_result_numbers(result, "angular_rate", 3, live.exposure.angular_rate);
    imk_result_numbers(result, "specific_force", 3, live.exposure.specific_force);
    imk_result_number(result, "temperature", live.exposure.temperature);
    imk_result_count(result, "first_signal", instrument->views[0].y[0]);
    describe_signals(result, "outputs", instrument->output_count, instrument->outputs, 0);
    describe_signals(result, "signals", instrument->signal_count, instrument->signals,
                     instrument->output_count);
    describe_fields(result);
    describe_derived(result);
    describe_parts(result, schematic);
    describe_quantities(result, schematic);
    describe_sliders(result, schematic);
    free(text);
    if (imk_result_to_json(result, &text, &size) != IMK_OK)
        text = NULL;
    imk_result_free(result);
    return text ? text : "";
}

/* ---- drawing --------------------------------------------------------------------------------- */

/** The schematic as it rests, an SVG text; "" without one. */
const char *EXPORT(live_schematic)(void)
{
    static char *svg;
    size_t size;
    imk_error error;
    free(svg);
    if (imk_schematic_svg(live.file.instrument, live.file.design, &svg, &size, &error) != IMK_OK)
        svg = NULL;
    return svg ? svg : "";
}

/** The moment after the last row: time of the run [s], input along x in the unit of the first
 *  output, value of each part of the schematic, and each quantity in its unit. */
double *EXPORT(live_moment)(void)
{
    static double moment[2 + 2 * IMK_SCHEMATIC_PARTS_MAX + 32];
    double signals[IMK_INSTRUMENT_SIGNALS_MAX], *at = moment;
    const imk_schematic *schematic = imk_schematic_of(live.file.instrument);
    const void *design = live.file.design;
    const bool gyro = live.file.instrument->sensor == IMK_GYRO;
    const imk_schematic_moment now = {.exposure = &live.exposure,
                                      .outputs = live.outputs,
                                      .signals = signals,
                                      .turned = live.turned,
                                      .screen = live.screen};
    live.file.instrument->observe(live.state, signals);
    *at++ = (double)live.row / live.physics.rate;
    *at++ = in_unit(gyro ? live.exposure.angular_rate[0] : live.exposure.specific_force[0],
                    live_unit(live.file.instrument, 0));
    for (size_t i = 0; schematic && i < schematic->part_count; i++)
        *at++ = imk_schematic_place(schematic, design, i, &now);
    for (size_t i = 0; schematic && i < schematic->quantity_count; i++)
        *at++ = in_unit(imk_schematic_quantity_value(schematic, design, i, &now),
                        imk_schematic_quantity_get(schematic, i).unit);
    return moment;
}
