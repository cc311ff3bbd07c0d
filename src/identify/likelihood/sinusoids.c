/* SPDX-License-Identifier: Apache-2.0 */
/* Tones of a record: each is found at the periodogram's peak, and all are then fitted together.
 *
 * At the peak of one tone the skirts of the others move its frequency and its amplitude, and so do
 * the mean of the record and, for a tone of few cycles, its own negative frequency. What a tone of
 * 300 standard deviations leaves because of that can be as strong as the noise. So they are fitted
 * by least squares, one at a time on what the others leave, until none moves: for a tone
 * c cos x + s sin x, x = 2 pi f (i - (n - 1)/2), the columns are cos x, sin x, the change with f,
 * and 1. As x is counted from the middle of the record, f is estimated independently of c and s. */
#include "identify_internal.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>

static const double turn = 6.283185307179586;

/* A phasor of so many cycles per sample about the middle of the record, set anew every BLOCK
 * samples so that its rounding does not grow. */
enum { BLOCK = 256 };
typedef struct phasor {
    double cycles, middle, re, im, cos_step, sin_step;
} phasor;

static phasor phasor_of(size_t n, double cycles)
{
    const double step = turn * cycles;
    return (phasor){cycles, 0.5 * (double)(n - 1), 1, 0, imk_cos(step), imk_sin(step)};
}

static void set_phase(phasor *p, size_t i)
{
    const double turns = p->cycles * ((double)i - p->middle);
    const double phase = turn * (turns - floor(turns));
    p->re = imk_cos(phase);
    p->im = imk_sin(phase);
}

static void advance(phasor *p)
{
    const double next = p->re * p->cos_step - p->im * p->sin_step;
    p->im = p->re * p->sin_step + p->im * p->cos_step;
    p->re = next;
}

double imki_sinusoid_amplitude(const imki_sinusoid *tone)
{
    return sqrt(tone->c * tone->c + tone->s * tone->s);
}

/* Projections of the record on cos and sin of a frequency. */
static void project(size_t n, const double *samples, double cycles, double *c, double *s)
{
    phasor p = phasor_of(n, cycles);
    *c = *s = 0;
    for (size_t i = 0; i < n; i++) {
        if (i % BLOCK == 0)
            set_phase(&p, i);
        *c += samples[i] * p.re;
        *s += samples[i] * p.im;
        advance(&p);
    }
}

/* Subtract `sign` times a tone. */
static void subtract(size_t n, double *samples, const imki_sinusoid *tone, double sign)
{
    const double c = sign * tone->c, s = sign * tone->s;
    phasor p = phasor_of(n, tone->cycles);
    for (size_t i = 0; i < n; i++) {
        if (i % BLOCK == 0)
            set_phase(&p, i);
        samples[i] -= c * p.re + s * p.im;
        advance(&p);
    }
}

typedef struct tone_search {
    size_t n;
    const double *samples;
} tone_search;

static double projected_power(void *context, double cycles)
{
    const tone_search *t = context;
    double c, s;
    project(t->n, t->samples, cycles, &c, &s);
    return c * c + s * s;
}

/* The periodogram's peak near the frequency; the two projections there are orthogonal to 1/n. */
bool imki_sinusoid_remove(size_t n, double cycles, double variance, double *samples,
                          imki_sinusoid *tone)
{
    tone_search search = {n, samples};
    const double reach = 0.75 / (double)n, half = 0.5 * (double)n;
    tone->cycles = imki_peak(projected_power, &search, cycles - reach, cycles + reach, 24);
    project(n, samples, tone->cycles, &tone->c, &tone->s);
    tone->c /= half;
    tone->s /= half;
    const double power = 0.5 * (tone->c * tone->c + tone->s * tone->s);
    double all = 0;
    for (size_t i = 0; i < n; i++)
        all += samples[i] * samples[i] / (double)n;
    if (!(power > 0.6 * variance && all - power > 1e-9 * all))
        return false;
    subtract(n, samples, tone, 1);
    return true;
}

enum { COLUMNS = 4 };

/* Normal equations of what a tone leaves, by cos, sin, the change with the frequency, and 1. */
static void normal_equations(size_t n, const double *samples, const imki_sinusoid *tone,
                             double *matrix, double *right)
{
    phasor p = phasor_of(n, tone->cycles);
    for (size_t i = 0; i < (size_t)COLUMNS * COLUMNS; i++)
        matrix[i] = 0;
    for (size_t i = 0; i < COLUMNS; i++)
        right[i] = 0;
    for (size_t i = 0; i < n; i++) {
        if (i % BLOCK == 0)
            set_phase(&p, i);
        const double slope = turn * ((double)i - p.middle);
        const double column[COLUMNS] = {p.re, p.im, slope * (tone->s * p.re - tone->c * p.im), 1};
        for (size_t j = 0; j < COLUMNS; j++) {
            right[j] += column[j] * samples[i];
            for (size_t k = 0; k <= j; k++)
                matrix[j * COLUMNS + k] += column[j] * column[k];
        }
        advance(&p);
    }
}

/* One step of a tone, on what all leave. Returns how far it moved, as a part of its energy. */
static double refine_one(size_t n, double *samples, imki_sinusoid *tone)
{
    double matrix[COLUMNS * COLUMNS], step[COLUMNS], scale[COLUMNS];
    normal_equations(n, samples, tone, matrix, step);
    for (size_t j = 0; j < COLUMNS; j++)
        scale[j] = matrix[j * (COLUMNS + 1)] > 0 ? 1 / sqrt(matrix[j * (COLUMNS + 1)]) : 0;
    for (size_t j = 0; j < COLUMNS; j++) {
        step[j] *= scale[j];
        for (size_t k = 0; k <= j; k++)
            matrix[j * COLUMNS + k] = matrix[k * COLUMNS + j] =
                j == k ? 1 + 1e-10 : matrix[j * COLUMNS + k] * scale[j] * scale[k];
    }
    if (imk_cholesky_factor(COLUMNS, matrix) != IMK_OK)
        return 0;
    imk_cholesky_solve(COLUMNS, matrix, step);
    double moved = 0;
    for (size_t j = 0; j + 1 < COLUMNS; j++)
        moved += step[j] * step[j];
    const double reach = 0.2 / (double)n; /* of one step */
    const imki_sinusoid before = *tone;
    tone->c += step[0] * scale[0];
    tone->s += step[1] * scale[1];
    tone->cycles += fmax(-reach, fmin(reach, step[2] * scale[2]));
    tone->cycles = fmax(0, fmin(0.5, tone->cycles));
    subtract(n, samples, &before, -1);
    subtract(n, samples, tone, 1);
    return moved / (0.5 * (double)n * (before.c * before.c + before.s * before.s));
}

void imki_sinusoids_refine(size_t n, double *samples, size_t count, imki_sinusoid *tones)
{
    enum { SWEEPS = 12 };
    const double settled = 1e-14; /* of the energy: rounding is below, the noise of a tone above */
    double moved = 1;
    for (int sweep = 0; sweep < SWEEPS && moved > settled; sweep++) {
        moved = 0;
        for (size_t i = 0; i < count; i++)
            moved = fmax(moved, refine_one(n, samples, &tones[i]));
    }
}
