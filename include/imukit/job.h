/* SPDX-License-Identifier: Apache-2.0 */
/** @file job.h
 *  What all jobs have in common: memory, threads, progress, and findings as data.
 *
 *  A job does for a program what a verb of the command does for a person: settings and a record
 *  source in (record.h), a result out, which one function frees. It opens no file and makes no
 *  thread. What it comes across on the way are findings: a code, numbers and a channel, of which
 *  imk_finding_text() makes a message. */
#ifndef IMUKIT_JOB_H
#define IMUKIT_JOB_H

#include "imukit/allocator.h"
#include "imukit/executor.h"
#include "imukit/status.h"

#include <stdbool.h>

IMK_BEGIN_C

/** Called now and then by long work, by one thread at a time.
 *  @param stage  what is done: "reading", "identifying", the name of a channel
 *  @param unit   of the count: "B", "channels", "points"
 *  @param total  0: not known
 *  @return false to give up: the job ends with IMK_ERROR_CANCELLED */
typedef bool (*imk_job_progress)(void *context, const char *stage, const char *unit, uint64_t done,
                                 uint64_t total);

/** How a job runs. All zeros is valid: one thread, the C library's memory, silence. */
typedef struct imk_job {
    imk_allocator allocator;
    const imk_executor *executor; /**< NULL: one thread */
    imk_job_progress progress;    /**< NULL: none */
    void *progress_context;
    size_t memory; /**< bytes that a record may take as a whole; 0: no limit */
} imk_job;

typedef enum imk_finding_level {
    IMK_FINDING_GOOD = 0,
    IMK_FINDING_NOTE,
    IMK_FINDING_WARNING,
    IMK_FINDING_FAILURE /**< why the job ended without a result */
} imk_finding_level;

enum { IMK_FINDINGS_MAX = 64, IMK_FINDING_NUMBERS = 6 };

/** Something a job came across. */
typedef struct imk_finding {
    const char *code; /**< "jitter", "compensate:gaps"; lives for ever */
    imk_finding_level level;
    char name[96];                      /**< the channel it is about, or a word; "" */
    double number[IMK_FINDING_NUMBERS]; /**< what they are says finding_text.c, by code */
} imk_finding;

typedef struct imk_findings {
    size_t count;
    imk_finding item[IMK_FINDINGS_MAX];
} imk_findings;

/** The finding why a job failed, or NULL: then the imk_error says it. */
IMK_API const imk_finding *imk_findings_failure(const imk_findings *findings);

/** The message of a finding, without the name of the record.
 *  @return its length, as snprintf() */
IMK_API size_t imk_finding_text(const imk_finding *finding, char *text, size_t size);
/** The message with what the record and the model are called; that of a failure that tells of
 *  neither begins with the record. @param record  NULL: it is about none. @return likewise */
IMK_API size_t imk_finding_message(const imk_finding *finding, const char *record,
                                   const char *model, char *text, size_t size);
/** The code without what tells it from one of that name in other jobs: "gaps". */
IMK_API const char *imk_finding_code(const imk_finding *finding);

IMK_END_C
#endif
