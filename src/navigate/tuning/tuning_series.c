/* SPDX-License-Identifier: Apache-2.0 */
/* Errors of readings along a window: what each element that is not noise adds to the mean of each
 * sample, by the sensitivities of the drift at each part of it, through the output filter. */
#include "tuning_internal.h"

#include "imukit/elementary.h"

#include <math.h>
#include <string.h>

/* What is filtered away is an error by itself. */
static double filtered(imki_band_limit *limit, size_t parts, bool delay, double *signal)
{
    double before = 0.0, after = 0.0;
    for (size_t j = 0; delay && j < parts; j++)
        before += signal[j];
    if (limit->present)
        imki_limit_band(limit, parts, signal);
    for (size_t j = 0; j < parts; j++)
        after += signal[j];
    return (after - before) / (double)parts;
}

static void state_at(const imki_exposed *exposed, size_t at, imk_motion_state *state)
{
    for (int i = 0; i < 3; i++) {
        state->angular_rate.v[i] = exposed->rate[i][at];
        state->specific_force.v[i] = exposed->force[i][at];
        state->angular_acceleration.v[i] =
            exposed->acceleration[i] ? exposed->acceleration[i][at] : 0.0;
    }
}

/* The mean of what an element is multiplied by, over a row. */
static double mean_factor(imki_tuning_lane *lane, size_t element, const imk_motion_state *state)
{
    double signal[IMK_SUBSTEPS_MAX];
    const size_t parts = lane->exposed.parts;
    const imki_drift_column *column =
        &lane->plan->drift.column[lane->plan->drift.element[element].column];
    const bool delay = column->kind == IMKI_COLUMN_DELAY;
    if (column->kind == IMKI_COLUMN_ONE)
        return 1.0;
    for (size_t j = 0; j < parts; j++)
        signal[j] =
            delay ? (column->sensor == IMK_GYRO ? state[j].angular_rate : state[j].specific_force)
                        .v[column->axis]
                  : imki_drift_factor(column, &state[j]);
    return filtered(&lane->limit[element], parts, delay, signal);
}

/* The output of a driver at this row, and on to the next. */
static double drive(imki_tuning_lane *lane, size_t element)
{
    double *z = lane->driver[element];
    const double now = z[0] - lane->offset[element];
    double(*phi)[2] = lane->plan->element[element].phi;
    const double next[2] = {phi[0][0] * z[0] + phi[0][1] * z[1],
                            phi[1][0] * z[0] + phi[1][1] * z[1]};
    memcpy(z, next, sizeof next);
    return now;
}

void imki_tuning_series(imki_tuning_lane *lane)
{
    imk_motion_state *state = lane->part_state;
    const imki_exposed *exposed = &lane->exposed;
    for (size_t row = 0; row < exposed->rows; row++) {
        for (size_t j = 0; j < exposed->parts; j++)
            state_at(exposed, row * exposed->parts + j, &state[j]);
        for (size_t i = 0; i < lane->plan->drift.element_count; i++)
            if (imki_tuning_has_series(lane->plan, i))
                lane->value[i][row] =
                    drive(lane, i) * mean_factor(lane, i, state) - lane->learned[i];
    }
}

/* ---- the start ---- */

static imk_status start_limits(imki_tuning_lane *lane)
{
    const imki_tuning_plan *plan = lane->plan;
    imk_status status = IMK_OK;
    const double part = plan->h / (double)lane->scene.substeps;
    for (size_t i = 0; i < plan->drift.element_count && status == IMK_OK; i++) {
        const imki_drift_column *column = &plan->drift.column[plan->drift.element[i].column];
        lane->limit[i].present = false;
        if (imki_tuning_has_series(plan, i))
            status = imki_band_limit_start(
                &lane->limit[i], imk_model_triad(lane->model, column->sensor), column->axis, part);
    }
    return status;
}

/* Drivers count from row 0. What is known of slow ones is their mean over n rows. */
static void start_driver(imki_tuning_lane *lane, size_t i, size_t row)
{
    const imki_drift_element *element = &lane->plan->drift.element[i];
    const imki_drift_driver *driver = &lane->plan->drift.driver[element->driver];
    const double h = lane->plan->h, n = (double)lane->plan->bias_samples, at = (double)row;
    const bool delay = lane->plan->drift.column[element->column].kind == IMKI_COLUMN_DELAY;
    double *z = lane->driver[i];
    memcpy(z, element->state, sizeof element->state);
    lane->offset[i] = 0.0;
    if (delay) /* the filter itself, not its delay */
        z[0] = 1.0;
    if (!lane->plan->element[i].slow || lane->plan->element[i].role == IMKI_ROLE_NONE)
        return;
    if (imki_tuning_is_ramp(driver)) {
        z[0] = z[1] * h * (at + 1.0);
        lane->offset[i] = z[1] * h * (at - 0.5 * (n - 1.0));
        return;
    }
    const double time = -1.0 / driver->a[0][0];
    z[0] = element->state[0] * imk_exp(-(at + 0.5) * h / time);
    lane->offset[i] = element->state[0] * imk_exp(-(at - n + 0.5) * h / time) *
                      (imk_expm1(-n * h / time) / (n * imk_expm1(-h / time)));
}

/* Rows of the chunk from `begin` on add to what is learned, but of what is taken against its mean
 * anyway. */
static void add_learned(imki_tuning_lane *lane, size_t first, size_t begin)
{
    const imki_tuning_plan *plan = lane->plan;
    for (size_t i = 0; i < plan->drift.element_count; i++) {
        const imki_drift_element *element = &plan->drift.element[i];
        const bool one = plan->drift.column[element->column].kind == IMKI_COLUMN_ONE;
        for (size_t k = 0; k < lane->exposed.rows && !one && imki_tuning_has_series(plan, i); k++)
            if (first + k >= begin)
                lane->sum[i] += lane->value[i][k];
    }
}

imk_status imki_tuning_series_start(imki_tuning_lane *lane, size_t row)
{
    const size_t learning = lane->settings->learned ? lane->plan->bias_samples : 0;
    const size_t lead = lane->grid->settle + learning;
    const imk_status status = start_limits(lane);
    if (status != IMK_OK)
        return imk_error_set(&lane->error, status, "bandwidth", "",
                             "a bandwidth that fits the sample rate");
    const size_t elements = lane->plan->drift.element_count;
    memset(lane->learned, 0, elements * sizeof *lane->learned);
    memset(lane->sum, 0, elements * sizeof *lane->sum);
    for (size_t i = 0; i < elements; i++)
        start_driver(lane, i, row);
    const size_t most = imki_tuning_rows_at_once(lane->scene.substeps);
    for (size_t first = row + 1 - lead; first <= row; first += lane->exposed.rows) {
        const size_t left = row + 1 - first;
        imki_tuning_expose(&lane->scene, first, left < most ? left : most, &lane->exposed);
        imki_tuning_series(lane);
        add_learned(lane, first, row + 1 - learning);
    }
    for (size_t i = 0; i < elements; i++) {
        start_driver(lane, i, row);
        lane->learned[i] = learning > 0 ? lane->sum[i] / (double)learning : 0.0;
    }
    return IMK_OK;
}
