/* SPDX-License-Identifier: Apache-2.0 */
/* The bounds of imukit/identify_plan.h for the axes of a model. */
#include "record_plan_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/record/record_check_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t settings_cookie = 0x52504C31; /* "RPL1" */

/* The bounds are known of so many samples (identify_plan.h). */
static const double fewest_samples = 256, most_samples = 1e12;

static const double day = 86400; /* [s] */

/* What the bounds are of. */
typedef struct planning {
    imk_record_plan *plan;
    const imk_model *model;
    imk_bounds_settings settings;
    void *workspace;
} planning;

imk_record_plan_settings imk_record_plan_default(void)
{
    return (imk_record_plan_settings){.cookie = settings_cookie, .significance = 0.01};
}

void imk_record_plan_free(imk_record_plan *result, const imk_allocator *allocator)
{
    imki_resize(allocator, result, 0);
}

/* ---- parameters ------------------------------------------------------------------------------ */

static void add_parameter(imk_record_plan *p, const imk_plan_parameter *made, double value)
{
    for (size_t k = 0; k < p->parameter_count; k++) {
        imk_plan_parameter *known = &p->parameter[k];
        if (known->sensor == made->sensor && known->term == made->term &&
            known->time == made->time) {
            known->low = fmin(known->low, value);
            known->high = fmax(known->high, value);
            return;
        }
    }
    if (p->parameter_count == IMK_PLAN_PARAMETERS_MAX)
        return;
    imk_plan_parameter *added = &p->parameter[p->parameter_count++];
    *added = *made;
    added->low = added->high = value;
}

static bool any_of(const imk_triad *triad, const imk_axes *axes)
{
    bool any = false;
    for (int axis = 0; axis < triad->axis_count; axis++)
        any = any || axes->value[axis] != 0;
    return any;
}

/* A record shows one size of the errors of readings. It has the name of the one term that the model
 * has of them; several together are reading noise at this rate. */
static imk_term_display reading_term(const imk_log_column *column, const imk_triad *triad,
                                     double dt)
{
    const bool counted = any_of(triad, &triad->noise.quantization);
    const bool white = any_of(triad, &triad->noise.angle_white);
    const bool reading = any_of(triad, &triad->noise.reading_noise);
    return reading || (counted && white) ? imk_channel_reading_noise(column)
           : white                       ? imk_channel_angle_white(column, dt)
                                         : imk_channel_term(column, IMK_NOISE_QUANTIZATION);
}

static void add_axis(const planning *about, const imk_triad *triad, int axis, int sensor)
{
    imk_record_plan *p = about->plan;
    const imk_expected_noise of_axis = imk_expected_noise_of(triad, axis, about->settings.dt);
    const imk_expected_noise *noise = &of_axis;
    const bool gyro = sensor == IMK_GYRO;
    const imk_log_column column = {.quantity = gyro ? IMK_QUANTITY_ANGULAR_RATE
                                                    : IMK_QUANTITY_SPECIFIC_FORCE,
                                   .unit = imk_unit_of(gyro ? "rad/s" : "m/s^2")};
    imk_plan_parameter made = {.sensor = sensor};
    for (made.term = 0; made.term < IMK_NOISE_TERMS; made.term++) {
        const imk_term_display display = made.term == IMK_NOISE_QUANTIZATION
                                             ? reading_term(&column, triad, about->settings.dt)
                                             : imk_channel_term(&column, (imk_noise_term)made.term);
        made.unit = display.unit;
        snprintf(made.key, sizeof made.key, "%s", display.key);
        if (noise->term[made.term] != 0)
            add_parameter(p, &made, fabs(noise->term[made.term]));
    }
    for (int i = 0; i < noise->gauss_markov_count; i++, made.term++) {
        made.time = false;
        made.unit = imk_channel_term(&column, IMK_NOISE_BIAS_INSTABILITY).unit;
        snprintf(made.key, sizeof made.key, "gauss_markov[%d].sigma", i);
        add_parameter(p, &made, noise->gauss_markov[i].sigma);
        made.time = true;
        made.unit = imk_unit_of("s");
        snprintf(made.key, sizeof made.key, "gauss_markov[%d].correlation_time", i);
        add_parameter(p, &made, noise->gauss_markov[i].correlation_time);
    }
}

static void list_parameters(const planning *about)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(about->model, sensor);
        for (int axis = 0; triad->present && axis < triad->axis_count; axis++)
            add_axis(about, triad, axis, sensor);
    }
}

/* ---- records --------------------------------------------------------------------------------- */

static const imk_bound *bound_of(const imk_identification_bounds *bounds,
                                 const imk_plan_parameter *parameter)
{
    const int i = parameter->term - IMK_NOISE_TERMS;
    return i < 0             ? &bounds->term[parameter->term]
           : parameter->time ? &bounds->correlation_time[i]
                             : &bounds->sigma[i];
}

static void add_bounds(const imk_record_plan *p, const imk_identification_bounds *bounds,
                       int sensor, imk_plan_record *record)
{
    for (size_t k = 0; k < p->parameter_count; k++) {
        const imk_bound *bound = bound_of(bounds, &p->parameter[k]);
        if (p->parameter[k].sensor != sensor || bound->value == 0)
            continue;
        record->relative[k] = fmax(record->relative[k], bound->relative);
        record->detection[k] = fmin(record->detection[k], bound->detection);
    }
}

static imk_plan_record record_of(const planning *about, double duration)
{
    imk_plan_record record = {.duration = duration, .planned = duration == about->plan->duration};
    for (size_t k = 0; k < about->plan->parameter_count; k++)
        record.detection[k] = 1;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(about->model, sensor);
        for (int axis = 0; triad->present && axis < triad->axis_count; axis++) {
            const imk_expected_noise noise = imk_expected_noise_of(triad, axis, about->settings.dt);
            imk_identification_bounds bounds;
            if (imk_identify_bounds(&noise, &about->settings, duration, &bounds, about->workspace,
                                    imk_bounds_workspace_size(), NULL) != IMK_OK)
                continue;
            record.told = true;
            add_bounds(about->plan, &bounds, sensor, &record);
        }
    }
    return record;
}

/* 10 min to a day, and what is planned, in order. */
static void list_records(const planning *about)
{
    static const double usual[] = {600, 3600, 10800, 43200, 86400};
    imk_record_plan *p = about->plan;
    bool placed = !(p->duration > 0);
    for (size_t k = 0; k < sizeof usual / sizeof usual[0]; k++) {
        if (!placed && p->duration <= usual[k] * 1.001) {
            placed = true;
            if (p->duration < usual[k] * 0.999)
                p->record[p->record_count++] = record_of(about, p->duration);
        }
        p->record[p->record_count++] = record_of(about, usual[k]);
    }
    if (!placed)
        p->record[p->record_count++] = record_of(about, p->duration);
    if (!p->settings.curve)
        return;
    const double low = imk_ln(fmax(60, fewest_samples * about->settings.dt));
    const double high = imk_ln(fmax(7 * day, 3 * p->duration));
    for (; p->curve_count < IMK_PLAN_CURVE; p->curve_count++)
        p->curve[p->curve_count] = record_of(
            about, imk_exp(low + (high - low) * (double)p->curve_count / (IMK_PLAN_CURVE - 1)));
}

/* ---- requirements ---------------------------------------------------------------------------- */

/* The axis that needs the longest decides. */
static imk_status find_duration(const planning *about, imk_plan_requirement *asked,
                                imk_error *error)
{
    const imk_plan_parameter *parameter = &about->plan->parameter[asked->parameter];
    const imk_triad *triad = imk_model_triad(about->model, parameter->sensor);
    const imk_identify_requirement requirement = {parameter->term, parameter->time, asked->relative,
                                                  asked->detection};
    for (int axis = 0; axis < triad->axis_count; axis++) {
        const imk_expected_noise noise = imk_expected_noise_of(triad, axis, about->settings.dt);
        const int i = parameter->term - IMK_NOISE_TERMS;
        if (i < 0 ? noise.term[parameter->term] == 0 : i >= noise.gauss_markov_count)
            continue;
        double duration = HUGE_VAL;
        const imk_status status =
            imk_identify_duration(&noise, &about->settings, &requirement, &duration,
                                  about->workspace, imk_bounds_workspace_size(), error);
        if (status != IMK_OK && status != IMK_ERROR_NO_CONVERGENCE)
            return status;
        asked->duration = fmax(asked->duration, duration);
    }
    return IMK_OK;
}

/* Is there a statement about the planned record, or about one of those that are always shown? What
 * is wanted finds its own length. */
static imk_status check_length(imk_record_plan *p, imk_error *error)
{
    const bool given = p->settings.duration > 0;
    const double planned = given ? p->settings.duration : day, samples = planned * p->settings.rate;
    if ((p->settings.want && !given) || (samples >= fewest_samples && samples <= most_samples))
        return IMK_OK;
    return imki_fail(&p->findings, error, IMK_ERROR_RANGE, given ? "plan_length" : "plan_no_length",
                     NULL, IMKI_NUMBERS(planned, p->settings.rate));
}

static imk_status plan(const planning *about, imk_error *error)
{
    imk_record_plan *p = about->plan;
    imk_status status = check_length(p, error);
    if (status != IMK_OK)
        return status;
    list_parameters(about);
    if (p->parameter_count == 0)
        return imki_fail(&p->findings, error, IMK_ERROR_EMPTY, "no_noise", NULL, 0, NULL);
    status = imki_plan_requirements(p, error);
    for (size_t k = 0; status == IMK_OK && k < p->requirement_count; k++)
        status = find_duration(about, &p->requirement[k], error);
    if (status != IMK_OK)
        return status;
    p->duration = p->settings.duration;
    for (size_t k = 0; k < p->requirement_count && !(p->settings.duration > 0); k++)
        if (isfinite(p->requirement[k].duration))
            p->duration = fmax(p->duration, p->requirement[k].duration);
    p->met = true;
    for (size_t k = 0; k < p->requirement_count; k++)
        p->met = p->met && p->requirement[k].duration <= p->duration;
    list_records(about);
    return IMK_OK;
}

imk_status imk_record_plan_run(const imk_model *model, const imk_record_plan_settings *settings,
                               const imk_job *job, imk_record_plan **result, imk_error *error)
{
    imki_arena scratch = {.allocator = imki_job_of(job)->allocator};
    imk_status status =
        imki_check_call(result, settings, settings_cookie, "imk_record_plan_default()", error);
    if (!result)
        return status;
    *result = NULL;
    if (status == IMK_OK)
        status = imki_check_model(model, error);
    if (status != IMK_OK)
        return status;
    if (!(settings->rate > 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, 0, "a rate above 0 Hz");
    if (!(settings->significance > 0 && settings->significance < 0.5))
        return imki_refuse(error, IMK_ERROR_RANGE, "significance", settings->significance, 0.5,
                           "a false-alarm rate above 0 and below 0.5");
    if (!(settings->duration >= 0))
        return imki_refuse(error, IMK_ERROR_RANGE, "duration", settings->duration, 0,
                           "a length above 0 s, or 0 for the one that is needed");
    planning about = {.model = model, .settings = imk_bounds_default()};
    about.settings.dt = 1 / settings->rate;
    about.settings.significance = settings->significance;
    about.workspace = imki_arena_room(&scratch, imk_bounds_workspace_size());
    about.plan = *result = imki_resize(&scratch.allocator, NULL, sizeof *about.plan);
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (about.plan) {
        memset(about.plan, 0, sizeof *about.plan);
        about.plan->settings = *settings;
    }
    if (about.plan && about.workspace)
        status = plan(&about, error);
    imki_arena_free(&scratch);
    return status;
}
