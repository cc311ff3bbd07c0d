/* SPDX-License-Identifier: Apache-2.0 */
/* The kinds of instruments there are, and what follows from their designs. */
#include "base/text_internal.h"
#include "imukit/physics.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define DESCRIPTION(name) &imk_##name##_instrument,
static const imk_instrument *const instruments[] = {IMK_INSTRUMENT_LIST(DESCRIPTION)};
enum { INSTRUMENTS = sizeof instruments / sizeof instruments[0] };

size_t imk_instrument_count(void)
{
    return INSTRUMENTS;
}

const imk_instrument *imk_instrument_get(size_t index)
{
    return index < INSTRUMENTS ? instruments[index] : NULL;
}

static bool is_separator(char c)
{
    return c == ' ' || c == '-' || c == '_';
}

static bool same_name(const char *a, const char *b)
{
    for (;;) {
        while (is_separator(*a))
            a++;
        while (is_separator(*b))
            b++;
        if (imki_lower(*a) != imki_lower(*b))
            return false;
        if (*a == '\0')
            return true;
        a++;
        b++;
    }
}

const imk_instrument *imk_instrument_find(const char *name)
{
    for (size_t i = 0; name && i < INSTRUMENTS; i++)
        if (same_name(name, instruments[i]->name))
            return instruments[i];
    return NULL;
}

/* ---- derived quantities ---------------------------------------------------------------------- */

const imk_derived *imk_instrument_derived(const imk_instrument *instrument, const char *name)
{
    for (const imk_derived *d = instrument->derived; name && d->name; d++)
        if (strcmp(d->name, name) == 0 || strcmp(d->symbol, name) == 0)
            return d;
    return NULL;
}

double imk_derived_value(const imk_derived *derived, const void *design)
{
    const double value = derived->value(design);
    return isfinite(value) ? value : (double)NAN;
}
