/* SPDX-License-Identifier: Apache-2.0 */
/* The times of an analysis by what is asked: how long a navigation is, and what its table shows. */
#include "imukit/drift_models.h"

#include "base/refuse_internal.h"

#include <math.h>

static const double day = 86400, longest = 1e8; /* [s]; imk_drift_validate() */

/* What is asked, and with what. */
typedef struct asking {
    const imk_drift_when *when;
    const imk_drift_settings *settings;
    const imk_drift_wanted *want; /* NULL: none */
    double length;                /* of the motion */
    double outage;                /* from which the times count; 0: the start */
    double duration;
    size_t count;
    double at[IMK_DRIFT_ROWS_MAX];
} asking;

/* The last row that is not past the end, whatever the rounding of its time. */
static double last_row(double length, double rate)
{
    return floor(length * rate + 1e-6) / rate;
}

static imk_status choose_duration(asking *a, imk_error *error)
{
    const double rate = a->settings->rate, stated = a->when->duration;
    a->duration = stated != 0        ? stated
                  : a->want          ? a->want->time
                  : isinf(a->length) ? day
                                     : last_row(a->length, rate);
    if (!(a->duration > 0 && a->duration <= longest))
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", a->duration, longest,
                           "a time above 0 s, at most three years");
    if (a->duration * rate < 1)
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", a->duration, 1 / rate,
                           "at least one sample");
    if (a->want && a->want->time > a->duration * (1 + 1e-12))
        return imki_refuse(error, IMK_ERROR_RANGE, "want.time", a->want->time, a->duration,
                           "a time within the duration");
    return IMK_OK;
}

static imk_status take_times(asking *a, const char *field, size_t count, const double *time,
                             imk_error *error)
{
    if (count == 0)
        return imk_error_set(error, IMK_ERROR_EMPTY, field, "no time is stated", NULL);
    if (count > IMK_DRIFT_ROWS_MAX - 2)
        return imki_refuse(error, IMK_ERROR_RANGE, field, (double)count, IMK_DRIFT_ROWS_MAX - 2,
                           "fewer times");
    for (size_t i = 0; i < count; i++) {
        if (!(time[i] > 0 && time[i] <= longest))
            return imki_refuse(error, IMK_ERROR_RANGE, field, time[i], longest,
                               "times above 0 s, at most three years");
        a->at[a->count++] = a->outage + time[i];
    }
    return IMK_OK;
}

/* The end of the aids, and times behind it. */
static imk_status outage_times(asking *a, imk_error *error)
{
    static const double usual[] = {10, 60, 300};
    const imk_drift_when *w = a->when;
    a->outage = imk_drift_outage(a->settings);
    const imk_status status =
        w->outage ? take_times(a, "outage", w->outage_count, w->outage, error) : IMK_OK;
    for (size_t i = 0; i < sizeof usual / sizeof usual[0] && !w->outage; i++)
        if (a->outage + usual[i] <= a->length)
            a->at[a->count++] = a->outage + usual[i];
    a->at[a->count++] = a->outage;
    return status;
}

static imk_status choose(asking *a, imk_error *error)
{
    const imk_drift_when *w = a->when;
    const bool ends = !isnan(imk_drift_outage(a->settings));
    if ((w->duration != 0) + (w->time != NULL) + (w->outage != NULL) > 1)
        return imk_error_set(error, IMK_ERROR_CONFLICT, NULL,
                             "duration, times and outage exclude each other", NULL);
    if (w->outage && !ends)
        return imk_error_set(error, IMK_ERROR_EMPTY, "outage", "no aid has an end",
                             "add \"until 600 s\" to an aid");
    if (w->time)
        return take_times(a, "times", w->time_count, w->time, error);
    return ends && w->duration == 0 ? outage_times(a, error) : choose_duration(a, error);
}

imk_status imk_drift_times_ask(const imk_drift_when *when, const imk_drift_settings *settings,
                               const imk_drift_wanted *want, const imk_allocator *allocator,
                               imk_drift_times *times, imk_error *error)
{
    if (!when || !settings || !times)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "when", NULL, NULL);
    asking a = {.when = when,
                .settings = settings,
                .want = want && want->asked ? want : NULL,
                .length = when->motion > 0 ? when->motion : HUGE_VAL};
    if (!(settings->rate > 0 && isfinite(settings->rate)))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, 0, "a rate above 0 Hz");
    imk_status status = choose(&a, error);
    if (status == IMK_OK)
        status =
            imk_drift_times_choose(a.duration, a.count, a.at, a.want ? a.want->time : 0,
                                   settings->rate, when->curves, a.outage, allocator, times, error);
    if (status != IMK_OK)
        return status;
    const double last = times->time[times->count - 1];
    if (!(last > a.length + 1.5 / settings->rate))
        return IMK_OK;
    imk_drift_times_free(times);
    return imki_refuse(error, IMK_ERROR_RANGE, "motion", last, a.length,
                       "times within the motion, or one that goes on (`then: hold`)");
}
