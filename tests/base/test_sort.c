/* SPDX-License-Identifier: Apache-2.0 */
/* Sorted like the C library's qsort, whatever the order before: also the orders for which quicksort
 * takes the square of the count, so that a long array of them ends in time only by heapsort. */
#include "check.h"

#include "base/sort_internal.h"

#include <string.h>

enum { MOST = 3000, ORDERS = 6, LONG = 400000 };

static double x[LONG], expected[MOST];
static uint64_t state;

static uint64_t next(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return state >> 33;
}

static int compare(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static double value_of(int order, size_t i, size_t n)
{
    switch (order) {
    case 0:
        return (double)i;
    case 1:
        return -(double)i;
    case 2:
        return (double)(i < n / 2 ? i : n - i); /* an organ pipe */
    case 3:
        return (double)(next() % 3); /* few different values */
    case 4:
        return 1;
    default:
        return (double)next() - 1e9;
    }
}

static void test_orders(void **context)
{
    (void)context;
    for (size_t n = 0; n <= MOST; n += n < 70 ? 1 : 293)
        for (int order = 0; order < ORDERS; order++) {
            for (size_t i = 0; i < n; i++)
                x[i] = expected[i] = value_of(order, i, n);
            imki_sort(x, n);
            qsort(expected, n, sizeof *expected, compare);
            assert_memory_equal(x, expected, n * sizeof *x);
        }
}

/* The order of [MUSSER1997] that makes the median of first, middle and last the smallest but one
 * each time. */
static void test_worst_order(void **context)
{
    (void)context;
    for (size_t i = 0; i < LONG / 2; i++) {
        x[i] = (double)(i % 2 == 0 ? i + 1 : LONG / 2 + i + (LONG / 2) % 2);
        x[LONG / 2 + i] = (double)(2 * (i + 1));
    }
    imki_sort(x, LONG);
    for (size_t i = 1; i < LONG; i++)
        assert_true(x[i - 1] <= x[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orders),
        cmocka_unit_test(test_worst_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
