/* SPDX-License-Identifier: Apache-2.0 */
/* Intervals at rest of a table of means: somebody else has found the rests and taken the means,
 * with their sigmas; each row is an interval. */
#include "static_internal.h"

#include <math.h>

imk_static_interval imki_static_mean(const imk_test_record *record, size_t row)
{
    imk_static_interval interval = {.begin = row,
                                    .end = row + 1,
                                    .temperature = record->temperature ? record->temperature[row]
                                                                       : (double)NAN,
                                    .section = record->section ? record->section[row] : -1};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const bool present = i < record->axis_count[sensor];
            interval.mean[sensor][i] = present && record->reading[sensor][i]
                                           ? record->reading[sensor][i][row]
                                           : (double)NAN;
            interval.sigma[sensor][i] = present && record->mean_sigma[sensor][i]
                                            ? record->mean_sigma[sensor][i][row]
                                            : (double)NAN;
            interval.scatter[sensor][i] = (double)NAN;
            interval.rounding[sensor][i] = 0.0;
        }
    return interval;
}

size_t imki_static_means(const imk_test_record *record, imk_static_interval *interval,
                         size_t capacity, double *activity, imk_static_findings *findings)
{
    *findings = (imk_static_findings){.rest_end = record->count,
                                      .standing = 1.0,
                                      .intervals = record->count,
                                      .quietest = (double)NAN,
                                      .loudest = (double)NAN};
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < record->axis_count[sensor]; i++) {
            double square = 0.0;
            for (size_t row = 0; record->mean_sigma[sensor][i] && row < record->count; row++)
                square += record->mean_sigma[sensor][i][row] * record->mean_sigma[sensor][i][row];
            findings->noise[sensor][i] = sqrt(square / (double)record->count);
        }
    for (size_t row = 0; row < record->count && row < capacity; row++)
        interval[row] = imki_static_mean(record, row);
    for (size_t row = 0; activity && row < record->count; row++)
        activity[row] = 0.0;
    return record->count;
}
