/* SPDX-License-Identifier: Apache-2.0 */
/* What simulator and sensor take of a unit: its axes in the order of channels, the numbers that one
 * run has, and the rows that are lost. */
#include "simulate_internal.h"

size_t imki_axes_of(const imk_triad *triad)
{
    return triad->present ? (size_t)triad->axis_count : 0;
}

bool imki_triad_has(const imk_triad *triad, const imk_axes *numbers)
{
    for (int i = 0; triad->present && i < triad->axis_count; i++)
        if (numbers->value[i] != 0.0)
            return true;
    return false;
}

imki_axis imki_axis_of(const imk_model *model, size_t channel)
{
    static const char *const names[IMK_KINDS] = {"gyro", "accel", "mag"};
    imki_axis axis = {.kind = NULL};
    for (int kind = 0; kind < IMK_KINDS; kind++) {
        const imk_triad *triad = imk_model_triad(model, kind);
        axis = (imki_axis){triad, names[kind],  kind == IMK_GYRO ? IMK_GYRO : IMK_ACCEL,
                           kind,  (int)channel, (uint8_t)(channel + (size_t)kind * IMK_AXES_MAX)};
        if (channel < imki_axes_of(triad))
            break;
        channel -= imki_axes_of(triad);
    }
    return axis;
}

void imki_draw_constants(imki_axis axis, imk_random random, uint32_t run, double *bias,
                         double *scale_factor)
{
    const imk_axes *sigma[2] = {&axis.triad->bias.repeatability,
                                &axis.triad->scale_factor.repeatability};
    double *constant[2] = {bias, scale_factor};
    for (uint8_t i = 0; i < 2; i++) {
        double normal;
        imk_random_normals(random, imk_stream(run, IMK_TERM_REPEATABILITY, i, axis.stream_axis), 0,
                           1, &normal);
        *constant[i] = sigma[i]->value[axis.axis] * normal;
    }
}

bool imki_row_dropped(imk_random random, uint32_t run, double probability, uint64_t row)
{
    uint32_t word;
    if (!(probability > 0.0))
        return false;
    imk_random_words(random, imk_stream(run, IMK_TERM_DROPS, 0, 0), row, 1, &word);
    return (double)word < probability * 0x1p32;
}
