/* SPDX-License-Identifier: Apache-2.0 */
/* Alignment of a body that does not move, from its means of force and rate.
 *
 * With the small rotation p, C_nb (found) = (I + [p x]) C_nb, errors b and c of the means leave the
 * force vertical and the rate's east component zero:
 *
 *     p x (0, 0, -g) + b = 0 across the vertical        p_N = -b_E/g,   p_E = b_N/g
 *     [p x w_ie + c]_E = 0                              p_D = -c_E/(w_ie cos L) - p_N tan L  */
#include "alignment_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

imk_status imki_alignment_of_means(imk_vector3 force, imk_vector3 rate, imk_geodetic place,
                                   imk_matrix3 *c_nb)
{
    const double f = imk_vector3_norm(force);
    if (!(f > 0.0 && isfinite(f)))
        return IMK_ERROR_SINGULAR;
    const imk_vector3 down = imk_vector3_scale(force, -1.0 / f);
    const imk_vector3 across = imk_vector3_cross(down, rate);
    const double sine = imk_vector3_norm(across);
    /* 1e-7 of the rate: what rounding leaves of a parallel one is below */
    if (!(sine > 1e-7 * imk_vector3_norm(rate) && isfinite(sine)))
        return IMK_ERROR_SINGULAR;
    const imk_vector3 east = imk_vector3_scale(across, 1.0 / sine);
    const imk_vector3 north = imk_vector3_cross(east, down);
    imk_matrix3 hanging;
    for (int j = 0; j < 3; j++) {
        hanging.m[0][j] = north.v[j];
        hanging.m[1][j] = east.v[j];
        hanging.m[2][j] = down.v[j];
    }
    *c_nb = imk_matrix3_multiply(imk_plumb_axes(place), hanging);
    return IMK_OK;
}

/* covariance += J m J^T */
static void add_congruent(imk_matrix3 j, imk_matrix3 m, imk_matrix3 *covariance)
{
    const imk_matrix3 all =
        imk_matrix3_multiply(imk_matrix3_multiply(j, m), imk_matrix3_transpose(j));
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            covariance->m[r][c] += all.m[r][c];
}

void imki_alignment_response(imk_matrix3 c_nb, double latitude, double gravity,
                             const imk_matrix3 *force, const imk_matrix3 *rate,
                             imk_matrix3 *covariance)
{
    const double cosine = imk_cos(latitude), tangent = imk_sin(latitude) / cosine;
    const imk_matrix3 tilt = {
        {{0.0, -1.0 / gravity, 0.0}, {1.0 / gravity, 0.0, 0.0}, {0.0, tangent / gravity, 0.0}}};
    const imk_matrix3 heading = {{{0}, {0}, {0.0, -1.0 / (IMK_EARTH_RATE * cosine), 0.0}}};
    add_congruent(imk_matrix3_multiply(tilt, c_nb), *force, covariance);
    add_congruent(imk_matrix3_multiply(heading, c_nb), *rate, covariance);
}

/* Covariance of a mean: white/T + mean + K^2 T/3 + reading + 2 Q^2/T^2. */
static imk_matrix3 mean_covariance(const imki_alignment_errors *errors, double duration)
{
    imk_matrix3 sum;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            sum.m[r][c] = errors->white.m[r][c] / duration + errors->mean.m[r][c] +
                          errors->walk.m[r][c] * duration / 3.0 + errors->reading.m[r][c] +
                          2.0 * errors->quantum.m[r][c] / (duration * duration);
    return sum;
}

/* Fewer say too little about their scatter. */
enum { EPOCHS_MIN = 8 };

/* From the scatter of the means of epochs: half the mean square of neighbours' differences is the
 * variance of one, if they are independent. */
static imk_matrix3 scatter_covariance(const double *scatter, size_t epochs)
{
    imk_matrix3 m = {{{0}}};
    for (int i = 0; i < 3; i++)
        m.m[i][i] = 0.5 * scatter[i] / ((double)(epochs - 1) * (double)epochs);
    return m;
}

imk_status imki_alignment_means_finish(const imk_alignment *alignment, imk_alignment_result *result,
                                       imk_error *error)
{
    const imk_alignment_settings *settings = &alignment->settings;
    if (settings->model == NULL && alignment->epochs < EPOCHS_MIN)
        return imk_error_set(error, IMK_ERROR_TOO_SHORT, "alignment", "",
                             "at least eight samples and a quarter of the duration");
    const double per_time = 1.0 / alignment->time;
    const imk_vector3 force = imk_vector3_scale(alignment->velocity, per_time);
    const imk_vector3 rate = imk_vector3_scale(alignment->angle, per_time);
    imk_matrix3 c_nb;
    if (imki_alignment_of_means(force, rate, settings->place, &c_nb) != IMK_OK)
        return imk_error_set(
            error, IMK_ERROR_SINGULAR, "alignment", "",
            "check the samples: force and rate must not be zero and not be parallel");
    const double gravity = imk_normal_gravity(settings->place.latitude, settings->place.height);
    imk_matrix3 force_error, rate_error;
    if (settings->model != NULL) {
        const double dt = alignment->time / (double)alignment->count;
        const imki_alignment_errors accel =
            imki_alignment_errors_of(&settings->model->accel, alignment->time, dt, force, NULL);
        const imki_alignment_errors gyro =
            imki_alignment_errors_of(&settings->model->gyro, alignment->time, dt, rate, &force);
        force_error = mean_covariance(&accel, alignment->time);
        rate_error = mean_covariance(&gyro, alignment->time);
    } else {
        force_error = scatter_covariance(alignment->force_scatter, alignment->epochs);
        rate_error = scatter_covariance(alignment->rate_scatter, alignment->epochs);
    }
    imk_matrix3 covariance = {{{0}}};
    *result =
        (imk_alignment_result){.state = imk_navigation_state_ned(alignment->time, settings->place,
                                                                 (imk_vector3){{0}}, c_nb),
                               .gravity_ratio = imk_vector3_norm(force) / gravity,
                               .earth_rate_ratio = imk_vector3_norm(rate) / IMK_EARTH_RATE};
    imk_matrix3_to_euler(c_nb, &result->roll, &result->pitch, &result->yaw);
    imki_alignment_response(c_nb, settings->place.latitude, gravity, &force_error, &rate_error,
                            &covariance);
    memcpy(result->covariance, covariance.m, sizeof covariance.m);
    return IMK_OK;
}
