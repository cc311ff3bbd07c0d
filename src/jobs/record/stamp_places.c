/* SPDX-License-Identifier: Apache-2.0 */
/* The places of rows whose stamps are late.
 *
 * Row i was sampled at a + T (i + L), where L rows are lost before it, and stamped later, at
 *
 *     t_i = a + T (i + L) + d_i,   d_i >= 0.
 *
 * Among any `window` rows one is hardly late, so the lower envelope of t_i - T i steps up by T for
 * each row that is lost, and stays there; a delay that is made up does not move it. How long to
 * wait for that: the window, and four times the rows that the delay is worth (rows that were held
 * back arrive faster than sampled, by a third at least). The lower envelope of delays: [MOON1999].
 */
#include "record_stamps_internal.h"

#include "imukit/samples.h"

#include <math.h>

enum { CATCH_UP = 4, END_ROWS = 8 };

/* A step back of more than this, in intervals, is one of the clock. */
static const double step_back = 0.5, counted_most = 2.0, counted_lost = 3.0;

/* A delay at the end is one of the usual ones up to this multiple of the longest. */
static const double usual_most = 1.3;

/* A loss that is so far from a whole number of rows is none of rows alone. */
static const double odd_rest = 0.25;

typedef struct envelope {
    double before, now; /* least of the blocks before and now [s] */
    size_t left;        /* rows until the next block */
} envelope;

typedef struct places {
    size_t n;
    const double *time;
    imki_stamp_reading *r;
    size_t lost, trusted; /* rows up to here are known to be late */
    double explained;     /* [s] of jumps of the envelope that are no drift */
    envelope least;
} places;

/* How far row i is behind the time of its place, but for a constant [s]. */
static double behind(const places *p, size_t i)
{
    return p->time[i] - p->r->interval * (double)(i + p->lost);
}

static double least_of(const envelope *e)
{
    return fmin(e->before, e->now);
}

/* Least delay of the rows from i on, up to `rows` of them, ends early where it is below the
 * threshold; `at` is that row. In intervals above the envelope. */
static double least_ahead(const places *p, size_t i, size_t rows, size_t *at)
{
    double least = HUGE_VAL;
    const size_t end = rows < p->n - i ? i + rows : p->n;
    const double from = least_of(&p->least), rate = 1.0 / p->r->interval;
    for (*at = i; *at < end; ++*at) {
        if (!isfinite(p->time[*at]))
            continue;
        least = fmin(least, (behind(p, *at) - from) * rate);
        if (least <= p->r->threshold)
            break;
    }
    return least;
}

/* The envelope at the beginning: the least of the first window. */
static void begin_envelope(places *p)
{
    const size_t end = p->r->window < p->n ? p->r->window : p->n;
    p->least = (envelope){HUGE_VAL, HUGE_VAL, p->r->window};
    for (size_t i = 0; i < end; i++)
        if (isfinite(p->time[i]))
            p->least.before = fmin(p->least.before, behind(p, i));
}

static void follow_envelope(places *p, double b)
{
    p->least.now = fmin(p->least.now, b);
    if (--p->least.left > 0)
        return;
    p->least = (envelope){p->least.now, HUGE_VAL, p->r->window};
}

/* Row i is late by e intervals: is that made up, or are rows lost before it? */
static void assess_delay(places *p, size_t i, double e)
{
    imki_stamp_reading *r = p->r;
    size_t at;
    const size_t rows = r->window + (size_t)fmin(CATCH_UP * e, (double)p->n);
    const double stays = least_ahead(p, i, rows, &at);
    /* At the end there may be no time to make it up. */
    const bool too_soon = (double)(p->n - i) < END_ROWS + 2.0 * e && e < usual_most * r->latest;
    if (!(stays > r->threshold && isfinite(stays)) || too_soon) {
        p->trusted = at;
        return;
    }
    const size_t lost = imk_samples_in(stays, 1.0);
    const double rest = stays - (double)lost;
    p->lost += lost;
    if (fabs(rest) > odd_rest) { /* the clock was set, or stood */
        p->explained += rest * r->interval;
        p->least.before += rest * r->interval;
        p->least.now += rest * r->interval;
    }
    r->losses += lost > 0;
    r->lost += lost;
    r->up += fmin((double)lost, counted_lost);
    r->longest_loss = lost > r->longest_loss ? lost : r->longest_loss;
}

/* Earlier than any row before. */
static void step_down(places *p, double b, double e)
{
    imki_stamp_reading *r = p->r;
    r->jumps++;
    r->down += fmin(-e, counted_most);
    r->largest_jump = fmax(r->largest_jump, -e);
    p->explained += e * r->interval;
    p->least.before = p->least.now = b;
}

static void place_row(places *p, size_t i)
{
    double e = (behind(p, i) - least_of(&p->least)) / p->r->interval;
    if (e < -step_back)
        step_down(p, behind(p, i), e);
    else if (e > p->r->threshold && i >= p->trusted)
        assess_delay(p, i, e);
    e = (behind(p, i) - least_of(&p->least)) / p->r->interval;
    p->r->late += e > p->r->usual;
    p->r->latest = fmax(p->r->latest, e);
    follow_envelope(p, behind(p, i));
}

void imki_read_stamps(size_t n, const double *time, imki_stamp_reading *reading, double *even)
{
    places p = {.n = n, .time = time, .r = reading};
    reading->rows = n;
    begin_envelope(&p);
    const double first = p.least.before;
    for (size_t i = 0; i < n; i++) {
        if (isfinite(time[i]))
            place_row(&p, i);
        if (even)
            even[i] = first + reading->interval * (double)(i + p.lost);
    }
    const double last = least_of(&p.least);
    reading->drift = n > 1 ? (last - first - p.explained) / (double)(n - 1 + p.lost) : 0.0;
}
