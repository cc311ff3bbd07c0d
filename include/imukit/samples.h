/* SPDX-License-Identifier: Apache-2.0 */
/** @file samples.h
 *  What counts as a sample of a record: which numbers are readings, which steps of time leave
 *  samples out, and how many there are in a time. Every verb and procedure goes by these rules. */
#ifndef IMUKIT_SAMPLES_H
#define IMUKIT_SAMPLES_H

#include "imukit/status.h"

#include <stdbool.h>
#include <stddef.h>

IMK_BEGIN_C

/** A number beyond this, in SI units, is no reading of a sensor but a fault of the log, like an
 *  infinity: sums of its powers overflow, up to the fourth. */
#define IMK_READING_MAX 1e60

/** Whether samples are missing in a step of time: it is 1.5 intervals or more, or not a number. */
IMK_API bool imk_step_is_gap(double step, double interval);

/** How many intervals a step of time is: 0 when it is not positive, 1 when it is no gap, else the
 *  nearest number, up to 1e15. */
IMK_API size_t imk_step_intervals(double step, double interval);

/** Samples in a time: the nearest number, 0 when it is not positive, up to 1e15, which is more than
 *  there can be. */
IMK_API size_t imk_samples_in(double time, double interval);

IMK_END_C
#endif
