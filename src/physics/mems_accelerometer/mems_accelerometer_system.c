/* SPDX-License-Identifier: Apache-2.0 */
/* The linear part of a MEMS accelerometer about its operating point: the mass on its softened
 * springs, the analog controller behind two amplifier stages, the output filter, and the white
 * noise of damping and pickoff. */
#include "mems_accelerometer_internal.h"

#include <string.h>

enum { N = IMKI_MEMS_STATES };

/* The signal as a row over the states (open and analog), and its white noise. */
static void set_output(const imk_mems_accelerometer *d, const double signal[N], double noise,
                       imki_mems_system *s)
{
    const double w = 2.0 * IMKI_PI * d->output_bandwidth;
    const int into = w > 0.0 ? IMKI_FILTER_RATE : IMKI_INTEGRAL;
    const double gain = w > 0.0 ? w * w : 1.0;
    for (int j = 0; j < s->n; j++)
        s->a[into * s->n + j] += gain * signal[j];
    s->b[into * IMKI_MEMS_INPUTS + IMKI_SIGNAL] = gain;
    s->w[into * s->n + into] += gain * gain * noise;
    if (!(w > 0.0))
        return;
    /* Butterworth: damping 1/sqrt(2) */
    s->a[IMKI_FILTER * s->n + IMKI_FILTER_RATE] = 1.0;
    s->a[IMKI_FILTER_RATE * s->n + IMKI_FILTER] -= w * w;
    s->a[IMKI_FILTER_RATE * s->n + IMKI_FILTER_RATE] -= 1.41421356237309505 * w;
    s->a[IMKI_INTEGRAL * s->n + IMKI_FILTER] = 1.0;
}

static void set_mass(const imk_mems_accelerometer *d, const imki_mems_point *point,
                     imki_mems_system *s)
{
    const int n = s->n;
    s->a[IMKI_POSITION * n + IMKI_VELOCITY] = 1.0;
    s->a[IMKI_VELOCITY * n + IMKI_POSITION] = -point->a1;
    s->a[IMKI_VELOCITY * n + IMKI_VELOCITY] = -point->damping;
    s->b[IMKI_VELOCITY * IMKI_MEMS_INPUTS + IMKI_FORCE] = 1.0;
    s->w[IMKI_VELOCITY * n + IMKI_VELOCITY] =
        2.0 * IMKI_BOLTZMANN * d->temperature * point->damping / d->mass;
}

static void set_controller(const imk_mems_accelerometer *d, imki_mems_system *s)
{
    const imk_mems_gains gains = imk_mems_accelerometer_gains(d);
    const double w = 2.0 * IMKI_PI * d->amplifier;
    double *a = s->a;
    const int n = s->n;
    a[IMKI_AMPLIFIER * n + IMKI_POSITION] = w;
    a[IMKI_AMPLIFIER * n + IMKI_AMPLIFIER] = -w;
    a[IMKI_COMPENSATOR * n + IMKI_AMPLIFIER] = w;
    a[IMKI_COMPENSATOR * n + IMKI_COMPENSATOR] = -w;
    a[IMKI_RESET * n + IMKI_COMPENSATOR] = d->reset > 0.0 ? 1.0 : 0.0;
    s->control[IMKI_AMPLIFIER] = -gains.derivative * w;
    s->control[IMKI_COMPENSATOR] = gains.derivative * w - gains.proportional;
    s->control[IMKI_RESET] = -gains.integral;
    for (int j = 0; j < n; j++)
        a[IMKI_VELOCITY * n + j] += s->control[j];
    s->w[IMKI_AMPLIFIER * n + IMKI_AMPLIFIER] = 0.5 * w * w * d->pickoff_noise * d->pickoff_noise;
}

void imki_mems_linear_system(const imk_mems_accelerometer *d, const imki_mems_point *point,
                             bool slow, imki_mems_system *s)
{
    double signal[N] = {0.0}, noise = 0.0;
    memset(s, 0, sizeof *s);
    s->n = d->loop == IMK_MEMS_ANALOG ? N : IMKI_AMPLIFIER;
    /* without its bits nothing holds the mass of a sigma-delta loop: the slow level has none */
    if (!(slow && d->loop == IMK_MEMS_SIGMA_DELTA))
        set_mass(d, point, s);
    if (d->loop == IMK_MEMS_ANALOG) {
        set_controller(d, s);
        memcpy(signal, s->control, sizeof signal);
    } else if (d->loop == IMK_MEMS_OPEN) {
        signal[IMKI_POSITION] = -point->a1;
        noise = 0.5 * point->a1 * point->a1 * d->pickoff_noise * d->pickoff_noise;
    } else if (slow) {
        noise = imki_mems_white(d, point);
        noise *= noise;
    }
    set_output(d, signal, noise, s);
}

/* The characteristic polynomial
 *   (s^2 + damping s + k)(s + w)^2 s + w^2 (kp s + ki + kd s^2)
 * of the loop, w the amplifier's, has all zeros to the left when the first column of Routh's array
 * is positive. Without an integral part the factor s is left out. Powers of s are scaled by w. */
bool imki_mems_loop_stable(const imk_mems_accelerometer *d, double stiffness)
{
    const imk_mems_gains gains = imk_mems_accelerometer_gains(d);
    const double w = 2.0 * IMKI_PI * d->amplifier;
    const double c = 2.0 * IMKI_PI * d->frequency / d->quality / w, k = stiffness / (w * w);
    const double kp = gains.proportional / (w * w), kd = gains.derivative / w;
    const double ki = gains.integral / (w * w * w);
    double rows[2][4] = {{1.0, 1.0 + 2.0 * c + k, k + kp, 0.0}, {2.0 + c, c + 2.0 * k + kd, ki}};
    int length = 6;
    if (!(ki > 0.0)) {
        length = 5;
        rows[1][2] = 0.0;
    }
    /* the array's next row replaces the row before last */
    for (int i = 2; i < length; i++) {
        double *above = rows[i % 2], *last = rows[(i + 1) % 2];
        if (!(last[0] > 0.0))
            return false;
        for (int j = 0; j < 3; j++)
            above[j] = above[j + 1] - above[0] / last[0] * last[j + 1];
        above[3] = 0.0;
    }
    return rows[(length + 1) % 2][0] > 0.0;
}
