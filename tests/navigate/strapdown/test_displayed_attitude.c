/* SPDX-License-Identifier: Apache-2.0 */
/* The error of a displayed attitude: against differences of roll, pitch and yaw, its linear form,
 * across the longitude of 180 deg, over the poles, and back. */
#include "check.h"

#include "imukit/navigate.h"

#include "imukit/elementary.h"

static const double degree = 0.017453292519943295, pi = 3.14159265358979323846;

static imk_navigation_state state_at(double latitude, double longitude, const double angle[3])
{
    return imk_navigation_state_ned(0.0, (imk_geodetic){latitude, longitude, 300.0},
                                    (imk_vector3){{0}},
                                    imk_matrix3_from_euler(angle[0], angle[1], angle[2]));
}

/* What a display shows is that of the local level: with equal roll, pitch and yaw there is no error
 * whatever the place, and a level unit's errors are their differences. */
static void differences_of_what_is_shown(void **state)
{
    (void)state;
    static const double none[3] = {0.3, -0.5, 2.0}, level[3] = {0.0, 0.0, 179.0 * degree};
    const double other[3] = {0.0, 0.0, -175.0 * degree};
    for (double latitude = -88.0 * degree; latitude < 89.0 * degree; latitude += 22.0 * degree) {
        const imk_navigation_state truth = state_at(latitude, 3.1, none);
        const imk_navigation_state far = state_at(latitude + 0.01, -3.1, none);
        const imk_vector3 nothing = imk_displayed_attitude_error(&far, &truth);
        for (int i = 0; i < 3; i++)
            CHECK_CLOSE(nothing.v[i], 0.0, 2e-15);
        const imk_navigation_state a = state_at(latitude, 3.1, level);
        const imk_navigation_state b = state_at(latitude + 0.01, -3.1, other);
        const imk_vector3 yaw = imk_displayed_attitude_error(&b, &a);
        CHECK_CLOSE(yaw.v[0], 0.0, 2e-15);
        CHECK_CLOSE(yaw.v[1], 0.0, 2e-15);
        CHECK_CLOSE(yaw.v[2], 6.0 * degree, 3e-15); /* wrapped: 185 - 179 */
    }
    /* pitch about east and roll about north, heading north */
    static const double zero[3] = {0.0, 0.0, 0.0}, roll[3] = {0.02, 0.0, 0.0};
    static const double pitch[3] = {0.0, 0.02, 0.0};
    const imk_navigation_state truth = state_at(0.5, 0.1, zero), rolled = state_at(0.6, 0.4, roll);
    const imk_navigation_state pitched = state_at(0.6, 0.4, pitch);
    CHECK_CLOSE(imk_displayed_attitude_error(&rolled, &truth).v[0], 0.02, 1e-15);
    CHECK_CLOSE(imk_displayed_attitude_error(&pitched, &truth).v[1], 0.02, 1e-15);
}

/* phi = psi - imk_level_turn() dr, beyond 89 deg of the grid: for errors of 20 m and 3e-6 rad,
 * whose products with angles of 20/(111 km) beside the pole are below 1e-9. */
static void linear_form(void **state)
{
    (void)state;
    static const double latitudes[] = {-90.0, -89.999, -89.5, -88.9, -60.0, 0.0,
                                       45.0,  88.9,    89.1,  89.99, 90.0};
    static const double angle[3] = {0.2, -0.3, 1.0};
    for (size_t i = 0; i < sizeof latitudes / sizeof *latitudes; i++)
        for (int direction = 0; direction < 6; direction++) {
            const imk_geodetic place = {latitudes[i] * degree, 0.7, 300.0};
            const imk_navigation_state truth = state_at(place.latitude, place.longitude, angle);
            const imk_geodetic found = imk_geodetic_from_ecef(truth.position);
            const imk_matrix3 axes = imk_ned_axes(found.latitude, found.longitude);
            imk_vector3 dr = {{0}}, psi = {{0}};
            if (direction < 3)
                dr.v[direction] = 20.0;
            else
                psi.v[direction - 3] = 3e-6;
            imk_navigation_state estimate = truth;
            estimate.position = imk_vector3_add(truth.position, imk_matrix3_apply(axes, dr));
            estimate.attitude = imk_quaternion_multiply(
                imk_quaternion_from_rotation_vector(imk_matrix3_apply(axes, psi)), truth.attitude);
            const imk_vector3 phi = imk_displayed_attitude_error(&estimate, &truth);
            const imk_vector3 turn = imk_matrix3_apply(imk_level_turn(found), dr);
            for (int k = 0; k < 3; k++)
                CHECK_CLOSE(phi.v[k], psi.v[k] - turn.v[k], 1e-9);
        }
}

/* At the pole the yaw of a display turns with the longitude and says nothing; the grid heading is
 * off by what the body is. */
static void grid_heading_over_the_pole(void **state)
{
    (void)state;
    static const double angle[3] = {0.0, 0.0, 0.4};
    for (int south = 0; south < 2; south++) {
        const double latitude = (south ? -1.0 : 1.0) * (90.0 * degree - 1e-6);
        const imk_navigation_state truth = state_at(latitude, 0.2, angle);
        imk_navigation_state estimate = state_at(latitude, 0.2 + 112.0 * degree, angle);
        estimate.attitude = truth.attitude;
        const imk_vector3 phi = imk_displayed_attitude_error(&estimate, &truth);
        CHECK_CLOSE(phi.v[2], 0.0, 1e-11);
        CHECK_BELOW(hypot(phi.v[0], phi.v[1]), 2.1e-6); /* two places 1e-6 rad from the pole */
        estimate.attitude = imk_quaternion_multiply(
            imk_quaternion_from_rotation_vector((imk_vector3){{0.0, 0.0, south ? 0.1 : -0.1}}),
            truth.attitude);
        CHECK_CLOSE(imk_displayed_attitude_error(&estimate, &truth).v[2], 0.1, 1e-9);
    }
}

/* imk_displayed_attitude() makes what imk_displayed_attitude_error() finds, also of large ones: a
 * tilt is the angle by which the vertical is wrong, whatever the heading. */
static void there_and_back(void **state)
{
    (void)state;
    static const double latitudes[] = {-90.0, -89.9, -30.0, 0.0, 60.0, 89.95};
    static const double angle[3] = {0.2, -0.3, 1.0};
    static const double errors[][3] = {{0.0, 0.0, 3.0}, {1.0, -1.5, -2.0}, {1e-6, 2e-6, -3e-6}};
    for (size_t i = 0; i < 6; i++)
        for (size_t j = 0; j < 3; j++) {
            const imk_navigation_state truth = state_at(latitudes[i] * degree, -2.0, angle);
            imk_navigation_state estimate = state_at(latitudes[i] * degree, 2.5, angle);
            const imk_vector3 phi = {{errors[j][0], errors[j][1], errors[j][2]}};
            estimate.attitude = imk_displayed_attitude(&truth, estimate.position, phi);
            const imk_vector3 found = imk_displayed_attitude_error(&estimate, &truth);
            for (int k = 0; k < 3; k++)
                CHECK_CLOSE(found.v[k], errors[j][k], 4e-15);
            if (fabs(latitudes[i]) > 89.0)
                continue;
            imk_matrix3 shown, right;
            imk_navigation_state_to_ned(&estimate, NULL, NULL, &shown);
            imk_navigation_state_to_ned(&truth, NULL, NULL, &right);
            const imk_matrix3 turn = imk_matrix3_multiply(shown, imk_matrix3_transpose(right));
            CHECK_CLOSE(turn.m[2][2], imk_cos(hypot(errors[j][0], errors[j][1])), 1e-14);
        }
    static const double flat[3] = {0.0, 0.0, 0.0};
    const imk_navigation_state truth = state_at(0.3, 0.0, flat);
    imk_navigation_state estimate = truth;
    estimate.attitude =
        imk_displayed_attitude(&truth, truth.position, (imk_vector3){{0.0, 0.0, -pi}});
    CHECK_CLOSE(fabs(imk_displayed_attitude_error(&estimate, &truth).v[2]), pi, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(differences_of_what_is_shown),
        cmocka_unit_test(linear_form),
        cmocka_unit_test(grid_heading_over_the_pole),
        cmocka_unit_test(there_and_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
