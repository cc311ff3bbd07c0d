/* SPDX-License-Identifier: Apache-2.0 */
/* The calibration job from arrays alone: a unit whose errors are known comes out, references are
 * taken from columns and programmes, and what does not fit is said by a code. */
#include "check.h"

#include "imukit/jobs.h"
#include "imukit/motion_script.h"

#include <stdio.h>
#include <string.h>

enum { RATE = 50, HOLD = 6 * RATE, MOVE = 2 * RATE, POSES = 6, ROWS = POSES * (HOLD + MOVE) };
enum { COLUMNS = 8 };

static const double gravity = 9.80665;
static const double bias[3] = {0.1, -0.2, 0.05}, scale[3] = {1e-3, -2e-3, 3e-3};
static const double noise = 1e-3;
static const double degrees = 57.29577951308232; /* of a radian */

static double column[COLUMNS][ROWS]; /* accel_x … z, gyro_x … z, and two more */

/* Uniform, of unit variance. */
static double draw(void)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return ((double)state / 4294967296.0 - 0.5) * sqrt(12.0);
}

/* From face to face: up and down along x, y and z. */
static void fill_poses(void)
{
    for (int row = 0; row < ROWS; row++) {
        const int pose = row / (HOLD + MOVE), within = row % (HOLD + MOVE);
        const double part = within < HOLD ? 0 : (double)(within - HOLD) / MOVE;
        double force[3] = {0, 0, 0};
        force[pose / 2] += (1 - part) * (pose % 2 ? -gravity : gravity);
        force[(pose + 1) % POSES / 2] += part * (pose % 2 ? gravity : -gravity);
        for (int k = 0; k < 3; k++) {
            column[k][row] = (1 + scale[k]) * force[k] + bias[k] + noise * draw();
            column[3 + k][row] = (within < HOLD ? 0 : 1) * (k == 1) + 1e-4 * draw();
        }
    }
}

static imk_record_source source_of(size_t columns, const char *const *names, size_t rows)
{
    static imk_array_source arrays[4];
    static int next;
    const double *data[COLUMNS];
    imk_record_source made;
    for (size_t k = 0; k < columns; k++)
        data[k] = column[k];
    CHECK_OK(
        imk_array_source_make(columns, names, data, rows, RATE, &arrays[next++ % 4], &made, NULL));
    return made;
}

static const char *const sensors[] = {"accel_x", "accel_y", "accel_z", "gyro_x",
                                      "gyro_y",  "gyro_z",  NULL,      NULL};

static imk_calibrate_log_settings known_gravity(void)
{
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    settings.gravity = gravity;
    settings.no_earth = true;
    return settings;
}

/* One record by one procedure. */
static imk_status calibrate(imk_procedure procedure, const imk_record_source *source,
                            const imk_calibrate_log_settings *settings, imk_calibrate_log **found,
                            imk_error *error)
{
    const imk_calibrate_input input = {"record", procedure, source};
    return imk_calibrate_logs(1, &input, settings, NULL, found, error);
}

/* The code of the failure, in the record or in all of them. */
static const char *code_of(const imk_calibrate_log *found)
{
    const imk_finding *failure = imk_findings_failure(&found->findings);
    if (!failure && found->failed < found->count)
        failure = imk_findings_failure(&found->record[found->failed].loaded);
    return failure ? failure->code : "";
}

static void check_value(const imk_calibrate_log *found, const char *name, double expected,
                        double tolerance)
{
    imk_model_parameter parameter;
    CHECK_OK(imk_model_parameter_parse(name, &parameter));
    const int k = imk_calibrate_find(found, parameter);
    assert_true(k >= 0);
    CHECK_CLOSE(found->result->value[k], expected, tolerance);
}

/* ---- what comes out -------------------------------------------------------------------------- */

static void test_six_positions(void **state)
{
    (void)state;
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    settings.placement = 0; /* exact */
    fill_poses();
    const imk_record_source source = source_of(6, sensors, ROWS);
    CHECK_OK(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error));
    assert_int_equal(found->record[0].record.count, ROWS);
    assert_int_equal(found->calibration->frame, IMK_FRAME_REFERENCE);
    /* Each pose is a mean of 300 rows: 1e-3/sqrt(600) of two of them. */
    for (int k = 0; k < 3; k++) {
        char name[40];
        snprintf(name, sizeof name, "accel.bias.fixed.%c", "xyz"[k]);
        check_value(found, name, bias[k], 3e-4);
        snprintf(name, sizeof name, "accel.scale_factor.fixed.%c", "xyz"[k]);
        check_value(found, name, scale[k], 3e-5);
        CHECK_CLOSE(found->model.accel.bias.fixed.value[k], bias[k], 4e-4);
    }
    assert_int_equal(found->findings.count, 0); /* gravity was given */
    imk_calibrate_log_free(found);
}

/* What is known before stays, counts are what the data sheet says, and the place is asked for. */
static void test_known_before(void **state)
{
    (void)state;
    imk_error error;
    imk_calibrate_log *found;
    static imk_model before;
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    imk_model_default(&before);
    before.gyro.range.value[0] = 7;
    settings.model = &before;
    settings.estimate = "accel.bias, accel.scale_factor";
    fill_poses();
    imk_record_source source = source_of(6, sensors, ROWS);
    CHECK_OK(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error));
    assert_int_equal(found->result->parameter_count, 6);
    CHECK_CLOSE(found->model.gyro.range.value[0], 7, 0);
    CHECK_CLOSE(found->before->gyro.range.value[0], 7, 0);
    assert_int_equal(found->findings.count, 1);
    assert_string_equal(imk_finding_code(&found->findings.item[0]), "gravity");
    imk_calibrate_log_free(found);

    settings.sensitivity[1].count = 1; /* of readings that have a unit */
    settings.sensitivity[1].value[0] = 400;
    CHECK_OK(source.rewind(source.context, NULL));
    assert_int_equal(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error),
                     IMK_ERROR_ARGUMENT);
    assert_string_equal(code_of(found), "not_in_counts");
    imk_calibrate_log_free(found);

    CHECK_OK(source.rewind(source.context, NULL));
    snprintf(before.residual_of, sizeof before.residual_of, "unit 7");
    assert_int_equal(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error),
                     IMK_ERROR_CONFLICT);
    assert_string_equal(code_of(found), "model_of_residuals");
    imk_calibrate_log_free(found);
}

/* Readings in counts: the source says so, and the data sheet what they are. */
static void test_counts(void **state)
{
    (void)state;
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    fill_poses();
    for (int k = 0; k < 3; k++)
        for (int row = 0; row < ROWS; row++)
            column[k][row] = floor(column[k][row] * 400 + 30.5);
    static const char *const names[] = {"accel_x [count]", "accel_y [count]", "accel_z [count]"};
    imk_record_source source = source_of(3, names, ROWS);
    settings.placement = 0;
    settings.sensitivity[1] = (imk_calibrate_counts){1, {400}};
    settings.zero_offset[1] = (imk_calibrate_counts){3, {30, 30, 30}};
    CHECK_OK(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error));
    for (int k = 0; k < 3; k++)
        CHECK_CLOSE(found->model.accel.bias.fixed.value[k], bias[k], 1e-3);
    imk_calibrate_log_free(found);

    settings.zero_offset[1].count = 2;
    CHECK_OK(source.rewind(source.context, NULL));
    assert_int_equal(calibrate(IMK_PROCEDURE_SIXPOSITION, &source, &settings, &found, &error),
                     IMK_ERROR_ARGUMENT);
    assert_string_equal(code_of(found), "counts_of_axes");
    imk_calibrate_log_free(found);
}

/* Units that were not moved: the bias of each record is its mean. */
static void test_power_cycles(void **state)
{
    (void)state;
    static const double turn_on[3] = {0.01, 0.03, 0.02};
    static double cycle[3][3][20 * RATE];
    imk_array_source arrays[3];
    imk_record_source source[3];
    imk_calibrate_input input[3];
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    settings.repeatability = true;
    for (int run = 0; run < 3; run++) {
        for (int row = 0; row < 20 * RATE; row++)
            for (int k = 0; k < 3; k++)
                cycle[run][k][row] = turn_on[run] * (k + 1) + 1e-4 * draw();
        const double *data[3] = {cycle[run][0], cycle[run][1], cycle[run][2]};
        CHECK_OK(imk_array_source_make(3, &sensors[3], data, 20 * RATE, RATE, &arrays[run],
                                       &source[run], &error));
        input[run] = (imk_calibrate_input){"run", IMK_PROCEDURE_MULTIPOSITION, &source[run]};
    }
    CHECK_OK(imk_calibrate_logs(3, input, &settings, NULL, &found, &error));
    assert_int_equal(found->run_count, 3);
    for (int k = 0; k < 3; k++) /* 0.01 is the standard deviation of the three */
        CHECK_RELATIVE(found->model.gyro.bias.repeatability.value[k], 0.01 * (k + 1), 0.02);
    imk_calibrate_log_free(found);

    CHECK_OK(source[0].rewind(source[0].context, NULL));
    assert_int_equal(imk_calibrate_logs(1, input, &settings, NULL, &found, &error),
                     IMK_ERROR_TOO_SHORT);
    assert_string_equal(code_of(found), "few_runs");
    imk_calibrate_log_free(found);
}

static void test_models_of_power_cycles(void **state)
{
    (void)state;
    static imk_model model[3];
    const imk_model *const run[3] = {&model[0], &model[1], &model[2]};
    const char *const name[3] = {"a/1.yaml", "2.yaml", "3.yaml"};
    const imk_procedure procedure[3] = {IMK_PROCEDURE_MULTIPOSITION};
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    imk_calibrate_log *found;
    imk_error error;
    settings.repeatability = true;
    for (int k = 0; k < 3; k++) {
        imk_model_default(&model[k]);
        for (int axis = 0; axis < 3; axis++) {
            model[k].accel.bias.fixed.value[axis] = 0.02 * k;
            model[k].accel.bias.fixed.sigma[axis] = 1e-5;
        }
    }
    CHECK_OK(imk_calibrate_log_create(3, procedure, &settings, NULL, &found, &error));
    CHECK_OK(imk_calibrate_log_compare(found, run, name, &error));
    CHECK_RELATIVE(found->model.accel.bias.repeatability.value[1], 0.02, 1e-3);
    assert_string_equal(found->record[0].record.name, "1.yaml");
    imk_calibrate_log_free(found);

    model[2].accel.axis_count = 2;
    CHECK_OK(imk_calibrate_log_create(3, procedure, &settings, NULL, &found, &error));
    assert_int_equal(imk_calibrate_log_compare(found, run, name, &error), IMK_ERROR_CONFLICT);
    assert_string_equal(code_of(found), "models_of_units");
    assert_int_equal(found->failed, 2);
    imk_calibrate_log_free(found);

    model[1].accel.bias.fixed = (imk_axes){.value = {0}};
    CHECK_OK(imk_calibrate_log_create(2, procedure, &settings, NULL, &found, &error));
    assert_int_equal(imk_calibrate_log_compare(found, run, name, &error), IMK_ERROR_EMPTY);
    assert_string_equal(code_of(found), "model_without_sigma");
    imk_calibrate_log_free(found);
}

/* ---- what the unit was exposed to ------------------------------------------------------------ */

/* Steps of rate about z, which column 6 tells. */
static void fill_steps(void)
{
    for (int row = 0; row < ROWS; row++) {
        const double rate = 0.3 * (row / HOLD % 5 - 2);
        for (int k = 0; k < 3; k++) {
            column[k][row] = (k == 2 ? -gravity : 0) + noise * draw();
            column[3 + k][row] = (k == 2 ? 1.01 * rate + 2e-3 : 0) + 1e-4 * draw();
        }
        column[6][row] = rate * degrees;
    }
}

static void test_rate_table(void **state)
{
    (void)state;
    const char *names[7];
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    memcpy(names, sensors, sizeof names);
    names[6] = "table_rate [deg/s]";
    fill_steps();
    imk_record_source source = source_of(7, names, ROWS);
    assert_int_equal(calibrate(IMK_PROCEDURE_RATE_TABLE, &source, &settings, &found, &error),
                     IMK_ERROR_ARGUMENT);
    assert_string_equal(code_of(found), "no_table_axis");
    imk_calibrate_log_free(found);

    settings.table_axis = 2;
    settings.estimate = "gyro.bias.fixed.z,gyro.scale_factor.fixed.z";
    CHECK_OK(source.rewind(source.context, NULL));
    CHECK_OK(calibrate(IMK_PROCEDURE_RATE_TABLE, &source, &settings, &found, &error));
    check_value(found, "gyro.scale_factor.fixed.z", 0.01, 1e-4);
    check_value(found, "gyro.bias.fixed.z", 2e-3, 3e-5);
    imk_calibrate_log_free(found);

    names[6] = "table_rate [m/s]";
    source = source_of(7, names, ROWS);
    assert_int_equal(calibrate(IMK_PROCEDURE_RATE_TABLE, &source, &settings, &found, &error),
                     IMK_ERROR_DIMENSION);
    assert_string_equal(code_of(found), "wrong_unit");
    imk_calibrate_log_free(found);
}

/* A programme of the same steps that begins 1.5 s later in the record than the record itself. */
static void test_programme(void **state)
{
    (void)state;
    enum { LATE = 3 * RATE / 2 };
    static double rate[3][ROWS], force[3][ROWS];
    const imk_recorded_motion recorded = {.rate = RATE,
                                          .count = ROWS - LATE,
                                          .angular_rate = {rate[0], rate[1], rate[2]},
                                          .specific_force = {force[0], force[1], force[2]}};
    const imk_motion motion = {.recorded = &recorded};
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    fill_steps();
    for (int row = 0; row < ROWS - LATE; row++) {
        rate[2][row] = column[6][row + LATE] / degrees;
        force[2][row] = -gravity;
    }
    imk_record_source source = source_of(6, sensors, ROWS);
    settings.motion = &motion;
    settings.estimate = "gyro.bias.fixed.z,gyro.scale_factor.fixed.z";
    settings.find_offset = true;
    CHECK_OK(calibrate(IMK_PROCEDURE_RATE_TABLE, &source, &settings, &found, &error));
    CHECK_CLOSE(found->record[0].motion_offset, (double)LATE / RATE, 1e-3);
    assert_string_equal(found->record[0].loaded.item[0].code, "programme_begins");
    check_value(found, "gyro.scale_factor.fixed.z", 0.01, 1e-3);
    imk_calibrate_log_free(found);

    settings.find_offset = false; /* told a wrong one: that is seen */
    settings.motion_offset = 1.0;
    CHECK_OK(source.rewind(source.context, NULL));
    (void)calibrate(IMK_PROCEDURE_RATE_TABLE, &source, &settings, &found, &error);
    assert_non_null(found);
    assert_string_equal(imk_finding_code(&found->record[0].loaded.item[0]), "motion_offset");
    CHECK_CLOSE(found->record[0].loaded.item[0].number[3], 1.5, 2e-3);
    imk_calibrate_log_free(found);
}

/* ---- what is refused ------------------------------------------------------------------------- */

static void test_settings(void **state)
{
    (void)state;
    imk_error error;
    imk_calibrate_log *found;
    const imk_procedure poses = IMK_PROCEDURE_MULTIPOSITION;
    imk_calibrate_log_settings settings = imk_calibrate_log_default();
    assert_int_equal(imk_calibrate_log_create(0, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_RANGE);
    settings.gravity = 1.62;
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_RANGE);
    assert_string_equal(error.field, "gravity");
    CHECK_CLOSE(error.value, 1.62, 0);
    assert_null(found);
    settings = imk_calibrate_log_default();
    settings.frame = IMK_FRAME_REFERENCE;
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_CONFLICT);
    assert_string_equal(error.field, "frame");
    settings = imk_calibrate_log_default();
    settings.closed_form = true;
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_CONFLICT);
    settings = imk_calibrate_log_default();
    settings.with = IMK_CALIBRATE_NONLINEARITY;
    settings.estimate = "bias";
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_CONFLICT);
    settings = imk_calibrate_log_default();
    assert_int_equal(imk_calibrate_log_create(1, &(imk_procedure){IMK_PROCEDURES}, &settings, NULL,
                                              &found, &error),
                     IMK_ERROR_RANGE);
    assert_int_equal(imk_calibrate_logs(1, NULL, &settings, NULL, &found, &error),
                     IMK_ERROR_ARGUMENT);
    assert_int_equal(imk_calibrate_log_create(1, &poses, NULL, NULL, &found, NULL),
                     IMK_ERROR_ARGUMENT);
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, NULL, &error),
                     IMK_ERROR_ARGUMENT);
    settings.cookie = 0;
    assert_int_equal(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error),
                     IMK_ERROR_UNINITIALISED);
}

static void test_records(void **state)
{
    (void)state;
    imk_error error;
    imk_calibrate_log *found;
    imk_calibrate_log_settings settings = known_gravity();
    const imk_procedure poses = IMK_PROCEDURE_MULTIPOSITION;
    fill_poses();
    imk_record_source source = source_of(6, sensors, 100);
    settings.window = 3; /* the record has 2 s */
    assert_int_equal(calibrate(poses, &source, &settings, &found, &error), IMK_ERROR_ARGUMENT);
    assert_string_equal(code_of(found), "longer_than_record");
    imk_calibrate_log_free(found);

    settings = known_gravity();
    source = source_of(6, sensors, 1);
    assert_int_equal(calibrate(poses, &source, &settings, &found, &error), IMK_ERROR_TOO_SHORT);
    assert_string_equal(code_of(found), "one_row_of_test");
    imk_calibrate_log_free(found);

    source = source_of(6, sensors, ROWS);
    settings.estimate = "accel.bais";
    assert_int_equal(calibrate(poses, &source, &settings, &found, NULL), IMK_ERROR_KEY_UNKNOWN);
    imk_calibrate_log_free(found);
    CHECK_OK(source.rewind(source.context, NULL));
    assert_int_equal(calibrate(poses, &source, &settings, &found, &error), IMK_ERROR_KEY_UNKNOWN);
    assert_string_equal(error.field, "accel.bais");
    imk_calibrate_log_free(found);

    settings.estimate = "bias.temperature";
    CHECK_OK(source.rewind(source.context, NULL));
    assert_int_equal(calibrate(poses, &source, &settings, &found, &error), IMK_ERROR_COLUMN);
    assert_string_equal(code_of(found), "no_change_of_temperature");
    imk_calibrate_log_free(found);

    settings = known_gravity(); /* nothing was loaded */
    CHECK_OK(imk_calibrate_log_create(1, &poses, &settings, NULL, &found, &error));
    assert_int_equal(imk_calibrate_log_run(found, &error), IMK_ERROR_EMPTY);
    assert_int_equal(imk_calibrate_log_load(found, 1, "b", &source, &error), IMK_ERROR_RANGE);
    imk_calibrate_log_free(found);
    imk_calibrate_log_free(NULL);
}

static void test_terms(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t numbers;
    } cases[] = {{"bias", 6},
                 {"gyro.bias", 3},
                 {"accel.bias.fixed.y", 1},
                 {"nonlinearity", 24},
                 {"accel.k2", 3},
                 {"accel.misalignment", 3},
                 {"lever_arm", 9},
                 {"gyro.scale_factor.temperature", 9}};
    static imk_calibration calibration;
    imk_calibration_default(&calibration);
    calibration.frame = IMK_FRAME_UPPER;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        imk_model_parameter parameter[IMK_CORRELATED_MAX];
        size_t count = 0;
        imk_error error;
        CHECK_OK(imk_calibrate_terms(&calibration, 0, cases[k].name, IMK_CORRELATED_MAX, parameter,
                                     &count, &error));
        assert_int_equal(count, cases[k].numbers);
        CHECK_OK(imk_calibrate_terms(&calibration, 0, cases[k].name, IMK_CORRELATED_MAX, parameter,
                                     &count, &error)); /* once more adds nothing */
        assert_int_equal(count, cases[k].numbers);
        assert_int_equal(imk_calibrate_terms(&calibration, 0, "gyro.g_sensitivity", count + 1,
                                             parameter, &count, &error),
                         IMK_ERROR_WORKSPACE);
        assert_int_equal(imk_calibrate_terms(&calibration, 0, "accel.bias.fixed.7",
                                             IMK_CORRELATED_MAX, parameter, &count, &error),
                         IMK_ERROR_RANGE);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_six_positions),
        cmocka_unit_test(test_known_before),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_power_cycles),
        cmocka_unit_test(test_models_of_power_cycles),
        cmocka_unit_test(test_rate_table),
        cmocka_unit_test(test_programme),
        cmocka_unit_test(test_settings),
        cmocka_unit_test(test_records),
        cmocka_unit_test(test_terms),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
