/* SPDX-License-Identifier: Apache-2.0 */
/* A step of a motion script as a function of time. With the speed v, the heading c, the climb angle
 * e, the bank r and the body's rotation in the vehicle q_b, all functions of time,
 *
 *     v_n  = v (cos e cos c, cos e sin c, -sin e),     q_nb = q_z(c) q_y(e) q_x(r) q_b;
 *
 * the velocity is the vehicle's forward axis, so it is v q_z(c) q_y(e) x. A step changes one of
 * them. A banked turn has r = atan(v c'/g), which leaves no specific force across the body.
 *
 * The coning motion is q_z(w t) q_x(a) q_z(-w t), written for the axis z: the axis is tilted by a
 * towards a direction that goes round, and the body does not follow it round. */
#include "script_step_internal.h"

#include "imukit/elementary.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Pieces that are tried first; what they miss of the tolerance makes them shorter. A steady turn by
 * 0.2 rad in a piece has 2e-11 of its rate w wrong, and 1e-9 w^2 of angular acceleration. */
static const double turn_per_piece = 0.2;
static const double pieces_per_ramp = 8.0;
static const double pieces_per_cycle = 16.0;

/* Slower than this after a step is rest: what rounding leaves of speeds that add up to zero. */
static const double rest_speed = 1e-10;

imki_vehicle imki_vehicle_start(const imk_motion_script *script)
{
    const imki_quaternion_jet yaw = imki_turn_axis(2, imki_jet_constant(script->mounting[2]));
    const imki_quaternion_jet pitch = imki_turn_axis(1, imki_jet_constant(script->mounting[1]));
    const imki_quaternion_jet roll = imki_turn_axis(0, imki_jet_constant(script->mounting[0]));
    const imk_quaternion body =
        imk_quaternion_multiply(imk_quaternion_multiply(yaw.d[0], pitch.d[0]), roll.d[0]);
    return (imki_vehicle){.speed = script->speed < rest_speed ? 0.0 : script->speed,
                          .heading = script->heading,
                          .climb = script->climb,
                          .body = imk_quaternion_normalise(body)};
}

static imki_local_motion compose(imki_jet speed, imki_jet heading, imki_jet climb, imki_jet bank,
                                 imki_quaternion_jet body)
{
    const imki_quaternion_jet level =
        imki_quaternion_jet_product(imki_turn_axis(2, heading), imki_turn_axis(1, climb));
    imki_quaternion_jet forward;
    for (int i = 0; i < 3; i++)
        forward.d[i] = (imk_quaternion){0.0, speed.d[i], 0.0, 0.0};
    return (imki_local_motion){
        .attitude = imki_quaternion_jet_product(
            imki_quaternion_jet_product(level, imki_turn_axis(0, bank)), body),
        .velocity = imki_quaternion_jet_rotate(level, forward)};
}

imki_local_motion imki_vehicle_motion(const imki_vehicle *vehicle)
{
    return compose(imki_jet_constant(vehicle->speed), imki_jet_constant(vehicle->heading),
                   imki_jet_constant(vehicle->climb), imki_jet_constant(0.0),
                   imki_quaternion_constant(vehicle->body));
}

static bool has_profile(imk_step_kind kind)
{
    return kind == IMK_STEP_ACCELERATE || kind == IMK_STEP_TURN || kind == IMK_STEP_CLIMB ||
           kind == IMK_STEP_ROTATE;
}

double imki_step_duration(const imk_motion_step *step, double smoothing)
{
    if (!has_profile(step->kind))
        return step->duration;
    const imki_profile profile = imki_profile_make(step->amount, step->rate, smoothing);
    return imki_profile_length(&profile);
}

/* The rotation about one axis from the present attitude to a stated one. */
static void begin_pose(imki_step_run *run)
{
    const imki_vehicle *vehicle = &run->begin;
    const double *angle = run->step->angle;
    const imki_vehicle stated = {.heading = angle[2], .climb = angle[1], .body = {1.0, 0, 0, 0}};
    const imk_quaternion now = imki_vehicle_motion(vehicle).attitude.d[0];
    const imk_quaternion then =
        imk_quaternion_multiply(imki_vehicle_motion(&stated).attitude.d[0],
                                imki_turn_axis(0, imki_jet_constant(angle[0])).d[0]);
    imk_quaternion turn = imk_quaternion_multiply(imk_quaternion_conjugate(now), then);
    if (turn.w < 0.0)
        turn = (imk_quaternion){-turn.w, -turn.x, -turn.y, -turn.z};
    const imk_vector3 vector = {{turn.x, turn.y, turn.z}};
    const double sine = imk_vector3_norm(vector);
    run->axis = sine > 0.0 ? imk_vector3_scale(vector, 1.0 / sine) : (imk_vector3){{1.0, 0, 0}};
    run->angle = 2.0 * imk_atan2(sine, turn.w);
}

/* Growth lasts whole cycles, at least one and at least the smoothing time, but at most half of the
 * step. */
static double growth_of(const imk_motion_step *step, double smoothing)
{
    const double half = floor(0.5 * step->frequency * step->duration * (1.0 + 1e-12));
    const double due = ceil(smoothing * step->frequency * (1.0 - 1e-12));
    return fmax(1.0, fmin(due, half)) / step->frequency;
}

static imki_quaternion_jet body_rotation(const imki_step_run *run, double time)
{
    const imk_motion_step *step = run->step;
    const imki_quaternion_jet begin = imki_quaternion_constant(run->begin.body);
    const int axis = step->axis;
    imki_jet angle;
    switch (step->kind) {
    case IMK_STEP_ROTATE:
        return imki_quaternion_jet_product(
            begin, imki_turn_axis(axis, imki_profile_at(&run->profile, time)));
    case IMK_STEP_POSE:
        angle =
            imki_jet_product(imki_jet_constant(run->angle), imki_smooth_step(time, run->duration));
        return imki_quaternion_jet_product(begin, imki_turn(run->axis, angle));
    case IMK_STEP_SWING:
    case IMK_STEP_CONING:
        break;
    default:
        return begin;
    }
    /* Before the middle it grows, behind it the time runs backwards: odd derivatives change sign.
     */
    const bool late = time > 0.5 * run->duration;
    imki_jet envelope = imki_smooth_step(late ? run->duration - time : time, run->growth);
    envelope.d[1] = late ? -envelope.d[1] : envelope.d[1];
    envelope.d[3] = late ? -envelope.d[3] : envelope.d[3];
    angle = imki_jet_product(imki_jet_constant(step->amount), envelope);
    if (step->kind == IMK_STEP_SWING) {
        angle = imki_jet_product(angle, imki_jet_sine(time, step->frequency));
        return imki_quaternion_jet_product(begin, imki_turn_axis(axis, angle));
    }
    const double cycles = time * step->frequency, w = 2.0 * PI * step->frequency;
    const double phase = 2.0 * PI * (cycles - floor(cycles));
    const imki_quaternion_jet there = imki_turn_axis(axis, (imki_jet){{phase, w, 0.0, 0.0}});
    const imki_quaternion_jet back = imki_turn_axis(axis, (imki_jet){{-phase, -w, 0.0, 0.0}});
    const imki_quaternion_jet tilt = imki_turn_axis((axis + 1) % 3, angle);
    return imki_quaternion_jet_product(
        begin, imki_quaternion_jet_product(imki_quaternion_jet_product(there, tilt), back));
}

imki_local_motion imki_step_motion(const imki_step_run *run, double time)
{
    imki_jet speed = imki_jet_constant(run->begin.speed);
    imki_jet heading = imki_jet_constant(run->begin.heading);
    imki_jet climb = imki_jet_constant(run->begin.climb);
    imki_jet bank = imki_jet_constant(0.0);
    imki_jet *changed = NULL;
    switch (run->step->kind) {
    case IMK_STEP_ACCELERATE:
        changed = &speed;
        break;
    case IMK_STEP_TURN:
        changed = &heading;
        break;
    case IMK_STEP_CLIMB:
        changed = &climb;
        break;
    default:
        break;
    }
    if (changed) {
        const double begin = changed->d[0];
        *changed = imki_profile_at(&run->profile, time);
        changed->d[0] += begin;
    }
    if (run->step->kind == IMK_STEP_TURN && run->step->banked) {
        const double factor = run->begin.speed / run->gravity;
        bank = imki_jet_arc_tangent(
            (imki_jet){{factor * heading.d[1], factor * heading.d[2], factor * heading.d[3], 0.0}});
    }
    return compose(speed, heading, climb, bank, body_rotation(run, time));
}

static void add_stretch(imki_step_run *run, double end, double spacing, bool even)
{
    run->stretch[run->stretch_count++] = (imki_stretch){end, spacing, even};
}

/* Two ramps and what is between them. */
static void three_stretches(imki_step_run *run, double ramp, double ramp_spacing, double spacing,
                            bool even)
{
    add_stretch(run, ramp, fmin(ramp_spacing, spacing), false);
    /* A plateau that is nothing beside the ramps is a part of the second one. */
    if (run->duration - 2.0 * ramp > 1e-3 * ramp)
        add_stretch(run, run->duration - ramp, spacing, even);
    add_stretch(run, run->duration, fmin(ramp_spacing, spacing), false);
}

static void divide(imki_step_run *run)
{
    const imk_motion_step *step = run->step;
    const double ramp = run->profile.ramp, ramp_spacing = ramp / pieces_per_ramp;
    const double turning = turn_per_piece / fmax(fabs(run->profile.peak), 1e-300);
    double spacing;
    switch (step->kind) {
    case IMK_STEP_HOLD:
        add_stretch(run, run->duration, (double)INFINITY, true);
        break;
    case IMK_STEP_ACCELERATE:
        three_stretches(run, ramp, ramp_spacing, (double)INFINITY, true);
        break;
    case IMK_STEP_TURN:
    case IMK_STEP_CLIMB:
        three_stretches(run, ramp, ramp_spacing, turning, run->begin.speed == 0.0);
        break;
    case IMK_STEP_ROTATE:
        three_stretches(run, ramp, ramp_spacing, turning, true);
        break;
    case IMK_STEP_POSE: /* the rate is at most 15/8 of its mean */
        spacing = run->duration *
                  fmin(1.0 / pieces_per_ramp, turn_per_piece / fmax(1.875 * run->angle, 1e-300));
        add_stretch(run, run->duration, spacing, false);
        break;
    case IMK_STEP_SWING:
    case IMK_STEP_CONING:
        spacing = fmin(1.0 / pieces_per_cycle,
                       turn_per_piece / (2.0 * PI * fmax(fabs(step->amount), 1e-300))) /
                  step->frequency;
        three_stretches(run, run->growth, spacing, spacing, false);
        break;
    }
}

imki_step_run imki_step_begin(const imk_motion_step *step, double smoothing, imki_vehicle vehicle,
                              double gravity)
{
    imki_step_run run = {.step = step, .begin = vehicle, .end = vehicle, .gravity = gravity};
    double amount = step->amount;
    imki_vehicle *end = &run.end;
    switch (step->kind) {
    case IMK_STEP_ACCELERATE:
        end->speed = vehicle.speed + amount;
        if (fabs(end->speed) < rest_speed)
            end->speed = 0.0;
        amount = end->speed - vehicle.speed;
        break;
    case IMK_STEP_TURN:
        end->heading = vehicle.heading + amount;
        break;
    case IMK_STEP_CLIMB:
        end->climb = vehicle.climb + amount;
        break;
    case IMK_STEP_POSE:
        begin_pose(&run);
        break;
    case IMK_STEP_SWING:
    case IMK_STEP_CONING:
        run.growth = growth_of(step, smoothing);
        break;
    default:
        break;
    }
    run.duration = imki_step_duration(step, smoothing);
    if (has_profile(step->kind))
        run.profile = imki_profile_make(amount, step->rate, smoothing);
    if (step->kind == IMK_STEP_ROTATE || step->kind == IMK_STEP_POSE)
        end->body = imk_quaternion_normalise(body_rotation(&run, run.duration).d[0]);
    divide(&run);
    return run;
}
