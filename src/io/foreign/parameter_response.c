/* SPDX-License-Identifier: Apache-2.0 */
/* Between the matrices of other programs and the terms of the model.
 *
 *     reading = T v + b,   T_i = (1 + s_i) e_i + A_i + X_i
 *
 * with scale factor s, direction e, misalignment A and cross-axis response X of axis i. A matrix
 * tells only their sum: reading one gives scale factors and misalignment. */
#include "parameter_internal.h"

#include "base/algebra/vector_internal.h"

#include <math.h>
#include <string.h>

void imki_response_of(const imk_triad *triad, double matrix[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            matrix[i][j] = (1 + triad->scale_factor.fixed.value[i]) * triad->direction[i][j] +
                           triad->misalignment.value[i][j] + triad->cross_axis.value[i][j];
}

bool imki_is_identity(double matrix[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (matrix[i][j] != (i == j))
                return false;
    return true;
}

void imki_multiply(double a[3][3], double b[3][3], double product[3][3])
{
    double result[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    memcpy(product, result, sizeof result);
}

/* Misalignments are small angles; beyond this share of the diagonal, the axes are turned. */
static const double small_share = 0.5;

void imki_response_set(imki_parameters *p, imki_place place, imk_triad *triad, double matrix[3][3])
{
    bool small = true;
    for (int i = 0; i < 3; i++) {
        double length = imki_norm3(matrix[i]);
        if (!(length >= 0.05 && length <= 20)) {
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "",
                                     "a matrix near a rotation: rows of a length near 1");
            return;
        }
        for (int j = 0; j < 3; j++)
            small = small &&
                    (i == j ? matrix[i][i] > 0 : fabs(matrix[i][j]) <= small_share * matrix[i][i]);
    }
    memset(&triad->misalignment, 0, sizeof triad->misalignment);
    memset(&triad->cross_axis, 0, sizeof triad->cross_axis);
    for (int i = 0; i < 3; i++) {
        double length = imki_norm3(matrix[i]);
        triad->scale_factor.fixed.value[i] = (small ? matrix[i][i] : length) - 1;
        for (int j = 0; j < 3; j++) {
            triad->direction[i][j] = small ? i == j : matrix[i][j] / length;
            if (small && i != j)
                triad->misalignment.value[i][j] = matrix[i][j];
        }
    }
    if (!small)
        imki_note(p, false,
                  "the matrices turn the axes by large angles: the model has them as directions");
}

/* Gram-Schmidt on the rows: exact where the matrix is lower triangular already. */
bool imki_lower_and_rotation(double matrix[3][3], double lower[3][3], double rotation[3][3])
{
    memset(lower, 0, 9 * sizeof(double));
    for (int i = 0; i < 3; i++) {
        double rest[3] = {matrix[i][0], matrix[i][1], matrix[i][2]};
        for (int k = 0; k < i; k++) {
            const double *q = rotation[k];
            lower[i][k] = imki_dot3(rest, q);
            for (int j = 0; j < 3; j++)
                rest[j] -= lower[i][k] * q[j];
        }
        lower[i][i] = imki_norm3(rest);
        if (!(lower[i][i] > 1e-6))
            return false;
        for (int j = 0; j < 3; j++)
            rotation[i][j] = rest[j] / lower[i][i];
    }
    double across[3];
    imki_cross3(rotation[0], rotation[1], across);
    return imki_dot3(rotation[2], across) > 0;
}

/* ---- noise ----------------------------------------------------------------------------------- */

void imki_add_gauss_markov(imk_triad *triad, const double sigma[3], const double time[3])
{
    struct imk_gauss_markov_term term = {.sigma = {{0}, {0}}};
    if (!imki_any(sigma))
        return;
    memcpy(term.sigma.value, sigma, 3 * sizeof sigma[0]);
    for (int i = 0; i < 3; i++)
        term.correlation_time.value[i] = sigma[i] == 0 ? 0 : time[i];
    triad->noise.gauss_markov[triad->noise.gauss_markov_count++] = term;
}

void imki_first_gauss_markov(const imk_triad *triad, double sigma[3], double time[3])
{
    const struct imk_gauss_markov_term *term = &triad->noise.gauss_markov[0];
    for (int i = 0; i < 3; i++) {
        sigma[i] = triad->noise.gauss_markov_count > 0 ? term->sigma.value[i] : 0;
        time[i] = triad->noise.gauss_markov_count > 0 ? term->correlation_time.value[i] : 0;
    }
}

void imki_white_where_infinite(imki_parameters *p, imki_place place, imk_triad *triad, double rate,
                               const char *program, double sigma[3], double time[3])
{
    for (int i = 0; i < 3; i++) {
        if (sigma[i] != 0 && time[i] == 0)
            imki_parameter_refuse_at(p, place, IMK_ERROR_RANGE, "0",
                                     "a positive correlation time [s]");
        if (sigma[i] == 0 || !isinf(time[i]))
            continue;
        if (!(rate > 0)) {
            imki_parameter_refuse_at(
                p, place, IMK_ERROR_KEY_MISSING,
                "\"inf\" is white noise per sample, and the sampling rate is not known",
                "add --rate 100Hz (samples per second)");
            return;
        }
        double n = triad->noise.white.value[i];
        triad->noise.white.value[i] = sqrt(n * n + sigma[i] * sigma[i] / rate);
        sigma[i] = time[i] = 0;
        imki_note(p, false,
                  "%s: with an infinite correlation time %s draws a new drift for each sample: the "
                  "drift is taken as white noise",
                  place.field, program);
    }
}

double imki_largest(imki_parameters *p, const char *name, const imk_axes *axes)
{
    double largest = fmax(axes->value[0], fmax(axes->value[1], axes->value[2]));
    double smallest = fmin(axes->value[0], fmin(axes->value[1], axes->value[2]));
    if (smallest != largest)
        imki_note(p, true, "%s is one number for all axes: the largest of the three is written",
                  name);
    return largest;
}

void imki_densities_read(imki_parameters *p, int mapping, const char *const keys[IMKI_DENSITIES],
                         const imki_unit units[IMKI_DENSITIES])
{
    for (int i = 0; i < IMKI_DENSITIES; i++) {
        imk_noise *noise = &p->triad[i / 2]->noise;
        const bool white = i % 2 == 0;
        imki_node_accept(p, mapping, keys[i], i / 2, white ? IMKI_WHITE : IMKI_RANDOM_WALK,
                         units[i], white ? noise->white.value : noise->random_walk.value);
    }
}

double imki_density(imki_parameters *p, int index, const char *key)
{
    const imk_noise *noise = &p->origin[index / 2]->noise;
    return imki_largest(p, key, index % 2 == 0 ? &noise->white : &noise->random_walk);
}
