/* SPDX-License-Identifier: Apache-2.0 */
/* Is the sensor at rest? By windows of a second: at rest their means stay, and none scatters much
 * more than the quiet ones.
 *
 * The limits are about what sensors do by themselves within a second, with room: the mean of a gyro
 * of 0.05 deg/s/sqrt(Hz) changes by 0.07 deg/s from one second to the next, that of an
 * accelerometer of 1 mg/sqrt(Hz) by 0.014 m/s^2. A hand, a vehicle on its way and a boat move more
 * than them. */
#include "info_log_internal.h"

#include "base/sort_internal.h"

#include <math.h>

static const double rate_change = 5e-3;    /* [rad/s], 0.3 deg/s */
static const double force_change = 0.1;    /* [m/s^2] */
static const double rate_scatter = 0.1;    /* [rad/s], above the noise of any sensor used at rest */
static const double force_scatter = 1.0;   /* [m/s^2] */
static const double rate_most = 0.35;      /* [rad/s], 20 deg/s: more than any zero offset */
static const double scatter_ratio = 5;     /* over that of the quiet windows */
static const double same_attitude = 0.866; /* cosine of 30 deg, beyond what a vehicle that speeds
                                              up and turns shows */

enum { WINDOWS_LEAST = 3, ATTITUDES_MAX = 64 };

static int triad(int axis)
{
    return axis / 3;
}

/* The scatter that a fifth of the windows are below. @param sorted  room for all windows */
static double quiet_scatter(const imki_info_rows *r, int axis, double *sorted)
{
    for (size_t k = 0; k < r->window_count; k++)
        sorted[k] = r->window[k].scatter[axis];
    imki_sort(sorted, r->window_count);
    return sorted[r->window_count / 5];
}

/* The change of a mean may be what a sensor does by itself and four times what white noise of the
 * scatter does. Of counts without a sensitivity the former is not known: some steps. */
static bool axis_rests(const imki_info_rows *r, size_t k, int axis, double quiet)
{
    const imki_info_window *w = &r->window[k];
    const int t = triad(axis);
    const double step = r->info->channel[r->axis[axis]].step;
    const double noise = 4 * quiet * sqrt(2 / (double)r->window_rows);
    const double change = noise + (r->counts[t] ? quiet + 2 * step
                                   : t == 0     ? rate_change
                                                : force_change);
    const double mean = t == 0 && !r->counts[t] ? fabs(w->mean[axis]) : 0;
    const double most = r->counts[t] ? HUGE_VAL : t == 0 ? rate_scatter : force_scatter;
    const bool stays =
        k == 0 || !w->follows || r->stride > 1 || fabs(w->mean[axis] - w[-1].mean[axis]) <= change;
    return stays && mean <= rate_most && w->scatter[axis] <= scatter_ratio * quiet + step &&
           w->scatter[axis] <= most;
}

/* The specific force as a direction; false: it is none of three axes in physical units, or not
 * about gravity, without which its direction is no attitude. */
static bool direction(const imki_info_rows *r, size_t k, double unit[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        if (r->axis[3 + a] < 0 || r->counts[1])
            return false;
        unit[a] = r->window[k].mean[3 + a];
        square += unit[a] * unit[a];
    }
    for (int a = 0; a < 3; a++)
        unit[a] /= sqrt(square);
    return square > 25 && square < 225; /* half and one and a half g */
}

/* Attitudes of windows at rest that follow one another. */
static size_t count_attitudes(const imki_info_rows *r, const double *rests)
{
    double known[ATTITUDES_MAX][3];
    size_t count = 0;
    for (size_t k = 1; k < r->window_count && count < ATTITUDES_MAX; k++) {
        double at[3];
        bool is_new = rests[k] > 0 && rests[k - 1] > 0 && direction(r, k, at);
        for (size_t i = 0; i < count && is_new; i++)
            is_new =
                at[0] * known[i][0] + at[1] * known[i][1] + at[2] * known[i][2] < same_attitude;
        for (int a = 0; a < 3 && is_new; a++)
            known[count][a] = at[a];
        count += is_new;
    }
    return count;
}

/* A stretch of rest whose attitude turns by more than a bias can is a slow motion. */
static void find_slow_turns(const imki_info_rows *r, double *rests)
{
    const double most = 0.985; /* cosine of 10 deg */
    for (size_t k = 0, end; k < r->window_count; k = end) {
        double first[3], last[3];
        bool turns = false;
        for (end = k + 1; end < r->window_count && rests[end] > 0 && rests[k] > 0; end++)
            turns = turns || (direction(r, k, first) && direction(r, end, last) &&
                              first[0] * last[0] + first[1] * last[1] + first[2] * last[2] < most);
        for (size_t i = k; i < end && turns; i++)
            rests[i] = 0;
    }
}

void imki_info_motion(imki_info_rows *r, double *rests, double *sorted)
{
    imk_info_log *info = r->info;
    double quiet[IMKI_INFO_AXES] = {0}, sum = 0;
    bool any = false;
    info->resting = (double)NAN;
    for (int a = 0; a < IMKI_INFO_AXES; a++)
        if (r->axis[a] >= 0 && r->window_count >= WINDOWS_LEAST) {
            quiet[a] = quiet_scatter(r, a, sorted);
            any = true;
        }
    if (!any)
        return;
    for (size_t k = 0; k < r->window_count; k++) {
        rests[k] = 1;
        for (int a = 0; a < IMKI_INFO_AXES; a++)
            if (r->axis[a] >= 0 && !axis_rests(r, k, a, quiet[a]))
                rests[k] = 0;
    }
    find_slow_turns(r, rests);
    for (size_t k = 0; k < r->window_count; k++)
        sum += rests[k];
    info->resting = sum / (double)r->window_count;
    info->attitudes = count_attitudes(r, rests);
    for (size_t k = 1; k < r->window_count; k++)
        info->holds += rests[k] > 0 && rests[k - 1] > 0 && (k == 1 || rests[k - 2] == 0);
    info->motion = info->attitudes >= 2 && info->resting >= 0.2    ? IMK_INFO_POSES
                   : info->resting >= 0.98 && info->attitudes <= 1 ? IMK_INFO_REST
                                                                   : IMK_INFO_MOVES;
}
