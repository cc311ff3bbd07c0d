/* SPDX-License-Identifier: Apache-2.0 */
/* Trajectories: a body at rest, checks, and the state at one instant. */
#include "trajectory_internal.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

#define HALF_TURN 3.14159265358979323846

/* Rotation by all lines about one axis: the series of the kernel hold below. */
#define LARGEST_VIBRATION 1.0 /* [rad] */

/* ---- at rest --------------------------------------------------------------------------------- */

static imk_status check_place(imk_geodetic place, imk_error *error)
{
    if (!(fabs(place.latitude) <= 0.5 * HALF_TURN))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "latitude", 0, place.latitude,
                              0.5 * HALF_TURN, "a latitude within a quarter turn of the equator");
    if (!(fabs(place.longitude) <= 2.0 * HALF_TURN))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "longitude", 0, place.longitude,
                              2.0 * HALF_TURN, "a longitude within one turn");
    if (!(place.height >= -1e4 && place.height <= 1e7))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "height", 0, place.height,
                              place.height < 0.0 ? -1e4 : 1e7, "a height from -10 km to 10000 km");
    return IMK_OK;
}

imk_status imk_trajectory_standstill(imk_geodetic place, const double roll_pitch_yaw[3], bool earth,
                                     imk_trajectory_piece *piece, imk_trajectory *trajectory,
                                     imk_error *error)
{
    static const char *const names[] = {"roll", "pitch", "yaw"};
    for (int i = 0; i < 3; i++)
        if (!(fabs(roll_pitch_yaw[i]) <= 1e3))
            return imki_refuse_at(error, IMK_ERROR_RANGE, names[i], (size_t)i, roll_pitch_yaw[i],
                                  1e3, "an angle");
    if (earth) {
        const imk_status status = check_place(place, error);
        if (status)
            return status;
    }
    imk_matrix3 axes =
        imk_matrix3_from_euler(roll_pitch_yaw[0], roll_pitch_yaw[1], roll_pitch_yaw[2]);
    memset(piece, 0, sizeof *piece);
    *trajectory = (imk_trajectory){.earth = earth, .piece_count = 1, .piece = piece};
    if (earth) {
        const imk_vector3 origin = imk_ecef_from_geodetic(place);
        memcpy(trajectory->origin, origin.v, sizeof origin.v);
        axes = imk_matrix3_multiply(imk_ned_axes(place.latitude, place.longitude), axes);
    }
    const imk_quaternion attitude = imk_quaternion_from_matrix(axes);
    piece->length = (double)INFINITY;
    piece->quaternion[0][0] = attitude.w;
    piece->quaternion[1][0] = attitude.x;
    piece->quaternion[2][0] = attitude.y;
    piece->quaternion[3][0] = attitude.z;
    return IMK_OK;
}

/* ---- checks ---------------------------------------------------------------------------------- */

static imk_quaternion polynomial_attitude(const imk_trajectory_piece *piece, double s)
{
    double q[4] = {0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < 4; i++)
        for (int power = 5; power >= 0; power--)
            q[i] = q[i] * s + piece->quaternion[i][power];
    return imk_quaternion_normalise((imk_quaternion){q[0], q[1], q[2], q[3]});
}

static double distance(const double a[3], const double b[3])
{
    const imk_vector3 difference = {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
    return imk_vector3_norm(difference);
}

static double size_of(const double a[3])
{
    return imk_vector3_norm((imk_vector3){{a[0], a[1], a[2]}});
}

static imk_status check_numbers(const imk_trajectory_piece *piece, size_t index, bool last,
                                imk_error *error)
{
    const double *const position = &piece->position[0][0];
    const double *const quaternion = &piece->quaternion[0][0];
    if (!isfinite(piece->start))
        return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "start", index, piece->start, 0.0, NULL);
    if (!(piece->length > 0.0) || (!last && isinf(piece->length)))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "length", index, piece->length, 0.0,
                              "a positive length, finite but for the last piece");
    for (size_t i = 0; i < 21; i++)
        if (!isfinite(position[i]))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "position", index, position[i], 0.0,
                                  NULL);
    double square = 0.0;
    for (size_t i = 0; i < 24; i++) {
        if (!isfinite(quaternion[i]))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "quaternion", index, quaternion[i],
                                  0.0, NULL);
        square += i % 6 == 0 ? quaternion[i] * quaternion[i] : 0.0;
    }
    if (!(square >= 0.01 && square <= 100.0))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "quaternion", index, square, 1.0,
                              "a quaternion of norm about 1");
    return IMK_OK;
}

/* Two pieces where they meet. The limits are far above rounding and far below what sensors see. */
static imk_status check_seam(const imk_trajectory_piece *before, const imk_trajectory_piece *after,
                             size_t index, imk_error *error)
{
    const double time = after->start;
    const double gap = fabs(time - (before->start + before->length));
    if (!(time > before->start) ||
        !(gap <= 1e-15 * fabs(time) * 8.0 || gap <= 1e-9 * before->length))
        return imki_refuse_at(error, IMK_ERROR_TIME_ORDER, "start", index, time,
                              before->start + before->length,
                              "start each piece at the end of the piece before it");
    /* free of gravity and vibration, so that force is the acceleration */
    const imk_trajectory bare = {.earth = false};
    imki_instant a, b;
    imki_instant_of(&bare, before, time, &a);
    imki_instant_of(&bare, after, time, &b);
    const imk_quaternion turn = imk_quaternion_multiply(
        imk_quaternion_conjugate(polynomial_attitude(before, before->length)),
        polynomial_attitude(after, 0.0));
    const struct {
        const char *name;
        double jump, limit;
    } checks[] = {
        {"attitude", 2.0 * size_of((double[]){turn.x, turn.y, turn.z}), 1e-7},
        {"position", distance(a.position, b.position), 1e-6 + 1e-9 * size_of(a.position)},
        {"velocity", distance(a.velocity, b.velocity), 1e-6 + 1e-9 * size_of(a.velocity)},
        {"angular rate", distance(a.rate, b.rate), 1e-6 * (1.0 + size_of(a.rate))},
        {"acceleration", distance(a.force, b.force), 1e-4 * (1.0 + size_of(a.force))},
    };
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++)
        if (!(checks[i].jump <= checks[i].limit))
            return imki_refuse_at(error, IMK_ERROR_CONFLICT, checks[i].name, index, checks[i].jump,
                                  checks[i].limit, "a motion without jumps where pieces meet");
    return IMK_OK;
}

/* Not so deep or so high that the formulas of gravity do not hold. */
static imk_status check_height(const imk_trajectory *trajectory, size_t index, double s,
                               imk_error *error)
{
    const imk_trajectory_piece *piece = &trajectory->piece[index];
    imk_vector3 position;
    for (int i = 0; i < 3; i++) {
        double p = piece->position[i][6];
        for (int power = 5; power >= 0; power--)
            p = p * s + piece->position[i][power];
        position.v[i] = trajectory->origin[i] + p;
    }
    const double radius = imk_vector3_norm(position);
    if (!(radius >= 6.34e6 && radius <= 1.64e7))
        return imki_refuse_at(error, IMK_ERROR_RANGE, "position", index, radius,
                              radius < 6.34e6 ? 6.34e6 : 1.64e7, "a place on or above the Earth");
    return IMK_OK;
}

static imk_status check_lines(const imk_trajectory *trajectory, imk_error *error)
{
    double sum[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    if (trajectory->line_count > IMK_VIBRATION_LINES_MAX ||
        (trajectory->line_count > 0 && !trajectory->line))
        return imki_refuse_at(error, IMK_ERROR_ARGUMENT, "vibration", trajectory->line_count,
                              (double)trajectory->line_count, IMK_VIBRATION_LINES_MAX,
                              "at most 512 lines");
    for (size_t i = 0; i < trajectory->line_count; i++) {
        const imk_vibration_line *line = &trajectory->line[i];
        if (line->axis < 0 || line->axis > 5)
            return imki_refuse_at(error, IMK_ERROR_RANGE, "vibration.axis", i, line->axis, 5.0,
                                  "an axis from 0 to 5");
        if (!(line->frequency >= IMK_VIBRATION_FREQUENCY_MIN &&
              line->frequency <= IMK_VIBRATION_FREQUENCY_MAX))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "vibration.frequency", i, line->frequency,
                                  line->frequency > 1.0 ? IMK_VIBRATION_FREQUENCY_MAX
                                                        : IMK_VIBRATION_FREQUENCY_MIN,
                                  "a frequency from 1e-6 Hz to 1e9 Hz");
        if (!(fabs(line->phase) <= 1e9))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "vibration.phase", i, line->phase, 1e9,
                                  "a phase in cycles");
        if (!isfinite(line->amplitude))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "vibration.amplitude", i,
                                  line->amplitude, 0.0, NULL);
        sum[line->axis] += fabs(line->amplitude);
        if (line->axis < 3 && !(sum[line->axis] <= IMK_VIBRATION_DISPLACEMENT_MAX))
            return imki_refuse_at(
                error, IMK_ERROR_RANGE, "vibration.amplitude", i, line->amplitude,
                IMK_VIBRATION_DISPLACEMENT_MAX,
                "at most 10 km for the displacements of all lines along an axis together");
        if (line->axis >= 3 &&
            !(fabs(line->amplitude) <= 0.1 && sum[line->axis] <= LARGEST_VIBRATION))
            return imki_refuse_at(error, IMK_ERROR_RANGE, "vibration.amplitude", i, line->amplitude,
                                  0.1,
                                  "at most 0.1 rad for a rotation, and 1 rad for all rotations "
                                  "about an axis together");
    }
    return IMK_OK;
}

imk_status imk_trajectory_validate(const imk_trajectory *trajectory, imk_error *error)
{
    const size_t count = trajectory->piece_count;
    if (count == 0 || !trajectory->piece)
        return imk_error_set(error, IMK_ERROR_EMPTY, "piece", NULL, "at least one piece");
    for (size_t i = 0; i < 3; i++)
        if (!isfinite(trajectory->origin[i]))
            return imki_refuse_at(error, IMK_ERROR_NOT_FINITE, "origin", i, trajectory->origin[i],
                                  0.0, NULL);
    for (size_t i = 0; i < count; i++) {
        imk_status status = check_numbers(&trajectory->piece[i], i, i + 1 == count, error);
        if (!status && i > 0)
            status = check_seam(&trajectory->piece[i - 1], &trajectory->piece[i], i, error);
        if (!status && trajectory->earth)
            status = check_height(trajectory, i, 0.0, error);
        if (status)
            return status;
    }
    if (trajectory->earth && isfinite(trajectory->piece[count - 1].length)) {
        const imk_status status =
            check_height(trajectory, count - 1, trajectory->piece[count - 1].length, error);
        if (status)
            return status;
    }
    return check_lines(trajectory, error);
}

void imk_trajectory_span(const imk_trajectory *trajectory, double *first, double *last)
{
    const imk_trajectory_piece *end = &trajectory->piece[trajectory->piece_count - 1];
    *first = trajectory->piece[0].start;
    *last = end->start + end->length;
}

size_t imk_trajectory_substeps(const imk_trajectory *trajectory, double dt)
{
    double highest = 0.0;
    for (size_t i = 0; i < trajectory->line_count; i++)
        if (trajectory->line[i].amplitude != 0.0)
            highest = fmax(highest, trajectory->line[i].frequency);
    const double parts = ceil(16.0 * highest * dt);
    return parts > 1.0 ? (size_t)fmin(parts, 1e9) : 1;
}

/* ---- the state at one instant ---------------------------------------------------------------- */

/* q_eb with vibration: about x, then y, then z, on the right. */
static imk_quaternion vibrating_attitude(imk_quaternion smooth, const double rotation[3])
{
    for (int i = 0; i < 3; i++) {
        imk_vector3 turn = {{0.0, 0.0, 0.0}};
        turn.v[i] = rotation[i];
        smooth = imk_quaternion_multiply(smooth, imk_quaternion_from_rotation_vector(turn));
    }
    return smooth;
}

void imk_trajectory_state(const imk_trajectory *trajectory, double time, imk_motion_state *state)
{
    imki_cursor cursor;
    imki_instant instant;
    imki_cursor_start(&cursor, trajectory, time);
    const imk_trajectory_piece *piece = imki_cursor_at(&cursor, time);
    imki_instant_of(trajectory, piece, time, &instant);
    memset(state, 0, sizeof *state);
    state->time = time;
    state->attitude = polynomial_attitude(piece, time - piece->start);
    if (trajectory->line_count > 0)
        state->attitude = vibrating_attitude(state->attitude, instant.rotation);
    state->c_nb = imk_quaternion_to_matrix(state->attitude);
    for (int i = 0; i < 3; i++) {
        state->position.v[i] = instant.position[i];
        state->velocity.v[i] = state->velocity_ned.v[i] = instant.velocity[i];
        state->angular_rate.v[i] = instant.rate[i];
        state->angular_acceleration.v[i] = instant.acceleration[i];
        state->specific_force.v[i] = instant.force[i];
    }
    if (!trajectory->earth)
        return;
    for (int i = 0; i < 3; i++)
        state->position.v[i] = trajectory->origin[i] + instant.position[i];
    state->place = imk_geodetic_from_ecef(state->position);
    const imk_matrix3 c_ne =
        imk_matrix3_transpose(imk_ned_axes(state->place.latitude, state->place.longitude));
    state->velocity_ned = imk_matrix3_apply(c_ne, state->velocity);
    state->c_nb = imk_matrix3_multiply(c_ne, state->c_nb);
}
