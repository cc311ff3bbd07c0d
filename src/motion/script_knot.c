/* SPDX-License-Identifier: Apache-2.0 */
/* From north-east-down to Earth-fixed axes, and from knots to pieces.
 *
 * Where the body is, the directions of north, east and down turn with the latitude B and longitude
 * L [GROVES2013, eq. 2.111],
 *
 *     B' = v_north/(R_m + h),     L' = v_east/((R_p + h) cos B),     h' = -v_down,
 *     q_en = q_z(L) q_y(-B - pi/2),     q_eb = q_en q_nb,     v_e = q_en v_n q_en*.
 *
 * Differentiating once more leaves out the change of the radii R_m and R_p along the way: less than
 * 0.01 B'^2, at 300 m/s 2e-11 rad/s^2. It makes the interpolation no worse than it is.
 *
 * Between two knots the quaternion and the velocity are quintic Hermite polynomials; the position
 * is the integral of the velocity, so it is continuous with its first three derivatives whatever
 * the rounding of positions. */
#include "script_knot_internal.h"

#include "imukit/elementary.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Of the interpolation against the script: rates [rad/s], also relative, and accelerations
 * [m/s^2]. */
static const double rate_tolerance = 1e-9, relative_rate_tolerance = 1e-10;
static const double acceleration_tolerance = 1e-7;

imki_script_frame imki_script_frame_of(const imk_motion_script *script)
{
    imki_script_frame frame = {.earth = script->earth, .place = script->place};
    if (script->earth)
        frame.origin = imk_ecef_from_geodetic(script->place);
    return frame;
}

static void components(imk_quaternion q, double component[4])
{
    component[0] = q.w;
    component[1] = q.x;
    component[2] = q.y;
    component[3] = q.z;
}

static bool is_moving(const imki_quaternion_jet *velocity)
{
    for (int i = 0; i < 3; i++)
        if (velocity->d[i].x != 0.0 || velocity->d[i].y != 0.0 || velocity->d[i].z != 0.0)
            return true;
    return false;
}

/* q_en with its derivatives. */
static imki_quaternion_jet axes_jet(imki_knot *knot, const imki_quaternion_jet *velocity)
{
    const imk_geodetic place = knot->place;
    imki_jet latitude = imki_jet_constant(place.latitude);
    imki_jet longitude = imki_jet_constant(place.longitude);
    if (knot->moving) {
        double meridian, prime_vertical;
        imk_curvature_radii(place.latitude, &meridian, &prime_vertical);
        const double sine = imk_sin(place.latitude), cosine = imk_cos(place.latitude);
        const double north = meridian + place.height, east = prime_vertical + place.height;
        const imk_quaternion v = velocity->d[0], a = velocity->d[1];
        const double climb = -v.z;
        latitude.d[1] = v.x / north;
        longitude.d[1] = v.y / (east * cosine);
        latitude.d[2] = (a.x - latitude.d[1] * climb) / north;
        longitude.d[2] = (a.y - longitude.d[1] * (climb * cosine - east * sine * latitude.d[1])) /
                         (east * cosine);
        knot->turning = fabs(latitude.d[1]) + fabs(longitude.d[1]);
    }
    imki_jet dip;
    for (int i = 0; i < 4; i++)
        dip.d[i] = -latitude.d[i];
    dip.d[0] -= 0.5 * PI;
    return imki_quaternion_jet_product(imki_turn_axis(2, longitude), imki_turn_axis(1, dip));
}

/* A body that stays where it is keeps its place to the last bit, so that rest is constant. */
static imk_geodetic place_of(const imki_script_frame *frame, imk_vector3 position,
                             const imki_knot *before)
{
    const double *p = position.v, *q = before->position.v;
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
        return before->place;
    return imk_geodetic_from_ecef(imk_vector3_add(frame->origin, position));
}

imki_knot imki_knot_make(const imki_script_frame *frame, double time, imk_vector3 position,
                         const imki_local_motion *motion, const imki_knot *before)
{
    imki_knot knot = {.time = time, .position = position, .place = frame->place};
    knot.moving = is_moving(&motion->velocity);
    if (!frame->earth) {
        knot.attitude = motion->attitude;
        knot.velocity = motion->velocity;
        return knot;
    }
    if (before)
        knot.place = place_of(frame, position, before);
    const imki_quaternion_jet axes = axes_jet(&knot, &motion->velocity);
    knot.attitude = imki_quaternion_jet_product(axes, motion->attitude);
    knot.velocity = imki_quaternion_jet_rotate(axes, motion->velocity);
    if (!before)
        return knot;
    /* The longitude jumps by a turn at 180 deg; both signs of q are the same attitude. */
    const imk_quaternion p = before->attitude.d[0], q = knot.attitude.d[0];
    if (p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0.0)
        for (int i = 0; i < 3; i++) {
            imk_quaternion *d = &knot.attitude.d[i];
            *d = (imk_quaternion){-d->w, -d->x, -d->y, -d->z};
        }
    return knot;
}

/* Polynomials of all components of a quaternion or vector between two instants. */
static void interpolate(const imki_quaternion_jet *first, const imki_quaternion_jet *last,
                        double length, double coefficient[4][6])
{
    double begin[3][4], end[3][4];
    for (int i = 0; i < 3; i++) {
        components(first->d[i], begin[i]);
        components(last->d[i], end[i]);
    }
    for (int k = 0; k < 4; k++) {
        const double from[3] = {begin[0][k], begin[1][k], begin[2][k]};
        const double to[3] = {end[0][k], end[1][k], end[2][k]};
        imki_quintic(from, to, length, coefficient[k]);
    }
}

/* Coefficients of the position, that at the start left out. */
static void integrate(const imki_knot *first, const imki_knot *last, double position[3][7])
{
    double velocity[4][6];
    interpolate(&first->velocity, &last->velocity, last->time - first->time, velocity);
    for (int k = 0; k < 3; k++) {
        position[k][0] = 0.0;
        for (int i = 0; i < 6; i++)
            position[k][i + 1] = velocity[k + 1][i] / (i + 1.0);
    }
}

imk_vector3 imki_knot_travel(const imki_knot *first, const imki_knot *last)
{
    const double length = last->time - first->time;
    double position[3][7];
    integrate(first, last, position);
    imk_vector3 travel;
    for (int k = 0; k < 3; k++) {
        double sum = position[k][6];
        for (int i = 5; i >= 0; i--)
            sum = sum * length + position[k][i];
        travel.v[k] = sum;
    }
    return travel;
}

imk_trajectory_piece imki_knot_piece(const imki_knot *first, const imki_knot *last)
{
    imk_trajectory_piece piece = {.start = first->time, .length = last->time - first->time};
    integrate(first, last, piece.position);
    for (int k = 0; k < 3; k++)
        piece.position[k][0] = first->position.v[k];
    interpolate(&first->attitude, &last->attitude, piece.length, piece.quaternion);
    return piece;
}

imk_trajectory_piece imki_knot_rest(const imki_knot *knot)
{
    imk_trajectory_piece piece = {.start = knot->time, .length = (double)INFINITY};
    double attitude[4];
    components(knot->attitude.d[0], attitude);
    for (int k = 0; k < 3; k++)
        piece.position[k][0] = knot->position.v[k];
    for (int k = 0; k < 4; k++)
        piece.quaternion[k][0] = attitude[k];
    return piece;
}

static double value_at(const double coefficient[6], double s)
{
    double sum = coefficient[5];
    for (int i = 4; i >= 0; i--)
        sum = sum * s + coefficient[i];
    return sum;
}

static double slope_at(const double coefficient[6], double s)
{
    double sum = 5.0 * coefficient[5];
    for (int i = 4; i >= 1; i--)
        sum = sum * s + i * coefficient[i];
    return sum;
}

/* The leading error term of a quintic Hermite polynomial is (x (1-x))^3; its derivative is largest
 * at 0.276 and 0.724 of the piece. */
bool imki_piece_is_good(const imki_step_run *run, const imki_local_motion *first, double first_time,
                        const imki_local_motion *last, double last_time)
{
    static const double place[2] = {0.276, 0.724};
    const double length = last_time - first_time;
    double attitude[4][6], velocity[4][6], q[4], p[4];
    interpolate(&first->attitude, &last->attitude, length, attitude);
    interpolate(&first->velocity, &last->velocity, length, velocity);
    for (int j = 0; j < 2; j++) {
        const double s = place[j] * length;
        const imki_local_motion due = imki_step_motion(run, first_time + s);
        for (int k = 0; k < 4; k++) {
            q[k] = value_at(attitude[k], s);
            p[k] = slope_at(attitude[k], s);
        }
        const imk_vector3 rate = imki_quaternion_rate((imk_quaternion){q[0], q[1], q[2], q[3]},
                                                      (imk_quaternion){p[0], p[1], p[2], p[3]});
        const imk_vector3 rate_due = imki_quaternion_rate(due.attitude.d[0], due.attitude.d[1]);
        const double rate_limit =
            rate_tolerance + relative_rate_tolerance * imk_vector3_norm(rate_due);
        const imk_vector3 acceleration = {{slope_at(velocity[1], s) - due.velocity.d[1].x,
                                           slope_at(velocity[2], s) - due.velocity.d[1].y,
                                           slope_at(velocity[3], s) - due.velocity.d[1].z}};
        if (!(imk_vector3_norm(imk_vector3_subtract(rate, rate_due)) <= rate_limit) ||
            !(imk_vector3_norm(acceleration) <= acceleration_tolerance))
            return false;
    }
    return true;
}
