/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of SI values as text or as a binary matrix.
 *
 * A log in deg/s should hold 0.1 where it was read from a log that says 0.1. The reader computes
 *
 *     value = scale * number + offset
 *
 * and the plain inverse, (value - offset) / scale, often misses the number by one unit in the last
 * place: 0.10000000000000002. So the number is rounded to decimals a little coarser than the SI
 * doubles are spaced, 10^-k >= ulp(value) / scale (ten times first, so that its product with 10^k
 * is rounded by less than one half), and taken when it reads back to the same value. Only + - * /
 * and conversion to integer are used: the bytes are the same everywhere. */
#include "log_formats_internal.h"

#include "imukit/decimal.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    POWERS = 23,    /* 10^22 is the last power of ten that is a double */
    TILE_ROWS = 32, /* 64 columns of them are 16 kB: stack, and first-level cache */
    LABEL_MAX = 300 /* bytes of a text that are written; less than IMK_DECIMAL_SIZE */
};

static const double power[POWERS] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                     1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* floor(log2 |value|) of a normal number; -1023 for zero and subnormal ones. */
static inline int binary_exponent(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (int)(bits >> 52 & 0x7FF) - 1023;
}

void imki_column_format_set(imki_column_format *column, double scale, double offset, int decimals)
{
    column->scale = scale;
    column->offset = offset;
    column->as_is = scale == 1.0 && offset == 0.0;
    column->origin = 0;
    column->fixed = imki_fixed_decimal_of(decimals);
    double spacing =
        0x1p-52; /* of the doubles at the exponent of entry i, which begins with 2^-64 */
    for (int i = 0; i < IMKI_EXPONENTS / 2; i++)
        spacing *= 0.5;
    for (int i = 0, k = POWERS - 1; i < IMKI_EXPONENTS; i++, spacing *= 2.0) {
        while (k >= 0 && power[k] * spacing > scale)
            k--;
        /* Still the first power: whether it is the largest is not known. */
        const bool largest = k < POWERS - 1 || power[k] * spacing * 10.0 > scale;
        column->fitting_decimals[i] = (int8_t)(largest ? k : -1);
    }
}

static inline bool reads_back(const imki_column_format *column, double number, double value)
{
    return column->scale * number + column->offset == value;
}

/* condition ? yes : no, without a branch */
static inline double either(bool condition, double yes, double no)
{
    uint64_t yes_bits, no_bits;
    memcpy(&yes_bits, &yes, sizeof yes_bits);
    memcpy(&no_bits, &no, sizeof no_bits);
    const uint64_t mask = (uint64_t)0 - (uint64_t)condition;
    const uint64_t bits = (yes_bits & mask) | (no_bits & ~mask);
    double result;
    memcpy(&result, &bits, sizeof result);
    return result;
}

/* The number rounded to `decimals` decimals, or NaN when it has too many digits for a double. */
static inline double rounded(double number, int decimals)
{
    const double scaled = number * power[decimals];
    if (!(scaled > -0x1p53 && scaled < 0x1p53))
        return (double)NAN;
    return (double)(int64_t)(scaled + copysign(0.5, scaled)) / power[decimals];
}

/* Any magnitude, through the text: for numbers outside the table. */
static double in_unit_slowly(const imki_column_format *column, double number, double value)
{
    char text[IMK_DECIMAL_SIZE];
    for (int digits = 15; digits <= 17; digits++) {
        double candidate;
        const size_t length = imk_decimal_significant(number, digits, text);
        imk_decimal_parse(text, text + length, &candidate);
        if (reads_back(column, candidate, value))
            return candidate;
    }
    return number;
}

double imki_log_in_unit(const imki_column_format *column, double value)
{
    if (column->as_is)
        return value;
    const double number = (value - column->offset) / column->scale;
    if (!(number - number == 0.0) || number == 0.0) /* not finite, or zero */
        return number;
    const int index = binary_exponent(value) + IMKI_EXPONENTS / 2;
    const int k = index >= 0 && index < IMKI_EXPONENTS ? column->fitting_decimals[index] : -1;
    if (k < 0)
        return in_unit_slowly(column, number, value);
    /* Which of the two reads back is a matter of luck, so no branch depends on it. */
    const double coarse = rounded(number, k > 0 ? k - 1 : 0), fine = rounded(number, k);
    const double second = either(reads_back(column, fine, value), fine, number);
    return either(reads_back(column, coarse, value), coarse, second);
}

/* Room for `needed` more bytes. */
static bool reserve(imki_log_bytes *bytes, size_t needed)
{
    if (bytes->capacity - bytes->size >= needed)
        return true;
    const size_t capacity = 2 * bytes->capacity + needed;
    char *grown = realloc(bytes->bytes, capacity);
    if (!grown) {
        bytes->failed = true;
        return false;
    }
    bytes->bytes = grown;
    bytes->capacity = capacity;
    return true;
}

/* Some rows in the units of their columns. They are converted before any is written as text, since
 * the branches of writing depend on the digits and cannot be predicted: each miss would wait for
 * the divisions of the conversion. */
typedef double tile[IMK_LOG_COLUMNS_MAX][TILE_ROWS];

static void convert(const imki_row_format *format, const double *const *columns, size_t first,
                    size_t count, tile numbers)
{
    for (size_t i = 0; i < format->column_count; i++) {
        const imki_column_format *column = &format->column[i];
        const double *values = columns[i] + first;
        if (column->as_is || column->label)
            memcpy(numbers[i], values, count * sizeof *values);
        else if (format->precision == IMK_LOG_FIXED)
            for (size_t row = 0; row < count; row++)
                numbers[i][row] = (values[row] - column->offset) / column->scale;
        else
            for (size_t row = 0; row < count; row++)
                numbers[i][row] = imki_log_in_unit(column, values[row]);
    }
}

static char *format_fixed_row(const imki_row_format *format, tile numbers, size_t row, char *at)
{
    for (size_t i = 0; i < format->column_count; i++) {
        at = imki_fixed_decimal_write(&format->column[i].fixed, numbers[i][row], at);
        *at++ = ',';
    }
    return at;
}

static char *format_shortest_row(const imki_row_format *format, tile numbers, size_t row, char *at)
{
    for (size_t i = 0; i < format->column_count; i++) {
        at += imk_decimal_shortest(numbers[i][row], at);
        *at++ = ',';
    }
    return at;
}

/* A text as a cell: in quotes when something in it would end the cell or begin a comment. */
static char *put_label(const char *text, char *at)
{
    const bool quoted = text[0] == '\0' || strpbrk(text, ",;\"# \t\r\n") != NULL;
    if (quoted)
        *at++ = '"';
    for (size_t i = 0; i < LABEL_MAX && text[i] != '\0'; i++) {
        const char c = text[i];
        *at++ = (char)(c == '"' ? '\'' : c == '\r' || c == '\n' ? ' ' : c);
    }
    if (quoted)
        *at++ = '"';
    return at;
}

/* Any row; the two above are for logs without texts and origins, which are nearly all. */
static char *format_labelled_row(const imki_row_format *format, tile numbers, size_t row, char *at)
{
    for (size_t i = 0; i < format->column_count; i++) {
        const imki_column_format *column = &format->column[i];
        const double number = numbers[i][row];
        const char *label = column->label && format->label && number >= 0.0 && number < 0x1p53
                                ? format->label(format->label_context, (size_t)number)
                                : NULL;
        if (label)
            at = put_label(label, at);
        else if (column->origin != 0 && fabs(number) < 0x1p53)
            at += sprintf(at, "%" PRId64, column->origin + (int64_t)llround(number));
        else if (format->precision == IMK_LOG_FIXED)
            at = imki_fixed_decimal_write(&column->fixed, number, at);
        else
            at += imk_decimal_shortest(number, at);
        *at++ = ',';
    }
    return at;
}

typedef char *row_function(const imki_row_format *format, tile numbers, size_t row, char *at);

void imki_log_format_text(const imki_row_format *format, const double *const *columns, size_t first,
                          size_t count, imki_log_bytes *bytes)
{
    const size_t longest = format->column_count * IMK_DECIMAL_SIZE; /* one row, commas included */
    row_function *format_row = format->label || format->has_origin  ? format_labelled_row
                               : format->precision == IMK_LOG_FIXED ? format_fixed_row
                                                                    : format_shortest_row;
    tile numbers;
    for (size_t done = 0; done < count; done += TILE_ROWS) {
        const size_t rows = count - done < TILE_ROWS ? count - done : TILE_ROWS;
        convert(format, columns, first + done, rows, numbers);
        for (size_t row = 0; row < rows; row++) {
            if (!reserve(bytes, longest))
                return;
            char *at = format_row(format, numbers, row, bytes->bytes + bytes->size);
            at[-1] = '\n';
            bytes->size = (size_t)(at - bytes->bytes);
        }
    }
}

/* Little-endian float64. */
static inline void store(char *at, double number)
{
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    for (int i = 0; i < 8; i++)
        at[i] = (char)(bits >> 8 * i);
#else
    memcpy(at, &number, sizeof number);
#endif
}

void imki_log_format_matrix(const imki_row_format *format, const double *const *columns,
                            size_t first, size_t count, imki_log_bytes *bytes)
{
    const size_t row_size = format->column_count * sizeof(double);
    if (!reserve(bytes, count * row_size))
        return;
    for (size_t i = 0; i < format->column_count; i++) {
        const imki_column_format *column = &format->column[i];
        const double *values = columns[i] + first;
        char *at = bytes->bytes + i * sizeof(double);
        if (column->as_is)
            for (size_t row = 0; row < count; row++)
                store(at + row * row_size, values[row]);
        else
            for (size_t row = 0; row < count; row++)
                store(at + row * row_size, imki_log_in_unit(column, values[row]));
    }
    bytes->size = count * row_size;
}

void imki_log_names_write(imk_output_file *file, size_t column_count, const imk_log_column *columns,
                          char separator)
{
    for (size_t i = 0; i < column_count; i++) {
        const char between[2] = {i > 0 ? separator : '\0', '\0'}, *unit = columns[i].unit.text;
        imk_output_file_print(file, unit[0] ? "%s%s [%s]" : "%s%s%s", between, columns[i].name,
                              unit);
    }
}
