/* SPDX-License-Identifier: Apache-2.0 */
/* The attitude at the start: found, or given; and whether what the sensors read at rest can be
 * gravity and the Earth's rotation. */
#include "navigate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static imk_vector3 increment(const navigation *n, int sensor, size_t row)
{
    imk_vector3 out;
    for (int i = 0; i < 3; i++)
        out.v[i] = n->reading[3 * sensor + i][row] * n->dt;
    return out;
}

/* Mean reading of the time of alignment. */
static imk_vector3 mean_reading(const navigation *n, int sensor)
{
    imk_vector3 sum = {{0}};
    for (size_t row = 0; row < n->first; row++)
        for (int i = 0; i < 3; i++)
            sum.v[i] += n->reading[3 * sensor + i][row];
    return imk_vector3_scale(sum, 1.0 / (double)n->first);
}

/* The unit in which the numbers of the file would be gravity, or NULL. */
static const char *likely_unit(const imk_log_column *column, double ratio)
{
    static const char *const rates[] = {"m/s^2", "g", "mg", "ug", "mm/s^2", "cm/s^2"};
    static const char *const increments[] = {"m/s", "g*s", "mg*s", "ug*s", "mm/s", "cm/s"};
    const char *const *units = column->increment ? increments : rates;
    for (int k = 0; k < 6; k++) {
        const double scale = imk_unit_of(units[k]).scale / column->unit.scale;
        if (fabs(ratio * scale - 1.0) < 0.05)
            return units[k];
    }
    return NULL;
}

static int check_force(const navigation *n)
{
    const double ratio = imk_vector3_norm(mean_reading(n, 1)) /
                         imk_normal_gravity(n->place.latitude, n->place.height);
    if (fabs(ratio - 1.0) <= 0.05)
        return -1;
    const int c = imk_log_find(&n->channels.log, IMK_QUANTITY_SPECIFIC_FORCE, 0);
    const imk_log_column *column = &n->channels.log.column[c];
    const char *unit = likely_unit(column, ratio);
    if (unit && strcmp(unit, column->unit.text) != 0)
        return command_failed("%s: at rest the accelerometers read %.4g of gravity: their unit, "
                              "%s, is likely to be %s",
                              n->path, ratio, column->unit.text, unit);
    return command_failed("%s: at rest the accelerometers read %.4g of gravity: their unit, %s, is "
                          "wrong, or gravity is not in them, or the unit does not stand still",
                          n->path, ratio, column->unit.text);
}

/* g means 9.780327 m/s^2, gravity at the equator, to some makers: a ratio of 1.0026905. */
static void check_gravity_unit(const navigation *n)
{
    const double ratio = imk_vector3_norm(mean_reading(n, 1)) /
                         imk_normal_gravity(n->place.latitude, n->place.height);
    const int c = imk_log_find(&n->channels.log, IMK_QUANTITY_SPECIFIC_FORCE, 0);
    if (fabs(ratio - 9.80665 / 9.780327) < 1e-4 &&
        strchr(n->channels.log.column[c].unit.text, 'g') != NULL)
        command_warn("standard_gravity",
                     "at rest the accelerometers read %.6f of gravity, as if g stood for 9.780327 "
                     "m/s^2 in this log: add --standard-gravity \"9.780327 m/s^2\" if it does",
                     ratio);
}

/* 1 sigma of a gyro's bias as the model has it, worst axis. */
static double bias_size(const navigation *n)
{
    const imk_triad *gyro = &n->model->gyro;
    double worst = 0.0;
    for (int i = 0; i < 3 && n->has_model; i++)
        worst = fmax(
            worst, hypot(gyro->bias.repeatability.value[i], gyro->noise.bias_instability.value[i]));
    return worst;
}

/* The angle between force and rotation is that of the place: 90 deg + latitude. */
static void check_rotation(const navigation *n)
{
    const imk_vector3 rate = mean_reading(n, 0), force = mean_reading(n, 1);
    const double ratio = imk_vector3_norm(rate) / IMK_EARTH_RATE;
    const double sine =
        -imk_vector3_dot(rate, force) / (imk_vector3_norm(rate) * imk_vector3_norm(force));
    const double latitude = asin(fmin(1.0, fmax(-1.0, -sine)));
    if (!(fabs(ratio - 1.0) <= 0.1 + 3.0 * bias_size(n) / IMK_EARTH_RATE)) {
        command_warn("earth_rate", "at rest the gyros read %.3g times the Earth's rotation: %s",
                     ratio,
                     isnan(n->options->heading)
                         ? "north cannot be found from that; take out the bias (imukit compensate) "
                           "or add --heading"
                         : "a bias; imukit compensate takes it out");
        return;
    }
    /* Of the angle 3 deg are a bias of 0.8 deg/h, or an accelerometer's of 50 mg. */
    const double doubt = 3.0 * degree + 3.0 * bias_size(n) / IMK_EARTH_RATE;
    if (fabs(latitude - n->place.latitude) > doubt)
        command_warn("axes",
                     "the angle between force and rotation is that of latitude %.1f deg, not of "
                     "%.1f deg: the axes are others than forward-right-down (--axes), or a bias "
                     "is large",
                     latitude / degree, n->place.latitude / degree);
}

int navigate_check(const navigation *n)
{
    if (n->options->attitude)
        return -1;
    const int code = check_force(n);
    if (code < 0) {
        check_gravity_unit(n);
        check_rotation(n);
    }
    return code;
}

/* Angles known to sigma: those of roll and pitch are about axes turned by the heading. */
static void given_attitude(navigation *n)
{
    const imk_matrix3 c_nb = imk_matrix3_from_euler(n->euler[0], n->euler[1], n->euler[2]);
    n->start =
        imk_navigation_state_ned(n->dt * (double)n->first, n->place, (imk_vector3){{0}}, c_nb);
    const double c = cos(n->euler[2]), s = sin(n->euler[2]);
    const double roll = n->attitude_sigma[0], pitch = n->attitude_sigma[1];
    n->attitude_sigma[0] = hypot(c * roll, s * pitch);
    n->attitude_sigma[1] = hypot(s * roll, c * pitch);
}

static int self_align(navigation *n)
{
    imk_alignment_settings settings = imk_alignment_default();
    imk_alignment *alignment;
    imk_error error;
    settings.method = (imk_alignment_method)n->options->method;
    settings.place = n->place;
    settings.duration = n->dt * (double)n->first;
    settings.model = n->has_model ? n->model : NULL;
    const size_t size = imk_alignment_size(&settings);
    void *memory = malloc(size);
    if (!memory)
        return command_failed("memory is exhausted");
    imk_status status = imk_alignment_start(memory, size, &settings, &alignment, &error);
    for (size_t row = 0; row < n->first && status == IMK_OK; row++)
        imk_alignment_add(alignment, n->dt, increment(n, 0, row), increment(n, 1, row), NULL);
    if (status == IMK_OK)
        status = imk_alignment_finish(alignment, &n->alignment, &error);
    free(memory);
    if (status == IMK_ERROR_CONFLICT)
        return command_failed("within 1 deg of a pole there is no north to align to: give "
                              "--attitude");
    return status == IMK_OK ? -1 : command_error(&error, n->path);
}

/* The heading is known, from elsewhere; roll and pitch stay. */
static void turn_to_heading(navigation *n)
{
    n->euler[2] = n->options->heading;
    const imk_matrix3 c_nb = imk_matrix3_from_euler(n->euler[0], n->euler[1], n->euler[2]);
    n->start = imk_navigation_state_ned(n->start.time, n->place, (imk_vector3){{0}}, c_nb);
    for (int i = 0; i < 3; i++)
        n->alignment.covariance[2][i] = n->alignment.covariance[i][2] = 0.0;
    n->attitude_sigma[2] = 0.0;
    n->alignment.state = n->start;
}

int navigate_align(navigation *n)
{
    if (n->options->attitude) {
        given_attitude(n);
        return -1;
    }
    const int code = self_align(n);
    if (code >= 0)
        return code;
    n->aligned = true;
    n->start = n->alignment.state;
    n->euler[0] = n->alignment.roll;
    n->euler[1] = n->alignment.pitch;
    n->euler[2] = n->alignment.yaw;
    for (int i = 0; i < 3; i++)
        n->attitude_sigma[i] = sqrt(n->alignment.covariance[i][i]);
    if (!isnan(n->options->heading))
        turn_to_heading(n);
    return -1;
}
