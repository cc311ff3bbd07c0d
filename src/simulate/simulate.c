/* SPDX-License-Identifier: Apache-2.0 */
/* The simulator: truth at rest on the Earth, memory, channels, threads. */
#include "imukit/simulate.h"

#include "imukit/earth.h"
#include "simulate/simulate_internal.h"

#include <string.h>

enum { COOKIE = 0x5131A710, ALIGNMENT = 64 };

struct imk_simulator {
    size_t channels;
    imki_channel *channel;
};

imk_simulation imk_simulation_default(void)
{
    return (imk_simulation){
        .cookie = COOKIE, .rate = 100.0, .earth = true, .latitude = 0.25 * IMKI_PI};
}

void imk_simulation_truth(const imk_simulation *simulation, double angular_rate[3],
                          double specific_force[3])
{
    imk_vector3 rate = {{0.0}}, force = {{0.0}};
    if (simulation->earth) {
        imk_matrix3 to_body = imk_matrix3_transpose(
            imk_matrix3_from_euler(simulation->roll, simulation->pitch, simulation->yaw));
        force.v[2] = -imk_normal_gravity(simulation->latitude, simulation->height);
        force = imk_matrix3_apply(to_body, force);
        rate = imk_matrix3_apply(to_body, imk_earth_rate(simulation->latitude));
    }
    memcpy(angular_rate, rate.v, sizeof rate.v);
    memcpy(specific_force, force.v, sizeof force.v);
}

static imk_status range_error(imk_error *error, const char *field, double value,
                              const char *expected)
{
    imk_status status = isfinite(value) ? IMK_ERROR_RANGE : IMK_ERROR_NOT_FINITE;
    imk_error_set(error, status, field, "", expected);
    if (error)
        error->value = value;
    return status;
}

static imk_status check_simulation(const imk_simulation *simulation, imk_error *error)
{
    const imk_simulation *s = simulation;
    if (s->cookie != COOKIE)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "simulation", "",
                             "a structure from imk_simulation_default()");
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
    return IMK_OK;
}

static size_t axes_of(const imk_triad *triad)
{
    return triad->present ? (size_t)triad->axis_count : 0;
}

static size_t aligned(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Bytes of the lists of one channel. */
static size_t list_size(const imk_noise *noise)
{
    return aligned((size_t)noise->gauss_markov_count * sizeof(imk_gauss_markov_state)) +
           aligned((size_t)noise->sinusoid_count * sizeof(imk_sinusoid_state)) +
           aligned((size_t)noise->resonance_count * sizeof(imk_arma_state));
}

size_t imk_simulator_size(const imk_model *model)
{
    size_t gyros = axes_of(&model->gyro), accels = axes_of(&model->accel);
    return aligned(sizeof(imk_simulator)) + aligned((gyros + accels) * sizeof(imki_channel)) +
           gyros * list_size(&model->gyro.noise) + accels * list_size(&model->accel.noise);
}

static void *take(unsigned char **memory, size_t size)
{
    void *taken = *memory;
    *memory += aligned(size);
    return taken;
}

static void assign_lists(imki_channel *channel, const imk_noise *noise, unsigned char **memory)
{
    channel->gauss_markov =
        take(memory, (size_t)noise->gauss_markov_count * sizeof(imk_gauss_markov_state));
    channel->sinusoid = take(memory, (size_t)noise->sinusoid_count * sizeof(imk_sinusoid_state));
    channel->resonance = take(memory, (size_t)noise->resonance_count * sizeof(imk_arma_state));
}

static imk_status start_channels(imk_simulator *made, unsigned char *memory, const imk_model *model,
                                 const imk_simulation *simulation, imk_error *error)
{
    double rate[3], force[3];
    imk_simulation_truth(simulation, rate, force);
    imk_random random = imk_random_seeded(simulation->seed);
    size_t gyros = axes_of(&model->gyro);
    for (size_t i = 0; i < made->channels; i++) {
        bool gyro = i < gyros;
        int axis = (int)(gyro ? i : i - gyros);
        imki_axis place = {gyro ? &model->gyro : &model->accel, gyro ? "gyro" : "accel", axis,
                           (uint8_t)(gyro ? axis : axis + IMK_AXES_MAX)};
        imki_channel *channel = &made->channel[i];
        assign_lists(channel, &place.triad->noise, &memory);
        channel->constant = imki_static_output(place, rate, force, random, simulation->run);
        imk_status status = imki_channel_start(channel, place, 1.0 / simulation->rate, random,
                                               simulation->run, error);
        if (status != IMK_OK)
            return status;
    }
    return IMK_OK;
}

imk_status imk_simulator_start(void *memory, size_t size, const imk_model *model,
                               const imk_simulation *simulation, imk_simulator **simulator,
                               imk_error *error)
{
    imk_status status = imk_model_validate(model, error);
    if (status == IMK_OK)
        status = check_simulation(simulation, error);
    if (status == IMK_OK)
        status = imki_check_supported(model, error);
    if (status != IMK_OK)
        return status;
    if (size < imk_simulator_size(model))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "memory", "",
                             "imk_simulator_size() bytes");
    if (!memory || (uintptr_t)memory % ALIGNMENT != 0)
        return imk_error_set(error, IMK_ERROR_ARGUMENT, "memory", "", "memory aligned to 64 bytes");
    memset(memory, 0, imk_simulator_size(model));
    unsigned char *rest = memory;
    imk_simulator *made = take(&rest, sizeof *made);
    made->channels = axes_of(&model->gyro) + axes_of(&model->accel);
    made->channel = take(&rest, made->channels * sizeof *made->channel);
    status = start_channels(made, rest, model, simulation, error);
    if (status == IMK_OK)
        *simulator = made;
    return status;
}

double imk_simulator_constant(const imk_simulator *simulator, size_t channel)
{
    return simulator->channel[channel].constant;
}

size_t imk_simulator_channels(const imk_simulator *simulator)
{
    return simulator->channels;
}

typedef struct channel_work {
    imk_simulator *simulator;
    size_t count;
    double *const *columns;
} channel_work;

static void run_channel(void *context, size_t item)
{
    const channel_work *work = context;
    imki_channel_next(&work->simulator->channel[item], work->count, work->columns[item]);
}

void imk_simulator_next(imk_simulator *simulator, size_t count, double *const *columns,
                        const imk_executor *executor)
{
    channel_work work = {simulator, count, columns};
    imk_execute(executor, simulator->channels, run_channel, &work);
}
