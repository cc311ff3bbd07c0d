/* SPDX-License-Identifier: Apache-2.0 */
/* Identification of one channel: spectrum, lines, fit, choice of terms, intervals, verdict. */
#include "identify_internal.h"
#include "imukit/distributions.h"
#include "imukit/fourier.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

/* Quality above which a resonance counts as a narrow line. */
static const double NARROW = 50;

enum { COOKIE = 0x1DE70001, SAMPLES_MIN = 256, SORTED = 65536, FACTORS_MAX = 160 };

/* Everything that one channel needs, laid out in the caller's workspace. */
typedef struct identification_work {
    const imk_identify_settings *settings;
    size_t n;
    double *samples;      /* n: mean removed, sinusoids subtracted */
    double *coefficients; /* n: cosine transform */
    double *cumulative;   /* n + 1: powers summed, later running sums */
    void *transform;
    size_t transform_size;
    imki_bands *bands;
    imki_fit *fit, *trial, *chosen;
    size_t line_count;
    imki_line lines[IMKI_LINES_MAX]; /* left out of the fit */
    double correlation_times[IMKI_GAUSS_MARKOV_MAX];
} identification_work;

imk_identify_settings imk_identify_default(void)
{
    return (imk_identify_settings){
        .cookie = COOKIE, .confidence = 0.95, .significance = 0.01, .shape = true};
}

static size_t aligned(size_t size)
{
    return (size + 63) / 64 * 64;
}

size_t imk_identify_workspace_size(size_t n)
{
    return 64 + 3 * aligned((n + 1) * sizeof(double)) + aligned(sizeof(imki_bands)) +
           3 * aligned(sizeof(imki_fit)) + aligned(imk_cosine_workspace_size(n));
}

static void *take(char **memory, size_t size)
{
    void *start = *memory;
    *memory += aligned(size);
    return start;
}

static void lay_out(identification_work *w, void *workspace)
{
    char *memory = (char *)workspace + (64 - (uintptr_t)workspace % 64) % 64;
    w->samples = take(&memory, (w->n + 1) * sizeof(double));
    w->coefficients = take(&memory, (w->n + 1) * sizeof(double));
    w->cumulative = take(&memory, (w->n + 1) * sizeof(double));
    w->bands = take(&memory, sizeof(imki_bands));
    w->fit = take(&memory, sizeof(imki_fit));
    w->trial = take(&memory, sizeof(imki_fit));
    w->chosen = take(&memory, sizeof(imki_fit));
    w->transform_size = imk_cosine_workspace_size(w->n);
    w->transform = take(&memory, w->transform_size);
}

/* ---- spectrum and lines ---------------------------------------------------------------------- */

static void transform(identification_work *w)
{
    memcpy(w->coefficients, w->samples, w->n * sizeof(double));
    (void)imk_cosine(w->n, w->coefficients, w->transform, w->transform_size); /* sized for it */
    w->cumulative[0] = w->cumulative[1] = 0;
    for (size_t k = 1; k < w->n; k++)
        w->cumulative[k + 1] =
            w->cumulative[k] + w->coefficients[k] * w->coefficients[k] * w->settings->dt;
}

static double centre_of(const imki_line *line)
{
    return 0.5 * (double)(line->first + line->last);
}

static double variance_of(const identification_work *w, const imki_line *line)
{
    return imki_line_variance(line, w->n, w->settings->dt, w->cumulative);
}

static size_t peak_of(const identification_work *w, const imki_line *line)
{
    size_t peak = line->first;
    for (size_t k = line->first; k <= line->last; k++)
        peak = fabs(w->coefficients[k]) > fabs(w->coefficients[peak]) ? k : peak;
    return peak;
}

/* Subtract the tones: a tone's skirts may make a line of sixteen coefficients of it, no more. */
static void remove_tones(identification_work *w, size_t count, const imki_line *lines,
                         imk_identification *result)
{
    const double step_hz = 1 / (2 * (double)w->n * w->settings->dt);
    for (size_t i = 0; i < count; i++)
        if (lines[i].last - lines[i].first < 16 && result->sinusoid_count < IMK_TERMS_MAX &&
            imki_sinusoid_remove(w->n, w->settings->dt, (double)peak_of(w, &lines[i]) * step_hz,
                                 variance_of(w, &lines[i]), w->samples,
                                 &result->sinusoid[result->sinusoid_count]))
            result->sinusoid_count++;
}

/* What a line is: a tone is subtracted as a sinusoid; what is shaped like a resonance is one; a
 * line that is neither, such as a tone whose frequency wanders, stands in the model as a sinusoid
 * of its power. Only wide resonances take part in the fit: narrow lines are left out of it, and
 * their power is what is found above their surroundings, whatever their exact shape. */
static void find_lines(identification_work *w, imk_identification *result)
{
    const double dt = w->settings->dt, step_hz = 1 / (2 * (double)w->n * dt);
    imki_line lines[IMKI_LINES_MAX];
    size_t count = imki_lines_find(w->n, w->cumulative, lines);
    remove_tones(w, count, lines, result);
    if (result->sinusoid_count > 0) {
        transform(w);
        count = imki_lines_find(w->n, w->cumulative, lines);
    }
    for (size_t i = 0; i < count; i++) {
        const double centre = centre_of(&lines[i]), variance = variance_of(w, &lines[i]);
        const double width = (double)(lines[i].last - lines[i].first + 1);
        imk_resonance r = {0, centre * step_hz, fmax(1, centre / width)};
        /* A frequency far below the sample rate is none that imk_resonance_arma() takes. */
        const bool resonant = width > 2 && r.frequency * dt > 1e-5 &&
                              result->resonance_count < IMK_TERMS_MAX &&
                              imki_shape_resonance(&r, variance, w->n, dt, w->cumulative);
        const bool narrow = !resonant || r.q > NARROW;
        if (narrow)
            w->lines[w->line_count++] = imki_line_widen(&lines[i], w->n);
        if (resonant) {
            r.sigma = narrow ? sqrt(variance) : r.sigma;
            result->resonance[result->resonance_count++] = r;
        } else if (result->sinusoid_count < IMK_TERMS_MAX) {
            result->sinusoid[result->sinusoid_count++] =
                (imk_sinusoid){sqrt(2 * variance), centre * step_hz};
        }
    }
}

/* ---- fit ------------------------------------------------------------------------------------- */

static void set_templates(identification_work *w, const imk_identification *result)
{
    imki_fit *fit = w->fit;
    const imki_bands *bands = w->bands;
    memset(fit, 0, sizeof *fit);
    fit->templates = IMKI_FIRST_RESONANCE + (size_t)result->resonance_count;
    for (size_t b = 0; b < bands->count; b++) {
        const double f = bands->frequency[b], dt = bands->dt;
        fit->shape[IMK_NOISE_QUANTIZATION][b] = imk_quantization_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_WHITE][b] = imk_white_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_BIAS_INSTABILITY][b] =
            b < bands->singles ? imk_flicker_cosine_spectrum(1, dt, bands->n, b + 1)
                               : imk_flicker_sampled_spectrum(1, dt, f);
        fit->shape[IMK_NOISE_RANDOM_WALK][b] = imk_random_walk_sampled_spectrum(1, dt, f);
    }
    for (int r = 0; r < result->resonance_count; r++)
        imki_resonance_shape(result->resonance[r].frequency, result->resonance[r].q, bands,
                             fit->shape[IMKI_FIRST_RESONANCE + r]);
    for (size_t j = IMK_NOISE_WHITE; j < fit->templates; j++)
        fit->active[j] =
            j <= IMK_NOISE_RANDOM_WALK ||
            (j >= IMKI_FIRST_RESONANCE && result->resonance[j - IMKI_FIRST_RESONANCE].q <= NARROW);
    for (int r = 0; r < result->resonance_count; r++)
        fit->amount[IMKI_FIRST_RESONANCE + r] =
            result->resonance[r].sigma * result->resonance[r].sigma;
    /* Start: white from the middle of the spectrum, half the lowest power to each slow term. */
    fit->amount[IMK_NOISE_WHITE] = bands->power[bands->count * 3 / 4];
    const double low = (bands->power[0] + bands->power[1] + bands->power[2] + bands->power[3]) / 8;
    fit->amount[IMK_NOISE_BIAS_INSTABILITY] = low / fit->shape[IMK_NOISE_BIAS_INSTABILITY][3];
    fit->amount[IMK_NOISE_RANDOM_WALK] = low / fit->shape[IMK_NOISE_RANDOM_WALK][1];
}

static double gain_without(identification_work *w, int term)
{
    *w->trial = *w->fit;
    w->trial->active[term] = false;
    w->trial->amount[term] = 0;
    return w->fit->log_likelihood - imki_fit_maximise(w->trial, w->bands);
}

static double gain_with_quantization(identification_work *w)
{
    *w->trial = *w->fit;
    w->trial->active[IMK_NOISE_QUANTIZATION] = true;
    w->trial->amount[IMK_NOISE_QUANTIZATION] =
        0.1 * w->fit->amount[IMK_NOISE_WHITE] * w->bands->dt * w->bands->dt;
    return imki_fit_maximise(w->trial, w->bands) - w->fit->log_likelihood;
}

static double gain_with_ramp(identification_work *w)
{
    *w->trial = *w->fit;
    w->trial->ramp_active = true;
    return imki_fit_maximise(w->trial, w->bands) - w->fit->log_likelihood;
}

/* Frequency and quality of the wide resonances again, now that the rest of the spectrum is known: a
 * filter's slope across a wide resonance shifts it. */
static void refine_resonances(identification_work *w, imk_identification *result)
{
    for (int r = 0; r < result->resonance_count; r++)
        if (result->resonance[r].q <= NARROW)
            imki_resonance_refine(w->fit, w->bands, (size_t)r, &result->resonance[r]);
}

/* Output filter and quantization shape the same end of the spectrum: quantization is asked for with
 * the filter that fits best without it, and may then replace the filter. */
static void fit_fast_end(identification_work *w, imk_identification *result, double needed)
{
    imki_fit_maximise(w->fit, w->bands);
    if (gain_with_quantization(w) > needed) {
        *w->fit = *w->trial;
        w->fit->active[IMK_NOISE_QUANTIZATION] = true;
    }
    if (w->settings->shape) {
        result->filter = imki_filter_find(w->fit, w->bands);
        refine_resonances(w, result);
        if (result->resonance_count > 0 && result->filter.bandwidth > 0)
            result->filter = imki_filter_find(w->fit, w->bands);
    }
    if (result->filter.bandwidth > 0 && w->fit->active[IMK_NOISE_QUANTIZATION] &&
        gain_without(w, IMK_NOISE_QUANTIZATION) < needed)
        *w->fit = *w->trial;
}

/* Backward elimination of the random terms, each by its likelihood ratio; the threshold is that of
 * a parameter on its boundary, where the ratio is half a chi-square [SELF1987]. */
static void choose_terms(identification_work *w, double needed)
{
    for (;;) {
        int weakest = -1;
        double least = needed;
        for (int term = IMK_NOISE_QUANTIZATION; term <= IMK_NOISE_RANDOM_WALK; term++)
            if (w->fit->active[term]) {
                const double gain = gain_without(w, term);
                weakest = gain < least ? term : weakest;
                least = gain < least ? gain : least;
            }
        if (weakest < 0)
            break;
        gain_without(w, weakest);
        *w->fit = *w->trial;
    }
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
        if (w->fit->active[IMKI_FIRST_GAUSS_MARKOV + term])
            w->correlation_times[term] =
                imki_gauss_markov_refine(w->fit, w->bands, term, w->correlation_times[term], 1.5);
}

/* ---- intervals ------------------------------------------------------------------------------- */

/* Largest distance from the estimate, in one direction, at which the profile likelihood has fallen
 * by `drop`. Works on the amplitude (square root of the amount; the ramp as it is). */
static double profile_end(const imki_fit *best, imki_fit *trial, const imki_bands *bands, int held,
                          double start, double step, double drop)
{
    const bool ramp = held == IMKI_HELD_RAMP;
    double inside = start, outside = start;
    for (int i = 0; i < 60; i++) {
        outside = start + step;
        if (!ramp && outside <= 0)
            outside = 0;
        *trial = *best;
        const double l = imki_fit_profile(trial, bands, held, ramp ? outside : outside * outside);
        if (best->log_likelihood - l > drop)
            break;
        if (!ramp && outside == 0)
            return 0;
        inside = outside;
        step *= 2;
    }
    for (int i = 0; i < 24 && fabs(outside - inside) > 1e-4 * fabs(step); i++) {
        const double middle = 0.5 * (inside + outside);
        *trial = *best;
        const double l = imki_fit_profile(trial, bands, held, ramp ? middle : middle * middle);
        *(best->log_likelihood - l > drop ? &outside : &inside) = middle;
    }
    return 0.5 * (inside + outside);
}

/* Covariance of the active amounts: inverse of the scaled information. */
static void amount_covariance(const imki_fit *fit, const imki_bands *bands, double *covariance)
{
    const size_t t = fit->templates;
    double h[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX], scale[IMKI_TEMPLATES_MAX];
    imki_fit_information(fit, bands, h);
    for (size_t i = 0; i < t; i++)
        scale[i] = fit->active[i] && h[i * t + i] > 0 ? 1 / sqrt(h[i * t + i]) : 0;
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            h[i * t + j] = i == j ? 1 + 1e-12 : h[i * t + j] * scale[i] * scale[j];
    memset(covariance, 0, t * t * sizeof *covariance);
    if (imk_cholesky_factor(t, h) != IMK_OK)
        return;
    imk_cholesky_inverse(t, h, covariance);
    for (size_t i = 0; i < t; i++)
        for (size_t j = 0; j < t; j++)
            covariance[i * t + j] *= scale[i] * scale[j];
}

/* Values, sigmas and correlations of the chosen terms. */
static void store_values(const identification_work *w, imk_identification *result)
{
    const imki_fit *fit = w->fit;
    const size_t t = fit->templates;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    amount_covariance(fit, w->bands, covariance);
    for (size_t i = 0; i < IMKI_FIRST_GAUSS_MARKOV; i++) {
        imk_estimate *e = &result->term[i];
        e->present = fit->active[i] && fit->amount[i] > 0;
        e->value = e->present ? sqrt(fit->amount[i]) : 0;
        e->sigma = e->present ? sqrt(covariance[i * t + i]) / (2 * e->value) : 0;
        for (size_t j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++) {
            const double product = covariance[i * t + i] * covariance[j * t + j];
            result->correlation[i][j] =
                product > 0 ? covariance[i * t + j] / sqrt(product) : i == j;
        }
    }
    imk_estimate *ramp = &result->term[IMK_NOISE_RAMP];
    ramp->present = fit->ramp_active;
    ramp->value = fit->ramp_active ? fit->ramp : 0;
    ramp->sigma = 1 / sqrt(imki_fit_ramp_information(fit, w->bands));
    result->correlation[IMK_NOISE_RAMP][IMK_NOISE_RAMP] = 1;
    for (int r = 0; r < result->resonance_count; r++)
        if (fit->active[IMKI_FIRST_RESONANCE + r])
            result->resonance[r].sigma = sqrt(fit->amount[IMKI_FIRST_RESONANCE + r]);
    result->log_likelihood = fit->log_likelihood;
}

/* Intervals are those of the model in which white noise, bias instability, random walk and the term
 * itself are all free, whether they were called present or not: leaving a term out would claim to
 * know that it is zero. */
static void store_interval(identification_work *w, imk_identification *result, int term,
                           double drop)
{
    static const bool always[IMK_NOISE_TERMS] = {false, true, true, true, false};
    imki_fit *best = w->trial, *scratch = w->fit;
    imk_estimate *e = &result->term[term];
    *w->chosen = *w->fit;
    *best = *w->chosen;
    for (int j = 0; j < IMKI_FIRST_GAUSS_MARKOV; j++)
        if ((always[j] || j == term) && !best->active[j]) {
            best->active[j] = true;
            best->amount[j] = 1e-6 * w->bands->power[0] / best->shape[j][0];
        }
    best->ramp_active = best->ramp_active || term == IMK_NOISE_RAMP;
    imki_fit_maximise(best, w->bands);

    const int held = term == IMK_NOISE_RAMP ? IMKI_HELD_RAMP : term;
    double centre, step;
    if (held == IMKI_HELD_RAMP) {
        centre = best->ramp;
        step = 1 / sqrt(imki_fit_ramp_information(best, w->bands));
    } else {
        double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
        amount_covariance(best, w->bands, covariance);
        const double sd = sqrt(covariance[(size_t)term * best->templates + (size_t)term]);
        centre = sqrt(best->amount[term]);
        step = sqrt(best->amount[term] + sd) - centre;
    }
    e->upper = profile_end(best, scratch, w->bands, held, centre, step, drop);
    e->lower = centre == 0 && held != IMKI_HELD_RAMP
                   ? 0
                   : profile_end(best, scratch, w->bands, held, centre, -step, drop);
    if (!e->present && term == IMK_NOISE_RAMP) {
        e->upper = fmax(fabs(e->lower), fabs(e->upper));
        e->lower = 0;
    } else if (!e->present) {
        e->lower = 0;
    }
    *w->fit = *w->chosen;
}

/* End of the interval of a correlation time, in one direction: the factor at which the likelihood,
 * all amounts refitted, has fallen by `drop`; at most a hundred. */
static double time_end(identification_work *w, size_t term, double time, double direction,
                       double drop)
{
    const double needed = w->chosen->log_likelihood - drop;
    double inside = 0, outside = 0.1;
    for (;; inside = outside, outside *= 2) {
        *w->trial = *w->chosen;
        if (imki_gauss_markov_set(w->trial, w->bands, term, time * exp(direction * outside)) <
            needed)
            break;
        if (outside > 4.6)
            return time * exp(direction * outside);
    }
    for (int i = 0; i < 16; i++) {
        const double middle = 0.5 * (inside + outside);
        *w->trial = *w->chosen;
        const double l =
            imki_gauss_markov_set(w->trial, w->bands, term, time * exp(direction * middle));
        *(l < needed ? &outside : &inside) = middle;
    }
    return time * exp(direction * 0.5 * (inside + outside));
}

static void store_gauss_markov(identification_work *w, imk_identification *result, size_t term,
                               double drop)
{
    const size_t slot = IMKI_FIRST_GAUSS_MARKOV + term, t = w->fit->templates;
    if (!w->fit->active[slot] || !(w->fit->amount[slot] > 0))
        return;
    double covariance[IMKI_TEMPLATES_MAX * IMKI_TEMPLATES_MAX];
    amount_covariance(w->fit, w->bands, covariance);
    struct imk_gauss_markov_estimate *g = &result->gauss_markov[result->gauss_markov_count++];
    const double sigma = sqrt(w->fit->amount[slot]), sd = sqrt(covariance[slot * t + slot]);
    *w->chosen = *w->fit;
    g->sigma = (imk_estimate){true, sigma, sd / (2 * sigma), 0, 0};
    const double step = sqrt(w->fit->amount[slot] + sd) - sigma;
    g->sigma.lower = profile_end(w->chosen, w->fit, w->bands, (int)slot, sigma, -step, drop);
    g->sigma.upper = profile_end(w->chosen, w->fit, w->bands, (int)slot, sigma, step, drop);

    const double time = w->correlation_times[term];
    g->correlation_time = (imk_estimate){.present = true, .value = time};
    g->correlation_time.lower = time_end(w, term, time, -1, drop);
    g->correlation_time.upper = time_end(w, term, time, 1, drop);
    g->correlation_time.sigma =
        (g->correlation_time.upper - g->correlation_time.lower) / (2 * sqrt(2 * drop));
    *w->fit = *w->chosen;
}

/* ---- verdict --------------------------------------------------------------------------------- */

/* The longest range of tau over which the measured deviation agrees with a model: within 5 %, or
 * with the model inside its 99.9 % interval. Infinite `from` when there is none. */
static void agreement(const imk_identification *result, double dt, size_t count,
                      const imk_allan_point *points, double *from, double *to)
{
    size_t first = 0, length = 0, run = 0;
    for (size_t i = 0; i < count; i++) {
        const double expected =
            sqrt(imk_identification_allan_variance(result, dt, points[i].m, -1));
        const bool close = fabs(points[i].deviation / expected - 1) < 0.05 ||
                           (expected >= points[i].lower && expected <= points[i].upper);
        run = close ? run + 1 : 0;
        if (run > length) {
            length = run;
            first = i + 1 - run;
        }
    }
    *from = length > 0 ? (double)points[first].m * dt : HUGE_VAL;
    *to = length > 0 ? (double)points[first + length - 1].m * dt : 0;
}

static void compare_with_allan(identification_work *w, const double *record,
                               imk_identification *result)
{
    const double dt = w->settings->dt;
    size_t factors[FACTORS_MAX], count = imk_allan_factors(IMK_ALLAN_DECADE, w->n, NULL);
    imk_allan_point points[FACTORS_MAX];
    if (count > FACTORS_MAX)
        return;
    imk_allan_factors(IMK_ALLAN_DECADE, w->n, factors);
    while (count > 1 && factors[count - 1] > w->n / 9)
        count--;
    imk_allan_settings settings = imk_allan_default();
    settings.confidence = 0.999;
    imk_allan_sums(w->n, record, w->cumulative);
    imk_allan_points(&settings, w->n, w->cumulative, count, factors, points, NULL);

    double least = points[0].deviation;
    for (size_t i = 0; i < count; i++)
        least = fmin(least, points[i].deviation);
    result->minimum_floor = least / sqrt(imk_flicker_allan_variance(1, 1));
    result->longest = (double)factors[count - 1] * dt;
    agreement(result, dt, count, points, &result->valid_from, &result->valid_to);

    imk_identification five = *result;
    five.gauss_markov_count = five.sinusoid_count = five.resonance_count = 0;
    five.filter = (imk_low_pass){0, 0};
    double five_terms_to;
    agreement(&five, dt, count, points, &result->five_terms_from, &five_terms_to);
}

static void judge(identification_work *w, const double *record, imk_identification *result)
{
    compare_with_allan(w, record, result);
    if (result->sinusoid_count > 0)
        result->verdict |= IMK_VERDICT_LINES;
    if (result->resonance_count > 0)
        result->verdict |= IMK_VERDICT_RESONANCE;
    if (result->filter.bandwidth > 0)
        result->verdict |= IMK_VERDICT_FILTERED;
    if (result->valid_from > 1.5 * w->settings->dt || result->valid_to < 0.99 * result->longest)
        result->verdict |= IMK_VERDICT_MISFIT;
    const imk_estimate *b = &result->term[IMK_NOISE_BIAS_INSTABILITY];
    if (!b->present || b->upper > 3 * b->lower)
        result->verdict |= IMK_VERDICT_SHORT;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static imk_status check_arguments(const imk_identify_settings *settings, size_t n,
                                  const double *samples, size_t workspace_size, imk_error *error)
{
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_identify_default()");
    if (!(settings->dt > 0) || !(settings->confidence > 0 && settings->confidence < 1) ||
        !(settings->significance > 0 && settings->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, confidence in (0, 1), significance in (0, 0.5)");
    if (n < SAMPLES_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, NULL, NULL,
                             "record at least 256 samples; hours of them tell the slow terms");
    if (workspace_size < imk_identify_workspace_size(n))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_identify_workspace_size() bytes");
    bool constant = true;
    for (size_t i = 0; i < n; i++) {
        if (!(fabs(samples[i]) < HUGE_VAL)) {
            imk_error_set(error, IMK_ERROR_NOT_FINITE, NULL, NULL, "remove or bridge such samples");
            if (error)
                error->index = i < INT32_MAX ? (int)i : -1;
            return IMK_ERROR_NOT_FINITE;
        }
        constant = constant && samples[i] == samples[0];
    }
    if (constant) {
        imk_error_set(error, IMK_ERROR_CONSTANT, NULL, NULL,
                      "a working sensor never repeats itself for a whole record");
        if (error)
            error->value = samples[0];
        return IMK_ERROR_CONSTANT;
    }
    return IMK_OK;
}

static void remove_mean(identification_work *w, const double *samples, imk_identification *result)
{
    double shifted = 0, squares = 0;
    for (size_t i = 0; i < w->n; i++)
        shifted += samples[i] - samples[0];
    result->mean = samples[0] + shifted / (double)w->n;
    for (size_t i = 0; i < w->n; i++) {
        w->samples[i] = samples[i] - result->mean;
        squares += w->samples[i] * w->samples[i];
    }
    result->deviation = sqrt(squares / (double)(w->n - 1));
}

imk_status imk_identify_channel(const imk_identify_settings *settings, size_t n,
                                const double *samples, imk_identification *result, void *workspace,
                                size_t workspace_size, imk_error *error)
{
    imk_status status = check_arguments(settings, n, samples, workspace_size, error);
    if (status != IMK_OK)
        return status;
    identification_work work = {.settings = settings, .n = n}, *w = &work;
    lay_out(w, workspace);
    imk_identification found = {0};
    remove_mean(w, samples, &found);
    found.resolution = imki_record_resolution(n, samples, w->coefficients, n < SORTED ? n : SORTED);
    found.verdict = imki_record_verdict(n, samples, found.resolution, found.deviation);

    transform(w);
    if (settings->shape)
        find_lines(w, &found);
    imki_bands_build(w->bands, n, settings->dt, w->coefficients, w->cumulative, w->line_count,
                     w->lines, (size_t)found.resonance_count, found.resonance);
    set_templates(w, &found);
    const double needed = 0.5 * imk_chi_square_quantile(1 - 2 * settings->significance, 1);
    fit_fast_end(w, &found, needed);
    imki_gauss_markov_find(w->fit, w->trial, w->bands, w->correlation_times);
    choose_terms(w, needed);
    if (gain_with_ramp(w) > 0.5 * imk_chi_square_quantile(1 - settings->significance, 1)) {
        *w->fit = *w->trial;
        choose_terms(w, needed);
    }
    store_values(w, &found);
    const double drop = 0.5 * imk_chi_square_quantile(settings->confidence, 1);
    for (int term = 0; term < IMK_NOISE_TERMS; term++)
        store_interval(w, &found, term, drop);
    for (size_t term = 0; term < IMKI_GAUSS_MARKOV_MAX; term++)
        store_gauss_markov(w, &found, term, drop);
    judge(w, samples, &found);
    *result = found;
    return IMK_OK;
}

double imk_identification_allan_variance(const imk_identification *result, double dt, size_t m,
                                         int term)
{
    const imk_estimate *t = result->term;
    const double part[IMK_NOISE_TERMS] = {
        imk_quantization_sampled_allan_variance(t[IMK_NOISE_QUANTIZATION].value, dt, m),
        result->filter.bandwidth > 0
            ? imk_filtered_white_sampled_allan_variance(t[IMK_NOISE_WHITE].value, result->filter,
                                                        dt, m)
            : imk_white_sampled_allan_variance(t[IMK_NOISE_WHITE].value, dt, m),
        imk_flicker_sampled_allan_variance(t[IMK_NOISE_BIAS_INSTABILITY].value, dt, m),
        imk_random_walk_sampled_allan_variance(t[IMK_NOISE_RANDOM_WALK].value, dt, m),
        imk_ramp_allan_variance(t[IMK_NOISE_RAMP].value, (double)m * dt)};
    if (term >= 0 && term < IMK_NOISE_TERMS)
        return part[term];
    double sum = 0;
    for (int i = 0; i < IMK_NOISE_TERMS; i++)
        sum += part[i];
    for (int i = 0; i < result->gauss_markov_count; i++) {
        const imk_gauss_markov g = {result->gauss_markov[i].sigma.value,
                                    result->gauss_markov[i].correlation_time.value};
        sum += imk_gauss_markov_sampled_allan_variance(g, dt, m);
    }
    for (int i = 0; i < result->sinusoid_count; i++)
        sum += imk_sinusoid_sampled_allan_variance(result->sinusoid[i], dt, m);
    for (int i = 0; i < result->resonance_count; i++)
        sum += imk_resonance_sampled_allan_variance(result->resonance[i], dt, m);
    return sum;
}
