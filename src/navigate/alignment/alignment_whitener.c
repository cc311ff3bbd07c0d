/* SPDX-License-Identifier: Apache-2.0 */
/* Which rotation C takes measured velocities V_i, in inertial axes that were the body's at the
 * start, to those gravity gives, V_r, if their difference
 *
 *     V_i - C^T V_r = x1 + white,   x1' = x2 + white,   x2' = x3 + white,   x3' = white
 *
 * is the same kind of noise along each axis; what is compared are means over epochs. A Kalman
 * filter of this noise makes its innovations white; it is linear, so that V_i and V_r go through it
 * each for itself, and the likelihood of C is
 *
 *     -1/2 sum |w_i - C^T w_r|^2/S = tr(C sum w_i w_r^T/S) + terms without C:
 *
 * Wahba's problem [WAHBA1965], whatever the noise, solved exactly by the largest eigenvector of a
 * 4 x 4 matrix [DAVENPORT1968]. The velocity at the start is not known: the first epoch sets x1.
 *
 * An error of C by (I + [p x]) leaves p x w_r, so its information is sum (|w_r|^2 I - w_r w_r^T)/S.
 *
 * V_i grows with g t and what is sought is far less, so it is kept as difference to what a coarse
 * rotation B expects, d = V_i - B V_r; all sums can be moved to a better one (rebase). */
#include "alignment_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>

enum { AVERAGE, VELOCITY, FORCE, GROWTH };

void imki_velocity_added(const imki_velocity_noise *noise, double step, double q[4][4])
{
    const double h = step, h2 = h * h, h3 = h * h2, h4 = h2 * h2, h5 = h2 * h3;
    const double f = noise->force, t = noise->turn + noise->forced, w = noise->walk;
    q[AVERAGE][AVERAGE] = f * h / 3.0 + t * h3 / 20.0 + w * h5 / 252.0;
    q[AVERAGE][VELOCITY] = q[VELOCITY][AVERAGE] = f * h / 2.0 + t * h3 / 8.0 + w * h5 / 72.0;
    q[AVERAGE][FORCE] = q[FORCE][AVERAGE] = t * h2 / 6.0 + w * h4 / 30.0;
    q[AVERAGE][GROWTH] = q[GROWTH][AVERAGE] = w * h3 / 24.0;
    q[VELOCITY][VELOCITY] = f * h + t * h3 / 3.0 + w * h5 / 20.0;
    q[VELOCITY][FORCE] = q[FORCE][VELOCITY] = t * h2 / 2.0 + w * h4 / 8.0;
    q[VELOCITY][GROWTH] = q[GROWTH][VELOCITY] = w * h3 / 6.0;
    q[FORCE][FORCE] = t * h + w * h3 / 3.0;
    q[FORCE][GROWTH] = q[GROWTH][FORCE] = w * h2 / 2.0;
    q[GROWTH][GROWTH] = w * h;
}

/* Of the mean of velocity over the epoch and of the three states at its end, from the three at its
 * start: F p F^T and what white noise adds. */
static void predict_covariance(const imki_whitener *w, double step, double p[4][4])
{
    const double h = step, f[4][3] = {{1.0, 0.5 * h, h * h * (1.0 / 6)},
                                      {1.0, h, 0.5 * h * h},
                                      {0.0, 1.0, h},
                                      {0.0, 0.0, 1.0}};
    double half[4][3] = {{0}};
    imki_velocity_added(&w->noise, step, p);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                half[i][j] += f[i][k] * w->p[k][j];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                p[i][j] += half[i][k] * f[j][k];
}

/* State at the end of the epoch, corrected by what its mean says. @return the innovation */
static inline imk_vector3 advance_state(double step, const double gain[3], imk_vector3 mean,
                                        imk_vector3 state[3])
{
    const double h = step;
    imk_vector3 innovation;
    for (int axis = 0; axis < 3; axis++) {
        const double v = state[0].v[axis], f = state[1].v[axis], g = state[2].v[axis];
        const double w = mean.v[axis] - (v + h * (0.5 * f + h * g * (1.0 / 6)));
        state[0].v[axis] = v + h * (f + 0.5 * h * g) + gain[0] * w;
        state[1].v[axis] = f + h * g + gain[1] * w;
        state[2].v[axis] = g + gain[2] * w;
        innovation.v[axis] = w;
    }
    return innovation;
}

/* Nothing is known of the velocity at the start: the first mean gives it, with the errors of that
 * mean instead of its own. */
static void start_filter(imki_whitener *w, double step, imk_vector3 reference,
                         imk_vector3 difference)
{
    double p[4][4];
    w->p[2][2] = w->noise.growth;
    predict_covariance(w, step, p);
    for (int j = 0; j < 4; j++)
        p[VELOCITY][j] -= p[AVERAGE][j];
    for (int i = 0; i < 4; i++)
        p[i][VELOCITY] -= p[i][AVERAGE];
    p[VELOCITY][VELOCITY] += w->noise.epoch;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            w->p[i][j] = p[i + 1][j + 1];
    w->reference[0] = reference;
    w->difference[0] = difference;
}

void imki_whitener_add(imki_whitener *whitener, double step, imk_vector3 reference,
                       imk_vector3 difference)
{
    imki_whitener *w = whitener;
    if (w->count++ == 0) {
        start_filter(w, step, reference, difference);
        return;
    }
    double p[4][4];
    predict_covariance(w, step, p);
    const double variance = p[AVERAGE][AVERAGE] + w->noise.epoch, weight = 1.0 / variance;
    const double gain[3] = {p[VELOCITY][AVERAGE] * weight, p[FORCE][AVERAGE] * weight,
                            p[GROWTH][AVERAGE] * weight};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            w->p[i][j] = p[i + 1][j + 1] - gain[i] * p[AVERAGE][j + 1];
    const imk_vector3 r = advance_state(step, gain, reference, w->reference);
    const imk_vector3 d = advance_state(step, gain, difference, w->difference);
    w->log_variance += imk_ln(variance);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            w->known[i][j] += weight * r.v[i] * r.v[j];
            w->mixed[i][j] += weight * r.v[i] * d.v[j];
            w->rest[i][j] += weight * d.v[i] * d.v[j];
        }
    }
}

/* Products of d - D r by themselves: rest - D mixed - (D mixed)^T + D known D^T. */
static void rest_with(const imki_whitener *f, const imk_matrix3 *change, double rest[3][3])
{
    imk_matrix3 mixed, known;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            mixed.m[i][j] = f->mixed[i][j];
            known.m[i][j] = f->known[i][j];
        }
    }
    const imk_matrix3 turned = imk_matrix3_multiply(*change, mixed);
    const imk_matrix3 both =
        imk_matrix3_multiply(imk_matrix3_multiply(*change, known), imk_matrix3_transpose(*change));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rest[i][j] = f->rest[i][j] - turned.m[i][j] - turned.m[j][i] + both.m[i][j];
}

void imki_whitener_rebase(imki_whitener *whitener, const imk_matrix3 *change)
{
    imki_whitener *f = whitener;
    double rest[3][3];
    rest_with(f, change, rest);
    for (int i = 0; i < 3; i++) {
        f->difference[i] =
            imk_vector3_subtract(f->difference[i], imk_matrix3_apply(*change, f->reference[i]));
        for (int j = 0; j < 3; j++) {
            f->rest[i][j] = rest[i][j];
            for (int k = 0; k < 3; k++)
                f->mixed[i][j] -= f->known[i][k] * change->m[j][k];
        }
    }
}

/* The rotation A that makes tr(A B^T) largest: its quaternion is the eigenvector of the largest
 * eigenvalue of [tr B, z^T; z, B + B^T - tr B I], z the axial vector of B - B^T. */
static imk_status best_rotation(const imk_matrix3 *b, imk_matrix3 *rotation)
{
    const double trace = b->m[0][0] + b->m[1][1] + b->m[2][2];
    double k[16], value[4], vector[16];
    k[0] = trace;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        k[i + 1] = k[4 * (i + 1)] = b->m[l][j] - b->m[j][l];
        for (int c = 0; c < 3; c++)
            k[4 * (i + 1) + c + 1] = b->m[i][c] + b->m[c][i] - (i == c ? trace : 0.0);
    }
    const imk_status status = imk_symmetric_eigen(4, k, value, vector);
    if (status != IMK_OK)
        return status;
    const imk_quaternion q = {vector[3], vector[7], vector[11], vector[15]};
    *rotation = imk_quaternion_to_matrix(imk_quaternion_normalise(q));
    return IMK_OK;
}

/* How far gravity was seen to turn, over how far it did: the part of the measured products along
 * the second principal direction of the known ones that is across the first. */
static double turn_ratio(const imk_matrix3 *measured, const double *value, const double *vector)
{
    imk_vector3 seen[2];
    for (int n = 0; n < 2; n++)
        for (int j = 0; j < 3; j++) {
            seen[n].v[j] = 0.0;
            for (int i = 0; i < 3; i++)
                seen[n].v[j] += measured->m[i][j] * vector[3 * i + 2 - n];
        }
    const double first = imk_vector3_norm(seen[0]);
    const double across = imk_vector3_norm(imk_vector3_cross(seen[0], seen[1])) / first;
    return across / value[1] * (value[2] / first);
}

imk_status imki_whitener_fit(const imki_whitener *whitener, const imk_matrix3 *coarse,
                             imki_velocity_fit *fit)
{
    const imki_whitener *f = whitener;
    imk_matrix3 measured; /* sum of w_r w_i^T */
    double known[9], value[3], vector[9], total = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            known[3 * i + j] = f->known[i][j];
            measured.m[i][j] = f->mixed[i][j];
            for (int k = 0; k < 3; k++)
                measured.m[i][j] += f->known[i][k] * coarse->m[j][k];
        }
        total += f->known[i][i];
    }
    if (imk_symmetric_eigen(3, known, value, vector) != IMK_OK ||
        best_rotation(&measured, &fit->rotation) != IMK_OK)
        return IMK_ERROR_SINGULAR;
    fit->rate_ratio = turn_ratio(&measured, value, vector);
    if (!(fit->rate_ratio > 1e-6 && isfinite(fit->rate_ratio)))
        return IMK_ERROR_SINGULAR;

    /* A common scale of force is not an error of attitude. */
    const imk_matrix3 back = imk_matrix3_transpose(fit->rotation);
    imk_matrix3 change;
    fit->scale = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            fit->scale += back.m[i][j] * measured.m[j][i] / total;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            change.m[i][j] = fit->scale * back.m[i][j] - coarse->m[i][j];
            fit->information.m[i][j] = -f->known[i][j];
        }
    /* Of the diagonal the two others', not the trace less its own: about the vertical that would
     * be a small difference. */
    for (int i = 0; i < 3; i++)
        fit->information.m[i][i] =
            f->known[(i + 1) % 3][(i + 1) % 3] + f->known[(i + 2) % 3][(i + 2) % 3];
    double rest[3][3];
    rest_with(f, &change, rest);
    const imk_vector3 down =
        imk_matrix3_apply(back, (imk_vector3){{vector[2], vector[5], vector[8]}});
    fit->square = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            fit->square += ((i == j ? 1.0 : 0.0) - down.v[i] * down.v[j]) * rest[i][j];
    fit->change = change;
    return IMK_OK;
}
