/* SPDX-License-Identifier: Apache-2.0 */
/* The progress of a job of the library as lines of the terminal. */
#ifndef IMUKIT_JOB_PROGRESS_H
#define IMUKIT_JOB_PROGRESS_H

#include "progress.h"

#include "imukit/job.h"
#include "imukit/thread_pool.h"

typedef struct job_progress {
    progress shown;
    const char *path; /* behind "reading" */
    char stage[64], label[140], unit[16];
} job_progress;

job_progress job_progress_begin(const char *path);
/* A job whose progress is shown, on these threads (NULL: one), in the memory of this machine. */
imk_job job_progress_job(job_progress *p, const imk_executor *executor);
void job_progress_end(job_progress *p);

/* A job with its progress on so many threads (0: all processors). It points into itself. */
typedef struct threaded_job {
    imk_job job;
    job_progress shown;
    imk_thread_pool *pool;
    imk_executor executor;
} threaded_job;

void threaded_job_begin(threaded_job *t, const char *path, uint64_t threads);
void threaded_job_end(threaded_job *t);

#endif
