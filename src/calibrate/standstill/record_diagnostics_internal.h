/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of imk_record_diagnostics(). */
#ifndef IMUKIT_RECORD_DIAGNOSTICS_INTERNAL_H
#define IMUKIT_RECORD_DIAGNOSTICS_INTERNAL_H

#include "imukit/procedure.h"

typedef struct imki_diagnostic_list {
    size_t count, capacity;
    imk_diagnostic_finding *diagnostic;
} imki_diagnostic_list;

static inline void imki_diagnostic_add(imki_diagnostic_list *list, imk_diagnostic_finding finding)
{
    if (list->count < list->capacity)
        list->diagnostic[list->count++] = finding;
}

/* record_turns.c: reading in SI = (reading - zero) * unit; unit 0: not known. */
typedef struct imki_axis_unit {
    double unit, zero;
} imki_axis_unit;
imki_axis_unit imki_record_unit(const imk_test_record *record, const imk_model *model, int sensor,
                                int axis);

/* A scale factor further from 1 is not an error of a sensor: the worst MEMS gyros and
 * accelerometers are within 10 %. */
#define IMKI_SCALE_DOUBTED 0.15

/* What the log is looked over with. */
typedef struct imki_diagnostic_call {
    const imk_test_record *record;
    const imk_static_findings *findings;
    size_t interval_count;
    const imk_static_interval *interval;
    double gravity;
    const imk_model *model;
} imki_diagnostic_call;

/* Unit of the rates, unit of time, and axes of the gyros against those of the accelerometers, by
 * the turns between the holds. */
void imki_diagnostic_turns(const imki_diagnostic_call *call, imki_diagnostic_list *list);

#endif
