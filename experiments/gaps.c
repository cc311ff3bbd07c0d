/* SPDX-License-Identifier: Apache-2.0 */
/* Allan deviations of records with missing samples: bias, scatter and coverage over many records.
 *
 * usage: gaps [records] [seed]
 *
 * Each noise is simulated by its generator; samples are taken out by each mask. Prints, for each
 * averaging factor, the bias of the variance in units of its scatter, the scatter over that of the
 * complete record, how often the 95 % interval covers the truth, and the degrees of freedom stated
 * over those of the scatter; beside it bias and scatter of the variogram form, half the sum over
 * lags of the filter's autocorrelation times the mean square of the differences of available pairs
 * [MONDAL2010] (first 100 records). */
#include "imukit/allan_gaps.h"
#include "imukit/imukit.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 16384, FACTORS = 11, NOISES = 7, MASKS = 5 };

static const char *const noise_name[NOISES] = {"white", "quantization", "flicker",  "random walk",
                                               "ramp",  "Gauss-Markov", "N + B + K"};
static const char *const mask_name[MASKS] = {"complete", "20 % at random", "a hole of 3 %",
                                             "20 % in holes of 50", "every 10th and 5 % at random"};

/* Variance at m of the noise; the state of the quantizer follows the rate already there. */
static double make_noise(int noise, imk_random random, uint32_t run, double *rate, size_t m)
{
    static imk_white_state white;
    static imk_flicker_state flicker;
    static imk_random_walk_state walk;
    static imk_gauss_markov_state markov;
    const imk_gauss_markov process = {1, 100};
    if (rate)
        for (size_t i = 0; i < SAMPLES; i++)
            rate[i] = 0;
    double variance = 0;
    if (noise == 0 || noise == 6) {
        if (rate && imk_white_start(&white, 1, 1, random, imk_stream(run, 1, 0, 0)) == IMK_OK)
            imk_white_add(&white, SAMPLES, rate);
        variance += imk_white_sampled_allan_variance(1, 1, m);
    }
    if (noise == 1) {
        /* Uniform rounding errors of the integral, as the quantizer makes them of a busy signal. */
        double error[2];
        for (size_t i = 0; rate && i < SAMPLES; i++) {
            static double draw[SAMPLES + 1];
            if (i == 0)
                imk_random_normals(random, imk_stream(run, 2, 0, 0), 0, SAMPLES + 1, draw);
            error[0] = draw[i];
            error[1] = draw[i + 1];
            rate[i] = error[1] - error[0];
        }
        variance += imk_quantization_sampled_allan_variance(1, 1, m);
    }
    if (noise == 2 || noise == 6) {
        const double b = noise == 2 ? 1 : 0.3;
        if (rate && imk_flicker_start(&flicker, (imk_flicker){b, 0}, 1, random,
                                      imk_stream(run, 3, 0, 0)) == IMK_OK)
            imk_flicker_add(&flicker, SAMPLES, rate);
        variance += imk_flicker_sampled_allan_variance((imk_flicker){b, 0}, 1, m);
    }
    if (noise == 3 || noise == 6) {
        const double k = noise == 3 ? 1 : 0.02;
        if (rate && imk_random_walk_start(&walk, k, 1, random, imk_stream(run, 4, 0, 0)) == IMK_OK)
            imk_random_walk_add(&walk, SAMPLES, rate);
        variance += imk_random_walk_sampled_allan_variance(k, 1, m);
    }
    if (noise == 4) {
        if (rate)
            imk_ramp_add(1, 1, 0, SAMPLES, rate);
        variance += imk_ramp_allan_variance(1, (double)m);
    }
    if (noise == 5) {
        if (rate &&
            imk_gauss_markov_start(&markov, process, 1, random, imk_stream(run, 5, 0, 0)) == IMK_OK)
            imk_gauss_markov_add(&markov, SAMPLES, rate);
        variance += imk_gauss_markov_sampled_allan_variance(process, 1, m);
    }
    return variance;
}

/* Uniform numbers by the words of a stream of their own. */
static void take_out(int mask, imk_random random, uint32_t run, double *rate)
{
    static uint32_t word[SAMPLES];
    imk_random_words(random, imk_stream(run, 9, 0, 0), 0, SAMPLES, word);
    const size_t hole = word[0] % (SAMPLES - 500);
    for (size_t i = 0; i < SAMPLES; i++) {
        const double u = word[i] / 4294967296.0;
        const bool out = mask == 1   ? u < 0.2
                         : mask == 2 ? i >= hole && i < hole + 490
                         : mask == 3 ? word[i / 50] < 858993459u
                         : mask == 4 ? i % 10 == 0 || u < 0.05
                                     : false;
        if (out)
            rate[i] = NAN;
    }
}

/* The variogram form, by its definition. */
static double variogram_variance(const double *gamma, size_t m)
{
    const double d = (double)m;
    double sum = 0;
    for (size_t k = 1; k < 2 * m; k++) {
        const double x = (double)k;
        const double a = k < m ? 2 * d - 3 * x : x - 2 * d; /* times m^2: the filter's */
        sum -= 2 * a * gamma[k] / (d * d);
    }
    return sum / 2;
}

static void variogram(const double *rate, size_t lags, double *gamma)
{
    for (size_t k = 1; k < lags; k++) {
        double sum = 0;
        size_t count = 0;
        for (size_t i = 0; i + k < SAMPLES; i++) {
            const double d = rate[i + k] - rate[i];
            if (isfinite(d)) {
                sum += d * d;
                count++;
            }
        }
        gamma[k] = sum / 2 / (double)count;
    }
}

typedef struct tally {
    double sum, squares, form_sum, form_squares, edf, used;
    size_t covered, trials, unresolved;
} tally;

static double scatter(double sum, double squares, size_t trials)
{
    const double n = (double)trials, mean = sum / n;
    return sqrt(fmax(squares / n - mean * mean, 0));
}

int main(int argc, char **argv)
{
    const uint32_t records = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 300;
    const uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const imk_random random = imk_random_seeded(seed);
    static double rate[SAMPLES], gamma[SAMPLES];
    const size_t size = imk_allan_gaps_workspace_size(SAMPLES);
    void *workspace = malloc(size);
    size_t factors[FACTORS];
    for (size_t i = 0; i < FACTORS; i++)
        factors[i] = (size_t)1 << i;
    if (!workspace)
        return 1;
    for (int noise = 0; noise < NOISES; noise++) {
        double complete[FACTORS] = {0};
        for (int mask = 0; mask < MASKS; mask++) {
            tally t[FACTORS] = {0};
            for (uint32_t run = 0; run < records; run++) {
                imk_allan_gap_point p[FACTORS];
                imk_allan_gaps_settings settings = imk_allan_gaps_default();
                make_noise(noise, random, run, rate, 1);
                take_out(mask, random, run, rate);
                imk_allan_gaps_points(&settings, SAMPLES, rate, FACTORS, factors, p, NULL,
                                      workspace, size);
                const bool form = run < 100 && noise != 4;
                if (form)
                    variogram(rate, 512, gamma);
                for (size_t i = 0; i < FACTORS; i++) {
                    const imk_allan_point *q = &p[i].point;
                    const double v = q->deviation * q->deviation;
                    const double truth = sqrt(make_noise(noise, random, run, NULL, factors[i]));
                    t[i].trials++;
                    t[i].sum += v;
                    t[i].squares += v * v;
                    t[i].edf += q->edf;
                    t[i].used += p[i].used;
                    t[i].covered += q->lower <= truth && truth <= q->upper;
                    t[i].unresolved += !p[i].resolved;
                    if (form && factors[i] <= 256) {
                        const double f = variogram_variance(gamma, factors[i]);
                        t[i].form_sum += f;
                        t[i].form_squares += f * f;
                    }
                }
            }
            printf("%s, %s\n    m  used  bias/sd  sd/complete  covers %%  edf/scatter's  "
                   "unresolved | variogram: bias/sd sd/truth (this: sd/truth)\n",
                   noise_name[noise], mask_name[mask]);
            for (size_t i = 0; i < FACTORS; i++) {
                const double n = (double)records;
                const double truth = make_noise(noise, random, 0, NULL, factors[i]);
                const double sd = scatter(t[i].sum, t[i].squares, records);
                complete[i] = mask == 0 ? sd : complete[i];
                const size_t forms = records < 100 ? records : 100;
                const double form_sd = scatter(t[i].form_sum, t[i].form_squares, forms);
                printf("%5zu  %.2f  %+6.2f   %6.2f      %5.1f     %5.2f         %4.2f   | ",
                       factors[i], t[i].used / n, (t[i].sum / n - truth) / sd, sd / complete[i],
                       100 * (double)t[i].covered / n, t[i].edf / n * sd * sd / 2 / truth / truth,
                       (double)t[i].unresolved / n);
                printf("%+6.2f  %.4f (%.4f)   bias/truth %+.4f\n",
                       (t[i].form_sum / (double)forms - truth) / form_sd, form_sd / truth,
                       sd / truth, t[i].sum / n / truth - 1);
            }
        }
    }
    free(workspace);
    return 0;
}
