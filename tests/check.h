/* SPDX-License-Identifier: Apache-2.0 */
/* Checks of numbers for cmocka tests. A failing check prints both values, the difference and the
 * tolerance with file and line. NaN never passes, and a NaN tolerance never passes. */
#ifndef IMUKIT_TESTS_CHECK_H
#define IMUKIT_TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "imukit/status.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static inline void check_close(double actual, double expected, double tolerance, const char *text,
                               const char *file, int line)
{
    /* Equal infinities are close; their difference is not a number. */
    const double difference = actual == expected ? 0.0 : fabs(actual - expected);
    if (!(difference <= tolerance)) {
        print_error("%s is %.17g, expected %.17g: off by %.3g, tolerance %.3g\n", text, actual,
                    expected, difference, tolerance);
        _fail(file, line);
    }
}

static inline void check_relative(double actual, double expected, double tolerance,
                                  const char *text, const char *file, int line)
{
    const double difference = actual == expected ? 0.0 : fabs(actual - expected);
    if (!(difference <= tolerance * fabs(expected))) {
        print_error("%s is %.17g, expected %.17g: relative error %.3g, tolerance %.3g\n", text,
                    actual, expected, difference / fabs(expected), tolerance);
        _fail(file, line);
    }
}

static inline void check_below(double actual, double limit, const char *text, const char *file,
                               int line)
{
    if (!(actual <= limit)) {
        print_error("%s is %.17g, expected at most %.17g\n", text, actual, limit);
        _fail(file, line);
    }
}

static inline void check_status(imk_status actual, imk_status expected, const char *text,
                                const char *file, int line)
{
    if (actual != expected) {
        print_error("%s is %s, expected %s\n", text, imk_status_name(actual),
                    imk_status_name(expected));
        _fail(file, line);
    }
}

/** Repetitions of a statistical test whose limits follow from their number: `full`, or that divided
 *  by IMUKIT_TEST_RUNS where the environment sets it (under sanitizers, which look for other
 *  mistakes than of statistics), at least 8. */
static inline uint32_t check_runs(uint32_t full)
{
    const char *text = getenv("IMUKIT_TEST_RUNS");
    const long divisor = text ? strtol(text, NULL, 10) : 1;
    const uint32_t runs = divisor > 1 ? full / (uint32_t)divisor : full;
    return runs > 8 ? runs : 8;
}

/** Whether a part will do of what is costly, because the statistics are others' (see above). */
static inline bool check_quick(void)
{
    return getenv("IMUKIT_TEST_RUNS") != NULL;
}

/** Whether case number i of many alike is left out there: all but one in n. The usual build runs
 *  them all. */
static inline bool check_skips(size_t i, size_t n)
{
    return check_quick() && i % n != 0;
}

/** |actual - expected| <= tolerance */
#define CHECK_CLOSE(actual, expected, tolerance)                                                   \
    check_close((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)

/** |actual - expected| <= tolerance |expected| */
#define CHECK_RELATIVE(actual, expected, tolerance)                                                \
    check_relative((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)

/** actual <= limit */
#define CHECK_BELOW(actual, limit) check_below((actual), (limit), #actual, __FILE__, __LINE__)

/** A call returns this status. */
#define CHECK_STATUS(actual, expected)                                                             \
    check_status((actual), (expected), #actual, __FILE__, __LINE__)

/** A call returns IMK_OK. */
#define CHECK_OK(actual) check_status((actual), IMK_OK, #actual, __FILE__, __LINE__)

#endif
