/* SPDX-License-Identifier: Apache-2.0 */
/* Benches with a magnetometer, from samples: a unit that rests in attitudes turned by hand, or is
 * turned all the time. */
#ifndef IMUKIT_TEST_MAGNETOMETER_BENCH_H
#define IMUKIT_TEST_MAGNETOMETER_BENCH_H

#include "imukit/attitude.h"
#include "imukit/magnetometer.h"
#include "imukit/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAG_BENCH_ROWS = 60000, MAG_BENCH_OBSERVATIONS = 4096 };

typedef struct mag_bench_plan {
    int rests, rows;    /* of each rest; rests 0: turned all the time, `rows` in all */
    int held;           /* rows of one update */
    double noise;       /* of an update [T] */
    double step;        /* of the output [T]; 0: fine */
    double disturbance; /* 1 sigma of what the field differs from place to place, each axis [T] */
    double wander;      /* the same while it is turned, over some seconds [T] */
    double bad;         /* share of rests next to steel: 10 uT more */
    double up_sigma;    /* of the vertical [rad] */
    double up_stated;   /* what is said of it; 0: the truth [rad] */
    double field, dip;  /* [T], [rad] */
    double tilt;        /* attitudes within this of each other [rad]; 0: all */
    double field_sigma; /* given with this sigma; 0: exactly; negative: not given */
    bool no_up;
} mag_bench_plan;

typedef struct mag_bench {
    double value[3][MAG_BENCH_ROWS];
    imk_magnetometer_observation observation[MAG_BENCH_OBSERVATIONS];
    double scratch[MAG_BENCH_OBSERVATIONS];
    double truth[IMK_MAGNETOMETER_PARAMETERS];
    imk_test_record record;
    imk_magnetometer problem;
    imk_magnetometer_result result;
    imk_random random;
    uint32_t number;
    uint64_t drawn;
} mag_bench;

static inline double mag_normal(mag_bench *b)
{
    double x;
    imk_random_normals(b->random, imk_stream(b->number, 1, 0, 0), b->drawn++, 1, &x);
    return x;
}

/* Hard iron some ten uT, soft iron some per cent, alignment some degrees. */
static inline void mag_truth(mag_bench *b, const mag_bench_plan *plan)
{
    for (int i = 0; i < 3; i++)
        b->truth[i] = 20e-6 * mag_normal(b);
    for (int i = 0; i < 9; i++)
        b->truth[3 + i] = (i % 4 == 0) + 0.04 * mag_normal(b);
    for (int i = 0; plan->no_up && i < 9; i++) /* symmetric */
        b->truth[3 + 3 * (i % 3) + i / 3] = b->truth[3 + i];
    const double *a = b->truth + 3;
    const double volume = a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) +
                          a[2] * (a[3] * a[7] - a[4] * a[6]);
    const double scale = cbrt(volume);
    b->truth[IMK_MAGNETOMETER_FIELD] = plan->field;
    b->truth[IMK_MAGNETOMETER_DIP] = sin(plan->dip);
    if (plan->field_sigma >= 0.0)
        return;
    for (int i = 0; i < 9; i++) /* what the convention makes of it */
        b->truth[3 + i] /= scale;
    b->truth[IMK_MAGNETOMETER_FIELD] *= scale;
}

/* A rotation, any, or about a level one. */
static inline imk_quaternion mag_attitude(mag_bench *b, const mag_bench_plan *plan)
{
    double q[4], norm = 0.0;
    for (int i = 0; i < 4; i++)
        q[i] = mag_normal(b) * (plan->tilt > 0.0 && i > 0 ? 0.5 * plan->tilt : 1.0);
    if (plan->tilt > 0.0)
        q[0] = 1.0;
    for (int i = 0; i < 4; i++)
        norm += q[i] * q[i];
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(norm);
    return (imk_quaternion){q[0], q[1], q[2], q[3]};
}

static inline imk_vector3 mag_in_body(imk_quaternion q, imk_vector3 v)
{
    return imk_quaternion_rotate(imk_quaternion_conjugate(q), v);
}

static inline void mag_row(mag_bench *b, const mag_bench_plan *plan, size_t row,
                           const double field[3])
{
    for (int i = 0; i < 3; i++) {
        double m = b->truth[i] + plan->noise * mag_normal(b);
        for (int j = 0; j < 3; j++)
            m += b->truth[3 + 3 * i + j] * field[j];
        if (plan->step > 0.0)
            m = plan->step * floor(m / plan->step + 0.5);
        const bool fresh = plan->held < 2 || row % (size_t)plan->held == 0;
        b->value[i][row] = fresh ? m : b->value[i][row - 1];
    }
}

static inline imk_vector3 mag_level(const mag_bench *b)
{
    const double s = b->truth[IMK_MAGNETOMETER_DIP], f = b->truth[IMK_MAGNETOMETER_FIELD];
    return (imk_vector3){{f * sqrt(1.0 - s * s), 0.0, f * s}};
}

/* The samples of a rest, and its vertical. */
static inline void mag_rest(mag_bench *b, const mag_bench_plan *plan, int k,
                            imk_magnetometer_observation *o)
{
    const imk_quaternion q = mag_attitude(b, plan);
    imk_vector3 u = mag_in_body(q, mag_level(b));
    const imk_vector3 up = mag_in_body(q, (imk_vector3){{0.0, 0.0, -1.0}});
    const bool bad = floor((k + 1.001) * plan->bad) > floor((k + 0.001) * plan->bad);
    double away[3], norm = 0.0;
    for (int i = 0; i < 3; i++)
        u.v[i] += plan->disturbance * mag_normal(b) + (bad ? 10e-6 * mag_normal(b) : 0.0);
    for (size_t row = (size_t)k * plan->rows; row < (size_t)(k + 1) * plan->rows; row++)
        mag_row(b, plan, row, u.v);
    for (int i = 0; i < 3; i++) {
        away[i] = up.v[i] + plan->up_sigma * mag_normal(b);
        norm += away[i] * away[i];
    }
    for (int i = 0; i < 3 && !plan->no_up; i++)
        o->up[i] = away[i] / sqrt(norm);
    o->up_sigma = plan->up_stated > 0.0 ? plan->up_stated : plan->up_sigma;
}

static inline void mag_rests(mag_bench *b, const mag_bench_plan *plan)
{
    static imk_magnetometer_observation up[MAG_BENCH_OBSERVATIONS];
    memset(up, 0, sizeof up);
    for (int k = 0; k < plan->rests; k++)
        mag_rest(b, plan, k, &up[k]);
    b->record.count = (size_t)plan->rests * plan->rows;
    b->problem.count = (size_t)plan->rests;
    const imk_magnetometer_record look = imk_magnetometer_look(&b->record);
    for (int k = 0; k < plan->rests; k++) {
        imk_magnetometer_observation *o = &b->observation[k];
        imk_magnetometer_rest(&b->record, &look, (size_t)k * plan->rows,
                              (size_t)(k + 1) * plan->rows, o);
        memcpy(o->up, up[k].up, sizeof o->up);
        o->up_sigma = up[k].up_sigma;
    }
    imk_magnetometer_pool(b->problem.count, b->observation);
}

/* Turned by hand: the rate about each axis is a Gauss-Markov process, some 60 deg/s over 1 s. */
static inline void mag_turning(mag_bench *b, const mag_bench_plan *plan)
{
    static const double dt = 0.01, rate = 1.0, fade = 0.99, slow = 0.995;
    imk_quaternion q = {1, 0, 0, 0};
    double w[3] = {0, 0, 0}, away[3] = {0, 0, 0};
    for (size_t row = 0; row < (size_t)plan->rows; row++) {
        imk_vector3 u;
        for (int i = 0; i < 3; i++) {
            w[i] = fade * w[i] + sqrt(1 - fade * fade) * rate * mag_normal(b);
            away[i] = slow * away[i] + sqrt(1 - slow * slow) * plan->wander * mag_normal(b);
        }
        q = imk_quaternion_multiply(q, imk_quaternion_from_rotation_vector(
                                           (imk_vector3){{w[0] * dt, w[1] * dt, w[2] * dt}}));
        u = mag_in_body(q, mag_level(b));
        for (int i = 0; i < 3; i++)
            u.v[i] += away[i];
        mag_row(b, plan, row, u.v);
    }
}

/* One bench: @return as imk_magnetometer_solve() */
static inline imk_status mag_bench_run(mag_bench *b, const mag_bench_plan *plan, uint64_t seed,
                                       uint32_t number)
{
    b->random = imk_random_seeded(seed);
    b->number = number;
    b->drawn = 0;
    b->record = (imk_test_record){.count = MAG_BENCH_ROWS, .dt = 0.01};
    for (int i = 0; i < 3; i++)
        b->record.mag[i] = b->value[i];
    mag_truth(b, plan);
    b->problem = imk_magnetometer_default();
    b->problem.observation = b->observation;
    if (plan->field_sigma >= 0.0) {
        b->problem.field = plan->field + plan->field_sigma * mag_normal(b);
        b->problem.field_sigma = plan->field_sigma;
    }
    if (plan->rests > 0) {
        mag_rests(b, plan);
    } else {
        mag_turning(b, plan);
        b->record.count = (size_t)plan->rows;
        b->problem.count =
            imk_magnetometer_motion(&b->record, MAG_BENCH_OBSERVATIONS, b->observation);
        b->problem.series = true;
    }
    return imk_magnetometer_solve(&b->problem, &b->result, b->scratch, NULL);
}

#endif
