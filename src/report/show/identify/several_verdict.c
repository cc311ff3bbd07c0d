/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict on several records together: do runs agree, do devices differ? */
#include "identify_show_internal.h"

#include <math.h>
#include <stdio.h>

static const imk_log_column *column_of(const imk_identify_several *s, size_t channel)
{
    return imk_even_record_column(&s->joint.record, channel);
}

imk_term_display imki_several_term(const imk_identify_several *s, size_t channel,
                                   imk_noise_term term)
{
    const imk_log_column *column = column_of(s, channel);
    const double dt = s->joint.record.dt;
    bool white = false, counted = false, alike = true;
    if (s->runs)
        return imk_identified_term(column, &s->joint.result[channel], term);
    for (size_t r = 0; r < s->count && term == IMK_NOISE_QUANTIZATION; r++) {
        const imk_identification *one = &s->log[r]->result[channel];
        if (one->term[term].present && imk_identification_counted(one))
            counted = true;
        else if (one->term[term].present)
            white = true;
        alike = alike && fabs(s->log[r]->record.dt / dt - 1) < 1e-3;
    }
    return !white || counted ? imk_channel_term(column, term)
           : alike           ? imk_channel_angle_white(column, dt)
                             : imk_channel_reading_noise(column);
}

/* ---- runs ------------------------------------------------------------------------------------ */

static void tell_run(imk_verdict *v, const imk_identify_several *s, size_t channel,
                     const char *const *labels)
{
    const imk_joint_agreement *a = &s->agreement[channel];
    const imk_log_column *column = column_of(s, channel);
    const imki_words chance = imki_chance(a->probability);
    if (a->record < 0 || a->term < 0) {
        imki_verdict_add(v, IMK_FINDING_WARNING, "runs_differ",
                         "%s: the logs do not have the same noise (chance %s): identify them "
                         "separately, or find what differed.",
                         column->name, chance.text);
        return;
    }
    const imk_term_display display = imki_several_term(s, channel, (imk_noise_term)a->term);
    const double scale = display.unit.scale;
    imki_verdict_add(
        v, IMK_FINDING_WARNING, "runs_differ",
        "%s: the logs do not have the same noise (chance %s); the largest difference is in %s: "
        "%.4g ± %.2g %s in %s, %.4g for all logs together (%.1f sigmas). Identify them separately, "
        "or find what differed: temperature, mounting, settings, vibration.",
        column->name, chance.text, display.name, a->value[a->record][a->term] / scale,
        a->sigma[a->record][a->term] / scale, display.unit.text, labels[a->record],
        s->joint.result[channel].term[a->term].value / scale, a->sigmas);
}

/* Warn if all logs together do not show any of the slow terms. */
static void assess_length(imk_verdict *v, const imk_identify_several *s)
{
    imki_text list = {.bytes = NULL};
    for (size_t c = 0; c < s->joint.record.count; c++) {
        const imk_identification *r = &s->joint.result[c];
        if (!r->term[IMK_NOISE_BIAS_INSTABILITY].present &&
            !r->term[IMK_NOISE_RANDOM_WALK].present && r->gauss_markov_count == 0)
            imki_text_add(&list, "%s%s", list.size > 0 ? ", " : "", column_of(s, c)->name);
    }
    imki_verdict_list(v, IMK_FINDING_WARNING, "short", "", &list,
                      ": all logs together are too short for the slowest terms: they are bounded, "
                      "not measured; make each log longer.");
}

static void assess_runs(imk_verdict *v, const imk_identify_several *s, const char *const *labels)
{
    bool differ = false;
    for (size_t c = 0; c < s->joint.record.count; c++)
        if (s->differs[c]) {
            tell_run(v, s, c, labels);
            differ = true;
        }
    assess_length(v, s);
    if (!differ)
        imki_verdict_add(v, IMK_FINDING_GOOD, "runs_agree",
                         "The %zu logs agree: one model explains them, %s in total.", s->count,
                         imki_duration(s->joint.duration).text);
    for (size_t c = 0; c < s->joint.record.count; c++) {
        const imk_repeatability *b = &s->bias[c];
        const imk_unit unit = imk_channel_readable_unit(column_of(s, c), b->value);
        if (b->lower > 0)
            imki_verdict_add(v, IMK_FINDING_NOTE, "bias_differs",
                             "%s: the mean differs from run to run by %.3g %s (1 sigma, %g %%: "
                             "%.3g to %.3g), more than the noise within a run explains. This is "
                             "the bias repeatability if the sensor was not moved between the runs.",
                             column_of(s, c)->name, b->value / unit.scale, unit.text,
                             100 * s->joint.settings.confidence, b->lower / unit.scale,
                             b->upper / unit.scale);
    }
}

/* ---- rates ----------------------------------------------------------------------------------- */

/* The channels of which a kind is told. */
static void tell_kind(imk_verdict *v, const imk_identify_several *s, imk_reading_kind kind)
{
    static const char *const codes[] = {"readings_untold", "readings_alike", "readings_white",
                                        "readings_both"};
    static const char *const texts[] = {
        (": the logs cannot tell reading noise, the same at each rate, from white noise of the "
         "integral: rates farther apart, or longer logs at the highest and the lowest, tell."),
        ": reading noise, the same at each rate.",
        ": white noise of the integral, whose readings scatter less at a lower rate.",
        ": both reading noise, the same at each rate, and white noise of the integral."};
    imki_text list = {.bytes = NULL};
    for (size_t c = 0; c < s->joint.record.count; c++) {
        const imk_reading_parts *parts = &s->readings[c];
        if (parts->count > 0 && parts->kind == kind && !s->differs[c])
            imki_text_add(&list, "%s%s", list.size > 0 ? ", " : "", column_of(s, c)->name);
    }
    imki_verdict_list(v, IMK_FINDING_NOTE, codes[kind], "", &list, texts[kind]);
}

static void assess_rates(imk_verdict *v, const imk_identify_several *s)
{
    for (size_t c = 0; c < s->joint.record.count; c++)
        if (s->differs[c])
            imki_verdict_add(v, IMK_FINDING_WARNING, "readings_differ",
                             "%s: neither reading noise nor white noise of the integral nor both "
                             "explain the readings at these rates (chance %s): a filter that "
                             "changes with the rate, or different settings; identify the logs "
                             "separately.",
                             column_of(s, c)->name, imki_chance(s->readings[c].probability).text);
    for (int kind = IMK_READING_UNTOLD; kind <= IMK_READING_BOTH; kind++)
        tell_kind(v, s, (imk_reading_kind)kind);
}

/* ---- devices --------------------------------------------------------------------------------- */

static imki_words strength_words(const imk_device_strength *s, double scale)
{
    imki_words words;
    if (s->present)
        return imki_plus_minus(s->value, s->sigma, scale);
    snprintf(words.text, sizeof words.text, "less than %.60s",
             imki_value(s->bound / scale, 0, 2).text);
    return words;
}

static void tell_difference(imk_verdict *v, const imk_identify_several *s, size_t channel, int term,
                            const char *const *labels)
{
    const imk_device_term *t = &s->term[channel][term];
    const imk_term_display display = imki_several_term(s, channel, (imk_noise_term)term);
    imki_verdict_add(v, IMK_FINDING_NOTE, "devices_differ",
                     "%s: %s differs: %s %s in %s, %s in %s (%.1f sigmas; chance if all were alike "
                     "%s).",
                     column_of(s, channel)->name, display.name,
                     strength_words(&t->device[t->high], display.unit.scale).text,
                     display.unit.text, labels[t->high],
                     strength_words(&t->device[t->low], display.unit.scale).text, labels[t->low],
                     t->sigmas, imki_chance(t->squares.probability).text);
}

/* Further terms in the model of a channel, which change the meaning of its other terms. */
static void assess_models(imk_verdict *v, const imk_identify_several *s, size_t channel,
                          const char *const *labels)
{
    static const char *const what[] = {"Gauss-Markov noise", "an output filter"};
    for (int filter = 0; filter < 2; filter++) {
        size_t have = 0, one = 0;
        for (size_t r = 0; r < s->count; r++) {
            const imk_identification *model = &s->log[r]->result[channel];
            if (filter ? model->filter.bandwidth > 0 : model->gauss_markov_count > 0) {
                have++;
                one = r;
            }
        }
        if (have > 0 && have < s->count)
            imki_verdict_add(v, IMK_FINDING_NOTE, "models_differ",
                             "%s: %zu of %zu logs show %s (%s%s); this changes the other terms, so "
                             "compare them with care.",
                             column_of(s, channel)->name, have, s->count, what[filter], labels[one],
                             have > 1 ? " and others" : "");
    }
}

static void assess_devices(imk_verdict *v, const imk_identify_several *s, const char *const *labels)
{
    const double percent = 100 * s->joint.settings.confidence;
    for (size_t c = 0; c < s->joint.record.count; c++)
        for (int term = 0; term < IMK_NOISE_RAMP; term++)
            if (s->term[c][term].differs)
                tell_difference(v, s, c, term, labels);
    for (size_t c = 0; c < s->joint.record.count; c++)
        assess_models(v, s, c, labels);
    if (s->differing_count == 0)
        imki_verdict_add(v, IMK_FINDING_GOOD, "devices_agree",
                         "The %zu sensors agree within their joint intervals in all %zu parameters "
                         "compared (%g %% over all of them).",
                         s->count, s->compared_count, percent);
    else
        imki_verdict_add(v, IMK_FINDING_GOOD, "devices_spread",
                         "The %zu sensors differ in %zu of %zu parameters compared by more than "
                         "their joint intervals (%g %% over all of them).",
                         s->count, s->differing_count, s->compared_count, percent);
    if (s->count == 2)
        imki_verdict_add(v, IMK_FINDING_NOTE, "two_devices",
                         "Two sensors show whether they differ, but almost nothing about the "
                         "spread of their type.");
}

imk_verdict imk_several_verdict(const imk_identify_several *s, const char *const *labels,
                                imk_result *result)
{
    imk_verdict v = {.result = result};
    if (s->rates)
        assess_rates(&v, s);
    else if (s->runs)
        assess_runs(&v, s, labels);
    else
        assess_devices(&v, s, labels);
    if (s->count > 0)
        imki_assess_untestable(&v, &s->log[0]->record);
    return v;
}
