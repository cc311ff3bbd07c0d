/* SPDX-License-Identifier: Apache-2.0 */
/* How the laboratory measures a single point, and fits to the readings of several. */
#include "laboratory_internal.h"

#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { BATCHES = 16, RAMP = 32 };

size_t imki_state_size(const imk_laboratory *laboratory)
{
    return (laboratory->instrument->state_size + 63) / 64 * 64;
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

size_t imki_samples_in(double time, double rate)
{
    const double count = ceil(time * rate);
    return count > 1.0 ? (size_t)count : 1;
}

/* The table is brought to speed: the input grows to its value in equal parts, one a sample. An
 * instrument that has to follow, such as a fibre gyro its fringe, is not thrown at it. */
static void bring_to_speed(const imk_laboratory *laboratory, const imki_trial *trial, void *state)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    for (int i = 1; i < RAMP; i++) {
        imk_exposure exposure = trial->exposure;
        const double missing = 1.0 - (double)i / RAMP;
        if (laboratory->instrument->sensor == IMK_GYRO)
            exposure.angular_rate[0] -= missing * trial->input;
        else
            exposure.specific_force[0] -= missing * trial->input;
        laboratory->instrument->step(state, &exposure, outputs);
    }
}

/* Mean of the dwell and its 1 sigma from the scatter of the means of its parts. */
static void measure_constant(const imk_laboratory *laboratory, imki_trial *trial, void *state)
{
    const imk_instrument *instrument = laboratory->instrument;
    const double rate = laboratory->physics.rate;
    const size_t part = (imki_samples_in(laboratory->dwell, rate) + BATCHES - 1) / BATCHES;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], batch[BATCHES], mean = 0.0, scatter = 0.0;
    bring_to_speed(laboratory, trial, state);
    for (size_t i = imki_samples_in(laboratory->settle, rate); i > 0; i--)
        instrument->step(state, &trial->exposure, outputs);
    for (int b = 0; b < BATCHES; b++) {
        double sum = 0.0;
        for (size_t i = 0; i < part; i++) {
            instrument->step(state, &trial->exposure, outputs);
            sum += outputs[0];
        }
        batch[b] = sum / (double)part;
        mean += batch[b] / BATCHES;
    }
    for (int b = 0; b < BATCHES; b++)
        scatter += (batch[b] - mean) * (batch[b] - mean);
    trial->reading =
        (imk_laboratory_point){trial->input, mean, sqrt(scatter / (BATCHES * (BATCHES - 1.0)))};
}

/* Correlation of input and output with the cosine and the sine of the input's phase, over whole
 * cycles. The mean of a sine over a sample is what the instrument is exposed to. */
static void measure_sine(const imk_laboratory *laboratory, size_t per_cycle, imki_trial *trial,
                         void *state)
{
    const imk_instrument *instrument = laboratory->instrument;
    const double angle = 2.0 * IMKI_PI / (double)per_cycle;
    const double dt = 1.0 / (trial->frequency * (double)per_cycle);
    const size_t settle = imki_samples_in(laboratory->settle + 4.0 / trial->frequency, 1.0 / dt);
    const size_t wanted = imki_samples_in(laboratory->dwell, trial->frequency);
    const size_t cycles = wanted < 4 ? 4 : wanted;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], out[2] = {0.0, 0.0}, in[2] = {0.0, 0.0};
    for (size_t i = 0; i < settle + cycles * per_cycle; i++) {
        const double begin = angle * (double)(i % per_cycle), middle = begin + 0.5 * angle;
        const double mean = trial->input * (imk_cos(begin) - imk_cos(begin + angle)) / angle;
        imk_exposure exposure = trial->exposure;
        if (instrument->sensor == IMK_GYRO) {
            exposure.angular_rate[0] += mean;
            exposure.angular_acceleration[0] +=
                trial->input * (imk_sin(begin + angle) - imk_sin(begin)) / dt;
        } else {
            exposure.specific_force[0] += mean;
        }
        instrument->step(state, &exposure, outputs);
        if (i < settle)
            continue;
        const double c = imk_cos(middle), s = imk_sin(middle);
        out[0] += outputs[0] * c;
        out[1] += outputs[0] * s;
        in[0] += mean * c;
        in[1] += mean * s;
    }
    double phase = imk_atan2(out[0], out[1]) - imk_atan2(in[0], in[1]);
    phase -= 2.0 * IMKI_PI * floor(phase / (2.0 * IMKI_PI) + 0.5);
    const double ratio = (out[0] * out[0] + out[1] * out[1]) / (in[0] * in[0] + in[1] * in[1]);
    trial->sine = (imk_laboratory_response){trial->frequency, sqrt(ratio), phase};
}

/* Samples to a cycle: as the sample rate gives, at least 64: holding the input and taking
 * the mean of the output then change the gain by less than 1e-3. */
static size_t samples_per_cycle(const imk_laboratory *laboratory, double frequency)
{
    const double count = floor(laboratory->physics.rate / frequency + 0.5);
    return count > 64.0 ? (size_t)count : 64;
}

typedef struct bench {
    const imk_laboratory *laboratory;
    imki_trial *trials;
    char *states;
} bench;

static void measure(void *context, size_t item)
{
    const bench *b = context;
    const imk_laboratory *laboratory = b->laboratory;
    imki_trial *trial = &b->trials[item];
    imk_physics_settings physics = laboratory->physics;
    void *state = b->states + item * imki_state_size(laboratory);
    size_t per_cycle = 1;
    physics.occasion = (uint8_t)(item + 1);
    if (trial->frequency > 0.0) {
        per_cycle = samples_per_cycle(laboratory, trial->frequency);
        physics.rate = trial->frequency * (double)per_cycle;
    }
    trial->sine = (imk_laboratory_response){trial->frequency, (double)NAN, (double)NAN};
    trial->reading = (imk_laboratory_point){trial->input, (double)NAN, (double)NAN};
    if (imk_instrument_init(laboratory->instrument, laboratory->design, &physics, state, NULL) !=
        IMK_OK)
        return;
    if (trial->frequency > 0.0)
        measure_sine(laboratory, per_cycle, trial, state);
    else
        measure_constant(laboratory, trial, state);
}

void imki_trials_run(const imk_laboratory *laboratory, size_t count, imki_trial *trials,
                     char *states, const imk_executor *executor)
{
    bench b = {laboratory, trials, states};
    imk_execute(executor, count, measure, &b);
}

/* ---- fits ------------------------------------------------------------------------------------ */

bool imki_fit(size_t rows, size_t columns, const double *a, const double *y, double reading_sigma,
              double *x, double *sigma)
{
    double qr[IMKI_FIT_ROWS * IMKI_FIT_COLUMNS], b[IMKI_FIT_ROWS], beta[IMKI_FIT_COLUMNS];
    double covariance[IMKI_FIT_COLUMNS * IMKI_FIT_COLUMNS], variance = 0.0;
    if (rows <= columns || rows > IMKI_FIT_ROWS || columns > IMKI_FIT_COLUMNS)
        return false;
    memcpy(qr, a, rows * columns * sizeof *a);
    memcpy(b, y, rows * sizeof *y);
    if (imk_qr_factor(rows, columns, qr, beta) != IMK_OK ||
        imk_qr_solve(rows, columns, qr, beta, b, x) != IMK_OK ||
        imk_qr_covariance(rows, columns, qr, covariance) != IMK_OK)
        return false;
    for (size_t i = columns; i < rows; i++) /* b is Q^T y: its tail is what the fit leaves */
        variance += b[i] * b[i] / (double)(rows - columns);
    if (variance < reading_sigma * reading_sigma)
        variance = reading_sigma * reading_sigma;
    for (size_t k = 0; k < columns; k++)
        sigma[k] = sqrt(variance * covariance[k * columns + k]);
    return true;
}
