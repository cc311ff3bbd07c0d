/* SPDX-License-Identifier: Apache-2.0 */
/* Why a model cannot be inverted: the term without which the iteration would converge fastest. */
#include "base/text_internal.h"
#include "correct_internal.h"

#include <math.h>
#include <string.h>

imk_status imki_correct_refuse(imk_error *error, imk_status status, int sensor, const char *key,
                               const char *found, const char *expected)
{
    char field[64] = "";
    if (key) {
        imki_append_text(field, sizeof field, sensor == IMK_GYRO ? "gyro." : "accel.");
        imki_append_text(field, sizeof field, key);
    }
    return imk_error_set(error, status, field, found, expected);
}

static void clear(double *weight, unsigned features)
{
    for (int k = 0; k < IMK_FEATURES; k++)
        if (features >> k & 1u)
            weight[k] = 0.0;
}

/* @return false when the inversion does not depend on how large the term is */
static bool remove_term(imk_axis_response *axis, int term)
{
    const imki_power *power;
    switch (imki_terms[term].form) {
    case IMKI_FORM_WARM_INPUT:
        axis->scale_order = 0;
        return true;
    case IMKI_FORM_POWER:
        power = &imki_input_powers[imki_power_of(term)];
        axis->power[power->q][imki_power_place(power)] = 0.0;
        return true;
    case IMKI_FORM_FORCE:
        clear(axis->other, IMKI_THIRD_FEATURES);
        return true;
    case IMKI_FORM_PRODUCT:
        clear(axis->other, IMKI_PRODUCT_FEATURES);
        return true;
    case IMKI_FORM_CROSS:
        axis->has_cross_products = false;
        return true;
    case IMKI_FORM_PLACE:
        clear(axis->input, IMKI_PRODUCT_FEATURES);
        clear(axis->other, IMKI_PRODUCT_FEATURES);
        clear(axis->pendulous, IMKI_PRODUCT_FEATURES);
        clear(axis->output, IMKI_PRODUCT_FEATURES);
        return true;
    default:
        return false;
    }
}

/* The contraction that is left without a term; infinite when it has no part in it. */
static double contraction_without(const imki_inversion *inversion, imk_distortion *distortion,
                                  int sensor, int term)
{
    imk_axis_response with[IMK_AXES_MAX];
    imki_inversion trial = *inversion;
    int singular;
    memcpy(with, distortion->axis[sensor], sizeof with);
    if (!remove_term(&distortion->axis[sensor][0], term))
        return HUGE_VAL;
    for (int i = 0; i < distortion->axis_count[sensor]; i++)
        remove_term(&distortion->axis[sensor][i], term);
    const bool inverted = imki_invert_middle(&trial, &singular) == IMK_OK;
    const double left = inverted ? imki_contraction(&trial) : HUGE_VAL;
    memcpy(distortion->axis[sensor], with, sizeof with);
    return left;
}

imk_status imki_refuse_inversion(const imki_inversion *inversion, imk_distortion *distortion,
                                 imk_error *error)
{
    const double contraction = imki_contraction(inversion);
    int worst_sensor = IMK_GYRO, worst = -1;
    double best = INFINITY;
    for (int sensor = 0; error && sensor < 2; sensor++) {
        uint8_t term[IMKI_TERMS];
        const size_t count = imki_terms_in_order(sensor, term);
        for (size_t k = 0; k < count; k++) {
            const double left = contraction_without(inversion, distortion, sensor, term[k]);
            if (left < best) {
                best = left;
                worst = term[k];
                worst_sensor = sensor;
            }
        }
    }
    imki_correct_refuse(error, IMK_ERROR_NO_CONVERGENCE, worst_sensor,
                        worst < 0 ? NULL : imki_term_field(worst)->path[worst_sensor],
                        "this term is too large to be taken out over the range of the sensors",
                        "state a smaller range, or correct without this term");
    if (error) {
        error->value = contraction;
        error->limit = 1.0;
    }
    return IMK_ERROR_NO_CONVERGENCE;
}
