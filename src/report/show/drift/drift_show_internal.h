/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a displayed drift: tables, figure, and the answer to a requirement. */
#ifndef IMUKI_DRIFT_SHOW_INTERNAL_H
#define IMUKI_DRIFT_SHOW_INTERNAL_H

#include "jobs/drift/drift_models_internal.h"
#include "report/show/show_internal.h"

enum { IMKI_DRIFT_TIME = 80 };
/* "10 min ~", where figures are rough. @return text */
const char *imki_drift_time(double time, imk_drift_validity validity, char text[IMKI_DRIFT_TIME]);

/* ---- drift_show_aids.c ---- */

/* A time of the table: "+1 min" behind the end of the aids, "10 min, aided" before it. */
const char *imki_drift_row_label(const imk_drift_models *r, double time,
                                 imk_drift_validity validity, char text[IMKI_DRIFT_TIME]);
/* In a sentence: "1 min of outage", or "10 min". */
const char *imki_drift_moment(const imk_drift_models *r, double time, char text[IMKI_DRIFT_TIME]);
/* "aided by position 1 m, velocity 0.05 m/s at 1 Hz until 10 min"; nothing without aids. */
void imki_drift_aids_words(const imk_drift_models *r, imki_text *text);
void imki_drift_show_aids(const imk_drift_models *r, const char *filter_model, imk_result *result);

/* The 1 sigma behind a source "aid.…", times a factor; nothing for a lever arm. */
void imki_drift_aid_value(const imk_drift_settings *s, const char *name, double factor,
                          imki_text *text);

/* drift_judgement.c: in the object of the data that is open. */
void imki_judge_drift(const imk_drift_models *r, const imk_verdict *verdict, imk_result *result);

/* Each table behind an empty line. Growth of one case, two of one model, or several models. */
void imki_drift_show_growth(const imk_drift_models *r, imk_result *result);
void imki_drift_show_budget(const imk_drift_models *r, const imk_drift_case *one,
                            imk_result *result);
/* The 95 % interval of the mean normalised error squared of a row, if the filter knows the truth.
 */
void imki_drift_nees_due(const imk_drift_models *r, size_t row, double *low, double *high);
void imki_drift_show_runs(const imk_drift_models *r, imk_result *result);
/* How the runs compare with the covariance. */
void imki_drift_show_ratios(const imk_drift_models *r, imk_result *result);

/* Share of a source in the horizontal variance at a time, of what the terms have by themselves:
 * what correlations add or take is of no single one. */
double imki_drift_share_at(const imk_drift_analysis *a, size_t source, size_t t);
/* @param shares  with the shares of the terms beside it */
void imki_drift_show_figure(const imk_drift_models *r, bool shares, imk_result *result);
/* @param model  of the last case, its JSON as data called "model"; NULL: no values are told */
void imki_drift_show_answer(const imk_drift_models *r, const imk_result *model, imk_result *result);
void imki_drift_show_answer_data(const imk_drift_models *r, imk_result *result);

/* "gyro.bias.repeatability" -> "1 deg/h" as the model says it, times a factor; nothing when it
 * cannot be told in one quantity. */
void imki_drift_term_value(const imk_result *model, const char *source, bool compensated,
                           double factor, imki_text *text);

#endif
