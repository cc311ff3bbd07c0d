/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_record.h
 *  Identification of a long record in one pass, its samples given in blocks and not kept.
 *
 *  imk_identify_channel() transforms a whole record at once: 32 bytes and 100 ns a sample. Here the
 *  record is gathered on two scales (docs/theory/long-records.md): the powers of segments of 65536
 *  samples, added up, give the spectrum above a frequency f_c; means of 32 or more samples, kept
 *  for the whole record, give it below. The estimator is the same, and so are its values to a small
 *  part of their standard deviations. 1e7 samples take 11 MB, and as much again at the end, and
 *  about 32 ns each.
 *
 *  Pure tones are not subtracted but left out of the fit, with the coefficients they spread over.
 *  Their amplitude is that of the power found, good to some per cent. */
#ifndef IMUKIT_IDENTIFY_RECORD_H
#define IMUKIT_IDENTIFY_RECORD_H

#include "imukit/identify.h"

IMK_BEGIN_C

enum {
    IMK_IDENTIFY_RECORD_LEAST = 1 << 19, /**< samples that a record needs at least */
    /** samples up to which imk_identify_channel() is advised */
    IMK_IDENTIFY_RECORD_ADVISED = 1 << 21
};

/** A record being gathered; in the caller's memory. */
typedef struct imk_identify_record imk_identify_record;

/** Bytes of memory for a record of `expected` samples, 0 where that is not known: 11 MB, and from
 *  1.3e8 samples on 1/16 to 1/8 of a byte a sample. More samples than expected are no error: beyond
 *  five times 1e8 with 0 expected, the division of the frequencies loses some of their information.
 */
IMK_API size_t imk_identify_record_size(size_t expected);

/** Start a record in `memory`, at any address, which the caller frees when all is done.
 *  @return IMK_ERROR_WORKSPACE, IMK_ERROR_ARGUMENT */
IMK_API imk_status imk_identify_record_begin(size_t expected, imk_identify_record **record,
                                             void *memory, size_t memory_size, imk_error *error);

/** Add samples, equally spaced and in order, in blocks of any size: the result does not depend on
 *  how the record is divided. A NaN is a missing sample.
 *  @return IMK_ERROR_NOT_FINITE for an infinite sample (error.index: the sample's place in the
 *          record, -1 beyond int), IMK_ERROR_RANGE beyond 8192 blocks a mean */
IMK_API imk_status imk_identify_record_add(imk_identify_record *record, size_t count,
                                           const double *samples, imk_error *error);

/** Workspace for imk_identify_record_finish(): 2 MB, and about 34 bytes for each mean that is kept
 *  (of 32 samples or more). */
IMK_API size_t imk_identify_record_workspace_size(const imk_identify_record *record);

/** Identify what was added; once. Arguments and errors as of imk_identify_channel(), and:
 *  IMK_ERROR_TOO_SHORT below IMK_IDENTIFY_RECORD_LEAST samples; IMK_ERROR_GAP where samples are
 *  missing in so many places that less than half of the segments have 99 % of theirs, or more than
 *  a twentieth of the means have none: identify a shorter stretch with imk_identify_channel(). */
IMK_API imk_status imk_identify_record_finish(imk_identify_record *record,
                                              const imk_identify_settings *settings,
                                              imk_identification *result, void *workspace,
                                              size_t workspace_size, imk_error *error);

/** After finish: overlapping Allan deviations at octaves of m, with intervals at the confidence of
 *  the settings. Up to m = 512 all windows are used; beyond, windows start every mean: an eighth of
 *  m or less up to 1.3e8 samples, which costs less than 2 % of the degrees of freedom. */
IMK_API const imk_allan_point *imk_identify_record_curve(const imk_identify_record *record,
                                                         size_t *count);

IMK_END_C
#endif
