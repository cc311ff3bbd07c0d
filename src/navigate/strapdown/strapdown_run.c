/* SPDX-License-Identifier: Apache-2.0 */
/* Many samples of one mechanisation, in blocks. The block under way is carried beside the state;
 * the state reported is that of a completed copy, and tells whether it has been changed since. */
#include "strapdown_block_internal.h"

#include <string.h>

/* Means of the two samples before, from what steps remember of them, and the force now. */
static void enter_history(imk_strapdown *s)
{
    s->block = (imk_strapdown_block){.taken = 0};
    if (!s->has_last || s->differences < 1 || s->last_step != s->step_before[0])
        return;
    const double dt = s->last_step;
    s->block = (imk_strapdown_block){.known = 2, .last_step = dt, .step_before = dt};
    for (int i = 0; i < 3; i++) {
        const double rate = s->last_angle.v[i] / dt, force = s->last_velocity.v[i] / dt;
        const double force_growth = 2.0 * dt * s->velocity_difference[0].v[i];
        s->carried[IMKI_LAST + i] = rate;
        s->carried[IMKI_LAST + 3 + i] = force;
        s->carried[IMKI_BEFORE + i] = rate - 2.0 * dt * s->angle_difference[0].v[i];
        s->carried[IMKI_BEFORE + 3 + i] = force - force_growth;
        s->carried[IMKI_FORCE + i] = force + 0.5 * force_growth;
    }
}

static void enter(imk_strapdown *s)
{
    const double position_low[3] = {s->position_low.v[0], s->position_low.v[1],
                                    s->position_low.v[2]};
    const double attitude_low[4] = {s->attitude_low.w, s->attitude_low.x, s->attitude_low.y,
                                    s->attitude_low.z};
    imki_block_enter(s->carried, 1, &s->state, s->height, s->climb);
    memcpy(s->carried + IMKI_POSITION_LOW, position_low, sizeof position_low);
    memcpy(s->carried + IMKI_ATTITUDE_LOW, attitude_low, sizeof attitude_low);
    enter_history(s);
}

/* What a step after this one needs to know of samples. */
static void leave_history(imk_strapdown *s)
{
    const imk_strapdown_block *b = &s->block;
    const double between = b->last_step + b->step_before;
    for (int i = 0; i < 3; i++) {
        const double rate = s->carried[IMKI_LAST + i], force = s->carried[IMKI_LAST + 3 + i];
        s->last_angle.v[i] = rate * b->last_step;
        s->last_velocity.v[i] = force * b->last_step;
        if (b->known > 1) {
            s->angle_difference[0].v[i] = (rate - s->carried[IMKI_BEFORE + i]) / between;
            s->velocity_difference[0].v[i] = (force - s->carried[IMKI_BEFORE + 3 + i]) / between;
        }
    }
    s->last_step = b->last_step;
    s->has_last = true;
    s->differences = b->known > 1 ? 1 : 0;
    s->step_before[0] = b->step_before;
}

/* The state after the last sample; the block goes on. */
static void report(imk_strapdown *s)
{
    double carried[IMKI_ROWS];
    imk_strapdown_block block = s->block;
    memcpy(carried, s->carried, sizeof carried);
    imki_block_complete(carried, &block, s->hold_height);
    const double *const r = carried + IMKI_POSITION_LOW, *const q = carried + IMKI_ATTITUDE_LOW;
    s->state = s->reported = imki_block_state(carried);
    s->position_low = (imk_vector3){{r[0], r[1], r[2]}};
    s->attitude_low = (imk_quaternion){q[0], q[1], q[2], q[3]};
    s->height = carried[IMKI_HEIGHT];
    s->climb = carried[IMKI_CLIMB];
}

static void take_steps(imk_strapdown *s, size_t count, double dt, const double *const channel[6],
                       const double *height, const double *climb)
{
    for (size_t k = 0; k < count; k++) {
        imk_vector3 angle, velocity;
        for (int i = 0; i < 3; i++) {
            angle.v[i] = dt * channel[i][k];
            velocity.v[i] = dt * channel[3 + i][k];
        }
        if (height)
            s->height = height[k];
        if (climb)
            s->climb = climb[k];
        imk_strapdown_step(s, dt, angle, velocity);
    }
}

static bool is_same(const imk_navigation_state *a, const imk_navigation_state *b)
{
    bool same = a->time == b->time && a->attitude.w == b->attitude.w &&
                a->attitude.x == b->attitude.x && a->attitude.y == b->attitude.y &&
                a->attitude.z == b->attitude.z;
    for (int i = 0; i < 3; i++)
        same = same && a->position.v[i] == b->position.v[i] && a->velocity.v[i] == b->velocity.v[i];
    return same;
}

void imk_strapdown_run(imk_strapdown *strapdown, size_t count, double dt,
                       const double *const channel[6], const double *height, const double *climb)
{
    imk_strapdown *const s = strapdown;
    if (count == 0)
        return;
    if (s->samples != 3) {
        take_steps(s, count, dt, channel, height, climb);
        return;
    }
    if (!is_same(&s->state, &s->reported) || s->hold_height != s->held)
        enter(s);
    s->held = s->hold_height;
    s->carried[IMKI_HEIGHT] = s->height;
    s->carried[IMKI_CLIMB] = s->climb;
    if (s->block.step != dt)
        imki_block_complete(s->carried, &s->block, s->hold_height);
    const imki_block_run run =
        imki_block_run_of(s->carried, 1, &s->block, s->hold_height, count, dt,
                          (const double *const(*)[6])channel, height, climb);
#if defined(__x86_64__) && defined(__GNUC__)
    if (imki_block_has_fma(imk_random_seeded(0).kernel))
        imki_block_run_fma(&run);
    else
#endif
        imki_block_run_portable(&run);
    leave_history(s);
    report(s);
}
