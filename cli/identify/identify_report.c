/* SPDX-License-Identifier: Apache-2.0 */
/* The identification as an HTML page and as JSON. */
#include "identify_parts.h"

#include "shell/json_output.h"
#include "shell/page_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put_parameters(imk_page *page, const identification *i)
{
    imk_page_heading(page, "Parameters");
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++) {
        text_table table = identify_table(i, kind);
        page_put_table(page, &table);
        text_table_free(&table);
    }
    imk_page_text(page,
                  "Values with their 1-sigma uncertainty; below each the interval that holds the "
                  "true value with the stated confidence, by profile likelihood. \"absent\" means "
                  "that the record does not show the term; the bound below says how large it could "
                  "still be. Bias instability is B of IEEE 952: the flat floor of the Allan "
                  "deviation is 0.664 B; the measured minimum also holds white noise and random "
                  "walk, which is why it is larger.");
    if (i->options->truth) {
        size_t covered, stated;
        text_table table = identify_truth_table(i, &covered, &stated);
        char text[160];
        imk_page_heading(page, "Against the truth");
        page_put_table(page, &table);
        text_table_free(&table);
        snprintf(text, sizeof text, "%zu of %zu intervals cover the truth; %g %% are expected to.",
                 covered, stated, 100 * i->options->confidence);
        imk_page_text(page, text);
    }
}

static void put_model(imk_page *page, const identification *i)
{
    if (!i->model.gyro.present && !i->model.accel.present)
        return;
    page_put_model(page, "Model file", &i->model);
}

static void put_next_steps(imk_page *page, const identification *i)
{
    char text[600];
    const char *model = i->options->output ? i->options->output : "model.yaml";
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    imk_page_heading(page, "Next");
    snprintf(text, sizeof text,
             "imukit grade %s\n"
             "imukit simulate %s --rate %gHz --duration 1h --seed 2 -o another.csv\n"
             "imukit identify %s --into MODEL -o MODEL   # only the noise of an existing model",
             model, model, 1 / i->found->record.dt, i->path);
    imk_page_code(page, text);
}

int identify_report(const identification *i, const char *path)
{
    char subtitle[300], length[60];
    format_duration(i->found->duration, length, sizeof length);
    snprintf(subtitle, sizeof subtitle, "%.120s: %zu samples of %zu channels, %g Hz, %s", i->path,
             i->found->record.rows, i->found->record.count, 1 / i->found->record.dt, length);
    imk_page *page = imk_page_create("Noise of an inertial sensor", subtitle);
    imk_page_heading(page, "Verdict");
    for (size_t k = 0; k < i->verdict_count; k++)
        imk_page_verdict(page, i->verdict[k].level, i->verdict[k].text);
    put_parameters(page, i);
    imk_page_heading(page, "Allan deviation");
    identify_figure *figure = command_memory(NULL, sizeof *figure);
    identify_figure_make(i, true, figure);
    imk_page_figure(page, &figure->figure,
                    "Points: the log, with confidence intervals. Line: the model. Dashes: its "
                    "terms. Grey: where the points of a record of this length may fall under the "
                    "model. Twin: a simulation of the model. Below: how improbable the difference "
                    "of each point from the model is, as standard deviations of a normal "
                    "distribution; neighbours share most of their data.");
    identify_figure_free(figure);
    free(figure);
    put_model(page, i);
    put_next_steps(page, i);
    return page_write(page, path);
}

static json_t *estimate_json(const imk_estimate *e, const char *unit, double scale)
{
    return json_pack("{s:b, s:o, s:o, s:o, s:o, s:o, s:s}", "present", e->present, "value",
                     json_number(e->value / scale), "sigma", json_number(e->sigma / scale), "lower",
                     json_number(e->lower / scale), "upper", json_number(e->upper / scale),
                     "free_value", json_number(e->free_value / scale), "unit", unit);
}

static json_t *gauss_markov_json(const imk_identification *r, const imk_unit *plain)
{
    json_t *list = json_array();
    for (int k = 0; k < r->gauss_markov_count; k++)
        json_array_append_new(
            list, json_pack("{s:o, s:o}", "sigma",
                            estimate_json(&r->gauss_markov[k].sigma, plain->text, plain->scale),
                            "correlation_time",
                            estimate_json(&r->gauss_markov[k].correlation_time, "s", 1)));
    return list;
}

static json_t *extras_json(const imk_identification *r, const imk_unit *plain)
{
    json_t *lines = json_array(), *resonances = json_array();
    for (int k = 0; k < r->sinusoid_count; k++)
        json_array_append_new(
            lines, json_pack("{s:o, s:o}", "amplitude",
                             json_quantity(r->sinusoid[k].amplitude / plain->scale, plain->text),
                             "frequency", json_quantity(r->sinusoid[k].frequency, "Hz")));
    for (int k = 0; k < r->resonance_count; k++)
        json_array_append_new(
            resonances, json_pack("{s:o, s:o, s:o}", "sigma",
                                  json_quantity(r->resonance[k].sigma / plain->scale, plain->text),
                                  "frequency", json_quantity(r->resonance[k].frequency, "Hz"), "q",
                                  json_quantity(r->resonance[k].q, "1")));
    json_t *filter =
        r->filter.bandwidth > 0
            ? json_pack("{s:o, s:o}", "bandwidth", json_quantity(r->filter.bandwidth, "Hz"),
                        "damping", json_quantity(r->filter.damping, "1"))
            : json_null();
    return json_pack("{s:o, s:o, s:o, s:o}", "gauss_markov", gauss_markov_json(r, plain),
                     "sinusoid", lines, "resonance", resonances, "filter", filter);
}

json_t *identify_channel_json(const identification *i, size_t channel)
{
    const imk_log_column *column = log_channel_column(&i->found->record, channel);
    const imk_identification *r = &i->found->result[channel];
    imk_unit plain = channel_plain_unit(column);
    json_t *terms = json_object();
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        term_display display = identify_term(column, (imk_noise_term)term);
        double scale = channel_kind_of(column) == CHANNEL_OTHER ? plain.scale : 1;
        json_object_set_new(terms, display.key, estimate_json(&r->term[term], display.si, scale));
    }
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:o, s:o}", "name",
        json_text(column->name), "terms", terms, "extras", extras_json(r, &plain), "mean",
        json_quantity(r->mean / plain.scale, plain.text), "allan_minimum_over_0.664",
        json_quantity(r->minimum_floor / plain.scale, plain.text), "resolution",
        json_quantity(r->resolution / plain.scale, plain.text), "valid_from",
        json_quantity(r->valid_from, "s"), "five_terms_from",
        json_quantity(r->five_terms_from, "s"), "valid_to", json_quantity(r->valid_to, "s"),
        "missing", (json_int_t)r->missing, "largest_gap", json_quantity(r->largest_gap, "s"),
        "screening", identify_screen_json(i, channel));
}

json_t *identify_verdict_json(const identification *i)
{
    json_t *verdict = json_array();
    for (size_t k = 0; k < i->verdict_count; k++) {
        static const char *const levels[] = {"good", "note", "warning"};
        json_array_append_new(
            verdict, json_pack("{s:s, s:s, s:o}", "level", levels[i->verdict[k].level], "code",
                               i->verdict[k].code, "message", json_text(i->verdict[k].text)));
    }
    return verdict;
}

int identify_json(const identification *i, int code)
{
    json_t *channels = json_array();
    for (size_t c = 0; c < i->found->record.count; c++)
        json_array_append_new(channels, identify_channel_json(i, c));
    json_t *inputs = json_pack(
        "{s:o, s:I, s:I, s:o, s:f}", "log", json_text(i->path), "rows",
        (json_int_t)i->found->record.rows, "bridged", (json_int_t)i->found->record.bridged,
        "interval", json_quantity(i->found->record.dt, "s"), "confidence", i->options->confidence);
    return json_print(
        "identify", inputs,
        json_pack("{s:o, s:o}", "channels", channels, "verdict", identify_verdict_json(i)), code);
}
