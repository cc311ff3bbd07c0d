/* SPDX-License-Identifier: Apache-2.0 */
/* What the mechanisation in blocks has outside its loops: constants that follow from dt, and
 * single mechanisations taken up and completed. */
#include "strapdown_block_internal.h"

#include "strapdown_internal.h"

#include <string.h>

/* The longest block [s]. What a block takes together changes by third powers of its length. */
#define LONGEST_BLOCK 0.4

/* Of a sphere: radius [m]; g/R [1/s^2]. */
#define EARTH_RADIUS 6371e3
#define GRAVITY_GRADIENT (9.81 / EARTH_RADIUS)

/* 2, 4, 8, 16 or 32 */
uint32_t imki_block_size(double dt)
{
    uint32_t size = 2;
    while (size < IMK_STRAPDOWN_BLOCK && (double)(2 * size) * dt <= LONGEST_BLOCK)
        size *= 2;
    return size;
}

/* Taylor series in n = (x/dt)^2, through y = (x/4)^2/n. */
imki_sample_constants imki_sample_constants_of(double dt)
{
    const double quarter = 0.25 * dt, y = quarter * quarter;
    return (imki_sample_constants){
        .dt = dt,
        .share = (2.0 / 3) * dt,
        .tangent = {quarter, quarter * y * (1.0 / 3), quarter * y * y * (2.0 / 15),
                    quarter * y * y * y * (17.0 / 315)},
        .scale = {2.0, -2.0 * y, y * y * (2.0 / 3), -y * y * y * (4.0 / 45)},
        .bend = {dt * (1.0 / 16), -dt * dt * dt * (1.0 / 1280)},
        .limit = 1.0 / (16.0 * dt * dt)};
}

imki_block_constants imki_block_constants_of(double dt, uint32_t samples)
{
    const double m = (double)samples, length = m * dt, square = length * length;
    const imki_earth_turn earth = imki_earth_turn_from(length);
    return (imki_block_constants){.dt = dt,
                                  .length = length,
                                  .half_length = 0.5 * length,
                                  .angle = earth.angle,
                                  .cosine_to_one = earth.cosine_to_one,
                                  .sine = earth.sine,
                                  .solved = 1.0 / (1.0 + earth.angle * earth.angle),
                                  .middle = 0.25 * (m + 2.0),
                                  .way_share = 2.0 * dt / m,
                                  .edge = dt / (3.0 * m),
                                  .gradient_velocity = GRAVITY_GRADIENT / 6.0 * square,
                                  .gradient_position = GRAVITY_GRADIENT / 12.0 * square * length,
                                  .vertical = 0.5 / EARTH_RADIUS * length};
}

bool imki_block_has_fma(imk_kernel kernel)
{
#if defined(__x86_64__) && defined(__GNUC__)
    return kernel != IMK_KERNEL_SCALAR && __builtin_cpu_supports("fma");
#else
    (void)kernel;
    return false;
#endif
}

imki_block_run imki_block_run_of(double *carried, size_t stride, imk_strapdown_block *block,
                                 bool hold_height, size_t count, double dt,
                                 const double *const (*channel)[6], const double *height,
                                 const double *climb)
{
    block->step = dt;
    const uint32_t size = imki_block_size(dt);
    return (imki_block_run){.carried = carried,
                            .stride = stride,
                            .block = block,
                            .hold_height = hold_height,
                            .count = count,
                            .channel = channel,
                            .height = height,
                            .climb = climb,
                            .sample = imki_sample_constants_of(dt),
                            .whole = imki_block_constants_of(dt, size),
                            .size = size};
}

void imki_block_enter(double *carried, size_t stride, const imk_navigation_state *state,
                      double height, double climb)
{
    const imk_quaternion q = state->attitude;
    const double attitude[4] = {q.w, q.x, q.y, q.z};
    for (size_t row = 0; row < IMKI_ROWS; row++)
        carried[row * stride] = 0.0;
    for (size_t i = 0; i < 3; i++) {
        carried[(IMKI_POSITION + i) * stride] = state->position.v[i];
        carried[(IMKI_VELOCITY + i) * stride] = state->velocity.v[i];
    }
    for (size_t i = 0; i < 4; i++)
        carried[(IMKI_ATTITUDE + i) * stride] = attitude[i];
    carried[IMKI_TIME * stride] = state->time;
    carried[IMKI_TURN * stride] = 1.0;
    carried[IMKI_HEIGHT * stride] = height;
    carried[IMKI_CLIMB * stride] = climb;
}

void imki_block_complete(double carried[IMKI_ROWS], imk_strapdown_block *block, bool hold_height)
{
    if (block->taken == 0)
        return;
    const imki_block_end end = {.block = imki_block_constants_of(block->step, block->taken),
                                .hold_height = hold_height,
                                .alone = block->taken % 2 == 1,
                                .known = block->known == 2,
                                .half = imki_sample_constants_of(0.5 * block->step)};
#if defined(__x86_64__) && defined(__GNUC__)
    /* The same bits with the slow one: only time is saved. */
    if (imki_block_has_fma(IMK_KERNEL_AVX2))
        imki_block_end_fma(&end, carried);
    else
#endif
        imki_block_end_portable(&end, carried);
    block->taken = 0;
}

imk_navigation_state imki_block_state(const double carried[IMKI_ROWS])
{
    const double *const r = carried + IMKI_POSITION, *const v = carried + IMKI_VELOCITY;
    const double *const q = carried + IMKI_ATTITUDE;
    return (imk_navigation_state){.time = carried[IMKI_TIME],
                                  .position = {{r[0], r[1], r[2]}},
                                  .velocity = {{v[0], v[1], v[2]}},
                                  .attitude = {q[0], q[1], q[2], q[3]}};
}
