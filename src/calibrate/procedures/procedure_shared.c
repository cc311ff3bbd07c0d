/* SPDX-License-Identifier: Apache-2.0 */
/* What the procedures share: terms made free, units of readings, figures and words of findings. */
#include "procedure_internal.h"

#include <math.h>
#include <string.h>

int imki_add_fixture(const imki_procedure_call *call)
{
    imk_calibration *c = call->calibration;
    if (!(call->settings->fixture_sigma > 0.0))
        return -1;
    if (c->fixture_count >= IMK_FIXTURES_MAX)
        return -2;
    c->fixture_sigma[c->fixture_count] = call->settings->fixture_sigma;
    return (int)c->fixture_count++;
}

/* Elements of the misalignments or cross-axis terms of accelerometers that a frame leaves free; a
 * symmetric one ties the pairs, so that all have a value. */
static bool frame_leaves(imk_triad_frame frame, int axis, int element)
{
    return frame == IMK_FRAME_UPPER ? element > axis : frame != IMK_FRAME_LOWER || element < axis;
}

imk_status imki_free_term(const imki_procedure_call *call, int sensor, int term, int elements,
                          bool attitudes_known)
{
    imk_calibration *c = call->calibration;
    const imk_triad *triad = imk_model_triad(&c->model, sensor);
    const int axes = c->record[call->record]->axis_count[sensor];
    const bool rows = term == IMK_MODEL_MISALIGNMENT || term == IMK_MODEL_CROSS_AXIS;
    if (call->keep_free)
        return IMK_OK;
    for (int axis = 0; axis < axes; axis++)
        for (int element = 0; element < elements; element++) {
            if (rows && triad->axis_count == 3 && element == axis)
                continue;
            if (rows && sensor == IMK_ACCEL && triad->axis_count == 3 && !attitudes_known &&
                !frame_leaves(c->frame, axis, element))
                continue;
            const imk_status status = imk_calibration_free(c, sensor, term, axis, element);
            if (status == IMK_ERROR_RANGE)
                return imk_error_set(call->error, status, "parameters", NULL,
                                     "at most 64 parameters can be estimated at once");
            if (status != IMK_OK)
                return imk_error_set(call->error, status, "parameters", NULL,
                                     "a term that this sensor has");
        }
    return IMK_OK;
}

double imki_reading_si(const imk_model *model, const imk_test_record *record, int sensor, int axis,
                       double reading)
{
    const imk_triad *triad = imk_model_triad(model, sensor);
    if (!record || !record->counts[sensor])
        return reading;
    return (reading - triad->zero_offset.value[axis]) / triad->sensitivity.value[axis];
}

double imki_counts_per_unit(const imk_model *model, const imk_test_record *record, int sensor,
                            int axis)
{
    return record->counts[sensor] ? imk_model_triad(model, sensor)->sensitivity.value[axis] : 1.0;
}

bool imki_unit_known(const imk_model *model, const imk_test_record *record, int sensor)
{
    for (int i = 0; i < record->axis_count[sensor]; i++)
        if (imki_counts_per_unit(model, record, sensor, i) == 0.0)
            return false;
    return true;
}

double imki_round_digits(double x, int digits)
{
    if (x == 0.0 || !isfinite(x))
        return x;
    double low = 1.0, scale = 1.0;
    while (digits-- > 1)
        low *= 10.0;
    while (fabs(x) * scale < low && scale < 1e300)
        scale *= 10.0;
    if (scale > 1.0)
        return rint(x * scale) / scale;
    while (fabs(x) / scale >= 10.0 * low)
        scale *= 10.0;
    return rint(x / scale) * scale;
}
