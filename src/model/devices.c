/* SPDX-License-Identifier: Apache-2.0 */
/* The catalogue: look-up, and the model of an entry.
 *
 * A data sheet's "bias instability" is the flat floor of the Allan deviation:
 *
 *     B = floor / sqrt(2 ln 2/pi) = floor / 0.664     [IEEE952] */
#include "device_table_internal.h"
#include "model_schema_internal.h"

#include <string.h>

static const double degree = 3.14159265358979323846 / 180; /* [rad] */
static const double hour = 3600;                           /* [s] */
static const double root_hour = 60;                        /* [sqrt(s)] */
static const double standard_gravity = 9.80665;            /* [m/s^2], CGPM 1901 */

/* SI values of the units of the table, for one kind of sensor. */
typedef struct table_units {
    double white, bias, random_walk, range;
} table_units;

size_t imk_device_count(void)
{
    return imki_device_table_count;
}

const imk_device *imk_device_get(size_t index)
{
    return index < imki_device_table_count ? &imki_device_table[index].device : NULL;
}

static char lower_case(char c)
{
    return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

/* Equal but for case and blanks. */
static bool same_name(const char *a, const char *b)
{
    for (;; a++, b++) {
        while (is_blank(*a))
            a++;
        while (is_blank(*b))
            b++;
        if (lower_case(*a) != lower_case(*b))
            return false;
        if (*a == '\0')
            return true;
    }
}

const imk_device *imk_device_find(const char *name)
{
    for (size_t i = 0; name && i < imki_device_table_count; i++)
        if (same_name(name, imki_device_table[i].device.name))
            return &imki_device_table[i].device;
    return NULL;
}

static void copy_text(char *target, size_t size, const char *source)
{
    size_t length = strlen(source);
    if (length >= size)
        length = size - 1;
    memcpy(target, source, length);
    target[length] = '\0';
}

static void set_all(imk_axes *axes, double value)
{
    for (int i = 0; i < 3; i++)
        axes->value[i] = value;
}

static void set_matrix(imk_triad *triad, const double *matrix)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            if (i == j)
                triad->scale_factor.fixed.value[i] = matrix[3 * i + j] * 1e-6;
            else
                triad->misalignment.value[i][j] = matrix[3 * i + j] * 1e-6;
        }
}

static void set_triad(imk_triad *triad, const imki_device_figures *figures, table_units unit)
{
    triad->present = figures->present;
    double to_b = figures->is_floor ? 1 / IMKI_ALLAN_FLOOR : 1;
    set_all(&triad->noise.white, figures->white * unit.white);
    set_all(&triad->noise.bias_instability, figures->instability * unit.bias * to_b);
    set_all(&triad->noise.random_walk, figures->random_walk * unit.random_walk);
    set_all(&triad->bias.repeatability, figures->repeatability * unit.bias);
    set_all(&triad->range, figures->range * unit.range);
    set_all(&triad->scale_factor.repeatability, figures->scale_factor * 1e-6);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            triad->misalignment.value[i][j] = i == j ? 0 : figures->misalignment * 1e-3;
    if (figures->matrix)
        set_matrix(triad, figures->matrix);
    for (int i = 0; figures->bias && i < 3; i++)
        triad->bias.fixed.value[i] = figures->bias[i] * unit.bias;
}

static void set_g_sensitivity(imk_triad *gyro, const imki_device_figures *figures)
{
    double unit = degree / hour / standard_gravity;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double own = i == j ? figures->g_sensitivity : 0;
            gyro->g_sensitivity.value[i][j] =
                (figures->g_matrix ? figures->g_matrix[3 * i + j] : own) * unit;
        }
}

void imk_device_model(const imk_device *device, imk_model *model)
{
    const table_units gyro_units = {degree / root_hour, degree / hour, degree / hour / root_hour,
                                    degree};
    const table_units accel_units = {1 / root_hour, standard_gravity * 1e-6,
                                     standard_gravity * 1e-6 / root_hour, standard_gravity};
    const imki_device_entry *entry = (const imki_device_entry *)(const void *)device;
    *model = imk_model_default();
    copy_text(model->name, sizeof model->name, device->name);
    copy_text(model->description, sizeof model->description, device->grade);
    set_triad(&model->gyro, &entry->gyro, gyro_units);
    set_triad(&model->accel, &entry->accel, accel_units);
    set_g_sensitivity(&model->gyro, &entry->gyro);
    imk_evidence *evidence[2] = {&model->gyro_evidence, &model->accel_evidence};
    for (int i = 0; i < 2; i++) {
        copy_text(evidence[i]->source, sizeof evidence[i]->source, device->source);
        copy_text(evidence[i]->method, sizeof evidence[i]->method, entry->method);
    }
}
