/* SPDX-License-Identifier: Apache-2.0 */
/* A channel of the simulator: one sensing axis, and what a model means for it at rest. */
#ifndef IMUKIT_SIMULATE_INTERNAL_H
#define IMUKIT_SIMULATE_INTERNAL_H

#include "imukit/simulate.h"
#include "noise/generator_internal.h"

/* One axis of a triad, and where it stands. */
typedef struct imki_axis {
    const imk_triad *triad;
    const char *kind;    /* "gyro" or "accel": where errors point */
    int axis;            /* in the triad */
    uint8_t stream_axis; /* in stream numbers */
} imki_axis;

typedef struct imki_channel {
    double constant, ramp; /* [unit], [unit per sample] */
    double range, resolution, sensitivity, zero_offset;
    imk_kernel kernel;
    uint64_t next; /* sample */
    bool white_present, arma_present, flicker_present, random_walk_present;
    imk_white_state white;
    imk_arma_state arma; /* filtered white noise */
    imk_flicker_state flicker;
    imk_random_walk_state random_walk;
    imk_quantization_state quantization;
    int gauss_markov_count, sinusoid_count, resonance_count;
    imk_gauss_markov_state *gauss_markov;
    imk_sinusoid_state *sinusoid;
    imk_arma_state *resonance;
    size_t used; /* of the samples below, made and not yet handed out */
    double sample[IMK_NOISE_BLOCK];
} imki_channel;

/* Refuse what cannot be simulated exactly. */
imk_status imki_check_supported(const imk_model *model, imk_error *error);

/* Mean output of an axis at rest, with this run's repeatabilities [unit]. */
double imki_static_output(imki_axis axis, const double angular_rate[3],
                          const double specific_force[3], imk_random random, uint32_t run);

/* Start the stochastic terms and the output stage. The arrays of the channel have been assigned. */
imk_status imki_channel_start(imki_channel *channel, imki_axis axis, double dt, imk_random random,
                              uint32_t run, imk_error *error);

/* The next `count` samples. */
void imki_channel_next(imki_channel *channel, size_t count, double *out);

#endif
