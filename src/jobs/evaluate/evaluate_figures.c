/* SPDX-License-Identifier: Apache-2.0 */
/* The figures of a channel as they are shown: names, definitions, units. */
#include "imukit/evaluate_sheet.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

typedef enum shown_in { IN_SLOPE, IN_READING, IN_REFERENCE, IN_PERCENT, IN_PPM } shown_in;

typedef enum figure_kind {
    PLAIN = 0,
    SLOPE_ERROR, /* a slope less 1, where reading and reference are one quantity */
    OF_RUNS,     /* an imk_repeatability, where there are two runs */
    AT_REST      /* of the log at rest */
} figure_kind;

#define AT(member) offsetof(imk_evaluation, member)

typedef struct definition {
    const char *key, *title, *definition;
    shown_in unit;
    figure_kind kind;
    bool is_signed;
    size_t at;    /* where it is in imk_evaluation */
    size_t level; /* the same of its level; 0: no such place */
} definition;

static const definition definitions[] = {
    {"sensitivity", "sensitivity (scale factor)",
     "Slope of the straight line fitted to the mean readings by least squares.", IN_SLOPE, PLAIN,
     false, AT(sensitivity), 0},
    {"scale_factor_error", "scale factor error", "Sensitivity minus 1.", IN_PPM, SLOPE_ERROR, true,
     AT(sensitivity), 0},
    {"zero", "reading at zero (bias)",
     "Reading of the least-squares line where the reference is 0.", IN_READING, PLAIN, true,
     AT(zero), 0},
    {"accuracy", "accuracy",
     "Largest difference between the mean reading of a level and its reference.", IN_READING, PLAIN,
     false, AT(accuracy), AT(accuracy_level)},
    {"coverage", "accuracy with coverage",
     "Half-width of the interval about the reference that contains the stated share of single "
     "readings at the worst level; mean error and noise are both included.",
     IN_READING, PLAIN, false, AT(coverage), AT(accuracy_level)},
    {"precision", "precision",
     "Standard deviation of readings under repeatability conditions: the same reference, reached "
     "from the same side, in the same run.",
     IN_READING, PLAIN, false, AT(precision), 0},
    {"linearity", "linearity, least-squares line",
     "Largest distance of a level's mean reading (of both directions) from the least-squares line, "
     "in % of full scale.",
     IN_PERCENT, PLAIN, false, AT(linearity), AT(linearity_level)},
    {"linearity_best", "linearity, best line",
     "Largest distance of a level's mean reading from the line that makes this distance smallest "
     "(minimax line), in % of full scale.",
     IN_PERCENT, PLAIN, false, AT(linearity_best), AT(alternation)},
    {"hysteresis", "hysteresis",
     "Largest difference between the mean readings with rising and with falling reference, in % of "
     "full scale.",
     IN_PERCENT, PLAIN, false, AT(hysteresis), AT(hysteresis_level)},
    {"asymmetry", "asymmetry (K+ - K-)/K",
     "Difference of the slopes for positive and negative reference, divided by their mean; the two "
     "lines meet at reference 0.",
     IN_PPM, PLAIN, true, AT(asymmetry), 0},
    {"resolution", "resolution",
     "Smallest step of the reference such that it and all larger tested steps changed the reading "
     "by at least half of the change expected from the sensitivity. It has no value where all "
     "tested steps did.",
     IN_REFERENCE, PLAIN, false, AT(resolution), 0},
    {"threshold", "threshold", "Resolution for changes of the reference from 0.", IN_REFERENCE,
     PLAIN, false, AT(threshold), 0},
    {"zero_repeatability", "bias repeatability",
     "Standard deviation, from run to run, of the reading at zero, less the contribution of the "
     "noise within the runs.",
     IN_READING, OF_RUNS, false, AT(run_zero), 0},
    {"sensitivity_repeatability", "scale factor repeatability",
     "Standard deviation, from run to run, of the sensitivity, less the contribution of the noise "
     "within the runs.",
     IN_PPM, OF_RUNS, false, AT(run_sensitivity), 0},
    {"bias_instability", "bias instability B, fitted",
     "Flicker coefficient of the noise at rest, separated from white noise and random walk by "
     "maximum likelihood.",
     IN_READING, AT_REST, false, 0, 0},
    {"allan_minimum", "Allan minimum / 0.664",
     "Smallest Allan deviation divided by 0.664. White noise N and random walk K raise it above B: "
     "for the three together, minimum^2 = 0.4413 B^2 + 2 N K/sqrt(3).",
     IN_READING, AT_REST, false, 0, 0},
};
enum { DEFINITIONS = sizeof definitions / sizeof *definitions };
_Static_assert(DEFINITIONS <= (int)IMK_EVALUATE_ROWS, "there is room for all");

size_t imk_evaluate_limit_keys(const char *key[IMK_EVALUATE_ROWS])
{
    for (size_t k = 1; k < DEFINITIONS; k++) /* all but the sensitivity */
        key[k - 1] = definitions[k].key;
    return DEFINITIONS - 1;
}

static imk_evaluate_row *add_row(imk_evaluate_sheet *sheet, const definition *d,
                                 imk_evaluation_figure figure, imk_unit unit)
{
    imk_evaluate_row *row = &sheet->row[sheet->count++];
    *row = (imk_evaluate_row){.key = d->key,
                              .title = d->title,
                              .definition = d->definition,
                              .figure = figure,
                              .unit = unit,
                              .is_signed = d->is_signed,
                              .level = -1,
                              .limit = ""};
    if (imk_dimension_si(unit.dimension, row->si, sizeof row->si) == 0 || !row->si[0])
        snprintf(row->si, sizeof row->si, "1");
    return row;
}

/* reading/reference, as one unit to show in. */
static imk_unit slope_unit(const imk_evaluate_channel *c, char *si, size_t size)
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

static imk_unit unit_of(const imk_evaluate_channel *c, shown_in unit)
{
    static const char *const fixed[] = {[IN_PERCENT] = "%", [IN_PPM] = "ppm"};
    return unit == IN_READING     ? of_difference(c->reading_unit)
           : unit == IN_REFERENCE ? of_difference(c->reference_unit)
                                  : imk_unit_of(fixed[unit]);
}

static imk_evaluation_figure figure_of(const imk_evaluation *r, const definition *d)
{
    const void *at = (const char *)r + d->at;
    if (d->kind == OF_RUNS) {
        const imk_repeatability *runs = at;
        const double none = (double)NAN;
        return runs->runs < 2 ? (imk_evaluation_figure){none, none, none}
                              : (imk_evaluation_figure){runs->value, runs->lower, runs->upper};
    }
    const imk_evaluation_figure *f = at;
    const double less = d->kind == SLOPE_ERROR ? 1 : 0;
    return (imk_evaluation_figure){f->value - less, f->lower - less, f->upper - less};
}

void imk_evaluate_channel_figures(imk_evaluate_channel *c)
{
    const imk_evaluation *r = &c->result;
    char si[80];
    const imk_unit slope = slope_unit(c, si, sizeof si);
    c->sheet.count = 0;
    for (const definition *d = definitions; d < definitions + DEFINITIONS; d++) {
        if ((d->kind == SLOPE_ERROR && !c->settings.same_unit) ||
            (d->kind == OF_RUNS && r->runs < 2) || d->kind == AT_REST)
            continue;
        const bool is_slope = d->unit == IN_SLOPE;
        imk_evaluate_row *row =
            add_row(&c->sheet, d, figure_of(r, d), is_slope ? slope : unit_of(c, d->unit));
        if (is_slope)
            memcpy(row->si, si, sizeof si);
        if (d->level > 0)
            row->level = *(const int *)(const void *)((const char *)r + d->level);
    }
}

void imk_evaluate_rest_figures(imk_evaluate_rest *rest)
{
    const double none = (double)NAN;
    const imk_estimate *b = &rest->result.term[IMK_NOISE_BIAS_INSTABILITY];
    const imk_evaluation_figure figure[2] = {{b->value, b->lower, b->upper},
                                             {rest->result.minimum_floor, none, none}};
    rest->sheet.count = 0;
    for (size_t k = 0; rest->identified && k < 2; k++)
        (void)add_row(&rest->sheet, &definitions[DEFINITIONS - 2 + k], figure[k], rest->unit);
}
