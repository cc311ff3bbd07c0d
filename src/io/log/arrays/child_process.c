/* SPDX-License-Identifier: Apache-2.0 */
/* The child is made by fork(), and runs on as the only thread of its process, so it must not wait
 * for what other threads held: the C library's memory is made usable by fork() itself, libhdf5 is
 * entered by the one who forks, and nothing is flushed at the end. Its signals are the usual ones
 * again, for a handler of this program would remove files of its parent. */
#define _GNU_SOURCE /* close_range() */
#include "child_process_internal.h"

#include "io/file/hdf5_use_internal.h"
#include "io/file/leftovers_internal.h"
#include "io/file/system_error_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifndef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0
#endif

enum {
    FILE_NUMBER = 3,
    SOCKET_NUMBER = 4,
    ABOVE = 16, /* descriptors that are moved before they get these numbers */
    SECONDS = 20,
    FILES = 32
};
static const rlim_t memory = (rlim_t)1 << 30;

/* Never above what the process has already. */
static void limit(int what, rlim_t most)
{
    struct rlimit now;
    if (getrlimit(what, &now) != 0)
        return;
    now.rlim_cur = now.rlim_max != RLIM_INFINITY && most > now.rlim_max ? now.rlim_max : most;
    setrlimit(what, &now);
}

void imki_child_continue(void)
{
    struct rusage used = {0};
    getrusage(RUSAGE_SELF, &used);
    limit(RLIMIT_CPU, (rlim_t)(used.ru_utime.tv_sec + used.ru_stime.tv_sec + SECONDS));
}

/* Addresses in use. @return 0: not known */
static rlim_t addresses(void)
{
    unsigned long long pages = 0;
    char text[32] = "";
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return 0;
    if (read(file, text, sizeof text - 1) > 0)
        for (const char *c = text; *c >= '0' && *c <= '9'; c++)
            pages = 10 * pages + (unsigned long long)(*c - '0');
    close(file);
    return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

static void close_others(void)
{
#if defined(__linux__)
    if (close_range(SOCKET_NUMBER + 1, ~0u, 0) == 0)
        return;
#endif
    const long most = sysconf(_SC_OPEN_MAX);
    for (int i = SOCKET_NUMBER + 1; i < (most > 0 && most < 65536 ? most : 65536); i++)
        close(i);
}

/* The file and the socket, nothing else. @return false: not possible */
static bool keep_files(int file, int socket)
{
    const int own_file = fcntl(file, F_DUPFD, ABOVE), own_socket = fcntl(socket, F_DUPFD, ABOVE);
    const int nothing = open("/dev/null", O_RDWR);
    if (own_file < 0 || own_socket < 0 || nothing < 0)
        return false;
    for (int i = 0; i < 3; i++)
        if (dup2(nothing, i) < 0)
            return false;
    if (dup2(own_file, FILE_NUMBER) < 0 || dup2(own_socket, SOCKET_NUMBER) < 0)
        return false;
    close_others();
    return true;
}

static void be_usual(void)
{
    struct sigaction usual = {.sa_handler = SIG_DFL};
    sigset_t none;
    sigemptyset(&usual.sa_mask);
    sigemptyset(&none);
    for (int i = 1; i < NSIG; i++)
        sigaction(i, &usual, NULL); /* two of them cannot be changed */
    pthread_sigmask(SIG_SETMASK, &none, NULL);
}

typedef struct start {
    imki_child_work work;
    int file, pair[2];
    pid_t process;
    int number; /* errno */
} start;

static void run_child(const start *s)
{
    be_usual();
    if (!keep_files(s->file, s->pair[1]))
        _exit(1);
    const rlim_t used = IMKI_SANITIZED ? 0 : addresses();
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    limit(RLIMIT_NOFILE, FILES);
    if (used > 0)
        limit(RLIMIT_AS, used + memory);
    imki_child_continue();
    s->work(FILE_NUMBER, SOCKET_NUMBER);
    _exit(0);
}

/* Called as the only one within libhdf5. */
static void divide(void *context)
{
    start *s = context;
    sigset_t before;
    imki_signals_hold(&before);
    s->process = fork();
    s->number = errno;
    if (s->process == 0)
        run_child(s);
    imki_signals_release(&before);
}

imk_status imki_child_start(imki_child_work work, int file, imki_child *child, imk_error *error)
{
    start s = {.work = work, .file = file};
    *child = (imki_child){.socket = -1};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, s.pair) != 0)
        return imki_system_error(error, IMK_ERROR_OPEN, "", errno);
    for (int i = 0; i < 2; i++)
        fcntl(s.pair[i], F_SETFD, FD_CLOEXEC);
    const bool entered = imki_hdf5_use(divide, &s);
    close(s.pair[1]);
    if (entered && s.process > 0) {
        *child = (imki_child){.process = s.process, .socket = s.pair[0]};
        return IMK_OK;
    }
    close(s.pair[0]);
    return entered ? imki_system_error(error, IMK_ERROR_OPEN, "", s.number)
                   : imk_error_set(error, IMK_ERROR_MEMORY, "", NULL, NULL);
}

/* Wait until it has ended, for a moment; then end it.
 * @return false: what became of it is not known, for the program that we are part of took it */
static bool await(imki_child *child, int *result)
{
    const struct timespec nap = {.tv_nsec = 5000000};
    pid_t ended = 0;
    for (int i = 0; i < 200 && (ended = waitpid(child->process, result, WNOHANG)) == 0; i++)
        nanosleep(&nap, NULL);
    if (ended == 0) { /* it is there, and it is ours */
        kill(child->process, SIGKILL);
        do
            ended = waitpid(child->process, result, 0);
        while (ended < 0 && errno == EINTR);
    }
    child->process = 0;
    return ended > 0;
}

static void hang_up(imki_child *child)
{
    if (child->socket >= 0)
        close(child->socket);
    child->socket = -1;
}

void imki_child_end(imki_child *child)
{
    int result;
    hang_up(child);
    if (child->process <= 0)
        return;
    if (waitpid(child->process, &result, WNOHANG) == 0) { /* it is there, and it is ours */
        kill(child->process, SIGKILL);
        while (waitpid(child->process, &result, 0) < 0 && errno == EINTR)
            ;
    }
    child->process = 0;
}

imk_status imki_child_refuse(imki_child *child, const char *library, imk_error *error)
{
    char found[96];
    int result = 0;
    hang_up(child);
    const bool known = child->process > 0 && await(child, &result);
    if (known && WIFSIGNALED(result) && WTERMSIG(result) == SIGXCPU)
        snprintf(found, sizeof found, "the %s library has not ended a step of this file in %d s",
                 library, SECONDS);
    else if (known && WIFSIGNALED(result))
        snprintf(found, sizeof found, "the %s library has ended on this file (%.40s)", library,
                 strsignal(WTERMSIG(result)));
    else
        snprintf(found, sizeof found, "the %s library has ended on this file", library);
    return imk_error_set(error, IMK_ERROR_FORMAT, "", found,
                         "the file is damaged: copy it again, or export it as a CSV");
}

bool imki_socket_send(int socket, const void *bytes, size_t size)
{
    const char *at = bytes;
    while (size > 0) {
        const ssize_t count = send(socket, at, size, MSG_NOSIGNAL);
        if (count < 0 && errno != EINTR)
            return false;
        at += count > 0 ? count : 0;
        size -= count > 0 ? (size_t)count : 0;
    }
    return true;
}

bool imki_socket_receive(int socket, void *bytes, size_t size)
{
    char *at = bytes;
    while (size > 0) {
        const ssize_t count = recv(socket, at, size, 0);
        if (count == 0 || (count < 0 && errno != EINTR))
            return false;
        at += count > 0 ? count : 0;
        size -= count > 0 ? (size_t)count : 0;
    }
    return true;
}
