/* SPDX-License-Identifier: Apache-2.0 */
/* The attitude at the start: found, or given; and whether what the sensors read at rest can be
 * gravity and the Earth's rotation. */
#include "navigate_parts.h"

#include "imukit/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 0.017453292519943295;

static imk_vector3 mean_of_rows(const navigation *n, int sensor, size_t rows)
{
    imk_vector3 sum = {{0}};
    for (size_t row = 0; row < rows; row++)
        for (int i = 0; i < 3; i++)
            sum.v[i] += n->reading[3 * sensor + i][row];
    return imk_vector3_scale(sum, 1.0 / (double)rows);
}

/* Mean reading of the time of alignment. */
static imk_vector3 mean_reading(const navigation *n, int sensor)
{
    return mean_of_rows(n, sensor, n->first);
}

/* The unit, unlike its own, in which the numbers of a column would be gravity, or the Earth's
 * rotation, within a tolerance; NULL: none. @param ratio  to that, in its own unit */
static const char *likely_unit(const imk_log_column *column, double ratio, double tolerance)
{
    enum { UNITS = 6 };
    static const char *const lists[4][UNITS] = {
        {"rad/s", "deg/s", "deg/h", "mrad/s", "mdeg/s", "urad/s"},
        {"rad", "deg", "arcsec", "mrad", "mdeg", "urad"},
        {"m/s^2", "g", "mg", "ug", "mm/s^2", "cm/s^2"},
        {"m/s", "g*s", "mg*s", "ug*s", "mm/s", "cm/s"}};
    const int sensor = column->quantity == IMK_QUANTITY_SPECIFIC_FORCE;
    const char *const *units = lists[2 * sensor + column->increment];
    for (int k = 0; k < UNITS; k++) {
        const double scale = imk_unit_of(units[k]).scale / column->unit.scale;
        if (fabs(ratio * scale - 1.0) < tolerance && strcmp(units[k], column->unit.text) != 0)
            return units[k];
    }
    return NULL;
}

static int check_force(const navigation *n)
{
    const double tolerance = 0.05;
    const double ratio = imk_vector3_norm(mean_reading(n, 1)) /
                         imk_normal_gravity(n->place.latitude, n->place.height);
    if (fabs(ratio - 1.0) <= tolerance)
        return -1;
    const int c = imk_log_find(&n->channels.log, IMK_QUANTITY_SPECIFIC_FORCE, 0);
    const imk_log_column *column = &n->channels.log.column[c];
    const char *unit = likely_unit(column, ratio, tolerance);
    if (unit)
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
    const double tolerance = 0.1 + 3.0 * bias_size(n) / IMK_EARTH_RATE;
    if (!(fabs(ratio - 1.0) <= tolerance)) {
        const int column = imk_log_find(&n->channels.log, IMK_QUANTITY_ANGULAR_RATE, 0);
        const char *unit = likely_unit(&n->channels.log.column[column], ratio, 0.1);
        char text[160] = "";
        if (unit)
            snprintf(text, sizeof text, "their unit, %s, may be %s; or ",
                     n->channels.log.column[column].unit.text, unit);
        command_warn("earth_rate", "at rest the gyros read %.3g times the Earth's rotation: %s%s",
                     ratio, text,
                     !n->options->heading
                         ? "north cannot be found from that; take out the bias (imukit compensate) "
                           "or add --heading"
                         : "a bias; imukit compensate takes it out");
        return;
    }
    /* Of the angle 3 deg are a bias of 0.8 deg/h, or an accelerometer's of 50 mg. */
    const double doubt = 3.0 * degree + 3.0 * bias_size(n) / IMK_EARTH_RATE;
    if (fabs(latitude + n->place.latitude) < doubt && fabs(latitude) > doubt)
        command_warn("axes",
                     "the angle between force and rotation is that of latitude %.1f deg, not of "
                     "%.1f deg: the sign of the latitude is wrong, or that of all gyros or all "
                     "accelerometers",
                     latitude / degree, n->place.latitude / degree);
    else if (fabs(latitude - n->place.latitude) > doubt)
        command_warn("axes",
                     "the angle between force and rotation is that of latitude %.1f deg, not of "
                     "%.1f deg: the axes are others than forward-right-down (--axes), or a bias "
                     "is large",
                     latitude / degree, n->place.latitude / degree);
}

/* In a given attitude the force of the first second, less gravity, is an acceleration. */
static void check_start(const navigation *n)
{
    const double g = imk_normal_gravity(n->place.latitude, n->place.height), tolerance = 0.05;
    const size_t second = n->dt < 1.0 ? imk_samples_in(1.0, n->dt) : 1;
    const imk_vector3 force = mean_of_rows(n, 1, second < n->rows ? second : n->rows);
    imk_vector3 acceleration =
        imk_matrix3_apply(imk_matrix3_from_euler(n->euler[0], n->euler[1], n->euler[2]), force);
    acceleration.v[2] += g;
    if (imk_vector3_norm(acceleration) <= tolerance * g)
        return;
    const int c = imk_log_find(&n->channels.log, IMK_QUANTITY_SPECIFIC_FORCE, 0);
    const imk_log_column *column = &n->channels.log.column[c];
    const char *unit = likely_unit(column, imk_vector3_norm(force) / g, tolerance);
    char text[160];
    if (unit)
        snprintf(text, sizeof text, "the accelerometers' unit, %s, is likely to be %s",
                 column->unit.text, unit);
    else
        snprintf(text, sizeof text,
                 "the attitude, --axes or the unit of the accelerometers is "
                 "wrong, or it moves from the first row on");
    command_warn("start_acceleration",
                 "in the attitude given the log begins with an acceleration of %.3g m/s^2: %s",
                 imk_vector3_norm(acceleration), text);
}

int navigate_check(const navigation *n)
{
    if (n->options->attitude) {
        check_start(n);
        return -1;
    }
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
    n->euler[0] = remainder(n->euler[0], 360.0 * degree);
    n->euler[2] = remainder(n->euler[2], 360.0 * degree);
    const double c = cos(n->euler[2]), s = sin(n->euler[2]);
    const double roll = n->attitude_sigma[0], pitch = n->attitude_sigma[1];
    n->attitude_sigma[0] = hypot(c * roll, s * pitch);
    n->attitude_sigma[1] = hypot(s * roll, c * pitch);
}

/* Gravity's turn in inertial axes is lost in biases larger than the Earth's rotation, and the tilt
 * with it: of 20 deg that they turn in the time it is off by 14. The mean force asks no gyro. */
static imk_alignment_method chosen_method(const navigation *n)
{
    const double coarse = 1.5 * IMK_EARTH_RATE;
    if (n->options->method >= 0)
        return (imk_alignment_method)n->options->method;
    return imk_vector3_norm(mean_reading(n, 0)) > coarse ? IMK_ALIGNMENT_MEANS
                                                         : IMK_ALIGNMENT_INERTIAL;
}

static int self_align(navigation *n)
{
    imk_alignment_settings settings = imk_alignment_default();
    imk_alignment *alignment;
    imk_error error;
    settings.method = n->method;
    settings.place = n->place;
    settings.duration = n->dt * (double)n->first;
    settings.model = n->has_model ? n->model : NULL;
    const size_t size = imk_alignment_size(&settings);
    void *memory = command_memory(NULL, size);
    imk_status status = imk_alignment_start(memory, size, &settings, &alignment, &error);
    for (size_t row = 0; row < n->first && status == IMK_OK; row++)
        imk_alignment_add(alignment, n->dt, navigate_increment(n, 0, row),
                          navigate_increment(n, 1, row), NULL);
    if (status == IMK_OK)
        status = imk_alignment_finish(alignment, &n->alignment, &error);
    free(memory);
    if (status == IMK_ERROR_CONFLICT)
        return command_failed("within 1 deg of a pole there is no north to align to: give "
                              "--attitude");
    const imk_alignment_result *a = &n->alignment;
    /* Fewer equations than unknowns leave no covariance. */
    bool known = true;
    for (int i = 0; i < 3; i++)
        known = known && a->covariance[i][i] >= 0.0 && isfinite(a->covariance[i][i]);
    if (status == IMK_ERROR_TOO_SHORT || (status == IMK_OK && !known))
        return command_failed("%s: --align %.6gs is too short to find an attitude; minutes are due",
                              n->path, n->options->align);
    return status == IMK_OK ? -1 : command_error(&error, n->path);
}

/* The heading is known, from elsewhere; roll and pitch stay. */
static void turn_to_heading(navigation *n)
{
    n->euler[2] = remainder(n->heading, 360.0 * degree);
    const imk_matrix3 c_nb = imk_matrix3_from_euler(n->euler[0], n->euler[1], n->euler[2]);
    n->start = imk_navigation_state_ned(n->start.time, n->place, (imk_vector3){{0}}, c_nb);
    for (int i = 0; i < 3; i++)
        n->alignment.covariance[2][i] = n->alignment.covariance[i][2] = 0.0;
    n->attitude_sigma[2] = n->heading_sigma;
    n->alignment.covariance[2][2] = n->heading_sigma * n->heading_sigma;
    n->alignment.state = n->start;
}

int navigate_align(navigation *n)
{
    if (n->options->attitude) {
        given_attitude(n);
        return -1;
    }
    n->method = chosen_method(n);
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
    if (n->options->heading)
        turn_to_heading(n);
    return -1;
}
