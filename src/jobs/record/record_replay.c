/* SPDX-License-Identifier: Apache-2.0 */
/* Are rows written again, much later?
 *
 * A log that stands twice in its file, or whose logger replays a buffer, has windows of rows that
 * came before, one behind the other and all the same number of rows earlier. Which windows are
 * remembered is decided by their hash, so that a passage has the same ones each time it comes; a
 * limit that falls as the log grows bounds their number.
 *
 * Sound rows come again by chance, where digits are coarse, and do so for a while, where a value
 * follows from the one before. If a passage so far agrees with an earlier one, its next row does so
 * with probability q. Rows that repeat the one before tell nothing, or a sensor that stands still
 * would be a passage; so only changes count, and q is that of a change, of the lag up to 64 where
 * it is largest: noise that is correlated, and a tone in phase. Of n rows, n^2/2 pairs may begin a
 * passage, and q^m are left of them after m changes. */
#include "record_replay_internal.h"

#include "row_keys_internal.h"

#include "jobs/job_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum {
    WINDOW = IMKI_REPLAY_WINDOW,
    SLOTS = IMKI_REPLAY_SLOTS,
    ROWS = 2048,
    LEAST = 256 /* changes in a passage: enough for a q of 0.8, however it was measured */
};

/* Share of the rows written again that is told. */
static const double told = 0.01;
/* Probability of a passage by chance. */
static const double by_chance = 1e-9;

/* Of the hash of a window, the factor from row to row; and what mixes its bits in the end. */
static const uint64_t factor = 0xd1342543de82ef95, mix = 0xbf58476d1ce4e5b9;

static uint64_t power(uint64_t base, int exponent)
{
    uint64_t result = 1;
    for (int k = 0; k < exponent; k++)
        result *= base;
    return result;
}

void imki_replay_start(imki_replay *r)
{
    memset(r, 0, sizeof *r);
    r->limit = UINT64_MAX;
}

/* ---- windows that are remembered --------------------------------------------------------------
 */

/* The slot of a window, or the empty one where it belongs. */
static size_t slot_of(const imki_replay *r, uint64_t hash)
{
    size_t slot = (hash >> 16) % SLOTS;
    while (r->hash[slot] != 0 && r->hash[slot] != hash)
        slot = (slot + 1) % SLOTS;
    return slot;
}

static void remember(imki_replay *r, uint64_t hash, size_t place)
{
    const size_t slot = slot_of(r, hash);
    r->hash[slot] = hash;
    r->place[slot] = place;
    r->earliest = r->remembered == 0 || place < r->earliest ? place : r->earliest;
    r->remembered++;
}

/* Forget every second window. Those that stay are taken out and put in again: in slots from behind
 * an empty one on, none is met twice, since none moves past where it was. */
static void thin_out(imki_replay *r)
{
    size_t first = 0;
    r->limit /= 2;
    r->remembered = 0;
    while (r->hash[first] != 0)
        first++;
    for (size_t k = 1; k < SLOTS; k++) {
        const size_t slot = (first + k) % SLOTS;
        const uint64_t hash = r->hash[slot];
        r->hash[slot] = 0;
        if (hash != 0 && hash < r->limit)
            remember(r, hash, r->place[slot]);
    }
}

/* ---- passages ---------------------------------------------------------------------------------
 */

static void end_passage(imki_replay *r)
{
    imki_passage_again *p = &r->now;
    if (p->lag > 0 && p->changes >= LEAST) {
        r->again += p->last - p->first + WINDOW;
        if (p->changes > r->longest.changes)
            r->longest = *p;
    }
    p->lag = 0;
}

/* A window that came before. */
static void go_on(imki_replay *r, size_t place, size_t earlier)
{
    imki_passage_again *p = &r->now;
    if (p->lag != place - earlier) {
        end_passage(r);
        *p = (imki_passage_again){.lag = place - earlier,
                                  .first = place,
                                  .before = r->changes,
                                  .from_the_start = earlier == r->earliest};
    }
    p->last = place;
    p->changes = r->changes - p->before;
}

static void meet(imki_replay *r, uint64_t hash, size_t place)
{
    const size_t slot = slot_of(r, hash);
    if (r->hash[slot] != 0) {
        go_on(r, place, r->place[slot]);
        return;
    }
    end_passage(r);
    if (r->remembered >= SLOTS / 2)
        thin_out(r);
    if (hash < r->limit)
        remember(r, hash, place);
}

/* Keys that are not the one before. */
static size_t count_changes(size_t first, size_t end, const uint64_t *key)
{
    size_t changes = 0;
    for (size_t i = first; i < end; i++)
        changes += key[i] != key[i - 1];
    return changes;
}

static bool is_whole(const uint64_t *window)
{
    bool whole = true;
    for (int k = 0; k < WINDOW; k++)
        whole = whole && window[k] != 0;
    return whole;
}

/* Rows behind WINDOW keys of those before. Of most rows only the hash is needed. */
static void add_windows(imki_replay *r, size_t rows, const uint64_t *key)
{
    const uint64_t last = power(factor, WINDOW);
    const size_t end = WINDOW + rows;
    uint64_t window = r->window, limit = r->limit;
    size_t counted = WINDOW;
    for (size_t i = WINDOW; i < end; i++) {
        window = window * factor + (key[i] - key[i - WINDOW] * last);
        const uint64_t mixed = window * mix, hash = mixed ^ mixed >> 32;
        if (hash >= limit || hash == 0 || !is_whole(key + i - WINDOW + 1))
            continue;
        r->changes += count_changes(counted, i + 1, key);
        counted = i + 1;
        meet(r, hash, r->rows + i - WINDOW);
        limit = r->limit;
    }
    r->changes += count_changes(counted, end, key);
    r->window = window;
}

void imki_replay_add(imki_replay *r, size_t channels, const int *column, size_t rows,
                     double *const *columns)
{
    uint64_t key[WINDOW + ROWS];
    for (size_t first = 0; first < rows; first += ROWS) {
        const size_t count = rows - first < ROWS ? rows - first : ROWS;
        memcpy(key, r->recent, sizeof r->recent);
        imki_row_keys(channels, column, count, columns, first, key + WINDOW);
        add_windows(r, count, key);
        r->rows += count;
        memcpy(r->recent, key + count, sizeof r->recent);
    }
}

/* Changes that a passage by chance does not have. */
static double changes_beyond_chance(size_t rows, double agreement)
{
    const double n = (double)rows;
    return imk_ln(by_chance / (n * n / 2)) / imk_ln(agreement);
}

void imki_replay_tell(imki_replay *r, double agreement, const char *name, double dt,
                      imk_findings *findings)
{
    end_passage(r);
    const imki_passage_again *p = &r->longest;
    const double share = (double)r->again / (double)r->rows;
    if (p->lag == 0 || share < told ||
        (double)p->changes < changes_beyond_chance(r->rows, agreement))
        return;
    const size_t earlier = p->from_the_start ? 0 : p->first - p->lag - (WINDOW - 1);
    const double from = (double)earlier * dt, again = (double)(earlier + p->lag) * dt;
    imki_find(findings, IMK_FINDING_WARNING, "replayed", name,
              IMKI_NUMBERS(100 * share, again, from));
}
