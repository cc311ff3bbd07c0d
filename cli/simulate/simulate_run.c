/* SPDX-License-Identifier: Apache-2.0 */
/* One run into one log, many into a directory, and the truth and the aids into other logs. */
#include "shell/aid_text.h"
#include "shell/job_progress.h"
#include "simulate_parts.h"

#include "imukit/thread_pool.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

/* Units of the columns. @return -1 or the exit code */
static int choose_units(const simulate_options *o, const imk_model *model,
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

/* One run of the scene into one file; the progress says `label`, "run 3 (4 of 20)".
 * @return the exit code, the message printed */
static int simulate_log(const simulate_options *o, const imk_model *model, const scene *s,
                        const imk_executor *executor, const char *path, const char *label)
{
    imk_error error;
    imk_log_sink log = {
        .path = path, .fixed = o->decimals.given, .decimals = (int)o->decimals.value};
    const imk_record_sink sink = imk_log_sink_of(&log);
    job_progress shown = job_progress_begin(NULL);
    const imk_job job = job_progress_job(&shown, executor);
    imk_status status = imk_simulate_log_run(model, &s->settings, &sink, label, &job, &error);
    job_progress_end(&shown);
    status = imk_log_sink_end(&log, status, &error);
    return status == IMK_OK ? EXIT_DONE : command_error(&error, NULL);
}

/* What perfect sensors would have read, and where the unit was. @return -1 or the exit code */
static int simulate_truth(const simulate_options *o, const imk_model *model, const scene *s,
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

/* What other instruments read. @return -1 or the exit code */
static int simulate_aids(const simulate_options *o, const imk_model *model, const scene *s)
{
    imk_aid aid[IMK_AIDS_MAX];
    size_t count = 0;
    double arm[3] = {0}, arm_sigma[3] = {0};
    int code = aid_text_parse("aid", o->aid, &count, aid);
    if (code < 0 && o->aid_lever_arm)
        code = aid_arm_parse("aid-lever-arm", o->aid_lever_arm, arm, arm_sigma);
    if (code >= 0)
        return code;
    for (size_t k = 0; k < count; k++) {
        aid[k].interval = isnan(o->aid_rate) ? 1.0 : 1.0 / o->aid_rate;
        aid[k].from = 0.0;
        aid[k].until = isnan(o->aid_until) ? (double)INFINITY : o->aid_until;
        if (aid[k].kind == IMK_AID_ODOMETER)
            continue;
        memcpy(aid[k].lever_arm, arm, sizeof arm);
        memcpy(aid[k].lever_arm_sigma, arm_sigma, sizeof arm_sigma);
    }
    imk_error error;
    imk_log_sink log = {.path = o->aid_output, .fixed = true};
    const imk_record_sink sink = imk_log_sink_of(&log);
    imk_status status = imk_simulate_aids_run(model, &s->settings, count, aid, &sink, NULL, &error);
    status = imk_log_sink_end(&log, status, &error);
    return status == IMK_OK ? -1 : command_error(&error, NULL);
}

/* One log per run, DIR/run_000.csv and so on. */
static int simulate_runs(const simulate_options *o, const imk_model *model, scene *s,
                         const imk_executor *executor)
{
    const size_t length = strlen(o->output);
    for (uint64_t i = 0; i < o->runs.value; i++) {
        char path[4096], label[64];
        const uint64_t number = o->run.value + i;
        int written = snprintf(path, sizeof path, "%s%srun_%03llu.%s", o->output,
                               o->output[length - 1] == '/' ? "" : "/", (unsigned long long)number,
                               o->format ? o->format : "csv");
        if (written < 0 || (size_t)written >= sizeof path)
            return command_failed("%s: the name is too long", o->output);
        snprintf(label, sizeof label, "run %llu (%llu of %llu)", (unsigned long long)number,
                 (unsigned long long)i + 1, (unsigned long long)o->runs.value);
        s->settings.simulation.run = (uint32_t)number;
        int code = simulate_log(o, model, s, executor, path, label);
        if (code != EXIT_DONE)
            return code;
    }
    return EXIT_DONE;
}

static int write_logs(const simulate_options *o, const imk_model *model, scene *s,
                      const imk_executor *executor)
{
    /* A truth that cannot be written is known before the logs are made. */
    int code = o->truth ? simulate_truth(o, model, s, executor) : -1;
    if (code < 0 && o->aid)
        code = simulate_aids(o, model, s);
    if (code >= 0)
        return code;
    if (o->runs.given)
        return simulate_runs(o, model, s, executor);
    return simulate_log(o, model, s, executor, o->output ? o->output : "-", "simulating");
}

int simulate_logs(const simulate_options *o, const imk_model *model, scene *s)
{
    int code = choose_units(o, model, &s->settings);
    const bool made = code < 0 && o->runs.given && mkdir(o->output, 0777) == 0;
    if (code < 0 && o->runs.given && !made && errno != EEXIST)
        code = command_failed("%s: %s", o->output, strerror(errno));
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o->threads.value);
        imk_executor executor = imk_thread_pool_executor(pool);
        code = write_logs(o, model, s, &executor);
        imk_thread_pool_destroy(pool);
    }
    if (made && code != EXIT_DONE)
        (void)rmdir(o->output); /* it stays when a log is in it */
    return code;
}
