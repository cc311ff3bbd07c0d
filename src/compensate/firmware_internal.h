/* SPDX-License-Identifier: Apache-2.0 */
/* Adding operations to a plan. Each looks first whether the plan has it already; its range and its
 * rounding error are known when it is added. All return the number of the operation, or -1 when the
 * plan is full or a number does not fit, which stays noted in `failed`; -1 as an operand gives -1.
 */
#ifndef IMUKI_FIRMWARE_INTERNAL_H
#define IMUKI_FIRMWARE_INTERNAL_H

#include "imukit/firmware.h"

enum {
    IMKI_FIRMWARE_COOKIE = 0x66777231, /* "fwr1" */
    IMKI_FIRMWARE_BITS = 30,     /* of the size of a fixed-point value; the rest is headroom */
    IMKI_FIRMWARE_BITS_MAX = 37, /* finest scale: shifts of products stay below 63 */
    IMKI_FIRMWARE_TERMS = 48     /* of one sum */
};

typedef struct imki_builder {
    imk_firmware *plan;
    double unit_roundoff; /* 2^-24, 2^-53; 0: fixed point */
    bool full, too_large;
} imki_builder;

/* A reading between `minimum` and `maximum`, less its origin. */
int imki_firmware_reading(imki_builder *builder, int sensor, int axis, double minimum,
                          double maximum);
int imki_firmware_temperature(imki_builder *builder);
int imki_firmware_clip(imki_builder *builder, int a, double lower, double upper);
int imki_firmware_size(imki_builder *builder, int a);
int imki_firmware_product(imki_builder *builder, int first, int second, double constant);

/* A sum under way. */
typedef struct imki_sum {
    double constant;
    int count;
    int operand[IMKI_FIRMWARE_TERMS];
    double coefficient[IMKI_FIRMWARE_TERMS];
} imki_sum;
/* Nothing happens when the coefficient is 0. */
void imki_sum_add(imki_sum *sum, int operand, double coefficient);
/* `constant_error`: of the constant beforehand. `bits`: the scale of the result; negative: the
 * finest that holds it. */
int imki_firmware_sum(imki_builder *builder, const imki_sum *sum, double constant_error, int bits);

/* Say what an operation is for, unless that is said already. */
void imki_firmware_name(imki_builder *builder, int operation, imk_firmware_role role, int sensor,
                        int axis, int step);

/* The finest scale at which values of this size fit; may be negative. */
int imki_firmware_bits(double size);
/* The largest |value| of an operation. */
double imki_firmware_largest(const imk_firmware_operation *operation);

/* The nearest float. The volatile store keeps the rounding: gcc 12 at -O2 drops a conversion to
 * float and back where it finds two side by side to make a vector of. */
static inline double imki_firmware_single(double x)
{
    volatile float single = (float)x;
    return (double)single;
}

/* Leave out what no output needs. */
void imki_firmware_prune(imk_firmware *firmware);

/* x 2^n, rounded to the nearest integer; |result| < 2^62. */
int64_t imki_firmware_integer(double x, int n);

#endif
