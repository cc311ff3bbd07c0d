/* SPDX-License-Identifier: Apache-2.0 */
/* Updates of the navigation filter. What is measured is z = H x + v, with noise v of covariance
 * R and, for the rotation, of covariance J with the errors x, since the gyros' noise that the mean
 * rate has is in the attitude already [SIMON2006, 7.1]:
 *
 *     S = H P H^T + H J + J^T H^T + R,     K = (P H^T + J) S^-1
 *     x <- K z, taken out of the state,    z^T S^-1 z chi-square when all is as described
 *     P <- (I-KH) P (I-KH)^T - (I-KH) J K^T - K J^T (I-KH)^T + K R K^T             (Joseph)
 *
 * Zero velocity: z is the velocity, less what quantization of the integrated force adds to its
 * noise. Zero rotation: z is the mean over the stand of what the gyros read beyond biases and the
 * Earth's rate, which is b_g - C^T [w x] e and noise. */
#include "navigation_filter_internal.h"

#include "imukit/distributions.h"
#include "imukit/earth.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS };

/* Inverse of a positive definite matrix of one to three rows; false when it is not. */
static bool invert(size_t rows, double s[3][3], double inverse[3][3])
{
    double factor[9], all[9];
    for (size_t k = 0; k < rows * rows; k++)
        factor[k] = s[k / rows][k % rows];
    if (imk_cholesky_factor(rows, factor) != IMK_OK)
        return false;
    imk_cholesky_inverse(rows, factor, all);
    for (size_t k = 0; k < rows * rows; k++)
        inverse[k / rows][k % rows] = all[k];
    return true;
}

/* out (states x rows) = a (states x states, or its transpose) H^T */
static void times_measured(const imk_navigation_filter *f, const double *a, size_t rows,
                           const double *h, double *out)
{
    const size_t n = f->states;
    for (size_t i = 0; i < n; i++)
        for (size_t r = 0; r < rows; r++) {
            double sum = 0.0;
            for (size_t k = 0; k < n; k++)
                sum += a[i * n + k] * h[r * n + k];
            out[i * rows + r] = sum;
        }
}

/* The errors x, out of the state. */
static void take_out(imk_navigation_filter *f, const double *x)
{
    imk_navigation_state *s = &f->strapdown.state;
    imk_vector3 turn;
    for (int i = 0; i < 3; i++) {
        s->position.v[i] -= x[i];
        s->velocity.v[i] -= x[3 + i];
        turn.v[i] = -x[6 + i];
    }
    s->attitude = imk_quaternion_normalise(
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), s->attitude));
    f->strapdown.attitude_low = (imk_quaternion){0};
    f->attitude = imk_quaternion_to_matrix(s->attitude);
    const double *part = x + ERRORS;
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < f->parts[sensor]; p++)
            for (int axis = 0; axis < 3; axis++, part++) {
                f->bias[sensor][p][axis] += *part;
                f->bias_sum[sensor].v[axis] += *part;
            }
}

/* P by Joseph's form; gain and cross are states x rows. */
static void update_covariance(imk_navigation_filter *f, size_t rows, const double *h,
                              const double *gain, double noise[3][3], const double *cross)
{
    enum { STATES_MAX = ERRORS + 6 * IMK_BIAS_PARTS_MAX };
    const size_t n = f->states;
    double *m = f->scratch, *p = f->covariance;
    double hp[3][STATES_MAX], mh[3 * STATES_MAX], rest[3 * STATES_MAX] = {0};
    memset(hp, 0, sizeof hp);
    for (size_t r = 0; r < rows; r++)
        for (size_t k = 0; k < n; k++)
            for (size_t j = 0; j < n && h[r * n + k] != 0.0; j++)
                hp[r][j] += h[r * n + k] * p[k * n + j];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double sum = p[i * n + j];
            for (size_t r = 0; r < rows; r++)
                sum -= gain[i * rows + r] * hp[r][j];
            m[i * n + j] = sum;
        }
    times_measured(f, m, rows, h, mh);
    for (size_t i = 0; i < n && cross != NULL; i++)
        for (size_t r = 0; r < rows; r++) {
            double sum = cross[i * rows + r];
            for (size_t q = 0; q < rows; q++)
                for (size_t k = 0; k < n; k++)
                    sum -= gain[i * rows + q] * h[q * n + k] * cross[k * rows + r];
            rest[i * rows + r] = sum;
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = 0.5 * (m[i * n + j] + m[j * n + i]);
            for (size_t r = 0; r < rows; r++) {
                const double a = gain[i * rows + r], b = gain[j * rows + r];
                sum -= 0.5 * (mh[i * rows + r] * b + mh[j * rows + r] * a);
                sum -= rest[i * rows + r] * b + a * rest[j * rows + r];
                for (size_t q = 0; q < rows; q++)
                    sum += a * noise[r][q] * gain[j * rows + q];
            }
            p[i * n + j] = p[j * n + i] = sum;
        }
}

bool imki_navigation_filter_measure(imk_navigation_filter *f, size_t rows, const double *h,
                                    const double z[3], double noise[3][3], const double *cross)
{
    enum { STATES_MAX = ERRORS + 6 * IMK_BIAS_PARTS_MAX };
    const size_t n = f->states;
    double ph[3 * STATES_MAX], x[STATES_MAX], s[3][3], inverse[3][3], *gain = f->gain;
    times_measured(f, f->covariance, rows, h, ph);
    for (size_t i = 0; i < n * rows && cross != NULL; i++)
        ph[i] += cross[i];
    for (size_t r = 0; r < rows; r++)
        for (size_t q = 0; q < rows; q++) {
            s[r][q] = noise[r][q];
            for (size_t k = 0; k < n; k++)
                s[r][q] += h[r * n + k] * ph[k * rows + q] +
                           (cross != NULL ? cross[k * rows + r] * h[q * n + k] : 0.0);
        }
    double test = 0.0;
    const bool solved = invert(rows, s, inverse);
    for (size_t r = 0; r < rows && solved; r++)
        for (size_t q = 0; q < rows; q++)
            test += z[r] * inverse[r][q] * z[q];
    const double limit = imk_chi_square_quantile(1.0 - f->settings.false_alarm, (double)rows);
    if (!solved || !(test <= limit)) {
        if (f->counts.refused++ == 0)
            f->counts.first_refused = f->strapdown.state.time;
        f->counts.refused_in_row++;
        return false;
    }
    f->counts.accepted++;
    f->counts.refused_in_row = 0;
    f->counts.degrees += rows;
    f->counts.chi_square += test;
    for (size_t i = 0; i < n; i++) {
        x[i] = 0.0;
        for (size_t r = 0; r < rows; r++) {
            gain[i * rows + r] = 0.0;
            for (size_t q = 0; q < rows; q++)
                gain[i * rows + r] += ph[i * rows + q] * inverse[q][r];
            x[i] += gain[i * rows + r] * z[r];
        }
    }
    f->rows = rows;
    memcpy(f->h, h, rows * n * sizeof *h);
    update_covariance(f, rows, h, gain, noise, cross);
    take_out(f, x);
    return true;
}

/* Axes of measurement: north, east, and down unless the vertical is held. */
static size_t measured_axes(const imk_navigation_filter *f, imk_matrix3 *axes)
{
    const imk_geodetic place = imk_geodetic_from_ecef(f->strapdown.state.position);
    *axes = imk_ned_axes(place.latitude, place.longitude);
    return f->settings.hold_height ? 2 : 3;
}

static bool zero_velocity(imk_navigation_filter *f)
{
    double h[3 * (ERRORS + 6 * IMK_BIAS_PARTS_MAX)] = {0}, z[3] = {0}, noise[3][3];
    imk_matrix3 axes;
    const size_t rows = measured_axes(f, &axes), n = f->states;
    const imk_matrix3 c_nb = imk_matrix3_multiply(imk_matrix3_transpose(axes), f->attitude);
    const double still = f->settings.velocity_sigma;
    for (size_t r = 0; r < rows; r++) {
        for (size_t i = 0; i < 3; i++) {
            h[r * n + 3 + i] = axes.m[i][r];
            z[r] += axes.m[i][r] * f->strapdown.state.velocity.v[i];
        }
        for (size_t q = 0; q < rows; q++) {
            noise[r][q] = r == q ? still * still : 0.0;
            for (int k = 0; k < 3; k++) {
                const double step = f->settings.accel.quantization[k];
                noise[r][q] += c_nb.m[r][k] * c_nb.m[q][k] * step * step;
            }
        }
    }
    return imki_navigation_filter_measure(f, rows, h, z, noise, NULL);
}

/* The integral of the gyros' noise, s, is the measurement's noise times the time of the stand. */
static bool zero_rotation(imk_navigation_filter *f)
{
    enum { STATES_MAX = ERRORS + 6 * IMK_BIAS_PARTS_MAX };
    double h[3 * STATES_MAX] = {0}, cross[3 * STATES_MAX] = {0}, z[3], noise[3][3] = {{0}};
    const size_t n = f->states;
    const double time = f->stand;
    for (size_t r = 0; r < 3; r++) {
        const double *column = &f->stand_attitude.m[0][r];
        const double white = f->settings.gyro.white[r], step = f->settings.gyro.quantization[r];
        /* -C^T [w x], w along z: columns x and y. */
        h[r * n + 6] = -IMK_EARTH_RATE * column[3] / time;
        h[r * n + 7] = IMK_EARTH_RATE * column[0] / time;
        for (size_t p = 0; p < f->parts[IMKI_GYRO_PART]; p++)
            h[r * n + ERRORS + 3 * p + r] = 1.0;
        z[r] = f->stand_turn.v[r] / time;
        noise[r][r] = white * white / time + 2.0 * step * step / (time * time) +
                      f->settings.rotation_sigma * f->settings.rotation_sigma;
    }
    for (size_t i = 0; i < 3 * n; i++)
        cross[i] = f->cross[i] / time;
    return imki_navigation_filter_measure(f, 3, h, z, noise, cross);
}

bool imk_navigation_filter_stand(imk_navigation_filter *filter)
{
    imki_navigation_filter_propagate(filter);
    bool good = true;
    if (filter->settings.rotation_sigma > 0.0 && filter->stand > 0.0)
        good = zero_rotation(filter);
    good = zero_velocity(filter) && good;
    imk_navigation_filter_moved(filter);
    return good;
}

bool imk_navigation_filter_fix(imk_navigation_filter *filter, imk_geodetic place, imk_vector3 sigma)
{
    double h[3 * (ERRORS + 6 * IMK_BIAS_PARTS_MAX)] = {0}, z[3], noise[3][3] = {{0}};
    const size_t n = filter->states;
    imki_navigation_filter_propagate(filter);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const imk_vector3 off =
        imk_vector3_subtract(filter->strapdown.state.position, imk_ecef_from_geodetic(place));
    size_t rows = 0;
    for (size_t axis = 0; axis < 3; axis++) {
        if (!(sigma.v[axis] > 0.0 && sigma.v[axis] < (double)INFINITY) ||
            (axis == 2 && filter->settings.hold_height))
            continue;
        z[rows] = 0.0;
        for (size_t i = 0; i < 3; i++) {
            h[rows * n + i] = axes.m[i][axis];
            z[rows] += axes.m[i][axis] * off.v[i];
        }
        noise[rows][rows] = sigma.v[axis] * sigma.v[axis];
        rows++;
    }
    if (rows == 0)
        return true;
    const bool good = imki_navigation_filter_measure(filter, rows, h, z, noise, NULL);
    /* The noise since the stand began is now in other errors. */
    imk_navigation_filter_moved(filter);
    return good;
}
