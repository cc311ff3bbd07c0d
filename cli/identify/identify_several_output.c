/* SPDX-License-Identifier: Apache-2.0 */
/* Several logs as tables, as a page and as JSON. */
#include "identify_several.h"

#include "shell/json_output.h"
#include "shell/page_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void several_chance(double probability, char *text, size_t size)
{
    if (probability < 1e-12)
        snprintf(text, size, "below 1e-12");
    else
        snprintf(text, size, "%.2g", probability);
}

/* The random terms that some log shows. */
typedef struct shown_terms {
    size_t count;
    int term[IMK_NOISE_RAMP];
    double scale[IMK_NOISE_RAMP]; /* of the unit a person reads */
} shown_terms;

static shown_terms find_terms(const several_logs *s, size_t channel)
{
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    shown_terms shown = {0};
    for (int term = 0; term < IMK_NOISE_RAMP; term++) {
        const bool runs = s->options->runs;
        if (!(runs ? s->joint->found->result[channel].term[term].present || term == IMK_NOISE_WHITE
                   : s->term[channel][term].compared))
            continue;
        shown.term[shown.count] = term;
        shown.scale[shown.count++] = identify_term(column, (imk_noise_term)term).unit.scale;
    }
    return shown;
}

static void put_value(text_table *table, size_t column, bool present, double value, double sigma,
                      double bound, double scale)
{
    char first[40], second[40];
    if (present) {
        format_value(value / scale, sigma / scale, 4, first, sizeof first);
        format_value(sigma / scale, sigma / scale, 2, second, sizeof second);
        text_table_set(table, column, "%s ± %s", first, second);
    } else if (bound > 0) {
        format_value(bound / scale, 0, 2, first, sizeof first);
        text_table_set(table, column, "< %s", first);
    } else {
        text_table_set(table, column, "absent");
    }
}

static void put_range(text_table *table, size_t column, double lower, double upper, double scale)
{
    char first[40], second[40];
    const double width = (upper - lower) / scale / 4;
    if (!isfinite(upper)) {
        text_table_set(table, column, "from %.3g", lower / scale);
        return;
    }
    format_value(lower / scale, width, 3, first, sizeof first);
    format_value(upper / scale, width, 3, second, sizeof second);
    text_table_set(table, column, "%s to %s", first, second);
}

static void put_runs(text_table *table, const several_logs *s, size_t channel,
                     const shown_terms *shown)
{
    const imk_joint_agreement *a = &s->agreement[channel];
    for (size_t r = 0; r < s->count; r++) {
        text_table_row(table);
        text_table_set(table, 0, "%.60s", s->label[r]);
        for (size_t k = 0; k < shown->count; k++) {
            const int term = shown->term[k];
            put_value(table, 1 + k, a->sigma[r][term] > 0, a->value[r][term], a->sigma[r][term], 0,
                      shown->scale[k]);
        }
    }
    text_table_row(table);
    text_table_set(table, 0, "together");
    for (size_t k = 0; k < shown->count; k++) {
        const imk_estimate *e = &s->joint->found->result[channel].term[shown->term[k]];
        put_value(table, 1 + k, e->present, e->value, e->sigma, e->upper, shown->scale[k]);
    }
    text_table_row(table);
    text_table_set(table, 0, "chance if alike");
    char chance[40];
    several_chance(a->probability, chance, sizeof chance);
    text_table_set(table, 1, "%s", chance);
}

typedef enum population_row {
    MEAN = 0,
    MEAN_RANGE,
    SPREAD,
    SPREAD_RANGE,
    CHANCE,
    POPULATION_ROWS
} population_row;
static const char *const population_names[] = {"mean", "  %g %%", "spread", "  %g %%",
                                               "chance if alike"};

/* A spread smaller than this part of the mean is none. */
static const double no_spread = 1e-6;

static void put_population(text_table *table, size_t column, const device_term *t,
                           population_row row, double scale)
{
    char text[40];
    switch (row) {
    case MEAN:
        format_value(t->mean / scale, (t->upper - t->lower) / scale / 4, 4, text, sizeof text);
        text_table_set(table, column, "%s", text);
        break;
    case SPREAD:
        if (t->spread > no_spread * t->mean)
            text_table_set(table, column, "%.3g", t->spread / scale);
        else
            text_table_set(table, column, "none seen");
        break;
    case CHANCE:
        several_chance(t->squares.probability, text, sizeof text);
        text_table_set(table, column, "%s", text);
        break;
    case SPREAD_RANGE:
        if (t->spread_lower > no_spread * t->mean)
            put_range(table, column, t->spread_lower, t->spread_upper, scale);
        else {
            format_value(t->spread_upper / scale, 0, 2, text, sizeof text);
            text_table_set(table, column, "< %s", text);
        }
        break;
    default:
        put_range(table, column, t->lower, t->upper, scale);
    }
}

static void put_devices(text_table *table, const several_logs *s, size_t channel,
                        const shown_terms *shown)
{
    for (size_t r = 0; r < s->count; r++) {
        text_table_row(table);
        text_table_set(table, 0, "%.60s", s->label[r]);
        for (size_t k = 0; k < shown->count; k++) {
            const strength *d = &s->term[channel][shown->term[k]].device[r];
            put_value(table, 1 + k, d->present, d->value, d->sigma, d->bound, shown->scale[k]);
        }
    }
    /* Two say next to nothing about the mean and spread of their kind. */
    for (population_row row = s->count > 2 ? MEAN : CHANCE; row < POPULATION_ROWS; row++) {
        text_table_row(table);
        text_table_set(table, 0, population_names[row], 100 * s->options->confidence);
        for (size_t k = 0; k < shown->count; k++)
            put_population(table, 1 + k, &s->term[channel][shown->term[k]], row, shown->scale[k]);
    }
}

text_table several_table(const several_logs *s, size_t channel)
{
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    const shown_terms shown = find_terms(s, channel);
    text_table table = text_table_make(1 + shown.count);
    text_table_row(&table);
    text_table_set(&table, 0, "%s", column->name);
    for (size_t k = 0; k < shown.count; k++) {
        const term_display display = identify_term(column, (imk_noise_term)shown.term[k]);
        text_table_set(&table, 1 + k, "%s [%s]", display.name, display.unit.text);
    }
    if (s->options->runs)
        put_runs(&table, s, channel, &shown);
    else
        put_devices(&table, s, channel, &shown);
    return table;
}

text_table several_bias_table(const several_logs *s)
{
    text_table table = text_table_make(6);
    text_table_row(&table);
    text_table_set(&table, 0, "mean from run to run");
    text_table_set(&table, 1, "unit");
    text_table_set(&table, 2, "mean");
    text_table_set(&table, 3, "1 sigma");
    text_table_set(&table, 4, "%g %%", 100 * s->options->confidence);
    text_table_set(&table, 5, "noise within a run");
    for (size_t c = 0; c < s->joint->found->record.count; c++) {
        const imk_log_column *column = log_channel_column(&s->joint->found->record, c);
        const imk_repeatability *b = &s->bias[c];
        const imk_unit unit = channel_readable_unit(column, fmax(b->value, b->within));
        text_table_row(&table);
        text_table_set(&table, 0, "%s", column->name);
        text_table_set(&table, 1, "%s", unit.text);
        text_table_set(&table, 2, "%.6g", b->mean / unit.scale);
        if (b->value > 0)
            text_table_set(&table, 3, "%.3g", b->value / unit.scale);
        else
            text_table_set(&table, 3, "none seen");
        if (b->lower > 0)
            put_range(&table, 4, b->lower, b->upper, unit.scale);
        else
            text_table_set(&table, 4, "< %.2g", b->upper / unit.scale);
        text_table_set(&table, 5, "%.3g", b->within / unit.scale);
    }
    return table;
}

static void print_table(text_table table)
{
    if (table.rows > 0) {
        text_table_print(&table, stdout);
        putchar('\n');
    }
    text_table_free(&table);
}

static void print_sentences(const identification *i)
{
    for (size_t k = 0; k < i->verdict_count; k++)
        if (i->verdict[k].level != VERDICT_WARNING)
            printf("%s\n", i->verdict[k].text);
}

void several_print(const several_logs *s)
{
    const identify_options *o = s->options;
    for (channel_kind kind = CHANNEL_GYRO; o->runs && kind < CHANNEL_KINDS; kind++)
        print_table(identify_table(s->joint, kind));
    for (size_t c = 0; c < s->joint->found->record.count; c++)
        print_table(several_table(s, c));
    if (o->runs)
        print_table(several_bias_table(s));
    if (o->runs && o->truth) {
        size_t covered, stated;
        print_table(identify_truth_table(s->joint, &covered, &stated));
        printf("%zu of %zu intervals cover the truth; %g %% are expected to.\n\n", covered, stated,
               100 * o->confidence);
    }
    for (size_t r = 0; r < s->count; r++)
        print_sentences(s->log[r]);
    print_sentences(s->joint);
    if (o->report)
        printf("Report: %s\n", o->report);
    if (o->output)
        printf("Model: %s\nNext: imukit grade %s, or imukit convert %s imu.yaml --to kalibr for a "
               "filter\n",
               o->output, o->output, o->output);
}

static void put_sentences(imk_page *page, const identification *i)
{
    for (size_t k = 0; k < i->verdict_count; k++)
        imk_page_verdict(page, i->verdict[k].level, i->verdict[k].text);
}

static void put_table(imk_page *page, text_table table)
{
    page_put_table(page, &table);
    text_table_free(&table);
}

static void put_joint(imk_page *page, const several_logs *s)
{
    imk_page_heading(page, "Joint estimate");
    for (channel_kind kind = CHANNEL_GYRO; kind < CHANNEL_KINDS; kind++)
        put_table(page, identify_table(s->joint, kind));
    imk_page_text(page, "One set of terms for all logs, by maximum likelihood on their spectra "
                        "together. Each log has its own mean, ramp and lines.");
    identify_figure *figure = command_memory(NULL, sizeof *figure);
    identify_figure_make(s->joint, true, figure);
    imk_page_figure(page, &figure->figure,
                    "Points: the Allan deviations of all logs, pooled, with confidence intervals. "
                    "Line: the joint model. Below: how improbable the difference of each point "
                    "from it is, as standard deviations of a normal distribution.");
    identify_figure_free(figure);
    free(figure);
}

int several_report(const several_logs *s, const char *path)
{
    char subtitle[300], length[60];
    format_duration(s->joint->found->duration, length, sizeof length);
    snprintf(subtitle, sizeof subtitle, "%.150s: %zu logs of %zu channels, %s together", s->path,
             s->count, s->joint->found->record.count, length);
    imk_page *page =
        imk_page_create(s->options->runs ? "Noise of an inertial sensor over several runs"
                                         : "Noise of several inertial sensors",
                        subtitle);
    imk_page_heading(page, "Verdict");
    put_sentences(page, s->joint);
    if (s->options->runs)
        put_joint(page, s);
    imk_page_heading(page, s->options->runs ? "Run by run" : "Sensor by sensor");
    for (size_t c = 0; c < s->joint->found->record.count; c++)
        put_table(page, several_table(s, c));
    if (s->options->runs) {
        put_table(page, several_bias_table(s));
        imk_page_text(page, "Noise within a run: how far the means of two runs without a break "
                            "between them would differ, by the joint model. What the means differ "
                            "by beyond it comes from run to run.");
    }
    imk_page_heading(page, "The logs");
    for (size_t r = 0; r < s->count; r++)
        put_sentences(page, s->log[r]);
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}

static json_t *joint_channel_json(const several_logs *s, size_t channel)
{
    static const char *const of_samples[] = {
        "valid_from",  "five_terms_from", "valid_to",   "missing",
        "largest_gap", "screening",       "resolution", "allan_minimum_over_0.664"};
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    const imk_unit plain = channel_plain_unit(column);
    const imk_joint_agreement *a = &s->agreement[channel];
    const imk_repeatability *b = &s->bias[channel];
    json_t *root = identify_channel_json(s->joint, channel);
    json_object_del(json_object_get(root, "terms"), identify_term(column, IMK_NOISE_RAMP).key);
    for (size_t k = 0; k < sizeof of_samples / sizeof of_samples[0]; k++)
        json_object_del(root, of_samples[k]);
    json_t *most = json_null();
    if (a->record >= 0 && a->term >= 0)
        most = json_pack("{s:o, s:s, s:f}", "log", json_text(s->label[a->record]), "term",
                         identify_term(column, (imk_noise_term)a->term).key, "sigmas", a->sigmas);
    json_object_set_new(root, "agreement",
                        json_pack("{s:o, s:I, s:o, s:o}", "chi_square", json_number(a->chi_square),
                                  "degrees", (json_int_t)a->degrees, "probability",
                                  json_number(a->probability), "largest_difference", most));
    json_object_set_new(root, "run_to_run",
                        json_pack("{s:o, s:o, s:o, s:o, s:o}", "value",
                                  json_quantity(b->value / plain.scale, plain.text), "lower",
                                  json_quantity(b->lower / plain.scale, plain.text), "upper",
                                  json_quantity(b->upper / plain.scale, plain.text), "within",
                                  json_quantity(b->within / plain.scale, plain.text), "probability",
                                  json_number(b->probability)));
    return root;
}

static json_t *device_term_json(const device_term *t, const char *unit, double scale)
{
    if (!t->compared)
        return json_null();
    return json_pack(
        "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s}", "mean", json_number(t->mean / scale),
        "mean_lower", json_number(t->lower / scale), "mean_upper", json_number(t->upper / scale),
        "spread", json_number(t->spread / scale), "spread_lower",
        json_number(t->spread_lower / scale), "spread_upper", json_number(t->spread_upper / scale),
        "chi_square", json_number(t->squares.chi_square), "probability",
        json_number(t->squares.probability), "unit", unit);
}

static json_t *population_json(const several_logs *s, size_t channel)
{
    const imk_log_column *column = log_channel_column(&s->joint->found->record, channel);
    const double scale =
        channel_kind_of(column) == CHANNEL_OTHER ? channel_plain_unit(column).scale : 1;
    json_t *terms = json_object();
    for (int term = 0; term < IMK_NOISE_RAMP; term++) {
        const term_display display = identify_term(column, (imk_noise_term)term);
        json_object_set_new(terms, display.key,
                            device_term_json(&s->term[channel][term], display.si, scale));
    }
    return json_pack("{s:o, s:o}", "name", json_text(column->name), "population", terms);
}

static json_t *log_json(const identification *i)
{
    json_t *channels = json_array();
    for (size_t c = 0; c < i->found->record.count; c++)
        json_array_append_new(channels, identify_channel_json(i, c));
    return json_pack("{s:o, s:I, s:o, s:o, s:o}", "log", json_text(i->path), "rows",
                     (json_int_t)i->found->record.rows, "interval",
                     json_quantity(i->found->record.dt, "s"), "channels", channels, "verdict",
                     identify_verdict_json(i));
}

int several_json(const several_logs *s, int code)
{
    json_t *channels = json_array(), *logs = json_array(), *paths = json_array();
    for (size_t c = 0; c < s->joint->found->record.count; c++)
        json_array_append_new(channels,
                              s->options->runs ? joint_channel_json(s, c) : population_json(s, c));
    for (size_t r = 0; r < s->count; r++) {
        json_array_append_new(logs, log_json(s->log[r]));
        json_array_append_new(paths, json_text(s->log[r]->path));
    }
    json_t *inputs =
        json_pack("{s:o, s:s, s:f}", "logs", paths, "together",
                  s->options->runs ? "runs" : "devices", "confidence", s->options->confidence);
    return json_print("identify", inputs,
                      json_pack("{s:o, s:o, s:o}", "channels", channels, "logs", logs, "verdict",
                                identify_verdict_json(s->joint)),
                      code);
}
