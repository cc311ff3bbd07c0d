/* SPDX-License-Identifier: Apache-2.0 */
/** @file job.h
 *  Common parts of all jobs: memory, threads, progress, and findings as data.
 *
 *  A job does for a program what a verb of the command does for a person. It takes settings and a
 *  record source (record.h) and gives a result, which one function frees. It opens no file and
 *  makes no thread. A job reports what it notices in the data as findings: a code, numbers and a
 *  channel. imk_finding_text() makes a message of a finding. */
#ifndef IMUKIT_JOB_H
#define IMUKIT_JOB_H

#include "imukit/allocator.h"
#include "imukit/executor.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Called now and then during long work, never by two threads at once.
 *  @param context  imk_job.progress_context
 *  @param stage    what the job does at present: "reading", "identifying", the name of a channel
 *  @param unit     of `done` and `total`: "B", "channels", "points"
 *  @param total    0: not known
 *  @return false to stop: the job ends with IMK_ERROR_CANCELLED */
typedef bool (*imk_job_progress)(void *context, const char *stage, const char *unit, uint64_t done,
                                 uint64_t total);

/** How a job runs. A structure of zeros is valid: one thread, the memory of the C library, no
 *  progress and no limit. */
typedef struct imk_job {
    imk_allocator allocator;      /**< memory of results and workspaces */
    const imk_executor *executor; /**< NULL: one thread */
    imk_job_progress progress;    /**< NULL: progress is not reported */
    void *progress_context;
    size_t memory; /**< bytes that a record may take as a whole; 0: no limit */
} imk_job;

/** Severity of a finding. */
typedef enum imk_finding_level {
    IMK_FINDING_GOOD = 0,
    IMK_FINDING_NOTE,
    IMK_FINDING_WARNING,
    IMK_FINDING_FAILURE /**< the reason why the job ended without a result */
} imk_finding_level;

enum { IMK_FINDINGS_MAX = 64, IMK_FINDING_NUMBERS = 6 };

/** One thing that a job noticed. */
typedef struct imk_finding {
    const char *code; /**< "jitter", "compensate:gaps"; a constant string */
    imk_finding_level level;
    char name[96]; /**< the channel concerned, or another word; may be "" */
    /** Numbers of the message; the code decides their meaning. */
    double number[IMK_FINDING_NUMBERS];
} imk_finding;

/** The findings of a job in the order in which it noticed them. */
typedef struct imk_findings {
    size_t count;
    imk_finding item[IMK_FINDINGS_MAX];
} imk_findings;

/** The finding that says why a job failed. NULL: there is none, and the imk_error says why. */
IMK_API const imk_finding *imk_findings_failure(const imk_findings *findings);

/** Write the message of a finding, which says "the record" and "the model" instead of their names.
 *  @param size  of `text` [bytes]
 *  @return length of the whole message, as snprintf() */
IMK_API size_t imk_finding_text(const imk_finding *finding, char *text, size_t size);
/** Write the message of a finding with the names of the record and the model. The message of a
 *  failure begins with the record's name if it mentions neither.
 *  @param record,model  their names, such as those of their files; record NULL: it is about none
 *  @return length of the whole message, as snprintf() */
IMK_API size_t imk_finding_message(const imk_finding *finding, const char *record,
                                   const char *model, char *text, size_t size);
/** The code of a finding without the prefix of the job: "gaps" for "compensate:gaps". */
IMK_API const char *imk_finding_code(const imk_finding *finding);

IMK_END_C
#endif
