/* SPDX-License-Identifier: Apache-2.0 */
/* Figures as SVG: read back as XML, with every path followed from point to point. */
#include "check.h"
#include "report/figure_internal.h"

#include <expat.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading a drawing ----------------------------------------------------------------------- */

typedef struct label {
    double x, y, size; /* [tenths of a pixel] */
    int anchor;        /* 0 start, 1 middle, 2 end */
    bool turned;
    char text[500];
} label;

enum { LABELS_MAX = 400, RUNS_MAX = 50000 };

/* What stands in a drawing; of paths, those of the curves. */
typedef struct drawing {
    double width, height;
    double left, top, right, bottom; /* of the last frame */
    bool in_curves, in_text;
    size_t frames, labels, vertices, runs;
    double lowest, highest, leftmost, rightmost; /* of vertices, y downwards */
    double margin;                               /* that a mark may reach over the frame */
    label label[LABELS_MAX];
} drawing;

static const char *attribute(const char **attributes, const char *name)
{
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

static double number_of(const char **attributes, const char *name)
{
    const char *text = attribute(attributes, name);
    assert_non_null(text);
    assert_null(strpbrk(text, ".,")); /* whole tenths of a pixel */
    return strtod(text, NULL);
}

static void visit(drawing *d, double x, double y)
{
    assert_true(x >= d->left - d->margin && x <= d->right + d->margin);
    assert_true(y >= d->top - d->margin && y <= d->bottom + d->margin);
    d->highest = fmin(d->highest, y);
    d->lowest = fmax(d->lowest, y);
    d->leftmost = fmin(d->leftmost, x);
    d->rightmost = fmax(d->rightmost, x);
    d->vertices++;
}

static void follow(drawing *d, const char *c)
{
    double x = 0, y = 0;
    while (*c) {
        const char kind = *c++;
        char *end = (char *)(size_t)c;
        if (kind == 'z')
            continue;
        assert_non_null(strchr("MlhvHV", kind));
        const double first = strtod(c, &end);
        assert_true(end > c);
        c = end;
        double second = 0;
        if (kind == 'M' || kind == 'l') {
            second = strtod(c, &end);
            assert_true(end > c);
            c = end;
        }
        d->runs += kind == 'M';
        x = kind == 'M' || kind == 'H' ? first : kind == 'l' || kind == 'h' ? x + first : x;
        y = kind == 'M'   ? second
            : kind == 'V' ? first
            : kind == 'l' ? y + second
            : kind == 'v' ? y + first
                          : y;
        visit(d, x, y);
    }
}

static void begin(void *context, const char *name, const char **attributes)
{
    drawing *d = context;
    if (strcmp(name, "svg") == 0) {
        char box[60];
        d->width = 10 * number_of(attributes, "width");
        d->height = 10 * number_of(attributes, "height");
        snprintf(box, sizeof box, "0 0 %.0f %.0f", d->width, d->height);
        assert_string_equal(attribute(attributes, "viewBox"), box);
    } else if (strcmp(name, "rect") == 0 && attribute(attributes, "x") && !d->in_curves) {
        d->left = number_of(attributes, "x");
        d->top = number_of(attributes, "y");
        d->right = d->left + number_of(attributes, "width");
        d->bottom = d->top + number_of(attributes, "height");
        d->frames++;
    } else if (strcmp(name, "g") == 0 && attribute(attributes, "clip-path")) {
        d->in_curves = true;
    } else if (strcmp(name, "path") == 0 && d->in_curves) {
        follow(d, attribute(attributes, "d"));
    } else if (strcmp(name, "text") == 0) {
        assert_true(d->labels < LABELS_MAX);
        label *l = &d->label[d->labels++];
        const char *anchor = attribute(attributes, "text-anchor");
        const char *size = attribute(attributes, "font-size");
        *l = (label){.x = number_of(attributes, "x"),
                     .y = number_of(attributes, "y"),
                     .size = size ? strtod(size, NULL) : 0,
                     .anchor = !anchor                         ? 0
                               : strcmp(anchor, "middle") == 0 ? 1
                                                               : 2,
                     .turned = attribute(attributes, "transform") != NULL};
        d->in_text = true;
    } else if (strcmp(name, "tspan") == 0) {
        strcat(d->label[d->labels - 1].text, "^");
    }
}

static void end(void *context, const char *name)
{
    drawing *d = context;
    if (strcmp(name, "g") == 0)
        d->in_curves = false;
    if (strcmp(name, "text") == 0)
        d->in_text = false;
}

static void text(void *context, const char *letters, int length)
{
    drawing *d = context;
    if (d->in_text)
        strncat(d->label[d->labels - 1].text, letters, (size_t)length);
}

static drawing last;

/* Read a drawing; what is not well-formed, or leaves the frame, fails. */
static const drawing *read_svg(const char *svg, size_t size, double margin)
{
    XML_Parser parser = XML_ParserCreate("UTF-8");
    last = (drawing){.margin = margin,
                     .highest = HUGE_VAL,
                     .lowest = -HUGE_VAL,
                     .leftmost = HUGE_VAL,
                     .rightmost = -HUGE_VAL};
    XML_SetUserData(parser, &last);
    XML_SetElementHandler(parser, begin, end);
    XML_SetCharacterDataHandler(parser, text);
    if (XML_Parse(parser, svg, (int)size, 1) != XML_STATUS_OK)
        fail_msg("line %lu: %s", XML_GetCurrentLineNumber(parser),
                 XML_ErrorString(XML_GetErrorCode(parser)));
    XML_ParserFree(parser);
    return &last;
}

static size_t last_size;

static const drawing *draw(const imk_figure *figure)
{
    char *svg = NULL;
    imk_error error;
    CHECK_OK(imk_figure_svg(figure, &svg, &last_size, &error));
    assert_int_equal(strlen(svg), last_size);
    const drawing *d = read_svg(svg, last_size, 1);
    free(svg);
    return d;
}

static const drawing *draw_panel(const imk_panel *panel)
{
    return draw(&(imk_figure){.panel_count = 1, .panels = panel});
}

static const drawing *draw_curve(imk_curve_style style, size_t count, const double *x,
                                 const double *y, bool logarithmic)
{
    const imk_curve curve = {
        .style = style, .count = count, .x = x, .y = y, .lower = y, .upper = y};
    return draw_panel(&(imk_panel){
        .x_logarithmic = logarithmic,
        .y_logarithmic = logarithmic,
        .curve_count = 1,
        .curves = &curve,
    });
}

static const label *find(const drawing *d, const char *text)
{
    for (size_t i = 0; i < d->labels; i++)
        if (strcmp(d->label[i].text, text) == 0)
            return &d->label[i];
    return NULL;
}

/* ---- a figure of everything ------------------------------------------------------------------ */

enum { POINTS = 40, CURVES = 6 };

static double across[POINTS], value[POINTS], lower[POINTS], upper[POINTS];
static imk_curve curves[CURVES];
static const imk_region regions[] = {{"left < region", 2, 0.1, 10, 0.02, 1, false, false},
                                     {"right & region", 3, 1, 1e3, 0.3, 1e4, true, true}};

static imk_panel everything(imk_key_place key)
{
    for (int i = 0; i < POINTS; i++) {
        across[i] = pow(10, 0.1 * i - 1);
        value[i] = 1 + sin(i);
        lower[i] = 0.8 * value[i];
        upper[i] = 1.2 * value[i];
    }
    static const char *const names[CURVES] = {"line", "points",     "<b>&amp; \"x\"",
                                              "",     "gr\xF6\xDF", "a\x01z"};
    for (int c = 0; c < CURVES; c++)
        curves[c] =
            (imk_curve){names[c], (imk_curve_style)c, c - 1, POINTS, across, value, lower, upper};
    return (imk_panel){.title = "title <svg>",
                       .x_label = "x & y",
                       .y_label = "]]> 'y'",
                       .x_logarithmic = true,
                       .y_logarithmic = true,
                       .curve_count = CURVES,
                       .curves = curves,
                       .region_count = 2,
                       .regions = regions,
                       .key = key,
                       .note = "first <note>\nsecond & last"};
}

/* All styles, in one panel and in several, with the key in each place: well-formed, each text there
 * as it was given, and whole within the drawing, for whose letters there is a table of widths. */
static void test_everything_is_drawn(void **state)
{
    (void)state;
    for (int key = IMK_KEY_UPPER; key <= IMK_KEY_BELOW; key++)
        for (size_t panels = 1; panels <= 5; panels++) {
            imk_panel panel[5];
            for (size_t p = 0; p < panels; p++)
                panel[p] = everything((imk_key_place)key);
            char *svg;
            size_t size;
            CHECK_OK(
                imk_figure_svg(&(imk_figure){"whole > part", panels, 2, panel}, &svg, &size, NULL));
            const drawing *d = read_svg(svg, size, 90); /* diamonds */
            free(svg);
            assert_int_equal(d->frames, panels);
            assert_int_equal(find(d, "whole > part") != NULL, panels > 1);
            static const char *const texts[] = {
                "title <svg>",    "x & y",          "]]> 'y'", "left < region",
                "right & region", "<b>&amp; \"x\"", "az",      "gr\xEF\xBF\xBD\xEF\xBF\xBD",
                "first <note>",   "second & last"};
            for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
                assert_non_null(find(d, texts[i]));
            for (size_t i = 0; i < d->labels; i++) {
                const label *l = &d->label[i];
                const double width = imki_line_width(l->text, l->size);
                const double left = l->x - width * l->anchor / 2;
                assert_true(l->turned || (left >= 0 && left + width <= d->width));
                assert_true(l->y > 0 && l->y <= d->height - 20);
            }
        }
}

/* The name of a region keeps off the lines that cross its corner: a dashed line, and the side of
 * another region. That of a region narrower than its name stands outside, crossed by nothing. */
static void test_names_off_lines(void **state)
{
    (void)state;
    static const double line_x[] = {1.5, 1.5}, line_y[] = {0, 10};
    static const imk_region crossed[] = {{"a crossed region", 0, 1, 9, 6, 9, false, false},
                                         {"wide", 1, 0, 10, 8.8, 10, false, false},
                                         {"narrower than this", 2, 4, 4.2, 2, 3, false, false}};
    const imk_curve line = {"", IMK_CURVE_DASHES, 0, 2, line_x, line_y, NULL, NULL};
    const imk_panel panel = {
        .curve_count = 1, .curves = &line, .region_count = 3, .regions = crossed};
    const drawing *d = draw_panel(&panel);
    const double scale = (d->right - d->left) / 11.4, origin = d->left + 0.7 * scale;
    const label *name = find(d, "a crossed region"), *narrow = find(d, "narrower than this");
    const double side = d->bottom - (8.8 + 0.7) / 11.4 * (d->bottom - d->top);
    assert_true(name && narrow);
    assert_true(name->x > origin + 1.5 * scale);
    assert_true(name->y - 100 > side);
    const double top = d->bottom - (3 + 0.7) / 11.4 * (d->bottom - d->top);
    const double bottom = d->bottom - (2 + 0.7) / 11.4 * (d->bottom - d->top);
    assert_true(narrow->y < top || narrow->y - 100 > bottom);
}

/* Noise that fills the frame leaves no corner for a key: it stands below the axes. Without it the
 * key of a panel among others is within them. */
static void test_key_off_data(void **state)
{
    (void)state;
    static double x[400], y[400];
    for (int i = 0; i < 400; i++) {
        x[i] = i;
        y[i] = i % 2;
    }
    const imk_curve noise = {"noise", IMK_CURVE_LINE, 0, 400, x, y, NULL, NULL};
    const imk_curve full[3] = {noise, noise, noise}; /* higher than the margin above the data */
    const imk_curve flat = {"flat", IMK_CURVE_LINE, 0, 1, x, y, NULL, NULL};
    const imk_panel noisy = {.curve_count = 3, .curves = full};
    const imk_panel calm = {.curve_count = 1, .curves = &flat};
    const imk_panel panels[2][2] = {{noisy, noisy}, {calm, calm}};
    const drawing *d = draw(&(imk_figure){"", 2, 2, panels[0]});
    assert_true(find(d, "noise")->y > d->bottom);
    d = draw(&(imk_figure){"", 2, 2, panels[1]});
    assert_true(find(d, "flat")->y < d->bottom);
}

/* Given limits are those of the axis: a line is cut there, and spans it the other way. */
static void test_given_limits(void **state)
{
    (void)state;
    static const double x[] = {0, 1, 2, 3}, y[] = {100, 1, 2, 1};
    const imk_curve line = {"", IMK_CURVE_LINE, 0, 4, x, y, NULL, NULL};
    const imk_panel panel = {.curve_count = 1, .curves = &line, .y_low = 0, .y_high = 4};
    const drawing *d = draw_panel(&panel);
    assert_non_null(find(d, "4.0"));
    assert_null(find(d, "100"));
    assert_non_null(find(d, "3.0"));
}

static void test_size_is_that_of_old(void **state)
{
    (void)state;
    static const double x[] = {1, 2};
    const imk_curve curve = {.count = 2, .x = x, .y = x};
    const imk_panel plain = {.curve_count = 1, .curves = &curve};
    const imk_panel four[] = {plain, plain, plain, plain};
    const drawing *d = draw_panel(&plain);
    assert_true(d->width == 8600 && d->height == 5600);
    d = draw(&(imk_figure){"", 4, 3, four});
    assert_true(d->width == 3 * 4800 && d->height == 2 * 3800 + 400);
}

/* Long texts are made smaller, or their middle left out, and stay on the drawing. */
static void test_long_texts(void **state)
{
    (void)state;
    char text[2000];
    for (size_t i = 0; i + 1 < sizeof text; i++)
        text[i] = "W\xC3\xB6"[i % 3];
    text[sizeof text - 2] = '\0';
    imk_panel panel[2];
    panel[0] = panel[1] = everything(IMK_KEY_UPPER);
    panel[0].title = panel[0].x_label = panel[0].y_label = text;
    curves[1].label = text;
    for (size_t panels = 1; panels <= 2; panels++) {
        char *svg;
        size_t size;
        CHECK_OK(imk_figure_svg(&(imk_figure){text, panels, 2, panel}, &svg, &size, NULL));
        const drawing *d = read_svg(svg, size, 90);
        free(svg);
        size_t shortened = 0;
        for (size_t i = 0; i < d->labels; i++) {
            const label *l = &d->label[i];
            const double width = imki_line_width(l->text, l->size);
            const double left = l->x - width * l->anchor / 2;
            shortened += strstr(l->text, "…") != NULL;
            if (l->turned)
                assert_true(l->y - width / 2 >= 0 && l->y + width / 2 <= d->height);
            else
                assert_true(left >= 0 && left + width <= d->width);
        }
        assert_int_equal(shortened, panels == 1 ? 4 : 6);
    }
}

/* ---- axes ------------------------------------------------------------------------------------ */

/* Air of 7 % on either side, so 5 of 0 … 10 and 1 of 0.01 … 100 are in the middle; the ends of the
 * curve are 0.07/1.14 of the frame away from its sides. */
static void test_ticks_are_where_they_belong(void **state)
{
    (void)state;
    static const double linear[] = {0, 10}, logarithmic[] = {0.01, 100};
    for (int log = 0; log < 2; log++) {
        const drawing *d = draw_curve(IMK_CURVE_LINE, 2, log ? logarithmic : linear,
                                      log ? logarithmic : linear, log);
        const double width = d->right - d->left, height = d->bottom - d->top;
        const label *x = NULL, *y = NULL;
        for (size_t i = 0; i < d->labels; i++)
            if (strcmp(d->label[i].text, log ? "10^0" : "4") == 0) {
                x = d->label[i].y > d->bottom ? &d->label[i] : x;
                y = d->label[i].x < d->left ? &d->label[i] : y;
            }
        assert_non_null(x);
        assert_non_null(y);
        const double place = log ? 0.5 : 4.7 / 11.4;
        CHECK_CLOSE(x->x, d->left + place * width, 1);
        CHECK_CLOSE(y->y, d->bottom - place * height + 42, 1.1); /* 0.35 of 12 px lower */
        CHECK_CLOSE(d->leftmost, d->left + 0.07 / 1.14 * width, 1);
        CHECK_CLOSE(d->rightmost, d->right - 0.07 / 1.14 * width, 1);
        CHECK_CLOSE(d->highest, d->top + 0.07 / 1.14 * height, 1);
        CHECK_CLOSE(d->lowest, d->bottom - 0.07 / 1.14 * height, 1);
    }
}

/* The labels of an axis that spans this, in 500 px with 50 for each. */
static void check_labels(double low, double high, bool logarithmic, const char *expected)
{
    imki_axis axis = {low, high, logarithmic, logarithmic && high - low < 2.5};
    imki_ticks ticks;
    char labels[1000] = "";
    double before = -1;
    imki_axis_ticks(&axis, 500, 50, &ticks);
    for (size_t i = 0; i < ticks.count; i++) {
        const imki_tick *t = &ticks.tick[i];
        assert_true(t->place > before && t->place <= 1);
        before = t->place;
        if (t->labelled)
            snprintf(labels + strlen(labels), sizeof labels - strlen(labels), "%s%s%s ", t->text,
                     t->power[0] ? "^" : "", t->power);
    }
    assert_string_equal(labels, expected);
}

static void test_labels(void **state)
{
    (void)state;
    check_labels(-0.7, 10.7, false, "0 2 4 6 8 10 ");
    check_labels(-1, 1, false, "−1.0 −0.8 −0.6 −0.4 −0.2 0 0.2 0.4 0.6 0.8 1.0 ");
    check_labels(-3e-7, 5.2e-7, false,
                 "−3·10^−7 −2·10^−7 −1·10^−7 0 1·10^−7 2·10^−7 3·10^−7 4·10^−7 5·10^−7 ");
    check_labels(0, 4.2e9, false,
                 "0 0.5·10^9 1.0·10^9 1.5·10^9 2.0·10^9 2.5·10^9 3.0·10^9 3.5·10^9 4.0·10^9 ");
    check_labels(1000000, 1000000.31, false,
                 "1000000.00 1000000.05 1000000.10 1000000.15 1000000.20 1000000.25 1000000.30 ");
    check_labels(-2, 0.1, true, "0.01 0.02 0.05 0.1 0.2 0.5 1 ");
    check_labels(-6, -5, true, "10^−6 2·10^−6 5·10^−6 10^−5 ");
    check_labels(log10(21), log10(43), true, "25 30 35 40 ");
    check_labels(-3.2, 3.2, true, "10^−3 10^−2 10^−1 10^0 10^1 10^2 10^3 ");
    check_labels(-310, 300, true,
                 "10^−300 10^−250 10^−200 10^−150 10^−100 10^−50 10^0 10^50 10^100 10^150 10^200 "
                 "10^250 10^300 ");
}

/* ---- curves ---------------------------------------------------------------------------------- */

/* Only the points span the axes: a line that leaves them ends at the frame, where it crosses it. */
static void test_line_is_clipped(void **state)
{
    (void)state;
    static const double x[] = {0, 1}, y[] = {0, 1}, far[] = {0.5, -1e300};
    const imk_curve both[] = {{.style = IMK_CURVE_POINTS, .count = 2, .x = x, .y = y},
                              {.style = IMK_CURVE_LINE, .count = 2, .x = x, .y = far}};
    const drawing *d = draw_panel(&(imk_panel){.curve_count = 2, .curves = both});
    assert_true(d->lowest == d->bottom);
    const imk_curve outside[] = {both[0], {.count = 1, .x = x, .y = &far[1]}};
    d = draw_panel(&(imk_panel){.curve_count = 2, .curves = outside});
    assert_int_equal(d->vertices, 4); /* of the points: M and h0 */
}

/* Two runs and a dot between gaps, whatever makes the gap. */
static void test_gaps(void **state)
{
    (void)state;
    const double nan = (double)NAN, inf = HUGE_VAL;
    const double x[] = {1, 2, 3, 4, 5, 6, 7, nan}, y[] = {1, 2, nan, 3, inf, 4, 3, 2};
    const double positive[] = {1, 2, 0, 3, -1, 4, 3, nan};
    assert_int_equal(draw_curve(IMK_CURVE_LINE, 8, x, y, false)->runs, 3);
    assert_int_equal(draw_curve(IMK_CURVE_LINE, 8, x, positive, true)->runs, 3);
    assert_int_equal(draw_curve(IMK_CURVE_BAND, 8, x, y, false)->runs, 3);
    assert_int_equal(draw_curve(IMK_CURVE_POINTS, 8, x, y, false)->runs, 10); /* with bars */
}

/* Nothing to draw is refused; a point, a flat curve and the largest numbers are drawn. */
static void test_hard_numbers(void **state)
{
    (void)state;
    const double nan = (double)NAN;
    const double hard[][3] = {{0, 0, 0},           {5, 5, 5},
                              {-1e308, 0, 1e308},  {5e-324, 1, 1.7e308},
                              {1, 1 + 2.3e-16, 1}, {1e-320, 2e-320, 3e-320},
                              {nan, -1e-300, nan}, {1e15, 1e15 + 1, 1e15},
                              {-1e308, -1e308, 1}};
    for (size_t i = 0; i < sizeof hard / sizeof hard[0]; i++)
        for (int style = IMK_CURVE_LINE; style <= IMK_CURVE_MARKS; style++)
            for (int log = 0; log < 2; log++) {
                bool positive = false;
                const imk_curve curve = {
                    "", (imk_curve_style)style, 0, 3, hard[i], hard[i], hard[i], hard[i]};
                const imk_panel panel = {.title = "the panel",
                                         .x_logarithmic = log,
                                         .y_logarithmic = log,
                                         .curve_count = 1,
                                         .curves = &curve};
                for (int k = 0; k < 3; k++)
                    positive = positive || imki_drawable(hard[i][k], log);
                char *svg = NULL;
                size_t size = 0;
                imk_error error;
                const imk_status status =
                    imk_figure_svg(&(imk_figure){"", 1, 1, &panel}, &svg, &size, &error);
                assert_int_equal(status, positive ? IMK_OK : IMK_ERROR_EMPTY);
                if (positive) {
                    assert_true(read_svg(svg, size, 90)->vertices > 0);
                    assert_null(strstr(svg, "nan"));
                    assert_null(strstr(svg, "inf"));
                } else {
                    assert_string_equal(error.field, "the panel");
                    assert_null(svg);
                }
                free(svg);
            }
    imk_error error;
    char *svg = NULL;
    size_t size;
    const imk_panel none = {.title = "none"};
    CHECK_STATUS(imk_figure_svg(&(imk_figure){"", 1, 1, &none}, &svg, &size, &error),
                 IMK_ERROR_EMPTY);
    CHECK_STATUS(imk_figure_svg(&(imk_figure){"", 0, 1, &none}, &svg, &size, &error),
                 IMK_ERROR_EMPTY);
    assert_null(svg);
}

/* A region without an end ends with the frame. */
static void test_open_region(void **state)
{
    (void)state;
    const imk_region open[] = {{"open", 0, 1, HUGE_VAL, 0, 10, false, false},
                               {"closed", 0, 1, 2, 1, 2, false, false}};
    char *svg;
    size_t size;
    const imk_panel panel = {
        .x_logarithmic = true, .y_logarithmic = true, .region_count = 2, .regions = open};
    CHECK_OK(imk_figure_svg(&(imk_figure){"", 1, 1, &panel}, &svg, &size, NULL));
    const drawing *d = read_svg(svg, size, 1);
    const char *rectangle = strstr(svg, "fill-opacity=\"0.12\"");
    assert_non_null(rectangle);
    while (*rectangle != '<')
        rectangle--;
    double x, y, width, height;
    assert_int_equal(sscanf(rectangle, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &x,
                            &y, &width, &height),
                     4);
    CHECK_CLOSE(x + width, d->right, 1.1);
    CHECK_CLOSE(y + height, d->bottom, 1.1);
    free(svg);
}

/* ---- very many points ------------------------------------------------------------------------ */

enum { MANY = 1000000 };

/* A curve is less than a megabyte, a line along its axis less than a tenth, also where it goes to
 * and fro, or has a gap at each second point; and a single spike among a million points is as high
 * as it is. */
static void test_a_million_points(void **state)
{
    (void)state;
    double *x = malloc(MANY * sizeof *x), *y = malloc(MANY * sizeof *y);
    double *random = malloc(MANY * sizeof *random), *gaps = malloc(MANY * sizeof *gaps);
    assert_true(x && y && random && gaps);
    uint64_t n = 1;
    for (int i = 0; i < MANY; i++) {
        n = 16807 * n % 2147483647;
        x[i] = i;
        y[i] = (double)n / 2147483647;
        random[i] = (double)(48271 * n % 2147483647) / 2147483647;
        gaps[i] = i % 2 ? (double)NAN : random[i];
    }
    y[654321] = 3;
    static const size_t most[] = {100000, 500000, 100000, 100000, 100000, 500000};
    for (int style = IMK_CURVE_LINE; style <= IMK_CURVE_MARKS; style++) {
        const drawing *d = draw_curve((imk_curve_style)style, MANY, x, y, false);
        const double height = d->bottom - d->top;
        assert_true(last_size < most[style]);
        if (style != IMK_CURVE_MARKS)
            CHECK_CLOSE(d->highest, d->top + 0.07 / 1.14 * height, 1);
    }
    assert_true(draw_curve(IMK_CURVE_LINE, MANY, random, y, false)->vertices < 50000);
    assert_true(last_size < 500000);
    assert_true(draw_curve(IMK_CURVE_POINTS, MANY, random, y, false)->vertices < 50000);
    assert_true(last_size < 500000);
    draw_curve(IMK_CURVE_LINE, MANY, gaps, y, false);
    assert_true(last_size < 500000);
    draw_curve(IMK_CURVE_BAND, MANY, gaps, y, false);
    assert_true(last_size < 1000000); /* each slice has two ends */
    free(x);
    free(y);
    free(random);
    free(gaps);
}

/* ---- keys ------------------------------------------------------------------------------------ */

/* In the corner that is asked for while it is free, else where it hides nothing. */
static void test_key_keeps_clear(void **state)
{
    (void)state;
    static const double x[] = {0, 1, 2}, rising[] = {0, 1, 2}, falling[] = {2, 1, 0};
    imk_curve up[3], down[3];
    for (int c = 0; c < 3; c++) {
        up[c] = (imk_curve){"name", IMK_CURVE_LINE, c, 3, x, rising, NULL, NULL};
        down[c] = (imk_curve){"name", IMK_CURVE_LINE, c, 3, x, falling, NULL, NULL};
    }
    for (int place = IMK_KEY_UPPER; place <= IMK_KEY_LOWER; place++)
        for (int k = 0; k < 2; k++) {
            const imk_panel panel = {
                .curve_count = 3, .curves = k ? up : down, .key = (imk_key_place)place};
            const imk_panel two[] = {panel, panel};
            const drawing *d = draw(&(imk_figure){"", 2, 1, two});
            const label *name = find(d, "name");
            assert_non_null(name);
            const bool asked = (place == IMK_KEY_UPPER) == (k == 0);
            assert_int_equal(name->x > d->left + 0.5 * (d->right - d->left), asked);
        }
}

/* ---- the same everywhere --------------------------------------------------------------------- */

static void test_bytes_are_the_same(void **state)
{
    (void)state;
    static const char *const locales[] = {"C", "de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "C.UTF-8"};
    const imk_panel panel = everything(IMK_KEY_UPPER);
    const imk_figure figure = {"", 1, 1, &panel};
    char *first = NULL;
    size_t size;
    CHECK_OK(imk_figure_svg(&figure, &first, &size, NULL));
    for (size_t i = 0; i < sizeof locales / sizeof locales[0]; i++) {
        char *again = NULL;
        if (!setlocale(LC_ALL, locales[i]))
            continue;
        CHECK_OK(imk_figure_svg(&figure, &again, &size, NULL));
        setlocale(LC_ALL, "C");
        assert_string_equal(first, again);
        free(again);
    }
    free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_everything_is_drawn),
        cmocka_unit_test(test_names_off_lines),
        cmocka_unit_test(test_key_off_data),
        cmocka_unit_test(test_given_limits),
        cmocka_unit_test(test_size_is_that_of_old),
        cmocka_unit_test(test_long_texts),
        cmocka_unit_test(test_ticks_are_where_they_belong),
        cmocka_unit_test(test_labels),
        cmocka_unit_test(test_line_is_clipped),
        cmocka_unit_test(test_gaps),
        cmocka_unit_test(test_hard_numbers),
        cmocka_unit_test(test_open_region),
        cmocka_unit_test(test_a_million_points),
        cmocka_unit_test(test_key_keeps_clear),
        cmocka_unit_test(test_bytes_are_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
