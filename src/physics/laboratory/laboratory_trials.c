/* SPDX-License-Identifier: Apache-2.0 */
/* How the laboratory measures a single point. */
#include "laboratory_internal.h"

#include <math.h>

enum { RAMP = 16 };

size_t imki_state_size(const imk_laboratory *laboratory)
{
    return (laboratory->instrument->state_size + 63) / 64 * 64;
}

size_t imki_samples_in(double time, double rate)
{
    const double count = ceil(time * rate);
    return count > 1.0 ? (size_t)count : 1;
}

imki_trial imki_trial_of(const imk_laboratory *laboratory, double input)
{
    imki_trial trial = {.exposure = laboratory->surroundings, .input = input};
    if (laboratory->instrument->sensor == IMK_GYRO)
        trial.exposure.angular_rate[0] += input;
    else
        trial.exposure.specific_force[0] += input;
    return trial;
}

imk_physics_settings imki_cycle(const imki_bench *bench, size_t cycle, bool quick)
{
    imk_physics_settings physics = bench->laboratory->physics;
    physics.run = physics.run * 4096u + (uint32_t)cycle;
    if (quick && physics.level != bench->slow) {
        physics.level = bench->slow;
        physics.step = 0.0;
    }
    return physics;
}

double imki_trial_time(const imki_bench *bench)
{
    const imk_laboratory *l = bench->laboratory;
    const size_t ramp = bench->experiment.ramps ? RAMP : 0;
    return (double)(imki_samples_in(bench->settle, l->physics.rate) +
                    imki_samples_in(bench->experiment.dwell, l->physics.rate) + ramp) /
           l->physics.rate;
}

bool imki_progress(imki_bench *bench, const char *stage, uint64_t done, uint64_t total)
{
    const imk_laboratory *l = bench->laboratory;
    if (!bench->cancelled && l->progress && !l->progress(l->progress_context, stage, done, total))
        bench->cancelled = true;
    return !bench->cancelled;
}

/* The table is brought to speed: the input grows to its value in equal parts, one a sample. An
 * instrument that has to follow, such as a fibre gyro its fringe, is not thrown at it. */
static void bring_to_speed(const imk_laboratory *laboratory, const imki_trial *trial, void *state)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    for (int i = 0; i < RAMP; i++) {
        imk_exposure exposure = trial->exposure;
        const double missing = 1.0 - (i + 1.0) / RAMP;
        if (laboratory->instrument->sensor == IMK_GYRO)
            exposure.angular_rate[0] -= missing * trial->input;
        else
            exposure.specific_force[0] -= missing * trial->input;
        laboratory->instrument->step(state, &exposure, outputs);
    }
}

/* Mean of the next readings. */
static double mean_of(const imk_instrument *instrument, const imk_exposure *exposure,
                      size_t samples, void *state)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], sum = 0.0;
    for (size_t i = 0; i < samples; i++) {
        instrument->step(state, exposure, outputs);
        sum += outputs[0];
    }
    return sum / (double)samples;
}

typedef struct batch {
    const imki_bench *bench;
    size_t first;
    double *y;
} batch;

static void measure(void *context, size_t item)
{
    const batch *b = context;
    const imk_laboratory *laboratory = b->bench->laboratory;
    const imki_experiment *e = &b->bench->experiment;
    const imki_trial *trial = &e->trial[item % e->rows];
    const imk_physics_settings physics = imki_cycle(b->bench, b->first + item / e->rows, e->quick);
    void *state = b->bench->states + item * imki_state_size(laboratory);
    b->y[item] = (double)NAN;
    if (imk_instrument_init(laboratory->instrument, laboratory->design, &physics, state, NULL) !=
        IMK_OK)
        return;
    if (e->ramps)
        bring_to_speed(laboratory, trial, state);
    (void)mean_of(laboratory->instrument, &trial->exposure,
                  imki_samples_in(b->bench->settle, physics.rate), state);
    b->y[item] = mean_of(laboratory->instrument, &trial->exposure,
                         imki_samples_in(e->dwell, physics.rate), state);
}

/* Windows in which a step of half of full scale, at the highest temperature of the chamber, beside
 * a run without it, still differs from the last ones by more than 1e-6 of itself, or a hundredth of
 * what it changes from run to run, and their scatter. */
static double settling_time(imki_bench *bench, bool noise)
{
    enum { WINDOWS = 40, LAST = 10 };
    static const double window = 0.1, small = 1e-6, warmer = 20.0; /* [s], [1], [K] */
    const imk_laboratory *l = bench->laboratory;
    imk_physics_settings physics = imki_cycle(bench, 0, false);
    imki_trial trial[2] = {imki_trial_of(l, 0.0),
                           imki_trial_of(l, 0.5 * bench->result->full_scale)};
    double change[WINDOWS] = {0.0}, end = 0.0, scatter = 0.0;
    physics.noise = noise && physics.noise;
    trial[1].exposure.temperature += l->temperature ? warmer : 0.0;
    for (size_t k = 0; k < 2; k++) {
        void *state = bench->states;
        if (imk_instrument_init(l->instrument, l->design, &physics, state, NULL) != IMK_OK)
            return window;
        bring_to_speed(l, &trial[k], state);
        for (size_t i = 0; i < WINDOWS; i++)
            change[i] +=
                (k == 0 ? -1.0 : 1.0) * mean_of(l->instrument, &trial[k].exposure,
                                                imki_samples_in(window, physics.rate), state);
    }
    for (size_t i = WINDOWS - LAST; i < WINDOWS; i++)
        end += change[i] / LAST;
    for (size_t i = WINDOWS - LAST; i < WINDOWS; i++) /* of noise, not of a drift */
        scatter = fmax(scatter, fabs(change[i] - change[i - 1]));
    size_t settled = WINDOWS - LAST;
    const double run = hypot(bench->bias, bench->scale * bench->result->full_scale);
    const double enough = fmax(small * fabs(end), 0.01 * run);
    while (settled > 0 && fabs(change[settled - 1] - end) <= enough + 3.0 * scatter)
        settled--;
    return 2.0 * window * (double)(settled + 1); /* what noise hides here may show in a mean */
}

/* Noise would hide the end of a decay that a mean over cycles shows; and what it sets off has to
 * settle too. */
double imki_settling_time(imki_bench *bench)
{
    const double set = bench->laboratory->settle;
    return set >= 0.0 ? set : fmax(settling_time(bench, false), settling_time(bench, true));
}

void imki_readings(imki_bench *bench, size_t first, size_t cycles, double *y)
{
    batch b = {bench, first, y};
    imk_execute(bench->executor, cycles * bench->experiment.rows, measure, &b);
}
