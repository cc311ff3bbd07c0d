/* SPDX-License-Identifier: Apache-2.0 */
/* Frames of triads: what a turn of the body axes must keep, the covariance's map against
 * differences of the exact one, and comparing calibrations across frames. */
#include "check.h"

#include "calibrate/estimator/calibration_internal.h"
#include "calibrate/estimator_session.h"

static void response(const imk_triad *t, double r[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[i][j] = (1.0 + t->scale_factor.fixed.value[i]) * t->direction[i][j] +
                      t->misalignment.value[i][j] + t->cross_axis.value[i][j];
}

/* A unit with everything that has body axes, in no frame. */
static imk_model turned_unit(session *b)
{
    imk_model m = session_truth();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            if (i != j) {
                m.accel.misalignment.value[i][j] = 0.02 * session_normal(b);
                m.accel.cross_axis.value[i][j] = 0.005 * session_normal(b);
            }
            m.gyro.g_sensitivity.value[i][j] = 1e-3 * session_normal(b);
            m.accel.lever_arm.value[i][j] = 0.02 * session_normal(b);
            m.gyro.g2_sensitivity.value[i][j] = 1e-4 * session_normal(b);
            m.gyro.g2_sensitivity.value[i][3 + j] = 1e-4 * session_normal(b);
        }
    return m;
}

static double read_axis(const imk_model *m, int sensor, int axis, const double *v[3][3])
{
    imk_distortion d;
    imk_stimulus s;
    double value;
    memset(&s, 0, sizeof s);
    for (int j = 0; j < 3; j++) {
        s.angular_rate[j] = v[0][j];
        s.specific_force[j] = v[1][j];
        s.angular_acceleration[j] = v[2][j];
    }
    CHECK_OK(imk_distortion_start(&d, m, NULL, IMK_KERNEL_SCALAR, NULL));
    imk_distort(&d, sensor, axis, &s, 1, &value);
    return value;
}

/* The unit reads the same whatever the axes are called. */
static void readings_stay(void **state)
{
    (void)state;
    session *b = session_new(1, 2);
    for (int round = 0; round < 12; round++) {
        const imk_model old = turned_unit(b);
        imk_model new = old;
        double c[9], v[3][3], turned[3][3];
        const double *of_old[3][3], *of_new[3][3];
        CHECK_OK(imk_triad_frame_convert(&new, (imk_triad_frame)(round % 3), 0, NULL, NULL, c));
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                v[k][j] = session_normal(b) * (k == 1 ? 8.0 : 1.0);
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++) {
                turned[k][j] = c[3 * j] * v[k][0] + c[3 * j + 1] * v[k][1] + c[3 * j + 2] * v[k][2];
                of_old[k][j] = &v[k][j];
                of_new[k][j] = &turned[k][j];
            }
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < 3; axis++) /* rounding of sums of some 20 terms of 10 */
                CHECK_CLOSE(read_axis(&new, sensor, axis, of_new),
                            read_axis(&old, sensor, axis, of_old), 1e-13);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double product = 0.0;
                for (int k = 0; k < 3; k++)
                    product += c[3 * i + k] * c[3 * j + k];
                CHECK_CLOSE(product, i == j ? 1.0 : 0.0, 1e-15 * 4.0);
            }
    }
    session_free(b);
}

static void forms_are_as_named(void **state)
{
    (void)state;
    session *b = session_new(2, 2);
    for (int round = 0; round < 12; round++) {
        imk_model m = turned_unit(b);
        double r[3][3];
        const imk_triad_frame frame = (imk_triad_frame)(round % 3);
        CHECK_OK(imk_triad_frame_convert(&m, frame, 0, NULL, NULL, NULL));
        response(&m.accel, r);
        for (int i = 0; i < 3; i++) {
            assert_true(r[i][i] > 0.0);
            for (int j = i + 1; j < 3; j++)
                CHECK_CLOSE(frame == IMK_FRAME_UPPER   ? r[j][i]
                            : frame == IMK_FRAME_LOWER ? r[i][j]
                                                       : r[i][j] - r[j][i],
                            0.0, 1e-15);
        }
        /* A second time nothing changes. */
        imk_model again = m;
        CHECK_OK(imk_triad_frame_convert(&again, frame, 0, NULL, NULL, NULL));
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                CHECK_CLOSE(again.gyro.misalignment.value[i][j], m.gyro.misalignment.value[i][j],
                            1e-15);
    }
    session_free(b);
}

/* V' = T V T^T with T by central differences of the exact conversion, near the identity: the map is
 * of first order in the misalignments, here 1e-4. */
static void covariances_follow(void **state)
{
    (void)state;
    enum { N = 12 };
    session *b = session_new(3, 2);
    imk_model_parameter parameter[N];
    size_t n = 0;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                if (i != j)
                    parameter[n++] = (imk_model_parameter){(uint8_t)sensor, IMK_MODEL_MISALIGNMENT,
                                                           (uint8_t)i, (uint8_t)j};
    for (int frame = 0; frame < 3; frame++) {
        imk_model m;
        imk_model_default(&m);
        for (int p = 0; p < N; p++)
            *imk_model_parameter_at(&m, parameter[p], NULL) = 1e-4 * session_normal(b);
        double root[N][N], v[N * N], t[N][N];
        for (int p = 0; p < N; p++)
            for (int q = 0; q < N; q++)
                root[p][q] = session_normal(b);
        for (int p = 0; p < N; p++)
            for (int q = 0; q < N; q++) {
                v[p * N + q] = 0.0;
                for (int k = 0; k < N; k++)
                    v[p * N + q] += root[p][k] * root[q][k];
            }
        for (int q = 0; q < N; q++) {
            imk_model up = m, down = m;
            *imk_model_parameter_at(&up, parameter[q], NULL) += 1e-4;
            *imk_model_parameter_at(&down, parameter[q], NULL) -= 1e-4;
            CHECK_OK(imk_triad_frame_convert(&up, (imk_triad_frame)frame, 0, NULL, NULL, NULL));
            CHECK_OK(imk_triad_frame_convert(&down, (imk_triad_frame)frame, 0, NULL, NULL, NULL));
            for (int p = 0; p < N; p++)
                t[p][q] = (imk_model_parameter_get(&up, parameter[p]) -
                           imk_model_parameter_get(&down, parameter[p])) /
                          2e-4;
        }
        double expected[N][N];
        for (int p = 0; p < N; p++)
            for (int q = 0; q < N; q++) {
                expected[p][q] = 0.0;
                for (int k = 0; k < N; k++)
                    for (int l = 0; l < N; l++)
                        expected[p][q] += t[p][k] * v[k * N + l] * t[q][l];
            }
        CHECK_OK(imk_triad_frame_convert(&m, (imk_triad_frame)frame, N, parameter, v, NULL));
        for (int p = 0; p < N; p++)
            for (int q = 0; q < N; q++) /* of elements up to 40 */
                CHECK_CLOSE(v[p * N + q], expected[p][q], 0.03);
    }
    session_free(b);
}

/* Solving in the symmetric frame is solving in the upper triangular one and converting. */
static void symmetric_solution_is_the_same_unit(void **state)
{
    (void)state;
    session *a = session_new(4, 2), *b = session_new(4, 2);
    session *both[2] = {a, b};
    b->calibration.frame = IMK_FRAME_SYMMETRIC;
    for (int k = 0; k < 2; k++) {
        session_free_static(both[k]);
        for (int i = 0; i < 24; i++)
            session_pose(both[k], 1.0);
        CHECK_OK(session_solve(both[k]));
    }
    assert_string_equal(a->result.model.accel_evidence.frame, "upper-triangular");
    assert_string_equal(b->result.model.gyro_evidence.frame, "symmetric");
    assert_int_equal(b->result.parameter_count, a->result.parameter_count + 3);
    imk_model converted = a->result.model;
    double rotation[9];
    CHECK_OK(imk_triad_frame_convert(&converted, IMK_FRAME_SYMMETRIC, 0, NULL, NULL, rotation));
    for (size_t p = 0; p < b->result.parameter_count; p++) {
        const imk_model_parameter place = b->result.parameter[p];
        CHECK_CLOSE(b->result.value[p], imk_model_parameter_get(&converted, place), 1e-14);
        assert_true(b->result.sigma[p] > 0.0 && b->result.freedom[p] > 1.0);
        for (size_t q = 0; place.term == IMK_MODEL_MISALIGNMENT && q < p; q++)
            if (b->result.parameter[q].term == place.term &&
                b->result.parameter[q].axis == place.element &&
                b->result.parameter[q].element == place.axis) {
                CHECK_CLOSE(b->result.value[p], b->result.value[q], 1e-15);
                CHECK_RELATIVE(b->result.sigma[p], b->result.sigma[q], 1e-12);
            }
    }
    /* The verticals are in the axes of the result. */
    for (int j = 0; j < 3; j++) {
        const double *v = a->observation[0].vertical;
        CHECK_CLOSE(b->observation[0].vertical[j],
                    rotation[3 * j] * v[0] + rotation[3 * j + 1] * v[1] +
                        rotation[3 * j + 2] * v[2],
                    1e-12);
    }

    /* Compared, the two are one unit. */
    double angles[3], difference[IMK_CORRELATED_MAX], sigma[IMK_CORRELATED_MAX];
    imk_model turned;
    CHECK_OK(imk_calibration_compare(&a->result.model, &b->result.model, a->result.parameter_count,
                                     a->result.parameter, &turned, angles, difference, sigma,
                                     NULL));
    for (size_t p = 0; p < a->result.parameter_count; p++)
        CHECK_CLOSE(difference[p], 0.0, 1e-6 * sigma[p]);
    session_free(a);
    session_free(b);
}

/* A unit turned by known angles: they are found, and nothing is left. */
static void comparison_finds_the_rotation(void **state)
{
    (void)state;
    session *b = session_new(5, 2);
    const imk_model a = turned_unit(b);
    imk_model turned = a, back;
    static const double angles[3] = {.02, -.01, .03};
    const imk_matrix3 c = imk_quaternion_to_matrix(
        imk_quaternion_from_rotation_vector((imk_vector3){{angles[0], angles[1], angles[2]}}));
    assert_true(imki_turn_model(&turned, (const double(*)[3])c.m));
    static const imk_model_parameter parameter[4] = {{0, IMK_MODEL_MISALIGNMENT, 0, 1},
                                                     {1, IMK_MODEL_MISALIGNMENT, 2, 0},
                                                     {1, IMK_MODEL_SCALE_FACTOR, 1, 0},
                                                     {0, IMK_MODEL_LEVER_ARM, 0, 0}};
    double found[3], difference[4], sigma[4];
    CHECK_OK(
        imk_calibration_compare(&a, &turned, 4, parameter, &back, found, difference, sigma, NULL));
    for (int j = 0; j < 3; j++) /* sums of three rotations: products of angles */
        CHECK_CLOSE(found[j], angles[j], 1e-3);
    for (int p = 0; p < 3; p++) /* fourth order of the angles is left after three rounds */
        CHECK_CLOSE(difference[p], 0.0, 1e-6);
    assert_true(isnan(difference[3]) && isnan(sigma[3])); /* gyros have no places */
    session_free(b);
}

/* Two units of one convention that differ in nothing but a misalignment: no rotation may take it
 * for one of the body. From another convention the same difference, and its sigma, are found. */
static void comparison_keeps_real_differences(void **state)
{
    (void)state;
    static const imk_model_parameter parameter[4] = {{1, IMK_MODEL_MISALIGNMENT, 0, 1},
                                                     {1, IMK_MODEL_MISALIGNMENT, 0, 2},
                                                     {1, IMK_MODEL_MISALIGNMENT, 1, 2},
                                                     {0, IMK_MODEL_MISALIGNMENT, 1, 0}};
    imk_model a = session_truth();
    imk_triad *triads[2] = {&a.gyro, &a.accel};
    for (int p = 0; p < 4; p++)
        triads[parameter[p].sensor]->misalignment.sigma[parameter[p].axis][parameter[p].element] =
            1e-4 * (p + 1);
    strcpy(a.accel_evidence.frame, "upper-triangular");
    imk_model b = a;
    b.accel.misalignment.value[0][1] += 2e-3;
    double angles[3], difference[4], sigma[4];
    imk_model turned;
    for (int frame = 0; frame < IMK_FRAME_REFERENCE; frame++) {
        imk_model other = b;
        double rotation[9];
        if (frame != IMK_FRAME_UPPER) {
            enum { N = 9 };
            imk_model_parameter all[N];
            double covariance[N * N] = {0.0};
            size_t count = 0;
            for (unsigned k = 0; k < 9; k++)
                if (k % 4 != 0)
                    all[count++] = (imk_model_parameter){1, IMK_MODEL_MISALIGNMENT,
                                                         (uint8_t)(k / 3), (uint8_t)(k % 3)};
            all[count++] = parameter[3];
            for (size_t p = 0; p < count; p++) {
                double *s;
                (void)imk_model_parameter_at(&other, all[p], &s);
                covariance[p * count + p] = *s * *s;
            }
            CHECK_OK(imk_triad_frame_convert(&other, (imk_triad_frame)frame, count, all, covariance,
                                             rotation));
            other.correlation.count = (int)count;
            for (size_t p = 0; p < count; p++) {
                double *s;
                (void)imk_model_parameter_at(&other, all[p], &s);
                *s = sqrt(covariance[p * count + p]);
                other.correlation.parameter[p] = all[p];
                for (size_t q = 0; q < p; q++) {
                    const double both = sqrt(covariance[p * count + p] * covariance[q * count + q]);
                    other.correlation.value[p * (p - 1) / 2 + q] =
                        both > 0.0 ? (float)(covariance[p * count + q] / both) : 0.0f;
                }
            }
            strcpy(other.accel_evidence.frame, imk_triad_frame_name((imk_triad_frame)frame));
        }
        CHECK_OK(imk_calibration_compare(&a, &other, 4, parameter, &turned, angles, difference,
                                         sigma, NULL));
        CHECK_CLOSE(difference[0], 2e-3, 1e-12);
        for (int p = 1; p < 4; p++)
            CHECK_CLOSE(difference[p], 0.0, 1e-12);
        for (int p = 0; p < 4; p++) /* correlations are floats */
            CHECK_RELATIVE(sigma[p], sqrt(2.0) * 1e-4 * (p + 1), 1e-5);
        /* C is to first order I - [psi x], so that R' = R + [psi x]. */
        for (int j = 0; j < 3; j++)
            CHECK_CLOSE(angles[j],
                        frame == IMK_FRAME_UPPER
                            ? 0.0
                            : -0.5 * (rotation[3 * ((j + 1) % 3) + (j + 2) % 3] -
                                      rotation[3 * ((j + 2) % 3) + (j + 1) % 3]),
                        1e-6);
    }
}

static void frames_need_a_triad(void **state)
{
    (void)state;
    imk_model m;
    imk_model_default(&m);
    m.accel.present = false;
    CHECK_STATUS(imk_triad_frame_convert(&m, IMK_FRAME_UPPER, 0, NULL, NULL, NULL),
                 IMK_ERROR_CONFLICT);
    imk_model_default(&m);
    CHECK_STATUS(imk_triad_frame_convert(&m, IMK_FRAME_REFERENCE, 0, NULL, NULL, NULL),
                 IMK_ERROR_ARGUMENT);
    memcpy(m.accel.direction[1], m.accel.direction[0], sizeof m.accel.direction[0]);
    CHECK_STATUS(imk_triad_frame_convert(&m, IMK_FRAME_UPPER, 0, NULL, NULL, NULL),
                 IMK_ERROR_SINGULAR);
    assert_string_equal(imk_triad_frame_name(IMK_FRAME_SYMMETRIC), "symmetric");
    assert_null(imk_triad_frame_name((imk_triad_frame)4));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_stay),
        cmocka_unit_test(forms_are_as_named),
        cmocka_unit_test(covariances_follow),
        cmocka_unit_test(symmetric_solution_is_the_same_unit),
        cmocka_unit_test(comparison_finds_the_rotation),
        cmocka_unit_test(comparison_keeps_real_differences),
        cmocka_unit_test(frames_need_a_triad),
    };
    return cmocka_run_group_tests_name("frames", tests, NULL, NULL);
}
