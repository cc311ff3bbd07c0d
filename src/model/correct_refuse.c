/* SPDX-License-Identifier: Apache-2.0 */
/* Why a model cannot be inverted: the term without which the iteration would converge fastest. */
#include "correct_internal.h"

#include <math.h>
#include <string.h>

enum {
    SCALE_TEMPERATURE,
    K2,
    KOQ,
    K3,
    ASYMMETRY,
    G_SENSITIVITY,
    G2_SENSITIVITY,
    CROSS_PRODUCTS,
    LEVER_ARM,
    TERMS
};

static const char *const names[2][TERMS] = {
    {"gyro.scale_factor.temperature", "gyro.nonlinearity.k2", "gyro.nonlinearity.koq",
     "gyro.nonlinearity.k3", "gyro.nonlinearity.asymmetry", "gyro.g_sensitivity",
     "gyro.g2_sensitivity", NULL, NULL},
    {"accel.scale_factor.temperature", "accel.nonlinearity.k2", "accel.nonlinearity.koq",
     "accel.nonlinearity.k3", "accel.nonlinearity.asymmetry", NULL, NULL, "accel.cross_products",
     "accel.lever_arm"},
};

static void clear(double *weight, unsigned features)
{
    for (int k = 0; k < IMK_FEATURES; k++)
        if (features >> k & 1u)
            weight[k] = 0.0;
}

static void remove_term(imk_axis_response *axis, int term)
{
    switch (term) {
    case SCALE_TEMPERATURE:
        axis->scale_order = 0;
        break;
    case K2:
        axis->k2 = 0.0;
        break;
    case KOQ:
        axis->koq = 0.0;
        break;
    case K3:
        axis->k3 = 0.0;
        break;
    case ASYMMETRY:
        axis->half_asymmetry = 0.0;
        break;
    case G_SENSITIVITY:
        clear(axis->other, IMKI_THIRD_FEATURES);
        break;
    case G2_SENSITIVITY:
        clear(axis->other, IMKI_PRODUCT_FEATURES);
        break;
    case CROSS_PRODUCTS:
        axis->has_cross_products = false;
        break;
    default:
        clear(axis->input, IMKI_PRODUCT_FEATURES);
        clear(axis->other, IMKI_PRODUCT_FEATURES);
        clear(axis->pendulous, IMKI_PRODUCT_FEATURES);
        clear(axis->output, IMKI_PRODUCT_FEATURES);
    }
}

imk_status imki_refuse_inversion(const imki_inversion *inversion, imk_distortion *distortion,
                                 imk_error *error)
{
    const double contraction = imki_contraction(inversion);
    const char *worst = "";
    double best = INFINITY;
    for (int k = 0; error && k < 2 * TERMS; k++) {
        const int sensor = k / TERMS, term = k % TERMS;
        imk_axis_response with[IMK_AXES_MAX];
        imki_inversion trial = *inversion;
        int singular;
        if (!names[sensor][term])
            continue;
        memcpy(with, distortion->axis[sensor], sizeof with);
        for (int i = 0; i < distortion->axis_count[sensor]; i++)
            remove_term(&distortion->axis[sensor][i], term);
        const bool inverted = imki_invert_middle(&trial, &singular) == IMK_OK;
        const double left = inverted ? imki_contraction(&trial) : HUGE_VAL;
        memcpy(distortion->axis[sensor], with, sizeof with);
        if (left < best) {
            best = left;
            worst = names[sensor][term];
        }
    }
    imk_error_set(error, IMK_ERROR_NO_CONVERGENCE, worst,
                  "this term is too large to be taken out over the range of the sensors",
                  "state a smaller range, or correct without this term");
    if (error) {
        error->value = contraction;
        error->limit = 1.0;
    }
    return IMK_ERROR_NO_CONVERGENCE;
}
