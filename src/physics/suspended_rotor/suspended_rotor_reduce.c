/* SPDX-License-Identifier: Apache-2.0 */
/* Closed forms of the suspended ball, and its error model.
 *
 * A pair of electrodes on case axis k pulls the ball with p+ on the one and p- on the other side.
 * Their difference carries the ball, m f_k. With voltages V0 +- v the forces are as (V0 +- v)^2, so
 * the difference is 4 V0 v and the sum 2 (V0^2 + v^2): T0 + (m f)^2/(4 T0) when T0 is the sum at
 * rest, and v = V0 where m f = 2 T0 and one side has none left. A surface that stands out by
 * delta(x) where its angle to the spin axis has the cosine x does the work p+ delta(s_k) + p-
 * delta(-s_k): even harmonics go with the sum, odd ones with the difference. The torque turns s
 * towards more work, M = s x grad G. */
#include "imukit/elementary.h"
#include "suspended_rotor_internal.h"

#include <math.h>

/* Range of the polynomial: that of a heated instrument's surroundings, -20 ... 70 degC [K]. */
#define LOWEST_TEMPERATURE 253.15
#define HIGHEST_TEMPERATURE 343.15

double imk_suspended_rotor_mass(const imk_suspended_rotor *design)
{
    const double outside = design->diameter, inside = design->hollow;
    return IMKI_PI / 6.0 * design->density *
           (outside * outside * outside - inside * inside * inside);
}

/* Inertia of the ball when it is round [kg m^2]. */
static double round_inertia(const imk_suspended_rotor *design)
{
    const double r = 0.5 * design->diameter, i = 0.5 * design->hollow;
    return 8.0 * IMKI_PI / 15.0 * design->density * (r * r * r * r * r - i * i * i * i * i);
}

double imk_suspended_rotor_momentum(const imk_suspended_rotor *design)
{
    const double e = design->inertia_difference;
    return round_inertia(design) * 3.0 * (1.0 + e) / (3.0 + e) * design->spin_rate;
}

double imk_suspended_rotor_wobble(const imk_suspended_rotor *design)
{
    return (1.0 + design->inertia_difference) * design->spin_rate / (2.0 * IMKI_PI);
}

imki_suspended_ball imki_suspended_ball_of(const imk_suspended_rotor *design)
{
    const double mass = imk_suspended_rotor_mass(design), pull = 0.5 * mass * design->limit;
    imki_suspended_ball ball = {
        .per_h = 1.0 / imk_suspended_rotor_momentum(design),
        .mass = mass,
        .moment = mass * design->unbalance,
        .second = design->oblateness,
        .third = design->pear,
        .per_pull = 0.25 / pull,
        .limit = design->limit,
    };
    for (int k = 0; k < 3; k++)
        ball.pull[k] = pull * (1.0 + design->preload_error[k]);
    return ball;
}

void imki_suspended_gradient(const imki_suspended_ball *ball, const double weak[3],
                             const double axis[3], const double force[3], double gradient[3])
{
    for (int k = 0; k < 3; k++) {
        const double carried = ball->mass * force[k];
        const double pull = ball->pull[k] + carried * carried * ball->per_pull;
        gradient[k] = -weak[0] * ball->moment * force[k] +
                      weak[1] * 3.0 * ball->second * pull * axis[k] +
                      weak[2] * ball->third * carried * (7.5 * axis[k] * axis[k] - 1.5);
    }
}

void imk_suspended_rotor_drift(const imk_suspended_rotor *design, const double axis[3],
                               const double force[3], double drift[3])
{
    static const double whole[3] = {1.0, 1.0, 1.0};
    const imki_suspended_ball ball = imki_suspended_ball_of(design);
    double g[3], result[3];
    imki_suspended_gradient(&ball, whole, axis, force, g);
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        result[k] = ball.per_h * (axis[l] * g[m] - axis[m] * g[l]);
    }
    for (int k = 0; k < 3; k++)
        drift[k] = result[k];
}

void imki_suspended_start(const imk_suspended_rotor *design, double axis[3])
{
    const double sine = imk_sin(design->start_tilt);
    axis[0] = sine * imk_cos(design->start_azimuth);
    axis[1] = sine * imk_sin(design->start_azimuth);
    axis[2] = imk_cos(design->start_tilt);
}

/* Row x of I - s s^T. */
static void seen_by_x(const double s[3], double row[3])
{
    for (int k = 0; k < 3; k++)
        row[k] = (k == 0 ? 1.0 : 0.0) - s[0] * s[k];
}

static void reduce_drift(const imk_suspended_rotor *design, const imki_suspended_ball *ball,
                         const double s[3], const double row[3], imk_triad *gyro)
{
    const double *t = design->torque;
    double fixed = s[2] * t[1] - s[1] * t[2];
    for (int k = 0; k < 3; k++) {
        const double second = 3.0 * ball->second * s[k] * row[k];
        fixed += second * ball->pull[k];
        gyro->g_sensitivity.value[0][k] =
            ball->per_h * row[k] *
            (ball->mass * ball->third * (7.5 * s[k] * s[k] - 1.5) - ball->moment);
        gyro->g2_sensitivity.value[0][k] =
            ball->per_h * second * ball->mass * ball->mass * ball->per_pull;
    }
    gyro->bias.fixed.value[0] = ball->per_h * fixed;
    if (design->torque_temperature == 0.0)
        return;
    gyro->bias.temperature.order = 1;
    gyro->bias.temperature.coefficient[0].value[0] =
        ball->per_h * design->torque_temperature * (s[2] - s[1]);
    gyro->bias.temperature.reference = IMKI_DESIGN_TEMPERATURE;
    gyro->bias.temperature.minimum = LOWEST_TEMPERATURE;
    gyro->bias.temperature.maximum = HIGHEST_TEMPERATURE;
}

void imki_suspended_rotor_reduce(const imk_suspended_rotor *design, imk_triad *gyro)
{
    const imki_suspended_ball ball = imki_suspended_ball_of(design);
    const double step = design->readout_resolution;
    double s[3], row[3];
    imki_suspended_start(design, s);
    seen_by_x(s, row);
    const double across = sqrt(s[1] * s[1] + s[2] * s[2]);
    reduce_drift(design, &ball, s, row, gyro);
    gyro->scale_factor.fixed.value[0] = row[0] - 1.0;
    gyro->misalignment.value[0][1] = row[1];
    gyro->misalignment.value[0][2] = row[2];
    gyro->bias.repeatability.value[0] = ball.per_h * across * design->torque_repeatability;
    gyro->noise.density = IMK_DENSITY_TWO_SIDED;
    gyro->noise.white.value[0] = ball.per_h * across * design->torque_noise;
    gyro->noise.bias_instability.value[0] = ball.per_h * across * design->torque_instability;
    gyro->noise.quantization.value[0] = across * step / sqrt(12.0);
    gyro->noise.reading_noise.value[0] = across * design->readout_noise;
}
