/* SPDX-License-Identifier: Apache-2.0 */
/* What a record of some length can tell: the information about the terms of a given noise,
 *
 *     I_ij = 1/2 sum_b v_b (dS_b/dp_i)(dS_b/dp_j)/S_b^2
 *
 * over the same kind of bands that identification uses [WHITTLE1953], and its inverse; and the
 * chance that a term is called present. */
#include "base/workspace_internal.h"
#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/identify_plan.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum {
    COOKIE = 0x1DE70B0D,
    SINGLES = 256, /* coefficients one to a band, with the expectations of a finite record */
    BANDS_MAX = 1536,
    AMOUNTS_MAX = 4 + 2 * IMK_TERMS_MAX, /* Q^2, N^2, B^2, K^2, Gauss-Markov, resonances */
    PARAMETERS_MAX = AMOUNTS_MAX + 3 * IMK_TERMS_MAX + 2,
    SAMPLES_MIN = 256
};
static const double SAMPLES_MAX = 1e12;

/* Columns are dS/dp: first of the amounts, then of the logarithms of times, of resonances'
 * frequencies and qualities, and of the filter's bandwidth and damping. */
typedef struct plan {
    const imk_expected_noise *noise;
    const imk_bounds_settings *settings;
    double n;
    size_t bands, amounts, parameters;
    double index[BANDS_MAX], degrees[BANDS_MAX]; /* k of a band's middle; coefficients */
    double spectrum[BANDS_MAX], reduced[BANDS_MAX];
    double column[PARAMETERS_MAX][BANDS_MAX];
    double amount[AMOUNTS_MAX];
    int slot[4]; /* column of Q^2 ... K^2; -1: not estimated */
    size_t gauss_markov[IMK_TERMS_MAX], time[IMK_TERMS_MAX]; /* columns */
    double scratch[2][BANDS_MAX];
    double matrix[2][PARAMETERS_MAX * PARAMETERS_MAX]; /* for the inverse of the information */
    double covariance[PARAMETERS_MAX * PARAMETERS_MAX];
} plan;

size_t imk_bounds_workspace_size(void)
{
    return sizeof(plan) + 64;
}

imk_bounds_settings imk_bounds_default(void)
{
    return (imk_bounds_settings){.cookie = COOKIE,
                                 .significance = 0.01,
                                 .free = {[IMK_NOISE_WHITE] = true,
                                          [IMK_NOISE_BIAS_INSTABILITY] = true,
                                          [IMK_NOISE_RANDOM_WALK] = true},
                                 .shape = true};
}

imk_expected_noise imk_expected_noise_of(const imk_triad *triad, int axis, double dt)
{
    const imk_noise *n = &triad->noise;
    imk_expected_noise noise = {
        .term = {imk_noise_reading(n, axis, dt), n->white.value[axis],
                 n->bias_instability.value[axis], n->random_walk.value[axis], n->ramp.value[axis]},
        .filter = {triad->bandwidth.value[axis], triad->damping.value[axis]}};
    for (int i = 0; i < n->gauss_markov_count; i++)
        if (n->gauss_markov[i].sigma.value[axis] > 0)
            noise.gauss_markov[noise.gauss_markov_count++] =
                (imk_gauss_markov){n->gauss_markov[i].sigma.value[axis],
                                   n->gauss_markov[i].correlation_time.value[axis]};
    for (int i = 0; i < n->resonance_count; i++)
        if (n->resonance[i].sigma.value[axis] > 0)
            noise.resonance[noise.resonance_count++] = (imk_resonance){
                n->resonance[i].sigma.value[axis], n->resonance[i].frequency.value[axis],
                n->resonance[i].q.value[axis]};
    return noise;
}

/* ---- bands and columns ----------------------------------------------------------------------- */

static double frequency_of(const plan *p, size_t b)
{
    return p->index[b] / (2 * p->n * p->settings->dt);
}

/* 3 % wide, near a resonance an eighth of its width and of the distance to it. */
static void lay_bands(plan *p)
{
    const double step_hz = 1 / (2 * p->n * p->settings->dt);
    p->bands = 0;
    for (double k = 1; k < p->n && p->bands < BANDS_MAX;) {
        double width = k < SINGLES ? 1 : 0.03 * k;
        for (int i = 0; i < p->noise->resonance_count; i++) {
            const imk_resonance *r = &p->noise->resonance[i];
            const double half_power = r->frequency / r->q / step_hz;
            width = fmin(width, (half_power + fabs(k - r->frequency / step_hz)) / 8);
        }
        double end = k + fmax(1, floor(width));
        if (end > p->n || p->bands == BANDS_MAX - 1)
            end = p->n;
        p->index[p->bands] = 0.5 * (k + end - 1);
        p->degrees[p->bands++] = end - k;
        k = end;
    }
}

static void white_shape(const plan *p, imk_low_pass filter, double *shape)
{
    imk_arma arma;
    const bool filtered = filter.bandwidth > 0 &&
                          imk_filtered_white_arma(1, filter, p->settings->dt, &arma) == IMK_OK;
    for (size_t b = 0; b < p->bands; b++)
        shape[b] = filtered ? imk_arma_spectrum(&arma, frequency_of(p, b)) : 1;
}

static void gauss_markov_shape(const plan *p, double time, double *shape)
{
    const imk_gauss_markov unit = {1, time};
    for (size_t b = 0; b < p->bands; b++)
        shape[b] =
            p->index[b] < SINGLES
                ? imk_gauss_markov_cosine_spectrum(unit, p->settings->dt, (size_t)p->n,
                                                   (size_t)p->index[b])
                : imk_gauss_markov_sampled_spectrum(unit, p->settings->dt, frequency_of(p, b));
}

static void resonance_shape(const plan *p, double frequency, double q, double *shape)
{
    imk_arma arma;
    if (imk_resonance_arma((imk_resonance){1, frequency, q}, p->settings->dt, &arma) == IMK_OK)
        for (size_t b = 0; b < p->bands; b++)
            shape[b] = imk_arma_spectrum(&arma, frequency_of(p, b));
}

static void term_shape(const plan *p, int term, double *shape)
{
    const double dt = p->settings->dt;
    if (term == IMK_NOISE_WHITE) {
        white_shape(p, p->noise->filter, shape);
        return;
    }
    for (size_t b = 0; b < p->bands; b++) {
        const double f = frequency_of(p, b), k = p->index[b];
        shape[b] = term == IMK_NOISE_QUANTIZATION  ? imk_quantization_sampled_spectrum(1, dt, f)
                   : term == IMK_NOISE_RANDOM_WALK ? imk_random_walk_sampled_spectrum(1, dt, f)
                   : k < SINGLES ? imk_flicker_cosine_spectrum((imk_flicker){1, 0}, dt,
                                                               (size_t)p->n, (size_t)k)
                                 : imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
    }
}

static void set_amounts(plan *p)
{
    const imk_expected_noise *noise = p->noise;
    p->amounts = 0;
    for (int term = 0; term < 4; term++) {
        const bool free = noise->term[term] > 0 || p->settings->free[term];
        p->slot[term] = free ? (int)p->amounts : -1;
        if (free) {
            p->amount[p->amounts] = noise->term[term] * noise->term[term];
            term_shape(p, term, p->column[p->amounts++]);
        }
    }
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        p->gauss_markov[i] = p->amounts;
        p->amount[p->amounts] = noise->gauss_markov[i].sigma * noise->gauss_markov[i].sigma;
        gauss_markov_shape(p, noise->gauss_markov[i].correlation_time, p->column[p->amounts++]);
    }
    for (int i = 0; i < noise->resonance_count; i++) {
        const imk_resonance *r = &noise->resonance[i];
        p->amount[p->amounts] = r->sigma * r->sigma;
        resonance_shape(p, r->frequency, r->q, p->column[p->amounts++]);
    }
    memset(p->spectrum, 0, sizeof p->spectrum);
    for (size_t j = 0; j < p->amounts; j++)
        for (size_t b = 0; b < p->bands; b++)
            p->spectrum[b] += p->amount[j] * p->column[j][b];
}

/* The column amount (shape(+) - shape(-))/(2 step), of two shapes at a parameter's logarithm plus
 * and minus a step: STEP^2/6 of the third derivative remains. */
static const double STEP = 1e-3;

static void add_difference(plan *p, double amount)
{
    double *column = p->column[p->parameters++];
    for (size_t b = 0; b < p->bands; b++)
        column[b] = amount * (p->scratch[0][b] - p->scratch[1][b]) / (2 * STEP);
}

static void set_shapes(plan *p)
{
    const imk_expected_noise *noise = p->noise;
    const double up = 1 + STEP, down = 1 - STEP;
    p->parameters = p->amounts;
    if (!p->settings->shape)
        return;
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        const imk_gauss_markov *g = &noise->gauss_markov[i];
        p->time[i] = p->parameters;
        gauss_markov_shape(p, g->correlation_time * up, p->scratch[0]);
        gauss_markov_shape(p, g->correlation_time * down, p->scratch[1]);
        add_difference(p, g->sigma * g->sigma);
    }
    for (int i = 0; i < noise->resonance_count; i++) {
        const imk_resonance *r = &noise->resonance[i];
        const double part = STEP / r->q; /* of a narrow one */
        resonance_shape(p, r->frequency * (1 + part), r->q, p->scratch[0]);
        resonance_shape(p, r->frequency * (1 - part), r->q, p->scratch[1]);
        add_difference(p, r->sigma * r->sigma);
        resonance_shape(p, r->frequency, r->q * up, p->scratch[0]);
        resonance_shape(p, r->frequency, r->q * down, p->scratch[1]);
        add_difference(p, r->sigma * r->sigma);
    }
    const imk_low_pass f = noise->filter;
    const double white = noise->term[IMK_NOISE_WHITE] * noise->term[IMK_NOISE_WHITE];
    if (!(f.bandwidth > 0 && white > 0))
        return;
    white_shape(p, (imk_low_pass){f.bandwidth * up, f.damping}, p->scratch[0]);
    white_shape(p, (imk_low_pass){f.bandwidth * down, f.damping}, p->scratch[1]);
    add_difference(p, white);
    if (f.damping > 0) {
        white_shape(p, (imk_low_pass){f.bandwidth, f.damping * up}, p->scratch[0]);
        white_shape(p, (imk_low_pass){f.bandwidth, f.damping * down}, p->scratch[1]);
        add_difference(p, white);
    }
}

/* ---- covariance ------------------------------------------------------------------------------ */

/* Information of the columns in `index`, at a spectrum. */
static void information(const plan *p, const double *spectrum, size_t count, const size_t *index,
                        double *h)
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = 0;
            for (size_t b = 0; b < p->bands; b++)
                sum += 0.5 * p->degrees[b] * p->column[index[i]][b] * p->column[index[j]][b] /
                       (spectrum[b] * spectrum[b]);
            h[i * count + j] = h[j * count + i] = sum;
        }
}

/* Inverse of the information of all parameters. One that the record says nothing about at all has
 * no part in it: its variance is infinite. */
static imk_status invert(plan *p)
{
    double *h = p->matrix[0], *inverse = p->matrix[1];
    double scale[PARAMETERS_MAX];
    size_t index[PARAMETERS_MAX] = {0};
    const size_t count = p->parameters;
    for (size_t i = 0; i < count; i++)
        index[i] = i;
    information(p, p->spectrum, count, index, h);
    for (size_t i = 0; i < count; i++)
        scale[i] = h[i * count + i] > 0 ? 1 / sqrt(h[i * count + i]) : 0;
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            h[i * count + j] = i == j ? 1 + 1e-13 : h[i * count + j] * scale[i] * scale[j];
    if (imk_cholesky_factor(count, h) != IMK_OK)
        return IMK_ERROR_SINGULAR;
    imk_cholesky_inverse(count, h, inverse);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            p->covariance[i * count + j] = scale[i] > 0 && scale[j] > 0
                                               ? inverse[i * count + j] * scale[i] * scale[j]
                                           : i == j ? HUGE_VAL
                                                    : 0;
    return IMK_OK;
}

/* Variance of a ramp from the lowest coefficients, of which it is the mean: DCT-II of a ramp, as in
 * cosine_spectrum.c. The sum goes as 1/k^4 at the least. */
static double ramp_variance(const plan *p)
{
    double sum = 0;
    for (size_t b = 0; b < p->bands && p->degrees[b] < 1.5 && b < SINGLES; b += 2) {
        const double half = 1.5707963267948966 * p->index[b] / p->n, s = imk_sin(half);
        const double dt = p->settings->dt, d = sqrt(2 / p->n) * dt * imk_cos(half) / (2 * s * s);
        sum += d * d * dt / p->spectrum[b];
    }
    return 1 / sum;
}

/* ---- detection ------------------------------------------------------------------------------- */

static double divergence(const plan *p, const double *spectrum)
{
    double sum = 0;
    for (size_t b = 0; b < p->bands; b++) {
        const double ratio = p->spectrum[b] / spectrum[b];
        if (!(spectrum[b] > 0))
            return HUGE_VAL;
        sum += p->degrees[b] * (ratio - 1 - imk_ln(ratio));
    }
    return sum;
}

static void reduce(plan *p, size_t count, const size_t *index, const double *amount)
{
    memset(p->reduced, 0, sizeof p->reduced);
    for (size_t i = 0; i < count; i++)
        for (size_t b = 0; b < p->bands; b++)
            p->reduced[b] += amount[i] * p->column[index[i]][b];
}

/* Scoring step of the amounts that are free to move: at zero they only rise. */
static bool reduced_step(const plan *p, size_t count, const size_t *index, const double *amount,
                         double *step)
{
    size_t chosen[AMOUNTS_MAX], place[AMOUNTS_MAX], left = count;
    for (size_t i = 0; i < count; i++)
        place[i] = i;
    while (left > 0) {
        double h[AMOUNTS_MAX * AMOUNTS_MAX], g[AMOUNTS_MAX], scale[AMOUNTS_MAX];
        for (size_t i = 0; i < left; i++)
            chosen[i] = index[place[i]];
        information(p, p->reduced, left, chosen, h);
        for (size_t i = 0; i < left; i++) {
            g[i] = 0;
            for (size_t b = 0; b < p->bands; b++)
                g[i] += 0.5 * p->degrees[b] * p->column[chosen[i]][b] *
                        (p->spectrum[b] - p->reduced[b]) / (p->reduced[b] * p->reduced[b]);
            scale[i] = h[i * left + i] > 0 ? 1 / sqrt(h[i * left + i]) : 0;
        }
        for (size_t i = 0; i < left; i++) {
            for (size_t j = 0; j < left; j++)
                h[i * left + j] = i == j ? 1 + 1e-12 : h[i * left + j] * scale[i] * scale[j];
            g[i] *= scale[i];
        }
        if (imk_cholesky_factor(left, h) != IMK_OK)
            return false;
        imk_cholesky_solve(left, h, g);
        size_t worst = left;
        for (size_t i = 0; i < left; i++)
            if (amount[place[i]] <= 0 && g[i] < 0 && (worst == left || g[i] < g[worst]))
                worst = i;
        memset(step, 0, count * sizeof *step);
        for (size_t i = 0; i < left; i++)
            step[place[i]] = g[i] * scale[i];
        if (worst == left)
            return true;
        for (size_t i = worst; i + 1 < left; i++)
            place[i] = place[i + 1];
        left--;
    }
    return false;
}

/* The spectrum that the other amounts come to without one of them, as p->reduced; returns L. */
static double without(plan *p, size_t term)
{
    size_t index[AMOUNTS_MAX], count = 0;
    double amount[AMOUNTS_MAX], trial[AMOUNTS_MAX], step[AMOUNTS_MAX];
    for (size_t j = 0; j < p->amounts; j++)
        if (j != term) {
            /* The others start where they would be if each took the term's place in turn. */
            amount[count] = p->amount[j];
            for (size_t b = 0; b < p->bands; b += p->bands / 8 + 1)
                amount[count] = fmax(amount[count], 0.1 * p->amount[term] * p->column[term][b] /
                                                        p->column[j][b] / (double)p->amounts);
            index[count++] = j;
        }
    reduce(p, count, index, amount);
    double best = divergence(p, p->reduced);
    for (int iteration = 0; iteration < 100; iteration++) {
        const double before = best;
        if (!reduced_step(p, count, index, amount, step))
            break;
        for (double part = 1; part > 1e-9; part *= 0.5) {
            for (size_t i = 0; i < count; i++)
                trial[i] = fmax(0, amount[i] + part * step[i]);
            reduce(p, count, index, trial);
            const double now = divergence(p, p->reduced);
            if (now <= best) {
                best = now;
                memcpy(amount, trial, sizeof amount);
                break;
            }
        }
        if (before - best <= 1e-6 * (1 + best))
            break;
    }
    reduce(p, count, index, amount);
    return best;
}

/* Chance that the gain exceeds z^2/2. */
static double detection_of(plan *p, size_t term, double z)
{
    const double mean = without(p, term);
    if (p->amounts < 2 || !(mean < HUGE_VAL))
        return 1;
    double squares = 0;
    for (size_t b = 0; b < p->bands; b++) {
        const double excess = p->spectrum[b] / p->reduced[b] - 1;
        squares += p->degrees[b] * excess * excess;
    }
    const double sd = mean > 1e-9 ? sqrt(squares / (2 * mean)) : 1;
    return imk_normal_probability((sqrt(mean) - z) / sd);
}

/* A Gauss-Markov term's threshold: term_search.c. */
static double gauss_markov_quantile(const plan *p)
{
    const double path = fmax(0, 0.5 * imk_ln(p->n / 300)), chance = 0.1 * p->settings->significance;
    double low = 0, high = 10;
    for (int i = 0; i < 40; i++) {
        const double z = 0.5 * (low + high);
        const double p_above =
            imk_normal_probability(-z) + path / 6.283185307179586 * imk_exp(-0.5 * z * z);
        *(p_above > chance ? &low : &high) = z;
    }
    return high;
}

/* ---- result ---------------------------------------------------------------------------------- */

static imk_bound bound_of(double value, double square_variance)
{
    const double sd = sqrt(square_variance), magnitude = fabs(value);
    return (imk_bound){.value = value,
                       .square_sigma = sd,
                       .sigma = magnitude > 0 ? sd / (2 * magnitude) : HUGE_VAL,
                       .relative = magnitude > 0 ? sd / (2 * magnitude * magnitude) : HUGE_VAL};
}

static void store(plan *p, imk_identification_bounds *bounds)
{
    const double *covariance = p->covariance;
    const double z = imk_normal_quantile(1 - p->settings->significance);
    const size_t count = p->parameters;
    for (int i = 0; i < IMK_NOISE_TERMS; i++) /* what is not estimated */
        bounds->term[i] = (imk_bound){0, HUGE_VAL, HUGE_VAL, HUGE_VAL, 0};
    for (int i = 0; i < 4; i++) {
        if (p->slot[i] < 0)
            continue;
        const size_t slot = (size_t)p->slot[i];
        bounds->term[i] = bound_of(p->noise->term[i], covariance[slot * count + slot]);
        if (p->amount[slot] > 0)
            bounds->term[i].detection = detection_of(p, slot, z);
        for (int j = 0; j < 4; j++)
            if (p->slot[j] >= 0)
                bounds->covariance[i][j] = covariance[slot * count + (size_t)p->slot[j]];
    }
    const double ramp = p->noise->term[IMK_NOISE_RAMP];
    if (ramp != 0 || p->settings->free[IMK_NOISE_RAMP]) {
        const double variance = ramp_variance(p), sd = sqrt(variance);
        /* A ramp must be twenty times less likely by chance, to either side: term_search.c. */
        const double quantile = imk_normal_quantile(1 - p->settings->significance / 40);
        bounds->term[IMK_NOISE_RAMP] = (imk_bound){
            .value = ramp,
            .square_sigma = 2 * fabs(ramp) * sd,
            .sigma = sd,
            .relative = ramp != 0 ? sd / fabs(ramp) : HUGE_VAL,
            .detection = ramp != 0 ? imk_normal_probability(fabs(ramp) / sd - quantile) : 0};
        bounds->covariance[IMK_NOISE_RAMP][IMK_NOISE_RAMP] = variance;
    }
    for (int i = 0; i < p->noise->gauss_markov_count; i++) {
        const size_t slot = p->gauss_markov[i];
        const double time = p->noise->gauss_markov[i].correlation_time;
        bounds->sigma[i] =
            bound_of(p->noise->gauss_markov[i].sigma, covariance[slot * count + slot]);
        bounds->sigma[i].detection = detection_of(p, slot, gauss_markov_quantile(p));
        bounds->correlation_time[i] = (imk_bound){.value = time};
        if (p->settings->shape) {
            const double relative = sqrt(covariance[p->time[i] * count + p->time[i]]);
            bounds->correlation_time[i].relative = relative;
            bounds->correlation_time[i].sigma = relative * time;
            bounds->correlation_time[i].square_sigma = 2 * relative * time * time;
        }
        bounds->correlation_time[i].detection = bounds->sigma[i].detection;
    }
}

static imk_status check(const imk_expected_noise *noise, const imk_bounds_settings *settings,
                        double duration, size_t workspace_size, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_bounds_default()");
    if (!(settings->dt > 0) || !(settings->significance > 0 && settings->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, significance in (0, 0.5)");
    if (!(duration >= SAMPLES_MIN * settings->dt * (1 - 1e-9) &&
          duration <= SAMPLES_MAX * settings->dt))
        return imk_error_set(error, IMK_ERROR_RANGE, "duration", NULL,
                             "between 256 and 1e12 sample intervals");
    if (workspace_size < imk_bounds_workspace_size())
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_bounds_workspace_size() bytes");
    double sum = 0;
    for (int term = 0; term < IMK_NOISE_RAMP; term++) {
        if (!(noise->term[term] >= 0 && noise->term[term] < HUGE_VAL))
            return imk_error_set(error, IMK_ERROR_RANGE, "noise", NULL,
                                 "use finite strengths >= 0");
        sum += noise->term[term];
    }
    for (int i = 0; i < noise->gauss_markov_count; i++) {
        const imk_gauss_markov *g = &noise->gauss_markov[i];
        if (!(g->sigma > 0 && g->sigma < HUGE_VAL && g->correlation_time > 0 &&
              g->correlation_time < HUGE_VAL))
            return imk_error_set(error, IMK_ERROR_RANGE, "noise.gauss_markov", NULL,
                                 "use a finite sigma and correlation time > 0");
        sum += g->sigma;
    }
    return sum > 0 ? IMK_OK
                   : imk_error_set(error, IMK_ERROR_RANGE, "noise", NULL,
                                   "at least one of white noise, bias instability, random walk, "
                                   "quantization and Gauss-Markov noise");
}

imk_status imk_identify_bounds(const imk_expected_noise *noise, const imk_bounds_settings *settings,
                               double duration, imk_identification_bounds *bounds, void *workspace,
                               size_t workspace_size, imk_error *error)
{
    const imk_status status = check(noise, settings, duration, workspace_size, error);
    if (status != IMK_OK)
        return status;
    plan *p = (void *)imki_align(workspace);
    p->noise = noise;
    p->settings = settings;
    p->n = floor(duration / settings->dt + 0.5);
    lay_bands(p);
    set_amounts(p);
    set_shapes(p);
    imk_identification_bounds found = {0};
    if (invert(p) != IMK_OK)
        return imk_error_set(error, IMK_ERROR_SINGULAR, "noise", NULL,
                             "leave out terms that a record cannot separate");
    store(p, &found);
    *bounds = found;
    return IMK_OK;
}
