/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of a plan, each with the range of its exact value and a bound of its error.
 *
 * Ranges are those of interval arithmetic. The error of a result is what the errors of its operands
 * become, and what the operation adds [HIGHAM2002, ch. 2, 3]: for floating point
 *
 *     |fl(x op y) - (x op y)| <= u |x op y|,     u = 2^-24 or 2^-53,
 *
 * for each product and each partial sum, for fixed point half a unit of the result, and in both the
 * rounding of the constants. A fused multiply-add rounds less than this takes. Values computed are
 * within range plus error, from which fixed-point scales are chosen, so that nothing overflows. */
#include "firmware_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Constants come out of a few operations in double: folding, polynomials about another centre. */
static const double constant_roundoff = 8 * DBL_EPSILON;

/* Kelvin to degrees Celsius and back, in double [K]. */
static const double temperature_error = 1e-13;

static const double all_of_int32 = 2147483648.0;

double imki_firmware_largest(const imk_firmware_operation *operation)
{
    return fmax(fabs(operation->minimum), fabs(operation->maximum));
}

int imki_firmware_bits(double size)
{
    int exponent = 0;
    if (!(size > 0))
        return IMKI_FIRMWARE_BITS_MAX;
    (void)frexp(size, &exponent); /* size < 2^exponent */
    const int bits = IMKI_FIRMWARE_BITS - exponent;
    return bits < IMKI_FIRMWARE_BITS_MAX ? bits : IMKI_FIRMWARE_BITS_MAX;
}

int64_t imki_firmware_integer(double x, int n)
{
    return (int64_t)floor(ldexp(x, n) + 0.5);
}

/* A constant as the arithmetic holds it; *error grows by its rounding. */
static double rounded(const imki_builder *b, double value, double *error)
{
    const double held =
        b->plan->arithmetic == IMK_FIRMWARE_FLOAT ? imki_firmware_single(value) : value;
    *error += fabs(held - value) + constant_roundoff * fabs(value);
    return held;
}

static bool is_fixed(const imki_builder *b)
{
    return b->plan->arithmetic == IMK_FIRMWARE_FIXED;
}

static bool same_terms(const imk_firmware *f, const imk_firmware_operation *a,
                       const imk_firmware_operation *b)
{
    if (a->count != b->count)
        return false;
    for (int i = 0; i < a->count; i++)
        if (f->term[a->first + i].operand != f->term[b->first + i].operand ||
            f->term[a->first + i].coefficient != f->term[b->first + i].coefficient)
            return false;
    return true;
}

static bool same_operation(const imk_firmware *f, const imk_firmware_operation *a,
                           const imk_firmware_operation *b)
{
    return a->kind == b->kind && a->a == b->a && a->b == b->b && a->bits == b->bits &&
           a->constant == b->constant && a->lower == b->lower && a->upper == b->upper &&
           (a->kind != IMK_FIRMWARE_READING || (a->sensor == b->sensor && a->axis == b->axis)) &&
           same_terms(f, a, b);
}

/* The same operation, when there is one; else this one, at the end. */
static int append(imki_builder *b, const imk_firmware_operation *made)
{
    imk_firmware *f = b->plan;
    for (int i = 0; i < f->operation_count; i++)
        if (same_operation(f, &f->operation[i], made)) {
            f->term_count -= made->count;
            return i;
        }
    if (f->operation_count == IMK_FIRMWARE_OPERATIONS_MAX) {
        b->full = true;
        return -1;
    }
    f->operation[f->operation_count] = *made;
    return f->operation_count++;
}

static imk_firmware_operation blank(imk_firmware_kind kind)
{
    imk_firmware_operation made;
    memset(&made, 0, sizeof made);
    made.kind = kind;
    made.a = made.b = -1;
    return made;
}

/* The scale of a fixed-point result: the finest that holds it, or the one asked for. */
static bool choose_scale(imki_builder *b, imk_firmware_operation *made, int asked)
{
    const int finest = imki_firmware_bits(imki_firmware_largest(made) + made->error);
    made->bits = asked >= 0 ? asked : finest;
    if (made->bits > finest || made->bits < 0)
        b->too_large = true;
    return !b->too_large;
}

int imki_firmware_reading(imki_builder *b, int sensor, int axis, double minimum, double maximum)
{
    const imk_firmware_channel *channel = &b->plan->channel[sensor][axis];
    imk_firmware_operation made = blank(IMK_FIRMWARE_READING);
    made.sensor = sensor;
    made.axis = axis;
    made.minimum = minimum - channel->origin;
    made.maximum = maximum - channel->origin;
    made.bits = channel->bits;
    /* An integer of more than 24 bits is rounded on its way to float. */
    if (channel->in_counts && b->unit_roundoff > 0x1p-53 && imki_firmware_largest(&made) > 0x1p24)
        made.error = b->unit_roundoff * imki_firmware_largest(&made);
    made.fixed_lower = (int32_t)fmax(floor(ldexp(minimum, made.bits)), -all_of_int32);
    made.fixed_upper = (int32_t)fmin(ceil(ldexp(maximum, made.bits)), all_of_int32 - 1);
    return append(b, &made);
}

int imki_firmware_temperature(imki_builder *b)
{
    imk_firmware_operation made = blank(IMK_FIRMWARE_TEMPERATURE);
    made.bits = b->plan->temperature_bits;
    made.maximum = ldexp(all_of_int32, -16);
    made.minimum = -made.maximum;
    made.error = temperature_error;
    return append(b, &made);
}

int imki_firmware_clip(imki_builder *b, int a, double lower, double upper)
{
    if (a < 0)
        return -1;
    const imk_firmware_operation *from = &b->plan->operation[a];
    imk_firmware_operation made = blank(IMK_FIRMWARE_CLIP);
    double lower_error = 0, upper_error = 0;
    made.a = a;
    made.bits = from->bits;
    made.lower = rounded(b, lower, &lower_error);
    made.upper = rounded(b, upper, &upper_error);
    if (is_fixed(b)) {
        /* A limit beyond what the scale holds never acts. */
        const double most = ldexp(all_of_int32 - 1, -from->bits);
        made.fixed_lower = (int32_t)imki_firmware_integer(fmax(lower, -most), from->bits);
        made.fixed_upper = (int32_t)imki_firmware_integer(fmin(upper, most), from->bits);
        lower_error += ldexp(0.5, -from->bits);
        upper_error += ldexp(0.5, -from->bits);
    }
    made.minimum = fmax(from->minimum, lower);
    made.maximum = fmin(from->maximum, upper);
    made.error = fmax(from->error, fmax(lower_error, upper_error));
    return append(b, &made);
}

int imki_firmware_size(imki_builder *b, int a)
{
    if (a < 0)
        return -1;
    const imk_firmware_operation *from = &b->plan->operation[a];
    imk_firmware_operation made = blank(IMK_FIRMWARE_SIZE);
    made.a = a;
    made.bits = from->bits;
    made.maximum = imki_firmware_largest(from);
    made.error = from->error;
    return append(b, &made);
}

/* a b + constant; in fixed point the product is rounded to the scale of the result, and the
 * constant apart. */
int imki_firmware_product(imki_builder *b, int first, int second, double constant)
{
    if (first < 0 || second < 0)
        return -1;
    const imk_firmware_operation *p = &b->plan->operation[first];
    const imk_firmware_operation *q = &b->plan->operation[second];
    const double corner[4] = {p->minimum * q->minimum, p->minimum * q->maximum,
                              p->maximum * q->minimum, p->maximum * q->maximum};
    const double size_p = imki_firmware_largest(p), size_q = imki_firmware_largest(q);
    imk_firmware_operation made = blank(IMK_FIRMWARE_PRODUCT);
    made.a = first;
    made.b = second;
    made.error = size_p * q->error + size_q * p->error + p->error * q->error;
    const double product = size_p * size_q + made.error;
    made.constant = rounded(b, constant, &made.error);
    made.minimum = fmin(fmin(corner[0], corner[1]), fmin(corner[2], corner[3])) + constant;
    made.maximum = fmax(fmax(corner[0], corner[1]), fmax(corner[2], corner[3])) + constant;
    if (!is_fixed(b)) {
        made.error += b->unit_roundoff * product;
        if (constant != 0)
            made.error += b->unit_roundoff * (product + fabs(constant));
        return append(b, &made);
    }
    if (!choose_scale(b, &made, -1))
        return -1;
    if (made.bits > p->bits + q->bits - 1)
        made.bits = p->bits + q->bits - 1;
    made.shift = p->bits + q->bits - made.bits;
    made.fixed_constant = imki_firmware_integer(constant, made.bits);
    made.error += ldexp(constant != 0 ? 1.0 : 0.5, -made.bits);
    if (made.shift > 62)
        b->too_large = true;
    return b->too_large ? -1 : append(b, &made);
}

/* ---- sums ------------------------------------------------------------------------------------ */

void imki_sum_add(imki_sum *sum, int operand, double coefficient)
{
    if (coefficient == 0.0)
        return;
    sum->operand[sum->count] = operand;
    sum->coefficient[sum->count++] = coefficient;
}

/* Terms into the plan. @return false when there is no room */
static bool take_terms(imki_builder *b, const imki_sum *sum, imk_firmware_operation *made)
{
    imk_firmware *f = b->plan;
    if (f->term_count + sum->count > IMK_FIRMWARE_TERMS_MAX) {
        b->full = true;
        return false;
    }
    made->first = f->term_count;
    made->count = sum->count;
    for (int i = 0; i < sum->count; i++) {
        const imk_firmware_operation *of = &f->operation[sum->operand[i]];
        const double c = sum->coefficient[i];
        imk_firmware_term *term = &f->term[f->term_count++];
        double error = 0;
        *term =
            (imk_firmware_term){.operand = sum->operand[i], .coefficient = rounded(b, c, &error)};
        made->minimum += fmin(c * of->minimum, c * of->maximum);
        made->maximum += fmax(c * of->minimum, c * of->maximum);
        made->error += fabs(c) * of->error + error * (imki_firmware_largest(of) + of->error);
    }
    return true;
}

/* Products and partial sums, in the order of the terms. */
static void add_roundings(const imki_builder *b, imk_firmware_operation *made)
{
    double size = fabs(made->constant);
    bool any = made->constant != 0;
    for (int i = 0; i < made->count; i++) {
        const imk_firmware_term *term = &b->plan->term[made->first + i];
        const imk_firmware_operation *of = &b->plan->operation[term->operand];
        const double product = fabs(term->coefficient) * (imki_firmware_largest(of) + of->error);
        size += product;
        if (fabs(term->coefficient) != 1)
            made->error += b->unit_roundoff * product;
        if (any)
            made->error += b->unit_roundoff * size;
        any = true;
    }
    /* Products of errors, and numbers below the normal range. */
    made->error *= 1.0 + 0x1p-20;
    if (b->unit_roundoff > 0x1p-53)
        made->error += 0x1p-140;
}

/* Integer coefficients: all products at one scale, as fine as 32-bit coefficients and a 64-bit sum
 * allow. */
static void scale_terms(imki_builder *b, imk_firmware_operation *made)
{
    imk_firmware *f = b->plan;
    int scale = 62 + made->bits, exponent = 0;
    double size = fabs(made->constant);
    for (int i = 0; i < made->count; i++) {
        const imk_firmware_term *term = &f->term[made->first + i];
        const imk_firmware_operation *of = &f->operation[term->operand];
        (void)frexp(term->coefficient, &exponent); /* |coefficient| < 2^exponent */
        scale = of->bits + 30 - exponent < scale ? of->bits + 30 - exponent : scale;
        size += fabs(term->coefficient) * (imki_firmware_largest(of) + of->error);
    }
    (void)frexp(size, &exponent);
    scale = 61 - exponent < scale ? 61 - exponent : scale;
    if (scale <= made->bits)
        scale = made->bits + 1;
    made->shift = scale - made->bits;
    for (int i = 0; i < made->count; i++) {
        imk_firmware_term *term = &f->term[made->first + i];
        const imk_firmware_operation *of = &f->operation[term->operand];
        const int64_t integer = imki_firmware_integer(term->coefficient, scale - of->bits);
        b->too_large = b->too_large || integer > INT32_MAX || integer < -INT32_MAX;
        term->fixed = (int32_t)integer;
        made->error += fabs(ldexp((double)integer, of->bits - scale) - term->coefficient) *
                       (imki_firmware_largest(of) + of->error);
    }
    made->fixed_constant =
        imki_firmware_integer(made->constant, scale) + ((int64_t)1 << (made->shift - 1));
    made->error += ldexp(0.5, -scale) + ldexp(0.5, -made->bits);
}

int imki_firmware_sum(imki_builder *b, const imki_sum *sum, double constant_error, int bits)
{
    for (int i = 0; i < sum->count; i++)
        if (sum->operand[i] < 0)
            return -1;
    if (sum->count == 1 && sum->coefficient[0] == 1.0 && sum->constant == 0.0 &&
        (bits < 0 || b->plan->operation[sum->operand[0]].bits == bits))
        return sum->operand[0];
    imk_firmware_operation made = blank(IMK_FIRMWARE_SUM);
    made.error = constant_error;
    made.constant = rounded(b, sum->constant, &made.error);
    made.minimum = made.maximum = sum->constant;
    if (!take_terms(b, sum, &made))
        return -1;
    if (!is_fixed(b)) {
        add_roundings(b, &made);
        return append(b, &made);
    }
    if (!choose_scale(b, &made, bits))
        return -1;
    scale_terms(b, &made);
    return b->too_large ? -1 : append(b, &made);
}

void imki_firmware_name(imki_builder *b, int operation, imk_firmware_role role, int sensor,
                        int axis, int step)
{
    if (operation < 0 || b->plan->operation[operation].role != IMK_FIRMWARE_STEP)
        return;
    imk_firmware_operation *o = &b->plan->operation[operation];
    o->role = role;
    o->sensor = sensor;
    o->axis = axis;
    o->step = step;
}
