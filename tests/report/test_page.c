/* SPDX-License-Identifier: Apache-2.0 */
/* HTML pages: escaping, structure, self-containedness, and that nothing appears on failure. */
#include "check.h"

#include "report/page_internal.h"

#include <math.h>
#include <stdio.h>
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
    imk_panel panel = {"url(#x id=\"y", "x",  "y",   false, false, 1, &curve, 0, NULL,
                       IMK_KEY_UPPER,   NULL, false, 0,     0};
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

/* ---- the security policy --------------------------------------------------------------------- */

static uint32_t turned(uint32_t word, int bits)
{
    return word >> bits | word << (32 - bits);
}

/* The first 32 bits of the fractional part of a root of a prime, as SHA-256 has them. */
static uint32_t fraction(double root)
{
    return (uint32_t)((root - floor(root)) * 4294967296.0);
}

/* SHA-256 [FIPS180-4]; its constants are computed from their definition. */
static void sha256(const char *text, size_t size, unsigned char digest[32])
{
    uint32_t constant[64], state[8];
    for (uint32_t prime = 2, found = 0; found < 64; prime++) {
        bool divided = false;
        for (uint32_t d = 2; d * d <= prime; d++)
            divided = divided || prime % d == 0;
        if (divided)
            continue;
        if (found < 8)
            state[found] = fraction(sqrt(prime));
        constant[found++] = fraction(cbrt(prime));
    }
    const size_t blocks = (size + 9 + 63) / 64;
    unsigned char *padded = calloc(blocks, 64);
    memcpy(padded, text, size);
    padded[size] = 0x80;
    for (int i = 0; i < 8; i++)
        padded[64 * blocks - 1 - (size_t)i] = (unsigned char)(8 * (uint64_t)size >> 8 * i);
    for (size_t b = 0; b < blocks; b++) {
        uint32_t w[64], v[8];
        memcpy(v, state, sizeof v);
        for (size_t i = 0; i < 16; i++) {
            const unsigned char *c = padded + 64 * b + 4 * i;
            w[i] = (uint32_t)c[0] << 24 | (uint32_t)c[1] << 16 | (uint32_t)c[2] << 8 | c[3];
        }
        for (int i = 16; i < 64; i++)
            w[i] = w[i - 16] + w[i - 7] +
                   (turned(w[i - 15], 7) ^ turned(w[i - 15], 18) ^ w[i - 15] >> 3) +
                   (turned(w[i - 2], 17) ^ turned(w[i - 2], 19) ^ w[i - 2] >> 10);
        for (int i = 0; i < 64; i++) {
            const uint32_t one = v[7] + (turned(v[4], 6) ^ turned(v[4], 11) ^ turned(v[4], 25)) +
                                 ((v[4] & v[5]) ^ (~v[4] & v[6])) + constant[i] + w[i];
            const uint32_t two = (turned(v[0], 2) ^ turned(v[0], 13) ^ turned(v[0], 22)) +
                                 ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
            memmove(v + 1, v, 7 * sizeof *v);
            v[4] += one;
            v[0] = one + two;
        }
        for (int i = 0; i < 8; i++)
            state[i] += v[i];
    }
    free(padded);
    for (int i = 0; i < 32; i++)
        digest[i] = (unsigned char)(state[i / 4] >> (24 - 8 * (i % 4)));
}

/* The script is named by its hash, and is the only one that runs; all else is forbidden. */
static void test_policy(void **state)
{
    (void)state;
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = written(imki_page_create("t", "s", true));
    const char *script = strstr(text, "<script>") + 8, *end = strstr(script, "</script>");
    unsigned char digest[34] = {0};
    char policy[300], hash[45];
    sha256("abc", 3, digest);
    assert_memory_equal(digest, "\xba\x78\x16\xbf\x8f\x01\xcf\xea", 8); /* its example B.1 */
    sha256(script, (size_t)(end - script), digest);
    for (size_t i = 0; i < 43; i++) {
        const size_t bit = 6 * i;
        const unsigned pair = (unsigned)digest[bit / 8] << 8 | digest[bit / 8 + 1];
        hash[i] = letters[pair >> (10 - bit % 8) & 63];
    }
    hash[43] = '=';
    hash[44] = '\0';
    snprintf(policy, sizeof policy,
             "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
             "style-src 'unsafe-inline'; script-src 'sha256-%s'; img-src data:; "
             "base-uri 'none'; form-action 'none'\">",
             hash);
    assert_non_null(strstr(text, policy));
    assert_int_equal(occurrences(text, "<script"), 1);
    assert_string_equal(end, "</script>\n</body>\n</html>\n");
    /* The policy stands before what it governs. */
    assert_true(strstr(text, policy) < strstr(text, "<style>"));
    /* Styles and scripts name no address, and take nothing from elsewhere. */
    assert_int_equal(occurrences(text, "url("), 0);
    assert_int_equal(occurrences(text, "@import"), 0);
    assert_int_equal(occurrences(text, "fetch("), 0);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texts_are_escaped),
        cmocka_unit_test(test_figures_are_inline),
        cmocka_unit_test(test_policy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
