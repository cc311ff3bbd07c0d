/* SPDX-License-Identifier: Apache-2.0 */
/* The elementary functions against the C library's long double ones. Where long double has 64 bits
 * of significand (x87) or 113 (AArch64), those are at least 500 times as accurate as a double can
 * hold, so they serve as exact values. Limits are those of elementary.h. */
#include "check.h"

#include "base/distributions/gamma_internal.h"
#include "base/sine_internal.h"
#include "imukit/elementary.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
enum { POINTS = 50000 };
#else
enum { POINTS = 350000 };
#endif

typedef double function(double x);
typedef long double exact_function(long double x);
typedef double argument(double uniform, double other_uniform);

/* Uniform in [0, 1): the high bits of a multiplicative congruential sequence [STEELE2022], good
 * enough to choose points. */
static double uniform(uint64_t *state)
{
    *state = *state * UINT64_C(0xd1342543de82ef95) + 1;
    return (double)(*state >> 11) * 0x1p-53;
}

/* Error in units of the last place of the exact value. */
static double error_ulp(double actual, long double exact)
{
    const double nearest = (double)exact;
    if (isinf(nearest) || isinf(actual))
        return actual == nearest ? 0.0 : (double)INFINITY;
    int exponent;
    frexp(nearest, &exponent);
    if (nearest == 0.0 || exponent < DBL_MIN_EXP)
        exponent = DBL_MIN_EXP;
    return (double)fabsl(((long double)actual - exact) / ldexpl(1.0L, exponent - DBL_MANT_DIG));
}

static void check_function(function *f, exact_function *exact, argument *point, double limit,
                           const char *name)
{
    if (LDBL_MANT_DIG < 64) {
        print_message("long double is double here: no oracle\n");
        skip();
    }
    double worst = 0.0, where = 0.0;
    uint64_t state = 1;
    for (int i = 0; i < POINTS; i++) {
        const double first = uniform(&state);
        const double x = point(first, uniform(&state));
        const double error = error_ulp(f(x), exact((long double)x));
        if (!(error <= worst)) {
            worst = error;
            where = x;
        }
    }
    if (!(worst <= limit)) {
        print_error("%s(%a) is off by %.3f ulp, limit %.3f\n", name, where, worst, limit);
        fail();
    }
}

static double whole_range(double u, double v)
{
    (void)v;
    return -745.0 + u * (745.0 + 709.78);
}

static double around_zero(double u, double v)
{
    (void)v;
    return 4.0 * u - 2.0;
}

static double every_size(double u, double v)
{
    return (v < 0.5 ? -1.0 : 1.0) * exp(-70.0 * u);
}

static void exp_is_accurate(void **state)
{
    (void)state;
    /* Rounded twice where the result is subnormal. */
    check_function(imk_exp, expl, whole_range, 1.0, "exp");
    check_function(imk_exp, expl, around_zero, 0.7, "exp");
    check_function(imk_exp, expl, every_size, 0.7, "exp");
}

static void exp_at_its_ends(void **state)
{
    (void)state;
    assert_true(imk_exp(0.0) == 1.0 && imk_exp(-0.0) == 1.0);
    assert_true(imk_exp((double)INFINITY) == (double)INFINITY);
    assert_true(imk_exp(-(double)INFINITY) == 0.0);
    assert_true(isnan(imk_exp((double)NAN)));
    assert_true(imk_exp(1000.0) == (double)INFINITY && imk_exp(DBL_MAX) == (double)INFINITY);
    assert_true(imk_exp(-1000.0) == 0.0 && imk_exp(-DBL_MAX) == 0.0);
    /* The largest argument with a finite result, and the next one. */
    const double last = 0x1.62e42fefa39efp+9;
    CHECK_BELOW(error_ulp(imk_exp(last), expl((long double)last)), 0.7);
    assert_true(imk_exp(nextafter(last, 1e4)) == (double)INFINITY);
    /* e^-745.13 is 1.004 of half the smallest subnormal, e^-745.14 less than half of it. */
    assert_true(imk_exp(-745.13) == 0x1p-1074 && imk_exp(-745.14) == 0.0);
}

static void expm1_is_accurate(void **state)
{
    (void)state;
    check_function(imk_expm1, expm1l, whole_range, 1.1, "expm1");
    check_function(imk_expm1, expm1l, around_zero, 1.1, "expm1");
    check_function(imk_expm1, expm1l, every_size, 1.1, "expm1");
}

static void expm1_at_its_ends(void **state)
{
    (void)state;
    assert_true(imk_expm1(0.0) == 0.0 && signbit(imk_expm1(-0.0)));
    assert_true(imk_expm1(0x1p-1074) == 0x1p-1074 && imk_expm1(-0x1p-60) == -0x1p-60);
    assert_true(imk_expm1((double)INFINITY) == (double)INFINITY);
    assert_true(imk_expm1(-(double)INFINITY) == -1.0 && imk_expm1(-50.0) == -1.0);
    assert_true(imk_expm1(709.8) == (double)INFINITY);
    assert_true(isnan(imk_expm1((double)NAN)));
    /* Where the formulas change. */
    const double seams[] = {40.0, -40.0, 0x1p-54, 0.34657359027997264, -0.34657359027997264};
    for (size_t i = 0; i < sizeof seams / sizeof *seams; i++) {
        const double near[] = {nextafter(seams[i], -1e3), seams[i], nextafter(seams[i], 1e3)};
        for (int j = 0; j < 3; j++)
            CHECK_BELOW(error_ulp(imk_expm1(near[j]), expm1l((long double)near[j])), 1.1);
    }
}

static double any_positive(double u, double v)
{
    return exp(-744.0 + u * (744.0 + 709.0)) * (1.0 + v);
}

static double one_octave(double u, double v)
{
    (void)v;
    return 0.5 + 1.5 * u;
}

static double around_one(double u, double v)
{
    return 1.0 + every_size(u, v) * 0.4;
}

static void log_is_accurate(void **state)
{
    (void)state;
    check_function(imk_ln, logl, any_positive, 0.95, "log");
    check_function(imk_ln, logl, one_octave, 0.95, "log");
    check_function(imk_ln, logl, around_one, 0.95, "log");
}

static void log_at_its_ends(void **state)
{
    (void)state;
    assert_true(imk_ln(1.0) == 0.0 && !signbit(imk_ln(1.0)));
    assert_true(imk_ln(0.0) == -(double)INFINITY && imk_ln(-0.0) == -(double)INFINITY);
    assert_true(imk_ln((double)INFINITY) == (double)INFINITY);
    assert_true(isnan(imk_ln(-1.0)) && isnan(imk_ln(-(double)INFINITY)));
    assert_true(isnan(imk_ln((double)NAN)));
    const double points[] = {0x1p-1074, 0x1.8p-1073,          DBL_MIN,
                             DBL_MAX,   0x1.fffffffffffffp-1, 0x1.0000000000001p+0,
                             2.0,       0x1.6a09e667f3bcdp-1, 0x1.6a09e667f3bccp-1};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        CHECK_BELOW(error_ulp(imk_ln(points[i]), logl((long double)points[i])), 0.95);
}

static double above_minus_one(double u, double v)
{
    return expm1(60.0 * u - 20.0) * (v < 0.5 ? 1.0 : 0.5);
}

static void log1p_is_accurate(void **state)
{
    (void)state;
    check_function(imk_ln1p, log1pl, above_minus_one, 2.0, "log1p");
    check_function(imk_ln1p, log1pl, around_zero, 2.0, "log1p");
    check_function(imk_ln1p, log1pl, every_size, 2.0, "log1p");
}

static void log1p_at_its_ends(void **state)
{
    (void)state;
    assert_true(imk_ln1p(0.0) == 0.0 && signbit(imk_ln1p(-0.0)));
    assert_true(imk_ln1p(0x1p-1074) == 0x1p-1074 && imk_ln1p(-0x1p-60) == -0x1p-60);
    assert_true(imk_ln1p(-1.0) == -(double)INFINITY && isnan(imk_ln1p(-1.5)));
    assert_true(imk_ln1p((double)INFINITY) == (double)INFINITY && isnan(imk_ln1p((double)NAN)));
    CHECK_BELOW(error_ulp(imk_ln1p(DBL_MAX), log1pl((long double)DBL_MAX)), 2.0);
    CHECK_BELOW(error_ulp(imk_ln1p(-0x1.fffffffffffffp-1), log1pl(-0x1.fffffffffffffp-1L)), 2.0);
}

static double in_the_tail(double u, double v)
{
    (void)v;
    return 32.0 * u - 6.0;
}

/* Beyond 26.5 the results are subnormal, and rounded twice. */
static void error_functions_are_accurate(void **state)
{
    (void)state;
    check_function(imki_erf, erfl, around_zero, 2.5, "erf");
    check_function(imki_erf, erfl, every_size, 2.5, "erf");
    check_function(imki_erfc, erfcl, around_zero, 4.0, "erfc");
    check_function(imki_erfc, erfcl, in_the_tail, 4.0, "erfc");
    assert_true(imki_erfc(30.0) == 0.0 && imki_erfc(-30.0) == 2.0 && imki_erfc(0.0) == 1.0);
    assert_true(imki_erfc((double)INFINITY) == 0.0 && imki_erf(-(double)INFINITY) == -1.0);
    assert_true(isnan(imki_erf((double)NAN)) && isnan(imki_erfc((double)NAN)));
}

static double few_turns(double u, double v)
{
    (void)v;
    return 20.0 * u - 10.0;
}

static double many_turns(double u, double v)
{
    (void)v;
    return 2e5 * u - 1e5;
}

/* Doubles next to multiples of pi/2, where the reduction cancels most. */
static double near_quarter_turn(double u, double v)
{
    (void)v;
    return (double)(floorl((long double)u * 63661.0L) * 1.57079632679489661923L);
}

static void sin_and_cos_are_accurate(void **state)
{
    (void)state;
    argument *const points[] = {every_size, few_turns, many_turns, near_quarter_turn};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        check_function(imk_sin, sinl, points[i], 0.85, "sin");
        check_function(imk_cos, cosl, points[i], 0.85, "cos");
    }
}

static void sin_and_cos_of_large_arguments(void **state)
{
    (void)state;
    if (LDBL_MANT_DIG < 64)
        skip();
    const double ends[] = {1e6, 1.7e6, 1e9, 1e12, 1e15};
    uint64_t seed = 2;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        for (int j = 0; j < POINTS / 10; j++) {
            const double x = ends[i] * (2.0 * uniform(&seed) - 1.0);
            const double tolerance = fabs(x) <= 1e9 ? 1e-16 : 1e-15;
            const long double s = sinl((long double)x), c = cosl((long double)x);
            if (fabs(x) > 1e9 || error_ulp(imk_sin(x), s) > 2.0)
                CHECK_BELOW((double)fabsl((long double)imk_sin(x) - s), tolerance);
            if (fabs(x) > 1e9 || error_ulp(imk_cos(x), c) > 2.0)
                CHECK_BELOW((double)fabsl((long double)imk_cos(x) - c), tolerance);
        }
}

static void sin_and_cos_at_their_ends(void **state)
{
    (void)state;
    assert_true(imk_sin(0.0) == 0.0 && signbit(imk_sin(-0.0)));
    assert_true(imk_cos(0.0) == 1.0 && imk_cos(-0.0) == 1.0);
    assert_true(imk_sin(0x1p-1074) == 0x1p-1074);
    assert_true(imk_sin(-0.5) == -imk_sin(0.5) && imk_cos(-0.5) == imk_cos(0.5));
    assert_true(imk_sin(-1e3) == -imk_sin(1e3) && imk_cos(-1e3) == imk_cos(1e3));
    const double outside[] = {1.0000001e15, -1e300, (double)INFINITY, -(double)INFINITY,
                              (double)NAN};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++)
        assert_true(isnan(imk_sin(outside[i])) && isnan(imk_cos(outside[i])));
}

/* The bits of the results, whatever the compiler and the machine: FNV-1a of the values on a grid.
 * The expected values were made by this library once and are its promise; that they are right is
 * what the other tests say. */
static uint64_t fingerprint(function *f, double first, double step)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (int i = 0; i < 20000; i++) {
        const double value = f(first + i * step);
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        for (int shift = 0; shift < 64; shift += 8)
            hash = (hash ^ (bits >> shift & 0xff)) * UINT64_C(0x100000001b3);
    }
    return hash;
}

static void bits_never_change(void **state)
{
    (void)state;
    assert_int_equal(fingerprint(imk_exp, -746.0, 0.0728), UINT64_C(0x01d3d7c56d737b3b));
    assert_int_equal(fingerprint(imk_expm1, -41.0, 0.0043), UINT64_C(0x795d0dadf90d6945));
    assert_int_equal(fingerprint(imk_ln, 1e-3, 1.7e-3), UINT64_C(0x46b6a5e60513aa19));
    assert_int_equal(fingerprint(imk_ln1p, -0.99, 1.7e-3), UINT64_C(0xe19aa3178cca19a5));
    assert_int_equal(fingerprint(imki_erf, -6.0, 6e-4), UINT64_C(0x5eefa5a424cc2345));
    assert_int_equal(fingerprint(imki_erfc, -6.0, 1.7e-3), UINT64_C(0x179d4f6cb4ee8319));
    assert_int_equal(fingerprint(imk_sin, -2e3, 0.21), UINT64_C(0xd647e9ec9174d7c1));
    assert_int_equal(fingerprint(imk_cos, -2e7, 2e3 + 0.1), UINT64_C(0xf8888a8a9030c2a9));
}

static void check_both(double x)
{
    double value[2];
    const double expected[2] = {imk_sin(x), imk_cos(x)};
    imki_sine_and_cosine(x, &value[0], &value[1]);
    assert_memory_equal(value, expected, sizeof value);
}

/* Over the circle, where a function takes another way or changes its sign, and close to 0. */
static void both_at_once_have_the_same_bits(void **state)
{
    (void)state;
    const double pi = 3.141592653589793;
    static const double edge[] = {0.785,
                                  0.7853981633974483,
                                  1.5707963267948966,
                                  2.356194490192345,
                                  3.141592653589793,
                                  0x1p-27,
                                  0x1p-26,
                                  0x1p-64,
                                  0x1p-62};
    for (int i = -100000; i <= 100000; i++)
        check_both(pi * 1e-5 * i);
    for (double x = 1.0; x > 0x1p-65; x *= 0.99) {
        check_both(x);
        check_both(-x);
    }
    for (size_t i = 0; i < sizeof edge / sizeof edge[0]; i++)
        for (int side = -1; side <= 1; side++) {
            double x = side == 0 ? edge[i] : nextafter(edge[i], side * 4.0);
            check_both(x < pi ? x : pi);
            check_both(x < pi ? -x : -pi);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp_is_accurate),
        cmocka_unit_test(exp_at_its_ends),
        cmocka_unit_test(expm1_is_accurate),
        cmocka_unit_test(expm1_at_its_ends),
        cmocka_unit_test(log_is_accurate),
        cmocka_unit_test(log_at_its_ends),
        cmocka_unit_test(log1p_is_accurate),
        cmocka_unit_test(log1p_at_its_ends),
        cmocka_unit_test(error_functions_are_accurate),
        cmocka_unit_test(sin_and_cos_are_accurate),
        cmocka_unit_test(sin_and_cos_of_large_arguments),
        cmocka_unit_test(sin_and_cos_at_their_ends),
        cmocka_unit_test(bits_never_change),
        cmocka_unit_test(both_at_once_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
