/* SPDX-License-Identifier: Apache-2.0 */
/* What noise does to an alignment that weighs all epochs alike. Its error is, with v the known
 * velocities and n the noise at the epochs,
 *
 *     p = -I^-1 sum (v - mean v) x n,
 *
 * so the covariance of sum v n, of sum n, and of the states n comes from is carried from epoch to
 * epoch; n is of the same kind and independent along each axis. */
#include "alignment_internal.h"

enum { SUM = 3, AVERAGE, VELOCITY, FORCE, GROWTH };

/* Row and column `to` += factor times row and column `from`. */
static void combine(imki_spread *s, int to, double factor, int from)
{
    for (int j = 0; j < IMKI_SPREAD_STATES; j++)
        s->p[to][j] += factor * s->p[from][j];
    for (int i = 0; i < IMKI_SPREAD_STATES; i++)
        s->p[i][to] += factor * s->p[i][from];
}

void imki_spread_add(imki_spread *spread, const imki_velocity_noise *noise, double step,
                     imk_vector3 reference, bool first)
{
    imki_spread *s = spread;
    const double h = step;
    if (first)
        s->p[GROWTH][GROWTH] = noise->growth;
    for (int i = 0; i < IMKI_SPREAD_STATES; i++)
        s->p[AVERAGE][i] = s->p[i][AVERAGE] = 0.0;
    combine(s, AVERAGE, 1.0, VELOCITY);
    combine(s, AVERAGE, 0.5 * h, FORCE);
    combine(s, AVERAGE, h * h / 6.0, GROWTH);
    combine(s, VELOCITY, h, FORCE);
    combine(s, VELOCITY, 0.5 * h * h, GROWTH);
    combine(s, FORCE, h, GROWTH);
    double added[4][4];
    imki_velocity_added(noise, h, added);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            s->p[AVERAGE + i][AVERAGE + j] += added[i][j];
    for (int i = 0; i < 3; i++)
        combine(s, i, reference.v[i], AVERAGE);
    combine(s, SUM, 1.0, AVERAGE);
}

/* e_lia */
static double permutation(int l, int i, int a)
{
    return 0.5 * (double)((l - i) * (i - a) * (a - l));
}

void imki_spread_covariance(const imki_spread *spread, const imk_matrix3 *inverse, imk_vector3 mean,
                            imk_vector3 force, bool turning, double strength,
                            imk_matrix3 *covariance)
{
    imki_spread centred = *spread;
    for (int i = 0; i < 3; i++)
        combine(&centred, i, -mean.v[i], SUM);
    static const int used[4] = {0, 1, 2, FORCE};
    const double end = turning ? 1.0 / imk_vector3_dot(force, force) : 0.0;
    for (int a = 0; a < 3; a++) {
        double map[3][4] = {{0}}; /* error from the sums and the force, n along axis a */
        for (int l = 0; l < 3; l++) {
            for (int i = 0; i < 3; i++) {
                for (int k = 0; k < 3; k++)
                    map[l][i] -= inverse->m[l][k] * permutation(k, i, a);
                map[l][3] += permutation(l, i, a) * force.v[i] * end;
            }
        }
        for (int l = 0; l < 3; l++)
            for (int m = 0; m < 3; m++)
                for (int i = 0; i < 4; i++)
                    for (int j = 0; j < 4; j++)
                        covariance->m[l][m] +=
                            strength * map[l][i] * centred.p[used[i]][used[j]] * map[m][j];
    }
}
