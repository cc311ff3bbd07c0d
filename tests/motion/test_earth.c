/* SPDX-License-Identifier: Apache-2.0 */
/* Normal gravity and rotation of the Earth against published values of WGS84. */
#include "check.h"

#include "imukit/earth.h"

static const double degree = 0.017453292519943295;

static void test_gravity_on_the_ellipsoid(void **state)
{
    (void)state;
    /* NIMA TR8350.2, table 3.4: at the equator and the poles, to the 10 decimals printed */
    CHECK_CLOSE(imk_normal_gravity(0.0, 0.0), 9.7803253359, 1e-10);
    CHECK_CLOSE(imk_normal_gravity(90.0 * degree, 0.0), 9.8321849378, 1e-9);
    CHECK_CLOSE(imk_normal_gravity(-90.0 * degree, 0.0), 9.8321849378, 1e-9);
}

/* The closed ellipsoidal field (tests/reference/ellipsoidal_gravity.py); the second-order expansion
 * in height leaves 1e-6 m/s^2 at 10 km and a tenth of that at 1 km. */
static void test_gravity_with_height(void **state)
{
    (void)state;
    static const double reference[][3] = {
        {0.0, 1000.0, 9.7772382646},   {0.0, 10000.0, 9.7495198583}, {30.0, 0.0, 9.7932472692},
        {30.0, 10000.0, 9.7624527276}, {45.0, 0.0, 9.8061977694},    {45.0, 1000.0, 9.8031128969},
        {45.0, 10000.0, 9.7754141882}, {90.0, 1000.0, 9.8291022743}, {90.0, 10000.0, 9.8014233509}};
    for (size_t i = 0; i < sizeof reference / sizeof *reference; i++) {
        double tolerance = reference[i][1] > 1000.0 ? 1e-6 : reference[i][1] > 0.0 ? 1.2e-7 : 1e-9;
        CHECK_CLOSE(imk_normal_gravity(reference[i][0] * degree, reference[i][1]), reference[i][2],
                    tolerance);
    }
    /* the parked laser gyro of the shared data reads 9.7955 at 34.246 N, 380 m */
    CHECK_CLOSE(imk_normal_gravity(34.246048 * degree, 380.0), 9.7955, 2e-4);
}

static void test_rotation(void **state)
{
    (void)state;
    imk_vector3 rate = imk_earth_rate(30.0 * degree);
    CHECK_RELATIVE(rate.v[0], 7.292115e-5 * sqrt(0.75), 1e-14);
    CHECK_CLOSE(rate.v[1], 0.0, 0.0);
    CHECK_RELATIVE(rate.v[2], -7.292115e-5 * 0.5, 1e-14);
    /* 15.041 deg/h */
    CHECK_CLOSE(imk_vector3_norm(rate) / degree * 3600.0, 15.041067, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gravity_on_the_ellipsoid),
        cmocka_unit_test(test_gravity_with_height),
        cmocka_unit_test(test_rotation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
