/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of a motion script, each by itself. What depends on the steps before, the speed and
 * the place, is checked while it is compiled. */
#include "base/refuse_internal.h"
#include "script_step_internal.h"

#include <float.h>
#include <math.h>

#define HALF_TURN 3.14159265358979323846

/* Angles beyond this lose digits to their size; times beyond this are 30 years. A step shorter than
 * a cycle of the highest rate has derivatives that overflow, or is lost beside the time so far. */
static const double angle_limit = 1e6;
static const double shortest_duration = 1e-6, duration_limit = 1e9;
static const double rate_limit = 1e6;

imk_status imki_step_refuse(imk_error *error, const char *field, size_t index, double value,
                            double limit, const char *expected)
{
    const bool finite = value >= -DBL_MAX && value <= DBL_MAX;
    const imk_status status = finite ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse_at(error, status, field, index, value, limit,
                          finite ? expected : "a finite number");
}

/* A number of the script itself: no index. */
static imk_status check(double value, double lower, double upper, const char *field,
                        const char *expected, imk_error *error)
{
    if (value >= lower && value <= upper)
        return IMK_OK;
    const imk_status status =
        imki_step_refuse(error, field, 0, value, value < lower ? lower : upper, expected);
    if (error)
        error->index = -1;
    return status;
}

static imk_status check_start(const imk_motion_script *s, imk_error *error)
{
    const struct {
        double value, lower, upper;
        const char *field, *expected;
    } numbers[] = {
        {s->smoothing, 1e-3, 1e3, "smoothing", "a time between 1 ms and 1000 s"},
        {s->place.latitude, -0.5 * HALF_TURN, 0.5 * HALF_TURN, "place.latitude",
         "a latitude within 90 deg"},
        {s->place.longitude, -2.0 * HALF_TURN, 2.0 * HALF_TURN, "place.longitude",
         "a longitude within 360 deg"},
        {s->place.height, -1e4, 1e7, "place.height", "a height between -10 km and 10000 km"},
        {s->heading, -angle_limit, angle_limit, "heading", "an angle of at most 1e6 rad"},
        {s->climb, -0.5 * HALF_TURN, 0.5 * HALF_TURN, "climb", "a climb angle within 90 deg"},
        {s->speed, 0.0, IMKI_SPEED_LIMIT, "speed", "a speed between 0 and 100 km/s"},
        {s->mounting[0], -angle_limit, angle_limit, "mounting.roll", "an angle of at most 1e6 rad"},
        {s->mounting[1], -angle_limit, angle_limit, "mounting.pitch",
         "an angle of at most 1e6 rad"},
        {s->mounting[2], -angle_limit, angle_limit, "mounting.yaw", "an angle of at most 1e6 rad"},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        const imk_status status = check(numbers[i].value, numbers[i].lower, numbers[i].upper,
                                        numbers[i].field, numbers[i].expected, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

/* What a step of this kind has to say. */
typedef struct needs {
    bool axis, amount, rate, duration, frequency, angles;
    double amount_limit;
    const char *amount_expected;
} needs;

static const char amounts_of_speed[] = "at most 100 km/s", amounts_of_angle[] = "at most 1e6 rad";

static needs needs_of(imk_step_kind kind)
{
    switch (kind) {
    case IMK_STEP_HOLD:
        return (needs){.duration = true};
    case IMK_STEP_ACCELERATE:
        return (needs){.amount = true,
                       .rate = true,
                       .amount_limit = IMKI_SPEED_LIMIT,
                       .amount_expected = amounts_of_speed};
    case IMK_STEP_TURN:
    case IMK_STEP_CLIMB:
        return (needs){.amount = true,
                       .rate = true,
                       .amount_limit = angle_limit,
                       .amount_expected = amounts_of_angle};
    case IMK_STEP_ROTATE:
        return (needs){.axis = true,
                       .amount = true,
                       .rate = true,
                       .amount_limit = angle_limit,
                       .amount_expected = amounts_of_angle};
    case IMK_STEP_POSE:
        return (needs){.duration = true, .angles = true};
    case IMK_STEP_SWING:
    case IMK_STEP_CONING:
        return (needs){.axis = true,
                       .amount = true,
                       .duration = true,
                       .frequency = true,
                       .amount_limit = HALF_TURN,
                       .amount_expected = "at most 180 deg"};
    }
    return (needs){.axis = false};
}

static imk_status check_step(const imk_motion_step *step, size_t index, imk_error *error)
{
    if ((unsigned)step->kind > IMK_STEP_CONING)
        return imki_step_refuse(error, "step.kind", index, (double)step->kind, IMK_STEP_CONING,
                                "a kind of step");
    const needs need = needs_of(step->kind);
    if (need.axis && !(step->axis >= 0 && step->axis <= 2))
        return imki_step_refuse(error, "step.axis", index, step->axis, 2.0, "0, 1 or 2: x, y, z");
    if (need.amount && !(fabs(step->amount) <= need.amount_limit))
        return imki_step_refuse(error, "step.amount", index, step->amount, need.amount_limit,
                                need.amount_expected);
    if (need.rate && !(step->rate > 0.0 && step->rate <= rate_limit))
        return imki_step_refuse(error, "step.rate", index, step->rate,
                                step->rate > 0.0 ? rate_limit : 0.0,
                                "a positive rate, at most 1e6 rad/s or m/s^2");
    if (need.duration && !(step->duration >= shortest_duration && step->duration <= duration_limit))
        return imki_step_refuse(error, "step.duration", index, step->duration,
                                step->duration >= 1.0 ? duration_limit : shortest_duration,
                                "a duration from 1 us to 1e9 s");
    if (need.frequency && !(step->frequency > 0.0 && step->frequency <= rate_limit))
        return imki_step_refuse(error, "step.frequency", index, step->frequency,
                                step->frequency > 0.0 ? rate_limit : 0.0,
                                "a positive frequency, at most 1e6 Hz");
    /* A cycle to grow, and one to die away; rounding of their product is not a cycle. */
    if (need.frequency && !(step->duration * step->frequency >= 2.0 * (1.0 - 1e-12)))
        return imki_step_refuse(error, "step.duration", index, step->duration,
                                2.0 / step->frequency, "at least two cycles");
    for (int i = 0; i < 3 && need.angles; i++)
        if (!(fabs(step->angle[i]) <= angle_limit))
            return imki_step_refuse(error, "step.angle", index, step->angle[i], angle_limit,
                                    "an angle of at most 1e6 rad");
    return IMK_OK;
}

imk_status imki_script_check(const imk_motion_script *script, imk_error *error)
{
    if (!script || script->cookie != IMKI_MOTION_SCRIPT_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "motion script", "",
                             "start from imk_motion_script_default()");
    imk_status status = check_start(script, error);
    if (status != IMK_OK)
        return status;
    if (script->step_count == 0 || !script->step)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "step", "", "at least one step");
    for (size_t i = 0; i < script->step_count && status == IMK_OK; i++)
        status = check_step(&script->step[i], i, error);
    return status;
}
