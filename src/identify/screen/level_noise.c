/* SPDX-License-Identifier: Apache-2.0 */
/* The slow noise of M means of a record: their cosine coefficients c_k have the variance
 * S_k = a + b/(2 s) + d (1/(4 s^2) - 1/6), s = sin(pi k/2M), of white noise, flicker and random
 * walk; the amounts are fitted by maximum likelihood. Where an octave of frequencies has more power
 * than this, S_k is raised to it. Vibration that the means alias is a tone, which can be taken out.
 */
#include "identify/likelihood/identify_internal.h"
#include "imukit/elementary.h"
#include "imukit/fourier.h"
#include "screener_internal.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 200, GROUP = 32 };

static const double pi = 3.14159265358979324;

size_t imki_level_noise_room(size_t n)
{
    return 4 * n + (imk_cosine_workspace_size(n) + sizeof(double) - 1) / sizeof(double);
}

void imki_level_noise_begin(imki_level_noise *noise, size_t n, double *room)
{
    double **const parts[] = {&noise->flicker, &noise->walk, &noise->coefficient, &noise->spectrum};
    noise->n = n;
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++, room += n)
        *parts[i] = room;
    noise->transform = room;
    noise->transform_size = imk_cosine_workspace_size(n);
    for (size_t i = 0; i < n; i++) {
        const double s = imk_sin(pi * (double)i / (2 * (double)n));
        noise->flicker[i] = i > 0 ? 1 / (2 * s) : 0;
        noise->walk[i] = i > 0 ? 1 / (4 * s * s) - 1.0 / 6 : 0;
    }
}

/* Amounts to begin with: a third of the power each. */
static void start(imki_level_noise *noise)
{
    double have[IMKI_LEVEL_NOISES] = {0};
    for (size_t k = 1; k < noise->n; k++) {
        const double square = noise->coefficient[k] * noise->coefficient[k];
        have[0] += square;
        have[1] += square / noise->flicker[k];
        have[2] += square / noise->walk[k];
    }
    for (size_t i = 0; i < IMKI_LEVEL_NOISES; i++)
        noise->amount[i] = have[i] / (double)(noise->n - 1) / IMKI_LEVEL_NOISES;
}

/* The amounts in turns, each times the ratio of what the likelihood wants more to what it wants
 * less [FEVOTTE2009]. @return the log-likelihood */
double imki_level_noise_fit(imki_level_noise *noise)
{
    double likelihood = 0;
    start(noise);
    for (int round = 0; round <= ROUNDS; round++) {
        double more[IMKI_LEVEL_NOISES] = {0}, less[IMKI_LEVEL_NOISES] = {0};
        for (size_t k = 1; k < noise->n; k++) {
            const double power[IMKI_LEVEL_NOISES] = {1, noise->flicker[k], noise->walk[k]};
            double spectrum = 0;
            for (size_t i = 0; i < IMKI_LEVEL_NOISES; i++)
                spectrum += noise->amount[i] * power[i];
            const double inverse = 1 / spectrum;
            const double ratio = noise->coefficient[k] * noise->coefficient[k] * inverse;
            noise->spectrum[k] = spectrum;
            likelihood -= round == ROUNDS ? 0.5 * (imk_ln(spectrum) + ratio) : 0;
            for (size_t i = 0; i < IMKI_LEVEL_NOISES; i++) {
                more[i] += power[i] * ratio * inverse;
                less[i] += power[i] * inverse;
            }
        }
        for (size_t i = 0; round < ROUNDS && i < IMKI_LEVEL_NOISES; i++)
            noise->amount[i] *= more[i] / less[i];
    }
    return likelihood;
}

/* Raise octaves that have more power than the fit. */
void imki_level_noise_raise(imki_level_noise *noise)
{
    for (size_t from = 1, to; from < noise->n; from = to) {
        to = from < 4 ? 4 : 2 * from;
        to = to < noise->n ? to : noise->n;
        double ratio = 0;
        for (size_t k = from; k < to; k++)
            ratio += noise->coefficient[k] * noise->coefficient[k] / noise->spectrum[k];
        ratio = fmax(1, ratio / (double)(to - from));
        for (size_t k = from; k < to; k++)
            noise->spectrum[k] *= ratio;
    }
}

static double upper_square(const double *coefficient, double *sorted)
{
    for (size_t k = 0; k < GROUP; k++)
        sorted[k] = coefficient[k] * coefficient[k];
    imki_sort(sorted, GROUP);
    return sorted[3 * GROUP / 4];
}

void imki_level_noise_transform(imki_level_noise *noise, const double *mean)
{
    memcpy(noise->coefficient, mean, noise->n * sizeof *mean);
    (void)imk_cosine(noise->n, noise->coefficient, noise->transform,
                     noise->transform_size); /* sized for it */
    noise->coefficient[0] = 0;
}

/* The coefficient that is farthest above those about it: more than 16 times the upper quartile of
 * their squares (5e-6 by chance). The skirts of a strong line raise its own group, so the
 * neighbours count, too. Every other coefficient of a jump in the middle is 0. @return 0: there is
 * none */
static size_t find_line(imki_level_noise *noise)
{
    const size_t groups = noise->n / GROUP;
    double *upper = noise->spectrum, most = 16; /* the spectrum is not needed yet */
    size_t line = 0;
    for (size_t g = 0; g < groups; g++)
        upper[g] = upper_square(noise->coefficient + g * GROUP, upper + groups);
    for (size_t g = 2; g < groups; g++) {
        const double after = g + 1 < groups ? upper[g + 1] : upper[g];
        const double least = fmin(upper[g], g > 2 ? fmin(upper[g - 1], after) : after);
        for (size_t k = g * GROUP; k < (g + 1) * GROUP; k++) {
            const double square = noise->coefficient[k] * noise->coefficient[k];
            if (square > most * least) {
                most = square / least;
                line = k;
            }
        }
    }
    return line;
}

void imki_level_noise_take_tones(imki_level_noise *noise, double *mean)
{
    enum { TONES = 4 };
    imki_sinusoid tone;
    double level = 0;
    for (size_t i = 0; i < noise->n; i++)
        level += mean[i] / (double)noise->n;
    for (size_t i = 0; i < noise->n; i++)
        mean[i] -= level;
    for (int k = 0; k < TONES; k++) {
        imki_level_noise_transform(noise, mean);
        const size_t line = find_line(noise);
        const double cycles = (double)line / (2 * (double)noise->n);
        const double power = noise->coefficient[line] * noise->coefficient[line] / (double)noise->n;
        if (line == 0 || !imki_sinusoid_remove(noise->n, cycles, power, mean, &tone))
            break;
    }
    for (size_t i = 0; i < noise->n; i++)
        mean[i] += level;
}
