/* SPDX-License-Identifier: Apache-2.0 */
/* The attitude at the start: found, or given; and whether what the sensors read at rest can be
 * gravity and the Earth's rotation. */
#include "imukit/samples.h"
#include "navigate_log_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* Mean reading of the time of alignment. */
static imk_vector3 mean_reading(const imk_navigate_log *n, int sensor)
{
    return imki_navigate_mean(n, sensor, 0, n->first);
}

/* Of the force at rest to gravity. */
static double gravity_ratio(const imk_navigate_log *n)
{
    const imk_geodetic *place = &n->settings.place;
    return imk_vector3_norm(mean_reading(n, 1)) /
           imk_normal_gravity(place->latitude, place->height);
}

static imk_status check_force(imk_navigate_log *n, imk_error *error)
{
    const double tolerance = 0.05, ratio = gravity_ratio(n);
    if (fabs(ratio - 1.0) <= tolerance + 3.0 * imki_navigate_bias_size(n, 1) / 9.80665)
        return IMK_OK;
    const imk_log_column *column = imki_navigate_first_column(n, IMK_QUANTITY_SPECIFIC_FORCE);
    const char *unit = imki_navigate_likely_unit(column, ratio, tolerance);
    char names[96];
    imki_navigate_unit_names(column, unit, names);
    return imki_fail(&n->findings, error, IMK_ERROR_UNIT_UNKNOWN, "no_gravity", names,
                     IMKI_NUMBERS(ratio, unit != NULL));
}

/* g means 9.780327 m/s^2, gravity at the equator, to some makers: a ratio of 1.0026905. */
static void check_gravity_unit(imk_navigate_log *n)
{
    const double ratio = gravity_ratio(n);
    const imk_log_column *column = imki_navigate_first_column(n, IMK_QUANTITY_SPECIFIC_FORCE);
    if (fabs(ratio - 9.80665 / 9.780327) < 1e-4 && strchr(column->unit.text, 'g') != NULL)
        imki_find(&n->findings, IMK_FINDING_WARNING, "standard_gravity", NULL, IMKI_NUMBERS(ratio));
}

/* The angle between force and rotation is that of the place: 90 deg + latitude. */
static void check_rotation(imk_navigate_log *n)
{
    const imk_vector3 rate = mean_reading(n, 0), force = mean_reading(n, 1);
    const double ratio = imk_vector3_norm(rate) / IMK_EARTH_RATE;
    const double sine =
        -imk_vector3_dot(rate, force) / (imk_vector3_norm(rate) * imk_vector3_norm(force));
    const double latitude = asin(fmin(1.0, fmax(-1.0, -sine)));
    const double tolerance = 0.1 + 3.0 * imki_navigate_bias_size(n, 0) / IMK_EARTH_RATE;
    if (!(fabs(ratio - 1.0) <= tolerance)) {
        const imk_log_column *column = imki_navigate_first_column(n, IMK_QUANTITY_ANGULAR_RATE);
        const char *unit = imki_navigate_likely_unit(column, ratio, 0.1);
        char names[96];
        imki_navigate_unit_names(column, unit, names);
        imki_find(&n->findings, IMK_FINDING_WARNING, "earth_rate", names,
                  IMKI_NUMBERS(ratio, unit != NULL, n->settings.heading_given));
        return;
    }
    /* Of the angle 3 deg are a bias of 0.8 deg/h, or an accelerometer's of 50 mg. */
    const double diagnostic = 3.0 * degree + 3.0 * imki_navigate_bias_size(n, 0) / IMK_EARTH_RATE;
    const double place = n->settings.place.latitude;
    const bool opposite = fabs(latitude + place) < diagnostic && fabs(latitude) > diagnostic;
    if (opposite || fabs(latitude - place) > diagnostic)
        imki_find(&n->findings, IMK_FINDING_WARNING, "axes", NULL,
                  IMKI_NUMBERS(latitude / degree, place / degree, opposite));
}

imk_status imki_navigate_check(imk_navigate_log *n, imk_error *error)
{
    if (!imki_navigate_aligns(n)) {
        imki_navigate_check_given(n);
        return IMK_OK;
    }
    const imk_status status = check_force(n, error);
    if (status == IMK_OK) {
        check_gravity_unit(n);
        check_rotation(n);
    }
    return status;
}

/* Angles known to sigma: those of roll and pitch are about axes turned by the heading. */
static void given_attitude(imk_navigate_log *n)
{
    memcpy(n->attitude, n->settings.attitude, sizeof n->attitude);
    memcpy(n->attitude_sigma, n->settings.attitude_sigma, sizeof n->attitude_sigma);
    const imk_matrix3 c_nb = imk_matrix3_from_euler(n->attitude[0], n->attitude[1], n->attitude[2]);
    const double *v = n->settings.velocity;
    n->start = imk_navigation_state_ned(n->record.dt * (double)n->first, n->settings.place,
                                        (imk_vector3){{v[0], v[1], v[2]}}, c_nb);
    n->attitude[0] = remainder(n->attitude[0], 360.0 * degree);
    n->attitude[2] = remainder(n->attitude[2], 360.0 * degree);
    const double c = cos(n->attitude[2]), s = sin(n->attitude[2]);
    const double roll = n->attitude_sigma[0], pitch = n->attitude_sigma[1];
    n->attitude_sigma[0] = hypot(c * roll, s * pitch);
    n->attitude_sigma[1] = hypot(s * roll, c * pitch);
}

static imk_status self_align(imk_navigate_log *n, imki_arena *scratch, imk_error *error)
{
    const double dt = n->record.dt;
    imk_alignment_settings settings = imk_alignment_default();
    imk_alignment *alignment;
    settings.method = n->method;
    settings.place = n->settings.place;
    settings.duration = dt * (double)n->first;
    settings.model = n->settings.model;
    const size_t size = imk_alignment_size(&settings);
    void *memory = imki_arena_room(scratch, size);
    if (!memory)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status = imk_alignment_start(&settings, &alignment, memory, size, error);
    for (size_t row = 0; row < n->first && status == IMK_OK; row++)
        imk_alignment_add(alignment, dt, imki_navigate_increment(n, 0, row),
                          imki_navigate_increment(n, 1, row), NULL);
    if (status == IMK_OK)
        status = imk_alignment_finish(alignment, &n->alignment, error);
    if (status == IMK_ERROR_CONFLICT)
        return imki_fail(&n->findings, error, status, "pole", NULL, 0, NULL);
    /* Fewer equations than unknowns leave no covariance. */
    bool known = true;
    for (int i = 0; i < 3; i++)
        known = known && n->alignment.covariance[i][i] >= 0.0 &&
                isfinite(n->alignment.covariance[i][i]);
    if (status == IMK_ERROR_TOO_SHORT || (status == IMK_OK && !known))
        return imki_fail(&n->findings, error, IMK_ERROR_TOO_SHORT, "align_short", NULL,
                         IMKI_NUMBERS(n->settings.align));
    return status;
}

/* The heading is known, from elsewhere; roll and pitch stay. */
static void turn_to_heading(imk_navigate_log *n)
{
    n->attitude[2] = remainder(n->settings.attitude[2], 360.0 * degree);
    const imk_matrix3 c_nb = imk_matrix3_from_euler(n->attitude[0], n->attitude[1], n->attitude[2]);
    n->start = imk_navigation_state_ned(n->start.time, n->settings.place, (imk_vector3){{0}}, c_nb);
    for (int i = 0; i < 3; i++)
        n->alignment.covariance[2][i] = n->alignment.covariance[i][2] = 0.0;
    n->attitude_sigma[2] = n->settings.attitude_sigma[2];
    n->alignment.covariance[2][2] = n->settings.attitude_sigma[2] * n->settings.attitude_sigma[2];
    n->alignment.state = n->start;
}

/* By means first, unless the method is stated: they say whether the biases leave a north to find.
 */
static imk_status align_by_choice(imk_navigate_log *n, imki_arena *scratch, imk_error *error)
{
    const bool given = n->settings.method_given;
    n->method = given ? n->settings.method : IMK_ALIGNMENT_MEANS;
    imk_status status = self_align(n, scratch, error);
    if (status == IMK_OK)
        imki_navigate_find_north(n);
    if (given || n->coarse || status == IMK_ERROR_MEMORY)
        return status;
    n->method = IMK_ALIGNMENT_INERTIAL;
    status = self_align(n, scratch, error);
    if (status == IMK_OK)
        imki_navigate_doubt_heading(n);
    return status;
}

imk_status imki_navigate_align(imk_navigate_log *n, imki_arena *scratch, imk_error *error)
{
    if (!imki_navigate_aligns(n)) {
        given_attitude(n);
        return IMK_OK;
    }
    const imk_status status = align_by_choice(n, scratch, error);
    if (status != IMK_OK)
        return status;
    n->start = n->alignment.state;
    n->attitude[0] = n->alignment.roll;
    n->attitude[1] = n->alignment.pitch;
    n->attitude[2] = n->alignment.yaw;
    for (int i = 0; i < 3; i++)
        n->attitude_sigma[i] = sqrt(n->alignment.covariance[i][i]);
    if (n->settings.heading_given)
        turn_to_heading(n);
    return IMK_OK;
}
