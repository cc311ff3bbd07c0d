/* SPDX-License-Identifier: Apache-2.0 */
/** @file grade_position.h
 *  The job of `imukit grade`: the class of a model by its biases (imk_grade_model()) and by the
 *  position error of all its terms (drift.h), the terms that limit it, and the improvement that the
 *  next better class needs. */
#ifndef IMUKIT_GRADE_POSITION_H
#define IMUKIT_GRADE_POSITION_H

#include "imukit/drift_models.h"
#include "imukit/job.h"
#include "imukit/model.h"

IMK_BEGIN_C

/** Times of the assessment: after a minute, an hour, a day. */
enum { IMK_GRADE_MINUTE, IMK_GRADE_HOUR, IMK_GRADE_DAY, IMK_GRADE_TIMES };
/** Value of one of these times [s]. */
IMK_API double imk_grade_time(size_t time);

/** Cases of navigation: the attitude at the start is given, or found by self-alignment; then both
 *  with all known values taken out. */
enum {
    IMK_GRADE_GIVEN,
    IMK_GRADE_SELF,
    IMK_GRADE_GIVEN_COMPENSATED,
    IMK_GRADE_SELF_COMPENSATED,
    IMK_GRADE_WAYS
};

/** Errors in one case at these times. */
typedef struct imk_grade_way {
    imk_drift_figures figures[IMK_GRADE_TIMES];
    imk_drift_validity validity[IMK_GRADE_TIMES];
    double cep[IMK_GRADE_TIMES]; /**< [m]; NaN: the position is lost */
    imk_grade grade;
} imk_grade_way;

/** A source of error, and its share or the factor by which it must be reduced. */
typedef struct imk_grade_share {
    char text[64];
    double value;
} imk_grade_share;

enum { IMK_GRADE_SHARES = 4, IMK_GRADE_OMITTED = 24 };

/** Result of the job. */
typedef struct imk_graded {
    const imk_model *model;
    imk_allocator allocator;
    imk_findings findings;
    imk_grade_result table;         /**< class by biases */
    double gyro_scale, accel_scale; /**< scale-factor errors that remain after calibration, worst
                                       axis [1]; NaN: not stated */
    const char *no_position; /**< reason why no position error is computed (a constant string);
                                NULL: it is computed, and the members below are valid */
    imk_grade_way way[IMK_GRADE_WAYS];
    /** Terms that the model does not state and that would matter for the position after an hour or
     *  a day, with the attitude given at the start. If there are any, all figures are lower bounds,
     *  and the classes of the ways are the best that are possible. */
    size_t missing_count;
    imk_drift_missing missing[IMK_UNSTATED_MAX];
    bool compensation_matters;
    size_t share_count;
    imk_grade_share share[IMK_GRADE_SHARES]; /**< the largest shares of the horizontal variance
                                                  after an hour, 0 … 1 */
    bool shifted;    /**< known values contribute more to the error than these */
    imk_grade next;  /**< the next better class; IMK_GRADE_NONE: it is the best */
    double next_all; /**< the next class is reached if every source is multiplied by this */
    size_t need_count;
    /** Sources that reach it alone, each with the factor by which it must be reduced, the largest
     *  factor first. */
    imk_grade_share need[IMK_GRADE_SHARES];
    size_t need_more; /**< number of further such sources */
    size_t omitted_count;
    const char *omitted[IMK_GRADE_OMITTED]; /**< effects that the linear figures leave out */
} imk_graded;

/** Does a model state anything to grade? */
IMK_API bool imk_grade_possible(const imk_model *model);

/** Grade a model, which must outlive the result.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_graded_free(), also after a failure, because it then holds the
 *                 findings; NULL if there was no memory for it
 *  @return errors of imk_drift_covariance(); IMK_ERROR_MEMORY; with a finding that says why:
 *          IMK_ERROR_EMPTY (neither biases nor a position error can be assessed) */
IMK_API imk_status imk_grade_run(const imk_model *model, const imk_job *job, imk_graded **result,
                                 imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_graded_free(imk_graded *result);

IMK_END_C
#endif
