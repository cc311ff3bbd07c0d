/* SPDX-License-Identifier: Apache-2.0 */
/* Geodetic and Earth-fixed coordinates, local axes, curvature and the vector of gravity: closed
 * forms, round trips over the globe, and consistency with imk_normal_gravity(). */
#include "check.h"

#include "imukit/earth.h"

#include <stdlib.h>

static const double degree = 0.017453292519943295;
static const double a = 6378137.0, b = 6356752.3142451795; /* WGS84, b = a (1 - f) */

static void test_places_known_in_closed_form(void **state)
{
    (void)state;
    imk_vector3 r = imk_ecef_from_geodetic((imk_geodetic){0.0, 0.0, 100.0});
    CHECK_CLOSE(r.v[0], a + 100.0, 1e-9);
    CHECK_CLOSE(r.v[1], 0.0, 0.0);
    CHECK_CLOSE(r.v[2], 0.0, 0.0);
    r = imk_ecef_from_geodetic((imk_geodetic){90.0 * degree, 0.3, -50.0});
    CHECK_CLOSE(hypot(r.v[0], r.v[1]), 0.0, 1e-9);
    CHECK_CLOSE(r.v[2], b - 50.0, 1e-9);
    /* On the ellipsoid, tan(latitude) = (a/b) tan u of the parametric latitude u: here u = 45
     * degrees, so the place is (a, a, ...)/sqrt(2). */
    const imk_geodetic place = {atan2(a, b), -90.0 * degree, 0.0};
    r = imk_ecef_from_geodetic(place);
    CHECK_CLOSE(r.v[0], 0.0, 1e-9);
    CHECK_CLOSE(r.v[1], -a * sqrt(0.5), 2e-9);
    CHECK_CLOSE(r.v[2], b * sqrt(0.5), 2e-9);
    /* and 1000 km up its normal */
    const double sine = a / hypot(a, b), cosine = b / hypot(a, b);
    const imk_geodetic above = imk_geodetic_from_ecef(
        (imk_vector3){{0.0, -(a * sqrt(0.5) + 1e6 * cosine), b * sqrt(0.5) + 1e6 * sine}});
    CHECK_CLOSE(above.latitude, place.latitude, 4e-16);
    CHECK_CLOSE(above.longitude, -90.0 * degree, 4e-16);
    CHECK_CLOSE(above.height, 1e6, 4e-9);
}

/* There and back over the globe. The height is a difference of two numbers of 6.4e6 m … 1.6e7 m, of
 * which some units in the last place, 0.9e-9 m … 1.9e-9 m, are lost. */
static void test_round_trip(void **state)
{
    (void)state;
    static const double heights[] = {-1e4, -100.0, 0.0, 1234.5, 1e4, 1e5, 1e6, 1e7};
    for (int i = -90; i <= 90; i++)
        for (int j = -180; j <= 180; j += 15)
            for (size_t k = 0; k < sizeof heights / sizeof *heights; k++) {
                const imk_geodetic place = {i * degree, j * degree, heights[k]};
                const imk_vector3 position = imk_ecef_from_geodetic(place);
                const imk_geodetic found = imk_geodetic_from_ecef(position);
                CHECK_CLOSE(found.latitude, place.latitude, 1e-15);
                CHECK_CLOSE(found.height, place.height, heights[k] > 1e5 ? 1e-8 : 3e-9);
                if (abs(i) < 90)
                    CHECK_CLOSE(cos(place.latitude) * sin(found.longitude - place.longitude), 0.0,
                                1e-15);
            }
}

static void test_poles_and_axis(void **state)
{
    (void)state;
    imk_geodetic place = imk_geodetic_from_ecef((imk_vector3){{0.0, 0.0, b + 10.0}});
    CHECK_CLOSE(place.latitude, 90.0 * degree, 0.0);
    CHECK_CLOSE(place.longitude, 0.0, 0.0);
    CHECK_CLOSE(place.height, 10.0, 2e-9);
    place = imk_geodetic_from_ecef((imk_vector3){{-0.0, -0.0, -b}});
    CHECK_CLOSE(place.latitude, -90.0 * degree, 0.0);
    CHECK_CLOSE(place.longitude, 0.0, 0.0);
    /* A millimetre beside the axis: the radius of curvature there is a^2/b. */
    place = imk_geodetic_from_ecef((imk_vector3){{0.0, -1e-3, b}});
    CHECK_CLOSE(90.0 * degree - place.latitude, 1e-3 * b / (a * a), 2.3e-16);
    CHECK_CLOSE(place.longitude, -90.0 * degree, 0.0);
    const imk_vector3 gravity = imk_gravity_ecef((imk_vector3){{0.0, 0.0, -b}});
    CHECK_CLOSE(gravity.v[0], 0.0, 0.0);
    CHECK_CLOSE(gravity.v[2], 9.8321849378, 1e-9); /* NIMA TR8350.2, table 3.4 */
}

/* Directions are rounded a few times, 1e-15 rad; toward the equator see test_normal_gravity.c. */
static void test_gravity_is_down(void **state)
{
    (void)state;
    for (int i = -90; i <= 90; i += 3)
        for (int j = -180; j < 180; j += 45)
            for (double height = -1e4; height <= 5e4; height += 5e3) {
                const double latitude = i * degree, longitude = j * degree;
                const imk_vector3 gravity = imk_gravity_ecef(
                    imk_ecef_from_geodetic((imk_geodetic){latitude, longitude, height}));
                const imk_matrix3 axes = imk_ned_axes(latitude, longitude);
                const imk_vector3 local = imk_matrix3_apply(imk_matrix3_transpose(axes), gravity);
                CHECK_CLOSE(local.v[0], 0.0, height == 0.0 ? 2e-14 : 8.2e-9 * fabs(height));
                CHECK_CLOSE(local.v[1], 0.0, 1e-14);
                CHECK_CLOSE(local.v[2], imk_normal_gravity(latitude, height), 2e-14);
            }
}

/* North and east are the directions in which latitude and longitude grow, and the radii of
 * curvature say how fast: differences over 20 m, whose error is the square of 20 m/a and the
 * rounding of 1e-9 m. */
static void test_axes_and_curvature(void **state)
{
    (void)state;
    for (int i = -80; i <= 80; i += 20) {
        const double latitude = i * degree, longitude = 0.4, height = 3000.0, step = 1.5e-6;
        double meridian, prime_vertical;
        imk_curvature_radii(latitude, &meridian, &prime_vertical);
        const imk_matrix3 axes = imk_ned_axes(latitude, longitude);
        const imk_vector3 north = imk_vector3_subtract(
            imk_ecef_from_geodetic((imk_geodetic){latitude + step, longitude, height}),
            imk_ecef_from_geodetic((imk_geodetic){latitude - step, longitude, height}));
        const imk_vector3 east = imk_vector3_subtract(
            imk_ecef_from_geodetic((imk_geodetic){latitude, longitude + step, height}),
            imk_ecef_from_geodetic((imk_geodetic){latitude, longitude - step, height}));
        const imk_vector3 up = imk_vector3_subtract(
            imk_ecef_from_geodetic((imk_geodetic){latitude, longitude, height + 10.0}),
            imk_ecef_from_geodetic((imk_geodetic){latitude, longitude, height - 10.0}));
        const double around = (prime_vertical + height) * cos(latitude);
        for (int k = 0; k < 3; k++) {
            CHECK_CLOSE(north.v[k] / (2.0 * step * (meridian + height)), axes.m[k][0], 3e-10);
            CHECK_CLOSE(east.v[k] / (2.0 * step * around), axes.m[k][1], 1e-9);
            CHECK_CLOSE(-up.v[k] / 20.0, axes.m[k][2], 2e-10);
        }
    }
    double meridian, prime_vertical;
    imk_curvature_radii(0.0, &meridian, &prime_vertical);
    CHECK_CLOSE(meridian, b * b / a, 1e-8);
    CHECK_CLOSE(prime_vertical, a, 0.0);
    imk_curvature_radii(90.0 * degree, &meridian, &prime_vertical);
    CHECK_CLOSE(meridian, a * a / b, 1e-8);
    CHECK_CLOSE(prime_vertical, a * a / b, 1e-8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places_known_in_closed_form),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_poles_and_axis),
        cmocka_unit_test(test_gravity_is_down),
        cmocka_unit_test(test_axes_and_curvature),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
