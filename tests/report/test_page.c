/* SPDX-License-Identifier: Apache-2.0 */
/* HTML pages: escaping, structure, self-containedness, and that nothing appears on failure. */
#include "check.h"

#include "report/page_internal.h"

#include <stdlib.h>
#include <string.h>

static char *written(imki_page *page)
{
    char *text;
    size_t size;
    imk_error error;
    CHECK_OK(imki_page_take(page, &text, &size, &error));
    assert_int_equal(strlen(text), size);
    return text;
}

static size_t occurrences(const char *text, const char *part)
{
    size_t count = 0;
    for (const char *c = strstr(text, part); c; c = strstr(c + 1, part))
        count++;
    return count;
}

static void test_texts_are_escaped(void **state)
{
    (void)state;
    imki_page *page = imki_page_create("<b>&\"x\"", "sub", true);
    imki_page_heading(page, "a < b");
    imki_page_text(page, "<script>alert(1)</script>\x01");
    imki_page_verdict(page, 2, "5 > 4");
    imki_page_code(page, "key: <value> \xE2\x82\xAC \xF6");
    const char *cells[] = {"term", "x", "N", "<1 \xc2\xb1 2>"};
    imki_page_table(page, 2, 2, 2, cells);
    char *text = written(page);
    assert_non_null(strstr(text, "<title>&lt;b&gt;&amp;&quot;x&quot;</title>"));
    assert_non_null(strstr(text, "<h2>a &lt; b</h2>"));
    assert_non_null(strstr(text, "<p>&lt;script&gt;alert(1)&lt;/script&gt;</p>"));
    assert_non_null(strstr(text, "<p class=\"verdict warning\">5 &gt; 4</p>"));
    assert_non_null(
        strstr(text, "<pre tabindex=\"0\">key: &lt;value&gt; \xE2\x82\xAC \xEF\xBF\xBD</pre>"));
    assert_non_null(
        strstr(text, "<tr><th scope=\"col\">term</th><th scope=\"col\" class=\"right\">x"));
    assert_non_null(strstr(text, "<tr><th scope=\"row\">N</th>"
                                 "<td class=\"right\">&lt;1 \xc2\xb1 2&gt;</td></tr>"));
    assert_null(strstr(text, "<script>alert"));
    assert_string_equal(text + strlen(text) - 8, "</html>\n");
    free(text);
}

/* Two figures on a page: inline, without prologue, and with ids of their own. */
static void test_figures_are_inline(void **state)
{
    (void)state;
    double x[] = {1, 2, 3}, y[] = {1, 4, 9};
    imk_curve curve = {"squares", IMK_CURVE_POINTS, 0, 3, x, y, NULL, NULL};
    imk_panel panel = {"url(#x id=\"y", "x", "y",  false,         false, 1,
                       &curve,          0,   NULL, IMK_KEY_UPPER, NULL,  false};
    imk_figure figure = {"", 1, 1, &panel};
    imki_page *page = imki_page_create("t", "s", true);
    imki_page_figure(page, &figure, "first");
    imki_page_figure(page, &figure, "second");
    char *text = written(page);
    assert_int_equal(occurrences(text, "<svg xmlns"), 2);
    assert_int_equal(occurrences(text, "<?xml"), 0);
    const char *first = strstr(text, "<clipPath id=\""),
               *second = strstr(first + 1, "<clipPath id=");
    assert_memory_equal(first + 23, "-frame1\"", 8);
    assert_memory_not_equal(first, second, 23);
    assert_memory_equal(strstr(second, " clip-path=\"url(#") + 17, second + 14, 16);
    /* A text that looks like one is left as it is: as label, as title, and in the numbers. */
    assert_int_equal(occurrences(text, "url(#x id=&quot;y"), 4);
    assert_int_equal(occurrences(text, "url(#x id=\\\"y"), 2);
    assert_int_equal(occurrences(text, "<title>"), 1); /* the page's */
    /* Nothing is fetched: the only addresses are the names of XML vocabularies. */
    assert_int_equal(occurrences(text, "://"), occurrences(text, "http://www.w3.org/"));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texts_are_escaped),
        cmocka_unit_test(test_figures_are_inline),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
