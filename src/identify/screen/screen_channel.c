/* SPDX-License-Identifier: Apache-2.0 */
/* Screening of a record in memory: it passes by the same screener as a long one. */
#include "imukit/elementary.h"
#include "screener_internal.h"

#include <math.h>
#include <string.h>

size_t imk_screen_workspace_size(size_t n)
{
    (void)n;
    return imk_screener_size();
}

static imk_status begin(const imk_screen_settings *settings, unsigned what, imk_screen_sink sink,
                        void *context, imk_screener **screener, void *workspace,
                        size_t workspace_size, imk_error *error)
{
    if (workspace_size < imk_screener_size())
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_screen_workspace_size() bytes");
    return imk_screener_begin(settings, what, sink, context, screener, workspace, workspace_size,
                              error);
}

imk_status imk_screen_channel(const imk_screen_settings *settings, size_t n, const double *samples,
                              imk_screen *found, void *workspace, size_t workspace_size,
                              imk_error *error)
{
    imk_screener *s;
    imk_status status = begin(settings, 0, NULL, NULL, &s, workspace, workspace_size, error);
    if (status != IMK_OK)
        return status;
    imk_screener_add(s, n, samples, settings->temperature);
    return imk_screener_finish(s, found, error);
}

/* Samples at or beyond the values where they pile up become NaN. */
static size_t remove_saturated(size_t n, const imk_screen *found, double *samples)
{
    size_t lost = 0;
    for (size_t i = 0; i < n; i++) {
        const bool beyond =
            samples[i] >= found->saturation_high || samples[i] <= found->saturation_low;
        if (!beyond || !imki_is_there(samples[i]))
            continue;
        samples[i] = (double)NAN;
        lost++;
    }
    return lost;
}

/* Where the samples that come back from the screener go. */
typedef struct replacement {
    double *samples;
    size_t done, lost;
    bool tails; /* outliers stay */
} replacement;

static void replace(void *context, size_t count, const double *loose, const double *clean)
{
    replacement *r = context;
    const double *kept = r->tails ? loose : clean;
    for (size_t i = 0; i < count; i++) {
        double *sample = &r->samples[r->done + i];
        if (!imki_is_there(*sample) || imki_is_there(kept[i]))
            continue;
        *sample = (double)NAN;
        r->lost++;
    }
    r->done += count;
}

/* The mean's parts that are known: warm-up by recursion, renewed often enough that its rounding
 * stays below 1e-13. */
static size_t subtract(const imk_screen_settings *settings, const imk_screen *found, unsigned what,
                       size_t n, double *samples)
{
    enum { RENEWED = 256 };
    const bool warm = (what & IMK_SCREEN_WARM_UP) && found->warm_up;
    const bool thermal = (what & IMK_SCREEN_TEMPERATURE) && found->temperature_degree > 0;
    const double step = warm ? settings->dt / found->warm_up_time : 0, ratio = imk_exp(-step);
    double exponential = 0;
    size_t lost = 0;
    for (size_t i = 0; (warm || thermal) && i < n; i++) {
        exponential = i % RENEWED == 0 ? imk_exp(-step * (double)i) : exponential * ratio;
        const bool there = imki_is_there(samples[i]);
        if (warm)
            samples[i] -= found->warm_up_amplitude * exponential;
        if (thermal) {
            const double t = settings->temperature[i] - found->temperature_reference;
            samples[i] -= (found->temperature_slope + found->temperature_curvature * t) * t;
            lost += there && !imki_is_there(samples[i]);
        }
    }
    return lost;
}

imk_status imk_screen_apply(const imk_screen_settings *settings, const imk_screen *found,
                            unsigned what, size_t n, double *samples, size_t *lost, void *workspace,
                            size_t workspace_size, imk_error *error)
{
    imk_screener *s;
    replacement r = {.samples = samples, .tails = found->heavy_tails};
    imk_status status = begin(settings, what, replace, &r, &s, workspace, workspace_size, error);
    if (status != IMK_OK)
        return status;
    if (what & (IMK_SCREEN_OUTLIERS | IMK_SCREEN_STUCK)) {
        imk_screener_add(s, n, samples, NULL);
        imki_screen_flush(s);
    }
    *lost = r.lost + ((what & IMK_SCREEN_SATURATED) ? remove_saturated(n, found, samples) : 0);
    *lost += subtract(settings, found, what, n, samples);
    return IMK_OK;
}
