/* SPDX-License-Identifier: Apache-2.0 */
/* --procedure repeatability of models, each the calibration of a power cycle: bias and scale factor
 * are compared. */
#include "calibrate_parts.h"

#include "imukit/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool session_has_run_models(const session *b)
{
    if (!b->options->procedure || strcmp(b->options->procedure, "repeatability") != 0)
        return false;
    for (size_t k = 0; k < b->found->count; k++)
        if (imk_is_script_name(b->found->record[k].path))
            return true;
    return false;
}

/* The same axes, counts where the first has counts, one frame. */
static int check_alike(const char *path, const imk_model *model, const char *first_path,
                       const imk_model *first)
{
    for (int sensor = 0; sensor < 2; sensor++) {
        const imk_triad *t = imk_model_triad(model, sensor);
        const imk_triad *f = imk_model_triad(first, sensor);
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

static int load_model(session *b, size_t index, imk_model *first, imk_calibration_result *r)
{
    session_log *log = &b->found->record[index];
    imk_model *model = index == 0 ? first : &r->model;
    if (!imk_is_script_name(log->path))
        return command_misused("--procedure repeatability: %s is a log and others are models: "
                               "calibrate each run first, or give logs only",
                               log->path);
    const int code = command_model(log->path, model, NULL);
    if (code >= 0)
        return code;
    const char *slash = strrchr(log->path, '/');
    log->record.name = slash ? slash + 1 : log->path;
    imk_calibration_of_model(model, first, r);
    if (r->parameter_count == 0)
        return command_failed("%s states no uncertainty of bias or scale factor: give the models "
                              "that imukit calibrate wrote, one of each run",
                              log->path);
    return check_alike(log->path, model, b->found->record[0].path, first);
}

/* The axes of the first model, as those of a log: what --into is checked against. */
static void take_axes(session *b, const imk_model *first)
{
    for (size_t k = 0; k < b->found->count; k++) {
        imk_test_record *record = &b->found->record[k].record;
        record->axis_count[0] = first->gyro.present ? first->gyro.axis_count : 0;
        record->axis_count[1] = first->accel.present ? first->accel.axis_count : 0;
    }
}

int session_compare_models(session *b)
{
    imk_error error;
    imk_calibration_result *result = command_zeroed(b->found->count * sizeof *result);
    const imk_calibration_result *run[IMK_TEST_RECORDS_MAX];
    imk_model *first = command_zeroed(sizeof *first);
    int code = session_choose(b);
    for (size_t k = 0; code < 0 && k < b->found->count; k++) {
        run[k] = &result[k];
        code = load_model(b, k, first, &result[k]);
    }
    if (code < 0) {
        take_axes(b, first);
        code = session_known_before(b);
    }
    if (code < 0)
        code = session_done(b, imk_calibrate_log_compare(b->found, run, &error), &error);
    free(result);
    free(first);
    return code;
}
