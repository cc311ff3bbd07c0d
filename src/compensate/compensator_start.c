/* SPDX-License-Identifier: Apache-2.0 */
/* What a model means for its compensation: which quantities it needs, which outputs depend on which
 * readings, and from where on a reading or a result is to be flagged. */
#include "imukit/compensate.h"
#include "model/model_schema_internal.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* [s] Long against the steps of a digital thermometer (a step of 0.1 K is then a rate of 0.2 K/min
 * for a while), short against the minutes in which a unit warms up. */
static const double usual_temperature_time = 30.0;

static bool any_axis(const imk_axes *axes, int count)
{
    for (int i = 0; i < count; i++)
        if (axes->value[i] != 0.0)
            return true;
    return false;
}

static bool any_coefficient(const imk_temperature_polynomial *polynomial, int count)
{
    for (int i = 0; i < polynomial->order; i++)
        if (any_axis(&polynomial->coefficient[i], count))
            return true;
    return false;
}

static bool any_lever_arm(const imk_triad *accel)
{
    for (int i = 0; accel->present && i < accel->axis_count; i++)
        for (int k = 0; k < 3; k++)
            if (accel->lever_arm.value[i][k] != 0.0)
                return true;
    return false;
}

static bool any_force_on_gyros(const imk_triad *gyro)
{
    for (int i = 0; i < gyro->axis_count; i++) {
        double row[9] = {0.0};
        imki_add_rows(gyro, i, IMKI_FORM_FORCE, row);
        imki_add_rows(gyro, i, IMKI_FORM_PRODUCT, row + 3);
        for (int k = 0; k < 9; k++)
            if (row[k] != 0.0)
                return true;
    }
    return false;
}

/* Every polynomial must be within its valid range. */
static void narrow(imk_compensator *c, const imk_temperature_polynomial *polynomial)
{
    if (polynomial->minimum > c->temperature_minimum)
        c->temperature_minimum = polynomial->minimum;
    if (polynomial->maximum < c->temperature_maximum)
        c->temperature_maximum = polynomial->maximum;
}

static void find_temperature(imk_compensator *c, const imk_triad *triad, int sensor)
{
    const int n = triad->axis_count;
    const bool bias = any_coefficient(&triad->bias.temperature, n);
    const bool scale = any_coefficient(&triad->scale_factor.temperature, n);
    const bool rate = any_axis(&triad->bias.temperature_rate, n);
    if (bias)
        narrow(c, &triad->bias.temperature);
    if (scale)
        narrow(c, &triad->scale_factor.temperature);
    c->uses_temperature[sensor] = bias || scale || rate;
    c->needs_temperature |= bias || scale || rate;
    c->needs_temperature_rate |= rate;
    if (any_axis(&triad->bias.warm_up_amplitude, n))
        c->warm_up_time[sensor] = triad->bias.warm_up_time.value;
}

/* A saturated reading comes out of the output stage as little as this below the range: rounded to
 * the resolution and to counts, and one step of the integral low (Q is the step over sqrt(12)).
 * The last part is for the rounding of units and of increments. */
static void find_ranges(imk_compensator *c, const imk_triad *triad, int sensor)
{
    for (int i = 0; i < IMK_AXES_MAX; i++) {
        c->range[sensor][i] = (double)INFINITY;
        if (!triad->present || i >= triad->axis_count || !(triad->range.value[i] > 0.0))
            continue;
        double margin = 0.5 * triad->resolution.value[i];
        if (triad->sensitivity.value[i] != 0.0)
            margin += 0.5 / fabs(triad->sensitivity.value[i]);
        margin += triad->noise.quantization.value[i] * sqrt(12.0) / c->dt;
        margin += 1e-9 * triad->range.value[i];
        c->range[sensor][i] = triad->range.value[i] - margin;
    }
}

/* Limits that somebody stated, where the iteration depends on them. A contraction this small is
 * that of a model which is solved in a fixed number of steps, up to rounding: linear, or with lever
 * arms alone. */
static void find_limits(imk_compensator *c, const imk_model *model,
                        const imk_correction_settings *settings)
{
    const imk_triad *triads[2] = {&model->gyro, &model->accel};
    const double stated[2] = {settings->rate_limit, settings->force_limit};
    for (int sensor = 0; sensor < 2; sensor++) {
        bool has_ranges = true;
        for (int i = 0; i < triads[sensor]->axis_count; i++)
            has_ranges = has_ranges && triads[sensor]->range.value[i] > 0.0;
        c->limited[sensor] =
            c->correction.contraction > 1e-12 && (stated[sensor] > 0.0 || has_ranges);
    }
}

/* Outputs that mix with readings of the other kind of sensor, by the model's terms or because the
 * joint solution weighs redundant sensors. */
static void find_dependence(imk_compensator *c, const imk_model *model)
{
    c->depends_on_other[IMK_GYRO] = model->gyro.present && any_force_on_gyros(&model->gyro);
    c->depends_on_other[IMK_ACCEL] = c->needs_acceleration;
    for (int row = 0; row < 6; row++) {
        const int sensor = row < 3 ? IMK_GYRO : IMK_ACCEL;
        const double *other = c->correction.inverse[row] + (sensor == IMK_GYRO ? IMK_AXES_MAX : 0);
        for (int i = 0; i < IMK_AXES_MAX; i++)
            c->depends_on_other[sensor] |= other[i] != 0.0;
    }
}

/* Everything but the correction. */
static void reset(imk_compensator *c, double dt)
{
    const size_t kept = offsetof(imk_compensator, dt);
    memset((char *)c + kept, 0, sizeof *c - kept);
    c->dt = c->temperature_interval = dt;
    c->temperature_minimum = -(double)INFINITY;
    c->temperature_maximum = (double)INFINITY;
    c->temperature_time = usual_temperature_time;
    c->temperature = (double)NAN;
}

imk_status imk_compensator_start(imk_compensator *compensator, const imk_model *model, double dt,
                                 const imk_correction_settings *settings, imk_error *error)
{
    const imk_correction_settings usual = imk_correction_default();
    if (!(dt >= 1e-12 && dt <= 1e9)) {
        imk_error_set(error, IMK_ERROR_RANGE, "dt", "", "a sample interval of 1e-12 s to 1e9 s");
        if (error)
            error->value = dt;
        return IMK_ERROR_RANGE;
    }
    imk_status status = imk_model_validate(model, error);
    if (status != IMK_OK)
        return status;
    imk_compensator *c = compensator;
    settings = settings ? settings : &usual;
    status = imk_correction_start(&c->correction, model, settings, error);
    if (status != IMK_OK)
        return status;
    reset(c, dt);
    if (model->gyro.present)
        find_temperature(c, &model->gyro, IMK_GYRO);
    if (model->accel.present)
        find_temperature(c, &model->accel, IMK_ACCEL);
    find_ranges(c, &model->gyro, IMK_GYRO);
    find_ranges(c, &model->accel, IMK_ACCEL);
    c->needs_acceleration = c->correction.solves[IMK_GYRO] && any_lever_arm(&model->accel);
    find_limits(c, model, settings);
    find_dependence(c, model);
    return IMK_OK;
}

int imk_compensator_delay(const imk_compensator *compensator)
{
    return compensator->needs_acceleration ? 1 : 0;
}

int imk_compensator_components(const imk_compensator *compensator, int sensor)
{
    return compensator->correction.output_count[sensor];
}

void imk_compensator_resume(imk_compensator *compensator, double time)
{
    imk_compensator *c = compensator;
    const double next = c->start_time + (double)c->count * c->dt;
    /* The interval from the sample before, when there was one. */
    if (c->count > 0 && time > next - c->dt)
        c->temperature_interval = time - (next - c->dt);
    c->start_time = time;
    c->count = 0;
}
