/* SPDX-License-Identifier: Apache-2.0 */
/* The magnetometer of a record: the field in body axes, u = A^-1 (m - h), with the bias h and A the
 * directions, scale factors, misalignment and cross-axis response of the model. */
#include "compensate_internal.h"

#include "jobs/job_internal.h"

static bool is_usable(const imk_record_source *source, const imk_triad *triad, int column[3])
{
    for (int i = 0; i < 3; i++) {
        column[i] = imk_record_find(source, IMK_QUANTITY_MAGNETIC, i);
        if (column[i] < 0 || imk_dimension_equal(source->columns[column[i]].unit.dimension,
                                                 imk_unit_of("count").dimension))
            return false;
    }
    return triad->axis_count == 3 && triad->sensitivity.value[0] == 0;
}

void imki_magnetic_start(const imk_record_source *source, imk_compensate_log *log,
                         imki_magnetic *magnetic)
{
    imk_triad *triad = &log->model.mag;
    imk_matrix3 a;
    bool there = false;
    for (size_t k = 0; k < source->column_count; k++)
        there = there || source->columns[k].quantity == IMK_QUANTITY_MAGNETIC;
    magnetic->present = false;
    if (!triad->present && there)
        imki_find(&log->findings, IMK_FINDING_WARNING, "not_in_model", NULL, IMKI_NUMBERS(IMK_MAG));
    if (triad->present && there) {
        for (int i = 0; i < 9; i++)
            a.m[i / 3][i % 3] =
                (1 + triad->scale_factor.fixed.value[i / 3]) * triad->direction[i / 3][i % 3] +
                triad->misalignment.value[i / 3][i % 3] + triad->cross_axis.value[i / 3][i % 3];
        magnetic->present = is_usable(source, triad, magnetic->column) &&
                            imk_matrix3_inverse(a, &magnetic->inverse) == IMK_OK;
        if (!magnetic->present)
            imki_find(&log->findings, IMK_FINDING_WARNING, "magnetometer_left", NULL, 0, NULL);
    }
    for (int i = 0; i < 3; i++)
        magnetic->bias[i] = triad->bias.fixed.value[i];
    triad->present = magnetic->present;
}

void imki_magnetic_correct(const imki_magnetic *magnetic, size_t begin, size_t end,
                           double *const *data)
{
    for (size_t r = begin; magnetic->present && r < end; r++) {
        imk_vector3 m;
        for (int i = 0; i < 3; i++)
            m.v[i] = data[magnetic->column[i]][r] - magnetic->bias[i];
        m = imk_matrix3_apply(magnetic->inverse, m);
        for (int i = 0; i < 3; i++)
            data[magnetic->column[i]][r] = m.v[i];
    }
}
