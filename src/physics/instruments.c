/* SPDX-License-Identifier: Apache-2.0 */
/* The kinds of instruments there are. */
#include "base/text_internal.h"
#include "imukit/physics.h"

#include <stdbool.h>

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
