/* SPDX-License-Identifier: Apache-2.0 */
/** @file grade_position.h
 *  The job of `imukit grade`: the class of a model by its biases (imk_grade_model()), and by the
 *  error of position that all its terms make (drift.h); what limits it, and what the next better
 *  class needs. */
#ifndef IMUKIT_GRADE_POSITION_H
#define IMUKIT_GRADE_POSITION_H

#include "imukit/drift.h"
#include "imukit/job.h"
#include "imukit/model.h"

IMK_BEGIN_C

/** When it is looked at: a minute, an hour, a day. */
enum { IMK_GRADE_MINUTE, IMK_GRADE_HOUR, IMK_GRADE_DAY, IMK_GRADE_TIMES };
/** These times [s]. */
IMK_API double imk_grade_time(size_t time);

/** How it is navigated: the attitude at the start given, or found by the unit itself; then the same
 *  with all known values taken out. */
enum {
    IMK_GRADE_GIVEN,
    IMK_GRADE_SELF,
    IMK_GRADE_GIVEN_COMPENSATED,
    IMK_GRADE_SELF_COMPENSATED,
    IMK_GRADE_WAYS
};

/** Errors at those times. */
typedef struct imk_grade_way {
    imk_drift_figures figures[IMK_GRADE_TIMES];
    imk_drift_validity validity[IMK_GRADE_TIMES];
    double cep[IMK_GRADE_TIMES]; /**< [m]; NaN: no longer a position */
    imk_grade grade;
} imk_grade_way;

/** A source of error, and its share or the factor by which it must become better. */
typedef struct imk_grade_share {
    char text[64];
    double value;
} imk_grade_share;

enum { IMK_GRADE_SHARES = 4, IMK_GRADE_OMITTED = 24 };

/** What was found of a model. */
typedef struct imk_graded {
    const imk_model *model;
    imk_allocator allocator;
    imk_findings findings;
    imk_grade_result table;         /**< by its biases */
    double gyro_scale, accel_scale; /**< what stays of the scale factors, worst axis [1]; NaN: not
                                         stated */
    const char *no_position;        /**< why none is computed: a text that lives for ever; NULL:
                                         there is one, and with it all below */
    imk_grade_way way[IMK_GRADE_WAYS];
    bool compensation_matters;
    size_t share_count;
    imk_grade_share share[IMK_GRADE_SHARES]; /**< the largest shares of the horizontal variance
                                                  after an hour, 0 … 1 */
    bool shifted;                            /**< known values make more of the error than that */
    imk_grade next;  /**< the next better class; IMK_GRADE_NONE: it is the best */
    double next_all; /**< every source times this is enough for it */
    size_t need_count;
    imk_grade_share need[IMK_GRADE_SHARES]; /**< or these alone, each so many times better, the most
                                                 first */
    size_t need_more;                       /**< and so many others */
    size_t omitted_count;
    const char *omitted[IMK_GRADE_OMITTED]; /**< what the linear figures leave out */
} imk_graded;

/** Grade a model, which outlives the result.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_graded_free(), also after a failure, because it then holds the
 *                 findings; NULL if there was no memory for it
 *  @return as imk_drift_covariance(); IMK_ERROR_MEMORY; with a finding, IMK_ERROR_EMPTY (a model
 *          with neither biases nor a position) */
IMK_API imk_status imk_grade_run(const imk_model *model, const imk_job *job, imk_graded **result,
                                 imk_error *error);
/** Free it and all it holds; NULL is allowed. */
IMK_API void imk_graded_free(imk_graded *result);

IMK_END_C
#endif
