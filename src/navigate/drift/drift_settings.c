/* SPDX-License-Identifier: Apache-2.0 */
/* What is navigated and when to look: defaults and checks, for the covariance and for the runs. */
#include "drift_correlation_internal.h"
#include "drift_settings_internal.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"

#include <math.h>

enum { COOKIE = 0x494D4B51 };

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)

/* Below this the body is at rest: as fast as the Earth's rotation within 0.1 %, and a millimetre in
 * a minute. What a compiled standstill has besides is rounding, 1e-9 of these. */
static const double rest_rate = 1e-3 * IMK_EARTH_RATE, rest_velocity = 1e-3 / 60.0;

imk_drift_settings imk_drift_default(void)
{
    return (imk_drift_settings){.cookie = COOKIE,
                                .latitude = 0.25 * PI,
                                .rate = 100.0,
                                .alignment_time = 300.0,
                                .gravity_distance = 20e3};
}

static imk_status refuse(imk_error *error, const char *field, double value, const char *expected)
{
    const imk_status status = isfinite(value) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse(error, status, field, value, 0.0, expected);
}

static imk_status check_triad(const imk_triad *triad, const char *kind, imk_error *error)
{
    /* Directions are unit vectors to 1e-9; along an axis they are so to the same. */
    const double tolerance = 1e-9;
    if (!triad->present || triad->axis_count != 3)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, kind, "",
                             "three gyros and three accelerometers: a navigator needs both triads");
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!(fabs(triad->direction[i][j] - (i == j ? 1.0 : 0.0)) <= tolerance)) {
                imk_error_set(
                    error, IMK_ERROR_UNSUPPORTED, kind, "",
                    "align the axes with body x, y, z: the navigator assumes these directions");
                if (error)
                    error->index = i;
                return IMK_ERROR_UNSUPPORTED;
            }
    return IMK_OK;
}

static imk_status check_times(const imk_drift_settings *settings, imk_error *error)
{
    if (settings->time_count == 0 || !settings->time)
        return imk_error_set(error, IMK_ERROR_EMPTY, "time", "", "at least one time to evaluate");
    double before = 0.0;
    for (size_t i = 0; i < settings->time_count; i++) {
        const double t = settings->time[i];
        if (!(t <= 1e8))
            return refuse(error, "time", t, "times up to three years (1e8 s)");
        if (!(t > before)) {
            imk_error_set(error, IMK_ERROR_TIME_ORDER, "time", "",
                          "times above 0, each later than the one before");
            if (error) {
                error->index = (int)i;
                error->value = t;
            }
            return IMK_ERROR_TIME_ORDER;
        }
        before = t;
    }
    return IMK_OK;
}

static imk_status check_numbers(const imk_drift_settings *s, imk_error *error)
{
    if (!(s->rate >= 1e-3 && s->rate <= 1e6))
        return refuse(error, "rate", s->rate, "a sample rate between 0.001 Hz and 1 MHz");
    if (!(fabs(s->latitude) <= 0.5 * PI))
        return refuse(error, "latitude", s->latitude, "a latitude within 90 deg");
    if (!(s->height >= -1e4 && s->height <= 1e5))
        return refuse(error, "height", s->height, "a height between -10 and 100 km");
    const double angle[3] = {s->roll, s->pitch, s->yaw};
    static const char *const name[3] = {"roll", "pitch", "yaw"};
    for (int i = 0; i < 3; i++)
        if (!(fabs(angle[i]) <= 1e4))
            return refuse(error, name[i], angle[i], "an angle");
    if (s->vertical != IMK_VERTICAL_SLAVED && s->vertical != IMK_VERTICAL_FREE)
        return refuse(error, "vertical", (double)s->vertical, "\"slaved\" or \"free\"");
    if (s->alignment != IMK_ALIGNED_GIVEN && s->alignment != IMK_ALIGNED_SELF)
        return refuse(error, "alignment", (double)s->alignment, "\"given\" or \"self\"");
    if (s->alignment == IMK_ALIGNED_SELF && !(s->alignment_time >= 1.0 && s->alignment_time <= 1e7))
        return refuse(error, "alignment_time", s->alignment_time, "1 s to 1e7 s");
    if (!(s->gravity_deflection >= 0.0 && s->gravity_deflection <= 0.1))
        return refuse(error, "gravity_deflection", s->gravity_deflection, "0 to 0.1 m/s^2");
    if (!(s->gravity_distance >= 0.0 && s->gravity_distance <= 1e9))
        return refuse(error, "gravity_distance", s->gravity_distance, "a distance up to 1e9 m");
    if (s->attitude_errors != IMK_ATTITUDE_LOCAL && s->attitude_errors != IMK_ATTITUDE_EARTH)
        return refuse(error, "attitude_errors", (double)s->attitude_errors,
                      "\"local\" or \"earth\"");
    for (int i = 0; i < IMK_DRIFT_STATES; i++)
        if (!(s->initial_sigma[i] >= 0.0 && s->initial_sigma[i] <= 1e9)) {
            const imk_status status = refuse(error, "initial_sigma", s->initial_sigma[i],
                                             "a standard deviation of 0 or more");
            if (error)
                error->index = i;
            return status;
        }
    return IMK_OK;
}

imk_vertical imk_drift_vertical(const imk_drift_settings *settings)
{
    for (size_t k = 0; k < settings->aid_count; k++) {
        const imk_aid *aid = &settings->aid[k];
        if (aid->kind == IMK_AID_HEIGHT ||
            (aid->kind == IMK_AID_POSITION && isfinite(aid->sigma[2])))
            return IMK_VERTICAL_FREE;
    }
    return settings->vertical;
}

int imk_drift_nees_degrees(const imk_drift_settings *settings)
{
    return imk_drift_vertical(settings) == IMK_VERTICAL_FREE ? 9 : 7;
}

double imk_drift_outage(const imk_drift_settings *settings)
{
    double last = (double)NAN;
    for (size_t k = 0; k < settings->aid_count; k++)
        if (isfinite(settings->aid[k].until) && !(settings->aid[k].until <= last))
            last = settings->aid[k].until;
    return last;
}

imk_status imki_drift_motion(const imk_drift_settings *settings, imki_drift_motion_of *motion,
                             imk_error *error)
{
    if (settings->motion) {
        motion->trajectory = *settings->motion;
        double last;
        imk_trajectory_span(&motion->trajectory, &motion->start, &last);
        return IMK_OK;
    }
    const double roll_pitch_yaw[3] = {settings->roll, settings->pitch, settings->yaw};
    motion->start = 0.0;
    return imk_trajectory_standstill((imk_geodetic){settings->latitude, 0.0, settings->height},
                                     roll_pitch_yaw, true, &motion->piece, &motion->trajectory,
                                     error);
}

/* Aids are those of the filter too, unless it has another description of the same aids. */
static imk_status check_aids(const imk_drift_settings *s, imk_error *error)
{
    if (s->aid_count > IMK_AIDS_MAX || (s->aid_count > 0 && !s->aid))
        return refuse(error, "aid_count", (double)s->aid_count, "up to 8 aids");
    for (size_t k = 0; k < s->aid_count; k++) {
        const imk_aid *aid = &s->aid[k], *filter = s->filter_aid ? &s->filter_aid[k] : aid;
        imk_status status = imk_aid_validate(aid, error);
        if (status == IMK_OK)
            status = imk_aid_validate(filter, error);
        if (status != IMK_OK)
            return status;
        if (!(aid->interval * s->rate >= 1.0 - 1e-9))
            return refuse(error, "aid.interval", aid->interval,
                          "readings of an aid at most once a sample");
        if (!(aid->from >= 0.0))
            return refuse(error, "aid.from", aid->from, "a time from the start on");
        bool same = aid->kind == filter->kind;
        for (int i = 0; i < 3; i++)
            same = same && isfinite(aid->sigma[i]) == isfinite(filter->sigma[i]);
        if (!same)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "filter_aid", "",
                                 "the same kinds and axes as in aid");
    }
    return IMK_OK;
}

static imk_status check_motion(const imk_drift_settings *settings, imk_error *error)
{
    if (settings->motion) {
        if (!settings->motion->earth)
            return imk_error_set(error, IMK_ERROR_CONFLICT, "motion", "",
                                 "a motion on the Earth: the navigator needs the Earth");
        const imk_status status = imk_trajectory_validate(settings->motion, error);
        if (status != IMK_OK)
            return status;
    }
    imki_drift_motion_of motion;
    const imk_status status = imki_drift_motion(settings, &motion, error);
    if (status != IMK_OK || settings->alignment != IMK_ALIGNED_SELF)
        return status;
    imk_motion_state state;
    imk_trajectory_state(&motion.trajectory, motion.start, &state);
    if (!(fabs(state.place.latitude) <= 89.0 * DEGREE))
        return imk_error_set(error, IMK_ERROR_CONFLICT, "alignment", "",
                             "a given attitude: a unit within 1 deg of a pole finds no north");
    const imk_vector3 earth = {{0.0, 0.0, IMK_EARTH_RATE}};
    const imk_vector3 turning =
        imk_vector3_subtract(imk_quaternion_rotate(state.attitude, state.angular_rate), earth);
    if (!(imk_vector3_norm(turning) <= rest_rate &&
          imk_vector3_norm(state.velocity) <= rest_velocity))
        return imk_error_set(error, IMK_ERROR_CONFLICT, "alignment", "",
                             "a given attitude, or a motion that begins at rest");
    return IMK_OK;
}

static imk_status check_correlation(const imk_correlation *correlation, imk_error *error)
{
    double factor[IMKI_CORRELATION_FACTOR];
    return imki_correlation_factor(correlation, factor)
               ? IMK_OK
               : imk_error_set(error, IMK_ERROR_CONFLICT, "correlation.values",
                               "numbers that no quantities have as correlations: their matrix is "
                               "not positive",
                               "the correlations of one estimate, or none");
}

imk_status imk_drift_validate(const imk_model *model, const imk_drift_settings *settings,
                              imk_error *error)
{
    imk_status status = imk_model_validate(model, error);
    if (status != IMK_OK)
        return status;
    if (settings->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "settings", "",
                             "start from imk_drift_default()");
    status = check_triad(&model->gyro, "gyro", error);
    if (status == IMK_OK)
        status = check_triad(&model->accel, "accel", error);
    if (status == IMK_OK)
        status = check_numbers(settings, error);
    if (status == IMK_OK)
        status = check_times(settings, error);
    if (status == IMK_OK)
        status = check_aids(settings, error);
    if (status == IMK_OK && settings->filter_model)
        status = imk_model_validate(settings->filter_model, error);
    if (status == IMK_OK && settings->filter_model)
        status = check_triad(&settings->filter_model->gyro, "filter_model.gyro", error);
    if (status == IMK_OK && settings->filter_model)
        status = check_triad(&settings->filter_model->accel, "filter_model.accel", error);
    if (status == IMK_OK)
        status = check_motion(settings, error);
    if (status == IMK_OK && settings->compensated)
        status = check_correlation(&model->correlation, error);
    return status;
}
