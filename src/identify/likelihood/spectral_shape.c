/* SPDX-License-Identifier: Apache-2.0 */
/* Frequency, quality and power of a resonance, from the spectrum around it.
 *
 * Within a window of some half-power widths the spectrum is level + power * shape(f0, q); for each
 * (f0, q) the two amounts have their own maximum-likelihood fit, so that only f0 and q are
 * searched, by turns. */
#include "identify_internal.h"

#include "imukit/elementary.h"

#include <math.h>

enum { WINDOW_BANDS = 160, TURNS = 6, SECTIONS = 14 };

typedef struct local_spectrum {
    size_t count;
    double dt;
    double frequency[WINDOW_BANDS], power[WINDOW_BANDS], degrees[WINDOW_BANDS];
} local_spectrum;

/* Log-likelihood at (f0, q), and the variance of the resonance there: none where (f0, q) is no
 * resonance, as q <= 1/2. */
static double local_likelihood(const local_spectrum *w, double frequency, double q,
                               double *variance)
{
    double shape[WINDOW_BANDS], level = HUGE_VAL, amount = 0;
    imk_arma unit;
    *variance = 0;
    if (imk_resonance_arma((imk_resonance){1, frequency, q}, w->dt, &unit) != IMK_OK)
        return -HUGE_VAL;
    for (size_t b = 0; b < w->count; b++) {
        shape[b] = imk_arma_spectrum(&unit, w->frequency[b]);
        level = fmin(level, w->power[b]);
    }
    for (int iteration = 0; iteration < 12; iteration++) {
        double g0 = 0, g1 = 0, h00 = 0, h01 = 0, h11 = 0;
        for (size_t b = 0; b < w->count; b++) {
            const double s = level + amount * shape[b], weight = w->degrees[b] / (s * s);
            g0 += weight * w->power[b];
            g1 += weight * w->power[b] * shape[b];
            h00 += weight;
            h01 += weight * shape[b];
            h11 += weight * shape[b] * shape[b];
        }
        const double determinant = h00 * h11 - h01 * h01;
        if (!(determinant > 0))
            break;
        const double next = (h11 * g0 - h01 * g1) / determinant;
        amount = fmax(0, (h00 * g1 - h01 * g0) / determinant);
        level = next > 1e-3 * level ? next : 1e-3 * level;
    }
    double sum = 0;
    for (size_t b = 0; b < w->count; b++) {
        const double s = level + amount * shape[b];
        sum += w->degrees[b] * imki_deviance(w->power[b], s);
    }
    *variance = amount;
    return -0.5 * sum;
}

static void cut_window(local_spectrum *w, const imk_resonance *r, size_t n, double dt,
                       const double *cumulative)
{
    const double step_hz = 1 / (2 * (double)n * dt), width = r->frequency / r->q / step_hz;
    const double reach = fmin(fmax(8 * width, 48), 0.5 * r->frequency / step_hz);
    const double from = r->frequency / step_hz - reach;
    w->count = 0;
    w->dt = dt;
    for (int b = 0; b < WINDOW_BANDS; b++) {
        const size_t first = (size_t)fmax(1, from + 2 * reach * b / WINDOW_BANDS);
        const size_t end = (size_t)fmin((double)n, from + 2 * reach * (b + 1) / WINDOW_BANDS);
        if (end <= first)
            continue;
        w->frequency[w->count] = 0.5 * (double)(first + end - 1) * step_hz;
        w->power[w->count] = (cumulative[end] - cumulative[first]) / (double)(end - first);
        w->degrees[w->count++] = (double)(end - first);
    }
}

/* One coordinate of the search, by its logarithm. */
typedef struct local_search {
    const local_spectrum *window;
    imk_resonance *resonance;
    double *field; /* of the resonance */
} local_search;

static double local_height(void *context, double logarithm)
{
    local_search *s = context;
    double variance;
    *s->field = imk_exp(logarithm);
    return local_likelihood(s->window, s->resonance->frequency, s->resonance->q, &variance);
}

static void search_locally(local_search *s, double *field, double reach)
{
    const double low = imk_ln(*field) - reach, high = imk_ln(*field) + reach;
    s->field = field;
    *field = imk_exp(imki_peak(local_height, s, low, high, SECTIONS));
}

/* A resonance has skirts: between one and four half-power widths from its peak its spectrum holds
 * 0.26 of its power (Lorentzian). A line without at least half of that is something else. */
static bool has_skirts(const local_spectrum *w, const imk_resonance *r)
{
    const imk_resonance unit = {1, r->frequency, r->q};
    const double width = r->frequency / r->q;
    double variance, found = 0, expected = 0, level = 0, far = 0;
    local_likelihood(w, r->frequency, r->q, &variance);
    for (size_t b = 0; b < w->count; b++)
        if (fabs(w->frequency[b] - r->frequency) > 5 * width) {
            level += w->degrees[b] * w->power[b];
            far += w->degrees[b];
        }
    if (!(far > 0))
        return true; /* as wide as its surroundings: nothing to tell it by */
    level /= far;
    for (size_t b = 0; b < w->count; b++) {
        const double distance = fabs(w->frequency[b] - r->frequency) / width;
        if (distance > 1 && distance < 4) {
            found += w->degrees[b] * (w->power[b] - level);
            expected += w->degrees[b] * variance *
                        imk_resonance_sampled_spectrum(unit, w->dt, w->frequency[b]);
        }
    }
    return found > 0.5 * expected;
}

bool imki_shape_resonance(imk_resonance *resonance, double line_variance, size_t n, double dt,
                          const double *cumulative)
{
    local_spectrum window;
    local_search search = {&window, resonance, NULL};
    for (int turn = 0; turn < TURNS; turn++) {
        if (turn % 2 == 0)
            cut_window(&window, resonance, n, dt, cumulative);
        search_locally(&search, &resonance->frequency, 1 / resonance->q);
        search_locally(&search, &resonance->q, 1.1); /* a factor of three */
    }
    double variance;
    local_likelihood(&window, resonance->frequency, resonance->q, &variance);
    resonance->sigma = sqrt(variance);
    /* Forced on a line of another shape, the fit gets the power wrong. */
    const bool same_power = variance > 0.75 * line_variance && variance < 1.5 * line_variance;
    return same_power && has_skirts(&window, resonance);
}
