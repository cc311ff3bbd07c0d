/* SPDX-License-Identifier: Apache-2.0 */
/* Output files appear complete or not at all, whatever they were before and whatever fails. */
#define _POSIX_C_SOURCE 200809L
#define _XOPEN_SOURCE 700
#include "imukit/output_file.h"

#include "io/file/input_stream_internal.h"
#include "io/file/output_file_internal.h"

#include "check.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { BIG = 2200013 }; /* several buffers */

static char directory[64];
static char big[BIG];

static const char *path_of(const char *name)
{
    static char paths[4][128];
    static unsigned next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

static void save(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* Files in the directory, but "." and "..". */
static size_t count_files(void)
{
    DIR *stream = opendir(directory);
    size_t count = 0;
    assert_non_null(stream);
    while (readdir(stream))
        count++;
    closedir(stream);
    return count - 2;
}

/* The decoded content of a file is exactly this. */
static void check_content(const char *path, const void *expected, size_t size)
{
    imki_input *input;
    imk_error error;
    size_t total = 0, got;
    char *content = malloc(size + 1);
    CHECK_OK(imki_input_open(path, &input, &error));
    do {
        CHECK_OK(imki_input_read(input, content + total, size + 1 - total, &got, &error));
        total += got;
    } while (got > 0 && total <= size);
    assert_int_equal(total, size);
    assert_memory_equal(content, expected, size);
    imki_input_close(input);
    free(content);
}

static imk_output_file *start(const char *path)
{
    imk_output_file *file;
    imk_error error;
    CHECK_OK(imk_output_file_open(path, &file, &error));
    return file;
}

static void write_text(const char *path, const char *text)
{
    imk_output_file *file = start(path);
    CHECK_OK(imk_output_file_write(file, text, strlen(text)));
    CHECK_OK(imk_output_file_commit(file, NULL));
}

static void appears_at_commit(void **state)
{
    (void)state;
    const char *path = path_of("new.txt");
    imk_output_file *file = start(path);
    CHECK_OK(imk_output_file_write(file, big, BIG));
    CHECK_OK(imk_output_file_print(file, "%d %s\n", 42, "words"));
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(count_files(), 1); /* the temporary one */
    CHECK_OK(imk_output_file_commit(file, NULL));
    assert_int_equal(count_files(), 1);
    char *expected = malloc(BIG + 9);
    memcpy(expected, big, BIG);
    memcpy(expected + BIG, "42 words\n", 9);
    check_content(path, expected, BIG + 9);
    free(expected);
    unlink(path);
}

static void abandon_leaves_the_old_file(void **state)
{
    (void)state;
    const char *path = path_of("old.txt");
    save(path, "old");
    imk_output_file *file = start(path);
    CHECK_OK(imk_output_file_write(file, big, BIG));
    imk_output_file_abandon(file);
    imk_output_file_abandon(NULL);
    check_content(path, "old", 3);
    assert_int_equal(count_files(), 1);
    write_text(path, "new text");
    check_content(path, "new text", 8);
    unlink(path);
}

static mode_t mode_of(const char *path)
{
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    return about.st_mode & 07777;
}

static void permissions(void **state)
{
    (void)state;
    const char *path = path_of("mode.txt");
    const mode_t before = umask(027);
    write_text(path, "1");
    assert_int_equal(mode_of(path), 0640);
    chmod(path, 0604);
    write_text(path, "2");
    assert_int_equal(mode_of(path), 0604);
    umask(before);
    chmod(path, 0444);
    if (access(path, W_OK) != 0) { /* root may write everything */
        imk_output_file *file;
        imk_error error;
        CHECK_STATUS(imk_output_file_open(path, &file, &error), IMK_ERROR_OPEN);
        assert_string_equal(error.found, strerror(EACCES));
    }
    unlink(path);
}

static void links_stay_links(void **state)
{
    (void)state;
    mkdir(path_of("sub"), 0700);
    const char *link = path_of("link"), *target = path_of("sub/target");
    save(target, "old");
    assert_int_equal(symlink("sub/second", link), 0);
    assert_int_equal(symlink("target", path_of("sub/second")), 0);
    write_text(link, "through two links");
    struct stat about;
    assert_int_equal(lstat(path_of("link"), &about), 0);
    assert_true(S_ISLNK(about.st_mode));
    assert_int_equal(lstat(path_of("sub/target"), &about), 0);
    assert_true(S_ISREG(about.st_mode));
    check_content(path_of("sub/target"), "through two links", 17);

    unlink(path_of("sub/target")); /* now the links lead to nothing */
    write_text(path_of("link"), "made");
    check_content(path_of("sub/target"), "made", 4);

    unlink(path_of("sub/second")); /* and now in a circle */
    assert_int_equal(symlink("../link", path_of("sub/second")), 0);
    imk_output_file *file;
    imk_error error;
    CHECK_STATUS(imk_output_file_open(path_of("link"), &file, &error), IMK_ERROR_OPEN);
    assert_string_equal(error.found, strerror(ELOOP));
    unlink(path_of("sub/second"));
    unlink(path_of("sub/target"));
    rmdir(path_of("sub"));
    unlink(path_of("link"));
    assert_int_equal(count_files(), 0);
}

static void check_refused(const char *path, const char *found)
{
    imk_output_file *file = NULL;
    imk_error error;
    CHECK_STATUS(imk_output_file_open(path, &file, &error), IMK_ERROR_OPEN);
    assert_null(file);
    assert_string_equal(error.field, path);
    assert_string_equal(error.found, found);
}

static void refusals_name_the_reason(void **state)
{
    (void)state;
    check_refused(directory, strerror(EISDIR));
    check_refused("", strerror(ENOENT));
    char found[160];
    snprintf(found, sizeof found, "the folder %s/missing does not exist", directory);
    check_refused(path_of("missing/a.csv"), found);
    assert_int_equal(symlink("missing/a.csv", path_of("link")), 0);
    check_refused(path_of("link"), found);
    unlink(path_of("link"));
    check_refused(path_of("missing/"), "this is the name of a folder");
    check_refused(
        "/proc/imukit.csv",
        "the folder /proc cannot be written: No such file or directory"); /* a directory where even
                                                                             root makes no files */
    save(path_of("file"), "");
    check_refused(path_of("file/a.csv"), strerror(ENOTDIR));
    unlink(path_of("file"));
    mkdir(path_of("locked"), 0500);
    snprintf(found, sizeof found, "the folder %s/locked cannot be written: Permission denied",
             directory);
    if (access(path_of("locked"), W_OK) != 0)
        check_refused(path_of("locked/a.csv"), found);
    rmdir(path_of("locked"));
    assert_int_equal(count_files(), 0);
}

/* /dev/full accepts no byte: each way of writing finds out, at the latest at commit. */
static void full_device(void **state)
{
    (void)state;
    for (int way = 0; way < 3; way++) {
        imk_error error;
        imk_output_file *file;
        if (access("/dev/full", W_OK) != 0)
            skip();
        assert_int_equal(symlink("/dev/full", path_of(way == 2 ? "full.zst" : "full.gz")), 0);
        file = start(way == 0 ? "/dev/full" : path_of(way == 2 ? "full.zst" : "full.gz"));
        CHECK_OK(imk_output_file_print(file, "one line\n")); /* still in the buffer */
        CHECK_STATUS(imk_output_file_commit(file, &error), IMK_ERROR_WRITE);
        assert_int_equal(error.status, IMK_ERROR_WRITE);
        assert_string_equal(error.found, strerror(ENOSPC));
        assert_non_null(strstr(error.field, "full"));

        file = start("/dev/full");
        imk_status status = IMK_OK;
        for (int i = 0; i < 5 && status == IMK_OK; i++)
            status = imk_output_file_write(file, big, BIG);
        CHECK_STATUS(status, IMK_ERROR_WRITE); /* kept from now on */
        CHECK_STATUS(imk_output_file_write(file, "x", 1), IMK_ERROR_WRITE);
        CHECK_STATUS(imk_output_file_commit(file, NULL), IMK_ERROR_WRITE);
        unlink(path_of(way == 2 ? "full.zst" : "full.gz"));
    }
    assert_int_equal(count_files(), 0);
}

/* A limit on the size of files stands for a full disk: nothing appears, nothing is left. */
static void full_disk(void **state)
{
    (void)state;
    struct rlimit before, limited;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limited = before;
    limited.rlim_cur = BIG / 2;
    signal(SIGXFSZ, SIG_IGN); /* write() then fails with EFBIG */
    save(path_of("old"), "old");
    imk_output_file *file = start(path_of("old"));
    setrlimit(RLIMIT_FSIZE, &limited);
    const imk_status status = imk_output_file_write(file, big, BIG);
    imk_error error;
    const imk_status committed = imk_output_file_commit(file, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_DFL);
    CHECK_STATUS(status, IMK_ERROR_WRITE);
    CHECK_STATUS(committed, IMK_ERROR_WRITE);
    assert_string_equal(error.found, strerror(EFBIG));
    check_content(path_of("old"), "old", 3);
    assert_int_equal(count_files(), 1);
    unlink(path_of("old"));
}

static void compressed(void **state)
{
    (void)state;
    static const char *const names[] = {"a.gz", "b.gz", "a.zst", "b.zst"};
    for (int i = 0; i < 4; i++) { /* once in one piece, once in many */
        imk_output_file *file = start(path_of(names[i]));
        const size_t step = i % 2 == 0 ? BIG : 997;
        for (size_t done = 0; done < BIG; done += step)
            CHECK_OK(
                imk_output_file_write(file, big + done, BIG - done < step ? BIG - done : step));
        assert_false(imki_output_file_can_replace(file));
        CHECK_OK(imk_output_file_commit(file, NULL));
        check_content(path_of(names[i]), big, BIG);
        struct stat about;
        assert_int_equal(stat(path_of(names[i]), &about), 0);
        assert_in_range(about.st_size, 1000, BIG / 2);
    }
    /* The same bytes whenever they are written: no time, no system in the head [RFC1952, 2.3]. */
    unsigned char head[10];
    FILE *file = fopen(path_of("a.gz"), "rb");
    assert_int_equal(fread(head, 1, 10, file), 10);
    fclose(file);
    const unsigned char expected[10] = {0x1F, 0x8B, 8, 0, 0, 0, 0, 0, 0, 255};
    assert_memory_equal(head, expected, 10);
    for (int i = 0; i < 4; i++)
        unlink(path_of(names[i]));
    write_text(path_of("a.gz"), ""); /* nothing, well compressed */
    imki_input *input;
    size_t got = 1;
    CHECK_OK(imki_input_open(path_of("a.gz"), &input, NULL));
    CHECK_OK(imki_input_read(input, big, 1, &got, NULL));
    assert_int_equal(got, 0);
    imki_input_close(input);
    unlink(path_of("a.gz"));
}

static void bytes_can_be_replaced(void **state)
{
    (void)state;
    imk_output_file *file = start(path_of("a.bin"));
    CHECK_OK(imk_output_file_write(file, "0123456789", 10));
    assert_true(imki_output_file_can_replace(file));
    CHECK_OK(imki_output_file_replace(file, 3, "abc", 3));
    CHECK_OK(imk_output_file_write(file, "X", 1));
    CHECK_OK(imki_output_file_prepare(file, NULL));
    CHECK_OK(imk_output_file_commit(file, NULL));
    check_content(path_of("a.bin"), "012abc6789X", 11);
    unlink(path_of("a.bin"));
}

/* A pipe cannot be renamed to; its reader gets the bytes. */
static void named_pipe(void **state)
{
    (void)state;
    const char *path = path_of("pipe");
    assert_int_equal(mkfifo(path, 0600), 0);
    const int reader = open(path, O_RDONLY | O_NONBLOCK);
    imk_output_file *file = start(path);
    assert_false(imki_output_file_can_replace(file));
    CHECK_OK(imk_output_file_write(file, "bytes", 5));
    CHECK_OK(imk_output_file_commit(file, NULL));
    char text[8];
    assert_int_equal(read(reader, text, sizeof text), 5);
    assert_memory_equal(text, "bytes", 5);
    close(reader);
    struct stat about;
    assert_int_equal(stat(path, &about), 0);
    assert_true(S_ISFIFO(about.st_mode));
    unlink(path);
}

static void standard_output(void **state)
{
    (void)state;
    fflush(stdout);
    const int saved = dup(STDOUT_FILENO);
    const int other = open(path_of("out"), O_WRONLY | O_CREAT, 0600);
    dup2(other, STDOUT_FILENO);
    printf("before ");
    imk_output_file *first = start("-");
    const imk_status one = imk_output_file_print(first, "one ");
    const imk_status two = imk_output_file_commit(first, NULL);
    imk_output_file *second = start(NULL);
    const imk_status three = imk_output_file_print(second, "two");
    const imk_status four = imk_output_file_commit(second, NULL);
    dup2(saved, STDOUT_FILENO);
    close(saved);
    close(other);
    CHECK_OK(one);
    CHECK_OK(two);
    CHECK_OK(three);
    CHECK_OK(four);
    check_content(path_of("out"), "before one two", 14);
    unlink(path_of("out"));
}

/* A stream that is open is written as it is, also where it leads to a file: what is in that stays.
 */
static void open_streams(void **state)
{
    (void)state;
    int ends[2];
    char name[40], content[32] = "";
    assert_int_equal(pipe(ends), 0);
    snprintf(name, sizeof name, "/proc/self/fd/%d", ends[1]);
    write_text(name, "through");
    snprintf(name, sizeof name, "/dev/fd/%d", ends[1]);
    write_text(name, " a pipe");
    assert_int_equal(read(ends[0], content, sizeof content), 14);
    assert_string_equal(content, "through a pipe");
    close(ends[0]);
    close(ends[1]);

    save(path_of("log"), "before ");
    const int file = open(path_of("log"), O_WRONLY | O_APPEND);
    snprintf(name, sizeof name, "/dev/fd/%d", file);
    write_text(name, "and after");
    assert_int_equal(close(file), 0); /* it was not closed by the others */
    check_content(path_of("log"), "before and after", 16);
    unlink(path_of("log"));

    snprintf(name, sizeof name, "/dev/fd/%d", file);
    check_refused(name, strerror(EBADF));
    assert_int_equal(symlink("/dev/null", path_of("nowhere")), 0);
    write_text(path_of("nowhere"), "nothing");
    struct stat about;
    assert_int_equal(stat("/dev/null", &about), 0);
    assert_true(S_ISCHR(about.st_mode));
    unlink(path_of("nowhere"));
    assert_int_equal(count_files(), 0);
}

/* What a signal handler does in the middle of several files. */
static void abandon_all(void **state)
{
    (void)state;
    save(path_of("kept"), "kept");
    imk_output_file *files[3];
    for (int i = 0; i < 3; i++) {
        static const char *const names[] = {"kept", "b", "c.gz"};
        files[i] = start(path_of(names[i]));
        CHECK_OK(imk_output_file_write(files[i], big, BIG));
    }
    assert_int_equal(count_files(), 4);
    imk_output_file_abandon(files[2]);
    imk_output_file_abandon_all();
    assert_int_equal(count_files(), 1);
    imk_error error;
    CHECK_STATUS(imk_output_file_commit(files[0], &error), IMK_ERROR_WRITE);
    imk_output_file_abandon(files[1]);
    check_content(path_of("kept"), "kept", 4);
    write_text(path_of("kept"), "later files are not concerned");
    check_content(path_of("kept"), "later files are not concerned", 29);
    unlink(path_of("kept"));
    assert_int_equal(count_files(), 0);
}

static void at_interrupt(int number)
{
    imk_output_file_abandon_all();
    _exit(number);
}

/* A process interrupted while it writes leaves the directory as it was. */
static void interrupted_process(void **state)
{
    (void)state;
    int ready[2];
    assert_int_equal(pipe(ready), 0);
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        struct sigaction action = {.sa_handler = at_interrupt};
        sigaction(SIGINT, &action, NULL);
        alarm(60);
        imk_output_file *file;
        if (imk_output_file_open(path_of("partial"), &file, NULL) != IMK_OK)
            _exit(99);
        for (int i = 0;; i++) {
            imk_output_file_write(file, big, BIG / 30);
            if (i == 30 && write(ready[1], "!", 1) != 1)
                _exit(98);
            if (i > 60)
                pause();
        }
    }
    char byte;
    assert_int_equal(read(ready[0], &byte, 1), 1);
    assert_true(count_files() <= 1);
    kill(child, SIGINT);
    int result;
    assert_int_equal(waitpid(child, &result, 0), child);
    assert_true(WIFEXITED(result));
    assert_int_equal(WEXITSTATUS(result), SIGINT);
    assert_int_equal(count_files(), 0);
    close(ready[0]);
    close(ready[1]);
}

/* More files at a time than the register holds, and names of the greatest length. */
static void many_and_long_names(void **state)
{
    (void)state;
    imk_output_file *files[40];
    char name[256];
    for (int i = 0; i < 40; i++) {
        memset(name, 'n', 255);
        snprintf(name + 250, 6, "%05d", i);
        char path[400];
        snprintf(path, sizeof path, "%s/%s", directory, name);
        files[i] = start(path);
        CHECK_OK(imk_output_file_print(files[i], "%d", i));
    }
    for (int i = 0; i < 40; i++)
        CHECK_OK(imk_output_file_commit(files[i], NULL));
    assert_int_equal(count_files(), 40);
    for (int i = 0; i < 40; i++) {
        char path[400], text[8];
        snprintf(name + 250, 6, "%05d", i);
        snprintf(path, sizeof path, "%s/%s", directory, name);
        snprintf(text, sizeof text, "%d", i);
        check_content(path, text, strlen(text));
        unlink(path);
    }
}

/* A line longer than print takes is an error, not a cut line. */
static void long_print(void **state)
{
    (void)state;
    imk_output_file *file = start(path_of("line"));
    CHECK_OK(imk_output_file_print(file, "%4095d", 1));
    CHECK_STATUS(imk_output_file_print(file, "%4096d", 1), IMK_ERROR_WRITE);
    CHECK_STATUS(imk_output_file_commit(file, NULL), IMK_ERROR_WRITE);
    assert_int_equal(count_files(), 0);
}

static int make_directory(void **state)
{
    (void)state;
    uint32_t random = 1;
    for (size_t i = 0; i < BIG; i++) {
        random = 1664525u * random + 1013904223u;
        big[i] = (char)('0' + (random >> 24) % 10);
    }
    snprintf(directory, sizeof directory, "/tmp/imukit_output_XXXXXX");
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    (void)state;
    return rmdir(directory); /* fails when a test left something behind */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appears_at_commit),
        cmocka_unit_test(abandon_leaves_the_old_file),
        cmocka_unit_test(permissions),
        cmocka_unit_test(links_stay_links),
        cmocka_unit_test(refusals_name_the_reason),
        cmocka_unit_test(full_device),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(compressed),
        cmocka_unit_test(bytes_can_be_replaced),
        cmocka_unit_test(named_pipe),
        cmocka_unit_test(standard_output),
        cmocka_unit_test(open_streams),
        cmocka_unit_test(abandon_all),
        cmocka_unit_test(interrupted_process),
        cmocka_unit_test(many_and_long_names),
        cmocka_unit_test(long_print),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
