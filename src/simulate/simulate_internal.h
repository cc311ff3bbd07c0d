/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of the simulator: what the unit is exposed to, and a channel, one sensing axis. */
#ifndef IMUKIT_SIMULATE_INTERNAL_H
#define IMUKIT_SIMULATE_INTERNAL_H

#include "base/workspace_internal.h"
#include "imukit/distort.h"
#include "imukit/simulate.h"
#include "noise/arma_internal.h"
#include "noise/noise_terms_internal.h"

/* ---- scene.c: motion and temperature, a stretch of parts of samples at a time ---- */

/* Parts of samples made at a time: enough to share among threads, small enough for the cache. */
enum { IMKI_STRETCH = 8192, IMKI_STRETCH_SERIAL = 512 };

/* Columns of a stretch. */
enum {
    IMKI_RATE = 0,
    IMKI_FORCE = 3,
    IMKI_ACCELERATION = 6,
    IMKI_LATE = 9, /* rate, force, acceleration again, for accelerometers that lag */
    IMKI_TEMPERATURE = 18,
    IMKI_TEMPERATURE_RATE,
    IMKI_HYSTERESIS,
    IMKI_WARM_UP = IMKI_HYSTERESIS + IMK_KINDS,
    IMKI_FIELD = IMKI_WARM_UP + IMK_KINDS,
    IMKI_TIME = IMKI_FIELD + 3, /* scratch: times */
    IMKI_COLUMNS
};

typedef struct imki_scene {
    imk_kernel kernel;
    imk_random random;
    uint64_t jitter_stream;
    imk_trajectory rest; /* at rest, when the caller gives no motion */
    imk_trajectory_piece rest_piece;
    const imk_trajectory *trajectory; /* or recorded */
    const imk_recorded_motion *recorded;
    const imk_temperature_profile *temperature; /* or NULL */
    double start;                               /* time of row 0 in the motion */
    double interval, jitter, skew;              /* of true time [s] */
    size_t substeps;
    bool motion_varies, varies; /* in time; anything at all */
    bool still;                 /* nothing but the warm-up varies, and a row is one part */
    bool needs_acceleration, hysteresis_present[IMK_KINDS], warm_up_present[IMK_KINDS];
    bool same_hysteresis, same_warm_up; /* of gyros and accelerometers: made once */
    double warm_up_time[IMK_KINDS];
    imk_hysteresis hysteresis[IMK_KINDS];
    bool has_field;
    double field[3];       /* north, east, down */
    double *warm_up_table; /* IMK_KINDS x IMK_NOISE_BLOCK: e^(-i part/time) */
    double *column[IMKI_COLUMNS];
    double *boundary; /* IMKI_STRETCH + 1 */
    /* The stretch made last, by kind. To the distortion a magnetometer is an accelerometer that
     * sees the field. */
    imk_stimulus stimulus[IMK_KINDS];
} imki_scene;

/* Parts of a sample this simulation needs. */
size_t imki_substeps(const imk_model *model, const imk_simulation *simulation);
/* True when anything varies: then the scene takes this memory for its columns. */
bool imki_scene_varies(const imk_model *model, const imk_simulation *simulation);
enum {
    IMKI_SCENE_SIZE =
        ((IMKI_COLUMNS + 1) * IMKI_STRETCH + 8 + IMK_KINDS * IMK_NOISE_BLOCK) * sizeof(double)
};
/* @param checked  the motion has been found valid before */
imk_status imki_scene_start(imki_scene *scene, const imk_model *model,
                            const imk_simulation *simulation, bool checked, imki_parts *memory,
                            imk_error *error);
/* True when two scenes that have been used alike go on alike. */
bool imki_scenes_agree(const imki_scene *a, const imki_scene *b);
/* Make the rows first … first + rows - 1, rows * substeps <= IMKI_STRETCH. Stretches follow one
 * another. */
void imki_scene_fill(imki_scene *scene, uint64_t first, size_t rows, const imk_executor *executor);
/* e^(-t/time) in the middle of part `within` of the block of 512 parts that begins with number
 * `first`, of a row's `parts` of this length, is the product of these: one exponential serves 512.
 */
static inline double imki_warm_up_block(uint64_t first, size_t parts, double part, double time)
{
    const double anchor = (double)first + 0.5 - (double)parts;
    return imk_exp(-(anchor * part) / time);
}

static inline double imki_warm_up_within(size_t within, double part, double time)
{
    return imk_exp(-((double)within * part) / time);
}
/* The field in body axes at an instant. */
void imki_field_at(const imki_scene *scene, double time, double field[3]);
/* True time at the end of a row, from the start of the motion. */
double imki_row_end(const imki_scene *scene, int64_t row);

/* ---- channel.c ---- */

/* One axis of a triad, and where it stands. */
typedef struct imki_axis {
    const imk_triad *triad;
    const char *kind;    /* "gyro", "accel" or "mag": where errors point */
    int sensor;          /* IMK_GYRO or IMK_ACCEL, as which it is distorted */
    int stimulus;        /* its kind */
    int axis;            /* in the triad */
    uint8_t stream_axis; /* in stream numbers */
} imki_axis;

/* The bandwidth, on a signal given by its means over equal parts of time: between two parts the
 * state (x, v) decays towards the steady state (u, 0) of the input,
 *
 *     X <- U + phi (X - U),     mean of x over the part = u + g (X - U)/h. */
typedef struct imki_band_limit {
    bool present, started;
    double phi[2][2], mean[2]; /* g/h */
    double x, v;
} imki_band_limit;

/* The mean of x over a part with the input u, whose state is carried. */
static inline double imki_band_limited(const imki_band_limit *limit, double u, double *x, double *v)
{
    const double away = *x - u, speed = *v;
    *x = u + (limit->phi[0][0] * away + limit->phi[0][1] * speed);
    *v = limit->phi[1][0] * away + limit->phi[1][1] * speed;
    return u + (limit->mean[0] * away + limit->mean[1] * speed);
}

/* Of an axis, over parts of this length; not present where it has no bandwidth. */
imk_status imki_band_limit_start(imki_band_limit *limit, const imk_triad *triad, int axis,
                                 double part);
void imki_limit_band(imki_band_limit *limit, size_t count, double *signal);

/* The states of a stochastic term that this axis has. */
typedef struct imki_channel_term {
    const imki_generator *generator;
    unsigned char *states;
    size_t count;
} imki_channel_term;

typedef struct imki_channel {
    int sensor, stimulus, axis;
    double constant, ramp; /* of a unit at rest [unit]; [unit per sample] */
    double dead_band, range, resolution, sensitivity, zero_offset;
    imk_random random;
    imk_kernel kernel;
    uint64_t next; /* sample */
    imki_band_limit band_limit;
    imki_channel_term term[IMKI_NOISE_TERMS];
    imk_quantization_state quantization;
    double *noise; /* a block, where the simulator has the room for it */
} imki_channel;

/* The output stage of one sample; the quantization of the integral comes before the resolution. */
static inline bool imki_saturates(const imki_channel *channel)
{
    return channel->dead_band > 0.0 || channel->range > 0.0;
}

static inline double imki_end_of_range(const imki_channel *channel)
{
    return channel->range > 0.0 ? channel->range : (double)INFINITY;
}

static inline double imki_to_resolution(double step, double x)
{
    return step * imki_round(x / step);
}

static inline double imki_to_counts(const imki_channel *channel, double x)
{
    return imki_round(channel->sensitivity * x + channel->zero_offset);
}

/* Bytes of the states of the stochastic terms, a multiple of 64. */
size_t imki_channel_memory(imki_axis axis);
/* Start the stochastic terms, whose states are taken from memory, and the output stage. */
imk_status imki_channel_start(imki_channel *channel, imki_axis axis, double dt, size_t substeps,
                              imk_random random, uint32_t run, imki_parts *memory,
                              imk_error *error);

/* The deterministic part of `rows` rows, whole blocks of 512 where the scene is still, out of the
 * stretch from its part `part` on. */
void imki_channel_response(imki_channel *channel, const imk_distortion *distortion,
                           const imki_scene *scene, size_t part, size_t rows, double *out);

enum { IMKI_SIDE_BY_SIDE = 8 };

/* The same of one channel of each of several units, rows from part 0 on.
 * @param count  <= IMKI_SIDE_BY_SIDE */
void imki_channel_responses(size_t count, imki_channel *const *channels,
                            const imk_distortion *const *distortions, const imki_scene *scene,
                            size_t rows, double *const *out);

enum { IMKI_CHANNELS = IMK_KINDS * IMK_AXES_MAX };

/* Noise and output stage of the next 512 samples of several channels of one unit.
 * @param count     <= IMKI_CHANNELS; each has room for its noise
 * @param constant  true: the deterministic part is channel->constant; false: it stands in out
 * @param out       in time order, one of each channel */
void imki_channel_blocks(size_t count, imki_channel *const *channels, bool constant,
                         double *const *out);

/* ---- channel_noise.c ---- */

/* The noise of the next 512 samples of several channels of one seed: together, because some terms
 * wait for their own sums and others can be computed meanwhile.
 * @param count  <= IMKI_CHANNELS
 * @param noise  in segment order, one of each channel */
void imki_channel_noise(size_t count, imki_channel *const *channels, double *const *noise);

/* ---- unit.c: the axes of a unit ---- */

size_t imki_axes_of(const imk_triad *triad);
/* True when a number of one of its axes is not 0. */
bool imki_triad_has(const imk_triad *triad, const imk_axes *numbers);
/* The axis of a channel: gyros first, then accelerometers, then a magnetometer. */
imki_axis imki_axis_of(const imk_model *model, size_t channel);
/* Bias and scale factor of an axis that this run has beside those of the model. */
void imki_draw_constants(imki_axis axis, imk_random random, uint32_t run, double *bias,
                         double *scale_factor);
/* True when the row with this number is lost, of a run with this probability of it. */
bool imki_row_dropped(imk_random random, uint32_t run, double probability, uint64_t row);

/* ---- simulate.c: many runs of one motion ---- */

/* imk_simulator_start() on a motion that may have been `checked` before. */
imk_status imki_simulator_start(void *memory, size_t size, const imk_model *model,
                                const imk_simulation *simulation, bool checked,
                                imk_simulator **simulator, imk_error *error);
/* The next blocks of 512 samples of several simulators: as imk_simulator_next() gives them, which
 * must have been asked for whole blocks so far. Neighbours that see the same motion and have been
 * used by this function only share the work of making it.
 * @param columns  [simulator][channel]: blocks * 512 doubles each */
void imki_simulators_next(size_t count, imk_simulator *const *simulators, size_t blocks,
                          double *const *const *columns);

#endif
