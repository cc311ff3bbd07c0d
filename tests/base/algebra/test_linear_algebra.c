/* SPDX-License-Identifier: Apache-2.0 */
/* Cholesky, QR and the symmetric eigenvalue problem: matrices with known factors, inverses and
 * eigenvalues, and the defining identities on random ones. Backward errors are a small multiple of
 * n eps |A| [HIGHAM2002]. */
#include "check.h"

#include "imukit/linear_algebra.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { N_MAX = 24 };

static double next_number(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53 - 0.5;
}

/* B B^T + n/20 of a random B: symmetric, definite, condition of a few hundred. */
static void random_definite(size_t n, uint64_t *state, double *a)
{
    double b[N_MAX * N_MAX];
    for (size_t i = 0; i < n * n; i++)
        b[i] = next_number(state);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            a[i * n + j] = i == j ? 0.05 * (double)n : 0.0;
            for (size_t k = 0; k < n; k++)
                a[i * n + j] += b[i * n + k] * b[j * n + k];
        }
    }
}

static double largest_difference(size_t count, const double *a, const double *b)
{
    double largest = 0.0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(a[i] - b[i]));
    return largest;
}

/* [4 12 -16; 12 37 -43; -16 -43 98] has the factor [2 0 0; 6 1 0; -8 5 3], exactly. */
static void cholesky_of_an_integer_matrix_is_exact(void **state)
{
    (void)state;
    /* What stands above the diagonal is not read. */
    double a[] = {4, -77, -77, 12, 37, -77, -16, -43, 98};
    const double factor[] = {2, 0, 0, 6, 1, 0, -8, 5, 3};
    double b[] = {0, 6, 39}; /* A (1, 1, 1)^T */
    CHECK_OK(imk_cholesky_factor(3, a));
    CHECK_CLOSE(largest_difference(9, a, factor), 0.0, 0.0);
    CHECK_RELATIVE(imk_cholesky_log_determinant(3, a), 2.0 * log(6.0), 1e-15);
    imk_cholesky_solve(3, a, b);
    for (int i = 0; i < 3; i++)
        CHECK_CLOSE(b[i], 1.0, 1e-14);
}

static void cholesky_identities_hold(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (size_t n = 1; n <= N_MAX; n++) {
        double a[N_MAX * N_MAX], l[N_MAX * N_MAX], inverse[N_MAX * N_MAX], x[N_MAX], b[N_MAX];
        random_definite(n, &random, a);
        memcpy(l, a, n * n * sizeof *a);
        CHECK_OK(imk_cholesky_factor(n, l));
        imk_cholesky_inverse(n, l, inverse);
        for (size_t i = 0; i < n; i++) {
            x[i] = next_number(&random);
            b[i] = 0.0;
        }
        for (size_t i = 0; i < n; i++) {
            for (size_t j = 0; j < n; j++) {
                double product = 0.0, unit = 0.0;
                for (size_t k = 0; k < n; k++) {
                    product += l[i * n + k] * l[j * n + k];
                    unit += a[i * n + k] * inverse[k * n + j];
                }
                CHECK_CLOSE(product, a[i * n + j], 4.0 * (double)n * DBL_EPSILON * (double)n);
                CHECK_CLOSE(unit, i == j ? 1.0 : 0.0, 1e-12);
                CHECK_CLOSE(inverse[i * n + j], inverse[j * n + i], 0.0);
                b[i] += a[i * n + j] * x[j];
            }
        }
        imk_cholesky_solve(n, l, b);
        CHECK_BELOW(largest_difference(n, b, x), 1e-12);
    }
}

static void cholesky_refuses_what_is_not_definite(void **state)
{
    (void)state;
    double indefinite[] = {1, 2, 2, 1}, zero[] = {0};
    double semidefinite[] = {0.1, 0.3, 0.3, 0.9};
    double not_a_number[] = {1, 0, (double)NAN, 1};
    CHECK_STATUS(imk_cholesky_factor(2, indefinite), IMK_ERROR_SINGULAR);
    CHECK_STATUS(imk_cholesky_factor(2, semidefinite), IMK_ERROR_SINGULAR);
    CHECK_STATUS(imk_cholesky_factor(1, zero), IMK_ERROR_SINGULAR);
    CHECK_STATUS(imk_cholesky_factor(2, not_a_number), IMK_ERROR_SINGULAR);
}

/* The inverse of the Hilbert matrix has integer elements; for n = 4 the corner is 16 and its
 * neighbour -120, and the determinant is 1/6048000. Its condition is 1.6e4. */
static void hilbert_matrix_has_its_integer_inverse(void **state)
{
    (void)state;
    const double exact[] = {16,  -120,  240,  -140,  -120, 1200, -2700, 1680,
                            240, -2700, 6480, -4200, -140, 1680, -4200, 2800};
    double a[16], inverse[16];
    for (int i = 0; i < 16; i++)
        a[i] = 1.0 / (i / 4 + i % 4 + 1);
    CHECK_OK(imk_cholesky_factor(4, a));
    imk_cholesky_inverse(4, a, inverse);
    CHECK_BELOW(largest_difference(16, inverse, exact), 6480 * 1.6e4 * 4 * DBL_EPSILON);
    CHECK_RELATIVE(imk_cholesky_log_determinant(4, a), -log(6048000.0), 1e-12);
}

/* R^T R = A^T A, the residual of the solution is orthogonal to the columns, and the covariance
 * inverts A^T A. */
static void qr_solves_least_squares(void **state)
{
    (void)state;
    uint64_t random = 2;
    for (size_t columns = 1; columns <= 9; columns++) {
        for (size_t rows = columns; rows <= N_MAX; rows += 5) {
            double a[N_MAX * 9], qr[N_MAX * 9], beta[9], b[N_MAX], rhs[N_MAX], x[9], c[81];
            for (size_t i = 0; i < rows * columns; i++)
                qr[i] = a[i] = next_number(&random) + (i % (columns + 1) == 0);
            for (size_t i = 0; i < rows; i++)
                rhs[i] = b[i] = next_number(&random);
            CHECK_OK(imk_qr_factor(rows, columns, qr, beta));
            CHECK_OK(imk_qr_solve(rows, columns, qr, beta, rhs, x));
            CHECK_OK(imk_qr_covariance(rows, columns, qr, c));
            for (size_t i = 0; i < rows; i++) {
                for (size_t j = 0; j < columns; j++)
                    b[i] -= a[i * columns + j] * x[j];
            }
            double gram[81];
            for (size_t i = 0; i < columns; i++) {
                double slope = 0.0;
                for (size_t k = 0; k < rows; k++)
                    slope += a[k * columns + i] * b[k];
                CHECK_CLOSE(slope, 0.0, 1e-12);
                for (size_t j = 0; j < columns; j++) {
                    double left = 0.0, right = 0.0;
                    for (size_t k = 0; k <= (i < j ? i : j); k++)
                        left += qr[k * columns + i] * qr[k * columns + j];
                    for (size_t k = 0; k < rows; k++)
                        right += a[k * columns + i] * a[k * columns + j];
                    CHECK_CLOSE(left, right, 1e-13);
                    gram[i * columns + j] = right;
                }
            }
            for (size_t i = 0; i < columns; i++) {
                for (size_t j = 0; j < columns; j++) {
                    double unit = 0.0;
                    for (size_t k = 0; k < columns; k++)
                        unit += gram[i * columns + k] * c[k * columns + j];
                    CHECK_CLOSE(unit, i == j ? 1.0 : 0.0, 1e-10);
                }
            }
        }
    }
}

/* The line of least squares through (0, 6), (1, 0), (2, 0) is 5 - 3 t. */
static void qr_fits_a_line(void **state)
{
    (void)state;
    double a[] = {1, 0, 1, 1, 1, 2}, beta[2], b[] = {6, 0, 0}, x[2], c[4];
    CHECK_OK(imk_qr_factor(3, 2, a, beta));
    CHECK_OK(imk_qr_solve(3, 2, a, beta, b, x));
    CHECK_CLOSE(x[0], 5.0, 1e-14);
    CHECK_CLOSE(x[1], -3.0, 1e-14);
    CHECK_CLOSE(fabs(b[2]), sqrt(6.0), 1e-14); /* the residual (1, -2, 1) */
    CHECK_OK(imk_qr_covariance(3, 2, a, c));
    CHECK_CLOSE(c[0], 5.0 / 6.0, 1e-15);
    CHECK_CLOSE(c[1], -0.5, 1e-15);
    CHECK_CLOSE(c[2], -0.5, 1e-15);
    CHECK_CLOSE(c[3], 0.5, 1e-15);
}

static void qr_refuses_bad_matrices(void **state)
{
    (void)state;
    double dependent[] = {1, 2, 2, 4, 3, 6}, beta[2], b[] = {1, 2, 3}, x[] = {7, 7}, c[4];
    CHECK_STATUS(imk_qr_factor(1, 2, dependent, beta), IMK_ERROR_ARGUMENT);
    CHECK_OK(imk_qr_factor(3, 2, dependent, beta));
    CHECK_STATUS(imk_qr_solve(3, 2, dependent, beta, b, x), IMK_ERROR_SINGULAR);
    CHECK_STATUS(imk_qr_covariance(3, 2, dependent, c), IMK_ERROR_SINGULAR);
    CHECK_CLOSE(x[0], 7.0, 0.0);
    double not_a_number[] = {1, (double)NAN, 2, 3};
    CHECK_STATUS(imk_qr_factor(2, 2, not_a_number, beta), IMK_ERROR_NOT_FINITE);
    double zero[] = {0, 0, 0, 0};
    CHECK_OK(imk_qr_factor(2, 2, zero, beta));
    CHECK_STATUS(imk_qr_solve(2, 2, zero, beta, b, x), IMK_ERROR_SINGULAR);
}

/* Squares that overflow or underflow are avoided. */
static void qr_works_at_the_ends_of_the_range(void **state)
{
    (void)state;
    for (int exponent = -1000; exponent <= 1000; exponent += 2000) {
        double a[] = {ldexp(3, exponent), ldexp(4, exponent)}, beta[1], b[] = {3, 4}, x[1];
        CHECK_OK(imk_qr_factor(2, 1, a, beta));
        CHECK_RELATIVE(fabs(a[0]), ldexp(5, exponent), 1e-15);
        CHECK_OK(imk_qr_solve(2, 1, a, beta, b, x));
        CHECK_RELATIVE(x[0], ldexp(1, -exponent), 1e-15);
    }
}

/* The second-difference matrix has the eigenvalues 2 - 2 cos(k pi/(n + 1)). */
static void eigenvalues_of_the_second_difference(void **state)
{
    (void)state;
    for (size_t n = 1; n <= N_MAX; n++) {
        double a[N_MAX * N_MAX] = {0}, values[N_MAX];
        for (size_t i = 0; i < n; i++) {
            a[i * n + i] = 2.0;
            if (i + 1 < n)
                a[i * n + i + 1] = a[(i + 1) * n + i] = -1.0;
        }
        CHECK_OK(imk_symmetric_eigen(n, a, values, NULL));
        for (size_t k = 0; k < n; k++) {
            const double s = sin(0.5 * (double)(k + 1) * 3.141592653589793 / (double)(n + 1));
            CHECK_RELATIVE(values[k], 4.0 * s * s, 1e-13);
        }
    }
}

static void eigenvectors_diagonalise(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (size_t n = 1; n <= N_MAX; n++) {
        double a[N_MAX * N_MAX], work[N_MAX * N_MAX], v[N_MAX * N_MAX], values[N_MAX];
        for (size_t i = 0; i < n; i++) {
            for (size_t j = 0; j <= i; j++)
                a[i * n + j] = a[j * n + i] = next_number(&random);
        }
        memcpy(work, a, n * n * sizeof *a);
        CHECK_OK(imk_symmetric_eigen(n, work, values, v));
        for (size_t k = 0; k < n; k++) {
            assert_true(k == 0 || values[k] >= values[k - 1]);
            for (size_t i = 0; i < n; i++) {
                double product = 0.0, overlap = 0.0;
                for (size_t j = 0; j < n; j++) {
                    product += a[i * n + j] * v[j * n + k];
                    overlap += v[j * n + i] * v[j * n + k];
                }
                CHECK_CLOSE(product, values[k] * v[i * n + k], 1e-13);
                CHECK_CLOSE(overlap, i == k ? 1.0 : 0.0, 1e-13);
            }
        }
    }
}

/* D H D with D = diag(1, 1e-5, 1e-10, 1e-15) and the matrix H of ones with 2 on the diagonal
 * (determinant 5): the product of the eigenvalues, 5e-60, is right only when the smallest, near
 * 1e-30, is right relative to itself. */
static void small_eigenvalues_are_accurate(void **state)
{
    (void)state;
    const double d[] = {1.0, 1e-5, 1e-10, 1e-15};
    double a[16], values[4];
    for (int i = 0; i < 16; i++)
        a[i] = d[i / 4] * d[i % 4] * (i / 4 == i % 4 ? 2.0 : 1.0);
    CHECK_OK(imk_symmetric_eigen(4, a, values, NULL));
    CHECK_RELATIVE(values[0] * values[1] * values[2] * values[3], 5e-60, 1e-13);
    /* To first order the ratios of leading minors of H, 2, 3, 4, 5. */
    CHECK_RELATIVE(values[0], 5.0 / 4.0 * 1e-30, 1e-9);
    CHECK_RELATIVE(values[3], 2.0, 1e-9);
}

static void special_matrices_have_eigenvalues(void **state)
{
    (void)state;
    double swap[] = {0, 1, 1, 0}, ones[25], zero[] = {0, 0, 0, 0}, values[5], v[25];
    CHECK_OK(imk_symmetric_eigen(2, swap, values, v));
    CHECK_CLOSE(values[0], -1.0, 1e-15);
    CHECK_CLOSE(values[1], 1.0, 1e-15);
    for (int i = 0; i < 25; i++)
        ones[i] = 1.0;
    CHECK_OK(imk_symmetric_eigen(5, ones, values, v));
    CHECK_CLOSE(values[4], 5.0, 1e-14);
    for (int i = 0; i < 4; i++)
        CHECK_CLOSE(values[i], 0.0, 1e-14);
    CHECK_OK(imk_symmetric_eigen(2, zero, values, v));
    CHECK_CLOSE(values[1], 0.0, 0.0);
    double not_a_number[] = {1, (double)NAN, (double)NAN, 1};
    CHECK_STATUS(imk_symmetric_eigen(2, not_a_number, values, v), IMK_ERROR_NOT_FINITE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cholesky_of_an_integer_matrix_is_exact),
        cmocka_unit_test(cholesky_identities_hold),
        cmocka_unit_test(cholesky_refuses_what_is_not_definite),
        cmocka_unit_test(hilbert_matrix_has_its_integer_inverse),
        cmocka_unit_test(qr_solves_least_squares),
        cmocka_unit_test(qr_fits_a_line),
        cmocka_unit_test(qr_refuses_bad_matrices),
        cmocka_unit_test(qr_works_at_the_ends_of_the_range),
        cmocka_unit_test(eigenvalues_of_the_second_difference),
        cmocka_unit_test(eigenvectors_diagonalise),
        cmocka_unit_test(small_eigenvalues_are_accurate),
        cmocka_unit_test(special_matrices_have_eigenvalues),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
