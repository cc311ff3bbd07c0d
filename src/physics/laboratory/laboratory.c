/* SPDX-License-Identifier: Apache-2.0 */
/* The laboratory: checks, the order of the experiments, and how a single point is measured. */
#include "laboratory_internal.h"

#include "base/workspace_internal.h"
#include "imukit/elementary.h"
#include "imukit/linear_algebra.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x494D4B22, BATCHES = 16, RAMP = 32, TRIALS_MAX = IMK_LABORATORY_POINTS_MAX };

imk_laboratory imk_laboratory_default(void)
{
    return (imk_laboratory){.cookie = COOKIE,
                            .physics = imk_physics_settings_default(),
                            .surroundings = imk_exposure_default(),
                            .points = 21,
                            .settle = 0.2,
                            .dwell = 1.0,
                            .threshold = true,
                            .tumble = true,
                            .temperature = true,
                            .frequencies = 16,
                            .record = 60.0};
}

/* ---- single points --------------------------------------------------------------------------- */

imki_trial imki_trial_of(const imk_laboratory *laboratory, double input)
{
    imki_trial trial = {.exposure = laboratory->surroundings, .input = input};
    if (laboratory->instrument->sensor == IMK_GYRO)
        trial.exposure.angular_rate[0] += input;
    else
        trial.exposure.specific_force[0] += input;
    return trial;
}

static size_t samples_in(double time, double rate)
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
    const size_t part = (samples_in(laboratory->dwell, rate) + BATCHES - 1) / BATCHES;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], batch[BATCHES], mean = 0.0, scatter = 0.0;
    bring_to_speed(laboratory, trial, state);
    for (size_t i = samples_in(laboratory->settle, rate); i > 0; i--)
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
    const size_t settle = samples_in(laboratory->settle + 4.0 / trial->frequency, 1.0 / dt);
    const size_t wanted = samples_in(laboratory->dwell, trial->frequency);
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
    if (laboratory->instrument->init(laboratory->design, &physics, state, NULL) != IMK_OK)
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

/* ---- the whole ------------------------------------------------------------------------------- */

size_t imki_state_size(const imk_laboratory *laboratory)
{
    return (laboratory->instrument->state_size + 63) / 64 * 64;
}

static size_t record_samples(const imk_laboratory *laboratory)
{
    return laboratory->record > 0.0
               ? samples_in(laboratory->record * (1.0 - 1e-12), laboratory->physics.rate)
               : 0;
}

size_t imk_laboratory_workspace_size(const imk_laboratory *laboratory)
{
    const size_t samples = record_samples(laboratory);
    size_t size = TRIALS_MAX * imki_state_size(laboratory) + 2 * IMKI_ALIGNMENT_SLACK;
    if (samples > 0)
        size += samples * sizeof(double) + imk_identify_workspace_size(samples);
    return size;
}

static imk_status refuse(imk_error *error, const char *field, double value, const char *expected)
{
    imk_error_set(error, IMK_ERROR_RANGE, field, "", expected);
    if (error) {
        error->index = -1;
        error->value = value;
    }
    return IMK_ERROR_RANGE;
}

static imk_status check(const imk_laboratory *l, void *state, imk_error *error)
{
    if (l->cookie != COOKIE || !l->instrument || !l->design)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "laboratory", NULL,
                             "settings made by imk_laboratory_default(), with an instrument");
    if (!(l->full_scale >= 0.0 && l->full_scale <= 1e9))
        return refuse(error, "full_scale", l->full_scale, "a full scale above 0");
    if (l->points != 0 &&
        !(l->points >= 7 && l->points <= IMK_LABORATORY_POINTS_MAX && l->points % 2 == 1))
        return refuse(error, "points", l->points, "an odd number from 7 to 101");
    if (!(l->settle >= 0.0 && l->settle <= 1e6))
        return refuse(error, "settle", l->settle, "a time from 0 to 1e6 s");
    if (!(l->dwell > 0.0 && l->dwell <= 1e6))
        return refuse(error, "dwell", l->dwell, "a time above 0, up to 1e6 s");
    if (l->frequencies < 0 || l->frequencies > IMK_LABORATORY_FREQUENCIES_MAX)
        return refuse(error, "frequencies", l->frequencies, "0 to 48 frequencies");
    if (!(l->lowest >= 0.0 && l->highest >= 0.0 && l->highest <= 1e9 &&
          (l->highest <= 0.0 || l->lowest < l->highest)))
        return refuse(error, "highest", l->highest, "a highest frequency above the lowest");
    if (!(l->record >= 0.0 && l->record * l->physics.rate <= 1e10))
        return refuse(error, "record", l->record, "at most 1e10 samples");
    if (l->record > 0.0 && record_samples(l) < 256)
        return refuse(error, "record", l->record, "a record of at least 256 samples");
    return l->instrument->init(l->design, &l->physics, state, error);
}

static double full_scale_of(const imk_laboratory *laboratory, double range)
{
    if (laboratory->full_scale > 0.0)
        return laboratory->full_scale;
    if (range > 0.0) /* a bias must not push a reading over the end */
        return 0.8 * range;
    return laboratory->instrument->sensor == IMK_GYRO ? 1.0 : 10.0;
}

/* Noise by identification. An instrument without noise has none to find, which is no error. */
static void static_record(const imk_laboratory *laboratory, char *state, double *samples,
                          imk_laboratory_result *result)
{
    const imk_instrument *instrument = laboratory->instrument;
    const size_t count = record_samples(laboratory);
    imk_identify_settings settings = imk_identify_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX];
    settings.dt = 1.0 / laboratory->physics.rate;
    if (instrument->init(laboratory->design, &laboratory->physics, state, NULL) != IMK_OK)
        return;
    for (size_t i = samples_in(laboratory->settle, laboratory->physics.rate); i > 0; i--)
        instrument->step(state, &laboratory->surroundings, outputs);
    for (size_t i = 0; i < count; i++) {
        instrument->step(state, &laboratory->surroundings, outputs);
        samples[i] = outputs[0];
    }
    result->has_noise =
        imk_identify_channel(&settings, count, samples, &result->noise, samples + count,
                             imk_identify_workspace_size(count), NULL) == IMK_OK;
    if (!result->has_noise)
        return;
    imk_triad *triad = imki_triad_of(laboratory, result);
    const imk_axes bandwidth = triad->bandwidth; /* the shaker's, not that of the noise */
    imk_identification_store(&result->noise, &result->model, instrument->sensor == IMK_ACCEL, 0);
    if (bandwidth.value[0] > 0.0)
        triad->bandwidth = bandwidth;
    /* The roundings at the two ends of a record look like white noise of 2 Q/sqrt(T), see
     * docs/theory/identification.md: what is not above that is not known. */
    imk_axes *white = &triad->noise.white;
    const double ends = 2.0 * triad->noise.quantization.value[0] / sqrt(laboratory->record);
    white->sigma[0] = sqrt(white->sigma[0] * white->sigma[0] + ends * ends);
}

/* What reduce says of the axes. */
typedef struct stated_axes {
    double direction[IMK_AXES_MAX][3], pendulous_axis[IMK_AXES_MAX][3];
    imk_axes range;
    double bandwidth; /* of the first */
} stated_axes;

/* A model of one axis with no errors, and what reduce says of the axes. */
static stated_axes begin_model(const imk_laboratory *laboratory, imk_laboratory_result *result)
{
    const imk_instrument *instrument = laboratory->instrument;
    imk_model *model = &result->model;
    instrument->reduce(laboratory->design, model);
    imk_triad *triad = imki_triad_of(laboratory, result);
    stated_axes stated = {.range = triad->range, .bandwidth = triad->bandwidth.value[0]};
    memcpy(stated.direction, triad->direction, sizeof stated.direction);
    memcpy(stated.pendulous_axis, triad->nonlinearity.pendulous_axis, sizeof stated.pendulous_axis);
    imk_model_default(model);
    (instrument->sensor == IMK_GYRO ? &model->accel : &model->gyro)->present = false;
    triad->axis_count = 1;
    memcpy(triad->direction, stated.direction, sizeof stated.direction);
    memcpy(triad->nonlinearity.pendulous_axis, stated.pendulous_axis, sizeof stated.pendulous_axis);
    triad->range = stated.range;
    return stated;
}

imk_status imk_laboratory_run(const imk_laboratory *laboratory, void *workspace,
                              size_t workspace_size, const imk_executor *executor,
                              imk_laboratory_result *result, imk_error *error)
{
    char *states = (char *)imki_align(workspace);
    if (laboratory->instrument && workspace_size < imk_laboratory_workspace_size(laboratory))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "laboratory", NULL,
                             "imk_laboratory_workspace_size() bytes");
    const imk_status status = check(laboratory, states, error);
    if (status != IMK_OK)
        return status;
    const imk_instrument *instrument = laboratory->instrument;
    memset(result, 0, sizeof *result);
    const stated_axes stated = begin_model(laboratory, result);
    result->full_scale = full_scale_of(laboratory, stated.range.value[0]);
    imki_zero_readings(laboratory, states, executor, result);
    if (laboratory->points > 0) {
        imki_rate_table(laboratory, states, executor, result);
        if (instrument->sensor == IMK_GYRO)
            imki_cross_rates(laboratory, states, executor, result);
    }
    if (laboratory->threshold)
        imki_threshold(laboratory, states, executor, result);
    if (laboratory->tumble)
        imki_tumble(laboratory, stated.pendulous_axis[0], states, executor, result);
    if (laboratory->temperature)
        imki_chamber(laboratory, states, executor, result);
    if (laboratory->frequencies > 0)
        imki_shaker(laboratory, stated.bandwidth, states, executor, result);
    if (laboratory->record > 0.0)
        static_record(laboratory, states,
                      (double *)(void *)(states + TRIALS_MAX * imki_state_size(laboratory)),
                      result);
    return IMK_OK;
}
