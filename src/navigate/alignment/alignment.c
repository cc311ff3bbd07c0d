/* SPDX-License-Identifier: Apache-2.0 */
/* Self-alignment: settings, memory, samples in, result out. The methods: alignment_means.c and
 * alignment_inertial.c. */
#include "alignment_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x414C4731, EPOCHS = 256, MEAN_EPOCHS = 32 };

static const double degree = 0.017453292519943295;

imk_alignment_settings imk_alignment_default(void)
{
    return (imk_alignment_settings){
        .cookie = COOKIE, .method = IMK_ALIGNMENT_INERTIAL, .duration = 300.0};
}

static imk_status refuse(imk_error *error, const char *field, double value, const char *expected)
{
    const imk_status status = isfinite(value) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse(error, status, field, value, 0.0, expected);
}

static imk_status check(const imk_alignment_settings *s, imk_error *error)
{
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "alignment", "",
                             "start from imk_alignment_default()");
    if ((unsigned)s->method > (unsigned)IMK_ALIGNMENT_FINE)
        return refuse(error, "method", (double)s->method, "one of the three methods");
    if (!(fabs(s->place.latitude) <= 90.0 * degree))
        return refuse(error, "place.latitude", s->place.latitude, "a latitude within 90 deg");
    if (!(fabs(s->place.longitude) <= 1e4))
        return refuse(error, "place.longitude", s->place.longitude, "an angle");
    if (!(s->place.height >= -1e4 && s->place.height <= 1e5))
        return refuse(error, "place.height", s->place.height, "a height between -10 and 100 km");
    if (!(s->duration > 0.0 && s->duration <= 1e9))
        return refuse(error, "duration", s->duration, "a time above 0");
    if (fabs(s->place.latitude) > 89.0 * degree)
        return imk_error_set(error, IMK_ERROR_CONFLICT, "place.latitude", "",
                             "a place more than 1 deg from a pole, so that north is defined");
    if (s->model == NULL)
        return IMK_OK;
    const imk_status status = imk_model_validate(s->model, error);
    if (status != IMK_OK)
        return status;
    const imk_triad *const triad[2] = {&s->model->gyro, &s->model->accel};
    for (int i = 0; i < 2; i++)
        if (!triad[i]->present || triad[i]->axis_count < 3)
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, i == 0 ? "gyro" : "accel", "",
                                 "at least three axes");
    return IMK_OK;
}

size_t imk_alignment_size(const imk_alignment_settings *settings)
{
    (void)settings;
    return sizeof(imk_alignment) + IMKI_ALIGNMENT_SLACK;
}

imk_status imk_alignment_start(const imk_alignment_settings *settings, imk_alignment **alignment,
                               void *memory, size_t memory_size, imk_error *error)
{
    const imk_status status = check(settings, error);
    if (status != IMK_OK)
        return status;
    if (memory == NULL || memory_size < imk_alignment_size(settings))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "alignment", "",
                             "imk_alignment_size() bytes");
    imk_alignment *a = (void *)imki_align(memory);
    memset(a, 0, sizeof *a);
    a->settings = *settings;
    const bool still = settings->method == IMK_ALIGNMENT_MEANS;
    a->epoch_length = settings->duration / (still ? MEAN_EPOCHS : EPOCHS);
    if (!still)
        imki_alignment_inertial_start(a);
    *alignment = a;
    return IMK_OK;
}

/* The scatter of neighbouring epochs' means. */
static void close_mean_epoch(imk_alignment *a)
{
    const double per_time = 1.0 / a->epoch_time;
    const imk_vector3 rate = imk_vector3_scale(a->epoch_angle, per_time);
    const imk_vector3 force = imk_vector3_scale(a->epoch_velocity, per_time);
    for (int i = 0; i < 3 && a->epochs > 0; i++) {
        a->rate_scatter[i] += (rate.v[i] - a->last_rate.v[i]) * (rate.v[i] - a->last_rate.v[i]);
        a->force_scatter[i] +=
            (force.v[i] - a->last_force.v[i]) * (force.v[i] - a->last_force.v[i]);
    }
    a->last_rate = rate;
    a->last_force = force;
    a->epoch_angle = a->epoch_velocity = (imk_vector3){{0}};
}

void imk_alignment_add(imk_alignment *alignment, double dt, imk_vector3 angle, imk_vector3 velocity,
                       const imk_vector3 *moving)
{
    imk_alignment *a = alignment;
    a->time += dt;
    a->count++;
    for (int i = 0; i < 3; i++) {
        a->angle.v[i] += angle.v[i];
        a->velocity.v[i] += velocity.v[i];
    }
    a->epoch_time += dt;
    const bool still = a->settings.method == IMK_ALIGNMENT_MEANS;
    if (still) {
        a->epoch_angle = imk_vector3_add(a->epoch_angle, angle);
        a->epoch_velocity = imk_vector3_add(a->epoch_velocity, velocity);
    } else {
        imki_alignment_inertial_add(a, dt, angle, velocity, moving);
    }
    /* The sample that ends nearest to the epoch's end is its last. */
    if (a->time + 0.5 * dt < (double)(a->epochs + 1) * a->epoch_length)
        return;
    if (still)
        close_mean_epoch(a);
    else
        imki_alignment_inertial_close(a);
    a->epoch_time = 0.0;
    a->epochs++;
}

imk_status imk_alignment_finish(const imk_alignment *alignment, imk_alignment_result *result,
                                imk_error *error)
{
    if (!(alignment->time >= 1.0 - 1e-9)) /* the sum of a second's samples */
        return imk_error_set(error,
                             isnan(alignment->time) ? IMK_ERROR_SINGULAR : IMK_ERROR_TOO_SHORT,
                             "alignment", "", "at least one second of samples");
    return alignment->settings.method == IMK_ALIGNMENT_MEANS
               ? imki_alignment_means_finish(alignment, result, error)
               : imki_alignment_inertial_finish(alignment, result, error);
}
