/* SPDX-License-Identifier: Apache-2.0 */
/* Readings of aids, as measurements of the errors. A reading at a time within the last sample is
 * compared with the state there: the mechanisation's way over the sample, by a cubic in the
 * position and a turn at a constant rate, from the estimate at its end. What it says of the errors
 * there is what it says of those at the end, by the transition back over the time between.
 *
 * With p, v, C the state, l the lever arm, w_ib the rate, w the Earth's, e the attitude error, x_b
 * the errors that the gyros' bias estimates leave, x_l = l - l(estimated):
 *
 *     position   P = p + C l             dP = dr - [C l x] e - C x_l
 *     velocity   V = v + C (w_ib x l) - w x C l
 *                dV = dv - [C (w_ib x l) x] e + [w x] [C l x] e - C [l x] x_b
 *                     - (C [w_ib x] - [w x] C) x_l
 *     odometer   U = C^T v + (w_ib - C^T w) x l
 *                dU = C^T dv + C^T [v x] e + [l x] C^T [w x] e - [l x] x_b - [(w_ib - C^T w) x] x_l
 *     heading    a of u = C x, north-east-down: da = d_D - u_D (u_N d_N + u_E d_E)/(u_N^2 + u_E^2),
 *                d = e + (-dr_E/R, dr_N/R, dr_E tan(L)/R), as north and the vertical are elsewhere
 *
 * An estimated correlated error is added to the prediction; what it leaves, x_c, is -1 in H. The
 * white noise of the rate, mean of a sample, is noise of V and U by the lever arm. */
#include "navigation_filter_internal.h"

#include "imukit/earth.h"

#include <math.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS };

static const double half_turn = 3.14159265358979323846;

/* The state at the time of a reading, and what a lever arm adds to it. */
typedef struct situation {
    imk_vector3 position, velocity;
    imk_matrix3 c, axes; /* C_eb; north, east, down */
    imk_vector3 rate;    /* w_ib */
    imk_vector3 arm;     /* l, estimated */
} situation;

static const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};

static imk_matrix3 cross_of(imk_vector3 a)
{
    return (imk_matrix3){{{0.0, -a.v[2], a.v[1]}, {a.v[2], 0.0, -a.v[0]}, {-a.v[1], a.v[0], 0.0}}};
}

static imk_matrix3 combine(imk_matrix3 a, double factor, imk_matrix3 b)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a.m[i][j] += factor * b.m[i][j];
    return a;
}

/* Where the mechanisation was a time `back` before the end of the sample, carried to the estimate
 * at its end. */
static situation look_back(const imk_navigation_filter *f, double back)
{
    const imki_last_sample *s = &f->last;
    const imk_navigation_state *now = &f->strapdown.state;
    situation out = {.position = now->position, .velocity = now->velocity, .c = f->attitude};
    if (back > 0.0) {
        const double dt = s->dt, part = back / dt, u = 1.0 - part;
        const double cubic = part * part * (1.0 + 2.0 * u); /* 1 at the sample's begin */
        for (int i = 0; i < 3; i++) {
            const double way = s->before.position.v[i] - s->after.position.v[i];
            const double gain = s->before.velocity.v[i] - s->after.velocity.v[i];
            out.position.v[i] +=
                cubic * way +
                dt * u * part * (part * s->before.velocity.v[i] - u * s->after.velocity.v[i]) -
                back * (now->velocity.v[i] - s->after.velocity.v[i]);
            out.velocity.v[i] += part * gain;
        }
        const imk_quaternion turn =
            imk_quaternion_from_rotation_vector(imk_vector3_scale(s->rate, -back));
        out.c = imk_quaternion_to_matrix(imk_quaternion_multiply(now->attitude, turn));
    }
    out.rate = s->rate;
    const imk_geodetic place = imk_geodetic_from_ecef(out.position);
    out.axes = imk_ned_axes(place.latitude, place.longitude);
    return out;
}

/* Rows of H: `out` of three axes on three errors at the time of the reading. */
typedef struct response {
    imk_matrix3 position, velocity, attitude, gyro, arm;
    bool has_gyro, has_arm;
} response;

static imk_matrix3 turned_arm(const situation *s)
{
    return cross_of(imk_matrix3_apply(s->c, s->arm));
}

static imk_vector3 point(const situation *s)
{
    return imk_vector3_add(s->position, imk_matrix3_apply(s->c, s->arm));
}

static response point_response(const situation *s)
{
    const imk_matrix3 to = imk_matrix3_transpose(s->axes);
    response r = {.position = to, .has_arm = true};
    r.attitude = combine(r.attitude, -1.0, imk_matrix3_multiply(to, turned_arm(s)));
    r.arm = combine(r.arm, -1.0, imk_matrix3_multiply(to, s->c));
    return r;
}

static imk_vector3 point_velocity(const situation *s)
{
    const imk_vector3 arm = imk_matrix3_apply(s->c, s->arm);
    const imk_vector3 swept = imk_matrix3_apply(s->c, imk_vector3_cross(s->rate, s->arm));
    return imk_vector3_add(s->velocity, imk_vector3_subtract(swept, imk_vector3_cross(earth, arm)));
}

static response velocity_response(const situation *s)
{
    const imk_matrix3 to = imk_matrix3_transpose(s->axes), w = cross_of(earth);
    const imk_vector3 swept = imk_matrix3_apply(s->c, imk_vector3_cross(s->rate, s->arm));
    response r = {.velocity = to, .has_arm = true, .has_gyro = true};
    const imk_matrix3 attitude =
        combine(imk_matrix3_multiply(w, turned_arm(s)), -1.0, cross_of(swept));
    const imk_matrix3 arm =
        combine(imk_matrix3_multiply(w, s->c), -1.0, imk_matrix3_multiply(s->c, cross_of(s->rate)));
    r.attitude = imk_matrix3_multiply(to, attitude);
    r.arm = imk_matrix3_multiply(to, arm);
    r.gyro = combine(r.gyro, -1.0,
                     imk_matrix3_multiply(to, imk_matrix3_multiply(s->c, cross_of(s->arm))));
    return r;
}

/* Rate relative to the Earth, body axes. */
static imk_vector3 turn_rate(const situation *s)
{
    return imk_vector3_subtract(s->rate, imk_matrix3_apply(imk_matrix3_transpose(s->c), earth));
}

static imk_vector3 body_velocity(const situation *s)
{
    return imk_vector3_add(imk_matrix3_apply(imk_matrix3_transpose(s->c), s->velocity),
                           imk_vector3_cross(turn_rate(s), s->arm));
}

static response body_response(const situation *s)
{
    const imk_matrix3 back = imk_matrix3_transpose(s->c), arm = cross_of(s->arm);
    response r = {.velocity = back, .has_arm = true, .has_gyro = true};
    r.attitude = combine(imk_matrix3_multiply(back, cross_of(s->velocity)), 1.0,
                         imk_matrix3_multiply(arm, imk_matrix3_multiply(back, cross_of(earth))));
    r.gyro = combine(r.gyro, -1.0, arm);
    r.arm = combine(r.arm, -1.0, cross_of(turn_rate(s)));
    return r;
}

/* First row only. @return false: there is no heading */
static bool heading_response(const situation *s, double *heading, response *r)
{
    const imk_vector3 forward = {{s->c.m[0][0], s->c.m[1][0], s->c.m[2][0]}};
    const imk_vector3 u = imk_matrix3_apply(imk_matrix3_transpose(s->axes), forward);
    const double level = u.v[0] * u.v[0] + u.v[1] * u.v[1];
    const double axis = hypot(s->position.v[0], s->position.v[1]);
    if (!(level > 1e-4) || !(axis > 1e3))
        return false;
    const double tilt = -u.v[2] / level;
    const double sine = -s->axes.m[2][2]; /* of the latitude: down is -(…, sin L) */
    *heading = atan2(u.v[1], u.v[0]);
    *r = (response){.has_arm = false};
    const double radius = axis / sqrt(1.0 - sine * sine);
    for (int i = 0; i < 3; i++) {
        const double north = s->axes.m[i][0], east = s->axes.m[i][1];
        r->attitude.m[0][i] = s->axes.m[i][2] + tilt * (u.v[0] * north + u.v[1] * east);
        r->position.m[0][i] = east * sine / axis - tilt * (u.v[0] * east - u.v[1] * north) / radius;
    }
    return true;
}

/* Prediction minus reading, on the axes of the kind. @return false: it has none */
static bool predict(imk_aid_kind kind, const double value[3], const situation *s, double z[3],
                    response *r)
{
    imk_vector3 off = {{0}};
    switch (kind) {
    case IMK_AID_POSITION:
        *r = point_response(s);
        off = imk_matrix3_apply(
            imk_matrix3_transpose(s->axes),
            imk_vector3_subtract(
                point(s), imk_ecef_from_geodetic((imk_geodetic){value[0], value[1], value[2]})));
        break;
    case IMK_AID_VELOCITY:
        *r = velocity_response(s);
        off = imk_matrix3_apply(imk_matrix3_transpose(s->axes), point_velocity(s));
        for (int i = 0; i < 3; i++)
            off.v[i] -= value[i];
        break;
    case IMK_AID_ZERO_VELOCITY:
        *r = (response){.velocity = imk_matrix3_transpose(s->axes)};
        off = imk_matrix3_apply(r->velocity, s->velocity);
        break;
    case IMK_AID_ODOMETER:
        *r = body_response(s);
        off = body_velocity(s);
        for (int i = 0; i < 3; i++)
            off.v[i] -= value[i];
        break;
    case IMK_AID_HEIGHT: {
        const response all = point_response(s);
        *r = (response){.has_arm = true};
        for (int i = 0; i < 3; i++) {
            r->position.m[0][i] = -all.position.m[2][i];
            r->attitude.m[0][i] = -all.attitude.m[2][i];
            r->arm.m[0][i] = -all.arm.m[2][i];
        }
        off.v[0] = imk_geodetic_from_ecef(point(s)).height - value[0];
        break;
    }
    case IMK_AID_HEADING:
        if (!heading_response(s, &off.v[0], r))
            return false;
        off.v[0] = remainder(off.v[0] - value[0], 2.0 * half_turn);
        break;
    case IMK_AID_KIND_COUNT:
        return false;
    }
    for (int i = 0; i < 3; i++)
        z[i] = off.v[i];
    return true;
}

/* Row `axis` of a response into row `row` of H, for the errors at the end of the sample. */
static void put_row(const imk_navigation_filter *f, size_t aid, const response *r, int axis,
                    const imki_filter_step *back, double *h)
{
    const double *at[3] = {r->position.m[axis], r->velocity.m[axis], r->attitude.m[axis]};
    double nine[ERRORS], bias[2][3] = {{0}};
    for (int i = 0; i < ERRORS; i++)
        nine[i] = at[i / 3][i % 3];
    for (int i = 0; i < ERRORS; i++)
        for (int j = 0; j < ERRORS; j++)
            h[j] += nine[i] * (back ? back->phi[i][j] : i == j ? 1.0 : 0.0);
    for (int i = 0; i < 3; i++) {
        bias[IMKI_GYRO_PART][i] = r->has_gyro ? r->gyro.m[axis][i] : 0.0;
        for (int k = 0; k < ERRORS && back; k++) {
            bias[IMKI_GYRO_PART][i] += nine[k] * back->gamma[IMKI_GYRO_PART][k][i];
            bias[IMKI_ACCEL_PART][i] += nine[k] * back->gamma[IMKI_ACCEL_PART][k][i];
        }
    }
    size_t state = ERRORS;
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (int i = 0; i < 3; i++)
                h[state++] = bias[sensor][i];
    if (f->aid_places[aid].correlated > 0)
        h[f->aid_places[aid].correlated + (size_t)axis] = -1.0;
    for (int i = 0; i < 3 && r->has_arm && f->aid_places[aid].lever_arm > 0; i++)
        h[f->aid_places[aid].lever_arm + (size_t)i] = r->arm.m[axis][i];
}

/* Covariance of what the gyros' white noise, mean of the last sample, does. */
static double rate_noise(const imk_navigation_filter *f, const response *r, int a, int b)
{
    double sum = 0.0;
    for (int k = 0; k < 3 && r->has_gyro && f->last.dt > 0.0; k++) {
        const double n = f->settings.gyro.white[k];
        sum += r->gyro.m[a][k] * r->gyro.m[b][k] * n * n / f->last.dt;
    }
    return sum;
}

/* The arm as described, and what was found of its error. */
static imk_vector3 lever_arm(const imk_navigation_filter *f, size_t aid)
{
    imk_vector3 arm;
    const size_t place = f->aid_places[aid].lever_arm;
    for (size_t i = 0; i < 3; i++)
        arm.v[i] = f->settings.aid[aid].lever_arm[i] +
                   (place > 0 ? f->aid_state[place - f->first_aid_state + i].estimate : 0.0);
    return arm;
}

/* The axes that are measured. @return false: none, or a number is not one */
static bool choose_axes(const imk_navigation_filter *f, const imk_aid *aid,
                        const imk_aid_reading *reading, double sigma[3], imki_measurement *m)
{
    for (size_t i = 0; i < imk_aid_axes(aid->kind); i++) {
        sigma[i] = reading->sigma[i] > 0.0 ? reading->sigma[i] : aid->sigma[i];
        const bool down = i == 2 && aid->kind != IMK_AID_ODOMETER;
        if (isinf(sigma[i]) || (down && f->settings.hold_height))
            continue;
        if (!(sigma[i] <= 1e100) || !isfinite(reading->value[i]))
            return false;
        m->axis[m->rows++] = (int)i;
    }
    return m->rows > 0 && !(aid->kind == IMK_AID_HEIGHT && f->settings.hold_height);
}

imk_aid_verdict imk_navigation_filter_aid(imk_navigation_filter *f, size_t aid,
                                          const imk_aid_reading *reading)
{
    double sigma[3], z[3];
    response r;
    imki_filter_step shift;
    imki_measurement m = {.compare = reading->compare};
    if (aid >= f->settings.aid_count || !choose_axes(f, &f->settings.aid[aid], reading, sigma, &m))
        return IMK_AID_NOT_USED;
    const double rounding = 1e-6 * f->last.dt + 1e-9 * fabs(f->strapdown.state.time);
    double back = f->strapdown.state.time - reading->time;
    if (!(back >= -rounding && back <= f->last.dt + rounding))
        return IMK_AID_NOT_USED;
    back = back < rounding ? 0.0 : fmin(back, f->last.dt);
    imki_navigation_filter_propagate(f);
    situation s = look_back(f, back);
    s.arm = lever_arm(f, aid);
    if (!predict(f->settings.aid[aid].kind, reading->value, &s, z, &r))
        return IMK_AID_NOT_USED;
    if (back > 0.0)
        imki_navigation_filter_shift(f, -back, &shift);
    const size_t correlated = f->aid_places[aid].correlated;
    for (size_t row = 0; row < m.rows; row++) {
        const int axis = m.axis[row];
        put_row(f, aid, &r, axis, back > 0.0 ? &shift : NULL, m.h + row * f->states);
        m.z[row] = z[axis];
        if (correlated > 0)
            m.z[row] += f->aid_state[correlated - f->first_aid_state + (size_t)axis].estimate;
        for (size_t q = 0; q < m.rows; q++)
            m.noise[row][q] =
                (row == q ? sigma[axis] * sigma[axis] : 0.0) + rate_noise(f, &r, axis, m.axis[q]);
    }
    return imki_navigation_filter_measure(f, aid, &m);
}
