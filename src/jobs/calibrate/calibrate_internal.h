/* SPDX-License-Identifier: Apache-2.0 */
/* Steps of a calibration, and the names of the sensors, gyros first. */
#ifndef IMUKI_CALIBRATE_INTERNAL_H
#define IMUKI_CALIBRATE_INTERNAL_H

#include "jobs/arena_internal.h"

#include "imukit/calibrate_log.h"

static const char *const imki_sensor_keys[IMK_KINDS] = {"gyro", "accel", "mag"};
static const char *const imki_sensor_titles[IMK_KINDS] = {"gyro", "accelerometer", "magnetometer"};
static const char *const imki_sensor_units[IMK_KINDS] = {"rad/s", "m/s^2", "T"};

/* session_record.c: the name of a record without its folders. */
const char *imki_record_name(const char *path);
/* fill_rows.c: rows that are no readings, as loggers write them where one was lost. */
void imki_tell_fill_rows(const imk_test_record *record, imk_findings *findings);
/* calibrate_set_up.c: the problem, its records not loaded; then what is known before of them. */
imk_status imki_calibrate_set_up(imk_calibrate_log *b, const imk_procedure *procedure,
                                 imk_error *error);
imk_status imki_know_before(imk_calibrate_log *b, imk_error *error);
/* calibrate_terms.c: estimate what is named. */
imk_status imki_free_terms(imk_calibrate_log *b, imk_error *error);
/* calibrate_exposure.c: index of the column of this name with the dimension of a unit, -1: there is
 * none; what the unit was exposed to, from columns or the programme. */
imk_status imki_find_column(imk_calibrate_record *log, const char *name, const char *unit,
                            int *found, imk_error *error);
imk_status imki_take_reference(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                               imk_error *error);

/* reference_force.c: whether the forces of columns are specific forces in their unit. */
void imki_check_reference_force(imk_calibrate_record *log);

/* pose_means.c: how well the means of a table are known, from the columns beside them. */
imk_status imki_take_means(const imk_calibrate_log_settings *s, imk_calibrate_record *log,
                           imk_error *error);

/* calibrate_observe.c: where a log stands still, what its procedure observes; a solution. */
imk_status imki_observe(imk_calibrate_log *b, imk_calibrate_record *log, imk_error *error);
imk_status imki_solve_once(imk_calibrate_log *b, imk_error *error);
/* calibrate_solve.c: the solution, where sigmas are not stated with those of the residuals. */
imk_status imki_solve(imk_calibrate_log *b, imk_error *error);
/* calibrate_magnetometer.c: the magnetometer of the records, beside the solution of the other
 * sensors if there is one: what cannot be used then is a warning. */
imk_status imki_calibrate_magnetometer(imk_calibrate_log *b, imk_error *error);
/* magnetometer_findings.c: what is told of its records, and of the solution. false: the result is
 * of no use, and `error` and a failure say why. */
bool imki_magnetometer_records(imk_calibrate_log *b, imk_error *error);
bool imki_magnetometer_result(imk_calibrate_log *b, imk_error *error);
/* Why there is no solution. @return as the record or the calibration goes on */
imk_status imki_magnetometer_useless(imk_calibrate_log *b, imk_status status, const char *code,
                                     const char *name, size_t count, const double *numbers,
                                     imk_error *error);
void imki_magnetometer_directions(const imk_magnetometer_result *r, char *text, size_t size);
/* calibrate_closed_form.c: in the place of the last two. */
imk_status imki_closed_form(imk_calibrate_log *b, imk_error *error);
/* power_cycles.c: the logs, or the sections of one, are runs. */
imk_status imki_compare_runs(imk_calibrate_log *b, imk_error *error);
/* calibrate_model.c: what was found as b->model. */
void imki_calibrate_model(imk_calibrate_log *b);

#endif
