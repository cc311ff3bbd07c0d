/* SPDX-License-Identifier: Apache-2.0 */
/* What gnuplot is given: the script and the numbers of a figure as text; and its drawing. */
#ifndef IMUKIT_GNUPLOT_INTERNAL_H
#define IMUKIT_GNUPLOT_INTERNAL_H

#include "imukit/report.h"

typedef enum imki_terminal {
    IMKI_TERMINAL_PNG = 0,
    IMKI_TERMINAL_PDF,
    IMKI_TERMINAL_TEXT
} imki_terminal;

/* Where a script draws to and reads from. */
typedef struct imki_drawing {
    imki_terminal terminal;
    const char *output, *data; /* paths the script names */
    int width, height;         /* characters; of IMKI_TERMINAL_TEXT only */
    bool color;                /* of IMKI_TERMINAL_TEXT only */
} imki_drawing;

/* The gnuplot script and its data, texts from malloc(); NULL when memory is exhausted. */
char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size);
char *imki_figure_data(const imk_figure *figure, size_t *size);

/* Draw with gnuplot, in a temporary folder: the drawing from malloc(), with a terminating zero.
 * output and data of `drawing` are set. */
imk_status imki_gnuplot_draw(const imk_figure *figure, imki_drawing *drawing, char **image,
                             size_t *size, imk_error *error);

#endif
