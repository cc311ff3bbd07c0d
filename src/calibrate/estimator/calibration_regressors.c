/* SPDX-License-Identifier: Apache-2.0 */
/* The equation of distort.h at single points, with its derivatives. A reading is
 *
 *     y = e.v + sum over the terms of  parameter x regressor(v, f, T)
 *
 * so that the regressors are the derivatives by the parameters, exact at any distance; only lever
 * arms are in v = f + alpha x r + w x (w x r) itself, which is linear in them but enters products.
 * By the input:
 *
 *     dy/dv = e (1 + s + n'(u)) + A + X + cross,   n(u) = K2 u^2 + Koq u|u| + …
 *     dv/dw = (w.r) I + w r^T - 2 r w^T,   dv/dalpha = -[r x],   dv/dr = [alpha x] + w w^T - w^2 I
 */
#include "axis_reading_internal.h"
#include "base/algebra/vector_internal.h"
#include "calibration_internal.h"

#include "model/model_internal.h"
#include "model/model_schema_internal.h"

#include <math.h>
#include <string.h>

/* T above the reference, T clipped to the valid range. */
static double warmth(const imk_temperature_polynomial *polynomial, double temperature)
{
    if (isnan(temperature))
        return 0.0;
    double t = temperature;
    if (polynomial->order > 0) {
        t = t < polynomial->minimum ? polynomial->minimum : t;
        t = t > polynomial->maximum ? polynomial->maximum : t;
    }
    return t - polynomial->reference;
}

double imki_polynomial_at(const imk_temperature_polynomial *polynomial, int axis,
                          double temperature)
{
    const double x = warmth(polynomial, temperature);
    double sum = 0.0;
    for (int k = polynomial->order - 1; k >= 0; k--)
        sum = (sum + polynomial->coefficient[k].value[axis]) * x;
    return sum;
}

double imki_power_of_warmth(const imk_temperature_polynomial *polynomial, double temperature,
                            int power)
{
    const double x = warmth(polynomial, temperature);
    double product = x;
    for (int k = 1; k < power; k++)
        product *= x;
    return product;
}

/* The force at the place of an accelerometer. */
static void force_at(const double r[3], const imki_input *input, double v[3])
{
    const double *w = input->rate;
    memcpy(v, input->force, 3 * sizeof *v);
    if (r[0] == 0.0 && r[1] == 0.0 && r[2] == 0.0)
        return;
    const double along = imki_dot3(w, r), square = imki_dot3(w, w);
    double turning[3];
    imki_cross3(input->angular_acceleration, r, turning);
    for (int j = 0; j < 3; j++)
        v[j] += turning[j] + w[j] * along - r[j] * square;
}

/* Derivatives by rate, force and angular acceleration, from that by the vector seen. */
static void by_input(const imk_triad *triad, int sensor, int i, const imki_input *input,
                     imki_axis_reading *y)
{
    const double *d = y->by_seen, *f = input->force, *w = input->rate;
    if (sensor == IMK_GYRO) {
        const double *g = triad->g_sensitivity.value[i], *q = triad->g2_sensitivity.value[i];
        memcpy(y->by_rate, d, sizeof y->by_rate);
        memset(y->by_angular_acceleration, 0, sizeof y->by_angular_acceleration);
        y->by_force[0] = g[0] + 2.0 * q[0] * f[0] + q[3] * f[1] + q[5] * f[2];
        y->by_force[1] = g[1] + 2.0 * q[1] * f[1] + q[3] * f[0] + q[4] * f[2];
        y->by_force[2] = g[2] + 2.0 * q[2] * f[2] + q[4] * f[1] + q[5] * f[0];
        return;
    }
    const double *r = triad->lever_arm.value[i];
    const double along = imki_dot3(w, r), d_w = imki_dot3(d, w), d_r = imki_dot3(d, r);
    memcpy(y->by_force, d, sizeof y->by_force);
    memset(y->by_rate, 0, sizeof y->by_rate);
    memset(y->by_angular_acceleration, 0, sizeof y->by_angular_acceleration);
    if (r[0] == 0.0 && r[1] == 0.0 && r[2] == 0.0)
        return;
    for (int j = 0; j < 3; j++)
        y->by_rate[j] = along * d[j] + d_w * r[j] - 2.0 * d_r * w[j];
    imki_cross3(r, d, y->by_angular_acceleration); /* d.(alpha x r) = alpha.(r x d) */
}

static void add_cross_products(const imk_triad *triad, int axis, imki_axis_reading *y)
{
    const double *k = triad->nonlinearity.cross_products.value[axis], *e = triad->direction[axis];
    const double u = y->along;
    if (k[0] == 0.0 && k[1] == 0.0 && k[2] == 0.0)
        return;
    double p[3], o[3];
    (void)imki_cross_axes(triad, axis, p, o);
    const double along_p = imki_dot3(p, y->seen), along_o = imki_dot3(o, y->seen);
    y->value += k[0] * u * along_p + k[1] * u * along_o + k[2] * along_p * along_o;
    for (int j = 0; j < 3; j++)
        y->by_seen[j] += (k[0] * along_p + k[1] * along_o) * e[j] +
                         (k[0] * u + k[2] * along_o) * p[j] + (k[1] * u + k[2] * along_p) * o[j];
}

/* n(u), and n'(u) to the slope. */
static void add_powers(const imk_triad *triad, int axis, imki_axis_reading *y, double *slope)
{
    const double u = y->along, side = (u > 0.0) - (u < 0.0);
    double of_square = 0.0, of_size = 0.0;
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const double c = power->weight * imki_term_values(power->term, triad)[axis];
        const int n = power->p + power->q;
        if (c == 0.0)
            continue;
        double x = power->q && n > 1 ? c * copysign(1.0, u) : c;
        for (int m = 2; m < n; m++)
            x *= u;
        *(n > 1 ? &of_square : &of_size) += x;
        *slope += imki_power_slope(power, c, u, side);
    }
    y->value += of_square * u * u;
    y->value += of_size * fabs(u);
}

imki_axis_reading imki_axis_read(const imk_model *model, int sensor, int axis,
                                 const imki_input *input)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    const double *e = triad->direction[axis];
    imki_axis_reading y;
    y.triad = triad;
    if (sensor == IMK_GYRO)
        memcpy(y.seen, input->rate, sizeof y.seen);
    else
        force_at(triad->lever_arm.value[axis], input, y.seen);
    const double u = imki_dot3(e, y.seen);
    const double scale =
        triad->scale_factor.fixed.value[axis] +
        imki_polynomial_at(&triad->scale_factor.temperature, axis, input->temperature);
    y.along = u;
    y.value = triad->bias.fixed.value[axis] +
              imki_polynomial_at(&triad->bias.temperature, axis, input->temperature) +
              triad->bias.temperature_rate.value[axis] * input->temperature_rate + u + scale * u;
    double slope = 1.0 + scale;
    add_powers(triad, axis, &y, &slope);
    for (int j = 0; j < 3; j++) {
        const double row = triad->misalignment.value[axis][j] + triad->cross_axis.value[axis][j];
        y.value += row * y.seen[j];
        y.by_seen[j] = slope * e[j] + row;
    }
    if (sensor == IMK_ACCEL) {
        add_cross_products(triad, axis, &y);
    } else {
        const double *f = input->force, *q = triad->g2_sensitivity.value[axis];
        y.value += imki_dot3(triad->g_sensitivity.value[axis], f) + q[0] * f[0] * f[0] +
                   q[1] * f[1] * f[1] + q[2] * f[2] * f[2] + q[3] * f[0] * f[1] +
                   q[4] * f[1] * f[2] + q[5] * f[2] * f[0];
    }
    by_input(triad, sensor, axis, input, &y);
    return y;
}

/* dy/dr along one component: d.([alpha x] + w w^T - w^2 I) column. */
static double by_lever_arm(const imki_axis_reading *y, const imki_input *input, int j)
{
    const double *d = y->by_seen, *w = input->rate;
    double column[3]; /* alpha x unit vector j */
    const double unit[3] = {j == 0, j == 1, j == 2};
    imki_cross3(input->angular_acceleration, unit, column);
    return imki_dot3(d, column) + imki_dot3(d, w) * w[j] - imki_dot3(w, w) * d[j];
}

static double by_cross_product(const imki_axis_reading *y, int axis, int k)
{
    double p[3], o[3];
    (void)imki_cross_axes(y->triad, axis, p, o);
    const double along_p = imki_dot3(p, y->seen), along_o = imki_dot3(o, y->seen);
    return k == 0 ? y->along * along_p : k == 1 ? y->along * along_o : along_p * along_o;
}

double imki_axis_regressor(const imki_axis_reading *y, const imki_input *input,
                           imk_model_parameter parameter)
{
    static const int first[6] = {0, 1, 2, 0, 1, 2}, second[6] = {0, 1, 2, 1, 2, 0};
    const double u = y->along, *f = input->force;
    const int k = parameter.element;
    switch (imki_terms[parameter.term].form) {
    case IMKI_FORM_ONE:
        return 1.0;
    case IMKI_FORM_INPUT:
        return u;
    case IMKI_FORM_SEEN:
        return y->seen[k];
    case IMKI_FORM_POWER:
        return imki_power_at(&imki_input_powers[imki_power_of(parameter.term)], u);
    case IMKI_FORM_CROSS:
        return by_cross_product(y, parameter.axis, k);
    case IMKI_FORM_FORCE:
        return f[k];
    case IMKI_FORM_PRODUCT:
        return f[first[k]] * f[second[k]];
    case IMKI_FORM_PLACE:
        return by_lever_arm(y, input, k);
    case IMKI_FORM_WARMTH:
        return imki_power_of_warmth(&y->triad->bias.temperature, input->temperature, k + 1);
    case IMKI_FORM_WARM_INPUT:
        return u *
               imki_power_of_warmth(&y->triad->scale_factor.temperature, input->temperature, k + 1);
    case IMKI_FORM_WARMING:
        return input->temperature_rate;
    default:
        return 0.0;
    }
}

void imki_calibration_regressors(const imk_model *model, size_t count,
                                 const imk_model_parameter *parameter, int sensor, int axis,
                                 const double rate[3], const double force[3],
                                 const double angular_acceleration[3], double temperature,
                                 double temperature_rate, double *row)
{
    imki_input input = {.temperature = temperature, .temperature_rate = temperature_rate};
    memcpy(input.rate, rate, sizeof input.rate);
    memcpy(input.force, force, sizeof input.force);
    if (angular_acceleration)
        memcpy(input.angular_acceleration, angular_acceleration, sizeof input.angular_acceleration);
    const imki_axis_reading reading = imki_axis_read(model, sensor, axis, &input);
    for (size_t p = 0; p < count; p++)
        row[p] = parameter[p].sensor == sensor && parameter[p].axis == axis
                     ? imki_axis_regressor(&reading, &input, parameter[p])
                     : 0.0;
}
