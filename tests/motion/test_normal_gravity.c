/* SPDX-License-Identifier: Apache-2.0 */
/* The vector of normal gravity aloft against the closed field of the ellipsoid in its own harmonic
 * coordinates [HEISKANEN1967, sec. 2-7 and 2-8] [NIMA-TR8350.2, sec. 4], which itself is checked
 * by what defines it: Laplace's equation, the level ellipsoid, Somigliana's gravity on it. */
#include "check.h"

#include "imukit/earth.h"

#include "imukit/elementary.h"

static const double degree = 0.017453292519943295;
/* [NIMA-TR8350.2, table 3.1] */
static const double a = 6378137.0, flattening = 1.0 / 298.257223563, rate = 7.292115e-5;
static const double gm = 3986004.418e8;

/* A point in the meridian: distance from the axis, along it. */
typedef struct point {
    double p, z;
} point;

static double minor(void)
{
    return a * (1.0 - flattening);
}

static double focal(void)
{
    return a * sqrt(flattening * (2.0 - flattening));
}

/* q = 1/2 [(1 + 3 u^2/E^2) atan(E/u) - 3 u/E] as the series of atan in t = E/u < 0.1 leaves it, in
 * which nothing cancels, and q' = 3 (1 + u^2/E^2) (1 - u/E atan(E/u)) - 1 likewise. */
static double shape(double u)
{
    const double t = focal() / u;
    double sum = 0.0, power = t * t * t, sign = 1.0;
    for (int n = 1; n < 12; n++, power *= t * t, sign = -sign)
        sum += sign * 2.0 * n / ((2.0 * n + 1.0) * (2.0 * n + 3.0)) * power;
    return sum;
}

static double shape_slope(double u)
{
    const double t = focal() / u;
    double sum = 0.0, power = t * t, sign = 1.0;
    for (int n = 1; n < 12; n++, power *= t * t, sign = -sign)
        sum += sign * 6.0 / ((2.0 * n + 1.0) * (2.0 * n + 3.0)) * power;
    return sum;
}

/* u^2, and the sine of the reduced latitude squared */
static double harmonic(point at, double *sine_squared)
{
    const double e = focal(), k = at.p * at.p + at.z * at.z - e * e;
    const double uu = 0.5 * (k + sqrt(k * k + 4.0 * e * e * at.z * at.z));
    *sine_squared = at.z * at.z / uu;
    return uu;
}

static double potential(point at)
{
    const double e = focal();
    double ss;
    const double u = sqrt(harmonic(at, &ss));
    return gm / e * imk_atan2(e, u) +
           0.5 * rate * rate * a * a * shape(u) / shape(minor()) * (ss - 1.0 / 3.0) +
           0.5 * rate * rate * at.p * at.p;
}

/* Derivatives of it along u and the reduced latitude, turned to p and z. */
static point gravity(point at)
{
    const double e = focal();
    double ss;
    const double uu = harmonic(at, &ss), u = sqrt(uu), v = sqrt(uu + e * e);
    const double s = at.z / u, c = at.p / v;
    const double w = sqrt((uu + e * e * ss) / (uu + e * e)), aa = rate * rate * a * a;
    const double along_u =
        -(gm / (v * v) + aa * e / (v * v) * shape_slope(u) / shape(minor()) * (0.5 * ss - 1.0 / 6) -
          rate * rate * u * c * c) /
        w;
    const double along_b = (aa / v * shape(u) / shape(minor()) - rate * rate * v) * s * c / w;
    return (point){(u / v * c * along_u - s * along_b) / w,
                   (s * along_u + u / v * c * along_b) / w};
}

static point point_at(double latitude, double height)
{
    const imk_vector3 r = imk_ecef_from_geodetic((imk_geodetic){latitude, 0.0, height});
    return (point){r.v[0], r.v[2]};
}

/* North and down of the oracle at a geodetic place. */
static void closed(double latitude, double height, double *north, double *down)
{
    const point g = gravity(point_at(latitude, height));
    const double s = imk_sin(latitude), c = imk_cos(latitude);
    *north = c * g.z - s * g.p;
    *down = -(c * g.p + s * g.z);
}

/* Differences of the potential over 100 m and over 20 km: rounding 6e7/1e16/200 m, the next term
 * of the series (step/r)^2 of what it is a difference of. */
static void test_oracle_is_a_field(void **state)
{
    (void)state;
    for (double latitude = -75.0 * degree; latitude < 90.0 * degree; latitude += 25.0 * degree)
        for (double height = 0.0; height <= 1e6; height += 2.5e5) {
            const point at = point_at(latitude, height), g = gravity(at);
            const double h = 100.0, k = 2e4;
            CHECK_CLOSE(g.p,
                        (potential((point){at.p + h, at.z}) - potential((point){at.p - h, at.z})) /
                            (2.0 * h),
                        3e-9);
            CHECK_CLOSE(g.z,
                        (potential((point){at.p, at.z + h}) - potential((point){at.p, at.z - h})) /
                            (2.0 * h),
                        3e-9);
            const double pp =
                (gravity((point){at.p + k, at.z}).p - gravity((point){at.p - k, at.z}).p) /
                (2.0 * k);
            const double zz =
                (gravity((point){at.p, at.z + k}).z - gravity((point){at.p, at.z - k}).z) /
                (2.0 * k);
            /* The gradients are 1.5e-6 and 3e-6 1/s^2, what they add up to 1.06e-8. */
            CHECK_CLOSE(pp + zz + g.p / at.p, 2.0 * rate * rate, 3e-10);
        }
}

static void test_oracle_on_the_ellipsoid(void **state)
{
    (void)state;
    const double level = 62636851.7146; /* [NIMA-TR8350.2, table 3.4] */
    for (double latitude = -80.0 * degree; latitude < 90.0 * degree; latitude += 16.0 * degree) {
        double north, down;
        closed(latitude, 0.0, &north, &down);
        CHECK_CLOSE(north, 0.0, 1e-14);
        CHECK_CLOSE(down, imk_normal_gravity(latitude, 0.0), 1e-9); /* Somigliana's, as printed */
        CHECK_CLOSE(potential(point_at(latitude, 0.0)), level, 1e-3);
    }
}

/* North of the library, in units of the oracle's: within `share`. */
static double worst_north(double low, double high, double step)
{
    double worst = 0.0;
    for (double latitude = -87.0 * degree; latitude < 90.0 * degree; latitude += 6.0 * degree)
        for (double height = low; height <= high; height += step) {
            double north, down;
            if (height == 0.0)
                continue;
            closed(latitude, height, &north, &down);
            const imk_vector3 g =
                imk_gravity_ecef(imk_ecef_from_geodetic((imk_geodetic){latitude, 0.7, height}));
            const imk_vector3 local =
                imk_matrix3_apply(imk_matrix3_transpose(imk_ned_axes(latitude, 0.7)), g);
            CHECK_CLOSE(local.v[1], 0.0, 1e-14);
            worst = fmax(worst, fabs(local.v[0] / north - 1.0));
        }
    return worst;
}

static void test_toward_the_equator(void **state)
{
    (void)state;
    double north, down;
    closed(45.0 * degree, 1e4, &north, &down);
    CHECK_CLOSE(north, -8.135e-5, 1e-8); /* what earth.h says */
    CHECK_BELOW(worst_north(-1e4, 5e4, 1e3), 3e-4);
    CHECK_BELOW(worst_north(0.0, 1e6, 2e4), 1e-3);
    CHECK_BELOW(worst_north(1e6, 3.6e6, 1e5), 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracle_is_a_field),
        cmocka_unit_test(test_oracle_on_the_ellipsoid),
        cmocka_unit_test(test_toward_the_equator),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
