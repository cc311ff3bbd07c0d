/* SPDX-License-Identifier: Apache-2.0 */
/* The noise of channels: their stochastic terms and the ramp, in blocks of 512 samples counted from
 * sample 0. It does not depend on the motion, and is summed up before what the motion adds. */
#include "simulate_internal.h"

#include <string.h>

/* Normals drawn in one call: for white noise, a random walk, flicker and two more terms. */
enum {
    BATCH_NORMALS = 4 * IMK_NOISE_BLOCK + IMKI_FLICKER_NORMALS,
    BATCH_PARTS = 2 * IMK_TERMS_MAX,
    BATCH_DRAWS = BATCH_NORMALS / IMK_NOISE_BLOCK + IMKI_DRAWS_MAX
};

/* States of a channel whose normals are drawn in one call. */
typedef struct batch {
    struct {
        const imki_generator *generator;
        unsigned char *states;
        size_t count;
        double *normals;
    } part[BATCH_PARTS];
    size_t parts, draws, used;
    imki_draw draw[BATCH_DRAWS];
    IMKI_ALIGNED double normals[BATCH_NORMALS];
} batch;

static void add_batch(const imki_channel *channel, batch *b, double *block)
{
    if (b->draws > 0)
        imki_random_draws(channel->random, b->draw, b->draws);
    for (size_t i = 0; i < b->parts; i++)
        b->part[i].generator->blocks(b->part[i].states, b->part[i].count, channel->kernel,
                                     b->part[i].normals, block);
    b->parts = b->draws = b->used = 0;
}

static void put_in_batch(batch *b, const imki_generator *generator, unsigned char *states,
                         size_t count)
{
    b->part[b->parts].generator = generator;
    b->part[b->parts].states = states;
    b->part[b->parts].count = count;
    b->part[b->parts++].normals = b->normals + b->used;
    for (size_t i = 0; i < count && generator->draws; i++) {
        b->draws += generator->draws(states + i * generator->state_size, b->normals + b->used,
                                     b->draw + b->draws);
        b->used += generator->normals;
    }
}

/* The terms first … last - 1 of a channel, one after another. Its memory is on the stack: not while
 * the terms that go across use theirs. */
static __attribute__((noinline)) void add_terms(imki_channel *channel, int first, int last,
                                                double *block)
{
    batch b;
    b.parts = b.draws = b.used = 0;
    for (int t = first; t < last; t++) {
        const imki_channel_term *term = &channel->term[t];
        const imki_generator *generator = term->generator;
        for (size_t i = 0; i < term->count && !generator->across;) {
            const size_t left = term->count - i;
            const size_t now = left < generator->together ? left : generator->together;
            if (b.used + now * generator->normals > BATCH_NORMALS || b.parts == BATCH_PARTS)
                add_batch(channel, &b, block);
            put_in_batch(&b, generator, term->states + i * generator->state_size, now);
            i += now;
        }
    }
    add_batch(channel, &b, block);
}

/* State `index` of a term of each channel that has it, where that goes across channels. */
static void add_across(size_t count, imki_channel *const *channels, int t, size_t index,
                       double *const *out)
{
    void *states[IMKI_CHANNELS];
    double *blocks[IMKI_CHANNELS] = {NULL};
    const imki_generator *generator = NULL;
    size_t present = 0;
    for (size_t i = 0; i < count; i++) {
        const imki_channel_term *term = &channels[i]->term[t];
        if (!term->generator->across || index >= term->count)
            continue;
        generator = term->generator;
        states[present] = term->states + index * generator->state_size;
        blocks[present++] = out[i];
    }
    if (generator)
        generator->across(states, present, blocks);
}

/* How many states of a term go across, of the channel that has most of them. */
static size_t states_across(size_t count, imki_channel *const *channels, int t)
{
    size_t most = 0;
    for (size_t i = 0; i < count; i++)
        if (channels[i]->term[t].generator->across && channels[i]->term[t].count > most)
            most = channels[i]->term[t].count;
    return most;
}

void imki_channel_noise(size_t count, imki_channel *const *channels, double *const *noise)
{
    for (size_t i = 0; i < count; i++) {
        memset(noise[i], 0, IMK_NOISE_BLOCK * sizeof(double));
        if (channels[i]->ramp != 0.0)
            imki_add_ramp(channels[i]->kernel, channels[i]->ramp, channels[i]->next, noise[i]);
    }
    for (int t = 0, done = 0; t <= IMKI_NOISE_TERMS; t++) {
        const size_t across = t < IMKI_NOISE_TERMS ? states_across(count, channels, t) : 0;
        if (across == 0 && t < IMKI_NOISE_TERMS)
            continue;
        for (size_t i = 0; i < count && t > done; i++)
            add_terms(channels[i], done, t, noise[i]);
        for (size_t j = 0; j < across; j++)
            add_across(count, channels, t, j, noise);
        done = t;
    }
    for (size_t i = 0; i < count; i++)
        channels[i]->next += IMK_NOISE_BLOCK;
}
