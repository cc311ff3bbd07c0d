/* SPDX-License-Identifier: Apache-2.0 */
/** @file reference_alignment.h
 *  A log beside what the table, the dividing head or the programme says: where that holds still,
 *  and by how much the two clocks differ. Method: docs/theory/calibration.md. */
#ifndef IMUKIT_REFERENCE_ALIGNMENT_H
#define IMUKIT_REFERENCE_ALIGNMENT_H

#include "imukit/procedure.h"

IMK_BEGIN_C

/** A stretch in which every reference channel is constant: a step of a rate table, a position of a
 *  dividing head, a level of a centrifuge. */
typedef struct imk_reference_stretch {
    size_t begin, end;              /**< samples begin … end - 1, what was trimmed left out */
    double rate[3];                 /**< mean reference [rad/s]; NaN: not known */
    double force[3];                /**< [m/s^2]; NaN: not known */
    double angular_acceleration[3]; /**< [rad/s^2]; 0: not known */
    imk_static_interval reading;    /**< mean readings, their sigma and scatter */
} imk_reference_stretch;

/** Bytes of workspace of imk_reference_stretches(). */
IMK_API size_t imk_reference_stretches_workspace_size(const imk_test_record *record);

/** Find the stretches of a record. A reference may be noisy, as the rates of an encoder are: means
 *  over a fifth of `minimum` are looked at, and what may vary is `steady_rate` or `steady_force`
 *  plus the range of these means' own noise, which the fourth differences tell from motion. At each
 *  end `trim` is left out, at the beginning `settle` besides; `minimum` of it must be left. A
 *  stretch ends at a gap and where the reference is not a number. Linear in the length.
 *  @param settings  of any procedure; trim, settle, steady_rate, steady_force, minimum are read. A
 *                   steady_force of 1e300 looks at the rates only
 *  @param stretch   room for `capacity`
 *  @param count     how many there are, also beyond the capacity
 *  @return IMK_ERROR_KEY_MISSING (field "reference": the record has none), IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_RANGE (dt), IMK_ERROR_UNINITIALISED; none found is no error */
IMK_API imk_status imk_reference_stretches(const imk_test_record *record,
                                           const imk_procedure_settings *settings,
                                           imk_reference_stretch *stretch, size_t capacity,
                                           size_t *count, void *workspace, size_t workspace_size,
                                           imk_error *error);

/** By how much a log and its reference differ in time. */
typedef struct imk_reference_shift {
    double offset;      /**< the log shows at t what the reference says at t - offset [s]; positive:
                             the readings come later */
    double sigma;       /**< from the noise of the readings [s] */
    double correlation; /**< of the axis that follows the reference best, 0 … 1 */
    double rival;       /**< its largest correlation at a shift that is another one: near
                             `correlation` the offset is ambiguous, as with a sine */
    double rival_offset; /**< [s]; NaN: no other peak */
    int sensor, axis;    /**< that axis */
} imk_reference_shift;

/** Bytes of workspace of imk_reference_offset(). */
IMK_API size_t imk_reference_offset_workspace_size(const imk_test_record *record, double max_shift);

/** Find the offset within +-max_shift that makes the readings follow the reference best, to a
 *  fraction of a sample. Every axis may respond to every component of its reference with any factor
 *  and either sign, so that units, nominal directions and exchanged axes do not matter: gyros are
 *  compared with reference_rate, accelerometers with reference_force, whichever the record has and
 *  that varies. The record's samples must be equally spaced but for gaps.
 *  @return IMK_ERROR_KEY_MISSING (field "reference"), IMK_ERROR_CONSTANT (reference or readings
 *          never change), IMK_ERROR_TOO_SHORT (less than three times max_shift), IMK_ERROR_RANGE
 *          (max_shift), IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_reference_offset(const imk_test_record *record, double max_shift,
                                        imk_reference_shift *shift, void *workspace,
                                        size_t workspace_size, imk_error *error);

IMK_END_C
#endif
