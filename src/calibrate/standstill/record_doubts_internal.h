/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imk_record_doubts(). */
#ifndef IMUKIT_RECORD_DOUBTS_INTERNAL_H
#define IMUKIT_RECORD_DOUBTS_INTERNAL_H

#include "imukit/procedure.h"

typedef struct imki_doubt_list {
    size_t count, capacity;
    imk_doubt_finding *doubt;
} imki_doubt_list;

static inline void imki_doubt_add(imki_doubt_list *list, imk_doubt_finding finding)
{
    if (list->count < list->capacity)
        list->doubt[list->count++] = finding;
}

/* record_turns.c: reading in SI = (reading - zero) * unit; unit 0: not known. */
typedef struct imki_axis_unit {
    double unit, zero;
} imki_axis_unit;
imki_axis_unit imki_record_unit(const imk_test_record *record, const imk_model *model, int sensor,
                                int axis);

/* What the log is looked over with. */
typedef struct imki_doubt_call {
    const imk_test_record *record;
    const imk_static_findings *findings;
    size_t interval_count;
    const imk_static_interval *interval;
    double gravity;
    const imk_model *model;
} imki_doubt_call;

/* Unit of the rates, unit of time, and axes of the gyros against those of the accelerometers, by
 * the turns between the holds. */
void imki_doubt_turns(const imki_doubt_call *call, imki_doubt_list *list);

#endif
