/* SPDX-License-Identifier: Apache-2.0 */
/* What is checked of any design, by its table, and of the settings it is run with; its start. */
#include "physics_internal.h"

#include <math.h>
#include <string.h>

enum { SETTINGS_COOKIE = 0x494D4B21 };

imk_exposure imk_exposure_default(void)
{
    return (imk_exposure){.temperature = 293.15};
}

imk_physics_settings imk_physics_default(void)
{
    return (imk_physics_settings){.cookie = SETTINGS_COOKIE, .rate = 100.0, .noise = true};
}

/* ---- designs --------------------------------------------------------------------------------- */

static int choice_count(const char *choices)
{
    int count = 1;
    for (; *choices; choices++)
        count += *choices == '|';
    return count;
}

static imk_status check_number(const imk_design_field *field, double value, imk_error *error)
{
    if (!isfinite(value))
        return imki_refuse(error, IMK_ERROR_NOT_FINITE, field->path, value, 0.0, NULL);
    const bool above = field->open ? value > field->minimum : value >= field->minimum;
    if (above && value <= field->maximum)
        return IMK_OK;
    return imki_refuse(error, IMK_ERROR_RANGE, field->path, value,
                       above ? field->maximum : field->minimum, field->help);
}

static imk_status check_field(const imk_design_field *field, const void *design, imk_error *error)
{
    const char *place = (const char *)design + field->offset;
    double number;
    int whole;
    switch (field->kind) {
    case IMK_DESIGN_NUMBER:
        memcpy(&number, place, sizeof number);
        return check_number(field, number, error);
    case IMK_DESIGN_COUNT:
        memcpy(&whole, place, sizeof whole);
        return check_number(field, (double)whole, error);
    case IMK_DESIGN_CHOICE:
        memcpy(&whole, place, sizeof whole);
        if (whole >= 0 && whole < choice_count(field->choices))
            return IMK_OK;
        return imki_refuse(error, IMK_ERROR_RANGE, field->path, (double)whole,
                           (double)choice_count(field->choices), field->choices);
    case IMK_DESIGN_SWITCH:
        break;
    }
    return IMK_OK;
}

imk_status imk_design_check(const imk_instrument *instrument, const void *design, imk_error *error)
{
    uint32_t cookie;
    memcpy(&cookie, design, sizeof cookie);
    if (cookie != instrument->cookie)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "design", NULL,
                             "a design made by the instrument's _default()");
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_status status = check_field(&instrument->fields[i], design, error);
        if (status != IMK_OK)
            return status;
    }
    return instrument->check ? instrument->check(design, error) : IMK_OK;
}

/* ---- settings -------------------------------------------------------------------------------- */

/* A cookie, a finite rate above 0, a known level, a step of 0 or more. */
static imk_status check_settings(const imk_physics_settings *settings, imk_error *error)
{
    if (settings->cookie != SETTINGS_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "start from imk_physics_default()");
    if (!isfinite(settings->rate) || !isfinite(settings->step))
        return imki_refuse(error, IMK_ERROR_NOT_FINITE, isfinite(settings->rate) ? "step" : "rate",
                           settings->rate, 0.0, NULL);
    if (!(settings->rate >= 1e-9 && settings->rate <= 1e12))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate,
                           settings->rate > 1.0 ? 1e12 : 1e-9,
                           "a sample rate from 1e-9 Hz to 1e12 Hz");
    if (!(settings->step >= 0.0))
        return imki_refuse(error, IMK_ERROR_RANGE, "step", settings->step, 0.0,
                           "a step above 0, or 0 for the instrument's own");
    if (settings->level != IMK_LEVEL_FULL && settings->level != IMK_LEVEL_SLOW)
        return imki_refuse(error, IMK_ERROR_RANGE, "level", (double)settings->level, 1.0,
                           "\"full\" or \"slow\"");
    return IMK_OK;
}

imk_status imk_instrument_init(const imk_instrument *instrument, const void *design,
                               const imk_physics_settings *settings, void *state, imk_error *error)
{
    imk_status status = imk_design_check(instrument, design, error);
    if (status == IMK_OK)
        status = check_settings(settings, error);
    if (status != IMK_OK)
        return status;
    memset(state, 0, instrument->state_size);
    return instrument->init(design, settings, state, error);
}

imk_status imki_divide_sample(const imk_physics_settings *settings, double longest, double limit,
                              const char *reason, size_t *count, double *step, imk_error *error)
{
    const double wanted = settings->step > 0.0 ? settings->step : longest;
    const double sample = 1.0 / settings->rate;
    /* the allowance lets a step that was meant to divide the sample divide it */
    const double parts = ceil(sample / wanted * (1.0 - 1e-9));
    if (settings->step > limit)
        return imki_refuse(error, IMK_ERROR_RANGE, "step", settings->step, limit, reason);
    if (!(parts <= 1e12) && settings->step > 0.0)
        return imki_refuse(error, IMK_ERROR_RANGE, "step", settings->step, 1e-12 * sample,
                           "at most 1e12 internal steps to a sample");
    if (!(parts <= 1e12))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, 1e-12 / wanted,
                           "at most 1e12 internal steps to a sample");
    *count = parts > 1.0 ? (size_t)parts : 1;
    *step = sample / (double)*count;
    return IMK_OK;
}
