/* SPDX-License-Identifier: Apache-2.0 */
/* What figure.c hands to gnuplot.c: the script and the numbers of a figure as text. */
#ifndef IMUKIT_REPORT_FIGURE_INTERNAL_H
#define IMUKIT_REPORT_FIGURE_INTERNAL_H

#include "imukit/report.h"

typedef enum imki_terminal {
    IMKI_TERMINAL_SVG = 0,
    IMKI_TERMINAL_PNG,
    IMKI_TERMINAL_TEXT
} imki_terminal;

/* Where a script draws to and reads from. */
typedef struct imki_drawing {
    imki_terminal terminal;
    const char *output, *data; /* paths the script names */
    int width, height;         /* characters; of IMKI_TERMINAL_TEXT only */
    bool color;                /* of IMKI_TERMINAL_TEXT only */
} imki_drawing;

/* Refuse a figure that cannot be drawn: no panel, a panel without a drawable point. */
imk_status imki_figure_check(const imk_figure *figure, imk_error *error);

/* The gnuplot script and its data, texts from malloc(); NULL when memory is exhausted. */
char *imki_figure_script(const imk_figure *figure, const imki_drawing *drawing, size_t *size);
char *imki_figure_data(const imk_figure *figure, size_t *size);

/* Path of a program on PATH, from malloc(); NULL when there is none. */
char *imki_program_find(const char *name);

/* Run the program on one script file with its messages discarded; true when it ended with 0. */
bool imki_gnuplot_run(const char *program, const char *script);

#endif
