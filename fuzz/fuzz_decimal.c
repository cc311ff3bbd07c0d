/* SPDX-License-Identifier: Apache-2.0 */
/* libFuzzer entry: imk_decimal_parse() against strtod(), and what is written reads back.
 * Reads: src/base/decimal/decimal_parse.c src/base/decimal/decimal_format.c
 * src/base/decimal/decimal_big.c */
#include "harness.h"

#include "imukit/decimal.h"

#include <stdlib.h>
#include <string.h>

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* strtod() also reads leading blanks, hexadecimal numbers and nan(...). */
static int is_ours(const char *text)
{
    return strspn(text, " \t\n\v\f\r") == 0 && !strpbrk(text, "xX(");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    double value = 0.0;
    const char *after = imk_decimal_parse(text, text + size, &value);
    if (is_ours(text)) {
        char *end;
        const double expected = strtod(text, &end);
        if (end != after || (end != text && bits_of(value) != bits_of(expected)))
            abort();
    }
    if (after != text && value == value) {
        char written[IMK_DECIMAL_SIZE];
        double back = 0.0;
        size_t length = imk_decimal_shortest(value, written);
        if (length > 24 ||
            imk_decimal_parse(written, written + length, &back) != written + length ||
            bits_of(back) != bits_of(value))
            abort();
        length = imk_decimal_significant(value, 17, written);
        if (length > 24 ||
            imk_decimal_parse(written, written + length, &back) != written + length ||
            bits_of(back) != bits_of(value))
            abort();
        length = imk_decimal_fixed(value, (int)(size % 18), written);
        if (length >= IMK_DECIMAL_SIZE || strlen(written) != length)
            abort();
    }
    free(text);
    return 0;
}
