/* SPDX-License-Identifier: Apache-2.0 */
/* Samples that are equal to something more often than noise is: in which chunks they are counted,
 * and when they are too many. All of the first chunks count, so that a short record has as many as
 * it can have, and of later ones every eighth.
 *
 * An excess counts if it moves the white noise by some 2 %, is more than the error of what is due,
 * and six standard deviations: 1e-9 by chance. */
#include "screener_internal.h"

#include <math.h>

enum { EVERY = 8 };

static const double deviations = 6;
static const double coarsest = 1.4; /* step over scale: beyond it rounding is no noise */

bool imki_screen_has_noise(const imk_screener *s)
{
    return s->scale > 0 && s->step <= coarsest * s->scale;
}

bool imki_screen_counts(size_t chunk)
{
    return chunk < IMKI_SCREEN_EARLY || chunk % EVERY == 0;
}

double imki_excess_share(const imki_excess *e, double least, double factor)
{
    const double excess = e->counted - e->due;
    return excess > least * e->samples && e->counted > factor * e->due &&
                   excess > deviations * sqrt(e->variance)
               ? excess / e->samples
               : 0;
}
