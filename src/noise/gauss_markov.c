/* SPDX-License-Identifier: Apache-2.0 */
/* First-order Gauss-Markov process  db/dt = -b/T + sigma sqrt(2/T) w(t), point-sampled exactly:
 *
 *     y[k] = phi y[k-1] + q n[k],   phi = exp(-dt/T),   q = sigma sqrt(1 - phi^2),
 *
 * from a stationary y[-1]. expm1 keeps q accurate for dt << T, where 1 - phi^2 cancels. */
#include "noise_terms_internal.h"

/* sum over k >= 3 of (-1)^k/k! [4 a^k - b^k - n c^k - d^k]: the bracket of either Allan variance,
 * whose terms up to second order cancel. Largest argument 2: 26 terms leave 2^29/29! < 1e-22. */
static double bracket_series(double a, double b, double n, double c, double d)
{
    double power_a = a * a / 2.0, power_b = b * b / 2.0, power_c = c * c / 2.0;
    double power_d = d * d / 2.0, sum = 0.0;
    for (int k = 3; k < 29; k++) {
        power_a *= -a / k;
        power_b *= -b / k;
        power_c *= -c / k;
        power_d *= -d / k;
        sum += 4.0 * power_a - power_b - n * power_c - 3.0 * power_d;
    }
    return sum;
}

/* sigma_A^2 = sigma^2/x^2 [2 x - 3 + 4 e^-x - e^-2x],  x = tau/T   [IEEE952]
 *
 * With u = 1 - e^-x the bracket is 2 (x - u) - u^2; below x = 1 its series. */
double imk_gauss_markov_allan_variance(imk_gauss_markov process, double tau)
{
    double x = tau / process.correlation_time;
    double u = -imk_expm1(-x);
    double bracket = x < 1.0 ? bracket_series(x, 2.0 * x, 0.0, 0.0, 0.0) : 2.0 * (x - u) - u * u;
    double ratio = process.sigma / x;
    return x > 0.0 ? ratio * ratio * bracket : 0.0;
}

/* sigma_A^2 = sigma^2/(n^2 (1-phi)^2) [n (1 - phi^2) - phi (3 - 4 phi^n + phi^2n)]
 *
 * With u = 1 - phi^n the second term is phi (2 u + u^2). For small n dt/T the series of
 * n (1 - e^-2x) - 3 e^-x + 4 e^-(n+1)x - e^-(2n+1)x. */
double imk_gauss_markov_sampled_allan_variance(imk_gauss_markov process, double dt, size_t n)
{
    double x = dt / process.correlation_time, m = (double)n;
    double bracket;
    if ((2.0 * m + 1.0) * x < 2.0) {
        bracket = bracket_series((m + 1.0) * x, (2.0 * m + 1.0) * x, m, 2.0 * x, x);
    } else {
        double u = -imk_expm1(-m * x);
        bracket = -m * imk_expm1(-2.0 * x) - imk_exp(-x) * (2.0 * u + u * u);
    }
    double ratio = process.sigma / (m * imk_expm1(-x));
    return x > 0.0 ? ratio * ratio * bracket : 0.0;
}

/* S(f) = dt sigma^2 (1 - phi^2)/((1 - phi)^2 + 4 phi sin^2(pi f dt)) */
double imk_gauss_markov_sampled_spectrum(imk_gauss_markov process, double dt, double frequency)
{
    double x = dt / process.correlation_time;
    double sine = imki_sin_half_turns(frequency * dt), distance = imk_expm1(-x);
    return dt * process.sigma * process.sigma * -imk_expm1(-2.0 * x) /
           (distance * distance + 4.0 * imk_exp(-x) * sine * sine);
}

/* With w = pi k/n and D = (1 - phi)^2 + 4 phi sin^2(w/2), the sums over both ends that an endless
 * record would add to E c_k^2 are  (4/n) phi (1 - phi)^2 cos^2(w/2)/D^2 [1 - (-1)^k phi^n]. */
double imki_cosine_end_loss(double x, size_t n, size_t k)
{
    double half_turns = 0.5 * (double)k / (double)n, sine = imki_sin_half_turns(half_turns);
    double phi = imk_exp(-x), distance = imk_expm1(-x);
    double ratio = distance / (distance * distance + 4.0 * phi * sine * sine);
    double far = imk_exp(-x * (double)n);
    return 4.0 / (double)n * phi * ratio * ratio * (1.0 - sine * sine) *
           (k % 2 == 0 ? -imk_expm1(-x * (double)n) : 1.0 + far);
}

double imk_gauss_markov_cosine_spectrum(imk_gauss_markov process, double dt, size_t n, size_t k)
{
    double frequency = 0.5 * (double)k / ((double)n * dt);
    double loss = imki_cosine_end_loss(dt / process.correlation_time, n, k);
    return imk_gauss_markov_sampled_spectrum(process, dt, frequency) -
           process.sigma * process.sigma * dt * loss;
}

imk_status imk_gauss_markov_start(imk_gauss_markov_state *state, imk_gauss_markov process,
                                  double dt, imk_random random, uint64_t stream)
{
    imk_status status = imki_check_noise(process.sigma, dt);
    if (status != IMK_OK)
        return status;
    if (!isfinite(process.correlation_time))
        return IMK_ERROR_NOT_FINITE;
    double x = dt / process.correlation_time;
    double innovation = -imk_expm1(-2.0 * x); /* variance, of a process of unit variance */
    if (!(process.correlation_time > 0.0) || !(innovation > 0.0))
        return IMK_ERROR_RANGE;
    *state = (imk_gauss_markov_state){.random = random,
                                      .stream = stream,
                                      .gain = process.sigma * sqrt(innovation),
                                      .block.used = IMK_NOISE_BLOCK};
    imki_powers(imk_exp(-x), state->power);
    double normal;
    imk_random_normals(random, stream, IMKI_START_NORMAL, 1, &normal);
    state->value = normal / sqrt(innovation);
    return IMK_OK;
}

static size_t draws(const void *state, double *normals, imki_draw *draw)
{
    const imk_gauss_markov_state *process = state;
    draw[0] = imki_draw_of(process->stream, process->next, IMK_NOISE_BLOCK, normals);
    return 1;
}

static void blocks(void *states, size_t count, imk_kernel kernel, double *normals, double *block)
{
    imki_recursion recursions[IMKI_TOGETHER];
    for (size_t i = 0; i < count; i++) {
        imk_gauss_markov_state *process =
            (void *)((char *)states + i * IMKI_STATE_SIZE(imk_gauss_markov_state));
        recursions[i] = (imki_recursion){.gain = process->gain,
                                         .power = process->power,
                                         .normals = normals + i * IMK_NOISE_BLOCK,
                                         .value = &process->value};
        process->next += IMK_NOISE_BLOCK;
    }
    imki_add_recursions(kernel, recursions, count, block);
}

static imk_gauss_markov process_at(imki_term_place place)
{
    const struct imk_gauss_markov_term *term = &place.triad->noise.gauss_markov[place.instance];
    return (imk_gauss_markov){term->sigma.value[place.axis],
                              term->correlation_time.value[place.axis]};
}

static double strength(imki_term_place place)
{
    return process_at(place).sigma;
}

static double correlation_time(imki_term_place place)
{
    return process_at(place).correlation_time;
}

static imk_status start(void *state, imki_term_place place, double dt, imk_random random,
                        uint64_t stream)
{
    return imk_gauss_markov_start(state, process_at(place), dt, random, stream);
}

static const imki_generator generator = {.state_size = IMKI_STATE_SIZE(imk_gauss_markov_state),
                                         .start = start,
                                         .field = "noise.gauss_markov",
                                         .refused = correlation_time,
                                         .normals = IMK_NOISE_BLOCK,
                                         .draws = draws,
                                         .together = IMKI_TOGETHER,
                                         .blocks = blocks};

void imk_gauss_markov_add(imk_gauss_markov_state *state, size_t count, double *out)
{
    imki_add_generated(&generator, state, state->random, &state->block, count, out);
}

static int count(const imk_noise *noise)
{
    return noise->gauss_markov_count;
}

static size_t processes(imki_term_place place, double dt, imki_process *process)
{
    (void)dt;
    const size_t one = imki_one_process(process, IMKI_PROCESS_FIRST_ORDER, strength(place));
    process->time = correlation_time(place);
    return one;
}

static double mean_variance(imki_term_place place, double dt, double time)
{
    (void)dt;
    return imk_gauss_markov_allan_variance(process_at(place), time);
}

const imki_noise_term imki_gauss_markov_term = {
    .path = {"noise.gauss_markov", "noise.gauss_markov"},
    .text = {"gyro Gauss-Markov process", "accelerometer Gauss-Markov process"},
    .stream = IMK_TERM_GAUSS_MARKOV,
    .count = count,
    .strength = strength,
    .generator = &generator,
    .processes = processes,
    .mean_variance = mean_variance};
