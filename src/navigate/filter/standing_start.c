/* SPDX-License-Identifier: Apache-2.0 */
/* Biases of gyros from their readings at rest. The mean reading over the time A, less the Earth's
 * rate in the attitude found, along north, east and down, is
 *
 *     z = C m - [w x] e + n = H x + v,    v = C (m - b) + n
 *
 * with m the means of the parts of the bias and b their values at the end, which are the states.
 * Their second moments are those of imki_bias_part_moments(), so v has the covariance J with the
 * states [SIMON2006, 7.1]:
 *
 *     cov(b, v) = cov(m, b) - var b,     cov(e, v) = M (var m - cov(m, b)),
 *     R = var m - 2 cov(m, b) + var b + N^2/A + 2 Q^2/A^2 + the unit's own rotation
 *
 * where the attitude errors contain M m of the alignment. */
#include "imukit/standing_start.h"

#include "navigation_filter_internal.h"

#include "imukit/distributions.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { ERRORS = IMK_NAVIGATION_ERRORS, PARTS_MAX = IMK_BIAS_PARTS_MAX };

static const double false_alarm = 1e-6;

/* Variances do not fall below this part of what they were, so that rounding leaves them positive.
 */
static const double least_part = 1e-12;

/* The states that the measurement is of, or goes with: attitude, then the parts of the gyros. */
enum { SEEN_MAX = 3 + 3 * PARTS_MAX };

typedef struct measurement {
    size_t rows, seen;
    double h[3][SEEN_MAX], cross[SEEN_MAX][3];
    double z[3], noise[3][3];
} measurement;

/* Number of a state that is seen. */
static size_t state_of(size_t seen)
{
    return seen < 3 ? 6 + seen : ERRORS + seen - 3;
}

static void add_part(const imk_navigation_filter *f, size_t p, const imk_matrix3 *axes,
                     double turn[3][3], double time, measurement *m)
{
    for (int axis = 0; axis < 3; axis++) {
        const imki_part_moments is = imki_bias_part_moments(&f->settings.gyro.part[p], axis, time);
        const size_t seen = 3 + 3 * p + (size_t)axis;
        for (size_t r = 0; r < m->rows; r++) {
            m->h[r][seen] = turn[r][axis];
            m->cross[seen][r] = turn[r][axis] * (is.both - is.end);
            for (size_t i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    m->cross[i][r] += axes->m[i][j] * f->settings.alignment[j][axis] *
                                      turn[r][axis] * (is.mean - is.both);
            for (size_t q = 0; q < m->rows; q++)
                m->noise[r][q] +=
                    turn[r][axis] * turn[q][axis] * (is.mean - 2.0 * is.both + is.end);
        }
    }
}

static void describe(const imk_navigation_filter *f, const imk_standing_start *stood,
                     measurement *m)
{
    static const int all[3] = {0, 1, 2}, found[2] = {0, 2};
    const int *row = stood->heading_found ? found : all;
    const imk_geodetic place = imk_geodetic_from_ecef(f->strapdown.state.position);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const imk_matrix3 c_nb = imk_matrix3_multiply(imk_matrix3_transpose(axes), f->attitude);
    const double t = stood->time;
    double turn[3][3];
    memset(m, 0, sizeof *m);
    m->rows = stood->heading_found ? 2 : 3;
    m->seen = 3 + 3 * f->parts[IMKI_GYRO_PART];
    for (size_t r = 0; r < m->rows; r++) {
        m->z[r] = -IMK_EARTH_RATE * axes.m[2][row[r]];
        m->h[r][0] = -IMK_EARTH_RATE * axes.m[1][row[r]];
        m->h[r][1] = IMK_EARTH_RATE * axes.m[0][row[r]];
        m->noise[r][r] = stood->rotation_sigma * stood->rotation_sigma;
        for (int axis = 0; axis < 3; axis++) {
            turn[r][axis] = c_nb.m[row[r]][axis];
            m->z[r] += turn[r][axis] * stood->rate.v[axis];
        }
    }
    for (size_t p = 0; p < f->parts[IMKI_GYRO_PART]; p++)
        add_part(f, p, &axes, turn, t, m);
    for (int axis = 0; axis < 3; axis++) {
        const double white = f->settings.gyro.white[axis], q = f->settings.gyro.quantization[axis];
        for (size_t r = 0; r < m->rows; r++)
            for (size_t s = 0; s < m->rows; s++)
                m->noise[r][s] +=
                    turn[r][axis] * turn[s][axis] * (white * white / t + 2.0 * q * q / (t * t));
    }
}

/* P H^T + J of all states, and the inverse of S, zeros if it has none. @return z^T S^-1 z;
 * infinity: S has no inverse */
static double expect(const imk_navigation_filter *f, const measurement *m, double *ph,
                     double inverse[9])
{
    const size_t n = f->states, rows = m->rows;
    double s[9];
    memset(inverse, 0, 9 * sizeof *inverse);
    for (size_t i = 0; i < n; i++)
        for (size_t r = 0; r < rows; r++) {
            double sum = 0.0;
            for (size_t k = 0; k < m->seen; k++)
                sum += f->covariance[i * n + state_of(k)] * m->h[r][k];
            ph[i * rows + r] = sum;
        }
    for (size_t k = 0; k < m->seen; k++)
        for (size_t r = 0; r < rows; r++)
            ph[state_of(k) * rows + r] += m->cross[k][r];
    for (size_t r = 0; r < rows; r++)
        for (size_t q = 0; q < rows; q++) {
            double sum = m->noise[r][q];
            for (size_t k = 0; k < m->seen; k++)
                sum += m->h[r][k] * ph[state_of(k) * rows + q] + m->cross[k][r] * m->h[q][k];
            s[r * rows + q] = r == q ? sum * (1.0 + least_part) : sum;
        }
    if (imk_cholesky_factor(rows, s) != IMK_OK)
        return (double)INFINITY;
    imk_cholesky_inverse(rows, s, inverse);
    double test = 0.0;
    for (size_t r = 0; r < rows; r++)
        for (size_t q = 0; q < rows; q++)
            test += m->z[r] * inverse[r * rows + q] * m->z[q];
    return test;
}

/* The errors that the measurement says, out of attitude and biases; nothing goes with position and
 * velocity yet. */
static void take_out(imk_navigation_filter *f, const measurement *m, const double *ph,
                     const double inverse[9])
{
    double gain_z[3] = {0.0};
    imk_vector3 turn = {{0.0, 0.0, 0.0}};
    for (size_t r = 0; r < m->rows; r++)
        for (size_t q = 0; q < m->rows; q++)
            gain_z[r] += inverse[r * m->rows + q] * m->z[q];
    for (size_t k = 0; k < m->seen; k++) {
        double x = 0.0;
        for (size_t r = 0; r < m->rows; r++)
            x += ph[state_of(k) * m->rows + r] * gain_z[r];
        if (k < 3) {
            turn.v[k] = -x;
            continue;
        }
        f->bias[IMKI_GYRO_PART][(k - 3) / 3][(k - 3) % 3] += x;
        f->bias_sum[IMKI_GYRO_PART].v[(k - 3) % 3] += x;
    }
    imk_navigation_state *s = &f->strapdown.state;
    s->attitude = imk_quaternion_normalise(
        imk_quaternion_multiply(imk_quaternion_from_rotation_vector(turn), s->attitude));
    f->attitude = imk_quaternion_to_matrix(s->attitude);
}

/* P - (P H^T + J) S^-1 (P H^T + J)^T */
static void reduce(imk_navigation_filter *f, size_t rows, const double *ph, const double inverse[9])
{
    const size_t n = f->states;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = f->covariance[i * n + j];
            for (size_t r = 0; r < rows; r++)
                for (size_t q = 0; q < rows; q++)
                    sum -= ph[i * rows + r] * inverse[r * rows + q] * ph[j * rows + q];
            f->covariance[i * n + j] = f->covariance[j * n + i] = sum;
        }
}

bool imk_navigation_filter_stood(imk_navigation_filter *f, const imk_standing_start *stood)
{
    measurement m;
    double inverse[9], *ph = f->scratch; /* of states x states, and rows are fewer */
    if (f->parts[IMKI_GYRO_PART] == 0 || !(stood->time > 0.0))
        return true;
    describe(f, stood, &m);
    double test = expect(f, &m, ph, inverse);
    const bool explained = test <= imk_chi_square_quantile(1.0 - false_alarm, (double)m.rows);
    if (!explained) {
        double square = 0.0;
        for (size_t r = 0; r < m.rows; r++)
            square += m.z[r] * m.z[r];
        for (size_t axis = 0; axis < 3; axis++)
            f->covariance[(ERRORS + axis) * (f->states + 1)] += square;
        test = expect(f, &m, ph, inverse);
    }
    if (!(test < (double)INFINITY))
        return explained;
    take_out(f, &m, ph, inverse);
    reduce(f, m.rows, ph, inverse);
    return explained;
}

double imk_heading_spread(double reading, double earth, double sigma)
{
    enum { POINTS = 4096 };
    static const double half_turn = 3.14159265358979323846;
    const double k = reading * earth / (sigma * sigma);
    if (!(k < 1e4)) /* narrower than the points are apart: 1/k of the variance */
        return sigma > 0.0 ? 1.0 / sqrt(k) : 0.0;
    double weights = 0.0, squares = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const double angle = half_turn * (i + 0.5) / POINTS;
        const double weight = imk_exp(k * (imk_cos(angle) - 1.0));
        weights += weight;
        squares += weight * angle * angle;
    }
    return sqrt(squares / weights);
}
