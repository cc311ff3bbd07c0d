/* SPDX-License-Identifier: Apache-2.0 */
/* Values that are equal to something more often than noise is, and values that never come: what a
 * driver, a logger or a converter makes of samples. */
#include "verdict_concern_internal.h"

#include <string.h>

static bool find_zeros(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%.3g %% of the samples", 100 * s->zeros);
    return s->zeros > 0;
}

/* Zeros are told by themselves. */
static bool find_filled(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->filled_value);
    imki_text_add(detail, "%.3g %% of the samples too many are %.6g %s", 100 * s->filled,
                  s->filled_value / unit.scale, unit.text);
    return s->filled > 0 && s->zeros == 0;
}

/* Rows of a slower sensor repeat all axes, and are told with its rate. */
static bool rows_are_held(const imk_identify_log *log)
{
    for (size_t k = 0; k < log->findings.count; k++)
        if (strcmp(log->findings.item[k].code, "stamps:held") == 0)
            return true;
    return false;
}

static bool find_repeated(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%.3g %% of the samples", 100 * s->held);
    return s->held > s->straight && !(log->result[channel].verdict & IMK_VERDICT_FROZEN) &&
           !rows_are_held(log);
}

static bool find_straight(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    imki_text_add(detail, "%.3g %% of the samples", 100 * s->straight);
    return s->straight > 0 && s->straight >= s->held && !s->interpolated && !rows_are_held(log);
}

/* So has a dead band. */
static bool find_gap(const imk_identify_log *log, size_t channel, imki_text *detail)
{
    const imk_screen *s = &log->screen[channel];
    const imk_unit unit = imki_concern_unit(log, channel, s->gap);
    imki_text_add(detail, "%.3g %s wide", s->gap / unit.scale, unit.text);
    return s->gap > 0 && s->zeros == 0;
}

static const imki_concern concerns[] = {
    {0, find_zeros, 0, IMK_FINDING_WARNING, "zeros",
     "so many zeros are more than the values beside zero tell: lost rows are written as 0, or the "
     "driver has a dead band or cuts values off toward zero instead of rounding them; the white "
     "noise may be too low by up to this share",
     NULL},
    {0, find_filled, 0, IMK_FINDING_WARNING, "filled",
     "one value is more frequent than those beside it tell, as where a mean or another number is "
     "written for missing samples; the white noise is too low by about half of this share; leave "
     "such rows out",
     NULL},
    {0, find_repeated, 0, IMK_FINDING_WARNING, "repeated",
     "these samples repeat the one before, beyond what noise repeats by chance: a driver that "
     "reads this axis before a new sample is there; the white noise is too high by about this "
     "share; log new samples only",
     NULL},
    {0, find_straight, 0, IMK_FINDING_WARNING, "straight",
     "these samples are the mean of the samples beside them: missing ones were interpolated, "
     "and the white noise is too high by about this share; log the samples as they are",
     NULL},
    {0, find_gap, 0, IMK_FINDING_WARNING, "gap",
     "values within the noise never come, as where a bit of the converter is stuck or missing; "
     "the noise is not the sensor's",
     NULL},
};

void imki_assess_values(imk_verdict *v, const imk_identify_log *log)
{
    for (size_t k = 0; log->screened && k < sizeof concerns / sizeof concerns[0]; k++)
        imki_assess_concern(v, log, &concerns[k]);
}
