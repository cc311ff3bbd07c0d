/* SPDX-License-Identifier: Apache-2.0 */
/* Does the rate of the settings agree with the times of the log? A wrong one would scale all
 * results, so it is refused where the times leave no doubt: a stretch of rows whose steps are even.
 * Coarse, bunched and late stamps have none; what they say of the rate is left to the jobs. */
#include "log_reader_internal.h"

#include <math.h>
#include <stdio.h>

enum { STEPS = 256, STEPS_LEAST = 8 };

static const double even = 0.2, differs = 0.01;

static imk_status refuse(double rate, double own, imk_error *error)
{
    char found[96];
    snprintf(found, sizeof found,
             "--rate %.6gHz does not agree with the time column, by which the rate is %.6g Hz",
             rate, own);
    return imk_error_set(error, IMK_ERROR_CONFLICT, "", found,
                         "leave --rate out; if the times are wrong, leave their column out, with "
                         "--map or with - in its place in --columns");
}

static bool is_even(const imki_log_pace *p)
{
    const double mean = (p->last - p->first) / (double)p->steps;
    return p->least > (1 - even) * mean && p->most < (1 + even) * mean;
}

imk_status imki_log_pace_check(imk_log_reader *reader, size_t rows, const double *time, bool ended,
                               imk_error *error)
{
    imki_log_pace *p = &reader->pace;
    if (reader->settings.rate == 0 || p->done)
        return IMK_OK;
    for (size_t i = 0; i < rows && p->steps < STEPS; i++) {
        const double step = time[i] - p->last;
        const bool begins = !p->begun || !(step > 0) || !isfinite(step);
        if (begins)
            *p = (imki_log_pace){.begun = isfinite(time[i]), .first = time[i]};
        else {
            p->least = p->steps == 0 || step < p->least ? step : p->least;
            p->most = step > p->most ? step : p->most;
            p->steps++;
        }
        p->last = time[i];
        if (p->steps > 0 && !is_even(p)) /* begin anew behind a gap */
            *p = (imki_log_pace){.begun = true, .first = time[i], .last = time[i]};
    }
    if (p->steps < (ended ? STEPS_LEAST : STEPS))
        return IMK_OK;
    p->done = true;
    const double own = (double)p->steps / (p->last - p->first);
    return fabs(own / reader->settings.rate - 1) > differs
               ? refuse(reader->settings.rate, own, error)
               : IMK_OK;
}
