/* SPDX-License-Identifier: Apache-2.0 */
/* Runs an instrument into a log, and its internal signals into another; or its experiments. */
#include "physics_parts.h"
#include "shell/job_progress.h"

#include "imukit/thread_pool.h"

#include <math.h>
#include <string.h>

/* The slow level, where it is not slow as well. */
static void suggest_level(const physics *p, imk_error *error)
{
    imk_physics_settings slow = p->settings.physics;
    slow.level = IMK_LEVEL_SLOW;
    const double step = p->settings.instrument->step_length(p->settings.design, &slow);
    const size_t length = strlen(error->expected);
    if (p->options->level != 1 && p->options->step == 0 &&
        p->settings.duration <= IMK_PHYSICS_STEPS * step)
        snprintf(error->expected + length, sizeof error->expected - length,
                 ", or add --level slow");
}

int physics_refused(const physics *p, imk_error *error)
{
    const bool is_file = strcmp(p->source, p->settings.instrument->name) != 0;
    imk_design_error_in_units(p->settings.instrument, p->settings.design, error);
    if (strcmp(error->field, "step") == 0) {
        snprintf(error->field, sizeof error->field, "--step");
    } else if (strcmp(error->field, "rate") == 0) {
        snprintf(error->field, sizeof error->field, "--output-rate");
    } else if (strcmp(error->field, "duration") == 0) {
        /* a view has a duration of its own */
        const bool is_run = !isnan(p->options->duration);
        snprintf(error->field, sizeof error->field, is_run ? "--duration" : "");
        if (is_run)
            suggest_level(p, error);
    } else if (strcmp(error->field, "level") == 0) {
        snprintf(error->field, sizeof error->field, "--level");
    }
    return command_error(error, is_file && error->field[0] != '-' ? p->source : NULL);
}

static int check(const physics *p)
{
    const physics_options *o = p->options;
    const double rate = p->settings.physics.rate;
    if (imk_physics_rows(&p->settings, rate) < 1)
        return command_misused("--duration %g s: shorter than a sample of %g s", o->duration,
                               1 / rate);
    if (o->signals && p->settings.instrument->signal_count == 0)
        return command_misused("--signals: the %s has no internal signals to write",
                               p->settings.instrument->title);
    return -1;
}

static void warn(const imk_findings *findings)
{
    char text[300];
    for (size_t i = 0; i < findings->count; i++) {
        const imk_finding *f = &findings->item[i];
        imk_finding_text(f, text, sizeof text);
        if (f->level == IMK_FINDING_WARNING)
            command_warn(imk_finding_code(f), "%s", text);
    }
}

/* Errors are reported with the names of the options. */
static int tell(const physics *p, const imk_physics_log *run, imk_status status, imk_error *error)
{
    const imk_finding *failure = run ? imk_findings_failure(&run->findings) : NULL;
    char text[300];
    if (run)
        warn(&run->findings);
    if (failure)
        imk_finding_text(failure, text, sizeof text);
    if (status == IMK_OK)
        return -1;
    if (!failure)
        return physics_refused(p, error);
    return strcmp(failure->code, "not_written") == 0
               ? command_error(error, NULL)
               : command_failed_by(imk_finding_code(failure), error, NULL, "%s", text);
}

int physics_run_make(const physics *p, imk_physics_log **run)
{
    const physics_options *o = p->options;
    const bool to_output = o->output || (!o->json && !o->report && !o->plot && !o->signals);
    imk_log_sink log = {.path = o->output ? o->output : "-"}, inside = {.path = o->signals};
    const imk_record_sink outputs = imk_log_sink_of(&log), signals = imk_log_sink_of(&inside);
    imk_error error = {.status = IMK_OK}, second = {.status = IMK_OK};
    *run = NULL;
    int code = check(p);
    if (code >= 0)
        return code;
    job_progress shown = job_progress_begin(NULL);
    const imk_job job = job_progress_job(&shown, NULL);
    const imk_status status = imk_physics_log_run(&p->settings, to_output ? &outputs : NULL,
                                                  o->signals ? &signals : NULL, &job, run, &error);
    job_progress_end(&shown);
    const imk_status first = imk_log_sink_end(&log, status, &error);
    const imk_status ended = imk_log_sink_end(&inside, status, &second);
    if (status == IMK_OK && first != IMK_OK)
        return command_error(&error, NULL);
    if (status == IMK_OK && ended != IMK_OK)
        return command_error(&second, NULL);
    return tell(p, *run, status, &error);
}

int physics_sweep_make(const physics *p, imk_physics_sweep **sweep)
{
    imk_error error = {.status = IMK_OK};
    threaded_job job;
    threaded_job_begin(&job, NULL, p->options->threads.value);
    if (p->options->json)
        job.job.progress = NULL;
    const imk_status status = imk_physics_sweep_run(&p->settings, &job.job, sweep, &error);
    threaded_job_end(&job);
    if (status == IMK_OK)
        warn(&(*sweep)->findings);
    return status == IMK_OK ? -1 : physics_refused(p, &error);
}
