/* SPDX-License-Identifier: Apache-2.0 */
/* The navigation filter: its memory and start, and a sample's way through the mechanisation. */
#include "navigation_filter_internal.h"

#include "base/workspace_internal.h"

#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS };

/* The errors of aids among the states. @param places,state  of each aid, and all; or NULL both */
static size_t aid_states(const imk_navigation_filter_settings *settings, size_t first,
                         imki_aid_places *places, imki_aid_state *state)
{
    const size_t aids = settings->aid_count < IMK_AIDS_MAX ? settings->aid_count : IMK_AIDS_MAX;
    size_t count = 0;
    for (size_t k = 0; k < aids; k++) {
        const imk_aid *aid = &settings->aid[k];
        const double *correlated = aid->correlated_sigma, *arm = aid->lever_arm_sigma;
        size_t shared = k;
        for (size_t i = k; i-- > 0;)
            if (imki_aids_at_one_point(&settings->aid[i], aid))
                shared = i;
        const bool has_arm = arm[0] > 0.0 || arm[1] > 0.0 || arm[2] > 0.0;
        const bool has_correlated =
            correlated[0] > 0.0 || correlated[1] > 0.0 || correlated[2] > 0.0;
        for (int i = 0; i < 3 && has_correlated; i++, count++) {
            if (places && i == 0)
                places[k].correlated = first + count;
            if (state)
                state[count] = (imki_aid_state){aid->correlation_time, correlated[i], 0.0};
        }
        if (places && has_arm && shared < k)
            places[k].lever_arm = places[shared].lever_arm;
        for (int i = 0; i < 3 && has_arm && shared == k; i++, count++) {
            if (places && i == 0)
                places[k].lever_arm = first + count;
            if (state)
                state[count] = (imki_aid_state){0.0, arm[i], 0.0};
        }
    }
    return count;
}

static size_t own_states(const imk_navigation_filter_settings *settings)
{
    return ERRORS + 3 * (settings->gyro.part_count + settings->accel.part_count);
}

size_t imk_navigation_filter_size(const imk_navigation_filter_settings *settings)
{
    const size_t n = own_states(settings) + aid_states(settings, 0, NULL, NULL);
    return sizeof(imk_navigation_filter) + (2 * n * n + 9 * n) * sizeof(double) +
           IMKI_ALIGNMENT_SLACK;
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
    for (size_t k = 0; k < f->aid_states; k++, state++)
        f->covariance[state * n + state] = f->aid_state[k].sigma * f->aid_state[k].sigma;
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
    const imk_status status = imki_navigation_filter_check(settings, error);
    if (status != IMK_OK)
        return status;
    const size_t need = imk_navigation_filter_size(settings);
    if (!memory || memory_size < need)
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "navigation_filter", "",
                             "provide imk_navigation_filter_size() bytes");
    imk_navigation_filter *f = (void *)imki_align(memory);
    memset(f, 0, need - IMKI_ALIGNMENT_SLACK);
    f->settings = *settings;
    f->first_aid_state = own_states(settings);
    f->aid_states = aid_states(settings, f->first_aid_state, f->aid_places, f->aid_state);
    f->states = f->first_aid_state + f->aid_states;
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
    f->last.before = f->last.after = f->strapdown.state;
    for (int k = 0; k <= IMK_AIDS_MAX; k++)
        f->counts[k].first_refused = f->counts[k].first_recovered = (double)NAN;
    for (int rows = 1; rows <= 3; rows++)
        f->limit[rows - 1] = imk_chi_square_quantile(1.0 - settings->false_alarm, rows);
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
    f->last.dt = dt;
    f->last.before = f->strapdown.state;
    imk_strapdown_step(&f->strapdown, dt, angle, velocity);
    f->last.after = f->strapdown.state;
    f->last.rate = imk_vector3_scale(angle, 1.0 / dt);
    const imk_matrix3 now = imk_quaternion_to_matrix(f->strapdown.state.attitude);
    imk_vector3 turned = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double middle = 0.5 * (f->attitude.m[i][j] + now.m[i][j]);
            f->turned.m[i][j] += middle * dt;
            f->stand_attitude.m[i][j] += middle * dt;
            turned.v[i] += middle * velocity.v[j];
        }
    f->last.force = imk_vector3_scale(turned, 1.0 / dt);
    f->force = imk_vector3_add(f->force, turned);
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
    return filter->counts[IMK_AIDS_MAX];
}

imk_navigation_filter_counts imk_navigation_filter_aided(const imk_navigation_filter *filter,
                                                         size_t aid)
{
    return filter->counts[aid < IMK_AIDS_MAX ? aid : IMK_AIDS_MAX];
}

double imk_navigation_filter_correlation(const imk_navigation_filter_counts *c)
{
    return c->pairs > 0 ? c->pair_sum / (double)c->pairs * (double)c->degrees / c->chi_square
                        : (double)NAN;
}

imk_innovation imk_navigation_filter_innovation(const imk_navigation_filter *filter)
{
    return filter->innovation;
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

void imki_estimate_of(const imk_navigation_state *state, const double *covariance, size_t stride,
                      imk_navigation_filter_estimate *estimate)
{
    const imk_matrix3 axes = axes_at(state);
    estimate->state = *state;
    for (size_t a = 0; a < ERRORS; a += 3)
        for (size_t b = 0; b < ERRORS; b += 3)
            for (size_t i = 0; i < 3; i++)
                for (size_t j = 0; j < 3; j++) {
                    double sum = 0.0;
                    for (size_t k = 0; k < 3; k++)
                        for (size_t l = 0; l < 3; l++)
                            sum +=
                                axes.m[k][i] * covariance[(a + k) * stride + b + l] * axes.m[l][j];
                    estimate->covariance[a + i][b + j] = sum;
                }
    display_attitude(state->position, estimate->covariance);
}

void imk_navigation_filter_get(imk_navigation_filter *f, imk_navigation_filter_estimate *estimate)
{
    imki_navigation_filter_propagate(f);
    const size_t n = f->states;
    imki_estimate_of(&f->strapdown.state, f->covariance, n, estimate);
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
