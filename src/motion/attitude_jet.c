/* SPDX-License-Identifier: Apache-2.0 */
/* Products of turns, differentiated twice by the rule of Leibniz,
 *
 *     (a b)'' = a'' b + 2 a' b' + a b'',
 *
 * and the quintic Hermite polynomial between two instants. */
#include "attitude_jet_internal.h"

#include "imukit/elementary.h"

static imk_quaternion sum(imk_quaternion a, imk_quaternion b)
{
    return (imk_quaternion){a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}

static imk_quaternion scaled(imk_quaternion a, double factor)
{
    return (imk_quaternion){factor * a.w, factor * a.x, factor * a.y, factor * a.z};
}

imki_quaternion_jet imki_quaternion_constant(imk_quaternion q)
{
    return (imki_quaternion_jet){{q, {0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}}};
}

/* With half the angle h: q = (cos h, u sin h), its derivative by h p = (-sin h, u cos h),
 * q' = h' p,  q'' = h'' p - h'^2 q. */
imki_quaternion_jet imki_turn(imk_vector3 axis, imki_jet angle)
{
    const double sine = imk_sin(0.5 * angle.d[0]), cosine = imk_cos(0.5 * angle.d[0]);
    const imk_quaternion q = {cosine, sine * axis.v[0], sine * axis.v[1], sine * axis.v[2]};
    const imk_quaternion p = {-sine, cosine * axis.v[0], cosine * axis.v[1], cosine * axis.v[2]};
    const double rate = 0.5 * angle.d[1], acceleration = 0.5 * angle.d[2];
    return (imki_quaternion_jet){
        {q, scaled(p, rate), sum(scaled(p, acceleration), scaled(q, -rate * rate))}};
}

imki_quaternion_jet imki_turn_axis(int axis, imki_jet angle)
{
    imk_vector3 unit = {{0.0, 0.0, 0.0}};
    unit.v[axis] = 1.0;
    return imki_turn(unit, angle);
}

imki_quaternion_jet imki_quaternion_jet_product(imki_quaternion_jet a, imki_quaternion_jet b)
{
    const imk_quaternion *x = a.d, *y = b.d;
    imki_quaternion_jet product;
    product.d[0] = imk_quaternion_multiply(x[0], y[0]);
    product.d[1] = sum(imk_quaternion_multiply(x[1], y[0]), imk_quaternion_multiply(x[0], y[1]));
    product.d[2] =
        sum(sum(imk_quaternion_multiply(x[2], y[0]), imk_quaternion_multiply(x[0], y[2])),
            scaled(imk_quaternion_multiply(x[1], y[1]), 2.0));
    return product;
}

imki_quaternion_jet imki_quaternion_jet_rotate(imki_quaternion_jet q, imki_quaternion_jet v)
{
    imki_quaternion_jet conjugate;
    for (int i = 0; i < 3; i++)
        conjugate.d[i] = imk_quaternion_conjugate(q.d[i]);
    imki_quaternion_jet turned =
        imki_quaternion_jet_product(imki_quaternion_jet_product(q, v), conjugate);
    for (int i = 0; i < 3; i++)
        turned.d[i].w = 0.0; /* rounding, where it is not zero already */
    return turned;
}

imk_vector3 imki_quaternion_rate(imk_quaternion q, imk_quaternion derivative)
{
    const imk_quaternion p = imk_quaternion_multiply(imk_quaternion_conjugate(q), derivative);
    const double factor = 2.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (imk_vector3){{factor * p.x, factor * p.y, factor * p.z}};
}

/* What is left at the end when the first three terms are taken away, of the value, the slope and
 * the curvature, determines the other three. Adding 0.0 turns -0 into 0. */
void imki_quintic(const double first[3], const double last[3], double length, double *coefficient)
{
    const double h = length;
    const double value = last[0] - first[0] - h * (first[1] + 0.5 * h * first[2]);
    const double slope = h * (last[1] - first[1] - h * first[2]);
    const double curvature = h * h * (last[2] - first[2]);
    const double cube = h * h * h;
    coefficient[0] = first[0];
    coefficient[1] = first[1] + 0.0;
    coefficient[2] = 0.5 * first[2] + 0.0;
    coefficient[3] = (10.0 * value - 4.0 * slope + 0.5 * curvature) / cube + 0.0;
    coefficient[4] = (-15.0 * value + 7.0 * slope - curvature) / (cube * h) + 0.0;
    coefficient[5] = (6.0 * value - 3.0 * slope + 0.5 * curvature) / (cube * h * h) + 0.0;
}
