/* SPDX-License-Identifier: Apache-2.0 */
/* Spectral densities, lines and parameters as CSV, tables, JSON and a page. */
#include "spectrum_output.h"

#include "identify/identify_parts.h"
#include "shell/json_output.h"
#include "shell/page_table.h"
#include "shell/text_table.h"
#include "spectrum_figure.h"

#include <math.h>
#include <stdlib.h>

double spectrum_sides(const spectrum_result *result)
{
    return result->options->density == 1 ? 2 : 1;
}

const char *spectrum_sides_text(const spectrum_result *result)
{
    return result->options->density == 1 ? "one-sided" : "two-sided";
}

imk_unit spectrum_root_unit(const spectrum_result *result, channel_kind kind)
{
    for (size_t c = 0; c < result->channels.count; c++) {
        const imk_log_column *column = log_channel_column(&result->channels, c);
        const channel_spectrum *f = &result->found[c];
        if (channel_kind_of(column) == kind)
            return channel_readable_unit(column, sqrt(f->table[f->table_count / 2].density));
    }
    return (imk_unit){.scale = 0};
}

/* ---- CSV ------------------------------------------------------------------------------------- */

int spectrum_write_csv(const spectrum_result *result, const char *output)
{
    const log_channels *channels = &result->channels;
    const double sides = spectrum_sides(result);
    imk_output_file *file;
    imk_error error;
    if (imk_output_file_open(output, &file, &error) != IMK_OK)
        return command_error(&error, NULL);
    imk_output_file_print(file, "channel,frequency [Hz],density [unit^2/Hz],lower,upper,degrees,"
                                "sides,unit\n");
    for (size_t c = 0; c < channels->count; c++) {
        const imk_log_column *column = log_channel_column(channels, c);
        const channel_spectrum *f = &result->found[c];
        imk_unit unit = channel_plain_unit(column);
        for (size_t i = 0; i < f->plotted_count; i++) {
            const imk_spectrum_band *b = &f->plotted[i];
            const double scale = sides / unit.scale / unit.scale;
            const double values[] = {b->frequency, b->density * scale, b->lower * scale,
                                     b->upper * scale};
            imk_output_file_print(file, "%s", column->name);
            for (int k = 0; k < 4; k++) {
                char text[IMK_DECIMAL_SIZE];
                text[imk_decimal_shortest(values[k], text)] = '\0';
                imk_output_file_print(file, ",%s", text);
            }
            char degrees[IMK_DECIMAL_SIZE];
            degrees[imk_decimal_significant(b->degrees, 6, degrees)] = '\0';
            imk_output_file_print(file, ",%s,%s,%s\n", degrees, spectrum_sides_text(result),
                                  unit.text);
        }
    }
    if (imk_output_file_commit(file, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

/* ---- tables ---------------------------------------------------------------------------------- */

static size_t members_of(const spectrum_result *result, channel_kind kind, size_t *member)
{
    size_t members = 0;
    for (size_t c = 0; c < result->channels.count; c++)
        if (channel_kind_of(log_channel_column(&result->channels, c)) == kind)
            member[members++] = c;
    return members;
}

/* Frequencies down, channels across; no rows when there are none. A band that is one line on some
 * channel is empty there. */
static text_table density_table(const spectrum_result *result, channel_kind kind)
{
    size_t member[IMK_LOG_COLUMNS_MAX];
    const size_t members = members_of(result, kind, member);
    text_table table = text_table_make(1 + members);
    if (members == 0)
        return table;
    const imk_unit unit = spectrum_root_unit(result, kind);
    const double sides = spectrum_sides(result);
    const imk_spectrum *s = &result->found[member[0]].spectrum;
    imk_spectrum_band all[SPECTRUM_TABLE_PER_DECADE * 12];
    const size_t count = imk_spectrum_bands(s, SPECTRUM_TABLE_PER_DECADE, 0.95, 0, NULL,
                                            sizeof all / sizeof all[0], all);
    text_table_row(&table);
    text_table_set(&table, 0, "frequency [Hz]");
    for (size_t k = 0; k < members; k++)
        text_table_set(&table, 1 + k, "%s [%s/sqrt(Hz)]",
                       log_channel_column(&result->channels, member[k])->name, unit.text);
    for (size_t i = 0; i < count; i++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%.4g", all[i].frequency);
        for (size_t k = 0; k < members; k++) {
            const channel_spectrum *f = &result->found[member[k]];
            for (size_t b = 0; b < f->table_count; b++)
                if (f->table[b].from == all[i].from)
                    text_table_set(&table, 1 + k, "%.4g (%.3g to %.3g)",
                                   sqrt(sides * f->table[b].density) / unit.scale,
                                   sqrt(sides * f->table[b].lower) / unit.scale,
                                   sqrt(sides * f->table[b].upper) / unit.scale);
        }
    }
    return table;
}

static void line_row(text_table *table, const spectrum_result *result, size_t channel, size_t index)
{
    const channel_spectrum *f = &result->found[channel];
    const imk_spectrum_line *l = &f->line[index];
    const imk_log_column *column = log_channel_column(&result->channels, channel);
    const imk_unit unit = channel_readable_unit(column, l->amplitude);
    char value[40], sigma[40];
    text_table_row(table);
    text_table_set(table, 0, "%s", column->name);
    format_value(l->frequency, l->frequency_sigma, 6, value, sizeof value);
    format_value(l->frequency_sigma, l->frequency_sigma, 2, sigma, sizeof sigma);
    text_table_set(table, 1, "%s ± %s", value, sigma);
    format_value(l->amplitude / unit.scale, l->amplitude_sigma / unit.scale, 4, value,
                 sizeof value);
    format_value(l->amplitude_sigma / unit.scale, l->amplitude_sigma / unit.scale, 2, sigma,
                 sizeof sigma);
    text_table_set(table, 2, "%s ± %s %s", value, sigma, unit.text);
    text_table_set(table, 3, "%.3g", l->density / l->level);
    if (l->false_alarm < 1e-12)
        text_table_set(table, 4, "< 1e-12");
    else
        text_table_set(table, 4, "%.1e", l->false_alarm);
    if (l->coherent)
        text_table_set(table, 5, "sinusoid");
    else if (l->width > 0)
        text_table_set(table, 5, "%.2g Hz wide", l->width);
    else
        text_table_set(table, 5, "wanders");
    if (l->multiple > 1)
        for (size_t j = 0; j < f->line_count; j++)
            if (f->line[j].family == l->family && f->line[j].multiple == 1)
                text_table_set(table, 6, "%d x %.6g Hz", l->multiple, f->line[j].frequency);
}

/* No rows when no channel has a line. */
static text_table line_table(const spectrum_result *result)
{
    static const char *const heads[] = {"channel",    "frequency [Hz]", "amplitude",
                                        "over floor", "chance of it",   "kind",
                                        "multiple of"};
    text_table table = text_table_make(7);
    for (size_t c = 0; c < result->channels.count; c++)
        for (size_t i = 0; i < result->found[c].line_count; i++) {
            if (table.rows == 0) {
                text_table_row(&table);
                for (size_t k = 0; k < 7; k++)
                    text_table_set(&table, k, "%s", heads[k]);
            }
            line_row(&table, result, c, i);
        }
    return table;
}

static void parameter_cell(text_table *table, size_t column, const imk_estimate *e, double scale)
{
    char value[40], sigma[40], lower[40], upper[40];
    if (!e->present) {
        format_value(e->upper / scale, 0, 2, upper, sizeof upper);
        text_table_set(table, column, "absent (< %s)", upper);
        return;
    }
    const double width = (e->upper - e->lower) / scale / 4;
    format_value(e->value / scale, e->sigma / scale, 4, value, sizeof value);
    format_value(e->sigma / scale, e->sigma / scale, 2, sigma, sizeof sigma);
    format_value(e->lower / scale, width, 3, lower, sizeof lower);
    format_value(e->upper / scale, width, 3, upper, sizeof upper);
    text_table_set(table, column, "%s ± %s (%s to %s)", value, sigma, lower, upper);
}

static text_table parameter_table(const spectrum_result *result, channel_kind kind)
{
    size_t member[IMK_LOG_COLUMNS_MAX];
    const size_t members = members_of(result, kind, member);
    text_table table = text_table_make(2 + members);
    if (members == 0)
        return table;
    text_table_row(&table);
    text_table_set(&table, 0, "noise parameter");
    text_table_set(&table, 1, "unit");
    for (size_t k = 0; k < members; k++)
        text_table_set(&table, 2 + k, "%s", log_channel_column(&result->channels, member[k])->name);
    const imk_log_column *column = log_channel_column(&result->channels, member[0]);
    for (int term = 0; term <= IMK_NOISE_RANDOM_WALK; term++) {
        const term_display display = identify_term(column, (imk_noise_term)term);
        text_table_row(&table);
        text_table_set(&table, 0, "%s", display.name);
        text_table_set(&table, 1, "%s", display.unit.text);
        for (size_t k = 0; k < members; k++)
            if (result->found[member[k]].fit_status == IMK_OK)
                parameter_cell(&table, 2 + k, &result->found[member[k]].fit.term[term],
                               display.unit.scale);
    }
    text_table_row(&table);
    text_table_set(&table, 0, "misfit");
    text_table_set(&table, 1, "1 if explained");
    for (size_t k = 0; k < members; k++)
        if (result->found[member[k]].fit_status == IMK_OK)
            text_table_set(&table, 2 + k, "%.2f", result->found[member[k]].fit.misfit);
    return table;
}

typedef void table_sink(void *context, text_table *table);

/* All tables in the order of a reader: densities, lines, parameters. */
static void each_table(const spectrum_result *result, table_sink *sink, void *context)
{
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = density_table(result, kind);
        sink(context, &table);
        text_table_free(&table);
    }
    text_table lines = line_table(result);
    sink(context, &lines);
    text_table_free(&lines);
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = parameter_table(result, kind);
        sink(context, &table);
        text_table_free(&table);
    }
}

static void print_table(void *context, text_table *table)
{
    (void)context;
    if (table->rows == 0)
        return;
    text_table_print(table, stdout);
    putchar('\n');
}

/* How the figures are meant, in one sentence. */
static void explain(const spectrum_result *result, char *text, size_t size)
{
    const imk_spectrum *s = &result->found[0].spectrum;
    size_t lines = 0;
    for (size_t c = 0; c < result->channels.count; c++)
        lines += result->found[c].line_count;
    snprintf(text, size,
             "Root densities, %s, lines left out; in brackets: %g %% confidence. %s: %zu "
             "segments of %.4g s, resolution %.3g Hz.%s",
             spectrum_sides_text(result), 100 * result->options->confidence,
             result->options->method ? "Multitaper" : "Welch", s->segments,
             (double)s->length * s->dt, s->noise_bandwidth, lines == 0 ? " No lines found." : "");
}

void spectrum_print_tables(const spectrum_result *result)
{
    char text[300];
    each_table(result, print_table, NULL);
    explain(result, text, sizeof text);
    printf("%s\n", text);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *line_json(const imk_spectrum_line *l, imk_unit unit)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:b, s:o, s:o, s:o, s:i, s:i}", "frequency",
                     json_quantity(l->frequency, "Hz"), "frequency_sigma",
                     json_quantity(l->frequency_sigma, "Hz"), "amplitude",
                     json_quantity(l->amplitude / unit.scale, unit.text), "amplitude_sigma",
                     json_quantity(l->amplitude_sigma / unit.scale, unit.text), "coherent",
                     l->coherent, "width", json_quantity(l->width, "Hz"), "ratio",
                     json_number(l->density / l->level), "false_alarm", json_number(l->false_alarm),
                     "family", l->family, "multiple", l->multiple);
}

static json_t *band_json(const imk_spectrum_band *b, double scale, const char *unit)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "frequency", json_quantity(b->frequency, "Hz"),
                     "density", json_quantity(b->density * scale, unit), "lower",
                     json_quantity(b->lower * scale, unit), "upper",
                     json_quantity(b->upper * scale, unit), "degrees", json_number(b->degrees));
}

static json_t *parameters_json(const channel_spectrum *f, const imk_log_column *column)
{
    if (f->fit_status != IMK_OK)
        return json_null();
    json_t *terms = json_object();
    for (int term = 0; term <= IMK_NOISE_RANDOM_WALK; term++) {
        const term_display display = identify_term(column, (imk_noise_term)term);
        const imk_estimate *e = &f->fit.term[term];
        const double scale = channel_kind_of(column) == CHANNEL_OTHER ? display.unit.scale : 1;
        json_object_set_new(terms, display.key,
                            json_pack("{s:b, s:o, s:o, s:o, s:o}", "present", e->present, "value",
                                      json_quantity(e->value / scale, display.si), "sigma",
                                      json_quantity(e->sigma / scale, display.si), "lower",
                                      json_quantity(e->lower / scale, display.si), "upper",
                                      json_quantity(e->upper / scale, display.si)));
    }
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "terms", terms, "from",
                     json_quantity(f->fit.lowest, "Hz"), "to", json_quantity(f->fit.highest, "Hz"),
                     "misfit", json_number(f->fit.misfit), "worst_frequency",
                     json_quantity(f->fit.worst_frequency, "Hz"), "worst_ratio",
                     json_number(f->fit.worst_ratio));
}

static json_t *channel_json(const spectrum_result *result, size_t channel)
{
    const imk_log_column *column = log_channel_column(&result->channels, channel);
    const channel_spectrum *f = &result->found[channel];
    const imk_unit unit = channel_plain_unit(column);
    const double scale = spectrum_sides(result) / unit.scale / unit.scale;
    char density[64];
    snprintf(density, sizeof density, "(%.48s)^2/Hz", unit.text);
    json_t *bands = json_array(), *lines = json_array();
    for (size_t i = 0; i < f->table_count; i++)
        json_array_append_new(bands, band_json(&f->table[i], scale, density));
    for (size_t i = 0; i < f->line_count; i++)
        json_array_append_new(lines, line_json(&f->line[i], unit));
    return json_pack("{s:o, s:I, s:o, s:o, s:o, s:o, s:o}", "name", json_text(column->name),
                     "segments", (json_int_t)f->spectrum.segments, "resolution",
                     json_quantity(f->spectrum.noise_bandwidth, "Hz"), "fraction_used",
                     json_number(f->spectrum.fraction_used), "bands", bands, "lines", lines,
                     "parameters", parameters_json(f, column));
}

int spectrum_print_json(const spectrum_result *result)
{
    const log_channels *channels = &result->channels;
    const spectrum_options *o = result->options;
    json_t *list = json_array();
    for (size_t c = 0; c < channels->count; c++)
        json_array_append_new(list, channel_json(result, c));
    json_t *inputs = json_pack(
        "{s:o, s:I, s:o, s:s, s:s, s:f, s:f}", "log", json_text(result->path), "rows",
        (json_int_t)channels->rows, "interval", json_quantity(channels->dt, "s"), "method",
        o->method ? "multitaper" : "welch", "density", spectrum_sides_text(result), "confidence",
        o->confidence, "false_alarm", o->false_alarm);
    int code = json_print("spectrum", inputs, json_pack("{s:o}", "channels", list), EXIT_DONE);
    return code == EXIT_DONE ? -1 : code;
}

/* ---- page ------------------------------------------------------------------------------------ */

static void put_on_page(void *page, text_table *table)
{
    page_put_table(page, table);
}

int spectrum_write_report(const spectrum_result *result, const char *path)
{
    char subtitle[300], text[300];
    spectrum_figure *figure = spectrum_figure_make(result);
    snprintf(subtitle, sizeof subtitle, "%.120s: %zu samples of %zu channels, %g Hz", result->path,
             result->channels.rows, result->channels.count, 1 / result->channels.dt);
    imk_page *page = imk_page_create("Power spectral density", subtitle);
    imk_page_figure(page, spectrum_figure_get(figure),
                    "Root densities, and their intervals as bands. Large points: spectral lines.");
    explain(result, text, sizeof text);
    imk_page_text(page, text);
    each_table(result, put_on_page, page);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    spectrum_figure_free(figure);
    return page_write(page, path);
}
