/* SPDX-License-Identifier: Apache-2.0 */
/* A page as it is put together. */
#ifndef IMUKI_PAGE_INTERNAL_H
#define IMUKI_PAGE_INTERNAL_H

#include "growing_text_internal.h"
#include "imukit/model.h"

#include "imukit/report.h"

/* Script and style sheet of every page, and the hash by which a page allows the script:
 * "sha256-…". cmake/write_page_assets.cmake makes them from page_*.js and page_style.css. */
extern const unsigned char imki_page_script[], imki_page_style[];
extern const char imki_page_script_hash[];

/* A self-contained HTML page being built: style, script and drawings are inside, nothing is
 * fetched, every text is escaped. Functions accept the NULL of a failed imki_page_create(), which
 * imki_page_take() then reports. */
typedef struct imki_page imki_page;

/* Start a page, or only the <article> of one; NULL when memory is exhausted, which every function
 * below allows. */
imki_page *imki_page_create(const char *title, const char *subtitle, bool whole);
/* A heading, escaped; the text must live as long as the page. */
void imki_page_heading(imki_page *page, const char *text);
/* A paragraph of plain text (escaped). */
void imki_page_text(imki_page *page, const char *text);
/* The judgement, large: 0 usable, 1 with care, 2 not usable. */
void imki_page_judgement(imki_page *page, int level, const char *text);
/* A coloured box: 0 good, 1 note, 2 warning. */
void imki_page_verdict(imki_page *page, int level, const char *text);
/* A table of rows x columns texts, the first row the header; right: as of imk_result_table(). */
void imki_page_table(imki_page *page, size_t rows, size_t columns, unsigned right,
                     const char *const *cells);
/* A figure, drawn into the page panel by panel, each with its numbers. For a figure without a point
 * to draw, a note says what is missing. */
void imki_page_figure(imki_page *page, const imk_figure *figure, const char *caption);
/* An animation, drawn into the page. */
void imki_page_animation(imki_page *page, const imk_animation *animation, const char *caption);
/* A drawing made here, an SVG text; NULL: none, as memory was exhausted. */
void imki_page_drawing(imki_page *page, const char *svg, const char *caption);
/* Begin a new sheet on paper and in a PDF; no effect on the screen. */
void imki_page_break(imki_page *page);
/* Preformatted text, such as a model file. */
void imki_page_code(imki_page *page, const char *text);
/* The page as text obtained from malloc(); frees the page.
 * @return IMK_ERROR_MEMORY */
imk_status imki_page_take(imki_page *page, char **text, size_t *size, imk_error *error);

/* ---- catalogue_data.c ------------------------------------------------------------------------ */

/* The Allan deviations of all sensors of the catalogue [rad/s, m/s^2], as JSON. */
void imki_catalogue_data(imki_text *out);
/* Allan deviation of all noise terms of a triad together, on its worst axis [rad/s, m/s^2], without
 * what rounded readings add. @param time  averaging time [s] */
double imki_noise_deviation(const imk_triad *triad, double time);

#endif
