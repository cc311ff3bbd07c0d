/* SPDX-License-Identifier: Apache-2.0 */
/* One result as JSON, text and a page; and memory that fails anywhere. */
#include "check.h"

#include "imukit/model_file.h"
#include "imukit/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t calls, fail_at, pieces;

static void *failing(void *context, void *at, size_t size)
{
    (void)context;
    if (size == 0) {
        pieces -= at != NULL;
        free(at);
        return NULL;
    }
    if (++calls == fail_at)
        return NULL;
    pieces += at == NULL;
    return realloc(at, size);
}

static void put_data(imk_result *r)
{
    const double values[] = {1, (double)NAN, 1e-7};
    imk_result_text(r, "name", "a \"b\"\n\x01\xff");
    imk_result_object(r, "empty");
    imk_result_end(r);
    imk_result_array(r, "none");
    imk_result_end(r);
    imk_result_quantity(r, "bias", 0.1, "deg/h");
    imk_result_quantity(r, "bound", HUGE_VAL, "deg/h");
    imk_result_numbers(r, "values", 3, values);
    imk_result_object(r, "seven");
    for (int i = 0; i < 7; i++)
        imk_result_count(r, "k", i);
    imk_result_end(r);
    imk_result_array(r, "list");
    imk_result_object(r, NULL);
    imk_result_flag(r, "good", true);
    imk_result_null(r, "why");
    imk_result_text(r, "which", NULL);
    imk_result_end(r);
    imk_result_end(r);
}

static const char expected_json[] = "{\n"
                                    "  \"name\": \"a \\\"b\\\"\\n\\u0001\xEF\xBF\xBD\",\n"
                                    "  \"empty\": {},\n"
                                    "  \"none\": [],\n"
                                    "  \"bias\": {\"value\": 0.1, \"unit\": \"deg/h\"},\n"
                                    "  \"bound\": {\"value\": null, \"unit\": \"deg/h\"},\n"
                                    "  \"values\": [\n    1,\n    null,\n    1e-7\n  ],\n"
                                    "  \"seven\": {\n    \"k\": 0,\n    \"k\": 1,\n"
                                    "    \"k\": 2,\n    \"k\": 3,\n    \"k\": 4,\n    \"k\": 5,\n"
                                    "    \"k\": 6\n  },\n"
                                    "  \"list\": [\n    {\"good\": true, \"why\": null, "
                                    "\"which\": null}\n  ]\n}\n";

static void put_display(imk_result *r)
{
    const double x[] = {1, 2, 3}, y[] = {10, 20, 30};
    imk_result_title(r, "Title <1>", "%d channels", 3);
    imk_result_heading(r, "Head");
    imk_result_finding(r, 2, "A warning & more.");
    imk_result_for(r, IMK_FOR_PAGE);
    imk_result_line(r, "only %s", "on the page");
    imk_result_for(r, IMK_FOR_TERMINAL);
    imk_result_line(r, "only %s", "on the terminal");
    imk_result_gap(r);
    imk_result_for(r, IMK_FOR_BOTH);
    imk_table *table = imk_result_table(r, 2);
    imk_table_row(table, "tau\t%s", "value");
    imk_table_row(table, "\xC2\xB5s");
    imk_table_add(table, "%d\t%s", 7, "more\x1b\t[0m");
    imk_table_row(table, "\t\tend");
    (void)imk_result_table(r, 0); /* without rows: nothing */
    imk_figure_builder *figure = imk_result_figure(r, "figure", 1, "Caption");
    imk_figure_panel(figure, &(imk_panel){.title = "p", .x_label = "x", .y_label = "y"});
    imk_figure_curve(figure, &(imk_curve){"c", IMK_CURVE_LINE, 0, 3, x, y, NULL, NULL}, 10);
    imk_figure_curve(figure, &(imk_curve){.label = "points"}, 1);
    for (int i = 0; i < 5; i++)
        imk_figure_point(figure, i, 2 * i);
    imk_figure_curve(figure, &(imk_curve){.label = "bars"}, 1);
    for (int i = 0; i < 5; i++)
        imk_figure_bar(figure, i, 2 * i, 2 * i - 1, 2 * i + 1);
    imk_figure_region(figure, &(imk_region){"r", 1, 0, 1, 0, 1, false, true});
}

static const char expected_text[] = "Head\nA warning & more.\nonly on the terminal\n\n"
                                    "tau  value\n"
                                    "\xC2\xB5s       7  more??[0m\n"
                                    "            end\n";

static void test_json(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_result *r = imk_result_create(NULL);
    put_data(r);
    assert_int_equal(imk_result_to_json(r, &text, &size), IMK_OK);
    assert_string_equal(text, expected_json);
    assert_int_equal(size, strlen(text));
    free(text);
    imk_result_free(r);
}

/* Data that was JSON is data like other, can be looked up, and is told from other data. */
static void test_read(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_result *r = imk_result_create(NULL);
    assert_true(imk_result_json(
        r, "z",
        "{\"b\": [{\"c\": \"\\u00B5 \\\"1\\\"\"}, 8, -1.5e-7, 1e20], \"a\": {\"n\": null, "
        "\"t\": true, \"r\": 0.1}, \"e\": []}"));
    assert_false(imk_result_json(r, "y", "{\"b\": "));
    imk_result_number(r, "x", 2);
    assert_string_equal(imk_result_find(r, "z.b[0].c"), "\xC2\xB5 \"1\"");
    assert_null(imk_result_find(r, "z.b[1]"));
    assert_null(imk_result_find(r, "z.b[9]"));
    assert_null(imk_result_find(r, "z.b[0].c.d"));
    assert_null(imk_result_find(r, "z.aa.n"));
    assert_int_equal(imk_result_to_key(r, &text, &size), IMK_OK);
    assert_string_equal(text, "{\"x\":2.0,\"y\":null,\"z\":{\"a\":{\"n\":null,\"r\":"
                              "0.10000000000000001,\"t\":true},\"b\":[{\"c\":\"\xC2\xB5 "
                              "\\\"1\\\"\"},8,-1.4999999999999999e-7,1e20],\"e\":[]}}");
    assert_int_equal(size, strlen(text));
    free(text);
    imk_result_free(r);
}

static void test_text(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_result *r = imk_result_create(NULL);
    put_display(r);
    assert_int_equal(imk_result_to_text(r, NULL, NULL, &text, &size), IMK_OK);
    assert_string_equal(text, expected_text);
    free(text);
    assert_int_equal(imk_result_to_text(r, "<", ">", &text, &size), IMK_OK);
    assert_non_null(strstr(text, "\n<tau  value>\n"));
    free(text);
    imk_result_free(r);
}

/* The judgement comes first everywhere, wherever it was made. */
static void test_judgement(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_error error;
    imk_result *r = imk_result_create(NULL);
    imk_result_line(r, "first");
    imk_result_object(r, "result");
    imk_result_judge(r, IMK_USABLE_WITH_CARE, "Usable with care: %d < 3\x1b.", 2);
    imk_result_end(r);
    assert_int_equal(imk_result_to_text(r, NULL, NULL, &text, &size), IMK_OK);
    assert_string_equal(text, "Usable with care: 2 < 3?.\n\nfirst\n");
    free(text);
    assert_int_equal(imk_result_to_page(r, &text, &size, &error), IMK_OK);
    const char *judgement = strstr(text, "<p class=\"judgement care\">Usable with care: 2 &lt; 3");
    assert_non_null(judgement);
    assert_true(judgement < strstr(text, "<p>first"));
    free(text);
    assert_string_equal(imk_result_find(r, "result.usability.grade"), "usable with care");
    imk_result_free(r);
    imk_result_judge(NULL, IMK_USABLE, "Usable.");
}

/* Names of strangers are no commands to a terminal; what stands out is marked. */
static void test_line(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_result *r = imk_result_create(NULL);
    imk_result_line(r, "%s: " IMK_BOLD "good" IMK_PLAIN ", \xC2\xB5\n", "a\x1b[2J\xff");
    imk_result_gap(r);
    imk_result_for(r, IMK_FOR_PAGE);
    imk_result_gap(r);
    assert_int_equal(imk_result_to_text(r, NULL, NULL, &text, &size), IMK_OK);
    assert_string_equal(text, "a?[2J?: good, \xC2\xB5\n\n\n");
    free(text);
    assert_int_equal(imk_result_to_text(r, "<", ">", &text, &size), IMK_OK);
    assert_string_equal(text, "a?[2J?: <good>, \xC2\xB5\n\n\n");
    free(text);
    imk_result_free(r);
}

static void test_key(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_result *r = imk_result_create(NULL);
    for (int i = 0; i < 2; i++)
        imk_result_count(r, imk_result_key(r, "sigma[%d]", i), i);
    assert_int_equal(imk_result_to_json(r, &text, &size), IMK_OK);
    assert_string_equal(text, "{\"sigma[0]\": 0, \"sigma[1]\": 1}\n");
    free(text);
    imk_result_free(r);
}

static void test_figure(void **state)
{
    (void)state;
    imk_result *r = imk_result_create(NULL);
    imk_result_for(r, IMK_FOR_PLOT);
    assert_non_null(imk_result_figure(r, "plot", 1, ""));
    imk_result_for(r, IMK_FOR_BOTH);
    put_display(r);
    assert_non_null(imk_result_figure_get(r, IMK_FOR_PLOT, 0));
    assert_null(imk_result_figure_get(r, IMK_FOR_PLOT, 1));
    const imk_figure *figure = imk_result_figure_get(r, IMK_FOR_PAGE, 0);
    assert_non_null(figure);
    assert_int_equal(figure->panel_count, 1);
    assert_int_equal(figure->panels[0].curve_count, 3);
    assert_true(figure->panels[0].curves[0].x[2] == 3);
    assert_true(figure->panels[0].curves[0].y[2] == 3); /* 30 by the scale of 10 */
    assert_null(figure->panels[0].curves[0].lower);
    const imk_curve *points = &figure->panels[0].curves[1], *bars = &figure->panels[0].curves[2];
    assert_int_equal(points->count, 5);
    assert_true(points->x[4] == 4 && points->y[3] == 6);
    assert_null(points->lower);
    assert_int_equal(bars->count, 5);
    assert_true(bars->y[0] == 0 && bars->lower[2] == 3 && bars->upper[4] == 9);
    assert_string_equal(figure->panels[0].regions[0].label, "r");
    assert_null(imk_result_figure_get(r, IMK_FOR_PAGE, 1));
    imk_result_free(r);
}

static void test_page(void **state)
{
    (void)state;
    char *text;
    size_t size;
    imk_error error;
    imk_result *r = imk_result_create(NULL);
    imk_result_title(r, "Title <1>", "%d channels", 3);
    imk_result_line(r, "one");
    imk_result_gap(r);
    imk_result_for(r, IMK_FOR_TERMINAL);
    imk_result_line(r, "two");
    assert_int_equal(imk_result_to_page(r, &text, &size, &error), IMK_OK);
    assert_non_null(strstr(text, "<h1>Title &lt;1&gt;</h1>"));
    const char *article = strstr(text, "<article"), *end = strstr(text, "<footer");
    assert_non_null(strstr(text, "<p>one</p>\n</article>\n<footer"));
    assert_null(strstr(article, "<p>two"));
    assert_null(strstr(text, "<p></p>"));
    char *fragment;
    assert_int_equal(imk_result_to_fragment(r, &fragment, &size, &error), IMK_OK);
    assert_int_equal(size, end - article);
    assert_memory_equal(fragment, article, size);
    free(fragment);
    free(text);
    imk_result_free(r);
}

/* Wherever memory fails, the renderers say so, and nothing is lost. */
static void test_memory(void **state)
{
    (void)state;
    const imk_allocator allocator = {failing, NULL};
    bool whole = false;
    for (fail_at = 1; !whole; fail_at++) {
        char *text = NULL;
        size_t size;
        calls = 0;
        imk_result *r = imk_result_create(&allocator);
        put_data(r);
        for (int i = 0; i < 300; i++)
            put_display(r);
        const bool failed = calls >= fail_at;
        assert_int_equal(imk_result_to_json(r, &text, &size), failed ? IMK_ERROR_MEMORY : IMK_OK);
        free(text);
        whole = !failed;
        imk_result_free(r);
        assert_int_equal(pieces, 0);
    }
    assert_true(fail_at > 3);
}

/* What renderers need beside the result fails: nothing is handed over, and nothing is freed twice.
 */
static void test_memory_of_renderers(void **state)
{
    (void)state;
    const imk_allocator allocator = {failing, NULL};
    fail_at = 0;
    imk_result *r = imk_result_create(&allocator);
    put_display(r);
    fail_at = calls + 1;
    char *text = NULL;
    size_t size = 0;
    imk_error error;
    assert_int_equal(imk_result_to_page(r, &text, &size, &error), IMK_ERROR_MEMORY);
    assert_null(text);
    fail_at = calls + 1;
    assert_int_equal(imk_result_to_text(r, NULL, NULL, &text, &size), IMK_ERROR_MEMORY);
    assert_null(text);
    imk_result_free(r);
    assert_int_equal(pieces, 0);
}

static void test_readable(void **state)
{
    (void)state;
    char text[40];
    imk_readable_value(1.23456, 0.012, 3, text, sizeof text);
    assert_string_equal(text, "1.235");
    imk_readable_value(-0.0001, 0.1, 3, text, sizeof text);
    assert_string_equal(text, "0.00");
    imk_readable_value((double)NAN, 0, 3, text, sizeof text);
    assert_string_equal(text, "-");
    imk_readable_duration(10000, text, sizeof text);
    assert_string_equal(text, "2 h 46 min 40 s");
    imk_readable_duration(12.5, text, sizeof text);
    assert_string_equal(text, "12.5 s");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_json),      cmocka_unit_test(test_text),
        cmocka_unit_test(test_judgement), cmocka_unit_test(test_line),
        cmocka_unit_test(test_figure),    cmocka_unit_test(test_key),
        cmocka_unit_test(test_page),      cmocka_unit_test(test_read),
        cmocka_unit_test(test_memory),    cmocka_unit_test(test_memory_of_renderers),
        cmocka_unit_test(test_readable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
