/* SPDX-License-Identifier: Apache-2.0 */
/* Which poses are missing: those that would tell most about the accelerometers, given the rests
 * that were found in the log. */
#include "calibrate_parts.h"

#include "imukit/calibration_plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POSES = 3 };

static const double degree = 0.017453292519943295;

/* What a mean at rest is worth [m/s^2]; only what poses are worth against one another matters. */
static const double pose_sigma = 1e-3;

/* The rests as observations of gravity; false for a log whose accelerometers are no triad, or whose
 * readings no unit is known of. */
static bool observe_rests(const bench *b, const bench_log *log, imk_calibration *c)
{
    const double gravity = b->calibration->gravity;
    if (log->record.axis_count[1] != 3 || log->record.counts[1] || log->interval_count == 0)
        return false;
    for (size_t k = 0; k < log->interval_count; k++) {
        const double *mean = log->interval[k].mean[1];
        const double norm = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
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

static bool find_poses(imk_calibration *c, imk_pose_advice advice[POSES])
{
    imk_error error;
    static const imk_test_record none = {.name = ""};
    c->record[0] = &none;
    c->record_count = 1;
    const size_t size = imk_next_pose_workspace_size(c);
    void *workspace = command_memory(NULL, size);
    const bool found =
        imk_next_pose(c, pose_sigma, workspace, size, POSES, advice, &error) == IMK_OK;
    free(workspace);
    return found;
}

static double whole_degrees(double angle)
{
    return floor(angle / degree + 0.5) + 0.0;
}

void bench_advise(const bench *b, const bench_log *log, const char *before, char *text, size_t size)
{
    imk_pose_advice advice[POSES];
    imk_calibration *c = command_zeroed(sizeof *c);
    imk_calibration_default(c);
    c->gravity = b->calibration->gravity;
    c->observation_capacity = log->interval_count + POSES;
    c->observation = command_zeroed(c->observation_capacity * sizeof *c->observation);
    free_accelerometers(c);
    const bool found = observe_rests(b, log, c) && find_poses(c, advice);
    free(c->observation);
    free(c);
    text[0] = '\0';
    if (found)
        snprintf(text, size,
                 "%sroll %.0f pitch %.0f deg, roll %.0f pitch %.0f deg and roll %.0f pitch %.0f "
                 "deg",
                 before, whole_degrees(advice[0].roll), whole_degrees(advice[0].pitch),
                 whole_degrees(advice[1].roll), whole_degrees(advice[1].pitch),
                 whole_degrees(advice[2].roll), whole_degrees(advice[2].pitch));
}
