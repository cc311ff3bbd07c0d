/* SPDX-License-Identifier: Apache-2.0 */
/** @file reference_alignment.h
 *  Comparison of a log with its reference (rate table, dividing head, programme): the stretches in
 *  which the reference is constant, and the offset between the two clocks. Method:
 *  docs/theory/calibration.md. */
#ifndef IMUKIT_REFERENCE_ALIGNMENT_H
#define IMUKIT_REFERENCE_ALIGNMENT_H

#include "imukit/procedure.h"

IMK_BEGIN_C

/** A stretch in which every reference channel is constant: a step of a rate table, a position of a
 *  dividing head, a level of a centrifuge. */
typedef struct imk_reference_stretch {
    size_t begin, end;              /**< samples begin … end - 1, without the trimmed ends */
    double rate[3];                 /**< mean reference [rad/s]; NaN: not known */
    double force[3];                /**< [m/s^2]; NaN: not known */
    double angular_acceleration[3]; /**< [rad/s^2]; 0: not known */
    imk_static_interval reading;    /**< mean readings, their sigma and scatter */
} imk_reference_stretch;

/** Bytes of workspace of imk_reference_stretches(). */
IMK_API size_t imk_reference_stretches_workspace_size(const imk_test_record *record);

/** Find the stretches of a record. A reference may be noisy, such as rates from an encoder.
 *  Therefore means over a fifth of `minimum` are compared, which may vary by `steady_rate` or
 *  `steady_force` plus the range of their own noise; fourth differences separate this noise from
 *  motion. `trim` is left out at each end, and `settle` also at the beginning; `minimum` must
 *  remain. A stretch ends at a gap and where the reference is not a number. Linear in the length.
 *  @param settings  of any procedure; trim, settle, steady_rate, steady_force, minimum are read.
 *                   With a steady_force of 1e300 only the rates are compared
 *  @param stretch   room for `capacity`
 *  @param count     number found, also beyond the capacity
 *  @return IMK_ERROR_KEY_MISSING (field "reference": the record has none), IMK_ERROR_WORKSPACE,
 *          IMK_ERROR_RANGE (dt), IMK_ERROR_UNINITIALISED; no stretch is no error */
IMK_API imk_status imk_reference_stretches(const imk_test_record *record,
                                           const imk_procedure_settings *settings,
                                           imk_reference_stretch *stretch, size_t capacity,
                                           size_t *count, void *workspace, size_t workspace_size,
                                           imk_error *error);

/** Time offset between a log and its reference. */
typedef struct imk_reference_shift {
    double offset; /**< the log at t corresponds to the reference at t - offset [s]; positive: the
                      readings come later */
    double sigma;  /**< from the noise of the readings [s] */
    double correlation;  /**< correlation of the axis that follows the reference best, 0 … 1 */
    double rival;        /**< its second largest correlation, at another shift; if it is near
                            `correlation`, the offset is ambiguous, as with a sine */
    double rival_offset; /**< the shift of `rival` [s]; NaN: no other peak */
    int sensor, axis;    /**< the axis with the best correlation */
} imk_reference_shift;

/** Bytes of workspace of imk_reference_offset(). */
IMK_API size_t imk_reference_offset_workspace_size(const imk_test_record *record, double max_shift);

/** Find the offset within +-max_shift that makes the readings follow the reference best, to a
 *  fraction of a sample. Every axis may respond to every component of its reference with any factor
 *  and either sign, so units, nominal directions and exchanged axes do not matter. Gyros are
 *  compared with reference_rate and accelerometers with reference_force, as far as the record has
 *  them and they vary. The record's samples must be equally spaced except for gaps. Of shifts that
 *  fit equally well, as with steps of equal length, the least is taken; the others are rivals.
 *  @return IMK_ERROR_KEY_MISSING (field "reference"), IMK_ERROR_CONSTANT (reference or readings
 *          never change), IMK_ERROR_TOO_SHORT (less than three times max_shift), IMK_ERROR_RANGE
 *          (max_shift), IMK_ERROR_WORKSPACE */
IMK_API imk_status imk_reference_offset(const imk_test_record *record, double max_shift,
                                        imk_reference_shift *shift, void *workspace,
                                        size_t workspace_size, imk_error *error);

IMK_END_C
#endif
