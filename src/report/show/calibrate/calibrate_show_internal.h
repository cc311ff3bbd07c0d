/* SPDX-License-Identifier: Apache-2.0 */
/* How a calibration is shown: messages, tables and a figure. */
#ifndef IMUKI_CALIBRATE_SHOW_INTERNAL_H
#define IMUKI_CALIBRATE_SHOW_INTERNAL_H

#include "report/growing_text_internal.h"
#include "report/show/identify/identify_show_internal.h"

#include "imukit/show.h"
#include "jobs/calibrate/calibrate_internal.h"

/* The same behind ", " unless it is the first. */
#define imki_list_item(list, ...)                                                                  \
    (imki_text_put(list, (list)->size > 0 ? ", " : ""), imki_text_add(list, __VA_ARGS__))

/* calibrate_diagnostics.c: the first diagnostic that makes a record useless; false: there is none.
 */
bool imki_calibrate_useless(const imk_calibrate_log *b, const imk_calibrate_record *log, char *text,
                            size_t size);
/* calibrate_axes_text.c: the mendings of axes (imk_axes_mendings()) and what decides; certain:
 * enough turns show it. @return their number */
size_t imki_axes_text(uint64_t classes, bool certain, char *text, size_t size);
/* Gyros that read full turns with the opposite sign. @return their number */
size_t imki_turns_text(const imk_calibrate_log *b, char *text, size_t size);
/* calibrate_scale_text.c: a scale that no sensor has; and what `ratio` of readings to input looks
 * like, appended to a list. */
void imki_scale_text(const imk_calibrate_log *b, const imk_diagnostic_finding *d, char *text,
                     size_t size);
void imki_scale_causes(const imk_calibrate_log *b, int sensor, double ratio, bool all_axes,
                       imki_text *to);
/* calibrate_lost_text.c: stretches of a log that look like rests and are not used, with times and
 * reasons. "": there is none */
void imki_lost_text(const imk_calibrate_record *log, char *text, size_t size);
/* calibrate_diagnostics.c: slow noise of the sensor, in the model; parameters of it that are
 * estimated. */
bool imki_states_slow_noise(const imk_triad *triad);
bool imki_has_parameters(const imk_calibrate_log *b, int sensor);
/* calibrate_untestable.c: a note of what another sound unit would show as well. */
void imki_untestable(const imk_calibrate_log *b, imk_verdict *verdict);
/* calibrate_words.c: nobody stated sigmas for the readings of this group, the scatter of its
 * residuals is all there is. */
bool imki_no_sigma(const imk_calibrate_log *b, int group);
/* The text that names a row; NULL: it has none. */
const char *imki_label_of(const imk_test_record *record, size_t row);
/* "accelerometer bias to 0.05 mg, scale factor to 65 ppm; gyro bias to 0.6 deg/h": the worst axis
 * of each term that was estimated. */
void imki_precision(size_t count, const imk_model_parameter *parameter, const double *sigma_of,
                    imki_text *list);
/* The verdict in one message. */
void imki_calibrate_summary(const imk_calibrate_log *b, const imk_verdict *verdict, char *text,
                            size_t size);
/* On frame and gravity, what was left out and what is correlated. */
void imki_calibrate_remarks(const imk_calibrate_log *b, imk_result *result);
/* The poses that would tell most, as a list of angles behind `before`; "": they are not known. */
void imki_calibrate_poses(const imk_calibrate_log *b, const imk_calibrate_record *log,
                          const char *before, char *text, size_t size);
/* calibrate_tables.c */
void imki_parameter_table(const imk_calibrate_log *b, int sensor, imk_result *result);
void imki_runs_table(const imk_calibrate_log *b, int sensor, imk_result *result);
void imki_thermal_table(const imk_calibrate_record *log, int sensor, bool brief,
                        imk_result *result);
void imki_fit_table(const imk_calibrate_log *b, imk_result *result);
void imki_pose_table(const imk_calibrate_log *b, imk_result *result);
/* calibrate_known_turns.c: of logs of the procedure turns, the table of all turns, the same as
 * data, and messages. */
bool imki_is_of_turns(const imk_calibrate_log *b, const imk_observation *o);
bool imki_has_only_turns(const imk_calibrate_log *b);
void imki_turn_table(const imk_calibrate_log *b, imk_result *result);
void imki_turn_fit(const imk_calibrate_log *b, imk_table *table); /* a row of the fit */
void imki_show_turns(const imk_calibrate_log *b, imk_result *result);
void imki_turns_verdict(const imk_calibrate_log *b, const imk_calibrate_record *log,
                        imk_verdict *verdict);
/* thermal_verdict.c: messages on a sweep of temperature. */
void imki_thermal_verdict(const imk_calibrate_record *log, imk_verdict *verdict);
/* magnetometer_show.c: its solution as data, in words, and as a row of the fit. */
void imki_magnetometer_data(const imk_calibrate_log *b, imk_result *result);
void imki_magnetometer_remarks(const imk_calibrate_log *b, imk_result *result);
void imki_magnetometer_row(const imk_calibrate_log *b, imk_table *table);
/* calibrate_figure.c */
void imki_calibrate_figure(const imk_calibrate_log *b, imk_result *result);

#endif
