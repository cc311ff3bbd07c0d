/* SPDX-License-Identifier: Apache-2.0 */
/* One run into one log, and the truth into another. */
#include "shell/job_progress.h"
#include "simulate_parts.h"

/* Counts are of the rate, whatever unit is asked for. */
static int check_counts(const simulate_options *o, const imk_model *model)
{
    const bool gyro = model->gyro.present && model->gyro.sensitivity.value[0] != 0;
    const bool accel = model->accel.present && model->accel.sensitivity.value[0] != 0;
    if (o->increments && (gyro || accel))
        return command_misused("--increments: a model with a sensitivity makes counts, which are "
                               "rates; leave the option out");
    if (o->gyro_unit.scale > 0 && gyro)
        return command_misused("--gyro-unit %s: the model's gyros have a sensitivity and make "
                               "counts; leave the option out",
                               o->gyro_unit.text);
    if (o->accel_unit.scale > 0 && accel)
        return command_misused("--accel-unit %s: the model's accelerometers have a sensitivity "
                               "and make counts; leave the option out",
                               o->accel_unit.text);
    return -1;
}

int simulate_units(const simulate_options *o, const imk_model *model,
                   imk_simulate_log_settings *settings)
{
    settings->increments = o->increments;
    settings->gyro_unit = o->gyro_unit;
    settings->accel_unit = o->accel_unit;
    int code = -1;
    if (o->gyro_unit.scale > 0)
        code = options_check_unit("gyro-unit", &o->gyro_unit,
                                  imk_unit_of(o->increments ? "deg" : "deg/s").dimension);
    if (code < 0 && o->accel_unit.scale > 0)
        code = options_check_unit("accel-unit", &o->accel_unit,
                                  imk_unit_of(o->increments ? "m/s" : "m/s^2").dimension);
    return code < 0 ? check_counts(o, model) : code;
}

int simulate_log(const simulate_options *o, const imk_model *model, const scene *s,
                 const imk_executor *executor, const log_target *target)
{
    imk_error error;
    imk_log_sink log = {
        .path = target->path, .fixed = o->decimals.given, .decimals = (int)o->decimals.value};
    const imk_record_sink sink = imk_log_sink_of(&log);
    job_progress shown = job_progress_begin(NULL);
    const imk_job job = job_progress_job(&shown, executor);
    imk_status status =
        imk_simulate_log_run(model, &s->settings, &sink, target->label, &job, &error);
    job_progress_end(&shown);
    status = imk_log_sink_end(&log, status, &error);
    return status == IMK_OK ? EXIT_DONE : command_error(&error, NULL);
}

int simulate_truth(const simulate_options *o, const imk_model *model, const scene *s,
                   const imk_executor *executor)
{
    imk_error error;
    imk_log_sink log = {.path = o->truth};
    const imk_record_sink sink = imk_log_sink_of(&log);
    job_progress shown = job_progress_begin(NULL);
    const imk_job job = job_progress_job(&shown, executor);
    imk_status status = imk_simulate_truth_run(model, &s->settings, &sink, &job, &error);
    job_progress_end(&shown);
    status = imk_log_sink_end(&log, status, &error);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}
