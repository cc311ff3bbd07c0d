/* SPDX-License-Identifier: Apache-2.0 */
/* UTF-8: every character there is, what is none, and texts made of both. */
#include "check.h"

#include "imukit/utf8.h"

#include <stdbool.h>
#include <string.h>

/* The encoding of a code point [RFC3629, 3]. @return its length */
static size_t encode(unsigned long point, char text[5])
{
    unsigned char *c = (unsigned char *)text;
    const size_t length = point < 0x80 ? 1 : point < 0x800 ? 2 : point < 0x10000 ? 3 : 4;
    static const unsigned char first[] = {0, 0, 0xC0, 0xE0, 0xF0};
    for (size_t i = length - 1; i > 0; i--, point >>= 6)
        c[i] = (unsigned char)(0x80 | (point & 0x3F));
    c[0] = (unsigned char)(first[length] | point);
    c[length] = '\0';
    return length;
}

static void every_character(void **state)
{
    (void)state;
    char text[5], cut[5];
    for (unsigned long point = 1; point < 0x120000; point++) {
        const size_t length = encode(point, text);
        const bool valid = point < 0x110000 && (point < 0xD800 || point > 0xDFFF);
        assert_int_equal(imk_utf8_length(text), valid ? length : 0);
        const bool control = point < 0x20 || (point >= 0x7F && point < 0xA0);
        assert_int_equal(imk_utf8_printable(text), valid && !control ? length : 0);
        strcpy(cut, text);
        cut[length - 1] = '\0';
        assert_int_equal(imk_utf8_length(cut), 0); /* cut short, or empty */
    }
}

/* Overlong forms, lone continuation bytes, and bytes that never occur [RFC3629, 3, 10]. */
static void no_characters(void **state)
{
    (void)state;
    static const char *const texts[] = {"",
                                        "\x80",
                                        "\xBF",
                                        "\xC0\x80",
                                        "\xC1\xBF",
                                        "\xE0\x9F\xBF",
                                        "\xF0\x8F\xBF\xBF",
                                        "\xF5\x80\x80\x80",
                                        "\xFE",
                                        "\xFF",
                                        "\xC3",
                                        "\xC3(",
                                        "\xE2\x82(",
                                        "\xED\xA0\x80"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        assert_int_equal(imk_utf8_length(texts[i]) + imk_utf8_printable(texts[i]), 0);
}

#define REPLACED IMK_UTF8_REPLACEMENT

static void clean_texts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *clean;
    } cases[] = {{"", ""},
                 {"log.csv", "log.csv"},
                 {"gr\xC3\xB6\xC3\x9F"
                  "e \xE2\x82\xAC \xF0\x9F\x98\x80", /* size, euro, a face */
                  "gr\xC3\xB6\xC3\x9F"
                  "e \xE2\x82\xAC \xF0\x9F\x98\x80"},
                 {"l\xF6g", "l" REPLACED "g"},
                 {"\xFF\xFE", REPLACED REPLACED},
                 {"\xE2\x82", REPLACED REPLACED},
                 {"\xC3", REPLACED}};
    char clean[80];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const size_t whole = strlen(cases[i].clean);
        assert_int_equal(imk_utf8_clean(cases[i].text, NULL, 0), whole);
        assert_int_equal(imk_utf8_clean(cases[i].text, clean, sizeof clean), whole);
        assert_string_equal(clean, cases[i].clean);
        for (size_t size = 1; size <= whole + 1; size++) { /* cut, but never a character */
            memset(clean, 'x', sizeof clean);
            assert_int_equal(imk_utf8_clean(cases[i].text, clean, size), whole);
            assert_true(strlen(clean) < size);
            assert_true(strlen(clean) == whole || strlen(clean) + 4 >= size);
            assert_memory_equal(clean, cases[i].clean, strlen(clean));
            for (const char *c = clean; *c; c += imk_utf8_length(c))
                assert_true(imk_utf8_length(c) > 0);
            assert_int_equal(clean[size], 'x');
        }
    }
}

/* The middle goes, between characters, and more of the end stays. */
static void shortened_texts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *shortened;
        size_t size;
    } cases[] = {{"", "", 1},
                 {"/logs/one.csv", "/logs/one.csv", 14},
                 {"/logs/one.csv", "/lo\xE2\x80\xA6ne.csv", 13},
                 {"/logs/one.csv", "\xE2\x80\xA6v", 5},
                 {"/logs/one.csv", "", 4},
                 {"/logs/one.csv", "", 1},
                 {"\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6\xC3\xB6",
                  "\xC3\xB6\xE2\x80\xA6\xC3\xB6\xC3\xB6", 10}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char target[20];
        memset(target, 'x', sizeof target);
        imk_utf8_shorten(cases[i].text, target, cases[i].size);
        assert_string_equal(target, cases[i].shortened);
        assert_int_equal(target[cases[i].size], 'x');
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_character),
        cmocka_unit_test(no_characters),
        cmocka_unit_test(clean_texts),
        cmocka_unit_test(shortened_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
