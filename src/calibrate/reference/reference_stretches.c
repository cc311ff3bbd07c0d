/* SPDX-License-Identifier: Apache-2.0 */
/* Stretches of a record in which its reference is constant.
 *
 * The reference is looked at in windows of a fifth of the shortest stretch. A stretch grows while
 * the means of its windows, of every channel, stay within
 *
 *     steady + 8 sigma/sqrt(samples of a window)
 *
 * of each other. sigma is the noise of a sample, from the fourth differences of the channel
 *
 *     d[k] = r[k-2] - 4 r[k-1] + 6 r[k] - 4 r[k+1] + r[k+2],   standard deviation sqrt(70) sigma
 *
 * which let a motion of angular frequency w through with (w dt)^4 only: 1.6e-5 of a sine of 1 Hz at
 * 100 Hz. Eight sigmas hold the range of some thousand normal numbers. The rate of an encoder,
 * which is a difference of rounded angles, is quieter than that: its windows' errors are those of
 * two angles. */
#include "reference_internal.h"

#include "base/workspace_internal.h"

#include "imukit/samples.h"

#include <math.h>

enum {
    CHANNELS = 6,
    DIFFERENCES = 4096, /* of a channel, looked at for its noise: 2 % of sigma */
    WINDOWS = 5         /* in the shortest stretch */
};

/* Upper quartile of the absolute value of a standard normal number. */
static const double upper_quartile = 1.1503493803760079;

typedef struct scan {
    const imk_test_record *record;
    int channels;
    const double *channel[CHANNELS];
    double limit[CHANNELS]; /* what means of windows may differ by */
    size_t window;          /* samples */
} scan;

size_t imk_reference_stretches_workspace_size(const imk_test_record *record)
{
    (void)record;
    return IMKI_ALIGNMENT_SLACK + DIFFERENCES * sizeof(double);
}

static bool is_gap(const imk_test_record *record, size_t k)
{
    return record->time && k > 0 &&
           imk_step_is_gap(record->time[k] - record->time[k - 1], record->dt);
}

/* ---- noise of a channel ----------------------------------------------------------------------
 */

/* Value of rank `rank` among `count`: parts are exchanged about a pivot until it stands at its
 * place. */
static double select_rank(double *a, size_t count, size_t rank)
{
    const ptrdiff_t place = (ptrdiff_t)rank;
    ptrdiff_t low = 0, high = (ptrdiff_t)count - 1;
    while (low < high) {
        const double pivot = a[place];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (a[i] < pivot)
                i++;
            while (pivot < a[j])
                j--;
            if (i <= j) {
                const double swap = a[i];
                a[i++] = a[j];
                a[j--] = swap;
            }
        }
        if (j < place)
            low = i;
        if (place < i)
            high = j;
    }
    return a[place];
}

static double noise_of(const imk_test_record *record, const double *channel, double *scratch)
{
    if (record->count < 5)
        return 0.0;
    const size_t possible = record->count - 4;
    const size_t stride = possible > DIFFERENCES ? possible / DIFFERENCES + 1 : 1;
    size_t count = 0;
    for (size_t k = 0; k < possible; k += stride) {
        const double *r = channel + k;
        const double d = fabs(r[0] - 4.0 * r[1] + 6.0 * r[2] - 4.0 * r[3] + r[4]);
        if (d < HUGE_VAL)
            scratch[count++] = d;
    }
    if (count == 0)
        return 0.0;
    return select_rank(scratch, count, (3 * count) / 4) / (upper_quartile * sqrt(70.0));
}

/* ---- windows ---------------------------------------------------------------------------------
 */

/* Means of window w; false at a gap or where the reference is not a number. */
static bool window_means(const scan *s, size_t w, double mean[CHANNELS])
{
    const size_t begin = w * s->window;
    for (size_t k = begin + 1; k < begin + s->window; k++)
        if (is_gap(s->record, k))
            return false;
    for (int c = 0; c < s->channels; c++) {
        const double first = s->channel[c][begin];
        double sum = 0.0;
        for (size_t k = begin; k < begin + s->window; k++)
            sum += s->channel[c][k] - first;
        mean[c] = first + sum / (double)s->window;
        if (!(fabs(mean[c]) < HUGE_VAL))
            return false;
    }
    return true;
}

/* Widen the range by a window; false when it becomes too wide. */
static bool widen(const scan *s, const double mean[CHANNELS], double low[CHANNELS],
                  double high[CHANNELS])
{
    bool within = true;
    for (int c = 0; c < s->channels; c++) {
        low[c] = fmin(low[c], mean[c]);
        high[c] = fmax(high[c], mean[c]);
        within = within && high[c] - low[c] <= s->limit[c];
    }
    return within;
}

static void empty_range(double low[CHANNELS], double high[CHANNELS])
{
    for (int c = 0; c < CHANNELS; c++) {
        low[c] = HUGE_VAL;
        high[c] = -HUGE_VAL;
    }
}

/* The earliest window from which on everything up to window `last` lies within the limits, not
 * before `first`; the range of it. */
static size_t restart(const scan *s, size_t first, size_t last, double low[CHANNELS],
                      double high[CHANNELS])
{
    size_t start = last + 1;
    empty_range(low, high);
    while (start > first) {
        double mean[CHANNELS] = {0.0}, wider_low[CHANNELS], wider_high[CHANNELS];
        for (int c = 0; c < CHANNELS; c++) {
            wider_low[c] = low[c];
            wider_high[c] = high[c];
        }
        if ((start <= last && is_gap(s->record, start * s->window)) ||
            !window_means(s, start - 1, mean) || !widen(s, mean, wider_low, wider_high))
            break;
        for (int c = 0; c < CHANNELS; c++) {
            low[c] = wider_low[c];
            high[c] = wider_high[c];
        }
        start--;
    }
    return start;
}

/* ---- stretches -------------------------------------------------------------------------------
 */

static double mean_over(const double *channel, size_t begin, size_t end, double absent)
{
    if (!channel)
        return absent;
    double sum = 0.0;
    for (size_t k = begin; k < end; k++)
        sum += channel[k] - channel[begin];
    return channel[begin] + sum / (double)(end - begin);
}

static imk_reference_stretch stretch_of(const imk_test_record *record, size_t begin, size_t end)
{
    imk_reference_stretch stretch = {
        .begin = begin, .end = end, .reading = imk_static_summary(record, begin, end)};
    for (int c = 0; c < 3; c++) {
        stretch.rate[c] = mean_over(record->reference_rate[c], begin, end, (double)NAN);
        stretch.force[c] = mean_over(record->reference_force[c], begin, end, (double)NAN);
        stretch.angular_acceleration[c] =
            mean_over(record->reference_acceleration[c], begin, end, 0.0);
    }
    return stretch;
}

/* What is left out and what must be left, in samples. */
typedef struct lengths {
    size_t head, tail, least;
} lengths;

static lengths lengths_of(const imk_test_record *record, const imk_procedure_settings *settings)
{
    lengths l = {.head = imk_samples_in(settings->trim + settings->settle, record->dt),
                 .tail = imk_samples_in(settings->trim, record->dt),
                 .least = imk_samples_in(settings->minimum, record->dt)};
    l.least = l.least > 2 ? l.least : 2;
    return l;
}

static bool close_stretch(const scan *s, const lengths *l, size_t first, size_t past,
                          imk_reference_stretch *stretch, size_t capacity, size_t *count)
{
    const size_t begin = first * s->window, end = past * s->window;
    if (past <= first || end - begin < l->head + l->tail + l->least)
        return false;
    if (*count < capacity)
        stretch[*count] = stretch_of(s->record, begin + l->head, end - l->tail);
    ++*count;
    return true;
}

static size_t find(const scan *s, const lengths *l, imk_reference_stretch *stretch, size_t capacity)
{
    const size_t windows = s->record->count / s->window;
    const size_t needed = l->head + l->tail + l->least;
    double low[CHANNELS], high[CHANNELS];
    size_t count = 0, first = 0;
    empty_range(low, high);
    for (size_t w = 0; w < windows; w++) {
        double mean[CHANNELS] = {0.0};
        const bool gap = is_gap(s->record, w * s->window);
        const bool valid = window_means(s, w, mean);
        if (!gap && valid && widen(s, mean, low, high))
            continue;
        /* The window does not belong to what came before, which ends if it is long enough. */
        const bool closed = close_stretch(s, l, first, w, stretch, capacity, &count);
        const bool alone = closed || gap || !valid || (w - first) * s->window >= needed;
        first = restart(s, alone ? w : first, w, low, high);
    }
    close_stretch(s, l, first, windows, stretch, capacity, &count);
    return count;
}

imk_status imk_reference_stretches(const imk_test_record *record,
                                   const imk_procedure_settings *settings,
                                   imk_reference_stretch *stretch, size_t capacity, size_t *count,
                                   void *workspace, size_t workspace_size, imk_error *error)
{
    scan s = {.record = record};
    if (settings->cookie != IMKI_PROCEDURE_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_procedure_default()");
    if (!(record->dt > 0.0 && record->dt < HUGE_VAL))
        return imk_error_set(error, IMK_ERROR_RANGE, "dt", NULL, "a positive sample interval");
    if (workspace_size < imk_reference_stretches_workspace_size(record))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "workspace", NULL,
                             "imk_reference_stretches_workspace_size() bytes");
    const double part = settings->minimum / WINDOWS / record->dt;
    const size_t most = record->count > 1 ? record->count : 1;
    s.window = !(part > 1.0) ? 1 : part < (double)most ? (size_t)part : most;
    for (int c = 0; c < CHANNELS; c++) {
        const double *channel = c < 3 ? record->reference_rate[c] : record->reference_force[c - 3];
        if (!channel)
            continue;
        const double noise = noise_of(record, channel, imki_align(workspace));
        s.limit[s.channels] = (c < 3 ? settings->steady_rate : settings->steady_force) +
                              8.0 * noise / sqrt((double)s.window);
        s.channel[s.channels++] = channel;
    }
    if (s.channels == 0)
        return imk_error_set(
            error, IMK_ERROR_KEY_MISSING, "reference", NULL,
            "give the reference: reference columns in the log, or the programme of the motion");
    if (record->means) {
        for (size_t row = 0; row < record->count && row < capacity; row++)
            stretch[row] = stretch_of(record, row, row + 1);
        *count = record->count;
        return IMK_OK;
    }
    const lengths l = lengths_of(record, settings);
    *count = find(&s, &l, stretch, capacity);
    return IMK_OK;
}
