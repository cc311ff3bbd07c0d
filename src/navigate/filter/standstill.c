/* SPDX-License-Identifier: Apache-2.0 */
/* Does the unit stand? Three figures of each window of n samples [SKOG2010]:
 *
 *     q0 = sum |f_k - mean f|^2/n,      q1 = sum |w_k - mean w|^2/n,
 *     q2 = |mean f - force at rest|^2,  q3 = |mean w - rate at rest|^2
 *
 * At rest each is about a multiple of a chi-square variable, whatever the colour of the noise and
 * the sway of the vehicle. Its mean m and variance v are learnt; it is then c chi-square(d) with
 * c = v/(2 m), d = 2 m^2/v [SATTERTHWAITE1946], and the limit a quantile of that, a quarter of the
 * false alarms to each figure. After a long way tilt and biases are not known as well as while
 * learning: q2 and q3 may then be (sqrt(limit) + 4 sigma)^2. */
#include "imukit/standstill.h"

#include "imukit/distributions.h"

#include <math.h>
#include <string.h>

enum { WINDOWS_MIN = 10, SAMPLES_MIN = 4 };

imk_standstill imk_standstill_start(double window, double false_alarm)
{
    return (imk_standstill){.window = window, .false_alarm = false_alarm};
}

static void clear_window(imk_standstill *d)
{
    d->count = 0;
    d->time = 0.0;
    d->turn = d->speed = d->rate_off = d->force_off = (imk_vector3){{0}};
    memset(d->rate_square, 0, sizeof d->rate_square);
    memset(d->force_square, 0, sizeof d->force_square);
}

/* @return true when the window is full */
static bool add_sample(imk_standstill *d, double dt, imk_vector3 angle, imk_vector3 velocity)
{
    if (d->count == 0) {
        d->first_rate = imk_vector3_scale(angle, 1.0 / dt);
        d->first_force = imk_vector3_scale(velocity, 1.0 / dt);
    }
    for (int i = 0; i < 3; i++) {
        const double rate = angle.v[i] / dt - d->first_rate.v[i];
        const double force = velocity.v[i] / dt - d->first_force.v[i];
        d->rate_off.v[i] += rate;
        d->force_off.v[i] += force;
        d->rate_square[i] += rate * rate;
        d->force_square[i] += force * force;
        d->turn.v[i] += angle.v[i];
        d->speed.v[i] += velocity.v[i];
    }
    d->time += dt;
    d->count++;
    return d->count >= SAMPLES_MIN && d->time > d->window - 0.5 * dt;
}

static void figures(const imk_standstill *d, imk_vector3 rest_rate, imk_vector3 rest_force,
                    double q[IMK_STANDSTILL_FIGURES])
{
    const double n = (double)d->count;
    q[0] = q[1] = q[2] = q[3] = 0.0;
    for (int i = 0; i < 3; i++) {
        const double rate = d->rate_off.v[i] / n, force = d->force_off.v[i] / n;
        const double rate_error = d->turn.v[i] / d->time - rest_rate.v[i];
        const double force_error = d->speed.v[i] / d->time - rest_force.v[i];
        q[0] += d->force_square[i] / n - force * force;
        q[1] += d->rate_square[i] / n - rate * rate;
        q[2] += force_error * force_error;
        q[3] += rate_error * rate_error;
    }
}

/* The means of the rest itself are not known while learning: those of the windows before stand for
 * them, whose own scatter makes the variance larger by one part in their number. */
void imk_standstill_learn(imk_standstill *d, double dt, imk_vector3 angle, imk_vector3 velocity)
{
    if (!add_sample(d, dt, angle, velocity))
        return;
    if (d->time_sum > 0.0) { /* the first window has nothing to be compared with */
        double q[IMK_STANDSTILL_FIGURES];
        figures(d, imk_vector3_scale(d->turn_sum, 1.0 / d->time_sum),
                imk_vector3_scale(d->speed_sum, 1.0 / d->time_sum), q);
        d->learnt++;
        for (int i = 0; i < IMK_STANDSTILL_FIGURES; i++) {
            d->sum[i] += q[i];
            d->square_sum[i] += q[i] * q[i];
        }
    }
    d->turn_sum = imk_vector3_add(d->turn_sum, d->turn);
    d->speed_sum = imk_vector3_add(d->speed_sum, d->speed);
    d->time_sum += d->time;
    clear_window(d);
}

imk_status imk_standstill_ready(imk_standstill *d, imk_error *error)
{
    if (d->learnt < WINDOWS_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "standstill", "",
                             "at least 11 stationary windows to learn from");
    const double n = (double)d->learnt;
    for (int i = 0; i < IMK_STANDSTILL_FIGURES; i++) {
        const double mean = d->sum[i] / n;
        const double variance = (d->square_sum[i] - n * mean * mean) / (n - 1.0);
        /* Readings without any scatter, or always the same: nothing but that is rest. */
        d->limit[i] = mean;
        if (variance > 1e-20 * mean * mean)
            d->limit[i] = 0.5 * variance / mean *
                          imk_chi_square_quantile(1.0 - d->false_alarm / IMK_STANDSTILL_FIGURES,
                                                  2.0 * mean * mean / variance);
    }
    clear_window(d);
    return IMK_OK;
}

/* Is q, the square of a distance, within a limit widened by four sigma of what it is measured from?
 */
static bool is_near(double q, double limit, double sigma)
{
    const double distance = sqrt(limit) + 4.0 * sigma;
    return q <= distance * distance;
}

imk_standstill_verdict imk_standstill_add(imk_standstill *d, double dt, imk_vector3 angle,
                                          imk_vector3 velocity, const imk_rest_readings *rest)
{
    if (!add_sample(d, dt, angle, velocity))
        return IMK_STANDSTILL_UNDECIDED;
    double q[IMK_STANDSTILL_FIGURES];
    figures(d, rest->rate, rest->force, q);
    clear_window(d);
    return q[0] <= d->limit[0] && q[1] <= d->limit[1] &&
                   is_near(q[2], d->limit[2], rest->force_sigma) &&
                   is_near(q[3], d->limit[3], rest->rate_sigma)
               ? IMK_STANDSTILL_STANDS
               : IMK_STANDSTILL_MOVES;
}
