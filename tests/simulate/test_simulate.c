/* SPDX-License-Identifier: Apache-2.0 */
/* The simulator: a unit at rest, the output stage, independence of the bytes from blocks, threads
 * and instruction set, and what it refuses. Each term by itself: test_deterministic_terms.c,
 * test_stochastic_terms.c; motion and timing: test_moving_unit.c. */
#define _POSIX_C_SOURCE 200809L /* setenv, aligned_alloc */
#include "check.h"

#include "imukit/distributions.h"
#include "imukit/noise.h"
#include "imukit/simulate.h"
#include "imukit/thread_pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 3000, CHANNELS = 6 };

static const double rate45 = 7.292115e-5 * 0.70710678118654752; /* Earth rate at 45 deg, each way */
static const double g45 = 9.8061977694;                         /* test_earth.c */

typedef struct log6 {
    double value[CHANNELS][ROWS];
} log6;

static imk_simulator *start(const imk_model *model, const imk_simulation *simulation)
{
    size_t size = imk_simulator_size(model, simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_non_null(memory);
    imk_simulator *simulator = NULL;
    imk_error error;
    CHECK_OK(imk_simulator_start(model, simulation, &simulator, memory, size, &error));
    return simulator;
}

static void next(imk_simulator *simulator, log6 *log, size_t first, size_t count,
                 const imk_executor *executor)
{
    double *columns[CHANNELS];
    for (size_t i = 0; i < CHANNELS; i++)
        columns[i] = log->value[i] + first;
    imk_simulator_next(simulator, count, columns, executor);
}

/* A simulator stands at the start of the memory given for it. */
static void simulate(const imk_model *model, const imk_simulation *simulation, log6 *log)
{
    imk_simulator *simulator = start(model, simulation);
    assert_int_equal(imk_simulator_channels(simulator), CHANNELS);
    next(simulator, log, 0, ROWS, NULL);
    free(simulator);
}

static imk_axes axes(double x, double y, double z)
{
    return (imk_axes){.value = {x, y, z}};
}

/* Every stochastic term, a different strength on each axis. */
static void add_noise(imk_triad *triad, double unit)
{
    imk_noise *noise = &triad->noise;
    noise->white = axes(unit, 2.0 * unit, 3.0 * unit);
    noise->bias_instability = axes(0.5 * unit, 0.4 * unit, 0.3 * unit);
    noise->random_walk = axes(0.1 * unit, 0.2 * unit, 0.3 * unit);
    noise->ramp = axes(1e-3 * unit, -2e-3 * unit, 3e-3 * unit);
    noise->quantization = axes(0.1 * unit, 0.2 * unit, 0.1 * unit);
    noise->gauss_markov_count = 2;
    noise->gauss_markov[0].sigma = axes(unit, unit, unit);
    noise->gauss_markov[0].correlation_time = axes(1.0, 2.0, 3.0);
    noise->gauss_markov[1].sigma = axes(0.5 * unit, 0.0, unit);
    noise->gauss_markov[1].correlation_time = axes(100.0, 100.0, 50.0);
    noise->sinusoid_count = 1;
    noise->sinusoid[0].amplitude = axes(unit, 2.0 * unit, 0.0);
    noise->sinusoid[0].frequency = axes(7.0, 13.0, 1.0);
    noise->resonance_count = 1;
    noise->resonance[0].sigma = axes(unit, unit, unit);
    noise->resonance[0].frequency = axes(20.0, 21.0, 22.0);
    noise->resonance[0].q = axes(10.0, 12.0, 14.0);
    triad->bandwidth = axes(40.0, 0.0, 30.0);
    triad->damping = axes(0.7, 0.0, 0.0);
    triad->bias.repeatability = axes(unit, unit, unit);
    triad->scale_factor.repeatability = axes(1e-4, 1e-4, 1e-4);
}

static imk_model full_model(void)
{
    imk_model model;
    imk_model_default(&model);
    add_noise(&model.gyro, 1e-4);
    add_noise(&model.accel, 1e-2);
    return model;
}

/* ---- truth and deterministic terms ----------------------------------------------------------- */

/* One row of a unit at rest. */
static void first_row(const imk_model *model, const imk_simulation *simulation,
                      double row[CHANNELS])
{
    double *columns[CHANNELS] = {row, row + 1, row + 2, row + 3, row + 4, row + 5};
    imk_simulator *simulator = start(model, simulation);
    imk_simulator_next(simulator, 1, columns, NULL);
    free(simulator);
}

static void test_truth(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = imk_simulation_default();
    double row[CHANNELS];
    first_row(&model, &simulation, row);
    CHECK_CLOSE(row[0], rate45, 1e-19);
    CHECK_CLOSE(row[1], 0.0, 1e-20);
    CHECK_CLOSE(row[2], -rate45, 1e-19);
    CHECK_CLOSE(row[3], 0.0, 1e-11); /* the direction of gravity, to 1e-12 rad */
    CHECK_CLOSE(row[5], -g45, 1e-9); /* at rest -g along down */
    /* nose up: f along +x is +g */
    simulation.pitch = 1.5707963267948966;
    first_row(&model, &simulation, row);
    CHECK_CLOSE(row[3], g45, 1e-9);
    CHECK_CLOSE(row[5], 0.0, 1e-11);
    CHECK_CLOSE(row[0], rate45, 1e-19); /* up is minus down */
    /* right wing down: gravity reaction along -y */
    simulation.pitch = 0.0;
    simulation.roll = 1.5707963267948966;
    first_row(&model, &simulation, row);
    CHECK_CLOSE(row[4], -g45, 1e-9);
    /* heading east: body y points south */
    simulation.roll = 0.0;
    simulation.yaw = 1.5707963267948966;
    first_row(&model, &simulation, row);
    CHECK_CLOSE(row[1], -rate45, 1e-19);
    simulation.earth = false;
    first_row(&model, &simulation, row);
    CHECK_CLOSE(row[1], 0.0, 0.0);
    CHECK_CLOSE(row[5], 0.0, 0.0);
}

static void test_perfect_unit(void **state)
{
    (void)state;
    static log6 log;
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = imk_simulation_default();
    double first[CHANNELS];
    simulate(&model, &simulation, &log);
    first_row(&model, &simulation, first);
    for (size_t row = 0; row < ROWS; row++)
        for (size_t i = 0; i < CHANNELS; i++)
            CHECK_CLOSE(log.value[i][row], first[i], 0.0);
}

/* Repeatability: one draw per run and axis, of the variance stated; the same within a run. */
static void test_repeatability(void **state)
{
    (void)state;
    enum { RUNS = 1000 };
    imk_model model;
    imk_model_default(&model);
    model.gyro.bias.repeatability = axes(2.0, 2.0, 2.0);
    model.accel.scale_factor.repeatability = axes(0.1, 0.1, 0.1);
    imk_simulation simulation = imk_simulation_default();
    double bias = 0.0, scale = 0.0, product = 0.0;
    for (simulation.run = 0; simulation.run < RUNS; simulation.run++) {
        double row[CHANNELS];
        first_row(&model, &simulation, row);
        double x = row[0] - rate45, y = row[1], z = row[5] / -g45 - 1.0;
        bias += x * x / 4.0 + y * y / 4.0;
        product += x * y / 4.0;
        scale += z * z / 0.01;
    }
    /* exact chi-square, probability 1e-7 each side */
    double probability = imk_chi_square_probability(bias, 2.0 * RUNS);
    assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
    probability = imk_chi_square_probability(scale, RUNS);
    assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
    CHECK_BELOW(fabs(product), 6.0 * sqrt(RUNS)); /* axes independent: 6 sigma of sum of products */
}

/* ---- the stochastic part --------------------------------------------------------------------- */

/* White, walk and Gauss-Markov of a channel are the public generators' samples of its streams. */
static void test_streams(void **state)
{
    (void)state;
    static log6 log;
    static double expected[ROWS];
    imk_model model;
    imk_model_default(&model);
    model.accel.noise.white = axes(0.0, 1.0, 0.0);
    model.accel.noise.random_walk = axes(0.0, 2.0, 0.0);
    model.accel.noise.gauss_markov_count = 2;
    model.accel.noise.gauss_markov[0].correlation_time = axes(1.0, 1.0, 1.0);
    model.accel.noise.gauss_markov[1].sigma = axes(0.0, 3.0, 0.0);
    model.accel.noise.gauss_markov[1].correlation_time = axes(1.0, 5.0, 1.0);
    imk_simulation simulation = imk_simulation_default();
    simulation.seed = 99;
    simulation.run = 7;
    simulate(&model, &simulation, &log);
    imk_random random = imk_random_seeded(99);
    imk_white_state white;
    imk_random_walk_state walk;
    imk_gauss_markov_state gauss_markov;
    const uint8_t axis = 8 + 1;
    CHECK_OK(imk_white_start(&white, 1.0, 0.01, random, imk_stream(7, IMK_TERM_WHITE, 0, axis)));
    CHECK_OK(imk_random_walk_start(&walk, 2.0, 0.01, random,
                                   imk_stream(7, IMK_TERM_RANDOM_WALK, 0, axis)));
    CHECK_OK(imk_gauss_markov_start(&gauss_markov, (imk_gauss_markov){3.0, 5.0}, 0.01, random,
                                    imk_stream(7, IMK_TERM_GAUSS_MARKOV, 1, axis)));
    memset(expected, 0, sizeof expected);
    imk_white_add(&white, ROWS, expected);
    imk_random_walk_add(&walk, ROWS, expected);
    imk_gauss_markov_add(&gauss_markov, ROWS, expected);
    assert_memory_equal(log.value[4], expected, sizeof expected);
}

/* Nothing on one axis, or another value on it, changes any other axis by a bit. */
static void test_axes_do_not_touch_each_other(void **state)
{
    (void)state;
    static log6 all, less;
    imk_model model = full_model();
    imk_simulation simulation = imk_simulation_default();
    simulate(&model, &simulation, &all);
    imk_noise *noise = &model.gyro.noise;
    noise->white.value[0] = noise->bias_instability.value[0] = noise->random_walk.value[0] = 0.0;
    noise->ramp.value[0] = noise->quantization.value[0] = noise->sinusoid[0].amplitude.value[0] =
        0.0;
    noise->gauss_markov[0].sigma.value[0] = noise->gauss_markov[1].sigma.value[0] = 0.0;
    noise->resonance[0].sigma.value[0] = 0.0;
    model.gyro.bias.repeatability.value[0] = model.gyro.scale_factor.repeatability.value[0] = 0.0;
    simulate(&model, &simulation, &less);
    for (size_t row = 0; row < ROWS; row++)
        CHECK_CLOSE(less.value[0][row], rate45, 1e-19);
    for (size_t i = 1; i < CHANNELS; i++) {
        assert_memory_equal(all.value[i], less.value[i], sizeof all.value[i]);
        double change = 0.0;
        for (size_t row = 1; row < ROWS; row++)
            change += fabs(all.value[i][row] - all.value[i][row - 1]);
        assert_true(change > 0.0); /* not silent */
    }
    /* a second simulation leaves the model, and so the first, alone */
    model = full_model();
    simulate(&model, &simulation, &less);
    assert_memory_equal(&all, &less, sizeof all);
}

/* Another seed and another run are other draws of every channel. */
static void test_seeds_and_runs(void **state)
{
    (void)state;
    static log6 one, two;
    imk_model model = full_model();
    imk_simulation simulation = imk_simulation_default();
    simulate(&model, &simulation, &one);
    simulation.seed = 1;
    simulate(&model, &simulation, &two);
    for (size_t i = 0; i < CHANNELS; i++)
        assert_memory_not_equal(one.value[i], two.value[i], sizeof one.value[i]);
    simulation.seed = 0;
    simulation.run = 1;
    simulate(&model, &simulation, &two);
    for (size_t i = 0; i < CHANNELS; i++)
        assert_memory_not_equal(one.value[i], two.value[i], sizeof one.value[i]);
}

/* Neither the number of threads nor the division into calls changes a bit. */
static void test_threads_and_blocks(void **state)
{
    (void)state;
    static log6 whole, pieces;
    const size_t piece[] = {1, 512, 7, 511, 300, 1000, 2, 513};
    imk_model model = full_model();
    imk_simulation simulation = imk_simulation_default();
    simulate(&model, &simulation, &whole);
    for (size_t threads = 1; threads <= 3; threads++) {
        imk_thread_pool *pool = imk_thread_pool_create(threads);
        imk_executor executor = imk_thread_pool_executor(pool);
        imk_simulator *simulator = start(&model, &simulation);
        memset(&pieces, 0, sizeof pieces);
        size_t done = 0;
        for (size_t i = threads; done < ROWS; i++) {
            size_t count = piece[i % 8] < ROWS - done ? piece[i % 8] : ROWS - done;
            next(simulator, &pieces, done, count, &executor);
            done += count;
        }
        free(simulator);
        imk_thread_pool_destroy(pool);
        assert_memory_equal(&whole, &pieces, sizeof whole);
    }
}

/* A redundant unit whose sixteen axes all have a filter and a resonance: on one thread they are
 * more sequences than are computed together. */
static void test_sixteen_filtered_axes(void **state)
{
    (void)state;
    enum { COUNT = 1024, AXES = 2 * IMK_AXES_MAX };
    static double value[3][AXES][COUNT];
    imk_model model = full_model();
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    for (int sensor = 0; sensor < 2; sensor++) {
        triads[sensor]->axis_count = IMK_AXES_MAX;
        for (int i = 0; i < IMK_AXES_MAX; i++) {
            const double angle = 0.4 * i, z = 0.1 * i;
            const double direction[3] = {sqrt(1.0 - z * z) * cos(angle),
                                         sqrt(1.0 - z * z) * sin(angle), z};
            memcpy(triads[sensor]->direction[i], direction, sizeof direction);
            triads[sensor]->noise.white.value[i] = 1e-3 * (i + 1);
            triads[sensor]->bandwidth.value[i] = 20.0 + i;
            triads[sensor]->noise.resonance[0].sigma.value[i] = 1e-3;
            triads[sensor]->noise.resonance[0].frequency.value[i] = 10.0 + i;
            triads[sensor]->noise.resonance[0].q.value[i] = 5.0;
        }
    }
    const imk_simulation simulation = imk_simulation_default();
    for (size_t threads = 1; threads <= 3; threads++) {
        double *columns[AXES];
        imk_thread_pool *pool = imk_thread_pool_create(threads);
        imk_executor executor = imk_thread_pool_executor(pool);
        imk_simulator *simulator = start(&model, &simulation);
        assert_int_equal(imk_simulator_channels(simulator), AXES);
        for (size_t i = 0; i < AXES; i++)
            columns[i] = value[threads - 1][i];
        imk_simulator_next(simulator, COUNT, columns, &executor);
        free(simulator);
        imk_thread_pool_destroy(pool);
        assert_memory_equal(value[0], value[threads - 1], sizeof value[0]);
    }
    for (size_t i = 1; i < AXES; i++)
        assert_memory_not_equal(value[0][0], value[0][i], sizeof value[0][0]);
}

/* FNV-1a of the bits, least significant byte first. */
static uint64_t hash_of(const log6 *log)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i < CHANNELS; i++)
        for (size_t row = 0; row < ROWS; row++) {
            uint64_t bits;
            memcpy(&bits, &log->value[i][row], sizeof bits);
            for (int byte = 0; byte < 8; byte++)
                hash = (hash ^ (bits >> 8 * byte & 0xff)) * 0x100000001b3u;
        }
    return hash;
}

/* The whole model has the same bits on every instruction set, compiler and machine: this value was
 * made by gcc 12 -O3 on x86-64. It changes only when a sequence's definition is changed on purpose.
 */
static void test_golden_hash(void **state)
{
    (void)state;
    static log6 log;
    const uint64_t golden = 0x6173d25664d52bf5u;
    const char *const isa[] = {"scalar", "avx2", "avx512", "neon"};
    char before[16] = "";
    if (getenv("IMUKIT_ISA"))
        strncpy(before, getenv("IMUKIT_ISA"), sizeof before - 1);
    imk_model model = full_model();
    imk_simulation simulation = imk_simulation_default();
    simulation.latitude = 0.6;
    simulation.height = 380.0;
    simulation.roll = 0.1;
    simulation.pitch = -0.2;
    simulation.yaw = 1.3;
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(setenv("IMUKIT_ISA", isa[i], 1), 0);
        simulate(&model, &simulation, &log);
        if (hash_of(&log) != golden)
            fail_msg("hash of a simulated log on %s: 0x%016llx, expected 0x%016llx", isa[i],
                     (unsigned long long)hash_of(&log), (unsigned long long)golden);
    }
    assert_int_equal(before[0] ? setenv("IMUKIT_ISA", before, 1) : unsetenv("IMUKIT_ISA"), 0);
}

/* ---- the output stage ------------------------------------------------------------------------ */

static void test_range_resolution_counts(void **state)
{
    (void)state;
    static log6 log;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.white = axes(0.1, 0.1, 0.1); /* 1 rad/s a sample at 100 Hz */
    model.gyro.range = axes(1.0, 0.0, 0.0);
    model.gyro.resolution = axes(0.0, 0.25, 0.0);
    imk_simulation simulation = imk_simulation_default();
    simulation.earth = false;
    simulate(&model, &simulation, &log);
    size_t high = 0, low = 0, inside = 0;
    for (size_t row = 0; row < ROWS; row++) {
        double x = log.value[0][row];
        assert_true(fabs(x) <= 1.0);
        high += x == 1.0;
        low += x == -1.0;
        inside += fabs(x) < 1.0;
        double steps = log.value[1][row] / 0.25;
        CHECK_CLOSE(steps, rint(steps), 0.0);
    }
    /* 15.9 % beyond each end: 476 of 3000, standard deviation 20 */
    CHECK_CLOSE((double)high, 476.0, 6.0 * 20.0);
    CHECK_CLOSE((double)low, 476.0, 6.0 * 20.0);
    assert_int_equal(high + low + inside, ROWS);

    static log6 counts;
    model.gyro.sensitivity = axes(100.0, 100.0, 100.0);
    model.gyro.zero_offset = axes(32768.0, 0.0, 7.0);
    simulate(&model, &simulation, &counts);
    for (size_t row = 0; row < ROWS; row++) {
        CHECK_CLOSE(counts.value[0][row], rint(100.0 * log.value[0][row] + 32768.0), 0.0);
        CHECK_CLOSE(counts.value[1][row], rint(100.0 * log.value[1][row]), 0.0);
        CHECK_CLOSE(counts.value[2][row], rint(100.0 * log.value[2][row] + 7.0), 0.0);
    }
}

/* In the simulator the quantiser works on whole blocks, in the library's call on any: same bits. */
static void test_quantization(void **state)
{
    (void)state;
    static log6 plain, quantised;
    imk_model model;
    imk_model_default(&model);
    model.accel.noise.white = axes(0.01, 0.01, 0.01);
    imk_simulation simulation = imk_simulation_default();
    simulate(&model, &simulation, &plain);
    model.accel.noise.quantization = axes(1e-4, 1e-4, 1e-4);
    simulate(&model, &simulation, &quantised);
    for (uint8_t axis = 0; axis < 3; axis++) {
        imk_quantization_state quantization;
        CHECK_OK(imk_quantization_start(&quantization, 1e-4, 0.01, imk_random_seeded(0),
                                        imk_stream(0, IMK_TERM_QUANTIZATION, 0, 8 + axis)));
        imk_quantization_apply(&quantization, ROWS, plain.value[3 + axis]);
        assert_memory_equal(plain.value[3 + axis], quantised.value[3 + axis],
                            sizeof plain.value[3 + axis]);
    }
}

/* The ramp is exact at any sample. */
static void test_ramp(void **state)
{
    (void)state;
    static log6 log;
    imk_model model;
    imk_model_default(&model);
    model.gyro.noise.ramp = axes(0.0, 0.25, 0.0);
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = 64.0;
    simulate(&model, &simulation, &log);
    for (size_t row = 0; row < ROWS; row++)
        CHECK_CLOSE(log.value[1][row], 0.25 * (double)row / 64.0, 0.0);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static void expect(const imk_model *model, const imk_simulation *simulation, imk_status status,
                   const char *field)
{
    size_t size = imk_simulator_size(model, simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_simulator *untouched = (imk_simulator *)&size, *simulator = untouched;
    imk_error error;
    CHECK_STATUS(imk_simulator_start(model, simulation, &simulator, memory, size, &error), status);
    assert_string_equal(error.field, field);
    assert_int_equal(error.status, status);
    assert_ptr_equal(simulator, untouched);
    CHECK_STATUS(imk_simulator_start(model, simulation, &simulator, memory, size, NULL), status);
    free(memory);
}

static void test_errors(void **state)
{
    (void)state;
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = imk_simulation_default();
    simulation.rate = 0.0;
    expect(&model, &simulation, IMK_ERROR_RANGE, "rate");
    simulation.rate = (double)NAN;
    expect(&model, &simulation, IMK_ERROR_NOT_FINITE, "rate");
    simulation = imk_simulation_default();
    simulation.latitude = 1.6;
    expect(&model, &simulation, IMK_ERROR_RANGE, "latitude");
    memset(&simulation, 0, sizeof simulation);
    expect(&model, &simulation, IMK_ERROR_UNINITIALISED, "simulation");
    simulation = imk_simulation_default();
    model.gyro.noise.white.value[0] = 1.0;
    model.gyro.bandwidth.value[0] = 1e-6; /* 1e-8 of the rate */
    expect(&model, &simulation, IMK_ERROR_RANGE, "gyro.bandwidth");

    imk_model_default(&model);
    size_t size = imk_simulator_size(&model, &simulation);
    unsigned char *memory = aligned_alloc(64, (size + 127) / 64 * 64);
    assert_non_null(memory);
    imk_simulator *simulator;
    CHECK_STATUS(imk_simulator_start(&model, &simulation, &simulator, memory, size - 1, NULL),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_simulator_start(&model, &simulation, &simulator, NULL, size, NULL),
                 IMK_ERROR_ARGUMENT);
    CHECK_OK(imk_simulator_start(&model, &simulation, &simulator, memory + 8, size, NULL));
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth),
        cmocka_unit_test(test_perfect_unit),
        cmocka_unit_test(test_repeatability),
        cmocka_unit_test(test_streams),
        cmocka_unit_test(test_axes_do_not_touch_each_other),
        cmocka_unit_test(test_seeds_and_runs),
        cmocka_unit_test(test_threads_and_blocks),
        cmocka_unit_test(test_sixteen_filtered_axes),
        cmocka_unit_test(test_golden_hash),
        cmocka_unit_test(test_range_resolution_counts),
        cmocka_unit_test(test_quantization),
        cmocka_unit_test(test_ramp),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
