/* SPDX-License-Identifier: Apache-2.0 */
/* What each log adds to the problem, and the one estimate of all of them together. */
#include "calibrate_internal.h"

#include <math.h>
#include <string.h>

/* Room for this many observations and turns at first; as many again while that is too little. */
enum { CAPACITY = 1024, CAPACITY_MAX = 1 << 20 };

static imk_status no_memory(imk_error *error)
{
    return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
}

bool imk_procedure_is_known(imk_procedure procedure)
{
    return procedure != IMK_PROCEDURE_MULTIPOSITION && procedure != IMK_PROCEDURE_THERMAL &&
           procedure != IMK_PROCEDURE_MAGNETOMETER;
}

/* Take away the diagnostics whether holds can be found where sections name them: the procedure
 * counts the faces, or turns. */
static void diagnostics_of_named_holds(imk_calibrate_record *log)
{
    enum { FACES = 6 };
    const bool faces =
        log->procedure == IMK_PROCEDURE_SIXPOSITION || log->procedure == IMK_PROCEDURE_FERRARIS;
    if (!(faces && log->record.section_count >= FACES) &&
        !(log->procedure == IMK_PROCEDURE_TURNS && log->record.section_count > 0))
        return;
    size_t kept = 0;
    for (size_t i = 0; i < log->diagnostic_count; i++)
        if (log->diagnostic[i].kind != IMK_DIAGNOSTIC_NEVER_STATIC &&
            log->diagnostic[i].kind != IMK_DIAGNOSTIC_NEVER_MOVES &&
            log->diagnostic[i].kind != IMK_DIAGNOSTIC_FEW_POSES)
            log->diagnostic[kept++] = log->diagnostic[i];
    log->diagnostic_count = kept;
}

/* ---- logs ------------------------------------------------------------------------------------ */

static imk_status find_rests(imk_calibrate_log *b, imk_calibrate_record *log, void *workspace,
                             size_t size, imk_error *error)
{
    enum { INTERVALS = 256 };
    imk_status status;
    for (size_t capacity = INTERVALS;; capacity = log->interval_count) {
        log->interval = imki_arena_take(b->memory, capacity * sizeof *log->interval);
        if (!log->interval)
            return no_memory(error);
        status = imk_static_detect(&log->record, &log->settings.stationary, &b->calibration->model,
                                   log->interval, capacity, &log->interval_count, log->activity,
                                   &log->stationary, workspace, size, error);
        if (status != IMK_OK || log->interval_count <= capacity)
            return status;
    }
}

/* Rests outside the sections that were asked for are none of the test. */
static void keep_labelled(imk_calibrate_record *log)
{
    size_t kept = 0;
    if (log->procedure != IMK_PROCEDURE_MULTIPOSITION || !log->settings.labelled_only)
        return;
    for (size_t k = 0; k < log->interval_count; k++)
        if (log->interval[k].section >= 0)
            log->interval[kept++] = log->interval[k];
    log->interval_count = kept;
}

static void diagnose(const imk_calibrate_log *b, imk_calibrate_record *log)
{
    log->diagnostic_count = imk_record_diagnostics(
        &log->record, &log->stationary, log->interval_count, log->interval, b->calibration->gravity,
        &b->calibration->model, IMK_CALIBRATE_DIAGNOSTICS_MAX, log->diagnostic);
    log->axes_unseen = imk_record_axes_unseen(&log->record, log->interval_count, log->interval,
                                              &b->calibration->model);
    diagnostics_of_named_holds(log);
}

/* Rests that the test lacks. Sections say by themselves what a rest is. */
static void find_lost(const imk_calibrate_log *b, imk_calibrate_record *log)
{
    const bool by_sections = log->record.section && (log->settings.labelled_only ||
                                                     log->procedure != IMK_PROCEDURE_MULTIPOSITION);
    if (log->procedure > IMK_PROCEDURE_SIXPOSITION || by_sections)
        return;
    log->lost_count = imk_static_lost_rests(
        &log->record, &log->settings.stationary, &b->calibration->model, &log->stationary,
        log->interval_count, log->interval, IMK_CALIBRATE_LOST_MAX, log->lost);
}

/* Where it stands still: for the diagnostics, the table of poses and the plot. */
static imk_status detect(imk_calibrate_log *b, imk_calibrate_record *log, imk_error *error)
{
    const size_t size = imk_static_workspace_size(&log->record, &log->settings.stationary);
    void *workspace = imki_resize(&b->job.allocator, NULL, size);
    if (b->settings.activity && !log->record.means)
        log->activity = imki_arena_take(b->memory, log->record.count * sizeof *log->activity);
    if (!workspace || b->memory->failed) {
        imki_resize(&b->job.allocator, workspace, 0);
        return no_memory(error);
    }
    const imk_status status = find_rests(b, log, workspace, size, error);
    imki_resize(&b->job.allocator, workspace, 0);
    if (status == IMK_OK) {
        keep_labelled(log);
        diagnose(b, log);
        find_lost(b, log);
        return IMK_OK;
    }
    /* A log too short for holds may still do for a table. */
    log->interval_count = 0;
    log->axes_unseen = UINT64_MAX;
    log->stationary.window = 0;
    log->activity = NULL;
    return imk_procedure_is_known(log->procedure) && status != IMK_ERROR_MEMORY ? IMK_OK : status;
}

static imk_status grow(imk_calibrate_log *b, imk_error *error)
{
    imk_calibration *c = b->calibration;
    const imk_allocator *allocator = &b->job.allocator;
    const size_t capacity = c->observation_capacity > 0 ? 2 * c->observation_capacity : CAPACITY;
    imk_observation *observation =
        imki_resize(allocator, c->observation, capacity * sizeof *observation);
    if (!observation)
        return no_memory(error);
    c->observation = observation;
    imk_turn *turn = imki_resize(allocator, c->turn, capacity * sizeof *turn);
    if (!turn)
        return no_memory(error);
    c->turn = turn;
    c->observation_capacity = c->turn_capacity = capacity;
    return IMK_OK;
}

static bool wants_room(imk_status status, const imk_error *error, const imk_calibration *c)
{
    return status == IMK_ERROR_WORKSPACE && strcmp(error->field, "workspace") != 0 &&
           c->observation_capacity < CAPACITY_MAX;
}

/* The findings of the thermal procedure, for the table; the problem has been given its part. */
static imk_status look_at_temperature(imk_calibrate_log *b, imk_calibrate_record *log,
                                      imk_error *error)
{
    imk_thermal_settings settings = imk_thermal_default();
    const size_t size = imk_thermal_workspace_size();
    void *workspace = imki_resize(&b->job.allocator, NULL, size);
    imk_thermal_findings *thermal = imki_arena_take(b->memory, sizeof *thermal);
    imk_status status = IMK_ERROR_MEMORY;
    settings.reference_temperature = log->settings.reference_temperature;
    settings.order = log->settings.temperature_order > 0 ? log->settings.temperature_order : -1;
    if (workspace && thermal)
        status = imk_thermal_analyse(&log->record, &settings, &b->calibration->model, thermal,
                                     workspace, size, error);
    else
        (void)no_memory(error);
    imki_resize(&b->job.allocator, workspace, 0);
    if (status == IMK_OK)
        log->thermal = thermal;
    /* Several poses: nothing can be said about each by itself. */
    return status == IMK_ERROR_CONFLICT ? IMK_OK : status;
}

imk_status imki_observe(imk_calibrate_log *b, imk_calibrate_record *log, imk_error *error)
{
    imk_calibration *c = b->calibration;
    imk_status status = detect(b, log, error);
    if (status == IMK_OK && !c->observation)
        status = grow(b, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_procedure_workspace_size(log->procedure, &log->record, &log->settings);
    void *workspace = imki_resize(&b->job.allocator, NULL, size);
    if (!workspace)
        return no_memory(error);
    do
        status = imk_procedure_observe(log->procedure, c, &log->record, &log->settings,
                                       b->settings.estimate != NULL, &log->findings, workspace,
                                       size, error);
    while (wants_room(status, error, c) && grow(b, error) == IMK_OK);
    imki_resize(&b->job.allocator, workspace, 0);
    if (status != IMK_OK)
        return error->status;
    if ((log->stationary.window > 0 || log->record.means) && (b->nominal[0] || b->nominal[1]))
        diagnose(b, log); /* with the sensitivities that were found */
    return log->procedure == IMK_PROCEDURE_THERMAL ? look_at_temperature(b, log, error) : IMK_OK;
}

/* ---- solution -------------------------------------------------------------------------------- */

imk_status imki_solve_once(imk_calibrate_log *b, imk_error *error)
{
    const size_t size = imk_calibration_workspace_size(b->calibration);
    void *workspace = imki_resize(&b->job.allocator, NULL, size);
    imk_calibration_result *result = imki_arena_take(b->memory, sizeof *result);
    imk_status status = IMK_ERROR_MEMORY;
    if (workspace && result)
        status = imk_calibration_solve(b->calibration, result, workspace, size, error);
    else
        (void)no_memory(error);
    imki_resize(&b->job.allocator, workspace, 0);
    if (status != IMK_OK)
        return status;
    b->result = result;
    b->diagnostic_count = imk_solution_diagnostics(b->calibration, result,
                                                   IMK_CALIBRATE_DIAGNOSTICS_MAX, b->diagnostic);
    return IMK_OK;
}
