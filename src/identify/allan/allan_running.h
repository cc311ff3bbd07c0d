/* SPDX-License-Identifier: Apache-2.0 */
/* Running sums of a block by vectors.
 *
 *     value[j] = start + sum_{i < j} step[i]
 *
 * One after another that is an addition's latency a term. Sums of eight neighbouring steps (three
 * sweeps) let eight terms go on at once: value[j + 8] = value[j] + (step[j] + … + step[j + 7]). */
#ifndef IMUKIT_ALLAN_RUNNING_H
#define IMUKIT_ALLAN_RUNNING_H

#include "allan_internal.h"

enum { IMKI_RUNNING = 8 };

/* The first eight values, and the steps summed by eights in place. */
IMKI_INLINED void imki_running_begin(double start, double *step, size_t count, double *lane)
{
    lane[0] = start;
    for (size_t l = 1; l < IMKI_RUNNING; l++)
        lane[l] = l < count ? lane[l - 1] + step[l - 1] : 0;
    for (size_t j = 0; j + 2 < count; j++)
        step[j] += step[j + 1];
    for (size_t j = 0; j + 4 < count; j++)
        step[j] += step[j + 2];
    for (size_t j = 0; j + 8 < count; j++)
        step[j] += step[j + 4];
}

/* @param step   count - 1 of them are used, and overwritten
 * @param value  count values, count >= 1 */
IMKI_INLINED void imki_running(double start, double *step, size_t count, double *value)
{
    double lane[IMKI_RUNNING];
    imki_running_begin(start, step, count, lane);
    size_t j = 0;
    for (; j + 2 * IMKI_RUNNING <= count; j += IMKI_RUNNING)
        for (size_t l = 0; l < IMKI_RUNNING; l++) {
            value[j + l] = lane[l];
            lane[l] += step[j + l];
        }
    for (size_t l = 0; l < IMKI_RUNNING && j + l < count; l++)
        value[j + l] = lane[l];
    for (j += IMKI_RUNNING; j < count; j++)
        value[j] = value[j - IMKI_RUNNING] + step[j - IMKI_RUNNING];
}

/* The sum of their squares is all that is wanted of the values. Returns the last value. */
IMKI_INLINED double imki_running_squares(double start, double *step, size_t count, double *squares)
{
    double lane[IMKI_RUNNING], total[IMKI_RUNNING] = {0};
    imki_running_begin(start, step, count, lane);
    size_t j = 0;
    for (; j + 2 * IMKI_RUNNING <= count; j += IMKI_RUNNING)
        for (size_t l = 0; l < IMKI_RUNNING; l++) {
            total[l] += lane[l] * lane[l];
            lane[l] += step[j + l];
        }
    for (size_t l = 0; l < IMKI_RUNNING && j + l < count; l++)
        total[l] += lane[l] * lane[l];
    size_t last = (count - 1 - j) % IMKI_RUNNING;
    for (j += IMKI_RUNNING; j < count; j++) {
        const size_t l = j % IMKI_RUNNING;
        lane[l] += step[j - IMKI_RUNNING];
        total[l] += lane[l] * lane[l];
        last = l;
    }
    for (size_t half = IMKI_RUNNING / 2; half > 0; half /= 2)
        for (size_t l = 0; l < half; l++)
            total[l] += total[l + half];
    *squares = total[0];
    return lane[last];
}

#endif
