/* SPDX-License-Identifier: Apache-2.0 */
/* --estimator closed-form: a Ferraris session solved without iteration, by the matrices other tools
 * publish. The figures are shown as those of the estimator are; the matrices themselves are in the
 * JSON output. */
#include "calibrate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STRETCHES = 256 };

static int check(const bench *b)
{
    const calibrate_options *o = b->options;
    if (b->found->count != 1 || b->found->settings.repeatability ||
        b->found->record[0].procedure != IMK_PROCEDURE_FERRARIS)
        return command_misused("--estimator closed-form: this is for one log of --procedure "
                               "ferraris; the others, and several logs together, are solved by "
                               "maximum likelihood");
    if (o->estimate || o->with || o->without)
        return command_misused("--estimator closed-form: what it finds is fixed; leave --estimate, "
                               "--with and --without out");
    return -1;
}

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

static int find(bench *b, imk_ferraris_stretch *stretch, size_t *count)
{
    imk_error error;
    bench_log *log = &b->found->record[0];
    const size_t size =
        imk_procedure_workspace_size(IMK_PROCEDURE_FERRARIS, &log->record, &log->settings);
    void *workspace = command_memory(NULL, size);
    imk_status status = imk_ferraris_stretches(
        &log->record, &log->settings, &b->found->calibration->model, b->found->calibration->gravity,
        workspace, size, STRETCHES, stretch, count, &error);
    free(workspace);
    if (status == IMK_OK && *count > STRETCHES)
        return command_failed("%s: these are more than %d holds and turns", log->path, STRETCHES);
    /* The angle is as good as the placements before and after the turn. */
    if (status == IMK_OK)
        status = imk_ferraris_closed_form(
            &log->record, *count, stretch, b->found->calibration->gravity, log->settings.turn_angle,
            sqrt(2.0) * log->settings.placement_sigma, b->found->ferraris, &error);
    return status == IMK_OK ? -1 : bench_observe_failed(b, log, &error);
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
static void fill_result(bench *b)
{
    imk_calibration_result *r = b->found->result = command_zeroed(sizeof *r);
    r->model = b->found->calibration->model;
    imk_triad *triad[2] = {&r->model.gyro, &r->model.accel};
    const imk_ferraris_triad *solved[2] = {&b->found->ferraris->gyro, &b->found->ferraris->accel};
    for (int sensor = 0; sensor < 2; sensor++)
        if (b->found->nominal[sensor])
            set_nominal(solved[sensor], triad[sensor]);
    imk_ferraris_to_model(b->found->ferraris, &r->model);
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

int bench_closed_form(bench *b)
{
    imk_ferraris_stretch stretch[STRETCHES];
    size_t count = 0;
    int code = check(b);
    b->found->ferraris = command_zeroed(sizeof *b->found->ferraris);
    if (code < 0)
        code = find(b, stretch, &count);
    if (code < 0)
        fill_result(b);
    return code;
}
