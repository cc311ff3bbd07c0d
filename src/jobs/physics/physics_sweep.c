/* SPDX-License-Identifier: Apache-2.0 */
/* What the experiments of a laboratory say of an instrument, beside its closed forms. */
#include "physics_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include "imukit/readable.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

static bool tell(void *context, const char *stage, uint64_t done, uint64_t total)
{
    return imki_job_progress(context, stage, "points", done, total, NULL) == IMK_OK;
}

static void compare(const imk_model *reduced, int sensor, imk_physics_sweep *s)
{
    const imk_triad *t = sensor == IMK_GYRO ? &reduced->gyro : &reduced->accel;
    s->count = imk_laboratory_figures(reduced, sensor, s->computed);
    (void)imk_laboratory_figures(&s->result.model, sensor, s->found);
    for (size_t i = 0; i < s->count; i++)
        s->verdict[i] = imk_laboratory_compare(&s->computed[i], &s->found[i], s->result.matters[i],
                                               &s->result.effort[i]);
    s->gain_bandwidth = t->bandwidth.value[0];
    s->gain_damping = t->damping.value[0];
}

/* Half a second at 1 g along each axis and between two, one after another: a suspension that does
 * not carry it is not in the closed forms. */
static void tell_event(const imk_physics_log_settings *s, void *state, imk_findings *findings)
{
    static const double directions[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0.7072, 0.7072}};
    const imk_instrument *instrument = s->instrument;
    imk_physics_settings settings = s->physics;
    imk_instrument_event event;
    bool happened = false;
    if (s->quick)
        settings.level = IMK_LEVEL_SLOW;
    settings.noise = false;
    for (size_t i = 0; i < 4 && instrument->happened && !happened; i++) {
        imk_exposure exposure = s->input.exposure;
        double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
        for (int k = 0; k < 3; k++)
            exposure.specific_force[k] = 9.80665 * directions[i][k];
        if (imk_instrument_init(instrument, s->design, &settings, state, NULL) != IMK_OK)
            return;
        for (double time = 0; time < 0.5; time += 1 / settings.rate)
            instrument->step(state, &exposure, outputs);
        happened = instrument->happened(state, &event);
    }
    if (happened)
        imki_find(findings, IMK_FINDING_WARNING, event.code, event.name, event.count, event.number);
}

/* At which bias and scale factor of the closed forms are stated; that of the settings where they do
 * not depend on it. */
static double reference_temperature(const imk_model *reduced, int sensor, double otherwise)
{
    const imk_triad *t = sensor == IMK_GYRO ? &reduced->gyro : &reduced->accel;
    return t->bias.temperature.order > 0           ? t->bias.temperature.reference
           : t->scale_factor.temperature.order > 0 ? t->scale_factor.temperature.reference
                                                   : otherwise;
}

imk_status imk_physics_sweep_run(const imk_physics_log_settings *s, const imk_job *job,
                                 imk_physics_sweep **sweep, imk_error *error)
{
    imk_status status = imki_physics_check(sweep, s, error);
    if (!sweep)
        return status;
    *sweep = NULL;
    if (status != IMK_OK)
        return status;
    job = imki_job_of(job);
    imk_laboratory settings = imk_laboratory_default();
    settings.instrument = s->instrument;
    settings.design = s->design;
    settings.physics = s->physics;
    settings.longest = s->duration > 0 ? s->duration : 0;
    settings.quick = s->quick;
    settings.progress = tell;
    settings.progress_context = (void *)(uintptr_t)job;
    if (!s->physics.noise)
        settings.record = 0;
    imki_arena arena = {.allocator = job->allocator};
    const size_t size = imk_laboratory_workspace_size(&settings);
    const size_t least = s->instrument->state_size > 256 ? s->instrument->state_size : 256;
    void *workspace = imki_arena_take(&arena, size > least ? size : least);
    imk_model *reduced = imki_arena_take(&arena, sizeof *reduced);
    imk_physics_sweep *made = imki_resize(&job->allocator, NULL, sizeof *made);
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (workspace && reduced && made) {
        made->findings = (imk_findings){0};
        tell_event(s, workspace, &made->findings);
        settings.tumble = made->findings.count == 0;
        imk_instrument_reduce(s->instrument, s->design, reduced);
        settings.surroundings.temperature =
            reference_temperature(reduced, s->instrument->sensor, s->input.exposure.temperature);
        status =
            imk_laboratory_run(&settings, job->executor, &made->result, workspace, size, error);
    }
    if (status == IMK_OK) {
        made->allocator = job->allocator;
        compare(reduced, s->instrument->sensor, made);
    } else {
        imki_resize(&job->allocator, made, 0);
        made = NULL;
    }
    *sweep = made;
    imki_arena_free(&arena);
    return status;
}

void imk_physics_sweep_free(imk_physics_sweep *sweep)
{
    if (sweep)
        imki_resize(&sweep->allocator, sweep, 0);
}

/* Up to whole days, hours or minutes, of which there are two or more. */
static double rounded_up(double seconds)
{
    const double unit = seconds > 2 * 86400.0 ? 86400.0
                        : seconds > 2 * 3600  ? 3600.0
                        : seconds > 120       ? 60.0
                                              : 1.0;
    return seconds < 10 ? seconds : unit * ceil(seconds / unit);
}

const char *imk_physics_sweep_verdict(const imk_physics_sweep *sweep, size_t index, char *text,
                                      size_t size)
{
    const imk_laboratory_effort *effort = &sweep->result.effort[index];
    const char *word = imk_laboratory_verdict_text(sweep->verdict[index]);
    char length[60];
    if (sweep->verdict[index] != IMK_LABORATORY_CANNOT_TELL) {
        snprintf(text, size, "%s", word);
    } else if (effort->limit) {
        snprintf(text, size, "%s: %s", word, effort->limit);
    } else {
        imk_readable_duration(rounded_up(effort->needs), length, sizeof length);
        snprintf(text, size, "%s: needs %s", word, length);
    }
    return text;
}
