/* SPDX-License-Identifier: Apache-2.0 */
/* Between the parts of the job of `imukit evaluate`. */
#ifndef IMUKIT_EVALUATE_JOB_INTERNAL_H
#define IMUKIT_EVALUATE_JOB_INTERNAL_H

#include "imukit/evaluate_log.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

/* ---- evaluate_delay.c ---- */

/* Bring the reference of a record to the time of the readings; with a finding when that matters.
 * The moved channels live in `scratch`.
 * @param log  the record as it was loaded
 * @return IMK_ERROR_MEMORY */
imk_status imki_evaluate_align(imk_evaluate_log *v, const imk_calibrate_record *log,
                               imki_arena *scratch, imk_test_record *record, imk_error *error);

#endif
