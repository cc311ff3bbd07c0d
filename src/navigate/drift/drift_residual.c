/* SPDX-License-Identifier: Apache-2.0 */
/* What calibration left: a model whose known values v with 1-sigma uncertainties s are taken out
 * has, in each run, values of its own in their place,
 *
 *     v <- s n,   n normal number `component` of the stream (run, IMK_TERM_RESIDUAL, parameter,
 *                 axis),
 *
 * axis 0-7 of the gyros, 8-15 of the accelerometers, 0 for the timing. The numbers of the
 * parameters below are fixed for ever, so that a new one changes no draw of an old one; components
 * are counted along a row of the model (x, y, z), a scalar being component 0. */
#include "drift_runs_internal.h"

#include "imukit/noise.h"

#include <string.h>

enum parameter {
    BIAS_FIXED = 0,
    /* 1, 2 and 4 are kept for bias.temperature, bias.temperature_rate and bias.hysteresis, 6 for
     * scale_factor.temperature: without a temperature profile they do nothing. */
    BIAS_WARM_UP = 3,
    SCALE_FACTOR_FIXED = 5,
    K2 = 7,
    KOQ = 8,
    K3 = 9,
    ASYMMETRY = 10,
    CROSS_PRODUCTS = 11,
    MISALIGNMENT = 12,
    CROSS_AXIS = 13,
    G_SENSITIVITY = 14,
    G2_SENSITIVITY = 15,
    LEVER_ARM = 16,
    RAMP = 17,
    RATE_ERROR = 18,
    SKEW = 19
};

typedef struct draw {
    imk_random random;
    uint32_t run;
    uint8_t first_axis;
    int axis_count;
} draw;

/* One row of a parameter: value[i] <- sigma[i] n[i]. */
static void draw_row(const draw *d, enum parameter parameter, int axis, size_t count,
                     const double *sigma, double *value)
{
    double normal[6];
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any = any || sigma[i] != 0.0;
    memset(value, 0, count * sizeof *value);
    if (!any)
        return;
    const uint64_t stream =
        imk_stream(d->run, IMK_TERM_RESIDUAL, (uint8_t)parameter, (uint8_t)(d->first_axis + axis));
    imk_random_normals(d->random, stream, 0, count, normal);
    for (size_t i = 0; i < count; i++)
        value[i] = sigma[i] * normal[i];
}

static void draw_axes(const draw *d, enum parameter parameter, imk_axes *axes)
{
    for (int i = 0; i < d->axis_count; i++)
        draw_row(d, parameter, i, 1, &axes->sigma[i], &axes->value[i]);
}

static void draw_rows(const draw *d, enum parameter parameter, imk_rows *rows)
{
    for (int i = 0; i < d->axis_count; i++)
        draw_row(d, parameter, i, 3, rows->sigma[i], rows->value[i]);
}

static void draw_scalar(const draw *d, enum parameter parameter, imk_scalar *scalar)
{
    draw_row(d, parameter, 0, 1, &scalar->sigma, &scalar->value);
}

static void draw_bias(const draw *d, imk_bias *bias)
{
    draw_axes(d, BIAS_FIXED, &bias->fixed);
    bias->temperature.order = 0;
    memset(&bias->temperature_rate, 0, sizeof bias->temperature_rate);
    memset(&bias->hysteresis, 0, sizeof bias->hysteresis);
    /* A model without a warm-up states no time for it. */
    if (bias->warm_up_time.value > 0.0)
        draw_axes(d, BIAS_WARM_UP, &bias->warm_up_amplitude);
}

static void draw_triad(const draw *d, imk_triad *triad)
{
    draw_bias(d, &triad->bias);
    draw_axes(d, SCALE_FACTOR_FIXED, &triad->scale_factor.fixed);
    triad->scale_factor.temperature.order = 0;
    draw_axes(d, K2, &triad->nonlinearity.k2);
    draw_axes(d, KOQ, &triad->nonlinearity.koq);
    draw_axes(d, K3, &triad->nonlinearity.k3);
    draw_axes(d, ASYMMETRY, &triad->nonlinearity.asymmetry);
    draw_rows(d, CROSS_PRODUCTS, &triad->nonlinearity.cross_products);
    draw_rows(d, MISALIGNMENT, &triad->misalignment);
    draw_rows(d, CROSS_AXIS, &triad->cross_axis);
    draw_rows(d, G_SENSITIVITY, &triad->g_sensitivity);
    for (int i = 0; i < d->axis_count; i++)
        draw_row(d, G2_SENSITIVITY, i, 6, triad->g2_sensitivity.sigma[i],
                 triad->g2_sensitivity.value[i]);
    draw_rows(d, LEVER_ARM, &triad->lever_arm);
    draw_axes(d, RAMP, &triad->noise.ramp);
}

void imki_drift_residual(imk_model *model, imk_random random, uint32_t run)
{
    draw d = {random, run, 0, model->gyro.axis_count};
    draw_scalar(&d, RATE_ERROR, &model->timing.rate_error);
    draw_scalar(&d, SKEW, &model->timing.skew);
    draw_triad(&d, &model->gyro);
    d.first_axis = IMK_AXES_MAX;
    d.axis_count = model->accel.axis_count;
    draw_triad(&d, &model->accel);
}
