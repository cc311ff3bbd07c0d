/* SPDX-License-Identifier: Apache-2.0 */
/* A self-contained HTML page: styles and drawings inside, nothing fetched, every text escaped. */
#include "markup_internal.h"
#include "page_internal.h"

#include <stdlib.h>
#include <string.h>

/* The page grows in memory; a failed allocation is remembered and reported at the end, so that
 * callers need no check after every paragraph. */
struct imki_page {
    imki_text text;
    int figures;
    imk_error failure; /* of the first drawing that failed */
};

static const char style[] =
    ":root{color-scheme:light}*{box-sizing:border-box}\n"
    "body{margin:0;background:#f5f6f7;color:#1d2327;"
    "font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\n"
    "main{max-width:1100px;margin:0 auto;padding:2.2rem 1.4rem 4rem;background:#fff;"
    "min-height:100vh}\n"
    "h1{font-size:1.75rem;line-height:1.25;margin:0}"
    ".subtitle{color:#5b6770;margin:.3rem 0 1.4rem}\n"
    "h2{font-size:1.2rem;margin:2.2rem 0 .7rem;padding-bottom:.25rem;"
    "border-bottom:1px solid #dfe3e6}\n"
    ".verdict{border-left:5px solid;padding:.6rem .9rem;margin:.6rem 0;border-radius:0 4px 4px 0}\n"
    ".judgement{font-size:1.3rem;line-height:1.4;font-weight:600;border-left:8px solid;"
    "padding:.7rem 1rem;margin:.2rem 0 1.2rem;border-radius:0 4px 4px 0}"
    ".care{border-color:#e69f00;background:#fdf5e2}.bad{border-color:#c1272d;background:#fbe9e9}\n"
    ".good{border-color:#009e73;background:#e9f6f1}.note{border-color:#0072b2;background:#e8f2f9}"
    ".warning{border-color:#d55e00;background:#fdf0e7}\n"
    ".table{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums;"
    "font-size:.92rem;margin:.4rem 0}\n"
    "th,td{padding:.35rem .8rem;text-align:left;vertical-align:top;"
    "border-bottom:1px solid #e6e9eb;white-space:pre-line}\n"
    "th{background:#f0f2f4}td:first-child{font-weight:600}\n"
    "pre{background:#f6f7f8;border:1px solid #e1e5e8;border-radius:4px;padding:.8rem 1rem;"
    "overflow-x:auto;font:.85rem/1.5 ui-monospace,'DejaVu Sans Mono',Menlo,Consolas,monospace}\n"
    "figure{margin:1rem 0}figure svg{width:100%;height:auto}"
    "figcaption{color:#5b6770;font-size:.9rem}\n"
    "footer{margin-top:3rem;color:#7a858d;font-size:.82rem}\n"
    "@media print{@page{margin:15mm}body{font-size:10.5pt;print-color-adjust:exact;"
    "-webkit-print-color-adjust:exact}body,main{background:#fff}"
    "main{max-width:none;padding:0;min-height:0}h1,h2{break-after:avoid}"
    "figure,table,tr,pre,.verdict,.judgement{break-inside:avoid}.table{overflow:visible}"
    "pre{white-space:pre-wrap}th,td{padding:.2rem .5rem}.sheet{break-after:page}}\n";

static void element(imki_page *page, const char *open, const char *text, const char *close)
{
    if (!page)
        return;
    imki_text_put(&page->text, open);
    imki_markup_escape(&page->text, text);
    imki_text_put(&page->text, close);
}

imki_page *imki_page_create(const char *title, const char *subtitle)
{
    imki_page *page = calloc(1, sizeof *page);
    if (!page)
        return NULL;
    element(page,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
            title, "</title>\n<style>\n");
    imki_text_put(&page->text, style);
    element(page, "</style>\n</head>\n<body>\n<main>\n<h1>", title, "</h1>\n");
    element(page, "<p class=\"subtitle\">", subtitle, "</p>\n");
    return page;
}

void imki_page_heading(imki_page *page, const char *text)
{
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

void imki_page_table(imki_page *page, size_t rows, size_t columns, const char *const *cells)
{
    if (!page)
        return;
    imki_text_put(&page->text, "<div class=\"table\"><table>\n");
    for (size_t row = 0; row < rows; row++) {
        imki_text_put(&page->text, "<tr>");
        for (size_t column = 0; column < columns; column++)
            element(page, row == 0 ? "<th>" : "<td>", cells[row * columns + column],
                    row == 0 ? "</th>" : "</td>");
        imki_text_put(&page->text, "</tr>\n");
    }
    imki_text_put(&page->text, "</table></div>\n");
}

void imki_page_break(imki_page *page)
{
    element(page, "<div class=\"sheet\">", "", "</div>\n");
}

void imki_page_code(imki_page *page, const char *text)
{
    element(page, "<pre>", text, "</pre>\n");
}

/* A drawing made here; its identifiers are made unique, since several drawings share the page. No
 * text of a caller can contain one of these openings, because its quotes are escaped. */
static void put_svg(imki_page *page, const char *svg)
{
    static const char *const openings[] = {" id=\"", " clip-path=\"url(#", "href=\"#"};
    page->figures++;
    while (*svg) {
        size_t length = 0;
        for (size_t i = 0; i < sizeof openings / sizeof openings[0] && length == 0; i++)
            if (strncmp(svg, openings[i], strlen(openings[i])) == 0)
                length = strlen(openings[i]);
        if (length == 0) {
            imki_text_put_char(&page->text, *svg++);
        } else {
            imki_text_add(&page->text, "%.*sf%d-", (int)length, svg, page->figures);
            svg += length;
        }
    }
}

static void fail(imki_page *page, const imk_error *error)
{
    if (page->failure.status == IMK_OK)
        page->failure = *error;
}

void imki_page_figure(imki_page *page, const imk_figure *figure, const char *caption)
{
    if (!page)
        return;
    char *svg = NULL;
    size_t size;
    imk_error error;
    const bool drawn = imk_figure_svg(figure, &svg, &size, &error) == IMK_OK;
    if (!drawn && error.status == IMK_ERROR_EMPTY) {
        element(page, "<p class=\"verdict note\">Figure left out: ", error.found, "; ");
        element(page, "", error.expected, ".</p>\n");
        return;
    }
    if (!drawn) {
        fail(page, &error);
        return;
    }
    imki_text_put(&page->text, "<figure>\n");
    put_svg(page, svg);
    element(page, "<figcaption>", caption, "</figcaption>\n</figure>\n");
    free(svg);
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
    imki_text_put(&page->text, "<figure>\n");
    put_svg(page, svg);
    element(page, "<figcaption>", caption, "</figcaption>\n</figure>\n");
    free(svg);
}

imk_status imki_page_take(imki_page *page, char **text, size_t *size, imk_error *error)
{
    if (!page)
        return imk_error_set(error, IMK_ERROR_MEMORY, "page", NULL, NULL);
    imki_text_put(&page->text,
                  "<footer>Made by imukit " IMK_VERSION ".</footer>\n</main>\n</body>\n</html>\n");
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
