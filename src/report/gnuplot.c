/* SPDX-License-Identifier: Apache-2.0 */
/* Runs gnuplot on a figure: script, numbers and drawing live in a private temporary directory; no
 * shell is involved. The drawing is copied to its place as any output file is, so it appears
 * complete or not at all. */
#define _DEFAULT_SOURCE
#include "figure_internal.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Names inside the temporary directory. */
enum { SCRIPT, DATA, OUTPUT, FILE_COUNT };
static const char *const file_names[FILE_COUNT] = {"figure.gp", "figure.dat", "figure.out"};

typedef struct scratch {
    char directory[256];
    char file[FILE_COUNT][300];
} scratch;

char *imki_program_find(const char *name)
{
    const char *path = getenv("PATH");
    while (path && *path) {
        size_t length = strcspn(path, ":");
        size_t size = length + strlen(name) + 2;
        char *candidate = malloc(size);
        struct stat status;
        if (!candidate)
            return NULL;
        snprintf(candidate, size, "%.*s/%s", (int)length, path, name);
        if (length > 0 && stat(candidate, &status) == 0 && S_ISREG(status.st_mode) &&
            access(candidate, X_OK) == 0)
            return candidate;
        free(candidate);
        path += length + (path[length] == ':');
    }
    return NULL;
}

bool imk_plot_available(void)
{
    char *program = imki_program_find("gnuplot");
    free(program);
    return program != NULL;
}

bool imki_gnuplot_run(const char *program, const char *script)
{
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return false;
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    /* -d: the user's own start-up file must not change our figures. */
    char name[] = "gnuplot", defaults[] = "-d";
    char *copy = strdup(script);
    char *const arguments[] = {name, defaults, copy, NULL};
    pid_t child;
    int status = -1;
    bool started = copy && posix_spawn(&child, program, &actions, NULL, arguments, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    if (started)
        while (waitpid(child, &status, 0) < 0 && errno == EINTR)
            ;
    free(copy);
    return started && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static bool scratch_make(scratch *s)
{
    char directory[sizeof s->directory];
    const char *base = getenv("TMPDIR");
    int length =
        snprintf(directory, sizeof directory, "%s/imukit-XXXXXX", base && *base ? base : "/tmp");
    if (length < 0 || (size_t)length >= sizeof directory || !mkdtemp(directory))
        return false;
    for (int i = 0; i < FILE_COUNT; i++)
        snprintf(s->file[i], sizeof s->file[i], "%s/%s", directory, file_names[i]);
    memcpy(s->directory, directory, sizeof directory);
    return true;
}

static void scratch_remove(const scratch *s)
{
    for (int i = 0; i < FILE_COUNT; i++)
        unlink(s->file[i]);
    rmdir(s->directory);
}

static bool save(const char *path, const char *text, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return false;
    bool good = fwrite(text, 1, size, file) == size;
    return fclose(file) == 0 && good;
}

/* A whole small file with a terminating zero. */
static char *slurp(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    char *text = NULL;
    long length;
    if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) >= 0 &&
        fseek(file, 0, SEEK_SET) == 0 && (text = malloc((size_t)length + 1)) != NULL) {
        *size = fread(text, 1, (size_t)length, file);
        text[*size] = '\0';
    }
    fclose(file);
    return text;
}

static void terminal_size(int *width, int *height, size_t panels)
{
    struct winsize size;
    *width = 79;
    *height = 24;
    if (isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 &&
        size.ws_col >= 40 && size.ws_row >= 12) {
        *width = size.ws_col - 1 < 160 ? size.ws_col - 1 : 160;
        *height = size.ws_row - 2 < 48 ? size.ws_row - 2 : 48;
    }
    /* Several panels follow one another down the page. */
    if (panels > 1 && *height > 30)
        *height = 30;
}

static imk_status memory_error(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
}

/* Draw in a temporary directory and hand over the drawing. */
static imk_status draw(const imk_figure *figure, imki_drawing *drawing, char **image, size_t *size,
                       imk_error *error)
{
    scratch s;
    char *program = imki_program_find("gnuplot");
    if (!program)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", "gnuplot is not installed",
                             "install it: apt install gnuplot-nox");
    if (!scratch_make(&s)) {
        free(program);
        return imk_error_set(error, IMK_ERROR_OPEN, "temporary directory", strerror(errno),
                             "set TMPDIR to a directory that can be written");
    }
    drawing->output = s.file[OUTPUT];
    drawing->data = s.file[DATA];
    size_t script_size = 0, data_size = 0;
    char *script = imki_figure_script(figure, drawing, &script_size);
    char *data = imki_figure_data(figure, &data_size);
    imk_status status = IMK_OK;
    *image = NULL;
    if (!script || !data)
        status = memory_error(error);
    else if (!save(s.file[SCRIPT], script, script_size) || !save(s.file[DATA], data, data_size))
        status = imk_error_set(error, IMK_ERROR_WRITE, s.directory, strerror(errno),
                               "set TMPDIR to a directory that can be written");
    else if (!imki_gnuplot_run(program, s.file[SCRIPT]) ||
             !(*image = slurp(s.file[OUTPUT], size)) || *size == 0)
        status = imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot", "gnuplot failed",
                               "a working gnuplot >= 5.2: apt install gnuplot-nox");
    if (status != IMK_OK) {
        free(*image);
        *image = NULL;
    }
    free(script);
    free(data);
    free(program);
    scratch_remove(&s);
    return status;
}

static imk_status write_file(const char *path, const char *text, size_t size, imk_error *error)
{
    imk_output_file *file;
    imk_status status = imk_output_file_open(path, &file, error);
    if (status != IMK_OK)
        return status;
    imk_output_file_write(file, text, size);
    return imk_output_file_commit(file, error);
}

static bool ends_with(const char *text, const char *end)
{
    size_t length = strlen(text), end_length = strlen(end);
    return length > end_length && strcmp(text + length - end_length, end) == 0;
}

/* Without gnuplot: the numbers and the script beside where the figure would be. */
static imk_status write_script(const imk_figure *figure, const char *path, imki_drawing *drawing,
                               imk_error *error)
{
    size_t stem = strlen(path) - 4;
    char *script_path = malloc(stem + 8), *data_path = malloc(stem + 8);
    char *script = NULL, *data = NULL;
    imk_status status = IMK_ERROR_MEMORY;
    if (script_path && data_path) {
        snprintf(script_path, stem + 8, "%.*s.gp", (int)stem, path);
        snprintf(data_path, stem + 8, "%.*s.dat", (int)stem, path);
        drawing->output = path;
        drawing->data = data_path;
        size_t script_size = 0, data_size = 0;
        script = imki_figure_script(figure, drawing, &script_size);
        data = imki_figure_data(figure, &data_size);
        if (script && data) {
            status = write_file(data_path, data, data_size, error);
            if (status == IMK_OK)
                status = write_file(script_path, script, script_size, error);
            if (status == IMK_OK) {
                char expected[160];
                snprintf(expected, sizeof expected,
                         "apt install gnuplot-nox, then: gnuplot %s (written with its data)",
                         script_path);
                status = imk_error_set(error, IMK_ERROR_UNSUPPORTED, path,
                                       "gnuplot is not installed", expected);
            }
        }
    }
    if (status == IMK_ERROR_MEMORY)
        memory_error(error);
    free(script);
    free(data);
    free(script_path);
    free(data_path);
    return status;
}

imk_status imk_figure_write(const imk_figure *figure, const char *path, imk_error *error)
{
    imk_status status = imki_figure_check(figure, error);
    if (status != IMK_OK)
        return status;
    imki_drawing drawing = {0};
    const char *target = path;
    if (strcmp(path, "term") == 0) {
        drawing.terminal = IMKI_TERMINAL_TEXT;
        terminal_size(&drawing.width, &drawing.height, figure->panel_count);
        const char *no_color = getenv("NO_COLOR");
        drawing.color = isatty(STDOUT_FILENO) && !(no_color && *no_color);
        target = "-";
    } else if (ends_with(path, ".svg")) {
        drawing.terminal = IMKI_TERMINAL_SVG;
    } else if (ends_with(path, ".png")) {
        drawing.terminal = IMKI_TERMINAL_PNG;
    } else {
        return imk_error_set(error, IMK_ERROR_FORMAT, "plot", path,
                             "a name ending in .svg or .png, or the word term");
    }
    if (drawing.terminal != IMKI_TERMINAL_TEXT && !imk_plot_available())
        return write_script(figure, path, &drawing, error);
    char *image;
    size_t size = 0;
    status = draw(figure, &drawing, &image, &size, error);
    if (status == IMK_OK)
        status = write_file(target, image, size, error);
    free(image);
    return status;
}

imk_status imk_figure_svg(const imk_figure *figure, char **svg, size_t *size, imk_error *error)
{
    imk_status status = imki_figure_check(figure, error);
    imki_drawing drawing = {.terminal = IMKI_TERMINAL_SVG};
    char *image;
    size_t image_size = 0;
    if (status == IMK_OK)
        status = draw(figure, &drawing, &image, &image_size, error);
    if (status != IMK_OK)
        return status;
    *svg = image;
    *size = image_size;
    return IMK_OK;
}
