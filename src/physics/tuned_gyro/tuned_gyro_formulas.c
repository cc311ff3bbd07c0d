/* SPDX-License-Identifier: Apache-2.0 */
/* The dynamically tuned gyro by closed forms, and its error model. */
#include "tuned_gyro_internal.h"

#include <math.h>

/* A rotor that stands tilted in the case moves at the frequency N in the axes of the shaft, on an
 * ellipse: the sum of a circle backwards, the steady tilt a = th_x - i th_y, and one forwards, b,
 * which is a motion at 2N in the case. For steady torque t = T_x - i T_y and rate w = w_x - i w_y
 * the equations of tuned_gyro.h give
 *
 *     P a + Q b = 2 t - i (2 C + j) N w,   Q a + D b = -i j N w
 *     P = kx + ky - J N^2 + 2 i d N,   Q = kx - ky - J N^2,   D = P + 4 (C - 2A) N^2
 *
 * with j = Ag - Bg + Cg. Hence t = K a + i H w with K = (P - Q^2/D)/2 and
 * H = N (C + j/2 - j Q/(2D)); d is left out of D. */
typedef struct ellipse {
    double p, q, d;
} ellipse;

static ellipse ellipse_at(const imk_tuned_gyro *d, double speed)
{
    const double square = speed * speed, dynamic = imki_tuned_gyro_gimbal_sum(d) * square;
    ellipse e;
    e.p = d->stiffness_x + d->stiffness_y - dynamic;
    e.q = d->stiffness_x - d->stiffness_y - dynamic;
    e.d = e.p + 4.0 * (d->axial_inertia - 2.0 * d->transverse_inertia) * square;
    return e;
}

static double spring_at(const imk_tuned_gyro *d, double speed)
{
    const ellipse e = ellipse_at(d, speed);
    return 0.5 * (e.p - e.q * e.q / e.d);
}

double imk_tuned_gyro_first_speed(const imk_tuned_gyro *d)
{
    return sqrt((d->stiffness_x + d->stiffness_y) / imki_tuned_gyro_gimbal_sum(d));
}

/* The spring falls with the speed. */
double imk_tuned_gyro_tuned_speed(const imk_tuned_gyro *d)
{
    double low = 0.5 * imk_tuned_gyro_first_speed(d), high = 4.0 * low;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (spring_at(d, middle) > 0.0)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double imk_tuned_gyro_speed(const imk_tuned_gyro *d)
{
    return 2.0 * IMKI_PI * d->spin_frequency * (1.0 + d->speed_error);
}

double imk_tuned_gyro_momentum(const imk_tuned_gyro *d, double speed)
{
    const ellipse e = ellipse_at(d, speed);
    const double j = d->gimbal_inertia_x - d->gimbal_inertia_y + d->gimbal_inertia_z;
    return speed * (d->axial_inertia + 0.5 * j * (1.0 - e.q / e.d));
}

double imk_tuned_gyro_residual_spring(const imk_tuned_gyro *d)
{
    return spring_at(d, imk_tuned_gyro_speed(d));
}

double imk_tuned_gyro_time_constant(const imk_tuned_gyro *d)
{
    const double speed = imk_tuned_gyro_speed(d);
    return imk_tuned_gyro_momentum(d, speed) / (speed * d->hinge_damping);
}

double imk_tuned_gyro_figure_of_merit(const imk_tuned_gyro *d)
{
    return d->axial_inertia / imki_tuned_gyro_gimbal_sum(d);
}

double imk_tuned_gyro_nutation(const imk_tuned_gyro *d)
{
    return imk_tuned_gyro_momentum(d, imk_tuned_gyro_speed(d)) /
           (d->transverse_inertia + 0.5 * d->gimbal_inertia_x);
}

/* The half of the vibration that turns forwards, W, drives the ellipse's forward circle:
 * D b = i N W (2 (C - 2A) - J), and 2 t = Q b + i N W J. */
double imk_tuned_gyro_vibration_drift(const imk_tuned_gyro *d)
{
    const double speed = imk_tuned_gyro_speed(d), sum = imki_tuned_gyro_gimbal_sum(d);
    const ellipse e = ellipse_at(d, speed);
    const double forward = 2.0 * (d->axial_inertia - 2.0 * d->transverse_inertia) - sum;
    return 0.25 * speed * fabs(e.q * forward / e.d + sum) / imk_tuned_gyro_momentum(d, speed);
}

/* ---- error model ----------------------------------------------------------------------------- */

typedef struct complex_number {
    double re, im;
} complex_number;

/* G = F C/(s - i q + F C), C = (2 z w0 s + w0^2)/s, of the reading x - i y of a rotor whose
 * residual spring turns its tilt by q = K/H; F the Butterworth filter. */
static complex_number loop_gain(const imk_tuned_gyro *d, double w, double q)
{
    const double w0 = 2.0 * IMKI_PI * d->loop_frequency, wf = 2.0 * IMKI_PI * d->loop_filter;
    /* G = wf^2 (2 z w0 s + w0^2)/[s (s - i q) (s^2 + sqrt2 wf s + wf^2) + wf^2 (2 z w0 s + w0^2)]
     */
    const double re = wf * wf * w0 * w0, im = wf * wf * 2.0 * d->loop_damping * w0 * w;
    const double turned = w * (w - q);
    const double below_re = re - turned * (wf * wf - w * w);
    const double below_im = im - turned * sqrt(2.0) * wf * w;
    const double square = below_re * below_re + below_im * below_im;
    return (complex_number){(re * below_re + im * below_im) / square,
                            (im * below_re - re * below_im) / square};
}

/* Of the response of x to x: the mean of both senses of turning. */
static double loop_power(const void *design, double w)
{
    const imk_tuned_gyro *d = design;
    const double q =
        imk_tuned_gyro_residual_spring(d) / imk_tuned_gyro_momentum(d, imk_tuned_gyro_speed(d));
    const complex_number g = loop_gain(d, w, q), h = loop_gain(d, w, -q);
    const double re = 0.5 * (g.re + h.re), im = 0.5 * (g.im + h.im);
    return re * re + im * im;
}

double imki_tuned_gyro_bandwidth(const imk_tuned_gyro *d)
{
    return imki_response_edge(loop_power, d, 2.0 * IMKI_PI * d->loop_frequency) / (2.0 * IMKI_PI);
}

void imki_tuned_gyro_reduce(const imk_tuned_gyro *d, imk_triad *triad)
{
    const double speed = imk_tuned_gyro_speed(d);
    const double nominal = imk_tuned_gyro_momentum(d, speed / (1.0 + d->speed_error));
    const double momentum = imk_tuned_gyro_momentum(d, speed);
    const double torquer = 1.0 / (1.0 + d->torquer_error);
    const double scale = d->captured ? momentum / nominal * torquer : 1.0;
    const double per_torque = scale / momentum;
    const double thermal = imk_thermal_torque(d->hinge_damping);
    const double compliance = d->axial_compliance - d->radial_compliance;
    const imki_gimbal gimbal = {.moment_z = d->mass * d->axial_offset,
                                .anisoelastic = d->mass * d->mass * compliance};
    imki_reduce_torques(&d->torque, &gimbal, per_torque, triad);
    triad->g_sensitivity.value[0][1] = d->mass * d->quadrature_offset * per_torque;
    triad->scale_factor.fixed.value[0] = scale - 1.0;
    triad->noise.white.value[0] =
        sqrt(thermal * thermal + d->torque.noise * d->torque.noise) * per_torque;
    if (!d->captured)
        return;
    triad->bias.fixed.value[0] += (imk_tuned_gyro_residual_spring(d) * d->pickoff_offset_y -
                                   speed * d->hinge_damping * d->pickoff_offset_x) *
                                  per_torque;
    triad->misalignment.value[0][2] = scale * d->pickoff_offset_y;
    imki_reduce_scale_temperature(-torquer * d->torquer_temperature, triad);
    triad->range.value[0] = d->torquer_limit / nominal;
    imki_reduce_response(loop_power, d, 2.0 * IMKI_PI * d->loop_frequency, triad);
}
