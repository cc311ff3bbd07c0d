/* SPDX-License-Identifier: Apache-2.0 */
/* The kinds of instruments there are, and what can be said of any design from its table. */
#include "imukit/fibre_optic.h"
#include "imukit/free_gyro.h"
#include "imukit/mems_accelerometer.h"
#include "imukit/pendulous_servo.h"
#include "imukit/rate_gyro.h"
#include "imukit/rate_integrating_gyro.h"
#include "imukit/ring_laser.h"
#include "imukit/shell_gyro.h"
#include "imukit/suspended_rotor.h"
#include "imukit/tuned_gyro.h"
#include "imukit/tuning_fork.h"
#include "imukit/vibrating_beam.h"
#include "physics_internal.h"

#include <math.h>
#include <string.h>

enum { SETTINGS_COOKIE = 0x494D4B21 };

/* In the order of the lecture: spinning mass, optical, vibratory, accelerometers. */
static const imk_instrument *const instruments[] = {&imk_free_gyro_instrument,
                                                    &imk_rate_gyro_instrument,
                                                    &imk_rate_integrating_gyro_instrument,
                                                    &imk_tuned_gyro_instrument,
                                                    &imk_suspended_rotor_instrument,
                                                    &imk_fibre_optic_instrument,
                                                    &imk_ring_laser_instrument,
                                                    &imk_tuning_fork_instrument,
                                                    &imk_shell_gyro_instrument,
                                                    &imk_mems_accelerometer_instrument,
                                                    &imk_pendulous_servo_instrument,
                                                    &imk_vibrating_beam_instrument,
                                                    NULL};
enum { INSTRUMENTS = sizeof instruments / sizeof instruments[0] - 1 };

imk_exposure imk_exposure_default(void)
{
    return (imk_exposure){.temperature = 293.15};
}

imk_physics_settings imk_physics_settings_default(void)
{
    return (imk_physics_settings){.cookie = SETTINGS_COOKIE, .rate = 100.0, .noise = true};
}

size_t imk_instrument_count(void)
{
    return INSTRUMENTS;
}

const imk_instrument *imk_instrument_get(size_t index)
{
    return index < INSTRUMENTS ? instruments[index] : NULL;
}

static bool is_separator(char c)
{
    return c == ' ' || c == '-' || c == '_';
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool same_name(const char *a, const char *b)
{
    for (;;) {
        while (is_separator(*a))
            a++;
        while (is_separator(*b))
            b++;
        if (lower(*a) != lower(*b))
            return false;
        if (*a == '\0')
            return true;
        a++;
        b++;
    }
}

const imk_instrument *imk_instrument_find(const char *name)
{
    for (size_t i = 0; name && i < INSTRUMENTS; i++)
        if (same_name(name, instruments[i]->name))
            return instruments[i];
    return NULL;
}

/* ---- checks ---------------------------------------------------------------------------------- */

imk_status imki_design_refuse(imk_error *error, imk_status status, const char *field, double value,
                              double limit, const char *expected)
{
    imk_error_set(error, status, field, "", expected);
    if (error) {
        error->index = -1;
        error->value = value;
        error->limit = limit;
    }
    return status;
}

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
        return imki_design_refuse(error, IMK_ERROR_NOT_FINITE, field->path, value, 0.0, NULL);
    const bool above = field->open ? value > field->minimum : value >= field->minimum;
    if (above && value <= field->maximum)
        return IMK_OK;
    return imki_design_refuse(error, IMK_ERROR_RANGE, field->path, value,
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
        return imki_design_refuse(error, IMK_ERROR_RANGE, field->path, (double)whole,
                                  (double)choice_count(field->choices), field->choices);
    case IMK_DESIGN_SWITCH:
        break;
    }
    return IMK_OK;
}

imk_status imk_design_check(const imk_instrument *instrument, const void *design, imk_error *error)
{
    for (size_t i = 0; i < instrument->field_count; i++) {
        const imk_status status = check_field(&instrument->fields[i], design, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

imk_status imki_settings_check(const imk_physics_settings *settings, imk_error *error)
{
    if (settings->cookie != SETTINGS_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", NULL,
                             "settings made by imk_physics_settings_default()");
    if (!isfinite(settings->rate) || !isfinite(settings->step))
        return imki_design_refuse(error, IMK_ERROR_NOT_FINITE,
                                  isfinite(settings->rate) ? "step" : "rate", settings->rate, 0.0,
                                  NULL);
    if (!(settings->rate >= 1e-9 && settings->rate <= 1e12))
        return imki_design_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate,
                                  settings->rate > 1.0 ? 1e12 : 1e-9,
                                  "a sample rate from 1e-9 Hz to 1e12 Hz");
    if (!(settings->step >= 0.0))
        return imki_design_refuse(error, IMK_ERROR_RANGE, "step", settings->step, 0.0,
                                  "a step above 0, or 0 for the instrument's own");
    if (settings->level != IMK_LEVEL_FULL && settings->level != IMK_LEVEL_SLOW)
        return imki_design_refuse(error, IMK_ERROR_RANGE, "level", (double)settings->level, 1.0,
                                  "full or slow");
    return IMK_OK;
}

imk_status imki_divide_sample(const imk_physics_settings *settings, double longest, double limit,
                              const char *reason, size_t *count, double *step, imk_error *error)
{
    const double wanted = settings->step > 0.0 ? settings->step : longest;
    const double sample = 1.0 / settings->rate;
    /* the allowance lets a step that was meant to divide the sample divide it */
    const double parts = ceil(sample / wanted * (1.0 - 1e-9));
    if (settings->step > limit)
        return imki_design_refuse(error, IMK_ERROR_RANGE, "step", settings->step, limit, reason);
    if (!(parts <= 1e12) && settings->step > 0.0)
        return imki_design_refuse(error, IMK_ERROR_RANGE, "step", settings->step, 1e-12 * sample,
                                  "at most 1e12 internal steps to a sample");
    if (!(parts <= 1e12))
        return imki_design_refuse(error, IMK_ERROR_RANGE, "rate", settings->rate, 1e-12 / wanted,
                                  "at most 1e12 internal steps to a sample");
    *count = parts > 1.0 ? (size_t)parts : 1;
    *step = sample / (double)*count;
    return IMK_OK;
}

/* ---- reduction ------------------------------------------------------------------------------- */

static void copy_text(char *to, size_t size, const char *from)
{
    size_t i = 0;
    for (; from[i] && i + 1 < size; i++)
        to[i] = from[i];
    to[i] = '\0';
}

imk_triad *imki_reduction_begin(imk_model *model, const imk_instrument *instrument)
{
    imk_model_default(model);
    const bool gyro = instrument->sensor == IMK_GYRO;
    imk_triad *triad = gyro ? &model->gyro : &model->accel;
    imk_evidence *evidence = gyro ? &model->gyro_evidence : &model->accel_evidence;
    (gyro ? &model->accel : &model->gyro)->present = false;
    triad->present = true;
    triad->axis_count = 1;
    for (int k = 0; k < 3; k++)
        triad->direction[0][k] = k == 0 ? 1.0 : 0.0;
    copy_text(model->name, sizeof model->name, instrument->title);
    copy_text(evidence->source, sizeof evidence->source, instrument->source);
    copy_text(evidence->method, sizeof evidence->method, "design parameters, by closed forms");
    return triad;
}

double imki_reduction_offset(imk_triad *triad, double u, double per_kelvin)
{
    double *const s = &triad->scale_factor.fixed.value[0];
    double *const k2 = &triad->nonlinearity.k2.value[0];
    double *const bias_slope = &triad->bias.temperature.coefficient[0].value[0];
    double *const scale_slope = &triad->scale_factor.temperature.coefficient[0].value[0];
    const double k3 = triad->nonlinearity.k3.value[0];
    const double slope = 1.0 + *s + u * (2.0 * *k2 + 3.0 * u * k3);
    triad->bias.fixed.value[0] += u * (1.0 + *s + u * (*k2 + u * k3));
    *bias_slope += slope * per_kelvin + *scale_slope * u;
    *scale_slope += 2.0 * (*k2 + 3.0 * u * k3) * per_kelvin;
    *s = slope - 1.0;
    *k2 += 3.0 * u * k3;
    return slope;
}

/* Component k of axis 0 becomes component (k + axis) mod 3 of axis `axis`. */
static void turn_rows(imk_rows *rows)
{
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 3; k++) {
            rows->value[axis][(k + axis) % 3] = rows->value[0][k];
            rows->sigma[axis][(k + axis) % 3] = rows->sigma[0][k];
        }
}

/* Squares turn as components do; so do the products xy, yz, zx. */
static void turn_quadratic(imk_quadratic_rows *rows)
{
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 6; k++) {
            const int to = k / 3 * 3 + (k + axis) % 3;
            rows->value[axis][to] = rows->value[0][k];
            rows->sigma[axis][to] = rows->sigma[0][k];
        }
}

static void repeat(imk_axes *axes)
{
    for (int axis = 1; axis < 3; axis++) {
        axes->value[axis] = axes->value[0];
        axes->sigma[axis] = axes->sigma[0];
    }
}

static void repeat_polynomial(imk_temperature_polynomial *polynomial)
{
    for (int i = 0; i < IMK_TEMPERATURE_ORDER_MAX; i++)
        repeat(&polynomial->coefficient[i]);
}

static void repeat_noise(imk_noise *noise)
{
    imk_axes *const single[] = {&noise->white, &noise->bias_instability, &noise->random_walk,
                                &noise->ramp, &noise->quantization};
    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++)
        repeat(single[i]);
    for (int i = 0; i < IMK_TERMS_MAX; i++) {
        repeat(&noise->gauss_markov[i].sigma);
        repeat(&noise->gauss_markov[i].correlation_time);
        repeat(&noise->sinusoid[i].amplitude);
        repeat(&noise->sinusoid[i].frequency);
        repeat(&noise->resonance[i].sigma);
        repeat(&noise->resonance[i].frequency);
        repeat(&noise->resonance[i].q);
    }
}

static void three_axes(imk_triad *triad)
{
    imk_axes *const single[] = {&triad->bias.fixed,
                                &triad->bias.repeatability,
                                &triad->bias.temperature_rate,
                                &triad->bias.warm_up_amplitude,
                                &triad->bias.hysteresis,
                                &triad->scale_factor.fixed,
                                &triad->scale_factor.repeatability,
                                &triad->nonlinearity.k2,
                                &triad->nonlinearity.koq,
                                &triad->nonlinearity.k3,
                                &triad->nonlinearity.asymmetry,
                                &triad->bandwidth,
                                &triad->damping,
                                &triad->dead_band,
                                &triad->range,
                                &triad->resolution,
                                &triad->sensitivity,
                                &triad->zero_offset};
    imk_rows *const rows[] = {&triad->misalignment, &triad->cross_axis, &triad->g_sensitivity,
                              &triad->lever_arm};
    for (size_t i = 0; i < sizeof single / sizeof single[0]; i++)
        repeat(single[i]);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        turn_rows(rows[i]);
    repeat_polynomial(&triad->bias.temperature);
    repeat_polynomial(&triad->scale_factor.temperature);
    repeat_noise(&triad->noise);
    turn_quadratic(&triad->g2_sensitivity);
    imk_rows *cross = &triad->nonlinearity.cross_products; /* Kip, Kio, Kpo: of the axis itself */
    for (int axis = 1; axis < 3; axis++)
        for (int k = 0; k < 3; k++) {
            cross->value[axis][k] = cross->value[0][k];
            cross->sigma[axis][k] = cross->sigma[0][k];
            triad->nonlinearity.pendulous_axis[axis][(k + axis) % 3] =
                triad->nonlinearity.pendulous_axis[0][k];
        }
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            triad->direction[axis][k] = axis == k ? 1.0 : 0.0;
    triad->axis_count = 3;
}

void imk_model_three_axes(imk_model *model)
{
    if (model->gyro.present)
        three_axes(&model->gyro);
    if (model->accel.present)
        three_axes(&model->accel);
}
