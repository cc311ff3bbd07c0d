/* SPDX-License-Identifier: Apache-2.0 */
/* Quantization, white noise, bias instability and random walk from a spectrum.
 *
 * In bands of 6 % the mean power P is S times a chi-square mean of v degrees, so with the spectra
 * of the four terms as the window sees them
 *
 *     l = -1/2 sum_b v_b [log S_b + P_b/S_b],   S_b = sum_j a_j shape_jb        [WHITTLE1953]
 *
 * which Fisher scoring maximises for each of the fifteen sets of terms. The set kept has the
 * largest 2 l less a price per term: the chi-square that a term which is not there exceeds with the
 * significance asked for. Intervals are those of the squares a_j with all four terms free. */
#include "spectrum_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { TERMS = IMK_NOISE_RANDOM_WALK + 1, SETS = 1 << TERMS, ALL = SETS - 1 };
enum { BANDS_MAX = 400, PER_DECADE = 40, CHECKED_PER_DECADE = 10, ITERATIONS = 60 };
enum { BINS_MIN = 8 };

typedef struct banded {
    size_t count;
    imk_spectrum_band band[BANDS_MAX];
    double shape[TERMS][BANDS_MAX];
} banded;

typedef struct fitted {
    double amount[TERMS], log_likelihood;
    bool feasible;
} fitted;

/* ---- shapes ---------------------------------------------------------------------------------- */

static double term_spectrum(int term, double dt, double f)
{
    const double nyquist = 0.5 / dt;
    f = fabs(f) > nyquist ? 2 * nyquist - fabs(f) : fabs(f);
    switch (term) {
    case IMK_NOISE_QUANTIZATION:
        return imk_quantization_sampled_spectrum(1, dt, f);
    case IMK_NOISE_WHITE:
        return 1;
    case IMK_NOISE_BIAS_INSTABILITY:
        return imk_flicker_sampled_spectrum((imk_flicker){1, 0}, dt, f);
    default:
        return imk_random_walk_sampled_spectrum(1, dt, f);
    }
}

/* What the window makes of it: three points that share the window's second moment. For Hann's the
 * points are bins and this is its kernel 1/6, 2/3, 1/6. */
static double seen_spectrum(const imk_spectrum *s, int term, double f)
{
    const double reach = sqrt(3.0) * s->blur;
    return 2.0 / 3 * term_spectrum(term, s->dt, f) +
           (term_spectrum(term, s->dt, f - reach) + term_spectrum(term, s->dt, f + reach)) / 6;
}

static double first_frequency(const imk_spectrum *s)
{
    return fmax(s->blur_bins + 1, 5 * s->blur / s->step) * s->step;
}

static void fill_bands(banded *b, const imk_spectrum *s, size_t line_count,
                       const imk_spectrum_line *lines, int per_decade, double lowest,
                       double highest)
{
    const size_t made =
        imk_spectrum_bands(s, per_decade, 0.95, line_count, lines, BANDS_MAX, b->band);
    b->count = 0;
    for (size_t i = 0; i < made; i++) {
        const imk_spectrum_band band = b->band[i];
        if (band.from < lowest - 0.6 * s->step || band.to > highest + 0.6 * s->step ||
            !(band.density > 0))
            continue;
        for (int term = 0; term < TERMS; term++)
            b->shape[term][b->count] = seen_spectrum(s, term, band.frequency);
        b->band[b->count++] = band;
    }
}

/* ---- likelihood ------------------------------------------------------------------------------ */

static double model_of(const banded *b, const double *amount, size_t band)
{
    double s = 0;
    for (int j = 0; j < TERMS; j++)
        s += amount[j] * b->shape[j][band];
    return s;
}

static double likelihood(const banded *b, const double *amount)
{
    double sum = 0;
    for (size_t i = 0; i < b->count; i++) {
        const double s = model_of(b, amount, i);
        if (!(s > 0))
            return -HUGE_VAL;
        const double power = b->band[i].density;
        sum += b->band[i].degrees * (imk_ln(s / power) + power / s);
    }
    return -0.5 * sum;
}

/* Gradient, and information scaled to a unit diagonal with its scales, over the terms of a set. */
static size_t slope(const banded *b, const double *amount, int set, double *gradient,
                    double *information, double *scale)
{
    int index[TERMS] = {0};
    size_t count = 0;
    for (int j = 0; j < TERMS; j++)
        if (set >> j & 1)
            index[count++] = j;
    memset(gradient, 0, TERMS * sizeof *gradient);
    memset(information, 0, TERMS * TERMS * sizeof *information);
    for (size_t i = 0; i < b->count; i++) {
        const double s = model_of(b, amount, i);
        for (size_t j = 0; j < count; j++) {
            const double shape = b->shape[index[j]][i] / s;
            gradient[j] += 0.5 * b->band[i].degrees * shape * (b->band[i].density / s - 1);
            for (size_t k = 0; k < count; k++)
                information[j * count + k] +=
                    0.5 * b->band[i].degrees * shape * b->shape[index[k]][i] / s;
        }
    }
    for (size_t j = 0; j < count; j++)
        scale[j] = 1 / sqrt(information[j * count + j]);
    for (size_t j = 0; j < count; j++)
        for (size_t k = 0; k < count; k++)
            information[j * count + k] *= scale[j] * scale[k];
    for (size_t j = 0; j < count; j++)
        information[j * count + j] += 1e-12; /* terms may coincide over a narrow range */
    return count;
}

/* Scoring from a start where each term alone touches the lowest band; steps are halved until the
 * likelihood rises. */
static fitted maximise(const banded *b, int set)
{
    fitted f = {.feasible = true};
    double members = 0;
    for (int j = 0; j < TERMS; j++)
        members += set >> j & 1;
    for (int j = 0; j < TERMS; j++) {
        double least = HUGE_VAL;
        for (size_t i = 0; i < b->count; i++)
            least = fmin(least, b->band[i].density / b->shape[j][i]);
        f.amount[j] = set >> j & 1 ? least / members : 0;
    }
    f.log_likelihood = likelihood(b, f.amount);
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        double g[TERMS], h[TERMS * TERMS], scale[TERMS], start[TERMS];
        const double before = f.log_likelihood;
        const size_t count = slope(b, f.amount, set, g, h, scale);
        for (size_t j = 0; j < count; j++)
            g[j] *= scale[j];
        if (imk_cholesky_factor(count, h) != IMK_OK)
            break;
        imk_cholesky_solve(count, h, g);
        memcpy(start, f.amount, sizeof start);
        for (double part = 1; part > 1e-9; part *= 0.5) {
            double trial[TERMS];
            size_t k = 0;
            for (int j = 0; j < TERMS; j++)
                trial[j] = set >> j & 1 ? start[j] + part * scale[k] * g[k] : 0, k += set >> j & 1;
            const double l = likelihood(b, trial);
            if (l > f.log_likelihood) {
                f.log_likelihood = l;
                memcpy(f.amount, trial, sizeof trial);
                break;
            }
        }
        if (f.log_likelihood - before < 1e-10)
            break;
    }
    for (int j = 0; j < TERMS; j++)
        f.feasible = f.feasible && (!(set >> j & 1) || f.amount[j] > 0);
    return f;
}

/* Standard deviations of the amounts of a set. */
static bool deviations(const banded *b, const double *amount, int set, double *deviation)
{
    double g[TERMS], h[TERMS * TERMS], scale[TERMS], inverse[TERMS * TERMS];
    const size_t count = slope(b, amount, set, g, h, scale);
    if (imk_cholesky_factor(count, h) != IMK_OK)
        return false;
    imk_cholesky_inverse(count, h, inverse);
    size_t k = 0;
    for (int j = 0; j < TERMS; j++) {
        deviation[j] = 0;
        if (set >> j & 1) {
            deviation[j] = sqrt(inverse[k * count + k]) * scale[k];
            k++;
        }
    }
    return true;
}

/* ---- result ---------------------------------------------------------------------------------- */

/* At the coarse bands. */
static void check_fit(const banded *b, const double *amount, imk_spectrum_parameters *result)
{
    double squares = 0, worst = -1;
    for (size_t i = 0; i < b->count; i++) {
        /* The cube root of chi-square is nearly normal [WILSON1931]. */
        const imk_spectrum_band *band = &b->band[i];
        const double ratio = band->density / model_of(b, amount, i), v = 2 / (9 * band->degrees);
        const double root = imk_exp(imk_ln(ratio) / 3), z = (root - (1 - v)) / sqrt(v);
        squares += z * z;
        if (fabs(z) > worst) {
            worst = fabs(z);
            result->worst_ratio = ratio;
            result->worst_frequency = band->frequency;
        }
    }
    result->misfit = b->count > 0 ? sqrt(squares / (double)b->count) : 0;
}

static imk_estimate estimate_of(double chosen, double deviation, double free_amount,
                                double free_deviation, double confidence)
{
    const double z = imk_normal_quantile(0.5 + 0.5 * confidence);
    const double one_sided = imk_normal_quantile(confidence);
    imk_estimate e = {
        .present = chosen > 0, .value = sqrt(chosen), .free_value = sqrt(free_amount)};
    if (e.present) {
        e.sigma = 0.5 * deviation / e.value;
        e.lower = sqrt(fmax(0, free_amount - z * free_deviation));
        e.upper = sqrt(free_amount + z * free_deviation);
    } else {
        e.upper = sqrt(free_amount + one_sided * free_deviation);
    }
    return e;
}

imk_status imk_spectrum_fit(const imk_spectrum *spectrum, size_t line_count,
                            const imk_spectrum_line *lines, double lowest, double highest,
                            double confidence, double significance, imk_spectrum_parameters *result)
{
    if (!(confidence > 0 && confidence < 1 && significance > 0 && significance < 0.5) ||
        !(lowest >= 0 && highest >= 0) || (highest > 0 && highest <= lowest))
        return IMK_ERROR_RANGE;
    banded b;
    imk_spectrum_parameters found = {.lowest = fmax(lowest, first_frequency(spectrum)),
                                     .highest = 0.5 / spectrum->dt};
    if (highest > 0)
        found.highest = fmin(highest, found.highest);
    fill_bands(&b, spectrum, line_count, lines, PER_DECADE, found.lowest, found.highest);
    if (b.count < BINS_MIN)
        return IMK_ERROR_TOO_SHORT;
    const double price = imk_chi_square_quantile(1 - 2 * significance, 1);
    int chosen = 0;
    fitted best = {.log_likelihood = -HUGE_VAL}, free_fit = best;
    double value = -HUGE_VAL;
    for (int set = 1; set < SETS; set++) {
        const fitted f = maximise(&b, set);
        double members = 0;
        for (int j = 0; j < TERMS; j++)
            members += set >> j & 1;
        if (!f.feasible)
            continue;
        if (f.log_likelihood > free_fit.log_likelihood)
            free_fit = f;
        if (2 * f.log_likelihood - members * price > value) {
            value = 2 * f.log_likelihood - members * price;
            best = f;
            chosen = set;
        }
    }
    double own[TERMS], all[TERMS];
    if (chosen == 0 || !deviations(&b, best.amount, chosen, own) ||
        !deviations(&b, free_fit.amount, ALL, all))
        return IMK_ERROR_NO_CONVERGENCE;
    for (int j = 0; j < TERMS; j++)
        found.term[j] = estimate_of(best.amount[j], own[j], free_fit.amount[j], all[j], confidence);
    fill_bands(&b, spectrum, line_count, lines, CHECKED_PER_DECADE, found.lowest, found.highest);
    check_fit(&b, best.amount, &found);
    *result = found;
    return IMK_OK;
}
