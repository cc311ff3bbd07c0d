/* SPDX-License-Identifier: Apache-2.0 */
/* The laboratory: checks, and the order of the experiments. */
#include "laboratory_internal.h"

#include "base/refuse_internal.h"
#include "base/workspace_internal.h"

#include <math.h>
#include <string.h>

enum { COOKIE = 0x494D4B22 };

imk_laboratory imk_laboratory_default(void)
{
    return (imk_laboratory){.cookie = COOKIE,
                            .physics = imk_physics_default(),
                            .surroundings = imk_exposure_default(),
                            .points = 21,
                            .cycles = 6,
                            .settle = -1.0,
                            .dwell = 0.16,
                            .threshold = true,
                            .tumble = true,
                            .temperature = true,
                            .frequencies = 16,
                            .record = -1.0,
                            .quick = true};
}

size_t imk_laboratory_workspace_size(const imk_laboratory *laboratory)
{
    const size_t samples = imki_record_samples(laboratory);
    size_t size =
        sizeof(imki_bench) + IMKI_STATES * imki_state_size(laboratory) + 4 * IMKI_ALIGNMENT_SLACK;
    if (samples > 0)
        size += samples * sizeof(double) + imk_identify_workspace_size(samples);
    return size;
}

static imk_status check(const imk_laboratory *l, void *state, imk_error *error)
{
    if (!(l->full_scale >= 0.0 && l->full_scale <= 1e9))
        return imki_refuse(error, IMK_ERROR_RANGE, "full_scale", l->full_scale, 0.0,
                           "a full scale above 0, or 0 for the default");
    if (l->points != 0 &&
        !(l->points >= 7 && l->points <= IMK_LABORATORY_POINTS_MAX && l->points % 2 == 1))
        return imki_refuse(error, IMK_ERROR_RANGE, "points", l->points, 0.0,
                           "an odd number from 7 to 101");
    if (l->cycles < 3 || l->cycles > 255)
        return imki_refuse(error, IMK_ERROR_RANGE, "cycles", l->cycles, 0.0, "3 to 255");
    if (!(l->longest >= 0.0 && l->longest <= 1e12))
        return imki_refuse(error, IMK_ERROR_RANGE, "longest", l->longest, 0.0,
                           "a time from 0 to 1e12 s");
    if (!(l->settle <= 1e6))
        return imki_refuse(error, IMK_ERROR_RANGE, "settle", l->settle, 0.0,
                           "a time from 0 to 1e6 s, or a negative number");
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
    if (!(l->record * l->physics.rate <= 1e10))
        return imki_refuse(error, IMK_ERROR_RANGE, "record", l->record, 0.0,
                           "at most 1e10 samples");
    if (l->record > 0.0 && imki_record_samples(l) < 256)
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
    return laboratory->instrument->sensor == IMK_GYRO ? 0.1 : 10.0;
}

/* What reduce says, and then a model of one axis with no errors. */
static void begin_model(imki_bench *b)
{
    const imk_instrument *instrument = b->laboratory->instrument;
    imk_model *model = &b->result->model;
    double direction[IMK_AXES_MAX][3], pendulous_axis[IMK_AXES_MAX][3];
    imk_instrument_reduce(instrument, b->laboratory->design, model);
    imk_triad *triad = b->triad = imk_model_triad_to_set(model, instrument->sensor);
    const imk_axes range = triad->range;
    b->bandwidth = triad->bandwidth.value[0];
    b->result->full_scale = full_scale_of(b->laboratory, range.value[0]);
    memcpy(direction, triad->direction, sizeof direction);
    memcpy(pendulous_axis, triad->nonlinearity.pendulous_axis, sizeof pendulous_axis);
    memcpy(b->pendulous_axis, pendulous_axis[0], sizeof b->pendulous_axis);
    imki_matters(b, model);
    imk_model_default(model);
    (instrument->sensor == IMK_GYRO ? &model->accel : &model->gyro)->present = false;
    triad->axis_count = 1;
    memcpy(triad->direction, direction, sizeof direction);
    memcpy(triad->nonlinearity.pendulous_axis, pendulous_axis, sizeof pendulous_axis);
    triad->range = range;
}

/* A step of the instruments takes 0.04 us where it is one of many to a sample, up to ten times as
 * much where it is long, as there is more to do for each. */
double imki_longest(const imki_bench *b, double rate, bool quick)
{
    static const double shared = 0.04e-6, own = 0.4e-6, long_step = 3e-4; /* [s] */
    const double computing = quick ? 6.0 : 4.0;
    const imk_laboratory *l = b->laboratory;
    imk_physics_settings physics = imki_cycle(b, 0, quick);
    if (l->longest > 0.0)
        return l->longest;
    physics.rate = rate;
    double step = physics.step > 0.0 || !l->instrument->step_length
                      ? physics.step
                      : l->instrument->step_length(l->design, &physics);
    step = step > 0.0 ? fmin(step, 1.0 / rate) : 1.0 / rate;
    return computing * step / (shared + own * fmin(1.0, step / long_step));
}

/* The slow level where there is one, and how long experiments may be. */
static void choose_levels(imki_bench *b)
{
    const imk_laboratory *l = b->laboratory;
    imk_physics_settings physics = l->physics;
    b->slow = physics.level;
    physics.level = IMK_LEVEL_SLOW;
    physics.step = 0.0;
    if (l->quick &&
        imk_instrument_init(l->instrument, l->design, &physics, b->states, NULL) == IMK_OK)
        b->slow = IMK_LEVEL_SLOW;
    for (int quick = 0; quick < 2; quick++)
        b->longest[quick] = imki_longest(b, l->physics.rate, quick);
}

static void run_all(imki_bench *b)
{
    const imk_laboratory *l = b->laboratory;
    imki_power_cycles(b);
    if (l->points > 0 && !b->cancelled) {
        imki_rate_table(b);
        if (l->instrument->sensor == IMK_GYRO && !b->cancelled)
            imki_cross_rates(b);
    }
    if (l->threshold && !b->cancelled)
        imki_threshold(b);
    if (l->tumble && !b->cancelled)
        imki_tumble(b);
    if (l->temperature && !b->cancelled)
        imki_chamber(b);
    if (l->frequencies > 0 && !b->cancelled)
        imki_shaker(b);
    if (b->samples > 0 && !b->cancelled)
        imki_record(b);
}

/* Parts of the workspace. */
static imki_bench *divide(const imk_laboratory *laboratory, void *workspace)
{
    char *place = (char *)imki_align(workspace);
    imki_bench *b = (imki_bench *)(void *)place;
    memset(b, 0, sizeof *b);
    b->laboratory = laboratory;
    b->states = (char *)imki_align(place + sizeof *b);
    b->samples = imki_record_samples(laboratory);
    b->record = (double *)imki_align(b->states + IMKI_STATES * imki_state_size(laboratory));
    b->identification = imki_align(b->record + b->samples);
    return b;
}

imk_status imk_laboratory_run(const imk_laboratory *laboratory, const imk_executor *executor,
                              imk_laboratory_result *result, void *workspace, size_t workspace_size,
                              imk_error *error)
{
    if (laboratory->cookie != COOKIE || !laboratory->instrument || !laboratory->design)
        return imk_error_set(error, IMK_ERROR_UNINITIALISED, "laboratory", NULL,
                             "start from imk_laboratory_default(), with an instrument");
    if (workspace_size < imk_laboratory_workspace_size(laboratory))
        return imk_error_set(error, IMK_ERROR_WORKSPACE, "laboratory", NULL,
                             "imk_laboratory_workspace_size() bytes");
    imki_bench *b = divide(laboratory, workspace);
    const imk_status status = check(laboratory, b->states, error);
    if (status != IMK_OK)
        return status;
    memset(result, 0, sizeof *result);
    b->executor = executor;
    b->result = result;
    begin_model(b);
    choose_levels(b);
    b->settle = imki_settling_time(b);
    run_all(b);
    return b->cancelled ? imk_error_set(error, IMK_ERROR_CANCELLED, NULL, NULL, NULL) : IMK_OK;
}
