/* SPDX-License-Identifier: Apache-2.0 */
/* Forces on the mass of a MEMS accelerometer, the point at which it works, and closed forms. Forces
 * are per mass. A series is value, slope, half the second and a sixth of the third derivative:
 *
 *     C/(g - z)^2:  C/(g-z)^2, 2C/(g-z)^3, 3C/(g-z)^4, 4C/(g-z)^5 */
#include "mems_accelerometer_internal.h"

#include <math.h>

static double square(double x)
{
    return x * x;
}

static double spring_rate(const imk_mems_accelerometer *d)
{
    return square(2.0 * IMKI_PI * d->frequency);
}

imki_series imki_mems_spring(const imk_mems_accelerometer *d, double x)
{
    const double k = spring_rate(d), q = d->spring_quadratic, r = d->spring_cubic;
    return (imki_series){k * x * (1.0 + x * (q + x * r)), k * (1.0 + x * (2.0 * q + 3.0 * x * r)),
                         k * (q + 3.0 * r * x), k * r};
}

imki_series imki_mems_attraction(const imk_mems_accelerometer *d, double plus, double minus,
                                 double z)
{
    const double c = 0.5 * IMKI_PERMITTIVITY * d->area / d->mass;
    const double p = 1.0 / (d->gap - z), m = 1.0 / (d->gap + z);
    double a = c * plus * p * p, b = d->plates == IMK_MEMS_SINGLE ? 0.0 : c * minus * m * m;
    imki_series series = {.value = a - b};
    series.first = 2.0 * ((a *= p) + (b *= m));
    series.second = 3.0 * ((a *= p) - (b *= m));
    series.third = 4.0 * (a * p + b * m);
    return series;
}

imki_series imki_mems_pickoff_series(const imk_mems_accelerometer *d, double z)
{
    const double g = d->gap;
    if (d->plates == IMK_MEMS_SINGLE) {
        /* s z/(s - z): of (C - C0)/(C + C0) with s = 2 gap, of C - C0 with s = gap */
        const double s = d->pickoff == IMK_MEMS_RATIO ? 2.0 * g : g, t = 1.0 / (s - z);
        return (imki_series){s * z * t, s * s * t * t, s * s * t * t * t, s * s * t * t * t * t};
    }
    if (d->pickoff == IMK_MEMS_RATIO)
        return (imki_series){.value = z, .first = 1.0};
    const double p = 1.0 / (g - z), m = 1.0 / (g + z), h = 0.5 * g * g;
    return (imki_series){z * g * g * p * m, h * (p * p + m * m), h * (p * p * p - m * m * m),
                         h * (p * p * p * p + m * m * m * m)};
}

double imk_mems_accelerometer_damping(const imk_mems_accelerometer *d, double z)
{
    const double s = z / d->gap;
    if (!d->squeeze_film)
        return 1.0;
    if (d->plates == IMK_MEMS_SINGLE)
        return 1.0 / ((1.0 - s) * (1.0 - s) * (1.0 - s));
    const double t = 1.0 - s * s;
    return (1.0 + 3.0 * s * s) / (t * t * t);
}

/* ---- the operating point --------------------------------------------------------------------- */

static void expand(const imk_mems_accelerometer *d, double plus, double minus, imki_mems_point *p)
{
    const imki_series spring = imki_mems_spring(d, p->spring);
    const imki_series pull = imki_mems_attraction(d, plus, minus, p->z);
    p->a1 = spring.first - pull.first;
    p->a2 = spring.second - pull.second;
    p->a3 = spring.third - pull.third;
    p->damping =
        2.0 * IMKI_PI * d->frequency / d->quality * imk_mems_accelerometer_damping(d, p->z);
    p->pickoff = imki_mems_pickoff_series(d, p->z);
}

/* Newton's method from the springs' rest: the pull grows, and the springs' slope exceeds its slope,
 * all the way to a stable equilibrium, if there is one. */
static void find_equilibrium(const imk_mems_accelerometer *d, imki_mems_point *p)
{
    const double v2 = d->voltage * d->voltage, end = d->stop * d->gap;
    double x = 0.0;
    p->exists = false;
    for (int i = 0; i < 100; i++) {
        const imki_series spring = imki_mems_spring(d, x);
        const imki_series pull = imki_mems_attraction(d, v2, v2, x + d->offset);
        const double slope = spring.first - pull.first;
        const double change = (spring.value - pull.value) / slope;
        if (!(slope > 0.0))
            return;
        x -= change;
        if (!(fabs(x + d->offset) < end))
            return;
        /* quadratic convergence, but at pull-in itself, where rounding sets the limit */
        if (fabs(change) <= 1e-11 * d->gap) {
            p->exists = true;
            break;
        }
    }
    p->spring = x;
    p->z = x + d->offset;
    expand(d, v2, v2, p);
    p->exists = p->exists && p->a1 > 0.0;
}

/* The control voltage that holds the mass at the null, from
 *   E = c [(V-u)^2 P - (V+u)^2 M] = S,   P = 1/(g-z)^2, M = 1/(g+z)^2 */
static void find_control(const imk_mems_accelerometer *d, imki_mems_point *p)
{
    const double c = 0.5 * IMKI_PERMITTIVITY * d->area / d->mass, v = d->voltage;
    const double near = 1.0 / square(d->gap - p->z), far = 1.0 / square(d->gap + p->z);
    const double first = v * (near + far), second = near - far;
    const double rest = v * v * second - imki_mems_spring(d, p->spring).value / c;
    const double root = first * first - second * rest;
    p->exists = root > 0.0;
    p->control = p->exists ? rest / (first + sqrt(root)) : 0.0;
    p->b1 = 2.0 * c * (second * p->control - first);
    p->b2 = c * second;
    expand(d, square(v - p->control), square(v + p->control), p);
}

imki_mems_point imki_mems_operating_point(const imk_mems_accelerometer *d)
{
    imki_mems_point p = {.exists = true};
    if (d->loop == IMK_MEMS_OPEN) {
        find_equilibrium(d, &p);
        return p;
    }
    p.z = d->pickoff_offset;
    p.spring = p.z - d->offset;
    if (d->loop == IMK_MEMS_ANALOG) {
        find_control(d, &p);
        return p;
    }
    const double carrier = square(d->voltage), feedback = square(d->feedback_voltage);
    const double up = imki_mems_attraction(d, carrier + feedback, carrier, p.z).value;
    const double down = imki_mems_attraction(d, carrier, carrier + feedback, p.z).value;
    p.unit = 0.5 * (up - down);
    p.rest = 0.5 * (up + down) - imki_mems_spring(d, p.spring).value;
    expand(d, carrier + 0.5 * feedback, carrier + 0.5 * feedback, &p);
    return p;
}

/* ---- closed forms ---------------------------------------------------------------------------- */

double imk_mems_accelerometer_brownian(const imk_mems_accelerometer *d)
{
    return sqrt(4.0 * IMKI_BOLTZMANN * d->temperature * 2.0 * IMKI_PI * d->frequency /
                (d->mass * d->quality));
}

double imk_mems_accelerometer_softening(const imk_mems_accelerometer *d)
{
    const double v2 = square(d->voltage);
    return d->mass * imki_mems_attraction(d, v2, v2, 0.0).first;
}

double imk_mems_accelerometer_pull_in(const imk_mems_accelerometer *d)
{
    const bool single = d->plates == IMK_MEMS_SINGLE;
    const double gap = single ? d->gap - d->offset : d->gap;
    const double cube = d->mass * spring_rate(d) * gap * gap * gap;
    const double ea = IMKI_PERMITTIVITY * d->area;
    return single ? sqrt(8.0 * cube / (27.0 * ea)) : sqrt(cube / (2.0 * ea));
}

double imki_mems_stiffness(const imk_mems_accelerometer *d)
{
    double v2 = square(d->voltage);
    if (d->loop == IMK_MEMS_SIGMA_DELTA)
        v2 += 0.5 * square(d->feedback_voltage);
    return spring_rate(d) - imki_mems_attraction(d, v2, v2, 0.0).first;
}

double imk_mems_accelerometer_sensitivity(const imk_mems_accelerometer *d)
{
    return 1.0 / imki_mems_stiffness(d);
}

/* Open loop: the smaller of the specific forces that bring the mass to either stop, or to where
 * the springs no longer outweigh the plates. */
static double travel_limit(const imk_mems_accelerometer *d)
{
    enum { PARTS = 256 };
    const imki_mems_point p = imki_mems_operating_point(d);
    const double v2 = square(d->voltage), end = d->stop * d->gap;
    double limit = HUGE_VAL;
    for (int side = -1; side <= 1; side += 2) {
        double largest = 0.0;
        for (int i = 1; i <= PARTS; i++) {
            /* closer together near rest: next to pull-in the springs give way early */
            const double part = (double)i / PARTS;
            const double z = p.z + (side * end - p.z) * part * part * part;
            const double force =
                imki_mems_spring(d, z - d->offset).value - imki_mems_attraction(d, v2, v2, z).value;
            largest = side * force > largest ? side * force : largest;
        }
        limit = largest < limit ? largest : limit;
    }
    return limit;
}

double imk_mems_accelerometer_limit(const imk_mems_accelerometer *d)
{
    const double unit = IMKI_PERMITTIVITY * d->area / (d->mass * d->gap * d->gap);
    if (d->loop == IMK_MEMS_OPEN)
        return travel_limit(d);
    return d->loop == IMK_MEMS_ANALOG ? 2.0 * unit * d->voltage * d->feedback_voltage
                                      : 0.5 * unit * square(d->feedback_voltage);
}

imk_mems_gains imk_mems_accelerometer_gains(const imk_mems_accelerometer *d)
{
    const double w = 2.0 * IMKI_PI * d->bandwidth;
    const double derivative = 2.0 * d->damping * w - 2.0 * IMKI_PI * d->frequency / d->quality;
    return (imk_mems_gains){.proportional = w * w - imki_mems_stiffness(d),
                            .derivative = derivative > 0.0 ? derivative : 0.0,
                            .integral = 2.0 * IMKI_PI * d->reset * w * w};
}

double imki_mems_fastest(const imk_mems_accelerometer *d)
{
    double fastest = d->frequency;
    if (d->loop != IMK_MEMS_ANALOG)
        return fastest;
    fastest = d->bandwidth > fastest ? d->bandwidth : fastest;
    const double derivative = imk_mems_accelerometer_gains(d).derivative / (2.0 * IMKI_PI);
    return derivative > fastest ? derivative : fastest;
}
