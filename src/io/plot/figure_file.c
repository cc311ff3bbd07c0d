/* SPDX-License-Identifier: Apache-2.0 */
/* Figures as files and on the terminal: SVG is drawn here (report/figure_svg.c), PNG and PDF are
 * made of it by rsvg-convert, letters by gnuplot. A drawing is written as any output file is, so it
 * appears complete or not at all. */
#define _DEFAULT_SOURCE
#include "drawing_program_internal.h"

#include "report/figure_internal.h"

#include "imukit/figure_file.h"
#include "imukit/names.h"
#include "imukit/output_file.h"

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

/* What a name asks for, other than SVG. @return false: another ending */
static bool terminal_of(const char *path, imki_terminal *terminal)
{
    *terminal = strcmp(path, "term") == 0      ? IMKI_TERMINAL_TEXT
                : imk_has_ending(path, ".pdf") ? IMKI_TERMINAL_PDF
                                               : IMKI_TERMINAL_PNG;
    return *terminal != IMKI_TERMINAL_PNG || imk_has_ending(path, ".png");
}

bool imk_plot_available(const char *path)
{
    imki_terminal terminal;
    return imk_has_ending(path, ".svg") ||
           (terminal_of(path, &terminal) && imki_drawing_possible(terminal));
}

static imk_status draw_by_program(const imk_figure *figure, imki_terminal terminal, char **image,
                                  size_t *size, imk_error *error)
{
    imki_drawing drawing = {.terminal = terminal};
    if (terminal == IMKI_TERMINAL_TEXT) {
        const char *no_color = getenv("NO_COLOR");
        terminal_size(&drawing.width, &drawing.height, figure->panel_count);
        drawing.color = isatty(STDOUT_FILENO) && !(no_color && *no_color);
    }
    return imki_drawing_make(figure, &drawing, image, size, error);
}

imk_status imk_figure_write(const imk_figure *figure, const char *path, imk_error *error)
{
    const bool in_letters = strcmp(path, "term") == 0;
    imki_terminal terminal;
    char *image = NULL;
    size_t size = 0;
    imk_status status = imki_figure_check(figure, error);
    if (status != IMK_OK)
        return status;
    if (imk_has_ending(path, ".svg"))
        status = imk_figure_svg(figure, &image, &size, error);
    else if (terminal_of(path, &terminal))
        status = draw_by_program(figure, terminal, &image, &size, error);
    else
        return imk_error_set(error, IMK_ERROR_FORMAT, "plot", path,
                             "a name ending in .svg, .png or .pdf, or the word term");
    if (status == IMK_OK)
        status = write_file(in_letters ? "-" : path, image, size, error);
    free(image);
    return status;
}

imk_status imk_animation_write(const imk_animation *animation, const char *path, imk_error *error)
{
    char *svg;
    size_t size;
    if (!imk_has_ending(path, ".svg"))
        return imk_error_set(error, IMK_ERROR_FORMAT, "animation", path, "a name ending in .svg");
    imk_status status = imk_animation_svg(animation, &svg, &size, error);
    if (status == IMK_OK) {
        status = write_file(path, svg, size, error);
        free(svg);
    }
    return status;
}

imk_status imk_schematic_write(const imk_physics_log_settings *settings, double seconds,
                               size_t frames, const char *path, imk_error *error)
{
    char *svg;
    size_t size;
    if (strcmp(path, "-") != 0 && !imk_has_ending(path, ".svg"))
        return imk_error_set(error, IMK_ERROR_FORMAT, "schematic", path, "a name ending in .svg");
    imk_status status = imk_schematic_animated(settings, seconds, frames, NULL, &svg, &size, error);
    if (status == IMK_OK) {
        status = write_file(path, svg, size, error);
        free(svg);
    }
    return status;
}
