/* SPDX-License-Identifier: Apache-2.0 */
/* Rows as they come: extremes, means, scatter within windows, runs at the ends of the range. */
#include "info_log_internal.h"

#include "identify/records/screen_internal.h"

#include <math.h>

void imki_info_rows_begin(imki_info_rows *r)
{
    r->in_window = 0;
    r->follows = false;
    for (size_t c = 0; c < r->info->channel_count; c++) {
        r->sums[c].sum = r->sums[c].squares = 0;
        r->sums[c].low.run = r->sums[c].high.run = 0;
        r->sums[c].values = 0;
    }
}

/* Rows at an extreme, and whether three of them follow one another. */
static void end_at(imki_info_end *end, double value, double extreme)
{
    end->run = value == extreme ? end->run + 1 : 0;
    end->rows += value == extreme;
    end->sticks = end->sticks || end->run >= 3;
}

static void add_value(imk_info_channel *channel, imki_info_sums *s, double value)
{
    if (!isfinite(value)) {
        s->low.run = s->high.run = 0;
        return;
    }
    if (channel->finite == 0)
        channel->lowest = channel->highest = value;
    if (value < channel->lowest) {
        channel->lowest = value;
        s->low = (imki_info_end){0};
    }
    if (value > channel->highest) {
        channel->highest = value;
        s->high = (imki_info_end){0};
    }
    end_at(&s->low, value, channel->lowest);
    end_at(&s->high, value, channel->highest);
    const double off = value - channel->mean;
    s->least = s->values == 0 ? off : fmin(s->least, off);
    s->most = s->values == 0 ? off : fmax(s->most, off);
    channel->finite++;
    s->values++;
    s->total += value;
    s->sum += off;
    s->squares += off * off;
}

/* Mean and scatter of a window without the value that is farthest off: a single wrong sample moves
 * no sensor. The mean is about that of the column. */
static double scatter_without_one(const imki_info_sums *s, double *mean)
{
    const double all = s->sum / (double)s->values, n = (double)(s->values - 1);
    const double off = s->most - all > all - s->least ? s->most : s->least;
    *mean = (s->sum - off) / n;
    const double squares = s->squares - off * off - n * *mean * *mean;
    return squares > 0 ? sqrt(squares / (n - 1)) : 0;
}

/* Columns without most of their values give nothing to the window; without a sensor's axis it shows
 * no motion. */
static void end_window(imki_info_rows *r)
{
    imki_info_window w = {.follows = r->follows};
    bool whole = true;
    for (size_t c = 0; c < r->info->channel_count; c++) {
        imki_info_sums *s = &r->sums[c];
        const double n = (double)s->values;
        const bool holds = s->values >= IMKI_INFO_VALUES && 4 * s->values >= r->window_rows;
        const double mean = holds ? s->sum / n : 0, within = s->squares - n * mean * mean;
        for (int a = 0; a < IMKI_INFO_AXES; a++)
            if (r->axis[a] == (int)c) {
                whole = whole && holds;
                double calm = 0;
                w.scatter[a] = holds ? scatter_without_one(s, &calm) : 0;
                w.mean[a] = r->info->channel[c].mean + calm;
            }
        if (holds) {
            s->within += within > 0 ? within : 0;
            s->degrees += s->values - 1;
        }
        s->sum = s->squares = 0;
        s->values = 0;
    }
    r->in_window = 0;
    r->follows = whole;
    if (!whole || r->passed++ % r->stride != 0)
        return;
    if (r->window_count == IMKI_INFO_WINDOWS) { /* every second one makes room */
        for (size_t k = 0; 2 * k < r->window_count; k++)
            r->window[k] = r->window[2 * k];
        r->window_count /= 2;
        r->stride *= 2;
    }
    r->window[r->window_count++] = w;
}

void imki_info_rows_add(imki_info_rows *r, size_t rows, double *const *column)
{
    imk_info_log *info = r->info;
    for (size_t row = 0; row < rows; row++) {
        for (size_t c = 0; c < info->channel_count; c++) {
            const double value = column[c][row];
            imk_info_channel *channel = &info->channel[c];
            if (channel->finite == 0 && isfinite(value))
                channel->mean = value; /* for now: what sums are taken about */
            add_value(channel, &r->sums[c], value);
            if (r->sampled < IMKI_INFO_SAMPLE && r->sample[c])
                r->sample[c][r->sampled] = value;
        }
        r->sampled += r->sampled < IMKI_INFO_SAMPLE;
        if (++r->in_window == r->window_rows)
            end_window(r);
    }
    info->rows_read += rows;
}

/* Where neighbouring values are many between the extremes, three in a row at one are no chance. */
static bool is_fine(const imk_info_channel *channel)
{
    return channel->highest > channel->lowest &&
           (channel->step == 0 || channel->highest - channel->lowest >= 16 * channel->step);
}

void imki_info_rows_end(imki_info_rows *r, double *scratch)
{
    for (size_t c = 0; c < r->info->channel_count; c++) {
        imk_info_channel *channel = &r->info->channel[c];
        const imki_info_sums *s = &r->sums[c];
        channel->mean = channel->finite > 0 ? s->total / (double)channel->finite : (double)NAN;
        channel->scatter = s->degrees > 0 ? sqrt(s->within / (double)s->degrees) : (double)NAN;
        if (channel->finite == 0)
            channel->lowest = channel->highest = (double)NAN;
        if (r->sample[c] && !channel->column.label)
            channel->step =
                imki_record_resolution(r->sampled, r->sample[c], scratch, IMKI_INFO_SAMPLE);
        channel->clipped_low = is_fine(channel) && s->low.sticks ? s->low.rows : 0;
        channel->clipped_high = is_fine(channel) && s->high.sticks ? s->high.rows : 0;
    }
}
