/* SPDX-License-Identifier: Apache-2.0 */
/* Running the runs of a campaign: on the threads of this process, or on the ranks of imukit-mpi. */
#ifndef IMUKIT_CAMPAIGN_RUN_H
#define IMUKIT_CAMPAIGN_RUN_H

#include "shell/command.h"

#include "imukit/campaign.h"

/* How runs are computed. Called from several threads at once, each with its own number. */
typedef struct campaign_work {
    size_t at_once; /* runs of one call, at most */
    imk_status (*run)(void *context, size_t thread, uint64_t first, size_t count, double *values,
                      imk_error *error);
    void *context;
    size_t threads; /* how many may call at once */
} campaign_work;

/* Functions that main() calls first and last. imukit-mpi joins the other ranks in the first and
 * leaves them in the last. */
void campaign_begin(int *argument_count, char ***arguments);
int campaign_end(int code);

/* Threads of one process for --threads N; 0, not given, is all processors (imukit-mpi: one per
 * rank). */
size_t campaign_threads(uint64_t asked);

/* Compute runs first … first + runs - 1, with progress and the time left, going on from what a
 * killed process left in PATH.part. With imukit-mpi the ranks share them; only rank 0 returns.
 * @param path    results file, or NULL: in memory only
 * @param values  [run][time][state] of these runs from malloc(), or NULL: not wanted
 * @return -1 or the exit code, the message printed */
int campaign_run(const imk_campaign *campaign, uint64_t first, uint64_t runs,
                 const campaign_work *work, const char *path, double **values);

#endif
