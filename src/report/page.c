/* SPDX-License-Identifier: Apache-2.0 */
/* A self-contained HTML page: style, script and drawings inside, nothing fetched, every text
 * escaped. */
#include "figure_internal.h"
#include "markup_internal.h"
#include "page_internal.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The page grows in memory; a failed allocation is remembered and reported at the end, so that
 * callers need no check after every paragraph. */
struct imki_page {
    imki_text text;
    uint32_t drawings;
    bool whole;            /* not only the <article> */
    bool allan_deviations; /* are drawn: those of the catalogue can be laid over them */
    const char *heading;   /* the last one, by which tables are called */
    imk_error failure;     /* of the first animation that failed */
};

static void element(imki_page *page, const char *open, const char *text, const char *close)
{
    if (!page)
        return;
    imki_text_put(&page->text, open);
    imki_markup_escape(&page->text, text);
    imki_text_put(&page->text, close);
}

/* Up to the body. Nothing but the script below may run, and nothing can be fetched. */
static void put_head(imki_page *page, const char *title)
{
    imki_text_add(&page->text,
                  "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                  "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                  "style-src 'unsafe-inline'; script-src '%s'; img-src data:; base-uri 'none'; "
                  "form-action 'none'\">\n"
                  "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n",
                  imki_page_script_hash);
    element(page, "<title>", title, "</title>\n<style>\n");
    imki_text_put(&page->text, (const char *)imki_page_style);
    imki_text_put(&page->text, "</style>\n</head>\n<body class=\"imukit-page\">\n<main>\n");
}

static void put_tail(imki_page *page)
{
    imki_text_put(&page->text,
                  "<footer>Made by imukit " IMK_VERSION ".</footer>\n</main>\n<script>");
    imki_text_put(&page->text, (const char *)imki_page_script);
    imki_text_put(&page->text, "</script>\n</body>\n</html>\n");
}

imki_page *imki_page_create(const char *title, const char *subtitle, bool whole)
{
    imki_page *page = calloc(1, sizeof *page);
    if (!page)
        return NULL;
    page->whole = whole;
    if (whole)
        put_head(page, title);
    element(page, "<article class=\"imukit\">\n<h1>", title, "</h1>\n");
    element(page, "<p class=\"subtitle\">", subtitle, "</p>\n");
    return page;
}

void imki_page_heading(imki_page *page, const char *text)
{
    if (page)
        page->heading = text;
    element(page, "<h2>", text, "</h2>\n");
}

void imki_page_text(imki_page *page, const char *text)
{
    element(page, "<p>", text, "</p>\n");
}

void imki_page_verdict(imki_page *page, int level, const char *text)
{
    static const char *const open[] = {"<p class=\"verdict good\">", "<p class=\"verdict note\">",
                                       "<p class=\"verdict warning\">"};
    element(page, open[level < 0 ? 0 : level > 2 ? 2 : level], text, "</p>\n");
}

void imki_page_judgement(imki_page *page, int level, const char *text)
{
    static const char *const open[] = {"<p class=\"judgement good\">",
                                       "<p class=\"judgement care\">",
                                       "<p class=\"judgement bad\">"};
    element(page, open[level < 0 ? 0 : level > 2 ? 2 : level], text, "</p>\n");
}

/* The first column names the rows. An empty corner is no header. */
static void put_cell(imki_page *page, const char *cell, size_t row, size_t column, bool right)
{
    const char *side = right ? " class=\"right\"" : "";
    const bool header = (row == 0 || column == 0) && cell[0];
    if (header)
        imki_text_add(&page->text, "<th scope=\"%s\"%s>", row == 0 ? "col" : "row", side);
    else
        imki_text_add(&page->text, "<td%s>", side);
    element(page, "", cell, header ? "</th>" : "</td>");
}

void imki_page_table(imki_page *page, size_t rows, size_t columns, unsigned right,
                     const char *const *cells)
{
    if (!page)
        return;
    element(page, "<div class=\"table\" role=\"group\" tabindex=\"0\" aria-label=\"",
            page->heading ? page->heading : "Table", "\"><table>\n");
    for (size_t row = 0; row < rows; row++) {
        imki_text_put(&page->text, row == 0 ? "<thead><tr>" : row == 1 ? "<tbody><tr>" : "<tr>");
        for (size_t column = 0; column < columns; column++)
            put_cell(page, cells[row * columns + column], row, column,
                     column < 32 && (right >> column & 1U));
        imki_text_put(&page->text, row == 0 ? "</tr></thead>\n" : "</tr>\n");
    }
    imki_text_put(&page->text, rows > 1 ? "</tbody></table></div>\n" : "</table></div>\n");
}

void imki_page_break(imki_page *page)
{
    element(page, "<div class=\"sheet\">", "", "</div>\n");
}

void imki_page_code(imki_page *page, const char *text)
{
    element(page, "<pre tabindex=\"0\">", text, "</pre>\n");
}

/* A drawing made here. Its identifiers get a number that follows from it and its place, so that
 * drawings can share a page, also one into which several articles are put. No text of a caller can
 * contain one of these openings, because its quotes are escaped. */
static void put_svg(imki_page *page, const char *svg)
{
    static const char *const openings[] = {" id=\"", " clip-path=\"url(#", "href=\"#"};
    uint32_t number = 2166136261U + page->drawings++; /* FNV-1a */
    for (const char *c = svg; *c; c++)
        number = (number ^ (unsigned char)*c) * 16777619U;
    while (*svg) {
        size_t length = 0;
        for (size_t i = 0; i < sizeof openings / sizeof openings[0] && length == 0; i++)
            if (strncmp(svg, openings[i], strlen(openings[i])) == 0)
                length = strlen(openings[i]);
        if (length == 0) {
            imki_text_put_char(&page->text, *svg++);
        } else {
            imki_text_add(&page->text, "%.*sf%08x-", (int)length, svg, (unsigned)number);
            svg += length;
        }
    }
}

static void fail(imki_page *page, const imk_error *error)
{
    if (page->failure.status == IMK_OK)
        page->failure = *error;
}

/* JSON for the script; `class`: with a blank before, or "". */
static void put_data(imki_page *page, imki_text *data, const char *class)
{
    size_t size;
    char *json = imki_text_take(data, &size);
    page->text.failed = page->text.failed || !json;
    imki_text_add(&page->text, "<script type=\"application/json\"%s>", class);
    imki_markup_data(&page->text, json ? json : "");
    imki_text_put(&page->text, "</script>\n");
    free(json);
}

/* The drawing of a panel, and its numbers for the script. */
static void put_panel(imki_page *page, const imk_panel *panel, bool alone)
{
    imki_text drawing = {.bytes = NULL}, data = {.bytes = NULL};
    size_t size;
    imki_panel_svg(&drawing, panel, alone);
    imki_panel_data(&data, panel, alone);
    char *svg = imki_text_take(&drawing, &size);
    page->text.failed = page->text.failed || !svg;
    imki_text_put(&page->text, "<div class=\"panel\">\n");
    put_svg(page, svg ? svg : "");
    put_data(page, &data, "");
    imki_text_put(&page->text, "</div>\n");
    free(svg);
    page->allan_deviations = page->allan_deviations || panel->allan_deviation;
}

void imki_page_figure(imki_page *page, const imk_figure *figure, const char *caption)
{
    if (!page)
        return;
    imk_error error;
    if (imki_figure_check(figure, &error) != IMK_OK) {
        element(page, "<p class=\"verdict note\">Figure left out: ", error.found, "; ");
        element(page, "", error.expected, ".</p>\n");
        return;
    }
    const imki_figure_size size = imki_figure_measure(figure);
    const bool alone = figure->panel_count == 1;
    imki_text_add(&page->text, "<figure class=\"panels columns-%zu\">\n", size.columns);
    if (!alone && figure->title[0])
        element(page, "<p class=\"name\">", figure->title, "</p>\n");
    imki_text_put(&page->text, "<div class=\"panes\">\n");
    for (size_t p = 0; p < figure->panel_count; p++)
        put_panel(page, &figure->panels[p], alone);
    imki_text_put(&page->text, "</div>\n");
    if (caption && caption[0])
        element(page, "<figcaption>", caption, "</figcaption>\n");
    imki_text_put(&page->text, "</figure>\n");
}

void imki_page_drawing(imki_page *page, const char *svg, const char *caption)
{
    if (!page || !svg)
        return;
    imki_text_put(&page->text, "<figure class=\"animation\" tabindex=\"0\">\n");
    put_svg(page, svg);
    element(page, "<figcaption>", caption, "</figcaption>\n</figure>\n");
}

void imki_page_animation(imki_page *page, const imk_animation *animation, const char *caption)
{
    char *svg = NULL;
    size_t size;
    imk_error error;
    if (!page)
        return;
    const imk_status status = imk_animation_svg(animation, &svg, &size, &error);
    if (status == IMK_ERROR_MEMORY) {
        fail(page, &error);
        return;
    }
    if (status != IMK_OK) {
        element(page, "<p class=\"verdict note\">Animation left out: ", error.found, ".</p>\n");
        return;
    }
    imki_page_drawing(page, svg, caption);
    free(svg);
}

imk_status imki_page_take(imki_page *page, char **text, size_t *size, imk_error *error)
{
    if (!page)
        return imk_error_set(error, IMK_ERROR_MEMORY, "page", NULL, NULL);
    if (page->allan_deviations) {
        imki_text catalogue = {.bytes = NULL};
        imki_catalogue_data(&catalogue);
        put_data(page, &catalogue, " class=\"catalogue\"");
    }
    imki_text_put(&page->text, "</article>\n");
    if (page->whole)
        put_tail(page);
    imk_status status = page->failure.status;
    if (page->text.failed)
        status = imk_error_set(error, IMK_ERROR_MEMORY, "page", NULL, NULL);
    else if (status != IMK_OK && error)
        *error = page->failure;
    if (status == IMK_OK) {
        *text = page->text.bytes;
        *size = page->text.size;
    } else {
        free(page->text.bytes);
    }
    free(page);
    return status;
}
