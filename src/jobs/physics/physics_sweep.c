/* SPDX-License-Identifier: Apache-2.0 */
/* What the experiments of a laboratory say of an instrument, beside its closed forms. */
#include "physics_log_internal.h"

#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"

#include <math.h>

static const double sigmas_allowed = 4, part_allowed = 0.1;

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
    settings.surroundings.temperature = s->input.exposure.temperature;
    if (!s->physics.noise)
        settings.record = 0;
    imki_arena arena = {.allocator = job->allocator};
    const size_t size = imk_laboratory_workspace_size(&settings);
    void *workspace = imki_arena_take(&arena, size > 256 ? size : 256);
    imk_model *reduced = imki_arena_take(&arena, sizeof *reduced);
    imk_physics_sweep *made = imki_resize(&job->allocator, NULL, sizeof *made);
    status = imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (workspace && reduced && made)
        status =
            imk_laboratory_run(&settings, job->executor, &made->result, workspace, size, error);
    if (status == IMK_OK) {
        imk_instrument_reduce(s->instrument, s->design, reduced);
        made->allocator = job->allocator;
        made->count = imk_laboratory_figures(reduced, s->instrument->sensor, made->computed);
        (void)imk_laboratory_figures(&made->result.model, s->instrument->sensor, made->found);
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

const char *imk_physics_sweep_verdict(const imk_physics_sweep *sweep, size_t index)
{
    const imk_laboratory_figure *computed = &sweep->computed[index], *found = &sweep->found[index];
    const double difference = fabs(found->value - computed->value);
    const double sigma = hypot(found->sigma, computed->sigma);
    if (isnan(found->value) || (found->value == 0 && found->sigma == 0))
        return "not measured";
    if (difference <= sigmas_allowed * sigma)
        return "agrees";
    if (difference <= part_allowed * fabs(computed->value))
        return "close";
    return "differs";
}
