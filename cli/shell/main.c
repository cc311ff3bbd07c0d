/* SPDX-License-Identifier: Apache-2.0 */
/* The command imukit as a process: signals and memory. */
#define _POSIX_C_SOURCE 200809L
#include "campaign/campaign_run.h"
#include "command.h"
#include "memory_guard.h"

#include "imukit/output_file.h"

#include <signal.h>

static const int ending_signals[] = {SIGINT,  SIGTERM, SIGHUP,  SIGPIPE, SIGQUIT,
                                     SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM};
enum { ENDING_SIGNALS = sizeof ending_signals / sizeof ending_signals[0] };

/* Interrupted: leave no half-written file behind, and end as the signal would have. */
static void interrupted(int number)
{
    imk_output_file_abandon_all();
    signal(number, SIG_DFL);
    raise(number);
}

/* A second signal, which shells and timeout(1) send soon after the first, waits until the files are
 * removed. A signal that the parent has switched off, as nohup(1) does, stays off, except SIGCHLD,
 * because the exit status of gnuplot is needed. A file beyond the limit of its size is an error of
 * write() like any other, with a message. */
static void catch_signals(void)
{
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGCHLD, SIG_DFL);
    struct sigaction action = {.sa_handler = interrupted}, before;
    sigemptyset(&action.sa_mask);
    for (int i = 0; i < ENDING_SIGNALS; i++)
        sigaddset(&action.sa_mask, ending_signals[i]);
    for (int i = 0; i < ENDING_SIGNALS; i++)
        if (sigaction(ending_signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(ending_signals[i], &action, NULL);
}

int main(int argc, char **argv)
{
    catch_signals();
    memory_guard();
    campaign_begin(&argc, &argv);
    return campaign_end(command_obey(argc, argv));
}
