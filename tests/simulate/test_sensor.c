/* SPDX-License-Identifier: Apache-2.0 */
/* A sensor that is stepped gives the bytes of a simulation, alone and beside others; wrong
 * arguments; truths that are not numbers. bench_sensor compares a million steps. */
#define _POSIX_C_SOURCE 200809L /* setenv */
#include "check.h"
#include "simulated_log.h"

#include "imukit/sensor.h"

#include <string.h>

enum { ROWS = 1300, MOST = 2 * IMK_AXES_MAX };

static const double rate = 200.0;

/* ---- a motion, and a temperature that rises, falls and rises ---- */

static const double profile_time[] = {0.0, 1.5, 3.5, 7.0},
                    profile_temperature[] = {295.0, 310.0, 285.0, 300.0};
static const imk_temperature_profile profile = {.point_count = 4,
                                                .time = profile_time,
                                                .temperature = profile_temperature,
                                                .time_constant = 0.5};

enum { QUANTITIES = 11 };
typedef struct truth {
    double row[QUANTITIES][ROWS]; /* in the order of imk_sensor_truth */
} truth;

static void make_truth(truth *t)
{
    double time[ROWS];
    for (int i = 0; i < 9; i++)
        for (size_t k = 0; k < ROWS; k++)
            t->row[i][k] = (i < 3 ? 0.7 : 6.0) * sin(0.01 * (double)k * (i + 1) + i);
    for (size_t k = 0; k < ROWS; k++)
        time[k] = ((double)k - 0.5) * (1.0 / rate);
    imk_temperature_at(&profile, ROWS, time, t->row[9], t->row[10]);
}

static imk_sensor_truth truth_of(const truth *t, size_t k)
{
    imk_sensor_truth now;
    double *quantity[QUANTITIES];
    for (int i = 0; i < 3; i++) {
        quantity[i] = &now.angular_rate[i];
        quantity[3 + i] = &now.specific_force[i];
        quantity[6 + i] = &now.angular_acceleration[i];
    }
    quantity[9] = &now.temperature;
    quantity[10] = &now.temperature_rate;
    for (int i = 0; i < QUANTITIES; i++)
        *quantity[i] = t->row[i][k];
    return now;
}

/* ---- models ---- */

static imk_rows rows(double value)
{
    imk_rows r = {.value = {{0.0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.value[i][j] = i == j ? 0.0 : value * (i + 2 * j + 1);
    return r;
}

static void add_noise(imk_noise *noise, double unit)
{
    noise->white = axes(unit, 2.0 * unit, 3.0 * unit);
    noise->bias_instability = axes(0.5 * unit, 0.4 * unit, 0.3 * unit);
    noise->random_walk = axes(0.1 * unit, 0.2 * unit, 0.3 * unit);
    noise->ramp = axes(1e-3 * unit, -2e-3 * unit, 3e-3 * unit);
    noise->angle_white = axes(1e-4 * unit, 0.0, 2e-4 * unit);
    noise->reading_noise = axes(0.0, 1e-4 * unit, 2e-4 * unit);
    noise->quantization = axes(1e-3 * unit, 0.0, 2e-3 * unit);
    noise->gauss_markov_count = 3;
    for (int i = 0; i < 3; i++) {
        noise->gauss_markov[i].sigma = axes(unit, i == 1 ? 0.0 : unit, 0.5 * unit);
        noise->gauss_markov[i].correlation_time = axes(1.0 + i, 20.0, 300.0);
    }
    noise->sinusoid_count = 2;
    for (int i = 0; i < 2; i++) {
        noise->sinusoid[i].amplitude = axes(unit, 2.0 * unit, i == 0 ? 0.0 : unit);
        noise->sinusoid[i].frequency = axes(7.0 + i, 13.0, 1.0);
    }
    noise->resonance_count = 1;
    noise->resonance[0].sigma = axes(unit, 0.0, unit);
    noise->resonance[0].frequency = axes(20.0, 21.0, 22.0);
    noise->resonance[0].q = axes(10.0, 12.0, 14.0);
}

static void add_errors(imk_triad *triad, double unit)
{
    triad->bias.fixed = axes(unit, -2.0 * unit, 3.0 * unit);
    triad->bias.repeatability = axes(unit, unit, unit);
    triad->bias.temperature =
        (imk_temperature_polynomial){.order = 2, .reference = 298, .minimum = 270, .maximum = 305};
    triad->bias.temperature.coefficient[0] = axes(1e-2 * unit, 0.0, 1e-2 * unit);
    triad->bias.temperature.coefficient[1] = axes(1e-4 * unit, 1e-4 * unit, 0.0);
    triad->bias.temperature_rate = axes(1e-2 * unit, 0.0, unit);
    triad->bias.hysteresis = axes(unit, 0.0, 2.0 * unit);
    triad->bias.warm_up_amplitude = axes(unit, 2.0 * unit, -unit);
    triad->bias.warm_up_time.value = 3.0;
    triad->scale_factor.fixed = axes(1e-3, -1e-3, 0.0);
    triad->scale_factor.repeatability = axes(1e-4, 1e-4, 1e-4);
    triad->scale_factor.temperature = triad->bias.temperature;
    triad->nonlinearity.k2 = triad->nonlinearity.koq = axes(1e-5, 2e-5, 0.0);
    triad->nonlinearity.k3 = axes(1e-6, 0.0, 1e-6);
    triad->nonlinearity.asymmetry = axes(1e-4, -1e-4, 1e-4);
    triad->misalignment = rows(1e-4);
    triad->cross_axis = rows(2e-4);
    triad->bandwidth = axes(40.0, 0.0, 30.0);
    triad->damping = axes(0.7, 0.0, 0.0);
    triad->dead_band = axes(unit, 0.0, 2.0 * unit);
}

/* Every term that a model can have. */
static imk_model full_model(void)
{
    imk_model model;
    imk_model_default(&model);
    add_errors(&model.gyro, 1e-3);
    add_noise(&model.gyro.noise, 1e-4);
    add_errors(&model.accel, 1e-2);
    add_noise(&model.accel.noise, 1e-3);
    model.accel.bias.warm_up_time.value = 5.0;
    model.gyro.range = axes(0.6, 0.6, 0.6);
    model.accel.range = axes(5.0, 100.0, 5.5);
    model.gyro.resolution = axes(1e-5, 0.0, 1e-4); /* or a quantized integral, not both */
    model.gyro.noise.quantization = axes(0.0, 0.0, 0.0);
    model.accel.nonlinearity.cross_products = rows(1e-6);
    model.accel.lever_arm = rows(0.01);
    model.gyro.g_sensitivity = rows(1e-6);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++)
            model.gyro.g2_sensitivity.value[i][j] = 1e-8 * (i + j + 1);
    model.timing.drops.value = 0.1;
    return model;
}

/* In counts, as a device gives them. */
static imk_model device_model(size_t index)
{
    imk_model model;
    imk_device_model(imk_device_get(index), &model);
    model.accel.sensitivity = axes(1000.0, 1000.0, 1000.0);
    model.accel.zero_offset = axes(100.0, 0.0, -5.0);
    return model;
}

/* Six gyros, no accelerometers. */
static imk_model redundant_model(void)
{
    imk_model model;
    imk_model_default(&model);
    model.accel.present = false;
    model.gyro.axis_count = 6;
    for (int i = 0; i < 6; i++) {
        model.gyro.direction[i][i % 3] = i < 3 ? 0.6 : 1.0;
        model.gyro.direction[i][(i + 1) % 3] = i < 3 ? 0.8 : 0.0;
        model.gyro.direction[i][(i + 2) % 3] = 0.0;
        model.gyro.noise.white.value[i] = 1e-3;
        model.gyro.bandwidth.value[i] = 30.0 + i;
    }
    return model;
}

/* ---- sensors ---- */

/* In memory that free() gives back. */
static imk_sensor *start_sensor(const imk_model *model, const imk_sensor_settings *settings,
                                void **memory)
{
    const size_t size = imk_sensor_size(model, settings);
    imk_sensor *sensor = NULL;
    *memory = malloc(size);
    assert_non_null(*memory);
    memset(*memory, 0xA5, size);
    CHECK_OK(imk_sensor_start(model, settings, &sensor, *memory, size, NULL));
    return sensor;
}

static imk_sensor_settings settings_of(size_t count, uint32_t run)
{
    imk_sensor_settings settings = imk_sensor_default();
    settings.rate = rate;
    settings.seed = 7;
    settings.run = run;
    settings.count = count;
    settings.temperature = true;
    return settings;
}

/* The simulation of one run; free() it. */
static double *simulated(const imk_model *model, const truth *t, uint32_t run)
{
    imk_recorded_motion motion = {.count = ROWS, .rate = rate};
    imk_simulation simulation = imk_simulation_default();
    for (int i = 0; i < 3; i++) {
        motion.angular_rate[i] = t->row[i];
        motion.specific_force[i] = t->row[3 + i];
        motion.angular_acceleration[i] = t->row[6 + i];
    }
    simulation.rate = rate;
    simulation.seed = 7;
    simulation.run = run;
    simulation.motion.recorded = &motion;
    simulation.temperature = &profile;
    return simulate_rows(model, &simulation, ROWS);
}

static void compare(const double *readings, size_t channels, size_t count, size_t number,
                    const double *log, size_t row)
{
    for (size_t c = 0; c < channels; c++)
        if (memcmp(&readings[c * count + number], &log[c * ROWS + row], sizeof *log) != 0)
            fail_msg("sensor %zu of %zu, channel %zu, row %zu: %.17g instead of %.17g", number,
                     count, c, row, readings[c * count + number], log[c * ROWS + row]);
}

static void check_like_simulation(const imk_model *model, const truth *t)
{
    const imk_sensor_settings settings = settings_of(1, 3);
    double *log = simulated(model, t, 3), readings[MOST], sum = 0.0;
    void *memory;
    imk_sensor *sensor = start_sensor(model, &settings, &memory);
    for (size_t k = 0; k < ROWS; k++) {
        const imk_sensor_truth now = truth_of(t, k);
        CHECK_OK(imk_sensor_step(sensor, &now, readings));
        compare(readings, imk_sensor_channels(sensor), 1, 0, log, k);
        sum += fabs(readings[0]);
    }
    assert_true(sum > 0.0);
    free(memory);
    free(log);
}

static void test_like_simulation(void **state)
{
    (void)state;
    static truth t;
    const char *const isa[] = {"scalar", "avx2", "avx512", "neon"};
    const char *before = getenv("IMUKIT_ISA");
    make_truth(&t);
    const imk_model full = full_model(), redundant = redundant_model();
    for (size_t i = 0; i < 4 && !before; i++) {
        assert_int_equal(setenv("IMUKIT_ISA", isa[i], 1), 0);
        check_like_simulation(&full, &t);
        assert_int_equal(unsetenv("IMUKIT_ISA"), 0);
    }
    check_like_simulation(&full, &t);
    check_like_simulation(&redundant, &t);
    for (size_t i = 0; i < imk_device_count(); i++) {
        const imk_model device = device_model(i);
        if (!check_skips(i, 5))
            check_like_simulation(&device, &t);
    }
}

/* At rest the simulator computes the response once, where only the warm-up changes: the bytes are
 * those of a step, too. A perfect unit says what is true. */
static void test_at_rest(void **state)
{
    (void)state;
    const imk_model model = full_model();
    imk_model perfect;
    imk_model_default(&perfect);
    imk_sensor_settings settings = settings_of(1, 3);
    imk_simulation simulation = imk_simulation_default();
    settings.temperature = false;
    simulation.rate = rate;
    simulation.seed = 7;
    simulation.run = 3;
    simulation.roll = 0.3;
    double *true_row = simulate_rows(&perfect, &simulation, 1), readings[6];
    double *log = simulate_rows(&model, &simulation, ROWS);
    void *memory;
    imk_sensor *sensor = start_sensor(&model, &settings, &memory);
    imk_sensor_truth now = {.temperature = (double)NAN}; /* not read */
    memcpy(now.angular_rate, true_row, sizeof now.angular_rate);
    memcpy(now.specific_force, true_row + 3, sizeof now.specific_force);
    for (size_t k = 0; k < ROWS; k++) {
        CHECK_OK(imk_sensor_step(sensor, &now, readings));
        compare(readings, 6, 1, 0, log, k);
    }
    free(memory);
    free(log);
    free(true_row);
}

/* Each of many is the one with its run number, whether all see one motion or each its own, and in
 * turns. Numbers of sensors that fill a group, and that do not. */
static void test_side_by_side(void **state)
{
    (void)state;
    enum { MANY = 45, STEPS = 1100 };
    static truth t;
    static double readings[6 * MANY], copy[QUANTITIES][MANY];
    make_truth(&t);
    const imk_model model = full_model();
    const size_t counts[] = {2, 32, 33, MANY};
    for (size_t n = 0; n < 4; n++) {
        const size_t count = counts[n];
        const imk_sensor_settings settings = settings_of(count, 11);
        const size_t probed[] = {0, 1, count - 1};
        double *log[3];
        void *memory;
        imk_sensor *sensor = start_sensor(&model, &settings, &memory);
        for (size_t i = 0; i < 3; i++)
            log[i] = simulated(&model, &t, 11 + (uint32_t)probed[i]);
        for (size_t k = 0; k < STEPS; k++) {
            const imk_sensor_truth now = truth_of(&t, k);
            imk_stimulus each = {.temperature = copy[9], .temperature_rate = copy[10]};
            for (int i = 0; i < QUANTITIES; i++)
                for (size_t s = 0; s < count; s++)
                    copy[i][s] = t.row[i][k];
            for (int i = 0; i < 3; i++) {
                each.angular_rate[i] = copy[i];
                each.specific_force[i] = copy[3 + i];
                each.angular_acceleration[i] = copy[6 + i];
            }
            CHECK_OK(k < 100 || k % 7 == 0 ? imk_sensor_step(sensor, &now, readings)
                                           : imk_sensor_step_each(sensor, &each, readings));
            for (size_t i = 0; i < 3; i++)
                compare(readings, 6, count, probed[i], log[i], k);
        }
        for (size_t i = 0; i < 3; i++)
            free(log[i]);
        free(memory);
    }
}

/* Motions of their own: sensor 1 of two alone moves, and a quantity that is NULL is 0. */
static void test_own_motions(void **state)
{
    (void)state;
    enum { COUNT = 2 };
    imk_model model;
    imk_model_default(&model);
    imk_sensor_settings settings = settings_of(COUNT, 0);
    settings.temperature = false;
    void *memory;
    imk_sensor *sensor = start_sensor(&model, &settings, &memory);
    const double about_x[COUNT] = {0.0, 0.25}, along_z[COUNT] = {-9.5, 4.0};
    imk_stimulus each = {.angular_rate = {about_x}, .specific_force = {NULL, NULL, along_z}};
    double readings[6 * COUNT];
    CHECK_OK(imk_sensor_step_each(sensor, &each, readings));
    const double expected[6 * COUNT] = {0.0, 0.25, 0, 0, 0, 0, 0, 0, 0, 0, -9.5, 4.0};
    for (size_t i = 0; i < 6 * COUNT; i++)
        CHECK_CLOSE(readings[i], expected[i], 0.0);
    free(memory);
}

static void test_drops(void **state)
{
    (void)state;
    static truth t;
    make_truth(&t);
    const imk_model model = full_model();
    const imk_sensor_settings settings = settings_of(5, 20);
    imk_simulation simulation = imk_simulation_default();
    simulation.seed = 7;
    simulation.run = 23;
    void *memory;
    imk_sensor *sensor = start_sensor(&model, &settings, &memory);
    imk_simulator *simulator = start_simulator(&model, &simulation);
    size_t lost = 0;
    for (uint64_t row = 0; row < 1000; row++) {
        lost += imk_sensor_dropped(sensor, 3, row);
        assert_int_equal(imk_sensor_dropped(sensor, 3, row), imk_simulator_dropped(simulator, row));
    }
    assert_in_range(lost, 50, 150); /* 100 +- 9.5: the seed is fixed */
    free(simulator);
    free(memory);
}

/* ---- faults ---- */

/* A truth that is not finite costs the readings that depend on it, and nothing later: the noise is
 * that of a sensor which saw the last good value, and filter and quantization go on. */
static void test_not_finite(void **state)
{
    (void)state;
    static truth t;
    make_truth(&t);
    const imk_model model = full_model();
    const imk_sensor_settings settings = settings_of(1, 3);
    const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    for (int round = 0; round < 3 * QUANTITIES; round++) {
        const int quantity = round % QUANTITIES;
        void *memory;
        imk_sensor *sensor = start_sensor(&model, &settings, &memory);
        double readings[6];
        for (size_t k = 0; k < 400; k++) {
            imk_sensor_truth now = truth_of(&t, k);
            t.row[quantity][100] = bad[round / QUANTITIES];
            const bool is_bad = k >= 100 && k < 103;
            if (is_bad)
                now = truth_of(&t, 100);
            const imk_status status = imk_sensor_step(sensor, &now, readings);
            if (is_bad) {
                CHECK_STATUS(status, IMK_ERROR_NOT_FINITE);
                continue;
            }
            CHECK_OK(status);
            for (int c = 0; c < 6; c++)
                assert_true(isfinite(readings[c]));
        }
        make_truth(&t);
        free(memory);
    }
}

/* Without filter, quantization and hysteresis nothing at all is left of it. */
static void test_not_finite_leaves_nothing(void **state)
{
    (void)state;
    static truth t;
    make_truth(&t);
    imk_model model = full_model();
    imk_triad *const triads[] = {&model.gyro, &model.accel};
    for (int i = 0; i < 2; i++) {
        triads[i]->bandwidth = triads[i]->damping = axes(0.0, 0.0, 0.0);
        triads[i]->bias.hysteresis = triads[i]->noise.quantization = axes(0.0, 0.0, 0.0);
    }
    const imk_sensor_settings settings = settings_of(1, 3);
    void *memory;
    imk_sensor *sensor = start_sensor(&model, &settings, &memory);
    double *log = simulated(&model, &t, 3), readings[6];
    for (size_t k = 0; k < 700; k++) {
        imk_sensor_truth now = truth_of(&t, k);
        if (k % 10 == 0)
            now.angular_rate[1] = (double)NAN;
        CHECK_STATUS(imk_sensor_step(sensor, &now, readings),
                     k % 10 == 0 ? IMK_ERROR_NOT_FINITE : IMK_OK);
        assert_int_equal(isnan(readings[1]), k % 10 == 0);
        if (k % 10 != 0)
            compare(readings, 6, 1, 0, log, k);
    }
    free(log);
    free(memory);
}

static void check_refused(const imk_model *model, const imk_sensor_settings *settings,
                          imk_status expected, const char *field)
{
    static char memory[1 << 20];
    imk_sensor *sensor = NULL;
    imk_error error;
    CHECK_STATUS(imk_sensor_start(model, settings, &sensor, memory, sizeof memory, &error),
                 expected);
    assert_string_equal(error.field, field);
    assert_null(sensor);
}

static void test_refusals(void **state)
{
    (void)state;
    const double rates[] = {0.0, -1.0, 1e13};
    const imk_model good = full_model();
    imk_model model = good;
    imk_sensor_settings settings = imk_sensor_default();
    check_refused(NULL, &settings, IMK_ERROR_ARGUMENT, "model");
    check_refused(&good, NULL, IMK_ERROR_ARGUMENT, "settings");
    for (size_t i = 0; i < 3; i++) {
        settings.rate = rates[i];
        check_refused(&good, &settings, IMK_ERROR_RANGE, "rate");
    }
    settings.rate = (double)NAN;
    check_refused(&good, &settings, IMK_ERROR_NOT_FINITE, "rate");
    settings.rate = 1e9;
    check_refused(&good, &settings, IMK_ERROR_RANGE, "gyro.bandwidth");
    settings = imk_sensor_default();
    settings.cookie++;
    check_refused(&good, &settings, IMK_ERROR_UNINITIALISED, "settings");
    settings = imk_sensor_default();
    settings.count = 0;
    assert_int_equal(imk_sensor_size(&good, &settings), 0);
    check_refused(&good, &settings, IMK_ERROR_RANGE, "count");
    settings.count = 3;
    settings.run = UINT32_MAX - 1;
    check_refused(&good, &settings, IMK_ERROR_RANGE, "count");
    settings = imk_sensor_default();
    imk_scalar *const timing[] = {&model.timing.rate_error, &model.timing.jitter,
                                  &model.timing.skew};
    const char *const names[] = {"timing.rate_error", "timing.jitter", "timing.skew"};
    for (size_t i = 0; i < 3; i++) {
        timing[i]->value = 1e-5;
        check_refused(&model, &settings, IMK_ERROR_CONFLICT, names[i]);
        timing[i]->value = 0.0;
    }
    model.gyro.axis_count = IMK_AXES_MAX + 1;
    assert_int_not_equal(imk_sensor_start(&model, &settings, NULL, NULL, 0, NULL), IMK_OK);
    model = good;
    model.accel.noise.white.value[2] = (double)NAN;
    check_refused(&model, &settings, imk_model_validate(&model, NULL),
                  "accel.noise.velocity_random_walk");
}

static void test_memory_and_null(void **state)
{
    (void)state;
    const imk_model model = full_model();
    imk_sensor_settings settings = settings_of(1, 0);
    const size_t size = imk_sensor_size(&model, &settings);
    char *memory = malloc(size + 3);
    imk_sensor *sensor = NULL;
    imk_sensor_truth now = {.temperature = 298.0};
    double readings[6];
    assert_non_null(memory);
    CHECK_STATUS(imk_sensor_start(&model, &settings, &sensor, NULL, size, NULL),
                 IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_sensor_start(&model, &settings, &sensor, memory, size - 1, NULL),
                 IMK_ERROR_WORKSPACE);
    CHECK_STATUS(imk_sensor_start(&model, &settings, NULL, memory, size, NULL), IMK_ERROR_ARGUMENT);
    assert_null(sensor);
    CHECK_OK(imk_sensor_start(&model, &settings, &sensor, memory + 3, size, NULL));
    CHECK_STATUS(imk_sensor_step(NULL, &now, readings), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_sensor_step(sensor, NULL, readings), IMK_ERROR_ARGUMENT);
    CHECK_STATUS(imk_sensor_step(sensor, &now, NULL), IMK_ERROR_ARGUMENT);
    const imk_stimulus cold = {.temperature = NULL};
    CHECK_STATUS(imk_sensor_step_each(sensor, &cold, readings), IMK_ERROR_ARGUMENT);
    CHECK_OK(imk_sensor_step(sensor, &now, readings));
    free(memory);
    /* many, and more than there are addresses for */
    settings.count = 1000;
    assert_in_range(imk_sensor_size(&model, &settings), 1000 * (size / 2), 1000 * size);
    settings.count = SIZE_MAX / 4096;
    assert_int_equal(imk_sensor_size(&model, &settings), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_like_simulation),
        cmocka_unit_test(test_at_rest),
        cmocka_unit_test(test_side_by_side),
        cmocka_unit_test(test_own_motions),
        cmocka_unit_test(test_drops),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_not_finite_leaves_nothing),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_memory_and_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
