/* SPDX-License-Identifier: Apache-2.0 */
/* A start whose attitude and velocity are given: where it leads, and which warnings are due for
 * which log, and which are not. */
#include "check.h"

#include "imukit/motion_script.h"
#include "imukit/navigate_log.h"
#include "imukit/simulate_log.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 7, RATE = 20, SECONDS = 120, ROWS = RATE * SECONDS };

static const double degree = 0.017453292519943295, latitude = 0.78539816339744831;
static double data[COLUMNS][ROWS];
static imk_array_source memory;
static imk_record_source source;

/* Warnings of the start. */
static const char *const codes[] = {"start_turning",      "start_changing", "start_shaking",
                                    "start_acceleration", "attitude_tilt",  "hemisphere",
                                    "heading_off",        "rotation_off"};
enum { CODES = sizeof codes / sizeof *codes };

static void simulate(const imk_model *model, const imk_trajectory *motion, uint32_t run)
{
    static const char *const names[COLUMNS] = {"time",    "gyro_x",  "gyro_y", "gyro_z",
                                               "accel_x", "accel_y", "accel_z"};
    double *arrays[COLUMNS];
    const double *columns[COLUMNS];
    imk_simulate_log_settings settings = imk_simulate_log_default();
    for (int i = 0; i < COLUMNS; i++)
        columns[i] = arrays[i] = data[i];
    imk_array_sink array = {.column_count = COLUMNS, .capacity = ROWS, .data = arrays};
    const imk_record_sink sink = imk_array_sink_of(&array);
    settings.simulation.rate = RATE;
    settings.simulation.latitude = latitude;
    settings.simulation.motion.trajectory = motion;
    settings.simulation.run = run;
    settings.rows = ROWS;
    CHECK_OK(imk_simulate_log_run(model, &settings, &sink, "simulating", NULL, NULL));
    CHECK_OK(imk_array_source_make(COLUMNS, names, columns, ROWS, 0.0, &memory, &source, NULL));
}

/* An axis that shakes at a third of the rate. */
static void shake(double amplitude)
{
    for (int k = 0; k < ROWS; k++)
        data[4][k] += amplitude * (k % 3 - 1) * sqrt(1.5);
}

/* Without the known values, which navigation takes for taken out. */
static imk_model device(const char *name)
{
    imk_model model;
    imk_device_model(imk_device_find(name), &model);
    imk_triad *triads[2] = {&model.gyro, &model.accel};
    for (int i = 0; i < 2; i++) {
        memset(triads[i]->misalignment.value, 0, sizeof triads[i]->misalignment.value);
        memset(triads[i]->g_sensitivity.value, 0, sizeof triads[i]->g_sensitivity.value);
        memset(&triads[i]->g2_sensitivity, 0, sizeof triads[i]->g2_sensitivity);
        memset(&triads[i]->nonlinearity, 0, sizeof triads[i]->nonlinearity);
    }
    return model;
}

static imk_navigate_log_settings given(const imk_model *model)
{
    imk_navigate_log_settings settings = imk_navigate_log_default();
    settings.place.latitude = latitude;
    settings.align = 0.0;
    settings.model = model;
    settings.model_name = "the model";
    return settings;
}

static imk_navigate_log *navigate(const imk_navigate_log_settings *settings)
{
    imk_navigate_log *n = NULL;
    memory.next = 0;
    CHECK_OK(imk_navigate_log_run(&source, settings, NULL, &n, NULL));
    return n;
}

/* The one warning of the start that is due, NULL: none. @return its first number */
static double check_verdict(const imk_navigate_log_settings *settings, const char *due)
{
    imk_navigate_log *n = navigate(settings);
    double number = (double)NAN;
    bool told = false;
    for (size_t i = 0; i < n->findings.count; i++)
        for (int k = 0; k < CODES; k++)
            if (strcmp(n->findings.item[i].code, codes[k]) == 0) {
                if (!due || strcmp(due, codes[k]) != 0)
                    fail_msg("%s, where %s is due", codes[k], due ? due : "nothing");
                told = true;
                number = n->findings.item[i].number[0];
            }
    if (due && !told)
        fail_msg("nothing, where %s is due", due);
    imk_navigate_log_free(n);
    return number;
}

static void test_right_starts_are_silent(void **state)
{
    (void)state;
    static const char *const names[] = {"navigation", "tactical", "AHRS", "ADIS16488"};
    for (int i = 0; i < 4; i++)
        for (uint32_t run = 0; run < 6; run++) {
            const imk_model model = device(names[i]);
            simulate(&model, NULL, run);
            imk_navigate_log_settings settings = given(&model);
            check_verdict(&settings, NULL);
            settings.attitude_sigma[0] = settings.attitude_sigma[1] = settings.attitude_sigma[2] =
                0.5 * degree;
            settings.attitude[2] = 0.5 * degree;
            check_verdict(&settings, NULL);
            settings.model = NULL;
            if (i < 3) /* without a model the biases of the last, 16 mg, are not known */
                check_verdict(&settings, NULL);
        }
}

/* A wrong hemisphere and a wrong yaw are told by gyros that can, with and without a model. */
static void test_rotation_contradicts(void **state)
{
    (void)state;
    const imk_model good = device("navigation"), poor = device("AHRS"), mems = device("ADIS16488");
    for (int modelled = 0; modelled < 2; modelled++) {
        simulate(&good, NULL, 3);
        imk_navigate_log_settings settings = given(modelled ? &good : NULL);
        settings.place.latitude = -latitude;
        check_verdict(&settings, "hemisphere");
        settings.place.latitude = latitude;
        settings.attitude[2] = 80.0 * degree;
        CHECK_CLOSE(check_verdict(&settings, "heading_off"), 80.0, 1.0);
        settings.attitude_sigma[2] = 100.0 * degree;
        check_verdict(&settings, NULL);
        settings.attitude_sigma[2] = 0.0;
        settings.attitude[2] = 3.0 * degree;
        check_verdict(&settings, modelled ? "heading_off" : NULL);
        settings.attitude[2] = 0.0;
        settings.place.latitude = 0.2;
        check_verdict(&settings, "rotation_off");
    }
    const imk_model *silent[2] = {&poor, &mems};
    for (int i = 0; i < 2; i++) {
        simulate(silent[i], NULL, 1);
        imk_navigate_log_settings settings = given(silent[i]);
        settings.place.latitude = -latitude;
        settings.attitude[2] = 30.0 * degree;
        check_verdict(&settings, NULL);
    }
}

static void test_force_contradicts(void **state)
{
    (void)state;
    const imk_model good = device("navigation");
    simulate(&good, NULL, 2);
    imk_navigate_log_settings settings = given(&good);
    settings.attitude[0] = 4.0 * degree; /* 7 % of g */
    check_verdict(&settings, "start_acceleration");
    settings.attitude[0] = 1.0 * degree;
    settings.attitude_sigma[0] = settings.attitude_sigma[1] = 0.1 * degree;
    CHECK_CLOSE(check_verdict(&settings, "attitude_tilt"), 1.0, 0.01);
    settings.attitude_sigma[0] = settings.attitude_sigma[1] = 1.0 * degree;
    check_verdict(&settings, NULL);
}

static void test_motion_without_velocity(void **state)
{
    (void)state;
    const imk_model good = device("navigation");
    simulate(&good, NULL, 2);
    imk_navigate_log_settings settings = given(&good);
    shake(0.4); /* an idling engine */
    check_verdict(&settings, NULL);
    shake(1.6);
    CHECK_CLOSE(check_verdict(&settings, "start_shaking"), 2.0 / sqrt(3.0), 0.05);
    settings.velocity_given = true;
    check_verdict(&settings, NULL);
    settings.velocity_given = false;
    simulate(&good, NULL, 2);
    for (int k = 0; k < ROWS; k++)
        data[3][k] += 5.0 * degree;
    CHECK_CLOSE(check_verdict(&settings, "start_turning"), 5.0, 0.01);
    simulate(&good, NULL, 2);
    for (int k = 3 * RATE; k < ROWS; k++)
        data[4][k] += 1.0;
    CHECK_CLOSE(check_verdict(&settings, "start_changing"), 1.0, 0.01);
}

/* A flight at 60 m/s with perfect sensors ends where it does if its velocity is given; sigmas of
 * the start become those of the end: 5 m and 0.1 m/s over 119.95 s are 13 m. */
static void test_flight(void **state)
{
    (void)state;
    imk_model perfect;
    imk_model_default(&perfect);
    imk_motion_script script = imk_motion_script_default();
    const imk_motion_step steps[] = {{.kind = IMK_STEP_HOLD, .duration = 40.0},
                                     {.kind = IMK_STEP_TURN, .amount = 1.0, .rate = 0.05},
                                     {.kind = IMK_STEP_HOLD, .duration = 90.0}};
    imk_trajectory_piece piece[64];
    imk_trajectory trajectory;
    imk_motion_state end;
    script.heading = 1.0;
    script.speed = 60.0;
    script.step = steps;
    script.step_count = 3;
    CHECK_OK(imk_motion_script_compile(&script, piece, 64, &trajectory, NULL));
    simulate(&perfect, &trajectory, 0);
    imk_navigate_log_settings settings = given(&perfect);
    settings.attitude[2] = 1.0;
    settings.velocity_given = true;
    settings.velocity[0] = 60.0 * cos(1.0);
    settings.velocity[1] = 60.0 * sin(1.0);
    for (int i = 0; i < 3; i++) {
        settings.velocity_sigma[i] = 0.1;
        settings.position_sigma[i] = 5.0;
    }
    imk_navigate_log *n = navigate(&settings);
    /* the first row is of the interval that ends at 0 */
    imk_trajectory_state(&trajectory, (ROWS - 1.0) / RATE, &end);
    CHECK_BELOW(imk_vector3_norm(imk_vector3_subtract(n->end.state.velocity, end.velocity)), 0.05);
    CHECK_BELOW(imk_vector3_norm(imk_vector3_subtract(n->end.state.position, end.position)), 6.0);
    CHECK_RELATIVE(sqrt(n->end.covariance[0][0]), hypot(5.0, 0.1 * 120.0), 0.01);
    imk_navigate_log_free(n);
    settings.velocity_given = false;
    memset(settings.velocity, 0, sizeof settings.velocity);
    check_verdict(&settings, NULL); /* steady, and 2 deg/h over the Earth: no gyro bias is known */
}

static void test_refusals(void **state)
{
    (void)state;
    imk_model perfect;
    imk_error error;
    imk_model_default(&perfect);
    simulate(&perfect, NULL, 0);
    for (int i = 0; i < 5; i++) {
        imk_navigate_log *n = NULL;
        imk_navigate_log_settings settings = given(&perfect);
        static const char *const fields[] = {"velocity", "velocity", "velocity", "position_sigma",
                                             "velocity_sigma"};
        settings.velocity_given = true;
        settings.align = i == 0 ? 10.0 : 0.0;
        settings.velocity[0] = i == 1 ? (double)NAN : 0.0;
        settings.velocity[2] = i == 2 ? 1.0 : 0.0;
        settings.position_sigma[1] = i == 3 ? -1.0 : 0.0;
        settings.velocity_sigma[1] = i == 4 ? -1.0 : 0.0;
        memory.next = 0;
        CHECK_STATUS(imk_navigate_log_run(&source, &settings, NULL, &n, &error), IMK_ERROR_RANGE);
        assert_string_equal(error.field, fields[i]);
        imk_navigate_log_free(n);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_right_starts_are_silent),
        cmocka_unit_test(test_rotation_contradicts),
        cmocka_unit_test(test_force_contradicts),
        cmocka_unit_test(test_motion_without_velocity),
        cmocka_unit_test(test_flight),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
