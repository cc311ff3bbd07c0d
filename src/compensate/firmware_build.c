/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of a plan. With A the rows of which J+ is the inverse (correct.h takes them from
 * the middle of the slopes) and n(x) = distort(x) - b - A x, the iteration of correct.h is
 *
 *     x + J+ (y - distort(x)) = J+ (y - b) + (I - J+ A) x - J+ n(x)
 *
 * of which the first part is computed once, and the second is rounding: where it is, it is left out
 * and bounded. The temperature is scaled to t = (T - middle)/half in -1 … 1, in which polynomials
 * have coefficients as large as their effects. */
#include "firmware_plan_internal.h"

#include <math.h>
#include <string.h>

enum { UNKNOWNS = 2 * IMK_AXES_MAX, FIRST_OTHER = 3, FIRST_FORCE = 9 };

static const double kelvin = 273.15;

/* I - J+ A below this is rounding, of the limit. */
static const double negligible = 1e-11;

/* A polynomial in t, with the operation that is t, or -1 when it is a constant. */
typedef struct polynomial {
    int order, scaled;
    double coefficient[IMK_TEMPERATURE_ORDER_MAX + 1];
    double error; /* of the coefficients, summed */
} polynomial;

typedef struct operations {
    imki_builder *builder;
    imk_firmware *plan;
    int input[2][IMK_AXES_MAX];      /* readings less bias */
    int first[2][IMK_AXES_MAX];      /* J+ (y - b) */
    int motion[2][IMK_AXES_MAX];     /* the components so far */
    int within[2][IMK_AXES_MAX];     /* the same within the limits, where these matter */
    double rest[UNKNOWNS][UNKNOWNS]; /* I - J+ A, where it is not left out */
    bool has_rest[UNKNOWNS];
} operations;

/* ---- temperature ----------------------------------------------------------------------------- */

/* p(T) = sum of a_k (T - reference)^k, k from 1, about the middle of the range. */
static polynomial about_middle(int order, const double *a, double reference, double minimum,
                               double maximum)
{
    const double half = 0.5 * (maximum - minimum), shift = 0.5 * (maximum + minimum) - reference;
    polynomial p = {.order = order, .scaled = -1};
    double size = 0, reach = 0;
    double *c = p.coefficient;
    /* Horner's rule: p <- (p + a_k)(shift + half t). */
    for (int k = order - 1; k >= 0; k--) {
        c[0] += a[k];
        for (int j = order; j > 0; j--)
            c[j] = c[j] * shift + c[j - 1] * half;
        c[0] *= shift;
        reach = fabs(shift) + half;
        size = (size + fabs(a[k])) * reach;
    }
    p.error = 16 * 0x1p-53 * size;
    while (p.order > 0 && c[p.order] == 0)
        p.order--;
    return p;
}

static bool any_of(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (values[i] != 0)
            return true;
    return false;
}

double imki_firmware_bias_reach(const imk_axis_response *axis)
{
    double reach = 0;
    if (!any_of(axis->bias_temperature, axis->bias_order))
        return 0;
    const polynomial p = about_middle(axis->bias_order, axis->bias_temperature,
                                      axis->bias_reference, axis->bias_minimum, axis->bias_maximum);
    for (int k = 0; k <= IMK_TEMPERATURE_ORDER_MAX; k++)
        reach += fabs(p.coefficient[k]);
    return reach;
}

/* The operation t of a valid range. */
static int scaled_temperature(const operations *o, double minimum, double maximum)
{
    const double middle = 0.5 * (maximum + minimum) - kelvin, half = 0.5 * (maximum - minimum);
    imki_sum sum = {.constant = -middle / half};
    const int clipped = imki_firmware_clip(o->builder, imki_firmware_temperature(o->builder),
                                           minimum - kelvin, maximum - kelvin);
    imki_firmware_name(o->builder, clipped, IMK_FIRMWARE_CELSIUS, 0, 0, 0);
    imki_sum_add(&sum, clipped, 1 / half);
    const int t = imki_firmware_sum(o->builder, &sum, 1e-13 / half, -1);
    imki_firmware_name(o->builder, t, IMK_FIRMWARE_SCALED, 0, 0, 0);
    return t;
}

/* The part with t of factor p(t) + constant by Horner's rule; -1 when it is a constant, which
 * *constant then is all of. On return the value is the operation, with the constant in it. */
static int horner(const operations *o, const polynomial *p, double factor, double constant,
                  int sensor, int axis)
{
    const double *c = p->coefficient;
    int value;
    if (p->order == 1) {
        imki_sum sum = {.constant = factor * c[0] + constant};
        imki_sum_add(&sum, p->scaled, factor * c[1]);
        return imki_firmware_sum(o->builder, &sum, fabs(factor) * p->error, -1);
    }
    imki_sum top = {.constant = factor * c[p->order - 1]};
    imki_sum_add(&top, p->scaled, factor * c[p->order]);
    value = imki_firmware_sum(o->builder, &top, fabs(factor) * p->error, -1);
    imki_firmware_name(o->builder, value, IMK_FIRMWARE_STEP, sensor, axis, p->order - 1);
    for (int k = p->order - 2; k >= 0; k--) {
        value = imki_firmware_product(o->builder, value, p->scaled,
                                      factor * c[k] + (k == 0 ? constant : 0));
        imki_firmware_name(o->builder, value, IMK_FIRMWARE_STEP, sensor, axis, k);
    }
    return value;
}

static polynomial bias_polynomial(const operations *o, const imk_axis_response *axis)
{
    polynomial p = {.scaled = -1};
    if (!any_of(axis->bias_temperature, axis->bias_order))
        return p;
    p = about_middle(axis->bias_order, axis->bias_temperature, axis->bias_reference,
                     axis->bias_minimum, axis->bias_maximum);
    p.scaled = scaled_temperature(o, axis->bias_minimum, axis->bias_maximum);
    return p;
}

static polynomial scale_polynomial(const operations *o, const imk_axis_response *axis)
{
    polynomial p = {.scaled = -1};
    if (!any_of(axis->scale_temperature, axis->scale_order))
        return p;
    p = about_middle(axis->scale_order, axis->scale_temperature, axis->scale_reference,
                     axis->scale_minimum, axis->scale_maximum);
    p.scaled = scaled_temperature(o, axis->scale_minimum, axis->scale_maximum);
    return p;
}

/* ---- readings -------------------------------------------------------------------------------- */

/* d = (reading - origin) - (zero offset - origin + bias/per_unit). */
static void take_readings(operations *o)
{
    const imk_firmware *f = o->plan;
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++) {
            const imk_axis_response *axis = &f->correction.distortion.axis[sensor][i];
            const imk_firmware_channel *channel = &f->channel[sensor][i];
            const double unit = 1 / f->correction.per_unit[sensor][i];
            const double zero = f->correction.zero_offset[sensor][i] - channel->origin;
            const polynomial p = bias_polynomial(o, axis);
            const double constant = zero + axis->bias * unit;
            imki_sum sum = {.constant = 0};
            imki_sum_add(
                &sum, imki_firmware_reading(o->builder, sensor, i, channel->lower, channel->upper),
                1);
            if (p.order > 0) {
                const int bias = horner(o, &p, unit, constant, sensor, i);
                imki_firmware_name(o->builder, bias, IMK_FIRMWARE_BIAS, sensor, i, 0);
                imki_sum_add(&sum, bias, -1);
            } else {
                sum.constant = -(constant + unit * p.coefficient[0]);
            }
            o->input[sensor][i] = imki_firmware_sum(o->builder, &sum, unit * p.error, -1);
            imki_firmware_name(o->builder, o->input[sensor][i], IMK_FIRMWARE_INPUT, sensor, i, 0);
        }
}

/* Weight of channel i of sensor `of` in unknown j of `sensor`, in physical units. */
static double weight(const imk_firmware *f, int sensor, int j, int of, int i)
{
    const imk_correction *c = &f->correction;
    if (c->solves[sensor])
        return c->inverse[3 * sensor + j][of * IMK_AXES_MAX + i];
    return sensor == of && i == j ? c->axis_inverse[sensor][j] : 0;
}

/* J+ (y - b); `reserve` as in imki_firmware_build(). */
static void first_step(operations *o, int reserve)
{
    imk_firmware *f = o->plan;
    for (int sensor = 0; sensor < 2; sensor++) {
        imki_sum sums[IMK_AXES_MAX];
        double largest = 0;
        for (int j = 0; j < f->output_count[sensor]; j++) {
            double size = 0;
            sums[j] = (imki_sum){.constant = 0};
            for (int of = 0; of < 2; of++)
                for (int i = 0; i < f->axis_count[of]; i++) {
                    const double w = weight(f, sensor, j, of, i) * f->correction.per_unit[of][i];
                    if (o->input[of][i] < 0)
                        return;
                    const imk_firmware_operation *d = &f->operation[o->input[of][i]];
                    imki_sum_add(&sums[j], o->input[of][i], w);
                    size += fabs(w) * (imki_firmware_largest(d) + d->error);
                }
            largest = fmax(largest, size);
        }
        f->output_bits[sensor] = imki_firmware_bits(largest) - reserve;
        if (f->output_bits[sensor] < 0)
            o->builder->too_large = o->builder->too_large || f->arithmetic == IMK_FIRMWARE_FIXED;
        const int bits = f->arithmetic == IMK_FIRMWARE_FIXED ? f->output_bits[sensor] : -1;
        for (int j = 0; j < f->output_count[sensor]; j++) {
            o->first[sensor][j] = imki_firmware_sum(o->builder, &sums[j], 0, bits);
            o->motion[sensor][j] = o->first[sensor][j];
            imki_firmware_name(o->builder, o->first[sensor][j], IMK_FIRMWARE_MOTION, sensor, j, 1);
        }
    }
}

/* ---- what is not linear ---------------------------------------------------------------------- */

/* The middle of the relative slope of an axis, of which J+ was made: correct_bound.c. */
static double middle_slope(const imk_firmware *f, int sensor, int i)
{
    const imk_correction *c = &f->correction;
    const imk_triad *triad = imk_model_triad(&f->model, sensor);
    double within = 0;
    for (int j = 0; j < 3; j++)
        within += fabs(triad->direction[i][j]) *
                  (c->solves[sensor] ? c->limit[sensor][j] : c->limit[sensor][i]);
    return imki_slope(&c->distortion.axis[sensor][i], within).center;
}

/* Rows of A over all unknowns. */
static void row_of(const imk_firmware *f, int sensor, int i, double middle, double row[UNKNOWNS])
{
    const imk_axis_response *axis = &f->correction.distortion.axis[sensor][i];
    const imk_correction *c = &f->correction;
    memset(row, 0, UNKNOWNS * sizeof *row);
    for (int j = 0; j < 3; j++) {
        const double own = (1 + middle) * axis->input[j] + axis->other[j];
        if (c->solves[sensor])
            row[sensor * IMK_AXES_MAX + j] = own;
        else
            row[sensor * IMK_AXES_MAX + i] += own * c->along[sensor][i][j];
        if (sensor == IMK_GYRO && c->solves[IMK_GYRO] && c->solves[IMK_ACCEL])
            row[IMK_AXES_MAX + j] = axis->other[FIRST_FORCE + j];
    }
}

/* I - J+ A. */
static void find_rest(operations *o, double left[2])
{
    const imk_firmware *f = o->plan;
    double row[2][IMK_AXES_MAX][UNKNOWNS];
    left[0] = left[1] = 0;
    for (int of = 0; of < 2; of++)
        for (int i = 0; i < f->axis_count[of]; i++)
            row_of(f, of, i, middle_slope(f, of, i), row[of][i]);
    for (int a = 0; a < UNKNOWNS; a++) {
        const int sensor = a / IMK_AXES_MAX, j = a % IMK_AXES_MAX;
        double sum = 0;
        for (int b = 0; j < f->output_count[sensor] && b < UNKNOWNS; b++) {
            if (b % IMK_AXES_MAX >= f->output_count[b / IMK_AXES_MAX])
                continue;
            double rest = a == b ? 1 : 0;
            for (int of = 0; of < 2; of++)
                for (int i = 0; i < f->axis_count[of]; i++)
                    rest -= weight(f, sensor, j, of, i) * row[of][i][b];
            const double effect =
                fabs(rest) * f->correction.limit[b / IMK_AXES_MAX][b % IMK_AXES_MAX];
            if (effect > negligible * f->correction.limit[sensor][j]) {
                o->rest[a][b] = rest;
                o->has_rest[a] = true;
            } else {
                sum += effect;
            }
        }
        left[sensor] = fmax(left[sensor], sum);
    }
}

/* Sum of three weights times components. */
static int along(const operations *o, int sensor, int i, const double weights[3],
                 imk_firmware_role role)
{
    imki_sum sum = {.constant = 0};
    if (!o->plan->correction.solves[sensor])
        return o->within[sensor][i];
    for (int j = 0; j < 3; j++)
        imki_sum_add(&sum, o->within[sensor][j], weights[j]);
    const int value = imki_firmware_sum(o->builder, &sum, 0, -1);
    imki_firmware_name(o->builder, value, role, sensor, i, 0);
    return value;
}

/* u^(p - 1) |u|^q, of which the size is at hand. */
static int power_less_one(const operations *o, const imki_power *power, int u, int size)
{
    int value = power->q ? size : u;
    for (int k = 2 - power->q; k < power->p; k++)
        value = imki_firmware_product(o->builder, value, u, 0);
    return value;
}

/* (s(t) - middle) u + n(u). */
static void add_slope(operations *o, int sensor, int i, int u, imki_sum *rest)
{
    const imk_axis_response *axis = &o->plan->correction.distortion.axis[sensor][i];
    const polynomial p = scale_polynomial(o, axis);
    const double constant = axis->scale - middle_slope(o->plan, sensor, i);
    imki_sum slope = {.constant = 0};
    int size = -1;
    if (any_of(axis->power[1], axis->powers))
        size = imki_firmware_size(o->builder, u);
    if (p.order > 0) {
        const int scale = horner(o, &p, 1, constant, sensor, i);
        imki_firmware_name(o->builder, scale, IMK_FIRMWARE_SLOPE, sensor, i, 0);
        imki_sum_add(&slope, scale, 1);
    } else {
        slope.constant = constant + p.coefficient[0];
    }
    for (size_t k = 0; k < imki_input_power_count; k++) {
        const imki_power *power = &imki_input_powers[k];
        const double number = imki_axis_power(axis, power);
        if (number != 0 && power->p + power->q > 1)
            imki_sum_add(&slope, power_less_one(o, power, u, size), number);
    }
    if (slope.count > 0) {
        const int factor = imki_firmware_sum(o->builder, &slope, p.error, -1);
        imki_firmware_name(o->builder, factor, IMK_FIRMWARE_STEP, sensor, i, 0);
        imki_sum_add(rest, imki_firmware_product(o->builder, factor, u, 0), 1);
    } else {
        imki_sum_add(rest, u, slope.constant);
    }
    imki_sum_add(rest, size, axis->power[1][0]);
}

static void add_cross_products(operations *o, int sensor, int i, int u, imki_sum *rest)
{
    const imk_axis_response *axis = &o->plan->correction.distortion.axis[sensor][i];
    /* A single axis is read as if the motion were along it: nothing is across. */
    if (!axis->has_cross_products || !o->plan->correction.solves[sensor])
        return;
    const int p = along(o, sensor, i, axis->pendulous, IMK_FIRMWARE_STEP);
    const int across = along(o, sensor, i, axis->output, IMK_FIRMWARE_STEP);
    imki_sum factor = {.constant = 0};
    imki_sum_add(&factor, p, axis->kip);
    imki_sum_add(&factor, across, axis->kio);
    if (factor.count > 0) {
        const int both = imki_firmware_sum(o->builder, &factor, 0, -1);
        imki_firmware_name(o->builder, both, IMK_FIRMWARE_STEP, sensor, i, 0);
        imki_sum_add(rest, imki_firmware_product(o->builder, both, u, 0), 1);
    }
    if (axis->kpo != 0)
        imki_sum_add(rest, imki_firmware_product(o->builder, p, across, 0), axis->kpo);
}

/* Products of forces, and forces on gyros that are not solved. */
static void add_force(operations *o, int i, imki_sum *rest)
{
    const imk_axis_response *axis = &o->plan->correction.distortion.axis[IMK_GYRO][i];
    const int *f = o->within[IMK_ACCEL];
    if (!o->plan->correction.solves[IMK_ACCEL])
        return;
    for (int k = 0; k < 6; k++)
        if (axis->other[FIRST_OTHER + k] != 0)
            imki_sum_add(
                rest, imki_firmware_product(o->builder, f[k % 3], k < 3 ? f[k] : f[(k + 1) % 3], 0),
                axis->other[FIRST_OTHER + k]);
    for (int k = 0; k < 3 && !o->plan->correction.solves[IMK_GYRO]; k++)
        imki_sum_add(rest, f[k], axis->other[FIRST_FORCE + k]);
}

/* n(x) of one axis; -1 when there is none (or no room, which is noted). */
static int rest_of(operations *o, int sensor, int i, int step)
{
    const imk_axis_response *axis = &o->plan->correction.distortion.axis[sensor][i];
    imki_sum rest = {.constant = 0};
    const double constant = axis->scale - middle_slope(o->plan, sensor, i);
    if (axis->has_nonlinearity || any_of(axis->scale_temperature, axis->scale_order) ||
        fabs(constant) > 1e-15 || axis->has_cross_products) {
        const int u = along(o, sensor, i, axis->input, IMK_FIRMWARE_ALONG);
        add_slope(o, sensor, i, u, &rest);
        add_cross_products(o, sensor, i, u, &rest);
    }
    if (sensor == IMK_GYRO)
        add_force(o, i, &rest);
    if (rest.count == 0)
        return -1;
    const int value = imki_firmware_sum(o->builder, &rest, 0, -1);
    imki_firmware_name(o->builder, value, IMK_FIRMWARE_REST, sensor, i, step);
    return value;
}

/* One step of all components at once. @return true when any changed */
static bool next_step(operations *o, int step)
{
    const imk_firmware *f = o->plan;
    int rest[2][IMK_AXES_MAX], next[2][IMK_AXES_MAX];
    bool changed = false;
    memcpy(next, o->motion, sizeof next);
    for (int sensor = 0; sensor < 2; sensor++)
        for (int j = 0; j < f->output_count[sensor]; j++) {
            int *within = &o->within[sensor][j];
            *within = o->motion[sensor][j];
            if (!f->correction.stays_within[sensor])
                continue;
            const double limit = f->correction.limit[sensor][j];
            *within = imki_firmware_clip(o->builder, *within, -limit, limit);
            imki_firmware_name(o->builder, *within, IMK_FIRMWARE_WITHIN, sensor, j, step);
        }
    for (int sensor = 0; sensor < 2; sensor++)
        for (int i = 0; i < f->axis_count[sensor]; i++)
            rest[sensor][i] = rest_of(o, sensor, i, step);
    for (int a = 0; a < UNKNOWNS; a++) {
        const int sensor = a / IMK_AXES_MAX, j = a % IMK_AXES_MAX;
        imki_sum sum = {.constant = 0};
        if (j >= f->output_count[sensor])
            continue;
        imki_sum_add(&sum, o->first[sensor][j], 1);
        for (int of = 0; of < 2; of++)
            for (int i = 0; i < f->axis_count[of]; i++)
                if (rest[of][i] >= 0)
                    imki_sum_add(&sum, rest[of][i], -weight(f, sensor, j, of, i));
        for (int b = 0; o->has_rest[a] && b < UNKNOWNS; b++)
            if (o->rest[a][b] != 0)
                imki_sum_add(&sum, o->within[b / IMK_AXES_MAX][b % IMK_AXES_MAX], o->rest[a][b]);
        next[sensor][j] = o->first[sensor][j];
        if (sum.count > 1) {
            const int bits = f->arithmetic == IMK_FIRMWARE_FIXED ? f->output_bits[sensor] : -1;
            next[sensor][j] = imki_firmware_sum(o->builder, &sum, 0, bits);
            imki_firmware_name(o->builder, next[sensor][j], IMK_FIRMWARE_MOTION, sensor, j, step);
        }
        changed = changed || next[sensor][j] != o->motion[sensor][j];
    }
    memcpy(o->motion, next, sizeof next);
    return changed;
}

bool imki_firmware_build(imki_builder *builder, int reserve, double left[2])
{
    imk_firmware *f = builder->plan;
    operations o;
    memset(&o, 0, sizeof o);
    o.builder = builder;
    o.plan = f;
    take_readings(&o);
    if (!builder->full && !builder->too_large)
        first_step(&o, reserve);
    if (builder->full || builder->too_large)
        return false;
    find_rest(&o, left);
    f->iterations = 1;
    for (int step = 2; step <= f->correction.iterations; step++) {
        const bool changed = next_step(&o, step);
        if (builder->full || builder->too_large)
            return false;
        if (!changed)
            break;
        f->iterations = step;
    }
    memcpy(f->output, o.motion, sizeof o.motion);
    imki_firmware_prune(f);
    return true;
}
