/* SPDX-License-Identifier: Apache-2.0 */
/* The channel's spectrum, and what its lines are. */
#include "identify/records/missing_internal.h"
#include "identify_internal.h"
#include "imukit/elementary.h"
#include "imukit/fourier.h"

#include <math.h>
#include <string.h>

void imki_identify_transform(imki_work *w)
{
    memcpy(w->coefficients, w->samples, w->n * sizeof(double));
    (void)imk_cosine(w->n, w->coefficients, w->transform, w->transform_size); /* sized for it */
    if (w->missing)
        imki_missing_restore(w->missing, w->n, w->coefficients);
    w->cumulative[0] = w->cumulative[1] = 0;
    for (size_t k = 1; k < w->n; k++)
        w->cumulative[k + 1] =
            w->cumulative[k] + w->coefficients[k] * w->coefficients[k] * w->settings->dt;
}

static double centre_of(const imki_line *line)
{
    return 0.5 * (double)(line->first + line->last);
}

static double variance_of(const imki_work *w, const imki_line *line)
{
    return imki_line_variance(line, w->n, w->settings->dt, w->cumulative);
}

static size_t peak_of(const imki_work *w, const imki_line *line)
{
    size_t peak = line->first;
    for (size_t k = line->first; k <= line->last; k++)
        peak = fabs(w->coefficients[k]) > fabs(w->coefficients[peak]) ? k : peak;
    return peak;
}

static double power_between(const imki_work *w, size_t from, size_t to)
{
    double power = 0;
    for (size_t k = from; k <= to && k < w->n; k++)
        power += w->coefficients[k] * w->coefficients[k];
    return power;
}

/* Variance that a tone must explain: that of the line, but of its skirts no more than eight
 * coefficients, which hold 0.97 of a tone. Farther out there may be another one, or its skirts. */
static double variance_near(const imki_work *w, const imki_line *line, size_t peak)
{
    const size_t reach = 8;
    const size_t first = line->first + reach < peak ? line->first : peak - reach;
    const size_t last = line->last > peak + reach ? line->last : peak + reach;
    return fmin(variance_of(w, line), power_between(w, first, last) / (double)w->n);
}

/* Is a line a tone? The skirts of a strong one make a wide line of it, but five coefficients hold
 * nine tenths of its power, many times that of those on either side. */
static bool is_tone(const imki_work *w, const imki_line *line)
{
    const size_t peak = peak_of(w, line);
    const double share = 0.6, skirt = 0.2;
    if (line->last - line->first < 16)
        return true; /* the fit will tell */
    const double power = power_between(w, peak - 2, peak + 2);
    return power > share * variance_near(w, line, peak) * (double)w->n &&
           power_between(w, peak - 8, peak - 3) < skirt * power &&
           power_between(w, peak + 3, peak + 8) < skirt * power;
}

/* Is it beside a tone that was subtracted? Then it is what that one leaves because its frequency or
 * its amplitude wanders, and no further tone. */
static bool is_beside(size_t n, double cycles, size_t count, const imki_sinusoid *tones)
{
    const double apart = 3 / (double)n;
    for (size_t i = 0; i < count; i++)
        if (fabs(cycles - tones[i].cycles) < apart)
            return true;
    return false;
}

/* Subtract the tones among the lines; returns how many there are then. */
static size_t subtract_tones(imki_work *w, size_t line_count, const imki_line *lines, size_t count,
                             imki_sinusoid *tones)
{
    for (size_t i = 0; i < line_count && count < IMKI_LINES_MAX; i++) {
        const size_t peak = peak_of(w, &lines[i]);
        const double cycles = (double)peak / (2 * (double)w->n);
        if (is_tone(w, &lines[i]) && !is_beside(w->n, cycles, count, tones) &&
            imki_sinusoid_remove(w->n, cycles, variance_near(w, &lines[i], peak), w->samples,
                                 &tones[count]))
            count++;
    }
    return count;
}

/* The strongest tones into the result, the strongest first. */
static void store_tones(const imki_work *w, size_t count, const imki_sinusoid *tones,
                        imk_identification *result)
{
    bool stored[IMKI_LINES_MAX] = {false};
    while (result->sinusoid_count < IMK_TERMS_MAX && (size_t)result->sinusoid_count < count) {
        size_t next = count;
        for (size_t i = 0; i < count; i++)
            if (!stored[i] && (next == count || imki_sinusoid_amplitude(&tones[i]) >
                                                    imki_sinusoid_amplitude(&tones[next])))
                next = i;
        stored[next] = true;
        result->sinusoid[result->sinusoid_count++] = (imk_sinusoid){
            imki_sinusoid_amplitude(&tones[next]), tones[next].cycles / w->settings->dt};
    }
}

/* Finds lines, and subtracts the tones among them until what they leave holds no more. The skirts
 * of a strong tone hide others and spoil the estimates of those that are seen, so all are estimated
 * again together each time. Returns how many lines are left. */
static size_t take_tones(imki_work *w, imki_line *lines, imk_identification *result)
{
    enum { ROUNDS = 8 };
    imki_sinusoid tones[IMKI_LINES_MAX] = {{0, 0, 0}};
    size_t count = 0, lines_left = imki_lines_find(w->n, w->cumulative, 1, lines);
    for (int round = 0; round < ROUNDS; round++) {
        const size_t before = count;
        count = subtract_tones(w, lines_left, lines, count, tones);
        if (count == before)
            break;
        imki_sinusoids_refine(w->n, w->samples, count, tones);
        imki_identify_transform(w);
        lines_left = imki_lines_find(w->n, w->cumulative, 1, lines);
    }
    w->crowded = count == IMKI_LINES_MAX && lines_left > 0;
    store_tones(w, count, tones, result);
    return lines_left;
}

bool imki_line_describe(const imki_line *line, size_t n, double dt, const double *cumulative,
                        double frequency, double narrowest, imk_identification *result)
{
    const double variance = imki_line_variance(line, n, dt, cumulative);
    const double centre = centre_of(line), width = (double)(line->last - line->first + 1);
    imk_resonance r = {0, frequency, fmax(1, centre / width)};
    /* A frequency far below the sample rate is none that imk_resonance_arma() takes. */
    const bool possible =
        width > 2 && r.frequency * dt > 1e-5 && result->resonance_count < IMK_TERMS_MAX;
    bool resonant = possible && imki_shape_resonance(&r, variance, n, dt, cumulative) &&
                    r.frequency > narrowest * r.q;
    /* What is wide takes part in the fit whatever its shape: further resonances complete it. */
    if (possible && !resonant && width > 16 && centre < IMKI_NARROW * width) {
        r = (imk_resonance){sqrt(variance), frequency, fmax(1, centre / width)};
        resonant = r.frequency > narrowest * r.q;
    }
    const bool narrow = !resonant || (r.q > IMKI_NARROW && !imki_line_is_strong(line));
    if (resonant) {
        r.sigma = narrow ? sqrt(variance) : r.sigma;
        result->resonance[result->resonance_count++] = r;
    } else if (result->sinusoid_count < IMK_TERMS_MAX) {
        result->sinusoid[result->sinusoid_count++] = (imk_sinusoid){sqrt(2 * variance), frequency};
    }
    return narrow;
}

/* What a line is: a tone is subtracted as a sinusoid; what is shaped like a resonance is one; a
 * line that is neither, such as a tone whose frequency wanders, stands in the model as a sinusoid
 * of its power. Only wide resonances take part in the fit, and those whose skirts reach far: other
 * narrow lines are left out of it, and their power is what is found above their surroundings,
 * whatever their exact shape. */
void imki_identify_lines(imki_work *w, imk_identification *result)
{
    const double dt = w->settings->dt, step_hz = 1 / (2 * (double)w->n * dt);
    imki_line lines[IMKI_LINES_MAX];
    const size_t count = take_tones(w, lines, result);
    for (size_t i = 0; i < count; i++)
        if (imki_line_describe(&lines[i], w->n, dt, w->cumulative, centre_of(&lines[i]) * step_hz,
                               0, result))
            w->lines[w->line_count++] = imki_line_widen(&lines[i], w->n);
}

/* Allan deviation at one sample: half the mean square of differences of neighbours. */
static double first_allan_deviation(const imki_bands *bands)
{
    double sum = 0, degrees = 0;
    for (size_t b = 0; b < bands->count; b++) {
        const double s = imk_sin(3.141592653589793 * bands->frequency[b] * bands->dt);
        sum += bands->degrees[b] * bands->power[b] * 2 * s * s;
        degrees += bands->degrees[b];
    }
    return sqrt(sum / (degrees * bands->dt));
}

/* White noise of rounding to steps, where it is white. */
static void set_rounding(imki_bands *bands, double step)
{
    const bool white = step > 0 && step < IMKI_STEP_FILTERED * first_allan_deviation(bands);
    bands->rounding = white ? step * step / 12 * bands->dt : 0;
}

/* Lines beside each other all over the spectrum, as of faults at a regular distance, would leave
 * nothing between them: then they are no lines. */
enum { BANDS_LEAST = 8 };

static void build_bands(imki_work *w, const imk_identification *result)
{
    const double dt = w->settings->dt;
    const size_t resonances = (size_t)result->resonance_count;
    if (w->spectrum_count == 0) {
        imki_bands_build(w->bands, w->n, dt, w->coefficients, w->cumulative, w->line_count,
                         w->lines, resonances, result->resonance);
        if (w->bands->count < BANDS_LEAST && w->line_count > 0) {
            w->line_count = 0;
            imki_bands_build(w->bands, w->n, dt, w->coefficients, w->cumulative, 0, w->lines,
                             resonances, result->resonance);
        }
        if (w->missing)
            imki_missing_weigh(w->missing, w->bands);
        return;
    }
    w->bands->n = w->n;
    w->bands->dt = dt;
    w->bands->count = w->bands->singles = 0;
    for (size_t i = 0; i < w->spectrum_count; i++)
        imki_bands_add(w->bands, &w->spectra[i], resonances, result->resonance);
}

void imki_identify_bands(imki_work *w, const imk_identification *result)
{
    if (!w->bands_given)
        build_bands(w, result);
    set_rounding(w->bands, result->resolution * w->scale);
}
