/* SPDX-License-Identifier: Apache-2.0 */
/* What cannot be rewound is read once and kept for the next opening; nothing of it is lost without
 * an error. */
#define _XOPEN_SOURCE 700
#include "check.h"

#include "io/file/descriptor_name_internal.h"
#include "io/file/input_stream_internal.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SIZE = 30000 }; /* a pipe holds it */
static char text[SIZE];
static char folder[] = "/tmp/imukit-copy-XXXXXX";

/* Name of the reading end of a pipe, or a socket, that holds the text. */
static const char *stream(bool socket, int *reader)
{
    static char name[40];
    int ends[2];
    assert_int_equal(socket ? socketpair(AF_UNIX, SOCK_STREAM, 0, ends) : pipe(ends), 0);
    assert_int_equal(write(ends[1], text, SIZE), SIZE);
    close(ends[1]);
    *reader = ends[0];
    snprintf(name, sizeof name, "/dev/fd/%d", ends[0]);
    return name;
}

/* Open, read so much, and close. */
static void check_reads(const char *path, bool kept, size_t size)
{
    static char buffer[SIZE + 1];
    imki_input *input;
    imk_error error;
    size_t total = 0, got = 1;
    CHECK_OK(kept ? imki_input_open_kept(path, &input, &error)
                  : imki_input_open(path, &input, &error));
    while (got > 0 && total < size) {
        CHECK_OK(imki_input_read(input, buffer + total, size - total, &got, &error));
        total += got;
    }
    imki_input_close(input);
    assert_int_equal(total, size);
    assert_memory_equal(buffer, text, size);
}

static size_t open_files(void)
{
    DIR *listing = opendir("/proc/self/fd");
    size_t count = 0;
    while (listing && readdir(listing))
        count++;
    if (listing)
        closedir(listing);
    return count;
}

static void looked_into_twice_and_read(void **state)
{
    (void)state;
    imki_input *input;
    for (int socket = 0; socket < 2; socket++) {
        const size_t before = open_files();
        int reader;
        const char *path = stream(socket, &reader);
        check_reads(path, true, 10);
        check_reads(path, true, SIZE);
        check_reads(path, false, SIZE);
        CHECK_STATUS(imki_input_open(path, &input, NULL), IMK_ERROR_EMPTY); /* the copy is gone */
        close(reader);
        assert_int_equal(open_files(), before);
    }
}

/* Without a need for it there is no copy: a stream may be as long as it likes. */
static void read_once(void **state)
{
    (void)state;
    setenv("TMPDIR", "/nonexistent", 1);
    for (int socket = 0; socket < 2; socket++) {
        int reader;
        check_reads(stream(socket, &reader), false, SIZE);
        close(reader);
    }
    setenv("TMPDIR", folder, 1);
}

/* The size of a copy is known, as that of a file is. */
static void size_is_known(void **state)
{
    (void)state;
    imki_input *input;
    uint64_t done, size;
    int reader;
    const char *path = stream(false, &reader);
    CHECK_OK(imki_input_open_kept(path, &input, NULL));
    imki_input_progress(input, &done, &size);
    assert_int_equal(size, SIZE);
    imki_input_close(input);
    check_reads(path, false, SIZE);
    close(reader);
}

/* A FIFO is known by its place, and not opened a second time: nobody would write to it. */
static void named_pipe(void **state)
{
    (void)state;
    char path[80];
    snprintf(path, sizeof path, "%s/fifo", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        const int writer = open(path, O_WRONLY);
        _exit(write(writer, text, SIZE) == SIZE ? 0 : 1);
    }
    check_reads(path, true, 10);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
    check_reads(path, true, SIZE);
    check_reads(path, false, SIZE);
    unlink(path);
}

/* What was taken for a copy that failed is lost: whoever opens the input next is to know. */
static void copy_that_fails(void **state)
{
    (void)state;
    imki_input *input = NULL;
    imk_error error;
    int reader;
    const char *path = stream(false, &reader);
    setenv("TMPDIR", "/nonexistent", 1);
    CHECK_STATUS(imki_input_open_kept(path, &input, &error), IMK_ERROR_WRITE);
    setenv("TMPDIR", folder, 1);
    assert_string_equal(error.field, path);
    assert_string_equal(error.found,
                        "its temporary copy cannot be written: No such file or directory");
    CHECK_STATUS(imki_input_open_kept(path, &input, &error), IMK_ERROR_WRITE);
    error = (imk_error){0};
    CHECK_STATUS(imki_input_open(path, &input, &error), IMK_ERROR_WRITE);
    assert_non_null(strstr(error.expected, "TMPDIR"));
    assert_null(input);
    close(reader);
}

static void check_refused(const char *path, const char *found)
{
    imki_input *input = NULL;
    imk_error error;
    for (int time = 0; time < 2; time++) {
        CHECK_STATUS(imki_input_open_kept(path, &input, &error), IMK_ERROR_FORMAT);
        assert_memory_equal(error.found, found, strlen(found)); /* it begins so */
    }
    CHECK_STATUS(imki_input_open(path, &input, &error), IMK_ERROR_FORMAT); /* ends the copy */
    assert_null(input);
}

/* What has no end is not copied until the disk is full: no text, and a line without end. */
static void without_end(void **state)
{
    (void)state;
    check_refused(
        "/dev/zero",
        "this is neither text nor a log that is read without a file, nor packed by gzip or zstd");
    int ends[2];
    char path[40];
    assert_int_equal(pipe(ends), 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        while (write(ends[1], "0123456789", 10) > 0)
            ;
        _exit(1);
    }
    close(ends[1]);
    snprintf(path, sizeof path, "/dev/fd/%d", ends[0]);
    check_refused(path, "a line is longer than 1 MiB");
    close(ends[0]);
    int status;
    assert_int_equal(waitpid(child, &status, 0), child); /* by SIGPIPE */
}

/* Standard input that is a file is put back to where it stood. */
static void standard_input_file(void **state)
{
    (void)state;
    char path[80];
    snprintf(path, sizeof path, "%s/file", folder);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite("head", 1, 4, file) + fwrite(text, 1, SIZE, file), SIZE + 4);
    fclose(file);
    const int saved = dup(STDIN_FILENO), other = open(path, O_RDONLY);
    dup2(other, STDIN_FILENO);
    lseek(STDIN_FILENO, 4, SEEK_SET);
    check_reads("-", true, 100);
    check_reads("-", true, SIZE);
    check_reads("-", false, SIZE);
    dup2(saved, STDIN_FILENO);
    close(saved);
    close(other);
    unlink(path);
}

static void names_of_streams(void **state)
{
    (void)state;
    assert_int_equal(imki_descriptor_named("/dev/stdin"), 0);
    assert_int_equal(imki_descriptor_named("/dev/stdout"), 1);
    assert_int_equal(imki_descriptor_named("/dev/stderr"), 2);
    assert_int_equal(imki_descriptor_named("/dev/fd/63"), 63);
    assert_int_equal(imki_descriptor_named("/proc/self/fd/2147483647"), 2147483647);
    static const char *const others[] = {
        "",           "-",          "/dev/null",          "/dev/stdin2",         "/dev/fd/",
        "/dev/fd/1x", "/dev/fd/-1", "/dev/fd/2147483648", "/dev/fd/99999999999", "dev/fd/1"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        assert_int_equal(imki_descriptor_named(others[i]), -1);
}

static int set_up(void **state)
{
    (void)state;
    for (int i = 0; i < SIZE; i++)
        text[i] = (char)(i % 9 == 8 ? '\n' : '0' + i % 10);
    return mkdtemp(folder) ? setenv("TMPDIR", folder, 1) : -1;
}

/* The copies have no names: the folder is empty. */
static int tear_down(void **state)
{
    (void)state;
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(looked_into_twice_and_read),
        cmocka_unit_test(read_once),
        cmocka_unit_test(size_is_known),
        cmocka_unit_test(named_pipe),
        cmocka_unit_test(copy_that_fails),
        cmocka_unit_test(without_end),
        cmocka_unit_test(standard_input_file),
        cmocka_unit_test(names_of_streams),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
