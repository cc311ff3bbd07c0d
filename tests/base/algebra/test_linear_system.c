/* SPDX-License-Identifier: Apache-2.0 */
/* Exact discretisation of linear systems, and Bessel functions. */
#define _XOPEN_SOURCE 700 /* jn() */
#include "check.h"

#include "base/algebra/linear_system_internal.h"
#include "base/distributions/bessel_internal.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* x'' + (w/Q) x' + w^2 x = u in its natural units, 15 kHz: e^{Ah} in closed form. */
static void closed_form(double w, double q, double h, double phi[4])
{
    const double decay = w / (2.0 * q), wd = sqrt(w * w - decay * decay);
    const double e = exp(-decay * h), c = cos(wd * h), s = sin(wd * h);
    phi[0] = e * (c + decay / wd * s);
    phi[1] = e * s / wd;
    phi[2] = -e * w * w / wd * s;
    phi[3] = e * (c - decay / wd * s);
}

static void a_resonator_is_its_closed_form(void **state)
{
    (void)state;
    const double w = 2.0 * 3.14159265358979324 * 15000.0;
    for (double q = 0.7; q < 1e8; q *= 10.0)
        for (double h = 1e-7; h < 1e-2; h *= 3.7) {
            const double a[4] = {0.0, 1.0, -w * w, -w / q}, units[4] = {1.0, 1.0 / w, w, 1.0};
            double phi[4], expected[4];
            imki_exponential(2, a, h, phi);
            closed_form(w, q, h, expected);
            /* the Taylor series begins at w h/2^k < 1/4 with some 1e-16, which k squarings double
             */
            for (int i = 0; i < 4; i++)
                CHECK_CLOSE(phi[i], expected[i], units[i] * (4e-15 + 2e-15 * w * h));
        }
}

/* Amplitude of an undamped resonator after a million cycles of 16 steps. */
static void nothing_is_damped(void **state)
{
    (void)state;
    const double w = 2.0 * 3.14159265358979324 * 15000.0, h = 1.0 / (16.0 * 15000.0);
    const double a[4] = {0.0, 1.0, -w * w, 0.0};
    double phi[4];
    imki_exponential(2, a, h, phi);
    /* the determinant is the factor on the area in phase space, in one step */
    CHECK_CLOSE(phi[0] * phi[3] - phi[1] * phi[2], 1.0, 1e-15);
}

static void inputs_are_integrated(void **state)
{
    (void)state;
    /* x' = -x/T + u and a double integrator with time constants from stiff to slow */
    for (double t = 1e-6; t < 1e7; t *= 10.0) {
        const double a[1] = {-1.0 / t}, b[1] = {1.0}, h = 0.01;
        double phi, gamma;
        imki_discretise(1, 1, a, b, h, &phi, &gamma);
        CHECK_CLOSE(phi, exp(-h / t), 1e-14);
        CHECK_RELATIVE(gamma, -expm1(-h / t) * t, 1e-14);
    }
    const double a[4] = {0.0, 1.0, 0.0, 0.0}, b[2] = {0.0, 3.0};
    double phi[4], gamma[2];
    imki_discretise(2, 1, a, b, 0.5, phi, gamma);
    CHECK_RELATIVE(gamma[0], 3.0 * 0.125, 1e-15);
    CHECK_RELATIVE(gamma[1], 1.5, 1e-15);
    CHECK_RELATIVE(phi[1], 0.5, 1e-15);
}

static void covariances_are_exact(void **state)
{
    (void)state;
    /* Ornstein-Uhlenbeck: s^2 (1 - e^{-2h/T}) */
    for (double t = 1e-4; t < 1e6; t *= 10.0) {
        const double a[1] = {-1.0 / t}, w[1] = {2.0 / t};
        double q;
        imki_step_covariance(1, a, w, 0.01, &q);
        CHECK_RELATIVE(q, -expm1(-0.02 / t), 1e-13);
    }
    /* white acceleration: h^3/3, h^2/2, h */
    const double a[4] = {0.0, 1.0, 0.0, 0.0}, w[4] = {0.0, 0.0, 0.0, 2.0};
    double q[4], root[4];
    imki_step_covariance(2, a, w, 0.3, q);
    CHECK_RELATIVE(q[0], 2.0 * 0.027 / 3.0, 1e-14);
    CHECK_RELATIVE(q[1], 2.0 * 0.09 / 2.0, 1e-14);
    CHECK_RELATIVE(q[3], 2.0 * 0.3, 1e-14);
    imki_covariance_root(2, q, root);
    CHECK_RELATIVE(root[0] * root[0], q[0], 1e-14);
    CHECK_RELATIVE(root[0] * root[2], q[1], 1e-14);
    CHECK_RELATIVE(root[2] * root[2] + root[3] * root[3], q[3], 1e-14);
    CHECK_CLOSE(root[1], 0.0, 0.0);
}

/* A resonator long after its start is stationary: q and phi at h = 1000 time constants. */
static void a_long_step_is_stationary(void **state)
{
    (void)state;
    const double w0 = 1e5, quality = 50.0;
    const double a[4] = {0.0, 1.0, -w0 * w0, -w0 / quality}, w[4] = {0.0, 0.0, 0.0, 7.0};
    double q[4];
    imki_step_covariance(2, a, w, 2000.0 * quality / w0, q);
    /* <v^2> = S Q/(2 w0), <x^2> = that / w0^2, equipartition [UHLENBECK1930] */
    CHECK_RELATIVE(q[3], 7.0 * quality / (2.0 * w0), 1e-9);
    CHECK_RELATIVE(q[0], 7.0 * quality / (2.0 * w0 * w0 * w0), 1e-9);
    CHECK_CLOSE(q[1] / sqrt(q[0] * q[3]), 0.0, 1e-9);
}

/* A singular covariance has zero columns instead of noise of rounding. */
static void a_singular_covariance_has_a_root(void **state)
{
    (void)state;
    const double v[3] = {1.0, 0.1, -3.0};
    double q[9], root[9];
    for (int i = 0; i < 9; i++)
        q[i] = v[i / 3] * v[i % 3];
    imki_covariance_root(3, q, root);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(root[3 * i], v[i], 1e-15);
    for (int i = 0; i < 9; i++)
        if (i % 3 > 0)
            CHECK_CLOSE(root[i], 0.0, 0.0);
    memset(q, 0, sizeof q);
    imki_covariance_root(3, q, root);
    for (int i = 0; i < 9; i++)
        CHECK_CLOSE(root[i], 0.0, 0.0);
}

/* Against the C library (POSIX j0, j1, jn), up to the arguments of a dithered ring laser. */
static void bessel_functions(void **state)
{
    (void)state;
    for (double x = -2000.0; x <= 2000.0; x += 7.3)
        for (int n = 0; n < 6; n++)
            CHECK_CLOSE(imki_bessel_j(n, x), jn(n, x), 3e-14 * sqrt(1.0 + fabs(x)));
    CHECK_CLOSE(imki_bessel_j(0, 2.404825557695773), 0.0, 1e-15); /* its first zero [ABRAMOWITZ1964,
                                                                     table 9.5] */
    CHECK_CLOSE(imki_bessel_j(1, 1.841183781340659), 0.5818652242815964, 1e-15); /* and maximum */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_resonator_is_its_closed_form),
        cmocka_unit_test(nothing_is_damped),
        cmocka_unit_test(inputs_are_integrated),
        cmocka_unit_test(covariances_are_exact),
        cmocka_unit_test(a_long_step_is_stationary),
        cmocka_unit_test(a_singular_covariance_has_a_root),
        cmocka_unit_test(bessel_functions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
