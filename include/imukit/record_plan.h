/* SPDX-License-Identifier: Apache-2.0 */
/** @file record_plan.h
 *  The job of `imukit identify --plan`: how accurately a record will determine each noise parameter
 *  of a model, and how long the record must be (identify_plan.h). Of the axes of a triad, the worst
 *  one counts. */
#ifndef IMUKIT_RECORD_PLAN_H
#define IMUKIT_RECORD_PLAN_H

#include "imukit/identify_log.h"
#include "imukit/identify_plan.h"
#include "imukit/job.h"

IMK_BEGIN_C

enum {
    IMK_PLAN_PARAMETERS_MAX = 2 * (IMK_NOISE_TERMS + 2 * IMK_TERMS_MAX),
    IMK_PLAN_REQUIREMENTS_MAX = 16,
    IMK_PLAN_RECORDS_MAX = 6,
    IMK_PLAN_CURVE = 61
};

/** Settings of the job. Start from imk_record_plan_default(). */
typedef struct imk_record_plan_settings {
    uint32_t cookie;
    double rate;         /**< sampling rate of the record [Hz]; must be set */
    double duration;     /**< planned length [s]; 0: the length that meets the requirements */
    double significance; /**< see imk_bounds_settings; default 0.01 */
    const char *want; /**< requirements, "bias_instability 5%, gyro.rate_random_walk detected 95%":
                         a term, and either its 1 sigma in per cent of its value or the probability
                         that it is detected; NULL: none */
    bool curve; /**< also assess IMK_PLAN_CURVE lengths from a minute to a week; default false */
} imk_record_plan_settings;

/** 1 % significance, no requirements; the rate must be set. */
IMK_API imk_record_plan_settings imk_record_plan_default(void);

/** A parameter of the gyros or of the accelerometers. */
typedef struct imk_plan_parameter {
    int sensor;       /**< IMK_GYRO or IMK_ACCEL */
    bool time;        /**< true: the correlation time of a Gauss-Markov term, not its strength */
    int term;         /**< imk_noise_term; IMK_NOISE_TERMS + i: Gauss-Markov term i */
    char key[48];     /**< its key in the model file */
    imk_unit unit;    /**< unit that a person reads */
    double low, high; /**< smallest and largest value of the axes that have the term [SI] */
} imk_plan_parameter;

/** A requirement of settings.want. */
typedef struct imk_plan_requirement {
    char text[96];              /**< as it was stated */
    size_t parameter;           /**< index in imk_record_plan.parameter */
    double relative, detection; /**< see imk_identify_requirement */
    double duration; /**< shortest record that meets the requirement [s]; infinite: none does */
} imk_plan_requirement;

/** How accurate the parameters from a record of one length will be. */
typedef struct imk_plan_record {
    double duration; /**< length of the record [s] */
    bool planned;    /**< true: the record of the planned length */
    bool told;       /**< false: too short or too long; the accuracy is then not known */
    double relative[IMK_PLAN_PARAMETERS_MAX], detection[IMK_PLAN_PARAMETERS_MAX];
} imk_plan_record;

/** Result of the job. */
typedef struct imk_record_plan {
    imk_record_plan_settings settings;
    double duration; /**< planned length [s]; 0: none */
    bool met;        /**< true when a record of that length meets all requirements */
    size_t parameter_count, requirement_count, record_count, curve_count;
    imk_plan_parameter parameter[IMK_PLAN_PARAMETERS_MAX]; /**< the gyros' first */
    imk_plan_requirement requirement[IMK_PLAN_REQUIREMENTS_MAX];
    /** Records of ten minutes to a day, and the planned one. */
    imk_plan_record record[IMK_PLAN_RECORDS_MAX];
    imk_plan_record curve[IMK_PLAN_CURVE]; /**< with settings.curve: a minute to a week */
    imk_findings findings;
} imk_record_plan;

/** Plan a record that determines the noise of a model.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_record_plan_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return errors of imk_identify_duration(); IMK_ERROR_RANGE (rate, duration, significance);
 *          IMK_ERROR_MEMORY; with a finding that says why: IMK_ERROR_RANGE (duration),
 *          _EMPTY (no noise), _SYNTAX and _NAME_UNKNOWN (in a requirement) */
IMK_API imk_status imk_record_plan_run(const imk_model *model,
                                       const imk_record_plan_settings *settings, const imk_job *job,
                                       imk_record_plan **result, imk_error *error);
/** Free the result; NULL is allowed. @param allocator  that of the job that made the result */
IMK_API void imk_record_plan_free(imk_record_plan *result, const imk_allocator *allocator);

IMK_END_C
#endif
