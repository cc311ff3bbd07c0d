/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict on a record in words: what it is good for, and what is wrong with it. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* Gravity on the surface of the Earth [m/s^2]: equator to pole by WGS84, rounded outwards; a value
 * more than 5 % outside is not the specific force at rest. */
static const double gravity_least = 9.78 * (1 - 0.05), gravity_most = 9.83 * (1 + 0.05);

/* ---- messages -------------------------------------------------------------------------------- */

void imki_verdict_add(imk_verdict *v, imk_finding_level level, const char *code, const char *format,
                      ...)
{
    if (!v->result)
        return;
    imki_arena *arena = &v->result->arena;
    va_list arguments;
    va_start(arguments, format);
    const char *text = imki_arena_format(arena, format, arguments);
    va_end(arguments);
    v->message = imki_arena_extend(arena, v->message, v->count, sizeof *v->message);
    if (!v->message) {
        v->count = 0;
        return;
    }
    if (v->label)
        text = imk_result_key(v->result, "%.200s: %s", v->label, text);
    v->message[v->count++] = (imk_message){.level = level, .code = code, .text = text};
    imki_verdict_about(v, NULL, 0);
}

void imki_verdict_list(imk_verdict *v, imk_finding_level level, const char *code,
                       const char *before, imki_text *list, const char *after)
{
    if (list->size > 0)
        imki_verdict_add(v, level, code, "%s%s%s", before, list->bytes, after);
    if (v->result && list->failed)
        v->result->arena.failed = true;
    free(list->bytes);
}

bool imk_verdict_warns(const imk_verdict *v)
{
    for (size_t k = 0; k < v->count; k++)
        if (v->message[k].level >= IMK_FINDING_WARNING)
            return true;
    return false;
}

void imki_verdict_data(const imk_verdict *v, imk_result *result)
{
    static const char *const levels[] = {"good", "note", "warning", "failure"};
    static const char *const grades[] = {"usable", "usable with care", "not usable"};
    imk_result_object(result, "usability");
    imk_result_text(result, "grade", grades[imk_verdict_usability(v)]);
    imk_result_text(result, "sentence", imk_identify_sentence(v));
    imk_result_end(result);
    imk_result_array(result, "verdict");
    for (size_t k = 0; k < v->count; k++) {
        imk_result_object(result, NULL);
        imk_result_text(result, "level", levels[v->message[k].level]);
        imk_result_text(result, "code", v->message[k].code);
        imk_result_text(result, "message", v->message[k].text);
        imk_result_end(result);
    }
    imk_result_end(result);
}

void imki_verdict_boxes(const imk_verdict *v, imk_result *result)
{
    imk_result_finding(result, (int)imk_verdict_level(v), imk_identify_sentence(v));
    for (size_t k = 0; k < v->count; k++)
        if (strcmp(v->message[k].code, "good") != 0)
            imk_result_finding(result, (int)v->message[k].level, v->message[k].text);
}

void imki_verdict_lines(const imk_verdict *v, bool verbose, imk_result *result)
{
    if (!verbose)
        imki_verdict_briefly(v, result);
    for (size_t k = 0; verbose && k < v->count; k++)
        if (strcmp(v->message[k].code, "good") != 0)
            imk_result_line(result, "%s", v->message[k].text);
}

/* ---- what is found on some channels ---------------------------------------------------------- */

/* Does a condition hold on a channel? The details are added to an empty text. */
typedef bool (*assessment)(const imk_identify_log *log, size_t channel, imki_text *detail);

static imk_unit unit_for(const imk_identify_log *log, size_t channel, double value)
{
    return imk_channel_readable_unit(imk_even_record_column(&log->record, channel), value);
}

static bool find_outliers(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = unit_for(log, channel, s->largest_outlier);
    imki_text_add(detail, "%zu, the largest %.3g %s or %.3g standard deviations off",
                  s->outliers.count, s->largest_outlier / unit.scale, unit.text,
                  s->noise > 0 ? s->largest_outlier / s->noise : (double)INFINITY);
    return s->outliers.count > 0 && !s->heavy_tails;
}

/* White noise with all samples, and without those far off. */
static bool find_tails(const imk_identify_log *log, size_t channel, bool matter, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_estimate *white = &log->result[channel].term[IMK_NOISE_WHITE];
    const imk_term_display term =
        imk_channel_term(imk_even_record_column(&log->record, channel), IMK_NOISE_WHITE);
    /* Tails that go on evenly are those of the noise; a cluster far off may be faults. */
    const bool matters = white->value * s->core < white->lower && s->nearly < s->outliers.count;
    imki_text_add(detail, "%zu samples; %s %.4g %s, of most samples %.4g", s->outliers.count,
                  term.name, white->value / term.unit.scale, term.unit.text,
                  white->value * s->core / term.unit.scale);
    return s->heavy_tails && s->outliers.count > 0 && matters == matter;
}

static bool find_tails_that_matter(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    return find_tails(log, channel, true, detail);
}

static bool find_small_tails(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    return find_tails(log, channel, false, detail);
}

static bool find_stuck(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%zu samples in %zu %s, the longest of %zu", s->stuck.count,
                  s->stuck.runs, s->stuck.runs == 1 ? "run" : "runs", s->longest_stuck);
    return s->stuck.count > 0;
}

/* So much is no glitch: the sensor or its driver stood still. */
static bool find_dead(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%.2g %% of the log", 100 * (double)s->stuck.count / (double)s->n);
    return (double)s->stuck.count > 0.05 * (double)s->n;
}

static bool find_saturated(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%zu samples, white noise times %.4g", s->saturated.count,
                  s->clipped_deviation);
    return s->saturated.count > 0;
}

/* Held samples have a cycle, too, and are told by the rows. */
static bool find_interpolated(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    for (size_t k = 0; k < log->findings.count; k++)
        if (strcmp(log->findings.item[k].code, "stamps:held") == 0)
            return false;
    imki_text_add(detail, "from about %.3g Hz", s->sensor_rate[0] / log->record.dt);
    if (s->sensor_rate[1] > 0)
        imki_text_add(detail, " or %.3g Hz", s->sensor_rate[1] / log->record.dt);
    return s->interpolated && s->sensor_rate[0] > 0;
}

static bool find_alternating(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    (void)detail;
    return log->screen[channel].interpolated && !(log->screen[channel].sensor_rate[0] > 0);
}

static bool find_warm_up(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = unit_for(log, channel, s->warm_up_amplitude);
    imki_text_add(
        detail, "%s %s at the start, time constant %s s",
        imki_plus_minus(s->warm_up_amplitude, s->warm_up_amplitude_sigma, unit.scale).text,
        unit.text, imki_plus_minus(s->warm_up_time, s->warm_up_time_sigma, 1).text);
    return s->warm_up;
}

static bool find_temperature(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = unit_for(log, channel, s->temperature_slope);
    imki_text_add(
        detail, "%s %s/degC%s",
        imki_plus_minus(s->temperature_slope, s->temperature_slope_sigma, unit.scale).text,
        unit.text, s->temperature_degree > 1 ? " and a curvature" : "");
    return s->temperature_degree > 0;
}

static bool find_steps(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = unit_for(log, channel, s->largest_step);
    imki_text_add(detail, "%zu, the largest %.3g %s at %.5g s", s->steps.count,
                  s->largest_step / unit.scale, unit.text, (double)s->steps.first * log->record.dt);
    return s->steps.count > 0;
}

/* A change of the level that is not significant, but which chance alone shows in one of ten
 * channels at most, beside slow terms that would hold it as noise. */
static bool find_possible_step(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double worth_telling = 14;
    const imk_screen *s = &log->screen[channel];
    const imk_identification *r = &log->result[channel];
    const imk_unit unit = unit_for(log, channel, s->possible_step);
    bool slow = false;
    for (int term = IMK_NOISE_BIAS_INSTABILITY; term <= IMK_NOISE_RAMP; term++)
        slow = slow || r->term[term].present;
    imki_text_add(detail, "%.3g %s at %.5g s", s->possible_step / unit.scale, unit.text,
                  (double)s->possible_step_place * log->record.dt);
    return (slow || r->gauss_markov_count > 0) && s->steps.count == 0 &&
           s->possible_step_square > worth_telling;
}

static bool find_cycle(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = unit_for(log, channel, s->cycle_amplitude);
    imki_text_add(detail, "%.3g %s, period %.3g s", s->cycle_amplitude / unit.scale, unit.text,
                  s->cycle_period);
    return s->cycle_amplitude > 0;
}

/* Samples that were taken out do not count: other messages report them. */
static bool find_missing(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_identification *r = &log->result[channel];
    const size_t missing = log->screened ? s->missing.count : r->missing;
    imki_text_add(detail, "%.3g %%, longest gap %.3g s",
                  100 * (double)missing / (double)log->record.rows,
                  log->screened ? (double)s->longest_hole * log->record.dt : r->largest_gap);
    return missing > 0;
}

/* A warm-up or an effect of temperature is in the log, and this channel has slow terms beside bias
 * instability: a trend too weak to be told from them here, or what a lag leaves of it. */
static bool find_trend_left(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    bool warm = false, thermal = false;
    for (size_t c = 0; c < log->record.count; c++) {
        warm = warm || log->screen[c].warm_up;
        thermal = thermal || log->screen[c].temperature_degree > 0;
    }
    imki_text_put(detail, r->term[IMK_NOISE_RANDOM_WALK].present ? "random walk"
                          : r->term[IMK_NOISE_RAMP].present      ? "ramp"
                                                                 : "");
    return (warm || thermal) && detail->size > 0;
}

/* A random walk or ramp of which the record holds little: other causes look the same. */
static bool find_walk(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double sure = 1.5;
    const imk_identification *r = &log->result[channel];
    const imk_estimate *walk = &r->term[IMK_NOISE_RANDOM_WALK], *ramp = &r->term[IMK_NOISE_RAMP];
    imki_text_put(detail, walk->present ? "random walk" : "ramp");
    return log->screen[channel].steps.count == 0 &&
           (ramp->present || (walk->present && walk->upper > sure * walk->lower));
}

/* Samples are missing, and the white noise has shorter tails than Gaussian noise: those far from
 * the level are not there. Tones and coarse steps shorten the tails, too. */
static bool find_dropped(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double by_chance = 5, share_least = 1e-3;
    const imk_noise_changes *c = &log->changes[channel];
    const imk_identification *r = &log->result[channel];
    const double missing = (double)log->screen[channel].missing.count / (double)log->record.rows;
    imki_text_add(detail, "%.3g %% missing, excess kurtosis %.2g, Gaussian 0 within %.1g",
                  100 * missing, c->kurtosis, 2 * c->kurtosis_sigma);
    return missing > share_least && log->map[channel] &&
           c->kurtosis < -by_chance * c->kurtosis_sigma && r->sinusoid_count == 0 &&
           r->resonance_count == 0 && r->resolution < 0.5 * r->deviation;
}

/* The joint estimate is not of one record alone. */
static bool find_short(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    (void)channel, (void)detail;
    return !log->settings.summarise;
}

static bool find_resolution(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double step = log->result[channel].resolution;
    const imk_unit unit = unit_for(log, channel, step);
    if (step > 0)
        imki_text_add(detail, "step %.3g %s", step / unit.scale, unit.text);
    return true;
}

static bool find_validity(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    if (isfinite(r->valid_from))
        imki_text_add(detail, "from %.3g s to %.3g s", r->valid_from, r->valid_to);
    else
        imki_text_put(detail, "nowhere");
    return true;
}

static bool find_lines(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    for (int k = 0; k < r->sinusoid_count && k < 3; k++) {
        const imk_unit unit = unit_for(log, channel, r->sinusoid[k].amplitude);
        imki_text_add(detail, "%s%.4g Hz of %.3g %s", k ? ", " : "", r->sinusoid[k].frequency,
                      r->sinusoid[k].amplitude / unit.scale, unit.text);
    }
    imki_text_put(detail, r->sinusoid_count > 3 ? ", more" : "");
    return true;
}

static bool find_resonance(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    if (r->resonance_count > 0)
        imki_text_add(detail, "%.3g Hz, Q %.3g%s", r->resonance[0].frequency, r->resonance[0].q,
                      r->resonance_count > 1 ? ", more" : "");
    return true;
}

/* Terms of a mask, as "bias instability, ramp". */
static void add_terms(imki_text *text, unsigned terms)
{
    static const char *const names[] = {"quantization", "white noise", "bias instability",
                                        "random walk",  "ramp",        "Gauss-Markov noise"};
    const char *between = "";
    for (unsigned k = 0; k < sizeof names / sizeof names[0]; k++)
        if (terms >> k & 1) {
            imki_text_add(text, "%s%s", between, names[k]);
            between = ", ";
        }
}

static bool find_ambiguous(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    if (!r->ambiguous || log->settings.summarise)
        return false;
    add_terms(detail, r->ambiguous);
    imki_text_put(detail, r->instead ? " or " : " or none");
    add_terms(detail, r->instead);
    return true;
}

/* Rounding an angle makes white noise of it only where the noise of one sample moves it by about
 * half a step. */
static bool find_angle_noise(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    const double step = sqrt(12) * r->term[IMK_NOISE_QUANTIZATION].value;
    const double moved = r->term[IMK_NOISE_WHITE].value * sqrt(log->record.dt);
    const bool rounded = fabs(r->resolution * log->record.dt - step) < 0.2 * step;
    (void)detail;
    return step > 2.1 * moved && !rounded;
}

static bool find_undetermined(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    static const char *const names[] = {"quantization", "white noise"};
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    for (int term = IMK_NOISE_QUANTIZATION; term <= IMK_NOISE_WHITE; term++) {
        const imk_estimate *e = &log->result[channel].term[term];
        const imk_unit unit = imk_channel_term(column, (imk_noise_term)term).unit;
        if (e->present && !(e->upper <= 9 * e->lower))
            imki_text_add(detail, "%s%s %.2g to %.2g %s", detail->size > 0 ? ", " : "", names[term],
                          e->lower / unit.scale, e->upper / unit.scale, unit.text);
    }
    return true;
}

/* White noise N behind a low-pass filter of time constant T has the spectrum of a Gauss-Markov term
 * with 2 sigma^2 T = N^2. A sensor without white noise, but with such a term of a few samples, is
 * more likely one with a filter; so is one with a term that is not certain and a tenth of N^2
 * large. */
static bool find_behind_filter(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double few = 10, matters = 0.1;
    const imk_identification *r = &log->result[channel];
    const imk_estimate *n = &r->term[IMK_NOISE_WHITE];
    const double white = n->present ? n->value : 0;
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_unit unit = imk_channel_term(column, IMK_NOISE_WHITE).unit;
    const bool alone = r->resonance_count == 0 || r->filter.bandwidth > 0;
    for (int i = 0; i < r->gauss_markov_count && alone; i++) {
        const imk_estimate *sigma = &r->gauss_markov[i].sigma;
        const double time = r->gauss_markov[i].correlation_time.value;
        const double behind = 2 * sigma->value * sigma->value * time;
        const bool certain = n->present && sigma->lower > 0;
        if (time < few * log->record.dt && !certain && behind > matters * white * white) {
            imki_text_add(detail, "%.3g %s behind a filter of %.2g Hz",
                          sqrt(behind + white * white) / unit.scale, unit.text,
                          1 / (6.283185307179586 * time));
            return true;
        }
    }
    return false;
}

static bool find_filter(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_low_pass filter = log->result[channel].filter;
    imki_text_add(detail, "%.3g Hz, ", filter.bandwidth);
    if (filter.damping > 0)
        imki_text_add(detail, "second order, damping %.2g", filter.damping);
    else
        imki_text_put(detail, "first order");
    return true;
}

/* What is looked for, and what it means. */
static const struct concern {
    unsigned bit;    /* IMK_VERDICT_…, which must hold; 0: any */
    assessment find; /* NULL: there is no more to it */
    unsigned screen; /* IMK_SCREEN_… bit by which it is taken out; 0: nothing is */
    imk_finding_level level;
    const char *code, *text, *kept; /* kept: when it was not taken out */
} concerns[] = {
    {0, find_outliers, IMK_SCREEN_OUTLIERS, IMK_FINDING_NOTE, "outliers",
     "outliers, left out of the estimate", "outliers, kept"},
    {0, find_tails_that_matter, 0, IMK_FINDING_WARNING, "heavy_tails",
     "so many samples are far from the level around them that they may be the noise itself: they "
     "are kept, and the intervals are as wide as the noise scatters; the log cannot show whether "
     "they are faults, and then the second value is closer",
     NULL},
    {0, find_small_tails, 0, IMK_FINDING_NOTE, "tails",
     "samples far from the level around them, kept as a part of the noise", NULL},
    {0, find_stuck, IMK_SCREEN_STUCK, IMK_FINDING_NOTE, "stuck",
     "one value repeated longer than the noise allows, left out", "one value repeated, kept"},
    {0, find_dead, 0, IMK_FINDING_WARNING, "dead",
     "a value that does not change makes up a part of the log: the sensor or its driver stood "
     "still; "
     "look for the cause, and record again",
     NULL},
    {0, find_saturated, IMK_SCREEN_SATURATED, IMK_FINDING_NOTE, "at_limit",
     "samples at the end of the range; the values are those of normal noise before it was cut off "
     "there, and their intervals allow for that assumption",
     "samples at the end of the range, kept; the values are too low by these factors"},
    {0, find_interpolated, 0, IMK_FINDING_WARNING, "interpolated",
     "the log looks interpolated: its noise is stronger and weaker in a cycle, as between the "
     "samples of a slower sensor, if no interference modulates it; interpolation takes away noise "
     "at short averaging times, so white noise, quantization, filter and resonances are not the "
     "sensor's; log the samples of the sensor themselves",
     NULL},
    {0, find_alternating, 0, IMK_FINDING_WARNING, "alternating",
     "the noise is stronger in every other row, as if two sensors or two converters wrote the log "
     "in turn; log them apart, because no stationary noise describes both",
     NULL},
    {0, find_warm_up, IMK_SCREEN_WARM_UP, IMK_FINDING_NOTE, "warm_up_removed",
     "a warm-up at the start, subtracted", "a warm-up at the start, kept"},
    {0, find_temperature, IMK_SCREEN_TEMPERATURE, IMK_FINDING_NOTE, "temperature",
     "the readings follow the temperature; subtracted",
     "the readings follow the temperature; kept"},
    {0, find_trend_left, 0, IMK_FINDING_WARNING, "trend_left",
     "a warm-up or an effect of temperature is in this log, and these terms may be what is left of "
     "it; "
     "record again at a constant temperature, and switch the sensor on earlier",
     NULL},
    {0, find_steps, 0, IMK_FINDING_WARNING, "steps",
     "the level jumps: the sensor was touched, or its range or filter was changed; the slow terms "
     "include the jump as noise",
     NULL},
    {0, find_cycle, 0, IMK_FINDING_WARNING, "cycle",
     "the level goes up and down regularly, as with the temperature of a room; the slow terms "
     "include it as noise; record again at a constant temperature, or log the temperature",
     NULL},
    {0, find_possible_step, 0, IMK_FINDING_NOTE, "possible_step",
     "a change of the level explains a part of the slow noise about as well; bias instability, "
     "random walk, ramp and Gauss-Markov noise may include it, and this record cannot tell",
     NULL},
    {0, find_missing, 0, IMK_FINDING_NOTE, "missing",
     "samples are missing; the estimate uses those that are there, and its intervals allow for "
     "the gaps",
     NULL},
    {0, find_walk, 0, IMK_FINDING_NOTE, "walk_or_drift",
     "jumps of the level by a few times the bias instability, or a drift with the temperature if "
     "the "
     "log does not state it, look the same; this record cannot tell",
     NULL},
    {0, find_dropped, 0, IMK_FINDING_WARNING, "dropped",
     "the samples far from the level are missing, as if a program had dropped what is out of a "
     "range; "
     "the white noise is too low; log every sample, or widen the range",
     NULL},
    {IMK_VERDICT_SHORT, find_short, 0, IMK_FINDING_NOTE, "short",
     "the record is too short for the slowest terms: they are bounded, not measured; log for "
     "longer",
     NULL},
    {IMK_VERDICT_COARSE, find_resolution, 0, IMK_FINDING_WARNING, "coarse",
     "the output step is so large against the noise that rounding errors are not white, so white "
     "noise and quantization are unreliable; log with more digits or a smaller range",
     NULL},
    {0, find_behind_filter, 0, IMK_FINDING_WARNING, "behind_filter",
     "a Gauss-Markov term of a few samples looks like white noise behind a low-pass filter; if the "
     "sensor or its driver filters, white noise is the first value, and the term is the filter; "
     "log "
     "unfiltered samples, or several times as many in a second",
     NULL},
    {IMK_VERDICT_UNDETERMINED, find_undetermined, 0, IMK_FINDING_WARNING, "undetermined",
     "filter, resonances or other terms can take the place of this term, so its value is hardly "
     "known; use the interval, or log faster or for longer",
     NULL},
    {IMK_VERDICT_SATURATED, NULL, 0, IMK_FINDING_WARNING, "saturated",
     "samples stick at an extreme value: the range is too small or the sensor was moved", NULL},
    {IMK_VERDICT_FROZEN, NULL, 0, IMK_FINDING_WARNING, "frozen",
     "long runs of one value: samples are repeated, so the true sample rate is lower than the "
     "log's",
     NULL},
    {IMK_VERDICT_WARM_UP, NULL, 0, IMK_FINDING_WARNING, "warm_up",
     "the start drifts differently from the rest; switch the sensor on earlier, or leave out the "
     "first minutes",
     NULL},
    {IMK_VERDICT_MISFIT, find_validity, 0, IMK_FINDING_WARNING, "misfit",
     "the model explains the record only over these averaging times; the log also contains "
     "something else (vibration, filtering, another process)",
     NULL},
    {IMK_VERDICT_LINES, find_lines, 0, IMK_FINDING_NOTE, "lines",
     "spectral lines, from vibration or interference, are modelled separately as sinusoids", NULL},
    {IMK_VERDICT_RESONANCE, find_resonance, 0, IMK_FINDING_NOTE, "resonance",
     "a resonance of the structure or the sensor is modelled separately", NULL},
    {0, find_angle_noise, 0, IMK_FINDING_NOTE, "angle_noise",
     "the quantization is white noise of the angle, and the output is not rounded to such steps; "
     "simulate rounds, so a twin has less noise at the shortest averaging times",
     NULL},
    {0, find_ambiguous, 0, IMK_FINDING_NOTE, "ambiguous",
     "the record cannot tell which of these terms it holds; the intervals hold for either", NULL},
    {IMK_VERDICT_FILTERED, find_filter, 0, IMK_FINDING_NOTE, "filtered",
     "the output is low-pass filtered within the band; the filter is in the model", NULL},
};

/* What the estimate shows without screening the samples. */
static bool is_of_estimate(assessment find)
{
    return find == find_missing || find == find_ambiguous || find == find_angle_noise ||
           find == find_behind_filter;
}

/* The channels on which a condition holds, each with its details in parentheses. */
static void assess_concern(imk_verdict *v, const imk_identify_log *log, const struct concern *about)
{
    imki_text list = {.bytes = NULL};
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        imki_text detail = {.bytes = NULL};
        imki_text_put(&detail, "");
        if ((log->result[c].verdict & about->bit) == about->bit &&
            (!about->find || about->find(log, c, &detail))) {
            imki_text_add(&list, "%s%s", list.size > 0 ? ", " : "",
                          imk_even_record_column(&log->record, c)->name);
            channels |= (uint64_t)1 << c;
            if (detail.size > 0)
                imki_text_add(&list, " (%s)", detail.bytes);
        }
        list.failed = list.failed || detail.failed;
        free(detail.bytes);
    }
    const bool kept = about->screen && !(log->settings.take_out & about->screen);
    if (list.size > 0)
        imki_text_add(&list, ": %s.", kept ? about->kept : about->text);
    imki_verdict_list(v, about->level, about->code, "", &list, "");
    if (channels)
        imki_verdict_about(v, &log->record, channels);
}

/* ---- the record as a whole ------------------------------------------------------------------- */

/* The unit in which the numbers of the file would equal gravity. */
static const char *likely_unit(double magnitude, double scale)
{
    static const char *const names[] = {"m/s^2", "g", "mg", "ug", "Gal", "mGal"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        const double as = magnitude / scale * imk_unit_of(names[k]).scale;
        if (as > gravity_least && as < gravity_most)
            return names[k];
    }
    return NULL;
}

/* The mean specific force of a triad at rest has the size of gravity; otherwise the unit is wrong
 * in most cases. */
static void assess_gravity(imk_verdict *v, const imk_identify_log *log)
{
    double square = 0, scale = 0;
    int axes = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_log_column *column = imk_even_record_column(&log->record, c);
        if (imk_channel_kind_of(column) != IMK_CHANNEL_ACCEL || column->axis > 2)
            continue;
        square += log->result[c].mean * log->result[c].mean;
        scale = column->unit.scale;
        axes++;
    }
    const double magnitude = sqrt(square);
    if (axes != 3 || (magnitude > gravity_least && magnitude < gravity_most))
        return;
    const char *unit = likely_unit(magnitude, scale);
    if (unit)
        imki_verdict_add(v, IMK_FINDING_WARNING, "gravity",
                         "|accel| is %.4g m/s^2 at rest: the numbers look like %s; write %s into "
                         "the header, or add --accel-unit %s if it has no unit.",
                         magnitude, unit, unit, unit);
    else
        imki_verdict_add(v, IMK_FINDING_WARNING, "gravity",
                         "|accel| is %.4g m/s^2 at rest, not gravity (9.78 to 9.83), and no common "
                         "unit explains this value: was gravity removed, or did the sensor move?",
                         magnitude);
}

/* The times at which the five terms alone do not explain the log, and the other terms that dominate
 * it there. */
static void assess_five_terms(imk_verdict *v, const imk_identify_log *log)
{
    imki_text list = {.bytes = NULL};
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++) {
        const imk_identification *r = &log->result[c];
        if (r->five_terms_from <= 1.5 * log->record.dt)
            continue;
        const struct {
            bool is;
            const char *name;
        } causes[] = {{r->filter.bandwidth > 0, "output filter"},
                      {r->resonance_count > 0, "resonances"},
                      {r->sinusoid_count > 0, "lines"},
                      {r->gauss_markov_count > 0, "Gauss-Markov noise"}};
        bool any = false;
        channels |= (uint64_t)1 << c;
        imki_text_add(&list, "%s%s from %.3g s (", list.size > 0 ? "; " : "",
                      imk_even_record_column(&log->record, c)->name, r->five_terms_from);
        for (size_t k = 0; k < sizeof causes / sizeof causes[0]; k++)
            if (causes[k].is) {
                imki_text_add(&list, "%s%s", any ? ", " : "", causes[k].name);
                any = true;
            }
        imki_text_put(&list, any ? ")" : "cause not known)");
    }
    imki_verdict_list(v, IMK_FINDING_NOTE, "five_terms",
                      "white noise, bias instability, random walk, ramp and quantization alone "
                      "explain the log only from some averaging time on. At shorter times other "
                      "terms of the model dominate the log: ",
                      &list, ".");
    if (channels)
        imki_verdict_about(v, &log->record, channels);
}

static bool has_times(const imk_even_record *record)
{
    for (size_t c = 0; c < record->log.column_count; c++)
        if (record->log.column[c].quantity == IMK_QUANTITY_TIME)
            return true;
    return false;
}

static void assess_length(imk_verdict *v, const imk_identify_log *log)
{
    const imk_even_record *record = &log->record;
    const imki_words length = imki_duration(record->dt * (double)record->rows);
    const char *rate = has_times(record) ? "" : " as stated, which no log can test";
    double from = 0, to = (double)INFINITY;
    for (size_t c = 0; c < record->count; c++)
        if (isfinite(log->result[c].valid_from)) {
            from = fmax(from, log->result[c].valid_from);
            to = fmin(to, log->result[c].valid_to);
        }
    if (from > 0)
        imki_verdict_add(
            v, imk_verdict_warns(v) ? IMK_FINDING_NOTE : IMK_FINDING_GOOD, "length",
            "%s at %.6g Hz%s: the model is valid for averaging times from %.3g s to %.3g s.",
            length.text, 1 / record->dt, rate, from, to);
    else
        imki_verdict_add(v, IMK_FINDING_NOTE, "length", "%s at %.6g Hz%s.", length.text,
                         1 / record->dt, rate);
}

/* Findings of the job itself. For a curve, only the quality of the fit is known. */
static void add_findings(imk_verdict *v, const imk_identify_log *log)
{
    char text[900];
    for (size_t k = 0; k < log->findings.count; k++) {
        const imk_finding *f = &log->findings.item[k];
        const bool misfit = strncmp(f->code, "curve_misfit", 12) == 0;
        const size_t before = v->count;
        imk_finding_text(f, text, sizeof text);
        if (misfit)
            imki_verdict_add(v, IMK_FINDING_WARNING, "misfit", "%s", text);
        else if (strcmp(f->code, "missing") != 0)
            imki_verdict_add(v, f->level,
                             f->level == IMK_FINDING_GOOD ? "curve" : imk_finding_code(f), "%s",
                             text);
        if (v->count > before)
            imki_verdict_clause(v, f->code);
        if (f->level == IMK_FINDING_WARNING && v->count > before)
            v->message[before].told = true;
    }
}

imk_verdict imk_identify_verdict(const imk_identify_log *log, const char *label, imk_result *result)
{
    imk_verdict v = {.result = result, .label = label};
    add_findings(&v, log);
    if (log->origin == IMK_IDENTIFY_CURVE)
        return v;
    assess_gravity(&v, log);
    for (size_t k = 0; k < sizeof concerns / sizeof concerns[0]; k++)
        if (log->screened || concerns[k].bit || is_of_estimate(concerns[k].find))
            assess_concern(&v, log, &concerns[k]);
    imki_assess_vibration(&v, log);
    imki_verdict_noise_changes(&v, log);
    assess_five_terms(&v, log);
    assess_length(&v, log);
    if (log->record.bridged > 0)
        imki_verdict_add(&v, IMK_FINDING_NOTE, "bridged",
                         "%zu of %zu samples were bridged by straight lines.", log->record.bridged,
                         log->record.rows);
    if (!imk_verdict_warns(&v))
        imki_verdict_add(&v, IMK_FINDING_GOOD, "good", "No test found a fault in this record.");
    return v;
}
