/* SPDX-License-Identifier: Apache-2.0 */
/* Figures as files, on the terminal and for a page. The drawing is copied to its place as any
 * output file is, so it appears complete or not at all. */
#define _DEFAULT_SOURCE
#include "figure_internal.h"

#include "imukit/utf8.h"

#include "imukit/names.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

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

static imk_status write_file(const char *path, const char *text, size_t size, imk_error *error)
{
    imk_output_file *file;
    imk_status status = imk_output_file_open(path, &file, error);
    if (status != IMK_OK)
        return status;
    imk_output_file_write(file, text, size);
    return imk_output_file_commit(file, error);
}

/* ---- without gnuplot ------------------------------------------------------------------------- */

/* The names a script of FILE.svg has to do with: FILE.svg, FILE.svg.dat, FILE.svg.gp. */
enum { DRAWING, NUMBERS, SCRIPT, NAMES };

/* gnuplot runs what begins with | or < as a command, and takes -, ~ and $ for something else than a
 * file; behind a folder they are letters like others. */
static const char *harmless_prefix(const char *path)
{
    return isalnum((unsigned char)path[0]) || strchr("./_", path[0]) ? "" : "./";
}

static bool make_names(const char *path, char *name[NAMES])
{
    static const char *const endings[NAMES] = {"", ".dat", ".gp"};
    const size_t size = strlen(path) + sizeof "./.dat";
    bool good = true;
    for (int i = 0; i < NAMES; i++) {
        name[i] = malloc(size);
        good = good && name[i];
        if (name[i])
            snprintf(name[i], size, "%s%s%s", harmless_prefix(path), path, endings[i]);
    }
    return good;
}

static bool has_control(const char *text)
{
    while (*text && !iscntrl((unsigned char)*text))
        text++;
    return *text != '\0';
}

/* A word as a shell takes it. @return false when it does not fit, or cannot be shown */
static bool shell_word(const char *text, char *word, size_t size)
{
    size_t used = 0;
    word[used++] = '\'';
    for (const char *c = text; *c; c += imk_utf8_length(c))
        if (imk_utf8_length(c) == 0)
            return false;
    for (; *text; text++) {
        const char letter[2] = {*text, '\0'};
        const char *piece = *text == '\'' ? "'\\''" : letter;
        if (used + strlen(piece) + 2 > size)
            return false;
        memcpy(word + used, piece, strlen(piece));
        used += strlen(piece);
    }
    memcpy(word + used, "'", 2);
    return true;
}

static imk_status say_what_is_missing(const char *path, const char *script, imk_error *error)
{
    char word[96], expected[160] = "apt install gnuplot-nox, then give it the script that is "
                                   "written in its place, with its data";
    if (shell_word(script, word, sizeof word))
        snprintf(expected, sizeof expected,
                 "apt install gnuplot-nox, then: gnuplot %s (written with its data)", word);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, "gnuplot is not installed", expected);
}

/* The numbers and the script beside where the figure would be. */
static imk_status write_script(const imk_figure *figure, const char *path, imki_drawing *drawing,
                               imk_error *error)
{
    char *name[NAMES], *script = NULL, *data = NULL;
    size_t script_size = 0, data_size = 0;
    if (has_control(path))
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "plot",
                             "gnuplot is not installed, and no script can name such a file",
                             "a name without control characters");
    bool good = make_names(path, name);
    if (good) {
        drawing->output = name[DRAWING];
        drawing->data = name[NUMBERS];
        script = imki_figure_script(figure, drawing, &script_size);
        data = imki_figure_data(figure, &data_size);
        good = script && data;
    }
    imk_status status =
        good ? IMK_OK : imk_error_set(error, IMK_ERROR_MEMORY, "figure", NULL, NULL);
    if (status == IMK_OK)
        status = write_file(name[NUMBERS], data, data_size, error);
    if (status == IMK_OK)
        status = write_file(name[SCRIPT], script, script_size, error);
    if (status == IMK_OK)
        status = say_what_is_missing(path, name[SCRIPT], error);
    free(script);
    free(data);
    for (int i = 0; i < NAMES; i++)
        free(name[i]);
    return status;
}

/* ---- from end to end ------------------------------------------------------------------------- */

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
    } else if (imk_has_ending(path, ".svg")) {
        drawing.terminal = IMKI_TERMINAL_SVG;
    } else if (imk_has_ending(path, ".png")) {
        drawing.terminal = IMKI_TERMINAL_PNG;
    } else {
        return imk_error_set(error, IMK_ERROR_FORMAT, "plot", path,
                             "a name ending in .svg or .png, or the word term");
    }
    if (drawing.terminal != IMKI_TERMINAL_TEXT && !imk_plot_available())
        return write_script(figure, path, &drawing, error);
    char *image = NULL;
    size_t size = 0;
    status = imki_gnuplot_draw(figure, &drawing, &image, &size, error);
    if (status == IMK_OK)
        status = write_file(target, image, size, error);
    free(image);
    return status;
}

imk_status imk_figure_svg(const imk_figure *figure, char **svg, size_t *size, imk_error *error)
{
    imki_drawing drawing = {.terminal = IMKI_TERMINAL_SVG};
    const imk_status status = imki_figure_check(figure, error);
    return status == IMK_OK ? imki_gnuplot_draw(figure, &drawing, svg, size, error) : status;
}
