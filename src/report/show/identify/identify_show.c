/* SPDX-License-Identifier: Apache-2.0 */
/* The display of one identified record: its data, and the order of its parts. */
#include "identify_show_internal.h"

#include <stdio.h>

/* ---- data ------------------------------------------------------------------------------------ */

static void estimate_data(imk_result *result, const char *key, const imk_estimate *e, double scale,
                          const char *unit)
{
    imk_result_object(result, key);
    imk_result_flag(result, "present", e->present);
    imk_result_number(result, "value", e->value / scale);
    imk_result_number(result, "sigma", e->sigma / scale);
    imk_result_number(result, "lower", e->lower / scale);
    imk_result_number(result, "upper", e->upper / scale);
    imk_result_number(result, "free_value", e->free_value / scale);
    imk_result_text(result, "unit", unit);
    imk_result_end(result);
}

static void terms_data(const imk_identify_log *log, size_t channel, imk_result *result)
{
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_identification *r = &log->result[channel];
    const int terms = log->origin == IMK_IDENTIFY_RECORDS ? IMK_NOISE_RAMP : IMK_NOISE_TERMS;
    const imk_reading_parts *parts = log->readings ? &log->readings[channel] : NULL;
    const bool parted = parts && parts->kind != IMK_READING_UNTOLD;
    imk_result_object(result, "terms");
    if (parted) {
        const imk_term_display reading = imk_channel_reading_noise(column);
        const imk_term_display white = imk_channel_angle_white(column, 1);
        estimate_data(result, imk_result_key(result, "%s", reading.key), &parts->reading_noise,
                      reading.si_scale, reading.si);
        estimate_data(result, imk_result_key(result, "%s", white.key), &parts->angle_white,
                      white.si_scale, white.si);
    }
    for (int term = parted ? IMK_NOISE_WHITE : 0; term < terms; term++) {
        const imk_term_display display = imk_identified_term(column, r, (imk_noise_term)term);
        estimate_data(result, imk_result_key(result, "%s", display.key), &r->term[term],
                      display.si_scale, display.si);
    }
    imk_result_end(result);
}

static void extras_data(const imk_identification *r, imk_unit unit, imk_result *result)
{
    imk_result_object(result, "extras");
    imk_result_array(result, "gauss_markov");
    for (int k = 0; k < r->gauss_markov_count; k++) {
        imk_result_object(result, NULL);
        estimate_data(result, "sigma", &r->gauss_markov[k].sigma, unit.scale, unit.text);
        estimate_data(result, "correlation_time", &r->gauss_markov[k].correlation_time, 1, "s");
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_array(result, "sinusoid");
    for (int k = 0; k < r->sinusoid_count; k++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "amplitude", r->sinusoid[k].amplitude / unit.scale, unit.text);
        imk_result_quantity(result, "frequency", r->sinusoid[k].frequency, "Hz");
        imk_result_end(result);
    }
    imk_result_end(result);
    imk_result_array(result, "resonance");
    for (int k = 0; k < r->resonance_count; k++) {
        imk_result_object(result, NULL);
        imk_result_quantity(result, "sigma", r->resonance[k].sigma / unit.scale, unit.text);
        imk_result_quantity(result, "frequency", r->resonance[k].frequency, "Hz");
        imk_result_quantity(result, "q", r->resonance[k].q, "1");
        imk_result_end(result);
    }
    imk_result_end(result);
    if (imki_begin_object(result, "filter", r->filter.bandwidth > 0)) {
        imk_result_quantity(result, "bandwidth", r->filter.bandwidth, "Hz");
        imk_result_quantity(result, "damping", r->filter.damping, "1");
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void count_data(imk_result *result, const char *key, const imk_screen_count *count)
{
    imk_result_object(result, key);
    imk_result_count(result, "samples", (long long)count->count);
    imk_result_count(result, "runs", (long long)count->runs);
    imk_result_count(result, "first", (long long)count->first);
    imk_result_end(result);
}

static void warm_up_data(const imk_screen *s, imk_unit unit, imk_result *result)
{
    if (!imki_begin_object(result, "warm_up", s->warm_up))
        return;
    imk_result_quantity(result, "amplitude", s->warm_up_amplitude / unit.scale, unit.text);
    imk_result_quantity(result, "amplitude_sigma", s->warm_up_amplitude_sigma / unit.scale,
                        unit.text);
    imk_result_quantity(result, "time", s->warm_up_time, "s");
    imk_result_quantity(result, "time_sigma", s->warm_up_time_sigma, "s");
    imk_result_end(result);
}

static void temperature_data(const imk_screen *s, imk_unit unit, imk_result *result)
{
    char per_kelvin[64];
    if (!imki_begin_object(result, "temperature", s->temperature_degree > 0))
        return;
    snprintf(per_kelvin, sizeof per_kelvin, "%.40s/K", unit.text);
    imk_result_count(result, "degree", s->temperature_degree);
    imk_result_quantity(result, "slope", s->temperature_slope / unit.scale, per_kelvin);
    imk_result_quantity(result, "slope_sigma", s->temperature_slope_sigma / unit.scale, per_kelvin);
    imk_result_end(result);
}

static void screening_data(const imk_identify_log *log, size_t channel, imk_unit unit,
                           imk_result *result)
{
    const imk_screen *s = &log->screen[channel];
    if (!imki_begin_object(result, "screening", log->screened))
        return;
    count_data(result, "missing", &s->missing);
    count_data(result, "outliers", &s->outliers);
    count_data(result, "stuck", &s->stuck);
    count_data(result, "lost", &s->lost);
    count_data(result, "saturated", &s->saturated);
    count_data(result, "steps", &s->steps);
    count_data(result, "moved", &s->moved);
    warm_up_data(s, unit, result);
    temperature_data(s, unit, result);
    imk_result_number(result, "zeros", s->zeros);
    imk_result_number(result, "filled", s->filled);
    imk_result_number(result, "repeated", s->held);
    imk_result_number(result, "straight", s->straight);
    imk_result_quantity(result, "gap", s->gap / unit.scale, unit.text);
    imk_result_end(result);
}

void imki_channel_data(const imk_identify_log *log, size_t channel, imk_result *result)
{
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_identification *r = &log->result[channel];
    const imk_unit unit = imk_channel_plain_unit(column);
    imk_result_object(result, NULL);
    imk_result_text(result, "name", column->name);
    terms_data(log, channel, result);
    extras_data(r, unit, result);
    imk_result_quantity(result, "mean", r->mean / unit.scale, unit.text);
    if (log->origin == IMK_IDENTIFY_RECORDS)
        return;
    imk_result_quantity(result, "allan_minimum_over_0.664", r->minimum_floor / unit.scale,
                        unit.text);
    imk_result_quantity(result, "resolution", r->resolution / unit.scale, unit.text);
    imk_result_quantity(result, "valid_from", r->valid_from, "s");
    imk_result_quantity(result, "five_terms_from", r->five_terms_from, "s");
    imk_result_quantity(result, "valid_to", r->valid_to, "s");
    imk_result_count(result, "missing", (long long)r->missing);
    imk_result_quantity(result, "largest_gap", r->largest_gap, "s");
    screening_data(log, channel, unit, result);
    imki_noise_changes_data(log, channel, unit, result);
}

void imki_channels_data(const imk_identify_log *log, imk_result *result)
{
    imk_result_array(result, "channels");
    for (size_t c = 0; c < log->record.count; c++) {
        imki_channel_data(log, c, result);
        imk_result_end(result);
    }
    imk_result_end(result);
}

static void show_data(const imk_identify_shown *shown, imk_result *result)
{
    const imk_identify_log *log = shown->log;
    imk_result_object(result, "inputs");
    imk_result_text(result, "log", shown->name);
    imk_result_count(result, "rows", (long long)log->record.rows);
    imk_result_count(result, "bridged", (long long)log->record.bridged);
    imk_result_quantity(result, "interval", log->record.dt, "s");
    imk_result_number(result, "confidence", log->settings.confidence);
    imk_result_end(result);
    imk_result_object(result, "result");
    imki_channels_data(log, result);
    imk_result_judge(result, imk_verdict_usability(&shown->verdict), "%s",
                     imk_identify_sentence(&shown->verdict));
    imki_verdict_data(&shown->verdict, result);
    imk_result_end(result);
}

/* ---- display --------------------------------------------------------------------------------- */

/* The picture, then the tables, then the whole messages; the terminal has no picture. */
void imk_show_identify_log(const imk_identify_shown *shown, imk_result *result)
{
    const imk_identify_log *log = shown->log;
    show_data(shown, result);
    imk_result_title(result, "Noise of an inertial sensor",
                     "%.120s: %zu samples of %zu channels, %g Hz, %s", shown->name,
                     log->record.rows, log->record.count, 1 / log->record.dt,
                     imki_duration(log->duration).text);
    imk_result_for(result, IMK_FOR_PAGE);
    imki_verdict_brief_boxes(&shown->verdict, result);
    imk_result_heading(result, "Allan deviation");
    imki_identify_figure(shown, "the log", result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, "Parameters");
    imk_result_for(result, IMK_FOR_BOTH);
    imki_identify_tables(log, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_line(
        result,
        "Each value has its 1-sigma uncertainty and the interval that contains the true value with "
        "the stated confidence, by profile likelihood. \"absent\" means that the record does not "
        "show the term; the bound says how large the term could still be. Bias instability is B of "
        "IEEE 952: the flat floor of the Allan deviation is 0.664 B; the measured minimum also "
        "contains white noise and random walk, so it is larger.");
    if (shown->truth) {
        imk_result_heading(result, "Comparison with the true values");
        imk_result_for(result, IMK_FOR_BOTH);
        imki_truth_table(shown, result);
    }
    imk_result_for(result, IMK_FOR_TERMINAL);
    imki_verdict_lines(&shown->verdict, shown->verbose, result);
    imki_noise_changes_figure(shown, result);
    imk_result_for(result, IMK_FOR_PAGE);
    imk_result_heading(result, "What was found in the log");
    imki_verdict_boxes(&shown->verdict, result);
    imk_result_for(result, IMK_FOR_BOTH);
}
