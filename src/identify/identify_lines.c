/* SPDX-License-Identifier: Apache-2.0 */
/* The channel's spectrum, and what its lines are. */
#include "identify_internal.h"
#include "imukit/fourier.h"

#include <math.h>
#include <string.h>

void imki_identify_transform(imki_work *w)
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

/* Subtract the tones: a tone's skirts may make a line of sixteen coefficients of it, no more. */
static void remove_tones(imki_work *w, size_t count, const imki_line *lines,
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
void imki_identify_lines(imki_work *w, imk_identification *result)
{
    const double dt = w->settings->dt, step_hz = 1 / (2 * (double)w->n * dt);
    imki_line lines[IMKI_LINES_MAX];
    size_t count = imki_lines_find(w->n, w->cumulative, lines);
    remove_tones(w, count, lines, result);
    if (result->sinusoid_count > 0) {
        imki_identify_transform(w);
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
        const bool narrow = !resonant || r.q > IMKI_NARROW;
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
