/* SPDX-License-Identifier: Apache-2.0 */
/* The strapdown step with constant rate and force, solved for its increments, in the symbols of
 * strapdown.c:
 *
 *     q(p) = q* q(h) q'                                       a = p
 *     F    = v' - v - g dt + h x (v' + v) + h x S + h x (h x F)/8
 *     u    = (mean R(s p))^-1 C^T R(h/2) F
 *
 * S and F on the right depend on u, but through h: each round multiplies what is left by less
 * than h |p|/12 + h^2, so four settle it to rounding for steps up to 10 s. */
#include "strapdown_internal.h"

/* q(h) q: an attitude in the Earth axes of the start of the step. */
static imk_quaternion earth_turned_back(const imki_earth_turn *turn, imk_quaternion q)
{
    const double c = 1.0 - turn->cosine_to_one, s = turn->sine;
    return (imk_quaternion){c * q.w - s * q.z, c * q.x - s * q.y, c * q.y + s * q.x,
                            c * q.z + s * q.w};
}

/* Rotation vector of at most half a turn. */
static imk_vector3 rotation_vector(imk_quaternion q)
{
    const imk_vector3 u = {{q.x, q.y, q.z}};
    const double sine = imk_vector3_norm(u);
    if (!(sine > 0.0))
        return u;
    /* q and -q are the same attitude. */
    const double sign = q.w < 0.0 ? -1.0 : 1.0;
    return imki_scaled(sign * 2.0 * imk_atan2(sine, sign * q.w) / sine, u);
}

/* (I + first [p] + second [p]^2)^-1 = I - [p]/2 + c [p]^2,
 * c = (1 - (1 - second x^2)/(2 first))/x^2 = 1/12 + x^2/720 + x^4/30240 + ...      */
static imk_vector3 unturned(const imki_turn *turn, imk_vector3 p, imk_vector3 v)
{
    const double x2 = turn->square;
    double c;
    if (x2 < 0.0625)
        c = 1.0 / 12 +
            x2 * (1.0 / 720 +
                  x2 * (1.0 / 30240 + x2 * (1.0 / 1209600 +
                                            x2 * (1.0 / 47900160 + x2 * (691.0 / 1307674368e3)))));
    else
        c = (1.0 - (1.0 - turn->second * x2) / (2.0 * turn->first)) / x2;
    const imk_vector3 pv = imki_cross(p, v), ppv = imki_cross(p, pv);
    return imki_sum(v, imki_difference(imki_scaled(c, ppv), imki_scaled(0.5, pv)));
}

void imk_strapdown_invert(const imk_navigation_state *from, const imk_navigation_state *to,
                          imk_vector3 *angle, imk_vector3 *velocity)
{
    const double dt = to->time - from->time;
    const imki_earth_turn earth = imki_earth_turn_from(dt);
    const imk_quaternion start = imk_quaternion_normalise(from->attitude);
    const imk_quaternion end = earth_turned_back(&earth, imk_quaternion_normalise(to->attitude));
    const imk_quaternion back = imk_quaternion_conjugate(start);
    const imk_vector3 p = rotation_vector(imki_quaternion_product(back, end));
    const imki_turn turn = imki_turn_from(p);

    const imk_vector3 gravity = imki_gravity_midway(from, dt);
    const imk_vector3 fall = imki_scaled(dt, gravity);
    imk_vector3 gain = imki_difference(imki_difference(to->velocity, from->velocity), fall);
    const imk_vector3 both = imki_sum(to->velocity, from->velocity);
    gain.v[0] -= earth.angle * both.v[1];
    gain.v[1] += earth.angle * both.v[0];

    imk_vector3 force = gain, u = {{0}};
    for (int round = 0; round < 4; round++) {
        u = unturned(&turn, p, imki_rotated(back, imki_earth_half_turn(&earth, -1.0, force)));
        const imk_vector3 pu = imki_cross(p, u), ppu = imki_cross(p, pu);
        const imk_vector3 scrolling =
            imki_rotated(start, imki_sum(imki_scaled(turn.second - 0.5 * turn.first, pu),
                                         imki_scaled(turn.third - 0.5 * turn.second, ppu)));
        force = imki_difference(gain, imki_earth_turn_of_force(earth.angle, scrolling, force));
    }
    *angle = p;
    *velocity = u;
}
