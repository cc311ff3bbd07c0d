/* SPDX-License-Identifier: Apache-2.0 */
/* How the noise terms of a channel are called, and the units of their strengths. */
#include "imukit/identify_log.h"

#include "imukit/channel_units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Key in the model file, name, unit a person reads, SI unit. */
static const struct term_text {
    const char *key, *name, *unit, *si;
} term_texts[2][IMK_NOISE_TERMS] = {
    {{"quantization", "quantization", "arcsec", "rad"},
     {"angle_random_walk", "angle random walk", "deg/sqrt(h)", "rad/sqrt(s)"},
     {"bias_instability", "bias instability", "deg/h", "rad/s"},
     {"rate_random_walk", "rate random walk", "deg/h/sqrt(h)", "rad/s/sqrt(s)"},
     {"rate_ramp", "rate ramp", "deg/h/h", "rad/s^2"}},
    {{"quantization", "quantization", "m/s", "m/s"},
     {"velocity_random_walk", "velocity random walk", "m/s/sqrt(h)", "m/s/sqrt(s)"},
     {"bias_instability", "bias instability", "ug", "m/s^2"},
     {"acceleration_random_walk", "acceleration random walk", "ug/sqrt(h)", "m/s^2/sqrt(s)"},
     {"acceleration_ramp", "acceleration ramp", "ug/h", "m/s^3"}}};

/* Other channels: the column's unit with what time adds to it. */
static const struct term_text other_texts[IMK_NOISE_TERMS] = {
    {"quantization", "quantization", " s", NULL},
    {"white_noise", "white noise", "/sqrt(Hz)", NULL},
    {"bias_instability", "bias instability", "", NULL},
    {"random_walk", "random walk", "/sqrt(s)", NULL},
    {"ramp", "ramp", "/s", NULL}};

/* White noise of the integral, gyros, accelerometers, others. */
static const struct term_text white_texts[3] = {
    {"angle_white", "angle white noise", "arcsec/sqrt(Hz)", "rad/sqrt(Hz)"},
    {"velocity_white", "velocity white noise", "m/s/sqrt(Hz)", "m/s/sqrt(Hz)"},
    {"integral_white_noise", "white noise of the integral", " s/sqrt(Hz)", NULL}};

/* Reading noise, in the same order. */
static const struct term_text reading_texts[3] = {
    {"reading_noise", "reading noise", "arcsec", "rad"},
    {"reading_noise", "reading noise", "m/s", "m/s"},
    {"reading_noise", "reading noise", " s", NULL}};

static imk_term_display display_of(const imk_log_column *column, const struct term_text *text)
{
    imk_term_display display;
    memset(&display, 0, sizeof display);
    snprintf(display.key, sizeof display.key, "%s", text->key);
    snprintf(display.name, sizeof display.name, "%s", text->name);
    if (text->si) {
        display.unit = imk_unit_of(text->unit);
        display.si_scale = 1;
        snprintf(display.si, sizeof display.si, "%s", text->si);
    } else {
        display.unit = imk_channel_plain_unit(column);
        display.si_scale = display.unit.scale;
        char unit[48];
        snprintf(unit, sizeof unit, "%.30s%s", display.unit.text, text->unit);
        snprintf(display.unit.text, sizeof display.unit.text, "%s", unit);
        snprintf(display.si, sizeof display.si, "%.39s", unit);
    }
    return display;
}

imk_term_display imk_channel_term(const imk_log_column *column, imk_noise_term term)
{
    const imk_channel_kind kind = imk_channel_kind_of(column);
    return display_of(column,
                      kind == IMK_CHANNEL_OTHER ? &other_texts[term] : &term_texts[kind][term]);
}

imk_term_display imk_channel_angle_white(const imk_log_column *column, double dt)
{
    imk_term_display display = display_of(column, &white_texts[imk_channel_kind_of(column)]);
    display.unit.scale /= sqrt(dt);
    display.si_scale /= sqrt(dt);
    return display;
}

imk_term_display imk_channel_reading_noise(const imk_log_column *column)
{
    return display_of(column, &reading_texts[imk_channel_kind_of(column)]);
}

imk_term_display imk_identified_term(const imk_log_column *column, const imk_identification *result,
                                     imk_noise_term term)
{
    return term == IMK_NOISE_QUANTIZATION && result->term[term].present &&
                   !imk_identification_counted(result)
               ? imk_channel_angle_white(column, result->dt)
               : imk_channel_term(column, term);
}
