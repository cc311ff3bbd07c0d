/* SPDX-License-Identifier: Apache-2.0 */
/* The intervals that increments are divided by: steps of the time, but behind lost rows. An
 * increment is what the device summed up from one sample to the next, whether that was recorded or
 * not. Rows are lost where a step is longer than those before, which were even, by half of them;
 * one that comes some times in a row is that of a new rate. */
#include "log_reader_internal.h"

#include <math.h>

void imki_log_intervals(imk_log_reader *reader, size_t rows, const double *time)
{
    enum { EVEN = 8, NEW_RATE = 5 };
    imki_log_steps *s = &reader->steps;
    for (size_t i = 0; i < rows; i++) {
        const double step = time[i] - reader->last_time;
        const bool is_step = step > 0.0 && isfinite(step);
        const bool even = step > 0.6 * s->usual && step < 1.5 * s->usual;
        reader->last_time = time[i];
        reader->interval[i] = is_step ? step : s->usual > 0 ? s->usual : (double)NAN;
        if (!is_step)
            continue;
        s->alike = fabs(step - s->last) < 0.1 * step ? s->alike + 1 : 1;
        s->last = step;
        if (step >= 1.5 * s->usual && s->even == EVEN && s->alike < NEW_RATE) {
            reader->interval[i] = s->usual;
            continue;
        }
        s->even = s->alike >= NEW_RATE ? EVEN : !even ? 0 : s->even < EVEN ? s->even + 1 : EVEN;
        s->usual = even ? s->usual + (step - s->usual) / EVEN : step;
    }
}
