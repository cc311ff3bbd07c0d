/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors, matrices and rotations: textbook turns, the identities between the representations, and
 * the ends of the range. Tolerances are a few rounding errors of numbers near 1. */
#include "check.h"

#include "imukit/attitude.h"

static const double pi = 3.14159265358979323846;

static double next_number(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

static imk_vector3 next_vector(uint64_t *state, double size)
{
    imk_vector3 v;
    for (int i = 0; i < 3; i++)
        v.v[i] = size * next_number(state);
    return v;
}

#define CHECK_VECTOR(actual, x, y, z, tolerance)                                                   \
    do {                                                                                           \
        const imk_vector3 vector = (actual);                                                       \
        CHECK_CLOSE(vector.v[0], (x), (tolerance));                                                \
        CHECK_CLOSE(vector.v[1], (y), (tolerance));                                                \
        CHECK_CLOSE(vector.v[2], (z), (tolerance));                                                \
    } while (0)

static void check_same_matrix(imk_matrix3 a, imk_matrix3 b, double tolerance)
{
    for (int i = 0; i < 9; i++)
        CHECK_CLOSE(a.m[i / 3][i % 3], b.m[i / 3][i % 3], tolerance);
}

static void vectors_follow_their_definitions(void **state)
{
    (void)state;
    const imk_vector3 a = {{1.0, 2.0, 3.0}}, b = {{-4.0, 5.0, 6.0}};
    CHECK_VECTOR(imk_vector3_add(a, b), -3.0, 7.0, 9.0, 0.0);
    CHECK_VECTOR(imk_vector3_subtract(a, b), 5.0, -3.0, -3.0, 0.0);
    CHECK_VECTOR(imk_vector3_scale(a, -2.0), -2.0, -4.0, -6.0, 0.0);
    CHECK_VECTOR(imk_vector3_cross(a, b), -3.0, -18.0, 13.0, 0.0);
    CHECK_CLOSE(imk_vector3_dot(a, b), 24.0, 0.0);
}

static void length_neither_overflows_nor_underflows(void **state)
{
    (void)state;
    const double sizes[] = {1.0, 1e-160, 1e-307, 1e160, 1e307};
    for (int i = 0; i < 5; i++) {
        const imk_vector3 v = {{2.0 * sizes[i], -3.0 * sizes[i], 6.0 * sizes[i]}};
        CHECK_RELATIVE(imk_vector3_norm(v), 7.0 * sizes[i], 4e-16);
    }
    CHECK_CLOSE(imk_vector3_norm((imk_vector3){{0.0, 0.0, 0.0}}), 0.0, 0.0);
    CHECK_CLOSE(imk_vector3_norm((imk_vector3){{0x1p-1074, 0.0, 0.0}}), 0x1p-1074, 0.0);
    assert_true(isinf(imk_vector3_norm((imk_vector3){{1.0, -(double)INFINITY, 0.0}})));
    assert_true(isnan(imk_vector3_norm((imk_vector3){{1.0, (double)NAN, 0.0}})));
}

static void matrix_inverse_and_products(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (int trial = 0; trial < 200; trial++) {
        imk_matrix3 a, inverse;
        for (int i = 0; i < 9; i++)
            a.m[i / 3][i % 3] = next_number(&random) + (i % 4 == 0 ? 2.0 : 0.0);
        CHECK_OK(imk_matrix3_inverse(a, &inverse));
        check_same_matrix(imk_matrix3_multiply(a, inverse), imk_matrix3_identity(), 1e-13);
        check_same_matrix(imk_matrix3_multiply(inverse, a), imk_matrix3_identity(), 1e-13);
        const imk_vector3 v = next_vector(&random, 1.0);
        const imk_vector3 back = imk_matrix3_apply(inverse, imk_matrix3_apply(a, v));
        CHECK_VECTOR(back, v.v[0], v.v[1], v.v[2], 1e-13);
        check_same_matrix(imk_matrix3_transpose(imk_matrix3_transpose(a)), a, 0.0);
        CHECK_OK(imk_matrix3_inverse(a, &a)); /* onto itself */
        check_same_matrix(a, inverse, 0.0);
    }
}

static void singular_matrices_are_refused(void **state)
{
    (void)state;
    const imk_matrix3 singular[] = {
        {{{0}}},
        {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}},
        {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1e-15}}}, /* condition 1e15 */
        {{{1, 0, 0}, {0, (double)NAN, 0}, {0, 0, 1}}},
        {{{1e-101, 0, 0}, {0, 1e-100, 0}, {0, 0, 1e-100}}}, /* determinant 1e-301 */
    };
    for (size_t i = 0; i < sizeof singular / sizeof singular[0]; i++) {
        imk_matrix3 inverse = {{{7.0}}};
        CHECK_STATUS(imk_matrix3_inverse(singular[i], &inverse), IMK_ERROR_SINGULAR);
        CHECK_CLOSE(inverse.m[0][0], 7.0, 0.0);
    }
    imk_matrix3 inverse;
    const imk_matrix3 stretched = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1e-13}}};
    CHECK_OK(imk_matrix3_inverse(stretched, &inverse));
    CHECK_RELATIVE(inverse.m[2][2], 1e13, 1e-15);
}

/* A quarter turn about z takes x to y; the body's x axis then points east when yaw is 90 deg. */
static void a_quarter_turn_takes_x_to_y(void **state)
{
    (void)state;
    const imk_vector3 x = {{1.0, 0.0, 0.0}};
    const imk_quaternion q =
        imk_quaternion_from_rotation_vector((imk_vector3){{0.0, 0.0, 0.5 * pi}});
    CHECK_CLOSE(q.w, sqrt(0.5), 2e-16);
    CHECK_CLOSE(q.z, sqrt(0.5), 2e-16);
    CHECK_VECTOR(imk_quaternion_rotate(q, x), 0.0, 1.0, 0.0, 4e-16);
    CHECK_VECTOR(imk_matrix3_apply(imk_quaternion_to_matrix(q), x), 0.0, 1.0, 0.0, 4e-16);
    CHECK_VECTOR(imk_matrix3_apply(imk_matrix3_from_euler(0.0, 0.0, 0.5 * pi), x), 0.0, 1.0, 0.0,
                 4e-16);
    /* Nose up by 30 deg: forward has a component up, which is -z in north-east-down. */
    CHECK_VECTOR(imk_matrix3_apply(imk_matrix3_from_euler(0.0, pi / 6.0, 0.0), x),
                 0.86602540378443865, 0.0, -0.5, 4e-16);
    /* Right wing down by 30 deg: right points down. */
    CHECK_VECTOR(imk_matrix3_apply(imk_matrix3_from_euler(pi / 6.0, 0.0, 0.0),
                                   (imk_vector3){{0.0, 1.0, 0.0}}),
                 0.0, 0.86602540378443865, 0.5, 4e-16);
}

static void representations_agree(void **state)
{
    (void)state;
    uint64_t random = 11;
    for (int trial = 0; trial < 2000; trial++) {
        const imk_vector3 a = next_vector(&random, 1.8), b = next_vector(&random, 1.8);
        const imk_vector3 v = next_vector(&random, 1.0);
        const imk_quaternion p = imk_quaternion_from_rotation_vector(a);
        const imk_quaternion q = imk_quaternion_from_rotation_vector(b);
        const imk_matrix3 cp = imk_quaternion_to_matrix(p), cq = imk_quaternion_to_matrix(q);
        CHECK_CLOSE(p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z, 1.0, 1e-15);
        const imk_vector3 turned = imk_matrix3_apply(cp, v);
        CHECK_VECTOR(imk_quaternion_rotate(p, v), turned.v[0], turned.v[1], turned.v[2], 2e-15);
        check_same_matrix(imk_quaternion_to_matrix(imk_quaternion_multiply(p, q)),
                          imk_matrix3_multiply(cp, cq), 2e-15);
        check_same_matrix(imk_quaternion_to_matrix(imk_quaternion_conjugate(p)),
                          imk_matrix3_transpose(cp), 0.0);
        const imk_vector3 back = imk_quaternion_to_rotation_vector(p);
        if (imk_vector3_norm(a) < pi - 1e-3)
            CHECK_VECTOR(back, a.v[0], a.v[1], a.v[2], 3e-15);
        const imk_quaternion opposite = {-p.w, -p.x, -p.y, -p.z};
        CHECK_VECTOR(imk_quaternion_to_rotation_vector(opposite), back.v[0], back.v[1], back.v[2],
                     0.0);
        const imk_quaternion again = imk_quaternion_from_matrix(cp);
        const double sign = p.w < 0.0 ? -1.0 : 1.0;
        assert_true(again.w >= 0.0);
        CHECK_CLOSE(again.w, sign * p.w, 2e-15);
        CHECK_CLOSE(again.x, sign * p.x, 2e-15);
        CHECK_CLOSE(again.y, sign * p.y, 2e-15);
        CHECK_CLOSE(again.z, sign * p.z, 2e-15);
    }
}

/* Half turns, where w is 0 and the largest component must be chosen. */
static void half_turns_survive_the_matrix(void **state)
{
    (void)state;
    const imk_vector3 axes[] = {{{1, 0, 0}},     {{0, 1, 0}},      {{0, 0, 1}},
                                {{0.6, 0.8, 0}}, {{0, 0.6, -0.8}}, {{-0.48, 0.6, 0.64}}};
    for (int i = 0; i < 6; i++) {
        const imk_quaternion q =
            imk_quaternion_from_rotation_vector(imk_vector3_scale(axes[i], pi));
        const imk_matrix3 c = imk_quaternion_to_matrix(q);
        check_same_matrix(imk_quaternion_to_matrix(imk_quaternion_from_matrix(c)), c, 2e-15);
    }
}

/* On both sides of the switch from the series to the sine, and far below it. */
static void small_rotations_are_exact_to_rounding(void **state)
{
    (void)state;
    const double angles[] = {1e-300, 1e-20, 1e-8, 1e-4, 0.00999999, 0.01000001, 0.1};
    for (int i = 0; i < 7; i++) {
        const imk_vector3 a = {{angles[i] * 0.48, angles[i] * -0.6, angles[i] * 0.64}};
        const imk_quaternion q = imk_quaternion_from_rotation_vector(a);
        CHECK_RELATIVE(q.x, 0.48 * sin(0.5 * angles[i]), 6e-16);
        CHECK_RELATIVE(q.w, cos(0.5 * angles[i]), 2e-16);
        const imk_vector3 back = imk_quaternion_to_rotation_vector(q);
        for (int k = 0; k < 3; k++)
            CHECK_RELATIVE(back.v[k], a.v[k], 2e-15);
    }
    const imk_quaternion q = imk_quaternion_from_rotation_vector((imk_vector3){{0, 0, 0}});
    assert_true(q.w == 1.0 && q.x == 0.0 && q.y == 0.0 && q.z == 0.0);
    CHECK_VECTOR(imk_quaternion_to_rotation_vector(q), 0.0, 0.0, 0.0, 0.0);
}

static void euler_angles_come_back(void **state)
{
    (void)state;
    uint64_t random = 13;
    for (int trial = 0; trial < 2000; trial++) {
        const double roll = pi * next_number(&random), yaw = pi * next_number(&random);
        const double pitch = 1.5 * next_number(&random); /* up to 86 deg: cosine above 0.07 */
        double r, p, y;
        imk_matrix3_to_euler(imk_matrix3_from_euler(roll, pitch, yaw), &r, &p, &y);
        CHECK_CLOSE(r, roll, 1e-14);
        CHECK_CLOSE(p, pitch, 1e-14);
        CHECK_CLOSE(y, yaw, 1e-14);
    }
    /* Straight up and down only yaw -+ roll is known; it is given as yaw. */
    for (int sign = -1; sign <= 1; sign += 2) {
        const imk_matrix3 c = imk_matrix3_from_euler(0.3, sign * 0.5 * pi, 1.0);
        double r, p, y;
        imk_matrix3_to_euler(c, &r, &p, &y);
        CHECK_CLOSE(r, 0.0, 0.0);
        CHECK_CLOSE(p, sign * 0.5 * pi, 1e-15);
        CHECK_CLOSE(y, 1.0 - sign * 0.3, 1e-14);
        check_same_matrix(imk_matrix3_from_euler(r, p, y), c, 1e-15);
    }
}

static void quaternions_are_normalised(void **state)
{
    (void)state;
    const double sizes[] = {1.0, 1e-200, 1e200, 5.0};
    for (int i = 0; i < 4; i++) {
        const double s = sizes[i];
        const imk_quaternion q =
            imk_quaternion_normalise((imk_quaternion){s, -2.0 * s, 4.0 * s, -10.0 * s});
        CHECK_CLOSE(q.w, 1.0 / 11.0, 1e-16);
        CHECK_CLOSE(q.z, -10.0 / 11.0, 2e-16);
    }
    const imk_quaternion zero = imk_quaternion_normalise((imk_quaternion){0, 0, 0, 0});
    assert_true(zero.w == 1.0 && zero.x == 0.0 && zero.y == 0.0 && zero.z == 0.0);
    const imk_quaternion unit =
        imk_quaternion_multiply(imk_quaternion_identity(), (imk_quaternion){0.5, 0.5, -0.5, 0.5});
    assert_true(unit.w == 0.5 && unit.x == 0.5 && unit.y == -0.5 && unit.z == 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors_follow_their_definitions),
        cmocka_unit_test(length_neither_overflows_nor_underflows),
        cmocka_unit_test(matrix_inverse_and_products),
        cmocka_unit_test(singular_matrices_are_refused),
        cmocka_unit_test(a_quarter_turn_takes_x_to_y),
        cmocka_unit_test(representations_agree),
        cmocka_unit_test(half_turns_survive_the_matrix),
        cmocka_unit_test(small_rotations_are_exact_to_rounding),
        cmocka_unit_test(euler_angles_come_back),
        cmocka_unit_test(quaternions_are_normalised),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
