/* SPDX-License-Identifier: Apache-2.0 */
/* What each procedure implements; procedure.c holds the table. */
#ifndef IMUKIT_PROCEDURE_INTERNAL_H
#define IMUKIT_PROCEDURE_INTERNAL_H

#include "imukit/procedure.h"

enum { IMKI_PROCEDURE_COOKIE = 0x50524F31 };

/* What an observe function gets: settings are valid, the record is appended already. */
typedef struct imki_procedure_call {
    imk_procedure procedure;
    imk_calibration *calibration;
    int record; /* index of it */
    const imk_procedure_settings *settings;
    bool keep_free;
    void *workspace;
    size_t workspace_size;
    imk_procedure_findings *findings;
    imk_error *error;
} imki_procedure_call;

imk_status imki_multiposition_observe(const imki_procedure_call *call);
size_t imki_multiposition_workspace(const imk_test_record *record,
                                    const imk_procedure_settings *settings);

/* sixposition, and the holds of ferraris */
imk_status imki_six_position_observe(const imki_procedure_call *call);
size_t imki_six_position_workspace(const imk_test_record *record,
                                   const imk_procedure_settings *settings);
imk_status imki_ferraris_observe(const imki_procedure_call *call);
size_t imki_ferraris_workspace(const imk_test_record *record,
                               const imk_procedure_settings *settings);

/* rate-table, tumble, centrifuge, spin: all that have a reference for every sample */
imk_status imki_reference_observe(const imki_procedure_call *call);
size_t imki_reference_workspace(const imk_test_record *record,
                                const imk_procedure_settings *settings);

imk_status imki_thermal_observe(const imki_procedure_call *call);
size_t imki_thermal_workspace(const imk_test_record *record,
                              const imk_procedure_settings *settings);

imk_status imki_turns_observe(const imki_procedure_call *call);
size_t imki_turns_workspace(const imk_test_record *record, const imk_procedure_settings *settings);

/* ---- procedure_shared.c ---- */

/* The mounting of a log's unit on its fixture, if it is not exact: another one. @return its index;
 * -1: exact; -2: there is no room */
int imki_add_fixture(const imki_procedure_call *call);

/* Make every element of a term free on all axes of a sensor that the record has (the diagonal of
 * misalignment aside; of accelerometers only what the frame leaves when `attitudes_known` is
 * false).
 */
imk_status imki_free_term(const imki_procedure_call *call, int sensor, int term, int elements,
                          bool attitudes_known);

/* Readings of a mean in SI by the model's nominal sensitivity and zero offset. */
double imki_reading_si(const imk_model *model, const imk_test_record *record, int sensor, int axis,
                       double reading);

/* d(reading)/d(input) of an axis in the record's unit: its sensitivity, 1 in SI. */
double imki_counts_per_unit(const imk_model *model, const imk_test_record *record, int sensor,
                            int axis);
/* False: readings in counts, and nobody knows how many make a unit. */
bool imki_unit_known(const imk_model *model, const imk_test_record *record, int sensor);
/* x to so many significant digits. */
double imki_round_digits(double x, int digits);

#endif
