/* SPDX-License-Identifier: Apache-2.0 */
/* A value that stays when the noise says it should move.
 *
 * Where a share r of samples repeats the one before by chance (coarse steps, repeated samples), a
 * run of more than L repeats occurs in n samples with probability about n (1 - r) r^L: L is put
 * where that is the false-alarm rate. r is the median over 64 parts of the record, so that one long
 * run does not excuse itself. Above one half the repeats are not independent (slow noise under
 * coarse steps, samples repeated in groups), and runs four times as long are let pass. */
#include "imukit/elementary.h"
#include "screen_internal.h"

#include <math.h>

enum { PARTS = 64, RUN_MIN = 4 };

size_t imki_stuck_limit(size_t n, const double *samples, double false_alarm, double *repeated)
{
    double share[PARTS];
    size_t parts = 0, repeats_all = 0, count_all = 0;
    for (size_t part = 0; part < PARTS; part++) {
        size_t repeats = 0, count = 0;
        double previous = (double)NAN;
        for (size_t i = n / PARTS * part; i < n / PARTS * (part + 1); i++) {
            if (!imki_is_there(samples[i]))
                continue;
            repeats += samples[i] == previous;
            count++;
            previous = samples[i];
        }
        if (count > 1)
            share[parts++] = (double)repeats / (double)count;
        repeats_all += repeats;
        count_all += count;
    }
    *repeated = count_all > 0 ? (double)repeats_all / (double)count_all : 0;
    imki_sort(share, parts);
    /* 64 parts of at least some samples tell no share smaller than one sample in all. */
    const double least = 1 / ((double)count_all + 1);
    const double middle = parts > 0 ? share[parts / 2] : 0, r = middle > least ? middle : least;
    if (r > 0.999)
        return n;
    const double length =
        imk_ln((double)n * (1 - r) / false_alarm) / -imk_ln(r) * (r > 0.5 ? 4 : 1);
    return length > RUN_MIN ? (size_t)length + 1 : RUN_MIN;
}

imk_screen_count imki_stuck_find(size_t n, const double *samples, size_t limit, double *marked,
                                 size_t *longest)
{
    imk_screen_count found = {0, 0, n};
    *longest = 0;
    for (size_t i = 0; i < n;) {
        size_t end = i + 1, last = i, length = imki_is_there(samples[i]);
        const double value = samples[i];
        for (; length > 0 && end < n && (samples[end] == value || !imki_is_there(samples[end]));
             end++)
            if (samples[end] == value) {
                length++;
                last = end;
            }
        if (length > limit) {
            found.first = found.runs++ == 0 ? i + 1 : found.first;
            found.count += length - 1; /* the first one was read */
            *longest = length > *longest ? length : *longest;
            for (size_t k = i + 1; marked && k <= last; k++)
                marked[k] = (double)NAN;
        }
        i = last + 1;
    }
    return found;
}
