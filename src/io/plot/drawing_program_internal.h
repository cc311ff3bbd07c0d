/* SPDX-License-Identifier: Apache-2.0 */
/* Programs that draw: gnuplot in letters, from a script and numbers; rsvg-convert PNG and PDF, from
 * our SVG. */
#ifndef IMUKIT_DRAWING_PROGRAM_INTERNAL_H
#define IMUKIT_DRAWING_PROGRAM_INTERNAL_H

#include "imukit/report.h"

typedef enum imki_terminal {
    IMKI_TERMINAL_PNG = 0,
    IMKI_TERMINAL_PDF,
    IMKI_TERMINAL_TEXT
} imki_terminal;

typedef struct imki_drawing {
    imki_terminal terminal;
    const char *output, *data; /* paths the script of gnuplot names */
    int width, height;         /* characters; of IMKI_TERMINAL_TEXT only */
    bool color;                /* of IMKI_TERMINAL_TEXT only */
} imki_drawing;

/* The script of gnuplot in letters and its data, texts from malloc(); NULL when memory is
 * exhausted. */
char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size);
char *imki_figure_data(const imk_figure *figure, size_t *size);

/* Is the program there that draws so? */
bool imki_drawing_possible(imki_terminal terminal);

/* Draw in a temporary folder: the drawing from malloc(), with a terminating zero. output and data
 * of `drawing` are set.
 * @return IMK_ERROR_UNSUPPORTED when the program is missing or fails */
imk_status imki_drawing_make(const imk_figure *figure, imki_drawing *drawing, char **image,
                             size_t *size, imk_error *error);

#endif
