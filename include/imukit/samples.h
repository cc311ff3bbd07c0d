/* SPDX-License-Identifier: Apache-2.0 */
/** @file samples.h
 *  Rules about the samples of a record, which every verb and procedure uses: which numbers are
 *  readings, which time steps leave out samples, and how many samples an interval of time has. */
#ifndef IMUKIT_SAMPLES_H
#define IMUKIT_SAMPLES_H

#include "imukit/status.h"

#include <stdbool.h>
#include <stddef.h>

IMK_BEGIN_C

/** A number with an absolute value beyond this, in SI units, is not a reading but a fault of the
 *  log, like an infinity: sums of its powers (up to the fourth) would overflow. */
#define IMK_READING_MAX 1e60

/** True when samples are missing in a time step: it is 1.5 intervals or longer, or NaN. */
IMK_API bool imk_step_is_gap(double step, double interval);

/** Number of sample intervals in a time step: 0 when it is not positive, 1 when it is not a gap,
 *  else the nearest whole number, up to 1e15. */
IMK_API size_t imk_step_intervals(double step, double interval);

/** Number of samples in a time: the nearest whole number, up to 1e15; 0 when it is not positive. */
IMK_API size_t imk_samples_in(double time, double interval);

IMK_END_C
#endif
