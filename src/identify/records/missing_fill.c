/* SPDX-License-Identifier: Apache-2.0 */
/* Missing samples given the present ones and a spectrum.
 *
 * With C the orthonormal cosine transform and v_k the expected square of coefficient k, the record
 * has the precision P = C^T diag(1/v) C (1/v_0 = 0: any mean). What is missing, m, given what is
 * present, p, is Gaussian:
 *
 *     mean        x_m = -P_mm^-1 P_mp y_p
 *     covariance  P_mm^-1
 *
 * Both systems are solved by conjugate gradients [HESTENES1952]; a product with P is two cosine
 * transforms. A draw of the covariance needs no factor: g = C^T v^(-1/2) xi of white xi has the
 * covariance P, so that P_mm^-1 g_m has P_mm^-1.
 *
 * Scattered missing samples make P_mm nearly diagonal. In long gaps it is as badly conditioned as
 * the spectrum is wide above 1/gap; where it is wide, the covariance of the missing samples,
 * (C^T diag(v) C)_mm, which is the inverse but for the gaps' ends, preconditions. */
#include "missing_internal.h"

#include "imukit/fourier.h"

#include <math.h>
#include <string.h>

/* Conjugate gradients stop here at the latest; what is reached by then is used. */
enum { STEPS_MAX = 200 };

/* Preconditioned with the covariance above these; at 10, steps are about as many as half of those
 * without. */
static const double BRIDGED_GAP = 16, BRIDGED_RATIO = 10;

/* scratch <- C^T diag(v^power) C scratch, power 1 or -1; coefficient 0 is dropped for -1, and for 1
 * taken to have the variance of the first. */
static void filter_scratch(const imki_fill *fill, int power)
{
    double *c = fill->scratch;
    (void)imk_cosine(fill->n, c, fill->transform, fill->transform_size); /* sized for it */
    if (power < 0) {
        c[0] = 0;
        for (size_t k = 1; k < fill->n; k++)
            c[k] /= fill->variance[k];
    } else {
        c[0] *= fill->variance[1];
        for (size_t k = 1; k < fill->n; k++)
            c[k] *= fill->variance[k];
    }
    (void)imk_cosine_inverse(fill->n, c, fill->transform, fill->transform_size);
}

static void scatter(const imki_fill *fill, const double *vector)
{
    memset(fill->scratch, 0, fill->n * sizeof *fill->scratch);
    for (size_t i = 0; i < fill->missing; i++)
        fill->scratch[fill->index[i]] = vector[i];
}

/* The preconditioned residual at missing sample i, with imki_fill.scratch as left by
 * precondition(). */
static inline double conditioned(const imki_fill *fill, size_t i, double diagonal)
{
    return fill->bridge ? fill->scratch[fill->index[i]] : fill->residual[i] * diagonal;
}

static double precondition(const imki_fill *fill, double diagonal)
{
    double energy = 0;
    if (fill->bridge) {
        scatter(fill, fill->residual);
        filter_scratch(fill, 1);
    }
    for (size_t i = 0; i < fill->missing; i++)
        energy += fill->residual[i] * conditioned(fill, i, diagonal);
    return energy;
}

/* Diagonal of the inverse precision: harmonic mean of the variances. Their mean above 1/gap is so
 * many times larger when the covariance pays, which doubles the cost of a step. */
static double choose_preconditioner(imki_fill *fill)
{
    const double first = (double)fill->n / fill->gap;
    double inverse = 0, sum = 0, count = 0;
    for (size_t k = 1; k < fill->n; k++) {
        inverse += 1 / fill->variance[k];
        sum += (double)k > first ? fill->variance[k] : 0;
        count += (double)k > first;
    }
    const double harmonic = (double)fill->n / inverse;
    fill->bridge = fill->gap >= BRIDGED_GAP && sum > BRIDGED_RATIO * harmonic * count;
    return harmonic;
}

/* P_mm solution = residual, from zero. The energy r P_mm^-1 r of the error is about r M r, and the
 * missing samples themselves have one unit each. */
static void solve(imki_fill *fill)
{
    const size_t count = fill->missing;
    const double diagonal = choose_preconditioner(fill);
    const double enough = fill->tolerance * fill->tolerance * (double)count;
    memset(fill->solution, 0, count * sizeof *fill->solution);
    double energy = precondition(fill, diagonal);
    for (size_t i = 0; i < count; i++)
        fill->direction[i] = conditioned(fill, i, diagonal);
    for (int step = 0; step < STEPS_MAX && energy > enough && energy < HUGE_VAL; step++) {
        double curvature = 0;
        scatter(fill, fill->direction);
        filter_scratch(fill, -1);
        for (size_t i = 0; i < count; i++)
            curvature += fill->direction[i] * fill->scratch[fill->index[i]];
        if (!(curvature > 0))
            break;
        const double length = energy / curvature;
        for (size_t i = 0; i < count; i++) {
            fill->solution[i] += length * fill->direction[i];
            fill->residual[i] -= length * fill->scratch[fill->index[i]];
        }
        const double next = precondition(fill, diagonal);
        for (size_t i = 0; i < count; i++)
            fill->direction[i] =
                conditioned(fill, i, diagonal) + next / energy * fill->direction[i];
        energy = next;
        fill->steps++;
    }
}

void imki_fill_correction(imki_fill *fill)
{
    filter_scratch(fill, -1);
    for (size_t i = 0; i < fill->missing; i++)
        fill->residual[i] = -fill->scratch[fill->index[i]];
    solve(fill);
}

void imki_fill_mean(imki_fill *fill, double *samples)
{
    memcpy(fill->scratch, samples, fill->n * sizeof *samples);
    imki_fill_correction(fill);
    for (size_t i = 0; i < fill->missing; i++)
        samples[fill->index[i]] += fill->solution[i];
}

void imki_fill_draw(imki_fill *fill, imk_random random, uint64_t stream)
{
    imk_random_normals(random, stream, 0, fill->n, fill->scratch);
    fill->scratch[0] = 0;
    for (size_t k = 1; k < fill->n; k++)
        fill->scratch[k] /= sqrt(fill->variance[k]);
    (void)imk_cosine_inverse(fill->n, fill->scratch, fill->transform, fill->transform_size);
    for (size_t i = 0; i < fill->missing; i++)
        fill->residual[i] = fill->scratch[fill->index[i]];
    solve(fill);
}

void imki_fill_coefficients(imki_fill *fill)
{
    scatter(fill, fill->solution);
    (void)imk_cosine(fill->n, fill->scratch, fill->transform, fill->transform_size);
}
