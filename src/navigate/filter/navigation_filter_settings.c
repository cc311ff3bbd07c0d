/* SPDX-License-Identifier: Apache-2.0 */
/* The settings of the navigation filter: their defaults, and what they must be. */
#include "navigation_filter_internal.h"

#include "base/refuse_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x5A0FEED1, ERRORS = IMK_NAVIGATION_ERRORS };

void imk_navigation_filter_default(imk_navigation_filter_settings *settings)
{
    memset(settings, 0, sizeof *settings);
    settings->cookie = COOKIE;
    settings->samples = 3;
    settings->step = 0.5;
    settings->velocity_sigma = 0.01;
    settings->false_alarm = 1e-4;
    settings->recover_after = 30;
}

static imk_status refuse(imk_error *error, const char *field, double value, const char *expected)
{
    const imk_status status = fabs(value) <= 1.7e308 ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse(error, status, field, value, 0.0, expected);
}

/* Finite and not negative, and not too large to be squared. */
static bool is_size(double value)
{
    return value >= 0.0 && value <= 1e100;
}

static imk_status check_triad(const imk_triad_errors *triad, const char *field, imk_error *error)
{
    if (triad->part_count > IMK_BIAS_PARTS_MAX)
        return refuse(error, field, (double)triad->part_count, "at most 13 parts of a bias");
    for (int i = 0; i < 3; i++) {
        if (!is_size(triad->white[i]))
            return refuse(error, field, triad->white[i], "a white noise of 0 or more");
        if (!is_size(triad->quantization[i]))
            return refuse(error, field, triad->quantization[i], "a quantization of 0 or more");
        for (size_t p = 0; p < triad->part_count; p++) {
            const imk_bias_part *part = &triad->part[p];
            if (!is_size(part->sigma[i]) || !is_size(part->walk[i]))
                return refuse(error, field,
                              is_size(part->sigma[i]) ? part->walk[i] : part->sigma[i],
                              "a sigma or random walk of 0 or more");
            if (!is_size(part->correlation_time))
                return refuse(error, field, part->correlation_time, "a time of 0 or more");
        }
    }
    return IMK_OK;
}

static imk_status check_alignment(const imk_navigation_filter_settings *s, imk_error *error)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            if (!(fabs(s->attitude_covariance[i][j]) <= 1e6))
                return refuse(error, "attitude_covariance", s->attitude_covariance[i][j],
                              "a covariance");
        for (int j = 0; j < 6; j++)
            if (!(fabs(s->alignment[i][j]) <= 1e100))
                return refuse(error, "alignment", s->alignment[i][j], "a finite number");
    }
    return IMK_OK;
}

static imk_status check_aids(const imk_navigation_filter_settings *s, imk_error *error)
{
    if (s->aid_count > IMK_AIDS_MAX)
        return refuse(error, "aid_count", (double)s->aid_count, "at most 8 aids");
    if (s->recover_after < 0)
        return refuse(error, "recover_after", s->recover_after, "a number of readings, or 0");
    imk_status status = IMK_OK;
    for (size_t k = 0; k < s->aid_count && status == IMK_OK; k++)
        status = imk_aid_validate(&s->aid[k], error);
    return status;
}

imk_status imki_navigation_filter_check(const imk_navigation_filter_settings *s, imk_error *error)
{
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "navigation_filter", "",
                             "start from imk_navigation_filter_default()");
    imk_status status = check_triad(&s->gyro, "gyro", error);
    if (status == IMK_OK)
        status = check_triad(&s->accel, "accel", error);
    if (status == IMK_OK)
        status = check_aids(s, error);
    if (status != IMK_OK)
        return status;
    if (!(s->samples >= 1 && s->samples <= 4))
        return refuse(error, "samples", s->samples, "1 to 4 samples");
    if (!(s->step >= 1e-3 && s->step <= 10.0))
        return refuse(error, "step", s->step, "a time between 1 ms and 10 s");
    if (!(s->velocity_sigma > 0.0 && s->velocity_sigma <= 1e6))
        return refuse(error, "velocity_sigma", s->velocity_sigma, "a positive velocity");
    if (!is_size(s->rotation_sigma))
        return refuse(error, "rotation_sigma", s->rotation_sigma, "a rate of 0 or more");
    if (!(s->false_alarm >= 1e-12 && s->false_alarm < 0.5))
        return refuse(error, "false_alarm", s->false_alarm, "a probability from 1e-12 to 0.5");
    if (!is_size(s->alignment_time))
        return refuse(error, "alignment_time", s->alignment_time, "a time of 0 or more");
    for (int i = 0; i < ERRORS; i++)
        if (!is_size(s->initial_sigma[i]))
            return refuse(error, "initial_sigma", s->initial_sigma[i], "a sigma of 0 or more");
    return check_alignment(s, error);
}
