/* SPDX-License-Identifier: Apache-2.0 */
/* Values that end abruptly.
 *
 * Near its largest value noise is rare: the density of n Gaussian samples falls by exp(-z w) over w
 * standard deviations there, with a z of at most sqrt(2 ln n). That k samples or more are within w
 * of the largest and none is beyond has the probability (1 - exp(-z w))^(k-1), as of the smallest
 * of a Poisson process; heavier tails have fewer. Where readings are clipped and then calibrated,
 * folded back, wrapped around, rectified, compressed, or dropped by value, there are many. So that
 * one slow wave is no crowd, samples are counted in pieces of 64, once each: the largest of a piece
 * is kept, if it is among the 256 largest. Values in steps are counted by whole steps. */
#include "screener_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

enum { PIECE = 64 };

static const double near = 0.25;      /* of the standard deviation */
static const double by_chance = 1e-6; /* for one end of a channel */

void imki_edges_begin(imki_edges *e)
{
    e->count = 0;
}

/* The list is in order, the largest first. */
static void enter(imki_edges *e, double value)
{
    const bool full = e->count == IMKI_EDGE_PIECES;
    if (full && !(value > e->largest[IMKI_EDGE_PIECES - 1]))
        return;
    size_t at = full ? IMKI_EDGE_PIECES - 1 : e->count++;
    for (; at > 0 && e->largest[at - 1] < value; at--)
        e->largest[at] = e->largest[at - 1];
    e->largest[at] = value;
}

void imki_edges_add(imki_edges *high, imki_edges *low, size_t count, const double *samples)
{
    for (size_t i = 0; i + PIECE <= count; i += PIECE) {
        double least, most;
        imki_screen_extremes(PIECE, samples + i, &least, &most);
        if (!(least <= most))
            continue;
        enter(high, most);
        enter(low, -least);
    }
}

/* How many samples noise does not have within some standard deviations of its largest. */
static double crowd_beyond_chance(size_t samples, double within)
{
    const double fall = sqrt(2 * imk_ln((double)samples)) * within;
    return 1 + imk_ln(by_chance) / imk_ln1p(-imk_exp(-fall));
}

bool imki_edge_is_abrupt(const imki_edges *e, size_t samples, double deviation, double step)
{
    size_t crowd = 0;
    const double within = fmax(near * deviation, 0.6 * step);
    if (samples < PIECE || step > 2 * near * deviation || !(deviation > 0))
        return false;
    while (crowd < e->count && e->largest[0] - e->largest[crowd] < within)
        crowd++;
    const double whole = step > 0 ? step * ceil(within / step) : within;
    return (double)crowd >= crowd_beyond_chance(samples, whole / deviation);
}
