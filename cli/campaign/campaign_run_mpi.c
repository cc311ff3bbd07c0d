/* SPDX-License-Identifier: Apache-2.0 */
/* A campaign on the ranks of imukit-mpi, in place of campaign_run.c.
 *
 * Rank 0 keeps the books: its main thread answers the other ranks while its other threads compute
 * as theirs do. A rank asks for as many batches as it has threads and brings the values of those
 * before along, so that fast ranks compute more. All ranks read the same command line; all ranks
 * but the first are silent and wait for their discharge, which rank 0 sends exactly once to
 * each. */
#define _POSIX_C_SOURCE 200809L
#include "campaign_job.h"

#include <mpi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TAG_ASK = 1, TAG_VALUES, TAG_ERROR, TAG_BATCHES };

static int rank, ranks;
static bool discharged; /* rank 0: the other ranks have been discharged; other ranks: this rank has
                         * been discharged */

/* ---- first and last ---- */

/* The other ranks take part in campaigns only: rank 0 writes everything that a verb writes. */
static bool takes_part(int argument_count, char **arguments)
{
    static const char name[] = "--monte-carlo";
    for (int i = 2; i < argument_count; i++)
        if (strncmp(arguments[i], name, sizeof name - 1) == 0 ||
            strncmp(arguments[i], "-n", 2) == 0)
            return strcmp(arguments[1], "drift") == 0;
    return false;
}

static void discharge_others(void)
{
    for (int other = 1; other < ranks && !discharged; other++)
        MPI_Send(NULL, 0, MPI_UINT64_T, other, TAG_BATCHES, MPI_COMM_WORLD);
    discharged = true;
}

/* Take what rank 0 sends until it is the discharge: nothing. */
static void await_discharge(void)
{
    int count = 1;
    while (!discharged && count > 0) {
        uint64_t ignored[2];
        MPI_Status status;
        MPI_Probe(0, TAG_BATCHES, MPI_COMM_WORLD, &status);
        MPI_Get_count(&status, MPI_UINT64_T, &count);
        MPI_Recv(ignored, 2, MPI_UINT64_T, 0, TAG_BATCHES, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    discharged = true;
}

int campaign_end(int code)
{
    if (rank == 0)
        discharge_others();
    else
        await_discharge();
    MPI_Finalize();
    return rank == 0 ? code : EXIT_DONE;
}

void campaign_begin(int *argument_count, char ***arguments)
{
    int provided;
    MPI_Init_thread(argument_count, arguments, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (rank == 0)
        return;
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
        MPI_Abort(MPI_COMM_WORLD, EXIT_FAILED);
    if (!takes_part(*argument_count, *arguments))
        exit(campaign_end(EXIT_DONE));
}

size_t campaign_threads(uint64_t asked)
{
    return asked > 0 ? (size_t)asked : 1;
}

/* ---- the other ranks ---- */

typedef struct team {
    const campaign_work *work;
    size_t run_values, count;
    campaign_batch *batches;
    double *values; /* of each batch, work->at_once runs apart */
    imk_status *status;
    imk_error *error;
} team;

static double *batch_values(const team *t, size_t item)
{
    return t->values + item * t->work->at_once * t->run_values;
}

static void compute(void *context, size_t item)
{
    team *t = context;
    t->status[item] =
        t->work->run(t->work->context, item, t->batches[item].first, (size_t)t->batches[item].count,
                     batch_values(t, item), &t->error[item]);
}

/* @return false when discharged */
static bool ask(team *t, uint64_t wanted)
{
    int count;
    MPI_Status status;
    MPI_Send(&wanted, 1, MPI_UINT64_T, 0, TAG_ASK, MPI_COMM_WORLD);
    MPI_Recv(t->batches, (int)(2 * wanted), MPI_UINT64_T, 0, TAG_BATCHES, MPI_COMM_WORLD, &status);
    MPI_Get_count(&status, MPI_UINT64_T, &count);
    t->count = (size_t)count / 2;
    return t->count > 0;
}

static void bring(const team *t)
{
    for (size_t i = 0; i < t->count; i++) {
        const campaign_batch b = t->batches[i];
        if (t->status[i] != IMK_OK) {
            MPI_Send(&t->error[i], sizeof t->error[i], MPI_BYTE, 0, TAG_ERROR, MPI_COMM_WORLD);
            continue;
        }
        /* The batch, then its values: messages between two ranks keep their order. */
        MPI_Send(&b, 2, MPI_UINT64_T, 0, TAG_VALUES, MPI_COMM_WORLD);
        MPI_Send(batch_values(t, i), (int)(b.count * t->run_values), MPI_DOUBLE, 0, TAG_VALUES,
                 MPI_COMM_WORLD);
    }
}

/* Compute what rank 0 gives, then end. A rank without memory says so and asks for nothing. */
static void follow(const imk_campaign *campaign, const campaign_work *work)
{
    const size_t threads = work->threads;
    team t = {.work = work, .run_values = campaign->time_count * campaign->state_count};
    t.batches = calloc(threads, sizeof *t.batches);
    t.status = calloc(threads, sizeof *t.status);
    t.error = calloc(threads, sizeof *t.error);
    t.values = malloc(threads * work->at_once * t.run_values * sizeof *t.values);
    imk_thread_pool *pool = threads > 1 ? imk_thread_pool_create(threads) : NULL;
    const imk_executor executor = imk_thread_pool_executor(pool);
    if (t.batches && t.status && t.error && t.values) {
        while (ask(&t, threads)) {
            imk_execute(&executor, t.count, compute, &t);
            bring(&t);
        }
    } else {
        imk_error error;
        imk_error_set(&error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        MPI_Send(&error, sizeof error, MPI_BYTE, 0, TAG_ERROR, MPI_COMM_WORLD);
        ask(&t, 0);
    }
    discharged = true;
    imk_thread_pool_destroy(pool);
    free(t.batches);
    free(t.status);
    free(t.error);
    free(t.values);
    exit(campaign_end(EXIT_DONE));
}

/* ---- rank 0 ---- */

typedef struct lead {
    campaign_job job;
    const campaign_work *work;
    double *values;   /* what another rank brings */
    int let_go_count; /* ranks that were told that there is nothing left */
    size_t computing; /* threads at work here; under the mutex of the job */
} lead;

/* A thread of this rank, identified by its number. */
typedef struct worker {
    lead *lead;
    size_t number;
    pthread_t thread;
} worker;

static void *work_on(void *argument)
{
    worker *w = argument;
    campaign_job_work(&w->lead->job, w->lead->work, w->number);
    pthread_mutex_lock(&w->lead->job.mutex);
    w->lead->computing--;
    pthread_mutex_unlock(&w->lead->job.mutex);
    return NULL;
}

/* A rank wants batches: some, or its discharge. */
static void give(lead *l, int other)
{
    uint64_t wanted, count = 0;
    MPI_Recv(&wanted, 1, MPI_UINT64_T, other, TAG_ASK, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    campaign_batch *batches = calloc(wanted, sizeof *batches);
    while (batches && count < wanted && campaign_job_take(&l->job, &batches[count]))
        count++;
    MPI_Send(batches, (int)(2 * count), MPI_UINT64_T, other, TAG_BATCHES, MPI_COMM_WORLD);
    free(batches);
    l->let_go_count += count == 0;
}

static void receive(lead *l, const MPI_Status *message)
{
    const int other = message->MPI_SOURCE;
    if (message->MPI_TAG == TAG_ASK) {
        give(l, other);
    } else if (message->MPI_TAG == TAG_ERROR) {
        imk_error error;
        MPI_Recv(&error, sizeof error, MPI_BYTE, other, TAG_ERROR, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
        campaign_job_fail(&l->job, &error);
    } else {
        campaign_batch batch;
        MPI_Recv(&batch, 2, MPI_UINT64_T, other, TAG_VALUES, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        MPI_Recv(l->values, (int)(batch.count * l->job.run_values), MPI_DOUBLE, other, TAG_VALUES,
                 MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        campaign_job_bring(&l->job, batch, l->values);
    }
}

/* Answer the others until all have been let go and the threads here are done. Looking for messages
 * without pause would take a processor from the computation; a pause of 0.2 ms is short against a
 * batch. */
static void answer(lead *l)
{
    const struct timespec pause = {.tv_nsec = 200000};
    bool busy = true;
    while (busy) {
        int there;
        MPI_Status message;
        MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &message);
        if (there)
            receive(l, &message);
        else
            nanosleep(&pause, NULL);
        pthread_mutex_lock(&l->job.mutex);
        busy = l->computing > 0 || (!discharged && l->let_go_count < ranks - 1);
        pthread_mutex_unlock(&l->job.mutex);
    }
    discharged = true;
}

/* Start the threads that compute here. @return how many there are */
static size_t start_workers(lead *l, worker *workers, size_t count)
{
    sigset_t all, before;
    size_t started = 0;
    /* Handlers run on the main thread. */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    for (; started < count; started++) {
        workers[started] = (worker){.lead = l, .number = started};
        pthread_mutex_lock(&l->job.mutex);
        l->computing++;
        pthread_mutex_unlock(&l->job.mutex);
        if (pthread_create(&workers[started].thread, NULL, work_on, &workers[started]) != 0) {
            pthread_mutex_lock(&l->job.mutex);
            l->computing--;
            pthread_mutex_unlock(&l->job.mutex);
            break;
        }
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

int campaign_run(const imk_campaign *campaign, uint64_t first, uint64_t runs,
                 const campaign_work *work, const char *path, double **values)
{
    if (rank > 0)
        follow(campaign, work);
    lead l = {.work = work};
    int code =
        campaign_job_open(&l.job, campaign, first, runs, work->at_once, path, values != NULL);
    if (code >= 0)
        return code;
    worker *workers = calloc(work->threads, sizeof *workers);
    l.values = malloc(work->at_once * l.job.run_values * sizeof *l.values);
    const size_t started = workers && l.values ? start_workers(&l, workers, work->threads) : 0;
    if (started == 0) {
        imk_error error;
        imk_error_set(&error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
        campaign_job_fail(&l.job, &error);
    }
    if (l.values)
        answer(&l);
    for (size_t i = 0; i < started; i++)
        pthread_join(workers[i].thread, NULL);
    free(workers);
    free(l.values);
    return campaign_job_close(&l.job, values);
}
