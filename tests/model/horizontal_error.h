/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance of the linear horizontal error equations of an inertial navigator at rest
 * [BRITTING1971] [TITTERTON2004], for tests; written without the library.
 *
 *     phi' = -w_in x phi + dw_in - d,   dv' = f x phi - 2 w_ie x dv + a,   dr' = dv
 *
 * north, east, down; sphere of R = 6371 km, g = 9.80665 m/s^2, 45 deg north, body axes along north,
 * east and down; height and vertical velocity held by another instrument; attitude, velocity and
 * position perfect at the start. d is the error of the three gyros, a of the two horizontal
 * accelerometers. */
#ifndef IMUKIT_TESTS_HORIZONTAL_ERROR_H
#define IMUKIT_TESTS_HORIZONTAL_ERROR_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double radius = 6371e3, gravity = 9.80665, latitude = 3.14159265358979323846 / 4;
static const double earth_rate = 7.292115e-5; /* WGS84 */

/* Inputs: gyros north, east, down; accelerometers north, east. States: 3 tilts, 2 velocities,
 * 2 positions, and the input's own. */
enum { INPUTS = 5, STATES = 8, POSITION = 5, SHAPE = 7, STEPS = 2000 };

typedef struct matrix {
    double m[STATES][STATES];
} matrix;

/* Of the horizontal position, north and east [m^2]. */
typedef struct covariance {
    double nn, ne, ee;
} covariance;

static matrix product(const matrix *a, const matrix *b)
{
    matrix c = {{{0}}};
    for (int i = 0; i < STATES; i++)
        for (int k = 0; k < STATES; k++)
            for (int j = 0; j < STATES; j++)
                c.m[i][j] += a->m[i][k] * b->m[k][j];
    return c;
}

/* e^(a t): the series of a t/2^halvings, whose norm is below 1/2, squared as often. The remainder
 * after 16 terms is below 0.5^17/17! = 2e-20. */
static matrix exponential(const matrix *a, double t)
{
    double norm = 0;
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            norm += fabs(a->m[i][j] * t);
    int halvings = 0;
    for (; norm > 0.5; norm /= 2)
        halvings++;
    matrix power = {{{0}}}, sum = {{{0}}};
    for (int i = 0; i < STATES; i++)
        power.m[i][i] = sum.m[i][i] = 1;
    for (int term = 1; term <= 16; term++) {
        power = product(a, &power);
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < STATES; j++) {
                power.m[i][j] *= ldexp(t, -halvings) / term;
                sum.m[i][j] += power.m[i][j];
            }
    }
    for (int i = 0; i < halvings; i++)
        sum = product(&sum, &sum);
    return sum;
}

/* The equations, driven at one input by state SHAPE, which decays with a time constant (infinite: a
 * constant). */
static matrix equations(int input, double time_constant, double rate)
{
    const double north = rate * cos(latitude), down = -rate * sin(latitude);
    matrix a = {{{0}}};
    double(*m)[STATES] = a.m;
    m[0][1] = down, m[1][0] = -down, m[1][2] = north, m[2][1] = -north; /* -w_in x phi */
    m[0][4] = 1 / radius, m[1][3] = -1 / radius;                        /* transport rate */
    m[2][4] = -tan(latitude) / radius, m[0][5] = down / radius;         /* and the Earth's, */
    m[2][5] = -north / radius;                                          /* moved north */
    m[3][1] = gravity, m[4][0] = -gravity;                              /* f x phi */
    m[3][4] = 2 * down, m[4][3] = -2 * down;                            /* Coriolis */
    m[POSITION][3] = m[POSITION + 1][4] = 1;
    m[input][SHAPE] = input < 3 ? -1 : 1; /* states 0 to 4 are in the order of the inputs */
    m[SHAPE][SHAPE] = -1 / time_constant;
    return a;
}

/* Position at k t/STEPS after the input's state was 1 and all others 0 (impulse: after the input
 * itself was a unit impulse). */
static void respond(int input, double time_constant, bool impulse, double rate, double t,
                    double north[STEPS + 1], double east[STEPS + 1])
{
    const matrix a = equations(input, time_constant, rate);
    const matrix step = exponential(&a, t / STEPS);
    double x[STATES] = {0}, next[STATES];
    x[impulse ? input : SHAPE] = impulse && input < 3 ? -1 : 1;
    for (int k = 0;; k++) {
        north[k] = x[POSITION];
        east[k] = x[POSITION + 1];
        if (k == STEPS)
            return;
        for (int i = 0; i < STATES; i++) {
            next[i] = 0;
            for (int j = 0; j < STATES; j++)
                next[i] += step.m[i][j] * x[j];
        }
        memcpy(x, next, sizeof x);
    }
}

static void add(covariance *sum, double factor, covariance part)
{
    sum->nn += factor * part.nn;
    sum->ne += factor * part.ne;
    sum->ee += factor * part.ee;
}

static covariance outer(double north, double east)
{
    return (covariance){north * north, north * east, east * east};
}

/* Integral over the time of the response's square, by Simpson's rule. */
static covariance integral(const double *north, const double *east, double t)
{
    covariance sum = {0, 0, 0};
    for (int k = 0; k <= STEPS; k++)
        add(&sum, k == 0 || k == STEPS ? 1 : k % 2 ? 4 : 2, outer(north[k], east[k]));
    covariance result = {0, 0, 0};
    add(&result, t / STEPS / 3, sum);
    return result;
}

/* ---- what a source of unit strength does ------------------------------------------------------
 */

static covariance unit_constant(int input, double t)
{
    static double north[STEPS + 1], east[STEPS + 1];
    respond(input, (double)INFINITY, false, earth_rate, t, north, east);
    return outer(north[STEPS], east[STEPS]);
}

static covariance unit_white(int input, double t)
{
    static double north[STEPS + 1], east[STEPS + 1];
    respond(input, (double)INFINITY, true, earth_rate, t, north, east);
    return integral(north, east, t);
}

/* A random walk from 0: each of its steps is a constant from then on. */
static covariance unit_random_walk(int input, double t)
{
    static double north[STEPS + 1], east[STEPS + 1];
    respond(input, (double)INFINITY, false, earth_rate, t, north, east);
    return integral(north, east, t);
}

/* First-order Gauss-Markov process of variance 1, stationary: its first value decays, and so do
 * the innovations of density 2/T. */
static covariance unit_gauss_markov(int input, double time_constant, double t)
{
    static double north[STEPS + 1], east[STEPS + 1];
    respond(input, time_constant, false, earth_rate, t, north, east);
    covariance sum = outer(north[STEPS], east[STEPS]);
    add(&sum, 2 / time_constant, integral(north, east, t));
    return sum;
}

/* Flicker noise of B = 1 as noise.h defines it, whatever the rate: stages of variances ln 4/pi,
 * whose correlation times fall by 4 from the longest; that one is such that the density at 0 Hz, 2
 * (ln 4/pi) T (1 + 1/4 + 1/16 …), is 1e6 s. Those slower than the run make up most of its effect:
 * within a run they pass for a constant bias. 16 of them reach down to a millisecond. */
enum { STAGES = 16 };

static double stage_time(int stage)
{
    return 1e6 / (8 * log(4) / (3 * pi)) * pow(4, -stage);
}

static double stage_variance(int stage)
{
    (void)stage;
    return log(4) / pi;
}

static covariance unit_flicker(int input, double t)
{
    covariance sum = {0, 0, 0};
    for (int j = 0; j < STAGES; j++)
        add(&sum, stage_variance(j), unit_gauss_markov(input, stage_time(j), t));
    return sum;
}

/* ---- figures of a covariance ------------------------------------------------------------------
 */

static double drms(covariance p)
{
    return sqrt(p.nn + p.ee);
}

/* Probability that a normal position with principal deviations s1 >= s2 lies within r:
 * x = r sin(theta), y by the error function; midpoint rule. */
static double within(double r, double s1, double s2)
{
    enum { PARTS = 4000 };
    double sum = 0;
    for (int k = 0; k < PARTS; k++) {
        const double theta = ((k + 0.5) / PARTS - 0.5) * pi;
        const double x = r * sin(theta) / s1, y = r * cos(theta);
        sum += exp(-x * x / 2) * erf(y / (s2 * sqrt(2))) * y;
    }
    return sum * pi / PARTS / (s1 * sqrt(2 * pi));
}

/* Circular error probable: the radius of half the probability, by bisection. */
static double cep(covariance p)
{
    const double mean = (p.nn + p.ee) / 2;
    const double spread = hypot((p.nn - p.ee) / 2, p.ne);
    const double s1 = sqrt(mean + spread);
    const double s2 = sqrt(fmax(mean - spread, 1e-12 * mean)); /* the midpoint rule needs some */
    double low = 0, high = 2 * s1;
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        if (within(middle, s1, s2) < 0.5)
            low = middle;
        else
            high = middle;
    }
    return low;
}

#endif
