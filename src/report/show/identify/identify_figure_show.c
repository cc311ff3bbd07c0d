/* SPDX-License-Identifier: Apache-2.0 */
/* The Allan plot of each channel: measured points, the model and its terms, the range expected for
 * a record of this length, and the twin; below it the difference of the points from the model. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <stdio.h>

enum { MODEL_COLOR = 6, BAND_COLOR = 7, DATA_COLOR = 0, TWIN_COLOR = 4 };

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

/* The model, or one term of it, at ten averaging times to a decade. */
static void show_model(const imk_identify_log *log, size_t channel, int term, double scale,
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
                         deviation_of(log, channel, factor[k], term) / scale);
}

static void show_deviations(const imk_identify_shown *shown, size_t channel,
                            imk_figure_builder *figure)
{
    static const int colors[IMK_NOISE_TERMS] = {3, 1, 2, 5, 4};
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
                                          .allan_deviation = true});
    imki_begin_curve(figure, "expected spread", IMK_CURVE_BAND, BAND_COLOR);
    for (size_t k = 0; k < curve->count; k++) {
        /* Under the model the measured variance is the model's times chi^2/edf. */
        const double edf = curve->point[k].edf;
        const double model = deviation_of(log, channel, curve->point[k].m, -1) / unit.scale;
        imk_figure_bar(figure, curve->tau[k], model,
                       model * sqrt(imk_chi_square_quantile(tail, edf) / edf),
                       model * sqrt(imk_chi_square_quantile(1 - tail, edf) / edf));
    }
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        if (log->result[channel].term[term].present) {
            const imk_term_display display =
                imk_identified_term(column, &log->result[channel], (imk_noise_term)term);
            imki_begin_curve(figure, display.name, IMK_CURVE_DASHES, colors[term]);
            show_model(log, channel, term, unit.scale, figure);
        }
    imki_begin_curve(figure, "model", IMK_CURVE_LINE, MODEL_COLOR);
    show_model(log, channel, -1, unit.scale, figure);
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
}

void imki_identify_figure(const imk_identify_shown *shown, const char *caption, imk_result *result)
{
    /* Choose the number of columns so that all rows are full. */
    const size_t count = shown->log->record.count;
    const size_t columns = count % 3 == 0 ? 3 : count % 2 == 0 ? 2 : 1;
    imk_result_for(result, IMK_FOR_PAGE);
    imk_figure_builder *figure = imk_result_figure(result, shown->name, columns, caption);
    for (size_t first = 0; first < count; first += columns) {
        for (size_t c = first; c < first + columns; c++)
            show_deviations(shown, c, figure);
        for (size_t c = first; c < first + columns; c++)
            show_misfit(shown->log, c, figure);
    }
    /* Letters have no room for more. */
    imk_result_for(result, IMK_FOR_TERMINAL);
    figure = imk_result_figure(result, shown->name, count < 3 ? count : 3, caption);
    for (size_t c = 0; c < count; c++)
        show_deviations(shown, c, figure);
}
