/* SPDX-License-Identifier: Apache-2.0 */
/* The display of several records: run by run with the joint estimate, or sensor by sensor. */
#include "identify_show_internal.h"

#include <math.h>
#include <stdio.h>

/* A spread smaller than this part of the mean counts as none. */
static const double no_spread = 1e-6;

static const imk_log_column *column_of(const imk_identify_several *s, size_t channel)
{
    return imk_even_record_column(&s->joint.record, channel);
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* The random terms that some record shows. */
typedef struct shown_terms {
    size_t count;
    int term[IMK_NOISE_RAMP];
    double scale[IMK_NOISE_RAMP]; /* of the unit a person reads */
} shown_terms;

static void value_cell(imk_table *table, bool present, double value, double sigma, double bound,
                       double scale)
{
    if (present)
        imk_table_add(table, "%s", imki_plus_minus(value, sigma, scale).text);
    else if (bound > 0)
        imk_table_add(table, "< %s", imki_value(bound / scale, 0, 2).text);
    else
        imk_table_add(table, "absent");
}

static imki_words open_range(double lower, double upper, double scale)
{
    imki_words words;
    if (isfinite(upper))
        return imki_range(lower, upper, scale);
    snprintf(words.text, sizeof words.text, "from %.3g", lower / scale);
    return words;
}

static void run_rows(imk_table *table, const imk_identify_several *s, size_t channel,
                     const imk_identify_shown *records, const shown_terms *shown)
{
    const imk_joint_agreement *a = &s->agreement[channel];
    for (size_t r = 0; r < s->count; r++) {
        imk_table_row(table, "%.60s", records[r].label);
        for (size_t k = 0; k < shown->count; k++) {
            const int term = shown->term[k];
            value_cell(table, a->sigma[r][term] > 0, a->value[r][term], a->sigma[r][term], 0,
                       shown->scale[k]);
        }
    }
    imk_table_row(table, "together");
    for (size_t k = 0; k < shown->count; k++) {
        const imk_estimate *e = &s->joint.result[channel].term[shown->term[k]];
        value_cell(table, e->present, e->value, e->sigma, e->upper, shown->scale[k]);
    }
    imk_table_row(table, "chance if alike\t%s", imki_chance(a->probability).text);
}

/* Mean and spread with their intervals; not for two sensors, which show almost nothing about the
 * spread of their type. */
static void population_rows(imk_table *table, const imk_device_term *const *terms,
                            const shown_terms *shown, double confidence)
{
    imk_table_row(table, "mean");
    for (size_t k = 0; k < shown->count; k++) {
        const double scale = shown->scale[k];
        const imk_device_term *t = terms[k];
        imk_table_add(table, "%s",
                      imki_value(t->mean / scale, (t->upper - t->lower) / scale / 4, 4).text);
    }
    imk_table_row(table, "  %g %%", 100 * confidence);
    for (size_t k = 0; k < shown->count; k++)
        imk_table_add(table, "%s",
                      open_range(terms[k]->lower, terms[k]->upper, shown->scale[k]).text);
    imk_table_row(table, "spread");
    for (size_t k = 0; k < shown->count; k++)
        if (terms[k]->spread > no_spread * terms[k]->mean)
            imk_table_add(table, "%.3g", terms[k]->spread / shown->scale[k]);
        else
            imk_table_add(table, "none seen");
    imk_table_row(table, "  %g %%", 100 * confidence);
    for (size_t k = 0; k < shown->count; k++) {
        const double lower = terms[k]->spread_lower, upper = terms[k]->spread_upper;
        if (lower > no_spread * terms[k]->mean)
            imk_table_add(table, "%s", open_range(lower, upper, shown->scale[k]).text);
        else
            imk_table_add(table, "< %s", imki_value(upper / shown->scale[k], 0, 2).text);
    }
}

static void device_rows(imk_table *table, const imk_identify_several *s, size_t channel,
                        const imk_identify_shown *records, const shown_terms *shown)
{
    const imk_device_term *terms[IMK_NOISE_RAMP];
    for (size_t k = 0; k < shown->count; k++)
        terms[k] = &s->term[channel][shown->term[k]];
    for (size_t r = 0; r < s->count; r++) {
        imk_table_row(table, "%.60s", records[r].label);
        for (size_t k = 0; k < shown->count; k++) {
            const imk_device_strength *d = &terms[k]->device[r];
            value_cell(table, d->present, d->value, d->sigma, d->bound, shown->scale[k]);
        }
    }
    if (s->count > 2)
        population_rows(table, terms, shown, s->joint.settings.confidence);
    imk_table_row(table, "chance if alike");
    for (size_t k = 0; k < shown->count; k++)
        imk_table_add(table, "%s", imki_chance(terms[k]->squares.probability).text);
}

/* The strengths of each record on a channel, and those of all records together. */
static void channel_table(const imk_identify_several *s, size_t channel,
                          const imk_identify_shown *records, imk_result *result)
{
    shown_terms shown = {0};
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "%s", column_of(s, channel)->name);
    for (int term = 0; term < IMK_NOISE_RAMP; term++) {
        const imk_term_display display = imki_several_term(s, channel, (imk_noise_term)term);
        if (s->runs ? !s->joint.result[channel].term[term].present && term != IMK_NOISE_WHITE
                    : !s->term[channel][term].compared)
            continue;
        shown.term[shown.count] = term;
        shown.scale[shown.count++] = display.unit.scale;
        imk_table_add(table, "%s [%s]", display.name, display.unit.text);
    }
    if (s->runs)
        run_rows(table, s, channel, records, &shown);
    else
        device_rows(table, s, channel, records, &shown);
    imk_result_gap(result);
}

/* 1 sigma of a reading at each rate, and what explains it. */
static void rates_table(const imk_identify_several *s, size_t channel,
                        const imk_identify_shown *records, imk_result *result)
{
    const imk_term_display display = imk_channel_reading_noise(column_of(s, channel));
    const imk_reading_parts *parts = &s->readings[channel];
    if (parts->count == 0)
        return;
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "%s\tat\t1 sigma of a reading [%s]", column_of(s, channel)->name,
                  display.unit.text);
    for (size_t r = 0; r < s->count; r++) {
        const imk_estimate *e = &s->log[r]->result[channel].term[IMK_NOISE_QUANTIZATION];
        imk_table_row(table, "%.60s\t%.6g Hz", records[r].label, 1 / s->log[r]->record.dt);
        value_cell(table, e->present, e->value, e->sigma, e->upper, display.unit.scale);
    }
    if (parts->degrees > 0)
        imk_table_row(table, "chance if so\t\t%s", imki_chance(parts->probability).text);
    imk_result_gap(result);
}

/* Means from run to run. */
static void bias_table(const imk_identify_several *s, imk_result *result)
{
    imk_table *table = imk_result_table(result, 0);
    imk_table_row(table, "mean from run to run\tunit\tmean\t1 sigma\t%g %%\tnoise within a run",
                  100 * s->joint.settings.confidence);
    for (size_t c = 0; c < s->joint.record.count; c++) {
        const imk_repeatability *b = &s->bias[c];
        const imk_unit unit = imk_channel_readable_unit(column_of(s, c), fmax(b->value, b->within));
        imk_table_row(table, "%s\t%s\t%.6g", column_of(s, c)->name, unit.text,
                      b->mean / unit.scale);
        if (b->value > 0)
            imk_table_add(table, "%.3g", b->value / unit.scale);
        else
            imk_table_add(table, "none seen");
        if (b->lower > 0)
            imk_table_add(table, "%s", open_range(b->lower, b->upper, unit.scale).text);
        else
            imk_table_add(table, "< %.2g", b->upper / unit.scale);
        imk_table_add(table, "%.3g", b->within / unit.scale);
    }
    imk_result_gap(result);
}

/* ---- data ------------------------------------------------------------------------------------ */

static void run_data(const imk_identify_several *s, size_t channel,
                     const imk_identify_shown *records, imk_result *result)
{
    const imk_unit unit = imk_channel_plain_unit(column_of(s, channel));
    const imk_joint_agreement *a = &s->agreement[channel];
    const imk_repeatability *b = &s->bias[channel];
    imki_channel_data(&s->joint, channel, result);
    imk_result_object(result, "agreement");
    imk_result_number(result, "chi_square", a->chi_square);
    imk_result_count(result, "degrees_of_freedom", (long long)a->degrees);
    imk_result_number(result, "probability", a->probability);
    if (imki_begin_object(result, "largest_difference", a->record >= 0 && a->term >= 0)) {
        imk_result_text(result, "log", records[a->record].label);
        imk_result_text(result, "term", imki_several_term(s, channel, (imk_noise_term)a->term).key);
        imk_result_number(result, "sigmas", a->sigmas);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_object(result, "run_to_run");
    imk_result_quantity(result, "value", b->value / unit.scale, unit.text);
    imk_result_quantity(result, "lower", b->lower / unit.scale, unit.text);
    imk_result_quantity(result, "upper", b->upper / unit.scale, unit.text);
    imk_result_quantity(result, "within", b->within / unit.scale, unit.text);
    imk_result_number(result, "probability", b->probability);
    imk_result_end(result);
    imk_result_end(result);
}

static void rates_data(const imk_identify_several *s, size_t channel, imk_result *result)
{
    static const char *const kinds[] = {"cannot be told", "reading noise",
                                        "white noise of the integral", "both"};
    const imk_reading_parts *parts = &s->readings[channel];
    imki_channel_data(&s->joint, channel, result);
    if (imki_begin_object(result, "readings", parts->count > 0)) {
        imk_result_text(result, "kind", kinds[parts->kind]);
        imk_result_number(result, "chi_square", parts->chi_square);
        imk_result_count(result, "degrees_of_freedom", (long long)parts->degrees);
        imk_result_number(result, "probability", parts->probability);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void population_data(const imk_identify_several *s, size_t channel, imk_result *result)
{
    const imk_log_column *column = column_of(s, channel);
    imk_result_object(result, NULL);
    imk_result_text(result, "name", column->name);
    imk_result_object(result, "population");
    for (int term = 0; term < IMK_NOISE_RAMP; term++) {
        const imk_term_display display = imki_several_term(s, channel, (imk_noise_term)term);
        const double scale = display.si_scale;
        const imk_device_term *t = &s->term[channel][term];
        const char *key = imk_result_key(result, "%s", display.key);
        if (!imki_begin_object(result, key, t->compared))
            continue;
        imk_result_number(result, "mean", t->mean / scale);
        imk_result_number(result, "mean_lower", t->lower / scale);
        imk_result_number(result, "mean_upper", t->upper / scale);
        imk_result_number(result, "spread", t->spread / scale);
        imk_result_number(result, "spread_lower", t->spread_lower / scale);
        imk_result_number(result, "spread_upper", t->spread_upper / scale);
        imk_result_number(result, "chi_square", t->squares.chi_square);
        imk_result_number(result, "probability", t->squares.probability);
        imk_result_text(result, "unit", display.si);
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_end(result);
}

static void record_data(const imk_identify_shown *record, imk_result *result)
{
    imk_result_object(result, NULL);
    imk_result_text(result, "log", record->name);
    imk_result_count(result, "rows", (long long)record->log->record.rows);
    imk_result_quantity(result, "interval", record->log->record.dt, "s");
    imki_channels_data(record->log, result);
    imk_result_usability(result, imk_verdict_usability(&record->verdict),
                         imk_identify_sentence(&record->verdict));
    imki_verdict_data(&record->verdict, result);
    imk_result_end(result);
}

static void show_data(const imk_identify_several *s, const imk_identify_shown *joint,
                      const imk_identify_shown *records, imk_result *result)
{
    imk_result_object(result, "inputs");
    imk_result_array(result, "logs");
    for (size_t r = 0; r < s->count; r++)
        imk_result_text(result, NULL, records[r].name);
    imk_result_end(result);
    imk_result_text(result, "together", s->runs ? "runs" : "devices");
    if (s->rates)
        imk_result_text(result, "longest", records[s->longest].name);
    imk_result_number(result, "confidence", s->joint.settings.confidence);
    imk_result_end(result);
    imk_result_object(result, "result");
    imk_result_array(result, "channels");
    for (size_t c = 0; c < s->joint.record.count; c++)
        if (s->rates)
            rates_data(s, c, result);
        else if (s->runs)
            run_data(s, c, records, result);
        else
            population_data(s, c, result);
    imk_result_end(result);
    imk_result_array(result, "logs");
    for (size_t r = 0; r < s->count; r++)
        record_data(&records[r], result);
    imk_result_end(result);
    imk_result_judge(result, imk_verdict_usability(&joint->verdict), "%s",
                     imk_identify_sentence(&joint->verdict));
    imki_verdict_data(&joint->verdict, result);
    imk_result_end(result);
}

/* ---- display --------------------------------------------------------------------------------- */

static void show_joint(const imk_identify_several *s, const imk_identify_shown *joint,
                       const imk_identify_shown *records, imk_result *result)
{
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, s->rates ? "Estimate" : "Joint estimate");
    imki_identify_figure(joint, s->rates ? "the longest log" : "all logs, pooled", result);
    imk_result_for(result, IMK_FOR_BOTH);
    imki_identify_tables(joint->log, result);
    if (s->rates) {
        imk_result_line(result,
                        "Reading noise and white noise of the integral are those of all "
                        "logs where they tell them apart. All else is that of %.60s, the "
                        "longest.",
                        records[s->longest].label);
        imk_result_gap(result);
        return;
    }
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_line(result, "One set of terms for all logs, by maximum likelihood on their spectra "
                            "together. Each log has its own mean, ramp and lines.");
}

static void show_bias(const imk_identify_several *s, const imk_identify_shown *joint,
                      imk_result *result)
{
    if (!s->rates) {
        bias_table(s, result);
        imk_result_for(result, IMK_FOR_PAGE);
        imk_result_line(result,
                        "Noise within a run: the difference that the joint model predicts between "
                        "the means of two runs without a break. Any further difference is a change "
                        "from run to run.");
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    if (joint->truth)
        imki_truth_table(joint, result);
}

void imk_show_identify_several(const imk_identify_several *s, const imk_identify_shown *joint,
                               const imk_identify_shown *records, imk_result *result)
{
    double duration = 0;
    for (size_t r = 0; r < s->count; r++)
        duration += s->log[r]->duration;
    show_data(s, joint, records, result);
    imk_result_title(result,
                     s->rates  ? "Noise of an inertial sensor at several rates"
                     : s->runs ? "Noise of an inertial sensor over several runs"
                               : "Noise of several inertial sensors",
                     "%.150s: %zu logs of %zu channels, %s together", joint->name, s->count,
                     s->joint.record.count, imki_duration(duration).text);
    imk_result_for(result, IMK_FOR_PAGE);
    imki_verdict_brief_boxes(&joint->verdict, result);
    imk_result_for(result, IMK_FOR_TERMINAL);
    for (size_t r = 0; r < s->count; r++)
        if (imk_verdict_usability(&records[r].verdict) != IMK_USABLE)
            imk_result_line(result, "%s: %s", records[r].label,
                            imk_identify_sentence(&records[r].verdict));
    if (s->runs)
        show_joint(s, joint, records, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, s->rates  ? "Rate by rate"
                               : s->runs ? "Run by run"
                                         : "Sensor by sensor");
    imk_result_for(result, IMK_FOR_BOTH);
    if (!s->runs)
        imki_devices_figure(s, records, joint->name, result);
    for (size_t c = 0; c < s->joint.record.count; c++)
        if (s->rates)
            rates_table(s, c, records, result);
        else
            channel_table(s, c, records, result);
    if (s->runs)
        show_bias(s, joint, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, "What was found in the logs");
    imki_verdict_boxes(&joint->verdict, result);
    for (size_t r = 0; r < s->count; r++) {
        imk_result_line(result, "%s: %s", records[r].label,
                        imk_identify_sentence(&records[r].verdict));
        imki_verdict_boxes(&records[r].verdict, result);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    for (size_t r = 0; r < s->count; r++)
        imki_verdict_lines(&records[r].verdict, joint->verbose, result);
    imki_verdict_lines(&joint->verdict, joint->verbose, result);
    imk_result_for(result, IMK_FOR_BOTH);
}
