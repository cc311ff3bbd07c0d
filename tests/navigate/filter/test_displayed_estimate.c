/* SPDX-License-Identifier: Apache-2.0 */
/* The attitude covariance of the navigation filter is that of what is displayed. */
#include "check.h"

#include "imukit/navigation_filter.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* At rest at the equator, gyro biases of 1 sigma b alone, on a filter of one radius R: against the
 * Earth the tilt grows as b t, displayed it is b/W sin(W t), W Schuler's rate: b/W after a quarter
 * of its period and nothing after the whole. The Earth's rate mixes the axes by w t = 0.37 rad in
 * the whole, 0.09 in the quarter; the radii of curvature differ from R by 0.7 %, which is 0.7 % of
 * 2 pi b/W after the whole. */
static void tilt_swings_with_the_level(void **state)
{
    (void)state;
    imk_navigation_filter_settings s;
    imk_navigation_filter_default(&s);
    const double b = 1e-7;
    s.hold_height = true;
    s.step = 1.0;
    s.gyro.part_count = 1;
    for (int i = 0; i < 3; i++)
        s.gyro.part[0].sigma[i] = b;
    const imk_geodetic place = {0.0, 0.4, 0.0};
    const imk_navigation_state start =
        imk_navigation_state_ned(0.0, place, (imk_vector3){{0}}, imk_matrix3_identity());
    const size_t size = imk_navigation_filter_size(&s);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_navigation_filter *filter;
    assert_non_null(memory);
    CHECK_OK(imk_navigation_filter_start(&s, &start, &filter, memory, size, NULL));
    const double g = imk_normal_gravity(0.0, 0.0);
    const double w = sqrt(g / imk_vector3_norm(imk_ecef_from_geodetic(place)));
    const imk_vector3 earth = imk_earth_rate(0.0);
    const long whole = lround(2.0 * pi / w), quarter = lround(0.5 * pi / w);
    imk_navigation_filter_estimate estimate;
    for (long k = 1; k <= whole; k++) {
        imk_navigation_filter_step(filter, 1.0, earth, (imk_vector3){{0.0, 0.0, -g}});
        if (k != quarter && k != whole)
            continue;
        imk_navigation_filter_get(filter, &estimate);
        const double *const p[2] = {estimate.covariance[6], estimate.covariance[7]};
        if (k == quarter)
            for (int i = 0; i < 2; i++)
                CHECK_RELATIVE(sqrt(p[i][6 + i]), b / w, 0.02);
        else
            CHECK_BELOW(sqrt(p[0][6] + p[1][7]), 0.1 * sqrt(2.0) * 2.0 * pi * b / w);
        for (int i = 0; i < IMK_NAVIGATION_ERRORS; i++)
            for (int j = 0; j < IMK_NAVIGATION_ERRORS; j++)
                if (i % 9 != 2 && j % 9 != 2 && i != 5 && j != 5) /* of the height is rounding */
                    CHECK_CLOSE(estimate.covariance[i][j], estimate.covariance[j][i],
                                1e-9 * sqrt(estimate.covariance[i][i] * estimate.covariance[j][j]));
    }
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(tilt_swings_with_the_level)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
