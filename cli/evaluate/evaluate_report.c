/* SPDX-License-Identifier: Apache-2.0 */
/* The test report: one self-contained page to be read, or printed on paper or into a PDF. */
#include "evaluate_parts.h"

#include "shell/page_table.h"

#include <math.h>
#include <string.h>

static void put_table(imk_page *page, text_table table)
{
    if (table.rows > 1)
        page_put_table(page, &table);
    text_table_free(&table);
}

/* What only the user knows; no line for what was not said. */
static void put_unit(imk_page *page, const evaluation *v)
{
    const evaluate_options *o = v->options;
    const struct {
        const char *title, *text;
    } rows[] = {{"Unit under test", o->unit},  {"Serial number", o->serial},
                {"Laboratory", o->laboratory}, {"Operator", o->operator_name},
                {"Date of the test", o->date}, {"Temperature", o->temperature}};
    text_table table = text_table_make(2);
    text_table_row(&table);
    text_table_set(&table, 0, "Test");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        if (!rows[k].text)
            continue;
        text_table_row(&table);
        text_table_set(&table, 0, "%s", rows[k].title);
        text_table_set(&table, 1, "%.110s", rows[k].text);
    }
    for (size_t k = 0; k < v->path_count; k++) {
        text_table_row(&table);
        text_table_set(&table, 0, "%s", k == 0 ? "Readings" : "");
        text_table_set(&table, 1, "%.110s", v->path[k]);
    }
    if (o->rest) {
        text_table_row(&table);
        text_table_set(&table, 0, "Log at rest");
        text_table_set(&table, 1, "%.110s", o->rest);
    }
    put_table(page, table);
}

static void put_limits(imk_page *page, const evaluation *v, const char *name, size_t count,
                       const evaluate_row *row, size_t *judged, size_t *bad, size_t *doubtful)
{
    for (size_t k = 0; k < count; k++) {
        const char *text;
        char line[300];
        const evaluate_verdict verdict = evaluate_judge(v, &row[k], &text);
        *judged += verdict != VERDICT_NONE;
        if (verdict <= VERDICT_MET)
            continue;
        *(verdict == VERDICT_DOUBTFUL ? doubtful : bad) += 1;
        snprintf(line, sizeof line, "%s, %s: %s (limit %s).", name, row[k].title,
                 evaluate_verdict_text(verdict), text);
        imk_page_verdict(page, verdict == VERDICT_DOUBTFUL ? 1 : 2, line);
    }
}

static void put_verdict(imk_page *page, const evaluation *v)
{
    evaluate_row row[EVALUATE_ROWS];
    size_t judged = 0, bad = 0, doubtful = 0;
    if (v->limit_count == 0)
        return;
    imk_page_heading(page, "Verdict");
    for (size_t k = 0; k < v->channel_count; k++)
        put_limits(page, v, v->channel[k].name, evaluate_figures(v, &v->channel[k], row), row,
                   &judged, &bad, &doubtful);
    for (size_t k = 0; k < v->rest_count; k++)
        put_limits(page, v, v->rest[k].name, evaluate_rest_figures(&v->rest[k], row), row, &judged,
                   &bad, &doubtful);
    if (bad + doubtful == 0) {
        char text[120];
        snprintf(text, sizeof text, "All %zu limits are met, with their whole intervals.", judged);
        imk_page_verdict(page, 0, text);
    }
}

static void put_channel(imk_page *page, const evaluation *v, const evaluate_channel *c)
{
    evaluate_row row[EVALUATE_ROWS];
    char text[500];
    imk_page_heading(page, c->name);
    evaluate_basis(c, text, sizeof text);
    imk_page_text(page, text);
    put_table(page, evaluate_figure_table(v, "figure", evaluate_figures(v, c, row), row));
    for (size_t line = 0; evaluate_remark(c, line, text, sizeof text); line++) {
        char sentence[sizeof text + 1];
        snprintf(sentence, sizeof sentence, "%s.", text);
        imk_page_text(page, sentence);
    }
    evaluate_put_figure(c, page);
}

static void put_definitions(imk_page *page, const evaluation *v)
{
    evaluate_row row[EVALUATE_ROWS];
    char text[500];
    size_t count = v->channel_count > 0 ? evaluate_figures(v, &v->channel[0], row) : 0;
    imk_page_heading(page, "Definitions");
    const char *cells[2 + 4 * EVALUATE_ROWS] = {"figure", "definition"};
    size_t used = 1;
    for (int rest = 0; rest < 2; rest++) {
        for (size_t k = 0; k < count; k++, used++) {
            cells[2 * used] = row[k].title;
            cells[2 * used + 1] = row[k].definition;
        }
        count = rest == 0 && v->rest_count > 0 ? evaluate_rest_figures(&v->rest[0], row) : 0;
    }
    imk_page_table(page, used, 2, cells);
    if (v->channel_count == 0)
        return;
    snprintf(text, sizeof text,
             "Intervals hold the true figure with %g %% confidence: Student's and the chi-square "
             "distribution for the figures of the line and the precision. Of figures that are the "
             "largest of several differences, the interval is that of what a unit without noise "
             "would show at the same levels; it holds it with at least about that confidence.",
             100 * v->options->confidence);
    imk_page_text(page, text);
    imk_page_text(page, "Figures are those of the runs tested; how a further run would differ is "
                        "the repeatability. The uncertainty of the reference is not contained.");
}

int evaluate_report(const evaluation *v, const char *path)
{
    char subtitle[300];
    evaluate_row row[EVALUATE_ROWS];
    const evaluate_options *o = v->options;
    snprintf(subtitle, sizeof subtitle, "%.100s%s%.80s", o->unit ? o->unit : "Laboratory figures",
             o->serial ? ", serial number " : "", o->serial ? o->serial : "");
    imk_page *page = imk_page_create("Test report", subtitle);
    put_unit(page, v);
    put_verdict(page, v);
    for (size_t k = 0; k < v->channel_count; k++) {
        if (k > 0)
            imk_page_break(page);
        put_channel(page, v, &v->channel[k]);
    }
    if (v->rest_count > 0)
        imk_page_heading(page, "At rest");
    for (size_t k = 0; k < v->rest_count; k++)
        put_table(page, evaluate_figure_table(v, v->rest[k].name,
                                              evaluate_rest_figures(&v->rest[k], row), row));
    imk_page_break(page);
    put_definitions(page, v);
    for (size_t k = 0; k < v->channel_count; k++) {
        char text[EVALUATE_NAME + 20];
        snprintf(text, sizeof text, "Levels of %s", v->channel[k].name);
        imk_page_heading(page, text);
        put_table(page, evaluate_level_table(v, &v->channel[k]));
    }
    imk_page_heading(page, "This page was made by");
    imk_page_code(page, command_line());
    return page_write(page, path);
}
