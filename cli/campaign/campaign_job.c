/* SPDX-License-Identifier: Apache-2.0 */
/* A run gives the same bytes wherever and whenever it is computed. Only the order in the file
 * matters, and the library keeps it. */
#define _POSIX_C_SOURCE 200809L
#include "campaign_job.h"
#include "shell/voice.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- interrupted ---- */

/* A signal handler writes this text, so it is composed beforehand. */
static char farewell[1024];
static const int ending_signals[] = {SIGINT, SIGTERM, SIGHUP};
enum { ENDING_SIGNALS = sizeof ending_signals / sizeof ending_signals[0] };
static struct sigaction before[ENDING_SIGNALS];

/* End as the signal would have. PATH.part is complete without further work. */
static void interrupted(int number)
{
    const ssize_t written = write(STDERR_FILENO, farewell, strlen(farewell));
    (void)written;
    imk_output_file_abandon_all();
    signal(number, SIG_DFL);
    raise(number);
}

static void catch_signals(const char *path)
{
    struct sigaction action = {.sa_handler = interrupted};
    snprintf(farewell, sizeof farewell,
             "%simukit: interrupted: the runs computed so far are kept in %.800s.part, and the "
             "same command continues from there\n",
             isatty(STDERR_FILENO) ? "\r\033[K" : "", path);
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < ENDING_SIGNALS; i++)
        sigaddset(&action.sa_mask, ending_signals[i]);
    for (int i = 0; i < ENDING_SIGNALS; i++)
        if (sigaction(ending_signals[i], NULL, &before[i]) == 0 && before[i].sa_handler != SIG_IGN)
            sigaction(ending_signals[i], &action, NULL);
}

static void release_signals(void)
{
    for (int i = 0; i < ENDING_SIGNALS; i++)
        sigaction(ending_signals[i], &before[i], NULL);
}

/* ---- which runs are due ---- */

static bool is_there(const campaign_job *job, uint64_t run)
{
    return job->writer && imk_campaign_has(job->writer, run);
}

/* Batches of the missing runs. @return false when memory is exhausted */
static bool make_batches(campaign_job *job, size_t at_once)
{
    const uint64_t end = job->first + job->runs;
    for (int pass = 0; pass < 2; pass++) {
        job->batch_count = 0;
        for (uint64_t run = job->first; run < end;) {
            uint64_t count = 0;
            while (count < at_once && run + count < end && !is_there(job, run + count))
                count++;
            if (count > 0 && pass == 1)
                job->batches[job->batch_count] = (campaign_batch){run, count};
            job->batch_count += count > 0;
            job->due += pass == 1 ? count : 0;
            run += count > 0 ? count : 1;
        }
        if (pass == 0 && !(job->batches = calloc(job->batch_count + 1, sizeof *job->batches)))
            return false;
    }
    return true;
}

/* The values of what is there. */
static imk_status read_values(campaign_job *job, imk_error *error)
{
    imk_status status = IMK_OK;
    for (uint64_t i = 0; i < job->runs && status == IMK_OK; i++)
        if (is_there(job, job->first + i))
            status = imk_campaign_read(job->writer, job->first + i, 1,
                                       job->values + i * job->run_values, error);
    return status;
}

static void abandon(campaign_job *job)
{
    imk_campaign_stop(job->writer);
    free(job->values);
    free(job->batches);
    pthread_mutex_destroy(&job->mutex);
    *job = (campaign_job){0};
}

static int start(campaign_job *job, size_t at_once, const char *path, bool values_wanted)
{
    imk_error error;
    if (path && imk_campaign_create(path, job->campaign, job->first, job->runs, &job->writer,
                                    &error) != IMK_OK)
        return command_error(&error, NULL);
    if (values_wanted && (job->runs > SIZE_MAX / sizeof(double) / job->run_values ||
                          !(job->values = malloc(job->runs * job->run_values * sizeof(double)))))
        return command_failed_by("memory", NULL, NULL,
                                 "memory is exhausted: %llu runs are too many to hold at once",
                                 (unsigned long long)job->runs);
    if (!make_batches(job, at_once))
        return command_failed_by("memory", NULL, NULL, "memory is exhausted");
    if (job->values && read_values(job, &error) != IMK_OK)
        return command_error(&error, NULL);
    return -1;
}

int campaign_job_open(campaign_job *job, const imk_campaign *campaign, uint64_t first,
                      uint64_t runs, size_t at_once, const char *path, bool values_wanted)
{
    *job = (campaign_job){.campaign = campaign, .first = first, .runs = runs};
    job->run_values = campaign->time_count * campaign->state_count;
    pthread_mutex_init(&job->mutex, NULL);
    const int code = start(job, at_once > 0 ? at_once : 1, path, values_wanted);
    if (code >= 0) {
        abandon(job);
        return code;
    }
    if (job->writer) {
        if (job->due < runs)
            command_note("runs_exist", "%llu of %llu runs exist already",
                         (unsigned long long)(runs - job->due), (unsigned long long)runs);
        catch_signals(path);
    }
    job->line = progress_begin("Monte Carlo", "runs", 1);
    return -1;
}

/* ---- at work ---- */

void campaign_job_fail(campaign_job *job, const imk_error *error)
{
    pthread_mutex_lock(&job->mutex);
    if (!job->failed)
        job->error = *error;
    job->failed = true;
    pthread_mutex_unlock(&job->mutex);
}

bool campaign_job_take(campaign_job *job, campaign_batch *batch)
{
    imk_error error;
    if (voice_interrupted()) {
        imk_error_set(&error, IMK_ERROR_CANCELLED, NULL, NULL, NULL);
        campaign_job_fail(job, &error);
    }
    pthread_mutex_lock(&job->mutex);
    const bool there = !job->failed && job->next < job->batch_count;
    if (there)
        *batch = job->batches[job->next++];
    pthread_mutex_unlock(&job->mutex);
    return there;
}

void campaign_job_bring(campaign_job *job, campaign_batch batch, const double *values)
{
    imk_error error;
    if (job->writer &&
        imk_campaign_add(job->writer, batch.first, batch.count, values, &error) != IMK_OK) {
        campaign_job_fail(job, &error);
        return;
    }
    if (job->values)
        memcpy(job->values + (batch.first - job->first) * job->run_values, values,
               batch.count * job->run_values * sizeof *values);
    pthread_mutex_lock(&job->mutex);
    job->done += batch.count;
    progress_update(&job->line, job->done, job->due);
    pthread_mutex_unlock(&job->mutex);
}

void campaign_job_work(campaign_job *job, const campaign_work *work, size_t thread)
{
    campaign_batch batch;
    imk_error error;
    double *values = malloc(work->at_once * job->run_values * sizeof *values);
    if (!values) {
        imk_error_set(&error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        campaign_job_fail(job, &error);
        return;
    }
    while (campaign_job_take(job, &batch)) {
        if (work->run(work->context, thread, batch.first, (size_t)batch.count, values, &error) !=
            IMK_OK)
            campaign_job_fail(job, &error);
        else
            campaign_job_bring(job, batch, values);
    }
    free(values);
}

int campaign_job_close(campaign_job *job, double **values)
{
    int code = -1;
    const bool caught = job->writer != NULL;
    progress_end(&job->line);
    if (job->failed) {
        code = command_error(&job->error, NULL);
    } else if (job->writer) {
        imk_error error;
        if (imk_campaign_commit(job->writer, &error) != IMK_OK)
            code = command_error(&error, NULL);
        job->writer = NULL;
    }
    /* Signals are held until here, because a large file takes time to write: PATH.part stays until
     * it has its final name. */
    if (caught)
        release_signals();
    if (code < 0 && values) {
        *values = job->values;
        job->values = NULL;
    }
    abandon(job);
    return code;
}
