/* SPDX-License-Identifier: Apache-2.0 */
/* The programme of a test, and how long all of it takes. */
#include "calibrate_internal.h"

#include <math.h>
#include <string.h>

/* A chamber's rate that a unit follows without large gradients: 1 K/min [K/s]. */
static const double ramp_rate = 1.0 / 60.0;

/* With the ramps between the temperatures; of a motion what its steps take. */
static double programme_length(const imk_calibrate_plan *p)
{
    double length = p->result.duration;
    if (p->script.step_count > 0)
        length = 0;
    for (size_t k = 0; k < p->script.step_count; k++)
        length += imk_motion_step_duration(&p->script, k);
    for (size_t k = 1; k < p->result.step_count && p->settings.procedure == IMK_PROCEDURE_THERMAL;
         k++)
        length += fabs(p->step[k].temperature - p->step[k - 1].temperature) / ramp_rate;
    return length;
}

/* The calibration lends its problem; its room for observations is scratch. */
static imk_status make(imk_calibration *c, imk_calibrate_plan *p, imk_error *error)
{
    const size_t room = p->settings.steps_maximum;
    imki_arena scratch = {.allocator = p->memory->allocator};
    imk_calibration lent = *c;
    imk_status status = IMK_ERROR_MEMORY;
    p->step = imki_arena_take(p->memory, (room + 1) * sizeof *p->step);
    c->observation = imki_arena_take(&scratch, (room + 1) * sizeof *c->observation);
    c->turn = imki_arena_take(&scratch, (room + 1) * sizeof *c->turn);
    c->observation_capacity = c->turn_capacity = room;
    const size_t size = imk_plan_workspace_size(c, &p->settings);
    void *workspace = imki_arena_room(&scratch, size);
    if (p->step && !scratch.failed)
        status = imk_plan_make(c, &p->settings, p->step, &p->result, workspace, size, error);
    else
        (void)imk_error_set(error, status, NULL, NULL, NULL);
    c->observation = lent.observation;
    c->turn = lent.turn;
    c->observation_capacity = lent.observation_capacity;
    c->turn_capacity = lent.turn_capacity;
    imki_arena_free(&scratch);
    return status;
}

static imk_status make_script(imk_calibrate_plan *p, imk_error *error)
{
    const size_t count = imk_plan_script_steps(p->result.step_count) + 1;
    imk_motion_step *steps = imki_arena_take(p->memory, count * sizeof *steps);
    if (!steps)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    if (p->settings.procedure != IMK_PROCEDURE_THERMAL &&
        imk_plan_script(&p->settings, p->result.step_count, p->step, steps, &p->script,
                        &p->unscripted) != IMK_OK)
        p->script.step_count = 0;
    p->duration = programme_length(p);
    return IMK_OK;
}

imk_status imk_calibrate_plan_run(imk_calibration *calibration, const imk_plan_settings *settings,
                                  const imk_job *job, imk_calibrate_plan **plan, imk_error *error)
{
    imki_arena arena = {.blocks = NULL};
    if (job)
        arena.allocator = job->allocator;
    *plan = NULL;
    imk_calibrate_plan *made = imki_arena_take(&arena, sizeof *made);
    imki_arena *memory = imki_arena_take(&arena, sizeof *memory);
    imk_sigma_requirement *requirement =
        imki_arena_take(&arena, (settings->requirement_count + 1) * sizeof *settings->requirement);
    if (arena.failed) {
        imki_arena_free(&arena);
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    }
    if (settings->requirement_count > 0)
        memcpy(requirement, settings->requirement,
               settings->requirement_count * sizeof *requirement);
    made->settings = *settings;
    made->settings.requirement = requirement;
    *memory = arena;
    made->memory = memory;
    imk_status status = make(calibration, made, error);
    if (status == IMK_OK)
        status = make_script(made, error);
    if (status == IMK_OK)
        *plan = made;
    else
        imk_calibrate_plan_free(made);
    return status;
}

void imk_calibrate_plan_free(imk_calibrate_plan *plan)
{
    if (!plan)
        return;
    imki_arena arena = *plan->memory;
    imki_arena_free(&arena);
}
