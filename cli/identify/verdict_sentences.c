/* SPDX-License-Identifier: Apache-2.0 */
/* The verdict on a record in plain sentences: what it is good for, and what is wrong with it. */
#include "identify_parts.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

/* Gravity on the surface of the Earth [m/s^2]: equator to pole by WGS84, rounded outwards; what is
 * off by more than 5 % is no specific force at rest. */
static const double gravity_least = 9.78, gravity_most = 9.83, gravity_slack = 0.05;

void identify_add_sentence(identification *i, verdict_level level, const char *code,
                           const char *format, ...)
{
    if (i->verdict_count == VERDICTS_MAX)
        return;
    verdict_sentence *sentence = &i->verdict[i->verdict_count++];
    sentence->level = level;
    snprintf(sentence->code, sizeof sentence->code, "%s", code);
    va_list arguments;
    const int used =
        i->label ? snprintf(sentence->text, sizeof sentence->text / 2, "%.200s: ", i->label) : 0;
    va_start(arguments, format);
    vsnprintf(sentence->text + used, sizeof sentence->text - (size_t)used, format, arguments);
    va_end(arguments);
}

/* What stands behind a channel's name in a list, "(61.2 Hz)"; "" for nothing. */
typedef void (*detail_writer)(const identification *i, size_t channel, char *text, size_t size);

static void no_detail(const identification *i, size_t channel, char *text, size_t size)
{
    (void)i, (void)channel, (void)size;
    text[0] = '\0';
}

static void filter_detail(const identification *i, size_t channel, char *text, size_t size)
{
    imk_low_pass filter = i->found->result[channel].filter;
    if (filter.damping > 0)
        snprintf(text, size, " (%.3g Hz, second order, damping %.2g)", filter.bandwidth,
                 filter.damping);
    else
        snprintf(text, size, " (%.3g Hz, first order)", filter.bandwidth);
}

static void line_detail(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_identification *r = &i->found->result[channel];
    size_t used = 0;
    text[0] = '\0';
    for (int k = 0; k < r->sinusoid_count && k < 3; k++) {
        imk_unit unit = channel_readable_unit(log_channel_column(&i->found->record, channel),
                                              r->sinusoid[k].amplitude);
        used += (size_t)snprintf(text + used, size - used, "%s%.4g Hz of %.3g %s", k ? ", " : " (",
                                 r->sinusoid[k].frequency, r->sinusoid[k].amplitude / unit.scale,
                                 unit.text);
        if (used >= size)
            return;
    }
    if (r->sinusoid_count > 0)
        snprintf(text + used, size - used, "%s)", r->sinusoid_count > 3 ? ", more" : "");
}

static void resonance_detail(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_identification *r = &i->found->result[channel];
    text[0] = '\0';
    if (r->resonance_count > 0)
        snprintf(text, size, " (%.3g Hz, Q %.3g%s)", r->resonance[0].frequency, r->resonance[0].q,
                 r->resonance_count > 1 ? ", more" : "");
}

static void resolution_detail(const identification *i, size_t channel, char *text, size_t size)
{
    double step = i->found->result[channel].resolution;
    imk_unit unit = channel_readable_unit(log_channel_column(&i->found->record, channel), step);
    text[0] = '\0';
    if (step > 0)
        snprintf(text, size, " (step %.3g %s)", step / unit.scale, unit.text);
}

static void valid_detail(const identification *i, size_t channel, char *text, size_t size)
{
    const imk_identification *r = &i->found->result[channel];
    if (isfinite(r->valid_from))
        snprintf(text, size, " (from %.3g s to %.3g s)", r->valid_from, r->valid_to);
    else
        snprintf(text, size, " (nowhere)");
}

static const struct bit_sentence {
    unsigned bit;
    verdict_level level;
    const char *code, *text;
    detail_writer detail;
} bit_sentences[] = {
    {IMK_VERDICT_SHORT, VERDICT_WARNING, "short",
     "the record is too short for the slowest terms: they are bounded, not measured; log for "
     "longer",
     no_detail},
    {IMK_VERDICT_COARSE, VERDICT_WARNING, "coarse",
     "the output step is larger than the noise: the white noise is doubtful; log with more digits "
     "or a smaller range",
     resolution_detail},
    {IMK_VERDICT_SATURATED, VERDICT_WARNING, "saturated",
     "samples stick at an extreme value: the range is too small or the sensor was moved",
     no_detail},
    {IMK_VERDICT_FROZEN, VERDICT_WARNING, "frozen",
     "long runs of one value: samples are repeated, so the true sample rate is lower than the "
     "log's",
     no_detail},
    {IMK_VERDICT_WARM_UP, VERDICT_WARNING, "warm_up",
     "the start drifts unlike the rest: switch on earlier, or leave the first minutes out",
     no_detail},
    {IMK_VERDICT_MISFIT, VERDICT_WARNING, "misfit",
     "the model explains the record only over these averaging times; the log holds something else "
     "as well (vibration, filtering, another process)",
     valid_detail},
    {IMK_VERDICT_LINES, VERDICT_NOTE, "lines",
     "spectral lines, from vibration or interference, are modelled apart as sinusoids",
     line_detail},
    {IMK_VERDICT_RESONANCE, VERDICT_NOTE, "resonance",
     "a resonance of the structure or the sensor is modelled apart", resonance_detail},
    {IMK_VERDICT_FILTERED, VERDICT_NOTE, "filtered",
     "the output is low-pass filtered within the band; the filter is in the model", filter_detail},
};

static void judge_bits(identification *i)
{
    for (size_t k = 0; k < sizeof bit_sentences / sizeof bit_sentences[0]; k++) {
        const struct bit_sentence *b = &bit_sentences[k];
        char list[260] = "";
        size_t used = 0;
        for (size_t c = 0; c < i->found->record.count && used < sizeof list; c++) {
            char detail[120];
            if (!(i->found->result[c].verdict & b->bit))
                continue;
            if (b->bit == IMK_VERDICT_SHORT && i->found->settings.summarise)
                continue; /* the joint estimate is not of this log alone */
            b->detail(i, c, detail, sizeof detail);
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s%s", used ? ", " : "",
                                     log_channel_column(&i->found->record, c)->name, detail);
        }
        if (used > 0)
            identify_add_sentence(i, b->level, b->code, "%s: %s.", list, b->text);
    }
}

/* The unit in which the file's numbers would be gravity. */
static const char *likely_unit(double magnitude, double scale)
{
    static const char *const names[] = {"m/s^2", "g", "mg", "ug", "Gal", "mGal"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        double as = magnitude / scale * imk_unit_of(names[k]).scale;
        if (as > gravity_least * (1 - gravity_slack) && as < gravity_most * (1 + gravity_slack))
            return names[k];
    }
    return NULL;
}

/* |mean specific force| of a triad at rest is gravity; anything else is a wrong unit, most often.
 */
static void judge_gravity(identification *i)
{
    double square = 0, scale = 0;
    int axes = 0;
    for (size_t c = 0; c < i->found->record.count; c++) {
        const imk_log_column *column = log_channel_column(&i->found->record, c);
        if (channel_kind_of(column) != CHANNEL_ACCEL || column->axis > 2)
            continue;
        square += i->found->result[c].mean * i->found->result[c].mean;
        scale = column->unit.scale;
        axes++;
    }
    double magnitude = sqrt(square);
    if (axes != 3 || (magnitude > gravity_least * (1 - gravity_slack) &&
                      magnitude < gravity_most * (1 + gravity_slack)))
        return;
    const char *unit = likely_unit(magnitude, scale);
    if (unit)
        identify_add_sentence(
            i, VERDICT_WARNING, "gravity",
            "|accel| is %.4g m/s^2 at rest: the numbers look like %s; write %s into the header, or "
            "add --accel-unit %s where it has none.",
            magnitude, unit, unit, unit);
    else
        identify_add_sentence(
            i, VERDICT_WARNING, "gravity",
            "|accel| is %.4g m/s^2 at rest, not gravity (9.78 to 9.83), and no usual unit makes it "
            "so: was gravity removed, or did the sensor move?",
            magnitude);
}

/* Where the five terms alone do not explain the log, and what shapes it there instead. */
static void judge_five_terms(identification *i)
{
    char list[600] = "";
    size_t used = 0;
    for (size_t c = 0; c < i->found->record.count && used < sizeof list; c++) {
        const imk_identification *r = &i->found->result[c];
        if (r->five_terms_from <= 1.5 * i->found->record.dt)
            continue;
        const struct {
            bool is;
            const char *name;
        } causes[] = {{r->filter.bandwidth > 0, "output filter"},
                      {r->resonance_count > 0, "resonances"},
                      {r->sinusoid_count > 0, "lines"},
                      {r->gauss_markov_count > 0, "Gauss-Markov noise"}};
        char why[100] = "";
        for (size_t k = 0; k < sizeof causes / sizeof causes[0]; k++)
            if (causes[k].is)
                snprintf(why + strlen(why), sizeof why - strlen(why), "%s%s", why[0] ? ", " : "",
                         causes[k].name);
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s from %.3g s (%s)",
                                 used ? "; " : "", log_channel_column(&i->found->record, c)->name,
                                 r->five_terms_from, why[0] ? why : "cause not known");
    }
    if (used > 0)
        identify_add_sentence(
            i, VERDICT_NOTE, "five_terms",
            "white noise, bias instability, random walk, ramp and quantization alone hold only "
            "from "
            "some averaging time on; below it what is named shapes the log, and is in the model: "
            "%s.",
            list);
}

void identify_judge(identification *i)
{
    char length[60];
    double from = 0, to = (double)INFINITY;
    for (size_t c = 0; c < i->found->record.count; c++) {
        if (!isfinite(i->found->result[c].valid_from))
            continue;
        from = fmax(from, i->found->result[c].valid_from);
        to = fmin(to, i->found->result[c].valid_to);
    }
    format_duration(i->found->record.dt * (double)i->found->record.rows, length, sizeof length);
    judge_gravity(i);
    identify_judge_samples(i);
    judge_bits(i);
    judge_five_terms(i);
    bool bad = identify_is_bad(i);
    if (from > 0)
        identify_add_sentence(
            i, bad ? VERDICT_NOTE : VERDICT_GOOD, "length",
            "%s at %.6g Hz: the model speaks for averaging times from %.3g s to %.3g s.", length,
            1 / i->found->record.dt, from, to);
    else
        identify_add_sentence(i, VERDICT_NOTE, "length", "%s at %.6g Hz.", length,
                              1 / i->found->record.dt);
    if (i->found->record.bridged > 0)
        identify_add_sentence(i, VERDICT_NOTE, "bridged",
                              "%zu of %zu samples were bridged by straight lines.",
                              i->found->record.bridged, i->found->record.rows);
    if (!bad)
        identify_add_sentence(i, VERDICT_GOOD, "good", "Nothing speaks against this record.");
}

void identify_warn(const identification *i)
{
    for (size_t k = 0; k < i->verdict_count; k++)
        if (i->verdict[k].level == VERDICT_WARNING)
            command_warn(i->verdict[k].code, "%s", i->verdict[k].text);
}

bool identify_is_bad(const identification *i)
{
    for (size_t k = 0; k < i->verdict_count; k++)
        if (i->verdict[k].level == VERDICT_WARNING)
            return true;
    return false;
}
