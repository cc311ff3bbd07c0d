/* SPDX-License-Identifier: Apache-2.0 */
/* What the tables of derived quantities (imk_derived) are made of, for a file that has said
 *
 *     #define DESIGN imk_ring_laser
 *
 * A value is a closed form of the instrument's header, or what one line makes of such. */
#ifndef IMUKI_DERIVED_ROWS_INTERNAL_H
#define IMUKI_DERIVED_ROWS_INTERNAL_H

#include "imukit/instrument.h"

#include <math.h>
#include <stddef.h>

/* The function of a row: `expression` of the design d. */
#define VALUE(name, expression)                                                                    \
    static double name(const void *design)                                                         \
    {                                                                                              \
        const DESIGN *const d = design;                                                            \
        return expression;                                                                         \
    }

/* A quantity that only some designs have: `expression` where `condition`. */
#define VALUE_IF(name, condition, expression) VALUE(name, (condition) ? (expression) : (double)NAN)

#define DERIVED_END                                                                                \
    {                                                                                              \
        NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL                                             \
    }

#endif
