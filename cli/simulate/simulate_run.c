/* SPDX-License-Identifier: Apache-2.0 */
/* One run into one log, many into a directory, and the truth and the aids into other logs. */
#include "shell/aid_option.h"
#include "shell/job_progress.h"
#include "simulate_parts.h"

#include "imukit/show.h"
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

/* End a log, or the truth or the aids beside it, and keep what it is. @return the exit code */
static int end_log(const scene *s, const char *key, imk_log_sink *log, imk_status status,
                   imk_error *error)
{
    if (imk_log_sink_end(log, status, error) != IMK_OK)
        return command_error(error, NULL);
    imk_show_written(key, log->path, log->rows, log->column_count, log->column, s->result);
    return EXIT_DONE;
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
    const imk_status status = imk_simulate_log_run(model, &s->settings, &sink, label, &job, &error);
    job_progress_end(&shown);
    return end_log(s, NULL, &log, status, &error);
}

/* What perfect sensors would have read, and where the unit was. @return the exit code */
static int simulate_truth(const simulate_options *o, const imk_model *model, const scene *s,
                          const imk_executor *executor)
{
    imk_error error;
    imk_log_sink log = {.path = o->truth};
    const imk_record_sink sink = imk_log_sink_of(&log);
    job_progress shown = job_progress_begin(NULL);
    const imk_job job = job_progress_job(&shown, executor);
    const imk_status status = imk_simulate_truth_run(model, &s->settings, &sink, &job, &error);
    job_progress_end(&shown);
    return end_log(s, "truth", &log, status, &error);
}

/* What other instruments read. @return the exit code */
static int simulate_aids(const simulate_options *o, const imk_model *model, const scene *s)
{
    imk_aid aid[IMK_AIDS_MAX];
    size_t count = 0;
    double arm[3], arm_sigma[3];
    int code = aid_option_kinds("aid", o->aid, &count, aid);
    if (code < 0 && o->aid_lever_arm)
        code = aid_option_arm("aid-lever-arm", o->aid_lever_arm, arm, arm_sigma);
    if (code >= 0)
        return code;
    for (size_t k = 0; k < count; k++) {
        if (!isnan(o->aid_rate))
            aid[k].interval = 1.0 / o->aid_rate;
        aid[k].from = 0.0;
        if (!isnan(o->aid_until))
            aid[k].until = o->aid_until;
        if (aid[k].kind == IMK_AID_ODOMETER || !o->aid_lever_arm)
            continue;
        memcpy(aid[k].lever_arm, arm, sizeof arm);
        memcpy(aid[k].lever_arm_sigma, arm_sigma, sizeof arm_sigma);
    }
    imk_error error;
    imk_log_sink log = {.path = o->aid_output, .fixed = true};
    const imk_record_sink sink = imk_log_sink_of(&log);
    const imk_status status =
        imk_simulate_aids_run(model, &s->settings, count, aid, &sink, NULL, &error);
    return end_log(s, "aids", &log, status, &error);
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
    int code = EXIT_DONE;
    imk_result_object(s->result, "result");
    if (o->truth)
        code = simulate_truth(o, model, s, executor);
    else
        imk_result_null(s->result, "truth");
    if (code == EXIT_DONE && o->aid)
        code = simulate_aids(o, model, s);
    else
        imk_result_null(s->result, "aids");
    if (code != EXIT_DONE)
        return code;
    imk_result_array(s->result, "logs");
    if (o->runs.given)
        code = simulate_runs(o, model, s, executor);
    else
        code = simulate_log(o, model, s, executor, o->output ? o->output : "-", "simulating");
    imk_result_end(s->result);
    show_judge(s->result, "%llu log%s of %llu samples with every error of the model",
               (unsigned long long)(o->runs.given ? o->runs.value : 1),
               o->runs.given && o->runs.value > 1 ? "s" : "", (unsigned long long)s->settings.rows);
    imk_result_end(s->result);
    return code;
}

int simulate_logs(const simulate_options *o, const imk_model *model, const char *name, scene *s)
{
    int code = choose_units(o, model, &s->settings);
    const bool made = code < 0 && o->runs.given && mkdir(o->output, 0777) == 0;
    if (code < 0 && o->runs.given && !made && errno != EEXIST)
        code = command_failed("%s: %s", o->output, strerror(errno));
    if (code < 0) {
        imk_thread_pool *pool = imk_thread_pool_create(o->threads.value);
        imk_executor executor = imk_thread_pool_executor(pool);
        s->result = show_begin("simulate");
        imk_show_simulate_inputs(&s->settings, name, o->motion, o->temperature,
                                 o->runs.given ? o->runs.value : 1, s->result);
        code = write_logs(o, model, s, &executor);
        imk_thread_pool_destroy(pool);
    }
    if (made && code != EXIT_DONE)
        (void)rmdir(o->output); /* it stays when a log is in it */
    if (code != EXIT_DONE)
        return code;
    imk_result *result = s->result;
    s->result = NULL;
    return show_end(result, &(show_options){.json = o->json, .quiet = true}, code);
}
