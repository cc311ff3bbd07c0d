/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of the noise of a channel: the contrast (noise_contrast.c) that is least probable over
 * all octaves, or in slow noise as a whole, splits the record, and its parts are searched again,
 * until nothing is found at the significance (of an octave: over the number of octaves). Then each
 * part gets its N and B. */
#include "imukit/elementary.h"
#include "noise_map_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x401E3A90, BOUNDARIES = IMK_NOISE_SEGMENTS_MAX + 1 };

static const double PI = 3.14159265358979323846;

/* A change of a deviation that is smaller matters nowhere: an estimate of the whole record then
 * moves by less than 2 %. */
static const double smallest_change = 0.015;

imk_noise_changes_settings imk_noise_changes_default(void)
{
    return (imk_noise_changes_settings){.cookie = COOKIE, .confidence = 0.95, .significance = 1e-3};
}

static imk_status check(const imk_noise_changes_settings *s, imk_error *error)
{
    if (!s || s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_noise_changes_default()");
    if (!(s->dt > 0 && s->dt < HUGE_VAL) || !(s->confidence > 0 && s->confidence < 1) ||
        !(s->significance > 0 && s->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, confidence in (0, 1), significance in (0, 0.5)");
    return IMK_OK;
}

/* Do squared differences of a tone of frequency f, a step apart, come back to nearly the same
 * phase, so that they beat more slowly than columns can average? */
static bool beats_slowly(const imk_noise_map *map, double cycles, double step)
{
    const double turns = 2 * cycles * step;
    return fabs(turns - floor(turns + 0.5)) * (double)map->block / step < 1.5;
}

/* Is a part of an octave a tone, or a resonance as narrow as one, whose beats would look like
 * changes? */
static bool beats(const imk_noise_map *map, const imk_identification *identified, double dt,
                  const imki_noise_shares *shares, size_t octave)
{
    const size_t m = (size_t)1 << octave;
    const double step = 2 * (double)m, least = 0.002 * imki_noise_total(shares, octave);
    bool any = false;
    for (int i = 0; i < identified->sinusoid_count; i++) {
        const imk_sinusoid tone = identified->sinusoid[i];
        any = any || (imk_sinusoid_sampled_allan_variance(tone, dt, m) > least &&
                      beats_slowly(map, tone.frequency * dt, step));
    }
    for (int i = 0; i < identified->resonance_count; i++) {
        const imk_resonance ring = identified->resonance[i];
        const double memory = ring.q / (2 * PI * ring.frequency * dt);
        any = any || (memory > 0.25 * (double)map->block &&
                      imk_resonance_sampled_allan_variance(ring, dt, m) > least &&
                      beats_slowly(map, ring.frequency * dt, step));
    }
    return any;
}

/* Coarse steps make the noise that is left by rounding depend on the level. */
static bool is_rounded_away(const imk_noise_map *map, const imk_identification *identified,
                            size_t octave)
{
    const imk_estimate fast = imk_noise_map_deviation(map, 0, 0, IMK_NOISE_MAP_BLOCKS, 0.95);
    const imk_estimate here = imk_noise_map_deviation(map, octave, 0, IMK_NOISE_MAP_BLOCKS, 0.95);
    return fast.value < 0.5 * identified->resolution && here.value < 2 * identified->resolution;
}

/* The tests of a search: each octave, and the slow noise of all octaves together. */
enum { SLOW = IMK_NOISE_MAP_OCTAVES, TESTS };

/* Everything a search needs. */
typedef struct search {
    const imk_noise_map *map;
    double significance;
    size_t octaves, tested_count;
    unsigned tested, changed;
    imki_noise_band slow;
    unsigned slow_octaves; /* those that slow noise dominates; 0: it is not tested */
    double expected[IMK_NOISE_MAP_OCTAVES], /* scatter by the model's resonances */
        scatter[IMK_NOISE_MAP_OCTAVES];     /* of the record; 0: too few differences */
    size_t boundary_count, boundary[BOUNDARIES];
    imki_noise_contrast contrast[BOUNDARIES]; /* the least probable one after each boundary */
    size_t test[BOUNDARIES];
    unsigned also[BOUNDARIES]; /* octaves that change significantly somewhere in the part */
    bool transition[IMK_NOISE_MAP_BLOCKS]; /* columns within which the noise changes */
    double probability;
} search;

static void choose_octaves(search *s, const imk_identification *identified,
                           const imki_noise_shares *shares, double dt)
{
    for (size_t j = 0; j < s->octaves; j++) {
        const imk_noise_cell all = imki_noise_cells(s->map, j, 0, IMK_NOISE_MAP_BLOCKS);
        if (!(all.square > 0) || is_rounded_away(s->map, identified, j) ||
            beats(s->map, identified, dt, shares, j))
            continue;
        s->tested |= 1u << j;
        s->tested_count++;
        s->expected[j] = imki_noise_expected_scatter(identified, dt, shares, j);
        s->scatter[j] = imki_noise_scatter(s->map, j, 0, imk_noise_map_blocks(s->map));
    }
}

/* The octaves of few differences, by the share of slow noise. Each alone holds too little to see it
 * become twice as strong, and in many short columns the probability of the largest difference by
 * chance is high: they are tested together, in eighths of the record. */
static void choose_slow(search *s, const imki_noise_shares *shares)
{
    enum { PARTS = 8 };
    static const double least = 0.1, most = 0.5;
    s->slow.joined = (imk_noise_map_blocks(s->map) + PARTS - 1) / PARTS;
    for (size_t j = 0; j < s->octaves; j++) {
        const double total = imki_noise_total(shares, j), share = shares->slow[j] / total;
        if (!(s->tested >> j & 1) || s->scatter[j] > 0 || !(share > least))
            continue;
        s->slow.share[j] = share;
        s->slow.scale[j] = 0.5 / total;
        s->slow_octaves |= share > most ? 1u << j : 0;
    }
}

static double scatter_for(const search *s, size_t octave, size_t low, size_t high)
{
    const double own = imki_noise_scatter(s->map, octave, low, high);
    const double scatter = own > 0 ? own : s->scatter[octave];
    return scatter > 0 ? fmax(scatter, s->expected[octave]) : 0;
}

static bool is_tested(const search *s, size_t test)
{
    return test == SLOW ? s->slow_octaves != 0 : s->tested >> test & 1;
}

static unsigned octaves_of(const search *s, size_t test)
{
    return test == SLOW ? s->slow_octaves : 1u << test;
}

/* How often a test is more likely to alarm than if it were alone: the octaves share a significance,
 * slow noise has its own. */
static double tries(const search *s, size_t test)
{
    return test == SLOW ? 1 : (double)s->tested_count;
}

/* The least probable contrast between a boundary and the next. */
static void search_part(search *s, size_t part)
{
    const size_t low = s->boundary[part], high = s->boundary[part + 1];
    imki_noise_contrast *best = &s->contrast[part];
    *best = (imki_noise_contrast){low, high, 1, 0};
    s->also[part] = 0;
    for (size_t test = 0; test < TESTS && high > low + 1; test++) {
        if (!is_tested(s, test))
            continue;
        const imki_noise_band band = test == SLOW ? s->slow : imki_noise_octave(test);
        const double scatter = test == SLOW ? 0 : scatter_for(s, test, low, high);
        imki_noise_contrast c = imki_noise_contrast_find(s->map, &band, low, high, scatter);
        c.probability = fmin(1, c.probability * tries(s, test));
        s->also[part] |= c.probability < s->significance ? octaves_of(s, test) : 0;
        if (c.probability < best->probability ||
            (c.probability == 0 && best->probability == 0 && c.size > best->size)) {
            *best = c;
            s->test[part] = test;
        }
    }
}

static void insert_boundary(search *s, size_t place)
{
    size_t k = 0;
    while (k < s->boundary_count && s->boundary[k] < place)
        k++;
    if (k < s->boundary_count && s->boundary[k] == place)
        return;
    for (size_t i = s->boundary_count; i > k; i--) {
        s->boundary[i] = s->boundary[i - 1];
        s->contrast[i] = s->contrast[i - 1];
        s->test[i] = s->test[i - 1];
        s->also[i] = s->also[i - 1];
    }
    s->boundary[k] = place;
    s->boundary_count++;
}

static size_t least_probable(const search *s)
{
    size_t best = 0;
    for (size_t p = 1; p + 1 < s->boundary_count; p++)
        if (s->contrast[p].probability < s->contrast[best].probability)
            best = p;
    return best;
}

static void split(search *s)
{
    s->boundary_count = 2;
    s->boundary[0] = 0;
    s->boundary[1] = imk_noise_map_blocks(s->map);
    search_part(s, 0);
    s->probability = s->contrast[0].probability;
    while (s->tested_count > 0 && s->boundary_count + 2 <= BOUNDARIES) {
        const size_t part = least_probable(s);
        const imki_noise_contrast found = s->contrast[part];
        if (!(found.probability < s->significance))
            return;
        s->changed |= octaves_of(s, s->test[part]) | s->also[part];
        insert_boundary(s, found.first);
        insert_boundary(s, found.end);
        for (size_t p = 0; p + 1 < s->boundary_count; p++)
            search_part(s, p);
    }
}

/* Do the parts on both sides of a boundary differ in any octave? */
static bool is_needed(const search *s, size_t k)
{
    const size_t low = s->boundary[k - 1], high = s->boundary[k + 1];
    for (size_t test = 0; test < TESTS; test++) {
        if (!is_tested(s, test))
            continue;
        const double scatter = test == SLOW ? 0 : scatter_for(s, test, low, high);
        imki_noise_band band = test == SLOW ? s->slow : imki_noise_octave(test);
        band.joined = 1; /* the place is given */
        if (tries(s, test) * imki_noise_compare(s->map, &band, low, s->boundary[k], high, scatter) <
            s->significance)
            return true;
    }
    return false;
}

static void remove_boundary(search *s, size_t k)
{
    s->boundary_count--;
    for (size_t i = k; i < s->boundary_count; i++)
        s->boundary[i] = s->boundary[i + 1];
}

/* Mean square of part k in the shortest octave that changed. */
static double level_of(const search *s, size_t k)
{
    size_t octave = 0;
    while (!(s->changed >> octave & 1))
        octave++;
    const imk_noise_cell part =
        imki_noise_cells(s->map, octave, s->boundary[k], s->boundary[k + 1]);
    return part.count > 0 ? part.square / part.count : 0;
}

/* Is part k the one column in which the noise changes from that before to that behind it? */
static bool is_transition(const search *s, size_t k)
{
    if (k == 0 || k + 2 >= s->boundary_count || s->boundary[k + 1] != s->boundary[k] + 1)
        return false;
    const double before = level_of(s, k - 1), here = level_of(s, k), after = level_of(s, k + 1);
    return (here - before) * (after - here) > 0;
}

/* A later split may make one before it superfluous; a change within a column makes two. */
static void prune(search *s)
{
    for (size_t k = 1; k + 1 < s->boundary_count && s->boundary_count > 3;)
        if (is_needed(s, k))
            k++;
        else
            remove_boundary(s, k);
    for (size_t k = 1; k + 2 < s->boundary_count; k++)
        if (is_transition(s, k)) {
            const double before = level_of(s, k - 1), here = level_of(s, k);
            const double after = level_of(s, k + 1);
            s->transition[s->boundary[k]] = true;
            remove_boundary(s, fabs(here - before) < fabs(after - here) ? k : k + 1);
        }
}

/* Logarithm of the ratio of deviations of a segment and of the record, and its variance. */
static double change_of(const search *s, size_t octave, size_t segment, double *variance)
{
    const imk_noise_cell part =
        imki_noise_cells(s->map, octave, s->boundary[segment], s->boundary[segment + 1]);
    const imk_noise_cell all = imki_noise_cells(s->map, octave, 0, IMK_NOISE_MAP_BLOCKS);
    *variance = 0.5 / fmax(part.count, 1);
    return part.square > 0 ? 0.5 * imk_ln(part.square / part.count / (all.square / all.count)) : 0;
}

/* The octave, of those that changed, and the segment whose deviation is farthest from the record's,
 * by two standard deviations less. */
static void describe(const search *s, double confidence, imk_noise_changes *r)
{
    double largest = -HUGE_VAL, variance;
    r->ratio = 1;
    for (size_t j = 0; j < s->octaves; j++)
        for (size_t k = 0; k < r->segment_count && (s->changed >> j & 1); k++) {
            const double size = fabs(change_of(s, j, k, &variance)) - 2 * sqrt(variance);
            if (!(size > largest))
                continue;
            largest = size;
            r->octave = j;
            r->strange = k;
        }
    if (s->changed == 0)
        return;
    r->deviation = imk_noise_map_deviation(s->map, r->octave, s->boundary[r->strange],
                                           s->boundary[r->strange + 1], confidence)
                       .value;
    r->of_record =
        imk_noise_map_deviation(s->map, r->octave, 0, IMK_NOISE_MAP_BLOCKS, confidence).value;
    r->ratio = r->deviation / r->of_record;
}

/* Do all octaves in which a term dominates change alike, so that the term changes? */
static bool is_of_term(const search *s, const imk_noise_changes *r, const imki_noise_shares *shares,
                       const double *part)
{
    double own, variance;
    const double size = change_of(s, r->octave, r->strange, &own);
    if (!(part[r->octave] > 0.5 * imki_noise_total(shares, r->octave)))
        return false;
    for (size_t j = 0; j < s->octaves; j++) {
        const double other = change_of(s, j, r->strange, &variance);
        if (part[j] > 0.8 * imki_noise_total(shares, j) && (s->tested >> j & 1) &&
            fabs(other - size) > 4 * sqrt(variance + own) + 0.3 * fabs(size))
            return false;
    }
    return true;
}

static bool matters(const imk_noise_changes *r, const imk_identification *identified)
{
    const imk_estimate *n = &identified->term[IMK_NOISE_WHITE];
    const double half = n->present ? 0.5 * (n->upper - n->lower) / n->value : 0;
    return fabs(r->ratio - 1) > fmax(smallest_change, fmin(half, 0.1));
}

imk_status imk_noise_changes_find(const imk_noise_changes_settings *settings,
                                  const imk_noise_map *map, const imk_identification *identified,
                                  imk_noise_changes *result, imk_error *error)
{
    const imk_status status = check(settings, error);
    if (status != IMK_OK)
        return status;
    imki_noise_shares shares;
    search s = {
        .map = map, .significance = settings->significance, .octaves = imk_noise_map_octaves(map)};
    imk_noise_changes r = {.scatter = 1};
    imki_noise_shares_find(identified, settings->dt, s.octaves, &shares);
    choose_octaves(&s, identified, &shares, settings->dt);
    choose_slow(&s, &shares);
    split(&s);
    prune(&s);
    r.tested = s.tested;
    r.changed = s.changed;
    r.probability = s.probability;
    r.segment_count = s.boundary_count - 1;
    for (size_t k = 0; k < r.segment_count; k++) {
        imk_noise_segment *segment = &r.segment[k];
        segment->first = s.boundary[k] * map->block;
        segment->end = s.boundary[k + 1] * map->block;
        segment->end = segment->end < map->samples ? segment->end : map->samples;
    }
    describe(&s, settings->confidence, &r);
    r.term = is_of_term(&s, &r, &shares, shares.white)     ? IMK_NOISE_WHITE
             : is_of_term(&s, &r, &shares, shares.flicker) ? IMK_NOISE_BIAS_INSTABILITY
                                                           : IMK_NOISE_TERMS;
    shares.skipped = r.term == IMK_NOISE_TERMS ? r.changed : 0;
    for (size_t k = 0; k < r.segment_count; k++) {
        const size_t low = s.boundary[k], high = s.boundary[k + 1];
        imki_noise_strengths(map, &shares, identified, settings->confidence,
                             low + (s.transition[low] && low + 1 < high),
                             high - (high > low + 1 && s.transition[high - 1]), &r.segment[k]);
    }
    r.matters = r.changed != 0 && matters(&r, identified);
    imki_noise_tails(map, settings, identified, &shares, &r);
    *result = r;
    return IMK_OK;
}
