/* SPDX-License-Identifier: Apache-2.0 */
/* Alignment by gravity in inertial axes: samples become velocities, and these means over epochs.
 *
 * The body's own inertial axes i are the body's at the start; the reference axes r are inertial as
 * well, north-east-down at the start: there gravity is far larger along one axis than along the
 * others, and what rounding leaves of the one does not get into the others. With the gyros' C_ib,
 *
 *     V_i = integral of C_ib f dt
 *     V_r = integral of C_re (w x v - g) dt + C_re v          C_re: Earth-fixed axes by now to r
 *
 * f being the force, v the velocity relative to the Earth (in Earth-fixed axes), so that
 * V_i = C_ri^T V_r but for a constant [WU2011]. alignment_solution.c finds C_ri. */
#include "alignment_internal.h"

#include "imukit/elementary.h"
#include "navigate/strapdown/strapdown_internal.h"

#include <math.h>

void imki_alignment_inertial_start(imk_alignment *alignment)
{
    imki_velocities *v = &alignment->velocities;
    v->body = imk_quaternion_identity();
    const imk_geodetic place = alignment->settings.place;
    v->position = imk_ecef_from_geodetic(place);
    v->axes = imk_matrix3_transpose(imk_ned_axes(place.latitude, place.longitude));
    alignment->coarse = imk_matrix3_identity();
    alignment->next_rebase = 4;
}

/* ---- samples ----------------------------------------------------------------------------------
 */

/* Increment of V_i: the velocity turned by the mean of the rotating axes, with coning and sculling
 * terms from this sample and the one before; then the body turns. */
static imk_vector3 measured_step(imki_velocities *v, double dt, imk_vector3 angle,
                                 imk_vector3 velocity)
{
    imk_vector3 coning = {{0}}, sculling = {{0}};
    if (v->last_step > 0.0) {
        const double k = dt / (12.0 * v->last_step);
        coning = imki_scaled(k, imki_cross(v->last_angle, angle));
        sculling = imki_scaled(
            k, imki_sum(imki_cross(v->last_angle, velocity), imki_cross(v->last_velocity, angle)));
    }
    const imk_vector3 p = imki_sum(angle, coning);
    const imki_turn turn = imki_turn_from(p);
    const imk_vector3 pu = imki_cross(p, velocity), ppu = imki_cross(p, pu);
    imk_vector3 u;
    for (int i = 0; i < 3; i++)
        u.v[i] = velocity.v[i] + turn.first * pu.v[i] + turn.second * ppu.v[i] + sculling.v[i];
    const imk_vector3 step = imk_quaternion_rotate(v->body, u);
    v->body = imk_quaternion_normalise(
        imk_quaternion_multiply(v->body, imk_quaternion_from_rotation_vector(p)));
    v->last_angle = angle;
    v->last_velocity = velocity;
    v->last_step = dt;
    return step;
}

imk_vector3 imki_alignment_to_reference(const imk_alignment *alignment, double time, imk_vector3 v)
{
    const double c = imk_cos(IMK_EARTH_RATE * time), s = imk_sin(IMK_EARTH_RATE * time);
    const imk_vector3 turned = {{c * v.v[0] - s * v.v[1], s * v.v[0] + c * v.v[1], v.v[2]}};
    return imk_matrix3_apply(alignment->velocities.axes, turned);
}

static imk_vector3 earth_velocity(imk_vector3 position, const imk_vector3 *moving)
{
    if (moving == NULL)
        return (imk_vector3){{0}};
    const imk_geodetic place = imk_geodetic_from_ecef(position);
    return imk_matrix3_apply(imk_ned_axes(place.latitude, place.longitude), *moving);
}

void imki_alignment_inertial_add(imk_alignment *alignment, double dt, imk_vector3 angle,
                                 imk_vector3 velocity, const imk_vector3 *moving)
{
    imki_velocities *v = &alignment->velocities;
    const double middle = alignment->time - 0.5 * dt;
    v->moving = earth_velocity(v->position, moving);
    const imk_vector3 halfway = imki_sum(v->position, imki_scaled(0.5 * dt, v->moving));
    const imk_vector3 gravity = imk_gravity_ecef(halfway);
    const imk_vector3 force = {{-IMK_EARTH_RATE * v->moving.v[1] - gravity.v[0],
                                IMK_EARTH_RATE * v->moving.v[0] - gravity.v[1], -gravity.v[2]}};
    const imk_vector3 known =
        imki_alignment_to_reference(alignment, middle, imki_scaled(dt, force));
    const imk_vector3 measured = measured_step(v, dt, angle, velocity);
    /* Both in the middle of the sample, where the velocity is given. */
    for (int i = 0; i < 3; i++) {
        v->epoch_measured.v[i] += dt * (v->measured.v[i] + 0.5 * measured.v[i]);
        v->epoch_reference.v[i] += dt * (v->reference.v[i] + 0.5 * known.v[i]);
    }
    if (moving != NULL)
        v->epoch_reference =
            imki_sum(v->epoch_reference,
                     imki_alignment_to_reference(alignment, middle, imki_scaled(dt, v->moving)));
    v->measured = imki_sum(v->measured, measured);
    v->reference = imki_sum(v->reference, known);
    v->position = imki_sum(v->position, imki_scaled(dt, v->moving));
}

/* ---- epochs -----------------------------------------------------------------------------------
 */

/* Noise of the velocities, for a model: white noise of the gyros turns gravity, and so does what
 * their quantization leaves, which is white in the angle. */
static imki_velocity_noise noise_of(const imk_alignment *a, double *rounding)
{
    const double dt = a->time / (double)a->count,
                 g = imk_normal_gravity(a->settings.place.latitude, a->settings.place.height);
    const imk_vector3 none = {{0}};
    const imki_alignment_errors accel =
        imki_alignment_errors_of(&a->settings.model->accel, a->settings.duration, dt, none, NULL);
    const imki_alignment_errors gyro =
        imki_alignment_errors_of(&a->settings.model->gyro, a->settings.duration, dt, none, NULL);
    const double t = a->settings.duration, walk = imki_alignment_isotropic(&gyro.walk);
    const double bias = imki_alignment_isotropic(&gyro.mean);
    const double turned = g * g * imki_alignment_isotropic(&gyro.white);
    const double forced =
        imki_alignment_isotropic(&accel.walk) + imki_alignment_isotropic(&accel.change);
    /* A bias is constant in the body's axes, not in inertial ones, from which they turn with the
     * Earth, and those the gyros find with the bias: the third order in time. */
    const double turning = sqrt(IMK_EARTH_RATE * IMK_EARTH_RATE + bias);
    const double bent = g * turning * t * t * t / 6.0;
    *rounding =
        imki_alignment_isotropic(&accel.quantum) * dt / a->epoch_length + bent * bent * bias;
    return (imki_velocity_noise){.force = imki_alignment_isotropic(&accel.white) +
                                          g * g * imki_alignment_isotropic(&gyro.quantum) * dt,
                                 .turn = turned,
                                 .forced = forced,
                                 .growth = g * g * bias,
                                 .walk = g * g * walk};
}

/* The candidates. With a model: velocities disturbed by 1 um/s to 0.5 m/s. Without: the ratios of
 * what a white and a walking force do in the whole time to what epochs scatter, 0 and powers of 100
 * up to where the latter no longer matters. */
static void start_whiteners(imk_alignment *a)
{
    a->equal.noise = (imki_velocity_noise){.epoch = 1.0};
    if (a->settings.model != NULL) {
        double rounding;
        imki_velocity_noise noise = noise_of(a, &rounding);
        noise.epoch = 1e-12;
        for (a->whitener_count = 0; a->whitener_count < 20; a->whitener_count++) {
            a->whitener[a->whitener_count].noise = noise;
            a->whitener[a->whitener_count].noise.epoch += rounding;
            noise.epoch *= 4.0;
        }
        return;
    }
    static const double force[5] = {0.0, 1.0, 1e2, 1e4, 1e6};
    static const double turn[8] = {0.0, 1.0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12};
    const double t = a->settings.duration;
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 8; j++)
            a->whitener[a->whitener_count++].noise = (imki_velocity_noise){
                .epoch = 1.0, .force = force[i] / t, .turn = turn[j] / (t * t * t)};
}

/* The coarse rotation is made what is known by now. */
static void rebase(imk_alignment *a)
{
    imki_velocity_fit fit;
    if (imki_whitener_fit(&a->equal, &a->coarse, &fit) != IMK_OK)
        return;
    imki_whitener_rebase(&a->equal, &fit.change);
    for (size_t i = 0; i < a->whitener_count; i++)
        imki_whitener_rebase(&a->whitener[i], &fit.change);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a->coarse.m[i][j] += fit.change.m[i][j];
}

/* Each kind by itself, of unit strength. */
static const imki_velocity_noise unit_noise[IMKI_SPREADS] = {[IMKI_SPREAD_FORCE] = {.force = 1.0},
                                                             [IMKI_SPREAD_TURN] = {.turn = 1.0},
                                                             [IMKI_SPREAD_GROWTH] = {.growth = 1.0},
                                                             [IMKI_SPREAD_WALK] = {.walk = 1.0}};

void imki_alignment_inertial_close(imk_alignment *alignment)
{
    imk_alignment *a = alignment;
    imki_velocities *v = &a->velocities;
    const double step = a->epoch_time, per_time = 1.0 / step;
    const imk_vector3 reference = imki_scaled(per_time, v->epoch_reference);
    const imk_vector3 measured = imki_scaled(per_time, v->epoch_measured);
    const imk_vector3 difference =
        imki_difference(measured, imk_matrix3_apply(a->coarse, reference));
    const bool first = a->epochs == 0;
    if (first)
        start_whiteners(a);
    imki_whitener_add(&a->equal, step, reference, difference);
    for (size_t i = 0; i < a->whitener_count; i++)
        imki_whitener_add(&a->whitener[i], step, reference, difference);
    for (int kind = 0; kind < IMKI_SPREADS; kind++)
        imki_spread_add(&a->spread[kind], &unit_noise[kind], step, reference, first);
    a->reference_sum = imki_sum(a->reference_sum, reference);
    v->last_epoch = a->time;
    v->epoch_measured = v->epoch_reference = (imk_vector3){{0}};
    if (a->epochs + 1 == a->next_rebase) {
        rebase(a);
        a->next_rebase *= 2;
    }
}
