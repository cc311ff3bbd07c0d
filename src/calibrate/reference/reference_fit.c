/* SPDX-License-Identifier: Apache-2.0 */
/* Readings against their reference: a linear fit, and the shift in time between the two.
 *
 *     y[k] = c + sum over j of B_j r_j(k - lag) + noise
 *
 * B and c by least squares for a given lag; the lag by Newton's steps on the remaining residual e,
 *
 *     step = - sum w d e / sum w d^2,   d = sum over j of B_j r_j'(k - lag),   w = 1/variance of e
 *
 * over all axes. The reference between its samples is Lagrange's polynomial through the six
 * nearest: half-way between samples it loses (5/1024) (w dt)^6 of a sine of angular frequency w. */
#include "reference_internal.h"

#include <math.h>

enum {
    FIT_SAMPLES = 200000, /* looked at in a fit of a whole record, evenly spread */
    LAG_STEPS = 30
};

/* A channel counts as independent of others when this much of the largest variance is its own: a
 * thousandth of the largest amplitude. */
static const double independent = 1e-6;

double imki_reference_at(const double *channel, size_t count, size_t k, double lag)
{
    const double place = (double)k - lag;
    const double whole = floor(place);
    const double t = place - whole;
    if (!(whole >= 2.0 && whole <= (double)count - 4.0)) {
        /* Without a shift the ends of the record are as good as its middle. */
        return lag == 0.0 ? channel[k] : (double)NAN;
    }
    const double *const r = channel + (size_t)whole;
    if (t == 0.0)
        return r[0];
    /* Weights of the samples -2 … 3 at 0 < t < 1. */
    const double a = t + 2.0, b = t + 1.0, d = t - 1.0, e = t - 2.0, f = t - 3.0;
    return -b * t * d * e * f / 120.0 * r[-2] + a * t * d * e * f / 24.0 * r[-1] -
           a * b * d * e * f / 12.0 * r[0] + a * b * t * e * f / 12.0 * r[1] -
           a * b * t * d * f / 24.0 * r[2] + a * b * t * d * e / 120.0 * r[3];
}

const double *const *imki_reference_channels(const imk_test_record *record, int sensor)
{
    const double *const *channel =
        sensor == IMK_GYRO ? record->reference_rate : record->reference_force;
    return channel[0] && channel[1] && channel[2] ? channel : NULL;
}

/* ---- linear fit -------------------------------------------------------------------------------
 */

void imki_linear_fit_add(imki_linear_fit *fit, const double x[3], double y)
{
    if (fit->count++ == 0) {
        for (int j = 0; j < 3; j++)
            fit->origin[j] = x[j];
        fit->origin[3] = y;
    }
    const double v[4] = {x[0] - fit->origin[0], x[1] - fit->origin[1], x[2] - fit->origin[2],
                         y - fit->origin[3]};
    for (int i = 0, p = 0; i < 4; i++) {
        fit->sum[i] += v[i];
        for (int j = i; j < 4; j++)
            fit->product[p++] += v[i] * v[j];
    }
}

/* Sums of products about the means, 4 x 4. */
static void centre(const imki_linear_fit *fit, double c[4][4])
{
    const double n = (double)fit->count;
    for (int i = 0, p = 0; i < 4; i++)
        for (int j = i; j < 4; j++, p++)
            c[i][j] = c[j][i] = fit->product[p] - fit->sum[i] * fit->sum[j] / n;
}

/* Take the channel with the largest remaining variance as pivot of Gauss-Jordan elimination, until
 * none varies by itself. */
static void eliminate(double c[4][4], bool used[3])
{
    const double largest = fmax(fmax(c[0][0], c[1][1]), c[2][2]);
    for (int round = 0; round < 3; round++) {
        int pivot = -1;
        for (int j = 0; j < 3; j++)
            if (!used[j] && c[j][j] > independent * largest &&
                (pivot < 0 || c[j][j] > c[pivot][pivot]))
                pivot = j;
        if (pivot < 0)
            return;
        used[pivot] = true;
        const double inverse = 1.0 / c[pivot][pivot];
        for (int j = 0; j < 4; j++)
            c[pivot][j] = j == pivot ? inverse : c[pivot][j] * inverse;
        for (int i = 0; i < 4; i++) {
            const double factor = c[i][pivot];
            if (i == pivot)
                continue;
            for (int j = 0; j < 4; j++)
                c[i][j] = j == pivot ? -factor * inverse : c[i][j] - factor * c[pivot][j];
        }
    }
}

void imki_linear_fit_solve(imki_linear_fit *fit)
{
    double c[4][4];
    bool used[3] = {false, false, false};
    if (fit->count < 2)
        return;
    centre(fit, c);
    const double n = (double)fit->count, total = c[3][3];
    eliminate(c, used);
    fit->intercept = fit->origin[3] + fit->sum[3] / n;
    for (int j = 0; j < 3; j++) {
        fit->slope[j] = used[j] ? c[j][3] : 0.0;
        fit->intercept -= fit->slope[j] * (fit->origin[j] + fit->sum[j] / n);
    }
    const double left = fmax(c[3][3], 0.0);
    const double freedom = n - 1.0 - used[0] - used[1] - used[2];
    fit->variance = total / (n - 1.0);
    fit->residual = sqrt(left / fmax(freedom, 1.0));
    fit->share = total > 0.0 ? 1.0 - left / total : 0.0;
}

imki_linear_fit imki_reference_fit(const imk_test_record *record, int sensor, int axis, double lag,
                                   size_t begin, size_t end, size_t stride)
{
    const double *const *channel = imki_reference_channels(record, sensor);
    const double *const reading = record->reading[sensor][axis];
    imki_linear_fit fit = {.count = 0};
    for (size_t k = begin; channel && k < end; k += stride) {
        double x[3];
        for (int j = 0; j < 3; j++)
            x[j] = imki_reference_at(channel[j], record->count, k, lag);
        if (fabs(reading[k]) < HUGE_VAL && fabs(x[0]) < HUGE_VAL && fabs(x[1]) < HUGE_VAL &&
            fabs(x[2]) < HUGE_VAL)
            imki_linear_fit_add(&fit, x, reading[k]);
    }
    imki_linear_fit_solve(&fit);
    return fit;
}

/* ---- lag --------------------------------------------------------------------------------------
 */

/* Sums of d e and d^2 of one axis, divided by the variance of e. */
static void add_axis(const imk_test_record *record, int sensor, int axis, double lag, size_t stride,
                     double *gradient, double *curvature)
{
    const double *const *channel = imki_reference_channels(record, sensor);
    const double *const reading = record->reading[sensor][axis];
    const imki_linear_fit fit =
        imki_reference_fit(record, sensor, axis, lag, 0, record->count, stride);
    if (fit.count < 8 || !(fit.residual > 0.0) || !(fit.share > 0.01))
        return; /* the axis hardly follows: its slopes would be noise */
    double de = 0.0, dd = 0.0;
    for (size_t k = 0; k < record->count; k += stride) {
        double e = reading[k] - fit.intercept, d = 0.0;
        for (int j = 0; j < 3; j++) {
            e -= fit.slope[j] * imki_reference_at(channel[j], record->count, k, lag);
            d += 0.5 * fit.slope[j] *
                 (imki_reference_at(channel[j], record->count, k, lag - 1.0) -
                  imki_reference_at(channel[j], record->count, k, lag + 1.0));
        }
        if (fabs(e) < HUGE_VAL && fabs(d) < HUGE_VAL) {
            de += d * e;
            dd += d * d;
        }
    }
    *gradient += de / (fit.residual * fit.residual);
    *curvature += dd / (fit.residual * fit.residual);
}

bool imki_reference_lag(const imk_test_record *record, int sensors, double limit, double *lag,
                        double *sigma)
{
    const size_t stride = record->count / FIT_SAMPLES + 1;
    const double start = *lag;
    double at = start;
    for (int step = 0; step < LAG_STEPS; step++) {
        double gradient = 0.0, curvature = 0.0;
        for (int sensor = 0; sensor < 2; sensor++)
            for (int axis = 0; axis < record->axis_count[sensor]; axis++)
                if ((sensors >> sensor & 1) && imki_reference_channels(record, sensor))
                    add_axis(record, sensor, axis, at, stride, &gradient, &curvature);
        if (!(curvature > 0.0))
            return false;
        const double change = -gradient / curvature;
        at += fmin(fmax(change, -2.0), 2.0); /* the slope holds near the fit only */
        if (!(fabs(at - start) <= limit))
            return false;
        if (fabs(change) < 1e-6) {
            *lag = at;
            *sigma = 1.0 / sqrt(curvature);
            return true;
        }
    }
    return false;
}
