/* SPDX-License-Identifier: Apache-2.0 */
/* Tumble test and thermal chamber. */
#include "laboratory_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/units.h"

#include <math.h>

enum { POSES = 19, POSE_TERMS = 10, TEMPERATURES = 5, TRIALS = 3 * TEMPERATURES + 1 };

/* ---- tumble: 6 faces and 12 edges of a cube, and no force ---------------------------------------
 *
 * Forces of 1 g alone cannot tell a bias from equal squares, since fx^2 + fy^2 + fz^2 is the same
 * for all; the last pose, free of force, can.
 *
 *     gyro           output = b + G1 . f + G2 . (fx^2, fy^2, fz^2, fx fy, fy fz, fz fx)
 *     accelerometer  output - f_i = b + s f_i + X_p f_p + X_o f_o
 *                                 + K2 f_i^2 + Kip f_i f_p + Kio f_i f_o + Kpo f_p f_o */

static void pose(int number, double f[3])
{
    static const signed char poses[POSES][3] = {
        {1, 0, 0},  {-1, 0, 0}, {0, 1, 0},   {0, -1, 0},  {0, 0, 1},  {0, 0, -1}, {1, 1, 0},
        {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 1, 1},   {0, 1, -1}, {0, -1, 1}, {0, -1, -1},
        {1, 0, 1},  {1, 0, -1}, {-1, 0, 1},  {-1, 0, -1}, {0, 0, 0}};
    const double length = number < 6 ? 1.0 : sqrt(2.0);
    for (int k = 0; k < 3; k++)
        f[k] = IMK_STANDARD_GRAVITY * poses[number][k] / length;
}

static void gyro_tumble(const double *y, double noise, imk_triad *triad)
{
    double a[POSES * POSE_TERMS], x[POSE_TERMS], sigma[POSE_TERMS], f[3];
    const double g = IMK_STANDARD_GRAVITY;
    for (int i = 0; i < POSES; i++) {
        pose(i, f);
        const double u[3] = {f[0] / g, f[1] / g, f[2] / g};
        const double row[POSE_TERMS] = {1.0,         u[0],        u[1],        u[2],
                                        u[0] * u[0], u[1] * u[1], u[2] * u[2], u[0] * u[1],
                                        u[1] * u[2], u[2] * u[0]};
        for (int k = 0; k < POSE_TERMS; k++)
            a[i * POSE_TERMS + k] = row[k];
    }
    if (!imki_fit(POSES, POSE_TERMS, a, y, noise, x, sigma))
        return;
    for (int k = 0; k < 3; k++) {
        triad->g_sensitivity.value[0][k] = x[1 + k] / g;
        triad->g_sensitivity.sigma[0][k] = sigma[1 + k] / g;
    }
    for (int k = 0; k < 6; k++) {
        triad->g2_sensitivity.value[0][k] = x[4 + k] / (g * g);
        triad->g2_sensitivity.sigma[0][k] = sigma[4 + k] / (g * g);
    }
}

/* The pendulous axis p, by default z, and the output axis o = p x input. */
static void axes_of(const double stated[3], double p[3], double o[3])
{
    const bool given = stated[0] != 0.0 || stated[1] != 0.0 || stated[2] != 0.0;
    for (int k = 0; k < 3; k++)
        p[k] = given ? stated[k] : k == 2 ? 1.0 : 0.0;
    o[0] = 0.0;
    o[1] = p[2];
    o[2] = -p[1];
}

static void accel_tumble(const double *y, double noise, const double stated[3], imk_triad *triad)
{
    enum { TERMS = 8 };
    double a[POSES * TERMS], residual[POSES], x[TERMS], sigma[TERMS], f[3], p[3], o[3];
    const double g = IMK_STANDARD_GRAVITY;
    axes_of(stated, p, o);
    for (int i = 0; i < POSES; i++) {
        pose(i, f);
        const double u = f[0] / g, v = imki_dot3(f, p) / g, w = imki_dot3(f, o) / g;
        const double row[TERMS] = {1.0, u, v, w, u * u, u * v, u * w, v * w};
        for (int k = 0; k < TERMS; k++)
            a[i * TERMS + k] = row[k];
        residual[i] = y[i] - f[0];
    }
    if (!imki_fit(POSES, TERMS, a, residual, noise, x, sigma))
        return;
    for (int k = 0; k < 3; k++) {
        const double along_p = p[k] * sigma[2], along_o = o[k] * sigma[3];
        triad->cross_axis.value[0][k] = (p[k] * x[2] + o[k] * x[3]) / g;
        triad->cross_axis.sigma[0][k] = sqrt(along_p * along_p + along_o * along_o) / g;
        triad->nonlinearity.cross_products.value[0][k] = x[5 + k] / (g * g);
        triad->nonlinearity.cross_products.sigma[0][k] = sigma[5 + k] / (g * g);
    }
}

void imki_tumble(const imk_laboratory *laboratory, const double pendulous[3], char *states,
                 const imk_executor *executor, imk_laboratory_result *result)
{
    imki_trial trials[POSES];
    double y[POSES], noise = 0.0;
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
    for (int i = 0; i < POSES; i++) {
        trials[i] = imki_trial_of(laboratory, 0.0);
        pose(i, trials[i].exposure.specific_force);
    }
    imki_trials_run(laboratory, POSES, trials, states, executor);
    for (int i = 0; i < POSES; i++) {
        y[i] = trials[i].reading.output;
        noise += trials[i].reading.sigma * trials[i].reading.sigma / POSES;
    }
    noise = imki_reading_sigma(result, sqrt(noise));
    if (laboratory->instrument->sensor == IMK_GYRO)
        gyro_tumble(y, noise, triad);
    else
        accel_tumble(y, noise, pendulous, triad);
}

/* ---- thermal chamber --------------------------------------------------------------------------
 *
 * At five temperatures, 10 K apart, the readings at zero and at plus and minus half of full scale:
 * bias from the first, scale factor from the difference of the other two; a line through each. One
 * more run with the temperature rising by 0.01 K/s shows what its rate does. */

static const double temperature_step = 10.0; /* [K] */
static const double ramp = 0.01;             /* [K/s] */

/* @return 1 sigma of a reading: how far they are from their line, or their noise if that is more */
static double fit_line(const double *y, double noise, imk_axes *slope,
                       imk_temperature_polynomial *p, double middle)
{
    double a[2 * TEMPERATURES], x[2], sigma[2];
    for (int i = 0; i < TEMPERATURES; i++) {
        a[2 * i] = 1.0;
        a[2 * i + 1] = temperature_step * (i - TEMPERATURES / 2);
    }
    if (!imki_fit(TEMPERATURES, 2, a, y, noise, x, sigma))
        return noise;
    slope->value[0] = x[1];
    slope->sigma[0] = sigma[1];
    p->order = 1;
    p->reference = middle;
    p->minimum = middle - temperature_step * (TEMPERATURES / 2);
    p->maximum = middle + temperature_step * (TEMPERATURES / 2);
    return sigma[0] * sqrt((double)TEMPERATURES);
}

void imki_chamber(const imk_laboratory *laboratory, char *states, const imk_executor *executor,
                  imk_laboratory_result *result)
{
    imki_trial trials[TRIALS];
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
    const double half = 0.5 * result->full_scale, middle = laboratory->surroundings.temperature;
    double bias[TEMPERATURES], scale[TEMPERATURES], noise = 0.0;
    for (int i = 0; i < 3 * TEMPERATURES; i++) {
        trials[i] = imki_trial_of(laboratory, half * (i % 3 - 1));
        trials[i].exposure.temperature += temperature_step * (i / 3 - TEMPERATURES / 2);
    }
    trials[TRIALS - 1] = imki_trial_of(laboratory, 0.0);
    trials[TRIALS - 1].exposure.temperature_rate = ramp;
    imki_trials_run(laboratory, TRIALS, trials, states, executor);
    for (int i = 0; i < TEMPERATURES; i++) {
        const imki_trial *at = &trials[3 * i];
        bias[i] = at[1].reading.output;
        scale[i] = (at[2].reading.output - at[0].reading.output) / (2.0 * half);
    }
    for (int i = 0; i < TRIALS; i++)
        noise += trials[i].reading.sigma * trials[i].reading.sigma / TRIALS;
    noise = imki_reading_sigma(result, sqrt(noise));
    const double scatter = fit_line(bias, noise, &triad->bias.temperature.coefficient[0],
                                    &triad->bias.temperature, middle);
    fit_line(scale, noise / (sqrt(2.0) * half), &triad->scale_factor.temperature.coefficient[0],
             &triad->scale_factor.temperature, middle);
    triad->bias.temperature_rate.value[0] =
        (trials[TRIALS - 1].reading.output - bias[TEMPERATURES / 2]) / ramp;
    triad->bias.temperature_rate.sigma[0] = sqrt(2.0) * scatter / ramp;
}
