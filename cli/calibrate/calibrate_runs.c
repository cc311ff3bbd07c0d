/* SPDX-License-Identifier: Apache-2.0 */
/* --procedure repeatability: the logs, or the sections of one, are power cycles of a unit that was
 * not moved; how much bias differs from one to the next. Or the operands are models, each the
 * calibration of a power cycle: bias and scale factor are compared. */
#include "calibrate_parts.h"

#include "imukit/distributions.h"
#include "imukit/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is left out at both ends of a run, and the shortest run, unless told [s]. */
static const double usual_trim = 0.2, usual_minimum = 1.0;

/* ---- logs ------------------------------------------------------------------------------------ */

static int take_runs(bench *b, const bench_log *log, imk_static_interval *run)
{
    imk_error error;
    size_t count = 0;
    const calibrate_options *o = b->options;
    const size_t room = IMK_RUNS_MAX - b->found->run_count;
    const imk_status status = imk_repeatability_runs(
        &log->record, isnan(o->trim) ? usual_trim : o->trim, isnan(o->settle) ? 0 : o->settle,
        isnan(o->minimum) ? usual_minimum : o->minimum, room, run + b->found->run_count, &count,
        &error);
    if (status != IMK_OK)
        return command_error(&error, log->path);
    if (count > room)
        return command_failed("these are more than %d runs", IMK_RUNS_MAX);
    b->found->run_count += count;
    return -1;
}

static int compare_holds(bench *b, const imk_static_interval *run)
{
    imk_error error;
    const bool counts[2] = {b->found->record[0].record.counts[0],
                            b->found->record[0].record.counts[1]};
    const double attitude = isnan(b->found->settings.placement) ? 0 : b->found->settings.placement;
    if (b->found->run_count < 2)
        return command_failed("%zu run: at least two are needed, better ten; give a log for each "
                              "power cycle, or one log with a column of texts that names the runs "
                              "(--section NAME)",
                              b->found->run_count);
    if (imk_repeatability_of_holds(&b->found->calibration->model, counts, b->found->run_count, run,
                                   attitude, 0.95, b->found->runs, &error) == IMK_OK)
        return -1;
    return error.status == IMK_ERROR_UNIT_MISSING
               ? bench_observe_failed(b, &b->found->record[0], &error)
               : command_error(&error, NULL);
}

int bench_compare_runs(bench *b)
{
    imk_static_interval *run = command_memory(NULL, IMK_RUNS_MAX * sizeof *run);
    int code = -1;
    b->found->runs = command_zeroed(sizeof *b->found->runs);
    for (size_t k = 0; code < 0 && k < b->found->count; k++)
        code = take_runs(b, &b->found->record[k], run);
    if (code < 0)
        code = compare_holds(b, run);
    free(run);
    if (code >= 0)
        return code;
    /* Biases differ by some milli-g, which is as many milliradians; hardly by more. */
    if (b->found->runs->attitude > 10e-3 && isnan(b->found->settings.placement))
        command_warn("attitude",
                     "the forces of the runs differ by up to %.3g mrad: was the unit moved? What a "
                     "change of attitude does to accelerometers looks like a change of bias; keep "
                     "it fixed, or state how well it is put back with --placement 0.1deg",
                     b->found->runs->attitude * 1e3);
    return -1;
}

/* ---- models ---------------------------------------------------------------------------------- */

static bool is_model(const char *path)
{
    return imk_has_ending(path, ".yaml") || imk_has_ending(path, ".yml") ||
           imk_has_ending(path, ".json");
}

bool bench_has_run_models(const bench *b)
{
    if (!b->options->procedure || strcmp(b->options->procedure, "repeatability") != 0)
        return false;
    for (size_t k = 0; k < b->found->count; k++)
        if (is_model(b->found->record[k].path))
            return true;
    return false;
}

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

/* Bias and scale factor with their sigmas; of counts by the sensitivities and zeros of the first
 * model, since each may have found its own nominal ones. */
static void state_model(imk_calibration_result *r, const imk_model *model, const imk_model *first)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *t = sensor == 0 ? &model->gyro : &model->accel;
        const imk_triad *f = sensor == 0 ? &first->gyro : &first->accel;
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
static int check_alike(const char *path, const imk_model *model, const char *first_path,
                       const imk_model *first)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *t = sensor == 0 ? &model->gyro : &model->accel;
        const imk_triad *f = sensor == 0 ? &first->gyro : &first->accel;
        const char *frame = (sensor == 0 ? &model->gyro_evidence : &model->accel_evidence)->frame;
        const char *other = (sensor == 0 ? &first->gyro_evidence : &first->accel_evidence)->frame;
        if (t->present != f->present || (t->present && t->axis_count != f->axis_count))
            return command_failed("%s and %s have not the same %s axes: they are not runs of one "
                                  "unit",
                                  first_path, path, sensor_titles[sensor]);
        if (t->present && (t->sensitivity.value[0] != 0) != (f->sensitivity.value[0] != 0))
            return command_failed("%s and %s: the %s readings are in counts in one and not in the "
                                  "other",
                                  first_path, path, sensor_titles[sensor]);
        if (strcmp(frame, other) != 0)
            return command_failed("%s is in the frame \"%s\", %s in \"%s\": calibrate all runs "
                                  "alike, with the same --frame",
                                  first_path, other, path, frame);
    }
    return -1;
}

static int load_model(bench *b, size_t index, imk_model *first, imk_calibration_result *r)
{
    bench_log *log = &b->found->record[index];
    imk_model *model = index == 0 ? first : &r->model;
    if (!is_model(log->path))
        return command_misused("--procedure repeatability: %s is a log and others are models: "
                               "calibrate each run first, or give logs only",
                               log->path);
    const int code = command_model(log->path, model, NULL);
    if (code >= 0)
        return code;
    const char *slash = strrchr(log->path, '/');
    log->record.name = slash ? slash + 1 : log->path;
    state_model(r, model, first);
    if (r->parameter_count == 0)
        return command_failed("%s states no uncertainty of bias or scale factor: give the models "
                              "that imukit calibrate wrote, one of each run",
                              log->path);
    return check_alike(log->path, model, b->found->record[0].path, first);
}

static int compare_models(bench *b, const imk_calibration_result *const *run)
{
    imk_error error;
    size_t found = 0;
    if (b->found->count < 2)
        return command_failed("1 run: at least two are needed, better ten; give the model of each "
                              "power cycle");
    if (imk_repeatability_of_calibrations(b->found->count, run, 0.95, b->found->runs, &error) !=
        IMK_OK)
        return command_error(&error, NULL);
    for (int sensor = 0; sensor < 2; sensor++)
        found += b->found->runs->axis_count[sensor] > 0;
    if (found == 0)
        return command_failed("no bias and no scale factor is stated with its uncertainty by all "
                              "of these models");
    b->found->run_count = b->found->count;
    return -1;
}

/* The axes of the first model, as those of a log: what --into is checked against. */
static void take_axes(bench *b, const imk_model *first)
{
    for (size_t k = 0; k < b->found->count; k++) {
        imk_test_record *record = &b->found->record[k].record;
        record->axis_count[0] = first->gyro.present ? first->gyro.axis_count : 0;
        record->axis_count[1] = first->accel.present ? first->accel.axis_count : 0;
    }
}

int bench_compare_models(bench *b)
{
    imk_calibration_result *result = command_zeroed(b->found->count * sizeof *result);
    const imk_calibration_result *run[IMK_TEST_RECORDS_MAX];
    imk_model *first = command_zeroed(sizeof *first);
    b->found->runs = command_zeroed(sizeof *b->found->runs);
    int code = bench_choose(b);
    for (size_t k = 0; code < 0 && k < b->found->count; k++) {
        run[k] = &result[k];
        code = load_model(b, k, first, &result[k]);
    }
    if (code < 0) {
        take_axes(b, first);
        code = bench_known_before(b);
    }
    if (code < 0)
        code = compare_models(b, run);
    free(result);
    free(first);
    return code;
}
