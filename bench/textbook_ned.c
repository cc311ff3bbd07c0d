/* SPDX-License-Identifier: Apache-2.0 */
/* With L the latitude, h the height, R_N and R_E the radii of curvature, w the Earth's rate:
 *
 *     w_ie = w (cos L, 0, -sin L)
 *     w_en = (v_E/(R_E + h), -v_N/(R_N + h), -v_E tan L/(R_E + h))
 *     phi  = a + (a_last x a)/12
 *     u'   = u + (a x u)/2 + (a_last x u + u_last x a)/12
 *     v'   = v + C_nb u' - (w_in dt/2) x C_nb u' + [g - (2 w_ie + w_en) x v] dt
 *     h'   = h - (v_D + v_D') dt/2,     L' = L + [v_N/(R_N + h) + v_N'/(R_N + h')] dt/2
 *     longitude' = longitude + [v_E/((R_E + h) cos L) + v_E'/((R_E' + h') cos L')] dt/2
 *     q'   = q(-w_in dt) q q(phi)
 *
 * [GROVES2013, eqs. 5.41, 5.44, 5.53, 5.54, 5.56; TITTERTON2004, sections 11.2.4 and 11.3.2] */
#include "textbook_ned.h"

#include <math.h>

/* WGS84 [NIMA-TR8350.2]. */
static const double semi_major_axis = 6378137.0, flattening = 1.0 / 298.257223563;
static const double eccentricity_squared = 6.69437999014e-3, earth_rate = 7.292115e-5;

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double normal_gravity(double sine, double height)
{
    const double s = sine * sine, a = semi_major_axis;
    const double surface =
        9.7803253359 * (1.0 + 1.93185265241e-3 * s) / sqrt(1.0 - eccentricity_squared * s);
    return surface *
           (1.0 - 2.0 / a * (1.0 + flattening + 3.44978650684e-3 - 2.0 * flattening * s) * height +
            3.0 * height * height / (a * a));
}

/* Toward the equator, of first order in height. */
static double gravity_north(double sine, double cosine, double height)
{
    return -8.1491e-9 * (2.0 * sine * cosine) * height * (1.0 - 0.7272 * height / semi_major_axis);
}

static void rotation_quaternion(const double v[3], double q[4])
{
    const double angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double scale = angle > 0.0 ? sin(0.5 * angle) / angle : 0.5;
    q[0] = cos(0.5 * angle);
    for (int i = 0; i < 3; i++)
        q[i + 1] = scale * v[i];
}

static void multiply(const double a[4], const double b[4], double out[4])
{
    out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

static void apply(const double q[4], const double v[3], double out[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double c[3][3] = {
        {w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
        {2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)},
        {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    for (int i = 0; i < 3; i++)
        out[i] = c[i][0] * v[0] + c[i][1] * v[1] + c[i][2] * v[2];
}

/* Rotation vector and velocity increment of the body over the step. */
static void integrate_body(const textbook_ned *s, const double angle[3], const double velocity[3],
                           double turn[3], double gain[3])
{
    double coning[3] = {0}, sculling_a[3] = {0}, sculling_b[3] = {0}, rotation[3];
    cross(angle, velocity, rotation);
    if (s->samples > 1) {
        cross(s->last_angle, angle, coning);
        cross(s->last_angle, velocity, sculling_a);
        cross(s->last_velocity, angle, sculling_b);
    }
    for (int i = 0; i < 3; i++) {
        turn[i] = angle[i] + coning[i] / 12.0;
        gain[i] = velocity[i] + 0.5 * rotation[i] + (sculling_a[i] + sculling_b[i]) / 12.0;
    }
}

static void advance_attitude(textbook_ned *s, const double earth_turn[3], const double turn[3])
{
    double body[4], back[4], between[4], q[4];
    const double axes[3] = {-earth_turn[0], -earth_turn[1], -earth_turn[2]};
    rotation_quaternion(turn, body);
    rotation_quaternion(axes, back);
    multiply(s->attitude, body, between);
    multiply(back, between, q);
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++)
        s->attitude[i] = q[i] / length;
}

void textbook_ned_step(textbook_ned *s, double dt, const double angle[3], const double velocity[3])
{
    const double sine = sin(s->latitude), cosine = cos(s->latitude);
    const double *v = s->velocity, height = s->height;
    const double root = sqrt(1.0 - eccentricity_squared * sine * sine);
    const double east_radius = semi_major_axis / root;
    const double north_radius = east_radius * (1.0 - eccentricity_squared) / (root * root);

    const double earth[3] = {earth_rate * cosine, 0.0, -earth_rate * sine};
    const double transport[3] = {v[1] / (east_radius + height), -v[0] / (north_radius + height),
                                 -v[1] * tan(s->latitude) / (east_radius + height)};
    double twice[3], turned[3];
    for (int i = 0; i < 3; i++) {
        twice[i] = 2.0 * earth[i] + transport[i];
        turned[i] = (earth[i] + transport[i]) * dt;
    }

    double turn[3], gain[3], force[3], lag[3], coriolis[3], next[3];
    integrate_body(s, angle, velocity, turn, gain);
    apply(s->attitude, gain, force);
    cross(turned, force, lag);
    cross(twice, v, coriolis);
    for (int i = 0; i < 3; i++)
        next[i] = v[i] + force[i] - 0.5 * lag[i] - coriolis[i] * dt;
    next[0] += gravity_north(sine, cosine, height) * dt;
    next[2] += normal_gravity(sine, height) * dt;

    s->height -= 0.5 * dt * (v[2] + next[2]);
    s->latitude +=
        0.5 * dt * (v[0] / (north_radius + height) + next[0] / (north_radius + s->height));
    const double new_sine = sin(s->latitude);
    const double new_radius =
        semi_major_axis / sqrt(1.0 - eccentricity_squared * new_sine * new_sine);
    s->longitude += 0.5 * dt *
                    (v[1] / ((east_radius + height) * cosine) +
                     next[1] / ((new_radius + s->height) * cos(s->latitude)));

    advance_attitude(s, turned, turn);
    for (int i = 0; i < 3; i++) {
        s->velocity[i] = next[i];
        s->last_angle[i] = angle[i];
        s->last_velocity[i] = velocity[i];
    }
}
