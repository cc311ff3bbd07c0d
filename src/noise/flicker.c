/* SPDX-License-Identifier: Apache-2.0 */
/* Flicker noise S(f) = B^2/(2 pi f) as a sum of first-order stages [KESHNER1982].
 *
 * Lorentzian spectra of variance v with correlation times in geometric progression r add up to
 * v/(2 ln(r) f) but for a ripple; hence v = (ln r/pi) B^2, here with r = 4. Stage j has the
 * correlation time dt 4^j. Stages 0 and 1 change at every sample; stage j >= 2 is a first-order
 * sequence with phi = exp(-1/4) per change (as stage 1 has) whose values are held for h = 4^(j-1)
 * samples. The moments of change have a random phase common to all stages, so that the sequence is
 * stationary: a held stage has the autocovariance of its coarse sequence, interpolated linearly.
 * The Allan variance of any stationary process, integrated over log tau, depends on its variance
 * alone, so holding does not move the level.
 *
 * The fastest stage also stands for those faster than dt, which are left out: its variance is
 * raised by FASTEST, chosen to make the largest deviation of the Allan deviation from the ideal one
 * smallest over 2 … 300 dt (tests/reference/flicker_stages.py). */
#include "noise_terms_internal.h"

#define FASTEST 1.20785             /* tests/reference/flicker_stages.py */
#define VARIANCE 0.4412712003053032 /* ln 4/pi */
#define STAGES IMK_FLICKER_STAGES

double imk_flicker_allan_variance(double instability, double tau)
{
    (void)tau;
    return VARIANCE * instability * instability; /* 2 ln 2/pi is the same number */
}

/* Variance of the sum of n samples of a held stage of unit variance. The autocovariance at lag
 * a h + b is phi^a (1 - p b/h), p = 1 - phi; with n = a h + b,
 *
 *     V = 2 [ (n E0 - E1) G0 - h E0 G1 + phi^a (b (b+1)/2 - p/h (b-1) b (b+1)/6) ] - n
 *     E0 = sum_{b<h} (1 - p b/h),  E1 = sum b (1 - p b/h),  G0 = sum_{i<a} phi^i,  G1 = sum i phi^i
 */
static double variance_of_sum(double n, double h, double phi, double p, double log_phi)
{
    double a = floor(n / h), b = n - a * h;
    double decay = imk_exp(a * log_phi);
    double e0 = h - 0.5 * p * (h - 1.0);
    double e1 = 0.5 * h * (h - 1.0) - p * (h - 1.0) * (2.0 * h - 1.0) / 6.0;
    double g0 = (1.0 - decay) / p;
    double g1 = (phi * g0 - a * decay) / p;
    double rest = 0.5 * b * (b + 1.0) - p / h * (b - 1.0) * b * (b + 1.0) / 6.0;
    return 2.0 * ((n * e0 - e1) * g0 - h * e0 * g1 + decay * rest) - n;
}

/* sigma_A^2 = (4 V(n) - V(2 n))/(2 n^2) for any stationary process whose n samples sum to V(n). */
double imk_flicker_sampled_allan_variance(double instability, double dt, size_t n)
{
    (void)dt;
    double m = (double)n, sum = 0.0, hold = 1.0;
    for (int stage = 0; stage < STAGES; stage++) {
        double log_phi = stage == 0 ? -1.0 : -0.25;
        double phi = imk_exp(log_phi), p = -imk_expm1(log_phi);
        double once = variance_of_sum(m, hold, phi, p, log_phi);
        double twice = variance_of_sum(2.0 * m, hold, phi, p, log_phi);
        sum += (stage == 0 ? FASTEST : 1.0) * (4.0 * once - twice);
        hold *= stage == 0 ? 1.0 : 4.0;
    }
    return VARIANCE * instability * instability * sum / (2.0 * m * m);
}

/* Spectrum of a stage of unit variance at dt = 1, without its 1/sin^2(pi f) if held. A held stage:
 * the triangle of width h transforms to sin^2(pi f h)/(h sin^2(pi f)), and with s = sin^2(pi f h)
 * its coarse sequence to (1 - phi^2)/((1 - phi)^2 + 4 phi s). f h is exact, h being a power of 4.
 */
static double stage_spectrum(int stage, double cycles, double hold)
{
    double log_phi = stage == 0 ? -1.0 : -0.25, distance = imk_expm1(log_phi);
    double held = imki_sin_half_turns(cycles * hold), power = held * held;
    return -imk_expm1(2.0 * log_phi) * power /
           (hold * (distance * distance + 4.0 * imk_exp(log_phi) * power));
}

double imk_flicker_sampled_spectrum(double instability, double dt, double frequency)
{
    double cycles = frequency * dt, sine = imki_sin_half_turns(cycles), sum = 0.0, hold = 1.0;
    for (int stage = 0; stage < STAGES; stage++) {
        sum += (stage == 0 ? FASTEST : 1.0) * stage_spectrum(stage, cycles, hold);
        hold *= stage == 0 ? 1.0 : 4.0;
    }
    return VARIANCE * instability * instability * dt * sum / (sine * sine);
}

/* Each stage's spectrum less what the ends take. A record of few holds does not show the zeros of a
 * held stage's spectrum: there the same stage not held stands for it. Together within 1.3 % of the
 * exact sums (tests). */
double imk_flicker_cosine_spectrum(double instability, double dt, size_t n, size_t k)
{
    double cycles = 0.5 * (double)k / (double)n, sine = imki_sin_half_turns(cycles);
    double sum = 0.0, hold = 1.0, time = 1.0;
    for (int stage = 0; stage < STAGES; stage++, time *= 4.0) {
        double spectrum =
            4.0 * hold < (double)n
                ? stage_spectrum(stage, cycles, hold) / (sine * sine)
                : imk_gauss_markov_sampled_spectrum((imk_gauss_markov){1.0, time}, 1.0, cycles);
        sum += (stage == 0 ? FASTEST : 1.0) * (spectrum - imki_cosine_end_loss(1.0 / time, n, k));
        hold *= stage == 0 ? 1.0 : 4.0;
    }
    return VARIANCE * instability * instability * dt * sum;
}

static uint64_t stage_stream(const imk_flicker_state *state, size_t stage)
{
    return state->stream + ((uint64_t)stage << 8); /* bits 8-15 are the instance */
}

imk_status imk_flicker_start(imk_flicker_state *state, double instability, double dt,
                             imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(instability, dt);
    if (status != IMK_OK)
        return status;
    *state = (imk_flicker_state){.random = random,
                                 .stream = stream,
                                 .sigma = instability * sqrt(VARIANCE),
                                 .block.used = IMK_NOISE_BLOCK};
    uint32_t words[2];
    imk_random_words(random, stream, IMKI_START_WORD, 2, words);
    state->phase = ((uint64_t)words[1] << 32 | words[0]) & (((uint64_t)1 << 2 * (STAGES - 2)) - 1);
    state->fast_innovation = sqrt(FASTEST * -imk_expm1(-2.0));
    state->innovation = sqrt(-imk_expm1(-0.5));
    imki_powers(imk_exp(-1.0), state->power[0]);
    imki_powers(imk_exp(-0.25), state->power[1]);
    for (size_t stage = 0; stage < STAGES; stage++) {
        double normal;
        imk_random_normals(random, stage_stream(state, stage), IMKI_START_NORMAL, 1, &normal);
        if (stage < 2)
            state->fast[stage] = normal / sqrt(-imk_expm1(stage == 0 ? -2.0 : -0.5));
        else
            state->value[stage] = normal;
    }
    for (size_t stage = STAGES; stage-- > 3;)
        state->above[stage] = state->above[stage + 1] + state->value[stage];
    return IMK_OK;
}

enum { CHANGES = IMKI_FLICKER_CHANGES };

static void change_stage(imk_flicker_state *state, size_t stage)
{
    const size_t i = state->changes[stage] % IMK_FLICKER_BUFFER;
    if (i == 0) {
        imk_random_normals(state->random, stage_stream(state, stage), state->changes[stage],
                           IMK_FLICKER_BUFFER, state->ahead[stage]);
        for (size_t k = 0; k < IMK_FLICKER_BUFFER; k++)
            state->ahead[stage][k] *= state->innovation;
    }
    state->changes[stage]++;
    state->value[stage] = state->power[1][1] * state->value[stage] + state->ahead[stage][i];
}

/* Change stage 3 and each slower one whose moment this is, then their sums, slowest first. */
static void change_slow_stages(imk_flicker_state *state, uint64_t count)
{
    size_t slowest = 3;
    while (slowest + 1 < STAGES && count % ((uint64_t)1 << 2 * slowest) == 0)
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
    imki_recursion stages[2];
    (void)count;
    for (size_t stage = 0; stage < 2; stage++) {
        const double innovation = stage == 0 ? state->fast_innovation : state->innovation;
        stages[stage] = (imki_recursion){.gain = state->sigma * innovation,
                                         .power = state->power[stage],
                                         .normals = normals + stage * IMK_NOISE_BLOCK,
                                         .value = &state->fast[stage]};
    }
    for (size_t k = 0; k < CHANGES; k++)
        value[lead + k] = normals[2 * IMK_NOISE_BLOCK + k] * state->innovation;
    imki_add_flicker(kernel, stages, state->value[2], value + lead, block);
    sum_held_stages(state, first_change, value, sums + 1);
    imki_add_held(kernel, sums + lead + (offset > 0 ? 0 : 1), offset, block);
    state->next += IMK_NOISE_BLOCK;
}

static double strength(imki_term_place place)
{
    return place.triad->noise.bias_instability.value[place.axis];
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_flicker_start(state, strength(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = sizeof(imk_flicker_state),
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

/* The stages. Those that are held are interpolated by it: only half a per cent is between them and
 * their processes. */
static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    double time = dt;
    for (int stage = 0; stage < STAGES; stage++, time *= 4.0)
        process[stage] = (imki_process){.kind = IMKI_PROCESS_FIRST_ORDER,
                                        .size = strength(place),
                                        .share = stage == 0 ? VARIANCE * FASTEST : VARIANCE,
                                        .time = time,
                                        .held = stage >= 2};
    return STAGES;
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
