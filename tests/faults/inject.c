/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the n-th allocation of a program fail, or its n-th call to the system. tools/run_faults
 * preloads it:
 *
 *     FAULTS_PIPES="IN OUT" FAULTS_FILES=PREFIX [FAULTS_INPUT=FILE] LD_PRELOAD=inject.so PROGRAM
 * ...
 *
 * The program is loaded once and waits in front of its main(). For every line "KIND FIRST LAST
 * ERRNO RECORD\n" that comes from IN, a copy of the process runs main() with calls FIRST to LAST of
 * that kind failing, and its wait status goes to OUT. Standard output and error are PREFIX.out and
 * PREFIX.err; PREFIX.where gets the stack of the first call that failed. With RECORD,
 * PREFIX.calls gets an entry for each call: what it was, and a hash of the stack it came from.
 *
 * The C library does not use its own read() and write() for its streams; those are made anew on top
 * of ours, standard output included. Its allocations do come here. What a program starts
 * (rsvg-convert) is left alone. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* What can fail: an allocation; any call to the system; of those, the ones that need room on a
 * disk. SHORT fails nothing: what is read or written is cut to LAST bytes a call. */
enum { MEMORY = 'm', CALL = 'c', ROOM = 'r', SHORT = 's' };
enum { FRAMES = 48, STREAMS = 64, TIME_LIMIT = 60 /* [s], a run takes milliseconds */ };

static struct {
    int kind, error;
    unsigned long first, last;
} plan;
static atomic_ulong counted[3];
static bool armed;
static _Thread_local bool busy; /* within this file: its own calls are not counted */
static int calls_file = -1, where_file = -1;

typedef struct call {
    uint64_t stack;
    char name[14], is_spared, kind;
} call;

/* Where a call comes from. libhdf5 is left alone: it does not survive a call that fails, and is
 * entered only when there is memory enough (src/io/file/hdf5_use.c). It is a shared library, or
 * lies in the program from FAULTS_HDF5's first address to its second. */
static bool is_spared(void *const *frame, int frames)
{
    const char *text = getenv("FAULTS_HDF5");
    char *end = NULL;
    const uintptr_t first = text ? strtoull(text, &end, 16) : 0;
    const uintptr_t last = text ? strtoull(end, NULL, 16) : 0;
    for (int i = 0; i < frames; i++) {
        Dl_info about;
        if (!dladdr(frame[i], &about) || !about.dli_fname)
            continue;
        const uintptr_t at = (uintptr_t)frame[i] - (uintptr_t)about.dli_fbase;
        const bool in_program = strstr(about.dli_fname, "/imukit") && at >= first && at < last;
        if (in_program || strstr(about.dli_fname, "libhdf5"))
            return true;
    }
    return false;
}

static void record(int kind, const char *name)
{
    void *frame[FRAMES];
    call c = {.stack = 14695981039346656037u, .kind = (char)kind};
    const int frames = backtrace(frame, FRAMES);
    for (int i = 2; i < frames; i++)
        c.stack = (c.stack ^ (uintptr_t)frame[i]) * 1099511628211u;
    c.is_spared = is_spared(frame, frames);
    snprintf(c.name, sizeof c.name, "%s", name);
    if (write(calls_file, &c, sizeof c) != sizeof c)
        _exit(99);
}

/* @return false: from here, nothing fails */
static bool show(const char *name, bool is_first)
{
    void *frame[FRAMES];
    const int frames = backtrace(frame, FRAMES);
    if (is_spared(frame, frames))
        return false;
    if (is_first) {
        dprintf(where_file, "%s\n", name);
        backtrace_symbols_fd(frame, frames, where_file);
    }
    return true;
}

/* Count a call. @return it is to fail, with errno set */
static bool fails(int kind, const char *name)
{
    if (!armed || busy)
        return false;
    busy = true;
    const unsigned long n = atomic_fetch_add(&counted[kind == MEMORY ? 0
                                                      : kind == CALL ? 1
                                                                     : 2],
                                             1) +
                            1;
    if (calls_file >= 0)
        record(kind, name);
    const bool failed =
        kind == plan.kind && n >= plan.first && n <= plan.last && show(name, n == plan.first);
    busy = false;
    if (failed)
        errno = plan.error;
    return failed;
}

/* A call that needs room on a disk is a call as well. */
static bool fails_for_room(const char *name)
{
    const bool failed = fails(CALL, name);
    return fails(ROOM, name) || failed;
}

static size_t cut(size_t size)
{
    return armed && plan.kind == SHORT && size > plan.last ? plan.last : size;
}

/* The function that would have been called: NAME in the libraries behind this one. */
#define REAL(name)                                                                                 \
    static __typeof__(name) *real;                                                                 \
    if (!real)                                                                                     \
    *(void **)&real = dlsym(RTLD_NEXT, #name)

/* ---- memory ---- */

void *malloc(size_t size)
{
    REAL(malloc);
    return fails(MEMORY, "malloc") ? NULL : real(size);
}

void *calloc(size_t count, size_t size)
{
    REAL(calloc);
    return fails(MEMORY, "calloc") ? NULL : real(count, size);
}

void *realloc(void *at, size_t size)
{
    REAL(realloc);
    return fails(MEMORY, "realloc") ? NULL : real(at, size);
}

void *reallocarray(void *at, size_t count, size_t size)
{
    REAL(reallocarray);
    return fails(MEMORY, "reallocarray") ? NULL : real(at, count, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    REAL(aligned_alloc);
    return fails(MEMORY, "aligned_alloc") ? NULL : real(alignment, size);
}

int posix_memalign(void **at, size_t alignment, size_t size)
{
    REAL(posix_memalign);
    return fails(MEMORY, "posix_memalign") ? ENOMEM : real(at, alignment, size);
}

/* ---- files ---- */

int open(const char *path, int flags, ...)
{
    va_list rest;
    va_start(rest, flags);
    const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
    va_end(rest);
    REAL(open);
    if ((flags & O_CREAT) != 0 ? fails_for_room("open") : fails(CALL, "open"))
        return -1;
    return real(path, flags, mode);
}

int close(int file)
{
    REAL(close);
    const int result = real(file); /* it is closed in any case */
    return fails(CALL, "close") ? -1 : result;
}

ssize_t read(int file, void *at, size_t size)
{
    REAL(read);
    return fails(CALL, "read") ? -1 : real(file, at, cut(size));
}

ssize_t write(int file, const void *at, size_t size)
{
    REAL(write);
    return fails_for_room("write") ? -1 : real(file, at, cut(size));
}

ssize_t pread(int file, void *at, size_t size, off_t offset)
{
    REAL(pread);
    return fails(CALL, "pread") ? -1 : real(file, at, cut(size), offset);
}

ssize_t pwrite(int file, const void *at, size_t size, off_t offset)
{
    REAL(pwrite);
    return fails_for_room("pwrite") ? -1 : real(file, at, cut(size), offset);
}

off_t lseek(int file, off_t offset, int from)
{
    REAL(lseek);
    return fails(CALL, "lseek") ? -1 : real(file, offset, from);
}

int ftruncate(int file, off_t size)
{
    REAL(ftruncate);
    return fails_for_room("ftruncate") ? -1 : real(file, size);
}

int stat(const char *path, struct stat *about)
{
    REAL(stat);
    return fails(CALL, "stat") ? -1 : real(path, about);
}

int lstat(const char *path, struct stat *about)
{
    REAL(lstat);
    return fails(CALL, "lstat") ? -1 : real(path, about);
}

int fstat(int file, struct stat *about)
{
    REAL(fstat);
    return fails(CALL, "fstat") ? -1 : real(file, about);
}

ssize_t readlink(const char *path, char *at, size_t size)
{
    REAL(readlink);
    return fails(CALL, "readlink") ? -1 : real(path, at, size);
}

int access(const char *path, int mode)
{
    REAL(access);
    return fails(CALL, "access") ? -1 : real(path, mode);
}

int fchmod(int file, mode_t mode)
{
    REAL(fchmod);
    return fails(CALL, "fchmod") ? -1 : real(file, mode);
}

int flock(int file, int operation)
{
    REAL(flock);
    return fails(CALL, "flock") ? -1 : real(file, operation);
}

/* Nothing is waited for: a sync costs more than the rest of a run. */
int fsync(int file)
{
    (void)file;
    return fails_for_room("fsync") ? -1 : 0;
}

int rename(const char *from, const char *to)
{
    REAL(rename);
    return fails_for_room("rename") ? -1 : real(from, to);
}

int mkdir(const char *path, mode_t mode)
{
    REAL(mkdir);
    return fails_for_room("mkdir") ? -1 : real(path, mode);
}

char *mkdtemp(char *path)
{
    REAL(mkdtemp);
    return fails_for_room("mkdtemp") ? NULL : real(path);
}

/* ---- threads and processes ---- */

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *),
                   void *argument)
{
    REAL(pthread_create);
    return fails(CALL, "pthread_create") ? EAGAIN : real(thread, attributes, start, argument);
}

int posix_spawn(pid_t *child, const char *path, const posix_spawn_file_actions_t *actions,
                const posix_spawnattr_t *attributes, char *const *arguments, char *const *variables)
{
    REAL(posix_spawn);
    return fails(CALL, "posix_spawn")
               ? EAGAIN
               : real(child, path, actions, attributes, arguments, variables);
}

/* ---- streams ---- */

static ssize_t stream_read(void *file, char *at, size_t size)
{
    return read((int)(intptr_t)file, at, size);
}

/* Like the C library's own stream, which writes until all is written. */
static ssize_t stream_write(void *file, const char *at, size_t size)
{
    size_t written = 0;
    while (written < size) {
        const ssize_t count = write((int)(intptr_t)file, at + written, size - written);
        if (count < 0)
            break;
        written += (size_t)count;
    }
    return (ssize_t)written;
}

static int stream_seek(void *file, off64_t *offset, int from)
{
    const off_t place = lseek((int)(intptr_t)file, *offset, from);
    *offset = place;
    return place < 0 ? -1 : 0;
}

static FILE *stream_of[STREAMS]; /* by the number of the file */

static int stream_close(void *file)
{
    stream_of[(intptr_t)file] = NULL;
    return close((int)(intptr_t)file);
}

static FILE *make_stream(int file, const char *mode)
{
    const cookie_io_functions_t functions = {stream_read, stream_write, stream_seek, stream_close};
    FILE *stream = file < STREAMS ? fopencookie((void *)(intptr_t)file, mode, functions) : NULL;
    if (stream)
        stream_of[file] = stream;
    return stream;
}

int fileno(FILE *stream)
{
    for (int file = 0; file < STREAMS; file++)
        if (stream_of[file] == stream)
            return file;
    REAL(fileno);
    return real(stream);
}

FILE *fopen(const char *path, const char *mode)
{
    const bool update = strchr(mode, '+') != NULL;
    const int flags = mode[0] == 'r'   ? (update ? O_RDWR : O_RDONLY)
                      : mode[0] == 'w' ? (update ? O_RDWR : O_WRONLY) | O_CREAT | O_TRUNC
                                       : (update ? O_RDWR : O_WRONLY) | O_CREAT | O_APPEND;
    const int file = open(path, flags, 0666);
    FILE *stream = file < 0 ? NULL : make_stream(file, mode);
    if (file >= 0 && !stream)
        close(file);
    return stream;
}

/* ---- runs ---- */

static int open_file(const char *ending)
{
    char path[4096];
    snprintf(path, sizeof path, "%s.%s", getenv("FAULTS_FILES"), ending);
    return open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
}

static int (*program)(int, char **, char **);

/* In the copy: the files, the plan, main(). */
static int run(bool with_record, int count, char **arguments, char **variables)
{
    const char *input = getenv("FAULTS_INPUT");
    if (input)
        dup2(open(input, O_RDONLY), 0);
    dup2(open_file("out"), 1);
    dup2(open_file("err"), 2);
    where_file = open_file("where");
    calls_file = with_record ? open_file("calls") : -1;
    stdout = make_stream(1, "w");
    void *frame[2];
    backtrace(frame, 2); /* which loads a library, once */
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    alarm(TIME_LIMIT);
    armed = true;
    return program(count, arguments, variables);
}

/* Run main() as often as is asked for. */
static int serve(int count, char **arguments, char **variables)
{
    int in, out, with_record;
    char line[200];
    if (sscanf(getenv("FAULTS_PIPES"), "%d %d", &in, &out) != 2)
        return 98;
    unsetenv("LD_PRELOAD");
    FILE *lines = fdopen(in, "r");
    while (lines && fgets(line, sizeof line, lines)) {
        char kind;
        if (sscanf(line, "%c %lu %lu %d %d", &kind, &plan.first, &plan.last, &plan.error,
                   &with_record) != 5)
            return 98;
        plan.kind = kind;
        const pid_t child = fork();
        if (child == 0)
            return run(with_record, count, arguments, environ);
        int status = 0;
        waitpid(child, &status, 0);
        dprintf(out, "%d\n", status);
    }
    (void)variables;
    return 0;
}

int __libc_start_main(int (*main)(int, char **, char **), int count, char **arguments,
                      void (*begin)(void), void (*end)(void), void (*loaded)(void), void *stack)
{
    int (*real)(int (*)(int, char **, char **), int, char **, void (*)(void), void (*)(void),
                void (*)(void), void *);
    *(void **)&real = dlsym(RTLD_NEXT, "__libc_start_main");
    program = main;
    return real(serve, count, arguments, begin, end, loaded, stack);
}
