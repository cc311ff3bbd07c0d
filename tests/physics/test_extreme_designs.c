/* SPDX-License-Identifier: Apache-2.0 */
/* Designs of which one parameter is extreme: refused with a reason, or all their numbers are finite
 * and a run ends. Bounds of steps and of figures, and the parameter that a refusal names. */
#include "instrument_run.h"

#include "imukit/physics.h"
#include "imukit/physics_log.h"

#include <stdio.h>

enum { VALUES = 10, SAMPLES = 3 };

/* Of the default, by a factor; or, where that is 0, this itself; the ends of the range. */
static double extreme(const imk_design_field *field, double usual, int which)
{
    static const double factors[] = {1e-300, 1e-20, 1e-9, 1e-3, 1e3, 1e9, 1e20, 1e300};
    if (which == 8)
        return field->open ? field->minimum + 1e-12 * fabs(field->minimum) + 1e-306
                           : field->minimum;
    if (which == 9)
        return field->maximum;
    return usual != 0.0 ? usual * factors[which] : factors[which];
}

static bool set_field(const imk_design_field *field, void *design, int which)
{
    char *place = (char *)design + field->offset;
    double value = 0.0;
    int whole = 0;
    if (field->kind == IMK_DESIGN_NUMBER) {
        memcpy(&value, place, sizeof value);
        value = extreme(field, value, which);
        memcpy(place, &value, sizeof value);
        return isfinite(value);
    } else if (field->kind == IMK_DESIGN_COUNT && which >= 8) {
        whole = (int)(which == 8 ? field->minimum : field->maximum);
        memcpy(place, &whole, sizeof whole);
    } else {
        return false;
    }
    return true;
}

static void check_all_finite(const imk_instrument *instrument, const char *path, size_t count,
                             const double *values, const imk_signal *signals)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(values[i]))
            fail_msg("%s, %s: %s is %g", instrument->name, path, signals[i].name, values[i]);
}

/* A few samples of at most a thousand steps, in motion. */
static void run_shortly(const imk_instrument *instrument, const void *design, const char *path,
                        imk_physics_settings settings, void *state)
{
    double outputs[IMK_INSTRUMENT_OUTPUTS_MAX], signals[IMK_INSTRUMENT_SIGNALS_MAX];
    const double step = instrument->step_length(design, &settings);
    imk_exposure exposure = imk_exposure_default();
    for (int k = 0; k < 3; k++) {
        exposure.angular_rate[k] = 3.0 - k;
        exposure.specific_force[k] = 9.8 * (k - 1.5);
    }
    if (!(step > 0.0 && isfinite(step)))
        fail_msg("%s, %s: a step of %g s", instrument->name, path, step);
    settings.rate = fmax(settings.rate, 1e-3 / step);
    if (imk_instrument_init(instrument, design, &settings, state, NULL) != IMK_OK)
        return;
    for (int i = 0; i < SAMPLES; i++) {
        instrument->step(state, &exposure, outputs);
        instrument->observe(state, signals);
        check_all_finite(instrument, path, instrument->output_count, outputs, instrument->outputs);
        check_all_finite(instrument, path, instrument->signal_count, signals, instrument->signals);
    }
}

/* A run of a second at 100 Hz is refused, or has no more steps than it may have. */
static void check_length(const imk_instrument *instrument, const void *design, const char *path,
                         imk_level level, void *state)
{
    imk_physics_settings settings = imk_physics_default();
    imk_error error = {0};
    settings.level = level;
    settings.duration = 1.0;
    settings.steps_max = IMK_PHYSICS_STEPS;
    const imk_status status = imk_instrument_init(instrument, design, &settings, state, &error);
    if (status != IMK_OK && !(error.field[0] && error.expected[0]))
        fail_msg("%s, %s: refused without a reason", instrument->name, path);
    if (status != IMK_OK)
        return;
    const double step = instrument->step_length(design, &settings);
    if (!(step * IMK_PHYSICS_STEPS >= 1.0 - 1e-6))
        fail_msg("%s, %s: %g steps", instrument->name, path, 1.0 / step);
    run_shortly(instrument, design, path, settings, state);
}

static void one_parameter_is_extreme(void **unused)
{
    (void)unused;
    imk_model *model = malloc(sizeof *model);
    for (size_t n = 0; n < imk_instrument_count(); n++) {
        const imk_instrument *instrument = imk_instrument_get(n);
        void *design = malloc(instrument->design_size);
        void *state = aligned_alloc(64, (instrument->state_size + 63) / 64 * 64);
        assert_true(model && design && state);
        for (size_t f = 0; f < instrument->field_count; f++)
            for (int which = 0; which < VALUES; which++) {
                const imk_design_field *field = &instrument->fields[f];
                imk_error error = {0};
                instrument->set_default(design);
                if (!set_field(field, design, which))
                    continue;
                if (imk_design_check(instrument, design, &error) != IMK_OK) {
                    if (!error.field[0] || !error.expected[0])
                        fail_msg("%s, %s: refused without a reason", instrument->name, field->path);
                    continue;
                }
                imk_instrument_reduce(instrument, design, model);
                if (imk_model_validate(model, &error) == IMK_ERROR_NOT_FINITE)
                    fail_msg("%s, %s: %s", instrument->name, field->path, error.field);
                check_length(instrument, design, field->path, IMK_LEVEL_FULL, state);
                check_length(instrument, design, field->path, IMK_LEVEL_SLOW, state);
            }
        free(design);
        free(state);
    }
    free(model);
}

/* ---- what a refusal says --------------------------------------------------------------------- */

static void the_figure_and_its_parameter_are_named(void **unused)
{
    (void)unused;
    imk_error error = {0};
    imk_pendulous_servo servo = imk_pendulous_servo_default();
    servo.inertia = 1e-300;
    CHECK_STATUS(imk_pendulous_servo_validate(&servo, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "pendulum.inertia");
    assert_non_null(strstr(error.expected, "noise.reading_noise of the error model is not finite"));
    CHECK_CLOSE(error.value, 1e-300, 0.0);
    imk_rate_gyro gyro = imk_rate_gyro_default();
    gyro.stiffness = 8e-302;
    CHECK_STATUS(imk_rate_gyro_validate(&gyro, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "spring.stiffness");
    assert_non_null(strstr(error.expected, "a fixed torque that the spring balances"));
    /* torque over stop: 2e-7 N m at 3 deg */
    CHECK_CLOSE(error.limit, 2e-7 / gyro.stop, 1e-18);
    gyro.torque.fixed = 0.0; /* which any spring balances */
    CHECK_STATUS(imk_rate_gyro_validate(&gyro, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "spring.stiffness");
    assert_non_null(strstr(error.expected, "nonlinearity.k2 "));
    /* in the unit of the table, without a limit that there is none */
    imk_design_error_in_units(&imk_rate_gyro_instrument, &gyro, &error);
    assert_string_equal(error.found, "\"8e-302 N*m/rad\" is in conflict");
}

/* A torque that the rest of the design does not balance is named itself; otherwise what is too weak
 * for the torque of the default design. */
static void what_does_not_balance_the_torque_is_named(void **unused)
{
    (void)unused;
    imk_error error = {0};
    imk_rate_gyro gyro = imk_rate_gyro_default();
    gyro.torque.fixed = -1.01 * gyro.stiffness * gyro.stop;
    CHECK_STATUS(imk_rate_gyro_validate(&gyro, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "torque.fixed");
    CHECK_CLOSE(error.limit, gyro.stiffness * gyro.stop, 1e-15);
    gyro = imk_rate_gyro_default();
    gyro.stop = 0.5 * gyro.torque.fixed / gyro.stiffness;
    CHECK_STATUS(imk_rate_gyro_validate(&gyro, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "gimbal.stop");
    CHECK_CLOSE(error.limit, 2.0 * gyro.stop, 1e-18);
    imk_tuned_gyro tuned = imk_tuned_gyro_default();
    tuned.torquer_limit = 0.5 * tuned.torque.fixed;
    CHECK_STATUS(imk_tuned_gyro_validate(&tuned, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "torquer.limit");
    tuned = imk_tuned_gyro_default();
    tuned.torque.fixed = 2.0 * tuned.torquer_limit;
    CHECK_STATUS(imk_tuned_gyro_validate(&tuned, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "torque.fixed");
    imk_rate_integrating_gyro floated = imk_rate_integrating_gyro_default();
    floated.torquer_limit = 0.5 * floated.torque.fixed;
    CHECK_STATUS(imk_rate_integrating_gyro_validate(&floated, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "torquer.limit");
}

/* 32 steps to a cycle of the captured pendulum, whose inertia is a 1e-12th: a millionth of the
 * step, and as many more; the loop's frequency is 800 Hz with a hinge of 1 %. */
static void too_many_steps_are_refused(void **unused)
{
    (void)unused;
    imk_pendulous_servo d = imk_pendulous_servo_default();
    imk_physics_settings settings = imk_physics_default();
    const imk_instrument *instrument = &imk_pendulous_servo_instrument;
    imk_error error = {0};
    void *state = started(instrument, &d, &settings);
    d.inertia *= 1e-12;
    CHECK_OK(imk_instrument_init(instrument, &d, &settings, state, &error)); /* of no duration */
    settings.duration = 2.0;
    CHECK_OK(imk_instrument_init(instrument, &d, &settings, state, &error)); /* of no bound */
    settings.steps_max = 1e7;
    CHECK_STATUS(imk_instrument_init(instrument, &d, &settings, state, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "duration");
    char found[96];
    const double cycle = 1.0 / imk_pendulous_servo_frequency(&d);
    snprintf(found, sizeof found, "the run of 2 s needs %.3g internal steps of %.3g s",
             64.0 / cycle, cycle / 32.0);
    assert_string_equal(error.found, found);
    assert_non_null(strstr(error.expected, "at most 1e+07 (at least 8 steps to a cycle of the "
                                           "captured pendulum)"));
    settings.duration = 1e7 * cycle / 32.0 * 0.999; /* just as many as may be */
    settings.rate = 1.0 / settings.duration;
    CHECK_OK(imk_instrument_init(instrument, &d, &settings, state, &error));
    settings.duration *= 1.01;
    CHECK_STATUS(imk_instrument_init(instrument, &d, &settings, state, &error), IMK_ERROR_CONFLICT);
    settings.level = IMK_LEVEL_SLOW; /* a step is a sample, however long that is */
    CHECK_OK(imk_instrument_init(instrument, &d, &settings, state, &error));
    /* a step that was asked for is the cause itself */
    d = imk_pendulous_servo_default();
    settings.level = IMK_LEVEL_FULL;
    settings.rate = 100.0;
    settings.duration = 1.0;
    settings.step = 1e-9;
    CHECK_STATUS(imk_instrument_init(instrument, &d, &settings, state, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(error.expected, "at most 1e+07: take a longer step");
    settings.steps_max = -1.0;
    CHECK_STATUS(imk_instrument_init(instrument, &d, &settings, state, &error), IMK_ERROR_RANGE);
    settings.duration = (double)NAN;
    CHECK_STATUS(imk_instrument_init(instrument, &d, &settings, state, &error), IMK_ERROR_RANGE);
    free(state);
}

/* 1e5 rad/s turn by 0.1 rad in a microsecond: 1e6 steps a second. */
static void a_fast_turn_is_counted(void **unused)
{
    (void)unused;
    const imk_free_gyro d = imk_free_gyro_default();
    imk_physics_settings settings = imk_physics_default();
    imk_error error = {0};
    settings.duration = 10.0;
    settings.steps_max = 1.001e7;
    settings.turning = 1e5;
    void *state = started(&imk_free_gyro_instrument, &d, &settings);
    settings.turning = 1.1e5;
    CHECK_STATUS(imk_instrument_init(&imk_free_gyro_instrument, &d, &settings, state, &error),
                 IMK_ERROR_CONFLICT);
    assert_non_null(strstr(error.expected, "at most 0.1 rad of the case's turn to a step"));
    settings.level = IMK_LEVEL_SLOW;
    CHECK_OK(imk_instrument_init(&imk_free_gyro_instrument, &d, &settings, state, &error));
    free(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_parameter_is_extreme),
        cmocka_unit_test(the_figure_and_its_parameter_are_named),
        cmocka_unit_test(what_does_not_balance_the_torque_is_named),
        cmocka_unit_test(too_many_steps_are_refused),
        cmocka_unit_test(a_fast_turn_is_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
