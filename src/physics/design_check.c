/* SPDX-License-Identifier: Apache-2.0 */
/* What is checked of any design, by its table, and of the settings it is run with; its start. */
#include "physics_internal.h"

#include "base/text_internal.h"
#include "imukit/decimal.h"
#include "model/model_schema_internal.h"

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

/* ---- the error model of a design ------------------------------------------------------------- */

/* Designs of larger structures are not searched for the parameter at fault. */
enum { DESIGN_SIZE_MAX = 1024 };

/* The first number of the error model that is not finite; NULL: all are. */
static const imki_field *find_not_finite(const imk_instrument *instrument, const void *design)
{
    imk_triad triad = {.present = true, .axis_count = 1, .direction = {{1.0, 0.0, 0.0}}};
    instrument->reduce(design, &triad);
    return imki_triad_not_finite(&triad);
}

static size_t size_of_field(const imk_design_field *field)
{
    return field->kind == IMK_DESIGN_NUMBER   ? sizeof(double)
           : field->kind == IMK_DESIGN_SWITCH ? sizeof(bool)
                                              : sizeof(int);
}

/* Is it the value of this field? With that of the default design the model is finite. */
static bool is_cause(const imk_instrument *instrument, const void *design,
                     const imk_design_field *field)
{
    _Alignas(16) char other[DESIGN_SIZE_MAX], usual[DESIGN_SIZE_MAX];
    const size_t size = size_of_field(field);
    instrument->set_default(usual);
    memcpy(other, design, instrument->design_size);
    if (memcmp(other + field->offset, usual + field->offset, size) == 0)
        return false;
    memcpy(other + field->offset, usual + field->offset, size);
    return (!instrument->check || instrument->check(other, NULL) == IMK_OK) &&
           !find_not_finite(instrument, other);
}

static void append(imk_error *error, const char *text)
{
    imki_append_text(error->expected, sizeof error->expected, text);
}

/* The first parameter at fault is the field of the error, the others are named. */
static imk_status refuse_model(const imk_instrument *instrument, const void *design,
                               const imki_field *figure, imk_error *error)
{
    imk_error said = {.status = IMK_OK};
    const imk_design_field *cause = NULL;
    const bool searched = instrument->design_size <= DESIGN_SIZE_MAX;
    append(&said, figure->path[instrument->sensor]);
    append(&said, " of the error model is not finite");
    for (size_t i = 0; searched && i < instrument->field_count; i++) {
        const imk_design_field *field = &instrument->fields[i];
        if (!is_cause(instrument, design, field))
            continue;
        if (cause) {
            append(&said, said.index++ == 0 ? "; as good a cause is " : ", ");
            append(&said, field->path);
        } else {
            cause = field;
            append(&said, " with this value: bring it nearer to that of the default design");
        }
    }
    if (!cause)
        append(&said, " with these values together: bring them nearer to those of the default "
                      "design");
    double value = 0.0;
    if (cause && cause->kind == IMK_DESIGN_NUMBER)
        memcpy(&value, (const char *)design + cause->offset, sizeof value);
    return imki_conflict(error, cause ? cause->path : "design", value, (double)INFINITY,
                         said.expected);
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
    const imk_status status = instrument->check ? instrument->check(design, error) : IMK_OK;
    if (status != IMK_OK || !instrument->reduce)
        return status;
    const imki_field *figure = find_not_finite(instrument, design);
    return figure ? refuse_model(instrument, design, figure, error) : IMK_OK;
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
    if (!(settings->duration >= 0.0 && isfinite(settings->duration)))
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", settings->duration, 0.0,
                           "a time of 0 or more");
    if (!(settings->turning >= 0.0 && isfinite(settings->turning)))
        return imki_refuse(error, IMK_ERROR_RANGE, "turning", settings->turning, 0.0,
                           "an angular rate of 0 or more");
    if (!(settings->steps_max >= 0.0))
        return imki_refuse(error, IMK_ERROR_RANGE, "steps_max", settings->steps_max, 0.0,
                           "a number of steps, or 0 for no limit");
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

/* A number as a person reads it, in a message. */
static void append_number(char *text, size_t size, double number)
{
    char digits[IMK_DECIMAL_SIZE];
    (void)imk_decimal_significant(number, 3, digits);
    imki_append_text(text, size, digits);
}

/* A run must end. Rows that were asked for count as they are: steps are those within a sample. */
static imk_status check_length(const imk_physics_settings *settings, double parts, double longest,
                               const char *reason, imk_error *error)
{
    const double duration = settings->duration, allowed = settings->steps_max;
    const double total = duration * settings->rate * parts;
    char found[sizeof error->found] = "the run of ", expected[sizeof error->expected] = "at most ";
    if (parts <= 1.0 || allowed == 0.0 || total <= allowed)
        return IMK_OK;
    append_number(found, sizeof found, duration);
    imki_append_text(found, sizeof found, " s needs ");
    append_number(found, sizeof found, total);
    imki_append_text(found, sizeof found, " internal steps of ");
    append_number(found, sizeof found, 1.0 / (settings->rate * parts));
    imki_append_text(found, sizeof found, " s");
    append_number(expected, sizeof expected, allowed);
    if (settings->step > 0.0 && settings->step < longest) {
        imki_append_text(expected, sizeof expected, ": take a longer step");
    } else {
        imki_append_text(expected, sizeof expected, " (");
        imki_append_text(expected, sizeof expected, reason);
        imki_append_text(expected, sizeof expected,
                         "): make the design or the input slower, or the run shorter");
    }
    (void)imk_error_set(error, IMK_ERROR_CONFLICT, "duration", found, expected);
    return IMK_ERROR_CONFLICT;
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
    return check_length(settings, parts, longest, reason, error);
}
