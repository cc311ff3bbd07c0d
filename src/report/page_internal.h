/* SPDX-License-Identifier: Apache-2.0 */
/* A page as it is put together. */
#ifndef IMUKI_PAGE_INTERNAL_H
#define IMUKI_PAGE_INTERNAL_H

#include "imukit/report.h"

/* A self-contained HTML page being built: styles and drawings are inside, nothing is fetched,
 * every text is escaped. Functions accept the NULL of a failed imki_page_create(), which
 * imki_page_take() then reports. */
typedef struct imki_page imki_page;

/* Start a page; NULL when memory is exhausted, which every function below allows. */
imki_page *imki_page_create(const char *title, const char *subtitle);
/* A heading, escaped. */
void imki_page_heading(imki_page *page, const char *text);
/* A paragraph of plain text (escaped). */
void imki_page_text(imki_page *page, const char *text);
/* The judgement, large: 0 usable, 1 with care, 2 not usable. */
void imki_page_judgement(imki_page *page, int level, const char *text);
/* A coloured box: 0 good, 1 note, 2 warning. */
void imki_page_verdict(imki_page *page, int level, const char *text);
/* A table of rows x columns texts, the first row the header. */
void imki_page_table(imki_page *page, size_t rows, size_t columns, const char *const *cells);
/* A figure, drawn into the page. For a figure without a point to draw, a note says what is missing;
 * imki_page_take() reports any other failure. */
void imki_page_figure(imki_page *page, const imk_figure *figure, const char *caption);
/* An animation, drawn into the page. */
void imki_page_animation(imki_page *page, const imk_animation *animation, const char *caption);
/* Begin a new sheet on paper and in a PDF; no effect on the screen. */
void imki_page_break(imki_page *page);
/* Preformatted text, such as a model file. */
void imki_page_code(imki_page *page, const char *text);
/* The page as text obtained from malloc(); frees the page.
 * @return IMK_ERROR_MEMORY, and why a figure was not drawn, as of imk_figure_svg() */
imk_status imki_page_take(imki_page *page, char **text, size_t *size, imk_error *error);

#endif
