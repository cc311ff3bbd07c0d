/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan plot of each channel: measured points, the model and all it consists of, where it does
 * not hold, the range expected for a record of this length, and the twin; below it the difference
 * of the points from the model. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdio.h>

enum { MODEL_COLOR = 6, BAND_COLOR = 7, DATA_COLOR = 0, TWIN_COLOR = 4, INVALID_COLOR = 1 };

/* Beyond this many standard deviations it does not matter how many. */
static const double misfit_most = 9;

/* The ratio of the measured variance to the model's, converted by its probability to standard
 * deviations of a normal distribution, so that one picture can show short and long averaging
 * times. */
static double misfit_of(double ratio, double edf)
{
    const double half = 0.5 * edf, x = half * ratio;
    const double z = ratio > 1 ? -imk_normal_quantile(imk_gamma_upper(half, x))
                               : imk_normal_quantile(imk_gamma_lower(half, x));
    return z < misfit_most ? fmax(z, -misfit_most) : misfit_most;
}

static double deviation_of(const imk_identify_log *log, size_t channel, size_t m, int term)
{
    return sqrt(imk_identification_allan_variance(&log->result[channel], log->record.dt, m, term));
}

/* What a curve is of: the model (negative), one of its terms, or a part behind these. */
typedef struct component {
    int term; /* IMK_NOISE_TERMS and more: a part of this kind */
    int index;
} component;

static double variance_of(const imk_identify_log *log, size_t channel, component c, size_t m)
{
    const imk_identification *r = &log->result[channel];
    const double dt = log->record.dt;
    return c.term < IMK_NOISE_TERMS
               ? imk_identification_allan_variance(r, dt, m, c.term)
               : imk_identification_part_allan_variance(
                     r, (imk_identified_kind)(c.term - IMK_NOISE_TERMS), c.index, dt, m);
}

/* The model, or a component of it, at ten averaging times to a decade. */
static void show_model(const imk_identify_log *log, size_t channel, component c, double scale,
                       imk_figure_builder *figure)
{
    const size_t rows = log->record.rows;
    const size_t count = imk_allan_factors_for(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_DECADE, rows, NULL);
    size_t *factor = figure ? imki_arena_take(figure->arena, (count + 1) * sizeof *factor) : NULL;
    if (!factor)
        return;
    imk_allan_factors_for(IMK_ALLAN_OVERLAPPING, IMK_ALLAN_DECADE, rows, factor);
    for (size_t k = 0; k < count; k++)
        imk_figure_point(figure, log->record.dt * (double)factor[k],
                         sqrt(variance_of(log, channel, c, factor[k])) / scale);
}

void imki_part_name(const imk_identification *r, imk_identified_kind kind, int index, size_t size,
                    char *text)
{
    switch (kind) {
    case IMK_IDENTIFIED_GAUSS_MARKOV:
        snprintf(text, size, "Gauss-Markov, %.3g s", r->gauss_markov[index].correlation_time.value);
        break;
    case IMK_IDENTIFIED_SINUSOID:
        snprintf(text, size, "line of %.4g Hz", r->sinusoid[index].frequency);
        break;
    case IMK_IDENTIFIED_RESONANCE:
        snprintf(text, size, "resonance at %.4g Hz", r->resonance[index].frequency);
        break;
    default:
        snprintf(text, size, "rounding");
    }
}

static void show_components(const imk_identify_log *log, size_t channel, double scale,
                            imk_figure_builder *figure)
{
    static const int colors[IMK_NOISE_TERMS] = {3, 1, 2, 5, 4};
    static const int part_colors[IMK_IDENTIFIED_KINDS] = {0, 7, 4, 6};
    const imk_identification *r = &log->result[channel];
    char name[80];
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        const imk_term_display display = imk_identified_term(
            imk_even_record_column(&log->record, channel), r, (imk_noise_term)term);
        const bool filtered = term == IMK_NOISE_WHITE && r->filter.bandwidth > 0;
        if (!r->term[term].present)
            continue;
        snprintf(name, sizeof name, "%.40s", display.name);
        if (filtered)
            snprintf(name, sizeof name, "%.30s, filter of %.3g Hz", display.name,
                     r->filter.bandwidth);
        imki_begin_curve(figure, name, IMK_CURVE_DASHES, colors[term]);
        show_model(log, channel, (component){term, 0}, scale, figure);
    }
    for (int kind = 0; kind < IMK_IDENTIFIED_KINDS; kind++)
        for (int i = 0; i < imk_identification_count(r, (imk_identified_kind)kind); i++) {
            imki_part_name(r, (imk_identified_kind)kind, i, sizeof name, name);
            imki_begin_curve(figure, name, IMK_CURVE_DASHES, part_colors[kind]);
            show_model(log, channel, (component){IMK_NOISE_TERMS + kind, i}, scale, figure);
        }
}

/* Averaging times at which the model does not hold, below the range of validity or above it. */
typedef struct invalid_range {
    double from, to; /* [s]; equal: none; infinite: to the frame */
} invalid_range;

static invalid_range invalid_range_of(const imk_identify_log *log, size_t channel, bool above)
{
    const imk_identification *r = &log->result[channel];
    const bool nowhere = !isfinite(r->valid_from);
    const invalid_range none = {0, 0};
    if (log->origin != IMK_IDENTIFY_RECORD || (nowhere && above))
        return none;
    if (nowhere)
        return (invalid_range){-HUGE_VAL, HUGE_VAL};
    if (above)
        return r->valid_to < 0.99 * r->longest ? (invalid_range){r->valid_to, HUGE_VAL} : none;
    return r->valid_from > 1.5 * log->record.dt ? (invalid_range){-HUGE_VAL, r->valid_from} : none;
}

static bool is_invalid(const imk_identify_log *log)
{
    bool any = false;
    for (size_t c = 0; c < log->record.count; c++)
        for (int above = 0; above < 2; above++) {
            const invalid_range range = invalid_range_of(log, c, above > 0);
            any = any || range.to > range.from;
        }
    return any;
}

static void show_invalid(const imk_identify_log *log, size_t channel, const char *label,
                         imk_figure_builder *figure)
{
    for (int above = 0; above < 2; above++) {
        const invalid_range range = invalid_range_of(log, channel, above > 0);
        if (range.to > range.from)
            imk_figure_region(figure, &(imk_region){.label = label,
                                                    .color = INVALID_COLOR,
                                                    .x_low = range.from,
                                                    .x_high = range.to,
                                                    .y_low = -HUGE_VAL,
                                                    .y_high = HUGE_VAL});
    }
}

static void show_deviations(const imk_identify_shown *shown, size_t channel,
                            imk_figure_builder *figure)
{
    const imk_identify_log *log = shown->log;
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_allan_curve *curve = &log->curve[channel];
    const imk_allan_curve *twin = shown->twin ? &shown->twin[channel] : NULL;
    const imk_unit unit = imk_channel_readable_unit(column, curve->deviation[curve->count / 2]);
    const double tail = (1 - log->settings.confidence) / 2;
    char label[80];
    snprintf(label, sizeof label, "Allan deviation [%s]", unit.text);
    imk_figure_panel(figure, &(imk_panel){.title = column->name,
                                          .x_label = "averaging time [s]",
                                          .y_label = label,
                                          .x_logarithmic = true,
                                          .y_logarithmic = true,
                                          .allan_deviation = true,
                                          .key = is_invalid(log) ? IMK_KEY_LOWER : IMK_KEY_UPPER});
    imki_begin_curve(figure, "expected spread", IMK_CURVE_BAND, BAND_COLOR);
    for (size_t k = 0; k < curve->count; k++) {
        /* Under the model the measured variance is the model's times chi^2/edf. */
        const double edf = curve->point[k].edf;
        const double model = deviation_of(log, channel, curve->point[k].m, -1) / unit.scale;
        imk_figure_bar(figure, curve->tau[k], model,
                       model * sqrt(imk_chi_square_quantile(tail, edf) / edf),
                       model * sqrt(imk_chi_square_quantile(1 - tail, edf) / edf));
    }
    show_components(log, channel, unit.scale, figure);
    imki_begin_curve(figure, "model", IMK_CURVE_LINE, MODEL_COLOR);
    show_model(log, channel, (component){-1, 0}, unit.scale, figure);
    if (twin && twin->count == curve->count)
        imk_figure_curve(figure,
                         &(imk_curve){"twin", IMK_CURVE_POINTS, TWIN_COLOR, twin->count, curve->tau,
                                      twin->deviation, NULL, NULL},
                         unit.scale);
    imk_figure_curve(figure,
                     &(imk_curve){"log", IMK_CURVE_POINTS, DATA_COLOR, curve->count, curve->tau,
                                  curve->deviation, curve->lower, curve->upper},
                     unit.scale);
}

/* In the colours of the panel above, which has the key. */
static void show_misfit(const imk_identify_log *log, size_t channel, imk_figure_builder *figure)
{
    const imk_allan_curve *curve = &log->curve[channel];
    const double most = imk_normal_quantile(1 - (1 - log->settings.confidence) / 2);
    imk_figure_panel(figure,
                     &(imk_panel){.title = imk_even_record_column(&log->record, channel)->name,
                                  .x_label = "averaging time [s]",
                                  .y_label = "measured over model [sigma]",
                                  .x_logarithmic = true});
    imki_begin_curve(figure, "", IMK_CURVE_BAND, BAND_COLOR);
    for (size_t k = 0; k < curve->count; k++)
        imk_figure_bar(figure, curve->tau[k], 0, -most, most);
    imki_begin_curve(figure, "", IMK_CURVE_LINE, MODEL_COLOR);
    for (size_t k = 0; k < curve->count; k++)
        imk_figure_point(figure, curve->tau[k], 0);
    imki_begin_curve(figure, "", IMK_CURVE_POINTS, DATA_COLOR);
    for (size_t k = 0; k < curve->count; k++) {
        const double model = deviation_of(log, channel, curve->point[k].m, -1);
        imk_figure_point(figure, curve->tau[k],
                         misfit_of(pow(curve->deviation[k] / model, 2), curve->point[k].edf));
    }
    show_invalid(log, channel, "", figure);
}

/* What the figure draws. */
static const char *caption_of(const imk_identify_shown *shown, const char *points,
                              imk_result *result)
{
    return imk_result_key(
        result,
        "Points: %s, with confidence intervals. Line: the model. Dashes: what it consists of. "
        "Grey: the range of points expected from the model in a record of this length.%s%s "
        "Below: the difference of each point from the model, converted by its probability to "
        "standard deviations of a normal distribution; neighbouring points share most of their "
        "data.",
        points, is_invalid(shown->log) ? " Tinted: where the model does not hold." : "",
        shown->twin ? " Twin: a simulation of the model." : "");
}

void imki_identify_figure(const imk_identify_shown *shown, const char *points, imk_result *result)
{
    /* Choose the number of columns so that all rows are full. */
    const size_t count = shown->log->record.count;
    const size_t columns = count % 3 == 0 ? 3 : count % 2 == 0 ? 2 : 1;
    const char *caption = caption_of(shown, points, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_figure_builder *figure = imk_result_figure(result, shown->name, columns, caption);
    for (size_t first = 0; first < count; first += columns) {
        for (size_t c = first; c < first + columns; c++) {
            show_deviations(shown, c, figure);
            show_invalid(shown->log, c, "the model does not hold", figure);
        }
        for (size_t c = first; c < first + columns; c++)
            show_misfit(shown->log, c, figure);
    }
    /* Letters have no room for more. */
    imk_result_for(result, IMK_FOR_TERMINAL);
    figure = imk_result_figure(result, shown->name, count < 3 ? count : 3, caption);
    for (size_t c = 0; c < count; c++)
        show_deviations(shown, c, figure);
}

/* The deviations of one channel of all sensors, each with its model in one colour. */
static void show_side_by_side(const imk_identify_several *several,
                              const imk_identify_shown *records, size_t channel,
                              imk_figure_builder *figure)
{
    const imk_log_column *column = imk_even_record_column(&several->log[0]->record, channel);
    const imk_allan_curve *first = &several->log[0]->curve[channel];
    const imk_unit unit = imk_channel_readable_unit(column, first->deviation[first->count / 2]);
    char label[80];
    snprintf(label, sizeof label, "Allan deviation [%s]", unit.text);
    imk_figure_panel(figure, &(imk_panel){.title = column->name,
                                          .x_label = "averaging time [s]",
                                          .y_label = label,
                                          .x_logarithmic = true,
                                          .y_logarithmic = true,
                                          .allan_deviation = true});
    for (size_t r = 0; r < several->count; r++) {
        const imk_allan_curve *curve = &several->log[r]->curve[channel];
        const int color = (int)(r % 7); /* the last of the palette is a grey for bands */
        imki_begin_curve(figure, "", IMK_CURVE_LINE, color);
        show_model(several->log[r], channel, (component){-1, 0}, unit.scale, figure);
        imk_figure_curve(figure,
                         &(imk_curve){records[r].label, IMK_CURVE_POINTS, color, curve->count,
                                      curve->tau, curve->deviation, curve->lower, curve->upper},
                         unit.scale);
    }
}

void imki_devices_figure(const imk_identify_several *several, const imk_identify_shown *records,
                         const char *name, imk_result *result)
{
    const size_t count = several->joint.record.count;
    imk_figure_builder *figure =
        imk_result_figure(result, name, count < 3 ? count : 3,
                          "Points: each log, with confidence intervals. Line of the same colour: "
                          "its model.");
    for (size_t c = 0; c < count; c++)
        show_side_by_side(several, records, c, figure);
}
