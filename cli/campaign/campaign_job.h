/* SPDX-License-Identifier: Apache-2.0 */
/* The state of a campaign while it is computed: which runs are missing, where results go, which
 * errors occurred. Each worker takes batches and brings their values back, in any order, from any
 * thread. */
#ifndef IMUKIT_CAMPAIGN_JOB_H
#define IMUKIT_CAMPAIGN_JOB_H

#include "campaign_run.h"
#include "shell/progress.h"

#include <pthread.h>

/* Consecutive runs. */
typedef struct campaign_batch {
    uint64_t first, count;
} campaign_batch;

typedef struct campaign_job {
    const imk_campaign *campaign;
    uint64_t first, runs;
    size_t run_values;           /* numbers of a run */
    imk_campaign_writer *writer; /* NULL: in memory only */
    double *values;              /* NULL: not wanted */
    campaign_batch *batches;     /* of the runs that are not there */
    size_t batch_count, next;
    uint64_t due, done; /* runs to compute, and computed */
    pthread_mutex_t mutex;
    bool failed;
    imk_error error;
    progress line;
} campaign_job;

/* @param at_once  runs of a batch, at most
 * @return -1 or the exit code */
int campaign_job_open(campaign_job *job, const imk_campaign *campaign, uint64_t first,
                      uint64_t runs, size_t at_once, const char *path, bool values_wanted);
/* @return false when there is none, or something has failed */
bool campaign_job_take(campaign_job *job, campaign_batch *batch);
void campaign_job_bring(campaign_job *job, campaign_batch batch, const double *values);
void campaign_job_fail(campaign_job *job, const imk_error *error);
/* Compute batches until there are none left. */
void campaign_job_work(campaign_job *job, const campaign_work *work, size_t thread);
/* Write the results file, or say what failed. @return -1 or the exit code */
int campaign_job_close(campaign_job *job, double **values);

#endif
