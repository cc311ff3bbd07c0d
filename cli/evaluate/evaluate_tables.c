/* SPDX-License-Identifier: Apache-2.0 */
/* The figures as tables of text, and what is said beside them. */
#include "evaluate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER = 40 };

static void number(double value, double spread, char text[NUMBER])
{
    format_value(value, spread, 4, text, NUMBER);
    if (text[0] == '-' && text[strspn(text, "-0.")] == '\0') /* rounded to nothing */
        format_value(0, spread, 4, text, NUMBER);
}

/* "1.20 … 1.45", "above 0.1" where one end is open. */
static void put_interval(text_table *table, size_t column, const evaluate_row *row)
{
    const double scale = row->unit.scale, low = row->figure.lower / scale;
    const double high = row->figure.upper / scale, spread = 0.25 * (high - low);
    char a[NUMBER], b[NUMBER];
    number(low, spread, a);
    number(high, spread, b);
    if (isfinite(low) && isfinite(high))
        text_table_set(table, column, "%s … %s", a, b);
    else if (isfinite(low) && low > 0)
        text_table_set(table, column, "above %s", a);
    else if (isfinite(high))
        text_table_set(table, column, "up to %s", b);
}

text_table evaluate_figure_table(const evaluation *v, const char *name, size_t count,
                                 const evaluate_row *row)
{
    const bool limits = v->limit_count > 0;
    text_table table = text_table_make(limits ? 6 : 4);
    table.right = 1U << 1 | 1U << 2;
    text_table_row(&table);
    text_table_set(&table, 0, "%s", name);
    text_table_set(&table, 1, "value");
    text_table_set(&table, 2, "%g %% interval", 100 * v->options->confidence);
    text_table_set(&table, 3, "unit");
    if (limits) {
        text_table_set(&table, 4, "limit");
        text_table_set(&table, 5, "verdict");
    }
    for (size_t k = 0; k < count; k++) {
        const imk_evaluation_figure *f = &row[k].figure;
        const double scale = row[k].unit.scale;
        char value[NUMBER];
        const char *text;
        const evaluate_verdict verdict = evaluate_judge(v, &row[k], &text);
        if (!isfinite(f->value) && !isfinite(f->upper) && verdict == VERDICT_NONE)
            continue;
        text_table_row(&table);
        number(f->value / scale, 0.25 * (f->upper - f->lower) / scale, value);
        text_table_set(&table, 0, "%s", row[k].title);
        text_table_set(&table, 1, "%s", value);
        put_interval(&table, 2, &row[k]);
        text_table_set(&table, 3, "%s", row[k].unit.text);
        if (limits) {
            text_table_set(&table, 4, "%s", text);
            text_table_set(&table, 5, "%s", evaluate_verdict_text(verdict));
        }
    }
    return table;
}

text_table evaluate_level_table(const evaluation *v, const evaluate_channel *c)
{
    static const char *const heads[] = {"mean",    "1 sigma",      "rising",
                                        "falling", "off the line", "off the best line"};
    (void)v;
    text_table table = text_table_make(8);
    table.right = 0xff;
    text_table_row(&table);
    text_table_set(&table, 0, "reference [%s]", c->reference_unit.text);
    text_table_set(&table, 1, "readings");
    for (size_t k = 0; k < 6; k++)
        text_table_set(&table, 2 + k, "%s [%s]", heads[k], c->reading_unit.text);
    const imk_unit *unit = &c->reading_unit;
    for (size_t k = 0; k < c->result.levels; k++) {
        const imk_evaluation_level *l = &c->level[k];
        const double s = unit->scale, o = unit->offset, spread = 0.1 * l->sigma / s;
        const double value[6] = {(l->reading - o) / s, l->sigma / s,     (l->up - o) / s,
                                 (l->down - o) / s,    l->deviation / s, l->deviation_best / s};
        char text[NUMBER];
        text_table_row(&table);
        text_table_set(&table, 0, "%.6g",
                       (l->reference - c->reference_unit.offset) / c->reference_unit.scale);
        text_table_set(&table, 1, "%zu", l->count);
        for (size_t i = 0; i < 6; i++) {
            format_value(value[i], i == 1 ? 0 : spread, i == 1 ? 2 : 6, text, sizeof text);
            text_table_set(&table, 2 + i, "%s", isfinite(value[i]) ? text : "-");
        }
    }
    return table;
}

void evaluate_basis(const evaluate_channel *c, char *text, size_t size)
{
    const imk_evaluation *r = &c->result;
    const char *sources[] = {"replicates", "the stated sigmas",
                             "the residuals of the line, nonlinearity included", "nothing"};
    char freedom[60] = "";
    if (isfinite(r->freedom) && r->source != IMK_SCATTER_NONE)
        snprintf(freedom, sizeof freedom, " (%.0f degrees of freedom)", r->freedom);
    snprintf(text, size,
             "%s: %zu readings at %zu level%s in %zu run%s; full scale %.6g %s; noise from %s%s",
             c->name, c->count, r->levels, r->levels == 1 ? "" : "s", r->runs,
             r->runs == 1 ? "" : "s", r->full_scale / c->reference_unit.scale,
             c->reference_unit.text, sources[r->source], freedom);
}

/* ---- remarks --------------------------------------------------------------------------------- */

typedef bool (*remark)(const evaluate_channel *c, char *text, size_t size);

static bool no_noise(const evaluate_channel *c, char *text, size_t size)
{
    snprintf(text, size,
             "No reading was repeated under the same conditions, so noise cannot be told from "
             "nonlinearity and hysteresis: these have no interval. Take every level at least twice "
             "from the same side");
    return c->result.source >= IMK_SCATTER_RESIDUALS;
}

static bool too_equal(const evaluate_channel *c, char *text, size_t size)
{
    snprintf(text, size,
             "Repeated readings are all equal: the output's resolution hides the noise, and the "
             "intervals do not contain it");
    return c->result.source == IMK_SCATTER_REPLICATES && c->result.precision.value == 0;
}

static bool no_smaller_step(const evaluate_channel *c, char *text, size_t size)
{
    const imk_evaluation *r = &c->result;
    const double step = r->smallest_step / c->reference_unit.scale;
    snprintf(text, size,
             "Every step gave its change down to the smallest that was tested and could be told "
             "from noise, %.6g %s: the resolution is that or finer",
             step, c->reference_unit.text);
    return r->resolution.value <= r->smallest_step;
}

static bool left_out(const evaluate_channel *c, char *text, size_t size)
{
    snprintf(text, size, "%zu stretches about other axes are left out", c->left_out);
    return c->left_out > 0;
}

static bool no_accuracy(const evaluate_channel *c, char *text, size_t size)
{
    snprintf(text, size,
             "Readings in %s have no error against a reference in %s: add --sensitivity (and "
             "--zero) for the accuracy",
             c->reading_unit.text, c->reference_unit.text);
    return !c->settings.same_unit;
}

bool evaluate_remark(const evaluate_channel *channel, size_t line, char *text, size_t size)
{
    static const remark remarks[] = {no_noise, too_equal, no_smaller_step, no_accuracy, left_out};
    for (size_t k = 0; k < sizeof remarks / sizeof *remarks; k++)
        if (remarks[k](channel, text, size) && line-- == 0)
            return true;
    return false;
}

/* ---- text ------------------------------------------------------------------------------------ */

static void print_table(text_table table)
{
    if (table.rows > 1) {
        text_table_print(&table, stdout);
        putchar('\n');
    }
    text_table_free(&table);
}

void evaluate_print(const evaluation *v)
{
    evaluate_row row[EVALUATE_ROWS];
    char text[500];
    for (size_t k = 0; k < v->channel_count; k++) {
        const evaluate_channel *c = &v->channel[k];
        evaluate_basis(c, text, sizeof text);
        printf("%s\n\n", text);
        print_table(evaluate_figure_table(v, c->name, evaluate_figures(v, c, row), row));
        if (v->options->levels)
            print_table(evaluate_level_table(v, c));
        for (size_t line = 0; evaluate_remark(c, line, text, sizeof text); line++)
            printf("%s.\n", text);
        if (k + 1 < v->channel_count || v->rest_count > 0)
            putchar('\n');
    }
    for (size_t k = 0; k < v->rest_count; k++)
        print_table(evaluate_figure_table(v, v->rest[k].name,
                                          evaluate_rest_figures(&v->rest[k], row), row));
    if (v->options->report)
        printf("Report: %s\n", v->options->report);
}
