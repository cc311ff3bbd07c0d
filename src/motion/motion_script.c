/* SPDX-License-Identifier: Apache-2.0 */
/* Compiling a motion script: step by step, and in each stretch of a step piece by piece, as long as
 * the interpolation allows. Where the body is at the next knot follows from the pieces behind it.
 * Counting pieces is compiling without keeping them. */
#include "imukit/motion_script.h"

#include "script_knot_internal.h"

#include <math.h>

#define QUARTER_TURN 1.57079632679489661923

/* On the move: pieces last so long, while nothing else makes them shorter, and the directions of
 * north and east turn by so much (near a pole the longitude changes fast). */
static const double cruise_spacing = 10.0;
static const double cruise_turning = 0.01;

/* Near the poles the heading is no help to steer by. 89.9 deg, in radians. */
static const double latitude_limit = 89.9 / 90.0 * QUARTER_TURN;

/* Pieces get shorter by this factor until they are good, but not shorter than a part of what was
 * tried first: rounding must not drive them down. */
static const double shrink = 0.8, growth = 1.25, smallest_part = 1.0 / 64.0;

/* The search for the next knot ends when it moves less than this [m], or after so many rounds. */
static const double round_end = 1e-9;
enum { rounds_most = 8 };

/* A compilation under way. */
typedef struct compiler {
    imki_script_frame frame;
    imki_vehicle vehicle;
    imki_local_motion motion; /* at the knot */
    imki_knot knot;           /* the last one */
    size_t index;             /* of the step */
    double start;             /* of the step */
    size_t count, capacity;
    imk_trajectory_piece *piece; /* NULL: only count */
    imk_error *error;
} compiler;

imk_motion_script imk_motion_script_default(void)
{
    return (imk_motion_script){.cookie = IMKI_MOTION_SCRIPT_COOKIE,
                               .earth = true,
                               .place = {.latitude = 0.5 * QUARTER_TURN},
                               .smoothing = 0.5};
}

double imk_motion_step_duration(const imk_motion_script *script, size_t index)
{
    return index < script->step_count ? imki_step_duration(&script->step[index], script->smoothing)
                                      : 0.0;
}

static imk_status check_place(const compiler *c)
{
    if (!c->knot.moving || !c->frame.earth)
        return IMK_OK;
    const imk_geodetic *place = &c->knot.place;
    if (!(fabs(place->latitude) <= latitude_limit))
        return imki_step_refuse(c->error, "step.latitude", c->index, place->latitude,
                                latitude_limit, "a path that stays 0.1 deg away from the poles");
    if (!(place->height >= -1e4 && place->height <= 1e7))
        return imki_step_refuse(c->error, "step.height", c->index, place->height,
                                place->height < 0.0 ? -1e4 : 1e7,
                                "a path at heights between -10 km and 10000 km");
    return IMK_OK;
}

static imk_status too_many(const compiler *c)
{
    return imki_step_refuse(
        c->error, "step", c->index, (double)c->count, IMK_MOTION_PIECES_MAX,
        "at most 1e7 pieces in all: use fewer turns and cycles, or less time on the way");
}

static imk_status keep(compiler *c, const imk_trajectory_piece *piece)
{
    if (c->count >= IMK_MOTION_PIECES_MAX)
        return too_many(c);
    if (c->piece) {
        if (c->count >= c->capacity)
            return imk_error_set(
                c->error, IMK_ERROR_WORKSPACE, "piece", "",
                "provide room for as many pieces as imk_motion_script_pieces() states");
        c->piece[c->count] = *piece;
    }
    c->count++;
    return IMK_OK;
}

/* Where the body would get from the last knot if its velocity went on changing as there. */
static imk_vector3 extrapolated(const imki_knot *knot, double length)
{
    const imk_quaternion v = knot->velocity.d[0], a = knot->velocity.d[1], j = knot->velocity.d[2];
    const double once = length, twice = 0.5 * length * length;
    const double thrice = twice * length / 3.0;
    return (imk_vector3){{knot->position.v[0] + once * v.x + twice * a.x + thrice * j.x,
                          knot->position.v[1] + once * v.y + twice * a.y + thrice * j.y,
                          knot->position.v[2] + once * v.z + twice * a.z + thrice * j.z}};
}

/* The next knot. The directions of its velocity depend on its place, and that on its velocity; an
 * error of the place comes back smaller by the length of the piece over the distance from the
 * Earth's axis: below 0.01 a round, most often 1e-5. What rounding leaves is not pursued. The
 * position is what the velocity says exactly. */
static imki_knot next_knot(const compiler *c, double time, const imki_local_motion *motion)
{
    imk_vector3 position = c->knot.position;
    imki_knot next = imki_knot_make(&c->frame, time, position, motion, &c->knot);
    if (!next.moving && !c->knot.moving)
        return next;
    imki_quaternion_jet velocity = next.velocity;
    position = extrapolated(&c->knot, time - c->knot.time);
    double change = (double)INFINITY;
    for (int i = 0; i < rounds_most && change > round_end; i++) {
        const imk_vector3 before = position;
        next = imki_knot_make(&c->frame, time, position, motion, &c->knot);
        velocity = next.velocity;
        position = imk_vector3_add(c->knot.position, imki_knot_travel(&c->knot, &next));
        change = imk_vector3_norm(imk_vector3_subtract(position, before));
    }
    next = imki_knot_make(&c->frame, time, position, motion, &c->knot);
    next.velocity = velocity;
    return next;
}

static imk_status advance(compiler *c, double time, const imki_local_motion *motion)
{
    if (!(time > c->knot.time))
        return imki_step_refuse(
            c->error, "step", c->index, time, c->knot.time,
            "a longer step: this one is lost in the rounding of the time so far");
    const imki_knot next = next_knot(c, time, motion);
    const imk_trajectory_piece piece = imki_knot_piece(&c->knot, &next);
    const imk_status status = keep(c, &piece);
    c->knot = next;
    c->motion = *motion;
    return status == IMK_OK ? check_place(c) : status;
}

/* Longest piece from the last knot on. */
static double longest(const compiler *c, double spacing)
{
    if (!c->knot.moving)
        return spacing;
    return fmin(fmin(spacing, cruise_spacing), cruise_turning / fmax(c->knot.turning, 1e-300));
}

/* The rest of a stretch in equal pieces no longer than `limit`: their number. */
static double parts_of(double rest, double limit)
{
    return fmax(1.0, ceil(rest / limit * (1.0 - 1e-12)));
}

/* Times are those of knots, rounded; the step is asked about the same, since the start is exact. */
static imk_status compile_stretch(compiler *c, const imki_step_run *run, int number)
{
    const imki_stretch *stretch = &run->stretch[number];
    const bool last_stretch = number + 1 == run->stretch_count;
    const double end = c->start + stretch->end;
    double spacing = stretch->spacing;
    imk_status status = IMK_OK;
    do {
        const double begin = c->knot.time, rest = end - begin;
        double limit = longest(c, spacing), time, parts;
        imki_local_motion motion;
        for (;;) {
            parts = parts_of(rest, limit);
            if (!(parts <= IMK_MOTION_PIECES_MAX))
                return too_many(c);
            time = parts > 1.0 ? begin + rest / parts : end;
            motion = parts == 1.0 && last_stretch ? imki_vehicle_motion(&run->end)
                                                  : imki_step_motion(run, time - c->start);
            if (stretch->even || !(time > begin) || !(limit > smallest_part * stretch->spacing) ||
                imki_piece_is_good(run, &c->motion, begin - c->start, &motion, time - c->start))
                break;
            limit *= shrink;
        }
        spacing = fmin(stretch->spacing, growth * limit);
        status = advance(c, time, &motion);
    } while (status == IMK_OK && c->knot.time < end);
    return status;
}

static imk_status compile_step(compiler *c, const imk_motion_script *script)
{
    const double gravity = imk_normal_gravity(c->knot.place.latitude, c->knot.place.height);
    const imki_step_run run =
        imki_step_begin(&script->step[c->index], script->smoothing, c->vehicle, gravity);
    if (!(run.end.speed >= 0.0))
        return imki_step_refuse(c->error, "step.amount", c->index, run.step->amount,
                                -c->vehicle.speed, "a change of speed that brakes at most to rest");
    if (!(run.end.speed <= IMKI_SPEED_LIMIT))
        return imki_step_refuse(c->error, "step.amount", c->index, run.step->amount,
                                IMKI_SPEED_LIMIT - c->vehicle.speed, "a speed below 100 km/s");
    imk_status status = IMK_OK;
    for (int i = 0; i < run.stretch_count && status == IMK_OK; i++)
        status = compile_stretch(c, &run, i);
    c->start += run.duration;
    c->vehicle = run.end;
    return status;
}

static imk_status compile(compiler *c, const imk_motion_script *script)
{
    imk_status status = imki_script_check(script, c->error);
    if (status != IMK_OK)
        return status;
    c->frame = imki_script_frame_of(script);
    c->vehicle = imki_vehicle_start(script);
    c->motion = imki_vehicle_motion(&c->vehicle);
    c->knot = imki_knot_make(&c->frame, 0.0, (imk_vector3){{0.0, 0.0, 0.0}}, &c->motion, NULL);
    status = check_place(c);
    for (c->index = 0; c->index < script->step_count && status == IMK_OK; c->index++)
        status = compile_step(c, script);
    if (status != IMK_OK || c->knot.moving)
        return status;
    const imk_trajectory_piece rest = imki_knot_rest(&c->knot);
    return keep(c, &rest);
}

imk_status imk_motion_script_pieces(const imk_motion_script *script, size_t *piece_count,
                                    imk_error *error)
{
    compiler c = {.error = error};
    const imk_status status = compile(&c, script);
    *piece_count = status == IMK_OK ? c.count : 0;
    return status;
}

imk_status imk_motion_script_compile(const imk_motion_script *script, imk_trajectory_piece *piece,
                                     size_t piece_count, imk_trajectory *trajectory,
                                     imk_error *error)
{
    compiler c = {.error = error, .piece = piece, .capacity = piece_count};
    const imk_status status = compile(&c, script);
    if (status != IMK_OK)
        return status;
    imk_trajectory made = {.earth = script->earth, .piece_count = c.count, .piece = piece};
    for (int i = 0; i < 3; i++)
        made.origin[i] = c.frame.origin.v[i];
    *trajectory = made;
    return IMK_OK;
}
