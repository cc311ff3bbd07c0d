/* SPDX-License-Identifier: Apache-2.0 */
/* Screening of simulated records: false alarms and what is found.
 *
 * usage: screen [records] [seed] [parts: letters of stfj, speed, trends, faults, jumps]
 *
 * First the faults: sound records of several noises, and the same with 0.1 % of samples 50 sigma
 * off, single or in bursts of ten. Then the warm-up and the temperature: how often slow noise is
 * called one (16384 samples a record), and how often a true one is seen, with the spread of its
 * amplitude and time in stated standard deviations. Then jumps of the level at a significance of
 * 1e-3/6, in whole records and in such with four holes: how often slow noise is called one, and how
 * often one of 4 or 8 B is found. */
#include "imukit/imukit.h"
#include "imukit/record_screen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SAMPLES = 65536, SHORT = 16384, NOISES = 10 };

static const char *const noise_name[NOISES] = {"white",
                                               "steps of 0.1 sigma",
                                               "steps of 3 sigma",
                                               "50 sigma line",
                                               "resonance",
                                               "flicker",
                                               "random walk",
                                               "half of it 5 times noisier",
                                               "a step of 20 sigma",
                                               "N + B + K in steps of 0.5 sigma"};

static void add_noise(double white, double flicker, double walk, imk_random random, uint32_t run,
                      size_t n, double *out)
{
    static imk_white_state w;
    static imk_flicker_state f;
    static imk_random_walk_state k;
    memset(out, 0, n * sizeof *out);
    if (white > 0 && imk_white_start(&w, white, 1, random, imk_stream(run, 1, 0, 0)) == IMK_OK)
        imk_white_add(&w, n, out);
    if (flicker > 0 && imk_flicker_start(&f, (imk_flicker){flicker, 0}, 1, random,
                                         imk_stream(run, 2, 0, 0)) == IMK_OK)
        imk_flicker_add(&f, n, out);
    if (walk > 0 && imk_random_walk_start(&k, walk, 1, random, imk_stream(run, 3, 0, 0)) == IMK_OK)
        imk_random_walk_add(&k, n, out);
}

static void make(int noise, imk_random random, uint32_t run, double *out)
{
    static imk_arma_state resonance;
    add_noise(noise == 5   ? 0.1
              : noise == 6 ? 0
                           : 1,
              noise == 5   ? 1
              : noise == 9 ? 0.3
                           : 0,
              noise == 6   ? 1
              : noise == 9 ? 0.01
                           : 0,
              random, run, SAMPLES, out);
    const imk_resonance ring = {10, 0.2, 100};
    if (noise == 4 &&
        imk_resonance_start(&resonance, ring, 1, random, imk_stream(run, 4, 0, 0)) == IMK_OK)
        imk_arma_add(&resonance, SAMPLES, out);
    const double step = noise == 1 ? 0.1 : noise == 2 ? 3 : noise == 9 ? 0.5 : 0;
    for (size_t i = 0; i < SAMPLES; i++) {
        out[i] += noise == 3 ? 50 * sin(0.7 * (double)i) : 0;
        out[i] *= noise == 7 && i > SAMPLES / 2 ? 5 : 1;
        out[i] += noise == 8 && i > SAMPLES / 3 ? 20 : 0;
        out[i] = step > 0 ? step * floor(out[i] / step + 0.5) : out[i];
    }
}

static void faults(uint32_t records, imk_random random, void *workspace, size_t size)
{
    static double rate[SAMPLES];
    for (int noise = 0; noise < NOISES; noise++) {
        size_t alarms = 0, false_outliers = 0, stuck = 0, saturated = 0, steps = 0, found = 0,
               put = 0, burst_found = 0, burst_put = 0, warm = 0;
        for (uint32_t run = 0; run < records; run++) {
            imk_screen_settings settings = imk_screen_default();
            imk_screen s;
            settings.dt = 0.01;
            make(noise, random, run, rate);
            if (imk_screen_channel(&settings, SAMPLES, rate, &s, workspace, size, NULL) != IMK_OK)
                continue;
            alarms += s.outliers.count > 0;
            false_outliers += s.outliers.count;
            stuck += s.stuck.count > 0;
            saturated += s.saturated.count > 0;
            steps += s.steps.count > 0;
            warm += s.warm_up;
            /* Outliers of 50 sigma of the fast noise. */
            const double size50 = 50 * (noise == 4 ? 10 : noise == 3 ? 35 : 1);
            static uint32_t word[SAMPLES];
            imk_random_words(random, imk_stream(run, 9, 0, 0), 0, SAMPLES, word);
            size_t now = 0;
            for (size_t i = 0; i < SAMPLES; i++)
                if (word[i] < 4294967) {
                    rate[i] += word[i] % 2 ? size50 : -size50;
                    now++;
                }
            put += now;
            if (imk_screen_channel(&settings, SAMPLES, rate, &s, workspace, size, NULL) == IMK_OK)
                found += s.outliers.count;
            make(noise, random, run, rate);
            for (size_t i = 5000; i < 60000; i += 10000)
                for (size_t k = 0; k < 10; k++)
                    rate[i + k] += size50;
            burst_put += 60;
            if (imk_screen_channel(&settings, SAMPLES, rate, &s, workspace, size, NULL) == IMK_OK)
                burst_found += s.outliers.count;
        }
        const double n = (double)records;
        printf("%-34s outliers in %5.3f of records (%.2f each), stuck %.3f, saturated %.3f, steps "
               "%.3f, warm-up %.3f; found of 50-sigma outliers %.4f, of bursts of ten %.4f\n",
               noise_name[noise], (double)alarms / n, (double)false_outliers / n, (double)stuck / n,
               (double)saturated / n, (double)steps / n, (double)warm / n,
               (double)found / (double)put, (double)burst_found / (double)burst_put);
    }
}

static void trends(uint32_t records, imk_random random, void *workspace, size_t size)
{
    static const struct {
        const char *name;
        double white, flicker, walk, ramp, warm_up, time, slope;
    } cases[] = {{"white", 1, 0, 0, 0, 0, 1, 0},
                 {"N + B", 1, 0.1, 0, 0, 0, 1, 0},
                 {"B", 0.1, 1, 0, 0, 0, 1, 0},
                 {"N + B + K", 1, 0.1, 0.001, 0, 0, 1, 0},
                 {"N + B + strong K", 1, 0.1, 0.03, 0, 0, 1, 0},
                 {"K", 0, 0, 1, 0, 0, 1, 0},
                 {"N + B + ramp", 1, 0.1, 0, 1e-4, 0, 1, 0},
                 {"N + B, warm-up 0.5", 1, 0.1, 0, 0, 0.5, 2000, 0},
                 {"N + B, warm-up 1", 1, 0.1, 0, 0, 1, 2000, 0},
                 {"N + B + K, warm-up 2", 1, 0.1, 0.001, 0, 2, 2000, 0},
                 {"N + B + K, fast warm-up 2", 1, 0.1, 0.001, 0, 2, 200, 0},
                 {"N + B, warm-up 100", 1, 0.1, 0, 0, 100, 1500, 0},
                 {"N + B + strong K, warm-up 5", 1, 0.1, 0.03, 0, 5, 1000, 0},
                 {"N + B, slope 0.05", 1, 0.1, 0, 0, 0, 1, 0.05},
                 {"N + B + strong K, slope 0.5", 1, 0.1, 0.03, 0, 0, 1, 0.5}};
    static double rate[SHORT], temperature[SHORT];
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        size_t warm = 0, thermal = 0, square = 0, covered = 0, both = 0;
        double amplitude = 0, amplitudes = 0, times = 0, slopes = 0;
        for (uint32_t run = 0; run < records; run++) {
            imk_screen_settings settings = imk_screen_default();
            settings.significance = 0.01;
            imk_screen s;
            settings.dt = 1;
            add_noise(cases[c].white, cases[c].flicker, cases[c].walk, random, run, SHORT, rate);
            for (size_t i = 0; i < SHORT; i++) {
                const double t = (double)i;
                temperature[i] = 3 * sin(t / 2500 + run) + 2 * t / SHORT;
                rate[i] += 9.8 + cases[c].ramp * t + cases[c].warm_up * exp(-t / cases[c].time) +
                           cases[c].slope * temperature[i];
            }
            if (imk_screen_channel(&settings, SHORT, rate, &s, workspace, size, NULL) != IMK_OK)
                continue;
            warm += s.warm_up;
            if (s.warm_up) {
                const double a =
                    (s.warm_up_amplitude - cases[c].warm_up) / s.warm_up_amplitude_sigma;
                amplitude += a;
                amplitudes += a * a;
                covered += fabs(a) < 1.96;
                times += pow((s.warm_up_time - cases[c].time) / s.warm_up_time_sigma, 2);
            }
            settings.temperature = temperature;
            imk_screen_channel(&settings, SHORT, rate, &s, workspace, size, NULL);
            thermal += s.temperature_degree > 0;
            square += s.temperature_degree > 1;
            both += s.warm_up;
            if (s.temperature_degree == 1)
                slopes +=
                    pow((s.temperature_slope - cases[c].slope) / s.temperature_slope_sigma, 2);
        }
        const double n = (double)records, w = (double)warm;
        printf("%-28s at 0.01: warm-up %.4f (amplitude off by %+.2f, rms %.2f of its sigma, covers "
               "%.3f; time rms %.2f); with a temperature column: follows it %.4f (square %.4f), "
               "slope rms %.2f of its sigma, warm-up %.4f\n",
               cases[c].name, w / n, amplitude / w, sqrt(amplitudes / w), (double)covered / w,
               sqrt(times / w), (double)thermal / n, (double)square / n,
               sqrt(slopes / (double)(thermal - square)), (double)both / n);
    }
}

/* Four holes that take a fifth of the record, with a few samples in them. */
static void make_holes(imk_random random, uint32_t run, double *rate)
{
    uint32_t word[8];
    imk_random_words(random, imk_stream(run, 7, 0, 0), 0, 8, word);
    for (size_t h = 0; h < 4; h++) {
        const size_t from = h * SAMPLES / 4 + word[2 * h] % (SAMPLES / 6);
        const size_t length = word[2 * h + 1] % (SAMPLES / 10);
        for (size_t i = from; i < from + length && i < SAMPLES; i++)
            if (i % 997 > 3)
                rate[i] = (double)NAN;
    }
}

static void jumps(uint32_t records, imk_random random, void *workspace, size_t size)
{
    static const struct {
        const char *name;
        double white, flicker, walk, markov, time, ramp, warm_up;
    } cases[] = {{"N", 1, 0, 0, 0, 1, 0, 0},
                 {"N + B", 1, 0.1, 0, 0, 1, 0, 0},
                 {"B", 0.1, 1, 0, 0, 1, 0, 0},
                 {"N + B + K", 1, 0.1, 0.001, 0, 1, 0, 0},
                 {"N + B + strong K", 1, 0.1, 0.03, 0, 1, 0, 0},
                 {"K", 0, 0, 1, 0, 1, 0, 0},
                 {"N + GM of 100", 1, 0, 0, 1, 100, 0, 0},
                 {"N + GM of 3000", 1, 0, 0, 1, 3000, 0, 0},
                 {"N + strong GM of 1000", 1, 0, 0, 10, 1000, 0, 0},
                 {"N + B + ramp", 1, 0.1, 0, 0, 1, 1e-4, 0},
                 {"N + B + strong ramp", 1, 0.1, 0, 0, 1, 1e-2, 0},
                 {"N + B, warm-up 2", 1, 0.1, 0, 0, 1, 0, 2},
                 {"N + B, warm-up 100", 1, 0.1, 0, 0, 1, 0, 100}};
    static double rate[SAMPLES], holed[SAMPLES];
    static imk_gauss_markov_state state;
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        size_t called = 0, with_holes = 0, found[2] = {0, 0}, placed[2] = {0, 0};
        for (uint32_t run = 0; run < records; run++) {
            imk_screen_settings settings = imk_screen_default();
            settings.significance = 1e-3 / 6;
            settings.dt = 1;
            imk_screen s;
            add_noise(cases[c].white, cases[c].flicker, cases[c].walk, random, run, SAMPLES, rate);
            const imk_gauss_markov markov = {cases[c].markov, cases[c].time};
            if (markov.sigma > 0 && imk_gauss_markov_start(&state, markov, 1, random,
                                                           imk_stream(run, 4, 0, 0)) == IMK_OK)
                imk_gauss_markov_add(&state, SAMPLES, rate);
            for (size_t i = 0; i < SAMPLES; i++)
                rate[i] +=
                    9.8 + cases[c].ramp * (double)i + cases[c].warm_up * exp(-(double)i / 5000);
            if (imk_screen_channel(&settings, SAMPLES, rate, &s, workspace, size, NULL) == IMK_OK)
                called += s.steps.count > 0;
            memcpy(holed, rate, sizeof rate);
            make_holes(random, run, holed);
            if (imk_screen_channel(&settings, SAMPLES, holed, &s, workspace, size, NULL) == IMK_OK)
                with_holes += s.steps.count > 0;
            const double unit = cases[c].flicker > 0 ? cases[c].flicker : 0.1;
            const size_t place = SAMPLES / 5 + run * 97 % (SAMPLES / 2);
            for (int k = 0; k < 2; k++) {
                for (size_t i = 0; i < SAMPLES; i++)
                    holed[i] = rate[i] + (i >= place ? (k == 0 ? 4 : 8) * unit : 0);
                if (imk_screen_channel(&settings, SAMPLES, holed, &s, workspace, size, NULL) !=
                    IMK_OK)
                    continue;
                found[k] += s.steps.count > 0;
                placed[k] += s.steps.count > 0 &&
                             fabs((double)s.steps.first - (double)place) < SAMPLES / 256;
            }
        }
        const double n = (double)records;
        printf("%-24s jumps called in %.4f of records, with holes %.4f; one of 4 B found in %.3f "
               "(at its place %.3f), of 8 B in %.3f (%.3f)\n",
               cases[c].name, (double)called / n, (double)with_holes / n, (double)found[0] / n,
               (double)placed[0] / n, (double)found[1] / n, (double)placed[1] / n);
    }
}

static void speed(imk_random random)
{
    enum { LONG = 1000000 };
    double *rate = malloc(LONG * sizeof *rate);
    const size_t size = imk_screen_workspace_size(LONG);
    void *workspace = malloc(size);
    if (rate && workspace) {
        double best = HUGE_VAL;
        imk_random_normals(random, 0, 0, LONG, rate);
        for (int round = 0; round < 5; round++) {
            imk_screen_settings settings = imk_screen_default();
            imk_screen s;
            settings.dt = 0.01;
            const clock_t begin = clock();
            imk_screen_channel(&settings, LONG, rate, &s, workspace, size, NULL);
            best = fmin(best, (double)(clock() - begin) / CLOCKS_PER_SEC);
        }
        printf("1e6 samples: %.1f ns each\n", best * 1e9 / LONG);
    }
    free(rate);
    free(workspace);
}

int main(int argc, char **argv)
{
    const uint32_t records = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : 500;
    const imk_random random = imk_random_seeded(argc > 2 ? strtoull(argv[2], NULL, 10) : 1);
    const size_t size = imk_screen_workspace_size(SAMPLES);
    void *workspace = malloc(size);
    if (!workspace)
        return 1;
    const char *parts = argc > 3 ? argv[3] : "stfj";
    if (strchr(parts, 's'))
        speed(random);
    if (strchr(parts, 't'))
        trends(records, random, workspace, size);
    if (strchr(parts, 'f'))
        faults(records / 10, random, workspace, size);
    if (strchr(parts, 'j'))
        jumps(records, random, workspace, size);
    free(workspace);
    return 0;
}
