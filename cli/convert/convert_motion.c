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
#include "convert_motion.h"

#include "imukit/elementary.h"
#include "imukit/navigate.h"
#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(convert_motion_options, member)

const option convert_motion_option_table[CONVERT_MOTION_OPTIONS] = {
    {"to-point", 0, A_TEXT("\"X Y Z UNIT\""), AT(to_point),
     "specific force at another point of the body, forward right down of the accelerometers, such "
     "as \"0.1 0 -0.05 m\""},
    {"gravity-free", 0, A_FLAG, AT(gravity_free),
     "acceleration relative to the Earth instead of specific force; needs --latitude, and a unit "
     "that is still at first"},
    {"still", 0, A_QUANTITY("TIME", "s", NULL), AT(still),
     "how long it is still, for roll and pitch; default 10s"},
    {"latitude", 0, A_QUANTITY("ANGLE", "deg", "-90..90"), AT(latitude), "geodetic, for gravity"},
    {"height", 0, A_QUANTITY("LENGTH", "m", "-10000..100000"), AT(height),
     "above the ellipsoid; default 0m"},
    {"yaw", 0, A_QUANTITY("ANGLE", "deg", "-36000..36000"), AT(yaw),
     "at first, from north to east, for the Earth's rotation; default 0deg"},
};

convert_motion_options convert_motion_default(void)
{
    return (convert_motion_options){.still = 10, .latitude = (double)NAN};
}

enum { CHUNK_ROWS = 65536 };

struct convert_motion {
    convert_motion_options options;
    size_t column_count, capacity;
    double *data[IMK_LOG_COLUMNS_MAX];
    int time, gyro[3], accel[3];
    /* Rows at the head of the buffers: read, moved to the point, ready to be given out. */
    size_t stored, moved, ready;
    bool begun, over;
    double interval;
    imk_vector3 point, before; /* the point [m]; rates of the row before the next to be moved */
    bool has_before;
    uint64_t unknown; /* rows without a neighbour to tell their angular acceleration */
    /* Without gravity. */
    bool aligned;
    imk_strapdown strapdown;
    imk_navigation_state start;
    imk_vector3 gravity;
    double step_time;            /* of the row before [s] */
    double duration, drift_rate; /* [s], [rad/s] */
    uint64_t lost;               /* rows without finite rates: the attitude was held */
};

/* ---- options ----------------------------------------------------------------------------------
 */

static int parse_point(const char *text, double point[3])
{
    double sigma[3];
    size_t count;
    imk_error error;
    imk_status status = imk_quantity_parse(text, text + strlen(text), imk_unit_of("m").dimension, 3,
                                           point, sigma, &count, NULL, &error);
    if (status == IMK_OK && count == 3)
        return -1;
    return command_misused("--to-point %s: expected three lengths with their unit, such as "
                           "\"0.1 0 -0.05 m\"",
                           text);
}

static int check_options(const convert_motion_options *o)
{
    if (!o->gravity_free)
        return -1;
    if (isnan(o->latitude))
        return command_misused("--gravity-free: gravity differs from place to place: add "
                               "--latitude 45deg and, off the sea, --height 500m");
    if (!(fabs(o->latitude) <= 90 * imk_unit_of("deg").scale))
        return command_misused("--latitude must be within 90 deg");
    if (!(o->height >= -1e4 && o->height <= 1e5))
        return command_misused("--height must be between -10 and 100 km");
    if (!(o->still > 0 && o->still <= 3600))
        return command_misused("--still must be positive, at most 1 h");
    return -1;
}

static int find_columns(convert_motion *m, imk_log_reader *reader, const char *log)
{
    m->time = imk_log_column_find(reader, IMK_QUANTITY_TIME, -1);
    for (int k = 0; k < 3; k++) {
        m->gyro[k] = imk_log_column_find(reader, IMK_QUANTITY_ANGULAR_RATE, k);
        m->accel[k] = imk_log_column_find(reader, IMK_QUANTITY_SPECIFIC_FORCE, k);
        int both[2] = {m->gyro[k], m->accel[k]};
        for (int sensor = 0; sensor < 2; sensor++) {
            const char *option_name = m->options.to_point ? "to-point" : "gravity-free";
            if (both[sensor] < 0)
                return command_failed("%s has no column %s_%c, which --%s needs", log,
                                      sensor == 0 ? "gyro" : "accel", "xyz"[k], option_name);
            const imk_log_column *column = imk_log_column_get(reader, (size_t)both[sensor]);
            if (imk_dimension_equal(column->unit.dimension, imk_unit_of("count").dimension))
                return command_failed("%s: %s is in counts, and --%s needs %s: imukit compensate "
                                      "makes them, by a model with a sensitivity",
                                      log, column->name, option_name,
                                      sensor == 0 ? "rates" : "forces");
        }
    }
    return -1;
}

static void grow(convert_motion *m, size_t capacity)
{
    for (size_t k = 0; k < m->column_count; k++)
        m->data[k] = command_memory(m->data[k], capacity * sizeof *m->data[k]);
    m->capacity = capacity;
}

static void free_motion(convert_motion *m)
{
    for (size_t k = 0; k < m->column_count; k++)
        free(m->data[k]);
    free(m);
}

int convert_motion_start(const convert_motion_options *o, imk_log_reader *reader, const char *log,
                         convert_motion **motion)
{
    imk_vector3 point = {{0, 0, 0}};
    *motion = NULL;
    if (!o->to_point && !o->gravity_free)
        return -1;
    int code = o->to_point ? parse_point(o->to_point, point.v) : -1;
    if (code < 0)
        code = check_options(o);
    if (code >= 0)
        return code;
    convert_motion *m = command_memory(NULL, sizeof *m);
    *m = (convert_motion){.options = *o,
                          .column_count = imk_log_column_count(reader),
                          .point = point,
                          .step_time = (double)NAN};
    code = find_columns(m, reader, log);
    if (code >= 0) {
        free_motion(m);
        return code;
    }
    grow(m, CHUNK_ROWS);
    *motion = m;
    return -1;
}

/* ---- to another point -------------------------------------------------------------------------
 */

static double time_of(const convert_motion *m, size_t row)
{
    return m->time >= 0 ? m->data[m->time][row] : (double)row * m->interval;
}

/* Rates of a row. @return whether they are finite */
static bool rates_of(const convert_motion *m, size_t row, imk_vector3 *rate)
{
    bool finite = true;
    for (int k = 0; k < 3; k++) {
        rate->v[k] = m->data[m->gyro[k]][row];
        finite = finite && isfinite(rate->v[k]);
    }
    return finite;
}

static void move_row(convert_motion *m, size_t row, imk_vector3 rate, imk_vector3 acceleration)
{
    imk_vector3 turning = imk_vector3_cross(rate, imk_vector3_cross(rate, m->point));
    imk_vector3 swinging = imk_vector3_cross(acceleration, m->point);
    for (int k = 0; k < 3; k++)
        m->data[m->accel[k]][row] += swinging.v[k] + turning.v[k];
}

/* Every row whose successor is there. */
static void move_rows(convert_motion *m)
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

/* The attitude from the mean force of the first rows, when the unit is still. */
static imk_status align(convert_motion *m, size_t rows, imk_error *error)
{
    const convert_motion_options *o = &m->options;
    imk_vector3 rate, force;
    double rate_moves = 0, force_moves = 0, moves;
    for (int k = 0; k < 3; k++) {
        average(m->data[m->gyro[k]], rows, &rate.v[k], &moves);
        rate_moves = moves > rate_moves ? moves : rate_moves;
        average(m->data[m->accel[k]], rows, &force.v[k], &moves);
        force_moves = moves > force_moves ? moves : force_moves;
    }
    if (!(imk_vector3_norm(force) > 0))
        return imk_error_set(error, IMK_ERROR_NOT_FINITE, "accel", "no finite specific force",
                             "a unit that is still at first");
    if (rate_moves > still_rate || force_moves > still_force)
        command_warn("moves",
                     "the unit moves in the first %g s (%.3g deg/s, %.3g m/s^2 rms): roll "
                     "and pitch are wrong by as much; shorten --still",
                     o->still, rate_moves / imk_unit_of("deg").scale, force_moves);
    double roll = imk_atan2(-force.v[1], -force.v[2]);
    double pitch = imk_atan2(force.v[0], sqrt(force.v[1] * force.v[1] + force.v[2] * force.v[2]));
    imk_matrix3 c_nb = imk_matrix3_from_euler(roll, pitch, o->yaw);
    imk_geodetic place = {.latitude = o->latitude, .height = o->height};
    m->start = imk_navigation_state_ned(0, place, (imk_vector3){{0, 0, 0}}, c_nb);
    m->strapdown = imk_strapdown_start(&m->start);
    m->gravity = imk_gravity_ecef(m->start.position);
    imk_vector3 earth = imk_matrix3_apply(imk_matrix3_transpose(c_nb), imk_earth_rate(o->latitude));
    m->drift_rate = imk_vector3_norm(imk_vector3_subtract(rate, earth));
    double excess = imk_vector3_norm(force) - imk_vector3_norm(m->gravity);
    if (fabs(excess) > 0.05 * imk_vector3_norm(m->gravity))
        command_warn("gravity", "the mean force while still is %.4g m/s^2 and gravity %.4g m/s^2",
                     imk_vector3_norm(force), imk_vector3_norm(m->gravity));
    m->aligned = true;
    return IMK_OK;
}

/* One row: attitude over its interval, gravity in its middle. */
static void take_gravity_out(convert_motion *m, size_t row)
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
static imk_status free_rows(convert_motion *m, imk_error *error)
{
    if (!m->aligned && m->moved > 0) {
        size_t rows = 1;
        while (rows < m->moved && !(time_of(m, rows) - time_of(m, 0) >= m->options.still))
            rows++;
        if (rows == m->moved && !m->over)
            return IMK_OK;
        imk_status status = align(m, rows, error);
        if (status != IMK_OK)
            return status;
    }
    for (; m->ready < m->moved; m->ready++)
        take_gravity_out(m, m->ready);
    return IMK_OK;
}

/* ---- rows -------------------------------------------------------------------------------------
 */

static imk_status fill(convert_motion *m, imk_log_reader *reader, imk_error *error)
{
    double *place[IMK_LOG_COLUMNS_MAX];
    size_t got;
    if (m->capacity - m->stored < CHUNK_ROWS)
        grow(m, m->stored + CHUNK_ROWS);
    for (size_t k = 0; k < m->column_count; k++)
        place[k] = m->data[k] + m->stored;
    imk_status status = imk_log_read(reader, CHUNK_ROWS, place, &got, error);
    if (status != IMK_OK)
        return status;
    if (!m->begun) {
        m->interval = imk_log_findings_get(reader).interval;
        m->begun = true;
    }
    if (!(m->interval > 0)) /* a single row has none, and no use for it */
        m->interval = 1;
    m->stored += got;
    m->over = got == 0;
    if (m->options.to_point)
        move_rows(m);
    else
        m->moved = m->stored;
    if (m->options.gravity_free)
        return free_rows(m, error);
    m->ready = m->moved;
    return IMK_OK;
}

imk_status convert_motion_read(convert_motion *motion, imk_log_reader *reader, size_t max_rows,
                               double *const *columns, size_t *rows, imk_error *error)
{
    convert_motion *m = motion;
    if (!m)
        return imk_log_read(reader, max_rows, columns, rows, error);
    while (m->ready == 0 && !m->over) {
        imk_status status = fill(m, reader, error);
        if (status != IMK_OK)
            return status;
    }
    size_t given = m->ready < max_rows ? m->ready : max_rows;
    for (size_t k = 0; k < m->column_count; k++) {
        if (columns[k])
            memcpy(columns[k], m->data[k], given * sizeof *columns[k]);
        memmove(m->data[k], m->data[k] + given, (m->stored - given) * sizeof *m->data[k]);
    }
    m->stored -= given;
    m->moved -= given;
    m->ready -= given;
    *rows = given;
    return IMK_OK;
}

void convert_motion_end(convert_motion *motion)
{
    if (!motion)
        return;
    const convert_motion *m = motion;
    if (m->unknown > 0)
        command_warn("acceleration",
                     "%llu rows have no neighbour with finite rates: their angular acceleration is "
                     "taken as zero",
                     (unsigned long long)m->unknown);
    if (m->aligned) {
        double angle = m->drift_rate * m->duration, quarter_turn = 90 * imk_unit_of("deg").scale;
        double error =
            imk_vector3_norm(m->gravity) * sin(angle < quarter_turn ? angle : quarter_turn);
        command_warn("drift",
                     "attitude comes from the gyros alone: while still they were off by "
                     "%.3g deg/h, which makes up to %.3g deg and %.3g m/s^2 in the %.4g s "
                     "of this log",
                     m->drift_rate / imk_unit_of("deg/h").scale, angle / imk_unit_of("deg").scale,
                     error, m->duration);
        if (m->lost > 0)
            command_warn("not_finite", "%llu rows have no finite rates: the attitude was held",
                         (unsigned long long)m->lost);
    }
    free_motion(motion);
}
