/* SPDX-License-Identifier: Apache-2.0 */
/* The loops of distort_internal.h, to be compiled for each instruction set with vectors of LANES
 * lanes, the width of its registers. Each sample sees the same operations in the same order
 * whatever these are:
 *
 *     b = bias + rate dT/dt + warm_up e + width/2 p + d(c1 + d(c2 + …)),   d = clip(T) - reference
 *     n = |u|(asymmetry/2 + Koq u + …) + u^2 (K2 + K3 u + …)
 *     y = ((b + other) + s u + n + c) + u
 *
 * The largest term comes last, so that the small ones lose nothing among themselves. */
#ifndef IMUKI_DISTORT_KERNEL_H
#define IMUKI_DISTORT_KERNEL_H

#include "distort_internal.h"

#define KERNEL static inline __attribute__((always_inline))

/* Four vectors at a time hide the latency of a sum, and fit the registers. */
#ifndef VECTORS
#define VECTORS 4
#endif
enum { STEP = VECTORS * LANES };

/* Arrays of double of any alignment. */
typedef double lanes __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
typedef long long bits __attribute__((vector_size(8 * LANES), aligned(8), may_alias));

#define VECTOR(array, v) (((const lanes *)(array))[v])
#define SIZE(x) ((lanes)((bits)(x) & (0x7FFFFFFFFFFFFFFF - (bits){0})))

/* All six products of three components: x (a x + d y + f z) + y (b y + e z) + z c z. */
KERNEL void add_all_products(lanes sum[VECTORS], const double *weight, const imki_exposure *x,
                             size_t start)
{
    const double *q = weight + 3, *f[3];
    for (int j = 0; j < 3; j++)
        f[j] = x->factor[3 + j][0] + start;
    for (int v = 0; v < VECTORS; v++) {
        const lanes f0 = VECTOR(f[0], v), f1 = VECTOR(f[1], v), f2 = VECTOR(f[2], v);
        sum[v] += (f0 * (q[0] * f0 + q[3] * f1 + q[5] * f2) + f1 * (q[1] * f1 + q[4] * f2)) +
                  f2 * (q[2] * f2);
    }
}

KERNEL void add_features(lanes sum[VECTORS], uint32_t used, const double *weight,
                         const imki_exposure *x, size_t start)
{
    for (uint32_t rest = used & ~(uint32_t)IMKI_PRODUCT_FEATURES; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        const double *a = x->factor[k][0] + start;
        for (int v = 0; v < VECTORS; v++)
            sum[v] += weight[k] * VECTOR(a, v);
    }
    if ((used & IMKI_PRODUCT_FEATURES) == IMKI_PRODUCT_FEATURES) {
        add_all_products(sum, weight, x, start);
        return;
    }
    for (uint32_t rest = used & IMKI_PRODUCT_FEATURES; rest; rest &= rest - 1) {
        const int k = __builtin_ctz(rest);
        const double *a = x->factor[k][0] + start, *b = x->factor[k][1] + start;
        for (int v = 0; v < VECTORS; v++)
            sum[v] += weight[k] * (VECTOR(a, v) * VECTOR(b, v));
    }
}

KERNEL const double *component(const imki_component *c, size_t start)
{
    return c->at + (start & c->moving);
}

/* f + alpha x r + w x (w x r) */
KERNEL void force_at(lanes place[3][VECTORS], const double r[3], const imki_exposure *x,
                     size_t start)
{
    const double *f[3], *w[3], *alpha[3], r0 = r[0], r1 = r[1], r2 = r[2];
    for (int j = 0; j < 3; j++) {
        f[j] = component(&x->force[j], start);
        w[j] = component(&x->rate[j], start);
        alpha[j] = component(&x->acceleration[j], start);
    }
    for (int v = 0; v < VECTORS; v++) {
        const lanes w0 = VECTOR(w[0], v), w1 = VECTOR(w[1], v), w2 = VECTOR(w[2], v);
        const lanes a0 = VECTOR(alpha[0], v), a1 = VECTOR(alpha[1], v), a2 = VECTOR(alpha[2], v);
        const lanes xx = w0 * w0, yy = w1 * w1, zz = w2 * w2;
        const lanes xy = w0 * w1, yz = w1 * w2, zx = w2 * w0;
        place[0][v] = VECTOR(f[0], v) + ((xy - a2) * r1 + (zx + a1) * r2 - (yy + zz) * r0);
        place[1][v] = VECTOR(f[1], v) + ((xy + a2) * r0 + (yz - a0) * r2 - (xx + zz) * r1);
        place[2][v] = VECTOR(f[2], v) + ((zx - a1) * r0 + (yz + a0) * r1 - (xx + yy) * r2);
    }
}

/* A row times the force at the place of an accelerometer, or the features as they are. */
KERNEL void add_row(lanes sum[VECTORS], uint32_t used, const double *weight, const imki_exposure *x,
                    size_t start, lanes (*place)[VECTORS])
{
    if (!place) {
        add_features(sum, used & x->available, weight, x, start);
        return;
    }
    for (int k = 0; k < 3; k++)
        if (used >> k & 1u)
            for (int v = 0; v < VECTORS; v++)
                sum[v] += weight[k] * place[k][v];
}

KERNEL void add_product(lanes sum[VECTORS], double weight, const double *factor)
{
    for (int v = 0; v < VECTORS; v++)
        sum[v] += weight * VECTOR(factor, v);
}

/* A temperature that is not a number stays what it is. */
KERNEL void clip(lanes *x, double minimum, double maximum)
{
    const lanes low = minimum - (lanes){0.0}, high = maximum - (lanes){0.0};
    bits beyond = *x < low;
    *x = (lanes)((beyond & (bits)low) | (~beyond & (bits)*x));
    beyond = *x > high;
    *x = (lanes)((beyond & (bits)high) | (~beyond & (bits)*x));
}

/* d = clip(T) - reference */
KERNEL void difference(lanes d[VECTORS], double reference, double minimum, double maximum,
                       const double *temperature)
{
    for (int v = 0; v < VECTORS; v++) {
        d[v] = VECTOR(temperature, v);
        clip(&d[v], minimum, maximum);
        d[v] -= reference;
    }
}

KERNEL void add_polynomial(lanes sum[VECTORS], int order, const double *coefficient,
                           const lanes d[VECTORS])
{
    lanes value[VECTORS];
    for (int v = 0; v < VECTORS; v++)
        value[v] = coefficient[order - 1] * d[v];
    for (int k = order - 2; k >= 0; k--)
        for (int v = 0; v < VECTORS; v++)
            value[v] = (coefficient[k] + value[v]) * d[v];
    for (int v = 0; v < VECTORS; v++)
        sum[v] += value[v];
}

/* Both polynomials; a sensor whose two have one range and reference needs one difference. */
KERNEL void add_temperature(lanes bias[VECTORS], lanes scale[VECTORS],
                            const imk_axis_response *axis, const double *temperature)
{
    lanes d[VECTORS];
    const bool same = axis->bias_order > 0 && axis->bias_reference == axis->scale_reference &&
                      axis->bias_minimum == axis->scale_minimum &&
                      axis->bias_maximum == axis->scale_maximum;
    if (axis->bias_order > 0) {
        difference(d, axis->bias_reference, axis->bias_minimum, axis->bias_maximum, temperature);
        add_polynomial(bias, axis->bias_order, axis->bias_temperature, d);
    }
    if (axis->scale_order > 0) {
        if (!same)
            difference(d, axis->scale_reference, axis->scale_minimum, axis->scale_maximum,
                       temperature);
        add_polynomial(scale, axis->scale_order, axis->scale_temperature, d);
    }
}

/* What is above the third power, which few models have. */
KERNEL void add_higher_powers(lanes sum[VECTORS], const lanes u[VECTORS],
                              const imk_axis_response *axis)
{
    lanes of_size[VECTORS] = {{0.0}}, of_square[VECTORS] = {{0.0}};
    for (int k = axis->powers - 1; k >= 2; k--)
        for (int v = 0; v < VECTORS; v++) {
            of_size[v] = (of_size[v] + axis->power[1][k]) * u[v];
            of_square[v] = (of_square[v] + axis->power[0][k]) * u[v];
        }
    for (int v = 0; v < VECTORS; v++)
        sum[v] += (SIZE(u[v]) * of_size[v] + (u[v] * u[v]) * of_square[v]) * u[v];
}

KERNEL void add_nonlinearity(lanes sum[VECTORS], const lanes u[VECTORS],
                             const imk_axis_response *axis)
{
    const double *a = axis->power[1], *b = axis->power[0];
    for (int v = 0; v < VECTORS; v++)
        sum[v] += SIZE(u[v]) * (a[1] * u[v] + a[0]) + (u[v] * u[v]) * (b[0] + b[1] * u[v]);
    if (__builtin_expect(axis->powers > 2, 0))
        add_higher_powers(sum, u, axis);
}

KERNEL void add_cross_products(lanes sum[VECTORS], const lanes u[VECTORS],
                               const imk_axis_response *axis, const imki_exposure *x, size_t i,
                               lanes (*place)[VECTORS])
{
    lanes p[VECTORS] = {{0.0}}, o[VECTORS] = {{0.0}};
    add_row(p, axis->used[IMKI_ROW_PENDULOUS], axis->pendulous, x, i, place);
    add_row(o, axis->used[IMKI_ROW_OUTPUT], axis->output, x, i, place);
    for (int v = 0; v < VECTORS; v++)
        sum[v] += u[v] * (axis->kip * p[v] + axis->kio * o[v]) + axis->kpo * (p[v] * o[v]);
}

KERNEL void distort_step(const imk_axis_response *axis, const imki_exposure *x, size_t i,
                         double *out)
{
    lanes y[VECTORS], u[VECTORS] = {{0.0}}, scale[VECTORS];
    for (int v = 0; v < VECTORS; v++) {
        y[v] = (lanes){0.0} + axis->bias;
        scale[v] = (lanes){0.0} + axis->scale;
    }
    for (int v = 0; v < VECTORS && x->bias; v++) {
        y[v] = VECTOR(x->bias + i, v);
        scale[v] = VECTOR(x->scale + i, v);
    }
    if (x->temperature)
        add_temperature(y, scale, axis, x->temperature + i);
    if (axis->temperature_rate != 0.0 && x->temperature_rate)
        add_product(y, axis->temperature_rate, x->temperature_rate + i);
    if (axis->warm_up != 0.0 && x->warm_up)
        add_product(y, axis->warm_up, x->warm_up + i);
    if (axis->half_hysteresis != 0.0 && x->hysteresis)
        add_product(y, axis->half_hysteresis, x->hysteresis + i);
    lanes force[3][VECTORS], (*place)[VECTORS] = axis->has_place && x->turns ? force : NULL;
    if (place)
        force_at(force, axis->place, x, i);
    add_row(u, axis->used[IMKI_ROW_INPUT], axis->input, x, i, place);
    add_row(y, axis->used[IMKI_ROW_OTHER], axis->other, x, i, place);
    for (int v = 0; v < VECTORS; v++)
        y[v] += scale[v] * u[v];
    if (axis->has_nonlinearity)
        add_nonlinearity(y, u, axis);
    if (axis->has_cross_products)
        add_cross_products(y, u, axis, x, i, place);
    for (int v = 0; v < VECTORS; v++)
        ((lanes *)(out + i))[v] = y[v] + u[v];
}

KERNEL void distort_chunks(const imk_axis_response *axis, const imki_exposure *x, size_t chunks,
                           double *out)
{
    for (size_t i = 0; i < chunks * IMKI_CHUNK; i += STEP)
        distort_step(axis, x, i, out);
}

/* ---- a motion that stays what it is in the first chunk ---- */

enum { STILL_TERMS = IMK_FEATURES + 3 };

KERNEL void still_row(lanes *term, uint32_t features, const imk_axis_response *axis,
                      const imki_exposure *x, lanes (*place)[VECTORS])
{
    lanes sum[VECTORS] = {{0.0}};
    add_row(sum, features, axis->other, x, 0, place);
    *term = sum[0];
}

/* What distort_step adds to the bias, one after another, up to u. @return how many */
KERNEL size_t still_terms(const imk_axis_response *axis, const imki_exposure *x,
                          lanes term[STILL_TERMS], lanes *input)
{
    lanes u[VECTORS] = {{0.0}}, force[3][VECTORS], (*place)[VECTORS] = NULL;
    uint32_t other = axis->used[IMKI_ROW_OTHER] & x->available;
    const uint32_t products = IMKI_PRODUCT_FEATURES;
    size_t count = 0;
    if (axis->has_place && x->turns) {
        place = force;
        other = axis->used[IMKI_ROW_OTHER] & IMKI_OWN_FEATURES;
        force_at(force, axis->place, x, 0);
    }
    add_row(u, axis->used[IMKI_ROW_INPUT], axis->input, x, 0, place);
    for (uint32_t rest = other & ~products; rest; rest &= rest - 1)
        still_row(&term[count++], rest & -rest, axis, x, place);
    if ((other & products) == products)
        still_row(&term[count++], products, axis, x, place);
    else
        for (uint32_t rest = other & products; rest; rest &= rest - 1)
            still_row(&term[count++], rest & -rest, axis, x, place);
    term[count++] = axis->scale * u[0];
    if (axis->has_nonlinearity) {
        lanes sum[VECTORS] = {{0.0}};
        add_nonlinearity(sum, u, axis);
        term[count++] = sum[0];
    }
    if (axis->has_cross_products) {
        lanes sum[VECTORS] = {{0.0}};
        add_cross_products(sum, u, axis, x, 0, place);
        term[count++] = sum[0];
    }
    *input = u[0];
    return count;
}

/* Only the warm-up changes: all else is added as distort_step adds it, but computed once. */
KERNEL void distort_still(const imk_axis_response *axis, const imki_exposure *x, size_t chunks,
                          double *out)
{
    lanes term[STILL_TERMS], u;
    const size_t count = still_terms(axis, x, term, &u);
    for (size_t i = 0; i < chunks * IMKI_CHUNK; i += STEP) {
        lanes y[VECTORS];
        for (int v = 0; v < VECTORS; v++)
            y[v] = (lanes){0.0} + axis->bias;
        if (axis->warm_up != 0.0 && x->warm_up)
            add_product(y, axis->warm_up, x->warm_up + i);
        for (size_t k = 0; k < count; k++)
            for (int v = 0; v < VECTORS; v++)
                y[v] += term[k];
        for (int v = 0; v < VECTORS; v++)
            ((lanes *)(out + i))[v] = y[v] + u;
    }
}

/* ---- sensors that differ in bias and scale factor only ---- */

/* What the motion alone makes of a step: what is added to the bias in turn, before s u and after.
 */
typedef struct shared_step {
    lanes term[STILL_TERMS][VECTORS];
    lanes input[VECTORS]; /* u */
    size_t before, after;
} shared_step;

KERNEL lanes *next_term(shared_step *step, size_t *count)
{
    lanes *term = step->term[step->before + step->after];
    (*count)++;
    for (int v = 0; v < VECTORS; v++)
        term[v] = (lanes){0.0};
    return term;
}

KERNEL void shared_terms(const imk_axis_response *axis, const imki_exposure *x, size_t i,
                         shared_step *step)
{
    lanes force[3][VECTORS], (*place)[VECTORS] = axis->has_place && x->turns ? force : NULL;
    const uint32_t products = IMKI_PRODUCT_FEATURES;
    uint32_t other = axis->used[IMKI_ROW_OTHER] & x->available;
    step->before = step->after = 0;
    if (place) {
        other = axis->used[IMKI_ROW_OTHER] & IMKI_OWN_FEATURES;
        force_at(force, axis->place, x, i);
    }
    for (int v = 0; v < VECTORS; v++)
        step->input[v] = (lanes){0.0};
    add_row(step->input, axis->used[IMKI_ROW_INPUT], axis->input, x, i, place);
    for (uint32_t rest = other & ~products; rest; rest &= rest - 1)
        add_row(next_term(step, &step->before), rest & -rest, axis->other, x, i, place);
    if ((other & products) == products)
        add_row(next_term(step, &step->before), products, axis->other, x, i, place);
    else
        for (uint32_t rest = other & products; rest; rest &= rest - 1)
            add_row(next_term(step, &step->before), rest & -rest, axis->other, x, i, place);
    if (axis->has_nonlinearity)
        add_nonlinearity(next_term(step, &step->after), step->input, axis);
    if (axis->has_cross_products)
        add_cross_products(next_term(step, &step->after), step->input, axis, x, i, place);
}

KERNEL void respond_to(const imk_axis_response *axis, const imki_exposure *x, size_t i,
                       const shared_step *step, double *out)
{
    lanes y[VECTORS];
    for (int v = 0; v < VECTORS; v++)
        y[v] = (lanes){0.0} + axis->bias;
    if (axis->warm_up != 0.0 && x->warm_up)
        add_product(y, axis->warm_up, x->warm_up + i);
    for (size_t k = 0; k < step->before; k++)
        for (int v = 0; v < VECTORS; v++)
            y[v] += step->term[k][v];
    for (int v = 0; v < VECTORS; v++)
        y[v] += axis->scale * step->input[v];
    for (size_t k = step->before; k < step->before + step->after; k++)
        for (int v = 0; v < VECTORS; v++)
            y[v] += step->term[k][v];
    for (int v = 0; v < VECTORS; v++)
        ((lanes *)(out + i))[v] = y[v] + step->input[v];
}

/* Adding what distort_step adds, in its order; what is common to all is computed once. */
KERNEL void distort_alike(size_t count, const imk_axis_response *const *axes,
                          const imki_exposure *x, size_t chunks, double *const *out)
{
    _Alignas(64) shared_step step; /* so that no vector of it is in two lines of the cache */
    for (size_t i = 0; i < chunks * IMKI_CHUNK; i += STEP) {
        shared_terms(axes[0], x, i, &step);
        for (size_t k = 0; k < count; k++)
            respond_to(axes[k], x, i, &step, out[k]);
    }
}

KERNEL void residual(size_t chunks, const double *reading, double *response)
{
    for (size_t v = 0; v < chunks * (IMKI_CHUNK / LANES); v++)
        ((lanes *)response)[v] = VECTOR(reading, v) - VECTOR(response, v);
}

KERNEL void add_residual(size_t chunks, double gain, const double *of, double *sum)
{
    for (size_t v = 0; v < chunks * (IMKI_CHUNK / LANES); v++)
        ((lanes *)sum)[v] += gain * VECTOR(of, v);
}

KERNEL void limit_all(size_t chunks, double limit, double *x)
{
    for (size_t v = 0; v < chunks * (IMKI_CHUNK / LANES); v++)
        clip(&((lanes *)x)[v], -limit, limit);
}

/* The loops as functions of one instruction set. */
#define COMPILE_FOR(isa, target)                                                                   \
    target void imki_distort_chunks_##isa(const imk_axis_response *axis, const imki_exposure *x,   \
                                          size_t chunks, double *out)                              \
    {                                                                                              \
        distort_chunks(axis, x, chunks, out);                                                      \
    }                                                                                              \
    target void imki_distort_still_##isa(const imk_axis_response *axis, const imki_exposure *x,    \
                                         size_t chunks, double *out)                               \
    {                                                                                              \
        distort_still(axis, x, chunks, out);                                                       \
    }                                                                                              \
    target void imki_distort_alike_##isa(size_t count, const imk_axis_response *const *axes,       \
                                         const imki_exposure *x, size_t chunks,                    \
                                         double *const *out)                                       \
    {                                                                                              \
        distort_alike(count, axes, x, chunks, out);                                                \
    }                                                                                              \
    target void imki_residual_##isa(size_t chunks, const double *reading, double *response)        \
    {                                                                                              \
        residual(chunks, reading, response);                                                       \
    }                                                                                              \
    target void imki_add_residual_##isa(size_t chunks, double gain, const double *of, double *sum) \
    {                                                                                              \
        add_residual(chunks, gain, of, sum);                                                       \
    }                                                                                              \
    target void imki_limit_##isa(size_t chunks, double limit, double *x)                           \
    {                                                                                              \
        limit_all(chunks, limit, x);                                                               \
    }

#endif
