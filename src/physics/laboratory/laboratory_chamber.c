/* SPDX-License-Identifier: Apache-2.0 */
/* Tumble test and thermal chamber. */
#include "laboratory_internal.h"

#include "base/algebra/vector_internal.h"
#include "imukit/units.h"

#include <math.h>

enum { POSES = IMK_LABORATORY_POSES, TEMPERATURES = IMK_LABORATORY_TEMPERATURES };

/* ---- tumble: 6 faces and 12 edges of a cube, and no force ---------------------------------------
 *
 * Forces of 1 g alone cannot tell a bias from equal squares, since fx^2 + fy^2 + fz^2 is the same
 * for all; the last pose, free of force, can.
 *
 *     gyro           output = b + G1 . f + G2 . (fx^2, fy^2, fz^2, fx fy, fy fz, fz fx)
 *     accelerometer  output - f_i = b + s f_i + K2 f_i^2 + K3 f_i^3 + X_y f_y + X_z f_z
 *                                 + Kip f_i f_p + Kio f_i f_o + Kpo f_p f_o
 *
 * What acts along x is the rate table's matter, and in the law of an accelerometer only to be out
 * of the way. */

static void pose(size_t number, double u[3])
{
    static const signed char poses[POSES][3] = {
        {1, 0, 0},  {-1, 0, 0}, {0, 1, 0},   {0, -1, 0},  {0, 0, 1},  {0, 0, -1}, {1, 1, 0},
        {1, -1, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 1, 1},   {0, 1, -1}, {0, -1, 1}, {0, -1, -1},
        {1, 0, 1},  {1, 0, -1}, {-1, 0, 1},  {-1, 0, -1}, {0, 0, 0}};
    const double length = number < 6 ? 1.0 : sqrt(2.0);
    for (int k = 0; k < 3; k++)
        u[k] = poses[number][k] / length;
}

static void gyro_columns(imki_bench *bench, imki_experiment *e)
{
    static const char *const linear[] = {"g_sensitivity.x", "g_sensitivity.y", "g_sensitivity.z"};
    static const char *const square[] = {"g2_sensitivity.xx", "g2_sensitivity.yy",
                                         "g2_sensitivity.zz", "g2_sensitivity.xy",
                                         "g2_sensitivity.yz", "g2_sensitivity.zx"};
    const double g = IMK_STANDARD_GRAVITY;
    imk_triad *t = bench->triad;
    imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    for (int k = 0; k < 3; k++)
        imki_experiment_column(e, linear[k], g, &t->g_sensitivity.value[0][k],
                               &t->g_sensitivity.sigma[0][k]);
    for (int k = 0; k < 6; k++)
        imki_experiment_column(e, square[k], g * g, &t->g2_sensitivity.value[0][k],
                               &t->g2_sensitivity.sigma[0][k]);
}

static void gyro_row(const double u[3], double *row)
{
    *row++ = 1.0;
    for (int k = 0; k < 3; k++)
        *row++ = u[k];
    for (int k = 0; k < 3; k++)
        *row++ = u[k] * u[k];
    for (int k = 0; k < 3; k++)
        *row++ = u[k] * u[(k + 1) % 3];
}

static void accel_columns(imki_bench *bench, imki_experiment *e)
{
    static const char *const cross[] = {"misalignment.y", "misalignment.z"};
    static const char *const products[] = {"cross_products.kip", "cross_products.kio",
                                           "cross_products.kpo"};
    const double g = IMK_STANDARD_GRAVITY;
    imk_triad *t = bench->triad;
    for (int k = 0; k < 4; k++)
        imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    for (int k = 0; k < 2; k++)
        imki_experiment_column(e, cross[k], g, &t->cross_axis.value[0][1 + k],
                               &t->cross_axis.sigma[0][1 + k]);
    for (int k = 0; k < 3; k++)
        imki_experiment_column(e, products[k], g * g, &t->nonlinearity.cross_products.value[0][k],
                               &t->nonlinearity.cross_products.sigma[0][k]);
}

/* The pendulous axis p, by default z, and the output axis o = p x input. */
static void accel_row(const double stated[3], const double u[3], double *row)
{
    const bool given = stated[0] != 0.0 || stated[1] != 0.0 || stated[2] != 0.0;
    const double p[3] = {0.0, given ? stated[1] : 0.0, given ? stated[2] : 1.0};
    const double o[3] = {0.0, p[2], -p[1]};
    const double along_p = imki_dot3(u, p), along_o = imki_dot3(u, o);
    const double values[9] = {1.0,  u[0],           u[0] * u[0],    u[0] * u[0] * u[0], u[1],
                              u[2], u[0] * along_p, u[0] * along_o, along_p * along_o};
    for (int k = 0; k < 9; k++)
        row[k] = values[k];
}

/* Force along x is the input of an accelerometer, which has scale factor and nonlinearity. */
static double along_input(const imki_bench *b, double f)
{
    const double s = b->computed[imki_figure_of(b, "scale_factor.fixed")].value;
    const double k2 = b->computed[imki_figure_of(b, "nonlinearity.k2")].value;
    const double k3 = b->computed[imki_figure_of(b, "nonlinearity.k3")].value;
    return b->laboratory->instrument->sensor == IMK_GYRO ? 0.0 : f * (s + f * (k2 + f * k3));
}

void imki_tumble(imki_bench *bench)
{
    const bool gyro = bench->laboratory->instrument->sensor == IMK_GYRO;
    imki_experiment *e = imki_experiment_begin(bench, "tumble");
    double u[3];
    e->rows = POSES;
    e->rest = POSES - 1;
    e->limit = "higher orders of the force";
    if (gyro)
        gyro_columns(bench, e);
    else
        accel_columns(bench, e);
    for (size_t i = 0; i < POSES; i++) {
        pose(i, u);
        e->trial[i] = imki_trial_of(bench->laboratory, 0.0);
        for (int k = 0; k < 3; k++)
            e->trial[i].exposure.specific_force[k] += IMK_STANDARD_GRAVITY * u[k];
        if (gyro) {
            gyro_row(u, &e->a[i * e->columns]);
        } else {
            e->trial[i].input = IMK_STANDARD_GRAVITY * u[0];
            e->offset[i] = e->trial[i].input;
            accel_row(bench->pendulous_axis, u, &e->a[i * e->columns]);
        }
    }
    imki_experiment_run(bench);
    bench->result->pose_count = e->cycles > 0 ? POSES : 0;
    for (size_t i = 0; e->cycles > 0 && i < POSES; i++) {
        imk_laboratory_pose *p = &bench->result->pose[i];
        pose(i, u);
        for (int k = 0; k < 3; k++)
            p->force[k] = IMK_STANDARD_GRAVITY * u[k];
        p->error = e->change[i] - e->offset[i];
        p->sigma = e->scatter[i];
        p->computed =
            imki_experiment_computed(bench, i) - e->offset[i] + along_input(bench, p->force[0]);
    }
}

/* ---- thermal chamber --------------------------------------------------------------------------
 *
 * At five temperatures, 10 K apart, the readings at zero and at plus and minus half of full scale;
 * one more run with the temperature rising by 0.01 K/s shows what its rate does.
 *
 *     output - input = b + s u + c |u| + b_T dT + s_T u dT + r dT/dt + (p + q u) dT^2 + (v + w dT)
 * |u| dT
 *
 * of which the last four terms are not told. */

static const double temperature_step = 10.0; /* [K] */
static const double ramp = 0.01;             /* [K/s] */

static void keep_temperatures(imki_bench *bench, double half)
{
    const imki_experiment *e = &bench->experiment;
    const size_t middle = TEMPERATURES / 2;
    for (size_t i = 0; i < TEMPERATURES; i++) {
        imk_laboratory_warmth *w = &bench->result->warmth[i];
        const size_t zero = 3 * i + 1, at = 3 * middle + 1;
        const double step = temperature_step * ((double)i - (double)middle);
        w->temperature = e->trial[zero].exposure.temperature;
        w->bias = e->change[zero];
        w->bias_sigma = e->scatter[zero];
        w->bias_computed = imki_experiment_computed(bench, zero);
        w->scale = (e->mean[zero + 1] - e->mean[zero - 1] - e->mean[at + 1] + e->mean[at - 1]) /
                   (2.0 * half);
        w->scale_sigma = i == middle ? 0.0 : e->sigma[4] / half * fabs(step) / temperature_step;
        w->scale_computed =
            bench->computed[imki_figure_of(bench, "scale_factor.temperature")].value * step;
    }
    bench->result->warmth_count = TEMPERATURES;
}

static void chamber_columns(imki_bench *bench, imki_experiment *e, double half)
{
    imk_triad *t = bench->triad;
    const double middle = bench->laboratory->surroundings.temperature;
    imk_temperature_polynomial *polynomial[2] = {&t->bias.temperature,
                                                 &t->scale_factor.temperature};
    for (int k = 0; k < 3; k++)
        imki_experiment_column(e, NULL, 1.0, NULL, NULL);
    for (int k = 0; k < 2; k++) {
        imk_temperature_polynomial *p = polynomial[k];
        p->order = 1;
        p->reference = middle;
        p->minimum = middle - temperature_step * (TEMPERATURES / 2);
        p->maximum = middle + temperature_step * (TEMPERATURES / 2);
        imki_experiment_column(e, k == 0 ? "bias.temperature" : "scale_factor.temperature",
                               k == 0 ? temperature_step : temperature_step * half,
                               &p->coefficient[0].value[0], &p->coefficient[0].sigma[0]);
    }
    imki_experiment_column(e, "bias.temperature_rate", ramp, &t->bias.temperature_rate.value[0],
                           &t->bias.temperature_rate.sigma[0]);
    for (int k = 0; k < 4; k++)
        imki_experiment_column(e, NULL, 1.0, NULL, NULL);
}

void imki_chamber(imki_bench *bench)
{
    const double half = 0.5 * bench->result->full_scale;
    imki_experiment *e = imki_experiment_begin(bench, "chamber");
    e->rows = 3 * TEMPERATURES + 1;
    e->rest = 3 * (TEMPERATURES / 2) + 1;
    e->limit = "higher orders of the temperature";
    chamber_columns(bench, e, half);
    for (size_t i = 0; i < e->rows; i++) {
        const bool rises = i == 3 * TEMPERATURES;
        const double u = rises ? 0.0 : (double)(i % 3) - 1.0;
        const double warm = rises ? 0.0 : (double)(i / 3) - TEMPERATURES / 2;
        const double square = warm * warm, size = fabs(u);
        const double row[IMKI_COEFFICIENTS] = {
            1.0,    u,          size,        warm,         u * warm, rises ? 1.0 : 0.0,
            square, u * square, size * warm, size * square};
        e->trial[i] = imki_trial_of(bench->laboratory, half * u);
        e->trial[i].exposure.temperature += temperature_step * warm;
        e->trial[i].exposure.temperature_rate += rises ? ramp : 0.0;
        e->offset[i] = e->trial[i].input;
        for (size_t k = 0; k < e->columns; k++)
            e->a[i * e->columns + k] = row[k];
    }
    imki_experiment_run(bench);
    if (e->cycles > 0)
        keep_temperatures(bench, half);
}
