/* SPDX-License-Identifier: Apache-2.0 */
/* What a model does not state, as drift and grade tell it. */
#ifndef IMUKI_UNSTATED_SHOW_INTERNAL_H
#define IMUKI_UNSTATED_SHOW_INTERNAL_H

#include "report/show/show_internal.h"

/* Members "lower_bound" and "unstated" of an object. */
void imki_show_missing_data(size_t count, const imk_drift_missing *missing, imk_result *result);
/* Member "assumed". @param assumed  NULL: nothing was to be assumed */
void imki_show_assumed_data(const imk_unstated *assumed, imk_result *result);

/* A table behind an empty line; nothing without such terms. */
void imki_show_missing(size_t count, const imk_drift_missing *missing, imk_result *result);
/* A line for each term of a model. */
void imki_show_assumed(const imk_unstated *assumed, const char *name, imk_result *result);

/* "gyro run-to-run bias, gyro misalignment and accelerometer run-to-run bias" */
void imki_missing_names(size_t count, const imk_drift_missing *missing, imki_text *text);
/* The same of run-to-run bias and bias instability, for the kinds of sensors asked for. */
void imki_unstated_biases(const imk_model *model, bool gyro, bool accel, imki_text *text);

#endif
