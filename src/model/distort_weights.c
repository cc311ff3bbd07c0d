/* SPDX-License-Identifier: Apache-2.0 */
/* A model compiled into weights of the twelve features of distort.h.
 *
 * What an accelerometer at r is exposed to, along a row a (its direction, say), is
 *
 *     a.(f + alpha x r + w x (w x r)) = a.f + (r x a).alpha + sum over i <= j of W_ij w_i w_j
 *     w x (w x r) = w (w.r) - r (w.w):   W_ii = a_i r_i - a.r,   W_ij = a_i r_j + a_j r_i  (i < j)
 */
#include "base/algebra/vector_internal.h"
#include "distort_internal.h"
#include "model_internal.h"

#include <string.h>

enum { XX = 3, YY, ZZ, XY, YZ, ZX, THIRD };

static void place_row(const double a[3], const double r[3], double weight[IMK_FEATURES])
{
    for (int j = 0; j < 3; j++)
        weight[j] = a[j];
    weight[XX] = -(a[1] * r[1] + a[2] * r[2]);
    weight[YY] = -(a[0] * r[0] + a[2] * r[2]);
    weight[ZZ] = -(a[0] * r[0] + a[1] * r[1]);
    weight[XY] = a[0] * r[1] + a[1] * r[0];
    weight[YZ] = a[1] * r[2] + a[2] * r[1];
    weight[ZX] = a[2] * r[0] + a[0] * r[2];
    imki_cross3(r, a, weight + THIRD);
}

bool imki_cross_axes(const imk_triad *triad, int axis, double p[3], double o[3])
{
    const double *e = triad->direction[axis];
    memcpy(p, triad->nonlinearity.pendulous_axis[axis], 3 * sizeof *p);
    for (int k = 0; k < 3 && p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0; k++)
        if (e[(k + 1) % 3] == 0.0 && e[(k + 2) % 3] == 0.0)
            p[(k + 2) % 3] = 1.0;
    imki_cross3(p, e, o);
    return p[0] != 0.0 || p[1] != 0.0 || p[2] != 0.0;
}

static bool has_cross_products(const imk_triad *triad, int axis)
{
    const double *k = triad->nonlinearity.cross_products.value[axis];
    return k[0] != 0.0 || k[1] != 0.0 || k[2] != 0.0;
}

static imk_status check_cross_products(const imk_triad *triad, imk_error *error)
{
    double p[3], o[3];
    for (int i = 0; triad->present && i < triad->axis_count; i++)
        if (has_cross_products(triad, i) && !imki_cross_axes(triad, i, p, o)) {
            imk_error_set(
                error, IMK_ERROR_CONFLICT, "accel.cross_products",
                "cross_products of a sensor that is not along a body axis need a pendulous axis",
                "add pendulous_axis, a row x y z for each axis");
            if (error)
                error->index = i;
            return IMK_ERROR_CONFLICT;
        }
    return IMK_OK;
}

static void compile_cross_products(imk_axis_response *axis, const imk_triad *triad, int i)
{
    const double *k = triad->nonlinearity.cross_products.value[i];
    double p[3], o[3];
    axis->kip = k[0];
    axis->kio = k[1];
    axis->kpo = k[2];
    axis->has_cross_products = has_cross_products(triad, i);
    if (!axis->has_cross_products)
        return;
    (void)imki_cross_axes(triad, i, p, o);
    place_row(p, triad->lever_arm.value[i], axis->pendulous);
    place_row(o, triad->lever_arm.value[i], axis->output);
}

static void compile_weights(imk_axis_response *axis, const imk_triad *triad, int sensor, int i)
{
    double other[3] = {0.0};
    imki_add_rows(triad, i, IMKI_FORM_SEEN, other);
    if (sensor == IMK_ACCEL) {
        place_row(triad->direction[i], triad->lever_arm.value[i], axis->input);
        place_row(other, triad->lever_arm.value[i], axis->other);
        memcpy(axis->place, triad->lever_arm.value[i], sizeof axis->place);
        axis->has_place = axis->place[0] != 0.0 || axis->place[1] != 0.0 || axis->place[2] != 0.0;
        return;
    }
    memcpy(axis->input, triad->direction[i], sizeof triad->direction[i]);
    memcpy(axis->other, other, sizeof other);
    imki_add_rows(triad, i, IMKI_FORM_PRODUCT, axis->other + XX);
    imki_add_rows(triad, i, IMKI_FORM_FORCE, axis->other + THIRD);
}

static int compile_polynomial(const imk_temperature_polynomial *from, int i, double *coefficient,
                              double *reference, double *minimum, double *maximum)
{
    int order = 0;
    for (int k = 0; k < from->order; k++) {
        coefficient[k] = from->coefficient[k].value[i];
        if (coefficient[k] != 0.0)
            order = k + 1;
    }
    *reference = from->reference;
    *minimum = from->minimum;
    *maximum = from->maximum;
    return order;
}

static uint16_t not_zero(const double weight[IMK_FEATURES])
{
    unsigned used = 0;
    for (int k = 0; k < IMK_FEATURES; k++)
        used |= weight[k] != 0.0 ? 1u << k : 0u;
    return (uint16_t)used;
}

static void compile_powers(imk_axis_response *axis, const imk_triad *triad, int i)
{
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const int place = (int)imki_power_place(power);
        const double number = power->weight * imki_term_values(power->term, triad)[i];
        axis->power[power->q][place] = number;
        if (number != 0.0 && axis->powers <= place)
            axis->powers = place + 1;
    }
    axis->has_nonlinearity = axis->powers > 0;
}

static void compile_numbers(imk_axis_response *axis, const imk_triad *triad, int i)
{
    /* Adding +0 turns -0 into +0: no sum that begins so is ever -0. */
    axis->bias = triad->bias.fixed.value[i] + 0.0;
    axis->scale = triad->scale_factor.fixed.value[i];
    compile_powers(axis, triad, i);
    axis->bias_order =
        compile_polynomial(&triad->bias.temperature, i, axis->bias_temperature,
                           &axis->bias_reference, &axis->bias_minimum, &axis->bias_maximum);
    axis->scale_order =
        compile_polynomial(&triad->scale_factor.temperature, i, axis->scale_temperature,
                           &axis->scale_reference, &axis->scale_minimum, &axis->scale_maximum);
    axis->temperature_rate = triad->bias.temperature_rate.value[i];
    axis->warm_up = triad->bias.warm_up_amplitude.value[i];
    axis->half_hysteresis = 0.5 * triad->bias.hysteresis.value[i];
}

static void compile_triad(imk_distortion *distortion, const imk_triad *triad, int sensor,
                          const imk_run_constants *constants)
{
    distortion->axis_count[sensor] = triad->present ? triad->axis_count : 0;
    for (int i = 0; i < distortion->axis_count[sensor]; i++) {
        imk_axis_response *axis = &distortion->axis[sensor][i];
        compile_numbers(axis, triad, i);
        compile_weights(axis, triad, sensor, i);
        if (sensor == IMK_ACCEL)
            compile_cross_products(axis, triad, i);
        if (constants) {
            axis->bias += constants->bias[sensor][i];
            axis->scale += constants->scale_factor[sensor][i];
        }
        axis->used[IMKI_ROW_INPUT] = not_zero(axis->input);
        axis->used[IMKI_ROW_OTHER] = not_zero(axis->other);
        axis->used[IMKI_ROW_PENDULOUS] = not_zero(axis->pendulous);
        axis->used[IMKI_ROW_OUTPUT] = not_zero(axis->output);
    }
}

static void start(imk_distortion *distortion, imk_kernel kernel)
{
    memset(distortion, 0, sizeof *distortion);
    distortion->cookie = IMKI_DISTORTION_COOKIE;
    distortion->kernel = kernel;
}

imk_status imk_distortion_start(imk_distortion *distortion, const imk_model *model,
                                const imk_run_constants *constants, imk_kernel kernel,
                                imk_error *error)
{
    const imk_status status = check_cross_products(&model->accel, error);
    if (status != IMK_OK)
        return status;
    start(distortion, kernel);
    compile_triad(distortion, &model->gyro, IMK_GYRO, constants);
    compile_triad(distortion, &model->accel, IMK_ACCEL, constants);
    return IMK_OK;
}

void imki_distortion_of_mag(imk_distortion *distortion, const imk_model *model,
                            const imk_run_constants *constants, imk_kernel kernel)
{
    start(distortion, kernel);
    compile_triad(distortion, &model->mag, IMK_ACCEL, constants);
}
