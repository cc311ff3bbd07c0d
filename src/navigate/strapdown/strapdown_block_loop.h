/* SPDX-License-Identifier: Apache-2.0 */
/* Samples in arrays to blocks and back to memory, for every instruction set. No include guard; each
 * strapdown_block_*.c defines first what strapdown_block_kernel.h asks for, and
 *
 *     load_across(channel, j, first, out)      LANES samples of channel j of each lane, from
 *                                              `first` on: out[k] has the k-th of all lanes */
#include "strapdown_block_kernel.h"

#include <string.h>

/* ---- memory ---------------------------------------------------------------------------------- */

typedef real real_in_array __attribute__((aligned(8), may_alias));

KERNEL vector load_vector(const double *row, size_t stride)
{
    vector a;
    for (size_t i = 0; i < 3; i++)
        a.v[i] = *(const real_in_array *)(row + i * stride);
    return a;
}

KERNEL void store_vector(double *row, size_t stride, vector a)
{
    for (size_t i = 0; i < 3; i++)
        *(real_in_array *)(row + i * stride) = a.v[i];
}

KERNEL quaternion load_quaternion(const double *row, size_t stride)
{
    const vector u = load_vector(row + stride, stride);
    return (quaternion){*(const real_in_array *)row, u.v[0], u.v[1], u.v[2]};
}

KERNEL void store_quaternion(double *row, size_t stride, quaternion q)
{
    *(real_in_array *)row = q.w;
    store_vector(row + stride, stride, (vector){{q.x, q.y, q.z}});
}

KERNEL reading load_reading(const double *row, size_t stride)
{
    reading r;
    for (size_t i = 0; i < 6; i++)
        r.channel[i] = *(const real_in_array *)(row + i * stride);
    return r;
}

KERNEL void store_reading(double *row, size_t stride, const reading *r)
{
    for (size_t i = 0; i < 6; i++)
        *(real_in_array *)(row + i * stride) = r->channel[i];
}

static void load_carrier(const double *row, size_t stride, carrier *c)
{
    c->position = load_vector(row + IMKI_POSITION * stride, stride);
    c->position_low = load_vector(row + IMKI_POSITION_LOW * stride, stride);
    c->velocity = load_vector(row + IMKI_VELOCITY * stride, stride);
    c->attitude = load_quaternion(row + IMKI_ATTITUDE * stride, stride);
    c->attitude_low = load_quaternion(row + IMKI_ATTITUDE_LOW * stride, stride);
    c->time = *(const real_in_array *)(row + IMKI_TIME * stride);
    c->last = load_reading(row + IMKI_LAST * stride, stride);
    c->before = load_reading(row + IMKI_BEFORE * stride, stride);
    c->block.turn = load_quaternion(row + IMKI_TURN * stride, stride);
    c->block.gain = load_vector(row + IMKI_GAIN * stride, stride);
    c->block.way = load_vector(row + IMKI_WAY * stride, stride);
    c->force = load_vector(row + IMKI_FORCE * stride, stride);
    c->height = *(const real_in_array *)(row + IMKI_HEIGHT * stride);
    c->climb = *(const real_in_array *)(row + IMKI_CLIMB * stride);
}

static void store_carrier(const carrier *c, double *row, size_t stride)
{
    store_vector(row + IMKI_POSITION * stride, stride, c->position);
    store_vector(row + IMKI_POSITION_LOW * stride, stride, c->position_low);
    store_vector(row + IMKI_VELOCITY * stride, stride, c->velocity);
    store_quaternion(row + IMKI_ATTITUDE * stride, stride, c->attitude);
    store_quaternion(row + IMKI_ATTITUDE_LOW * stride, stride, c->attitude_low);
    *(real_in_array *)(row + IMKI_TIME * stride) = c->time;
    store_reading(row + IMKI_LAST * stride, stride, &c->last);
    store_reading(row + IMKI_BEFORE * stride, stride, &c->before);
    store_quaternion(row + IMKI_TURN * stride, stride, c->block.turn);
    store_vector(row + IMKI_GAIN * stride, stride, c->block.gain);
    store_vector(row + IMKI_WAY * stride, stride, c->block.way);
    store_vector(row + IMKI_FORCE * stride, stride, c->force);
    *(real_in_array *)(row + IMKI_HEIGHT * stride) = c->height;
    *(real_in_array *)(row + IMKI_CLIMB * stride) = c->climb;
}

/* ---- samples in arrays ----------------------------------------------------------------------- */

/* Samples gathered at once, and those of the blocks that are worked on one ahead of the other. */
enum { GROUP = 8, WHOLE = IMK_STRAPDOWN_BLOCK };

/* A group of samples of arrays of their own in lanes, one channel. */
KERNEL void gather_group(const double *const (*channel)[6], size_t first, size_t j, reading *sample)
{
    for (size_t i = 0; i < GROUP; i += LANES) {
        real across[LANES];
        load_across(channel, j, first + i, across);
        for (size_t k = 0; k < LANES; k++)
            sample[i + k].channel[j] = across[k];
    }
}

static void gather(const double *const (*channel)[6], size_t first, size_t count, reading *sample)
{
    size_t i = 0;
    for (; i + GROUP <= count; i += GROUP)
        for (size_t j = 0; j < 6; j++)
            gather_group(channel, first + i, j, sample + i);
    for (; i < count; i++)
        for (size_t j = 0; j < 6; j++) {
            double lanes[LANES];
            for (size_t lane = 0; lane < LANES; lane++)
                lanes[lane] = channel[lane][j][first + i];
            memcpy(&sample[i].channel[j], lanes, sizeof lanes);
        }
}

/* What is known of samples after `count` more of one length. */
static void count_samples(imk_strapdown_block *block, double dt, size_t count)
{
    block->step_before = count > 1 ? dt : block->last_step;
    block->last_step = dt;
    block->known = count > 1 || block->known > 0 ? 2 : 1;
    block->taken += (uint32_t)count;
}

/* Up to a block of samples; an odd one waits for the next as c->last. */
static void take_part(const imki_block_run *run, size_t first, size_t count, carrier *c)
{
    imk_strapdown_block *const block = run->block;
    reading buffer[1 + WHOLE];
    const size_t waiting = block->taken % 2;
    reading *const sample = buffer + waiting;
    buffer[0] = c->last;
    gather(run->channel, first, count, sample);
    /* The force before the first sample of all, as soon as there are two. */
    if (block->known == waiting && waiting + count >= 2)
        c->force = force_after(&buffer[0], &buffer[1]);
    else if (block->known == 0)
        c->force = force_of(sample);
    if (block->known == 0)
        c->last = sample[0];
    take_pairs(&run->sample, buffer, (waiting + count) / 2, &c->block);
    c->before = count > 1 ? sample[count - 2] : c->last;
    c->last = sample[count - 1];
    count_samples(block, run->sample.dt, count);
}

static void finish_block(const imki_block_run *run, size_t done, carrier *c)
{
    if (run->height)
        c->height = spread(run->height[done - 1]);
    if (run->climb)
        c->climb = spread(run->climb[done - 1]);
    if (run->block->taken == run->size) {
        const place at = place_halfway(&run->whole, c);
        end_block(&run->whole, run->hold_height, &at, c);
        run->block->taken = 0;
    }
}

/* What goes on beside the samples of a whole block: the end of the block before, if there was one,
 * and gravity in the middle of this one. */
typedef struct beside {
    bool pending;
    place halfway;
    ending end;
} beside;

KERNEL void work_beside(const imki_block_run *run, size_t pair, beside *b, carrier *c)
{
    const imki_block_constants *const k = &run->whole;
    switch (pair) {
    case 0:
        if (b->pending)
            integrals(k, c, &b->end.force, &b->end.scrolling);
        break;
    case 2:
        if (b->pending)
            end_velocity(k, run->hold_height, &b->halfway, c, &b->end);
        break;
    case 4:
        if (b->pending)
            end_position(k, run->hold_height, &b->halfway, &b->end, c);
        break;
    case 6:
        find_distance(k, c, &b->halfway);
        break;
    case 8:
        if (b->pending)
            end_attitude(k, c);
        break;
    case 10:
        find_parametric(&b->halfway);
        break;
    case 12:
        find_vertical(&b->halfway);
        break;
    case 14:
        find_gravity(&b->halfway);
        break;
    default:
        break;
    }
}

/* A whole block of samples, `now`; the next one is gathered meanwhile. A processor looks ahead by a
 * few hundred operations only, and each of these works is a chain of operations that wait for one
 * another: so they are mixed. */
KERNEL void take_block(const imki_block_run *run, const reading *now, size_t then, reading *next,
                       step *ahead, beside *b, carrier *c)
{
    enum { PAIRS = WHOLE / 2, QUARTER = GROUP / 2 };
    gathered g = {{spread(1.0), spread(0.0), spread(0.0), spread(0.0)},
                  {{spread(0.0), spread(0.0), spread(0.0)}},
                  {{spread(0.0), spread(0.0), spread(0.0)}}};
    real largest = spread(0.0);
    for (size_t i = 0; i < PAIRS; i++) {
        const step by = *ahead;
        const size_t group = i / QUARTER * GROUP, channel = i % QUARTER * 3 / 2;
        *ahead = step_of(&run->sample, false, i + 1 < PAIRS ? now + 2 * (i + 1) : next);
        take_step(&by, &g);
        largest = larger(largest, by.square);
        gather_group(run->channel, then + group, channel, next + group);
        if (i % 2 == 1)
            gather_group(run->channel, then + group, channel + 1, next + group);
        work_beside(run, i, b, c);
    }
    if (any_above(largest, run->sample.limit))
        take_fast(&run->sample, now, PAIRS, &c->block);
    else
        c->block = g;
    c->before = now[WHOLE - 2];
    c->last = now[WHOLE - 1];
}

static void take_whole(const imki_block_run *run, size_t first, size_t blocks, carrier *c)
{
    reading buffer[2][WHOLE];
    gather(run->channel, first, WHOLE, buffer[0]);
    step ahead = step_of(&run->sample, false, buffer[0]);
    beside b = {.pending = false};
    for (size_t i = 0; i < blocks; i++) {
        const size_t at = first + i * WHOLE, then = i + 1 < blocks ? at + WHOLE : at;
        take_block(run, buffer[i % 2], then, buffer[(i + 1) % 2], &ahead, &b, c);
        if (run->height)
            c->height = spread(run->height[at + WHOLE - 1]);
        if (run->climb)
            c->climb = spread(run->climb[at + WHOLE - 1]);
        b.pending = true;
    }
    end_block(&run->whole, run->hold_height, &b.halfway, c);
    count_samples(run->block, run->sample.dt, 2);
    run->block->taken = 0;
}

static void run_blocks(const imki_block_run *run)
{
    imk_strapdown_block *const block = run->block;
    carrier c;
    load_carrier(run->carried, run->stride, &c);
    for (size_t done = 0; done < run->count;) {
        const size_t left = run->size - block->taken, rest = run->count - done;
        if (left == WHOLE && rest >= WHOLE && block->known == 2) {
            take_whole(run, done, rest / WHOLE, &c);
            done += rest - rest % WHOLE;
        } else {
            const size_t count = rest < left ? rest : left;
            take_part(run, done, count, &c);
            done += count;
            finish_block(run, done, &c);
        }
    }
    store_carrier(&c, run->carried, run->stride);
}
