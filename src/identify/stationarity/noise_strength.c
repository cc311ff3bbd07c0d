/* SPDX-License-Identifier: Apache-2.0 */
/* N and B of a part of a record, by weighted least squares on its mean squares v_j of the octaves,
 *
 *     v_j = x w_j + y f_j + o_j,   variance of v_j = 2 v_j^2/n_j
 *
 * with the parts w_j of white noise, f_j of flicker noise and o_j of everything else in the model
 * of the whole record, whose N^2 and B^2 are multiplied by x and y. The same fit to the whole
 * record gives the x and y that these are relative to, so that a misfit of the model cancels. */
#include "imukit/distributions.h"
#include "noise_map_internal.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
/* Correlation of neighbours, at most (random walk): 1 + 2/16, and a margin. */
static const double sound_scatter = 1.2;
/* Structures do not ring longer; a narrower line is a tone, or a vibration that came and went. */
static const double quality_most = 300;

void imki_noise_shares_find(const imk_identification *identified, double dt, size_t octaves,
                            imki_noise_shares *shares)
{
    shares->octaves = octaves;
    shares->skipped = 0;
    for (size_t j = 0; j < octaves; j++) {
        const size_t m = (size_t)1 << j;
        const double all = imk_identification_allan_variance(identified, dt, m, -1);
        shares->white[j] = imk_identification_allan_variance(identified, dt, m, IMK_NOISE_WHITE);
        shares->flicker[j] =
            imk_identification_allan_variance(identified, dt, m, IMK_NOISE_BIAS_INSTABILITY);
        shares->other[j] = fmax(0, all - shares->white[j] - shares->flicker[j]);
        shares->slow[j] = shares->flicker[j] + imk_identification_allan_variance(
                                                   identified, dt, m, IMK_NOISE_RANDOM_WALK);
        for (int i = 0; i < identified->gauss_markov_count; i++) {
            const imk_gauss_markov g = {identified->gauss_markov[i].sigma.value,
                                        identified->gauss_markov[i].correlation_time.value};
            shares->slow[j] += imk_gauss_markov_sampled_allan_variance(g, dt, m);
        }
        shares->tones[j] = 0;
        for (int i = 0; i < identified->sinusoid_count; i++)
            shares->tones[j] += imk_sinusoid_sampled_allan_variance(identified->sinusoid[i], dt, m);
    }
}

double imki_noise_expected_scatter(const imk_identification *identified, double dt,
                                   const imki_noise_shares *shares, size_t octave)
{
    const size_t m = (size_t)1 << octave;
    double sum = sound_scatter;
    for (int i = 0; i < identified->resonance_count; i++) {
        const imk_resonance *ring = &identified->resonance[i];
        if (ring->q > quality_most)
            continue;
        const double share =
            imk_resonance_sampled_allan_variance(*ring, dt, m) / imki_noise_total(shares, octave);
        const double memory = ring->q / (2 * PI * ring->frequency * dt);
        sum += 2 * share * share * memory / (2 * (double)m);
    }
    return sum;
}

/* Factors of N^2 and B^2, and their variances. */
typedef struct factors {
    double x, y, variance_x, variance_y;
} factors;

/* One weighted solution at the variances of the factors before. */
static void solve(const imk_noise_cell *cell, const imki_noise_shares *s, bool flicker, factors *f)
{
    double ww = 0, wf = 0, ff = 0, wr = 0, fr = 0;
    for (size_t j = 0; j < s->octaves; j++) {
        const double expected = f->x * s->white[j] + f->y * s->flicker[j] + s->other[j];
        if (!(cell[j].count > 0) || !(expected > 0) || (s->skipped >> j & 1))
            continue;
        const double weight = 0.5 * cell[j].count / (expected * expected);
        const double rest = 0.5 * cell[j].square / cell[j].count - s->other[j];
        ww += weight * s->white[j] * s->white[j];
        wf += weight * s->white[j] * s->flicker[j];
        ff += weight * s->flicker[j] * s->flicker[j];
        wr += weight * s->white[j] * rest;
        fr += weight * s->flicker[j] * rest;
    }
    const double determinant = ww * ff - wf * wf;
    const bool both = flicker && determinant > 1e-12 * ww * ff;
    f->y = both ? (ww * fr - wf * wr) / determinant : 0;
    if (f->y < 0 || !both) {
        f->y = both ? 0 : f->y;
        f->x = ww > 0 ? wr / ww : 0;
    } else {
        f->x = (ff * wr - wf * fr) / determinant;
    }
    f->x = fmax(f->x, 0);
    f->variance_x = both ? ff / determinant : ww > 0 ? 1 / ww : 0;
    f->variance_y = both ? ww / determinant : 0;
}

static factors fit(const imk_noise_map *map, const imki_noise_shares *shares, bool flicker,
                   size_t first, size_t end)
{
    enum { ROUNDS = 8 };
    imk_noise_cell cell[IMK_NOISE_MAP_OCTAVES];
    double measured = 0, expected = 0;
    for (size_t j = 0; j < shares->octaves; j++) {
        cell[j] = imki_noise_cells(map, j, first, end);
        measured += 0.5 * cell[j].square;
        expected += cell[j].count * (shares->white[j] + shares->flicker[j] + shares->other[j]);
    }
    const double start = expected > 0 ? measured / expected : 0;
    factors f = {start, flicker ? start : 0, 0, 0};
    for (int round = 0; round < ROUNDS; round++)
        solve(cell, shares, flicker, &f);
    return f;
}

/* A strength whose square is known like chi-square over its degrees. */
static imk_estimate strength(double value, double square, double of_record, double variance,
                             double confidence)
{
    const double ratio = of_record > 0 ? square / of_record : 0, tail = 0.5 * (1 - confidence);
    imk_estimate e = {.present = true};
    e.value = e.free_value = value * sqrt(ratio);
    const double base = fmax(square, sqrt(variance)); /* at least that large at the upper end */
    const double degrees = fmax(2 * base * base / variance, 0.5);
    const double size = value * sqrt(of_record > 0 ? base / of_record : 0);
    e.sigma = size / sqrt(2 * degrees);
    e.lower = square > 0 ? e.value * sqrt(degrees / imk_chi_square_quantile(1 - tail, degrees)) : 0;
    e.upper = size * sqrt(degrees / imk_chi_square_quantile(tail, degrees));
    return e;
}

void imki_noise_strengths(const imk_noise_map *map, const imki_noise_shares *shares,
                          const imk_identification *identified, double confidence, size_t first,
                          size_t end, imk_noise_segment *segment)
{
    const imk_estimate *n = &identified->term[IMK_NOISE_WHITE];
    const imk_estimate *b = &identified->term[IMK_NOISE_BIAS_INSTABILITY];
    const factors all = fit(map, shares, b->present, 0, IMK_NOISE_MAP_BLOCKS);
    const factors here = fit(map, shares, b->present, first, end);
    segment->white = segment->bias_instability = (imk_estimate){.present = false};
    if (n->present && here.variance_x > 0)
        segment->white = strength(n->value, here.x, all.x, here.variance_x, confidence);
    if (b->present && here.variance_y > 0 && all.y > 0)
        segment->bias_instability = strength(b->value, here.y, all.y, here.variance_y, confidence);
}
