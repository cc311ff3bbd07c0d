/* SPDX-License-Identifier: Apache-2.0 */
/* Integrals of rate and force over a window. With r the rotation vector of a stretch of length h in
 * which both are constant, and f h its increment of velocity,
 *
 *     attitude   C <- C (1 + s1 [r x] + s2 [r x]^2)
 *     velocity   v <- v + C (1 + s2 [r x] + s3 [r x]^2) f h
 *
 *     s_n = sum over k of (-1)^k |r|^2k/(n + 2 k)!
 *
 * and of a sample the position, by the mean of the velocities at its ends. How the velocity bends
 * within a sample moves the position by h^2/12 of the change of force, whatever the number of
 * samples: it is left out on both sides. */
#include "tuning_internal.h"

#include "base/algebra/vector_internal.h"

#include <string.h>

imki_increments imki_increments_start(void)
{
    return (imki_increments){.c = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}}};
}

/* s_1 … s_3; fourteen terms are enough for a turn of half a revolution. */
static void series(double square, double s[3])
{
    double term = 1.0;
    for (int n = 0; n < 3; n++) {
        double part = term / (double)(n + 1), sum = part;
        for (int k = 1; k < 14; k++) {
            part *= -square / (double)((n + 2 * k) * (n + 1 + 2 * k));
            sum += part;
        }
        term /= (double)(n + 1);
        s[n] = sum;
    }
}

/* Turn r, and the increment of velocity dv. */
static void take(imki_increments *s, const double r[3], const double dv[3])
{
    double k[3], once[3], twice[3], body[3];
    series(imki_dot3(r, r), k);
    imki_cross3(r, dv, once);
    imki_cross3(r, once, twice);
    for (int i = 0; i < 3; i++)
        body[i] = dv[i] + k[1] * once[i] + k[2] * twice[i];
    for (int i = 0; i < 3; i++)
        s->v[i] += imki_dot3(s->c.m[i], body);
    for (int i = 0; i < 3; i++) { /* rows of C (1 + s1 [r x] + s2 [r x]^2) */
        double row[3];
        memcpy(row, s->c.m[i], sizeof row);
        imki_cross3(row, r, once);
        imki_cross3(once, r, twice);
        for (int j = 0; j < 3; j++)
            s->c.m[i][j] = row[j] + k[0] * once[j] + k[1] * twice[j];
    }
}

void imki_increments_take(imki_increments *s, double h, const double rate[3], const double force[3])
{
    double r[3], dv[3];
    for (int i = 0; i < 3; i++) {
        r[i] = rate[i] * h;
        dv[i] = force[i] * h;
    }
    take(s, r, dv);
}

void imki_increments_sample(imki_increments *s, double h, const double before[3])
{
    for (int i = 0; i < 3; i++)
        s->p[i] += 0.5 * h * (before[i] + s->v[i]);
}

/* Of two means a and b over h each: rotation vector a + b + 2/3 a x b, increment of velocity
 * u + w + 2/3 (a x w + u x b), besides what a constant turn makes of it. */
void imki_increments_pair(imki_increments *s, double h, const double rate[2][3],
                          const double force[2][3])
{
    double a[2][3], u[2][3], coning[3], first[3], second[3], r[3], dv[3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            a[k][i] = rate[k][i] * h;
            u[k][i] = force[k][i] * h;
        }
    imki_cross3(a[0], a[1], coning);
    imki_cross3(a[0], u[1], first);
    imki_cross3(u[0], a[1], second);
    for (int i = 0; i < 3; i++) {
        r[i] = a[0][i] + a[1][i] + 2.0 / 3.0 * coning[i];
        dv[i] = u[0][i] + u[1][i] + 2.0 / 3.0 * (first[i] + second[i]);
    }
    take(s, r, dv);
}

/* C (estimate) = (1 + [psi x]) C. */
void imki_increments_error(const imki_increments *estimate, const imki_increments *truth,
                           double x[9])
{
    const imk_matrix3 turn = imk_matrix3_multiply(estimate->c, imk_matrix3_transpose(truth->c));
    const imk_vector3 psi = imk_quaternion_to_rotation_vector(imk_quaternion_from_matrix(turn));
    memcpy(x, psi.v, sizeof psi.v);
    for (int i = 0; i < 3; i++) {
        x[3 + i] = estimate->v[i] - truth->v[i];
        x[6 + i] = estimate->p[i] - truth->p[i];
    }
}
