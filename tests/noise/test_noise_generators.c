/* SPDX-License-Identifier: Apache-2.0 */
/* The generators against their own exact formulas. Two seeds each; every statistical check is
 * passed by a right generator with a probability above 1 - 1e-7 (chi-square checks are exact, the
 * others Student's t over some hundred independent streams), all of them together above 1 - 1e-5.
 */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"
#include "noise/generator_internal.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.141592653589793;
static const uint64_t seeds[] = {1, 20260517};

/* ---- the generators under one interface ----------------------------------------------------- */

typedef union any_state {
    imk_white_state white;
    imk_arma_state arma;
    imk_flicker_state flicker;
    imk_random_walk_state random_walk;
    imk_gauss_markov_state gauss_markov;
    imk_sinusoid_state sinusoid;
    imk_angle_white_state angle_white;
} any_state;

typedef struct generator {
    const char *name;
    void (*start)(any_state *state, imk_random random, uint64_t stream);
    void (*add)(any_state *state, size_t count, double *out);
    double (*allan_variance)(size_t n);
    double (*spectrum)(double f);
    double variance; /* of sample 0; 0: not stationary */
} generator;

static const double dt = 0.02;
static const imk_gauss_markov slow = {1.5, 2.0}, medium = {1.5, 0.1}, fast = {1.5, 0.01};
static const imk_low_pass first_order = {9.0, 0.0}, second_order = {7.0, 0.4}, wide = {400.0, 0.7};
static const imk_resonance ringing = {0.8, 13.0, 9.0}, folded = {0.8, 61.0, 30.0};
static const imk_sinusoid tone = {1.3, 7.7};

#define GENERATOR(name, member, START, avar, psd)                                                  \
    static void name##_start(any_state *state, imk_random random, uint64_t stream)                 \
    {                                                                                              \
        CHECK_OK(START);                                                                           \
    }                                                                                              \
    static void name##_add(any_state *state, size_t count, double *out)                            \
    {                                                                                              \
        imk_##member##_add(&state->member, count, out);                                            \
    }                                                                                              \
    static double name##_avar(size_t n)                                                            \
    {                                                                                              \
        return avar;                                                                               \
    }                                                                                              \
    static double name##_spectrum(double f)                                                        \
    {                                                                                              \
        (void)f;                                                                                   \
        return psd;                                                                                \
    }

GENERATOR(white, white, imk_white_start(&state->white, 0.4, dt, random, stream),
          imk_white_sampled_allan_variance(0.4, dt, n), imk_white_sampled_spectrum(0.4, dt, f))
GENERATOR(walk, random_walk, imk_random_walk_start(&state->random_walk, 0.4, dt, random, stream),
          imk_random_walk_sampled_allan_variance(0.4, dt, n),
          imk_random_walk_sampled_spectrum(0.4, dt, f))
GENERATOR(slow, gauss_markov,
          imk_gauss_markov_start(&state->gauss_markov, slow, dt, random, stream),
          imk_gauss_markov_sampled_allan_variance(slow, dt, n),
          imk_gauss_markov_sampled_spectrum(slow, dt, f))
GENERATOR(medium, gauss_markov,
          imk_gauss_markov_start(&state->gauss_markov, medium, dt, random, stream),
          imk_gauss_markov_sampled_allan_variance(medium, dt, n),
          imk_gauss_markov_sampled_spectrum(medium, dt, f))
GENERATOR(fast, gauss_markov,
          imk_gauss_markov_start(&state->gauss_markov, fast, dt, random, stream),
          imk_gauss_markov_sampled_allan_variance(fast, dt, n),
          imk_gauss_markov_sampled_spectrum(fast, dt, f))
/* Its samples depend on time/dt only: as of 1e6 s at 50 Hz, 1 Hz and 8 kHz; with three stages, with
 * two, and white. */
#define FLICKER(name, time)                                                                        \
    GENERATOR(name, flicker,                                                                       \
              imk_flicker_start(&state->flicker, (imk_flicker){0.9, time}, dt, random, stream),    \
              imk_flicker_sampled_allan_variance((imk_flicker){0.9, time}, dt, n),                 \
              imk_flicker_sampled_spectrum((imk_flicker){0.9, time}, dt, f))
FLICKER(flicker, 0)
FLICKER(flicker_at_1Hz, 2e4)
FLICKER(flicker_at_8kHz, 1.6e8)
FLICKER(short_flicker, 0.3)
FLICKER(brief_flicker, 0.1)
FLICKER(white_flicker, 0.02)
GENERATOR(first, arma, imk_filtered_white_start(&state->arma, 0.4, first_order, dt, random, stream),
          imk_filtered_white_sampled_allan_variance(0.4, first_order, dt, n),
          imk_filtered_white_sampled_spectrum(0.4, first_order, dt, f))
GENERATOR(second, arma,
          imk_filtered_white_start(&state->arma, 0.4, second_order, dt, random, stream),
          imk_filtered_white_sampled_allan_variance(0.4, second_order, dt, n),
          imk_filtered_white_sampled_spectrum(0.4, second_order, dt, f))
GENERATOR(wide, arma, imk_filtered_white_start(&state->arma, 0.4, wide, dt, random, stream),
          imk_filtered_white_sampled_allan_variance(0.4, wide, dt, n),
          imk_filtered_white_sampled_spectrum(0.4, wide, dt, f))
GENERATOR(ringing, arma, imk_resonance_start(&state->arma, ringing, dt, random, stream),
          imk_resonance_sampled_allan_variance(ringing, dt, n),
          imk_resonance_sampled_spectrum(ringing, dt, f))
GENERATOR(folded, arma, imk_resonance_start(&state->arma, folded, dt, random, stream),
          imk_resonance_sampled_allan_variance(folded, dt, n),
          imk_resonance_sampled_spectrum(folded, dt, f))
GENERATOR(tone, sinusoid, imk_sinusoid_start(&state->sinusoid, tone, dt, random, stream),
          imk_sinusoid_sampled_allan_variance(tone, dt, n), 0.0)

GENERATOR(angle, angle_white, imk_angle_white_start(&state->angle_white, 0.4, dt, random, stream),
          imk_angle_white_sampled_allan_variance(0.4, dt, n),
          imk_angle_white_sampled_spectrum(0.4, dt, f))

#define ENTRY(name, variance)                                                                      \
    {                                                                                              \
#name, name##_start, name##_add, name##_avar, name##_spectrum, variance                    \
    }

/* Variance of a filtered white sample: the spectrum's integral, by the midpoint rule. */
static double variance_of(const generator *g)
{
    enum { POINTS = 2000 };
    if (g->variance >= 0.0)
        return g->variance;
    double sum = 0.0;
    for (int i = 0; i < POINTS; i++)
        sum += g->spectrum((i + 0.5) / (2.0 * POINTS * dt));
    return sum / (POINTS * dt);
}

#define FLOOR (0.81 * 0.44127120030530319) /* B^2 ln 4/pi */
static const generator generators[] = {
    ENTRY(white, 0.16 / 0.02), ENTRY(walk, 0.0), ENTRY(slow, 2.25), ENTRY(medium, 2.25),
    ENTRY(fast, 2.25),
    /* stages of variance 1, and the fastest by the cubic of flicker.c; white: (8/3) x */
    ENTRY(flicker, FLOOR * 13.888709), ENTRY(flicker_at_1Hz, FLOOR * 11.058789),
    ENTRY(flicker_at_8kHz, FLOOR * 17.5614894), ENTRY(short_flicker, FLOOR * 3.04710577),
    ENTRY(brief_flicker, FLOOR * 2.24066527), ENTRY(white_flicker, FLOOR * 2.26618007),
    ENTRY(first, -1.0), ENTRY(second, -1.0), ENTRY(wide, -1.0), ENTRY(ringing, 0.64),
    ENTRY(folded, 0.64), ENTRY(tone, 0.0),
    ENTRY(angle, 2.0 * 0.16 / (0.02 * 0.02 * 0.02)), /* two readings of A^2/dt, over dt^2 */
};
enum { GENERATORS = sizeof generators / sizeof *generators };

static void draw(const generator *g, uint64_t seed, uint32_t run, size_t count, double *out)
{
    any_state *state = malloc(sizeof *state);
    assert_non_null(state);
    g->start(state, imk_random_seeded(seed), imk_stream(run, 9, 0, 0));
    memset(out, 0, count * sizeof *out);
    g->add(state, count, out);
    free(state);
}

/* ---- statistical checks --------------------------------------------------------------------- */

/* The mean of independent values is `expected`: |t| < 6, for 200 values of moderate skewness a
 * probability of about 1e-8. `bias` is a systematic error of the method, relative. */
static void check_mean(const double *values, size_t count, double expected, double bias,
                       const char *what)
{
    double mean = 0.0, square = 0.0;
    for (size_t i = 0; i < count; i++)
        mean += values[i] / (double)count;
    for (size_t i = 0; i < count; i++)
        square += (values[i] - mean) * (values[i] - mean);
    double error = sqrt(square / (double)(count - 1) / (double)count);
    /* 1e-12: where every stream gives the same value there is rounding alone */
    double off = fabs(mean - expected) - (bias + 1e-12) * fabs(expected);
    if (!(off < 6.0 * error))
        fail_msg("%s: mean %g, expected %g, standard error %g", what, mean, expected, error);
}

/* A sum of `count` independent squared normals of this variance is chi-square distributed. */
static void check_chi_square(double sum, size_t count, double variance, const char *what)
{
    double probability = imk_chi_square_probability(sum / variance, (double)count);
    if (!(probability > 5e-8 && probability < 1.0 - 5e-8))
        fail_msg("%s: mean square %g, expected %g", what, sum / (double)count, variance);
}

enum { STREAMS = 200, LENGTH = 2048 };

static double values[4][STREAMS];
static double samples[LENGTH * 8];

static double mean_of(const double *x, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += x[i];
    return sum / (double)n;
}

static void test_allan_variance(void **unused)
{
    (void)unused;
    const size_t length[] = {1, 3, 16, 100};
    for (size_t s = 0; s < 2; s++)
        for (int g = 0; g < GENERATORS; g++) {
            for (uint32_t run = 0; run < STREAMS; run++) {
                draw(&generators[g], seeds[s], run, LENGTH, samples);
                for (int j = 0; j < 4; j++) {
                    size_t n = length[j], pairs = LENGTH / (2 * n);
                    values[j][run] = 0.0;
                    for (size_t i = 0; i < pairs; i++) {
                        double step =
                            mean_of(samples + (2 * i + 1) * n, n) - mean_of(samples + 2 * i * n, n);
                        values[j][run] += step * step / (double)(2 * pairs);
                    }
                }
            }
            for (int j = 0; j < 4; j++)
                check_mean(values[j], STREAMS, generators[g].allan_variance(length[j]), 0.0,
                           generators[g].name);
        }
}

/* Slow stages: 16384 samples, means of 2048. */
static void test_flicker_slow(void **unused)
{
    (void)unused;
    for (size_t s = 0; s < 2; s++) {
        for (uint32_t run = 0; run < STREAMS; run++) {
            draw(&generators[5], seeds[s], run, LENGTH * 8, samples);
            double step = mean_of(samples, LENGTH * 4) - mean_of(samples + LENGTH * 4, LENGTH * 4);
            values[0][run] = step * step;
        }
        double sum = 0.0;
        for (uint32_t run = 0; run < STREAMS; run++)
            sum += values[0][run];
        check_chi_square(sum, STREAMS, 2.0 * generators[5].allan_variance(LENGTH * 4), "flicker");
    }
}

/* Periodograms under a Hann window, whose leakage from 4 cycles away is below 1 % for these. */
static void test_spectrum(void **unused)
{
    (void)unused;
    const int cycles[] = {100, 330, 700, 1000};
    for (int g = 0; g < GENERATORS; g++) {
        if (generators[g].variance == 0.0)
            continue;
        for (int j = 0; j < 4; j++) {
            static double cosine[LENGTH], sine[LENGTH];
            double power = 0.0;
            for (int i = 0; i < LENGTH; i++) {
                double window = sin(pi * (i + 0.5) / LENGTH), phase = 2.0 * pi * cycles[j] / LENGTH;
                cosine[i] = window * window * cos(phase * i);
                sine[i] = window * window * sin(phase * i);
                power += window * window * window * window;
            }
            for (uint32_t run = 0; run < STREAMS; run++) {
                draw(&generators[g], seeds[j % 2], run, LENGTH, samples);
                double re = 0.0, im = 0.0;
                for (int i = 0; i < LENGTH; i++) {
                    re += cosine[i] * samples[i];
                    im += sine[i] * samples[i];
                }
                values[0][run] = (re * re + im * im) * dt / power;
            }
            check_mean(values[0], STREAMS, generators[g].spectrum(cycles[j] / (LENGTH * dt)), 0.01,
                       generators[g].name);
        }
    }
}

/* Stationary from sample 0: the variance of samples 0 and 700, and of the step from 0 to 1, which
 * is twice the Allan variance at n = 1. Samples of different streams are independent normals. */
static void test_stationary_start(void **unused)
{
    (void)unused;
    enum { RUNS = 6000 };
    for (size_t s = 0; s < 2; s++)
        for (int g = 0; g < GENERATORS; g++) {
            if (generators[g].variance == 0.0)
                continue;
            double zero = 0.0, later = 0.0, step = 0.0;
            for (uint32_t run = 0; run < RUNS; run++) {
                bool far = run < RUNS / 10;
                draw(&generators[g], seeds[s], run, far ? 701 : 2, samples);
                zero += samples[0] * samples[0];
                step += (samples[1] - samples[0]) * (samples[1] - samples[0]);
                later += far ? samples[700] * samples[700] : 0.0;
            }
            double variance = variance_of(&generators[g]);
            check_chi_square(zero, RUNS, variance, generators[g].name);
            check_chi_square(later, RUNS / 10, variance, generators[g].name);
            check_chi_square(step, RUNS, 2.0 * generators[g].allan_variance(1), generators[g].name);
        }
}

/* From dt/T = 0.01 to 2: sample 0 has the full variance, and the correlation of neighbours is
 * exp(-dt/T), by the exactly chi-square distributed innovations x1 - phi x0. */
static void test_gauss_markov_any_step(void **unused)
{
    (void)unused;
    enum { RUNS = 6000 };
    for (double ratio = 0.01; ratio <= 2.0; ratio *= 2.3) {
        double zero = 0.0, innovation = 0.0, phi = exp(-ratio);
        for (uint32_t run = 0; run < RUNS; run++) {
            imk_gauss_markov_state state;
            double x[2] = {0.0, 0.0};
            CHECK_OK(imk_gauss_markov_start(&state, (imk_gauss_markov){3.0, 0.1}, 0.1 * ratio,
                                            imk_random_seeded(seeds[0]), imk_stream(run, 4, 0, 1)));
            imk_gauss_markov_add(&state, 2, x);
            zero += x[0] * x[0];
            innovation += (x[1] - phi * x[0]) * (x[1] - phi * x[0]);
        }
        check_chi_square(zero, RUNS, 9.0, "Gauss-Markov");
        check_chi_square(innovation, RUNS, 9.0 * -expm1(-2.0 * ratio), "Gauss-Markov step");
    }
}

/* K sqrt(dt), not K dt: the same walk after one second at 10, 100 and 1000 Hz. */
static void test_random_walk_rates(void **unused)
{
    (void)unused;
    for (size_t rate = 10; rate <= 1000; rate *= 10) {
        double steps = 0.0, second = 0.0;
        for (uint32_t run = 0; run < 400; run++) {
            imk_random_walk_state state;
            CHECK_OK(imk_random_walk_start(&state, 0.3, 1.0 / (double)rate,
                                           imk_random_seeded(seeds[0]), imk_stream(run, 3, 0, 0)));
            memset(samples, 0, sizeof samples);
            imk_random_walk_add(&state, rate + 1, samples);
            CHECK_CLOSE(samples[0], 0.0, 0.0);
            for (size_t i = 0; i < rate; i++)
                steps += (samples[i + 1] - samples[i]) * (samples[i + 1] - samples[i]);
            second += samples[rate] * samples[rate];
        }
        check_chi_square(steps, 400 * rate, 0.09 / (double)rate, "step of the walk");
        check_chi_square(second, 400, 0.09, "walk after 1 s");
    }
}

/* Axes and terms are independent: the mean product over streams is 0. */
static void test_streams_are_independent(void **unused)
{
    (void)unused;
    imk_random random = imk_random_seeded(seeds[0]);
    for (uint32_t run = 0; run < STREAMS; run++) {
        imk_white_state white;
        memset(samples, 0, sizeof samples);
        for (uint8_t axis = 0; axis < 2; axis++) {
            CHECK_OK(imk_white_start(&white, 1.0, 1.0, random, imk_stream(run, 1, 0, axis)));
            imk_white_add(&white, LENGTH, samples + LENGTH * axis);
        }
        values[0][run] = values[1][run] = 0.0;
        for (size_t i = 0; i < LENGTH; i++) {
            values[0][run] += samples[i] * samples[LENGTH + i];
            values[1][run] += samples[i] * samples[(i + 1) % LENGTH];
        }
    }
    check_mean(values[0], STREAMS, 0.0, 0.0, "product of two axes");
    check_mean(values[1], STREAMS, 0.0, 0.0, "product of neighbours");
}

/* ---- exact properties ------------------------------------------------------------------------ */

/* Any division into blocks gives the same bits, and a copy of a state continues alike. */
static void test_blocks(void **unused)
{
    (void)unused;
    const size_t piece[] = {1, 511, 1, 513, 3, 700, 31};
    static double pieces[LENGTH], copy[LENGTH];
    for (int g = 0; g < GENERATORS; g++) {
        any_state *state = malloc(2 * sizeof *state);
        assert_non_null(state);
        draw(&generators[g], 3, 0, LENGTH, samples);
        generators[g].start(state, imk_random_seeded(3), imk_stream(0, 9, 0, 0));
        memset(pieces, 0, sizeof pieces);
        size_t done = 0;
        for (size_t i = 0; done < LENGTH; i++) {
            size_t take = piece[i % 7] < LENGTH - done ? piece[i % 7] : LENGTH - done;
            if (i == 4) {
                memcpy(state + 1, state, sizeof *state);
                memset(copy, 0, sizeof copy);
                generators[g].add(state + 1, LENGTH - done, copy + done);
                assert_memory_equal(copy + done, samples + done, (LENGTH - done) * sizeof *copy);
            }
            generators[g].add(state, take, pieces + done);
            done += take;
        }
        assert_memory_equal(pieces, samples, sizeof pieces);
        free(state);
    }
}

/* `add` adds: what was there stays. */
static void test_add(void **unused)
{
    (void)unused;
    for (int g = 0; g < GENERATORS; g++) {
        any_state *state = malloc(sizeof *state);
        assert_non_null(state);
        draw(&generators[g], 3, 0, 100, samples);
        for (size_t i = 0; i < 100; i++)
            samples[LENGTH + i] = 1024.0;
        generators[g].start(state, imk_random_seeded(3), imk_stream(0, 9, 0, 0));
        generators[g].add(state, 100, samples + LENGTH);
        for (size_t i = 0; i < 100; i++)
            CHECK_CLOSE(samples[LENGTH + i], 1024.0 + samples[i], 0.0);
        free(state);
    }
}

/* Nothing repeats after 16384 samples, as a table of vibration would. */
static void test_no_period(void **unused)
{
    (void)unused;
    static double record[2 * 16384];
    for (int g = 0; g < GENERATORS; g++) {
        draw(&generators[g], 3, 0, 2 * 16384, record);
        double same = 0.0, different = 0.0;
        for (size_t i = 0; i < 16384; i++) {
            same += record[i] * record[i];
            different += (record[i] - record[i + 16384]) * (record[i] - record[i + 16384]);
        }
        CHECK_BELOW(0.05 * same, different);
    }
}

/* The recursion of a Gauss-Markov process by the book, one sample after another, from the normals
 * that noise.h assigns: equal to rounding. */
static void test_gauss_markov_recursion(void **unused)
{
    (void)unused;
    enum { COUNT = 1024 };
    static double normals[COUNT];
    imk_random random = imk_random_seeded(5);
    imk_gauss_markov_state state;
    CHECK_OK(imk_gauss_markov_start(&state, slow, dt, random, 77));
    imk_random_normals(random, 77, 0, COUNT, normals);
    memset(samples, 0, COUNT * sizeof *samples);
    imk_gauss_markov_add(&state, COUNT, samples);
    double start, phi = exp(-dt / slow.correlation_time);
    imk_random_normals(random, 77, (uint64_t)1 << 63, 1, &start);
    double y = slow.sigma * start, q = slow.sigma * sqrt(1.0 - phi * phi);
    for (size_t k = 0; k < COUNT; k++) {
        size_t in_block = k % 512;
        y = phi * y + q * normals[k - in_block + 16 * (in_block % 32) + in_block / 32];
        CHECK_CLOSE(samples[k], y, 1e-13); /* 1/(1 - phi) = 100 roundings of 1e-16 */
    }
}

/* The ARMA recursion by the book, from the starting values in the state and normal k for sample k.
 */
static void test_arma_recursion(void **unused)
{
    (void)unused;
    enum { COUNT = 1500 };
    static double normals[COUNT];
    imk_random random = imk_random_seeded(5);
    imk_arma_state state;
    CHECK_OK(imk_filtered_white_start(&state, 0.4, second_order, dt, random, 77));
    double y[3] = {0.0, state.y1, state.y2}, e[3] = {0.0, state.e1, state.e2};
    const double a1 = state.a1, a2 = state.a2, b0 = state.b0, b1 = state.b1, b2 = state.b2;
    imk_random_normals(random, 77, 0, COUNT, normals);
    memset(samples, 0, COUNT * sizeof *samples);
    imk_arma_add(&state, COUNT, samples);
    for (size_t k = 0; k < COUNT; k++) {
        e[0] = normals[k];
        y[0] = a1 * y[1] + a2 * y[2] + b0 * e[0] + b1 * e[1] + b2 * e[2];
        CHECK_CLOSE(samples[k], y[0], 1e-13); /* another order of the five sums */
        for (int i = 2; i > 0; i--) {
            y[i] = y[i - 1];
            e[i] = e[i - 1];
        }
    }
}

/* Sequences computed together, in lanes, have the bits each has alone, with every kernel. */
static void test_arma_together(void **unused)
{
    (void)unused;
    enum { BLOCK = IMK_NOISE_BLOCK, BLOCKS = 3, MOST = IMKI_ARMA_LANES };
    static imk_arma_state alone[MOST], lane[MOST];
    static double expected[MOST][BLOCKS * BLOCK], block[MOST][BLOCK];
    const imk_random random = imk_random_seeded(5);
    imk_arma_state *states[MOST];
    double *blocks[MOST];
    for (size_t i = 0; i < MOST; i++) {
        const imk_resonance resonance = {0.3 * (double)(i + 1), 7.0 * (double)(i + 1), 3.0};
        CHECK_OK(imk_resonance_start(&alone[i], resonance, 0.01, random, 40 + i));
        for (size_t k = 0; k < BLOCKS * BLOCK; k++)
            expected[i][k] = (double)k;
        lane[i] = alone[i];
        imk_arma_add(&alone[i], BLOCKS * BLOCK, expected[i]);
        states[i] = &lane[i];
        blocks[i] = block[i];
    }
    for (imk_kernel kernel = IMK_KERNEL_SCALAR;; kernel = random.kernel) {
        for (size_t count = 0; count <= MOST; count++) {
            imk_arma_state before[MOST];
            memcpy(before, lane, sizeof before);
            for (size_t b = 0; b < BLOCKS; b++) {
                for (size_t i = 0; i < count; i++)
                    for (size_t k = 0; k < BLOCK; k++)
                        block[i][imki_place(k)] = (double)(b * BLOCK + k);
                lane[0].random.kernel = kernel;
                imki_arma_blocks(states, count, blocks);
                for (size_t i = 0; i < count; i++)
                    for (size_t k = 0; k < BLOCK; k++)
                        CHECK_CLOSE(block[i][imki_place(k)], expected[i][b * BLOCK + k], 0.0);
            }
            memcpy(lane, before, sizeof before);
        }
        if (kernel == random.kernel)
            break;
    }
}

/* A million samples on, the phase is what the frequency says, by 128-bit arithmetic; 1e9 samples on
 * the count is still exact, as it has no fraction to lose. */
static void test_sinusoid_phase(void **unused)
{
    (void)unused;
    enum { COUNT = 1000000 };
    imk_sinusoid_state state;
    CHECK_OK(
        imk_sinusoid_start(&state, (imk_sinusoid){2.0, 123.456789}, 1e-3, imk_random_seeded(1), 4));
    double start = (double)state.phase * 0x1p-64;
    uint64_t expected = state.phase + state.step * COUNT;
    for (size_t k = 0; k < COUNT; k += 1000) {
        memset(samples, 0, 1000 * sizeof *samples);
        imk_sinusoid_add(&state, 1000, samples);
        long double cycles = (long double)start + (long double)(123.456789 * 1e-3) * (long double)k;
        cycles -= floorl(cycles);
        /* 64-bit long double: k 2^-64; 53-bit: 1e6 * 1e-17 */
        CHECK_CLOSE(samples[0], 2.0 * sin(2.0 * pi * (double)cycles), 1e-9);
    }
    imk_sinusoid_state fresh = state;
    CHECK_CLOSE((double)(fresh.phase - expected - fresh.step * (512 - COUNT % 512)), 0.0, 0.0);
}

/* ---- quantization ---------------------------------------------------------------------------- */

/* The outputs are whole steps, and their sum never strays more than half a step from the integral:
 * no rate is lost, however small. */
static void test_quantization_residual(void **unused)
{
    (void)unused;
    const double q = 1e-5, lsb = q * sqrt(12.0), interval = 0.01;
    const double rate[] = {9.8e-9, -3.1e-5, 0.7, 9.80665, -150.0}; /* 0.002 deg/h first */
    for (size_t r = 0; r < 5; r++) {
        imk_quantization_state state;
        CHECK_OK(imk_quantization_start(&state, q, interval, imk_random_seeded(8), r));
        long double in = state.residual, out = 0.0L;
        assert_true(fabs(state.residual) <= lsb / 2.0);
        for (int block = 0; block < 200; block++) {
            for (size_t i = 0; i < 1000; i++) {
                samples[i] = rate[r] * (1.0 + 0.3 * sin(0.01 * (double)i));
                samples[LENGTH + i] = samples[i];
            }
            imk_quantization_apply(&state, 1000, samples);
            for (size_t i = 0; i < 1000; i++) {
                in += (long double)samples[LENGTH + i] * interval;
                out += (long double)samples[i] * interval;
                double steps = samples[i] * interval / lsb;
                CHECK_CLOSE(steps, rint(steps), 1e-15 * (1.0 + fabs(steps)) * 4.0);
                /* rounding of 2e5 sums of up to 1.5 * 16: 1e-11 beside lsb/2 = 1.7e-5 */
                CHECK_BELOW((double)fabsl(in - out), lsb / 2.0 + 1e-11);
            }
        }
    }
}

/* A busy input: 3 Q^2/tau^2 on top of the input's own Allan variance. White noise of 3 lsb a sample
 * fills the step so evenly that the correction is below e^-100. */
static void test_quantization_allan_variance(void **unused)
{
    (void)unused;
    const double q = 1.0, interval = 0.1;
    const size_t length[] = {1, 4, 16};
    for (size_t s = 0; s < 2; s++) {
        for (uint32_t run = 0; run < STREAMS; run++) {
            imk_white_state white;
            imk_quantization_state state;
            imk_random random = imk_random_seeded(seeds[s]);
            CHECK_OK(imk_white_start(&white, 10.0 * sqrt(interval) / interval, interval, random,
                                     imk_stream(run, 1, 0, 0)));
            CHECK_OK(imk_quantization_start(&state, q, interval, random, imk_stream(run, 7, 0, 0)));
            memset(samples, 0, sizeof samples);
            imk_white_add(&white, LENGTH, samples);
            memcpy(samples + LENGTH, samples, LENGTH * sizeof *samples);
            imk_quantization_apply(&state, LENGTH, samples);
            for (int j = 0; j < 3; j++) { /* of output minus input: the noise alone */
                size_t n = length[j], pairs = LENGTH / (2 * n);
                values[j][run] = 0.0;
                for (size_t i = 0; i < pairs; i++) {
                    double mean[2];
                    for (size_t k = 0; k < 2; k++)
                        mean[k] = mean_of(samples + (2 * i + k) * n, n) -
                                  mean_of(samples + LENGTH + (2 * i + k) * n, n);
                    values[j][run] +=
                        (mean[1] - mean[0]) * (mean[1] - mean[0]) / (double)(2 * pairs);
                }
            }
        }
        for (int j = 0; j < 3; j++)
            check_mean(values[j], STREAMS,
                       imk_quantization_sampled_allan_variance(q, interval, length[j]), 0.0,
                       "quantization");
    }
}

/* The starting residual is uniform: mean 0, variance Q^2. */
static void test_quantization_start(void **unused)
{
    (void)unused;
    for (uint32_t run = 0; run < STREAMS; run++) {
        imk_quantization_state state;
        CHECK_OK(imk_quantization_start(&state, 2.0, 1.0, imk_random_seeded(1),
                                        imk_stream(run, 7, 0, 0)));
        values[0][run] = state.residual;
        values[1][run] = state.residual * state.residual;
    }
    check_mean(values[0], STREAMS, 0.0, 0.0, "residual");
    check_mean(values[1], STREAMS, 4.0, 0.0, "square of the residual");
}

static void test_ramp(void **unused)
{
    (void)unused;
    double out[3] = {1.0, 1.0, 1.0};
    imk_ramp_add(2.0, 0.25, 10, 3, out);
    CHECK_CLOSE(out[0], 6.0, 0.0);
    CHECK_CLOSE(out[2], 7.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_allan_variance),
        cmocka_unit_test(test_flicker_slow),
        cmocka_unit_test(test_spectrum),
        cmocka_unit_test(test_stationary_start),
        cmocka_unit_test(test_gauss_markov_any_step),
        cmocka_unit_test(test_random_walk_rates),
        cmocka_unit_test(test_streams_are_independent),
        cmocka_unit_test(test_blocks),
        cmocka_unit_test(test_add),
        cmocka_unit_test(test_no_period),
        cmocka_unit_test(test_gauss_markov_recursion),
        cmocka_unit_test(test_arma_recursion),
        cmocka_unit_test(test_arma_together),
        cmocka_unit_test(test_sinusoid_phase),
        cmocka_unit_test(test_quantization_residual),
        cmocka_unit_test(test_quantization_allan_variance),
        cmocka_unit_test(test_quantization_start),
        cmocka_unit_test(test_ramp),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
