/* SPDX-License-Identifier: Apache-2.0 */
/* Tables of the units and dimensions, and what the reader and writer of units share. */
#ifndef IMUKIT_UNIT_TABLE_INTERNAL_H
#define IMUKIT_UNIT_TABLE_INTERNAL_H

#include "imukit/units.h"

enum {
    IMKI_DIMENSIONS = 7,
    /** Longest name of a unit after µ and ° are spelled out, with its terminating zero. */
    IMKI_UNIT_NAME_SIZE = 32,
    /** Longest text in SI base units, "count^29.5*kg^29.5*…/sqrt(Hz)", with room. */
    IMKI_SI_TEXT_SIZE = 96
};

/** A unit with a name of its own. */
typedef struct imki_named_unit {
    const char *name;
    double scale;
    double offset;
    imk_dimension dimension;
    bool is_hertz; /**< Hz or a multiple: its root makes a density */
} imki_named_unit;

/** How many units have names. */
size_t imki_unit_count(void);

/** By exact name, µ as u and ° as deg; NULL when unknown. */
const imki_named_unit *imki_unit_find(const char *name);

/** The known name nearest to `name`; NULL when none is near. */
const char *imki_unit_nearest(const char *name);

/** True when imk_dimension_name() has a name for it. */
bool imki_dimension_known(imk_dimension dimension);

/** Text of the SI base units of a dimension, like "rad/s^1.5" or "m/s^2/sqrt(Hz)". */
void imki_unit_si_text(imk_dimension dimension, bool per_root_hertz, char text[IMKI_SI_TEXT_SIZE]);

/** First character that is not blank. */
static inline const char *imki_skip_blanks(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    return at;
}

/** The first character behind `text` when [at, end) starts with it; else NULL. */
const char *imki_match(const char *at, const char *end, const char *text);

#endif
