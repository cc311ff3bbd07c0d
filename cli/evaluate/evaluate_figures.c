/* SPDX-License-Identifier: Apache-2.0 */
/* The figures of a channel as they are shown: names, definitions, units. */
#include "evaluate_parts.h"

#include <math.h>
#include <string.h>

static evaluate_row row_of(const char *key, const char *title, const char *definition,
                           imk_evaluation_figure figure, imk_unit unit)
{
    evaluate_row row = {.key = key,
                        .title = title,
                        .definition = definition,
                        .figure = figure,
                        .unit = unit,
                        .level = -1};
    if (imk_dimension_si(unit.dimension, row.si, sizeof row.si) == 0 || !row.si[0])
        snprintf(row.si, sizeof row.si, "1");
    return row;
}

/* reading/reference, as one unit to show in. */
static imk_unit slope_unit(const evaluate_channel *c, char *si, size_t size)
{
    imk_unit unit = c->reading_unit;
    unit.scale = c->reading_unit.scale / c->reference_unit.scale;
    unit.offset = 0;
    char top[40], bottom[40];
    for (int k = 0; k < 7; k++)
        unit.dimension.half[k] =
            (int8_t)(c->reading_unit.dimension.half[k] - c->reference_unit.dimension.half[k]);
    if (strcmp(c->reading_unit.text, c->reference_unit.text) == 0) {
        snprintf(unit.text, sizeof unit.text, "1");
        snprintf(si, size, "1");
        return unit;
    }
    snprintf(unit.text, sizeof unit.text, "%.20s/(%.20s)", c->reading_unit.text,
             c->reference_unit.text);
    imk_dimension_si(c->reading_unit.dimension, top, sizeof top);
    imk_dimension_si(c->reference_unit.dimension, bottom, sizeof bottom);
    snprintf(si, size, "%.30s/(%.30s)", top, bottom);
    return unit;
}

/* A difference has no offset: 25 degC is a reading, 2 K an error. */
static imk_unit of_difference(imk_unit unit)
{
    if (unit.offset != 0)
        unit = imk_unit_of("K");
    return unit;
}

static imk_evaluation_figure of_repeatability(const imk_repeatability *r)
{
    const double none = (double)NAN;
    if (r->runs < 2)
        return (imk_evaluation_figure){none, none, none};
    return (imk_evaluation_figure){r->value, r->lower, r->upper};
}

static size_t slope_rows(const evaluate_channel *c, evaluate_row *row)
{
    const imk_evaluation *r = &c->result;
    const imk_unit reading = of_difference(c->reading_unit);
    size_t count = 0;
    char si[80];
    const imk_unit unit = slope_unit(c, si, sizeof si);
    row[count] = row_of("sensitivity", "sensitivity (scale factor)",
                        "Slope of the straight line fitted to the mean readings by least squares.",
                        r->sensitivity, unit);
    memcpy(row[count++].si, si, sizeof si);
    if (c->settings.same_unit) {
        const imk_evaluation_figure k = r->sensitivity;
        row[count] = row_of("scale_factor_error", "scale factor error", "Sensitivity less 1.",
                            (imk_evaluation_figure){k.value - 1, k.lower - 1, k.upper - 1},
                            imk_unit_of("ppm"));
        row[count++].is_signed = true;
    }
    row[count] = row_of("zero", "reading at zero (bias)",
                        "Reading of that line where the reference is 0.", r->zero, reading);
    row[count++].is_signed = true;
    return count;
}

static size_t error_rows(const evaluate_channel *c, evaluate_row *row)
{
    const imk_evaluation *r = &c->result;
    const imk_unit reading = of_difference(c->reading_unit);
    size_t count = 0;
    row[count] = row_of("accuracy", "accuracy",
                        "Largest difference between the mean reading of a level and its reference.",
                        r->accuracy, reading);
    row[count++].level = r->accuracy_level;
    row[count] = row_of("coverage", "accuracy with coverage",
                        "Half width about the reference that holds the stated share of single "
                        "readings at the worst level: mean error and noise together.",
                        r->coverage, reading);
    row[count++].level = r->accuracy_level;
    row[count++] = row_of("precision", "precision",
                          "Standard deviation of readings under repeatability conditions: the same "
                          "reference, reached from the same side, in the same run.",
                          r->precision, reading);
    return count;
}

static size_t line_rows(const evaluate_channel *c, evaluate_row *row)
{
    const imk_evaluation *r = &c->result;
    size_t count = 0;
    row[count] = row_of("linearity", "linearity, least-squares line",
                        "Largest distance of a level's mean reading (of both directions) from the "
                        "least-squares line, in % of full scale.",
                        r->linearity, imk_unit_of("%"));
    row[count++].level = r->linearity_level;
    row[count] = row_of("linearity_best", "linearity, best line",
                        "The same from the line for which it is smallest (minimax line).",
                        r->linearity_best, imk_unit_of("%"));
    row[count++].level = r->alternation[0];
    row[count] = row_of("hysteresis", "hysteresis",
                        "Largest difference between the mean readings with rising and with falling "
                        "reference, in % of full scale.",
                        r->hysteresis, imk_unit_of("%"));
    row[count++].level = r->hysteresis_level;
    row[count] =
        row_of("asymmetry", "asymmetry (K+ - K-)/K",
               "Difference of the slopes for positive and negative reference, of two lines "
               "that meet at reference 0, over their mean.",
               r->asymmetry, imk_unit_of("ppm"));
    row[count++].is_signed = true;
    return count;
}

static size_t step_rows(const evaluate_channel *c, evaluate_row *row)
{
    const imk_evaluation *r = &c->result;
    const imk_unit reference = of_difference(c->reference_unit);
    row[0] = row_of("resolution", "resolution",
                    "Smallest step of the reference from which on every tested step changed the "
                    "reading by at least half of what the sensitivity lets one expect.",
                    r->resolution, reference);
    row[1] = row_of("threshold", "threshold", "The same for changes of the reference from 0.",
                    r->threshold, reference);
    return 2;
}

static size_t run_rows(const evaluate_channel *c, evaluate_row *row)
{
    const imk_evaluation *r = &c->result;
    if (r->runs < 2)
        return 0;
    row[0] =
        row_of("zero_repeatability", "bias repeatability",
               "Standard deviation, from run to run, of the reading at zero; what noise within "
               "the runs explains is taken off.",
               of_repeatability(&r->run_zero), of_difference(c->reading_unit));
    row[1] = row_of("sensitivity_repeatability", "scale factor repeatability",
                    "The same of the sensitivity.", of_repeatability(&r->run_sensitivity),
                    imk_unit_of("ppm"));
    return 2;
}

size_t evaluate_figures(const evaluation *v, const evaluate_channel *channel,
                        evaluate_row row[EVALUATE_ROWS])
{
    (void)v;
    size_t count = slope_rows(channel, row);
    count += error_rows(channel, row + count);
    count += line_rows(channel, row + count);
    count += step_rows(channel, row + count);
    count += run_rows(channel, row + count);
    return count;
}

size_t evaluate_rest_figures(const evaluate_rest *rest, evaluate_row row[EVALUATE_ROWS])
{
    const double none = (double)NAN;
    if (!rest->identified)
        return 0;
    const imk_estimate *b = &rest->result.term[IMK_NOISE_BIAS_INSTABILITY];
    const imk_evaluation_figure fitted = {b->value, b->lower, b->upper};
    const imk_evaluation_figure floor = {rest->result.minimum_floor, none, none};
    row[0] = row_of("bias_instability", "bias instability B, fitted",
                    "Flicker coefficient of the noise at rest, told apart from white noise and "
                    "random walk by maximum likelihood.",
                    fitted, rest->unit);
    row[1] = row_of("allan_minimum", "Allan minimum / 0.664",
                    "Smallest Allan deviation over 0.664. White noise N and random walk K raise it "
                    "above B: minimum^2 = 0.4413 B^2 + 2 N K/sqrt(3) for the three together.",
                    floor, rest->unit);
    return 2;
}
