/* SPDX-License-Identifier: Apache-2.0 */
/* Simulated benches of the procedures that have a reference: programmes of rates and forces, units
 * drawn at random, their logs by the simulator. Used by tests and by experiments/. */
#ifndef IMUKIT_TEST_REFERENCE_SESSION_H
#define IMUKIT_TEST_REFERENCE_SESSION_H

#include "imukit/procedure.h"
#include "imukit/simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BENCH_SAMPLES = 40000, BENCH_OBSERVATIONS = 21000, BENCH_HOLDS = 200 };
static const double session_rate = 100.0, session_gravity = 9.80665,
                    session_pi = 3.14159265358979323846;

/* Does the unit feel the Earth turn, and what is the calibration told? */
typedef enum session_earth {
    SESSION_NO_EARTH = 0,
    SESSION_ONE_HEADING, /* forces and the latitude; the heading of the head's axis is one for all
                            holds */
    SESSION_HEADINGS,    /* the same, another heading in each hold */
    SESSION_TABLE        /* the rates of the table, relative to the ground: no forces, no
                            accelerometers, and the g-sensitivity is as large as it is assumed */
} session_earth;

/* A programme, and the log of one unit in it. */
typedef struct session {
    imk_procedure procedure;
    size_t count, holds;
    size_t hold_begin[BENCH_HOLDS], hold_end[BENCH_HOLDS];
    double rate[3][BENCH_SAMPLES], force[3][BENCH_SAMPLES], acceleration[3][BENCH_SAMPLES];
    double encoder[3][BENCH_SAMPLES]; /* the rates as the table's encoder tells them */
    double log[6][BENCH_SAMPLES], slow[6][BENCH_SAMPLES];
    imk_model truth;             /* run constants and the mean of the slow noise included */
    void (*slower)(imk_model *); /* makes the noise of a unit slower; NULL: as session_unit() */
    double unequal; /* white noise of each axis over that of the axis before it; 0: 1 */
    double
        push[2]; /* 1 sigma of what each hold adds to every gyro [rad/s], accelerometer [m/s^2] */
    double mounting, placement; /* 1 sigma of the unit on its fixture, and besides in each hold
                                   [rad]; the calibration is told `stated` of them */
    double stated;
    bool noise_known; /* the calibration is told the noise */
    session_earth earth;
    imk_test_record record;
    imk_procedure_settings settings;
    imk_calibration calibration;
    imk_calibration_result result;
    imk_procedure_findings findings;
    imk_observation observation[BENCH_OBSERVATIONS];
    void *workspace;
    size_t workspace_size;
} session;

/* ---- programmes ------------------------------------------------------------------------------
 */

/* Go smoothly to a rate and a force, 10 x^3 - 15 x^4 + 6 x^5, and stay there. */
static inline void session_go(session *b, const double rate[3], const double force[3],
                              double change, double hold)
{
    const size_t ramp = (size_t)(change * session_rate), stay = (size_t)(hold * session_rate);
    const size_t from = b->count;
    if (from + ramp + stay > BENCH_SAMPLES || b->holds == BENCH_HOLDS)
        abort();
    for (int j = 0; j < 3; j++) {
        const double r0 = from > 0 ? b->rate[j][from - 1] : rate[j];
        const double f0 = from > 0 ? b->force[j][from - 1] : force[j];
        for (size_t k = 0; k < ramp + stay; k++) {
            const double x = k < ramp ? ((double)k + 0.5) / (double)ramp : 1.0;
            const double s = k < ramp ? x * x * x * (10.0 - 15.0 * x + 6.0 * x * x) : 1.0;
            b->rate[j][from + k] = r0 + (rate[j] - r0) * s;
            b->force[j][from + k] = f0 + (force[j] - f0) * s;
            b->acceleration[j][from + k] = (rate[j] - r0) * 30.0 * x * x * (1.0 - x) * (1.0 - x) /
                                           ((double)(ramp > 0 ? ramp : 1) / session_rate);
        }
    }
    b->hold_begin[b->holds] = from + ramp;
    b->hold_end[b->holds++] = b->count = from + ramp + stay;
}

static inline void session_along(int axis, double value, double out[3])
{
    for (int j = 0; j < 3; j++)
        out[j] = j == axis ? value : 0.0;
}

/* Each axis upright, then upside down: rates of both signs in steps. */
static inline void session_rate_steps(session *b)
{
    static const double level[] = {0.0, 0.3, 0.8, 1.5, 2.2, 3.0};
    for (int axis = 0; axis < 3; axis++)
        for (int up = 0; up < 2; up++) {
            double rate[3], force[3];
            session_along(axis, up ? session_gravity : -session_gravity, force);
            for (int i = 0; i < 6; i++)
                for (int sign = 1; sign >= (i > 0 ? -1 : 1); sign -= 2) {
                    session_along(axis, sign * level[i], rate);
                    session_go(b, rate, force, 0.5, 3.0);
                }
        }
}

/* The same in three attitudes, never upside down: the log does not tell the sum of the components
 * of g-sensitivity from the bias. */
static inline void session_rate_upright(session *b)
{
    static const double level[] = {0.0, 0.3, 0.8, 1.5, 2.2, 3.0};
    for (int axis = 0; axis < 3; axis++) {
        double rate[3], force[3];
        session_along(axis, session_gravity, force);
        for (int i = 0; i < 6; i++)
            for (int sign = 1; sign >= (i > 0 ? -1 : 1); sign -= 2) {
                session_along(axis, sign * level[i], rate);
                session_go(b, rate, force, 0.5, 3.0);
            }
    }
}

/* Only z, upright. */
static inline void session_rate_one(session *b)
{
    static const double level[] = {0.0, 0.3, 0.8, 1.5, 2.2, 3.0};
    double rate[3], force[3];
    session_along(2, session_gravity, force);
    for (int i = 0; i < 6; i++)
        for (int sign = 1; sign >= (i > 0 ? -1 : 1); sign -= 2) {
            session_along(2, sign * level[i], rate);
            session_go(b, rate, force, 0.5, 3.0);
        }
}

/* Each axis: rest, sines of two frequencies, rest. */
static inline void session_rate_sine(session *b)
{
    for (int axis = 0; axis < 3; axis++)
        for (int up = 0; up < 2; up++) {
            double rate[3] = {0.0, 0.0, 0.0}, force[3];
            session_along(axis, up ? session_gravity : -session_gravity, force);
            session_go(b, rate, force, 1.0, 2.0);
            for (int k = 0; k < 2000; k++, b->count++) {
                const double t = (k + 0.5) / session_rate, grow = fmin(fmin(t, 20.0 - t), 1.0);
                const double s = grow * grow * (3.0 - 2.0 * grow);
                for (int j = 0; j < 3; j++) {
                    b->rate[j][b->count] =
                        j == axis ? 3.0 * s * sin(2.0 * session_pi * 0.5 * t) : 0;
                    b->force[j][b->count] = force[j];
                }
            }
            session_go(b, rate, force, 0.0, 2.0);
        }
}

/* Each axis as the axis of a dividing head, level, in steps of 30 degrees. */
static inline void session_tumble(session *b)
{
    for (int axis = 0; axis < 3; axis++)
        for (int step = 0; step < 12; step++) {
            const double angle = session_pi * step / 6.0;
            const double rate[3] = {0.0, 0.0, 0.0};
            double force[3] = {0.0, 0.0, 0.0};
            force[(axis + 1) % 3] = session_gravity * cos(angle);
            force[(axis + 2) % 3] = session_gravity * sin(angle);
            session_go(b, rate, force, 1.0, 3.0);
        }
}

/* On an arm of 2 m that turns about the vertical, five levels to 10 g, in 12 mountings: along the
 * arm each axis outwards and inwards, upright each of the others. */
static inline void session_centrifuge(session *b)
{
    for (int mount = 0; mount < 12; mount++)
        for (int level = 0; level <= 5; level++) {
            const int along = mount / 4, up = (along + 1 + mount % 2) % 3;
            const double f = 2.0 * level * session_gravity;
            double rate[3] = {0.0, 0.0, 0.0}, force[3] = {0.0, 0.0, 0.0};
            rate[up] = sqrt(f / 2.0);
            force[up] = session_gravity;
            force[along] = mount / 2 % 2 ? f : -f;
            session_go(b, rate, force, 1.0, 2.0);
        }
}

/* About each axis, upright, both ways, with rests between. */
static inline void session_spin(session *b)
{
    for (int axis = 0; axis < 3; axis++) {
        double rate[3], force[3];
        session_along(axis, session_gravity, force);
        for (int i = 0; i < 5; i++) {
            session_along(axis, i % 2 == 0 ? 0.0 : i == 1 ? 15.0 : -15.0, rate);
            session_go(b, rate, force, 0.5, 4.0);
        }
    }
}

/* ---- units ---------------------------------------------------------------------------------- */

static inline void session_draw(double *value, size_t count, double sigma, uint64_t seed,
                                uint32_t which)
{
    double normal[32];
    imk_random_normals(imk_random_seeded(seed), imk_stream(which, 900, 0, 0), 0, 32, normal);
    for (size_t i = 0; i < count; i++)
        value[i] = sigma * normal[i];
}

static inline void session_rows(double row[IMK_AXES_MAX][3], bool diagonal, double sigma,
                                uint64_t seed, uint32_t which)
{
    double value[9];
    session_draw(value, 9, sigma, seed, which);
    for (int i = 0; i < 9; i++)
        row[i / 3][i % 3] = i / 3 == i % 3 && !diagonal ? 0.0 : value[i];
}

/* A unit of tactical grade: gyros 0.15 deg/sqrt(h), 0.5 deg/h; accelerometers 50 ug/sqrt(Hz), 3 ug;
 * rounded increments. Its bias instability overtakes the white noise after some 10 minutes, longer
 * than these tests last. Errors drawn, of the terms that the procedure estimates; what it does not
 * estimate is not there. */
static inline imk_model session_unit(imk_procedure procedure, uint64_t seed)
{
    imk_model m;
    imk_model_default(&m);
    const bool gyro = procedure != IMK_PROCEDURE_SPIN;
    const bool accel = procedure != IMK_PROCEDURE_RATE_TABLE && procedure != IMK_PROCEDURE_SPIN;
    for (int axis = 0; axis < 3; axis++) {
        m.gyro.noise.white.value[axis] = 0.15 / 60.0 * session_pi / 180.0;
        m.gyro.noise.bias_instability.value[axis] = 0.5 / 3600.0 * session_pi / 180.0;
        m.gyro.noise.quantization.value[axis] = 1e-6;
        m.accel.noise.white.value[axis] = 50e-6 * session_gravity;
        m.accel.noise.bias_instability.value[axis] = 3e-6 * session_gravity;
        m.accel.noise.quantization.value[axis] = 1e-5;
    }
    session_draw(m.gyro.bias.fixed.value, 3, 0.005, seed, 1);
    if (gyro)
        session_rows(m.gyro.g_sensitivity.value, true, 1e-5, seed, 4);
    if (procedure == IMK_PROCEDURE_RATE_TABLE || procedure == IMK_PROCEDURE_CENTRIFUGE) {
        session_draw(m.gyro.scale_factor.fixed.value, 3, 0.003, seed, 2);
        session_rows(m.gyro.misalignment.value, false, 0.003, seed, 3);
    }
    if (procedure == IMK_PROCEDURE_RATE_TABLE) {
        session_draw(m.gyro.nonlinearity.k2.value, 3, 1e-4, seed, 5);
        session_draw(m.gyro.nonlinearity.koq.value, 3, 1e-4, seed, 6);
        session_draw(m.gyro.nonlinearity.k3.value, 3, 3e-5, seed, 7);
        session_draw(m.gyro.nonlinearity.asymmetry.value, 3, 3e-4, seed, 8);
    }
    if (procedure == IMK_PROCEDURE_SPIN)
        session_rows(m.accel.lever_arm.value, true, 0.02, seed, 9);
    if (!accel)
        return m;
    session_draw(m.accel.bias.fixed.value, 3, 0.05, seed, 10);
    session_draw(m.accel.scale_factor.fixed.value, 3, 0.003, seed, 11);
    session_rows(m.accel.misalignment.value, false, 0.003, seed, 12);
    session_draw(m.accel.nonlinearity.k2.value, 3, 1e-5, seed, 13);
    session_draw(m.accel.nonlinearity.k3.value, 3, 1e-7, seed, 14);
    if (procedure == IMK_PROCEDURE_CENTRIFUGE) {
        session_draw(m.accel.nonlinearity.koq.value, 3, 1e-5, seed, 15);
        session_draw(m.accel.nonlinearity.asymmetry.value, 3, 3e-4, seed, 16);
    }
    return m;
}

/* ---- logs ------------------------------------------------------------------------------------
 */

static inline void session_run(const session *b, const imk_model *model, uint64_t seed,
                               uint32_t run, bool moving, double (*out)[BENCH_SAMPLES])
{
    imk_recorded_motion motion = {.count = b->count, .rate = session_rate};
    imk_simulation simulation = imk_simulation_default();
    double *columns[6];
    for (int j = 0; j < 3; j++) {
        motion.angular_rate[j] = b->rate[j];
        motion.specific_force[j] = b->force[j];
        motion.angular_acceleration[j] = b->acceleration[j];
    }
    for (int c = 0; c < 6; c++)
        columns[c] = out[c];
    simulation.rate = session_rate;
    simulation.seed = seed;
    simulation.run = run;
    simulation.earth = false;
    if (moving)
        simulation.motion.recorded = &motion;
    const size_t size = (imk_simulator_size(model, &simulation) + 63) / 64 * 64;
    void *memory = aligned_alloc(64, size);
    imk_simulator *simulator;
    if (!memory ||
        imk_simulator_start(model, &simulation, &simulator, memory, size, NULL) != IMK_OK)
        abort();
    imk_simulator_next(simulator, b->count, columns, NULL);
    free(memory);
}

/* The bias a unit has in this log: its own, and the mean of its slow noise. */
static inline void session_true_bias(session *b, uint64_t seed, uint32_t run)
{
    imk_model slow;
    imk_model_default(&slow);
    imk_triad *const triads[2] = {&slow.gyro, &slow.accel};
    const imk_triad *const own[2] = {&b->truth.gyro, &b->truth.accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_noise *noise = &triads[sensor]->noise;
        *noise = own[sensor]->noise;
        memset(&noise->white, 0, sizeof noise->white);
        memset(&noise->quantization, 0, sizeof noise->quantization);
    }
    session_run(b, &slow, seed, run, false, b->slow);
    for (int c = 0; c < 6; c++) {
        double sum = 0.0;
        for (size_t k = 0; k < b->count; k++)
            sum += b->slow[c][k];
        (c < 3 ? &b->truth.gyro : &b->truth.accel)->bias.fixed.value[c % 3] +=
            sum / (double)b->count;
    }
}

/* Programme, references, settings. */
static inline void session_start(session *b, imk_procedure procedure, void (*programme)(session *))
{
    memset(b, 0, sizeof *b);
    b->procedure = procedure;
    programme(b);
    b->settings = imk_procedure_default(procedure);
    b->record = (imk_test_record){
        .name = "bench", .count = b->count, .dt = 1.0 / session_rate, .axis_count = {3, 3}};
    for (int j = 0; j < 3; j++) {
        b->record.reading[0][j] = b->log[j];
        b->record.reading[1][j] = b->log[3 + j];
        b->record.reference_rate[j] = b->encoder[j];
        b->record.reference_force[j] = b->force[j];
    }
    b->workspace_size = imk_procedure_workspace_size(procedure, &b->record, &b->settings);
    b->workspace = malloc(b->workspace_size);
}

/* Every hold is off by as much on each axis of a sensor. */
static inline void session_push(session *b, uint64_t seed)
{
    double normal[6 * BENCH_HOLDS];
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 903, 0, 0), 0, 6 * BENCH_HOLDS,
                       normal);
    for (size_t h = 0; h < b->holds; h++)
        for (size_t k = b->hold_begin[h]; k < b->hold_end[h]; k++)
            for (size_t c = 0; c < 6; c++)
                b->log[c][k] += b->push[c / 3] * normal[6 * h + c];
}

/* Turn the motion of samples begin ... end - 1, to second order in the angles. */
static inline void session_tilt(session *b, size_t begin, size_t end, const double angle[3],
                                double sign)
{
    for (size_t k = begin; k < end; k++)
        for (int which = 0; which < 3; which++) {
            double(*const motion)[BENCH_SAMPLES] = which == 0   ? b->rate
                                                   : which == 1 ? b->force
                                                                : b->acceleration;
            double v[3], once[3];
            for (int j = 0; j < 3; j++)
                v[j] = motion[j][k];
            for (int j = 0; j < 3; j++)
                once[j] = sign * (angle[(j + 1) % 3] * v[(j + 2) % 3] -
                                  angle[(j + 2) % 3] * v[(j + 1) % 3]);
            for (int j = 0; j < 3; j++)
                motion[j][k] = v[j] + once[j] +
                               0.5 * sign *
                                   (angle[(j + 1) % 3] * once[(j + 2) % 3] -
                                    angle[(j + 2) % 3] * once[(j + 1) % 3]);
        }
}

/* The unit is not placed as the reference says; with the sign -1 it is again. */
static inline void session_misplace(session *b, uint64_t seed, double sign)
{
    double normal[3 * BENCH_HOLDS + 3], angle[3];
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 904, 0, 0), 0, 3 * BENCH_HOLDS + 3,
                       normal);
    for (int pass = 0; pass < 2; pass++) {
        const bool mounts = (pass == 0) == (sign > 0.0);
        for (int j = 0; j < 3; j++)
            angle[j] = b->mounting * normal[3 * BENCH_HOLDS + j];
        if (mounts && b->mounting > 0.0)
            session_tilt(b, 0, b->count, angle, sign);
        for (size_t h = 0; h < b->holds && !mounts && b->placement > 0.0; h++) {
            for (size_t j = 0; j < 3; j++)
                angle[j] = b->placement * normal[3 * h + j];
            session_tilt(b, b->hold_begin[h], b->hold_end[h], angle, sign);
        }
    }
}

/* ---- the Earth ----------------------------------------------------------------------------------
 */

static const double session_latitude = 0.7, session_earth_rate = 7.292115e-5;

/* The Earth's rate on a dividing head: along the force, and level at an angle to the axis of the
 * head, which is x, then y, then z. */
static inline void session_head_rate(const session *b, size_t k, size_t hold, double heading,
                                     double rate[3])
{
    const size_t along = hold / 12;
    const double up = session_earth_rate * sin(session_latitude),
                 level = session_earth_rate * cos(session_latitude);
    double u[3], first[3], size = 0.0, length = 0.0;
    for (size_t j = 0; j < 3; j++)
        size += b->force[j][k] * b->force[j][k];
    for (size_t j = 0; j < 3; j++)
        u[j] = b->force[j][k] / sqrt(size);
    for (size_t j = 0; j < 3; j++)
        first[j] = (j == along) - u[along] * u[j];
    for (size_t j = 0; j < 3; j++)
        length += first[j] * first[j];
    for (size_t j = 0; j < 3; j++) {
        const double second =
            u[(j + 1) % 3] * first[(j + 2) % 3] - u[(j + 2) % 3] * first[(j + 1) % 3];
        rate[j] =
            up * u[j] + level * (cos(heading) * first[j] + sin(heading) * second) / sqrt(length);
    }
}

/* Let the Earth turn the unit; with the sign -1 it does not any more. */
static inline void session_turn(session *b, uint64_t seed, double sign)
{
    double draw[BENCH_HOLDS], angle = 0.0; /* 0 … 1, by the normal distribution */
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 905, 0, 0), 0, BENCH_HOLDS, draw);
    for (size_t h = 0; h < BENCH_HOLDS; h++)
        draw[h] = 0.5 * erfc(draw[h] / sqrt(2.0));
    for (size_t k = 0, hold = 0; b->earth != SESSION_NO_EARTH && k < b->count; k++) {
        double rate[3];
        hold += hold + 1 < b->holds && k >= b->hold_end[hold];
        if (b->earth == SESSION_TABLE) {
            const double up = 2.0 * draw[0] - 1.0, level = sqrt(1.0 - up * up);
            rate[0] = session_earth_rate * level * cos(2.0 * session_pi * draw[1] - angle);
            rate[1] = session_earth_rate * level * sin(2.0 * session_pi * draw[1] - angle);
            rate[2] = session_earth_rate * up;
            angle += b->rate[2][k] / session_rate;
        } else {
            const double turn = draw[b->earth == SESSION_HEADINGS ? hold : 0];
            session_head_rate(b, k, hold, 2.0 * session_pi * turn, rate);
        }
        for (int j = 0; j < 3; j++)
            b->slow[j][k] = rate[j];
    }
    for (int j = 0; b->earth != SESSION_NO_EARTH && j < 3; j++)
        for (size_t k = 0; k < b->count; k++)
            b->rate[j][k] += sign * b->slow[j][k];
}

/* What the calibration is told of such a bench. */
static inline void session_tell(session *b)
{
    for (int j = 0; j < 3 && b->earth != SESSION_NO_EARTH; j++) {
        if (b->earth == SESSION_TABLE)
            b->record.reference_force[j] = NULL;
        else
            b->record.reference_rate[j] = NULL;
    }
    if (b->earth != SESSION_TABLE)
        return;
    b->record.reference_on_ground = true;
    b->record.axis_count[IMK_ACCEL] = 0;
    const double larger = b->settings.g_sensitivity_sigma / 1e-5;
    for (int i = 0; i < 9; i++)
        b->truth.gyro.g_sensitivity.value[i / 3][i % 3] *= larger;
}

/* The log of unit `seed`; `bad` of its holds are disturbed. */
static inline void session_log(session *b, uint64_t seed, double bad)
{
    b->truth = session_unit(b->procedure, seed);
    if (b->slower)
        b->slower(&b->truth);
    for (int axis = 1; axis < 3 && b->unequal > 0.0; axis++) {
        double *gyro = b->truth.gyro.noise.white.value, *accel = b->truth.accel.noise.white.value;
        gyro[axis] = b->unequal * gyro[axis - 1];
        accel[axis] = b->unequal * accel[axis - 1];
    }
    session_tell(b);
    session_turn(b, seed, 1.0);
    session_misplace(b, seed, 1.0);
    session_run(b, &b->truth, seed, (uint32_t)seed, true, b->log);
    session_misplace(b, seed, -1.0);
    session_turn(b, seed, -1.0);
    session_true_bias(b, seed, (uint32_t)seed);
    /* An encoder of 2e-7 rad: its rates are differences of rounded angles. */
    for (int j = 0; j < 3; j++) {
        double angle = 0.0, shown = 0.0;
        for (size_t k = 0; k < b->count; k++) {
            angle += b->rate[j][k] / session_rate;
            const double next = 2e-7 * floor(angle / 2e-7 + 0.5);
            b->encoder[j][k] = (next - shown) * session_rate;
            shown = next;
        }
    }
    if (b->push[0] > 0.0)
        session_push(b, seed);
    double luck[BENCH_HOLDS], size[BENCH_HOLDS];
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 901, 0, 0), 0, BENCH_HOLDS, luck);
    imk_random_normals(imk_random_seeded(seed), imk_stream(0, 902, 0, 0), 0, BENCH_HOLDS, size);
    for (size_t h = 0; h < b->holds && bad > 0.0; h++)
        if (0.5 * erfc(luck[h] / sqrt(2.0)) < bad)
            for (size_t k = b->hold_begin[h]; k < b->hold_end[h]; k++)
                for (int c = 0; c < 6; c++)
                    b->log[c][k] += (c < 3 ? 0.01 : 0.1) * size[(h + (size_t)c) % BENCH_HOLDS];
}

/* Observe and solve. */
static inline imk_status session_solve(session *b, imk_error *error)
{
    imk_calibration_default(&b->calibration);
    if (b->stated > 0.0) {
        b->settings.fixture_sigma = b->stated * b->mounting;
        b->settings.placement_sigma = b->stated * b->placement;
    }
    b->calibration.observation = b->observation;
    b->calibration.observation_capacity = BENCH_OBSERVATIONS;
    if (b->noise_known) {
        b->calibration.model.gyro.noise = b->truth.gyro.noise;
        b->calibration.model.accel.noise = b->truth.accel.noise;
    }
    if (b->earth == SESSION_ONE_HEADING || b->earth == SESSION_HEADINGS)
        b->calibration.latitude = session_latitude;
    imk_status status =
        imk_procedure_observe(b->procedure, &b->calibration, &b->record, &b->settings, false,
                              &b->findings, b->workspace, b->workspace_size, error);
    if (status != IMK_OK)
        return status;
    const size_t size = imk_calibration_workspace_size(&b->calibration);
    void *memory = malloc(size);
    status = imk_calibration_solve(&b->calibration, &b->result, memory, size, error);
    free(memory);
    return status;
}

#endif
