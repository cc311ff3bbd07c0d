/* SPDX-License-Identifier: Apache-2.0 */
/* The evaluation as a result: data, tables for the terminal, and the test report that can be read,
 * or printed on paper or into a PDF. */
#include "show_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NUMBER = 40 };

/* ---- data ------------------------------------------------------------------------------------ */

static void show_figure_data(const imk_evaluate_sheet *sheet, imk_result *result)
{
    imk_result_object(result, "figures");
    for (const imk_evaluate_row *row = sheet->row; row < sheet->row + sheet->count; row++) {
        imk_result_object(result, row->key);
        imk_result_number(result, "value", row->figure.value);
        imk_result_number(result, "lower", row->figure.lower);
        imk_result_number(result, "upper", row->figure.upper);
        imk_result_text(result, "unit", row->si);
        if (row->level >= 0)
            imk_result_count(result, "level", row->level);
        if (row->verdict != IMK_EVALUATE_NONE) {
            imk_result_text(result, "limit", row->limit);
            imk_result_text(result, "verdict", imk_evaluate_verdict_text(row->verdict));
        }
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_line_data(const char *key, const imk_evaluation_line *line, imk_result *result)
{
    imk_result_object(result, key);
    imk_result_number(result, "zero", line->zero);
    imk_result_number(result, "sensitivity", line->sensitivity);
    imk_result_number(result, "deviation", line->deviation);
    imk_result_end(result);
}

static void show_level_data(const imk_evaluate_channel *c, imk_result *result)
{
    imk_result_array(result, "levels");
    for (const imk_evaluation_level *l = c->level; l < c->level + c->result.levels; l++) {
        imk_result_object(result, NULL);
        imk_result_number(result, "reference", l->reference);
        imk_result_count(result, "count", (long long)l->count);
        imk_result_number(result, "mean", l->reading);
        imk_result_number(result, "sigma", l->sigma);
        imk_result_number(result, "up", l->up);
        imk_result_number(result, "down", l->down);
        imk_result_number(result, "deviation", l->deviation);
        imk_result_number(result, "deviation_best", l->deviation_best);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_channel_data(const imk_evaluate_channel *c, imk_result *result)
{
    static const char *const sources[] = {"replicates", "stated", "residuals", "none"};
    char reference[40], reading[40];
    const imk_evaluation *r = &c->result;
    imk_dimension_si(c->reference_unit.dimension, reference, sizeof reference);
    imk_dimension_si(c->reading_unit.dimension, reading, sizeof reading);
    imk_result_object(result, NULL);
    imk_result_text(result, "name", c->name);
    imk_result_count(result, "readings", (long long)c->count);
    imk_result_count(result, "runs", (long long)r->runs);
    imk_result_quantity(result, "full_scale", r->full_scale, reference);
    imk_result_text(result, "noise_from", sources[r->source]);
    imk_result_number(result, "degrees_of_freedom", r->freedom);
    imk_result_text(result, "reference_unit", reference);
    imk_result_text(result, "reading_unit", reading);
    show_figure_data(&c->sheet, result);
    show_line_data("least_squares_line", &r->line, result);
    show_line_data("best_line", &r->best, result);
    imk_result_array(result, "alternation");
    for (int k = 0; k < 3 && r->alternation[k] >= 0; k++)
        imk_result_count(result, NULL, r->alternation[k]);
    imk_result_end(result);
    show_level_data(c, result);
    imk_result_end(result);
}

static void show_data(const imk_evaluate_shown *v, imk_result *result)
{
    imk_result_object(result, "inputs");
    imki_show_texts(result, "files", v->path_count, v->path);
    imk_result_text(result, "static", v->rest_path);
    imk_result_number(result, "confidence", v->confidence);
    imk_result_end(result);
    imk_result_object(result, "result");
    imki_judge_evaluation(v, result);
    imk_result_array(result, "channels");
    for (size_t k = 0; k < v->channel_count; k++)
        show_channel_data(&v->channel[k], result);
    imk_result_end(result);
    imk_result_array(result, "static");
    for (size_t k = 0; k < v->rest_count; k++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "name", v->rest[k].name);
        show_figure_data(&v->rest[k].sheet, result);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_flag(result, "limits_met", !v->missed);
    imk_result_end(result);
}

/* ---- tables ---------------------------------------------------------------------------------- */

static void number(double value, double spread, char text[NUMBER])
{
    imk_readable_value(value, spread, 4, text, NUMBER);
    if (value < 0 && text[strspn(text, "-0.")] == '\0') /* rounded to nothing */
        imk_readable_value(0, spread, 4, text, NUMBER);
}

/* "1.20 … 1.45", "above 0.1" where one end is open, "up to 0.5" where nothing says that the figure
 * is not 0. */
static void add_interval(const imk_evaluate_row *row, imk_table *table)
{
    const double scale = row->unit.scale, low = row->figure.lower / scale;
    const double high = row->figure.upper / scale, spread = 0.25 * (high - low);
    char a[NUMBER], b[NUMBER];
    number(low, spread, a);
    number(high, spread, b);
    if (isfinite(low) && isfinite(high) && isfinite(row->figure.value))
        imk_table_add(table, "%s … %s", a, b);
    else if (isfinite(low) && low > 0)
        imk_table_add(table, "above %s", a);
    else
        imk_table_add(table, "%s%s", isfinite(high) ? "up to " : "", isfinite(high) ? b : "");
}

/* Figures that are not determined are left out, unless they have a limit. */
static void show_figures(const imk_evaluate_shown *v, const char *name,
                         const imk_evaluate_sheet *sheet, imk_result *result)
{
    const bool limits = v->limit_count > 0;
    imk_table *table = imk_result_table(result, 1U << 1 | 1U << 2);
    for (const imk_evaluate_row *row = sheet->row; row < sheet->row + sheet->count; row++) {
        const imk_evaluation_figure *f = &row->figure;
        const double scale = row->unit.scale;
        char value[NUMBER];
        if (!isfinite(f->value) && !isfinite(f->upper) && row->verdict == IMK_EVALUATE_NONE)
            continue;
        if (imk_table_rows(table) == 0) {
            imk_table_row(table, "%s\tvalue\t%g %% interval\tunit", name, 100 * v->confidence);
            if (limits)
                imk_table_add(table, "limit\tverdict");
        }
        number(f->value / scale, 0.25 * (f->upper - f->lower) / scale, value);
        imk_table_row(table, "%s\t%s", row->title, value);
        add_interval(row, table);
        imk_table_add(table, "%s", row->unit.text);
        if (limits)
            imk_table_add(table, "%s\t%s", row->limit, imk_evaluate_verdict_text(row->verdict));
    }
    if (imk_table_rows(table) > 0)
        imk_result_gap(result);
}

static void show_levels(const imk_evaluate_channel *c, imk_result *result)
{
    static const char *const heads[] = {"mean",    "1 sigma",      "rising",
                                        "falling", "off the line", "off the best line"};
    const imk_unit *unit = &c->reading_unit, *reference = &c->reference_unit;
    if (c->result.levels == 0)
        return;
    imk_table *table = imk_result_table(result, 0xff);
    imk_table_row(table, "reference [%s]\treadings", reference->text);
    for (size_t k = 0; k < 6; k++)
        imk_table_add(table, "%s [%s]", heads[k], unit->text);
    for (const imk_evaluation_level *l = c->level; l < c->level + c->result.levels; l++) {
        const double s = unit->scale, o = unit->offset, spread = 0.1 * l->sigma / s;
        const double value[6] = {(l->reading - o) / s, l->sigma / s,     (l->up - o) / s,
                                 (l->down - o) / s,    l->deviation / s, l->deviation_best / s};
        imk_table_row(table, "%.6g\t%zu", (l->reference - reference->offset) / reference->scale,
                      l->count);
        for (size_t i = 0; i < 6; i++) {
            char text[NUMBER];
            imk_readable_value(value[i], i == 1 ? 0 : spread, i == 1 ? 2 : 6, text, sizeof text);
            imk_table_add(table, "%s", isfinite(value[i]) ? text : "-");
        }
    }
    imk_result_gap(result);
}

/* ---- words ----------------------------------------------------------------------------------- */

/* What the figures rest on. */
static void show_basis(const imk_evaluate_channel *c, imk_result *result)
{
    static const char *const sources[] = {"replicates", "the stated sigmas",
                                          "the residuals of the line, nonlinearity included",
                                          "nothing"};
    const imk_evaluation *r = &c->result;
    char freedom[60] = "";
    if (isfinite(r->freedom) && r->source != IMK_SCATTER_NONE)
        snprintf(freedom, sizeof freedom, " (%.0f degrees of freedom)", r->freedom);
    imk_result_line(
        result, "%s: %zu readings at %zu level%s in %zu run%s; full scale %.6g %s; noise from %s%s",
        c->name, c->count, r->levels, r->levels == 1 ? "" : "s", r->runs, r->runs == 1 ? "" : "s",
        r->full_scale / c->reference_unit.scale, c->reference_unit.text, sources[r->source],
        freedom);
}

/* Where all steps passed, resolution and threshold have no value. */
static void show_untested_steps(const imk_evaluate_channel *c, imk_result *result)
{
    const imk_evaluation *r = &c->result;
    const bool steps = isnan(r->resolution.value) && isfinite(r->smallest_step);
    const bool inputs = isnan(r->threshold.value) && isfinite(r->smallest_input);
    const double smallest = steps ? r->smallest_step : r->smallest_input;
    if (steps || inputs)
        imk_result_line(result,
                        "Every %s that exceeds the noise gave its change, down to %.6g %s: the %s "
                        "finer than what was tested. To find %s, test smaller steps.",
                        steps ? "step" : "change from rest", smallest / c->reference_unit.scale,
                        c->reference_unit.text,
                        !inputs  ? "resolution is"
                        : !steps ? "threshold is"
                                 : "resolution and the threshold are",
                        steps && inputs ? "them" : "it");
}

/* What a reader should know beside the numbers. */
static void show_remarks(const imk_evaluate_channel *c, imk_result *result)
{
    const imk_evaluation *r = &c->result;
    if (r->source >= IMK_SCATTER_RESIDUALS)
        imk_result_line(result,
                        "No reading was repeated under the same conditions, so noise cannot be "
                        "separated from nonlinearity and hysteresis: these two have no interval. "
                        "Take every level at least twice from the same side.");
    if (r->source == IMK_SCATTER_REPLICATES && r->precision.value == 0)
        imk_result_line(result, "Repeated readings are all equal: the output's resolution hides "
                                "the noise, and the intervals do not contain it.");
    show_untested_steps(c, result);
    if (!c->settings.same_unit)
        imk_result_line(result,
                        "Readings in %s cannot be compared with a reference in %s: for the "
                        "accuracy, add --sensitivity (and --zero).",
                        c->reading_unit.text, c->reference_unit.text);
    if (c->left_out > 0)
        imk_result_line(result, "%zu stretches about other axes are left out.", c->left_out);
}

/* What only the user knows; no line for what was not said. */
static void show_unit(const imk_evaluate_shown *v, imk_result *result)
{
    const struct {
        const char *title, *text;
    } rows[] = {{"Unit under test", v->unit},  {"Serial number", v->serial},
                {"Laboratory", v->laboratory}, {"Operator", v->operator_name},
                {"Date of the test", v->date}, {"Temperature", v->temperature}};
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "Test");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
        if (rows[k].text)
            imk_table_row(table, "%s\t%s", rows[k].title, rows[k].text);
    for (size_t k = 0; k < v->path_count; k++)
        imk_table_row(table, "%s\t%s", k == 0 ? "Readings" : "", v->path[k]);
    if (v->rest_path)
        imk_table_row(table, "Log at rest\t%s", v->rest_path);
}

/* A finding for each limit that is not surely met. */
static void show_limits(const char *name, const imk_evaluate_sheet *sheet, imk_result *result)
{
    for (const imk_evaluate_row *row = sheet->row; row < sheet->row + sheet->count; row++) {
        char line[300];
        if (row->verdict <= IMK_EVALUATE_MET)
            continue;
        snprintf(line, sizeof line, "%s, %s: %s (limit %s).", name, row->title,
                 imk_evaluate_verdict_text(row->verdict), row->limit);
        imk_result_finding(result, row->verdict == IMK_EVALUATE_DOUBTFUL ? 1 : 2, line);
    }
}

static void show_limits_of_all(const imk_evaluate_shown *v, imk_result *result)
{
    for (size_t k = 0; k < v->channel_count; k++)
        show_limits(v->channel[k].name, &v->channel[k].sheet, result);
    for (size_t k = 0; k < v->rest_count; k++)
        show_limits(v->rest[k].name, &v->rest[k].sheet, result);
}

static void show_definitions(const imk_evaluate_shown *v, imk_result *result)
{
    const imk_evaluate_sheet *sheets[2] = {v->channel_count > 0 ? &v->channel[0].sheet : NULL,
                                           v->rest_count > 0 ? &v->rest[0].sheet : NULL};
    imk_result_heading(result, "Definitions");
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "figure\tdefinition");
    for (int s = 0; s < 2; s++)
        for (size_t k = 0; sheets[s] && k < sheets[s]->count; k++)
            imk_table_row(table, "%s\t%s", sheets[s]->row[k].title, sheets[s]->row[k].definition);
    if (v->channel_count == 0)
        return;
    imk_result_line(result,
                    "Intervals hold the true figure with %g %% confidence: Student's and the "
                    "chi-square distribution for the figures of the line and the precision. For "
                    "figures that are the largest of several differences, the interval is for the "
                    "value that a unit without noise would show at the same levels, and holds this "
                    "value with at least about the same confidence.",
                    100 * v->confidence);
    imk_result_line(result,
                    "The figures describe the runs tested; the repeatability describes how a "
                    "further run would differ. The uncertainty of the reference is not included.");
}

/* ---- all of it ------------------------------------------------------------------------------- */

static void show_channel(const imk_evaluate_shown *v, const imk_evaluate_channel *c,
                         imk_result *result)
{
    imk_result_for(result, IMK_FOR_PAGE);
    if (c > v->channel)
        imk_result_break(result);
    imk_result_heading(result, c->name);
    imk_result_for(result, IMK_FOR_BOTH);
    show_basis(c, result);
    imk_result_gap(result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    show_figures(v, c->name, &c->sheet, result);
    if (v->levels)
        show_levels(c, result);
    imk_result_for(result, IMK_FOR_PAGE);
    show_figures(v, "figure", &c->sheet, result);
    imk_result_for(result, IMK_FOR_BOTH);
    show_remarks(c, result);
    if (c + 1 < v->channel + v->channel_count || v->rest_count > 0)
        imk_result_gap(result);
    imk_result_for(result, IMK_FOR_PAGE);
    if (c->result.levels > 1)
        imki_show_evaluate_panels(
            c,
            imk_result_figure(result, "", c->result.hysteresis_level < 0 ? 1 : 2,
                              "Mean readings of each level minus the least-squares line. Dashes: "
                              "the best line; tinted: the narrowest strip that holds all means. "
                              "Rising and falling: the mean readings of each direction."));
}

/* All channels in one; a single panel keeps its own width, two stand side by side. */
static void show_plotted(const imk_evaluate_shown *v, imk_result *result)
{
    bool two = false;
    for (size_t k = 0; k < v->channel_count; k++)
        two = two || v->channel[k].result.hysteresis_level >= 0;
    imk_result_for(result, IMK_FOR_PLOT);
    imk_figure_builder *figure = imk_result_figure(result, "", two ? 2 : 1, "");
    for (size_t k = 0; k < v->channel_count; k++)
        imki_show_evaluate_panels(&v->channel[k], figure);
}

void imk_show_evaluate(const imk_evaluate_shown *v, imk_result *result)
{
    show_data(v, result);
    imk_result_title(result, "Test report", "%s%s%s", v->unit ? v->unit : "Laboratory figures",
                     v->serial ? ", serial number " : "", v->serial ? v->serial : "");
    imk_result_for(result, IMK_FOR_PAGE);
    show_unit(v, result);
    show_limits_of_all(v, result);
    for (size_t k = 0; k < v->channel_count; k++)
        show_channel(v, &v->channel[k], result);
    imk_result_for(result, IMK_FOR_PAGE);
    if (v->rest_count > 0)
        imk_result_heading(result, "At rest");
    imk_result_for(result, IMK_FOR_BOTH);
    for (size_t k = 0; k < v->rest_count; k++)
        show_figures(v, v->rest[k].name, &v->rest[k].sheet, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (v->report)
        imk_result_line(result, "Report: %s", v->report);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_break(result);
    show_definitions(v, result);
    for (size_t k = 0; k < v->channel_count; k++) {
        char text[IMK_EVALUATE_NAME + 20];
        snprintf(text, sizeof text, "Levels of %s", v->channel[k].name);
        imk_result_heading(result, text);
        show_levels(&v->channel[k], result);
    }
    show_plotted(v, result);
    imk_result_for(result, IMK_FOR_PAGE);
}
