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
#include "navigation_smoother_internal.h"

#include "imukit/distributions.h"
#include "imukit/earth.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS, STATES_MAX = IMKI_FILTER_STATES_MAX };

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

/* out (states x rows) = a H^T, a of states x states */
static void times_measured(const imk_navigation_filter *f, const double *a, size_t rows,
                           const double *h, double *out)
{
    const size_t n = f->states;
    memset(out, 0, n * rows * sizeof *out);
    for (size_t r = 0; r < rows; r++)
        for (size_t k = 0; k < n; k++) {
            const double factor = h[r * n + k];
            for (size_t i = 0; i < n && factor != 0.0; i++)
                out[i * rows + r] += factor * a[i * n + k];
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
    for (size_t k = 0; k < f->aid_states; k++)
        f->aid_state[k].estimate += x[f->first_aid_state + k];
}

/* P by Joseph's form; gain and cross are states x rows. */
static void update_covariance(imk_navigation_filter *f, size_t rows, const double *h,
                              const double *gain, const double noise[3][3], const double *cross)
{
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

/* Innovation covariance S, its inverse, and P H^T + J. */
typedef struct expectation {
    double s[3][3], inverse[3][3];
    double ph[3 * STATES_MAX];
} expectation;

/* @param factor  by which P is to be multiplied @return false: S has no inverse */
static bool expect(const imk_navigation_filter *f, const imki_measurement *m, double factor,
                   expectation *e)
{
    const size_t n = f->states;
    times_measured(f, f->covariance, m->rows, m->h, e->ph);
    for (size_t i = 0; i < n * m->rows; i++)
        e->ph[i] = factor * e->ph[i] + (m->cross ? m->cross[i] : 0.0);
    for (size_t r = 0; r < m->rows; r++)
        for (size_t q = 0; q < m->rows; q++) {
            e->s[r][q] = m->noise[r][q];
            for (size_t k = 0; k < n; k++)
                e->s[r][q] += m->h[r * n + k] * e->ph[k * m->rows + q] +
                              (m->cross ? m->cross[k * m->rows + r] * m->h[q * n + k] : 0.0);
        }
    return invert(m->rows, e->s, e->inverse);
}

static double squared(const imki_measurement *m, double inverse[3][3])
{
    double sum = 0.0;
    for (size_t r = 0; r < m->rows; r++)
        for (size_t q = 0; q < m->rows; q++)
            sum += m->z[r] * inverse[r][q] * m->z[q];
    return sum;
}

static void note_innovation(imk_navigation_filter *f, const imki_measurement *m,
                            const expectation *e, double test, bool accepted)
{
    imk_innovation *i = &f->innovation;
    *i = (imk_innovation){.rows = m->rows, .chi_square = test, .accepted = accepted};
    for (size_t r = 0; r < m->rows; r++) {
        i->axis[r] = m->axis[r];
        i->value[r] = m->z[r];
        i->sigma[r] = sqrt(e->s[r][r]);
    }
}

static void refuse(imk_navigation_filter *f, imk_navigation_filter_counts *counts)
{
    if (counts->refused++ == 0)
        counts->first_refused = f->strapdown.state.time;
    counts->refused_in_row++;
}

/* L^-1 z, with S = L L^T: independent normal numbers if all is as described. */
static void whiten(const imki_measurement *m, const expectation *e, double u[3])
{
    double factor[9];
    for (size_t k = 0; k < m->rows * m->rows; k++)
        factor[k] = e->s[k / m->rows][k % m->rows];
    imk_cholesky_factor(m->rows, factor);
    for (size_t r = 0; r < m->rows; r++) {
        u[r] = m->z[r];
        for (size_t q = 0; q < r; q++)
            u[r] -= factor[r * m->rows + q] * u[q];
        u[r] /= factor[r * m->rows + r];
    }
}

static void count(imk_navigation_filter *f, size_t kind, const imki_measurement *m,
                  const expectation *e, double test)
{
    imk_navigation_filter_counts *counts = &f->counts[kind];
    imki_whitened *before = &f->whitened[kind];
    double u[3];
    whiten(m, e, u);
    counts->accepted++;
    counts->refused_in_row = 0;
    counts->degrees += m->rows;
    counts->chi_square += test;
    if (before->rows == m->rows) {
        counts->pairs += m->rows;
        for (size_t r = 0; r < m->rows; r++)
            counts->pair_sum += before->value[r] * u[r];
    }
    before->rows = m->rows;
    memcpy(before->value, u, m->rows * sizeof *u);
}

/* The noise of the gyros since the stand began is now in other errors, too: J <- (I - K H) J. */
static void update_cross(imk_navigation_filter *f, const imki_measurement *m)
{
    const size_t n = f->states;
    double hj[3][3] = {{0}};
    for (size_t r = 0; r < m->rows; r++)
        for (size_t k = 0; k < n; k++)
            for (size_t axis = 0; axis < 3; axis++)
                hj[r][axis] += m->h[r * n + k] * f->cross[3 * k + axis];
    for (size_t i = 0; i < n; i++)
        for (size_t r = 0; r < m->rows; r++)
            for (size_t axis = 0; axis < 3; axis++)
                f->cross[3 * i + axis] -= f->gain[i * m->rows + r] * hj[r][axis];
}

/* K, and with it the errors and P. */
static void correct(imk_navigation_filter *f, const imki_measurement *m, expectation *e)
{
    const size_t n = f->states, rows = m->rows;
    double x[STATES_MAX];
    for (size_t i = 0; i < n; i++) {
        x[i] = 0.0;
        for (size_t r = 0; r < rows; r++) {
            double sum = 0.0;
            for (size_t q = 0; q < rows; q++)
                sum += e->ph[i * rows + q] * e->inverse[q][r];
            f->gain[i * rows + r] = sum;
            x[i] += sum * m->z[r];
        }
    }
    f->rows = rows;
    memcpy(f->h, m->h, rows * n * sizeof *f->h);
    if (f->smoother)
        imki_smoother_update(f->smoother, m, f->gain, e->inverse);
    update_covariance(f, rows, m->h, f->gain, m->noise, m->cross);
    if (!m->cross && f->settings.rotation_sigma > 0.0)
        update_cross(f, m);
    take_out(f, x);
}

/* After many refusals in a row the estimate is wrong, or the aid: P is multiplied by what makes the
 * innovation as large as expected. Its correlations stay, and lead velocity, tilt and biases back
 * with the position. */
static bool recovers(imk_navigation_filter *f, size_t kind, const imki_measurement *m,
                     expectation *e, double *test)
{
    const size_t n = f->states;
    if (kind == IMK_AIDS_MAX || f->settings.recover_after == 0 ||
        f->counts[kind].refused_in_row < (uint64_t)f->settings.recover_after)
        return false;
    const double factor = *test / (double)m->rows;
    if (!(factor < 1e12) || !expect(f, m, factor, e))
        return false;
    *test = squared(m, e->inverse);
    if (!(*test <= f->limit[m->rows - 1]))
        return false;
    for (size_t i = 0; i < n * n; i++)
        f->covariance[i] *= factor;
    return true;
}

imk_aid_verdict imki_navigation_filter_measure(imk_navigation_filter *f, size_t kind,
                                               const imki_measurement *m)
{
    imk_navigation_filter_counts *counts = &f->counts[kind];
    expectation e;
    const bool solved = expect(f, m, 1.0, &e);
    double test = solved ? squared(m, e.inverse) : (double)INFINITY;
    const bool fits = test <= f->limit[m->rows - 1];
    note_innovation(f, m, &e, test, fits);
    if (m->compare)
        return fits ? IMK_AID_USED : IMK_AID_REFUSED;
    if (!fits && !(solved && recovers(f, kind, m, &e, &test))) {
        refuse(f, counts);
        return IMK_AID_REFUSED;
    }
    if (!fits && counts->recovered++ == 0)
        counts->first_recovered = f->strapdown.state.time;
    count(f, kind, m, &e, test);
    correct(f, m, &e);
    return fits ? IMK_AID_USED : IMK_AID_RECOVERED;
}

/* ---- stands ---------------------------------------------------------------------------------- */

/* Axes of measurement: north, east, and down unless the vertical is held. */
static size_t measured_axes(const imk_navigation_filter *f, imk_matrix3 *axes)
{
    const imk_geodetic place = imk_geodetic_from_ecef(f->strapdown.state.position);
    *axes = imk_ned_axes(place.latitude, place.longitude);
    return f->settings.hold_height ? 2 : 3;
}

static bool zero_velocity(imk_navigation_filter *f)
{
    imki_measurement m = {.axis = {0, 1, 2}};
    imk_matrix3 axes;
    const size_t n = f->states;
    m.rows = measured_axes(f, &axes);
    const imk_matrix3 c_nb = imk_matrix3_multiply(imk_matrix3_transpose(axes), f->attitude);
    const double still = f->settings.velocity_sigma;
    for (size_t r = 0; r < m.rows; r++) {
        for (size_t i = 0; i < 3; i++) {
            m.h[r * n + 3 + i] = axes.m[i][r];
            m.z[r] += axes.m[i][r] * f->strapdown.state.velocity.v[i];
        }
        for (size_t q = 0; q < m.rows; q++) {
            m.noise[r][q] = r == q ? still * still : 0.0;
            for (int k = 0; k < 3; k++) {
                const double step = f->settings.accel.quantization[k];
                m.noise[r][q] += c_nb.m[r][k] * c_nb.m[q][k] * step * step;
            }
        }
    }
    return imki_navigation_filter_measure(f, IMK_AIDS_MAX, &m) == IMK_AID_USED;
}

/* The integral of the gyros' noise, s, is the measurement's noise times the time of the stand. */
static bool zero_rotation(imk_navigation_filter *f)
{
    imki_measurement m = {.rows = 3, .axis = {0, 1, 2}};
    double cross[3 * STATES_MAX];
    const size_t n = f->states;
    const double time = f->stand;
    for (size_t r = 0; r < 3; r++) {
        const double *column = &f->stand_attitude.m[0][r];
        const double white = f->settings.gyro.white[r], step = f->settings.gyro.quantization[r];
        /* -C^T [w x], w along z: columns x and y. */
        m.h[r * n + 6] = -IMK_EARTH_RATE * column[3] / time;
        m.h[r * n + 7] = IMK_EARTH_RATE * column[0] / time;
        for (size_t p = 0; p < f->parts[IMKI_GYRO_PART]; p++)
            m.h[r * n + ERRORS + 3 * p + r] = 1.0;
        m.z[r] = f->stand_turn.v[r] / time;
        m.noise[r][r] = white * white / time + 2.0 * step * step / (time * time) +
                        f->settings.rotation_sigma * f->settings.rotation_sigma;
    }
    for (size_t i = 0; i < 3 * n; i++)
        cross[i] = f->cross[i] / time;
    m.cross = cross;
    return imki_navigation_filter_measure(f, IMK_AIDS_MAX, &m) == IMK_AID_USED;
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
