/* SPDX-License-Identifier: Apache-2.0 */
/** @file identify_record.h
 *  Identification of a long record in one pass. Samples are given in blocks and not kept.
 *
 *  imk_identify_channel() transforms a whole record at once: 32 bytes and 100 ns a sample. Here the
 *  record is gathered on two scales (docs/theory/long-records.md). Above a frequency f_c the
 *  spectrum is the sum of the powers of segments of 65536 samples; below f_c it comes from means of
 *  32 or more samples, kept for the whole record. The estimator is the same, and its values differ
 *  by a small part of their standard deviations. 1e7 samples take 11 MB, as much again at the end,
 *  and about 32 ns each.
 *
 *  Pure tones are not subtracted: the coefficients over which they spread are left out of the fit.
 *  Their amplitude comes from the power found and is accurate to some per cent. */
#ifndef IMUKIT_IDENTIFY_RECORD_H
#define IMUKIT_IDENTIFY_RECORD_H

#include "imukit/identify.h"
#include "imukit/noise_map.h"

IMK_BEGIN_C

enum {
    IMK_IDENTIFY_RECORD_LEAST = 1 << 19, /**< least number of samples of a record */
    /** Up to so many samples, use imk_identify_channel() */
    IMK_IDENTIFY_RECORD_ADVISED = 1 << 21
};

/** A record being gathered, in the caller's memory. */
typedef struct imk_identify_record imk_identify_record;

/** Bytes of memory for a record of `expected` samples (0: not known): 11 MB, and 1/16 to 1/8 of a
 *  byte a sample from 1.3e8 samples on. More samples than expected are no error. If `expected` is
 *  0, more than 5e8 samples lose some information, because the frequencies are then divided badly.
 */
IMK_API size_t imk_identify_record_size(size_t expected);

/** Start a record in `memory`, which may have any alignment and which the caller frees after
 *  imk_identify_record_finish().
 *  @return IMK_ERROR_WORKSPACE (memory_size is too small), IMK_ERROR_ARGUMENT */
IMK_API imk_status imk_identify_record_begin(size_t expected, imk_identify_record **record,
                                             void *memory, size_t memory_size, imk_error *error);

/** Add samples, equally spaced and in order, in blocks of any size: the result does not depend on
 *  how the record is divided. A NaN is a missing sample.
 *  @return IMK_ERROR_NOT_FINITE for an infinite sample (error.index: the sample's place in the
 *          record, -1 beyond int), IMK_ERROR_RANGE when the record is too long (more than 8192
 *          blocks a mean) */
IMK_API imk_status imk_identify_record_add(imk_identify_record *record, size_t count,
                                           const double *samples, imk_error *error);

/** Continue a record twice: a copy of what was gathered, in `memory` of imk_identify_record_size()
 *  bytes for the same number of samples.
 *  @return errors of imk_identify_record_begin() */
IMK_API imk_status imk_identify_record_copy(const imk_identify_record *record,
                                            imk_identify_record **copy, void *memory,
                                            size_t memory_size, imk_error *error);

/** Part of the mean of a record at a time [s] from its first sample [unit]. */
typedef double (*imk_record_trend)(const void *context, double time);
/** Subtract a slow part of the mean, after the last sample was added and before
 *  imk_identify_record_finish(). It is taken from the means of 32 samples or more, so it must be
 *  slow against 65536 samples: a change by D over so many leaves 3.3e-4 D^2 at most in the power of
 *  the lowest frequency that the segments are used for. */
IMK_API void imk_identify_record_subtract(imk_identify_record *record, double dt,
                                          imk_record_trend trend, const void *context);

/** Workspace for imk_identify_record_finish(): 2 MB, and about 34 bytes for each mean that is kept
 *  (of 32 samples or more). */
IMK_API size_t imk_identify_record_workspace_size(const imk_identify_record *record);

/** Identify the samples added; may be called once. Arguments and errors as of
 *  imk_identify_channel(), and: IMK_ERROR_TOO_SHORT below IMK_IDENTIFY_RECORD_LEAST samples;
 *  IMK_ERROR_GAP when samples are missing in too many places: less than half of the segments have
 *  99 % of their samples, or more than a twentieth of the means have none. Then identify a shorter
 *  stretch with imk_identify_channel(). */
IMK_API imk_status imk_identify_record_finish(imk_identify_record *record,
                                              const imk_identify_settings *settings,
                                              imk_identification *result, void *workspace,
                                              size_t workspace_size, imk_error *error);

/** Overlapping Allan deviations at octaves of m, with intervals at the confidence of the settings;
 *  call after imk_identify_record_finish(). Up to m = 512 all windows are used. Beyond, one window
 *  starts at each mean, which is every m/8 samples or less (up to 1.3e8 samples) and costs less
 *  than 2 % of the degrees of freedom.
 *  @param count  set to the number of points */
IMK_API const imk_allan_point *imk_identify_record_curve(const imk_identify_record *record,
                                                         size_t *count);

/** Noise over time of the samples, in their unit; valid after imk_identify_record_finish(), until
 *  the record's memory is used otherwise. */
IMK_API const imk_noise_map *imk_identify_record_map(const imk_identify_record *record);

IMK_END_C
#endif
