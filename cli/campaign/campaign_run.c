/* SPDX-License-Identifier: Apache-2.0 */
/* A campaign on the threads of this process. imukit-mpi has another file in place of this one. */
#include "campaign_job.h"

void campaign_begin(int *argument_count, char ***arguments)
{
    (void)argument_count;
    (void)arguments;
}

int campaign_end(int code)
{
    return code;
}

size_t campaign_threads(uint64_t asked)
{
    if (asked > 0)
        return (size_t)asked;
    imk_thread_pool *pool = imk_thread_pool_create(0);
    const size_t threads = imk_thread_pool_threads(pool);
    imk_thread_pool_destroy(pool);
    return threads;
}

typedef struct shared {
    campaign_job job;
    const campaign_work *work;
} shared;

static void work_on(void *context, size_t item)
{
    shared *s = context;
    campaign_job_work(&s->job, s->work, item);
}

int campaign_run(const imk_campaign *campaign, uint64_t first, uint64_t runs,
                 const campaign_work *work, const char *path, double **values)
{
    shared s = {.work = work};
    int code =
        campaign_job_open(&s.job, campaign, first, runs, work->at_once, path, values != NULL);
    if (code >= 0)
        return code;
    const size_t threads = work->threads < s.job.batch_count ? work->threads : s.job.batch_count;
    imk_thread_pool *pool = threads > 1 ? imk_thread_pool_create(threads) : NULL;
    const imk_executor executor = imk_thread_pool_executor(pool);
    imk_execute(&executor, threads, work_on, &s);
    imk_thread_pool_destroy(pool);
    return campaign_job_close(&s.job, values);
}
