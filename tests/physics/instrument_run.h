/* SPDX-License-Identifier: Apache-2.0 */
/* Running instruments in tests: states, means, and the chain from a design to an identified model.
 */
#ifndef IMUKIT_TESTS_INSTRUMENT_RUN_H
#define IMUKIT_TESTS_INSTRUMENT_RUN_H

#include "check.h"

#include "imukit/identify.h"
#include "imukit/instrument.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The state of a started instrument, from the aligned heap: free() it. A refusal fails the test. */
static inline void *started(const imk_instrument *instrument, const void *design,
                            const imk_physics_settings *settings)
{
    imk_error error = {0};
    const size_t size = (instrument->state_size + 63) / 64 * 64;
    void *state = aligned_alloc(64, size);
    assert_non_null(state);
    if (imk_instrument_init(instrument, design, settings, state, &error) != IMK_OK)
        print_error("%s: %s %s (%g, limit %g)\n", imk_status_name(error.status), error.field,
                    error.expected, error.value, error.limit);
    assert_int_equal(error.status, IMK_OK);
    return state;
}

/* Advance by `count` samples; output number `output` of each goes to `samples` unless NULL. */
static inline void run(const imk_instrument *instrument, void *state, const imk_exposure *exposure,
                       size_t count, size_t output, double *samples)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    for (size_t i = 0; i < count; i++) {
        instrument->step(state, exposure, outputs);
        if (samples)
            samples[i] = outputs[output];
    }
}

/* Mean of an output over `count` samples of a new run, behind `settle` samples. */
static inline double mean_of(const imk_instrument *instrument, const void *design,
                             const imk_physics_settings *settings, const imk_exposure *exposure,
                             size_t settle, size_t count, size_t output)
{
    void *state = started(instrument, design, settings);
    double *samples = malloc(count * sizeof *samples), sum = 0.0;
    assert_non_null(samples);
    run(instrument, state, exposure, settle, output, NULL);
    run(instrument, state, exposure, count, output, samples);
    for (size_t i = 0; i < count; i++)
        sum += samples[i];
    free(samples);
    free(state);
    return sum / (double)count;
}

/* Gain (output amplitude / input amplitude) and phase [rad] for a sine about or along x. Input and
 * output are both means over samples, so that sampling itself is neither gain nor phase; the run
 * settles for `settle` samples and is evaluated over whole cycles, at least `cycles`. */
static inline double sine_gain(const imk_instrument *instrument, const void *design,
                               const imk_physics_settings *settings, double amplitude,
                               double frequency, size_t settle, size_t cycles, double *phase)
{
    const double pi = 3.14159265358979324, dt = 1.0 / settings->rate;
    const size_t per_cycle = (size_t)llround(settings->rate / frequency);
    const double angle = 2.0 * pi / (double)per_cycle; /* the frequency that divides evenly */
    double out[2] = {0.0, 0.0}, in[2] = {0.0, 0.0}, outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    void *state = started(instrument, design, settings);
    for (size_t i = 0; i < settle + cycles * per_cycle; i++) {
        const double begin = angle * (double)(i % per_cycle);
        const double mean = amplitude * (cos(begin) - cos(begin + angle)) / angle;
        imk_exposure exposure = imk_exposure_default();
        if (instrument->sensor == 0) {
            exposure.angular_rate[0] = mean;
            exposure.angular_acceleration[0] = amplitude * (sin(begin + angle) - sin(begin)) / dt;
        } else {
            exposure.specific_force[0] = mean;
        }
        instrument->step(state, &exposure, outputs);
        if (i < settle)
            continue;
        const double c = cos(begin + 0.5 * angle), s = sin(begin + 0.5 * angle);
        out[0] += outputs[0] * c;
        out[1] += outputs[0] * s;
        in[0] += mean * c;
        in[1] += mean * s;
    }
    free(state);
    if (phase)
        *phase = atan2(out[0], out[1]) - atan2(in[0], in[1]);
    return hypot(out[0], out[1]) / hypot(in[0], in[1]);
}

/* The chain: a record of output 0 at rest (or under `exposure`), identified, has the noise terms
 * that `reduce` states. Intervals are those of a confidence of 1 - 1e-6, and a term counts as
 * present at a significance of 1e-6, so that a right instrument fails about five times in a million
 * seeds. A term that `reduce` states and the record is too short to show passes when it is below
 * the bound; one that it does not state must not be found. Under the sanitizers a quarter of the
 * record will do. */
static inline void check_chain(const imk_instrument *instrument, const void *design,
                               const imk_physics_settings *settings, const imk_exposure *exposure,
                               size_t settle, size_t count)
{
    static const char *const names[] = {"reading", "white", "bias instability", "random walk",
                                        "ramp"};
    count = check_quick() ? count / 4 : count;
    imk_model *model = malloc(sizeof *model);
    imk_identification found;
    imk_error error = {0};
    imk_identify_settings identify = imk_identify_default();
    const size_t workspace_size = imk_identify_workspace_size(count);
    double *samples = malloc(count * sizeof *samples);
    void *workspace = malloc(workspace_size), *state = started(instrument, design, settings);
    assert_true(model && samples && workspace);
    run(instrument, state, exposure, settle, 0, NULL);
    run(instrument, state, exposure, count, 0, samples);
    identify.dt = 1.0 / settings->rate;
    identify.confidence = 1.0 - 1e-6;
    identify.significance = 1e-6;
    CHECK_OK(
        imk_identify_channel(&identify, count, samples, &found, workspace, workspace_size, &error));
    imk_instrument_reduce(instrument, design, model);
    const imk_noise *noise = instrument->sensor == 0 ? &model->gyro.noise : &model->accel.noise;
    const double stated[] = {imk_noise_reading(noise, 0, identify.dt), noise->white.value[0],
                             noise->bias_instability.value[0], noise->random_walk.value[0],
                             noise->ramp.value[0]};
    for (int i = 0; i < IMK_NOISE_TERMS; i++) {
        const imk_estimate *e = &found.term[i];
        const bool inside = stated[i] >= e->lower && stated[i] <= e->upper;
        if (!(stated[i] > 0.0 ? inside : !e->present)) {
            print_error("%s: %s is stated as %g, identified %g (%g to %g)%s\n", instrument->name,
                        names[i], stated[i], e->value, e->lower, e->upper,
                        e->present ? "" : ", absent");
            fail();
        }
    }
    free(state);
    free(workspace);
    free(samples);
    free(model);
}

#endif
