/* SPDX-License-Identifier: Apache-2.0 */
/* Generalised autocovariance R(t) of the running sums, for each noise term.
 *
 * Second differences of the sums are stationary even where the sums are not, and
 *
 *     cov(z_m1(j), z_m2(j + l)) = sum_a sum_b c_a c_b R(l + b m2 - a m1),   c = 1, -2, 1
 *
 * for any R that is right but for a quadratic [GREENHALL2003]. With t in samples:
 *
 *     quantization  delta(t)                    random walk  (|t|^3 - |t|)/12 (point-sampled)
 *     white noise   -|t|/2                      flicker      t^2 ln|t|/(2 pi)
 *
 * and for an autocovariance Re C exp(-lambda |t|) of the samples, z = exp(-lambda), by geometric
 * series,
 *
 *     R(t) = -1/2 Re C (1+z)/(1-z) |t| - Re C z/(1-z)^2 exp(-lambda |t|)
 *
 * (a Gauss-Markov term with real lambda, a resonance with complex). White noise behind a filter is
 * averaged over the samples, so its sums are the integral of the continuous process, whose
 * autocovariance is Re C exp(-lambda |t|) too: R(t) = -|t|/2 - Re C/lambda^2 exp(-lambda |t|). */
#include "allan_fit_internal.h"
#include "imukit/elementary.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* x^2/2 - x + 1 - e^-x, by its series where that cancels: for x < 1, 18 terms reach 1e-17. */
static double decay_form(double x)
{
    if (x > 1)
        return 0.5 * x * x - x - imk_expm1(-x);
    double term = x * x * x / 6, sum = 0;
    for (int k = 4; k < 20 && fabs(term) > 1e-17 * fabs(sum); k++) {
        sum += term;
        term *= -x / k;
    }
    return sum;
}

static double exponential_part(const imki_lag_term *term, double t)
{
    double sum = 0;
    for (int i = 0; i < term->exponentials; i++) {
        const double damping = term->lambda[i][0] * t, turn = -term->lambda[i][1] * t;
        if (damping > 40)
            continue; /* below 1e-17 of its start */
        const double size = imk_exp(-damping);
        sum += term->lambda[i][1] == 0
                   ? term->g[i][0] * size
                   : size * (term->g[i][0] * imk_cos(turn) - term->g[i][1] * imk_sin(turn));
    }
    return sum;
}

double imki_lag_smooth(const imki_lag_term *term, double lag)
{
    const double t = fabs(lag);
    switch (term->kind) {
    case IMKI_LAG_LINEAR:
    case IMKI_LAG_RINGING:
        return term->linear * t;
    case IMKI_LAG_FILTERED:
        return term->linear * t + exponential_part(term, t);
    case IMKI_LAG_LOGARITHM:
        return t > 0 ? term->scale * t * t * imk_ln(t) : 0;
    case IMKI_LAG_CUBIC:
        return term->scale * t * t * t + term->linear * t;
    case IMKI_LAG_DECAY:
        return term->scale * decay_form(term->rate * t) + term->linear * t;
    case IMKI_LAG_DELTA:
    case IMKI_LAG_RAMP:
    case IMKI_LAG_SINUSOID:
        break;
    }
    return 0;
}

double imki_lag_ringing(const imki_lag_term *term, double lag)
{
    return term->kind == IMKI_LAG_RINGING ? exponential_part(term, fabs(lag)) : 0;
}

typedef struct complex_number {
    double re, im;
} complex_number;

static complex_number times(complex_number a, complex_number b)
{
    return (complex_number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static complex_number over(complex_number a, complex_number b)
{
    const double size = b.re * b.re + b.im * b.im;
    return (complex_number){(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
}

static complex_number power(const imki_lag_term *term, double exponent)
{
    const double size = imk_exp(-term->lambda[0][0] * exponent);
    const double turn = -term->lambda[0][1] * exponent;
    return (complex_number){size * imk_cos(turn), size * imk_sin(turn)};
}

/* sum_t Re g z^|t| = Re g (1+z)/(1-z) */
double imki_ringing_sum(const imki_lag_term *term)
{
    const complex_number z = power(term, 1), g = {term->g[0][0], term->g[0][1]};
    return times(g, over((complex_number){1 + z.re, z.im}, (complex_number){1 - z.re, -z.im})).re;
}

/* sum_t Re(g z^|t|) Re(g z^|t+d|): both ends decay alike, in between the product is constant but
 * for the turn, each a geometric series of 1/2 Re(x y) + 1/2 Re(conj(x) y). */
double imki_ringing_product(const imki_lag_term *term, double shift)
{
    const complex_number g = {term->g[0][0], term->g[0][1]}, gg = times(g, g);
    const double size = g.re * g.re + g.im * g.im;
    const complex_number zd = power(term, shift), z2 = power(term, 2);
    const double modulus2 = imk_exp(-2 * term->lambda[0][0]);
    double sum =
        times(times(gg, zd), over((complex_number){1, 0}, (complex_number){1 - z2.re, -z2.im})).re +
        size * zd.re / (1 - modulus2);
    if (shift > 1) {
        const double turn = 2 * term->lambda[0][1], count = shift - 1;
        const complex_number unit = {imk_cos(turn), imk_sin(turn)};
        const complex_number all = {imk_cos(turn * count), imk_sin(turn * count)};
        const complex_number below = {1 - unit.re, -unit.im};
        const complex_number series =
            below.re * below.re + below.im * below.im > 1e-20
                ? over(times(unit, (complex_number){1 - all.re, -all.im}), below)
                : (complex_number){count, 0};
        sum += 0.5 * (count * times(gg, zd).re + size * times(zd, series).re);
    }
    return sum;
}

/* Gauss-Markov, point-sampled. With d = dt/T and A = e^-d/(1 - e^-d)^2 the form above is
 * A (x^2/2 - x + 1 - e^-x) less a quadratic and (A d - coth(d/2)/2) t, which cancels for small d:
 * -d/6 + d^3/180. */
static void set_decay(imki_lag_term *term, double d)
{
    const double phi = imk_exp(-d), distance = -imk_expm1(-d), a = phi / (distance * distance);
    term->kind = IMKI_LAG_DECAY;
    term->rate = d;
    term->scale = a;
    term->linear = d < 0.05 ? -d / 6 + d * d * d / 180 : a * d - 0.5 * (1 + phi) / distance;
}

static void set_ringing(imki_lag_term *term, const imk_resonance *resonance, double dt)
{
    const double omega = 2 * PI * resonance->frequency * dt, damping = 0.5 / resonance->q;
    const double root = sqrt(1 - damping * damping);
    *term = (imki_lag_term){.kind = IMKI_LAG_RINGING, .exponentials = 1};
    term->lambda[0][0] = omega * damping;
    term->lambda[0][1] = -omega * root;
    const complex_number c = {1, -damping / root}, z = power(term, 1);
    const complex_number below = {1 - z.re, -z.im};
    term->linear = -0.5 * times(c, over((complex_number){1 + z.re, z.im}, below)).re;
    const complex_number g = times(c, over(z, times(below, below)));
    term->g[0][0] = -g.re;
    term->g[0][1] = -g.im;
}

/* The filter's natural frequency from its -3 dB point, as in noise/filtered_white.c. */
static void set_filtered(imki_lag_term *term, imk_low_pass filter, double dt)
{
    const double cutoff = 2 * PI * filter.bandwidth * dt;
    *term = (imki_lag_term){.kind = IMKI_LAG_FILTERED, .linear = -0.5, .exponentials = 1};
    if (filter.damping == 0) {
        term->lambda[0][0] = cutoff;
        term->g[0][0] = -0.5 / cutoff;
        return;
    }
    /* At critical damping two equal exponentials would stand for t exp: close by is as good. */
    double zeta = filter.damping;
    zeta = fabs(zeta - 1) < 1e-4 ? 1 + 1e-4 : zeta;
    const double m = 1 - 2 * zeta * zeta, root = sqrt(m * m + 1);
    const double omega = cutoff / sqrt(m > 0 ? m + root : 1 / (root - m));
    const double level = omega / (4 * zeta);
    if (zeta < 1) {
        const double r = sqrt(1 - zeta * zeta);
        const complex_number lambda = {omega * zeta, -omega * r}, c = {level, -level * zeta / r};
        const complex_number g = over(c, times(lambda, lambda));
        term->lambda[0][0] = lambda.re;
        term->lambda[0][1] = lambda.im;
        term->g[0][0] = -g.re;
        term->g[0][1] = -g.im;
        return;
    }
    const double r = sqrt(zeta * zeta - 1);
    term->exponentials = 2;
    term->lambda[0][0] = omega * (zeta + r);
    term->lambda[1][0] = omega / (zeta + r); /* zeta - r without cancellation */
    for (int i = 0; i < 2; i++) {
        const double lambda = term->lambda[i][0];
        term->g[i][0] = -0.5 * level * (1 + (i == 0 ? -zeta : zeta) / r) / (lambda * lambda);
    }
}

static void set_lag_form(imki_allan_problem *problem, size_t j)
{
    const double dt = problem->table->dt;
    const imk_allan_noise *noise = &problem->noise;
    imki_lag_term *term = &problem->term[j];
    const int i = problem->origin[j];
    switch (term->kind) {
    case IMKI_LAG_DELTA:
        term->scale = 1 / (dt * dt);
        break;
    case IMKI_LAG_LINEAR:
    case IMKI_LAG_FILTERED:
        if (noise->filter.bandwidth > 0)
            set_filtered(term, noise->filter, dt);
        else
            *term = (imki_lag_term){.kind = IMKI_LAG_LINEAR, .linear = -0.5};
        term->linear /= dt;
        for (int k = 0; k < term->exponentials; k++) {
            term->g[k][0] /= dt;
            term->g[k][1] /= dt;
        }
        break;
    case IMKI_LAG_LOGARITHM:
        term->scale = 0.5 / PI;
        break;
    case IMKI_LAG_CUBIC:
        term->scale = dt / 12;
        term->linear = -dt / 12;
        break;
    case IMKI_LAG_DECAY:
        set_decay(term, dt / noise->gauss_markov[i].correlation_time);
        break;
    case IMKI_LAG_RINGING:
        set_ringing(term, &noise->resonance[i], dt);
        break;
    case IMKI_LAG_RAMP:
        term->scale = dt * dt;
        break;
    case IMKI_LAG_SINUSOID: {
        term->rate = 2 * PI * noise->sinusoid[i].frequency * dt;
        const double sine = imk_sin(0.5 * term->rate);
        term->scale = 0.5 / (4 * sine * sine); /* mean square of the sums of amplitude 1 */
        break;
    }
    }
}

/* Allan variance for amount 1, exact for the sampled term. */
static double unit_variance(const imki_allan_problem *problem, size_t j, size_t m)
{
    imk_allan_noise one = problem->noise;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        one.term[i] = 0;
    for (int i = 0; i < IMK_TERMS_MAX; i++) {
        one.gauss_markov[i].sigma = 0;
        one.sinusoid[i].amplitude = 0;
        one.resonance[i].sigma = 0;
    }
    imki_allan_store_amount(problem, j, 1, &one);
    return imk_allan_noise_variance(&one, problem->table->dt, m);
}

/* Two-sided spectrum for amount 1. */
static double unit_spectrum(const imki_allan_problem *problem, size_t j, double f)
{
    const double dt = problem->table->dt;
    const imk_allan_noise *noise = &problem->noise;
    const int i = problem->origin[j];
    switch (problem->term[j].kind) {
    case IMKI_LAG_DELTA:
        return imk_quantization_sampled_spectrum(1, dt, f);
    case IMKI_LAG_LINEAR:
    case IMKI_LAG_FILTERED:
        return noise->filter.bandwidth > 0
                   ? imk_filtered_white_sampled_spectrum(1, noise->filter, dt, f)
                   : 1;
    case IMKI_LAG_LOGARITHM:
        return imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
    case IMKI_LAG_CUBIC:
        return imk_random_walk_sampled_spectrum(1, dt, f);
    case IMKI_LAG_DECAY:
        return imk_gauss_markov_sampled_spectrum(
            (imk_gauss_markov){1, noise->gauss_markov[i].correlation_time}, dt, f);
    case IMKI_LAG_RINGING: {
        imk_resonance one = noise->resonance[i];
        one.sigma = 1;
        return imk_resonance_sampled_spectrum(one, dt, f);
    }
    case IMKI_LAG_RAMP:
    case IMKI_LAG_SINUSOID:
        break;
    }
    return 0;
}

void imki_allan_term_set(imki_allan_problem *problem, size_t j)
{
    set_lag_form(problem, j);
    for (size_t i = 0; i < problem->table->count; i++)
        problem->shape[i * problem->capacity + j] =
            unit_variance(problem, j, problem->table->factors[i]);
    for (int s = 0; s < problem->noise.sinusoid_count; s++)
        problem->spectrum[s][j] = unit_spectrum(problem, j, problem->noise.sinusoid[s].frequency);
    if (problem->term[j].kind == IMKI_LAG_SINUSOID)
        for (size_t i = 0; i < problem->terms; i++)
            problem->spectrum[problem->origin[j]][i] =
                unit_spectrum(problem, i, problem->noise.sinusoid[problem->origin[j]].frequency);
}

void imki_allan_problem_terms(imki_allan_problem *problem, const bool use[IMK_NOISE_TERMS])
{
    static const imki_lag_kind kinds[IMK_NOISE_TERMS] = {
        IMKI_LAG_DELTA, IMKI_LAG_LINEAR, IMKI_LAG_LOGARITHM, IMKI_LAG_CUBIC, IMKI_LAG_RAMP};
    size_t count = 0;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        if (use[i]) {
            problem->origin[count] = i;
            problem->term[count++] = (imki_lag_term){.kind = kinds[i]};
        }
    for (int i = 0; i < problem->noise.sinusoid_count; i++) {
        problem->origin[count] = i;
        problem->term[count++] = (imki_lag_term){.kind = IMKI_LAG_SINUSOID};
    }
    for (int i = 0; i < problem->noise.resonance_count; i++) {
        problem->origin[count] = i;
        problem->term[count++] = (imki_lag_term){.kind = IMKI_LAG_RINGING};
    }
    for (int i = 0; i < problem->noise.gauss_markov_count; i++) {
        problem->origin[count] = i;
        problem->term[count++] = (imki_lag_term){.kind = IMKI_LAG_DECAY};
    }
    problem->terms = count;
    for (size_t j = 0; j < count; j++)
        imki_allan_term_set(problem, j);
}

double imki_allan_amount(const imki_allan_problem *problem, const imk_allan_noise *noise, size_t j)
{
    const int i = problem->origin[j];
    const imki_lag_kind kind = problem->term[j].kind;
    const double value = kind == IMKI_LAG_DECAY      ? noise->gauss_markov[i].sigma
                         : kind == IMKI_LAG_RINGING  ? noise->resonance[i].sigma
                         : kind == IMKI_LAG_SINUSOID ? noise->sinusoid[i].amplitude
                                                     : noise->term[i];
    return value * value;
}

void imki_allan_store_amount(const imki_allan_problem *problem, size_t j, double amount,
                             imk_allan_noise *noise)
{
    const int i = problem->origin[j];
    const imki_lag_kind kind = problem->term[j].kind;
    double *value = kind == IMKI_LAG_DECAY      ? &noise->gauss_markov[i].sigma
                    : kind == IMKI_LAG_RINGING  ? &noise->resonance[i].sigma
                    : kind == IMKI_LAG_SINUSOID ? &noise->sinusoid[i].amplitude
                                                : &noise->term[i];
    *value = sqrt(amount);
}

double imk_allan_noise_variance(const imk_allan_noise *noise, double dt, size_t m)
{
    const double tau = (double)m * dt;
    double sum = 0;
    if (noise->term[IMK_NOISE_QUANTIZATION] != 0)
        sum += imk_quantization_sampled_allan_variance(noise->term[IMK_NOISE_QUANTIZATION], dt, m);
    if (noise->term[IMK_NOISE_WHITE] != 0)
        sum += imk_filtered_white_sampled_allan_variance(noise->term[IMK_NOISE_WHITE],
                                                         noise->filter, dt, m);
    if (noise->term[IMK_NOISE_BIAS_INSTABILITY] != 0)
        sum += imk_flicker_sampled_allan_variance(
            (imk_flicker){noise->term[IMK_NOISE_BIAS_INSTABILITY], 0}, dt, m);
    if (noise->term[IMK_NOISE_RANDOM_WALK] != 0)
        sum += imk_random_walk_sampled_allan_variance(noise->term[IMK_NOISE_RANDOM_WALK], dt, m);
    sum += imk_ramp_allan_variance(noise->term[IMK_NOISE_RAMP], tau);
    for (int i = 0; i < noise->gauss_markov_count; i++)
        if (noise->gauss_markov[i].sigma != 0)
            sum += imk_gauss_markov_sampled_allan_variance(noise->gauss_markov[i], dt, m);
    for (int i = 0; i < noise->sinusoid_count; i++)
        if (noise->sinusoid[i].amplitude != 0)
            sum += imk_sinusoid_sampled_allan_variance(noise->sinusoid[i], dt, m);
    for (int i = 0; i < noise->resonance_count; i++)
        if (noise->resonance[i].sigma != 0)
            sum += imk_resonance_sampled_allan_variance(noise->resonance[i], dt, m);
    return sum;
}
