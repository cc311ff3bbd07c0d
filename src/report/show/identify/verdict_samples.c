/* SPDX-License-Identifier: Apache-2.0 */
/* What is wrong with the samples of some channels, and what may be: as screening them tells, and
 * the estimate beside it. */
#include "verdict_concern_internal.h"

#include <math.h>
#include <string.h>

static bool find_outliers(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->largest_outlier);
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
    const bool matters = white->value * s->core < white->lower && s->clustered;
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

static bool find_lost(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imk_channel_plain_unit(imk_even_record_column(&log->record, channel));
    imki_text_add(detail, "%zu of %zu samples are %.6g %s", s->lost.count, s->n,
                  s->lost_value / unit.scale, unit.text);
    return s->lost.count > 0;
}

static bool find_saturated(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%zu samples, white noise times %.4g", s->saturated.count,
                  s->clipped_deviation);
    return s->saturated.count > 0;
}

/* Where uniform errors of counting behind a dither are all there is, two readings differ by a step
 * at most, and the values end there by themselves. */
static bool ends_by_counting(const imk_identification *r, double end)
{
    const imk_estimate *q = &r->term[IMK_NOISE_QUANTIZATION];
    const double step = sqrt(12) * q->value;
    return q->present && r->dt > 0 && fabs(fabs(end - r->mean) * r->dt - step) < 0.1 * step;
}

/* Tones have many largest values; resonances and filters may. */
static bool find_ends(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_identification *r = &log->result[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->end_high - s->end_low);
    const bool low = s->ends_low && !ends_by_counting(r, s->end_low);
    const bool high = s->ends_high && !ends_by_counting(r, s->end_high);
    if (low)
        imki_text_add(detail, "above %.4g %s", s->end_low / unit.scale, unit.text);
    if (high)
        imki_text_add(detail, "%sbelow %.4g %s", low ? " and " : "", s->end_high / unit.scale,
                      unit.text);
    return (low || high) && s->saturated.count == 0 && r->sinusoid_count == 0;
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
    const imk_unit unit = imki_concern_unit(log, channel, s->warm_up_amplitude);
    imki_text_add(
        detail, "%s %s at the start, time constant %s s",
        imki_plus_minus(s->warm_up_amplitude, s->warm_up_amplitude_sigma, unit.scale).text,
        unit.text, imki_plus_minus(s->warm_up_time, s->warm_up_time_sigma, 1).text);
    return s->warm_up;
}

static bool find_temperature(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->temperature_slope);
    imki_text_add(
        detail, "%s %s/degC%s",
        imki_plus_minus(s->temperature_slope, s->temperature_slope_sigma, unit.scale).text,
        unit.text, s->temperature_degree > 1 ? " and a curvature" : "");
    return s->temperature_degree > 0;
}

static bool find_steps(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->largest_step);
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
    const imk_unit unit = imki_concern_unit(log, channel, s->possible_step);
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
    const imk_unit unit = imki_concern_unit(log, channel, s->cycle_amplitude);
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
static bool is_dropped(const imk_identify_log *log, size_t channel)
{
    const double by_chance = 5, share_least = 1e-3;
    const imk_noise_changes *c = &log->changes[channel];
    const imk_identification *r = &log->result[channel];
    const double missing = (double)log->screen[channel].missing.count / (double)log->record.rows;
    return missing > share_least && log->map[channel] &&
           c->kurtosis < -by_chance * c->kurtosis_sigma && r->sinusoid_count == 0 &&
           r->resonance_count == 0 && r->resolution < 0.5 * r->deviation;
}

static void put_kurtosis(const imk_noise_changes *c, imki_text *detail)
{
    imki_text_add(detail, "excess kurtosis %.2g, Gaussian 0 within %.1g", c->kurtosis,
                  2 * c->kurtosis_sigma);
}

static bool find_dropped(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double missing = (double)log->screen[channel].missing.count / (double)log->record.rows;
    imki_text_add(detail, "%.3g %% missing, ", 100 * missing);
    put_kurtosis(&log->changes[channel], detail);
    return is_dropped(log, channel);
}

/* Lighter tails than the noise has, and nothing that was found made them: samples at the end of the
 * range are allowed for, and where the output is rounded twice, the noise is right. */
static bool find_light_tails(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_noise_changes *c = &log->changes[channel];
    put_kurtosis(c, detail);
    return log->map[channel] && c->light_tails && !is_dropped(log, channel) &&
           log->screen[channel].saturated.count == 0 && !log->screen[channel].uneven;
}

/* What is looked for, and what it means, in the order in which it is told. */
static const imki_concern concerns[] = {
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
     "still; look for the cause, and record again",
     NULL},
    {0, find_lost, IMK_SCREEN_STUCK, IMK_FINDING_NOTE, "lost",
     "one value far outside the noise, as a logger writes it for a row that was lost; left out",
     "one value far outside the noise, as a logger writes it for a row that was lost; kept"},
    {0, find_saturated, IMK_SCREEN_SATURATED, IMK_FINDING_NOTE, "at_limit",
     "samples at the end of the range; the values are those of normal noise before it was cut off "
     "there, and their intervals allow for that assumption",
     "samples at the end of the range, kept; the values are too low by these factors"},
    {0, find_ends, 0, IMK_FINDING_WARNING, "ends",
     "all samples are on one side of a value near which there are many, as where readings are "
     "limited, folded back, wrapped around, rectified, or dropped and replaced by their value; the "
     "white noise is not the sensor's; widen the range, and log the samples as they are",
     NULL},
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
     "it; record again at a constant temperature, and switch the sensor on earlier",
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
     "the log does not state it, look the same; this record cannot tell",
     NULL},
    {0, find_dropped, 0, IMK_FINDING_WARNING, "dropped",
     "the samples far from the level are missing, as if a program had dropped what is out of a "
     "range; the white noise is too low; log every sample, or widen the range",
     NULL},
    {0, find_light_tails, 0, IMK_FINDING_WARNING, "light_tails",
     "the noise has lighter tails than noise has, as behind a stage that saturates softly or a "
     "filter that removes spikes; the white noise is too low; log without the filter, or with less "
     "gain",
     NULL},
};

/* Nothing that was estimated is of a sensor at rest. */
static void assess_moves(imk_verdict *v, const imk_identify_log *log)
{
    const imk_identify_moves m = imk_identify_log_moves(log);
    uint64_t channels = 0;
    for (size_t c = 0; c < log->record.count; c++)
        channels |= (uint64_t)(log->screen[c].moved.count > 0) << c;
    if (!m.moved)
        return;
    if (m.still_end > m.still_first)
        imki_verdict_add(
            v, IMK_FINDING_FAILURE, "moved",
            "the sensor was moved, or had not settled, %sbetween %.4g s and %.4g s; the "
            "longest part without this is read by --after %gs --before %gs.",
            m.still_first > m.first && m.still_end < m.end ? "at times " : "", m.first, m.end,
            m.still_first, m.still_end);
    else
        imki_verdict_add(v, IMK_FINDING_FAILURE, "moved",
                         "the sensor was moved, or had not settled, between %.4g s and %.4g s, and "
                         "no part of the log is without this: record it again at rest.",
                         m.first, m.end);
    imki_verdict_about(v, &log->record, channels);
}

/* That samples are missing is known without screening them. */
void imki_assess_samples(imk_verdict *v, const imk_identify_log *log)
{
    if (log->screened)
        assess_moves(v, log);
    for (size_t k = 0; k < sizeof concerns / sizeof concerns[0]; k++)
        if (log->screened || concerns[k].find == find_missing)
            imki_assess_concern(v, log, &concerns[k]);
}
