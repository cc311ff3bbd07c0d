/* SPDX-License-Identifier: Apache-2.0 */
/* Windows of four blocks assessed by the limits (static_noise.c), and runs of those that stand. */
#include "static_internal.h"

#include <math.h>

static const double BIAS_TIME = 10.0; /* the rate at rest is that of the last so many seconds [s] */
/* Gyros feel force, and a unit put on another face must not seem to turn for it. Data sheets of
 * MEMS gyros state 0.1 deg/s/g as typical, 1.8e-4 rad/s/(m/s^2); an axis of the less good ones has
 * more [rad/s/(m/s^2)]. */
static const double G_SENSITIVITY = 3e-4;
static const double TWO_G = 19.6133; /* of force: how much it changes at most [m/s^2] */

/* ---- assessing windows
 * ----------------------------------------------------------------------------
 */

/* Scatter and halves of every window over their limits, the worst axis. */
static void assess_windows(imki_static_job *job)
{
    const imki_static_blocks *b = &job->blocks;
    const size_t windows = imki_static_windows(b);
    for (size_t w = 0; w < windows; w++)
        job->activity[w] = 0.0;
    for (int a = 0; a < job->axis_count; a++) {
        const imki_static_limit *limit = &job->limit[a];
        if (limit->scatter_squared == 0.0)
            continue;
        const double per_variance = 1.0 / limit->scatter_squared;
        const double per_half = 1.0 / (limit->half * limit->half);
        for (size_t w = 0; w < windows; w++) {
            const imki_window_moments m = imki_static_window(b, a, w);
            const double scatter = m.variance * per_variance;
            const double half = m.half * m.half * per_half;
            const double worst = scatter > half ? scatter : half;
            job->activity[w] = worst > job->activity[w] ? worst : job->activity[w];
        }
    }
    for (size_t w = 0; w < windows; w++)
        job->activity[w] = imki_static_window_valid(b, w) ? sqrt(job->activity[w]) : (double)NAN;
}

/* Do accelerometers tell how the force changes, in SI? Three of them do. */
static bool tells_force(const imki_static_job *job)
{
    int axes = 0;
    for (int a = 0; a < job->axis_count; a++)
        axes += job->axis[a].sensor == IMK_ACCEL && job->axis[a].unit != 0.0;
    return axes >= 3;
}

/* By how much the force differs from that at rest [m/s^2]. */
static double force_change(const imki_static_job *job, const double *mean, const double *rest)
{
    double square = 0.0;
    for (int a = 0; a < job->axis_count; a++)
        if (job->axis[a].sensor == IMK_ACCEL) {
            const double change = (mean[a] - rest[a]) * job->axis[a].unit;
            square += change * change;
        }
    return sqrt(square);
}

/* A rate less that at rest over its limit, which is wider by what the change of the force may make
 * of it. */
static double rate_off(const imki_static_job *job, int a, double off, double change)
{
    const double unit = fabs(job->axis[a].unit);
    const double felt = unit > 0.0 ? G_SENSITIVITY * change / unit : 0.0;
    return fabs(off) / (job->limit[a].mean_off + felt);
}

/* Rates less those at rest, from the rest to one end of the log; the rest follows in standing
 * windows, and so does its force. */
static void assess_rates(imki_static_job *job, size_t first, size_t count, bool forward)
{
    double rest[IMKI_STATIC_AXES];
    for (int a = 0; a < job->axis_count; a++)
        rest[a] = job->limit[a].mean;
    const double step = (double)job->blocks.length * job->record->dt / BIAS_TIME;
    const double gain = step < 0.5 ? step : 0.5;
    const bool force_known = tells_force(job);
    for (size_t i = 0; i < count; i++) {
        const size_t w = forward ? first + i : first - i;
        if (!(job->activity[w] <= 1.0))
            continue;
        double mean[IMKI_STATIC_AXES], worst = job->activity[w];
        for (int a = 0; a < job->axis_count; a++)
            mean[a] = imki_static_window(&job->blocks, a, w).mean;
        const double change = force_known ? force_change(job, mean, rest) : TWO_G;
        for (int a = 0; a < job->axis_count; a++)
            if (isfinite(job->limit[a].mean_off))
                worst = fmax(worst, rate_off(job, a, mean[a] - rest[a], change));
        job->activity[w] = worst;
        for (int a = 0; worst <= 1.0 && a < job->axis_count; a++)
            rest[a] += gain * (mean[a] - rest[a]);
    }
}

void imki_static_assess(imki_static_job *job)
{
    assess_windows(job);
    const size_t windows = imki_static_windows(&job->blocks);
    const size_t middle = job->rest_begin;
    assess_rates(job, middle, windows - middle, true);
    if (middle > 0)
        assess_rates(job, middle - 1, middle, false);
}

/* ---- runs ----------------------------------------------------------------------------------
 */

static size_t skip(const imki_static_job *job, size_t w, bool standing)
{
    const size_t windows = imki_static_windows(&job->blocks);
    while (w < windows && (job->activity[w] <= 1.0) == standing)
        w++;
    return w;
}

/* Is a run that ends before window `stop` the same hold as the one that begins with window `next`?
 * Only when every block between them belongs to a window that stands, those that do not miss it by
 * little, and the means before and after agree. */
static bool is_same_hold(const imki_static_job *job, imki_static_run r, size_t stop, size_t next)
{
    const imki_static_blocks *b = &job->blocks;
    if (next >= imki_static_windows(b) || next >= stop - 1 + IMKI_WINDOW_BLOCKS ||
        next < r.begin + IMKI_WINDOW_BLOCKS)
        return false;
    for (size_t w = stop; w < next; w++)
        if (!(job->activity[w] <= 1.5))
            return false;
    /* Windows side by side differ by half the variance of the halves of one of them. */
    for (int a = 0; a < job->axis_count; a++) {
        const double limit = job->limit[a].half;
        const double step = imki_static_window(b, a, next).mean -
                            imki_static_window(b, a, next - IMKI_WINDOW_BLOCKS).mean;
        if (limit > 0.0 && !(2.0 * step * step <= limit * limit))
            return false;
    }
    return true;
}

/* Next run of standing windows from window *w on. */
bool imki_static_next_run(const imki_static_job *job, size_t *w, imki_static_run *r)
{
    const size_t windows = imki_static_windows(&job->blocks);
    r->begin = skip(job, *w, false);
    if (r->begin >= windows)
        return false;
    size_t stop = skip(job, r->begin, true);
    for (;;) {
        const size_t next = skip(job, stop, false);
        if (!is_same_hold(job, *r, stop, next))
            break;
        stop = skip(job, next, true);
    }
    *w = stop;
    r->end = stop - 1 + IMKI_WINDOW_BLOCKS;
    return true;
}
