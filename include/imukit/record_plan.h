/* SPDX-License-Identifier: Apache-2.0 */
/** @file record_plan.h
 *  The job of `imukit identify --plan`: how well a record will tell each parameter of a model's
 *  noise, and how long it must be (identify_plan.h). Of the axes of a triad the worst counts. */
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
    double rate;         /**< of the record [Hz]; must be set */
    double duration;     /**< planned [s]; 0: as long as the requirements need */
    double significance; /**< as of imk_bounds_settings; default 0.01 */
    const char *want;    /**< requirements, "bias_instability 5%, gyro.rate_random_walk detected
                              95%": a term, and its 1 sigma in per cent of itself, or the chance
                              that it is found; NULL: none */
    bool curve;          /**< also IMK_PLAN_CURVE records from a minute to a week; default false */
} imk_record_plan_settings;

/** Terms at 1 % significance; the rate must be set. */
IMK_API imk_record_plan_settings imk_record_plan_default(void);

/** A parameter of the gyros or of the accelerometers. */
typedef struct imk_plan_parameter {
    int sensor;       /**< IMK_GYRO or IMK_ACCEL */
    bool time;        /**< the correlation time of a Gauss-Markov term */
    int term;         /**< imk_noise_term; IMK_NOISE_TERMS + i: Gauss-Markov term i */
    char key[48];     /**< as in the model file */
    imk_unit unit;    /**< readable */
    double low, high; /**< over the axes that have it */
} imk_plan_parameter;

typedef struct imk_plan_requirement {
    char text[96];
    size_t parameter;
    double relative, detection; /**< as of imk_identify_requirement */
    double duration;            /**< that meets it [s]; infinite: none does */
} imk_plan_requirement;

/** What a record tells. */
typedef struct imk_plan_record {
    double duration; /**< [s] */
    bool planned;
    bool told; /**< false: it is too short or too long for any statement */
    double relative[IMK_PLAN_PARAMETERS_MAX], detection[IMK_PLAN_PARAMETERS_MAX];
} imk_plan_record;

/** What was found. */
typedef struct imk_record_plan {
    imk_record_plan_settings settings;
    double duration; /**< planned [s]; 0: none */
    bool met;        /**< are all requirements, by a record of that length? */
    size_t parameter_count, requirement_count, record_count, curve_count;
    imk_plan_parameter parameter[IMK_PLAN_PARAMETERS_MAX]; /**< those of the gyros first */
    imk_plan_requirement requirement[IMK_PLAN_REQUIREMENTS_MAX];
    imk_plan_record record[IMK_PLAN_RECORDS_MAX]; /**< ten minutes to a day, and what is planned */
    imk_plan_record curve[IMK_PLAN_CURVE];
    imk_findings findings;
} imk_record_plan;

/** Plan the record of a model's noise.
 *  @param job     NULL: one thread, no progress, the memory of the C library
 *  @param result  free it with imk_record_plan_free(), also after a failure, because it then holds
 *                 the findings; NULL if there was no memory for it
 *  @return as imk_identify_duration(); IMK_ERROR_MEMORY; with a finding that says why:
 *          IMK_ERROR_RANGE (the length), _EMPTY (no noise), _SYNTAX and _NAME_UNKNOWN (a
 *          requirement) */
IMK_API imk_status imk_record_plan_run(const imk_model *model,
                                       const imk_record_plan_settings *settings, const imk_job *job,
                                       imk_record_plan **result, imk_error *error);
/** @param allocator  of the job that made it */
IMK_API void imk_record_plan_free(imk_record_plan *result, const imk_allocator *allocator);

IMK_END_C
#endif
