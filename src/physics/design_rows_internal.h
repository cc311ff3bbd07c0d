/* SPDX-License-Identifier: Apache-2.0 */
/* The rows of the table of a design's parameters (imk_design_field), for a file that has said
 *
 *     #define DESIGN imk_ring_laser
 *
 * Minimum and maximum are in SI. The unit is the one that files and help are written in. */
#ifndef IMUKI_DESIGN_ROWS_INTERNAL_H
#define IMUKI_DESIGN_ROWS_INTERNAL_H

#include "imukit/instrument.h"

#include <stddef.h>

/* From the minimum to the maximum. */
#define NUMBER(path, member, unit, minimum, maximum, help)                                         \
    {                                                                                              \
        path, IMK_DESIGN_NUMBER, offsetof(DESIGN, member), unit, minimum, maximum, false, NULL,    \
            help                                                                                   \
    }
/* Above the minimum. */
#define ABOVE(path, member, unit, minimum, maximum, help)                                          \
    {                                                                                              \
        path, IMK_DESIGN_NUMBER, offsetof(DESIGN, member), unit, minimum, maximum, true, NULL,     \
            help                                                                                   \
    }
#define COUNT(path, member, minimum, maximum, help)                                                \
    {                                                                                              \
        path, IMK_DESIGN_COUNT, offsetof(DESIGN, member), "1", minimum, maximum, false, NULL, help \
    }
/* One of the words of "open|closed". */
#define CHOICE(path, member, words, help)                                                          \
    {                                                                                              \
        path, IMK_DESIGN_CHOICE, offsetof(DESIGN, member), "1", 0, 0, false, words, help           \
    }
#define SWITCH(path, member, help)                                                                 \
    {                                                                                              \
        path, IMK_DESIGN_SWITCH, offsetof(DESIGN, member), "1", 0, 0, false, NULL, help            \
    }

#endif
