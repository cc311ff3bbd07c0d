/* SPDX-License-Identifier: Apache-2.0 */
/* Runs gnuplot on a figure. Script, numbers and drawing have fixed names in a private temporary
 * folder, in which gnuplot runs: a name that begins with | or < is a command to it, so it sees none
 * that the user or the environment chose. It has a limited time, and a signal that ends this
 * process ends it too (io/leftovers.c). */
#define _GNU_SOURCE /* posix_spawn_file_actions_addchdir_np() */
#include "figure_internal.h"

#include "imukit/decimal.h"
#include "io/leftovers_internal.h"
#include "io/system_error_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A figure takes a second; the fonts of a new system, once, up to a minute. */
static const double usual_limit = 120; /* [s] */

/* Names inside the temporary folder. */
enum { SCRIPT, DATA, OUTPUT, FILE_COUNT };
static char script_name[] = "figure.gp";
static const char *const file_names[FILE_COUNT] = {script_name, "figure.dat", "figure.out"};

/* ---- the program ----------------------------------------------------------------------------- */

/* Path of gnuplot on PATH, absolute, for it is started in another folder. */
static bool find_program(char program[PATH_MAX])
{
    for (const char *path = getenv("PATH"); path && *path;) {
        const size_t length = strcspn(path, ":");
        char candidate[PATH_MAX];
        struct stat status;
        const int needed = snprintf(candidate, sizeof candidate, "%.*s/gnuplot", (int)length, path);
        if (length > 0 && needed > 0 && needed < PATH_MAX && stat(candidate, &status) == 0 &&
            S_ISREG(status.st_mode) && access(candidate, X_OK) == 0 && realpath(candidate, program))
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

bool imk_plot_available(void)
{
    char program[PATH_MAX];
    return find_program(program);
}

/* Until what it made is in the register, no signal may end the process. */
static void hold_signals(sigset_t *before)
{
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, before);
}

/* Start the program in the folder, with its messages discarded, as the leader of a process group.
 * @return 0 or an errno value */
static int start(const char *program, const char *folder, const sigset_t *mask, pid_t *child)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t usual;
    /* -d: the user's own start-up file must not change our figures. */
    char name[] = "gnuplot", defaults[] = "-d";
    char *const arguments[] = {name, defaults, script_name, NULL};
    int number = posix_spawn_file_actions_init(&actions);
    if (number != 0)
        return number;
    number = posix_spawnattr_init(&attributes);
    if (number != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return number;
    }
    number = posix_spawn_file_actions_addchdir_np(&actions, folder);
    for (int stream = 0; stream < 3 && number == 0; stream++)
        number = posix_spawn_file_actions_addopen(&actions, stream, "/dev/null",
                                                  stream == 0 ? O_RDONLY : O_WRONLY, 0);
    sigemptyset(&usual);
    sigaddset(&usual, SIGXFSZ); /* ignored, it would let a drawing be cut short silently */
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setsigmask(&attributes, mask);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                              POSIX_SPAWN_SETSIGDEF);
    if (number == 0)
        number = posix_spawn(child, program, &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return number;
}

/* The time gnuplot has [s]. */
static double time_limit(void)
{
    const char *text = getenv("IMUKIT_GNUPLOT_SECONDS");
    double limit = usual_limit;
    if (text && *text && *imk_decimal_parse(text, text + strlen(text), &limit) != '\0')
        limit = usual_limit;
    return limit > 0 ? limit : usual_limit;
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* @return true when it ended by itself before the limit; it has ended in any case */
static bool await(pid_t child, double limit, int *status)
{
    const struct timespec nap = {.tv_nsec = 2000000};
    const double end = now() + limit;
    pid_t ended;
    while ((ended = waitpid(child, status, WNOHANG)) == 0 && now() < end)
        nanosleep(&nap, NULL);
    if (ended != 0) /* -1: the status went to somebody else; the drawing shows how it was */
        return true;
    kill(-child, SIGKILL);
    while (waitpid(child, status, 0) < 0 && errno == EINTR)
        ;
    return false;
}

static imk_status run(const char *program, const char *folder, imk_error *error)
{
    sigset_t before;
    pid_t child = 0;
    int status = 0, slot = -1;
    const double limit = time_limit();
    hold_signals(&before);
    const int number = start(program, folder, &before, &child);
    if (number == 0)
        slot = imki_leftover_add_program(child);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (number != 0)
        return imki_system_error(error, IMK_ERROR_OPEN, program, number);
    const bool in_time = await(child, limit, &status);
    imki_leftover_drop(slot);
    if (in_time && WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return IMK_OK;
    char found[80] = "gnuplot failed";
    if (!in_time)
        snprintf(found, sizeof found, "gnuplot was ended: it has not finished in %g s", limit);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", found,
                         in_time ? "a working gnuplot >= 5.2: apt install gnuplot-nox"
                                 : "a working gnuplot, or more time: IMUKIT_GNUPLOT_SECONDS");
}

/* ---- the folder ------------------------------------------------------------------------------ */

typedef struct scratch {
    char *folder;
    char *file[FILE_COUNT];
    int slot[FILE_COUNT + 1];
} scratch;

static void scratch_free(scratch *s)
{
    for (int i = 0; i < FILE_COUNT; i++)
        free(s->file[i]);
    free(s->folder);
}

static void scratch_remove(scratch *s)
{
    for (int i = 0; i < FILE_COUNT; i++)
        unlink(s->file[i]);
    rmdir(s->folder);
    for (int i = 0; i <= FILE_COUNT; i++)
        imki_leftover_drop(s->slot[i]);
    scratch_free(s);
}

static imk_status refuse_folder(int number, imk_error *error)
{
    (void)imki_system_error(error, IMK_ERROR_OPEN, "temporary folder", number);
    if (error)
        snprintf(error->expected, sizeof error->expected,
                 "set TMPDIR to a folder that can be written");
    return IMK_ERROR_OPEN;
}

static imk_status scratch_make(scratch *s, imk_error *error)
{
    static const char pattern[] = "/imukit-XXXXXX";
    const char *base = getenv("TMPDIR");
    base = base && *base ? base : "/tmp";
    const size_t size = strlen(base) + sizeof pattern;
    *s = (scratch){.folder = malloc(size)};
    bool good = s->folder != NULL;
    for (int i = 0; i < FILE_COUNT; i++)
        good = (s->file[i] = malloc(size + 1 + strlen(file_names[i]))) && good;
    if (!good) {
        scratch_free(s);
        return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    }
    snprintf(s->folder, size, "%s%s", base, pattern);
    sigset_t before;
    hold_signals(&before);
    const int number = mkdtemp(s->folder) ? 0 : errno;
    for (int i = 0; i < FILE_COUNT && number == 0; i++) {
        snprintf(s->file[i], size + 1 + strlen(file_names[i]), "%s/%s", s->folder, file_names[i]);
        s->slot[i] = imki_leftover_add(s->file[i]);
    }
    if (number == 0)
        s->slot[FILE_COUNT] = imki_leftover_add(s->folder);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (number == 0)
        return IMK_OK;
    scratch_free(s);
    return refuse_folder(number, error);
}

/* @return 0 or an errno value */
static int save(const char *path, const char *text, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return errno;
    int number = fwrite(text, 1, size, file) == size ? 0 : errno;
    if (fclose(file) != 0 && number == 0)
        number = errno;
    return number;
}

/* A whole file that is not empty, with a terminating zero, from malloc(). @return as save() */
static int slurp(const char *path, char **text, size_t *size)
{
    FILE *file = fopen(path, "rb");
    struct stat about;
    if (!file)
        return errno;
    if (fstat(fileno(file), &about) != 0 || about.st_size == 0) {
        fclose(file);
        return ENOENT;
    }
    const size_t length = (size_t)about.st_size;
    char *whole = malloc(length + 1);
    const int number = !whole ? ENOMEM : fread(whole, 1, length, file) == length ? 0 : EIO;
    fclose(file);
    if (number != 0) {
        free(whole);
        return number;
    }
    whole[length] = '\0';
    *text = whole;
    *size = length;
    return 0;
}

/* ---- from end to end ------------------------------------------------------------------------- */

static imk_status save_figure(const imk_figure *figure, imki_drawing *drawing, const scratch *s,
                              imk_error *error)
{
    drawing->output = file_names[OUTPUT];
    drawing->data = file_names[DATA];
    size_t script_size = 0, data_size = 0;
    char *script = imki_figure_script(figure, drawing, &script_size);
    char *data = imki_figure_data(figure, &data_size);
    imk_status status = IMK_OK;
    if (script && data) {
        int number = save(s->file[SCRIPT], script, script_size);
        if (number == 0)
            number = save(s->file[DATA], data, data_size);
        if (number != 0)
            status = refuse_folder(number, error);
    } else {
        status = imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    }
    free(script);
    free(data);
    return status;
}

/* The drawing that gnuplot has left. */
static imk_status take_image(const scratch *s, char **image, size_t *size, imk_error *error)
{
    const int number = slurp(s->file[OUTPUT], image, size);
    if (number == 0)
        return IMK_OK;
    if (number == ENOMEM)
        return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot",
                         "gnuplot failed: there is no drawing",
                         "a working gnuplot >= 5.2: apt install gnuplot-nox");
}

imk_status imki_gnuplot_draw(const imk_figure *figure, imki_drawing *drawing, char **image,
                             size_t *size, imk_error *error)
{
    scratch s;
    char program[PATH_MAX];
    if (!find_program(program))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", "gnuplot is not installed",
                             "install it: apt install gnuplot-nox");
    imk_status status = scratch_make(&s, error);
    if (status != IMK_OK)
        return status;
    status = save_figure(figure, drawing, &s, error);
    if (status == IMK_OK)
        status = run(program, s.folder, error);
    if (status == IMK_OK)
        status = take_image(&s, image, size, error);
    scratch_remove(&s);
    return status;
}
