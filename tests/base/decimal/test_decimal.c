/* SPDX-License-Identifier: Apache-2.0 */
/* Decimal numbers: reading equals the C library's strtod() bit for bit, writing equals its printf()
 * byte for byte (glibc's are exact), and the shortest form meets its definition. */
#include "check.h"

#include "imukit/decimal.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t random_state = 20240607;

/* SplitMix64: any generator will do here. */
static uint64_t random_bits(void)
{
    uint64_t z = random_state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Every finite bit pattern is equally likely. */
static double random_double(void)
{
    double value;
    do
        value = double_of(random_bits());
    while (!isfinite(value));
    return value;
}

/* As sensor logs hold them: up to 17 decimals, up to six digits before the point. */
static double random_plain(void)
{
    const double scale[7] = {1e-3, 1e-2, 1e-1, 1.0, 1e2, 1e4, 1e6};
    const double unit = (double)(random_bits() >> 11) * 0x1p-53 - 0.5;
    return unit * scale[random_bits() % 7];
}

/* ---------------------------------------------------------------------------------- reading */

static void check_parse(const char *text)
{
    const size_t length = strlen(text);
    char *end;
    const double expected = strtod(text, &end);
    double value = 7.0;
    const char *after = imk_decimal_parse(text, text + length, &value);
    if (after != end || (end != text && bits_of(value) != bits_of(expected))) {
        print_error("\"%.60s\": %a after %td characters, strtod %a after %td\n", text, value,
                    after - text, expected, end - text);
        fail();
    }
    if (end == text)
        assert_true(value == 7.0);
}

static void parse_reads_what_strtod_reads(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "0",
        "-0",
        "+0",
        "0.0",
        "-.0",
        "0.",
        ".5",
        "+.5",
        "5.",
        "1",
        "-1",
        "00001",
        "1e0",
        "1E5",
        "1e",
        "1e+",
        "1e-",
        "1e+x",
        "1.e3",
        ".e3",
        ".",
        "",
        "-",
        "+",
        "+-1",
        "e5",
        "x",
        ",",
        "1,2",
        "1.2.3",
        "nan",
        "NaN",
        "-nan",
        "inf",
        "INF",
        "-Infinity",
        "infinit",
        "infx",
        "na",
        "1 2",
        "1e22",
        "1e23",
        "1e-22",
        "9007199254740993",
        "9007199254740993e1",
        "90071992547409930e-1",
        "9007199254740992.5",
        "9007199254740993.0000000000000000000000000000000001",
        "0.1",
        "0.3",
        "2.2250738585072011e-308",
        "2.2250738585072012e-308",
        "2.2250738585072014e-308",
        "4.9e-324",
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "2.47e-324",
        "1e-400",
        "-1e-400",
        "1e400",
        "-1e400",
        "1.7976931348623157e308",
        "1.7976931348623158e308",
        "1.7976931348623159e308",
        "1.8e308",
        "179769313486231580793728971405301e276",
        "1e308",
        "1e309",
        "1e-999999999999999999999",
        "1e999999999999999999999",
        "0e999999999999999999999",
        "123456789012345678901234567890",
        "0.000000000000000000000000000000000000000123456789012345678901234567890",
        "18446744073709551615",
        "18446744073709551616",
        "9999999999999999999",
        "9999999999999999999e-342",
        "1e-342",
        "1e-343",
        "99999999999999999999e-343",
        "6929495644600919.5",
        "6929495644600920.5",
        "3.5e15",
        "8.5e-1"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        check_parse(texts[i]);
}

static void parse_stops_at_the_end_given(void **state)
{
    (void)state;
    /* The byte at `end` is never part of the number, whatever it is. */
    double value = 0.0;
    const char text[] = "1234.5678e+12";
    for (size_t length = 0; length < sizeof text; length++) {
        char copy[sizeof text] = "";
        memcpy(copy, text, length);
        char *end;
        const double expected = strtod(copy, &end);
        const char *after = imk_decimal_parse(text, text + length, &value);
        assert_int_equal(after - text, end - copy);
        if (length > 0)
            assert_true(value == expected);
    }
}

static void parse_reads_random_doubles(void **state)
{
    (void)state;
    char text[64];
    for (int i = 0; i < 150000; i++) {
        snprintf(text, sizeof text, "%.*e", 14 + i % 8, random_double());
        check_parse(text);
        snprintf(text, sizeof text, "%.*f", i % 19, random_plain());
        check_parse(text);
    }
}

static void parse_reads_random_digits(void **state)
{
    (void)state;
    for (int i = 0; i < 100000; i++) {
        char text[96];
        const int length = 1 + (int)(random_bits() % 45), point = (int)(random_bits() % 50);
        int at = 0;
        for (int digit = 0; digit < length; digit++) {
            if (digit == point)
                text[at++] = '.';
            text[at++] = (char)('0' + (random_bits() % 3 == 0 ? 0 : random_bits() % 10));
        }
        snprintf(text + at, sizeof text - (size_t)at, "e%d", (int)(random_bits() % 700) - 350);
        check_parse(text);
    }
}

/* Exactly half way between two doubles, and one unit of the last digit beside it. printf() writes
 * the exact digits of the midpoint m as m = x + ulp/2, which a long double of 64 bits holds. */
static void parse_decides_ties(void **state)
{
    (void)state;
    if (sizeof(long double) == sizeof(double))
        skip();
    static char text[1400];
    for (int i = 0; i < 4000; i++) {
        const double x = fabs(random_double());
        const double next = nextafter(x, (double)INFINITY);
        if (!isfinite(next))
            continue;
        const long double middle = ((long double)x + (long double)next) / 2.0L;
        int length = snprintf(text, sizeof text, "%.*Le", 780, middle);
        check_parse(text);
        char *exponent = strchr(text, 'e');
        char tail[16];
        strcpy(tail, exponent);
        strcpy(exponent, "0000000000000000000000000000000000000001");
        strcat(text, tail);
        check_parse(text);
        /* One less: the last of the zeros before it becomes nines. */
        length = snprintf(text, sizeof text, "%.*Le", 780, middle);
        for (char *p = text + length; p > text; p--) {
            if (*p < '0' || *p > '9' || strchr(p, 'e'))
                continue;
            if (*p != '0') {
                --*p;
                break;
            }
            *p = '9';
        }
        check_parse(text);
    }
}

static void parse_reads_long_texts(void **state)
{
    (void)state;
    const size_t size = 100000;
    char *text = malloc(size + 40);
    assert_non_null(text);
    memset(text, '0', size);
    strcpy(text + size, "123e-5");
    check_parse(text);
    text[1] = '.';
    strcpy(text + size, "123e100000");
    check_parse(text);
    memset(text, '7', size);
    strcpy(text + size, "e-100000");
    check_parse(text);
    /* 1 + 2^-53 is a tie with 53 decimals; then 99 940 zeros and a one. */
    memset(text, '0', size);
    memcpy(text, "1.00000000000000011102230246251565404236316680908203125", 55);
    text[size] = '\0';
    check_parse(text);
    strcpy(text + size, "1");
    check_parse(text);
    free(text);
}

/* ---------------------------------------------------------------------------------- writing */

static void check_fixed(double value, int decimals)
{
    char text[IMK_DECIMAL_SIZE], expected[400];
    const size_t length = imk_decimal_fixed(value, decimals, text);
    snprintf(expected, sizeof expected, "%.*f", decimals, value);
    if (strcmp(text, expected) != 0 || length != strlen(expected)) {
        print_error("%a with %d decimals: %s, printf %s\n", value, decimals, text, expected);
        fail();
    }
}

static void check_significant(double value, int digits)
{
    char text[IMK_DECIMAL_SIZE], expected[400];
    const size_t length = imk_decimal_significant(value, digits, text);
    snprintf(expected, sizeof expected, "%.*g", digits, value);
    if (strcmp(text, expected) != 0 || length != strlen(expected) || length > 24) {
        print_error("%a with %d digits: %s, printf %s\n", value, digits, text, expected);
        fail();
    }
}

static const double edge_values[] = {0.0,
                                     -0.0,
                                     1.0,
                                     -1.0,
                                     0.5,
                                     1.5,
                                     2.5,
                                     0.125,
                                     0.375,
                                     9.5,
                                     10.5,
                                     0.05,
                                     0.25,
                                     0.75,
                                     9.995,
                                     99.5,
                                     999999.5,
                                     0.1,
                                     0.3,
                                     1e15,
                                     9007199254740991.0,
                                     9007199254740992.0,
                                     9007199254740994.0,
                                     1e16,
                                     1e17,
                                     9999999999999998.0,
                                     123456789012345680.0,
                                     1e22,
                                     1e23,
                                     1e100,
                                     1.7976931348623157e308,
                                     -1.7976931348623157e308,
                                     2.2250738585072014e-308,
                                     2.2250738585072009e-308,
                                     4.9406564584124654e-324,
                                     1e-5,
                                     9.9999999999999991e-6,
                                     1e-4,
                                     0.00001234,
                                     4503599627370496.5,
                                     4503599627370497.5,
                                     2251799813685248.25,
                                     1e21,
                                     25.0,
                                     35.0,
                                     1e-17,
                                     5e-18,
                                     0.99999999999999989,
                                     9.9999999999999982,
                                     5e-324,
                                     1e-300,
                                     67108864.0,
                                     33554432.0};
enum { EDGE_COUNT = sizeof edge_values / sizeof edge_values[0] };

static void fixed_and_significant_equal_printf(void **state)
{
    (void)state;
    for (int i = 0; i < EDGE_COUNT; i++)
        for (int digits = 0; digits <= 17; digits++) {
            check_fixed(edge_values[i], digits);
            if (digits > 0)
                check_significant(edge_values[i], digits);
        }
    for (int i = 0; i < 200000; i++) {
        check_fixed(random_plain(), i % 18);
        check_significant(random_plain(), 1 + i % 17);
    }
    for (int i = 0; i < 60000; i++) {
        const double value = random_double();
        check_significant(value, 1 + i % 17);
        if (i % 8 == 0)
            check_fixed(value, i / 8 % 18);
    }
}

/* Values with few bits behind the point lie half way between decimals often. */
static void fixed_and_significant_round_ties_to_even(void **state)
{
    (void)state;
    int ties = 0;
    for (int i = 0; i < 100000; i++) {
        const int bits = 1 + (int)(random_bits() % 12);
        const double value = ldexp((double)(random_bits() % 200000), -bits);
        ties += fmod(ldexp(value, bits), 2.0) == 1.0;
        check_fixed(value, bits - 1);
        check_significant(value, 1 + (int)(random_bits() % 12));
        check_significant(floor(value) * 5.0, 1 + (int)(random_bits() % 5));
    }
    assert_true(ties > 40000);
}

static void not_finite_has_a_name(void **state)
{
    (void)state;
    char text[IMK_DECIMAL_SIZE];
    assert_int_equal(imk_decimal_shortest((double)NAN, text), 3);
    assert_string_equal(text, "nan");
    imk_decimal_fixed((double)INFINITY, 3, text);
    assert_string_equal(text, "inf");
    imk_decimal_significant(-(double)INFINITY, 3, text);
    assert_string_equal(text, "-inf");
}

/* Significant digits of a text without zeros at either end, and the power of ten of the last. */
static int significant_digits(const char *text, char *digits, int *exponent)
{
    int count = 0, last = 0;
    bool point = false;
    *exponent = 0;
    for (; *text && *text != 'e'; text++) {
        if (*text == '.') {
            point = true;
        } else if (*text != '-') {
            *exponent -= point;
            if (count > 0 || *text != '0')
                digits[count++] = *text;
            if (*text != '0')
                last = count;
        }
    }
    *exponent += count - last + (*text == 'e' ? atoi(text + 1) : 0);
    digits[last] = '\0';
    return last;
}

/* The definition of imk_decimal_shortest(), by other means: strtod() reads the text back to the
 * value; printf() with one digit less, rounded to nearest, and its two neighbours, do not read back
 * to it; and printf() with as many digits (the nearest such decimal) is the same text, or does not
 * read back. */
static void check_shortest(double value)
{
    char text[IMK_DECIMAL_SIZE], digits[32], other[64], nearest[32];
    int exponent, nearest_exponent;
    const size_t length = imk_decimal_shortest(value, text);
    assert_int_equal(length, strlen(text));
    assert_true(length <= 24);
    if (bits_of(strtod(text, NULL)) != bits_of(value)) {
        print_error("%a: %s does not read back\n", value, text);
        fail();
    }
    if (value == 0.0)
        return;
    const int count = significant_digits(text, digits, &exponent);
    snprintf(other, sizeof other, "%.*e", count - 1, value);
    significant_digits(other, nearest, &nearest_exponent);
    if (strtod(other, NULL) == value &&
        (strcmp(nearest, digits) != 0 || nearest_exponent != exponent)) {
        print_error("%a: %s is nearer than %s\n", value, other, text);
        fail();
    }
    if (count == 1)
        return;
    snprintf(other, sizeof other, "%.*e", count - 2, value);
    const int shorter = significant_digits(other, nearest, &nearest_exponent);
    /* Back to count - 1 digits, then the neighbours on both sides. */
    long long number = atoll(nearest);
    for (int i = shorter; i < count - 1; i++, nearest_exponent--)
        number *= 10;
    for (long long step = -1; step <= 1; step++) {
        snprintf(other, sizeof other, "%llde%d", number + step, nearest_exponent);
        if (strtod(other, NULL) == fabs(value)) {
            print_error("%a: %s is shorter than %s\n", value, other, text);
            fail();
        }
    }
}

static void shortest_meets_its_definition(void **state)
{
    (void)state;
    for (int i = 0; i < EDGE_COUNT; i++)
        check_shortest(edge_values[i]);
    /* Every power of two and its neighbours: there the interval is lopsided. */
    for (int exponent = -1074; exponent <= 1023; exponent++) {
        const double power = ldexp(1.0, exponent);
        check_shortest(power);
        check_shortest(nextafter(power, 0.0));
        check_shortest(-nextafter(power, (double)INFINITY) * (exponent < 1023 ? 1.0 : 0.5));
    }
    char text[16];
    for (int exponent = -323; exponent <= 308; exponent++) {
        snprintf(text, sizeof text, "1e%d", exponent);
        const double power = strtod(text, NULL);
        check_shortest(power);
        check_shortest(nextafter(power, 0.0));
        check_shortest(nextafter(power, 1e308));
    }
    for (int i = 0; i < 120000; i++) {
        check_shortest(random_double());
        check_shortest(random_plain());
        check_shortest((double)(int)(random_bits() % 2000001 - 1000000) / 1000.0);
    }
}

static void shortest_has_the_form_documented(void **state)
{
    (void)state;
    const struct {
        double value;
        const char *text;
    } cases[] = {{0.0, "0"},
                 {-0.0, "-0"},
                 {1.0, "1"},
                 {100.0, "100"},
                 {-0.1, "-0.1"},
                 {9.80665, "9.80665"},
                 {1e-5, "0.00001"},
                 {1.5e-7, "1.5e-7"},
                 {9.9e-6, "9.9e-6"},
                 {1e15, "1000000000000000"},
                 {1e16, "1e16"},
                 {1.25e300, "1.25e300"},
                 {5e-324, "5e-324"},
                 {9007199254740993.0, "9007199254740992"},
                 {1234567890123456.0, "1234567890123456"},
                 {2e-100, "2e-100"},
                 {1.7976931348623157e308, "1.7976931348623157e308"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[IMK_DECIMAL_SIZE];
        imk_decimal_shortest(cases[i].value, text);
        assert_string_equal(text, cases[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parse_reads_what_strtod_reads),
        cmocka_unit_test(parse_stops_at_the_end_given),
        cmocka_unit_test(parse_reads_random_doubles),
        cmocka_unit_test(parse_reads_random_digits),
        cmocka_unit_test(parse_decides_ties),
        cmocka_unit_test(parse_reads_long_texts),
        cmocka_unit_test(fixed_and_significant_equal_printf),
        cmocka_unit_test(fixed_and_significant_round_ties_to_even),
        cmocka_unit_test(not_finite_has_a_name),
        cmocka_unit_test(shortest_meets_its_definition),
        cmocka_unit_test(shortest_has_the_form_documented),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
