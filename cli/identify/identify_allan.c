/* SPDX-License-Identifier: Apache-2.0 */
/* The terms of a log from its Allan deviations, by generalised least squares with their full
 * covariance (imukit/allan_fit.h), beside the lines, resonances and the filter that the spectrum
 * showed. It loses a little against the likelihood of the spectrum, and shows what the plot holds.
 */
#include "identify_parts.h"

#include "imukit/allan_fit.h"

#include <math.h>
#include <stdlib.h>

/* What the spectrum found stays. */
static imk_allan_fit_settings settings_of(const identification *i, const imk_identification *r)
{
    imk_allan_fit_settings settings = imk_allan_fit_default();
    settings.confidence = i->options->confidence;
    settings.significance = i->options->significance;
    settings.tolerance = i->options->tolerance;
    settings.gauss_markov_max = (int)i->options->gauss_markov.value;
    settings.filter = r->filter;
    settings.sinusoid_count = r->sinusoid_count;
    for (int k = 0; k < r->sinusoid_count; k++)
        settings.sinusoid[k] = r->sinusoid[k];
    settings.resonance_count = r->resonance_count;
    for (int k = 0; k < r->resonance_count; k++)
        settings.resonance[k] = r->resonance[k];
    return settings;
}

static void store(imk_identification *r, const imk_allan_fit *fit, double from)
{
    for (int term = 0; term < IMK_NOISE_TERMS; term++) {
        r->term[term] = fit->term[term];
        for (int other = 0; other < IMK_NOISE_TERMS; other++)
            r->correlation[term][other] = fit->correlation[term][other];
    }
    r->gauss_markov_count = fit->gauss_markov_count;
    for (int k = 0; k < fit->gauss_markov_count; k++) {
        r->gauss_markov[k].sigma = fit->gauss_markov[k].sigma;
        r->gauss_markov[k].correlation_time = fit->gauss_markov[k].correlation_time;
    }
    r->valid_from = fmax(r->valid_from, from);
}

static int fit_channel(identification *i, size_t channel)
{
    imk_identification *r = &i->result[channel];
    const allan_curve *curve = &i->curve[channel];
    const char *name = log_channel_column(&i->channels, channel)->name;
    size_t factor[IMK_ALLAN_FIT_FACTORS_MAX], count = 0;
    double variance[IMK_ALLAN_FIT_FACTORS_MAX];
    for (size_t k = 0; k < curve->count && count < IMK_ALLAN_FIT_FACTORS_MAX; k++) {
        factor[count] = curve->point[k].m;
        variance[count++] = curve->point[k].deviation * curve->point[k].deviation;
    }
    const imk_allan_table table = {.dt = i->channels.dt,
                                   .count = count,
                                   .factors = factor,
                                   .variances = variance,
                                   .record_count = 1,
                                   .lengths = &i->channels.rows};
    const imk_allan_fit_settings settings = settings_of(i, r);
    const size_t size = imk_allan_fit_workspace_size(&settings, count, 0);
    void *workspace = malloc(size);
    imk_allan_fit *fit = malloc(sizeof *fit);
    imk_status status = IMK_ERROR_MEMORY;
    if (workspace && fit)
        status = imk_allan_fit_table(&settings, &table, fit, workspace, size, NULL);
    if (status == IMK_OK) {
        store(r, fit, curve->tau[fit->first]);
        identify_add_sentence(i, VERDICT_NOTE, "allan_fit",
                              "%s: Allan deviations fitted from %.3g s to %.3g s, chi-square %.1f "
                              "for %d degrees of freedom (%.2g by chance).",
                              name, curve->tau[fit->first], curve->tau[count - 1], fit->chi_square,
                              fit->degrees, fit->probability);
    }
    free(workspace);
    free(fit);
    return status == IMK_OK
               ? -1
               : command_failed("%s: column %s: %s", i->path, name, imk_status_text(status));
}

int identify_by_allan(identification *i)
{
    int code = -1;
    for (size_t c = 0; c < i->channels.count && code < 0; c++) {
        if (i->result[c].missing > 0)
            return command_failed("%s: column %s has %zu samples missing, or taken out: --method "
                                  "allan needs all of them; the likelihood, which is the default, "
                                  "does not (or use --gaps bridge)",
                                  i->path, log_channel_column(&i->channels, c)->name,
                                  i->result[c].missing);
        code = fit_channel(i, c);
    }
    return code;
}
