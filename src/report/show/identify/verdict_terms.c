/* SPDX-License-Identifier: Apache-2.0 */
/* What the estimates of some channels are worth: terms that the record does not tell apart or holds
 * too little of, and what the model has besides the usual terms. */
#include "verdict_concern_internal.h"

#include <math.h>

/* The joint estimate is not of one record alone. */
static bool find_short(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    (void)channel, (void)detail;
    return !log->settings.summarise;
}

static bool find_resolution(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double step = log->result[channel].resolution;
    const imk_unit unit = imki_concern_unit(log, channel, step);
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

/* A warm-up or an effect of temperature that was subtracted took slow noise with it. */
static bool has_level(const imk_identify_log *log, size_t channel)
{
    const imk_screen *s = &log->screen[channel];
    return !s->warm_up && s->temperature_degree == 0;
}

/* Power that is missing at the lowest frequencies of a channel; or of all together, and of it. */
static bool find_held(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double loss = 0.3;
    const imk_identification *together[IMK_LOG_COLUMNS_MAX], *r = &log->result[channel];
    size_t count = 0;
    for (size_t c = 0; c < log->record.count && count < IMK_LOG_COLUMNS_MAX; c++)
        if (has_level(log, c))
            together[count++] = &log->result[c];
    imk_level_sum low = imk_level_loss(1, &r), all = imk_level_loss(count, together);
    for (size_t k = 0; low.degrees == 0 && k < IMK_LEVEL_SUMS; k++)
        if (all.degrees > 0 && fabs(r->level[k].period - all.period) < 0.1 * all.period &&
            r->level[k].power < (1 - loss) * r->level[k].degrees)
            low = r->level[k];
    imki_text_add(detail, "periods above %.2g s hold %.2g of the model's power", low.period,
                  low.power / low.degrees);
    return has_level(log, channel) && low.degrees > 0;
}

static bool find_lines(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    for (int k = 0; k < r->sinusoid_count && k < 3; k++) {
        const imk_unit unit = imki_concern_unit(log, channel, r->sinusoid[k].amplitude);
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

static bool find_angle_noise(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    const imk_estimate *q = &r->term[IMK_NOISE_QUANTIZATION];
    const imk_unit unit =
        imk_channel_term(imk_even_record_column(&log->record, channel), IMK_NOISE_QUANTIZATION)
            .unit;
    if (!q->present || imk_identification_counted(r))
        return false;
    imki_text_add(detail, "1 sigma of a reading %.3g %s", q->value / unit.scale, unit.text);
    return true;
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

/* Slow fluctuations that are larger than those of any sensor at rest: 0.3 deg/s are ten times the
 * bias instability of the poorest gyros, 5 mg that of accelerometers. */
static bool find_unrest(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_identification *r = &log->result[channel];
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_channel_kind kind = imk_channel_kind_of(column);
    const double limit = kind == IMK_CHANNEL_GYRO ? 0.005 : kind == IMK_CHANNEL_ACCEL ? 0.05 : 0;
    for (int i = 0; i < r->gauss_markov_count && limit > 0; i++) {
        const double sigma = r->gauss_markov[i].sigma.value;
        const double time = r->gauss_markov[i].correlation_time.value;
        const imk_unit unit = imki_concern_unit(log, channel, sigma);
        if (sigma > limit && time > 0.1 && time > 10 * log->record.dt) {
            imki_text_add(detail, "%.3g %s over %.2g s", sigma / unit.scale, unit.text, time);
            return true;
        }
    }
    return false;
}

/* White noise N behind a low-pass filter of time constant T has the spectrum of a Gauss-Markov term
 * with 2 sigma^2 T = N^2. A sensor without white noise, but with such a term of a few samples, is
 * more likely one with a filter; so is one with a term that is not certain and a tenth of N^2
 * large. Beside white noise, resonances without a filter leave such a term over themselves. The
 * time constant; 0: there is no such term. */
static double time_constant_of(const imk_identification *r, double dt, double *white)
{
    const double few = 10, many = 1000, matters = 0.1; /* many: no sensor is without white noise */
    const imk_estimate *n = &r->term[IMK_NOISE_WHITE];
    const bool alone = r->resonance_count == 0 || r->filter.bandwidth > 0 || !n->present;
    *white = n->present ? n->value : 0;
    for (int i = 0; i < r->gauss_markov_count && alone; i++) {
        const imk_estimate *sigma = &r->gauss_markov[i].sigma;
        const double time = r->gauss_markov[i].correlation_time.value;
        const double behind = 2 * sigma->value * sigma->value * time;
        const bool certain = n->present && sigma->lower > 0;
        const double limit = (n->present ? few : many) * dt;
        if (time < limit && !certain && behind > matters * *white * *white) {
            *white = sqrt(behind + *white * *white);
            return time;
        }
    }
    return 0;
}

/* The same of resonances that stand for the shape of a filter. */
static bool find_behind_filter(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const double matters = 1.01;
    const imk_identification *r = &log->result[channel];
    const imk_log_column *column = imk_even_record_column(&log->record, channel);
    const imk_unit unit = imk_channel_term(column, IMK_NOISE_WHITE).unit;
    double white;
    const double time = time_constant_of(r, log->record.dt, &white);
    if (time > 0)
        imki_text_add(detail, "%.3g %s behind a filter of %.2g Hz", white / unit.scale, unit.text,
                      1 / (6.283185307179586 * time));
    else if (r->plateau > matters * white)
        imki_text_add(detail, "%.3g %s behind a digital filter", r->plateau / unit.scale,
                      unit.text);
    return time > 0 || r->plateau > matters * white;
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

/* What is looked for, and what it means, in the order in which it is told. */
static const imki_concern concerns[] = {
    {IMK_VERDICT_SHORT, find_short, 0, IMK_FINDING_NOTE, "short",
     "the record is too short for the slowest terms: they are bounded, not measured; log for "
     "longer",
     NULL},
    {IMK_VERDICT_COARSE, find_resolution, 0, IMK_FINDING_WARNING, "coarse",
     "the output step is so large against the noise that rounding errors are not white, so white "
     "noise and quantization are unreliable; log with more digits or a smaller range, or, of a "
     "sensor that counts its integral, at a lower rate",
     NULL},
    {0, find_unrest, 0, IMK_FINDING_WARNING, "unrest",
     "slow fluctuations that no sensor at rest has: it was carried, or stood on something that "
     "moves; "
     "the slow terms are of the movement; record again on a firm base",
     NULL},
    {0, find_behind_filter, 0, IMK_FINDING_WARNING, "behind_filter",
     "a Gauss-Markov term of a few samples, or one without white noise, looks like white noise "
     "behind a low-pass filter, and so do wide resonances; if the sensor or its driver filters, "
     "white noise is the first value, and the term or the resonances are the filter; log "
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
    {0, find_held, 0, IMK_FINDING_WARNING, "level_held",
     "the level moves less than the rest of the noise tells, as behind a high-pass filter or an "
     "automatic zero: bias instability and random walk cannot be seen; log without it",
     NULL},
    {IMK_VERDICT_LINES, find_lines, 0, IMK_FINDING_NOTE, "lines",
     "spectral lines, from vibration or interference, are modelled separately as sinusoids", NULL},
    {IMK_VERDICT_RESONANCE, find_resonance, 0, IMK_FINDING_NOTE, "resonance",
     "a resonance of the structure or the sensor is modelled separately", NULL},
    {0, find_angle_noise, 0, IMK_FINDING_NOTE, "angle_noise",
     "the readings of the integral have white errors that lie on no grid: they are taken as white "
     "noise of the integral, whose readings scatter less at a lower rate; counts behind a dither "
     "look the same at one rate, but scatter alike at every rate: a log at another rate tells",
     NULL},
    {0, find_ambiguous, 0, IMK_FINDING_NOTE, "ambiguous",
     "the record cannot tell which of these terms it holds; the intervals hold for either", NULL},
    {IMK_VERDICT_FILTERED, find_filter, 0, IMK_FINDING_NOTE, "filtered",
     "the output is low-pass filtered within the band; the filter is in the model", NULL},
};

void imki_assess_terms(imk_verdict *v, const imk_identify_log *log)
{
    for (size_t k = 0; k < sizeof concerns / sizeof concerns[0]; k++)
        imki_assess_concern(v, log, &concerns[k]);
}
