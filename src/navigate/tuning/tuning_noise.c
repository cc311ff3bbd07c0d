/* SPDX-License-Identifier: Apache-2.0 */
/* Covariances of noise, sample after sample. With x <- Phi x + g (c z + d w), z <- a z + b w, w of
 * unit variance, and P, S, Z the covariances of x, of x with z, and of z:
 *
 *     P <- Phi P Phi^T + Phi S c^T g^T + g c S^T Phi^T + g (c Z c^T + d^2) g^T
 *     S <- Phi S a^T + g (c Z a^T + d b^T)
 *     Z <- a Z a^T + b b^T */
#include "tuning_internal.h"

#include "base/algebra/vector_internal.h"

#include <string.h>

void imki_tuning_move(const imki_tuning_sample *sample, double x[9])
{
    double lever[3];
    imki_cross3(sample->v, x, lever);
    for (int i = 0; i < 3; i++) {
        x[6 + i] += sample->h * x[3 + i] - 0.5 * sample->h * lever[i];
        x[3 + i] -= lever[i];
    }
}

/* Rows of p: Phi p. */
static void move_rows(const imki_tuning_sample *sample, double p[9][9])
{
    const double *v = sample->v, h = sample->h;
    for (int i = 0; i < 3; i++) {
        const int k = (i + 1) % 3, l = (i + 2) % 3;
        for (int j = 0; j < 9; j++) {
            const double lever = v[k] * p[l][j] - v[l] * p[k][j];
            p[6 + i][j] += h * p[3 + i][j] - 0.5 * h * lever;
            p[3 + i][j] -= lever;
        }
    }
}

void imki_tuning_move_matrix(const imki_tuning_sample *sample, imki_matrix9 *p)
{
    move_rows(sample, p->m);
    for (int i = 0; i < 9; i++)
        imki_tuning_move(sample, p->m[i]);
}

void imki_tuning_start_noise(const imki_sampled *sampled, double cross[2][9], double states[2][2])
{
    memset(cross, 0, 2 * sizeof *cross);
    memcpy(states, sampled->start, sizeof sampled->start);
}

/* p += a b^T + b a^T */
static void add_both(imki_matrix9 *p, const double a[9], const double b[9])
{
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++)
            p->m[i][j] += a[i] * b[j] + b[i] * a[j];
}

void imki_tuning_drive(const imki_tuning_sample *sample, const imki_sampled *sampled,
                       const double of_states[9], const double of_noise[9], double cross[2][9],
                       double states[2][2], imki_matrix9 *p)
{
    const int n = sampled->states;
    const double *c = sampled->c, *b = sampled->b;
    double seen[2] = {0.0, 0.0}, output = 0.0, along[9], half[9]; /* c Z, c Z c^T */
    for (int j = 0; j < n; j++) {
        for (int k = 0; k < n; k++)
            seen[j] += c[k] * states[k][j];
        output += seen[j] * c[j];
        imki_tuning_move(sample, cross[j]);
    }
    for (int i = 0; i < 9; i++) {
        along[i] = 0.5 * output * of_states[i];
        half[i] = 0.5 * sampled->d * sampled->d * of_noise[i];
        for (int j = 0; j < n; j++)
            along[i] += cross[j][i] * c[j];
        if (of_states == of_noise)
            half[i] += along[i];
    }
    add_both(p, half, of_noise);
    if (of_states != of_noise)
        add_both(p, along, of_states);
    double next[2][9] = {{0.0}}, moved[2][2] = {{0.0}};
    for (int s = 0; s < n; s++) {
        double entering = 0.0;
        for (int j = 0; j < n; j++)
            entering += seen[j] * sampled->a[s][j];
        for (int i = 0; i < 9; i++) {
            next[s][i] = of_states[i] * entering + of_noise[i] * (sampled->d * b[s]);
            for (int j = 0; j < n; j++)
                next[s][i] += sampled->a[s][j] * cross[j][i];
        }
        for (int t = 0; t < n; t++) {
            moved[s][t] = b[s] * b[t];
            for (int j = 0; j < n; j++)
                for (int k = 0; k < n; k++)
                    moved[s][t] += sampled->a[s][j] * states[j][k] * sampled->a[t][k];
        }
    }
    memcpy(cross, next, sizeof next);
    memcpy(states, moved, sizeof moved);
}

void imki_pack(const imki_matrix9 *p, double packed[IMKI_PACKED])
{
    int at = 0;
    for (int i = 0; i < 9; i++)
        for (int j = 0; j <= i; j++)
            packed[at++] = 0.5 * (p->m[i][j] + p->m[j][i]);
}

void imki_unpack(const double packed[IMKI_PACKED], double p[9][9])
{
    int at = 0;
    for (int i = 0; i < 9; i++)
        for (int j = 0; j <= i; j++) {
            p[i][j] = packed[at];
            p[j][i] = packed[at++];
        }
}
