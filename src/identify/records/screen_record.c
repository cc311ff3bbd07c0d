/* SPDX-License-Identifier: Apache-2.0 */
/* Screening of one channel, in the order in which one fault would hide another: missing samples,
 * saturation, runs of one value, outliers, steps; then the trends of what is left. */
#include "base/workspace_internal.h"
#include "imukit/elementary.h"
#include "screen_internal.h"

#include <math.h>

enum { COOKIE = 0x5C4EE401, SCRATCH = 8192, SAMPLED = 4096, PRESENT_MIN = 64 };

imk_screen_settings imk_screen_default(void)
{
    return (imk_screen_settings){.cookie = COOKIE, .false_alarm = 1e-3, .significance = 1e-3};
}

size_t imk_screen_workspace_size(size_t n)
{
    return 64 + (n + SCRATCH) * sizeof(double);
}

static imk_status check(const imk_screen_settings *s, size_t workspace_size, size_t n,
                        imk_error *error)
{
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_screen_default()");
    if (!(s->dt > 0 && s->dt < HUGE_VAL) || !(s->false_alarm > 0 && s->false_alarm < 0.5) ||
        !(s->significance > 0 && s->significance < 0.5))
        return imk_error_set(error, IMK_ERROR_RANGE, "settings", NULL,
                             "dt > 0, false_alarm and significance in (0, 0.5)");
    if (workspace_size < imk_screen_workspace_size(n))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_screen_workspace_size() bytes");
    return IMK_OK;
}

/* Of those that are there, 0 when they are all the same. Scaled to below 1, so that squares neither
 * overflow nor vanish. */
static double deviation_of(size_t n, const double *samples, size_t present)
{
    double shift = (double)NAN, size = 0, sum = 0, squares = 0;
    int exponent;
    for (size_t i = 0; i < n; i++) {
        shift = isnan(shift) ? samples[i] : shift;
        size = fmax(size, fabs(samples[i])); /* the number, when one of them is none */
    }
    frexp(size, &exponent);
    const double scale = ldexp(1, exponent < -1000 ? 1000 : -exponent);
    for (size_t i = 0; i < n; i++) {
        const double distance = isnan(samples[i]) ? 0 : samples[i] * scale - shift * scale;
        sum += distance;
        squares += distance * distance;
    }
    const double count = (double)present, variance = (squares - sum * sum / count) / count;
    return variance > 0 ? sqrt(variance) / scale : 0;
}

/* Copy what is there, and count what is not. */
static void take_samples(size_t n, const double *samples, double *copy, imk_screen *found)
{
    size_t hole = 0;
    found->missing.first = n;
    for (size_t i = 0; i < n; i++) {
        const bool there = imki_is_there(samples[i]);
        copy[i] = there ? samples[i] : (double)NAN;
        if (there) {
            found->present++;
            hole = 0;
            continue;
        }
        found->missing.first = found->missing.count++ == 0 ? i : found->missing.first;
        found->missing.runs += hole++ == 0;
        found->longest_hole = hole > found->longest_hole ? hole : found->longest_hole;
    }
    found->deviation = deviation_of(n, copy, found->present);
}

/* Samples at or beyond the values where they pile up become NaN. */
static imk_screen_count mark_saturated(size_t n, const imk_screen *found, double *samples)
{
    imk_screen_count count = {0, 0, n};
    size_t last = n;
    for (size_t i = 0; i < n; i++) {
        const bool beyond =
            samples[i] >= found->saturation_high || samples[i] <= found->saturation_low;
        if (!beyond || !imki_is_there(samples[i]))
            continue;
        count.first = count.count++ == 0 ? i : count.first;
        count.runs += last == n || i != last + 1;
        last = i;
        samples[i] = (double)NAN;
    }
    return count;
}

static void find_saturation(size_t n, double *samples, imk_screen *found)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        low = samples[i] < low ? samples[i] : low;
        high = samples[i] > high ? samples[i] : high;
    }
    const double step = found->resolution > 0 ? found->resolution * 1.01 : 0.1 * found->deviation;
    found->saturation_low = imki_record_sticks(n, samples, low, 1, step) ? low : -HUGE_VAL;
    found->saturation_high = imki_record_sticks(n, samples, high, -1, step) ? high : HUGE_VAL;
    found->saturated = mark_saturated(n, found, samples);
}

imk_status imk_screen_channel(const imk_screen_settings *settings, size_t n, const double *samples,
                              imk_screen *found, void *workspace, size_t workspace_size,
                              imk_error *error)
{
    const imk_status status = check(settings, workspace_size, n, error);
    if (status != IMK_OK)
        return status;
    double *scratch = imki_align(workspace), *copy = scratch + SCRATCH;
    imk_screen f = {.n = n};
    take_samples(n, samples, copy, &f);
    if (f.present < PRESENT_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, NULL, NULL,
                             "at least 64 samples that are not missing");
    if (f.deviation == 0)
        return imk_error_set(error, IMK_ERROR_CONSTANT, NULL, NULL,
                             "a channel that changes: check its wiring and driver");
    f.resolution = imki_record_resolution(n, copy, scratch, SCRATCH);
    f.stuck_limit = imki_stuck_limit(n, copy, settings->false_alarm, &f.repeated);
    find_saturation(n, copy, &f);
    f.stuck = imki_stuck_find(n, copy, f.stuck_limit, copy, &f.longest_stuck);
    const imki_outlier_rule rule =
        imki_outlier_rule_find(n, copy, settings->false_alarm, f.resolution, SAMPLED, scratch);
    f.outlier_threshold = rule.threshold;
    f.noise = rule.noise;
    f.outliers = imki_outliers_find(n, copy, &rule, copy, &f.largest_outlier);
    imki_steps_find(n, copy, settings->significance, &f, scratch);
    imki_trend_find(settings, n, copy, &f);
    *found = f;
    return IMK_OK;
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

size_t imk_screen_apply(const imk_screen_settings *settings, const imk_screen *found, unsigned what,
                        size_t n, double *samples)
{
    size_t lost = 0;
    if (what & IMK_SCREEN_SATURATED)
        lost += mark_saturated(n, found, samples).count;
    size_t longest;
    if (what & IMK_SCREEN_STUCK)
        lost += imki_stuck_find(n, samples, found->stuck_limit, samples, &longest).count;
    if (what & IMK_SCREEN_OUTLIERS) {
        const imki_outlier_rule rule = {found->outlier_threshold, found->noise};
        double largest;
        lost += imki_outliers_find(n, samples, &rule, samples, &largest).count;
    }
    return lost + subtract(settings, found, what, n, samples);
}
