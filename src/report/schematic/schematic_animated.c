/* SPDX-License-Identifier: Apache-2.0 */
/* A schematic in motion: a run of the instrument gives the places of its parts. */
#include "schematic_internal.h"

#include "base/refuse_internal.h"
#include "jobs/arena_internal.h"
#include "jobs/job_internal.h"
#include "jobs/physics/physics_log_internal.h"

#include <math.h>
#include <stdio.h>

enum { FRAMES = 120 };

/* What is run. */
typedef struct take {
    const imk_schematic *schematic;
    const imk_physics_log_settings *settings;
    imk_physics_input input;
    double rate, screen_step; /* steps per simulated second; seconds on the screen of a step */
    void *state;
} take;

/* The schematic's own input, unless another was asked for. */
static imk_physics_input input_of(const imk_physics_log_settings *settings,
                                  const imk_schematic *schematic)
{
    imk_physics_input input = settings->input;
    if (!settings->view_input) {
        const bool gyro = schematic->instrument->sensor == IMK_GYRO;
        (gyro ? input.exposure.angular_rate : input.exposure.specific_force)[0] = schematic->input;
        if (gyro)
            input.exposure.specific_force[0] = schematic->force;
        input.frequency = schematic->sine ? 1 / schematic->cycle(settings->design) : 0;
    }
    return input;
}

static imk_status refuse(const take *t, size_t part, double time, imk_error *error)
{
    char found[sizeof error->found];
    snprintf(found, sizeof found, "\"%.48s\" is not finite at %.4g s",
             t->schematic->parts[part].signal, time);
    return imk_error_set(error, IMK_ERROR_NOT_FINITE, "", found,
                         "bring the design nearer to the default one, or the input nearer to 0");
}

/* The places of all parts at one moment after another. */
static imk_status record(const take *t, imki_film *film, imk_error *error)
{
    const imk_schematic *schematic = t->schematic;
    const imk_instrument *instrument = schematic->instrument;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    const uint64_t settle = (uint64_t)floor(schematic->settle * t->rate + 0.5);
    imk_schematic_moment moment = {.outputs = outputs, .signals = signals};
    for (uint64_t k = 0; k < settle + film->frames; k++) {
        const imk_exposure e = imk_physics_input_at(&t->input, t->rate, k);
        const double input =
            instrument->sensor == IMK_GYRO ? e.angular_rate[0] : e.specific_force[0];
        instrument->step(t->state, &e, outputs);
        if (k < settle)
            continue;
        instrument->observe(t->state, signals);
        moment.exposure = &e;
        const size_t frame = (size_t)(k - settle);
        moment.screen = (double)frame * t->screen_step;
        for (size_t part = 0; part < schematic->part_count; part++) {
            const double value = imk_schematic_place(schematic, t->settings->design, part, &moment);
            if (!isfinite(value))
                return refuse(t, part, (double)(k + 1) / t->rate, error);
            film->value[part * film->frames + frame] = value;
        }
        moment.turned += input / t->rate;
    }
    return IMK_OK;
}

static imk_status check(double seconds, size_t frames, imk_error *error)
{
    if (!(seconds >= 1 && seconds <= 3600))
        return imki_refuse(error, IMK_ERROR_RANGE, "seconds", seconds, seconds < 1 ? 1 : 3600,
                           "1 to 3600 seconds");
    if (frames < 2 || frames > FRAMES)
        return imki_refuse(error, IMK_ERROR_RANGE, "frames", (double)frames,
                           frames < 2 ? 2 : FRAMES, "2 to 120 moments");
    return IMK_OK;
}

/* Start the instrument and take the film. */
static imk_status run(take *t, double seconds, imki_film *film, imki_arena *arena, imk_error *error)
{
    const imk_instrument *instrument = t->schematic->instrument;
    const double pace = imk_schematic_pace(t->schematic, t->settings->design);
    const size_t size = instrument->state_size;
    imk_physics_settings physics = t->settings->physics;
    t->screen_step = seconds / (double)(film->frames - 1);
    t->rate = 1 / (t->screen_step * pace);
    t->input = input_of(t->settings, t->schematic);
    t->state = imki_arena_take(arena, size > 256 ? size : 256); /* a cache line begins there */
    film->value =
        imki_arena_take(arena, (t->schematic->part_count * film->frames + 1) * sizeof *film->value);
    if (!t->state || !film->value)
        return imk_error_set(error, IMK_ERROR_MEMORY, NULL, NULL, NULL);
    physics.rate = t->rate;
    physics.duration = t->schematic->settle + seconds * pace;
    physics.steps_max = IMK_PHYSICS_VIEW_STEPS;
    physics.turning = imki_physics_turning(&t->input);
    const imk_status status =
        imk_instrument_init(instrument, t->settings->design, &physics, t->state, error);
    return status == IMK_OK ? record(t, film, error) : status;
}

imk_status imk_schematic_animated(const imk_physics_log_settings *settings, double seconds,
                                  size_t frames, const imk_job *job, char **svg, size_t *size,
                                  imk_error *error)
{
    const imk_schematic *schematic = NULL;
    imk_status status = imki_physics_check(svg, settings, error);
    if (status == IMK_OK)
        status = imki_schematic_find(settings->instrument, settings->design, &schematic, error);
    if (status != IMK_OK)
        return status;
    imki_film film = {.frames = frames > 0 ? frames : FRAMES};
    if (seconds == 0)
        seconds = schematic->cycles * schematic->cycle_screen;
    status = check(seconds, film.frames, error);
    if (status != IMK_OK)
        return status;
    film.milliseconds = lround(seconds * 1000);
    imki_arena arena = {.allocator = imki_job_of(job)->allocator};
    take t = {.schematic = schematic, .settings = settings};
    status = run(&t, seconds, &film, &arena, error);
    if (status == IMK_OK)
        status = imki_schematic_sheet(schematic, settings->design, &film, svg, size, error);
    imki_arena_free(&arena);
    return status;
}
