/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of a rate table in steps with a column of the reference that comes late: a gyro with white
 * noise and a hysteresis of 0.10 % of full scale, evaluated by the job. Used by the tests and by
 * experiments/coverage_evaluate.c. */
#ifndef IMUKIT_TEST_DELAYED_REFERENCE_H
#define IMUKIT_TEST_DELAYED_REFERENCE_H

#include "imukit/evaluate_log.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DELAYED_STEPS = 25, DELAYED_STEP = 500, DELAYED_COUNT = DELAYED_STEPS * DELAYED_STEP };
static const double delayed_dt = 0.01, delayed_scale = 5.0, delayed_hysteresis = 1e-3;

typedef struct delayed_reference {
    double rate[DELAYED_COUNT], reference[DELAYED_COUNT], zero[DELAYED_COUNT];
    double reading[3][DELAYED_COUNT], noise[3 * DELAYED_COUNT];
    imk_calibrate_record log;
    double delay, delay_sigma; /* found */
    imk_evaluation_figure hysteresis;
    bool warned;
} delayed_reference;

static inline double delayed_level(int step)
{
    static const double level[12] = {0, 1, 2, 3, 2, 1, 0, -1, -2, -3, -2, -1};
    return step < 0 ? 0.0 : delayed_scale / 3.0 * level[step % 12];
}

/* Rate of the programme at t: ramps of half a second, then the level. */
static inline double delayed_rate(double t)
{
    const double length = DELAYED_STEP * delayed_dt;
    int step = (int)floor(t / length);
    step = step < DELAYED_STEPS ? step : DELAYED_STEPS - 1;
    if (step < 0)
        return 0.0;
    const double x = fmin(1.0, (t - step * length) / 0.5);
    const double s = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x), from = delayed_level(step - 1);
    return from + (delayed_level(step) - from) * s;
}

/* The unit reads less where it rises than where it falls, except at both ends. */
static inline void delayed_log(delayed_reference *d, double delay, uint64_t seed)
{
    double side = 0.0;
    imk_random_normals(imk_random_seeded(seed), 0xDE1A, 0, 3 * DELAYED_COUNT, d->noise);
    for (int k = 0; k < DELAYED_COUNT; k++) {
        const double t = (k + 0.5) * delayed_dt;
        d->rate[k] = delayed_rate(t);
        d->reference[k] = delayed_rate(t - delay);
        d->zero[k] = 0.0;
        const double change = d->rate[k] - (k > 0 ? d->rate[k - 1] : 0.0);
        side = change > 1e-12 ? 1.0 : change < -1e-12 ? -1.0 : side;
        const double loop = fabs(d->rate[k]) < 0.99 * delayed_scale ? side : 0.0;
        d->reading[2][k] = 1e-3 + 1.0005 * d->rate[k] -
                           0.5 * loop * delayed_hysteresis * delayed_scale * 1.0005 +
                           1e-3 * d->noise[k];
        for (int axis = 0; axis < 2; axis++)
            d->reading[axis][k] =
                0.003 * d->rate[k] + 1e-3 * d->noise[(axis + 1) * DELAYED_COUNT + k];
    }
}

/* Evaluate the log. @return whether it could be */
static inline bool delayed_evaluate(delayed_reference *d, bool keep_delay)
{
    imk_evaluate_log_settings settings = imk_evaluate_log_default();
    imk_evaluate_log *v;
    imk_error error;
    settings.keep_delay = keep_delay;
    memset(&d->log, 0, sizeof d->log);
    d->log.path = "delayed";
    d->log.record = (imk_test_record){
        .name = "delayed", .count = DELAYED_COUNT, .dt = delayed_dt, .axis_count = {3, 0}};
    for (int axis = 0; axis < 3; axis++) {
        d->log.record.reading[IMK_GYRO][axis] = d->reading[axis];
        d->log.record.reference_rate[axis] = axis == 2 ? d->reference : d->zero;
    }
    if (imk_evaluate_log_create(&settings, NULL, &v, &error) != IMK_OK)
        return false;
    bool done = imk_evaluate_record(v, &d->log, &error) == IMK_OK && v->channel_count == 1;
    if (done) {
        imk_evaluate_channel_settings(v, &v->channel[0]);
        done = imk_evaluate_channel_run(v, &v->channel[0], &error) == IMK_OK;
    }
    if (done) {
        d->hysteresis = v->channel[0].result.hysteresis;
        d->delay = v->delay;
        d->delay_sigma = v->delay_sigma;
        d->warned = v->findings.count > 0;
    }
    imk_evaluate_log_free(v);
    return done;
}

#endif
