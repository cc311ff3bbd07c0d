/* SPDX-License-Identifier: Apache-2.0 */
/* A level that goes up and down regularly, as with the temperature of an air-conditioned room,
 * against the slow noise (level_noise.c). A cosine and a sine are fitted by generalised least
 * squares at 2 to 24 periods in the record, a quarter of a period apart: faster ones are lines of
 * the spectrum, slower ones a walk. Twice the gain is chi-square with two degrees of freedom where
 * there is none; the noise is fitted again without the cycle, as for jumps. */
#include "imukit/elementary.h"
#include "imukit/fourier.h"
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { LEAST = 8, MOST = 96, PER_PERIOD = 4, PERIODS = 2 * PER_PERIOD };

static const double pi = 3.14159265358979324;

typedef struct cycle_search {
    imki_level_noise noise;
    size_t n;
    double *sine;    /* sin(2 pi i/8 M) */
    double *part[2]; /* coefficients of cosine and sine */
    double *kept;    /* c_k with the cycle */
    double amount[2];
} cycle_search;

size_t imki_cycle_room(size_t n)
{
    return (PERIODS + 3) * n + imki_level_noise_room(n);
}

/* Cosine and sine of quarter periods of the record, at the middle of mean i. */
static inline double sine_at(const cycle_search *c, size_t quarters, size_t i, bool cosine)
{
    const size_t all = PERIODS * c->n;
    return c->sine[(quarters * (2 * i + 1) + (cosine ? all / 4 : 0)) % all];
}

/* Coefficients of cosine and sine. */
static void make_parts(cycle_search *c, size_t quarters)
{
    for (int p = 0; p < 2; p++) {
        for (size_t i = 0; i < c->n; i++)
            c->part[p][i] = sine_at(c, quarters, i, p == 0);
        (void)imk_cosine(c->n, c->part[p], c->noise.transform, c->noise.transform_size);
    }
}

/* Amounts of both by generalised least squares. @return twice the gain */
static double solve(cycle_search *c, const double *coefficient)
{
    double a = 0, b = 0, d = 0, u = 0, v = 0;
    for (size_t k = 1; k < c->n; k++) {
        const double weight = 1 / c->noise.spectrum[k];
        const double p = c->part[0][k] * weight, q = c->part[1][k] * weight;
        a += p * c->part[0][k];
        b += p * c->part[1][k];
        d += q * c->part[1][k];
        u += p * coefficient[k];
        v += q * coefficient[k];
    }
    const double determinant = a * d - b * b;
    if (!(determinant > 0))
        return 0;
    c->amount[0] = (d * u - b * v) / determinant;
    c->amount[1] = (a * v - b * u) / determinant;
    return c->amount[0] * u + c->amount[1] * v;
}

/* The most likely cycle, about: a sine has the information M/2 over the spectrum at its frequency,
 * and its product with c/S is that of its samples with the inverse transform. */
static size_t search(cycle_search *c)
{
    double best = 0, *weighted = c->kept;
    size_t quarters = 0;
    weighted[0] = 0;
    for (size_t k = 1; k < c->n; k++)
        weighted[k] = c->noise.coefficient[k] / c->noise.spectrum[k];
    (void)imk_cosine_inverse(c->n, weighted, c->noise.transform, c->noise.transform_size);
    for (size_t q = LEAST; q <= MOST; q++) {
        double u = 0, v = 0;
        for (size_t i = 0; i < c->n; i++) {
            u += weighted[i] * sine_at(c, q, i, true);
            v += weighted[i] * sine_at(c, q, i, false);
        }
        const double gain = (u * u + v * v) * c->noise.spectrum[2 * q / PER_PERIOD];
        if (gain > best) {
            best = gain;
            quarters = q;
        }
    }
    return quarters;
}

static void lay_out(cycle_search *c, double *room)
{
    const size_t n = c->n, all = PERIODS * n;
    c->sine = room;
    c->part[0] = room + all;
    c->part[1] = c->part[0] + n;
    c->kept = c->part[1] + n;
    imki_level_noise_begin(&c->noise, n, c->kept + n);
    for (size_t i = 0; i < all; i++)
        c->sine[i] = imk_sin(2 * pi * (double)i / (double)all);
}

bool imki_cycle_find(size_t n, double *mean, double empty, double significance, double *room,
                     imki_cycle *cycle)
{
    cycle_search work = {.n = n}, *c = &work;
    *cycle = (imki_cycle){0, 0, 0};
    lay_out(c, room);
    imki_level_noise_take_tones(&c->noise, mean);
    imki_level_noise_transform(&c->noise, mean);
    /* not raised yet: of a slow cycle's octave, the cycle is most of the power */
    const double without = imki_level_noise_fit(&c->noise);
    const size_t quarters = search(c);
    if (quarters == 0)
        return false;
    make_parts(c, quarters);
    solve(c, c->noise.coefficient);
    memcpy(c->kept, c->noise.coefficient, n * sizeof *c->kept);
    for (size_t k = 1; k < n; k++)
        c->noise.coefficient[k] -= c->amount[0] * c->part[0][k] + c->amount[1] * c->part[1][k];
    const double gain = imki_level_noise_fit(&c->noise) - without;
    imki_level_noise_raise(&c->noise);
    cycle->square = fmin(2 * gain, solve(c, c->kept)) * (1 - empty);
    cycle->periods = (double)quarters / PER_PERIOD;
    cycle->amplitude = sqrt(c->amount[0] * c->amount[0] + c->amount[1] * c->amount[1]);
    return imk_exp(-0.5 * cycle->square) * (MOST + 1 - LEAST) < significance;
}
