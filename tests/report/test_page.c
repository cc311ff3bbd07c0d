/* SPDX-License-Identifier: Apache-2.0 */
/* HTML pages: escaping, structure, self-containedness, and that nothing appears on failure. */
#define _POSIX_C_SOURCE 200809L
#include "check.h"

#include "imukit/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *written(imk_page *page)
{
    char path[] = "/tmp/imukit-page-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    imk_error error;
    CHECK_OK(imk_page_write(page, path, &error));
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    unlink(path);
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
    imk_page *page = imk_page_create("<b>&\"x\"", "sub");
    imk_page_heading(page, "a < b");
    imk_page_text(page, "<script>alert(1)</script>\x01");
    imk_page_verdict(page, 2, "5 > 4");
    imk_page_code(page, "key: <value> \xE2\x82\xAC \xF6");
    const char *cells[] = {"term", "x", "N", "<1 \xc2\xb1 2>"};
    imk_page_table(page, 2, 2, cells);
    char *text = written(page);
    assert_non_null(strstr(text, "<title>&lt;b&gt;&amp;&quot;x&quot;</title>"));
    assert_non_null(strstr(text, "<h2>a &lt; b</h2>"));
    assert_non_null(strstr(text, "<p>&lt;script&gt;alert(1)&lt;/script&gt;</p>"));
    assert_non_null(strstr(text, "<p class=\"verdict warning\">5 &gt; 4</p>"));
    assert_non_null(strstr(text, "<pre>key: &lt;value&gt; \xE2\x82\xAC \xEF\xBF\xBD</pre>"));
    assert_non_null(strstr(text, "<tr><th>term</th><th>x</th></tr>"));
    assert_non_null(strstr(text, "<tr><td>N</td><td>&lt;1 \xc2\xb1 2&gt;</td></tr>"));
    assert_null(strstr(text, "<script"));
    assert_string_equal(text + strlen(text) - 8, "</html>\n");
    free(text);
}

/* Two figures on a page: inline, without prologue, and with ids of their own. */
static void test_figures_are_inline(void **state)
{
    (void)state;
    double x[] = {1, 2, 3}, y[] = {1, 4, 9};
    imk_curve curve = {"squares", IMK_CURVE_POINTS, 0, 3, x, y, NULL, NULL};
    imk_panel panel = {"url(#x id=\"y", "x", "y", false, false, 1, &curve, 0, NULL, IMK_KEY_UPPER};
    imk_figure figure = {"", 1, 1, &panel};
    imk_page *page = imk_page_create("t", "s");
    imk_page_figure(page, &figure, "first");
    imk_page_figure(page, &figure, "second");
    char *text = written(page);
    assert_int_equal(occurrences(text, "<svg"), 2);
    assert_int_equal(occurrences(text, "<?xml"), 0);
    assert_int_equal(occurrences(text, "id=\"f1-frame1\""), 1);
    assert_int_equal(occurrences(text, "\"url(#f1-frame1)\""), 1);
    assert_int_equal(occurrences(text, "id=\"f2-frame1\""), 1);
    assert_int_equal(occurrences(text, "\"url(#f2-frame1)\""), 1);
    /* A text that looks like one is left as it is: as label and as title of both. */
    assert_int_equal(occurrences(text, "url(#x id=&quot;y"), 4);
    assert_int_equal(occurrences(text, "<title>"), 1); /* the page's */
    /* Nothing is fetched: the only addresses are the names of XML vocabularies. */
    assert_int_equal(occurrences(text, "http"), occurrences(text, "http://www.w3.org/"));
    free(text);
}

static void test_unwritable_page(void **state)
{
    (void)state;
    imk_error error;
    CHECK_STATUS(imk_page_write(imk_page_create("t", "s"), "/nonexistent/page.html", &error),
                 IMK_ERROR_OPEN);
    CHECK_STATUS(imk_page_write(imk_page_create("t", "s"), "/dev/full", &error), IMK_ERROR_WRITE);
    CHECK_OK(imk_page_write(imk_page_create("t", "s"), NULL, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texts_are_escaped),
        cmocka_unit_test(test_figures_are_inline),
        cmocka_unit_test(test_unwritable_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
