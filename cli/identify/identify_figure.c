/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan plot of each channel: measured points, the model and its terms, where a record of this
 * length may fall under the model, and the twin; below it how far the points are off the model. */
#include "identify_parts.h"

#include "imukit/distributions.h"
#include "imukit/figure_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    double *misfit, *zero, *minus, *plus;           /* octave_count */
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

/* Beyond this many standard deviations it does not matter how many. */
static const double misfit_most = 9;

/* The measured variance over the model's as a normal deviate: as improbable as this many standard
 * deviations, so that short and long averaging times can be seen in one picture. */
static double misfit_of(double ratio, double edf)
{
    const double half = 0.5 * edf, x = half * ratio;
    const double z = ratio > 1 ? -imk_normal_quantile(imk_gamma_upper(half, x))
                               : imk_normal_quantile(imk_gamma_lower(half, x));
    return z < misfit_most ? fmax(z, -misfit_most) : misfit_most;
}

/* Under the model the measured variance is the model's times chi^2/edf. */
static void fill_octaves(panel_data *d, const identification *i, size_t channel, double scale)
{
    const imk_allan_curve *measured = &i->found->curve[channel], *twin = &i->twin[channel];
    double tail = (1 - i->options->confidence) / 2;
    for (size_t k = 0; k < d->octave_count; k++) {
        const imk_allan_point *p = &measured->point[k];
        double middle =
            deviation_of(&i->found->result[channel], i->found->record.dt, p->m, -1, scale);
        d->octave_tau[k] = measured->tau[k];
        d->deviation[k] = p->deviation / scale;
        d->lower[k] = p->lower / scale;
        d->upper[k] = p->upper / scale;
        d->band_middle[k] = middle;
        d->band_lower[k] = middle * sqrt(imk_chi_square_quantile(tail, p->edf) / p->edf);
        d->band_upper[k] = middle * sqrt(imk_chi_square_quantile(1 - tail, p->edf) / p->edf);
        d->misfit[k] = misfit_of(pow(d->deviation[k] / middle, 2), p->edf);
        d->zero[k] = 0;
        d->plus[k] = imk_normal_quantile(1 - tail);
        d->minus[k] = -d->plus[k];
        if (twin->count == d->octave_count)
            d->twin[k] = twin->point[k].deviation / scale;
    }
}

static void fill(panel_data *d, const identification *i, size_t channel, double scale,
                 double **memory)
{
    const imk_identification *r = &i->found->result[channel];
    double dt = i->found->record.dt;
    const size_t rows = i->found->record.rows;
    d->smooth_count = imk_allan_factors_for(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_DECADE, rows, NULL);
    size_t *factors = command_memory(NULL, (d->smooth_count + 1) * sizeof *factors);
    imk_allan_factors_for(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_DECADE, rows, factors);
    d->octave_count = i->found->curve[channel].count;
    *memory = command_memory(
        NULL, ((2 + IMK_NOISE_TERMS) * d->smooth_count + 12 * d->octave_count) * sizeof **memory);
    double *rest = *memory;
    d->tau = cut(&rest, d->smooth_count);
    d->total = cut(&rest, d->smooth_count);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        d->term[term] = cut(&rest, d->smooth_count);
    double **octaves[] = {&d->octave_tau,  &d->deviation,  &d->lower,      &d->upper,
                          &d->band_middle, &d->band_lower, &d->band_upper, &d->twin,
                          &d->misfit,      &d->zero,       &d->minus,      &d->plus};
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
}

static size_t make_curves(imk_curve *curve, const panel_data *d, const identification *i,
                          size_t channel)
{
    /* Names of the terms in the key: string literals of the table live for ever. */
    static const char *const names[2][IMK_NOISE_TERMS] = {
        {"quantization", "angle random walk", "bias instability", "rate random walk", "rate ramp"},
        {"quantization", "velocity random walk", "bias instability", "acceleration random walk",
         "acceleration ramp"}};
    bool accel = channel_kind_of(log_channel_column(&i->found->record, channel)) == CHANNEL_ACCEL;
    size_t count = 0;
    curve[count++] = (imk_curve){"expected spread", IMK_CURVE_BAND, BAND_COLOR,    d->octave_count,
                                 d->octave_tau,     d->band_middle, d->band_lower, d->band_upper};
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        if (i->found->result[channel].term[term].present)
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

/* In the colours of the panel above, which has the key. */
static void make_misfit(imk_curve *curve, const panel_data *d)
{
    curve[0] = (imk_curve){"",      IMK_CURVE_BAND, BAND_COLOR, d->octave_count, d->octave_tau,
                           d->zero, d->minus,       d->plus};
    curve[1] = (imk_curve){"",      IMK_CURVE_LINE, MODEL_COLOR, d->octave_count, d->octave_tau,
                           d->zero, NULL,           NULL};
    curve[2] = (imk_curve){
        "", IMK_CURVE_POINTS, DATA_COLOR, d->octave_count, d->octave_tau, d->misfit, NULL, NULL};
}

/* So many beside one another that rows are full. */
static size_t columns_for(size_t channels)
{
    return channels % 3 == 0 ? 3 : channels % 2 == 0 ? 2 : 1;
}

static void make_panels(const identification *i, identify_figure *figure, size_t channel,
                        imk_panel *deviation, imk_panel *misfit)
{
    const imk_log_column *column = log_channel_column(&i->found->record, channel);
    const imk_allan_curve *measured = &i->found->curve[channel];
    const imk_unit unit = channel_readable_unit(column, measured->deviation[measured->count / 2]);
    panel_data data;
    fill(&data, i, channel, unit.scale, &figure->memory[channel]);
    char *label = figure->label[channel];
    snprintf(label, sizeof figure->label[channel], "Allan deviation [%s]", unit.text);
    imk_curve *curve = figure->curve[channel];
    const size_t curves = make_curves(curve, &data, i, channel);
    *deviation =
        (imk_panel){column->name, "averaging time [s]", label, true, true, curves, curve, 0,
                    NULL,         IMK_KEY_UPPER};
    if (!misfit)
        return;
    make_misfit(figure->misfit[channel], &data);
    *misfit = (imk_panel){column->name,
                          "averaging time [s]",
                          "measured over model [sigma]",
                          true,
                          false,
                          3,
                          figure->misfit[channel],
                          0,
                          NULL,
                          IMK_KEY_UPPER};
}

void identify_figure_make(const identification *i, bool misfit, identify_figure *figure)
{
    const size_t count = i->found->record.count;
    const size_t columns = misfit ? columns_for(count) : count < 3 ? count : 3;
    figure->channels = count;
    for (size_t c = 0; c < count; c++) {
        const size_t place = misfit ? c / columns * 2 * columns + c % columns : c;
        make_panels(i, figure, c, &figure->panel[place],
                    misfit ? &figure->panel[place + columns] : NULL);
    }
    figure->figure = (imk_figure){i->path, misfit ? 2 * count : count, columns, figure->panel};
}

int identify_draw(const identification *i, const char *plot)
{
    imk_error error;
    identify_figure *figure = command_memory(NULL, sizeof *figure);
    /* Letters have no room for more. */
    identify_figure_make(i, strcmp(plot, "term") != 0, figure);
    const imk_status status = imk_figure_write(&figure->figure, plot, &error);
    identify_figure_free(figure);
    free(figure);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

void identify_figure_free(identify_figure *figure)
{
    for (size_t c = 0; c < figure->channels; c++)
        free(figure->memory[c]);
}
