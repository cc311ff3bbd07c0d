/* SPDX-License-Identifier: Apache-2.0 */
/* Flicker noise S(f) = B^2/(2 pi f) as a sum of first-order stages [KESHNER1982].
 *
 * Lorentzian spectra of variance v with correlation times in geometric progression r add up to
 * v/(2 ln(r) f) but for a ripple; hence v = (ln r/pi) B^2, here with r = 4. The times are those of
 * the noise, not of its samples: T 4^-k, k = 0, 1 …, down to the last one of at least SHORTEST dt.
 * The longest is such that all stages together have the density B^2 T_L at 0 Hz, to which the
 * spectrum rises at f = 1/(2 pi T_L): (8/3) v T = B^2 T_L. Stages are counted from the fastest.
 * Stage 1 has that last time, x dt with 1.5 <= x < 6, and changes at every sample; stage j >= 2 of
 * time 4^(j-1) x dt is a first-order sequence whose values are held for h = 4^(j-1) samples. The
 * moments of change have a random phase common to all stages, so that the sequence is stationary: a
 * held stage has the autocovariance of its coarse sequence, interpolated linearly. All of them have
 *
 *     phi = (2 x - 1)/(2 x + 1)
 *
 * per change, with which a stage has the variance of its process and its density at 0 Hz, 2 v T,
 * whatever dt. The Allan variance of any stationary process, integrated over log tau, depends on
 * its variance alone, so holding does not move the level.
 *
 * Stage 0 stands for all that are faster. Its variance and its phi are functions of x chosen to
 * make the largest deviation of the Allan deviation from the ideal one smallest from 2 dt on
 * (tests/reference/flicker_stages.py). Where even the longest time is below SHORTEST dt, it is
 * white noise of the density at 0 Hz. */
#include "noise_terms_internal.h"

#define SHORTEST 1.5                /* [dt] */
#define VARIANCE 0.4412712003053032 /* ln 4/pi */
#define LONGEST 0.8498175265925988  /* 3 pi/(8 ln 4) [T_L] */
#define STAGES IMK_FLICKER_STAGES
#define NO_MEMORY -1000.0 /* its exponential is 0 */

/* The stages of samples 1 apart. */
typedef struct flicker_stages {
    int count;           /* the fastest included */
    double x;            /* time of stage 1 */
    double variance;     /* of all stages but the fastest */
    double fastest;      /* the fastest's relative to it */
    double decay[2];     /* phi of stage 0, of the others */
    double log_decay[2]; /* their logarithms */
} flicker_stages;

static double time_of(imk_flicker flicker)
{
    return flicker.correlation_time > 0.0 ? flicker.correlation_time : IMK_FLICKER_TIME;
}

/* Cubics in ln x: tests/reference/flicker_stages.py */
static flicker_stages stages_of(imk_flicker flicker, double dt)
{
    double x = LONGEST * time_of(flicker) / dt;
    flicker_stages stages = {.count = 1,
                             .variance = VARIANCE * flicker.instability * flicker.instability,
                             .fastest = 8.0 / 3.0 * x,
                             .log_decay = {NO_MEMORY, NO_MEMORY}};
    if (!(x >= SHORTEST))
        return stages;
    stages.count = 2;
    for (; x >= 4.0 * SHORTEST && stages.count < STAGES; x *= 0.25)
        stages.count++;
    const double l = imk_ln(x);
    stages.x = x;
    stages.fastest = 0.24881 + l * (0.66356 + l * (0.048 - 0.02265 * l));
    stages.decay[0] = 0.36056 + l * (-0.34515 + l * (0.37854 - 0.08901 * l));
    stages.decay[1] = (2.0 * x - 1.0) / (2.0 * x + 1.0);
    for (int i = 0; i < 2; i++)
        stages.log_decay[i] = imk_ln(stages.decay[i]);
    return stages;
}

double imk_flicker_allan_variance(double instability, double tau)
{
    (void)tau;
    return VARIANCE * instability * instability; /* 2 ln 2/pi is the same number */
}

/* Variance of the sum of n samples of a held stage of unit variance. The autocovariance at lag
 * a h + b is phi^a (1 - p b/h), p = 1 - phi; with n = a h + b and decay = phi^a,
 *
 *     V = 2 [ (n E0 - E1) G0 - h E0 G1 + phi^a (b (b+1)/2 - p/h (b-1) b (b+1)/6) ] - n
 *     E0 = sum_{b<h} (1 - p b/h),  E1 = sum b (1 - p b/h),  G0 = sum_{i<a} phi^i,  G1 = sum i phi^i
 */
static double variance_of_sum(double n, double h, double phi, double log_phi)
{
    double a = floor(n / h), b = n - a * h, p = 1.0 - phi;
    double decay = imk_exp(a * log_phi);
    double e0 = h - 0.5 * p * (h - 1.0);
    double e1 = 0.5 * h * (h - 1.0) - p * (h - 1.0) * (2.0 * h - 1.0) / 6.0;
    double g0 = (1.0 - decay) / p;
    double g1 = (phi * g0 - a * decay) / p;
    double rest = 0.5 * b * (b + 1.0) - p / h * (b - 1.0) * b * (b + 1.0) / 6.0;
    return 2.0 * ((n * e0 - e1) * g0 - h * e0 * g1 + decay * rest) - n;
}

/* factor[0] V(n) + factor[1] V(2 n), V(n) the variance of the sum of n samples. */
static double sums_of_samples(imk_flicker flicker, double dt, double n, const double factor[2])
{
    const flicker_stages stages = stages_of(flicker, dt);
    double sum = 0.0, hold = 1.0;
    for (int stage = 0; stage < stages.count; stage++) {
        const int which = stage > 0;
        double part = 0.0;
        for (int i = 0; i < 2; i++)
            if (factor[i] != 0.0)
                part += factor[i] * variance_of_sum((double)(i + 1) * n, hold, stages.decay[which],
                                                    stages.log_decay[which]);
        sum += (stage == 0 ? stages.fastest : 1.0) * part;
        hold *= stage == 0 ? 1.0 : 4.0;
    }
    return stages.variance * sum;
}

/* sigma_A^2 = (4 V(n) - V(2 n))/(2 n^2) for any stationary process. */
double imk_flicker_sampled_allan_variance(imk_flicker flicker, double dt, size_t n)
{
    const double m = (double)n;
    return sums_of_samples(flicker, dt, m, (const double[2]){4.0, -1.0}) / (2.0 * m * m);
}

double imk_flicker_mean_variance(imk_flicker flicker, double dt, size_t n)
{
    const double m = (double)n;
    return sums_of_samples(flicker, dt, m, (const double[2]){1.0, 0.0}) / (m * m);
}

/* Spectrum of a stage of unit variance at dt = 1, without its 1/sin^2(pi f) if held. A held stage:
 * the triangle of width h transforms to sin^2(pi f h)/(h sin^2(pi f)), and with s = sin^2(pi f h)
 * its coarse sequence to (1 - phi^2)/((1 - phi)^2 + 4 phi s). f h is exact, h being a power of 4.
 */
static double stage_spectrum(double phi, double cycles, double hold)
{
    const double distance = 1.0 - phi, held = imki_sin_half_turns(cycles * hold);
    const double power = held * held;
    return (1.0 - phi * phi) * power / (hold * (distance * distance + 4.0 * phi * power));
}

double imk_flicker_sampled_spectrum(imk_flicker flicker, double dt, double frequency)
{
    const flicker_stages stages = stages_of(flicker, dt);
    double cycles = frequency * dt, sine = imki_sin_half_turns(cycles), hold = 4.0;
    double sum = stages.fastest * stage_spectrum(stages.decay[0], cycles, 1.0);
    if (stages.count > 1)
        sum += stage_spectrum(stages.decay[1], cycles, 1.0);
    for (int stage = 2; stage < stages.count; stage++, hold *= 4.0)
        sum += stage_spectrum(stages.decay[1], cycles, hold);
    return stages.variance * dt * sum / (sine * sine);
}

/* Each stage's spectrum less what the ends take. A record of few holds does not show the zeros of a
 * held stage's spectrum: there its process stands for it. Together within 3.4 % of the exact sums
 * for k < 9, 1.6 % beyond (tests). */
double imk_flicker_cosine_spectrum(imk_flicker flicker, double dt, size_t n, size_t k)
{
    const flicker_stages stages = stages_of(flicker, dt);
    double cycles = 0.5 * (double)k / (double)n, sine = imki_sin_half_turns(cycles);
    double sum = 0.0, hold = 1.0;
    for (int stage = 0; stage < stages.count; stage++) {
        const int which = stage > 0;
        const double x = stage == 0 ? -stages.log_decay[0] : 1.0 / (stages.x * hold); /* 1/time */
        double spectrum =
            4.0 * hold < (double)n
                ? stage_spectrum(stages.decay[which], cycles, hold) / (sine * sine)
                : imk_gauss_markov_sampled_spectrum((imk_gauss_markov){1.0, 1.0 / x}, 1.0, cycles);
        sum += (stage == 0 ? stages.fastest : 1.0) * (spectrum - imki_cosine_end_loss(x, n, k));
        hold *= stage == 0 ? 1.0 : 4.0;
    }
    return stages.variance * dt * sum;
}

static uint64_t stage_stream(const imk_flicker_state *state, size_t stage)
{
    return state->stream + ((uint64_t)stage << 8); /* bits 8-15 are the instance */
}

/* Normals that are drawn ahead for each of the stages 3 …, those that change often enough. */
enum { AHEAD = IMK_FLICKER_AHEAD, BUFFER = IMK_FLICKER_BUFFER };

static void start_stages(imk_flicker_state *state)
{
    const bool held = state->stages > 2;
    for (size_t stage = 0; stage < state->stages; stage++) {
        double normal;
        imk_random_normals(state->random, stage_stream(state, stage), IMKI_START_NORMAL, 1,
                           &normal);
        if (stage >= 2)
            state->value[stage] = normal;
        else /* in units of the innovation */
            state->fast[stage] =
                normal / sqrt(1.0 - state->power[stage][1] * state->power[stage][1]);
    }
    for (size_t stage = state->stages; held && stage-- > 3;)
        state->above[stage] = state->above[stage + 1] + state->value[stage];
}

imk_status imk_flicker_start(imk_flicker_state *state, imk_flicker flicker, double dt,
                             imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(flicker.instability, dt);
    if (status == IMK_OK && !isfinite(flicker.correlation_time))
        status = IMK_ERROR_NOT_FINITE;
    if (status != IMK_OK)
        return status;
    const flicker_stages stages = stages_of(flicker, dt);
    if (flicker.correlation_time < 0.0 || stages.x >= 4.0 * SHORTEST)
        return IMK_ERROR_RANGE;
    *state = (imk_flicker_state){.random = random,
                                 .stream = stream,
                                 .stages = (size_t)stages.count,
                                 .sigma = sqrt(stages.variance),
                                 .block.used = IMK_NOISE_BLOCK};
    uint32_t words[2];
    imk_random_words(random, stream, IMKI_START_WORD, 2, words);
    state->phase = ((uint64_t)words[1] << 32 | words[0]) & (((uint64_t)1 << 2 * (STAGES - 2)) - 1);
    for (size_t i = 0; i < 2; i++)
        imki_powers(stages.decay[i], state->power[i]);
    state->fast_innovation = sqrt(stages.fastest * (1.0 - stages.decay[0] * stages.decay[0]));
    state->innovation = sqrt(1.0 - stages.decay[1] * stages.decay[1]);
    start_stages(state);
    return IMK_OK;
}

enum { CHANGES = IMKI_FLICKER_CHANGES };

static void change_stage(imk_flicker_state *state, size_t stage)
{
    const uint64_t change = state->changes[stage]++;
    const size_t count = stage < 3 + AHEAD ? BUFFER : 1, i = (size_t)(change % count);
    double one, *ahead = stage < 3 + AHEAD ? state->ahead[stage - 3] : &one;
    if (i == 0)
        imk_random_normals(state->random, stage_stream(state, stage), change, count, ahead);
    state->value[stage] = state->power[1][1] * state->value[stage] + state->innovation * ahead[i];
}

/* Change stage 3 and each slower one whose moment this is, then their sums, slowest first. */
static void change_slow_stages(imk_flicker_state *state, uint64_t count)
{
    size_t slowest = 3;
    if (state->stages <= slowest)
        return;
    while (slowest + 1 < state->stages && count % ((uint64_t)1 << 2 * slowest) == 0)
        slowest++;
    for (size_t stage = slowest; stage >= 3; stage--) {
        change_stage(state, stage);
        state->above[stage] = state->above[stage + 1] + state->value[stage];
    }
}

/* The changes of stage 2 in a block, in groups of four that begin with a change of stage 3. The
 * first group may have begun before the block, `lead` changes ago. */
enum { GROUP = 4, GROUPED = CHANGES + 2 * GROUP };

/* The sums of all held stages: sum[lead + k] from change k on, sum[lead - 1] before. */
static void sum_held_stages(imk_flicker_state *state, uint64_t first_change,
                            const double value[GROUPED], double *sum)
{
    const size_t lead = (size_t)(first_change % GROUP);
    const double before = state->sigma * (state->above[3] + state->value[2]);
    for (size_t k = 0; k < lead + CHANGES; k += GROUP) {
        if (k >= lead)
            change_slow_stages(state, 4 * (first_change - lead + k));
        for (size_t j = k; j < k + GROUP; j++)
            sum[j] = state->sigma * (state->above[3] + value[j]);
    }
    sum[(ptrdiff_t)lead - 1] = before;
    state->value[2] = value[lead + CHANGES - 1];
    state->changes[2] += CHANGES;
}

static size_t draws(const void *of, double *normals, imki_draw *draw)
{
    const imk_flicker_state *state = of;
    for (size_t stage = 0; stage < 2; stage++)
        draw[stage] = imki_draw_of(stage_stream(state, stage), state->next, IMK_NOISE_BLOCK,
                                   normals + stage * IMK_NOISE_BLOCK);
    draw[2] = imki_draw_of(stage_stream(state, 2), state->changes[2], CHANGES,
                           normals + (size_t)2 * IMK_NOISE_BLOCK);
    return 3;
}

static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imk_flicker_state *state = states;
    double value[GROUPED] = {0.0}, sums[1 + GROUPED];
    const uint64_t first = state->next + state->phase, first_change = (first + 3) / 4;
    const size_t offset = (size_t)(first % 4), lead = (size_t)(first_change % GROUP);
    const double held_innovation = state->stages > 2 ? state->innovation : 0.0;
    imki_recursion stages[2];
    (void)count;
    for (size_t stage = 0; stage < 2; stage++) {
        const double innovation = stage == 0          ? state->fast_innovation
                                  : state->stages > 1 ? state->innovation
                                                      : 0.0;
        stages[stage] = (imki_recursion){.gain = state->sigma * innovation,
                                         .power = state->power[stage],
                                         .normals = normals + stage * IMK_NOISE_BLOCK,
                                         .value = &state->fast[stage]};
    }
    for (size_t k = 0; k < CHANGES; k++)
        value[lead + k] = normals[2 * IMK_NOISE_BLOCK + k] * held_innovation;
    imki_add_flicker(kernel, stages, state->value[2], value + lead, block);
    sum_held_stages(state, first_change, value, sums + 1);
    imki_add_held(kernel, sums + lead + (offset > 0 ? 0 : 1), offset, block);
    state->next += IMK_NOISE_BLOCK;
}

static double strength(imki_term_place place)
{
    return place.triad->noise.bias_instability.value[place.axis];
}

static imk_flicker flicker_at(imki_term_place place)
{
    return (imk_flicker){strength(place),
                         place.triad->noise.bias_instability_correlation_time.value};
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_flicker_start(state, flicker_at(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_flicker_state),
                                         .start = start,
                                         .field = "noise.bias_instability",
                                         .refused = strength,
                                         .normals = IMKI_FLICKER_NORMALS,
                                         .draws = draws,
                                         .together = 1,
                                         .blocks = blocks};

void imk_flicker_add(imk_flicker_state *state, size_t count, double *out)
{
    imki_add_generated(&generator, state, state->random, &state->block, count, out);
}

/* The stages. Their densities at 0 Hz are those of their samples. */
static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    const flicker_stages stages = stages_of(flicker_at(place), dt);
    const double fastest = VARIANCE * stages.fastest, phi = stages.decay[0];
    double time = stages.x * dt;
    process[0] = (imki_process){.kind = IMKI_PROCESS_WHITE, .size = strength(place)};
    process[0].share = fastest * dt;
    if (stages.count > 1)
        process[0] = (imki_process){.kind = IMKI_PROCESS_FIRST_ORDER,
                                    .size = strength(place),
                                    .share = fastest,
                                    .time = 0.5 * dt * (1.0 + phi) / (1.0 - phi),
                                    .matched = true};
    for (int stage = 1; stage < stages.count; stage++, time *= 4.0)
        process[stage] = (imki_process){.kind = IMKI_PROCESS_FIRST_ORDER,
                                        .size = strength(place),
                                        .share = VARIANCE,
                                        .time = time,
                                        .matched = true};
    return (size_t)stages.count;
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_flicker_allan_variance(strength(place), time);
}

const imki_noise_term imki_flicker_term = {
    .path = {"noise.bias_instability", "noise.bias_instability"},
    .text = {"gyro bias instability", "accelerometer bias instability"},
    .stream = IMK_TERM_FLICKER,
    .strength = strength,
    .generator = &generator,
    .processes = processes,
    .mean_variance = mean_variance};
