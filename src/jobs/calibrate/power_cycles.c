/* SPDX-License-Identifier: Apache-2.0 */
/* The logs, or the sections of one, are power cycles of a unit that was not moved: how much bias
 * differs from one to the next. Or each is a model, the calibration of a power cycle: bias and
 * scale factor are compared. */
#include "calibrate_internal.h"

#include "jobs/job_internal.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"
#include "imukit/simulate_log.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is left out at both ends of a run, and the shortest run, unless told [s]. */
static const double usual_trim = 0.2, usual_minimum = 1.0;

static double or_usual(double asked, double usual)
{
    return isnan(asked) ? usual : asked;
}

/* Flicker noise that the model states differs from run to run by itself. A run does not show the
 * part that is slower than it: the variance of its mean less the Allan variance at its length. The
 * repeatability of a model comes on top of it. */
static void add_slow_flicker(const imk_calibrate_log *b, const imk_test_record *record,
                             imk_static_interval *run)
{
    const size_t n = run->end - run->begin;
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *triad = imk_model_triad(&b->calibration->model, sensor);
        for (int i = 0; triad->present && n > 0 && i < triad->axis_count; i++) {
            const imk_flicker flicker = {triad->noise.bias_instability.value[i],
                                         triad->noise.bias_instability_correlation_time.value};
            const double slow = imk_flicker_mean_variance(flicker, record->dt, n) -
                                imk_flicker_sampled_allan_variance(flicker, record->dt, n);
            const double scale = record->counts[sensor] ? triad->sensitivity.value[i] : 1.0;
            const double sigma = run->sigma[sensor][i];
            if (flicker.instability > 0.0)
                run->sigma[sensor][i] = sqrt(sigma * sigma + scale * scale * slow);
        }
    }
}

static imk_status take_runs(imk_calibrate_log *b, const imk_calibrate_record *log,
                            imk_static_interval *run, imk_error *error)
{
    size_t count = 0;
    const imk_calibrate_log_settings *s = &b->settings;
    const size_t room = IMK_RUNS_MAX - b->run_count;
    const imk_status status = imk_repeatability_runs(
        &log->record, or_usual(s->trim, usual_trim), or_usual(s->settle, 0),
        or_usual(s->minimum, usual_minimum), room, run + b->run_count, &count, error);
    if (status != IMK_OK)
        return status;
    if (count > room)
        return imki_fail(&b->findings, error, IMK_ERROR_RANGE, "many_runs", NULL,
                         IMKI_NUMBERS(IMK_RUNS_MAX));
    for (size_t k = 0; k < count; k++)
        add_slow_flicker(b, &log->record, &run[b->run_count + k]);
    b->run_count += count;
    return IMK_OK;
}

static imk_status compare_holds(imk_calibrate_log *b, const imk_static_interval *run,
                                imk_error *error)
{
    const bool *counts = b->record[0].record.counts;
    b->failed = b->count;
    if (b->run_count < 2)
        return imki_fail(&b->findings, error, IMK_ERROR_TOO_SHORT, "few_runs", NULL,
                         IMKI_NUMBERS((double)b->run_count));
    const imk_status status =
        imk_repeatability_of_holds(&b->calibration->model, counts, b->run_count, run,
                                   or_usual(b->settings.placement, 0), 0.95, b->runs, error);
    /* Biases differ by some milli-g, which is as many milliradians; hardly by more. */
    if (status == IMK_OK && b->runs->attitude > 10e-3 && isnan(b->settings.placement))
        imki_find(&b->findings, IMK_FINDING_WARNING, "attitude", NULL,
                  IMKI_NUMBERS(b->runs->attitude * 1e3));
    if (status == IMK_ERROR_UNIT_MISSING)
        b->failed = 0;
    return status;
}

imk_status imki_compare_runs(imk_calibrate_log *b, imk_error *error)
{
    imk_static_interval *run = imki_resize(&b->job.allocator, NULL, IMK_RUNS_MAX * sizeof *run);
    imk_status status = IMK_OK;
    b->runs = imki_arena_take(b->memory, sizeof *b->runs);
    if (!run || !b->runs)
        status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (size_t k = 0; status == IMK_OK && k < b->count; k++) {
        b->failed = k;
        status = take_runs(b, &b->record[k], run, error);
    }
    if (status == IMK_OK)
        status = compare_holds(b, run, error);
    imki_resize(&b->job.allocator, run, 0);
    return status;
}

/* ---- models ---------------------------------------------------------------------------------- */

/* Degrees of freedom of a sigma, from the 95 % interval beside it: Student's quantile is their
 * ratio. Both are rounded in a file, so that what is nearly normal counts as normal. */
static double freedom_of(const imk_evidence *evidence, const char *key, int axis, double sigma)
{
    for (int k = 0; k < evidence->interval_count; k++) {
        if (strcmp(evidence->interval[k].key, key) != 0)
            continue;
        const double half = 0.5 * (evidence->interval[k].upper.value[axis] -
                                   evidence->interval[k].lower.value[axis]);
        double low = 1, high = 200;
        if (!(half > imk_student_quantile(0.975, high) * sigma))
            return HUGE_VAL;
        for (int step = 0; step < 40; step++) {
            const double middle = sqrt(low * high);
            if (imk_student_quantile(0.975, middle) * sigma > half)
                low = middle;
            else
                high = middle;
        }
        return low;
    }
    return HUGE_VAL;
}

static void state(imk_calibration_result *r, int sensor, int term, int axis, double value,
                  double sigma, double freedom)
{
    const size_t k = r->parameter_count++;
    r->parameter[k] = (imk_model_parameter){(uint8_t)sensor, (uint8_t)term, (uint8_t)axis, 0};
    r->value[k] = value;
    r->sigma[k] = sigma;
    r->freedom[k] = freedom;
}

/* Bias and scale factor of a model with their sigmas, as the calibration of a run; of counts by the
 * sensitivities and zeros of the first one, since each may have found its own. */
static void calibration_of(const imk_model *model, const imk_model *first,
                           imk_calibration_result *r)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *t = imk_model_triad(model, sensor);
        const imk_triad *f = imk_model_triad(first, sensor);
        const imk_evidence *evidence = sensor == 0 ? &model->gyro_evidence : &model->accel_evidence;
        for (int axis = 0; t->present && axis < t->axis_count; axis++) {
            const double nominal = f->sensitivity.value[axis];
            const bool counts = nominal != 0;
            const double ratio = counts ? t->sensitivity.value[axis] / nominal : 1;
            const double shift =
                counts ? (t->zero_offset.value[axis] - f->zero_offset.value[axis]) / nominal : 0;
            const double bias = t->bias.fixed.sigma[axis];
            const double scale = t->scale_factor.fixed.sigma[axis];
            if (bias > 0)
                state(r, sensor, IMK_MODEL_BIAS, axis, ratio * t->bias.fixed.value[axis] + shift,
                      fabs(ratio) * bias, freedom_of(evidence, "bias.fixed", axis, bias));
            if (scale > 0)
                state(r, sensor, IMK_MODEL_SCALE_FACTOR, axis,
                      ratio * (1 + t->scale_factor.fixed.value[axis]) - 1, fabs(ratio) * scale,
                      freedom_of(evidence, "scale_factor.fixed", axis, scale));
        }
    }
}

/* The same axes, counts where the first has counts, one frame. */
static imk_status check_alike(imk_calibrate_log *b, const imk_model *model, const imk_model *first,
                              const char *const names[2], imk_error *error)
{
    char words[96];
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *t = imk_model_triad(model, sensor);
        const imk_triad *f = imk_model_triad(first, sensor);
        const char *frame = (sensor == 0 ? &model->gyro_evidence : &model->accel_evidence)->frame;
        const char *other = (sensor == 0 ? &first->gyro_evidence : &first->accel_evidence)->frame;
        snprintf(words, sizeof words, "%s\t%.70s", imki_sensor_titles[sensor], names[0]);
        if (t->present != f->present || (t->present && t->axis_count != f->axis_count))
            return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "models_of_units", words, 0,
                             NULL);
        if (t->present && (t->sensitivity.value[0] != 0) != (f->sensitivity.value[0] != 0))
            return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "models_of_counts", words, 0,
                             NULL);
        snprintf(words, sizeof words, "%s\t%s", other, frame);
        if (strcmp(frame, other) != 0)
            return imki_fail(&b->findings, error, IMK_ERROR_CONFLICT, "models_of_frames", words, 0,
                             NULL);
    }
    return IMK_OK;
}

/* The axes of the first model, as those of a record: what a model known before is checked against.
 */
static void take_axes(imk_calibrate_log *b, const imk_model *first)
{
    for (size_t k = 0; k < b->count; k++)
        for (int sensor = 0; sensor < 2; sensor++) {
            const imk_triad *triad = imk_model_triad(first, sensor);
            b->record[k].record.axis_count[sensor] = triad->present ? triad->axis_count : 0;
            imk_triad_axes(triad, b->record[k].body_axis[sensor]);
        }
}

static imk_status take_model(imk_calibrate_log *b, const imk_model *model, const imk_model *first,
                             const char *name, const char *first_name,
                             imk_calibration_result *result, imk_error *error)
{
    const char *const names[2] = {first_name, name};
    imk_calibrate_record *record = &b->record[b->failed];
    record->path = name;
    record->record.name = imki_record_name(name);
    calibration_of(model, first, result);
    if (result->parameter_count == 0)
        return imki_fail(&b->findings, error, IMK_ERROR_EMPTY, "model_without_sigma", NULL, 0,
                         NULL);
    return check_alike(b, model, first, names, error);
}

static imk_status compare(imk_calibrate_log *b, const imk_calibration_result *const *run,
                          imk_error *error)
{
    b->failed = b->count;
    if (b->count < 2)
        return imki_fail(&b->findings, error, IMK_ERROR_TOO_SHORT, "one_model", NULL, 0, NULL);
    const imk_status status =
        imk_repeatability_of_calibrations(b->count, run, 0.95, b->runs, error);
    if (status != IMK_OK)
        return status;
    if (b->runs->axis_count[0] == 0 && b->runs->axis_count[1] == 0)
        return imki_fail(&b->findings, error, IMK_ERROR_EMPTY, "no_uncertainty", NULL, 0, NULL);
    b->run_count = b->count;
    imki_calibrate_model(b);
    return IMK_OK;
}

imk_status imk_calibrate_log_compare(imk_calibrate_log *b, const imk_model *const *model,
                                     const char *const *name, imk_error *error)
{
    const imk_calibration_result *run[IMK_TEST_RECORDS_MAX];
    imk_calibration_result *result =
        imki_resize(&b->job.allocator, NULL, b->count * sizeof *result);
    imk_status status = IMK_OK;
    b->runs = imki_arena_take(b->memory, sizeof *b->runs);
    if (!result || !b->runs)
        status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    for (size_t k = 0; status == IMK_OK && k < b->count; k++) {
        run[k] = memset(&result[k], 0, sizeof result[k]);
        b->failed = k;
        status = take_model(b, model[k], model[0], name[k], name[0], &result[k], error);
    }
    if (status == IMK_OK) {
        take_axes(b, model[0]);
        status = imki_know_before(b, error);
    }
    if (status == IMK_OK)
        status = compare(b, run, error);
    imki_resize(&b->job.allocator, result, 0);
    return status;
}
