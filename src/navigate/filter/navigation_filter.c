/* SPDX-License-Identifier: Apache-2.0 */
/* The navigation filter: its memory and start, and a sample's way through the mechanisation. */
#include "navigation_filter_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"

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
}

static size_t state_count(const imk_navigation_filter_settings *settings)
{
    return ERRORS + 3 * (settings->gyro.part_count + settings->accel.part_count);
}

size_t imk_navigation_filter_size(const imk_navigation_filter_settings *settings)
{
    const size_t n = state_count(settings);
    return sizeof(imk_navigation_filter) + (2 * n * n + 9 * n) * sizeof(double) +
           IMKI_ALIGNMENT_SLACK;
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

static imk_status check(const imk_navigation_filter_settings *s, imk_error *error)
{
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "navigation_filter", "",
                             "start from imk_navigation_filter_default()");
    imk_status status = check_triad(&s->gyro, "gyro", error);
    if (status == IMK_OK)
        status = check_triad(&s->accel, "accel", error);
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

static imk_matrix3 axes_at(const imk_navigation_state *state)
{
    const imk_geodetic place = imk_geodetic_from_ecef(state->position);
    return imk_ned_axes(place.latitude, place.longitude);
}

/* A block of nine navigation errors, north-east-down, into Earth-fixed axes. */
static void put_block(imk_navigation_filter *f, const imk_matrix3 *axes, size_t block,
                      double ned[3][3])
{
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            double sum = 0.0;
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    sum += axes->m[i][a] * ned[a][b] * axes->m[j][b];
            f->covariance[(block + i) * f->states + block + j] = sum;
        }
}

static void start_covariance(imk_navigation_filter *f)
{
    const imk_navigation_filter_settings *s = &f->settings;
    const imk_triad_errors *triad[2] = {&s->gyro, &s->accel};
    const imk_matrix3 axes = axes_at(&f->strapdown.state);
    const size_t n = f->states;
    double tilt[3][3];
    memcpy(tilt, s->attitude_covariance, sizeof tilt);
    for (int i = 0; i < 3; i++)
        tilt[i][i] += s->initial_sigma[6 + i] * s->initial_sigma[6 + i];
    size_t state = ERRORS;
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (int axis = 0; axis < 3; axis++, state++) {
                const imki_part_moments m =
                    imki_bias_part_moments(&triad[sensor]->part[p], axis, s->alignment_time);
                f->covariance[state * n + state] = m.end;
                double gain[3], earth[3] = {0};
                for (int i = 0; i < 3; i++)
                    gain[i] = s->alignment[i][3 * sensor + axis];
                for (int i = 0; i < 3; i++)
                    for (int j = 0; j < 3; j++) {
                        tilt[i][j] += gain[i] * gain[j] * m.mean;
                        earth[i] += axes.m[i][j] * gain[j] * m.both;
                    }
                for (size_t i = 0; i < 3; i++)
                    f->covariance[(6 + i) * n + state] = f->covariance[state * n + 6 + i] =
                        earth[i];
            }
    put_block(f, &axes, 6, tilt);
    for (size_t block = 0; block < 6; block += 3) {
        double ned[3][3] = {{0}};
        const int known = s->hold_height ? 2 : 3;
        for (int i = 0; i < known; i++)
            ned[i][i] = s->initial_sigma[block + (size_t)i] * s->initial_sigma[block + (size_t)i];
        put_block(f, &axes, block, ned);
    }
}

imk_status imk_navigation_filter_start(const imk_navigation_filter_settings *settings,
                                       const imk_navigation_state *start,
                                       imk_navigation_filter **filter, void *memory,
                                       size_t memory_size, imk_error *error)
{
    const imk_status status = check(settings, error);
    if (status != IMK_OK)
        return status;
    const size_t need = imk_navigation_filter_size(settings);
    if (!memory || memory_size < need)
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "navigation_filter", "",
                             "provide imk_navigation_filter_size() bytes");
    imk_navigation_filter *f = (void *)imki_align(memory);
    memset(f, 0, need - IMKI_ALIGNMENT_SLACK);
    f->settings = *settings;
    f->states = state_count(settings);
    f->covariance = (double *)(void *)(f + 1);
    f->scratch = f->covariance + f->states * f->states;
    f->cross = f->scratch + f->states * f->states;
    f->h = f->cross + 3 * f->states;
    f->gain = f->h + 3 * f->states;
    f->parts[IMKI_GYRO_PART] = settings->gyro.part_count;
    f->parts[IMKI_ACCEL_PART] = settings->accel.part_count;
    f->strapdown = imk_strapdown_start(start);
    f->strapdown.hold_height = settings->hold_height;
    f->strapdown.samples = settings->samples;
    f->attitude = imk_quaternion_to_matrix(f->strapdown.state.attitude);
    f->counts.first_refused = (double)NAN;
    start_covariance(f);
    *filter = f;
    return IMK_OK;
}

void imk_navigation_filter_step(imk_navigation_filter *f, double dt, imk_vector3 angle,
                                imk_vector3 velocity)
{
    const imk_vector3 *gyro = &f->bias_sum[IMKI_GYRO_PART], *accel = &f->bias_sum[IMKI_ACCEL_PART];
    for (int i = 0; i < 3; i++) {
        angle.v[i] -= gyro->v[i] * dt;
        velocity.v[i] -= accel->v[i] * dt;
    }
    imk_strapdown_step(&f->strapdown, dt, angle, velocity);
    const imk_matrix3 now = imk_quaternion_to_matrix(f->strapdown.state.attitude);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double middle = 0.5 * (f->attitude.m[i][j] + now.m[i][j]);
            f->turned.m[i][j] += middle * dt;
            f->stand_attitude.m[i][j] += middle * dt;
            f->force.v[i] += middle * velocity.v[j];
        }
    for (int i = 0; i < 3; i++)
        f->stand_turn.v[i] += angle.v[i] - IMK_EARTH_RATE * dt * now.m[2][i];
    f->attitude = now;
    f->stand += dt;
    f->span += dt;
    /* An interval short of the step by rounding is not continued. */
    if (f->span > f->settings.step - 0.5 * dt)
        imki_navigation_filter_propagate(f);
}

void imk_navigation_filter_moved(imk_navigation_filter *filter)
{
    /* Noise in the covariance is counted from here too. */
    imki_navigation_filter_propagate(filter);
    filter->stand = 0.0;
    filter->stand_turn = (imk_vector3){{0}};
    memset(&filter->stand_attitude, 0, sizeof filter->stand_attitude);
    memset(filter->cross, 0, 3 * filter->states * sizeof *filter->cross);
}

imk_navigation_state imk_navigation_filter_state(const imk_navigation_filter *filter)
{
    return filter->strapdown.state;
}

imk_navigation_filter_counts imk_navigation_filter_counted(const imk_navigation_filter *filter)
{
    return filter->counts;
}

imki_filter_gain imki_navigation_filter_gain(const imk_navigation_filter *f)
{
    return (imki_filter_gain){f->states, f->rows, f->h, f->gain};
}

const double *imki_navigation_filter_covariance(imk_navigation_filter *f)
{
    imki_navigation_filter_propagate(f);
    return f->covariance;
}

/* Trace of the covariance of a sensor's biases, sums of their parts. */
static double bias_variance(const imk_navigation_filter *f, int sensor)
{
    const size_t n = f->states, parts = f->parts[sensor];
    const size_t first = ERRORS + (sensor == IMKI_GYRO_PART ? 0 : 3 * f->parts[IMKI_GYRO_PART]);
    double sum = 0.0;
    for (size_t axis = 0; axis < 3; axis++)
        for (size_t p = 0; p < parts; p++)
            for (size_t q = 0; q < parts; q++)
                sum += f->covariance[(first + 3 * p + axis) * n + first + 3 * q + axis];
    return sum > 0.0 ? sum : 0.0;
}

/* An attitude error turns gravity by at most g times itself. */
imk_rest_readings imk_navigation_filter_rest(const imk_navigation_filter *f)
{
    const imk_vector3 gravity = imk_gravity_ecef(f->strapdown.state.position);
    const double g2 = imk_vector3_dot(gravity, gravity);
    imk_rest_readings rest = {f->bias_sum[IMKI_GYRO_PART], f->bias_sum[IMKI_ACCEL_PART],
                              sqrt(bias_variance(f, IMKI_GYRO_PART)), 0.0};
    double tilt = 0.0; /* g^2 times the variance across gravity */
    for (size_t i = 0; i < 3; i++) {
        rest.rate.v[i] += IMK_EARTH_RATE * f->attitude.m[2][i];
        for (size_t j = 0; j < 3; j++) {
            const double across = (i == j ? g2 : 0.0) - gravity.v[i] * gravity.v[j];
            rest.force.v[i] -= f->attitude.m[j][i] * gravity.v[j];
            tilt += across * f->covariance[(6 + i) * f->states + 6 + j];
        }
    }
    rest.force_sigma = sqrt((tilt > 0.0 ? tilt : 0.0) + bias_variance(f, IMKI_ACCEL_PART));
    return rest;
}

/* Attitude errors psi to those of what is displayed, phi = psi - turn dr: rows, then columns. */
static void display_attitude(imk_vector3 position, double p[ERRORS][ERRORS])
{
    const imk_matrix3 turn = imk_level_turn(imk_geodetic_from_ecef(position));
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < ERRORS; j++)
            p[6 + i][j] -= turn.m[i][0] * p[0][j] + turn.m[i][1] * p[1][j];
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < ERRORS; j++)
            p[j][6 + i] -= turn.m[i][0] * p[j][0] + turn.m[i][1] * p[j][1];
}

void imk_navigation_filter_get(imk_navigation_filter *f, imk_navigation_filter_estimate *estimate)
{
    imki_navigation_filter_propagate(f);
    const imk_matrix3 axes = axes_at(&f->strapdown.state);
    const size_t n = f->states;
    estimate->state = f->strapdown.state;
    for (size_t a = 0; a < ERRORS; a += 3)
        for (size_t b = 0; b < ERRORS; b += 3)
            for (size_t i = 0; i < 3; i++)
                for (size_t j = 0; j < 3; j++) {
                    double sum = 0.0;
                    for (size_t k = 0; k < 3; k++)
                        for (size_t l = 0; l < 3; l++)
                            sum += axes.m[k][i] * f->covariance[(a + k) * n + b + l] * axes.m[l][j];
                    estimate->covariance[a + i][b + j] = sum;
                }
    display_attitude(f->strapdown.state.position, estimate->covariance);
    estimate->gyro_bias = f->bias_sum[IMKI_GYRO_PART];
    estimate->accel_bias = f->bias_sum[IMKI_ACCEL_PART];
    imk_vector3 *sigma[2] = {&estimate->gyro_bias_sigma, &estimate->accel_bias_sigma};
    size_t first = ERRORS;
    for (int sensor = 0; sensor < 2; sensor++) {
        const size_t parts = f->parts[sensor];
        for (size_t axis = 0; axis < 3; axis++) {
            double sum = 0.0;
            for (size_t p = 0; p < parts; p++)
                for (size_t q = 0; q < parts; q++)
                    sum += f->covariance[(first + 3 * p + axis) * n + first + 3 * q + axis];
            sigma[sensor]->v[axis] = sqrt(sum > 0.0 ? sum : 0.0);
        }
        first += 3 * parts;
    }
}
