/* SPDX-License-Identifier: Apache-2.0 */
/* Radius of the circle about the origin that holds a part of a normal distribution in the plane. In
 * the axes of its ellipse, x along the longer one,
 *
 *   F(r) = integral over |y| <= r of  phi((y - m2)/s2)/s2
 *                                     [Phi((w - m1)/s1) - Phi((-w - m1)/s1)],  w = sqrt(r^2 - y^2),
 *
 * with the longer axis inside, so that a line (s2 = 0) is no special case. The integrand is cut
 * where it changes, at steps of the two sigmas about the two means, and each part integrated by
 * Gauss's rule: in t = (y - m2)/s2, or, where the circle's edge is among the values of y and the
 * root would spoil the rule, in the angle from there, y = r cos(a). For m = 0 this is the
 * distribution of Hoyt, for s1 = s2 that of Rice. */
#include "drift_radius_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* Beyond, a normal distribution has less than 4e-18. */
static const double tail = 8.8;
/* The edge of the circle is this far from all values of y, in sigmas: the root is then smooth. */
static const double clear = 3.5;

imki_ellipse imki_ellipse_of(double mean_x, double mean_y, double xx, double xy, double yy)
{
    const double half = 0.5 * (xx - yy), middle = 0.5 * (xx + yy);
    const double root = sqrt(half * half + xy * xy);
    const double major = middle + root;
    const double determinant = xx * yy - xy * xy;
    const double minor = major > 0.0 && determinant > 0.0 ? determinant / major : 0.0;
    /* Direction of the longer axis, from the difference that does not cancel. */
    double x = 1.0, y = 0.0;
    if (root > 0.0 && half >= 0.0) {
        x = half + root;
        y = xy;
    } else if (root > 0.0) {
        x = xy;
        y = root - half;
    }
    const double length = sqrt(x * x + y * y);
    x /= length;
    y /= length;
    return (imki_ellipse){.mean_major = x * mean_x + y * mean_y,
                          .mean_minor = x * mean_y - y * mean_x,
                          .major = sqrt(major > 0.0 ? major : 0.0),
                          .minor = major >= 0.0 ? sqrt(minor) : (double)NAN};
}

/* ---- one part of the integral ---- */

/* Nodes and weights of Gauss-Legendre quadrature with 16 points on -1 … 1 [ABRAMOWITZ1964, table
 * 25.4]; the rule is symmetric. */
enum { HALF_POINTS = 8 };
static const double node[HALF_POINTS] = {
    0.0950125098376374402, 0.2816035507792589132, 0.4580167776572273863, 0.6178762444026437484,
    0.7554044083550030339, 0.8656312023878317439, 0.9445750230732325761, 0.9894009349916499326};
static const double weight[HALF_POINTS] = {
    0.1894506104550684963, 0.1826034150449235889, 0.1691565193950025382, 0.1495959888165767321,
    0.1246289712555338721, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

typedef struct integral {
    const imki_ellipse *e;
    double radius;
    int edge; /* 0: the variable is t; +-1: the angle from the edge y = +-radius */
} integral;

/* The probability of |x| <= w. */
static double across(const imki_ellipse *e, double w)
{
    const double upper = (w - e->mean_major) / e->major, lower = (-w - e->mean_major) / e->major;
    /* Of two numbers near 1 the small rests are subtracted. */
    return lower > 0.0 ? imk_normal_probability(-lower) - imk_normal_probability(-upper)
                       : imk_normal_probability(upper) - imk_normal_probability(lower);
}

static double integrand(const integral *f, double variable)
{
    static const double one_over_root_two_pi = 0.39894228040143267794;
    const imki_ellipse *e = f->e;
    const double r = f->radius;
    if (f->edge == 0) {
        const double y = e->mean_minor + e->minor * variable;
        return one_over_root_two_pi * imk_exp(-0.5 * variable * variable) *
               across(e, sqrt((r - y) * (r + y)));
    }
    /* y = edge r cos(a); r - |y| = 2 r sin^2(a/2) keeps its digits near the edge. */
    const double half_sine = imk_sin(0.5 * variable), sine = imk_sin(variable);
    const double t =
        ((f->edge * r - e->mean_minor) - f->edge * 2.0 * r * half_sine * half_sine) / e->minor;
    return one_over_root_two_pi * imk_exp(-0.5 * t * t) * across(e, r * sine) * r * sine / e->minor;
}

static double part(const integral *f, double from, double to)
{
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = 0.0;
    for (int i = 0; i < HALF_POINTS; i++)
        sum += weight[i] *
               (integrand(f, middle - half * node[i]) + integrand(f, middle + half * node[i]));
    return half * sum;
}

/* ---- the cuts ---- */

/* In sigmas about the mean: where a normal density or distribution function changes. */
enum { STEPS = 11, CUTS_MAX = 2 + 5 * STEPS };
static const double step[STEPS] = {-8.8, -6.0, -4.2, -2.7, -1.3, 0.0, 1.3, 2.7, 4.2, 6.0, 8.8};

typedef struct cuts {
    double from, to; /* of the variable */
    size_t count;
    double at[CUTS_MAX];
} cuts;

static void insert(cuts *c, double at)
{
    if (!(at > c->from && at < c->to) || c->count == CUTS_MAX)
        return;
    size_t i = c->count++;
    for (; i > 0 && c->at[i - 1] > at; i--)
        c->at[i] = c->at[i - 1];
    c->at[i] = at;
}

/* The angle from the edge at which r - |y| is `depth`, 0 … 2 r. */
static double angle_of_depth(double r, double depth)
{
    if (!(depth > 0.0))
        return 0.0;
    if (depth >= 2.0 * r)
        return 3.14159265358979323846;
    return 2.0 * imk_atan2(sqrt(depth), sqrt(2.0 * r - depth));
}

/* Cut where w passes `at`. */
static void cut_across(cuts *c, const integral *f, double at)
{
    const double r = f->radius;
    if (!(at > 0.0 && at < r))
        return;
    const double y = sqrt((r - at) * (r + at));
    if (f->edge == 0) {
        insert(c, (y - f->e->mean_minor) / f->e->minor);
        insert(c, (-y - f->e->mean_minor) / f->e->minor);
    } else {
        const double angle = imk_atan2(at, y);
        insert(c, angle);
        insert(c, 3.14159265358979323846 - angle);
    }
}

static double sum_of_parts(const integral *f, cuts *c)
{
    const imki_ellipse *e = f->e;
    for (int i = 0; i < STEPS; i++) {
        const double y = e->mean_minor + step[i] * e->minor;
        insert(c, f->edge == 0 ? step[i]
                               : angle_of_depth(f->radius, f->radius - (f->edge > 0 ? y : -y)));
        cut_across(c, f, fabs(e->mean_major) + step[i] * e->major);
        cut_across(c, f, -fabs(e->mean_major) + step[i] * e->major);
    }
    double sum = 0.0, from = c->from;
    for (size_t i = 0; i < c->count; i++) {
        sum += part(f, from, c->at[i]);
        from = c->at[i];
    }
    return sum + part(f, from, c->to);
}

double imki_ellipse_probability(const imki_ellipse *e, double r)
{
    const double m = fabs(e->mean_minor);
    if (e->major == 0.0)
        return e->mean_major * e->mean_major + m * m <= r * r ? 1.0 : 0.0;
    if (r <= 0.0 || m - r >= tail * e->minor)
        return 0.0;
    if (e->minor == 0.0)
        return across(e, sqrt((r - m) * (r + m)));
    integral f = {e, r, 0};
    cuts c = {.from = -tail, .to = tail};
    if (r - m > (tail + clear) * e->minor)
        return sum_of_parts(&f, &c);
    f.edge = e->mean_minor >= 0.0 ? 1 : -1;
    c.from = angle_of_depth(r, r - m - tail * e->minor);
    c.to = angle_of_depth(r, r - m + tail * e->minor);
    return sum_of_parts(&f, &c);
}

/* ---- the radius ---- */

/* A root between two points of different sign, by the method of Chandrupatla [CHANDRUPATLA1997]:
 * inverse quadratic interpolation where three points say that it is safe, else bisection. */
double imki_ellipse_radius(const imki_ellipse *e, double probability)
{
    const double middle = sqrt(e->mean_major * e->mean_major + e->mean_minor * e->mean_minor);
    if (!(middle < (double)INFINITY && e->major < (double)INFINITY && e->minor >= 0.0))
        return (double)NAN;
    if (e->major == 0.0)
        return middle;
    /* The distance differs from the mean's by less than that of a point from the mean, which is
     * beyond 12 sigma nowhere with a probability a double could tell from 1. */
    double a = middle + 12.0 * e->major,
           b = middle > 12.0 * e->major ? middle - 12.0 * e->major : 0.0;
    double fa = imki_ellipse_probability(e, a) - probability;
    double fb = imki_ellipse_probability(e, b) - probability;
    double share = 0.5;
    for (int i = 0; i < 100 && fa * fb < 0.0; i++) {
        const double x = a + share * (b - a), fx = imki_ellipse_probability(e, x) - probability;
        const bool same = (fx > 0.0) == (fa > 0.0);
        const double c = same ? a : b, fc = same ? fa : fb;
        if (!same) {
            b = a;
            fb = fa;
        }
        a = x;
        fa = fx;
        const double best = fabs(fa) < fabs(fb) ? a : b;
        const double reach = 0.5e-12 * best / fabs(b - a);
        if (reach > 0.5 || fa == 0.0)
            return best;
        const double u = (a - b) / (c - b), v = (fa - fb) / (fc - fb);
        share = 0.5;
        if (1.0 - sqrt(1.0 - u) < v && v < sqrt(u))
            share = fa / (fb - fa) * fc / (fb - fc) +
                    (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
        share = share < reach ? reach : share > 1.0 - reach ? 1.0 - reach : share;
    }
    return fabs(fa) < fabs(fb) ? a : b;
}
