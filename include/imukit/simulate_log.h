/* SPDX-License-Identifier: Apache-2.0 */
/** @file simulate_log.h
 *  The jobs of `imukit simulate`: one run of a model into a record, and the truth behind it. */
#ifndef IMUKIT_SIMULATE_LOG_H
#define IMUKIT_SIMULATE_LOG_H

#include "imukit/job.h"
#include "imukit/record.h"
#include "imukit/simulate.h"

IMK_BEGIN_C

/** What is asked. Start from imk_simulate_log_default(). */
typedef struct imk_simulate_log_settings {
    uint32_t cookie;
    imk_simulation simulation;      /**< motion, temperature, rate, seed and run */
    uint64_t rows;                  /**< > 0 */
    double start;                   /**< [s] stamp of the first row; 0 */
    bool increments;                /**< of the integrals, over the row; false: rates */
    imk_unit gyro_unit, accel_unit; /**< as the columns are called; scale 0: the usual ones */
} imk_simulate_log_settings;

/** As imk_simulation_default(), rates in the usual units. */
IMK_API imk_simulate_log_settings imk_simulate_log_default(void);

/** The number in the name of the column for each sensor of a triad: up to three along body axes are
 *  called by them, others are numbered. */
IMK_API void imk_triad_axes(const imk_triad *triad, int axis[IMK_AXES_MAX]);

/** One run: time, gyros, accelerometers, and the temperature where there is a profile. Rows that
 *  are lost (timing.drops) are left out. A model with a sensitivity makes counts.
 *  @param stage  what the progress says
 *  @return as imk_simulator_start(), the sink; IMK_ERROR_MEMORY, _CANCELLED */
IMK_API imk_status imk_simulate_log_run(const imk_model *model,
                                        const imk_simulate_log_settings *settings,
                                        const imk_record_sink *sink, const char *stage,
                                        const imk_job *job, imk_error *error);

/** The truth behind every run, row by row: where the unit was at the stamp (not of a recorded
 *  motion), its true time, and what perfect sensors would have read over the row.
 *  @return likewise */
IMK_API imk_status imk_simulate_truth_run(const imk_model *model,
                                          const imk_simulate_log_settings *settings,
                                          const imk_record_sink *sink, const imk_job *job,
                                          imk_error *error);

IMK_END_C
#endif
