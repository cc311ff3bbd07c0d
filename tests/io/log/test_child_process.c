/* SPDX-License-Identifier: Apache-2.0 */
/* A library that crashes, ends, talks nonsense or wants too much becomes a message, and nothing of
 * this process reaches it but its file and its socket. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include "io/log/arrays/child_messages_internal.h"
#include "io/log/arrays/child_process_internal.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void crash(int file, int socket)
{
    (void)file;
    (void)socket;
    raise(SIGSEGV);
}

static void give_up(int file, int socket)
{
    (void)file;
    (void)socket;
    abort();
}

static void leave(int file, int socket)
{
    (void)file;
    (void)socket;
}

/* A kind that is due with a size that is not, and no end. */
static void babble(int file, int socket)
{
    const imki_message message = {.kind = IMKI_MESSAGE_ARRAY, .size = UINT32_MAX};
    (void)file;
    while (imki_socket_send(socket, &message, sizeof message))
        ;
}

/* @return the message about a child that does not list its arrays */
static void check_told(imki_child_work work, const char *found)
{
    imki_child child;
    imki_array_list list = {.separator = '/'};
    imk_status status;
    imk_error error;
    CHECK_OK(imki_child_start(work, 0, &child, &error));
    assert_false(imki_child_list(child.socket, &list, &status, &error));
    CHECK_STATUS(imki_child_refuse(&child, "HDF5", &error), IMK_ERROR_FORMAT);
    assert_string_equal(error.found, found);
    assert_int_equal(child.process, 0);
    imki_array_list_free(&list);
}

static void endings(void **state)
{
    (void)state;
    char found[96];
    snprintf(found, sizeof found, "the HDF5 library has ended on this file (%s)",
             strsignal(SIGSEGV));
    check_told(crash, found);
    snprintf(found, sizeof found, "the HDF5 library has ended on this file (%s)",
             strsignal(SIGABRT));
    check_told(give_up, found);
    check_told(leave, "the HDF5 library has ended on this file");
    check_told(babble, "the HDF5 library has ended on this file");
}

/* What the child has: answers in one byte each. */
static void look(int file, int socket)
{
    struct stat about;
    size_t open_files = 0;
    for (int i = 0; i < 256; i++)
        open_files += fcntl(i, F_GETFD) >= 0;
    struct sigaction action;
    sigaction(SIGTERM, NULL, &action);
    const bool large = sizeof(void *) == 8;
    void *volatile memory = large ? malloc((size_t)3 << 30) : NULL;
    const char answer[] = {(char)(open_files == 5), /* three of nothing, the file, the socket */
                           (char)(fstat(file, &about) == 0 && S_ISDIR(about.st_mode)),
                           (char)(action.sa_handler == SIG_DFL),
                           (char)(fcntl(STDERR_FILENO, F_GETFD) >= 0 && !isatty(STDERR_FILENO)),
                           (char)(memory == NULL)};
    imki_socket_send(socket, answer, sizeof answer);
    char wait;
    imki_socket_receive(socket, &wait, 1);
}

static void be_told(int number)
{
    (void)number;
}

static void surroundings(void **state)
{
    (void)state;
    imki_child child;
    imk_error error;
    char answer[5] = "";
    struct sigaction own = {.sa_handler = be_told}, before;
    sigemptyset(&own.sa_mask);
    sigaction(SIGTERM, &own, &before);
    const int folder = open("/", O_RDONLY), other = open("/dev/null", O_RDONLY);
    CHECK_OK(imki_child_start(look, folder, &child, &error));
    assert_true(imki_socket_receive(child.socket, answer, sizeof answer));
    const pid_t process = child.process;
    imki_child_end(&child); /* it waits for an answer */
    assert_int_equal(kill(process, 0), -1);
    for (int i = 0; i < 4; i++)
        assert_int_equal(answer[i], 1);
#if defined(__linux__)
    assert_int_equal(answer[4], !IMKI_SANITIZED); /* 1 GiB is the limit */
#endif
    sigaction(SIGTERM, &before, NULL);
    close(folder);
    close(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(endings),
        cmocka_unit_test(surroundings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
