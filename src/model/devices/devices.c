/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue: look-up, and the model of an entry.
 *
 * A data sheet's "bias instability" is the flat floor of the Allan deviation:
 *
 *     B = floor / sqrt(2 ln 2/pi) = floor / 0.664     [IEEE952] */
#include "base/text_internal.h"
#include "device_table_internal.h"
#include "model/model_schema_internal.h"

#include "imukit/names.h"
#include "imukit/units.h"

#include <string.h>

/* SI values of the units of the table and of model files, for one kind of sensor. The scales are
 * those of the units' own table, so that 0.8 mg here is the double that "0.8 mg" reads as. */
typedef struct table_units {
    double white, instability, random_walk, quantization, range, resolution;
    double bias;         /* of fixed and repeatability as model files write them */
    double bias_divisor; /* from the table's unit to that one */
} table_units;

size_t imk_device_count(void)
{
    return IMKI_PRESETS + imki_device_table_count + imki_part_table_count;
}

const imk_device *imk_device_get(size_t index)
{
    if (index < IMKI_PRESETS)
        return &imki_grade_presets[index].device;
    index -= IMKI_PRESETS;
    if (index < imki_device_table_count)
        return &imki_device_table[index].device;
    index -= imki_device_table_count;
    return index < imki_part_table_count ? &imki_part_table[index].device : NULL;
}

const imk_device *imk_device_find(const char *name)
{
    for (size_t i = 0; name && i < imk_device_count(); i++)
        if (imk_name_equal(name, imk_device_get(i)->name))
            return imk_device_get(i);
    return NULL;
}

static void set_all(imk_axes *axes, double value)
{
    for (int i = 0; i < 3; i++)
        axes->value[i] = value;
}

static void set_matrix(imk_triad *triad, const double *matrix)
{
    double ppm = imk_unit_of("ppm").scale, mrad = imk_unit_of("mrad").scale;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            if (i == j)
                triad->scale_factor.fixed.value[i] = matrix[3 * i + j] * ppm;
            else
                triad->misalignment.value[i][j] = matrix[3 * i + j] / 1000 * mrad;
        }
}

static void set_triad(imk_triad *triad, const imki_device_figures *figures, table_units unit)
{
    triad->present = figures->present;
    double mrad = imk_unit_of("mrad").scale;
    double to_b = figures->is_floor ? 1 / IMKI_ALLAN_FLOOR : 1;
    set_all(&triad->noise.white, figures->white * unit.white);
    if (figures->white_z > 0)
        triad->noise.white.value[2] = figures->white_z * unit.white;
    set_all(&triad->noise.bias_instability, figures->instability * to_b * unit.instability);
    set_all(&triad->noise.random_walk, figures->random_walk * unit.random_walk);
    set_all(&triad->bias.repeatability, figures->repeatability / unit.bias_divisor * unit.bias);
    set_all(&triad->noise.quantization, figures->quantization * unit.quantization);
    set_all(&triad->range, figures->range * unit.range);
    set_all(&triad->resolution, figures->resolution * unit.resolution);
    set_all(&triad->bandwidth, figures->bandwidth);
    set_all(&triad->nonlinearity.k2, figures->k2 * imk_unit_of("ppm/g").scale);
    set_all(&triad->scale_factor.repeatability, figures->scale_factor * imk_unit_of("ppm").scale);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            triad->misalignment.value[i][j] = i == j ? 0 : figures->misalignment * mrad;
    if (figures->matrix)
        set_matrix(triad, figures->matrix);
    for (int i = 0; figures->bias && i < 3; i++)
        triad->bias.fixed.value[i] = figures->bias[i] / unit.bias_divisor * unit.bias;
}

static void set_g_sensitivity(imk_triad *gyro, const imki_device_figures *figures)
{
    double unit = imk_unit_of("deg/h/g").scale, unit2 = imk_unit_of("deg/h/g^2").scale;
    for (int i = 0; i < 3; i++)
        gyro->g2_sensitivity.value[i][i] = figures->g2_sensitivity * unit2;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double own = i == j ? figures->g_sensitivity : 0;
            gyro->g_sensitivity.value[i][j] =
                (figures->g_matrix ? figures->g_matrix[3 * i + j] : own) * unit;
        }
}

void imk_device_model(const imk_device *device, imk_model *model)
{
    const table_units gyro_units = {.white = imk_unit_of("deg/sqrt(h)").scale,
                                    .instability = imk_unit_of("deg/h").scale,
                                    .random_walk = imk_unit_of("deg/h/sqrt(h)").scale,
                                    .quantization = imk_unit_of("arcsec").scale,
                                    .range = imk_unit_of("deg/s").scale,
                                    .resolution = imk_unit_of("deg/s").scale,
                                    .bias = imk_unit_of("deg/h").scale,
                                    .bias_divisor = 1};
    const table_units accel_units = {.white = imk_unit_of("m/s/sqrt(h)").scale,
                                     .instability = imk_unit_of("ug").scale,
                                     .random_walk = imk_unit_of("ug/sqrt(h)").scale,
                                     .quantization = imk_unit_of("m/s").scale,
                                     .range = imk_unit_of("g").scale,
                                     .resolution = imk_unit_of("mg").scale,
                                     .bias = imk_unit_of("mg").scale,
                                     .bias_divisor = 1000};
    const imki_device_entry *entry = (const imki_device_entry *)(const void *)device;
    imk_model_default(model);
    imki_copy_text(model->name, sizeof model->name, device->name);
    imki_copy_text(model->description, sizeof model->description, device->grade);
    set_triad(&model->gyro, &entry->gyro, gyro_units);
    set_triad(&model->accel, &entry->accel, accel_units);
    set_g_sensitivity(&model->gyro, &entry->gyro);
    imk_evidence *evidence[2] = {&model->gyro_evidence, &model->accel_evidence};
    for (int i = 0; i < 2; i++) {
        imki_copy_text(evidence[i]->source, sizeof evidence[i]->source, device->source);
        imki_copy_text(evidence[i]->method, sizeof evidence[i]->method, entry->method);
    }
}
