/* SPDX-License-Identifier: Apache-2.0 */
/* Signed permutations of the axes of gyros and accelerometers: of all 48 x 48 pairs, which look
 * alike by turns between rests, and that what is offered mends them. */
#include "check.h"

#include "imukit/axes_mending.h"

#include <string.h>

enum { AXES = 3 };

static void matrix_of(const imk_signed_axes *p, int m[AXES][AXES])
{
    memset(m, 0, sizeof(int[AXES][AXES]));
    for (int i = 0; i < AXES; i++)
        m[i][p->column[i]] = p->sign[i];
}

static void multiply(int a[AXES][AXES], int b[AXES][AXES], int out[AXES][AXES])
{
    for (int i = 0; i < AXES; i++)
        for (int j = 0; j < AXES; j++) {
            out[i][j] = 0;
            for (int k = 0; k < AXES; k++)
                out[i][j] += a[i][k] * b[k][j];
        }
}

static int determinant(int m[AXES][AXES])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* The gyro permutation that alone explains a log with gyros P w and accelerometers A f:
 * det(A) A P^-1, from the definition C(R w) = R C(w) R^T. */
static int class_of(int gyro, int accel)
{
    int a[AXES][AXES], p[AXES][AXES], inverse[AXES][AXES], due[AXES][AXES], m[AXES][AXES];
    const imk_signed_axes of_gyro = imk_signed_axes_of(gyro), of_accel = imk_signed_axes_of(accel);
    matrix_of(&of_gyro, p);
    matrix_of(&of_accel, a);
    for (int i = 0; i < AXES; i++)
        for (int j = 0; j < AXES; j++)
            inverse[i][j] = p[j][i];
    multiply(a, inverse, due);
    for (int index = 0; index < IMK_SIGNED_AXES; index++) {
        const imk_signed_axes candidate = imk_signed_axes_of(index);
        matrix_of(&candidate, m);
        bool same = true;
        for (int i = 0; i < AXES; i++)
            for (int j = 0; j < AXES; j++)
                same = same && m[i][j] == determinant(a) * due[i][j];
        if (same)
            return index;
    }
    fail_msg("no class");
    return -1;
}

static void permutations_are_all_there(void **state)
{
    (void)state;
    for (int k = 0; k < IMK_SIGNED_AXES; k++) {
        int m[AXES][AXES], other[AXES][AXES];
        const imk_signed_axes p = imk_signed_axes_of(k);
        matrix_of(&p, m);
        assert_int_equal(determinant(m), p.determinant);
        for (int j = 0; j < k; j++) {
            const imk_signed_axes q = imk_signed_axes_of(j);
            matrix_of(&q, other);
            assert_true(memcmp(m, other, sizeof m) != 0);
        }
    }
    const imk_signed_axes none = imk_signed_axes_of(0), outside = imk_signed_axes_of(99);
    assert_memory_equal(&none, &outside, sizeof none);
}

/* What is mended differs from the truth by one rotation of both sensors, or all accelerometers. */
static void check_mends(int gyro, int accel, const imk_axes_mending *m)
{
    int read[AXES][AXES], mend[AXES][AXES], of_gyro[AXES][AXES], of_accel[AXES][AXES];
    imk_signed_axes p = imk_signed_axes_of(gyro);
    matrix_of(&p, read);
    matrix_of(&m->of[0], mend);
    multiply(mend, read, of_gyro);
    p = imk_signed_axes_of(accel);
    matrix_of(&p, read);
    matrix_of(&m->of[1], mend);
    multiply(mend, read, of_accel);
    assert_int_equal(determinant(of_gyro), 1);
    const int sign = determinant(of_accel);
    for (int i = 0; i < AXES; i++)
        for (int j = 0; j < AXES; j++)
            assert_int_equal(of_accel[i][j], sign * of_gyro[i][j]);
}

static void every_pair_is_mended(void **state)
{
    (void)state;
    int sound = 0;
    for (int gyro = 0; gyro < IMK_SIGNED_AXES; gyro++)
        for (int accel = 0; accel < IMK_SIGNED_AXES; accel++) {
            imk_axes_mending m[IMK_AXES_MENDINGS_MAX];
            const int index = class_of(gyro, accel);
            const size_t count = imk_axes_mendings(UINT64_C(1) << index, m);
            sound += count == 0;
            assert_true((count == 0) == (index == 0));
            for (size_t k = 0; k < count; k++) {
                check_mends(gyro, accel, &m[k]);
                if (k > 0)
                    assert_true(m[k].mistakes[0] + m[k].mistakes[1] >=
                                m[k - 1].mistakes[0] + m[k - 1].mistakes[1]);
            }
        }
    /* Renamed by a rotation, and each with all accelerometers inverted: not to be seen. */
    assert_int_equal(sound, 48);
}

/* Mending of a log whose gyros are P w and accelerometers A f. */
static size_t mendings(int gyro, int accel, imk_axes_mending *m)
{
    return imk_axes_mendings(UINT64_C(1) << class_of(gyro, accel), m);
}

/* Permutation numbers: bits 0, 1, 2 are the signs of x, y, z; 24 exchanges x and y. */
static void simple_mistakes_are_counted(void **state)
{
    (void)state;
    imk_axes_mending m[IMK_AXES_MENDINGS_MAX];
    assert_int_equal(mendings(1, 0, m), 1); /* gyro x inverted: nothing else */
    assert_int_equal(m[0].mistakes[0], 1);
    assert_int_equal(m[0].of[0].sign[0], -1);
    assert_int_equal(mendings(24, 0, m), 1); /* two gyros exchanged */
    assert_int_equal(m[0].of[0].column[0], 1);
    assert_int_equal(mendings(0, 24, m), 1);
    assert_int_equal(m[0].mistakes[1], 1);
    /* Two gyros inverted, or one accelerometer, or the other two accelerometers. */
    assert_int_equal(mendings(3, 0, m), 3);
    assert_int_equal(m[0].mistakes[1], 1);
    assert_int_equal(m[0].of[1].sign[2], -1);
    assert_int_equal(m[1].mistakes[0] + m[1].mistakes[1], 2);
    /* Left-handed: an axis of both, two axes of both exchanged, or all gyros. */
    assert_int_equal(mendings(7, 0, m), 7);
    assert_int_equal(mendings(4, 4, m), 7);
    assert_int_equal(m[6].mistakes[0], 3);
    /* All accelerometers inverted, or all axes turned: looks sound. */
    assert_int_equal(mendings(0, 7, m), 0);
    assert_int_equal(mendings(8, 8, m), 0);
    assert_int_equal(imk_axes_mendings(0, m), 0);
    /* Where turns tell less, the simplest of all classes come first. */
    const uint64_t both = UINT64_C(1) << class_of(1, 0) | UINT64_C(1) << class_of(3, 0);
    assert_int_equal(imk_axes_mendings(both, m), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(permutations_are_all_there),
        cmocka_unit_test(every_pair_is_mended),
        cmocka_unit_test(simple_mistakes_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
