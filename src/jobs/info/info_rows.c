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
        r->sums[c].run_low = r->sums[c].run_high = 0;
        r->sums[c].values = 0;
    }
}

/* Rows of a run at an extreme count from the third one on, and then with those before it. */
static void run_at(double value, double extreme, size_t *run, size_t *count)
{
    *run = value == extreme ? *run + 1 : 0;
    if (*run >= 3)
        *count += *run == 3 ? 3 : 1;
}

static void add_value(imk_info_channel *channel, imki_info_sums *s, double value)
{
    if (!isfinite(value)) {
        s->run_low = s->run_high = 0;
        return;
    }
    if (channel->finite == 0)
        channel->lowest = channel->highest = value;
    if (value < channel->lowest) {
        channel->lowest = value;
        s->at_low = s->run_low = 0;
    }
    if (value > channel->highest) {
        channel->highest = value;
        s->at_high = s->run_high = 0;
    }
    run_at(value, channel->lowest, &s->run_low, &s->at_low);
    run_at(value, channel->highest, &s->run_high, &s->at_high);
    channel->finite++;
    s->values++;
    s->total += value;
    s->sum += value - channel->mean;
    s->squares += (value - channel->mean) * (value - channel->mean);
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
                w.mean[a] = r->info->channel[c].mean + mean;
                w.scatter[a] = holds && within > 0 ? sqrt(within / (n - 1)) : 0;
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
        channel->clipped_low = is_fine(channel) ? s->at_low : 0;
        channel->clipped_high = is_fine(channel) ? s->at_high : 0;
    }
}
