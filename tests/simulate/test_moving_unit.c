/* SPDX-License-Identifier: Apache-2.0 */
/* Units that move: bandwidth, timing errors, vibration, parts of samples; the same bytes for any
 * threads, calls and instruction set. Motions are sines, whose means have closed forms. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "check.h"
#include "simulated_log.h"

#include "imukit/distributions.h"
#include "imukit/thread_pool.h"

#include <complex.h>
#include <string.h>

enum { ROWS = 1500, CHANNELS = 6 };

static const double pi = 3.14159265358979323846;
static const double dt = 0.01;
static const double complex i1 = (double complex)I; /* I itself is a complex float */

/* ---- a body at rest but for vibration, in empty space -----------------------------------------
 */

typedef struct shaken {
    imk_trajectory_piece piece;
    imk_trajectory trajectory;
} shaken;

static void shake(shaken *s, bool earth, size_t count, const imk_vibration_line *lines)
{
    const double level[3] = {0.1, -0.2, 0.7}, flat[3] = {0.0};
    imk_geodetic place = {0.8, 0.2, 300.0};
    CHECK_OK(imk_trajectory_standstill(place, earth ? level : flat, earth, &s->piece,
                                       &s->trajectory, NULL));
    s->trajectory.line_count = count;
    s->trajectory.line = lines;
}

static imk_simulation simulation_of(const shaken *s)
{
    imk_simulation simulation = imk_simulation_default();
    simulation.motion.trajectory = &s->trajectory;
    return simulation;
}

/* Rotation about x and displacement along z, both slow enough to be seen at 100 Hz. */
static const imk_vibration_line slow_lines[] = {
    {.axis = 3, .amplitude = 0.01, .frequency = 5.0, .phase = 0.1},
    {.axis = 2, .amplitude = 0.02, .frequency = 3.0, .phase = 0.3},
};

/* Mean over begin … end of amplitude sin(2 pi (f t + phase)), differentiated `order` times. */
static double mean_of_line(const imk_vibration_line *line, int order, double begin, double end)
{
    const double w = 2.0 * pi * line->frequency;
    double complex value =
        line->amplitude * cpow(i1 * w, order) * cexp(2.0 * pi * i1 * line->phase);
    value *= (cexp(i1 * w * end) - cexp(i1 * w * begin)) / (i1 * w * (end - begin));
    return cimag(value);
}

/* A perfect unit reads the means, however its samples are divided. */
static void test_means(void **state)
{
    (void)state;
    shaken s;
    shake(&s, false, 2, slow_lines);
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = simulation_of(&s);
    static const size_t substeps[] = {0, 1, 3, 64};
    for (size_t i = 0; i < 4; i++) {
        simulation.substeps = substeps[i];
        double *log = simulate_rows(&model, &simulation, ROWS);
        for (int k = 0; k < ROWS; k++) {
            double begin = (k - 1) * dt, end = k * dt;
            /* Row 0 is before the start: the body vibrates, its trajectory rests. A rate of 0.3
             * rad/s and a force of 7 m/s^2: quadrature at a twentieth of a cycle. */
            CHECK_CLOSE(log[k], mean_of_line(&slow_lines[0], 1, begin, end), 1e-12);
            /* along z of a body that is tilted by the rotation about x, in empty space */
            double force = hypot(log[4 * ROWS + k], log[5 * ROWS + k]);
            CHECK_CLOSE(force, fabs(mean_of_line(&slow_lines[1], 2, begin, end)), 2e-3);
        }
        free(log);
    }
}

/* ---- bandwidth ---- */

/* Response of the filter: first order, or second order with the -3 dB point at f3. */
static double complex response(double f, double f3, double damping)
{
    if (damping == 0.0)
        return 1.0 / (1.0 + i1 * f / f3);
    double m = 1.0 - 2.0 * damping * damping;
    double f0 = f3 / sqrt(m + sqrt(m * m + 1.0));
    return 1.0 / (1.0 - f * f / (f0 * f0) + 2.0 * i1 * damping * f / f0);
}

/* A sine comes through with the filter's gain and delay, exactly placed, for bandwidths below and
 * above Nyquist. */
static void test_bandwidth(void **state)
{
    (void)state;
    static const struct {
        double bandwidth, damping;
    } filters[] = {{10.0, 0.0}, {10.0, 0.7}, {20.0, 0.3}, {200.0, 0.0}, {300.0, 0.9}};
    shaken s;
    shake(&s, false, 1, slow_lines);
    imk_simulation simulation = simulation_of(&s);
    for (size_t i = 0; i < 5; i++) {
        imk_model model;
        imk_model_default(&model);
        model.gyro.bandwidth = axes(filters[i].bandwidth, 0.0, 0.0);
        model.gyro.damping = axes(filters[i].damping, 0.0, 0.0);
        double *log = simulate_rows(&model, &simulation, ROWS);
        imk_vibration_line filtered = slow_lines[0];
        double complex gain = response(5.0, filters[i].bandwidth, filters[i].damping);
        filtered.amplitude *= cabs(gain);
        filtered.phase += carg(gain) / (2.0 * pi);
        /* From 1 s on the start is forgotten (e^-31). The eighths of a sample are 1/160 of a cycle:
         * (pi/160)^2/3 = 1.3e-4 of the amplitude, 0.314 rad/s; a third more where the filter turns
         * the phase of the images. */
        for (int k = 100; k < ROWS; k++) {
            double expected = mean_of_line(&filtered, 1, (k - 1) * dt, k * dt);
            CHECK_CLOSE(log[k], expected, 1.75e-4 * 0.314 * fmax(1.0, cabs(gain)));
        }
        free(log);
    }
}

/* ---- timing ---- */

static void test_rate_error(void **state)
{
    (void)state;
    shaken s;
    shake(&s, false, 1, slow_lines);
    imk_simulation simulation = simulation_of(&s);
    imk_model model;
    imk_model_default(&model);
    model.timing.rate_error.value = 0.002; /* a clock 2000 ppm fast */
    double *log = simulate_rows(&model, &simulation, ROWS);
    for (int k = 0; k < ROWS; k++) {
        double begin = (k - 1) * dt / 1.002, end = k * dt / 1.002;
        CHECK_CLOSE(log[k], mean_of_line(&slow_lines[0], 1, begin, end), 1e-12);
    }
    free(log);
}

static void test_skew(void **state)
{
    (void)state;
    static const imk_vibration_line line = {
        .axis = 0, .amplitude = 0.01, .frequency = 4.0, .phase = 0.2};
    shaken s;
    shake(&s, false, 1, &line);
    imk_simulation simulation = simulation_of(&s);
    imk_model model;
    imk_model_default(&model);
    model.timing.skew.value = 0.0033;
    double *log = simulate_rows(&model, &simulation, ROWS);
    for (int k = 0; k < ROWS; k++) {
        double begin = (k - 1) * dt - 0.0033, end = k * dt - 0.0033;
        CHECK_CLOSE(log[3 * ROWS + k], mean_of_line(&line, 2, begin, end), 1e-11);
    }
    free(log);
}

/* Jitter: the boundaries are off by normals, and the samples are the means between them. */
static void test_jitter(void **state)
{
    (void)state;
    shaken s;
    shake(&s, false, 1, slow_lines);
    imk_simulation simulation = simulation_of(&s);
    imk_model model;
    imk_model_default(&model);
    const double sigma = 3e-4;
    model.timing.jitter.value = sigma;
    imk_simulator *simulator = start_simulator(&model, &simulation);
    double *log = simulate_rows(&model, &simulation, ROWS), sum = 0.0;
    for (int k = 0; k < ROWS; k++) {
        double begin = imk_simulator_true_time(simulator, k - 1);
        double end = imk_simulator_true_time(simulator, k);
        CHECK_CLOSE(log[k], mean_of_line(&slow_lines[0], 1, begin, end), 1e-12);
        sum += (end - k * dt) * (end - k * dt) / (sigma * sigma);
    }
    double probability = imk_chi_square_probability(sum, ROWS);
    assert_true(probability > 1e-7 && probability < 1.0 - 1e-7);
    free(log);
    free(simulator);

    model.timing.jitter.value = 1e-3; /* a tenth of a sample */
    const size_t size = imk_simulator_size(&model, &simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_error error;
    CHECK_STATUS(imk_simulator_start(&model, &simulation, &simulator, memory, size, &error),
                 IMK_ERROR_RANGE);
    assert_string_equal(error.field, "timing.jitter");
    free(memory);
}

/* Dropped rows: the stated fraction (binomial, 6 sigma), other ones in another run. */
static void test_drops(void **state)
{
    (void)state;
    enum { MANY = 20000 };
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = imk_simulation_default();
    imk_simulator *none = start_simulator(&model, &simulation);
    model.timing.drops.value = 0.03;
    imk_simulator *one = start_simulator(&model, &simulation);
    simulation.run = 1;
    imk_simulator *other = start_simulator(&model, &simulation);
    double dropped = 0.0, both = 0.0;
    for (uint64_t row = 0; row < MANY; row++) {
        assert_false(imk_simulator_dropped(none, row));
        dropped += imk_simulator_dropped(one, row);
        both += imk_simulator_dropped(one, row) && imk_simulator_dropped(other, row);
    }
    CHECK_CLOSE(dropped, 0.03 * MANY, 6.0 * sqrt(0.03 * MANY));
    CHECK_BELOW(both, 0.0009 * MANY + 6.0 * sqrt(0.0009 * MANY));
    free(none);
    free(one);
    free(other);
}

/* ---- vibration faster than the samples ---- */

/* Rectification: K2 turns vibration of rms a into a bias K2 a^2, though the log shows hardly any of
 * it. The mean over a part h loses (sin(pi f h)/(pi f h))^2 of the square. 470 Hz, whole cycles in
 * 15 s, no gravity. */
static void test_vibration_rectification(void **state)
{
    (void)state;
    static const size_t substeps[] = {0, 300};
    const double frequency = 470.0, acceleration = 50.0, w = 2.0 * pi * frequency;
    const imk_vibration_line line = {
        .axis = 2, .amplitude = acceleration / (w * w), .frequency = frequency, .phase = 0.0};
    shaken s;
    shake(&s, false, 1, &line);
    imk_simulation simulation = simulation_of(&s);
    imk_model model;
    imk_model_default(&model);
    model.accel.nonlinearity.k2 = axes(1e-4, 1e-4, 1e-4);
    for (int i = 0; i < 2; i++) {
        simulation.substeps = substeps[i];
        double *log = simulate_rows(&model, &simulation, ROWS + 1), mean = 0.0;
        for (int k = 1; k <= ROWS; k++)
            mean += log[5 * (ROWS + 1) + k] / ROWS;
        /* by itself: 16 parts to a cycle, 76 to a sample */
        const double parts = substeps[i] > 0 ? (double)substeps[i] : ceil(16.0 * frequency * dt);
        const double x = pi * frequency * dt / parts, seen = sin(x) / x;
        CHECK_RELATIVE(mean, 1e-4 * 0.5 * acceleration * acceleration * seen * seen, 1e-6);
        assert_true(seen * seen > 0.985);
        free(log);
    }
}

/* ---- the same bytes ---- */

static imk_model lively_model(void)
{
    imk_model model;
    imk_model_default(&model);
    for (int sensor = 0; sensor < 2; sensor++) {
        imk_triad *triad = sensor == 0 ? &model.gyro : &model.accel;
        triad->bias.fixed = axes(0.1, -0.2, 0.3);
        triad->bias.repeatability = axes(0.1, 0.1, 0.0);
        triad->bias.temperature = (imk_temperature_polynomial){
            .order = 2, .reference = 298.0, .minimum = 250.0, .maximum = 350.0};
        triad->bias.temperature.coefficient[0] = axes(1e-3, 2e-3, 0.0);
        triad->bias.temperature.coefficient[1] = axes(1e-5, 0.0, 2e-5);
        triad->bias.hysteresis = axes(0.01, 0.02, 0.0);
        triad->bias.warm_up_amplitude = axes(0.01, 0.0, 0.02);
        triad->bias.warm_up_time.value = 3.0;
        triad->bias.temperature_rate = axes(0.01, 0.02, 0.03);
        triad->scale_factor.fixed = axes(1e-3, 2e-3, -1e-3);
        triad->nonlinearity.k2 = axes(1e-4, 0.0, 1e-4);
        triad->nonlinearity.koq = axes(0.0, 1e-4, 1e-4);
        triad->nonlinearity.asymmetry = axes(1e-3, 0.0, 1e-3);
        triad->misalignment.value[0][1] = 1e-3;
        triad->cross_axis.value[2][0] = 2e-3;
        triad->noise.white = axes(1e-3, 2e-3, 0.0);
        triad->noise.bias_instability = axes(1e-3, 0.0, 1e-3);
        triad->noise.quantization = axes(0.0, 1e-6, 0.0);
        triad->bandwidth = axes(30.0, 0.0, 200.0);
        triad->damping = axes(0.7, 0.0, 0.0);
        triad->dead_band = axes(0.0, 1e-3, 0.0);
        triad->range = axes(0.0, 9.0, 0.0);
        triad->resolution = axes(1e-3, 0.0, 0.0);
    }
    model.gyro.g_sensitivity.value[1][2] = 1e-4;
    model.gyro.g2_sensitivity.value[2][3] = 1e-5;
    model.accel.lever_arm.value[0][1] = 0.05;
    model.accel.lever_arm.value[2][0] = -0.03;
    model.timing.jitter.value = 1e-4;
    model.timing.skew.value = 2e-3;
    model.timing.rate_error.value = 1e-4;
    return model;
}

/* Rows in calls of 1, 512, 7, … rows. */
static double *in_pieces(const imk_model *model, const imk_simulation *simulation,
                         const imk_executor *executor)
{
    static const size_t piece[] = {1, 512, 7, 300, 513, 1, 2, 700};
    imk_simulator *simulator = start_simulator(model, simulation);
    double *values = malloc(CHANNELS * ROWS * sizeof *values);
    for (size_t done = 0, i = 0; done < ROWS; i++) {
        size_t count = piece[i % 8] < ROWS - done ? piece[i % 8] : ROWS - done;
        double *columns[CHANNELS];
        for (size_t c = 0; c < CHANNELS; c++)
            columns[c] = values + c * ROWS + done;
        imk_simulator_next(simulator, count, columns, executor);
        done += count;
    }
    free(simulator);
    return values;
}

static void test_same_bytes(void **state)
{
    (void)state;
    static const imk_vibration_line lines[] = {
        {.axis = 3, .amplitude = 0.01, .frequency = 5.0, .phase = 0.1},
        {.axis = 2, .amplitude = 1e-3, .frequency = 31.0, .phase = 0.3},
        {.axis = 0, .amplitude = 1e-4, .frequency = 77.0, .phase = 0.9},
    };
    static const double time[] = {0.0, 5.0, 9.0}, temperature[] = {280.0, 320.0, 300.0};
    const imk_temperature_profile profile = {
        .point_count = 3, .time = time, .temperature = temperature, .time_constant = 2.0};
    static const char *const isa[] = {"scalar", "avx2", "avx512", "neon"};
    char before[16] = "";
    if (getenv("IMUKIT_ISA"))
        strncpy(before, getenv("IMUKIT_ISA"), sizeof before - 1);
    shaken s;
    shake(&s, true, 3, lines);
    imk_model model = lively_model();
    imk_simulation simulation = simulation_of(&s);
    simulation.temperature = &profile;
    simulation.seed = 5;
    double *whole = simulate_rows(&model, &simulation, ROWS);
    const size_t size = CHANNELS * ROWS * sizeof *whole;
    for (size_t threads = 1; threads <= 3; threads++) {
        imk_thread_pool *pool = imk_thread_pool_create(threads);
        imk_executor executor = imk_thread_pool_executor(pool);
        double *pieces = in_pieces(&model, &simulation, &executor);
        assert_memory_equal(whole, pieces, size);
        free(pieces);
        imk_thread_pool_destroy(pool);
    }
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(setenv("IMUKIT_ISA", isa[i], 1), 0);
        double *log = simulate_rows(&model, &simulation, ROWS);
        assert_memory_equal(whole, log, size);
        free(log);
    }
    assert_int_equal(before[0] ? setenv("IMUKIT_ISA", before, 1) : unsetenv("IMUKIT_ISA"), 0);
    free(whole);
}

/* ---- errors ---- */

static void expect(const imk_model *model, const imk_simulation *simulation, imk_status status,
                   const char *field)
{
    const size_t size = imk_simulator_size(model, simulation);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    imk_simulator *simulator;
    imk_error error;
    CHECK_STATUS(imk_simulator_start(model, simulation, &simulator, memory, size, &error), status);
    assert_string_equal(error.field, field);
    free(memory);
}

static void test_errors(void **state)
{
    (void)state;
    static const double zero[10] = {0.0};
    imk_recorded_motion recorded = {.count = 10, .rate = 100.0};
    for (int i = 0; i < 3; i++)
        recorded.angular_rate[i] = recorded.specific_force[i] = zero;
    shaken s;
    shake(&s, true, 0, NULL);
    imk_model model;
    imk_model_default(&model);
    imk_simulation simulation = simulation_of(&s);
    simulation.motion.recorded = &recorded;
    expect(&model, &simulation, IMK_ERROR_CONFLICT, "motion");
    simulation.motion.trajectory = NULL;
    simulation.rate = 200.0;
    expect(&model, &simulation, IMK_ERROR_CONFLICT, "rate");
    simulation.rate = 100.0;
    simulation.substeps = 2;
    expect(&model, &simulation, IMK_ERROR_CONFLICT, "substeps");
    simulation.substeps = 0;
    model.timing.skew.value = 1e-3;
    expect(&model, &simulation, IMK_ERROR_CONFLICT, "timing");
    model.timing.skew.value = 0.0;
    recorded.count = 0;
    expect(&model, &simulation, IMK_ERROR_EMPTY, "motion");
    simulation = simulation_of(&s);
    simulation.substeps = 1000;
    expect(&model, &simulation, IMK_ERROR_RANGE, "substeps");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_means),
        cmocka_unit_test(test_bandwidth),
        cmocka_unit_test(test_rate_error),
        cmocka_unit_test(test_skew),
        cmocka_unit_test(test_jitter),
        cmocka_unit_test(test_drops),
        cmocka_unit_test(test_vibration_rectification),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
