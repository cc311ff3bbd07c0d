/* SPDX-License-Identifier: Apache-2.0 */
/* Runs the program that draws a figure, in a private temporary folder (scratch_folder.c). It has a
 * limited time, and a signal that ends this process ends it too (io/leftovers.c). What it has drawn
 * is taken when it is whole only: gnuplot does not notice that the disk is full. */
#define _GNU_SOURCE /* posix_spawn_file_actions_addchdir_np() */
#include "drawing_program_internal.h"

#include "imukit/decimal.h"
#include "imukit/figure_file.h"
#include "io/file/leftovers_internal.h"
#include "io/file/system_error_internal.h"
#include "scratch_folder_internal.h"

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

/* ---- the program ----------------------------------------------------------------------------- */

/* A program, its package in Debian and its arguments: it works on files of the folder. */
typedef struct tool {
    const char *name, *package;
    const char *argument[8];
} tool;

static const tool *tool_of(imki_terminal terminal)
{
    /* -d: the user's own start-up file must not change our figures. PNG has twice the size of the
     * SVG: sharp on dense screens and in print. */
    static const tool tools[] = {
        [IMKI_TERMINAL_PNG] = {"rsvg-convert",
                               "librsvg2-bin",
                               {"--unlimited", "--format=png", "--zoom=2", "--output=figure.out",
                                "figure.in"}},
        [IMKI_TERMINAL_PDF] = {"rsvg-convert",
                               "librsvg2-bin",
                               {"--unlimited", "--format=pdf", "--output=figure.out", "figure.in"}},
        [IMKI_TERMINAL_TEXT] = {"gnuplot", "gnuplot-nox", {"-d", "figure.in"}}};
    return &tools[terminal];
}

/* Its path on PATH, absolute, for it is started in another folder. */
static bool find_program(const tool *t, char program[PATH_MAX])
{
    for (const char *path = getenv("PATH"); path && *path;) {
        const size_t length = strcspn(path, ":");
        char candidate[PATH_MAX];
        struct stat status;
        const int needed =
            snprintf(candidate, sizeof candidate, "%.*s/%s", (int)length, path, t->name);
        if (length > 0 && needed > 0 && needed < PATH_MAX && stat(candidate, &status) == 0 &&
            S_ISREG(status.st_mode) && access(candidate, X_OK) == 0 && realpath(candidate, program))
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

bool imki_drawing_possible(imki_terminal terminal)
{
    char program[PATH_MAX];
    return find_program(tool_of(terminal), program);
}

/* Start the program in the folder, with its messages in a file, as the leader of a process group.
 * @return 0 or an errno value */
static int start(const tool *t, const char *program, const char *folder, const sigset_t *mask,
                 pid_t *child)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t usual;
    char words[9][24], *arguments[10] = {words[0]};
    snprintf(words[0], sizeof words[0], "%s", t->name);
    for (int i = 0; t->argument[i]; i++) {
        snprintf(words[i + 1], sizeof words[0], "%s", t->argument[i]);
        arguments[i + 1] = words[i + 1];
    }
    int number = posix_spawn_file_actions_init(&actions);
    if (number != 0)
        return number;
    number = posix_spawnattr_init(&attributes);
    if (number != 0) {
        posix_spawn_file_actions_destroy(&actions);
        return number;
    }
    number = posix_spawn_file_actions_addchdir_np(&actions, folder);
    const char *const streams[] = {"/dev/null", "/dev/null", imki_scratch_names[IMKI_SCRATCH_SAID]};
    for (int stream = 0; stream < 3 && number == 0; stream++)
        number = posix_spawn_file_actions_addopen(&actions, stream, streams[stream],
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

/* The time it has [s]. */
static double time_limit(void)
{
    const char *text = getenv("IMUKIT_DRAWING_SECONDS");
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

/* What happened, and in its own words why. */
static imk_status refuse(const tool *t, const imki_scratch *s, const char *found, imk_error *error)
{
    char line[160], expected[sizeof line + 60];
    imki_scratch_last_line(s, IMKI_SCRATCH_SAID, line, sizeof line);
    if (line[0])
        snprintf(expected, sizeof expected, "%s printed: %s", t->name, line);
    else
        snprintf(expected, sizeof expected, "check that %s works: %s --version", t->name, t->name);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", found, expected);
}

static imk_status run(const tool *t, const char *program, const imki_scratch *s, imk_error *error)
{
    sigset_t before;
    pid_t child = 0;
    int status = 0, slot = -1;
    const double limit = time_limit();
    imki_signals_hold(&before);
    const int number = start(t, program, s->folder, &before, &child);
    if (number == 0)
        slot = imki_leftover_add_program(child);
    imki_signals_release(&before);
    if (number != 0)
        return imki_system_error(error, IMK_ERROR_OPEN, program, number);
    const bool in_time = await(child, limit, &status);
    imki_leftover_drop(slot);
    char found[sizeof error->found], expected[sizeof error->expected];
    if (!in_time) {
        snprintf(found, sizeof found, "%s was stopped: it did not finish in %g s", t->name, limit);
        snprintf(expected, sizeof expected,
                 "check that %s works, or give it more time: IMUKIT_DRAWING_SECONDS", t->name);
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", found, expected);
    }
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
        return IMK_OK;
    if (WIFSIGNALED(status))
        snprintf(found, sizeof found, "%s was ended by signal %d (%s)", t->name, WTERMSIG(status),
                 strsignal(WTERMSIG(status)));
    else
        snprintf(found, sizeof found, "%s failed with exit code %d", t->name, WEXITSTATUS(status));
    return refuse(t, s, found, error);
}

/* ---- from end to end ------------------------------------------------------------------------- */

/* For gnuplot a script and numbers; for the other our SVG. */
static imk_status save_figure(const imk_figure *figure, imki_drawing *drawing,
                              const imki_scratch *s, imk_error *error)
{
    const bool in_letters = drawing->terminal == IMKI_TERMINAL_TEXT;
    char *input = NULL, *data = NULL;
    size_t input_size = 0, data_size = 0;
    imk_status status = IMK_OK;
    drawing->output = imki_scratch_names[IMKI_SCRATCH_OUTPUT];
    drawing->data = imki_scratch_names[IMKI_SCRATCH_DATA];
    if (in_letters) {
        input = imki_figure_script(figure, drawing, &input_size);
        data = imki_figure_data(figure, &data_size);
        if (!input || !data)
            status = imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    } else {
        status = imk_figure_svg(figure, &input, &input_size, error);
    }
    if (status == IMK_OK)
        status = imki_scratch_save(s, IMKI_SCRATCH_INPUT, input, input_size, error);
    if (status == IMK_OK && in_letters)
        status = imki_scratch_save(s, IMKI_SCRATCH_DATA, data, data_size, error);
    if (status == IMK_OK)
        status = imki_scratch_save(s, IMKI_SCRATCH_SAID, "", 0, error);
    free(input);
    free(data);
    return status;
}

static bool ends_with(const char *text, size_t size, const char *end, size_t end_size)
{
    return size >= end_size && memcmp(text + size - end_size, end, end_size) == 0;
}

/* Is nothing missing at the end? In letters each panel has as many lines as the terminal. */
static bool is_whole(const imk_figure *figure, const imki_drawing *drawing, const char *image,
                     size_t size)
{
    static const char pdf_end[] = "%%EOF\n", png_end[] = "\0\0\0\0IEND\xAE\x42\x60\x82";
    size_t lines = 0;
    switch (drawing->terminal) {
    case IMKI_TERMINAL_PDF:
        return ends_with(image, size, pdf_end, sizeof pdf_end - 1);
    case IMKI_TERMINAL_PNG:
        return ends_with(image, size, png_end, sizeof png_end - 1);
    case IMKI_TERMINAL_TEXT:
        for (size_t i = 0; i < size; i++)
            lines += image[i] == '\n';
        return lines >= figure->panel_count * (size_t)drawing->height;
    }
    return false;
}

/* The drawing that the program has left. */
static imk_status take_image(const imk_figure *figure, const imki_drawing *drawing,
                             const imki_scratch *s, char **image, size_t *size, imk_error *error)
{
    char *drawn = NULL;
    size_t length = 0;
    const int number = imki_scratch_load(s, IMKI_SCRATCH_OUTPUT, &drawn, &length);
    if (number == ENOMEM)
        return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    if (number != 0 || !is_whole(figure, drawing, drawn, length)) {
        const tool *t = tool_of(drawing->terminal);
        char found[sizeof error->found];
        snprintf(found, sizeof found, "%s failed: %s", t->name,
                 number != 0 ? "there is no drawing" : "the end of its drawing is missing");
        free(drawn);
        return refuse(t, s, found, error);
    }
    *image = drawn;
    *size = length;
    return IMK_OK;
}

/* What to install, and what needs nothing. */
static imk_status refuse_missing(const tool *t, imki_terminal terminal, imk_error *error)
{
    char found[sizeof error->found], expected[sizeof error->expected];
    snprintf(found, sizeof found, "%s is not installed", t->name);
    snprintf(expected, sizeof expected, "install it: apt install %s%s", t->package,
             terminal == IMKI_TERMINAL_TEXT ? ""
                                            : "; a file ending in .svg needs no other program");
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", found, expected);
}

imk_status imki_drawing_make(const imk_figure *figure, imki_drawing *drawing, char **image,
                             size_t *size, imk_error *error)
{
    imki_scratch s;
    char program[PATH_MAX];
    const tool *t = tool_of(drawing->terminal);
    if (!find_program(t, program))
        return refuse_missing(t, drawing->terminal, error);
    imk_status status = imki_scratch_make(&s, error);
    if (status != IMK_OK)
        return status;
    status = save_figure(figure, drawing, &s, error);
    if (status == IMK_OK) {
        status = run(t, program, &s, error);
        if (status == IMK_OK)
            status = take_image(figure, drawing, &s, image, size, error);
        if (status == IMK_ERROR_UNSUPPORTED && imki_scratch_is_full(&s))
            status = imki_scratch_refuse_full(error);
    }
    imki_scratch_remove(&s);
    return status;
}
