/* SPDX-License-Identifier: Apache-2.0 */
/* What a record without a visible filter shows of noise that passed one.
 *
 * White noise behind a filter beyond the band is nearly white in the samples: no record of usual
 * length shows the filter, but all show less noise, some percent of it at half the sample rate. An
 * estimator of maximum likelihood then finds the amounts whose spectrum
 *
 *     M(f) = sum a_j h_j(f)
 *
 * of white noise, bias instability, random walk and errors of the readings is nearest to the true
 * one S in the sense of Kullback and Leibler, sum S/M + log M [WHITE1982], over the frequencies of
 * the record. They are found from the true ones by
 *
 *     a_j <- a_j sqrt(sum h_j S/M^2 / sum h_j/M),
 *
 * which keeps them positive and never makes the distance larger [FEVOTTE2011]. Frequencies are
 * taken in bands of equal ratio, each with the weight of its width. */
#include "imukit/elementary.h"
#include "imukit/identify_plan.h"

#include <math.h>

enum { BANDS = 256, TEMPLATES = 4, ROUNDS = 4000 };

typedef struct spectrum {
    double weight[BANDS], s[BANDS];
    double h[TEMPLATES][BANDS];
} spectrum;

static void set_bands(spectrum *p, double dt, double duration)
{
    const double low = 0.5 / duration, ratio = imk_exp(imk_ln(0.5 / (dt * low)) / BANDS);
    double from = low;
    for (int b = 0; b < BANDS; b++, from *= ratio) {
        const double f = 0.5 * from * (1 + ratio);
        p->weight[b] = from * (ratio - 1);
        p->h[0][b] = imk_quantization_sampled_spectrum(1, dt, f);
        p->h[1][b] = 1;
        p->h[2][b] = imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
        p->h[3][b] = imk_random_walk_sampled_spectrum(1, dt, f);
        p->s[b] = f; /* until the spectrum is put there */
    }
}

static void improve(const spectrum *p, double *a)
{
    double up[TEMPLATES] = {0}, down[TEMPLATES] = {0};
    for (int b = 0; b < BANDS; b++) {
        double model = 0;
        for (int j = 0; j < TEMPLATES; j++)
            model += a[j] * p->h[j][b];
        const double weight = p->weight[b] / model, excess = weight * p->s[b] / model;
        for (int j = 0; j < TEMPLATES; j++) {
            up[j] += excess * p->h[j][b];
            down[j] += weight * p->h[j][b];
        }
    }
    for (int j = 0; j < TEMPLATES; j++)
        a[j] *= sqrt(up[j] / down[j]);
}

imk_identify_seen imk_identify_seen_of(const imk_triad *triad, int axis, double dt, double duration,
                                       bool readings)
{
    const imk_noise *noise = &triad->noise;
    const double n = noise->white.value[axis], q = imk_noise_reading(noise, axis, dt);
    const double instability = noise->bias_instability.value[axis];
    const double walk = noise->random_walk.value[axis];
    const imk_low_pass filter = {triad->bandwidth.value[axis], triad->damping.value[axis]};
    imk_identify_seen seen = {n, q};
    imk_arma arma;
    spectrum p;
    if (!(filter.bandwidth > 0) || !(n > 0) || !(duration > 2 * dt) ||
        imk_filtered_white_arma(n, filter, dt, &arma) != IMK_OK)
        return seen;
    set_bands(&p, dt, duration);
    for (int b = 0; b < BANDS; b++)
        p.s[b] = imk_arma_spectrum(&arma, p.s[b]) + q * q * p.h[0][b] +
                 instability * instability * p.h[2][b] + walk * walk * p.h[3][b];
    /* Terms that the model has not begin with what moves white noise by a thousandth at an end. */
    double a[TEMPLATES] = {readings ? fmax(q * q, 1e-3 * n * n / p.h[0][BANDS - 1]) : 0, n * n,
                           fmax(instability * instability, 1e-3 * n * n / p.h[2][0]),
                           fmax(walk * walk, 1e-3 * n * n / p.h[3][0])};
    for (int round = 0; round < ROUNDS; round++)
        improve(&p, a);
    seen.white = sqrt(a[1]);
    seen.reading = sqrt(a[0]);
    return seen;
}
