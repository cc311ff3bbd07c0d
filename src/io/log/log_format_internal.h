/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of SI values as the bytes of a log: CSV text or a binary matrix. */
#ifndef IMUKIT_LOG_FORMAT_INTERNAL_H
#define IMUKIT_LOG_FORMAT_INTERNAL_H

#include "fixed_decimal_internal.h"
#include "imukit/log.h"

enum { IMKI_EXPONENTS = 128 }; /* binary exponents in the table below: -64 … 63 */

typedef struct imki_column_format {
    double scale, offset;     /* SI value = scale * value + offset */
    bool as_is;               /* scale 1, offset 0 */
    bool label;               /* the value is the index of a text */
    imki_fixed_decimal fixed; /* with IMK_LOG_FIXED */
    /* By the SI value's binary exponent: the largest k with 10^-k >= spacing of the doubles /
     * scale, so that numbers of k decimals are spaced about as the SI doubles; -1 outside 0 … 22.
     */
    int8_t fitting_decimals[IMKI_EXPONENTS];
    int64_t origin; /* added to whole numbers; 0: none */
} imki_column_format;

typedef struct imki_row_format {
    size_t column_count;
    imk_log_precision precision;
    imk_log_label_lookup label; /* NULL: the indices are written */
    void *label_context;
    bool has_origin; /* a column has one */
    imki_column_format column[IMK_LOG_COLUMNS_MAX];
} imki_row_format;

/* Bytes that grow; zero-initialised. Free with free(bytes). */
typedef struct imki_log_bytes {
    char *bytes;
    size_t size, capacity;
    bool failed; /* out of memory */
} imki_log_bytes;

/* Make a column ready. @param scale,offset  finite, scale > 0 */
void imki_column_format_set(imki_column_format *column, double scale, double offset, int decimals);

/* The number in the unit of a column that reads back to the SI value, scale * number + offset ==
 * value, and has few digits; the quotient where there is none with few digits. */
double imki_log_in_unit(const imki_column_format *column, double value);

/* Add rows first … first + count - 1 to the bytes: as CSV, or as float64, little-endian. */
void imki_log_format_text(const imki_row_format *format, const double *const *columns, size_t first,
                          size_t count, imki_log_bytes *bytes);
void imki_log_format_matrix(const imki_row_format *format, const double *const *columns,
                            size_t first, size_t count, imki_log_bytes *bytes);

#endif
