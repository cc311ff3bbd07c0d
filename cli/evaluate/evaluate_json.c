/* SPDX-License-Identifier: Apache-2.0 */
/* The evaluation as JSON. */
#include "evaluate_parts.h"

#include "shell/json_output.h"

#include <math.h>

static json_t *figures_json(const evaluation *v, size_t count, const evaluate_row *row)
{
    json_t *figures = json_object();
    for (size_t k = 0; k < count; k++) {
        const imk_evaluation_figure *f = &row[k].figure;
        const char *text;
        const evaluate_verdict verdict = evaluate_judge(v, &row[k], &text);
        json_t *figure =
            json_pack("{s:o, s:o, s:o, s:s}", "value", json_number(f->value), "lower",
                      json_number(f->lower), "upper", json_number(f->upper), "unit", row[k].si);
        if (row[k].level >= 0)
            json_object_set_new(figure, "level", json_integer(row[k].level));
        if (verdict != VERDICT_NONE) {
            json_object_set_new(figure, "limit", json_text(text));
            json_object_set_new(figure, "verdict", json_string(evaluate_verdict_text(verdict)));
        }
        json_object_set_new(figures, row[k].key, figure);
    }
    return figures;
}

static json_t *levels_json(const evaluate_channel *c)
{
    json_t *list = json_array();
    for (size_t k = 0; k < c->result.levels; k++) {
        const imk_evaluation_level *l = &c->level[k];
        json_array_append_new(list, json_pack("{s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o}",
                                              "reference", json_number(l->reference), "count",
                                              (json_int_t)l->count, "mean", json_number(l->reading),
                                              "sigma", json_number(l->sigma), "up",
                                              json_number(l->up), "down", json_number(l->down),
                                              "deviation", json_number(l->deviation),
                                              "deviation_best", json_number(l->deviation_best)));
    }
    return list;
}

static json_t *line_json(const imk_evaluation_line *line)
{
    return json_pack("{s:o, s:o, s:o}", "zero", json_number(line->zero), "sensitivity",
                     json_number(line->sensitivity), "deviation", json_number(line->deviation));
}

static json_t *channel_json(const evaluation *v, const evaluate_channel *c)
{
    static const char *const sources[] = {"replicates", "stated", "residuals", "none"};
    evaluate_row row[EVALUATE_ROWS];
    char reference[40], reading[40];
    const imk_evaluation *r = &c->result;
    const size_t count = evaluate_figures(v, c, row);
    imk_dimension_si(c->reference_unit.dimension, reference, sizeof reference);
    imk_dimension_si(c->reading_unit.dimension, reading, sizeof reading);
    json_t *alternation = json_array();
    for (int k = 0; k < 3 && r->alternation[k] >= 0; k++)
        json_array_append_new(alternation, json_integer(r->alternation[k]));
    return json_pack(
        "{s:o, s:I, s:I, s:o, s:s, s:o, s:s, s:s, s:o, s:o, s:o, s:o, s:o}", "name",
        json_text(c->name), "readings", (json_int_t)c->count, "runs", (json_int_t)r->runs,
        "full_scale", json_quantity(r->full_scale, reference), "noise_from", sources[r->source],
        "degrees_of_freedom", json_number(r->freedom), "reference_unit", reference, "reading_unit",
        reading, "figures", figures_json(v, count, row), "least_squares_line", line_json(&r->line),
        "best_line", line_json(&r->best), "alternation", alternation, "levels", levels_json(c));
}

int evaluate_json(const evaluation *v, int code)
{
    json_t *files = json_array(), *channels = json_array(), *rest = json_array();
    for (size_t k = 0; k < v->path_count; k++)
        json_array_append_new(files, json_text(v->path[k]));
    for (size_t k = 0; k < v->channel_count; k++)
        json_array_append_new(channels, channel_json(v, &v->channel[k]));
    for (size_t k = 0; k < v->rest_count; k++) {
        evaluate_row row[EVALUATE_ROWS];
        const size_t count = evaluate_rest_figures(&v->rest[k], row);
        json_array_append_new(rest, json_pack("{s:o, s:o}", "name", json_text(v->rest[k].name),
                                              "figures", figures_json(v, count, row)));
    }
    json_t *inputs = json_pack("{s:o, s:o, s:f}", "files", files, "static",
                               v->options->rest ? json_text(v->options->rest) : json_null(),
                               "confidence", v->options->confidence);
    json_t *result = json_pack("{s:o, s:o, s:b}", "channels", channels, "static", rest,
                               "limits_met", !v->missed);
    return json_print("evaluate", inputs, result, code);
}
