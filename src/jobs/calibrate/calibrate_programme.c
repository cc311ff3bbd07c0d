/* SPDX-License-Identifier: Apache-2.0 */
/* The programme of a test: what is asked of it, its steps, and how long all of it takes. */
#include "calibrate_internal.h"

#include <math.h>
#include <stdio.h>
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

/* ---- what is asked ----------------------------------------------------------------------------
 */

imk_status imk_calibrate_plan_settings(const imk_calibrate_log *session,
                                       imk_plan_settings *settings, imk_error *error)
{
    const imk_procedure procedure = session->record[0].procedure;
    const imk_procedure_settings *s = &session->record[0].settings;
    if (session->settings.repeatability)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "procedure",
                             "repeatability needs no programme",
                             "record as many power cycles as you can, ten or more");
    if (procedure == IMK_PROCEDURE_MAGNETOMETER)
        return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "procedure",
                             "magnetometer needs no programme",
                             "turn the unit slowly by hand for a minute, so that each of its axes "
                             "points along the field and against it");
    *settings = imk_plan_default(procedure);
    settings->nonlinear = s->nonlinear;
    settings->cross_products = s->cross_products;
    settings->g_sensitivity = s->g_sensitivity;
    settings->placement_sigma = s->placement_sigma;
    settings->fixture_sigma = s->fixture_sigma;
    settings->turn_angle = s->turn_angle;
    if (session->settings.temperature_order != 0)
        settings->temperature_order = session->settings.temperature_order;
    return IMK_OK;
}

static imk_status refuse_requirement(const char *item, const char *expected, imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_SYNTAX, "want", item, expected);
}

/* "accel.scale_factor 50 ppm": every number of the term. */
static imk_status read_requirement(const imk_calibration *c, int order, const char *text,
                                   size_t length, size_t capacity,
                                   imk_sigma_requirement *requirement, size_t *count,
                                   imk_error *error)
{
    char item[160], name[sizeof item], expected[80];
    imk_model_parameter parameter[IMK_CORRELATED_MAX];
    size_t numbers = 0;
    const size_t blank = strspn(text, " ");
    length = length > blank ? length - blank : 0;
    snprintf(item, sizeof item, "%.*s", (int)(length < sizeof item ? length : sizeof item - 1),
             text + blank);
    const size_t named = strcspn(item, " ");
    if (!item[named])
        return refuse_requirement(
            item, "a term and its 1 sigma, such as \"accel.scale_factor 50 ppm\"", error);
    snprintf(name, sizeof name, "%.*s", (int)named, item);
    const imk_status status =
        imk_calibrate_terms(c, order, name, IMK_CORRELATED_MAX, parameter, &numbers, error);
    const char *value = item + named + 1;
    for (size_t k = 0; status == IMK_OK && k < numbers; k++) {
        double sigma, unused;
        size_t values;
        const char *unit = imk_parameter_file_unit(parameter[k]);
        if (imk_quantity_parse(value, value + strlen(value), imk_unit_of(unit).dimension, 1, &sigma,
                               &unused, &values, NULL, NULL) != IMK_OK ||
            !(sigma > 0)) {
            snprintf(expected, sizeof expected, "a positive number with a unit such as %s", unit);
            return refuse_requirement(item, expected, error);
        }
        if (*count == capacity)
            return imk_error_set(error, IMK_ERROR_WORKSPACE, "want", "there are too many numbers",
                                 "name fewer terms");
        requirement[(*count)++] =
            (imk_sigma_requirement){.parameter = parameter[k], .sigma = sigma};
    }
    return status;
}

imk_status imk_calibrate_requirements(const imk_calibration *calibration, int temperature_order,
                                      const char *text, size_t capacity,
                                      imk_sigma_requirement *requirement, size_t *count,
                                      imk_error *error)
{
    imk_status status = IMK_OK;
    *count = 0;
    while (status == IMK_OK && text && *text) {
        const size_t length = strcspn(text, ",");
        status = read_requirement(calibration, temperature_order, text, length, capacity,
                                  requirement, count, error);
        text += length + (text[length] == ',');
    }
    return status;
}

/* ---- the programme ----------------------------------------------------------------------------
 */

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
