/* SPDX-License-Identifier: Apache-2.0 */
/** @file decimal.h
 *  Exact conversion between decimal text and double: no locale, no allocation, no libm. */
#ifndef IMUKIT_DECIMAL_H
#define IMUKIT_DECIMAL_H

#include "imukit/status.h"

IMK_BEGIN_C

/** Longest text imk_decimal_shortest() or imk_decimal_fixed() writes, with its terminating zero. */
#define IMK_DECIMAL_SIZE 384

/** Read a decimal number: [+-] digits [. digits] [e [+-] digits], or nan, inf, infinity in any
 *  case.
 *
 *  The value is the nearest double, ties to even, bit-equal to strtod() in the C locale on every
 *  input (hexadecimal is not read). Short decimals take a fast path, others Eisel-Lemire
 *  [LEMIRE2021], the few it cannot decide an exact comparison by big integers.
 *
 *  @param begin,end  the text; no terminating zero needed, nothing is read at or beyond end
 *  @param value      untouched when there is no number
 *  @return the first character after the number; begin when there is none */
IMK_API const char *imk_decimal_parse(const char *begin, const char *end, double *value);

/** Write the shortest decimal that reads back to the same double; of those, the nearest to it.
 *  1e-5 <= |x| < 1e16 is written without exponent ("0.1", "100"); others like "1.5e-7"; "nan",
 *  "inf", "-inf", and "-0" for negative zero.
 *  @return length without the terminating zero, at most 24 */
IMK_API size_t imk_decimal_shortest(double value, char *text);

/** Write with a fixed number of decimals (0 … 17), rounded exactly, ties to even: the text printf's
 *  "%.*f" gives. @return length without the terminating zero, at most IMK_DECIMAL_SIZE - 1 */
IMK_API size_t imk_decimal_fixed(double value, int decimals, char *text);

/** Write with a number of significant digits (1 … 17), as printf's "%.*g".
 *  @return length without the terminating zero, at most 24 */
IMK_API size_t imk_decimal_significant(double value, int digits, char *text);

IMK_END_C
#endif
