/* SPDX-License-Identifier: Apache-2.0 */
/* The default model: orthogonal triads of gyros and accelerometers without any error. */
#include "imukit/model.h"

#include "model_internal.h"
#include "model_schema_internal.h"

#include <math.h>
#include <string.h>

static void set_triad(imk_triad *triad, bool present)
{
    triad->present = present;
    triad->axis_count = 3;
    for (int i = 0; i < 3; i++)
        triad->direction[i][i] = 1;
}

void imk_model_default(imk_model *model)
{
    memset(model, 0, sizeof *model);
    model->cookie = IMKI_MODEL_COOKIE;
    set_triad(&model->gyro, true);
    set_triad(&model->accel, true);
    set_triad(&model->mag, false);
}

int imk_model_complete(imk_model *model)
{
    for (int kind = IMK_GYRO; kind <= IMK_ACCEL; kind++) {
        imk_triad *triad = imk_model_triad_to_set(model, kind);
        if (triad->present)
            continue;
        memset(triad, 0, sizeof *triad);
        set_triad(triad, true);
        return kind;
    }
    return -1;
}

const imk_triad *imk_model_triad(const imk_model *model, int sensor)
{
    return sensor == IMK_GYRO ? &model->gyro : sensor == IMK_ACCEL ? &model->accel : &model->mag;
}

imk_triad *imk_model_triad_to_set(imk_model *model, int sensor)
{
    return sensor == IMK_GYRO ? &model->gyro : sensor == IMK_ACCEL ? &model->accel : &model->mag;
}

double imk_noise_reading(const imk_noise *noise, int axis, double dt)
{
    const double q = noise->quantization.value[axis], a = noise->angle_white.value[axis];
    const double r = noise->reading_noise.value[axis];
    return a == 0.0 && r == 0.0 ? q : sqrt(q * q + r * r + a * a / dt);
}

/* ---- comparison -------------------------------------------------------------------------------
 *
 * Numbers are compared as numbers (-0 is 0); what lies beyond the number of axes or of list
 * elements does not count. */

static bool equal_triads(const imk_triad *a, const imk_triad *b)
{
    if (a->present != b->present)
        return false;
    if (!a->present)
        return true;
    /* The first field is the direction, with the number of axes the others are compared on. How
     * the file states its densities changes no number. */
    for (size_t i = 0; i < imki_triad_field_count; i++)
        if (imki_triad_fields[i].shape != IMKI_DENSITY &&
            !imki_field_equal(&imki_triad_fields[i], a, b, false))
            return false;
    return true;
}

bool imk_model_equal(const imk_model *a, const imk_model *b)
{
    for (size_t i = 0; i < imki_timing_field_count; i++)
        if (!imki_numbers_equal(&imki_timing_fields[i], &a->timing, &b->timing, 1, false))
            return false;
    return equal_triads(&a->gyro, &b->gyro) && equal_triads(&a->accel, &b->accel) &&
           equal_triads(&a->mag, &b->mag);
}
