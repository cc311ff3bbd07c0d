/* SPDX-License-Identifier: Apache-2.0 */
/* How well the mean of a hold, and the angle of a turn, are known before anything is fitted.
 *
 * With L the variance of a mean times its number of samples, correlation of neighbours taken into
 * account: a hold gives an L of its own, from few independent samples, and all holds together a
 * common one, the harmonic mean, which a touched hold hardly moves. Half of each is taken: noise of
 * the estimate halves, and a touched hold still weighs less. Then
 *
 *     sigma^2 of a hold = L/min(samples, typical)
 *
 * typical the harmonic mean of the lengths: what a mean is uncertain by besides white noise does
 * not average out, so a long rest counts like any other. Angular random walk N^2 = L dt over a turn
 * of length T, and the horizontal part of the Earth's rate, whose heading is not known, make the
 * sigma of a turn about each axis across the vertical:
 *
 *     sigma^2 = N^2 T + (earth_rate cos(latitude) T)^2/2.
 *
 * What the rounding to steps leaves in a mean is no part of L. It is added: once for an
 * accelerometer, which reads something else in each hold, and as many times as there are holds for
 * a gyro, whose reading lies at the same place within a step in all of them, so that the error is
 * the same and does not average out. At both ends of a turn, where it is slow, it is the same
 * again: it is taken for an error of the bias during the whole turn.
 *
 * A turn has the common L: a hand that trembles during a hold really turns the unit, and the gyros
 * see it; that is no noise of theirs. */
#include "multiposition_internal.h"

#include "imukit/elementary.h"

#include <math.h>

/* Variance of a mean without what rounding leaves. */
static double noise_of(const imk_static_interval *hold, int sensor, int axis)
{
    const double sigma = hold->sigma[sensor][axis], rounding = hold->rounding[sensor][axis];
    return sigma > 0.0 && isfinite(sigma) ? sigma * sigma - rounding * rounding : 0.0;
}

static double samples_of(const imk_static_interval *hold)
{
    return (double)(hold->end - hold->begin);
}

void imki_hold_noise_find(const imk_test_record *record, size_t count,
                          const imk_static_interval *hold, imki_hold_noise *noise)
{
    double lengths = 0.0;
    for (size_t k = 0; k < count; k++)
        lengths += 1.0 / samples_of(&hold[k]);
    noise->typical = (double)count / lengths;
    noise->holds = (double)count;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < record->axis_count[sensor]; i++) {
            double sum = 0.0, used = 0.0, rounding = 0.0;
            for (size_t k = 0; k < count; k++) {
                rounding += hold[k].rounding[sensor][i] * hold[k].rounding[sensor][i];
                const double square = noise_of(&hold[k], sensor, i);
                if (square > 0.0) {
                    sum += 1.0 / (square * samples_of(&hold[k]));
                    used += 1.0;
                }
            }
            noise->level[sensor][i] = used > 0.0 ? used / sum : 0.0;
            noise->rounding[sensor][i] = sqrt(rounding / (double)count);
        }
}

/* L of a hold, worse than the step of the reading makes it. */
static double level_of(const imki_hold_noise *noise, const imk_static_interval *hold, int sensor,
                       int axis, double step)
{
    const double square = noise_of(hold, sensor, axis);
    const double own = square > 0.0 ? square * samples_of(hold) : noise->level[sensor][axis];
    return fmax(0.5 * (own + noise->level[sensor][axis]), step * step / 12.0);
}

double imki_hold_sigma(const imki_hold_noise *noise, const imk_static_interval *hold, int sensor,
                       int axis, double step)
{
    const double length = fmin(samples_of(hold), noise->typical);
    const double rounding = hold->rounding[sensor][axis];
    const double times = sensor == IMK_GYRO ? noise->holds : 1.0;
    const double sigma =
        sqrt(level_of(noise, hold, sensor, axis, step) / length + times * rounding * rounding);
    /* Nothing scatters and the step is not known: a billionth stands for the rounding of a log. */
    return sigma > 0.0 ? sigma : 1e-9;
}

double imki_turn_sigma(const imki_turn_surroundings *around, const imki_hold_noise *noise,
                       double duration, double *earth_sigma)
{
    double level = 0.0, rounding = 0.0;
    for (int i = 0; i < around->axis_count; i++) {
        const double unit = around->unit[i], step = around->step[i];
        level +=
            unit * unit * fmax(noise->level[IMK_GYRO][i], step * step / 12.0) / around->axis_count;
        const double off = unit * noise->rounding[IMK_GYRO][i] * duration;
        rounding += off * off / around->axis_count;
    }
    /* Places all over the Earth have 2/3 for the mean square of cos(latitude). */
    const double cosine = imk_cos(around->latitude);
    const double square = isnan(around->latitude) ? 2.0 / 3.0 : cosine * cosine;
    const double earth = around->earth_rate * duration;
    const double sigma =
        sqrt(level * around->dt * duration + rounding + 0.5 * square * earth * earth);
    /* The gyros' own part is a thousandth of it at least, however quiet the record. */
    *earth_sigma = fmin(sqrt(0.5 * square) * earth, 0.999999 * sigma);
    return sigma > 0.0 ? sigma : 1e-9;
}
