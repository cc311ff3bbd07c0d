/* SPDX-License-Identifier: Apache-2.0 */
/* A programme as a motion: turned to each pose about one axis, held for the time that is measured
 * and the margin, half of it before and half after. A rate is one of motion_script.h: it builds up
 * and dies away besides. A turn of ferraris and of turns is whole and lies between two holds on its
 * face, by which it is recognised. */
#include "plan_internal.h"

#include <math.h>

size_t imk_plan_script_steps(size_t step_count)
{
    return 4 * step_count + 1;
}

static bool is_same_pose(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* What is done in the pose of a step. @return steps put */
static size_t put_step(const imk_plan_settings *settings, const imk_plan_step *s,
                       imk_motion_step *motion_step)
{
    const bool turns = s->action == IMK_PLAN_RATE;
    const bool whole = imki_plan_is_whole_turn(settings, s);
    const double angle = fabs(settings->turn_angle);
    const double before = whole   ? settings->hold_minimum + settings->margin
                          : turns ? 0.5 + 0.5 * settings->margin
                                  : s->duration + settings->margin;
    const imk_motion_step hold = {.kind = IMK_STEP_HOLD, .duration = before};
    size_t count = 0;
    motion_step[count++] = hold;
    if (turns)
        motion_step[count++] =
            (imk_motion_step){.kind = IMK_STEP_ROTATE,
                              .axis = s->axis,
                              .amount = whole ? (s->rate < 0.0 ? -angle : angle)
                                              : s->rate * (s->duration + settings->margin),
                              .rate = fabs(s->rate)};
    if (whole)
        motion_step[count++] = hold;
    return count;
}

imk_status imk_plan_script(const imk_plan_settings *settings, size_t step_count,
                           const imk_plan_step *step, imk_motion_step *motion_step,
                           imk_motion_script *script, imk_error *error)
{
    if (!settings || settings->cookie != IMKI_PLAN_COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "plan_settings", NULL,
                             "start from imk_plan_default()");
    const double level[3] = {0.0, 0.0, 0.0};
    const double *last = level;
    size_t count = 0;
    for (size_t k = 0; k < step_count; k++) {
        const imk_plan_step *s = &step[k];
        if (s->action == IMK_PLAN_FORCE)
            return imk_error_set(error, IMK_ERROR_UNSUPPORTED, "centrifuge", NULL,
                                 "use poses and rates: a motion script has no centrifuge");
        const bool turned = k > 0 && step[k - 1].action == IMK_PLAN_RATE;
        if (turned || !is_same_pose(last, s->angle))
            motion_step[count++] =
                (imk_motion_step){.kind = IMK_STEP_POSE,
                                  .duration = settings->turn_time,
                                  .angle = {s->angle[0], s->angle[1], s->angle[2]}};
        count += put_step(settings, s, motion_step + count);
        last = s->angle;
    }
    *script = imk_motion_script_default();
    script->step_count = count;
    script->step = motion_step;
    return IMK_OK;
}
