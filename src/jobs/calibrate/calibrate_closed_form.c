/* SPDX-License-Identifier: Apache-2.0 */
/* --estimator closed-form: a Ferraris session solved without iteration, by the matrices other tools
 * publish. The figures are shown as those of the estimator are; the matrices themselves are in the
 * JSON output. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STRETCHES = 256 };

static double three_digits(double value)
{
    const double step = pow(10, floor(log10(fabs(value))) - 2);
    return step < 1 ? floor(value / step + 0.5) / floor(1 / step + 0.5)
                    : floor(value / step + 0.5) * step;
}

/* Counts without a known sensitivity: one number for the three axes, with the sign of each. */
static void set_nominal(const imk_ferraris_triad *from, imk_triad *to)
{
    const double mean = (from->scale[0] + from->scale[1] + from->scale[2]) / 3;
    for (int i = 0; i < 3; i++)
        to->sensitivity.value[i] = (from->axes[i][i] < 0 ? -1 : 1) * three_digits(mean);
}

static imk_status find(imk_calibrate_log *b, imk_ferraris_stretch *stretch, size_t *count,
                       imk_error *error)
{
    imk_calibrate_record *log = &b->record[0];
    const double gravity = b->calibration->gravity;
    const size_t size =
        imk_procedure_workspace_size(IMK_PROCEDURE_FERRARIS, &log->record, &log->settings);
    void *workspace = imki_resize(&b->job.allocator, NULL, size);
    if (!workspace)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    imk_status status =
        imk_ferraris_stretches(&log->record, &log->settings, &b->calibration->model, gravity,
                               STRETCHES, stretch, count, workspace, size, error);
    imki_resize(&b->job.allocator, workspace, 0);
    if (status == IMK_OK && *count > STRETCHES)
        return imki_fail(&b->findings, error, IMK_ERROR_RANGE, "stretches", NULL,
                         IMKI_NUMBERS(STRETCHES));
    /* The angle is as good as the placements before and after the turn. */
    if (status == IMK_OK)
        status = imk_ferraris_closed_form(
            &log->record, *count, stretch, gravity, log->settings.turn_angle,
            sqrt(2.0) * log->settings.placement_sigma, b->ferraris, error);
    return status;
}

static void state(imk_calibration_result *r, int sensor, int term, int elements)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < elements; j++) {
            double *sigma;
            const imk_model_parameter p = {(uint8_t)sensor, (uint8_t)term, (uint8_t)i, (uint8_t)j};
            const double *value = imk_model_parameter_at(&r->model, p, &sigma);
            if (!value || r->parameter_count == IMK_CORRELATED_MAX)
                continue;
            const size_t k = r->parameter_count++;
            r->parameter[k] = p;
            r->value[k] = *value;
            r->sigma[k] = *sigma;
            r->freedom[k] = HUGE_VAL;
        }
}

/* As a result of the estimator: sigmas to first order, without correlations. */
static void fill_result(imk_calibrate_log *b)
{
    imk_calibration_result *r = b->result;
    r->model = b->calibration->model;
    imk_triad *triad[2] = {&r->model.gyro, &r->model.accel};
    const imk_ferraris_triad *solved[2] = {&b->ferraris->gyro, &b->ferraris->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        if (b->nominal[sensor])
            set_nominal(solved[sensor], triad[sensor]);
    imk_ferraris_to_model(b->ferraris, &r->model);
    for (int sensor = 1; sensor >= 0; sensor--) {
        state(r, sensor, IMK_MODEL_BIAS, 1);
        state(r, sensor, IMK_MODEL_SCALE_FACTOR, 1);
        state(r, sensor, IMK_MODEL_MISALIGNMENT, 3);
    }
    state(r, 0, IMK_MODEL_G_SENSITIVITY, 3);
    for (size_t k = 0; k < r->parameter_count; k++)
        r->covariance[k * r->parameter_count + k] = r->sigma[k] * r->sigma[k];
    r->weakest_parameter[0] = r->weakest_parameter[1] = -1;
    const char *frame = imk_triad_frame_name(IMK_FRAME_REFERENCE);
    snprintf(r->model.gyro_evidence.frame, sizeof r->model.gyro_evidence.frame, "%s", frame);
    snprintf(r->model.accel_evidence.frame, sizeof r->model.accel_evidence.frame, "%s", frame);
}

imk_status imki_closed_form(imk_calibrate_log *b, imk_error *error)
{
    imk_ferraris_stretch stretch[STRETCHES];
    size_t count = 0;
    imk_calibration_result *result = imki_arena_take(b->memory, sizeof *result);
    b->ferraris = imki_arena_take(b->memory, sizeof *b->ferraris);
    if (!b->ferraris || !result)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    b->failed = 0;
    const imk_status status = find(b, stretch, &count, error);
    if (status != IMK_OK)
        return status;
    b->result = result;
    fill_result(b);
    return IMK_OK;
}
