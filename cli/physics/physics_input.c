/* SPDX-License-Identifier: Apache-2.0 */
/* What an instrument is exposed to, from the options. */
#include "physics_parts.h"

#include <math.h>
#include <string.h>

/* The limit of the steps of a motion script: at higher temperatures nothing is solid. */
static const double largest_motion = 1e6; /* [rad/s], [m/s^2] */
static const double highest_temperature = 1e4;

/* One number is along x, three are x y z. */
static int read_vector(const char *name, const char *text, const char *unit, const char *most,
                       double *values)
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
    for (size_t k = 0; k < count; k++) {
        if (!(fabs(read[k]) <= largest_motion))
            return command_misused("--%s %s: expected at most %s", name, text, most);
        values[k] = read[k];
    }
    return -1;
}

static int check(const physics_options *o)
{
    const bool is_sine = !isnan(o->sine), moves = o->rate || o->acceleration;
    if (is_sine && !moves)
        return command_misused("--sine is the frequency of the rate or acceleration given: add "
                               "--rate or --acceleration");
    if (is_sine && !(o->sine > 0))
        return command_misused("--sine: expected a frequency above 0");
    if (is_sine && !(o->sine <= 0.25 * o->output_rate))
        return command_misused("--sine %g Hz: the input is held over a sample of %g s, and a cycle "
                               "needs at least four samples; add --output-rate %gHz or more",
                               o->sine, 1 / o->output_rate, 4 * o->sine);
    if (!(o->temperature > 0 && o->temperature <= highest_temperature))
        return command_misused("--temperature: expected more than absolute zero, and at most "
                               "10000 K");
    const double end = isnan(o->duration) ? 0 : o->temperature + o->temperature_rate * o->duration;
    if (!(fabs(o->temperature_rate) <= highest_temperature && end <= highest_temperature))
        return command_misused("--temperature-rate: expected at most 10000 K/s, and to end at no "
                               "more than 10000 K");
    return -1;
}

int physics_input_make(const physics_options *o, imk_physics_input *input)
{
    *input = (imk_physics_input){.exposure = imk_exposure_default(),
                                 .frequency = isnan(o->sine) ? 0 : o->sine,
                                 .temperature_rate = o->temperature_rate};
    input->exposure.temperature = o->temperature;
    input->exposure.temperature_rate = o->temperature_rate;
    int code = check(o);
    if (code < 0 && o->rate)
        code = read_vector("rate", o->rate, "deg/s", "1e6 rad/s, which is 5.7e7 deg/s",
                           input->exposure.angular_rate);
    if (code < 0 && o->acceleration)
        code = read_vector("acceleration", o->acceleration, "m/s^2", "1e6 m/s^2, which is 102000 g",
                           input->exposure.specific_force);
    return code;
}
