/* SPDX-License-Identifier: Apache-2.0 */
/** @file simulate_log.h
 *  The jobs of `imukit simulate`: one run of a model into a record, and the truth behind it. */
#ifndef IMUKIT_SIMULATE_LOG_H
#define IMUKIT_SIMULATE_LOG_H

#include "imukit/aiding.h"
#include "imukit/job.h"
#include "imukit/record.h"
#include "imukit/simulate.h"

IMK_BEGIN_C

/** Settings of the job. Start from imk_simulate_log_default(). */
typedef struct imk_simulate_log_settings {
    uint32_t cookie;
    imk_simulation simulation;      /**< motion, temperature, rate, seed and run number */
    uint64_t rows;                  /**< length of the log, > 0 */
    double start;                   /**< time of the first row [s]; default 0 */
    bool increments;                /**< increments of the integrals over a row instead of rates and
                                         forces; default false */
    imk_unit gyro_unit, accel_unit; /**< units of the columns; scale 0 (default): deg/s and m/s^2,
                                       or their increments */
} imk_simulate_log_settings;

/** Settings of imk_simulation_default(), with rates in the usual units. */
IMK_API imk_simulate_log_settings imk_simulate_log_default(void);

/** Complete the settings by what follows from the model and the motion, as the command does: the
 *  time of the first row, where a trajectory does not begin at 0; the field of the Earth
 *  (imk_dipole_field()), where it is 0, the model has a magnetometer and the motion an
 *  attitude; and the rows.
 *  @param duration  of the log [s]; NaN: that of the whole motion
 *  @param length    of the motion [s], imk_motion_file_duration(); infinite: it has no end, and
 *                   without a duration `rows` is 0
 *  @param findings  what is left out of the simulation: temperature terms without a temperature,
 *                   the magnetometer on a recorded motion, vibration that is too fast
 *  @return IMK_ERROR_RANGE (rate, duration) */
IMK_API imk_status imk_simulate_log_complete(const imk_model *model, double duration, double length,
                                             imk_simulate_log_settings *settings,
                                             imk_findings *findings, imk_error *error);

/** Find the number by which the column of each sensor of a triad is named: 0 to 2 (x to z) for up
 *  to three sensors along the body axes, consecutive numbers for others. */
IMK_API void imk_triad_axes(const imk_triad *triad, int axis[IMK_AXES_MAX]);

/** Simulate one run: time, gyros, accelerometers, the magnetometer [uT] if the simulation has a
 *  field, and the temperature if there is a profile. Rows
 *  that are lost (timing.drops) are left out. A model with a sensitivity gives counts.
 *  @param sink   takes the rows
 *  @param stage  text for the progress, such as "simulating"
 *  @param job    NULL: one thread, memory of the C library, no progress
 *  @return errors of imk_simulator_start() and of the sink; IMK_ERROR_MEMORY, _CANCELLED */
IMK_API imk_status imk_simulate_log_run(const imk_model *model,
                                        const imk_simulate_log_settings *settings,
                                        const imk_record_sink *sink, const char *stage,
                                        const imk_job *job, imk_error *error);

/** A simulation whose rows are taken when they are wanted: for programs that go on for ever, or
 * hold a block at a time. */
typedef struct imk_simulated_rows imk_simulated_rows;

/** Start a run; its rows are those of imk_simulate_log_run().
 *  @param settings  copied, but not what its pointers point to; `rows` 0: without end
 *  @param job       memory, which must live as long as the rows; NULL: that of the C library
 *  @param rows      end it with imk_simulated_rows_free()
 *  @return errors of imk_simulate_log_run() */
IMK_API imk_status imk_simulated_rows_start(const imk_model *model,
                                            const imk_simulate_log_settings *settings,
                                            const imk_job *job, imk_simulated_rows **rows,
                                            imk_error *error);
/** Its columns; the values of `next` are SI. */
IMK_API const imk_log_column *imk_simulated_rows_columns(const imk_simulated_rows *rows,
                                                         size_t *count);
/** Make the next rows.
 *  @param most     rows wanted; fewer at the end, and where rows are lost (timing.drops)
 *  @param columns  one array of `most` doubles for each column
 *  @param job      threads and progress (`stage`); NULL: one thread, no progress
 *  @param made     rows that were made; 0 with IMK_OK: the end, or all of them are lost
 *  @return IMK_ERROR_CANCELLED */
IMK_API imk_status imk_simulated_rows_next(imk_simulated_rows *rows, size_t most,
                                           double *const *columns, const char *stage,
                                           const imk_job *job, size_t *made, imk_error *error);
/** Rows that are still to come, those that are lost included; UINT64_MAX: without end. */
IMK_API uint64_t imk_simulated_rows_left(const imk_simulated_rows *rows);
/** End it; NULL is allowed. */
IMK_API void imk_simulated_rows_free(imk_simulated_rows *rows);

/** Write the truth behind every run, row by row: position, velocity and attitude at the time of the
 *  row (not for a recorded motion), the true time, and what perfect sensors would have read over
 *  the row.
 *  @return errors of imk_simulate_log_run() */
IMK_API imk_status imk_simulate_truth_run(const imk_model *model,
                                          const imk_simulate_log_settings *settings,
                                          const imk_record_sink *sink, const imk_job *job,
                                          imk_error *error);

/** Write what other instruments read of the motion, with their errors: a row each `interval`, from
 *  `from` to `until` or the end of the log, with the time, the readings of all aids and the 1 sigma
 *  of their white errors, in columns that imukit navigate knows. The errors of seed and run are the
 *  same at every call.
 *  @param aid_count,aid  1 … IMK_AIDS_MAX, of different kinds that an instrument reads, with the
 *                        same interval, from and until
 *  @return errors of imk_simulate_log_run() and imk_aid_validate(); IMK_ERROR_CONFLICT (times that
 *          differ, no Earth), _UNSUPPORTED (a recorded motion, zero velocity) */
IMK_API imk_status imk_simulate_aids_run(const imk_model *model,
                                         const imk_simulate_log_settings *settings,
                                         size_t aid_count, const imk_aid *aid,
                                         const imk_record_sink *sink, const imk_job *job,
                                         imk_error *error);

IMK_END_C
#endif
