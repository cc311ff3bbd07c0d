/* SPDX-License-Identifier: Apache-2.0 */
/** @file io.h
 *  Everything of libimukit-io: jobs, files, threads, messages. Needs libyaml, zlib, zstd, lz4,
 *  bzip2, SQLite, pthreads.
 */
#ifndef IMUKIT_IO_H
#define IMUKIT_IO_H

#include "imukit/aid_text.h"
#include "imukit/campaign.h"
#include "imukit/design_file.h"
#include "imukit/figure_file.h"
#include "imukit/firmware_file.h"
#include "imukit/jobs.h"
#include "imukit/log.h"
#include "imukit/memory_limit.h"
#include "imukit/model_file.h"
#include "imukit/motion_file.h"
#include "imukit/output_file.h"
#include "imukit/parameter_file.h"
#include "imukit/thread_pool.h"

IMK_BEGIN_C

/** Write the message of an error, which says what was found, what was expected and what to do:
 *  `tactical.yaml:7:3: gyro.noise.angle_random_walk: "0.1 deg/h" is a rate; expected a unit like …`
 *
 *  How an author fills an imk_error so that the message is good:
 *  - found is the bare text that stood there for the statuses about a text (_SYNTAX, _UNIT_…,
 *    _DIMENSION, _KEY_…, _NAME_UNKNOWN, _VERSION, _RANGE, _NOT_FINITE): it is quoted and the clause
 *    added; or a whole clause that begins with its own quotation mark. For the others it is a
 *    reason ("Permission denied") or a clause ("gnuplot is not installed").
 *  - expected begins with an article, a count or "at least" when it says what is due ("a positive
 *    number"; "expected" is put in front), else it is what to do ("add --rate 100Hz"); a single
 *    word after _UNIT_UNKNOWN, _KEY_UNKNOWN, _NAME_UNKNOWN becomes "did you mean …?".
 *  - without found, value and limit are printed unless both are 0 (SI, as they are); index is an
 *    axis under gyro… and accel…, a row with _TIME_ORDER and _GAP, else an element.
 *
 *  Control characters and bytes that are not UTF-8 are written as "?".
 *  @param source  file name to put in front ("-": standard input), or NULL
 *  @return length; the text is cut between characters so that it fits into `size` with its
 *          terminating zero */
IMK_API size_t imk_error_text(const imk_error *error, const char *source, char *text, size_t size);

IMK_END_C
#endif
