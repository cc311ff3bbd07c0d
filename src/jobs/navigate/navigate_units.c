/* SPDX-License-Identifier: Apache-2.0 */
/* What the checks of a start look at: mean readings, the model's biases, and the units in which
 * readings would be what they should be. */
#include "navigate_log_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

imk_vector3 imki_navigate_mean(const imk_navigate_log *n, int sensor, size_t first, size_t rows)
{
    imk_vector3 sum = {{0.0, 0.0, 0.0}};
    for (size_t row = first; row < first + rows; row++)
        for (int i = 0; i < 3; i++)
            sum.v[i] += n->reading[3 * sensor + i][row];
    return imk_vector3_scale(sum, 1.0 / (double)rows);
}

const char *imki_navigate_likely_unit(const imk_log_column *column, double ratio, double tolerance)
{
    enum { UNITS = 6 };
    static const char *const lists[4][UNITS] = {
        {"rad/s", "deg/s", "deg/h", "mrad/s", "mdeg/s", "urad/s"},
        {"rad", "deg", "arcsec", "mrad", "mdeg", "urad"},
        {"m/s^2", "g", "mg", "ug", "mm/s^2", "cm/s^2"},
        {"m/s", "g*s", "mg*s", "ug*s", "mm/s", "cm/s"}};
    const int sensor = column->quantity == IMK_QUANTITY_SPECIFIC_FORCE;
    const char *const *units = lists[2 * sensor + column->increment];
    for (int k = 0; k < UNITS; k++) {
        const double scale = imk_unit_of(units[k]).scale / column->unit.scale;
        if (fabs(ratio * scale - 1.0) < tolerance && strcmp(units[k], column->unit.text) != 0)
            return units[k];
    }
    return NULL;
}

const imk_log_column *imki_navigate_first_column(const imk_navigate_log *n, imk_quantity quantity)
{
    return &n->record.log.column[imk_log_find(&n->record.log, quantity, 0)];
}

void imki_navigate_unit_names(const imk_log_column *column, const char *likely, char text[96])
{
    snprintf(text, 96, "%s\t%s", column->unit.text, likely ? likely : "");
}

double imki_navigate_bias_size(const imk_navigate_log *n, int sensor)
{
    const imk_model *model = n->settings.model;
    const imk_triad *triad = !model ? NULL : sensor == 0 ? &model->gyro : &model->accel;
    double worst = 0.0;
    for (int i = 0; i < 3 && triad; i++)
        worst = fmax(worst, hypot(triad->bias.repeatability.value[i],
                                  triad->noise.bias_instability.value[i]));
    return worst;
}
