/* SPDX-License-Identifier: Apache-2.0 */
/* Specific force at another point of the body, and acceleration without gravity.
 *
 *     f' = f + alpha x r + w x (w x r),      alpha[k] = (w[k+1] - w[k-1])/(2 dt)
 *
 * with the one-sided difference at the ends, at gaps and beside rates that are not finite. Without
 * gravity,
 *
 *     a = f + C_bn g
 *
 * is the acceleration relative to the Earth in body axes (but for the Coriolis term 2 w_ie x v,
 * 1.5e-4 m/s^2 per m/s): roll and pitch from the mean force over the first seconds, when the unit
 * is still, and from there on by the strapdown of navigate.h, held at one place. A sample is a mean
 * over its interval, so gravity is turned by the attitude half-way. */
#include "convert_motion_internal.h"

#include "base/refuse_internal.h"
#include "jobs/job_internal.h"

#include "imukit/elementary.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdio.h>

static const char *requirement(const imki_convert_motion *m)
{
    return m->settings->to_point ? "to-point" : "gravity-free";
}

/* A column of each axis, none in counts. @param numbers  0 gyro, 1 accel */
static imk_status find_axis(const imki_convert_motion *m, const imk_record_source *source,
                            int sensor, int k, int *found, imk_error *error)
{
    char name[96];
    *found = imk_record_find(
        source, sensor == 0 ? IMK_QUANTITY_ANGULAR_RATE : IMK_QUANTITY_SPECIFIC_FORCE, k);
    snprintf(name, sizeof name, "%s_%c\t%s", sensor == 0 ? "gyro" : "accel", "xyz"[k],
             requirement(m));
    if (*found < 0)
        return imki_fail(m->findings, error, IMK_ERROR_COLUMN, "convert:no_axis", name, 0, NULL);
    const imk_log_column *column = &source->columns[*found];
    snprintf(name, sizeof name, "%s\t%s", column->name, requirement(m));
    if (imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension))
        return imki_fail(m->findings, error, IMK_ERROR_DIMENSION, "convert:counts", name,
                         IMKI_NUMBERS(sensor));
    return IMK_OK;
}

static imk_status check_settings(const imk_convert_log_settings *s, imk_error *error)
{
    if (!s->gravity_free)
        return IMK_OK;
    if (!(fabs(s->latitude) <= 90 * imk_unit_of("deg").scale))
        return imki_refuse(error, IMK_ERROR_RANGE, "latitude", s->latitude, 0, "within 90 deg");
    if (!(s->height >= -1e4 && s->height <= 1e5))
        return imki_refuse(error, IMK_ERROR_RANGE, "height", s->height, s->height > 0 ? 1e5 : -1e4,
                           "between -10 and 100 km");
    if (!(s->still > 0 && s->still <= 3600))
        return imki_refuse(error, IMK_ERROR_RANGE, "still", s->still, s->still > 0 ? 3600 : 0,
                           "positive, at most 1 h");
    return IMK_OK;
}

imk_status imki_convert_motion_start(imki_convert_motion *m, const imk_record_source *source,
                                     imk_error *error)
{
    imk_status status = check_settings(m->settings, error);
    m->time = imk_record_find(source, IMK_QUANTITY_TIME, -1);
    m->step_time = (double)NAN;
    for (int i = 0; i < 6 && status == IMK_OK; i++)
        status =
            find_axis(m, source, i % 2, i / 2, i % 2 ? &m->accel[i / 2] : &m->gyro[i / 2], error);
    return status;
}

/* ---- to another point -------------------------------------------------------------------------
 */

static double time_of(const imki_convert_motion *m, size_t row)
{
    return m->time >= 0 ? m->data[m->time][row] : (double)row * m->interval;
}

/* Rates of a row. @return whether they are finite */
static bool rates_of(const imki_convert_motion *m, size_t row, imk_vector3 *rate)
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        rate->v[k] = m->data[m->gyro[k]][row];
        finite = finite && isfinite(rate->v[k]);
    }
    return finite;
}

static void move_row(imki_convert_motion *m, size_t row, imk_vector3 rate, imk_vector3 acceleration)
{
    imk_vector3 turning = imk_vector3_cross(rate, imk_vector3_cross(rate, m->settings->point));
    imk_vector3 swinging = imk_vector3_cross(acceleration, m->settings->point);
    for (int k = 0; k < 3; k++)
        m->data[m->accel[k]][row] += swinging.v[k] + turning.v[k];
}

/* Every row whose successor is there. */
static void move_rows(imki_convert_motion *m)
{
    for (; m->moved < m->stored && (m->moved + 1 < m->stored || m->over); m->moved++) {
        size_t row = m->moved;
        imk_vector3 here, after, alpha = {{0, 0, 0}};
        bool finite = rates_of(m, row, &here), has_before = m->has_before, goes_on = false;
        if (row + 1 < m->stored) {
            double step = time_of(m, row + 1) - time_of(m, row);
            goes_on = !(step <= 0) && imk_step_intervals(step, m->interval) <= 1;
        }
        bool has_after = goes_on && rates_of(m, row + 1, &after);
        double span = has_before && has_after ? 2 * m->interval : m->interval;
        if (has_before || has_after)
            alpha = imk_vector3_scale(
                imk_vector3_subtract(has_after ? after : here, has_before ? m->before : here),
                1 / span);
        m->unknown += finite && !has_before && !has_after;
        move_row(m, row, here, alpha);
        m->before = here;
        m->has_before = finite && goes_on;
    }
}

/* ---- without gravity --------------------------------------------------------------------------
 */

/* Mean and rms deviation of the first `rows` rows, those that are finite. */
static void average(const double *data, size_t rows, double *mean, double *deviation)
{
    double sum = 0, squares = 0;
    size_t count = 0;
    for (size_t r = 0; r < rows; r++)
        if (isfinite(data[r])) {
            sum += data[r];
            count++;
        }
    *mean = count > 0 ? sum / (double)count : (double)NAN;
    for (size_t r = 0; r < rows; r++)
        if (isfinite(data[r]))
            squares += (data[r] - *mean) * (data[r] - *mean);
    *deviation = count > 0 ? sqrt(squares / (double)count) : 0;
}

/* Well beyond the noise of small sensors, well below what a hand does. */
static const double still_rate = 0.02, still_force = 0.5; /* rms [rad/s], [m/s^2] */

/* Roll and pitch are those of a plumb line, the yaw is that of north-east-down, of which the plumb
 * line's differs by less than the square of what matters. */
static imk_matrix3 hanging(imk_geodetic place, double roll, double pitch, double yaw)
{
    const imk_matrix3 plumb = imk_plumb_axes(place);
    double other, first;
    imk_matrix3 c_nb = imk_matrix3_multiply(plumb, imk_matrix3_from_euler(roll, pitch, yaw));
    imk_matrix3_to_euler(c_nb, &other, &other, &first);
    return imk_matrix3_multiply(plumb, imk_matrix3_from_euler(roll, pitch, yaw - (first - yaw)));
}

/* The attitude from the mean force of the first rows, when the unit is still. */
static imk_status align(imki_convert_motion *m, size_t rows, imk_error *error)
{
    const imk_convert_log_settings *o = m->settings;
    imk_vector3 rate, force;
    double rate_moves = 0, force_moves = 0, moves;
    for (int k = 0; k < 3; k++) {
        average(m->data[m->gyro[k]], rows, &rate.v[k], &moves);
        rate_moves = moves > rate_moves ? moves : rate_moves;
        average(m->data[m->accel[k]], rows, &force.v[k], &moves);
        force_moves = moves > force_moves ? moves : force_moves;
    }
    if (!(imk_vector3_norm(force) > 0))
        return imk_error_set(error, IMK_ERROR_NOT_FINITE, "accel", NULL,
                             "check the log: at its start the unit must be at rest, with a finite "
                             "specific force other than 0");
    if (rate_moves > still_rate || force_moves > still_force)
        imki_find(m->findings, IMK_FINDING_WARNING, "moves", NULL,
                  IMKI_NUMBERS(o->still, rate_moves / imk_unit_of("deg").scale, force_moves));
    double roll = imk_atan2(-force.v[1], -force.v[2]);
    double pitch = imk_atan2(force.v[0], sqrt(force.v[1] * force.v[1] + force.v[2] * force.v[2]));
    imk_geodetic place = {.latitude = o->latitude, .height = o->height};
    imk_matrix3 c_nb = hanging(place, roll, pitch, o->yaw);
    m->start = imk_navigation_state_ned(0, place, (imk_vector3){{0, 0, 0}}, c_nb);
    m->strapdown = imk_strapdown_start(&m->start);
    m->gravity = imk_gravity_ecef(m->start.position);
    imk_vector3 earth = imk_matrix3_apply(imk_matrix3_transpose(c_nb), imk_earth_rate(o->latitude));
    m->drift_rate = imk_vector3_norm(imk_vector3_subtract(rate, earth));
    double excess = imk_vector3_norm(force) - imk_vector3_norm(m->gravity);
    if (fabs(excess) > 0.05 * imk_vector3_norm(m->gravity))
        imki_find(m->findings, IMK_FINDING_WARNING, "gravity", NULL,
                  IMKI_NUMBERS(imk_vector3_norm(force), imk_vector3_norm(m->gravity)));
    m->aligned = true;
    return IMK_OK;
}

/* One row: attitude over its interval, gravity in its middle. */
static void take_gravity_out(imki_convert_motion *m, size_t row)
{
    double time = time_of(m, row), step = time - m->step_time;
    if (m->time < 0 || !(step > 0))
        step = m->interval;
    if (!isnan(time))
        m->step_time = time;
    imk_vector3 angle, velocity;
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        angle.v[k] = m->data[m->gyro[k]][row] * step;
        velocity.v[k] = 0; /* the place is held, so no force is needed */
        finite = finite && isfinite(angle.v[k]);
    }
    imk_quaternion before = m->strapdown.state.attitude;
    if (finite)
        imk_strapdown_step(&m->strapdown, step, angle, velocity);
    m->lost += !finite;
    m->duration += step;
    m->strapdown.state.position = m->start.position;
    m->strapdown.state.velocity = m->start.velocity;
    imk_quaternion after = m->strapdown.state.attitude;
    imk_quaternion middle = {before.w + after.w, before.x + after.x, before.y + after.y,
                             before.z + after.z};
    imk_vector3 gravity = imk_quaternion_rotate(
        imk_quaternion_conjugate(imk_quaternion_normalise(middle)), m->gravity);
    for (int k = 0; k < 3; k++)
        m->data[m->accel[k]][row] += gravity.v[k];
}

/* Rows that have been moved; none before the unit has been still for long enough. */
static imk_status free_rows(imki_convert_motion *m, imk_error *error)
{
    if (!m->aligned && m->moved > 0) {
        size_t rows = 1;
        while (rows < m->moved && !(time_of(m, rows) - time_of(m, 0) >= m->settings->still))
            rows++;
        if (rows == m->moved && !m->over)
            return IMK_OK;
        const double length = time_of(m, rows - 1) - time_of(m, 0) + m->interval;
        if (m->settings->still > length * (1 + 1e-9))
            return imki_refuse(error, IMK_ERROR_RANGE, "still", m->settings->still, length,
                               "at most the length of the record");
        imk_status status = align(m, rows, error);
        if (status != IMK_OK)
            return status;
    }
    for (; m->ready < m->moved; m->ready++)
        take_gravity_out(m, m->ready);
    return IMK_OK;
}

imk_status imki_convert_motion_rows(imki_convert_motion *m, imk_error *error)
{
    if (m->settings->to_point)
        move_rows(m);
    else
        m->moved = m->stored;
    if (m->settings->gravity_free)
        return free_rows(m, error);
    m->ready = m->moved;
    return IMK_OK;
}

void imki_convert_motion_warn(const imki_convert_motion *m)
{
    if (m->unknown > 0)
        imki_find(m->findings, IMK_FINDING_WARNING, "acceleration", NULL,
                  IMKI_NUMBERS((double)m->unknown));
    if (!m->aligned)
        return;
    const double angle = m->drift_rate * m->duration, degree = imk_unit_of("deg").scale;
    const double error =
        imk_vector3_norm(m->gravity) * sin(angle < 90 * degree ? angle : 90 * degree);
    imki_find(m->findings, IMK_FINDING_WARNING, "drift", NULL,
              IMKI_NUMBERS(m->drift_rate / imk_unit_of("deg/h").scale, angle / degree, error,
                           m->duration));
    if (m->lost > 0)
        imki_find(m->findings, IMK_FINDING_WARNING, "convert:not_finite", NULL,
                  IMKI_NUMBERS((double)m->lost));
}
