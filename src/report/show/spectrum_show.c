/* SPDX-License-Identifier: Apache-2.0 */
/* The display of spectra: root densities, lines, noise parameters, a figure. */
#include "show_internal.h"

#include "imukit/identify_log.h"

#include <math.h>
#include <stdio.h>

static double sides(const imk_spectrum_log *s)
{
    return s->settings.one_sided ? 2 : 1;
}

static const char *sides_text(const imk_spectrum_log *s)
{
    return s->settings.one_sided ? "one-sided" : "two-sided";
}

/* Readable unit for the root densities of these channels, without /sqrt(Hz). */
static imk_unit root_unit(const imk_spectrum_log *s, size_t channel)
{
    const imk_channel_spectrum *f = &s->channel[channel];
    return imk_channel_readable_unit(imk_even_record_column(&s->record, channel),
                                     sqrt(f->coarse[f->coarse_count / 2].density));
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void density_cell(imk_table *table, const imk_channel_spectrum *f,
                         const imk_spectrum_band *at, double scale)
{
    for (size_t b = 0; b < f->coarse_count; b++)
        if (f->coarse[b].from == at->from) {
            imk_table_add(table, "%.4g (%.3g to %.3g)", sqrt(f->coarse[b].density) * scale,
                          sqrt(f->coarse[b].lower) * scale, sqrt(f->coarse[b].upper) * scale);
            return;
        }
    imk_table_add(table, "%s", "");
}

/* Frequencies down, channels across; nothing when there are none. A band that a spectral line fills
 * on some channel is empty there. */
static void show_densities(const imk_spectrum_log *s, imk_channel_kind kind, imk_result *result)
{
    size_t member[IMK_LOG_COLUMNS_MAX];
    const size_t members = imki_members(&s->record, kind, member);
    if (members == 0)
        return;
    const imk_unit unit = root_unit(s, member[0]);
    imk_spectrum_band all[IMK_SPECTRUM_COARSE * 12];
    const size_t count = imk_spectrum_bands(&s->channel[member[0]].spectrum, IMK_SPECTRUM_COARSE,
                                            0.95, 0, NULL, sizeof all / sizeof all[0], all);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "frequency [Hz]");
    for (size_t k = 0; k < members; k++)
        imk_table_add(table, "%s [%s/sqrt(Hz)]",
                      imk_even_record_column(&s->record, member[k])->name, unit.text);
    for (size_t i = 0; i < count; i++) {
        imk_table_row(table, "%.4g", all[i].frequency);
        for (size_t k = 0; k < members; k++)
            density_cell(table, &s->channel[member[k]], &all[i], sqrt(sides(s)) / unit.scale);
    }
    imk_result_gap(result);
}

static void show_line(const imk_spectrum_log *s, size_t channel, size_t index, imk_table *table)
{
    const imk_channel_spectrum *f = &s->channel[channel];
    const imk_spectrum_line *l = &f->line[index];
    const imk_log_column *column = imk_even_record_column(&s->record, channel);
    const imk_unit unit = imk_channel_readable_unit(column, l->amplitude);
    imk_table_row(table, "%s\t%s ± %s\t%s %s\t%.3g", column->name,
                  imki_value(l->frequency, l->frequency_sigma, 6).text,
                  imki_value(l->frequency_sigma, l->frequency_sigma, 2).text,
                  imki_plus_minus(l->amplitude, l->amplitude_sigma, unit.scale).text, unit.text,
                  l->density / l->level);
    if (l->false_alarm < 1e-12)
        imk_table_add(table, "< 1e-12");
    else
        imk_table_add(table, "%.1e", l->false_alarm);
    if (l->coherent)
        imk_table_add(table, "sinusoid");
    else if (l->width > 0)
        imk_table_add(table, "%.2g Hz wide", l->width);
    else
        imk_table_add(table, "wanders");
    for (size_t j = 0; l->multiple > 1 && j < f->line_count; j++)
        if (f->line[j].family == l->family && f->line[j].multiple == 1) {
            imk_table_add(table, "%d x %.6g Hz", l->multiple, f->line[j].frequency);
            return;
        }
}

static void show_lines(const imk_spectrum_log *s, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table,
                  "channel\tfrequency [Hz]\tamplitude\tover floor\tfalse alarm\tkind\tmultiple of");
    for (size_t c = 0; c < s->record.count; c++)
        for (size_t i = 0; i < s->channel[c].line_count; i++)
            show_line(s, c, i, table);
    imk_result_gap(result);
}

static void parameter_cell(imk_table *table, const imk_estimate *e, double scale)
{
    if (!e->present)
        imk_table_add(table, "absent (< %s)", imki_value(e->upper / scale, 0, 2).text);
    else
        imk_table_add(table, "%s (%s)", imki_plus_minus(e->value, e->sigma, scale).text,
                      imki_range(e->lower, e->upper, scale).text);
}

static void show_parameters(const imk_spectrum_log *s, imk_channel_kind kind, imk_result *result)
{
    size_t member[IMK_LOG_COLUMNS_MAX];
    const size_t members = imki_members(&s->record, kind, member);
    if (members == 0)
        return;
    const imk_log_column *first = imk_even_record_column(&s->record, member[0]);
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "noise parameter\tunit");
    for (size_t k = 0; k < members; k++)
        imk_table_add(table, "%s", imk_even_record_column(&s->record, member[k])->name);
    for (int term = 0; term <= IMK_NOISE_RANDOM_WALK; term++) {
        const imk_term_display display = imk_channel_term(first, (imk_noise_term)term);
        imk_table_row(table, "%s\t%s", display.name, display.unit.text);
        for (size_t k = 0; k < members; k++)
            if (s->channel[member[k]].fit_status == IMK_OK)
                parameter_cell(table, &s->channel[member[k]].fit.term[term], display.unit.scale);
            else
                imk_table_add(table, "%s", "");
    }
    imk_table_row(table, "misfit\t1 if explained");
    for (size_t k = 0; k < members; k++)
        if (s->channel[member[k]].fit_status == IMK_OK)
            imk_table_add(table, "%.2f", s->channel[member[k]].fit.misfit);
        else
            imk_table_add(table, "%s", "");
    imk_result_gap(result);
}

/* How the figures are meant. */
static void explain(const imk_spectrum_log *s, size_t lines, imk_result *result)
{
    const imk_spectrum *p = &s->channel[0].spectrum;
    imk_result_line(result,
                    "Root densities, %s, lines left out; in brackets: %g %% confidence. %s: %zu "
                    "segments of %.4g s, resolution %.3g Hz.%s",
                    sides_text(s), 100 * s->settings.confidence,
                    s->settings.method ? "Multitaper" : "Welch", p->segments,
                    (double)p->length * p->dt, p->noise_bandwidth,
                    lines == 0 ? " No lines found." : "");
}

/* ---- judgement ------------------------------------------------------------------------------- */

/* The lines of all channels; the strongest is the one that stands highest above its floor. */
static void judge_lines(const imk_spectrum_log *s, imki_reasons *reasons)
{
    const imk_spectrum_line *strongest = NULL;
    size_t count = 0, channel = 0;
    for (size_t c = 0; c < s->record.count; c++)
        for (size_t i = 0; i < s->channel[c].line_count; i++, count++) {
            const imk_spectrum_line *l = &s->channel[c].line[i];
            if (strongest && l->density / l->level <= strongest->density / strongest->level)
                continue;
            strongest = l;
            channel = c;
        }
    if (!strongest)
        imki_reason(reasons, "no line stands out");
    else
        imki_reason(reasons, "%zu line%s stand%s out, %sat %.4g Hz in %s", count,
                    count == 1 ? "" : "s", count == 1 ? "s" : "",
                    count == 1 ? "" : "the strongest ", strongest->frequency,
                    imk_even_record_column(&s->record, channel)->name);
}

/* How well the root densities are known. */
static void judge(const imk_spectrum_log *s, imk_result *result)
{
    imki_reasons reasons = {.result = result};
    double best = HUGE_VAL, worst = 0, low = HUGE_VAL, high = 0;
    char use[80];
    for (size_t c = 0; c < s->record.count; c++)
        for (size_t b = 0; b < s->channel[c].coarse_count; b++) {
            const imk_spectrum_band *band = &s->channel[c].coarse[b];
            const double above = sqrt(band->upper / band->density) - 1;
            best = fmin(best, above);
            worst = fmax(worst, above);
            low = fmin(low, band->frequency);
            high = fmax(high, band->frequency);
        }
    const bool none = !(best <= 1); /* nothing is known to a factor of two */
    imki_reasons_of_warnings(&reasons, &s->findings);
    const imk_usability usability = none                                ? IMK_NOT_USABLE
                                    : reasons.told > 0 || !(worst <= 1) ? IMK_USABLE_WITH_CARE
                                                                        : IMK_USABLE;
    snprintf(use, sizeof use, " from %.4g Hz to %.4g Hz", low, high);
    if (none)
        imki_reason(&reasons,
                    "no density is known to a factor of two, as the record has only %zu "
                    "rows",
                    s->record.rows);
    else
        imki_reason(&reasons, "root densities are known to %.2g %%, at worst %.2g %%", 100 * best,
                    100 * worst);
    judge_lines(s, &reasons);
    imki_judge(&reasons, usability, none ? "" : use);
}

/* ---- data ------------------------------------------------------------------------------------ */

static void line_data(const imk_spectrum_line *l, imk_unit unit, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_quantity(result, "frequency", l->frequency, "Hz");
    imk_result_quantity(result, "frequency_sigma", l->frequency_sigma, "Hz");
    imk_result_quantity(result, "amplitude", l->amplitude / unit.scale, unit.text);
    imk_result_quantity(result, "amplitude_sigma", l->amplitude_sigma / unit.scale, unit.text);
    imk_result_flag(result, "coherent", l->coherent);
    imk_result_quantity(result, "width", l->width, "Hz");
    imk_result_number(result, "ratio", l->density / l->level);
    imk_result_number(result, "false_alarm", l->false_alarm);
    imk_result_count(result, "family", l->family);
    imk_result_count(result, "multiple", l->multiple);
    imk_result_end(result);
}

static void band_data(imk_spectrum_band b, const char *unit, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_quantity(result, "frequency", b.frequency, "Hz");
    imk_result_quantity(result, "density", b.density, unit);
    imk_result_quantity(result, "lower", b.lower, unit);
    imk_result_quantity(result, "upper", b.upper, unit);
    imk_result_number(result, "degrees_of_freedom", b.degrees);
    imk_result_end(result);
}

static void parameter_data(const imk_channel_spectrum *f, const imk_log_column *column,
                           imk_result *result)
{
    if (!imki_begin_object(result, "parameters", f->fit_status == IMK_OK))
        return;
    imk_result_object(result, "terms");
    for (int term = 0; term <= IMK_NOISE_RANDOM_WALK; term++) {
        const imk_term_display display = imk_channel_term(column, (imk_noise_term)term);
        const bool other = imk_channel_kind_of(column) == IMK_CHANNEL_OTHER;
        imki_show_estimate(result, imk_result_key(result, "%s", display.key), &f->fit.term[term],
                           other ? display.unit.scale : 1, display.si);
    }
    imk_result_end(result);
    imk_result_quantity(result, "from", f->fit.lowest, "Hz");
    imk_result_quantity(result, "to", f->fit.highest, "Hz");
    imk_result_number(result, "misfit", f->fit.misfit);
    imk_result_quantity(result, "worst_frequency", f->fit.worst_frequency, "Hz");
    imk_result_number(result, "worst_ratio", f->fit.worst_ratio);
    imk_result_end(result);
}

static void channel_data(const imk_spectrum_log *s, size_t channel, imk_result *result)
{
    const imk_log_column *column = imk_even_record_column(&s->record, channel);
    const imk_channel_spectrum *f = &s->channel[channel];
    const imk_unit unit = imk_channel_plain_unit(column);
    char density[64];
    snprintf(density, sizeof density, "(%.48s)^2/Hz", unit.text);
    imk_result_object(result, NULL);
    imk_result_text(result, "name", column->name);
    imk_result_count(result, "segments", (long long)f->spectrum.segments);
    imk_result_quantity(result, "resolution", f->spectrum.noise_bandwidth, "Hz");
    imk_result_number(result, "fraction_used", f->spectrum.fraction_used);
    imk_result_array(result, "bands");
    for (size_t i = 0; i < f->coarse_count; i++)
        band_data(imk_spectrum_log_band(s, channel, &f->coarse[i]), density, result);
    imk_result_end(result);
    imk_result_array(result, "lines");
    for (size_t i = 0; i < f->line_count; i++)
        line_data(&f->line[i], unit, result);
    imk_result_end(result);
    parameter_data(f, column, result);
    imk_result_end(result);
}

static void show_data(const imk_spectrum_log *s, const char *name, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", name);
    imk_result_count(result, "rows", (long long)s->record.rows);
    imk_result_quantity(result, "interval", s->record.dt, "s");
    imk_result_text(result, "method", s->settings.method ? "multitaper" : "welch");
    imk_result_text(result, "density", sides_text(s));
    imk_result_number(result, "confidence", s->settings.confidence);
    imk_result_number(result, "false_alarm", s->settings.false_alarm);
    imk_result_end(result);
    imk_result_object(result, "result");
    judge(s, result);
    imk_result_array(result, "channels");
    for (size_t c = 0; c < s->record.count; c++)
        channel_data(s, c, result);
    imk_result_end(result);
    imk_result_end(result);
}

/* ---- figure ---------------------------------------------------------------------------------- */

/* Root densities with their intervals; lines as large points at their peaks. */
static void show_curves(const imk_channel_spectrum *f, const char *name, int color, double scale,
                        imk_figure_builder *figure)
{
    imki_begin_curve(figure, "", IMK_CURVE_BAND, color);
    for (size_t i = 0; i < f->fine_count; i++)
        imk_figure_bar(figure, f->fine[i].frequency, sqrt(f->fine[i].density) * scale,
                       sqrt(f->fine[i].lower) * scale, sqrt(f->fine[i].upper) * scale);
    imki_begin_curve(figure, name, IMK_CURVE_LINE, color);
    for (size_t i = 0; i < f->fine_count; i++)
        imk_figure_point(figure, f->fine[i].frequency, sqrt(f->fine[i].density) * scale);
    if (f->line_count == 0)
        return;
    imki_begin_curve(figure, "", IMK_CURVE_MARKS, color);
    for (size_t i = 0; i < f->line_count; i++)
        imk_figure_point(figure, f->line[i].frequency, sqrt(f->line[i].density) * scale);
}

static void show_panel(const imk_spectrum_log *s, imk_channel_kind kind, imk_figure_builder *figure)
{
    static const char *const titles[] = {"Gyros", "Accelerometers", "Channels"};
    size_t member[IMK_LOG_COLUMNS_MAX];
    const size_t members = imki_members(&s->record, kind, member);
    char label[100];
    if (members == 0)
        return;
    const imk_unit unit = root_unit(s, member[0]);
    snprintf(label, sizeof label, "root density [%.40s/sqrt(Hz)], %s", unit.text, sides_text(s));
    imk_figure_panel(figure, &(imk_panel){.title = titles[kind],
                                          .x_label = "frequency [Hz]",
                                          .y_label = label,
                                          .x_logarithmic = true,
                                          .y_logarithmic = true});
    for (size_t k = 0; k < members; k++)
        show_curves(&s->channel[member[k]], imk_even_record_column(&s->record, member[k])->name,
                    (int)k, sqrt(sides(s)) / unit.scale, figure);
}

void imk_show_spectrum_log(const imk_spectrum_log *s, const char *name, imk_result *result)
{
    size_t lines = 0;
    show_data(s, name, result);
    imk_result_title(result, "Power spectral density", "%.120s: %zu samples of %zu channels, %g Hz",
                     name, s->record.rows, s->record.count, 1 / s->record.dt);
    imk_figure_builder *figure = imk_result_figure(
        result, name, 2,
        "Root densities, and their intervals as bands. Large points: spectral lines.");
    for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
        show_panel(s, kind, figure);
    for (size_t c = 0; c < s->record.count; c++)
        lines += s->channel[c].line_count;
    imk_result_for(result, IMK_FOR_PAGE);
    explain(s, lines, result);
    imk_result_for(result, IMK_FOR_BOTH);
    for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
        show_densities(s, kind, result);
    if (lines > 0)
        show_lines(s, result);
    for (imk_channel_kind kind = IMK_CHANNEL_GYRO; kind < IMK_CHANNEL_KINDS; kind++)
        show_parameters(s, kind, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    explain(s, lines, result);
    imk_result_for(result, IMK_FOR_BOTH);
}
