/* SPDX-License-Identifier: Apache-2.0 */
/* A result on its way out: --json, the terminal, --report and --plot. */
#ifndef IMUKIT_SHOW_H
#define IMUKIT_SHOW_H

#include "command.h"

#include "imukit/result.h"

/* Where a result goes. */
typedef struct show_options {
    const char *report, *plot; /* NULL: nowhere */
    bool json;
    bool quiet;          /* nothing on the terminal, as the caller knows (a table went there) */
    const char *lacking; /* what a figure would need, "observations to draw"; NULL: there is one */
} show_options;

/* An empty result of this verb: ends the command where memory is exhausted. */
imk_result *show_begin(const char *name);
/* The command line, as pages tell it. */
void show_origin(imk_result *result);
/* The warnings up to now, as findings. */
void show_warnings(imk_result *result);
/* Judge what was written by the warnings up to now: "Usable: …", or with care, because of them. */
void show_judge(imk_result *result, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Write the page, print JSON or text, draw, and free the result.
 * @return the exit code: `code`, or another one when something could not be written */
int show_end(imk_result *result, const show_options *options, int code);
/* Print the text to standard error now: standard output is for a log. */
void show_aside(const imk_result *result);
/* Draw now, where the picture comes before the text. @return -1 or the exit code */
int show_plot(const imk_result *result, const char *plot);
/* A model file as text, or why there is none. */
void show_model(imk_result *result, const char *title, const imk_model *model);

#endif
