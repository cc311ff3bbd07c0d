/* SPDX-License-Identifier: Apache-2.0 */
/* The list of sources, elements, columns and drivers, as it grows. */
#include "drift_covariance_internal.h"

#include "base/text_internal.h"
#include "imukit/distort.h"

#include <string.h>

static bool same_axis(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_column(const imki_drift_column *a, const imki_drift_column *b)
{
    return a->kind == b->kind && a->sensor == b->sensor && a->axis == b->axis &&
           a->part == b->part && same_axis(a->pendulous, b->pendulous) &&
           same_axis(a->output, b->output);
}

int imki_drift_column_number(imki_drift_plan *plan, const imki_drift_column *column)
{
    for (size_t i = 0; i < plan->column_count; i++)
        if (same_column(&plan->column[i], column))
            return (int)i;
    plan->column[plan->column_count] = *column;
    return (int)plan->column_count++;
}

static int driver_number(imki_drift_plan *plan, const imki_drift_driver *driver)
{
    for (size_t i = 0; i < plan->driver_count; i++)
        if (imki_driver_equal(&plan->driver[i], driver))
            return (int)i;
    plan->driver[plan->driver_count] = *driver;
    return (int)plan->driver_count++;
}

void imki_drift_add_source(imki_drift_plan *plan, const char *first, const char *second,
                           const char *third, const char *text)
{
    const size_t i = plan->source_count++;
    if (!plan->element)
        return;
    imk_drift_source *source = &plan->source[i];
    memset(source, 0, sizeof *source);
    imki_append_text(source->name, sizeof source->name, first);
    imki_append_text(source->name, sizeof source->name, ".");
    imki_append_text(source->name, sizeof source->name, second);
    imki_append_text(source->name, sizeof source->name, third);
    source->text = text;
    const size_t n = plan->states;
    plan->part[i] =
        (imki_drift_part){.first = plan->element_count, .covariance = plan->covariance + i * n * n};
    memset(plan->part[i].covariance, 0, n * n * sizeof *plan->covariance);
}

/* The next element of the source added last. NULL when only counting. */
imki_drift_element *imki_drift_add_element(imki_drift_plan *plan, imki_element_use use,
                                           const imki_drift_column *column,
                                           const imki_drift_driver *driver)
{
    const size_t i = plan->element_count++;
    if (!plan->element)
        return NULL;
    imki_drift_element *element = &plan->element[i];
    memset(element, 0, sizeof *element);
    element->use = use;
    element->column = imki_drift_column_number(plan, column);
    element->driver = driver_number(plan, driver);
    element->x = plan->vector + 3 * i * plan->states;
    for (size_t state = 0; state < 2; state++)
        element->cross[state] = element->x + (1 + state) * plan->states;
    memset(element->x, 0, 3 * plan->states * sizeof *element->x);
    plan->part[plan->source_count - 1].count++;
    return element;
}

void imki_drift_add_constant(imki_drift_plan *plan, imki_element_use use,
                             const imki_drift_column *column, const imki_drift_driver *driver,
                             double first, double second)
{
    imki_drift_element *element = imki_drift_add_element(plan, use, column, driver);
    if (!element)
        return;
    element->state[0] = first;
    element->state[1] = second;
}

void imki_drift_add_noise(imki_drift_plan *plan, imki_element_use use,
                          const imki_drift_column *column, const imki_drift_driver *driver,
                          double variance)
{
    imki_drift_element *element = imki_drift_add_element(plan, use, column, driver);
    if (!element)
        return;
    element->size = variance;
    for (int i = 0; i < 2; i++)
        element->covariance[i][i] = variance * driver->start[i];
}

void imki_drift_omit(imki_drift_plan *plan, const char *name)
{
    if (plan->element)
        plan->omitted[plan->omitted_count++] = name;
}

imki_drift_column imki_drift_column_of(imki_column_kind kind, int sensor, int axis, int part)
{
    return (imki_drift_column){.kind = kind, .sensor = sensor, .axis = axis, .part = part};
}

imki_column_kind imki_drift_own_input(int sensor)
{
    return sensor == IMK_GYRO ? IMKI_COLUMN_RATE : IMKI_COLUMN_FORCE;
}

bool imki_drift_has_any(const double *number, int count)
{
    for (int i = 0; i < count; i++)
        if (number[i] != 0.0)
            return true;
    return false;
}
