/* SPDX-License-Identifier: Apache-2.0 */
/* Which poses are missing: those that would tell most about the accelerometers, given the rests
 * that were found in the log. */
#include "calibrate_internal.h"

#include "base/algebra/vector_internal.h"
#include "jobs/arena_internal.h"

#include <math.h>

/* What a mean at rest is worth [m/s^2]; only what poses are worth against one another matters. */
static const double pose_sigma = 1e-3;

/* The rests as observations of gravity; false for a log whose accelerometers are no triad, or whose
 * readings no unit is known of. */
static bool observe_rests(const imk_calibrate_log *b, const imk_calibrate_record *log,
                          imk_calibration *c)
{
    const double gravity = b->calibration->gravity;
    if (log->record.axis_count[1] != 3 || log->record.counts[1] || log->interval_count == 0)
        return false;
    for (size_t k = 0; k < log->interval_count; k++) {
        const double *mean = log->interval[k].mean[1];
        const double norm = imki_norm3(mean);
        imk_observation o = {
            .knowledge = IMK_INPUT_GRAVITY, .fixture = -1, .temperature = (double)NAN};
        if (!(norm > 0))
            continue;
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            o.reading[0][i] = (double)NAN;
            o.reading[1][i] = i < 3 ? mean[i] * gravity / norm : (double)NAN;
            o.sigma[0][i] = o.sigma[1][i] = pose_sigma;
        }
        for (int i = 0; i < 3; i++)
            o.force[i] = mean[i] * gravity / norm;
        if (imk_calibration_observe(c, &o) < 0)
            return false;
    }
    return c->observation_count > 0;
}

static void free_accelerometers(imk_calibration *c)
{
    for (int axis = 0; axis < 3; axis++) {
        (void)imk_calibration_free(c, 1, IMK_MODEL_BIAS, axis, 0);
        (void)imk_calibration_free(c, 1, IMK_MODEL_SCALE_FACTOR, axis, 0);
        for (int element = axis + 1; element < 3; element++)
            (void)imk_calibration_free(c, 1, IMK_MODEL_MISALIGNMENT, axis, element);
    }
}

static bool find_poses(imk_calibration *c, imki_arena *arena, imk_pose_advice *advice)
{
    imk_error error;
    static const imk_test_record none = {.name = ""};
    c->record[0] = &none;
    c->record_count = 1;
    const size_t size = imk_next_pose_workspace_size(c);
    void *workspace = imki_arena_room(arena, size);
    return workspace && imk_next_pose(c, pose_sigma, IMK_CALIBRATE_POSES, advice, workspace, size,
                                      &error) == IMK_OK;
}

bool imk_calibrate_advise(const imk_calibrate_log *b, const imk_calibrate_record *log,
                          const imk_allocator *allocator,
                          imk_pose_advice advice[IMK_CALIBRATE_POSES])
{
    imki_arena arena = {.blocks = NULL};
    if (allocator)
        arena.allocator = *allocator;
    bool found = false;
    const size_t room = log->interval_count + IMK_CALIBRATE_POSES;
    imk_calibration *c = imki_arena_take(&arena, sizeof *c);
    imk_observation *observation = imki_arena_take(&arena, room * sizeof *observation);
    if (c && observation) {
        imk_calibration_default(c);
        c->gravity = b->calibration->gravity;
        c->observation_capacity = room;
        c->observation = observation;
        free_accelerometers(c);
        found = observe_rests(b, log, c) && find_poses(c, &arena, advice);
    }
    imki_arena_free(&arena);
    return found;
}
