/* SPDX-License-Identifier: Apache-2.0 */
/* The simulator: memory, channels, and the order in which rows are made. */
#include "imukit/simulate.h"

#include "base/refuse_internal.h"
#include "imukit/elementary.h"
#include "model/distort_internal.h"
#include "simulate_internal.h"

#include <string.h>

enum { COOKIE = 0x5131A711 };

struct imk_simulator {
    imki_scene scene;
    imk_distortion distortion, magnetic; /* the magnetometer's: as accelerometers of its own */
    imk_random random;
    uint32_t run;
    double drops;
    uint64_t next; /* first row of the block to be made next */
    size_t left;   /* rows of the channels' blocks not yet handed out */
    size_t channels;
    imki_channel *channel;
    double *held; /* a block of each channel, not yet handed out completely */
};

imk_simulation imk_simulation_default(void)
{
    return (imk_simulation){
        .cookie = COOKIE, .rate = 100.0, .earth = true, .latitude = 0.25 * IMKI_PI};
}

static imk_status range_error(imk_error *error, const char *field, double value,
                              const char *expected)
{
    imk_status status = isfinite(value) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    return imki_refuse(error, status, field, value, 0.0, expected);
}

static imk_status check_simulation(const imk_simulation *simulation, imk_error *error)
{
    const imk_simulation *s = simulation;
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "simulation", "",
                             "start from imk_simulation_default()");
    if (!(s->rate >= 1e-9 && s->rate <= 1e12))
        return range_error(error, "rate", s->rate, "a rate between 1e-9 and 1e12 Hz");
    if (!(fabs(s->latitude) <= 0.5 * IMKI_PI))
        return range_error(error, "latitude", s->latitude, "a latitude within 90 deg");
    if (!(s->height >= -1e4 && s->height <= 1e5))
        return range_error(error, "height", s->height, "a height between -10 and 100 km");
    const double angle[3] = {s->roll, s->pitch, s->yaw};
    const char *const name[3] = {"roll", "pitch", "yaw"};
    for (int i = 0; i < 3; i++)
        if (!(fabs(angle[i]) <= 1e4))
            return range_error(error, name[i], angle[i], "an angle");
    for (int i = 0; i < 3; i++)
        if (!(fabs(s->field[i]) <= 1.0))
            return range_error(error, "field", s->field[i], "a flux density of at most 1 T");
    if (s->substeps > IMK_SUBSTEPS_MAX)
        return range_error(error, "substeps", (double)s->substeps, "at most 512 parts of a sample");
    return IMK_OK;
}

static size_t channels_of(const imk_model *model, const imk_simulation *simulation)
{
    const double *field = simulation->field;
    const bool magnetic = field[0] != 0.0 || field[1] != 0.0 || field[2] != 0.0;
    return imki_axes_of(&model->gyro) + imki_axes_of(&model->accel) +
           (magnetic ? imki_axes_of(&model->mag) : 0);
}

void imk_dipole_field(double latitude, double field[3])
{
    static const double equator = 29.35e-6;
    field[0] = equator * imk_cos(latitude);
    field[1] = 0.0;
    field[2] = 2.0 * equator * imk_sin(latitude);
}

size_t imk_simulator_size(const imk_model *model, const imk_simulation *simulation)
{
    const size_t count = channels_of(model, simulation);
    imki_parts parts = {NULL, 0};
    size_t states = 0;
    for (size_t i = 0; i < count; i++) {
        const imki_axis axis = imki_axis_of(model, i);
        states += imki_channel_memory(axis);
    }
    imki_take(&parts, states);
    imki_take(&parts, count * sizeof(imki_channel));
    imki_take(&parts, 2 * count * IMK_NOISE_BLOCK * sizeof(double));
    imki_take(&parts, sizeof(imk_simulator));
    if (imki_scene_varies(model, simulation))
        imki_take(&parts, IMKI_SCENE_SIZE);
    return imki_parts_size(&parts);
}

/* ---- start ---- */

static imk_status start_distortion(imk_simulator *made, const imk_model *model,
                                   const imk_simulation *simulation, imk_error *error)
{
    imk_run_constants constants = {.bias = {{0.0}}}, magnetic = {.bias = {{0.0}}};
    for (size_t i = 0; i < made->channels; i++) {
        const imki_axis axis = imki_axis_of(model, i);
        imk_run_constants *of = axis.stimulus == IMK_MAG ? &magnetic : &constants;
        imki_draw_constants(axis, made->random, simulation->run, &of->bias[axis.sensor][axis.axis],
                            &of->scale_factor[axis.sensor][axis.axis]);
    }
    const imk_status status =
        imk_distortion_start(&made->distortion, model, &constants, made->random.kernel, error);
    if (status == IMK_OK && made->scene.has_field)
        imki_distortion_of_mag(&made->magnetic, model, &magnetic, made->random.kernel);
    return status;
}

static const imk_distortion *distortion_of(const imk_simulator *made, const imki_channel *channel)
{
    return channel->stimulus == IMK_MAG ? &made->magnetic : &made->distortion;
}

/* The response of a unit at rest. */
static double constant_response(const imk_simulator *made, const imki_channel *channel)
{
    imk_motion_state state;
    imk_trajectory_state(made->scene.trajectory, made->scene.start, &state);
    imk_stimulus stimulus = {.temperature = NULL};
    for (int i = 0; i < 3; i++) {
        stimulus.angular_rate[i] = &state.angular_rate.v[i];
        stimulus.specific_force[i] = &state.specific_force.v[i];
    }
    double response, field[3];
    if (channel->stimulus == IMK_MAG) {
        imki_field_at(&made->scene, made->scene.start, field);
        for (int i = 0; i < 3; i++)
            stimulus.specific_force[i] = &field[i];
    }
    imk_distort(distortion_of(made, channel), channel->sensor, channel->axis, &stimulus, 1,
                &response);
    return response;
}

static imk_status start_channels(imk_simulator *made, imki_parts *memory, const imk_model *model,
                                 const imk_simulation *simulation, imk_error *error)
{
    for (size_t i = 0; i < made->channels; i++) {
        imki_axis axis = imki_axis_of(model, i);
        imki_channel *channel = &made->channel[i];
        imk_status status =
            imki_channel_start(channel, axis, 1.0 / simulation->rate, made->scene.substeps,
                               made->random, simulation->run, memory, error);
        if (status != IMK_OK)
            return status;
        if (!made->scene.varies)
            channel->constant = constant_response(made, channel);
    }
    return IMK_OK;
}

imk_status imki_simulator_start(void *memory, size_t size, const imk_model *model,
                                const imk_simulation *simulation, bool checked,
                                imk_simulator **simulator, imk_error *error)
{
    imk_status status = imk_model_validate(model, error);
    if (status == IMK_OK)
        status = check_simulation(simulation, error);
    if (status != IMK_OK)
        return status;
    if (size < imk_simulator_size(model, simulation))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", "",
                             "imk_simulator_size() bytes");
    if (!memory)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", "", "memory");
    imki_parts rest = imki_parts_of(memory);
    const size_t channels = channels_of(model, simulation);
    imk_simulator *made = imki_take(&rest, sizeof *made);
    imki_channel *channel = imki_take(&rest, channels * sizeof *channel);
    double *blocks = imki_take(&rest, 2 * channels * IMK_NOISE_BLOCK * sizeof(double));
    memset(rest.memory, 0, rest.used);
    for (size_t i = 0; i < channels; i++)
        channel[i].noise = blocks + (channels + i) * IMK_NOISE_BLOCK;
    made->held = blocks;
    made->random = imk_random_seeded(simulation->seed);
    made->drops = model->timing.drops.value;
    made->run = simulation->run;
    made->channels = channels;
    made->channel = channel;
    status = imki_scene_start(&made->scene, model, simulation, checked, &rest, error);
    if (status == IMK_OK)
        status = start_distortion(made, model, simulation, error);
    if (status == IMK_OK)
        status = start_channels(made, &rest, model, simulation, error);
    if (status == IMK_OK)
        *simulator = made;
    return status;
}

imk_status imk_simulator_start(const imk_model *model, const imk_simulation *simulation,
                               imk_simulator **simulator, void *memory, size_t memory_size,
                               imk_error *error)
{
    return imki_simulator_start(memory, memory_size, model, simulation, false, simulator, error);
}

size_t imk_simulator_channels(const imk_simulator *simulator)
{
    return simulator->channels;
}

double imk_simulator_true_time(const imk_simulator *simulator, int64_t row)
{
    return simulator->scene.start + imki_row_end(&simulator->scene, row);
}

bool imk_simulator_dropped(const imk_simulator *simulator, uint64_t row)
{
    return imki_row_dropped(simulator->random, simulator->run, simulator->drops, row);
}

/* ---- rows ---- */

/* Rows first … first + rows - 1 of the blocks that begin at `out`. */
typedef struct row_work {
    imk_simulator *simulator;
    const imki_scene *scene; /* what it sees */
    size_t first, rows;
    double *const *out;
    size_t groups; /* of channels */
} row_work;

/* The deterministic part of these rows in one channel. */
static void run_response(void *context, size_t item)
{
    const row_work *work = context;
    imk_simulator *simulator = work->simulator;
    imki_channel *channel = &simulator->channel[item];
    imki_channel_response(channel, distortion_of(simulator, channel), work->scene, 0, work->rows,
                          work->out[item] + work->first);
}

/* Noise and output of the blocks that these rows complete: every groups-th channel, which mixes
 * gyros and accelerometers, so that groups of one simulator have much the same to do. */
static void run_blocks(void *context, size_t item)
{
    const row_work *work = context;
    imk_simulator *simulator = work->simulator;
    const size_t begin = work->first / IMK_NOISE_BLOCK, end = work->first + work->rows;
    for (size_t block = begin; (block + 1) * IMK_NOISE_BLOCK <= end; block++) {
        imki_channel *channels[IMKI_CHANNELS];
        double *out[IMKI_CHANNELS];
        size_t count = 0;
        for (size_t i = item; i < simulator->channels; i += work->groups) {
            channels[count] = &simulator->channel[i];
            out[count++] = work->out[i] + block * IMK_NOISE_BLOCK;
        }
        imki_channel_blocks(count, channels, !simulator->scene.varies, out);
    }
}

/* Channels are computed together, but all threads have one group. */
static size_t groups_of(const imk_simulator *simulator, const imk_executor *executor)
{
    const size_t threads = executor && executor->threads > 1 ? executor->threads : 1;
    return threads < simulator->channels ? threads : simulator->channels;
}

/* Rows made at a time: a power of two of them, so that stretches and blocks fit each other. */
static size_t stretch_rows(const imk_simulator *simulator, const imk_executor *executor)
{
    size_t parts = executor && executor->threads > 1 ? IMKI_STRETCH : IMKI_STRETCH_SERIAL;
    size_t rows = IMKI_STRETCH;
    while (rows > 1 && rows * simulator->scene.substeps > parts)
        rows /= 2;
    return rows;
}

/* `blocks` blocks of every channel. */
static void make_blocks(imk_simulator *simulator, size_t blocks, double *const *out,
                        const imk_executor *executor)
{
    const size_t rows = blocks * IMK_NOISE_BLOCK;
    const bool varies = simulator->scene.varies;
    const size_t stretch = varies ? stretch_rows(simulator, executor) : rows;
    const size_t groups = groups_of(simulator, executor);
    for (size_t first = 0; first < rows; first += stretch) {
        row_work work = {simulator, &simulator->scene,
                         first,     rows - first < stretch ? rows - first : stretch,
                         out,       groups};
        if (varies) {
            imki_scene_fill(&simulator->scene, simulator->next + first, work.rows, executor);
            /* All channels before any noise, which would push the motion out of the cache. */
            imk_execute(executor, simulator->channels, run_response, &work);
        }
        imk_execute(executor, groups, run_blocks, &work);
    }
    simulator->next += rows;
}

/* Hand out rows of the blocks the channels hold. */
static size_t hand_out(imk_simulator *simulator, size_t channels, size_t count, double *const *out)
{
    size_t now = count < simulator->left ? count : simulator->left;
    for (size_t i = 0; i < channels; i++)
        memcpy(out[i], simulator->held + (i + 1) * IMK_NOISE_BLOCK - simulator->left,
               now * sizeof(double));
    simulator->left -= now;
    return now;
}

static void advance(double *column[IMKI_CHANNELS], size_t channels, size_t rows)
{
    for (size_t i = 0; i < channels; i++)
        column[i] += rows;
}

void imk_simulator_next(imk_simulator *simulator, size_t count, double *const *columns,
                        const imk_executor *executor)
{
    double *out[IMKI_CHANNELS] = {NULL}, *held[IMKI_CHANNELS] = {NULL};
    const size_t channels = simulator->channels;
    for (size_t i = 0; i < channels; i++) {
        out[i] = columns[i];
        held[i] = simulator->held + i * IMK_NOISE_BLOCK;
    }
    size_t done = hand_out(simulator, channels, count, out);
    advance(out, channels, done);
    const size_t blocks = (count - done) / IMK_NOISE_BLOCK;
    make_blocks(simulator, blocks, out, executor);
    advance(out, channels, blocks * IMK_NOISE_BLOCK);
    done += blocks * IMK_NOISE_BLOCK;
    if (done == count)
        return;
    make_blocks(simulator, 1, held, executor);
    simulator->left = IMK_NOISE_BLOCK;
    hand_out(simulator, channels, count - done, out);
}

/* ---- several at once ---- */

/* The deterministic part of rows first … first + rows - 1, a channel of several simulators at a
 * time. */
static void respond_together(size_t count, imk_simulator *const *simulators,
                             const imki_scene *scene, size_t first, size_t rows,
                             double *const *const *columns)
{
    for (size_t j = 0; j < simulators[0]->channels; j++) {
        imki_channel *channels[IMKI_SIDE_BY_SIDE];
        const imk_distortion *distortions[IMKI_SIDE_BY_SIDE];
        double *out[IMKI_SIDE_BY_SIDE];
        for (size_t i = 0; i < count; i++) {
            channels[i] = &simulators[i]->channel[j];
            distortions[i] = distortion_of(simulators[i], channels[i]);
            out[i] = columns[i][j] + first;
        }
        imki_channel_responses(count, channels, distortions, scene, rows, out);
    }
}

/* Rows of simulators that see the same: the motion is made once, by the first. */
static void make_together(size_t count, imk_simulator *const *simulators, size_t rows,
                          double *const *const *columns)
{
    imki_scene *scene = &simulators[0]->scene;
    const uint64_t next = simulators[0]->next;
    const size_t stretch = stretch_rows(simulators[0], NULL);
    for (size_t first = 0; first < rows; first += stretch) {
        const size_t now = rows - first < stretch ? rows - first : stretch;
        imki_scene_fill(scene, next + first, now, NULL);
        respond_together(count, simulators, scene, first, now, columns);
        for (size_t i = 0; i < count; i++) {
            row_work work = {simulators[i], scene, first, now, columns[i], 1};
            run_blocks(&work, 0);
        }
    }
    for (size_t i = 0; i < count; i++)
        simulators[i]->next += rows;
}

void imki_simulators_next(size_t count, imk_simulator *const *simulators, size_t blocks,
                          double *const *const *columns)
{
    for (size_t i = 0; i < count;) {
        size_t same = 1;
        const imki_scene *scene = &simulators[i]->scene;
        while (scene->varies && same < IMKI_SIDE_BY_SIDE && i + same < count &&
               simulators[i + same]->channels == simulators[i]->channels &&
               imki_scenes_agree(scene, &simulators[i + same]->scene))
            same++;
        if (same > 1)
            make_together(same, simulators + i, blocks * IMK_NOISE_BLOCK, columns + i);
        else
            make_blocks(simulators[i], blocks, columns[i], NULL);
        i += same;
    }
}
