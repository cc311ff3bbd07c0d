/* SPDX-License-Identifier: Apache-2.0 */
/* What a model says about the errors of a standing unit, in the terms of the filter, and what a
 * self-alignment makes of them.
 *
 * Flicker, S(f) = B^2/(2 pi f): Gauss-Markov spectra of variance v with correlation times in
 * progression r add up to v/(2 ln(r) f) [KESHNER1982], hence v = B^2 ln(r)/pi, here with r = 10.
 * Four of them, 10 s to 10^4 s, cover what a filter can follow: faster flicker is below the white
 * noise of usual sensors, slower is a constant. Each stands for the times of a decade about its
 * own. The model's flicker is flat below 1/(2 pi T), with the density B^2 T there: so much have
 * all processes of times up to T_m = (pi/2) T, each d ln(time) of variance (B^2/pi) d ln(time). So
 * the constant has, from 10^4.5 s on,
 *
 *     (B^2/pi) ln(T_m/10^4.5)
 *
 * and if T_m is less, a part stands for the times up to T_m alone, or is left out.
 *
 * A self-alignment over the time A before the start leaves e = M m + noise, m the means of the
 * biases over A. The filter's biases are those at its end. With the part's own statistics, exact:
 *
 *     constant with walk   var m = s^2 + K^2 A/3,  cov(m, end) = s^2 + K^2 A/2,
 *                          var end = s^2 + K^2 A
 *     Gauss-Markov         var m = 2 s^2 (a - 1 + e^-a)/a^2,  cov(m, end) = s^2 (1 - e^-a)/a,
 *                          a = A/T */
#include "navigation_filter_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"
#include "imukit/noise.h"

#include <math.h>
#include <string.h>

enum { DECADES = 4 };
static const double pi = 3.141592653589793;
static const double first_edge = 3.1622776601683795; /* where the part of 10 s begins [s] */
static const double last_edge = 31622.776601683795;  /* where that of 10^4 s ends [s] */

static double squared(double x)
{
    return x * x;
}

/* T_m: all flicker is of processes with less time [s]. */
static double longest_flicker(const imk_triad *triad)
{
    const double time = triad->noise.bias_instability_correlation_time.value;
    return 0.5 * pi * (time > 0.0 ? time : IMK_FLICKER_TIME);
}

/* Variance of what is constant while the unit stands: bias and, of scale factor and rows, the
 * uncertainty times what they respond to. */
static double constant_variance(const imk_triad *triad, int axis, imk_vector3 input,
                                imk_vector3 force)
{
    const double slower = fmax(0.0, imk_ln(longest_flicker(triad) / last_edge)) / pi;
    double along = 0.0, sum = squared(triad->bias.repeatability.value[axis]) +
                              squared(triad->bias.fixed.sigma[axis]) +
                              squared(triad->noise.bias_instability.value[axis]) * slower;
    for (int j = 0; j < 3; j++) {
        along += triad->direction[axis][j] * input.v[j];
        sum += squared(triad->misalignment.sigma[axis][j] * input.v[j]) +
               squared(triad->cross_axis.sigma[axis][j] * input.v[j]) +
               squared(triad->g_sensitivity.sigma[axis][j] * force.v[j]);
    }
    return sum + squared(triad->scale_factor.repeatability.value[axis] * along) +
           squared(triad->scale_factor.fixed.sigma[axis] * along);
}

static bool any(const double value[3])
{
    return value[0] > 0.0 || value[1] > 0.0 || value[2] > 0.0;
}

static void add_flicker(const imk_triad *triad, imk_triad_errors *errors)
{
    if (!any(triad->noise.bias_instability.value))
        return;
    const double longest = longest_flicker(triad);
    double edge = first_edge;
    for (int k = 0; k < DECADES && longest > edge; k++, edge *= 10.0) {
        const double end = fmin(10.0 * edge, longest), share = imk_ln(end / edge) / pi;
        imk_bias_part *part = &errors->part[errors->part_count++];
        part->correlation_time = sqrt(edge * end);
        for (int i = 0; i < 3; i++)
            part->sigma[i] = triad->noise.bias_instability.value[i] * sqrt(share);
    }
}

/* Axes of one term may differ in correlation time: one part for each time there is. */
static void add_gauss_markov(const imk_triad *triad, imk_triad_errors *errors)
{
    for (int k = 0; k < triad->noise.gauss_markov_count; k++) {
        const struct imk_gauss_markov_term *term = &triad->noise.gauss_markov[k];
        for (int i = 0; i < 3; i++) {
            const double time = term->correlation_time.value[i];
            bool known = !(term->sigma.value[i] > 0.0);
            for (int j = 0; j < i; j++)
                known = known ||
                        (term->sigma.value[j] > 0.0 && term->correlation_time.value[j] == time);
            if (known || errors->part_count == IMK_BIAS_PARTS_MAX)
                continue;
            imk_bias_part *part = &errors->part[errors->part_count++];
            part->correlation_time = time;
            for (int j = i; j < 3; j++)
                if (term->correlation_time.value[j] == time)
                    part->sigma[j] = term->sigma.value[j];
        }
    }
}

static void describe(const imk_triad *triad, double dt, imk_vector3 input, imk_vector3 force,
                     imk_triad_errors *errors)
{
    memset(errors, 0, sizeof *errors);
    imk_bias_part *constant = &errors->part[errors->part_count++];
    for (int i = 0; i < 3; i++) {
        errors->white[i] = triad->noise.white.value[i];
        errors->quantization[i] = imk_noise_reading(&triad->noise, i, dt);
        constant->sigma[i] = sqrt(constant_variance(triad, i, input, force));
        constant->walk[i] = triad->noise.random_walk.value[i];
    }
    add_flicker(triad, errors);
    add_gauss_markov(triad, errors);
}

imk_status imk_navigation_filter_describe(const imk_model *model, double dt, imk_vector3 rate,
                                          imk_vector3 force,
                                          imk_navigation_filter_settings *settings,
                                          imk_error *error)
{
    const imk_triad *triad[2] = {&model->gyro, &model->accel};
    static const char *const name[2] = {"gyro", "accel"};
    for (int sensor = 0; sensor < 2; sensor++)
        if (!triad[sensor]->present || triad[sensor]->axis_count != 3)
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, name[sensor], "",
                                 "a triad of three axes");
    describe(&model->gyro, dt, rate, force, &settings->gyro);
    describe(&model->accel, dt, force, force, &settings->accel);
    return IMK_OK;
}

imki_part_moments imki_bias_part_moments(const imk_bias_part *part, int axis, double time)
{
    const double s2 = squared(part->sigma[axis]), t = part->correlation_time;
    const double k2 = t > 0.0 ? 0.0 : squared(part->walk[axis]);
    imki_part_moments m = {s2 + k2 * time / 3.0, s2 + 0.5 * k2 * time, s2 + k2 * time};
    if (t > 0.0 && time > 0.0) {
        const double a = time / t, lost = -imk_expm1(-a);
        m.both = s2 * lost / a;
        /* By series where the difference cancels. */
        m.mean = a < 1e-3 ? s2 * (1.0 - a / 3.0) : 2.0 * s2 * (a - lost) / (a * a);
    }
    return m;
}

/* What the biases' means make of the attitude, M var(m) M^T, off a covariance. */
static void take_biases_off(const imk_navigation_filter_settings *settings, double covariance[3][3])
{
    const imk_triad_errors *triad[2] = {&settings->gyro, &settings->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        for (size_t p = 0; p < triad[sensor]->part_count; p++)
            for (int axis = 0; axis < 3; axis++) {
                const imk_bias_part *part = &triad[sensor]->part[p];
                const double mean =
                    imki_bias_part_moments(part, axis, settings->alignment_time).mean;
                const int column = 3 * sensor + axis;
                for (int i = 0; i < 3; i++)
                    for (int j = 0; j < 3; j++)
                        covariance[i][j] -=
                            settings->alignment[i][column] * settings->alignment[j][column] * mean;
            }
}

/* The nearest covariance: eigenvalues below zero become zero. Scaled, since heading and tilt differ
 * by orders of magnitude. */
static imk_status make_covariance(const double scale[3], double covariance[3][3])
{
    double a[9], v[9], eigenvalue[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[3 * i + j] =
                scale[i] > 0.0 && scale[j] > 0.0 ? covariance[i][j] / (scale[i] * scale[j]) : 0.0;
    const imk_status status = imk_symmetric_eigen(3, a, eigenvalue, v);
    for (int i = 0; i < 3 && status == IMK_OK; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                if (eigenvalue[k] > 0.0)
                    sum += v[3 * i + k] * eigenvalue[k] * v[3 * j + k];
            covariance[i][j] = scale[i] * scale[j] * sum;
        }
    return status;
}

imk_status imk_navigation_filter_aligned(const imk_alignment_result *alignment,
                                         imk_alignment_method method, bool heading,
                                         double alignment_time,
                                         imk_navigation_filter_settings *settings)
{
    const imk_navigation_state *start = &alignment->state;
    const imk_geodetic place = imk_geodetic_from_ecef(start->position);
    const imk_matrix3 axes = imk_ned_axes(place.latitude, place.longitude);
    const imk_matrix3 c = imk_matrix3_multiply(imk_matrix3_transpose(axes),
                                               imk_quaternion_to_matrix(start->attitude));
    const double g = imk_normal_gravity(place.latitude, place.height);
    const double cosine = imk_cos(place.latitude), tangent = imk_sin(place.latitude) / cosine;
    imk_navigation_filter_settings made = *settings;
    made.alignment_time = alignment_time;
    const double level = method == IMK_ALIGNMENT_INERTIAL ? 0.5 * alignment_time : 0.0;
    const double about = method == IMK_ALIGNMENT_MEANS ? 0.0 : 0.5 * alignment_time;
    for (int axis = 0; axis < 3; axis++) {
        const double north = -c.m[1][axis] / (IMK_EARTH_RATE * cosine) + about * c.m[2][axis];
        made.alignment[0][axis] = level * c.m[0][axis];
        made.alignment[1][axis] = 0.0;
        made.alignment[2][axis] = heading ? north : 0.0;
        made.alignment[0][3 + axis] = -c.m[1][axis] / g;
        made.alignment[1][3 + axis] = c.m[0][axis] / g;
        made.alignment[2][3 + axis] = heading ? c.m[1][axis] * tangent / g : 0.0;
    }
    double scale[3];
    for (int i = 0; i < 3; i++) {
        scale[i] = sqrt(alignment->covariance[i][i] > 0.0 ? alignment->covariance[i][i] : 0.0);
        for (int j = 0; j < 3; j++)
            made.attitude_covariance[i][j] =
                0.5 * (alignment->covariance[i][j] + alignment->covariance[j][i]);
    }
    take_biases_off(&made, made.attitude_covariance);
    const imk_status status = make_covariance(scale, made.attitude_covariance);
    if (status == IMK_OK)
        *settings = made;
    return status;
}
