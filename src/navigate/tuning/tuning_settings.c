/* SPDX-License-Identifier: Apache-2.0 */
/* Defaults and checks of the tuning of a filter, and its grids of windows and times. */
#include "tuning_internal.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>

enum { COOKIE = 0x494D4B66 };

imk_filter_tuning_settings imk_filter_tuning_default(void)
{
    return (imk_filter_tuning_settings){.cookie = COOKIE,
                                        .rate = 200.0,
                                        .from = 0.01,
                                        .to = 10.0,
                                        .per_decade = 4,
                                        .window_count = 64,
                                        .bias_time = 1.0,
                                        .bias_sigma = {-1.0, -1.0},
                                        .eigen_limit = 1.05};
}

/* ---- grids ---- */

/* Rows of a motion: row k ends at k samples from its start. */
static size_t rows_of(const imk_filter_tuning_settings *s, size_t motion)
{
    enum { MOST = 1 << 30 };
    const imk_motion *m = &s->motion[motion];
    double length = s->duration[motion];
    if (m->recorded) {
        const double all = (double)(m->recorded->count - 1) / s->rate;
        length = length > 0.0 && length < all ? length : all;
    } else if (!(length > 0.0)) {
        double first, last;
        imk_trajectory_span(m->trajectory, &first, &last);
        if (isinf(last)) /* a rest at the end says no more */
            last = m->trajectory->piece[m->trajectory->piece_count - 1].start;
        length = last - first;
    }
    const double rows = floor(length * s->rate * (1.0 + 1e-12) + 1e-6);
    return rows < MOST ? (size_t)rows : MOST;
}

/* Rows in which the slowest output filter forgets how it was started. */
static size_t rows_to_settle(const imk_model *model, double rate)
{
    enum { MOST = 1 << 20 };
    double longest = 0.0;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(model, sensor);
        for (int i = 0; i < 3; i++) {
            const double f = triad->bandwidth.value[i], damping = triad->damping.value[i];
            const double slow = damping > 1.0 ? 2.0 * damping : damping > 0.0 ? 1.0 / damping : 1.0;
            if (f > 0.0) /* e^-18 */
                longest = fmax(longest, 3.0 * slow / f);
        }
    }
    const double rows = ceil(longest * rate);
    return rows < MOST ? (size_t)rows : MOST;
}

void imki_tuning_grid_of(const imk_model *model, const imk_filter_tuning_settings *s,
                         imki_tuning_grid *grid)
{
    *grid = (imki_tuning_grid){.bias_samples = (size_t)floor(s->bias_time * s->rate + 0.5)};
    if (grid->bias_samples == 0)
        grid->bias_samples = 1;
    const size_t settle = rows_to_settle(model, s->rate);
    grid->settle = settle;
    grid->lead = settle > grid->bias_samples ? settle : grid->bias_samples;
    if (s->learned)
        grid->lead = settle + grid->bias_samples;
    size_t least = SIZE_MAX;
    for (size_t m = 0; m < s->motion_count; m++) {
        grid->rows[m] = rows_of(s, m);
        least = grid->rows[m] < least ? grid->rows[m] : least;
    }
    const size_t most = least > grid->lead + 1 ? least - grid->lead - 1 : 0;
    const double ten = imk_ln(10.0);
    const double step = 1.0 / (double)s->per_decade, decades = imk_ln(s->to / s->from) / ten;
    size_t before = 0;
    for (size_t i = 0; (double)i * step <= decades + 1e-9 && i < IMK_TUNING_TIMES_MAX; i++) {
        const double time = s->from * imk_exp((double)i * step * ten);
        const size_t n = (size_t)floor(time * s->rate + 0.5);
        if (n < 2)
            grid->short_count++;
        else if (n > most)
            grid->long_count++;
        else if (n != before)
            grid->samples[grid->time_count++] = before = n;
    }
}

size_t imki_tuning_window(const imk_filter_tuning_settings *settings, const imki_tuning_grid *grid,
                          size_t motion, size_t window)
{
    const size_t longest = grid->samples[grid->time_count - 1];
    const size_t span = grid->rows[motion] - 1 - longest - grid->lead;
    const size_t count = settings->window_count;
    if (count == 1)
        return grid->lead + span / 2;
    return grid->lead + (size_t)((double)span * ((double)window / (double)(count - 1)));
}

/* ---- checks ---- */

static imk_status refuse(imk_error *error, const char *field, double value, const char *expected)
{
    const imk_status status = isfinite(value) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse(error, status, field, value, 0.0, expected);
}

static imk_status check_numbers(const imk_filter_tuning_settings *s, imk_error *error)
{
    if (!(s->rate >= 0.1 && s->rate <= 1e5))
        return refuse(error, "rate", s->rate, "a sample rate between 0.1 Hz and 100 kHz");
    if (!(s->from >= 1e-6 && s->from <= s->to))
        return refuse(error, "from", s->from, "a time of 1e-6 s or more, not after `to`");
    if (!(s->to <= 1000.0))
        return refuse(error, "to", s->to, "a time of at most 1000 s");
    if (s->per_decade < 1 || s->per_decade > 12)
        return refuse(error, "per_decade", (double)s->per_decade, "1 to 12 times in a decade");
    if (s->window_count < 1 || s->window_count > 256 ||
        s->window_count * s->motion_count > IMK_TUNING_WINDOWS_MAX)
        return refuse(error, "window_count", (double)s->window_count,
                      "1 to 256 windows of a motion, at most 1024 of all");
    if (!(s->bias_time >= 0.0 && s->bias_time <= 1e4))
        return refuse(error, "bias_time", s->bias_time, "0 s to 1e4 s");
    if (s->correlation_time != 0.0 && !(s->correlation_time >= 1.0 && s->correlation_time <= 1e9))
        return refuse(error, "correlation_time", s->correlation_time, "0, or 1 s to 1e9 s");
    for (int i = 0; i < 2; i++)
        if (!(s->bias_sigma[i] <= 1e6) || isinf(s->bias_sigma[i]))
            return refuse(error, "bias_sigma", s->bias_sigma[i], "a standard deviation");
    if (!(s->eigen_limit > 0.0 && s->eigen_limit <= 1e6))
        return refuse(error, "eigen_limit", s->eigen_limit, "a ratio of variances above 0");
    return IMK_OK;
}

static imk_status check_motions(const imk_model *model, const imk_filter_tuning_settings *s,
                                imk_error *error)
{
    if (s->motion_count == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, "motion", "", "at least one motion");
    if (s->motion_count > IMK_TUNING_MOTIONS_MAX)
        return refuse(error, "motion_count", (double)s->motion_count, "at most 8 motions");
    const imk_timing *timing = &model->timing;
    for (size_t m = 0; m < s->motion_count; m++) {
        const imk_recorded_motion *recorded = s->motion[m].recorded;
        if (!recorded == !s->motion[m].trajectory)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "motion", "",
                                 "either a trajectory or a recorded motion");
        if (!recorded) {
            const imk_status status = imk_trajectory_validate(s->motion[m].trajectory, error);
            if (status != IMK_OK)
                return status;
        } else if (recorded->count == 0)
            return imk_error_set(error, IMK_ERROR_EMPTY, "motion", "", "at least one sample");
        else if (!(fabs(recorded->rate - s->rate) <= 1e-6 * s->rate))
            return imk_error_set(error, IMK_ERROR_CONFLICT, "rate", "",
                                 "the sample rate of the recorded motion");
        else if (timing->rate_error.value != 0.0 || timing->jitter.value != 0.0 ||
                 timing->skew.value != 0.0)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "timing", "",
                                 "a model without clock errors: a recorded motion is known at its "
                                 "samples only");
    }
    return IMK_OK;
}

imk_status imk_filter_tuning_validate(const imk_model *model, const imk_filter_tuning_settings *s,
                                      imk_error *error)
{
    const double second = 1.0;
    imk_drift_settings at_rest = imk_drift_default();
    at_rest.time_count = 1;
    at_rest.time = &second;
    imk_status status = imk_drift_validate(model, &at_rest, error);
    if (status == IMK_OK && s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_filter_tuning_default()");
    if (status == IMK_OK)
        status = check_numbers(s, error);
    if (status == IMK_OK)
        status = check_motions(model, s, error);
    if (status != IMK_OK)
        return status;
    imki_tuning_grid grid;
    imki_tuning_grid_of(model, s, &grid);
    if (grid.time_count > 0)
        return IMK_OK;
    return imk_error_set(error, IMK_ERROR_TOO_SHORT, "motion", "",
                         grid.long_count > 0
                             ? "motions longer than the time over which the bias is known, and two "
                               "samples"
                             : "times of two samples at least: a higher rate, or a longer `to`");
}
