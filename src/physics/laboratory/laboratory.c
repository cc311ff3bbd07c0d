/* SPDX-License-Identifier: Apache-2.0 */
/* The laboratory: checks, and the order of the experiments. */
#include "laboratory_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x494D4B22, TRIALS_MAX = IMK_LABORATORY_POINTS_MAX };

imk_laboratory imk_laboratory_default(void)
{
    return (imk_laboratory){.cookie = COOKIE,
                            .physics = imk_physics_default(),
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

static size_t record_samples(const imk_laboratory *laboratory)
{
    return laboratory->record > 0.0
               ? imki_samples_in(laboratory->record * (1.0 - 1e-12), laboratory->physics.rate)
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

static imk_status check(const imk_laboratory *l, void *state, imk_error *error)
{
    if (l->cookie != COOKIE || !l->instrument || !l->design)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "laboratory", NULL,
                             "start from imk_laboratory_default(), with an instrument");
    if (!(l->full_scale >= 0.0 && l->full_scale <= 1e9))
        return imki_refuse(error, IMK_ERROR_RANGE, "full_scale", l->full_scale, 0.0,
                           "a full scale above 0, or 0 for the default");
    if (l->points != 0 &&
        !(l->points >= 7 && l->points <= IMK_LABORATORY_POINTS_MAX && l->points % 2 == 1))
        return imki_refuse(error, IMK_ERROR_RANGE, "points", l->points, 0.0,
                           "an odd number from 7 to 101");
    if (!(l->settle >= 0.0 && l->settle <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "settle", l->settle, 0.0,
                           "a time from 0 to 1e6 s");
    if (!(l->dwell > 0.0 && l->dwell <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "dwell", l->dwell, 0.0,
                           "a time above 0, up to 1e6 s");
    if (l->frequencies < 0 || l->frequencies > IMK_LABORATORY_FREQUENCIES_MAX)
        return imki_refuse(error, IMK_ERROR_RANGE, "frequencies", l->frequencies, 0.0,
                           "0 to 48 frequencies");
    if (!(l->lowest >= 0.0 && l->highest >= 0.0 && l->highest <= 1e9 &&
          (l->highest <= 0.0 || l->lowest < l->highest)))
        return imki_refuse(error, IMK_ERROR_RANGE, "highest", l->highest, 0.0,
                           "a highest frequency above the lowest");
    if (!(l->record >= 0.0 && l->record * l->physics.rate <= 1e10))
        return imki_refuse(error, IMK_ERROR_RANGE, "record", l->record, 0.0,
                           "at most 1e10 samples");
    if (l->record > 0.0 && record_samples(l) < 256)
        return imki_refuse(error, IMK_ERROR_RANGE, "record", l->record, 0.0,
                           "a record of at least 256 samples");
    return imk_instrument_init(l->instrument, l->design, &l->physics, state, error);
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
    if (imk_instrument_init(instrument, laboratory->design, &laboratory->physics, state, NULL) !=
        IMK_OK)
        return;
    for (size_t i = imki_samples_in(laboratory->settle, laboratory->physics.rate); i > 0; i--)
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
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
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
    imk_instrument_reduce(instrument, laboratory->design, model);
    imk_triad *triad = imk_model_triad_to_set(&result->model, laboratory->instrument->sensor);
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

imk_status imk_laboratory_run(const imk_laboratory *laboratory, const imk_executor *executor,
                              imk_laboratory_result *result, void *workspace, size_t workspace_size,
                              imk_error *error)
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
