/* SPDX-License-Identifier: Apache-2.0 */
/* Values that end abruptly.
 *
 * Near its largest value noise is rare: of n Gaussian samples some three are within a quarter of a
 * standard deviation of the largest, since the density falls by exp(-z/4) over that distance and z
 * is 4 to 6. Where readings are clipped and then calibrated, folded back, wrapped around,
 * rectified, compressed, or dropped by value, many are. So that one slow wave is no crowd, samples
 * are counted in pieces of 64, once each: the largest of a piece is kept, if it is among the 64
 * largest. */
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { PIECE = 64, CROWD = 30 };

static const double near = 0.25; /* of the standard deviation */

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

bool imki_edge_is_abrupt(const imki_edges *e, double deviation, double step)
{
    size_t crowd = 0;
    const double within = fmax(near * deviation, 0.6 * step);
    if (step > 2 * near * deviation)
        return false;
    while (crowd < e->count && e->largest[0] - e->largest[crowd] < within)
        crowd++;
    return crowd >= CROWD;
}
