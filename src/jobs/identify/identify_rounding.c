/* SPDX-License-Identifier: Apache-2.0 */
/* Rounds what was identified to the digits it has, in the units of the model file.
 *
 * A written value must read back to the same double, so a raw estimate would fill the file with
 * seventeen digits in SI. Rounded to a hundredth of its 1-sigma uncertainty it is short and in the
 * usual unit, and what is simulated from the file is what the file says. */
#include "identify_log_internal.h"

#include "imukit/decimal.h"
#include "imukit/units.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Digits of a bound, and of a parameter whose uncertainty is not known. */
enum { BOUND_DIGITS = 3, PLAIN_DIGITS = 6 };

/* The double a reader gets from the value written with so many digits in a unit. */
static double rounded(double value, int digits, const char *unit)
{
    char text[80];
    double result, sigma;
    size_t count;
    imk_unit u = imk_unit_of(unit);
    if (value == 0 || !isfinite(value) || !(u.scale > 0))
        return value;
    size_t length = imk_decimal_significant(value / u.scale, digits, text);
    snprintf(text + length, sizeof text - length, " %s", unit);
    if (imk_quantity_parse(text, text + strlen(text), u.dimension, 1, &result, &sigma, &count, NULL,
                           NULL) != IMK_OK)
        return value;
    return result;
}

/* Significant digits that reach a hundredth of the uncertainty. */
static int digits_for(double value, double uncertainty)
{
    if (!(uncertainty > 0) || value == 0)
        return PLAIN_DIGITS;
    int digits = (int)floor(log10(fabs(value))) - (int)floor(log10(uncertainty)) + 3;
    return digits < BOUND_DIGITS ? BOUND_DIGITS : digits > 12 ? 12 : digits;
}

static void round_axes(imk_axes *axes, const char *unit)
{
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        double value = axes->value[axis], sigma = axes->sigma[axis];
        axes->value[axis] = rounded(value, digits_for(value, sigma), unit);
        axes->sigma[axis] = rounded(sigma, BOUND_DIGITS, unit);
    }
}

static void round_interval(imk_interval *interval, const char *unit)
{
    for (int axis = 0; axis < IMK_AXES_MAX; axis++) {
        double *lower = &interval->lower.value[axis], *upper = &interval->upper.value[axis];
        double quarter = (*upper - *lower) / 4; /* about 1 sigma of a 95 % interval */
        int digits = *lower > 0 ? digits_for(*upper, quarter) : BOUND_DIGITS;
        *upper = rounded(*upper, digits, unit);
        *lower = rounded(*lower, digits_for(*lower, quarter), unit);
    }
}

static void round_lists(imk_noise *noise, const char *unit)
{
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        round_axes(&noise->gauss_markov[i].sigma, unit);
        round_axes(&noise->gauss_markov[i].correlation_time, "s");
    }
    for (int i = 0; i < noise->sinusoid_count; i++) {
        round_axes(&noise->sinusoid[i].amplitude, unit);
        round_axes(&noise->sinusoid[i].frequency, "Hz");
    }
    for (int i = 0; i < noise->resonance_count; i++) {
        round_axes(&noise->resonance[i].sigma, unit);
        round_axes(&noise->resonance[i].frequency, "Hz");
        round_axes(&noise->resonance[i].q, "1");
    }
}

/* Unit of the parameter a dotted key of the evidence names. */
static const char *unit_of_key(const char *key, const imk_term_display *terms, size_t count,
                               const char *plain)
{
    if (strncmp(key, "noise.", 6) != 0)
        return plain;
    for (size_t term = 0; term < count; term++)
        if (strcmp(key + 6, terms[term].key) == 0)
            return terms[term].unit.text;
    return strstr(key, "time") ? "s" : plain;
}

static void round_triad(imk_triad *triad, imk_evidence *evidence, imk_quantity quantity,
                        const char *unit)
{
    const imk_log_column column = {.quantity = quantity};
    imk_noise *noise = &triad->noise;
    enum { TERMS = IMK_NOISE_TERMS + 2 };
    imk_axes *axes[TERMS] = {&noise->quantization, &noise->white, &noise->bias_instability,
                             &noise->random_walk,  &noise->ramp,  &noise->angle_white,
                             &noise->reading_noise};
    imk_term_display terms[TERMS];
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        terms[term] = imk_channel_term(&column, (imk_noise_term)term);
    terms[IMK_NOISE_TERMS] = imk_channel_angle_white(&column, 1);
    terms[IMK_NOISE_TERMS + 1] = imk_channel_reading_noise(&column);
    for (int term = 0; term < TERMS; term++)
        round_axes(axes[term], terms[term].unit.text);
    round_lists(noise, unit);
    round_axes(&triad->bandwidth, "Hz");
    round_axes(&triad->damping, "1");
    round_axes(&triad->resolution, unit);
    for (int i = 0; i < evidence->interval_count; i++)
        round_interval(&evidence->interval[i],
                       unit_of_key(evidence->interval[i].key, terms, TERMS, unit));
}

void imki_round_model(imk_model *model)
{
    round_triad(&model->gyro, &model->gyro_evidence, IMK_QUANTITY_ANGULAR_RATE, "deg/h");
    round_triad(&model->accel, &model->accel_evidence, IMK_QUANTITY_SPECIFIC_FORCE, "ug");
}
