/* SPDX-License-Identifier: Apache-2.0 */
/* What an instrument is exposed to, from the options. */
#include "physics_parts.h"

#include <math.h>
#include <string.h>

/* One number is along x, three are x y z. */
static int read_vector(const char *name, const char *text, const char *unit, double *values)
{
    imk_error error;
    double read[3], sigmas[3];
    size_t count;
    const imk_dimension due = imk_unit_of(unit).dimension;
    const imk_status status =
        imk_quantity_parse(text, text + strlen(text), due, 3, read, sigmas, &count, NULL, &error);
    if (status == IMK_ERROR_UNIT_MISSING)
        return command_misused("--%s %s: the unit is missing; write --%s \"%s %s\"", name, text,
                               name, text, unit);
    if (status != IMK_OK || count == 2 || sigmas[0] != 0)
        return command_misused("--%s %s: %s; expected one number about x, or three, and a unit "
                               "such as %s",
                               name, text,
                               status == IMK_OK ? (count == 2 ? "there are two numbers"
                                                              : "an input has no uncertainty")
                               : error.found[0] ? error.found
                                                : imk_status_text(status),
                               imk_dimension_examples(due));
    memcpy(values, read, count * sizeof *values);
    return -1;
}

static int check_sine(const physics_options *o)
{
    if (isnan(o->sine))
        return -1;
    if (!o->rate && !o->acceleration)
        return command_misused("--sine is the frequency of the rate or acceleration given: add "
                               "--rate or --acceleration");
    return o->sine > 0 ? -1 : command_misused("--sine: expected a frequency above 0");
}

/* The library's refusal with the names of the options. */
static int check(const physics_options *o, const imk_physics_log_settings *settings)
{
    imk_error error;
    if (imk_physics_input_check(settings, &error) == IMK_OK)
        return -1;
    if (strcmp(error.field, "angular_rate") == 0)
        return command_misused("--rate %s: expected %s", o->rate, error.expected);
    if (strcmp(error.field, "specific_force") == 0)
        return command_misused("--acceleration %s: expected %s", o->acceleration, error.expected);
    if (strcmp(error.field, "frequency") == 0)
        return command_misused("--sine %g Hz: the input is held over a sample of %g s, and a cycle "
                               "needs at least four samples; add --output-rate %gHz or more",
                               o->sine, 1 / o->output_rate, 4 * o->sine);
    return command_misused("--temperature%s: expected %s",
                           strcmp(error.field, "temperature_rate") == 0 ? "-rate" : "",
                           error.expected);
}

int physics_input_make(const physics_options *o, imk_physics_log_settings *settings)
{
    imk_physics_input *input = &settings->input;
    *input = (imk_physics_input){.exposure = imk_exposure_default(),
                                 .frequency = isnan(o->sine) ? 0 : o->sine,
                                 .temperature_rate = o->temperature_rate};
    input->exposure.temperature = o->temperature;
    input->exposure.temperature_rate = o->temperature_rate;
    int code = check_sine(o);
    if (code < 0 && o->rate)
        code = read_vector("rate", o->rate, "deg/s", input->exposure.angular_rate);
    if (code < 0 && o->acceleration)
        code =
            read_vector("acceleration", o->acceleration, "m/s^2", input->exposure.specific_force);
    return code < 0 ? check(o, settings) : code;
}
