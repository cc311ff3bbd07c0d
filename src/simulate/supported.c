/* SPDX-License-Identifier: Apache-2.0 */
/* Which terms a static log cannot hold exactly: those that depend on the temperature, act between
 * the sensor and its filter, or move the samples in time. They are refused by name. */
#include "simulate/simulate_internal.h"

#include <string.h>

static bool any(const imk_axes *axes, int count)
{
    for (int i = 0; i < count; i++)
        if (axes->value[i] != 0.0)
            return true;
    return false;
}

static bool any_polynomial(const imk_temperature_polynomial *polynomial, int count)
{
    for (int i = 0; i < polynomial->order; i++)
        if (any(&polynomial->coefficient[i], count))
            return true;
    return false;
}

static bool any_row(const imk_rows *rows, int count)
{
    for (int i = 0; i < count; i++)
        for (int j = 0; j < 3; j++)
            if (rows->value[i][j] != 0.0)
                return true;
    return false;
}

static imk_status refuse(imk_error *error, const char *kind, const char *field,
                         const char *expected)
{
    char path[96] = "";
    size_t length = strlen(kind);
    memcpy(path, kind, length);
    if (length > 0)
        path[length++] = '.';
    memcpy(path + length, field, strlen(field) + 1);
    return imk_error_set(error, IMK_ERROR_UNSUPPORTED, path, "", expected);
}

static imk_status check_triad(const imk_triad *triad, const char *kind, imk_error *error)
{
    static const char *const temperature =
        "a model without it: simulated logs have a constant, unstated temperature";
    if (!triad->present)
        return IMK_OK;
    int n = triad->axis_count;
    if (any_polynomial(&triad->bias.temperature, n))
        return refuse(error, kind, "bias.temperature", temperature);
    if (any(&triad->bias.warm_up_amplitude, n))
        return refuse(error, kind, "bias.warm_up", temperature);
    if (any(&triad->bias.hysteresis, n))
        return refuse(error, kind, "bias.hysteresis", temperature);
    if (any_polynomial(&triad->scale_factor.temperature, n))
        return refuse(error, kind, "scale_factor.temperature", temperature);
    if (any_row(&triad->nonlinearity.cross_products, n))
        return refuse(error, kind, "nonlinearity.cross_products",
                      "a model without it: pendulous and output axes are not stated");
    if (any(&triad->dead_band, n))
        return refuse(error, kind, "dead_band",
                      "a model without it: it acts before the mean over a sample");
    return IMK_OK;
}

imk_status imki_check_supported(const imk_model *model, imk_error *error)
{
    static const char *const timing = "a model without it: simulated samples are equally spaced";
    imk_status status = check_triad(&model->gyro, "gyro", error);
    if (status == IMK_OK)
        status = check_triad(&model->accel, "accel", error);
    if (status != IMK_OK)
        return status;
    if (model->timing.rate_error.value != 0.0)
        return refuse(error, "timing", "rate_error", timing);
    if (model->timing.jitter.value != 0.0)
        return refuse(error, "timing", "jitter", timing);
    if (model->timing.drops.value != 0.0)
        return refuse(error, "timing", "drops", timing);
    return IMK_OK;
}
