/* SPDX-License-Identifier: Apache-2.0 */
/* One line for each stage of a job. */
#include "job_progress.h"
#include "voice.h"

#include "imukit/memory_limit.h"

#include <stdio.h>
#include <string.h>

static bool show(void *context, const char *stage, const char *unit, uint64_t done, uint64_t total)
{
    job_progress *p = context;
    if (strcmp(p->stage, stage) != 0) {
        progress_end(&p->shown);
        snprintf(p->stage, sizeof p->stage, "%s", stage);
        snprintf(p->unit, sizeof p->unit, "%s", unit);
        const bool reading = strcmp(stage, "reading") == 0;
        snprintf(p->label, sizeof p->label, "%.30s%s%.100s", stage, reading ? " " : "",
                 reading ? p->path : "");
        p->shown = progress_begin(p->label, p->unit, 1);
    }
    progress_update(&p->shown, done, total);
    return !voice_interrupted();
}

job_progress job_progress_begin(const char *path)
{
    return (job_progress){.path = path};
}

imk_job job_progress_job(job_progress *p, const imk_executor *executor)
{
    return (imk_job){.executor = executor,
                     .progress = show,
                     .progress_context = p,
                     .memory = imk_memory_limit() / 2};
}

void job_progress_end(job_progress *p)
{
    progress_end(&p->shown);
}

void threaded_job_begin(threaded_job *t, const char *path, uint64_t threads)
{
    t->pool = imk_thread_pool_create(threads);
    t->executor = imk_thread_pool_executor(t->pool);
    t->shown = job_progress_begin(path);
    t->job = job_progress_job(&t->shown, &t->executor);
}

void threaded_job_end(threaded_job *t)
{
    job_progress_end(&t->shown);
    imk_thread_pool_destroy(t->pool);
}
