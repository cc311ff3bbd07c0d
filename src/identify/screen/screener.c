/* SPDX-License-Identifier: Apache-2.0 */
/* Screening of one channel that passes by. Samples are gathered in chunks at fixed places of the
 * record. A chunk is decided when the next one is there, in the order in which one fault would hide
 * another: missing samples, runs of one value, outliers, values that pile up at an end; what is
 * left goes into the levels of the whole record, whose jumps and trends are found at the end. */
#include "screener_internal.h"

#include "base/workspace_internal.h"
#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum {
    COOKIE = 0x5C4EE401,
    CHUNK = IMKI_SCREEN_CHUNK,
    BLOCK = IMKI_BLOCK,
    MARGIN = 2 * IMKI_SCREEN_REACH + 2,
    RESOLVED_EVERY = 8, /* chunks whose values are looked at for a step */
    RESOLVED_OF = 2048, /* samples of them */
    CORE_EVERY = 4,     /* chunks whose median deviation is taken */
    EDGES_EVERY = 2     /* chunks whose largest values are looked at */
};

imk_screen_settings imk_screen_default(void)
{
    return (imk_screen_settings){.cookie = COOKIE, .false_alarm = 1e-3, .significance = 1e-3};
}

static void lay_out(imk_screener *s, imki_parts *parts)
{
    const size_t row = CHUNK * sizeof(double);
    const size_t begin = parts->used;
    s->room = imki_take(parts, row);
    s->raw[0] = s->room;
    s->raw[1] = imki_take(parts, row);
    s->warm[0] = imki_take(parts, row);
    s->warm[1] = imki_take(parts, row);
    s->loose = imki_take(parts, row);
    s->clean = imki_take(parts, row);
    s->value = imki_take(parts, row + MARGIN * sizeof(double));
    s->room_count = (parts->used - begin) / sizeof(double);
    s->place = imki_take(parts, (CHUNK + 1) * sizeof *s->place);
    s->mark = imki_take(parts, CHUNK);
}

size_t imk_screener_size(void)
{
    imk_screener unused;
    imki_parts parts = imki_parts_of(NULL);
    imki_take(&parts, sizeof unused);
    lay_out(&unused, &parts);
    return imki_parts_size(&parts);
}

static imk_status check(const imk_screen_settings *s, size_t memory_size, imk_error *error)
{
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_screen_default()");
    if (!(s->dt > 0 && s->dt < HUGE_VAL) || !(s->false_alarm > 0 && s->false_alarm < 0.5) ||
        !(s->significance > 0 && s->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, false_alarm and significance in (0, 0.5)");
    if (memory_size < imk_screener_size())
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", NULL,
                             "imk_screener_size() bytes");
    return IMK_OK;
}

imk_status imk_screener_begin(const imk_screen_settings *settings, unsigned what,
                              imk_screen_sink sink, void *context, imk_screener **screener,
                              void *memory, size_t memory_size, imk_error *error)
{
    const imk_status status = check(settings, memory_size, error);
    if (status != IMK_OK)
        return status;
    imki_parts parts = imki_parts_of(memory);
    imk_screener *s = imki_take(&parts, sizeof *s);
    memset(s, 0, sizeof *s);
    lay_out(s, &parts);
    s->settings = *settings;
    s->what = what;
    s->sink = sink;
    s->context = context;
    s->z = -imk_normal_quantile(settings->false_alarm / (2 * imki_screen_samples));
    s->last = s->run_value = (double)NAN;
    s->found.outliers.first = s->found.stuck.first = s->found.missing.first = s->found.lost.first =
        SIZE_MAX;
    imki_edges_begin(&s->upper);
    imki_edges_begin(&s->lower);
    imki_levels_begin(&s->levels);
    imki_cycles_begin(&s->cycles);
    *screener = s;
    return IMK_OK;
}

/* ---- a new chunk ----------------------------------------------------------------------------- */

static bool all_there(size_t count, const double *x)
{
    bool all = true;
    for (size_t i = 0; i < count; i++)
        all &= x[i] - x[i] == 0;
    return all;
}

/* What is not finite is missing. */
static void count_missing(imk_screener *s, size_t first, size_t count, double *samples)
{
    imk_screen *f = &s->found;
    for (size_t i = 0; i < count; i++) {
        if (imki_is_there(samples[i])) {
            s->counting.run = 0;
            continue;
        }
        samples[i] = (double)NAN;
        f->missing.first = f->missing.count++ == 0 ? first + i : f->missing.first;
        f->missing.runs += s->counting.run++ == 0;
        f->longest_hole = s->counting.run > f->longest_hole ? s->counting.run : f->longest_hole;
    }
}

static void find_step(imk_screener *s, size_t index, size_t count, const double *samples)
{
    if (index % RESOLVED_EVERY != 0)
        return;
    const size_t of = index == 0 ? CHUNK : RESOLVED_OF;
    s->step = imki_record_resolution(count, samples, s->value, of < count ? of : count);
}

/* The chunk raw[at] is complete. */
static void take_chunk(imk_screener *s, int at)
{
    const size_t index = s->chunk + (size_t)at, count = s->count[at];
    double *samples = s->raw[at];
    s->found.n += count;
    const size_t before = s->found.missing.count;
    const bool whole = all_there(count, samples);
    if (whole)
        s->counting.run = 0;
    else
        count_missing(s, index * CHUNK, count, samples);
    imki_screen_moments(s, at, s->found.missing.count - before);
    imki_screen_repeats(s, at, whole);
}

/* ---- a decided chunk ------------------------------------------------------------------------- */

/* The chunk without samples that have one of these marks. */
static void mark_out(const imk_screener *s, unsigned marks, double *out)
{
    memcpy(out, s->raw[0], s->count[0] * sizeof *out);
    for (size_t i = 0; s->marked && i < s->count[0]; i++)
        out[i] = s->mark[i] & marks ? (double)NAN : out[i];
}

/* To the sink, without what is to be taken out. */
static void hand_on(imk_screener *s)
{
    const unsigned stuck = s->what & IMK_SCREEN_STUCK ? IMKI_MARK_STUCK : 0;
    if (!s->sink)
        return;
    mark_out(s, stuck, s->loose);
    if (s->what & IMK_SCREEN_OUTLIERS)
        mark_out(s, stuck | IMKI_MARK_OUTLIER, s->clean);
    const double *given = s->what & IMK_SCREEN_OUTLIERS ? s->clean : s->loose;
    s->sink(s->context, s->count[0], s->loose, given);
}

static void add_ends(imk_screener *s)
{
    double low, high;
    const size_t place = s->chunk * CHUNK;
    imki_screen_extremes(s->count[0], s->clean, &low, &high);
    const imki_ends *top = &s->high, *bottom = &s->low;
    if (top->distinct < IMKI_SCREEN_ENDS || high >= top->value[IMKI_SCREEN_ENDS - 1])
        imki_ends_add(&s->high, place, s->count[0], s->clean, 1);
    if (bottom->distinct < IMKI_SCREEN_ENDS || -low >= bottom->value[IMKI_SCREEN_ENDS - 1])
        imki_ends_add(&s->low, place, s->count[0], s->clean, -1);
}

/* Decide raw[0]; raw[1] is the next chunk, of no samples at the end. */
static void decide(imk_screener *s)
{
    memset(s->mark, 0, s->count[0]);
    s->marked = false;
    find_step(s, s->chunk, s->count[0], s->raw[0]);
    imki_screen_stuck(s);
    imki_screen_lost(s);
    if (s->marked) { /* a code for lost rows is no value */
        mark_out(s, IMKI_MARK_STUCK, s->loose);
        find_step(s, s->chunk, s->count[0], s->loose);
    }
    s->found.resolution = fmax(s->found.resolution, s->step);
    imki_screen_outliers(s);
    hand_on(s);
    mark_out(s, IMKI_MARK_STUCK, s->loose);
    mark_out(s, IMKI_MARK_STUCK | IMKI_MARK_OUTLIER, s->clean);
    imki_screen_variances(s);
    if (s->chunk % CORE_EVERY == 0)
        imki_screen_core(s);
    imki_screen_zeros(s);
    imki_screen_frequent(s);
    imki_screen_serial(s);
    add_ends(s);
    if (s->chunk % EDGES_EVERY == 0)
        imki_edges_add(&s->upper, &s->lower, s->count[0], s->clean);
    imki_cycles_add(&s->cycles, s->chunk, s->count[0], s->clean, s->step, s->value);
    imki_levels_add(&s->levels, s->count[0], s->clean, s->thermal ? s->warm[0] : NULL);
    s->chunk++;
}

static void rotate(imk_screener *s)
{
    double *raw = s->raw[0], *warm = s->warm[0];
    s->raw[0] = s->raw[1];
    s->raw[1] = raw;
    s->warm[0] = s->warm[1];
    s->warm[1] = warm;
    s->count[0] = s->count[1];
    s->count[1] = 0;
    s->lowest[0] = s->lowest[1];
    s->highest[0] = s->highest[1];
    s->chunk_repeats[0] = s->chunk_repeats[1];
    s->chunk_whole[0] = s->chunk_whole[1];
    s->chunk_repeats[1] = 0;
}

void imk_screener_add(imk_screener *s, size_t count, const double *samples,
                      const double *temperature)
{
    s->thermal = s->thermal || temperature;
    for (size_t done = 0; done < count;) {
        const int at = s->count[0] == CHUNK;
        const size_t room = CHUNK - s->count[at], left = count - done;
        const size_t part = left < room ? left : room;
        memcpy(s->raw[at] + s->count[at], samples + done, part * sizeof *samples);
        if (temperature)
            memcpy(s->warm[at] + s->count[at], temperature + done, part * sizeof *samples);
        for (size_t i = s->count[at]; s->thermal && i < s->count[at] + part; i++)
            s->warm[at][i] =
                temperature && imki_is_there(s->warm[at][i]) ? s->warm[at][i] : (double)NAN;
        s->count[at] += part;
        done += part;
        if (s->count[at] < CHUNK)
            continue;
        take_chunk(s, at);
        if (at == 1) {
            decide(s);
            rotate(s);
        }
    }
}

void imki_screen_flush(imk_screener *s)
{
    const int at = s->count[0] == CHUNK;
    if (s->count[at] > 0)
        take_chunk(s, at);
    while (s->count[0] > 0) {
        decide(s);
        rotate(s);
    }
}

imk_status imk_screener_finish(imk_screener *s, imk_screen *found, imk_error *error)
{
    enum { PRESENT_MIN = 64 };
    imki_screen_flush(s);
    if (s->found.present < PRESENT_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, NULL, NULL,
                             "at least 64 samples that are not missing");
    if (s->norm == 0)
        return imk_error_set(error, IMK_ERROR_CONSTANT, NULL, NULL,
                             "a channel that changes: check its wiring and driver");
    imki_screen_conclude(s);
    *found = s->found;
    return IMK_OK;
}
