/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan plot of each channel: measured points, the model and its terms, where a record of this
 * length may fall under the model, and the twin. */
#include "identify_parts.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdlib.h>

enum { MODEL_COLOR = 6, BAND_COLOR = 7, DATA_COLOR = 0, TWIN_COLOR = 4 };

/* Colours of the five terms in the house palette. */
static const int term_colors[IMK_NOISE_TERMS] = {3, 1, 2, 5, 4};

/* Numbers of one panel, cut from one piece of memory. */
typedef struct panel_data {
    size_t smooth_count, octave_count;
    double *tau, *total, *term[IMK_NOISE_TERMS];    /* smooth_count each */
    double *octave_tau, *deviation, *lower, *upper; /* octave_count each: measured */
    double *band_middle, *band_lower, *band_upper;  /* octave_count each: expected */
    double *twin;                                   /* octave_count */
} panel_data;

static double *cut(double **memory, size_t count)
{
    double *start = *memory;
    *memory += count;
    return start;
}

static double deviation_of(const imk_identification *r, double dt, size_t m, int term, double scale)
{
    return sqrt(imk_identification_allan_variance(r, dt, m, term)) / scale;
}

/* Under the model the measured variance is the model's times chi^2/edf. */
static void fill_octaves(panel_data *d, const identification *i, size_t channel, double scale)
{
    const allan_curve *measured = &i->curve[channel], *twin = &i->twin[channel];
    double tail = (1 - i->options->confidence) / 2;
    for (size_t k = 0; k < d->octave_count; k++) {
        const imk_allan_point *p = &measured->point[k];
        double middle = deviation_of(&i->result[channel], i->channels.dt, p->m, -1, scale);
        d->octave_tau[k] = measured->tau[k];
        d->deviation[k] = p->deviation / scale;
        d->lower[k] = p->lower / scale;
        d->upper[k] = p->upper / scale;
        d->band_middle[k] = middle;
        d->band_lower[k] = middle * sqrt(imk_chi_square_quantile(tail, p->edf) / p->edf);
        d->band_upper[k] = middle * sqrt(imk_chi_square_quantile(1 - tail, p->edf) / p->edf);
        if (twin->count == d->octave_count)
            d->twin[k] = twin->point[k].deviation / scale;
    }
}

static bool fill(panel_data *d, const identification *i, size_t channel, double scale,
                 double **memory)
{
    const imk_identification *r = &i->result[channel];
    double dt = i->channels.dt;
    size_t *factors = allan_factors_of_grid(IMK_ALLAN_DECADE, i->channels.rows, &d->smooth_count);
    d->octave_count = i->curve[channel].count;
    *memory =
        malloc(((2 + IMK_NOISE_TERMS) * d->smooth_count + 8 * d->octave_count) * sizeof **memory);
    if (!factors || !*memory) {
        free(factors);
        return false;
    }
    double *rest = *memory;
    d->tau = cut(&rest, d->smooth_count);
    d->total = cut(&rest, d->smooth_count);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        d->term[term] = cut(&rest, d->smooth_count);
    double **octaves[] = {&d->octave_tau,  &d->deviation,  &d->lower,      &d->upper,
                          &d->band_middle, &d->band_lower, &d->band_upper, &d->twin};
    for (size_t k = 0; k < sizeof octaves / sizeof octaves[0]; k++)
        *octaves[k] = cut(&rest, d->octave_count);
    for (size_t k = 0; k < d->smooth_count; k++) {
        d->tau[k] = dt * (double)factors[k];
        d->total[k] = deviation_of(r, dt, factors[k], -1, scale);
        for (int term = 0; term < IMK_NOISE_TERMS; term++)
            d->term[term][k] = deviation_of(r, dt, factors[k], term, scale);
    }
    free(factors);
    fill_octaves(d, i, channel, scale);
    return true;
}

static size_t make_curves(imk_curve *curve, const panel_data *d, const identification *i,
                          size_t channel)
{
    /* Names of the terms in the key: string literals of the table live for ever. */
    static const char *const names[2][IMK_NOISE_TERMS] = {
        {"quantization", "angle random walk", "bias instability", "rate random walk", "rate ramp"},
        {"quantization", "velocity random walk", "bias instability", "acceleration random walk",
         "acceleration ramp"}};
    bool accel = channel_kind_of(log_channel_column(&i->channels, channel)) == CHANNEL_ACCEL;
    size_t count = 0;
    curve[count++] = (imk_curve){"expected spread", IMK_CURVE_BAND, BAND_COLOR,    d->octave_count,
                                 d->octave_tau,     d->band_middle, d->band_lower, d->band_upper};
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        if (i->result[channel].term[term].present)
            curve[count++] = (imk_curve){names[accel][term],
                                         IMK_CURVE_DASHES,
                                         term_colors[term],
                                         d->smooth_count,
                                         d->tau,
                                         d->term[term],
                                         NULL,
                                         NULL};
    curve[count++] = (imk_curve){"model", IMK_CURVE_LINE, MODEL_COLOR, d->smooth_count,
                                 d->tau,  d->total,       NULL,        NULL};
    if (i->twin[channel].count == d->octave_count)
        curve[count++] = (imk_curve){"twin",        IMK_CURVE_POINTS, TWIN_COLOR, d->octave_count,
                                     d->octave_tau, d->twin,          NULL,       NULL};
    curve[count++] = (imk_curve){"log",         IMK_CURVE_POINTS, DATA_COLOR, d->octave_count,
                                 d->octave_tau, d->deviation,     d->lower,   d->upper};
    return count;
}

bool identify_figure_make(const identification *i, identify_figure *figure)
{
    size_t count = i->channels.count;
    for (size_t c = 0; c < count; c++)
        figure->memory[c] = NULL;
    for (size_t c = 0; c < count; c++) {
        const imk_log_column *column = log_channel_column(&i->channels, c);
        const allan_curve *measured = &i->curve[c];
        imk_unit unit = channel_readable_unit(column, measured->deviation[measured->count / 2]);
        panel_data data;
        if (!fill(&data, i, c, unit.scale, &figure->memory[c])) {
            figure->figure.panel_count = c;
            identify_figure_free(figure);
            return false;
        }
        snprintf(figure->label[c], sizeof figure->label[c], "Allan deviation [%s]", unit.text);
        size_t curves = make_curves(figure->curve[c], &data, i, c);
        figure->panel[c] = (imk_panel){column->name,
                                       "averaging time [s]",
                                       figure->label[c],
                                       true,
                                       true,
                                       curves,
                                       figure->curve[c],
                                       0,
                                       NULL,
                                       IMK_KEY_UPPER};
    }
    figure->figure = (imk_figure){i->path, count, count < 3 ? count : 3, figure->panel};
    return true;
}

void identify_figure_free(identify_figure *figure)
{
    for (size_t c = 0; c < figure->figure.panel_count; c++)
        free(figure->memory[c]);
}
