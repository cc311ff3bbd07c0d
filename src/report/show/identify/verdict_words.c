/* SPDX-License-Identifier: Apache-2.0 */
/* A verdict in one sentence, and its messages in a few words. Every code has a clause for the
 * sentence and a title for the list; %s stands for the channels, {looks|look} for the word of one
 * channel and that of several. The whole text of a message is for the page and the JSON. */
#include "identify_show_internal.h"

#include "report/result_internal.h"

#include <stdlib.h>
#include <string.h>

enum { WORDS_MOST = 110 };

static const struct words {
    const char *code;
    const char *clause; /* what it does to which estimates; NULL: it does nothing to them */
    const char *title;  /* NULL: the text of the message is short enough */
} words[] = {
    {"steps", "the slow terms of %s include jumps of the level", "Jumps of the level: %s."},
    {"cycle", "the slow terms of %s include a regular cycle of the level",
     "A level that goes up and down: %s."},
    {"coarse", "the output step is too coarse for the white noise of %s",
     "An output step coarser than the noise: %s."},
    {"saturated", "samples stick at the end of the range in %s",
     "Samples at an extreme value: %s."},
    {"ends", "the values of %s end abruptly, as if they were limited",
     "Values that end abruptly: %s."},
    {"frozen", "samples are repeated in %s, so that the true rate is lower", "Repeats: %s."},
    {"interpolated", "%s {looks|look} interpolated from a slower sensor, so that noise is missing",
     "Interpolated from a slower sensor: %s."},
    {"alternating", "the noise of %s alternates from row to row",
     "Noise that alternates from row to row: %s."},
    {"warm_up", "the slow terms of %s include a start that drifts differently",
     "A start that drifts differently: %s."},
    {"misfit", "the model does not describe %s at all averaging times",
     "Model and log differ: %s."},
    {"trend_left",
     "the slow terms of %s may be the rest of a warm-up or of an effect of temperature",
     "Slow terms beside a warm-up or an effect of temperature: %s."},
    {"moved", NULL, "Moved: %s."},
    {"lost", NULL, "Rows that were lost and written as a number, left out: %s."},
    {"zeros", "values of %s near zero were put to zero, or all were cut off toward zero",
     "More zeros than the noise has: %s."},
    {"filled", "%s {has|have} one value too often, as where samples are filled in",
     "One value more often than the noise has it: %s."},
    {"repeated", "samples of %s repeat the one before", "Repeats of single samples: %s."},
    {"straight", "samples of %s are the means of those beside them",
     "Samples that were interpolated: %s."},
    {"gap", "values are missing among those of %s, as where a bit is stuck",
     "Values that never come: %s."},
    {"dead", "%s {stands|stand} still for a part of the log", "Standing still: %s."},
    {"unrest", "the slow terms of %s are larger than those of a sensor at rest",
     "Fluctuations larger than those of a sensor at rest: %s."},
    {"behind_filter", "the white noise of %s may be larger, behind a low-pass filter",
     "White noise behind a filter, or a fast Gauss-Markov term: %s."},
    {"dropped", "the white noise of %s is too low, because samples far from the level are missing",
     "Samples far from the level are missing: %s."},
    {"noise_changes", "the noise of %s changes with time", "Noise that changes with time: %s."},
    {"bursts", "the noise of %s comes in bursts", "Noise in bursts: %s."},
    {"heavy_tails", "samples far off may be noise or faults in %s",
     "Many samples far off, kept as noise: %s."},
    {"light_tails",
     "the noise of %s has lighter tails than noise has, as behind a stage that saturates softly or "
     "a filter that removes spikes, so that the white noise is too low",
     "Lighter tails than noise has: %s."},
    {"level_held",
     "the level of %s moves less than the rest of the noise tells, as behind a high-pass filter or "
     "an automatic zero, so that slow terms are missing",
     "A level that moves too little: %s."},
    {"undetermined", "a term of %s can take the place of another",
     "Terms that can replace each other: %s."},
    {"stamps:unordered", "rows whose time does not increase are left out", NULL},
    {"stamps:longest_stretch", "only the longest part without missing samples is used", NULL},
    {"stamps:short_stretch", "less than a tenth of the rows is used, as the rest has faults", NULL},
    {"stamps:coarse_stamps", "one stamp is that of several rows",
     "One stamp for several rows, which are counted."},
    {"stamps:bunched", "rows are stamped in bunches", NULL},
    {"stamps:late", "rows are stamped late", NULL},
    {"stamps:jumps", "the clock steps back", NULL},
    {"stamps:doubled", "rows stand twice in the log", NULL},
    {"stamps:two_rates", "the sample interval changes with time", NULL},
    {"stamps:alternate", "long and short steps of the time alternate", NULL},
    {"stamps:held", "rows repeat the samples of a slower sensor", NULL},
    {"stamps:sparse", "a slower sensor has no values in other rows", NULL},
    {"stamps:rate_differs", "the rate stated is not that of the time column", NULL},
    {"uneven_increments", "increments are divided by steps of the time that are not even", NULL},
    {"unused_axis", "an axis is missing, and a column that looks like it is not used", NULL},
    {"unused_sensor", "a sensor that seems to be in the log is not read", NULL},
    {"unknown_channels", "no column is read as one of a gyro or an accelerometer", NULL},
    {"gyro_size", "the numbers of %s are no gyro's at rest: a wrong unit, or the sensor turned",
     "Numbers that no gyro at rest has: %s."},
    {"packets", "rows are written twice in place of others", NULL},
    {"replayed", "a part of the log is written a second time", NULL},
    {"copy", "a column is the copy of another", NULL},
    {"follows", "a column is computed from another", NULL},
    {"correlated", "axes share their noise", NULL},
    {"runs_differ", "the logs do not have the same noise", NULL},
    {"outliers", NULL, "Outliers, left out: %s."},
    {"tails", NULL, "Samples far off, kept as noise: %s."},
    {"gaussian", NULL, "White noise with heavier tails than Gaussian: %s."},
    {"angle_noise", NULL, "White noise of the integral, not rounding: %s."},
    {"ambiguous", NULL, "Terms that the record cannot tell apart: %s."},
    {"walk_or_drift", "a walk or ramp of %s may be jumps or a drift",
     "A walk or ramp that may be jumps or a drift: %s."},
    {"possible_step", "the level of %s may have changed",
     "Slow terms that may include a change of the level: %s."},
    {"stuck", NULL, "Stuck samples, left out: %s."},
    {"at_limit", NULL, "Samples at the end of the range, allowed for: %s."},
    {"warm_up_removed", NULL, "A warm-up at the start, subtracted: %s."},
    {"temperature", NULL, "An effect of temperature, subtracted: %s."},
    {"missing", NULL, "Missing samples, allowed for: %s."},
    {"short", NULL, "Too short for the slowest terms, which are bounded: %s."},
    {"lines", NULL, "Spectral lines, modelled: %s."},
    {"vibration", NULL, "Vibration of what the sensor stands on, in %s."},
    {"resonance", NULL, "Resonances, modelled: %s."},
    {"filtered", NULL, "A low-pass filter in the band, modelled: %s."},
    {"five_terms", NULL, "The five terms alone do not hold at short averaging times: %s."},
};

static const struct words *words_of(const char *code)
{
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++)
        if (strcmp(words[k].code, code) == 0)
            return &words[k];
    return NULL;
}

/* ---- channels -------------------------------------------------------------------------------- */

/* Are all channels of a kind of sensor among these, and are there two of them at least? */
static bool all_of_kind(const imk_even_record *record, uint64_t channels, imk_channel_kind kind)
{
    int count = 0;
    for (size_t c = 0; c < record->count; c++)
        if (imk_channel_kind_of(imk_even_record_column(record, c)) == kind) {
            if (!(channels >> c & 1))
                return false;
            count++;
        }
    return count > 1;
}

static uint64_t without_kind(const imk_even_record *record, uint64_t channels,
                             imk_channel_kind kind)
{
    for (size_t c = 0; c < record->count; c++)
        if (imk_channel_kind_of(imk_even_record_column(record, c)) == kind)
            channels &= ~((uint64_t)1 << c);
    return channels;
}

/* "the gyros, accel_x and accel_z" */
static void name_channels(const imk_even_record *record, uint64_t channels, imki_text *text)
{
    const uint64_t all = ~(uint64_t)0 >> (64 - record->count);
    if (record->count > 2 && channels == all) {
        imki_text_put(text, "all channels");
        return;
    }
    static const struct {
        imk_channel_kind kind;
        const char *name;
    } groups[] = {{IMK_CHANNEL_GYRO, "the gyros"}, {IMK_CHANNEL_ACCEL, "the accelerometers"}};
    const char *names[2 + IMK_LOG_COLUMNS_MAX];
    size_t count = 0;
    for (size_t g = 0; g < 2; g++)
        if (all_of_kind(record, channels, groups[g].kind)) {
            channels = without_kind(record, channels, groups[g].kind);
            names[count++] = groups[g].name;
        }
    for (size_t c = 0; c < record->count; c++)
        if (channels >> c & 1)
            names[count++] = imk_even_record_column(record, c)->name;
    for (size_t k = 0; k < count; k++)
        imki_text_add(text, "%s%s", k == 0 ? "" : k + 1 == count ? " and " : ", ", names[k]);
}

/* A pattern with %s and {one|several} replaced. */
static const char *filled(imk_verdict *v, const char *pattern, const char *names, bool several)
{
    const char *place = strstr(pattern, "%s"), *open = strchr(pattern, '{');
    const char *bar = open ? strchr(open, '|') : NULL, *close = bar ? strchr(bar, '}') : NULL;
    if (close) {
        const char *word = several ? bar + 1 : open + 1, *end = several ? close : bar;
        pattern = imk_result_key(v->result, "%.*s%.*s%s", (int)(open - pattern), pattern,
                                 (int)(end - word), word, close + 1);
        place = strstr(pattern, "%s");
    }
    if (!place)
        return pattern;
    return imk_result_key(v->result, "%.*s%s%s", (int)(place - pattern), pattern, names, place + 2);
}

void imki_verdict_clause(imk_verdict *v, const char *code)
{
    const struct words *w = words_of(code);
    if (!w || !v->message || v->count == 0)
        return;
    imk_message *m = &v->message[v->count - 1];
    m->clause = w->clause;
    m->brief = w->title && !strstr(w->title, "%s") ? w->title : m->brief;
}

void imki_verdict_about(imk_verdict *v, const imk_even_record *record, uint64_t channels)
{
    imki_text names = {.bytes = NULL};
    if (!v->message || v->count == 0)
        return;
    imk_message *m = &v->message[v->count - 1];
    const struct words *w = words_of(m->code);
    m->channels = channels;
    imki_text_put(&names, "");
    if (record)
        name_channels(record, channels, &names);
    if (w && !names.failed && names.bytes) {
        const char *text = names.size > 0 ? names.bytes : "the record";
        const bool several = (channels & (channels - 1)) != 0;
        m->clause = w->clause ? filled(v, w->clause, text, several) : NULL;
        m->brief = w->title ? filled(v, w->title, text, several) : NULL;
        if (v->label && m->brief)
            m->brief = imk_result_key(v->result, "%.200s: %s", v->label, m->brief);
    }
    if (names.failed)
        v->result->arena.failed = true;
    free(names.bytes);
}

/* ---- sentence -------------------------------------------------------------------------------- */

imk_usability imk_verdict_usability(const imk_verdict *v)
{
    const imk_finding_level level = imk_verdict_level(v);
    return level == IMK_FINDING_FAILURE   ? IMK_NOT_USABLE
           : level == IMK_FINDING_WARNING ? IMK_USABLE_WITH_CARE
                                          : IMK_USABLE;
}

static bool has_code(const imk_verdict *v, const char *code)
{
    for (size_t k = 0; k < v->count; k++)
        if (strcmp(v->message[k].code, code) == 0)
            return true;
    return false;
}

/* No doubt: what the record leaves open of the slow terms. */
static const char *usable(const imk_verdict *v)
{
    const char *open = NULL;
    for (size_t k = 0; k < v->count; k++) {
        const imk_message *m = &v->message[k];
        if (m->clause &&
            (strcmp(m->code, "walk_or_drift") == 0 || strcmp(m->code, "possible_step") == 0))
            open = open ? imk_result_key(v->result, "%s, and %s", open, m->clause) : m->clause;
    }
    if (open)
        return imk_result_key(v->result,
                              "Usable for the white noise: no test found a fault, but %s; the "
                              "record cannot tell.",
                              open);
    return has_code(v, "short") ? "Usable for the white noise: no test found a fault, but the "
                                  "record is too short for some slow terms, which are bounded."
                                : "Usable: no test found a fault.";
}

const char *imk_identify_sentence(const imk_verdict *v)
{
    const imk_usability usability = imk_verdict_usability(v);
    const imk_finding_level level =
        usability == IMK_NOT_USABLE ? IMK_FINDING_FAILURE : IMK_FINDING_WARNING;
    if (usability == IMK_USABLE)
        return usable(v);
    imki_reasons reasons = {.result = v->result};
    const char *last = NULL;
    for (size_t k = 0; k < v->count; k++) {
        const imk_message *m = &v->message[k];
        if (m->level != level || (last && m->clause == last)) /* of another sensor, too */
            continue;
        last = m->clause;
        imki_reason(&reasons, "%s", m->clause ? m->clause : m->text);
    }
    return imki_judgement(&reasons, usability, "");
}

/* ---- list ------------------------------------------------------------------------------------ */

static size_t count_words(const char *text)
{
    size_t count = 0;
    for (size_t i = 0; text[i]; i++)
        count += text[i] != ' ' && (i == 0 || text[i - 1] == ' ');
    return count;
}

/* What no log can show is never left out: it belongs to every all-clear. */
static bool is_of_limits(const imk_message *m)
{
    return strcmp(m->code, "not_testable") == 0;
}

static size_t words_of_limits(const imk_verdict *v)
{
    size_t count = 0;
    for (size_t k = 0; k < v->count; k++) {
        const imk_message *m = &v->message[k];
        count += is_of_limits(m) ? count_words(m->brief ? m->brief : m->text) : 0;
    }
    return count;
}

void imki_verdict_briefly(const imk_verdict *v, imk_result *result)
{
    size_t used = count_words(imk_identify_sentence(v)) + words_of_limits(v), left = 0;
    bool more = false;
    for (size_t k = 0; k < v->count; k++) {
        const imk_message *m = &v->message[k];
        const char *text = m->brief ? m->brief : m->text;
        if (strcmp(m->code, "good") == 0 || (m->level >= IMK_FINDING_WARNING && !m->brief))
            continue;
        more = more || m->brief != NULL;
        const bool limits = is_of_limits(m);
        used += limits ? 0 : count_words(text);
        if (used > WORDS_MOST && !limits)
            left++;
        else
            imk_result_line(result, "%s", text);
    }
    if (left > 0)
        imk_result_line(result, "%zu more notes, and all details: --verbose", left);
    else if (more)
        imk_result_line(result, "Details: --verbose");
}
