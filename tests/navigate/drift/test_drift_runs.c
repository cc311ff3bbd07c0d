/* SPDX-License-Identifier: Apache-2.0 */
/* Monte Carlo: runs against the same written down plainly, step by step; the statistics of biases
 * against their closed form; the draws of what calibration left and of the start; the same bits
 * whoever shares a call and on every instruction set; runs that leave; refusals. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "car_profile.h"
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/drift.h"
#include "imukit/navigate.h"
#include "imukit/noise.h"
#include "imukit/simulate.h"
#include "navigate/drift/drift_runs_internal.h"

#include <stdlib.h>
#include <string.h>

enum { STATES = IMK_DRIFT_STATES, LANES = IMK_DRIFT_LANES, TIMES = 3 };

/* ---- set-up ---- */

typedef struct car {
    imk_motion_script script;
    imk_motion_step step[CAR_PROFILE_STEPS];
    imk_trajectory trajectory;
    imk_trajectory_piece *piece;
} car;

static void drive(car *c)
{
    size_t count = 0;
    car_profile(&c->script, c->step);
    CHECK_OK(imk_motion_script_pieces(&c->script, &count, NULL));
    c->piece = malloc(count * sizeof *c->piece);
    assert_non_null(c->piece);
    CHECK_OK(imk_motion_script_compile(&c->script, c->piece, count, &c->trajectory, NULL));
}

static void *make_memory(const imk_model *model, const imk_drift_settings *settings, size_t *size)
{
    *size = imk_drift_runs_workspace_size(model, settings);
    void *memory = aligned_alloc(64, (*size + 63) / 64 * 64);
    assert_non_null(memory);
    return memory;
}

/* errors[run][time][state] */
static void compute(const imk_model *model, const imk_drift_settings *settings, uint64_t seed,
                    uint32_t first, size_t count, double *errors)
{
    size_t size;
    void *memory = make_memory(model, settings, &size);
    for (size_t done = 0; done < count; done += LANES) {
        const size_t now = count - done < LANES ? count - done : LANES;
        CHECK_OK(imk_drift_runs(model, settings, seed, first + (uint32_t)done, now,
                                errors + done * settings->time_count * STATES, memory, size, NULL));
    }
    free(memory);
}

static void set_all(imk_axes *axes, double value, double sigma)
{
    for (int i = 0; i < 3; i++) {
        axes->value[i] = value * (1 + i);
        axes->sigma[i] = sigma * (1 + i);
    }
}

/* A MEMS unit with something of everything that a navigator feels. */
static imk_model lively_model(void)
{
    imk_model model;
    imk_model_default(&model);
    imk_triad *gyro = &model.gyro, *accel = &model.accel;
    set_all(&gyro->bias.fixed, 1e-5, 4e-6);
    set_all(&gyro->bias.repeatability, 2e-5, 0.0);
    set_all(&gyro->scale_factor.fixed, 3e-4, 1e-4);
    set_all(&gyro->noise.white, 5e-5, 0.0);
    set_all(&gyro->noise.bias_instability, 3e-6, 0.0);
    set_all(&gyro->noise.quantization, 1e-6, 0.0);
    set_all(&accel->bias.fixed, 3e-3, 1e-3);
    set_all(&accel->bias.repeatability, 5e-3, 0.0);
    set_all(&accel->scale_factor.repeatability, 2e-4, 0.0);
    set_all(&accel->noise.white, 3e-4, 0.0);
    set_all(&accel->noise.random_walk, 1e-5, 0.0);
    accel->noise.gauss_markov_count = 1;
    set_all(&accel->noise.gauss_markov[0].sigma, 1e-3, 0.0);
    set_all(&accel->noise.gauss_markov[0].correlation_time, 50.0, 0.0);
    gyro->misalignment.value[0][1] = 2e-4;
    gyro->misalignment.sigma[1][2] = 1e-4;
    gyro->g_sensitivity.value[0][2] = 1e-6;
    accel->misalignment.value[2][0] = -3e-4;
    accel->lever_arm.value[1][0] = 0.03;
    accel->lever_arm.sigma[0][2] = 0.01;
    return model;
}

/* ---- the same written down plainly ---- */

/* The rows of one run: simulate, and repeat lost rows. log[channel * rows + row] */
static double *plain_rows(const imk_model *model, const imk_simulation *simulation, size_t rows,
                          imk_simulator **simulator, void **memory)
{
    const size_t size = imk_simulator_size(model, simulation);
    double *log = malloc(6 * rows * sizeof *log), *column[6];
    *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(*memory);
    CHECK_OK(imk_simulator_start(model, simulation, simulator, *memory, size, NULL));
    for (size_t i = 0; i < 6; i++)
        column[i] = log + i * rows;
    imk_simulator_next(*simulator, rows, column, NULL);
    for (size_t i = 0; i < 6; i++) {
        const imk_triad *triad = i < 3 ? &model->gyro : &model->accel;
        const double k = triad->sensitivity.value[i % 3], zero = triad->zero_offset.value[i % 3];
        for (size_t row = 0; row < rows; row++) {
            if (k != 0.0)
                column[i][row] = (column[i][row] - zero) / k;
            if (row > 0 && imk_simulator_dropped(*simulator, row))
                column[i][row] = column[i][row - 1];
        }
    }
    return log;
}

/* C_nb by gravity first: down is against the mean force, east across the mean rate; then what a
 * plumb line leans. */
static imk_quaternion plain_alignment(const double *log, size_t stride, size_t rows,
                                      imk_geodetic place)
{
    imk_vector3 mean[2] = {{{0.0}}};
    for (size_t i = 0; i < 6; i++)
        for (size_t row = 1; row <= rows; row++)
            mean[i / 3].v[i % 3] += log[i * stride + row] / (double)rows;
    imk_vector3 down = imk_vector3_scale(mean[1], -1.0 / imk_vector3_norm(mean[1]));
    imk_vector3 east = imk_vector3_cross(down, mean[0]);
    east = imk_vector3_scale(east, 1.0 / imk_vector3_norm(east));
    const imk_vector3 north = imk_vector3_cross(east, down);
    imk_matrix3 c_nb;
    for (int i = 0; i < 3; i++) {
        c_nb.m[0][i] = north.v[i];
        c_nb.m[1][i] = east.v[i];
        c_nb.m[2][i] = down.v[i];
    }
    c_nb = imk_matrix3_multiply(imk_plumb_axes(place), c_nb);
    return imk_quaternion_from_matrix(
        imk_matrix3_multiply(imk_ned_axes(place.latitude, place.longitude), c_nb));
}

/* C_nb of the display against the true one, by its elements: of R = S T, T about down and S about
 * an axis across, S takes down to the third column and T is 2 atan(z/w) of the quaternion. */
static void plain_display(const imk_navigation_state *estimate, const imk_motion_state *truth,
                          double phi[3])
{
    imk_matrix3 c_nb;
    imk_navigation_state_to_ned(estimate, NULL, NULL, &c_nb);
    const imk_matrix3 r = imk_matrix3_multiply(c_nb, imk_matrix3_transpose(truth->c_nb));
    const double sine = hypot(r.m[0][2], r.m[1][2]);
    const double length = sine > 0.0 ? atan2(sine, r.m[2][2]) / sine : 1.0;
    phi[0] = -length * r.m[1][2];
    phi[1] = length * r.m[0][2];
    phi[2] = atan2(r.m[1][0] - r.m[0][1], r.m[0][0] + r.m[1][1]);
}

static void plain_errors(const imk_navigation_state *estimate, const imk_motion_state *truth,
                         imk_attitude_errors stated, double errors[STATES])
{
    const imk_matrix3 axes = imk_ned_axes(truth->place.latitude, truth->place.longitude);
    const imk_matrix3 to_ned = imk_matrix3_transpose(axes);
    const imk_matrix3 c_nb =
        imk_matrix3_multiply(to_ned, imk_quaternion_to_matrix(estimate->attitude));
    const imk_matrix3 turn = imk_matrix3_multiply(c_nb, imk_matrix3_transpose(truth->c_nb));
    const imk_vector3 part[3] = {
        imk_matrix3_apply(to_ned, imk_vector3_subtract(estimate->position, truth->position)),
        imk_matrix3_apply(to_ned, imk_vector3_subtract(estimate->velocity, truth->velocity)),
        imk_quaternion_to_rotation_vector(imk_quaternion_from_matrix(turn)),
    };
    for (int i = 0; i < STATES; i++)
        errors[i] = part[i / 3].v[i % 3];
    if (stated == IMK_ATTITUDE_LOCAL)
        plain_display(estimate, truth, errors + 6);
}

/* One run on a trajectory that has the standstill of the alignment before it. */
static void plain_run(const imk_model *model, const imk_drift_settings *s,
                      const imk_trajectory *trajectory, uint64_t seed, uint32_t run, bool blocks,
                      double *errors)
{
    const size_t aligned =
        s->alignment == IMK_ALIGNED_SELF ? (size_t)(s->alignment_time * s->rate + 0.5) : 0;
    const size_t rows = aligned + (size_t)(s->time[s->time_count - 1] * s->rate + 1e-6) + 1;
    const double dt = 1.0 / s->rate, interval = dt / (1.0 + model->timing.rate_error.value);
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = s->rate;
    simulation.seed = seed;
    simulation.run = run;
    simulation.motion.trajectory = trajectory;
    imk_simulator *simulator;
    void *memory;
    double *log = plain_rows(model, &simulation, rows, &simulator, &memory);
    imk_motion_state truth;
    imk_trajectory_state(trajectory, imk_simulator_true_time(simulator, (int64_t)aligned), &truth);
    imk_navigation_state state = {0.0, truth.position, truth.velocity, truth.attitude};
    if (aligned > 0)
        state.attitude = plain_alignment(log, rows, aligned, truth.place);
    imk_strapdown strapdown = imk_strapdown_start(&state);
    strapdown.hold_height = s->vertical == IMK_VERTICAL_SLAVED;
    size_t seen = 0;
    for (size_t row = aligned; seen < s->time_count; row++) {
        if (row > aligned) {
            imk_vector3 angle, velocity;
            const double *channel[6];
            for (size_t i = 0; i < 3; i++) {
                angle.v[i] = dt * log[i * rows + row];
                velocity.v[i] = dt * log[(i + 3) * rows + row];
                channel[i] = log + i * rows + row;
                channel[i + 3] = log + (i + 3) * rows + row;
            }
            const double time = trajectory->piece[0].start + (double)row * interval;
            imk_trajectory_state(trajectory, time, &truth);
            const double height = truth.place.height, climb = -truth.velocity_ned.v[2];
            strapdown.height = height;
            strapdown.climb = climb;
            if (blocks)
                imk_strapdown_run(&strapdown, 1, dt, channel, &height, &climb);
            else
                imk_strapdown_step(&strapdown, dt, angle, velocity);
        }
        for (; seen < s->time_count && row == aligned + (size_t)(s->time[seen] * s->rate + 1e-6);
             seen++) {
            imk_trajectory_state(trajectory, imk_simulator_true_time(simulator, (int64_t)row),
                                 &truth);
            plain_errors(&strapdown.state, &truth, s->attitude_errors, errors + seen * STATES);
        }
    }
    free(log);
    free(memory);
}

/* By the mechanisation of blocks for one run the errors are the same but for how they are taken:
 * 1e-8 m is some ten last bits of the position. Steps of one sample differ from blocks of several:
 * both take the samples for those of a smooth motion, which white noise is not, and 2e-4 of the
 * drift is seen. */
static void check_plain(const imk_model *model, const imk_drift_settings *settings,
                        const imk_trajectory *trajectory)
{
    static const double tolerance[2][3] = {{3e-3, 3e-4, 3e-7}, {1e-8, 1e-10, 1e-13}};
    double together[LANES][TIMES][STATES], alone[TIMES][STATES];
    assert_int_equal(settings->time_count, TIMES);
    compute(model, settings, 11, 40, 3, &together[0][0][0]);
    for (uint32_t run = 0; run < 3; run++)
        for (int blocks = 0; blocks < 2; blocks++) {
            plain_run(model, settings, trajectory, 11, 40 + run, blocks, &alone[0][0]);
            for (int t = 0; t < TIMES; t++)
                for (int i = 0; i < STATES; i++)
                    CHECK_CLOSE(together[run][t][i], alone[t][i], tolerance[blocks][i / 3]);
        }
}

static const double short_times[TIMES] = {0.004, 17.0, 60.077};

static void test_plain_at_rest(void **state)
{
    (void)state;
    imk_model model = lively_model();
    imk_drift_settings settings = imk_drift_default();
    const double attitude[3] = {0.1, -0.2, 0.7};
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
    settings.latitude = -0.6;
    settings.height = 400.0;
    settings.roll = attitude[0];
    settings.pitch = attitude[1];
    settings.yaw = attitude[2];
    settings.time = short_times;
    settings.time_count = TIMES;
    CHECK_OK(imk_trajectory_standstill((imk_geodetic){-0.6, 0.0, 400.0}, attitude, true, &piece,
                                       &trajectory, NULL));
    check_plain(&model, &settings, &trajectory);
    settings.vertical = IMK_VERTICAL_FREE;
    check_plain(&model, &settings, &trajectory);
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 40.0;
    set_all(&model.gyro.noise.white, 1e-7, 0.0); /* or there is no north */
    set_all(&model.gyro.bias.fixed, 1e-7, 0.0);
    set_all(&model.gyro.bias.repeatability, 1e-7, 0.0);
    model.timing.drops.value = 0.05;
    for (int i = 0; i < 3; i++) {
        model.gyro.sensitivity.value[i] = 1e8;
        model.gyro.zero_offset.value[i] = 32768.0;
        model.accel.sensitivity.value[i] = 1e5;
    }
    check_plain(&model, &settings, &trajectory);
}

static void test_plain_on_the_road(void **state)
{
    (void)state;
    car c;
    drive(&c);
    imk_model model = lively_model();
    imk_drift_settings settings = imk_drift_default();
    static const double times[TIMES] = {33.0, 50.505, 90.0};
    settings.motion = &c.trajectory;
    settings.time = times;
    settings.time_count = TIMES;
    check_plain(&model, &settings, &c.trajectory);
    /* A clock with all its errors: each run makes its own motion. */
    model.timing.rate_error.value = 5e-5;
    model.timing.jitter.value = 1e-5;
    model.timing.skew.value = 2e-3;
    settings.attitude_errors = IMK_ATTITUDE_EARTH;
    check_plain(&model, &settings, &c.trajectory);
    free(c.piece);
}

/* Self-alignment in a standstill before the motion. */
static void test_plain_standstill_first(void **state)
{
    (void)state;
    car c;
    drive(&c);
    imk_model model = lively_model();
    set_all(&model.gyro.noise.white, 1e-7, 0.0);
    set_all(&model.gyro.bias.repeatability, 1e-7, 0.0);
    imk_drift_settings settings = imk_drift_default();
    static const double times[TIMES] = {33.0, 50.505, 60.0};
    settings.motion = &c.trajectory;
    settings.time = times;
    settings.time_count = TIMES;
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 20.0;
    imk_trajectory padded = c.trajectory;
    imk_trajectory_piece *piece = calloc(padded.piece_count + 1, sizeof *piece);
    assert_non_null(piece);
    memcpy(piece + 1, padded.piece, padded.piece_count * sizeof *piece);
    piece[0].start = padded.piece[0].start - 20.0;
    piece[0].length = 20.0;
    for (int i = 0; i < 3; i++)
        piece[0].position[i][0] = piece[1].position[i][0];
    for (int i = 0; i < 4; i++)
        piece[0].quaternion[i][0] = piece[1].quaternion[i][0];
    padded.piece = piece;
    padded.piece_count++;
    check_plain(&model, &settings, &padded);
    free(piece);
    free(c.piece);
}

/* Perfect sensors: 10 minutes of traffic, the attitude given or found. A self-aligned unit keeps
 * the standstill's rounding: 1e-16 of gravity over the Earth's rate, some 1e-12 rad. */
static void test_perfect(void **state)
{
    (void)state;
    car c;
    drive(&c);
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    const double time = CAR_PROFILE_DURATION;
    double errors[2][STATES];
    settings.motion = &c.trajectory;
    settings.time = &time;
    settings.time_count = 1;
    compute(&model, &settings, 0, 0, 1, errors[0]);
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 10.0;
    compute(&model, &settings, 0, 0, 1, errors[1]);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < STATES; i++)
            CHECK_BELOW(fabs(errors[k][i]), i < 3 ? 1e-4 : (i < 6 ? 1e-6 : 1e-9));
    free(c.piece);
}

/* ---- statistics ---- */

/* Biases b of force and c of rate, at rest: for a minute, north is b t^2/2 + g c_E t^3/6 (c_E turns
 * up about east, and gravity then seems to push north), and east b t^2/2 - g c_N t^3/6. What is
 * left out, the Schuler period and the Earth's rotation, is (w t)^2/12 = 5e-4 and 2e-3 of it. */
static void test_biases(void **state)
{
    (void)state;
    enum { RUNS = 1200 };
    const double b = 0.01, c = 1e-5, t = 60.0, g = imk_normal_gravity(0.25 * 3.14159265358979, 0);
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    for (int i = 0; i < 3; i++) {
        model.accel.bias.repeatability.value[i] = b;
        model.gyro.bias.repeatability.value[i] = c;
    }
    settings.rate = 5.0;
    settings.time = &t;
    settings.time_count = 1;
    double *errors = malloc(RUNS * STATES * sizeof *errors);
    compute(&model, &settings, 2026, 0, RUNS, errors);
    const double force = 0.5 * b * t * t, rate = g * c * t * t * t / 6.0;
    const double sigma = sqrt(force * force + rate * rate);
    double square = 0.0, mean[2] = {0.0, 0.0}, cross = 0.0;
    size_t beyond = 0;
    for (int k = 0; k < RUNS; k++) {
        const double *e = errors + k * STATES;
        for (int i = 0; i < 2; i++) {
            square += e[i] * e[i] / (sigma * sigma);
            mean[i] += e[i] / sigma / sqrt(RUNS);
            beyond += fabs(e[i]) > 2.0 * sigma;
        }
        cross += e[0] * e[1] / (sigma * sigma);
        CHECK_BELOW(fabs(e[2]), 1e-3); /* slaved; d^2/2R of some 20 m */
    }
    /* Four tests at 1e-7 or less each; the 4e-3 stand for what the closed form leaves out. */
    const double sum = 2.0 * RUNS;
    CHECK_BELOW(square, imk_chi_square_quantile(1.0 - 1e-7, sum) * 1.004);
    CHECK_BELOW(imk_chi_square_quantile(1e-7, sum) * 0.996, square);
    for (int i = 0; i < 2; i++)
        CHECK_BELOW(fabs(mean[i]), -imk_normal_quantile(1e-7));
    CHECK_BELOW(fabs(cross) / sqrt(RUNS), -imk_normal_quantile(1e-7));
    /* Binomial, 2400 at 0.0455: 109 +- 10.2; 5.5 of these and the half percent. */
    CHECK_CLOSE((double)beyond, 109.2, 5.5 * 10.2 + 1.0);
    free(errors);
}

/* The same biases, known to 1 sigma and taken out: each run keeps what calibration left, which is
 * predicted from the fixed numbers of the draws. */
static void test_compensated_biases(void **state)
{
    (void)state;
    enum { RUNS = 40 };
    const double t = 20.0;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    for (int i = 0; i < 3; i++) {
        model.accel.bias.fixed.value[i] = 5.0; /* gone */
        model.accel.bias.fixed.sigma[i] = 0.01;
    }
    settings.compensated = true;
    settings.rate = 5.0;
    settings.time = &t;
    settings.time_count = 1;
    double errors[RUNS][STATES];
    compute(&model, &settings, 9, 1000, RUNS, errors[0]);
    for (uint32_t k = 0; k < RUNS; k++)
        for (uint8_t i = 0; i < 2; i++) {
            double normal;
            imk_random_normals(imk_random_seeded(9),
                               imk_stream(1000 + k, IMK_TERM_RESIDUAL, 0, (uint8_t)(8 + i)), 0, 1,
                               &normal);
            /* 2 m, 1 sigma; the Earth's rotation turns w_ie t/3 = 5e-4 of one into the other */
            CHECK_CLOSE(errors[k][i], 0.5 * 0.01 * normal * t * t, 6e-3);
        }
}

/* Errors of readings: of the angle what two readings have, sqrt(2) r, whether r is stated or is
 * A/sqrt(dt) of 1/dt = 100 Hz; chi-square of the runs at 1e-7 each side. */
static void test_readings(void **state)
{
    (void)state;
    enum { RUNS = 160 };
    const double t = 1.0, size = 1e-5;
    static double errors[RUNS][STATES];
    for (int white = 0; white < 2; white++) {
        imk_model model;
        imk_model_default(&model);
        for (int i = 0; i < 3; i++)
            (white ? &model.gyro.noise.angle_white : &model.gyro.noise.reading_noise)->value[i] =
                white ? 0.1 * size : size;
        imk_drift_settings settings = imk_drift_default();
        settings.time = &t;
        settings.time_count = 1;
        compute(&model, &settings, 4, 1, RUNS, errors[0]);
        double sum = 0.0;
        for (size_t k = 0; k < RUNS; k++)
            for (size_t i = 6; i < 9; i++)
                sum += errors[k][i] * errors[k][i] / (2.0 * size * size);
        const double probability = imk_chi_square_probability(sum, 3.0 * RUNS);
        assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
    }
}

/* ---- draws ---- */

/* Every parameter: its number in the stream and where it stands; values of these are no longer
 * what they were, sigma times the normal instead. The numbers are fixed for ever. */
static void test_residual_numbers(void **state)
{
    (void)state;
    static imk_model known, drawn;
    imk_model_default(&known);
    imk_triad *triads[2] = {&known.gyro, &known.accel};
    double *bytes = (double *)(void *)&drawn;
    const uint32_t run = 77;
    const imk_random random = imk_random_seeded(3);
    for (int k = 0; k < 2; k++) {
        imk_triad *triad = triads[k];
        triad->bias.warm_up_time.value = 100.0;
        triad->bias.temperature.order = 1;
        triad->bias.hysteresis.value[0] = 1.0;
        triad->scale_factor.temperature.order = 2;
        const struct {
            int number, columns;
            double *value, *sigma;
        } parameters[] = {
            {0, 1, triad->bias.fixed.value, triad->bias.fixed.sigma},
            {3, 1, triad->bias.warm_up_amplitude.value, triad->bias.warm_up_amplitude.sigma},
            {5, 1, triad->scale_factor.fixed.value, triad->scale_factor.fixed.sigma},
            {7, 1, triad->nonlinearity.k2.value, triad->nonlinearity.k2.sigma},
            {8, 1, triad->nonlinearity.koq.value, triad->nonlinearity.koq.sigma},
            {9, 1, triad->nonlinearity.k3.value, triad->nonlinearity.k3.sigma},
            {10, 1, triad->nonlinearity.asymmetry.value, triad->nonlinearity.asymmetry.sigma},
            {11, 3, triad->nonlinearity.cross_products.value[0],
             triad->nonlinearity.cross_products.sigma[0]},
            {12, 3, triad->misalignment.value[0], triad->misalignment.sigma[0]},
            {13, 3, triad->cross_axis.value[0], triad->cross_axis.sigma[0]},
            {14, 3, triad->g_sensitivity.value[0], triad->g_sensitivity.sigma[0]},
            {15, 6, triad->g2_sensitivity.value[0], triad->g2_sensitivity.sigma[0]},
            {16, 3, triad->lever_arm.value[0], triad->lever_arm.sigma[0]},
            {17, 1, triad->noise.ramp.value, triad->noise.ramp.sigma},
        };
        for (size_t p = 0; p < sizeof parameters / sizeof *parameters; p++)
            for (int i = 0; i < 3 * parameters[p].columns; i++) {
                parameters[p].value[i] = 1.0;
                parameters[p].sigma[i] = 0.01 * (i + 1);
            }
        drawn = known;
        imki_drift_residual(&drawn, NULL, random, run);
        for (size_t p = 0; p < sizeof parameters / sizeof *parameters; p++)
            for (int i = 0; i < 3 * parameters[p].columns; i++) {
                const int columns = parameters[p].columns;
                const uint64_t stream =
                    imk_stream(run, IMK_TERM_RESIDUAL, (uint8_t)parameters[p].number,
                               (uint8_t)(8 * k + i / columns));
                double normal;
                imk_random_normals(random, stream, (uint64_t)(i % columns), 1, &normal);
                const ptrdiff_t at = parameters[p].value + i - (double *)(void *)&known;
                CHECK_CLOSE(bytes[at], 0.01 * (i + 1) * normal, 0.0);
            }
        const imk_triad *left = k == 0 ? &drawn.gyro : &drawn.accel;
        assert_int_equal(left->bias.temperature.order, 0);
        assert_int_equal(left->scale_factor.temperature.order, 0);
        CHECK_CLOSE(left->bias.hysteresis.value[0], 0.0, 0.0);
    }
}

/* Normal with the stated sigma, independent between runs: 3000 draws. */
static void test_residual_distribution(void **state)
{
    (void)state;
    enum { RUNS = 3000 };
    static imk_model known, drawn;
    imk_model_default(&known);
    known.timing.rate_error = (imk_scalar){5e-5, 2e-5};
    known.timing.skew = (imk_scalar){1e-3, 1e-4};
    const imk_random random = imk_random_seeded(12);
    double square = 0.0, mean = 0.0, along = 0.0, before = 0.0;
    size_t beyond = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        drawn = known;
        imki_drift_residual(&drawn, NULL, random, run);
        const double n = drawn.timing.rate_error.value / 2e-5;
        square += n * n;
        mean += n / sqrt(RUNS);
        along += n * before / sqrt(RUNS);
        beyond += fabs(n) > 2.0;
        before = n;
        assert_true(drawn.timing.skew.value != n * 1e-4); /* another stream */
    }
    CHECK_BELOW(square, imk_chi_square_quantile(1.0 - 1e-7, RUNS));
    CHECK_BELOW(imk_chi_square_quantile(1e-7, RUNS), square);
    CHECK_BELOW(fabs(mean), -imk_normal_quantile(1e-7));
    CHECK_BELOW(fabs(along), -imk_normal_quantile(1e-7));
    CHECK_CLOSE((double)beyond, 0.0455003 * RUNS, 5.5 * sqrt(0.0455 * 0.9545 * RUNS));
}

/* At the start itself the errors are the draws: state i is normal 0 of instance 0, axis i. With
 * the vertical slaved there are none of height and climb; with self-alignment none of attitude,
 * but a unit that is mistaken about its place takes the vertical there for its own. */
static void test_initial(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    const double time = 1e-3; /* before the first sample ends */
    settings.time = &time;
    settings.time_count = 1;
    settings.yaw = 1.0;
    settings.alignment_time = 5.0;
    for (int i = 0; i < STATES; i++)
        settings.initial_sigma[i] = i < 3 ? 100.0 : (i < 6 ? 0.1 : 1e-3);
    for (int kind = 0; kind < 6; kind++) {
        settings.attitude_errors = kind < 3 ? IMK_ATTITUDE_LOCAL : IMK_ATTITUDE_EARTH;
        settings.vertical = kind % 3 == 0 ? IMK_VERTICAL_FREE : IMK_VERTICAL_SLAVED;
        settings.alignment = kind % 3 == 2 ? IMK_ALIGNED_SELF : IMK_ALIGNED_GIVEN;
        double errors[LANES][STATES];
        compute(&model, &settings, 4, 90, LANES, errors[0]);
        for (uint32_t run = 0; run < LANES; run++) {
            double expected[STATES];
            for (int i = 0; i < STATES; i++) {
                imk_random_normals(imk_random_seeded(4),
                                   imk_stream(90 + run, IMK_TERM_INITIAL, 0, (uint8_t)i), 0, 1,
                                   &expected[i]);
                expected[i] *= settings.initial_sigma[i];
                if (kind % 3 > 0 && (i == 2 || i == 5))
                    expected[i] = 0.0;
            }
            if (kind == 2) /* displayed right, but for the rate of another latitude: 1e-6 */
                expected[6] = expected[7] = expected[8] = 0.0;
            if (kind == 5) { /* the axes of a place some 100 m away, to 1e-4 of the angle */
                double meridian, prime;
                imk_curvature_radii(settings.latitude, &meridian, &prime);
                expected[6] = expected[1] / prime;
                expected[7] = -expected[0] / meridian;
                expected[8] = -expected[1] / prime; /* tan 45 deg */
            }
            for (int i = 0; i < STATES; i++)
                CHECK_CLOSE(errors[run][i], expected[i],
                            i < 6 ? 1e-8 : (kind % 3 == 2 ? 2e-9 : 1e-12));
        }
    }
}

/* ---- the same bits ---- */

/* Settings that take every way through: at rest, moving, moving with models that differ, and with
 * clocks that differ. */
static void check_same_bits(const imk_model *model, const imk_drift_settings *settings)
{
    double all[LANES][TIMES][STATES], part[LANES][TIMES][STATES];
    static const char *const isa[] = {"scalar", "avx2", "avx512", "neon"};
    char before[16] = "";
    compute(model, settings, 5, 20, LANES, &all[0][0][0]);
    compute(model, settings, 5, 20, LANES, &part[0][0][0]);
    assert_memory_equal(all, part, sizeof all);
    for (uint32_t first = 0; first < LANES; first += 7) { /* seven, and one alone */
        const size_t count = LANES - first < 7 ? LANES - first : 7;
        compute(model, settings, 5, 20 + first, count, &part[0][0][0]);
        assert_memory_equal(all[first], part[0], count * sizeof all[0]);
    }
    if (getenv("IMUKIT_ISA"))
        strncpy(before, getenv("IMUKIT_ISA"), sizeof before - 1);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(setenv("IMUKIT_ISA", isa[i], 1), 0);
        compute(model, settings, 5, 20, LANES, &part[0][0][0]);
        assert_memory_equal(all, part, sizeof all);
    }
    assert_int_equal(before[0] ? setenv("IMUKIT_ISA", before, 1) : unsetenv("IMUKIT_ISA"), 0);
}

static void test_same_bits(void **state)
{
    (void)state;
    car c;
    drive(&c);
    imk_model model = lively_model();
    imk_drift_settings settings = imk_drift_default();
    static const double times[TIMES] = {0.01, 20.0, 36.0};
    settings.time = times;
    settings.time_count = TIMES;
    settings.initial_sigma[1] = 1.0;
    settings.initial_sigma[6] = 1e-3;
    check_same_bits(&model, &settings);
    settings.motion = &c.trajectory;
    check_same_bits(&model, &settings);
    settings.compensated = true;
    check_same_bits(&model, &settings);
    model.timing.rate_error.sigma = 3e-5;
    model.gyro.bandwidth.value[0] = 40.0;
    check_same_bits(&model, &settings);
    free(c.piece);
}

/* Another seed, another run: other errors. */
static void test_other_draws(void **state)
{
    (void)state;
    const imk_model model = lively_model();
    imk_drift_settings settings = imk_drift_default();
    const double time = 10.0;
    double a[STATES], b[STATES], c[STATES];
    settings.time = &time;
    settings.time_count = 1;
    compute(&model, &settings, 1, 0, 1, a);
    compute(&model, &settings, 2, 0, 1, b);
    compute(&model, &settings, 1, UINT32_MAX, 1, c);
    for (int i = 0; i < STATES; i++) {
        if (i == 2 || i == 5)
            continue; /* slaved */
        assert_true(a[i] != b[i]);
        assert_true(a[i] != c[i]);
    }
}

/* ---- runs that are none ---- */

/* A force b too much lifts a unit with a free vertical by b (cosh(sqrt(2) w t) - 1)/(2 w^2), w that
 * of Schuler: after 900 s by 5e5 s^2 b, after 6000 s by 6e9 s^2 b. With 2 m/s^2, 1 sigma, about a
 * third of the runs are 370 km below the ground by then, and all out of reach at the end. One that
 * has left gives no numbers, and does not disturb the others. */
static void test_leaving(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    static const double times[TIMES] = {10.0, 900.0, 6000.0};
    double errors[LANES][TIMES][STATES], alone[TIMES][STATES];
    model.accel.bias.repeatability.value[2] = 2.0;
    settings.rate = 1.0;
    settings.vertical = IMK_VERTICAL_FREE;
    settings.time = times;
    settings.time_count = TIMES;
    compute(&model, &settings, 1, 0, LANES, &errors[0][0][0]);
    int gone[TIMES] = {0, 0, 0};
    for (uint32_t run = 0; run < LANES; run++) {
        for (int t = 0; t < TIMES; t++) {
            const double *e = errors[run][t];
            gone[t] += isnan(e[0]);
            for (int i = 0; i < STATES; i++)
                assert_int_equal(isnan(e[i]), isnan(e[0]));
            if (t > 0 && isnan(errors[run][t - 1][0]))
                assert_true(isnan(e[0])); /* for good */
            if (!isnan(e[0]))
                CHECK_BELOW(fabs(e[2]), 4e6);
        }
        compute(&model, &settings, 1, run, 1, &alone[0][0]);
        assert_memory_equal(alone, errors[run], sizeof alone);
    }
    assert_int_equal(gone[0], 0);
    assert_int_equal(gone[2], LANES);
    assert_in_range(gone[1], 1, LANES - 1);
}

/* Gyros with a dead band wider than the Earth's rate find no north. */
static void test_no_north(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    const double time = 10.0;
    double errors[STATES];
    set_all(&model.gyro.dead_band, 1e-3, 0.0);
    settings.alignment = IMK_ALIGNED_SELF;
    settings.alignment_time = 5.0;
    settings.time = &time;
    settings.time_count = 1;
    compute(&model, &settings, 1, 0, 1, errors);
    for (int i = 0; i < STATES; i++)
        assert_true(isnan(errors[i]));
}

static void test_refusals(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_drift_settings settings = imk_drift_default();
    const double time = 1.0;
    double errors[LANES][STATES] = {{7.0}};
    settings.time = &time;
    settings.time_count = 1;
    size_t size;
    void *memory = make_memory(&model, &settings, &size);
    imk_error error;
    double *out = errors[0];
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, 0, out, memory, size, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "count");
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, LANES + 1, out, memory, size, &error),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, UINT32_MAX, 2, out, memory, size, &error),
                 IMK_ERROR_RANGE);
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, 1, out, memory, size - 1, &error),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, 1, out, NULL, size, &error),
                 IMK_ERROR_ARGUMENT);
    settings.time_count = 0;
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, 1, out, memory, size, &error),
                 IMK_ERROR_EMPTY);
    settings.time_count = 1;
    settings.cookie = 0;
    CHECK_STATUS(imk_drift_runs(&model, &settings, 0, 0, 1, out, memory, size, &error),
                 IMK_ERROR_UNINITIALISED);
    CHECK_CLOSE(errors[0][0], 7.0, 0.0); /* untouched */
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain_at_rest),
        cmocka_unit_test(test_plain_on_the_road),
        cmocka_unit_test(test_plain_standstill_first),
        cmocka_unit_test(test_perfect),
        cmocka_unit_test(test_biases),
        cmocka_unit_test(test_compensated_biases),
        cmocka_unit_test(test_readings),
        cmocka_unit_test(test_residual_numbers),
        cmocka_unit_test(test_residual_distribution),
        cmocka_unit_test(test_initial),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_other_draws),
        cmocka_unit_test(test_leaving),
        cmocka_unit_test(test_no_north),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
