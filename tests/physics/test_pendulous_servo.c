/* SPDX-License-Identifier: Apache-2.0 */
/* The pendulous servo accelerometer: check values, levels, chain, limits. */
#include "instrument_run.h"

#include "imukit/laboratory.h"
#include "imukit/pendulous_servo.h"
#include "imukit/units.h"

#define G IMK_STANDARD_GRAVITY
static const double pi = 3.14159265358979324;
static const imk_instrument *const servo = &imk_pendulous_servo_instrument;

/* The design of the check value of rectification: 300 Hz, damping 0.7, integral 200/s. */
static imk_pendulous_servo checked(void)
{
    imk_pendulous_servo d = imk_pendulous_servo_default();
    const double stiffness = 1e-7 * (2.0 * pi * 300.0) * (2.0 * pi * 300.0);
    d.inertia = 1e-7;
    d.pendulosity = 5e-6;
    d.damping = 2.0 * 0.7 * sqrt(d.inertia * stiffness);
    d.hinge_stiffness = 0.0;
    d.proportional = stiffness;
    d.integral = stiffness * 200.0;
    d.stop = 0.1;
    d.hinge_torque = d.hinge_torque_temperature = d.torquer_quadratic = 0.0;
    d.misalignment_y = d.misalignment_z = d.readout_step = 0.0;
    d.torquer_constant = d.pendulosity * G / 1e-3;
    d.largest_current = 0.1;
    return d;
}

static imk_physics_settings quiet(double rate)
{
    imk_physics_settings settings = imk_physics_default();
    settings.rate = rate;
    settings.noise = false;
    return settings;
}

/* Forces of 10 g/sqrt(2) peak at 20 Hz along x and z: 1.0615 mg of mean reading, by the formula
 * (all printed digits) and by the full dynamics, whose steps of 1/40000 s hold the forces constant:
 * their means over the step are 0.001 % smaller, the small-angle formula errs by phi^2, 1e-4. */
static void rectification(void **state)
{
    (void)state;
    const imk_pendulous_servo d = checked();
    const double amplitude = 10.0 * G / sqrt(2.0), f = 20.0, rate = 40000.0;
    const double formula = imk_pendulous_servo_rectification(&d, f) * amplitude * amplitude;
    CHECK_CLOSE(formula / (1e-3 * G), 1.0615, 5e-5);
    const imk_physics_settings settings = quiet(rate);
    void *run_state = started(servo, &d, &settings);
    const size_t cycle = (size_t)(rate / f), cycles = 12;
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], sum = 0.0;
    for (size_t i = 0; i < 2 * cycles * cycle; i++) {
        imk_exposure exposure = imk_exposure_default();
        const double force = amplitude * cos(2.0 * pi * ((double)i + 0.5) / (double)cycle);
        exposure.specific_force[0] = exposure.specific_force[2] = force;
        servo->step(run_state, &exposure, outputs);
        if (i >= cycles * cycle)
            sum += outputs[0];
    }
    free(run_state);
    CHECK_RELATIVE(sum / (double)(cycles * cycle), formula, 5e-4);
}

/* A constant force is read exactly at both levels: integral action leaves no angle. */
static void a_constant_force_is_balanced(void **state)
{
    (void)state;
    const imk_pendulous_servo d = checked();
    for (int level = 0; level < 2; level++) {
        imk_physics_settings settings = quiet(1000.0);
        imk_exposure exposure = imk_exposure_default();
        settings.level = (imk_level)level;
        exposure.specific_force[0] = -37.0;
        exposure.specific_force[2] = 20.0;
        CHECK_RELATIVE(mean_of(servo, &d, &settings, &exposure, 1000, 10, 0), -37.0, 1e-12);
    }
}

/* The loop's gain for sines: full and slow levels against |M_c/(P f)|. The input is held over
 * samples of 1/8000 s, which costs nothing in gain: both are compared as means over samples. */
static void levels_agree_in_frequency(void **state)
{
    (void)state;
    const imk_pendulous_servo d = checked();
    const double frequencies[] = {5.0, 50.0, 200.0, 400.0};
    for (int i = 0; i < 4; i++)
        for (int level = 0; level < 2; level++) {
            imk_physics_settings settings = quiet(8000.0);
            settings.level = (imk_level)level;
            const double gain =
                sine_gain(servo, &d, &settings, 1.0, frequencies[i], 8000, 20, NULL);
            /* holding the input and taking the mean of the output are a sinc each; what the held
             * input has beside the sine is far above the loop */
            const double x = pi * frequencies[i] / 8000.0, held = sin(x) / x;
            CHECK_RELATIVE(gain, imk_pendulous_servo_gain(&d, frequencies[i]) * held * held, 2e-4);
        }
    const double bandwidth = imk_pendulous_servo_bandwidth(&d);
    CHECK_RELATIVE(imk_pendulous_servo_gain(&d, bandwidth), sqrt(0.5), 1e-9);
}

/* Without controller noise and damping nothing is lost: the exact propagator's area in phase space.
 * The loop needs damping to be stable with integral action, so that is switched off too. */
static void no_numerical_damping(void **state)
{
    (void)state;
    imk_pendulous_servo d = checked();
    d.damping = d.integral = 0.0;
    d.temperature = 293.15;
    const double cycles = 3000.0, f = imk_pendulous_servo_frequency(&d);
    imk_physics_settings settings = quiet(f * 16.0);
    void *run_state = started(servo, &d, &settings);
    imk_exposure exposure = imk_exposure_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], peak[2] = {0.0, 0.0}, signals[3];
    exposure.specific_force[0] = 1e-3; /* so little that angles squared do not count */
    for (size_t i = 0; i < (size_t)(16.0 * cycles); i++) {
        servo->step(run_state, &exposure, outputs);
        servo->observe(run_state, signals);
        const double angle = signals[0] - d.pendulosity * 1e-3 / d.proportional;
        const int part = i < (size_t)(8.0 * cycles) ? 0 : 1;
        peak[part] = fabs(angle) > peak[part] ? fabs(angle) : peak[part];
    }
    free(run_state);
    CHECK_RELATIVE(peak[1], peak[0], 1e-9 * cycles / 2.0);
}

/* All terms of the default design, by the experiments of the laboratory, against reduce. */
static void the_laboratory_finds_what_reduce_states(void **state)
{
    (void)state;
    const imk_pendulous_servo d = imk_pendulous_servo_default();
    imk_laboratory laboratory = imk_laboratory_default();
    imk_laboratory_result *found = malloc(sizeof *found);
    imk_model *stated = malloc(sizeof *stated);
    laboratory.instrument = servo;
    laboratory.design = &d;
    laboratory.physics = quiet(1000.0);
    laboratory.physics.step = 2e-4 / 8.0;
    laboratory.settle = 0.1;
    laboratory.dwell = 0.02;
    laboratory.points = 7;
    laboratory.threshold = false;
    laboratory.record = 0.0;
    laboratory.surroundings.temperature = d.temperature;
    laboratory.frequencies = 24;
    laboratory.lowest = 10.0;
    laboratory.highest = 4000.0;
    laboratory.full_scale = 100.0;
    const size_t size = imk_laboratory_workspace_size(&laboratory);
    void *workspace = malloc(size);
    assert_true(found && stated && workspace);
    CHECK_OK(imk_laboratory_run(&laboratory, NULL, found, workspace, size, NULL));
    imk_pendulous_servo_reduce(&d, stated);
    imk_error error;
    CHECK_OK(imk_model_validate(stated, &error));
    imk_laboratory_figure a[IMK_LABORATORY_FIGURES_MAX], b[IMK_LABORATORY_FIGURES_MAX];
    const size_t count = imk_laboratory_figures(stated, servo->sensor, a);
    imk_laboratory_figures(&found->model, servo->sensor, b);
    /* The integral settles with 1/300 s: e^-30 after 0.1 s. The sampled current is rounded to
     * 0.1 ug: 1e-6 m/s^2 of bias, 1e-8 of scale; K2 and K3 of it divided by 100 and 100^2. */
    const struct {
        const char *key;
        double tolerance;
    } checks[] = {{"bias.fixed", 2e-6},
                  {"bias.temperature", 2e-7},
                  {"scale_factor.fixed", 1e-7},
                  {"scale_factor.temperature", 2e-7}, /* 1/(1 + x) is not quite a line */
                  {"nonlinearity.k2", 2e-9},
                  {"nonlinearity.k3", 1e-10},
                  {"misalignment.y", 2e-6},
                  {"misalignment.z", 2e-6},
                  {"cross_products.kip", 1e-7},
                  {"cross_products.kio", 1e-7}};
    for (size_t c = 0; c < sizeof checks / sizeof checks[0]; c++)
        for (size_t i = 0; i < count; i++)
            if (strcmp(a[i].key, checks[c].key) == 0) {
                const double expected = a[i].value;
                if (!(fabs(b[i].value - expected) <= checks[c].tolerance)) {
                    print_error("%s: stated %g, found %g\n", a[i].key, expected, b[i].value);
                    fail();
                }
            }
    /* 24 frequencies in a factor 400, log-interpolated */
    CHECK_RELATIVE(found->bandwidth, stated->accel.bandwidth.value[0], 0.03);
    free(workspace);
    free(stated);
    free(found);
}

/* A turn about the hinge shows as a force at the centre of percussion, J/P from it. */
static void angular_acceleration_acts_at_the_centre_of_percussion(void **state)
{
    (void)state;
    const imk_pendulous_servo d = checked();
    const imk_physics_settings settings = quiet(1000.0);
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_acceleration[1] = 3.0;
    exposure.angular_rate[0] = 2.0;
    exposure.angular_rate[2] = 5.0;
    CHECK_RELATIVE(mean_of(servo, &d, &settings, &exposure, 1000, 10, 0),
                   d.inertia / d.pendulosity * (3.0 + 10.0), 1e-12);
}

/* A rod of 12 mm on a hinge at its end, 0.8 g: P = m L/2, J = m L^2/3, and the centre of percussion
 * is at 2/3 of its length, wherever the loop. The reading under angular acceleration and the
 * reduced model both say 8 mm along the pendulum, and nothing across. */
static void the_lever_arm_of_a_rod(void **state)
{
    (void)state;
    const double mass = 0.8e-3, length = 12e-3, arm = 8e-3;
    static imk_model model;
    imk_pendulous_servo d = checked();
    d.pendulosity = 0.5 * mass * length;
    d.inertia = mass * length * length / 3.0;
    const imk_physics_settings settings = quiet(1000.0);
    imk_exposure exposure = imk_exposure_default();
    exposure.angular_acceleration[1] = 1.0;
    CHECK_RELATIVE(mean_of(servo, &d, &settings, &exposure, 1000, 10, 0), arm, 1e-9);
    imk_pendulous_servo_reduce(&d, &model);
    CHECK_RELATIVE(model.accel.lever_arm.value[0][2], arm, 1e-14);
    assert_true(model.accel.lever_arm.value[0][0] == 0.0);
    assert_true(model.accel.lever_arm.value[0][1] == 0.0);
}

/* Without integral action: K_ip = P/K and the scale factor lacks K_h/K. */
static void a_soft_loop_deflects(void **state)
{
    (void)state;
    imk_pendulous_servo d = checked();
    imk_model *model = malloc(sizeof *model);
    imk_exposure exposure = imk_exposure_default();
    const imk_physics_settings settings = quiet(1000.0);
    d.integral = 0.0;
    d.hinge_stiffness = 0.05 * d.proportional;
    imk_pendulous_servo_reduce(&d, model);
    const double s = model->accel.scale_factor.fixed.value[0];
    const double kip = model->accel.nonlinearity.cross_products.value[0][0];
    CHECK_RELATIVE(s, -0.05 / 1.05, 1e-9);
    const double fx = 10.0, fz = 30.0;
    exposure.specific_force[0] = fx;
    exposure.specific_force[2] = fz;
    /* beyond: (P fz/K)^2, 1.6e-7 of fx */
    CHECK_CLOSE(mean_of(servo, &d, &settings, &exposure, 1000, 10, 0),
                (1.0 + s) * fx + kip * fx * fz +
                    model->accel.nonlinearity.k3.value[0] * fx * fx * fx,
                1e-5);
    free(model);
}

static void a_long_record_identifies_as_reduced(void **state)
{
    (void)state;
    imk_pendulous_servo d = imk_pendulous_servo_default();
    imk_physics_settings settings = imk_physics_default();
    imk_exposure exposure = imk_exposure_default();
    settings.rate = 50.0;
    settings.seed = 12;
    settings.step = 1.0 / 8000.0;
    d.readout_step = 0.0;
    check_chain(servo, &d, &settings, &exposure, 50, 4000);
    /* the slow level, four hours: the flicker shows too */
    settings.level = IMK_LEVEL_SLOW;
    settings.step = 0.0;
    settings.rate = 10.0;
    check_chain(servo, &d, &settings, &exposure, 50, 144000);
}

/* White noise of the reading, at both levels: 4000 samples, 1.1 % each, five times that. */
static void noise_is_its_formula(void **state)
{
    (void)state;
    imk_pendulous_servo d = checked();
    d.readout_noise = d.pickoff_noise = 0.0;
    d.hinge_torque_instability = d.hinge_torque_repeatability = d.torquer_repeatability = 0.0;
    for (int level = 0; level < 2; level++) {
        enum { COUNT = 4000 };
        static double samples[COUNT];
        imk_physics_settings settings = imk_physics_default();
        imk_exposure exposure = imk_exposure_default();
        double sum = 0.0;
        settings.rate = 50.0;
        settings.level = (imk_level)level;
        settings.step = level == 0 ? 1.0 / 3000.0 : 0.0;
        void *run_state = started(servo, &d, &settings);
        run(servo, run_state, &exposure, 50, 0, NULL);
        run(servo, run_state, &exposure, COUNT, 0, samples);
        for (int i = 0; i < COUNT; i++)
            sum += samples[i] * samples[i] / COUNT;
        free(run_state);
        CHECK_RELATIVE(sqrt(sum / 50.0), imk_pendulous_servo_noise(&d), 0.06);
    }
}

/* 100 g on 60 g: the torquer stops at its largest current, the pendulum at its stop, and both come
 * back. */
static void it_saturates_and_recovers(void **state)
{
    (void)state;
    const imk_pendulous_servo d = imk_pendulous_servo_default();
    const imk_physics_settings settings = quiet(1000.0);
    imk_exposure exposure = imk_exposure_default();
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[3];
    imk_model *model = malloc(sizeof *model);
    void *run_state = started(servo, &d, &settings);
    exposure.specific_force[0] = -100.0 * G;
    for (int i = 0; i < 100; i++)
        servo->step(run_state, &exposure, outputs);
    servo->observe(run_state, signals);
    imk_pendulous_servo_reduce(&d, model);
    CHECK_CLOSE(signals[0], -d.stop, 0.0);
    CHECK_CLOSE(outputs[0], -model->accel.range.value[0], d.readout_step / 1e-3 * G);
    exposure.specific_force[0] = 1.0;
    for (int i = 0; i < 1000; i++)
        servo->step(run_state, &exposure, outputs);
    CHECK_CLOSE(outputs[0], 1.0 + model->accel.bias.fixed.value[0], 1e-4);
    free(run_state);
    free(model);
}

static void impossible_designs_are_refused(void **state)
{
    (void)state;
    imk_error error;
    imk_pendulous_servo d = imk_pendulous_servo_default();
    void *memory = aligned_alloc(64, (servo->state_size + 63) / 64 * 64);
    imk_physics_settings settings = imk_physics_default();
    CHECK_OK(imk_pendulous_servo_validate(&d, &error));
    d.inertia = -1e-7;
    CHECK_STATUS(imk_pendulous_servo_validate(&d, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "pendulum.inertia");
    d.inertia = (double)NAN;
    CHECK_STATUS(imk_pendulous_servo_validate(&d, &error), IMK_ERROR_NOT_FINITE);
    d = imk_pendulous_servo_default();
    d.integral = d.proportional * 8000.0; /* b/J is 7037/s */
    CHECK_STATUS(imk_pendulous_servo_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "controller.integral");
    /* The torque must grow with the current, with some to spare: a quarter at the largest. */
    d = imk_pendulous_servo_default();
    d.torquer_quadratic = -0.245 / d.largest_current;
    CHECK_OK(imk_pendulous_servo_validate(&d, &error));
    d.torquer_quadratic = -0.255 / d.largest_current;
    CHECK_STATUS(imk_pendulous_servo_validate(&d, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "torquer.quadratic");
    memset(&d, 0, sizeof d);
    CHECK_STATUS(imk_pendulous_servo_validate(&d, &error), IMK_ERROR_UNINITIALISED);
    d = imk_pendulous_servo_default();
    settings.step = 1e-3; /* 800 Hz: 1.25 ms a cycle */
    CHECK_STATUS(imk_instrument_init(servo, &d, &settings, memory, &error), IMK_ERROR_RANGE);
    assert_string_equal(error.field, "step");
    free(memory);
}

/* A copied state goes on with the same bits; noise of another occasion differs, its constants do
 * not. */
static void states_are_plain_data(void **state)
{
    (void)state;
    const imk_pendulous_servo d = imk_pendulous_servo_default();
    imk_physics_settings settings = imk_physics_default();
    imk_exposure exposure = imk_exposure_default();
    double a[64], b[64];
    void *one = started(servo, &d, &settings), *two = started(servo, &d, &settings);
    run(servo, one, &exposure, 37, 0, NULL);
    memcpy(two, one, servo->state_size);
    run(servo, one, &exposure, 64, 0, a);
    run(servo, two, &exposure, 64, 0, b);
    assert_memory_equal(a, b, sizeof a);
    free(one);
    free(two);
}

/* The class of the lecture's table that the default reaches names "servo" among its technologies.
 */
static void the_default_is_of_a_class_with_servos(void **state)
{
    (void)state;
    const imk_pendulous_servo d = imk_pendulous_servo_default();
    imk_model *model = malloc(sizeof *model);
    imk_pendulous_servo_reduce(&d, model);
    imk_model_three_axes(model);
    const imk_grade_result grade = imk_grade_model(model);
    assert_int_equal(grade.accel, IMK_GRADE_NAVIGATION);
    assert_non_null(strstr(imk_grade_table(grade.accel)->accel_technology, servo->technology));
    CHECK_RELATIVE(imk_pendulous_servo_scale(&d) * G, 1.3e-3, 1e-12);
    CHECK_BELOW(300.0, imk_pendulous_servo_bandwidth(&d));
    free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rectification),
        cmocka_unit_test(a_constant_force_is_balanced),
        cmocka_unit_test(levels_agree_in_frequency),
        cmocka_unit_test(no_numerical_damping),
        cmocka_unit_test(the_laboratory_finds_what_reduce_states),
        cmocka_unit_test(angular_acceleration_acts_at_the_centre_of_percussion),
        cmocka_unit_test(the_lever_arm_of_a_rod),
        cmocka_unit_test(a_soft_loop_deflects),
        cmocka_unit_test(a_long_record_identifies_as_reduced),
        cmocka_unit_test(noise_is_its_formula),
        cmocka_unit_test(it_saturates_and_recovers),
        cmocka_unit_test(impossible_designs_are_refused),
        cmocka_unit_test(states_are_plain_data),
        cmocka_unit_test(the_default_is_of_a_class_with_servos),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
