/* SPDX-License-Identifier: Apache-2.0 */
/* A record with samples missing: its spectrum and the missing samples, by turns.
 *
 * Given a spectrum v, let f be the cosine coefficients of the record whose missing samples are
 * filled with their conditional mean (missing_fill.c), and V_k the variance that this leaves open
 * in coefficient k. Then E f_k^2 = v_k - V_k if the spectrum is right. With a_k = 1 - V_k/v_k,
 * f_k^2/a_k takes the place of c_k^2 in Whittle's likelihood [WHITTLE1953]: this is expectation
 * maximisation [DEMPSTER1977] with other weights, those of missing_information.c. The sum of
 * 1 - a_k is the number of missing samples, exactly; each is found from draws.
 *
 * So the spectrum is measured in bands and the record is filled with it, until the bands stay
 * (missing_spectrum.c). Then the terms are chosen and fitted as ever, the record is filled with
 * their spectrum, and the terms again, until they stay: a spectrum free in every band would be
 * known less well than its terms, and lend its errors to the filling. */
#include "missing_internal.h"

#include "base/workspace_internal.h"
#include "imukit/elementary.h"
#include "imukit/fourier.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Fixed for ever: the same record gives the same result. */
enum { SEED = 0x6d697373, TURNS_MAX = 8, REFINEMENTS_MAX = 4 };

/* Degrees of freedom that a band's lost share is averaged over, which leaves it uncertain by 7 %.
 */
static const double LOST_DEGREES = 400;
/* Another round is due while the bands move by more than this, as half the sum of squares of their
 * changes in standard deviations: first of the bands, then of the fit. What is left is a small part
 * of it. */
static const double BANDS_SETTLED = 1, FIT_SETTLED = 0.01;

size_t imki_missing_size(size_t count)
{
    return imki_aligned(sizeof(imki_missing)) + imki_aligned(count * sizeof(uint32_t)) +
           3 * imki_aligned(count * sizeof(double));
}

imki_missing *imki_missing_place(void *memory, size_t count)
{
    imki_parts parts = {memory, 0};
    imki_missing *m = imki_take(&parts, sizeof *m);
    memset(m, 0, offsetof(imki_missing, scratch));
    m->count = count;
    for (int i = 0; i < 3; i++)
        m->vector[i] = imki_take(&parts, count * sizeof(double));
    m->index = imki_take(&parts, count * sizeof(uint32_t));
    return m;
}

/* Runs by octaves of their length. */
static void add_run(imki_missing *m, size_t run)
{
    size_t octave = 0;
    while (octave + 1 < IMKI_RUN_OCTAVES && run >> (octave + 1) > 0)
        octave++;
    if (run > 0) {
        m->runs[octave] += 1;
        m->in_runs[octave] += (double)run;
    }
}

/* Their places; how many lie between present samples, and the longest run of these. The first
 * sample is present. */
static void find_missing(imki_missing *m, size_t n, const double *samples,
                         imk_identification *result)
{
    size_t count = 0, run = 0, longest = 0;
    for (size_t i = 0; i < n; i++) {
        if (isnan(samples[i])) {
            m->index[count++] = (uint32_t)i;
            run++;
        } else {
            add_run(m, run);
            longest = run > longest ? run : longest;
            run = 0;
        }
    }
    add_run(m, run);
    result->missing = count - run;
    result->largest_gap = (double)longest;
}

/* Variance of neighbours' differences, halved: the fast noise; of the whole when no two present
 * samples are neighbours. */
static double fast_variance(size_t n, const double *samples)
{
    double differences = 0, squares = 0;
    size_t pairs = 0, present = 0;
    for (size_t i = 0; i < n; i++) {
        if (isnan(samples[i]))
            continue;
        present++;
        squares += samples[i] * samples[i];
        if (i + 1 < n && !isnan(samples[i + 1])) {
            const double d = samples[i + 1] - samples[i];
            differences += 0.5 * d * d;
            pairs++;
        }
    }
    squares /= (double)present;
    return pairs > 16 ? fmax(differences / (double)pairs, 1e-12 * squares) : squares;
}

/* Variance of a random walk's step, from the means of 64 blocks beyond what fast noise explains:
 * means over tau of a walk differ by 2/3 K^2 tau. */
static double walk_variance(size_t n, const double *samples, double fast)
{
    enum { BLOCKS = 64 };
    double mean[BLOCKS], count[BLOCKS], sum = 0, pairs = 0;
    for (size_t part = 0; part < BLOCKS; part++) {
        mean[part] = count[part] = 0;
        for (size_t i = part * n / BLOCKS; i < (part + 1) * n / BLOCKS; i++)
            if (!isnan(samples[i])) {
                mean[part] += samples[i];
                count[part] += 1;
            }
        mean[part] /= fmax(1, count[part]);
    }
    for (size_t part = 1; part < BLOCKS; part++)
        if (count[part] > 0 && count[part - 1] > 0) {
            const double d = mean[part] - mean[part - 1];
            sum += d * d - fast * (1 / count[part] + 1 / count[part - 1]);
            pairs += 1;
        }
    return pairs > 0 ? fmax(0, 1.5 * sum / pairs * BLOCKS / (double)n) : 0;
}

/* A local level and white noise, as the first spectrum: its missing samples start at zero, which is
 * the mean. */
static void start(imki_work *w, imki_missing *m)
{
    const double fast = fast_variance(w->n, w->samples);
    const double walk = walk_variance(w->n, w->samples, fast);
    imki_missing_bands(m, w->n);
    m->line_count = 0;
    for (size_t b = 0; b < m->bands; b++) {
        const double s = imk_sin(1.5707963267948966 * m->centre[b] / (double)w->n);
        m->level[b] = imk_ln(fast + walk / (4 * s * s));
    }
    double last = 0;
    for (size_t i = 0; i < w->n; i++) {
        last = isnan(w->samples[i]) ? last : w->samples[i];
        w->samples[i] = isnan(w->samples[i]) && walk > 1e-3 * fast ? last : w->samples[i];
        w->samples[i] = isnan(w->samples[i]) ? 0 : w->samples[i];
    }
}

static imki_fill fill_of(imki_work *w, imki_missing *m)
{
    size_t runs = 0;
    for (size_t i = 0; i < m->count; i++)
        runs += i == 0 || m->index[i] != m->index[i - 1] + 1;
    return (imki_fill){.n = w->n,
                       .missing = m->count,
                       .index = m->index,
                       .variance = w->cumulative,
                       .gap = (double)m->count / (double)runs,
                       .scratch = w->coefficients,
                       .solution = m->vector[0],
                       .residual = m->vector[1],
                       .direction = m->vector[2],
                       .transform = w->transform,
                       .transform_size = w->transform_size};
}

/* Share of each band's variance that is missing, from draws. Over all coefficients, those of lines
 * included, the shares add up to the missing samples. */
static void find_lost(imki_fill *fill, imki_missing *m, uint64_t draws)
{
    double *mean = m->scratch[0], *count = m->scratch[1], *raw = m->scratch[2];
    double all = 0, between_lines = 0, smoothed = 0;
    memset(raw, 0, m->bands * sizeof *raw);
    for (uint64_t draw = 0; draw < draws; draw++) {
        imki_fill_draw(fill, imk_random_seeded(SEED), draw);
        imki_fill_coefficients(fill);
        imki_missing_means(m, fill->scratch, fill->variance, mean, count);
        for (size_t k = 1; k < fill->n; k++)
            all += fill->scratch[k] * fill->scratch[k] / fill->variance[k];
        for (size_t b = 0; b < m->bands; b++) {
            raw[b] += mean[b] / (double)draws;
            between_lines += count[b] * mean[b];
        }
    }
    imki_missing_smooth(m->bands, raw, count, LOST_DEGREES / (double)draws, m->lost);
    for (size_t b = 0; b < m->bands; b++)
        smoothed += count[b] * m->lost[b];
    const double factor =
        smoothed > 0 && all > 0 ? (double)m->count * between_lines / all / smoothed : 0;
    for (size_t b = 0; b < m->bands; b++)
        m->lost[b] = fmin(0.98, m->lost[b] * factor);
}

/* One round; returns how far the bands moved. */
static double turn(imki_work *w, imki_missing *m, imki_fill *fill)
{
    double *power = m->scratch[0], *degrees = m->scratch[1];
    imki_fill_mean(fill, w->samples);
    find_lost(fill, m, 1);
    memcpy(w->coefficients, w->samples, w->n * sizeof(double));
    (void)imk_cosine(w->n, w->coefficients, w->transform, w->transform_size); /* sized for it */
    imki_missing_lines(w, m);
    imki_missing_means(m, w->coefficients, NULL, power, degrees);
    for (size_t b = 0; b < m->bands; b++) {
        power[b] /= 1 - m->lost[b];
        degrees[b] *= 1 - m->lost[b];
    }
    const double moved = imki_missing_levels(w, m, power, degrees);
    imki_missing_spread(m, w->n, w->coefficients, w->cumulative);
    return moved;
}

/* A ramp goes through the same filling as the record, and what comes out is what the fit looks for.
 */
static void fill_ramp(imki_work *w, imki_missing *m, imki_fill *fill)
{
    const double dt = w->settings->dt, middle = 0.5 * (double)(w->n - 1);
    for (size_t i = 0; i < w->n; i++)
        fill->scratch[i] = ((double)i - middle) * dt;
    imki_fill_correction(fill);
    for (size_t i = 0; i < w->n; i++)
        fill->scratch[i] = ((double)i - middle) * dt;
    for (size_t i = 0; i < m->count; i++)
        fill->scratch[m->index[i]] += fill->solution[i];
    (void)imk_cosine(w->n, fill->scratch, w->transform, w->transform_size);
    for (size_t k = 1; k < IMKI_SINGLE_BANDS && k < w->n; k++)
        m->ramp[k] = fill->scratch[k];
}

/* With the spectrum as it is: the ramp, the mean, the shares lost, and a draw. */
static void fill_finally(imki_work *w, imki_missing *m, imki_fill *fill)
{
    const double share = (double)m->count / (double)w->n;
    fill->tolerance = 2e-3;
    fill_ramp(w, m, fill);
    imki_fill_mean(fill, w->samples);
    find_lost(fill, m, 1 + (uint64_t)(4 * share));
    for (size_t i = 0; i < m->count; i++)
        fill->solution[i] += w->samples[m->index[i]];
}

void imki_missing_fill(imki_work *w, imk_identification *result)
{
    imki_missing *m = w->missing;
    find_missing(m, w->n, w->samples, result);
    result->largest_gap *= w->settings->dt;
    imki_fill fill = fill_of(w, m);
    start(w, m);
    imki_missing_spread(m, w->n, NULL, w->cumulative);
    fill.tolerance = 1e-2;
    for (m->rounds = 1; turn(w, m, &fill) > BANDS_SETTLED && m->rounds < TURNS_MAX; m->rounds++)
        ;
    fill_finally(w, m, &fill);
    result->rounds = m->rounds;
}

/* The fit at the bands it was made at becomes the spectrum; returns how far it has moved. The
 * common band, of no width, is left out. */
static double adopt_fit(const imki_work *w, imki_missing *m)
{
    const imki_bands *bands = w->bands;
    double *level = m->scratch[0], *lost = m->scratch[1], change = 0;
    size_t at = 0, lost_at = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const size_t k = (size_t)(bands->frequency[b] * 2 * (double)w->n * bands->dt + 0.5);
        level[b] = imk_ln(imki_fit_spectrum(w->fit, b) / bands->dt);
        lost[b] = imki_missing_between(m, m->lost, &lost_at, k);
        const double moved = level[b] - imki_missing_between(m, m->level, &at, k);
        change += 0.5 * bands->degrees[b] * moved * moved;
    }
    m->bands = bands->count;
    for (size_t b = 0; b < bands->count; b++) {
        m->centre[b] = bands->frequency[b] * 2 * (double)w->n * bands->dt;
        m->width[b] = m->whole[b];
        m->first[b] = floor(m->centre[b] - 0.5 * (m->width[b] - 1) + 0.25);
        m->level[b] = level[b];
        m->lost[b] = lost[b];
    }
    return change;
}

bool imki_missing_refine(imki_work *w, imk_identification *result)
{
    imki_missing *m = w->missing;
    if (!(adopt_fit(w, m) > FIT_SETTLED) || m->refinements++ == REFINEMENTS_MAX)
        return false;
    imki_fill fill = fill_of(w, m);
    memcpy(w->coefficients, w->samples, w->n * sizeof(double));
    (void)imk_cosine(w->n, w->coefficients, w->transform, w->transform_size);
    imki_missing_spread(m, w->n, w->coefficients, w->cumulative);
    fill_finally(w, m, &fill);
    result->rounds = ++m->rounds;
    return true;
}

void imki_missing_draw(const imki_missing *m, double *samples)
{
    for (size_t i = 0; i < m->count; i++)
        samples[m->index[i]] = m->vector[0][i];
}
